"""The page by a simulated user: empty files, many tabs, presets, temperatures of
measured points.
"""

import asyncio
import dataclasses
import io
import threading
import time
import tomllib
import warnings
import weakref
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import elastomdr as em
from elastomdr.app.scene import CancelledError, bundle, compute
from elastomdr.app.security import Folder

from ..refused import mentions
from .simulated import STOPPED, simulated, until

SAMPLE = Path(__file__).parents[2] / "examples" / "data"
pytestmark = [
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings(STOPPED),
]


async def dropped(user, screen, *files):
    """Drops files, by name and content, on a screen; returns what is said there, empty
    where nothing is.
    """
    from nicegui import ui
    from nicegui.elements.upload_files import SmallFileUpload

    upload = next(e for e in _within(screen) if isinstance(e, ui.upload))
    alert = next(
        e for e in _within(screen) if isinstance(e, ui.label) and "alert" in e.classes
    )
    await upload.handle_uploads(
        [SmallFileUpload(name, "text/csv", content) for name, content in files]
    )
    await asyncio.sleep(0.1)
    return alert.text if alert.visible else ""


def _within(screen):
    """All elements of a screen, in order: those of the panel that its form stands
    in.
    """
    panel = next(
        slot.parent
        for slot in _above(screen.form._place)
        if "q-tab-panel" in slot.parent.tag
    )
    return list(panel.descendants())


def _above(element):
    while element.parent_slot is not None:
        yield element.parent_slot
        element = element.parent_slot.parent


def test_empty_files(tmp_path):
    """Each is answered where it was dropped, alone and beside a good one; the next good
    file takes the answer away.
    """

    async def act(user, page, opened):
        for screen in (
            page.screen("Rubber"),
            page.screen("Road"),
            page.screen("Friction"),
        ):
            said = await dropped(user, screen, ("none.csv", b""))
            assert said == (
                "file must be a file with content, got 'none.csv': it is empty (0 "
                "bytes): export or copy it again. Nothing has "
                "been changed."
            )
        assert "'none.csv': it is empty" in await dropped(
            user, page.screen("Rubber"), ("a.csv", b"1"), ("none.csv", b"")
        )
        assert not page._session.rubber["data"]
        assert "broken.toml" in await dropped(
            user, page.screen("Rubber"), ("broken.toml", b"name = ")
        )
        assert not page._session.folder.names(".toml")  # is not offered as a rubber
        material = (
            Path(em.__file__).parents[2] / "materials" / "epdm-70.toml"
        ).read_bytes()
        assert await dropped(user, page.screen("Rubber"), ("own.toml", material)) == ""
        assert page._session.scenes["friction"]["material"] == "own.toml"
        page._session.folder.remove()
        said = await dropped(user, page.screen("Rubber"), ("a.csv", b"1"))
        assert said.startswith("The file could not be kept: ")

    simulated(tmp_path, act)


def errors(form):
    """What is said beside the fields."""
    said = {name: getattr(w, "error", None) for name, w in form.widgets.items()}
    return {name: message for name, message in said.items() if message}


def test_an_error_leads_to_the_screen_of_its_field(tmp_path):
    """What the screen Compare takes of the screen Friction is filled in there; all that
    is folded over a field opens.
    """

    async def act(user, page, opened):
        contact = page._session.scenes["friction"]["contact"]
        compare, friction = page.screen("Compare"), page.screen("Friction")
        friction.form.set("[contact] pressure", "0.3 smoots")
        page._go("Compare")
        await compare.compute()
        assert page._tabs.value == "Friction"
        assert list(errors(friction.form)) == ["[contact] pressure"]
        friction.form.set("[contact] pressure", "0.3 MPa")
        assert contact["pressure"] == "0.3 MPa"
        page._go("Compare")
        compare.form.set("[compare] velocity", "1 smoot")
        await compare.compute()
        assert page._tabs.value == "Compare"
        assert list(errors(compare.form)) == ["[compare] velocity"]
        hidden = {name for name, folds in friction.form._folded.items() if folds}
        assert "[contact] gamma" in hidden
        wrong = em.InputError(argument="[contact] gamma", accepted="0 to 1")
        friction.form.show_error(wrong)
        assert all(fold.value for fold in friction.form._folded["[contact] gamma"])

    simulated(tmp_path, act)


ALL = ("Friction", "Compare", "Rolling", "Tyre", "Seal")


