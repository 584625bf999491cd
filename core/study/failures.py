"""At which cam angles a stage has no answer: found by bisection, so that they do not depend on a sampling."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees
from typing import Any

import numpy as np

from core.errors import NoAnswer
from core.motion import Angles, Program
from core.motion.extremes import piecewise_angles

MOST = 1000  # angles that are tried; motions of many more pieces are sampled more coarsely


def failing_ranges(study_at: Callable[[Angles], Any], stage: str, program: Program) -> list[tuple[float, float]]:
    """Ranges of cam angles [deg] at which the stage raises NoAnswer; study_at gives the study at any cam angles."""

    def fails(theta: float, piece: int) -> bool:
        try:
            getattr(study_at(Angles(np.array([theta]), np.array([piece]))), stage)
        except NoAnswer:
            return True
        return False

    def edge(good: float, bad: float, piece: int) -> float:
        """The last cam angle that fails, next to one that does not."""
        while True:
            middle = 0.5 * (good + bad)
            if middle in (good, bad):
                return bad
            if fails(middle, piece):
                bad = middle
            else:
                good = middle

    angles = piecewise_angles(program)
    step = max(1, angles.theta.size // MOST)
    theta, piece = angles.theta[::step].tolist(), angles.piece[::step].tolist()
    bad = np.array([fails(*place) for place in zip(theta, piece, strict=True)])
    changes = np.flatnonzero(np.diff(bad, prepend=False, append=False)).reshape(
        -1, 2
    )  # first bad one, first good one after it
    ranges = []
    for first, after in changes.tolist():
        last, begin, end = after - 1, theta[first], theta[after - 1]
        if first > 0 and piece[first - 1] == piece[first]:
            begin = edge(theta[first - 1], begin, piece[first])
        if after < len(theta) and piece[after] == piece[last]:
            end = edge(theta[after], end, piece[last])
        ranges.append((degrees(begin), degrees(end)))
    return ranges
