"""The formulas of the motion laws, as lines of text: s(u) rising from 0 to 1 while u goes from 0 to 1."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

_CYCLOID, _HARMONIC = ("s = u - sin(2 π u)/(2 π)",), ("s = (1 - cos(π u))/2",)
_C1, _C2 = ("s = u - sin(π u)/π",), ("s = u + sin(π u)/π",)
_H1, _H2 = ("s = 1 - cos(π u/2)",), ("s = sin(π u/2)",)

LINES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "constant-velocity": ("s = u",),
        "parabolic": ("s = 2 u², u ≤ 1/2", "s = 1 - 2 (1 - u)², u ≥ 1/2"),
        "simple-harmonic": _HARMONIC,
        "double-harmonic": ("s = (1 - cos(π u))/2 - (1 - cos(2 π u))/8",),
        "cycloidal": _CYCLOID,
        "modified-sine": (
            "s = (π u - sin(4 π u)/4)/(4 + π), u ≤ 1/8",
            "s = (2 + π u - 9 sin(4 π u/3 + π/3)/4)/(4 + π), 1/8 ≤ u ≤ 7/8",
            "s = (4 + π u - sin(4 π u)/4)/(4 + π), u ≥ 7/8",
        ),
        "2-3": ("s = 3 u² - 2 u³",),
        "3-4-5": ("s = 10 u³ - 15 u⁴ + 6 u⁵",),
        "4-5-6-7": ("s = 35 u⁴ - 84 u⁵ + 70 u⁶ - 20 u⁷",),
        "5-6-7-8-9": ("s = 126 u⁵ - 420 u⁶ + 540 u⁷ - 315 u⁸ + 70 u⁹",),
        "freudenstein-1-3": ("s = u - 27 sin(2 π u)/(56 π) - sin(6 π u)/(168 π)",),
        "freudenstein-1-3-5": (
            "s = u - 1125 sin(2 π u)/(2384 π) - 1125 sin(6 π u)/(128736 π) - 9 sin(10 π u)/(23840 π)",
        ),
        "gutman-1-3": ("s = u - 15 sin(2 π u)/(32 π) - sin(6 π u)/(96 π)",),
        "c1": _C1, "c2": _C2, "c3": _C1, "c4": _C2, "c5": _CYCLOID, "c6": _CYCLOID,
        "h1": _H1, "h2": _H2, "h3": _H1, "h4": _H2, "h5": _HARMONIC, "h6": _HARMONIC,
        "p1": ("s = (250 u³ - 852 u⁵ + 1096 u⁶ - 558 u⁷ + 105 u⁸)/41",),
        "p2": ("s = 1 - (250 (1 - u)³ - 852 (1 - u)⁵ + 1096 (1 - u)⁶ - 558 (1 - u)⁷ + 105 (1 - u)⁸)/41",),
        "cv1": ("s = u",), "cv2": ("s = u",),
        "polynomial": ("s = Σ c_k u^k",),
    }
)  # fmt: skip
"""Slug -> its lines; laws that are put together from ramps, and curves of points, have none in closed form that could be read."""

SCCA = (
    "s″ = C_a sin(π u/b), 0 ≤ u ≤ b/2",
    "s″ = C_a, b/2 ≤ u ≤ (b + c)/2",
    "s″ = C_a cos(π w/d), w = u - (b + c)/2 ≤ d/2",
)
SCCA_WHERE = (
    "b, c, d widths of ramp, constant and cosine, then constant velocity, and the same mirrored; C_a so that s(1) = 1"
)
HALF_FLAT = (
    "s″ = C_a sin(π u/(2r)), 0 ≤ u ≤ r",
    "s″ = C_a, r ≤ u ≤ 1 - r",
    "s″ = C_a sin(π (1 - u)/(2r)), 1 - r ≤ u ≤ 1",
)
HALF_FLAT_WHERE = "of C1 and C3; C2 and C4 have -s″; 1 - 2r the fraction of the span at constant acceleration, C_a = 2/(1 - 2r + 4r/π)"
POINTS = ("min ∫ s‴² dθ",)
POINTS_WHERE = (
    "the periodic spline through the points of the table with the least jerk, a polynomial between neighbours"
)

__all__ = ["HALF_FLAT", "HALF_FLAT_WHERE", "LINES", "POINTS", "POINTS_WHERE", "SCCA", "SCCA_WHERE"]
