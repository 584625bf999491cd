"""Limits of a flexible shaft: running in a forbidden band of speed, or near one."""

from __future__ import annotations

import math

from core.findings import ERROR, NOTE, WARNING, Finding
from core.stability.critical_speeds import CLEAR, NOTICEABLE, Band
from core.stability.stage import Stability
from core.stability.steady_response import TOLERANCE

FIELD = "shaft.stiffness_nm_per_rad"


def findings(found: Stability) -> list[Finding]:
    """Where the machine's own speed stands among the forbidden bands. In a band that grows noticeably: an error; in one that
    the slightest damping would close: a warning; near one: a note."""
    rpm = found.machine.omega * 30.0 / math.pi
    if rpm >= found.top_rpm:
        values = {"rpm": rpm, "top_rpm": found.top_rpm}
        return [Finding("above-all-speeds", ERROR, FIELD, None, values)]
    growth = found.linear[-1].growth
    inside = [b for b in found.near_bands if b.holds(rpm)]
    if not inside and growth > TOLERANCE:  # beyond the bands looked for
        severity = ERROR if growth >= NOTICEABLE else WARNING
        return [
            Finding("unstable-shaft", severity, FIELD, None, {"rpm": rpm, "growth_percent": 100.0 * math.expm1(growth)})
        ]
    if inside:
        band = max(inside, key=lambda b: b.growth)
        severity = ERROR if band.growth >= NOTICEABLE else WARNING
        return [Finding("unstable-speed", severity, FIELD, None, _values(band, rpm))]
    near = [b for b in found.near_bands if b.growth >= NOTICEABLE and b.distance(rpm) <= CLEAR]
    if near:
        band = min(near, key=lambda b: b.distance(rpm))
        return [Finding("near-unstable-speed", NOTE, FIELD, None, _values(band, rpm))]
    return []


def _values(band: Band, rpm: float) -> dict[str, float | str]:
    return {
        "rpm": rpm,
        "n": float(band.n),
        "rpm_lo": band.rpm_lo,
        "rpm_hi": band.rpm_hi,
        "growth_percent": 100.0 * math.expm1(band.growth),
    }
