"""Points on a curve: at equal cam angles, at equal arc lengths, or the fewest that keep a tolerance. One row each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import ceil
from types import MappingProxyType
from typing import Any

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.motion import degrees
from core.numerics.cancellation import checkpoint
from core.output.profile.curve import ProfileCurve, SpanEnds
from core.output.profile.fewest import TooMany, fewest
from core.output.profile.fits import FitMethod

LEAST_POINTS, MOST_POINTS = 3, 1_000_000
AT_ONCE = 32_768  # points that are computed together: memory does not grow with them
MOST_SEARCHED = 100_000  # points whose spans are searched one by one


@frozen(eq=False)
class Points:
    """n points of a curve: cam angles [deg] (n,), and the points at just these angles."""

    degrees: np.ndarray
    ends: SpanEnds

    def spans(self, length: float) -> tuple[SpanEnds, SpanEnds]:
        """Each point and the next, the last being followed by the first, one length of the curve [mm] further on."""
        here = self.ends
        after = SpanEnds(np.roll(here.z, -1), np.roll(here.tangent, -1), np.append(here.s[1:], here.s[0] + length))
        return here, after


@frozen
class Sampling:
    """One row: the sentence that tells what it is of its value; the cam angles [deg] (n,) of the points it gives."""

    text: str
    degrees: Callable[[ProfileCurve, FitMethod, float], np.ndarray]


def _equal_angles(curve: ProfileCurve, fit: FitMethod, count: float) -> np.ndarray:
    return degrees(int(count))


def _equal_lengths(curve: ProfileCurve, fit: FitMethod, spacing: float) -> np.ndarray:
    count = ceil(curve.length / spacing * (1.0 - 1e-12))
    if not LEAST_POINTS <= count <= MOST_POINTS:
        low, high = curve.length / MOST_POINTS, curve.length / LEAST_POINTS
        raise KindynaError(
            f"spacing {spacing:g} mm: the curve is {curve.length:.6g} mm long; allowed: {low:.3g} ... {high:.6g} mm"
        )
    return np.rad2deg(curve.theta(curve.length * np.arange(count) / count))


def _fewest(curve: ProfileCurve, fit: FitMethod, tolerance: float) -> np.ndarray:
    try:
        s = fewest(curve, fit, tolerance, MOST_SEARCHED)
    except TooMany as error:
        raise KindynaError(
            f"tolerance {tolerance:g} mm: it takes about {error.count} points, {MOST_SEARCHED} at most are searched for; "
            "choose a larger tolerance, or arcs or a spline"
        ) from None
    return np.rad2deg(curve.theta(s))


SAMPLINGS: Mapping[str, Sampling] = MappingProxyType(
    {
        "samples": Sampling("{value:g} points at equal cam angles", _equal_angles),
        "spacing": Sampling("points at equal arc lengths of at most {value:g} mm", _equal_lengths),
        "tolerance": Sampling("the fewest points that keep a tolerance of {value:g} mm", _fewest),
    }
)


def points(curve: ProfileCurve, program: Any, sampling: str, fit: FitMethod, value: float) -> Points:
    """The points of a sampling. Raises KindynaError where they would be too few or too many."""
    angles = SAMPLINGS[sampling].degrees(curve, fit, value)
    rows = []
    for first in range(0, angles.size, AT_ONCE):
        checkpoint()
        there = program.angles(np.deg2rad(angles[first : first + AT_ONCE]))
        exact = curve.exact(there)
        rows.append((exact.z, exact.tangent, curve.reached(there.theta)))
    return Points(angles, SpanEnds(*(np.concatenate(part) for part in zip(*rows, strict=True))))


__all__ = ["LEAST_POINTS", "MOST_POINTS", "SAMPLINGS", "Points", "Sampling", "points"]
