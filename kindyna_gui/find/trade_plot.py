"""The trade-off of a search as a curve: what is reached over the value that it is bought with, limit and answer marked on it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyqtgraph as pg
from PySide6.QtGui import QPainterPath

from core.design import Design
from core.find import LIMITS, Solution
from kindyna_gui.find.texts import axis_title, typed_text, unit_of
from kindyna_gui.pictures.items import Outline, Tag
from kindyna_gui.pictures.plots.frame import Z_CURSOR, Z_LIMIT
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import DASHED
from kindyna_gui.pictures.units import short

DOT = 9  # pixels
ROOM = 1.6  # of the highest value that is marked, shown of a curve that goes on rising
MARK_DIGITS = 6  # of the answer beside its line
BESIDE = 0.03  # of the width, left free on both sides
APART = 3.0  # pixels between a line and its text

Rule = tuple[Outline, Tag, float]
"""A line across or upright, its text, and where it stands."""


class TradePlot(XYPlot):
    """A curve over one value, the limit across, the answer upright, and the present value as a ring."""

    def __init__(self) -> None:
        self._limit: Rule | None = None
        self._answer: Rule | None = None
        self._dots: list[pg.ScatterPlotItem] = []
        self.points: dict[str, tuple[float, float]] = {}
        super().__init__("", "")
        self.setMinimumSize(220, 110)

    def show_solution(self, design: Design, solution: Solution) -> None:
        """Draw what a search has found; nothing of another before it is left."""
        path, key = next(iter(solution.answer)), solution.curve_of
        low, high = solution.near
        curve = np.array([point for point in solution.curve if low <= point[0] <= high])
        x, y = curve[:, 0], np.where(np.isfinite(curve[:, 1]), curve[:, 1], np.nan)
        limit = solution.limits.get(key)
        answer = (solution.answer[path], solution.reached.get(key, solution.answer.get(key, np.nan)))
        now = (solution.present[path], solution.before.get(key, solution.present.get(key)))
        if key in solution.answer:  # another field that is varied: the first one is what it is bought with
            path, key, x, y, answer, now = key, path, y, x, answer[::-1], now[::-1]
        self.name_axes(axis_title(design, path), axis_title(design, key))
        colour = self._theme.family("pressure-angle" if key in LIMITS and LIMITS[key].most else "curvature")
        self.show_lines([Line(x, _what_matters(y, [answer[1], now[1], limit]), colour)])
        beside = BESIDE * float(np.ptp(x))  # else a dot at the end of the curve is cut
        self._view.setRange(xRange=(float(x.min()) - beside, float(x.max()) + beside), padding=0.0)
        if now[0] is not None and now[1] is not None and np.isfinite(now[1]):
            self.points["now"] = (now[0], now[1])
            self._dot(self.points["now"], filled=False)
        self.points["answer"] = answer
        self._dot(answer, filled=True)
        if limit is not None:
            text = f"limit {typed_text(limit, unit_of(design, key))}" if limit or key not in LIMITS else "undercut"
            self._limit = self._rule_off(text, limit, self._theme.limit)
        self._answer = self._rule_off(short(answer[0], min(MARK_DIGITS, solution.digits)), answer[0], self._theme.ink)
        self._lay()

    def _rule_off(self, text: str, at: float, colour: str) -> Rule:
        """A line with a text."""
        tag = Tag(text, colour, self._theme, backing=True)
        self._include(tag, Z_CURSOR)
        return self._outline(colour, Z_LIMIT, DASHED), tag, at

    @property
    def limit(self) -> float | None:
        """Where the limit is drawn."""
        return None if self._limit is None else self._limit[2]

    def _dot(self, at: tuple[float, float], filled: bool) -> None:
        colour = self._theme.ink
        dot = pg.ScatterPlotItem(
            [at[0]], [at[1]], size=DOT, pen=self._theme.pen(colour), brush=colour if filled else self._theme.paper
        )
        self._include(dot, Z_CURSOR)
        self._dots.append(dot)

    def _clear(self) -> None:
        super()._clear()
        for dot in self._dots:
            self._view.removeItem(dot)
        for rule in (self._limit, self._answer):
            if rule is not None:
                self._view.removeItem(rule[0])
                self._view.removeItem(rule[1])
        self._dots, self._limit, self._answer, self.points = [], None, None, {}

    def _lay(self, *args: object) -> None:
        super()._lay(*args)
        frame = self.frame()
        if self._limit is not None:
            line, tag, at = self._limit
            line.redraw(_line((frame.first, at), (frame.last, at)))
            above = frame.height - frame.pixel(at) > tag.size[1] + APART
            tag.set_lean(1.0, 1.0 if above else 0.0)
            tag.shift(-APART, -APART if above else APART)
            tag.setPos(frame.last, at)
        if self._answer is not None:
            line, tag, at = self._answer
            line.redraw(_line((at, frame.low), (at, frame.high)))
            right = (frame.last - at) / (frame.last - frame.first) * frame.width > tag.size[0] + APART
            tag.set_lean(0.0 if right else 1.0, 1.0)
            tag.shift(APART if right else -APART, -APART)
            tag.setPos(at, frame.low)


def _what_matters(y: np.ndarray, pins: Sequence[float | None]) -> np.ndarray:
    """The values (n,) without those that are far above or below all that are marked, else these would be seen at one height."""
    marked = [value for value in pins if value is not None and np.isfinite(value)]
    most = ROOM * max((abs(value) for value in marked), default=np.inf)
    near = np.where(np.abs(y) <= most, y, np.nan) if most > 0.0 else y
    return near if np.isfinite(near).sum() > 1 else y


def _line(start: tuple[float, float], end: tuple[float, float]) -> QPainterPath:
    path = QPainterPath()
    path.moveTo(*start)
    path.lineTo(*end)
    return path
