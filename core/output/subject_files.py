"""The same motion made by a cam on its shaft, with and without flywheel, and by a servo: what each asks; the motor's working points."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from io import StringIO
from math import degrees, pi
from typing import Any

import numpy as np

from core.design import UNITS, Unit, split_unit
from core.design.parts import LINEAR
from core.dynamics import ContactMap, Flights, contact_map
from core.elastic import Spectrum
from core.errors import NoSolution
from core.frozen import frozen
from core.motion import TURN
from core.motion.extremes import find_highest
from core.output.lines import columns, digits
from core.plot import Figure, Plot, PlotCurve
from core.study import Study
from core.study.drive_forces import servo_part, servo_speed, servo_torque, servo_turn, turn_nodes

# -- the same motion made by a cam on its shaft, with and without flywheel, and by a servo ----------------------


Values = Callable[[Study], np.ndarray]
CAM, LEVELLED, SERVO = "cam", "cam_with_flywheel", "servo"
LABELS = {CAM: "Cam", LEVELLED: "Cam and flywheel", SERVO: "Servo"}
CORNERS = (
    np.array([1.0, 1.0, -1.0, -1.0, 1.0]),
    np.array([1.0, -1.0, -1.0, 1.0, 1.0]),
)  # of a field, by speed and by torque


@frozen
class Asked:
    """What one way to make the motion asks of its motor over a turn: rms and peak of the torque [unit] with the cam angle of the peak
    [deg], peak power [W], energy that the motor gives and that the load gives back to it [J]."""

    way: str
    unit: str
    rms: float
    peak: float
    peak_deg: float
    peak_power: float
    given: float
    braked: float

    @property
    def label(self) -> str:
        """For headings and legends."""
        return LABELS[self.way]


@frozen(eq=False)
class _Way:
    """Torque (n,) [N m; N], what it is multiplied with to be power (n,) [rad/s; m/s], of a study at its angles."""

    name: str
    torque: Values
    speed: Values

    def power(self, study: Study) -> np.ndarray:
        return self.torque(study) * self.speed(study)


def _ways(study: Study) -> Iterator[_Way]:
    """Those that the design has. Raises NoSolution as the stage dynamics does."""
    if study.loads_shaft:
        yield _Way(CAM, lambda s: s.shaft_torque, lambda s: np.full(s.theta.size, s.omega))
        if study.levels_torque and study.flywheel.runs:
            wheel = study.flywheel
            yield _Way(LEVELLED, lambda s: wheel.motor_torque(s.angles), lambda s: wheel.speed(s.angles))
    yield _Way(SERVO, servo_torque, servo_speed)


def _asked(study: Study, way: _Way) -> Asked:
    def sizes(angles: object) -> dict[str, np.ndarray]:
        there = study.at(angles)  # type: ignore[arg-type]
        return {"torque": np.abs(way.torque(there)), "power": np.abs(way.power(there))}

    high = find_highest(sizes, study.program)
    if way.name == SERVO:
        turn = servo_turn(study)
        rms, given, braked = turn.rms, turn.given, turn.braked
    else:
        there, weight = turn_nodes(study, way.power)
        torque, seconds = way.torque(there), weight * TURN / way.speed(there)
        rms = float(np.sqrt((torque**2 * seconds).sum() / seconds.sum()))
        given, braked = (float(np.maximum(sign * torque, 0.0) @ weight * TURN) for sign in (1.0, -1.0))
    peak, power = high["torque"], high["power"].value
    return Asked(way.name, _unit(study, way), rms, peak.value, degrees(peak.theta), power, given, braked)


def _unit(study: Study, way: _Way) -> str:
    return "N" if way.name == SERVO and servo_part(study).kind == LINEAR else "N·m"


def asked(study: Study) -> tuple[Asked, ...]:
    """By the cam, by the cam with its flywheel where there is one that the motor turns, and by the servo, of a design that has one; a
    motion that no cam makes has the servo alone. Raises NoSolution as the stage dynamics does."""
    return tuple(_asked(study, way) for way in _ways(study))


def torque_figure(study: Study, found: tuple[Asked, ...]) -> Figure:
    """Torque over the cam angle of all ways, with the peak and rms of each; a linear motor's force has a plot of its own."""
    x = np.append(study.angle_degrees, 360.0)
    plots: dict[str, list[PlotCurve]] = {}
    for i, (way, each) in enumerate(zip(_ways(study), found, strict=True)):
        values = way.torque(study)
        label = f"{each.label}: peak {each.peak:.4g}, rms {each.rms:.4g}"
        plots.setdefault(each.unit, []).append(PlotCurve(x, np.append(values, values[0]), label, i))
    return Figure(
        "cam_or_servo",
        "Cam or servo",
        tuple(
            Plot("Cam angle, °", f"{'Force' if unit == 'N' else 'Torque'}, {unit}", tuple(curves))
            for unit, curves in plots.items()
        ),
    )


