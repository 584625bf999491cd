"""A design and everything that follows from it; each stage is computed when it is first read."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from core.design import drive_names, only
from core.errors import NoStability
from core.number_text import result_text
from core.numerics.lazy import lazy
from core.shaft import Flywheel
from core.study.camshaft import Camshaft, is_complete
from core.study.drive_forces import DriveForces

if TYPE_CHECKING:
    from core.stability import Stability, SteadyTurn


class Study(DriveForces):
    """A design with one drive, or with several on one shaft.

    ``drives`` holds a study of each drive by its own angle, ``camshaft`` the drives together. The study of a design that lists
    no drives is also that of its only drive, with the stages of a DriveForces, at equally spaced angles or at given angles; in a
    design that lists several, every study in ``drives`` has its own stages.

    The stage ``stability`` is present where a shaft turns a cam or a crank (None where the shaft is rigid, or nothing excites
    it); ``flywheel`` belongs to the stage ``dynamics``.
    """

    @lazy
    def drives(self) -> Mapping[str, Study]:
        """Name -> study of the drive, in the order of the design."""
        names = drive_names(self.design)
        if not self.design.listed:
            return {names[0]: self}
        return {name: self.with_design(only(self.design, i)) for i, name in enumerate(names)}

    @property
    def solved_drives(self) -> Mapping[str, Study]:
        """Slug -> study of every drive that has a solution.

        The drive of a design that lists none has the slug '' and is always present: its stages raise its NoSolution.
        """
        if not self.design.listed:
            return {"": self}
        camshaft = self.camshaft
        return {camshaft.slugs[name]: study for name, study in self.drives.items() if name not in camshaft.failures}

    @lazy
    def camshaft(self) -> Camshaft[Study]:
        """The drives together on their shaft, by machine angle."""
        return Camshaft(self.design, self.drives, self.samples)

    @lazy
    def flywheel(self) -> Flywheel:
        """Size of the flywheel, speed and motor torque. Raises NoSolution where friction jams, or a crank cannot turn fully."""
        return self.camshaft.flywheel

    def flexible_shaft(self) -> Stability:
        """The stage ``stability``. Raises NoStability with the reason, NoSolution where the linkage has no solution."""
        self.require_stage("stability")
        return self._flexible_shaft

    @lazy
    def _flexible_shaft(self) -> Stability:
        return self.camshaft.flexible_shaft()

    @property
    def stability(self) -> Stability | None:
        """Stability of the flexible shaft; None where the shaft is rigid, or nothing excites it."""
        self.require_stage("stability")
        try:
            return self.flexible_shaft()
        except NoStability:
            return None

    @property
    def steady_turn(self) -> SteadyTurn:
        """One turn of the steady response of the flexible shaft. Raises NoStability where there is none."""
        stability = self.flexible_shaft()
        if stability.steady_turn is None:
            eta, q = stability.machine.eta, stability.machine.q
            problem = f"there is no steady response at η = {result_text(eta)}, Q = {result_text(q)}"
            raise NoStability(problem, "shaft.speed_rpm", "choose another speed")
        return stability.steady_turn


def shaft_in_chart(study: Study) -> Stability | None:
    """The flexible shaft that has a point in the chart of stability.

    None where the shaft is rigid, nothing excites it, or one of several drives has no solution.
    """
    has_stage = "stability" in study.stages and (not study.design.listed or is_complete(study.camshaft))
    shaft = study.stability if has_stage else None
    try:
        return shaft if shaft is not None and shaft.exact and shaft.machine else None
    except NoStability:
        return None
