# SPDX-License-Identifier: GPL-3.0-or-later
"""One module a room: `scene()` says what stands where and how it is photographed."""
