# SPDX-License-Identifier: GPL-3.0-or-later
"""Finding an asset for an object: what asset libraries hold, and what fits an object's words and size."""
