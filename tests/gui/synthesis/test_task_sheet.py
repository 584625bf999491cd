"""The sheet of Compo > Find a linkage: lines, area, points, moving pivots; snapping, typed values, taking back, leaving."""

import time
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QContextMenuEvent, QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QMenu, QPushButton, QWidget
from window_user import Open, User, end_pauses, plain, settle, wait_for

from core.contour.underlay import Underlay
from core.numerics.lazy import checkpoint
from core.synthesis import Area, BodyPose, Pivot, Task, load_task, save_task
from kindyna_gui import settings
from kindyna_gui.synthesis.find_linkage_view import FindLinkageView

EXAMPLE = Path(__file__).parents[3] / "resources" / "examples" / "four_bar.toml"
TASKS = EXAMPLE.parents[1] / "tasks"
LEFT = Qt.MouseButton.LeftButton
NONE, CTRL = Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.ControlModifier
POSES = (BodyPose(0.0, 0.0, 0.0), BodyPose(60.0, 20.0, 30.0), BodyPose(110.0, 10.0, 60.0))


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window(EXAMPLE)


class Sheet:
    """The mouse and the keys on the sheet."""

    def __init__(self, user: User, task: Task) -> None:
        user.choose("Compo", "Find a linkage")
        view = user.window.view("find_linkage")
        assert isinstance(view, FindLinkageView)
        self.view = view
        view.show_task(task)
        view.sheet.choose_tool("pose" if task.kind == "poses" else "stroke")
        assert view.sheet.canvas is not None
        self.canvas = view.sheet.canvas
        wait_for(lambda: not view.busy)
        self.canvas.show_region(QPointF(40.0, 0.0), 2.0)  # the grid has cells of 10 mm
        settle()

    @property
    def viewport(self) -> QWidget:
        return self.canvas.viewport()

    @property
    def task(self) -> Task:
        return self.view.task

    def tool(self, name: str) -> None:
        QTest.mouseClick(self.view.sheet.bar.buttons[name], LEFT)

    def pixel(self, z: complex) -> QPoint:
        return self.view.sheet.pixel(z).toPoint()

    def drag(self, *places: complex, modifier: Qt.KeyboardModifier = NONE, release: bool = True) -> None:
        pixels = [self.pixel(z) for z in places]
        QTest.mousePress(self.viewport, LEFT, modifier, pixels[0])
        for at in pixels[1:]:
            move(self.viewport, at, modifier)
        if release:
            QTest.mouseRelease(self.viewport, LEFT, modifier, pixels[-1])
        settle()

    def click(self, z: complex) -> None:
        QTest.mouseClick(self.viewport, LEFT, NONE, self.pixel(z))
        settle()

    def key(self, key: Qt.Key) -> None:
        QTest.keyClick(self.canvas, key)
        settle()

    def type(self, *texts: str) -> None:
        """Numbers from the first digit on, in the boxes that it opens."""
        QTest.keyClicks(self.canvas, texts[0][0])
        for i, text in enumerate(texts):
            box = QApplication.focusWidget()
            assert isinstance(box, QLineEdit)
            QTest.keyClicks(box, text[1:] if not i else text)
            QTest.keyClick(box, Qt.Key.Key_Tab if i < len(texts) - 1 else Qt.Key.Key_Return)
        settle()

    def menu(self, z: complex) -> QMenu:
        at = self.pixel(z)
        event = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, at, self.viewport.mapToGlobal(at))
        QApplication.sendEvent(self.viewport, event)
        settle()
        menu = QApplication.activePopupWidget()
        assert isinstance(menu, QMenu)
        return menu

    def choose(self, z: complex, entry: str) -> None:
        menu = self.menu(z)
        next(action for action in menu.actions() if plain(action.text()) == entry).trigger()
        menu.close()
        settle()

    def answered(self) -> None:
        wait_for(self.view.strip.put_button.isEnabled)


def move(viewport: QWidget, at: QPoint, modifier: Qt.KeyboardModifier) -> None:
    place = QPointF(at)
    event = QMouseEvent(QEvent.Type.MouseMove, place, viewport.mapToGlobal(place), LEFT, LEFT, modifier)
    QApplication.sendEvent(viewport, event)


