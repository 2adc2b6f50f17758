"""Steady scenes run on NumPy and load no JAX; the classes they take are JAX's pytrees
all the same.
"""

import pickle
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import equinox as eqx
import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr import checks
from elastomdr import trees as _trees
from elastomdr.arrays import on_numpy, xp

ROOT = Path(__file__).parents[2]
DMA = ROOT / "examples/data/dma.csv"
RUBBER = em.Prony(
    1e6,
    np.geomspace(1e8, 1e6, 8),
    np.logspace(-6, 1, 8),
    poisson=0.4,
    shift=em.WLF(8.86, 101.6, 293.15),
)
HEAVY = {
    "jax",
    "jaxlib",
    "equinox",
    "jaxtyping",
    "diffrax",
    "matplotlib",
    "scipy",
    "scipy.special",
    "pint",
}
MATERIAL = (
    "em.Prony(1e6, [1e8, 1e7], [1e-4, 1e-1], poisson=0.4, shift=em.WLF(8.86, 101.6, "
    "293.15))"
)
SURFACE = "em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e5)"


def loaded(code: str) -> set[str]:
    """Which heavy packages a new process has loaded after `code`."""
    code = (
        f"import elastomdr as em\n{textwrap.dedent(code)}\nimport sys; "
        f"print('loaded', *({HEAVY} & set(sys.modules)))"
    )
    return set(new_process(code).splitlines()[-1].split()[1:])


def new_process(code: str) -> str:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", textwrap.dedent(code)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    "shape",
    ["em.Sphere(0.01)", "em.Cone(0.1)", "em.Paraboloid(0.01)", "em.PowerLaw(3, 1e3)"],
)
def test_friction_of_smooth_bodies_loads_nothing_heavy(shape):
    call = f"em.friction({MATERIAL}, {shape}, velocity=[1e-3, 1.0], temperature=300.0"
    assert (
        loaded(f"{call}, load=1.0)\n{call}, depth=1e-6, model='line')\nem.materials()")
        == set()
    )


def test_rolling_layers_and_plans_load_nothing_heavy():
    layer = f"em.springs({MATERIAL}, 1e-2)"
    roller = f"{layer}, em.Cylinder(0.05, 0.5), velocity=[0.1, 1.0], load=100.0)"
    assert (
        loaded(f"em.rolling({roller}\nem.plan({roller}\nem.dissipation({roller}")
        == set()
    )
    assert (
        loaded(f"em.friction({layer}, em.Sphere(0.01), velocity=1.0, load=1.0)")
        == set()
    )


def test_closed_formulas_and_the_laboratory_load_no_jax():
    assert (
        loaded(
            "em.stability(em.Mount(1.0, 1e3), velocity=[1.0, 2.0, 3.0], force=[1.0, "
            "0.9, 0.8], wavelength=1e-3)\n"
            f"em.o_ring({MATERIAL}, 1e-2, 0.1)"
        )
        == set()
    )
    jax_and_its_own = {"jax", "jaxlib", "equinox", "jaxtyping", "diffrax", "matplotlib"}
    leak = "pressure=1e5, pressure_drop=1e4, viscosity=1.0, length=1.0"
    assert not loaded(f"em.leak({MATERIAL}, {SURFACE}, {leak})") & jax_and_its_own
    assert not loaded(f"em.read_dma({str(DMA)!r})\nem.fit.material") & jax_and_its_own
    heights = "[i * i % 97 * 1e-8 for i in range(200)]"  # all waves, as of a surface
    assert not loaded(f"em.read_surface({heights}, pixel_size=1e-5)") & jax_and_its_own


def test_annotations_load_nothing():
    """jaxtyping is for editors and type checkers."""
    sources = {
        path: path.read_text(encoding="utf-8") for path in (ROOT / "src").rglob("*.py")
    }
    assert len(sources) > 100
    assert not [
        path
        for path, text in sources.items()
        if re.search("^(from|import) jaxtyping", text, re.MULTILINE)
    ]


HISTORIES = {
    "indent by a growing load": lambda **at: em.indent(
        RUBBER, em.Cone(0.1), time=[0, 1, 2], load=[1, 1, 2], **at
    ),
    "impact": lambda **at: em.impact(
        RUBBER, em.Sphere(0.01), mass=1e-2, velocity=1.0, **at
    ),
}
TIME = np.array([0.0, 0.01, 0.02])
MARCHES = {
    "indent by a falling load": lambda: em.indent(
        RUBBER, em.Sphere(0.01), time=[0, 1, 2], load=[0, 1, 0.2], rtol=1e-3
    ),
    "slide": lambda: em.slide(
        RUBBER, em.Sphere(0.01), time=TIME, position=0.02 * TIME, load=1.0, rtol=0.1
    ),
    "drive": lambda: em.drive(
        RUBBER,
        em.Sphere(0.01),
        time=TIME,
        position=0.02 * TIME,
        load=1.0,
        tangential=em.Mount(0.1, 1e3, 1.0),
        rtol=0.1,
    ),
    "shear": lambda: em.shear(
        RUBBER,
        em.Sphere(0.01),
        time=TIME,
        displacement=2e-3 * TIME,
        load=1.0,
        friction=0.5,
        elements=50,
        steps=4,
    ),
}


