# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether Blender can draw with the graphics card (or Mesa in its place) before it is asked to.

Without a driver a background Blender does not raise an error, it ends the process (seen with bpy 4.5 and 5.0 on Linux),
so this has to be known first.
"""

from __future__ import annotations

import ctypes
import functools
import sys

import bpy

_SURFACELESS = 0x31DD  # EGL_PLATFORM_SURFACELESS_MESA
_DEVICE = 0x313F  # EGL_PLATFORM_DEVICE_EXT


@functools.lru_cache(maxsize=1)
def can_draw() -> bool:
    """False on a Linux without a window where EGL finds no driver; True everywhere else."""
    if not sys.platform.startswith("linux") or not bpy.app.background:
        return True
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError:
        return False
    egl.eglGetDisplay.restype = ctypes.c_void_p
    egl.eglGetDisplay.argtypes = [ctypes.c_void_p]
    egl.eglInitialize.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    displays = [egl.eglGetDisplay(None)]
    for_platform = getattr(egl, "eglGetPlatformDisplay", None)  # EGL 1.5
    if for_platform is not None:
        for_platform.restype = ctypes.c_void_p
        for_platform.argtypes = [ctypes.c_uint, ctypes.c_void_p, ctypes.c_void_p]
        displays += [for_platform(platform, None, None) for platform in (_SURFACELESS, _DEVICE)]
    # The displays are not terminated: Blender uses the same ones.
    return any(display and egl.eglInitialize(display, None, None) for display in displays)
