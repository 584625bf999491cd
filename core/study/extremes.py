"""Refined extremes of a study's quantities: where one grows without limit, at a cusp, a dead centre or a change point, it is infinite."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from functools import partial

import numpy as np

from core import cam
from core.errors import NoSolution
from core.motion import TURN, Angles
from core.motion.extremes import Extreme, Extremes, find_extremes
from core.study.quantities import OF_CONTACT, OF_MOTOR, OF_SPEED, Quantity, quantities_of, quantity
from core.study.stages import memory
from core.study.study import Study, pairings, ratings

PROFILE_CURVATURES = {
    cam.INNER: "profile_curvature",
    cam.OUTER: "outer_curvature",
    cam.SECOND: "second_profile_curvature",
}
"""Flank -> quantity."""

_AT_END = 1e-9  # [rad] from a dead centre: what grows towards it and has its extreme so near has none
_AT_CHANGE = 1e-3  # the same from a change point, where samples fall beside it


def extremes_of(study: Study, stage: str, only: tuple[str, ...] = ()) -> Mapping[str, Extremes]:
    """Of a stage's quantities (of those named only, where any are), in SI units; of the steady response of a flexible shaft for
    the stage ``stability``. Raises NoSuchStage; NoSolution as the stage does."""
    study.require_stage(stage)
    if stage == "stability":
        return _of_the_steady_turn(study)
    kind, key = _kept_as(study, stage, only)
    found: Mapping[str, Extremes] = memory.get(kind, key, lambda: _of_the_turn(study, stage, only))
    return found


def search_together(study: Study, asked: Mapping[str, tuple[str, ...]]) -> None:
    """The extremes of several stages, by stage the names of the quantities, in one search; ``extremes_of`` finds them there. What has no
    answer is left to that."""
    kept = {stage: _kept_as(study, stage, only) for stage, only in asked.items()}
    asked = {stage: only for stage, only in asked.items() if not memory.has(*kept[stage])}
    if len(asked) < 2:
        return
    rows = {stage: _rows(study, stage, only) for stage, only in asked.items()}
    try:
        found = _searched(study, {name: row for of_stage in rows.values() for name, row in of_stage.items()})
    except NoSolution:
        return
    for stage, of_stage in rows.items():
        own = {name: found[name] for name in of_stage}
        memory.get(*kept[stage], partial(_finished, study, stage, own))


def _kept_as(study: Study, stage: str, only: tuple[str, ...]) -> tuple[Hashable, Hashable]:
    """As what they are remembered, and by which key."""
    with_motor = stage == "dynamics" and (not only or not OF_MOTOR.isdisjoint(only))
    with_speed = stage == "cam" and (not only or not OF_SPEED.isdisjoint(only))
    with_contact = stage == "dynamics" and (not only or not OF_CONTACT.isdisjoint(only))
    touching = (tuple(pairings(study).items()), *ratings(study)) if with_contact else ()
    design = study.design
    return ("extremes", stage, only), (
        study.depends_on(stage),
        design.shaft if with_motor else None,
        design.speed_rpm if with_speed else None,
        touching,
    )


def cam_extremes(study: Study) -> Mapping[str, Extremes]:
    """Those of the quantities that the findings of the cam are taken from."""
    return extremes_of(study, "cam", cam.limits_of(study.design.drive.face, study.design.drive.cam))


def undercut_on(study: Study, flank: str) -> bool:
    """Whether a flank has a cusp, or crosses itself where it is curved too much. Where the velocity
    jumps the pitch curve has a corner, which is sharper than any roller."""
    corners = any(join.jumps[:2].any() for join in study.program.joins)
    return corners or cam.undercut(cam_extremes(study), flank, study.design.drive.face, study.design.drive.cam)


def fits(study: Study) -> bool:
    """Whether what touches fits the profile everywhere: no flank is undercut."""
    return not any(undercut_on(study, flank) for flank in cam.form_row(study.design.drive.cam.form).flanks)


def exists(study: Study, row: Quantity) -> bool:
    """Whether a design that could have a quantity does."""
    return row.exists(study) and not (row.fitting and not fits(study))


def _of_the_steady_turn(study: Study) -> Mapping[str, Extremes]:
    """Its pieces are those of the integration; empty where there is no steady response."""
    turn = None if study.stability is None else study.stability.steady_turn
    if turn is None:
        return {}
    wind_up, stiffness = turn.wind_up_range, turn.stiffness
    sides = (Extreme(stiffness * side.value, side.theta) for side in (wind_up.low, wind_up.high))
    errors = dict(zip(("follower_error",), turn.errors, strict=False))  # of a crank there is none
    return {"wind_up": wind_up, **errors, "shaft_torque": Extremes(*sides)}


def _of_the_turn(study: Study, stage: str, only: tuple[str, ...]) -> Mapping[str, Extremes]:
    rows = _rows(study, stage, only)
    with study.located(stage):
        found = _searched(study, rows)
    return _finished(study, stage, found)


def _rows(study: Study, stage: str, only: tuple[str, ...]) -> dict[str, Quantity]:
    return {
        name: row
        for name, row in quantities_of(study, stage).items()
        if not row.turns and (name in only if only else exists(study, row))
    }


@np.errstate(invalid="ignore", over="ignore")  # infinite rates at dead centres
def _searched(study: Study, rows: Mapping[str, Quantity]) -> dict[str, Extremes]:
    def values(angles: Angles) -> Mapping[str, np.ndarray]:
        there = study.at(angles)
        return {name: row.value(there) for name, row in rows.items()}

    found = find_extremes(values, study.program)
    if study.design.drive.motion is not None and study.design.drive.motion.gain:
        found = _at_the_end(found, values(study.program.angles(np.zeros(1))))
    return found


@np.errstate(invalid="ignore", over="ignore")
def _finished(study: Study, stage: str, found: dict[str, Extremes]) -> Mapping[str, Extremes]:
    """Extremes of a stage with those that are infinite."""
    if stage == "cam":
        found |= _infinite_at_cusps(study, found)
    if not study.by_crank:
        return found
    return {name: Extremes(_limit(study, name, r.low), _limit(study, name, r.high)) for name, r in found.items()}


def _at_the_end(found: Mapping[str, Extremes], first: Mapping[str, np.ndarray]) -> dict[str, Extremes]:
    """Of a motion that goes on, what has its extreme where the turn ends, and is another where the next one begins: at 2π."""

    def placed(side: Extreme, begins: float, size: float) -> Extreme:
        ends = side.theta == 0.0 and abs(side.value - begins) > 1e-9 * size
        return Extreme(side.value, TURN) if ends else side

    made = {}
    for name, each in found.items():
        begins, size = float(first[name][0]), max(abs(each.low.value), abs(each.high.value))
        made[name] = Extremes(placed(each.low, begins, size), placed(each.high, begins, size))
    return made


def _infinite_at_cusps(study: Study, found: Mapping[str, Extremes]) -> dict[str, Extremes]:
    """The curvatures among extremes of the cam that grow without limit, as they come out."""
    drive = study.design.drive
    flanks = [(flank, name) for flank, name in PROFILE_CURVATURES.items() if name in found]
    if not flanks:
        return {}
    limits = found if found.keys() >= set(cam.limits_of(drive.face, drive.cam)) else cam_extremes(study)
    return {
        name: _through_cusp(found[name]) for flank, name in flanks if cam.undercut(limits, flank, drive.face, drive.cam)
    }


def _through_cusp(found: Extremes) -> Extremes:
    """A curvature that grows without limit at a cusp, and comes back from below where the profile runs backwards."""
    low = Extreme(-np.inf, found.low.theta) if found.low.value < 0.0 else found.low
    return Extremes(low, Extreme(np.inf, found.high.theta))


def _limit(study: Study, name: str, extreme: Extreme) -> Extreme:
    """An extreme right at a dead centre, or at a change point, is infinite where it grows without limit there."""
    for place, near, inwards in _singular_places(study):
        if abs(extreme.theta - place) < near and _grows(study, name, place, inwards):
            return Extreme(float(np.copysign(np.inf, extreme.value)), place)
    return extreme


def is_unlimited(study: Study, name: str, theta: float) -> bool:
    """Whether a quantity grows without limit towards an angle [rad], where a crank locks or its circuits meet."""
    places = _singular_places(study) if study.by_crank else []
    return any(abs(theta - place) < _AT_END and _grows(study, name, place, inwards) for place, _, inwards in places)


def _singular_places(study: Study) -> list[tuple[float, float, float]]:
    """Dead centres and change points of a crank: angle [rad], distance from it that counts as there, and sign of the way inwards."""
    if study.swings:  # it locks where the cycle begins, and where it turns round
        return [(0.0, _AT_END, 1.0), (np.pi, _AT_END, -1.0), (TURN, _AT_END, -1.0)]
    driver_ranges = study.driver_ranges
    places = [(r.low, _AT_END, 1.0) for r in driver_ranges.ranges if r.low_joint]
    places += [(r.high, _AT_END, -1.0) for r in driver_ranges.ranges if r.high_joint]
    places += [(change.at, _AT_CHANGE, 1.0) for change in driver_ranges.changes]
    return [(place / study.turns, near, inwards) for place, near, inwards in places]


def _grows(study: Study, name: str, place: float, inwards: float) -> bool:
    """Whether a quantity grows without limit towards a place: a hundred times nearer it is more than five times as large."""
    steps = place + inwards * np.array([1e-7, 1e-5])
    nearer, near = np.abs(quantity(name).value(study.at(study.program.angles(steps))))
    return bool(nearer > 5.0 * near)
