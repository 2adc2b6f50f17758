"""Results: tables that other programs read back, figures that say what they show, text
that stays true.
"""

import base64
import dataclasses
import html
import importlib
import pkgutil
import warnings

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pandas as pd
import pytest

import elastomdr as em
import elastomdr.results
from elastomdr.results.base import Result
from elastomdr.results.curve import Contact, FrictionCurve, RollingCurve
from elastomdr.results.words import in_words

from ..refused import mentions, refused

MODEL = "bare MDR line (a test)"
INPUTS = (("material", "nbr"), ("shape", "sphere, radius 0.005"), ("load", "10 N"))
VELOCITY = np.geomspace(1e-6, 1e2, 33)  # its middle is 0.01
KELVIN = np.array([273.15, 293.15, 313.15])


def friction_curve(
    velocity=VELOCITY, temperature=None, load=10.0, error=1e-9, failed=(), plan="a plan"
):
    """mu = z/(1 + z^2) with z = v a_T/(1 cm/s) and one decade of a_T per 20 K: a peak
    of 0.5 at z = 1.
    """
    given = np.broadcast_arrays(
        velocity, KELVIN[1] if temperature is None else temperature, load
    )
    v, kelvin, force = (np.array(x, dtype=float) for x in given)
    z = v * 10 ** ((KELVIN[1] - kelvin) / 20) / 1e-2
    mu = np.array(z / (1 + z**2))
    for i in failed:
        mu[..., i] = np.nan
    converged = np.isfinite(mu)
    edge = Contact(1e-3 * force, 0.5e-3 * force)
    return FrictionCurve(
        velocity=v,
        mu=mu,
        normal_force=force * (1 + 1e-9 * mu),  # as a load that was searched for
        friction_force=mu * force,
        depth=1e-4 * (1 + mu),
        contact=edge,
        error=np.where(converged, error, np.nan),
        converged=converged,
        temperature=None if temperature is None else kelvin,
        model=MODEL,
        plan=plan,
        inputs=INPUTS,
    )


def rolling_curve(**changes):
    c = friction_curve(**changes)
    return RollingCurve(
        velocity=c.velocity,
        coefficient=c.mu,
        resistance=c.friction_force,
        moment=5e-3 * c.friction_force,
        power=c.velocity * c.friction_force,
        normal_force=c.normal_force,
        depth=c.depth,
        contact=c.contact,
        error=c.error,
        converged=c.converged,
        temperature=c.temperature,
        model=c.model,
        plan=c.plan,
        inputs=c.inputs,
    )


def test_csv_reads_back_the_same_numbers(tmp_path):
    curve = friction_curve(temperature=KELVIN[:, None], failed=[3])
    curve.to_csv(tmp_path / "curve.csv")
    table = pd.read_csv(tmp_path / "curve.csv", comment="#")
    assert list(table) == list(curve.columns())
    assert list(table)[:3] == [
        "velocity [m/s]",
        "temperature [K]",
        "friction coefficient [-]",
    ]
    assert (table.dtypes.iloc[:-1] == [float] * 9 + [bool]).all()
    columns = curve.columns()
    names = columns.pop("doubts")
    assert (table.pop("doubts").fillna("") == names).all()
    assert (names == np.where(curve.converged.ravel(), "", "not converged")).all()
    for title, values in columns.items():
        np.testing.assert_allclose(table[title], values, rtol=1e-15)
    assert table["friction coefficient [-]"].isna().sum() == 3
    rows = [
        line
        for line in (tmp_path / "curve.csv").read_text().splitlines()
        if not line.startswith("#")
    ]
    assert len(rows) == 1 + 99
    numbers = np.array(
        [[float(cell or "nan") for cell in row.split(",")[:-2]] for row in rows[1:]]
    )
    # to the last bit
    np.testing.assert_array_equal(numbers.T, list(curve.columns().values())[:-2])


def test_csv_header_says_what_the_numbers_are():
    curve = friction_curve(failed=[0])
    inputs = (*curve.inputs, ("scene", "a\nb"))
    header = [
        line
        for line in dataclasses.replace(curve, inputs=inputs).csv().splitlines()
        if line[0] == "#"
    ]
    assert all(line.startswith("# ") for line in header)
    text = "\n".join(header)
    for said in (
        em.__version__,
        MODEL,
        "material: nbr",
        "load: 10 N",
        "SI",
        "peak friction coefficient 0.5 at 0.01 m/s",
        "scene: a b",
    ):
        assert said in text
    assert "33, 1 did not converge" in text


