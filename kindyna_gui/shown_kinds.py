"""What the kinds of design differ in for the window, said once: where the motion stands, which has a cam."""

from __future__ import annotations

from core.design import Design, Motion, motion_of
from core.errors import KindynaError
from core.study import Study

NO_MOTION = (
    "The crank turns at constant speed: there is no motion to lay out. Compo > Driver lets a link follow one."
)


NO_SHAFT = "Stability is studied for the shaft of a cam; a linkage has none here."


class NotHere(KindynaError):
    """This kind of design has nothing that a view could show; the sentence says where to look instead."""


def is_linkage(design: Design) -> bool:
    """A general linkage, with or without a cam that makes it move."""
    return design.drive.is_linkage


def only_cams(design: Design, instead: str) -> Design:
    """The design of a cam and its follower; raises NotHere, with the sentence, for any other kind."""
    if not design.drive.is_linkage:
        return design
    raise NotHere(instead)


def motion_shown(design: Design) -> Motion:
    """The motion program; raises NotHere, with a sentence, where a crank turns at speed."""
    motion = motion_of(design)
    if motion is None:
        raise NotHere(NO_MOTION)
    return motion


def has_cam(study: Study) -> bool:
    """Whether a cam belongs to the design."""
    return not is_linkage(study.design) or "cam" in study.stages


def sense_of(study: Study) -> float:
    """+1 where the cam, or the crank, turns counter-clockwise, -1 clockwise."""
    sense: float = study.sense if is_linkage(study.design) else study.design.shaft.sense
    return sense


def size_of(study: Study) -> float:
    """A length that tells the size of the mechanism [m]."""
    size: float = study.course.plan.size if is_linkage(study.design) else study.reach
    return size


def ranges_of(study: Study) -> tuple[tuple[float, float], ...]:
    """Where the angle of all views can go [rad]: the whole turn, or the ranges between a crank's dead centres.

    Raises NoAnswer where the linkage stands nowhere.
    """
    if not is_linkage(study.design) or not study.by_crank:
        return ()
    ranges = study.course.ranges
    return () if len(ranges) == 1 and ranges[0].free else tuple((r.low, r.high) for r in ranges)
