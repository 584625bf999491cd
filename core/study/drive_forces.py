"""Forces of one drive: contact, elastic follower, load on its shaft, and the servo that makes its motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from core import dynamics, shaft, stress
from core.cam import INNER, OUTER, SECOND, CamShape, Flank
from core.design import NO_LIMITS, STAGES, Design, si
from core.design.parts import Servo
from core.dynamics import FlankChange, Forces, Friction, Loading, UnitLoads, kinetic_energy
from core.errors import NoPosition, NoSolution
from core.frozen import frozen
from core.mechanism import motion_extent
from core.mechanism.kinematics import SLIDING, Kinematics
from core.motion import TURN, Angles, program
from core.motion.extremes import Extreme, crossings, find_above, piecewise_angles, turn_quadrature
from core.motion.program import ShaftPosition
from core.numerics.derivatives import spread
from core.numerics.lazy import lazy
from core.shaft import LoadCurve, combined_load, has_flywheel
from core.stress import ContactStress, Pairing, RollerLife, contact_stress
from core.study.drive_study import DriveStudy
from core.study.stages import fit_load_curve, load_nodes, memory

if TYPE_CHECKING:  # imported where a study first needs them
    from core.dynamics import ContactForce, Flights, ForceOnBody, LiftOff
    from core.dynamics.forces import Contact
    from core.elastic import Elasticity, Response, Spectrum
    from core.spatial import SpatialShape

_FEW_ANGLES = 24  # of which at least one is no dead centre


class DriveForces(DriveStudy):
    """One drive from its motion to its forces.

    Further stages are ``dynamics``, and ``stress`` where cam and follower have materials.
    """

    @property
    def is_form_closed(self) -> bool:
        """Whether the cam holds the follower from both sides, as a groove or a conjugate pair does."""
        return "cam" in self.stages and bool(self.design.drive.cam.form.holds)

    @lazy
    def dynamics(self) -> Forces:
        """All forces at constant speed. Raises NoSolution where friction depends on reactions that statics does not determine."""
        if self.undetermined and (rubbing := [f for f in self.loading.frictions if f.pair in self.undetermined]):
            raise NoSolution(
                f"friction of {', '.join(f.pair for f in rubbing)} depends on a force that statics does not determine",
                rubbing[0].field,
                "remove the friction, or the redundant link",
            )

        def solve(kinematics: Kinematics, shape: CamShape | None, loading: Loading, omega: float) -> Forces:
            return dynamics.newton_euler(kinematics, shape, loading, omega, units=self._unit_loads)

        if self.has_surface:
            return self._stage("dynamics", self._forces_in_space, self.linkage, self.surface, self.loading, self.omega)
        return self._stage("dynamics", solve, self.linkage, self.shape, self.loading, self.omega)

    def _forces_in_space(self, kinematics: Kinematics, shape: SpatialShape, loading: Loading, omega: float) -> Forces:
        forces = dynamics.newton_euler(kinematics, None, loading, omega)
        y_1 = spread(kinematics.motion.displacement[1], kinematics.theta.size)
        return dynamics.with_cam_in_space(forces, y_1, shape.gain_ahead, shape.gain_behind, self.mechanism.driver_sign)

    def solve_turn(self, stage: str, *further: Angles, has_load: bool = False) -> None:
        """Solve a stage, and those before it, at once at all angles at which searches over the turn begin, and at further ones.

        ``has_load``: the load on the shaft is needed although this drive alone has no flywheel.
        """
        stages = [name for name in self.stages if STAGES.index(name) <= STAGES.index(stage)]
        sets = [*further, piecewise_angles(self.program)]
        if self.loading.is_empty:
            stages = [name for name in stages if name != "dynamics"]
        elif stage == "dynamics" and self.loads_shaft and (has_load or self.levels_torque):
            sets.append(load_nodes(self.program))
        self.solve_together(stages, sets)

    @property
    def levels_torque(self) -> bool:
        """Whether flywheel and motor make the torque of the motor differ from that of cam or crank."""
        return self.design.shaft is not None and has_flywheel(self.design.shaft)

    @property
    def _unit_loads(self) -> UnitLoads:
        """Reactions to unit loads, which neither the loads nor the speed change."""
        loading = self.loading
        pairs = tuple(friction.pair for friction in loading.frictions)
        units: UnitLoads = self._cached(
            "unit loads", dynamics.unit_loads, self.linkage, self.shape, loading.contact_friction, pairs
        )
        return units

    @lazy
    def free_bodies(self) -> Mapping[str, tuple[ForceOnBody, ...]]:
        """Body -> all forces on it, in equilibrium; infinite where friction jams.

        Bodies with reactions that statics does not determine are left out.
        """
        bodies = dynamics.free_bodies(self.linkage, self.shape, self.loading, self.dynamics)
        if not self.undetermined:
            return bodies
        pairs = self.linkage.pairs
        excluded = {body for name in self.undetermined for body in (pairs[name].on, pairs[name].body)}
        return MappingProxyType({body: rows for body, rows in bodies.items() if body not in excluded})

    @lazy
    def undetermined(self) -> frozenset[str]:
        """Pairs whose reactions statics does not determine, because the linkage is overconstrained."""
        if not self.mechanism.plan.redundant:
            return frozenset()
        key = (self.design.drive.posed, self.design.drive.motion)
        from core.dynamics.forces import undetermined_pairs

        pairs: frozenset[str] = memory.get(
            "undetermined", key, lambda: undetermined_pairs(type(self)(self.design, _FEW_ANGLES).linkage)
        )
        return pairs

    @lazy
    def jam(self) -> Extreme | None:
        """Refined extreme of the jamming factor where friction jams, independent of the sampling; None where nothing jams.

        A drive that jams has no forces.
        """
        if not self.loading.has_friction:
            return None

        def compute() -> Extreme | None:
            self.solve_turn("dynamics")
            return find_above(lambda angles: self.at(angles).dynamics.jam, self.program, dynamics.JAMS)

        worst: Extreme | None = memory.get("jam", self.depends_on("dynamics"), compute)
        return worst

    @property
    def contact_force(self) -> ContactForce:
        """Contact force F_c at every speed.

        Raises NoSolution where the cam holds the follower from both sides, nothing loads the follower, or friction jams.
        """
        self.require_stage("cam")
        if self.is_form_closed:
            form = self.design.drive.cam.form.form
            raise NoSolution(
                f"a {form} cam holds the follower from both sides, so that the follower cannot leave it",
                "cam.form",
                "choose an open cam",
            )
        if self.loading.is_empty:
            raise NoSolution(
                "nothing presses the follower on the cam: there are no masses and no spring",
                "loads",
                "enter masses or a spring",
            )
        if self.jam is not None:
            raise self._jammed(self.jam)
        return self._contact_force

    @lazy
    def _contact_force(self) -> ContactForce:
        def at(angles: Angles) -> tuple[Kinematics, CamShape]:
            study = self.at(angles)
            return study.linkage, study.cam

        return dynamics.ContactForce(at, self.loading, self.program, self.omega)

    @property
    def lift_off(self) -> LiftOff | None:
        """Lowest speed at which the follower leaves the cam; None where there is none. Raises NoSolution as ``contact_force``."""
        design = self.design
        key = replace(design.drive, cam=design.drive.bare_cam, limits=NO_LIMITS), design.sense  # at any speed the same
        result: LiftOff | None = memory.get("lift-off", key, self.contact_force.lift_off)
        return result

    def flights(self, turns: float = 3.0) -> Flights:
        """Flights of the follower after it has left the cam, at the speed of the design.

        Raises NoSolution as ``contact_force``, and where nothing presses the follower on the cam or it flies out of its reach.
        """
        contact, loads = self.contact_force, self.design.drive.loads

        def compute() -> Flights:
            lever = self.at_theta(np.zeros(1)).dynamics.contacts[0].lever[0]
            away = -float(np.sign(lever * self.mechanism.driver_sign))
            restitution = getattr(loads, "restitution", None) or 0.0

            def force(angles: Angles) -> np.ndarray:
                """Contact force; positive where a valve train is loose, which is no separation."""
                return np.nan_to_num(contact.at_speed(angles, self.omega), nan=1.0)

            parts = self.mechanism, self.loading, self.program, self.omega
            return dynamics.flights(force, *parts, away, restitution, turns)

        result: Flights = memory.get("flights", (self.depends_on("dynamics"), turns), compute)
        return result

    # -- elastic follower -----------------------------------------------------------------------------------

    @property
    def is_elastic(self) -> bool:
        """Whether the follower has a stiffness between its mass and the cam."""
        return self.has_disk and bool(self.design.drive.loads.follower_stiffness_n_per_mm)

    @property
    def elasticity(self) -> Elasticity:
        """One-mass model of the elastic follower. Raises NoSolution where the follower is rigid, or no mass vibrates."""
        from core.elastic import elasticity

        self.require_stage("cam")
        if not self.is_elastic:
            raise NoSolution("the follower is rigid", "loads.follower_stiffness_n_per_mm", "enter its stiffness")
        drive, driver_ranges, loading = self.design.drive, self.driver_ranges, self.loading
        loads, stroke = si(drive.loads), motion_extent(program(drive.motion))
        parts = (
            self.mechanism, driver_ranges, loading, drive.face, drive.bare_cam, self.sense, stroke, loads.follower_stiffness,
            loads.follower_damping_ratio or 0.0,
        )  # fmt: skip
        model: Elasticity = memory.get("elasticity", parts, lambda: elasticity(*parts))
        return model

    @property
    def follower_response(self) -> Response:
        """Response of the elastic follower at the speed of the design. Raises NoSolution as ``elasticity``."""
        from core.elastic import Response

        parts = self.elasticity.middle, program(self.design.drive.motion), self.omega
        response: Response = memory.get("response", parts, lambda: Response(*parts))
        return response

    @property
    def vibrates(self) -> bool:
        """Whether the follower is elastic and its response is periodic."""
        try:
            return self.is_elastic and not self.follower_response.is_resonant
        except NoSolution:
            return False

    def vibration(self, omega: np.ndarray, with_peaks: bool = True) -> Spectrum:
        """Response spectrum of the elastic follower.

        Parameters
        ----------
        omega : ndarray (m,) [rad/s]
            Speeds, positive.
        with_peaks : bool
            Also compute the largest error and acceleration over the turn.

        Returns
        -------
        Spectrum

        Raises
        ------
        NoSolution
            As ``elasticity``.
        """
        from core.elastic import spectrum

        model, driven = self.elasticity.middle, program(self.design.drive.motion)
        key = (model, driven, tuple(omega.tolist()), with_peaks)
        result: Spectrum = memory.get("spectrum", key, lambda: spectrum(model, driven, omega, with_peaks))
        return result

    def elastic_error(self, order: int = 0) -> np.ndarray:
        """Error z - s of the elastic follower in its periodic response, or a derivative by time.

        Parameters
        ----------
        order : int
            Order of the derivative.

        Returns
        -------
        ndarray (n,) [m or rad, by s^order]
        """
        return self.follower_response.error(self.program.uncut(self.angles), order) * self.omega**order

    @property
    def elastic_contact_force(self) -> np.ndarray:
        """Contact force of an open cam with an elastic follower, F_e = F_c + Δ (n,) [N], with the part Δ of m ë + c ż - c_d ṡ + ks e.

        That sum is the force of the elastic follower less that of the rigid one; c_d is the damping of its dampers.
        """
        model, forces = self.elasticity.middle, self.dynamics
        e, speed, acceleration = (self.elastic_error(order) for order in range(3))
        own_damping = model.damping - model.dampers
        difference = (
            model.mass * acceleration
            + model.damping * speed
            + own_damping * self.omega * self.motion.displacement[1]
            + model.closing * e
        )
        change = self.loading.acting(self.linkage) * self.mechanism.driver_sign * difference / forces.lever
        return np.asarray(forces.contact - change)

    @property
    def jamming_pair(self) -> Friction | None:
        """Pair with the largest part in the jamming; None where the face on the cam jams."""
        assert self.jam is not None
        forces = self.at_theta(np.array([self.jam.theta])).dynamics
        if not self.loading.frictions or forces.contact_jam[0] >= dynamics.JAMS:
            return None
        return self.loading.frictions[int(forces.most_jamming[0])]

    def _jammed(self, jam: Extreme) -> NoSolution:
        angle, friction = float(np.rad2deg(jam.theta)), self.jamming_pair
        what, field = ("contact", "loads.contact_friction") if friction is None else (friction.pair, friction.field)
        return NoSolution(f"the {what} jams, the torque is infinite", field, "lower the friction", [(angle, angle)])

    @property
    def flank_changes(self) -> tuple[FlankChange, ...]:
        """Changes of the flank in contact, of a groove or a conjugate pair, by cam angle."""
        if not (self.is_form_closed and self.has_disk):
            return ()
        return memory.get(
            "flank changes", self.depends_on("dynamics"), lambda: dynamics.flank_changes(self._forces_at, self.program)
        )

    @property
    def flank_impacts(self) -> tuple[FlankChange, ...]:
        """Changes of flank with the speed at which the follower strikes after it has crossed the play."""
        changes = self.flank_changes
        if not changes:
            return ()
        parts = self.mechanism, self.loading, self.program, abs(self.omega), 1e-3 * self.design.drive.cam.form.play_mm
        key = self.depends_on("dynamics")
        return memory.get("flank impacts", key, lambda: dynamics.with_impacts(changes, self._forces_at, *parts))

    def _forces_at(self, angles: Angles) -> tuple[Kinematics, Forces]:
        study = self.at(angles)
        return study.linkage, study.dynamics

    @lazy
    def stress(self) -> Mapping[str, ContactStress]:
        """Flank -> stresses of its contact; empty where a material is not known, or the face is a knife edge."""

        def compute(shape: CamShape, forces: Forces, *pairs: Any) -> Mapping[str, ContactStress]:
            rows = zip(shape.flanks, forces.contacts, pairs, strict=True)
            return {flank.name: contact_stress(flank, contact.force, pair) for flank, contact, pair in rows}

        contacts = pairings(self)
        if not contacts:
            return {}
        return self._stage("stress", compute, self.cam, self.dynamics, *(contacts[f.name] for f in self.cam.flanks))

    # -- load on the shaft ----------------------------------------------------------------------------------

    @property
    def shaft_torque(self) -> np.ndarray:
        """Torque that keeps the shaft at constant speed (n,) [N m], positive in its sense of rotation."""
        return self._torque_of(self.dynamics)

    def _torque_of(self, forces: Forces) -> np.ndarray:
        return self.sense * forces.driver if self.by_crank else forces.torque

    @property
    def loads_shaft(self) -> bool:
        """Whether the drive loads the shaft, through its cam or crank."""
        return self.design.drive.loads_shaft

    @property
    def turn_sign(self) -> float:
        """Sign of the angle's change as the shaft turns: -1 for a crank that turns clockwise, else +1."""
        return self.sense if self.by_crank else 1.0

    def require_load(self) -> None:
        """Raises NoSolution where the drive has no load on its shaft: mechanism or cam fail, or as ``load_curve``."""
        self._require_rotation()
        _ = self.dynamics

    def _require_rotation(self) -> None:
        if self.jam is not None:
            raise self._jammed(self.jam)
        self.require_full_turn()

    def require_full_turn(self) -> None:
        """Raises NoPosition where a crank cannot turn fully, or returns after several turns only."""
        if self.turns > 1:
            raise NoPosition(
                f"its cycle is {self.turns} turns of the crank; the load on a shaft is calculated for one turn only",
                "linkage.drivers" if self.design.drive.linkage.drivers else "linkage.links",
                "choose ratios and lengths with which it returns after one turn",
            )
        if self.by_crank and not (len(self.driver_ranges.ranges) == 1 and self.driver_ranges.ranges[0].is_free):
            raise NoPosition(
                "the crank cannot turn fully, so that no shaft can drive it", "linkage.links", "change their lengths"
            )

    @property
    def load_curve(self) -> LoadCurve:
        """Load on the shaft over one turn, by the angle the shaft has turned.

        Raises NoSolution where friction jams, or a crank cannot turn fully.
        """
        self._require_rotation()
        curve: LoadCurve = memory.get("load curve", self.depends_on("dynamics"), self._load_curve)
        return curve

    def _load_curve(self) -> LoadCurve:
        self.solve_turn("dynamics")
        slides = [f for f in self.loading.frictions if self.mechanism.pairs_by_name[f.pair].kind == SLIDING]
        curve = fit_load_curve(
            self._forces_at, self._torque_of, self.loading, self.program, slides, self.is_form_closed
        )
        return curve if self.turn_sign > 0.0 else combined_load([(curve, ShaftPosition(0.0, self.turn_sign))])


