"""Which field is traded for a quantity, and what value of it gives an extreme that is wanted."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from core.design import Design, get
from core.errors import KindynaError
from core.find.offer import offered, varied
from core.find.wanted import WANTED
from core.frozen import frozen
from core.study.many import many
from core.study.quantities import quantity

TRADED: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        **dict.fromkeys(("displacement", "velocity", "acceleration", "jerk"), ("span",)),
        **dict.fromkeys(("pressure_angle", "pitch_curvature", "profile_curvature", "radius"), ("base-radius", "span")),
        "contact_force": ("preload", "spring", "base-radius"),
        "contact_pressure": ("roller-radius", "base-radius"),
    }
)
"""Quantity -> rows of ``WANTED`` whose field is traded for it, the first that a design has."""


def traded(design: Design, name: str) -> str:
    """The path of the field that is traded for a quantity; empty where there is none."""
    there = offered(design)
    what = next((what for what in TRADED.get(name, ()) if what in there), "")
    return varied(design, what)[0] if what else ""


@frozen(eq=False)
class Trade:
    """Values of a field (n,), rising, and the extreme (n,) of a quantity that each gives, in the unit of its column; NaN where the
    design cannot be built."""

    design: Design
    path: str
    key: str
    value: np.ndarray
    extreme: np.ndarray

    def at(self, wanted: float, near: float | None = None) -> float | None:
        """The value next to one, that of the design where none is named, that gives the extreme wanted, linear between those tried; None
        where none does."""
        own, off = get(self.design, self.path) if near is None else near, self.extreme - wanted
        crossed = np.flatnonzero((off[:-1] * off[1:] <= 0.0) & (off[:-1] != off[1:]))
        found = self.value[crossed] - off[crossed] * np.diff(self.value)[crossed] / np.diff(off)[crossed]
        return float(found[np.abs(found - own).argmin()]) if found.size else None

    def exactly(self, wanted: float, near: float | None = None) -> float | None:
        """The same to 1e-9, where the extreme is no larger in size than wanted."""
        from scipy.optimize import brentq

        rough = self.at(wanted, near)
        if rough is None:
            return None
        j = int(np.clip(np.searchsorted(self.value, rough), 1, self.value.size - 1))

        def off(value: float) -> float:
            return float(many(self.design, {self.path: [value]}, [self.key]).value[self.key][0]) - wanted

        low, high = self.value[j - 1], self.value[j]
        if off(low) * off(high) > 0.0:
            return rough
        found = brentq(off, low, high, xtol=1e-10 * high, rtol=1e-12)
        ends = [found * (1.0 + side * 1e-9) for side in (-1.0, 0.0, 1.0)]
        return float(min(ends, key=lambda value: abs(off(value) + wanted) - abs(wanted) > 0.0 or abs(value - found)))


def trade(design: Design, name: str, highest: bool) -> Trade | None:
    """How an extreme of the pressure angle, or of another quantity of the cam's size, goes with the base radius; None where the design
    has none, or cannot be computed."""
    path = traded(design, name)
    if path != "cam.base_radius_mm":
        return None
    slug = quantity(name).slug.format(m=design.drive.motion_unit)
    key = f"{slug}:{'max' if highest else 'min'}"
    tried = WANTED["base-radius"].values(design, path)
    try:
        found = many(design, {path: tried}, [key], polish=False).value[key]
    except (KindynaError, ValueError):
        return None
    return Trade(design, path, key, tried, found)


__all__ = ["TRADED", "Trade", "trade", "traded"]
