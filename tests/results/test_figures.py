"""Figures of friction and rolling: what they show, and that nothing overlaps."""

import dataclasses

import matplotlib.figure
import numpy as np
import pytest

import elastomdr as em
from elastomdr.results.curve import FrictionCurve
from elastomdr.results.plotting import saved

from ..refused import refused
from .test_results import INPUTS, KELVIN, MODEL, VELOCITY, friction_curve, rolling_curve


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
    assert MODEL.partition(" (")[0] in texts
    assert ax.get_legend() is None
    assert not ax.collections  # an error of 1e-9 cannot be seen
    line, peak = ax.get_lines()
    np.testing.assert_array_equal(line.get_ydata(), friction_curve().mu)
    assert (peak.get_xdata()[0], peak.get_ydata()[0]) == (
        pytest.approx(0.01),
        pytest.approx(0.5),
    )


def test_figure_of_several_curves():
    ax = drawn(
        rolling_curve(temperature=KELVIN[:, None], error=0.05, failed=[0, 1]),
        title="A title",
    )
    assert ax.get_title(loc="left") == "A title"
    assert ax.get_ylabel() == "Rolling resistance coefficient [-]"
    assert ax.get_xlabel() == "Rolling velocity [m/s]"
    assert legend(ax) == ["0 °C", "20 °C", "40 °C", "numerical error"]
    assert len(ax.collections) == 3
    (sentence,) = ax.texts
    assert "6 of 99 points" in sentence.get_text().replace("\n", " ")


def test_of_many_curves_over_two_parameters_some_are_drawn_and_the_figure_says_so():
    load = np.array([10.0, 20.0, 40.0])[:, None, None]
    result = rolling_curve(temperature=KELVIN[:, None], load=load)
    ax = drawn(result)
    assert legend(ax) == [
        f"{newton:g} N, {celsius:g} °C"
        for newton, celsius in ((10, 20), (20, 0), (20, 20), (20, 40), (40, 20))
    ]
    assert "5 of 9 curves drawn" in ax.texts[0].get_text().replace("\n", " ")
    eight = drawn(rolling_curve(temperature=np.linspace(273.0, 313.0, 9)[:, None]))
    assert len(legend(eight)) == 9  # of one parameter all


def test_band_is_the_whole_uncertainty():
    plain = friction_curve(error=0.01)
    bound = np.where(VELOCITY > 1e-2, np.nan, 0.04)
    for model_error, half, words in (
        (None, np.full(VELOCITY.size, 0.01), "numerical error"),
        (
            np.full(VELOCITY.size, 0.04),
            np.full(VELOCITY.size, 0.05),
            "numerical and model error",
        ),
        (
            bound,
            np.where(VELOCITY > 1e-2, np.nan, 0.05),
            "numerical and model error",
        ),
        (
            np.full(VELOCITY.size, np.nan),
            np.full(VELOCITY.size, 0.01),
            "numerical error (the model's is not known)",
        ),
    ):
        curve = dataclasses.replace(plain, model_error=model_error)
        ax = drawn(curve)
        (band,) = ax.collections
        edges = band.get_paths()[0].vertices
        for x, mu, width in zip(VELOCITY, curve.mu, half, strict=True):
            at = edges[np.isclose(edges[:, 0], x, rtol=1e-12), 1]
            if np.isnan(width):  # a numerical error alone would be too small
                assert not at.size
                continue
            assert at.max() == pytest.approx(mu + width, rel=1e-12)
            assert at.min() == pytest.approx(max(mu - width, 0.0), rel=1e-12, abs=1e-12)
        assert legend(ax)[0] == words


def test_the_band_that_is_printed_is_not_negative():
    curve = friction_curve(error=0.01)
    wide = dataclasses.replace(curve, model_error=2 * curve.mu)
    assert dict(wide.headline())["how sure"].startswith("0 to ")


def test_band_of_a_point_and_of_an_unknown_error():
    curve = friction_curve(velocity=0.01, error=0.05)
    _, bar = drawn(curve).get_lines()
    ends = curve.mu - 0.05, curve.mu + 0.05
    np.testing.assert_allclose(bar.get_ydata()[:2], ends)
    assert not drawn(friction_curve(error=np.nan)).collections


