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


def show_rows(plot: XYPlot, fit: MotionFit, order: int = 0) -> None:
    """The rows of a column and the curve of the motion through them; where the table has no such column, the curve alone."""
    family = QUANTITIES[order]
    index = next((i for i, each in enumerate(fit.columns) if each.column.order == order), None)
    if index is None:
        unit, values = (f"{fit.motion.unit}/deg{'2' if order == 2 else ''}" if order else fit.motion.unit), None
        curve = fit.derivative(SMOOTH, order)
    else:
        column = fit.columns[index].column
        unit, values, curve = column.unit, column.values / column.size, fit.curve(SMOOTH, index)
    rung = readable(symbol(unit), float(np.nanmax(np.abs(curve if values is None else values))))
    colour = SCREEN.family(family)
    plot.name_axes("", f"{family.capitalize()}, {rung.symbol}", colour)
    dots = () if values is None else _dots(fit, values / rung.size, order)
    plot.show_lines([Line(SMOOTH, curve / rung.size, colour)], dots=dots)
    known = [] if values is None else [values[np.isfinite(values)] / rung.size]
    plot.show_range(WHOLE_TURN, shown_range([*known, curve / rung.size], {family}, ()))


def show_residuals(plot: XYPlot, fit: MotionFit) -> None:
    """What each row is off the curve, between lines at the measuring error; rows far off stand at the edge."""
    kept = np.delete(fit.residuals, fit.left_out)
    far = ROOM * max(float(np.abs(kept).max()), 1.2 * fit.error) or 1.0
    rung = readable(symbol(fit.table.unit), far)
    edge, error = far / rung.size, fit.error / rung.size
    texts = (with_unit(f"± {short(error, 3)}", rung.symbol), "") if error else ()
    rules = [Rule(at, text, SCREEN.limit, level=True) for at, text in zip((error, -error), texts, strict=False)]
    plot.name_axes(ANGLE, f"Residual, {rung.symbol}")
    plot.show_lines([], rules=rules, dots=_dots(fit, np.clip(fit.residuals / rung.size, -0.97 * edge, 0.97 * edge)))
    plot.show_range(WHOLE_TURN, (-edge, edge))


def _dots(fit: MotionFit, values: np.ndarray, order: int | None = None) -> Sequence[Dots]:
    """Of the rows, and larger ones of those that are wrong."""
    angles = fit.table.angles
    step = -(-angles.size // MOST_DOTS)
    wrong = [*fit.outliers.wrong, *(row for stretch in fit.outliers.undecided for row in stretch)]
    if order is not None and order != fit.columns[0].column.order:
        wrong = list(fit.spoiled.get(order, ()))
    size = DOT if angles.size < MANY else SMALL_DOT
    return (
        Dots(angles[::step], values[::step], SCREEN.quiet, size, behind=True),
        Dots(angles[wrong], values[wrong], SCREEN.limit, BAD_DOT, behind=True),
    )
