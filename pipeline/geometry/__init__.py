# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras, footprints, polygons and small placement solvers: plain numbers in, plain numbers out, no Blender."""
