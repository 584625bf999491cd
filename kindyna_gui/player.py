"""The player: one cam angle for all views, set by hand or advanced by time; the available speeds, and the keys."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache
from math import pi
from types import MappingProxyType

from PySide6.QtCore import QElapsedTimer, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QKeyEvent

from core.frozen import frozen

TURN = 2.0 * pi
FRAME_MS = 16
TINY = 1e-6  # distance from a dead centre, where velocities have no limit [rad]
LEAST_TURN, LONGEST_TURN = 0.5, 120.0  # range of the available durations of a turn [s]
CALM, PATIENT = 2.0, 12.0  # real time is the initial speed if a turn takes between these durations [s]
TYPICAL_TURN = 4.0  # otherwise the initial speed is the one nearest to this duration [s]

PLAY = Qt.Key.Key_Space
DIRECTIONS: Mapping[int, float] = MappingProxyType({Qt.Key.Key_Left: -1.0, Qt.Key.Key_Right: 1.0})
DEGREES: Mapping[Qt.KeyboardModifier, float] = MappingProxyType(
    {
        Qt.KeyboardModifier.NoModifier: 1.0,
        Qt.KeyboardModifier.ShiftModifier: 0.1,
        Qt.KeyboardModifier.ControlModifier: 10.0,
    }
)
"""Modifier -> degrees of a step by an arrow key."""
KEYS_HELP = "Space plays and pauses; Left and Right step by 1°, with Shift by 0.1°, with Ctrl by 10°"

# -- player ----------------------------------------------------------------------------------------------


class Player(QObject):
    """Plays turns of the cam.

    theta    cam angle of the current drive [rad], 0 ... 2π
    turn     number of turns since the angle or the design was last set by hand; negative backwards
    machine  machine angle of the shaft [rad], 0 ... 2π; equal to theta if there is one drive
    speed    1 plays in real time, with the speed ``omega`` of the shaft
    forward  False plays backwards
    ranges   allowed angles [rad], in rising order; empty if all are allowed
    """

    angle_changed = Signal(float)
    playing_changed = Signal(bool)
    speed_changed = Signal(float)
    forward_changed = Signal(bool)

    def __init__(self) -> None:
        super().__init__()
        self.theta = 0.0
        self.turn = 0
        self.speed = 1.0
        self.forward = True
        self.omega = pi
        self._phase, self._rotation_sign = 0.0, 1.0
        self.ranges: tuple[tuple[float, float], ...] = ()
        self._clock = QElapsedTimer()
        self._timer = QTimer(self, interval=FRAME_MS)
        self._timer.timeout.connect(self._tick)

    @property
    def playing(self) -> bool:
        """Whether the player is playing."""
        return self._timer.isActive()

    def play(self, on: bool = True) -> None:
        """Start or pause."""
        if on == self.playing:
            return
        if on:
            self._clock.start()
            self._timer.start()
        else:
            self._timer.stop()
        self.playing_changed.emit(on)

    def set_theta(self, theta: float, turn: int = 0) -> None:
        """Go to a cam angle [rad], reduced to one turn, in a turn."""
        theta = self._nearest_allowed(_turns_and_angle(theta)[1])
        if (theta, turn) != (self.theta, self.turn):
            self.theta, self.turn = theta, turn
            self.angle_changed.emit(theta)

    def _continue_to(self, theta: float) -> None:
        """Go to a cam angle [rad] and count the turns."""
        self.set_theta(theta, self.turn + _turns_and_angle(theta)[0])

    @property
    def machine(self) -> float:
        """Current machine angle [rad]."""
        return self.machine_of(self.theta)

    def machine_of(self, theta: float) -> float:
        """Machine angle [rad] at a cam angle [rad] of the current drive."""
        return (self._phase + self._rotation_sign * theta) % TURN

    def set_machine(self, machine: float) -> None:
        """Go to a machine angle [rad]."""
        self.set_theta(self._rotation_sign * (machine - self._phase))

    def show_drive(self, phase: float, rotation_sign: float) -> None:
        """Change to a drive of cam angle rotation_sign·(machine angle - phase), at the same machine angle."""
        if (phase, rotation_sign) != (self._phase, self._rotation_sign):
            machine = self.machine
            self._phase, self._rotation_sign = phase, rotation_sign
            self.set_machine(machine)

    def set_ranges(self, ranges: tuple[tuple[float, float], ...]) -> None:
        """Limit the angle to ranges, and go to the nearest allowed angle."""
        self.ranges = ranges
        self.set_theta(self.theta)

    def _nearest_allowed(self, theta: float) -> float:
        """Nearest allowed angle [rad], at a small distance from the dead centres."""
        if not self.ranges:
            return theta
        allowed = [min(max(theta, _inner_end(low, 1.0)), _inner_end(high, -1.0)) for low, high in self.ranges]
        return min(allowed, key=lambda angle: abs((angle - theta + pi) % TURN - pi))

    def step(self, degrees: float) -> None:
        """Move by an angle [deg], forward positive, and stop playing."""
        self.play(False)
        # rounding avoids accumulated errors: 0.1 degrees a thousand times is 100 degrees
        self._continue_to(round(self.theta * 180.0 / pi + degrees, 9) * pi / 180.0)

    def set_speed(self, speed: float) -> None:
        """Set the speed relative to real time."""
        if speed != self.speed:
            self.speed = speed
            self.speed_changed.emit(speed)

    def set_forward(self, forward: bool) -> None:
        """Set the direction of playing."""
        if forward != self.forward:
            self.forward = forward
            self.forward_changed.emit(forward)

    def advance(self, seconds: float) -> None:
        """Move on by a time [s]."""
        direction = 1.0 if self.forward else -1.0
        target = self.theta + direction * self.speed * self.omega * seconds
        self._continue_to(target)
        if self.ranges and abs((self.theta - target + pi) % TURN - pi) > TINY:  # reverse at a dead centre
            self.set_forward(not self.forward)

    def _tick(self) -> None:
        self.advance(self._clock.restart() / 1000.0)


def _inner_end(angle: float, inwards: float) -> float:
    """End of a range, moved inwards if it is a dead centre."""
    return angle if angle in (0.0, TURN) else angle + inwards * TINY


def _turns_and_angle(theta: float) -> tuple[int, float]:
    """Split an angle into whole turns and the remainder [rad], 0 ... 2π."""
    turns, rest = divmod(theta, TURN)
    return (int(turns), rest) if rest < TURN else (int(turns) + 1, 0.0)  # rounding just below 0


# -- speeds ----------------------------------------------------------------------------------------------


@frozen
class Speed:
    """A speed of the player: part of the shaft speed, and duration of a turn [s]."""

    part: Fraction
    seconds: float


@lru_cache(maxsize=8)
def speeds(omega: float) -> tuple[Speed, ...]:
    """Return the available speeds for a shaft speed [rad/s], the slowest first; real time is always one."""
    steps = [Fraction(m) * Fraction(10) ** e for e in range(-8, 5) for m in (1, 2, 5)]
    true_turn = 2.0 * pi / abs(omega)
    rows = [Speed(part, true_turn / float(part)) for part in steps]
    return tuple(s for s in rows if LEAST_TURN <= s.seconds <= LONGEST_TURN or s.part == 1)


def initial_speed(omega: float) -> Speed:
    """Initial speed for a shaft speed [rad/s]: real time if it is easy to watch, else a turn in a few seconds."""
    rows = speeds(omega)
    real_time = next(s for s in rows if s.part == 1)
    if CALM <= real_time.seconds <= PATIENT:
        return real_time
    return min(rows, key=lambda s: max(s.seconds / TYPICAL_TURN, TYPICAL_TURN / s.seconds))


# -- keys ------------------------------------------------------------------------------------------------


def step_of(modifiers: Qt.KeyboardModifier) -> float:
    """Step of an arrow key with modifiers [deg]; 0 if they have another meaning."""
    return DEGREES.get(modifiers & ~Qt.KeyboardModifier.KeypadModifier, 0.0)


def obey(player: Player, event: QKeyEvent) -> bool:
    """Handle a key of the player; False if the key has another meaning."""
    step = step_of(event.modifiers())
    direction = DIRECTIONS.get(event.key(), 0.0)
    if event.key() == PLAY and step == 1.0:
        if not event.isAutoRepeat():
            player.play(not player.playing)
    elif direction and step:
        player.step(direction * step)
    else:
        return False
    event.accept()
    return True
