"""Force elements: what acts on a mechanism, one class each. All give their loads and their potential in the same way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from core.frozen import frozen
from core.mechanism.kinematics import REVOLUTE, Kinematics
from core.numerics.derivatives import Derivatives
from core.numerics.vectors import dot

Number = float | np.ndarray


class Rate(NamedTuple):
    """How the shaft turns: speed θ̇ [rad/s] and acceleration θ̈ [rad/s²]; of any x(θ): ẍ = x'' θ̇² + x' θ̈."""

    speed: float
    acceleration: float = 0.0

    def second(self, x: Derivatives) -> np.ndarray:
        """ẍ (n,)."""
        if self.acceleration == 0.0:
            return self.speed * self.speed * x[2]
        return self.speed * self.speed * x[2] + self.acceleration * x[1]


class Load(NamedTuple):
    """A force [N] (n,) in the global frame at a place [m] of a body, and a couple [N m] on it."""

    body: str
    at: np.ndarray
    force: np.ndarray
    couple: Number = 0.0


class Element(Protocol):
    """One force element.

    loads      what it puts on the bodies, inertia included (d'Alembert)
    potential  V' and V'' of its potential energy by cam angle (2, n) [N m]; 0 where it has none
    acts       whether there is anything to it
    """

    @property
    def acts(self) -> bool: ...

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]: ...

    def potential(self, kinematics: Kinematics) -> np.ndarray: ...


@frozen
class Inertia:
    """mass [kg], centre of mass in the body's frame [m], inertia about that centre [kg m²]."""

    mass: float
    centre: complex = 0j
    about_centre: float = 0.0


def combined(parts: Sequence[Inertia]) -> Inertia:
    """Several masses fixed to one body as one (parallel axes)."""
    mass = sum(p.mass for p in parts)
    centre = sum((p.mass * p.centre for p in parts), 0j) / mass if mass else 0j
    about = sum(p.about_centre + p.mass * abs(p.centre - centre) ** 2 for p in parts)
    return Inertia(mass, centre, about)


@frozen
class Mass:
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
        zero = rate == Rate(0.0)
        pull = np.full(kinematics.theta.size, part.mass * self.gravity) if zero else (
            part.mass * (self.gravity - rate.second(z))
        )  # fmt: skip
        couple = -part.about_centre * rate.second(a) if part.about_centre and not zero else 0.0
        yield Load(self.body, z[0], pull, couple)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V = -m g·z."""
        z = kinematics.bodies[self.body].carried(self.inertia.centre)
        along = -self.inertia.mass * np.conjugate(self.gravity)
        return np.array([(along * z[order]).real for order in (1, 2)])

    def reduced_inertia(self, kinematics: Kinematics) -> np.ndarray:
        """J = m|z'|² + I α'², its share of the inertia at the camshaft, and J', J'' by cam angle (3, n) [kg m²]."""
        pose, part = kinematics.bodies[self.body], self.inertia
        z, a = pose.carried(part.centre), pose.turn
        m, i = part.mass, part.about_centre
        return np.array([
            m * dot(z[1], z[1]) + i * a[1] * a[1],
            2.0 * (m * dot(z[1], z[2]) + i * a[1] * a[2]),
            2.0 * (m * (dot(z[2], z[2]) + dot(z[1], z[3])) + i * (a[2] * a[2] + a[1] * a[3])),
        ])  # fmt: skip


@frozen
class OutputForce:
    """On the output along its motion: F(y) = force - rate y, y the motion [N and m, or N m and rad]: an external force and
    a spring."""

    force: float
    rate: float = 0.0
    sense: float = 1.0

    @property
    def acts(self) -> bool:
        return bool(self.force or self.rate)

    def size(self, kinematics: Kinematics) -> np.ndarray:
        """F (n,)."""
        return np.asarray(self.force - self.rate * kinematics.motion.displacement[0])

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        pair, along = kinematics.driver_pair, self.sense * self.size(kinematics)
        at = kinematics.bodies[kinematics.output].place(pair.point)
        if pair.kind == REVOLUTE:
            yield Load(kinematics.output, at, np.zeros(at.size, dtype=complex), along)
        else:
            yield Load(kinematics.output, at, along * pair.axis)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' = -F y'."""
        v, a = (kinematics.motion.displacement[order] for order in (1, 2))
        force = self.size(kinematics)
        return np.array([-force * v, self.rate * v * v - force * a])


@frozen
class PointForce:
    """A constant force [N], complex, at a point of a body, and a constant torque [N m] on it."""

    body: str
    point: str
    force: complex
    torque: float = 0.0

    @property
    def acts(self) -> bool:
        return bool(self.force or self.torque)

    def loads(self, kinematics: Kinematics, rate: Rate) -> Iterator[Load]:
        at = kinematics.bodies[self.body].place(self.point)
        yield Load(self.body, at, np.full(at.size, self.force), self.torque)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V' = -F·z' - T α'."""
        pose = kinematics.bodies[self.body]
        rows = [
            -dot(pose.place(self.point, order), np.asarray(self.force)) - self.torque * pose.turn[order] for order in (1, 2)
        ]
        return np.array(np.broadcast_arrays(*rows))


@frozen
class Friction:
    """Coulomb friction of a pair: μ|N| along the line of a sliding pair, the moment μ r |R| in a pin of radius r [m]."""

    pair: str
    coefficient: float
    radius: float = 1.0


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

    def inertia(self, kinematics: Kinematics) -> np.ndarray:
        """J(θ), J', J'' of all moved bodies at the camshaft (3, n) [kg m²]: the kinetic energy is J θ̇²/2."""
        return sum((mass.reduced_inertia(kinematics) for mass in self.masses), np.zeros((3, kinematics.theta.size)))

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V'(θ) and V'' of all elements (2, n) [N m]: the torque at standstill that they ask of the cam."""
        return sum((element.potential(kinematics) for element in self.elements), np.zeros((2, kinematics.theta.size)))
