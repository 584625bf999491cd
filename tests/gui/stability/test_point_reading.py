"""kindyna_gui.stability_view: what is told of the point under the mouse, at once and where it rests."""

import threading
import time
from collections.abc import Callable
from typing import Any

import pytest
from PySide6.QtCore import QPoint
from PySide6.QtTest import QTest
from stability_page import KIM, TURNS, page, pixel, unhurried
from window_user import Open, User, settle, wait_for

from core.numerics.lazy import checkpoint
from core.stability import EXACT, Stability, Verdict
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.stability_pages import verdict_table, waiting_text


@pytest.fixture
def kim(open_user: Open, monkeypatch: pytest.MonkeyPatch) -> User:
    """The window with Kim1990's cam, whose shaft is followed through few turns only: how many is no matter of the window."""
    monkeypatch.setattr(Stability, "turns", TURNS)
    return open_user(KIM, size=(1440, 900))


def test_the_mouse_reads_tongue_and_growth_at_once(kim: User) -> None:
    view = page(kim, rest=False)
    edges = view.drawn.tongues[EXACT].edges[-1]
    q = float(view.drawn.q[-1]) * 0.98
    QTest.mouseMove(view.chart.viewport(), pixel(view, float(edges[1].mean()), q))
    settle()
    place, slow = view.reading.text().split("\n")
    assert "tongue 2; " in place
    assert "exact (21) grows" in place
    assert "rpm" in place
    assert "computing" in slow
    QTest.mouseMove(view.chart.viewport(), pixel(view, 0.75, q))
    settle()
    assert "between tongues; approximate (22) stable; exact (21) stable" in view.reading.text()


def test_where_the_mouse_rests_every_model_tells_its_verdict(kim: User, monkeypatch: pytest.MonkeyPatch) -> None:
    """The slow ones are computed by another thread than the window's, and only there."""
    view = page(kim)
    threads: set[int] = set()
    for name in ("steady_at", "rest_at"):
        monkeypatch.setattr(Stability, name, heard(getattr(Stability, name), threads))
    QTest.mouseMove(view.chart.viewport(), pixel(view, 0.75, 0.1))
    assert view.reading.busy
    wait_for(lambda: not view.busy)
    assert not view.progress.isVisible()
    place, *slow = view.reading.text().split("\n")
    assert place.startswith("η = 0.7")
    assert [v.model for v in view.reading.verdicts] == ["approx_22", "exact_21", "from_rest", "steady"]
    assert [line.split(":")[0] for line in slow] == ["steady", "from rest"]
    assert slow[0].startswith("steady: stable, ")
    width = max(view.reading.fontMetrics().horizontalAdvance(line) for line in (place, *slow))
    assert width < view.reading.width(), "nothing is cut off"
    assert view.stability is not None
    eta, q = view.reading.point
    gone = view.stability.history(None, eta, q)
    assert view.reading.verdicts[2].largest == gone.largest[0]
    assert len(threads) >= 1
    assert threading.get_ident() not in threads
    QTest.mouseMove(view.chart.viewport(), QPoint(2, 2))
    settle()
    assert view.reading.text() == ""


def heard(method: Callable[..., Verdict], threads: set[int]) -> Callable[..., Verdict]:
    def hearing(*words: Any) -> Verdict:
        threads.add(threading.get_ident())
        return method(*words)

    return hearing


@pytest.mark.stress
def test_what_the_mouse_has_left_or_an_edit_made_untrue_is_given_up(kim: User, monkeypatch: pytest.MonkeyPatch) -> None:
    view = page(kim)
    asked: list[tuple[float, float]] = []

    def endless(found: Stability, eta: float, q: float) -> Verdict:
        asked.append((eta, q))
        while True:
            checkpoint()
            time.sleep(0.001)

    monkeypatch.setattr(Stability, "rest_at", endless)
    QTest.mouseMove(view.chart.viewport(), pixel(view, 0.75, 0.1))
    wait_for(lambda: len(asked) == 1)
    assert view.progress.isVisible()
    with unhurried(view):
        QTest.mouseMove(view.chart.viewport(), pixel(view, 1.25, 0.1))
        settle()
        assert not view.reading.background.busy, "it waits for the mouse to rest anew"
        assert not view.progress.isVisible()
    wait_for(lambda: len(asked) == 2)
    assert asked[1][0] == pytest.approx(1.25, abs=0.02)
    monkeypatch.undo()
    monkeypatch.setattr(Stability, "turns", TURNS)
    kim.session.edit("shaft.speed_rpm", 1400.0, "Change speed")
    settle()
    assert not view.reading.busy
    assert view.reading.text() == ""
    wait_for(lambda: not view.busy)


def test_the_words_for_each_verdict() -> None:
    steady, lost = Verdict("steady", True, largest=0.1), Verdict("steady", False, 0.05, 2.1, 0.1, 2.275)
    assert waiting_text((steady,), False) == "steady: stable, 36.0°"
    assert waiting_text((lost,), True) == (
        "steady: grows 5.13 % a turn, 36.0°, off the cam at turn 2.275\nstill computing …"
    )
    assert waiting_text((Verdict("steady", None),), False) == "steady: no steady response"
    left = Verdict("steady", True, -0.01, 1.9, 0.1, 2.275)
    assert waiting_text((left,), False) == "steady: contact lost, 36.0°, off the cam at turn 2.275"
    rest = Verdict("from_rest", None, largest=0.01, contact_lost=3.3)
    assert waiting_text((rest, steady), False).endswith("\nfrom rest: 3.60°, not settled, off the cam at turn 3.300")
    assert waiting_text((), True) == "nonlinear models: computing …"


def test_a_machine_that_leaves_its_cam_is_not_stable_in_green() -> None:
    linear, steady = Verdict(EXACT, True, -0.01, 1.9), Verdict("steady", True, -0.01, 1.9, 0.1)
    off = Verdict("steady", True, -0.01, 1.9, 0.1, 2.275)
    assert verdict_table((linear, steady)).count(f"color:{LIGHT.good}") == 2
    table = verdict_table((linear, off))
    assert LIGHT.good not in table
    assert f'color:{LIGHT.limit}">contact lost' in table
