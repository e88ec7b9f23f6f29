# SPDX-License-Identifier: GPL-3.0-or-later
"""What stage 8 decides: which look each part of each object has, in the picture's colours. Pure functions."""
