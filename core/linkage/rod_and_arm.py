"""Arm and rod between a pivot and a slider: their angles and three derivatives (Shin1995 §2.3)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np

from core.derivatives import Chain, Derivatives
from core.design import SI
from core.linkage.base import BasePosition
from core.linkage.dead_centres import dead_centres
from core.vectors import blocks


@dataclass(frozen=True, eq=False)
class RodAndArm:
    """slider L (n,) [m]; phi, beta [rad], in the guide's frame, with three derivatives; arm e^{iφ} and rod e^{iβ} (n,);
    area K (n,) = 4 x area of the triangle pivot, arm pin, slider pin, NaN where it does not close; square r² (n,) of the
    distance pivot - slider pin."""

    slider: np.ndarray
    phi: Derivatives
    beta: Derivatives
    arm: np.ndarray
    rod: np.ndarray
    area: np.ndarray
    square: np.ndarray


def rod_and_arm(g: SI, base: BasePosition, y: np.ndarray) -> RodAndArm:
    """Angles φ and β of arm and rod for the slider at L0 + y, y (4, n) with three derivatives.

    By the triangle r = hypot(L, H), L1, L2 with Kahan's area K in place of Shin1995 (9), (10), which divide by zero
    where a root is at 180 deg; error <= 1.3 eps (1 + S/K), S = r² + L1² + L2². Their sines and cosines follow from the
    triangle too: e^{iφ} = (L + iH)(r² + L1² - L2² + iσK)/(2 L1 r²). Velocities (11), (12) and accelerations (13), (14)
    as printed; third derivatives by differentiating them once more. All NaN where there is no triangle, infinite or NaN
    where it is flat.
    """
    n = y.shape[1]
    slider, square, area = made = np.empty((3, n))
    arm, rod = units = np.empty((2, n), dtype=complex)
    for at in blocks(n):
        _triangle(g, base, y[0, at], made[:, at], units[:, at])
    difference = (g.slider_arm - g.rod) * (g.slider_arm + g.rod)

    def follow(order: int, turns: Chain) -> np.ndarray:
        lower = [turns[k] for k in range(1, order)]
        out = np.empty((2, n))
        for at in blocks(n):
            known = y[order, at] * units.real[::-1, at]
            _rates(g, base.sigma, square[at], area[at], known, [rates[:, at] for rates in lower], out[:, at])
        return out

    def angle(which: int, sigma: float, beside: float) -> Callable[[], np.ndarray]:
        def made() -> np.ndarray:
            opposite = sigma * np.arctan2(area, square + beside)
            return np.asarray(np.arctan2(g.guide_height, slider) + opposite + _whole_turns(g, base)[which])

        return made

    turns = Chain(follow)
    phi = turns.part(0, angle(0, base.sigma, difference))
    beta = turns.part(1, angle(1, -base.sigma, -difference))
    return RodAndArm(slider, phi, beta, arm, rod, area, square)


@np.errstate(divide="ignore", invalid="ignore")
def _triangle(g: SI, base: BasePosition, y: np.ndarray, made: np.ndarray, units: np.ndarray) -> None:
    """L, r², K (3, m) and the unit vectors of arm and rod (2, m) for slider displacements y (m,)."""
    l1, l2, h = g.slider_arm, g.rod, g.guide_height
    slider, square, k = made
    np.add(base.slider, y, out=slider)
    np.multiply(slider, slider, out=square)
    square += h * h
    k[:] = dead_centres(l1, l2, h).area4(slider)
    difference = (l1 - l2) * (l1 + l2)
    for unit, length, other, sigma in zip(units, (l1, l2), (difference, -difference), (base.sigma, -base.sigma), strict=True):
        share = (0.5 / length) / square
        np.multiply(square + other, share, out=unit.real)
        np.multiply(k, share * sigma, out=unit.imag)
    line = np.empty(slider.size, dtype=complex)
    line.real, line.imag = slider, h
    units *= line


@np.errstate(divide="ignore", invalid="ignore")
def _rates(
    g: SI, sigma: float, square: np.ndarray, area: np.ndarray, known: np.ndarray, lower: list[np.ndarray], out: np.ndarray
) -> None:
    """The next derivatives of φ and β (2, m) into ``out`` from those before and what the slider's own gives, y cos β and
    y cos φ in that order (2, m): (12), (11); with the squares of the velocities (14), (13); once more differentiated."""
    l1, l2 = g.slider_arm, g.rod
    inverse = np.empty(known.shape)  # 1/(L1 sin(β-φ)), 1/(L2 sin(φ-β)) with sin(φ-β) = σK/2 L1 L2
    np.divide(-2.0 * sigma * l2, area, out=inverse[0])
    np.divide(2.0 * sigma * l1, area, out=inverse[1])
    if lower:
        w = lower[0]
        turning = (w * w if len(lower) == 1 else 3.0 * w * lower[1]) * np.array([[l1], [l2]])
        cos = (square - (l1 * l1 + l2 * l2)) / (2.0 * l1 * l2)  # cos(φ-β)
        known += turning * cos
        known += turning[::-1]
    np.multiply(known, inverse, out=out)
    if len(lower) == 2:
        out += w * w * w


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
