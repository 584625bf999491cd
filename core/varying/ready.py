"""Studies that are ready for a design at hand: what each varies, within which limits, and what it makes as small as can be."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType

from core.design import Design, get, only, path_in
from core.frozen import frozen
from core.study.study import Study
from core.varying.request import AskedFor, Bounded, Goal, StudyFile, Vary
from core.varying.space import with_words
from core.varying.surveys import PART, askable, can_be_varied, usual_limit

QUIET_LAWS = ("cycloidal", "modified-sine", "modified-trapezoid", "3-4-5", "4-5-6-7")
MOST_SETS = 128  # of laws
OF_CAM = ("cam.base_radius_mm", "cam.roller_radius_mm")
PLACE = ("cam.base_radius_mm", "follower.pivot_x_mm", "follower.offset_mm")
"""Lengths by which the size of a cam is traded for its pressure angle."""
Rows = Callable[[Design], Iterator[Vary]]


@frozen
class Ready:
    """One study: its title; what of one drive it varies; quantities, of which the first that the design has is its goal, as column and
    what of it over the turn; limited: whether the pressure angle and the radii of the profile are."""

    title: str
    rows: Rows
    goals: tuple[tuple[str, str], ...]
    limited: bool = True


def _between(design: Design, paths: Sequence[str]) -> Iterator[Vary]:
    """±20 % of these numbers, as far as the design has them and they are not 0."""
    for path in paths:
        value = get(design, path)
        if value:
            low, high = sorted(float(f"{value * (1.0 + side * PART):.6g}") for side in (-1.0, 1.0))
            yield Vary(field=path, low=low, high=high)


def _place(design: Design) -> Iterator[Vary]:
    there = set(can_be_varied(design))
    return _between(design, [path for path in PLACE if path in there])


def _lengths(design: Design) -> Iterator[Vary]:
    return _between(
        design,
        [path for path in can_be_varied(design) if path.startswith(("follower.", "linkage.links")) or path in OF_CAM],
    )


def _laws(design: Design) -> Iterator[Vary]:
    motion = design.drive.motion
    moving = [] if motion is None else [i for i, segment in enumerate(motion.segments) if segment.rise]
    some = next((n for n in range(len(QUIET_LAWS), 1, -1) if n ** len(moving) <= MOST_SETS), 0)
    for i in moving if some else ():
        path = f"motion.segments[{i}].law"
        words = words_that_go(design, path, QUIET_LAWS[:some])
        if len(words) > 1:
            yield Vary(field=path, choices=words)


def words_that_go(design: Design, path: str, words: Sequence[str]) -> tuple[str, ...]:
    """Those of some words that make no fault at a path of the design."""
    return tuple(word for word in words if with_words(design, {path: word}) is not None)


READY: Mapping[str, Ready] = MappingProxyType(
    {
        "smallest-cam": Ready("Smallest cam", _place, (("radius_mm", "max"),)),
        "least-torque": Ready("Least peak torque", _lengths, (("drive_torque_nm", "abs"), ("driver_torque_nm", "abs"))),
        "least-pressure": Ready("Least contact pressure", _lengths, (("contact_pressure_mpa", "max"),)),
        "all-lengths": Ready("All lengths together: least contact force", _lengths, (("contact_force_n", "max"),)),
        "quietest-law": Ready("Quietest law for this follower", _laws,
            (("jerk_mm_s3", "abs"), ("jerk_deg_s3", "abs")), limited=False),
    }
)  # fmt: skip
"""Every study by its name, in the order in which they are offered."""


def ready_study(design: Design, name: str, drive: int = 0) -> StudyFile | None:
    """A study of one drive of a design; None where there is nothing in it to vary, or nothing that it could make small."""
    row, own = READY[name], only(design, drive)
    there = set(askable(own))
    goal = next((each for each in row.goals if each[0] in there), None)
    varied = list(row.rows(own)) if goal is not None else []
    if goal is None or not varied:
        return None
    limits = list(_limits(own)) if row.limited else []
    beside = [AskedFor(slug, of) for slug, of in (("drive_torque_nm", "abs"),) if slug in there and slug != goal[0]]

    def at(path: str) -> str:
        return path_in(design, drive, path)

    return StudyFile(
        design="",
        seed=1,
        vary=tuple(Vary(field=at(each.field), low=each.low, high=each.high, choices=each.choices) for each in varied),
        quantities=tuple(AskedFor(at(each.quantity), each.of) for each in beside),
        limits=tuple(Bounded(at(each.quantity), each.of, each.min, each.max) for each in limits),
        goals=(Goal(at(goal[0]), goal[1]),),
    )


def _limits(design: Design) -> Iterator[Bounded]:
    """Pressure angle and least convex radius: the design's own, else the usual ones, half the roller's radius."""
    there, drive = set(askable(design)), design.drive
    if drive.cam is None:
        return
    angle = usual_limit(Study(design), "pressure_angle_deg") if "pressure_angle_deg" in there else None
    if angle is not None:
        yield Bounded("pressure_angle_deg", "max", max=angle)
    radius = drive.limits.convex_radius_mm or 0.5 * getattr(drive.face, "radius_mm", 0.0)
    if radius and "profile_curvature_per_mm" in there:
        yield Bounded("profile_curvature_per_mm", "max", max=1.0 / radius)
