"""Design of an answer in place of a present one: driven by a crank, or under the motion of the present design.

Under the motion the driver covers its range over the task: at the lowest position of the motion the task begins, at the highest one it
ends. A motion with an advance turns the driver fully, once per advance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from math import degrees

import numpy as np

from core.design import (
    CRANK,
    ELEMENT_LISTS,
    MOTION,
    Design,
    Drive,
    Linkage,
    LinkageLoads,
    Motion,
    NamedCurve,
    Segment,
    all_paths,
    faults,
    with_drive,
)
from core.design.edits import with_levels
from core.design.limits import NO_LIMITS
from core.design.motion_edits import require_motion
from core.design.paths import followed, row_at
from core.errors import MISSING, DesignError, Fault
from core.frozen import frozen
from core.laws import find_law
from core.mechanism.drawing_references import pruned
from core.mechanism.driver_ranges import TURN
from core.mechanism.drivers import LAW, SPANS
from core.motion import program
from core.motion.tables import lobe_to_segments, tabled
from core.synthesis.candidates import is_in_order, shortest_arc, with_bar_masses
from core.synthesis.judge import Answer, task_positions
from core.synthesis.task import PATH, ROCKER, Task

ROW_LISTS = ("masses", "forces", *ELEMENT_LISTS)
"""Lists of the loads of a linkage."""
GRAVITY = ("gravity_m_s2", "gravity_angle_deg")
OF_MECHANISM = ("tolerances", "waviness", "engine", "outlines", "clearances")
"""Parts of a design that belong to its mechanism."""


@frozen(eq=False)
class Takeover:
    """Design of an answer.

    Attributes
    ----------
    design : Design
    left_out : tuple of str
        Paths of the parts of the present design that do not fit the linkage: loads, cam, servo, outlines.
    """

    design: Design
    left_out: tuple[str, ...] = ()


def taken_over(answer: Answer, present: Design) -> Takeover:
    """The linkage at the speed of a present design of one drive, with its shaft, and its loads where they fit.

    A driver that turns fully is a crank at constant speed; any other one follows a motion from the task's first position to its last one
    and back, which is assumed. Where the loads contain no masses, the links are steel bars, assumed too.
    """
    design = answer.candidate.design
    motion = None if answer.turns_fully else _assumed_motion(answer)
    drive = _driven(Drive(None, design.drive.linkage, None, _linkage_loads(present)), motion)
    takeover = _fitted(drive, design.name, present)
    if motion is None:
        return takeover
    marks = [path for path in all_paths(takeover.design) if path.startswith("motion.") and "advance" not in path]
    return replace(takeover, design=replace(takeover.design, assumed=(*marks, *takeover.design.assumed)))


def under_motion(answer: Answer, task: Task, present: Design) -> Takeover:
    """The linkage driven by the motion of a present design of one drive, whose loads are kept where they fit.

    Spans and laws of the motion stay, its levels are scaled to the driver's range over the task. Laws that only rise, or only return, are
    tables where the driver turns clockwise.

    Raises
    ------
    DesignError
        The present design has no motion, its motion does not move, or it cannot drive the linkage through the task.
    """
    motion = present.drive.motion
    if motion is None:
        raise DesignError([Fault("motion", MISSING, "the present design has no motion", "a design with a motion")])
    if motion.lobe is not None:
        motion = require_motion(lobe_to_segments(present))
    drive = present.drive
    driven = replace(
        drive,
        mechanism=answer.candidate.linkage,
        cam=drive.cam if drive.links else None,
        loads=_linkage_loads(present),
        servo=drive.servo if motion.unit == "deg" else None,
        valve=None,
    )
    driven = _driven(driven, _of_driver(replace(motion.typed, follows=None), answer, task))
    return _fitted(driven, present.name, present)


# -- motion of the driver -------------------------------------------------------------------------------------


def driver_path(answer: Answer) -> np.ndarray:
    """Angles of the driver at the positions of the task, from the first one on, without jumps.

    A driver that turns fully passes the positions in their order where there is one, else in the shortest arc.

    Returns
    -------
    ndarray (n,) [rad]
        NaN for positions outside of the driver's range.
    """
    at = task_positions(answer)
    if not answer.turns_fully:
        return at
    first = at[0]
    if at.size > 2 and is_in_order(at):
        onwards = np.mod(at - first, TURN)
        sign = 1.0 if (np.diff(onwards) >= 0.0).all() else -1.0
        return first + sign * np.mod(sign * (at - first), TURN)
    low, _ = shortest_arc(at)
    at = low + np.mod(at - low, TURN)
    return np.asarray(at + first - at[0])


def _of_driver(motion: Motion, answer: Answer, task: Task) -> Motion:
    """The motion in degrees of the driver."""
    at = driver_path(answer)
    if not np.isfinite(at).all():
        problem = "the driver of this linkage cannot pass all positions of the task in one range"
        raise DesignError([Fault("linkage", MISSING, problem, "a linkage without a defect")])
    home, far = _ends_of_driver(at)
    if motion.gain:
        if not answer.turns_fully:
            problem, allowed = (
                "the driver of this linkage cannot turn fully",
                "a motion that returns, or another linkage",
            )
            raise DesignError([Fault("motion.advance", motion.gain, problem, allowed)])
        far = home + float(np.copysign(TURN, far - home))
        return _scaled(motion, (motion.first, motion.first + abs(motion.gain)), (home, far), answer)
    if _needs_turn(task):
        problem = "returns, and this task needs full turns of the driver"
        raise DesignError([Fault("motion", MISSING, problem, "a motion with an advance, or a crank at constant speed")])
    low, high = (y / motion.scale for y in program(motion).position_range)
    if low == high:
        raise DesignError([Fault("motion", MISSING, "does not move", "a segment with a rise")])
    return _scaled(motion, (low, high), (home, far), answer)


def _assumed_motion(answer: Answer) -> Motion | None:
    """Dwell, rise, dwell, return of the driver over the positions of the task that are in its range; None where this is one position."""
    at = driver_path(answer)
    home, far = _ends_of_driver(at[np.isfinite(at)])
    if home == far:
        return None
    curves = (("dwell", 0.0), (LAW, 1.0), ("dwell", 0.0), (LAW, -1.0))
    rows = zip(SPANS, curves, strict=True)
    motion = Motion(0.0, tuple(Segment(span, rise, NamedCurve(law)) for span, (law, rise) in rows), "deg")
    return _scaled(motion, (0.0, 1.0), (home, far), answer)


def _driven(drive: Drive, motion: Motion | None) -> Drive:
    """The drive with a motion of its driver; without one, with a crank."""
    driver = replace(drive.linkage.driver, kind=CRANK if motion is None else MOTION)
    return replace(drive, motion=motion, mechanism=replace(drive.linkage, driver=driver))


def _ends_of_driver(at: np.ndarray) -> tuple[float, float]:
    """Ends [rad] of the driver's range over positions (n,) [rad], first the one next to the first position."""
    low, high = float(at.min()), float(at.max())
    return (low, high) if at[0] - low <= high - at[0] else (high, low)