def poses_task(*pivots: Pivot, area: Area | None = None) -> Task:
    return Task(kind="poses", poses=POSES, pivots=pivots, area=area)


# -- lines and area --------------------------------------------------------------------------------------


def test_a_line_is_dragged_turned_and_holds_the_pivot(user: User) -> None:
    sheet = Sheet(user, poses_task())
    sheet.tool("line")
    sheet.drag(-40.0 - 60.0j, 0.0 - 60.0j, 40.0 - 60.0j)
    (pivot,) = sheet.task.pivots
    assert pivot.line == (-40.0, -60.0, 0.0)
    assert [box.number for box in sheet.view.form.pivots[0].all_boxes] == [-40.0, -60.0, 0.0]
    arm = 42.0 / sheet.canvas.scale_now
    sheet.drag(-40.0 + arm - 60.0j, -40.0 + 30.0 - 30.0j)
    assert sheet.task.pivots[0].line == (-40.0, -60.0, 45.0)
    sheet.answered()
    answer = sheet.view.strip.answer
    assert answer is not None
    fixed = answer.candidate.linkage.by_number[1].places.values()
    distances = [abs(((z + 40.0 + 60.0j) * np.exp(-0.25j * np.pi)).imag) for z in fixed]
    assert min(distances) < 1e-6


def test_an_area_is_dragged_moved_and_resized_and_holds_the_fixed_pivots(user: User) -> None:
    sheet = Sheet(user, poses_task())
    sheet.tool("area")
    sheet.drag(100.0 + 60.0j, 0.0 + 0.0j, -20.0 - 60.0j)  # from the upper right corner to the lower left one
    assert sheet.task.area == Area(-20.0, -60.0, 100.0, 60.0)
    sheet.drag(100.0 + 60.0j, 120.0 + 80.0j)
    assert sheet.task.area == Area(-20.0, -60.0, 120.0, 80.0)
    sheet.drag(50.0 - 60.0j, 60.0 - 80.0j)
    assert sheet.task.area == Area(-10.0, -80.0, 130.0, 60.0)
    assert [box.number for box in sheet.view.form.area] == [-10.0, -80.0, 130.0, 60.0]
    sheet.answered()
    for answer in sheet.view.strip.proposals.answers:  # type: ignore[union-attr]
        places = answer.candidate.linkage.by_number[1].places
        pins = [places[name] for name in ("O2", "O4") if name in places]
        assert all(-10.0 <= z.real <= 130.0 and -80.0 <= z.imag <= 60.0 for z in pins)
    sheet.click(50.0 + 60.0j)
    sheet.key(Qt.Key.Key_Delete)
    assert sheet.task.area is None


def test_lines_area_and_moving_pivots_of_a_file_are_shown_and_edited(user: User, tmp_path: Path) -> None:
    task = poses_task(
        Pivot(dyad=1, of="fixed", line=(0.0, -60.0, 90.0)),
        Pivot(dyad=2, of="moving", x_mm=10.0, y_mm=20.0),
        area=Area(-60.0, -100.0, 120.0, 60.0),
    )
    save_task(task, tmp_path / "task.toml")
    sheet = Sheet(user, load_task(tmp_path / "task.toml"))
    assert sheet.task.pivots == task.pivots
    assert sheet.task.area == task.area
    row = sheet.view.form.pivots[1]
    assert (row.of.currentText(), row.dyad.currentText()) == ("moving", "dyad 2")
    sheet.drag(10.0 + 20.0j, 10.0 + 40.0j)  # drawn at the first pose
    assert sheet.task.pivots[1] == Pivot(dyad=2, of="moving", x_mm=10.0, y_mm=40.0)
    box = row.direction
    box.setFocus()
    QTest.keyClicks(box, "90")
    QTest.keyClick(box, Qt.Key.Key_Return)
    assert sheet.task.pivots[1] == Pivot(dyad=2, of="moving", line=(10.0, 40.0, 90.0))
    save_task(sheet.task, tmp_path / "again.toml")
    assert load_task(tmp_path / "again.toml").pivots == sheet.task.pivots


