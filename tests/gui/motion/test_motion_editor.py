"""kindyna_gui.motion.segments_view with motion_editor, motion_bar: the motion is drawn, cut, doubled and mirrored by hand."""

from collections.abc import Callable
from math import degrees
from typing import Any

import numpy as np
import pyqtgraph as pg
import pytest
from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QToolBar, QWidget
from sampled import spread
from window_user import Open, User, plain, settle, wait_for

from core.design import Design, Motion, NamedCurve, Segment, edited, with_drive
from core.output.drawing.turn import spans as spans_of
from core.project import load
from core.study import Study
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.motion.diagram import LEVEL, LINE, POINT, join_marks, mark_spaces, mark_variants, segment_labels
from kindyna_gui.motion.editor import MotionEditor
from kindyna_gui.motion.segments_table import LAW, RISE, SPAN, TO
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.places import example

LIFT = load(example("transfer_lift"))
NONE, SHIFT, CTRL, ALT = (
    Qt.KeyboardModifier.NoModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.AltModifier,
)


@pytest.fixture
def user(same_window: Open) -> User:
    """Without plots, for which no test here has eyes, and without its mechanism's limits of reach."""
    made = same_window()
    made.session.stages_on_screen = tuple
    return made


def diagram(user: User) -> MotionEditor:
    return user.motion().diagram


def spans(user: User) -> list[float]:
    return [s.span_deg for s in user.design.drive.motion.segments]


def rises(user: User) -> list[float]:
    return [s.rise for s in user.design.drive.motion.segments]


def laws(user: User) -> list[str]:
    return [s.curve.law for s in user.design.drive.motion.segments]


class Hand:
    """The left button held down somewhere in the diagram."""

    def __init__(self, user: User, at: QPointF, keys: Qt.KeyboardModifier = NONE) -> None:
        self._paper, self._at, self._keys = diagram(user), at, keys
        QTest.mousePress(self._paper.viewport(), Qt.MouseButton.LeftButton, keys, at.toPoint())

    def move(self, x: float, y: float) -> None:
        """Draw on by so many degrees and units of level."""
        scale = self._paper.scale_now()
        self.move_pixels(x * scale.degree, -y * scale.unit)

    def move_pixels(self, dx: float, dy: float) -> None:
        self._at = self._at + QPointF(dx, dy)
        paper = self._paper.viewport()
        buttons = Qt.MouseButton.NoButton, Qt.MouseButton.LeftButton
        event = QMouseEvent(QEvent.Type.MouseMove, self._at, paper.mapToGlobal(self._at), *buttons, self._keys)
        QApplication.sendEvent(paper, event)
        settle()

    def release(self) -> None:
        QTest.mouseRelease(self._paper.viewport(), Qt.MouseButton.LeftButton, NONE, self._at.toPoint())
        settle()


def take(user: User, join: int, keys: Qt.KeyboardModifier = NONE) -> Hand:
    """Take hold of the point of a join."""
    return Hand(user, diagram(user).position_of_join(join), keys)


def take_line(user: User, angle: float, level: float = 75.0, keys: Qt.KeyboardModifier = NONE) -> Hand:
    """Take hold of what is at a cam angle and a level."""
    return Hand(user, diagram(user).position_of(angle, level), keys)


def shown_before(user: User) -> bool:
    """The motion before the last edit is to be seen."""
    return line(user, dashed=True).isVisible()


def line(user: User, dashed: bool = False) -> pg.PlotCurveItem:
    """The displacement that is drawn; dashed: that before the last edit."""
    lines = [item for item in diagram(user).items() if isinstance(item, pg.PlotCurveItem)]
    (found,) = (item for item in lines if bool(item.opts["pen"].dashPattern()) == dashed)
    return found


# -- what is shown ----------------------------------------------------------------------------------------


