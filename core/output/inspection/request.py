"""How a cut cam is inspected."""

from __future__ import annotations

from core.frozen import frozen

TOLERANCE_MM = 0.02
ANGLES = 360
LEAST_ANGLES, MOST_ANGLES = 4, 1_000_000


@frozen
class Request:
    """One inspection.

    probe          row of ``PROBES``; empty: as the cam's own follower touches it
    radius_mm      of a round probe; None: that of the cam's own follower
    tolerance_mm   ±, normal to the profile
    samples        equally spaced cam angles of the table
    flank          name of one of the cam's flanks
    direction_deg  in which the probe stands as seen from the cam centre, in the global frame; None: that of the follower where it
                   has one, else 90
    """

    probe: str = ""
    radius_mm: float | None = None
    tolerance_mm: float = TOLERANCE_MM
    samples: int = ANGLES
    flank: str = "inner"
    direction_deg: float | None = None


__all__ = ["ANGLES", "LEAST_ANGLES", "MOST_ANGLES", "TOLERANCE_MM", "Request"]
