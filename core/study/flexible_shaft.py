"""The stability of a flexible shaft with the drives that it carries; its coefficients do not depend on speed and damping, and are kept
apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from core.cam import CamShape, envelope
from core.design import ElasticShaft, si
from core.errors import NoStability
from core.frozen import frozen
from core.mechanism import solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import Angles
from core.motion.turn import MachineTurn, ShaftPosition
from core.study.drive_study import DriveStudy
from core.study.stages import memory

if TYPE_CHECKING:  # a rigid shaft needs nothing of it
    from core.stability import Coefficients, DrivenMechanism, Follower, Stability, Touching
    from core.stability.contact import ShaftContacts
    from core.stability.hill.coefficients import Sizes


@frozen(eq=False)
class ShaftDrive:
    """A drive on the shaft: its name, its number in the list and the path of its fields, its study, where it stands; turn: that of the
    shaft, in which its program has the number ``at``; None where the shaft is asked by the drive's own angle."""

    name: str
    number: int
    path: str
    study: DriveStudy
    place: ShaftPosition = ShaftPosition()
    turn: MachineTurn | None = None
    at: int = 0

    @property
    def key(self) -> tuple[Any, ...]:
        """What its coefficients depend on."""
        study = self.study
        program = study.driver_ranges if study.by_crank else study.program
        return program, study.mechanism, study.driver_ranges, study.loading, self.place

    @property
    def parts(self) -> tuple[Any, ...]:
        """What anything of it depends on."""
        study, drive = self.study, self.study.design.drive
        cam = None if drive.cam is None else (drive.face, drive.bare_cam, study.sense)
        return (*self.key, cam, drive.motion_unit, self.name, self.number)

    @property
    def lifts(self) -> bool:
        """Whether there is a cam that its follower could leave."""
        return "cam" in self.study.stages and not self.study.holds

    def own(self, angles: Angles) -> Angles:
        """Its own angles at those of the shaft."""
        return angles if self.turn is None else self.turn.own(self.at, angles)

    def kinematics(self, angles: Angles) -> Kinematics:
        """The drive's kinematics at any of its own angles."""
        return solve_mechanism(self.study.mechanism, self.study.program.state(angles), self.study.driver_ranges)

    def kinematics_and_shape(self, angles: Angles) -> tuple[Kinematics, CamShape]:
        """The same, with the cam."""
        kinematics, drive = self.kinematics(angles), self.study.design.drive
        return kinematics, envelope(kinematics, drive.face, drive.bare_cam, self.study.sense)

    def displacement(self, theta: np.ndarray) -> np.ndarray:
        """Of the motion, at angles of the shaft (n,) [rad]."""
        program = self.study.program
        own = theta if self.turn is None else self.place.own(theta)
        return np.asarray(program.state(program.angles(own)).displacement[0])

    @property
    def driven(self) -> DrivenMechanism:
        """The drive as the equation of the shaft sees it."""
        from core.stability import DrivenMechanism

        study = self.study
        return DrivenMechanism(self.kinematics, study.loading, study.program, self.own, self.place.sense, self.path)

    def touching(self, sizes: Sizes | None) -> Touching:
        """sizes: those of all together, where it is the only one."""
        from core.stability import Touching, own_sizes

        study, sizes = self.study, sizes or own_sizes(self.driven)
        parts = (study.loading, study.program, sizes, self.own, self.place.sense, self.name, self.number)
        return Touching(self.kinematics_and_shape, *parts)

    @property
    def follower(self) -> Follower:
        """The follower as the steady response tells of it."""
        from core.stability import Follower

        starts = self.study.program.starts
        places = starts if self.turn is None else self.place.machine(starts)
        return Follower(self.name, self.study.design.drive.motion_unit, self.displacement, places)


def flexible_shaft(
    carried: Sequence[ShaftDrive], turn: Any, elastic: ElasticShaft, omega: float
) -> Stability | NoStability:
    """The stability of the shaft at a speed [rad/s], or why there is none; turn: its pieces, in none of which a drive has a join."""
    from core.stability import coefficients_of_all, contact_forces, stability

    s = si(elastic)
    parts = (s.camshaft_inertia, s.stiffness, elastic.spring, elastic.spring_factor)

    def compute() -> Coefficients | NoStability:
        try:
            return coefficients_of_all([each.driven for each in carried], turn, *parts)
        except NoStability as error:
            return error

    def contact() -> ShaftContacts | None:
        sizes = made.sizes if len(carried) == 1 else None
        return contact_forces(made, elastic, [each.touching(sizes) for each in carried if each.lifts], turn)

    def followers() -> Sequence[Follower]:
        return [each.follower for each in carried if "motion" in each.study.stages]

    try:
        made = memory.get("coefficients", (*(each.key for each in carried), *parts), compute)
        return made if isinstance(made, NoStability) else stability(made, elastic, omega, contact, followers)
    except NoStability as error:
        return error
