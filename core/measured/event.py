"""The events of a fitted motion: from where the follower leaves the base circle to where it is back, how long it is above a stated lift,
the ramps at both ends, and where the velocity jumps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from core.design import Motion, join_angles, join_levels
from core.design.edits import is_dwell
from core.frozen import frozen
from core.measured.fitting import MotionFit
from core.measured.table import distinct_angles
from core.motion import Angles, program

USUAL_LIFTS = {"mm": (1.0, 1.27)}
"""Lifts that durations are stated at: 1 mm and 0.05 in."""
SAMPLES = 1440  # of an event
ON_BASE = 1e-3  # of the stroke: a table that is left with a kink swings below it a little
RAMP_HEIGHT, RAMP_SPEED, RAMP_BEND, RAMP_LEAST = 0.12, 0.35, 0.04, 2.0
"""A ramp ends below this share of the lift, is slower than this share of the largest velocity, bends less than this share of the largest
acceleration, and is as long [deg]."""
JUMP = 1e-6  # of the largest velocity
KINK, KINK_ERRORS = 8.0, 40.0  # times the changes of velocity beside it, and the errors that it may come of


@frozen
class Duration:
    """At a lift above the base circle: from cam angle to cam angle [deg], the second counted on past 360."""

    lift: float
    start: float
    end: float


@frozen
class Ramp:
    """Almost constant velocity [per degree] between two cam angles [deg], counted on past 360."""

    start: float
    end: float
    velocity: float


@frozen
class VelocityJump:
    """Where the velocity jumps: cam angle [deg], before and behind, per degree."""

    angle: float
    before: float
    after: float


@frozen
class Event:
    """Off the base circle from start to end [deg], counted on past 360; lift: its highest, in the motion's unit."""

    start: float
    end: float
    lift: float
    durations: tuple[Duration, ...]
    ramps: tuple[Ramp, ...]


def events(fit: MotionFit, lifts: Sequence[float] = ()) -> tuple[Event, ...]:
    """The events of a motion that rests on its base circle, its lowest level; none of one that does not. lifts: where durations are
    wanted; none of them: at the usual ones of the motion's unit. One that the event does not reach is left out."""
    motion = fit.motion
    stroke = fit.stroke
    angles, levels = (*join_angles(motion), 360.0), join_levels(motion)
    still = [i for i, segment in enumerate(motion.segments) if is_dwell(segment)]
    lowest = min((levels[i] for i in still), default=np.inf)
    rests = [(angles[i], angles[i + 1]) for i in still if levels[i] - lowest <= 1e-9 * stroke]
    if lowest - fit.lowest > ON_BASE * stroke or len(rests) == len(motion.segments):
        return ()
    found = []
    for (_, start), (end, _) in pairwise([*rests, (rests[0][0] + 360.0, 0.0)]):
        if end - start > 1e-9:
            turn = 360.0 if start >= 360.0 - 1e-9 else 0.0  # the last rest ends with the turn
            found.append(_event(fit, lowest, start - turn, end - turn, lifts or USUAL_LIFTS.get(motion.unit, ())))
    return tuple(found)


def _event(fit: MotionFit, base: float, start: float, end: float, lifts: Sequence[float]) -> Event:
    x = np.linspace(start, end, SAMPLES + 1)
    s, v, a = (fit.derivative(np.mod(x, 360.0), order) for order in range(3))
    s = s - base
    s[[0, -1]] = 0.0
    durations = []
    for lift in lifts:
        above = np.flatnonzero(s > lift)
        if above.size:
            ends = [_crossing(fit, base + lift, *x[[k - 1, k]]) for k in (above[0], above[-1] + 1)]
            durations.append(Duration(lift, *ends))
    jumps = [jump.angle + turn for jump in velocity_jumps(fit) for turn in (0.0, 360.0)]
    ramps = (_to_jumps(ramp, jumps) for ramp in _ramps(x, s, v, a))
    return Event(start, end, float(s.max()), tuple(durations), tuple(ramps))


def _to_jumps(ramp: Ramp, jumps: Sequence[float]) -> Ramp:
    """A ramp up to where the velocity jumps, which the curve goes round."""
    reach = 0.5 * (ramp.end - ramp.start)
    start, end = (next((at for at in jumps if abs(at - edge) <= reach), edge) for edge in (ramp.start, ramp.end))
    return Ramp(start, end, ramp.velocity)


