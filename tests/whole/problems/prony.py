"""The steadily sliding Prony paraboloid in many digits, from its closed force density:
an independent answer.

    q(x) = E_inf (a^2 - x^2)/R + sum_k (2 E_k s_k/R)[(x + s_k) - (a + s_k) exp(-(a - x)/s_k)],
    s_k = v tau_k,

with the exit where q = 0. Its integrals against 1 and 2x/R are elementary; mpmath
carries the digits that cancel.
"""

import mpmath as mp


def root(function, low, high, digits=55):
    """Where a function changes sign, by Ridders' method and bisection in turn."""
    value_low, value_high = function(low), function(high)
    while (
        high - low > mp.mpf(10) ** -digits * (abs(low) + abs(high))
        and value_low * value_high != 0
    ):
        middle = (low + high) / 2
        value = function(middle)
        step = (
            (middle - low)
            * mp.sign(value_low)
            * value
            / mp.sqrt(value**2 - value_low * value_high)
        )
        for x, at in ((middle, value), (middle + step, function(middle + step))):
            if low < x < high and at * value_low > 0:
                low, value_low = x, at
            elif low < x < high:
                high, value_high = x, at
    return low if value_low == 0 else high if value_high == 0 else (low + high) / 2


def line(equilibrium, moduli, times, radius, velocity, *, load=None, size=None):
    """(mu, F_N, F_x, a, b) of the bare line at a load [N] or a leading edge [m]."""
    with mp.workdps(120):
        e_inf, radius, velocity = mp.mpf(equilibrium), mp.mpf(radius), mp.mpf(velocity)
        branches = [
            (mp.mpf(e), velocity * mp.mpf(t))
            for e, t in zip(moduli, times, strict=True)
        ]

        def density(x, a):
            viscous = sum(
                2 * e * s / radius * ((x + s) - (a + s) * mp.exp(-(a - x) / s))
                for e, s in branches
            )
            return e_inf * (a * a - x * x) / radius + viscous

        def trailing(a):
            # b/a: the force density is positive at the apex and not above zero at the
            # far end.
            return a * root(lambda ratio: density(-ratio * a, a), mp.mpf(0), mp.mpf(1))

        def forces(a):
            b = trailing(a)

            def moment(n, s):  # int_{-b}^{a} x^n exp(-(a-x)/s) dx
                gone = mp.exp(-(a + b) / s)
                first = s * (1 - gone)
                return first if n == 0 else s * (a + b * gone) - s * first

            def power(n):
                return (a ** (n + 1) - (-b) ** (n + 1)) / (n + 1)

            normal = e_inf / radius * (a * a * power(0) - power(2))
            drag = 2 * e_inf / radius**2 * (a * a * power(1) - power(3))
            for e, s in branches:
                normal += (
                    2
                    * e
                    * s
                    / radius
                    * (power(1) + s * power(0) - (a + s) * moment(0, s))
                )
                drag += (
                    4
                    * e
                    * s
                    / radius**2
                    * (power(2) + s * power(1) - (a + s) * moment(1, s))
                )
            return normal, drag, b

        if size is None:
            size = mp.exp(
                root(
                    lambda log_a: mp.log(forces(mp.exp(log_a))[0] / load),
                    mp.mpf(-28),
                    mp.mpf(7),
                )
            )
        a = mp.mpf(size)
        normal, drag, b = forces(a)
        return tuple(float(x) for x in (drag / normal, normal, drag, a, b))
