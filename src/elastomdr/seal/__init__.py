"""Seals: O-rings."""
