"""What the command ``centres`` prints: instant centres, angular velocities and points of a linkage at one position."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from core.errors import NoSuchStage
from core.instant_centres import Centres
from core.mechanism import link_number
from core.study import LinkageStudy, Study

_MM = 1e3


def centres_data(study: Study, angle_deg: float) -> dict[str, Any]:
    """At this driver angle [deg]; links by their numbers, the frame included.

    A centre is [x, y] in mm, or its direction where it is at infinity; null where the links have no motion against each
    other. Raises NoPosition where the linkage cannot stand there, NoSuchStage for a design that is no linkage.
    """
    if not isinstance(study, LinkageStudy):
        raise NoSuchStage("centres", study.stages)
    there = study.at_theta(np.array([math.radians(angle_deg)]))
    assert isinstance(there, LinkageStudy)
    table = there.centres
    return {
        "angular_velocity_rad_s": {str(n): _plain(w[0]) for n, w in there.angular_velocities().items()},
        "centres": {
            f"{link_number(a)},{link_number(b)}": _centre(centre, table.size)
            for (a, b), centre in table.centres.items()
        },
        "points": {
            name: {
                "x_mm": _plain(z[0].real * _MM),
                "y_mm": _plain(z[0].imag * _MM),
                "vx_mm_s": _plain(v[0].real * _MM),
                "vy_mm_s": _plain(v[0].imag * _MM),
            }
            for name, (z, v) in there.points().items()
        },
    }


def _centre(centre: Centres, size: float) -> Any:
    if centre.weight[0] == 0.0 and centre.point[0] == 0.0:
        return None
    if centre.far(size)[0]:
        return {"direction_deg": _plain(math.degrees(centre.direction[0]))}
    at = complex(centre.finite[0]) * _MM
    return [_plain(at.real), _plain(at.imag)]


def _plain(value: Any) -> float | None:
    """A number for JSON: no minus zero, null for infinity."""
    number = float(value) + 0.0
    return number if math.isfinite(number) else None