def test_an_answer_fits_what_was_dropped(tmp_path):
    """The walk of docs/app.md. Until the file is fitted, every screen says which rubber
    it takes in its place; the question is there again when the page is.
    """

    async def act(user, page, opened):
        q800, profile = (
            (name, (SAMPLE / name).read_bytes())
            for name in ("dma-q800.txt", "profile.csv")
        )
        session = page._session
        await dropped(user, page.screen("Rubber"), q800)
        await until(lambda: errors(page.screen("Rubber").form))
        for name in ALL:
            taken = session.scenes["friction"]["material"]
            said = page.screen(name)._unfitted
            assert said.visible
            assert said.text.startswith("dma-q800.txt is not fitted"), name
            assert taken == "epdm-70"
            assert taken in said.text
        page = await opened(f"/?session={session.name}")
        rubber = page.screen("Rubber")
        assert "“Kind of moduli” tensile" in errors(rubber.form)["kind"]
        rubber.form.widgets["kind"].value = "tensile"
        await until(lambda: session.fits)
        assert not errors(rubber.form)
        await dropped(user, page.screen("Road"), profile)
        await until(lambda: not page.screen("Road")._reading.on)
        friction = page.screen("Friction")
        friction.form.set("[contact] velocity", "1, 10")
        await friction.compute()
        done = session.done["friction"]
        assert done.content["material"] == "dma-q800.toml"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # they are on the screens
            dma = em.read_dma(SAMPLE / "dma-q800.txt", kind="tensile")
            again = em.friction(
                em.fit.material(dma).material,
                em.read_surface(SAMPLE / "profile.csv"),
                velocity=[1.0, 10.0],
                pressure=3e5,
                temperature=np.array([[273.15], [293.15], [313.15]]),
            )
        np.testing.assert_allclose(done.result.mu, again.mu, rtol=1e-9)
        assert not any(page.screen(name)._unfitted.visible for name in ALL)
        # an entry that is not fitted yet; a typed answer
        rubber.form.set("poisson", "5")
        page.screen("Friction").look()
        assert mentions(page.screen("Friction")._unfitted.text, "dma-q800", "rubber")
        await rubber.fit()
        assert "poisson" in errors(rubber.form)
        assert friction._unfitted.visible
        rubber.form.set("poisson", "0.49")
        await rubber._answered()
        page.screen("Friction").look()
        assert not friction._unfitted.visible
        assert session.fits["dma-q800.toml"].asked["poisson"] == 0.49

    simulated(tmp_path, act)


def test_what_others_change_is_what_is_filled_in(tmp_path):
    """A rubber that is fitted anew under its name, and the road of a slip curve: the
    result is marked, and its archive gives its own numbers.
    """

    async def act(user, page, opened):
        rubber, friction = page.screen("Rubber"), page.screen("Friction")
        await rubber._sample()
        friction.form.set("[contact] velocity", "1, 10")
        await friction.compute()
        tyre = page.screen("Tyre")
        tyre.form.set("[contact] slip", "0.1, 0.3")
        tyre.form.set("[contact] load", "4 kN")
        await tyre.compute()
        friction.form.set("[contact] velocity", "1, 20")  # the wheel has its own
        await page._look()
        assert not tyre._old.visible
        friction.form.set("[contact] velocity", "1, 10")
        page.screen("Road").form.set("[surface] hurst", "0.9")
        await page._look()
        assert tyre._old.visible
        page.screen("Road").form.set("[surface] hurst", "0.8")
        await page._look()
        assert not tyre._old.visible
        assert not friction._old.visible
        rubber.form.set("poisson", "0.45")
        await rubber.fit()
        await page._look()
        assert tyre._old.visible
        assert friction._old.visible
        done, folder = page._session.done["friction"], tmp_path / "taken"
        archive = bundle(done, page._session.folder, "friction")
        zipfile.ZipFile(io.BytesIO(archive)).extractall(folder)
        scene = tomllib.loads((folder / "friction.toml").read_text())
        again = compute("friction", scene, Folder(folder)).result
        np.testing.assert_array_equal(again.mu, done.result.mu)

    simulated(tmp_path, act)


def test_open_tabs_are_kept(tmp_path, monkeypatch):
    """However many tabs are open, none loses its session or its files; those go that
    nothing shows any more.
    """
    from elastomdr.app import session

    monkeypatch.setattr(session, "_MOST", 1)

    async def act(user, first, opened):
        others = [await opened() for _ in range(2)]
        sessions = [page._session for page in (first, *others)]
        assert all(each.folder.path.is_dir() for each in sessions)
        assert (await opened(f"/?session={sessions[0].name}"))._session is sessions[0]
        assert "is empty" in await dropped(
            user, first.screen("Rubber"), ("none.csv", b"")
        )
        for page in others:
            # as NiceGUI does a minute after a tab was closed
            page.screen("Rubber").form._place.client.delete()
        await opened()
        assert [each.folder.path.is_dir() for each in sessions] == [
            True,
            False,
            True,
        ]

    simulated(tmp_path, act)


def test_an_isotherm_shifted_by_hand_stays_over_a_reload(tmp_path):
    async def act(user, page, opened):
        rubber = page.screen("Rubber")
        await rubber._sample()
        editor = rubber._editor
        editor._isotherm.value = 0
        shifted = float(rubber._fitted.fit.master.log10_a[0]) + 0.5
        before = editor._said.text
        editor._moved(shifted)
        await until(lambda: editor._said.text != before)
        again = await opened(f"/?session={page._session.name}")
        reloaded = again.screen("Rubber")
        assert reloaded is not rubber
        of_fit = reloaded._fitted.figures["master"]
        await until(lambda: reloaded._pictures["master"]._drawn is not of_fit)
        assert reloaded._editor._isotherm.value == 0
        assert reloaded._editor._slider.value == pytest.approx(shifted)
        assert reloaded._editor._said.text == editor._said.text
        reloaded._editor._back()
        assert reloaded._pictures["master"]._drawn is of_fit
        await rubber.fit()
        assert not rubber._fitted.offsets.any()

    simulated(tmp_path, act)


