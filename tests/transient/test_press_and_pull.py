"""`em.indent(adhesion=...)`: JKR's cycles, an edge that depends on its speed, its bounds
and its limits.
"""

from pathlib import Path

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.checks import numpy_unless_traced
from elastomdr.element.episode import recovery_modes

RELAXED, RADIUS, WORK = 1e6, 1e-2, 0.05  # Pa, m, J/m^2
BALL = em.Paraboloid(RADIUS)
ELASTIC = em.Foundation(RELAXED, [], [])
# one branch so weak that nothing depends on it: the march instead of the closed form
WEAK = em.Foundation(RELAXED, [1e-3], [0.1])
RUBBER = em.Foundation(RELAXED, [9e6], [0.1])
SCALE = (np.pi * WORK * RADIUS**2 / RELAXED) ** (2 / 3) / RADIUS  # D of JKR
JKR = 1.5 * np.pi * WORK * RADIUS
CUTOFF = em.Adhesion(WORK, cutoff=1e-6)


def way(top, low, steps=100):
    """Up, down and beyond."""
    return np.append(
        np.linspace(0, top, steps), np.linspace(top, low, 3 * steps + 1)[1:]
    )


def cycle(law, shape=BALL, rate=1.0, top=6 * SCALE, low=-12 * SCALE, **options):
    """From the first touch to a depth and back, at a rate in D/s."""
    depth = way(top, low, options.pop("steps", 60))
    time = np.append(0.0, np.cumsum(abs(np.diff(depth)))) / (rate * SCALE)
    adhesion = options.pop("adhesion", CUTOFF)
    return em.indent(law, shape, time=time, depth=depth, adhesion=adhesion, **options)


def test_cycle_of_an_elastic_ball():
    """Oracle jkr_cycle_sphere."""
    found = cycle(ELASTIC, low=-1.5 * SCALE)
    assert np.isclose(found.jump_in.radius, 3.155368e-4, rtol=1e-6)
    assert np.isclose(found.jump_in.force, -2.094395e-3, rtol=1e-6)
    assert np.isclose(found.pull_off.depth, -4.704078e-6, rtol=1e-6)
    assert np.isclose(found.pull_off.force, -1.308997e-3, rtol=1e-6)
    assert np.isclose(found.loop_energy, 1.036885e-8, rtol=1e-6)


def test_load_pulls_an_elastic_ball_off():
    load = way(2 * JKR, -1.5 * JKR)
    with pytest.warns(em.ConvergenceWarning):
        found = em.indent(
            ELASTIC, BALL, time=np.arange(load.size), load=load, adhesion=WORK
        )
    assert np.isclose(found.pull_off.force, -2.356194e-3, rtol=1e-6)
    assert np.isclose(found.pull_off.radius, 2.604699e-4, rtol=1e-6)
    assert np.isclose(found.jump_in.radius, 4.134701e-4, rtol=1e-6)


@pytest.mark.parametrize(
    ("rate", "expected"),
    [
        (1e-06, 1.0005),
        (0.01, 2.656),
        (0.1, 5.46),
        (1, 8.69),
        (10, 9.355),
        (100, 2.28),
        (10000.0, 1.01),
    ],
)
def test_pull_of_a_cycle_is_a_bell_over_its_rate(rate, expected):
    """Oracle jkr_cycle_viscoelastic."""
    found = cycle(RUBBER, rate=rate)
    assert np.isclose(-found.pull_off.force / JKR, expected, rtol=0.01)
    assert np.nanmin(found.force) >= found.pull_off.force
    assert (found.error[found.converged] < 0.03).all()


@pytest.mark.parametrize(
    ("shape", "pull"),
    [
        (BALL, -2.356194e-3),
        (em.Cone(0.2), -5.371479e-6),
        (em.FlatPunch(5e-4), -1.253314e-2),
        (em.PowerLaw(4.0, 1e8), -5.099735e-3),
    ],
    ids=lambda value: getattr(value, "label", ""),
)
def test_march_is_the_closed_form_where_nothing_relaxes(shape, pull):
    load = way(-6 * pull, 1.3 * pull)
    runs = []
    for law in (WEAK, ELASTIC):
        with pytest.warns(em.ConvergenceWarning):
            run = em.indent(
                law, shape, time=np.arange(load.size), load=load, adhesion=CUTOFF
            )
        assert np.isclose(run.pull_off.force, pull, rtol=1e-4)
        runs.append(run)
    known = runs[1].converged
    for field in ("depth", "contact_radius"):
        march, closed = (getattr(run, field)[known] for run in runs)
        assert np.allclose(march, closed, rtol=1e-3, atol=1e-4 * closed.max())
    assert np.allclose(runs[0].error[known], 0, atol=1e-3)


