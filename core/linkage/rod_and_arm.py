"""Arm and rod between a pivot and a slider: their angles and three derivatives (Shin1995 §2.3)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from math import pi

import numpy as np

from core.design import SI
from core.keeping import WhenAsked
from core.linkage.base import BasePosition
from core.linkage.dead_centres import dead_centres
from core.vectors import BLOCK


@dataclass(frozen=True, eq=False)
class RodAndArm:
    """slider L (n,) [m]; phi, beta (4, n) [rad], in the guide's frame, made when they are asked for; phi_rates,
    beta_rates (4, n), whose first row is not theirs, the derivatives alone; arm e^{iφ} and rod e^{iβ} (n,); area K (n,) =
    4 x area of the triangle pivot, arm pin, slider pin, NaN where it does not close; square r² (n,) of the distance
    pivot - slider pin."""

    slider: np.ndarray
    phi: WhenAsked[np.ndarray] = WhenAsked()
    beta: WhenAsked[np.ndarray] = WhenAsked()
    phi_rates: WhenAsked[np.ndarray] = WhenAsked()
    beta_rates: WhenAsked[np.ndarray] = WhenAsked()
    arm: WhenAsked[np.ndarray] = WhenAsked()
    rod: WhenAsked[np.ndarray] = WhenAsked()
    area: WhenAsked[np.ndarray] = WhenAsked()
    square: WhenAsked[np.ndarray] = WhenAsked()


def rod_and_arm(g: SI, base: BasePosition, y: np.ndarray) -> RodAndArm:
    """Angles φ and β of arm and rod for the slider at L0 + y, y (4, n) with three derivatives.

    By the triangle r = hypot(L, H), L1, L2 with Kahan's area K in place of Shin1995 (9), (10), which divide by zero
    where a root is at 180 deg; error <= 1.3 eps (1 + S/K), S = r² + L1² + L2². Their sines and cosines follow from the
    triangle too: e^{iφ} = (L + iH)(r² + L1² - L2² + iσK)/(2 L1 r²). Velocities (11), (12) and accelerations (13), (14)
    as printed; third derivatives by differentiating them once more. All NaN where there is no triangle, infinite or NaN
    where it is flat.
    """
    h, n = g.guide_height, y.shape[1]
    slider, square, k, by_arm, by_rod = made = np.empty((5, n))
    arm, rod = np.empty((2, n), dtype=complex)
    phi, beta = np.empty_like(y), np.empty_like(y)
    for i in range(0, n, BLOCK):
        at = slice(i, i + BLOCK)
        _solve(g, base, y[:, at], made[:, at], (arm[at], rod[at]), (phi[:, at], beta[:, at]))

    def angle(rates: np.ndarray, sigma: float, by_side: np.ndarray, turns: float) -> np.ndarray:
        """The angle before its derivatives."""
        rates[0] = np.arctan2(h, slider) + sigma * np.arctan2(k, by_side) + turns
        return rates

    return RodAndArm(
        slider,
        lambda: angle(phi, base.sigma, by_arm, _whole_turns(g, base)[0]),
        lambda: angle(beta, -base.sigma, by_rod, _whole_turns(g, base)[1]),
        phi, beta, arm, rod, k, square,
    )  # fmt: skip


Pair = tuple[np.ndarray, np.ndarray]


@np.errstate(divide="ignore", invalid="ignore")
def _solve(g: SI, base: BasePosition, y: np.ndarray, made: np.ndarray, units: Pair, rates: Pair) -> None:
    """The same for some cam angles into rows L, r², K, r² + L1² - L2², r² - L1² + L2² (5, m), unit vectors (m,) and rates
    (4, m) of arm and rod."""
    l1, l2, h = g.slider_arm, g.rod, g.guide_height
    (arm, rod), (phi, beta) = units, rates
    slider = np.add(base.slider, y[0], out=made[0])
    square = np.multiply(slider, slider, out=made[1])
    square += h * h
    k = made[2]
    k[:] = dead_centres(l1, l2, h).area4(slider)
    difference = (l1 - l2) * (l1 + l2)
    by_arm, by_rod = np.add(square, difference, out=made[3]), np.subtract(square, difference, out=made[4])
    up, ahead = k * (base.sigma * h), k * (base.sigma)
    ahead *= slider
    cos_phi, sin_phi = slider * by_arm - up, h * by_arm + ahead
    cos_beta, sin_beta = slider * by_rod + up, h * by_rod - ahead
    for cosine, sine, twice in ((cos_phi, sin_phi, 2.0 * l1), (cos_beta, sin_beta, 2.0 * l2)):
        share = 1.0 / (twice * square)
        cosine *= share
        sine *= share

    sin = k * (base.sigma / (2.0 * l1 * l2))  # sin(φ-β)
    cos = (square - (l1 * l1 + l2 * l2)) / (2.0 * l1 * l2)  # cos(φ-β)
    to_phi, to_beta = -1.0 / (l1 * sin), 1.0 / (l2 * sin)
    p1 = np.multiply(y[1] * cos_beta, to_phi, out=phi[1])  # (12)
    b1 = np.multiply(y[1] * cos_phi, to_beta, out=beta[1])  # (11)
    p2, b2 = l1 * p1 * p1, l2 * b1 * b1
    np.multiply(y[2] * cos_beta + p2 * cos + b2, to_phi, out=phi[2])  # (14)
    np.multiply(y[2] * cos_phi + b2 * cos + p2, to_beta, out=beta[2])  # (13)
    p3, b3 = 3.0 * l1 * p1 * phi[2], 3.0 * l2 * b1 * beta[2]
    np.multiply(y[3] * cos_beta + p3 * cos - p2 * p1 * sin + b3, to_phi, out=phi[3])
    np.multiply(y[3] * cos_phi + p3 + b3 * cos + b2 * b1 * sin, to_beta, out=beta[3])
    arm.real, arm.imag, rod.real, rod.imag = cos_phi, sin_phi, cos_beta, sin_beta


def _whole_turns(g: SI, base: BasePosition) -> tuple[float, float]:
    """Whole turns [rad] that φ and β of the triangle lack at the base position; neither wraps within the cycle."""
    square = base.slider**2 + g.guide_height**2
    k = 2.0 * g.slider_arm * g.rod * abs(math.sin(base.phi - base.beta))
    difference = (g.slider_arm - g.rod) * (g.slider_arm + g.rod)
    line = math.atan2(g.guide_height, base.slider)
    phi = line + base.sigma * math.atan2(k, square + difference)
    beta = line - base.sigma * math.atan2(k, square - difference)
    turn = 2.0 * pi
    return turn * round((base.phi - phi) / turn), turn * round((base.beta - beta) / turn)
