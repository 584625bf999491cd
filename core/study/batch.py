"""Figures of a block of designs: computed for all at once where ``is_batchable``, else design by design."""

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
from core.shaft import Flywheel, LoadCurve, combined_load, panel_angles, peaks, rms
from core.shaft.curve import NODES, fitted, nodes, torque_at
from core.shaft.flywheel import energy_ranges
from core.study.drive_forces import load_ratings, roller_force, roller_speed
from core.study.extremes import extremes_of, has_quantity, undercut_on
from core.study.highest import clenshaw_curtis_nodes
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
from core.study.stages_of_many import NO_VALUE, UNDERCUT, DesignBlock, Results
from core.study.study import Study

OUT_OF_RANGE = "out-of-range"
"""Reason of a design, as the codes of errors and findings are: a number is outside the range of its field."""
FAULTY = "design-fault"
"""Reason of a design: its values exclude each other, as a law that only falls with a rise."""

BLOCK_POINTS = 240_000  # nodes of a block, which needs far less than 256 MiB

_MOTION = "motion."
_VARIABLE = ("follower.", "linkage.", "cam.", "loads.", "shaft.", _MOTION)
_SWITCHES = re.compile(r"loads\.process\[\d+\]\.(cam_|position_|points)")
"""When a process force acts: it cuts the turn into pieces."""
_NEEDS_CENTRES = frozenset({"instant_centre", "instant_centre_x", "instant_centre_y", "instant_centre_velocity"})


def is_batchable(design: Design, paths: Sequence[str], request: QuantityRequest) -> bool:
    """Whether a figure of designs that differ at these paths is computed for all of them at once.

    The numbers may be lengths, angles, masses, springs, friction and speed of a follower or a linkage of dyads. The figures
    are of quantities that follow at every cam angle by itself, and totals; of several drives on a shaft, of every drive.
    """
    if request.drive is not None:
        number = request.drive
        return is_batchable(only(design, number), [*paths_inside(design, paths, number)], request._replace(drive=None))
    if design.listed:
        energy = QuantityRequest("", "", ENERGY, 1.0)
        return (
            design.balancer is None
            and request.statistic != LIFE
            and all(
                is_batchable(only(design, i), [*paths_inside(design, paths, i)], energy)
                for i in _loading_drives(design)
            )
        )
    if design.drive.links and any(step.kind in (GROUP, INPUT) for step, _ in plan_of(design.drive.linkage).steps):
        return False
    if not all(path.startswith(_VARIABLE) and not _SWITCHES.match(path) for path in paths):
        return False
    if design.drive.loads.process and any(path.startswith(_MOTION) for path in paths):
        return False
    if not request.name:
        has_open_cam = design.drive.cam is not None and not design.drive.cam.form.holds
        return design.drive.loads_shaft and (request.statistic != LIFE or has_open_cam)
    row = quantity(request.name)
    return (
        row.stage in ("motion", "linkage", "cam", "dynamics")
        and request.name not in OF_MOTOR | _NEEDS_CENTRES
        and not row.needs.startswith("elastic")
    )


