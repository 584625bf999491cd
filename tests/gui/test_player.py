"""kindyna_gui.player: one cam angle for all."""

from math import pi, tau

import pytest
from PySide6.QtWidgets import QApplication
from window_user import wait_for

from kindyna_gui.player import Player


@pytest.fixture
def player(app: QApplication) -> Player:
    return Player()


def test_whole_turns_are_taken_off(player: Player) -> None:
    for theta, kept in ((tau + 1.0, 1.0), (-1.0, tau - 1.0), (tau, 0.0), (-1e-20, 0.0)):
        player.set_theta(theta)
        assert player.theta == pytest.approx(kept)
        assert 0.0 <= player.theta < tau


def test_only_a_new_angle_is_told(player: Player) -> None:
    told: list[float] = []
    player.angle_changed.connect(told.append)
    for theta in (1.0, 1.0, tau + 1.0, 2.0):
        player.set_theta(theta)
    assert told == [1.0, 2.0] or told == pytest.approx([1.0, 1.0, 2.0], rel=1e-12)


def test_steps_add_up(player: Player) -> None:
    for _ in range(1000):
        player.step(0.1)
    assert player.theta * 180.0 / pi == pytest.approx(100.0, abs=1e-12)
    player.step(-100.0)
    assert player.theta == pytest.approx(0.0, abs=1e-14)


def test_time_moves_it_by_speed_and_sense(player: Player) -> None:
    player.omega = 2.0
    player.set_speed(0.5)
    player.advance(0.25)
    assert player.theta == pytest.approx(0.25)
    player.set_forward(False)
    player.advance(0.5)
    assert player.theta == pytest.approx(tau - 0.25)


def test_changes_are_told_once(player: Player) -> None:
    told: list[object] = []
    for signal in (player.playing_changed, player.speed_changed, player.forward_changed):
        signal.connect(told.append)
    for _ in range(2):
        player.play(True)
        player.set_speed(2.0)
        player.set_forward(False)
    player.step(1.0)
    assert told == [True, 2.0, False, False]
    assert not player.playing


def test_playing_turns_the_cam(player: Player) -> None:
    player.omega = 20.0
    player.play()
    wait_for(lambda: player.theta > 0.0)
    player.play(False)
    assert not player.playing


def test_turns_are_counted_until_the_angle_is_set_by_hand(player: Player) -> None:
    player.omega = pi
    for _ in range(5):
        player.advance(1.0)
    assert (player.turn, player.theta) == (2, pytest.approx(pi))
    player.step(-200.0)
    assert player.turn == 1
    player.set_forward(False)
    player.advance(4.0)
    assert player.turn == -1
    player.set_theta(1.0)
    assert player.turn == 0
