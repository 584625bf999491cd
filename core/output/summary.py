"""The figures of a design in the units of the tables: extremes, joins, torque, flywheel, findings, certificate."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from core.design import UNITS, Design, distances
from core.design.parts import LINEAR
from core.design.topology import mobility
from core.errors import NoStability
from core.findings import Finding, Residual
from core.mechanism.branches import four_bar
from core.motion.extremes import Extremes
from core.output.channels import channels, has_cycle, motion_cycle
from core.output.subject_files import SERVO, Asked, asked, elastic_rows
from core.shaft import Flywheel, peaks
from core.study import Camshaft, Study, certificate_of, extremes_of, findings_of, quantities_of, roller_lives
from core.study.cam_checks import limit_rows
from core.study.camshaft import has_speed, is_complete
from core.study.drive_forces import has_servo, servo_part, servo_turn
from core.study.study import shaft_in_chart

if TYPE_CHECKING:  # no design without a flexible shaft loads it
    from core.stability import Stability, SteadyTurn, Verdict


def summary(study: Study, stages: Sequence[str] = (), without: frozenset[str] = frozenset()) -> dict[str, Any]:
    """The figures of ``summary.json`` for the named stages (all, where none is named); ``stability`` where the shaft is flexible; without:
    quantities that are left out."""
    wanted = tuple(stages) or study.stages
    if study.design.listed:
        kind, own = "shaft", _of_camshaft(study, wanted)
    else:
        table = study.design.drive.table
        kind, own = "cam" if table == "follower" else study.kind, _of_drive(study, wanted, without)
    shaft = stability(study) if "stability" in wanted else {}
    return {
        "name": study.design.name,
        "kind": kind,
        "assumed": list(study.design.assumed),
        **own,
        **({"stability": shaft} if shaft else {}),
        "findings": finding_rows(findings_of(study, wanted)),
        "certificate": residual_rows(certificate_of(study, wanted)),
    }


def _of_drive(study: Study, stages: Sequence[str], without: frozenset[str]) -> dict[str, Any]:
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
        **({"elastic_follower": elastic_rows(study)} if "dynamics" in stages and study.is_elastic else {}),
    }


def _of_camshaft(study: Study, stages: Sequence[str]) -> dict[str, Any]:
    """By machine angle."""
    camshaft, dynamics = study.camshaft, "dynamics" in stages
    return {
        "base": {},
        "drives": _drives(camshaft),
        "timing": _timing(study.design),
        "extremes": _camshaft_extremes(camshaft) if dynamics else {},
        "torque": torque(camshaft) if dynamics else {},
        "flywheel": flywheel(study) if dynamics else {},
    }


def servo(study: Study) -> dict[str, Any]:
    """What the servo's motor does in a turn; of a linear one forces [N]. Braking energy is recovered where the motor regenerates."""
    row, turn = servo_part(study), servo_turn(study)
    unit, name = ("n", "servo_force") if row.kind == LINEAR else ("nm", "servo_torque")
    found = extremes_of(study, "dynamics", (name, "servo_power"))
    peak, power = (max(abs(found[each].low.value), abs(found[each].high.value)) for each in (name, "servo_power"))
    return {
        f"rms_{unit}": turn.rms,
        f"peak_{unit}": peak,
        "peak_power_w": power,
        "energy_j": turn.given,
        "recovered_j": turn.braked if row.regenerates else 0.0,
        "inertia_ratio": turn.inertia_ratio,
        **{way.way: _shaft_figures(way) for way in asked(study) if way.way != SERVO},
        "parts": [
            {"segment": each.segment, "energy_j": each.given, "recovered_j": each.braked if row.regenerates else 0.0}
            for each in turn.parts
        ],
    }


def cycle(study: Study) -> dict[str, Any]:
    """What a motion that no cam makes does in a turn; energy: without recovery, and what is left of it where all braking is recovered."""
    found, unit = motion_cycle(study), study.design.drive.motion_unit
    row: dict[str, Any] = {f"mean_speed_{unit}_s": found.mean_speed}
    row["stops"] = [
        {"cam_angle_deg": s.at_deg, f"position_{unit}": s.position, f"error_{unit}": s.error} for s in found.stops
    ]
    if found.work is not None:
        rms = "rms_n" if unit == "mm" else "rms_nm"
        row |= {
            rms: found.work.rms,
            "energy_j": found.work.given,
            "energy_with_recovery_j": found.work.given - found.work.braked,
        }
    return row


def _shaft_figures(way: Asked) -> dict[str, float]:
    """What a cam asks of its shaft for the same motion, beside the servo's figures."""
    return {
        "rms_nm": way.rms,
        "peak_nm": way.peak,
        "peak_power_w": way.peak_power,
        "energy_j": way.given,
        "recovered_j": way.braked,
    }


def finding_rows(findings: Iterable[Finding]) -> list[dict[str, Any]]:
    """Findings, each with its sentence."""
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


def residual_rows(proof: Mapping[str, Residual]) -> dict[str, Any]:
    """A certificate by name."""
    return {name: {"value": r.value, "bound": r.bound, "left_out": r.left_out} for name, r in proof.items()}


