"""What a profile file shall hold, and how."""

from __future__ import annotations

from typing import Any

from core.cam import INNER, OUTER, SECOND
from core.design.fields import choice, flag, length, number, whole
from core.frozen import frozen
from core.output.profile.fits import FITS
from core.output.profile.points import LEAST_POINTS, MOST_POINTS
from core.requests import asked

ALL_FLANKS = (INNER, OUTER, SECOND)


def flank_choice() -> Any:
    """A field for one of a cam's flanks."""
    return choice("Flank", ALL_FLANKS, default=INNER, help="which side of the cam")


def _of_path(label: str, low: float, high: float, default: float, help: str, usual: str = "") -> Any:
    """A field for a number of G-code, which the option says."""
    known = number(label, low, high, default=default, help=help)
    return asked(known, help=f"G-code: {label.lower()}, {help}", usual=usual)


@frozen
class Machining:
    """How a path is cut."""

    feed_mm_min: float = _of_path("Feed", 0.1, 1e5, 200.0, "along the path")
    plunge_mm_min: float = _of_path("Plunge", 0.1, 1e5, 50.0, "feed on the way down")
    safe_mm: float = _of_path("Safe height", 0.1, 1e4, 10.0, "of rapid moves above the face of the blank")
    depth_mm: float = _of_path("Depth", 0.0, 1e4, 0.0, "below the face of the blank", "the cam's thickness, or 10 mm")
    step_mm: float = _of_path("Depth of a pass", 0.0, 1e4, 0.0, "at most", "all in one pass")
    conventional: bool = asked(
        flag("Conventional instead of climb milling"), help="G-code: conventional instead of climb milling"
    )


@frozen
class Request:
    """One curve.

    flank      name of one of the cam's flanks
    samples, spacing_mm, tolerance_mm  one of them says where the points lie; None of all: as the format usually has them
    cutter_mm  radius of a cutter or grinding wheel, the path of whose centre is wanted; 0 where the profile is
    fit        row of ``FITS``: what runs from point to point; empty: what the format usually has
    machining  of a path that a machine is to follow
    """

    flank: str = flank_choice()
    samples: int | None = asked(
        whole("Points", LEAST_POINTS, MOST_POINTS, default=None, help="points at equal cam angles"),
        one_of=("Points", "At equal cam angles"),
    )
    spacing_mm: float | None = asked(
        length("Spacing", default=None, help="points at equal arc lengths, at most so far apart"),
        one_of=("Points", "At equal arc lengths"),
    )
    tolerance_mm: float | None = asked(
        length("Tolerance", default=None, help="the fewest points that keep a tolerance"),
        one_of=("Points", "The fewest that keep a tolerance"),
    )
    fit: str = asked(
        choice("Between them", tuple(FITS), default="", help="what runs from point to point"),
        "--as",
        usual="spline; CSV: polyline",
        words={name: row.label.capitalize() for name, row in FITS.items()},
    )
    cutter_mm: float = asked(
        length("Cutter radius", default=0.0, help="path of the centre of a cutter or grinding wheel of this radius"),
        usual="none: the profile itself",
        metavar="RADIUS_MM",
    )
    machining: Machining = Machining()

    @property
    def sampling(self) -> str:
        """The row of ``SAMPLINGS`` that is asked for; empty where none is."""
        given = {"samples": self.samples, "spacing": self.spacing_mm, "tolerance": self.tolerance_mm}
        return next((name for name, value in given.items() if value is not None), "")

    @property
    def value(self) -> float:
        """Of the sampling: how many points, or [mm]; 0 where none is asked for."""
        return self.samples or self.spacing_mm or self.tolerance_mm or 0.0


__all__ = ["ALL_FLANKS", "Machining", "Request", "flank_choice"]
