"""Flanks of a cam in space: contact with a cylindrical or conical roller, normal, curvature and sliding, for every kind.

The relative velocity of a point on the roller's axis against the cam is w, by cam angle. At the point where a normal of the roller meets
its axis the normal is perpendicular to w: n = cos τ e + sin τ a, with a the axis, e ⟂ a and n · w = 0. The contact is at r e from
the axis. Derivatives are in closed form.

Sources: Litvin and Fuentes, *Gear Geometry and Applied Theory*, equation of meshing n · v = 0; Gonzalez-Palacios and Angeles, *Cam
Synthesis*, indexing cams.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from core.frozen import frozen
from core.numerics.lazy import Lazy
from core.spatial.kinds import Machine, RollerAxis, roller_axis

AHEAD, BEHIND = "ahead", "behind"
SIDES = (AHEAD, BEHIND)
"""Flank in front of the roller as its motion grows, and flank behind it."""


def dots(v: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Scalar product of vectors.

    Parameters
    ----------
    v, w : ndarray (3, ...) [any unit]
        Vectors.

    Returns
    -------
    ndarray (...,) [product of both units]
    """
    return np.asarray(v[0] * w[0] + v[1] * w[1] + v[2] * w[2])


def crossed(v: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Vector product v × w.

    Parameters
    ----------
    v, w : ndarray (3, ...) [any unit]
        Vectors.

    Returns
    -------
    ndarray (3, ...) [product of both units]
    """
    return np.stack(
        (v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0])
    )  # three times as fast as np.cross


def turned(v: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Vectors rotated about the z axis, as from the global frame into that of the cam.

    Parameters
    ----------
    v : ndarray (3, ..., n) [any unit]
        Vectors.
    angle : ndarray (n,) [rad]
        Angle of rotation, counter-clockwise about +z.

    Returns
    -------
    ndarray (3, ..., n) [as v]
    """
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack((cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], v[2] + 0.0 * cos))


class MotionRows(NamedTuple):
    """Cam angles (n,) [rad], and the motion with two derivatives by them (n,) [m or rad]."""

    theta: np.ndarray
    y: np.ndarray
    y_1: np.ndarray
    y_2: np.ndarray

    def shifted(self, offset: np.ndarray | float) -> MotionRows:
        """Motion of another roller.

        Parameters
        ----------
        offset : ndarray (n,) [m or rad]
            Motion of that roller less this one.

        Returns
        -------
        MotionRows
        """
        return self._replace(y=self.y + offset)


