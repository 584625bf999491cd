"""Joints of cams and their followers drawn elsewhere on the drawing, as those of linkages are."""

from collections.abc import Callable
from time import sleep

import numpy as np
import pytest
from PySide6.QtCore import QCoreApplication, QEvent, QObject, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from window_user import Open, User, pixel, settle, wait_for

from core.design import faults
from core.mechanism import driver_ranges_of
from core.project import load
from core.study import Study, findings_of
from core.study.stages import evaluations
from kindyna_gui.documents.edits import SAMPLES
from kindyna_gui.graph.plots_view import PlotView
from kindyna_gui.linkage.canvas import draggable_joints
from kindyna_gui.linkage.centres_view import PAGES, CentresView, Position
from kindyna_gui.places import example
from kindyna_gui.view import FRAME_MS, View
from kindyna_gui.window import gallery, status_line

WAYS = {"pivot": 20 + 15j, "arm_pin": -30 + 20j, "slider_pin": 25 - 20j, "roller": 15 + 20j}


def place(user: User, point: str) -> complex:
    """Where a joint stands, exactly [mm]."""
    kinematics = user.session.at(user.window.player.theta).linkage
    return next(complex(b.position(point)[0]) for b in kinematics.bodies.values() if point in b.points) * 1e3


@pytest.fixture
def user(same_window: Open) -> User:
    """At the lift."""
    return same_window()


@pytest.mark.stress
def test_every_joint_of_a_layout_follows_the_mouse_in_one_step(user: User) -> None:
    """At a cam angle within the motion; the joint lands under the mouse, the drawing shows it, Undo brings it back."""
    view = user.drawing()
    for letter in ("a", "d", "g"):
        user.session.start(gallery.layout_design(letter))
        user.window.player.set_theta(1.0)
        settle()
        before = user.design
        assert set(draggable_joints(view.scene)) == set(WAYS)
        for joint, way in WAYS.items():
            start = place(user, joint)
            user.drag(start, start + way)
            assert place(user, joint) == pytest.approx(start + way, abs=1.5 / view.canvas.scale_now), (letter, joint)
            assert draggable_joints(view.scene)[joint] == pytest.approx(
                place(user, joint), abs=1.0 / view.canvas.scale_now
            )
            assert user.steps == [f"Move {joint.replace('_', ' ')}"]
            assert faults(user.design) == []
            user.session.stack.undo()
            assert user.design == before
    assert user.faults == []


def test_the_fields_follow_a_joint_that_is_drawn(user: User) -> None:
    start = place(user, "arm_pin")
    user.drag(start, start - 30.0)
    follower = user.design.drive.mechanism
    for path in ("slider_arm_mm", "rod_mm", "fixed_angle_deg"):
        assert user.number(f"follower.{path}").value == getattr(follower, path)
        assert getattr(follower, path) != getattr(load(example("transfer_lift")).drive.mechanism, path)


def test_the_roller_of_a_translating_follower_is_drawn_aside(open_user: Open) -> None:
    user = open_user(example("kim_1990"))
    assert not user.design.drive.is_linkage
    view = user.drawing()
    start = place(user, "roller")
    user.drag(start, start + 6.0 + 4.0j)
    assert place(user, "roller") == pytest.approx(start + 6.0 + 4.0j, abs=1.5 / view.canvas.scale_now)
    assert user.design.drive.mechanism.offset_mm == pytest.approx(-6.0, abs=0.5)
    assert user.design.drive.cam.base_radius_mm > load(example("kim_1990")).drive.cam.base_radius_mm
    assert user.steps == ["Move roller"]


