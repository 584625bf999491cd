"""Force elements: what acts on a mechanism, one class each. All give their loads and their potential in the same way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple, Protocol

import numpy as np

from core.frozen import frozen
from core.mechanism.kinematics import FRAME, FRAME_POSE, REVOLUTE, Kinematics, Pose
from core.motion import TURN, MotionState
from core.motion.extremes import crossings, piecewise_angles
from core.numerics.derivatives import Derivatives, dot, spread

# -- when a process force works ---------------------------------------------------------------------------------


_LEVEL = 1e-9  # [m or rad] a dwell this near to the end of a part of the motion lies in it


@frozen
class OverTurn:
    """On from one angle to another [rad], past 0 where the first is the larger."""

    start: float
    end: float

    def value(self, motion: MotionState) -> tuple[np.ndarray, np.ndarray]:
        """1 where it is on, else 0, and the derivative by cam angle (n,)."""
        at = motion.within[0]
        after, before = at >= self.start, at < self.end
        on = after & before if self.start < self.end else after | before
        return on.astype(float), np.zeros(at.size)

    def cuts(self, program: Any) -> np.ndarray:
        """Angles (m,) [rad] at which it switches."""
        return np.mod([self.start, self.end], TURN)


@frozen
class OverMotion:
    """On while the motion [m or rad] lies between two values, these included."""

    low: float
    high: float

    def value(self, motion: MotionState) -> tuple[np.ndarray, np.ndarray]:
        """1 where it is on, else 0, and the derivative by cam angle (n,)."""
        y = motion.within[1]
        return ((y >= self.low - _LEVEL) & (y <= self.high + _LEVEL)).astype(float), np.zeros(y.size)

    def cuts(self, program: Any) -> np.ndarray:
        """Angles (m,) [rad] at which it switches: roots of the motion."""
        angles = piecewise_angles(program)
        y = program.state(angles).displacement[0]
        levels = np.array([[self.low], [self.high]])
        return crossings(lambda there: program.state(there).displacement[0] - levels, angles, y - levels).theta


@frozen
class ByTable:
    """Linear between rows of angle [rad] and value, periodic."""

    angles: tuple[float, ...]
    values: tuple[float, ...]

    def value(self, motion: MotionState) -> tuple[np.ndarray, np.ndarray]:
        """Value and derivative by cam angle (n,)."""
        at = np.array([self.angles[-1] - TURN, *self.angles, self.angles[0] + TURN])
        rows = np.array([self.values[-1], *self.values, self.values[0]])
        width = np.diff(at)
        slope = np.where(width > 0.0, np.diff(rows) / np.where(width > 0.0, width, 1.0), 0.0)
        row = np.clip(np.searchsorted(at, motion.within[0], side="right") - 1, 0, slope.size - 1)
        return rows[row] + slope[row] * (motion.theta - at[row]), slope[row]

    def cuts(self, program: Any) -> np.ndarray:
        """Its rows."""
        return np.mod(self.angles, TURN)


Schedule = OverTurn | OverMotion | ByTable


# -- force elements ---------------------------------------------------------------------------------------------


Number = float | np.ndarray


class Rate(NamedTuple):
    """How the shaft turns: speed θ̇ [rad/s] and acceleration θ̈ [rad/s²]; of any x(θ): ẍ = x'' θ̇² + x' θ̈."""

    speed: float
    acceleration: float = 0.0

    def second(self, x: Derivatives, by: Number = 1.0) -> np.ndarray:
        """ẍ = ω² x'' + ω̇ x' (n,) [unit of x per s²], by a factor."""
        if self.acceleration == 0.0:
            return (by * self.speed * self.speed) * x[2]
        return (by * self.speed * self.speed) * x[2] + (by * self.acceleration) * x[1]


class Load(NamedTuple):
    """A force [N] (n,) in the global frame at a place [m] of a body, and a couple [N m] on it."""

    body: str
    at: np.ndarray
    force: np.ndarray
    couple: Number = 0.0


