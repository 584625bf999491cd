"""A linkage and everything that follows from it, computed when asked and not before."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from core import cam, dynamics, mechanism, motion
from core.cam import CamShape
from core.design import CRANK, Linkage, LinkageCam, LinkageDesign, LinkageLoads, si
from core.dynamics import LinkageForces, LinkLoading, link_loading, linkage_forces
from core.errors import NoAnswer, NoPosition, angle_list
from core.extremes import Extreme, Range
from core.findings import ERROR, LEAST_BOUND, NOTE, Finding, Residual
from core.instant_centres import CentreTable, all_centres, moving_collinearity
from core.mechanism import Course, CrankProgram, body_name, course_of, linkage_train, swept, unit_speed_train
from core.motion import EPS, Angles, MotionState, Program, degrees, program
from core.study.base import Study
from core.study.linkage_quantities import body_of, names_of, quantity
from core.study.quantities import Quantity
from core.study.stages import cam_stage, grid, motion_stage, remembered, stage
from core.train import REVOLUTE, Train

_AT_END = 1e-9  # [rad] from a dead centre: what grows towards it and has its extreme so near has none
_POSITIONS = 120  # at which the centres are proven
_SAYS_NOTHING = 1e-6  # a bound above it, of unit vectors, would pass lines that plainly miss each other
_AT_CHANGE = 1e-3  # the same from a change point, where samples fall beside it


@remembered
def crank_grid(course: Course, samples: int) -> Angles:
    """Equally spaced driver angles over one turn, as far as the linkage can be assembled there."""
    run = CrankProgram(course)
    return run.angles(np.deg2rad(run.degrees(samples)), kept=True)


@remembered
def crank_state(course: Course, angles: Angles) -> MotionState:
    return CrankProgram(course).state(angles)


@stage("linkage")
def mechanism_stage(linkage: Linkage, roller: LinkageCam | None, course: Course, state: MotionState) -> Train:
    return linkage_train(linkage, state, course, roller)


@stage("centres")
def centres_of(linkage: Linkage, course: Course, state: MotionState) -> CentreTable:
    """By the driver's own coordinate, so that a dwell of the motion has centres too."""
    train = unit_speed_train(linkage, state.y[0], course)
    return all_centres(train, course.plan.size)


@stage("dynamics")
def statics_stage(train: Train, shape: CamShape | None, loading: LinkLoading, omega: float) -> LinkageForces:
    return linkage_forces(train, loading, omega, _contact(shape))


@remembered
def link_loads(loads: LinkageLoads) -> LinkLoading:
    return link_loading(loads, body_name)


def _contact(shape: CamShape | None) -> tuple[np.ndarray, np.ndarray, float] | None:
    return None if shape is None else (shape.reference, shape.flank.normal, shape.sense)


def _worst(residual: np.ndarray, bound: np.ndarray) -> Residual:
    """Of residuals with their own bounds (n,) the one that comes nearest to its bound, or lies farthest beyond."""
    i = int(np.argmax(residual / np.maximum(bound, LEAST_BOUND)))
    return Residual(float(residual[i]), float(bound[i]))


