"""Position of a follower whose face touches a given line or arc of the turning cam, in closed form for every follower.

The driver's position is in the mechanism's frame, in mm or rad. The centre R of a round face is on the offset curve of the cam,
given at one of its points P by the normal N away from the cam and the curvature κ: F(R) = κ|R - P|²/2 + N·(R - P) = 0, a line
where κ = 0. Its gradient N + κ(R - P) is the normal at R. The solution is the one of two at which a growing motion leaves the cam.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.design import CamSlider, Oscillating, OscillatingFlat, Pushrod, Rocker, Translating
from core.design.parts import SIDES
from core.followers.cam_slider import LAYOUT_TABLE
from core.numerics.derivatives import Taylor, dot, heading, select


class Touching(NamedTuple):
    """Functions of the contact between a follower and its cam; points are complex [mm].

    Attributes
    ----------
    angle : callable
        Angle (n,) [rad] by which the cam is turned counter-clockwise when the follower is there; NaN where it never is. Arguments
        for a round face: points (n,) of its centre's path in the cam's frame; for a flat face: points of the cam and unit normals.
    position : callable
        Driver position (n,) [mm or rad]. Arguments for a round face: P, N, κ in the global frame; for a flat face: centre and
        radius of an arc.
    driver : callable
        Driver position (n,) [mm or rad]. Argument for a round face: its centre (n,) in the global frame; for a flat face: unit
        normal and a point.
    leaving : callable
        Direction (n,) in which the centre (n,) of a round face moves while the motion grows outwards.
    outward : float
        Sign of the driver's velocity while the face leaves the cam.
    lever_mm : float
        Displacement of the face per radian of a rotating driver; 1 for a sliding one.
    rotates : bool
        The driver rotates, so that its position is defined up to whole turns.
    """

    angle: Callable[..., np.ndarray]
    position: Callable[..., Taylor]
    driver: Callable[..., np.ndarray]
    leaving: Callable[[np.ndarray], np.ndarray]
    outward: float = 1.0
    lever_mm: float = 1.0
    rotates: bool = False


def touching(follower: Any) -> Touching:
    """Contact functions of a follower."""
    row: Touching = (FLAT if follower.face.straight else ROUND)[type(follower)](follower)
    return row


# -- translating followers --------------------------------------------------------------------------------------


def _sliding(follower: Translating | Pushrod) -> Touching:
    e, offset = heading(math.radians(follower.direction_deg)), follower.offset_mm

    def angle(p: np.ndarray) -> np.ndarray:
        with np.errstate(invalid="ignore"):
            return np.asarray(np.angle(e) + np.arcsin(offset / np.abs(p)) - np.angle(p))

    def position(p: Taylor, n: Taylor, curvature: float) -> Taylor:
        along, across = p * e.conjugate(), n * e.conjugate()
        # with t from the projection of P on the line: κt²/2 + bt + c = 0
        distance = -along.imag + offset
        b = across.real
        c = distance * distance * (0.5 * curvature) + across.imag * distance
        root = (b * b - c * (2.0 * curvature)).sqrt()
        t = _root(b, c, root, curvature)
        return along.real + t

    return Touching(
        angle,
        position,
        lambda r: dot(np.asarray(r), np.asarray(e)),
        lambda r: np.full(np.shape(r), e),
    )


def _root(b: Taylor, c: Taylor, root: Taylor, curvature: float) -> Taylor:
    """Root t of κt²/2 + bt + c = 0 with κt + b = root > 0, without cancellation."""
    with np.errstate(divide="ignore", invalid="ignore"):
        stable = (c * -2.0) / (b + root)
        if curvature == 0.0:
            return stable
        return select(b.c[0].real >= 0.0, stable, (root - b) * (1.0 / curvature))


def _flat_sliding(follower: Translating | Pushrod) -> Touching:
    """S = (H - ε sin η)/cos η with the support function H of the cam along the face's normal."""
    face: Any = follower.face
    tilt = math.radians(face.face_tilt_deg)
    m = heading(math.radians(follower.direction_deg + face.face_tilt_deg))

    def driver(support: Any) -> Any:
        return (support - follower.offset_mm * math.sin(tilt)) * (1.0 / math.cos(tilt))

    return Touching(
        lambda p, n: np.asarray(np.angle(m) - np.angle(n)),
        lambda centre, radius: driver((centre * m.conjugate()).real + radius),
        lambda n, p: driver(dot(np.asarray(m), p)),
        lambda r: np.full(np.shape(r), m),
    )


# -- oscillating followers --------------------------------------------------------------------------------------


