"""What the command ``centres`` prints: instant centres, angular velocities and points of a linkage at one position."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from core.design import require_linkage
from core.instant_centres import CHAINS, Centres, RatioArms, ratio_arms
from core.mechanism import body_name, link_number
from core.output.position import differences
from core.study import Study

_MM = 1e3


@dataclass(frozen=True, eq=False)
class Snapshot:
    """A linkage at one driver angle [deg], to be drawn with its centres and its velocity polygon."""

    study: Study
    angle_deg: float


def snapshot(study: Study, angle_deg: float) -> Snapshot:
    """Raises DesignError for a design that is no linkage."""
    require_linkage(study.design)
    return Snapshot(study, angle_deg)


def centres_data(study: Study, angle_deg: float) -> dict[str, Any]:
    """At this driver angle [deg]; links by their numbers, the frame included.

    A centre is [x, y] in mm, or its direction where it is at infinity; null where the links have no motion against each
    other. A velocity difference is V_to = V_from + V_difference, of two points of one link, or of two links that slide on
    each other at the same place. Raises NoPosition where the linkage cannot stand there, DesignError for a design that is no linkage.
    """
    require_linkage(study.design)
    there = study.at_theta(np.array([math.radians(angle_deg)]))
    table, driver = there.centres, body_name(there.design.drive.linkage.driver.link)
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
        "velocity_ratios": {
            f"{link_number(body)},{link_number(base)}": _ratio(ratio_arms(table, body, base))
            for body, base in dict.fromkeys(pair for pairs in CHAINS.values() for pair in pairs(table, driver))
        },
        "velocity_differences": [
            {
                "kind": row.kind,
                "link": row.link,
                "on": row.on,
                "from": row.a,
                "to": row.p,
                "v_from_mm_s": _vector(row.v_a),
                "v_difference_mm_s": _vector(row.v_pa),
                "v_to_mm_s": _vector(row.v_p),
            }
            for row in differences(there)
        ],
    }


def _ratio(arms: RatioArms) -> dict[str, float | None]:
    """ω_body/ω_base and the directed distances that tell it; null where infinite, as of a link that does not turn."""
    return {
        "ratio": _plain(arms.ratio[0]),
        "base_arm_mm": _plain(arms.base_arm[0] * _MM),
        "body_arm_mm": _plain(arms.body_arm[0] * _MM),
    }


def _vector(velocity: complex) -> list[float | None]:
    return [_plain(velocity.real * _MM), _plain(velocity.imag * _MM)]


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