class LinkageStudy(Study, of=LinkageDesign):
    """Stages ``linkage`` and ``dynamics``; ``motion`` where it drives a link, ``cam`` where a cam makes it.

    The angle is the crank's own, or the cam's (the turn of the motion). A crank that cannot turn fully is looked at where
    it can: then there are fewer angles than samples. ``centres`` belongs to the stage ``linkage``, and is counted by itself.
    """

    design: LinkageDesign
    angle_column, angle_name = "driver_angle_deg", "driver angle"

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        there = {"motion": self.design.motion, "linkage": True, "cam": self.design.cam, "dynamics": True}
        return tuple(name for name, has in there.items() if has is not None)

    # -- stages -----------------------------------------------------------------------------------------

    @property
    def by_crank(self) -> bool:
        """The driver turns at speed, and no motion tells it how."""
        return self.design.linkage.driver.kind == CRANK

    @cached_property
    def _places(self) -> Linkage:
        """The linkage at a speed of 1: no place and no derivative by the angle depends on it, so that another speed solves
        nothing anew."""
        linkage = self.design.linkage
        return replace(linkage, driver=replace(linkage.driver, speed_rpm=1.0))

    @cached_property
    def _roller(self) -> LinkageCam | None:
        """The roller's centre, which is where it is whatever its radius."""
        part: LinkageCam | None = self.design.cam
        return part and replace(part, roller_radius_mm=1.0)

    @cached_property
    def course(self) -> Course:
        """Ranges, change points and turning of the links. Raises NoPosition where they meet nowhere."""
        ends = () if self.by_crank else swept(program(self.design.motion))
        found = course_of(self._places, *ends)
        if not found.ranges:
            raise NoPosition(
                "its links cannot be put together at any position of the driver, or at single ones only", "linkage.links",
                "change their lengths, or linkage.branch",
            )  # fmt: skip
        if self.by_crank and self._between_samples(found):
            places = angle_list([(float(np.rad2deg(r.low)), float(np.rad2deg(r.high))) for r in found.ranges])
            raise NoPosition(
                f"its links can be put together with the crank within {places} only, where none of the {self.samples} "
                "driver angles lies", "linkage.links", "change their lengths, or ask for more angles",
            )  # fmt: skip
        return found

    def _between_samples(self, course: Course) -> bool:
        """Whether the crank's ranges are so short that no angle of the grid lies in them."""
        longest = max(r.high - r.low for r in course.ranges)
        return longest * self.samples < 4.0 * np.pi and not CrankProgram(course).degrees(self.samples).size

    @cached_property
    def program(self) -> Program | CrankProgram:
        """What the driver does over one turn: its pieces and joins."""
        return CrankProgram(self.course) if self.by_crank else program(self.design.motion)

    @cached_property
    def angles(self) -> Angles:
        if self._given is not None:
            return self._given
        return crank_grid(self.course, self.samples) if self.by_crank else grid(self.design.motion, self.samples)

    @property
    def angle_degrees(self) -> np.ndarray:
        return CrankProgram(self.course).degrees(self.samples) if self.by_crank else degrees(self.samples)

    @cached_property
    def drive(self) -> MotionState:
        """Where the driver is (4, n) [rad or m]."""
        if self.by_crank:
            return self._stage(crank_state, self.course, self.angles)
        return self._stage(motion_stage, self.design.motion, self.angles)

    @property
    def motion(self) -> MotionState:
        self.require_stage("motion")
        return self.drive

    @cached_property
    def linkage(self) -> Train:
        try:
            return self._stage(mechanism_stage, self._places, self._roller, self.course, self.drive)
        except NoAnswer as error:
            raise self._located(error, "linkage") from None

    @cached_property
    def centres(self) -> CentreTable:
        """All instant centres at every angle; bodies are named as in ``linkage``."""
        return self._stage(centres_of, self._places, self.course, self.drive)

    @cached_property
    def _cam(self) -> CamShape:
        try:
            shape: CamShape = self._stage(cam_stage, self.linkage, self.design.cam, self.sense)
            if self._given is None:
                cam.require_hold(self.linkage)
            return shape
        except NoAnswer as error:
            raise self._located(error, "cam") from None

    @property
    def cam(self) -> CamShape:
        self.require_stage("cam")
        return self._cam

    @cached_property
    def dynamics(self) -> LinkageForces:
        return self._stage(statics_stage, self.linkage, self._shape, self.loading, self.omega)

    @property
    def _shape(self) -> CamShape | None:
        return self.cam if self.design.cam is not None else None

    @property
    def loading(self) -> LinkLoading:
        loads: LinkLoading = link_loads(self.design.loads)
        return loads

    # -- what stages share ------------------------------------------------------------------------------

    @property
    def kind(self) -> str:
        return "linkage"

    @property
    def omega(self) -> float:
        """[rad/s] of the crank, negative clockwise; of a motion's shaft, which is counted as it turns, positive."""
        speed: float = si(self.design.linkage.driver).speed
        return speed if self.by_crank else abs(speed)

    @property
    def sense(self) -> float:
        """+1 where crank or cam turns counter-clockwise, -1 clockwise."""
        return float(np.sign(self.design.linkage.driver.speed_rpm))

    def quantities(self, stage: str | None = None) -> Mapping[str, Quantity]:
        rows = {name: quantity(name) for name in names_of(self.design)}
        told = {name: row for name, row in rows.items() if stage in (None, row.stage)}
        if stage in (None, "linkage"):
            for link, turning in self.course.turning.items():
                name = f"link.{link}"
                if turning.turns and name in told:
                    told[name] = replace(told[name], turns=True)
        return told

    def _figures_depend_on(self, stage: str, only: tuple[str, ...] = ()) -> Any:
        design = self.design
        loads = design.loads if stage == "dynamics" else None
        return design.linkage, design.motion, design.cam if stage != "motion" else None, loads

    # -- figures ----------------------------------------------------------------------------------------

    @np.errstate(invalid="ignore", over="ignore")  # infinite rates at dead centres
    def _extremes(self, stage: str, only: tuple[str, ...]) -> Mapping[str, Range]:
        found = super()._extremes(stage, only)
        if not self.by_crank:
            return found
        return {name: Range(self._limit(name, r.low), self._limit(name, r.high)) for name, r in found.items()}

    def _limit(self, name: str, extreme: Extreme) -> Extreme:
        """An extreme right at a dead centre, or at a change point, is infinite where it grows without limit there."""
        for r in self.course.ranges:
            for end, joint, inwards in ((r.low, r.low_joint, 1.0), (r.high, r.high_joint, -1.0)):
                if joint and abs(extreme.theta - end) < _AT_END and self._grows(name, end, inwards):
                    return Extreme(float(np.copysign(np.inf, extreme.value)), end)
        for change in self.course.changes:
            if abs(extreme.theta - change.at) < _AT_CHANGE and self._grows(name, change.at, 1.0):
                return Extreme(float(np.copysign(np.inf, extreme.value)), change.at)
        return extreme

    def _grows(self, name: str, place: float, way: float) -> bool:
        """Whether a quantity grows without limit towards a place: a hundred times nearer it is more than five times as large."""
        steps = place + way * np.array([1e-7, 1e-5])
        nearer, near = np.abs(quantity(name).value(self.at(self.program.angles(steps))))
        return bool(nearer > 5.0 * near)

    def _findings_of(self, stage: str) -> list[Finding]:
        rows: Mapping[str, Callable[[], list[Finding]]] = {
            "motion": lambda: motion.findings(program(self.design.motion)),
            "linkage": self._linkage_findings,
            "cam": self._cam_findings,
            "dynamics": self._dynamics_findings,
        }
        return rows[stage]()

    def _dynamics_findings(self) -> list[Finding]:
        if self.loading.empty:
            return [Finding("no-load", NOTE, "loads", None)]
        if self.design.cam is None:
            return []
        least = self.extremes("dynamics", ("roller_force",))["roller_force"].low
        if least.value > 0.0:
            return []
        return [Finding("separation", ERROR, "loads", float(np.rad2deg(least.theta)), {"force_n": least.value})]

    def _cam_findings(self) -> list[Finding]:
        part, train = self.design.cam, self.linkage
        assert part is not None
        ground = train.pairs[train.ground].kind if train.ground else REVOLUTE
        return cam.findings(self._cam_extremes, ground, part)

    @property
    def _undercut(self) -> bool:
        """Where the velocity jumps the pitch curve has a corner, which is sharper than any roller."""
        assert self.design.cam is not None
        corners = any(join.jumps[:2].any() for join in program(self.design.motion).joins)
        return corners or cam.undercut(self._cam_extremes, self.design.cam)

    @property
    def _cam_extremes(self) -> Mapping[str, Range]:
        return self.extremes("cam", ("pressure_angle", "pitch_curvature"))

    def _linkage_findings(self) -> list[Finding]:
        names = [n for n in names_of(self.design) if n.startswith("transmission.")]
        extremes = self.extremes("linkage", tuple(names)) if names else {}
        by_joint = {name.removeprefix("transmission."): r for name, r in extremes.items()}
        return mechanism.findings(self.course, by_joint, self.by_crank)

    def certificate(self, stages: tuple[str, ...] = ()) -> dict[str, Residual]:
        wanted = stages or self.stages
        proof: dict[str, Residual] = {}
        if "motion" in wanted:
            last = self.program.joins[-1]
            stroke = float(np.ptp(self.motion.y[0])) or 1.0
            proof["motion_closure"] = Residual(abs(float(last.jump[0])) / stroke, 1e-9 * max(1.0, 1.0 / stroke))
        if "linkage" in wanted:
            train = self.linkage
            proof["loop_closure"] = _worst(train.residual, EPS * train.condition)
            proof["three_centres"] = self._three_centres()
        if "cam" in wanted:
            centre = cam.centre_residual(self.linkage, self.cam)
            proof["instant_centre"] = _worst(centre, 16.0 * EPS * self.linkage.condition * self.cam.centre.doubt)
            radius: float = si(self.design.cam).roller_radius
            reach = float(np.abs(self.cam.flank.pitch).max())
            proof["roller_tangency"] = cam.tangency(
                self.cam, radius, reach, 64.0 * EPS, lambda: self._undercut
            )
        if "dynamics" in wanted:
            bound = np.maximum(1e-13, 64.0 * EPS * self.linkage.condition * self._over_lever())
            parts = (self.linkage, self.dynamics, self.loading)
            proof["power_balance"] = _worst(dynamics.linkage_power_residual(*parts), bound)
            momentum = dynamics.linkage_momentum_residual(*parts, _contact(self._shape))
            proof["momentum_balance"] = _worst(momentum, bound)
        return proof

    def _three_centres(self) -> Residual:
        """Kennedy's theorem at some of the angles, for enough triples of bodies to hold every centre (``proving_triples``);
        a triple whose bound would say nothing is left out where it is so."""
        step = max(1, self.theta.size // _POSITIONS)
        there = LinkageStudy(self.design, self.samples, Angles(self.theta[::step], self.angles.piece[::step]))
        train = unit_speed_train(self._places, there.drive.y[0], self.course)
        found = moving_collinearity(train, self.course.plan.size)
        bound = 16.0 * EPS * there.linkage.condition * found.doubt
        well = bound <= _SAYS_NOTHING
        worst = _worst(found.zero[well], bound[well]) if well.any() else Residual(0.0, 0.0)
        return replace(worst, left_out=well.size - int(np.count_nonzero(well)), cases=f"{well.size} triples")

    def _over_lever(self) -> np.ndarray:
        """How many times longer the linkage is than the contact force's lever on the driver (n,), 1 at least: the force
        is as uncertain."""
        size = self.course.plan.size if self.course.plan.driver.revolute else 1.0
        with np.errstate(divide="ignore"):
            return np.fmax(1.0, size / np.abs(self.dynamics.lever))

    # -- what the window asks ---------------------------------------------------------------------------

    def angular_velocities(self) -> dict[int, np.ndarray]:
        """Link -> (n,) [rad/s], the frame included."""
        bodies = self.linkage.bodies
        return {n: bodies[body_name(n)].turn[1] * self.omega for n in sorted(self.design.linkage.by_number)}

    def points(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Every named point: place [m] and velocity [m/s] (n,), complex."""
        train, found = self.linkage, {}
        for n in sorted(self.design.linkage.by_number):
            for name in self.design.linkage.by_number[n].places:
                if name not in found:
                    z = train.bodies[body_of(train, name)].point(name)
                    found[name] = (z[0], z[1] * self.omega)
        return found
