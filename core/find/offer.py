"""The searches available for a design, the limits that apply by default, and the trade of a field for a quantity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from types import MappingProxyType

import numpy as np

from core.design import Design, Info, Limits, get, info_of, split_unit
from core.errors import KindynaError, NoSolution
from core.find.goals import CAM_SEARCHES, ENDS, LEAST_PRESSURE, LIFT_OFF, SearchRow, has
from core.find.trial import RPM, ContactLimit
from core.frozen import frozen
from core.motion.extremes import piecewise_angles
from core.project.reading_faults import did_you_mean
from core.study import Study
from core.study.limits import ANY_PRESSURE, BOUNDS, FORCE, LIMITS, USER, LimitValue, limit_of
from core.study.many import many
from core.study.quantities import quantity

# -- searches and their default limits ------------------------------------------------------------------------

StatedLimits = Mapping[str, float | None]
"""Key of a limit -> its value; None removes the limit."""
Bounds = dict[str, tuple[float | None, float | None]]
OF_PRESSURE = ("pressure_angle_rise_deg", "pressure_angle_return_deg")
_PRESSURE = info_of(next(field for field in fields(Limits) if field.name == OF_PRESSURE[0])) or Info("")
LIMIT_RANGES: Mapping[str, Info] = MappingProxyType(
    {
        **{
            field.name: info if LIMITS[field.name].is_upper else replace(info, open_low=False)
            for field in fields(Limits)
            if (info := info_of(field)) is not None
        },
        ANY_PRESSURE: replace(_PRESSURE, label="Pressure angle", help="largest over the turn"),
        "contact_on_face_mm": Info(
            "Contact on the face", "largest distance from its centre", 0.0, open_low=True, optional=True
        ),
    }
)
"""Key in ``LIMITS`` -> name and range of the limit in a search; a least radius of 0 requires only that the cam is not undercut."""


def available_searches(design: Design) -> tuple[str, ...]:
    """Keys of ``CAM_SEARCHES`` whose fields the design has; none where it has no cam."""
    if design.drive.cam is None:
        return ()
    has_form_closure = design.drive.cam.form.holds
    rows = ((what, row) for what, row in CAM_SEARCHES.items() if not (row.seeks_contact and has_form_closure))
    return tuple(
        what
        for what, row in rows
        if (what != "rollers" or design.drive.motion_unit == "deg")
        and all(has(design, path) for path in row.fields(design, {}))
    )


def varied_fields(design: Design, what: str, choice: str = "") -> tuple[str, ...]:
    """Paths of the fields that a search varies; choice: the selected one, where there is a choice."""
    return CAM_SEARCHES[what].fields(design, {choice: (None, None)} if choice else {})


def default_limits(design: Design, what: str) -> Mapping[str, LimitValue]:
    """Limits of a search where none is stated: the design's own, else the typical ones for the present design."""
    row, study = CAM_SEARCHES[what], Study(design)
    limits: dict[str, LimitValue | None] = {key: _limit(study, key) for key in applicable_limits(design, what)}
    paths = row.fields(design, {})
    if row.bounded:
        limits |= {key: _bound(study, key) for key in BOUNDS if key[:-4] in paths}
    if row.target == LIFT_OFF:
        force = _bound(study, f"{FORCE}_min")
        limits[f"{FORCE}_min"] = force if force is not None and force.source == USER else LIFT_OFF_LIMIT
    elif _limits_contact(study, row):
        limits |= {key: _bound(study, key) for key in row.contact_limits(design)}
    return {key: limit for key, limit in limits.items() if limit is not None}


LIFT_OFF_LIMIT = LimitValue(0.0, "there the follower leaves the cam", USER)


def applicable_limits(design: Design, what: str) -> tuple[str, ...]:
    """Keys of the cam's limits in a search where none is stated; a least pressure angle has no typical limit."""
    row, user_limits = CAM_SEARCHES[what], vars(design.drive.limits)
    free = row.target == LEAST_PRESSURE
    study = Study(design)
    return tuple(
        key
        for key in row.limits
        if (user_limits.get(key) is not None and not LIMITS[key].missing(study))
        or (user_limits.get(key) is None and LIMITS[key].help and not (free and key.startswith("pressure_angle")))
    )


def _limit(study: Study, key: str) -> LimitValue | None:
    try:
        return limit_of(study, key)
    except NoSolution:
        return None


def _bound(study: Study, key: str) -> LimitValue | None:
    try:
        return BOUNDS[key].typical(study)
    except NoSolution:
        return None