class Element(Protocol):
    """One force element.

    name       of its power among the channels; empty where that has none
    loads      what it puts on the bodies, inertia included (d'Alembert)
    potential  V' and V'' of its potential energy by cam angle (2, n) [N m]; 0 where it has none. Of a force that changes over the
               turn V' is what it asks of the cam at standstill, since its work is a function of the cam angle too
    lost       power [W] (n,) that it turns into heat
    acts       whether there is anything to it
    """

    @property
    def name(self) -> str: ...

    @property
    def acts(self) -> bool: ...

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]: ...

    def potential(self, kinematics: Kinematics) -> np.ndarray: ...

    def lost(self, kinematics: Kinematics, omega: float) -> np.ndarray: ...


class Lossless:
    """What all elements without a damper share."""

    name = ""

    def lost(self, kinematics: Kinematics, omega: float) -> np.ndarray:
        """Power turned into heat (n,) [W]: 0."""
        return np.zeros(kinematics.theta.shape[-1])


def pose_of(kinematics: Kinematics, body: str) -> Pose:
    """Of a body, or of the frame, whose places are those of the global frame."""
    return kinematics.bodies.get(body, FRAME_POSE)


@frozen
class Inertia:
    """mass [kg], centre of mass in the body's frame [m], inertia about that centre [kg m²]."""

    mass: float
    centre: complex = 0j
    about_centre: float = 0.0


def combined(parts: Sequence[Inertia]) -> Inertia:
    """Several masses fixed to one body as one (parallel axes)."""
    mass = sum(p.mass for p in parts)
    centre = sum((p.mass * p.centre for p in parts), 0j) / (mass + (mass == 0.0))
    about = sum(p.about_centre + p.mass * abs(p.centre - centre) ** 2 for p in parts)
    return Inertia(mass, centre, about)


@frozen
class Mass(Lossless):
    """The mass of a body under gravity g [m/s²], complex: m(g - a) at its centre of mass and the couple -I α̈."""

    body: str
    inertia: Inertia
    gravity: complex = 0j

    @property
    def acts(self) -> bool:
        return bool(self.inertia.mass or self.inertia.about_centre)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        pose, part = kinematics.bodies[self.body], self.inertia
        z, a = pose.carried(part.centre), pose.turn
        zero = not rate.speed and not rate.acceleration
        pull = (
            spread(np.atleast_1d(part.mass * self.gravity), kinematics.theta.shape[-1])
            if zero
            else part.mass * self.gravity - rate.second(z, part.mass)
        )
        couple = rate.second(a, -part.about_centre) if part.about_centre and not zero else 0.0
        yield Load(self.body, z[0], pull, couple)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V = -m g·z: V' and V'' by cam angle (2, n) [N m]."""
        z = kinematics.bodies[self.body].carried(self.inertia.centre)
        along = -self.inertia.mass * np.conjugate(self.gravity)
        return np.array(np.broadcast_arrays(*((along * z[order]).real for order in (1, 2))))

    def reduced_inertia(self, kinematics: Kinematics, orders: int = 3) -> np.ndarray:
        """J = m|z'|² + I α'², its share of the inertia at the camshaft, and J', J'' by cam angle (3, n) [kg m²], or so many of
        them."""
        pose, part = kinematics.bodies[self.body], self.inertia
        z, a = pose.carried(part.centre), pose.turn
        m, i = part.mass, part.about_centre
        rows = [m * dot(z[1], z[1]) + i * a[1] * a[1]]
        if orders > 1:
            rows.append(2.0 * (m * dot(z[1], z[2]) + i * a[1] * a[2]))
        if orders > 2:
            rows.append(2.0 * (m * (dot(z[2], z[2]) + dot(z[1], z[3])) + i * (a[2] * a[2] + a[1] * a[3])))
        return np.array(rows)


def on_output(kinematics: Kinematics, size: np.ndarray) -> Load:
    """A force, or a torque where it turns, on the output along its driver's coordinate (n,)."""
    pair = kinematics.driver_pair
    at = kinematics.bodies[kinematics.output].place(pair.point)
    if pair.kind == REVOLUTE:
        return Load(kinematics.output, at, np.zeros(1, dtype=complex), size)
    return Load(kinematics.output, at, size * pair.axis)