def test_what_rested_pulls_up_to_the_glassy_modulus():
    """From rest the pull rises with the rate to E_inf/E_0 times that of JKR."""
    pulls = []
    for rate, expected in ((0.01, 2.658), (0.1, 5.47), (1, 8.70), (10, 9.95)):
        depth = np.append(6 * SCALE, np.linspace(6, -12, 300) * SCALE)
        time = np.append(0.0, 1e9 + np.arange(300) * 18 / 299 / rate)
        found = em.indent(RUBBER, BALL, time=time, depth=depth, adhesion=CUTOFF)
        pulls.append(-found.force.min() / JKR)
        assert np.isclose(pulls[-1], expected, rtol=0.01)
    assert (np.diff(pulls) > 0).all()
    assert pulls[-1] < 10


def test_rubber_that_creeps_closes_under_a_load_that_falls_slowly():
    """Pulled, the edge advances nevertheless: as without adhesion, where that is weak."""
    time = np.append(0.0, np.append(np.geomspace(1e-4, 1e-3, 9), np.geomspace(2e-3, 1)))
    load = 50 * JKR * np.interp(time, [0.0, 1e-3, 1.0], [0.0, 1.0, 0.9])
    plain, sticky = (
        em.indent(RUBBER, BALL, time=time, load=load, adhesion=adhesion)
        for adhesion in (None, em.Adhesion(5e-4, cutoff=1e-6))
    )
    pulled = time > 1e-3
    assert sticky.contact_radius[-1] > 1.7 * sticky.contact_radius[pulled][0]
    np.testing.assert_allclose(
        sticky.contact_radius[pulled], plain.contact_radius[pulled], rtol=0.015
    )


def test_factor_of_the_edge():
    """1/Gamma = 1 - (1-k)(sqrt(1+b^2) - 1)/b with b = 2 pi nu/Gamma, solved by hand."""
    law = RUBBER.law()
    bond = numpy_unless_traced(CUTOFF.bond)(law, recovery_modes(law))
    retardation = 0.1 * 10  # lambda = tau E_inf/E_0
    for nu in (0.01, 0.1, 1.0, 10.0):
        factor = 2.0
        for _ in range(200):
            b = 2 * np.pi * nu / factor
            factor = 0.5 * (factor + 1 / (1 - 0.9 * (np.sqrt(1 + b**2) - 1) / b))
        found = bond.at(np.array(nu * 1e-6 / retardation))
        assert np.isclose(found, factor, rtol=1e-3)
    assert np.isclose(bond.at(np.array(0.0)), 1)
    assert np.isclose(bond.at(np.array(1e9)), 10)


def test_edges_that_are_given_are_limits():
    pulls = {
        name: -cycle(RUBBER, adhesion=adhesion).force.min() / JKR
        for name, adhesion in {
            "elastic": em.Adhesion(WORK, edge="elastic"),
            "computed": CUTOFF,
            "table": em.Adhesion(WORK, edge=([1e-9, 1e-6, 1.0], [1.0, 3.0, 3.0])),
            "number": WORK,
        }.items()
    }
    assert pulls["elastic"] < pulls["table"] < pulls["computed"] < pulls["number"]
    upper = cycle(RUBBER, adhesion=WORK)
    assert np.isnan(upper.model_error).all()
    assert any("upper limit" in doubt.says for doubt in upper.doubts)


