"""A cam on its shaft and everything that follows from it, computed when asked and not before."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from core import cam, dynamics, linkage, motion, shaft
from core.cam import CamShape
from core.design import SingleCam, kind_of, si
from core.dynamics import Forces, Loading, reduced_inertia
from core.errors import NoAnswer, NoStability
from core.extremes import Extreme, Range, find_above
from core.findings import NOTE, Finding, Residual
from core.motion import EPS, Angles, MotionState, Program, program
from core.shaft import Flywheel, LoadCurve, levels, load_curve
from core.study.base import Study
from core.study.quantities import OF_MOTOR, Quantity, quantities_of
from core.study.stages import (
    cam_stage,
    dynamics_stage,
    evaluations,
    grid,
    linkage_stage,
    loading,
    memory,
    motion_stage,
    stability_stage,
)
from core.train import Train

if TYPE_CHECKING:
    from core.stability import Stability

_CONTACT = ("contact_force",)


class CamStudy(Study, of=SingleCam):
    """Stages ``motion``, ``linkage``, ``cam``, ``dynamics``, ``stability``, which is None where the shaft is rigid or nothing
    excites it; ``flywheel`` belongs to the stage ``dynamics``."""

    stages = ("motion", "linkage", "cam", "dynamics", "stability")
    design: SingleCam

    # -- stages -----------------------------------------------------------------------------------------

    @cached_property
    def program(self) -> Program:
        """The compiled motion: its pieces and joins."""
        return program(self.design.drive.motion)

    @cached_property
    def angles(self) -> Angles:
        return grid(self.design.drive.motion, self.samples) if self._given is None else self._given

    @cached_property
    def motion(self) -> MotionState:
        return self._stage(motion_stage, self.design.drive.motion, self.angles)

    @cached_property
    def linkage(self) -> Train:
        try:
            return self._stage(linkage_stage, self.design.drive.follower, self.reach, self.motion)
        except NoAnswer as error:
            raise self._located(error, "linkage") from None

    @cached_property
    def cam(self) -> CamShape:
        try:
            return self._stage(cam_stage, self.linkage, self.design.drive.cam, self.design.shaft.sense)
        except NoAnswer as error:
            raise self._located(error, "cam") from None

    @cached_property
    def dynamics(self) -> Forces:
        return self._stage(dynamics_stage, self.linkage, self.cam, self.loading, self.omega)

    @cached_property
    def stability(self) -> Stability | None:
        try:
            return self.flexible_shaft()
        except NoStability:
            return None

    def flexible_shaft(self) -> Stability:
        """The stage ``stability``. Raises NoStability, which says why there is none; NoAnswer where there is no linkage."""
        elastic, drive = self.design.shaft.elastic, self.design.drive
        if elastic is None:
            raise NoStability("the camshaft is rigid", "shaft", "give camshaft_inertia_kg_m2 and stiffness_nm_per_rad")
        try:
            found = stability_stage(
                drive.motion, drive.follower, self.reach, drive.loads, drive.cam, self.design.shaft.sense, elastic, self.omega
            )
        except NoStability:
            raise
        except NoAnswer as error:
            raise self._located(error, "linkage") from None
        if isinstance(found, NoStability):
            raise found
        shaft: Stability = found
        return shaft

    @property
    def levelled(self) -> bool:
        """Whether a flywheel makes the motor's torque another than the cam's."""
        return levels(self.design.shaft)

    @property
    def jam(self) -> Extreme | None:
        if not self.loading.friction:
            return None
        key = ("jam", self._depends_on("dynamics"))
        worst: Extreme | None = memory.get(
            key, lambda: find_above(lambda angles: self.at(angles).dynamics.guide.jam, self.program, dynamics.JAMS)
        )
        return worst

    @property
    def whole(self) -> CamStudy:
        """The study over the whole turn, which this one is or was taken from."""
        return self if self._given is None else CamStudy(self.design, self.samples)

    @cached_property
    def flywheel(self) -> Flywheel:
        """Sizing, speed and motor torque. Raises NoAnswer where the guide jams."""
        key = (*self._depends_on("dynamics"), self.design.shaft)
        return memory.get(("flywheel", key), self._flywheel)

    def _flywheel(self) -> Flywheel:
        evaluations["flywheel"] += 1
        return Flywheel(self._torque, self._load_curve(), self.design.shaft)

    def _load_curve(self) -> LoadCurve:
        if self.jam is not None:
            angle = float(np.rad2deg(self.jam.theta))
            raise NoAnswer("the guide jams, the torque is infinite", "loads.friction", "lower it", [(angle, angle)])
        key = ("load curve", self._depends_on("dynamics"))
        curve: LoadCurve = memory.get(key, self._fitted_load)
        return curve

    def _fitted_load(self) -> LoadCurve:
        there = lru_cache(maxsize=1)(self.at)  # load and guide are needed at the same angles

        def load(angles: Angles) -> np.ndarray:
            study = there(angles)
            return np.array([study.dynamics.torque, reduced_inertia(study.linkage, self.loading.inertias)])

        def turning_guide(angles: Angles) -> np.ndarray:
            """The guide's force where it rubs: friction turns round with its sign."""
            return there(angles).dynamics.guide.normal * np.abs(there(angles).motion.way)

        switch = turning_guide if self.loading.friction else None
        return load_curve(load, self.program, switch)

    def _torque(self, angles: Angles) -> np.ndarray:
        return self.at(angles).dynamics.torque

    # -- what stages share ------------------------------------------------------------------------------

    @property
    def kind(self) -> str:
        """Slug of the follower's kind."""
        return kind_of(self.design.drive.follower)

    @property
    def omega(self) -> float:
        """Camshaft speed [rad/s], positive."""
        speed: float = si(self.design.shaft).speed
        return speed

    @property
    def reach(self) -> float:
        """Cam centre to the follower's reference point on the base circle [m]."""
        parts = si(self.design.drive.cam)
        reach: float = parts.base_radius + parts.roller_radius
        return reach

    @property
    def loading(self) -> Loading:
        loads: Loading = loading(self.design.drive.follower, self.design.drive.loads)
        return loads

    def _depends_on(self, stage: str) -> tuple[Any, ...]:
        """The parts of the design that the quantities of a stage depend on."""
        drive, shaft = self.design.drive, self.design.shaft
        parts = {
            "motion": (drive.motion, self.omega),
            "linkage": (drive.motion, self.omega, drive.follower, self.reach),
            "cam": (drive.motion, drive.follower, drive.cam, shaft.rotation),
            "dynamics": (drive, shaft.rotation, self.omega),
            "stability": (drive, shaft.rotation, self.omega, shaft.elastic),
        }
        return parts[stage]

    # -- figures ----------------------------------------------------------------------------------------

    def quantities(self, stage: str | None = None) -> Mapping[str, Quantity]:
        return quantities_of(self.kind, stage)

    def _figures_depend_on(self, stage: str, only: tuple[str, ...] = ()) -> Any:
        with_motor = stage == "dynamics" and not set(only).isdisjoint(OF_MOTOR) if only else stage == "dynamics"
        return self._depends_on(stage), self.design.shaft if with_motor else None

    def _findings_of(self, stage: str) -> list[Finding]:
        rows: Mapping[str, Callable[[], list[Finding]]] = {
            "motion": lambda: motion.findings(self.program),
            "linkage": lambda: linkage.findings(self.extremes("linkage", ("dead-centre", "rod-across-guide"))),
            "cam": lambda: cam.findings(
                self._cam_extremes,
                self.linkage.pairs[self.linkage.ground].kind,
                self.design.drive.cam,
            ),
            "dynamics": lambda: [
                *dynamics.findings(self.extremes("dynamics", _CONTACT)["contact_force"], self.jam, self.loading),
                *self._motor_findings(),
            ],
            "stability": self._stability_findings,
        }
        return rows[stage]()

    @property
    def _cam_extremes(self) -> Mapping[str, Range]:
        return self.extremes("cam", ("pressure_angle", "pitch_curvature"))

    def _motor_findings(self) -> list[Finding]:
        return shaft.findings(self.flywheel) if self.levelled and self.jam is None else []

    @property
    def _undercut(self) -> bool:
        """Where the velocity jumps the pitch curve has a corner, which is sharper than any roller."""
        corners = any(join.jumps[:2].any() for join in self.program.joins)
        return corners or cam.undercut(self._cam_extremes, self.design.drive.cam)

    def _stability_findings(self) -> list[Finding]:
        if self.design.shaft.elastic is None:
            return []
        from core.stability import findings

        try:
            return findings(self.flexible_shaft())
        except NoStability as error:
            return [Finding("no-stability", NOTE, error.field, None, {"why": error.problem, "hint": error.hint})]

    def certificate(self, stages: tuple[str, ...] = ()) -> dict[str, Residual]:
        wanted = stages or self.stages
        proof: dict[str, Residual] = {}
        if "motion" in wanted:
            last = self.program.joins[-1]
            stroke = float(np.ptp(self.motion.y[0])) or 1.0
            proof["motion_closure"] = Residual(abs(float(last.jump[0])) / stroke, 1e-9 * max(1.0, 1.0 / stroke))
        if "linkage" in wanted:
            train = self.linkage
            bound = EPS * float(train.condition.max())
            proof["loop_closure"] = Residual(float(train.residual.max()), bound)
        if "cam" in wanted:
            proof["instant_centre"] = Residual(float(cam.centre_residual(self.linkage, self.cam).max()), 16.0 * EPS)
            radius: float = si(self.design.drive.cam).roller_radius
            # rounding grows with the distance, which a motion long against the base circle carries beyond it
            farthest = max(1.0, float(np.abs(self.cam.flank.pitch).max()) / self.reach)
            proof["roller_tangency"] = cam.tangency(
                self.cam, radius, self.reach, 64.0 * EPS * farthest, lambda: self._undercut
            )
        if "dynamics" in wanted:
            bound = max(1e-13, 64.0 * EPS * float(self.linkage.condition.max()))
            parts = (self.linkage, self.cam, self.dynamics, self.loading)
            proof["power_balance"] = Residual(float(dynamics.power_residual(*parts).max()), bound)
            proof["momentum_balance"] = Residual(float(dynamics.momentum_residual(*parts).max()), bound)
        if "stability" in wanted and self.stability is not None:
            proof.update(self.stability.certificate)
        return proof
