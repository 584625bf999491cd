"""kindyna_gui.window.player_bar and player: the cam moved by buttons, slider, number, speed and keys."""

from collections.abc import Iterator
from math import degrees, pi, radians

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QToolButton
from window_user import User, settle, wait_for

from core.project import load
from core.study import evaluations
from kindyna_gui.documents.session import Session
from kindyna_gui.look import apply_preferences
from kindyna_gui.places import example
from kindyna_gui.player import Player, initial_speed, speeds, step_of
from kindyna_gui.settings import Preferences
from kindyna_gui.window.player_bar import PlayerBar, speed_text
from kindyna_gui.window.tasks import INSPECTOR

NONE = Qt.KeyboardModifier.NoModifier
SHIFT, CONTROL = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def bar(app: QApplication) -> Iterator[PlayerBar]:
    made = PlayerBar(Session(load(example("transfer_lift"))), Player())
    made.resize(640, made.height())
    made.show()
    assert QTest.qWaitForWindowExposed(made)
    settle()
    yield made
    made.player.play(False)
    made.close()
    made.deleteLater()


def click(button: QToolButton, modifier: Qt.KeyboardModifier = NONE) -> None:
    QTest.mouseClick(button, Qt.MouseButton.LeftButton, modifier)


def angle(bar: PlayerBar) -> float:
    return degrees(bar.player.theta)


def test_large_letters_are_not_cut_in_a_narrow_bar(bar: PlayerBar, app: QApplication) -> None:
    apply_preferences(Preferences(font=125), app)
    bar.resize(INSPECTOR, bar.height())
    settle()
    box = QRect(bar.speed.mapTo(bar, QPoint()), bar.speed.size())
    try:
        assert bar.rect().contains(box)
        assert box.width() >= bar.speed.sizeHint().width()
        assert bar.slider.width() >= 70, "the angle can be dragged"
    finally:
        apply_preferences(Preferences(), app)


# -- buttons ----------------------------------------------------------------------------------------------


def test_play_and_pause(bar: PlayerBar) -> None:
    playing = bar.play.toolTip()
    click(bar.play)
    assert bar.player.playing
    assert bar.play.toolTip() != playing
    wait_for(lambda: angle(bar) > 0.5)
    assert bar.slider.sliderPosition() == pytest.approx(100.0 * angle(bar), abs=1.0)
    click(bar.play)
    assert not bar.player.playing
    assert bar.play.toolTip() == playing


def test_backwards(bar: PlayerBar) -> None:
    click(bar.reverse)
    bar.player.advance(0.1)
    assert angle(bar) > 180.0
    bar.player.set_forward(True)
    assert not bar.reverse.isChecked()


def test_steps_by_buttons(bar: PlayerBar) -> None:
    click(bar.forward)
    click(bar.forward)
    click(bar.back)
    assert angle(bar) == pytest.approx(1.0)
    bar.player.play(True)
    click(bar.forward)
    assert not bar.player.playing


@pytest.mark.parametrize(("modifier", "step"), [(NONE, 1.0), (SHIFT, 0.1), (CONTROL, 10.0)])
def test_modifiers_make_steps_finer_and_coarser(modifier: Qt.KeyboardModifier, step: float, bar: PlayerBar) -> None:
    assert step_of(modifier) == step_of(modifier | Qt.KeyboardModifier.KeypadModifier) == step
    QTest.keyClick(bar, Qt.Key.Key_Right, modifier)
    assert angle(bar) == pytest.approx(step)
    QTest.keyClick(bar, Qt.Key.Key_Left, modifier)
    assert angle(bar) == pytest.approx(0.0, abs=1e-12)


def test_other_modifiers_are_not_the_players(bar: PlayerBar) -> None:
    assert step_of(Qt.KeyboardModifier.AltModifier) == 0.0
    QTest.keyClick(bar, Qt.Key.Key_Right, Qt.KeyboardModifier.AltModifier)
    QTest.keyClick(bar, Qt.Key.Key_Space, CONTROL)
    assert angle(bar) == 0.0
    assert not bar.player.playing


def test_from_join_to_join(bar: PlayerBar) -> None:
    """The lift: 35, 76.5, 283.5, 325 and 360."""
    seen = []
    for _ in range(6):
        click(bar.join_forward)
        seen.append(round(angle(bar), 9))
    assert seen == [35.0, 76.5, 283.5, 325.0, 0.0, 35.0]
    QTest.keyClick(bar, Qt.Key.Key_PageUp)
    QTest.keyClick(bar, Qt.Key.Key_PageUp)
    assert angle(bar) == pytest.approx(325.0)
    bar.player.set_theta(radians(76.4))
    QTest.keyClick(bar, Qt.Key.Key_PageDown)
    assert angle(bar) == pytest.approx(76.5)
    bar.player.set_theta(radians(76.6))
    click(bar.join_back)
    assert angle(bar) == pytest.approx(76.5)


# -- slider and number ------------------------------------------------------------------------------------


@pytest.mark.parametrize("wanted", [0.0, 90.0, 123.0, 359.0])
def test_a_click_on_the_slider_goes_there(wanted: float, bar: PlayerBar) -> None:
    bar.player.set_theta(1.0)
    x = round(bar.slider.position_of(wanted))
    QTest.mouseClick(bar.slider, Qt.MouseButton.LeftButton, pos=QPoint(x, 10))
    assert angle(bar) == pytest.approx(wanted, abs=360.0 / bar.slider.width())


