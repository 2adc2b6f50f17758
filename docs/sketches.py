"""The sketches of docs/theory.md: the line of elements, contact by scales, the layer.

python docs/sketches.py
"""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

FIGURES = Path(__file__).parent / "figures"
BODY, RUBBER, CONTACT = "#c9ced4", "#dbe7f1", "#a03030"
EDGE = {"color": "#222222", "lw": 1.5}


def canvas(panels: int, height: float) -> list[Any]:
    """Axes side by side, without frames."""
    figure, axes = plt.subplots(1, panels, figsize=(8.6, height), layout="constrained")
    for ax in np.ravel(axes):
        ax.set_axis_off()
        ax.set_aspect("equal")
    return [figure, *np.ravel(axes)]


def arrow(ax: Any, start: tuple[float, float], end: tuple[float, float]) -> None:
    ax.annotate("", end, start, arrowprops={"arrowstyle": "->", **EDGE})


def line_of_elements() -> None:
    """A ball on a half-space, and its profile on a row of elements."""
    figure, left, right = canvas(2, 3.2)
    x = np.linspace(-1.0, 1.0, 201)
    for ax, curvature, name in (
        (left, 0.5, "$f(r)=r^2/2R$"),
        (right, 1.0, "$g(x)=x^2/R$"),
    ):
        ax.fill_between(x, curvature * x**2 - 0.25, 1.05, color=BODY)
        ax.plot(x, curvature * x**2 - 0.25, **EDGE)
        ax.text(0, 0.75, name, ha="center")
        ax.set(xlim=(-1.15, 1.15), ylim=(-1.0, 1.1))
    a = 0.5
    surface = np.where(np.abs(x) < a, 0.5 * x**2 - 0.25, -0.03 / np.maximum(x**2, a**2))
    left.fill_between(x, surface, -1.0, color=RUBBER)
    left.plot(x, np.minimum(surface, 0.5 * x**2 - 0.25), **EDGE)
    arrow(right, (-0.25, 0.5), (0.25, 0.5))
    right.text(0.31, 0.5, "$v$", va="center")
    left.set_title("Body on a half-space")
    ahead, behind = 0.5, 0.32
    for place in np.arange(-0.95, 1.0, 0.1):
        free = 0.0
        if place < -behind:  # recovers
            free = (behind**2 - 0.25) * np.exp((place + behind) / 0.3)
        touches = -behind < place < ahead
        top = place**2 - 0.25 if touches else free
        colour = CONTACT if touches else "#1f5a94"
        coil = np.linspace(-1.0, top - 0.05, 41)
        wave = 0.025 * np.sin(np.linspace(0, 10 * np.pi, 41))
        right.plot(place + wave, coil, color=colour, lw=0.9)
        right.plot([place - 0.045, place + 0.045], [top - 0.03] * 2, color=colour, lw=3)
    right.annotate(
        "$-b$", (-behind, -0.13), (-0.62, 0.22), arrowprops={"arrowstyle": "-"}
    )
    right.annotate("$a$", (ahead, 0.02), (0.75, 0.12), arrowprops={"arrowstyle": "-"})
    right.set_title("Its profile on the line")
    figure.savefig(FIGURES / "sketch_line.png")
    plt.close(figure)


def scales() -> None:
    """The same line seen with ever shorter waves, and what is still in contact."""
    figure, ax = canvas(1, 3.0)
    x = np.linspace(0.0, 1.0, 4001)
    height, touches = np.zeros_like(x), np.ones_like(x, bool)
    shares = []
    for row, (wave, phase, most) in enumerate(
        ((2, -0.8, 0.62), (14, 0.6, 0.55), (110, 2.0, 0.5))
    ):
        height = height + np.cos(2 * np.pi * wave * x + phase) / (2.4 * wave)
        local = np.cos(2 * np.pi * wave * x + phase)
        touches = touches & (local > np.cos(np.pi * most))
        shares.append(touches.mean())
        base = -0.62 * row
        ax.fill_between(4 * x, base - 0.32, base + height * 0.9, color=BODY)
        ax.plot(4 * x, base + height * 0.9, color="#222222", lw=0.8)
        marked = np.where(touches, base + height * 0.9, np.nan)
        ax.plot(4 * x, marked, color=CONTACT, lw=2.5 - 0.5 * row)
        ax.text(
            4.1,
            base,
            f"waves up to $q_{row + 1}$: $P={shares[-1]:.2f}$",
            va="center",
        )
    ax.set(xlim=(0, 5.6), ylim=(-1.65, 0.4))
    figure.savefig(FIGURES / "sketch_scales.png")
    plt.close(figure)


def compliance(z: np.ndarray, poisson: float) -> np.ndarray:
    """W(kh) of a bonded layer, section 10."""
    kappa = 3 - 4 * poisson
    above = 2 * kappa * np.sinh(2 * z) - 4 * z
    return above / (2 * kappa * np.cosh(2 * z) + 1 + kappa**2 + 4 * z**2)


def layer() -> None:
    """A cylinder on a layer, and the compliance of the layer wave by wave."""
    figure, left, right = canvas(2, 3.0)
    x = np.linspace(-1.3, 1.3, 301)
    body = 1.2 - np.sqrt(np.maximum(1.44 - x**2, 0)) - 0.12
    bulge = 0.035 * (
        np.exp(-(((x - 0.75) / 0.2) ** 2)) + np.exp(-(((x + 0.6) / 0.2) ** 2))
    )
    surface = np.where((x > -0.45) & (x < 0.55), body, bulge)
    left.fill_between(x, body, 1.0, where=body < 1.0, color=BODY)
    left.plot(x, np.where(body < 1.0, body, np.nan), **EDGE)
    left.fill_between(x, np.minimum(surface, body), -0.5, color=RUBBER)
    left.fill_between(x, -0.5, -0.62, color="#888888", hatch="///", lw=0)
    arrow(left, (-0.25, 0.55), (0.25, 0.55))
    left.text(0.31, 0.55, "$v$", va="center")
    left.annotate("", (-1.15, 0.0), (-1.15, -0.5), arrowprops={"arrowstyle": "<->"})
    left.text(-1.1, -0.25, "$h$", va="center")
    left.text(0.0, -0.32, "rubber, bonded to a rigid base", ha="center")
    left.set(xlim=(-1.4, 1.4), ylim=(-0.65, 1.05))
    right.set_axis_on()
    right.set_aspect("auto")
    z = np.geomspace(0.1, 10, 200)
    right.loglog(z, compliance(z, 0.5), label="bonded, incompressible")
    right.loglog(z, compliance(z, 0.45), label="bonded, Poisson's ratio 0.45")
    slipping = (np.cosh(2 * z) - 1) / (np.sinh(2 * z) + 2 * z)
    right.loglog(z, slipping, "--", label="slipping base")
    right.set(xlabel="$kh$", ylabel="$W$", ylim=(5e-4, 2))
    right.legend(loc="lower right")
    figure.savefig(FIGURES / "sketch_layer.png")
    plt.close(figure)


if __name__ == "__main__":
    plt.style.use("elastomdr.figures")
    line_of_elements()
    scales()
    layer()
