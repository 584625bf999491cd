"""What is said of a table for a controller: as JSON, as text; and the errors of tables with other numbers of rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from core.frozen import frozen
from core.output.controllers.rows import KINDS, UNKNOWN, evaluated
from core.output.controllers.slave import EQUAL, QUANTITIES, Slave
from core.output.controllers.table import NOT_PUBLISHED, Ecam, Placer, equal
from core.output.export import csv

COUNTS = 60
MOST = 5000


def facts(made: Ecam) -> dict[str, Any]:
    """As ``ecam --json`` prints them; errors in the motion's unit, per degree and degree² of the master."""
    unit, known = made.slave.unit, made.deviation
    values = dict.fromkeys(QUANTITIES, None) if known is None else dict(_padded(known.values))
    result: dict[str, Any] = {
        "controller": made.controller.slug,
        "interpolation": made.interpolation,
        "rows": made.rows,
        "certified": known is not None,
        "reason": NOT_PUBLISHED if known is None else "",
        f"deviation_{unit}": values["deviation"],
        "velocity_deviation": values["velocity"],
        "acceleration_deviation": values["acceleration"],
        "at_deg": {} if known is None else dict(zip(QUANTITIES, known.at_deg, strict=False)),
        "jumps": [
            {"at_deg": j.at_deg, "of": j.of, "jump": j.jump, "rows": j.rows, f"bound_{unit}": j.bound}
            for j in made.jumps
        ],
        "open": list(made.controller.open),
    }
    if known is not None and made.speed_rpm:
        result["at_speed"] = {"speed_rpm": made.speed_rpm} | {name: value for name, value, _ in per_time(made)}
    if made.cycle is not None:
        c = made.cycle
        result["cycle"] = {
            "acceleration_step": c.acceleration_step,
            "at_deg": c.at_deg,
            "dominates_above_rpm": c.dominates_above_rpm,
        }
    return result


def _padded(values: Sequence[float]) -> Any:
    return zip(QUANTITIES, [*values, None, None], strict=False)


def per_time(made: Ecam) -> list[tuple[str, float, str]]:
    """Errors of velocity and acceleration at the design's speed: name, value, unit."""
    assert made.deviation is not None
    unit, rate = made.slave.unit, 6.0 * abs(made.speed_rpm)
    rows = (
        (f"velocity_deviation_{unit}_s", rate, f"{'°' if unit == 'deg' else unit}/s"),
        ("acceleration_deviation_m_s2", 1e-3 * rate**2, "m/s²")
        if unit == "mm"
        else ("acceleration_deviation_deg_s2", rate**2, "°/s²"),
    )
    return [
        (name, value * factor, symbol)
        for (name, factor, symbol), value in zip(rows, made.deviation.values[1:], strict=False)
    ]


def text(made: Ecam) -> str:
    """For the terminal, and for the dialog."""
    unit = "°" if made.slave.unit == "deg" else made.slave.unit
    lines = [f"{made.rows} rows for {made.controller.label}, {made.interpolation}"]
    if made.deviation is None:
        lines.append(NOT_PUBLISHED)
    else:
        units = (unit, f"{unit}/deg", f"{unit}/deg²")
        for name, symbol, value, at in zip(
            ("position", "velocity", "acceleration"), units, made.deviation.values, made.deviation.at_deg, strict=False
        ):
            lines.append(f"largest error of the {name}: {value:.4g} {symbol} at {at:.6g} deg")
        if made.speed_rpm:
            lines += [
                f"at {made.speed_rpm:g} rpm: {value:.4g} {symbol} ({name.split('_')[0]})"
                for name, value, symbol in per_time(made)
            ]
    for jump in made.jumps:
        bound = "" if jump.bound is None else f", which leaves at most {jump.bound:.3g} {unit}"
        told = "both sides of it have a row" if jump.rows == 2 else f"one row for both sides{bound}"
        lines.append(f"the {jump.of} jumps by {jump.jump:.4g} at {jump.at_deg:.6g} deg: {told}")
    if made.cycle is not None:
        c, step = made.cycle, "m/s²" if made.slave.unit == "mm" else "°/s²"
        above = "at no speed" if c.dominates_above_rpm is None else f"above {c.dominates_above_rpm:.4g} rpm"
        lines.append(
            f"cycles of {made.request.cycle_ms:g} ms at {abs(made.speed_rpm):g} rpm: the acceleration steps by "
            f"{c.acceleration_step:.4g} {step} "
            f"at {c.at_deg:.6g} deg; {above} the cycle errs by more than the table"
        )
    lines += [f"open: {each}" for each in made.controller.open]
    return "\n".join(lines) + "\n"


