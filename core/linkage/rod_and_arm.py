"""Arm and rod between a pivot and a slider: their angles and three derivatives (Shin1995 §2.3)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from math import pi

import numpy as np

from core.design import SI
from core.linkage.base import BasePosition
from core.linkage.triangle import area4, area4_of


@dataclass(frozen=True, eq=False)
class RodAndArm:
    """slider L (n,) [m]; phi, beta (4, n) [rad], in the guide's frame; area K (n,) = 4 x area of the triangle pivot,
    arm pin, slider pin, NaN where it does not close; square r² (n,) of the distance pivot - slider pin."""

    slider: np.ndarray
    phi: np.ndarray
    beta: np.ndarray
    area: np.ndarray
    square: np.ndarray


def rod_and_arm(g: SI, base: BasePosition, y: np.ndarray) -> RodAndArm:
    """Angles φ and β of arm and rod for the slider at L0 + y, y (4, n) with three derivatives.

    By the triangle r = hypot(L, H), L1, L2 with Kahan's area K in place of Shin1995 (9), (10), which divide by zero
    where a root is at 180 deg; error <= 1.3 eps (1 + S/K), S = r² + L1² + L2². Velocities (11), (12) and accelerations
    (13), (14) as printed; third derivatives by differentiating them once more. All NaN where there is no triangle,
    infinite or NaN where it is flat.
    """
    l1, l2, h = g.slider_arm, g.rod, g.guide_height
    slider = base.slider + y[0]
    square = slider * slider + h * h
    k = area4(np.hypot(slider, h), l1, l2)
    difference = (l1 - l2) * (l1 + l2)
    line = np.arctan2(h, slider)
    turns = _whole_turns(g, base)
    phi, beta = np.empty_like(y), np.empty_like(y)
    phi[0] = line + base.sigma * np.arctan2(k, square + difference) + turns[0]
    beta[0] = line - base.sigma * np.arctan2(k, square - difference) + turns[1]

    sin = base.sigma * k / (2.0 * l1 * l2)  # sin(φ-β)
    cos = (square - (l1 * l1 + l2 * l2)) / (2.0 * l1 * l2)  # cos(φ-β)
    cos_phi, cos_beta = np.cos(phi[0]), np.cos(beta[0])
    with np.errstate(divide="ignore", invalid="ignore"):
        to_phi, to_beta = -1.0 / (l1 * sin), 1.0 / (l2 * sin)
        phi[1] = y[1] * cos_beta * to_phi  # (12)
        beta[1] = y[1] * cos_phi * to_beta  # (11)
        p1, b1 = phi[1], beta[1]
        p2, b2 = l1 * p1 * p1, l2 * b1 * b1
        phi[2] = (y[2] * cos_beta + p2 * cos + b2) * to_phi  # (14)
        beta[2] = (y[2] * cos_phi + b2 * cos + p2) * to_beta  # (13)
        p3, b3 = 3.0 * l1 * p1 * phi[2], 3.0 * l2 * b1 * beta[2]
        phi[3] = (y[3] * cos_beta + p3 * cos - p2 * p1 * sin + b3) * to_phi
        beta[3] = (y[3] * cos_phi + p3 + b3 * cos + b2 * b1 * sin) * to_beta
    return RodAndArm(slider, phi, beta, k, square)


def _whole_turns(g: SI, base: BasePosition) -> tuple[float, float]:
    """Whole turns [rad] that φ and β of the triangle lack at the base position; neither wraps within the cycle."""
    square = base.slider**2 + g.guide_height**2
    k = area4_of(math.sqrt(square), g.slider_arm, g.rod)
    difference = (g.slider_arm - g.rod) * (g.slider_arm + g.rod)
    line = math.atan2(g.guide_height, base.slider)
    phi = line + base.sigma * math.atan2(k, square + difference)
    beta = line - base.sigma * math.atan2(k, square - difference)
    turn = 2.0 * pi
    return turn * round((base.phi - phi) / turn), turn * round((base.beta - beta) / turn)
