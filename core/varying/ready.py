"""Ready studies: goal, varied fields and limits for a design."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType

from core.design import Design, get, only, path_in
from core.frozen import frozen
from core.study import Study
from core.varying.request import Goal, StudyFile, StudyLimit, StudyQuantity, VariedField
from core.varying.space import QUIET_LAWS, valid_words
from core.varying.surveys import PART, can_be_varied, request_keys, typical_limit
from core.varying.top_speed import TITLE, TOP_SPEED, has_top_speed, top_speed_study

MAX_COMBINATIONS = 128  # of laws
CAM_LENGTHS = ("cam.base_radius_mm", "cam.roller_radius_mm")
SIZE_LENGTHS = ("cam.base_radius_mm", "follower.pivot_x_mm", "follower.offset_mm")
"""Lengths on which size and pressure angle of a cam depend."""
Rows = Callable[[Design], Iterator[VariedField]]


@frozen
class ReadyStudy:
    """A study that can be offered for a design.

    Attributes
    ----------
    title : str
    rows : callable
        Varied fields of a design with one drive.
    goals : tuple of (column, statistic)
        The first that the design has is the goal.
    limited : bool
        Whether pressure angle and profile radii are limited.
    machine : callable or None
        Design -> study of the whole machine, in place of one of a drive.
    """

    title: str
    rows: Rows = lambda design: iter(())
    goals: tuple[tuple[str, str], ...] = ()
    limited: bool = True
    machine: Callable[[Design], StudyFile] | None = None


def _around(design: Design, paths: Sequence[str]) -> Iterator[VariedField]:
    """±20 % of these numbers, as far as the design has them and they are not 0."""
    for path in paths:
        value = get(design, path)
        if value:
            low, high = sorted(float(f"{value * (1.0 + side * PART):.6g}") for side in (-1.0, 1.0))
            yield VariedField(field=path, low=low, high=high)


def _size_lengths(design: Design) -> Iterator[VariedField]:
    variable = set(can_be_varied(design))
    return _around(design, [path for path in SIZE_LENGTHS if path in variable])


def _lengths(design: Design) -> Iterator[VariedField]:
    prefixes = ("follower.", "linkage.links")
    paths = [path for path in can_be_varied(design) if path.startswith(prefixes) or path in CAM_LENGTHS]
    return _around(design, paths)


def _laws(design: Design) -> Iterator[VariedField]:
    motion = design.drive.motion
    moving = [] if motion is None else [i for i, segment in enumerate(motion.segments) if segment.rise]
    count = next((n for n in range(len(QUIET_LAWS), 1, -1) if n ** len(moving) <= MAX_COMBINATIONS), 0)
    for i in moving if count else ():
        path = f"motion.segments[{i}].law"
        words = valid_words(design, path, QUIET_LAWS[:count])
        if len(words) > 1:
            yield VariedField(field=path, choices=words)


READY: Mapping[str, ReadyStudy] = MappingProxyType(
    {
        "smallest-cam": ReadyStudy("Smallest cam", _size_lengths, (("radius_mm", "max"),)),
        "least-torque": ReadyStudy("Least peak torque", _lengths, (("drive_torque_nm", "abs"), ("driver_torque_nm", "abs"))),
        "least-pressure": ReadyStudy("Least contact pressure", _lengths, (("contact_pressure_mpa", "max"),)),
        "all-lengths": ReadyStudy("All lengths together: least contact force", _lengths, (("contact_force_n", "max"),)),
        "quietest-law": ReadyStudy("Quietest law for this follower", _laws,
            (("jerk_mm_s3", "abs"), ("jerk_deg_s3", "abs")), limited=False),
        TOP_SPEED: ReadyStudy(f"{TITLE} of the machine", machine=top_speed_study),
    }
)  # fmt: skip
"""Name -> study, in the order of the menu."""


def ready_study(design: Design, name: str, drive: int = 0) -> StudyFile | None:
    """Ready study of one drive of a design, or of the machine; None where there is no field to vary, or no goal."""
    row, single = READY[name], only(design, drive)
    if row.machine is not None:
        return row.machine(design) if has_top_speed(design) else None
    columns = set(request_keys(single))
    goal = next((goal for goal in row.goals if goal[0] in columns), None)
    varied = list(row.rows(single)) if goal is not None else []
    if goal is None or not varied:
        return None
    limits = list(_limits(single)) if row.limited else []
    torque = "drive_torque_nm"
    quantities = [StudyQuantity(torque, "abs")] if torque in columns and torque != goal[0] else []

    def at(path: str) -> str:
        return path_in(design, drive, path)

    return StudyFile(
        design="",
        seed=1,
        vary=tuple(VariedField(field=at(row.field), low=row.low, high=row.high, choices=row.choices) for row in varied),
        quantities=tuple(StudyQuantity(at(row.quantity), row.of) for row in quantities),
        limits=tuple(StudyLimit(at(row.quantity), row.of, row.min, row.max) for row in limits),
        goals=(Goal(at(goal[0]), goal[1]),),
    )


def _limits(design: Design) -> Iterator[StudyLimit]:
    """Limits of pressure angle and convex radius: those of the design, else the typical ones."""
    columns, drive = set(request_keys(design)), design.drive
    if not drive.has_disk:
        return
    angle = typical_limit(Study(design), "pressure_angle_deg") if "pressure_angle_deg" in columns else None
    if angle is not None:
        yield StudyLimit("pressure_angle_deg", "max", max=angle)
    radius = drive.limits.convex_radius_mm or 0.5 * getattr(drive.face, "radius_mm", 0.0)
    if radius and "profile_curvature_per_mm" in columns:
        yield StudyLimit("profile_curvature_per_mm", "max", max=1.0 / radius)
