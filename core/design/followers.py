"""Faces of a follower on the cam, one class for each word ``face`` of the file, and forms of a disk cam.

A roller's radius is in [cam]; a linkage's cam contains its face. ``Drive.face`` returns the face of a drive. The class
attributes of a face are its word ``face``, its name ``noun`` in messages, whether it ``slides`` on the cam, whether it is a
``straight`` line without a centre, and ``reach``, the distance of its reference point from the cam centre on the base circle.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any, ClassVar

from core.design.fields import (
    LARGEST,
    LONGEST_MM,
    MAIN,
    FileLayout,
    choice,
    chosen_by_word,
    coordinate,
    leading,
    length,
    number,
    placed,
    seldom,
    whole,
)
from core.frozen import frozen
from core.materials import MATERIALS

# -- faces of a follower ----------------------------------------------------------------------------------------


FACE = "face"
"""Key of the word."""


@frozen
class Roller:
    """A roller, whose centre is the follower's reference point."""

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
        """The face with its size, which the cam may state."""
        return self


@frozen
class Rolling:
    """A roller in [follower], whose radius is in [cam]."""

    face: ClassVar[str] = "roller"
    noun: ClassVar[str] = "roller"
    straight: ClassVar[bool] = False
    reach: ClassVar[str] = "base radius + roller radius"

    def on(self, cam: Any) -> Roller:
        """The face with its size, which the cam may state."""
        return Roller(cam.roller_radius_mm)


@frozen
class _Sliding:
    """A face that is fixed to the follower and slides on the cam."""

    slides: ClassVar[bool] = True
    straight: ClassVar[bool] = False

    def on(self, cam: Any) -> Any:
        """The face with its size, which the cam may state."""
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
    """A cylindrical face that slides; its centre is the reference point."""

    face: ClassVar[str] = "shoe"
    noun: ClassVar[str] = "shoe"
    reach: ClassVar[str] = "base radius + shoe radius"
    shoe_radius_mm: float = length("Shoe radius", help="with its centre at the position of a roller's centre")

    @property
    def radius_mm(self) -> float:
        """Radius of the face about the reference point [mm]."""
        return self.shoe_radius_mm


@frozen(kw_only=True)
class Flat(_Sliding):
    """A straight face; positions on it are measured from the reference point along i·m, m its normal away from the cam."""

    face: ClassVar[str] = "flat"
    straight: ClassVar[bool] = True
    noun: ClassVar[str] = "flat face"
    face_half_width_mm: float | None = number(
        "Face half width", 0.0, 1e9, open_low=True, default=None, help="empty = as wide as needed"
    )
    face_centre_mm: float = seldom(
        coordinate("Face centre", default=0.0, help="middle of the face, along it from its reference point")
    )

    @property
    def radius_mm(self) -> float:
        """Distance of the reference point from the profile [mm]: 0, it is on the face."""
        return 0.0

    @property
    def tilt_deg(self) -> float:
        """Tilt of the face [deg]."""
        return 0.0


@frozen(kw_only=True)
class TiltedFlat(Flat):
    """Flat face of a translating follower; its reference point is on the line at the offset."""

    face_tilt_deg: float = seldom(
        number("Face tilt", -89.0, 89.0, default=0.0, help="from the perpendicular to the guide, counter-clockwise")
    )

    @property
    def tilt_deg(self) -> float:
        """Tilt of the face [deg]."""
        return self.face_tilt_deg


@frozen(kw_only=True)
class OffsetFlat(Flat):
    """Flat face of an arm; its reference point is the projection of the pivot on the face."""

    face_offset_mm: float = coordinate(
        "Face offset",
        default=0.0,
        help="of the face from the pivot, along its normal, which points from the cam to the face",
    )


RoundFace = Roller | Knife | Shoe
Face = Roller | Knife | Shoe | TiltedFlat | OffsetFlat
"""A face with its size."""


@frozen
class ContactFriction:
    """Friction of a face that slides on the cam."""

    contact_friction: float = number(
        "Contact friction", 0.0, 10.0, default=0.0, step=0.01, help="coefficient between face and cam"
    )


def rubs(table: Any) -> type[ContactFriction] | None:
    """Class of the contact friction, where a table of loads has it."""
    return ContactFriction if "contact_friction" in table else None


# -- forms of a disk cam ----------------------------------------------------------------------------------------


FORM = "form"
"""Key of the word."""


def _known(label: str, help: str, high: float = LONGEST_MM, otherwise: str = "not known") -> Any:
    return number(label, 0.0, high, open_low=True, default=None, help=f"{help}; empty = {otherwise}")


def _play(help: str) -> Any:
    return number("Play", 0.0, LONGEST_MM, default=0.0, help=help)


@frozen
class Open:
    """A cam with one flank; a force must press the follower on it."""

    form: ClassVar[str] = "open"
    holds: ClassVar[bool] = False