@pytest.mark.filterwarnings("ignore::elastomdr.ExtrapolationWarning")
@pytest.mark.parametrize("celsius", [25.0, 5.0])
def test_an_edge_faster_than_the_data_is_extrapolated(celsius):
    """At 2 pi v/(a_0 Gamma), of what is pressed and pulled slowly enough."""
    rubber, kelvin = em.load_material("epdm-70"), celsius + 273.15
    depth = way(30e-6, -30e-6, 30)
    found = {}
    for cutoff in (1e-4, 1e-8):
        found[cutoff] = em.indent(
            rubber,
            em.Sphere(RADIUS),
            time=np.append(0.0, 1e-2 + np.arange(depth.size - 1) * 1e-3),
            depth=depth,
            adhesion=em.Adhesion(WORK, cutoff=cutoff),
            temperature=kelvin,
        )
    assert not found[1e-4].extrapolated.any()
    pull = found[1e-8]
    gamma = np.where(pull.edge_speed > 0, 1 / pull.work_factor, pull.work_factor)
    rate = 2 * np.pi * abs(pull.edge_speed) / (1e-8 * gamma)
    fast = rate * 10 ** rubber.shift.log10_a(kelvin) > rubber.range.omega[1]
    assert 0 < fast.sum() < fast.size
    assert (pull.extrapolated == fast).all()
    assert np.isnan(pull.model_error[fast]).all()


@pytest.mark.filterwarnings("ignore::elastomdr.ExtrapolationWarning")
def test_an_edge_that_came_off_too_fast_is_extrapolated_until_the_contact_is_lost():
    """And has no bound, however slow it is in the end; one that closed too fast is
    forgotten.
    """
    depth, top = way(30e-6, -30e-6, 30), 29
    steps = np.full(depth.size - 1, 1e-3)
    steps[top : top + 10] = 1e-4
    steps[top + 20 :] = 1.0
    found = em.indent(
        em.load_material("epdm-70"),
        em.Sphere(RADIUS),
        time=np.append(0.0, np.cumsum(steps)),
        depth=depth,
        adhesion=em.Adhesion(WORK, cutoff=1e-8),
        temperature=298.15,
    )
    closing, touching = found.edge_speed > 0, found.contact_radius > 0
    flagged = found.extrapolated
    assert flagged[closing].any()
    assert not flagged[top]
    first = top + int(np.argmax(flagged[top:]))
    assert first < top + 10
    assert (flagged == (touching & (np.arange(depth.size) >= first)))[top:].all()
    assert abs(found.edge_speed[top + 30]) < 1e-5
    assert np.isnan(found.model_error[flagged]).all()
    assert not np.isnan(found.model_error[~flagged]).any()


def test_an_edge_faster_than_its_table_is_extrapolated():
    edge = ([1e-9, 1e-5], [1.0, 3.0])
    with pytest.warns(em.ExtrapolationWarning, match="table"):
        found = cycle(RUBBER, adhesion=em.Adhesion(WORK, edge=edge))
    fast = np.nan_to_num(abs(found.edge_speed)) > 1e-5
    assert 0 < fast.sum() < fast.size
    assert (found.extrapolated == fast).all()
    elastic = cycle(ELASTIC, adhesion=em.Adhesion(WORK, edge=edge))  # no table is used
    assert elastic.extrapolated is None


def test_strength_is_a_cutoff():
    strength = 1e5
    cutoff = 6 * RELAXED * WORK / (np.pi * strength**2)
    one = cycle(RUBBER, adhesion=em.Adhesion(WORK, strength=strength))
    other = cycle(RUBBER, adhesion=em.Adhesion(WORK, cutoff=cutoff))
    assert (one.force == other.force).all()


def test_bound_follows_the_zone():
    assert (cycle(RUBBER).model_error[:1] == 0.1).all()
    wide = cycle(RUBBER, adhesion=em.Adhesion(WORK, cutoff=1e-4))
    assert np.isnan(wide.model_error).all()
    assert wide.zone_ratio[50] > 0.1
    shallow = cycle(RUBBER, top=2 * SCALE)
    assert any("pressed less" in doubt.says for doubt in shallow.doubts)
    stiff = em.Foundation(RELAXED, [200e6], [0.1])
    assert np.isnan(cycle(stiff, steps=30).model_error).all()
    assert np.isnan(cycle(RUBBER, shape=em.Cone(0.1)).model_error).all()


