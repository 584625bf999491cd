"""A servo motor that makes a motion through a gear: its torque, what it takes over a turn, and its best ratio."""

from __future__ import annotations

import math

import numpy as np

from core.design.parts import LINEAR, Servo
from core.frozen import frozen


def lever(servo: Servo) -> float:
    """Motor turns per unit of the motion, as radians per radian or per metre; 1 of a linear motor."""
    return servo.gear_ratio * shaft_lever(servo)


def shaft_lever(servo: Servo) -> float:
    """The same of the output shaft."""
    if servo.kind == LINEAR or servo.travel_mm_per_turn is None:
        return 1.0
    return 2.0 * math.pi / (servo.travel_mm_per_turn * 1e-3)


def moved(servo: Servo) -> float:
    """What the servo moves besides the loads, at the motion [kg or kg m²]."""
    return (servo.mass_kg or 0.0) + (servo.inertia_kg_m2 or 0.0) * shaft_lever(servo) ** 2


@frozen(eq=False)
class MotorLoad:
    """What a motion asks of a motor.

    speed, acceleration  (n,) of the motion by time [m or rad]
    load, friction  (n,) on it, of the design's loads and masses, and of the servo's own friction [N or N m]
    losses  (n,) of the gear, by which force is more than they and the mass of the servo's own ask
    force  (n,) on it without the rotor, with the losses of the gear [N or N m]
    """

    speed: np.ndarray
    acceleration: np.ndarray
    load: np.ndarray
    friction: np.ndarray
    losses: np.ndarray
    force: np.ndarray


def motor_load(
    servo: Servo, speed: np.ndarray, acceleration: np.ndarray, force: np.ndarray, sign: np.ndarray
) -> MotorLoad:
    """Q = F + m ÿ + F_r sgn ẏ; a gear of efficiency η gives it as Q/η where the load is driven, Q ẏ > 0, and Q η where it brakes.

    force (n,) of the loads [N or N m]; sign (n,) of the velocity, as the segment states it.
    """
    friction = ((servo.friction_n or 0.0) + (servo.friction_nm or 0.0) * shaft_lever(servo)) * sign
    total = force + moved(servo) * acceleration + friction
    losses = np.where(total * speed >= 0.0, 1.0 / servo.efficiency, servo.efficiency)
    return MotorLoad(speed, acceleration, force, friction, losses, total * losses)


def motor_torque(servo: Servo, load: MotorLoad) -> np.ndarray:
    """T = J_r i ÿ + Q/i (n,) [N m; N of a linear motor], i motor turns per unit of the motion."""
    i = lever(servo)
    rotor = 0.0 if servo.kind == LINEAR else servo.rotor_inertia_kg_m2
    return np.asarray(rotor * i * load.acceleration + load.force / i)


def best_ratio(servo: Servo, acceleration_squared: float, force_squared: float) -> float:
    """The gear ratio of least rms torque: T² = J_r² i² ÿ² + 2 J_r ÿ Q + Q²/i² has its least mean where i⁴ = ⟨Q²⟩/(J_r² ⟨ÿ²⟩); on
    pure inertia i² = J_load/J_r. Of means over the time of a turn."""
    i = (force_squared / acceleration_squared) ** 0.25 / math.sqrt(servo.rotor_inertia_kg_m2)
    return i / shaft_lever(servo)


__all__ = ["MotorLoad", "best_ratio", "lever", "motor_load", "motor_torque", "moved", "shaft_lever"]