def test_sessions_of_many_tabs(tmp_path):
    from elastomdr.app.session import Sessions

    sessions, gone = Sessions(tmp_path), []
    tabs = [sessions.get(None)]
    while len(tabs) < 25:
        tabs[-1].shown_by(SimpleNamespace(id=str(len(tabs)), on_delete=gone.append))
        tabs.append(sessions.get(None))
    assert all(tab.folder.path.is_dir() for tab in tabs)
    assert all(sessions.get(tab.name) is tab for tab in tabs)
    for close in gone:
        close()
    sessions.get(None)
    assert sum(tab.folder.path.is_dir() for tab in tabs) == 20
    assert not tabs[0].folder.path.exists()


def test_presets_are_the_defaults_of_the_calls(tmp_path):
    """A cover is bonded, as an `em.layer` is, on every screen that has one."""

    async def act(user, page, opened):
        for kind in ("rolling", "heat_build_up", "conveyor"):
            await page.screen("Rolling")._other_kind(SimpleNamespace(value=kind))
            bonded = page.screen("Rolling").form.widgets["[layer] bonded"]
            assert (
                bonded.value
                is em.layer(em.load_material("epdm-70"), 6e-3).bonded
                is True
            )
        page.screen("Tyre")
        wheel = page._session.scenes["traction"]
        assert wheel["material"] == page._session.scenes["friction"]["material"]
        assert wheel["friction"] == "computed"
        await the_road_of_a_slip_curve(page)

    simulated(tmp_path, act)


def test_the_belt_lies_on_sets_of_three_rolls(tmp_path):
    """20.3 kW/km at 5 m/s; 26.2 where one roll carries all, which nobody meant."""
    from elastomdr.app.screens import preset

    done = compute("rolling", preset("conveyor", "epdm-70"), Folder(tmp_path))
    cover = em.layer(em.load_material("epdm-70"), 6e-3)
    short, long = (em.Cylinder(79.5e-3, length) for length in (0.4, 1.2))
    again = em.conveyor(
        em.Idlers(cover, short, spacing=1.2, shares=[0.2, 0.6, 0.2]),
        em.Idlers(cover, long, spacing=3.0),
        velocity=5.0,
        belt=28.0,
        goods=120.0,
        temperature=283.15,
    )
    assert done.result.power[-1] == pytest.approx(float(again.power), rel=1e-9)
    assert 20.2 < again.power < 20.4

    async def act(user, page, opened):
        rolling = page.screen("Rolling")
        await rolling._other_kind(SimpleNamespace(value="conveyor"))
        shares = rolling.form.widgets["[conveyor] shares"]
        assert shares.value == "0.2, 0.6, 0.2"
        assert "[conveyor] shares" not in rolling.form._folded
        rolling.form.set("[conveyor] shares", "")  # stays in sight
        rolling.form.draw()
        assert "[conveyor] shares" not in rolling.form._folded

    simulated(tmp_path, act)


async def the_road_of_a_slip_curve(page):
    """What is wrong with its road is said on the road's screen, and with its wheel
    beside the field.
    """
    page._session.scenes["friction"]["surface"]["longest"] = "5 smoots"
    await page.screen("Tyre").compute()
    assert page._tabs.value == "Road"
    longest = "[surface] longest"  # drawn anew with the value that was not typed there
    await until(lambda: page.screen("Road").form.widgets[longest].error)
    assert "smoots" in page.screen("Road").form.widgets[longest].error
    page._session.scenes["friction"]["surface"]["longest"] = "5 mm"
    page.screen("Tyre").form.set("[contact] slip", "0, 0.1")
    await page.screen("Tyre").compute()
    assert (
        "must be other than zero"
        in page.screen("Tyre").form.widgets["[contact] slip"].error
    )
    page.screen("Tyre").form.set("[contact] slip", "0.1")
    page._session.scenes["friction"]["heat"] = {"conductivity": "2 m"}
    await page.screen("Tyre").compute()
    assert "“Thermal conductivity λ”" in page.screen("Tyre").form._alert.text
    page._session.scenes["friction"].pop("heat")
    form = page.screen("Friction").form
    for box in ("heat", "adhesion"):
        form.set(box, True)
    options = form.widgets["[adhesion] preset"].options
    assert mentions(options["rubber on a road"], "typical", 5, 7, "Lorenz")
    form.set("[adhesion] preset", "rubber on a road")
    assert mentions(form.widgets["[heat] preset"].options["filled rubber"], "CIBSE")
    form.set("[heat] preset", "filled rubber")
    scene = page._session.scenes["friction"]
    assert scene["adhesion"] == {"preset": "rubber on a road"}
    assert scene["heat"] == {"preset": "filled rubber"}