def test_csv_is_whole_or_not_there(tmp_path):
    target = tmp_path / "curve.csv"
    target.mkdir()
    for path in (tmp_path / "missing" / "curve.csv", target, "bad\0name.csv"):
        with refused("path", "written") as raised:
            friction_curve().to_csv(path)
        assert "\n" not in str(raised.value)
    assert list(tmp_path.iterdir()) == [target]
    old = tmp_path / "old.csv"
    old.write_text("old")
    friction_curve().to_csv(old)
    assert old.read_text().startswith("# elastomdr")
    (tmp_path / "plain").touch()
    assert old.stat().st_mode == (tmp_path / "plain").stat().st_mode
    assert len(list(tmp_path.iterdir())) == 3


@pytest.mark.parametrize("make", [friction_curve, rolling_curve])
def test_dict_pandas_xarray_hold_the_same(make):
    curve = make(temperature=KELVIN[:, None])
    content = curve.to_dict()
    name = curve.shows
    assert content["model"] == MODEL
    assert content["plan"] == "a plan"
    assert content["inputs"]["load"] == "10 N"
    np.testing.assert_array_equal(content["leading"], curve.contact.leading)
    frame = curve.to_pandas()
    np.testing.assert_array_equal(frame["depth [m]"], curve.depth.ravel())
    assert frame.attrs["model"] == MODEL
    data = curve.to_xarray()
    assert dict(data.sizes) == {"temperature": 3, "velocity": 33}
    np.testing.assert_array_equal(
        data[name].sel(temperature=293.15), getattr(curve, name)[1]
    )
    assert data["velocity"].attrs["units"] == "m/s"
    assert data.attrs["material"] == "nbr"
    assert data.attrs["elastomdr"] == em.__version__


def test_missing_packages_are_named(monkeypatch):
    import sys

    for package, method in (("pandas", "to_pandas"), ("xarray", "to_xarray")):
        monkeypatch.setitem(sys.modules, package, None)
        with pytest.raises(
            em.InputError, match=rf"{package}.*pip install elastomdr\[tables\]"
        ):
            getattr(friction_curve(), method)()


def axis_names(curve):
    return [axis.name for axis in curve.axes()], [c.label for c in curve.curves()[1]]


def test_axes_are_named_after_what_changes_along_them():
    assert axis_names(friction_curve()) == (["velocity"], [""])
    assert axis_names(friction_curve(velocity=0.1)) == ([], [""])
    assert axis_names(friction_curve(temperature=KELVIN[:, None])) == (
        ["temperature", "velocity"],
        ["0 degC", "20 degC", "40 degC"],
    )
    both = friction_curve(
        temperature=KELVIN[:2, None, None], load=np.array([[1.0], [10.0]]), failed=[0]
    )
    assert axis_names(both) == (
        ["temperature", "load", "velocity"],
        ["0 degC, 1 N", "0 degC, 10 N", "20 degC, 1 N", "20 degC, 10 N"],
    )
    assert axis_names(friction_curve(velocity=0.1, temperature=KELVIN)) == (
        ["temperature"],
        [""],
    )
    # no axis of its own for velocity
    tied = friction_curve(velocity=VELOCITY * np.array([[1.0], [2.0]]))
    assert axis_names(tied)[0] == ["axis_0", "axis_1"]
    assert dict(tied.to_xarray().sizes) == {"axis_0": 2, "axis_1": 33}


