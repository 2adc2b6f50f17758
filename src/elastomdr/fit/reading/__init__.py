"""Files of the laboratory into SI arrays: moduli, measured friction, surfaces and their spectra."""
