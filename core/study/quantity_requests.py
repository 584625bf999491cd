"""What can be asked of a quantity over the turn, or of the whole turn, by its key."""

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
from core.stress import RollerLife
from core.study.camshaft import Camshaft
from core.study.extremes import extremes_of, fits
from core.study.quantities import names_of, quantity
from core.study.stages import memory
from core.study.study import PRESSURES, Study, pairings, pressing, ratings, roller_speed
from core.units import split_unit

# -- stress where the follower touches the cam, over the turn of a study ----------------------------------------


def worst(study: Study) -> Mapping[str, Extreme]:
    """First flank of each roller -> the greatest contact pressure [Pa], refined; empty where there is none."""
    there = pairings(study)
    if not there or study.loading.is_empty or study.jam is not None or not fits(study):
        return {}
    names = {flank: name for flank, name in PRESSURES.items() if flank in there}
    found = extremes_of(study, "dynamics", tuple(names.values()))
    return {flank: found[name].high for flank, name in names.items()}


def findings(study: Study) -> list[Finding]:
    """Pressures beyond their limits, or why there are none where they are asked for."""
    drive = study.design.drive
    if study.loading.is_empty or study.jam is not None:
        return []
    if lacking := stress.missing_input_findings(drive.face, drive.cam, drive.limits):
        return lacking
    there = pairings(study)
    if not there:
        return []
    if not fits(study):
        return (
            [stress.undercut_finding(drive.face.noun, drive.limits)]
            if stress.is_stress_requested(drive.cam, drive.limits)
            else []
        )
    return stress.pressure_findings(worst(study), there, drive.limits)


def borne(study: Study) -> tuple[float | None, str]:
    """The least pressure [Pa] that one of the materials bears, and where that stands; None where none is known."""
    rows = [each for pair in pairings(study).values() for each in pair.surfaces if each.allowable is not None]
    least = min(rows, key=lambda each: each.allowable or 0.0, default=None)
    return (None, "") if least is None else (least.allowable, least.source)


def roller_lives(study: Study) -> tuple[RollerLife, ...]:
    """The life of every roller whose load rating is stated; none where nothing loads the cam, or friction jams."""
    stated = ratings(study)
    if not stated or study.loading.is_empty or study.jam is not None:
        return ()

    def compute() -> tuple[RollerLife, ...]:
        angles, weight = stress.turn_quadrature(study.program, tuple(change.theta for change in study.flank_changes))
        there = study.at(angles)
        found = []
        for roller, rating in stated.items():
            speed = roller_speed(there, roller) / study.omega
            figures = stress.rolling_life(rating, pressing(there, roller), speed, weight, study.omega)
            found.append(RollerLife(roller, *(float(figure) for figure in figures)))
        return tuple(found)

    key = study.depends_on("dynamics"), tuple(stated.items())
    found: tuple[RollerLife, ...] = memory.get("rolling life", key, compute)
    return found


# -- what can be asked of a quantity over the turn, or of the whole turn, by its key ----------------------------


OVER_TURN = ("max", "min", "abs", "rms", "mean", "range")
"""What can be asked of a quantity over the turn: its largest and least value, the largest of either sign, root mean square, mean, and
largest less least value."""

LIFE, ENERGY = "life_hours", "energy_j"
TOTALS: Mapping[str, Callable[[Study], float]] = {
    "flywheel_inertia_kg_m2": lambda study: study.flywheel.needed_inertia,
    ENERGY: lambda study: study.flywheel.energy_swing,
    LIFE: lambda study: min(
        (life.hours for drive in study.drives.values() if "cam" in drive.stages for life in roller_lives(drive)),
        default=np.nan,
    ),
}
"""Totals of a turn: the flywheel that keeps the fluctuation, the energy that it takes up and gives back, life of the shortest-lived
roller."""


TORQUE = "torque_nm"
"""Column of what all drives of a shaft ask of it together, at constant speed."""


class Asked(NamedTuple):
    """One thing asked: its key as given; the quantity, what of it over the turn, and its unit in SI; a total, and the torque of a shaft
    of several drives, have no quantity; drive: number of the one whose quantity it is."""

    key: str
    name: str
    of: str
    unit: float
    drive: int | None = None


