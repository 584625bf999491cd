"""What the studies of all kinds of design share: stages as attributes, passing cam angles, extremes, findings."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from core.design import Design
from core.errors import NoAnswer, NoSuchStage, at_angles
from core.extremes import Extreme, Range, find_extremes
from core.findings import ERROR, NOTE, WARNING, Finding, Residual
from core.keeping import keep_freed_memory
from core.motion import Angles, degrees
from core.study.failures import failing_ranges
from core.study.quantities import Quantity
from core.study.stages import memory

SAMPLES = 3600
_ORDER = {ERROR: 0, WARNING: 1, NOTE: 2}
_MODULES: Mapping[bool, str] = MappingProxyType({False: "core.study.study", True: "core.study.linkage"})
"""What studies each kind of design: a cam does without the mechanics of linkages, which are loaded with the first one."""


class Study:
    """One design at equally spaced cam angles, or at the angles given: ``Study(design)`` is the study of its kind.

    Stages are attributes; ``stages`` names them, in the order they need each other (on the class: those of all kinds).
    Each is computed on first use from only the parts of the design it needs, and kept for every other study that shares
    these parts. Any stage may raise NoAnswer; a stage this kind of design lacks raises NoSuchStage.
    """

    stages: tuple[str, ...] = ("motion", "linkage", "cam", "dynamics", "stability")
    angle_column, angle_name = "cam_angle_deg", "cam angle"
    _kinds: ClassVar[dict[bool, type[Study]]] = {}

    def __init_subclass__(cls, of: bool) -> None:
        Study._kinds[of] = cls

    def __new__(cls, design: Design, samples: int = SAMPLES, angles: Angles | None = None) -> Study:
        kind = design.drive.is_linkage
        if kind not in Study._kinds:
            import_module(_MODULES[kind])
        return object.__new__(Study._kinds[kind])

    def __init__(self, design: Design, samples: int = SAMPLES, angles: Angles | None = None) -> None:
        keep_freed_memory()
        self.design: Any = design
        self.samples = samples
        self._given = angles

    # -- stages -----------------------------------------------------------------------------------------

    @property
    def theta(self) -> np.ndarray:
        """Cam angles (n,) [rad]."""
        theta: np.ndarray = self.angles.theta
        return theta

    @property
    def angle_degrees(self) -> np.ndarray:
        """The equally spaced angles of the tables [deg] (n,), each rounded once."""
        return degrees(self.samples)

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

    def _located(self, error: NoAnswer, stage: str) -> NoAnswer:
        """The error of a sampled stage with the cam angles to the last digit, whatever the sampling was."""
        if not error.cam_angles or not self.angles.kept:
            return error
        return at_angles(error, failing_ranges(lambda angles: self.at(angles), stage, self.program))

    def at(self, angles: Angles) -> Study:
        """The same design at other cam angles, not remembered."""
        return Study(self.design, self.samples, angles)

    def at_theta(self, theta: np.ndarray) -> Study:
        """The same design at any cam angles (n,) [rad]; at a join the right-hand limit."""
        return self.at(self.program.angles(np.atleast_1d(theta)))

    @property
    def jam(self) -> Extreme | None:
        """Where friction jams a guide hardest, by the refined extreme of the jamming factor, so whatever the sampling: then
        there are no forces to be tabled. None where none jams."""
        return None

    # -- what a kind has to tell ------------------------------------------------------------------------

    def quantities(self, stage: str | None = None) -> Mapping[str, Quantity]:
        """The scalars that can be asked for, of one stage or of all."""
        raise NotImplementedError

    def _figures_depend_on(self, stage: str, only: tuple[str, ...] = ()) -> Any:
        """The parts of the design that the extremes of a stage depend on, of all its quantities or of those named."""
        raise NotImplementedError

    def _findings_of(self, stage: str) -> list[Finding]:
        raise NotImplementedError

    def certificate(self, stages: tuple[str, ...] = ()) -> dict[str, Residual]:
        """What proves the figures: each residual with its bound, of the named stages or of all."""
        raise NotImplementedError

    # -- figures ----------------------------------------------------------------------------------------

    def extremes(self, stage: str, only: tuple[str, ...] = ()) -> Mapping[str, Range]:
        """Refined extremes of a stage's quantities (of those named only, where any are); raises NoSuchStage."""
        self.require_stage(stage)
        key = ("extremes", stage, only, self._figures_depend_on(stage, only))
        found: Mapping[str, Range] = memory.get(key, lambda: self._extremes(stage, only))
        return found

    def _extremes(self, stage: str, only: tuple[str, ...]) -> Mapping[str, Range]:
        rows = {
            name: row
            for name, row in self.quantities(stage).items()
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
        found = [f for name in stages or self.stages for f in self._findings_of(name)]
        return tuple(sorted(found, key=lambda f: _ORDER[f.severity]))