def test_friction_calibrated_on_the_page(tmp_path):
    """Cutoff and shear law go into the scene, which is computed with them; without
    points the field says what is missing.
    """

    async def act(user, page, opened):
        stage = page.screen("Friction")
        await stage.calibrate()
        assert stage.form.widgets["measured"].error
        scene = page._session.scenes["friction"]
        road = em.SelfAffine(0.8, rms_slope=1.3, q_low=1256.6, q_high=6.28e4)
        law = em.AdhesiveShear(8e6, 1e-2, 0.1, shift=em.Arrhenius(8e4, 293.15))
        velocity, kelvin = np.geomspace(1e-5, 1.0, 6), np.array([[278.15], [308.15]])
        mu = em.friction(
            em.load_material("tread-passenger-synthetic"),
            road.ended(5e4),
            velocity=velocity,
            temperature=kelvin,
            pressure=3e5,
            adhesion=law,
        ).mu
        rows = ["v [m/s],T [K],mu"]
        rows += [
            f"{velocity[j]},{kelvin[i, 0]},{value}"
            for (i, j), value in np.ndenumerate(mu)
        ]
        scene.pop("heat", None)
        scene.pop("adhesion", None)
        page._session.folder.keep("rig.csv", "\n".join(rows).encode())
        scene["measured"] = "rig.csv"
        await stage.calibrate()
        assert "cutoff" in scene["surface"]
        assert page._session.done["friction"].asked["adhesion"] == scene["adhesion"]
        assert float(scene["adhesion"]["energy"].split()[0]) == pytest.approx(
            8e4, rel=0.2
        )
        assert not stage._sliders._of["[surface] shortest"]._place.visible
        (taken,) = (
            t for t in page.screen("Export")._taken() if t.title == "Calibration"
        )
        found = page._session.calibrated.found
        for name in ("friction-material.toml", "friction-surface.csv"):
            (tmp_path / name).write_bytes(taken.files[name][1]())
        rubber = em.load_material(tmp_path / "friction-material.toml")
        np.testing.assert_array_equal(rubber.moduli, found.material.moduli)
        surface = em.read_spectrum(tmp_path / "friction-surface.csv", convention="2d")
        assert float(surface.q_high) == pytest.approx(float(found.shape.q_high))

    simulated(tmp_path, act)


def test_measured_points_get_curves_at_their_temperatures():
    from elastomdr.app.computed import _with_measured

    sample = SAMPLE / "friction.csv"  # at 0, 20 and 60 degC
    assert _with_measured(
        {"temperature": ["0 degC", "20 degC", "40 degC"]}, sample
    ) == [
        "0 degC",
        "20 degC",
        "40 degC",
        "60 degC",
    ]
    assert _with_measured({"temperature": "293.9 K"}, sample) == [
        "0 degC",
        "293.9 K",
        "60 degC",
    ]
    assert _with_measured({"temperature": "warm"}, sample) == "warm"
    assert _with_measured({}, sample) is None
    assert _with_measured({"temperature": "20 degC"}, SAMPLE / "dma.csv") == "20 degC"


def test_not_more_curves_than_can_be_told_apart(write):
    from elastomdr.app.computed import _with_measured

    rows = "".join(f"1,{t},0.3\n" for t in np.arange(-40, 100, 10))
    many = write(f"velocity [m/s],temperature [degC],mu\n{rows}", "many.csv")
    assert _with_measured({"temperature": "20 degC"}, many) == "20 degC"


def test_cutoffs_are_asked_for(tmp_path):
    """Of a dropped spectrum, each within what was measured, with its rms slope."""
    from elastomdr.app.road import look
    from elastomdr.app.session import Session

    session = Session("one", Folder(tmp_path))
    name = session.folder.keep("road.csv", SAMPLE.joinpath("road.csv").read_bytes())
    asked = {"shape": "spectrum", "file": name, "convention": "2d"}
    offers = look(asked, session).offers
    assert offers[0][:2] == ("5 mm", "100 um")
    for longest, shortest, slope in offers:
        seen = look(asked | {"longest": longest, "shortest": shortest}, session)
        assert not seen.offers
        said = float(seen.words.split("rms slope")[1].split(",")[0])
        assert slope == pytest.approx(said, rel=5e-3)


def test_cutoffs_are_asked_for_heights(tmp_path):
    """Of a topography the shortest wave, with the rms slope down to it."""
    from elastomdr.app.road import look
    from elastomdr.app.session import Session

    session = Session("one", Folder(tmp_path))
    road = em.SelfAffine(0.8, 0.3, q_low=2e3, q_high=1e6, q_rolloff=6e3)
    heights = road.line(periods=4, samples=2**14)
    table = np.transpose([heights.x, heights.height])
    rows = "".join(f"{x:.9e},{height:.9e}\n" for x, height in table)
    name = session.folder.keep("profile.csv", f"x [m],height [m]\n{rows}".encode())
    asked = {"shape": "file", "file": name}
    offers = look(asked, session).offers
    assert [shortest for _, shortest, _ in offers[:2]] == ["100 um", "10 um"]
    seen = look(asked | {"shortest": "10 um"}, session)
    assert not seen.offers
    said = float(seen.words.split("rms slope")[1].split(",")[0])
    assert offers[1][2] == pytest.approx(said, rel=0.05)


