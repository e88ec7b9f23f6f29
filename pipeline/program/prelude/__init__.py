# SPDX-License-Identifier: GPL-3.0-or-later
"""The fixed part of every room.py: pure numpy and math, also inlined as text (see `program/assemble.py`)."""
