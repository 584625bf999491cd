"""How a cut cam is inspected."""

from __future__ import annotations

from core.design.fields import choice, length, number, whole
from core.frozen import frozen
from core.output.inspection.probe import PROBES
from core.output.profile.request import flank_choice
from core.requests import asked


@frozen
class Request:
    """One inspection.

    probe          row of ``PROBES``; None: as the cam's own follower touches it
    radius_mm      of a round probe; None: that of the cam's own follower
    tolerance_mm   ±, normal to the profile
    samples        equally spaced cam angles of the table
    flank          name of one of the cam's flanks
    direction_deg  in which the probe stands as seen from the cam centre, in the global frame; None: that of the follower where it
                   has one, else 90
    """

    probe: str | None = asked(
        choice("Probe", tuple(PROBES), default=None, help="what touches the cam"),
        usual="as its own follower does",
        words={name: row.label.capitalize() for name, row in PROBES.items()},
    )
    radius_mm: float | None = asked(
        length("Radius", default=None, help="of a roller or ball"), usual="that of the cam's own follower"
    )
    tolerance_mm: float = number("Tolerance", 0.0, 1e9, default=0.02, help="half the band, normal to the profile")
    samples: int = whole("Cam angles", 4, 1_000_000, default=360, help="equally spaced cam angles")
    flank: str = flank_choice()
    direction_deg: float | None = asked(
        number(
            "Direction",
            default=None,
            help="where the probe stands, seen from the cam centre, counter-clockwise from the x axis",
        ),
        usual="as the follower, else 90",
    )


__all__ = ["Request"]
