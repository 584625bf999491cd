"""A design and everything that follows from it, computed when asked and not before."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from core import cam, dynamics, linkage, motion
from core.cam import CamShape
from core.design import Design, kind_of, si
from core.dynamics import Forces, Loading
from core.errors import NoAnswer, NoSuchStage, at_angles
from core.extremes import Range, find_extremes
from core.findings import ERROR, NOTE, WARNING, Finding, Residual
from core.motion import EPS, Angles, MotionState, Program, program
from core.shaft import Flywheel, TorqueCurve, flywheel, torque_curve
from core.study.failures import failing_ranges
from core.study.quantities import quantities_of
from core.study.stages import cam_stage, dynamics_stage, evaluations, grid, linkage_stage, loading, memory, motion_stage
from core.train import Train

SAMPLES = 3600
_ORDER = {ERROR: 0, WARNING: 1, NOTE: 2}


class Study:
    """One design at equally spaced cam angles, or at the angles given.

    Stages are attributes: ``motion``, ``linkage``, ``cam``, ``dynamics``; ``stages`` names them, in the order they
    need each other. Each is computed on first use from only the parts of the design it needs, and kept for every other
    study that shares these parts. ``flywheel`` belongs to the stage ``dynamics``.
    Any stage may raise NoAnswer; a stage this kind of design lacks raises NoSuchStage.
    """

    stages: tuple[str, ...] = ("motion", "linkage", "cam", "dynamics")

    def __init__(self, design: Design, samples: int = SAMPLES, angles: Angles | None = None) -> None:
        self.design = design
        self.samples = samples
        self._given = angles

    # -- stages -----------------------------------------------------------------------------------------

    @cached_property
    def program(self) -> Program:
        """The compiled motion: its pieces and joins."""
        return program(self.design.drive.motion)

    @cached_property
    def angles(self) -> Angles:
        return grid(self.design.drive.motion, self.samples) if self._given is None else self._given

    @property
    def theta(self) -> np.ndarray:
        """Cam angles (n,) [rad]."""
        return self.angles.theta

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
    def flywheel(self) -> Flywheel:
        """Sizing and motor torque. Raises NoAnswer where the guide jams."""
        key = (*self._depends_on("dynamics"), self.design.shaft)
        return memory.get(("flywheel", key), self._flywheel)

    def _flywheel(self) -> Flywheel:
        evaluations["flywheel"] += 1
        return flywheel(self._torque, self._torque_curve(), self.design.shaft)

    def _torque_curve(self) -> TorqueCurve:
        key = ("torque curve", self._depends_on("dynamics"))
        curve: TorqueCurve = memory.get(key, lambda: torque_curve(self._torque, self.program))
        return curve

    def _torque(self, angles: Angles) -> np.ndarray:
        return self.at(angles).dynamics.torque

    def _located(self, error: NoAnswer, stage: str) -> NoAnswer:
        """The error of a sampled stage with the cam angles to the last digit, whatever the sampling was."""
        if not error.cam_angles or not self.angles.kept:
            return error
        return at_angles(error, failing_ranges(lambda angles: self.at(angles), stage, self.program))

    def _stage(self, function: Any, *parts: Any) -> Any:
        return function(*parts) if self.angles.kept else function.__wrapped__(*parts)

    def require_stage(self, name: str) -> None:
        """Raises NoSuchStage, naming the stages there are."""
        if name not in self.stages:
            raise NoSuchStage(name, self.stages)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        raise NoSuchStage(name, self.stages)

    def at(self, angles: Angles) -> Study:
        """The same design at other cam angles, not remembered."""
        return Study(self.design, self.samples, angles)

    def at_theta(self, theta: np.ndarray) -> Study:
        """The same design at any cam angles (n,) [rad]; at a join the right-hand limit."""
        return self.at(self.program.angles(np.atleast_1d(theta)))

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
        }
        return parts[stage]

    # -- figures ----------------------------------------------------------------------------------------

    def extremes(self, stage: str, only: tuple[str, ...] = ()) -> Mapping[str, Range]:
        """Refined extremes of a stage's quantities (of those named only, where any are); raises NoSuchStage."""
        self.require_stage(stage)
        key = ("extremes", stage, only, self._depends_on(stage), self.design.shaft if stage == "dynamics" else None)
        found: Mapping[str, Range] = memory.get(key, lambda: self._extremes(stage, only))
        return found

    def _extremes(self, stage: str, only: tuple[str, ...]) -> Mapping[str, Range]:
        rows = {
            name: row
            for name, row in quantities_of(self.kind, stage).items()
            if not row.turns and (name in only if only else row.exists(self))
        }

        def values(angles: Angles) -> Mapping[str, np.ndarray]:
            there = self.at(angles)
            return {name: row.value(there) for name, row in rows.items()}

        try:
            return find_extremes(values, self.program)
        except NoAnswer as error:
            raise self._located(error, stage) from None

    def findings(self, stages: tuple[str, ...] = ()) -> tuple[Finding, ...]:
        """What the named stages (all, where none is named) exceed, the gravest first."""
        rows: Mapping[str, Callable[[], list[Finding]]] = {
            "motion": lambda: motion.findings(self.program),
            "linkage": lambda: linkage.findings(self.extremes("linkage", ("dead-centre", "rod-across-guide"))),
            "cam": lambda: cam.findings(
                self.extremes("cam", ("pressure_angle", "pitch_curvature")),
                self.linkage.pairs[self.linkage.ground].kind,
                self.design.drive.cam,
            ),
            "dynamics": lambda: dynamics.findings(
                self.extremes("dynamics", ("contact_force", "jam_factor")), self.loading
            ),
        }
        found = [f for name in stages or self.stages for f in rows[name]()]
        return tuple(sorted(found, key=lambda f: _ORDER[f.severity]))

    def certificate(self, stages: tuple[str, ...] = ()) -> dict[str, Residual]:
        """What proves the figures: each residual with its bound, of the named stages or of all."""
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
            proof["roller_tangency"] = Residual(
                cam.tangency_residual(self.cam, radius, self.reach), 64.0 * EPS * farthest
            )
        if "dynamics" in wanted:
            bound = max(1e-13, 64.0 * EPS * float(self.linkage.condition.max()))
            parts = (self.linkage, self.cam, self.dynamics, self.loading)
            proof["power_balance"] = Residual(float(dynamics.power_residual(*parts).max()), bound)
            proof["momentum_balance"] = Residual(float(dynamics.momentum_residual(*parts).max()), bound)
        return proof
