# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements on the meshes of a built room, by ray casting: nothing here believes the numbers that were asked for."""
