"""Where things can stand: surfaces found on built geometry, and free places on them. Pure numpy, no bpy."""