# -- errors over the turn ----------------------------------------------------------------------------------

PER_PIECE, LEAST_POINTS = 24, 1200


@frozen(eq=False)
class Shown:
    """An error (n,) [unit, per degree], and the factor to the unit that it is shown in."""

    values: np.ndarray
    factor: float
    unit: str


@frozen(eq=False)
class Errors:
    """Errors of position, velocity and acceleration at angles x (n,) [deg]; None of what the controller's path has none."""

    x: np.ndarray
    shown: tuple[Shown | None, Shown | None, Shown | None]


def errors_over_turn(made: Ecam) -> Errors:
    """What the controller's path is above the exact curve, between all rows."""
    table, row = made.table, KINDS[made.interpolation]
    count = max(PER_PIECE, LEAST_POINTS // (table.x.size - 1))
    part = np.clip(np.linspace(0.0, 1.0, count), 1e-9, 1.0 - 1e-9)
    w = np.diff(table.x)[:, None] * part
    x = (table.x[:-1, None] + w).ravel()
    path = evaluated(row.coefficients(table)[:, :, None], w, row.derivatives).reshape(row.derivatives, -1)
    errors = path - made.slave.state(x, made.slave.piece_of(x), row.derivatives)
    unit, factor = ("µm", 1e3) if made.slave.unit == "mm" else ("0.001°", 1e3)
    units = (unit, f"{unit}/deg", f"{unit}/deg²")
    shown = [Shown(each, factor, symbol) for each, symbol in zip(errors, units, strict=False)]
    return Errors(x, (*shown, *([None] * (3 - len(shown)))))  # type: ignore[arg-type]


# -- error against number of rows --------------------------------------------------------------------------


def counts_of(low: int, most: int = MOST, count: int = COUNTS) -> np.ndarray:
    """Numbers of rows, each about as much larger than the one before."""
    return np.unique(np.round(np.geomspace(max(low, 1), max(most, low), count)).astype(int))


def error_curve(slave: Slave, kind: str, placing: str, most: int = MOST, closing: bool = True) -> dict[str, np.ndarray]:
    """Column -> (n,): errors of tables with so many rows, from the fewest that there can be. Empty for ``unknown``."""
    if kind == UNKNOWN:
        return {}
    limits, extra = (np.inf,) * 3, 0 if closing else 1
    placers = [Placer(slave, kind, limits, free=placing != EQUAL, kinks=kinks) for kinks in (False, True)]
    least = 4 if kind == "zebra" else placers[0].parts.size + placers[0].hairs.size - extra if placing != EQUAL else 2
    rows = counts_of(least, most)
    found = []
    for count in rows.tolist():
        pieces = count - 1 + extra
        if placing == EQUAL:
            found.append(placers[0].errors_at(equal(pieces)))
        else:
            pieces -= placers[0].hairs.size
            many = kind != "zebra" and pieces >= 2 * placers[1].parts.size
            found.append(placers[many].errors(pieces + (pieces % 2 if kind == "zebra" else 0)))
    columns = {"rows": rows.astype(float)}
    for i, name in enumerate(("deviation", "velocity_deviation", "acceleration_deviation")[: KINDS[kind].derivatives]):
        columns[name] = np.array([each[i] for each in found])
    return columns


def curve_csv(columns: dict[str, np.ndarray]) -> str:
    """The table of ``--curve``."""
    return csv(list(columns), list(columns.values()))
