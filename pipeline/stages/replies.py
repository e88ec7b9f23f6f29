# SPDX-License-Identifier: GPL-3.0-or-later
from ..artifacts.replies import *  # noqa: F403 (moved; the lead removes this file)
