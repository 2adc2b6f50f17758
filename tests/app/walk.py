"""A random walk through the page: drop, type, choose, tick, slide, compute, reload. Where
it shows a result, every number is that of the call of the exported scene, and every doubt
of the call is said.
"""

import random
import re
import shutil
import time
import tomllib
import warnings
from pathlib import Path

import numpy as np

import elastomdr as em
from elastomdr.app.words import spoken
from elastomdr.cli.kinds import decoded
from elastomdr.cli.schema import given
from elastomdr.results.curve import AbstractCurve

SAMPLE = Path(__file__).parents[2] / "examples" / "data"
COMPUTED = ("Friction", "Compare", "Rolling", "Tyre", "Seal")
SCREENS = ("Rubber", "Road", *COMPUTED)
FILES = ("dma.csv", "dma-q800.txt", "road.csv", "profile.csv", "friction.csv")
GARBAGE = ("0.3 smoots", "-1", "", "1e400", "nan", "0", "a, b", "1 to 2")
# kind of a step and how often it is taken
STEPS = {"tab": 4, "compute": 6, "write": 6, "choose": 3, "tick": 2, "slide": 2}
STEPS |= {"unfold": 1, "drop": 2, "sample": 2, "reload": 1}
PATIENCE = 8.0  # seconds of computing after which the walk presses Stop
UNITS = {"MPa": 1e-6, "mm³": 1e9, "°C": 1.0}  # of a card, and an SI unit in them
# the texts of what is shown, whether something is being done, and whether it is marked
SHOWN = """() => {
    const panel = [...document.querySelectorAll('.q-tab-panel')].find(e => e.offsetParent);
    const seen = (what) => [...panel.querySelectorAll(what)].filter(e => e.checkVisibility());
    const texts = (what) => seen(what).map(e => e.textContent);
    return {
        numbers: texts('.right .number'),
        words: texts('.right > .words'),
        all: panel.innerText,
        notes: texts('.note, .alert, .q-field--error .q-field__messages'),
        said: texts('.sliders + .about'),
        table: texts('.right td'),
        busy: seen('.busy').length + panel.querySelectorAll('button.disabled').length
            + panel.innerText.includes('is being computed'),
        charts: seen('.chart').map(e => (e.data ?? []).flatMap(trace => [...(trace.y ?? [])])),
        screen: document.querySelector('[role=tab][aria-selected=true]').innerText.trim(),
    };
}"""