class _Arm(NamedTuple):
    """Arm length and pivot [mm]; side: +1 where the round face is left of the ray from the pivot to the cam centre, else -1."""

    arm: float
    pivot: complex
    side: float

    @property
    def to_centre(self) -> float:
        return math.atan2(-self.pivot.imag, -self.pivot.real)

    def angle(self, p: np.ndarray) -> np.ndarray:
        r, distance = np.abs(p), abs(self.pivot)
        cosine = (r * r + (distance - self.arm) * (distance + self.arm)) / (2.0 * r * distance)
        with np.errstate(invalid="ignore"):
            return np.asarray(
                math.atan2(self.pivot.imag, self.pivot.real) - self.side * np.arccos(cosine) - np.angle(p)
            )

    def position(self, p: Taylor, n: Taylor, curvature: float) -> Taylor:
        """Angle α - θz: with G = N - κD, D = P - pivot, F = 0 is arm G·e^{iα} = N·D - κ(D² + arm²)/2."""
        d = p - self.pivot
        g = n - d * curvature
        square = (d * d.conj()).real
        length = (g * g.conj()).real.sqrt()
        cosine = ((n * d.conj()).real - (square + self.arm**2) * (0.5 * curvature)) / (length * self.arm)
        return (g * np.exp(-1j * self.to_centre)).argument() - cosine.arccos() * self.side

    def driver(self, r: np.ndarray) -> np.ndarray:
        return np.asarray(np.angle((r - self.pivot) * np.exp(-1j * self.to_centre)))

    def leaving(self, r: np.ndarray) -> np.ndarray:
        return np.asarray(1j * self.side * (r - self.pivot) / np.abs(r - self.pivot))

    def moving(self, output: Callable[[Taylor], Taylor], output_arm: float) -> Touching:
        """Follower whose position is a function of the arm's angle; ``output_arm``: length of the rocker's other arm [mm]."""
        return Touching(
            self.angle,
            lambda p, n, curvature: output(self.position(p, n, curvature)),
            lambda r: output(_constant(self.driver(r))).c[0],
            self.leaving,
            lever_mm=min(1.0, self.arm / output_arm),
        )


def _constant(angle: np.ndarray) -> Taylor:
    return Taylor(np.array([angle, np.zeros_like(angle), np.zeros_like(angle)]))


def _turned(vector: complex, angle: Taylor) -> Taylor:
    """Series of a vector turned by an angle α, v e^{iα}."""
    u = angle.c
    turn = np.exp(1j * u[0]) * vector
    return Taylor(np.array([turn, 1j * turn * u[1], 1j * turn * (u[2] + 0.5j * u[1] ** 2)]))


def _swinging(follower: Oscillating) -> Touching:
    side = SIDES[follower.side]
    arm = _Arm(follower.arm_mm, complex(follower.pivot_x_mm, follower.pivot_y_mm), side)
    return Touching(arm.angle, arm.position, arm.driver, arm.leaving, side, arm.arm, rotates=True)


def _slider(follower: CamSlider) -> Touching:
    """L = L1 cos φ + √(L2² - (H - L1 sin φ)²), φ = α - γ - δ, the root with the sign of the layout."""
    layout = LAYOUT_TABLE[follower.layout]
    roller_side = -1.0 if layout.cam_left == layout.roller_above else 1.0
    arm = _Arm(follower.roller_arm_mm, complex(follower.pivot_x_mm, follower.pivot_y_mm), roller_side)
    to_arm = np.exp(1j * (arm.to_centre - math.radians(follower.fixed_angle_deg + follower.guide_angle_deg)))
    side = 1.0 if layout.slider_right else -1.0

    def position(alpha: Taylor) -> Taylor:
        pin = _turned(to_arm, alpha) * follower.slider_arm_mm
        height = -pin.imag + follower.guide_height_mm
        with np.errstate(invalid="ignore"):
            return pin.real + (height * height * -1.0 + follower.rod_mm**2).sqrt() * side

    return arm.moving(position, follower.slider_arm_mm)


def _rocker(follower: Rocker) -> Touching:
    """Distance of the pad's centre from the pivot along the valve, p cos β, β = α + γ - ν."""
    arm = _Arm(follower.arm_mm, complex(follower.pivot_x_mm, follower.pivot_y_mm), SIDES[follower.side])
    to_pad = np.exp(1j * (arm.to_centre + math.radians(follower.pad_angle_deg - follower.valve_direction_deg)))

    def position(alpha: Taylor) -> Taylor:
        return _turned(to_pad, alpha).real * follower.pad_mm

    return arm.moving(position, follower.pad_mm)


def _flat_swinging(follower: OscillatingFlat) -> Touching:
    """Face (x - pivot)·m = f on an arc of centre C, radius ρ: D·m = f - ρ, D = C - pivot."""
    side = SIDES[follower.side]
    face: Any = follower.face
    pivot, offset = complex(follower.pivot_x_mm, follower.pivot_y_mm), face.face_offset_mm
    to_centre, distance = math.atan2(-pivot.imag, -pivot.real), abs(pivot)

    def angle(p: np.ndarray, n: np.ndarray) -> np.ndarray:
        with np.errstate(invalid="ignore"):
            return np.asarray(to_centre + side * np.arccos((offset - dot(n, p)) / distance) - np.angle(n))

    def position(centre: Taylor, radius: float) -> Taylor:
        d = centre - pivot
        cosine = (
            Taylor(np.array([np.full(d.c.shape[1], offset - radius), *np.zeros((2, d.c.shape[1]))]))
            / (d * d.conj()).real.sqrt()
        )
        return (d * np.exp(-1j * to_centre)).argument() + cosine.arccos() * side

    def driver(n: np.ndarray, p: np.ndarray) -> np.ndarray:
        return np.asarray(np.angle(n * np.exp(-1j * to_centre)))

    return Touching(
        angle,
        position,
        driver,
        lambda r: 1j * side * (r - pivot) / np.abs(r - pivot),
        side,
        distance,
        rotates=True,
    )


ROUND: Mapping[type, Callable[[Any], Touching]] = MappingProxyType(
    {Translating: _sliding, Oscillating: _swinging, CamSlider: _slider, Rocker: _rocker, Pushrod: _sliding}
)
FLAT: Mapping[type, Callable[[Any], Touching]] = MappingProxyType(
    {Translating: _flat_sliding, OscillatingFlat: _flat_swinging, Pushrod: _flat_sliding}
)


__all__ = ["Touching", "touching"]
