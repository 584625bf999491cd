"""kindyna_gui.drives: several drives on one shaft in the window; one chosen, all kept, by mouse and keys."""

from cmath import phase, rect
from dataclasses import replace
from itertools import pairwise
from math import atan2, cos, degrees, isclose, radians
from pathlib import Path
from shutil import copyfile

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QRectF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QLineEdit, QToolButton
from sampled import spread
from window_user import Open, User, end_pauses, pixel, settle, wait_for

from core.design import drive_names, only, phase_room
from core.design.limits import Waviness
from core.output.export import Film, as_texts, file_parts
from core.project import load
from core.study import Study
from core.study.stages import memory
from kindyna_gui import dialogs, export_dialogs
from kindyna_gui.cam_dialogs import profile_dialogs
from kindyna_gui.dialogs import OnShaft
from kindyna_gui.drives import ON_SHAFT, SIDE_BY_SIDE
from kindyna_gui.drives_view import NAME, PHASE, TORQUE, DrivesView
from kindyna_gui.export_dialogs import TablesRequest
from kindyna_gui.graph.plots_view import PlotView
from kindyna_gui.linkage.mechanism_view import MechanismView
from kindyna_gui.pictures.drawing.assembly import DriveFigure
from kindyna_gui.pictures.film import shoot
from kindyna_gui.places import example
from kindyna_gui.touch_targets import MouseReadout

UNIT = example("transfer_unit")
ROD = "follower.rod_mm"
ALT = Qt.KeyboardModifier.AltModifier


@pytest.fixture
def open_user(same_window: Open) -> Open:
    """One window for all tests of this file."""
    return same_window


@pytest.fixture
def unit(open_user: Open, tmp_path: Path) -> User:
    """A user at a window with a copy of the transfer unit, its drawing alone."""
    path = tmp_path / "unit.toml"
    copyfile(UNIT, path)
    return open_user(path)


def click_drive(user: User, number: int) -> None:
    """On the strip above the mechanism."""
    strip = user.drawing().strip
    button = strip.bar.widgetForAction(strip.actions_of_drives[number])
    assert isinstance(button, QToolButton)
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    settle()


def listed(user: User) -> DrivesView:
    view = user.see("drives")
    assert isinstance(view, DrivesView)
    view.settle()
    return view


def column(view: DrivesView, number: int) -> list[str]:
    return [view.table.item(row, number).text() for row in range(view.table.rowCount())]


def click_row(user: User, row: int) -> None:
    table = listed(user).table
    at = table.visualItemRect(table.item(row, NAME)).center() + QPoint(20, 0)
    QTest.mouseClick(table.viewport(), Qt.MouseButton.LeftButton, pos=at)
    settle()


