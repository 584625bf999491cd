"""What can be sought in a design, and the limits that hold where nobody states others."""

from __future__ import annotations

from collections.abc import Mapping

from core.design import Design
from core.find.limits import ANY_PRESSURE, LIMITS
from core.find.trial import usual_pressure
from core.find.wanted import LEAST_PRESSURE, WANTED, has


def offered(design: Design) -> tuple[str, ...]:
    """The rows of ``WANTED`` whose fields the design has; none where it has no cam."""
    if design.drive.cam is None:
        return ()
    held = design.drive.cam.form.holds
    rows = ((what, row) for what, row in WANTED.items() if not (row.holding and held))
    return tuple(what for what, row in rows if all(has(design, path) for path in row.fields(design, {})))


def varied(design: Design, what: str, place: str = "") -> tuple[str, ...]:
    """The paths of the fields that a row varies; place: the one that is chosen where there is a choice."""
    return WANTED[what].fields(design, {place: (None, None)} if place else {})


def limits_without(design: Design, what: str, stated: Mapping[str, float]) -> Mapping[str, float]:
    """The limits of a row beside those stated: the design's own, else, where none is stated either, the usual pressure angle."""
    row, own = WANTED[what], vars(design.drive.limits)
    if row.holding:
        return {key: value for key, value in row.usual(design).items() if key not in stated}
    kept = (key for key in row.limits if own.get(key) is not None and key not in stated)
    limits = {key: own[key] for key in kept if not LIMITS[key].lacking(design)}
    if not limits and row.limits and row.wanted != LEAST_PRESSURE and not any(key in row.limits for key in stated):
        limits[ANY_PRESSURE] = usual_pressure(design)
    return limits
