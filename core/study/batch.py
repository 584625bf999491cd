"""Figures of a block of designs: computed for all at once where ``is_batchable``, else design by design."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from core import dynamics
from core.design import Design, Motion, only, part_faults, path_of, put, varied
from core.design.camshaft import drive_at
from core.design.curves import has_common_pieces, has_optimal_laws
from core.design.edits import balance
from core.design.rules import CLOSING
from core.design.topology import GROUP, INPUT
from core.errors import NoSolution
from core.mechanism import plan_of
from core.motion.program import ShaftPosition
from core.numerics.lazy import at_owners, column, map_columns, one_design
from core.shaft import LoadCurve, combined_load, combined_loads
from core.study.extremes import extremes_beyond_lash, extremes_of, has_quantity, search_together, undercut_on
from core.study.highest import clenshaw_curtis_nodes
from core.study.limits import SPEEDS
from core.study.loads_of_many import (
    MOTOR_SPEED,
    MOTOR_TORQUE,
    OF_STEADY_SPEED,
    load_curves,
    load_figures,
    motor_figures,
    shortest_lives,
)
from core.study.quantities import CLEARANCES, OF_MOTOR, quantities_of, quantity
from core.study.quantity_requests import (
    ENERGY,
    LIFE,
    TOTALS,
    QuantityRequest,
    extreme_statistic,
    mean_statistic,
    number_fields,
)
from core.study.spatial_checks import shape_errors
from core.study.stages import memory
from core.study.stages_of_many import NO_VALUE, UNDERCUT, DesignBlock, Results
from core.study.study import Study

OUT_OF_RANGE = "out-of-range"
"""Reason of a design, as the codes of errors and findings are: a number is outside the range of its field."""
FAULTY = "design-fault"
"""Reason of a design: its values exclude each other, as a law that only falls with a rise."""
SPANS = "spans"
"""Reason of a design: its varied spans leave nothing to the segments that make up for them, or there is no such segment."""

BLOCK_POINTS = 240_000  # nodes of a block, which needs far less than 256 MiB

_MOTION = "motion."
_VARIABLE = ("follower.", "linkage.", "cam.", "loads.", "shaft.", _MOTION)
_SWITCHES = re.compile(r"loads\.process\[\d+\]\.(cam_|position_|points)")
"""When a process force acts, which cuts the turn into pieces; and the dimensions of valve springs."""
_NEEDS_CENTRES = frozenset({"instant_centre", "instant_centre_x", "instant_centre_y", "instant_centre_velocity"})


def is_batchable(design: Design, paths: Sequence[str], request: QuantityRequest) -> bool:
    """Whether a figure of designs that differ at these paths is computed for all of them at once.

    The numbers may be lengths, angles, masses, springs, friction and speed of a follower or a linkage of dyads. The figures
    are of quantities that follow at every cam angle by itself, and totals; of several drives on a shaft, of every drive.
    """
    if request.drive is not None:
        number = request.drive
        return is_batchable(only(design, number), [*paths_inside(design, paths, number)], request._replace(drive=None))
    if design.listed and request.name:  # a clearance
        return False
    if design.listed:
        energy = QuantityRequest("", "", ENERGY, 1.0)
        return (
            design.balancer is None
            and request.statistic != LIFE
            and not any(_moves_its_phase(design, path) for path in paths)
            and all(
                is_batchable(only(design, i), [*paths_inside(design, paths, i)], energy)
                for i in _loading_drives(design)
            )
        )
    if design.drive.motion is not None and design.drive.motion.needs_machine:  # each design has its own laws
        return False
    if design.drive.links and any(step.kind in (GROUP, INPUT) for step, _ in plan_of(design.drive.linkage).steps):
        return False
    if design.drive.has_surface:
        return False
    if not all(path.startswith(_VARIABLE) and not _SWITCHES.match(path) for path in paths):
        return False
    if design.drive.loads.process and any(path.startswith(_MOTION) for path in paths):
        return False
    if not _keeps_its_lash(design, paths) or _is_least_beyond_lash(design, request):
        return False
    if request.name in OF_STEADY_SPEED:
        return design.drive.loads_shaft
    if not request.name:
        has_open_cam = design.drive.has_disk and not design.drive.cam.form.holds
        return design.drive.loads_shaft and (request.statistic != LIFE or has_open_cam)
    row = quantity(request.name)
    return (
        row.stage in ("motion", "linkage", "cam", "dynamics")
        and row.table != CLEARANCES
        and request.name not in OF_MOTOR | _NEEDS_CENTRES | {"valve_spring_force"}
        and not row.needs.startswith("elastic")
    )


def _is_least_beyond_lash(design: Design, request: QuantityRequest) -> bool:
    """Whether a figure is the least contact force of a valve train with lash: that of the open valve, since a loose train has none."""
    valve = design.drive.valve
    return (request.name, request.statistic) == ("contact_force", "min") and valve is not None and bool(valve.lash_mm)


def _keeps_its_lash(design: Design, paths: Sequence[str]) -> bool:
    """Whether the motion at which a valve opens, which cuts the turn, is common to designs that differ at these paths."""
    valve = design.drive.valve
    if valve is None or (valve.link is None and not valve.lash_mm):
        return True
    fixed = ("loads.", "shaft.", *(("follower.", "cam.") if design.drive.is_valve_motion else ()))
    if valve.link is not None or not all(path.startswith(fixed) for path in paths):
        return False
    try:
        return Study(design).lash is not None
    except NoSolution:  # one by one each design has its reason
        return False


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
        if motion is not None:
            results.reason[is_inside & ~np.asarray(_spans_make_a_turn(motion))] = SPANS
        if motion is not None and not has_common_pieces(motion):
            for k in np.flatnonzero(is_inside & (results.reason == "")).tolist():
                one_motion = map_columns(motion, one_design(k))
                if part_faults(one_motion, "motion") or not has_optimal_laws(one_motion):
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
    block.add_reader(MOTOR_TORQUE, lambda study: study.shaft_torque)  # without a flywheel
    block.add_reader(MOTOR_SPEED, lambda study: np.asarray(study.omega))
    named = [i for i, request in enumerate(requests) if request.name]
    totals = [i for i, request in enumerate(requests) if not request.name]
    of_motor = [i for i, request in enumerate(requests) if request.name in OF_STEADY_SPEED]
    value, theta = (np.full((len(requests), block.count), np.nan) for _ in range(2))
    needs_curves = bool(of_motor) or any(requests[i].statistic != LIFE for i in totals)
    if named or not needs_curves:
        part = block.results([requests[i] for i in named], polish, bool(totals))
        value[named], theta[named] = part.value, part.theta
    curves = load_curves(block, polish, not named) if needs_curves else []
    failed = block.failed_at("dynamics")
    if of_motor:
        *figures, has_inertia = motor_figures(block, [requests[i] for i in of_motor], curves)
        for result, figure in zip((value, theta), figures, strict=True):
            result[of_motor] = np.where(has_inertia, figure, result[of_motor])
    if totals and curves:
        value[totals], theta[totals] = load_figures([requests[i] for i in totals], curves, block.design.camshaft)
    for i in totals:
        if requests[i].statistic == LIFE:
            value[i] = np.where(failed, np.nan, shortest_lives(block))
        block.reason[np.isnan(value[i]) & (block.reason == "")] = NO_VALUE
    for i in of_motor:  # a stall before an undercut, as in the study of a single design
        block.reason[np.isnan(value[i]) & ((block.reason == "") | (block.reason == UNDERCUT))] = NO_VALUE
    return Results(value, theta, block.reason), block.separate


# -- several drives ----------------------------------------------------------------------------------------


def _moves_its_phase(design: Design, path: str) -> bool:
    """Whether a number of a motion changes the phase of its drive, which is determined by the nose of the motion."""
    number, inside = drive_at(path) or (0, "")
    return inside.startswith(_MOTION) and design.drives[number].valve is not None


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
    constant_loads: list[tuple[Any, ShaftPosition]] = []  # the same for all designs
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
            drive_infos, numbers = _at_its_speed(drive)
        if named:
            drive_requests = tuple(requests[i]._replace(drive=None) for i in named)
            part = block_results(drive, drive_infos, drive_requests, polish, numbers)
            results.value[named], results.theta[named] = part.value, part.theta
            _add_reasons(results.reason, part.reason)
        if needs_load:
            curves, reason = _constant_load(drive) if is_constant else _drive_loads(drive, drive_infos, numbers)
            _add_reasons(results.reason, reason)
            path = path_of(number, "phase_deg")
            phase = rows[paths.index(path)] if path in infos else design.drives[number].phase
            positions = [ShaftPosition(angle) for angle in np.deg2rad(np.broadcast_to(phase, m) % 360.0).tolist()]
            if is_constant and path not in infos:
                constant_loads.append((curves[0], positions[0]))
                continue
            for k, position in enumerate(positions):
                loads[k].append((curves[0 if is_constant else k], position))
    if totals:
        if constant_loads:
            is_complete = all(curve is not None for curve, _ in constant_loads)
            constant = (combined_load(constant_loads) if is_complete else None, ShaftPosition())
            loads = [[*parts, constant] for parts in loads]
        complete = [all(curve is not None for curve, _ in parts) for parts in loads]
        total = iter(combined_loads([parts for parts, is_complete in zip(loads, complete, strict=True) if is_complete]))
        curves = [next(total) if is_complete else None for is_complete in complete]
        of_shaft = {path: column(rows[i]) for i, path in enumerate(paths) if path.startswith("shaft.")}
        shaft = with_numbers(design, list(of_shaft), list(of_shaft.values())).camshaft
        results.value[totals], results.theta[totals] = load_figures([requests[i] for i in totals], curves, shaft)
    return results, np.zeros(m, dtype=bool)


def _constant_load(design: Design) -> tuple[list[LoadCurve | None], np.ndarray]:
    """Load of a drive that no varied number changes, as by ``_drive_loads``; it is the same in every block."""

    def compute() -> tuple[list[LoadCurve | None], np.ndarray]:
        return _drive_loads(design, *_at_its_speed(design))

    result: tuple[list[LoadCurve | None], np.ndarray] = memory.get("constant load", design, compute)
    return result


def _at_its_speed(design: Design) -> tuple[dict[str, Any], np.ndarray]:
    """Speed of the shaft in place of varied numbers: the infos of its field, and the number (1, 1) [rpm]."""
    return dict(number_fields(design, SPEEDS[:1])), np.array([[design.speed_rpm]])


def _drive_loads(
    design: Design, infos: Mapping[str, Any], rows: np.ndarray
) -> tuple[list[LoadCurve | None], np.ndarray]:
    """Load on the shaft of every design of one drive, and the reason (m,) where a design has none."""
    block = design_block(design, tuple(infos), rows)
    curves = load_curves(block, polish=True)
    reason = np.where(block.separate, "", block.reason)
    for k in np.flatnonzero(block.separate).tolist():
        try:
            curves[k] = Study(with_numbers(design, tuple(infos), rows[:, k].tolist())).load_curve
        except NoSolution as error:
            curves[k], reason[k] = None, error.code
    return curves, reason


def _add_reasons(reason: np.ndarray, more: np.ndarray) -> None:
    """Fill reasons that are empty; the first reason of a design stays."""
    reason[reason == ""] = np.broadcast_to(more, reason.shape)[reason == ""]


# -- varied numbers ----------------------------------------------------------------------------------------


def with_numbers(design: Design, paths: Sequence[str], numbers: Sequence[Any]) -> Design:
    """The design with these numbers; segments whose span and rise are not varied make up for a span or rise that changes."""
    return varied(design, dict(zip(paths, numbers, strict=True)), put)


def _varied_motion(design: Design, paths: Sequence[str], rows: np.ndarray) -> Motion | None:
    """The motion with a column for each of its numbers among these (p, m); None where none of them belongs to it."""
    varied = {path: column(row) for path, row in zip(paths, rows, strict=True) if path.startswith(_MOTION)}
    return with_numbers(design, list(varied), list(varied.values())).drive.motion if varied else None


def _spans_make_a_turn(motion: Motion) -> Any:
    """Whether the spans of a motion are positive and add up to 360 deg; with many designs a column."""
    spans = [segment.span_deg for segment in motion.segments]
    closes: Any = abs(balance(360.0, spans)) <= CLOSING
    for span in spans:
        closes = closes & (span > 0.0)
    return closes


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
    if study.has_surface:
        search_together(study, _searched_together(study, requests), lambda: None)
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
        for drive in (drives[number] for number in with_shape if drives[number].has_disk):
            try:
                reasons += [UNDERCUT for flank in drive.cam.flanks if undercut_on(drive, flank.name)]
            except NoSolution as error:  # at no single angle, but over the turn
                reasons.append(error.code)
        reasons += [
            code for number in with_shape if drives[number].has_surface for code in shape_errors(drives[number])
        ]
    return values, thetas, reasons[0] if reasons else ""


def _searched_together(study: Study, requests: Sequence[QuantityRequest]) -> dict[str, tuple[str, ...]]:
    """Stage -> quantities whose extremes follow for one cam in space from the same flanks."""
    names = {request.name for request in requests if request.name and request.statistic not in ("rms", "mean", *TOTALS)}
    rows = [quantity(name) for name in names]
    return {
        stage: tuple(row.name for row in rows if row.stage == stage)
        for stage in ("motion", "linkage", "cam", "dynamics")
    }


class _NoValue(Exception):
    """A design that could have a value has none; the text is its reason."""


def _clearance_figure(study: Study, request: QuantityRequest) -> tuple[float, float]:
    """Value and machine angle [rad] of a clearance of several drives."""
    clearances = study.clearances
    pair = clearances.by_column.get(request.name)
    if pair is None:
        raise _NoValue(NO_VALUE)
    if request.statistic in ("rms", "mean"):
        angles, weight = clenshaw_curtis_nodes(clearances.turn)
        return mean_statistic(clearances.distance(pair, clearances.at(angles)), weight, request.statistic), np.nan
    least = clearances.least(pair)
    highest = clearances.greatest(pair)
    value, theta = extreme_statistic(request.statistic, (least.value, least.theta), (highest.value, highest.theta))
    return float(value), float(theta)


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
        values, thetas = load_figures([request], [study.camshaft.load], study.design.camshaft)
        return float(values[0, 0]), float(thetas[0, 0])
    if study.design.listed:
        return _clearance_figure(study, request)
    if not has_quantity(study, row) or quantities_of(study, row.stage)[row.name].is_periodic:
        raise _NoValue(UNDERCUT if row.needs_smooth_profile else NO_VALUE)
    if statistic in ("rms", "mean"):
        angles, weight = clenshaw_curtis_nodes(study.program)
        values = np.broadcast_to(row.value(study.at(angles)), angles.theta.size)
        return mean_statistic(values, weight, statistic), np.nan
    extremes = (
        extremes_beyond_lash(study, request.name)
        if _is_least_beyond_lash(study.design, request)
        else extremes_of(study, row.stage, (request.name,))[request.name]
    )
    value, theta = extreme_statistic(statistic, *((end.value, end.theta) for end in (extremes.low, extremes.high)))
    return float(value), float(theta)
