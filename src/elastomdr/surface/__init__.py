"""What rubber meets: indenters, profiles, rough lines and spectra, and their lines of
elements.
"""
