"""Events of a fitted motion: lift off the base circle and return, durations above a lift, ramps, velocity jumps."""

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

DEFAULT_LIFTS = {"mm": (1.0, 1.27)}
"""Lifts at which durations are stated: 1 mm and 0.05 in."""
SAMPLES = 1440  # per event
ON_BASE = 1e-3  # depth below the base circle relative to the stroke; a fit overshoots where a table has a kink
RAMP_HEIGHT, RAMP_SPEED, RAMP_CURVATURE, RAMP_LEAST = 0.12, 0.35, 0.04, 2.0
"""Limits of a ramp: fractions of the lift, of the largest velocity and of the largest acceleration; least span [deg]."""
JUMP = 1e-6  # least jump relative to the largest velocity
KINK, KINK_ERRORS = 8.0, 40.0  # least jump in units of the neighbouring changes of velocity, and of its error


@frozen
class Duration:
    """Interval above a lift over the base circle: start and end are cam angles [deg], the end may exceed 360."""

    lift: float
    start: float
    end: float


@frozen
class Ramp:
    """Interval of almost constant velocity [per degree]: start and end are cam angles [deg], they may exceed 360."""

    start: float
    end: float
    velocity: float


@frozen
class VelocityJump:
    """Jump of the velocity: cam angle [deg], velocity before and after [per degree]."""

    angle: float
    before: float
    after: float


@frozen
class Event:
    """Interval off the base circle: start and end [deg], the end may exceed 360; greatest lift."""

    start: float
    end: float
    lift: float
    durations: tuple[Duration, ...]
    ramps: tuple[Ramp, ...]


def events(fit: MotionFit, lifts: Sequence[float] = ()) -> tuple[Event, ...]:
    """Events of a motion whose lowest level is a dwell on the base circle; empty for other motions.

    ``lifts`` are the lifts at which durations are stated, by default those of the motion's unit; lifts that an event
    does not reach are omitted.
    """
    motion = fit.motion
    stroke = fit.stroke
    angles, levels = (*join_angles(motion), 360.0), join_levels(motion)
    dwells = [i for i, segment in enumerate(motion.segments) if is_dwell(segment)]
    lowest = min((levels[i] for i in dwells), default=np.inf)
    base_dwells = [(angles[i], angles[i + 1]) for i in dwells if levels[i] - lowest <= 1e-9 * stroke]
    if lowest - fit.lowest > ON_BASE * stroke or len(base_dwells) == len(motion.segments):
        return ()
    result = []
    for (_, start), (end, _) in pairwise([*base_dwells, (base_dwells[0][0] + 360.0, 0.0)]):
        if end - start > 1e-9:
            turn = 360.0 if start >= 360.0 - 1e-9 else 0.0  # the last dwell ends with the turn
            result.append(_event(fit, lowest, start - turn, end - turn, lifts or DEFAULT_LIFTS.get(motion.unit, ())))
    return tuple(result)


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
    """Ramp extended to jumps of the velocity near its ends, which the fitted curve rounds off."""
    reach = 0.5 * (ramp.end - ramp.start)
    start, end = (next((jump for jump in jumps if abs(jump - edge) <= reach), edge) for edge in (ramp.start, ramp.end))
    return Ramp(start, end, ramp.velocity)


def _crossing(fit: MotionFit, level: float, low: float, high: float) -> float:
    from scipy.optimize import brentq

    def difference(angle: float) -> float:
        return float(fit.derivative(np.mod(np.array([angle]), 360.0), 0)[0]) - level

    return float(brentq(difference, low, high, xtol=1e-12))


def _ramps(x: np.ndarray, s: np.ndarray, v: np.ndarray, a: np.ndarray) -> Iterator[Ramp]:
    """Intervals of almost constant velocity at small lift and speed, as long as a ramp."""
    steady = (np.abs(a) <= RAMP_CURVATURE * np.abs(a).max()) & (s <= RAMP_HEIGHT * s.max())
    steady &= (np.abs(v) <= RAMP_SPEED * np.abs(v).max()) & (np.abs(v) >= 1e-3 * np.abs(v).max())
    edges = np.flatnonzero(np.diff(np.concatenate(([False], steady, [False])).astype(int))).reshape(-1, 2)
    yield from (
        Ramp(float(x[first]), float(x[end - 1]), float(np.mean(v[first:end])))
        for first, end in edges
        if x[end - 1] - x[first] >= RAMP_LEAST
    )


def velocity_jumps(fit: MotionFit) -> tuple[VelocityJump, ...]:
    """Jumps of the velocity in order: at joins of the motion, and where the rows have a kink that a table smooths."""
    jumps, width = _jumps_of_motion(fit.motion), 3.0 * 360.0 / max(fit.table.angles.size, 1)
    for row_jump in _jumps_of_rows(fit):
        if all(_distance(row_jump.angle, jump.angle) > width for jump in jumps):
            jumps.append(row_jump)
    return tuple(sorted(jumps, key=lambda jump: jump.angle))


def _distance(a: float, b: float) -> float:
    return abs((a - b + 180.0) % 360.0 - 180.0)


def _jumps_of_motion(motion: Motion) -> list[VelocityJump]:
    compiled = program(motion)
    count, jumps = len(compiled.starts), []
    ends = [
        compiled.state(Angles(theta, np.arange(count))).y[1] * np.deg2rad(1.0) / motion.scale
        for theta in (compiled.starts, compiled.ends)
    ]
    mean = sum(abs(segment.rise) for segment in motion.segments) / 360.0  # the velocity may be 0 at all ends
    largest = max(mean, *(float(np.abs(end).max()) for end in ends))
    for i in range(count):
        before, after = float(ends[1][i - 1]), float(ends[0][i])
        if abs(after - before) > JUMP * largest:
            jumps.append(VelocityJump(float(np.rad2deg(compiled.starts[i])), before, after))
    return jumps


def _jumps_of_rows(fit: MotionFit) -> Iterator[VelocityJump]:
    """Changes of velocity at a row, or between two rows, far larger than the neighbouring changes and their error."""
    table = fit.table
    used = table.used_rows(fit.left_out)
    x, index = distinct_angles(table.angles[used])
    if table.layout.order or x.size < 12:
        return
    y = np.bincount(index, table.values[used]) / np.bincount(index)
    h = np.diff(np.append(x, x[0] + 360.0))
    v = (np.roll(y, -1) - y) / h  # from each row to the next
    change = v - np.roll(v, 1)  # at each row
    pair_change = change + np.roll(change, -1)  # at a row and the next
    neighbours = np.max([np.abs(np.roll(change, k)) for k in (3, 2, 1, -2, -3, -4)], axis=0)
    error = max(fit.error * abs(table.size), 10.0**-table.decimals * abs(table.size)) / np.minimum(h, np.roll(h, 1))
    largest = np.abs(pair_change) >= np.maximum(np.abs(np.roll(pair_change, 1)), np.abs(np.roll(pair_change, -1)))
    for i in np.flatnonzero(
        largest & (np.abs(pair_change) > KINK * neighbours) & (np.abs(pair_change) > KINK_ERRORS * error)
    ):
        next_row = (i + 1) % x.size
        angle = float(x[i] + h[i] * np.clip(change[next_row] / pair_change[i], 0.0, 1.0))
        yield VelocityJump(angle % 360.0, float(v[i - 1]), float(v[next_row]))