def test_diagram_and_table_stand_together(user: User) -> None:
    """The diagram above the table; where that is wide the form of the segment stands beside it, and the table takes its rows alone."""
    view = user.motion()
    assert view.diagram.isVisible()
    assert view.table.isVisible()
    user.window.docks["motion"].setFloating(True)
    user.window.docks["motion"].resize(384, 420)
    wait_for(lambda: view.diagram.mapToGlobal(QPoint(0, 0)).y() < view.table.mapToGlobal(QPoint(0, 0)).y())
    settle()
    assert view.table.horizontalScrollBar().maximum() == view.table.verticalScrollBar().maximum() == 0
    user.window.docks["motion"].resize(1000, 420)
    wait_for(lambda: view.bar.mapToGlobal(QPoint(0, 0)).x() > view.table.mapToGlobal(QPoint(0, 0)).x() + 300)
    wait_for(lambda: view.diagram.width() > 950)
    rows = view.model.rowCount() * view.table.verticalHeader().defaultSectionSize()
    wait_for(lambda: rows <= view.table.viewport().height() < rows + view.table.rowHeight(0))


def test_segments_are_numbered_and_named_where_there_is_room() -> None:
    rows = spans_of(LIFT.drive.motion)
    assert [text for _, text in segment_labels(rows, 900.0)] == [
        "1  Dwell",
        "2  Modified sine",
        "3  Dwell",
        "4  Modified sine",
        "5  Dwell",
    ]
    assert [text for _, text in segment_labels(rows, 300.0)] == ["1", "2", "3  Dwell", "4", "5"]


def test_the_diagram_shows_the_displacement(user: User) -> None:
    angles, values = line(user).getData()
    study = user.session.study
    assert angles[-1] == 360.0
    assert values[:-1] == pytest.approx(study.motion.y[0] * 1e3, abs=1e-12)
    assert not shown_before(user)


def test_marks_are_green_where_all_is_smooth_and_red_where_it_is_not() -> None:
    """s v a j at each join; a jump of jerk is usual and stays quiet."""
    design = edited(LIFT, "motion.segments[1].law", "constant-velocity")
    joins, motion = Study(design).program.joins, design.drive.motion
    assert [mark.colour for mark in join_marks(joins[0], motion)] == [LIGHT.good, LIGHT.limit, LIGHT.good, LIGHT.good]
    assert [mark.size_with_unit for mark in join_marks(joins[0], motion)] == ["", "207.1 mm/rad", "", ""]
    assert [mark.colour for mark in join_marks(joins[2], motion)] == [LIGHT.good, LIGHT.good, LIGHT.good, LIGHT.quiet]
    assert [mark.symbol for mark in join_marks(joins[4], motion)] == list("svaj")
    told = [
        "".join(text for text, _ in words).replace("\u00a0", " ")
        for words in mark_variants(join_marks(joins[0], motion))
    ]
    assert told == ["sΔv 207.1 mm/radaj", "sΔv 207.1 mm/radaj", "sΔv 207.1aj", "sΔv 207.1aj", "sΔvaj"]


def test_marks_that_face_each_other_share_the_segment() -> None:
    assert mark_spaces([0.0, 90.0, 180.0, 360.0]) == [(False, 90.0), (False, 90.0), (True, 90.0)]
    assert mark_spaces([0.0, 200.0, 210.0, 360.0]) == [(True, 200.0), (False, 75.0), (True, 75.0)]
    assert mark_spaces([0.0, 360.0]) == [(True, 360.0)]


def test_tips_say_what_is_there_and_what_can_be_done(user: User) -> None:
    paper = diagram(user)
    tip = paper.tip(paper.position_of_join(2))
    assert tip.startswith("Segment 2 ends, segment 3 begins\nContinuous in displacement, velocity, acceleration\n")
    assert "Drag a point to change its angle and level" in tip
    assert paper.tip(paper.position_of(180.0, 0.0)).startswith("Level of the dwell, segment 3\n")
    assert paper.tip(paper.position_of(60.0, 100.0)).startswith("Segment 2: Modified sine\n")


