"""Refined extremes of a study's quantities; a quantity that grows without limit has an infinite extreme there.

It does so at a cusp of the profile, at a dead centre of a crank and at a change point.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Hashable, Mapping
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from core import cam
from core.design import STAGES
from core.errors import NoSolution
from core.motion import TURN, Angles
from core.motion.extremes import Extreme, Extremes, find_extremes, find_highest, piecewise_angles
from core.study.drive_forces import load_ratings, pairings
from core.study.quantities import CLEARANCES, OF_CONTACT, OF_MOTOR, OF_SPEED, Quantity, quantities_of, quantity
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
_STEPS = np.array([1e-7, 1e-5])  # [rad] from a singular angle: where growth without limit shows


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

    def compute() -> Mapping[str, Extremes]:
        rows = _rows(study, stage, only)
        with study.with_exact_angles(stage):
            return _searched(study, rows)

    extremes: Mapping[str, Extremes] = memory.get(("extremes", stage, only), parts_of(study, stage, only), compute)
    return extremes


def extremes_beyond_lash(study: Study, name: str) -> Extremes:
    """Refined extremes of a force in SI units; with lash only where the train is not loose."""
    if study.lash is None:
        return extremes_of(study, "dynamics", (name,))[name]
    row = quantity(name)

    def force(angles: Angles) -> dict[str, np.ndarray]:
        at = study.at(angles)
        return {"": np.where(at.loading.acting(at.linkage), row.value(at), np.nan)}

    def compute() -> Extremes:
        return find_extremes(force, study.program)[""]

    extremes: Extremes = memory.get(("beyond lash", name), study.depends_on("dynamics"), compute)
    return extremes


def search_together(study: Study, requested: Mapping[str, tuple[str, ...]], prepare: Callable[[], None]) -> None:
    """Extremes of several stages (stage -> names of quantities) in one search; ``extremes_of`` then reads them from the cache.

    ``prepare`` is called before a search. Stages without a solution are left to ``extremes_of``, which raises their error.
    """
    rows = {name: row for stage, only in requested.items() if only for name, row in _rows(study, stage, only).items()}
    with suppress(NoSolution):
        _searched(study, rows, prepare)


def parts_of(study: Study, stage: str, names: Container[str]) -> tuple[Hashable, ...]:
    """Parts of the design on which the named quantities of a stage depend, all of the stage where none is named."""

    def has_any(group: frozenset[str]) -> bool:
        return not names or any(name in names for name in group)

    with_motor = stage == "dynamics" and has_any(OF_MOTOR)
    with_speed = stage == "cam" and has_any(OF_SPEED)
    with_contact = stage == "dynamics" and has_any(OF_CONTACT)
    design = study.design
    has_pairs = stage == "linkage" and bool(design.outlines)
    return (
        study.depends_on(stage),
        study.clearances.key if has_pairs else (),
        design.shaft if with_motor else None,
        design.speed_rpm if with_speed else None,
        (tuple(pairings(study).items()), *load_ratings(study)) if with_contact else (),
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
    if not study.has_disk:
        return False

    def compute() -> bool:
        return any(undercut_on(study, flank) for flank in cam.form_row(study.design.drive.cam.form).flanks)

    is_undercut: bool = memory.get("undercut", study.depends_on("cam"), compute)
    return is_undercut


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


def _rows(study: Study, stage: str, only: tuple[str, ...]) -> dict[str, Quantity]:
    return {
        name: row
        for name, row in quantities_of(study, stage).items()
        if not row.is_periodic and (name in only if only else has_quantity(study, row))
    }


def _searched(
    study: Study, rows: Mapping[str, Quantity], prepare: Callable[[], None] | None = None
) -> dict[str, Extremes]:
    """Extremes of quantities; those that are not cached are searched together, so that a pass costs one solution."""
    with_cusps = {**rows, **_cusp_rows(study, rows)}
    keys = {name: (("extremes", name), parts_of(study, row.stage, (name,))) for name, row in with_cusps.items()}
    missing = {name: row for name, row in with_cusps.items() if not memory.has(*keys[name])}
    if missing:
        if prepare is not None:
            prepare()
        extremes = {name: memory.get(*key, dict) for name, key in keys.items() if name not in missing}
        for name, range_ in _search(study, missing, extremes).items():
            memory.get(*keys[name], lambda range_=range_: range_)  # type: ignore[misc]
    return {name: memory.get(*keys[name], dict) for name in rows}


def _cusp_rows(study: Study, rows: Mapping[str, Quantity]) -> Mapping[str, Quantity]:
    """Quantities from which an undercut follows, where the rows contain a curvature, which grows without limit at its cusps."""
    if rows.keys().isdisjoint(PROFILE_CURVATURES.values()):
        return {}
    limits = cam.limits_of(study.design.drive.face, study.design.drive.cam)
    return {name: row for name, row in quantities_of(study, "cam").items() if name in limits}


@np.errstate(invalid="ignore", over="ignore")  # infinite rates at dead centres
def _search(study: Study, rows: Mapping[str, Quantity], known: Mapping[str, Extremes]) -> dict[str, Extremes]:
    """Extremes of quantities, infinite where a quantity grows without limit; ``known``: extremes of further quantities."""

    def values(angles: Angles) -> Mapping[str, np.ndarray]:
        at_angles = study.at(angles)
        return {name: row.value(at_angles) for name, row in rows.items()}

    if of_pairs := {name: row for name, row in rows.items() if row.table == CLEARANCES}:
        rest = {name: row for name, row in rows.items() if name not in of_pairs}
        return _clearance_extremes(study, of_pairs) | (_search(study, rest, known) if rest else {})
    last = max((row.stage for row in rows.values()), key=STAGES.index)
    if last != "motion":
        study.solve_turn(last, *near_singular(study))
    extremes = find_extremes(values, study.program)
    if study.design.drive.motion is not None and study.design.drive.motion.gain:
        extremes = _at_turn_end(extremes, values(piecewise_angles(study.program)))
    extremes |= _cusp_curvatures(study, {**known, **extremes})
    if not study.by_crank:
        return extremes
    return {name: Extremes(_limit(study, name, r.low), _limit(study, name, r.high)) for name, r in extremes.items()}


def _clearance_extremes(study: Study, rows: Mapping[str, Quantity]) -> dict[str, Extremes]:
    """Extremes of clearances; the least one is proven, since it may be at a kink between two samples."""

    def values(angles: Angles) -> Mapping[str, np.ndarray]:
        at_angles = study.at(angles)
        return {name: row.value(at_angles) for name, row in rows.items()}

    highest, clearances = find_highest(values, study.program), study.clearances
    least = {name: clearances.least(clearances.by_column[name]) for name in rows}
    return {name: Extremes(Extreme(row.value, row.theta), highest[name]) for name, row in least.items()}


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
    result = {}
    for flank, name in PROFILE_CURVATURES.items():
        if name in extremes and cam.undercut(extremes, flank, drive.face, drive.cam):
            low, high = extremes[name].low, extremes[name].high
            low = Extreme(-np.inf, low.theta) if low.value < 0.0 else low
            result[name] = Extremes(low, Extreme(np.inf, high.theta))
    return result


def _limit(study: Study, name: str, extreme: Extreme) -> Extreme:
    """The extreme; infinite where it is at a dead centre or change point towards which the quantity grows without limit."""
    for number, singular in enumerate(_singular_angles(study)):
        if abs(extreme.theta - singular.theta) < singular.near and _grows(study, name, number):
            return Extreme(float(np.copysign(np.inf, extreme.value)), singular.theta)
    return extreme


def is_unlimited(study: Study, name: str, theta: float) -> bool:
    """Whether a quantity grows without limit towards an angle [rad], a dead centre or change point of a crank."""
    angles = _singular_angles(study) if study.by_crank else []
    return any(abs(theta - at.theta) < _NEAR_END and _grows(study, name, number) for number, at in enumerate(angles))


class _SingularAngle(NamedTuple):
    """Dead centre or change point of a crank.

    Attributes
    ----------
    theta, near : float [rad]
        Its angle, and the distance that counts as at it.
    inwards : float
        Direction ±1 into the range.
    """

    theta: float
    near: float
    inwards: float


def _singular_angles(study: Study) -> list[_SingularAngle]:
    if study.swings:  # it locks where the cycle begins, and where it reverses
        return [
            _SingularAngle(*row) for row in ((0.0, _NEAR_END, 1.0), (np.pi, _NEAR_END, -1.0), (TURN, _NEAR_END, -1.0))
        ]
    driver_ranges, turns = study.driver_ranges, study.turns
    angles = [(r.low, _NEAR_END, 1.0) for r in driver_ranges.ranges if r.low_joint]
    angles += [(r.high, _NEAR_END, -1.0) for r in driver_ranges.ranges if r.high_joint]
    angles += [(change.at, _NEAR_CHANGE, 1.0) for change in driver_ranges.changes]
    return [_SingularAngle(at / turns, near, inwards) for at, near, inwards in angles]


def near_singular(study: Study) -> tuple[Angles, ...]:
    """Two angles next to every dead centre and change point of a crank, as one set; empty where it has none."""

    def compute() -> tuple[Angles, ...]:
        steps = [at.theta + at.inwards * _STEPS for at in _singular_angles(study)]
        if not steps:
            return ()
        angles = study.program.angles(np.concatenate(steps))
        return (Angles(angles.theta, angles.piece, cached=True, search=True),)

    sets: tuple[Angles, ...] = memory.get("near singular", study.driver_ranges, compute) if study.by_crank else ()
    return sets


def _grows(study: Study, name: str, number: int) -> bool:
    """Whether a quantity grows without limit towards a singular angle: a hundred times nearer it is more than five times as large."""
    (angles,) = near_singular(study)
    nearer, near = np.abs(quantity(name).value(study.at(angles)))[2 * number : 2 * number + 2]
    return bool(nearer > 5.0 * near)