@frozen
class Groove:
    """A groove cam, with the roller between an inner and an outer flank."""

    form: ClassVar[str] = "groove"
    holds: ClassVar[bool] = True
    play_mm: float = _play("width of the groove minus the roller's diameter, at the outer flank")
    outer_radius_mm: float | None = _known("Blank radius", "of the disk around the groove, for its solid")
    groove_depth_mm: float | None = _known(
        "Groove depth", "from the upper face, less than the thickness, for its solid"
    )


def _material(label: str, help: str) -> Any:
    gives = "gives modulus, Poisson's ratio and, where known, the allowable pressure"
    return choice(label, tuple(MATERIALS), default=None, help=f"{help}; {gives}")


def _ratio(label: str) -> Any:
    return number(
        label, 0.0, 0.5, default=None, step=0.01, help="for a typed modulus; empty = the material's, else 0.3"
    )


@frozen(kw_only=True)
class Surfaces:
    """Materials of the cam and of the face on it, and the roller's bearing, as far as known; a typed modulus has priority."""

    material: str | None = leading(_material("Material", "of the cam"))
    roller_material: str | None = leading(_material("Roller material", "of roller, shoe or face"))
    youngs_modulus_gpa: float | None = _known("Young's modulus", "of the cam", LARGEST, "the material's")
    poisson_ratio: float | None = _ratio("Poisson's ratio")
    roller_youngs_modulus_gpa: float | None = _known(
        "Roller's modulus", "Young's modulus of roller, shoe or face", LARGEST, "the material's"
    )
    roller_poisson_ratio: float | None = _ratio("Roller's Poisson's ratio")
    roller_load_rating_n: float | None = _known(
        "Roller's load rating C", "dynamic rating of its bearing (ISO 281), for the rolling life", LARGEST
    )


@frozen(kw_only=True)
class SecondSurfaces(Surfaces):
    """Materials of the second cam and its roller; empty fields are as for the first."""

    thickness_mm: float | None = _known(
        "Second thickness", "width of the second cam along the shaft", otherwise="as the first cam"
    )


OF_SECOND = tuple(field.name for field in fields(SecondSurfaces))


@frozen(kw_only=True)
class SecondRoller(SecondSurfaces):
    """The roller on the second cam of a conjugate pair; its position is in [follower]."""

    roller_radius_mm: float = leading(length("Second roller radius"))


@frozen(kw_only=True)
class SecondLinkRoller(SecondSurfaces):
    """The roller on the second cam of a conjugate pair, at a point of a link."""

    link: int = whole("Second roller on link", 2, 999)
    point: str = placed(FileLayout(missing="the name of a point"))
    roller_radius_mm: float = leading(length("Second roller radius"))


@frozen(kw_only=True)
class Conjugate:
    """Two cams on one shaft, with a roller on each, which push in opposite directions."""

    form: ClassVar[str] = "conjugate"
    holds: ClassVar[bool] = True
    play_mm: float = _play("between the second roller and its cam")
    second: SecondRoller = placed(FileLayout(SecondRoller, single=True, missing="{ roller_radius_mm = 20.0 }"))


@frozen(kw_only=True)
class LinkageConjugate:
    """A conjugate pair of cams under a linkage."""

    form: ClassVar[str] = "conjugate"
    holds: ClassVar[bool] = True
    play_mm: float = _play("between the second roller and its cam")
    second: SecondLinkRoller = placed(
        FileLayout(SecondLinkRoller, single=True, missing='{ link = 3, point = "C", roller_radius_mm = 20.0 }')
    )


Form = Open | Groove | Conjugate | LinkageConjugate
FORMS = (Open.form, Groove.form, Conjugate.form)


def form_of(*classes: type[Form]) -> Any:
    """Dataclass field for the form of a cam, with its keys in the cam's table."""
    words = {class_.form: class_ for class_ in classes}
    return placed(chosen_by_word(FORM, words, "Form", otherwise=Open.form, weight=MAIN), Open())


@frozen(kw_only=True)
class CamDetails(Surfaces):
    """Further dimensions of a cam's drawing, as far as known."""

    thickness_mm: float | None = leading(_known("Thickness", "width of the profile along the shaft"))
    bore_mm: float | None = _known("Bore", "diameter")
    hub_mm: float | None = _known("Hub", "diameter")
    hub_length_mm: float | None = _known(
        "Hub length", "from the lower face of the cam, for its solid", otherwise="no hub"
    )
    keyway_width_mm: float | None = _known("Keyway width", "of the groove in the bore")
    keyway_depth_mm: float | None = _known("Keyway depth", "from the bore")
    keyway_angle_deg: float | None = number(
        "Keyway angle", -360.0, 360.0, default=None, help="of its middle in the cam's frame; empty = not known"
    )
    cutter_radius_mm: float | None = _known("Cutter radius", "of cutter or grinding wheel")
