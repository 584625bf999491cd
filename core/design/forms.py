"""Forms of a disk cam: one small class per form, chosen by the word ``form`` of the file, and what a cam may state besides.

Each class has its word as ``form`` and as ``holds`` whether the cam holds the follower from both sides, so that the contact
changes sides where its force would change its sign.
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
    leading,
    length,
    number,
    placed,
    whole,
)
from core.frozen import frozen
from core.materials import MATERIALS

FORM = "form"
"""Key of the word."""


def _play(help: str) -> Any:
    return number("Play", 0.0, LONGEST_MM, default=0.0, help=help)


@frozen
class Open:
    """One flank; something has to press the follower on it."""

    form: ClassVar[str] = "open"
    holds: ClassVar[bool] = False


@frozen
class Groove:
    """The roller runs between an inner and an outer flank."""

    form: ClassVar[str] = "groove"
    holds: ClassVar[bool] = True
    play_mm: float = _play("the groove is so much wider than the roller; the outer flank is the farther one")


def _known(label: str, help: str, most: float = LONGEST_MM, otherwise: str = "not known") -> Any:
    return number(label, 0.0, most, open_low=True, default=None, help=f"{help}; empty = {otherwise}")


def _material(label: str, help: str) -> Any:
    gives = "gives modulus, Poisson's ratio and, where known, the pressure that it bears"
    return choice(label, tuple(MATERIALS), default=None, help=f"{help}; {gives}")


def _ratio(label: str) -> Any:
    return number(
        label, 0.0, 0.5, default=None, step=0.01, help="beside a typed modulus; empty = the material's, else 0.3"
    )


@frozen(kw_only=True)
class Surfaces:
    """What touches there, as far as it is known: materials of cam and of the roller, shoe or face on it, and the roller's bearing.
    A typed modulus stands before that of the material."""

    material: str | None = leading(_material("Material", "of the cam"))
    roller_material: str | None = leading(_material("Roller material", "of what touches the cam, roller or not"))
    youngs_modulus_gpa: float | None = _known("Young's modulus", "of the cam", LARGEST, "the material's")
    poisson_ratio: float | None = _ratio("Poisson's ratio")
    roller_youngs_modulus_gpa: float | None = _known(
        "Roller's modulus", "Young's, of what touches the cam", LARGEST, "the material's"
    )
    roller_poisson_ratio: float | None = _ratio("Roller's Poisson's ratio")
    roller_load_rating_n: float | None = _known(
        "Roller's load rating C", "dynamic, of its bearing by ISO 281: then its life is computed", LARGEST
    )


@frozen(kw_only=True)
class SecondSurfaces(Surfaces):
    """The same of the second cam; what is empty is as of the first."""

    thickness_mm: float | None = _known(
        "Second thickness", "width of the second cam along the shaft", otherwise="as the first cam"
    )


OF_SECOND = tuple(field.name for field in fields(SecondSurfaces))


@frozen(kw_only=True)
class SecondRoller(SecondSurfaces):
    """The roller on the second cam of a conjugate pair; where it stands is the follower's entry."""

    roller_radius_mm: float = leading(length("Second roller radius"))


@frozen(kw_only=True)
class SecondLinkRoller(SecondSurfaces):
    """The roller on the second cam of a conjugate pair, at a point of a link."""

    link: int = whole("Second roller on link", 2, 999)
    point: str = placed(FileLayout(missing="the name of a point"))
    roller_radius_mm: float = leading(length("Second roller radius"))


@frozen(kw_only=True)
class Conjugate:
    """Two cams on one shaft, a roller on each: where the one would pull, the other pushes."""

    form: ClassVar[str] = "conjugate"
    holds: ClassVar[bool] = True
    play_mm: float = _play("between the second roller and its cam")
    second: SecondRoller = placed(FileLayout(SecondRoller, single=True, missing="{ roller_radius_mm = 20.0 }"))


@frozen(kw_only=True)
class LinkageConjugate:
    """The same under a linkage."""

    form: ClassVar[str] = "conjugate"
    holds: ClassVar[bool] = True
    play_mm: float = _play("between the second roller and its cam")
    second: SecondLinkRoller = placed(
        FileLayout(SecondLinkRoller, single=True, missing='{ link = 3, point = "C", roller_radius_mm = 20.0 }')
    )


Form = Open | Groove | Conjugate | LinkageConjugate
FORMS = (Open.form, Groove.form, Conjugate.form)


def form_of(*classes: type[Form]) -> Any:
    """A dataclass field for the form of a cam, whose keys stand in the cam's table."""
    words = {each.form: each for each in classes}
    return placed(chosen_by_word(FORM, words, "Form", otherwise=Open.form, weight=MAIN), Open())


@frozen(kw_only=True)
class CamDetails(Surfaces):
    """What the drawing of a cam may state besides its form, as far as it is known."""

    thickness_mm: float | None = leading(_known("Thickness", "width of the profile along the shaft"))
    bore_mm: float | None = _known("Bore", "diameter")
    hub_mm: float | None = _known("Hub", "diameter")
    keyway_width_mm: float | None = _known("Keyway width", "of the groove in the bore")
    keyway_depth_mm: float | None = _known("Keyway depth", "from the bore")
    keyway_angle_deg: float | None = number(
        "Keyway angle", -360.0, 360.0, default=None, help="of its middle in the cam's own frame; empty = not known"
    )
    cutter_radius_mm: float | None = _known("Cutter radius", "of cutter or grinding wheel")
