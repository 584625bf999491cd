"""The servo of a drive: what its motor gives at every angle, and over a turn."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np

from core import dynamics
from core.design import Design
from core.design.parts import Servo
from core.dynamics import kinetic_energy
from core.frozen import frozen
from core.motion import TURN, Angles
from core.motion.extremes import piecewise_angles
from core.motion.roots import crossings
from core.numerics.gauss import gauss
from core.numerics.vectors import spread
from core.shaft.servo import MotorLoad, best_ratio, lever, motor_load, motor_torque, moved
from core.study.stages import memory
from core.study.study import Study

NODES = 24
WIDEST = np.deg2rad(30.0)  # that so many nodes integrate
SLOW = 1e-6  # of the largest velocity: below it the inertia is not told by the energy


def has_servo(design: Design, kind: str = "") -> bool:
    """Whether a motor makes the motion of its drive, one of this kind where one is named."""
    servo = design.drive.servo
    return servo is not None and kind in ("", servo.kind)


def servo_part(study: Study) -> Servo:
    """The drive's servo. The design must have one."""
    servo = study.design.drive.servo
    assert servo is not None, "a drive without [servo]"
    return servo


def load_of(study: Study) -> MotorLoad:
    """What the motion asks of the motor at the study's angles."""
    n = study.theta.size
    forces = dynamics.newton_euler(study.linkage, None, study.loading, study.omega)
    force = study.mechanism.sense * spread(forces.driver, n)
    y = study.motion.displacement
    v, a = (spread(y[k], n) * study.omega**k for k in (1, 2))
    return motor_load(servo_part(study), v, a, force, np.sign(study.omega) * study.motion.velocity_sign)


def servo_torque(study: Study) -> np.ndarray:
    """T of the motor (n,) [N m; N of a linear one]."""
    return motor_torque(servo_part(study), load_of(study))


def servo_speed(study: Study) -> np.ndarray:
    """Its speed (n,) [rad/s; m/s of a linear one]."""
    return lever(servo_part(study)) * spread(study.motion.displacement[1], study.theta.size) * study.omega


def servo_power(study: Study) -> np.ndarray:
    """T ω_m (n,) [W]."""
    return servo_torque(study) * servo_speed(study)


@frozen
class Part:
    """Energy [J] that the motor gives, and takes back, over a segment of the motion."""

    segment: int
    given: float
    braked: float


@frozen
class Turn:
    """Over a turn of the master.

    rms            of the torque [N m; N]
    given, braked  energy [J] that the motor gives, and that the load gives back to it; parts: of each segment
    acceleration_squared, force_squared  mean squares that the best ratio follows from
    inertia_ratio  largest inertia of the load at the motor over that of the rotor; None without a rotor's
    """

    rms: float
    given: float
    braked: float
    parts: tuple[Part, ...]
    acceleration_squared: float
    force_squared: float
    inertia_ratio: float | None


def servo_turn(study: Study) -> Turn:
    """What the motor does in a turn, by Gauss's rule between the ends of the motion's pieces and the zeros of the power. Raises
    NoAnswer as the linkage does."""
    turn: Turn = memory.get("servo", study.depends_on("dynamics"), lambda: _turn(study.whole))
    return turn


def _turn(study: Study) -> Turn:
    servo = servo_part(study)
    there, weight = over_turn(study, servo_power)
    load = load_of(there)
    torque = motor_torque(servo, load)
    power = torque * lever(servo) * load.speed
    seconds = TURN / abs(study.omega)
    segment = np.asarray(study.program.segment)[there.angles.piece]
    given, braked = np.maximum(power, 0.0) * weight * seconds, np.maximum(-power, 0.0) * weight * seconds
    parts = tuple(
        Part(int(i), float(given[segment == i].sum()), float(braked[segment == i].sum())) for i in np.unique(segment)
    )
    return Turn(
        float(np.sqrt((torque**2 * weight).sum())),
        float(given.sum()),
        float(braked.sum()),
        parts,
        float((load.acceleration**2 * weight).sum()),
        float((load.force**2 * weight).sum()),
        _inertia_ratio(servo, study.at(piecewise_angles(study.program))),
    )


def over_turn(study: Study, power: Callable[[Study], np.ndarray]) -> tuple[Study, np.ndarray]:
    """The study at Gauss's nodes between the ends of the motion's pieces and the zeros of this power (n,) of a study, and the parts
    of the turn (n,) that they stand for."""
    program = study.program
    samples = piecewise_angles(program)
    zeros = crossings(lambda angles: power(study.at(angles)), samples, power(study.at(samples)))
    cuts = _cuts(program, zeros)
    nodes, weights = gauss(NODES)
    theta = np.concatenate([a + (b - a) * nodes for a, b, _ in cuts])
    angles = Angles(theta, np.repeat([piece for _, _, piece in cuts], NODES))
    return study.at(angles), np.concatenate([(b - a) * weights for a, b, _ in cuts]) / TURN


def _cuts(program: Any, zeros: Angles) -> list[tuple[float, float, int]]:
    """Begin, end [rad] and piece of what is integrated at once."""
    found = []
    for i, (a, b) in enumerate(zip(program.starts.tolist(), program.ends.tolist(), strict=True)):
        inside = zeros.theta[zeros.piece == i].tolist()
        ends = sorted({a, b, *inside, *np.linspace(a, b, int(np.ceil((b - a) / WIDEST)) + 1).tolist()})
        found += [(low, high, i) for low, high in itertools.pairwise(ends)]
    return found


def _inertia_ratio(servo: Servo, at: Study) -> float | None:
    if not servo.rotor_inertia_kg_m2:
        return None
    v = spread(at.motion.displacement[1], at.theta.size) * at.omega
    moving = np.abs(v) > SLOW * max(float(np.abs(v).max()), 1e-300)
    energy = spread(kinetic_energy(at.linkage, at.loading, at.omega), at.theta.size)
    mass = float((2.0 * energy[moving] / v[moving] ** 2).max(initial=0.0)) + moved(servo)
    return mass / lever(servo) ** 2 / servo.rotor_inertia_kg_m2


def best_servo_ratio(study: Study) -> float:
    """The gear ratio of least rms torque. There must be a rotor's inertia, and a motion."""
    turn = servo_turn(study)
    return best_ratio(servo_part(study), turn.acceleration_squared, turn.force_squared)


__all__ = [
    "Part", "Turn", "best_servo_ratio", "has_servo", "load_of", "over_turn", "servo_part", "servo_power", "servo_speed", "servo_torque",
    "servo_turn",
]  # fmt: skip
