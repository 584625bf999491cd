"""Kinematics of a mechanism: bodies with their poses, the pairs between them, and the order of the dyads for forces.

Drawing, cam profile, instant centres and forces depend on Kinematics and on nothing else of a follower.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from types import MappingProxyType
from typing import Any

import numpy as np

from core.frozen import frozen
from core.motion import MotionState
from core.numerics.derivatives import Derivatives, body_vector, constant, dot, sum_with_multiple, unit
from core.numerics.lazy import Lazy, lazy, self_locking

FRAME, CAM = "frame", "cam"
REVOLUTE, SLIDING = "revolute", "sliding"
_NOTHING: Mapping[str, complex] = MappingProxyType({})


@self_locking
@frozen(eq=False)
class Pose:
    """Position and angle of a body with three derivatives by cam angle, each calculated when it is first read.

    Attributes
    ----------
    origin : Derivatives
        Origin of the body's frame, complex, in the global frame (n,) [m].
    turn : Derivatives
        Angle from global +x (n,) [rad], counter-clockwise.
    points : mapping of str to complex
        Named points of the body in its frame [m].
    unit : ndarray (n,) complex, dimensionless
        Direction of the body's x axis, e^{i angle}.
    spin : Derivatives
        `unit` with its derivatives (n,), or (1,) where the angle is constant.
    """

    origin: Derivatives
    turn: Derivatives
    points: Mapping[str, complex] = field(default_factory=lambda: _NOTHING)
    unit: Lazy[np.ndarray] = Lazy(lambda pose: unit(pose.turn[0]))
    spin: Lazy[Derivatives] = Lazy(lambda pose: body_vector(pose.unit, pose.turn))

    @classmethod
    def of(cls, z: np.ndarray, angle: np.ndarray, points: Mapping[str, complex] = _NOTHING) -> Pose:
        """Pose from a value and three derivatives.

        Parameters
        ----------
        z : ndarray (4, n) complex [m]
            Origin with its derivatives by cam angle.
        angle : ndarray (4, n) [rad]
            Angle with its derivatives by cam angle.
        points : mapping of str to complex
            Named points in the body's frame [m].

        Returns
        -------
        Pose
        """
        return cls(Derivatives.of(z), Derivatives.of(angle), points)

    def with_turn(self, turn: Derivatives) -> Pose:
        """The pose with another angle that differs by whole turns."""
        return Pose(self.origin, turn, self.points, lambda: self.unit, lambda: self.spin)

    @property
    def z(self) -> np.ndarray:
        """Origin (4, n) complex [m] with its derivatives by cam angle [m/rad^k]."""
        return self.origin.all

    @property
    def angle(self) -> np.ndarray:
        """Angle (4, n) [rad] with its derivatives by cam angle."""
        return self.turn.all

    @property
    def x(self) -> np.ndarray:
        """Coordinate x of the origin (n,) [m] with its derivatives."""
        return self.z.real

    @property
    def y(self) -> np.ndarray:
        """Coordinate y of the origin (n,) [m] with its derivatives."""
        return self.z.imag

    def fixed_point(self, local: complex) -> Derivatives:
        """Point fixed in the body at `local` [m] of its frame, in the global frame (n,) [m]; cached."""
        if not local:
            return self.origin
        point = self._fixed_points.get(local)
        if point is None:
            point = sum_with_multiple(self.origin, self.spin, local)
            if not point.constant:  # all designs share the pose of the frame, whose cache would grow without end
                self._fixed_points[local] = point
        return point

    @lazy
    def _fixed_points(self) -> dict[complex, Derivatives]:
        return {}

    def point(self, name: str) -> np.ndarray:
        """Named point in the global frame with three derivatives by cam angle.

        Returns
        -------
        ndarray (4, n) complex [m]
        """
        return self.fixed_point(self.points[name]).all

    def position(self, name: str, order: int = 0) -> np.ndarray:
        """Named point in the global frame, or its derivative of an order 0 ... 3 by cam angle.

        Returns
        -------
        ndarray (n,) complex [m]
        """
        return self.fixed_point(self.points[name])[order]


FRAME_POSE = Pose(constant(0j), constant(0.0), unit=np.ones(1, dtype=complex))
"""Pose of the frame: the global frame."""


@self_locking
@frozen
class Pair:
    """Kinematic pair of two bodies.

    Attributes
    ----------
    kind : str
        REVOLUTE or SLIDING.
    on, body : str
        `body` turns or slides on `on`.
    point : str
        Named point of `body` in the pair.
    axis : complex
        Unit vector of a sliding pair's line in the frame of `on`; 0 of a revolute pair.
    """

    kind: str
    on: str
    body: str
    point: str
    axis: complex = 0j


@self_locking
@frozen
class Dyad:
    """Bodies that are solved together: a dyad, a larger group, or a second driving body.

    Attributes
    ----------
    kind : str
        Pairs from the driving body outwards: RRP is a rod and a slider.
    bodies, pairs : tuple of str
        Names, in the same order.
    on, ratio : str, float
        For a second driving body: the body against which it moves, and its turn or slide there per unit of the driver's.
    by_motion : bool
        The second driving body follows a separate motion and takes no force from the driver.
    driven : str
        The driving pair among `pairs`, where it is between two moving bodies.
    """

    kind: str
    bodies: tuple[str, ...]
    pairs: tuple[str, ...]
    on: str = ""
    ratio: float = 0.0
    by_motion: bool = False
    driven: str = ""

    @property
    def is_redundant(self) -> bool:
        """Whether more pairs constrain the bodies than necessary."""
        return 2 * len(self.pairs) + bool(self.driven) > 3 * len(self.bodies)


@frozen(eq=False)
class Kinematics:
    """Kinematics of a mechanism at n cam angles; lazy attributes are calculated when they are first read.

    Attributes
    ----------
    motion : MotionState
    bodies : mapping of str to Pose
    pairs : mapping of str to Pair
    dyads : tuple of Dyad
        Outermost first, which is the order in which forces are calculated.
    output : str
        Driven body, which moves against `driver_on`.
    follower_body : str
        Body on which the cam acts; its origin is the reference point of the face.
    ground : str
        Pair between the follower body and the frame; empty where there is none.
    travel : ndarray (n,) complex, dimensionless
        Unit vector in which the reference point moves when the follower moves forward.
    coordinates : mapping of str to Derivatives
        Coordinates of the follower (n,) [rad or m], named as in tables (phi, beta, slider_position).
    base : mapping of str to (float, str)
        Values of the base position in SI, with the unit in which they are displayed.
    residual : ndarray (n,), dimensionless
        Loop closure error divided by the size of the mechanism.
    condition : ndarray (n,), dimensionless
        Bound of `residual` in units of the machine epsilon.
    singular : mapping of str to ndarray (n,), dimensionless
        Measures 0 ... 1 that must not vanish, by the code of their finding.
    transmission : mapping of str to ndarray (n,) [rad]
        Transmission angle 0 ... π/2 by the joint of the dyad.
    by_driver : mapping of str to Pose
        Poses with derivatives by the driver's coordinate, which are defined in a dwell too.
    carrier : str
        Body that carries the follower body, where that is the roller alone.
    driver_sign : float
        Sign ±1 of the driver's coordinate: q = start + driver_sign y.
    driver_on : str
        Body against which the driven body moves.
    """

    motion: MotionState
    bodies: Mapping[str, Pose]
    pairs: Mapping[str, Pair]
    dyads: tuple[Dyad, ...]
    output: str
    follower_body: str
    ground: str
    travel: Lazy[np.ndarray] = Lazy()
    coordinates: Lazy[Mapping[str, Derivatives]] = Lazy()
    base: Lazy[Mapping[str, tuple[float, str]]] = Lazy()
    residual: Lazy[np.ndarray] = Lazy()
    condition: Lazy[np.ndarray] = Lazy()
    singular: Lazy[Mapping[str, np.ndarray]] = Lazy(lambda kinematics: MappingProxyType({}))
    transmission: Lazy[Mapping[str, np.ndarray]] = Lazy(lambda kinematics: MappingProxyType({}))
    by_driver: Lazy[Mapping[str, Pose]] = Lazy(lambda kinematics: MappingProxyType({}))
    carrier: str = ""
    driver_sign: float = 1.0
    driver_on: str = FRAME

    def body_of(self, point: str) -> str:
        """Body whose pose gives a named point: a sliding body that has the point, since it stays on its line, else the first."""
        candidates = [name for name, body in self.bodies.items() if point in body.points]
        sliding = [pair.body for pair in self.pairs.values() if pair.kind == SLIDING and pair.body in candidates]
        return (sliding or candidates)[0]

    @lazy
    def is_redundant(self) -> bool:
        """Whether more pairs constrain some bodies than necessary, so that their reactions are not unique."""
        return any(dyad.is_redundant for dyad in self.dyads)

    @lazy
    def driver_name(self) -> str:
        """Name of the pair between the driven body and `driver_on`."""
        return next(name for name, pair in self.pairs.items() if {pair.on, pair.body} == {self.driver_on, self.output})

    @property
    def driver_pair(self) -> Pair:
        """The driving pair."""
        return self.pairs[self.driver_name]

    def line(self, pair: Pair) -> np.ndarray:
        """Direction of a sliding pair in the global frame.

        Returns
        -------
        ndarray (n,) or (1,) complex, dimensionless
            One value where the line is fixed in the frame.
        """
        if pair.on in self.bodies:
            return np.asarray(pair.axis * self.bodies[pair.on].unit)
        axis: Any = pair.axis
        return axis if isinstance(axis, np.ndarray) else np.array([axis])

    def slip(self, name: str) -> np.ndarray:
        """Rate of a pair's coordinate by the driver's coordinate, ∂s/∂q or ∂φ/∂q, defined in a dwell too.

        Parameters
        ----------
        name : str
            Name of the pair.

        Returns
        -------
        ndarray (n,) [m or rad, per m or rad of the driver]
            Of the slide along the line, or of the angle of `body` against `on`.
        """
        pair = self.pairs[name]
        body, on = self.by_driver[pair.body], self.by_driver.get(pair.on)
        if pair.kind == REVOLUTE:
            return np.asarray(body.turn[1] - (on.turn[1] if on else 0.0))
        speed = body.position(pair.point, 1)
        if on:  # relative to the coincident point of `on`
            speed = speed - on.origin[1] - 1j * on.turn[1] * (body.position(pair.point) - on.origin[0])
        return dot(self.line(pair), speed)

    @property
    def theta(self) -> np.ndarray:
        """Cam angles (n,) [rad]."""
        return self.motion.theta

    @property
    def count(self) -> int:
        """Number n of the cam angles."""
        return self.motion.count

    @property
    def follower(self) -> Pose:
        """Pose of the follower body."""
        return self.bodies[self.follower_body]
