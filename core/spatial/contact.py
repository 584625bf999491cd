"""Flanks of a cam in space: contact with a cylindrical or conical roller, normal, curvature and sliding, for every kind.

A frame moves with the roller: a along its axis, t in the direction of its motion, s = a × t. Against the cam the frame has the
velocity V of its origin on the axis and the angular velocity Ω, by cam angle. A point of the axis at u has the velocity w = V + Ω × u a.
The contact is at r e from the axis, e = t cos β + s sin β, with the normal n = cos τ e + sin τ a. It meets the axis at u - r tan τ,
where n · w = 0. All derivatives are in closed form.

Sources: Litvin and Fuentes, *Gear Geometry and Applied Theory*, equation of meshing n · v = 0; Gonzalez-Palacios and Angeles, *Cam
Synthesis*, indexing cams.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from core.frozen import frozen
from core.numerics.lazy import lazy
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
    return np.stack((v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]))


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


class RelativeMotion(NamedTuple):
    """Motion of the roller's frame against the cam, by cam angle, as components along a, t and s.

    Attributes
    ----------
    velocity, velocity_1 : ndarray (3, n) [m/rad]
        Velocity V of the frame's origin, and the derivative of its components.
    turning, turning_1 : ndarray (3, n), dimensionless
        Angular velocity Ω, and the derivative of its components.
    """

    velocity: np.ndarray
    velocity_1: np.ndarray
    turning: np.ndarray
    turning_1: np.ndarray


def relative_motion(line: RollerAxis, motion: MotionRows, sense: float) -> RelativeMotion:
    """Motion of the roller's frame against the cam: V = c' - d ẑ × c, Ω = y' σ - d ẑ, with the carrier's turn σ.

    Parameters
    ----------
    line : RollerAxis
    motion : MotionRows
    sense : float
        Sense of rotation d, ±1.

    Returns
    -------
    RelativeMotion
    """
    y_1, y_2 = motion.y_1, motion.y_2
    s = crossed(line.a, line.t)
    swept, swept_1 = (np.stack((-v[1], v[0], np.zeros_like(v[2]))) for v in (line.c, line.c_y * y_1))
    velocity, velocity_1 = line.c_y * y_1 - sense * swept, line.c_yy * y_1**2 + line.c_y * y_2 - sense * swept_1
    turning = line.turn * y_1 - sense * np.array([[0.0], [0.0], [1.0]])
    basis = (line.a, line.t, s)
    basis_1 = [crossed(line.turn * y_1, b) for b in basis]

    def components(vector: np.ndarray, vector_1: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        rates = (dots(vector_1, b) + dots(vector, b_1) for b, b_1 in zip(basis, basis_1, strict=True))
        return np.stack([dots(vector, b) for b in basis]), np.stack(list(rates))

    return RelativeMotion(*components(velocity, velocity_1), *components(turning, line.turn * y_2))


@frozen(eq=False)
class SpatialFlank:
    """One flank under one roller at n cam angles and at distances u along the roller, which broadcast to (m, n).

    Vectors are in the global frame; ``in_cam`` gives them in the frame of the cam. Tangents of the roller at the contact are
    g along its surface outwards and f around it; the line of contact has the direction g + h f.

    Attributes
    ----------
    side : str
        ``ahead`` or ``behind``.
    sense, taper : float
        Sense of rotation of the cam, +1 counter-clockwise about +z; half angle of the roller's cone [rad].
    theta : ndarray (n,) [rad]
        Cam angles.
    line, relative : axis of the roller, and its motion against the cam
    u, radius : ndarray (m, n) or (m, 1) [m]
        Distances along the roller's axis, and radius of the flank about it, with the play of a groove.
    e_t, e_s : ndarray (m, n), dimensionless
        Components of the direction e from the axis to the contact.
    w_f : ndarray (m, n) [m/rad]
        Velocity w · f where the normal meets the axis.
    beta_1, beta_u : ndarray (m, n) [dimensionless], [1/m]
        Derivatives of the angle β of the contact around the roller, by cam angle and by u.
    """

    side: str
    sense: float
    taper: float
    theta: np.ndarray
    line: RollerAxis
    relative: RelativeMotion
    u: np.ndarray
    radius: np.ndarray
    e_t: np.ndarray
    e_s: np.ndarray
    w_f: np.ndarray
    beta_1: np.ndarray
    beta_u: np.ndarray

    # -- scalars ------------------------------------------------------------------------------------------

    @lazy
    def pressure_angle(self) -> np.ndarray:
        """Acute angle ψ (m, n) [rad] between the normal and the direction of the motion, tan ψ = |n × v|/|n · v|."""
        if not self.taper:
            return np.arctan2(np.abs(self.e_s), np.abs(self.e_t))
        cos, sin = np.cos(self.taper), np.sin(self.taper)
        return np.arctan2(np.sqrt(sin * sin + (cos * self.e_s) ** 2), np.abs(cos * self.e_t))

    @lazy
    def gain(self) -> np.ndarray:
        """|∂p/∂y · n| (m, n) [1 or m]: work of one newton of contact per unit of the motion."""
        return np.abs(np.cos(self.taper) * self.e_t * (self.line.reach + self.u * self.line.reach_u))

    @lazy
    def slip(self) -> tuple[np.ndarray, np.ndarray]:
        """Velocity of the contact against the cam, of a roller that does not turn, along g and f (m, n) [m/rad]."""
        (v_a, v_t, v_s), (o_a, o_t, o_s) = self.relative.velocity, self.relative.turning
        e_t, e_s, u, r = self.e_t, self.e_s, self.u, self.radius
        turn_f = e_t * o_s - e_s * o_t
        around = e_t * (v_s - u * o_t) - e_s * (v_t + u * o_s) + r * o_a
        if not self.taper:
            return v_a - r * turn_f, around
        cos, sin = np.cos(self.taper), np.sin(self.taper)
        return cos * v_a - sin * (e_t * v_t + e_s * v_s) - (u * sin + r * cos) * turn_f, around

    @lazy
    def rates(self) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives ∂p/∂θ · T [m/rad] and ∂n/∂θ · T [1/rad] (m, n) along T, the unit tangent across the line of contact."""
        o_a, o_t, o_s = self.relative.turning
        cos, sin = float(np.cos(self.taper)), float(np.sin(self.taper))
        along, around = self.slip
        around = around + self.radius * self.beta_1
        h, size = self.skew
        turn_f = self.e_t * o_s - self.e_s * o_t
        turn_g = cos * o_a - sin * (self.e_t * o_t + self.e_s * o_s) if sin else o_a
        share = cos * (along + h * around) / (size * size)
        turning = cos * self.beta_1 + turn_g + h * turn_f - share * cos * self.beta_u
        return (around - h * along) / size, turning / size

    @lazy
    def skew(self) -> tuple[np.ndarray, np.ndarray]:
        """Slope h = r cos τ ∂β/∂u of the line of contact around the roller, and √(1 + h²) (m, n)."""
        h = self.radius * np.cos(self.taper) * self.beta_u
        return h, np.sqrt(1.0 + h * h)

    @property
    def stretch(self) -> np.ndarray:
        """∂p/∂θ · T (m, n) [m/rad]."""
        return self.rates[0]

    @property
    def turning(self) -> np.ndarray:
        """∂n/∂θ · T (m, n) [1/rad]."""
        return self.rates[1]

    @lazy
    def curvature(self) -> np.ndarray:
        """Normal curvature κ = -(∂n/∂T · T) across the line of contact (m, n) [1/m], positive where the cam is convex."""
        with np.errstate(divide="ignore", invalid="ignore"):  # infinite at an edge
            return np.asarray(-self.turning / self.stretch)

    @lazy
    def margin(self) -> np.ndarray:
        """Area |∂θ × ∂u| over that of a thin roller (m, n): 0 where the flank has an edge, negative where it is undercut."""
        return np.asarray(self.stretch * self.skew[1] / (np.cos(self.taper) * self.w_f))

    # -- vectors ------------------------------------------------------------------------------------------

    def vector(self, along_a: np.ndarray, along_t: np.ndarray, along_s: np.ndarray) -> np.ndarray:
        """Vector of these components.

        Parameters
        ----------
        along_a, along_t, along_s : ndarray (m, n) [any unit]
            Components in the roller's frame.

        Returns
        -------
        ndarray (3, m, n) [any unit]
        """
        a, t = self.line.a[:, None], self.line.t[:, None]
        return np.asarray(along_a * a + along_t * t + along_s * crossed(a, t))

    @lazy
    def axis(self) -> np.ndarray:
        """Points of the roller's axis (3, m, n) [m]."""
        return np.asarray(self.line.c[:, None] + self.u * self.line.a[:, None])

    @lazy
    def point(self) -> np.ndarray:
        """Points of contact (3, m, n) [m]."""
        return self.line.c[:, None] + self.vector(self.u, self.radius * self.e_t, self.radius * self.e_s)

    @lazy
    def normal(self) -> np.ndarray:
        """Unit normals (3, m, n) from the roller into the cam."""
        cos, sin = np.cos(self.taper), np.sin(self.taper)
        return self.vector(sin + 0.0 * self.e_t, cos * self.e_t, cos * self.e_s)

    @lazy
    def moving(self) -> np.ndarray:
        """Derivative of the axis point by the motion (3, m, n) [1 or m]."""
        return np.asarray((self.line.reach + self.u * self.line.reach_u) * self.line.t[:, None] + 0.0 * self.e_t)

    def _tangent(self, along_g: np.ndarray, along_f: np.ndarray) -> np.ndarray:
        cos, sin = np.cos(self.taper), np.sin(self.taper)
        e_part = -sin * along_g
        return self.vector(
            cos * along_g, e_part * self.e_t - along_f * self.e_s, e_part * self.e_s + along_f * self.e_t
        )

    @lazy
    def by_theta(self) -> np.ndarray:
        """Derivative of the point by cam angle, as seen from the cam (3, m, n) [m/rad]."""
        along, around = self.slip
        return self._tangent(along, around + self.radius * self.beta_1)

    @lazy
    def by_u(self) -> np.ndarray:
        """Derivative of the point by u (3, m, n)."""
        return self._tangent(1.0 / np.cos(self.taper) + 0.0 * self.e_t, self.radius * self.beta_u)

    @lazy
    def normal_by_theta(self) -> np.ndarray:
        """Derivative of the normal by cam angle, as seen from the cam (3, m, n) [1/rad]."""
        (o_a, o_t, o_s), cos, sin = self.relative.turning, np.cos(self.taper), np.sin(self.taper)
        turn_f = self.e_t * o_s - self.e_s * o_t
        turn_g = cos * o_a - sin * (self.e_t * o_t + self.e_s * o_s)
        return self._tangent(-turn_f, cos * self.beta_1 + turn_g)

    @lazy
    def normal_by_u(self) -> np.ndarray:
        """Derivative of the normal by u (3, m, n) [1/m]."""
        return self._tangent(0.0 * self.e_t, np.cos(self.taper) * self.beta_u)

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

    @lazy
    def cam_point(self) -> np.ndarray:
        """Points of contact in the frame of the cam (3, m, n) [m]."""
        c, a, t, s = (turned(v, -self.sense * self.theta) for v in (*self.line[:3], crossed(*self.line[1:3])))
        across_t, across_s = self.radius * self.e_t, self.radius * self.e_s
        return np.stack([c[i] + self.u * a[i] + across_t * t[i] + across_s * s[i] for i in range(3)])


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
    line = roller_axis(machine, motion.y)
    relative, tan = relative_motion(line, motion, sense), float(np.tan(machine.taper))
    u = np.atleast_2d(np.asarray(u, dtype=float))
    radius = machine.roller_radius(u) + (machine.play if side == BEHIND else 0.0)
    foot = u - radius * tan
    (v_a, v_t, v_s), (_, o_t, o_s) = relative.velocity, relative.turning
    (a_1, t_1, s_1), (_, o_t_1, o_s_1) = relative.velocity_1, relative.turning_1
    w_t, w_s = v_t + foot * o_s, v_s - foot * o_t
    # across w, towards +t on the flank ahead
    way = np.where(w_s >= 0.0, 1.0, -1.0) * (1.0 if side == AHEAD else -1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = way / np.sqrt(w_t * w_t + w_s * w_s)
        e_t, e_s = w_s * scale, -w_t * scale
        if tan:
            share = -tan * v_a * np.abs(scale)  # e · w/|w|
            rest = np.sqrt(1.0 - share * share)
            e_t, e_s = rest * e_t - way * share * e_s, rest * e_s + way * share * e_t
        w_f = e_t * w_s - e_s * w_t
    w_f = np.where(w_f == 0.0, np.nan, w_f)  # no line of contact
    rate = e_t * (t_1 + foot * o_s_1) + e_s * (s_1 - foot * o_t_1) + tan * a_1
    beta_1 = -rate / w_f
    beta_u = -(1.0 + tan * tan) * (e_t * o_s - e_s * o_t) / w_f
    return SpatialFlank(
        side, sense, machine.taper, motion.theta, line, relative, u, np.asarray(radius), e_t, e_s, w_f, beta_1, beta_u
    )


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
        Along the roller's surface towards its outer end, and around it.
    """
    along, around = flank.slip
    return along, around - rolling.slip[1] / rolling.radius * flank.radius


# -- proofs -----------------------------------------------------------------------------------------------------


def meshing(flank: SpatialFlank) -> np.ndarray:
    """Residual of the equation of meshing, |n · w|/|w| where the normal meets the roller's axis.

    Parameters
    ----------
    flank : SpatialFlank

    Returns
    -------
    ndarray (m, n), dimensionless
    """
    foot = (flank.u - flank.radius * np.tan(flank.taper)) * flank.line.a[:, None]
    velocity, turning = (
        flank.vector(*(row[None] for row in rows)) for rows in (flank.relative.velocity, flank.relative.turning)
    )
    w = velocity + crossed(turning, foot)
    return np.abs(dots(flank.normal, w)) / np.sqrt(dots(w, w))


def intrusion(machine: Machine, flank: SpatialFlank, step: int) -> np.ndarray:
    """Depth of points of a flank inside of the roller at all other cam angles, relative to its radius; 0 outside.

    Parameters
    ----------
    machine : Machine
    flank : SpatialFlank
        At one distance u along the roller (1, n).
    step : int
        Every how many cam angles a point is compared.

    Returns
    -------
    ndarray (k,), dimensionless
        Greatest depth of each of the k points.
    """
    points = flank.cam_point[:, 0, ::step]
    c, a = (turned(v, -flank.sense * flank.theta) for v in flank.line[:2])
    away = points[:, :, None] - c[:, None]
    along = dots(away, a[:, None])
    radius = machine.roller_radius(along) + (machine.play if flank.side == BEHIND else 0.0)
    across = away - along * a[:, None]
    depth = radius - np.sqrt(dots(across, across))
    inside = (along >= machine.inner) & (along <= machine.outer)
    return np.asarray(np.where(inside, depth, 0.0).max(axis=1).clip(0.0) / machine.radius)
