"""The engine of a valve train, and the valve that a drive moves, as typed: crank degrees from TDC of overlap."""

from __future__ import annotations

from core.design.fields import choice, coordinate, length, number, whole
from core.frozen import frozen

FLAT, PARALLEL = "flat", "parallel"


@frozen(kw_only=True)
class Engine:
    """Crank of a four-stroke engine, which turns twice while the camshaft turns once; machine angle 0 is TDC of overlap."""

    stroke_mm: float = length("Stroke")
    rod_mm: float = length("Connecting rod", help="centre to centre")
    pin_offset_mm: float = coordinate(
        "Pin offset", default=0.0, help="of the cylinder's axis, towards the side to which the crank turns after TDC"
    )


@frozen(kw_only=True)
class Valve:
    """Valve that a drive moves: its timing on the crank, its lash, and its position against the piston."""

    centre_deg: float = number(
        "Lobe centre", -720.0, 720.0, step=1.0, help="crank angle from TDC of overlap to the greatest lift; exhaust < 0"
    )
    cylinder_deg: float = number(
        "Cylinder", -720.0, 720.0, default=0.0, step=1.0, help="crank angle by which its TDC of overlap comes later"
    )
    lash_mm: float = number("Lash", 0.0, default=0.0, step=0.01, help="at the valve's tip")
    angle_deg: float | None = number(
        "Valve angle", -89.0, 89.0, default=None, step=1.0, help="against the cylinder's axis"
    )
    clearance_mm: float | None = number(
        "Clearance at TDC", 0.0, default=None, help="of the closed valve: along the cylinder's axis (flat), or its own"
    )
    pocket: str = choice("Piston crown", (FLAT, PARALLEL), default=FLAT, help="flat, or a pocket parallel to the head")
    link: int | None = whole("Valve's link", 2, 1000, default=None, help="of a linkage: the slider that is the valve")
