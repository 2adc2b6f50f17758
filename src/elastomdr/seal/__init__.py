"""Seals: O-rings, lubricated contacts, rods that move out and in."""