class Walk:
    """One page of the browser, walked through by a generator of this seed."""

    def __init__(self, page, place, seed):
        self.page, self.place, self.random = page, place, random.Random(seed)
        self.screen, self.done, self.compared = "Start", [], 0
        self.last = None  # what was compared last

    def steps(self, count):
        """Takes so many steps; what went before is in the message of a failure."""
        kinds, weights = zip(*STEPS.items(), strict=True)
        self.tab("Friction")
        for kind in ["compute", *self.random.choices(kinds, weights, k=count - 1)]:
            try:
                what = getattr(self, kind)()
                self.done.append(f"{self.screen}: {kind} {what or ''}")
                if kind not in ("write", "choose", "tick", "unfold"):
                    self.look()
            except BaseException as error:
                error.add_note("\n".join([*self.done, kind]))
                raise
        assert self.compared, self.done

    # ----------------------------------------------------------------------------------
    # steps

    def tab(self, screen=None):
        self.screen = screen or self.random.choice(SCREENS)
        self.page.locator(f"[role=tab]:has(:text-is('{self.screen}'))").click()
        of = f".of-{self.screen.lower()}:visible > *:visible"
        self.page.locator(of).first.wait_for()
        return self.screen

    def compute(self):
        if self.screen not in COMPUTED:
            self.tab(self.random.choice(COMPUTED))
        self.page.locator(".left > .buttons button:visible").last.click()

    def write(self):
        """Another number in a field, or garbage."""
        if (field := self.any_of(".left input[type=text]:not([readonly])")) is None:
            return None
        text = field.input_value() or field.get_attribute("placeholder") or "1"
        text = self.random.choice(GARBAGE) if self.random.random() < 0.2 else text
        factor = self.random.choice((0.5, 0.9, 1.1, 2.0))
        number = re.search(r"\d+\.?\d*(e-?\d+)?", text)
        if number is not None:
            scaled = f"{factor * float(number[0]):.4g}"
            text = text[: number.start()] + scaled + text[number.end() :]
        text = text.partition(", or ")[0]
        field.fill(text)
        return f"{field.get_attribute('aria-label')} = {text!r}"

    def choose(self):
        if (field := self.any_of(".left .q-select")) is None:
            return None
        label = field.locator(".q-field__label").first.text_content()
        field.click()
        options = self.page.locator(".q-menu .q-item:visible")
        for _ in range(20):
            if options.count():
                break
            self.page.wait_for_timeout(50)
        else:  # there is nothing to choose from
            self.page.keyboard.press("Escape")
            return f"{label}: nothing"
        option = options.nth(self.random.randrange(options.count()))
        chosen = option.text_content()
        option.click()
        self.page.keyboard.press("Escape")
        return f"{label} = {chosen}"

    def tick(self):
        if (box := self.any_of(".left .q-checkbox")) is None:
            return None
        box.click()
        return box.text_content()

    def slide(self):
        if (thumb := self.any_of(".right .q-slider [tabindex]")) is None:
            return None
        key = self.random.choice(("ArrowLeft", "ArrowRight"))
        for _ in range(self.random.randrange(1, 8)):
            thumb.press(key)
        return key

    def unfold(self):
        if (
            fold := self.any_of(".left .more > .q-expansion-item__container > *")
        ) is None:
            return None
        fold.first.click()
        return None

    def drop(self):
        self.tab(self.random.choice(("Rubber", "Road", "Friction")))
        file = self.random.choice(FILES)
        upload = self.page.locator(".q-tab-panel:visible .q-uploader").first
        upload.locator(".q-uploader__list:empty").wait_for(state="attached")
        upload.locator("input[type=file]").set_input_files(SAMPLE / file)
        return file

    def sample(self):
        self.tab(self.random.choice(("Rubber", "Road", "Friction")))
        self.page.locator(".q-uploader + button:visible").click()

    def reload(self):
        before = self.settled()
        self.page.reload()
        self.page.locator(
            f".of-{self.screen.lower()}:visible > *:visible"
        ).first.wait_for()
        after = self.settled()
        if not any("error" in note or "must" in note for note in before["notes"]):
            for key in ("numbers", "words", "table"):
                assert after[key] == before[key], key

    def any_of(self, selector):
        """One of the elements that are seen on this screen; None where there are none."""
        found = self.page.locator(f".q-tab-panel:visible {selector}:visible")
        count = found.count()
        return found.nth(self.random.randrange(count)) if count else None

    # ----------------------------------------------------------------------------------
    # what is shown

    def settled(self):
        """What is shown, once that has not changed for a while; what takes long is
        stopped.
        """
        begun, last, since = time.monotonic(), None, 0.0
        while True:
            now = self.page.evaluate(SHOWN)
            if now != last:
                last, since = now, time.monotonic()
            if now["busy"] and time.monotonic() - begun > PATIENCE:
                stop = self.page.locator(".busy button:visible")
                if stop.count():
                    stop.first.click()
            if not now["busy"] and time.monotonic() - since > 0.7:
                return now
            assert time.monotonic() - begun < 60
            self.page.wait_for_timeout(60)

    def look(self):
        """Compares what is shown with the call of the scene that the page exports."""
        shown = self.settled()
        assert "undefined" not in shown["all"]
        screen = self.screen = shown["screen"]  # an error may lead to another one
        now = screen, shown["words"], shown["numbers"], shown["said"]
        if screen not in COMPUTED or not shown["charts"] or now == self.last:
            return
        self.last = now
        if any("before the last change" in note for note in shown["notes"]):
            return  # its rubber may have been fitted anew
        verb, scene, folder = self.exported(screen)
        self.tab(screen)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            asked = decoded(verb, scene)
            result = getattr(em, asked.called())(**asked.arguments(folder))
            if verb == "compare":
                result = result.ranking(**given(asked.compare))
        shutil.rmtree(folder)
        ours = (
            em.ConvergenceWarning,
            em.ExtrapolationWarning,
            em.ModelWarning,
            em.fit.FitWarning,
        )
        for each in caught:
            if issubclass(each.category, ours):
                assert spoken(str(each.message)) in " ".join(shown["notes"])
        said = " ".join(shown["all"].split())
        for doubt in result.doubts:
            assert " ".join(spoken(doubt.says).split()) in said
        self.compared += 1
        if verb == "compare":
            assert shown["words"] == [spoken(result.summary())]
            for place in result.places:
                assert f"{place.mu:.3f}" in shown["table"]
            return
        (words,) = shown["words"]
        assert words.startswith(spoken(result.summary()))
        self.numbers(shown["numbers"], result)
        self.curves(shown["charts"], result)
        if screen == "Friction":
            self.readings(shown["said"], result)

    def exported(self, screen):
        """Verb, scene and a copy of the folder with its files, of the screen Export."""
        self.tab("Export")
        cards = self.page.locator(".of-export section.card").filter(
            has=self.page.locator(f".lead:text-is('{screen}')")
        )
        text = cards.locator(".words").text_content()
        name = re.search(r"session=(\w+)", self.page.url)[1]
        (session,) = self.place.glob(f"elastomdr-app-*/{name}")
        folder = self.place.parent / "taken"
        shutil.copytree(session, folder)
        return text.split()[2], tomllib.loads(text), folder

    def numbers(self, cards, result):
        """Each card's number is a value of the result, with the uncertainty there."""
        y = np.ravel(getattr(result, result.shows))
        unit = next(q for q in result.fields() if q.key == result.shows).unit
        if unit == "K":
            y = y - 273.15
        bound = getattr(result, "model_error", None)
        half = np.ravel(result.error + (np.nan if bound is None else bound))
        for card in cards:
            if not re.match(r"-?\d", card) or "%" in card:
                continue
            number, *_ = card.split()
            scale = next((s for u, s in UNITS.items() if u in card), 1.0)
            digits = ".1f" if unit == "K" else ".3g"
            here = [f"{scale * each:{digits}}" == number for each in y]
            assert any(here), card
            if isinstance(result, AbstractCurve):
                (said,) = re.findall(r"± (.*)", card) or [""]
                known = {f"{each:.2g}" for each in half[here]}
                assert said in known | {""}, card
                assert said or not (half[here] > 0.01 * y[here]).any(), card

    def curves(self, charts, result):
        """Each point of the result is in the figure, in the unit of its axis."""
        unit = next(q for q in result.fields() if q.key == result.shows).unit
        y = np.ravel(getattr(result, result.shows))
        y = np.abs(y[np.isfinite(y)] - (273.15 if unit == "K" else 0.0))
        drawn = np.array([each for chart in charts for each in chart], float)
        drawn = np.unique(np.abs(drawn[np.isfinite(drawn)]))
        for scale in (1.0, 1e3, 1e6, 1e9, 1e-3, 1e-6, 100.0):
            nearest = np.abs(drawn[:, None] - scale * y).min(axis=0)
            if (nearest <= 1e-9 * scale * y).all():
                return
        raise AssertionError((drawn, y))

    def readings(self, said, result):
        """The line below the sliders, read from the curves anew."""
        if not said:
            return
        velocity = float(re.match(r"At ([\d.e+-]+) m/s", said[0])[1])
        shown = [float(each) for each in re.findall(r"µ = ([\d.e+-]+)", said[0])]
        speed = np.broadcast_to(result.velocity, result.mu.shape)
        if np.ptp(speed) == 0:
            expected = np.ravel(result.mu)
        else:
            rows = result.mu.reshape(-1, result.mu.shape[-1])
            x = np.log(speed.reshape(rows.shape))
            expected = np.array(
                [
                    np.interp(np.log(velocity), *pair)
                    for pair in zip(x, rows, strict=True)
                ]
            )
        np.testing.assert_allclose(shown, expected[np.isfinite(expected)], rtol=0.02)
