"""The picture of README.md: of every kernel, run time over true error, each by what KINDYNA takes at most, on logarithmic axes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from benchmarks.measuring import WARM, Row
from benchmarks.ratios import Told, power
from benchmarks.table import Kernel, kernels
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QGridLayout, QLabel

from core.output.drawing.palette import BLUE, GREEN, ORANGE, PURPLE, VERMILION
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.painter import MARGIN, RATIO, PaperSheet, png
from kindyna_gui.pictures.plots.xy import Dots, Line, XYPlot
from kindyna_gui.pictures.style import LIGHT, Theme
from kindyna_gui.screenshots import small_file

COLUMNS, CELL = 3, (290, 196)  # pixels: three beside each other are as wide as a page of GitHub
ERRORS = (-16.0, -2.0)  # powers of ten that are shown
LABEL = 11
COMPILED = {"compiled by numba", "odeint"}
TABLES = {"linear table by even steps", "nearest value of a table", "quintic table", "cubic spline"}
KINDS = (
    ("KINDYNA", VERMILION, lambda kernel, name: name == kernel.ours.name),
    ("compiled: numba, odeint", PURPLE, lambda kernel, name: name in COMPILED),
    ("tables and splines, made before", GREEN, lambda kernel, name: name in TABLES),
    ("numpy by hand", BLUE, lambda kernel, name: "by hand" in name or "on paper" in name),
    ("another method in numpy or scipy", ORANGE, lambda kernel, name: True),
)  # fmt: skip
"""Kind, its colour, and which methods are of it: the first that says so."""


def _powers(ends: tuple[float, float], step: int) -> list[tuple[float, str]]:
    """Ticks of an axis whose numbers are logarithms."""
    return [(float(e), power(e)) for e in range(math.ceil(ends[0]), math.floor(ends[1]) + 1) if not e % step]


def _best(told: Told, name: str) -> list[Row]:
    """Of a method's settings those that no other is as quick and as exact as, from the most exact."""
    kept: list[Row] = []
    for row in sorted(told.of_method(name, WARM), key=lambda row: (max(row.error, 1e-16), row.seconds)):
        if not kept or row.seconds < kept[-1].seconds:
            kept.append(row)
    return kept


def _plot(kernel: Kernel, rows: Sequence[Row], theme: Theme) -> XYPlot | None:
    told = Told.of(kernel, rows)
    ours = told.of_method(kernel.ours.name, WARM)
    if not ours:
        return None
    unit, lines, dots = min(row.seconds for row in ours), [], []
    for name in [*told.rivals, kernel.ours.name]:
        colour = next(colour for _, colour, has in KINDS if has(kernel, name))
        best = [row for row in _best(told, name) if row.error <= 10.0 ** ERRORS[1]]
        x = np.log10([max(row.error, 10.0 ** ERRORS[0]) for row in best])
        y = np.log10([row.seconds / unit for row in best])
        lines.append(Line(x, y, colour))
        dots.append(Dots(x, y, colour, 9.0 if name == kernel.ours.name else 6.0))
    plot = XYPlot("largest error", "time", theme=theme)
    plot.setFixedSize(*CELL)
    plot.show_lines(lines, dots=dots, fit=True)
    every = np.concatenate([line.y for line in lines])
    across = ERRORS[0] - 0.4, ERRORS[1] + 0.4
    upwards = min(-1.2, float(every.min()) - 0.2), max(0.6, float(every.max()) + 0.2)
    plot.show_range(across, upwards)
    plot.show_ticks(_powers(across, 4), _powers(upwards, 1))
    return plot


def picture(rows: Sequence[Row]) -> bytes:
    """PNG."""
    ensure_app(offscreen=True)
    theme = replace(LIGHT, ratio=RATIO)
    sheet = PaperSheet(theme)
    grid = QGridLayout(sheet)
    grid.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
    grid.setVerticalSpacing(2)
    style = f"color: {theme.ink}; font-size: {LABEL}px"
    legend = " &nbsp; ".join(f'<span style="color: {colour}">●</span> {name}' for name, colour, _ in KINDS)
    head = "Run time, as a multiple of KINDYNA's quickest, over the largest error against 50-digit values: left and low is better."
    grid.addWidget(QLabel(f"{head}<br>{legend}", styleSheet=style), 0, 0, 1, COLUMNS)
    shown = [(kernel, plot) for kernel in kernels() if (plot := _plot(kernel, rows, theme)) is not None]
    for i, (kernel, plot) in enumerate(shown):
        row, column = divmod(i, COLUMNS)
        grid.addWidget(QLabel(kernel.title, styleSheet=f"{style}; font-weight: bold"), 2 * row + 1, column)
        grid.addWidget(plot, 2 * row + 2, column)
    sheet.adjustSize()
    return small_file(QImage.fromData(png(sheet)), "PNG")
