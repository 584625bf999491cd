"""Compo > Find a linkage: dyads clicked, the other link as the driver, the present motion as the driver; loaded after taking over."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAction, QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QWidget
from window_user import Open, User, plain, settle, wait_for

from core.study import Study
from core.synthesis import BodyPose, Dyad, Swing, Task
from kindyna_gui.studies.study_view import StudyView
from kindyna_gui.synthesis.find_linkage_view import FindLinkageView

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
OpenTask = Callable[[str], tuple[User, FindLinkageView]]
LEFT = Qt.MouseButton.LeftButton
POSES = ((0.0, 0.0, 0.0), (60.0, 20.0, 30.0), (110.0, 10.0, 60.0))
TASK = Task(kind="poses", poses=tuple(BodyPose(*row) for row in POSES))


@pytest.fixture
def open_task(same_window: Open) -> OpenTask:
    def open(example: str) -> tuple[User, FindLinkageView]:
        user = same_window(EXAMPLES / f"{example}.toml")
        user.choose("Compo", "Find a linkage")
        view = user.window.view("find_linkage")
        assert isinstance(view, FindLinkageView)
        view.show_task(TASK)
        wait_for(view.strip.put_button.isEnabled)
        return user, view

    return open


def canvas(view: FindLinkageView) -> QWidget:
    assert view.sheet.canvas is not None
    return view.sheet.canvas.viewport()


def at(view: FindLinkageView, z: complex) -> QPoint:
    return view.sheet.pixel(z).toPoint()


def texts(view: FindLinkageView) -> list[str]:
    """First line of each card."""
    cards = view.strip.board.list
    return [cards.item(i).text().splitlines()[0] for i in range(cards.count())]


def entry(view: FindLinkageView, text: str) -> QAction:
    return next(action for action in view.strip.board.list.actions() if action.text() == text)


def visible_dyads(view: FindLinkageView) -> list[Dyad]:
    """Dyads whose fixed pivot alone is under the mouse there, on the canvas."""
    pixels = [at(view, dyad.fixed) for dyad in view.sheet.dyads.dyads]
    moving = [at(view, dyad.moving_at(TASK.poses[0])) for dyad in view.sheet.dyads.dyads]
    inside = canvas(view).rect().adjusted(12, 12, -12, -12)

    def is_alone(i: int) -> bool:
        others = [*pixels[:i], *pixels[i + 1 :], *moving]
        return inside.contains(pixels[i]) and all((other - pixels[i]).manhattanLength() > 12 for other in others)

    return [dyad for i, dyad in enumerate(view.sheet.dyads.dyads) if is_alone(i)]


def torque(user: User) -> np.ndarray:
    """Torque (n,) of the driver over the turn [N m]."""
    return np.array(Study(user.design, 360).dynamics.driver)


def test_two_clicked_dyads_are_a_card_and_a_second_click_or_escape_releases_one(open_task: OpenTask) -> None:
    _, view = open_task("four_bar")
    QTest.mouseClick(view.sheet.bar.buttons["dyads"], LEFT)
    assert "two dyads" in view.sheet.bar.prompt.text()
    first, *_, second = visible_dyads(view)
    poses = view.task.poses
    QTest.mouseClick(canvas(view), LEFT, pos=at(view, first.fixed))
    assert view.sheet.dyads.chosen == [first]
    QTest.mouseClick(canvas(view), LEFT, pos=at(view, first.fixed))
    assert not view.sheet.dyads.chosen
    QTest.mouseClick(canvas(view), LEFT, pos=at(view, first.fixed))
    QTest.keyClick(view.sheet.canvas, Qt.Key.Key_Escape)
    assert not view.sheet.dyads.chosen
    count = len(texts(view))
    QTest.mouseClick(canvas(view), LEFT, pos=at(view, first.fixed))
    QTest.mouseClick(canvas(view), LEFT, pos=at(view, second.fixed))
    settle()
    assert not view.sheet.dyads.chosen
    assert len(texts(view)) in (count, count + 1)
    assert "chosen dyads" in texts(view)[0]
    assert view.strip.board.list.currentRow() == 0
    answer = view.strip.answer
    assert answer is not None
    assert set(answer.candidate.linkage.by_number[1].places.values()) == {first.fixed, second.fixed}
    assert answer.error_mm < 1e-9
    assert view.task.poses == poses  # a click on a dyad adds no pose


def test_the_mouse_on_a_pivot_shows_the_link_of_its_dyad(open_task: OpenTask) -> None:
    _, view = open_task("four_bar")
    QTest.mouseClick(view.sheet.bar.buttons["dyads"], LEFT)
    dyad = visible_dyads(view)[0]
    middle = at(view, 0.5 * (dyad.fixed + dyad.moving_at(TASK.poses[0])))
    view.strip.run(False)
    view.sheet.show_answer({})
    QTest.mouseMove(canvas(view), QPoint(3, 3))
    settle()
    before = canvas(view).grab().toImage()
    QTest.mouseMove(canvas(view), at(view, dyad.fixed))
    settle()
    after = canvas(view).grab().toImage()
    near = [middle + QPoint(x, y) for x in range(-2, 3) for y in range(-2, 3)]
    assert any(before.pixel(p) != after.pixel(p) for p in near)


def test_the_other_link_drives_and_the_card_is_judged_again(open_task: OpenTask) -> None:
    _, view = open_task("four_bar")
    before = view.strip.answer
    assert before is not None
    view.strip.board.list.setFocus()
    entry(view, "Drive by the other link").trigger()
    settle()
    after = view.strip.answer
    assert after is not None
    assert after.candidate.linkage.by_number[1].places["O2"] == before.candidate.linkage.by_number[1].places["O4"]
    assert all(f"{defect} defect" in texts(view)[0] for defect in after.defects)


def test_the_present_motion_drives_the_linkage_as_one_step(open_task: OpenTask) -> None:
    user, view = open_task("transfer_lift")
    answer = view.strip.answer
    assert answer is not None
    motion, steps = user.design.drive.motion, user.steps
    assert motion is not None
    QTest.mouseClick(view.strip.motion_button, LEFT)
    settle()
    assert len(user.steps) == len(steps) + 1
    drive = user.design.drive
    assert drive.linkage.links == answer.candidate.linkage.links
    assert drive.linkage.driver.kind == "motion"
    assert drive.motion is not None
    assert [s.span_deg for s in drive.motion.segments] == [s.span_deg for s in motion.segments]
    assert "slider mass" in user.window.status.currentMessage()
    assert np.isfinite(torque(user)).all()
    user.choose("Edit", "Undo Take over a linkage under the motion")
    assert user.design.drive.motion == motion


def test_without_a_motion_the_button_says_why(open_task: OpenTask) -> None:
    _, view = open_task("four_bar")
    assert view.strip.put_button.isEnabled()
    assert not view.strip.motion_button.isEnabled()
    assert "turns at constant speed" in view.strip.motion_button.toolTip()


def test_a_taken_linkage_runs_loaded_between_the_poses(open_task: OpenTask) -> None:
    user, view = open_task("four_bar")
    QTest.mouseClick(view.strip.put_button, LEFT)
    settle()
    user.window.show_task("dyna")
    settle()
    assert 0.01 < np.abs(torque(user)).max() < 10.0
    assert "cannot be calculated" not in user.window.status.findings.text()


@pytest.mark.stress
def test_study_finds_a_better_length_of_a_taken_linkage(open_task: OpenTask) -> None:
    user, view = open_task("four_bar")
    QTest.mouseClick(view.strip.put_button, LEFT)
    settle()
    before, steps = np.abs(torque(user)).max(), user.steps
    label = user.field("linkage.links[3].points.B.x_mm").label
    where = label.rect().center()
    QApplication.sendEvent(label, QContextMenuEvent(QContextMenuEvent.Reason.Mouse, where, label.mapToGlobal(where)))
    menu = QApplication.activePopupWidget()
    assert isinstance(menu, QMenu)
    next(action for action in menu.actions() if plain(action.text()) == "Vary this").trigger()
    menu.close()
    settle()
    study = user.window.view("study")
    assert isinstance(study, StudyView)
    wait_for(lambda: study.on_screen() and study.up_to_date and not study.busy)
    study.tabs.setCurrentIndex(2)
    goal = study.best.goals[0]
    goal.setCurrentIndex(goal.findData("driver_torque_nm:abs"))
    goal.activated.emit(goal.currentIndex())
    settle()
    QTest.mouseClick(study.best.start, LEFT)
    wait_for(lambda: not study.best.busy)
    QTest.mouseClick(study.best.take, LEFT)
    settle()
    assert user.steps == [*steps, "Take over the best design"]
    assert np.abs(torque(user)).max() < before


def coupler_pose(angle: float) -> BodyPose:
    """Pose of the rod of a slider-crank of 40 mm and 120 mm on the x axis, with its origin in the slider's pin."""
    pin = 40.0 * np.exp(1j * angle)
    x = pin.real + np.sqrt(120.0**2 - pin.imag**2)
    return BodyPose(float(x), 0.0, float(np.degrees(np.angle(x - pin))))


