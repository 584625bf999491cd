"""The angles at which the torque of a study jumps or breaks, but for the joins of its motion; those at which a stage has no answer."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees
from typing import Any

import numpy as np

from core.dynamics import Loading
from core.errors import NoAnswer
from core.mechanism import DriverRanges, Mechanism, solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, Program
from core.motion.extremes import piecewise_angles
from core.motion.roots import crossings
from core.numerics.vectors import spread
from core.study.stages import memory


def cuts(
    loading: Loading, driven: Any, uncut: Any, mechanism: Mechanism, course_of: Callable[[], DriverRanges]
) -> tuple[float, ...]:
    """Angles [rad] in rising order at which a process force switches, and at which friction turns round in a pin; none where the
    mechanism cannot be solved, which its own stage says. driven: the motion, or a crank's ranges; uncut: its program."""
    try:
        switches = memory.get("switches", (driven, loading.switches), lambda: tuple(loading.cuts(uncut).tolist()))
        pairs = tuple(friction.pair for friction in loading.frictions)
        key = (driven, mechanism, pairs)
        back = memory.get("turning back", key, lambda: _turning_back(pairs, uncut, mechanism, course_of))
    except NoAnswer:
        return ()
    return tuple(sorted({*switches, *back}))


def _turning_back(
    pairs: tuple[str, ...], uncut: Any, mechanism: Mechanism, course_of: Callable[[], DriverRanges]
) -> tuple[float, ...]:
    """Angles [rad] at which one of these pairs slips the other way."""
    if not pairs:
        return ()
    angles, driver_ranges = piecewise_angles(uncut), course_of()
    sampled = solve_mechanism(mechanism, uncut.state(angles), driver_ranges)
    turning = [name for name in pairs if name != sampled.driver_name]
    if not turning:
        return ()

    def slips(kinematics: Kinematics) -> np.ndarray:
        return np.array([spread(kinematics.slip(name), kinematics.theta.size) for name in turning])

    def slip(at: Angles) -> np.ndarray:
        return slips(solve_mechanism(mechanism, uncut.state(at), driver_ranges))

    return tuple(crossings(slip, angles, slips(sampled)).theta.tolist())


# -- where there is no answer: by bisection, so that it does not depend on a sampling ---------------------------

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
