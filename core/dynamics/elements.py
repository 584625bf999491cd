"""Force elements: the forces on the bodies of a mechanism, one class for each law."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar, NamedTuple

import numpy as np

from core.dynamics.schedules import Schedule
from core.frozen import frozen
from core.mechanism.kinematics import FRAME, FRAME_POSE, REVOLUTE, Kinematics, Pose
from core.numerics.derivatives import Derivatives, dot, spread

# -- force elements ---------------------------------------------------------------------------------------------


Number = float | np.ndarray


class Rate(NamedTuple):
    """Speed θ̇ [rad/s] and acceleration θ̈ [rad/s²] of the shaft."""

    speed: float
    acceleration: float = 0.0

    def second(self, x: Derivatives, by: Number = 1.0) -> np.ndarray:
        """Second derivative by time, ẍ = θ̇² x'' + θ̈ x', times a factor.

        Parameters
        ----------
        x : Derivatives
            Of a quantity [m or rad] by cam angle.
        by : float or ndarray (n,), dimensionless
            The factor.

        Returns
        -------
        ndarray (n,) [m/s² or rad/s²]
        """
        if self.acceleration == 0.0:
            return (by * self.speed * self.speed) * x[2]
        return (by * self.speed * self.speed) * x[2] + (by * self.acceleration) * x[1]


class Load(NamedTuple):
    """A force on a body and a couple on it.

    Attributes
    ----------
    body : name of the body
    at : ndarray (n,) complex [m]
        Point of application in the global frame.
    force : ndarray (n,) complex [N]
        In the global frame.
    couple : float or ndarray (n,) [N m]
    """

    body: str
    at: np.ndarray
    force: np.ndarray
    couple: Number = 0.0


class Element:
    """A force on bodies. A subclass states its law: its loads, its potential and the power that it dissipates.

    Attributes
    ----------
    name : name of its power among the channels; empty where it has none
    strengths : fields without which it is inactive
    """

    name: str = ""
    strengths: ClassVar[tuple[str, ...]] = ()

    @property
    def is_active(self) -> bool:
        """Whether one of its strengths is not 0."""
        return any(getattr(self, strength) for strength in self.strengths)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        """Loads on the bodies at a rate of the shaft, inertia forces included (d'Alembert)."""
        raise NotImplementedError

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' and V'' of its potential energy by cam angle; 0 for a force without potential.

        For a force that changes over the turn V' is the torque at standstill that it requires from the cam, since its
        work is a function of the cam angle too.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.

        Returns
        -------
        ndarray (2, n) [N m]
        """
        return np.zeros((2, kinematics.theta.size))

    def dissipation(self, kinematics: Kinematics, omega: float) -> np.ndarray:
        """Power that it turns into heat at a constant speed omega [rad/s].

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.
        omega : float
            Speed of the shaft [rad/s].

        Returns
        -------
        ndarray (n,) [W]
        """
        return np.zeros(kinematics.count)


# -- masses -----------------------------------------------------------------------------------------------------


@frozen
class Inertia:
    """Mass [kg], centre of mass in the body's frame [m], inertia about that centre [kg m²]."""

    mass: float
    centre: complex = 0j
    about_centre: float = 0.0


def combined_inertia(parts: Sequence[Inertia]) -> Inertia:
    """Inertia of several masses that are fixed to one body (parallel axes)."""
    mass = sum([p.mass for p in parts])
    centre = sum([p.mass * p.centre for p in parts], 0j) / (mass + (mass == 0.0))
    about = sum([p.about_centre + p.mass * abs(p.centre - centre) ** 2 for p in parts])
    return Inertia(mass, centre, about)


@frozen
class Mass(Element):
    """Mass of a body under gravity g [m/s²], complex: the force m(g - a) at its centre of mass and the couple -I α̈."""

    body: str
    inertia: Inertia
    gravity: complex = 0j

    @property
    def is_active(self) -> bool:
        """Whether mass or inertia is not 0."""
        return bool(self.inertia.mass or self.inertia.about_centre)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        """Force m(g - a) at the centre of mass and couple -I α̈."""
        pose, part = kinematics.bodies[self.body], self.inertia
        z, a = pose.fixed_point(part.centre), pose.turn
        zero, weight = not rate.speed and not rate.acceleration, part.mass * self.gravity
        if zero:
            force = spread(np.atleast_1d(weight), kinematics.count)
        else:
            inertia = rate.second(z, part.mass)
            # with many designs the weight is a column, which may have more values
            force = np.subtract(weight, inertia, out=inertia if isinstance(weight, complex) else None)
        couple = rate.second(a, -part.about_centre) if part.about_centre and not zero else 0.0
        yield Load(self.body, z[0], force, couple)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' and V'' of V = -m g·z by cam angle.

        Returns
        -------
        ndarray (2, n) [N m]
        """
        z = kinematics.bodies[self.body].fixed_point(self.inertia.centre)
        weight = -self.inertia.mass * np.conjugate(self.gravity)
        return np.array(np.broadcast_arrays(*((weight * z[order]).real for order in (1, 2))))

    def reduced_inertia(self, kinematics: Kinematics, orders: int = 3) -> np.ndarray:
        """Inertia reduced to the camshaft, J = m|z'|² + I α'², and its derivatives J', J'' by cam angle.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.
        orders : int
            Number of rows, 1 to 3.

        Returns
        -------
        ndarray (orders, n) [kg m²]
        """
        pose, part = kinematics.bodies[self.body], self.inertia
        z, a = pose.fixed_point(part.centre), pose.turn
        m, i = part.mass, part.about_centre
        rows = [m * dot(z[1], z[1]) + i * a[1] * a[1]]
        if orders > 1:
            rows.append(2.0 * (m * dot(z[1], z[2]) + i * a[1] * a[2]))
        if orders > 2:
            rows.append(2.0 * (m * (dot(z[2], z[2]) + dot(z[1], z[3])) + i * (a[2] * a[2] + a[1] * a[3])))
        return np.array(rows)


# -- forces on the output ---------------------------------------------------------------------------------------


def output_load(kinematics: Kinematics, size: np.ndarray, name: str = "") -> Load:
    """Load on the output along the coordinate of its driver: a force, or a torque where the driver rotates.

    Parameters
    ----------
    kinematics : Kinematics
        At n cam angles.
    size : ndarray (n,) [N or N m]
    name : str
        Name of a sliding pair on the frame whose body is loaded in place of the output.

    Returns
    -------
    Load
    """
    pair, body = (
        (kinematics.pairs[name], kinematics.pairs[name].body) if name else (kinematics.driver_pair, kinematics.output)
    )
    at = kinematics.bodies[body].position(pair.point)
    if pair.kind == REVOLUTE:
        return Load(body, at, np.zeros(1, dtype=complex), size)
    return Load(body, at, size * pair.axis)


@frozen
class OutputForce(Element):
    """External force and spring on the output along its motion y: F(y) = force - rate y [N and m, or N m and rad].

    ``sign`` is ±1: the direction of the motion along the driver's coordinate. ``pair`` is the name of a sliding pair on the frame,
    and of its coordinate, whose body and slide take the place of output and motion.
    """

    force: float
    rate: float = 0.0
    sign: float = 1.0
    name: str = ""
    pair: str = ""
    strengths: ClassVar[tuple[str, ...]] = ("force", "rate")

    def displacement(self, kinematics: Kinematics) -> Derivatives:
        """Displacement y of its body [m or rad] with derivatives by cam angle."""
        return kinematics.coordinates[self.pair] if self.pair else kinematics.motion.displacement

    def size(self, kinematics: Kinematics) -> np.ndarray:
        """Force F(y) at the cam angles.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.

        Returns
        -------
        ndarray (n,), or (1,) without a spring [N or N m]
        """
        if not self.rate:
            return np.atleast_1d(np.asarray(self.force))
        return np.asarray(self.force - self.rate * self.displacement(kinematics)[0])

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        """Force F(y) on the output."""
        yield output_load(kinematics, self.sign * self.size(kinematics), self.pair)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' = -F y' and V'' by cam angle.

        Returns
        -------
        ndarray (2, n) [N m]
        """
        displacement = self.displacement(kinematics)
        v, a = (displacement[order] for order in (1, 2))
        force = self.size(kinematics)
        return np.array([-force * v, self.rate * v * v - force * a])


@frozen
class OutputFriction(Element):
    """Coulomb friction of constant size on the output, against its motion: -F_r sgn ẏ [N or N m]."""

    size: float
    name: str = "friction"
    strengths: ClassVar[tuple[str, ...]] = ("size",)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        """Friction -F_r sgn ẏ on the output."""
        yield output_load(kinematics, -self.size * np.sign(rate.speed) * kinematics.motion.velocity_sign)

    def dissipation(self, kinematics: Kinematics, omega: float) -> np.ndarray:
        """Power F_r |ẏ|.

        Returns
        -------
        ndarray (n,) [W]
        """
        return np.asarray(self.size * np.abs(omega * kinematics.motion.displacement[1]))


# -- forces on a point of a body --------------------------------------------------------------------------------


@frozen
class BodyPoint:
    """A point [m] in the frame of a body; a point of the frame in the global one."""

    body: str
    at: complex


def _work_rate(z: Derivatives, turn: Derivatives, force: complex, torque: float, order: int) -> np.ndarray:
    """Work rate F·z' + T α' (n,) [N m] of a constant force and torque by cam angle, or its derivative (order 2)."""
    return dot(z[order], np.asarray(force)) + torque * turn[order]


@frozen
class PointForce(Element):
    """Constant force [N], complex, on a point of a body, and a constant torque [N m] on the body."""

    body: str
    point: str
    force: complex
    torque: float = 0.0
    name: str = ""
    strengths: ClassVar[tuple[str, ...]] = ("force", "torque")

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        """The force at the point, and the torque."""
        at = kinematics.bodies[self.body].position(self.point)
        yield Load(self.body, at, np.atleast_1d(self.force), self.torque)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' = -F·z' - T α' and V'' by cam angle.

        Returns
        -------
        ndarray (2, n) [N m]
        """
        pose = kinematics.bodies[self.body]
        z = pose.fixed_point(pose.points[self.point])
        rows = [-_work_rate(z, pose.turn, self.force, self.torque, order) for order in (1, 2)]
        return np.array(np.broadcast_arrays(*rows))


@frozen
class ScheduledForce(Element):
    """A process force: its size times the factor of a schedule.

    Attributes
    ----------
    schedule : factor by cam angle
    size : force [N] or torque [N m] on the output along its motion, where ``point`` is None
    sign : ±1, as of `OutputForce`
    point : point of the body on which it acts, None for the output
    force : force [N] on this point, complex in the global frame
    torque : torque [N m] on this body
    field : path of its row in the file
    """

    schedule: Schedule
    size: float = 0.0
    sign: float = 1.0
    point: BodyPoint | None = None
    force: complex = 0j
    torque: float = 0.0
    name: str = ""
    field: str = ""
    strengths: ClassVar[tuple[str, ...]] = ("size", "force", "torque")

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        """The force on the output, or at the point, times the factor."""
        factor, _ = self.schedule.value(kinematics.motion)
        if self.point is None:
            yield output_load(kinematics, self.sign * self.size * factor)
        else:
            at = kinematics.bodies[self.point.body].fixed_point(self.point.at)[0]
            yield Load(self.point.body, at, self.force * factor, self.torque * factor)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' = -F w' and V'' = -F' w' - F w'': F the factor, w the work of the force for F = 1.

        Returns
        -------
        ndarray (2, n) [N m]
        """
        factor, slope = self.schedule.value(kinematics.motion)
        if self.point is None:
            first, second = (self.size * kinematics.motion.displacement[order] for order in (1, 2))
        else:
            pose = kinematics.bodies[self.point.body]
            z = pose.fixed_point(self.point.at)
            first, second = (_work_rate(z, pose.turn, self.force, self.torque, order) for order in (1, 2))
        return np.array([-factor * first, -slope * first - factor * second])


# -- springs and dampers ----------------------------------------------------------------------------------------


class SpringDamper(Element):
    """A spring and a damper in parallel between two bodies."""

    rate: float
    damping: float
    field: str
    damping_key: ClassVar[str]
    strengths: ClassVar[tuple[str, ...]] = ("rate", "damping")

    def elongation_rate(self, kinematics: Kinematics) -> np.ndarray:
        """Derivative of length or angle by cam angle.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.

        Returns
        -------
        ndarray (n,) [m/rad], or dimensionless for an angle
        """
        raise NotImplementedError

    def dissipation(self, kinematics: Kinematics, omega: float) -> np.ndarray:
        """Power c l̇², or c φ̇², of the damper.

        Returns
        -------
        ndarray (n,) [W]
        """
        return np.asarray(self.damping * (omega * self.elongation_rate(kinematics)) ** 2)


@frozen
class Spring(SpringDamper):
    """A spring and a damper between points of two bodies at the distance l: the tension F = k (l - l_0) + c l̇.

    rate k [N/m], length l_0 [m], damping c [N s/m]; field: path of its row in the file
    """

    first: BodyPoint
    second: BodyPoint
    rate: float = 0.0
    length: float = 0.0
    damping: float = 0.0
    name: str = ""
    field: str = ""
    damping_key: ClassVar[str] = "damping_n_s_per_mm"

    def between(self, kinematics: Kinematics, order: int = 0) -> np.ndarray:
        """Vector d = z_second - z_first from end to end, or a derivative by cam angle.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.
        order : int
            Order of the derivative.

        Returns
        -------
        ndarray (n,) complex [m]
        """
        first, second = self.ends(kinematics, order)
        return np.asarray(second - first)

    def ends(self, kinematics: Kinematics, order: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Points z_first and z_second, or their derivatives by cam angle.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.
        order : int
            Order of the derivative.

        Returns
        -------
        first, second : ndarray (n,) complex [m]
        """
        n = kinematics.count
        first, second = self._points(kinematics)
        return spread(first[order], n), spread(second[order], n)

    def _points(self, kinematics: Kinematics) -> tuple[Derivatives, Derivatives]:
        first, second = (body_pose(kinematics, p.body).fixed_point(p.at) for p in (self.first, self.second))
        return first, second

    def elongation_rate(self, kinematics: Kinematics) -> np.ndarray:
        """Derivative l' of the length by cam angle; 0 where the ends meet.

        Returns
        -------
        ndarray (n,) [m/rad]
        """
        d = self.between(kinematics)
        size = np.abs(d)
        return dot(d, self.between(kinematics, 1)) / np.where(size > 0.0, size, 1.0)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        """The tension k (l - l0) + c l̇ on the two bodies."""
        first, second = self._points(kinematics)
        d = spread(second[0] - first[0], kinematics.count)
        size = np.abs(d)
        safe = np.where(size > 0.0, size, 1.0)
        pull = self.rate * (1.0 - self.length / safe if self.length else 1.0) * d
        if self.damping and rate.speed:
            pull = pull + (self.damping * rate.speed) * (dot(d, second[1] - first[1]) / (safe * safe)) * d
        for end, at, force in ((self.first, first, pull), (self.second, second, -pull)):
            if end.body != FRAME:
                yield Load(end.body, at[0], force)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' and V'' of V = k (l - l0)²/2 by cam angle.

        V' = k (1 - l0/l) d·d', V'' = k [(1 - l0/l)(d'·d' + d·d'') + l0 (d·d')²/l³].

        Returns
        -------
        ndarray (2, n) [N m]
        """
        d, d1, d2 = (self.between(kinematics, order) for order in range(3))
        safe = np.abs(d)
        safe = np.where(safe > 0.0, safe, 1.0)
        ratio, along = self.length / safe, dot(d, d1)
        second = (1.0 - ratio) * (dot(d1, d1) + dot(d, d2)) + ratio * (along / safe) ** 2
        return self.rate * np.array([(1.0 - ratio) * along, second])


@frozen
class Torsion(SpringDamper):
    """A torsion spring and a damper of ``body`` against ``on``: the torque k (φ - φ0) + c φ̇, φ = α_body - α_on.

    rate k [N m/rad]; free: φ0 [rad], from angles in the global frame; damping c [N m s/rad]
    """

    body: str
    on: str
    rate: float = 0.0
    free: float = 0.0
    damping: float = 0.0
    name: str = ""
    field: str = ""
    damping_key: ClassVar[str] = "damping_nm_s_per_rad"

    def angle(self, kinematics: Kinematics, order: int = 0) -> np.ndarray:
        """Angle of twist φ - φ0, or a derivative by cam angle.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.
        order : int
            Order of the derivative.

        Returns
        -------
        ndarray (n,) [rad]
        """
        body, on = (body_pose(kinematics, name).turn[order] for name in (self.body, self.on))
        return spread(body - on - (0.0 if order else self.free), kinematics.count)

    def elongation_rate(self, kinematics: Kinematics) -> np.ndarray:
        """Derivative φ' of the angle by cam angle.

        Returns
        -------
        ndarray (n,), dimensionless
        """
        return self.angle(kinematics, 1)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        """The torque k (φ - φ0) + c φ̇ on the two bodies."""
        torque = self.rate * self.angle(kinematics)
        if self.damping and rate.speed:
            torque = torque + self.damping * rate.speed * self.angle(kinematics, 1)
        for body, couple in ((self.body, -torque), (self.on, torque)):
            if body != FRAME:
                at = kinematics.bodies[body].origin[0]
                yield Load(body, at, np.zeros(kinematics.count, dtype=complex), couple)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' and V'' of V = k (φ - φ0)²/2 by cam angle.

        Returns
        -------
        ndarray (2, n) [N m]
        """
        a, a1, a2 = (self.angle(kinematics, order) for order in range(3))
        return self.rate * np.array([a * a1, a1 * a1 + a * a2])


def body_pose(kinematics: Kinematics, body: str) -> Pose:
    """Pose of a body, or of the frame, whose points are those of the global frame."""
    return kinematics.bodies.get(body, FRAME_POSE)
