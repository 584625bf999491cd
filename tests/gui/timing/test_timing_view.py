"""The timing chart in the window: each drag and each row is one step of the undo stack; the list, overlaps, files."""

from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from sampled import spread
from window_user import Open, User, settle

from core.design import (
    NamedCurve,
    PolynomialCurve,
    PolynomialEnd,
    SplineCurve,
    SplinePoint,
    distances,
    events,
    with_motion,
)
from kindyna_gui import dialogs
from kindyna_gui.places import example
from kindyna_gui.timing_view import TimingView

FEED, CLAMP, LIFT, TORQUE = range(4)
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


def seen(user: User) -> TimingView:
    view = user.window.show_view("timing")
    settle()
    assert isinstance(view, TimingView)
    return view


def draw(view: TimingView, place: QPoint, degrees: float, keys: Qt.KeyboardModifier = NONE) -> None:
    pixels = round(degrees * view.canvas.chart.degree)
    QTest.mousePress(view.canvas, LEFT, keys, place)
    for part in (pixels // 2, pixels):
        QTest.mouseMove(view.canvas, place + QPoint(part, 0))
        settle()
    QTest.mouseRelease(view.canvas, LEFT, keys, place + QPoint(pixels, 0))
    settle()


def band(view: TimingView, drive: int, angle: float) -> QPoint:
    chart = view.canvas.chart
    return QPointF(chart.x(angle), chart.box(drive).center().y()).toPoint()


CURVES = {
    "constant velocity": NamedCurve("constant-velocity"),
    "polynomial": PolynomialCurve(PolynomialEnd(0.0, 0.0), PolynomialEnd(0.0, 0.0)),
    "spline": SplineCurve((SplinePoint(20.0, 60.0),)),
}


@pytest.mark.parametrize("curve", spread(CURVES, 1))
def test_a_segment_that_is_split_stays_on_the_chart(same_window: Open, curve: str) -> None:
    user = same_window(example("transfer_unit"))
    view, session = seen(user), user.session
    motion = session.design.drive.motion
    first, *others = motion.segments
    changed = replace(motion, segments=(replace(first, curve=CURVES[curve]), *others))
    session.put(with_motion(session.design, changed), "Curve")
    user.choose("Make", "Split segment")
    settle()
    joins = view.canvas.chart.bands[FEED].joins
    assert len(joins) == len(others) + 2
    assert (joins[1] - joins[0]) % 360.0 == pytest.approx(first.span_deg / 2.0)
    assert user.faults == []


def test_a_drag_is_one_step_and_the_other_drives_are_not_computed_anew(same_window: Open) -> None:
    user = same_window(example("transfer_unit"))
    view, session = seen(user), user.session
    study = session.study
    draw(view, band(view, CLAMP, 180.0), -15.0)
    assert session.full_design.drives[CLAMP].phase_deg == 234.5, "it stops at what must be kept"
    assert user.steps == ["Turn Clamp to 234.5°"]
    assert session.study is study, "the feed, which is shown, has not moved"
    assert not session.drag_source
    place = view.canvas.chart.join_position(FEED, 3).toPoint()
    draw(view, place, -20.0)
    assert events(session.full_design)["Feed.return.1.end"] == pytest.approx(206.0, abs=0.5)
    assert len(user.steps) == 2
    assert session.study is not study
    session.stack.undo()
    session.stack.undo()
    assert session.full_design.drives[CLAMP].phase_deg == 238.0
    QTest.mouseClick(view.canvas, LEFT, NONE, band(view, LIFT, 180.0))
    settle()
    assert session.chosen == LIFT
    assert view.canvas.chosen == LIFT


def test_an_edit_that_leaves_the_timing_as_it_is_leaves_the_chart(same_window: Open) -> None:
    user = same_window(example("transfer_unit"))
    view, session = seen(user), user.session
    chart = view.canvas.chart
    assert session.edit("follower.arm_mm", 505.0, "Change arm")
    settle()
    assert view.up_to_date
    assert view.canvas.chart is chart
    draw(view, band(view, CLAMP, 180.0), -2.0)
    assert session.full_design.drives[FEED].mechanism.arm_mm == 505.0, (
        "what is drawn here is put into the design at hand"
    )
    assert view.canvas.chart is not chart
    assert session.edit("shaft.speed_rpm", 25.0, "Change speed")
    settle()
    view.set_unit("ms")
    assert view.canvas.chart.degrees_and_ms(90.0).endswith("600.0 ms")
    view.set_unit("deg")


def test_rows_are_added_changed_moved_and_removed(same_window: Open) -> None:
    user = same_window(example("transfer_unit"))
    view, session = seen(user), user.session
    rows = view.rows
    rows.buttons["add"].click()
    settle()
    added = session.full_design.timing[6]
    assert (added.first, added.second) == ("Feed.rise.1.end", "Lift.return.1.start"), (
        "what follows next on another drive"
    )
    assert rows.list.currentIndex().row() == 6
    rows.first.setCurrentIndex(rows.first.findData("Clamp.return.1.end"))
    rows.first.activated.emit(rows.first.currentIndex())
    rows.second.setCurrentIndex(rows.second.findData("Torque.return.1.start"))
    rows.second.activated.emit(rows.second.currentIndex())
    assert rows.least is not None
    rows.least.setFocus()
    rows.least.selectAll()
    user.type("165")
    user.press(Qt.Key.Key_Return)
    assert session.full_design.timing[6].least_deg == 165.0
    assert distances(session.full_design)[6].spare_deg == pytest.approx(-4.5)
    assert rows.list.rows.rows[6].tip.startswith("4.5° too early")
    rows.least.selectAll()
    user.type("400")
    user.press(Qt.Key.Key_Return)
    assert rows.least.is_refused
    assert rows.message.text() == "Outside its range; allowed: −360 ... 360 °, not 400°"
    assert list(rows.message.buttons) == ["Use 360°", "Back to 165°"]
    QTest.mouseClick(rows.message.buttons["Use 360°"], Qt.MouseButton.LeftButton)
    assert (session.full_design.timing[6].least_deg, rows.least.is_refused) == (360.0, False)
    session.stack.undo()
    assert session.full_design.timing[6].least_deg == 165.0, "one step"
    rows.least.selectAll()
    user.type("400")
    user.press(Qt.Key.Key_Return)
    user.press(Qt.Key.Key_Escape)
    assert not rows.least.is_refused
    assert rows.message.text() == ""
    rows.buttons["up"].click()
    assert session.full_design.timing[5].least_deg == 165.0
    rows.buttons["remove"].click()
    assert len(session.full_design.timing) == 6
    before = user.steps
    assert before[-4:] == [
        "Let Torque return 1 start follow Clamp return 1 end by 0°",
        "Let Torque return 1 start follow Clamp return 1 end by 165°",
        "Move a sequence condition",
        "Remove a sequence condition",
    ]
    for _ in before:
        session.stack.undo()
    assert len(session.full_design.timing) == 6


def test_rows_that_contradict_each_other_are_named_under_the_list(same_window: Open) -> None:
    user = same_window(example("transfer_unit"))
    view = seen(user)
    view.canvas.condition_drawn.emit("Lift.rise.1.start", "Clamp.rise.1.end")  # against the sixth
    settle()
    text = view.rows.message.text()
    assert "conditions 6, 7" in text
    assert "5° more than a turn has" in text
    user.window.status.count_findings()
    assert user.window.status.findings.text() == "2 errors", (
        "the row that is broken, and those that contradict each other"
    )
    user.window.focus_field("timing[2]")
    assert view.canvas.row == 2


def test_where_two_drives_move_together_is_summed(same_window: Open) -> None:
    user = same_window(example("transfer_unit"))
    view = seen(user)
    for box, name in zip(view.pair, ("Lift", "Torque"), strict=True):
        box.setCurrentText(name)
        box.activated.emit(box.currentIndex())
    assert view.overlap.text().split() == ["83°", "691.7", "ms"]
    draw(view, band(view, TORQUE, 150.0), 41.5)
    assert view.overlap.text().split()[0] == "never"
    view.pair[1].setCurrentText("Feed")
    view.pair[1].activated.emit(view.pair[1].currentIndex())
    assert view.overlap.text() == "never"


def test_the_axis_turns_the_machine_and_the_chart_goes_into_a_file(
    same_window: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    user = same_window(example("transfer_unit"))
    view = seen(user)
    view.set_unit("ms")
    chart = view.canvas.chart
    QTest.mouseClick(view.canvas, LEFT, NONE, QPointF(chart.x(90.0), chart.height - 6.0).toPoint())
    settle()
    assert user.window.player.machine == pytest.approx(1.5708, abs=0.02)
    assert view.canvas.machine == pytest.approx(90.0, abs=1.0)
    monkeypatch.setattr(dialogs, "timing_to_save", lambda *_: tmp_path / "chart.svg")
    user.choose("File", "Export", "Timing chart...")
    assert "Time [ms] at 20 rpm" in (tmp_path / "chart.svg").read_text("utf-8")


def test_one_drive_alone_has_a_chart_of_its_motion(same_window: Open) -> None:
    user = same_window()
    view = seen(user)
    assert not view.rows.isVisible()
    draw(view, view.canvas.chart.join_position(0, 1).toPoint(), -10.0)
    assert user.design.drive.motion is not None
    assert user.design.drive.motion.segments[0].span_deg == pytest.approx(25.0, abs=0.6)
    assert len(user.steps) == 1
