"""The measured rows over the cam angle with the curve fitted to them, and what is left between the two."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.measured import QUANTITIES, MotionFit
from kindyna_gui.measured.request import symbol
from kindyna_gui.pictures.plots.ranges import shown_range
from kindyna_gui.pictures.plots.xy import WHOLE_TURN, Dots, Line, Rule, XYPlot
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import readable, short, with_unit

ANGLE = "Cam angle, °"
SMOOTH = np.linspace(0.0, 360.0, 1441)  # where the curve is drawn
MOST_DOTS = 4000  # of a table; of a longer one every so many rows are shown
DOT, SMALL_DOT, BAD_DOT = 4.0, 2.5, 7.0  # pixels
MANY = 400  # rows, from which on the small ones are drawn
ROOM = 1.15  # of the residuals' range, shown around it
BAND = np.array([-3.0, -1.0, 0.0, 1.0, 3.0])  # measuring errors around the curve that are shaded


def show_rows(plot: XYPlot, fit: MotionFit, order: int = 0) -> None:
    """The rows of a column and the curve of the motion through them; where the table has no such column, the curve alone.
    Around it the measuring error of the column is shaded."""
    family = QUANTITIES[order]
    index = next((i for i, each in enumerate(fit.columns) if each.column.order == order), None)
    if index is None:
        error, unit, values = (
            0.0,
            (f"{fit.motion.unit}/deg{'2' if order == 2 else ''}" if order else fit.motion.unit),
            None,
        )
        curve = fit.derivative(SMOOTH, order)
    else:
        column, error = fit.columns[index].column, fit.columns[index].error
        unit, values, curve = column.unit, column.values / column.size, fit.curve(SMOOTH, index)
    rung = readable(symbol(unit), float(np.nanmax(np.abs(curve if values is None else values))))
    colour = SCREEN.family(family)
    plot.name_axes("", f"{family.capitalize()}, {rung.symbol}", colour)
    dots = () if values is None else _dots(fit, values / rung.size, order)
    band = (SMOOTH, (curve + error * BAND[:, None]) / rung.size) if error else None
    shaded = "± 1 and 3 measuring errors" if order == fit.columns[0].column.order else ""
    plot.show_lines([Line(SMOOTH, curve / rung.size, colour, band=band)], dots=dots, shaded=shaded)
    known = [] if values is None else [values[np.isfinite(values)] / rung.size]
    plot.show_range(WHOLE_TURN, shown_range([*known, curve / rung.size], {family}, ()))


def show_residuals(plot: XYPlot, fit: MotionFit, index: int = 0) -> None:
    """What each row of a column is off the curve, between lines at the measuring error; rows far off stand at the edge."""
    each = fit.columns[index]
    order = each.column.order
    kept = np.delete(each.residuals, fit.spoiled.get(order, ()) if index else fit.left_out)
    far = ROOM * max(float(np.nanmax(np.abs(kept), initial=0.0)), 1.2 * each.error) or 1.0
    rung = readable(symbol(each.column.unit), far)
    edge, error = far / rung.size, each.error / rung.size
    texts = (with_unit(f"± {short(error, 3)}", rung.symbol), "") if error else ()
    rules = [Rule(at, text, SCREEN.limit, level=True) for at, text in zip((error, -error), texts, strict=False)]
    colour = SCREEN.family(each.column.quantity) if len(fit.columns) > 1 else ""
    plot.name_axes(ANGLE, f"Residual, {rung.symbol}", colour)
    dots = _dots(fit, np.clip(each.residuals / rung.size, -0.97 * edge, 0.97 * edge), order)
    plot.show_lines([], rules=rules, dots=dots)
    plot.show_range(WHOLE_TURN, (-edge, edge))


def _dots(fit: MotionFit, values: np.ndarray, order: int) -> Sequence[Dots]:
    """Of the rows, and larger ones of those that are wrong."""
    angles = fit.table.angles
    step = -(-angles.size // MOST_DOTS)
    wrong = [*fit.outliers.wrong, *(row for stretch in fit.outliers.undecided for row in stretch)]
    if order != fit.columns[0].column.order:
        wrong = list(fit.spoiled.get(order, ()))
    size = DOT if angles.size < MANY else SMALL_DOT
    return (
        Dots(angles[::step], values[::step], SCREEN.quiet, size, behind=True),
        Dots(angles[wrong], values[wrong], SCREEN.limit, BAD_DOT, behind=True),
    )
