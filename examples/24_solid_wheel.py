"""24: a rubber-tyred wheel warms up: its steady temperature, the way there, and which
part of the spectrum pays.

Teaches: `em.heat_build_up` finds the temperature at which a rolling body gives off what
its resistance makes, and the way to it; `em.dissipation` says how much each relaxation
time takes of the loss. Warm rubber is faster rubber: the loss moves to branches that
are slower at the reference temperature, here to those that lose less.

Inputs: the synthetic passenger tread of the library (synthetic, illustrative) as a solid
tyre, 15 mm thick on a steel hub of 200 mm over all and 50 mm wide, 800 N, in a cold
store at -10 degC; 1.2 W/K to the air and 1 kJ/K: chosen here, the first as 0.06 m^2 at
20 W/(m^2 K). The tyre is a layer bonded to its hub (`em.layer`), exact in plane strain.

Check: rubber of one short time with a shift factor exp(-beta dT) has P = P_0 exp(-beta
dT), so that the steady rise is W(beta P_0/H)/beta, Lambert's function, and scipy
integrates the way to it; the shares, on springs, against force histories by quadrature,
f_k^2/(E_k tau_k), with the free recovery behind the contact from Lyapunov's equation.

    python examples/24_solid_wheel.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.linalg import solve_continuous_lyapunov
from scipy.special import lambertw

import elastomdr as em

TYRE = em.layer(em.load_material("tread-passenger-synthetic"), 15e-3)
# the textbook's tyre
SPRINGS = em.springs(em.load_material("tread-passenger-synthetic"), 15e-3, bonded=False)
WHEEL = em.Cylinder(0.1, 0.05)  # radius, width [m]
LOAD, AMBIENT, CONDUCTANCE, CAPACITY = 800.0, 263.15, 1.2, 1e3  # N, K, W/K, J/K
SPEEDS = np.array([1.0, 2.0, 4.0])  # m/s
TIME = np.linspace(0, 5400, 61)  # s
SHOWN = 2  # of the speeds, in the middle and on the right


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    surroundings = {
        "ambient": AMBIENT,
        "conductance": CONDUCTANCE,
        "capacity": CAPACITY,
    }
    warm = em.heat_build_up(
        TYRE, WHEEL, velocity=SPEEDS, load=LOAD, time=TIME, rtol=1e-4, **surroundings
    )
    print(warm.summary())
    steady, settling = warm.steady[:, 0], warm.settling[:, 0]
    textbook = em.heat_build_up(
        SPRINGS,
        WHEEL,
        velocity=SPEEDS,
        load=LOAD,
        ambient=AMBIENT,
        conductance=CONDUCTANCE,
    ).steady
    print(
        "on springs free at the base:",
        ", ".join(f"{k - AMBIENT:.2f} K" for k in textbook),
    )
    naive = warm.power[:, 0] / CONDUCTANCE
    for v, kelvin, first, tau in zip(SPEEDS, steady, naive, settling, strict=True):
        rise = kelvin - AMBIENT
        print(
            f"{v:g} m/s: {rise:.2f} K above the air, {first:.1f} K if the loss "
            f"stayed as it starts; {tau:.0f} s"
        )
    assert warm.converged.all(), (
        "a wheel runs away, or gets hotter than the shift law reaches: less load, or "
        "slower"
    )
    ends = np.array([AMBIENT, steady[SHOWN]])
    parts = em.dissipation(
        TYRE, WHEEL, velocity=SPEEDS[SHOWN], load=LOAD, temperature=ends, rtol=1e-4
    )

    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(8.6, 3.4))
    colours = ("#8bb4d9", "#3a7fb5", "#0b2540")
    for row, end, v, colour in zip(
        warm.temperature, steady, SPEEDS, colours, strict=True
    ):
        left.plot(TIME / 60, row - 273.15, color=colour, label=f"{v:g} m/s")
        left.axhline(end - 273.15, color=colour, linestyle=":", linewidth=1)
    left.set(
        xlabel="Time [min]",
        ylabel="Temperature of the tyre [°C]",
        xlim=(0, TIME[-1] / 60),
    )
    left.set_title("From the cold; dotted: steady")
    middle.plot(
        warm.temperature[SHOWN] - 273.15,
        warm.power[SHOWN],
        color="#a03030",
        label="made",
    )
    kelvin = np.array([AMBIENT, steady[SHOWN] + 5])
    middle.plot(
        kelvin - 273.15,
        CONDUCTANCE * (kelvin - AMBIENT),
        color="#1f5a94",
        label="given off",
    )
    middle.plot(steady[SHOWN] - 273.15, warm.power[SHOWN, -1], "o", color="#222222")
    middle.set(
        xlabel="Temperature of the tyre [°C]", ylabel="Power [W]", ylim=(0, None)
    )
    middle.set_title(f"Balance at {SPEEDS[SHOWN]:g} m/s")
    for share, kelvin, colour in zip(
        parts.share, ends, ("#1f5a94", "#a03030"), strict=True
    ):
        label = f"at {kelvin - 273.15:.0f} °C"
        right.semilogx(
            SPRINGS.times, 100 * share, "o-", color=colour, markersize=4, label=label
        )
    right.set(
        xlabel="Relaxation time at 20 °C [s]",
        ylabel="Share of the dissipation [%]",
        ylim=(0, None),
    )
    right.set_title(f"Where the loss happens, {SPEEDS[SHOWN]:g} m/s")
    for ax in (left, middle, right):
        ax.legend()
    figure.savefig(out / "24_solid_wheel.png")
    plt.close(figure)

    check_warming()
    check_shares(
        em.dissipation(
            SPRINGS, WHEEL, velocity=SPEEDS[SHOWN], load=LOAD, temperature=ends
        ),
        ends,
    )


def check_warming() -> None:
    """One short relaxation time: the loss is in proportion to a_T = exp(-beta dT)."""
    beta, start, cold = 0.04, 200.0, 293.15  # 1/K, J/K, K
    shift = em.ShiftTable([cold, cold + 100], [0.0, -100 * beta / np.log(10)])
    rubber = em.Foundation(1e9, [1e9], [1e-9], shift=shift)
    power = float(
        em.rolling(rubber, WHEEL, velocity=1.0, load=LOAD, temperature=cold).power
    )
    conductance = power / 50  # 50 K if nothing changed
    time = start / conductance * np.array([0.0, 0.03, 0.1, 0.3, 1.0, 3.0])
    warm = em.heat_build_up(
        rubber,
        WHEEL,
        velocity=1.0,
        load=LOAD,
        ambient=cold,
        conductance=conductance,
        capacity=start,
        time=time,
        hottest=cold + 99,
    )
    expected = float(lambertw(beta * power / conductance).real) / beta
    print(
        f"check     steady rise {warm.steady[0] - cold:.6f} K, Lambert's function "
        f"{expected:.6f} K"
    )
    assert np.isclose(warm.steady[0] - cold, expected, rtol=1e-5), "the steady state"

    def rate(_: float, rise: np.ndarray) -> np.ndarray:
        return (power * np.exp(-beta * rise) - conductance * rise) / start

    way = solve_ivp(rate, (0, time[-1]), [0.0], t_eval=time, rtol=1e-10, atol=1e-10).y[
        0
    ]
    off = np.abs(warm.temperature - cold - way).max()
    print(f"check     the way there: off scipy's integrator by {off:.1e} K")
    assert off < 1e-3, "the way to the steady state"


def check_shares(parts: em.Dissipation, kelvin: np.ndarray) -> None:
    """The same shares from the history of every branch, by quadrature, at both
    temperatures.
    """
    rolled = em.rolling(
        SPRINGS, WHEEL, velocity=SPEEDS[SHOWN], load=LOAD, temperature=kelvin
    )
    for i, tau in enumerate(parts.time):
        a, b = rolled.contact.leading[i], rolled.contact.trailing[i]
        expected = losses(
            SPRINGS.equilibrium, SPRINGS.moduli, SPEEDS[SHOWN] * tau, a, b
        )
        off = np.abs(parts.share[i] - expected / expected.sum()).max()
        closed = WHEEL.length * expected.sum() / rolled.resistance[i] - 1
        print(
            f"check     at {kelvin[i] - 273.15:.0f} degC: shares off by {off:.1e}, "
            f"their sum by {closed:.1e}"
        )
        assert off < 1e-10, "the shares by quadrature"
        assert abs(closed) < 1e-9, (
            "what the branches lose is the work of the resistance"
        )


def losses(
    relaxed: float, moduli: np.ndarray, s: np.ndarray, a: float, b: float
) -> np.ndarray:
    """int f_k^2/(E_k s_k) dx of each branch, in the contact and behind it; s_k = v
    tau_k is a length, f' = df/dx.
    """
    lost, held = [], []
    for modulus, length in zip(moduli, s, strict=True):
        # at x = a - y
        def force(y: float, e: float = modulus, l: float = length) -> float:
            w = y / l
            second = 0.5 - w / 6 if w < 1e-4 else (w + np.expm1(-w)) / w**2
            return e / float(WHEEL.radius) * (a * l * -np.expm1(-w) - y**2 * second)

        layer = sorted({min(m * length, a + b) for m in (1, 5, 40)})
        whole, _ = quad(
            lambda y, f=force: f(y) ** 2,
            0,
            a + b,
            points=layer,
            epsrel=1e-10,
            epsabs=0,
            limit=200,
        )
        lost.append(whole / (modulus * length))
        held.append(force(a + b))
    # Free: E_0 u' + sum f_k' = 0, f_k' = E_k u' - f_k/s_k, so f' = A f; int f_k^2 = f^T
    # M f with A^T M + M A = -1.
    rates = np.outer(moduli, 1 / s) / (relaxed + moduli.sum()) - np.diag(1 / s)
    # of the same size as the rest, to keep the equation well conditioned
    root = np.sqrt(moduli * s)
    balanced, state = rates * (root[None, :] / root[:, None]), np.array(held) / root
    for k in range(s.size):
        one = np.zeros_like(rates)
        one[k, k] = 1.0
        lost[k] += state @ solve_continuous_lyapunov(balanced.T, -one) @ state
    return np.array(lost)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