def range_row(found: Extremes, factor: float) -> dict[str, Any]:
    """Lowest and highest in the channel's unit, each with its angle."""
    sides = (("min", found.low), ("max", found.high))
    return {side: {"value": e.value / factor + 0.0, "cam_angle_deg": math.degrees(e.theta)} for side, e in sides}


def joins(study: Study) -> list[dict[str, float]]:
    """Every join of segments: cam angle and the jumps of s, v, a, j there, per radian of cam angle and in the
    motion's unit; what is rounding counts as 0. None where no motion is asked for."""
    if "motion" not in study.stages:
        return []
    scale = study.program.motion.scale
    rows = []
    for join in study.program.joins:
        jump = np.where(join.jumps, join.jump, 0.0) / scale
        rows.append({"cam_angle_deg": math.degrees(join.theta), **dict(zip("svaj", map(float, jump), strict=True))})
    return rows


def extremes(study: Study, stages: Iterable[str], without: frozenset[str] = frozenset()) -> dict[str, Any]:
    """Refined extremes of every channel of the named stages, in the channel's own unit; no forces where a guide jams; without:
    quantities that are left out."""
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
    """The figures of a cam beside their limits: the user's own, else the usual one with its source, null where there is none."""
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
    """Of every roller whose load rating is stated: equivalent load, mean speed about its own axis, L10; null where nothing loads it."""
    return [
        {
            "roller": each.roller,
            "million_turns": each.million_turns,
            "hours": each.hours,
            "load_n": each.load,
            "mean_rpm": each.rpm,
        }
        for each in roller_lives(study)
    ]


def flywheel(study: Study) -> dict[str, float | None]:
    """Sizing by the true speed and the estimate by energy, and what the flywheel fitted makes of the speed: (max - min)/mean, lowest
    and highest, null where the motor stalls; of drives that are listed the motor's greatest power, too. Empty where there is no motor
    torque at all: for linkages that no crank drives, where a guide jams, and where a drive is missing."""
    if study.design.listed:
        if not is_complete(study.camshaft):
            return {}
        power = study.camshaft.motor_range["motor_power"].high.value if has_speed(study.camshaft) else None
        return {**flywheel_figures(study.flywheel), "motor_peak_power_w": power}
    if "motor_torque" not in quantities_of(study, "dynamics") or study.jam is not None:
        return {}
    return flywheel_figures(study.flywheel)


def flywheel_figures(wheel: Flywheel) -> dict[str, float | None]:
    """The same of any shaft."""
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
    """Mobility, ranges of the driver, change points, and the kind of four-bar where it holds one."""
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
    """What each model says of a point of the chart."""
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
    """What the steady response of a flexible shaft does to shaft and followers; angles are those of its input."""
    degree = UNITS["deg"].factor
    return {
        "wind_up_deg": range_row(turn.wind_up_range, degree),
        "shaft_torque_nm": range_row(turn.wind_up_range, 1.0 / turn.stiffness),
        "mean_shaft_torque_nm": turn.mean_torque,
        "shaft_torque_amplitude_nm": turn.torque_amplitude,
        "follower_error": [
            {"drive": each.name or None, "unit": each.unit, **range_row(found, UNITS[each.unit].factor)}
            for each, found in zip(turn.followers, turn.errors, strict=True)
        ],
    }


def _needed_stiffness(study: Study, shaft: Stability) -> dict[str, Any] | None:
    """What the design's speed asks of the shaft; None where it swings so often in a turn that tongues are not looked for there."""
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
    """The shaft's place in the chart, the forbidden bands of speed, what each model says, the stiffness the speed needs;
    empty where there is no ``shaft_in_chart``."""
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


# -- of several drives on a shaft --------------------------------------------------------------------------


def _drives(camshaft: Camshaft[Study]) -> list[dict[str, Any]]:
    rows = []
    for (name, slug), drive in zip(camshaft.slugs.items(), camshaft.design.drives, strict=True):
        error = camshaft.failures.get(name)
        rows.append(
            {
                "name": name,
                "slug": slug,
                "phase_deg": drive.phase_deg,
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


def _camshaft_extremes(camshaft: Camshaft[Study]) -> dict[str, Any]:
    """Of the columns of ``shaft.csv``; ``cam_angle_deg`` is the machine angle there."""
    found = {
        f"{camshaft.slugs[name]}_torque_nm": peaks(camshaft.drive_load(name))
        for name in camshaft.loading_drives
        if name not in camshaft.failures
    }
    rows = {key: range_row(each, 1.0) for key, each in found.items()}
    if is_complete(camshaft):
        rows = {"torque_nm": range_row(camshaft.peaks, 1.0), **rows}
    if has_speed(camshaft):
        motor = camshaft.motor_range
        rows |= {
            "motor_torque_nm": range_row(motor["motor_torque"], 1.0),
            "speed_rpm": range_row(motor["speed"], UNITS["rpm"].factor),
        }
    return rows


def torque(camshaft: Camshaft[Study]) -> dict[str, float]:
    """Mean, root mean square, greatest size with its machine angle, and peak power, at constant speed; empty where a drive is
    missing."""
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


# -- as text -----------------------------------------------------------------------------------------------


def to_json(data: Any) -> str:
    """As text; JSON has no infinity, and null stands for it and for what has no value. No minus zero."""
    return json.dumps(_finite(data), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _finite(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    if isinstance(data, float):
        return data + 0.0 if math.isfinite(data) else None
    return data
