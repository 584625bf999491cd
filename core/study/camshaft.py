"""The drives of a design together on their shaft, by machine angle: torque, flywheel, true speed and stability."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
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
from core.numerics.lazy import lazy
from core.shaft import Flywheel, LoadCurve, combined_load, has_flywheel, peaks, rms
from core.study.drive_forces import DriveForces
from core.study.stages import evaluations, memory

if TYPE_CHECKING:
    from core.stability import Coefficients, DrivenMechanism, Follower, FollowerContact, Stability
    from core.stability.coefficients import Sizes
    from core.stability.windup import ShaftContacts


D = TypeVar("D", bound=DriveForces)


class Camshaft(Generic[D]):
    """A shaft with its drives, at equally spaced machine angles or at given angles.

    ``drives`` maps names to studies of single drives (``design.only``), so that an edit of one drive computes that drive only.
    The machine angle θ grows as the shaft turns; the angle of a drive is θ less its phase, for a mirrored drive too, whose
    torque acts on the same shaft. A drive without a solution is in ``failures``; only results that need all drives raise its
    NoSolution.

    Where a design lists no drives, flywheel and flexible shaft go by the angle of its ``single_drive``.
    """

    def __init__(self, design: Design, drives: Mapping[str, D], samples: int, theta: np.ndarray | None = None) -> None:
        self.design = design
        self.drives = drives
        self.samples = samples
        self._given = theta

    # -- drives and angles ----------------------------------------------------------------------------------

    @property
    def single_drive(self) -> D | None:
        """Study of the only drive; None where the design lists its drives."""
        return None if self.design.listed else next(iter(self.drives.values()))

    @lazy
    def slugs(self) -> Mapping[str, str]:
        """Name -> slug of the drive, as in columns and folders."""
        return dict(zip(self.drives, slugs(self.design), strict=True))

    def drive_number(self, name: str) -> int:
        """Number of a drive in the list, from 0."""
        return list(self.drives).index(name)

    @property
    def omega(self) -> float:
        """Speed of the shaft [rad/s], positive in its sense of rotation."""
        return self.design.speed_rpm * TURN / 60.0

    @property
    def angle_degrees(self) -> np.ndarray:
        """Equally spaced machine angles of the tables (n,) [deg], each rounded once."""
        return degrees(self.samples)

    @lazy
    def theta(self) -> np.ndarray:
        """Machine angles (n,) [rad]."""
        return np.deg2rad(self.angle_degrees) if self._given is None else self._given

    def at_theta(self, theta: np.ndarray) -> Camshaft[D]:
        """The same shaft at given machine angles.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Machine angles; at a join the right-hand limit is taken.

        Returns
        -------
        Camshaft
        """
        camshaft = Camshaft(self.design, self.drives, self.samples, np.atleast_1d(theta))
        for name in ("failures", "_balance"):  # they do not depend on the angles
            if name in vars(self):
                vars(camshaft)[name] = vars(self)[name]
        return camshaft

    @lazy
    def positions(self) -> Mapping[str, ShaftPosition]:
        """Name -> position of the drive on the shaft."""
        rows = zip(self.drives.items(), self.design.drives, strict=True)
        return {name: _position(study, drive.phase) for (name, study), drive in rows}

    def drive_study(self, name: str) -> D:
        """Study of a drive at these machine angles."""
        return _at_machine_angles(self.drives[name], self.positions[name], self.samples, self._given)

    # -- transfer of a part -----------------------------------------------------------------------------------

    @property
    def has_transfer_path(self) -> bool:
        """Whether any drive has a direction along which it transfers a part."""
        return any(drive.carries for drive in self.design.drives)

    @lazy
    def transfer_path(self) -> np.ndarray:
        """Position of the part that the drives transfer together (n, 3) [m], the sum of their motions along their directions.

        Directions are unit vectors; a swing counts as the path of the end of its arm. Raises KindynaError where no drive
        transfers a part. (Shin 1995, §6.1.)
        """
        if not self.has_transfer_path:
            raise KindynaError("drives: none transfers a part; give a drive its direction: carries = [0.0, 0.0, 1.0]")
        path = np.zeros((self.theta.size, 3))
        for drive in self.design.drives:
            if drive.carries:
                direction = np.array(drive.carries)
                along = self.drive_study(drive.name or "").motion.displacement[0] * drive.carried_per_motion
                path += np.asarray(along)[:, None] * (direction / np.linalg.norm(direction))
        return path

    # -- drives on the shaft, drives without a solution -------------------------------------------------------

    @lazy
    def loading_drives(self) -> tuple[str, ...]:
        """Names of the drives that load the shaft; a motion without a cam is driven otherwise."""
        return tuple(name for name, study in self.drives.items() if study.loads_shaft)

    @lazy
    def failures(self) -> Mapping[str, NoSolution]:
        """Name -> error of every drive that cannot be assembled or jams; its field is a path in the file of the design."""
        failures: dict[str, NoSolution] = {}
        for i, (name, study) in enumerate(self.drives.items()):
            try:
                if study.loads_shaft:
                    study.require_load()
                else:
                    _ = study.linkage
            except NoSolution as error:
                field = path_in(self.design, i, error.field)
                failures[name] = type(error)(error.problem, field, error.hint, error.cam_angles)
        return failures

    def _require_all(self, what: str) -> None:
        """Raises NoSolution for the first drive without a solution; ``what`` is the result that needs all drives."""
        for name in self.loading_drives:
            if name in self.failures:
                error = self.failures[name]
                problem = f"{what} lacks the drive {name}: {error.problem}"
                raise type(error)(problem, error.field, error.hint, error.cam_angles)

    # -- torque ---------------------------------------------------------------------------------------------

    def drive_torque(self, name: str) -> np.ndarray:
        """Torque of one drive on the shaft at constant speed.

        Parameters
        ----------
        name : str
            Name of the drive.

        Returns
        -------
        ndarray (n,) [N m]

        Raises
        ------
        NoSolution
            Where the drive has no torque.
        """
        if name in self.failures:
            raise self.failures[name]
        study, position = self.drives[name], self.positions[name]
        if self._given is None and (order := _grid_order(position, self.samples)) is not None:
            return np.asarray(study.shaft_torque[order])
        return self.drive_study(name).shaft_torque

    def drive_load(self, name: str) -> LoadCurve:
        """Load of one drive on the shaft, as a curve by machine angle. Raises NoSolution where the drive has no torque."""
        if name in self.failures:
            raise self.failures[name]
        parts = self.drives[name].depends_on("dynamics"), self.positions[name]
        curve: LoadCurve = memory.get("load on shaft", parts, lambda: combined_load([self._positioned_load(name)]))
        return curve

    def _positioned_load(self, name: str) -> tuple[LoadCurve, ShaftPosition]:
        return self.drives[name].load_curve, ShaftPosition(self.positions[name].phase)

    def drive_peak(self, name: str) -> Extreme:
        """Torque of one drive that is greatest in size [N m], by machine angle. Raises NoSolution as ``drive_load``."""
        return _greatest(peaks(self.drive_load(name)))

    @property
    def cams_torque(self) -> np.ndarray:
        """Torque of all drives, without the balance cam (n,) [N m]. Raises NoSolution, which names the drive without a solution."""
        self._require_all("the shaft's torque")
        return np.asarray(sum((self.drive_torque(name) for name in self.loading_drives), np.zeros(self.theta.size)))

    @property
    def torque(self) -> np.ndarray:
        """Torque that keeps the shaft at constant speed, of all drives and the balance cam, T(θ) = Σ T_k(θ - θ_k) (n,) [N m]."""
        return self.cams_torque if self.balancer is None else self.cams_torque + self.balancer_torque

    @property
    def _key(self) -> tuple[Any, ...]:
        parts = ((self.drives[name].depends_on("dynamics"), self.positions[name]) for name in self.loading_drives)
        return self.design.listed, *parts

    @property
    def cams_load(self) -> LoadCurve:
        """Load of all drives as one curve, without the balance cam. Raises NoSolution as ``cams_torque``."""
        if self.single_drive is not None:
            return self.single_drive.load_curve
        self._require_all("the shaft's torque")

        def compute() -> LoadCurve:
            evaluations["shaft load"] += 1
            return combined_load([self._positioned_load(name) for name in self.loading_drives])

        curve: LoadCurve = memory.get("shaft load", self._key, compute)
        return curve

    @property
    def load(self) -> LoadCurve:
        """Load of all drives and of the balance cam as one curve."""
        balance = self._balance
        if balance is None:
            return self.cams_load
        key = self._key, self.design.balancer, self.omega
        loads = [(self.cams_load, ShaftPosition()), (balance[0].load_curve, balance[1])]
        curve: LoadCurve = memory.get("balanced load", key, lambda: combined_load(loads))
        return curve

    @lazy
    def _balance(self) -> tuple[D, ShaftPosition] | None:
        """Study of the balance cam by its own angle, and its position on the shaft."""
        part = self.design.balancer
        if part is None:
            return None
        key = self._key, part, self.omega
        drive = memory.get("balance cam", key, lambda: shaft.balance_drive(self.cams_load, part, self.omega))
        camshaft = self.design.camshaft
        design = Design(BALANCER, Shaft(camshaft.rotation, camshaft.speed_rpm), (drive,))
        study = next(iter(self.drives.values())).with_design(design)
        return study, _position(study, part.phase_deg)

    @property
    def balancer(self) -> D | None:
        """Study of the balance cam as a drive, by its own angle; None where the design has no balance cam.

        Raises NoSolution where no balance cam exists for the torque, or a drive has no torque.
        """
        return None if self._balance is None else self._balance[0]

    @property
    def balancer_position(self) -> ShaftPosition:
        """Position of the balance cam on the shaft. Raises NoSolution as ``balancer``."""
        assert self._balance is not None, "a design without [balancer]"
        return self._balance[1]

    @property
    def balancer_peak(self) -> Extreme:
        """Torque of the balance cam that is greatest in size [N m], by its own angle."""
        assert self._balance is not None, "a design without [balancer]"
        return _greatest(peaks(self._balance[0].load_curve))

    @property
    def balancer_torque(self) -> np.ndarray:
        """Torque of the balance cam on the shaft (n,) [N m]; the design must have one."""
        assert self._balance is not None, "a design without [balancer]"
        return _at_machine_angles(*self._balance, self.samples, self._given).shaft_torque

    # -- total torque ---------------------------------------------------------------------------------------

    @property
    def mean_torque(self) -> float:
        """Mean torque T̄ [N m]."""
        return self.load.mean

    @property
    def rms_torque(self) -> float:
        """Root mean square of the torque, T_r = √M with the mean M of T² [N m]."""
        return rms(self.load)

    @property
    def peaks(self) -> Extremes:
        """Lowest and highest torque [N m], by machine angle."""
        return peaks(self.load)

    @property
    def peak_torque(self) -> Extreme:
        """Torque that is greatest in size [N m]."""
        return _greatest(self.peaks)

    @property
    def peak_power(self) -> float:
        """Greatest power of the shaft at constant speed, P = T ω̄ [W]."""
        return self.peaks.high.value * self.omega

    @property
    def levels_torque(self) -> bool:
        """Whether flywheel and motor make the torque of the motor differ from that of the shaft."""
        return self.design.shaft is not None and has_flywheel(self.design.shaft)

    @property
    def flywheel(self) -> Flywheel:
        """Size of the flywheel, true speed and motor torque, by machine angle, or by the angle of the only drive.

        Raises NoSolution as ``torque``.
        """
        camshaft, single = self.design.camshaft, self.single_drive

        def compute() -> Flywheel:
            evaluations["flywheel"] += 1
            if single is not None:
                unsolved = single.with_design(single.design)  # a flywheel in the cache does not keep a study's results
                return Flywheel(
                    lambda angles: unsolved.at(angles).shaft_torque, single.load_curve, camshaft, single.turn_sign
                )
            return Flywheel(lambda angles: self.at_theta(angles.theta).torque, self.load, camshaft)

        wheel: Flywheel = memory.get("flywheel", (self._key, self.design.balancer, camshaft), compute)
        return wheel

    @lazy
    def turn(self) -> MachineTurn:
        """Pieces of the machine's turn, between the joins of all drives that have a solution."""
        return MachineTurn(
            [
                (self.drives[name].program, self.positions[name])
                for name in self.loading_drives
                if name not in self.failures
            ]
        )

    @property
    def motor_torque(self) -> np.ndarray:
        """Torque of the motor T̄ + k(ω̄ - ω) (n,) [N m]; without a flywheel that of the shaft. Raises NoSolution where the motor stalls."""
        return self.flywheel.motor_torque(self._flywheel_angles) if self.levels_torque else self.torque

    @property
    def _flywheel_angles(self) -> Any:
        """The angles of the study in the pieces of the flywheel."""
        return (
            self.turn.angles(self.theta)
            if self.single_drive is None
            else self.drive_study(next(iter(self.drives))).angles
        )

    @property
    def speed(self) -> np.ndarray:
        """True speed of the shaft (n,) [rad/s]; constant without a flywheel. Raises NoSolution where the motor stalls."""
        return (
            self.flywheel.speed(self._flywheel_angles) if self.levels_torque else np.full(self.theta.size, self.omega)
        )

    @property
    def motor_range(self) -> Mapping[str, Extremes]:
        """Refined extremes of ``motor_torque`` [N m], ``speed`` [rad/s] and ``motor_power`` [W].

        Raises NoSolution where the motor stalls.
        """
        if not self.levels_torque:
            low, high = self.peaks.low, self.peaks.high
            power = Extremes(Extreme(low.value * self.omega, low.theta), Extreme(high.value * self.omega, high.theta))
            steady = Extreme(self.omega, 0.0)
            return {"motor_torque": self.peaks, "speed": Extremes(steady, steady), "motor_power": power}
        wheel = self.flywheel

        def values(angles: Any) -> Mapping[str, np.ndarray]:
            torque, speed = wheel.motor_torque(angles), wheel.speed(angles)
            return {"motor_torque": torque, "speed": speed, "motor_power": torque * speed}

        key = self._key, self.design.balancer, self.design.camshaft
        extremes: Mapping[str, Extremes] = memory.get("motor range", key, lambda: find_extremes(values, self.turn))
        return extremes

    # -- the flexible shaft ---------------------------------------------------------------------------------

    def flexible_shaft(self) -> Stability:
        """Stability of all drives together. Raises NoStability with the reason, NoSolution where a drive has no solution."""
        elastic = None if self.design.shaft is None else self.design.shaft.elastic
        if elastic is None:
            raise NoStability("the camshaft is rigid", "shaft", "enter camshaft_inertia_kg_m2 and stiffness_nm_per_rad")

        single = self.single_drive
        if single is not None:
            single.require_full_turn()
            position = ShaftPosition(0.0, single.turn_sign)
            turn = single.program if position == ShaftPosition() else MachineTurn([(single.program, position)])
            drives = [ShaftDrive("", 0, "", single, position, None if position == ShaftPosition() else turn)]
        else:
            self._require_all("the flexible shaft")
            turn = MachineTurn([(self.drives[name].program, self.positions[name]) for name in self.loading_drives])
            drives = []
            for index, name in enumerate(self.loading_drives):
                number = self.drive_number(name)
                study, position = self.drives[name], self.positions[name]
                drives.append(ShaftDrive(name, number, f"drives[{number}].", study, position, turn, index))

        def compute() -> Stability | NoStability:
            evaluations["stability"] += 1
            return flexible_shaft(drives, turn, elastic, self.omega)

        with nullcontext() if single is None else single.with_exact_angles("linkage"):
            result = memory.get("stability", (*(drive.parts for drive in drives), elastic, self.omega), compute)
        if isinstance(result, NoStability):
            raise result
        stability: Stability = result
        return stability


