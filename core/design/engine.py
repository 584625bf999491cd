"""A valve train as typed: its engine, the valve that a drive moves, and its lobe, in crank and cam degrees."""

from __future__ import annotations

from typing import Any, ClassVar

from core.design.fields import FileLayout, brief, choice, coordinate, length, number, placed, whole
from core.frozen import frozen

FLAT, PARALLEL = "flat", "parallel"
CRANK_PER_CAM = 2.0
"""Turns of the crank per turn of the camshaft of a four-stroke engine."""
HALF_CYCLE = 180.0 * CRANK_PER_CAM
"""Crank angle from TDC of overlap to the ends of the cycle [deg]."""


def within_cycle(crank: Any) -> Any:
    """Crank angle, or array of them, in the cycle from -360 to 360 [deg]."""
    return (crank + HALF_CYCLE) % (2.0 * HALF_CYCLE) - HALF_CYCLE


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


@frozen
class LobeRow:
    """A lift, and the crank degrees from one side to the other at this lift, or from one side to the nose."""

    at_mm: float = length("At lift", help="of the lobe")
    crank_deg: float = number("Crank angle", 0.0, 720.0, open_low=True, step=1.0, help="in crank degrees")


def _rows() -> Any:
    return placed(FileLayout(LobeRow, whole=True, rows=True), ())


@frozen(kw_only=True)
class LobeClosing:
    """Values of the closing side that differ from those of the opening side."""

    to_nose: tuple[LobeRow, ...] = _rows()
    ramp_mm: float | None = length("Closing ramp", help="height at which it ends", default=None)
    ramp_mm_per_deg: float | None = number(
        "Closing ramp's velocity", 0.0, open_low=True, default=None, help="by cam angle"
    )
    ramp_runup_deg: float | None = number(
        "Closing run-up", 0.0, 360.0, open_low=True, default=None, help="cam angle from the ramp to rest"
    )
    flank_flat: float | None = number(
        "Flat of the closing flank", 0.0, 1.0, default=None, step=0.05, help="part of it at constant acceleration"
    )
    nose_flat: float | None = number(
        "Flat behind the nose", 0.0, 1.0, default=None, step=0.05, help="part of it at constant acceleration"
    )


@frozen(kw_only=True)
class Lobe:
    """A lobe: its lift, two values of its opening side, ramp and flats, and the closing side where it differs.

    The two values are rows of ``duration`` or ``to_nose``, the greatest velocity, or an acceleration.
    """

    FILE_ORDER: ClassVar[tuple[str, ...]] = (
        "lift_mm",
        "duration",
        "to_nose",
        "velocity_mm_per_deg",
        "acceleration_mm_per_deg2",
        "nose_acceleration_mm_per_deg2",
        "ramp_mm",
        "ramp_mm_per_deg",
        "ramp_runup_deg",
        "flank_flat",
        "nose_flat",
        "nose_at_deg",
        "closing",
    )

    lift_mm: float = length("Lobe lift")
    duration: tuple[LobeRow, ...] = _rows()
    to_nose: tuple[LobeRow, ...] = _rows()
    velocity_mm_per_deg: float | None = number(
        "Greatest velocity", 0.0, open_low=True, default=None, help="by cam angle"
    )
    acceleration_mm_per_deg2: float | None = number(
        "Acceleration of the flank", 0.0, open_low=True, default=None, help="the greatest, by cam angle"
    )
    nose_acceleration_mm_per_deg2: float | None = number(
        "Deceleration of the nose", 0.0, open_low=True, default=None, help="the greatest, by cam angle"
    )
    ramp_mm: float = brief(length("Ramp", help="height at which it ends", default=0.1))
    ramp_mm_per_deg: float = brief(
        number("Ramp's velocity", 0.0, open_low=True, default=0.01, step=0.001, help="by cam angle")
    )
    ramp_runup_deg: float = brief(
        number("Run-up", 0.0, 360.0, open_low=True, default=5.0, step=1.0, help="cam angle from rest to the ramp")
    )
    flank_flat: float = brief(
        number("Flat of the flank", 0.0, 1.0, default=0.0, step=0.05, help="part of it at constant acceleration")
    )
    nose_flat: float = brief(
        number("Flat of the nose", 0.0, 1.0, default=0.0, step=0.05, help="part of it at constant acceleration")
    )
    nose_at_deg: float = brief(number("Nose at", 0.0, 360.0, default=180.0, step=1.0, help="own cam angle"))
    closing: LobeClosing | None = placed(FileLayout(LobeClosing, single=True), None)

    @property
    def is_symmetric(self) -> bool:
        """Whether the closing side has the values of the opening side."""
        return self.closing in (None, LobeClosing())