@frozen
class OutputForce(Lossless):
    """On the output along its motion: F(y) = force - rate y, y the motion [N and m, or N m and rad]: an external force and
    a spring."""

    force: float
    rate: float = 0.0
    sense: float = 1.0
    name: str = ""

    @property
    def acts(self) -> bool:
        return bool(self.force or self.rate)

    def size(self, kinematics: Kinematics) -> np.ndarray:
        """The force F (n,) [N] or torque [N m] at the cam angles."""
        return np.asarray(self.force - self.rate * kinematics.motion.displacement[0])

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        yield on_output(kinematics, self.sense * self.size(kinematics))

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' = -F y' and V'' by cam angle (2, n) [N m]."""
        v, a = (kinematics.motion.displacement[order] for order in (1, 2))
        force = self.size(kinematics)
        return np.array([-force * v, self.rate * v * v - force * a])


@frozen
class OutputFriction:
    """Coulomb friction of a constant size on the output, against its motion: -F_r sgn ẏ [N, or N m]."""

    size: float
    name: str = "friction"

    @property
    def acts(self) -> bool:
        return bool(self.size)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        yield on_output(kinematics, -self.size * np.sign(rate.speed) * kinematics.motion.velocity_sign)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """It has none."""
        return np.zeros((2, kinematics.theta.size))

    def lost(self, kinematics: Kinematics, omega: float) -> np.ndarray:
        """Power F_r |ẏ| (n,) [W] turned into heat."""
        return np.asarray(self.size * np.abs(omega * kinematics.motion.displacement[1]))


@frozen
class PointForce(Lossless):
    """A constant force [N], complex, at a point of a body, and a constant torque [N m] on it."""

    body: str
    point: str
    force: complex
    torque: float = 0.0
    name: str = ""

    @property
    def acts(self) -> bool:
        return bool(self.force or self.torque)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        at = kinematics.bodies[self.body].place(self.point)
        yield Load(self.body, at, np.atleast_1d(self.force), self.torque)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' = -F·z' - T α' and V'' by cam angle (2, n) [N m]."""
        pose = kinematics.bodies[self.body]
        rows = [
            -dot(pose.place(self.point, order), np.asarray(self.force)) - self.torque * pose.turn[order]
            for order in (1, 2)
        ]
        return np.array(np.broadcast_arrays(*rows))


@frozen
class BodyPoint:
    """A place [m] in the frame of a body, of the frame in the global one."""

    body: str
    at: complex


