"""How torque, speed and power of a servo's motor are worked out at one angle."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType

from core.design.parts import LINEAR
from core.output.explain.letters import MOTION, Letter, Maker, Working, first, letter, motion_unit, other
from core.shaft.servo import lever, moved
from core.study import Study
from core.study.servo import load_of, servo_part


def _gear(study: Study) -> tuple[Letter, ...]:
    servo = servo_part(study)
    slides = motion_unit(study) == "mm"
    meaning = "turning of the motor by the motion" if slides else "turns of the motor by turns of the motion"
    return (letter("i", meaning, lever(servo), "per_mm" if slides else "", "servo.gear_ratio"),)


def _speed(study: Study) -> Letter:
    speed = first(study.motion.displacement[1]) * study.omega
    return letter("ẏ", "velocity of the motion", speed, f"{motion_unit(study).replace('deg', 'rad')}_s", MOTION)


def _torque(study: Study, _: str, symbol: str) -> Working:
    servo, load = servo_part(study), load_of(study)
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
        return Working(("P_s = F_s ẏ",), (other(study, "servo_force", "F_s"), _speed(study)))
    return Working(("P_s = T_s i ẏ",), (other(study, "servo_torque", "T_s"), *_gear(study), _speed(study)))


ROWS: Mapping[str, Maker] = MappingProxyType(
    {
        "servo_torque": partial(_torque, symbol="T_s"),
        "servo_force": partial(_torque, symbol="F_s"),
        "servo_speed": lambda s, _: Working(("n_s = i ẏ",), (*_gear(s), _speed(s))),
        "servo_velocity": lambda s, _: Working(("v_s = ẏ",), (_speed(s),)),
        "servo_power": _power,
    }
)
"""Quantity -> how it is worked out."""

__all__ = ["ROWS"]