def test_band_of_computed_curves():
    road = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=1e4)
    for shape, how in (
        (road, {"pressure": 1e5}),
        (em.Paraboloid(5e-3), {"load": 10.0}),
    ):
        curve = em.friction(
            em.StandardSolid(1e6, 9e6, 1e-4),
            shape,
            velocity=np.geomspace(1e-2, 10, 12),
            rtol=1e-4,
            **how,
        )
        whole = curve.error + np.nan_to_num(curve.model_error)
        bands = drawn(curve).collections
        assert len(bands) == int((whole > 0.004 * curve.mu.max()).any())
        for band in bands:
            assert band.get_paths()[0].vertices[:, 1].max() == pytest.approx(
                (curve.mu + whole).max(), rel=1e-9
            )


def test_figure_on_given_axes_and_along_other_axes():
    figure = matplotlib.figure.Figure()
    given = figure.add_subplot()
    assert friction_curve().plot(given) is given
    warm = drawn(friction_curve(velocity=0.01, temperature=KELVIN))
    assert warm.get_xlabel() == "Temperature [°C]"
    assert warm.get_xscale() == "linear"
    assert warm.get_lines()[-1].get_xdata() == pytest.approx(20.0)  # the peak
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
    boxes = [
        t.get_window_extent()
        for t in [*ax.texts, ax.title, ax._left_title]
        if t.get_text()
    ]
    legend = ax.get_legend()
    boxes += [legend.get_window_extent()] if legend else []
    for i, box in enumerate(boxes):
        assert box.x0 >= frame.x0 - 1
        assert box.x1 <= frame.x1 + 1
        assert box.y1 <= frame.y1 + 1
        assert not any(box.overlaps(other) for other in boxes[:i])


def width(png):
    assert png.startswith(b"\x89PNG")
    return int.from_bytes(png[16:20], "big")


def test_png_is_as_wide_as_its_style_says():
    # 5.2 inches at 200 dots per inch
    assert width(saved(friction_curve().plot(title="A title"))) == 1040
    for curve in (friction_curve(), friction_curve(temperature=KELVIN[:, None])):
        assert width(saved(curve.plot(style="paper"))) == pytest.approx(
            85 / 25.4 * 300, abs=1
        )
    with refused("style", '"paper"', "'slide'"):
        friction_curve().plot(style="slide")
    with refused("ax", "matplotlib Axes"):
        friction_curve().plot("paper")


@pytest.mark.parametrize(
    "kelvin", [None, KELVIN[:, None], np.linspace(270, 320, 9)[:, None]]
)
def test_a_figure_for_a_paper_has_no_title_and_nothing_is_cut_off(kelvin):
    ax = drawn(
        friction_curve(temperature=kelvin, error=0.02, failed=[0]), style="paper"
    )
    assert ax.get_title(loc="left") == ""
    assert not ax.texts
    box, frame = ax.get_tightbbox(), ax.figure.bbox  # with ticks, labels and legend
    assert box.x0 >= frame.x0 - 1
    assert box.x1 <= frame.x1 + 1
    assert box.y0 >= frame.y0 - 1
    assert box.y1 <= frame.y1 + 1
    assert (
        drawn(friction_curve(), style="paper", title="Mine").get_title(loc="left")
        == "Mine"
    )


