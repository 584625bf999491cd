"""Quantities of links, points, pairs and the cam: functions of a study with results (n,) in SI units."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from core.cam import SECOND, forward_push
from core.design import FOLLOWER_KINDS
from core.dynamics import GuideReaction
from core.mechanism.kinematics import SLIDING
from core.motion import Angles
from core.numerics.derivatives import spread
from core.shaft import Flywheel
from core.study.study import Study

Part = Callable[[np.ndarray], np.ndarray]
OF_POINT: Mapping[str, tuple[int, Part]] = MappingProxyType(
    {"x": (0, np.real), "y": (0, np.imag), "vx": (1, np.real), "vy": (1, np.imag), "ax": (2, np.real), "ay": (2, np.imag),
     "speed": (1, np.abs)}
)  # fmt: skip
"""Part of a point's motion -> order of its derivative, and function of the complex number."""


def _direction(force: np.ndarray) -> np.ndarray:
    """Direction of a force [rad]; 0 for no force, whatever the signs of its zeros."""
    return np.angle(force + 0.0)


OF_FORCE: Mapping[str, Part] = MappingProxyType({"x": np.real, "y": np.imag, "size": np.abs, "direction": _direction})
"""Part of a force -> function of the complex number."""


# -- conditions --------------------------------------------------------------------------------------------


def always(study: Study) -> bool:
    """True of every study."""
    return True


def motor_runs(study: Study) -> bool:
    """Whether the motor runs: no guide jams, and the motor does not stall."""
    return study.jam is None and (not study.levels_torque or study.flywheel.runs)


def levelled_runs(study: Study) -> bool:
    """Whether the shaft has a flywheel, and its motor runs."""
    return study.levels_torque and motor_runs(study)


def vibrates(study: Study) -> bool:
    """Whether the follower is elastic and its response is periodic."""
    return study.vibrates


def turns_steadily(study: Study) -> bool:
    """Whether a flexible shaft has a steady response."""
    return study.stability is not None and study.stability.steady_turn is not None


# -- motion, links, forces ---------------------------------------------------------------------------------


def moved(study: Study, order: int) -> np.ndarray:
    """Displacement of the follower, or a derivative by time.

    Parameters
    ----------
    study : Study
    order : int
        Order of the derivative.

    Returns
    -------
    ndarray (n,) [m or rad, by s^order]
    """
    return study.motion.displacement[order] * study.omega**order


def gain_of(study: Study, name: str) -> float:
    """Growth of a quantity in one turn, in SI units: the advance of a motion, else 0."""
    motion = study.design.drive.motion
    return motion.gain * motion.scale if name == "displacement" and motion is not None else 0.0


def modulo(study: Study) -> np.ndarray:
    """Position modulo the advance per turn, 0 ... a; the position where the motion has no advance.

    Returns
    -------
    ndarray (n,) [m or rad]
    """
    motion, y = study.program.motion, study.motion.displacement[0]
    advance = abs(motion.gain) * motion.scale
    return np.asarray(np.mod(y, advance) if advance else y)


def coordinate(study: Study, name: str, order: int = 0) -> np.ndarray:
    """Angle of a link or displacement along a guide, or a derivative by time.

    Parameters
    ----------
    study : Study
    name : str
        Name of the coordinate.
    order : int
        Order of the derivative.

    Returns
    -------
    ndarray (n,) [m or rad, by s^order]
    """
    return study.linkage.coordinates[name][order] * study.omega**order


def singular(study: Study, code: str) -> np.ndarray:
    """Quantity of ``SINGULAR`` that must not vanish in a linkage.

    Returns
    -------
    ndarray (n,) [m or dimensionless]
    """
    return np.asarray(study.linkage.singular[code])


def transmission(study: Study, joint: str) -> np.ndarray:
    """Transmission angle at a joint, 0 ... π/2.

    Returns
    -------
    ndarray (n,) [rad]
    """
    return np.asarray(study.linkage.transmission[joint])


def point_part(study: Study, point: str, what: str) -> np.ndarray:
    """Position, velocity or acceleration of a point, or a part of it, as by ``OF_POINT``.

    Returns
    -------
    ndarray (n,) [m, m/s or m/s²]
    """
    order, part = OF_POINT[what]
    pose = study.linkage.bodies[study.linkage.body_of(point)]
    return part(pose.place(point, order) * study.omega**order)


def force_part(study: Study, pair: str, what: str) -> np.ndarray:
    """Force in a pair, or a part of it, as by ``OF_FORCE``.

    Returns
    -------
    ndarray (n,) [N or rad]
    """
    return OF_FORCE[what](study.dynamics.pairs[pair])