# -- the servo of a drive ---------------------------------------------------------------------------------------


T = TypeVar("T", bound=DriveForces)
NODES = 24
MAX_PANEL = np.deg2rad(30.0)  # that so many nodes integrate
MIN_VELOCITY = 1e-6  # of the largest velocity: below it the energy does not determine the inertia


def has_servo(design: Design, kind: str = "") -> bool:
    """Whether a servo makes the motion of the drive; with ``kind``, a servo of this kind."""
    servo = design.drive.servo
    return servo is not None and kind in ("", servo.kind)


def servo_part(study: DriveForces) -> Servo:
    """Servo of the drive, which must have one."""
    servo = study.design.drive.servo
    assert servo is not None, "a drive without [servo]"
    return servo


def servo_load(study: DriveForces) -> shaft.MotorLoad:
    """Load of the motor at the angles of the study."""
    n = study.theta.shape[-1]
    forces = dynamics.newton_euler(study.linkage, None, study.loading, study.omega)
    force = study.mechanism.driver_sign * spread(forces.driver, n)
    y = study.motion.displacement
    v, a = (spread(y[k], n) * study.omega**k for k in (1, 2))
    return shaft.motor_load(servo_part(study), v, a, force, np.sign(study.omega) * study.motion.velocity_sign)


def servo_torque(study: DriveForces) -> np.ndarray:
    """Torque T of the motor.

    Returns
    -------
    ndarray (n,) [N m; N of a linear motor]
    """
    return shaft.motor_torque(servo_part(study), servo_load(study))


