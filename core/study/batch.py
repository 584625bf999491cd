"""A block of many designs: of all at once what ``together`` says can be, the rest design by design."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from math import inf
from typing import Any

import numpy as np

from core import dynamics, stress
from core.design import Design, Motion, Shaft, edited, only, part_faults, path_of, put, row_at, with_only
from core.design.camshaft import drive_at
from core.design.topology import GROUP, INPUT
from core.errors import NoSolution
from core.mechanism import plan_of
from core.mechanism.kinematics import SLIDING
from core.motion import Angles
from core.motion.curves import has_common_pieces
from core.motion.extremes import crossings
from core.motion.program import ShaftPosition
from core.numerics.lazy import at_owners, column, map_columns, one_design
from core.shaft import Flywheel, LoadCurve, combined, panel_angles, peaks, rms
from core.shaft.curve import NODES, fitted, nodes, value
from core.shaft.flywheel import energy_ranges
from core.study.drive_forces import load_ratings, roller_force, roller_speed
from core.study.extremes import extremes_of, has_quantity, undercut_on
from core.study.highest import nodes_of
from core.study.limits import SPEEDS
from core.study.quantities import OF_MOTOR, quantities_of, quantity
from core.study.quantity_requests import (
    ENERGY,
    LIFE,
    TOTALS,
    QuantityRequest,
    extreme_statistic,
    mean_statistic,
    number_fields,
)
from core.study.stages import Switch, friction_switches
from core.study.stages_of_many import NO_VALUE, UNDERCUT, Results, Together
from core.study.study import Study

# -- A block of many designs ------------------------------------------------------------------------------------


OUT_OF_RANGE = "out-of-range"
"""Reason beside the codes of errors and findings: a number lies outside the range of its field."""
FAULTY = "design-fault"
"""The same: these values do not go together in a design, as a law that only falls with a rise."""

BLOCK_POINTS = 240_000  # nodes of a block, which takes far less than 256 MiB

_MOTION = "motion."
_VARIED = ("follower.", "linkage.", "cam.", "loads.", "shaft.", _MOTION)
_SWITCHES = re.compile(r"loads\.process\[\d+\]\.(cam_|position_|points)")
"""When a process force works, by which the turn is cut into pieces."""
_READS_CENTRES = frozenset({"instant_centre", "instant_centre_x", "instant_centre_y", "instant_centre_velocity"})


def together(design: Design, paths: Sequence[str], asked: QuantityRequest) -> bool:
    """Whether what is asked of designs that differ in these paths is computed of all at once: lengths, angles, masses, springs,
    friction and speed of a follower or a linkage of dyads, quantities that follow at each angle by itself, with their totals; of several
    drives on a shaft those of each."""
    if asked.drive is not None:
        return together(
            only(design, asked.drive), [*paths_inside(design, paths, asked.drive)], asked._replace(drive=None)
        )
    if design.listed:
        return (
            design.balancer is None
            and asked.statistic != LIFE
            and all(
                together(only(design, i), [*paths_inside(design, paths, i)], QuantityRequest("", "", ENERGY, 1.0))
                for i in _carried(design)
            )
        )
    if design.drive.links and any(step.kind in (GROUP, INPUT) for step, _ in plan_of(design.drive.linkage).steps):
        return False
    if not all(path.startswith(_VARIED) and not _SWITCHES.match(path) for path in paths):
        return False
    if design.drive.loads.process and any(path.startswith(_MOTION) for path in paths):
        return False
    if not asked.name:
        return design.drive.loads_shaft and not (
            asked.statistic == LIFE and (design.drive.cam is None or design.drive.cam.form.holds)
        )
    row = quantity(asked.name)
    return (
        row.stage in ("motion", "linkage", "cam", "dynamics")
        and asked.name not in OF_MOTOR | _READS_CENTRES
        and not row.needs.startswith("elastic")
    )


@np.errstate(invalid="ignore", over="ignore", divide="ignore")  # infinite values of some, as rates at dead centres
def block(
    design: Design, infos: Mapping[str, Any], asked: tuple[QuantityRequest, ...], polish: bool, rows: np.ndarray
) -> Results:
    """What is asked of the designs with these numbers (p, m)."""
    paths, m = tuple(infos), rows.shape[1]
    found = Results(np.full((len(asked), m), np.nan), np.full((len(asked), m), np.nan), np.full(m, "", dtype=object))
    inside = np.all(
        [np.ones(m, dtype=bool), *(_admitted(i, row) for i, row in zip(infos.values(), rows, strict=True))], axis=0
    )
    for number in range(len(design.drives)):
        own, here = (
            only(design, number),
            paths_inside(design, paths, number) if design.listed else {path: path for path in paths},
        )
        motion = _own_motion(own, tuple(here), rows[[paths.index(path) for path in here.values()]])
        for segment in () if motion is None else motion.segments:
            inside &= np.asarray(segment.span_deg > 0.0)
        if motion is not None and not has_common_pieces(motion):
            for k in np.flatnonzero(inside).tolist():
                if part_faults(map_columns(motion, one_design(k)), "motion"):
                    found.reason[k] = FAULTY
    found.reason[~inside] = OUT_OF_RANGE
    good = np.flatnonzero(found.reason == "")
    if not good.size:
        return found
    if good.size == 1:  # of a single number numpy takes products in another order, with other last bits
        good = good.repeat(2)
    chosen = np.array([together(design, paths, each) for each in asked])
    at_once, alone = np.flatnonzero(chosen), np.flatnonzero(~chosen)
    further = {int(k): alone for k in good} if alone.size else {}
    if at_once.size:
        every = _of_drives if design.listed else partial(_of_one, motion=map_columns(motion, at_owners(good)))
        part, again = every(
            design,
            infos,
            rows[:, good],
            [asked[i] for i in at_once],
            polish,
        )
        found.value[np.ix_(at_once, good)], found.theta[np.ix_(at_once, good)] = part.value, part.theta
        found.reason[good] = part.reason
        for k in good[again].tolist():
            further[k], found.reason[k] = np.arange(len(asked)), ""
    for k, which in further.items():
        single = Study(with_numbers(design, paths, rows[:, k].tolist()))
        values, thetas, reason = asked_of_study(single, [asked[i] for i in which])
        found.value[which, k], found.theta[which, k] = values, thetas
        found.reason[k] = found.reason[k] or reason
    return found


def _of_one(
    design: Design,
    infos: Mapping[str, Any],
    rows: np.ndarray,
    asked: Sequence[QuantityRequest],
    polish: bool,
    motion: Motion | None,
) -> tuple[Results, np.ndarray]:
    """What is asked of all at once, whose motion has columns; and which designs (m,) are computed by themselves instead, as their turn is
    cut at angles of their own."""

    one = _with_motion(design, tuple(infos), rows, motion)
    whole = [not each.name for each in asked]
    part = one.results([each for each in asked if each.name], polish, any(whole))
    value, theta = (np.full((len(asked), one.count), np.nan) for _ in range(2))
    named = [i for i, each in enumerate(whole) if not each]
    value[named], theta[named] = part.value, part.theta
    if any(whole):
        wanted = [i for i, each in enumerate(whole) if each]
        curves = loads(one) if any(asked[i].statistic != LIFE for i in wanted) else []
        lost = one.lost_at("dynamics")
        if curves:
            curves = [None if lost[k] else curve for k, curve in enumerate(curves)]
            value[wanted], theta[wanted] = asked_of_loads(
                [asked[i] for i in wanted], curves, _shafts(design, infos, rows)
            )
        for i in wanted:
            if asked[i].statistic == LIFE:
                value[i] = np.where(lost, np.nan, lives(one))
            one.reason[np.isnan(value[i]) & (one.reason == "")] = NO_VALUE
    return Results(value, theta, one.reason), one.apart


def _shafts(design: Design, infos: Mapping[str, Any], rows: np.ndarray) -> list[Shaft]:
    """The shaft of each design."""
    own = [i for i, path in enumerate(infos) if path.startswith("shaft.")]
    if not own:
        return [design.camshaft] * rows.shape[1]
    paths = [list(infos)[i] for i in own]
    return [with_numbers(design, paths, row).camshaft for row in rows[own].T.tolist()]


# -- several drives ----------------------------------------------------------------------------------------


def _carried(design: Design) -> list[int]:
    """Numbers of the drives that load the shaft."""
    return [i for i, drive in enumerate(design.drives) if drive.loads_shaft]


def paths_inside(design: Design, paths: Sequence[str], number: int) -> dict[str, str]:
    """Path in a drive alone -> path in the machine, of those that this drive depends on."""
    own = {inner: path for path in paths for at, inner in [drive_at(path) or (-1, "")] if at == number}
    return own | {path: path for path in paths if path in SPEEDS}


def _of_drives(
    design: Design,
    infos: Mapping[str, Any],
    rows: np.ndarray,
    asked: Sequence[QuantityRequest],
    polish: bool,
) -> tuple[Results, np.ndarray]:
    """The same of several drives on a shaft: each by itself, then their loads together."""

    m, paths = rows.shape[1], list(infos)
    found = Results(np.full((len(asked), m), np.nan), np.full((len(asked), m), np.nan), np.full(m, "", dtype=object))
    whole = [i for i, each in enumerate(asked) if each.drive is None]
    places: list[list[tuple[Any, ShaftPosition]]] = [[] for _ in range(m)]
    for number in range(len(design.drives)):
        mine = [i for i, each in enumerate(asked) if each.drive == number]
        carried = bool(whole) and number in _carried(design)
        if not mine and not carried:
            continue
        own, inside = only(design, number), paths_inside(design, paths, number)
        numbers = rows[[paths.index(path) for path in inside.values()]]
        part_of = {inner: infos[path] for inner, path in inside.items()}
        spread = not inside  # nothing of this drive is varied
        if spread:
            part_of, numbers = number_fields(own, SPEEDS[:1]), np.array([[own.speed_rpm]])
        if mine:
            part = block(own, part_of, tuple(asked[i]._replace(drive=None) for i in mine), polish, numbers)
            found.value[mine], found.theta[mine] = part.value, part.theta
            _because(found.reason, part.reason)
        if carried:
            curves, reason = _loads(own, part_of, numbers)
            _because(found.reason, reason)
            phase = (
                rows[paths.index(path)]
                if (path := f"{path_of(number, 'phase_deg')}") in infos
                else design.drives[number].phase_deg
            )
            for k, turned in enumerate(np.deg2rad(np.broadcast_to(phase, m) % 360.0).tolist()):
                places[k].append((curves[0 if spread else k], ShaftPosition(turned)))
    if whole:
        curves = [None if any(curve is None for curve, _ in each) else combined(each) for each in places]
        found.value[whole], found.theta[whole] = asked_of_loads(
            [asked[i] for i in whole], curves, _shafts(design, infos, rows)
        )
    return found, np.zeros(m, dtype=bool)


def _loads(design: Design, infos: Mapping[str, Any], rows: np.ndarray) -> tuple[list[LoadCurve | None], np.ndarray]:
    """What each design of one drive asks of its shaft, and why it has none (m,)."""

    one = at_once(design, tuple(infos), rows)
    one.results([], polish=True, loads=True)
    curves, lost = loads(one), one.lost_at("dynamics")
    reason = np.where(one.apart, "", one.reason)
    for k in range(one.count):
        if one.apart[k]:
            curves[k], reason[k] = _load_of_one(with_numbers(design, tuple(infos), rows[:, k].tolist()))
        elif lost[k]:
            curves[k] = None
    return curves, reason


def _load_of_one(design: Design) -> tuple[LoadCurve | None, str]:
    try:
        return Study(design).load_curve, ""
    except NoSolution as error:
        return None, error.code


def _because(reason: np.ndarray, more: np.ndarray) -> None:
    """What is said first stays."""
    reason[reason == ""] = np.broadcast_to(more, reason.shape)[reason == ""]


# -- what is varied ----------------------------------------------------------------------------------------


def with_numbers(design: Design, paths: Sequence[str], numbers: Sequence[Any]) -> Design:
    """The design with these numbers; a span or a rise takes from segments that are not varied what it gains, as where it is typed."""
    kept = {row_at(path)[1] for path in paths if path.startswith(_MOTION)}
    for number in sorted({own[0] for path in paths if design.listed and (own := drive_at(path))}):
        inside = {path: inner for path in paths for at, inner in [drive_at(path) or (-1, "")] if at == number}
        here = [value for path, value in zip(paths, numbers, strict=True) if path in inside]
        design = with_only(design, number, with_numbers(only(design, number), list(inside.values()), here))
    for path, number in zip(paths, numbers, strict=True):
        if path.startswith(_MOTION):
            design = edited(design, path, number, kept)
        elif not (design.listed and drive_at(path)):
            design = put(design, path, number)
    return design


def _own_motion(design: Design, paths: Sequence[str], rows: np.ndarray) -> Motion | None:
    """The motion with a column for each of its numbers among these (p, m); None where none of them is."""
    moving = {path: column(row) for path, row in zip(paths, rows, strict=True) if path.startswith(_MOTION)}
    return with_numbers(design, list(moving), list(moving.values())).drive.motion if moving else None


def at_once(design: Design, paths: Sequence[str], rows: np.ndarray) -> Together:
    """The designs with these numbers (p, m), whatever the ranges of their fields."""
    return _with_motion(design, paths, rows, _own_motion(design, paths, rows))


def _with_motion(design: Design, paths: Sequence[str], rows: np.ndarray, motion: Motion | None) -> Together:
    fixed = {path: row for path, row in zip(paths, rows, strict=True) if not path.startswith(_MOTION)}
    return Together(design, fixed, motion, rows.shape[1])


def _admitted(info: Any, row: np.ndarray) -> np.ndarray:
    """Whether each number (m,) lies in the range of its field."""
    above = row > info.low if info.open_low else row >= info.low
    return np.asarray(above & (row <= info.high) & np.isfinite(row))


def block_size(design: Design) -> int:
    """Designs of a block; it depends on nothing that is varied."""
    motion = design.drives[0].motion
    points = 128 if motion is None or len(design.drives) > 1 else nodes_of(Study(design).uncut)[0].theta.size
    return max(1, BLOCK_POINTS // points)


# -- design by design --------------------------------------------------------------------------------------


def asked_of_study(study: Study, asked: Sequence[QuantityRequest]) -> tuple[list[float], list[float], str]:
    """Values, cam angles [rad] and reason of a single design."""
    reasons = []
    values, thetas = [np.nan] * len(asked), [np.nan] * len(asked)
    for i, each in enumerate(asked):
        try:
            values[i], thetas[i] = _asked_of_one(study, each)
        except NoSolution as error:
            reasons.append(error.code)
        except _NoValue as error:
            reasons.append(str(error))
    if not reasons:
        drives = list(study.drives.values())
        shaped = {a.drive or 0: None for a in asked if a.name and quantity(a.name).stage in ("cam", "dynamics")}
        for drive in (drives[number] for number in shaped if "cam" in drives[number].stages):
            try:
                reasons += [UNDERCUT for flank in drive.cam.flanks if undercut_on(drive, flank.name)]
            except NoSolution as error:  # at no single angle, but over the turn
                reasons.append(error.code)
    return values, thetas, reasons[0] if reasons else ""


class _NoValue(Exception):
    """A design that could have a value has none; its reason."""


def _asked_of_one(study: Study, asked: QuantityRequest) -> tuple[float, float]:
    if asked.drive is not None:
        return _asked_of_one(list(study.drives.values())[asked.drive], asked._replace(drive=None))
    row = quantity(asked.name) if asked.name else None
    for drive in study.drives.values() if row is None or row.stage == "dynamics" else ():
        if drive.loads_shaft and drive.jam is not None:
            raise _NoValue(dynamics.jam_finding(drive.jam, drive.jamming_pair).code)
    if asked.statistic in TOTALS:
        total = float(TOTALS[asked.statistic](study))
        if np.isnan(total):
            raise _NoValue(NO_VALUE)
        return total, np.nan
    if row is None:
        return OF_LOAD[asked.statistic](study.camshaft.load, study.design.camshaft)
    if not has_quantity(study, row) or quantities_of(study, row.stage)[row.name].is_periodic:
        raise _NoValue(UNDERCUT if row.needs_smooth_profile else NO_VALUE)
    if asked.statistic in ("rms", "mean"):
        angles, weight = nodes_of(study.program)
        return mean_statistic(
            np.broadcast_to(row.value(study.at(angles)), angles.theta.size), weight, asked.statistic
        ), np.nan
    found = extremes_of(study, row.stage, (asked.name,))[asked.name]
    value, theta = extreme_statistic(asked.statistic, *((each.value, each.theta) for each in (found.low, found.high)))
    return float(value), float(theta)


# -- totals of a turn of many designs ---------------------------------------------------------------------------


WIDE, FEW = (
    np.deg2rad(9.0),
    2,
)  # longest panel of a load, and the least of a piece: where these do not hold it, those of a study are taken
RESOLVED = 1e-8  # of the largest torque: what the last two coefficients of a panel may hold
LIFE_PANEL = np.deg2rad(6.0)
TOTAL_POINTS = 60_000  # cam angles at a time

Places = tuple[np.ndarray, np.ndarray, Angles]
"""Panels (start, width) and the angles of their nodes."""


# -- what a design asks of its shaft -----------------------------------------------------------------------


def loads(one: Together) -> list[LoadCurve | None]:
    """The load of each design by its cam's angle, as ``fit_load_curve`` has it; None where it is not finite."""
    slides = [f for f in one.loading.frictions if one.mechanism.pairs_by_name[f.pair].kind == SLIDING]
    switches = [
        one.reader(f"switch {i}", partial(_switch, switch))
        for i, switch in enumerate(friction_switches(one.loading, slides, one.is_form_closed))
    ]
    rows = [
        one.reader("torque of the shaft", lambda there: there.shaft_torque),
        one.reader("inertia at the shaft", lambda there: there.loading.inertia(there.linkage, 1)[0]),
    ]
    wide = panel_angles(one.program, None, WIDE, FEW)
    sampled = _values(one, [*rows, *switches], [(k, wide[2]) for k in range(one.count)])
    cuts = _cuts(one, switches, wide[2], np.array([each[2:] for each in sampled])) if switches else {}
    places = [panel_angles(one.program, cuts[k], WIDE, FEW) if k in cuts else wide for k in range(one.count)]
    for k, found in zip(cuts, _values(one, rows, [(k, places[k][2]) for k in cuts]), strict=True):
        sampled[k] = found
    rough = [k for k in range(one.count) if np.isfinite(sampled[k]).all() and not _resolved(sampled[k][0])]
    for k in rough:
        places[k] = panel_angles(one.program, cuts.get(k))
    for k, found in zip(rough, _values(one, rows, [(k, places[k][2]) for k in rough]), strict=True):
        sampled[k] = found
    return [_curve(one, k, places[k], sampled[k][:2]) for k in range(one.count)]


