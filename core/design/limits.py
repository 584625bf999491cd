"""The user's own limits of a drive, one row each: a field that says of which quantities it is a limit. Finding, margin, line in plots
and report, and what Find may hold follow; usual values and figures of other sorts stand in ``core.study.limits``."""

from __future__ import annotations

from typing import Any

from core.design.fields import LONGEST_MM, Bounds, number
from core.frozen import frozen


def _angle(label: str, stretch: str) -> Any:
    return number(
        label,
        0.0,
        90.0,
        open_low=True,
        default=None,
        step=1.0,
        help=f"greatest {stretch}; empty = the usual one",
        bounds=Bounds(("pressure_angle",), line=f"limit of the {label.rpartition(' ')[2]} {{}}"),
    )


# Which quantities a limit holds for is in its ``Bounds``, by their names in ``core.study.quantities``. With a ``remedy`` there the whole
# check follows; without, the limit has a check of its own (``core.study.cam_checks``, ``contact_stress``), and a new row would be silent.
# A lower limit says ``most=False``.


def _least(label: str, help: str, usual: str = "none") -> Any:
    return number(label, 0.0, LONGEST_MM, open_low=True, default=None, help=f"{help}; empty = {usual}")


def _most(label: str, help: str, bounds: Bounds) -> Any:
    return number(label, 0.0, open_low=True, default=None, help=f"{help}; empty = none", bounds=bounds)


@frozen(kw_only=True)
class Limits:
    """What the user does not want to exceed, as far as stated; radii are those of the profile."""

    pressure_angle_rise_deg: float | None = _angle("Pressure angle, rise", "while the motion rises")
    pressure_angle_return_deg: float | None = _angle("Pressure angle, return", "while it returns")
    convex_radius_mm: float | None = _least(
        "Convex radius",
        "least radius of curvature where the profile bulges",
        "half the roller's radius, 3 mm under what slides",
    )
    concave_radius_mm: float | None = _least("Concave radius", "least radius of curvature where the profile is hollow")
    polar_radius_mm: float | None = _least(
        "Polar radius",
        "least distance of the profile from the cam centre",
        "metal around hub and bore, else room for the shaft's hub",
    )
    contact_force_n: float | None = _most(
        "Contact force",
        "greatest between follower and cam",
        Bounds(
            ("contact_force", "second_contact_force", "elastic_contact_force"),
            "lower the speed, the masses or the closing force",
        ),
    )
    contact_pressure_mpa: float | None = _most(
        "Contact pressure",
        "greatest between follower and cam",
        Bounds(("contact_pressure", "second_contact_pressure")),
    )


NO_LIMITS = Limits()
