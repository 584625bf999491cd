"""What can be sought in a design, and the limits that hold where nobody states others."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from core.design import Design, get
from core.errors import KindynaError, NoSolution
from core.find.goals import ENDS, LEAST_PRESSURE, LIFT_OFF, WANTED, SearchRow, has
from core.find.trial import RPM, KeptForce
from core.frozen import frozen
from core.motion.extremes import piecewise_angles
from core.study import Study
from core.study.limits import ANY_PRESSURE, BOUNDS, FORCE, LIMITS, USER, LimitValue, limit_of
from core.study.many import many
from core.study.quantities import quantity

# -- what can be sought in a design, and the limits that hold where nobody states others ------------------------


Stated = Mapping[str, float | None]
"""Key of a limit -> its value; None: it is taken away."""
Bounds = dict[str, tuple[float | None, float | None]]
OF_PRESSURE = ("pressure_angle_rise_deg", "pressure_angle_return_deg")


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


def usual_limits(design: Design, what: str) -> Mapping[str, LimitValue]:
    """What limits a search of ``WANTED`` where none is stated: the design's own limits, else the usual ones, as they are for the design
    at hand."""
    row, study = WANTED[what], Study(design)
    found: dict[str, LimitValue | None] = {key: _known(study, key) for key in applying(design, what)}
    paths = row.fields(design, {})
    if row.bounded:
        found |= {key: _bound(study, key) for key in BOUNDS if key[:-4] in paths}
    if row.wanted == LIFT_OFF:
        force = _bound(study, f"{FORCE}_min")
        found[f"{FORCE}_min"] = force if force is not None and force.source == USER else AT_NOTHING
    elif _keeps(study, row):
        found |= {key: _bound(study, key) for key in row.keeping(design)}
    return {key: usual for key, usual in found.items() if usual is not None}


AT_NOTHING = LimitValue(0.0, "there the follower leaves the cam", USER)


def applying(design: Design, what: str) -> tuple[str, ...]:
    """The limits of the cam that hold in a search where none is stated; where the pressure angle is to be least no usual one of it."""
    row, own = WANTED[what], vars(design.drive.limits)
    free = row.wanted == LEAST_PRESSURE
    study = Study(design)
    return tuple(
        key
        for key in row.limits
        if (own.get(key) is not None and not LIMITS[key].missing(study))
        or (own.get(key) is None and LIMITS[key].help and not (free and key.startswith("pressure_angle")))
    )


def _known(study: Study, key: str) -> LimitValue | None:
    try:
        return limit_of(study, key)
    except NoSolution:
        return None


def _bound(study: Study, key: str) -> LimitValue | None:
    try:
        return BOUNDS[key].typical(study)
    except NoSolution:
        return None


def _keeps(study: Study, row: SearchRow) -> bool:
    """Whether a search keeps the follower on the cam: one for its spring, and every other where it is kept there now."""
    if not row.keeping(study.design):
        return False
    try:
        contact = study.contact_force
        if row.holding:
            return True
        kept, speed = (BOUNDS[key].typical(study) for key in row.keeping(study.design))
    except NoSolution:
        return False
    if kept is None or speed is None:
        return False
    return contact.sampled(piecewise_angles(study.program), speed.value * RPM)[0] >= kept.value


# -- what is asked -----------------------------------------------------------------------------------------


@frozen
class Request:
    """limits   key of ``LIMITS`` -> value, None: what is usual for each design tried
    bounds   path -> of the values of a field that is varied
    at_bound path with its end -> why that is a bound, where it is a usual one
    contact  what keeps the follower on the cam; None: nothing is asked of it
    waived   codes of the findings that an answer may bring, since their limits were stated
    """

    limits: dict[str, float | None]
    bounds: Bounds
    at_bound: Mapping[str, LimitValue]
    contact: KeptForce | None
    waived: frozenset[str]


def request(design: Design, what: str, stated: Stated, place: str = "") -> Request:
    """The limits of a search, each as stated, else the design's own, else the usual one: one that is stated takes the place of the same
    one only, but for the pressure angle over the whole turn, which stands for rise and return. place: of the fields of which one is
    varied. Raises KindynaError for what is none of its limits, or outside its range."""
    row, usual = WANTED[what], usual_limits(design, what)
    keeping = row.keeping(design)
    bounds: Bounds = {place: (None, None)} if place else {}
    limits: dict[str, float | None] = {key: vars(design.drive.limits).get(key) for key in applying(design, what)}
    if stated.get(ANY_PRESSURE) is not None:
        limits = {key: own for key, own in limits.items() if own is not None or key not in OF_PRESSURE}
    for key, value in stated.items():
        if key in row.limits:
            _require_sense(key, value)
            limits[key] = value
        elif key in keeping:
            _require_positive(key, value)
        elif key.endswith(ENDS) and "." in key[:-4] and row.bounded:
            _bound_by(bounds, key, value)
        else:
            allowed = (*row.limits, *keeping, *(("the field's path with _min or _max",) if row.bounded else ()))
            raise KindynaError(f"limit {key!r}: {what} has none of that name; allowed: {' | '.join(allowed)}")
    limits = {key: value for key, value in limits.items() if value is not None or key not in stated}
    free = {key: each for key, each in usual.items() if key in BOUNDS and key not in (*keeping, *stated)}
    at_bound = {key: each for key, each in free.items() if _between(bounds, key, each)}
    for key, each in at_bound.items():
        _bound_by(bounds, key, each.value)
    codes = {code for key in stated for rows in (LIMITS, BOUNDS) if key in rows for code in rows[key].findings}
    return Request(limits, bounds, at_bound, _contact(design, keeping, stated, usual), frozenset(codes))


def _bound_by(bounds: Bounds, key: str, value: float | None) -> None:
    """Add a bound: the path of a field with _min or _max."""
    low, high = bounds.get(key[:-4], (None, None))
    bounds[key[:-4]] = (value, high) if key.endswith(ENDS[0]) else (low, value)


def _between(bounds: Bounds, key: str, usual: LimitValue) -> bool:
    """Whether a usual bound leaves something to the one that is stated on the other side."""
    low, high = bounds.get(key[:-4], (None, None))
    return high is None or usual.value < high if key.endswith(ENDS[0]) else low is None or usual.value > low


def _contact(
    design: Design, keeping: tuple[str, ...], stated: Stated, usual: Mapping[str, LimitValue]
) -> KeptForce | None:
    """The force, and the speed up to which, of a search that keeps the follower on the cam, or in which one of them is stated."""
    if not any(stated.get(key) is not None or key in usual for key in keeping) or stated.get(keeping[0], 0.0) is None:
        return None
    force, own = stated.get(keeping[0]), usual.get(keeping[0])
    if force is None and own is not None and own.source == USER:
        force = own.value
    speeds = {key: each.value for key, each in usual.items()} | dict(stated)
    speed = speeds.get(keeping[-1]) if len(keeping) > 1 else None
    return KeptForce(force, (design.speed_rpm if speed is None else speed) * RPM)


def _require_sense(key: str, value: float | None) -> None:
    row = LIMITS[key]
    if value is None:
        return
    fits, allowed = value >= 0.0, f">= 0 {row.unit}"
    if row.is_upper:
        angle = row.unit == "deg"
        fits, allowed = (
            0.0 < value < (90.0 if angle else math.inf),
            "above 0, below 90 deg" if angle else f"above 0 {row.unit}",
        )
    if not fits:
        raise KindynaError(f"limit {key} = {value:g}: outside its range; allowed: {allowed}")


def _require_positive(key: str, value: float | None) -> None:
    """A force may be 0, a speed not."""
    force = key.startswith(FORCE)
    if value is not None and not (value >= 0.0 if force else value > 0.0):
        raise KindynaError(f"limit {key} = {value:g}: outside its range; allowed: {'>= 0 N' if force else '> 0 rpm'}")


# -- which field is traded for a quantity, and what value of it gives an extreme that is wanted -----------------


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