def _switch(switch: Switch, there: Study) -> np.ndarray:
    return switch(there.linkage, there.dynamics)


def _values(one: Together, names: Sequence[str], places: Sequence[tuple[int, Angles]]) -> list[np.ndarray]:
    """What is read (k, n) of designs, each at angles of its own."""
    found: list[np.ndarray] = []
    for part in _parts(places):
        sizes = [angles.theta.size for _, angles in part]
        theta, piece = (np.concatenate([getattr(angles, name) for _, angles in part]) for name in ("theta", "piece"))
        owner = np.repeat([k for k, _ in part], sizes)
        values = one.values(names, one.state(theta, piece, owner), owner)
        found += np.split(np.array([values[name] for name in names]), np.cumsum(sizes)[:-1], axis=1)
    return found


def _parts(places: Sequence[tuple[int, Angles]]) -> Iterator[Sequence[tuple[int, Angles]]]:
    """As many of these as are computed at a time."""
    first, count = 0, 0
    for i, (_, angles) in enumerate(places):
        if count and count + angles.theta.size > TOTAL_POINTS:
            yield places[first:i]
            first, count = i, 0
        count += angles.theta.size
    if count:
        yield places[first:]


def _cuts(one: Together, names: Sequence[str], angles: Angles, values: np.ndarray) -> dict[int, Angles]:
    """Designs -> the angles in their pieces where one of these quantities (m, k, n) changes its sign, of those where one does."""
    pieces, count = one.program.starts.size, one.count
    every = Angles(np.tile(angles.theta, count), (np.arange(count)[:, None] * pieces + angles.piece).ravel())

    def there(at: Angles) -> np.ndarray:
        owner = at.piece // pieces
        found = one.values(names, one.state(at.theta, at.piece % pieces, owner), owner)
        return np.array([found[name] for name in names])

    found = crossings(there, every, values.transpose(1, 0, 2).reshape(len(names), -1))
    owner, piece = found.piece // pieces, found.piece % pieces
    return {int(k): Angles(found.theta[owner == k], piece[owner == k]) for k in np.unique(owner)}


