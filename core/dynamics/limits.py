"""Limits of the forces: separation, jamming, nothing to move."""

from __future__ import annotations

import math

from core.dynamics.elements import Loading
from core.findings import ERROR, NOTE, Finding
from core.motion.extremes import Extreme, Range

JAMS = 1.0  # the jamming factor from which a guide may jam


def findings(contact: Range, jam: Extreme | None, loading: Loading) -> list[Finding]:
    """What the refined extremes of contact force [N] and jamming factor exceed; jam: the factor's, where it reaches 1."""
    if loading.empty:
        return [Finding("no-load", NOTE, "loads", None)]
    found = []
    least = contact.low
    if math.isfinite(least.value) and least.value <= 0.0:  # an infinite one is the jam's
        found.append(Finding("separation", ERROR, "loads", math.degrees(least.theta), {"force_n": least.value}))
    if jam is not None:
        found.append(Finding("jamming", ERROR, "loads.friction", math.degrees(jam.theta), {"factor": jam.value}))
    return found