def servo_speed(study: DriveForces) -> np.ndarray:
    """Speed ω_m of the motor.

    Returns
    -------
    ndarray (n,) [rad/s; m/s of a linear motor]

    References
    ----------
    Gear of the servo, n_s = i ẏ; of a linear motor v_s = ẏ.
    """
    return shaft.lever(servo_part(study)) * spread(study.motion.displacement[1], study.theta.shape[-1]) * study.omega


def servo_power(study: DriveForces) -> np.ndarray:
    """Power T ω_m of the motor.

    Returns
    -------
    ndarray (n,) [W]

    References
    ----------
    P_s = T_s i ẏ.
    """
    return servo_torque(study) * servo_speed(study)


@frozen
class SegmentEnergy:
    """Energy of the motor over a segment of the motion.

    Attributes
    ----------
    segment : int
        Number of the segment, from 0.
    given, braked : float [J]
        Energy that the motor supplies, and energy that the load returns to it.
    """

    segment: int
    given: float
    braked: float


@frozen
class ServoTurn:
    """The motor over a turn of the master.

    Attributes
    ----------
    rms : float [N m; N of a linear motor]
        Root mean square of the torque.
    given, braked : float [J]
        Energy that the motor supplies, and energy that the load returns to it.
    parts : tuple of SegmentEnergy
    acceleration_squared, force_squared : float
        Mean squares that determine the best gear ratio.
    inertia_ratio : float or None
        Largest inertia of the load at the motor over that of the rotor; None where the rotor's is not given.
    """

    rms: float
    given: float
    braked: float
    parts: tuple[SegmentEnergy, ...]
    acceleration_squared: float
    force_squared: float
    inertia_ratio: float | None