def test_one_drive_is_chosen_and_edited_and_the_file_keeps_all(unit: User) -> None:
    session, player, whole = unit.session, unit.window.player, load(UNIT)
    strip = unit.drawing().strip
    assert strip.isVisible()
    assert [a.text() for a in strip.actions_of_drives] == ["Feed", "Clamp", "Lift", "Torque"]
    assert strip.actions_of_drives[0].isChecked()
    assert unit.design == only(whole, 0)
    player.set_machine(radians(100.0))
    click_drive(unit, 2)
    assert strip.actions_of_drives[2].isChecked()
    assert unit.design == only(whole, 2)
    assert unit.steps == [], "choosing is no edit"
    assert not session.modified
    assert isclose(degrees(player.theta), 100.0), "the lift stands at phase 0"
    click_drive(unit, 3)
    assert isclose(degrees(player.theta), 100.0 - 35.0)
    assert isclose(degrees(player.machine), 100.0)
    assert isclose(unit.window.bar.angle.value(), 100.0)
    assert unit.window.bar.angle.accessibleName() == "Machine angle"
    player.step(1.0)
    assert isclose(degrees(player.machine), 101.0)
    click_drive(unit, 2)

    listed(unit)  # peak torques of all drives are on the screen
    assert session.shaft.cams_torque.size
    before = memory.computed.copy()
    unit.enter(ROD, "850")
    assert session.full_design.drives[2].mechanism.rod_mm == 850.0
    assert session.full_design.drives[:2] == whole.drives[:2]
    assert session.shaft.cams_torque.size
    spent = memory.computed - before
    assert spent["linkage"] == spent["dynamics"] == 1, "one drive is computed anew"

    click_drive(unit, 0)
    unit.choose("Edit", "Undo Change rod L2 to 850 mm")
    assert session.full_design == whole
    assert session.chosen == 2, "what undo changes is shown"
    unit.choose("Edit", "Redo Change rod L2 to 850 mm")
    unit.enter("shaft.flywheel_inertia_kg_m2", "3000")
    unit.choose("File", "Save")
    assert session.path is not None
    assert not session.modified
    saved = load(session.path)
    assert saved == session.full_design
    assert saved.drives[2].mechanism.rod_mm == 850.0
    assert saved.shaft.flywheel_inertia_kg_m2 == 3000.0
    assert saved.timing == whole.timing
    session.restore(session.state())
    assert session.full_design == saved
    assert session.chosen == 2


def test_names_on_the_strip_are_read_in_full_where_they_have_room(open_user: Open) -> None:
    user = open_user(example("valve_train"), size=(1280, 720))
    user.window.show_task("compo")
    assert [action.iconText() for action in user.drawing().strip.actions_of_drives] == ["Inlet", "Exhaust"]


def test_all_drives_of_the_strip_are_in_sight_in_a_narrow_drawing(unit: User) -> None:
    """The arrangements are in a list there, and the names are shortened; the tips have them in full."""
    unit.window.show_task("compo")
    strip = unit.drawing().strip
    extension = strip.bar.findChild(QToolButton, "qt_toolbar_ext_button")
    for width in (640, 300, 240):
        strip.setFixedWidth(width)
        settle()
        assert not extension.isVisible(), width
        assert strip.arrangement_list.isVisible() == (width < 400)
    assert [action.iconText() for action in strip.actions_of_drives] == ["F", "C", "L", "T"]
    assert strip.actions_of_drives[2].toolTip() == "Show Lift in the forms and plots"
    menu = strip.arrangement_list.menu()
    next(action for action in menu.actions() if action.text() == "Side by side").trigger()
    settle()
    assert strip.arrangement_list.text() == "Side by side"
    strip.setMinimumWidth(0)
    strip.setMaximumWidth(10_000)
    strip.arrangements["one"].trigger()


def test_the_list_of_drives(unit: User) -> None:
    session, view = unit.session, listed(unit)
    assert column(view, NAME) == ["Feed", "Clamp", "Lift", "Torque"]
    assert column(view, PHASE) == ["328°", "238°", "0°", "35°"]
    peak = session.shaft.drive_peak("Lift").value / 1e3
    assert column(view, TORQUE)[2] == f"{peak:.3f} kN·m"
    click_row(unit, 1)
    assert session.chosen == 1
    assert unit.design.name == "Clamp"

    view.buttons["copy"].click()
    assert drive_names(session.full_design) == ("Feed", "Clamp", "Clamp 2", "Lift", "Torque")
    assert session.chosen == 2
    assert view.focus_field("drives[2].phase_deg")
    unit.type("200")
    unit.press(Qt.Key.Key_Return)
    assert session.full_design.drives[2].phase_deg == 200.0
    assert column(view, PHASE)[2] == "200°"
    view.table.setFocus()
    unit.press(Qt.Key.Key_Down, modifier=ALT)
    assert drive_names(session.full_design) == ("Feed", "Clamp", "Lift", "Clamp 2", "Torque")
    assert session.chosen == 3

    view.table.setCurrentCell(3, NAME)
    view.table.setFocus()
    unit.press(Qt.Key.Key_F2)
    editor = view.table.findChild(QLineEdit)
    assert editor is not None
    editor.selectAll()
    QTest.keyClicks(editor, "Gripper")
    QTest.keyClick(editor, Qt.Key.Key_Return)
    settle()
    assert drive_names(session.full_design)[3] == "Gripper"
    assert unit.design.name == "Gripper"

    session.edit("drives[3].name", "Lift", "Rename")
    assert drive_names(session.full_design)[3] == "Gripper", "two drives of one name are refused"
    view.table.setFocus()
    unit.press(Qt.Key.Key_Delete)
    assert drive_names(session.full_design) == ("Feed", "Clamp", "Lift", "Torque")
    assert unit.steps == [
        "Duplicate Clamp",
        "Change phase to 200°",
        "Move Clamp 2 down",
        "Rename Clamp 2 to Gripper",
        "Remove Gripper",
    ]
    for _ in unit.steps:
        session.stack.undo()
    settle()
    assert session.full_design == load(UNIT)
    assert not session.modified
    assert column(view, NAME) == ["Feed", "Clamp", "Lift", "Torque"]