@pytest.mark.parametrize(
    ("name", "joint", "way", "step"),
    [("finger_follower", "pad_centre", 2.0 - 1.0j, "pad"), ("pushrod_train", "upper_ball", -3.0 + 2.0j, "upper ball")],
)
def test_a_joint_of_a_valve_train_is_drawn_elsewhere(
    open_user: Open, name: str, joint: str, way: complex, step: str
) -> None:
    """Within the lift; the pivot stays, the fields show the new lengths, and Undo brings them back."""
    user = open_user(example(name))
    user.turn(170.0)
    view, before, pivot = user.drawing(), user.design, place(user, "pivot")
    start = place(user, joint)
    user.drag(start, start + way)
    assert user.steps == [f"Move {step}"]
    assert place(user, joint) == pytest.approx(start + way, abs=1.5 / view.canvas.scale_now)
    assert place(user, "pivot") == pytest.approx(pivot, abs=1e-9)
    assert faults(user.design) == []
    assert user.number("follower.pad_angle_deg").value == user.design.drive.mechanism.pad_angle_deg
    assert user.design.drive.mechanism.pad_angle_deg != before.drive.mechanism.pad_angle_deg
    user.session.stack.undo()
    assert user.design == before


def test_the_face_of_a_flat_rocker_is_drawn_off_its_pivot(open_user: Open) -> None:
    """It goes through the mouse, in the same direction."""
    user = open_user(example("rocker_flat"))
    user.turn(100.0)
    view, before = user.drawing(), user.design
    arm = user.session.at(user.window.player.theta).linkage.follower
    way = 7.0 * complex(arm.unit[0])
    start = draggable_joints(view.scene)["face"]
    user.drag(start, start + way)
    assert user.steps == ["Move flat face"]
    assert user.design.drive.mechanism.face.face_offset_mm == pytest.approx(
        before.drive.mechanism.face.face_offset_mm + 7.0, abs=0.3
    )
    after = user.session.at(user.window.player.theta).linkage.follower
    assert after.unit[0] == pytest.approx(arm.unit[0], abs=1e-9)
    off = ((start + way) * 1e-3 - after.z[0, 0]) / after.unit[0]
    assert abs(off.real) * 1e3 < 1.5 / view.canvas.scale_now


def test_a_joint_stays_at_its_last_good_place_where_nothing_fits(user: User) -> None:
    """The arm's pin drawn between pivot and slider: farther out, in the base position, arm and rod would not meet. A word
    tells it, the last good design stays."""
    view = user.drawing()
    told: list[str] = []
    user.session.refused.connect(lambda refusal: told.append(refusal.reasons[0][2]))
    user.drag(place(user, "arm_pin"), (place(user, "pivot") + place(user, "slider_pin")) / 2.0)
    assert told
    assert "Refused" in user.window.status.currentMessage()
    assert not view.in_trouble
    assert faults(user.design) == []
    _ = user.session.study.linkage
    assert len(user.steps) <= 1


def test_a_refused_drag_says_why_at_the_mouse_until_a_place_is_valid(user: User) -> None:
    view = user.drawing()
    canvas, start = view.canvas, place(user, "arm_pin")
    end = (place(user, "pivot") + place(user, "slider_pin")) / 2.0
    QTest.mousePress(canvas.viewport(), Qt.MouseButton.LeftButton, pos=pixel(canvas, start))
    for at in (start + 1.0, end):
        QTest.mouseMove(canvas.viewport(), pixel(canvas, at))
        settle()
    assert view.drag is not None
    refusal = view.drag.refusal
    assert refusal
    assert refusal in " ".join(text for text, violated in view.drag.shown if violated), "in the colour of limits"
    QTest.mouseMove(canvas.viewport(), pixel(canvas, start + 2.0))
    settle()
    assert view.drag.refusal == ""
    QTest.mouseRelease(canvas.viewport(), Qt.MouseButton.LeftButton, pos=pixel(canvas, start + 2.0))


def test_beside_the_joints_the_drawing_is_moved(user: User) -> None:
    view = user.drawing()
    centre = view.canvas.visible.center()
    at = complex(view.canvas.visible.center().x(), view.canvas.visible.center().y())
    user.drag(at, at + 60.0)
    assert view.canvas.visible.center() != centre
    assert user.steps == []


