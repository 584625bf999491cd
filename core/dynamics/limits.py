"""Limits of the forces: separation, jamming, nothing to move."""

from __future__ import annotations

import math

from core.design import Roller
from core.dynamics.elements import Loading
from core.findings import ERROR, NOTE, Finding
from core.motion.extremes import Extreme, Range


def findings(contact: Range | None, jam: Extreme | None, at_contact: bool, loading: Loading, noun: str) -> list[Finding]:
    """What the refined extremes of contact force [N] and jamming factor exceed; contact: None where the cam holds the follower from
    both sides, jam: the factor's, where it reaches 1, at_contact: by the friction between face and cam; noun: of the face."""
    if loading.empty:
        return [Finding("no-load", NOTE, "loads", None)]
    found = []
    face = {} if noun == Roller.noun else {"face": noun}
    least = None if contact is None else contact.low
    if least is not None and math.isfinite(least.value) and least.value <= 0.0:  # an infinite one is the jam's
        found.append(Finding("separation", ERROR, "loads", math.degrees(least.theta), {"force_n": least.value, **face}))
    if jam is not None:
        code, field = ("contact-jamming", "loads.contact_friction") if at_contact else ("jamming", "loads.friction")
        found.append(Finding(code, ERROR, field, math.degrees(jam.theta), {"factor": jam.value}))
    return found
