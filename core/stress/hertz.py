"""Hertz's line contact of two cylinders, one of which may be hollow (Hertz 1881; Johnson, Contact Mechanics, ch. 4.2)."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from core.cam import OUTER, Flank
from core.frozen import frozen
from core.stress.pairing import Pairing

_GOLDEN = 0.5 * (1.0 + sqrt(5.0))
DEPTH = _GOLDEN**-0.5
"""Of the largest shear, in half widths of the contact: 0.786151. With z in half widths the principal shear below the middle is
p (z - z²/√(1 + z²)), largest where z⁴ + z² = 1."""
SHEAR = _GOLDEN**-2.5
"""The largest shear there, in parts of the pressure: 0.300283."""


@frozen(eq=False)
class ContactStress:
    """On one flank at n cam angles: pressure in the middle of the contact and the largest shear below it [Pa], the depth of that
    and half the width of the contact [m]; 0 where nothing presses, NaN where what touches does not fit the profile."""

    pressure: np.ndarray
    shear: np.ndarray
    depth: np.ndarray
    half_width: np.ndarray


def relative_curvature(flank: Flank) -> np.ndarray:
    """κ_rel (n,) [1/m] of a flank and what touches it, convex positive: 1/r + κ of the inner flank, 1/r - κ of the outer one,
    whose material lies on the other side; 1/ρ under a straight face.

    With the offset o of the profile κ = κ_p/(1 - o κ_p), so that nothing cancels: [1 - (o ∓ r) κ_p]/[r (1 - o κ_p)], which is
    1/[r (1 - r κ_p)] without play. At most 0 where what touches is undercut, infinite for an edge.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        if flank.straight:
            return np.asarray(1.0 / flank.profile_radius)
        side = -1.0 if flank.name == OUTER else 1.0
        bend, offset, radius = flank.pitch_curvature, flank.offset, flank.radius
        return np.asarray((1.0 - (offset - side * radius) * bend) / (radius * (1.0 - offset * bend)))


def pressure(force: np.ndarray, curvature: np.ndarray, pairing: Pairing) -> np.ndarray:
    """p = √(F E* κ_rel/(π b)) (n,) [Pa] of the force F (n,) [N] on a line of length b; 0 where F does not press, NaN where the
    relative curvature (n,) [1/m] is not positive: what touches does not fit there."""
    fits = np.where(curvature > 0.0, curvature, np.nan)
    return np.sqrt(np.maximum(force, 0.0) * pairing.modulus * fits / (pi * pairing.width))


def half_width(pressure: np.ndarray, curvature: np.ndarray, pairing: Pairing) -> np.ndarray:
    """a = 2p/(E* κ_rel) (n,) [m], which is √(4F/(π b E* κ_rel))."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(2.0 * pressure / (pairing.modulus * curvature))


def shear_depth(half_width: np.ndarray) -> np.ndarray:
    """Depth (n,) [m] of the largest shear."""
    return DEPTH * half_width


def contact_stresses(flank: Flank, force: np.ndarray, pairing: Pairing) -> ContactStress:
    """The stresses on a flank under the force (n,) [N] that presses on it."""
    curvature = relative_curvature(flank)
    pressed = pressure(force, curvature, pairing)
    half = half_width(pressed, curvature, pairing)
    return ContactStress(pressed, SHEAR * pressed, shear_depth(half), half)
