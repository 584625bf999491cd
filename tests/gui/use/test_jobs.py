"""Whole jobs of a designer at the window, by mouse and keys alone, counted. An action is a click, a drag, a shortcut, or a typed value
with Enter; a menu costs a click for its title and one for each entry on the way, a dialog one for each of its buttons, and a field
that has not the keys yet a click before its value is typed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QApplication,
    QComboBox,
    QDialogButtonBox,
    QFileDialog,
    QMenu,
    QPushButton,
    QTabBar,
    QToolBar,
    QWidget,
)
from sampled import stressed
from window_user import Open, User, pixel, plain, settle, wait_for

from core.design import get
from core.project import load
from core.study import Study, findings_of
from kindyna_gui.cam_dialogs.profile_dialogs import ProfileDialog
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.places import example
from kindyna_gui.stability_pages import bands_table
from kindyna_gui.window.gallery import DWELL, Gallery

LEFT, RIGHT = Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton
SMALL = (1280, 720)
LARGER = [stressed(size) for size in ((1440, 900), (1920, 1080))]
SIZES = [SMALL, *LARGER]


class Counted:
    """One user's hands: each of these is an action, and what is clicked can be seen where it is clicked."""

    def __init__(self, user: User) -> None:
        self.user, self.window = user, user.window
        self.actions = 0

    # -- clicks -------------------------------------------------------------------------------------------

    def click(self, widget: QWidget, at: QPoint | None = None, button: Qt.MouseButton = LEFT) -> None:
        self.actions += 1
        place = widget.rect().center() if at is None else at
        assert widget.visibleRegion().contains(place), f"{widget} cannot be seen there"
        assert widget.isEnabled()
        QTest.mouseClick(widget, button, pos=place)
        settle()

    def double_click(self, widget: QWidget, at: QPoint) -> None:
        """A double click, as the desktop sends it: the click first, then the second press."""
        self.click(widget, at)
        QTest.mouseDClick(widget, LEFT, pos=at)
        settle()

    def entry(self, menu: Any, text: str) -> QMenu | None:
        """An entry of a menu that is open, or of the bar; the menu that it opens."""
        action = next(each for each in menu.actions() if plain(each.text()) == text)
        assert action.isEnabled()
        inner = action.menu()
        self.click(menu, menu.actionGeometry(action).center())
        if isinstance(inner, QMenu):
            wait_for(inner.isVisible)
            return inner
        return None

    def menu(self, *way: str) -> None:
        """From the bar of menus to an entry, a click each."""
        place: Any = self.window.menuBar()
        for text in way:
            place = self.entry(place, text)

    def under(self, widget: QWidget, at: QPoint, text: str) -> None:
        """A context menu, and its entry."""
        self.click(widget, at, RIGHT)
        asked = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, at, widget.mapToGlobal(at))
        QApplication.sendEvent(widget, asked)  # as a desktop does
        wait_for(lambda: isinstance(QApplication.activePopupWidget(), QMenu))
        self.entry(QApplication.activePopupWidget(), text)

    def task(self, text: str) -> None:
        bar = self.window.findChild(QToolBar, "tasks")
        assert isinstance(bar, QToolBar)
        self.click(bar.widgetForAction(next(each for each in bar.actions() if plain(each.text()) == text)))

    def tab(self, text: str) -> None:
        """Of docks behind each other, or of a page."""
        bars = [bar for bar in self.window.findChildren(QTabBar) if bar.isVisible()]
        bar, number = next((b, i) for b in bars for i in range(b.count()) if plain(b.tabText(i)) == text)
        self.click(bar, bar.tabRect(number).center())

    def drag(self, widget: QWidget, begin: QPoint, end: QPoint) -> None:
        self.actions += 1
        QTest.mouseMove(widget, begin)
        QTest.mousePress(widget, LEFT, pos=begin)
        for part in (0.3, 0.7, 1.0):
            QTest.mouseMove(widget, begin + (end - begin) * part)
            settle()
        QTest.mouseRelease(widget, LEFT, pos=end)
        settle()

    # -- keys ---------------------------------------------------------------------------------------------

    def keys(self, key: Qt.Key, modifier: Qt.KeyboardModifier) -> None:
        """A shortcut."""
        self.actions += 1
        QTest.keyClick(QApplication.focusWidget() or self.window, key, modifier)
        settle()

    def type(self, text: str) -> None:
        """A value and Enter, to what has the keys."""
        self.actions += 1
        holder = QApplication.focusWidget()
        assert holder is not None
        QTest.keyClicks(holder, text)
        QTest.keyClick(holder, Qt.Key.Key_Return)
        settle()

    def enter(self, path: str, text: str) -> None:
        """Click a field of the inspector that can be seen, and type its value."""
        box = self.field(path)
        assert isinstance(box, NumberBox)
        self.click(box, QPoint(8, box.height() // 2))
        box.selectAll()  # as a double click would
        self.type(text)

    def reveal(self, widget: QWidget) -> None:
        """Roll a page by the wheel until a widget of it is in sight, which is no action."""
        area = widget.parentWidget()
        while area is not None and not hasattr(area, "ensureWidgetVisible"):
            area = area.parentWidget()
        if area is not None:
            area.ensureWidgetVisible(widget)
            settle()

    def pick(self, path: str, word: str) -> None:
        """Open the list of a field, and click its entry."""
        self.choose(self.field(path), self.field(path).findData(word))

    def choose(self, box: QComboBox, number: int) -> None:
        """Open a list, and click the entry of this number."""
        self.click(box)
        view = box.view()
        wait_for(view.isVisible)
        row = box.model().index(number, 0)
        view.scrollTo(row)
        self.click(view.viewport(), view.visualRect(row).center())
        while view.isVisible():  # a list that has just opened takes a release for that of the click that has opened it
            QTest.qWait(10)
            QTest.mouseClick(view.viewport(), LEFT, pos=view.visualRect(row).center())
        settle()

    def field(self, path: str) -> Any:
        """The editor of a field of the inspector, which stands on the page in front."""
        field = self.user.window.view("parameters").field(path)  # type: ignore[union-attr]
        assert field is not None, path
        self.reveal(field.editor)
        return field.editor

    # -- dialogs ------------------------------------------------------------------------------------------

    def during(self, open: Callable[[], None], *acts: tuple[type[QWidget], Callable[[Any], None]]) -> None:
        """Do what opens dialogs, one after the other, and act on each as it comes."""
        left, failed = list(acts), list[BaseException]()

        def look() -> None:
            dialog = QApplication.activeModalWidget()
            try:
                if dialog is not None and dialog.isVisible() and left and isinstance(dialog, left[0][0]):
                    left.pop(0)[1](dialog)
            except BaseException as error:
                failed.append(error)
                dialog.close()  # type: ignore[union-attr]
            if left and not failed:
                timer.start()

        timer = QTimer(self.window, singleShot=True, interval=5)
        timer.timeout.connect(look)
        timer.start()
        open()
        wait_for(lambda: not left or bool(failed))
        if failed:
            raise failed[0]
        self.window.activateWindow()  # which a desktop does by itself
        assert QTest.qWaitForWindowActive(self.window)
        settle()

    def begin(self, group: str, caption: str, dwell: bool = False) -> Callable[[Gallery], None]:
        """In the gallery: a group, a double click on a picture; or a picture, with what the motion begins, Begin."""

        def act(dialog: Gallery) -> None:
            names, pictures = dialog.names, dialog.groups[group]
            if names.currentItem().text() != group:
                item = next(names.item(i) for i in range(names.count()) if names.item(i).text() == group)
                self.click(names.viewport(), names.visualItemRect(item).center())
            item = next(pictures.item(i) for i in range(pictures.count()) if pictures.item(i).text() == caption)
            at = pictures.visualItemRect(item).center()
            if dwell:
                self.click(pictures.viewport(), at)
                button = dialog.orders[DWELL]
                self.click(button, QPoint(8, button.height() // 2))
                self.click(dialog.ok)
            else:
                self.double_click(pictures.viewport(), at)

        return act


@pytest.mark.stress
@pytest.mark.parametrize("size", SIZES)
def test_a_flat_cam_that_begins_with_a_dwell_goes_from_new_to_its_dxf(
    open_user: Open, size: tuple[int, int], tmp_path: Path
) -> None:
    """With a stroke and a base circle of its own; no shortcut is used."""
    user = open_user(size=size, whole=True)
    hand = Counted(user)
    user.window.settings.folder = tmp_path

    def export(dialog: ProfileDialog) -> None:
        wait_for(dialog.export.isEnabled)
        hand.click(dialog.export)

    def save(dialog: QFileDialog) -> None:
        buttons = dialog.findChild(QDialogButtonBox)
        assert buttons is not None
        hand.click(buttons.button(QDialogButtonBox.StandardButton.Save))

    hand.during(
        lambda: hand.menu("File", "New..."), (Gallery, hand.begin("Translating follower", "Flat face", dwell=True))
    )
    assert [s.span_deg for s in user.design.drive.motion.segments] == [60.0, 120.0, 60.0, 120.0]
    hand.type("24")
    assert [s.rise for s in user.design.drive.motion.segments] == [0.0, 24.0, 0.0, -24.0]
    drawing = user.drawing()
    canvas, base = drawing.canvas, get(user.design, "cam.base_radius_mm")
    at = base * np.exp(1j * np.deg2rad(215.0))
    hand.drag(canvas.viewport(), pixel(canvas, at), pixel(canvas, at * 1.1))
    assert get(user.design, "cam.base_radius_mm") == pytest.approx(1.1 * base, rel=0.03)
    below = pixel(canvas, -0.5j * base)
    hand.during(
        lambda: hand.under(canvas.viewport(), below, "Export profile..."), (ProfileDialog, export), (QFileDialog, save)
    )
    (file,) = tmp_path.glob("*.dxf")
    drawn = ezdxf.readfile(file)
    assert not drawn.audit().has_errors
    assert drawn.modelspace().query("*[layer=='PROFILE']")
    assert [f for f in findings_of(Study(user.design)) if f.severity != "note"] == []
    assert user.faults == []
    assert hand.actions <= 12, hand.actions


@pytest.mark.stress
@pytest.mark.parametrize("size", SIZES)
def test_the_pressure_of_a_rocker_with_its_spring_and_material_is_read(open_user: Open, size: tuple[int, int]) -> None:
    user = open_user(size=size, whole=True)
    hand = Counted(user)
    hand.menu("File", "New by type", "Oscillating follower")
    hand.task("Dyna")
    hand.enter("loads.spring_rate_nm_per_rad", "55")
    hand.tab("Cam")
    hand.pick("cam.material", "42crmo4")
    hand.menu("Dyna", "Contact pressure")
    view: Any = user.window.view("contact_pressure")
    wait_for(lambda: view.on_screen() and view.up_to_date and view.plot.readings())
    design = user.design
    assert (design.drive.loads.spring_rate_nm_per_rad, design.drive.cam.material) == (55.0, "42crmo4")
    (stress,) = Study(design).stress.values()
    (read,) = view.plot.readings()
    assert read == f"{stress.pressure[0] / 1e6:.1f} MPa"
    assert len(user.steps) == 2
    assert hand.actions <= 12, hand.actions


@pytest.mark.stress
@pytest.mark.parametrize("size", SIZES)
def test_the_drives_of_a_transfer_unit_come_onto_a_new_shaft_with_the_values_that_are_offered(
    open_user: Open, size: tuple[int, int]
) -> None:
    """Lift, feed in a groove, clamp and torque balance: what they ask of the shaft together is read."""
    user = open_user(size=size, whole=True)
    hand = Counted(user)
    hand.during(
        lambda: hand.menu("File", "New by type", "Camshaft..."),
        (Gallery, hand.begin("Cam-driven slider", "Layout b")),
    )
    drives: Any = user.window.view("drives")
    add = drives.buttons["add"]

    def more(*way: str) -> Callable[[], None]:
        def act() -> None:
            QTimer.singleShot(0, choose)
            hand.click(add, QPoint(8, add.height() // 2))

        def choose() -> None:
            menu = QApplication.activePopupWidget()
            if isinstance(menu, QMenu) and menu.isVisible():
                hand.entry(menu, way[0])
            else:
                QTimer.singleShot(5, choose)

        return act

    hand.during(more("From images..."), (Gallery, hand.begin("Oscillating follower", "Groove")))
    more("Translating follower")()
    more("Translating follower")()
    hand.task("Dyna")
    kinds = [drive.kind for drive in user.session.full_design.drives]
    assert sorted(kinds) == sorted(drive.kind for drive in load(example("transfer_unit")).drives)
    view: Any = user.window.view("shaft_torque")
    wait_for(lambda: view is not None and view.on_screen() and view.up_to_date and not view.in_trouble)
    assert len(view.drives.lines) == 4
    if size == SMALL:
        hand.tab("Figures")  # behind the torque where the side is too low for both
    figures: Any = user.window.view("shaft_figures")
    wait_for(lambda: figures.on_screen() and figures.table.model().rowCount() >= 5)
    assert hand.actions <= 15, hand.actions


@pytest.mark.stress
@pytest.mark.parametrize("size", SIZES)
def test_the_forbidden_speeds_of_a_shaft_just_made_elastic_are_read(open_user: Open, size: tuple[int, int]) -> None:
    user = open_user(size=size, whole=True)
    hand = Counted(user)
    hand.task("Stability")
    page: Any = user.window.view("stability")
    (button,) = [each for each in page.findChildren(QPushButton) if each.isVisible()]
    hand.click(button)
    assert user.session.full_design.camshaft.elastic is not None
    hand.tab("Speeds")
    wait_for(lambda: page.pages.speeds.isVisible() and "rpm" in page.pages.speeds.text())
    rpm = user.session.full_design.camshaft.speed_rpm
    bands = sorted(
        user.session.shaft.flexible_shaft().bands, key=lambda band: max(band.rpm_lo - rpm, rpm - band.rpm_hi)
    )
    assert page.pages.speeds.text() == bands_table(bands, rpm)
    page.leave()
    assert hand.actions <= 6, hand.actions


ROCKER = {
    "motion.segments[0].span_deg": 60.0,
    "motion.segments[1].span_deg": 110.0,
    "motion.segments[2].span_deg": 60.0,
    "motion.segments[3].span_deg": 130.0,
    "motion.segments[1].rise_deg": 15.0,
    "motion.segments[3].law": "cycloidal",
    "follower.arm_mm": 80.0,
    "follower.pivot_y_mm": 25.0,
    "cam.base_radius_mm": 40.0,
    "cam.roller_radius_mm": 10.0,
    "shaft.speed_rpm": 240.0,
    "loads.spring_rate_nm_per_rad": 45.0,
}
"""A rocker cam of other numbers than those that are offered."""


@pytest.mark.stress
def test_the_rocker_cam_is_designed_in_inspector_and_drawing_without_a_menu_but_new(open_user: Open) -> None:
    """At the smallest window: what is typed where its part is clicked, what is held in the drawing, and the pages of the inspector."""
    user = open_user(size=SMALL, whole=True)
    hand = Counted(user)
    hand.during(
        lambda: hand.menu("File", "New..."), (Gallery, hand.begin("Oscillating follower", "Roller", dwell=True))
    )
    hand.type("15")  # the stroke
    hand.task("Kine")
    hand.tab("Motion")
    shown: Any = user.window.view("parameters").pages["motion"]  # type: ignore[union-attr]
    for number, key, text in ((1, "span_deg", "110"), (2, "span_deg", "60")):
        hand.reveal(shown.segment)
        hand.choose(shown.segment, number)
        hand.enter(f"motion.segments[{number}].{key}", text)
    hand.reveal(shown.segment)
    hand.choose(shown.segment, 3)
    hand.click(hand.field("motion.segments[3].law"))
    wait_for(lambda: shown.fields["motion.segments[3].law"].editor.picker is not None)
    hand.type("cycloidal")

    drawing = user.drawing()
    canvas, viewport = drawing.canvas, drawing.canvas.viewport()

    def handles() -> Any:
        assert drawing.scene.geometry is not None
        return drawing.scene.geometry, drawing.scene.geometry.handles(drawing.scene.index)

    def held(begin: complex, text: str) -> None:
        """Press, move, type what it shall be, let go: the typed value is an action more."""
        QTest.mousePress(viewport, LEFT, pos=pixel(canvas, begin))
        QTest.mouseMove(viewport, pixel(canvas, begin) + QPoint(4, 3))
        QTest.mouseMove(viewport, pixel(canvas, begin) + QPoint(9, 6))
        settle()
        assert drawing.drag is not None
        wait_for(lambda: any(line.startswith("Pressure angle") for line, _ in drawing.drag.lines))
        hand.type(text)
        QTest.mouseRelease(viewport, LEFT, pos=QPoint(5, 5))
        hand.actions += 1
        settle()

    geometry, points = handles()
    roller = complex(geometry.reference[drawing.scene.index])
    hand.click(viewport, pixel(canvas, 0.4 * roller + 0.6 * points["pivot"]))  # the arm
    hand.type("80")
    hand.enter("follower.pivot_y_mm", "25")
    geometry, _ = handles()
    held(geometry.base_radius * np.exp(2.5j), "40")
    geometry, _ = handles()
    held(complex(geometry.reference[drawing.scene.index]) + geometry.face_radius * np.exp(1.2j), "10")
    hand.tab("Shaft")
    hand.enter("shaft.speed_rpm", "240")
    hand.tab("Loads")
    hand.enter("loads.spring_rate_nm_per_rad", "45")

    assert {path: get(user.design, path) for path in ROCKER} == ROCKER
    assert [f for f in findings_of(Study(user.design)) if f.severity != "note"] == []
    assert user.faults == []
    assert len(user.steps) == 11, "each value is one"