def servo_turn(study: DriveForces) -> ServoTurn:
    """Torque and energy of the motor over a turn, by Gauss's rule. Raises NoSolution as the stage ``linkage``."""
    turn: ServoTurn = memory.get("servo", study.depends_on("dynamics"), lambda: _servo_turn(study.full_turn))
    return turn


def _servo_turn(study: DriveForces) -> ServoTurn:
    servo = servo_part(study)
    nodes, weight = turn_nodes(study, servo_power)
    load = servo_load(nodes)
    torque = shaft.motor_torque(servo, load)
    power = torque * shaft.lever(servo) * load.speed
    seconds = TURN / abs(study.omega)
    segment = np.asarray(study.program.segment)[nodes.angles.piece]
    given, braked = np.maximum(power, 0.0) * weight * seconds, np.maximum(-power, 0.0) * weight * seconds
    parts = tuple(
        SegmentEnergy(int(i), float(given[segment == i].sum()), float(braked[segment == i].sum()))
        for i in np.unique(segment)
    )
    return ServoTurn(
        float(np.sqrt((torque**2 * weight).sum())),
        float(given.sum()),
        float(braked.sum()),
        parts,
        float((load.acceleration**2 * weight).sum()),
        float((load.force**2 * weight).sum()),
        _inertia_ratio(servo, study.at(piecewise_angles(study.program))),
    )