def test_a_joint_shows_that_it_can_be_taken(user: User) -> None:
    view = user.drawing()
    viewport = view.canvas.viewport()
    QTest.mouseMove(viewport, viewport.rect().center())
    QTest.mouseMove(viewport, pixel(view.canvas, place(user, "arm_pin")))
    settle()
    assert view.canvas.cursor().shape() == Qt.CursorShape.SizeAllCursor
    QTest.mouseMove(viewport, viewport.rect().center())
    settle()
    assert view.canvas.cursor().shape() == Qt.CursorShape.ArrowCursor


class Diary(QObject):
    """Writes down what is read from a study and what is painted, in order."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        super().__init__()
        self.lines: list[str] = []
        self._patch, self._papers = patch, dict[QObject, str]()

    def watch(self, name: str, view: View, paper: QWidget) -> None:
        refresh = view.refresh

        def noted(study: Study) -> None:
            self.lines.append(f"read {name}")
            refresh(study)

        self._patch.setattr(view, "refresh", noted)
        self._papers[paper] = name
        paper.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.Paint:
            self.lines.append(f"paint {self._papers[watched]}")
        return False


@pytest.fixture
def hand(six_bar: User) -> Callable[[int], None]:
    """Takes the first joint of the six-bar and draws it on, so many moves of the mouse from where it is, one in a frame of the
    screen; a negative number: as many moves at once."""
    paper, at = six_bar.drawing().canvas.viewport(), [QPointF()]
    none, left = Qt.KeyboardModifier.NoModifier, Qt.MouseButton.LeftButton

    def draw(moves: int) -> None:
        if at[0].isNull():
            at[0] = QPointF(pixel(six_bar.drawing().canvas, draggable_joints(six_bar.drawing().scene)["A"]))
            QTest.mousePress(paper, left, none, at[0].toPoint())
        for _ in range(abs(moves)):
            sleep(FRAME_MS / 1e3 if moves > 0 else 0.0)
            at[0] += QPointF(-1.0, 1.0)
            before = six_bar.design
            event = QMouseEvent(
                QEvent.Type.MouseMove, at[0], paper.mapToGlobal(at[0]), Qt.MouseButton.NoButton, left, none
            )
            QApplication.sendEvent(paper, event)
            assert six_bar.design is not before
            QCoreApplication.sendPostedEvents()  # paints, while the next move is waiting already

    return draw


@pytest.mark.stress
def test_the_table_of_centres_and_the_count_of_findings_follow_once_the_mouse_lets_go(
    six_bar: User, hand: Callable[[int], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are then those of the same values typed in."""
    centres, status = six_bar.see("centres"), six_bar.window.status
    assert isinstance(centres, CentresView)
    settle()
    counts: list[object] = []
    monkeypatch.setattr(status_line, "findings_of", lambda *parts: counts.append(parts) or findings_of(*parts))
    before = centres.now
    for _ in range(3):
        hand(1)
        QTest.qWait(2 * centres.pause_ms)
        QTest.qWait(2 * status_line.PAUSE_MS)
    assert centres.now is before
    assert not counts
    QTest.mouseRelease(six_bar.drawing().canvas.viewport(), Qt.MouseButton.LeftButton)
    typed = Study(six_bar.design, SAMPLES)
    text = status_line.counted(findings_of(typed, six_bar.window.stages_on_screen()))[0]
    wait_for(lambda: centres.up_to_date and bool(counts) and status.findings.text() == text)
    table = centres.page("links")
    now = Position(typed.at_theta(np.array([six_bar.window.player.theta])))
    assert [table.model().index(row, 0).data() for row in range(table.model().rowCount())] == [
        row.cells[0] for row in PAGES["links"].rows(now)
    ]