def test_the_mouse_shows_what_can_be_drawn(user: User) -> None:
    paper = diagram(user)
    for place, kind, shape in (
        (paper.position_of_join(2), POINT, Qt.CursorShape.SizeAllCursor),
        (paper.position_of(76.5, 75.0), LINE, Qt.CursorShape.SizeHorCursor),
        (paper.position_of(180.0, 0.0), LEVEL, Qt.CursorShape.SizeVerCursor),
        (paper.position_of(180.0, 75.0), None, Qt.CursorShape.ArrowCursor),
    ):
        QTest.mouseMove(paper.viewport(), place.toPoint())
        settle()
        assert (paper.hovered.kind if paper.hovered is not None else None) == kind
        assert paper.viewport().cursor().shape() == shape


# -- drawing ----------------------------------------------------------------------------------------------


def test_a_boundary_is_drawn_and_everything_follows(user: User) -> None:
    hand = take_line(user, 76.5)
    hand.move(20.0, 60.0)
    assert spans(user) == [35.0, 61.5, 187.0, 41.5, 35.0]  # while the button is still down
    assert rises(user) == rises_of_lift()
    wait_for(lambda: user.cell(1, SPAN) == "61.5")  # the view is drawn once in a frame
    assert user.cell(1, TO) == "96.5"
    assert diagram(user).label is not None
    assert diagram(user).label.text == "96.5°  0 mm"
    hand.move(-10.0, 0.0)
    hand.release()
    assert spans(user) == [35.0, 51.5, 197.0, 41.5, 35.0]
    assert diagram(user).label is None
    assert user.steps == ["Move start of segment 3 to 86.5°"]
    user.choose("Edit", "Undo Move start of segment 3 to 86.5°")
    assert user.design == LIFT


def rises_of_lift() -> list[float]:
    return [0.0, -150.0, 0.0, 150.0, 0.0]


def test_a_point_is_drawn_in_both_directions(user: User) -> None:
    hand = take(user, 2)
    hand.move(15.0, -20.0)
    hand.release()
    level = user.design.drive.motion.start + rises(user)[1]
    assert spans(user) == [35.0, 56.5, 192.0, 41.5, 35.0]
    assert level in (-22.0, -20.0, -18.0)  # pixels are whole, levels step by 2 mm
    assert rises(user) == [0.0, level - 150.0, 0.0, 150.0 - level, 0.0]
    assert user.steps == [f"Move start of segment 3 to 91.5°, \u2212{-level:g} mm"]


def test_sideways_a_point_keeps_its_level(user: User) -> None:
    hand = take(user, 2)
    hand.move_pixels(12.0, 2.0)
    hand.release()
    assert rises(user) == rises_of_lift()
    assert spans(user)[1] > 41.5


def test_shift_keeps_to_one_direction(user: User) -> None:
    hand = take(user, 2, SHIFT)
    hand.move_pixels(12.0, 9.0)
    assert rises(user) == rises_of_lift()
    hand.move_pixels(0.0, 12.0)
    assert spans(user) == [s.span_deg for s in LIFT.drive.motion.segments]
    assert rises(user) != rises_of_lift()
    hand.release()


def test_ctrl_is_finer(user: User) -> None:
    hand = take_line(user, 76.5, keys=CTRL)
    hand.move(7.0, 0.0)
    hand.release()
    assert spans(user)[1] == pytest.approx(42.2, abs=0.051)
    assert round(spans(user)[1] * 20.0) == pytest.approx(spans(user)[1] * 20.0, abs=1e-9)


def test_a_dwell_is_drawn_as_a_whole(user: User) -> None:
    hand = take_line(user, 180.0, 0.0)
    hand.move(0.0, 30.0)
    hand.release()
    rise = rises(user)[3]
    assert rise == pytest.approx(120.0, abs=2.0)
    assert rises(user) == [0.0, -rise, 0.0, rise, 0.0]
    assert spans(user) == [s.span_deg for s in LIFT.drive.motion.segments]


