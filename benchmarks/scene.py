"""The scene of the timing benchmarks: 16 branches under a ball over 10 decades of
velocity.
"""

import numpy as np

import elastomdr as em

EQUILIBRIUM = 4e6  # E_inf [Pa]
# tau_k [s]: all between the shortest and the longest passage, none can be left out
TIMES = np.geomspace(1e-7, 1e3, 16)
# E_k [Pa]: a power law from rubber to glass, E_0/E_inf = 2700
MODULI = EQUILIBRIUM * (TIMES / TIMES[-1]) ** -0.3
RADIUS = 0.01  # R [m]
LOAD = 10.0  # F_N [N]
LEADING = 1e-3  # leading edge where the depth is given [m]
VELOCITY = np.geomspace(1e-7, 1e3, 64)  # v [m/s]
FOUNDATION = em.Foundation(EQUILIBRIUM, MODULI, TIMES)

INPUTS = (
    f"E_inf = {EQUILIBRIUM:g} Pa, {TIMES.size} branches, tau = {TIMES[0]:g} ... "
    f"{TIMES[-1]:g} s, E_k = E_inf (tau_k/{TIMES[-1]:g} s)^-0.3, given as E*",
    f"R = {RADIUS:g} m, load {LOAD:g} N or leading edge at {LEADING:g} m, "
    f"{VELOCITY.size} velocities, {VELOCITY[0]:g} ... {VELOCITY[-1]:g} m/s",
)
