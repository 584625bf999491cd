"""Figures of a design in the units of the tables: extremes, joins, torque, flywheel, findings, certificate."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from core.design import UNITS, Design, distances
from core.design.parts import LINEAR
from core.design.topology import mobility
from core.errors import NoStability
from core.findings import Finding
from core.mechanism.branches import four_bar
from core.motion.extremes import Extreme, Extremes
from core.output.channels import channels, has_cycle, motion_cycle
from core.output.subject_files import SERVO, DriveEffort, drive_efforts, elastic_figures
from core.shaft import Flywheel, peaks
from core.study import Camshaft, Study, certificate_of, extremes_of, findings_of, quantities_of, roller_lives
from core.study.cam_checks import limit_rows
from core.study.camshaft import has_speed, is_complete
from core.study.drive_forces import has_servo, servo_part, servo_turn
from core.study.study import shaft_in_chart

if TYPE_CHECKING:  # no design without a flexible shaft loads it
    from core.stability import Stability, SteadyTurn, Verdict


def summary(study: Study, stages: Sequence[str] = (), without: frozenset[str] = frozenset()) -> dict[str, Any]:
    """Figures of ``summary.json`` for the named stages, or for all; ``stability`` where the shaft is flexible.

    ``without`` lists quantities to omit.
    """
    selected = tuple(stages) or study.stages
    if study.design.listed:
        kind, figures = "shaft", _shaft_figures(study, selected)
    else:
        table = study.design.drive.table
        kind, figures = "cam" if table == "follower" else study.kind, _drive_figures(study, selected, without)
    shaft = stability(study) if "stability" in selected else {}
    return {
        "name": study.design.name,
        "kind": kind,
        "assumed": list(study.design.assumed),
        **figures,
        **({"stability": shaft} if shaft else {}),
        "findings": finding_rows(findings_of(study, selected)),
        "certificate": {
            name: {"value": r.value, "bound": r.bound, "left_out": r.left_out}
            for name, r in certificate_of(study, selected).items()
        },
    }


def _drive_figures(study: Study, stages: Sequence[str], without: frozenset[str]) -> dict[str, Any]:
    linkage = study.linkage if {"linkage", "cam", "dynamics"} & set(stages) else None
    return {
        "base": {}
        if linkage is None
        else {f"{name}_{unit}": value / UNITS[unit].factor for name, (value, unit) in linkage.base.items()},
        "joins": joins(study),
        **(mechanism(study) if study.design.drive.links and linkage is not None else {}),
        "extremes": extremes(study, stages, without),
        **({"limits": limits(study, stages)} if "cam" in study.stages else {}),
        "flywheel": flywheel(study) if "dynamics" in stages else {},
        **({"servo": servo(study)} if "dynamics" in stages and has_servo(study.design) and study.jam is None else {}),
        **({"cycle": cycle(study)} if has_cycle(study) else {}),
        **({"rolling_life": rolling_life(study)} if "dynamics" in stages and roller_lives(study) else {}),
        **({"elastic_follower": elastic_figures(study)} if "dynamics" in stages and study.is_elastic else {}),
    }


def _shaft_figures(study: Study, stages: Sequence[str]) -> dict[str, Any]:
    """Figures of several drives, by machine angle."""
    camshaft, dynamics = study.camshaft, "dynamics" in stages
    return {
        "base": {},
        "drives": _drives(camshaft),
        "timing": _timing(study.design),
        "extremes": (shaft_extremes(camshaft) if dynamics else {})
        | (clearance_extremes(study) if "linkage" in stages else {}),
        "torque": torque(camshaft) if dynamics else {},
        "flywheel": flywheel(study) if dynamics else {},
    }


def servo(study: Study) -> dict[str, Any]:
    """Figures of the servo over a turn; forces [N] for a linear motor. Braking energy is recovered by a regenerating motor."""
    row, turn = servo_part(study), servo_turn(study)
    unit, name = ("n", "servo_force") if row.kind == LINEAR else ("nm", "servo_torque")
    ranges = extremes_of(study, "dynamics", (name, "servo_power"))
    peak, power = (
        max(abs(ranges[row_name].low.value), abs(ranges[row_name].high.value)) for row_name in (name, "servo_power")
    )
    return {
        f"rms_{unit}": turn.rms,
        f"peak_{unit}": peak,
        "peak_power_w": power,
        "energy_j": turn.given,
        "recovered_j": turn.braked if row.regenerates else 0.0,
        "inertia_ratio": turn.inertia_ratio,
        **{effort.drive: _effort_figures(effort) for effort in drive_efforts(study) if effort.drive != SERVO},
        "parts": [
            {"segment": part.segment, "energy_j": part.given, "recovered_j": part.braked if row.regenerates else 0.0}
            for part in turn.parts
        ],
    }


def cycle(study: Study) -> dict[str, Any]:
    """Figures of a turn of a motion without a cam; energy without recovery, and less all recovered braking energy."""
    result, unit = motion_cycle(study), study.design.drive.motion_unit
    row: dict[str, Any] = {f"mean_speed_{unit}_s": result.mean_speed}
    row["stops"] = [
        {"cam_angle_deg": s.at_deg, f"position_{unit}": s.position, f"error_{unit}": s.error} for s in result.stops
    ]
    if result.work is not None:
        rms = "rms_n" if unit == "mm" else "rms_nm"
        row |= {
            rms: result.work.rms,
            "energy_j": result.work.given,
            "energy_with_recovery_j": result.work.given - result.work.braked,
        }
    return row


def _effort_figures(effort: DriveEffort) -> dict[str, float]:
    """Effort of a cam for the same motion, to compare with the servo."""
    return {
        "rms_nm": effort.rms,
        "peak_nm": effort.peak,
        "peak_power_w": effort.peak_power,
        "energy_j": effort.given,
        "recovered_j": effort.braked,
    }


def finding_rows(findings: Iterable[Finding]) -> list[dict[str, Any]]:
    """Findings as data, with their sentences."""
    return [
        {
            "code": f.code,
            "severity": f.severity,
            "field": f.field,
            "cam_angle_deg": f.cam_angle_deg,
            "values": dict(f.values),
            "message": f.message,
        }
        for f in findings
    ]


def range_row(extreme_values: Extremes, factor: float) -> dict[str, Any]:
    """Lowest and highest value in the channel's unit, with their angles."""
    sides = (("min", extreme_values.low), ("max", extreme_values.high))
    return {side: {"value": e.value / factor + 0.0, "cam_angle_deg": math.degrees(e.theta)} for side, e in sides}


