"""The lessons play to the letter; a step that fails is named; a user who does what a step says is led on."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QMenu
from sampled import spread, stressed
from shiboken6 import delete, isValid
from window_user import Open, User, plain, settle, wait_for

from kindyna_gui.__main__ import main
from kindyna_gui.places import lesson_files, lessons
from kindyna_gui.window.tutorial import TutorialStrip

STEPS = {"lift": 10, "linkage": 8, "camshaft": 8, "valve_train": 9}


def play(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, list[str]]:
    code = main(["--headless", "tutorial", *arguments])
    out = capsys.readouterr()
    return code, (out.out + out.err).splitlines()


@pytest.mark.stress
@pytest.mark.parametrize("name", spread(list(STEPS), 1))
def test_a_lesson_plays_to_its_end_with_mouse_and_keys(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, lines = play(capsys, name, "--play")
    assert code == 0, lines
    assert [line.partition(":")[0] for line in lines] == [f"ok {n + 1}" for n in range(STEPS[name])]


def test_every_lesson_is_offered_and_its_pictures_are_there() -> None:
    assert [name for name, _ in lessons()] == list(STEPS)
    for file in lesson_files():
        for number in range(1, STEPS[file.stem] + 1):
            picture = QImage(str(file.parent.parent / "help" / f"tutorial_{file.stem}_{number:02}.webp"))
            assert (picture.width(), picture.height()) == (1280, 720), number


STEP = '[[steps]]\ntext = "Bigger."\ndo = {{ {do} }}\nuntil = {{ {until} }}\n'
RADIUS = 'path = ["cam.base_radius_mm", 410.0]'


@pytest.mark.parametrize(
    ("do", "until", "said"),
    [
        ('field = "cam.base_radius_mm", keys = ["409", "Return"]', RADIUS, "step 1 of 1: conditions of until"),
        stressed('menu = "Kine > Fly"', RADIUS, "Fly: no such entry"),
        stressed('field = "cam.nowhere"', 'path = ["cam.base_radius_mm", 400.0]', "are met before the step is done"),
        ('dialog = ["Kine > Play", "Esc"]', RADIUS, "Kine > Play: opens no dialog"),
        stressed('drag = ["Z9"]', RADIUS, "Z9: the drawing has no such point"),
    ],
)
def test_a_step_that_fails_is_named(
    do: str, until: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kindyna_gui.window.tutorial_steps.PATIENCE", 0.3)
    file = tmp_path / "own.toml"
    file.write_text(STEP.format(do=do, until=until), "utf-8")
    code, lines = play(capsys, str(file), "--play")
    assert code == 1
    assert said in lines[-1]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "needs [[steps]]"),
        ("[[steps]", "own.toml"),
        (STEP.format(do='fly = "up"', until=RADIUS), "steps[0]: fly is unknown; allowed are menu, field, drag"),
        (STEP.format(do='menu = "Kine > Play"', until="moon = true"), "steps[0]: moon is unknown"),
        ('[[steps]]\ntext = "Bigger."\n', "steps[0]: needs text"),
    ],
)
def test_a_file_that_is_no_lesson_is_refused(
    text: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "own.toml"
    file.write_text(text, "utf-8")
    code, lines = play(capsys, str(file), "--play")
    assert code == 2
    assert said in lines[-1]
    assert "tutorial kite: not found" in play(capsys, "kite", "--play")[1][-1]


@pytest.mark.stress
def test_who_does_what_a_step_says_is_led_on(open_user: Open) -> None:
    """By the menu into the lesson; each step at the window itself; a mark where; Do it for me; Leave."""
    user = open_user(size=(1280, 720), whole=True)
    user.choose("Help", "Tutorial", dict(lessons())["lift"])
    strip = user.window.findChild(TutorialStrip)
    assert isinstance(strip, TutorialStrip)
    assert strip.isVisible()
    assert "Kine > Play" in strip.text.text()
    bar = user.window.menuBar()
    kine = next(action for action in bar.actions() if plain(action.text()) == "Kine")
    assert isinstance(kine.menu(), QMenu)
    (mark,) = strip.marks
    assert mark.geometry().contains(bar.mapTo(user.window, bar.actionGeometry(kine).center()))
    user.choose("Kine", "Play")
    wait_for(lambda: strip.number == 1)
    user.window.setFocus()
    user.press(Qt.Key.Key_Space)
    wait_for(lambda: strip.number == 2)
    QTest.mouseClick(strip.done, Qt.MouseButton.LeftButton)
    wait_for(lambda: strip.number == 3)
    assert user.design.drive.motion.segments[1].rise == -140.0
    user.choose("View", "Dyna")  # something else first: the step waits
    settle()
    assert strip.number == 3
    user.choose("View", "Kine")
    wait_for(lambda: strip.number == 4)
    QTest.mouseClick(strip.leave, Qt.MouseButton.LeftButton)
    settle()
    assert user.window.findChild(TutorialStrip) is None or not strip.isVisible()
    assert user.faults == []


def begin(user: User, name: str) -> TutorialStrip:
    user.choose("Help", "Tutorial", dict(lessons())[name])
    strip = user.window.findChild(TutorialStrip)
    assert isinstance(strip, TutorialStrip)
    return strip


def test_the_keys_that_are_played_do_not_press_the_button_that_plays_them(open_user: Open) -> None:
    """Space is the second step, and would press what has the focus."""
    user = open_user(size=(1280, 720), whole=True)
    strip = begin(user, "lift")
    for number in (1, 2):
        QTest.mouseClick(strip.done, Qt.MouseButton.LeftButton)
        wait_for(lambda number=number: strip.number == number)  # type: ignore[misc]
    assert strip.isEnabled()


def test_a_mark_goes_with_its_dock_and_the_lesson_stays(open_user: Open) -> None:
    """The place of a step stands in a dock that floats; what is put there goes with it."""
    user = open_user(size=(1280, 720), whole=True)
    strip = begin(user, "lift")
    strip.number = 5  # a limit, among the parameters
    dock = user.window.docks["parameters"]
    user.see("parameters")
    dock.setFloating(True)
    settle()
    QTest.mouseClick(strip.where, Qt.MouseButton.LeftButton)
    settle()
    (mark,) = (each for each in strip.marks if each.window() is dock)
    delete(mark)  # as its window does that goes
    strip.check()
    QTest.mouseClick(strip.leave, Qt.MouseButton.LeftButton)
    settle()
    left = user.window.findChild(TutorialStrip)
    assert left is None or not left.isVisible()


@pytest.mark.parametrize("how", ["leave", "another"])
def test_a_tutorial_ended_while_it_performs_a_step_ends_quietly(how: str, open_user: Open) -> None:
    user = open_user(size=(1280, 720), whole=True)
    strip = begin(user, "lift")

    def end() -> None:
        if how == "leave":
            strip.end()
        else:
            user.window.begin_tutorial("linkage")

    strip.number = 4  # keys and a word after another
    QTimer.singleShot(0, end)
    QTest.mouseClick(strip.done, Qt.MouseButton.LeftButton)
    settle()
    assert user.faults == []
    assert not isValid(strip) or not strip.isVisible()
