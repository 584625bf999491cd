"""Limits of the contact's stress: the user's own, that of the materials, and what is missing to know it."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees
from typing import Any

from core.cam.limits import ROUNDING
from core.design import Limits
from core.findings import NOTE, WARNING, Finding
from core.motion.extremes import Extreme
from core.stress.pairing import MPA, Pairing, asked_for, has_width, missing

_LIMIT = "limits.contact_pressure_mpa"


def pressure_findings(worst: Mapping[str, Extreme], pairing: Mapping[str, Pairing], limits: Limits) -> list[Finding]:
    """A pressure beyond the user's own limit, or beyond what one of the materials bears; worst: flank -> the greatest [Pa] there."""
    found = []
    most, own = max(worst.values(), key=lambda extreme: extreme.value), limits.contact_pressure_mpa
    if own is not None and most.value > MPA * own * (1.0 + ROUNDING):
        values: dict[str, float | str] = {"value": most.value / MPA, "limit": own}
        found.append(Finding("contact-pressure", WARNING, _LIMIT, degrees(most.theta), values))
    by_surface: dict[str, Extreme] = {}
    surfaces = {each.path: each for pair in pairing.values() for each in pair.surfaces}
    for flank, extreme in worst.items():
        for each in pairing[flank].surfaces:
            known = by_surface.get(each.path)
            by_surface[each.path] = extreme if known is None or extreme.value > known.value else known
    for path, extreme in by_surface.items():
        surface = surfaces[path]
        if surface.allowable is not None and extreme.value > surface.allowable * (1.0 + ROUNDING):
            values = {
                "value": extreme.value / MPA, "limit": surface.allowable / MPA, "what": surface.what, "material": surface.name,
                "source": surface.source,
            }  # fmt: skip
            found.append(Finding("material-pressure", WARNING, path, degrees(extreme.theta), values))
    return found


def missing_findings(face: Any, cam: Any, limits: Limits) -> list[Finding]:
    """Why there is no stress where one is asked for: an edge has none, or what must be given."""
    if not asked_for(cam, limits):
        return []
    severity = NOTE if limits.contact_pressure_mpa is None else WARNING
    if not has_width(face):
        return [
            Finding(
                "no-contact-pressure-edge",
                severity,
                _LIMIT if severity == WARNING else "cam.material",
                None,
                {"face": face.noun},
            )
        ]
    lacking = missing(face, cam)
    if not lacking:
        return []
    values: dict[str, float | str] = {"missing": ", and ".join(lacking.values()), "fields": ", ".join(lacking)}
    return [Finding("no-contact-pressure", severity, next(iter(lacking)), None, values)]


def unfit_finding(noun: str, limits: Limits) -> Finding:
    """There is no stress where the profile is undercut."""
    severity = NOTE if limits.contact_pressure_mpa is None else WARNING
    return Finding("no-contact-pressure-undercut", severity, "cam", None, {"face": noun})
