"""The user's own limits that bound quantities: each follows from its field in ``core.design.limits``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields
from math import degrees
from types import MappingProxyType

from core.cam.limits import ROUNDING
from core.design import Design, Limits, info_of
from core.design.fields import Bounds, Info
from core.findings import WARNING, Finding
from core.motion.extremes import Extreme
from core.study.extremes import exists, extremes_of
from core.study.quantities import names_of, quantities_of, quantity
from core.study.study import Study
from core.units import kind_of, split_unit

OWN_BOUNDS: Mapping[str, tuple[Info, Bounds]] = MappingProxyType(
    {each.name: (info, info.bounds) for each in fields(Limits) if (info := info_of(each)) and info.bounds}
)
"""Key in [limits] -> its field, and of what it is a limit."""


def code_of(key: str) -> str:
    """Of the finding that a limit is passed."""
    return split_unit(key)[0].replace("_", "-")


def stage_of(key: str) -> str:
    """Of the quantities that a limit bounds."""
    return quantity(OWN_BOUNDS[key][1].quantities[0]).stage


def bounded(design: Design, key: str) -> tuple[str, ...]:
    """The quantities that a limit bounds in a design: those that it has and that measure the same, for a follower's jerk is one of
    lengths or of angles."""
    kind = kind_of(split_unit(key)[1].symbol)
    there = (name for name in OWN_BOUNDS[key][1].quantities if name in names_of(design))
    slugs = {name: quantity(name).slug.format(m=design.drive.motion_unit) for name in there}
    return tuple(name for name, slug in slugs.items() if kind_of(split_unit(slug)[1].symbol) == kind)


def worst_of(study: Study, stage: str) -> Iterator[tuple[str, float, Extreme]]:
    """Key, limit as stated and what comes nearest to it or passes it by most, in its unit, of every limit that the user states for
    quantities of a stage and that has no check of its own; forces only where there are any. Raises NoAnswer as the stage does."""
    for key, (_, bounds) in OWN_BOUNDS.items():
        limit = getattr(study.design.drive.limits, key)
        if limit is None or not bounds.remedy or stage_of(key) != stage or (stage == "dynamics" and _forceless(study)):
            continue
        rows = quantities_of(study, stage)
        names = tuple(name for name in bounded(study.design, key) if name in rows and exists(study, rows[name]))
        if not names:
            continue
        factor = split_unit(key)[1].factor
        ends = [
            Extreme(abs(end.value) / factor if bounds.most else end.value / factor, end.theta)
            for found in extremes_of(study, stage, names).values()
            for end in (found.low, found.high)
        ]
        yield key, limit, (max if bounds.most else min)(ends, key=lambda end: end.value)


def _forceless(study: Study) -> bool:
    return study.loading.empty or study.jam is not None


def own_findings(study: Study, stage: str) -> list[Finding]:
    """The quantities of a stage that pass the user's own limits."""
    found = []
    for key, limit, worst in worst_of(study, stage):
        info, bounds = OWN_BOUNDS[key]
        passed = worst.value > limit * (1.0 + ROUNDING) if bounds.most else worst.value < limit * (1.0 - ROUNDING)
        if not passed:
            continue
        words = {
            "what": info.in_sentence,
            "unit": split_unit(key)[1].symbol,
            "remedy": bounds.remedy,
        }
        values: dict[str, float | str] = {"value": worst.value, "limit": limit, **words}
        found.append(Finding(code_of(key), WARNING, f"limits.{key}", degrees(worst.theta), values))
    return found
