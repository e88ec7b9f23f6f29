# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks as Blender's shader nodes: the same in every supported version, in EEVEE and in Cycles."""