def field_plot(study: Study, rms: float) -> Plot:
    """The working points of the servo's motor over a turn, torque over speed, within its peak and its rated torque up to its rated
    speed; rms: of the torque, which the rated one bears."""
    servo = servo_part(study)
    linear = servo.kind == LINEAR
    speed, torque = servo_speed(study) * (1e3 if linear else 30.0 / pi), servo_torque(study)
    fastest, most = float(np.abs(speed).max()), float(np.abs(torque).max())
    width = servo.rated_rpm or fastest
    fields = [("Peak torque", servo.peak_torque_nm, 1), ("Rated torque", servo.rated_torque_nm, 2)]
    if servo.peak_torque_nm is None and servo.rated_torque_nm is None and servo.rated_rpm is not None:
        fields = [("Rated speed", most, 1)]
    edges = tuple(
        PlotCurve(width * CORNERS[0], limit * CORNERS[1], label, row, dashed=True)
        for label, limit, row in fields
        if limit is not None
    )
    loop = PlotCurve(np.append(speed, speed[0]), np.append(torque, torque[0]), "Working points")
    level = PlotCurve(fastest * CORNERS[0], rms * CORNERS[1], f"rms {rms:.4g}", 3, dashed=True)
    across, upwards = ("Speed, mm/s", "Force, N") if linear else ("Motor speed, rpm", "Motor torque, N·m")
    return Plot(across, upwards, (loop, level, *edges))


# -- keeping contact as text and as a table ---------------------------------------------------------------------


CONTACT_RPM = math.pi / 30.0
CONTACT_SPEEDS, CONTACT_BEYOND = (
    40,
    1.5,
)  # of the map: how many, and up to which multiple of the design's speed or of that of lift-off


def map_of(study: Study, theta: np.ndarray, top_rpm: float | None = None, speeds: int = CONTACT_SPEEDS) -> ContactMap:
    """The contact force at cam angles (n,) [rad] and evenly spaced speeds up to one, usually somewhat above those that matter. Raises
    NoSolution where there is no contact force that could be lost."""
    return contact_map(
        study.contact_force, theta, np.linspace(0.0, CONTACT_RPM * (top_rpm or usual_top(study)), speeds + 1)[1:]
    )


def usual_top(study: Study) -> float:
    """The highest speed of the map [rpm]."""
    found, own = study.lift_off, abs(study.omega) / CONTACT_RPM
    most = own if found is None else max(own, min(found.omega / CONTACT_RPM, 4.0 * own))
    return float(f"{CONTACT_BEYOND * most:.2g}")


def map_csv(found: ContactMap) -> str:
    """Rows of cam angle, speed and contact force, speed by speed."""
    text = StringIO()
    text.write("cam_angle_deg,speed_rpm,contact_force_n\n")
    angles = [repr(x) for x in np.rad2deg(found.theta).tolist()]
    for speed, row in zip((found.omega / CONTACT_RPM).tolist(), found.force.tolist(), strict=True):
        for angle, force in zip(angles, row, strict=True):
            text.write(f"{angle},{speed!r},{force!r}\n")
    return text.getvalue()


def lift_off_lines(study: Study) -> list[str]:
    """The speed from which the follower leaves the cam, in one line; none where it cannot leave it."""
    try:
        found = study.lift_off
    except NoSolution:
        return []
    if found is None:
        return ["The follower stays on the cam at any speed"]
    if not found.omega:
        return [
            f"The follower is not pressed on the cam at {digits(math.degrees(found.theta))}°, even where the shaft stands still"
        ]
    return [
        f"The follower leaves the cam from {digits(found.omega / CONTACT_RPM)} rpm on, at cam angle {digits(math.degrees(found.theta))}°"
    ]


def flight_lines(study: Study, found: Flights) -> list[str]:
    """The flights as a table, and whether they repeat."""
    if not found.flights:
        return ["It does not fly at the design's speed"]
    unit = UNITS[study.program.motion.unit]
    rows: list[Sequence[str]] = [
        ("Flight", "leaves at °", "lands at °", f"height {unit.symbol}", f"lands with {unit.symbol}/s")
    ]
    for i, one in enumerate(found.flights, 1):
        ends = [digits(math.degrees(x)) if math.isfinite(x) else "not" for x in (one.lift, one.land)]
        rows.append((str(i), *ends, digits(one.height / unit.factor), digits(one.speed / unit.factor)))
    lines = columns(rows)
    if found.steady:
        again = "every turn" if found.turns == 1 else f"every {found.turns} turns"
        lines.append(f"From flight {found.repeats + 1} on they repeat {again}")
    else:
        lines.append("They do not repeat within the turns that were followed")
    return lines


# -- the elastic follower as text, as figures and as a table ----------------------------------------------------


SPECTRUM_RPM = UNITS["rpm"].factor
SPECTRUM_SPEEDS, SPECTRUM_BEYOND = 200, 2.0  # of the spectrum: how many, and up to which multiple of the design's speed
MM = 1e3


