# SPDX-License-Identifier: GPL-3.0-or-later
"""A whole room in one answer: its prompt, reading it while it is written, and what stages 1 to 10 take from it."""