def joins(study: Study) -> list[dict[str, float]]:
    """Joins of segments: cam angle and the jumps of s, v, a, j, per radian of cam angle and in the motion's unit.

    Rounding counts as 0; empty without a motion.
    """
    if "motion" not in study.stages:
        return []
    scale = study.program.motion.scale
    rows = []
    for join in study.program.joins:
        jump = np.where(join.jumps, join.jump, 0.0) / scale
        rows.append({"cam_angle_deg": math.degrees(join.theta), **dict(zip("svaj", map(float, jump), strict=True))})
    return rows


def extremes(study: Study, stages: Iterable[str], without: frozenset[str] = frozenset()) -> dict[str, Any]:
    """Refined extremes of the channels of the named stages, in their units; no forces where a guide jams.

    ``without`` lists quantities to omit.
    """
    rows = {}
    for stage in stages:
        if stage == "dynamics" and study.jam is not None:
            continue
        ranges = extremes_of(study, stage)
        for row in channels(study.design, (stage,)):
            if row.name in ranges and row.name not in without:
                rows[row.slug] = range_row(ranges[row.name], row.unit.factor)
    return rows


def limits(study: Study, stages: Sequence[str]) -> list[dict[str, Any]]:
    """Figures of a cam with their limits: those of the user, else typical limits with their source, null without a limit."""
    return [
        {
            "name": row.name,
            "value": row.value,
            "cam_angle_deg": row.cam_angle_deg,
            "limit": row.limit,
            "source": row.source or None,
        }
        for row in limit_rows(study, stages)
    ]


def rolling_life(study: Study) -> list[dict[str, Any]]:
    """Rollers with a load rating: equivalent load, mean speed about their axis, L10; null where nothing loads them."""
    return [
        {
            "roller": life.roller,
            "million_turns": life.million_turns,
            "hours": life.hours,
            "load_n": life.load,
            "mean_rpm": life.rpm,
        }
        for life in roller_lives(study)
    ]


