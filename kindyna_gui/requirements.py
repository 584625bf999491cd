"""What a view requires of a design, why an empty view has nothing to show, and what the user can do about it.

A view requires a motion, a shaft, links with numbers, or the sizes of a contact. Where these are missing, Unavailable has a
sentence for the user, and ``suggestions_for`` the buttons below it.
"""

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

NO_MOTION = "The crank turns at constant speed: there is no motion to edit. Drive a link by a motion."
NO_CAM = "This design has no cam"
NO_DISK = "This is for disk cams; a cam in space is written by File > Export > Solid and surfaces, and the tables"
NO_SHAFT = "Stability needs the shaft of a cam or a crank; this design has none."
NO_WHEEL = "A flywheel needs the shaft of a cam or a crank; this design has none."
RIGID_SHAFT = "The camshaft is rigid: it has no wind-up, and nothing can become unstable."
RIGID_FOLLOWER = "The follower is rigid and does not vibrate. Give it a stiffness and a damping ratio."
RIGID_IN_SPACE = "The output of a cam in space is computed as rigid: it does not vibrate."
NO_ELASTIC = "An elastic follower is driven by a cam; this design has none."
NO_FLIGHT = "Only a follower on a cam can lift off; this design has no cam."
LINKAGE_WITHOUT_CAM = "This linkage has no cam: "
MISSING_SIZES, NO_CONTACT_FORCE = "Contact pressure: give ", "Contact pressure: no masses and no forces are given"
NO_SIZES = "Find calculates a cam and its follower within limits; this design has no cam."
NO_FORCES = "No forces: no masses and no forces are given."
NO_RANKING = "No quantity to rank by: torque and forces need a cam and loads."
NOT_PINNED = "Nothing is pinned. Pin the current design, then change it: this table shows what the change does."
NO_VALVE = "No drive of this design moves a valve. A new valve train begins with inlet and exhaust."
NOT_IN_SPACE = "This design has no cam in space. A motion alone can have one, as a barrel cam or a globoidal cam."
NO_VALVE_SPRINGS = "This drive has no valve spring. Add one to its loads, by wire, coils and lengths."
NO_SERVO = "No servo drives this motion. Add one to compare it with the cam."
ONE_DRIVE_TORQUE = "One drive only: see the Torque plot. With several drives this shows their total."
ONE_DRIVE = "One drive only. It can be the first of several on one shaft."
ONLY_LINKAGES = "Only the links of a linkage can be drawn; the links of this follower are given by its lengths."
UNKNOWN_PREFERENCES = "Preferences not understood: "


@frozen
class Suggestion:
    """A button in an empty view: its text, and the key of the menu entry that it calls."""

    text: str
    entry: str


DRIVER, ROLLER = Suggestion("Drive a link by a motion...", "drivers"), Suggestion("Add a cam...", "rollers")
BEGIN = Suggestion("Begin with a cam...", "designing.new_by_picture")
SHAFT, OPEN_LOADS = (
    Suggestion("Add a shaft", "designing.give_shaft"),
    Suggestion("Type masses and forces", "focus_field:loads"),
)
NEW = Suggestion("New design...", "new")
TO_SHAFT = Suggestion("Add a drive...", "add_to_shaft")

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
        NO_VALVE_SPRINGS: (OPEN_LOADS,),
        NOT_PINNED: (Suggestion("Pin this variant", "pin"),),
        NO_SERVO: (Suggestion("Add a servo", "designing.give_servo"),),
        ONE_DRIVE_TORQUE: (TO_SHAFT,),
        ONE_DRIVE: (TO_SHAFT,),
        ONLY_LINKAGES: (NEW,),
        NO_VALVE: (NEW,),
        NOT_IN_SPACE: (NEW,),
    }
)
"""Why a view is empty -> what the user can do; entries that the current design has not are left out."""

SUGGESTIONS_BY_START: Mapping[str, tuple[Suggestion, ...]] = MappingProxyType(
    {
        LINKAGE_WITHOUT_CAM: (ROLLER, DRIVER),
        MISSING_SIZES: (Suggestion("Give the missing sizes", "focus_field:cam"),),
        NO_CONTACT_FORCE: (OPEN_LOADS,),
        UNKNOWN_PREFERENCES: (Suggestion("Preferences...", "prefer"),),
    }
)
"""Start of a sentence about what is missing -> what the user can do."""


def suggestions_for(sentence: str) -> tuple[Suggestion, ...]:
    """Return what the user can do about a reason."""
    matches = (rows for start, rows in SUGGESTIONS_BY_START.items() if sentence.startswith(start))
    return SUGGESTIONS.get(sentence) or next(matches, ())


def why_no_disk(design: Design) -> str:
    """Return why the design has no disk cam; empty where it has one."""
    drive = design.drive
    return "" if drive.has_disk else NO_DISK if drive.has_surface else NO_CAM


class Unavailable(KindynaError):
    """The design has nothing that a view could show; the sentence says why, or what to do."""


def lists_links(design: Design) -> bool:
    """Whether the design lists links with numbers, as a linkage does; links of a follower are given by its lengths."""
    return bool(design.drive.links)


def require_links(design: Design, reason: str) -> None:
    """Raise Unavailable with the sentence where the links have no numbers."""
    if not lists_links(design):
        raise Unavailable(reason)


def require_centres(study: Study, reason: str) -> None:
    """Raise Unavailable with the sentence where there are neither links with numbers nor a cam."""
    if not study.has_disk:
        require_links(study.design, reason)


def turned_shaft(study: Study, reason: str) -> Shaft:
    """Return the shaft of cams or cranks; raises Unavailable with the sentence where there is none."""
    if study.design.shaft is not None and study.camshaft.loading_drives:
        return study.design.shaft
    raise Unavailable(reason)


def require_list(design: Design, reason: str) -> None:
    """Raise Unavailable with the sentence where the design is not a list of drives."""
    if not design.listed:
        raise Unavailable(reason)


def require_motion(design: Design) -> Motion:
    """Return the motion; raises Unavailable where a crank turns at constant speed."""
    motion = motion_of(design)
    if motion is None:
        raise Unavailable(NO_MOTION)
    return motion


def why_no_forces(study: Study) -> str:
    """Return why no forces can be drawn, in a sentence that says what to give; empty where they can."""
    if study.loading.is_empty:
        return NO_FORCES
    known = all(np.isfinite(force).all() for force in study.dynamics.pairs.values())
    return "" if known else "Forces are infinite where friction jams, and not drawn there."


def why_no_pressure(study: Study) -> str:
    """Return why there is no contact pressure, in a sentence that says what to give; empty where there is one."""
    drive = study.design.drive
    if not drive.has_disk:
        return f"{LINKAGE_WITHOUT_CAM}there is no contact pressure."
    if not is_line_contact(drive.face):
        return f"A {drive.face.noun} touches in a line without width: it has no contact pressure."
    if lacking := missing_inputs(drive.face, drive.cam):
        return f"{MISSING_SIZES}{', and '.join(lacking.values())}, in the form of the cam."
    if study.loading.is_empty:
        return f"{NO_CONTACT_FORCE}, so there is no contact force."
    if study.jam is not None:
        return "No contact pressure: friction jams, the forces are infinite."
    return (
        f"No contact pressure: the profile is undercut, the {drive.face.noun} does not fit it."
        if has_undercut(study)
        else ""
    )
