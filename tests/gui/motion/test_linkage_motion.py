"""The motion that drives a linkage in the window: the same editor as for a cam, and a cam that follows every edit."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QProgressDialog
from sampled import spread
from window_user import Open, User, settle, wait_for

from core.design import join_levels, motion_of, require_motion
from core.project import load
from core.study import certificate_of, findings_of
from kindyna_gui import dialogs
from kindyna_gui.blend.wizard import BlendDialog
from kindyna_gui.measured.dialog import MeasuredDialog
from kindyna_gui.motion.editor import MotionEditor
from kindyna_gui.motion.laws_view import LawsView
from kindyna_gui.motion.segments_table import LAW, RISE, SPAN
from kindyna_gui.places import example

COUPLER = load(example("four_bar_coupler_cam"))


@pytest.fixture
def user(same_window: Open) -> User:
    """At the four-bar with the roller on its coupler, without plots."""
    return same_window(example("four_bar_coupler_cam"))


def profile(user: User) -> np.ndarray:
    shape: np.ndarray = user.session.study.cam.flank.profile
    return shape


def laws(user: User) -> list[str]:
    return [s.curve.law for s in require_motion(user.design).segments]


def test_the_table_is_the_linkages_motion(user: User) -> None:
    view = user.motion()
    assert not view.in_trouble
    assert [user.cell(row, LAW) for row in range(4)] == ["Dwell", "Cycloidal", "Dwell", "Cycloidal"]
    assert [user.cell(row, SPAN) for row in range(4)] == ["60", "100", "60", "140"]
    assert set(view.header.fields) == {"motion.start_deg", "motion.stroke_deg"}
    assert view.diagram.motion == motion_of(COUPLER)


def test_a_typed_span_moves_the_cam_and_is_undone_by_name(user: User) -> None:
    before = profile(user)
    user.enter_cell(1, SPAN, "90")
    assert [s.span_deg for s in require_motion(user.design).segments] == [60.0, 90.0, 70.0, 140.0]
    assert user.steps == ["Change span of segment 2 to 90°"]
    assert np.abs(profile(user) - before).max() > 1e-4
    user.choose("Edit", "Undo Change span of segment 2 to 90°")
    assert user.design == COUPLER
    user.enter_cell(1, RISE, "15")
    user.enter("motion.stroke_deg", "10")
    assert [s.rise for s in require_motion(user.design).segments] == [0.0, 10.0, 0.0, -10.0]


@pytest.mark.parametrize(
    ("entry", "count", "step"),
    spread(
        [
            ("Insert segment", 5, "Insert segment after segment 2"),
            ("Split segment", 5, "Split segment 2"),
            ("Duplicate segment", 5, "Duplicate segment 2"),
            ("Mirror stroke", 4, "Mirror the stroke of segment 2"),
            ("Delete segment", 3, "Delete segment 2"),
        ],
        1,
    ),
)
def test_whole_segments_are_edited_from_the_menu(entry: str, count: int, step: str, user: User) -> None:
    user.motion().choose(1)
    settle()
    user.choose("Make", entry)
    assert len(laws(user)) == count
    assert user.steps == [step]
    user.session.stack.undo()
    assert user.design == COUPLER


def test_a_join_is_drawn_with_the_mouse(user: User) -> None:
    diagram = user.motion().diagram
    assert isinstance(diagram, MotionEditor)
    scale = diagram.scale_now()

    def pixel(angle: float, level: float) -> QPointF:
        return QPointF(diagram.mapFromScene(QPointF(scale.x(angle), scale.y(level))))

    start = pixel(160.0, 12.0).toPoint()
    end = start + (pixel(180.0, 12.0) - pixel(160.0, 12.0)).toPoint()
    QTest.mousePress(diagram.viewport(), Qt.MouseButton.LeftButton, pos=start)
    QTest.mouseMove(diagram.viewport(), (start + end) / 2)
    QTest.mouseMove(diagram.viewport(), end)
    QTest.mouseRelease(diagram.viewport(), Qt.MouseButton.LeftButton, pos=end)
    settle()
    motion = require_motion(user.design)
    assert motion.segments[1].span_deg == pytest.approx(120.0, abs=2.0)
    assert join_levels(motion)[2] == pytest.approx(12.0, abs=0.5)
    assert len(user.steps) == 1
    assert user.faults == []


@pytest.mark.stress
def test_a_motion_beyond_the_reach_of_the_links_is_refused(user: User) -> None:
    """What the links cannot follow is told with the angles; the last good design stays."""
    user.enter("motion.stroke_deg", "300")
    assert user.design == COUPLER
    assert "do not meet" in user.motion().fields["motion.stroke_deg"].trouble


def test_a_law_is_used_from_the_law_table(user: User) -> None:
    user.motion().choose(1)
    settle()
    laws_view = user.window.show_view("laws")
    assert isinstance(laws_view, LawsView)
    laws_view.pull()
    laws_view.table.choose("modified-sine")
    assert laws_view.use_button.text() == "Use in segment 2"
    laws_view.use_button.click()
    assert laws(user)[1] == "modified-sine"


def test_findings_and_certificate_follow_the_motion(user: User) -> None:
    for name in ("findings", "certificate"):
        view = user.window.show_view(name)
        wait_for(lambda view=view: view.up_to_date)  # type: ignore[misc]
    assert findings_of(user.session.study) == ()
    user.enter_cell(1, SPAN, "40")
    told = certificate_of(user.session.study)
    assert set(told) >= {"motion_closure", "loop_closure", "three_centres", "instant_centre", "roller_tangency"}
    assert all(residual.kept for residual in told.values())
    user.enter_cell(1, SPAN, "20")
    view = user.window.show_view("findings")
    wait_for(lambda: view.up_to_date)
    shown = [view.table.model().index(row, 0).data() for row in range(view.table.model().rowCount())]  # type: ignore[attr-defined]
    assert [finding.code for finding in findings_of(user.session.study)] == ["undercut", "roller-pressure-angle"]
    assert len(shown) == 2


@pytest.mark.stress
def test_a_blend_is_put_into_the_linkage(user: User) -> None:
    user.motion().choose(1)
    settle()
    user.choose("Make", "Blend...")
    dialog = user.window.findChild(BlendDialog)
    assert isinstance(dialog, BlendDialog)
    wait_for(lambda: not dialog.busy)
    assert dialog.questions.request().unit == "deg"
    assert dialog.put_button.isEnabled()
    dialog.questions.stroke.setFocus()
    dialog.questions.stroke.selectAll()
    QTest.keyClicks(dialog.questions.stroke, "9")
    wait_for(lambda: not dialog.busy and dialog.design is not None)
    QTest.mouseClick(dialog.put_button, Qt.MouseButton.LeftButton)
    settle()
    motion = require_motion(user.design)
    assert max(join_levels(motion)) == pytest.approx(9.0)
    assert user.steps[0].startswith("Blend ")
    user.session.stack.undo()
    assert user.design == COUPLER


def test_a_measured_swing_becomes_the_motion(user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    theta = np.arange(0.0, 360.0, 5.0)
    rows = "\n".join(f"{t:g},{6.0 - 6.0 * np.cos(np.radians(t)):.6f}" for t in theta)
    path = tmp_path / "swing.csv"
    path.write_text(f"cam_angle_deg,displacement_deg\n{rows}\n", encoding="utf-8")
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: path)
    user.choose("File", "Import measured motion...")
    dialog = user.window.findChild(MeasuredDialog)
    assert isinstance(dialog, MeasuredDialog)
    wait_for(lambda: dialog.reading.fit is not None)
    QTest.mouseClick(dialog.put_button, Qt.MouseButton.LeftButton)
    settle()
    assert set(laws(user)) == {"simple-harmonic"}
    assert user.steps == ["Import swing.csv"]
    assert np.rad2deg(user.session.study.motion.y[0]).max() == pytest.approx(12.0, abs=0.01)


def test_a_crank_at_speed_says_how_to_get_a_motion(same_window: Open) -> None:
    """Every entry of the menu Make that needs one; the law table is there for any design."""
    user = same_window(example("four_bar"))
    motion = user.window.show_view("motion")
    wait_for(lambda: motion.up_to_date)
    assert "Drive a link by a motion" in motion.no_picture
    user.choose("Make", "Blend...")
    assert "Drive a link by a motion" in user.window.status.currentMessage()
    user.window.status.clearMessage()
    user.choose("File", "Import measured motion...")
    assert "Drive a link by a motion" in user.window.status.currentMessage()
    for entry in ("Insert segment", "Duplicate segment", "Delete segment"):
        user.window.docks["motion"].hide()
        user.session.start(user.design)  # whose motion nobody has looked for yet
        user.window.status.clearMessage()
        user.window.actions_by_key[f"designing.segment:{entry.partition(' ')[0].lower()}"].trigger()
        assert "Drive a link by a motion" in user.window.status.currentMessage()
    view = user.window.show_view("laws")
    wait_for(lambda: view.up_to_date)
    assert not view.in_trouble
    assert not view.use_button.isEnabled()  # type: ignore[attr-defined]
    user.choose("Stability", "Flexible shaft")
    assert "this design has none" in user.window.status.currentMessage()
    assert user.steps == []


# -- which link leads, and where the roller is ------------------------------------------------------------


def stands(user: User) -> dict[str, complex]:
    """Where every point stands [mm]."""
    study = user.session.at(user.window.player.theta)
    return {name: complex(z[0]) * 1e3 for name, (z, _) in study.points().items()}  # type: ignore[attr-defined]


def test_another_link_leads_and_the_drawing_stays(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    user.window.player.set_theta(1.0)
    before, crank = stands(user), user.design
    assert user.entries("Compo", "Driver") == [
        "Link 2 turns at constant speed",
        "Link 2 follows a motion",
        "Link 4 turns at constant speed",
        "Link 4 follows a motion",
    ]
    user.choose("Compo", "Driver", "Link 4 follows a motion")
    assert user.design.drive.is_linkage
    assert user.design.drive.motion is not None
    assert user.window.player.theta == 0.0
    assert stands(user) == pytest.approx(before, abs=1e-3)
    assert user.steps == ["Drive link 4 by a motion"]
    user.choose("Compo", "Driver", "Link 2 turns at constant speed")
    assert stands(user) == pytest.approx(before, abs=1e-3)
    assert user.window.player.theta == pytest.approx(1.0, abs=1e-6)
    assert user.design.drive.mechanism == crank.drive.mechanism
    user.session.stack.undo()
    user.session.stack.undo()
    assert user.design == crank


def test_a_cam_that_goes_with_its_motion_is_named_and_comes_back(same_window: Open) -> None:
    """The driver's ranges move the angle before the plots show the new design."""
    user = same_window(example("four_bar_coupler_cam"))
    user.turn(270.0)
    before = user.design
    entry = ("Compo", "Driver", "Link 4 turns at constant speed")
    assert user.action(*entry).statusTip().endswith("removes its motion and its cam")
    user.choose(*entry)
    assert user.design.drive.motion is None
    assert user.design.drive.cam is None
    assert user.window.status.currentMessage().startswith(
        "Drive link 4 at constant speed: removed its motion and its cam"
    )
    assert user.steps == ["Drive link 4 at constant speed, without its motion and its cam"]
    user.choose("Edit", f"Undo {user.steps[0]}")
    assert user.design == before
    user.choose("Edit", f"Redo {user.steps[0]}")
    assert user.design.drive.cam is None


