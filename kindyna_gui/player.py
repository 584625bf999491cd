"""The player: one cam angle for every view, moved by hand or by time; the speeds it offers, and the keys that move it."""

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
TINY = 1e-6  # [rad] from a dead centre, where velocities grow without limit


def _edge(place: float, inwards: float) -> float:
    """An end of a range, a hair inside where it is a dead centre."""
    return place if place in (0.0, TURN) else place + inwards * TINY


class Player(QObject):
    """Plays turns of the cam.

    theta    cam angle of the drive that is shown [rad], 0 ... 2π
    turn     whole turns since the angle or the design was last set by hand; backwards below 0
    machine  machine angle of the shaft that turns several drives [rad], 0 ... 2π; the same where there is one
    speed    1 plays in true time, at the speed of the shaft given by ``omega``
    forward  False plays backwards
    ranges   where the angle can go [rad], in rising order; everywhere where none is named
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
        self._phase, self._sense = 0.0, 1.0
        self.ranges: tuple[tuple[float, float], ...] = ()
        self._clock = QElapsedTimer()
        self._timer = QTimer(self, interval=FRAME_MS)
        self._timer.timeout.connect(self._tick)

    @property
    def playing(self) -> bool:
        """Whether the angle runs by itself."""
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
        """Go to a cam angle [rad] of a turn; whole turns are taken off."""
        theta = self._within(_taken_apart(theta)[1])
        if (theta, turn) != (self.theta, self.turn):
            self.theta, self.turn = theta, turn
            self.angle_changed.emit(theta)

    def _go_on(self, theta: float) -> None:
        """Go on to a cam angle [rad]; whole turns are counted."""
        self.set_theta(theta, self.turn + _taken_apart(theta)[0])

    @property
    def machine(self) -> float:
        """The machine angle at hand [rad]."""
        return self.machine_of(self.theta)

    def machine_of(self, theta: float) -> float:
        """The machine angle at which the drive that is shown stands at an angle of its own [rad]."""
        return (self._phase + self._sense * theta) % TURN

    def set_machine(self, machine: float) -> None:
        """Go to a machine angle [rad]."""
        self.set_theta(self._sense * (machine - self._phase))

    def show_drive(self, phase: float, sense: float) -> None:
        """Another drive is shown, whose own angle is sense·(machine angle - phase); the machine stands still."""
        if (phase, sense) != (self._phase, self._sense):
            machine = self.machine
            self._phase, self._sense = phase, sense
            self.set_machine(machine)

    def set_ranges(self, ranges: tuple[tuple[float, float], ...]) -> None:
        """Keep the angle within these ranges; it goes to the nearest allowed angle."""
        self.ranges = ranges
        self.set_theta(self.theta)

    def _within(self, theta: float) -> float:
        """The nearest allowed angle, a hair off the dead centres."""
        if not self.ranges:
            return theta
        kept = [min(max(theta, _edge(low, 1.0)), _edge(high, -1.0)) for low, high in self.ranges]
        return min(kept, key=lambda place: abs((place - theta + pi) % TURN - pi))

    def step(self, degrees: float) -> None:
        """Move by so many degrees, forward positive; playing stops."""
        self.play(False)
        # whole steps stay whole: 0.1 degrees a thousand times is 100 degrees
        self._go_on(round(self.theta * 180.0 / pi + degrees, 9) * pi / 180.0)

    def set_speed(self, speed: float) -> None:
        if speed != self.speed:
            self.speed = speed
            self.speed_changed.emit(speed)

    def set_forward(self, forward: bool) -> None:
        if forward != self.forward:
            self.forward = forward
            self.forward_changed.emit(forward)

    def advance(self, seconds: float) -> None:
        """Move on by a time, as a frame does."""
        direction = 1.0 if self.forward else -1.0
        wanted = self.theta + direction * self.speed * self.omega * seconds
        self._go_on(wanted)
        if self.ranges and abs((self.theta - wanted + pi) % TURN - pi) > TINY:  # at a dead centre it swings back
            self.set_forward(not self.forward)

    def _tick(self) -> None:
        self.advance(self._clock.restart() / 1000.0)


def _taken_apart(theta: float) -> tuple[int, float]:
    """Whole turns, and the rest [rad], 0 ... 2π."""
    turns, rest = divmod(theta, TURN)
    return (int(turns), rest) if rest < TURN else (int(turns) + 1, 0.0)  # what lies below 0 by less than rounding


LEAST_TURN, LONGEST_TURN = 0.5, 120.0  # seconds per turn that are offered
CALM, PATIENT = 2.0, 12.0  # a turn in true time that takes so many seconds is played so
USUAL_TURN = 4.0  # else about so many


@frozen
class Speed:
    """Part of the shaft's own speed, and what a turn takes then [s]."""

    part: Fraction
    seconds: float


@lru_cache(maxsize=8)
def speeds(omega: float) -> tuple[Speed, ...]:
    """The speeds offered for a shaft that turns at omega [rad/s] either way, the slowest first; true time is always among them."""
    steps = [Fraction(m) * Fraction(10) ** e for e in range(-8, 5) for m in (1, 2, 5)]
    true_turn = 2.0 * pi / abs(omega)
    offered = [Speed(part, true_turn / float(part)) for part in steps]
    return tuple(s for s in offered if LEAST_TURN <= s.seconds <= LONGEST_TURN or s.part == 1)


def usual(omega: float) -> Speed:
    """The speed to begin with: true time where it can be watched, else what comes near a few seconds."""
    rows = speeds(omega)
    true = next(s for s in rows if s.part == 1)
    if CALM <= true.seconds <= PATIENT:
        return true
    return min(rows, key=lambda s: max(s.seconds / USUAL_TURN, USUAL_TURN / s.seconds))


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


def step_of(modifiers: Qt.KeyboardModifier) -> float:
    """Degrees of a step with these modifiers; 0 where they mean something else."""
    return DEGREES.get(modifiers & ~Qt.KeyboardModifier.KeypadModifier, 0.0)


def obey(player: Player, event: QKeyEvent) -> bool:
    """Act on a key that moves the cam; False where the key is no such one."""
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