def turn_nodes(study: T, power: Callable[[T], np.ndarray]) -> tuple[T, np.ndarray]:
    """Gauss nodes of a turn, between the ends of the motion's pieces and the zeros of a power.

    Parameters
    ----------
    study : DriveForces
    power : callable
        Power of a study, ndarray (n,) [W].

    Returns
    -------
    study : DriveForces
        The study at the nodes.
    weights : ndarray (n,), dimensionless
        Weights of the nodes; their sum is 1.
    """
    samples = piecewise_angles(study.program)
    zeros = crossings(lambda angles: power(study.at(angles)), samples, power(study.at(samples)))
    angles, weights = turn_quadrature(study.program, zeros.theta.tolist(), MAX_PANEL, NODES)
    return study.at(angles), weights / TURN


def _inertia_ratio(servo: Servo, study: DriveForces) -> float | None:
    """Largest inertia of load and servo at the motor, over the inertia of the rotor; None where the rotor has none."""
    if not servo.rotor_inertia_kg_m2:
        return None
    v = spread(study.motion.displacement[1], study.theta.size) * study.omega
    moving = np.abs(v) > MIN_VELOCITY * max(float(np.abs(v).max()), 1e-300)
    energy = spread(kinetic_energy(study.linkage, study.loading, study.omega), study.theta.size)
    mass = float((2.0 * energy[moving] / v[moving] ** 2).max(initial=0.0)) + shaft.moved_mass(servo)
    return mass / shaft.lever(servo) ** 2 / servo.rotor_inertia_kg_m2