def test_the_slider_is_dragged_and_stops_playing(bar: PlayerBar) -> None:
    bar.player.play(True)
    start, end = (QPoint(round(bar.slider.position_of(a)), 12) for a in (10.0, 200.0))
    QTest.mousePress(bar.slider, Qt.MouseButton.LeftButton, pos=start)
    QTest.mouseMove(bar.slider, end)
    QTest.mouseRelease(bar.slider, Qt.MouseButton.LeftButton, pos=end)
    assert angle(bar) == pytest.approx(200.0, abs=2.0)
    assert not bar.player.playing
    QTest.mouseMove(bar.slider, start)
    assert angle(bar) == pytest.approx(200.0, abs=2.0), "released is released"


def test_beyond_its_ends_the_slider_stays_at_them(bar: PlayerBar) -> None:
    QTest.mouseClick(bar.slider, Qt.MouseButton.LeftButton, pos=QPoint(0, 10))
    assert angle(bar) == 0.0
    QTest.mouseClick(bar.slider, Qt.MouseButton.LeftButton, pos=QPoint(bar.slider.width() - 1, 10))
    assert bar.slider.sliderPosition() in (0, bar.slider.maximum()), "360 is 0"


def test_the_number_is_typed(bar: PlayerBar) -> None:
    bar.activateWindow()
    bar.angle.setFocus()
    bar.angle.selectAll()
    bar.player.play(True)
    QTest.keyClicks(bar.angle, "123.45")
    assert not bar.player.playing, "playing would type over it"
    QTest.keyClick(bar.angle, Qt.Key.Key_Return)
    assert angle(bar) == pytest.approx(123.45)
    assert bar.slider.sliderPosition() == 12345


def test_the_number_follows_without_moving_the_cam(bar: PlayerBar) -> None:
    """It shows two decimals; the cam keeps all."""
    bar.player.set_theta(1.23456789)
    assert bar.player.theta == 1.23456789
    assert bar.angle.value() == pytest.approx(degrees(1.23456789), abs=0.005)


# -- speed ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rpm", [0.1, 1.0, 4.9, 5.1, 20.0, 31.0, 60.0, 300.0, 2900.0, 24000.0])
def test_a_turn_can_be_watched_at_first(rpm: float) -> None:
    omega = rpm * pi / 30.0
    rows, first = speeds(omega), initial_speed(omega)
    assert first in rows
    assert [row.seconds for row in rows] == sorted((row.seconds for row in rows), reverse=True)
    assert sum(row.part == 1 for row in rows) == 1, "true time is always offered"
    for row in rows:
        assert row.seconds == pytest.approx(60.0 / rpm / float(row.part))
        assert row.part == 1 or 0.2 <= row.seconds <= 300.0
    assert 2.0 <= first.seconds <= 12.0
    assert first.part == 1 or not 3.0 <= 60.0 / rpm <= 10.0, "in true time where that can be watched"


def test_the_speeds_say_what_a_turn_takes(bar: PlayerBar) -> None:
    told = [bar.speed.itemText(i) for i in range(bar.speed.count())]
    assert told == [speed_text(row) for row in speeds(bar.session.study.omega)]
    assert bar.speed.currentText() == "true, 3.0 s"
    assert "1/2 ×, 6.0 s" in told
    assert "5 ×, 0.60 s" in told


def test_a_speed_is_chosen(bar: PlayerBar) -> None:
    index = bar.speed.findText("1/2 ×, 6.0 s")
    bar.speed.setCurrentIndex(index)
    bar.speed.activated.emit(index)
    assert bar.player.speed == 0.5
    bar.session.edit("shaft.speed_rpm", 40.0, "a")
    assert bar.player.speed == 0.5, "what was chosen stays through an edit"
    assert bar.speed.currentText() == "1/2 ×, 3.0 s"
    bar.session.start(load(example("card_picker")))
    assert bar.player.speed == float(initial_speed(bar.session.study.omega).part), "another shaft begins anew"


def test_the_speed_set_elsewhere_is_shown(bar: PlayerBar) -> None:
    bar.player.set_speed(2.0)
    assert bar.speed.currentText().startswith("2 ×")


# -- in the window ----------------------------------------------------------------------------------------


def test_keys_that_nobody_wants_are_the_players(user: User) -> None:
    player = user.window.player
    QTest.keyClick(user.window, Qt.Key.Key_Right)
    assert degrees(player.theta) == pytest.approx(1.0)
    QTest.keyClick(user.window, Qt.Key.Key_Space)
    assert player.playing
    assert user.window.actions_by_key["play"].isChecked()
    QTest.keyClick(user.window, Qt.Key.Key_Space)
    assert not player.playing


def test_keys_that_are_typed_are_not_the_players(user: User) -> None:
    name = user.parameters().name
    name.setFocus()
    name.selectAll()
    user.type("A new lift")
    user.press(Qt.Key.Key_Left, Qt.Key.Key_Return)
    assert user.design.name == "A new lift"
    assert not user.window.player.playing
    assert user.window.player.theta == 0.0
    box = user.number("follower.rod_mm")
    box.setFocus()
    user.press(Qt.Key.Key_Right, Qt.Key.Key_Left)
    assert user.window.player.theta == 0.0


def test_the_bar_computes_nothing(bar: PlayerBar) -> None:
    evaluations.clear()
    bar.session.edit("follower.rod_mm", 850.0, "a")
    bar.player.step(1.0)
    assert bar.stages == ()
    assert not evaluations