def test_summary_finds_the_peak_and_the_ends():
    text = friction_curve().summary()
    assert mentions(text, 0.5, 0.01, "m/s", 0.0001)
    assert mentions(text, "33, all converged", 1e-09)
    assert MODEL in text
    rising = friction_curve(velocity=np.geomspace(1e-5, 1e-3, 5)).summary()
    assert "largest friction coefficient 0.099 at" in rising
    assert "the highest velocity computed" in rising
    falling = friction_curve(velocity=np.geomspace(1e2, 1.0, 5)).summary()
    # the order in which velocities are given does not matter
    assert mentions(falling, 0.01, 1, 0.0001, 100, "m/s")
    assert "none of the points converged" in friction_curve(failed=range(33)).summary()
    assert "33 did not converge" in friction_curve(failed=range(33)).summary()
    assert "coefficient 0.5" in friction_curve(velocity=0.01).summary()
    many = friction_curve(temperature=np.linspace(270, 320, 20)[:, None]).summary()
    assert "14 more curves" in many
    assert "peak rolling resistance coefficient 0.5 at" in rolling_curve().summary()


def test_headline_is_peak_band_and_doubts():
    """What a command prints: the largest value, its band, and each kind of doubt."""

    def headline(**changes):
        curve = friction_curve(error=0.01, failed=[0])
        return dict(dataclasses.replace(curve, **changes).headline())

    bound = np.full(VELOCITY.size, 0.04)
    said = headline(model_error=bound)
    assert mentions(said["peak"], 0.5, 0.01, "m/s", 0.0001, 100)
    assert mentions(said["how sure"], 0.45, 0.55, 2, "%", 8)
    assert said["rests on"].startswith("nbr; bare MDR line; ")
    assert mentions(said["rests on"], "moduli", "temperature")
    fitted = headline(
        inputs=(("material", "nbr"), ("material against its data", "1 %"))
    )
    assert mentions(fitted["rests on"], "temperature")
    assert "moduli" not in fitted["rests on"]
    assert mentions(said["doubts"], "not converged", "1 of 33", "bound")
    said = headline(model_error=np.where(VELOCITY < 1, np.nan, bound))
    assert "not known" in said["how sure"]
    assert "no prediction" in said["doubts"]
    said = headline(marks=(em.Doubt("extrapolated", VELOCITY > 1.0),))
    assert mentions(said["doubts"], "1 of 33", "extrapolated", "8 of 33")
    pressed = np.full(VELOCITY.size, 1e5)
    dry = headline(adhesion=0.2 * friction_curve().mu, pressure=pressed)
    assert mentions(dry["rests on"], "shear law", 20, "shortest wave", "heights")
    falling = dict(friction_curve(velocity=np.geomspace(1e2, 1.0, 5)).headline())
    assert mentions(falling["largest"], 1, "the lowest velocity", 0.0001, 100)
    both = FrictionCurve.stack([friction_curve()] * 2, ["nbr", "sbr"])
    assert "0.5 at nbr, 0.01 m/s" in dict(both.headline())["peak"]


def test_repr_is_readable_and_never_fails():
    assert repr(friction_curve()) == "FrictionCurve\n" + friction_curve().summary()
    assert repr(jax.tree.map(lambda x: None, friction_curve())).startswith(
        "FrictionCurve("
    )
    assert "shape (33,)" in repr(eqx.filter(friction_curve(), eqx.is_inexact_array))
    assert repr(jax.tree.map(lambda x: "?", rolling_curve())).startswith(
        "RollingCurve("
    )
    seen = []

    def under_jit(curve):
        seen.append((repr(curve), curve.summary()))
        with pytest.raises(em.InputError, match="outside jit, grad and vmap"):
            curve.columns()
        return curve

    back = jax.jit(under_jit)(friction_curve())
    assert seen[0][0] == seen[0][1]
    assert "shape (33,)" in seen[0][0]
    assert back.model == MODEL
    assert back.inputs == INPUTS
    assert "peak" in repr(back)


def test_curves_are_pytrees():
    curve = friction_curve(temperature=KELVIN[:, None])
    assert len(jax.tree.leaves(curve)) == 10
    doubled = jax.jit(
        lambda c: jax.tree.map(lambda x: x if x.dtype == bool else 2 * x, c)
    )(curve)
    np.testing.assert_allclose(doubled.mu, 2 * curve.mu, rtol=1e-6)
    rows = jax.vmap(lambda c: jnp.nanmax(c.mu))(curve)
    assert rows.shape == (3,)


def test_numbers_in_words():
    assert in_words("temperature", 238.15) == "-35 degC"
    assert in_words("temperature", 300.0) == "26.85 degC"
    assert in_words("depth", 1.2e-4) == "0.12 mm"
    assert in_words("load", 2000.0) == "2000 N"
    assert in_words("velocity", 1e-6) == "1e-06 m/s"


