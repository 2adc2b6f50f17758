"""Figures of friction and rolling: what they show, and that nothing overlaps."""

from pathlib import Path

import matplotlib.figure
import numpy as np
import pytest

import elastomdr as em
from elastomdr.results.figure import save

from .test_results import KELVIN, MODEL, VELOCITY, friction_curve, rolling_curve


def drawn(curve, **options):
    ax = curve.plot(**options)
    ax.figure.draw_without_rendering()
    return ax


def test_figure_of_one_curve():
    ax = drawn(friction_curve())
    assert ax.get_xscale() == "log"
    assert ax.get_xlabel() == "Sliding velocity [m/s]"
    assert ax.get_ylabel() == "Friction coefficient [-]"
    assert ax.get_title(loc="left") == "Friction, nbr"
    texts = [t.get_text() for t in ax.texts]
    assert MODEL in texts
    assert "peak 0.5 at 0.01 m/s" in texts
    assert ax.get_legend() is None
    assert not ax.collections  # an error of 1e-9 cannot be seen
    line, peak = ax.get_lines()
    np.testing.assert_array_equal(line.get_ydata(), friction_curve().mu)
    assert (peak.get_xdata()[0], peak.get_ydata()[0]) == (pytest.approx(0.01), pytest.approx(0.5))


def test_figure_of_several_curves():
    ax = drawn(rolling_curve(temperature=KELVIN[:, None], error=0.05, failed=[0, 1]), title="A title")
    assert ax.get_title(loc="left") == "A title"
    assert ax.get_ylabel() == "Rolling resistance coefficient [-]"
    assert ax.get_xlabel() == "Rolling velocity [m/s]"
    labels = [t.get_text() for t in ax.get_legend().get_texts()]
    assert [label.split(":")[0] for label in labels] == ["0 °C", "20 °C", "40 °C"]
    assert len(ax.collections) == 3
    note = "6 of 99 points did not converge and are left out; shaded: estimated numerical error"
    assert note in [t.get_text() for t in ax.texts]


def test_figure_on_given_axes_and_along_other_axes():
    figure = matplotlib.figure.Figure()
    given = figure.add_subplot()
    assert friction_curve().plot(given) is given
    warm = drawn(friction_curve(velocity=0.01, temperature=KELVIN))
    assert warm.get_xlabel() == "Temperature [K]"
    assert warm.get_xscale() == "linear"
    assert "peak 0.5 at 20 °C" in [t.get_text() for t in warm.texts]
    point = drawn(friction_curve(velocity=0.01))
    assert len(point.get_lines()) == 1
    unordered = drawn(friction_curve(velocity=VELOCITY[::-1]))
    assert (np.diff(unordered.get_lines()[0].get_xdata()) > 0).all()
    crowd = drawn(friction_curve(temperature=np.linspace(270, 320, 40)[:, None]))
    assert len(crowd.get_legend().get_texts()) == 12
    drawn(friction_curve(failed=range(33)))


@pytest.mark.parametrize("title", ["Short", "A long title " * 12])
@pytest.mark.parametrize("kelvin", [None, KELVIN[:, None]])
def test_nothing_overlaps_or_leaves_the_figure(title, kelvin):
    curve = friction_curve(temperature=kelvin, failed=[0])
    ax = drawn(curve, title=title)
    frame = ax.figure.bbox
    boxes = [t.get_window_extent() for t in [*ax.texts, ax.title, ax._left_title] if t.get_text()]
    legend = ax.get_legend()
    boxes += [legend.get_window_extent()] if legend else []
    for i, box in enumerate(boxes):
        assert box.x0 >= frame.x0 - 1
        assert box.x1 <= frame.x1 + 1
        assert box.y1 <= frame.y1 + 1
        assert not any(box.overlaps(other) for other in boxes[:i])


def test_saved_figure_is_a_png_of_200_dpi(tmp_path):
    save(friction_curve(), tmp_path / "figure.png", "A title")
    content = Path(tmp_path / "figure.png").read_bytes()
    assert content.startswith(b"\x89PNG")
    assert int.from_bytes(content[16:20], "big") == 1320  # 6.6 inches
    with pytest.raises(em.InputError, match="can be written"):
        save(friction_curve(), tmp_path / "missing" / "figure.png")


def test_a_second_curve_on_the_same_axes_goes_into_the_legend():
    ax = friction_curve().plot()
    title, texts = ax.get_title(loc="left"), len(ax.texts)
    friction_curve(load=20.0).plot(ax=ax)
    friction_curve(load=30.0).plot(ax=ax, label="the other one")
    assert (ax.get_title(loc="left"), len(ax.texts)) == (title, texts)
    first, second = (text.get_text() for text in ax.get_legend().get_texts())
    assert first.startswith("nbr: peak")
    assert second.startswith("the other one: peak")
    lines = [line for line in ax.get_lines() if len(line.get_xdata()) > 1]
    assert len({line.get_color() for line in lines}) == 3


def test_measured_points_take_the_colour_of_their_temperature():
    measured = {"velocity": [1e-3, 1e-2, 1e-1], "mu": [0.1, 0.7, 0.2], "temperature": [273.15, 294.0, 350.0]}
    ax = drawn(friction_curve(temperature=KELVIN[:, None]), measured=measured)
    labels = {line.get_label(): line for line in ax.get_lines() if str(line.get_label()).startswith("measured")}
    assert set(labels) == {"measured, 0 °C", "measured, 20 °C", "measured"}
    assert labels["measured"].get_xdata()[0] == 0.1
    assert ax.get_ylim()[1] > 0.7
    curves = [line for line in ax.get_lines() if len(line.get_xdata()) > 1]
    assert labels["measured, 20 °C"].get_color() is not labels["measured, 0 °C"].get_color()
    np.testing.assert_array_equal(labels["measured, 20 °C"].get_color(), curves[1].get_color())
    grid = {"velocity": [1e-3, 1e-2], "temperature": [[273.15], [294.0]], "mu": [[0.1, 0.2], [0.3, 0.4]]}
    lines = drawn(friction_curve(temperature=KELVIN[:, None]), measured=grid).get_lines()
    points = {str(line.get_label()): list(line.get_ydata()) for line in lines}
    assert (points["measured, 0 °C"], points["measured, 20 °C"]) == ([0.1, 0.2], [0.3, 0.4])
    for bad in ({"velocity": [1.0]}, {"velocity": [1.0], "mu": [1.0, 2.0]}, {"velocity": [-1.0], "mu": [1.0]}, 3.0):
        with pytest.raises(em.InputError, match="measured"):
            friction_curve().plot(measured=bad)


def test_figure_of_a_surface():
    surface = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=4e4, q_rolloff=3e3)
    line, spectrum = surface.plot(seed=3)
    height = line.get_lines()[0].get_ydata()
    np.testing.assert_allclose(height.std(), 1e6 * surface.rms_height, rtol=1e-9)
    np.testing.assert_array_equal(spectrum.get_lines()[0].get_xdata(), surface.q)
    assert (line.get_xlabel(), spectrum.get_xlabel()) == ("Position on the line [mm]", "Wave number q [rad/m]")
    x = np.linspace(0, 1e-3, 64, endpoint=False)
    _, waves = em.RoughLine(x, 1e-6 * np.cos(2 * np.pi * 3 * x / 1e-3)).plot()
    q, power = waves.get_lines()[0].get_data()
    assert q[np.nanargmax(power)] == pytest.approx(6000 * np.pi)
    np.testing.assert_allclose(2 * np.nansum(power) * 2000 * np.pi, 0.5e-12, rtol=1e-9)  # both sides: <h^2>