def test_small_histories_load_nothing_heavy():
    ball = f"{MATERIAL}, em.Sphere(0.01)"
    calls = (
        f"em.indent({ball}, time=[0, 1, 2], depth=[0, 1e-4, 0])\n"
        f"em.indent({ball}, time=[0, 1, 2], load=[0, 1, 2])\n"
        f"em.impact({ball}, mass=1e-2, velocity=1.0, rtol=1e-3)\n"
        f"em.traction({ball}, velocity=1.0, creepage=0.01, friction=0.8, load=5.0)\n"
        f"em.indent({ball}, time=[0, 1, 2], load=[0, 1, 0.5], rtol=1e-3)\n"
        f"em.slide({ball}, time=[0, 1e-2], position=[0, 1e-4], load=1.0, rtol=0.1)\n"
        f"em.drive({ball}, time=[0, 1e-2], position=[0, 1e-4], load=1.0, "
        "tangential=em.Mount(0.1, 1e3), rtol=0.1)\n"
        f"em.shear({ball}, time=[0, 1], displacement=[0, 1e-6], load=1.0, "
        "friction=0.5, elements=50, steps=4)"
    )
    assert loaded(calls) == set()


def large(monkeypatch):
    """As if every problem were so large that it is compiled."""
    for limit in (
        "indentation_route._MANY",
        "refinement._PATIENCE",
        "impact_motion._FEW",
    ):
        monkeypatch.setattr(f"elastomdr.transient.{limit}", 0)


@pytest.mark.parametrize("name", HISTORIES)
def test_histories_on_numpy_and_compiled_agree(name, monkeypatch):
    """The same source on NumPy, and by JAX where a problem is large."""
    first = HISTORIES[name](rtol=1e-4)
    large(monkeypatch)
    other = HISTORIES[name](rtol=1e-4)
    for field in (
        "force",
        "depth",
        "dissipated",
        "restitution",
        "max_depth",
        "duration",
    ):
        if hasattr(first, field):
            small, big = getattr(first, field), getattr(other, field)
            np.testing.assert_allclose(small, big, atol=1e-6 * np.abs(small).max())
            assert isinstance(big, np.ndarray)


@pytest.mark.parametrize("name", MARCHES)
def test_marches_on_numpy_and_compiled_agree(name, monkeypatch):
    first = MARCHES[name]()
    large(monkeypatch)
    other = MARCHES[name]()
    for field in (
        "force",
        "normal_force",
        "friction_force",
        "depth",
        "dissipated",
        "work",
        "error",
    ):
        if hasattr(first, field):
            small, big = getattr(first, field), getattr(other, field)
            np.testing.assert_allclose(
                small, big, rtol=1e-6, atol=1e-7 * np.abs(small).max()
            )


@pytest.mark.parametrize("model", ["em.Multiscale()", "em.Persson()"])
def test_surfaces_need_one_function_of_scipy(model):
    call = (
        f"em.friction({MATERIAL}, {SURFACE}, velocity=[0.1, 1.0], pressure=3e5, "
        f"model={model})"
    )
    assert loaded(call) == {"scipy", "scipy.special"}
    table = (
        "em.TabulatedModulus([1e-3, 1.0, 1e3, 1e9], [1e6, 2e6, 1e7, 1e8], [1e5, 5e5, "
        "2e6, 1e7])"
    )
    assert loaded(call.replace(MATERIAL, table)) == {"scipy", "scipy.special"}


def test_the_command_draws_without_jax(tmp_path):
    scene = tmp_path / "slider.toml"
    scene.write_text(
        'material = "tread-passenger-synthetic"\ntemperature = "20 degC"\n'
        '[indenter]\nshape = "sphere"\nradius = "5 mm"\n'
        '[contact]\nload = "10 N"\nvelocity = { from = "1e-6 m/s", to = "10 m/s", '
        "points = 8 }\n"
    )
    command = ["friction", str(scene), "--out", str(tmp_path)]
    code = f"from elastomdr.cli.main import main\nassert main({command}) == 0"
    assert not loaded(code) & {"jax", "equinox", "jaxtyping", "diffrax"}
    assert (tmp_path / "slider-friction.png").exists()


def test_numbers_and_what_jax_traces_agree():
    """One source: the same bodies by NumPy, and under jit by JAX, which has its own
    search.
    """
    for shape, at in (
        (em.Cone(0.1), {"depth": 1e-5}),
        (em.Sphere(0.01), {"load": 9.0}),
    ):
        numbers = em.friction(RUBBER, shape, velocity=[1e-3, 0.1, 10.0], **at)
        traced = jax.jit(
            lambda m, s, at=at: (
                em.friction(m, s, velocity=np.array([1e-3, 0.1, 10.0]), **at).mu
            )
        )(RUBBER, shape)
        np.testing.assert_allclose(numbers.mu, traced, rtol=1e-6)
        assert isinstance(numbers.mu, np.ndarray) and numbers.mu.dtype == np.float64  # noqa: PT018


