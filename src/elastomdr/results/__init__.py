"""What comes out: curves, their tables and their figures."""