def test_a_guide_is_a_line_and_with_a_pin_a_slider_crank(open_task: OpenTask) -> None:
    _, view = open_task("four_bar")
    view.show_task(Task(kind="poses", poses=tuple(coupler_pose(angle) for angle in (0.4, 0.8, 1.3, 1.9, 2.4))))
    wait_for(view.strip.put_button.isEnabled)
    QTest.mouseClick(view.sheet.bar.buttons["dyads"], LEFT)
    view.sheet.fit()
    settle()
    guide = next(dyad for dyad in view.sheet.dyads.dyads if dyad.kind == "guide")
    crank = min(view.sheet.dyads.dyads, key=lambda dyad: abs(dyad.fixed) if dyad.kind == "pin" else np.inf)
    QTest.mouseClick(canvas(view), LEFT, pos=at(view, 60.0 + 0.0j))  # on the line of the guide, away from its pivot
    assert view.sheet.dyads.chosen == [guide]
    QTest.mouseClick(canvas(view), LEFT, pos=at(view, crank.fixed))
    settle()
    answer = view.strip.answer
    assert answer is not None
    assert answer.candidate.kind == "slider-crank"
    assert abs(answer.candidate.linkage.by_number[2].places["A"]) == pytest.approx(40.0, abs=1e-6)
    assert texts(view)[0].startswith("Slider-crank, chosen dyads")
    entry(view, "Drive by the other link").trigger()
    settle()
    assert "sliding pair" in view.form.message.text()