def test_copies_are_numbered_on(unit: User) -> None:
    """A copy of a copy is the next one, never ``Clamp 2 2``; the undo list calls it what the button does."""
    for row in (1, 2, 1):
        click_row(unit, row)
        listed(unit).buttons["copy"].click()
        settle()
    assert drive_names(unit.session.full_design) == ("Feed", "Clamp", "Clamp 4", "Clamp 2", "Clamp 3", "Lift", "Torque")
    assert unit.steps == ["Duplicate Clamp", "Duplicate Clamp 2", "Duplicate Clamp"]


@pytest.mark.parametrize("deed", spread(["copy", "remove"], 1))
def test_what_was_before_is_never_another_drive(unit: User, deed: str) -> None:
    """Neither is it pinned in place of the drive that has come to hand, nor drawn dashed behind its motion."""
    click_row(unit, 0)
    listed(unit).buttons[deed].click()
    settle()
    assert unit.session.before is None
    unit.choose("Edit", "Compare with the last step")
    assert unit.window.status.currentMessage() == "The design has not been changed yet"


def test_torques_that_wait_for_a_pause_are_not_of_the_design_before(unit: User) -> None:
    view = listed(unit)
    menu = view.buttons["add"].menu()
    menu.aboutToShow.emit()
    next(action for action in menu.actions() if action.text() == "Balance cam").trigger()
    settle()
    unit.session.stack.setClean()
    assert unit.window.documents.open_path(example("card_picker"))
    end_pauses()
    assert view.in_trouble, "a design of one drive"
    assert unit.faults == []


def test_a_drive_that_cannot_be_assembled_takes_no_other_with_it(unit: User, tmp_path: Path) -> None:
    text = UNIT.read_text("utf-8").replace("slider_arm_mm = 1302.162", "slider_arm_mm = 300.0")
    (tmp_path / "broken.toml").write_text(text, "utf-8")
    assert unit.window.documents.open_path(tmp_path / "broken.toml")
    view = listed(unit)
    assert column(view, TORQUE)[2] == "not calculated"
    assert view.table.item(2, NAME).toolTip() != ""
    assert all(text.endswith("N·m") for n, text in enumerate(column(view, TORQUE)) if n != 2)
    assert not unit.drawing().in_trouble
    click_drive(unit, 2)
    assert unit.drawing().in_trouble
    click_drive(unit, 1)
    assert not unit.drawing().in_trouble


