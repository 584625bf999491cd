"""Figures of a design by key: a statistic of a quantity over the turn, or a total of the turn."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from core import stress
from core.design import Design, entry_at, only
from core.design.camshaft import drive_at, path_of
from core.findings import Finding
from core.motion.extremes import Extreme
from core.project.reading_faults import did_you_mean
from core.study.camshaft import Camshaft
from core.study.drive_forces import PRESSURES, pairings, roller_lives
from core.study.extremes import extremes_of, has_undercut
from core.study.quantities import Quantity, names_of, quantity, why_absent
from core.study.study import Study
from core.units import split_unit

# -- contact stress and rolling life over the turn ---------------------------------------------------------------


def peak_pressures(study: Study) -> Mapping[str, Extreme]:
    """First flank of each roller -> greatest contact pressure [Pa], refined; empty where there is no pressure."""
    contacts = pairings(study)
    if not contacts or study.loading.is_empty or study.jam is not None or has_undercut(study):
        return {}
    names = {flank: name for flank, name in PRESSURES.items() if flank in contacts}
    extremes = extremes_of(study, "dynamics", tuple(names.values()))
    return {flank: extremes[name].high for flank, name in names.items()}


def pressure_findings(study: Study) -> list[Finding]:
    """Contact pressures beyond their limits, or why a requested pressure cannot be given."""
    drive = study.design.drive
    if study.loading.is_empty or study.jam is not None:
        return []
    if missing := stress.missing_input_findings(drive.face, drive.cam, drive.limits):
        return missing
    contacts = pairings(study)
    if not contacts:
        return []
    if has_undercut(study):
        is_requested = stress.is_stress_requested(drive.cam, drive.limits)
        return [stress.undercut_finding(drive.face.noun, drive.limits)] if is_requested else []
    return stress.pressure_findings(peak_pressures(study), contacts, drive.limits)


def allowable_pressure(study: Study) -> tuple[float | None, str]:
    """Allowable contact pressure [Pa] of the weaker material, and its source; None where no material states one."""
    surfaces = [s for pair in pairings(study).values() for s in pair.surfaces if s.allowable is not None]
    weakest = min(surfaces, key=lambda surface: surface.allowable or 0.0, default=None)
    return (None, "") if weakest is None else (weakest.allowable, weakest.source)


# -- statistics and totals --------------------------------------------------------------------------------------


STATISTICS = ("max", "min", "abs", "rms", "mean", "range")
"""Statistics of a quantity over the turn: greatest, least, greatest in size, root mean square, mean, greatest less least."""

LIFE, ENERGY, INERTIA = "life_hours", "energy_j", "flywheel_inertia_kg_m2"
TOTALS: Mapping[str, Callable[[Study], float]] = {
    INERTIA: lambda study: study.flywheel.needed_inertia,
    ENERGY: lambda study: study.flywheel.energy_swing,
    LIFE: lambda study: min(
        (life.hours for drive in study.drives.values() if drive.has_disk for life in roller_lives(drive)),
        default=np.nan,
    ),
}
"""Totals of a turn: inertia of the flywheel that keeps the fluctuation, energy that it stores and releases, life of the
roller with the shortest life."""


TORQUE = "torque_nm"
"""Column of the total torque of all drives on a shaft, at constant speed."""


class QuantityRequest(NamedTuple):
    """A requested figure of a design.

    Attributes
    ----------
    key : str
        The request as given.
    name : str
        Name of the quantity; empty for a total, and for the torque of a shaft with several drives.
    statistic : str
        One of ``STATISTICS``, or the key of a total.
    unit : float
        Size of its unit in SI units.
    drive : int or None
        Number of the drive to which the quantity belongs, of several.
    """

    key: str
    name: str
    statistic: str
    unit: float
    drive: int | None = None


def quantity_request(design: Design, key: str) -> QuantityRequest:
    """Request of a key, as ``pressure_angle_deg:max``. Raises ValueError, which names the key, where the design lacks it."""
    if key in TOTALS:
        if design.shaft is None and key != LIFE:
            raise ValueError(f"{key}: this design has no [shaft]")
        return QuantityRequest(key, "", key, 1.0)
    slug, _, statistic = key.partition(":")
    if statistic not in STATISTICS:
        near = did_you_mean(key, (*(f"{slug}:{name}" for name in STATISTICS), *TOTALS))
        raise ValueError(f"{key}: allowed are <column>:{'|'.join(STATISTICS)}, and {', '.join(TOTALS)}{near}")
    if design.listed:
        if slug == TORQUE:
            return QuantityRequest(key, "", statistic, 1.0)
        if slug in _clearance_columns(design):
            return QuantityRequest(key, slug, statistic, split_unit(slug)[1].factor)
        number, column = drive_at(slug) or (len(design.drives), "")
        if number >= len(design.drives):
            raise ValueError(
                f"{key}: allowed are {TORQUE}:{statistic}, drives[0].<column>:{statistic} of a drive, and "
                f"{', '.join(TOTALS)}{did_you_mean(slug, request_columns(design))}"
            )
        return quantity_request(only(design, number), f"{column}:{statistic}")._replace(key=key, drive=number)
    name = _columns(design).get(slug) or _table_columns(design).get(slug, "")
    if not name:
        raise ValueError(
            f"{key}: this design has no such column with extremes{did_you_mean(slug, _columns(design))}{why_absent(design, slug)}"
        )
    return QuantityRequest(key, name, statistic, split_unit(slug)[1].factor)


@lru_cache(maxsize=16)
def _columns(design: Design) -> Mapping[str, str]:
    """Column, whose unit the values have -> name of the quantity, of quantities with extremes."""
    return {row.slug.format(m=design.drive.motion_unit): row.name for row in _with_extremes(design)}


def _table_columns(design: Design) -> Mapping[str, str]:
    """Column of a table that is named otherwise than its quantity, as the servo's -> name of the quantity."""
    return {row.column: row.name for row in _with_extremes(design) if row.column != row.slug}


