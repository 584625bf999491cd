"""The result shape of every linkage: bodies with their poses, the pairs that join them, how forces walk through.

Drawing, cam shape, instant centres and forces read the Kinematics and nothing else of a follower.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from core.frozen import frozen
from core.motion import MotionState
from core.numerics.derivatives import Derivatives, body_vector, constant, dot, scaled, sum_of, unit
from core.numerics.lazy import Lazy

FRAME, CAM = "frame", "cam"
REVOLUTE, SLIDING = "revolute", "sliding"
_NOTHING: Mapping[str, complex] = MappingProxyType({})


@frozen(eq=False)
class Pose:
    """Where a body is: its origin and its angle with three derivatives by cam angle, each made when it is first read.

    origin  complex, in the global frame [m]
    turn    [rad], counter-clockwise from global +x
    points  the body's own points, fixed in its frame [m], for drawing and for pairs
    unit    (n,) complex, the body's x axis: e^{i angle}, where it is known without the angle
    spin    the same with its derivatives, of which every point that the body carries is a multiple
    """

    origin: Derivatives
    turn: Derivatives
    points: Mapping[str, complex] = field(default_factory=lambda: _NOTHING)
    unit: Lazy[np.ndarray] = Lazy(lambda pose: unit(pose.turn[0]))
    spin: Lazy[Derivatives] = Lazy(lambda pose: body_vector(pose.unit, pose.turn))

    @classmethod
    def of(cls, z: np.ndarray, angle: np.ndarray, points: Mapping[str, complex] = _NOTHING) -> Pose:
        """From all derivatives (4, n)."""
        return cls(Derivatives.of(z), Derivatives.of(angle), points)

    def turning_as(self, turn: Derivatives) -> Pose:
        """The same body with its angle whole turns apart."""
        return Pose(self.origin, turn, self.points, lambda: self.unit, lambda: self.spin)

    @property
    def z(self) -> np.ndarray:
        """Origin (4, n) complex [m] with its derivatives by cam angle [m per rad^k]."""
        return self.origin.all

    @property
    def angle(self) -> np.ndarray:
        """Angle (4, n) [rad] with its derivatives by cam angle."""
        return self.turn.all

    @property
    def x(self) -> np.ndarray:
        """x of the origin (n,) [m] with its derivatives."""
        return self.z.real

    @property
    def y(self) -> np.ndarray:
        """y of the origin (n,) [m] with its derivatives."""
        return self.z.imag

    def carried(self, local: complex) -> Derivatives:
        """A body-fixed point in the global frame; kept, since masses, pairs and springs ask for the same few."""
        if not local:
            return self.origin
        found = self._carried.get(local)
        if found is None:
            found = sum_of(self.origin, scaled(self.spin, local))
            if not found.constant:  # the frame, which all designs share, would keep the points of all of them
                self._carried[local] = found
        return found

    @cached_property
    def _carried(self) -> dict[complex, Derivatives]:
        return {}

    def point(self, name: str) -> np.ndarray:
        """A named point in the global frame with three derivatives (4, n)."""
        return self.carried(self.points[name]).all

    def place(self, name: str, order: int = 0) -> np.ndarray:
        """A named point in the global frame, or one derivative (n,)."""
        return self.carried(self.points[name])[order]


FRAME_POSE = Pose(constant(0j), constant(0.0), unit=np.ones(1, dtype=complex))
"""Of the frame, which is the global one."""


@frozen
class Pair:
    """Two bodies joined.

    kind       ``revolute`` or ``sliding``
    on, body   ``body`` turns or slides on ``on``
    point      named point of ``body`` in the pair
    axis       of a sliding pair: unit vector of the line in the frame of ``on``, else 0
    friction   True where the loads' guide friction acts
    """

    kind: str
    on: str
    body: str
    point: str
    axis: complex = 0j


@frozen
class Dyad:
    """Two bodies that are solved together, known from outside in.

    kind    order of its pairs from the driving body outwards: ``RRP`` = rod and slider
    bodies  in the same order
    pairs   names of its three pairs in the same order
    on, ratio  of a body that is driven too: the body against which it is, and its turn or slide there for one of the driver
    by_motion  it follows a motion of its own, and what drives it asks nothing of the driver
    driven  the one of the pairs that drives, where it is between two bodies that move
    """

    kind: str
    bodies: tuple[str, ...]
    pairs: tuple[str, ...]
    on: str = ""
    ratio: float = 0.0
    by_motion: bool = False
    driven: str = ""

    @property
    def redundant(self) -> bool:
        """Whether its bodies are held by more pairs than need be."""
        return 2 * len(self.pairs) + bool(self.driven) > 3 * len(self.bodies)


@frozen(eq=False)
class Kinematics:
    """A solved mechanism at n cam angles. What not everyone needs may be given as a function that makes it.

    bodies         name -> Pose
    pairs          name -> Pair; the body moved by the cam stands on the frame in ``ground``
    dyads          outermost first: forces are found in this order
    output         body that the driver leads, against ``driver_on``; follower_body: body the cam acts on, its origin the face's
                   reference point; ``ground``: pair that holds the follower body on the frame, empty where none does;
                   ``carrier``: body of that pair or the roller's link, where the follower body is the roller alone
    by_driver      name -> Pose with derivatives by the driver's coordinate: what goes where, in a dwell too
    travel         (n,) complex unit vector: where the reference point goes when the follower moves forward
    sense          of the driver's coordinate: q = start + sense y
    singular       what must not vanish, by the code of its finding: (n,) 0 ... 1
    transmission   joint of a dyad -> transmission angle (n,) [rad], 0 ... π/2
    coordinates    the follower's own variables and their derivatives, named as in tables (phi, beta, slider_position)
    base           the base position: name -> (value in SI, unit)
    residual       (n,) loop closure relative to the size of the mechanism; ``condition`` (n,) bounds it times eps
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
    sense: float = 1.0
    driver_on: str = FRAME

    def body_of(self, point: str) -> str:
        """The body that a point is read from: the first that has it, but for one that slides, which keeps to its line."""
        having = [name for name, body in self.bodies.items() if point in body.points]
        sliding = [pair.body for pair in self.pairs.values() if pair.kind == SLIDING and pair.body in having]
        return (sliding or having)[0]

    @cached_property
    def driver_name(self) -> str:
        """The pair that holds the driven body on the frame, or on the body against which it is driven."""
        return next(name for name, pair in self.pairs.items() if {pair.on, pair.body} == {self.driver_on, self.output})

    @property
    def driver_pair(self) -> Pair:
        """The pair that drives."""
        return self.pairs[self.driver_name]

    def line(self, pair: Pair) -> np.ndarray:
        """The direction of a sliding pair (n,), or (1,) where it stands on the frame."""
        if pair.on in self.bodies:
            return np.asarray(pair.axis * self.bodies[pair.on].unit)
        axis: Any = pair.axis
        return axis if isinstance(axis, np.ndarray) else np.array([axis])

    def slip(self, name: str) -> np.ndarray:
        """How fast a pair moves with the driver's coordinate q (n,), in a dwell too: ∂slide/∂q along its line, or the turn
        of ``body`` against ``on``."""
        pair = self.pairs[name]
        body, on = self.by_driver[pair.body], self.by_driver.get(pair.on)
        if pair.kind == REVOLUTE:
            return np.asarray(body.turn[1] - (on.turn[1] if on else 0.0))
        speed = body.place(pair.point, 1)
        if on:  # against the place of ``on`` that it stands on
            speed = speed - on.origin[1] - 1j * on.turn[1] * (body.place(pair.point) - on.origin[0])
        return dot(self.line(pair), speed)

    @property
    def theta(self) -> np.ndarray:
        """Cam angles (n,) [rad]."""
        return self.motion.theta

    @property
    def follower(self) -> Pose:
        """Pose of the body that the cam moves."""
        return self.bodies[self.follower_body]