def test_all_drives_stand_at_one_machine_angle(unit: User) -> None:
    view, player = unit.drawing(), unit.window.player
    bar = view.strip.arrangement_bar
    for name in (SIDE_BY_SIDE, ON_SHAFT):
        button = bar.widgetForAction(view.strip.arrangements[name])
        assert isinstance(button, QToolButton)
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
        settle()
        assert view.all_canvas.isVisible()
        items = len(view.assembly.items())
        for machine in (0.0, 100.0, 290.0):
            player.set_machine(radians(machine))
            settle()
            for drive, figure in zip(unit.session.full_design.drives, view.assembly.figures.values(), strict=True):
                own = (machine - drive.phase_deg) % 360.0
                cam = next(part.item for part in figure.parts if part.key == "cam")
                seen = cam.mapToScene(1.0, 0.0) - cam.mapToScene(0.0, 0.0)
                angle = degrees(atan2(seen.y(), seen.x()))
                # all turn counter-clockwise as seen from this end; a mirrored one's zero stands on the other side
                wanted = 180.0 + own if drive.mirrored else own
                assert isclose(cos(radians(angle - wanted)), 1.0, abs_tol=1e-9), drive.name
        assert len(view.assembly.items()) == items, "items are moved, none is made"
        shafts = {figure.corner for figure in view.assembly.figures.values()}
        assert len(shafts) == (4 if name == SIDE_BY_SIDE else 1)
        if name == SIDE_BY_SIDE:
            figure = view.assembly.figures[3]
            QTest.mouseClick(
                view.all_canvas.viewport(), Qt.MouseButton.LeftButton, pos=pixel(view.all_canvas, figure.corner)
            )
            assert unit.session.chosen == 3
            assert unit.steps == []


def on_cam(view: MechanismView, number: int, angle: float) -> complex:
    """A place on a drive's cam, at this angle about its shaft [mm]."""
    figure = view.assembly.figures[number]
    return figure.corner + 0.3 * figure.geometry.base_radius * rect(1.0, radians(angle))


def direction(view: MechanismView, number: int) -> float:
    """Where the mark of the cam points, as it is seen [deg]."""
    figure = view.assembly.figures[number]
    own = rect(1.0, radians(figure.geometry.cam_rotation[figure.index]))
    return degrees(phase(-own.conjugate() if figure.mirrored else own))


@pytest.mark.parametrize("arrangement", spread([SIDE_BY_SIDE, ON_SHAFT], 1))
def test_the_cam_of_a_drive_is_turned_by_hand_among_the_others(unit: User, arrangement: str) -> None:
    view = unit.drawing()
    click_drive(unit, 1)
    QTest.mouseClick(
        view.strip.arrangement_bar.widgetForAction(view.strip.arrangements[arrangement]), Qt.MouseButton.LeftButton
    )
    settle()
    canvas, viewport, before = view.all_canvas, view.all_canvas.viewport(), unit.session.full_design
    timed = before
    unit.session.put_full_design(replace(timed, timing=()), "No timing")
    before, mark = unit.session.full_design, direction(view, 1)

    def turn(*angles: float) -> None:
        QTest.mousePress(viewport, Qt.MouseButton.LeftButton, pos=pixel(canvas, on_cam(view, 1, 20.0)))
        for angle in angles:
            QTest.mouseMove(viewport, pixel(canvas, on_cam(view, 1, angle)))
        settle()

    def let_go() -> None:
        QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, pos=QPoint(3, 3))
        settle()

    turn(30.0, 40.0, 50.0)
    assert (direction(view, 1) - mark + 180.0) % 360.0 - 180.0 == pytest.approx(30.0, abs=3.0), "it goes with the hand"
    turned = (unit.session.full_design.drives[1].phase_deg - before.drives[1].phase_deg + 180.0) % 360.0 - 180.0
    assert abs(turned) == pytest.approx(30.0, abs=3.0)
    (beside,) = (each for each in unit.window.findChildren(MouseReadout) if each.isVisible())
    assert f"Clamp phase {unit.session.full_design.drives[1].phase_deg:g}°" in beside.text()
    let_go()
    assert unit.session.full_design.drives[1].phase_deg != before.drives[1].phase_deg
    unit.session.stack.undo()
    assert unit.session.full_design == before, "one step"

    turn(60.0)
    assert unit.session.full_design != before
    unit.press(Qt.Key.Key_Escape)
    assert unit.session.full_design == before
    QTest.mouseMove(viewport, pixel(canvas, on_cam(view, 1, 90.0)))
    assert unit.session.full_design == before, "nothing is held"
    let_go()

    unit.session.put_full_design(timed, "Timing")
    room = phase_room(timed, 1)
    turn(60.0, 110.0, 160.0, 210.0, 260.0, 310.0, 350.0)
    moved = (unit.session.full_design.drives[1].phase_deg - timed.drives[1].phase_deg + 180.0) % 360.0 - 180.0
    assert moved == pytest.approx(room.low) or moved == pytest.approx(room.high), "as far as the timing lets it"
    assert "stops: " in beside.text()
    let_go()
    unit.session.put_full_design(before, "No timing")

    turn(60.0)
    QTest.keyClicks(canvas, "200.25")
    QTest.keyClick(canvas, Qt.Key.Key_Return)
    let_go()
    assert unit.session.full_design.drives[1].phase_deg == 200.25

    figure = view.assembly.figures[1]
    rim = figure.geometry.profile[7] * rect(1.0, radians(figure.geometry.cam_rotation[figure.index]))
    rim = figure.corner + (-rim.conjugate() if figure.mirrored else rim)
    QTest.mouseMove(viewport, pixel(canvas, rim))
    settle()
    assert view.assembly.overlay.reading.isVisible()
    assert view.assembly.overlay.reading_text.startswith("Clamp: "), "what lies under the mouse is read"
    QTest.mouseMove(viewport, QPoint(2, 2))
    assert not view.assembly.overlay.reading.isVisible()