def test_a_computed_curve_is_such_a_result(tmp_path):
    rubber = em.StandardSolid(1e6, 3e6, 1e-2, name="test rubber")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        curve = em.friction(
            rubber,
            em.Paraboloid(5e-3),
            velocity=[0.01, 0.1, 1.0],
            load=10.0,
            model=em.Line(),
        )
    assert "test rubber" in repr(curve)
    assert curve.columns()["friction coefficient [-]"].shape == (3,)
    assert hash(jax.tree.structure(curve)) is not None
    curve.to_csv(tmp_path / "curve.csv")
    assert len(pd.read_csv(tmp_path / "curve.csv", comment="#")) == 3


def test_materials_are_a_first_axis(tmp_path):
    soft, hard = (
        friction_curve(temperature=KELVIN[:, None]),
        friction_curve(temperature=KELVIN[:, None], failed=[0]),
    )
    hard = dataclasses.replace(
        hard, model_error=hard.error, inputs=(*INPUTS[:2], ("load", "20 N"))
    )
    both = FrictionCurve.stack([soft, hard], ["soft", "hard"])
    assert both.mu.shape == (2, 3, 33)
    assert both.materials == ("soft", "hard")
    assert axis_names(both)[0] == ["material", "temperature", "velocity"]
    assert axis_names(both)[1][:2] == ["soft, 0 degC", "soft, 20 degC"]
    assert np.isnan(both.model_error[0]).all()  # not known for the first
    back = both.select("hard")
    assert dict(back.inputs) == {
        "material": "hard",
        "shape": INPUTS[1][1],
        "load": "20 N",
    }
    for one, other in ((both.select("soft"), soft), (back, hard)):
        assert jax.tree.structure(one) == jax.tree.structure(
            dataclasses.replace(other, inputs=one.inputs)
        )
        jax.tree.map(
            np.testing.assert_array_equal, jax.tree.leaves(one), jax.tree.leaves(other)
        )
    with refused("material", "'sofd'"):
        both.select("sofd")

    inputs = dict(both.inputs)
    assert inputs["material"] == "soft, hard"
    assert inputs["load"] == "soft: 10 N; hard: 20 N"
    assert "hard: at 20 degC" in both.summary()
    assert "198, 3 did not converge" in both.summary()
    both.to_csv(tmp_path / "both.csv")
    table = pd.read_csv(tmp_path / "both.csv", comment="#")
    assert list(table.groupby("material", sort=False).size().items()) == [
        ("soft", 99),
        ("hard", 99),
    ]
    data = both.to_xarray()
    np.testing.assert_array_equal(
        data["mu"].sel(material="soft", temperature=293.15), soft.mu[1]
    )
    assert both.to_dict()["material"] == ("soft", "hard")
    assert jax.jit(lambda c: c)(both).materials == both.materials

    assert FrictionCurve.stack([soft, soft], ["a", "a"]).materials == ("a", "a (2)")
    flat = friction_curve()
    for results, names, said in (
        ([soft, flat], ["a", "b"], "one shape"),
        ([flat, rolling_curve()], ["a", "b"], "one class"),
        ([flat], ["a", "b"], "2 names"),
        (
            [flat, dataclasses.replace(flat, contact=None)],
            ["a", "b"],
            "computed alike, 2 of them with contact",
        ),
    ):
        with pytest.raises(em.InputError, match=said):
            FrictionCurve.stack(results, names)


def test_what_only_some_materials_have():
    marks = (em.Doubt("extrapolated", VELOCITY > 1.0),)
    known = dataclasses.replace(friction_curve(), marks=marks)
    both = FrictionCurve.stack([known, friction_curve()], ["a", "b"])
    assert not both.extrapolated[1].any()
    assert "not known for b" in dict(both.inputs)["range of the data"]
    assert both.select("b").extrapolated is None


