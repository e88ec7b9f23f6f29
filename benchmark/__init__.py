# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements of the product on rooms with ground truth. Not part of the extension."""

import os

# Before numpy is there: a process that is copied (os.fork, in the fuzz) while a thread of it computes with several threads of
# OpenBLAS waits for ever.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
