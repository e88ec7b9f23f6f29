# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements of the product on rooms with ground truth. Not part of the extension."""
