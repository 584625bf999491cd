"""Between which values machines lie at each angle of the turn: of a drive alone, and of the torque of several drives on their shaft."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from core.design import Design, drive_at, only
from core.errors import NoAnswer
from core.motion import degrees
from core.motion.turn import ShaftPosition
from core.numerics.cancellation import checkpoint
from core.shaft import Flywheel, combined
from core.study import Camshaft, Study
from core.study.batches.asked import TORQUE, asked_of, columns_of
from core.study.batches.batch import with_numbers
from core.study.limits import SPEEDS
from core.varying.request import AskedFor, StudyFile, study_of
from core.varying.surveys import SEED
from core.varying.tolerances import MACHINES, PERCENTILES, Scatter
from core.varying.waves import DRIVE_TORQUE, AllWaves

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
    there = set(columns_of(design))
    rows = []
    for slug in slugs:
        with suppress(ValueError):
            if slug in there:
                rows.append((slug, asked_of(design, f"{slug}:max")))
    if not rows or not (design.tolerances or design.waviness):
        return {}
    asked_for = tuple(AskedFor(slug, "max") for slug, _ in rows)
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
    names = own.carried
    found = np.full((len(names), machines, samples), np.nan)
    rows = {path: drive_at(path) for path in made}
    same = [
        not design.tolerances or not any(row is None or row[0] == own.number(name) for row in rows.values())
        for name in names
    ]
    for k, shaft in enumerate(_shafts(design, made, theta)):
        for i, name in enumerate(names):
            with suppress(NoAnswer):
                found[i, k] = found[i, 0] if same[i] and k else shaft.drive_torque(name)
    every = AllWaves(design)
    for i, number in enumerate(map(own.number, names)):
        if number in every.each and every.each[number].changes(DRIVE_TORQUE):
            there = every.each[number].at(own.places[names[i]].own(theta))
            found[i] += there.more(DRIVE_TORQUE, found[i], there.error(*every.drawn(number, machines, SEED)))
    balance: float | np.ndarray = 0.0
    with suppress(NoAnswer):
        balance = own.balancer_torque if design.balancer is not None else 0.0
    torques = {**dict(zip(names, found, strict=True)), "": found.sum(axis=0) + balance}
    return _percentiles(torques)


def motor_bands(design: Design, samples: int = 360, machines: int = FEW_MACHINES) -> Mapping[str, np.ndarray]:
    """Of several drives behind a flywheel: name of a quantity -> percentiles (5, samples) over the machine angle of the motor's torque
    [N m] and of the true speed [rad/s], of machines whose motor does not stall; none without tolerances or flywheel. Waves of
    the profile are too short for it to feel them; the balance cam as in ``shaft_bands``."""
    own = Study(design).camshaft
    if not design.tolerances or not own.levelled:
        return {}
    theta = np.deg2rad(degrees(samples))
    balance = []
    with suppress(NoAnswer):
        balance = [] if own.balancer is None else [(own.balancer.load_curve, own.balancer_place)]
    found = {name: np.full((machines, samples), np.nan) for name in (MOTOR, SPEED)}
    for k, shaft in enumerate(_shafts(design, _drawn(design, machines), theta)):
        with suppress(NoAnswer):
            load = combined([(shaft.cams_load, ShaftPosition()), *balance])
            wheel = Flywheel(lambda _, shaft=shaft: shaft.cams_torque, load, shaft.design.camshaft)  # type: ignore[misc]
            angles = shaft.turn.angles(theta)
            found[MOTOR][k], found[SPEED][k] = wheel.motor_torque(angles), wheel.speed(angles)
    return _percentiles(found)


def _drawn(design: Design, machines: int) -> Mapping[str, np.ndarray]:
    """Field -> its numbers (machines,)."""
    asked = StudyFile(design="", quantities=(AskedFor(TORQUE, "max"),))
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


__all__ = ["drive_bands", "motor_bands", "shaft_bands"]