@np.errstate(invalid="ignore", over="ignore", divide="ignore")  # infinite values of some designs, at dead centres
def block_results(
    design: Design, infos: Mapping[str, Any], requests: tuple[QuantityRequest, ...], polish: bool, rows: np.ndarray
) -> Results:
    """Figures of the designs of a block.

    Parameters
    ----------
    design : Design
    infos : mapping of str -> Info
        Paths of p numbers, with the infos of their fields.
    requests : tuple of QuantityRequest
        k figures.
    polish : bool
        Refine the extremes.
    rows : ndarray (p, m) [unit of the field]
        The numbers of m designs.

    Returns
    -------
    Results
    """
    paths, m = tuple(infos), rows.shape[1]
    results = _no_results(len(requests), m)
    is_inside = np.all(
        [np.ones(m, dtype=bool), *(_in_range(info, row) for info, row in zip(infos.values(), rows, strict=True))],
        axis=0,
    )
    for number in range(len(design.drives)):
        drive = only(design, number)
        inside = paths_inside(design, paths, number) if design.listed else {path: path for path in paths}
        motion = _varied_motion(drive, tuple(inside), rows[[paths.index(path) for path in inside.values()]])
        for segment in () if motion is None else motion.segments:
            is_inside &= np.asarray(segment.span_deg > 0.0)
        if motion is not None and not has_common_pieces(motion):
            for k in np.flatnonzero(is_inside).tolist():
                if part_faults(map_columns(motion, one_design(k)), "motion"):
                    results.reason[k] = FAULTY
    results.reason[~is_inside] = OUT_OF_RANGE
    good = np.flatnonzero(results.reason == "")
    if not good.size:
        return results
    if good.size == 1:  # numpy multiplies a single number in another order, with other last bits
        good = good.repeat(2)
    batchable = np.array([is_batchable(design, paths, request) for request in requests])
    batched, single = np.flatnonzero(batchable), np.flatnonzero(~batchable)
    remaining = {int(k): single for k in good} if single.size else {}
    if batched.size:
        compute = (
            _drives_results if design.listed else partial(_drive_results, motion=map_columns(motion, at_owners(good)))
        )
        part, again = compute(design, infos, rows[:, good], [requests[i] for i in batched], polish)
        results.value[np.ix_(batched, good)], results.theta[np.ix_(batched, good)] = part.value, part.theta
        results.reason[good] = part.reason
        for k in good[again].tolist():
            remaining[k], results.reason[k] = np.arange(len(requests)), ""
    for k, which in remaining.items():
        study = Study(with_numbers(design, paths, rows[:, k].tolist()))
        values, thetas, reason = study_figures(study, [requests[i] for i in which])
        results.value[which, k], results.theta[which, k] = values, thetas
        results.reason[k] = results.reason[k] or reason
    return results


def _no_results(k: int, m: int) -> Results:
    return Results(np.full((k, m), np.nan), np.full((k, m), np.nan), np.full(m, "", dtype=object))


def _drive_results(
    design: Design,
    infos: Mapping[str, Any],
    rows: np.ndarray,
    requests: Sequence[QuantityRequest],
    polish: bool,
    motion: Motion | None,
) -> tuple[Results, np.ndarray]:
    """Figures of all designs at once, and the mask (m,) of designs to be computed one by one.

    Those are cut at angles of their own. ``motion`` has columns of numbers.
    """
    block = _block(design, tuple(infos), rows, motion)
    named = [i for i, request in enumerate(requests) if request.name]
    totals = [i for i, request in enumerate(requests) if not request.name]
    part = block.results([requests[i] for i in named], polish, bool(totals))
    value, theta = (np.full((len(requests), block.count), np.nan) for _ in range(2))
    value[named], theta[named] = part.value, part.theta
    if totals:
        curves = load_curves(block) if any(requests[i].statistic != LIFE for i in totals) else []
        failed = block.failed_at("dynamics")
        if curves:
            curves = [None if failed[k] else curve for k, curve in enumerate(curves)]
            shafts = _shafts(design, infos, rows)
            value[totals], theta[totals] = load_figures([requests[i] for i in totals], curves, shafts)
        for i in totals:
            if requests[i].statistic == LIFE:
                value[i] = np.where(failed, np.nan, shortest_lives(block))
            block.reason[np.isnan(value[i]) & (block.reason == "")] = NO_VALUE
    return Results(value, theta, block.reason), block.separate


def _shafts(design: Design, infos: Mapping[str, Any], rows: np.ndarray) -> list[Shaft]:
    """Shaft of every design."""
    of_shaft = [i for i, path in enumerate(infos) if path.startswith("shaft.")]
    if not of_shaft:
        return [design.camshaft] * rows.shape[1]
    paths = [list(infos)[i] for i in of_shaft]
    return [with_numbers(design, paths, row).camshaft for row in rows[of_shaft].T.tolist()]


# -- several drives ----------------------------------------------------------------------------------------


def _loading_drives(design: Design) -> list[int]:
    """Numbers of the drives that load the shaft."""
    return [i for i, drive in enumerate(design.drives) if drive.loads_shaft]


def paths_inside(design: Design, paths: Sequence[str], number: int) -> dict[str, str]:
    """Path in the design of a single drive -> path in the whole design, of the numbers on which this drive depends."""
    inside = {inner: path for path in paths for at, inner in [drive_at(path) or (-1, "")] if at == number}
    return inside | {path: path for path in paths if path in SPEEDS}