def test_about_one_shaft_the_names_stand_in_a_row_and_on_no_cam(unit: User) -> None:
    view = unit.drawing()
    QTest.mouseClick(
        view.strip.arrangement_bar.widgetForAction(view.strip.arrangements[ON_SHAFT]), Qt.MouseButton.LeftButton
    )
    settle()
    canvas, figures = view.all_canvas, list(view.assembly.figures.values())

    def box(figure: DriveFigure) -> QRectF:
        return figure.tag.pixel_box().translated(canvas.viewportTransform().map(figure.tag.scenePos()))

    names = [box(figure) for figure in figures]
    cams = [part.item.sceneBoundingRect() for figure in figures for part in figure.parts if part.key == "cam"]
    lowest = max(canvas.viewportTransform().mapRect(cam).bottom() for cam in cams)
    assert all(name.top() >= lowest - 1.0 for name in names)
    assert all(left.right() < right.left() for left, right in pairwise(names))
    assert all(QRectF(canvas.viewport().rect()).contains(name) for name in names)


def test_an_animation_of_all_drives(app: object) -> None:
    film = Film(".gif", frames=2, width=240, height=160)
    moving = shoot(load(UNIT), film)
    assert moving is not None
    assert moving[:6] == b"GIF89a"
    assert moving != shoot(only(load(UNIT), 0), film)