def _resolved(torque: np.ndarray) -> bool:
    _, to_chebyshev = nodes()
    c = np.abs(to_chebyshev @ torque.reshape(-1, NODES).T)
    return not c[-2:].max() > RESOLVED * c.max()


def _curve(one: Together, k: int, place: Places, values: np.ndarray) -> LoadCurve | None:
    if not np.isfinite(values).all():
        return None
    start, width, angles = place
    if one.motions is not None:
        owner, piece = np.full(start.size, k), angles.piece[::NODES]
        ends = one.motions.own(start + width, piece, owner)
        start = one.motions.own(start, piece, owner)
        width = ends - start
    torque, inertia = (row.reshape(-1, NODES) for row in values)
    curve = fitted(start, width, torque, inertia)
    turning = Study(one.plain).turn_sign
    return curve if turning > 0.0 else combined([(curve, ShaftPosition(0.0, turning))])


# -- what is asked of it -----------------------------------------------------------------------------------


def asked_of_loads(
    asked: Sequence[QuantityRequest], curves: Sequence[LoadCurve | None], shafts: Sequence[Shaft]
) -> tuple[np.ndarray, np.ndarray]:
    """What is asked of m loads on their shafts, and its angle [rad], both (k, m)."""
    value_, theta = np.full((2, len(asked), len(curves)), np.nan)
    good = [k for k, curve in enumerate(curves) if curve is not None]
    there = [(k, curve, shafts[k]) for k, curve in enumerate(curves) if curve is not None]
    for i, each in enumerate(asked):
        if each.statistic == ENERGY and good:
            low, high = energy_ranges([curve for _, curve, _ in there])
            value_[i, good] = high - low
        for k, curve, shaft in there if each.statistic in OF_LOAD else ():
            value_[i, k], theta[i, k] = OF_LOAD[each.statistic](curve, shaft)
    return value_, theta


