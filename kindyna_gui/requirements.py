"""What a view needs of a design: a motion, a shaft, links that are listed one by one, what a contact pressure
takes. Where it is missing, there is a sentence for the user; Unavailable carries it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from core.design import Design, Motion, Shaft, motion_of
from core.errors import KindynaError
from core.frozen import frozen
from core.stress import is_line_contact, missing_inputs
from core.study import Study
from core.study.extremes import has_undercut

NO_MOTION = "The crank turns at constant speed: there is no motion to lay out. Let a link follow one."
NO_CAM = "This design has no cam"
NO_SHAFT = "Stability is studied for the shaft of a cam or a crank; this design has none."
NO_WHEEL = "A flywheel is sized for a shaft that a cam or a crank turns with; this design has none."
RIGID_SHAFT = "The camshaft is rigid: it winds up nowhere, and nothing can become unstable."
RIGID_FOLLOWER = "The follower is rigid and does not vibrate. It does with a stiffness and a damping ratio."
NO_ELASTIC = "An elastic follower is driven by a cam; this design has none."
NO_FLIGHT = "A follower can leave a cam; this design has none."
LED_BY_NO_CAM = "No cam makes this linkage move: "
LACKS_SIZES, NOTHING_PRESSES = "Contact pressure: give ", "Contact pressure: no masses and no forces are given"
NO_SIZES = "Find sizes a cam and its follower under limits; this design has no cam."
NO_FORCES = "No forces: no masses and no forces are given."
NO_RANKING = "Nothing to rank by: torque and forces need a cam and loads."
NOT_PINNED = "Nothing is pinned. A pinned variant is kept as it is, and what you change then is held against it."
NO_SERVO = "No servo makes this motion. One can be put beside the cam."
ALONE = "This design has one drive: its torque stands in the plot Torque. A shaft of several shows here what they ask together."
ONE_DRIVE = "This design has one drive. It can be the first of several on one shaft."

ONLY_LINKAGES = "Only the links of a linkage are drawn; those of this follower follow from its lengths."
STRANGE = "Preferences that are not understood: "


@frozen
class Suggestion:
    """What fills an empty view: the words of its button, and the entry of the menus that it stands for, by its key there."""

    text: str
    entry: str


DRIVER, ROLLER = Suggestion("Let a link follow a motion...", "drivers"), Suggestion("Put a cam under it...", "rollers")
BEGIN = Suggestion("Begin with a cam...", "designing.new_by_picture")
SHAFT, OPEN_LOADS = (
    Suggestion("Add a shaft", "designing.give_shaft"),
    Suggestion("Type masses and forces", "focus_field:loads"),
)
TO_SHAFT = Suggestion("Add it to a shaft...", "add_to_shaft")

SUGGESTIONS: Mapping[str, tuple[Suggestion, ...]] = MappingProxyType(
    {
        NO_MOTION: (DRIVER,),
        NO_SHAFT: (SHAFT,),
        NO_WHEEL: (SHAFT,),
        RIGID_SHAFT: (Suggestion("Make the shaft elastic", "designing.make_flexible"),),
        RIGID_FOLLOWER: (Suggestion("Type its stiffness", "focus_field:loads"),),
        NO_ELASTIC: (ROLLER, DRIVER),
        NO_FLIGHT: (ROLLER, DRIVER),
        NO_SIZES: (BEGIN, ROLLER, DRIVER),
        NO_FORCES: (OPEN_LOADS,),
        NO_RANKING: (OPEN_LOADS,),
        NOT_PINNED: (Suggestion("Pin this variant", "pin"),),
        NO_SERVO: (Suggestion("Add a servo", "designing.give_servo"),),
        ALONE: (TO_SHAFT,),
        ONE_DRIVE: (TO_SHAFT,),
        ONLY_LINKAGES: (Suggestion("New design...", "new"),),
    }
)
"""Why a view is empty -> what can be done about it; entries that the design at hand has not are left out."""

SUGGESTIONS_BY_START: Mapping[str, tuple[Suggestion, ...]] = MappingProxyType(
    {
        LED_BY_NO_CAM: (ROLLER, DRIVER),
        LACKS_SIZES: (Suggestion("Type what the cam lacks", "focus_field:cam"),),
        NOTHING_PRESSES: (OPEN_LOADS,),
        STRANGE: (Suggestion("Preferences...", "prefer"),),
    }
)
"""Likewise, of sentences that go on with what is missing."""


def suggestions_for(sentence: str) -> tuple[Suggestion, ...]:
    """What can be done about a reason."""
    begun = (ways for words, ways in SUGGESTIONS_BY_START.items() if sentence.startswith(words))
    return SUGGESTIONS.get(sentence) or next(begun, ())


class Unavailable(KindynaError):
    """The design has nothing that a view could show; the sentence names where to look instead."""


def lists_links(design: Design) -> bool:
    """Whether the links are listed one by one, with numbers: those of a follower follow from its lengths."""
    return bool(design.drive.links)


def require_links(design: Design, instead: str) -> None:
    """Raises Unavailable, with the sentence, where the links have no numbers."""
    if not lists_links(design):
        raise Unavailable(instead)


def require_centres(study: Study, instead: str) -> None:
    """Raises Unavailable, with the sentence, where there are neither links with numbers nor a cam."""
    if "cam" not in study.stages:
        require_links(study.design, instead)


def turned_shaft(study: Study, instead: str) -> Shaft:
    """The shaft of a design, which turns cams or cranks, carries a flywheel and may twist; raises Unavailable, with the sentence, where
    there is none."""
    if study.design.shaft is not None and study.camshaft.loading_drives:
        return study.design.shaft
    raise Unavailable(instead)


def require_list(design: Design, instead: str) -> None:
    """Raises Unavailable, with the sentence, where the design is of one drive that no list names."""
    if not design.listed:
        raise Unavailable(instead)


def require_motion(design: Design) -> Motion:
    """The motion; raises Unavailable, with a sentence, where a crank turns at speed."""
    motion = motion_of(design)
    if motion is None:
        raise Unavailable(NO_MOTION)
    return motion


def why_no_forces(study: Study) -> str:
    """Why there are no forces that could be drawn, in a sentence that says what to give; empty where there are."""
    if study.loading.is_empty:
        return NO_FORCES
    known = all(np.isfinite(force).all() for force in study.dynamics.pairs.values())
    return "" if known else "Forces are infinite where friction jams, and not drawn there."


def why_no_pressure(study: Study) -> str:
    """Why there is no contact pressure, in a sentence that says what to give; empty where there is one."""
    drive = study.design.drive
    if drive.cam is None:
        return f"{LED_BY_NO_CAM}there is no contact pressure."
    if not is_line_contact(drive.face):
        return f"A {drive.face.noun} touches in a line without width: it has no contact pressure."
    if lacking := missing_inputs(drive.face, drive.cam):
        return f"{LACKS_SIZES}{', and '.join(lacking.values())}, in the form of the cam."
    if study.loading.is_empty:
        return f"{NOTHING_PRESSES}, so nothing presses."
    if study.jam is not None:
        return "No contact pressure: friction jams, the forces are infinite."
    return (
        f"No contact pressure: the profile is undercut, the {drive.face.noun} does not fit it."
        if has_undercut(study)
        else ""
    )
