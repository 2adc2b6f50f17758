"""What every call shares: its arguments, lists of materials, the choice of a model,
extrapolation.
"""
