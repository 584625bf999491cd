"""The measured rows over the cam angle with the curve fitted to them, and what is left between the two."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyqtgraph as pg

from core.measured import Fit
from kindyna_gui.measured.request import symbol
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.plots.background import Z_CURSOR, Z_CURVE, LimitLine, angle_ticks, value_ticks
from kindyna_gui.pictures.plots.fixed_plot import FixedPlot
from kindyna_gui.pictures.plots.ranges import shown_range
from kindyna_gui.pictures.style import LIGHT, TEXT, THIN, Theme, brush, no_pen
from kindyna_gui.pictures.units import readable, short, with_unit

SMOOTH = np.linspace(0.0, 360.0, 1441)  # where the curve is drawn
MOST_DOTS = 4000  # of a table; of a longer one every so many rows are shown
DOT, SMALL_DOT, BAD_DOT = 4.0, 2.5, 7.0  # pixels
MANY = 400  # rows, from which on the small ones are drawn
ROOM = 1.15  # of the residuals' range, shown around it


class MeasuredPlot(FixedPlot):
    """Dots and, where there is one, a curve over one turn. angles: whether the cam angle's numbers stand below."""

    def __init__(self, angles: bool, theme: Theme = LIGHT) -> None:
        super().__init__(theme=theme)
        self.show_numbers(angles, "Cam angle, °")
        self.dots, self.bad = (self._scatter(DOT, theme.quiet), self._scatter(BAD_DOT, theme.limit))
        self.line = pg.PlotCurveItem()
        self.cursor = pg.InfiniteLine(0.0, 90.0, theme.pen(theme.quiet))
        self.cursor.hide()
        self._include(self.line, Z_CURVE)
        self._include(self.cursor, Z_CURSOR)
        self.limits: list[LimitLine] = []
        self._title, self._colour = "", theme.ink

    def _scatter(self, size: float, colour: str) -> pg.ScatterPlotItem:
        item = pg.ScatterPlotItem(size=size, pen=no_pen(), brush=brush(colour), antialias=True)
        self._include(item, Z_CURVE - 1.0)
        return item

    # -- what is drawn --------------------------------------------------------------------------------------

    def show_rows(self, fit: Fit) -> None:
        """The rows of the table and the curve through them."""
        family = fit.table.layout.quantity
        values, curve = fit.table.values / fit.table.size, fit.curve(SMOOTH)
        rung = readable(symbol(fit.table.unit), float(np.abs(values).max()))
        colour = self._theme.family(family)
        self.line.setData(
            SMOOTH, curve / rung.size, pen=self._theme.pen(colour, THIN), antialias=True, skipFiniteCheck=True
        )
        low, high = shown_range([values / rung.size, curve / rung.size], {family}, ())
        self._show(fit, values / rung.size, (low, high), f"{family.capitalize()}, {rung.symbol}", colour)

    def show_residuals(self, fit: Fit) -> None:
        """What each row is off the curve, between lines at the measuring error; rows far off stand at the edge."""
        kept = np.delete(fit.residuals, fit.left_out)
        far = ROOM * max(float(np.abs(kept).max()), 1.2 * fit.error) or 1.0
        rung = readable(symbol(fit.table.unit), far)
        self.line.setData([], [])
        edge = far / rung.size
        shown = np.clip(fit.residuals / rung.size, -0.97 * edge, 0.97 * edge)
        error = fit.error / rung.size
        lines = ((error, with_unit(f"± {short(error, 3)}", rung.symbol)), (-error, ""))
        self._show(fit, shown, (-edge, edge), f"Residual, {rung.symbol}", self._theme.ink, lines if error else ())

    def _show(
        self,
        fit: Fit,
        values: np.ndarray,
        sides: tuple[float, float],
        title: str,
        colour: str,
        lines: Sequence[tuple[float, str]] = (),
    ) -> None:
        angles = fit.table.angles
        step = -(-angles.size // MOST_DOTS)
        wrong = [*fit.outliers.wrong, *(row for stretch in fit.outliers.undecided for row in stretch)]
        self.dots.setData(x=angles[::step], y=values[::step], size=DOT if angles.size < MANY else SMALL_DOT)
        self.bad.setData(x=angles[wrong], y=values[wrong])
        for old in self.limits:
            old.remove(self._view)
        self.limits = [LimitLine(self._view, self._theme, value, text) for value, text in lines]
        self._title, self._colour, self._message_text = title, self._theme.letters(colour), ""
        self._view.setRange(yRange=sides, padding=0.0)
        self._lay()

    def show_message(self, text: str) -> None:
        """Nothing but a text in the middle."""
        for item in (self.dots, self.bad, self.line):
            item.setData([], [])
        for old in self.limits:
            old.remove(self._view)
        self.limits, self._title, self._message_text = [], "", text
        self.cursor.hide()
        self._view.setRange(yRange=(0.0, 1.0), padding=0.0)
        self._lay()

    def point_out(self, angle: float | None) -> None:
        """A line at a cam angle [deg]; None: none."""
        self.cursor.setVisible(angle is not None)
        if angle is not None:
            self.cursor.setValue(angle)

    # -- layout ---------------------------------------------------------------------------------------------

    def _lay(self, *_: object) -> None:
        frame = self.frame()
        values = value_ticks(frame.low, frame.high, frame.height) if self._title else []
        self._rule(frame, angle_ticks(frame.width), values)
        fits = text_size(self._title, TEXT)[0] <= frame.height
        self._axes["left"].show_title(self._title if fits else self._title.rpartition(", ")[2], self._colour)
        for limit in self.limits:
            limit.lay(frame.low, frame.high, frame.height)
