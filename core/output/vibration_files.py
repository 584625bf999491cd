"""The elastic follower as text, as figures and as a table: natural frequency, residual vibration in every dwell, response spectrum."""

from __future__ import annotations

import math
from collections.abc import Sequence
from io import StringIO
from typing import Any

import numpy as np

from core.design import UNITS, Unit, split_unit
from core.elastic import Spectrum
from core.errors import NoAnswer
from core.output.lines import columns, digits
from core.study import Study

RPM = UNITS["rpm"].factor
SPEEDS, BEYOND = 200, 2.0  # of the spectrum: how many, and up to which multiple of the design's speed
MM = 1e3


def speeds_of(study: Study, low: float | None = None, high: float | None = None, count: int = SPEEDS) -> np.ndarray:
    """Evenly spaced speeds (count,) [rad/s] between two [rpm]; where these are not given up to a multiple of the design's."""
    top = BEYOND * abs(study.omega) / RPM if high is None else high
    return np.linspace(top / count if low is None else low, top, count) * RPM


def units_of(study: Study) -> tuple[tuple[str, float], ...]:
    """Units in which a vibration is read, each with what one unit of the motion is in it: millimetres; where the motion turns those of
    the roller's centre (or of the contact) along its path, and degrees too."""
    if study.program.motion.unit == "mm":
        return (("mm", MM),)
    return ("mm", study.elasticity.way * MM), ("deg", 1.0 / UNITS["deg"].factor)


def elastic_rows(study: Study) -> dict[str, Any]:
    """The figures of ``summary.json``: the one mass, and its residual vibration in each dwell; infinite where every turn adds to it.
    Empty where the follower is rigid, or has no answer."""
    try:
        found, response = study.elasticity, study.follower_response
    except NoAnswer:
        return {}
    one, turns = found.middle, 2.0 * math.pi
    swings = study.program.motion.unit == "deg"
    mass, rate = ("mass_kg_m2", "nm_per_rad") if swings else ("mass_kg", "n_per_mm")
    factor = UNITS[rate].factor
    return {
        "natural_hz": one.natural / turns,
        "lowest_natural_hz": found.lowest / turns,
        "highest_natural_hz": found.highest / turns,
        mass: one.mass,
        f"stiffness_{rate}": one.stiffness / factor,
        f"closing_{rate}": one.closing / factor,
        "damping_ratio": one.ratio,
        "periods_per_turn": one.natural / abs(study.omega),
        "residual": [
            {
                "from_deg": math.degrees(each.dwell.start),
                "to_deg": math.degrees(each.dwell.end),
                **{f"from_rest_{unit}": each.from_rest * size for unit, size in units_of(study)},
                **{f"steady_{unit}": each.steady * size for unit, size in units_of(study)},
            }
            for each in response.residuals
        ],
    }


def elastic_lines(study: Study) -> list[str]:
    """Natural frequency, and the residual vibration in each dwell; none where the follower is rigid, or has no answer."""
    figures = elastic_rows(study)
    if not figures:
        return []
    spread = ""
    if figures["highest_natural_hz"] > 1.001 * figures["lowest_natural_hz"]:
        spread = f", {digits(figures['lowest_natural_hz'], 4)} to {digits(figures['highest_natural_hz'], 4)} Hz over the stroke"
    lines = [
        f"Natural frequency {digits(figures['natural_hz'], 5)} Hz{spread}: {digits(figures['periods_per_turn'], 4)} periods a turn, "
        f"damping ratio {digits(figures['damping_ratio'], 4)}"
    ]  # fmt: skip
    if not figures["residual"]:
        return [*lines, "The motion has no dwell in which it could come to rest"]
    units = [unit for unit, _ in units_of(study)]
    rows: list[Sequence[str]] = [
        (
            "Vibration in the dwell",
            "to °",
            *(f"{word} {UNITS[unit].symbol}" for word in ("from rest", "steady") for unit in units),
        )
    ]
    for each in figures["residual"]:
        values = (each[f"{word}_{unit}"] for word in ("from_rest", "steady") for unit in units)
        rows.append(
            (f"from {digits(each['from_deg'])} °", digits(each["to_deg"]), *(digits(value, 4) for value in values))
        )
    return [*lines, *columns(rows)]


def spectrum_table(study: Study, found: Spectrum) -> dict[str, np.ndarray]:
    """The spectrum by columns, in their units: per dwell the residual from rest and steady, then the largest |z - s| and |z̈| of
    both; infinite where there is no steady response."""
    unit = study.program.motion.unit
    rows: dict[str, np.ndarray] = {"speed_rpm": found.omega / RPM}
    for word, residual in zip(("", "steady_"), found.residual, strict=True):
        for i, amplitude in enumerate(residual, 1):
            rows |= {f"{word}residual{i}_{name}": amplitude * size for name, size in units_of(study)}
    for word, error, acceleration in zip(("", "steady_"), found.error, found.acceleration, strict=True):
        scale = UNITS[unit].factor
        rows[f"{word}largest_error_{unit}"] = error / scale
        rows[f"{word}largest_acceleration_{unit}_s2"] = acceleration / scale
    return rows


def unit_of(column: str) -> Unit:
    """The unit of a column."""
    return split_unit(column)[1]


def spectrum_csv(study: Study, found: Spectrum) -> str:
    """A row for each speed; a figure that is not finite is left empty."""
    table, text = spectrum_table(study, found), StringIO()
    text.write(",".join(table) + "\n")
    for row in zip(*(column.tolist() for column in table.values()), strict=True):
        text.write(",".join(repr(value) if math.isfinite(value) else "" for value in row) + "\n")
    return text.getvalue()
