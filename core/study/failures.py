"""At which cam angles a stage has no answer: found by bisection, so that they do not depend on a sampling."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees
from typing import Any

import numpy as np

from core.errors import NoAnswer
from core.motion import Angles, Program
from core.motion.extremes import piecewise_angles

MOST = 2000  # angles looked at; motions of many more pieces are looked at more coarsely


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
    places = list(zip(angles.theta[::step].tolist(), angles.piece[::step].tolist(), strict=True))
    bad = [fails(theta, piece) for theta, piece in places]
    ranges: list[tuple[float, float]] = []
    begin: float | None = None
    for i, (theta, piece) in enumerate(places):
        same = i > 0 and places[i - 1][1] == piece
        if bad[i] and begin is None:
            begin = edge(places[i - 1][0], theta, piece) if same else theta
        if not bad[i] and begin is not None:
            end = edge(theta, places[i - 1][0], piece) if same else places[i - 1][0]
            ranges.append((degrees(begin), degrees(end)))
            begin = None
    if begin is not None:
        ranges.append((degrees(begin), degrees(places[-1][0])))
    return ranges
