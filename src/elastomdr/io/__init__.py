"""Files of others into SI numbers: a register of formats for moduli, and readers of
friction, spectra and surfaces.
"""
