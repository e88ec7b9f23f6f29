# SPDX-License-Identifier: GPL-3.0-or-later
"""What stage 9 decides: surfaces of the room as flat pictures, taken from the reference image where it shows them well."""