def test_contact_is_made_again_on_what_was_pulled():
    """A second cycle after a long rest is the first one."""
    once = way(6 * SCALE, -4 * SCALE, 40)
    depth = np.concatenate([once, [-4 * SCALE], once])
    time = np.arange(depth.size) * 0.1
    time[once.size :] += 1e6
    found = em.indent(RUBBER, BALL, time=time, depth=depth, adhesion=CUTOFF)
    first, second = found.force[: once.size], found.force[once.size + 1 :]
    assert np.allclose(second, first, atol=0.02 * abs(first).max())


def test_histories_together_are_those_alone():
    depth = np.stack([way(6 * SCALE, -9 * SCALE, 30), way(4 * SCALE, -9 * SCALE, 30)])
    time = np.arange(depth.shape[1]) * 0.2
    together = em.indent(RUBBER, BALL, time=time, depth=depth, adhesion=CUTOFF)
    assert together.pull_off.force.shape == (2,)
    assert together.to_pandas().shape[0] == depth.size
    for i, row in enumerate(depth):
        alone = em.indent(RUBBER, BALL, time=time, depth=row, adhesion=CUTOFF)
        assert np.allclose(together.force[i], alone.force, atol=0.03 * JKR)


def test_depth_and_load_in_turn():
    time = np.array([0.0, 1.0, 2.0, 3.0])
    depth = np.array([0.0, 6 * SCALE, np.nan, np.nan])
    load = np.array([np.nan, np.nan, 3 * JKR, 0.0])
    found = em.indent(RUBBER, BALL, time=time, depth=depth, load=load, adhesion=CUTOFF)
    assert np.allclose(found.force[2:], load[2:])
    assert np.isfinite(found.depth).all()


@pytest.mark.parametrize(
    ("argument", "options"),
    [
        ("work", {"work": -1.0}),
        ("cutoff", {"work": WORK, "cutoff": 0.0}),
        ("cutoff", {"work": WORK, "cutoff": 1e-7, "strength": 1e6}),
        ("edge", {"work": WORK, "edge": "viscous"}),
        ("edge", {"work": WORK, "edge": ([1.0, 0.1], [1.0, 2.0])}),
        ("edge", {"work": WORK, "edge": ([0.1, 1.0], [0.5, 2.0])}),
    ],
)
def test_refuses(argument, options):
    with pytest.raises(em.InputError) as refused:
        em.Adhesion(**options)
    assert refused.value.argument == argument
    assert np.isin(refused.value.got, options[argument]).all()


@pytest.mark.parametrize("nothing", [0.0, em.Adhesion(0.0, cutoff=1e-7)])
def test_no_work_is_no_adhesion(nothing):
    depth = way(6 * SCALE, -SCALE, 20)
    runs = [
        em.indent(RUBBER, BALL, time=np.arange(depth.size), depth=depth, adhesion=work)
        for work in (None, nothing)
    ]
    for field in ("force", "contact_radius", "dissipated", "model_error"):
        one, other = (getattr(run, field) for run in runs)
        assert np.array_equal(one, other)


@pytest.mark.parametrize(
    ("argument", "law", "adhesion"),
    [
        ("cutoff", RUBBER, em.Adhesion(WORK)),
        ("edge", em.springs(em.Prony(1e6, [9e6], [0.1]), 5e-3, bonded=False), CUTOFF),
        ("adhesion", em.layer(em.Prony(1e6, [9e6], [0.1]), 5e-3), CUTOFF),
        ("material", em.Foundation(1e6, [], [], viscosity=1e3), CUTOFF),
        ("material", em.Foundation(0.0, [1e6], [1.0]), CUTOFF),
    ],
)
def test_refuses_rubber(argument, law, adhesion):
    with pytest.raises(em.InputError) as refused:
        em.indent(law, BALL, time=[0, 1], depth=[0, 1e-5], adhesion=adhesion)
    assert refused.value.argument == argument


def test_memory_at_the_edge_has_no_derivatives():
    def force(top):
        return em.indent(
            RUBBER, BALL, time=[0.0, 1.0], depth=top * np.arange(2), adhesion=CUTOFF
        ).force[-1]

    with pytest.raises(em.InputError) as refused:
        jax.grad(force)(1e-5)
    assert refused.value.argument == "depth"