def _greatest(extremes: Extremes) -> Extreme:
    """The extreme that is greatest in size."""
    return max((extremes.low, extremes.high), key=lambda extreme: abs(extreme.value))


def _position(study: DriveForces, phase_deg: float) -> ShaftPosition:
    return ShaftPosition(float(np.deg2rad(phase_deg % 360.0)), study.turn_sign)


def _at_machine_angles(study: D, position: ShaftPosition, samples: int, theta: np.ndarray | None) -> D:
    """Study of a drive at machine angles (n,) [rad]; at equally spaced ones (theta None) the angles are cached.

    Where the grids of machine and drive coincide, its results are those of the drive in another order.
    """
    turn = MachineTurn([(study.program, position)])
    if theta is not None:
        return study.at(turn.drive_angles(0, turn.angles(theta)))

    def compute() -> Any:
        return turn.drive_angles(0, turn.angles(np.deg2rad(degrees(samples))), cached=True)

    angles = memory.get("grid", (study.program, samples, position), compute)
    order = _grid_order(position, samples)
    if order is None or study.theta.size != samples or position.rotation_sign < 0.0:  # then joins have the other limit
        return study.at(angles)
    return study.part(angles, order)


def _grid_order(position: ShaftPosition, samples: int) -> np.ndarray | None:
    """Numbers (n,) of the drive's grid angles at those of the machine, where both grids coincide; else None."""
    steps = position.phase * samples / TURN
    if abs(steps - round(steps)) > 1e-9:
        return None
    return np.asarray((int(position.rotation_sign) * (np.arange(samples) - round(steps))) % samples)