def speeds_of(
    study: Study, low: float | None = None, high: float | None = None, count: int = SPECTRUM_SPEEDS
) -> np.ndarray:
    """Evenly spaced speeds (count,) [rad/s] between two [rpm]; where these are not given up to a multiple of the design's."""
    top = SPECTRUM_BEYOND * abs(study.omega) / SPECTRUM_RPM if high is None else high
    return np.linspace(top / count if low is None else low, top, count) * SPECTRUM_RPM


def units_of(study: Study) -> tuple[tuple[str, float], ...]:
    """Units in which a vibration is read, each with what one unit of the motion is in it: millimetres; where the motion turns those of
    the roller's centre (or of the contact) along its path, and degrees too."""
    if study.program.motion.unit == "mm":
        return (("mm", MM),)
    return ("mm", study.elasticity.lever_arm * MM), ("deg", 1.0 / UNITS["deg"].factor)


def elastic_rows(study: Study) -> dict[str, Any]:
    """The figures of ``summary.json``: the one mass, and its residual vibration in each dwell; infinite where every turn adds to it.
    Empty where the follower is rigid, or has no answer."""
    try:
        found, response = study.elasticity, study.follower_response
    except NoSolution:
        return {}
    one, turns = found.middle, 2.0 * math.pi
    swings = study.program.motion.unit == "deg"
    mass, rate = ("mass_kg_m2", "nm_per_rad") if swings else ("mass_kg", "n_per_mm")
    factor = UNITS[rate].factor
    return {
        "natural_hz": one.natural_frequency / turns,
        "lowest_natural_hz": found.lowest / turns,
        "highest_natural_hz": found.highest / turns,
        mass: one.mass,
        f"stiffness_{rate}": one.stiffness / factor,
        f"closing_{rate}": one.closing / factor,
        "damping_ratio": one.damping_ratio,
        "periods_per_turn": one.natural_frequency / abs(study.omega),
        "residual": [
            {
                "from_deg": math.degrees(each.dwell.start),
                "to_deg": math.degrees(each.dwell.end),
                **{f"from_rest_{unit}": each.from_rest * size for unit, size in units_of(study)},
                **{f"steady_{unit}": each.steady * size for unit, size in units_of(study)},
            }
            for each in response.residuals
        ],
    }


def elastic_lines(study: Study) -> list[str]:
    """Natural frequency, and the residual vibration in each dwell; none where the follower is rigid, or has no answer."""
    figures = elastic_rows(study)
    if not figures:
        return []
    spread = ""
    if figures["highest_natural_hz"] > 1.001 * figures["lowest_natural_hz"]:
        spread = f", {digits(figures['lowest_natural_hz'], 4)} to {digits(figures['highest_natural_hz'], 4)} Hz over the stroke"
    lines = [
        f"Natural frequency {digits(figures['natural_hz'], 5)} Hz{spread}: {digits(figures['periods_per_turn'], 4)} periods a turn, "
        f"damping ratio {digits(figures['damping_ratio'], 4)}"
    ]  # fmt: skip
    if not figures["residual"]:
        return [*lines, "The motion has no dwell in which it could come to rest"]
    units = [unit for unit, _ in units_of(study)]
    rows: list[Sequence[str]] = [
        (
            "Vibration in the dwell",
            "to °",
            *(f"{word} {UNITS[unit].symbol}" for word in ("from rest", "steady") for unit in units),
        )
    ]
    for each in figures["residual"]:
        values = (each[f"{word}_{unit}"] for word in ("from_rest", "steady") for unit in units)
        rows.append(
            (f"from {digits(each['from_deg'])} °", digits(each["to_deg"]), *(digits(value, 4) for value in values))
        )
    return [*lines, *columns(rows)]


def spectrum_table(study: Study, found: Spectrum) -> dict[str, np.ndarray]:
    """The spectrum by columns, in their units: per dwell the residual from rest and steady, then the largest |z - s| and |z̈| of
    both; infinite where there is no steady response."""
    unit = study.program.motion.unit
    rows: dict[str, np.ndarray] = {"speed_rpm": found.omega / SPECTRUM_RPM}
    for word, residual in zip(("", "steady_"), found.residual, strict=True):
        for i, amplitude in enumerate(residual, 1):
            rows |= {f"{word}residual{i}_{name}": amplitude * size for name, size in units_of(study)}
    for word, error, acceleration in zip(("", "steady_"), found.error, found.acceleration, strict=True):
        scale = UNITS[unit].factor
        rows[f"{word}largest_error_{unit}"] = error / scale
        rows[f"{word}largest_acceleration_{unit}_s2"] = acceleration / scale
    return rows


def unit_of(column: str) -> Unit:
    """The unit of a column."""
    return split_unit(column)[1]


def spectrum_csv(study: Study, found: Spectrum) -> str:
    """A row for each speed; a figure that is not finite is left empty."""
    table, text = spectrum_table(study, found), StringIO()
    text.write(",".join(table) + "\n")
    for row in zip(*(column.tolist() for column in table.values()), strict=True):
        text.write(",".join(repr(value) if math.isfinite(value) else "" for value in row) + "\n")
    return text.getvalue()