def best_servo_ratio(study: DriveForces) -> float:
    """Gear ratio of least rms torque. The servo must have a rotor inertia, and the drive a motion that is not a dwell."""
    turn = servo_turn(study)
    return shaft.best_ratio(servo_part(study), turn.acceleration_squared, turn.force_squared)


# -- contact with the cam ---------------------------------------------------------------------------------------


PRESSURES: Mapping[str, str] = {INNER: "contact_pressure", SECOND: "second_contact_pressure"}
"""First flank of each roller -> quantity of its pressure; the two flanks of a groove share one."""
ROLLERS: Mapping[str, tuple[str, ...]] = {"first": (INNER, OUTER), "second": (SECOND,)}


def pairings(study: DriveForces) -> Mapping[str, Pairing]:
    """Flank -> its contact; empty for a knife edge, or where an input of the stress is missing."""
    drive = study.design.drive
    return stress.pairings(drive.face, drive.cam) if drive.has_disk else {}


def load_ratings(study: DriveForces) -> Mapping[str, float]:
    """Roller -> dynamic load rating of its bearing [N], where given."""
    drive = study.design.drive
    return stress.load_ratings(drive.face, drive.cam) if drive.has_disk else {}


def _roller_contacts(study: DriveForces, roller: str) -> list[tuple[Flank, Contact]]:
    """Flanks of a roller with their contacts."""
    rows = zip(study.cam.flanks, study.dynamics.contacts, strict=True)
    return [(flank, contact) for flank, contact in rows if flank.name in ROLLERS[roller]]


