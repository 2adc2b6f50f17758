"""Belts and rollers: conveyors, heat build-up, stability."""
