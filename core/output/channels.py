"""What a design can plot, table and export: the rows of ``core.study.quantities`` as this design has them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import lru_cache, partial
from math import fsum
from types import MappingProxyType

import numpy as np

from core.design import UNITS, Design, Motion, join_angles, join_levels, motion_of, stroke
from core.design.edits import is_dwell
from core.dynamics import input_power
from core.errors import KindynaError
from core.frozen import frozen
from core.motion import TURN
from core.numerics.derivatives import spread
from core.output.lines import digits
from core.study import QUANTITIES, Camshaft, Quantity, Study, extremes_of, names_of, quantity
from core.study.drive_forces import turn_nodes
from core.study.extremes import has_quantity
from core.study.quantities import KINEMATICS, ORBIT, PROFILE, SERVO
from core.study.quantity_requests import OUTPUTS, is_angular, length_per_output, output_travel, path_drives, path_rate
from core.study.stages import memory

# -- what a design can plot, table and export -------------------------------------------------------------------


ANGLES: Mapping[str, str] = MappingProxyType(
    {PROFILE: "cam_angle_deg", KINEMATICS: "cam_angle_deg", SERVO: "cam_angle_deg", ORBIT: "input_angle_deg"}
)
"""First column of the tables whose angle is one and the same in every kind of design: the cam's, or that of a flexible shaft's input."""


@lru_cache(maxsize=64)  # an edit of a length changes no name
def _rows_named(unit: str, names: tuple[str, ...]) -> tuple[Quantity, ...]:
    """First the rows that any design may have, then those of its links, with the unit of the motion and the face's formula."""
    straight = "contact_on_face" in names
    shared = tuple(
        replace(row, slug=row.slug.format(m=unit), straight=straight)
        for row in QUANTITIES.values()
        if row.slug and row.name in names
    )
    return (*shared, *(quantity(name) for name in names if name not in QUANTITIES))


def channels(design: Design, stages: Iterable[str] = ()) -> tuple[Quantity, ...]:
    """A row for each quantity of this very design that a reader can see, of the named stages or of all, in the order of the tables."""
    rows, wanted = _rows_named(design.drive.motion_unit, names_of(design)), tuple(stages)
    return tuple(row for row in rows if not wanted or row.stage in wanted)


def channel(design: Design, slug: str) -> Quantity:
    """One row of a design by its slug. Raises KeyError."""
    rows = channels(design)
    for row in rows:
        if row.slug == slug:
            return row
    raise KeyError(f"{slug}: no such channel; allowed: {', '.join(row.slug for row in rows)}")


def existing(study: Study, rows: Iterable[Quantity]) -> list[Quantity]:
    """Those rows that this very design has."""
    return [row for row in rows if has_quantity(study, row)]


# -- what a motion that no cam makes does in a turn -------------------------------------------------------------


@frozen
class Stop:
    """A rest of a motion that goes on: cam angle [deg] where it begins, position, and how far it is off [the motion's unit]."""

    at_deg: float
    position: float
    error: float


@frozen
class Work:
    """Of the force or torque at the output over a turn: root mean square [N, N m]; energy [J] that is given, and given back."""

    rms: float
    given: float
    braked: float


@frozen
class Cycle:
    """mean_speed: of the motion [unit/s]; work: None where nothing is moved, or friction jams."""

    mean_speed: float
    stops: tuple[Stop, ...]
    work: Work | None


def has_cycle(study: Study) -> bool:
    """Whether a motion drives it, and no cam."""
    return not study.design.listed and "motion" in study.stages and "cam" not in study.stages


def cycle_of(study: Study) -> Cycle:
    """Of a drive that a motion moves without a cam. Raises NoSolution as the linkage does."""
    motion = study.program.motion
    return Cycle(motion.gain * study.design.speed_rpm / 60.0, stops_of(motion), _work(study))


def stops_of(motion: Motion) -> tuple[Stop, ...]:
    """The rests of a motion with an advance. The first one is right; from one to the next it should go by equal steps: of an angle those
    that divide a whole turn, next to the mean of these. The first one of the next turn is the last."""
    begins, levels = join_angles(motion), join_levels(motion)
    still = [is_dwell(segment) for segment in motion.segments]
    rests = [i for i, rest in enumerate(still) if rest and not still[i - 1]]
    if not rests or not motion.gain:
        return ()
    step = motion.gain / len(rests)
    if motion.unit == "deg" and (whole := round(360.0 / abs(step))):
        step = float(np.copysign(360.0 / whole, step))
    at = [*((begins[i], levels[i]) for i in rests), (begins[rests[0]] + 360.0, levels[rests[0]] + motion.gain)]
    first = at[0][1]
    return tuple(Stop(angle, level, fsum((level, -first, -k * step))) for k, (angle, level) in enumerate(at))


def _work(study: Study) -> Work | None:
    if "dynamics" not in study.stages:
        return None
    try:
        if study.jam is not None:
            return None
        found: Work = memory.get("work of a turn", study.depends_on("dynamics"), lambda: _over_turn(study.full_turn))
    except KindynaError:  # its own stage says so
        return None
    return found


