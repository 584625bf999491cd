"""Tolerance bands over the turn, of a drive and of the torque of several drives on their shaft."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from core.design import Design, drive_at, only
from core.errors import NoSolution
from core.motion import degrees
from core.motion.program import ShaftPosition
from core.numerics.lazy import checkpoint
from core.shaft import Flywheel, combined_load
from core.study import Camshaft, Study
from core.study.batch import with_numbers
from core.study.limits import SPEEDS
from core.study.machine_laws import with_fixed_laws
from core.study.quantity_requests import TORQUE, quantity_request, request_columns
from core.varying.request import StudyFile, StudyQuantity, study_of
from core.varying.surveys import SEED
from core.varying.tolerances import MACHINES, PERCENTILES, Scatter
from core.varying.waves import DRIVE_TORQUE, AllWaves

# -- tolerance bands --------------------------------------------------------------------------------------------


MOTOR, SPEED = "motor_torque", "camshaft_speed"
FEW_MACHINES = 200  # of quantities that are computed machine by machine


def _single_drive(design: Design, drive: int) -> Design:
    """Design of a single drive (``only``), with its tolerances and the waviness of its profile."""
    if not design.listed:
        return design
    inside = ((row, drive_at(row.field)) for row in design.tolerances)
    rows = [replace(row, field=at[1]) for row, at in inside if at is not None and at[0] == drive]
    rows += [row for row in design.tolerances if row.field in SPEEDS]
    return replace(only(design, drive), tolerances=tuple(rows), waviness=design.waviness)


def drive_bands(design: Design, drive: int, slugs: Sequence[str], quick: bool) -> Mapping[str, np.ndarray]:
    """Percentiles of a drive's quantities over its cam angle.

    Parameters
    ----------
    design : Design
    drive : int
        Number of the drive.
    slugs : sequence of str
        Columns; those that the drive lacks are left out.
    quick : bool
        Take the columns that are computed for many machines at once; else the others, for fewer machines.

    Returns
    -------
    mapping of str -> ndarray (5, 360) [unit of the column]
    """
    design = with_fixed_laws(_single_drive(design, drive))
    columns = set(request_columns(design))
    rows = []
    for slug in slugs:
        with suppress(ValueError):
            if slug in columns:
                rows.append((slug, quantity_request(design, f"{slug}:max")))
    if not rows or not (design.tolerances or design.waviness):
        return {}
    quantities = tuple(StudyQuantity(slug, "max") for slug, _ in rows)
    scatter = Scatter(study_of(StudyFile(design="", quantities=quantities), design))
    chosen = [slug for slug, request in rows if scatter.is_quick(request) == quick]
    return scatter.bands(MACHINES if quick else FEW_MACHINES, SEED, only=chosen) if chosen else {}


def shaft_bands(design: Design, samples: int = 360, machines: int = FEW_MACHINES) -> Mapping[str, np.ndarray]:
    """Percentiles of the torques of several drives on the shaft at constant speed, over the machine angle.

    Every cam has its own waves. The balance cam has none: it is that of the nominal torque.

    Parameters
    ----------
    design : Design
    samples : int
        Number n of machine angles.
    machines : int
        Number of random machines.

    Returns
    -------
    mapping of str -> ndarray (5, n) [N m]
        Name of a drive, or "" for the total; empty where the design has neither tolerances nor waviness.
    """
    if not design.tolerances and design.waviness is None:
        return {}
    design = with_fixed_laws(design)
    numbers = _random_numbers(design, machines)
    theta = np.deg2rad(degrees(samples))
    camshaft = Study(design).camshaft.at_theta(theta)
    names = camshaft.loading_drives
    torques = np.full((len(names), machines, samples), np.nan)
    rows = {path: drive_at(path) for path in numbers}
    is_constant = [
        not design.tolerances or not any(row is None or row[0] == camshaft.drive_number(name) for row in rows.values())
        for name in names
    ]
    for k, shaft in enumerate(_shafts(design, numbers, theta)):
        for i, name in enumerate(names):
            with suppress(NoSolution):
                torques[i, k] = torques[i, 0] if is_constant[i] and k else shaft.drive_torque(name)
    waves = AllWaves(design)
    for i, number in enumerate(map(camshaft.drive_number, names)):
        if number in waves.by_drive and waves.by_drive[number].changes(DRIVE_TORQUE):
            drive_waves = waves.by_drive[number].at(camshaft.positions[names[i]].drive_angle(theta))
            torques[i] += drive_waves.change(
                DRIVE_TORQUE, torques[i], drive_waves.error(*waves.random_waves(number, machines, SEED))
            )
    balance: float | np.ndarray = 0.0
    with suppress(NoSolution):
        balance = camshaft.balancer_torque if design.balancer is not None else 0.0
    return _percentiles({**dict(zip(names, torques, strict=True)), "": torques.sum(axis=0) + balance})


def motor_bands(design: Design, samples: int = 360, machines: int = FEW_MACHINES) -> Mapping[str, np.ndarray]:
    """Percentiles of motor torque and true speed over the machine angle, of machines whose motor does not stall.

    Waves of the profile are too short to affect them; the balance cam is as in ``shaft_bands``.

    Parameters
    ----------
    design : Design
    samples : int
        Number n of machine angles.
    machines : int
        Number of random machines.

    Returns
    -------
    mapping of str -> ndarray (5, n) [N m] or [rad/s]
        Quantity -> its percentiles; empty without tolerances or flywheel.
    """
    design = with_fixed_laws(design)
    camshaft = Study(design).camshaft
    if not design.tolerances or not camshaft.levels_torque:
        return {}
    theta = np.deg2rad(degrees(samples))
    balance = []
    with suppress(NoSolution):
        balance = [] if camshaft.balancer is None else [(camshaft.balancer.load_curve, camshaft.balancer_position)]
    values = {name: np.full((machines, samples), np.nan) for name in (MOTOR, SPEED)}
    for k, shaft in enumerate(_shafts(design, _random_numbers(design, machines), theta)):
        with suppress(NoSolution):
            load = combined_load([(shaft.cams_load, ShaftPosition()), *balance])
            wheel = Flywheel(lambda _, shaft=shaft: shaft.cams_torque, load, shaft.design.camshaft)  # type: ignore[misc]
            angles = shaft.turn.angles(theta)
            values[MOTOR][k], values[SPEED][k] = wheel.motor_torque(angles), wheel.speed(angles)
    return _percentiles(values)


def _random_numbers(design: Design, machines: int) -> Mapping[str, np.ndarray]:
    """Field -> its numbers (machines,) in random machines."""
    file = StudyFile(design="", quantities=(StudyQuantity(TORQUE, "max"),))
    return Scatter(study_of(file, design)).machines(machines, SEED)


def _shafts(design: Design, columns: Mapping[str, np.ndarray], theta: np.ndarray) -> Iterator[Camshaft[Study]]:
    """Camshaft of every machine at machine angles (n,) [rad]."""
    for numbers in zip(*(row.tolist() for row in columns.values()), strict=True):
        checkpoint()
        yield Study(with_numbers(design, list(columns), numbers)).camshaft.at_theta(theta)


def _percentiles(values: Mapping[str, np.ndarray]) -> Mapping[str, np.ndarray]:
    """Name -> percentiles (5, n) of values (m, n) of m machines; names without any value are left out."""
    levels = list(PERCENTILES.values())
    return {name: np.nanpercentile(row, levels, axis=0) for name, row in values.items() if not np.isnan(row).all()}