def test_stop(tmp_path):
    """What is computed ends at once, and the next computation goes on."""

    async def act(user, page, opened):
        begun, ended = [], []

        def endless(content):
            try:
                begun.append(content)
                while True:
                    pass
            finally:
                ended.append(content)

        stage = page.screen("Friction")
        stage._computed_as_asked = endless
        task = asyncio.create_task(stage.compute())
        await until(lambda: begun)
        assert stage._busy.on
        stage._busy.stop()
        await task
        await until(lambda: ended)
        assert not stage._busy.on
        assert not stage._picture.shown
        stage._computed_as_asked = lambda content: SimpleNamespace(content=content)
        done = await stage._busy.during(COMPUTING, stage._computed, "next")
        assert done.content == "next"

    from elastomdr.app.session import COMPUTING

    simulated(tmp_path, act)


class Unheard:
    """Hears the first stop where Python drops it."""

    def __del__(self):
        waits()


def waits():
    while True:
        pass


def dropped_by_its_end():
    Unheard()


def dropped_by_a_weak_reference():
    dead = type("Dead", (), {})()
    watched = weakref.ref(dead, lambda _: waits())
    del dead
    assert watched() is None


@pytest.mark.parametrize(
    "drops", [dropped_by_its_end, dropped_by_a_weak_reference], ids=lambda f: f.__name__
)
def test_a_stop_that_is_dropped_is_repeated(tmp_path, drops):
    """What drops the first stop ends all the same, and only that."""
    from elastomdr.app.session import COMPUTING

    async def act(user, page, opened):
        begun, went_on = [], []

        def call():
            begun.append(drops)
            drops()
            went_on.append(drops)
            waits()

        busy = page.screen("Friction")._busy
        task = asyncio.create_task(busy.during(COMPUTING, call))
        await until(lambda: begun)
        busy.stop()
        with pytest.raises(CancelledError):
            await task
        assert await busy.during(COMPUTING, lambda: went_on) == [drops]

    simulated(tmp_path, act)


class Held:
    """A lock that says when the call that is stopped comes to its end."""

    def __init__(self):
        self.lock, self.taken, self.ending = threading.Lock(), 0, threading.Event()

    def __enter__(self):
        self.taken += threading.current_thread() is not threading.main_thread()
        if self.taken > 1:
            self.ending.set()
        try:
            self.lock.acquire()
        except BaseException:  # the stop came while it waited, and has the lock
            self.lock.release()
            raise

    def __exit__(self, *_):
        self.lock.release()


def test_a_stop_hits_nothing_else(monkeypatch):
    """A call that ends by itself while it is being stopped: what its thread does next is
    left alone.
    """
    from elastomdr.app import stage

    raised, stops, calm = stage._raise_in, threading.Event(), []

    def late(thread, exception):
        if exception is not None:
            stops.set()  # the call ends
            work._lock.ending.wait(1)
        raised(thread, exception)

    def between():
        try:
            work(begun_and_stopped)
        finally:
            for _ in range(20):
                time.sleep(0.1 if work._lock.taken == 1 else 0.001)
                calm.append(True)

    def begun_and_stopped():
        begun.set()
        stops.wait()

    monkeypatch.setattr(stage, "_raise_in", late)
    begun, work = threading.Event(), stage._Work()
    work._lock = Held()
    with ThreadPoolExecutor(1) as pool:
        running = pool.submit(between)
        begun.wait()
        work.stop()
        assert isinstance(running.exception(), CancelledError | None)
        assert len(calm) == 20
        assert pool.submit(sum, [1, 2]).result() == 3


def test_an_uncertainty_gives_way(tmp_path, monkeypatch):
    """What is asked for does not wait for it; it is computed afterwards."""
    from elastomdr.app import cards
    from elastomdr.app.session import COMPUTING
    from elastomdr.app.stage import worked

    begun = []

    def judge(done):
        begun.append(done)
        while begun.count(done) < 2:
            pass

    def is_left(done):
        """Of friction; the example of the first screen is not looked at."""
        return len(done.content["contact"]["velocity"]) == 2 and begun.count(done) < 2

    monkeypatch.setattr(cards.Done, "judge", judge)
    monkeypatch.setattr(cards.Done, "judges", property(is_left))

    async def act(user, page, opened):
        friction = page.screen("Friction")
        friction.form.set("[contact] velocity", "1, 10")
        await friction.compute()
        await until(lambda: begun)
        assert await worked(COMPUTING, len, "four") == 4
        await until(lambda: len(begun) == 2)
        await until(lambda: not friction._cards._judging.on)

    simulated(tmp_path, act)


def test_cards_of_friction_that_is_zero():
    """An elastic body: nothing is divided by its friction."""
    from elastomdr.app.cards import cards

    result = em.friction(
        em.Prony(1e6, [], []), em.Sphere(5e-3), velocity=[0.1, 1.0], load=1.0
    )
    top, sure, _ = cards(result)
    assert top.number == "0"
    assert sure.number == "below 0.1 %"


def test_cards_of_a_result():
    from elastomdr.app.cards import cards
    from elastomdr.app.page import example

    result = example().result
    *tops, sure, surer = cards(result)
    assert len(tops) == 3
    for i, top in enumerate(tops):
        assert top.number.startswith(f"{result.mu[i].max():.3g} ± ")
        assert mentions(top.notes, "model and computation alone")
    assert sure.title == "How sure"
    share = float(sure.number.split()[1]) / 100
    widest = np.max((result.error + result.model_error) / result.mu)
    assert 0.05 < share < 1.02 * widest < 0.5
    assert surer.notes


