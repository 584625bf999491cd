"""Limits of the forces: separation, jamming, nothing to move."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi

from core.dynamics.loading import Loading
from core.extremes import Range
from core.findings import ERROR, NOTE, Finding


def findings(extremes: Mapping[str, Range], loading: Loading) -> list[Finding]:
    """What the refined extremes of contact force [N] and jamming factor exceed."""
    if loading.empty:
        return [Finding("no-load", NOTE, "loads", None)]
    found = []
    least = extremes["contact_force"].low
    if least.value <= 0.0:
        found.append(Finding("separation", ERROR, "loads", least.theta * 180.0 / pi, {"force_n": least.value}))
    worst = extremes["jam_factor"].high
    if worst.value >= 1.0:
        found.append(Finding("jamming", ERROR, "loads.friction", worst.theta * 180.0 / pi, {"factor": worst.value}))
    return found
