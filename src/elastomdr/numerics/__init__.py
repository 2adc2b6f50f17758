"""Numerical ground: root search, exponentials, compiled code."""