def _end(of: str, curve: LoadCurve, shaft: Shaft) -> tuple[float, float]:
    found = peaks(curve)
    return extreme_statistic(of, *((end.value, end.theta) for end in (found.low, found.high)))


def _flywheel(curve: LoadCurve, shaft: Shaft) -> tuple[float, float]:
    wheel = Flywheel(lambda angles: value(curve, angles.theta), curve, shaft)
    return wheel.needed_inertia, np.nan


OF_LOAD: dict[str, Callable[[LoadCurve, Shaft], tuple[float, float]]] = {
    "flywheel_inertia_kg_m2": _flywheel,
    "mean": lambda curve, shaft: (curve.mean, np.nan),
    "rms": lambda curve, shaft: (rms(curve), np.nan),
    **{of: partial(_end, of) for of in ("max", "min", "abs", "range")},
}


# -- rollers -----------------------------------------------------------------------------------------------


def lives(one: Together) -> np.ndarray:
    """L10 [h] of the shortest-lived roller of each design (m,), as ``roller_lives`` has them, of an open cam; NaN where none is rated."""
    rated = {} if one.loading.is_empty else load_ratings(Study(one.design))
    if not rated:
        return np.full(one.count, np.nan)

    names = []
    for roller in rated:
        names.append(one.reader(f"force {roller}", partial(roller_force, roller=roller)))
        names.append(one.reader(f"speed {roller}", partial(_speed, roller)))
    angles, weight = stress.turn_quadrature(one.program, (), LIFE_PANEL)
    values = np.array(_values(one, names, [(k, angles) for k in range(one.count)]))
    if one.motions is not None:
        weight = weight * one.motions.stretched()[:, angles.piece]
    omega = np.broadcast_to(np.asarray(Study(one.design).omega), one.count)
    least = np.full(one.count, inf)
    for i, rating in enumerate(rated.values()):
        *_, hours = stress.rolling_life(np.asarray(rating), values[:, 2 * i], values[:, 2 * i + 1], weight, omega)
        least = np.minimum(least, hours)
    return least


def _speed(roller: str, there: Study) -> np.ndarray:
    """Of a roller by cam angle (n,)."""
    return roller_speed(there, roller) / there.omega
