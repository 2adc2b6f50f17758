"""Motion in time: indentation, impact, sliding, drives, shear."""
