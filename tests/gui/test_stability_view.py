"""kindyna_gui.stability_*: the chart under the mouse, verdicts and histories beside it, the shaft that a point needs."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt, QTimer
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Open, User, settle

from core.design import with_elastic
from core.project import load
from core.stability import EXACT, Curve, Figure, History, Plot, Stability, Verdict, chart, flexible, mean_wind_up
from core.study import Study, evaluations
from kindyna_gui.__main__ import main
from kindyna_gui.pictures.files import chart_file
from kindyna_gui.pictures.xy_sheet import figure_file
from kindyna_gui.places import example
from kindyna_gui.stability_view import COARSE, FINE, StabilityView
from kindyna_gui.stability_words import waiting_text

KIM = example("kim_1990")
LEFT = Qt.MouseButton.LeftButton
PATIENCE = 40.0
TURNS = 3.0  # a shaft is followed from rest


def wait_until(condition: Callable[[], bool]) -> None:
    """Let events run and, unlike ``qWait``, other threads as well."""
    patience = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < patience, "waited in vain"
        QApplication.processEvents()
        time.sleep(0.002)


@pytest.fixture(autouse=True)
def short_histories(monkeypatch: pytest.MonkeyPatch) -> None:
    """How long a shaft is followed is no matter of the window."""
    monkeypatch.setattr(Stability, "turns", TURNS)


@pytest.fixture
def kim(open_user: Open, short_histories: None) -> User:
    return open_user(KIM, size=(1440, 900), plots=False)


def page(user: User, rest: bool = True) -> StabilityView:
    user.choose("Stability", "Chart")
    view = user.window.view("stability")
    assert isinstance(view, StabilityView)
    wait_until(lambda: view.found is not None)
    assert view.found.turns == TURNS
    if rest:
        wait_until(lambda: not view.busy)
    return view


@contextmanager
def unhurried(pause: QTimer) -> Iterator[None]:
    """However slow the machine is, the pause does not end meanwhile."""
    usual = pause.interval()
    pause.setInterval(60_000)
    yield
    pause.setInterval(usual)


def pixel(view: StabilityView, eta: float, q: float) -> QPoint:
    return view.chart.pixel(eta, q).toPoint()


def test_a_coarse_chart_stands_at_once_and_the_fine_one_follows(kim: User) -> None:
    kim.choose("Stability", "Chart")
    view = kim.window.view("stability")
    assert isinstance(view, StabilityView)
    wait_until(lambda: view.found is not None)
    assert view.drawn.q.size == COARSE
    wait_until(lambda: not view.busy)
    assert view.drawn.q.size == FINE
    assert not view.progress.isVisible()
    assert "1500 rpm" in view.head.text()
    found = kim.session.study.stability
    assert found is not None
    exact = chart(found.coefficients, found.machine, rows=FINE).tongues[EXACT]
    assert np.array_equal(view.drawn.tongues[EXACT].edges, exact.edges)


def test_every_point_of_the_chart_is_where_the_axes_say(kim: User) -> None:
    view = page(kim, rest=False)
    for across in range(2):
        for upwards in range(2):
            view.across.setCurrentIndex(across)
            view.upwards.setCurrentIndex(upwards)
            settle()
            for eta, q in ((1.7, 0.05), (3.1, 0.08), (0.9, 0.02)):
                at = view.chart.point_at(QPointF(pixel(view, eta, q)))
                assert at is not None
                low, high = view.chart.point_at(QPointF(pixel(view, eta, q) + QPoint(-1, 1))), at
                assert low is not None
                room = 1.5 * np.abs(np.array(low) - np.array(high))
                assert np.all(np.abs(np.array(at) - (eta, q)) <= np.maximum(room, 1e-9))
    assert view.chart.point_at(QPointF(2.0, 2.0)) is None


def test_the_mouse_reads_tongue_and_growth_at_once(kim: User) -> None:
    view = page(kim, rest=False)
    edges = view.drawn.tongues[EXACT].edges[-1]
    q = float(view.drawn.q[-1]) * 0.98
    QTest.mouseMove(view.chart.viewport(), pixel(view, float(edges[1].mean()), q))
    settle()
    place, slow = view.reading.text().split("\n")
    assert "tongue 2; " in place
    assert "(21) grows" in place
    assert "rpm" in place
    assert "computing" in slow
    QTest.mouseMove(view.chart.viewport(), pixel(view, 0.75, q))
    settle()
    assert "between tongues; (22) stable; (21) stable" in view.reading.text()


def test_where_the_mouse_rests_every_model_tells_its_verdict(kim: User, monkeypatch: pytest.MonkeyPatch) -> None:
    """The slow ones are computed by another thread than the window's, and only there."""
    view = page(kim)
    threads: set[int] = set()
    for name in ("steady_at", "rest_at"):
        monkeypatch.setattr(Stability, name, heard(getattr(Stability, name), threads))
    QTest.mouseMove(view.chart.viewport(), pixel(view, 0.75, 0.1))
    assert view.reading.busy
    wait_until(lambda: not view.busy)
    assert not view.progress.isVisible()
    place, slow = view.reading.text().split("\n")
    assert place.startswith("η = 0.7")
    assert [v.model for v in view.reading.told] == ["approx_22", "exact_21", "from_rest", "steady"]
    assert "steady: stable, " in slow
    assert "from rest: " in slow
    assert "computing" not in slow
    assert view.found is not None
    eta, q = view.reading.point
    gone = view.found.history(None, eta, q)
    assert view.reading.told[2].largest == gone.largest[0]
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