def roller_force(study: DriveForces, roller: str) -> np.ndarray:
    """Force that presses a roller on its flanks.

    Parameters
    ----------
    study : DriveForces
    roller : "first" or "second"

    Returns
    -------
    ndarray (n,) [N]
    """
    return np.sum([np.maximum(contact.force, 0.0) for _, contact in _roller_contacts(study, roller)], axis=0)


def roller_speed(study: DriveForces, roller: str) -> np.ndarray:
    """Angular velocity ω_r of a roller about its own axis, on the flank in contact.

    Parameters
    ----------
    study : DriveForces
    roller : "first" or "second"

    Returns
    -------
    ndarray (n,) [rad/s]
    """
    flanks = _roller_contacts(study, roller)
    speed = stress.roller_speed(study.linkage, flanks[0][0], study.sense)
    for flank, contact in flanks[1:]:
        speed = np.where(contact.force > 0.0, stress.roller_speed(study.linkage, flank, study.sense), speed)
    return speed * study.omega


def roller_pv(study: DriveForces) -> np.ndarray:
    """Specific load of the roller of a cam in space times its largest sliding speed, PV = |F_c| v_s/(d L).

    Parameters
    ----------
    study : DriveForces

    Returns
    -------
    ndarray (n,) [Pa m/s]
    """
    machine, length = study.machine, study.machine.outer - study.machine.inner
    load = np.abs(study.dynamics.contact) / (2.0 * machine.roller_radius(machine.middle) * length)
    return np.asarray(load * study.surface.sliding * abs(study.omega))


def roller_lives(study: DriveForces) -> tuple[RollerLife, ...]:
    """Life of every roller with a load rating; empty where nothing loads the cam, or friction jams."""
    ratings = load_ratings(study)
    if not ratings or study.loading.is_empty or study.jam is not None:
        return ()

    def compute() -> tuple[RollerLife, ...]:
        angles, weight = turn_quadrature(study.program, [change.theta for change in study.flank_changes])
        nodes = study.at(angles)
        lives = []
        for roller, rating in ratings.items():
            speed = roller_speed(nodes, roller) / study.omega
            figures = stress.rolling_life(rating, roller_force(nodes, roller), speed, weight, study.omega)
            lives.append(RollerLife(roller, *(float(figure) for figure in figures)))
        return tuple(lives)

    key = study.depends_on("dynamics"), tuple(ratings.items())
    lives: tuple[RollerLife, ...] = memory.get("rolling life", key, compute)
    return lives