def test_a_card_is_its_linkage_after_others_were_removed_or_sorted(open_task: OpenTask) -> None:
    user, view = open_task("four_bar")
    board = view.strip.board
    board.list.setCurrentRow(1)
    second = view.strip.answer
    board.list.setCurrentRow(0)
    entry(view, "Remove").trigger()
    settle()
    board.list.setCurrentRow(0)
    assert view.strip.answer is second
    QTest.mouseClick(board.compare, LEFT)
    settle()
    wanted = board.order[2].design.drive.linkage.links
    cell = board.table.visualItemRect(board.table.item(3, 0)).center()  # the first row is the current design
    QTest.mouseClick(board.table.viewport(), LEFT, pos=cell)
    QTest.mouseDClick(board.table.viewport(), LEFT, pos=cell)
    settle()
    assert user.design.drive.linkage.links == wanted


def test_a_card_says_that_its_driver_turns_fully(open_task: OpenTask) -> None:
    user, view = open_task("four_bar")
    assert not any("full turn" in text for text in texts(view)[:1])  # the best one swings
    view.show_task(Task(kind="rocker", rocker=Swing(swing_deg=60.0, time_ratio=1.2, frame_mm=100.0)))
    wait_for(lambda: view.strip.put_button.isEnabled() and "full turn" in texts(view)[0])
    QTest.mouseClick(view.strip.put_button, LEFT)
    settle()
    assert user.design.drive.by_crank
    assert 0.001 < np.abs(torque(user)).max() < 10.0
