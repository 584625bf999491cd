"""Figures of the whole turn that the summary holds, each with its equation and its letters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING

from core.errors import NoAnswer
from core.frozen import frozen
from core.motion import TURN
from core.output.explain.letters import DYNAMICS, Letter, letter, speed_field
from core.output.summary import answers, flywheel, shaft_in_chart
from core.shaft.energy import energy_range
from core.shaft.linear import motor_inertia
from core.stress import RollerLife
from core.study import Study, roller_lives
from core.study.touching import ratings
from core.units import NO_UNIT, UNITS, Unit

if TYPE_CHECKING:  # no design without a flexible shaft loads it
    from core.stability.critical_speeds import Machine


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
    except NoAnswer:
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
    rating = ratings(study)[each.roller]
    turning = letter("n_r", "mean speed of the roller about its own axis", each.rpm * UNITS["rpm"].factor, "rpm")
    return (
        letter("C", "load rating of the roller", rating, "n", "cam.roller_load_rating_n"),
        letter("P", "equivalent load", each.load, "n"),
        turning,
    )


def _of_shaft(study: Study) -> bool:
    return study.design.listed and answers(study.camshaft)


def _rms_letters(study: Study) -> tuple[Letter, ...]:
    return (letter("M", "mean of T² over the turn, N²·m²", study.camshaft.rms_torque**2, "", DYNAMICS),)


def _power_letters(study: Study) -> tuple[Letter, ...]:
    return (letter("T", "largest torque of the shaft", study.camshaft.peaks.high.value, "nm"), _mean(study))


def _elastic(study: Study) -> bool:
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
                              lambda s: _machine(s).natural, _machine_letters, _elastic),
        "eta": Figure("Frequency ratio", NO_UNIT, "η = √(K_s/I_c)/ω̄", "Kim1990 (12)",
                      lambda s: _machine(s).eta, lambda s: (*_machine_letters(s), _mean(s)), _elastic),
    }
)  # fmt: skip
"""Name in ``summary.json`` -> its row."""

__all__ = ["FIGURES", "Figure"]
