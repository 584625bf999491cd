"""Keeping contact as text and as a table: speed of lift-off, flights, and the contact force over cam angle and speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from io import StringIO

import numpy as np

from core.design import UNITS
from core.dynamics import ContactMap, Flights, contact_map
from core.errors import NoAnswer
from core.output.lines import columns, digits
from core.study import Study

RPM = math.pi / 30.0
SPEEDS, BEYOND = 40, 1.5  # of the map: how many, and up to which multiple of the design's speed or of that of lift-off


def map_of(study: Study, theta: np.ndarray, top_rpm: float | None = None, speeds: int = SPEEDS) -> ContactMap:
    """The contact force at cam angles (n,) [rad] and evenly spaced speeds up to one, usually somewhat above those that matter. Raises
    NoAnswer where there is no contact force that could be lost."""
    return contact_map(
        study.contact_force, theta, np.linspace(0.0, RPM * (top_rpm or usual_top(study)), speeds + 1)[1:]
    )


def usual_top(study: Study) -> float:
    """The highest speed of the map [rpm]."""
    found, own = study.lift_off, abs(study.omega) / RPM
    most = own if found is None else max(own, min(found.omega / RPM, 4.0 * own))
    return float(f"{BEYOND * most:.2g}")


def map_csv(found: ContactMap) -> str:
    """Rows of cam angle, speed and contact force, speed by speed."""
    text = StringIO()
    text.write("cam_angle_deg,speed_rpm,contact_force_n\n")
    angles = [repr(x) for x in np.rad2deg(found.theta).tolist()]
    for speed, row in zip((found.omega / RPM).tolist(), found.force.tolist(), strict=True):
        for angle, force in zip(angles, row, strict=True):
            text.write(f"{angle},{speed!r},{force!r}\n")
    return text.getvalue()


def lift_off_lines(study: Study) -> list[str]:
    """The speed from which the follower leaves the cam, in one line; none where it cannot leave it."""
    try:
        found = study.lift_off
    except NoAnswer:
        return []
    if found is None:
        return ["The follower stays on the cam at any speed"]
    if not found.omega:
        return [
            f"The follower is not pressed on the cam at {digits(math.degrees(found.theta))}°, even where the shaft stands still"
        ]
    return [
        f"The follower leaves the cam from {digits(found.omega / RPM)} rpm on, at cam angle {digits(math.degrees(found.theta))}°"
    ]


def flight_lines(study: Study, found: Flights) -> list[str]:
    """The flights as a table, and whether they repeat."""
    if not found.flights:
        return ["It does not fly at the design's speed"]
    unit = UNITS[study.program.motion.unit]
    rows: list[Sequence[str]] = [
        ("Flight", "leaves at °", "lands at °", f"height {unit.symbol}", f"lands with {unit.symbol}/s")
    ]
    for i, one in enumerate(found.flights, 1):
        ends = [digits(math.degrees(x)) if math.isfinite(x) else "not" for x in (one.lift, one.land)]
        rows.append((str(i), *ends, digits(one.height / unit.factor), digits(one.speed / unit.factor)))
    lines = columns(rows)
    if found.steady:
        again = "every turn" if found.turns == 1 else f"every {found.turns} turns"
        lines.append(f"From flight {found.repeats + 1} on they repeat {again}")
    else:
        lines.append("They do not repeat within the turns that were followed")
    return lines