def flywheel(study: Study) -> dict[str, float | None]:
    """Figures of the flywheel: sizes by the true speed and by the energy estimate, and the speed with the fitted one.

    Fluctuation is (max - min)/mean; null where the motor stalls. Listed drives also give the motor's peak power. Empty without
    motor torque: for linkages without a crank, where a guide jams, and where a drive fails.
    """
    if study.design.listed:
        if not is_complete(study.camshaft):
            return {}
        power = study.camshaft.motor_range["motor_power"].high.value if has_speed(study.camshaft) else None
        return {**flywheel_figures(study.flywheel), "motor_peak_power_w": power}
    if "motor_torque" not in quantities_of(study, "dynamics") or study.jam is not None:
        return {}
    return flywheel_figures(study.flywheel)


def flywheel_figures(wheel: Flywheel) -> dict[str, float | None]:
    """Figures of the flywheel of a shaft."""
    low, high = (speed / UNITS["rpm"].factor for speed in wheel.speed_range) if wheel.runs else (None, None)
    return {
        "mean_torque_nm": wheel.mean_torque,
        "energy_swing_j": wheel.energy_swing,
        "needed_inertia_kg_m2": wheel.needed_inertia,
        "estimated_inertia_kg_m2": wheel.estimated_inertia,
        "fluctuation": wheel.fluctuation if wheel.runs else None,
        "min_speed_rpm": low,
        "max_speed_rpm": high,
    }


def mechanism(study: Study) -> dict[str, Any]:
    """Mobility, ranges of the driver, change points, and the kind of a four-bar."""
    driver_ranges, linkage = study.driver_ranges, study.design.drive.linkage
    unit = UNITS["deg" if driver_ranges.plan.driver.revolute else "mm"]
    suffix = "deg" if driver_ranges.plan.driver.revolute else "mm"
    bar = four_bar(driver_ranges.plan)
    return {
        "mobility": mobility(linkage),
        "dyads": [{"kind": step.kind, "links": list(step.links)} for step, _ in driver_ranges.plan.steps],
        "driver_ranges": [
            {
                f"from_{suffix}": r.low / unit.factor,
                f"to_{suffix}": r.high / unit.factor,
                "locks_at": [r.low_joint, r.high_joint],
            }
            for r in driver_ranges.ranges
        ],
        "change_points": [{f"at_{suffix}": c.at / unit.factor, "joint": c.joint} for c in driver_ranges.changes],
        "four_bar": {}
        if bar is None
        else {
            **{f"{name}_mm": getattr(bar, name) * 1e3 for name in ("ground", "crank", "coupler", "rocker")},
            "kind": bar.kind,
        },
    }


def verdict_rows(verdicts: Sequence[Verdict]) -> list[dict[str, Any]]:
    """Verdicts of the models on a point of the chart."""
    return [
        {
            "model": verdict.model,
            "stable": verdict.stable,
            "state": verdict.state,
            "trace": verdict.trace,
            "growth_percent_per_turn": round(100.0 * math.expm1(verdict.growth), 6),
            "largest_wind_up_deg": 360.0 * verdict.largest,
            "leaves_cam_at_turns": verdict.contact_lost,
            **({"leaves_cam": verdict.leaving} if verdict.leaving else {}),
        }
        for verdict in verdicts
    ]


def steady(turn: SteadyTurn) -> dict[str, Any]:
    """Steady response of a flexible shaft and its followers; angles are those of its input."""
    degree = UNITS["deg"].factor
    return {
        "wind_up_deg": range_row(turn.wind_up_range, degree),
        "shaft_torque_nm": range_row(turn.wind_up_range, 1.0 / turn.stiffness),
        "mean_shaft_torque_nm": turn.mean_torque,
        "shaft_torque_amplitude_nm": turn.torque_amplitude,
        "follower_error": [
            {"drive": follower.name or None, "unit": follower.unit, **range_row(errors, UNITS[follower.unit].factor)}
            for follower, errors in zip(turn.followers, turn.errors, strict=True)
        ],
    }


def _needed_stiffness(study: Study, shaft: Stability) -> dict[str, Any] | None:
    """Stiffness that the design's speed requires; None beyond the tongues that are computed."""
    try:
        needed = shaft.stiffness_for(study.design.camshaft.speed_rpm)
    except NoStability:
        return None
    return {
        "allowed": needed.allowed,
        "least_stiffer_nm_per_rad": needed.stiffer,
        "greatest_softer_nm_per_rad": needed.softer,
    }


