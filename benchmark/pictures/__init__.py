# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of our own making with exact ground truth: `<room>/picture.png` and `<room>/truth.json`, and what makes them."""