def test_what_the_mouse_has_left_or_an_edit_made_untrue_is_given_up(kim: User, monkeypatch: pytest.MonkeyPatch) -> None:
    view = page(kim)
    asked: list[tuple[float, float]] = []

    def endless(found: Stability, eta: float, q: float) -> Verdict:
        asked.append((eta, q))
        while True:
            time.sleep(0.001)

    monkeypatch.setattr(Stability, "rest_at", endless)
    QTest.mouseMove(view.chart.viewport(), pixel(view, 0.75, 0.1))
    wait_until(lambda: len(asked) == 1)
    assert view.progress.isVisible()
    with unhurried(view.reading._pause):
        QTest.mouseMove(view.chart.viewport(), pixel(view, 1.25, 0.1))
        settle()
        assert not view.reading.lane.busy, "it waits for the mouse to rest anew"
        assert not view.progress.isVisible()
    view.reading._pause.start()
    wait_until(lambda: len(asked) == 2)
    assert asked[1][0] == pytest.approx(1.25, abs=0.02)
    monkeypatch.undo()
    monkeypatch.setattr(Stability, "turns", TURNS)
    kim.session.edit("shaft.speed_rpm", 1400.0, "Change speed")
    settle()
    assert not view.reading.busy
    assert view.reading.text() == ""
    wait_until(lambda: not view.busy)


def test_the_words_for_each_verdict() -> None:
    steady, lost = Verdict("steady", True, largest=0.1), Verdict("steady", False, 0.05, 2.1, 0.1, 2.275)
    assert waiting_text((steady,), False) == "steady: stable, 36.0°"
    assert waiting_text((lost,), True) == (
        "steady: grows 5.13 % a turn, 36.0°, off the cam at turn 2.275; still computing …"
    )
    assert waiting_text((Verdict("steady", None),), False) == "steady: no response found"
    rest = Verdict("from_rest", None, largest=0.01, lost=3.3)
    assert waiting_text((rest, steady), False).endswith("from rest: 3.60°, not settled, off the cam at turn 3.300")
    assert waiting_text((), True) == "nonlinear models: computing …"


def test_a_click_shows_verdicts_and_history_there(kim: User) -> None:
    view = page(kim)
    own = shown(view)
    assert view.found is not None
    assert (own.eta, own.q) == (view.found.machine.eta, view.found.machine.q)
    QTest.mouseClick(view.chart.viewport(), LEFT, pos=pixel(view, 1.5, 0.1))
    assert view.picked is not None
    wait_until(lambda: not view.busy)
    gone = shown(view)
    assert (gone.eta, gone.q) == view.picked
    assert view.looked is not None
    assert len(view.looked.said) == 4
    text = view.pages.verdicts.text()
    assert text.count("<tr>") == 5
    assert "unstable" in text
    for name in ("Wind-up", "Phase", "Spectrum", "Contact"):
        view.pages.show_page(name)
        settle()
        (x, y), *_ = view.pages.plots[name][0].lines
        assert x.size == y.size > 30
        assert np.ptp(y[np.isfinite(y)]) > 0.0
    y, twist = view.pages.plots["Wind-up"][0].lines[0]
    assert twist == pytest.approx(360.0 * gone.at(y)[0])


def shown(view: StabilityView) -> History:
    assert view.looked is not None
    assert view.looked.gone is not None
    return view.looked.gone


