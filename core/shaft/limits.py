"""Limits of flywheel and motor: standing still."""

from __future__ import annotations

from core.findings import ERROR, Finding
from core.shaft.flywheel import Flywheel


def findings(wheel: Flywheel) -> list[Finding]:
    """Whether the motor stalls, and with which flywheel it would not."""
    if wheel.runs:
        return []
    values: dict[str, float | str] = {
        "inertia_kg_m2": wheel.shaft.flywheel_inertia_kg_m2,
        "least_kg_m2": wheel.least_inertia,
        "swing_j": wheel.energy_swing,
    }
    return [Finding("motor-stalls", ERROR, "shaft.flywheel_inertia_kg_m2", None, values)]
