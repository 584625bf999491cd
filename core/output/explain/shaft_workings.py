"""Figures of the whole turn that the summary holds, each with its equation and its letters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from core.design import UNITS
from core.design.parts import LINEAR
from core.errors import NoSolution
from core.frozen import frozen
from core.motion import TURN
from core.motion.extremes import Extreme, Extremes
from core.output.explain.force_workings import motor_torque, shaft_speed
from core.output.explain.letters import (
    DYNAMICS,
    MOTION,
    Letter,
    Maker,
    Working,
    first,
    letter,
    motion_unit,
    other,
    speed_field,
)
from core.output.summary import flywheel
from core.shaft.flywheel import energy_range, motor_inertia
from core.shaft.speed import lever, moved
from core.stress import RollerLife
from core.study import Camshaft, Study, roller_lives
from core.study.camshaft import has_speed, is_complete
from core.study.drive_forces import load_ratings, servo_load, servo_part
from core.study.study import shaft_in_chart
from core.units import NO_UNIT, Unit

if TYPE_CHECKING:
    from core.stability.critical_speeds import Machine


# -- figures of the whole turn that the summary holds, each with its equation and its letters -------------------


@frozen
class Figure:
    """One row: in words, unit, equation, source; its value in SI units, its letters, and whether a design has it."""

    label: str
    unit: Unit
    line: str
    source: str
    value: Callable[[Study], float]
    letters: Callable[[Study], tuple[Letter, ...]]
    exists: Callable[[Study], bool]


def _wheel(study: Study) -> bool:
    try:
        return bool(flywheel(study))
    except NoSolution:
        return False


def _runs(study: Study) -> bool:
    return _wheel(study) and study.flywheel.runs


def _mean(study: Study) -> Letter:
    return letter("ω̄", "mean speed", study.omega, "rad_s", speed_field(study))


def _fluctuation(study: Study) -> Letter:
    wanted = float(study.design.camshaft.speed_fluctuation)
    return letter("C_s", "fluctuation of speed wanted", wanted, "", "shaft.speed_fluctuation")


def _speeds(study: Study) -> tuple[Letter, ...]:
    low, high = study.flywheel.speed_range
    names = (("ω_M", "highest speed", high), ("ω_m", "lowest speed", low))
    return (*(letter(symbol, meaning, value, "rad_s", DYNAMICS) for symbol, meaning, value in names), _mean(study))


def _energy(study: Study) -> tuple[Letter, ...]:
    low, high = energy_range(study.flywheel.load)
    work = "of the work of T - T̄ over the turn, ∫(T - T̄) dθ"
    return (letter("W_M", f"greatest {work}", high, "j"), letter("W_m", f"least {work}", low, "j"))


def _estimate(study: Study) -> tuple[Letter, ...]:
    own = letter(
        "I_m",
        "inertia of the motor at the shaft",
        motor_inertia(study.flywheel.shaft),
        "kg_m2",
        "shaft.motor_inertia_kg_m2",
    )
    swing = letter("ΔE", "swing of energy", study.flywheel.energy_swing, "j")
    return (swing, _fluctuation(study), _mean(study), own)


def _needed(study: Study) -> tuple[Letter, ...]:
    wheel = study.flywheel
    own = motor_inertia(wheel.shaft)
    whole = letter(
        "I_C", "least inertia with which (ω_M - ω_m)/ω̄ of the true speed is C_s", wheel.needed_inertia + own, "kg_m2"
    )
    return (whole, letter("I_m", "inertia of the motor at the shaft", own, "kg_m2", "shaft.motor_inertia_kg_m2"))


def _mean_torque(study: Study) -> tuple[Letter, ...]:
    return (letter("W", "work of the turn", study.flywheel.mean_torque * TURN, "j"),)


def _has_life(study: Study) -> bool:
    return (
        not study.design.listed and "cam" in study.stages and bool(roller_lives(study)) and isfinite(_life(study).hours)
    )


def _life(study: Study) -> RollerLife:
    """Of the roller that lives shortest."""
    return min(roller_lives(study), key=lambda each: each.hours)


def _life_letters(study: Study) -> tuple[Letter, ...]:
    each = _life(study)
    rating = load_ratings(study)[each.roller]
    turning = letter("n_r", "mean speed of the roller about its own axis", each.rpm * UNITS["rpm"].factor, "rpm")
    return (
        letter("C", "load rating of the roller", rating, "n", "cam.roller_load_rating_n"),
        letter("P", "equivalent load", each.load, "n"),
        turning,
    )


def _of_shaft(study: Study) -> bool:
    return study.design.listed and is_complete(study.camshaft)


def _rms_letters(study: Study) -> tuple[Letter, ...]:
    return (letter("M", "mean of T² over the turn, N²·m²", study.camshaft.rms_torque**2, "", DYNAMICS),)


def _power_letters(study: Study) -> tuple[Letter, ...]:
    return (letter("T", "largest torque of the shaft", study.camshaft.peaks.high.value, "nm"), _mean(study))


def _is_elastic(study: Study) -> bool:
    elastic = study.design.shaft.elastic if study.design.shaft is not None else None
    return elastic is not None and shaft_in_chart(study) is not None


def _machine(study: Study) -> Machine:
    assert study.stability is not None
    return study.stability.machine


def _machine_letters(study: Study) -> tuple[Letter, ...]:
    machine = _machine(study)
    return (
        letter("K_s", "stiffness of the shaft", machine.stiffness, "nm_per_rad", "shaft.stiffness_nm_per_rad"),
        letter("I_c", "inertia of the camshaft", machine.camshaft_inertia, "kg_m2", "shaft.camshaft_inertia_kg_m2"),
    )


_KG, _NM, _J, _RPM = (UNITS[key] for key in ("kg_m2", "nm", "j", "rpm"))
_SIZING = "sizing by the true speed; textbook's estimate by the energy of the turn"
FIGURES: Mapping[str, Figure] = MappingProxyType(
    {
        "mean_torque_nm": Figure("Mean torque", _NM, "T̄ = W/(2 π)", "definition",
                                 lambda s: s.flywheel.mean_torque, _mean_torque, _wheel),
        "energy_swing_j": Figure("Swing of energy", _J, "ΔE = W_M - W_m", _SIZING,
                                 lambda s: s.flywheel.energy_swing, _energy, _wheel),
        "needed_inertia_kg_m2": Figure("Flywheel needed", _KG, "I = I_C - I_m", _SIZING,
                                       lambda s: s.flywheel.needed_inertia, _needed, _wheel),
        "estimated_inertia_kg_m2": Figure("Flywheel, estimate", _KG, "I = max(ΔE/(C_s ω̄²) - I_m, 0)", _SIZING,
                                          lambda s: s.flywheel.estimated_inertia, _estimate, _wheel),
        "fluctuation": Figure("Fluctuation of speed", NO_UNIT, "C = (ω_M - ω_m)/ω̄", _SIZING,
                              lambda s: s.flywheel.fluctuation, _speeds, _runs),
        "min_speed_rpm": Figure("Lowest speed", _RPM, "n = ω_m", _SIZING,
                                lambda s: s.flywheel.speed_range[0], lambda s: _speeds(s)[1:2], _runs),
        "max_speed_rpm": Figure("Highest speed", _RPM, "n = ω_M", _SIZING,
                                lambda s: s.flywheel.speed_range[1], lambda s: _speeds(s)[:1], _runs),
        "life_hours": Figure("Rolling life L10", NO_UNIT, "L = 3600^(-1) (C/P)^(10/3) 10^6 2 π/n_r", "ISO 281",
                             lambda s: _life(s).hours, _life_letters, _has_life),
        "rms_nm": Figure("Root mean square of the shaft's torque", _NM, "T_r = √M", "definition",
                         lambda s: s.camshaft.rms_torque, _rms_letters, _of_shaft),
        "peak_power_w": Figure("Peak power of the shaft", UNITS["w"], "P = T ω̄", "definition",
                               lambda s: s.camshaft.peak_power, _power_letters, _of_shaft),
        "natural_rpm": Figure("Natural frequency of the shaft", _RPM, "n_s = √(K_s/I_c)", "Kim1990",
                              lambda s: _machine(s).natural, _machine_letters, _is_elastic),
        "eta": Figure("Frequency ratio", NO_UNIT, "η = √(K_s/I_c)/ω̄", "Kim1990 (12)",
                      lambda s: _machine(s).eta, lambda s: (*_machine_letters(s), _mean(s)), _is_elastic),
    }
)  # fmt: skip
"""Name in ``summary.json`` -> its row."""


# -- how torque, speed and power of a servo's motor are worked out at one angle ---------------------------------


def _gear(study: Study) -> tuple[Letter, ...]:
    servo = servo_part(study)
    slides = motion_unit(study) == "mm"
    meaning = "turning of the motor by the motion" if slides else "turns of the motor by turns of the motion"
    return (letter("i", meaning, lever(servo), "per_mm" if slides else "", "servo.gear_ratio"),)


def _servo_speed(study: Study) -> Letter:
    speed = first(study.motion.displacement[1]) * study.omega
    return letter("ẏ", "velocity of the motion", speed, f"{motion_unit(study).replace('deg', 'rad')}_s", MOTION)


def _torque(study: Study, _: str, symbol: str) -> Working:
    servo, load = servo_part(study), servo_load(study)
    force, mass, rate = ("n", "kg", "mm_s2") if motion_unit(study) == "mm" else ("nm", "kg_m2", "rad_s2")
    losses = "losses of the gear: 1/η where it drives the load, η where the load drives it"
    letters = (
        letter("F", "what loads and masses ask of the motion", first(load.load), force),
        letter("m", "what the servo moves besides", moved(servo), mass, "servo"),
        letter("ÿ", "acceleration of the motion", first(load.acceleration), rate, MOTION),
        letter("F_r", "friction of the servo's own", first(load.friction), force, "servo"),
        letter("k", losses, first(load.losses), "", "servo.efficiency"),
    )
    if servo.kind == LINEAR:
        return Working((f"{symbol} = (F + m ÿ + F_r) k",), letters)
    rotor = letter("J_r", "inertia of the rotor", servo.rotor_inertia_kg_m2, "kg_m2", "servo.rotor_inertia_kg_m2")
    return Working((f"{symbol} = J_r i ÿ + (F + m ÿ + F_r) k/i",), (rotor, *_gear(study), *letters))


def _power(study: Study, _: str) -> Working:
    if servo_part(study).kind == LINEAR:
        return Working(("P_s = F_s ẏ",), (other(study, "servo_force", "F_s"), _servo_speed(study)))
    return Working(("P_s = T_s i ẏ",), (other(study, "servo_torque", "T_s"), *_gear(study), _servo_speed(study)))


SERVO_ROWS: Mapping[str, Maker] = MappingProxyType(
    {
        "servo_torque": partial(_torque, symbol="T_s"),
        "servo_force": partial(_torque, symbol="F_s"),
        "servo_speed": lambda s, _: Working(("n_s = i ẏ",), (*_gear(s), _servo_speed(s))),
        "servo_velocity": lambda s, _: Working(("v_s = ẏ",), (_servo_speed(s),)),
        "servo_power": _power,
    }
)
"""Quantity -> how it is worked out."""


# -- how the columns of a shaft with several drives are worked out at one machine angle -------------------------


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
    drives = [name for name in camshaft.loading_drives if name not in camshaft.failures]
    balanced = camshaft.design.balancer is not None
    rows: dict[str, ShaftColumn] = {}
    if is_complete(camshaft):
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
    if has_speed(camshaft):
        rows["motor_torque_nm"] = ShaftColumn(
            "Torque of the motor", torque, lambda there: there.motor_torque,
            lambda shaft: _greatest(shaft.motor_range["motor_torque"]), lambda there: _motor(study, there)
        )  # fmt: skip
        rows["speed_rpm"] = ShaftColumn(
            "Speed of the shaft", UNITS["rpm"], lambda there: there.speed,
            lambda shaft: _greatest(shaft.motor_range["speed"]), lambda there: _speed(study, there)
        )  # fmt: skip
    return rows


def _greatest(extremes: Extremes) -> Extreme:
    return max((extremes.low, extremes.high), key=lambda end: abs(end.value))


def _balancer_peak(camshaft: Camshaft[Study]) -> Extreme:
    peak = camshaft.balancer_peak
    return Extreme(peak.value, float(camshaft.balancer_position.machine_angle(np.array(peak.theta))))


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
    if not there.levels_torque:
        return Working(("T_m = T",), (letter("T", "torque of the shaft there", first(there.torque), "nm", DYNAMICS),))
    return motor_torque(study, there.flywheel.mean_torque, first(there.speed))


def _speed(study: Study, there: Camshaft[Study]) -> Working:
    torques = (there.flywheel.mean_torque, first(there.motor_torque)) if there.levels_torque else None
    return shaft_speed(study, first(there.speed), torques)
