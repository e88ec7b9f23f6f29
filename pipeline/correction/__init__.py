# SPDX-License-Identifier: GPL-3.0-or-later
"""The deterministic correction of a finished room: every kind of fault is a module that finds it and proposes mends."""
