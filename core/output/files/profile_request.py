"""Requests for profile files: flank, points, fit and machining; and numbers rounded to the safe side."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import ceil
from types import MappingProxyType
from typing import Any

import numpy as np

from core.cam import INNER, OUTER, SECOND
from core.design.fields import choice, flag, length, number, whole
from core.errors import KindynaError
from core.frozen import frozen
from core.motion import degrees
from core.number_text import result_text
from core.numerics.lazy import checkpoint
from core.output.files.fewest import TooManyPoints, fewest_points
from core.output.files.profile_curve import ProfileCurve, SpanEnds
from core.output.files.profile_fit import FITS, FitMethod
from core.requests import option

# -- points on a curve ------------------------------------------------------------------------------------------


LEAST_POINTS, MOST_POINTS = 3, 1_000_000
AT_ONCE = 32_768  # points that are computed together, which limits memory
MOST_SEARCHED = 100_000  # points whose spans are searched one by one


@frozen(eq=False)
class Points:
    """n points of a curve.

    Attributes
    ----------
    degrees : (n,) cam angles [deg]
    ends : the points at these angles
    """

    degrees: np.ndarray
    ends: SpanEnds

    def spans(self, length: float) -> tuple[SpanEnds, SpanEnds]:
        """Start and end of each span; the last ends at the first point, one ``length`` of the curve [mm] further on."""
        start = self.ends
        end = SpanEnds(np.roll(start.z, -1), np.roll(start.tangent, -1), np.append(start.s[1:], start.s[0] + length))
        return start, end


@frozen
class Sampling:
    """One row of ``SAMPLINGS``.

    Attributes
    ----------
    text : description, with its value
    degrees : cam angles (n,) [deg] of the points
    """

    text: str
    degrees: Callable[[ProfileCurve, FitMethod, float], np.ndarray]


def _equal_lengths(curve: ProfileCurve, fit: FitMethod, spacing: float) -> np.ndarray:
    count = ceil(curve.length / spacing * (1.0 - 1e-12))
    if not LEAST_POINTS <= count <= MOST_POINTS:
        low, high = curve.length / MOST_POINTS, curve.length / LEAST_POINTS
        raise KindynaError(
            f"spacing {spacing:g} mm: the curve is {result_text(curve.length, 5)} mm long; allowed: "
            f"{result_text(low, 3)} ... {result_text(high, 5)} mm"
        )
    return np.rad2deg(curve.theta(curve.length * np.arange(count) / count))


def _fewest_points(curve: ProfileCurve, fit: FitMethod, tolerance: float) -> np.ndarray:
    try:
        s = fewest_points(curve, fit, tolerance, MOST_SEARCHED)
    except TooManyPoints as error:
        raise KindynaError(
            f"tolerance {tolerance:g} mm: it requires about {error.count} points, the limit is {MOST_SEARCHED}; "
            "choose a larger tolerance, or arcs or a spline"
        ) from None
    return np.rad2deg(curve.theta(s))


SAMPLINGS: Mapping[str, Sampling] = MappingProxyType(
    {
        "samples": Sampling("{value:g} points at equal cam angles", lambda curve, fit, count: degrees(int(count))),
        "spacing": Sampling("points at equal arc lengths of at most {value:g} mm", _equal_lengths),
        "tolerance": Sampling("the fewest points that keep a tolerance of {value:g} mm", _fewest_points),
    }
)


def points(curve: ProfileCurve, motion: Any, sampling: str, fit: FitMethod, value: float) -> Points:
    """Points of a curve by one row of ``SAMPLINGS``. Raises KindynaError where they are too few or too many."""
    angles = SAMPLINGS[sampling].degrees(curve, fit, value)
    rows = []
    for first in range(0, angles.size, AT_ONCE):
        checkpoint()
        cam_angles = motion.angles(np.deg2rad(angles[first : first + AT_ONCE]))
        exact = curve.exact(cam_angles)
        rows.append((exact.z, exact.tangent, curve.arc_length(cam_angles.theta)))
    return Points(angles, SpanEnds(*(np.concatenate(part) for part in zip(*rows, strict=True))))


# -- requests ---------------------------------------------------------------------------------------------------


ALL_FLANKS = (INNER, OUTER, SECOND)


def flank_choice() -> Any:
    """A field for one of a cam's flanks."""
    return choice("Flank", ALL_FLANKS, default=INNER, help="which side of the cam")


def _machining_field(label: str, low: float, high: float, default: float, help: str, default_text: str = "") -> Any:
    """A field for a number of G-code with its option."""
    field = number(label, low, high, default=default, help=help)
    return option(field, help=f"G-code: {label.lower()}, {help}", default_text=default_text)


@frozen
class Machining:
    """Machining data of a cutter's path."""

    feed_mm_min: float = _machining_field("Feed", 0.1, 1e5, 200.0, "along the path")
    plunge_mm_min: float = _machining_field("Plunge", 0.1, 1e5, 50.0, "feed on the way down")
    safe_mm: float = _machining_field("Safe height", 0.1, 1e4, 10.0, "of rapid moves above the face of the blank")
    depth_mm: float = _machining_field("Depth", 0.0, 1e4, 0.0, "below the face of the blank", "full, or 10 mm")
    step_mm: float = _machining_field("Depth of a pass", 0.0, 1e4, 0.0, "at most", "all in one pass")
    conventional: bool = option(
        flag("Conventional instead of climb milling"), help="G-code: conventional instead of climb milling"
    )


@frozen
class ProfileRequest:
    """One curve in a file.

    Attributes
    ----------
    flank : name of one of the cam's flanks
    samples, spacing_mm, tolerance_mm : one of them determines the points; None of all: the default of the format
    fit : row of ``FITS``, the pieces from point to point; empty: the default of the format
    cutter_mm : radius of a cutter or grinding wheel, for the path of its centre; 0 for the profile itself
    machining : machining data of a path
    """

    flank: str = flank_choice()
    samples: int | None = option(
        whole("Points", LEAST_POINTS, MOST_POINTS, default=None, help="points at equal cam angles"),
        one_of=("Points", "At equal cam angles"),
    )
    spacing_mm: float | None = option(
        length("Spacing", default=None, help="points at equal arc lengths, at most this distance"),
        one_of=("Points", "At equal arc lengths"),
    )
    tolerance_mm: float | None = option(
        length("Tolerance", default=None, help="the fewest points that keep a tolerance"),
        one_of=("Points", "The fewest that keep a tolerance"),
    )
    fit: str = option(
        choice("Between them", tuple(FITS), default="", help="curve from point to point"),
        "--as",
        default_text="spline; CSV: polyline",
        words={name: row.label.capitalize() for name, row in FITS.items()},
    )
    cutter_mm: float = option(
        length("Cutter radius", default=0.0, help="path of the centre of a cutter or grinding wheel of this radius"),
        default_text="none: the profile itself",
        metavar="RADIUS_MM",
    )
    machining: Machining = Machining()

    @property
    def sampling(self) -> str:
        """The requested row of ``SAMPLINGS``; empty for the default."""
        given = {"samples": self.samples, "spacing": self.spacing_mm, "tolerance": self.tolerance_mm}
        return next((name for name, value in given.items() if value is not None), "")

    @property
    def value(self) -> float:
        """Value of the sampling: number of points, or [mm]; 0 for the default."""
        return self.samples or self.spacing_mm or self.tolerance_mm or 0.0
