"""Study of one drive from its motion to its cam; each stage is computed when it is first read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np

from core import cam, dynamics, followers, mechanism
from core.cam import CamShape
from core.design import NO_LIMITS, Design, Linkage, Motion
from core.dynamics import Lash, Loading
from core.errors import KindynaError, NoPosition, NoSolution, NoSuchStage, angle_list, at_angles
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
from core.mechanism.kinematics import FRAME, REVOLUTE, Kinematics
from core.motion import TURN, Angles, MotionState, degrees, program
from core.motion.program import SubdividedTurn
from core.numerics.derivatives import spread
from core.numerics.lazy import lazy, locked
from core.numerics.parts import part_of
from core.process import keep_freed_memory
from core.study.stages import (
    SEARCHED,
    crank_grid,
    crank_state,
    cut_grid,
    evaluations,
    failing_ranges,
    grid,
    memory,
    roller_handovers,
    torque_breaks,
)

if TYPE_CHECKING:
    from core.spatial import Machine, MotionRows, SpatialShape
    from core.study.valve_travel import ValveTravel

SAMPLES = 3600
_ATTRIBUTES = {"motion": "drive", "cam centres": "cam_centres"}
"""Stage -> attribute of a study with its result, where the name is another."""


@lru_cache(maxsize=64)
def _driver_ranges(solved: Mechanism, motion: Motion | None) -> DriverRanges:
    """Ranges of the driver over the positions of a motion, or over the full turn of a crank."""
    return mechanism.driver_ranges_for(
        solved, lambda: (0.0, TURN) if motion is None else motion_extent(program(motion))
    )


def _require_agreement(driver_ranges: DriverRanges) -> None:
    """Raises NoPosition where the redundant pairs of an overconstrained linkage do not agree with each other."""
    plan = driver_ranges.plan
    groups = {"-".join(map(str, step.links)) for step, _ in plan.steps if set(step.links) <= set(plan.redundant)}
    locked_by = {joint for r in driver_ranges.ranges for joint in (r.low_joint, r.high_joint)}
    if driver_ranges.ranges and not groups & locked_by:
        return
    from core.mechanism.unfinished import mobility

    sentences = mobility(plan.linkage).sentences
    links = ", ".join(map(str, plan.redundant))
    problem = "; ".join(sentences) or f"link {links} has redundant pairs, which do not agree over the full turn"
    raise NoPosition(problem, "linkage", "make their lengths agree, or remove one")


class _NotSolvedError(Exception):
    """A stage is not cached."""


def _union(sets: tuple[Angles, ...]) -> Angles:
    """Angles of several sets, one set after the other; equal arguments return the same object."""

    def compute() -> Angles:
        theta, piece = (np.concatenate([getattr(angles, name) for angles in sets]) for name in ("theta", "piece"))
        return Angles(theta, piece, cached=True, search=True)

    return memory.get("union", sets, compute)


class DriveStudy:
    """One drive from its motion to its cam, at equally spaced angles of its cam or crank, or at given angles.

    Stages are attributes: ``motion`` where one drives the mechanism, ``linkage``, ``cam`` where there is one. ``stages`` names
    the stages of the design, in the order in which they need each other; ``centres`` belongs to the stage ``linkage``. A stage
    is computed on first use from the parts of the design it needs, and cached for every other study that shares these parts. A
    stage without a solution raises NoSolution, a stage that this design lacks raises NoSuchStage.

    A crank that cannot turn fully is sampled within its ranges: then there are fewer angles than samples.
    """

    _larger: tuple[Self, slice | np.ndarray] | None = None
    """Study of which the results are a part, and the numbers of its angles."""
    _solves = True
    """Whether stages may be solved, and not only read from the cache."""
    _names_ranges = True
    """Whether errors name the exact ranges of angles."""
    _followed: DriverRanges | None = None
    """Ranges of a similar design, whose branch is followed."""

    def __init__(self, design: Design, samples: int = SAMPLES, angles: Angles | None = None) -> None:
        keep_freed_memory()
        self.design = design
        self.samples = samples
        self._given = angles

    # -- the drive ------------------------------------------------------------------------------------------

    @property
    def stages(self) -> tuple[str, ...]:
        """Stages of the design, of any of its drives."""
        return self.design.stages

    def require_stage(self, name: str) -> None:
        """Raises NoSuchStage, which names the stages of the design, where this stage is not among them."""
        if name not in self.stages:
            raise NoSuchStage(name, self.stages)

    if not TYPE_CHECKING:  # so that a type checker reports an unknown name

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_"):
                raise AttributeError(name)
            raise NoSuchStage(name, self.stages)

    @property
    def has_disk(self) -> bool:
        """Whether the design, or any of its drives, has a disk cam."""
        return any(drive.has_disk for drive in self.design.drives)

    @property
    def has_surface(self) -> bool:
        """Whether the design is one drive with a cam in space."""
        return not self.design.listed and self.design.drive.has_surface

    @property
    def by_crank(self) -> bool:
        """Whether a crank that turns at constant speed drives the mechanism, in place of a motion."""
        return self.design.by_crank

    @property
    def kind(self) -> str:
        """Slug of the kind of mechanism."""
        return self.design.drive.kind

    @property
    def omega(self) -> float:
        """Speed ω [rad/s]: of the shaft, positive in its sense of rotation; of a crank, positive counter-clockwise.

        Where the crank swings, of its cycle.
        """
        speed = self.design.speed_rpm * TURN / 60.0
        if self.swings:
            swing = self.driver_ranges.ranges[0]
            return speed * np.pi / (swing.high - swing.low)
        speed /= self.turns
        return self.sense * speed if self.by_crank else speed

    @lazy
    def _crank(self) -> DriverRanges | None:
        """Ranges of a crank; None where no crank drives, or where it has none, which the stage ``linkage`` reports."""
        if not self.by_crank:
            return None
        try:
            return self.driver_ranges
        except KindynaError:
            return None

    @property
    def swings(self) -> bool:
        """Whether a crank that cannot turn fully swings in the range in which it is drawn."""
        return self._crank is not None and self._crank.is_swinging

    @property
    def turns(self) -> int:
        """Turns of a crank in one cycle, after which every link has returned."""
        return 1 if self._crank is None else self._crank.turns

    @property
    def by_cycle(self) -> bool:
        """Whether the angle of the study is that of a cycle, and not of the driver."""
        return self.swings or self.turns > 1

    @property
    def sense(self) -> float:
        """Sense of rotation of cam or crank: +1 counter-clockwise, -1 clockwise; +1 where a crank swings."""
        return 1.0 if self.swings else self.design.sense

    # -- angles ---------------------------------------------------------------------------------------------

    @property
    def angle_column(self) -> str:
        """Column of the angle in tables, for example ``cam_angle_deg``."""
        return f"{self.angle_name}_deg".replace(" ", "_")

    @property
    def angle_name(self) -> str:
        """Name of the angle: cam angle, crank angle, or cycle where the crank swings or returns after several turns."""
        return "cycle" if self.by_cycle else self.design.angle_name

    @lazy
    def program(self) -> Any:
        """Pieces and joins of the driver over one turn, a CompiledMotion or a CrankMotion.

        Pieces also end where a process force switches and where the friction in a pin reverses.
        """
        if not (breaks := self._torque_breaks):
            return self.uncut
        key = (self.driver_ranges if self.by_crank else self.uncut, breaks)
        return memory.get("cut program", key, lambda: SubdividedTurn(self.uncut, breaks))

    @property
    def _torque_breaks(self) -> tuple[float, ...]:
        """Angles [rad] at which the torque jumps or breaks, or another roller takes over, except the joins of the motion."""
        drive = self.design.drive
        handovers = roller_handovers(self.machine, drive.motion) if drive.has_surface and drive.cam.rollers > 1 else ()
        if not (drive.loads.process or drive.loads.pair_friction or (drive.valve and drive.valve.lash_mm)):
            return handovers
        try:
            driver = self.driver_ranges if self.by_crank else drive.motion
            breaks = torque_breaks(self.loading, driver, self.uncut, self.mechanism, lambda: self.driver_ranges)
        except KindynaError:  # the stage ``linkage`` reports it
            return handovers
        return tuple(sorted({*breaks, *handovers})) if handovers else breaks

    @property
    def uncut(self) -> Any:
        """The program of the driver in the pieces of its motion only."""
        return CrankMotion(self.driver_ranges) if self.by_crank else program(self.design.drive.motion)

    @lazy
    def angles(self) -> Angles:
        """Angles of the study, (n,)."""
        if self._given is not None:
            return self._given
        if isinstance(self.program, SubdividedTurn):
            return cut_grid(self.program, self.angle_degrees)
        return (
            crank_grid(self.driver_ranges, self.samples)
            if self.by_crank
            else grid(self.design.drive.motion, self.samples)
        )

    @property
    def theta(self) -> np.ndarray:
        """Angles of the study (n,) [rad]."""
        theta: np.ndarray = self.angles.theta
        return theta

    @property
    def angle_degrees(self) -> np.ndarray:
        """Equally spaced angles of the tables (n,) [deg], each rounded once."""
        return CrankMotion(self.driver_ranges).degrees(self.samples) if self.by_crank else degrees(self.samples)

    def at(self, angles: Angles) -> Self:
        """Study of the same design at other angles; the same study for the same angles where their results are cached."""
        if not angles.cached:
            return self._at_angles(angles)
        if angles not in self._at:
            self._at[angles] = self._at_angles(angles)
        return self._at[angles]

    def _at_angles(self, angles: Angles | None) -> Self:
        study = type(self)(self.design, self.samples, angles)
        study._followed = self._followed
        return study

    @lazy
    def _at(self) -> dict[Angles, Self]:
        return {}

    def at_theta(self, theta: np.ndarray) -> Self:
        """Study of the same design at given angles.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Cam or crank angles; at a join the right-hand limit is taken.

        Returns
        -------
        DriveStudy
        """
        return self.at(self.program.angles(np.atleast_1d(theta)))

    def part(self, angles: Angles, selected: slice | np.ndarray) -> Self:
        """Study at some of the angles of this study, whose results are parts of the results here.

        Parameters
        ----------
        angles : Angles
            The k angles.
        selected : slice or ndarray (k,) of int, dimensionless
            Their numbers among the angles of this study.

        Returns
        -------
        DriveStudy
        """
        study = self._at_angles(angles)
        study._larger = self, selected
        return study

    def with_design(self, design: Design) -> Self:
        """Study of another design with the same number of samples."""
        return type(self)(design, self.samples)

    @property
    def full_turn(self) -> Self:
        """Study of the same design over the full turn."""
        return self if self._given is None else self._at_angles(None)

    def follow(self, study: Self) -> Self:
        """Follow the branch of a similar design, if its driver ranges are known, in place of a search; returns this study.

        While a joint is dragged, each design differs a little from the last. Where the linkage then has no position, the ranges
        are searched.
        """
        self._followed = vars(study).get("driver_ranges")
        return self

    @property
    def follows(self) -> bool:
        """Whether the driver ranges follow those of another design, and are not searched."""
        return self._followed is not None

    # -- stages ---------------------------------------------------------------------------------------------

    def _stage(self, name: str, function: Callable[..., Any], *parts: Any) -> Any:
        """Result of function(*parts), counted as a solution of a stage and cached as by ``_cached``."""

        def compute(*parts: Any) -> Any:
            if self._larger is not None:
                larger, selected = self._larger
                return part_of(getattr(larger, _ATTRIBUTES.get(name, name)), selected, larger.theta.size)
            evaluations[name] += 1
            return function(*parts)

        return self._cached(name, compute, *parts)

    def _cached(self, name: str, function: Callable[..., Any], *parts: Any) -> Any:
        """Result of function(*parts), cached by its parts where the angles are those of a full turn."""
        if not self.angles.cached:
            return locked(function(*parts))
        kind = (name, SEARCHED) if self.angles.search else name
        if not self._solves and not memory.has(kind, parts):
            raise _NotSolvedError
        return memory.get(kind, parts, lambda: function(*parts), is_locked=self._larger is not None)

    def solve_together(self, stages: Sequence[str], sets: Sequence[Angles]) -> None:
        """Solve stages at several sets of cached angles at once; studies at these angles then read their part from the cache.

        Sets that are solved already are left out. Where a stage has no solution, it and those after it are left to the study that
        reads them, which raises the error.
        """
        unknown = [angles for angles in sets if not self._solved.get(angles, frozenset()).issuperset(stages)]
        self._solved.update(dict.fromkeys(unknown, frozenset(stages)))
        with suppress(KindynaError):
            missing = [angles for angles in unknown if not self._is_cached(stages, angles)]
            if len(missing) < 2:
                return
            union = self.at(_union(tuple(missing)))
            union._names_ranges = False
            ends = np.cumsum([angles.theta.size for angles in missing]).tolist()
            parts = [
                union.part(angles, slice(end - angles.theta.size, end))
                for angles, end in zip(missing, ends, strict=True)
            ]
            for stage in stages:
                for part in parts:
                    getattr(part, stage)
            self._at.update(zip(missing, parts, strict=True))

    @lazy
    def _solved(self) -> dict[Angles, frozenset[str]]:
        """Angles -> stages that ``solve_together`` has solved or tried to solve there."""
        return {}

    def _is_cached(self, stages: Sequence[str], angles: Angles) -> bool:
        """Whether the results of stages at these angles are cached."""
        study = self._at_angles(angles)
        study._solves = False
        try:
            for stage in stages:
                getattr(study, stage)
        except _NotSolvedError:
            return False
        return True

    @contextmanager
    def with_exact_angles(self, stage: str) -> Iterator[None]:
        """Errors of a sampled stage name the exact ends of the ranges that fail, which do not depend on the sampling."""
        try:
            yield
        except NoSolution as error:
            if not error.cam_angles or error.exact or not self.angles.cached or not self._names_ranges:
                raise
            raise at_angles(error, failing_ranges(self.at, stage, self.program)) from None

    @lazy
    def mechanism(self) -> Mechanism:
        """Mechanism to be solved. Raises NoAssembly where a follower does not reach its base position."""
        return followers.built(self.design.drive.posed, self.design.drive.cam)

    @lazy
    def driver_ranges(self) -> DriverRanges:
        """Ranges of the driver in which the links can be assembled. Raises NoPosition where there are none."""
        motion = None if self.by_crank else self.design.drive.motion
        if (followed := self._followed_ranges(motion)) is not None:
            return followed
        self._followed = None
        result = _driver_ranges(self.mechanism, motion)
        if not self.mechanism.ranged:
            return result
        if self.mechanism.plan.redundant:
            _require_agreement(result)
        if not result.ranges:
            raise NoPosition(
                "its links cannot be assembled at any position of the driver, or at single ones only",
                "linkage.links",
                "change their lengths, or linkage.branch",
            )
        if self.by_crank and not CrankMotion(result).degrees(self.samples).size:
            ranges = angle_list([(float(np.rad2deg(r.low)), float(np.rad2deg(r.high))) for r in result.ranges])
            raise NoPosition(
                f"its links can be assembled only for crank angles within {ranges}, which contain none of the "
                f"{self.samples} driver angles",
                "linkage.links",
                "change their lengths, or increase the number of angles",
            )
        return result

    def _followed_ranges(self, motion: Motion | None) -> DriverRanges | None:
        """Ranges with the branch of those to follow; None where there is none, or another motion needs other ranges."""
        last = self._followed
        if last is None or not last.ranges or not self.mechanism.ranged:
            return None
        if motion is not None and motion_extent(program(motion)) != (last.ranges[0].low, last.ranges[0].high):
            return None
        return mechanism.followed_ranges(self.mechanism.linkage, last)

    def _search(self) -> None:
        """Search the driver ranges in place of following others, and solve again what depends on them."""
        typed = {name: vars(self)[name] for name in ("design", "samples", "_given")}
        vars(self).clear()
        vars(self).update(typed)

    @property
    def turn_ranges(self) -> tuple[tuple[float, float], ...]:
        """Ranges of the angle [rad] between a crank's dead centres; () for the full turn.

        Raises NoPosition where the linkage cannot be assembled anywhere.
        """
        ranges = self.driver_ranges.ranges if self.by_crank and not self.swings else ()
        return () if len(ranges) == 1 and ranges[0].is_free else tuple((r.low, r.high) for r in ranges)

    @lazy
    def drive(self) -> MotionState:
        """State of the driver: the motion, or the angle of the crank, with three derivatives (4, n) [rad or m]."""
        if isinstance(self.program, SubdividedTurn):
            return self._stage("motion", self.program.state, self.angles)
        if self.by_crank:
            return crank_state(self.driver_ranges, self.angles)
        return self._stage(
            "motion", lambda motion, angles: program(motion).state(angles), self.design.drive.motion, self.angles
        )

    @property
    def motion(self) -> MotionState:
        """Motion at the angles of the study. Raises NoSuchStage where a crank drives."""
        self.require_stage("motion")
        return self.drive

    @lazy
    def linkage(self) -> Kinematics:
        """Kinematics of the mechanism. Raises KindynaError where it has no position."""
        with self.with_exact_angles("linkage"):
            try:
                return self._stage("linkage", solve_mechanism, self.mechanism, self.drive, self.driver_ranges)
            except NoSolution:
                if not self.follows:
                    raise
        self._search()
        return self.linkage

    @lazy
    def centres(self) -> CentreTable:
        """All instant centres of a linkage at every angle; bodies are named as in ``linkage``.

        Derivatives are taken by the coordinate of the driver, so that a dwell of the motion has centres too.
        """

        def compute(linkage: Linkage, state: MotionState, driver_ranges: DriverRanges) -> CentreTable:
            return all_centres(
                unit_speed_kinematics(linkage, state.displacement[0], driver_ranges), driver_ranges.plan.size
            )

        if self.by_crank:  # its kinematics already have derivatives by the crank's angle
            return self._stage("centres", all_centres, self.linkage, self.driver_ranges.plan.size)
        return self._stage("centres", compute, self.mechanism.linkage, self.drive, self.driver_ranges)

    @lazy
    def cam_centres(self) -> CentreTable:
        """All instant centres at every angle, the cam included. Raises NoSuchStage where there is no cam."""
        self.require_stage("cam")
        return self._stage("cam centres", cam_centres, self.linkage, self.sense)

    @lazy
    def _cam(self) -> CamShape:
        with self.with_exact_angles("cam"):
            shape: CamShape = self._stage(
                "cam", cam.envelope, self.linkage, self.design.drive.face, self.design.drive.bare_cam, self.sense
            )
            if self._given is None and self.mechanism.ranged:
                cam.require_drivable(self.linkage, self.design.drive.face.noun, shape)
            return shape

    @property
    def cam(self) -> CamShape:
        """Shape of a disk cam. Raises NoSuchStage where the design has no cam, NoCam where none is possible.

        The stage of a cam in space has another shape, ``surface``.
        """
        self.require_stage("cam")
        return cast(CamShape, self._surface) if self.has_surface else self._cam

    @property
    def machine(self) -> Machine:
        """Dimensions of a cam in space."""
        from core.spatial import machine_of  # imported here to save start-up time

        drive = self.design.drive
        return machine_of(drive.bare_cam, drive.motion_unit)

    @lazy
    def _surface(self) -> SpatialShape:
        from core.spatial import MotionRows, spatial_shape  # as above

        def shape(machine: Machine, state: MotionState, sense: float) -> SpatialShape:
            rows = (spread(state.displacement[order], state.theta.size) for order in range(3))
            return spatial_shape(machine, MotionRows(state.theta, *rows), sense)

        with self.with_exact_angles("cam"):
            result: SpatialShape = self._stage("cam", shape, self.machine, self.drive, self.sense)
            return result

    def motion_rows(self, theta: np.ndarray) -> MotionRows:
        """Motion with two derivatives at any cam angles, as the flanks of a cam in space need it.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Cam angles. The end of the turn has the left-hand limit; beyond it the motion repeats, with its advance.

        Returns
        -------
        MotionRows
        """
        from core.spatial import MotionRows  # as above

        turns = np.where((theta < 0.0) | (theta > TURN), np.floor(theta / TURN), 0.0)
        inside, starts = np.clip(theta - turns * TURN, 0.0, TURN), self.uncut.starts
        state = self.uncut.state(Angles(inside, np.searchsorted(starts, inside, side="right") - 1))
        y, y_1, y_2 = (spread(state.displacement[order], theta.size) for order in range(3))
        return MotionRows(theta, y + turns * self.advance, y_1, y_2)

    @lazy
    def advance(self) -> float:
        """Motion at the end of the turn less that at its start [m or rad]."""
        ends = self.uncut.state(Angles(np.array([0.0, TURN]), np.array([0, self.uncut.starts.size - 1])))
        return float(np.diff(spread(ends.displacement[0], 2))[0])

    @lazy
    def rib_thickness(self) -> np.ndarray:
        """Least thickness (n,) [m] of a cam's ribs between rollers at the cam angles of the flank ahead."""
        from core.spatial import rib_thickness  # as above

        return rib_thickness(self.machine, self.surface.motion, self.motion_rows, self.sense)

    @property
    def surface(self) -> SpatialShape:
        """Shape of a cam in space. Raises NoSuchStage where the design has none, NoCam where none is possible."""
        if not self.has_surface:
            raise NoSuchStage("surface", self.stages)
        return self._surface

    @property
    def shape(self) -> CamShape | None:
        """Shape of the disk cam; None where the design has none."""
        return self.cam if self.has_disk else None

    @lazy
    def valve(self) -> ValveTravel:
        """Travel of the valve of the drive."""
        from core.study.valve_travel import ValveTravel  # few drives have one

        return ValveTravel(self.design.drive, self.mechanism, self.uncut, lambda: self.driver_ranges)

    @lazy
    def lash(self) -> Lash | None:
        """Lash of the valve train; None without lash. Raises NoAssembly where the train does not take it up."""
        valve = self.design.drive.valve
        if valve is None or not valve.lash_mm:
            return None
        result: Lash = memory.get("lash", self.depends_on("linkage"), lambda: self.valve.lash)
        return result

    @lazy
    def loading(self) -> Loading:
        """Loads of the drive as force elements."""
        parts = (self.design.drive.mechanism, self.design.drive.loads, self.mechanism, self.lash)
        loads: Loading = memory.get("loading", parts, lambda: dynamics.loading_of(*parts))
        return loads

    # -- dependencies ---------------------------------------------------------------------------------------

    def depends_on(self, stage: str) -> tuple[Any, ...]:
        """Parts of the design on which the quantities of a stage depend; key of the cache."""
        return self._depends_on[stage]

    @lazy
    def _depends_on(self) -> Mapping[str, tuple[Any, ...]]:
        design = self.design
        drive = replace(design.drive, cam=design.drive.bare_cam, limits=NO_LIMITS)
        speed = (design.sense, design.speed_rpm, self._followed)
        return {
            "motion": (drive.motion, speed),
            "linkage": (drive.motion, speed, drive.mechanism, drive.cam, drive.valve, design.engine),
            "cam": (drive.motion, drive.mechanism, drive.cam, design.sense, self._followed),
            "dynamics": (drive, speed),
            "stability": (drive, speed, design.shaft),
        }

    # -- follower and linkage -------------------------------------------------------------------------------

    def frame_pair_kind(self, body: str) -> str:
        """Kind of the pair between a body and the frame; revolute where there is none, since the body turns about its pole."""
        pairs = self.linkage.pairs.values()
        return next((pair.kind for pair in pairs if {pair.on, pair.body} == {FRAME, body}), REVOLUTE)

    @property
    def reach(self) -> float:
        """Distance of the follower's reference point from the cam centre on the base circle [m].

        Where the linkage sets the size of the cam, the greatest distance; of a motion by itself, its greatest position.
        """
        if self.design.drive.is_alone:
            return float(np.abs(self.motion.displacement[0]).max())
        if self.mechanism.ranged:
            return float(np.abs(self.cam.reference).max())
        return followers.reach_of(self.design.drive.follower, self.design.drive.cam)

    def angular_velocities(self) -> dict[int, np.ndarray]:
        """Angular velocities of all links, the frame included.

        Returns
        -------
        dict of int -> ndarray (n,) [rad/s]
            Number of the link -> angular velocity.
        """
        bodies = self.linkage.bodies
        return {n: bodies[body_name(n)].turn[1] * self.omega for n in sorted(self.design.drive.linkage.by_number)}

    def points(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Positions and velocities of all named points.

        Returns
        -------
        dict of str -> (position, velocity)
            Complex ndarray (n,) [m] and complex ndarray (n,) [m/s].
        """
        kinematics, links = self.linkage, self.design.drive.linkage.by_number
        names = dict.fromkeys(name for n in sorted(links) for name in links[n].places)
        poses = {name: kinematics.bodies[kinematics.body_of(name)] for name in names}
        return {name: (pose.position(name), pose.position(name, 1) * self.omega) for name, pose in poses.items()}
