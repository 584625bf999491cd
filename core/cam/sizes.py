"""Which entries of the design set the size of cam and face, by the class of the cam: where a finding leads."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from core.design import DiskCam, Face, LinkageCam, Roller, RollerCam, SecondArm, SecondLinkRoller, SecondPlace


class SizeEntries(NamedTuple):
    """pressure: code of the finding; size: field that makes the cam larger; hint: how, ``{smaller}`` for what else helps where
    the face has a radius; faces: table that holds the entries of a face other than a roller; gentler: what lessens the pressure
    angle on the rise or on the return."""

    pressure: str
    size: str
    hint: str
    smaller: str
    faces: str
    gentler: str


_DISK = SizeEntries(
    "pressure-angle",
    "cam.base_radius_mm",
    "make it larger,{smaller} or lower the motion",
    " or the {name} smaller,",
    "follower",
    "enlarge the base radius, or lengthen the {stretch}",
)
# a cam under a linkage has the size that the linkage gives it
_UNDER_LINKAGE = SizeEntries(
    "roller-pressure-angle",
    "cam.point",
    "let the {name} run farther from the frame's origin{smaller}",
    ", or make it smaller",
    "cam",
    "let the cam act on another point, or lengthen the {stretch}",
)
ENTRIES: Mapping[type, SizeEntries] = MappingProxyType({RollerCam: _DISK, DiskCam: _DISK, LinkageCam: _UNDER_LINKAGE})


class SecondEntry(NamedTuple):
    """field that places the second roller of a conjugate pair; remedy: what to do with it where its pressure angle is too large."""

    field: str
    remedy: str


_SECOND: Mapping[type, SecondEntry] = MappingProxyType(
    {
        SecondArm: SecondEntry("follower.second.angle_deg", "turn the second roller's arm, or change its length"),
        SecondPlace: SecondEntry("follower.second.distance_mm", "put the second roller farther away"),
        SecondLinkRoller: SecondEntry("cam.second.point", "let the second roller run at another point"),
    }
)


def second_entry(mechanism: Any, cam: Any) -> SecondEntry | None:
    """Where the second roller of a conjugate pair is placed; None of other cams."""
    return _SECOND.get(type(getattr(mechanism, "second", None) or getattr(cam.form, "second", None)))


def size_of(cam: object, name: str, radius: float) -> tuple[str, str]:
    """The field that sets the cam's size, and what to do with it; name: of the face, radius: it has one that may be smaller."""
    row = ENTRIES[type(cam)]
    return row.size, row.hint.format(name=name, smaller=row.smaller.format(name=name) if radius else "")


def face_table(cam: object, face: Face) -> str:
    """The table of the file that holds the face's own entries: a roller's radius is always the cam's."""
    return "cam" if isinstance(face, Roller) else ENTRIES[type(cam)].faces
