"""A graph as a file: PNG, SVG or PDF."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QPoint
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QWidget

from core.output.graph.curves import GraphImage
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.paper import RATIO, png, svg
from kindyna_gui.pictures.plots.graph_plot import NO_BANDS, Bands, GraphPlot
from kindyna_gui.pictures.plots.graph_ranges import Shown
from kindyna_gui.pictures.sheet_file import UNITS, vector_pdf
from kindyna_gui.pictures.style import LIGHT

PIXEL = 0.26  # mm of paper that a pixel is


def graph_file(picture: GraphImage, shown: Shown | None = None, bands: Bands = NO_BANDS) -> bytes:
    """The file's bytes; shown: the part of the graph, None: all of it; bands: as ``show_graph``."""
    ensure_app(offscreen=True)
    raster = picture.ending == ".png"
    plot = GraphPlot(theme=replace(LIGHT, ratio=RATIO) if raster else LIGHT)
    plot.resize(picture.width, picture.height)
    plot.show_graph(picture.graph, picture.data, bands=bands)
    plot.grab()  # the axes find their sizes
    plot.show_part(shown or plot.shown)
    if raster:
        return png(plot)
    if picture.ending == ".svg":
        return svg(plot, picture.name)

    def paint(painter: QPainter) -> None:
        painter.scale(PIXEL * UNITS, PIXEL * UNITS)
        QWidget.render(plot, painter, QPoint())

    curves = ", ".join(each.name for each in picture.data.series)
    return vector_pdf(picture.name, f"Curves: {curves}", picture.width * PIXEL, picture.height * PIXEL, paint)


__all__ = ["graph_file"]
