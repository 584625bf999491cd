"""Facts about a table for a controller, as JSON and text; its errors over the turn and over the number of rows."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.frozen import frozen
from core.number_text import result_text
from core.output.controllers.errors import QUANTITIES
from core.output.controllers.placing import RowPlacer, equal_steps
from core.output.controllers.rows import KINDS, UNKNOWN, evaluate
from core.output.controllers.slave import EQUAL, Slave
from core.output.controllers.table import NOT_PUBLISHED, Ecam
from core.output.export import csv

COUNTS = 60
MOST = 5000


def facts(cam: Ecam) -> dict[str, Any]:
    """Facts for ``ecam --json``; errors in the motion's unit, per degree and degree² of the master."""
    unit, deviation = cam.slave.unit, cam.deviation
    values = dict(zip(QUANTITIES, [*(() if deviation is None else deviation.values), None, None, None], strict=False))
    result: dict[str, Any] = {
        "controller": cam.controller.slug,
        "interpolation": cam.interpolation,
        "rows": cam.rows,
        "certified": deviation is not None,
        "reason": NOT_PUBLISHED if deviation is None else "",
        f"deviation_{unit}": values["deviation"],
        "velocity_deviation": values["velocity"],
        "acceleration_deviation": values["acceleration"],
        "at_deg": {} if deviation is None else dict(zip(QUANTITIES, deviation.at_deg, strict=False)),
        "jumps": [
            {"at_deg": j.at_deg, "of": j.of, "jump": j.jump, "rows": j.rows, f"bound_{unit}": j.bound}
            for j in cam.jumps
        ],
        "open": list(cam.controller.open),
    }
    if deviation is not None and cam.speed_rpm:
        result["at_speed"] = {"speed_rpm": cam.speed_rpm} | {name: value for name, value, _ in errors_at_speed(cam)}
    if cam.cycle is not None:
        c = cam.cycle
        result["cycle"] = {
            "acceleration_step": c.acceleration_step,
            "at_deg": c.at_deg,
            "dominates_above_rpm": c.dominates_above_rpm,
        }
    return result


def errors_at_speed(cam: Ecam) -> list[tuple[str, float, str]]:
    """Errors of velocity and acceleration at the design's speed: name, value, unit."""
    assert cam.deviation is not None
    unit, rate = cam.slave.unit, 6.0 * abs(cam.speed_rpm)
    rows = (
        (f"velocity_deviation_{unit}_s", rate, f"{'°' if unit == 'deg' else unit}/s"),
        ("acceleration_deviation_m_s2", 1e-3 * rate**2, "m/s²")
        if unit == "mm"
        else ("acceleration_deviation_deg_s2", rate**2, "°/s²"),
    )
    return [
        (name, value * factor, symbol)
        for (name, factor, symbol), value in zip(rows, cam.deviation.values[1:], strict=False)
    ]


def text(cam: Ecam) -> str:
    """Facts for the terminal and the dialog."""
    unit = "°" if cam.slave.unit == "deg" else cam.slave.unit
    lines = [f"{cam.rows} rows for {cam.controller.label}, {cam.interpolation}"]
    if cam.deviation is None:
        lines.append(NOT_PUBLISHED)
    else:
        units = (unit, f"{unit}/deg", f"{unit}/deg²")
        for name, symbol, value, at in zip(
            ("position", "velocity", "acceleration"), units, cam.deviation.values, cam.deviation.at_deg, strict=False
        ):
            lines.append(f"largest error of the {name}: {result_text(value)} {symbol} at {result_text(at)} deg")
        if cam.speed_rpm:
            lines += [
                f"at {cam.speed_rpm:g} rpm: {result_text(value)} {symbol} ({name.split('_')[0]})"
                for name, value, symbol in errors_at_speed(cam)
            ]
    for jump in cam.jumps:
        bound = "" if jump.bound is None else f", with an error of at most {result_text(jump.bound, 3)} {unit}"
        rows_text = "both sides of it have a row" if jump.rows == 2 else f"one row for both sides{bound}"
        lines.append(f"the {jump.of} jumps by {result_text(jump.jump)} at {result_text(jump.at_deg)} deg: {rows_text}")
    if cam.cycle is not None:
        c, step = cam.cycle, "m/s²" if cam.slave.unit == "mm" else "°/s²"
        above = "at no speed" if c.dominates_above_rpm is None else f"above {result_text(c.dominates_above_rpm)} rpm"
        lines.append(
            f"cycles of {cam.request.cycle_ms:g} ms at {abs(cam.speed_rpm):g} rpm: the acceleration steps by "
            f"{result_text(c.acceleration_step)} {step} "
            f"at {result_text(c.at_deg)} deg; {above} the error of the cycle exceeds that of the table"
        )
    lines += [f"open: {fact}" for fact in cam.controller.open]
    return "\n".join(lines) + "\n"


