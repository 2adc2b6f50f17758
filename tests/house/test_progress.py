"""What is computed within `em.progress` says how far it is, within a second, on a
terminal; nothing is shown elsewhere.
"""

import contextlib
import io
import time

import pytest

import elastomdr as em
from elastomdr import progress_bar

from ..refused import refused


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


@pytest.fixture
def terminal(monkeypatch):
    stream = Terminal()
    monkeypatch.setattr(progress_bar, "DELAY", 0.02)
    monkeypatch.setattr(progress_bar, "_SHORTEST", 0.0)
    monkeypatch.setattr(progress_bar, "_in_notebook", lambda: False)
    return stream


def appears(terminal):
    """Waits for the bar."""
    end = time.monotonic() + 20
    while not terminal.getvalue() and time.monotonic() < end:
        time.sleep(0.01)


def test_a_bar_says_what_is_done_and_the_time_that_is_left(terminal):
    with contextlib.redirect_stderr(terminal), em.progress("pressing"):
        appears(terminal)  # nothing is counted yet
        assert "pressing: 00:00" in terminal.getvalue()
        with progress_bar.counted("each roller", 4) as add:
            add(1)
            with progress_bar.counted("within a roller", 9) as within:
                within(5)  # is not shown
            add(1)
    assert "each roller:  50 %" in terminal.getvalue()
    assert "left" in terminal.getvalue()
    assert "within" not in terminal.getvalue()


def test_materials_are_counted(terminal, monkeypatch):
    monkeypatch.setattr(progress_bar, "DELAY", 0.0)
    rubber = em.load_material("silicone-like")
    with contextlib.redirect_stderr(terminal), em.progress():
        appears(terminal)
        em.friction([rubber] * 3, em.Sphere(1e-2), velocity=0.1, load=1.0)
    assert "each material:  67 %" in terminal.getvalue()


def test_nothing_is_shown_where_nobody_looks(capsys):
    pytest.importorskip("ipykernel")  # imported is not a notebook
    with em.progress(), progress_bar.counted("rollers", 1) as add:
        add(1)
        assert progress_bar._bar.get() is None
    assert capsys.readouterr().err == ""


def test_what_is_done_must_be_a_text():
    with (
        refused("doing", 3),
        em.progress(3),
    ):
        pass