def _drives_results(
    design: Design, infos: Mapping[str, Any], rows: np.ndarray, requests: Sequence[QuantityRequest], polish: bool
) -> tuple[Results, np.ndarray]:
    """Figures of several drives on a shaft: first of every drive, then of the total load."""
    m, paths = rows.shape[1], list(infos)
    results = _no_results(len(requests), m)
    totals = [i for i, request in enumerate(requests) if request.drive is None]
    loads: list[list[tuple[Any, ShaftPosition]]] = [[] for _ in range(m)]
    for number in range(len(design.drives)):
        named = [i for i, request in enumerate(requests) if request.drive == number]
        needs_load = bool(totals) and number in _loading_drives(design)
        if not named and not needs_load:
            continue
        drive, inside = only(design, number), paths_inside(design, paths, number)
        numbers = rows[[paths.index(path) for path in inside.values()]]
        drive_infos = {inner: infos[path] for inner, path in inside.items()}
        is_constant = not inside  # no number of this drive is varied
        if is_constant:
            drive_infos, numbers = number_fields(drive, SPEEDS[:1]), np.array([[drive.speed_rpm]])
        if named:
            drive_requests = tuple(requests[i]._replace(drive=None) for i in named)
            part = block_results(drive, drive_infos, drive_requests, polish, numbers)
            results.value[named], results.theta[named] = part.value, part.theta
            _add_reasons(results.reason, part.reason)
        if needs_load:
            curves, reason = _drive_loads(drive, drive_infos, numbers)
            _add_reasons(results.reason, reason)
            path = path_of(number, "phase_deg")
            phase = rows[paths.index(path)] if path in infos else design.drives[number].phase_deg
            for k, phase_rad in enumerate(np.deg2rad(np.broadcast_to(phase, m) % 360.0).tolist()):
                loads[k].append((curves[0 if is_constant else k], ShaftPosition(phase_rad)))
    if totals:
        curves = [None if any(curve is None for curve, _ in parts) else combined_load(parts) for parts in loads]
        shafts = _shafts(design, infos, rows)
        results.value[totals], results.theta[totals] = load_figures([requests[i] for i in totals], curves, shafts)
    return results, np.zeros(m, dtype=bool)


def _drive_loads(
    design: Design, infos: Mapping[str, Any], rows: np.ndarray
) -> tuple[list[LoadCurve | None], np.ndarray]:
    """Load on the shaft of every design of one drive, and the reason (m,) where a design has none."""
    block = design_block(design, tuple(infos), rows)
    block.results([], polish=True, loads=True)
    curves, failed = load_curves(block), block.failed_at("dynamics")
    reason = np.where(block.separate, "", block.reason)
    for k in range(block.count):
        if block.separate[k]:
            try:
                curves[k] = Study(with_numbers(design, tuple(infos), rows[:, k].tolist())).load_curve
            except NoSolution as error:
                curves[k], reason[k] = None, error.code
        elif failed[k]:
            curves[k] = None
    return curves, reason


def _add_reasons(reason: np.ndarray, more: np.ndarray) -> None:
    """Fill reasons that are empty; the first reason of a design stays."""
    reason[reason == ""] = np.broadcast_to(more, reason.shape)[reason == ""]


# -- varied numbers ----------------------------------------------------------------------------------------


def with_numbers(design: Design, paths: Sequence[str], numbers: Sequence[Any]) -> Design:
    """The design with these numbers; segments whose span and rise are not varied make up for a span or rise that changes."""
    varied = {row_at(path)[1] for path in paths if path.startswith(_MOTION)}
    for number in sorted({at[0] for path in paths if design.listed and (at := drive_at(path))}):
        inside = {path: inner for path in paths for at, inner in [drive_at(path) or (-1, "")] if at == number}
        values = [value for path, value in zip(paths, numbers, strict=True) if path in inside]
        design = with_only(design, number, with_numbers(only(design, number), list(inside.values()), values))
    for path, number in zip(paths, numbers, strict=True):
        if path.startswith(_MOTION):
            design = edited(design, path, number, varied)
        elif not (design.listed and drive_at(path)):
            design = put(design, path, number)
    return design


def _varied_motion(design: Design, paths: Sequence[str], rows: np.ndarray) -> Motion | None:
    """The motion with a column for each of its numbers among these (p, m); None where none of them belongs to it."""
    varied = {path: column(row) for path, row in zip(paths, rows, strict=True) if path.startswith(_MOTION)}
    return with_numbers(design, list(varied), list(varied.values())).drive.motion if varied else None


