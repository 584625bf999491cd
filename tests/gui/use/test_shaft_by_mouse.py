"""The transfer unit from File > Examples to its forbidden speeds at 1280 × 720, with the mouse and the space bar: its drives turn, its
timing is drawn, its torque, flywheel, phases and balance cam are found. What is shown is what the core computes of that design."""

from math import atan2, degrees
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QTabBar, QToolBar, QToolButton, QWidget
from window_user import Open, User, plain, settle, wait_for

from core.design import distances
from core.find import Solution
from core.project import load
from core.study import Study
from core.study.cam_checks import smallest_radii
from kindyna_gui.drives import ONE, SIDE_BY_SIDE
from kindyna_gui.drives_view import NAME, DrivesView
from kindyna_gui.find import FindView
from kindyna_gui.findings import FindingsView
from kindyna_gui.places import example
from kindyna_gui.shaft import ShaftTorqueView
from kindyna_gui.stability_pages import bands_table
from kindyna_gui.stability_view import StabilityView
from kindyna_gui.timing_view import TimingView

LEFT = Qt.MouseButton.LeftButton
FEED, CLAMP = 0, 1


class Hand:
    """Clicks of the left button, and nothing else."""

    def __init__(self, user: User) -> None:
        self.user, self.window = user, user.window

    def click(self, widget: QWidget, at: QPoint | None = None) -> None:
        QTest.mouseClick(widget, LEFT, pos=widget.rect().center() if at is None else at)
        settle()

    def entry(self, menu: QMenu, text: str) -> None:
        wait_for(menu.isVisible)
        action = next(each for each in menu.actions() if plain(each.text()) == text)
        self.click(menu, menu.actionGeometry(action).center())

    def menu(self, title: str, *way: str) -> None:
        bar = self.window.menuBar()
        action = next(each for each in bar.actions() if plain(each.text()) == title)
        self.click(bar, bar.actionGeometry(action).center())
        for text in way:
            place = action.menu()
            assert isinstance(place, QMenu)
            action = next(each for each in place.actions() if plain(each.text()) == text)
            self.entry(place, text)

    def button(self, bar: QToolBar, text: str) -> None:
        action = next(each for each in bar.actions() if plain(each.text()) == text)
        button = bar.widgetForAction(action)
        assert isinstance(button, QToolButton)
        assert button.isVisible(), text
        self.click(button)

    def task(self, text: str) -> None:
        bar = self.window.findChild(QToolBar, "tasks")
        assert isinstance(bar, QToolBar)
        self.button(bar, text)

    def tab(self, text: str) -> None:
        """Of a dock behind others, or of a page."""
        for bar in self.window.findChildren(QTabBar):
            for index in range(bar.count()) if bar.isVisible() else ():
                if plain(bar.tabText(index)) == text:
                    self.click(bar, bar.tabRect(index).center())
                    return
        raise AssertionError(f"{text}: no such tab")

    def from_menu_of(self, button: QToolButton, text: str) -> None:
        """A menu that opens under a button, and an entry of it."""

        def choose() -> None:
            menu = QApplication.activePopupWidget()
            if isinstance(menu, QMenu):
                self.entry(menu, text)
            else:
                QTimer.singleShot(5, choose)

        QTimer.singleShot(0, choose)
        self.click(button, QPoint(8, button.height() // 2))

    def draw(self, widget: QWidget, begin: QPoint, pixels: int) -> None:
        QTest.mousePress(widget, LEFT, pos=begin)
        for part in (pixels // 3, 2 * pixels // 3, pixels):
            QTest.mouseMove(widget, begin + QPoint(part, 0))
            settle()
        QTest.mouseRelease(widget, LEFT, pos=begin + QPoint(pixels, 0))
        settle()

    def view(self, name: str, kind: type[Any]) -> Any:
        """A view that can be seen, up to date."""
        view = self.window.view(name)
        assert isinstance(view, kind)
        wait_for(lambda: view.on_screen() and view.up_to_date)
        view.settle()
        return view

    def take_over(self, what: str) -> Solution:
        """Choose it in the Find dock, wait for its answer and press the button: one step."""
        view = self.view("find", FindView)  # its list is that of the design at hand
        for _ in range(view.what.count()):
            if view.what.currentData() == what:
                break
            view.what.setFocus()
            QTest.keyClick(view.what, Qt.Key.Key_Down)
        settle()
        wait_for(lambda: view.up_to_date and not view.busy and view.solution is not None and view.take.isEnabled())
        settle()  # the answer takes its room, and the button stands
        assert view.solution is not None
        found = view.solution
        before = len(self.user.steps)
        self.click(view.take)
        assert len(self.user.steps) == before + 1
        assert self.user.session.full_design == found.machine
        return found


def sums(view: ShaftTorqueView) -> np.ndarray:
    """The torque of the whole shaft as it is drawn [N m]."""
    line = 1 if view.session.full_design.balancer is not None else 0
    return np.asarray(view.sums.lines[line][1][:-1] * view.sums.display_unit.size)


@pytest.mark.stress
def test_the_transfer_unit_is_worked_through_with_the_mouse(open_user: Open) -> None:
    user = open_user(size=(1280, 720), whole=True)
    hand, session, player = Hand(user), user.session, user.window.player
    size = user.window.size()
    hand.menu("File", "Examples", "Transfer unit")
    assert session.full_design == load(example("transfer_unit"))

    # several drives drawn, and played by the space bar
    hand.task("Dyna")
    drawing = user.drawing()
    hand.button(drawing.strip.arrangement_bar, plain(drawing.strip.arrangements[SIDE_BY_SIDE].text()))
    assert drawing.all_canvas.isVisible()
    user.press(Qt.Key.Key_Space)
    assert player.playing
    wait_for(lambda: degrees(player.machine) > 20.0)
    user.press(Qt.Key.Key_Space)
    assert not player.playing
    settle()
    machine = degrees(player.machine)
    for drive, figure in zip(session.full_design.drives, drawing.assembly.figures.values(), strict=True):
        cam = next(part.item for part in figure.parts if part.key == "cam")
        seen = cam.mapToScene(1.0, 0.0) - cam.mapToScene(0.0, 0.0)
        own = machine - drive.phase_deg
        wanted = 180.0 + own if drive.mirrored else own
        off = (degrees(atan2(seen.y(), seen.x())) - wanted + 180.0) % 360.0 - 180.0
        assert abs(off) < 0.11, f"{drive.name}: drawn at the nearest of 1800 angles"
    slider = user.window.bar.slider
    hand.click(slider, QPointF(slider.position_of(90.0), slider.height() / 2.0).toPoint())
    assert degrees(player.machine) == pytest.approx(90.0, abs=1.0)

    # its timing drawn with the mouse: the torque of the whole follows
    torque = hand.view("shaft_torque", ShaftTorqueView)
    assert np.allclose(sums(torque), Study(session.full_design, 1800).camshaft.torque, atol=1e-9)
    before = sums(torque)
    timing = hand.view("timing", TimingView)
    chart = timing.canvas.chart
    place = QPointF(chart.x(180.0), chart.box(CLAMP).center().y()).toPoint()
    hand.draw(timing.canvas, place, round(-3.0 * chart.degree))
    assert session.full_design.drives[CLAMP].phase_deg == pytest.approx(235.0, abs=0.6)
    hand.draw(timing.canvas, chart.join_position(FEED, 3).toPoint(), round(-8.0 * chart.degree))
    assert len(user.steps) == 2
    assert all(each.spare_deg >= 0.0 for each in distances(session.full_design))
    torque = hand.view("shaft_torque", ShaftTorqueView)
    drawn = Study(session.full_design, 1800)
    assert np.allclose(sums(torque), drawn.camshaft.torque, atol=1e-9)
    assert np.abs(sums(torque) - before).max() > 0.01 * np.abs(before).max()

    # flywheel and phases, each found and taken over as one step
    hand.menu("Kine", "Find")
    hand.click(hand.view("find", FindView).exact)  # else what is taken over is rounded
    speed = session.shaft.motor_range["speed"]
    reached = (speed.high.value - speed.low.value) / session.shaft.omega
    assert hand.take_over("flywheel").before["shaft.speed_fluctuation"] == pytest.approx(reached, rel=1e-6)
    speed = session.shaft.motor_range["speed"]
    assert (speed.high.value - speed.low.value) / session.shaft.omega == pytest.approx(
        session.full_design.camshaft.speed_fluctuation, rel=1e-6
    )
    peak = hand.take_over("phases").reached["peak_torque_nm"]
    assert abs(session.shaft.peak_torque.value) == pytest.approx(peak, rel=1e-9)
    assert peak < 0.95 * abs(drawn.camshaft.peak_torque.value)
    assert all(each.spare_deg > -1e-9 for each in distances(session.full_design))

    # a balance cam as one more drive, with its profile and its findings
    hand.tab("Drives")
    drives = hand.view("drives", DrivesView)
    hand.from_menu_of(drives.buttons["add"], "Balance cam")
    drives = hand.view("drives", DrivesView)
    assert drives.table.item(4, NAME).text() == "Balance cam"
    assert session.is_on_balancer
    hand.from_menu_of(drawing.strip.arrangement_list, plain(drawing.strip.arrangements[ONE].text()))
    balancer = session.shaft.balancer
    assert balancer is not None
    box, profile = drawing.scene.item("cam").boundingRect(), balancer.cam.flanks[0].profile * 1e3
    assert (box.left(), box.right()) == pytest.approx((profile.real.min(), profile.real.max()), abs=0.1)
    torque = hand.view("shaft_torque", ShaftTorqueView)
    assert np.ptp(sums(torque)) < 1e-9 * np.ptp(before)
    hand.tab("Findings")
    findings = user.see("findings")
    assert isinstance(findings, FindingsView)
    assert {each.field for each in findings.findings} == {"balancer.base_radius_mm"}
    assert [each.code for each in findings.findings] == ["pressure-angle", "convex-radius"]
    hand.take_over("balancer")
    sharpest = min(
        each.smallest.value
        for each in smallest_radii(session.shaft.balancer)
        if each.is_on_profile and not each.is_concave
    )
    assert 1e3 * sharpest == pytest.approx(0.5 * session.full_design.balancer.roller_radius_mm, rel=1e-6)
    findings = user.see("findings")
    assert isinstance(findings, FindingsView)
    assert findings.findings == (), "its spring keeps the limit now"

    # forbidden speeds
    for tab in ("Over speed", "Drives"):
        hand.tab(tab)
        assert user.window.size() == size, f"{tab} has room"
    hand.task("Stability")
    page = hand.view("stability", StabilityView)
    hand.tab("Speeds")
    bands = session.shaft.flexible_shaft().bands
    wait_for(lambda: "rpm" in page.pages.speeds.text())
    assert page.pages.speeds.isVisible()
    assert page.pages.speeds.text() == bands_table(bands, session.full_design.camshaft.speed_rpm)
    assert "1264" in page.pages.speeds.text()
    assert user.window.size() == size
    assert user.faults == []