# -- stability of a flexible shaft with its drives --------------------------------------------------------------


@frozen(eq=False)
class ShaftDrive:
    """A drive on a flexible shaft.

    Attributes
    ----------
    name, number, path
        Name of the drive, its number in the list, and the path of its fields.
    study : DriveForces
    position : ShaftPosition
    turn : MachineTurn or None
        Pieces of the shaft's turn; None where the shaft goes by the angle of the drive.
    index : int
        Number of the drive's program in ``turn``.
    """

    name: str
    number: int
    path: str
    study: DriveForces
    position: ShaftPosition = ShaftPosition()
    turn: MachineTurn | None = None
    index: int = 0

    @property
    def key(self) -> tuple[Any, ...]:
        """Parts of the design on which the coefficients of the equation of motion depend."""
        study = self.study
        program = study.driver_ranges if study.by_crank else study.program
        return program, study.mechanism, study.driver_ranges, study.loading, self.position

    @property
    def parts(self) -> tuple[Any, ...]:
        """Parts of the design on which any result of the drive depends."""
        study, drive = self.study, self.study.design.drive
        cam = (drive.face if drive.has_disk else None, drive.bare_cam, study.sense) if drive.cam is not None else None
        return (*self.key, cam, drive.motion_unit, self.name, self.number)

    @property
    def can_lift_off(self) -> bool:
        """Whether the drive has a cam that its follower could leave."""
        return self.study.has_disk and not self.study.is_form_closed

    def drive_angles(self, angles: Angles) -> Angles:
        """Angles of the drive at angles of the shaft."""
        return angles if self.turn is None else self.turn.drive_angles(self.index, angles)

    def kinematics(self, angles: Angles) -> Kinematics:
        """Kinematics of the drive at given angles of the drive."""
        return solve_mechanism(self.study.mechanism, self.study.program.state(angles), self.study.driver_ranges)

    def kinematics_and_shape(self, angles: Angles) -> tuple[Kinematics, CamShape]:
        """Kinematics and cam of the drive at given angles of the drive."""
        kinematics, drive = self.kinematics(angles), self.study.design.drive
        return kinematics, envelope(kinematics, drive.face, drive.bare_cam, self.study.sense)

    def displacement(self, theta: np.ndarray) -> np.ndarray:
        """Displacement of the motion.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Angles of the shaft.

        Returns
        -------
        ndarray (n,) [m or rad]
        """
        program = self.study.program
        drive_theta = theta if self.turn is None else self.position.drive_angle(theta)
        return np.asarray(program.state(program.angles(drive_theta)).displacement[0])

    @property
    def driven(self) -> DrivenMechanism:
        """The drive as a mechanism in the equation of motion of the shaft."""
        from core.stability import DrivenMechanism

        study = self.study
        return DrivenMechanism(
            self.kinematics, study.loading, study.program, self.drive_angles, self.position.rotation_sign, self.path
        )

    def touching(self, sizes: Sizes | None) -> FollowerContact:
        """Contact of cam and follower; ``sizes`` are those of the shaft, where this is its only drive."""
        from core.stability import FollowerContact, driven_sizes

        study, sizes = self.study, sizes or driven_sizes(self.driven)
        parts = (
            study.loading,
            study.program,
            sizes,
            self.drive_angles,
            self.position.rotation_sign,
            self.name,
            self.number,
        )
        return FollowerContact(self.kinematics_and_shape, *parts)

    @property
    def follower(self) -> Follower:
        """Follower of the drive, for the steady response of the shaft."""
        from core.stability import Follower

        starts = self.study.program.starts
        joins = starts if self.turn is None else self.position.machine_angle(starts)
        return Follower(self.name, self.study.design.drive.motion_unit, self.displacement, joins)