def design_block(design: Design, paths: Sequence[str], rows: np.ndarray) -> DesignBlock:
    """Block of designs that differ in some numbers; the ranges of their fields are not checked.

    Parameters
    ----------
    design : Design
    paths : sequence of str
        Paths of p numbers.
    rows : ndarray (p, m) [unit of the field]
        The numbers of m designs.

    Returns
    -------
    DesignBlock
    """
    return _block(design, paths, rows, _varied_motion(design, paths, rows))


def _block(design: Design, paths: Sequence[str], rows: np.ndarray, motion: Motion | None) -> DesignBlock:
    constant_motion = {path: row for path, row in zip(paths, rows, strict=True) if not path.startswith(_MOTION)}
    return DesignBlock(design, constant_motion, motion, rows.shape[1])


def _in_range(info: Any, row: np.ndarray) -> np.ndarray:
    """Mask (m,) of the numbers (m,) within the range of their field."""
    above = row > info.low if info.open_low else row >= info.low
    return np.asarray(above & (row <= info.high) & np.isfinite(row))


def block_size(design: Design) -> int:
    """Number of designs in a block; it does not depend on the varied numbers."""
    motion = design.drives[0].motion
    if motion is None or len(design.drives) > 1:
        return BLOCK_POINTS // 128
    return max(1, BLOCK_POINTS // clenshaw_curtis_nodes(Study(design).uncut)[0].theta.size)


# -- figures of a single design ----------------------------------------------------------------------------


def study_figures(study: Study, requests: Sequence[QuantityRequest]) -> tuple[list[float], list[float], str]:
    """Values in SI units, cam angles [rad] and reason of a single design; NaN where it has no value."""
    reasons = []
    values, thetas = [np.nan] * len(requests), [np.nan] * len(requests)
    for i, request in enumerate(requests):
        try:
            values[i], thetas[i] = _study_figure(study, request)
        except NoSolution as error:
            reasons.append(error.code)
        except _NoValue as error:
            reasons.append(str(error))
    if not reasons:
        drives = list(study.drives.values())
        with_shape = {r.drive or 0: None for r in requests if r.name and quantity(r.name).stage in ("cam", "dynamics")}
        for drive in (drives[number] for number in with_shape if "cam" in drives[number].stages):
            try:
                reasons += [UNDERCUT for flank in drive.cam.flanks if undercut_on(drive, flank.name)]
            except NoSolution as error:  # at no single angle, but over the turn
                reasons.append(error.code)
    return values, thetas, reasons[0] if reasons else ""


class _NoValue(Exception):
    """A design that could have a value has none; the text is its reason."""


def _study_figure(study: Study, request: QuantityRequest) -> tuple[float, float]:
    """Value and cam angle [rad] of a figure. Raises NoSolution or _NoValue where it has none."""
    if request.drive is not None:
        return _study_figure(list(study.drives.values())[request.drive], request._replace(drive=None))
    row, statistic = quantity(request.name) if request.name else None, request.statistic
    for drive in study.drives.values() if row is None or row.stage == "dynamics" else ():
        if drive.loads_shaft and drive.jam is not None:
            raise _NoValue(dynamics.jam_finding(drive.jam, drive.jamming_pair).code)
    if statistic in TOTALS:
        total = float(TOTALS[statistic](study))
        if np.isnan(total):
            raise _NoValue(NO_VALUE)
        return total, np.nan
    if row is None:
        return LOAD_FIGURES[statistic](study.camshaft.load, study.design.camshaft)
    if not has_quantity(study, row) or quantities_of(study, row.stage)[row.name].is_periodic:
        raise _NoValue(UNDERCUT if row.needs_smooth_profile else NO_VALUE)
    if statistic in ("rms", "mean"):
        angles, weight = clenshaw_curtis_nodes(study.program)
        values = np.broadcast_to(row.value(study.at(angles)), angles.theta.size)
        return mean_statistic(values, weight, statistic), np.nan
    extremes = extremes_of(study, row.stage, (request.name,))[request.name]
    value, theta = extreme_statistic(statistic, *((end.value, end.theta) for end in (extremes.low, extremes.high)))
    return float(value), float(theta)


# -- loads on the shaft of the designs of a block ----------------------------------------------------------------


COARSE_PANEL, FEW_PANELS = np.deg2rad(9.0), 2
"""Longest panel of a load, and least number of panels in a piece; a load that they do not resolve takes those of a study."""
RESOLVED = 1e-8  # of the largest torque: the last two coefficients of a panel that resolves it
LIFE_PANEL = np.deg2rad(6.0)
TOTAL_POINTS = 60_000  # cam angles at a time

Panels = tuple[np.ndarray, np.ndarray, Angles]
"""Panels (start, width), and the angles of their nodes."""


def load_curves(block: DesignBlock) -> list[LoadCurve | None]:
    """Load of every design by its cam angle, as by ``fit_load_curve``; None where it is not finite."""
    slides = [f for f in block.loading.frictions if block.mechanism.pairs_by_name[f.pair].kind == SLIDING]
    switches = [
        block.add_reader(f"switch {i}", partial(_switch, switch))
        for i, switch in enumerate(friction_switches(block.loading, slides, block.is_form_closed))
    ]
    rows = [
        block.add_reader("torque of the shaft", lambda study: study.shaft_torque),
        block.add_reader("inertia at the shaft", lambda study: study.loading.inertia(study.linkage, 1)[0]),
    ]
    coarse = panel_angles(block.program, None, COARSE_PANEL, FEW_PANELS)
    sampled = _values(block, [*rows, *switches], [(k, coarse[2]) for k in range(block.count)])
    cuts = _sign_changes(block, switches, coarse[2], np.array([row[2:] for row in sampled])) if switches else {}
    panels = [
        panel_angles(block.program, cuts[k], COARSE_PANEL, FEW_PANELS) if k in cuts else coarse
        for k in range(block.count)
    ]
    for k, values in zip(cuts, _values(block, rows, [(k, panels[k][2]) for k in cuts]), strict=True):
        sampled[k] = values
    rough = [k for k in range(block.count) if np.isfinite(sampled[k]).all() and not _is_resolved(sampled[k][0])]
    for k in rough:
        panels[k] = panel_angles(block.program, cuts.get(k))
    for k, values in zip(rough, _values(block, rows, [(k, panels[k][2]) for k in rough]), strict=True):
        sampled[k] = values
    return [_load_curve(block, k, panels[k], sampled[k][:2]) for k in range(block.count)]


def _switch(switch: Switch, study: Study) -> np.ndarray:
    return switch(study.linkage, study.dynamics)


def _values(block: DesignBlock, names: Sequence[str], angles: Sequence[tuple[int, Angles]]) -> list[np.ndarray]:
    """Values (k, n) of k names, of pairs of a design and its angles (n,)."""
    result: list[np.ndarray] = []
    for part in _parts(angles):
        sizes = [at.theta.size for _, at in part]
        theta, piece = (np.concatenate([getattr(at, name) for _, at in part]) for name in ("theta", "piece"))
        owner = np.repeat([k for k, _ in part], sizes)
        values = block.values(names, block.state(theta, piece, owner), owner)
        result += np.split(np.array([values[name] for name in names]), np.cumsum(sizes)[:-1], axis=1)
    return result


def _parts(angles: Sequence[tuple[int, Angles]]) -> Iterator[Sequence[tuple[int, Angles]]]:
    """Parts of these pairs that are computed at a time."""
    first, count = 0, 0
    for i, (_, at) in enumerate(angles):
        if count and count + at.theta.size > TOTAL_POINTS:
            yield angles[first:i]
            first, count = i, 0
        count += at.theta.size
    if count:
        yield angles[first:]


def _sign_changes(block: DesignBlock, names: Sequence[str], angles: Angles, values: np.ndarray) -> dict[int, Angles]:
    """Number of a design -> angles at which one of the quantities changes its sign, from values (m, k, n) at angles (n,)."""
    pieces, count = block.program.starts.size, block.count
    every = Angles(np.tile(angles.theta, count), (np.arange(count)[:, None] * pieces + angles.piece).ravel())

    def values_at(at: Angles) -> np.ndarray:
        owner = at.piece // pieces
        rows = block.values(names, block.state(at.theta, at.piece % pieces, owner), owner)
        return np.array([rows[name] for name in names])

    changes = crossings(values_at, every, values.transpose(1, 0, 2).reshape(len(names), -1))
    owner, piece = changes.piece // pieces, changes.piece % pieces
    return {int(k): Angles(changes.theta[owner == k], piece[owner == k]) for k in np.unique(owner)}


def _is_resolved(torque: np.ndarray) -> bool:
    _, to_chebyshev = nodes()
    c = np.abs(to_chebyshev @ torque.reshape(-1, NODES).T)
    return not c[-2:].max() > RESOLVED * c.max()


def _load_curve(block: DesignBlock, k: int, panels: Panels, values: np.ndarray) -> LoadCurve | None:
    """Load of design k from torque and inertia (2, n) at the nodes of its panels."""
    if not np.isfinite(values).all():
        return None
    start, width, angles = panels
    if block.motions is not None:
        owner, piece = np.full(start.size, k), angles.piece[::NODES]
        ends = block.motions.cam_angles(start + width, piece, owner)
        start = block.motions.cam_angles(start, piece, owner)
        width = ends - start
    torque, inertia = (row.reshape(-1, NODES) for row in values)
    curve = fitted(start, width, torque, inertia)
    sign = Study(block.plain).turn_sign
    return curve if sign > 0.0 else combined_load([(curve, ShaftPosition(0.0, sign))])


def load_figures(
    requests: Sequence[QuantityRequest], curves: Sequence[LoadCurve | None], shafts: Sequence[Shaft]
) -> tuple[np.ndarray, np.ndarray]:
    """Figures of m loads on their shafts.

    Parameters
    ----------
    requests : sequence of QuantityRequest
        k totals, or statistics of the shaft's torque.
    curves : sequence of LoadCurve or None
        The loads; None where a design has none.
    shafts : sequence of Shaft

    Returns
    -------
    value : ndarray (k, m) [SI unit of the figure]
        NaN where a design has no load.
    theta : ndarray (k, m) [rad]
        Cam angles of extremes, else NaN.
    """
    values, thetas = np.full((2, len(requests), len(curves)), np.nan)
    loads = [(k, curve, shafts[k]) for k, curve in enumerate(curves) if curve is not None]
    for i, request in enumerate(requests):
        if request.statistic == ENERGY and loads:
            low, high = energy_ranges([curve for _, curve, _ in loads])
            values[i, [k for k, _, _ in loads]] = high - low
        for k, curve, shaft in loads if request.statistic in LOAD_FIGURES else ():
            values[i, k], thetas[i, k] = LOAD_FIGURES[request.statistic](curve, shaft)
    return values, thetas


def _torque_extreme(statistic: str, curve: LoadCurve, shaft: Shaft) -> tuple[float, float]:
    extremes = peaks(curve)
    return extreme_statistic(statistic, *((end.value, end.theta) for end in (extremes.low, extremes.high)))


def _flywheel_inertia(curve: LoadCurve, shaft: Shaft) -> tuple[float, float]:
    return Flywheel(lambda angles: torque_at(curve, angles.theta), curve, shaft).needed_inertia, np.nan


LOAD_FIGURES: dict[str, Callable[[LoadCurve, Shaft], tuple[float, float]]] = {
    "flywheel_inertia_kg_m2": _flywheel_inertia,
    "mean": lambda curve, shaft: (curve.mean, np.nan),
    "rms": lambda curve, shaft: (rms(curve), np.nan),
    **{statistic: partial(_torque_extreme, statistic) for statistic in ("max", "min", "abs", "range")},
}
"""Figure -> function of load and shaft: value in SI units and cam angle [rad]."""


def shortest_lives(block: DesignBlock) -> np.ndarray:
    """Life of the roller with the shortest life, of designs with an open cam, as by ``roller_lives``.

    Returns
    -------
    ndarray (m,) [h]
        NaN where no roller has a load rating.
    """
    ratings = {} if block.loading.is_empty else load_ratings(Study(block.design))
    if not ratings:
        return np.full(block.count, np.nan)

    names = []
    for roller in ratings:
        names.append(block.add_reader(f"force {roller}", partial(roller_force, roller=roller)))
        names.append(block.add_reader(f"speed {roller}", partial(_speed_ratio, roller)))
    angles, weight = stress.turn_quadrature(block.program, (), LIFE_PANEL)
    values = np.array(_values(block, names, [(k, angles) for k in range(block.count)]))
    if block.motions is not None:
        weight = weight * block.motions.span_ratios()[:, angles.piece]
    omega = np.broadcast_to(np.asarray(Study(block.design).omega), block.count)
    shortest = np.full(block.count, inf)
    for i, rating in enumerate(ratings.values()):
        *_, hours = stress.rolling_life(np.asarray(rating), values[:, 2 * i], values[:, 2 * i + 1], weight, omega)
        shortest = np.minimum(shortest, hours)
    return shortest


def _speed_ratio(roller: str, study: Study) -> np.ndarray:
    """Speed ω_r/ω (n,) of a roller about its own axis."""
    return roller_speed(study, roller) / study.omega
