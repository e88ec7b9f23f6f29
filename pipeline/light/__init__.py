# SPDX-License-Identifier: GPL-3.0-or-later
"""What stage 10 decides, as functions: lights, how bright they are, exposure, and from where the room is looked at."""