def test_averages_are_followed_when_their_page_comes_to_the_front(kim: User, monkeypatch: pytest.MonkeyPatch) -> None:
    """Kim1990 Figs. 6 and 7: mean wind-up and mean rate of the first turn by η, a row for each Q."""
    monkeypatch.setattr("core.stability.means.STEP", 0.85)
    view = page(kim)
    found = view.found
    assert found is not None
    assert "first_turn" not in vars(found)
    view.pages.show_page("Averages")
    settle()
    assert "many speeds" in view.pages.plots["Averages"][0].message
    assert view.progress.isVisible()
    wait_until(lambda: not view.busy)
    means = mean_wind_up(found.coefficients, (0.05, 0.1, 0.2, 0.5, 1.0), found.eta_max, contact=found.contact)
    for plot, rows in zip(view.pages.plots["Averages"], (means.wind_up, means.slope), strict=True):
        assert not plot.message
        solid = [line for line in plot.lines if np.isfinite(line[1]).any()]
        assert np.array_equal(solid[0][0], means.eta)
        assert solid[0][1] == pytest.approx(rows[0], rel=1e-9)
        assert max(np.nanmax(y) for _, y in solid) == pytest.approx(rows.max(), rel=1e-9)
    with unhurried(view._pause):
        kim.session.edit("shaft.stiffness_nm_per_rad", 80.0, "Change stiffness")
        settle()
        assert view.means.busy is False, "not before editing pauses"
    view.settle()
    wait_until(lambda: not view.busy)
    assert view.found is not found
    assert "first_turn" in vars(view.found)


def test_the_terms_of_the_equation_are_drawn_by_cam_angle(kim: User) -> None:
    """Kim1990 Fig. 5."""
    view = page(kim, rest=False)
    view.pages.show_page("Terms")
    settle()
    degrees, psi = view.pages.plots["Terms"][0].lines[0]
    theta = np.deg2rad(degrees)
    kims = np.where(degrees < 180.0, 3.0 * (np.cos(2.0 * theta) - np.cos(4.0 * theta)), 0.0)
    assert np.abs(psi - kims).max() < 1e-12


def test_only_the_page_in_front_is_drawn(kim: User) -> None:
    view = page(kim)
    plots = {name: group[0] for name, group in view.pages.plots.items()}
    assert all(not plot.lines for plot in plots.values())
    view.pages.show_page("Spectrum")
    settle()
    assert [name for name, plot in plots.items() if plot.lines] == ["Spectrum"]


def test_the_forbidden_speeds_and_the_shaft_for_a_speed(kim: User) -> None:
    view = page(kim)
    view.pages.show_page("Speeds")
    settle()
    found = kim.session.study.stability
    assert found is not None
    assert view.pages.speeds.text().count("<tr>") == 1 + len(found.bands)
    band = found.bands[1]
    view.pages.speed.setFocus()
    view.pages.speed.selectAll()
    kim.type(f"{0.5 * (band.rpm_lo + band.rpm_hi):.1f}")
    kim.press(Qt.Key.Key_Return)
    assert "at least" in view.pages.needed.text()


def test_the_machines_point_is_drawn_to_the_shaft_it_would_need(kim: User) -> None:
    view = page(kim)
    machine, paper = view.drawn.machine, view.chart.viewport()
    assert machine is not None
    begin, end = pixel(view, machine.eta, machine.q), pixel(view, 2.7, 0.08)
    before = kim.design
    for give_up in (True, False):
        QTest.mousePress(paper, LEFT, pos=begin)
        QTest.mouseMove(paper, end)
        settle()
        assert "needs" in view.reading.text()
        if give_up:
            QTest.keyClick(view.chart, Qt.Key.Key_Escape)
            assert not view.use.isVisible()
        QTest.mouseRelease(paper, LEFT, pos=end)
        settle()
    assert kim.design == before, "nothing changes before it is asked for"
    wanted = view.wanted
    assert wanted is not None
    QTest.mouseClick(view.use, LEFT)
    settle()
    found = kim.session.study.stability
    assert found is not None
    assert (found.machine.eta, found.machine.q) == pytest.approx(wanted, rel=1e-5)
    assert len(kim.steps) == 1
    kim.press(Qt.Key.Key_Z, modifier=Qt.KeyboardModifier.ControlModifier)
    assert kim.design == before