def stability(study: Study) -> dict[str, Any]:
    """Point of the shaft in the chart, forbidden bands of speed, verdicts of the models, required stiffness.

    Empty where there is no ``shaft_in_chart``.
    """
    shaft = shaft_in_chart(study)
    if shaft is None:
        return {}
    row, machine = shaft.exact, shaft.machine
    return {
        "eta": machine.eta,
        "q": machine.q,
        "natural_rpm": machine.natural / UNITS["rpm"].factor,
        "top_rpm": shaft.top_rpm,
        "harmonics": row.order,
        "method": row.method,
        "edge_error": float(np.nanmax(row.error, initial=0.0)),
        "bands": [
            {
                "n": band.n,
                "eta_lo": band.eta_lo,
                "eta_hi": band.eta_hi,
                "rpm_lo": band.rpm_lo,
                "rpm_hi": band.rpm_hi,
                "growth_percent_per_turn": 100.0 * math.expm1(band.growth),
                "growth_per_s": band.rate,
            }
            for band in shaft.bands
        ],
        "verdicts": verdict_rows(shaft.own_verdicts),
        **({} if shaft.steady_turn is None else {"steady": steady(shaft.steady_turn)}),
        "stiffness": _needed_stiffness(study, shaft),
    }


# -- several drives on a shaft -----------------------------------------------------------------------------


def _drives(camshaft: Camshaft[Study]) -> list[dict[str, Any]]:
    rows = []
    for (name, slug), drive in zip(camshaft.slugs.items(), camshaft.design.drives, strict=True):
        error = camshaft.failures.get(name)
        rows.append(
            {
                "name": name,
                "slug": slug,
                "phase_deg": drive.phase,
                "mirrored": drive.mirrored,
                "kind": drive.kind,
                "missing": None if error is None else str(error),
            }
        )
    return rows


def _timing(design: Design) -> list[dict[str, Any]]:
    return [
        {
            "first": row.first,
            "second": row.second,
            "least_deg": row.least_deg,
            "first_deg": at.first_deg,
            "second_deg": at.second_deg,
            "after_deg": at.after_deg,
            "kept": at.kept,
        }
        for row, at in zip(design.timing, distances(design), strict=True)
    ]


def shaft_extremes(camshaft: Camshaft[Study]) -> dict[str, Any]:
    """Extremes of the columns of ``shaft.csv``; their ``cam_angle_deg`` is the machine angle."""
    loads = {
        f"{camshaft.slugs[name]}_torque_nm": peaks(camshaft.drive_load(name))
        for name in camshaft.loading_drives
        if name not in camshaft.failures
    }
    rows = {key: range_row(load, 1.0) for key, load in loads.items()}
    if is_complete(camshaft):
        rows = {"torque_nm": range_row(camshaft.peaks, 1.0), **rows}
    if has_speed(camshaft):
        motor = camshaft.motor_range
        rows |= {
            "motor_torque_nm": range_row(motor["motor_torque"], 1.0),
            "speed_rpm": range_row(motor["speed"], UNITS["rpm"].factor),
        }
    return rows


def clearance_extremes(study: Study) -> dict[str, Any]:
    """Extremes of the clearances of several drives; their ``cam_angle_deg`` is the machine angle."""
    if not study.design.outlines or study.camshaft.failures:
        return {}
    clearances, rows = study.clearances, {}
    for column, pair in clearances.by_column.items():
        least = clearances.least(pair)
        ends = Extremes(Extreme(least.value, least.theta), clearances.greatest(pair))
        rows[column] = range_row(ends, UNITS["mm"].factor)
    return rows


def torque(camshaft: Camshaft[Study]) -> dict[str, float]:
    """Mean, root mean square, peak with its machine angle, and peak power at constant speed; empty where a drive fails."""
    if not is_complete(camshaft):
        return {}
    peak = camshaft.peak_torque
    return {
        "mean_nm": camshaft.mean_torque,
        "rms_nm": camshaft.rms_torque,
        "peak_nm": peak.value,
        "peak_angle_deg": math.degrees(peak.theta),
        "peak_power_w": camshaft.peak_power,
    }


# -- JSON --------------------------------------------------------------------------------------------------


def to_json(data: Any) -> str:
    """Data as JSON text: null for infinity and missing values, no minus zero."""
    return json.dumps(_finite(data), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _finite(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    if isinstance(data, float):
        return data + 0.0 if math.isfinite(data) else None
    return data