@frozen(eq=False)
class SpatialFlank:
    """One flank under one roller at n cam angles and at distances u along the roller, which broadcast to (m, n).

    Vectors are in the global frame; derivatives by cam angle are those seen from the cam. ``turned(v, -sense θ)`` gives them in
    the cam's frame.

    Attributes
    ----------
    side : str
        ``ahead`` or ``behind``.
    sense : float
        Sense of rotation of the cam, +1 counter-clockwise about +z.
    theta : ndarray (n,) [rad]
        Cam angles.
    u : ndarray (m, n) [m]
        Distances along the roller's axis.
    radius : ndarray (m, n) [m]
        Radius of the flank about the axis there, with the play of a groove.
    axis : ndarray (3, m, n) [m]
        Points of the roller's axis.
    along : ndarray (3, m, n), dimensionless
        Direction of the axis.
    moving : ndarray (3, m, n) [1 or m]
        Derivative of the axis point by the motion.
    point : ndarray (3, m, n) [m]
        Points of contact.
    normal : ndarray (3, m, n), dimensionless
        Unit normals, from the roller into the cam.
    by_theta, by_u : ndarray (3, m, n) [m/rad], dimensionless
        Derivatives of the point by cam angle and by u.
    normal_by_theta, normal_by_u : ndarray (3, m, n) [1/rad], [1/m]
        Derivatives of the normal.
    pressure_angle : ndarray (m, n) [rad]
        Acute angle between the normal and the direction in which the roller moves.
    gain : ndarray (m, n) [1 or m]
        |∂p/∂y · n|: work of one newton of contact per unit of the motion.
    margin : ndarray (m, n), dimensionless
        (∂θ × ∂u) · n over that of the roller's axis: 1 for a thin roller, 0 where the flank has an edge, negative where undercut.
    stretch, turning : ndarray (m, n) [m/rad], [1/rad]
        Derivatives ∂p · T and ∂n · T by cam angle, with T the unit tangent across the line of contact.
    curvature : ndarray (m, n) [1/m]
        Normal curvature κ = -(∂n/∂T · T) across the line of contact, positive where the cam is convex.
    """

    side: str
    sense: float
    theta: np.ndarray
    u: np.ndarray
    radius: np.ndarray
    axis: np.ndarray
    along: np.ndarray
    moving: np.ndarray
    point: np.ndarray
    normal: np.ndarray
    by_theta: np.ndarray
    by_u: np.ndarray
    normal_by_theta: np.ndarray
    normal_by_u: np.ndarray
    thin_area: np.ndarray
    carrier_velocity: np.ndarray
    pressure_angle: Lazy[np.ndarray] = Lazy(lambda flank: _pressure_angle(flank))
    gain: Lazy[np.ndarray] = Lazy(lambda flank: np.abs(dots(flank.moving, flank.normal)))
    margin: Lazy[np.ndarray] = Lazy(
        lambda flank: dots(crossed(flank.by_theta, flank.by_u), flank.normal) / flank.thin_area
    )
    rates: Lazy[tuple[np.ndarray, np.ndarray]] = Lazy(lambda flank: _tangent_rates(flank))
    curvature: Lazy[np.ndarray] = Lazy(lambda flank: _curvature(flank))

    @property
    def stretch(self) -> np.ndarray:
        """∂p/∂θ · T (m, n) [m/rad]."""
        return self.rates[0]

    @property
    def turning(self) -> np.ndarray:
        """∂n/∂θ · T along T (m, n) [1/rad]."""
        return self.rates[1]

    def in_cam(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors in the frame of the cam.

        Parameters
        ----------
        vectors : ndarray (3, m, n) [any unit]
            Vectors of the flank in the global frame.

        Returns
        -------
        ndarray (3, m, n) [any unit]
        """
        return turned(vectors, -self.sense * self.theta)


@np.errstate(invalid="ignore", divide="ignore")
def flank(machine: Machine, motion: MotionRows, u: np.ndarray, sense: float, side: str) -> SpatialFlank:
    """Flank of a cam in space under one roller, with all derivatives in closed form: n = cos τ e + sin τ a, tan ψ = |n × v|/|n · v|.

    Parameters
    ----------
    machine : Machine
    motion : MotionRows
        Cam angles and the motion of this roller.
    u : ndarray (m, 1) or (m, n) [m]
        Distances along the roller's axis.
    sense : float
        Sense of rotation of the cam, ±1.
    side : str
        ``ahead`` or ``behind``.

    Returns
    -------
    SpatialFlank
        NaN where the roller has no line of contact.
    """
    line, y_1, y_2 = roller_axis(machine, motion.y), motion.y_1, motion.y_2
    u = np.atleast_2d(np.asarray(u, dtype=float))
    a, tan, cos, sin = line.a[:, None], *(float(f(machine.taper)) for f in (np.tan, np.cos, np.sin))
    radius = machine.roller_radius(u) + (machine.play if side == BEHIND else 0.0) + np.zeros_like(motion.y)
    # relative velocity w where the normal meets the axis, at u - r tan τ, with its derivatives
    foot = u - radius * tan
    q, q_y, q_yy = (_on_axis(c, d, foot) for c, d in ((line.c, line.a), (line.c_y, line.a_y), (line.c_yy, line.a_yy)))
    a_1 = (line.a_y * y_1)[:, None]
    w = q_y * y_1 - sense * _swept(q)
    w_1 = q_yy * y_1**2 + q_y * y_2 - sense * _swept(q_y * y_1)
    w_u = (a_1 - sense * _swept(a)) * (1.0 + tan * tan)
    e, e_1, e_u, thin = _direction(
        a, a_1, (w, w_1, w_u), tan, _ahead_sign(line, q, sense) * (1.0 if side == AHEAD else -1.0)
    )
    axis, moving = _on_axis(line.c, line.a, u), _on_axis(line.c_y, line.a_y, u)
    point, velocity = axis + radius * e, moving * y_1
    return SpatialFlank(
        side, sense, motion.theta, u + np.zeros_like(motion.y), radius, axis, np.broadcast_to(a, axis.shape), moving, point,
        normal=cos * e + sin * a,
        by_theta=velocity + radius * e_1 - sense * _swept(point),
        by_u=a - tan * e + radius * e_u,
        normal_by_theta=cos * e_1 + sin * a_1 - sense * _swept(cos * e + sin * a),
        normal_by_u=cos * e_u,
        thin_area=thin,
        carrier_velocity=velocity + crossed(line.turn[:, None], radius * e) * y_1 - sense * _swept(point),
    )  # fmt: skip


def _on_axis(c: np.ndarray, a: np.ndarray, u: np.ndarray) -> np.ndarray:
    """C + u a (3, m, n) [unit of c]."""
    return np.asarray(c[:, None] + u * a[:, None])


def _swept(v: np.ndarray) -> np.ndarray:
    """Vector product ẑ × v (3, ...)."""
    return np.stack((-v[1], v[0], np.zeros_like(v[2])))


def _ahead_sign(line: RollerAxis, q: np.ndarray, sense: float) -> np.ndarray:
    """Sign s (m, n) with which s (a × w) points in the direction of the growing motion; y′ has no part in it."""
    a, moving = line.a[:, None], np.broadcast_to(line.c_y[:, None], q.shape) + 0.0
    if line.a_y.any():
        moving = line.a_y[:, None] + 0.0 * q  # c_y = 0: the point moves along a_y, in proportion to its distance
    return np.where(dots(crossed(a, -sense * _swept(q)), moving) >= 0.0, 1.0, -1.0)


def _direction(
    a: np.ndarray, a_1: np.ndarray, velocities: tuple[np.ndarray, np.ndarray, np.ndarray], tan: float, sign: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Direction e ⟂ a of the contact from the axis, with e · w = -tan τ a · w, its derivatives by θ and u, and (w × a) · e.

    ``velocities``: w with its derivatives by θ and u.
    """
    w, w_1, w_u = velocities
    b = crossed(a, w)
    size = np.sqrt(dots(b, b))
    b = b / size
    if not tan:
        e = sign * b
        side = crossed(a, e)  # along -w across the axis
        share = 0.0
    else:
        across = crossed(b, a)  # unit vector of w across the axis
        share = -tan * dots(a, w) / size
        e = share * across + sign * np.sqrt(1.0 - share * share) * b
        side = crossed(a, e)
    w_side, w_a = dots(w, side), dots(w, a)
    # derivatives from e · e = 1, e · a = 0, e · w + tan τ a · w = 0
    turning = dots(e, a_1)
    e_1 = -turning * a + (turning * w_a - dots(e, w_1) - tan * (dots(a_1, w) + dots(a, w_1))) / w_side * side
    e_u = -(dots(e, w_u) + tan * dots(a, w_u)) / w_side * side
    return e, e_1, e_u, dots(crossed(w, a), e)


def _pressure_angle(flank: SpatialFlank) -> np.ndarray:
    across = crossed(flank.normal, flank.moving)
    return np.arctan2(np.sqrt(dots(across, across)), np.abs(dots(flank.normal, flank.moving)))


def _tangent_rates(flank: SpatialFlank) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives ∂p · T and ∂n · T by cam angle along the tangent T across the line of contact ∂u."""
    with np.errstate(invalid="ignore", divide="ignore"):
        across = crossed(flank.normal, flank.by_u)
        across = across / np.sqrt(dots(across, across))
        skew = dots(flank.by_theta, flank.by_u) / dots(flank.by_u, flank.by_u)
        turning = flank.normal_by_theta - skew * flank.normal_by_u
        return dots(flank.by_theta, across), dots(turning, across)


def _curvature(flank: SpatialFlank) -> np.ndarray:
    """κ = -(∂n/∂T · T), with T the unit tangent across the line of contact."""
    with np.errstate(divide="ignore", invalid="ignore"):  # infinite at an edge
        return np.asarray(-flank.turning / flank.stretch)


def sliding(flank: SpatialFlank, rolling: SpatialFlank) -> np.ndarray:
    """Speed at which the roller slides on the flank, by cam angle: rolling in the middle of the roller.

    Parameters
    ----------
    flank : SpatialFlank
    rolling : SpatialFlank
        The same flank in the middle of the roller (1, n).

    Returns
    -------
    ndarray (m, n) [m/rad]
    """
    return np.asarray(np.hypot(*sliding_parts(flank, rolling)))


def sliding_parts(flank: SpatialFlank, rolling: SpatialFlank) -> tuple[np.ndarray, np.ndarray]:
    """Parts of the sliding w_C + Ω r (a × e) of a roller whose middle rolls, by cam angle.

    Parameters
    ----------
    flank : SpatialFlank
    rolling : SpatialFlank
        The same flank in the middle of the roller (1, n).

    Returns
    -------
    along, around : ndarray (m, n) [m/rad]
        Along the line on the roller's surface towards its outer end, and around the roller.
    """
    around = _around(flank)
    spin = -dots(rolling.carrier_velocity, _around(rolling)) / rolling.radius
    return dots(flank.carrier_velocity, crossed(around, flank.normal)), dots(
        flank.carrier_velocity, around
    ) + spin * flank.radius


def _around(flank: SpatialFlank) -> np.ndarray:
    """Direction a × e (3, m, n), in which the surface of a turning roller moves."""
    return crossed(flank.along, (flank.point - flank.axis) / flank.radius)