def _scaled(motion: Motion, levels: tuple[float, float], ends: tuple[float, float], answer: Answer) -> Motion:
    """The motion in degrees, with its levels [mm or deg] at the ends of the driver's range [rad]."""
    factor = degrees(ends[1] - ends[0]) / (levels[1] - levels[0])
    if factor < 0.0:
        motion = _with_reversible_laws(motion)
    scaled = with_levels(motion, lambda value: value * factor + 0.0)  # no minus zero
    start = _near_drawing(degrees(ends[0]), answer.candidate.linkage) + factor * (motion.start - levels[0])
    return replace(scaled, start=start, unit="deg")


def _with_reversible_laws(motion: Motion) -> Motion:
    """The motion with laws that only rise, or only return, as tables, which can do both."""
    compiled = program(motion)
    segments = list(motion.segments)
    for i, segment in enumerate(segments):
        law = find_law(segment.curve.law)
        if law is not None and law.rises:
            segments[i] = replace(segment, curve=tabled(compiled, i, segment).curve)
    return replace(motion, segments=tuple(segments))


def _needs_turn(task: Task) -> bool:
    return task.kind == ROCKER or (task.kind == PATH and task.path is not None and task.path.closed)


def _near_drawing(angle: float, linkage: Linkage) -> float:
    """An angle of the driver [deg] with the turns that bring it next to that of the drawing."""
    drawn = None if linkage.drawn is None else linkage.drawn.driver_deg
    return angle if drawn is None else angle + 360.0 * round((drawn - angle) / 360.0)


