"""Where a displacement diagram can be taken hold of, and what a pull at it makes of a join. No Qt, pixels in, values
out."""

from __future__ import annotations

import math
from collections.abc import Iterator
from math import hypot

from core.design import Motion, join_angles, join_levels, join_range
from core.design.edits import is_dwell
from core.frozen import frozen
from kindyna_gui.pictures.units import nice_below

POINT, LINE, LEVEL = "point", "line", "level"
REACH, LINE_REACH = 7.0, 4.0  # pixels from a point, from a line
AWAY = 8.0  # a dwell's line begins so many pixels from its ends, which belong to the points
TREMBLE = 3.0  # pixels that a hand may tremble in a direction that it does not mean
ANGLE_STEP = 0.5  # degrees
LEVEL_PIXELS = 2.5  # the most that a step of levels, 1, 2 or 5 times a power of ten, is high
FINE = 0.1  # of the travel, and of the steps


@frozen
class Grip:
    """Something to take hold of: a join's point (angle and level), the line through it (its angle), or the level line
    of a dwell. ``segment``: of a dwell's line the dwell, else the segment before the join."""

    kind: str
    join: int
    segment: int

    @property
    def turns(self) -> bool:
        """Whether it can be drawn along the cam angle."""
        return self.kind != LEVEL and self.join > 0

    @property
    def lifts(self) -> bool:
        """Whether it can be drawn to another level."""
        return self.kind != LINE


@frozen
class DiagramScale:
    """How the diagram is laid out: pixels from ``left`` to ``right`` are 0 ... 360 degrees, from ``bottom`` up to
    ``top`` (pixels count downwards) the levels ``low`` ... ``high``."""

    left: float
    right: float
    top: float
    bottom: float
    low: float
    high: float

    def x(self, angle: float) -> float:
        return self.left + angle / 360.0 * (self.right - self.left)

    def y(self, level: float) -> float:
        return self.bottom - (level - self.low) / (self.high - self.low) * (self.bottom - self.top)

    def angle(self, x: float) -> float:
        return min(max((x - self.left) / self.degree, 0.0), 360.0)

    @property
    def degree(self) -> float:
        """Pixels that are one degree."""
        return max(self.right - self.left, 1.0) / 360.0

    @property
    def unit(self) -> float:
        """Pixels that are one unit of level."""
        return max(self.bottom - self.top, 1.0) / (self.high - self.low)

    @property
    def level_step(self) -> float:
        """A round step of levels that a hand can aim at."""
        return nice_below(LEVEL_PIXELS / self.unit)


def places(motion: Motion, scale: DiagramScale) -> Iterator[tuple[int, float, float]]:
    """Every join and where it stands [pixels]; join 0 stands at both ends."""
    levels = join_levels(motion)
    for join, angle in enumerate(join_angles(motion)):
        yield join, scale.x(angle), scale.y(levels[join])
    yield 0, scale.x(360.0), scale.y(levels[0] + motion.gain)


def grip_at(motion: Motion, scale: DiagramScale, x: float, y: float) -> Grip | None:
    """What the mouse would take hold of: the nearest point, else the nearest line, else the level line of a dwell."""
    joins_at, last = list(places(motion, scale)), len(motion.segments) - 1
    away, join = min((hypot(x - px, y - py), join) for join, px, py in joins_at)
    if away <= REACH:
        return Grip(POINT, join, join - 1 if join else last)
    if not scale.top <= y <= scale.bottom:
        return None
    lines = [(abs(x - px), join) for join, px, _ in joins_at if join > 0]
    away, join = min(lines, default=(math.inf, 0))
    if away <= LINE_REACH:
        return Grip(LINE, join, join - 1)
    for i, segment in enumerate(motion.segments):
        _, begin, level = joins_at[i]
        if is_dwell(segment) and begin + AWAY < x < joins_at[i + 1][1] - AWAY and abs(y - level) <= LINE_REACH:
            return Grip(LEVEL, i, i)
    return None


def segment_at(motion: Motion, angle: float) -> int:
    """The segment at a cam angle [deg]; at a join the one behind it."""
    return max(i for i, begin in enumerate(join_angles(motion)) if begin <= angle)


def snapped(value: float, step: float, direction: int = 0) -> float:
    """The nearest multiple of a step, or the next one up (direction 1) or down (-1), in decimals."""
    count = value / step
    whole = {0: round(count), 1: math.floor(count + 1e-6) + 1, -1: math.ceil(count - 1e-6) - 1}[direction]
    return round(whole * step, 10) + 0.0


def snapped_angle(angle: float) -> float:
    """A cam angle [deg] snapped where it was pointed at; a round one, which was typed or stepped to, stays."""
    typed = round(angle, 2)
    return typed + 0.0 if abs(typed - angle) < 1e-6 else snapped(angle, ANGLE_STEP)


class Pull:
    """One pull at a grip, from the press of the button on: each move of the mouse gives the angle and the level that
    the join shall have, None where it keeps what it had.

    A direction counts once the hand has moved in it by more than it trembles, so a point drawn sideways keeps its
    level. Values snap to steps, ``fine`` ten times finer at a tenth of the travel; ``one_direction``: only in the direction in
    which the hand has moved more. An angle stays between its neighbours.
    """

    def __init__(self, motion: Motion, grip: Grip, scale: DiagramScale) -> None:
        self.motion, self.grip = motion, grip
        self._scale = scale  # as it was: the diagram may grow meanwhile
        self._angle, self._level = join_angles(motion)[grip.join], join_levels(motion)[grip.join]
        self._range = join_range(motion, grip.join)
        self._travel = [0.0, 0.0]  # of the hand, pixels
        self._moved = [0.0, 0.0]  # of the join, pixels
        self._intended = [False, False]

    def move(
        self, dx: float, dy: float, fine: bool = False, one_direction: bool = False
    ) -> tuple[float | None, float | None]:
        """The hand has moved on by so many pixels."""
        for k, by in enumerate((dx, dy)):
            self._travel[k] += by
            self._moved[k] += by * (FINE if fine else 1.0)
            self._intended[k] = self._intended[k] or abs(self._travel[k]) > TREMBLE
        sideways = abs(self._travel[0]) >= abs(self._travel[1])
        turns = self.grip.turns and self._intended[0] and (not one_direction or sideways or not self.grip.lifts)
        lifts = self.grip.lifts and self._intended[1] and (not one_direction or not sideways or not self.grip.turns)
        by = FINE if fine else 1.0
        return self._turned(by) if turns else None, self._lifted(by) if lifts else None

    def _turned(self, by: float) -> float:
        wanted = snapped(self._angle + self._moved[0] / self._scale.degree, ANGLE_STEP * by)
        low, high = self._range
        return min(max(wanted, low), high)

    def _lifted(self, by: float) -> float:
        return snapped(self._level - self._moved[1] / self._scale.unit, self._scale.level_step * by)


def nudged(
    motion: Motion, join: int, scale: DiagramScale, direction: tuple[int, int], fine: bool = False
) -> tuple[float | None, float | None]:
    """Angle and level of a join one step on by keys: -1, 0 or 1 in angle and in level."""
    by = FINE if fine else 1.0
    low, high = join_range(motion, join)
    angle = min(max(snapped(join_angles(motion)[join], ANGLE_STEP * by, direction[0]), low), high)
    level = snapped(join_levels(motion)[join], scale.level_step * by, direction[1])
    return angle if direction[0] and join else None, level if direction[1] else None
