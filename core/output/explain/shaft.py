"""Figures of the whole turn, and columns of a shaft with several drives, as they are explained."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from core.design import UNITS
from core.frozen import frozen
from core.motion.extremes import Extreme, Extremes
from core.output.explain.workings import Calculation, motor_torque, shaft_speed
from core.study import Camshaft, Study, names_of, roller_lives
from core.study.camshaft import has_speed, is_complete
from core.study.force_formulas import has_finite_life
from core.study.formulas import FORMULAS
from core.study.symbols import DYNAMICS, first, letter
from core.units import NO_UNIT, Unit

# -- figures of the whole turn --------------------------------------------------------------------------------


@frozen
class Figure:
    """A figure of the summary: its name in words, unit and value in SI units; its formula is the row of that name in ``FORMULAS``."""

    label: str
    unit: Unit
    value: Callable[[Study], float]


def has_figure(study: Study, name: str) -> bool:
    """Whether a design has this figure of the whole turn."""
    if name not in FIGURES:
        return False
    if name == "life_hours":
        return not study.design.listed and study.has_disk and has_finite_life(study, ())
    when = FORMULAS[name].when
    return when is None or when(study, () if study.design.listed else names_of(study.design))


def _machine(name: str) -> Callable[[Study], float]:
    def value(study: Study) -> float:
        assert study.stability is not None
        return float(getattr(study.stability.machine, name))

    return value


_KG, _NM, _J, _RPM = (UNITS[key] for key in ("kg_m2", "nm", "j", "rpm"))
FIGURES: Mapping[str, Figure] = MappingProxyType(
    {
        "mean_torque_nm": Figure("Mean torque", _NM, lambda s: s.flywheel.mean_torque),
        "energy_swing_j": Figure("Swing of energy", _J, lambda s: s.flywheel.energy_swing),
        "needed_inertia_kg_m2": Figure("Flywheel needed", _KG, lambda s: s.flywheel.needed_inertia),
        "estimated_inertia_kg_m2": Figure("Flywheel, estimate", _KG, lambda s: s.flywheel.estimated_inertia),
        "fluctuation": Figure("Fluctuation of speed", NO_UNIT, lambda s: s.flywheel.fluctuation),
        "min_speed_rpm": Figure("Lowest speed", _RPM, lambda s: s.flywheel.speed_range[0]),
        "max_speed_rpm": Figure("Highest speed", _RPM, lambda s: s.flywheel.speed_range[1]),
        "life_hours": Figure("Rolling life L10", NO_UNIT, lambda s: min(life.hours for life in roller_lives(s))),
        "rms_nm": Figure("Root mean square of the shaft's torque", _NM, lambda s: s.camshaft.rms_torque),
        "peak_power_w": Figure("Peak power of the shaft", UNITS["w"], lambda s: s.camshaft.peak_power),
        "natural_rpm": Figure("Natural frequency of the shaft", _RPM, _machine("natural")),
        "eta": Figure("Frequency ratio", NO_UNIT, _machine("eta")),
    }
)
"""Name in ``summary.json`` -> its row."""


# -- columns of a shaft with several drives ---------------------------------------------------------------------


SHAFT_TORQUE, BALANCER_TORQUE = "torque_nm", "balancer_torque_nm"
MOTOR_TORQUE, SHAFT_SPEED = "motor_torque_nm", "speed_rpm"


@frozen
class ShaftColumn:
    """A column of ``shaft.csv``: its label, unit, values in SI units, greatest value and calculation."""

    label: str
    unit: Unit
    values: Callable[[Camshaft[Study]], np.ndarray]
    largest: Callable[[Camshaft[Study]], Extreme]
    calculation: Callable[[Camshaft[Study]], Calculation]


def shaft_columns(study: Study) -> Mapping[str, ShaftColumn]:
    """Name -> column of ``shaft.csv``."""
    rows = {name: shaft_column(study, name) for name in _shaft_names(study.camshaft)}
    return {name: row for name, row in rows.items() if row is not None}


def _shaft_names(camshaft: Camshaft[Study]) -> tuple[str, ...]:
    """Names of the columns of a shaft all of whose drives have a solution, in their order."""
    drives = (f"{camshaft.slugs[name]}_torque_nm" for name in camshaft.loading_drives)
    balancer = () if camshaft.design.balancer is None else (BALANCER_TORQUE,)
    return (SHAFT_TORQUE, *drives, *balancer, MOTOR_TORQUE, SHAFT_SPEED)


def shaft_column(study: Study, name: str) -> ShaftColumn | None:
    """The column of a name; None where ``shaft.csv`` lacks it. Computes only what this column depends on."""
    camshaft, torque = study.camshaft, UNITS["nm"]
    if name not in _shaft_names(camshaft):
        return None
    if name in (MOTOR_TORQUE, SHAFT_SPEED):
        if not has_speed(camshaft):
            return None
        if name == SHAFT_SPEED:
            return ShaftColumn(
                "Speed of the shaft", UNITS["rpm"], lambda position: position.speed,
                lambda shaft: _greatest(shaft.motor_range["speed"]), lambda position: _speed(study, position)
            )  # fmt: skip
        return ShaftColumn(
            "Torque of the motor", torque, lambda position: position.motor_torque,
            lambda shaft: _greatest(shaft.motor_range["motor_torque"]), lambda position: _motor(study, position)
        )  # fmt: skip
    for drive in camshaft.loading_drives:
        if name == f"{camshaft.slugs[drive]}_torque_nm":
            return None if drive in camshaft.failures else _drive(drive)
    if not is_complete(camshaft):
        return None
    if name == BALANCER_TORQUE:
        return ShaftColumn(
            "Torque of the balance cam",
            torque,
            lambda position: position.balancer_torque,
            _balancer_peak,
            _sum([], True),
        )
    drives, has_balancer = list(camshaft.loading_drives), camshaft.design.balancer is not None
    return ShaftColumn(
        "Torque of the shaft",
        torque,
        lambda position: position.torque,
        lambda shaft: shaft.peak_torque,
        _sum(drives, has_balancer),
    )


def _greatest(extremes: Extremes) -> Extreme:
    return max((extremes.low, extremes.high), key=lambda end: abs(end.value))


def _balancer_peak(camshaft: Camshaft[Study]) -> Extreme:
    peak = camshaft.balancer_peak
    return Extreme(peak.value, float(camshaft.balancer_position.machine_angle(np.array(peak.theta))))


def _drive(name: str) -> ShaftColumn:
    return ShaftColumn(
        f"Torque of {name}",
        UNITS["nm"],
        lambda position: position.drive_torque(name),
        lambda shaft: shaft.drive_peak(name),
        _sum([name], False),
    )


def _sum(drives: list[str], has_balancer: bool) -> Callable[[Camshaft[Study]], Calculation]:
    """Calculation of a sum of torques of drives and of the balance cam."""

    def calculation(position: Camshaft[Study]) -> Calculation:
        parts = [
            letter(f"T_{i}", f"torque of {name}", first(position.drive_torque(name)), "nm")
            for i, name in enumerate(drives, 1)
        ]
        if has_balancer:
            parts.append(letter("T_b", "torque of the balance cam", first(position.balancer_torque), "nm"))
        return Calculation((f"T = {' + '.join(part.symbol for part in parts)}",), tuple(parts))

    return calculation


def _motor(study: Study, position: Camshaft[Study]) -> Calculation:
    if not position.levels_torque:
        return Calculation(("T_m = T",), (letter("T", "torque of the shaft", first(position.torque), "nm", DYNAMICS),))
    return motor_torque(study, position.flywheel.mean_torque, first(position.speed))


def _speed(study: Study, position: Camshaft[Study]) -> Calculation:
    torques = (position.flywheel.mean_torque, first(position.motor_torque)) if position.levels_torque else None
    return shaft_speed(study, first(position.speed), torques)