def _crossing(fit: MotionFit, level: float, low: float, high: float) -> float:
    from scipy.optimize import brentq

    def off(angle: float) -> float:
        return float(fit.derivative(np.mod(np.array([angle]), 360.0), 0)[0]) - level

    return float(brentq(off, low, high, xtol=1e-12))


def _ramps(x: np.ndarray, s: np.ndarray, v: np.ndarray, a: np.ndarray) -> Iterator[Ramp]:
    """Stretches of almost constant velocity, slow and low, the first at each end of an event (n,)."""
    steady = (np.abs(a) <= RAMP_BEND * np.abs(a).max()) & (s <= RAMP_HEIGHT * s.max())
    steady &= (np.abs(v) <= RAMP_SPEED * np.abs(v).max()) & (np.abs(v) >= 1e-3 * np.abs(v).max())
    edges = np.flatnonzero(np.diff(np.concatenate(([False], steady, [False])).astype(int))).reshape(-1, 2)
    for first, behind in edges:
        if x[behind - 1] - x[first] >= RAMP_LEAST:
            yield Ramp(float(x[first]), float(x[behind - 1]), float(np.mean(v[first:behind])))


def velocity_jumps(fit: MotionFit) -> tuple[VelocityJump, ...]:
    """Where the velocity jumps, in order: at joins of the motion, and where the rows have a kink that a table goes round."""
    found, width = _of_the_motion(fit.motion), 3.0 * 360.0 / max(fit.table.angles.size, 1)
    for each in _of_the_rows(fit):
        if all(_apart(each.angle, jump.angle) > width for jump in found):
            found.append(each)
    return tuple(sorted(found, key=lambda jump: jump.angle))


def _apart(a: float, b: float) -> float:
    return abs((a - b + 180.0) % 360.0 - 180.0)


def _of_the_motion(motion: Motion) -> list[VelocityJump]:
    compiled = program(motion)
    count, found = len(compiled.starts), []
    ends = [
        compiled.state(Angles(theta, np.arange(count))).y[1] * np.deg2rad(1.0) / motion.scale
        for theta in (compiled.starts, compiled.ends)
    ]
    mean = sum(abs(segment.rise) for segment in motion.segments) / 360.0  # no end need move at all
    largest = max(mean, *(float(np.abs(end).max()) for end in ends))
    for i in range(count):
        before, after = float(ends[1][i - 1]), float(ends[0][i])
        if abs(after - before) > JUMP * largest:
            found.append(VelocityJump(float(np.rad2deg(compiled.starts[i])), before, after))
    return found


def _of_the_rows(fit: MotionFit) -> Iterator[VelocityJump]:
    """A change of velocity at one row, or between two, that is far larger than those beside it, and than its error."""
    table = fit.table
    used = table.used_rows(fit.left_out)
    x, place = distinct_angles(table.angles[used])
    if table.layout.order or x.size < 12:
        return
    y = np.bincount(place, table.values[used]) / np.bincount(place)
    h = np.diff(np.append(x, x[0] + 360.0))
    v = (np.roll(y, -1) - y) / h  # from each row to the next
    change = v - np.roll(v, 1)  # at each row
    both = change + np.roll(change, -1)  # at it and the next
    beside = np.max([np.abs(np.roll(change, k)) for k in (3, 2, 1, -2, -3, -4)], axis=0)
    error = max(fit.error * abs(table.size), 10.0**-table.decimals * abs(table.size)) / np.minimum(h, np.roll(h, 1))
    largest = np.abs(both) >= np.maximum(np.abs(np.roll(both, 1)), np.abs(np.roll(both, -1)))
    for i in np.flatnonzero(largest & (np.abs(both) > KINK * beside) & (np.abs(both) > KINK_ERRORS * error)):
        behind = (i + 1) % x.size
        angle = float(x[i] + h[i] * np.clip(change[behind] / both[i], 0.0, 1.0))
        yield VelocityJump(angle % 360.0, float(v[i - 1]), float(v[behind]))


__all__ = ["Duration", "Event", "Ramp", "VelocityJump", "events", "velocity_jumps"]
