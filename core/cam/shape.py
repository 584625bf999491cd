"""The cam's shape as results: its flanks, and the relative motion that they follow from."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from core.frozen import frozen
from core.instant_centres import Centres
from core.mechanism.kinematics import Kinematics
from core.numerics.derivatives import BINOMIAL, Derivatives
from core.numerics.lazy import Lazy, once
from core.numerics.vectors import cross, dot

INNER, OUTER, SECOND = "inner", "outer", "second"


def _none(flank: Flank) -> np.ndarray:
    return np.zeros(0, dtype=complex)


@frozen(eq=False, kw_only=True)
class Flank:
    """One side of the cam that the follower touches, at n cam angles; each may be given as a function.

    straight  under a straight face; else under a roller, a shoe or an edge, which has a pitch curve: the path of its centre
    name      ``inner`` of the first cam, ``outer`` of a groove, ``second`` of the other cam of a conjugate pair
    body      body of the kinematics that the cam's force acts on
    reference          (n,) complex [m], the reference point R of what touches it, in the global frame
    relative_velocity  (n,) complex [m] by cam angle: its velocity t relative to the cam
    centre             instant centre Q of what touches it and the cam
    profile  (n,) complex [m] in the cam's own frame, which is the global frame at cam angle 0
    contact  (n,) complex [m], where they touch, in the global frame
    normal   (n,) complex unit vector in the global frame, from the follower into the cam
    pressure_angle     (n,) [rad], unsigned, 0 ... π/2
    profile_curvature  (n,) [1/m], positive where the cam is convex
    profile_velocity   (n,) complex [m] by cam angle: the profile's derivative, in the cam's own frame
    sliding  (n,) [m] by cam angle: speed of the follower's point that touches relative to the cam's, along i d n

    Under a round alone, else empty:
    radius           [m] of the round
    offset           [m] from the pitch curve to the profile along -i d t: radius and play; less than 0 of an outer flank
    pitch            (n,) complex [m] in the cam's own frame
    pitch_curvature  (n,) [1/m], positive where the cam is convex; ``pitch_curvature_slope`` (n,) its derivative by cam angle

    Under a straight face alone, else empty:
    support         (n,) [m] distance of the face from the cam centre, and ``support_angle`` (n,) complex unit vector of its
                    normal in the cam's own frame, from the cam to the face
    profile_radius  (n,) [m] radius of curvature, positive where the cam is convex: it goes through 0 at a cusp
    on_face         (n,) [m] where the contact lies on the face, along i m from the reference point
    """

    straight: bool = False
    name: str
    body: str
    reference: np.ndarray
    relative_velocity: Lazy[np.ndarray] = Lazy()
    centre: Lazy[Centres] = Lazy()
    profile: Lazy[np.ndarray] = Lazy()
    contact: Lazy[np.ndarray] = Lazy()
    normal: Lazy[np.ndarray] = Lazy()
    pressure_angle: Lazy[np.ndarray] = Lazy()
    profile_curvature: Lazy[np.ndarray] = Lazy()
    profile_velocity: Lazy[np.ndarray] = Lazy()
    sliding: Lazy[np.ndarray] = Lazy()
    radius: float = 0.0
    offset: float = 0.0
    pitch: Lazy[np.ndarray] = Lazy(_none)
    pitch_curvature: Lazy[np.ndarray] = Lazy(_none)
    pitch_curvature_slope: Lazy[np.ndarray] = Lazy(_none)
    support: Lazy[np.ndarray] = Lazy(_none)
    support_angle: Lazy[np.ndarray] = Lazy(_none)
    profile_radius: Lazy[np.ndarray] = Lazy(_none)
    on_face: Lazy[np.ndarray] = Lazy(_none)


class FaceOutline(NamedTuple):
    """How a face looks, in the frame of the follower's body: its closed outline (m,) [m], and ``held``, the place [m] from where
    the follower holds it."""

    points: np.ndarray
    held: complex


@frozen(eq=False)
class CamShape:
    """The cam at n cam angles: its flanks (one for an open cam), the first one first; of that the reference point R, its
    velocity t relative to the cam and the instant centre Q. sense: d = +1 where it turns counter-clockwise, -1 clockwise."""

    flanks: tuple[Flank, ...]
    sense: float

    @property
    def flank(self) -> Flank:
        """The first flank, the only one of an open cam."""
        return self.flanks[0]

    @property
    def reference(self) -> np.ndarray:
        """The reference point R on the first flank (n,) [m], in the global frame."""
        return self.flank.reference

    @property
    def relative_velocity(self) -> np.ndarray:
        """Velocity (n,) [m per rad] of the follower relative to the cam at the reference point of the first flank."""
        return self.flank.relative_velocity

    @property
    def centre(self) -> Centres:
        """The instant centre of follower and cam, on the first flank."""
        return self.flank.centre

    @property
    def extent(self) -> float:
        """Farthest that a reference point, or what it carries to the cam, comes from the cam centre [m]."""
        return max(float(np.abs(place).max()) for flank in self.flanks for place in (flank.reference, flank.contact))

    def only(self, name: str) -> CamShape:
        """The cam with one of its flanks as the first and only one."""
        return CamShape(tuple(flank for flank in self.flanks if flank.name == name), self.sense)


def relative_motion(kinematics: Kinematics, sense: float) -> Derivatives:
    """The pitch curve's derivatives, turned into the global frame: the reference point R, its velocity t = R' - idR relative
    to the cam, w = R'' - 2idR' - R and x = R''' - 3idR'' - 3R' + idR, by Leibniz of R e^{-idθ}."""
    r = kinematics.follower.origin

    def row(order: int) -> np.ndarray:
        terms = [c * (-1j * sense) ** (order - k) * r[k] for k, c in enumerate(BINOMIAL[order][:-1])]
        return np.asarray(sum(terms, r[order]))

    return Derivatives(row)


def turned_back(kinematics: Kinematics, sense: float) -> Callable[[], np.ndarray]:
    """e^{-idθ} (n,), made once: from the global frame into the cam's."""

    @once
    def back() -> np.ndarray:
        turned = kinematics.motion.angles.unit
        return turned.conj() if sense > 0.0 else turned

    return back


def sliding(
    kinematics: Kinematics, motion: Derivatives, contact: np.ndarray, normal: np.ndarray, sense: float
) -> np.ndarray:
    """Speed of the follower relative to the cam where they touch (n,) [m] by cam angle, along i d n: the velocity
    t + i(φ' - d)(C - R) of the follower's point there has no part along the normal."""
    turn = kinematics.follower.turn[1] - sense
    return sense * cross(normal, motion[1] + 1j * turn * (contact - motion[0]))


def curvature(motion: Derivatives, sense: float) -> np.ndarray:
    """κ_p = -d Im(t̄ w)/|t|³ (n,) [1/m], convex positive for both senses."""
    speed = np.abs(motion[1])
    return -sense * cross(motion[1], motion[2]) / (speed * speed * speed)


def curvature_slope(motion: Derivatives, sense: float) -> np.ndarray:
    """κ_p' (n,) [1/m per rad]."""
    t, w, x = (motion[order] for order in (1, 2, 3))
    square = dot(t, t)
    bend = cross(t, x) - 3.0 * cross(t, w) * dot(t, w) / square
    return -sense * bend / (square * np.sqrt(square))