def test_outside_of_a_call_nothing_is_numpys():
    assert not on_numpy()
    with pytest.raises(em.InputError):
        em.friction(RUBBER, em.Cone(0.1), velocity=-1.0, load=1.0)
    assert not on_numpy()


def test_a_tracer_that_reaches_numpy_raises():
    inside = checks.numpy_unless_traced(lambda function: function(1.0))
    with pytest.raises(jax.errors.TracerArrayConversionError):
        inside(jax.jit(lambda x: xp.sin(x)))


def test_trees_of_jax():
    leaves, structure = jax.tree.flatten(RUBBER)
    again = jax.tree.unflatten(structure, leaves)
    assert type(again) is em.Prony and _trees.same(again, RUBBER)  # noqa: PT018
    assert not _trees.same(again, RUBBER.at(300.0))
    assert any("moduli" in str(path) for path, _ in jax.tree.leaves_with_path(RUBBER))
    many = jax.vmap(
        lambda load: em.friction(
            RUBBER, em.Cone(0.1), velocity=1.0, load=load, model="line"
        )
    )(np.array([1.0, 2.0]))
    assert many.mu.shape == (2,)


class Holder(eqx.Module):
    """A class of a user's, with equinox."""

    material: em.Prony
    shape: em.Sphere

    def friction(self, velocity):
        return em.friction(
            self.material, self.shape, velocity=velocity, load=1.0, model="line"
        ).mu


def test_a_module_of_the_users_holds_ours():
    holder = Holder(RUBBER, em.Sphere(0.01))
    assert float(holder.friction(0.1)) == pytest.approx(
        float(eqx.filter_jit(Holder.friction)(holder, 0.1)), rel=1e-6
    )
    with jax.enable_x64(True):
        slope = eqx.filter_jit(eqx.filter_grad(lambda one: one.friction(0.1)))(holder)
    assert slope.shape.radius.shape == ()


@pytest.mark.parametrize(
    "thing",
    [
        RUBBER,
        em.half_space(RUBBER),
        em.Cone(0.1),
        em.Profile([0, 1, 2, 3], [0, 1, 4, 9]),
    ],
)
def test_pickle_and_frozen(thing):
    assert _trees.same(pickle.loads(pickle.dumps(thing)), thing)
    name = next(iter(vars(thing)))
    with pytest.raises(AttributeError):
        setattr(thing, name, 1.0)


ORDERS = {
    "elastomdr first": "import elastomdr as em; m = em.Paraboloid(0.01); import jax",
    "jax first": "import jax; import elastomdr as em; m = em.Paraboloid(0.01)",
    "classes in between": "import elastomdr as em; import jax; m = em.Paraboloid(0.01)",
    "by a submodule of jax": "import elastomdr as em; m = em.Paraboloid(0.01); import jax.numpy; import jax",
    "from a pickle": """
        import pickle, elastomdr as em
        data = pickle.dumps(em.Paraboloid(0.01))
        import jax
        m = pickle.loads(data)""",
    "JAX that failed before": """
        import sys, elastomdr as em
        m = em.Paraboloid(0.01)
        class Broken:
            def find_spec(self, name, path, target=None):
                if name == "jax._src.core": raise ImportError("broken")
        broken = Broken()
        sys.meta_path.insert(0, broken)
        try: import jax
        except ImportError: pass
        else: raise AssertionError
        sys.meta_path.remove(broken)
        for name in [name for name in sys.modules if name.partition(".")[0] == "jax"]: del sys.modules[name]
        import jax""",
    "threads": """
        import threading
        def one(): import jax
        def two(): import elastomdr as em; em.Cone(0.1); em.Prony(1e6, [], []); em.Sphere(1.0)
        threads = [threading.Thread(target=t) for t in (one, two, one, two)]
        [t.start() for t in threads]; [t.join() for t in threads]
        import jax, elastomdr as em
        m = em.Paraboloid(0.01)""",
    "while JAX is being imported": """
        import sys
        class Plugin:
            def find_spec(self, name, path, target=None):
                if name == "jax.numpy" and "elastomdr" not in sys.modules:
                    import elastomdr; elastomdr.Paraboloid(0.01)
        sys.meta_path.insert(0, Plugin())
        import jax, elastomdr as em
        m = em.Paraboloid(0.01)""",
}


@pytest.mark.parametrize("order", ORDERS)
def test_whichever_is_imported_first(order):
    check = (
        "assert len(jax.tree.leaves(m)) == 1, jax.tree.leaves(m); jax.jit(lambda s: "
        "s.radius)(m); assert em.Cone"
    )
    new_process(f"{textwrap.dedent(ORDERS[order])}\n{check}")