def test_the_power_of_a_belt_has_the_bound_of_its_coefficient():
    from elastomdr.app.cards import cards

    cover = em.layer(em.load_material("epdm-70"), 6e-3)
    side = em.Idlers(cover, em.Cylinder(0.08, 0.4), spacing=1.2)
    belt = em.conveyor(
        side, side, velocity=[2.0, 5.0], belt=28.0, goods=120.0, temperature=293.15
    )
    top, sure, _ = cards(belt)
    share = float((belt.model_error / belt.coefficient)[1])
    assert share > 0.01
    number, half = (part.split()[0] for part in top.number.split(" ± "))
    assert float(half) / float(number) == pytest.approx(share, rel=0.05)
    assert float(sure.number.split()[1]) == pytest.approx(100 * share, rel=0.05)


def at_one_velocity():
    road = em.SelfAffine(0.8, rms_slope=0.7, q_low=1257.0, q_high=125663.0)
    return em.friction(
        em.load_material("epdm-70"),
        road,
        velocity=2.78,
        pressure=3e5,
        temperature=[273.15, 293.15, 323.15],
    )


@pytest.mark.filterwarnings("ignore::elastomdr.errors.ExtrapolationWarning")
def test_one_velocity_and_three_temperatures():
    """0 degC is no -0.15 degC, each point is read at the one velocity, and the one that
    is extrapolated is marked alone.
    """
    from elastomdr.app.cards import cards
    from elastomdr.app.computed import _readings

    result = at_one_velocity()
    assert result.extrapolated.tolist() == [True, False, False]
    top, *_ = cards(result)
    assert top.notes[0] == "at 0 degC, the lowest temperature computed"
    half = result.error + result.model_error
    marks = ", extrapolated", "", ""
    names = "0 degC", "20 degC", "50 degC"
    assert list(_readings(result, 2.78)) == [
        f"{name}: µ = {mu:.3g} ± {spread:.2g}{mark}"
        for name, mu, spread, mark in zip(names, result.mu, half, marks, strict=True)
    ]
    assert mentions(result.summary(), "extrapolated", "1 of 3 points")


@pytest.mark.filterwarnings("ignore::elastomdr.errors.ExtrapolationWarning")
def test_a_reading_of_a_curve():
    """Between its points; what is not known, or lies beyond the data, is said."""
    from elastomdr.app.computed import _readings

    result = em.friction(
        em.load_material("epdm-70"),
        em.SelfAffine(0.8, rms_slope=0.7, q_low=1257.0, q_high=125663.0),
        velocity=[0.1, 1.0, 1e4],
        pressure=3e5,
        temperature=293.15,
    )
    known = np.array([0.01, np.nan, 0.001])
    result = dataclasses.replace(result, model_error=known)
    (first,) = _readings(result, 0.1)
    assert first == f"µ = {result.mu[0]:.3g} ± {result.error[0] + 0.01:.2g}"
    (between,) = _readings(result, 0.3)
    assert between.endswith("without a bound of the model")
    (beyond,) = _readings(result, 1e3)
    assert mentions(beyond, "without a bound", "extrapolated")


def sheared():
    """Where the shear exceeds the pressure of the contact, there is no prediction."""
    return em.friction(
        em.load_material("epdm-70"),
        em.SelfAffine(0.8, rms_slope=0.7, q_low=1257.0, q_high=125663.0),
        velocity=np.geomspace(1e-3, 1.0, 5),
        pressure=3e5,
        temperature=np.array([[293.15], [313.15]]),
        adhesion=em.AdhesiveShear(8e6, 1e-2, 0.1),
    )


@pytest.mark.filterwarnings("ignore::elastomdr.errors.ModelWarning")
@pytest.mark.filterwarnings("ignore::elastomdr.errors.ExtrapolationWarning")
def test_no_number_with_a_part_of_its_uncertainty():
    """Where no bound of the model is known, the numerical error alone is none."""
    from elastomdr.app.cards import cards

    result = sheared()
    assert np.isnan(result.model_error[:, 0]).all()
    *tops, sure, surer = cards(result)
    for i, top in enumerate(tops):
        assert top.number == f"{result.mu[i, 0]:.3g}"
        assert mentions(top.notes, "no bound of the model")
    assert sure.number == "not known"
    count = int(np.isnan(result.model_error).sum())
    assert f"no bound of the model: {count} of 10 points" in sure.notes
    assert surer.notes[0].startswith("A measured value")