def asked_of(design: Design, key: str) -> Asked:
    """What a key asks. Raises ValueError, naming it."""
    if key in TOTALS:
        if design.shaft is None and key != LIFE:
            raise ValueError(f"{key}: this design has no [shaft]")
        return Asked(key, "", key, 1.0)
    slug, _, of = key.partition(":")
    if of not in OVER_TURN:
        raise ValueError(f"{key}: asked is <column>:{'|'.join(OVER_TURN)}, or {', '.join(TOTALS)}")
    if design.listed:
        if slug == TORQUE:
            return Asked(key, "", of, 1.0)
        number, inside = drive_at(slug) or (len(design.drives), "")
        if number >= len(design.drives):
            raise ValueError(
                f"{key}: asked is {TORQUE}:{of}, or drives[0].<column>:{of} of its drives, or {', '.join(TOTALS)}"
            )
        own = asked_of(only(design, number), f"{inside}:{of}")
        return own._replace(key=key, drive=number)
    name = _columns(design).get(slug, "")
    if not name:
        raise ValueError(f"{key}: this design has no such column with extremes")
    return Asked(key, name, of, split_unit(slug)[1].factor)


@lru_cache(maxsize=16)
def _columns(design: Design) -> Mapping[str, str]:
    """Column, by whose unit a value counts -> quantity, of those that have extremes."""
    rows = (quantity(name) for name in names_of(design))
    return {row.slug.format(m=design.drive.motion_unit): row.name for row in rows if row.slug and not row.turns}


def columns_of(design: Design) -> tuple[str, ...]:
    """The columns of which something over the turn can be asked; of several drives what all ask together, then those of each."""
    if not design.listed:
        return tuple(_columns(design))
    return (TORQUE, *(path_of(i, slug) for i in range(len(design.drives)) for slug in _columns(only(design, i))))


def infos_of(design: Design, paths: Iterable[str]) -> dict[str, Any]:
    """Path -> what its field takes. Raises ValueError, naming a path that is no number which need not be whole."""
    found = {path: _info(design, path) for path in paths}
    for path, info in found.items():
        if info is None or info.choices or info.whole or info.flag:
            raise ValueError(f"{path}: only a number that need not be whole can be varied")
    return found


def _info(design: Design, path: str) -> Any:
    entry = entry_at(design, path)
    if entry is None:
        raise ValueError(f"{path}: no such number in this design")
    return entry.info


def mean_of(values: np.ndarray, weight: np.ndarray, of: str) -> Any:
    """Mean or root mean square over the turn of values (..., n) at nodes of these weights (n,)."""
    return np.sqrt((values * values * weight).sum(axis=-1)) if of == "rms" else (values * weight).sum(axis=-1)


def of_range(of: str, low: tuple[Any, Any], high: tuple[Any, Any]) -> tuple[Any, Any]:
    """Value and cam angle of what is asked, from the least and the largest value with theirs."""
    if of == "range":
        return high[0] - low[0], np.full(np.shape(high[0]), np.nan)
    if of == "abs":
        upper = np.abs(high[0]) >= np.abs(low[0])
        return np.where(upper, np.abs(high[0]), np.abs(low[0])), np.where(upper, high[1], low[1])
    return low if of == "min" else high


# -- the path on which the first drives of a shaft lead what they carry together --------------------------------


OUTPUTS = ("displacement", "velocity", "acceleration")
DIRECTIONS = 3


def leads(camshaft: Camshaft[Study]) -> tuple[str, ...]:
    """The drives that lead the path: the first three of the list, or two where there are no more; none where one of them has no
    measure in lengths."""
    names = tuple(camshaft.drives)[:DIRECTIONS]
    return names if len(names) > 1 and all(lever(camshaft.drives[name]) is not None for name in names) else ()


def swings(study: Study) -> bool:
    """Whether a drive's output is an angle."""
    motion = study.design.drive.motion
    return motion is not None and motion.unit == "deg"


def lever(study: Study) -> float | None:
    """Length by output: 1 of what slides; of what swings the length of the roller's arm [m]; None where there is none."""
    if study.design.drive.motion is None:
        return None
    if not swings(study):
        return 1.0
    arm: float | None = getattr(study.design.drive.mechanism, "arm_mm", None)
    return None if arm is None else arm * 1e-3


def travel(camshaft: Camshaft[Study], name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Output of a drive as a length, its velocity and acceleration, each (n,), at its machine angles [m, m/s, m/s²].

    s = y of what slides; s = l φ of what swings, l the length of the roller's arm.
    """
    there, length = camshaft.there(name), lever(camshaft.drives[name])
    assert length is not None, name
    first, second, third = (quantity(key).value(there) * length for key in OUTPUTS)
    return first, second, third


def along(camshaft: Camshaft[Study], order: int) -> np.ndarray:
    """Speed along the path (order 1) and size of the acceleration on it (2), of drives that move at right angles: √(Σ ṡ²), √(Σ s̈²)
    (n,) [m/s, m/s²]."""
    return np.asarray(np.linalg.norm([travel(camshaft, name)[order] for name in leads(camshaft)], axis=0))