def test_the_menu_of_a_pivot_makes_it_a_moving_one_at_the_same_position(user: User) -> None:
    poses = (BodyPose(10.0, 20.0, 90.0), *POSES[1:])
    sheet = Sheet(user, Task(kind="poses", poses=poses, pivots=(Pivot(dyad=1, of="fixed", x_mm=40.0, y_mm=-40.0),)))
    sheet.choose(40.0 - 40.0j, "Moving pivot, on the body")
    (pivot,) = sheet.task.pivots
    assert (pivot.of, pivot.x_mm, pivot.y_mm) == ("moving", pytest.approx(-60.0), pytest.approx(-30.0))
    sheet.choose(40.0 - 40.0j, "For both dyads")
    assert sheet.task.pivots[0].dyad is None
    sheet.choose(40.0 - 40.0j, "Remove")
    assert not sheet.task.pivots


def test_the_line_of_a_moving_pivot_is_turned_on_the_sheet_and_given_on_the_body(user: User) -> None:
    poses = (BodyPose(10.0, 20.0, 90.0), *POSES[1:])
    sheet = Sheet(user, Task(kind="poses", poses=poses, pivots=(Pivot(dyad=1, of="fixed", line=(40.0, -40.0, 30.0)),)))
    sheet.choose(40.0 - 40.0j, "Moving pivot, on the body")
    (pivot,) = sheet.task.pivots
    assert (pivot.of, pivot.line) == ("moving", pytest.approx((-60.0, -30.0, -60.0)))
    arm = 42.0 / sheet.canvas.scale_now
    sheet.drag(40.0 - 40.0j + arm * np.exp(1j * np.pi / 6.0), 40.0 - 10.0j)
    assert sheet.task.pivots[0].line == pytest.approx((-60.0, -30.0, 0.0))


# -- a path by points ------------------------------------------------------------------------------------


