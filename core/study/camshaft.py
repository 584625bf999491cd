"""What the drives of a design do together on their shaft: torque, flywheel, true speed and stability, by machine angle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from core import shaft
from core.cam import CamShape, envelope
from core.design import BALANCER, Design, ElasticShaft, Shaft, path_in, si, slugs
from core.errors import KindynaError, NoSolution, NoStability
from core.frozen import frozen
from core.mechanism import solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import TURN, Angles, degrees
from core.motion.extremes import Extreme, Extremes, find_extremes
from core.motion.program import MachineTurn, ShaftPosition
from core.shaft import Flywheel, LoadCurve, combined, levels, peaks, rms
from core.study.drive_study import DriveStudy
from core.study.stages import evaluations, memory

if TYPE_CHECKING:
    from core.stability import Coefficients, DrivenMechanism, Follower, FollowerContact, Stability
    from core.stability.coefficients import Sizes
    from core.stability.windup import ShaftContacts


# -- what the drives of a design do together on their shaft -----------------------------------------------------


D = TypeVar("D", bound=DriveStudy)


class Camshaft(Generic[D]):
    """A shaft with its drives at equally spaced machine angles, or at the angles given.

    ``drives`` holds the study of each drive alone (``design.only``) by its name, so that an edit of one computes that one anew. The
    machine angle θ counts as the shaft turns; a drive's own angle is θ less its phase, for a mirrored one too, whose torque turns the
    same shaft. A drive that has no answer is in ``failures``, and takes no other with it: only what needs all raises its NoSolution.

    ``alone`` is the drive of a design that lists none: flywheel and flexible shaft are taken by its own angle, and are the very same
    that its study has.
    """

    def __init__(self, design: Design, drives: Mapping[str, D], samples: int, theta: np.ndarray | None = None) -> None:
        self.design = design
        self.drives = drives
        self.samples = samples
        self._given = theta

    # -- drives and angles ----------------------------------------------------------------------------------

    @property
    def alone(self) -> D | None:
        """The only drive's study; None of a design that lists its drives."""
        return None if self.design.listed else next(iter(self.drives.values()))

    @cached_property
    def slugs(self) -> Mapping[str, str]:
        """Name -> as columns and folders have it."""
        return dict(zip(self.drives, slugs(self.design), strict=True))

    def number(self, name: str) -> int:
        """Of the drive in the list."""
        return list(self.drives).index(name)

    @property
    def omega(self) -> float:
        """[rad/s] of the shaft, counted as it turns."""
        return self.design.speed_rpm * TURN / 60.0

    @property
    def angle_degrees(self) -> np.ndarray:
        """The equally spaced machine angles of the tables [deg] (n,), each rounded once."""
        return degrees(self.samples)

    @cached_property
    def theta(self) -> np.ndarray:
        """Machine angles (n,) [rad]."""
        return np.deg2rad(self.angle_degrees) if self._given is None else self._given

    def at_theta(self, theta: np.ndarray) -> Camshaft[D]:
        """The same shaft at any machine angles (n,) [rad]; at a join the right-hand limit."""
        there = Camshaft(self.design, self.drives, self.samples, np.atleast_1d(theta))
        for name in ("failures", "_balance"):  # what there is does not depend on the angles
            if name in vars(self):
                vars(there)[name] = vars(self)[name]
        return there

    @cached_property
    def places(self) -> Mapping[str, ShaftPosition]:
        """Name -> where it stands on the shaft."""
        rows = zip(self.drives.items(), self.design.drives, strict=True)
        return {name: _place(study, drive.phase_deg) for (name, study), drive in rows}

    def there(self, name: str) -> D:
        """The study of a drive at these machine angles."""
        return _there(self.drives[name], self.places[name], self.samples, self._given)

    # -- what they carry together -------------------------------------------------------------------------------

    @property
    def carries(self) -> bool:
        """Whether any drive says along which direction it carries a part."""
        return any(drive.carries for drive in self.design.drives)

    @cached_property
    def carried_path(self) -> np.ndarray:
        """Where the part is that the drives carry together (n, 3) [m] (Shin1995 §6.1): the sum of their motions, each along its
        direction of length 1; a swing as long as the end of its arm goes. Raises KindynaError where none carries any."""
        if not self.carries:
            raise KindynaError("drives: none carries a part; say along which direction: carries = [0.0, 0.0, 1.0]")
        path = np.zeros((self.theta.size, 3))
        for drive in self.design.drives:
            if drive.carries:
                direction = np.array(drive.carries)
                along = self.there(drive.name or "").motion.displacement[0] * drive.carried_per_motion
                path += np.asarray(along)[:, None] * (direction / np.linalg.norm(direction))
        return path

    # -- who has an answer ----------------------------------------------------------------------------------

    @cached_property
    def carried(self) -> tuple[str, ...]:
        """The drives that the shaft carries; a motion that no cam makes is driven by something else."""
        return tuple(name for name, study in self.drives.items() if study.loads_shaft)

    @cached_property
    def failures(self) -> Mapping[str, NoSolution]:
        """Name -> why it has none, of the drives that cannot be assembled or jam; its field is that of the whole file."""
        found: dict[str, NoSolution] = {}
        for i, (name, study) in enumerate(self.drives.items()):
            try:
                if study.loads_shaft:
                    study.require_load()
                else:
                    _ = study.linkage
            except NoSolution as error:
                field = path_in(self.design, i, error.field)
                found[name] = type(error)(error.problem, field, error.hint, error.cam_angles)
        return found

    def _require_all(self, what: str) -> None:
        """Raises NoSolution for the first drive that is missing."""
        for name in self.carried:
            if name in self.failures:
                error = self.failures[name]
                problem = f"{what} lacks the drive {name}: {error.problem}"
                raise type(error)(problem, error.field, error.hint, error.cam_angles)

    # -- torque ---------------------------------------------------------------------------------------------

    def drive_torque(self, name: str) -> np.ndarray:
        """What one drive asks of the shaft at constant speed (n,) [N m]. Raises NoSolution where it has none."""
        if name in self.failures:
            raise self.failures[name]
        study, place = self.drives[name], self.places[name]
        if self._given is None and (order := _on_grid(place, self.samples)) is not None:
            return np.asarray(study.shaft_torque[order])
        return self.there(name).shaft_torque

    def drive_load(self, name: str) -> LoadCurve:
        """The same as a curve by machine angle."""
        if name in self.failures:
            raise self.failures[name]
        parts = self.drives[name].depends_on("dynamics"), self.places[name]
        curve: LoadCurve = memory.get("load on shaft", parts, lambda: combined([self._turned_load(name)]))
        return curve

    def _turned_load(self, name: str) -> tuple[LoadCurve, ShaftPosition]:
        return self.drives[name].load_curve, ShaftPosition(self.places[name].phase)

    def drive_peak(self, name: str) -> Extreme:
        """That of the greatest size of what one drive asks of the shaft [N m], by machine angle. Raises NoSolution as ``drive_load``."""
        return _greatest(peaks(self.drive_load(name)))

    @property
    def cams_torque(self) -> np.ndarray:
        """That of all drives, without the balance cam (n,) [N m]. Raises NoSolution, which names the drive that is missing."""
        self._require_all("the shaft's torque")
        return np.asarray(sum((self.drive_torque(name) for name in self.carried), np.zeros(self.theta.size)))

    @property
    def torque(self) -> np.ndarray:
        """What the shaft must be given at constant speed (n,) [N m], by all drives and the balance cam."""
        return self.cams_torque if self.balancer is None else self.cams_torque + self.balancer_torque

    @property
    def _key(self) -> tuple[Any, ...]:
        parts = ((self.drives[name].depends_on("dynamics"), self.places[name]) for name in self.carried)
        return self.design.listed, *parts

    @property
    def cams_load(self) -> LoadCurve:
        """The sum of the drives as one curve, without the balance cam. Raises NoSolution as ``cams_torque``."""
        if self.alone is not None:
            return self.alone.load_curve
        self._require_all("the shaft's torque")

        def compute() -> LoadCurve:
            evaluations["shaft load"] += 1
            return combined([self._turned_load(name) for name in self.carried])

        curve: LoadCurve = memory.get("shaft load", self._key, compute)
        return curve

    @property
    def load(self) -> LoadCurve:
        """The sum of all, the balance cam included."""
        balance = self._balance
        if balance is None:
            return self.cams_load
        key = self._key, self.design.balancer, self.omega
        places = [(self.cams_load, ShaftPosition()), (balance[0].load_curve, balance[1])]
        curve: LoadCurve = memory.get("balanced load", key, lambda: combined(places))
        return curve

    @cached_property
    def _balance(self) -> tuple[D, ShaftPosition] | None:
        """The study of the balance cam by its own angle, and where it stands."""
        part = self.design.balancer
        if part is None:
            return None
        key = self._key, part, self.omega
        drive = memory.get("balance cam", key, lambda: shaft.balance_drive(self.cams_load, part, self.omega))
        camshaft = self.design.camshaft
        alone = Design(BALANCER, Shaft(camshaft.rotation, camshaft.speed_rpm), (drive,))
        study = next(iter(self.drives.values())).of(alone)
        return study, _place(study, part.phase_deg)

    @property
    def balancer(self) -> D | None:
        """The balance cam as a drive of its own, by its own angle; None where the design has none. Raises NoSolution where nothing
        can balance the torque, or the torque has no answer."""
        return None if self._balance is None else self._balance[0]

    @property
    def balancer_place(self) -> ShaftPosition:
        """Where the balance cam stands on the shaft. Raises NoSolution as ``balancer``."""
        assert self._balance is not None, "a design without [balancer]"
        return self._balance[1]

    @property
    def balancer_peak(self) -> Extreme:
        """The torque of the greatest size that the balance cam asks of the shaft [N m], by its own angle."""
        assert self._balance is not None, "a design without [balancer]"
        return _greatest(peaks(self._balance[0].load_curve))

    @property
    def balancer_torque(self) -> np.ndarray:
        """That of the balance cam (n,) [N m], of a design that has one."""
        assert self._balance is not None, "a design without [balancer]"
        study, place = self._balance
        return _there(study, place, self.samples, self._given).shaft_torque

    # -- figures of the sum ---------------------------------------------------------------------------------

    @property
    def mean_torque(self) -> float:
        """T̄ [N m]."""
        return self.load.mean

    @property
    def rms_torque(self) -> float:
        """√(mean of T²) [N m]."""
        return rms(self.load)

    @property
    def peaks(self) -> Extremes:
        """Lowest and highest torque [N m], by machine angle."""
        return peaks(self.load)

    @property
    def peak_torque(self) -> Extreme:
        """That of the greatest size."""
        return _greatest(self.peaks)

    @property
    def peak_power(self) -> float:
        """The most that the shaft takes at constant speed [W]."""
        return self.peaks.high.value * self.omega

    @property
    def levelled(self) -> bool:
        """Whether flywheel or motor make the motor's torque another than the shaft's."""
        return self.design.shaft is not None and levels(self.design.shaft)

    @property
    def flywheel(self) -> Flywheel:
        """Sizing, true speed and motor torque, by machine angle, or by a drive's own where that is alone. Raises NoSolution as
        ``torque``."""
        camshaft, alone = self.design.camshaft, self.alone

        def compute() -> Flywheel:
            evaluations["flywheel"] += 1
            if alone is not None:
                return Flywheel(lambda angles: alone.at(angles).shaft_torque, alone.load_curve, camshaft, alone.turning)
            return Flywheel(lambda angles: self.at_theta(angles.theta).torque, self.load, camshaft)

        wheel: Flywheel = memory.get("flywheel", (self._key, self.design.balancer, camshaft), compute)
        return wheel

    @cached_property
    def turn(self) -> MachineTurn:
        """The pieces of the machine's turn, between the joins of all drives that have an answer."""
        return MachineTurn(
            [(self.drives[name].program, self.places[name]) for name in self.carried if name not in self.failures]
        )

    @property
    def motor_torque(self) -> np.ndarray:
        """T̄ + k(ω̄ - ω) (n,) [N m]; the shaft's without a flywheel. Raises NoSolution where the motor stalls."""
        return self.flywheel.motor_torque(self._wheel_angles) if self.levelled else self.torque

    @property
    def _wheel_angles(self) -> Any:
        """These angles as the flywheel counts them."""
        return self.turn.angles(self.theta) if self.alone is None else self.there(next(iter(self.drives))).angles

    @property
    def speed(self) -> np.ndarray:
        """The true speed of the shaft (n,) [rad/s]; constant without a flywheel. Raises NoSolution where the motor stalls."""
        return self.flywheel.speed(self._wheel_angles) if self.levelled else np.full(self.theta.size, self.omega)

    @property
    def motor_range(self) -> Mapping[str, Extremes]:
        """Refined extremes of ``motor_torque`` [N m], ``speed`` [rad/s] and ``motor_power`` [W]. Raises NoSolution where it stalls."""
        if not self.levelled:
            low, high = self.peaks.low, self.peaks.high
            power = Extremes(Extreme(low.value * self.omega, low.theta), Extreme(high.value * self.omega, high.theta))
            steady = Extreme(self.omega, 0.0)
            return {"motor_torque": self.peaks, "speed": Extremes(steady, steady), "motor_power": power}
        wheel = self.flywheel

        def values(angles: Any) -> Mapping[str, np.ndarray]:
            torque, speed = wheel.motor_torque(angles), wheel.speed(angles)
            return {"motor_torque": torque, "speed": speed, "motor_power": torque * speed}

        key = self._key, self.design.balancer, self.design.camshaft
        found: Mapping[str, Extremes] = memory.get("motor range", key, lambda: find_extremes(values, self.turn))
        return found

    # -- the flexible shaft ---------------------------------------------------------------------------------

    def flexible_shaft(self) -> Stability:
        """The stability of all drives together. Raises NoStability, which says why there is none; NoSolution where a drive is missing."""
        elastic = None if self.design.shaft is None else self.design.shaft.elastic
        if elastic is None:
            raise NoStability("the camshaft is rigid", "shaft", "give camshaft_inertia_kg_m2 and stiffness_nm_per_rad")

        alone = self.alone
        if alone is not None:
            alone.require_whole_turn()
            place = ShaftPosition(0.0, alone.turning)
            turn = alone.program if place == ShaftPosition() else MachineTurn([(alone.program, place)])
            carried = [ShaftDrive("", 0, "", alone, place, None if place == ShaftPosition() else turn)]
        else:
            self._require_all("the flexible shaft")
            turn = MachineTurn([(self.drives[name].program, self.places[name]) for name in self.carried])
            carried = [
                ShaftDrive(
                    name,
                    self.number(name),
                    f"drives[{self.number(name)}].",
                    self.drives[name],
                    self.places[name],
                    turn,
                    at,
                )
                for at, name in enumerate(self.carried)
            ]

        def compute() -> Stability | NoStability:
            evaluations["stability"] += 1
            return flexible_shaft(carried, turn, elastic, self.omega)

        with nullcontext() if alone is None else alone.located("linkage"):
            found = memory.get("stability", (*(each.parts for each in carried), elastic, self.omega), compute)
        if isinstance(found, NoStability):
            raise found
        stable: Stability = found
        return stable


