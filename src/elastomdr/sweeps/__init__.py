"""Many scenes: the product of axes of one call, in chunks that are computed apart and
kept in a store.
"""