def test_elastic_derivatives_where_the_body_is_off():
    """Of the pull-off -(5/6) pi w R, and of a force before it, without 64-bit types."""
    depth = way(3 * SCALE, -2 * SCALE, 20)

    def pulled(work):
        found = em.indent(
            ELASTIC, BALL, time=np.arange(depth.size), depth=depth, adhesion=work
        )
        return found.pull_off.force, found.force[40]

    off, before = (jax.grad(lambda w, i=i: pulled(w)[i])(WORK) for i in (0, 1))
    assert np.isclose(off, -5 / 6 * np.pi * RADIUS, rtol=1e-5)
    high, low = (pulled(WORK + step)[1] for step in (1e-6, -1e-6))
    assert np.isclose(before, (high - low) / 2e-6, rtol=1e-4)


def test_bound_of_a_load_that_does_not_pull_off():
    load = way(20 * JKR, -JKR, 30)
    time = 0.1 * np.arange(load.size)
    found = em.indent(RUBBER, BALL, time=time, load=load, adhesion=CUTOFF)
    assert np.isnan(found.pull_off.force)
    assert np.isnan(found.loop_energy)
    assert (found.model_error == 0.1).all()
    stays, energies = found.doubts
    assert "pull_off" in stays.says
    assert "stored" in energies.says
    for doubt in (stays, energies):
        assert doubt.kind == "estimate"
        assert np.flatnonzero(doubt.points).tolist() == [load.size - 1]
    assert np.isnan(found.stored).all()
    assert np.isnan(found.locked).all()


@pytest.mark.parametrize("law", [ELASTIC, RUBBER], ids=["elastic", "rubber"])
def test_only_histories_that_end_in_contact_have_no_pull_off(law):
    stays, parts, never = (6, 6), (6, -12), (-1, -1)
    ends = np.array([stays, parts, never]) * SCALE
    found = em.indent(
        law,
        BALL,
        time=[0.0, 6.0, 24.0],
        depth=np.column_stack([np.minimum(ends[:, 0], 0), ends]),
        adhesion=CUTOFF,
    )
    assert found.converged.all()
    assert np.isfinite(found.loop_energy).tolist() == [False, True, False]
    assert (found.force[2] == 0).all()
    (doubt,) = (d for d in found.doubts if "pull_off" in d.says)
    assert np.argwhere(doubt.points).tolist() == [[0, 2]]
    assert (found.model_error[2] == 0).all()
    for doubt in found.doubts:
        assert not np.asarray(doubt.points)[2].any()


def test_pull_off_depends_on_the_instants_within_its_error():
    """A fast withdrawal: 16 to 301 instants differed by 10 %."""
    top = 30 * SCALE
    pulls, errors = [], []
    for instants in (16, 61, 301):
        time = np.linspace(0, 3, instants)
        depth = np.interp(time, [0, 2, 3], [0, top, -top])
        found = em.indent(RUBBER, BALL, time=time, depth=depth, adhesion=CUTOFF)
        pulls.append(float(found.pull_off.force))
        errors.append(float(found.pull_off.error))
        assert found.converged.all()
        assert found.jump_in.error < 0.03
        assert "pull-off" in found.summary()
        assert "pull-off" in dict(found.headline())["peak"]
    assert max(errors) < 0.03
    assert np.ptp(pulls) < 0.01 * abs(np.mean(pulls))


def test_where_the_rubber_is_met_does_not_depend_on_the_instants():
    time = np.linspace(0, 12, 7)
    depth = np.interp(time, [0, 6, 12], [-5 * SCALE, 7 * SCALE, -12 * SCALE])
    found = em.indent(RUBBER, BALL, time=time, depth=depth, adhesion=CUTOFF)
    assert np.isclose(found.jump_in.time, 2.5, atol=1e-3)
    assert np.isclose(found.jump_in.force, -4 / 3 * np.pi * WORK * RADIUS, rtol=0.03)


