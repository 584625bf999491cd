"""Designs from an empty file with the mouse alone: the lift's modified sine in the motion editor, the card picker in the
blend wizard, every face and form of a cam up to its torque. Every event is a click, a drag or a turn of the wheel; what is
saved is compared with the examples."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from plot_reading import curves
from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QStyle, QStyleOptionSpinBox, QToolBar, QWidget
from sampled import stressed
from window_user import Open, User, plain, settle, wait_for

from core.design import edited, get, join_angles, join_levels, with_drive
from core.project import dumps, load, loads
from core.study import Study, extremes_of
from kindyna_gui import dialogs
from kindyna_gui.blend.wizard import BlendDialog
from kindyna_gui.cam_dialogs.profile_dialogs import ProfileDialog
from kindyna_gui.files.beginnings import beginning
from kindyna_gui.find import FindView
from kindyna_gui.forms.number_box import NumberBox, WordBox
from kindyna_gui.motion.law_picker import LawBox
from kindyna_gui.motion.segments_table import LAW
from kindyna_gui.motion.segments_view import SegmentsView
from kindyna_gui.places import example
from kindyna_gui.window.gallery import Gallery

LEFT = Qt.MouseButton.LeftButton
TRIES = 60


@pytest.fixture
def open_user(same_window: Open) -> Open:
    return same_window


class Mouse:
    """The mouse of a user, and nothing else."""

    def __init__(self, user: User) -> None:
        self.user = user

    def click(self, widget: QWidget, at: QPoint | None = None) -> None:
        QTest.mouseClick(widget, LEFT, pos=widget.rect().center() if at is None else at)
        settle()

    def menu(self, *way: str) -> None:
        """Click from menu to menu."""
        place: Any = self.user.window.menuBar()
        for text in way:
            action = next(a for a in place.actions() if plain(a.text()) == text)
            QTest.mouseClick(place, LEFT, pos=place.actionGeometry(action).center())
            settle()
            if isinstance(action.menu(), QMenu):
                place = action.menu()
                wait_for(place.isVisible)

    def drag(self, widget: QWidget, begin: QPoint, by: QPoint) -> None:
        """Press, move in steps as a hand does, release."""
        QTest.mouseMove(widget, begin)
        QTest.mousePress(widget, LEFT, pos=begin)
        for k in range(1, 5):
            QTest.mouseMove(widget, begin + by * k / 4)
        QTest.mouseMove(widget, begin + by)
        settle()
        QTest.mouseRelease(widget, LEFT, pos=begin + by)
        settle()

    def count_to(self, box: NumberBox, wanted: float) -> None:
        """Click the arrows of a spin box until it shows a number."""
        for _ in range(TRIES):
            if box.number == wanted:
                return
            option = QStyleOptionSpinBox()
            box.initStyleOption(option)
            up = box.number is not None and box.number < wanted
            part = QStyle.SubControl.SC_SpinBoxUp if up else QStyle.SubControl.SC_SpinBoxDown
            self.click(box, box.style().subControlRect(QStyle.ComplexControl.CC_SpinBox, option, part, box).center())
        raise AssertionError(f"{box.number} instead of {wanted}")


class Editor:
    """The motion editor under the mouse."""

    def __init__(self, mouse: Mouse) -> None:
        self.mouse, self.view = mouse, mouse.user.motion()
        self.paper = self.view.diagram.viewport()

    @property
    def motion(self) -> Any:
        return self.mouse.user.design.drive.motion

    def row(self, number: int) -> None:
        """Click a row of the table."""
        view: SegmentsView = self.view
        self.mouse.click(view.table.viewport(), view.table.visualRect(view.model.index(number, LAW)).center())

    def law(self, number: int, slug: str) -> None:
        """Double click the law of a segment, then a picture of the picker."""
        table = self.view.table
        at = table.visualRect(self.view.model.index(number, LAW)).center()
        QTest.mouseClick(table.viewport(), LEFT, pos=at)
        QTest.mouseDClick(table.viewport(), LEFT, pos=at)
        wait_for(lambda: any(box.picker is not None for box in table.findChildren(LawBox)))
        picker = next(box.picker for box in table.findChildren(LawBox) if box.picker is not None)
        wait_for(picker.isVisible)
        grid, area = picker.grid, picker.area
        area.ensureVisible(grid.box(slug).center().x(), grid.box(slug).center().y())
        settle()
        self.mouse.click(grid, grid.box(slug).center())
        wait_for(lambda: self.motion.segments[number].curve.law == slug)

    def _pull(self, way: QPoint, value: Callable[[], float], wanted: float, first: int) -> None:
        """Drag to and fro, as a hand that watches the number beside the mouse, until it is the wanted one.

        Pixels and round steps seldom meet at once; from another place they do.
        """
        diagram = self.view.diagram
        for attempt in range(TRIES):
            if abs(value() - wanted) < 1e-9:
                return
            scale, grip = diagram.scale_now(), diagram.position_of_join(first).toPoint()
            pixels = (wanted - value()) * (scale.degree if way.x() else -scale.unit)
            step = round(pixels) + (0, 1, -1, 2, -2, 5, -7)[attempt % 7]
            if 0 < abs(step) <= 3:
                step += 9 if attempt % 2 else -9  # a hand trembles by so much: go away and come back
            self.mouse.drag(self.paper, grip, way * step)
        raise AssertionError(f"{value()} instead of {wanted}")

    def angle(self, join: int, wanted: float) -> None:
        self._pull(QPoint(1, 0), lambda: join_angles(self.motion)[join], wanted, join)

    def level(self, join: int, wanted: float) -> None:
        self._pull(QPoint(0, 1), lambda: join_levels(self.motion)[join], wanted, join)


def saved(user: User, path: Path, monkeypatch: pytest.MonkeyPatch, mouse: Mouse) -> str:
    monkeypatch.setattr(dialogs, "design_to_save", lambda *_: path)
    mouse.menu("File", "Save")
    return path.read_text(encoding="utf-8")


@pytest.mark.stress
def test_the_lift_is_laid_out_by_mouse(open_user: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    user = open_user(size=(1440, 900), whole=True)
    mouse = Mouse(user)
    mouse.menu("File", "New by type", "Cam-driven slider")
    # the dock beside the drawing is made wider, for a steady hand
    dock = user.window.docks["motion"]
    edge = dock.mapTo(user.window, QPoint(dock.width() + 2, dock.height() // 2))
    mouse.drag(user.window, edge, QPoint(420, 0))
    assert user.window.docks["motion"].width() > 700

    editor = Editor(mouse)
    for row, name in ((0, "delete"), (1, "duplicate"), (1, "insert")):  # the joins find their places below
        editor.row(row)
        mouse.click(editor.view.bar.buttons[name])
    assert len(editor.motion.segments) == 5
    for join, angle in ((1, 35.0), (2, 76.5), (4, 325.0), (3, 283.5)):
        editor.angle(join, angle)
    editor.level(0, 150.0)
    editor.level(2, 0.0)
    assert join_levels(editor.motion)[:5] == pytest.approx([150.0, 150.0, 0.0, 0.0, 150.0], abs=1e-9)

    lift = load(example("transfer_lift"))
    wanted = with_drive(beginning("cam-slider"), motion=lift.drive.motion)
    assert (wanted.drive.mechanism, wanted.drive.loads) == (lift.drive.mechanism, lift.drive.loads)
    assert saved(user, tmp_path / "lift.toml", monkeypatch, mouse) == dumps(wanted)


@pytest.mark.stress
def test_the_card_picker_is_blended_by_mouse(open_user: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    user = open_user(size=(1440, 900))
    mouse = Mouse(user)
    mouse.menu("File", "New by type", "Translating follower")
    editor = Editor(mouse)
    for row in (0, 1, 0):  # nothing but a dwell
        editor.row(row)
        mouse.click(editor.view.bar.buttons["delete"])
    still = user.design
    mouse.menu("Make", "Blend...")
    dialog = user.window.findChild(BlendDialog)
    assert dialog is not None
    wait_for(dialog.isVisible)
    assert dialog.isModal()
    wait_for(lambda: not dialog.busy)
    assert dialog.panel.headline.text() == "P1–P2", "a motion without settings is answered at once"
    questions = dialog.questions
    mouse.click(questions.kind.types["DRRD"])
    mouse.click(questions.kind.constants["rise"], QPoint(8, questions.kind.constants["rise"].height() // 2))
    for box, wanted in ((questions.stroke, 20.0), (questions.start, 30.0), (questions.end, 330.0)):
        mouse.count_to(box, wanted)
    for name in ("h1", "h3"):
        row = questions.settings.rows[name]
        mouse.click(row.check, QPoint(8, row.check.height() // 2))
        mouse.count_to(row.box, 1.0)
    wait_for(lambda: dialog.put_button.isEnabled())
    assert dialog.panel.headline.text() == "C1–CV1–H2–P2"
    row = dialog.panel.table.rows.rows[1].cells
    assert row == ("CV1", "18.0000", "169.6215", "48.8468", "218.4684", "1.0000", "19.0000")
    assert "CV1 runs at 0.1061 mm/° (38.20 mm/s) for 169.6°" in dialog.panel.figures.text()
    mouse.click(dialog.put_button)
    wait_for(lambda: len(user.design.drive.motion.segments) == 6)
    assert user.window.findChild(BlendDialog) is None, "it is gone"
    assert user.steps[-1] == "Blend C1-CV1-H2-P2"

    picker = load(example("card_picker"))
    text = saved(user, tmp_path / "picker.toml", monkeypatch, mouse)
    solved, wanted_motion = loads(text).drive.motion, picker.drive.motion
    # The last digits of a solved span are the processor's own: the spans to rounding, all else as it stands in the file.
    spans = [segment.span_deg for segment in wanted_motion.segments]
    assert [segment.span_deg for segment in solved.segments] == pytest.approx(spans, abs=1e-11)
    for got, wanted_span in zip(solved.segments, spans, strict=True):
        text = text.replace(f"span_deg = {got.span_deg!r}\n", f"span_deg = {wanted_span!r}\n")
    wanted = with_drive(beginning("translating"), motion=wanted_motion)
    assert (wanted.drive.mechanism, wanted.drive.loads) == (picker.drive.mechanism, picker.drive.loads)
    assert text == dumps(wanted)
    user.session.stack.undo()
    assert user.design == still, "one step"


# -- every follower, face and form --------------------------------------------------------------------------

FACES_AND_FORMS = {
    "Translating follower": ("Roller", "Flat face", "Knife edge", "Curved shoe", "Groove", "Conjugate pair"),
    "Oscillating follower": ("Flat face", "Conjugate pair"),
}
"""Of an arm those whose classes are others than under a slide; its roller is sized below."""


def begin_by_picture(mouse: Mouse, group: str, caption: str) -> None:
    """File > New, a click on the group, one on the picture, one on Begin."""
    seen: list[str] = []

    def choose() -> None:
        dialog = QApplication.activeModalWidget()
        if not isinstance(dialog, Gallery):
            QTimer.singleShot(5, choose)
            return
        names, pictures = dialog.names, dialog.groups[group]
        mouse.click(names.viewport(), names.visualItemRect(names.item(list(dialog.groups).index(group))).center())
        row = next(i for i in range(pictures.count()) if pictures.item(i).text() == caption)
        mouse.click(pictures.viewport(), pictures.visualItemRect(pictures.item(row)).center())
        seen.append(pictures.item(row).toolTip())
        mouse.click(dialog.ok)

    QTimer.singleShot(0, choose)
    mouse.menu("File", "New...")
    assert seen, "no gallery opened"
    window = mouse.user.window
    window.activateWindow()  # which a desktop does by itself
    assert QTest.qWaitForWindowActive(window)
    settle()


@pytest.mark.stress
@pytest.mark.parametrize("group", FACES_AND_FORMS)
def test_every_face_and_form_comes_to_its_profile_and_its_torque_by_mouse(group: str, open_user: Open) -> None:
    user = open_user(size=(1440, 900), whole=True)
    mouse = Mouse(user)
    bar = user.window.findChild(QToolBar, "tasks")
    assert isinstance(bar, QToolBar)
    buttons = {action.text().replace("&", ""): bar.widgetForAction(action) for action in bar.actions()}
    for caption in FACES_AND_FORMS[group]:
        begin_by_picture(mouse, group, caption)
        assert [s.span_deg for s in user.design.drive.motion.segments] == [120.0, 60.0, 120.0, 60.0]
        mouse.click(buttons["Kine"])
        drawing = user.drawing()
        assert drawing.on_screen()
        assert drawing.note.isHidden(), "a cam is there"
        shape = user.session.study.cam
        for name, flank in zip(
            ("cam", *(key for key in ("outer", "second") if key in drawing.scene.parts)), shape.flanks, strict=True
        ):
            box, profile = drawing.scene.item(name).boundingRect(), flank.profile * 1e3
            assert (box.left(), box.right()) == pytest.approx((profile.real.min(), profile.real.max()), abs=0.1)
            assert (box.top(), box.bottom()) == pytest.approx((profile.imag.min(), profile.imag.max()), abs=0.1)
        mouse.click(buttons["Dyna"])
        torque = user.window.view("torque")
        assert torque is not None
        wait_for(lambda view=torque: view.on_screen() and view.up_to_date)  # type: ignore[misc]
        assert not torque.in_trouble
        assert curves(torque.plot)  # type: ignore[attr-defined]
        assert user.faults == []


# -- from an empty file to a cam of 30° and its DXF ---------------------------------------------------------


class Actions(Mouse):
    """A user who counts: a choice in a menu or a list, a field typed and entered, a button."""

    count = 0

    def choose(self, *way: str) -> None:
        self.count += 1
        self.menu(*way)

    def press_button(self, button: QWidget) -> None:
        self.count += 1
        self.click(button)

    def type_in(self, box: NumberBox, text: str) -> None:
        self.count += 1
        self.click(box, QPoint(10, box.height() // 2))
        box.selectAll()
        QTest.keyClicks(box, text)
        QTest.keyClick(box, Qt.Key.Key_Return)
        settle()

    def pick(self, box: WordBox, key: str) -> None:
        """From a list, by the keys."""
        self.count += 1
        box.setFocus()
        for _ in range(box.count()):
            QTest.keyClick(box, Qt.Key.Key_Up)
        first = box.currentIndex()
        for _ in range(box.findData(key) - first):
            QTest.keyClick(box, Qt.Key.Key_Down)
        QTest.keyClick(box, Qt.Key.Key_Return)
        settle()

    def add_limit(self, view: FindView, key: str) -> None:
        """By the button and its menu."""
        self.count += 1
        self.click(view.limits.add)
        menu = view.limits.menu
        wait_for(menu.isVisible)
        action = next(each for each in menu.actions() if each.data() == key)
        self.click(menu, menu.actionGeometry(action).center())

    def export_dxf(self, path: Path) -> None:
        """File > Export > Profile as it is offered, its button, and a name."""

        def accept() -> None:
            dialog = QApplication.activeModalWidget()
            if not isinstance(dialog, ProfileDialog) or not dialog.export.isEnabled():
                QTimer.singleShot(5, accept)
                return
            self.press_button(dialog.export)

        self.user.picks("profile_to_save", path)
        self.count += 1  # the name
        QTimer.singleShot(0, accept)
        self.choose("File", "Export", "Profile...")


def rested(view: FindView) -> FindView:
    """Once its answer stands there."""
    wait_for(lambda: view.up_to_date and not view.busy)
    return view


def highest(design: Any, name: str) -> float:
    """Of a quantity of the cam, over the turn."""
    limits = extremes_of(Study(design), "cam", (name,))
    return float(limits[name].high.value)


@pytest.mark.parametrize("kind", ["Translating follower", stressed("Oscillating follower"), stressed("Flat face")])
def test_a_cam_goes_from_nothing_to_its_limit_and_to_a_dxf_in_twelve_actions(
    open_user: Open, tmp_path: Path, kind: str
) -> None:
    """A stroke of 40 mm; a pressure angle of 30° under a roller, a least radius of 25 mm under a flat face."""
    user = open_user(size=(1280, 720), whole=True)
    actor = sized(user, kind)
    actor.export_dxf(tmp_path / "cam.dxf")
    drawing = ezdxf.readfile(tmp_path / "cam.dxf")
    assert not drawing.audit().has_errors
    assert drawing.modelspace().query("*[layer=='PROFILE']")
    assert actor.count <= 12
    assert user.faults == []


def sized(user: User, kind: str) -> Actions:
    """From File > New to the base radius that just keeps the limit."""
    actor, flat = Actions(user), kind == "Flat face"
    if flat:
        begin_by_picture(actor, "Translating follower", kind)
        actor.count += 4  # the menu, the group, the picture, Begin
    else:
        actor.choose("File", "New by type", kind)
    arm = getattr(user.design.drive.mechanism, "arm_mm", None)
    assert user.design.drive.motion is not None
    stroke = user.number(f"motion.stroke_{user.design.drive.motion.unit}")
    actor.type_in(stroke, "40" if arm is None else f"40/{arm} rad")
    actor.choose("Kine", "Find")

    view = user.window.view("find")
    assert isinstance(view, FindView)
    rested(view)
    if flat:
        actor.type_in(view.limits.boxes["convex_radius_mm"], "25")
    elif view.limits.boxes["pressure_angle_rise_deg"].value != 30.0:
        for stretch in ("rise", "return"):
            actor.type_in(rested(view).limits.boxes[f"pressure_angle_{stretch}_deg"], "30")
    if not rested(view).take.isEnabled():
        assert "No value meets all limits" in view.answer.text()
        actor.pick(view.what, "pivot")
        actor.press_button(rested(view).take)
        actor.pick(view.what, "base-radius")
    actor.press_button(rested(view).take)
    radius = get(user.design, "cam.base_radius_mm")
    assert radius == pytest.approx(round(radius, 1), abs=1e-12), "a radius that can be made"
    smaller = edited(user.design, "cam.base_radius_mm", radius - 0.1)
    for design, keeps in ((user.design, True), (smaller, False)):
        if flat:
            curvature = extremes_of(Study(design), "cam", ("profile_curvature",))["profile_curvature"].high.value
            assert (1.0 / curvature >= 0.025) == keeps
        else:
            assert (np.rad2deg(highest(design, "pressure_angle")) <= 30.0) == keeps
    return actor
