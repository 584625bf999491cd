"""What a view needs of a design: a motion, a shaft, links that are listed one by one, what a contact pressure
takes. Where it is missing, there is a sentence for the user; NotHere carries it."""

from __future__ import annotations

import numpy as np

from core.design import Design, Motion, Shaft, motion_of
from core.errors import KindynaError
from core.stress import has_width, missing
from core.study import Study
from core.study.contact_stress import fits

NO_MOTION = "The crank turns at constant speed: there is no motion to lay out. Compo > Driver lets a link follow one."
NO_CAM = "This design has no cam"
NO_SHAFT = "Stability is studied for the shaft of a cam or a crank; this linkage has none: Stability > Give it a shaft."
NO_WHEEL = (
    "A flywheel is sized for a shaft that a cam or a crank turns with; this linkage has none: Dyna > Give it a shaft."
)


class NotHere(KindynaError):
    """The design has nothing that a view could show; the sentence names where to look instead."""


def lists_links(design: Design) -> bool:
    """Whether the links are listed one by one, with numbers: those of a follower follow from its lengths."""
    return bool(design.drive.links)


def require_links(design: Design, instead: str) -> None:
    """Raises NotHere, with the sentence, where the links have no numbers."""
    if not lists_links(design):
        raise NotHere(instead)


def require_centres(study: Study, instead: str) -> None:
    """Raises NotHere, with the sentence, where there are neither links with numbers nor a cam."""
    if "cam" not in study.stages:
        require_links(study.design, instead)


def turned_shaft(study: Study, instead: str) -> Shaft:
    """The shaft of a design, which turns cams or cranks, carries a flywheel and may twist; raises NotHere, with the sentence, where
    there is none."""
    if study.design.shaft is not None and study.camshaft.carried:
        return study.design.shaft
    raise NotHere(instead)


def require_list(design: Design, instead: str) -> None:
    """Raises NotHere, with the sentence, where the design is of one drive that no list names."""
    if not design.listed:
        raise NotHere(instead)


def require_motion(design: Design) -> Motion:
    """The motion; raises NotHere, with a sentence, where a crank turns at speed."""
    motion = motion_of(design)
    if motion is None:
        raise NotHere(NO_MOTION)
    return motion


def why_no_forces(study: Study) -> str:
    """Why there are no forces that could be drawn, in a sentence that says what to give; empty where there are."""
    if study.loading.empty:
        return "No forces: no masses and no forces are given. Dyna > Add to the loads gives some."
    known = all(np.isfinite(force).all() for force in study.dynamics.pairs.values())
    return "" if known else "Forces are infinite where friction jams, and not drawn there."


def why_no_pressure(study: Study) -> str:
    """Why there is no contact pressure, in a sentence that says what to give; empty where there is one."""
    drive = study.design.drive
    if drive.cam is None:
        return "No cam makes this linkage move: there is no contact pressure."
    if not has_width(drive.face):
        return f"A {drive.face.noun} touches in a line without width: it has no contact pressure."
    if lacking := missing(drive.face, drive.cam):
        return f"Contact pressure: give {', and '.join(lacking.values())}, in the form of the cam."
    if study.loading.empty:
        return "Contact pressure: no masses and no forces are given, so nothing presses."
    if study.jam is not None:
        return "No contact pressure: friction jams, the forces are infinite."
    return (
        "" if fits(study) else f"No contact pressure: the profile is undercut, the {drive.face.noun} does not fit it."
    )