def test_designs_come_together_on_a_shaft(unit: User, monkeypatch: pytest.MonkeyPatch) -> None:
    session, view = unit.session, listed(unit)
    unit.picks("design_to_open", example("card_picker"))
    unit.choose("File", "Add this design to a shaft...")
    assert len(session.full_design.drives) == 5
    assert session.full_design.drives[4].mechanism == load(example("card_picker")).drive.mechanism
    assert session.chosen == 4
    session.stack.undo()
    assert session.full_design == load(UNIT)

    menu = view.buttons["add"].menu()
    menu.aboutToShow.emit()
    next(action for action in menu.actions() if action.text() == "Balance cam").trigger()
    settle()
    view.settle()
    assert column(view, NAME)[4] == "Balance cam"
    assert session.is_on_balancer
    assert not session.choose_drive(5), "of a list that is not up to date"
    left = session.shaft.torque
    assert left.max() - left.min() < 1e-9 * (session.shaft.cams_torque.max() - session.shaft.cams_torque.min())
    assert not unit.drawing().in_trouble
    unit.see("displacement")
    form = unit.motion().curve
    assert not form.fields
    assert "follows from the torque" in form.findChild(QLabel).text()
    assert not session.edit("cam.base_radius_mm", 300.0, "Change"), "it follows from the drives"
    assert not session.edit("motion.segments[0].span_deg", 100.0, "Change"), "nor is a motion begun that is not whole"
    assert session.incomplete is None
    assert session.edit("balancer.base_radius_mm", 300.0, "Change base radius to 300 mm")
    assert session.design.drive.cam.base_radius_mm == 300.0
    view.buttons["remove"].click()
    assert session.full_design == load(UNIT)

    assert unit.window.documents.open_path(example("card_picker"))
    single = session.full_design
    monkeypatch.setattr(dialogs, "ask_on_shaft", lambda *_: OnShaft.NEW)
    unit.choose("File", "Add this design to a shaft...")
    assert session.has_several_drives
    assert drive_names(session.full_design) == (single.name,)
    assert unit.drawing().strip.isVisible()
    session.stack.undo()
    assert session.full_design == single
    settle()
    assert not unit.drawing().strip.isVisible()


@pytest.mark.stress
def test_a_plot_of_all_drives_lies_over_the_machine_angle(unit: User) -> None:
    view = unit.see("torque")
    assert isinstance(view, PlotView)
    view.all_drives.trigger()
    settle()
    shaft, lines = unit.session.shaft, view.drives_plot.lines
    assert len(lines) == 5
    x, total = lines[-1]
    drives = sum(np.interp(x, *line) for line in lines[:-1])
    assert np.abs(drives - total).max() < 1e-3 * np.abs(total).max(), "the last one is their sum"
    at = [np.interp(302.72, *line) for line in lines]
    assert max(range(4), key=lambda i: at[i]) == list(shaft.drives).index("Lift")
    unit.window.player.set_machine(radians(90.0))
    assert isclose(view.drives_plot.cursor_at, 90.0)

    made = replace(unit.session.full_design, waviness=Waviness(amplitude_mm=0.05, lobes_from=10, lobes_to=30))
    unit.session.put_full_design(made, "Waves")
    view.bands.set_shown(True)
    wait_for(lambda: all(line.band is not None for line in view.drives_plot.shown))
    for line in view.drives_plot.shown:
        assert line.band is not None
        angles, (low, _, middle, _, high) = line.band
        own, size = np.interp(angles, line.x, line.y), np.ptp(line.y)
        assert (angles[0], angles[-1]) == (0.0, 360.0)
        assert np.abs(middle - own).max() < 0.05 * size, "in their place on the shaft"
        assert (high - low).max() > 1e-4 * size
    click_drive(unit, 0)
    assert view.drives_plot.shown[2].band is not None, "another drive at hand changes nothing"
    view.bands.set_shown(False)
    view.all_drives.trigger()
    settle()
    assert view.plot.isVisible()


@pytest.mark.stress
def test_tables_of_the_shaft_and_the_profile_of_the_chosen_drive(
    unit: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    monkeypatch.setattr(export_dialogs, "ask_tables", lambda *_: TablesRequest(out, 72))
    unit.choose("File", "Export", "Tables...")
    wanted = as_texts(file_parts(Study(load(UNIT), 72)))
    assert {name: (out / name).read_text("utf-8") for name in wanted} == wanted
    assert unit.faults == []
    click_drive(unit, 2)
    asked: list[object] = []
    monkeypatch.setattr(profile_dialogs, "ask_profile", lambda _, design: asked.append(design))
    unit.choose("File", "Export", "Profile...")
    assert asked == [replace(only(load(UNIT), 2), name="Transfer unit, drive Lift")]
