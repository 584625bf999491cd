"""Limits of the forces: separation, jamming, nothing to move."""

from __future__ import annotations

import math
from collections.abc import Mapping

from core.dynamics.elements import Loading
from core.extremes import Range
from core.findings import ERROR, NOTE, Finding


def findings(extremes: Mapping[str, Range], loading: Loading) -> list[Finding]:
    """What the refined extremes of contact force [N] and jamming factor exceed."""
    if loading.empty:
        return [Finding("no-load", NOTE, "loads", None)]
    found = []
    least = extremes["contact_force"].low
    if math.isfinite(least.value) and least.value <= 0.0:  # an infinite one is the jam's
        found.append(Finding("separation", ERROR, "loads", math.degrees(least.theta), {"force_n": least.value}))
    worst = extremes["jam_factor"].high
    if worst.value >= 1.0:
        found.append(Finding("jamming", ERROR, "loads.friction", math.degrees(worst.theta), {"factor": worst.value}))
    return found
