"""The figures of a shaft with several drives, in the units of the tables, by machine angle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from core.design import UNITS, distances
from core.errors import NoAnswer
from core.output.summary import finding_rows, flywheel_figures, range_row, residual_rows, stability
from core.shaft import peaks
from core.study import ShaftStudy

RPM = UNITS["rpm"].factor


def shaft_summary(study: ShaftStudy, stages: Sequence[str] = ()) -> dict[str, Any]:
    """The figures of ``summary.json`` of the whole for the named stages, all where none is named."""
    dynamics = not stages or "dynamics" in stages
    shaft = stability(study) if (not stages or "stability" in stages) and answers(study) else {}
    return {
        "name": study.design.name,
        "kind": "shaft",
        "assumed": list(study.design.assumed),
        "base": {},
        "drives": _drives(study),
        "timing": _timing(study),
        "extremes": _extremes(study) if dynamics else {},
        "torque": shaft_torque(study) if dynamics else {},
        "flywheel": shaft_flywheel(study) if dynamics else {},
        **({"stability": shaft} if shaft else {}),
        "findings": finding_rows(study.findings(stages)),
        "certificate": residual_rows(study.certificate(stages)),
    }


def answers(study: ShaftStudy) -> bool:
    """Whether all that the shaft carries has an answer, the balance cam included."""
    try:
        return study.load is not None
    except NoAnswer:
        return False


def runs(study: ShaftStudy) -> bool:
    """Whether there is a true speed: all has an answer, and the motor does not stall."""
    return answers(study) and (not study.levelled or study.flywheel.runs)


def _drives(study: ShaftStudy) -> list[dict[str, Any]]:
    rows = []
    for (name, slug), drive in zip(study.slugs.items(), study.design.drives, strict=True):
        error = study.failures.get(name)
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


def _timing(study: ShaftStudy) -> list[dict[str, Any]]:
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
        for row, at in zip(study.design.timing, distances(study.design), strict=True)
    ]


def _extremes(study: ShaftStudy) -> dict[str, Any]:
    """Of the columns of ``shaft.csv``; ``cam_angle_deg`` is the machine angle there."""
    found = {
        f"{study.slugs[name]}_torque_nm": peaks(study.drive_load(name))
        for name in study.carried
        if name not in study.failures
    }
    rows = {key: range_row(each, 1.0) for key, each in found.items()}
    if answers(study):
        rows = {"torque_nm": range_row(study.peaks, 1.0), **rows}
    if runs(study):
        motor = study.motor_range
        rows |= {"motor_torque_nm": range_row(motor["motor_torque"], 1.0), "speed_rpm": range_row(motor["speed"], RPM)}
    return rows


def shaft_torque(study: ShaftStudy) -> dict[str, float]:
    """Mean, root mean square, greatest size with its machine angle, and peak power, at constant speed; empty where a drive is
    missing."""
    if not answers(study):
        return {}
    peak = study.peak_torque
    return {
        "mean_nm": study.mean_torque,
        "rms_nm": study.rms_torque,
        "peak_nm": peak.value,
        "peak_angle_deg": math.degrees(peak.theta),
        "peak_power_w": study.peak_power,
    }


def shaft_flywheel(study: ShaftStudy) -> dict[str, float | None]:
    """As ``summary.flywheel``, of all drives together, with the motor's greatest power; empty where a drive is missing."""
    if not answers(study):
        return {}
    power = study.motor_range["motor_power"].high.value if runs(study) else None
    return {**flywheel_figures(study.flywheel), "motor_peak_power_w": power}