def legend(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


def test_several_results_on_the_same_axes_are_named_by_what_they_differ_in():
    def curve(**inputs):
        return dataclasses.replace(
            friction_curve(error=0.05), inputs=tuple({**dict(INPUTS), **inputs}.items())
        )

    ax = curve().plot(style="paper")
    assert ax.get_legend() is None
    curve(load="20 N").plot(ax=ax)
    assert legend(ax) == ["10 N", "20 N"]
    curve(load="20 N", material="sbr").plot(ax)
    assert legend(ax) == ["nbr, 10 N", "nbr, 20 N", "sbr, 20 N"]
    curve().plot(ax, label="mine")
    assert legend(ax) == ["nbr, 10 N", "nbr, 20 N", "sbr, 20 N", "mine"]
    lines = [line for line in ax.get_lines() if len(line.get_xdata()) > 1]
    assert len({line.get_color() for line in lines}) == 4
    ax.clear()
    curve(material="sbr").plot(ax)
    assert ax.get_legend() is None

    ax = curve().plot()
    assert ax.get_title(loc="left") == "Friction, nbr"
    curve(material="sbr").plot(ax)
    assert ax.get_title(loc="left") == "Friction"  # of more than one material
    assert legend(ax) == ["nbr", "numerical error", "sbr"]
    dataclasses.replace(curve(), model="another model (a test)").plot(ax)
    assert legend(ax) == [
        "nbr, bare MDR line",
        "numerical error",
        "sbr, bare MDR line",
        "nbr, another model",
    ]


def test_materials_are_told_apart_by_name():
    many = FrictionCurve.stack(
        [friction_curve(temperature=KELVIN[:2, None])] * 2, ["nbr", "sbr"]
    )
    assert legend(many.plot(style="paper")) == [
        "nbr, 0 °C",
        "nbr, 20 °C",
        "sbr, 0 °C",
        "sbr, 20 °C",
    ]
    assert legend(many.plot(style="paper", label="new"))[3] == "new, sbr, 20 °C"


def test_measured_points_take_the_colour_of_their_temperature():
    measured = {
        "velocity": [1e-3, 1e-2, 1e-1],
        "mu": [0.1, 0.7, 0.2],
        "temperature": [273.15, 294.0, 350.0],
    }
    ax = drawn(friction_curve(temperature=KELVIN[:, None]), measured=measured)
    labels = {
        line.get_label(): line
        for line in ax.get_lines()
        if str(line.get_label()).startswith("measured")
    }
    assert set(labels) == {
        "measured, 0 °C",
        "measured, 20 °C",
        "measured, 76.85 °C (no curve)",
    }
    assert labels["measured, 76.85 °C (no curve)"].get_xdata()[0] == 0.1
    assert ax.get_ylim()[1] > 0.7
    curves = [line for line in ax.get_lines() if len(line.get_xdata()) > 1]
    assert (
        labels["measured, 20 °C"].get_color()
        is not labels["measured, 0 °C"].get_color()
    )
    np.testing.assert_array_equal(
        labels["measured, 20 °C"].get_color(), curves[1].get_color()
    )
    grid = {
        "velocity": [1e-3, 1e-2],
        "temperature": [[273.15], [294.0]],
        "mu": [[0.1, 0.2], [0.3, 0.4]],
    }
    lines = drawn(
        friction_curve(temperature=KELVIN[:, None]), measured=grid
    ).get_lines()
    points = {str(line.get_label()): list(line.get_ydata()) for line in lines}
    assert (points["measured, 0 °C"], points["measured, 20 °C"]) == (
        [0.1, 0.2],
        [0.3, 0.4],
    )
    warm = 333.15 + np.array([0.0, 20.4, 0.6, 19.6, -0.6])
    elsewhere = {
        "velocity": np.full(5, 1e-2),
        "mu": 0.1 * np.arange(1, 6),
        "temperature": warm,
    }
    lines = drawn(
        friction_curve(temperature=KELVIN[:, None]), measured=elsewhere
    ).get_lines()
    points = {str(line.get_label()): list(line.get_ydata()) for line in lines}
    away = points["measured, 59.4 to 80.4 °C (no curve)"]
    np.testing.assert_allclose(away, elsewhere["mu"])
    bare = {"velocity": [1e-2], "mu": [0.1]}
    assert (
        legend(drawn(friction_curve(temperature=KELVIN[:, None]), measured=bare))[-1]
        == "measured"
    )
    for bad in (
        {"velocity": [1.0]},
        {"velocity": [1.0, 2.0, 3.0], "mu": [1.0, 2.0]},
        {"velocity": [-1.0], "mu": [1.0]},
        3.0,
    ):
        with pytest.raises(em.InputError, match="measured"):
            friction_curve().plot(measured=bad)


def test_figure_of_a_surface():
    surface = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=4e4, q_rolloff=3e3)
    line, spectrum = surface.plot(seed=3)
    height = line.get_lines()[0].get_ydata()
    np.testing.assert_allclose(height.std(), 1e6 * surface.rms_height, rtol=1e-9)
    np.testing.assert_array_equal(spectrum.get_lines()[0].get_xdata(), surface.q)
    assert (line.get_xlabel(), spectrum.get_xlabel()) == (
        "Position on the line [mm]",
        "Wave number q [rad/m]",
    )


def test_quantities_of_one_unit_share_axes_and_others_are_refused():
    friction, rolling = friction_curve(), rolling_curve()
    ax = friction.plot(style="paper")
    rolling.plot(ax)
    assert ax.get_ylabel() == "Friction coefficient, rolling resistance coefficient [-]"
    assert ax.get_xlabel() == "Sliding velocity, rolling velocity [m/s]"
    assert [text.partition(",")[0] for text in legend(ax)] == [
        "friction coefficient",
        "rolling resistance coefficient",
    ]
    lines = len(ax.get_lines())
    rubber, ball = em.StandardSolid(1e6, 4e6, 1e-2), em.Paraboloid(5e-3)
    pressed = em.indent(rubber, ball, time=[0.0, 1.0], depth=[0.0, 1e-4])
    with refused("ax", "result"):
        pressed.plot(ax)
    assert len(ax.get_lines()) == lines  # nothing was drawn


