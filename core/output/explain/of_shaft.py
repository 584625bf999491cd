"""How the columns of a shaft with several drives are worked out at one machine angle."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from core.design import UNITS
from core.frozen import frozen
from core.motion.extremes import Extreme, Range
from core.output.explain.letters import DYNAMICS, Working, first, letter
from core.output.explain.of_forces import motor_torque, shaft_speed
from core.output.summary import answers, runs
from core.study import Camshaft, Study
from core.units import Unit


@frozen
class ShaftColumn:
    """One column of ``shaft.csv``: its name in words, unit, values [SI], largest value and calculation."""

    label: str
    unit: Unit
    values: Callable[[Camshaft[Study]], np.ndarray]
    largest: Callable[[Camshaft[Study]], Extreme]
    working: Callable[[Camshaft[Study]], Working]


def shaft_columns(study: Study) -> Mapping[str, ShaftColumn]:
    """Name -> column, of those that this shaft has."""
    camshaft, torque = study.camshaft, UNITS["nm"]
    drives = [name for name in camshaft.carried if name not in camshaft.failures]
    balanced = camshaft.design.balancer is not None
    rows: dict[str, ShaftColumn] = {}
    if answers(camshaft):
        rows["torque_nm"] = ShaftColumn(
            "Torque of the shaft",
            torque,
            lambda there: there.torque,
            lambda shaft: shaft.peak_torque,
            _sum(drives, balanced),
        )
    for name in drives:
        rows[f"{camshaft.slugs[name]}_torque_nm"] = _drive(name)
    if "torque_nm" in rows and balanced:
        rows["balancer_torque_nm"] = ShaftColumn(
            "Torque of the balance cam", torque, lambda there: there.balancer_torque, _balancer_peak, _sum([], True)
        )
    if runs(camshaft):
        rows["motor_torque_nm"] = ShaftColumn(
            "Torque of the motor", torque, lambda there: there.motor_torque,
            lambda shaft: _greatest(shaft.motor_range["motor_torque"]), lambda there: _motor(study, there)
        )  # fmt: skip
        rows["speed_rpm"] = ShaftColumn(
            "Speed of the shaft", UNITS["rpm"], lambda there: there.speed,
            lambda shaft: _greatest(shaft.motor_range["speed"]), lambda there: _speed(study, there)
        )  # fmt: skip
    return rows


def _greatest(extremes: Range) -> Extreme:
    return max((extremes.low, extremes.high), key=lambda end: abs(end.value))


def _balancer_peak(camshaft: Camshaft[Study]) -> Extreme:
    peak = camshaft.balancer_peak
    return Extreme(peak.value, float(camshaft.balancer_place.machine(np.array(peak.theta))))


def _drive(name: str) -> ShaftColumn:
    return ShaftColumn(
        f"Torque of {name}",
        UNITS["nm"],
        lambda there: there.drive_torque(name),
        lambda shaft: shaft.drive_peak(name),
        _sum([name], False),
    )


def _sum(drives: list[str], balanced: bool) -> Callable[[Camshaft[Study]], Working]:
    """The torques of drives, and of the balance cam."""

    def working(there: Camshaft[Study]) -> Working:
        parts = [
            letter(f"T_{i}", f"torque of {name} there", first(there.drive_torque(name)), "nm")
            for i, name in enumerate(drives, 1)
        ]
        if balanced:
            parts.append(letter("T_b", "torque of the balance cam there", first(there.balancer_torque), "nm"))
        return Working((f"T = {' + '.join(part.symbol for part in parts)}",), tuple(parts))

    return working


def _motor(study: Study, there: Camshaft[Study]) -> Working:
    if not there.levelled:
        return Working(("T_m = T",), (letter("T", "torque of the shaft there", first(there.torque), "nm", DYNAMICS),))
    return motor_torque(study, there.flywheel.mean_torque, first(there.speed))


def _speed(study: Study, there: Camshaft[Study]) -> Working:
    torques = (there.flywheel.mean_torque, first(there.motor_torque)) if there.levelled else None
    return shaft_speed(study, first(there.speed), torques)


__all__ = ["ShaftColumn", "shaft_columns"]
