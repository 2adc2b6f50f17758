"""Numerical ground: root search, quadrature, interpolation, decaying exponentials."""