def test_a_figure_to_point_at_has_the_same_curves():
    pytest.importorskip("plotly")
    curve = em.friction(
        em.load_material("silicone-like"),
        em.Sphere(1e-2),
        velocity=[1e-3, 1e-2, 0.1],
        load=1.0,
        temperature=np.array([[283.15], [303.15]]),
    )
    points = {"velocity": [0.1], "mu": [0.2], "temperature": [303.15]}
    figure = curve.interactive(title="Balls", measured=points)
    curves = [trace for trace in figure.data if trace.mode == "lines"]
    np.testing.assert_array_equal([trace.y for trace in curves], curve.mu)
    assert [trace.name[:5] for trace in curves] == ["10 °C", "30 °C"]
    assert figure.layout.xaxis.type == "log"
    assert figure.layout.xaxis.title.text == "Sliding velocity [m/s]"
    assert figure.layout.title.text.split("<br>")[0] == "Balls"
    (measured,) = (each for each in figure.data if each.name == "measured, 30 °C")
    assert (measured.mode, measured.marker.symbol) == ("markers", "circle-open")
    assert (measured.x, measured.y) == ((0.1,), (0.2,))
    assert sum(bool(trace.showlegend) for trace in figure.data) == 3
    spectrum = em.friction_spectrum(
        em.load_material("epdm-70"),
        em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=1e5),
        velocity=0.1,
        pressure=3e5,
        temperature=293.15,
    )
    (steps,) = spectrum.interactive().data
    per_decade = np.ravel(spectrum.mu) / np.log10(spectrum.width)
    np.testing.assert_allclose(steps.y, np.repeat(per_decade, 2))


def test_figures_name_rubbers_whose_moduli_are_illustrative():
    def friction(*names):
        rubbers = [em.load_material(name) for name in names]
        given = rubbers if len(rubbers) > 1 else rubbers[0]
        return em.friction(given, em.Sphere(1e-2), velocity=[0.1, 1.0], load=1.0)

    def above(axes):
        return " ".join(" ".join(words.get_text() for words in axes.texts).split())

    assert "illustrative moduli" in above(friction("silicone-like").plot())
    assert "illustrative" not in above(friction("epdm-70").plot())
    pytest.importorskip("plotly")
    figure = friction("silicone-like").interactive()
    assert "illustrative moduli" in figure.layout.title.text
    ranking = friction("silicone-like", "epdm-70").ranking()
    assert "silicone-like: illustrative moduli" in above(ranking.plot())
    assert "silicone-like, illustrative" in ranking.summary()
    assert "illustrative" not in friction("epdm-70", "psa-468mp").ranking().summary()


def test_a_ring_on_a_rod_says_that_its_rubber_is_illustrative():
    rubber = em.load_material("silicone-like")
    ring = em.o_ring(rubber, diameter=5e-3, squeeze=0.2, time=300.0)
    motion = {"velocity_out": [0.1, 1.0], "velocity_in": 0.1, "stroke": 0.1}
    strokes = em.reciprocating(rubber, o_ring=ring, viscosity=0.05, **motion)
    words = " ".join(text.get_text() for text in strokes.plot().texts)
    assert "illustrative moduli" in words
    assert "no particular rubber" in strokes.summary()


def test_two_axes_are_told_apart_by_colour_and_line():
    """Temperature by colour, load by line; where the loads are more than there are
    lines, the other way round.
    """
    rubber = em.load_material("epdm-70")

    def looks(temperatures, loads):
        curve = em.rolling(
            rubber,
            em.Cylinder(0.05, 0.1),
            velocity=[0.1, 1.0],
            load=np.linspace(300.0, 900.0, loads)[:, None],
            temperature=np.linspace(283.15, 303.15, temperatures)[:, None, None],
        )
        lines = [each for each in curve.plot().lines if len(each.get_xdata()) > 1]
        drawn = [(each.get_color(), each.get_linestyle()) for each in lines]
        many = temperatures * loads > 8  # of which some are drawn
        count = temperatures + loads - 1 if many else temperatures * loads
        assert len(set(drawn)) == len(drawn) == count
        return [len(set(each)) for each in zip(*drawn, strict=True)]

    assert looks(4, 3) == [4, 3]
    assert looks(2, 4) == [4, 2]
    assert looks(4, 4) == [7, 1]