def _power(study: Study) -> np.ndarray:
    return spread(input_power(study.linkage, study.dynamics), study.theta.size)


def _over_turn(study: Study) -> Work:
    there, weight = turn_nodes(study, _power)
    power, seconds = _power(there), TURN / abs(study.omega)
    force = spread(there.dynamics.driver, weight.size)
    given, braked = (float(np.maximum(sign * power, 0.0) @ weight * seconds) for sign in (1.0, -1.0))
    return Work(float(np.sqrt(force**2 @ weight)), given, braked)


def cycle_line(study: Study) -> str:
    """The figures of a turn in a line: mean speed and index error where the motion goes on; of what it moves rms and energy. Empty where
    there are none."""
    found, unit = cycle_of(study), study.design.drive.motion_unit
    symbol, parts = UNITS[unit].symbol, []
    if study.program.motion.gain:
        parts.append(f"mean speed {found.mean_speed:.6g} {symbol}/s")
    if found.stops:
        parts.append(f"index error {max(abs(each.error) for each in found.stops):.3g} {symbol}")
    if found.work is not None:
        kind, left = "N" if unit == "mm" else "N m", found.work.given - found.work.braked
        parts.append(f"rms {found.work.rms:.6g} {kind}")
        parts.append(f"energy {found.work.given:.6g} J a turn, {left:.6g} J with recovery")
    return "; ".join(parts)


def begun_text(design: Design) -> str:
    """Advance, or stroke, and the peaks of a design that begins with its motion: largest velocity, acceleration and jerk."""
    motion, study = motion_of(design), Study(design)
    assert motion is not None, "a design without a motion"
    unit = UNITS[motion.unit].symbol
    way = f"advance {digits(motion.gain)} {unit} a turn" if motion.gain else f"stroke {digits(stroke(motion))} {unit}"
    lines = [f"{design.name}, {digits(design.speed_rpm)} rpm: {way}"]
    found = extremes_of(study, "motion")
    for row in channels(design, ("motion",)):
        if row.name in ("velocity", "acceleration", "jerk"):
            ends = (found[row.name].low.value, found[row.name].high.value)
            largest = max(ends, key=abs) / row.unit.factor
            lines.append(f"largest {row.label.lower()} {digits(largest)} {row.unit.symbol}")
    if stops := stops_of(motion):
        error = max(abs(each.error) for each in stops)
        lines.append(f"index error at the stops {digits(error)} {unit}")
    return "\n".join(lines)


# -- the outputs of all drives of a shaft at one machine angle, and the path on which the first of --------------


TRAVEL, SPEED, ACCELERATION = "{}_travel_mm", "path_speed_mm_s", "path_acceleration_mm_s2"
MM = 1e3


@frozen(eq=False)
class Output:
    """One column: its name, whose ending is its unit, in words, the family that sets its colour, and its values (n,) in its unit."""

    name: str
    label: str
    family: str
    values: Callable[[Camshaft[Study]], np.ndarray]


def outputs(camshaft: Camshaft[Study]) -> tuple[Output, ...]:
    """Displacement, velocity and acceleration of every drive; of one that swings an arm also its travel; then speed and acceleration
    along the path, where the first drives that lead it are measured in lengths."""
    rows: list[Output] = []
    for name, drive in camshaft.drives.items():
        own = {row.name: row for row in channels(drive.design, ("motion",))}
        slug = camshaft.slugs[name]
        rows += [
            Output(
                f"{slug}_{own[key].slug}",
                f"{name}, {own[key].label.lower()}",
                own[key].family,
                partial(_own, name, own[key]),
            )
            for key in OUTPUTS
            if key in own
        ]
        if is_angular(drive) and length_per_output(drive) is not None:
            rows.append(Output(TRAVEL.format(slug), f"{name}, travel", "displacement", partial(_travel, name)))
    leading = path_drives(camshaft)
    if leading:
        by = " and ".join((", ".join(leading[:-1]), leading[-1]))
        rows.append(Output(SPEED, f"Speed along the path by {by}", "velocity", partial(_along, 1)))
        rows.append(Output(ACCELERATION, f"Acceleration on the path by {by}", "acceleration", partial(_along, 2)))
    return tuple(rows)


def travel_column(camshaft: Camshaft[Study], name: str) -> str:
    """The column with the output of a drive as a length."""
    return (
        TRAVEL.format(camshaft.slugs[name])
        if is_angular(camshaft.drives[name])
        else f"{camshaft.slugs[name]}_displacement_mm"
    )


def _own(name: str, row: Quantity, camshaft: Camshaft[Study]) -> np.ndarray:
    return row.values(camshaft.drive_study(name))


def _travel(name: str, camshaft: Camshaft[Study]) -> np.ndarray:
    return output_travel(camshaft, name)[0] * MM + 0.0


def _along(order: int, camshaft: Camshaft[Study]) -> np.ndarray:
    return path_rate(camshaft, order) * MM
