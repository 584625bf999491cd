"""Texts, tables and figures of three subjects: cam or servo, contact and lift-off, and the elastic follower."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from io import StringIO
from math import degrees, pi
from typing import Any

import numpy as np

from core.design import UNITS
from core.design.parts import LINEAR
from core.dynamics import ContactMap, Flights, contact_map
from core.elastic import Spectrum
from core.errors import NoSolution
from core.frozen import frozen
from core.motion import TURN
from core.motion.extremes import find_highest
from core.number_text import result_text
from core.output.lines import columns, digits
from core.plot import Figure, Plot, PlotCurve
from core.study import Study
from core.study.drive_forces import servo_part, servo_speed, servo_torque, servo_turn, turn_nodes

# -- cam or servo: motor torque for the same motion -------------------------------------------------------------


RPM = UNITS["rpm"].factor
Values = Callable[[Study], np.ndarray]
CAM, FLYWHEEL, SERVO = "cam", "cam_with_flywheel", "servo"
LABELS = {CAM: "Cam", FLYWHEEL: "Cam and flywheel", SERVO: "Servo"}
RECTANGLE = np.array([1.0, 1.0, -1.0, -1.0, 1.0]), np.array([1.0, -1.0, -1.0, 1.0, 1.0])  # speed, torque


@frozen
class DriveEffort:
    """Effort of the motor of one drive over a turn.

    Attributes
    ----------
    drive : ``CAM``, ``FLYWHEEL`` or ``SERVO``
    rms, peak : root mean square and peak of the torque or force [unit]
    peak_deg : cam angle of the peak [deg]
    peak_power : [W]
    given, braked : energy from the motor, and returned to it by the load [J]
    """

    drive: str
    unit: str
    rms: float
    peak: float
    peak_deg: float
    peak_power: float
    given: float
    braked: float

    @property
    def label(self) -> str:
        """Name of the drive in headings and legends."""
        return LABELS[self.drive]


@frozen(eq=False)
class _Drive:
    """A drive of the motion.

    Attributes
    ----------
    torque : study -> torque or force at its angles (n,) [N m or N]
    speed : study -> its speed (n,) [rad/s or m/s]
    """

    name: str
    torque: Values
    speed: Values

    def power(self, study: Study) -> np.ndarray:
        return self.torque(study) * self.speed(study)


def _drives(study: Study) -> Iterator[_Drive]:
    """Drives of the design. Raises NoSolution as the stage dynamics does."""
    if study.loads_shaft:
        yield _Drive(CAM, lambda s: s.shaft_torque, lambda s: np.full(s.theta.size, s.omega))
        if study.levels_torque and study.flywheel.runs:
            wheel = study.flywheel
            yield _Drive(FLYWHEEL, lambda s: wheel.motor_torque(s.angles), lambda s: wheel.speed(s.angles))
    yield _Drive(SERVO, servo_torque, servo_speed)


def _drive_effort(study: Study, drive: _Drive) -> DriveEffort:
    def sizes(angles: object) -> dict[str, np.ndarray]:
        nodes = study.at(angles)  # type: ignore[arg-type]
        return {"torque": np.abs(drive.torque(nodes)), "power": np.abs(drive.power(nodes))}

    peaks = find_highest(sizes, study.program)
    if drive.name == SERVO:
        turn = servo_turn(study)
        rms, given, braked = turn.rms, turn.given, turn.braked
    else:
        nodes, weight = turn_nodes(study, drive.power)
        torque, seconds = drive.torque(nodes), weight * TURN / drive.speed(nodes)
        rms = float(np.sqrt((torque**2 * seconds).sum() / seconds.sum()))
        given, braked = (float(np.maximum(sign * torque, 0.0) @ weight * TURN) for sign in (1.0, -1.0))
    peak, power = peaks["torque"], peaks["power"].value
    unit = "N" if drive.name == SERVO and servo_part(study).kind == LINEAR else "N·m"
    return DriveEffort(drive.name, unit, rms, peak.value, degrees(peak.theta), power, given, braked)


def drive_efforts(study: Study) -> tuple[DriveEffort, ...]:
    """Efforts of the cam, of the cam with the flywheel that the motor turns, and of the servo, as far as the design has them.

    A motion without a cam has the servo alone. Raises NoSolution as the stage dynamics does.
    """
    return tuple(_drive_effort(study, drive) for drive in _drives(study))


def torque_figure(study: Study, efforts: tuple[DriveEffort, ...]) -> Figure:
    """Torque of all drives over the cam angle, with peak and rms; the force of a linear motor has a separate plot."""
    x = np.append(study.angle_degrees, 360.0)
    plots: dict[str, list[PlotCurve]] = {}
    for i, (drive, effort) in enumerate(zip(_drives(study), efforts, strict=True)):
        values = drive.torque(study)
        label = f"{effort.label}: peak {result_text(effort.peak)}, rms {result_text(effort.rms)}"
        plots.setdefault(effort.unit, []).append(PlotCurve(x, np.append(values, values[0]), label, i))
    return Figure(
        "cam_or_servo",
        "Cam or servo",
        tuple(
            Plot("Cam angle, °", f"{'Force' if unit == 'N' else 'Torque'}, {unit}", tuple(curves))
            for unit, curves in plots.items()
        ),
    )


def field_plot(study: Study, rms: float) -> Plot:
    """Working points of the servo motor over a turn, torque over speed, within its peak and its rated torque up to its rated speed.

    ``rms`` is the torque that the rated torque must exceed.
    """
    servo = servo_part(study)
    linear = servo.kind == LINEAR
    speed, torque = servo_speed(study) * (1e3 if linear else 30.0 / pi), servo_torque(study)
    fastest, largest = float(np.abs(speed).max()), float(np.abs(torque).max())
    width = servo.rated_rpm or fastest
    fields = [("Peak torque", servo.peak_torque_nm, 1), ("Rated torque", servo.rated_torque_nm, 2)]
    if servo.peak_torque_nm is None and servo.rated_torque_nm is None and servo.rated_rpm is not None:
        fields = [("Rated speed", largest, 1)]
    edges = tuple(
        PlotCurve(width * RECTANGLE[0], limit * RECTANGLE[1], label, row, dashed=True)
        for label, limit, row in fields
        if limit is not None
    )
    loop = PlotCurve(np.append(speed, speed[0]), np.append(torque, torque[0]), "Working points")
    level = PlotCurve(fastest * RECTANGLE[0], rms * RECTANGLE[1], f"rms {result_text(rms)}", 3, dashed=True)
    x_title, y_title = ("Speed, mm/s", "Force, N") if linear else ("Motor speed, rpm", "Motor torque, N·m")
    return Plot(x_title, y_title, (loop, level, *edges))


# -- contact and lift-off ---------------------------------------------------------------------------------------


CONTACT_SPEEDS, CONTACT_BEYOND = 40, 1.5  # speeds of the map, their range relative to the speed of design or lift-off


def contact_force_map(
    study: Study, theta: np.ndarray, top_rpm: float | None = None, speeds: int = CONTACT_SPEEDS
) -> ContactMap:
    """Contact force over cam angle and speed.

    Parameters
    ----------
    study : Study
    theta : ndarray (n,) [rad]
        Cam angles.
    top_rpm : float, optional
        Highest speed [rpm]; by default somewhat above the speeds of design and lift-off.
    speeds : int
        Number of equally spaced speeds.

    Returns
    -------
    ContactMap

    Raises
    ------
    NoSolution
        There is no contact force that could be lost.
    """
    return contact_map(
        study.contact_force, theta, np.linspace(0.0, RPM * (top_rpm or default_top_rpm(study)), speeds + 1)[1:]
    )


def default_top_rpm(study: Study) -> float:
    """Highest speed of the map [rpm]."""
    lift_off, speed = study.lift_off, abs(study.omega) / RPM
    highest = speed if lift_off is None else max(speed, min(lift_off.omega / RPM, 4.0 * speed))
    return float(f"{CONTACT_BEYOND * highest:.2g}")


def contact_map_csv(contact: ContactMap) -> str:
    """Rows of cam angle, speed and contact force, speed by speed."""
    text = StringIO()
    text.write("cam_angle_deg,speed_rpm,contact_force_n\n")
    angles = [repr(x) for x in np.rad2deg(contact.theta).tolist()]
    for speed, row in zip((contact.omega / RPM).tolist(), contact.force.tolist(), strict=True):
        for angle, force in zip(angles, row, strict=True):
            text.write(f"{angle},{speed!r},{force!r}\n")
    return text.getvalue()


def lift_off_lines(study: Study) -> list[str]:
    """Whether the follower stays on the cam at the design's speed, and the speed from which it leaves it, in one line.

    Empty where it cannot leave it.
    """
    try:
        lift_off = study.lift_off
    except NoSolution:
        return []
    if lift_off is None:
        return ["The follower stays on the cam at any speed"]
    rpm, angle = digits(lift_off.omega / RPM), digits(math.degrees(lift_off.theta))
    if not lift_off.omega:
        return [f"No force presses the follower on the cam at {angle}°, even at standstill"]
    speed = digits(abs(study.omega) / RPM)
    if abs(study.omega) < lift_off.omega:
        return [
            f"At {speed} rpm the follower stays on the cam; it leaves the cam at {rpm} rpm and above, at cam angle {angle}°"
        ]
    return [f"At {speed} rpm the follower leaves the cam: it does at {rpm} rpm and above, first at cam angle {angle}°"]


def flight_lines(study: Study, result: Flights) -> list[str]:
    """Flights as a table, and whether they repeat."""
    if not result.flights:
        return ["No flight at the design's speed"]
    unit = UNITS[study.program.motion.unit]
    rows: list[Sequence[str]] = [
        ("Flight", "leaves at °", "lands at °", f"height {unit.symbol}", f"lands with {unit.symbol}/s")
    ]
    for i, flight in enumerate(result.flights, 1):
        ends = [digits(math.degrees(x)) if math.isfinite(x) else "not" for x in (flight.lift, flight.land)]
        rows.append((str(i), *ends, digits(flight.height / unit.factor), digits(flight.speed / unit.factor)))
    lines = columns(rows)
    if result.steady:
        period = "every turn" if result.turns == 1 else f"every {result.turns} turns"
        lines.append(f"From flight {result.repeats + 1} on they repeat {period}")
    else:
        lines.append("They do not repeat within the computed turns")
    return lines


# -- elastic follower -------------------------------------------------------------------------------------------


SPECTRUM_SPEEDS, SPECTRUM_BEYOND = 200, 2.0  # speeds of the spectrum, their range relative to the design's speed
MM = 1e3


def spectrum_speeds(
    study: Study, low: float | None = None, high: float | None = None, count: int = SPECTRUM_SPEEDS
) -> np.ndarray:
    """Evenly spaced speeds between two speeds [rpm], by default up to a multiple of the design's speed.

    Returns
    -------
    ndarray (count,) [rad/s]
    """
    top = SPECTRUM_BEYOND * abs(study.omega) / RPM if high is None else high
    return np.linspace(top / count if low is None else low, top, count) * RPM


def vibration_units(study: Study) -> tuple[tuple[str, float], ...]:
    """Units of a vibration, and their number in one unit of the motion.

    For a rotating motion, millimetres of the roller's centre (or of the contact) along its path, and degrees.
    """
    if study.program.motion.unit == "mm":
        return (("mm", MM),)
    return ("mm", study.elasticity.lever_arm * MM), ("deg", 1.0 / UNITS["deg"].factor)


def elastic_figures(study: Study) -> dict[str, Any]:
    """Figures of the elastic follower for ``summary.json``: equivalent mass, and residual vibration in each dwell.

    Infinite where every turn increases the vibration; empty where the follower is rigid, or has no solution.
    """
    try:
        elasticity, response = study.elasticity, study.follower_response
    except NoSolution:
        return {}
    middle, full_turn = elasticity.middle, 2.0 * math.pi
    swings = study.program.motion.unit == "deg"
    mass, rate = ("mass_kg_m2", "nm_per_rad") if swings else ("mass_kg", "n_per_mm")
    factor = UNITS[rate].factor
    return {
        "natural_hz": middle.natural_frequency / full_turn,
        "lowest_natural_hz": elasticity.lowest / full_turn,
        "highest_natural_hz": elasticity.highest / full_turn,
        mass: middle.mass,
        f"stiffness_{rate}": middle.stiffness / factor,
        f"closing_{rate}": middle.closing / factor,
        "damping_ratio": middle.damping_ratio,
        "periods_per_turn": middle.natural_frequency / abs(study.omega),
        "residual": [
            {
                "from_deg": math.degrees(residual.dwell.start),
                "to_deg": math.degrees(residual.dwell.end),
                **{f"from_rest_{unit}": residual.from_rest * size for unit, size in vibration_units(study)},
                **{f"steady_{unit}": residual.steady * size for unit, size in vibration_units(study)},
            }
            for residual in response.residuals
        ],
    }


def elastic_lines(study: Study) -> list[str]:
    """Natural frequency and residual vibration in each dwell; empty where the follower is rigid, or has no solution."""
    figures = elastic_figures(study)
    if not figures:
        return []
    spread = ""
    if figures["highest_natural_hz"] > 1.001 * figures["lowest_natural_hz"]:
        spread = (
            f", {digits(figures['lowest_natural_hz'])} to {digits(figures['highest_natural_hz'])} Hz over the stroke"
        )
    lines = [
        f"Natural frequency {digits(figures['natural_hz'])} Hz{spread}: {digits(figures['periods_per_turn'])} periods a turn, "
        f"damping ratio {digits(figures['damping_ratio'])}"
    ]  # fmt: skip
    if not figures["residual"]:
        return [*lines, "The motion has no dwell in which it could come to rest"]
    units = [unit for unit, _ in vibration_units(study)]
    rows: list[Sequence[str]] = [
        (
            "Vibration in the dwell",
            "to °",
            *(f"{word} {UNITS[unit].symbol}" for word in ("from rest", "steady") for unit in units),
        )
    ]
    for residual in figures["residual"]:
        values = (residual[f"{word}_{unit}"] for word in ("from_rest", "steady") for unit in units)
        rows.append(
            (
                f"from {digits(residual['from_deg'])} °",
                digits(residual["to_deg"]),
                *(digits(value) for value in values),
            )
        )
    return [*lines, *columns(rows)]


def spectrum_table(study: Study, spectrum: Spectrum) -> dict[str, np.ndarray]:
    """Columns of the spectrum: residuals of each dwell from rest and steady, then the largest |z - s| and |z̈| of both.

    Returns
    -------
    dict of str to ndarray (n,) [units in the names]
        Infinite where there is no steady response.
    """
    unit = study.program.motion.unit
    rows: dict[str, np.ndarray] = {"speed_rpm": spectrum.omega / RPM}
    for word, residual in zip(("", "steady_"), spectrum.residual, strict=True):
        for i, amplitude in enumerate(residual, 1):
            rows |= {f"{word}residual{i}_{name}": amplitude * size for name, size in vibration_units(study)}
    for word, error, acceleration in zip(("", "steady_"), spectrum.error, spectrum.acceleration, strict=True):
        scale = UNITS[unit].factor
        rows[f"{word}largest_error_{unit}"] = error / scale
        rows[f"{word}largest_acceleration_{unit}_s2"] = acceleration / scale
    return rows


def spectrum_csv(study: Study, spectrum: Spectrum) -> str:
    """Spectrum as CSV, a row for each speed; infinite values are empty."""
    table, text = spectrum_table(study, spectrum), StringIO()
    text.write(",".join(table) + "\n")
    for row in zip(*(column.tolist() for column in table.values()), strict=True):
        text.write(",".join(repr(value) if math.isfinite(value) else "" for value in row) + "\n")
    return text.getvalue()
