"""A servo motor with its gear: motor rotation, torque and speed, and the gear ratio of the least torque."""

from __future__ import annotations

import math

import numpy as np

from core.design.parts import LINEAR, Servo
from core.frozen import frozen


def lever(servo: Servo) -> float:
    """Motor rotation per unit of the motion [rad/rad or rad/m]; 1 for a linear motor."""
    return servo.gear_ratio * shaft_lever(servo)


def shaft_lever(servo: Servo) -> float:
    """Rotation of the output shaft per unit of the motion [rad/rad or rad/m]; 1 for a linear motor."""
    if servo.kind == LINEAR or servo.travel_mm_per_turn is None:
        return 1.0
    return 2.0 * math.pi / (servo.travel_mm_per_turn * 1e-3)


def moved_mass(servo: Servo) -> float:
    """Mass or inertia that the servo moves besides the loads, reduced to the motion [kg or kg m²]."""
    return (servo.mass_kg or 0.0) + (servo.inertia_kg_m2 or 0.0) * shaft_lever(servo) ** 2


@frozen(eq=False)
class MotorLoad:
    """Load of a motor by a motion.

    Attributes
    ----------
    speed, acceleration : ndarray (n,) [m/s, m/s² or rad/s, rad/s²]
        Of the motion.
    load, friction : ndarray (n,) [N or N m]
        Of the design's loads and masses, and friction of the servo.
    losses : ndarray (n,), dimensionless
        Factor of the gear on the force.
    force : ndarray (n,) [N or N m]
        On the motion without the rotor, with the losses of the gear.
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
    """Load of a motor, Q = F + m ÿ + F_r sgn ẏ, times 1/η where the motor drives, Q ẏ > 0, and times η where it brakes.

    Parameters
    ----------
    servo : Servo
        With the efficiency η of the gear.
    speed, acceleration : ndarray (n,) [m/s, m/s² or rad/s, rad/s²]
        Of the motion.
    force : ndarray (n,) [N or N m]
        Of the loads, F.
    sign : ndarray (n,), dimensionless
        Of the velocity, as the segment states it.

    Returns
    -------
    MotorLoad
    """
    friction = ((servo.friction_n or 0.0) + (servo.friction_nm or 0.0) * shaft_lever(servo)) * sign
    total = force + moved_mass(servo) * acceleration + friction
    losses = np.where(total * speed >= 0.0, 1.0 / servo.efficiency, servo.efficiency)
    return MotorLoad(speed, acceleration, force, friction, losses, total * losses)


def motor_torque(servo: Servo, load: MotorLoad) -> np.ndarray:
    """Motor torque T = J_r i ÿ + Q/i, i the motor rotation per unit of the motion.

    Parameters
    ----------
    servo : Servo
    load : MotorLoad

    Returns
    -------
    ndarray (n,) [N m], [N] for a linear motor

    References
    ----------
    Balance at the motor.
    """
    i = lever(servo)
    rotor = 0.0 if servo.kind == LINEAR else servo.rotor_inertia_kg_m2
    return np.asarray(rotor * i * load.acceleration + load.force / i)


def best_ratio(servo: Servo, acceleration_squared: float, force_squared: float) -> float:
    """Gear ratio of least rms torque, from means over the time of a turn.

    T² = J_r² i² ÿ² + 2 J_r ÿ Q + Q²/i² has its least mean where i⁴ = ⟨Q²⟩/(J_r² ⟨ÿ²⟩); with pure inertia i² =
    J_load/J_r.
    """
    i = (force_squared / acceleration_squared) ** 0.25 / math.sqrt(servo.rotor_inertia_kg_m2)
    return i / shaft_lever(servo)
