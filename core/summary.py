"""The figures of a study in the units of the tables: extremes, joins, flywheel, findings, certificate."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from core.channels import channels, existing
from core.design import UNITS
from core.study import Study


def summary(study: Study, stages: Sequence[str]) -> dict[str, Any]:
    """The figures of ``summary.json`` for the named stages."""
    linkage = study.linkage if {"linkage", "cam", "dynamics"} & set(stages) else None
    return {
        "name": study.design.name,
        "kind": "cam",
        "assumed": list(study.design.assumed),
        "base": {} if linkage is None else {
            f"{name}_{unit}": _number(value / UNITS[unit].factor) for name, (value, unit) in linkage.base.items()
        },
        "joins": joins(study),
        "extremes": extremes(study, stages),
        "flywheel": flywheel(study) if "dynamics" in stages else {},
        "findings": [
            {
                "code": f.code,
                "severity": f.severity,
                "field": f.field,
                "cam_angle_deg": f.cam_angle_deg,
                "values": {k: _number(v) for k, v in f.values.items()},
                "message": f.message,
            }
            for f in study.findings(tuple(stages))
        ],
        "certificate": {
            name: {"value": _number(r.value), "bound": _number(r.bound)}
            for name, r in study.certificate(tuple(stages)).items()
        },
    }  # fmt: skip


def joins(study: Study) -> list[dict[str, float]]:
    """Every join of segments: cam angle and the jumps of s, v, a, j there, per radian of cam angle and in the
    motion's unit; what is rounding counts as 0."""
    scale = study.design.drive.motion.scale
    told = []
    for join in study.program.joins:
        jump = np.where(join.jumps, join.jump, 0.0) / scale
        told.append({"cam_angle_deg": math.degrees(join.theta), **dict(zip("svaj", map(float, jump), strict=True))})
    return told


def extremes(study: Study, stages: Iterable[str]) -> dict[str, Any]:
    """Refined extremes of every channel of the named stages, in the channel's own unit."""
    found = {}
    for stage in stages:
        ranges = study.extremes(stage)
        for row in channels(study.design, (stage,)):
            if row.quantity in ranges:
                low, high = ranges[row.quantity].low, ranges[row.quantity].high
                found[row.slug] = {
                    side: {
                        "value": _number(e.value / row.unit.factor + 0.0),
                        "cam_angle_deg": _number(math.degrees(e.theta)),
                    }
                    for side, e in (("min", low), ("max", high))
                }
    return found


def flywheel(study: Study) -> dict[str, float | None]:
    names = {row.slug for row in existing(study, channels(study.design, ("dynamics",)))}
    if "motor_torque_nm" not in names:
        return {}
    wheel = study.flywheel
    return {
        "mean_torque_nm": _number(wheel.mean_torque),
        "energy_swing_j": _number(wheel.energy_swing),
        "needed_inertia_kg_m2": _number(wheel.needed_inertia),
    }


def _number(value: Any) -> Any:
    """JSON has no infinity: null stands for it."""
    return value if not isinstance(value, float) or math.isfinite(value) else None


def to_json(data: Any) -> str:
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
