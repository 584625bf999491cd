"""The angles at which the torque of a study jumps or breaks, but for the joins of its motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from core.dynamics import Loading
from core.errors import NoAnswer
from core.mechanism import DriverRanges, Mechanism, solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import Angles
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