def test_spectra_of_unlike_length():
    def spectrum(n):
        share = np.full((2, n), 1 / n)
        time = np.geomspace(1e-3, 1.0, n) * np.ones((2, 1))
        return em.Dissipation(
            velocity=np.array([[1.0], [2.0]]) * np.ones(n),
            time=time,
            share=share,
            resistance=share,
            power=share,
            normal_force=10 * np.ones((2, n)),
            error=1e-9 * np.ones((2, n)),
            model_error=np.nan * np.ones((2, n)),
            converged=np.ones((2, n), bool),
            model=MODEL,
            plan="a plan",
            inputs=INPUTS,
        )

    both = em.Dissipation.stack([spectrum(3), spectrum(5)], ["a", "b"])
    assert both.share.shape == (2, 2, 5)
    assert len(both.to_pandas()) == 2 * 3 + 2 * 5
    assert dict(both.to_xarray().sizes) == {"material": 2, "velocity": 2, "branch": 5}
    assert both.select("a").share.shape == (2, 3)
    assert "4, all converged" in both.summary()
    assert len(both.plot().get_lines()) == 4


def test_excel_holds_the_table_and_what_it_is(tmp_path, monkeypatch):
    import sys

    import openpyxl

    curve = dataclasses.replace(
        friction_curve(failed=[3]), inputs=(("material", "=1+1"), ("note", "a\x01b"))
    )
    curve.to_excel(tmp_path / "curve.xlsx")
    book = openpyxl.load_workbook(tmp_path / "curve.xlsx")
    titles, *rows = book["result"].iter_rows(values_only=True)
    assert list(titles) == list(curve.columns())
    assert "not converged" in [row[-1] for row in rows]
    for i, values in enumerate(list(curve.columns().values())[:-2]):
        read = [np.nan if row[i] is None else row[i] for row in rows]
        np.testing.assert_allclose(
            np.array(read, dtype=float), values.astype(float), rtol=1e-15
        )
    told = {row[0].value: row[1] for row in book["inputs"].iter_rows()}
    assert told["material"].value == "=1+1"
    assert told["material"].data_type == "s"  # no formula
    assert told["model"].value == MODEL
    meaning = {row[1]: row for row in book["columns"].iter_rows(values_only=True)}
    assert meaning["contact.leading"][::2] == ("leading edge", "m")
    with refused("path", "curve.csv"):
        curve.to_excel(tmp_path / "curve.csv")
    with refused("path", "workbook"):
        curve.to_csv(tmp_path / "curve.xlsx")
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(
        em.InputError, match=r"openpyxl.*pip install elastomdr\[excel\]"
    ):
        curve.to_excel(tmp_path / "curve.xlsx")


def test_every_field_of_every_result_is_declared():
    """A number without a name and a unit would be in no table: fields are quantities,
    settings, or parts of these.
    """
    for name in (
        "Impact",
        "Indentation",
        "Slide",
        "Traction",
        "HeatBuildUp",
        "FrictionSpectrum",
        "Leak",
        "Lubricated",
        "BreakOut",
    ):
        getattr(em, name)  # loads it
    seen, names = [Result], []
    while seen:
        cls = seen.pop()
        seen += cls.__subclasses__()
        for f in dataclasses.fields(cls):
            plain = not {"quantity", "static"} & f.metadata.keys()
            names += [f"{cls.__name__}.{f.name}"] if plain else []
            q = f.metadata.get("quantity")
            assert q is None or (q.label and q.dims.startswith(("...", "")))
    parts = {name.partition(".")[2] for name in names}
    of_some = {"contact", "lines", "history", "oblique", "surface", "profile"}
    assert parts == {*of_some, "marks", "jump_in", "pull_off"}


