"""What a profile file shall hold, and how."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

FLANKS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"open": ("inner",), "groove": ("inner", "outer"), "conjugate": ("inner", "second")}
)
"""Form of a cam -> what its flanks are called, in the order of ``CamShape.flanks``."""

ALL_FLANKS = tuple(dict.fromkeys(name for names in FLANKS.values() for name in names))


@dataclass(frozen=True)
class Request:
    """One curve.

    sampling   row of ``SAMPLINGS``, and its value: how many points, or [mm]
    fit        row of ``FITS``: what runs from point to point
    flank      one of ``FLANKS``
    cutter_mm  radius of a cutter or grinding wheel, the path of whose centre is wanted; 0 where the profile is
    """

    sampling: str
    value: float
    fit: str
    flank: str = "inner"
    cutter_mm: float = 0.0


__all__ = ["ALL_FLANKS", "FLANKS", "Request"]
