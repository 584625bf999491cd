"""What a profile file shall hold, and how."""

from __future__ import annotations

from core.cam import INNER, OUTER, SECOND
from core.frozen import frozen

ALL_FLANKS = (INNER, OUTER, SECOND)


@frozen
class Request:
    """One curve.

    sampling   row of ``SAMPLINGS``, and its value: how many points, or [mm]
    fit        row of ``FITS``: what runs from point to point
    flank      name of one of the cam's flanks
    cutter_mm  radius of a cutter or grinding wheel, the path of whose centre is wanted; 0 where the profile is
    """

    sampling: str
    value: float
    fit: str
    flank: str = "inner"
    cutter_mm: float = 0.0


__all__ = ["ALL_FLANKS", "Request"]
