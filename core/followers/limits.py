"""Limits of a linkage: poses near which it can no longer be driven."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees

from core.findings import ERROR, WARNING, Finding
from core.motion.extremes import Range

NEAR = {"dead-centre": (0.05, WARNING), "rod-across-guide": (0.05, WARNING)}
AT = 1e-3  # below this the pose cannot be held against any play


def findings(extremes: Mapping[str, Range]) -> list[Finding]:
    """Singular poses the cycle comes near to; extremes by the code of the finding."""
    found = []
    for code, (limit, severity) in NEAR.items():
        if code in extremes and extremes[code].low.value < limit:
            low = extremes[code].low
            grade = ERROR if low.value < AT else severity
            found.append(Finding(code, grade, "follower.rod_mm", degrees(low.theta), {"value": low.value}))
    return found
