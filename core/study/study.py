"""A design and everything that follows from it, computed when it is read and not before."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from core import dynamics, stress
from core.cam import INNER, OUTER, SECOND
from core.design import Design, drive_names, only
from core.design.parts import Servo
from core.dynamics import kinetic_energy
from core.errors import NoStability
from core.frozen import frozen
from core.motion import TURN, Angles
from core.motion.extremes import crossings, piecewise_angles
from core.numerics.derivatives import spread
from core.numerics.roots import gauss
from core.shaft import Flywheel, levels
from core.shaft.speed import MotorLoad, best_ratio, lever, motor_load, motor_torque, moved
from core.stress import Pairing
from core.study.camshaft import Camshaft
from core.study.drive_study import DriveStudy
from core.study.stages import memory

if TYPE_CHECKING:
    from core.stability import Stability, SteadyTurn


# -- A design and everything that follows from it, computed when it is read and not before ----------------------


class Study(DriveStudy):
    """A design with one drive, or with several on one shaft.

    ``drives`` holds a study of each drive by its own angle, ``camshaft`` what they do together. The study of a design that lists no
    drives is that of its only one as well, with the stages of a ``DriveStudy``, at equally spaced angles or at those given; in a design
    that lists several each of ``drives`` has its own.

    The stage ``stability`` is there where a shaft turns a cam or a crank (None where that is rigid, or nothing excites it);
    ``flywheel`` belongs to the stage ``dynamics``.
    """

    @cached_property
    def drives(self) -> Mapping[str, Study]:
        """Name -> study, in the order of the list."""
        names = drive_names(self.design)
        if not self.design.listed:
            return {names[0]: self}
        return {name: self.of(only(self.design, i)) for i, name in enumerate(names)}

    @property
    def answering(self) -> Mapping[str, Study]:
        """Those of ``drives`` that have an answer, by the slug that columns, folders and residuals name them by. The drive of a design that
        lists none needs no name: it has the slug '', and stands for the whole, whose questions raise its NoAnswer."""
        if not self.design.listed:
            return {"": self}
        camshaft = self.camshaft
        return {camshaft.slugs[name]: each for name, each in self.drives.items() if name not in camshaft.failures}

    @cached_property
    def camshaft(self) -> Camshaft[Study]:
        """All drives together, by machine angle."""
        return Camshaft(self.design, self.drives, self.samples)

    @property
    def levelled(self) -> bool:
        """Whether a flywheel makes the motor's torque another than that of cam or crank."""
        return self.design.shaft is not None and levels(self.design.shaft)

    @cached_property
    def flywheel(self) -> Flywheel:
        """Sizing, speed and motor torque. Raises NoAnswer where friction jams, or a crank cannot turn fully."""
        return self.camshaft.flywheel

    def flexible_shaft(self) -> Stability:
        """The stage ``stability``. Raises NoStability, which says why there is none; NoAnswer where there is no linkage."""
        self.require_stage("stability")
        return self._flexible_shaft

    @cached_property
    def _flexible_shaft(self) -> Stability:
        return self.camshaft.flexible_shaft()

    @property
    def stability(self) -> Stability | None:
        """None where the shaft is rigid, or nothing excites it."""
        self.require_stage("stability")
        try:
            return self.flexible_shaft()
        except NoStability:
            return None

    @property
    def steady_turn(self) -> SteadyTurn:
        """One turn of the flexible shaft's steady response. Raises NoStability where there is none."""
        found = self.flexible_shaft()
        if found.steady_turn is None:
            m = found.machine
            raise NoStability(
                f"no steady response is found at η = {m.eta:.6g}, Q = {m.q:.6g}",
                "shaft.speed_rpm",
                "take another speed",
            )
        return found.steady_turn


# -- the servo of a drive ---------------------------------------------------------------------------------------


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
    force = study.mechanism.driver_sign * spread(forces.driver, n)
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


# -- what touches the cam ---------------------------------------------------------------------------------------


PRESSURES: Mapping[str, str] = {INNER: "contact_pressure", SECOND: "second_contact_pressure"}
"""First flank of each roller -> the quantity; of a groove both flanks together."""
ROLLERS: Mapping[str, tuple[str, ...]] = {"first": (INNER, OUTER), "second": (SECOND,)}


def pairings(study: Study) -> Mapping[str, Pairing]:
    """Flank -> what touches there; empty where a stress is not asked for, or not all is known."""
    drive = study.design.drive
    return stress.pairings(drive.face, drive.cam) if drive.cam is not None else {}


def ratings(study: Study) -> Mapping[str, float]:
    """Roller -> load rating [N], as far as stated."""
    drive = study.design.drive
    return stress.ratings(drive.face, drive.cam) if drive.cam is not None else {}


def pressing(study: Study, roller: str) -> np.ndarray:
    """What presses a roller on its flanks (n,) [N]."""
    flanks = zip(study.cam.flanks, study.dynamics.contacts, strict=True)
    pressed = [contact.force for flank, contact in flanks if flank.name in ROLLERS[roller]]
    return np.sum([np.maximum(each, 0.0) for each in pressed], axis=0)


def roller_speed(study: Study, roller: str) -> np.ndarray:
    """ω_r (n,) [rad/s] about its own axis, on the flank that carries."""
    flanks = [
        (flank, contact)
        for flank, contact in zip(study.cam.flanks, study.dynamics.contacts, strict=True)
        if flank.name in ROLLERS[roller]
    ]
    speed = stress.roller_speed(study.linkage, flanks[0][0], study.sense)
    for flank, contact in flanks[1:]:
        speed = np.where(contact.force > 0.0, stress.roller_speed(study.linkage, flank, study.sense), speed)
    return speed * study.omega