@pytest.mark.parametrize("adhesion", [1e-9, em.Adhesion(1e-8, cutoff=1e-8)])
def test_adhesion_too_weak_for_the_elements_has_no_pull_off(adhesion):
    depth = np.array([0.0, 2e-4, -3e-4])
    found = em.indent(
        RUBBER, BALL, time=[0.0, 2.0, 3.0], depth=depth, adhesion=adhesion
    )
    assert found.converged.all()
    for event in (found.pull_off, found.jump_in):
        assert np.isnan([event.time, event.depth, event.force, event.radius]).all()
        assert event.error > 0.1
    (doubt,) = (d for d in found.doubts if "pull_off" in d.says)
    assert np.flatnonzero(doubt.points).tolist() == [2]


def test_a_step_of_depth_at_the_first_instant_is_glassy_jkr():
    """Marched with half as many steps, too."""
    found = em.indent(
        RUBBER, BALL, time=[0.0, 1.0], depth=[9 * SCALE, 9 * SCALE], adhesion=WORK
    )
    assert found.converged.all()
    assert (found.error < 0.03).all()


@pytest.mark.filterwarnings("ignore:.*comes off too near")  # of the closer instants
@pytest.mark.parametrize("top", [1, 3, 5, 10])
def test_steps_are_as_short_as_meeting_and_parting_ask_for(top):
    """Errors of 0.032 to 0.11 at the first instant and at the last in contact."""
    ends = [0, 50, 150], np.array([0, top, -min(3, top)]) * SCALE

    def pulled(instants):
        time = np.linspace(0, 150, instants)
        depth = np.interp(time, *ends)
        return em.indent(RUBBER, BALL, time=time, depth=depth, adhesion=CUTOFF)

    found = pulled(401)
    assert found.converged.all()
    if top == 3:
        closer = pulled(1201).force[::3]
        same = (found.force != 0) & (closer != 0)
        assert np.nanmax(abs(found.force - closer)[same]) <= 0.03 * found.force.max()


def test_a_compiled_cycle_needs_no_64_bit_types_of_the_caller():
    def pulled(work):
        return cycle(ELASTIC, low=-2 * SCALE, adhesion=work)

    found = jax.jit(pulled)(WORK)
    assert np.isclose(found.pull_off.force, -1.308997e-3, rtol=1e-6)
    assert np.isclose(found.loop_energy, 1.036885e-8, rtol=1e-4)


def test_springs_of_an_elastic_rubber_stick():
    """On springs delta = sqrt(2 w/k) everywhere, and a = sqrt(2 R (d + delta))."""
    stiffness, depth = 1e9, np.array([0.0, 1e-5, 5e-6])
    law = em.springs(em.Prony(stiffness * 5e-3, [], [], poisson=0.4), 5e-3)
    found = em.indent(law, BALL, time=np.arange(3), depth=depth, adhesion=WORK)
    k = float(law.equilibrium)
    wide = np.sqrt(2 * RADIUS * (depth + np.sqrt(2 * WORK / k)))
    np.testing.assert_allclose(found.contact_radius, wide, rtol=1e-12)


@pytest.fixture
def pull_off(monkeypatch):
    """`benchmarks/pull_off.py`: boundary elements that attract each other."""
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "benchmarks")
    import pull_off

    return pull_off


@pytest.mark.parametrize(("rate", "bound"), [(0.1, 0.1), (1.0, 0.15)])
def test_bound_reaches_boundary_elements(pull_off, rate, bound):
    """A ball that has rested is pulled off; neither an edge nor a factor is known to
    the rings, but the range of their attraction.
    """
    scene = pull_off.Scene(np.array([9e6]), np.array([0.1]), 3.0, 3.5, rate, True)
    rings, ours, _, model_error = pull_off.compared(scene, 120)
    assert model_error == bound
    assert rings > 1.5  # far from JKR
    assert abs(ours / rings - 1) < bound


def test_rings_without_memory_are_jkr(pull_off):
    """At a Tabor number of 3 the attraction reaches a little further than an edge."""
    scene = pull_off.Scene(np.array([1.0]), np.array([0.1]), 3.0, 3.5, 1.0, True)
    assert np.isclose(
        pull_off.Rings(scene, 120).pull() / pull_off.JKR, 1.033, atol=5e-3
    )