def _with_extremes(design: Design) -> Iterable[Quantity]:
    rows = (quantity(name) for name in names_of(design))
    return (row for row in rows if row.slug and not row.is_periodic)


def request_columns(design: Design) -> tuple[str, ...]:
    """Columns that have statistics over the turn; of several drives the total torque, then the columns of every drive."""
    if not design.listed:
        return tuple(_columns(design))
    of_drives = (path_of(i, slug) for i in range(len(design.drives)) for slug in _columns(only(design, i)))
    return (TORQUE, *_clearance_columns(design), *of_drives)


@lru_cache(maxsize=16)
def _clearance_columns(design: Design) -> tuple[str, ...]:
    """Columns of the clearances of a design with several drives."""
    if not design.outlines:
        return ()
    from core.study.clearances import pair_members  # few designs have outlines

    return tuple(f"{member}_mm" for member in pair_members(Study(design)))


def number_fields(design: Design, paths: Iterable[str]) -> dict[str, Any]:
    """Path -> info of its field. Raises ValueError, which names the path, for anything but a number with fractions."""
    infos = {}
    for path in paths:
        entry = entry_at(design, path)
        if entry is None:
            raise ValueError(f"{path}: no such number in this design")
        infos[path] = entry.info
    for path, info in infos.items():
        if info is None or info.choices or info.whole or info.flag:
            raise ValueError(f"{path}: only a number that need not be whole can be varied")
    return infos


def mean_statistic(values: np.ndarray, weight: np.ndarray, statistic: str) -> Any:
    """Mean, or root mean square for "rms", of a quantity over the turn.

    Parameters
    ----------
    values : ndarray (..., n) [SI unit of the quantity]
        Values at the nodes of a quadrature; leading axes are designs.
    weight : ndarray (..., n), dimensionless
        Weights of the nodes; their sum is 1.
    statistic : "rms" or "mean"

    Returns
    -------
    ndarray (...,) [SI unit of the quantity]
    """
    if statistic == "rms":
        return np.sqrt((values * values * weight).sum(axis=-1))
    return (values * weight).sum(axis=-1)


def extreme_statistic(statistic: str, low: tuple[Any, Any], high: tuple[Any, Any]) -> tuple[Any, Any]:
    """Value and cam angle of "max", "min", "abs" or "range", from the least and the greatest value with their cam angles."""
    if statistic == "range":
        return high[0] - low[0], np.full(np.shape(high[0]), np.nan)
    if statistic == "abs":
        upper = np.abs(high[0]) >= np.abs(low[0])
        return np.where(upper, np.abs(high[0]), np.abs(low[0])), np.where(upper, high[1], low[1])
    return low if statistic == "min" else high


# -- path of the part that the drives of a shaft transfer ---------------------------------------------------------


OUTPUTS = ("displacement", "velocity", "acceleration")
DIRECTIONS = 3


def path_drives(camshaft: Camshaft[Study]) -> tuple[str, ...]:
    """Names of the drives that move the part: the first three, or two; empty where one of them has no output as a length."""
    names = tuple(camshaft.drives)[:DIRECTIONS]
    has_lengths = all(length_per_output(camshaft.drives[name]) is not None for name in names)
    return names if len(names) > 1 and has_lengths else ()


def is_angular(study: Study) -> bool:
    """Whether the output of a drive is an angle."""
    motion = study.design.drive.motion
    return motion is not None and motion.unit == "deg"


def length_per_output(study: Study) -> float | None:
    """Length by output of a drive: 1 for a slide, the length of the roller's arm [m] for a swing; None where there is none."""
    if study.design.drive.motion is None:
        return None
    if not is_angular(study):
        return 1.0
    arm: float | None = getattr(study.design.drive.mechanism, "arm_mm", None)
    return None if arm is None else arm * 1e-3


def output_travel(camshaft: Camshaft[Study], name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Output of a drive as a length at the machine angles: s = y of a slide, s = l φ of a swing with the roller's arm l.

    Parameters
    ----------
    camshaft : Camshaft
    name : str
        Name of the drive.

    Returns
    -------
    travel, velocity, acceleration : ndarray (n,) [m], [m/s], [m/s²]
    """
    study, length = camshaft.drive_study(name), length_per_output(camshaft.drives[name])
    assert length is not None, name
    travel, velocity, acceleration = (quantity(key).value(study) * length for key in OUTPUTS)
    return travel, velocity, acceleration


def path_rate(camshaft: Camshaft[Study], order: int) -> np.ndarray:
    """Speed √(Σ ṡ²) along the path, or size √(Σ s̈²) of the acceleration, of drives at right angles.

    Parameters
    ----------
    camshaft : Camshaft
    order : int
        1 for the speed, 2 for the acceleration.

    Returns
    -------
    ndarray (n,) [m/s] or [m/s²]
    """
    return np.asarray(np.linalg.norm([output_travel(camshaft, name)[order] for name in path_drives(camshaft)], axis=0))
