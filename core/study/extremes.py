"""Refined extremes of a study's quantities; a quantity that grows without limit has an infinite extreme there.

It does so at a cusp of the profile, at a dead centre of a crank and at a change point.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from functools import partial

import numpy as np

from core import cam
from core.errors import NoSolution
from core.motion import TURN, Angles
from core.motion.extremes import Extreme, Extremes, find_extremes
from core.study.drive_forces import load_ratings, pairings
from core.study.quantities import OF_CONTACT, OF_MOTOR, OF_SPEED, Quantity, quantities_of, quantity
from core.study.stages import memory
from core.study.study import Study

PROFILE_CURVATURES = {
    cam.INNER: "profile_curvature",
    cam.OUTER: "outer_curvature",
    cam.SECOND: "second_profile_curvature",
}
"""Flank -> quantity."""

_NEAR_END = 1e-9  # [rad] from a dead centre: an extreme so near to it is the limit at the dead centre
_NEAR_CHANGE = 1e-3  # [rad] from a change point, which no sample meets exactly


def extremes_of(study: Study, stage: str, only: tuple[str, ...] = ()) -> Mapping[str, Extremes]:
    """Extremes over the turn of a stage's quantities, in SI units.

    Parameters
    ----------
    study : Study
    stage : str
        For ``stability`` the extremes are those of the steady response of the flexible shaft.
    only : tuple of str
        Names of the quantities; all of the stage where empty.

    Returns
    -------
    mapping of str -> Extremes

    Raises
    ------
    NoSuchStage
        Where the design lacks the stage.
    NoSolution
        Where the stage has no solution.
    """
    study.require_stage(stage)
    if stage == "stability":
        return _steady_turn_extremes(study)
    kind, key = _cache_key(study, stage, only)
    extremes: Mapping[str, Extremes] = memory.get(kind, key, lambda: _turn_extremes(study, stage, only))
    return extremes


def search_together(study: Study, requested: Mapping[str, tuple[str, ...]]) -> None:
    """Extremes of several stages (stage -> names of quantities) in one search; ``extremes_of`` then reads them from the cache.

    Stages without a solution are left to ``extremes_of``, which raises their error.
    """
    keys = {stage: _cache_key(study, stage, only) for stage, only in requested.items()}
    missing = {stage: only for stage, only in requested.items() if not memory.has(*keys[stage])}
    if len(missing) < 2:
        return
    rows = {stage: _rows(study, stage, only) for stage, only in missing.items()}
    try:
        extremes = _searched(study, {name: row for stage_rows in rows.values() for name, row in stage_rows.items()})
    except NoSolution:
        return
    for stage, stage_rows in rows.items():
        memory.get(*keys[stage], partial(_with_infinite, study, stage, {name: extremes[name] for name in stage_rows}))


def _cache_key(study: Study, stage: str, only: tuple[str, ...]) -> tuple[Hashable, Hashable]:
    """Kind and key by which the extremes of a stage are cached."""
    with_motor = stage == "dynamics" and (not only or not OF_MOTOR.isdisjoint(only))
    with_speed = stage == "cam" and (not only or not OF_SPEED.isdisjoint(only))
    with_contact = stage == "dynamics" and (not only or not OF_CONTACT.isdisjoint(only))
    contact = (tuple(pairings(study).items()), *load_ratings(study)) if with_contact else ()
    design = study.design
    return ("extremes", stage, only), (
        study.depends_on(stage),
        design.shaft if with_motor else None,
        design.speed_rpm if with_speed else None,
        contact,
    )


def cam_extremes(study: Study) -> Mapping[str, Extremes]:
    """Extremes of the quantities from which the findings of the cam follow."""
    return extremes_of(study, "cam", cam.limits_of(study.design.drive.face, study.design.drive.cam))


def undercut_on(study: Study, flank: str) -> bool:
    """Whether a flank is undercut: it has a cusp, or its curvature makes it cross itself.

    A jump of velocity gives the pitch curve a corner, which undercuts the profile of any roller.
    """
    has_corner = any(join.jumps[:2].any() for join in study.program.joins)
    return has_corner or cam.undercut(cam_extremes(study), flank, study.design.drive.face, study.design.drive.cam)


def has_undercut(study: Study) -> bool:
    """Whether any flank is undercut, so that the face cannot touch the profile everywhere."""
    return any(undercut_on(study, flank) for flank in cam.form_row(study.design.drive.cam.form).flanks)


def has_quantity(study: Study, row: Quantity) -> bool:
    """Whether a design has a quantity: its stage gives it, and no undercut rules it out."""
    return row.exists(study) and not (row.needs_smooth_profile and has_undercut(study))


def _steady_turn_extremes(study: Study) -> Mapping[str, Extremes]:
    """Extremes of the steady response, in the pieces of its integration; empty where there is none."""
    turn = None if study.stability is None else study.stability.steady_turn
    if turn is None:
        return {}
    wind_up, stiffness = turn.wind_up_range, turn.stiffness
    sides = (Extreme(stiffness * side.value, side.theta) for side in (wind_up.low, wind_up.high))
    errors = dict(zip(("follower_error",), turn.errors, strict=False))  # a crank has no follower
    return {"wind_up": wind_up, **errors, "shaft_torque": Extremes(*sides)}


def _turn_extremes(study: Study, stage: str, only: tuple[str, ...]) -> Mapping[str, Extremes]:
    rows = _rows(study, stage, only)
    with study.with_exact_angles(stage):
        extremes = _searched(study, rows)
    return _with_infinite(study, stage, extremes)


def _rows(study: Study, stage: str, only: tuple[str, ...]) -> dict[str, Quantity]:
    return {
        name: row
        for name, row in quantities_of(study, stage).items()
        if not row.is_periodic and (name in only if only else has_quantity(study, row))
    }


@np.errstate(invalid="ignore", over="ignore")  # infinite rates at dead centres
def _searched(study: Study, rows: Mapping[str, Quantity]) -> dict[str, Extremes]:
    def values(angles: Angles) -> Mapping[str, np.ndarray]:
        at_angles = study.at(angles)
        return {name: row.value(at_angles) for name, row in rows.items()}

    extremes = find_extremes(values, study.program)
    if study.design.drive.motion is not None and study.design.drive.motion.gain:
        extremes = _at_turn_end(extremes, values(study.program.angles(np.zeros(1))))
    return extremes


@np.errstate(invalid="ignore", over="ignore")
def _with_infinite(study: Study, stage: str, extremes: dict[str, Extremes]) -> Mapping[str, Extremes]:
    """Extremes of a stage, infinite where the quantity grows without limit."""
    if stage == "cam":
        extremes |= _cusp_curvatures(study, extremes)
    if not study.by_crank:
        return extremes
    return {name: Extremes(_limit(study, name, r.low), _limit(study, name, r.high)) for name, r in extremes.items()}


def _at_turn_end(extremes: Mapping[str, Extremes], first: Mapping[str, np.ndarray]) -> dict[str, Extremes]:
    """Of a motion with an advance: an extreme at 0 that differs from the value at the start (first) is at 2π."""

    def moved(side: Extreme, start: float, size: float) -> Extreme:
        is_end = side.theta == 0.0 and abs(side.value - start) > 1e-9 * size
        return Extreme(side.value, TURN) if is_end else side

    result = {}
    for name, range_ in extremes.items():
        start, size = float(first[name][0]), max(abs(range_.low.value), abs(range_.high.value))
        result[name] = Extremes(moved(range_.low, start, size), moved(range_.high, start, size))
    return result


def _cusp_curvatures(study: Study, extremes: Mapping[str, Extremes]) -> dict[str, Extremes]:
    """Extremes of the curvatures of undercut flanks.

    A curvature grows without limit at a cusp, and returns from below where the profile runs backwards.
    """
    drive = study.design.drive
    flanks = [(flank, name) for flank, name in PROFILE_CURVATURES.items() if name in extremes]
    if not flanks:
        return {}
    limits = extremes if extremes.keys() >= set(cam.limits_of(drive.face, drive.cam)) else cam_extremes(study)
    result = {}
    for flank, name in flanks:
        if cam.undercut(limits, flank, drive.face, drive.cam):
            low, high = extremes[name].low, extremes[name].high
            low = Extreme(-np.inf, low.theta) if low.value < 0.0 else low
            result[name] = Extremes(low, Extreme(np.inf, high.theta))
    return result


def _limit(study: Study, name: str, extreme: Extreme) -> Extreme:
    """The extreme; infinite where it is at a dead centre or change point towards which the quantity grows without limit."""
    for theta, near, inwards in _singular_angles(study):
        if abs(extreme.theta - theta) < near and _grows(study, name, theta, inwards):
            return Extreme(float(np.copysign(np.inf, extreme.value)), theta)
    return extreme


def is_unlimited(study: Study, name: str, theta: float) -> bool:
    """Whether a quantity grows without limit towards an angle [rad], a dead centre or change point of a crank."""
    angles = _singular_angles(study) if study.by_crank else []
    return any(abs(theta - at) < _NEAR_END and _grows(study, name, at, inwards) for at, _, inwards in angles)


def _singular_angles(study: Study) -> list[tuple[float, float, float]]:
    """Dead centres and change points of a crank: angle [rad], distance that counts as at it [rad], direction into the range."""
    if study.swings:  # it locks where the cycle begins, and where it reverses
        return [(0.0, _NEAR_END, 1.0), (np.pi, _NEAR_END, -1.0), (TURN, _NEAR_END, -1.0)]
    driver_ranges = study.driver_ranges
    angles = [(r.low, _NEAR_END, 1.0) for r in driver_ranges.ranges if r.low_joint]
    angles += [(r.high, _NEAR_END, -1.0) for r in driver_ranges.ranges if r.high_joint]
    angles += [(change.at, _NEAR_CHANGE, 1.0) for change in driver_ranges.changes]
    return [(at / study.turns, near, inwards) for at, near, inwards in angles]


def _grows(study: Study, name: str, theta: float, inwards: float) -> bool:
    """Whether a quantity grows without limit towards an angle: a hundred times nearer it is more than five times as large."""
    steps = theta + inwards * np.array([1e-7, 1e-5])
    nearer, near = np.abs(quantity(name).value(study.at(study.program.angles(steps))))
    return bool(nearer > 5.0 * near)