def test_a_path_is_clicked_point_by_point(user: User) -> None:
    sheet = Sheet(user, Task(kind="path"))
    sheet.tool("points")
    for z in (0.0, 60.0, 60.0 + 40.0j, 90.0 + 90.0j):
        sheet.click(z)
    sheet.key(Qt.Key.Key_Backspace)
    sheet.click(0.0 + 40.0j)
    sheet.key(Qt.Key.Key_Return)
    path = sheet.task.path
    assert path is not None
    assert [(p.x_mm, p.y_mm) for p in path.points] == [(0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (0.0, 40.0)]
    assert not path.closed
    sheet.drag(60.0 + 40.0j, 70.0 + 50.0j)
    path = sheet.task.path
    assert path is not None
    assert (path.points[2].x_mm, path.points[2].y_mm) == (70.0, 50.0)


def test_a_click_on_the_first_point_closes_the_path(user: User) -> None:
    sheet = Sheet(user, Task(kind="path"))
    sheet.tool("points")
    for z in (0.0, 60.0, 60.0 + 40.0j, 0.0):
        sheet.click(z)
    path = sheet.task.path
    assert path is not None
    assert len(path.points) == 3
    assert path.closed
    assert sheet.view.form.closed.isChecked()


def test_points_are_clicked_without_a_fault_and_without_moving_the_drawing(user: User) -> None:
    sheet = Sheet(user, Task(kind="path"))
    sheet.tool("points")
    height = sheet.canvas.height()
    for z in (0.0, 60.0):
        sheet.click(z)
        end_pauses()
        assert not sheet.view.form.message.text()
        assert not sheet.view.busy
        assert sheet.canvas.height() == height
    sheet.key(Qt.Key.Key_Return)
    wait_for(lambda: "2 points" in sheet.view.form.message.text())
    assert sheet.canvas.height() == height


def test_the_path_of_a_point_of_the_mechanism_becomes_the_task(user: User) -> None:
    sheet = Sheet(user, Task(kind="path"))
    menu = sheet.view.form.point_button.menu()
    assert isinstance(menu, QMenu)
    assert [plain(action.text()) for action in menu.actions()] == ["A", "B", "C"]
    menu.actions()[0].trigger()
    path = sheet.task.path
    assert path is not None
    assert path.closed
    assert [abs(complex(p.x_mm, p.y_mm)) for p in path.points] == pytest.approx(len(path.points) * [30.0], rel=1e-3)


def test_a_ready_task_is_opened_and_seen_in_full(user: User) -> None:
    sheet = Sheet(user, poses_task())
    button = next(b for b in sheet.view.findChildren(QPushButton) if plain(b.text()) == "Ready tasks")
    menu = button.menu()
    assert isinstance(menu, QMenu)
    names = [plain(action.text()) for action in menu.actions()]
    assert names == ["Arc dwell", "Chebyshev line", "Hoeken line", "Quick return", "Roberts line", "Watt line"]
    menu.actions()[3].trigger()
    assert sheet.task == load_task(TASKS / "quick_return.toml")
    sheet.answered()
    answer = sheet.view.strip.answer
    assert answer is not None
    positions = sheet.view.strip.proposals.positions[0]  # type: ignore[union-attr]
    assert all(sheet.viewport.rect().contains(sheet.pixel(z)) for path in positions.values() for z in path.tolist())


# -- snapping, typing, taking back -----------------------------------------------------------------------


def test_the_mouse_snaps_to_a_joint_of_the_mechanism_and_ctrl_leaves_it(user: User) -> None:
    sheet = Sheet(user, poses_task())
    joint = sheet.view.sheet.marks()["B"]
    assert joint == pytest.approx(87.86 + 68.94j, abs=0.01)
    near = joint + (3.0 + 2.0j) / sheet.canvas.scale_now
    sheet.drag(60.0 + 20.0j, near)
    assert sheet.task.poses[1].z == pytest.approx(joint, abs=1e-6)
    sheet.drag(joint, joint + 5.0, near, modifier=CTRL)
    assert 1.0 < abs(sheet.task.poses[1].z - joint) * sheet.canvas.scale_now < 6.0


def test_the_sheet_is_over_the_underlay_and_snaps_to_its_corners(user: User, tmp_path: Path) -> None:
    sheet = Sheet(user, poses_task())
    bare = sheet.canvas.grab().toImage()
    drawing = ezdxf.new(units=4)
    drawing.modelspace().add_line((33.3, 44.4), (83.3, 44.4))
    drawing.saveas(tmp_path / "corner.dxf")
    desk = user.drawing().underlay
    desk.put(Underlay(tmp_path / "corner.dxf", opacity=1.0), save=False)
    settle()
    at = sheet.pixel(70.0 + 44.4j)
    sheet.view.strip.run(False)
    shown = sheet.canvas.grab().toImage()
    assert any(shown.pixelColor(at.x(), at.y() + k) != bare.pixelColor(at.x(), at.y() + k) for k in (-1, 0, 1))
    sheet.drag(60.0 + 20.0j, 34.0 + 45.0j)
    assert sheet.task.poses[1].z == 33.3 + 44.4j
    desk.put(None, save=False)


def test_values_are_typed_during_a_drag_and_for_a_new_pose(user: User) -> None:
    sheet = Sheet(user, poses_task())
    sheet.drag(60.0 + 20.0j, 70.0 + 30.0j, release=False)
    sheet.type("61.5", "22", "33.25")
    assert sheet.task.poses[1] == BodyPose(61.5, 22.0, 33.25)
    sheet.key(Qt.Key.Key_Escape)  # nothing is selected any more
    sheet.type("150", "-12.5", "80")
    assert sheet.task.poses[3] == BodyPose(150.0, -12.5, 80.0)


def test_escape_takes_a_drag_back_then_leaves_the_sheet(user: User) -> None:
    sheet = Sheet(user, poses_task())
    sheet.drag(60.0 + 20.0j, 80.0 + 50.0j, release=False)
    assert sheet.task.poses[1].z == 80.0 + 50.0j
    sheet.key(Qt.Key.Key_Escape)
    QTest.mouseRelease(sheet.viewport, LEFT)
    assert sheet.task.poses == POSES
    assert sheet.view.isVisible()
    sheet.key(Qt.Key.Key_Escape)
    sheet.key(Qt.Key.Key_Escape)
    assert user.window.docks["find_linkage"].isHidden()
    assert not sheet.view.sheet.bar.isVisible()


def test_undo_restores_the_task_and_leaves_the_design(user: User) -> None:
    assert user.session.edit("linkage.links[0].points.O4.x_mm", 101.0, "Move O4")
    sheet = Sheet(user, poses_task())
    design = user.design
    sheet.drag(60.0 + 20.0j, 80.0 + 50.0j)
    sheet.tool("area")
    sheet.click(-30.0 - 60.0j)  # without a drag it is none
    assert sheet.task.area is None
    sheet.drag(-30.0 - 60.0j, 120.0 + 70.0j)
    QTest.keyClick(sheet.canvas, Qt.Key.Key_Z, CTRL)
    assert sheet.task.area is None
    assert sheet.task.poses[1].z == 80.0 + 50.0j
    QTest.keyClick(sheet.canvas, Qt.Key.Key_Z, CTRL)
    assert sheet.task.poses == POSES
    assert user.design == design


def test_drawing_links_leaves_the_sheet_and_the_task_stays(user: User) -> None:
    sheet = Sheet(user, poses_task(area=Area(-200.0, -300.0, 300.0, 200.0)))
    user.choose("Compo", "Draw")
    assert user.window.docks["find_linkage"].isHidden()
    assert not sheet.view.strip.isVisible()
    user.choose("Compo", "Draw")
    user.choose("Compo", "Find a linkage")
    assert sheet.view.strip.isVisible()
    assert sheet.task.area == Area(-200.0, -300.0, 300.0, 200.0)


def test_a_design_that_is_a_motion_alone_has_a_sheet_too(open_user: Open) -> None:
    user = open_user(EXAMPLE.with_name("barrel_feeder.toml"))
    sheet = Sheet(user, poses_task())
    sheet.answered()
    sheet.drag(60.0 + 20.0j, 80.0 + 50.0j)
    assert sheet.task.poses[1].z == 80.0 + 50.0j


def test_values_and_cards_are_in_the_preferred_unit(user: User) -> None:
    sheet = Sheet(user, poses_task())
    sheet.answered()
    try:
        settings.choose(settings.INCH, False)
        settle()
        assert sheet.view.form.poses[1][0].text() == "2.3622"
        assert " in" in sheet.view.strip.board.list.item(0).text()
        sheet.click(60.0 + 20.0j)
        sheet.type("2", "1", "30")
        assert sheet.task.poses[1] == BodyPose(50.8, 25.4, 30.0)
    finally:
        settings.choose({}, False)


def test_another_design_and_the_dock_opened_again_show_the_full_task(user: User) -> None:
    far = tuple(BodyPose(1000.0 + pose.x_mm, pose.y_mm, pose.angle_deg) for pose in POSES)
    sheet = Sheet(user, Task(kind="poses", poses=far))

    def sees_all() -> bool:
        return all(sheet.viewport.rect().contains(sheet.pixel(pose.z)) for pose in far)

    assert not sees_all()
    user.session.open(EXAMPLE.with_name("transfer_lift.toml"))
    settle()
    assert sees_all()
    sheet.canvas.show_region(QPointF(40.0, 0.0), 2.0)
    user.window.docks["find_linkage"].close()
    settle()
    user.choose("Compo", "Find a linkage")
    assert sees_all()


# -- errors and the search -------------------------------------------------------------------------------


def test_a_fault_is_shown_at_its_field(user: User) -> None:
    sheet = Sheet(
        user,
        poses_task(Pivot(dyad=1, of="fixed", x_mm=0.0, y_mm=-50.0), Pivot(dyad=1, of="moving", x_mm=0.0, y_mm=5.0)),
    )
    wait_for(lambda: bool(sheet.view.form.message.text()))
    assert "3 poses leave 2" in sheet.view.form.message.text()
    first, second = sheet.view.form.pivots
    assert all(box.is_refused for box in second.all_boxes)
    assert not any(box.is_refused for box in first.all_boxes)
    sheet.choose(0.0 + 5.0j, "For dyad 2")
    sheet.answered()
    assert not sheet.view.form.message.text()
    assert not any(box.is_refused for box in second.all_boxes)


def test_cards_follow_while_a_pose_is_dragged(user: User) -> None:
    sheet = Sheet(user, poses_task())
    strip = sheet.view.strip
    for z in (70.0 + 30.0j, 80.0 + 20.0j, 70.0 + 10.0j):
        before = strip.proposals
        if z.real == 70.0 and z.imag == 30.0:
            sheet.drag(60.0 + 20.0j, z, release=False)
        else:
            move(sheet.viewport, sheet.pixel(z), NONE)
        wait_for(lambda before=before: strip.proposals is not before)  # type: ignore[misc]
        assert strip.proposals is not None
        assert strip.proposals.task.poses[1].z == z
    QTest.mouseRelease(sheet.viewport, LEFT)
    sheet.answered()


def test_a_long_search_greys_the_cards_and_can_be_stopped(user: User, monkeypatch: pytest.MonkeyPatch) -> None:
    sheet = Sheet(user, poses_task())
    sheet.answered()
    strip, count = sheet.view.strip, sheet.view.strip.board.list.count()

    def endless(_: Task) -> None:
        while True:
            checkpoint()
            time.sleep(0.002)

    monkeypatch.setattr("kindyna_gui.synthesis.find_linkage_view.propose", endless)
    sheet.drag(60.0 + 20.0j, 70.0 + 30.0j)
    wait_for(strip.stop.isVisible)
    assert strip.board.list.count() == count
    assert not strip.board.list.isEnabled()
    assert not strip.put_button.isEnabled()
    QTest.mouseClick(strip.stop, LEFT)
    wait_for(strip.stop.isHidden)
    assert strip.board.list.isEnabled()
    assert "earlier task" in strip.summary.text()
    assert not sheet.view.busy


def test_cards_move_under_the_mouse_are_sorted_and_compared(user: User) -> None:
    sheet = Sheet(user, poses_task())
    sheet.answered()
    board = sheet.view.strip.board
    cards = board.list
    before = cards.item(1).icon().pixmap(112, 72).toImage()
    QTest.mouseMove(cards.viewport(), cards.visualItemRect(cards.item(1)).center())
    wait_for(lambda: cards.item(1).icon().pixmap(112, 72).toImage() != before)
    QTest.mouseClick(cards.viewport(), LEFT, pos=cards.visualItemRect(cards.item(1)).center())
    chosen = sheet.view.strip.answer
    assert chosen is not None
    board.sort.setCurrentIndex(board.sort.findText("by size"))
    board.sort.activated.emit(board.sort.currentIndex())
    assert sheet.view.strip.answer is chosen
    sizes = [board.cards[cards.item(i).data(Qt.ItemDataRole.UserRole)].values["size"][0] for i in range(cards.count())]
    assert sizes == sorted(sizes)
    QTest.mouseClick(board.compare, LEFT)
    headings = [board.table.horizontalHeaderItem(i).text() for i in range(board.table.columnCount())]
    assert headings == ["kind", "error", "transmission angle", "longest to shortest link", "size"]
    assert board.table.isRowHidden(0)
    assert board.table.item(1, 4).text().endswith(" mm")
    QTest.mouseClick(board.compare, LEFT)
    board.sort.setCurrentIndex(0)
    board.sort.activated.emit(0)


def test_undo_while_the_mouse_drags_a_new_pose_lets_go_of_it(user: User) -> None:
    sheet = Sheet(user, Task(kind="poses", poses=POSES[:2]))
    sheet.drag(30 - 40j, 60 - 40j)
    sheet.drag(-30 + 20j, -10 + 30j, release=False)
    assert len(sheet.task.poses) == 4
    QTest.keyClick(sheet.canvas, Qt.Key.Key_Z, CTRL)
    settle()
    left = len(sheet.task.poses)
    assert left < 4
    assert not sheet.view.sheet.is_dragging
    move(sheet.viewport, sheet.pixel(20 + 40j), NONE)
    QTest.mouseRelease(sheet.viewport, LEFT, NONE, sheet.pixel(20 + 40j))
    settle()
    assert len(sheet.task.poses) == left
