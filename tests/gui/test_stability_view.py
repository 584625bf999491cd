"""kindyna_gui.stability_*: the chart under the mouse, verdicts and histories beside it, the shaft that a point needs."""

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Open, User, settle

from core.design import with_elastic
from core.project import load
from core.stability import EXACT, chart
from core.study import Study, evaluations
from kindyna_gui.__main__ import main
from kindyna_gui.pictures.files import chart_file
from kindyna_gui.places import example
from kindyna_gui.stability_view import COARSE, FINE, StabilityView

KIM = example("kim_1990")
LEFT = Qt.MouseButton.LeftButton
PATIENCE = 40.0


def wait_until(condition: Callable[[], bool]) -> None:
    """Let events run and, unlike ``qWait``, other threads as well."""
    patience = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < patience, "waited in vain"
        QApplication.processEvents()
        time.sleep(0.002)


@pytest.fixture
def kim(open_user: Open) -> User:
    return open_user(KIM, size=(1440, 900), plots=False)


def page(user: User, rest: bool = True) -> StabilityView:
    user.choose("Stability", "Chart")
    view = user.window.view("stability")
    assert isinstance(view, StabilityView)
    wait_until(lambda: view.found is not None)
    if rest:
        wait_until(lambda: not view.busy)
    return view


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


def test_the_mouse_reads_tongue_growth_and_both_verdicts(kim: User) -> None:
    view = page(kim, rest=False)
    edges = view.drawn.tongues[EXACT].edges[-1]
    q = float(view.drawn.q[-1]) * 0.98
    QTest.mouseMove(view.chart.viewport(), pixel(view, float(edges[1].mean()), q))
    settle()
    assert "tongue 2; " in view.reading.text()
    assert "(21) grows" in view.reading.text()
    assert "rpm" in view.reading.text()
    QTest.mouseMove(view.chart.viewport(), pixel(view, 0.75, q))
    settle()
    assert "between tongues; (22) stable; (21) stable" in view.reading.text()


def test_a_click_shows_verdicts_and_history_there(kim: User) -> None:
    view = page(kim)
    own = view.gone
    assert own is not None
    assert (own.eta, own.q) == view.looked_at
    QTest.mouseClick(view.chart.viewport(), LEFT, pos=pixel(view, 1.0, 0.1))
    assert view.point is not None
    wait_until(lambda: not view.busy)
    assert view.gone is not None
    assert (view.gone.eta, view.gone.q) == view.point
    assert len(view.said) == 4
    text = view.verdicts.text()
    assert text.count("<tr>") == 5
    assert "unstable" in text
    for name in view.plots:
        view.tabs.setCurrentWidget(view.plots[name])
        settle()
        (x, y), *_ = view.plots[name].lines
        assert x.size == y.size > 100
        assert np.ptp(y[np.isfinite(y)]) > 0.0
    wind_up = view.plots["Wind-up"].lines[0]
    assert wind_up[1] == pytest.approx(360.0 * view.gone.at(wind_up[0])[0])


def test_only_the_page_in_front_is_drawn(kim: User) -> None:
    view = page(kim)
    assert all(not plot.lines for plot in view.plots.values())
    view.tabs.setCurrentWidget(view.plots["Spectrum"])
    settle()
    assert [name for name, plot in view.plots.items() if plot.lines] == ["Spectrum"]


def test_the_forbidden_speeds_and_the_shaft_for_a_speed(kim: User) -> None:
    view = page(kim)
    view.tabs.setCurrentIndex(1)
    settle()
    found = kim.session.study.stability
    assert found is not None
    assert view.speeds.text().count("<tr>") == 1 + len(found.bands)
    band = found.bands[1]
    view.speed.setFocus()
    view.speed.selectAll()
    kim.type(f"{0.5 * (band.rpm_lo + band.rpm_hi):.1f}")
    kim.press(Qt.Key.Key_Return)
    assert "at least" in view.needed.text()


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
    assert found.machine.q == pytest.approx(0.05, rel=0.01)
    assert found.machine.eta == pytest.approx(10.0, rel=0.01)
    assert {"shaft.stiffness_nm_per_rad", "shaft.camshaft_inertia_kg_m2"} <= set(user.design.assumed)
    assert user.field("shaft.damping_ratio") is not None
    user.choose("Stability", "Rigid shaft")
    assert user.design == lift
    wait_until(lambda: view.in_trouble)


def test_an_edit_gives_up_what_is_being_computed(kim: User) -> None:
    view = page(kim, rest=False)
    QTest.mouseClick(view.chart.viewport(), LEFT, pos=pixel(view, 2.0, 0.1))
    assert view.looks.busy
    kim.session.edit("shaft.speed_rpm", 1234.0, "Change speed")
    settle()
    assert view.gone is None
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


def test_the_chart_as_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--headless", "stability", str(KIM), "--out", str(tmp_path), "--q", "0.05"]) == 0
    assert {"stability.svg", "stability.png", "tongues.csv"} <= {path.name for path in tmp_path.iterdir()}
    assert (tmp_path / "stability.svg").read_text().count("<path") > 5
    image = QImage(str(tmp_path / "stability.png"))
    colours = {image.pixelColor(x, 200).name() for x in range(0, image.width(), 1)}
    assert len(colours) > 5, "tongues are crossed at this height"


def test_a_chart_of_no_machine_has_no_point() -> None:
    found = Study(load(KIM)).stability
    assert found is not None
    alone = chart(found.coefficients, None, "alone", rows=8)
    assert chart_file(alone, ".png") != chart_file(chart(found.coefficients, found.machine, "alone", rows=8), ".png")


def test_the_lift_with_a_shaft_has_a_chart_of_its_own() -> None:
    """A whole train: its inertia by cam angle, its weight and its cylinder."""
    from kindyna_gui.stability_shaft import flexible

    study = Study(flexible(Study(load(example("transfer_lift")))))
    found = study.stability
    assert found is not None
    widths = np.diff(found.exact.edges[0], axis=1).ravel()
    assert widths[0] > 1e-4
    assert with_elastic(study.design, None).shaft == load(example("transfer_lift")).shaft