# -- loads ------------------------------------------------------------------------------------------------------


def _linkage_loads(present: Design) -> LinkageLoads:
    """Loads of a present linkage; of a follower, whose bodies are others, its gravity."""
    loads: LinkageLoads = present.drive.loads
    if present.drive.links:
        return loads
    return LinkageLoads(**{name: getattr(loads, name) for name in GRAVITY if hasattr(loads, name)})


def _fitted(drive: Drive, name: str, present: Design) -> Takeover:
    """Design of a drive with the loads of a present design that fit it, and the parts that do not."""
    linkage = replace(drive.linkage, driver=replace(drive.linkage.driver, speed_rpm=present.sense * present.speed_rpm))
    marks = tuple(mark for mark in present.assumed if mark.startswith(("shaft.", "loads.")) or _is_of_spans(mark))
    design = pruned(Design(name, present.shaft, (replace(drive, mechanism=linkage),), marks))
    if design.drive.cam is None:
        loads = replace(design.drive.loads, contact=None, follower_stiffness_n_per_mm=None, follower_damping_ratio=None)
        design = with_drive(design, loads=loads, limits=NO_LIMITS)
    while rows := {row[:2] for fault in faults(design) if (row := row_at(fault.path))[0].startswith("loads.")}:
        design = _without_rows(design, rows)
    if not design.drive.loads.masses:
        design = with_bar_masses(design)
    if wrong := faults(design):
        raise DesignError(wrong)
    return Takeover(design, tuple(_left_out(present, design)))


def _is_of_spans(mark: str) -> bool:
    """Whether a path belongs to the spans and laws of a motion, which stay as they are."""
    return mark.startswith("motion.segments") and mark.endswith(("span_deg", "law"))


def _without_rows(design: Design, rows: set[tuple[str, int]]) -> Design:
    """Design without some rows of loads, given by path and number, and without their marks."""
    for path in {path for path, _ in rows}:
        name = path.removeprefix("loads.")
        old = getattr(design.drive.loads, name)
        order = [i for i in range(len(old)) if (path, i) not in rows]
        loads = replace(design.drive.loads, **{name: tuple(old[i] for i in order)})
        marks = followed(design.assumed, path, order)
        design = replace(with_drive(design, loads=loads), assumed=marks)
    return design


def _left_out(present: Design, design: Design) -> Iterator[str]:
    """Paths of the parts of a present design that another one does not have."""
    before, after = present.drive.loads, design.drive.loads
    for part in fields(before):
        value = getattr(before, part.name)
        if part.name in ROW_LISTS:
            kept = getattr(after, part.name)
            yield from (f"loads.{part.name}[{i}]" for i, row in enumerate(value) if row not in kept)
        elif value != part.default and value and not (part.name in GRAVITY or getattr(after, part.name, None) == value):
            yield f"loads.{part.name}"
    for name in ("cam", "servo", "valve"):
        if getattr(present.drive, name) is not None and getattr(design.drive, name) is None:
            yield name
    if present.drive.limits != NO_LIMITS and design.drive.limits == NO_LIMITS:
        yield "limits"
    yield from (name for name in OF_MECHANISM if getattr(present, name))