def flexible_shaft(
    drives: Sequence[ShaftDrive], turn: Any, elastic: ElasticShaft, omega: float
) -> Stability | NoStability:
    """Stability of a flexible shaft with its drives, or why there is none.

    Parameters
    ----------
    drives : sequence of ShaftDrive
    turn : MachineTurn or CompiledMotion
        Pieces of the shaft's turn; no drive has a join within a piece.
    elastic : ElasticShaft
    omega : float [rad/s]
        Speed of the shaft.

    Returns
    -------
    Stability or NoStability
    """
    from core.stability import contact_forces, shaft_coefficients, stability

    s = si(elastic)
    parts = (s.camshaft_inertia, s.stiffness, elastic.spring, elastic.spring_factor)

    def compute() -> Coefficients | NoStability:
        try:
            return shaft_coefficients([drive.driven for drive in drives], turn, *parts)
        except NoStability as error:
            return error

    def contact() -> ShaftContacts | None:
        sizes = coefficients.sizes if len(drives) == 1 else None
        touching = [drive.touching(sizes) for drive in drives if drive.can_lift_off]
        return contact_forces(coefficients, elastic, touching, turn)

    def followers() -> Sequence[Follower]:
        return [drive.follower for drive in drives if "motion" in drive.study.stages]

    try:
        coefficients = memory.get("coefficients", (*(drive.key for drive in drives), *parts), compute)
        if isinstance(coefficients, NoStability):
            return coefficients
        return stability(coefficients, elastic, omega, contact, followers)
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
    return is_complete(camshaft) and (not camshaft.levels_torque or camshaft.flywheel.runs)