def test_the_roller_asks_for_a_motion_first(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    assert user.entries("Compo", "Cam roller") == ["No cam", "A on link 2", "B on link 3", "C on link 3"]
    action = user.action("Compo", "Cam roller", "C on link 3")
    assert not action.isEnabled()
    assert action.statusTip() == "First drive a link by a motion: Compo > Driver"


Step = Callable[[User], None]


@pytest.mark.parametrize(
    ("name", "driver", "roller"),
    spread(
        [
            ("watt_six_bar", "Link 6 follows a motion", "C on link 4"),
            ("slider_crank", "Link 4 follows a motion", "B on link 3"),
        ],
        1,
    ),
)
def test_a_roller_rides_on_any_link_of_any_linkage(name: str, driver: str, roller: str, same_window: Open) -> None:
    user = same_window(example(name))
    user.window.player.set_theta(1.0)
    user.choose("Compo", "Driver", driver)
    user.choose("Compo", "Cam roller", roller)
    assert user.action("Compo", "Cam roller", roller).isChecked()
    view = user.window.view("mechanism")
    view.pull()  # type: ignore[union-attr]
    scene = view.scene  # type: ignore[union-attr]
    for part in ("cam", "roller", "pitch"):
        assert scene.item(part).isVisible()
    point = roller.partition(" ")[0]
    for theta in (0.0, 2.0, 4.0):
        user.window.player.set_theta(theta)
        settle()
        at = scene.item("roller").pos()
        assert complex(at.x(), at.y()) == pytest.approx(stands(user)[point], abs=0.5)
    user.choose("Compo", "Cam roller", "No cam")
    assert user.design.drive.cam is None
    assert user.faults == []


def test_menus_of_linkages_are_not_there_for_a_cam(same_window: Open) -> None:
    user = same_window()
    assert not {"Driver", "Cam roller"} & set(user.entries("Compo"))


def test_keys_of_a_motion_go_nowhere_where_there_is_none(same_window: Open) -> None:
    """The stroke that was shown for the design before is out of sight; Make > Stroke does not choose it."""
    user = same_window(example("four_bar_coupler_cam"))
    box = user.number("motion.stroke_deg")
    user.window.documents.open_example(example("lecture_six_bar"))
    settle()
    before = user.design
    user.choose("Make", "Stroke")
    assert not box.hasFocus()
    for key in (Qt.Key.Key_PageDown, Qt.Key.Key_Up):
        QTest.keyClick(box, key)  # as where the focus has stayed
    settle()
    assert user.design is before


@pytest.mark.stress
def test_a_driver_that_takes_long_can_be_given_up(same_window: Open) -> None:
    """The last link of Stephenson's chain leads a group of four: each way to put it together is followed all round."""
    user = same_window(example("stephenson_six_bar"))
    user.turn(50.0)
    before = user.design

    def give_up() -> None:
        dialog = user.window.findChild(QProgressDialog)
        if dialog is not None:
            timer.stop()
            dialog.canceled.emit()

    timer = QTimer(user.window, interval=10)
    timer.timeout.connect(give_up)
    timer.start()
    user.choose("Compo", "Driver", "Link 6 turns at constant speed")
    assert not timer.isActive(), "a dialog came while it was computed"
    assert user.design is before
    assert "Cancelled" in user.window.status.currentMessage()
