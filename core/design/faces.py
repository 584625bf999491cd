"""What of the follower touches the cam: one small class per face, chosen by the word ``face`` of the file.

A roller's radius stands in [cam]; a linkage's cam holds its face whole. Whoever needs the face of a drive asks ``Drive.face``.
Each class has its word as ``face``, what it is called in messages as ``noun``, whether it slides on the cam as ``slides`` and is a
straight line, which has no centre, as ``straight``, and as ``reach`` what takes its reference point from the cam centre to where it
stands on the base circle.
"""

from __future__ import annotations

from typing import Any, ClassVar

from core.design.fields import coordinate, leading, length, number, seldom
from core.frozen import frozen

FACE = "face"
"""Key of the word."""


@frozen
class Roller:
    """It turns on its own axis and rolls on the cam; its centre is the follower's reference point."""

    face: ClassVar[str] = "roller"
    noun: ClassVar[str] = "roller"
    straight: ClassVar[bool] = False
    reach: ClassVar[str] = "base radius + roller radius"
    slides: ClassVar[bool] = False
    roller_radius_mm: float = leading(length("Roller radius Rr"))

    @property
    def radius_mm(self) -> float:
        """Radius of the face about the reference point [mm]."""
        return self.roller_radius_mm

    def on(self, cam: Any) -> Roller:
        """The face as it is on this cam, whose table may state its radius."""
        return self


@frozen
class Rolling:
    """A roller in [follower], which says no more: its radius is the cam's entry."""

    face: ClassVar[str] = "roller"
    noun: ClassVar[str] = "roller"
    straight: ClassVar[bool] = False
    reach: ClassVar[str] = "base radius + roller radius"

    def on(self, cam: Any) -> Roller:
        """The face as it is on this cam, whose table may state its radius."""
        return Roller(cam.roller_radius_mm)


@frozen
class _Sliding:
    """A face that is fixed to the follower and slides on the cam."""

    slides: ClassVar[bool] = True
    straight: ClassVar[bool] = False

    def on(self, cam: Any) -> Any:
        """The face as it is on this cam, whose table may state its radius."""
        return self


@frozen
class Knife(_Sliding):
    """An edge: the profile is the path of the reference point."""

    face: ClassVar[str] = "knife"
    noun: ClassVar[str] = "knife edge"
    reach: ClassVar[str] = "base radius"

    @property
    def radius_mm(self) -> float:
        """Radius of the face about the reference point [mm]."""
        return 0.0


@frozen
class Shoe(_Sliding):
    """A round that slides; its centre is the reference point."""

    face: ClassVar[str] = "shoe"
    noun: ClassVar[str] = "shoe"
    reach: ClassVar[str] = "base radius + shoe radius"
    shoe_radius_mm: float = length("Shoe radius", help="its centre is where a roller's would be")

    @property
    def radius_mm(self) -> float:
        """Radius of the face about the reference point [mm]."""
        return self.shoe_radius_mm


@frozen(kw_only=True)
class Flat(_Sliding):
    """A straight face. Its normal m points from the cam to the face; places on it are counted along i·m from the
    reference point."""

    face: ClassVar[str] = "flat"
    straight: ClassVar[bool] = True
    noun: ClassVar[str] = "flat face"
    face_half_width_mm: float | None = number(
        "Face half width", 0.0, 1e9, open_low=True, default=None, help="empty = as wide as it needs to be"
    )
    face_centre_mm: float = seldom(
        coordinate("Face centre", default=0.0, help="middle of the face, along it from its reference point")
    )

    @property
    def radius_mm(self) -> float:
        """How far its reference stands off the cam: it lies on it."""
        return 0.0

    @property
    def tilt_deg(self) -> float:
        """Of its normal from the x axis of its body."""
        return 0.0


@frozen(kw_only=True)
class TiltedFlat(Flat):
    """Of a translating follower: the reference point is where the line at the offset meets the face."""

    face_tilt_deg: float = seldom(
        number("Face tilt", -89.0, 89.0, default=0.0, help="from square to the guide, counter-clockwise")
    )

    @property
    def tilt_deg(self) -> float:
        """Tilt of the face [deg]."""
        return self.face_tilt_deg


@frozen(kw_only=True)
class OffsetFlat(Flat):
    """Of an arm: the reference point is the foot of the pivot on the face."""

    face_offset_mm: float = coordinate(
        "Face offset",
        default=0.0,
        help="of the face from the pivot, along its normal, which points from the cam to the face",
    )


RoundFace = Roller | Knife | Shoe
Face = Roller | Knife | Shoe | TiltedFlat | OffsetFlat
"""A face with its size, as the cam sees it."""


@frozen
class ContactFriction:
    """Of a face that slides on the cam."""

    contact_friction: float = number(
        "Contact friction", 0.0, 10.0, default=0.0, step=0.01, help="coefficient between face and cam"
    )


def rubs(table: Any) -> type[ContactFriction] | None:
    """Whether loads state a friction of the contact."""
    return ContactFriction if "contact_friction" in table else None
