# SPDX-License-Identifier: GPL-3.0-or-later
"""What stages write to memory, as pydantic models. No behaviour beyond validation lives here."""