UNITS = {  # of each quantity, whatever the result
    "-": (
        "adhesion after area area_ratio asperity asperity_share boundary coefficient cold "
        "creepage error fill friction hysteresis knudsen linear model_error mu mu_high mu_low outside "
        "ratio restitution road_share rolling rubber share slip spread squeeze stick strain "
        "trapped_error trapped_share value viscous work_factor zone_ratio"
    ),
    "m^2": "contact_area",
    "": "converged extrapolated follows other_states percolates stuck touching",
    "m/s": "edge_speed road slowest velocity velocity_in velocity_out",
    "K": "ambient contact_rise steady temperature temperature_rise",
    "N": "amplitude mean force friction_force friction_in friction_out max_force normal_force pull resistance",
    "W": "power slip_power",
    "m": (
        "approach approach_error contact_radius critical_gap depth diameter "
        "displacement drive film film_in film_in_error film_out film_thickness height leading least_film lifted max_depth mean_gap position separation "
        "stick_radius surface trailing width x"
    ),
    "s": "duration settling time",
    "Pa": (
        "asperity_pressure fluid_pressure outlet_pressure pressure pressure_drop "
        "sealing_pressure shear_stress"
    ),
    "Pa s": "viscosity",
    "m^3/s": "rate",
    "m^2/s": "flow",
    "m^3": "net_leak net_leak_error",
    "kg/s": "mass_rate",
    "rad/s": "omega",
    "rad/m": "wave_number",
    "N/m": "back carry friction_per_length line_load load load_per_length",
    "kg": "mass",
    "J": "dissipated given imbalance kinetic locked loop_energy lost slip_loss stored work",
    "N m": "moment",
    "W/m^2": "heat_flux",
    "N s/m": "slope",
    "kg/m": "belt goods",
    "W/K": "conductance",
    "1/m": "conductance_low",
    "Pa/m": "stiffness",
    "W/(m^2 K)": "thermal",
    "S/m^2": "electrical",
    "Hz": "frequency",
    "N^2/Hz": "density",
    "J/K": "capacity",
    "rad": "direction",
}
OTHERS = {
    "Shear.error": "N",
    "Shear.model_error": "N",
    "ForceSpectrum.error": "N",
    "ForceSpectrum.model_error": "N",
    "ORing.error": "N/m",
    "ORing.model_error": "N/m",
    "Leak.conductance": "m^3/(Pa s)",
    "Lubricated.load": "N",
    "Lubricated.imbalance": "-",
    "Reciprocating.error": "m",
    "Reciprocating.work": "J",
    "HeatBuildUp.error": "K",
    "HeatBuildUp.model_error": "K",
    "HeatBuildUp.load": "N",
    "RoughContact.conductance": "1/m",
    "Conveyor.resistance": "N/m",
    "Conveyor.power": "W/m",
}


def test_every_quantity_has_the_unit_of_what_it_is():
    """Columns are in SI, whatever a figure shows."""
    for module in pkgutil.iter_modules(elastomdr.results.__path__):
        importlib.import_module(f"elastomdr.results.{module.name}")
    units = {name: unit for unit, names in UNITS.items() for name in names.split()}
    waiting, count = [Result, Contact], 0
    while waiting:
        cls = waiting.pop()
        waiting += cls.__subclasses__()
        for f in dataclasses.fields(cls):
            if q := f.metadata.get("quantity"):
                assert q.unit == OTHERS.get(
                    f"{cls.__name__}.{f.name}", units[f.name]
                ), (cls, f.name)
                count += 1
    assert count > 100


@pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")
def test_a_result_and_a_fit_as_tables_of_a_notebook():
    curve = dataclasses.replace(
        friction_curve(), inputs=(("material", "<b>"), *INPUTS[1:])
    )
    shown = curve._repr_html_()
    assert shown.startswith("<table><caption>FrictionCurve</caption>")
    assert "<b>" not in shown
    for name, text in curve.findings():
        assert f">{html.escape(name)}</th>" in shown
        assert f">{html.escape(text)}</td>" in shown
    table, image = shown.split('<img alt="" width="420" src="data:image/png;base64,')
    assert table.endswith("</table>")
    assert base64.b64decode(image.removesuffix('">')).startswith(b"\x89PNG")
    one = friction_curve(velocity=VELOCITY[:1])._repr_html_()
    assert "<img" not in one  # a point is no curve
    swept = np.geomspace(1e-3, 0.5, 12)
    fit = em.fit.softening(
        {
            "strain": swept,
            "storage": 1e6 + 4e6 / (1 + swept / 0.02),
            "loss": 1e5 + 0 * swept,
        }
    ).sweeps
    assert "<caption>Sweeps</caption>" in fit._repr_html_()
    assert html.escape(fit.summary().splitlines()[-1][-20:]) in fit._repr_html_()


def test_a_result_without_numbers_has_its_line_as_a_table():
    shown = jax.tree.map(lambda _: "traced", friction_curve())._repr_html_()
    assert "without numbers" in shown
