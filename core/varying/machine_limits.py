"""Limits of a machine as limits of a study: of its drives, of the contact with open cams, and of servos."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import partial
from types import MappingProxyType
from typing import NamedTuple

from core.design import Design, Limits, only, path_in
from core.errors import KindynaError
from core.find import StatedLimits
from core.project.reading_faults import did_you_mean
from core.study import Study
from core.study.limits import ANY_PRESSURE, CONVEX, FORCE, POLAR, USER_BOUNDS, bounded_quantities, limits_in_force
from core.study.quantities import quantity
from core.study.quantity_requests import quantity_request
from core.varying.request import StudyLimit
from core.varying.surveys import current_figures, request_keys, split_key

FORCE_MIN = f"{FORCE}_min"
PRESSURES = ("pressure_angle_rise_deg", "pressure_angle_return_deg", ANY_PRESSURE)


class MachineLimit(NamedTuple):
    """A limit of a drive, the figures that it bounds, and their bound.

    Attributes
    ----------
    figures : callable
        Design of one drive -> keys of figures; "min" has a least value, other statistics a greatest one.
    own : callable
        Design of one drive -> value of the limit, None where it has none.
    bound : callable
        Value of the limit, side of a figure (``side_of``) -> bound of the figure.
    is_strict : bool
        Whether a design that violates it already must keep it.
    """

    figures: Callable[[Design], tuple[str, ...]]
    own: Callable[[Design], float | None]
    bound: Callable[[float, float], float] = lambda value, side: value
    is_strict: bool = True


def _always(*figures: str) -> Callable[[Design], tuple[str, ...]]:
    return lambda design: figures


def _curvatures(of: str, of_outer: str) -> Callable[[Design], tuple[str, ...]]:
    """Curvatures of all flanks; of the outer flank of a groove another statistic."""
    inner = tuple(f"{name}profile_curvature_per_mm:{of}" for name in ("", "second_"))
    return _always(*inner, f"outer_curvature_per_mm:{of_outer}")


def _field(name: str, part: str = "limits") -> Callable[[Design], float | None]:
    """Value of a field of a part of the drive, None where the drive lacks one of them."""

    def value(design: Design) -> float | None:
        result: float | None = getattr(getattr(design.drive, part), name, None)
        return result

    return value


_servo = partial(_field, part="servo")


def _bounded(key: str) -> Callable[[Design], tuple[str, ...]]:
    """Figures that a limit with ``Bounds`` bounds."""
    of = "abs" if USER_BOUNDS[key][1].most else "min"

    def figures(design: Design) -> tuple[str, ...]:
        rows = (quantity(name) for name in bounded_quantities(design, key))
        return tuple(f"{row.slug.format(m=design.drive.motion_unit)}:{of}" for row in rows)

    return figures


def _least_force(design: Design) -> float | None:
    """Least contact force of a follower on an open cam, 0 where none is stated; None where the cam holds the follower."""
    cam = design.drive.cam
    if cam is None or cam.form.holds:
        return None
    return float(getattr(design.drive.loads, FORCE.rpartition(".")[2], None) or 0.0)


def _curvature(radius: float, side: float) -> float:
    """Bound of a curvature by a least radius of the profile; the outer flank of a groove is convex where it is negative."""
    return side / radius if radius else side * math.inf


_NAMES = [field.name for field in fields(Limits)]
_PRESSURE = _always("pressure_angle_deg:max", "second_pressure_angle_deg:max")
ROWS: Mapping[str, MachineLimit] = MappingProxyType(
    {
        **{key: MachineLimit(_bounded(key), _field(key)) for key in _NAMES if key in USER_BOUNDS},
        **{key: MachineLimit(_PRESSURE, _field(key), is_strict=False) for key in PRESSURES},
        CONVEX: MachineLimit(_curvatures("max", "min"), _field(CONVEX), _curvature),
        "concave_radius_mm": MachineLimit(_curvatures("min", "max"), _field("concave_radius_mm"), _curvature),
        POLAR: MachineLimit(_always("radius_mm:min"), _field(POLAR)),
        FORCE_MIN: MachineLimit(_always("contact_force_n:min"), _least_force, is_strict=False),
        "servo.peak_torque_nm": MachineLimit(_always("servo_torque_nm:abs", "servo_force_n:abs"), _servo("peak_torque_nm")),
        "servo.rated_torque_nm": MachineLimit(_always("servo_torque_nm:rms", "servo_force_n:rms"), _servo("rated_torque_nm")),
        "servo.rated_rpm": MachineLimit(_always("servo_speed_rpm:abs"), _servo("rated_rpm")),
    }
)  # fmt: skip
"""Key of a limit -> its row: the keys of [limits], the least contact force, and the limits of a servo."""


def machine_limits(design: Design, stated: StatedLimits = MappingProxyType({})) -> tuple[StudyLimit, ...]:
    """Limits of all drives of a design, as stated, else their own, else the typical ones; and the clearances of its bodies.

    A typical limit, one of the pressure angle and one of the contact are relaxed to the present value where this exceeds them.

    Parameters
    ----------
    design : Design
    stated : dict
        Key of ``ROWS``, for all drives or with the number of one (``drives[1].contact_force_n``), or key of a figure
        (``drive_torque_nm:abs``) -> value; None removes the limit.

    Raises
    ------
    KindynaError
        Where no drive has such a limit, or such a figure.
    """
    rows: dict[str, float] = {}
    used: set[str] = set()
    for number in range(len(design.drives)):
        single = only(design, number)
        keys = {
            key: stated_key
            for key in ROWS
            for stated_key in (key, path_in(design, number, key))
            if stated_key in stated
        }
        values = {key: stated[stated_key] for key, stated_key in keys.items()}
        for figure, bound in _drive_bounds(single, values).items():
            rows[path_in(design, number, figure)] = bound
        present = set(request_keys(single))
        used |= {at for key, at in keys.items() if any(split_key(f)[0] in present for f in ROWS[key].figures(single))}
    rows |= _clearances(design)
    for key, value in stated.items():
        if ":" in key:
            _require_figure(design, key)
            rows.pop(key, None)
            rows |= {} if value is None else {key: value}
        elif key not in used:
            known = [*ROWS, *(path_in(design, i, key) for i in range(len(design.drives)) for key in ROWS)]
            raise KindynaError(
                f"limit {key!r}: this design has none of that name{did_you_mean(key, known)}; allowed: {' | '.join(ROWS)}, "
                "a figure as drive_torque_nm:abs, or the path of a varied number with _min or _max"
            )
    return tuple(_study_limit(figure, bound) for figure, bound in rows.items())


def _clearances(design: Design) -> Mapping[str, float]:
    """Least distance over the turn of every pair of bodies with a stated clearance -> this clearance [mm]."""
    if not design.clearances:
        return {}
    clearances = Study(design).clearances
    least = {f"{column}:min": clearances.required(pair) for column, pair in clearances.by_column.items()}
    return {figure: bound for figure, bound in least.items() if bound}


def _require_figure(design: Design, key: str) -> None:
    try:
        quantity_request(design, key)
    except ValueError as error:
        raise KindynaError(f"limit {error}") from None


def _study_limit(figure: str, bound: float) -> StudyLimit:
    slug, of = split_key(figure)
    return StudyLimit(slug, of, min=bound) if of == "min" else StudyLimit(slug, of, max=bound)


def _drive_bounds(design: Design, stated: StatedLimits) -> Mapping[str, float]:
    """Figure -> bound of one drive."""
    study, columns = Study(design), set(request_keys(design))
    typical = {key: row.value for key, row in limits_in_force(study).items() if key != POLAR}  # of an estimated torque
    bounds: dict[str, tuple[float, bool]] = {}  # the tightest, and whether the present value relaxes it
    for key, row in ROWS.items():
        own = row.own(design)
        value = stated[key] if key in stated else typical.get(key) if own is None else own
        is_lenient = key not in stated and (own is None or not row.is_strict)
        for figure in row.figures(design) if value is not None else ():
            bound, side = row.bound(float(value), side_of(figure)), side_of(figure)  # type: ignore[arg-type]
            tighter = figure not in bounds or side * bound < side * bounds[figure][0]
            if split_key(figure)[0] in columns and math.isfinite(bound) and tighter:
                bounds[figure] = (bound, is_lenient)
    present = _present(study, bounds)
    return {
        figure: bound
        if not lenient
        else side_of(figure) * max(side_of(figure) * bound, side_of(figure) * present[figure])
        for figure, (bound, lenient) in bounds.items()
        if not lenient or math.isfinite(present[figure])
    }


def side_of(figure: str) -> float:
    """-1 for a figure with a least value, else 1."""
    return -1.0 if split_key(figure)[1] == "min" else 1.0


def _present(study: Study, figures: Mapping[str, object]) -> Mapping[str, float]:
    """Figures of the present design; NaN where it has no value."""
    try:
        values, _ = current_figures(study, tuple(figures))
    except KindynaError:
        return dict.fromkeys(figures, math.nan)
    return values
