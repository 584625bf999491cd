"""The same motion made by a cam on its shaft, with and without flywheel, and by a servo: what each asks; the motor's working points."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import degrees, pi

import numpy as np

from core.design.parts import LINEAR
from core.frozen import frozen
from core.motion import TURN
from core.motion.extremes import find_highest
from core.plot import Figure, Plot, PlotCurve
from core.study.servo import over_turn, servo_part, servo_speed, servo_torque, servo_turn
from core.study.study import Study

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
    """Those that the design has. Raises NoAnswer as the stage dynamics does."""
    if study.loads_shaft:
        yield _Way(CAM, lambda s: s.shaft_torque, lambda s: np.full(s.theta.size, s.omega))
        if study.levelled and study.flywheel.runs:
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
        there, weight = over_turn(study, way.power)
        torque, seconds = way.torque(there), weight * TURN / way.speed(there)
        rms = float(np.sqrt((torque**2 * seconds).sum() / seconds.sum()))
        given, braked = (float(np.maximum(sign * torque, 0.0) @ weight * TURN) for sign in (1.0, -1.0))
    peak, power = high["torque"], high["power"].value
    return Asked(way.name, _unit(study, way), rms, peak.value, degrees(peak.theta), power, given, braked)


def _unit(study: Study, way: _Way) -> str:
    return "N" if way.name == SERVO and servo_part(study).kind == LINEAR else "N·m"


def asked(study: Study) -> tuple[Asked, ...]:
    """By the cam, by the cam with its flywheel where there is one that the motor turns, and by the servo, of a design that has one; a
    motion that no cam makes has the servo alone. Raises NoAnswer as the stage dynamics does."""
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


__all__ = ["CAM", "LEVELLED", "SERVO", "Asked", "asked", "field_plot", "torque_figure"]
