"""One drive and everything that follows from it, computed when it is read and not before."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from core import cam, dynamics, followers, mechanism, stress
from core.cam import CamShape
from core.design import NO_LIMITS, Design, Linkage, Motion, si
from core.dynamics import FlankChange, Forces, Friction, Loading
from core.errors import KindynaError, NoAnswer, NoPosition, NoSuchStage, angle_list, at_angles
from core.instant_centres import CentreTable, all_centres, cam_centres
from core.mechanism import (
    CrankMotion,
    DriverRanges,
    Mechanism,
    body_name,
    motion_extent,
    solve_mechanism,
    unit_speed_kinematics,
)
from core.mechanism.kinematics import FRAME, REVOLUTE, SLIDING, Kinematics
from core.motion import TURN, Angles, MotionState, degrees, program
from core.motion.extremes import Extreme, find_above
from core.motion.program import CutProgram, ShaftPosition
from core.numerics.lazy import locked
from core.shaft import LoadCurve, combined
from core.stress import ContactStress, contact_stresses
from core.study.stages import (
    crank_grid,
    crank_state,
    cut_grid,
    cuts,
    evaluations,
    failing_ranges,
    fitted_load,
    grid,
    memory,
)

if TYPE_CHECKING:  # most questions need nothing of it
    from core.dynamics import ContactForce, Flights, ForceOnBody, LiftOff
    from core.elastic import Elasticity, Response, Spectrum

SAMPLES = 3600
_FEW = 24  # angles, of which one at least is no dead centre


@lru_cache(maxsize=64)
def _driver_ranges(solved: Mechanism, motion: Motion | None) -> DriverRanges:
    """Where the links of a mechanism go with a motion, or through the whole turn of its crank; kept."""
    return mechanism.driver_ranges_for(
        solved, lambda: (0.0, TURN) if motion is None else motion_extent(program(motion))
    )


def _require_agreement(found: DriverRanges) -> None:
    """Raises NoPosition where links that more pairs hold than need be do not agree with each other."""
    plan = found.plan
    groups = {"-".join(map(str, step.links)) for step, _ in plan.steps if set(step.links) <= set(plan.redundant)}
    locked_by = {joint for r in found.ranges for joint in (r.low_joint, r.high_joint)}
    if found.ranges and not groups & locked_by:
        return
    from core.mechanism.unfinished import mobility

    sentences = mobility(plan.linkage).sentences
    held = ", ".join(map(str, plan.redundant))
    said = (
        "; ".join(sentences)
        or f"link {held} is held by more pairs than need be, which do not agree all through the turn"
    )
    raise NoPosition(said, "linkage", "make their lengths agree, or take one away")


class DriveStudy:
    """One drive at equally spaced angles of its cam or crank, or at the angles given.

    Stages are attributes: ``motion`` where one moves the mechanism, ``linkage``, ``cam`` where there is one, ``dynamics``.
    ``stages`` names those of the design, in the order in which they need each other. ``centres`` belongs to the stage
    ``linkage``. Each is computed on first use from only the parts of the design that it needs, and kept for every other
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
        """Those of the design, of any of its drives."""
        return self.design.stages

    def require_stage(self, name: str) -> None:
        """Raises NoSuchStage, naming the stages there are."""
        if name not in self.stages:
            raise NoSuchStage(name, self.stages)

    if not TYPE_CHECKING:  # which shall find a name that is none

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
        """[rad/s] of the shaft, counted as it turns; of a crank counter-clockwise, negative clockwise; of the cycle of one that
        swings."""
        speed = self.design.speed_rpm * TURN / 60.0
        if self.swings:
            swing = self.driver_ranges.ranges[0]
            return speed * np.pi / (swing.high - swing.low)
        speed /= self.turns
        return self.sense * speed if self.by_crank else speed

    @cached_property
    def _crank(self) -> DriverRanges | None:
        """The ranges of a crank; None where no crank drives, or the links meet nowhere, which their own stage reports."""
        if not self.by_crank:
            return None
        try:
            return self.driver_ranges
        except KindynaError:
            return None

    @property
    def swings(self) -> bool:
        """Whether a crank that cannot turn fully goes to and fro in the range in which it is drawn."""
        return self._crank is not None and self._crank.is_swinging

    @property
    def turns(self) -> int:
        """Turns of a crank in one cycle, after which every link is back."""
        return 1 if self._crank is None else self._crank.turns

    @property
    def by_cycle(self) -> bool:
        """Whether its angle is that of a cycle, and not the driver's own."""
        return self.swings or self.turns > 1

    @property
    def sense(self) -> float:
        """+1 where cam or crank turns counter-clockwise, -1 clockwise; +1 where a crank swings."""
        return 1.0 if self.swings else self.design.sense

    # -- angles ---------------------------------------------------------------------------------------------

    @property
    def angle_column(self) -> str:
        """Name of the angle's column in tables: ``cam_angle_deg``."""
        return f"{self.angle_name}_deg".replace(" ", "_")

    @property
    def angle_name(self) -> str:
        """What the angle is called: of the cam or of the crank, or of the cycle of a crank that swings."""
        return "cycle" if self.by_cycle else self.design.angle_name

    @cached_property
    def program(self) -> Any:
        """What the driver does over one turn, a Program or a CrankProgram: its pieces and joins. Its pieces end where a process
        force switches and where friction turns round in a pin, too."""
        if not (found := self._cuts):
            return self.uncut
        return memory.get(
            "cut program",
            (self.driver_ranges if self.by_crank else self.uncut, found),
            lambda: CutProgram(self.uncut, found),
        )

    @property
    def _cuts(self) -> tuple[float, ...]:
        """The angles [rad] at which its torque jumps or breaks, but for the joins of its motion."""
        drive = self.design.drive
        if not (drive.loads.process or drive.loads.pair_friction):
            return ()
        try:
            driven = self.driver_ranges if self.by_crank else drive.motion
            return cuts(self.loading, driven, self.uncut, self.mechanism, lambda: self.driver_ranges)
        except KindynaError:  # its own stage says so
            return ()

    @property
    def uncut(self) -> Any:
        """The same in its own pieces only."""
        return CrankMotion(self.driver_ranges) if self.by_crank else program(self.design.drive.motion)

    @cached_property
    def angles(self) -> Angles:
        """The angles at which the drive is studied."""
        if self._given is not None:
            return self._given
        if isinstance(self.program, CutProgram):
            return cut_grid(self.program, self.angle_degrees)
        return (
            crank_grid(self.driver_ranges, self.samples)
            if self.by_crank
            else grid(self.design.drive.motion, self.samples)
        )

    @property
    def theta(self) -> np.ndarray:
        """Angles (n,) [rad]."""
        theta: np.ndarray = self.angles.theta
        return theta

    @property
    def angle_degrees(self) -> np.ndarray:
        """The equally spaced angles of the tables [deg] (n,), each rounded once."""
        return CrankMotion(self.driver_ranges).degrees(self.samples) if self.by_crank else degrees(self.samples)

    def at(self, angles: Angles) -> Self:
        """The same design at other angles, not remembered."""
        return type(self)(self.design, self.samples, angles)

    def at_theta(self, theta: np.ndarray) -> Self:
        """The same design at any angles (n,) [rad]; at a join the right-hand limit."""
        return self.at(self.program.angles(np.atleast_1d(theta)))

    def of(self, design: Design) -> Self:
        """Another design at as many angles."""
        return type(self)(design, self.samples)

    @property
    def whole(self) -> Self:
        """The study over the whole turn, which this one is or was taken from."""
        return self if self._given is None else type(self)(self.design, self.samples)

    # -- stages ---------------------------------------------------------------------------------------------

    def _stage(self, name: str, function: Callable[..., Any], *parts: Any) -> Any:
        """function(*parts), counted; remembered by its parts over a whole turn."""

        def compute() -> Any:
            evaluations[name] += 1
            return function(*parts)

        if not self.angles.kept:
            return locked(compute())
        return memory.get((name, "searched") if self.angles.search else name, parts, compute)

    @contextmanager
    def located(self, stage: str) -> Iterator[None]:
        """Errors of a sampled stage name the angles to the last digit, whatever the sampling was."""
        try:
            yield
        except NoAnswer as error:
            if not error.cam_angles or error.exact or not self.angles.kept:
                raise
            raise at_angles(error, failing_ranges(self.at, stage, self.program)) from None

    @cached_property
    def mechanism(self) -> Mechanism:
        """The linkage that is solved. Raises NoAssembly where a follower does not come to its base position."""
        return followers.built(self.design.drive.posed, self.design.drive.cam)

    @cached_property
    def driver_ranges(self) -> DriverRanges:
        """Where the links go. Raises NoPosition where they meet nowhere."""
        found = _driver_ranges(self.mechanism, None if self.by_crank else self.design.drive.motion)
        if not self.mechanism.ranged:
            return found
        if self.mechanism.plan.redundant:
            _require_agreement(found)
        if not found.ranges:
            raise NoPosition(
                "its links cannot be put together at any position of the driver, or at single ones only",
                "linkage.links",
                "change their lengths, or linkage.branch",
            )
        if self.by_crank and not CrankMotion(found).degrees(self.samples).size:
            places = angle_list([(float(np.rad2deg(r.low)), float(np.rad2deg(r.high))) for r in found.ranges])
            raise NoPosition(
                f"its links can be put together with the crank within {places} only, where none of the {self.samples} "
                "driver angles lies",
                "linkage.links",
                "change their lengths, or ask for more angles",
            )
        return found

    @property
    def turn_ranges(self) -> tuple[tuple[float, float], ...]:
        """Where the angle can go [rad]: () for the whole turn, else the ranges between a crank's dead centres.

        Raises NoPosition where the linkage stands nowhere.
        """
        ranges = self.driver_ranges.ranges if self.by_crank and not self.swings else ()
        return () if len(ranges) == 1 and ranges[0].is_free else tuple((r.low, r.high) for r in ranges)

    @cached_property
    def drive(self) -> MotionState:
        """What moves the mechanism: the motion, or the crank's own angle, with three derivatives (4, n) [rad or m]."""
        if isinstance(self.program, CutProgram):
            return self._stage("motion", self.program.state, self.angles)
        if self.by_crank:
            return crank_state(self.driver_ranges, self.angles)
        return self._stage(
            "motion", lambda motion, angles: program(motion).state(angles), self.design.drive.motion, self.angles
        )

    @property
    def motion(self) -> MotionState:
        """The motion at these angles."""
        self.require_stage("motion")
        return self.drive

    @cached_property
    def linkage(self) -> Kinematics:
        """The solved mechanism. Raises KindynaError where it has no position."""
        with self.located("linkage"):
            return self._stage("linkage", solve_mechanism, self.mechanism, self.drive, self.driver_ranges)

    @cached_property
    def centres(self) -> CentreTable:
        """All instant centres of a linkage at every angle, by the driver's own coordinate, so that a dwell of the motion has
        them too; bodies are named as in ``linkage``."""

        def compute(linkage: Linkage, state: MotionState, driver_ranges: DriverRanges) -> CentreTable:
            return all_centres(
                unit_speed_kinematics(linkage, state.displacement[0], driver_ranges), driver_ranges.plan.size
            )

        if self.by_crank:  # its kinematics are by the crank's angle already
            return self._stage("centres", all_centres, self.linkage, self.driver_ranges.plan.size)
        return self._stage("centres", compute, self.mechanism.linkage, self.drive, self.driver_ranges)

    @cached_property
    def cam_centres(self) -> CentreTable:
        """All instant centres with the cam among the bodies, at every angle. Raises NoSuchStage where there is no cam."""
        self.require_stage("cam")
        return self._stage("cam centres", cam_centres, self.linkage, self.sense)

    @cached_property
    def _cam(self) -> CamShape:
        with self.located("cam"):
            shape: CamShape = self._stage(
                "cam", cam.envelope, self.linkage, self.design.drive.face, self.design.drive.bare_cam, self.sense
            )
            if self._given is None and self.mechanism.ranged:
                cam.require_hold(self.linkage, self.design.drive.face.noun, shape)
            return shape

    @property
    def cam(self) -> CamShape:
        """The cam. Raises NoSuchStage where the design has none, NoCam where there can be none."""
        self.require_stage("cam")
        return self._cam

    @property
    def shape(self) -> CamShape | None:
        """The cam; None where the design has none."""
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
        """All forces at constant speed. Raises NoAnswer where friction asks for reactions that statics does not fix."""
        if self.undetermined and (rubs := [f for f in self.loading.frictions if f.pair in self.undetermined]):
            raise NoAnswer(
                f"friction of {', '.join(f.pair for f in rubs)} goes by a force that statics does not fix",
                rubs[0].field,
                "take the friction away, or the link that is not needed",
            )
        return self._stage("dynamics", dynamics.newton_euler, self.linkage, self.shape, self.loading, self.omega)

    @cached_property
    def free_bodies(self) -> Mapping[str, tuple[ForceOnBody, ...]]:
        """Body -> every force on it, in equilibrium; infinite where friction jams. Bodies with reactions that statics does not fix are
        left out."""
        found = dynamics.free_bodies(self.linkage, self.shape, self.loading, self.dynamics)
        if not self.undetermined:
            return found
        pairs = self.linkage.pairs
        without = {body for name in self.undetermined for body in (pairs[name].on, pairs[name].body)}
        return MappingProxyType({body: rows for body, rows in found.items() if body not in without})

    @cached_property
    def undetermined(self) -> frozenset[str]:
        """The pairs whose reactions statics does not fix, since more of them hold the links than need be."""
        if not self.mechanism.plan.redundant:
            return frozenset()
        key = (self.design.drive.posed, self.design.drive.motion)
        from core.dynamics.forces import undetermined_pairs

        found: frozenset[str] = memory.get(
            "undetermined", key, lambda: undetermined_pairs(type(self)(self.design, _FEW).linkage)
        )
        return found

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
            raise NoAnswer(
                f"a {form} cam holds the follower from both sides, so that it cannot leave it",
                "cam.form",
                "take an open cam",
            )
        if self.loading.empty:
            raise NoAnswer(
                "nothing presses the follower on the cam: there are no masses and no spring", "loads", "give them"
            )
        if self.jam is not None:
            raise self._jammed(self.jam)
        return self._contact_force

    @cached_property
    def _contact_force(self) -> ContactForce:
        def at(angles: Angles) -> tuple[Kinematics, CamShape]:
            there = self.at(angles)
            return there.linkage, there.cam

        return dynamics.ContactForce(at, self.loading, self.program, self.omega)

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
            away = -float(np.sign(lever * self.mechanism.driver_sign))
            restitution = getattr(loads, "restitution", None) or 0.0
            return dynamics.flights(
                lambda angles: contact.at_speed(angles, self.omega),
                self.mechanism,
                self.loading,
                self.program,
                self.omega,
                away,
                restitution,
                turns,
            )

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
        from core.elastic import equivalent

        self.require_stage("cam")
        if not self.is_elastic:
            raise NoAnswer("the follower is rigid", "loads.follower_stiffness_n_per_mm", "give its stiffness")
        drive, driver_ranges, loading = self.design.drive, self.driver_ranges, self.loading
        loads, stroke = si(drive.loads), motion_extent(program(drive.motion))
        parts = (
            self.mechanism, driver_ranges, loading, drive.face, drive.bare_cam, self.sense, stroke, loads.follower_stiffness,
            loads.follower_damping_ratio or 0.0,
        )  # fmt: skip
        found: Elasticity = memory.get("elasticity", parts, lambda: equivalent(*parts))
        return found

    @property
    def follower_response(self) -> Response:
        """What the elastic follower does at the design's speed. Raises NoAnswer as ``elasticity``; see also ``Response``."""
        from core.elastic import Response

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
        from core.elastic import spectrum

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
        more = (
            one.mass * acceleration
            + one.damping * speed
            + rubs * self.omega * self.motion.displacement[1]
            + one.closing * e
        )
        return np.asarray(forces.contact - self.mechanism.driver_sign * more / forces.lever)

    @property
    def jamming_pair(self) -> Friction | None:
        """The pair that has the largest part in what jams; None: the face on the cam."""
        assert self.jam is not None
        forces = self.at_theta(np.array([self.jam.theta])).dynamics
        if not self.loading.frictions or forces.contact_jam[0] >= dynamics.JAMS:
            return None
        return self.loading.frictions[int(forces.most_jamming[0])]

    def _jammed(self, jam: Extreme) -> NoAnswer:
        angle, friction = float(np.rad2deg(jam.theta)), self.jamming_pair
        what, field = ("contact", "loads.contact_friction") if friction is None else (friction.pair, friction.field)
        return NoAnswer(f"the {what} jams, the torque is infinite", field, "lower it", [(angle, angle)])

    @property
    def flank_changes(self) -> tuple[FlankChange, ...]:
        """Where the contact goes from one flank of a groove or of a conjugate pair to the other, by cam angle."""
        if not self.holds:
            return ()
        return memory.get(
            "flank changes", self.depends_on("dynamics"), lambda: dynamics.flank_changes(self._forces_at, self.program)
        )

    @property
    def flank_impacts(self) -> tuple[FlankChange, ...]:
        """The same with the speed at which the follower strikes across the play."""
        changes = self.flank_changes
        if not changes:
            return ()
        parts = self.mechanism, self.loading, self.program, abs(self.omega), 1e-3 * self.design.drive.cam.form.play_mm
        key = self.depends_on("dynamics")
        return memory.get("flank impacts", key, lambda: dynamics.with_impacts(changes, self._forces_at, *parts))

    def _forces_at(self, angles: Angles) -> tuple[Kinematics, Forces]:
        there = self.at(angles)
        return there.linkage, there.dynamics

    @cached_property
    def stress(self) -> Mapping[str, ContactStress]:
        """By flank; empty where what touches is not known, or is an edge."""

        def compute(shape: CamShape, forces: Forces, *pairs: Any) -> Mapping[str, ContactStress]:
            rows = zip(shape.flanks, forces.contacts, pairs, strict=True)
            return {flank.name: contact_stresses(flank, contact.force, pair) for flank, contact, pair in rows}

        drive = self.design.drive
        there = stress.pairings(drive.face, drive.cam) if drive.cam is not None else {}
        return (
            self._stage("stress", compute, self.cam, self.dynamics, *(there[f.name] for f in self.cam.flanks))
            if there
            else {}
        )

    # -- what it asks of its shaft --------------------------------------------------------------------------

    @property
    def shaft_torque(self) -> np.ndarray:
        """What the shaft must be given at constant speed (n,) [N m], > 0 in its sense of rotation."""
        return self._torque_of(self.dynamics)

    def _torque_of(self, forces: Forces) -> np.ndarray:
        return self.sense * forces.driver if self.by_crank else forces.torque

    @property
    def loads_shaft(self) -> bool:
        """Whether cam or crank make the shaft carry it."""
        return self.design.drive.loads_shaft

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
        self.require_whole_turn()

    def require_whole_turn(self) -> None:
        """Raises NoPosition where a crank cannot turn fully, or comes back after several turns only."""
        if self.turns > 1:
            raise NoPosition(
                f"its cycle is {self.turns} turns of the crank, and what it asks of a shaft is known for one turn",
                "linkage.drivers" if self.design.drive.linkage.drivers else "linkage.links",
                "choose ratios and lengths with which it returns after one turn",
            )
        if self.by_crank and not (len(self.driver_ranges.ranges) == 1 and self.driver_ranges.ranges[0].is_free):
            raise NoPosition(
                "the crank cannot turn fully, so no flywheel carries it", "linkage.links", "change their lengths"
            )

    @property
    def load_curve(self) -> LoadCurve:
        """What it asks of the shaft over one turn, by the angle that the shaft has turned through. Raises NoAnswer where
        friction jams, or a crank cannot turn fully."""
        self._require_turning()
        curve: LoadCurve = memory.get("load curve", self.depends_on("dynamics"), self._turned_load)
        return curve

    def _turned_load(self) -> LoadCurve:
        slides = [f for f in self.loading.frictions if self.linkage.pairs[f.pair].kind == SLIDING]
        parts = (self._forces_at, self._torque_of, self.loading, self.program, slides, self.holds)
        curve = fitted_load(*parts)
        return curve if self.turning > 0.0 else combined([(curve, ShaftPosition(0.0, self.turning))])

    # -- what figures depend on -----------------------------------------------------------------------------

    def depends_on(self, stage: str) -> tuple[Any, ...]:
        """The parts of the design that the quantities of a stage depend on."""
        return self._depends_on[stage]

    @cached_property
    def _depends_on(self) -> Mapping[str, tuple[Any, ...]]:
        design = self.design
        drive = replace(design.drive, cam=design.drive.bare_cam, limits=NO_LIMITS)
        speed = (design.sense, design.speed_rpm)
        return {
            "motion": (drive.motion, speed),
            "linkage": (drive.motion, speed, drive.mechanism, drive.cam),
            "cam": (drive.motion, drive.mechanism, drive.cam, design.sense),
            "dynamics": (drive, speed),
            "stability": (drive, speed, design.shaft),
        }

    # -- what is read of it ---------------------------------------------------------------------------------

    @property
    def ground(self) -> str:
        """Kind of the pair that holds what the cam acts on."""
        return self.held_by(self.cam.flank.body)

    def held_by(self, body: str) -> str:
        """Kind of the pair that holds a body on the frame; a body that none holds turns with its pole."""
        pairs = self.linkage.pairs.values()
        return next((pair.kind for pair in pairs if {pair.on, pair.body} == {FRAME, body}), REVOLUTE)

    @property
    def reach(self) -> float:
        """Distance of the follower's reference point from the cam centre on the base circle [m]; where the linkage gives the
        cam its size, the largest; of a motion that is alone its largest position."""
        if self.design.drive.is_alone:
            return float(np.abs(self.motion.displacement[0]).max())
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
        poses = {name: kinematics.bodies[kinematics.body_of(name)] for name in names}
        return {name: (pose.position(name), pose.position(name, 1) * self.omega) for name, pose in poses.items()}
