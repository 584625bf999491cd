"""What the kinds of design differ in for the window, said once: where the motion stands, which has a cam."""

from __future__ import annotations

from core.design import Design, Motion, motion_of
from core.errors import KindynaError
from core.study import Study

NO_MOTION = (
    "The crank turns at constant speed: there is no motion to lay out. Compo > Driver lets a link follow one."
)


NO_SHAFT = "Stability is studied for the shaft of a cam; this linkage has none: Stability > Give it a shaft."
NO_WHEEL = "A flywheel is sized for a shaft that a cam or a crank turns with; this linkage has none: Dyna > Give it a shaft."


class NotHere(KindynaError):
    """This kind of design has nothing that a view could show; the sentence says where to look instead."""


def is_linkage(design: Design) -> bool:
    """A general linkage, with or without a cam that makes it move."""
    return design.drive.is_linkage


def with_shaft(design: Design, instead: str) -> Design:
    """The design, whose shaft carries a flywheel and may twist; raises NotHere, with the sentence, where it has none."""
    if design.shaft is not None and (design.drive.cam is not None or design.by_crank):
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
    return "cam" in study.stages


def sense_of(study: Study) -> float:
    """+1 where the cam, or the crank, turns counter-clockwise, -1 clockwise."""
    return study.sense


def size_of(study: Study) -> float:
    """A length that tells the size of the mechanism [m]."""
    size: float = study.course.plan.size if study.mechanism.ranged else study.reach
    return size


def ranges_of(study: Study) -> tuple[tuple[float, float], ...]:
    """Where the angle of all views can go [rad]: the whole turn, or the ranges between a crank's dead centres.

    Raises NoAnswer where the linkage stands nowhere.
    """
    if not study.by_crank:
        return ()
    ranges = study.course.ranges
    return () if len(ranges) == 1 and ranges[0].free else tuple((r.low, r.high) for r in ranges)
