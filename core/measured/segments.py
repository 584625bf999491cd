"""Segments of a motion from angles and states, and the motion cut at cam angle 0."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from core.design import Motion, Segment, SplinePoint, TableCurve, join_angles
from core.laws.polynomial import quintics
from core.measured.rows import TurnRows
from core.motion import Angles, program
from core.motion.split import with_segment_split

# -- segments from states -----------


def difference(after: float, before: float) -> float:
    """Difference after - before, without the rounding of binary numbers where both are decimals."""
    result = after - before
    return (
        rounded + 0.0
        if abs((rounded := round(result, 9)) - result) < 1e-15 * max(abs(after), abs(before), 1.0)
        else result
    )


def quintic_segment(knots: np.ndarray, states: np.ndarray, low: float, high: float) -> Segment:
    """Segment of law table: quintics through states at knots, between two levels.

    Parameters
    ----------
    knots : ndarray (k,) [deg]
        Cam angles of the knots.
    states : ndarray (k, 3) [mm or deg, per degree]
        Displacement, velocity and acceleration at the knots.
    low, high : float
        Levels at which the segment begins and ends [mm or deg].
    """
    start = float(knots[0])
    angles = [difference(angle, start) for angle in knots.tolist()]
    heights = (states[:, 0] - low).tolist()
    heights[0], heights[-1] = 0.0, difference(high, low)
    points = tuple(
        SplinePoint(*row) for row in zip(angles, heights, states[:, 1].tolist(), states[:, 2].tolist(), strict=True)
    )
    return Segment(angles[-1], heights[-1], TableCurve(points))


def _quintic(knots: np.ndarray, states: np.ndarray, x: np.ndarray, order: int = 0) -> np.ndarray:
    """Derivative s⁽ᵏ⁾ (n,) of the curve with states (m, 3) at knots (m,)."""
    i = np.clip(np.searchsorted(knots, x, side="right") - 1, 0, knots.size - 2)
    rows = quintics(np.diff(knots), states[:-1, :, None], states[1:, :, None])[:, :, 0]
    w, result = x - knots[i], np.zeros(x.size)
    for power in range(5, order - 1, -1):
        result = result * w + float(np.prod(np.arange(power - order + 1, power + 1))) * rows[i, power]
    return result


def thin_knots(x: np.ndarray, states: np.ndarray, rows: TurnRows) -> np.ndarray:
    """Fewest rows, found by successive halving, whose quintics fit all other rows.

    Parameters
    ----------
    x : ndarray (n,) [deg]
        Cam angles of the rows.
    states : ndarray (3, n) [mm or deg, per degree]
        Displacement, velocity and acceleration of the rows.
    rows : TurnRows

    Returns
    -------
    ndarray (k,) of int, dimensionless
        Numbers of the rows.
    """
    selected = np.unique(np.linspace(0, x.size - 1, min(x.size, 13)).astype(int))
    while selected.size < x.size:
        is_off = np.zeros(x.size, dtype=bool)
        for order in range(3):
            curve = _quintic(x[selected], states.T[selected], x, order)
            is_off |= np.abs(curve - states[order]) > rows.errors[order]
        is_off[selected] = False
        if not is_off.any():
            break
        interval = np.unique(np.searchsorted(selected, np.flatnonzero(is_off)))
        selected = np.union1d(selected, (selected[interval - 1] + selected[interval]) // 2)
    return selected


# -- cam angle 0 ------------------------------------------------------------------------------------------


def with_start_at_zero(begin: float, level: float, segments: list[Segment], unit: str) -> Motion:
    """Motion of the segments from cam angle 0 on; the segment that contains it is split.

    A law that is split becomes tables with the same curve.
    """
    motion = Motion(level, tuple(segments), unit)
    cut = (-begin) % 360.0
    if cut < 1e-9 or cut > 360.0 - 1e-9:
        return motion
    starts = np.array(join_angles(motion))
    nearest = int(np.argmin(np.abs(starts - cut)))
    if abs(starts[nearest] - cut) > 1e-9:
        index = int(np.searchsorted(starts, cut)) - 1
        segment = motion.segments[index]
        law = segment.curve.law
        if law == "dwell":
            parts = (
                Segment(difference(cut, float(starts[index])), 0.0),
                Segment(difference(float(starts[index]) + segment.span_deg, cut), 0.0),
            )
            return Motion(
                level + sum(s.rise for s in motion.segments[:index]),
                (parts[1], *motion.segments[index + 1 :], *motion.segments[:index], parts[0]),
                unit,
            )
        if not isinstance(segment.curve, TableCurve) and law not in ("constant-velocity", "cv1", "cv2"):
            motion = replace(
                motion, segments=tuple(_as_table(motion, i) if i == index else s for i, s in enumerate(motion.segments))
            )
        motion = with_segment_split(motion, index, cut)
        nearest = index + 1
    height = level + sum(s.rise for s in motion.segments[:nearest])
    return Motion(height, (*motion.segments[nearest:], *motion.segments[:nearest]), unit)


def _as_table(motion: Motion, index: int) -> Segment:
    """Segment as a table whose quintics have its curve to 1e-9 of its acceleration."""
    compiled, segment = program(motion), motion.segments[index]
    start, span = join_angles(motion)[index], segment.span_deg
    pieces = np.flatnonzero(compiled.segment == index)
    joints = np.append(np.rad2deg(compiled.starts[pieces]), start + span)

    def states(x: np.ndarray) -> np.ndarray:
        piece = pieces[np.clip(np.searchsorted(joints, x, side="right") - 1, 0, pieces.size - 1)]
        y = compiled.state(Angles(np.deg2rad(x), piece)).displacement
        return np.array([y[k] * np.deg2rad(1.0) ** k for k in range(3)]) / motion.scale

    x = np.unique(np.concatenate([np.linspace(a, b, 5) for a, b in pairwise(joints)]))
    size = float(np.abs(states(x)[2]).max())
    for _ in range(8):
        y = states(x)
        y[2, -1] = states(np.array([x[-1]]))[2, 0]
        middle = 0.5 * (x[:-1] + x[1:])
        is_off = np.abs(_quintic(x, y.T, middle, 2) - states(middle)[2]) > 1e-9 * size
        if not is_off.any():
            break
        x = np.sort(np.append(x, middle[is_off]))
    y = states(x)
    return quintic_segment(x, y.T, float(y[0, 0]), float(y[0, 0]) + segment.rise)
