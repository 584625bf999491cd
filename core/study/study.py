"""A design and everything that follows from it, computed when it is read and not before."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING

from core.design import drive_names, only
from core.errors import NoStability
from core.shaft import Flywheel, levels
from core.study.camshaft import Camshaft
from core.study.drive_study import DriveStudy

if TYPE_CHECKING:  # a rigid shaft needs nothing of it
    from core.stability import Stability, SteadyTurn


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