def test_a_drawn_joint_is_followed_by_the_drawing_first_and_by_plots_once_no_move_waits(
    six_bar: User, hand: Callable[[int], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each move solves the linkage once for all views, and where the hand is, at one angle."""
    drawing, plot = six_bar.drawing(), six_bar.see("velocity")
    assert isinstance(plot, PlotView)
    settle()
    diary = Diary(monkeypatch)
    diary.watch("drawing", drawing, drawing.canvas.viewport())
    diary.watch("plot", plot, plot.plot.viewport())
    hand(1)
    wait_for(lambda: plot.up_to_date)
    evaluations.clear()
    diary.lines.clear()
    hand(4)
    assert diary.lines == ["read drawing", "paint drawing"] * 4
    assert evaluations["linkage"] == 4 + 4
    assert not plot.up_to_date
    wait_for(lambda: plot.up_to_date)
    settle()
    after = [
        line for line in diary.lines[8:] if line != "paint drawing"
    ]  # which finds better sides for its labels at rest
    assert after == ["read plot", "paint plot"]
    assert plot.up_to_date
    hand(1)
    QTest.mouseRelease(drawing.canvas.viewport(), Qt.MouseButton.LeftButton)
    settle()
    assert diary.lines.count("read plot") == 2
    assert plot.up_to_date
    assert len(six_bar.steps) == 1
    diary.lines.clear()
    assert six_bar.session.edit("linkage.links[2].points.B", (69.5, 0.0), "Change B")
    assert "read plot" in diary.lines, "what is typed is followed at once"


def test_a_drawn_joint_is_painted_once_a_move_while_a_plot_is_waiting_to_be_painted(
    six_bar: User, hand: Callable[[int], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    drawing, plot = six_bar.drawing(), six_bar.see("velocity")
    assert isinstance(plot, PlotView)
    diary = Diary(monkeypatch)
    diary.watch("drawing", drawing, drawing.canvas.viewport())
    diary.watch("plot", plot, plot.plot.viewport())
    hand(2)
    settle()
    diary.lines.clear()
    for _ in range(4):
        hand(1)
        plot.pull()  # in its turn, just before the next move
    assert diary.lines.count("paint drawing") == 4
    assert diary.lines.count("paint plot") == 3


def test_moves_faster_than_the_screen_are_drawn_at_most_once_a_frame_and_the_last_one_always(
    six_bar: User, hand: Callable[[int], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    drawing = six_bar.drawing()
    hand(1)
    settle()
    diary = Diary(monkeypatch)
    diary.watch("drawing", drawing, drawing.canvas.viewport())
    monkeypatch.setattr("kindyna_gui.view.FRAME_MS", 60_000)
    hand(-5)
    assert diary.lines == []
    assert not drawing.up_to_date
    QTest.mouseRelease(drawing.canvas.viewport(), Qt.MouseButton.LeftButton)
    assert drawing.up_to_date
    assert "read drawing" in diary.lines
    assert draggable_joints(drawing.scene)["A"] == pytest.approx(place(six_bar, "A"), abs=1e-6)


def test_a_drag_searches_no_ranges_and_ends_with_those_of_the_typed_values(
    six_bar: User, hand: Callable[[int], None]
) -> None:
    """While the mouse draws a joint the change points of the six-bar follow it; the search runs once it lets go."""
    six_bar.see("centres")
    hand(1)
    settle()
    searches = driver_ranges_of.cache_info().misses
    first = six_bar.session.study.driver_ranges.changes
    for _ in range(6):
        hand(1)
        settle()
    assert driver_ranges_of.cache_info().misses == searches
    dragged = six_bar.session.study
    assert all(abs(a.at - b.at) > 1e-4 for a, b in zip(first, dragged.driver_ranges.changes, strict=True))
    QTest.mouseRelease(six_bar.drawing().canvas.viewport(), Qt.MouseButton.LeftButton)
    settle()
    assert driver_ranges_of.cache_info().misses == searches + 1
    study, typed = six_bar.session.study, Study(six_bar.design, SAMPLES)
    assert study is not dragged
    assert study.driver_ranges is typed.driver_ranges
    assert study.linkage is typed.linkage
    assert findings_of(study) == findings_of(typed)
    assert [c.joint for c in dragged.driver_ranges.changes] == [c.joint for c in typed.driver_ranges.changes]
    assert [c.at for c in dragged.driver_ranges.changes] == pytest.approx(
        [c.at for c in typed.driver_ranges.changes], abs=1e-7
    )
    views = six_bar.window.findChildren(View)
    wait_for(lambda: all(view.up_to_date or not view.on_screen() for view in views))