@pytest.mark.parametrize("angle", [0.0, 360.0])
def test_the_join_at_cam_angle_0_moves_the_start(user: User, angle: float) -> None:
    hand = take_line(user, angle, 150.0)
    hand.move(20.0 if angle == 0.0 else -20.0, -30.0)
    label = diagram(user).label
    assert label is not None
    assert label.right == (angle == 360.0)
    hand.release()
    start = user.design.drive.motion.start
    assert start == pytest.approx(120.0, abs=2.0)
    assert rises(user) == [0.0, -start, 0.0, start, 0.0]
    assert spans(user) == [s.span_deg for s in LIFT.drive.motion.segments]
    assert user.steps == [f"Move start of segment 1 to {start:g} mm"]


def test_a_boundary_does_not_pass_its_neighbours(user: User) -> None:
    hand = take_line(user, 76.5)
    hand.move(-300.0, 0.0)
    assert spans(user) == [35.0, 0.5, 248.0, 41.5, 35.0]
    hand.move(900.0, 0.0)
    assert spans(user) == [35.0, 248.0, 0.5, 41.5, 35.0]
    hand.release()


def test_escape_takes_a_pull_back(user: User) -> None:
    hand = take(user, 2)
    hand.move(15.0, -20.0)
    assert user.design != LIFT
    user.press(Qt.Key.Key_Escape)
    assert (user.design, user.steps, user.session.modified) == (LIFT, [], False)
    assert not shown_before(user)
    hand.move(15.0, 15.0)  # the button is still down
    hand.release()
    assert user.design == LIFT


def test_undo_in_the_middle_of_a_pull_ends_it(user: User) -> None:
    hand = take(user, 2)
    hand.move(15.0, -20.0)
    user.session.stack.undo()
    settle()
    hand.move(15.0, -20.0)
    hand.release()
    assert user.design == LIFT


def test_another_edit_in_the_middle_of_a_pull_ends_it(user: User) -> None:
    hand = take(user, 2)
    hand.move(15.0, -20.0)
    user.choose("Make", "Insert segment")
    grown = user.design
    hand.move(15.0, -20.0)
    hand.release()
    assert user.design == grown
    assert len(user.steps) == 2


def test_what_cannot_be_is_told_and_the_last_good_motion_stays(same_window: Open) -> None:
    """With the mechanism in sight its reach is a limit."""
    user = same_window()
    hand = take_line(user, 180.0, 0.0)
    hand.move(0.0, -20.0)
    good = user.design
    assert good != LIFT
    hand.move_pixels(0.0, 3000.0)
    label = diagram(user).label
    assert label is not None
    assert label.refused
    assert label.text.endswith("not possible")
    assert user.session.study.cam is not None
    hand.release()
    assert diagram(user).label is None
    assert all(not field.trouble for form in user.parameters().forms.values() for field in form.fields.values())
    assert len(user.steps) == 1


def test_the_range_grows_with_a_pull_and_fits_afterwards(whole: User) -> None:
    """What the hand draws at stays under it: a pixel is as many mm at the end of the pull as at its start."""
    paper = diagram(whole)
    step, low = paper.scale_now().unit, paper.scale_now().low
    hand = take_line(whole, 180.0, 0.0)
    hand.move_pixels(0.0, 60.0)
    level = 150.0 + rises(whole)[1]
    assert level == pytest.approx(-60.0 / step, abs=2.0)
    assert paper.scale_now().low < low
    hand.move_pixels(0.0, -60.0)
    assert rises(whole) == rises_of_lift()
    hand.move_pixels(0.0, -120.0)
    assert paper.scale_now().low == pytest.approx(low)
    hand.release()
    paper.setFocus()
    whole.press(Qt.Key.Key_Escape)  # without the motion before
    assert paper.scale_now().low > 0.0


