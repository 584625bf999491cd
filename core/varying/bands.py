"""Between which values machines lie at each angle of the turn: of a drive alone, and of the torque of several drives on their shaft."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from core.design import Design, drive_at, get, only, path_in
from core.errors import NoSolution
from core.frozen import frozen
from core.motion import degrees
from core.motion.program import ShaftPosition
from core.numerics.lazy import checkpoint
from core.shaft import Flywheel, combined_load
from core.study import Camshaft, Study
from core.study.batch import with_numbers
from core.study.limits import SPEEDS
from core.study.quantity_requests import TORQUE, quantity_request, request_columns
from core.varying.request import Goal, StudyFile, StudyLimit, StudyQuantity, VariedField, study_of
from core.varying.space import with_words
from core.varying.surveys import PART, SEED, can_be_varied, request_keys, typical_limit
from core.varying.tolerances import DRIVE_TORQUE, MACHINES, PERCENTILES, AllWaves, Scatter

# -- between which values machines lie at each angle of the turn ------------------------------------------------


MOTOR, SPEED = "motor_torque", "camshaft_speed"
FEW_MACHINES = 200  # of quantities that are computed of each by itself


def _alone(design: Design, drive: int) -> Design:
    """A drive of a design with its tolerances, by the paths in it alone (``only``), and the waves of its profile."""
    if not design.listed:
        return design
    inside = ((row, drive_at(row.field)) for row in design.tolerances)
    rows = [replace(row, field=own[1]) for row, own in inside if own is not None and own[0] == drive]
    rows += [row for row in design.tolerances if row.field in SPEEDS]
    return replace(only(design, drive), tolerances=tuple(rows), waviness=design.waviness)


def drive_bands(whole: Design, drive: int, slugs: Sequence[str], quick: bool) -> Mapping[str, np.ndarray]:
    """Of a drive of a design: column -> percentiles (5, 360) over its own cam angle, as far as it has that; quick: of those of which
    many machines are computed at once, else of the others, of which fewer are."""
    design = _alone(whole, drive)
    there = set(request_columns(design))
    rows = []
    for slug in slugs:
        with suppress(ValueError):
            if slug in there:
                rows.append((slug, quantity_request(design, f"{slug}:max")))
    if not rows or not (design.tolerances or design.waviness):
        return {}
    asked_for = tuple(StudyQuantity(slug, "max") for slug, _ in rows)
    scatter = Scatter(study_of(StudyFile(design="", quantities=asked_for), design))
    mine = [slug for slug, asked in rows if scatter.quick(asked) == quick]
    return scatter.bands(MACHINES if quick else FEW_MACHINES, SEED, only=mine) if mine else {}


def shaft_bands(design: Design, samples: int = 360, machines: int = FEW_MACHINES) -> Mapping[str, np.ndarray]:
    """Of several drives on a shaft: name of a drive, or empty of all together -> percentiles (5, samples) over the machine angle of the
    torque that it asks of the shaft at constant speed [N m]; none where nothing varies. Each cam has waves of its own; the balance
    cam has none, and is made as it was designed, by the nominal torque."""
    if not design.tolerances and design.waviness is None:
        return {}
    made = _drawn(design, machines)
    theta = np.deg2rad(degrees(samples))
    own = Study(design).camshaft.at_theta(theta)
    names = own.loading_drives
    found = np.full((len(names), machines, samples), np.nan)
    rows = {path: drive_at(path) for path in made}
    same = [
        not design.tolerances or not any(row is None or row[0] == own.drive_number(name) for row in rows.values())
        for name in names
    ]
    for k, shaft in enumerate(_shafts(design, made, theta)):
        for i, name in enumerate(names):
            with suppress(NoSolution):
                found[i, k] = found[i, 0] if same[i] and k else shaft.drive_torque(name)
    every = AllWaves(design)
    for i, number in enumerate(map(own.drive_number, names)):
        if number in every.each and every.each[number].changes(DRIVE_TORQUE):
            there = every.each[number].at(own.positions[names[i]].drive_angle(theta))
            found[i] += there.more(DRIVE_TORQUE, found[i], there.error(*every.drawn(number, machines, SEED)))
    balance: float | np.ndarray = 0.0
    with suppress(NoSolution):
        balance = own.balancer_torque if design.balancer is not None else 0.0
    torques = {**dict(zip(names, found, strict=True)), "": found.sum(axis=0) + balance}
    return _percentiles(torques)


def motor_bands(design: Design, samples: int = 360, machines: int = FEW_MACHINES) -> Mapping[str, np.ndarray]:
    """Of several drives behind a flywheel: name of a quantity -> percentiles (5, samples) over the machine angle of the motor's torque
    [N m] and of the true speed [rad/s], of machines whose motor does not stall; none without tolerances or flywheel. Waves of
    the profile are too short for it to feel them; the balance cam as in ``shaft_bands``."""
    own = Study(design).camshaft
    if not design.tolerances or not own.levels_torque:
        return {}
    theta = np.deg2rad(degrees(samples))
    balance = []
    with suppress(NoSolution):
        balance = [] if own.balancer is None else [(own.balancer.load_curve, own.balancer_position)]
    found = {name: np.full((machines, samples), np.nan) for name in (MOTOR, SPEED)}
    for k, shaft in enumerate(_shafts(design, _drawn(design, machines), theta)):
        with suppress(NoSolution):
            load = combined_load([(shaft.cams_load, ShaftPosition()), *balance])
            wheel = Flywheel(lambda _, shaft=shaft: shaft.cams_torque, load, shaft.design.camshaft)  # type: ignore[misc]
            angles = shaft.turn.angles(theta)
            found[MOTOR][k], found[SPEED][k] = wheel.motor_torque(angles), wheel.speed(angles)
    return _percentiles(found)


def _drawn(design: Design, machines: int) -> Mapping[str, np.ndarray]:
    """Field -> its numbers (machines,)."""
    asked = StudyFile(design="", quantities=(StudyQuantity(TORQUE, "max"),))
    return Scatter(study_of(asked, design)).machines(machines, SEED)


def _shafts(design: Design, made: Mapping[str, np.ndarray], theta: np.ndarray) -> Iterator[Camshaft[Study]]:
    """That of each machine at these machine angles (n,) [rad]."""
    for numbers in zip(*(row.tolist() for row in made.values()), strict=True):
        checkpoint()
        yield Study(with_numbers(design, list(made), numbers)).camshaft.at_theta(theta)


def _percentiles(found: Mapping[str, np.ndarray]) -> Mapping[str, np.ndarray]:
    """Of values (m, n) of m machines, as far as there are any."""
    levels = list(PERCENTILES.values())
    return {name: np.nanpercentile(row, levels, axis=0) for name, row in found.items() if not np.isnan(row).all()}


# -- studies that are ready for a design at hand ----------------------------------------------------------------


QUIET_LAWS = ("cycloidal", "modified-sine", "modified-trapezoid", "3-4-5", "4-5-6-7")
MOST_SETS = 128  # of laws
OF_CAM = ("cam.base_radius_mm", "cam.roller_radius_mm")
PLACE = ("cam.base_radius_mm", "follower.pivot_x_mm", "follower.offset_mm")
"""Lengths by which the size of a cam is traded for its pressure angle."""
Rows = Callable[[Design], Iterator[VariedField]]


@frozen
class ReadyStudy:
    """One study: its title; what of one drive it varies; quantities, of which the first that the design has is its goal, as column and
    what of it over the turn; limited: whether the pressure angle and the radii of the profile are."""

    title: str
    rows: Rows
    goals: tuple[tuple[str, str], ...]
    limited: bool = True


def _between(design: Design, paths: Sequence[str]) -> Iterator[VariedField]:
    """±20 % of these numbers, as far as the design has them and they are not 0."""
    for path in paths:
        value = get(design, path)
        if value:
            low, high = sorted(float(f"{value * (1.0 + side * PART):.6g}") for side in (-1.0, 1.0))
            yield VariedField(field=path, low=low, high=high)


def _place(design: Design) -> Iterator[VariedField]:
    there = set(can_be_varied(design))
    return _between(design, [path for path in PLACE if path in there])


def _lengths(design: Design) -> Iterator[VariedField]:
    return _between(
        design,
        [path for path in can_be_varied(design) if path.startswith(("follower.", "linkage.links")) or path in OF_CAM],
    )


def _laws(design: Design) -> Iterator[VariedField]:
    motion = design.drive.motion
    moving = [] if motion is None else [i for i, segment in enumerate(motion.segments) if segment.rise]
    some = next((n for n in range(len(QUIET_LAWS), 1, -1) if n ** len(moving) <= MOST_SETS), 0)
    for i in moving if some else ():
        path = f"motion.segments[{i}].law"
        words = valid_words(design, path, QUIET_LAWS[:some])
        if len(words) > 1:
            yield VariedField(field=path, choices=words)


def valid_words(design: Design, path: str, words: Sequence[str]) -> tuple[str, ...]:
    """Those of some words that make no fault at a path of the design."""
    return tuple(word for word in words if with_words(design, {path: word}) is not None)


READY: Mapping[str, ReadyStudy] = MappingProxyType(
    {
        "smallest-cam": ReadyStudy("Smallest cam", _place, (("radius_mm", "max"),)),
        "least-torque": ReadyStudy("Least peak torque", _lengths, (("drive_torque_nm", "abs"), ("driver_torque_nm", "abs"))),
        "least-pressure": ReadyStudy("Least contact pressure", _lengths, (("contact_pressure_mpa", "max"),)),
        "all-lengths": ReadyStudy("All lengths together: least contact force", _lengths, (("contact_force_n", "max"),)),
        "quietest-law": ReadyStudy("Quietest law for this follower", _laws,
            (("jerk_mm_s3", "abs"), ("jerk_deg_s3", "abs")), limited=False),
    }
)  # fmt: skip
"""Every study by its name, in the order in which they are offered."""


def ready_study(design: Design, name: str, drive: int = 0) -> StudyFile | None:
    """A study of one drive of a design; None where there is nothing in it to vary, or nothing that it could make small."""
    row, own = READY[name], only(design, drive)
    there = set(request_keys(own))
    goal = next((each for each in row.goals if each[0] in there), None)
    varied = list(row.rows(own)) if goal is not None else []
    if goal is None or not varied:
        return None
    limits = list(_limits(own)) if row.limited else []
    beside = [
        StudyQuantity(slug, of) for slug, of in (("drive_torque_nm", "abs"),) if slug in there and slug != goal[0]
    ]

    def at(path: str) -> str:
        return path_in(design, drive, path)

    return StudyFile(
        design="",
        seed=1,
        vary=tuple(
            VariedField(field=at(each.field), low=each.low, high=each.high, choices=each.choices) for each in varied
        ),
        quantities=tuple(StudyQuantity(at(each.quantity), each.of) for each in beside),
        limits=tuple(StudyLimit(at(each.quantity), each.of, each.min, each.max) for each in limits),
        goals=(Goal(at(goal[0]), goal[1]),),
    )


def _limits(design: Design) -> Iterator[StudyLimit]:
    """Pressure angle and least convex radius: the design's own, else the usual ones, half the roller's radius."""
    there, drive = set(request_keys(design)), design.drive
    if drive.cam is None:
        return
    angle = typical_limit(Study(design), "pressure_angle_deg") if "pressure_angle_deg" in there else None
    if angle is not None:
        yield StudyLimit("pressure_angle_deg", "max", max=angle)
    radius = drive.limits.convex_radius_mm or 0.5 * getattr(drive.face, "radius_mm", 0.0)
    if radius and "profile_curvature_per_mm" in there:
        yield StudyLimit("profile_curvature_per_mm", "max", max=1.0 / radius)
