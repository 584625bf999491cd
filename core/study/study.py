"""A design and everything that follows from it, computed when it is read and not before."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from core import cam, dynamics, followers, mechanism, motion, shaft
from core.cam import CamShape, Wall
from core.design import NO_LIMITS, Design, Linkage, si, with_drive
from core.dynamics import Acting, ContactForce, FlankChange, Flights, Forces, Friction, LiftOff, Loading
from core.elastic import Elasticity, Response, Spectrum, equivalent, spectrum
from core.errors import NoAnswer, NoPosition, NoStability, NoSuchStage, angle_list, at_angles
from core.findings import ERROR, NOTE, WARNING, Finding, Residual
from core.instant_centres import CentreTable, all_centres, cam_centres
from core.mechanism import Course, CrankProgram, Mechanism, body_name, solve_mechanism, swept, unit_speed_kinematics
from core.mechanism.kinematics import FRAME, REVOLUTE, SLIDING, Kinematics
from core.motion import TURN, Angles, MotionState, degrees, program
from core.motion.cuts import CutProgram
from core.motion.extremes import Extreme, Range, find_above, find_extremes, piecewise_angles
from core.motion.roots import crossings
from core.motion.turn import Place
from core.numerics.lazy import locked
from core.shaft import Flywheel, LoadCurve, combined, levels, load_curve
from core.stress import ContactStress, RollerLife, contact_stresses
from core.study import cam_checks, contact_stress
from core.study.certificate import certificate
from core.study.failures import failing_ranges
from core.study.quantities import OF_CONTACT, OF_MOTOR, OF_SPEED, Quantity, body_of, names_of, quantity
from core.study.stages import crank_grid, crank_state, cut_grid, evaluations, flexible_shaft, grid, memory

if TYPE_CHECKING:
    from core.stability import Stability, SteadyTurn

SAMPLES = 3600
STAGES = ("motion", "linkage", "cam", "dynamics", "stability")
"""All stages that a study may have, in the order in which they need each other."""

_ORDER = {ERROR: 0, WARNING: 1, NOTE: 2}
_AT_END = 1e-9  # [rad] from a dead centre: what grows towards it and has its extreme so near has none
_AT_CHANGE = 1e-3  # the same from a change point, where samples fall beside it
_CONTACT = ("contact_force",)


PROFILE_CURVATURES = {cam.INNER: "profile_curvature", cam.OUTER: "outer_curvature", cam.SECOND: "second_profile_curvature"}
"""Flank -> quantity."""


def _through_cusp(found: Range) -> Range:
    """A curvature that grows without limit at a cusp, and comes back from below where the profile runs backwards."""
    low = Extreme(-np.inf, found.low.theta) if found.low.value < 0.0 else found.low
    return Range(low, Extreme(np.inf, found.high.theta))


class Study:
    """One design at equally spaced angles of its cam or crank, or at the angles given.

    Stages are attributes: ``motion`` where one moves the mechanism, ``linkage``, ``cam`` where there is one, ``dynamics``,
    ``stability`` where a cam stands on a shaft (None where that is rigid, or nothing excites it). ``stages`` names those of
    this design, in the order in which they need each other. ``centres`` belongs to the stage ``linkage``, ``flywheel`` to
    ``dynamics``. Each is computed on first use from only the parts of the design that it needs, and kept for every other
    study that shares these parts. Any stage may raise NoAnswer; a stage that this design lacks raises NoSuchStage.

    A crank that cannot turn fully is sampled where it can: then there are fewer angles than samples.
    """

    def __init__(self, design: Design, samples: int = SAMPLES, angles: Angles | None = None) -> None:
        self.design = design
        self.samples = samples
        self._given = angles

    # -- what there is --------------------------------------------------------------------------------------

    @cached_property
    def stages(self) -> tuple[str, ...]:
        drive = self.design.drive
        there = {
            "motion": drive.motion is not None,
            "cam": drive.cam is not None,
            "stability": drive.cam is not None and self.design.shaft is not None,
        }
        return tuple(name for name in STAGES if there.get(name, True))

    def require_stage(self, name: str) -> None:
        """Raises NoSuchStage, naming the stages there are."""
        if name not in self.stages:
            raise NoSuchStage(name, self.stages)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        raise NoSuchStage(name, self.stages)

    @property
    def by_crank(self) -> bool:
        """A crank turns at speed, and no motion moves it."""
        return self.design.by_crank

    @property
    def kind(self) -> str:
        """Slug of the mechanism's kind."""
        return self.design.drive.kind

    @property
    def omega(self) -> float:
        """[rad/s] of the shaft, counted as it turns; of a crank counter-clockwise, negative clockwise."""
        speed = self.design.speed_rpm * TURN / 60.0
        return self.sense * speed if self.by_crank else speed

    @property
    def sense(self) -> float:
        """+1 where cam or crank turns counter-clockwise, -1 clockwise."""
        return self.design.sense

    # -- angles ---------------------------------------------------------------------------------------------

    @property
    def angle_column(self) -> str:
        return f"{self.angle_name}_deg".replace(" ", "_")

    @property
    def angle_name(self) -> str:
        return self.design.drive.angle_name

    @cached_property
    def program(self) -> Any:
        """What the driver does over one turn, a Program or a CrankProgram: its pieces and joins. Its pieces end where a process
        force switches and where friction turns round in a pin, too."""
        found = self._uncut
        if not (cuts := self._cuts(found)):
            return found
        return memory.get("cut program", (self.course if self.by_crank else found, cuts), lambda: CutProgram(found, cuts))

    @property
    def _uncut(self) -> Any:
        return CrankProgram(self.course) if self.by_crank else program(self.design.drive.motion)

    def _cuts(self, uncut: Any) -> tuple[float, ...]:
        """Angles [rad] in rising order at which the torque jumps or breaks, but for joins of the motion; none where the mechanism
        cannot be solved, which its own stage says."""
        loads = self.design.drive.loads
        if not (loads.process or loads.pair_friction):
            return ()

        try:
            loading, driven = self.loading, self.course if self.by_crank else self.design.drive.motion
            switches = memory.get("switches", (driven, loading.switches), lambda: tuple(loading.cuts(uncut).tolist()))
            pairs = tuple(friction.pair for friction in loading.frictions)
            back = memory.get("turning back", (driven, self.mechanism, pairs), lambda: tuple(self._turning_back(uncut, pairs)))
        except NoAnswer:
            return ()
        return tuple(sorted({*switches, *back}))

    def _turning_back(self, uncut: Any, pairs: tuple[str, ...]) -> Iterator[float]:
        """Angles [rad] at which one of these pairs slips the other way."""
        if not pairs:
            return
        angles = piecewise_angles(uncut)

        def kinematics(there: Angles) -> Kinematics:
            return solve_mechanism(self.mechanism, uncut.state(there), self.course)

        sampled = kinematics(angles)
        for name in pairs:
            if name != sampled.driver_name:

                def slip(at: Angles, name: str = name) -> np.ndarray:
                    return np.broadcast_to(kinematics(at).slip(name), at.theta.size)

                yield from crossings(slip, angles, np.broadcast_to(sampled.slip(name), angles.theta.size)).theta.tolist()

    @cached_property
    def angles(self) -> Angles:
        if self._given is not None:
            return self._given
        if isinstance(self.program, CutProgram):
            return cut_grid(self.program, self.angle_degrees)
        return crank_grid(self.course, self.samples) if self.by_crank else grid(self.design.drive.motion, self.samples)

    @property
    def theta(self) -> np.ndarray:
        """Angles (n,) [rad]."""
        theta: np.ndarray = self.angles.theta
        return theta

    @property
    def angle_degrees(self) -> np.ndarray:
        """The equally spaced angles of the tables [deg] (n,), each rounded once."""
        return CrankProgram(self.course).degrees(self.samples) if self.by_crank else degrees(self.samples)

    def at(self, angles: Angles) -> Study:
        """The same design at other angles, not remembered."""
        return Study(self.design, self.samples, angles)

    def at_theta(self, theta: np.ndarray) -> Study:
        """The same design at any angles (n,) [rad]; at a join the right-hand limit."""
        return self.at(self.program.angles(np.atleast_1d(theta)))

    @property
    def whole(self) -> Study:
        """The study over the whole turn, which this one is or was taken from."""
        return self if self._given is None else Study(self.design, self.samples)

    # -- stages ---------------------------------------------------------------------------------------------

    def _stage(self, name: str, function: Callable[..., Any], *parts: Any) -> Any:
        """function(*parts), counted; remembered by its parts over a whole turn."""

        def compute() -> Any:
            evaluations[name] += 1
            return function(*parts)

        return memory.get(name, parts, compute) if self.angles.kept else locked(compute())

    @contextmanager
    def _located(self, stage: str) -> Iterator[None]:
        """Errors of a sampled stage name the angles to the last digit, whatever the sampling was."""
        try:
            yield
        except NoAnswer as error:
            if not error.cam_angles or not self.angles.kept:
                raise
            raise at_angles(error, failing_ranges(self.at, stage, self.program)) from None

    @cached_property
    def mechanism(self) -> Mechanism:
        """The linkage that is solved. Raises NoAssembly where a follower does not come to its base position."""
        return followers.built(self.design.drive.mechanism, self.design.drive.cam)

    @cached_property
    def course(self) -> Course:
        """Where the links go. Raises NoPosition where they meet nowhere."""
        ends = (0.0, TURN) if self.by_crank else swept(program(self.design.drive.motion))
        found = mechanism.course_for(self.mechanism, *ends)
        if not self.mechanism.ranged:
            return found
        if not found.ranges:
            raise NoPosition(
                "its links cannot be put together at any position of the driver, or at single ones only", "linkage.links",
                "change their lengths, or linkage.branch",
            )  # fmt: skip
        if self.by_crank and not CrankProgram(found).degrees(self.samples).size:
            places = angle_list([(float(np.rad2deg(r.low)), float(np.rad2deg(r.high))) for r in found.ranges])
            raise NoPosition(
                f"its links can be put together with the crank within {places} only, where none of the {self.samples} "
                "driver angles lies", "linkage.links", "change their lengths, or ask for more angles",
            )  # fmt: skip
        return found

    @property
    def turn_ranges(self) -> tuple[tuple[float, float], ...]:
        """Where the angle can go [rad]: () for the whole turn, else the ranges between a crank's dead centres.

        Raises NoPosition where the linkage stands nowhere.
        """
        ranges = self.course.ranges if self.by_crank else ()
        return () if len(ranges) == 1 and ranges[0].free else tuple((r.low, r.high) for r in ranges)

    @cached_property
    def drive(self) -> MotionState:
        """What moves the mechanism: the motion, or the crank's own angle, with three derivatives (4, n) [rad or m]."""
        if isinstance(self.program, CutProgram):
            return self._stage("motion", self.program.state, self.angles)
        if self.by_crank:
            return crank_state(self.course, self.angles)
        return self._stage("motion", lambda motion, angles: program(motion).state(angles), self.design.drive.motion, self.angles)

    @property
    def motion(self) -> MotionState:
        self.require_stage("motion")
        return self.drive

    @cached_property
    def linkage(self) -> Kinematics:
        with self._located("linkage"):
            return self._stage("linkage", solve_mechanism, self.mechanism, self.drive, self.course)

    @cached_property
    def centres(self) -> CentreTable:
        """All instant centres of a linkage at every angle, by the driver's own coordinate, so that a dwell of the motion has
        them too; bodies are named as in ``linkage``."""

        def compute(linkage: Linkage, state: MotionState, course: Course) -> CentreTable:
            return all_centres(unit_speed_kinematics(linkage, state.displacement[0], course), course.plan.size)

        if self.by_crank:  # its kinematics are by the crank's angle already
            return self._stage("centres", all_centres, self.linkage, self.course.plan.size)
        return self._stage("centres", compute, self.mechanism.linkage, self.drive, self.course)

    @cached_property
    def cam_centres(self) -> CentreTable:
        """All instant centres with the cam among the bodies, at every angle. Raises NoSuchStage where there is no cam."""
        self.require_stage("cam")
        return self._stage("cam centres", cam_centres, self.linkage, self.sense)

    @cached_property
    def _cam(self) -> CamShape:
        with self._located("cam"):
            shape: CamShape = self._stage("cam", cam.envelope, self.linkage, self.design.drive.face, self.design.drive.bare_cam, self.sense)
            if self._given is None and self.mechanism.ranged:
                cam.require_hold(self.linkage, self.design.drive.face.noun, shape)
            return shape

    @property
    def cam(self) -> CamShape:
        self.require_stage("cam")
        return self._cam

    @property
    def shape(self) -> CamShape | None:
        return self.cam if "cam" in self.stages else None

    @cached_property
    def loading(self) -> Loading:
        """The force elements."""
        parts = (self.design.drive.mechanism, self.design.drive.loads, self.mechanism)
        loads: Loading = memory.get("loading", parts, lambda: dynamics.loading_of(*parts))
        return loads

    @property
    def holds(self) -> bool:
        """Whether the cam holds the follower from both sides."""
        return "cam" in self.stages and bool(self.design.drive.cam.form.holds)

    @cached_property
    def dynamics(self) -> Forces:
        return self._stage("dynamics", dynamics.newton_euler, self.linkage, self.shape, self.loading, self.omega)

    @cached_property
    def free_bodies(self) -> Mapping[str, tuple[Acting, ...]]:
        """Body -> every force on it, in equilibrium; infinite where friction jams."""
        return dynamics.free_bodies(self.linkage, self.shape, self.loading, self.dynamics)

    @property
    def jam(self) -> Extreme | None:
        """Where friction jams hardest, by the refined extreme of the jamming factor, so whatever the sampling: then there
        are no forces to be tabled. None where nothing jams."""
        if not self.loading.rubs:
            return None

        def compute() -> Extreme | None:
            return find_above(lambda angles: self.at(angles).dynamics.jam, self.program, dynamics.JAMS)

        worst: Extreme | None = memory.get("jam", self.depends_on("dynamics"), compute)
        return worst

    @property
    def contact_force(self) -> ContactForce:
        """F_c at every speed. Raises NoAnswer where the cam holds the follower from both sides, nothing loads it, or friction jams."""
        self.require_stage("cam")
        if self.holds:
            form = self.design.drive.cam.form.form
            raise NoAnswer(f"a {form} cam holds the follower from both sides, so that it cannot leave it", "cam.form", "take an open cam")
        if self.loading.empty:
            raise NoAnswer("nothing presses the follower on the cam: there are no masses and no spring", "loads", "give them")
        if self.jam is not None:
            raise self._jammed(self.jam)
        return self._contact_force

    @cached_property
    def _contact_force(self) -> ContactForce:
        def at(angles: Angles) -> tuple[Kinematics, CamShape]:
            there = self.at(angles)
            return there.linkage, there.cam

        return ContactForce(at, self.loading, self.program, self.omega)

    @property
    def lift_off(self) -> LiftOff | None:
        """The least speed at which the follower leaves the cam; None where none does. Raises NoAnswer as ``contact_force``."""
        design = self.design
        key = replace(design.drive, cam=design.drive.bare_cam, limits=NO_LIMITS), design.sense  # at any speed the same
        found: LiftOff | None = memory.get("lift-off", key, self.contact_force.lift_off)
        return found

    def flights(self, turns: float = 3.0) -> Flights:
        """The flights of the follower after it has left the cam, at the design's own speed. Raises NoAnswer as ``contact_force``, and
        where it is pressed nowhere or flies out of its reach."""
        contact, loads = self.contact_force, self.design.drive.loads

        def compute() -> Flights:
            lever = self.at_theta(np.zeros(1)).dynamics.contacts[0].lever[0]
            away = -float(np.sign(lever * self.mechanism.sense))
            restitution = getattr(loads, "restitution", None) or 0.0
            return dynamics.flights(
                lambda angles: contact.at_speed(angles, self.omega), self.mechanism, self.loading, self.program, self.omega, away,
                restitution, turns,
            )  # fmt: skip

        found: Flights = memory.get("flights", (self.depends_on("dynamics"), turns), compute)
        return found

    # -- elastic follower -----------------------------------------------------------------------------------

    @property
    def is_elastic(self) -> bool:
        """Whether the follower has a stiffness, between its mass and the cam."""
        return "cam" in self.stages and bool(self.design.drive.loads.follower_stiffness_n_per_mm)

    @property
    def elasticity(self) -> Elasticity:
        """The follower as one mass. Raises NoAnswer where it is rigid, or no mass vibrates."""
        self.require_stage("cam")
        if not self.is_elastic:
            raise NoAnswer("the follower is rigid", "loads.follower_stiffness_n_per_mm", "give its stiffness")
        drive, course, loading = self.design.drive, self.course, self.loading
        loads, stroke = si(drive.loads), swept(program(drive.motion))
        parts = (
            self.mechanism, course, loading, drive.face, drive.bare_cam, self.sense, stroke, loads.follower_stiffness,
            loads.follower_damping_ratio or 0.0,
        )  # fmt: skip
        found: Elasticity = memory.get("elasticity", parts, lambda: equivalent(*parts))
        return found

    @property
    def follower_response(self) -> Response:
        """What the elastic follower does at the design's speed. Raises NoAnswer as ``elasticity``; see also ``Response``."""
        one, driven = self.elasticity.middle, program(self.design.drive.motion)
        found: Response = memory.get("response", (one, driven, self.omega), lambda: Response(one, driven, self.omega))
        return found

    @property
    def vibrates(self) -> bool:
        """Whether there is an elastic follower with a response that repeats every turn."""
        try:
            return self.is_elastic and not self.follower_response.resonant
        except NoAnswer:
            return False

    def vibration(self, omega: np.ndarray, largest: bool = True) -> Spectrum:
        """The response spectrum at speeds (m,) [rad/s]; largest: with the largest values over the turn. Raises NoAnswer as
        ``elasticity``."""
        one, driven = self.elasticity.middle, program(self.design.drive.motion)
        key = (one, driven, tuple(omega.tolist()), largest)
        found: Spectrum = memory.get("spectrum", key, lambda: spectrum(one, driven, omega, largest))
        return found

    def elastic_error(self, order: int = 0) -> np.ndarray:
        """z - s of the elastic follower (n,) [m or rad], or a derivative by time, of the response that repeats every turn."""
        return self.follower_response.error(self.program.uncut(self.angles), order) * self.omega**order

    @property
    def elastic_contact_force(self) -> np.ndarray:
        """Of an open cam (n,) [N]: F_c with what m ë + c ż - c_d ṡ + ks e, the difference of the elastic follower's force from the
        rigid one's, c_d of its dampers, adds to it."""
        one, forces = self.elasticity.middle, self.dynamics
        e, speed, acceleration = (self.elastic_error(order) for order in range(3))
        rubs = one.damping - one.dampers
        more = one.mass * acceleration + one.damping * speed + rubs * self.omega * self.motion.displacement[1] + one.closing * e
        return np.asarray(forces.contact - self.mechanism.sense * more / forces.lever)

    @property
    def _lift_off_rpm(self) -> float:
        """The speed from which on the follower leaves the cam, as it does at the design's own."""
        own = abs(self.omega)
        found = self.lift_off if self.jam is None else None
        return (own if found is None else min(found.omega, own)) * 30.0 / math.pi

    @property
    def _jamming(self) -> Friction | None:
        """The pair that has the largest part in what jams; None: the face on the cam."""
        assert self.jam is not None
        forces = self.at_theta(np.array([self.jam.theta])).dynamics
        if not self.loading.frictions or forces.contact_jam[0] >= dynamics.JAMS:
            return None
        return self.loading.frictions[int(forces.most_jamming[0])]

    def _jammed(self, jam: Extreme) -> NoAnswer:
        angle, friction = float(np.rad2deg(jam.theta)), self._jamming
        what, field = ("contact", "loads.contact_friction") if friction is None else (friction.pair, friction.field)
        return NoAnswer(f"the {what} jams, the torque is infinite", field, "lower it", [(angle, angle)])

    @property
    def flank_changes(self) -> tuple[FlankChange, ...]:
        """Where the contact goes from one flank of a groove or of a conjugate pair to the other, by cam angle."""
        if not self.holds:
            return ()

        def compute() -> tuple[FlankChange, ...]:
            def at(angles: Angles) -> tuple[Kinematics, Forces]:
                there = self.at(angles)
                return there.linkage, there.dynamics

            return dynamics.flank_changes(at, self.program, self.loading, 1e-3 * self.design.drive.cam.form.play_mm)

        return memory.get("flank changes", self.depends_on("dynamics"), compute)

    @cached_property
    def stress(self) -> Mapping[str, ContactStress]:
        """By flank; empty where what touches is not known, or is an edge."""

        def compute(shape: CamShape, forces: Forces, *pairs: Any) -> Mapping[str, ContactStress]:
            rows = zip(shape.flanks, forces.contacts, pairs, strict=True)
            return {flank.name: contact_stresses(flank, contact.force, pair) for flank, contact, pair in rows}

        there = contact_stress.pairings(self)
        return self._stage("stress", compute, self.cam, self.dynamics, *(there[f.name] for f in self.cam.flanks)) if there else {}

    @property
    def roller_lives(self) -> tuple[RollerLife, ...]:
        """Of every roller whose load rating is stated (ISO 281)."""
        return contact_stress.lives(self)

    @property
    def stability(self) -> Stability | None:
        self.require_stage("stability")
        try:
            return self.flexible_shaft()
        except NoStability:
            return None

    def flexible_shaft(self) -> Stability:
        """The stage ``stability``. Raises NoStability, which says why there is none; NoAnswer where there is no linkage."""
        self.require_stage("stability")
        return self._flexible_shaft

    @cached_property
    def _flexible_shaft(self) -> Stability:
        drive, shaft_part = self.design.drive, self.design.shaft
        if shaft_part is None or shaft_part.elastic is None:
            raise NoStability("the camshaft is rigid", "shaft", "give camshaft_inertia_kg_m2 and stiffness_nm_per_rad")
        with self._located("linkage"):
            found = self._stage(
                "stability", flexible_shaft, self.program, self.mechanism, self.course, self.loading, drive.face, drive.bare_cam,
                self.sense, shaft_part.elastic, self.omega, drive.motion_unit,
            )  # fmt: skip
        if isinstance(found, NoStability):
            raise found
        return found

    @property
    def steady_turn(self) -> SteadyTurn:
        """One turn of the flexible shaft's steady response. Raises NoStability where there is none."""
        found = self.flexible_shaft()
        if found.steady_turn is None:
            m = found.machine
            raise NoStability(f"no steady response is found at η = {m.eta:.6g}, Q = {m.q:.6g}", "shaft.speed_rpm", "take another speed")
        return found.steady_turn

    # -- flywheel and motor ---------------------------------------------------------------------------------

    @property
    def levelled(self) -> bool:
        """Whether a flywheel makes the motor's torque another than that of cam or crank."""
        return self.design.shaft is not None and levels(self.design.shaft)

    @cached_property
    def flywheel(self) -> Flywheel:
        """Sizing, speed and motor torque. Raises NoAnswer where friction jams, or a crank cannot turn fully."""
        return memory.get("flywheel", (self.depends_on("dynamics"), self.design.shaft), self._flywheel)

    def _flywheel(self) -> Flywheel:
        evaluations["flywheel"] += 1
        assert self.design.shaft is not None
        return Flywheel(lambda angles: self.at(angles).shaft_torque, self.load_curve, self.design.shaft, self.turning)

    @property
    def shaft_torque(self) -> np.ndarray:
        """What the shaft must be given at constant speed (n,) [N m], > 0 in its sense of rotation."""
        forces = self.dynamics
        return self.sense * forces.driver if self.by_crank else forces.torque

    @property
    def loads_shaft(self) -> bool:
        """Whether cam or crank make the shaft carry it; a motion that no cam makes is driven by something else."""
        return "cam" in self.stages or self.by_crank

    @property
    def turning(self) -> float:
        """+1, or -1 of a crank whose angle, counted counter-clockwise, falls as the shaft turns."""
        return self.sense if self.by_crank else 1.0

    def require_load(self) -> None:
        """Raises NoAnswer where the shaft cannot carry it: there is no mechanism or no cam, friction jams, or a crank cannot turn
        fully."""
        self._require_turning()
        _ = self.dynamics

    def _require_turning(self) -> None:
        if self.jam is not None:
            raise self._jammed(self.jam)
        if self.by_crank and not (len(self.course.ranges) == 1 and self.course.ranges[0].free):
            raise NoPosition("the crank cannot turn fully, so no flywheel carries it", "linkage.links", "change their lengths")

    @property
    def load_curve(self) -> LoadCurve:
        """What it asks of the shaft over one turn, by the angle that the shaft has turned through. Raises NoAnswer where
        friction jams, or a crank cannot turn fully."""
        self._require_turning()
        curve: LoadCurve = memory.get("load curve", self.depends_on("dynamics"), self._turned_load)
        return curve

    def _turned_load(self) -> LoadCurve:
        curve = self._fitted_load()
        return curve if self.turning > 0.0 else combined([(curve, Place(0.0, self.turning))])

    def _fitted_load(self) -> LoadCurve:
        there = lru_cache(maxsize=1)(self.at)  # load and guide are needed at the same angles

        def load(angles: Angles) -> np.ndarray:
            study = there(angles)
            return np.array([study.shaft_torque, self.loading.inertia(study.linkage)[0]])

        def rubbing(friction: Friction, edge: int) -> Callable[[Angles], np.ndarray]:
            """What a slide carries where it rubs: friction turns round with its sign."""

            def force(angles: Angles) -> np.ndarray:
                study = there(angles)
                share = dynamics.carried(study.linkage, study.dynamics, friction)[edge]
                return np.asarray(share * np.abs(study.drive.velocity_sign))

            return force

        def carrying(angles: Angles) -> np.ndarray:
            """Which flank carries: with another one friction in the guide grows otherwise."""
            return there(angles).dynamics.carrying

        slides = [f for f in self.loading.frictions if self.linkage.pairs[f.pair].kind == SLIDING]
        switches = [rubbing(f, edge) for f in slides for edge in range(2 if f.length else 1)]
        changes = carrying if self.holds and self.loading.frictions else None
        return load_curve(load, self.program, *switches, changes)

    # -- what figures depend on -----------------------------------------------------------------------------

    def depends_on(self, stage: str) -> tuple[Any, ...]:
        """The parts of the design that the quantities of a stage depend on."""
        design = self.design
        drive = replace(design.drive, cam=design.drive.bare_cam, limits=NO_LIMITS)
        speed = (design.sense, design.speed_rpm)
        parts: Mapping[str, tuple[Any, ...]] = {
            "motion": (drive.motion, speed),
            "linkage": (drive.motion, speed, drive.mechanism, drive.cam),
            "cam": (drive.motion, drive.mechanism, drive.cam, design.sense),
            "dynamics": (drive, speed),
            "stability": (drive, speed, design.shaft),
        }
        return parts[stage]

    def quantities(self, stage: str | None = None) -> Mapping[str, Quantity]:
        """The scalars that can be read, of one stage or of all."""
        rows = {name: quantity(name) for name in names_of(self.design)}
        found = {name: row for name, row in rows.items() if stage in (None, row.stage)}
        if stage in (None, "linkage") and self.mechanism.ranged:
            for link, turning in self.course.turning.items():
                name = f"link.{link}"
                if turning.turns and name in found:
                    found[name] = replace(found[name], turns=True)
        return found

    # -- extremes -------------------------------------------------------------------------------------------

    def extremes(self, stage: str, only: tuple[str, ...] = ()) -> Mapping[str, Range]:
        """Refined extremes of a stage's quantities (of those named only, where any are); raises NoSuchStage."""
        self.require_stage(stage)
        if stage == "stability":
            return self._steady_extremes
        with_motor = stage == "dynamics" and (not only or not OF_MOTOR.isdisjoint(only))
        with_speed = stage == "cam" and (not only or not OF_SPEED.isdisjoint(only))
        with_contact = stage == "dynamics" and (not only or not OF_CONTACT.isdisjoint(only))
        touching = (tuple(contact_stress.pairings(self).items()), *contact_stress.ratings(self)) if with_contact else ()
        key = self.depends_on(stage), self.design.shaft if with_motor else None, self.design.speed_rpm if with_speed else None, touching
        found: Mapping[str, Range] = memory.get(("extremes", stage, only), key, lambda: self._extremes(stage, only))
        return found

    @property
    def _steady_extremes(self) -> Mapping[str, Range]:
        """Of the steady response, whose pieces are those of the integration; empty where there is none."""
        turn = None if self.stability is None else self.stability.steady_turn
        if turn is None:
            return {}
        wind_up, stiffness = turn.wind_up_range, turn.stiffness
        sides = (Extreme(stiffness * side.value, side.theta) for side in (wind_up.low, wind_up.high))
        return {"wind_up": wind_up, "follower_error": turn.errors[0], "shaft_torque": Range(*sides)}

    @np.errstate(invalid="ignore", over="ignore")  # infinite rates at dead centres
    def _extremes(self, stage: str, only: tuple[str, ...]) -> Mapping[str, Range]:
        rows = {
            name: row
            for name, row in self.quantities(stage).items()
            if not row.turns and (name in only if only else row.exists(self))
        }

        def values(angles: Angles) -> Mapping[str, np.ndarray]:
            there = self.at(angles)
            return {name: row.value(there) for name, row in rows.items()}

        with self._located(stage):
            found = find_extremes(values, self.program)
        if stage == "cam":
            found |= self._infinite_at_cusps(found)
        if not self.by_crank:
            return found
        return {name: Range(self._limit(name, r.low), self._limit(name, r.high)) for name, r in found.items()}

    def _infinite_at_cusps(self, found: Mapping[str, Range]) -> dict[str, Range]:
        """The curvatures among extremes of the cam that grow without limit, as they come out."""
        drive = self.design.drive
        flanks = [(flank, name) for flank, name in PROFILE_CURVATURES.items() if name in found]
        if not flanks:
            return {}
        limits = found if found.keys() >= set(cam.limits_of(drive.face, drive.cam)) else self.cam_extremes
        return {name: _through_cusp(found[name]) for flank, name in flanks if cam.undercut(limits, flank, drive.face, drive.cam)}

    def _limit(self, name: str, extreme: Extreme) -> Extreme:
        """An extreme right at a dead centre, or at a change point, is infinite where it grows without limit there."""
        places = [(r.low, _AT_END, 1.0) for r in self.course.ranges if r.low_joint]
        places += [(r.high, _AT_END, -1.0) for r in self.course.ranges if r.high_joint]
        places += [(change.at, _AT_CHANGE, 1.0) for change in self.course.changes]
        for place, near, inwards in places:
            if abs(extreme.theta - place) < near and self._grows(name, place, inwards):
                return Extreme(float(np.copysign(np.inf, extreme.value)), place)
        return extreme

    def _grows(self, name: str, place: float, inwards: float) -> bool:
        """Whether a quantity grows without limit towards a place: a hundred times nearer it is more than five times as large."""
        steps = place + inwards * np.array([1e-7, 1e-5])
        nearer, near = np.abs(quantity(name).value(self.at(self.program.angles(steps))))
        return bool(nearer > 5.0 * near)

    # -- findings -------------------------------------------------------------------------------------------

    def findings(self, stages: tuple[str, ...] = ()) -> tuple[Finding, ...]:
        """What the named stages (all, where none is named) exceed, the gravest first."""
        rows: Mapping[str, Callable[[], list[Finding]]] = {
            "motion": lambda: motion.findings(program(self.design.drive.motion)),
            "linkage": self._linkage_findings,
            "cam": self._cam_findings,
            "dynamics": self._dynamics_findings,
            "stability": self._stability_findings,
        }
        found = [f for name in stages or self.stages for f in rows[name]()]
        return tuple(sorted(found, key=lambda f: _ORDER[f.severity]))

    def _linkage_findings(self) -> list[Finding]:
        names = [n for n in self.quantities("linkage") if n in mechanism.SINGULAR or n.startswith("transmission.")]
        extremes = self.extremes("linkage", tuple(names)) if names else {}
        return mechanism.findings(self.course, extremes, self.by_crank)

    @property
    def cam_extremes(self) -> Mapping[str, Range]:
        """Those of the quantities that the findings of the cam are taken from."""
        return self.extremes("cam", cam.limits_of(self.design.drive.face, self.design.drive.cam))

    def _cam_findings(self) -> list[Finding]:
        drive, extremes = self.design.drive, self.cam_extremes
        grounds = {flank.name: self._held_by(flank.body) for flank in self.cam.flanks}
        found = cam.findings(extremes, grounds[cam.INNER], drive.face, drive.cam, self._least_at)
        found += cam.further_findings(extremes, grounds, drive.face, drive.cam)
        found += cam.wall_findings(self._wall(), drive.cam) if any(f.name == cam.OUTER for f in self.cam.flanks) else []
        return found + cam_checks.findings(self)

    def _wall(self) -> Wall | None:
        """The wall of a groove that is gone."""

        def compute() -> Wall | None:
            return cam.thinnest_wall(lambda theta: self.at_theta(theta).cam, self.cam, self.angles)

        wall: Wall | None = memory.get("wall", (self.depends_on("cam"), self.samples), compute)
        return wall

    @property
    def ground(self) -> str:
        """Kind of the pair that holds what the cam acts on."""
        return self._held_by(self.cam.flank.body)

    def _held_by(self, body: str) -> str:
        """Kind of the pair that holds a body on the frame; a body that none holds turns with its pole."""
        pairs = self.linkage.pairs.values()
        return next((pair.kind for pair in pairs if {pair.on, pair.body} == {FRAME, body}), REVOLUTE)

    def _least_at(self, name: str, base_radius_mm: float) -> float:
        """The refined least value of a quantity of the cam with another base radius; NaN where there is none."""
        design = with_drive(self.design, cam=replace(self.design.drive.cam, base_radius_mm=base_radius_mm))
        other = Study(design, self.samples)
        try:
            return find_extremes(lambda angles: {name: quantity(name).value(other.at(angles))}, other.program)[name].low.value
        except NoAnswer:
            return math.nan

    def _dynamics_findings(self) -> list[Finding]:
        jams = [] if self.jam is None or self.loading.empty else [dynamics.jam_finding(self.jam, self._jamming)]
        if "cam" not in self.stages:
            found = [*dynamics.findings(None, self.loading, "", lambda: 0.0), *jams]
        else:
            contact = None if self.holds else self.extremes("dynamics", _CONTACT)["contact_force"]
            wanted = getattr(self.design.drive.loads, "least_contact_force_n", None)
            found = [*dynamics.findings(contact, self.loading, self.design.drive.face.noun, lambda: self._lift_off_rpm, wanted), *jams]
            if self.holds and self.jam is None and not self.loading.empty:
                found += dynamics.change_findings(self.flank_changes, self.design.drive.cam.form)
            found += cam_checks.force_findings(self) + contact_stress.findings(self) + self._elastic_findings()
        found += dynamics.element_findings(lambda angles: self.at(angles).linkage, self.program, self.loading)
        return [*found, *(shaft.findings(self.flywheel) if self.levelled and self.jam is None else [])]

    def _elastic_findings(self) -> list[Finding]:
        if not self.is_elastic:
            return []
        try:
            self.follower_response.require_steady()
        except NoAnswer as error:
            return [Finding("no-elastic-follower", WARNING, error.field, None, {"why": error.problem, "hint": error.hint})]
        return []

    def undercut_on(self, flank: str) -> bool:
        """Whether a flank has a cusp, or crosses itself where it is curved too much. Where the velocity
        jumps the pitch curve has a corner, which is sharper than any roller."""
        corners = any(join.jumps[:2].any() for join in self.program.joins)
        return corners or cam.undercut(self.cam_extremes, flank, self.design.drive.face, self.design.drive.cam)

    def _stability_findings(self) -> list[Finding]:
        if self.design.shaft is None or self.design.shaft.elastic is None:
            return []
        from core.stability import findings

        try:
            return findings(self.flexible_shaft())
        except NoStability as error:
            return [Finding("no-stability", NOTE, error.field, None, {"why": error.problem, "hint": error.hint})]

    def certificate(self, stages: tuple[str, ...] = ()) -> dict[str, Residual]:
        """What proves the figures: each residual with its bound, of the named stages or of all."""
        return certificate(self, stages or self.stages)

    @property
    def reach(self) -> float:
        """Distance of the follower's reference point from the cam centre on the base circle [m]; where the linkage gives the
        cam its size, the largest."""
        if self.mechanism.ranged:
            return float(np.abs(self.cam.reference).max())
        return followers.reach_of(self.design.drive.follower, self.design.drive.cam)

    # -- of a linkage ---------------------------------------------------------------------------------------

    def angular_velocities(self) -> dict[int, np.ndarray]:
        """Link -> (n,) [rad/s], the frame included."""
        bodies = self.linkage.bodies
        return {n: bodies[body_name(n)].turn[1] * self.omega for n in sorted(self.design.drive.linkage.by_number)}

    def points(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Every named point: place [m] and velocity [m/s] (n,), complex."""
        kinematics, links = self.linkage, self.design.drive.linkage.by_number
        names = dict.fromkeys(name for n in sorted(links) for name in links[n].places)
        poses = {name: kinematics.bodies[body_of(kinematics, name)] for name in names}
        return {name: (pose.place(name), pose.place(name, 1) * self.omega) for name, pose in poses.items()}