def _limits_contact(study: Study, row: SearchRow) -> bool:
    """Whether contact limits a search: always where it seeks contact, else where the present design has contact."""
    if not row.contact_limits(study.design):
        return False
    try:
        contact = study.contact_force
        if row.seeks_contact:
            return True
        least, speed = (BOUNDS[key].typical(study) for key in row.contact_limits(study.design))
    except NoSolution:
        return False
    if least is None or speed is None:
        return False
    return contact.sampled(piecewise_angles(study.program), speed.value * RPM)[0] >= least.value


# -- requests ----------------------------------------------------------------------------------------------


@frozen
class SearchRequest:
    """Limits and bounds of a search.

    Attributes
    ----------
    limits : dict
        Key of ``LIMITS`` -> value, None: the typical value for each design.
    bounds : dict
        Path of a varied field -> bounds of its value.
    default_bounds : dict
        Path with _min or _max -> the bounds among these that are typical values, with their reason.
    contact : ContactLimit or None
        Least contact force; None where contact is no limit.
    waived : frozenset of str
        Codes of findings that a solution may add, since their limits are stated.
    """

    limits: dict[str, float | None]
    bounds: Bounds
    default_bounds: Mapping[str, LimitValue]
    contact: ContactLimit | None
    waived: frozenset[str]


def search_request(design: Design, what: str, stated: StatedLimits, choice: str = "") -> SearchRequest:
    """Limits of a search: as stated, else the design's own, else the typical ones.

    A stated limit replaces the same one only; that of the pressure angle over the full turn replaces rise and return.
    choice: path of the varied field, where there is a choice.

    Raises
    ------
    KindynaError
        Where the search has no such limit, or a limit is outside its range.
    """
    row, defaults = CAM_SEARCHES[what], default_limits(design, what)
    contact_keys = row.contact_limits(design)
    bounds: Bounds = {choice: (None, None)} if choice else {}
    user_limits = vars(design.drive.limits)
    limits: dict[str, float | None] = {key: user_limits.get(key) for key in applicable_limits(design, what)}
    if stated.get(ANY_PRESSURE) is not None:
        limits = {key: value for key, value in limits.items() if value is not None or key not in OF_PRESSURE}
    for key, value in stated.items():
        if key in row.limits:
            _require_range(key, value)
            limits[key] = value
        elif key in contact_keys:
            _require_positive(key, value)
        elif key.endswith(ENDS) and "." in key[:-4] and row.bounded:
            _add_bound(bounds, key, value)
        else:
            allowed = (*row.limits, *contact_keys, *(("the field's path with _min or _max",) if row.bounded else ()))
            raise KindynaError(
                f"limit {key!r}: {what} has none of that name{did_you_mean(key, allowed)}; allowed: {' | '.join(allowed)}"
            )
    limits = {key: value for key, value in limits.items() if value is not None or key not in stated}
    free = {key: bound for key, bound in defaults.items() if key in BOUNDS and key not in (*contact_keys, *stated)}
    default_bounds = {key: bound for key, bound in free.items() if _is_compatible(bounds, key, bound)}
    for key, bound in default_bounds.items():
        _add_bound(bounds, key, bound.value)
    codes = {code for key in stated for rows in (LIMITS, BOUNDS) if key in rows for code in rows[key].findings}
    contact = _contact_limit(design, contact_keys, stated, defaults)
    return SearchRequest(limits, bounds, default_bounds, contact, frozenset(codes))


def _add_bound(bounds: Bounds, key: str, value: float | None) -> None:
    """Add a bound: the path of a field with _min or _max."""
    low, high = bounds.get(key[:-4], (None, None))
    bounds[key[:-4]] = (value, high) if key.endswith(ENDS[0]) else (low, value)


def _is_compatible(bounds: Bounds, key: str, bound: LimitValue) -> bool:
    """Whether a typical bound is on the correct side of the stated opposite bound."""
    low, high = bounds.get(key[:-4], (None, None))
    return high is None or bound.value < high if key.endswith(ENDS[0]) else low is None or bound.value > low


def _contact_limit(
    design: Design, keys: tuple[str, ...], stated: StatedLimits, defaults: Mapping[str, LimitValue]
) -> ContactLimit | None:
    """Least contact force and highest speed, where contact limits the search or one of them is stated."""
    if not any(stated.get(key) is not None or key in defaults for key in keys) or stated.get(keys[0], 0.0) is None:
        return None
    force, default = stated.get(keys[0]), defaults.get(keys[0])
    if force is None and default is not None and default.source == USER:
        force = default.value
    speeds = {key: limit.value for key, limit in defaults.items()} | dict(stated)
    speed = speeds.get(keys[-1]) if len(keys) > 1 else None
    return ContactLimit(force, (design.speed_rpm if speed is None else speed) * RPM)


