"""kindyna_gui.stability_view: the chart, the shaft that a point needs, what an edit gives up."""

from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from threading import Thread, current_thread
from threading import enumerate as enumerate_threads
from typing import Any

import numpy as np
import pytest
from linkages import lift_twice
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from stability_page import KIM, LEFT, TURNS, page, pixel, unhurried
from window_user import Open, User, settle, wait_for

from core.errors import NoSolution
from core.project import load, save
from core.stability import EXACT, Chart, Stability, chart
from core.study import Study, evaluations
from kindyna_gui.background import Worker
from kindyna_gui.look import apply_preferences
from kindyna_gui.pictures.painter import chart_file
from kindyna_gui.pictures.plots.stability_chart import ChartPlot
from kindyna_gui.places import example
from kindyna_gui.settings import Preferences, Settings
from kindyna_gui.stability_pages import PLOTS
from kindyna_gui.stability_view import StabilityView


@pytest.fixture
def open_user(same_window: Open) -> Open:
    """One window for all tests of this file."""
    return same_window


@pytest.fixture
def kim(open_user: Open, monkeypatch: pytest.MonkeyPatch) -> User:
    """The window with Kim1990's cam, whose shaft is followed through few turns only: how many is no matter of the window."""
    monkeypatch.setattr(Stability, "turns", TURNS)
    return open_user(KIM, size=(1440, 900))


def plain(user: User) -> StabilityView:
    """The page as a designer finds it."""
    user.choose("Stability", "Chart")
    view = user.window.view("stability")
    assert isinstance(view, StabilityView)
    view.as_paper.setChecked(False)
    wait_for(lambda: view.stability is not None and view.up_to_date)
    return view


