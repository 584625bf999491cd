"""A design and everything that follows from it; each stage is computed when it is first read."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING

from core.cam import OUTER, SECOND, form_row, row_of
from core.design import Design, drive_names, only
from core.design.parts import LINEAR, ROTARY
from core.design.spatial import Rib
from core.errors import NoStability
from core.frozen import frozen
from core.number_text import result_text
from core.numerics.lazy import lazy
from core.shaft import Flywheel
from core.stress import load_ratings, pairings
from core.study.camshaft import Camshaft, is_complete
from core.study.drive_forces import ROLLERS, DriveForces, has_servo
from core.study.stages import memory

if TYPE_CHECKING:
    from core.stability import Stability, SteadyTurn
    from core.study.clearances import Clearances


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
    def clearances(self) -> Clearances:
        """Clearances of the bodies with outlines, of all drives together."""
        from core.study.clearances import Clearances, drawings_of  # few designs have outlines

        key = self.design, drawings_of(self.design), self._followed
        clearances: Clearances = memory.get("clearances", key, lambda: Clearances(self._at_angles(None).camshaft))
        return clearances

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


# -- what quantities need of a design ---------------------------------------------------------------------------


def _is_rated(roller: str, design: Design) -> bool:
    return design.drive.has_disk and roller in load_ratings(design.drive.face, design.drive.cam)


def _has_flank(name: str, design: Design) -> bool:
    return design.drive.has_disk and name in form_row(design.drive.cam.form).flanks


def _has_stress(design: Design) -> bool:
    return design.drive.has_disk and bool(pairings(design.drive.face, design.drive.cam))


def _has_rib(design: Design) -> bool:
    drive = design.drive
    return drive.has_surface and (drive.cam.rollers > 1 or drive.cam.form.form == Rib.form)


def _has_elastic_follower(design: Design) -> bool:
    return design.drive.has_disk and bool(design.drive.loads.follower_stiffness_n_per_mm)


def has_piston(design: Design) -> bool:
    """Whether a design has an engine, and a valve with its angle and its clearance at TDC."""
    valve = design.drive.valve
    return design.engine is not None and valve is not None and None not in (valve.angle_deg, valve.clearance_mm)


def has_motor(design: Design) -> bool:
    """Whether the motor of a shaft turns its cam or crank."""
    return design.shaft is not None and design.drive.loads_shaft


@frozen
class Need:
    """What a design must have so that it has a quantity: in words, and whether a design has it."""

    words: str
    is_met: Callable[[Design], bool]


NEEDS: Mapping[str, Need] = MappingProxyType(
    {
        "": Need("", lambda design: True),
        "motion": Need("a motion", lambda design: design.drive.motion is not None),
        "slide": Need(
            "a motion in mm, with a mass or a force", lambda d: d.drive.loaded and d.drive.motion_unit == "mm"
        ),
        "turned": Need(
            "a motion in degrees, with an inertia or a torque",
            lambda design: design.drive.loaded and design.drive.motion_unit == "deg",
        ),
        "loaded": Need("a mass, an inertia or a force", lambda design: design.drive.loaded),
        "servo": Need("a table [servo]", has_servo),
        "rotary servo": Need("a rotary motor in [servo]", lambda design: has_servo(design, ROTARY)),
        "linear servo": Need("a linear motor in [servo]", lambda design: has_servo(design, LINEAR)),
        "valve": Need("a rocker, a pushrod train, or a table [valve]", lambda design: design.drive.has_valve),
        "piston": Need("[engine], and valve.angle_deg and valve.clearance_mm", has_piston),
        "valve springs": Need(
            "[[loads.valve_springs]]", lambda design: bool(getattr(design.drive.loads, "valve_springs", ()))
        ),
        "cam": Need("a cam", lambda design: design.drive.cam is not None),
        "loaded cam": Need("a cam, and a mass or a force", lambda d: d.drive.cam is not None and d.drive.loaded),
        "rib": Need("a rib between two rollers", _has_rib),
        "pitch": Need(
            "a cam with a roller, a knife edge or a shoe",
            lambda design: design.drive.has_disk and "pitch_curvature" in row_of(design.drive.face).limits,
        ),
        "straight": Need("a cam with a flat face", lambda design: design.drive.has_disk and design.drive.face.straight),
        OUTER: Need("a cam with a groove", partial(_has_flank, OUTER)),
        SECOND: Need("a conjugate pair of cams", partial(_has_flank, SECOND)),
        "stress": Need("a cam with thickness and materials", _has_stress),
        "second stress": Need(
            "a conjugate pair of cams with thickness and materials",
            lambda design: _has_flank(SECOND, design) and _has_stress(design),
        ),
        **{f"{roller} rating": Need("a roller with a load rating", partial(_is_rated, roller)) for roller in ROLLERS},
        "elastic": Need("a cam, and loads.follower_stiffness_n_per_mm", _has_elastic_follower),
        "elastic open": Need(
            "an open cam, and loads.follower_stiffness_n_per_mm",
            lambda design: _has_elastic_follower(design) and not design.drive.cam.form.holds,
        ),
        "elastic shaft": Need(
            "a cam, and shaft.stiffness_nm_per_rad",
            lambda design: (
                design.drive.cam is not None
                and design.drive.loads_shaft
                and design.shaft is not None
                and design.shaft.elastic is not None
            ),
        ),
        "shaft": Need("a shaft that turns a cam or a crank", has_motor),
    }
)
"""What quantities need of a design, beyond the kind of its mechanism."""


# -- formulas of kinds of cams ----------------------------------------------------------------------------------


FLAT, SURFACE = ".flat", ".surface"
"""Endings of a formula's name: the formula under a straight face, and that of a cam in space."""


def variant_of(names: Collection[str]) -> str:
    """Ending of the formulas of a design that has quantities of these names."""
    return FLAT if "contact_on_face" in names else SURFACE if "sliding" in names else ""