def _require_range(key: str, value: float | None) -> None:
    """Require that a stated limit is within its range."""
    info = LIMIT_RANGES[key]
    if not info.admits(value):
        raise KindynaError(f"limit {key} = {value:g}: {info.problem}; allowed: {info.allowed(split_unit(key)[1])}")


def _require_positive(key: str, value: float | None) -> None:
    """Require a force of at least 0, or a speed above 0."""
    force = key.startswith(FORCE)
    if value is not None and not (value >= 0.0 if force else value > 0.0):
        raise KindynaError(f"limit {key} = {value:g}: outside its range; allowed: {'>= 0 N' if force else '> 0 rpm'}")


# -- the trade of a field for a quantity ------------------------------------------------------------------------

TRADED: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        **dict.fromkeys(("displacement", "velocity", "acceleration", "jerk"), ("span",)),
        **dict.fromkeys(("pressure_angle", "pitch_curvature", "profile_curvature", "radius"), ("base-radius", "span")),
        "contact_force": ("preload", "spring", "base-radius"),
        "contact_pressure": ("roller-radius", "base-radius"),
    }
)
"""Quantity -> keys of ``CAM_SEARCHES`` whose field is traded for it; the first available one counts."""


def traded_field(design: Design, name: str) -> str:
    """Path of the field that is traded for a quantity; empty where none is."""
    available = available_searches(design)
    what = next((what for what in TRADED.get(name, ()) if what in available), "")
    return varied_fields(design, what)[0] if what else ""


@frozen(eq=False)
class Trade:
    """Extreme of a quantity as a function of a field.

    Attributes
    ----------
    design : Design
    path : str
        Path of the field.
    key : str
        Quantity and extreme.
    value : ndarray (n,) [mm]
        Rising values of the field.
    extreme : ndarray (n,)
        Extremes in the unit of the quantity's column; NaN where the design cannot be built.
    """

    design: Design
    path: str
    key: str
    value: np.ndarray
    extreme: np.ndarray

    def field_value(self, target: float, near: float | None = None) -> float | None:
        """Value of the field that gives the target extreme, by linear interpolation; None where no value does.

        Of several values the nearest to ``near``, by default to the design's own.
        """
        present, error = get(self.design, self.path) if near is None else near, self.extreme - target
        crossed = np.flatnonzero((error[:-1] * error[1:] <= 0.0) & (error[:-1] != error[1:]))
        roots = self.value[crossed] - error[crossed] * np.diff(self.value)[crossed] / np.diff(error)[crossed]
        return float(roots[np.abs(roots - present).argmin()]) if roots.size else None

    def exact_field_value(self, target: float, near: float | None = None) -> float | None:
        """Value of the field to 1e-9 whose extreme does not exceed the target in size; None where no value has it."""
        from scipy.optimize import brentq  # slow to import

        rough = self.field_value(target, near)
        if rough is None:
            return None
        j = int(np.clip(np.searchsorted(self.value, rough), 1, self.value.size - 1))

        def error(value: float) -> float:
            return float(many(self.design, {self.path: [value]}, [self.key]).value[self.key][0]) - target

        low, high = self.value[j - 1], self.value[j]
        if error(low) * error(high) > 0.0:
            return rough
        root = brentq(error, low, high, xtol=1e-10 * high, rtol=1e-12)
        ends = [root * (1.0 + side * 1e-9) for side in (-1.0, 0.0, 1.0)]
        return float(min(ends, key=lambda value: abs(error(value) + target) - abs(target) > 0.0 or abs(value - root)))


def trade(design: Design, name: str, highest: bool) -> Trade | None:
    """Trade of the base radius for an extreme of a quantity of the cam's size.

    None where the design has no base radius, or cannot be computed.
    """
    path = traded_field(design, name)
    if path != "cam.base_radius_mm":
        return None
    slug = quantity(name).slug.format(m=design.drive.motion_unit)
    key = f"{slug}:{'max' if highest else 'min'}"
    values = CAM_SEARCHES["base-radius"].values(design, path)
    try:
        extremes = many(design, {path: values}, [key], polish=False).value[key]
    except (KindynaError, ValueError):
        return None
    return Trade(design, path, key, values, extremes)