def test_a_coarse_chart_stands_at_once_and_the_fine_one_follows(kim: User, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes: list[int] = []
    usual = ChartPlot.show_speeds

    def counted(plot: ChartPlot, drawn: Chart, *rest: Any) -> None:
        sizes.append(drawn.q.size)
        usual(plot, drawn, *rest)

    monkeypatch.setattr(ChartPlot, "show_speeds", counted)
    view = plain(kim)
    wait_for(lambda: not view.busy)
    rows = view.drawn.q.size
    assert rows == sizes[-1]
    assert rows > 4 * min(sizes)
    assert not view.progress.isVisible()
    assert "1500 rpm" in view.verdict.text()
    found = kim.session.study.stability
    assert found is not None
    exact = chart(found.coefficients, found.machine, rows=rows).tongues[EXACT]
    assert np.array_equal(view.drawn.tongues[EXACT].edges, exact.edges)


def test_the_first_line_says_whether_the_speed_is_clear_before_anything_slow_is_known(
    kim: User, monkeypatch: pytest.MonkeyPatch
) -> None:

    def never(*_: object, **__: object) -> None:
        raise NoSolution("slow", "shaft.speed_rpm", "none")

    for slow in ("history", "steady_turn_at"):
        monkeypatch.setattr(Stability, slow, never)
    view = plain(kim)
    said = view.verdict.text(), view.pages.speeds.text(), view.chart.accessibleDescription()
    assert said[0] == "1500 rpm keeps clear of every band; the nearest is 1388.7 … 1389.2 rpm, 7.4 % below."
    assert "η" not in "".join(said)


@pytest.mark.parametrize(
    ("rpm", "said"),
    [
        (
            "4800",
            "4800 rpm is inside a forbidden band, 4776.4 … 4954.1 rpm: the twist of the shaft grows by up to 12 % a turn.",
        ),
        (
            "1385",
            "1385 rpm is clear of every band, but close to one; the nearest is 1388.7 … 1389.2 rpm, 0.27 % above.",
        ),
    ],
)
def test_the_first_line_follows_the_speed(kim: User, rpm: str, said: str) -> None:
    view = plain(kim)
    kim.enter("shaft.speed_rpm", rpm)
    wait_for(lambda: view.verdict.text() == said)


def test_the_chart_shows_the_nearest_bands_over_the_speed_and_the_machines_own(kim: User) -> None:
    view = plain(kim)
    frame = view.chart.frame()
    assert view.stability is not None
    seen = [band.n for band in view.stability.bands if frame.first <= band.rpm_lo and band.rpm_hi <= frame.last]
    assert seen == [5, 6, 7, 8, 9]
    assert "Speed, rpm across" in view.chart.accessibleDescription()
    assert view.chart.accessibleDescription().endswith("; 1500 rpm")
    wait_for(lambda: "margin" in view.pages.speeds.text())
    assert ">rpm<" in view.pages.speeds.text().replace("&nbsp;", "")
    for rpm, shown in (("30", "30 rpm"), ("60000", "60\u202f000 rpm")):  # far outside of every band
        kim.enter("shaft.speed_rpm", rpm)
        wait_for(lambda shown=shown: view.verdict.text().startswith(shown))  # type: ignore[misc]
        assert view.chart.machine_point.isVisible()


def test_no_band_that_damping_closes_is_drawn_while_the_chart_is_calculated(open_user: Open) -> None:
    """The transfer unit has one band, beyond 1200 rpm; without its damping there were one at 605 rpm and thirty below."""
    user = open_user(example("transfer_unit"), size=(1440, 900))
    user.choose("Stability", "Chart")
    view = user.window.view("stability")
    assert isinstance(view, StabilityView)
    with unhurried(view):
        view.as_paper.setChecked(False)
        wait_for(lambda: view.stability is not None and view.up_to_date)
        view.settle()
        wait_for(lambda: view.fine.busy)
        assert view.verdict.text().startswith("20 rpm keeps clear of every band; the nearest is 12")
        box, image = view.chart.getViewBox().sceneBoundingRect().toRect(), view.chart.grab().toImage()
    frame = view.chart.frame()
    middle = box.center().y()
    tinted = [x for x in range(box.left() + 2, box.right() - 2) if is_reddish(image.pixelColor(x, middle))]
    speeds = [frame.first + (x - box.left()) / box.width() * (frame.last - frame.first) for x in tinted]
    assert speeds
    assert min(speeds) > 1100.0


def is_reddish(colour: QColor) -> bool:
    return colour.red() - colour.blue() > 20


def test_the_switch_to_the_paper_is_remembered(kim: User) -> None:
    view = plain(kim)
    assert not view.fields.isVisible()
    QTest.mouseClick(view.as_paper, LEFT)
    settle()
    assert view.fields.isVisible()
    assert "η = " in view.chart.accessibleDescription()
    shown = [view.pages.tabText(i) for i in range(view.pages.count()) if view.pages.isTabVisible(i)]
    assert shown[:2] == ["Speeds", "Verdicts"]
    assert Settings().as_in_paper
    QTest.mouseClick(view.as_paper, LEFT)
    assert not Settings().as_in_paper


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
    wanted = view.target
    assert wanted is not None
    QTest.mouseClick(view.use, LEFT)
    settle()
    found = kim.session.study.stability
    assert found is not None
    assert (found.machine.eta, found.machine.q) == pytest.approx(wanted, rel=1e-5)
    assert len(kim.steps) == 1
    kim.press(Qt.Key.Key_Z, modifier=Qt.KeyboardModifier.ControlModifier)
    assert kim.design == before


@pytest.mark.stress
def test_a_rigid_shaft_is_told_and_can_be_made_flexible(open_user: Open) -> None:
    user = open_user(size=(1440, 900))
    lift = user.design
    user.choose("Stability", "Chart")
    view = user.window.view("stability")
    assert isinstance(view, StabilityView)
    wait_for(lambda: view.up_to_date)
    assert view.in_trouble
    user.choose("Stability", "Flexible shaft")
    wait_for(lambda: view.stability is not None)
    elastic = user.design.shaft.elastic
    assert elastic is not None
    found = user.session.study.stability
    assert found is not None
    assert view.drawn.eta_max > found.machine.eta, "the chart shows the machine"
    assert view.chart.machine_point.isVisible()
    assert found.machine.q == pytest.approx(0.05, rel=0.01)
    assert found.machine.eta == pytest.approx(10.25, rel=0.01)
    assert {"shaft.stiffness_nm_per_rad", "shaft.camshaft_inertia_kg_m2"} <= set(user.design.assumed)
    assert user.field("shaft.damping_ratio") is not None
    user.choose("Stability", "Rigid shaft")
    assert user.design == lift
    wait_for(lambda: view.in_trouble)


@pytest.mark.stress
def test_a_linkage_that_its_cam_drives_has_a_chart(open_user: Open, tmp_path: Path) -> None:
    path = tmp_path / "linkage.toml"
    save(lift_twice()[1], path)
    user = open_user(path, size=(1440, 900))
    user.choose("Stability", "Chart")
    view = user.window.view("stability")
    assert isinstance(view, StabilityView)
    wait_for(lambda: view.up_to_date)
    assert view.in_trouble
    user.choose("Stability", "Add a shaft")
    user.choose("Stability", "Flexible shaft")
    wait_for(lambda: view.stability is not None)
    assert not view.in_trouble
    assert view.stability.machine.q == pytest.approx(0.05, rel=0.01)
    assert view.stability.bands
    assert view.chart.machine_point.isVisible()
    assert "20.00 rpm" in view.header.text()


@pytest.mark.stress
def test_an_edit_gives_up_what_is_being_computed(kim: User) -> None:
    view = page(kim, rest=False)
    QTest.mouseClick(view.chart.viewport(), LEFT, pos=pixel(view, 2.0, 0.1))
    assert view.point_jobs.busy
    view.picked = None  # near a resonance the steady response takes long
    with unhurried(view):
        kim.session.edit("shaft.speed_rpm", 1234.0, "Change speed")
        settle()
        assert not view.point_jobs.busy
        assert view.chosen is not None
        assert view.chosen.history is None
    view.settle()
    wait_for(lambda: not view.busy)
    assert view.stability is not None
    assert view.stability.machine.rpm(view.stability.machine.eta) == pytest.approx(1234.0)


def test_an_edit_waits_for_no_chart_and_the_one_before_stays_marked(kim: User, monkeypatch: pytest.MonkeyPatch) -> None:
    view = page(kim)
    before, own, count, threads = view.drawn, kim.design, evaluations["stability"], set()

    def drawn_by(*parts: object, **more: object) -> Chart:
        threads.add(current_thread())
        return chart(*parts, **more)  # type: ignore[arg-type]

    monkeypatch.setattr("kindyna_gui.stability_view.chart", drawn_by)
    for stiffness in (91.0, 95.0):
        assert kim.session.edit("shaft.stiffness_nm_per_rad", stiffness, "Change stiffness")
        assert view.drawn is before
        assert evaluations["stability"] == count
        assert not threads
        assert "Calculating" in view.verdict.text()
        assert view.busy
    wait_for(lambda: not view.busy)
    assert current_thread() not in threads
    found = kim.session.study.stability
    assert found is not None
    assert view.stability is found
    assert view.drawn is not before
    assert np.array_equal(
        view.drawn.tongues[EXACT].edges, chart(found.coefficients, found.machine, rows=64).tongues[EXACT].edges
    )
    assert "Calculating" not in view.header.text()
    kim.session.edit("shaft.stiffness_nm_per_rad", 60.0, "Change stiffness")
    kim.window.show_view("mechanism")
    settle()
    assert not view.busy, "what has left the screen is given up"
    kim.window.show_view("stability")
    wait_for(lambda: view.up_to_date and not view.busy)
    assert view.stability is kim.session.study.stability
    assert own != kim.design


def test_the_first_page_computes_nothing_in_the_windows_thread(kim: User, monkeypatch: pytest.MonkeyPatch) -> None:
    threads: list[Thread] = []
    bands = Stability.bands.func

    def computed(stability: Stability) -> object:
        threads.append(current_thread())
        return bands(stability)

    monkeypatch.setattr(Stability.bands, "func", computed)
    view = plain(kim)
    assert view.verdict.text().startswith("1500 rpm keeps clear of every band")
    assert threads
    assert current_thread() not in threads


@pytest.fixture(params=["light", "dark"])
def theme(request: pytest.FixtureRequest, app: QApplication) -> Iterator[str]:
    apply_preferences(Preferences(theme=request.param), app)
    yield request.param
    apply_preferences(Preferences(), app)


@pytest.mark.usefixtures("theme")
def test_a_picture_has_the_verdict_however_early_it_is_taken(kim: User, tmp_path: Path) -> None:
    view = plain(kim)
    assert kim.session.edit("shaft.speed_rpm", 1385.0, "Change speed")
    kim.picks("picture_to_save", tmp_path / "page.svg")
    kim.choose("Graph", "Export picture", "Stability...")
    assert "1385 rpm is clear of every band" in (tmp_path / "page.svg").read_text("utf-8")
    wait_for(lambda: view.verdict.text().startswith("1385 rpm"))


def test_a_closed_window_computes_no_more(kim: User) -> None:
    view = page(kim, rest=False)
    QTest.mouseClick(view.chart.viewport(), LEFT, pos=pixel(view, 2.0, 0.1))
    assert view.point_jobs.busy
    assert any(isinstance(each, Worker) for each in enumerate_threads())
    kim.window.close()
    assert not view.busy
    assert not any(isinstance(each, Worker) for each in enumerate_threads())


@pytest.mark.stress
def test_a_page_that_leaves_the_screen_gives_up_and_asks_again_when_it_returns(
    kim: User, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("core.stability.stage.etas", lambda eta_max: np.arange(0.5, eta_max, 0.85))
    view = page(kim, rest=False)
    counts, few = counted(view, monkeypatch), view.drawn.q.size
    view.pages.show_page("Averages")
    QTest.mouseClick(view.chart.viewport(), LEFT, pos=pixel(view, 2.7, 0.05))
    assert view.point_jobs.busy
    counts.clear()
    kim.window.show_view("mechanism")
    settle()
    assert not view.busy
    assert not view.progress.isVisible()
    wait_for(lambda: not any(isinstance(each, Worker) for each in enumerate_threads()))
    kim.session.stages_on_screen = tuple
    before = evaluations["stability"]
    kim.session.edit("shaft.stiffness_nm_per_rad", 91.0, "Change stiffness")
    settle()
    view.settle()
    assert counts == {}, "nothing is asked for, nothing drawn"
    assert evaluations["stability"] == before
    assert not view.up_to_date
    assert not view.busy
    kim.press(Qt.Key.Key_Z, modifier=Qt.KeyboardModifier.ControlModifier)
    kim.window.show_view("stability")
    wait_for(lambda: view.up_to_date and not view.busy)
    assert view.drawn.q.size > few
    assert view.chosen is not None
    assert view.chosen.history is not None
    assert view.chosen.verdicts
    assert not view.pages.missing_result
    counts.clear()
    for name in ("mechanism", "stability"):
        kim.window.show_view(name)
        settle()
    assert counts == {}, "what is known is not asked for again"
    assert not view.busy


def counted(view: StabilityView, monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How often work is started beside the window and anything is drawn."""
    counts: Counter[str] = Counter()
    for owner, name in (
        *((each, "start") for each in (view.fine, view.point_jobs, view.shaft_jobs, view.reading.background)),
        (view.chart, "show_chart"),
        (view.pages, "redraw"),
        *((plot, "show_plot") for title in PLOTS for plot in view.pages.plots[title]),
    ):
        monkeypatch.setattr(owner, name, partial(tallied, counts, name, getattr(owner, name)))
    return counts


def tallied(counts: Counter[str], name: str, done: Callable[..., object], *words: object) -> object:
    counts[name] += 1
    return done(*words)


@pytest.mark.stress
def test_a_page_left_unchanged_while_it_computes_goes_on_when_it_returns(kim: User) -> None:
    view = page(kim, rest=False)
    with unhurried(view):
        QTest.mouseClick(view.chart.viewport(), LEFT, pos=pixel(view, 2.7, 0.05))
        assert view.point_jobs.busy
        kim.window.show_view("mechanism")
        settle()
        assert not view.busy
        assert view.up_to_date
        kim.window.show_view("stability")
        settle()
        assert view.busy, "it is to be asked for again"
        assert not view.point_jobs.busy
    view.settle()
    assert view.point_jobs.busy
    wait_for(lambda: not view.busy)
    assert view.chosen is not None
    assert view.chosen.history is not None
    assert (view.chosen.eta, view.chosen.q) == view.picked


def test_a_chart_of_no_machine_has_no_point(app: object) -> None:
    found = Study(load(KIM)).stability
    assert found is not None
    alone = chart(found.coefficients, None, "alone", rows=8)
    assert chart_file(alone, ".png") != chart_file(chart(found.coefficients, found.machine, "alone", rows=8), ".png")