def test_the_range_does_not_shrink_under_the_hand(user: User) -> None:
    """What was recalled of an earlier edit is no longer shown, but its room stays until the pull is over."""
    paper = diagram(user)
    user.enter_cell(1, RISE, "-90")
    low = paper.scale_now().low
    assert low < 0.0
    hand = take_line(user, 180.0, 60.0)
    hand.move_pixels(0.0, -8.0)
    assert paper.scale_now().low == pytest.approx(low)
    hand.release()
    assert paper.scale_now().low > 0.0


def test_the_picture_is_kept_and_only_changed(user: User) -> None:
    paper = diagram(user)
    items = set(map(id, paper.scene().items()))
    hand = take(user, 2)
    for _ in range(5):
        hand.move(3.0, -3.0)
    hand.release()
    assert set(map(id, paper.scene().items())) == items


def test_plots_below_the_diagram_are_read_only_after_they_are_drawn(
    user: User, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While a point is drawn they follow in their turn: each draws its curve, then writes its value, and both once."""
    view = user.motion()
    user.window.docks["motion"].setFloating(True)
    user.window.docks["motion"].resize(1000, 900)
    wait_for(lambda: view.derivatives.shown)
    settle()
    lines: list[str] = []
    for name in ("set_curves", "set_angle"):
        call = getattr(LivePlot, name)

        def noted(plot: LivePlot, *args: Any, name: str = name, call: Any = call, **more: Any) -> None:
            if plot is view.derivatives.plots[0]:
                lines.append(name)
            call(plot, *args, **more)

        monkeypatch.setattr(LivePlot, name, noted)
    hand = take(user, 2)
    hand.move(10.0, -10.0)
    lines.clear()
    for times in (1, 2, 3):
        hand.move(3.0, -3.0)
        wait_for(lambda times=times: lines == ["set_curves", "set_angle"] * times)  # type: ignore[misc]
    user.window.player.step(1.0)
    assert lines[-1] == "set_angle"
    hand.release()


class Counter(QObject):
    """Number of paints and layouts of a widget."""

    def __init__(self, widget: QWidget) -> None:
        super().__init__()
        self.count = 0
        widget.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        self.count += event.type() in (QEvent.Type.Paint, QEvent.Type.LayoutRequest)
        return False


def test_a_pull_neither_lays_out_nor_paints_the_toolbar(user: User) -> None:
    """Undo names the step once the mouse lets go, and can be chosen before."""
    undo = user.action("Edit", "Undo")
    (toolbar,) = (bar for bar in user.window.findChildren(QToolBar) if bar.objectName() == "toolbar")
    assert not undo.isEnabled()
    hand = take(user, 2)
    hand.move(10.0, -10.0)
    counter = Counter(toolbar)
    for _ in range(3):
        hand.move(3.0, -3.0)
    assert counter.count == 0
    assert undo.isEnabled()
    hand.release()
    assert undo.text() == f"&Undo {user.steps[-1]}"


# -- the motion before ------------------------------------------------------------------------------------


def test_the_motion_before_the_edit_is_recalled(user: User) -> None:
    hand = take(user, 2)
    hand.move(15.0, -20.0)
    assert shown_before(user)
    _, values = line(user, dashed=True).getData()
    assert values[:-1] == pytest.approx(Study(LIFT, 1800).motion.y[0] * 1e3)
    hand.release()
    assert shown_before(user)
    user.motion().table.setFocus()
    user.press(Qt.Key.Key_Escape)
    assert not shown_before(user)
    user.enter_cell(1, SPAN, "45")
    assert shown_before(user)
    user.enter("follower.rod_mm", "846")  # another edit, which leaves the motion alone
    assert not shown_before(user)


def test_undo_forgets_the_motion_before(user: User) -> None:
    user.enter_cell(1, RISE, "-120")
    user.enter_cell(1, RISE, "-100")
    assert shown_before(user)
    user.choose("Edit", "Undo Change rise of segment 2 to \u2212100 mm")
    user.choose("Edit", "Undo Change rise of segment 2 to \u2212120 mm")
    assert user.design == LIFT
    assert not shown_before(user)


def test_a_gesture_of_many_steps_is_compared_with_its_beginning(user: User) -> None:
    box = user.number("motion.stroke_mm")
    user.press(Qt.Key.Key_Up, Qt.Key.Key_Up, Qt.Key.Key_Up)
    assert box.value == 153.0
    _, values = line(user, dashed=True).getData()
    assert float(np.ptp(values)) == pytest.approx(150.0)


# -- cam and choice ---------------------------------------------------------------------------------------


def test_beside_the_joins_a_press_turns_the_cam_and_chooses_the_segment(user: User) -> None:
    hand = take_line(user, 180.0, 90.0)
    assert degrees(user.window.player.theta) == pytest.approx(180.0, abs=1.0)
    assert user.motion().chosen == 2
    hand.move(60.0, 0.0)
    assert degrees(user.window.player.theta) == pytest.approx(240.0, abs=1.5)
    hand.release()
    assert user.design == LIFT


def test_the_cursor_follows_the_cam(user: User) -> None:
    user.window.player.step(50.0)
    assert diagram(user).angle == pytest.approx(user.window.player.theta)


# -- keys -------------------------------------------------------------------------------------------------


def test_keys_choose_and_move_a_join(user: User) -> None:
    paper = diagram(user)
    user.motion().choose(0)
    paper.setFocus()
    user.press(Qt.Key.Key_PageDown)
    assert user.motion().chosen == 1
    user.press(Qt.Key.Key_Right, Qt.Key.Key_Right, Qt.Key.Key_Left, Qt.Key.Key_Right, modifier=ALT)
    assert spans(user) == [35.0, 42.5, 206.0, 41.5, 35.0]
    user.press(Qt.Key.Key_Right, modifier=ALT | SHIFT)
    assert spans(user)[1] == 42.55
    assert len(user.steps) == 1
    user.press(Qt.Key.Key_Down, modifier=ALT)
    step = paper.scale_now().level_step
    assert user.steps == [f"Move start of segment 3 to 77.55°, \u2212{step:g} mm"]
    user.press(Qt.Key.Key_PageUp)
    user.press(Qt.Key.Key_Left, modifier=ALT)
    assert spans(user)[:2] == [34.5, 43.05]
    assert len(user.steps) == 2


def test_escape_takes_steps_by_keys_back(user: User) -> None:
    user.motion().choose(1)
    diagram(user).setFocus()
    user.press(Qt.Key.Key_Right, Qt.Key.Key_Right, Qt.Key.Key_Up, modifier=ALT)
    user.press(Qt.Key.Key_Escape)
    assert (user.design, user.steps) == (LIFT, [])


def test_the_other_keys_belong_to_the_player(user: User) -> None:
    diagram(user).setFocus()
    user.press(Qt.Key.Key_Right, Qt.Key.Key_Right, Qt.Key.Key_Left)
    assert degrees(user.window.player.theta) == pytest.approx(1.0)
    user.press(Qt.Key.Key_Space)
    assert user.window.player.playing
    user.press(Qt.Key.Key_Space)
    assert not user.window.player.playing
    assert user.design == LIFT


def test_keys_move_the_join_from_the_table_too(user: User) -> None:
    user.motion().choose(1, SPAN)
    user.motion().table.setFocus()
    user.press(Qt.Key.Key_Right, modifier=ALT)
    assert spans(user) == [35.0, 42.0, 206.5, 41.5, 35.0]
    user.press(Qt.Key.Key_Escape)
    assert user.design == LIFT


# -- whole segments ---------------------------------------------------------------------------------------

WAYS: dict[str, Callable[[User, str, str], None]] = {
    "menu": lambda user, name, entry: user.choose("Make", entry),
    "button": lambda user, name, entry: QTest.mouseClick(user.motion().bar.buttons[name], Qt.MouseButton.LeftButton),
    "keys": lambda user, name, entry: shortcut(user, entry),
    "context menu": lambda user, name, entry: from_menu(user, entry),
}


def shortcut(user: User, entry: str) -> None:
    """Press the keys that the menu tells."""
    keys = user.action("Make", entry).shortcut()[0]
    assert keys.toCombined() != 0
    QTest.keyClick(user.motion().table, keys.key(), keys.keyboardModifiers())
    settle()


def from_menu(user: User, entry: str) -> None:
    """Right click on the chosen row of the table, and choose."""
    view = user.motion()
    place = view.table.visualRect(view.model.index(view.chosen, LAW)).center()
    view.table.customContextMenuRequested.emit(place)
    menu = view.table.findChild(QMenu)
    assert menu is not None
    next(a for a in menu.actions() if plain(a.text()) == entry).trigger()
    menu.close()
    settle()


@pytest.mark.parametrize("way", spread(WAYS, 1))
def test_a_segment_is_split(user: User, way: str) -> None:
    user.motion().choose(1)
    user.motion().table.setFocus()
    user.window.player.step(50.0)
    WAYS[way](user, "split", "Split segment")
    assert spans(user) == [35.0, 15.0, 26.5, 207.0, 41.5, 35.0]
    assert laws(user)[1:3] == ["modified-sine", "modified-sine"]
    assert user.steps == ["Split segment 2"]
    assert user.motion().chosen == 1


@pytest.mark.parametrize("way", spread(WAYS, 1))
def test_a_segment_is_duplicated(user: User, way: str) -> None:
    user.motion().choose(1)
    user.motion().table.setFocus()
    WAYS[way](user, "duplicate", "Duplicate segment")
    assert spans(user) == [35.0, 20.75, 20.75, 207.0, 41.5, 35.0]
    assert rises(user) == [0.0, -75.0, -75.0, 0.0, 150.0, 0.0]
    assert user.steps == ["Duplicate segment 2"]
    assert user.motion().chosen == 2


@pytest.mark.parametrize("way", spread(WAYS, 1))
def test_a_stroke_is_mirrored(user: User, way: str) -> None:
    user.session.edit("motion.segments[1].law", "cycloidal", "x")
    user.session.edit("motion.segments[1].span_deg", 60.0, "x")
    user.motion().choose(1)
    user.motion().table.setFocus()
    WAYS[way](user, "mirror", "Mirror stroke")
    assert laws(user) == ["dwell", "cycloidal", "dwell", "cycloidal", "dwell"]
    assert spans(user)[1] == spans(user)[3] == 60.0
    assert user.steps[-1] == "Mirror the stroke of segment 2"
    assert not user.motion().bar.buttons["mirror"].isEnabled()


def test_the_diagram_cuts_where_it_was_clicked(user: User) -> None:
    paper = diagram(user)
    place = paper.position_of(200.2, 60.0).toPoint()
    QTest.mouseClick(paper.viewport(), Qt.MouseButton.RightButton, NONE, place)
    paper.menu_requested.emit(paper.mapToGlobal(place), 200.2)
    menu = paper.findChild(QMenu)
    assert menu is not None
    paper.segment_chosen.emit(2)
    next(a for a in menu.actions() if plain(a.text()) == "Split segment").trigger()
    menu.close()
    settle()
    assert spans(user) == [35.0, 41.5, 123.5, 83.5, 41.5, 35.0]
    assert laws(user)[2:4] == ["dwell", "dwell"]


def test_what_makes_no_sense_is_grey(user: User) -> None:
    view = user.motion()
    entries = {"mirror": "Mirror stroke", "delete": "Delete segment", "split": "Split segment"}

    def able(name: str) -> bool:
        shown = view.bar.buttons[name].isEnabled()
        assert user.action("Make", entries[name]).isEnabled() == shown
        return shown

    view.choose(1)
    assert (able("mirror"), able("delete"), able("split")) == (False, True, True)  # it is its own image
    user.enter_cell(1, SPAN, "60")
    assert able("mirror")
    view.choose(2)
    assert not able("mirror")  # a dwell
    while len(spans(user)) > 1:
        view.act("delete")
        settle()
    assert (able("mirror"), able("delete")) == (False, False)


def test_what_does_not_fit_is_told_below_the_table(user: User) -> None:
    """With the guide there the rod does not reach, so that there is no motion at all."""
    view = user.motion()
    user.session.stages_on_screen = tuple
    user.session.edit("follower.guide_height_mm", -1300.0, "x")
    user.session.stages_on_screen = lambda: ("motion", "linkage")
    before = user.design
    view.choose(1)
    view.act("duplicate")
    assert user.design == before
    assert view.incomplete_bar.isVisible()
    assert view.incomplete_bar.trouble.text().startswith("Rod L2: the rod does not reach")
    user.session.edit("follower.guide_height_mm", 1300.0, "x")
    assert not view.incomplete_bar.isVisible()
    assert user.field("follower.rod_mm").trouble == ""
    assert len(user.design.drive.motion.segments) == 6
    assert user.steps == ["x", "Duplicate segment 2", "x"]


# -- from nothing -----------------------------------------------------------------------------------------


@pytest.mark.stress
def test_a_rise_and_its_return_are_laid_out_by_the_mouse_alone(user: User) -> None:
    """From a dwell over the whole turn: cut where the mouse points, pick laws, draw the level, mirror."""
    user.session.put(edited_to_stand(user), "Lay out")
    view, paper = user.motion(), diagram(user)
    assert (spans(user), rises(user)) == ([360.0], [0.0])
    for angle in (60.0, 120.0, 210.0, 300.0):
        Hand(user, paper.position_of(angle, 20.0)).release()
        QTest.mouseClick(view.bar.buttons["split"], Qt.MouseButton.LeftButton)
        settle()
    assert [round(a) for a in spans(user)] == pytest.approx([60, 60, 90, 90, 60], abs=1)
    assert all(2.0 * a == round(2.0 * a) for a in spans(user))
    for row in (1, 3):
        user.session.edit(f"motion.segments[{row}].law", "modified-sine", "x")
    hand = take_line(user, 165.0, 0.0)
    hand.move(0.0, 30.0)
    hand.release()
    assert rises(user) == [0.0, rises(user)[1], 0.0, -rises(user)[1], 0.0]
    assert rises(user)[1] == pytest.approx(30.0, abs=2.0)
    view.choose(1)
    QTest.mouseClick(view.bar.buttons["mirror"], Qt.MouseButton.LeftButton)
    assert spans(user)[1] == spans(user)[3]


def edited_to_stand(user: User) -> Design:
    """The design with a single dwell."""
    still = Motion(0.0, (Segment(360.0, 0.0, NamedCurve("dwell")),))
    return with_drive(user.design, motion=still)


# -- little room ------------------------------------------------------------------------------------------


def test_in_a_narrow_dock_buttons_lose_their_words_and_joins_their_sizes(user: User) -> None:
    view = user.motion()
    user.session.edit("motion.segments[1].law", "constant-velocity", "x")
    user.window.docks["motion"].setFloating(True)
    for width, words in ((900, True), (600, True), (345, False)):
        user.window.docks["motion"].resize(width, 420)
        settle()
        wait_for(lambda width=width: view.width() == width)  # type: ignore[misc]
        beside = Qt.ToolButtonStyle.ToolButtonTextBesideIcon
        assert all((b.toolButtonStyle() == beside) == words for b in view.bar.buttons.values())
        assert view.table.horizontalScrollBar().maximum() == 0
        assert view.minimumSizeHint().width() <= view.width()