@pytest.mark.filterwarnings("ignore::elastomdr.errors.ExtrapolationWarning")
@pytest.mark.filterwarnings("ignore::elastomdr.errors.ModelWarning")
def test_what_dominates_comes_first():
    """The road where its shortest wave decides; a shear that is assumed."""
    from elastomdr.app.cards import cards
    from elastomdr.app.words import quoted

    road = em.SelfAffine(0.8, rms_slope=0.7, q_low=1257.0, q_high=125663.0)
    given = {"velocity": np.geomspace(0.01, 1.0, 5), "pressure": 3e5}
    rubber = em.load_material("epdm-70")
    result = em.friction(rubber, road, temperature=293.15, **given)
    table = result.uncertainty()
    *_, sure, surer = cards(result, table)
    i = result.mu.argmax()
    at_peak = table["road"].share[i]
    assert sure.number == f"± {100 * table.half_band()[i]:.2g} %"
    assert sure.notes[0].startswith(f"road {100 * at_peak:.2g} %: shortest wave")
    best = table.at([i]).surer()[0]
    said = f"{100 * best.before:.2g} %, then {100 * best.after:.2g} %."
    assert surer.notes[0].endswith(said)
    assert "rubber not known: not computed" in sure.notes
    assert mentions(surer.notes, quoted("adhesion"), quoted("uncertainty"))
    assert not any(word in str(surer.notes) for word in ("em.", "=", "scene"))
    *_, sure, surer = cards(sheared(), sheared().uncertainty())
    assert sure.number.startswith("±")  # by the limits of mu
    assert mentions(sure.notes, "model", "limits")
    assert mentions(surer.notes, "scan of the road")  # friction narrows it by less


def test_cards_and_readings_of_draws_are_of_their_median(tmp_path):
    from elastomdr.app.cards import cards
    from elastomdr.app.computed import _readings
    from elastomdr.app.page import report

    content = {
        "material": "epdm-70",
        "temperature": "20 degC",
        "uncertainty": 4,
        "surface": {
            "shape": "self_affine",
            "hurst": 0.8,
            "rms_slope": 0.7,
            "longest": "5 mm",
            "shortest": "50 um",
            "cutoff_error": 0.2,
        },
        "contact": {"pressure": "0.3 MPa", "velocity": ["0.1 m/s", "1 m/s"]},
    }
    done = compute("friction", content, Folder(tmp_path))
    assert done.result.drawn
    assert done.judges
    done.judge()
    assert not done.judges
    low, middle, high = done.result.band()
    top, sure, _ = cards(done.shown, done.parts)
    i = middle.argmax()
    half = 0.5 * (high - low)[i]
    spread = half + done.shown.model_error[i]
    assert top.number == f"{middle[i]:.3g} ± {spread:.2g}"
    rubber = 100 * done.parts["rubber"].share[i]
    assert f"rubber {rubber:.2g} %: 95 % of 4 draws" in sure.notes
    assert mentions(sure.notes, "its upper cutoff to +- 0.2")
    assert mentions(cards(done.shown)[1].notes, "and 95 % of the draws")
    _, sure, _ = cards(done.shown)
    assert mentions(sure.notes, f"numerical {100 * half / middle[i]:.2g} %")
    (reading,) = _readings(done.shown, 0.1)
    assert reading.startswith(f"µ = {middle[0]:.3g} ")
    (tmp_path / "law.csv").write_bytes(done.law("csv"))
    np.testing.assert_allclose(
        np.ravel(em.load_friction(tmp_path / "law.csv").mu), middle
    )
    assert top.number in report("x", done, "").decode()


def test_every_kind_of_doubt_is_on_the_cards():
    """By the curve that has it, and with how many points have it and what would help."""
    from elastomdr.app.cards import cards

    road = em.SelfAffine(0.8, rms_slope=0.7, q_low=1257.0, q_high=125663.0)
    result = em.friction(
        em.load_material("epdm-70"),
        road,
        velocity=[0.1, 0.2],
        pressure=3e5,
        temperature=np.array([[293.15], [313.15]]),
    )
    assert not result.doubts
    points = np.array([[True, True], [False, False]])
    kinds = "extrapolated", "hot branch", "bound", "estimate", "illustrative"
    doubts = tuple(
        em.Doubt(kind, points, f"are {kind}", f"no {kind}") for kind in kinds
    )
    cold, warm, sure, surer = cards(dataclasses.replace(result, marks=doubts))
    said = " ".join(cold.notes)
    for word in ("not measured", "hotter state", "above half", "an estimate"):
        assert word in said
    assert len(warm.notes) == 2  # its place, and what its band is of
    assert sum("2 of 4 points" in note for note in sure.notes) == len(kinds)
    for kind in kinds[1:]:
        assert f"No {kind}." in surer.notes
    assert mentions(surer.notes, "Moduli measured at more")


def test_the_slider_of_the_temperature_shows_tenths():
    from elastomdr.app.computed import _celsius

    assert _celsius(273.15) == "0 degC"
    assert _celsius(273.15 - 0.04) == "0 degC"
    assert _celsius(295.65) == "22.5 degC"


def test_cards_say_of_how_many_curves_there_are_none():
    from elastomdr.app.cards import cards

    temperature = np.array([273.15, 293.15, 313.15])[:, None, None]
    rolling = em.rolling(
        em.load_material("epdm-70"), em.Cylinder(10e-3, 0.1), velocity=[0.1, 1.0],
        load=np.array([50.0, 100.0])[:, None], temperature=temperature,
    )  # fmt: skip
    shown = cards(rolling)
    assert [card.title for card in shown[-3:-2]] == ["And 2 more curves"]
    assert len(shown) == 4 + 3


