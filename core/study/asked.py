"""What can be asked of a quantity over the turn, or of the whole turn, by its key."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from core.design import Design
from core.study.contact_stress import roller_lives
from core.study.quantities import names_of, quantity
from core.study.study import Study
from core.units import split_unit

OVER_TURN = ("max", "min", "abs", "rms", "mean", "range")
"""What can be asked of a quantity over the turn: its largest and least value, the largest of either sign, root mean square, mean, and
largest less least value."""

TOTALS: Mapping[str, Callable[[Study], float]] = {
    "flywheel_inertia_kg_m2": lambda study: study.flywheel.needed_inertia,
    "energy_j": lambda study: study.flywheel.energy_swing,
    "life_hours": lambda study: min((life.hours for life in roller_lives(study)), default=np.nan),
}
"""Totals of a turn: the flywheel that keeps the fluctuation, the energy that it takes up and gives back, life of the shortest-lived
roller."""


class Asked(NamedTuple):
    """One thing asked: its key as given; the quantity, what of it over the turn, and its unit in SI; a total has no quantity."""

    key: str
    name: str
    of: str
    unit: float


def asked_of(design: Design, key: str) -> Asked:
    """What a key asks. Raises ValueError, naming it."""
    if key in TOTALS:
        return Asked(key, "", key, 1.0)
    slug, _, of = key.partition(":")
    if of not in OVER_TURN:
        raise ValueError(f"{key}: asked is <column>:{'|'.join(OVER_TURN)}, or {', '.join(TOTALS)}")
    name = "" if design.listed else _columns(design).get(slug, "")
    if not name or quantity(name).turns:
        raise ValueError(f"{key}: this design has no such column with extremes")
    return Asked(key, name, of, split_unit(slug)[1].factor)


@lru_cache(maxsize=16)
def _columns(design: Design) -> Mapping[str, str]:
    """Column, by whose unit a value counts -> quantity."""
    rows = (quantity(name) for name in names_of(design))
    return {row.slug.format(m=design.drive.motion_unit): row.name for row in rows if row.slug}


def mean_of(values: np.ndarray, weight: np.ndarray, of: str) -> Any:
    """Mean or root mean square over the turn of values (..., n) at nodes of these weights (n,)."""
    return np.sqrt((values * values * weight).sum(axis=-1)) if of == "rms" else (values * weight).sum(axis=-1)


def of_range(of: str, low: tuple[Any, Any], high: tuple[Any, Any]) -> tuple[Any, Any]:
    """Value and cam angle of what is asked, from the least and the largest value with theirs."""
    if of == "range":
        return high[0] - low[0], np.full(np.shape(high[0]), np.nan)
    if of == "abs":
        upper = np.abs(high[0]) >= np.abs(low[0])
        return np.where(upper, np.abs(high[0]), np.abs(low[0])), np.where(upper, high[1], low[1])
    return low if of == "min" else high
