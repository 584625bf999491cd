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
_PARTS = np.linspace(0.0, 1.0, 9)[1:-1, None]  # of the interval between an angle that fails and one that does not


def failing_ranges(study_at: Callable[[Angles], Any], stage: str, program: Program) -> list[tuple[float, float]]:
    """Ranges of cam angles [deg] at which the stage raises NoAnswer; study_at gives the study at any cam angles."""
    angles = piecewise_angles(program)
    step = max(1, angles.theta.size // MOST)
    theta, piece = angles.theta[::step], angles.piece[::step]
    bad = _failing(study_at, stage, theta, piece)
    first, after = np.flatnonzero(np.diff(bad, prepend=False, append=False)).reshape(-1, 2).T
    ends = np.array([first, after - 1])  # of each range: the first and the last sample that fails
    beyond = np.clip([first - 1, after], 0, theta.size - 1)
    found = theta[ends]
    inner = (piece[beyond] == piece[ends]) & ~bad[beyond]
    found[inner] = _edges(study_at, stage, theta[beyond[inner]], theta[ends[inner]], piece[ends[inner]])
    return [(degrees(begin), degrees(end)) for begin, end in found.T]


def _edges(
    study_at: Callable[[Angles], Any], stage: str, good: np.ndarray, bad: np.ndarray, piece: np.ndarray
) -> np.ndarray:
    """The last angles (m,) [rad] that fail, next to ones that do not, between angles (m,) that do not and that do: each interval is cut
    into many parts at a time, since many angles cost hardly more than one."""
    columns = np.arange(good.size)
    while good.size:
        theta = good + (bad - good) * _PARTS
        if not ((theta != good) & (theta != bad)).any():
            break
        fails = _failing(study_at, stage, theta.ravel(), np.tile(piece, len(_PARTS))).reshape(theta.shape)
        theta = np.vstack((good, theta, bad))
        at = np.where(fails.any(axis=0), fails.argmax(axis=0), len(_PARTS))  # the last part before the first that fails
        good, bad = theta[at, columns], theta[at + 1, columns]
    return bad


def _failing(study_at: Callable[[Angles], Any], stage: str, theta: np.ndarray, piece: np.ndarray) -> np.ndarray:
    """At which angles (n,) [rad], each in its piece (n,), the stage raises NoAnswer."""
    bad, rest = np.zeros(theta.size, dtype=bool), np.argsort(theta, kind="stable")
    while rest.size:
        try:
            getattr(study_at(Angles(theta[rest], piece[rest])), stage)
            break
        except NoAnswer as error:
            at = np.rad2deg(theta[rest])
            named = [(low <= at) & (at <= high) for low, high in error.cam_angles]
            failed = np.any(named, axis=0) if named else np.ones(rest.size, dtype=bool)
            if rest.size > 1 and not (named and failed.any()):  # it does not say where: each angle by itself
                failed = np.array([_failing(study_at, stage, theta[[i]], piece[[i]])[0] for i in rest])
                bad[rest[failed]] = True
                break
            bad[rest[failed]] = True
            rest = rest[~failed]
    return bad