def test_a_rigid_shaft_is_told_and_can_be_made_flexible(open_user: Open) -> None:
    user = open_user(size=(1440, 900), plots=False)
    lift = user.design
    user.choose("Stability", "Chart")
    view = user.window.view("stability")
    assert isinstance(view, StabilityView)
    wait_until(lambda: view.up_to_date)
    assert view.in_trouble
    user.choose("Stability", "Flexible shaft")
    wait_until(lambda: view.found is not None)
    elastic = user.design.shaft.elastic
    assert elastic is not None
    found = user.session.study.stability
    assert found is not None
    assert view.drawn.eta_max > found.machine.eta, "the chart shows the machine"
    assert view.chart.own.isVisible()
    assert found.machine.q == pytest.approx(0.05, rel=0.01)
    assert found.machine.eta == pytest.approx(10.25, rel=0.01)
    assert {"shaft.stiffness_nm_per_rad", "shaft.camshaft_inertia_kg_m2"} <= set(user.design.assumed)
    assert user.field("shaft.damping_ratio") is not None
    user.choose("Stability", "Rigid shaft")
    assert user.design == lift
    wait_until(lambda: view.in_trouble)


def test_an_edit_gives_up_what_is_being_computed(kim: User) -> None:
    view = page(kim, rest=False)
    QTest.mouseClick(view.chart.viewport(), LEFT, pos=pixel(view, 2.0, 0.1))
    assert view.looks.busy
    view.picked = None  # near a resonance the steady response takes long
    with unhurried(view._pause):
        kim.session.edit("shaft.speed_rpm", 1234.0, "Change speed")
        settle()
        assert not view.looks.busy
        assert view.looked is not None
        assert view.looked.gone is None
    view.settle()
    wait_until(lambda: not view.busy)
    assert view.found is not None
    assert view.found.machine.rpm(view.found.machine.eta) == pytest.approx(1234.0)


def test_nothing_is_computed_while_the_page_is_hidden(kim: User) -> None:
    view = page(kim)
    kim.window.show_view("mechanism")
    settle()
    kim.session.stages_on_screen = tuple
    count = evaluations["stability"]
    kim.session.edit("shaft.stiffness_nm_per_rad", 91.0, "Change stiffness")
    settle()
    assert evaluations["stability"] == count
    assert not view.up_to_date


def test_the_chart_and_the_other_figures_as_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--q", "0.05", "--eta-max", "2.2", "--periods", "2"]
    assert main(["--headless", "stability", str(KIM), "--out", str(tmp_path), *words]) == 0
    names = ("stability", "windup_averages", "windup", "coefficients")
    assert {f"{name}{ending}" for name in names for ending in (".svg", ".png")} <= {p.name for p in tmp_path.iterdir()}
    for name in names:
        drawn = (tmp_path / f"{name}.svg").read_text()
        assert drawn.count("<path") + drawn.count("<polyline") > 5
        image = QImage(str(tmp_path / f"{name}.png"))
        row = image.height() // 3
        colours = {image.pixelColor(x, row).name() for x in range(image.width())}
        assert len(colours) > 4, f"{name}: curves are crossed at this height"


@pytest.mark.parametrize("ending", [".svg", ".png"])
def test_a_figure_of_the_core_as_a_file(ending: str) -> None:
    """Its title, its legend, broken and dashed curves; one plot below the other."""
    x = np.linspace(0.0, 1.0, 9)
    broken = np.where(x > 0.5, np.nan, x)
    one = Plot(
        "Turns", "Twist", (Curve(x, x, "first"), Curve(x, broken, "second", 1, dashed=True)), ((0.4, "here"),), "a note"
    )
    data = figure_file(Figure("name", "Title of it", (one, one)), ending)
    if ending == ".svg":
        text = data.decode()
        for word in ("Title of it", "first", "second", "a note", "Turns", "Twist", "here"):
            assert word in text, word
    else:
        image = QImage.fromData(data)
        assert (image.width(), image.height()) == (1920, 1280)


def test_a_chart_of_no_machine_has_no_point() -> None:
    found = Study(load(KIM)).stability
    assert found is not None
    alone = chart(found.coefficients, None, "alone", rows=8)
    assert chart_file(alone, ".png") != chart_file(chart(found.coefficients, found.machine, "alone", rows=8), ".png")


def test_the_lift_with_a_shaft_has_a_chart_of_its_own() -> None:
    """A whole train: its inertia by cam angle, its weight and its cylinder."""
    lift = Study(load(example("transfer_lift")))
    study = Study(flexible(lift.design, lift.linkage, lift.loading, lift.omega))
    found = study.stability
    assert found is not None
    widths = np.diff(found.exact.edges[0], axis=1).ravel()
    assert widths[0] > 1e-4
    assert with_elastic(study.design, None).shaft == load(example("transfer_lift")).shaft