# -- errors over the turn ----------------------------------------------------------------------------------

PER_PIECE, LEAST_POINTS = 24, 1200


@frozen(eq=False)
class ErrorCurve:
    """An error over the turn.

    Attributes
    ----------
    values : (n,) error [unit, per degree]
    factor, unit : factor to the unit on display, and that unit
    """

    values: np.ndarray
    factor: float
    unit: str


@frozen(eq=False)
class ErrorCurves:
    """Errors over the turn.

    Attributes
    ----------
    x : (n,) master angles [deg]
    curves : errors of position, velocity and acceleration; None for a derivative that the interpolation lacks
    """

    x: np.ndarray
    curves: tuple[ErrorCurve | None, ErrorCurve | None, ErrorCurve | None]


def errors_over_turn(cam: Ecam) -> ErrorCurves:
    """Controller's path less the exact curve, between all rows."""
    table, row = cam.table, KINDS[cam.interpolation]
    count = max(PER_PIECE, LEAST_POINTS // (table.x.size - 1))
    part = np.clip(np.linspace(0.0, 1.0, count), 1e-9, 1.0 - 1e-9)
    w = np.diff(table.x)[:, None] * part
    x = (table.x[:-1, None] + w).ravel()
    path = evaluate(row.coefficients(table)[:, :, None], w, row.derivatives).reshape(row.derivatives, -1)
    errors = path - cam.slave.state(x, cam.slave.piece_of(x), row.derivatives)
    unit, factor = ("µm", 1e3) if cam.slave.unit == "mm" else ("0.001°", 1e3)
    units = (unit, f"{unit}/deg", f"{unit}/deg²")
    curves = [ErrorCurve(values, factor, symbol) for values, symbol in zip(errors, units, strict=False)]
    return ErrorCurves(x, (*curves, *([None] * (3 - len(curves)))))  # type: ignore[arg-type]


# -- error against number of rows --------------------------------------------------------------------------


def row_counts(low: int, most: int = MOST, count: int = COUNTS) -> np.ndarray:
    """Numbers of rows in geometric progression.

    Returns
    -------
    ndarray (k,), dimensionless
    """
    return np.unique(np.round(np.geomspace(max(low, 1), max(most, low), count)).astype(int))


def error_curve(slave: Slave, kind: str, placing: str, most: int = MOST, closing: bool = True) -> dict[str, np.ndarray]:
    """Errors of tables over the number of rows, from the fewest possible; empty for ``unknown``.

    Returns
    -------
    dict of str to ndarray (k,) [unit, per degree]
        Column -> values; rows are dimensionless.
    """
    if kind == UNKNOWN:
        return {}
    limits, extra = (np.inf,) * 3, 0 if closing else 1
    placers = [RowPlacer(slave, kind, limits, free=placing != EQUAL, kinks=kinks) for kinks in (False, True)]
    least = 4 if kind == "zebra" else placers[0].parts.size + placers[0].splits.size - extra if placing != EQUAL else 2
    rows = row_counts(least, most)
    errors = []
    for count in rows.tolist():
        pieces = count - 1 + extra
        if placing == EQUAL:
            errors.append(placers[0].errors_at(equal_steps(pieces)))
        else:
            pieces -= placers[0].splits.size
            many = kind != "zebra" and pieces >= 2 * placers[1].parts.size
            errors.append(placers[many].errors(pieces + (pieces % 2 if kind == "zebra" else 0)))
    columns = {"rows": rows.astype(float)}
    for i, name in enumerate(("deviation", "velocity_deviation", "acceleration_deviation")[: KINDS[kind].derivatives]):
        columns[name] = np.array([error[i] for error in errors])
    return columns


def curve_csv(columns: dict[str, np.ndarray]) -> str:
    """Table of ``--curve`` as CSV.

    Parameters
    ----------
    columns : dict of str to ndarray (k,) [unit, per degree]
    """
    return csv(list(columns), list(columns.values()))
