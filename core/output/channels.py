"""Quantities that a design can plot, tabulate and export: the rows of ``core.study.quantities`` for this design."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import lru_cache, partial
from math import fsum
from types import MappingProxyType

import numpy as np

from core.design import UNITS, Design, Motion, join_angles, join_levels, motion_of, stroke
from core.design.edits import is_dwell
from core.design.fields import in_sentence
from core.dynamics import input_power
from core.errors import KindynaError
from core.frozen import frozen
from core.motion import TURN
from core.number_text import result_text
from core.numerics.derivatives import spread
from core.study import QUANTITIES, Camshaft, Quantity, Study, extremes_of, names_of, quantity
from core.study.drive_forces import turn_nodes
from core.study.extremes import has_quantity
from core.study.quantities import KINEMATICS, ORBIT, PROFILE, SERVO
from core.study.quantity_requests import OUTPUTS, is_angular, length_per_output, output_travel, path_drives, path_rate
from core.study.stages import memory
from core.study.study import variant_of

# -- channels ---------------------------------------------------------------------------------------------------


ANGLES: Mapping[str, str] = MappingProxyType(
    {PROFILE: "cam_angle_deg", KINEMATICS: "cam_angle_deg", SERVO: "cam_angle_deg", ORBIT: "input_angle_deg"}
)
"""Table -> its first column, for tables with the same angle in every kind of design: cam, or input of a flexible shaft."""


@lru_cache(maxsize=64)  # a changed length changes no name
def _rows_named(unit: str, names: tuple[str, ...]) -> tuple[Quantity, ...]:
    """Rows common to all designs, then rows of its links, with the unit of the motion and the formula of face or cam."""
    variant = variant_of(names)
    shared = tuple(
        replace(row, slug=row.slug.format(m=unit), variant=variant)
        for row in QUANTITIES.values()
        if row.slug and row.name in names
    )
    return (*shared, *(quantity(name) for name in names if name not in QUANTITIES))


def channels(design: Design, stages: Iterable[str] = ()) -> tuple[Quantity, ...]:
    """Quantities of a design for its readers, of the named stages or of all, in the order of the tables."""
    rows, selected = _rows_named(design.drive.motion_unit, names_of(design)), tuple(stages)
    return tuple(row for row in rows if not selected or row.stage in selected)


def channel(design: Design, slug: str) -> Quantity:
    """The quantity of a slug. Raises KeyError."""
    rows = channels(design)
    for row in rows:
        if row.slug == slug:
            return row
    raise KeyError(f"{slug}: no such channel; allowed: {', '.join(row.slug for row in rows)}")


def existing(study: Study, rows: Iterable[Quantity]) -> list[Quantity]:
    """Rows of quantities that this design has."""
    return [row for row in rows if has_quantity(study, row)]


# -- one turn of a motion without a cam -------------------------------------------------------------------------


@frozen
class Stop:
    """A rest of a motion that advances: its cam angle [deg], its position and index error [the motion's unit]."""

    at_deg: float
    position: float
    error: float


@frozen
class Work:
    """Work at the output over a turn: root mean square of force or torque [N or N m]; energy supplied and returned [J]."""

    rms: float
    given: float
    braked: float


@frozen
class MotionCycle:
    """One turn of a motion: mean speed [unit/s]; work, None without masses and forces, or where friction jams."""

    mean_speed: float
    stops: tuple[Stop, ...]
    work: Work | None


def has_cycle(study: Study) -> bool:
    """Whether the design has a motion and no cam."""
    return not study.design.listed and "motion" in study.stages and not study.has_disk


def motion_cycle(study: Study) -> MotionCycle:
    """One turn of a motion without a cam. Raises NoSolution as the linkage does."""
    motion = study.program.motion
    return MotionCycle(motion.gain * study.design.speed_rpm / 60.0, motion_stops(motion), _work(study))


def motion_stops(motion: Motion) -> tuple[Stop, ...]:
    """Rests of a motion with an advance, and their index errors.

    The first rest is exact, further ones should follow at equal steps: for an angle the step that divides a full turn and is
    nearest to the mean step. The first rest of the next turn is the last.
    """
    begins, levels = join_angles(motion), join_levels(motion)
    still = [is_dwell(segment) for segment in motion.segments]
    rests = [i for i, rest in enumerate(still) if rest and not still[i - 1]]
    if not rests or not motion.gain:
        return ()
    step = motion.gain / len(rests)
    if motion.unit == "deg" and (count := round(360.0 / abs(step))):
        step = float(np.copysign(360.0 / count, step))
    positions = [*((begins[i], levels[i]) for i in rests), (begins[rests[0]] + 360.0, levels[rests[0]] + motion.gain)]
    first = positions[0][1]
    return tuple(Stop(angle, level, fsum((level, -first, -k * step))) for k, (angle, level) in enumerate(positions))


def _work(study: Study) -> Work | None:
    if "dynamics" not in study.stages:
        return None
    try:
        if study.jam is not None:
            return None
        result: Work = memory.get("work of a turn", study.depends_on("dynamics"), lambda: _turn_work(study.full_turn))
    except KindynaError:  # the stage reports it
        return None
    return result


def _power(study: Study) -> np.ndarray:
    return spread(input_power(study.linkage, study.dynamics), study.theta.size)


def _turn_work(study: Study) -> Work:
    nodes, weight = turn_nodes(study, _power)
    power, seconds = _power(nodes), TURN / abs(study.omega)
    force = spread(nodes.dynamics.driver, weight.size)
    given, braked = (float(np.maximum(sign * power, 0.0) @ weight * seconds) for sign in (1.0, -1.0))
    return Work(float(np.sqrt(force**2 @ weight)), given, braked)


def cycle_line(study: Study) -> str:
    """Mean speed, index error, rms and energy of a turn in a line; empty where there are none."""
    result, unit = motion_cycle(study), study.design.drive.motion_unit
    symbol, parts = UNITS[unit].symbol, []
    if study.program.motion.gain:
        parts.append(f"mean speed {result_text(result.mean_speed)} {symbol}/s")
    if result.stops:
        parts.append(f"index error {result_text(max(abs(stop.error) for stop in result.stops), 3)} {symbol}")
    if result.work is not None:
        kind, net_energy = "N" if unit == "mm" else "N·m", result.work.given - result.work.braked
        parts.append(f"rms {result_text(result.work.rms)} {kind}")
        parts.append(f"energy {result_text(result.work.given)} J a turn, {result_text(net_energy)} J with recovery")
    return "; ".join(parts)


def new_design_text(design: Design) -> str:
    """Advance or stroke of a new design, and its peak velocity, acceleration and jerk."""
    motion, study = motion_of(design), Study(design)
    assert motion is not None, "a design without a motion"
    unit = UNITS[motion.unit].symbol
    size = (
        f"advance {result_text(motion.gain)} {unit} a turn"
        if motion.gain
        else f"stroke {result_text(stroke(motion))} {unit}"
    )
    lines = [f"{design.name}, {result_text(design.speed_rpm)} rpm: {size}"]
    extremes = extremes_of(study, "motion")
    for row in channels(design, ("motion",)):
        if row.name in ("velocity", "acceleration", "jerk"):
            ends = (extremes[row.name].low.value, extremes[row.name].high.value)
            largest = max(ends, key=abs) / row.unit.factor
            lines.append(f"largest {in_sentence(row.label)} {result_text(largest)} {row.unit.symbol}")
    if stops := motion_stops(motion):
        error = max(abs(stop.error) for stop in stops)
        lines.append(f"index error at the stops {result_text(error)} {unit}")
    return "\n".join(lines)


# -- outputs of the drives of a shaft ---------------------------------------------------------------------------


TRAVEL, SPEED, ACCELERATION = "{}_travel_mm", "path_speed_mm_s", "path_acceleration_mm_s2"
MM = 1e3


@frozen(eq=False)
class OutputColumn:
    """A column of the output of a drive.

    Attributes
    ----------
    name : name, which ends with the unit
    label : name in words
    family : family that determines its colour
    values : shaft -> values (n,) in the unit
    """

    name: str
    label: str
    family: str
    values: Callable[[Camshaft[Study]], np.ndarray]


def output_columns(camshaft: Camshaft[Study]) -> tuple[OutputColumn, ...]:
    """Outputs of every drive: displacement, velocity and acceleration, for a swinging arm also its travel.

    Then speed and acceleration along the path of the first drives, where their outputs are lengths.
    """
    rows: list[OutputColumn] = []
    for name, drive in camshaft.drives.items():
        quantities = {row.name: row for row in channels(drive.design, ("motion",))}
        slug = camshaft.slugs[name]
        rows += [
            OutputColumn(
                f"{slug}_{quantities[key].slug}",
                f"{name}, {in_sentence(quantities[key].label)}",
                quantities[key].family,
                partial(_drive_values, name, quantities[key]),
            )
            for key in OUTPUTS
            if key in quantities
        ]
        if is_angular(drive) and length_per_output(drive) is not None:
            rows.append(OutputColumn(TRAVEL.format(slug), f"{name}, travel", "displacement", partial(_travel, name)))
    leading = path_drives(camshaft)
    if leading:
        by = " and ".join((", ".join(leading[:-1]), leading[-1]))
        rows.append(OutputColumn(SPEED, f"Speed along the path by {by}", "velocity", partial(_path_values, 1)))
        rows.append(
            OutputColumn(ACCELERATION, f"Acceleration on the path by {by}", "acceleration", partial(_path_values, 2))
        )
    return tuple(rows)


def travel_column(camshaft: Camshaft[Study], name: str) -> str:
    """Column with the output of a drive as a length."""
    return (
        TRAVEL.format(camshaft.slugs[name])
        if is_angular(camshaft.drives[name])
        else f"{camshaft.slugs[name]}_displacement_mm"
    )


def _drive_values(name: str, row: Quantity, camshaft: Camshaft[Study]) -> np.ndarray:
    return row.values(camshaft.drive_study(name))


def _travel(name: str, camshaft: Camshaft[Study]) -> np.ndarray:
    return output_travel(camshaft, name)[0] * MM + 0.0


def _path_values(order: int, camshaft: Camshaft[Study]) -> np.ndarray:
    return path_rate(camshaft, order) * MM
