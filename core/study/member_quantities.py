"""What the quantities of ``core.study.quantities`` are read from: functions of a study that give (n,) in SI units."""

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
"""Part of a point's motion -> order of its derivative, and what of the complex number."""


def _direction(force: np.ndarray) -> np.ndarray:
    """0 of no force, whatever the signs of its zeros."""
    return np.angle(force + 0.0)


OF_FORCE: Mapping[str, Part] = MappingProxyType({"x": np.real, "y": np.imag, "size": np.abs, "direction": _direction})
"""Part of a force -> what of the complex number."""


# -- whether a design has it -------------------------------------------------------------------------------


def always(study: Study) -> bool:
    """True of every study."""
    return True


def motor_runs(study: Study) -> bool:
    """Not where the guide jams, nor where the motor stalls."""
    return study.jam is None and (not study.levels_torque or study.flywheel.runs)


def levelled_runs(study: Study) -> bool:
    """Where a flywheel levels the speed, and the motor runs."""
    return study.levels_torque and motor_runs(study)


def vibrates(study: Study) -> bool:
    """Where a follower that is not rigid does the same every turn."""
    return study.vibrates


def turns_steadily(study: Study) -> bool:
    """Where a flexible shaft has a steady response."""
    return study.stability is not None and study.stability.steady_turn is not None


# -- motion, links, forces ---------------------------------------------------------------------------------


def moved(study: Study, order: int) -> np.ndarray:
    """The follower's displacement, or its derivative by time."""
    return study.motion.displacement[order] * study.omega**order


def gain_of(study: Study, name: str) -> float:
    """What a quantity grows by in a turn [SI]: the motion by its advance."""
    motion = study.design.drive.motion
    return motion.gain * motion.scale if name == "displacement" and motion is not None else 0.0


def modulo(study: Study) -> np.ndarray:
    """The position less the whole advances of turns in it, 0 ... a; where it comes back the position itself."""
    motion, y = study.program.motion, study.motion.displacement[0]
    advance = abs(motion.gain) * motion.scale
    return np.asarray(np.mod(y, advance) if advance else y)


def coordinate(study: Study, name: str, order: int = 0) -> np.ndarray:
    """An angle of a link [rad] or a way along a guide [m] (n,), or its derivative by time of that order [per s^order]."""
    return study.linkage.coordinates[name][order] * study.omega**order


def singular(study: Study, code: str) -> np.ndarray:
    """What must not vanish in a follower's linkage (n,): a row of ``SINGULAR``."""
    return np.asarray(study.linkage.singular[code])


def transmission(study: Study, joint: str) -> np.ndarray:
    """Transmission angle (n,) [rad] at a joint, 0 ... π/2."""
    return np.asarray(study.linkage.transmission[joint])


def point_part(study: Study, point: str, what: str) -> np.ndarray:
    """A row of ``OF_POINT``."""
    order, part = OF_POINT[what]
    pose = study.linkage.bodies[study.linkage.body_of(point)]
    return part(pose.position(point, order) * study.omega**order)


def force_part(study: Study, pair: str, what: str) -> np.ndarray:
    """A row of ``OF_FORCE`` of what a pair carries."""
    return OF_FORCE[what](study.dynamics.pairs[pair])


def guide_of(study: Study) -> GuideReaction:
    """Reactions of the follower's guide. The mechanism must have one."""
    guide = study.dynamics.guide
    assert guide is not None, "the mechanism has no guide"
    return guide


def by_motor(torque: Callable[[Flywheel, Angles], np.ndarray]) -> Callable[[Study], np.ndarray]:
    """That of the cam where no flywheel levels it. Raises NoSolution where the guide jams or the motor stalls."""
    return lambda s: torque(s.flywheel, s.angles) if s.levels_torque or s.jam is not None else s.shaft_torque


def speed(study: Study) -> np.ndarray:
    """Angular velocity of the camshaft (n,) [rad/s]; constant where no flywheel lets it change."""
    if study.levels_torque or study.jam is not None:
        return study.flywheel.speed(study.angles)
    return spread(np.atleast_1d(study.omega), study.theta.shape[-1])


def stress(study: Study, part: str, second: bool = False) -> np.ndarray:
    """Of what the first roller or face touches, in a groove the flank that carries; or of the second roller."""
    parts = [getattr(each, part) for name, each in study.stress.items() if (name == SECOND) == second]
    return np.asarray(sum(parts[1:], parts[0]))


# -- the cam -----------------------------------------------------------------------------------------------


def second_push(study: Study) -> np.ndarray:
    """What one newton on the second roller pushes forward, times what one on the first does, as parts of that newton (n,):
    negative where they push opposite ways."""
    shape = study.cam
    return forward_push(study.linkage, shape.flank) * forward_push(study.linkage, shape.only(SECOND).flank)


def second_roller_distance(study: Study) -> np.ndarray:
    """Least distance (n,) [m] of the second roller from the cam centre."""
    flank = study.cam.only(SECOND).flank
    return np.asarray(np.abs(flank.reference) - flank.radius)


def line_of_centres(study: Study) -> np.ndarray:
    """Unit vector (1,) from the cam centre along which Q is counted: to the follower's pivot; across a guide so that Q = y'."""
    kinematics = study.linkage
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == SLIDING:
        return -1j * study.sense * kinematics.line(pair)
    pivot = kinematics.bodies[pair.body].position(pair.point)[:1]
    return np.asarray(pivot / np.abs(pivot))


def centre_distance(study: Study) -> np.ndarray:
    """Distance of the instant centre along the line of centres (n,) [m], infinite where it is at infinity."""
    centre = study.cam.flank.centre
    with np.errstate(divide="ignore"):
        return np.asarray((np.conj(line_of_centres(study)) * centre.point).real / centre.weight)


def centre_velocity(study: Study) -> np.ndarray:
    """V_Q = Q θ̇; its size, where the follower's pole moves and Q with it off any line."""
    held = study.kind in FOLLOWER_KINDS
    return study.omega * (centre_distance(study) if held else np.abs(study.cam.flank.centre.finite))


def reference_velocity(study: Study) -> np.ndarray:
    """Of the roller's centre, > 0 where V_Q is, which carries it along; its size, where the pole moves."""
    kinematics = study.linkage
    moved = study.omega * kinematics.follower.origin[1]
    if study.kind not in FOLLOWER_KINDS:
        return np.asarray(np.abs(moved))
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == SLIDING:
        return np.asarray((np.conj(kinematics.line(pair)) * moved).real)
    arm = kinematics.follower.origin[0] - kinematics.bodies[pair.body].position(pair.point)
    return np.asarray((np.conj(-1j * study.sense * arm / np.abs(arm)) * moved).real)


def polar_angle(study: Study) -> np.ndarray:
    """0 ... 2π, 2π itself never."""
    angle = np.mod(np.angle(study.cam.flank.profile), 2.0 * np.pi)
    return np.where(angle >= 2.0 * np.pi, 0.0, angle)