def test_card_says_what_is_not_known_of_the_rubber():
    """Rolling's error is numerical, that of a rough road holds what a fit misses."""
    from elastomdr.app.cards import cards

    rubber = em.load_material("epdm-70")
    roller, point = (
        em.Cylinder(10e-3, 0.1),
        {"velocity": [0.1, 1.0], "temperature": 293.15},
    )
    _, sure, surer = cards(em.rolling(rubber, roller, load=100.0, **point))
    assert mentions(sure.notes, "numerical below", "rubber not known: not computed")
    assert mentions(surer.notes, "Draws of a fit")
    road = em.SelfAffine(0.8, rms_slope=0.7, q_low=1e3, q_high=1e5)
    _, sure, _ = cards(em.friction(rubber, road, pressure=3e5, **point))
    assert mentions(sure.notes, "misfit of the rubber")


@pytest.mark.filterwarnings("ignore::elastomdr.errors.ExtrapolationWarning")
def test_seals(tmp_path):
    """An O-ring over years and on a rod, and a start after a rest, as the calls compute
    them, with their cards.
    """
    from elastomdr.app.cards import cards
    from elastomdr.app.screens import SEAL, preset

    rubber, year = em.load_material("epdm-70"), 365.25 * 86400.0
    ring, stroke = (
        compute(SEAL.kinds[kind].verb, preset(kind, "epdm-70"), Folder(tmp_path)).result
        for kind in ("o_ring", "stroke")
    )
    squeezed = {"diameter": 5e-3, "squeeze": 0.2, "fluid_pressure": 2e6}
    alone = em.o_ring(
        rubber, **squeezed, groove_width=7e-3, time=10 * year, temperature=293.15
    )
    assert ring.pressure[-1, 1] == pytest.approx(float(alone.pressure), rel=1e-6)
    _, cold, *_ = cards(ring)
    assert cold.title == "Mean pressure at 20 °C"
    assert cold.number.startswith(f"{alone.pressure / 1e6:.3g} MPa ± ")
    when, _, whose = cold.notes  # between them what the band is of
    assert (when, whose) == ("after 10 years", "the rubber was not measured here")
    held = em.o_ring(rubber, **squeezed, time=300.0, temperature=293.15)
    out = em.reciprocating(
        rubber,
        o_ring=held,
        velocity_out=1.0,
        velocity_in=0.1,
        stroke=0.1,
        viscosity=0.05,
        width=0.16,
    )
    assert stroke.net_leak[-1] == pytest.approx(float(out.net_leak), rel=1e-9)
    largest, sure, _ = cards(stroke)
    assert largest.number == f"{1e9 * out.net_leak:.3g} mm³"
    assert sure.number == "not known"
    start = compute(
        "break_out", preset("break_out", "epdm-70"), Folder(tmp_path)
    ).result
    rod = em.SelfAffine(
        0.8, rms_slope=0.3, q_low=2 * np.pi / 100e-6, q_high=2 * np.pi / 4e-6
    )
    rest = em.break_out(
        rubber,
        rod,
        pressure=0.35e6,
        boundary_shear=0.2e6,
        time=10 * 86400.0,
        temperature=293.15,
    )
    assert start.mu[-1, 1] == pytest.approx(float(rest.mu), rel=1e-9)
    assert cards(start)[0].title == "Largest break-out coefficient at 0 °C"


def test_docs():
    """Each screen has a page of them, as the wheel and the site have it."""
    from elastomdr.app.page import _COMPUTED, _DOCS, PAGES, text

    named = {*_DOCS.values(), *(screen.docs for screen in _COMPUTED.values())}
    assert named <= PAGES.keys()
    wheel = (SAMPLE.parents[1] / "pyproject.toml").read_text(encoding="utf-8")
    for name in PAGES:
        assert f'"docs/{name}.md" = "elastomdr/app/data/{name}.md"' in wheel
        assert "](" not in text(name)
        assert "$" not in text(name)


def test_choices_say_what_they_mean(tmp_path):
    """Conventions of a spectrum by what they integrate to; a slider is there where its
    wave is given; friction of a wheel on the road is ticked, not typed.
    """
    from elastomdr.surface.spectrum import CONVENTIONS

    async def act(user, page, opened):
        road = page.screen("Road")
        await until(lambda: road._picture.shown)
        spectrum = (SAMPLE / "road.csv").read_bytes()
        await dropped(user, road, ("road.csv", spectrum))
        await until(lambda: "[surface] convention" in road.form.widgets)
        shown = road.form.widgets["[surface] convention"].options
        assert shown.keys() - {""} == CONVENTIONS.keys()
        assert all("⟨h²⟩ = ∫" in shown[word] for word in CONVENTIONS)
        assert len(set(shown.values())) == len(shown)
        await until(lambda: not road._sliders["[surface] longest"]._place.visible)
        sliders = page.screen("Friction")._sliders._of
        waves = [sliders[f"[surface] {key}"] for key in ("longest", "shortest")]
        assert not any(slider._place.visible for slider in waves)
        road.form.set("[surface] convention", "2d")
        await until(lambda: road._sliders["[surface] longest"]._place.visible)
        tyre = page.screen("Tyre")
        scene = page._session.scenes["traction"]
        assert not hasattr(tyre.form.widgets["friction"], "error")
        tyre.form.widgets["friction"].value = False
        assert "friction" not in scene
        tyre.form.set("friction", "0.8")
        assert scene["friction"] == 0.8

    simulated(tmp_path, act)