def _greatest(found: Extremes) -> Extreme:
    return max((found.low, found.high), key=lambda extreme: abs(extreme.value))


def _place(study: DriveStudy, phase_deg: float) -> ShaftPosition:
    return ShaftPosition(float(np.deg2rad(phase_deg % 360.0)), study.turning)


def _there(study: D, place: ShaftPosition, samples: int, theta: np.ndarray | None) -> D:
    """A drive's study at machine angles; at equally spaced ones it is remembered."""
    turn = MachineTurn([(study.program, place)])
    if theta is not None:
        return study.at(turn.drive_angles(0, turn.angles(theta)))

    def compute() -> Any:
        return turn.drive_angles(0, turn.angles(np.deg2rad(degrees(samples))), cached=True)

    return study.at(memory.get("grid", (study.program, samples, place), compute))


def _on_grid(place: ShaftPosition, samples: int) -> np.ndarray | None:
    """The numbers (n,) of the own grid's angles at the machine's, where both grids fall together; else None."""
    steps = place.phase * samples / TURN
    if abs(steps - round(steps)) > 1e-9:
        return None
    return np.asarray((int(place.rotation_sign) * (np.arange(samples) - round(steps))) % samples)


# -- the stability of a flexible shaft with the drives that it carries ------------------------------------------


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
        return angles if self.turn is None else self.turn.drive_angles(self.at, angles)

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
        own = theta if self.turn is None else self.place.drive_angle(theta)
        return np.asarray(program.state(program.angles(own)).displacement[0])

    @property
    def driven(self) -> DrivenMechanism:
        """The drive as the equation of the shaft sees it."""
        from core.stability import DrivenMechanism

        study = self.study
        return DrivenMechanism(
            self.kinematics, study.loading, study.program, self.own, self.place.rotation_sign, self.path
        )

    def touching(self, sizes: Sizes | None) -> FollowerContact:
        """sizes: those of all together, where it is the only one."""
        from core.stability import FollowerContact, driven_sizes

        study, sizes = self.study, sizes or driven_sizes(self.driven)
        parts = (study.loading, study.program, sizes, self.own, self.place.rotation_sign, self.name, self.number)
        return FollowerContact(self.kinematics_and_shape, *parts)

    @property
    def follower(self) -> Follower:
        """The follower as the steady response tells of it."""
        from core.stability import Follower

        starts = self.study.program.starts
        places = starts if self.turn is None else self.place.machine_angle(starts)
        return Follower(self.name, self.study.design.drive.motion_unit, self.displacement, places)


def flexible_shaft(
    carried: Sequence[ShaftDrive], turn: Any, elastic: ElasticShaft, omega: float
) -> Stability | NoStability:
    """The stability of the shaft at a speed [rad/s], or why there is none; turn: its pieces, in none of which a drive has a join."""
    from core.stability import contact_forces, shaft_coefficients, stability

    s = si(elastic)
    parts = (s.camshaft_inertia, s.stiffness, elastic.spring, elastic.spring_factor)

    def compute() -> Coefficients | NoStability:
        try:
            return shaft_coefficients([each.driven for each in carried], turn, *parts)
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


# -- whether the shaft has a torque and a speed ----------------------------------------------------------------


def is_complete(camshaft: Camshaft[Any]) -> bool:
    """Whether every drive of the shaft has a solution, the balance cam included."""
    try:
        return camshaft.load is not None
    except NoSolution:
        return False


def has_speed(camshaft: Camshaft[Any]) -> bool:
    """Whether the shaft has a true speed: every drive has a solution, and the motor does not stall."""
    return is_complete(camshaft) and (not camshaft.levelled or camshaft.flywheel.runs)