def guide_of(study: Study) -> GuideReaction:
    """Reactions of the follower's guide. The mechanism must have one."""
    guide = study.dynamics.guide
    assert guide is not None, "the mechanism has no guide"
    return guide


def by_motor(torque: Callable[[Flywheel, Angles], np.ndarray]) -> Callable[[Study], np.ndarray]:
    """Function of a study: torque of the flywheel's motor; the torque of the cam where there is no flywheel.

    The function raises NoSolution where the guide jams or the motor stalls.

    Parameters
    ----------
    torque : callable
        Torque, ndarray (n,) [N m], of flywheel and angles.

    Returns
    -------
    callable
        Torque of a study, ndarray (n,) [N m].
    """
    return lambda s: torque(s.flywheel, s.angles) if s.levels_torque or s.jam is not None else s.shaft_torque


def speed(study: Study) -> np.ndarray:
    """Angular velocity of the camshaft; constant without a flywheel.

    Returns
    -------
    ndarray (n,) [rad/s]
    """
    if study.levels_torque or study.jam is not None:
        return study.flywheel.speed(study.angles)
    return spread(np.atleast_1d(study.omega), study.theta.shape[-1])


def stress(study: Study, part: str, second: bool = False) -> np.ndarray:
    """Stress on the first roller or face, in a groove on the flank in contact; or on the second roller.

    Parameters
    ----------
    study : Study
    part : str
        Attribute of ContactStress.
    second : bool
        Take the second roller.

    Returns
    -------
    ndarray (n,) [Pa or m]
    """
    parts = [getattr(contact, part) for name, contact in study.stress.items() if (name == SECOND) == second]
    return np.asarray(sum(parts[1:], parts[0]))


# -- the cam -----------------------------------------------------------------------------------------------


def second_push(study: Study) -> np.ndarray:
    """Product of the parts of a force on the first and on the second roller that push the follower forward.

    Returns
    -------
    ndarray (n,), dimensionless
        Negative where the two rollers push in opposite directions.
    """
    shape = study.cam
    return forward_push(study.linkage, shape.flank) * forward_push(study.linkage, shape.only(SECOND).flank)


def second_roller_distance(study: Study) -> np.ndarray:
    """Least distance of the second roller from the cam centre.

    Returns
    -------
    ndarray (n,) [m]
    """
    flank = study.cam.only(SECOND).flank
    return np.asarray(np.abs(flank.reference) - flank.radius)


def line_of_centres(study: Study) -> np.ndarray:
    """Unit vector from the cam centre along which Q is measured: to the follower's pivot; across a guide, so that Q = y'.

    Returns
    -------
    ndarray (1,) complex, dimensionless
    """
    kinematics = study.linkage
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == SLIDING:
        return -1j * study.sense * kinematics.line(pair)
    pivot = kinematics.bodies[pair.body].place(pair.point)[:1]
    return np.asarray(pivot / np.abs(pivot))


def centre_distance(study: Study) -> np.ndarray:
    """Distance Q of the instant centre from the cam centre along the line of centres; infinite where it is at infinity.

    Returns
    -------
    ndarray (n,) [m]
    """
    centre = study.cam.flank.centre
    with np.errstate(divide="ignore"):
        return np.asarray((np.conj(line_of_centres(study)) * centre.point).real / centre.weight)


def centre_velocity(study: Study) -> np.ndarray:
    """Velocity of the instant centre V_Q = Q θ̇; its size for a linkage, in which Q follows no line.

    Returns
    -------
    ndarray (n,) [m/s]
    """
    has_line = study.kind in FOLLOWER_KINDS
    return study.omega * (centre_distance(study) if has_line else np.abs(study.cam.flank.centre.finite))


def reference_velocity(study: Study) -> np.ndarray:
    """Velocity of the roller's centre, positive in the direction of V_Q; its size for a linkage.

    Returns
    -------
    ndarray (n,) [m/s]
    """
    kinematics = study.linkage
    velocity = study.omega * kinematics.follower.origin[1]
    if study.kind not in FOLLOWER_KINDS:
        return np.asarray(np.abs(velocity))
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == SLIDING:
        return np.asarray((np.conj(kinematics.line(pair)) * velocity).real)
    arm = kinematics.follower.origin[0] - kinematics.bodies[pair.body].place(pair.point)
    return np.asarray((np.conj(-1j * study.sense * arm / np.abs(arm)) * velocity).real)


def polar_angle(study: Study) -> np.ndarray:
    """Polar angle of the profile, 0 ≤ φ < 2π.

    Returns
    -------
    ndarray (n,) [rad]
    """
    angle = np.mod(np.angle(study.cam.flank.profile), 2.0 * np.pi)
    return np.where(angle >= 2.0 * np.pi, 0.0, angle)
