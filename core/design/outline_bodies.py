"""Bodies with outlines: their words in the file, their names in the kinematics, and the columns of their clearances."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from core.design.camshaft import drive_names, slug, slugs
from core.design.design import Design, Drive
from core.design.linkage import FRAME_LINK
from core.design.outlines import CAM, CARRIED, FRAME, ROLLER, Outline
from core.frozen import frozen

_ARM = {"arm": "arm", "follower": "arm"}
_TRAIN = {"rocker": "rocker", "valve": "valve"}
_BODIES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "cam-slider": {"follower": "slider", "arm": "arm", "rod": "rod"},
        "translating": {"follower": "follower"},
        "oscillating": _ARM,
        "rocker": {"arm": "rocker", **_TRAIN},
        "pushrod": {"follower": "tappet", "pushrod": "pushrod", **_TRAIN},
    }
)
"""Kind of mechanism -> word of a body -> its name in the kinematics."""


def body_words(drive: Drive) -> Mapping[str, str]:
    """Word of every body of a drive that can have an outline -> its name in the kinematics; the frame is not listed."""
    mechanism: object = drive.mechanism  # None in a file with an unreadable table
    if mechanism is None:
        return {}
    if drive.is_alone:  # without a cam, or with one in space, which is in no plane
        return {"follower": "output"}
    if drive.is_linkage:
        words = {f"link {n}": f"link{n}" for n in sorted(drive.linkage.by_number) if n != FRAME_LINK}
    else:
        words = dict(_BODIES[drive.kind])
    if drive.cam is None:
        return words
    return words | {CAM: CAM} | ({} if drive.face.slides or drive.face.straight else {ROLLER: ROLLER})


@frozen
class Body:
    """A body with an outline.

    Attributes
    ----------
    drive : number of its drive, None for the frame and the transferred part
    name : in the kinematics of the drive: ``arm``, ``link3``, ``cam``; ``frame`` or ``carried``
    """

    drive: int | None
    name: str


def drive_number(design: Design, name: str) -> int | None:
    """Number of the drive with a name or slug; None where there is none."""
    for names in (drive_names(design), slugs(design)):
        if name in names:
            return names.index(name)
    return None


def is_frame(design: Design, number: int | None, word: str) -> bool:
    """Whether a word is the frame: that word, or the link of that number in a linkage."""
    if word == f"link {FRAME_LINK}" and number is not None:
        return design.drives[number].is_linkage
    return word == FRAME


def body_of(design: Design, outline: Outline) -> Body | None:
    """Body of an outline; None where the design has no such body."""
    number = drive_number(design, outline.drive) if outline.drive else None if design.listed else 0
    if is_frame(design, number, outline.of):
        return Body(None, FRAME)
    if outline.of == CARRIED:
        return Body(None, CARRIED)
    name = None if number is None else body_words(design.drives[number]).get(outline.of)
    return None if name is None else Body(number, name)


def body_named(design: Design, text: str) -> Body | None:
    """Body of a name, ``link 3`` or ``feed.arm``; None where the design has no such body."""
    drive, dot, word = text.rpartition(".")
    return body_of(design, Outline(of=word, drive=drive or None)) if bool(dot) == bool(drive) else None


def outlined_bodies(design: Design) -> Mapping[Body, str]:
    """Body with outlines -> its name, in the order of the file; a body that two words name has the first."""
    names: dict[Body, str] = {}
    for outline in design.outlines:
        body = body_of(design, outline)
        if body is not None and body not in names:
            listed = design.listed and body.drive is not None
            word = outline.of if body.drive is not None else body.name
            names[body] = f"{slugs(design)[body.drive]}.{word}" if listed and body.drive is not None else word
    return names


def share_layer(first: Outline, second: Outline) -> bool:
    """Whether two outlines have a common layer and plane; layers that only touch have none."""
    low, high = max(first.layer[0], second.layer[0]), min(first.layer[1], second.layer[1])
    return low < high and first.plane == second.plane


def pair_slug(names: Sequence[str]) -> str:
    """Names of two bodies as in columns: ``link_3__frame``, ``feed_arm__clamp_cam``."""
    return "__".join(slug(name) for name in names)


def pair_column(names: Sequence[str]) -> str:
    """Column of the clearance of two bodies, ``link_3__frame_mm``; also the name of that quantity."""
    return f"{pair_slug(names)}_mm"