@frozen
class Spring:
    """A spring and a damper between places of two bodies: F = k (l - l_0) + c l̇ pulls them together, l their distance.

    rate [N/m], length l0 [m], damping [N s/m]; field: path of its row in the file
    """

    one: BodyPoint
    other: BodyPoint
    rate: float = 0.0
    length: float = 0.0
    damping: float = 0.0
    name: str = ""
    field: str = ""
    damping_key: ClassVar[str] = "damping_n_s_per_mm"

    @property
    def acts(self) -> bool:
        return bool(self.rate or self.damping)

    def between(self, kinematics: Kinematics, order: int = 0) -> np.ndarray:
        """d = z_other - z_one (n,) [m], complex, or a derivative by cam angle."""
        one, other = self.ends(kinematics, order)
        return np.asarray(other - one)

    def ends(self, kinematics: Kinematics, order: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """z_one and z_other (n,) [m], complex, or a derivative by cam angle."""
        n = kinematics.theta.shape[-1]
        one, other = self._carried(kinematics)
        return spread(one[order], n), spread(other[order], n)

    def _carried(self, kinematics: Kinematics) -> tuple[Derivatives, Derivatives]:
        one, other = (pose_of(kinematics, place.body).carried(place.at) for place in (self.one, self.other))
        return one, other

    def stretch(self, kinematics: Kinematics) -> np.ndarray:
        """l' (n,) [m]; 0 where the ends meet."""
        d = self.between(kinematics)
        size = np.abs(d)
        return dot(d, self.between(kinematics, 1)) / np.where(size > 0.0, size, 1.0)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        one, other = self._carried(kinematics)
        d = spread(other[0] - one[0], kinematics.theta.shape[-1])
        size = np.abs(d)
        safe = np.where(size > 0.0, size, 1.0)
        pull = self.rate * (1.0 - self.length / safe if self.length else 1.0) * d
        if self.damping and rate.speed:
            pull = pull + (self.damping * rate.speed) * (dot(d, other[1] - one[1]) / (safe * safe)) * d
        for place, at, force in ((self.one, one, pull), (self.other, other, -pull)):
            if place.body != FRAME:
                yield Load(place.body, at[0], force)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V = k (l - l0)²/2: V' = k (1 - l0/l) d·d', V'' = k [(1 - l0/l)(d'·d' + d·d'') + l0 (d·d')²/l³]."""
        d, d1, d2 = (self.between(kinematics, order) for order in range(3))
        safe = np.abs(d)
        safe = np.where(safe > 0.0, safe, 1.0)
        over, along = self.length / safe, dot(d, d1)
        second = (1.0 - over) * (dot(d1, d1) + dot(d, d2)) + over * (along / safe) ** 2
        return self.rate * np.array([(1.0 - over) * along, second])

    def lost(self, kinematics: Kinematics, omega: float) -> np.ndarray:
        """Power c l̇² (n,) [W] that the damper turns into heat."""
        return np.asarray(self.damping * (omega * self.stretch(kinematics)) ** 2)


@frozen
class Torsion:
    """A torsion spring and a damper of ``body`` against ``on``: k (φ - φ0) + c φ̇ turns it back, φ = α_body - α_on.

    rate [N m/rad]; free: φ0 [rad], of angles in the global frame; damping [N m s/rad]
    """

    body: str
    on: str
    rate: float = 0.0
    free: float = 0.0
    damping: float = 0.0
    name: str = ""
    field: str = ""
    damping_key: ClassVar[str] = "damping_nm_s_per_rad"

    @property
    def acts(self) -> bool:
        return bool(self.rate or self.damping)

    def angle(self, kinematics: Kinematics, order: int = 0) -> np.ndarray:
        """φ - φ0 (n,) [rad], or a derivative by cam angle."""
        one, other = (pose_of(kinematics, body).turn[order] for body in (self.body, self.on))
        return spread(one - other - (0.0 if order else self.free), kinematics.theta.shape[-1])

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        back = self.rate * self.angle(kinematics)
        if self.damping and rate.speed:
            back = back + self.damping * rate.speed * self.angle(kinematics, 1)
        for body, couple in ((self.body, -back), (self.on, back)):
            if body != FRAME:
                at = kinematics.bodies[body].origin[0]
                yield Load(body, at, np.zeros(kinematics.theta.shape[-1], dtype=complex), couple)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V = k (φ - φ0)²/2: V' and V'' by cam angle (2, n) [N m]."""
        a, a1, a2 = (self.angle(kinematics, order) for order in range(3))
        return self.rate * np.array([a * a1, a1 * a1 + a * a2])

    def lost(self, kinematics: Kinematics, omega: float) -> np.ndarray:
        """Power c φ̇² (n,) [W] that the damper turns into heat."""
        return np.asarray(self.damping * (omega * self.angle(kinematics, 1)) ** 2)


@frozen
class ScheduledForce(Lossless):
    """A process force, ``schedule`` times its size: on the output along its motion where it has no place, sense as that of
    ``OutputForce``; else a force [N], complex in the global frame, at a place of a body, and a torque [N m] on it. field: path of its row
    in the file."""

    schedule: Schedule
    along: float = 0.0
    sense: float = 1.0
    place: BodyPoint | None = None
    force: complex = 0j
    torque: float = 0.0
    name: str = ""
    field: str = ""

    @property
    def acts(self) -> bool:
        return bool(self.along or self.force or self.torque)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        on, _ = self.schedule.value(kinematics.motion)
        if self.place is None:
            yield on_output(kinematics, self.sense * self.along * on)
        else:
            at = kinematics.bodies[self.place.body].carried(self.place.at)[0]
            yield Load(self.place.body, at, self.force * on, self.torque * on)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' = -F w' and V'' = -F' w' - F w'', w' the way of a unit of it by cam angle."""
        on, slope = self.schedule.value(kinematics.motion)
        first, second = (self._way(kinematics, order) for order in (1, 2))
        return np.array([-on * first, -slope * first - on * second])

    def _way(self, kinematics: Kinematics, order: int) -> np.ndarray:
        if self.place is None:
            return self.along * kinematics.motion.displacement[order]
        pose = kinematics.bodies[self.place.body]
        return dot(pose.carried(self.place.at)[order], np.asarray(self.force)) + self.torque * pose.turn[order]


@frozen
class Friction:
    """Coulomb friction of a pair: μ|N| along the line of a sliding pair, the moment μ r |R| in a pin of radius r [m].

    length  of a sliding pair [m]: its two edges carry N/2 ± M/length, M the couple on it; 0: N acts in one point
    field   path of its row in the file
    """

    pair: str
    coefficient: float
    radius: float = 1.0
    length: float = 0.0
    field: str = "loads.friction"

    @property
    def own(self) -> bool:
        """Whether it is the loads' own guide friction."""
        return self.field == "loads.friction"


@frozen
class Loading:
    """What acts on a mechanism: masses, other force elements, and the pairs that rub.

    guide  name of the pair whose friction is the design's guide friction; empty where it has no guide
    contact_friction  coefficient of a face that slides on the cam
    """

    masses: tuple[Mass, ...] = ()
    others: tuple[Element, ...] = ()
    frictions: tuple[Friction, ...] = ()
    guide: str = ""
    contact_friction: float = 0.0

    @property
    def named(self) -> Mapping[str, Element]:
        """Name -> element, of those whose power is a channel."""
        return MappingProxyType({element.name: element for element in self.others if element.name})

    @property
    def switches(self) -> tuple[Schedule, ...]:
        """When its process forces work."""
        return tuple(element.schedule for element in self.others if isinstance(element, ScheduledForce))

    def cuts(self, program: Any) -> np.ndarray:
        """Angles (m,) [rad] at which a force switches."""
        found = [schedule.cuts(program) for schedule in self.switches]
        return np.concatenate(found) if found else np.zeros(0)

    @property
    def rubs(self) -> bool:
        """Whether there is friction anywhere, so that something might jam."""
        return bool(self.frictions or self.contact_friction)

    @property
    def elements(self) -> tuple[Element, ...]:
        """All that have a load."""
        return tuple(element for element in (*self.masses, *self.others) if element.acts)

    @property
    def empty(self) -> bool:
        """True where nothing has mass and nothing pushes."""
        return not self.elements

    @property
    def friction(self) -> float:
        """The coefficient of the guide."""
        return next((f.coefficient for f in self.frictions if f.pair == self.guide), 0.0)

    @property
    def smooth(self) -> Loading:
        """The same without friction."""
        return Loading(self.masses, self.others, (), self.guide)

    @property
    def inertial(self) -> Loading:
        """Its masses alone, without their weight."""
        return Loading(tuple(Mass(m.body, m.inertia) for m in self.masses), (), (), self.guide)

    @property
    def inertial_with_contact(self) -> Loading:
        """Its masses alone, under the friction of a face that slides on the cam."""
        return replace(self.inertial, contact_friction=self.contact_friction)

    def inertia(self, kinematics: Kinematics, orders: int = 3) -> np.ndarray:
        """J(θ), J', J'' of all moved bodies at the camshaft (3, n) [kg m²], or so many of them: the kinetic energy is J θ̇²/2."""
        none = np.zeros((orders, kinematics.theta.shape[-1]))
        return sum((mass.reduced_inertia(kinematics, orders) for mass in self.masses), none)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V'(θ) and V'' of all elements (2, n) [N m]: the torque at standstill that they ask of the cam."""
        return sum(
            (element.potential(kinematics) for element in self.elements), np.zeros((2, kinematics.theta.shape[-1]))
        )
