"""The samples of many trial designs at once: the figures of their limits by the formulas of one, on columns."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from core.design import Design
from core.errors import NoAnswer
from core.mechanism.kinematics import Kinematics
from core.motion import Angles
from core.motion.extremes import Extreme, piecewise_angles
from core.numerics.cancellation import checkpoint
from core.numerics.columns import column
from core.study import Study
from core.study.limits import LIMITS, Curve
from core.study.own_limits import OWN_BOUNDS, bounded

MOTION = "motion."
Put = Callable[[Design, str, Any], Design]
"""The design with another number, or a column of them, at a path."""


class Top(NamedTuple):
    """The highest value of a figure over the turn, and the greatest of its sizes."""

    curve: Curve
    found: Extreme
    size: float


Tops = Mapping[str, Sequence[Top]]
"""Key of a limit -> the figures of its flanks."""


def curves_of(study: Study, keys: Sequence[str]) -> dict[str, tuple[Curve, ...]]:
    """Key -> the figures of its flanks, at the cam angles of a study."""
    return {key: tuple(LIMITS[key].curves(study)) for key in keys}


class Sampled(NamedTuple):
    """Of one of many designs: its number; its limits, None where it has no answer; the linkage of all, of whose pairs the kinds are
    its."""

    number: int
    tops: Tops | None
    linkage: Kinematics


def sampled_together(
    design: Design, paths: Sequence[str], rows: np.ndarray, put: Put, keys: Sequence[str]
) -> Iterator[Sampled]:
    """The designs with other numbers (p, m) at these paths, by samples of every piece of the motion: those of them that can be
    computed together."""
    from core.study.batches.asked import Asked
    from core.study.batches.batch import together
    from core.study.batches.together import POINTS, Together

    read = [name for key in keys if key in OWN_BOUNDS for name in bounded(design, key)]
    if not rows.size or not all(together(design, paths, Asked("", name, "max", 1.0)) for name in read):
        return
    stage = "dynamics" if any(LIMITS[key].of_forces for key in keys) else "cam"
    size = max(1, POINTS // piecewise_angles(Study(design).uncut).theta.size)
    for first in range(0, rows.shape[1], size):
        checkpoint()
        moved, fixed = design, {}
        for path, row in zip(paths, rows[:, first : first + size], strict=True):
            if path.startswith(MOTION):
                moved = put(moved, path, column(row))
            else:
                fixed[path] = row
        motion = None if moved is design else moved.drive.motion
        one = Together(design, fixed, motion, rows[0, first : first + size].size)
        angles = piecewise_angles(one.program)
        try:
            linkage, curves = one.read(
                stage, *one.spread(angles), lambda there: (there.linkage, curves_of(there, keys))
            )
        except NoAnswer:  # all of them
            continue
        tops = tops_of(curves, one.count, angles)
        lost = one.lost_at(stage)
        for k in np.flatnonzero(~one.apart).tolist():
            yield Sampled(first + k, None if lost[k] else tops[k], linkage)


def tops_of(curves: Mapping[str, Sequence[Curve]], count: int, angles: Angles) -> list[Tops]:
    """The limits of each of so many designs, by their samples one after the other."""
    every = [curve for rows in curves.values() for curve in rows]
    samples = np.array([curve.value for curve in every]).reshape(len(every) * count, -1)
    value, theta = (each.reshape(-1, count).tolist() for each in highest_of_samples(samples, angles))
    sizes = [
        np.reshape(curve.size, (count, -1)).max(axis=1).tolist() if np.ndim(curve.size) else [float(curve.size)] * count
        for curve in every
    ]
    found: list[Tops] = []
    for k in range(count):
        tops = iter(Top(curve, Extreme(value[i][k], theta[i][k]), sizes[i][k]) for i, curve in enumerate(every))
        found.append({key: [next(tops) for _ in rows] for key, rows in curves.items()})
    return found


def highest_of_samples(value: np.ndarray, angles: Angles) -> tuple[np.ndarray, np.ndarray]:
    """The highest of samples (m, n) at angles (n,), or of the parabola through it and its neighbours in the same segment, and the angle
    of the sample [rad], both (m,)."""
    value = np.where(np.isnan(value), -np.inf, value)
    top, last = value.argmax(axis=1), angles.theta.size - 1
    index = np.clip(top[:, None] + np.arange(-1, 2), 0, last)
    x, y = angles.theta[index], np.take_along_axis(value, index, axis=1)
    piece = angles.piece[index]
    inside = (top > 0) & (top < last) & (piece[:, 0] == piece[:, 2]) & np.isfinite(y).all(axis=1)
    x, y = x[inside], y[inside]
    before, after = x[:, 0] - x[:, 1], x[:, 2] - x[:, 1]
    left, right = (y[:, 0] - y[:, 1]) / before, (y[:, 2] - y[:, 1]) / after
    bend = (right - left) / (after - before)
    slope = left - bend * before
    highest = value[np.arange(top.size), top]
    highest[inside] -= np.where(bend < 0.0, 0.25 * slope * slope / np.where(bend < 0.0, bend, 1.0), 0.0)
    return highest, angles.theta[top]
