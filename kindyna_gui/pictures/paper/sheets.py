"""Sheets, tables, graphs as files."""

from __future__ import annotations

import math
import re
import uuid
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape

import numpy as np
from PySide6.QtCore import (
    QBuffer,
    QByteArray,
    QHashSeed,
    QIODevice,
    QMarginsF,
    QPoint,
    QPointF,
    QRect,
    QRectF,
    QSize,
    QSizeF,
    Qt,
    QUuid,
)
from PySide6.QtGui import (
    QBrush,
    QColor,
    QFont,
    QFontMetricsF,
    QImage,
    QPageSize,
    QPaintDevice,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPdfWriter,
    QPen,
    QPolygonF,
)
from PySide6.QtSvg import QSvgGenerator, QSvgRenderer
from PySide6.QtWidgets import QGridLayout, QLabel, QVBoxLayout, QWidget

from core.output.files.cam_drawing import ENDINGS
from core.output.files.sheet import (
    LINE_KINDS,
    SVG,
    ArrowHead,
    BezierLoop,
    DrawingSheet,
    Logo,
    SheetCircle,
    SheetLine,
    SheetLogo,
    SheetText,
)
from core.output.graph.curves import GraphImage
from core.papers import FigureTable
from core.study import Quantity, Study
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.painter import MARGIN, RATIO, PaperSheet, png, svg
from kindyna_gui.pictures.plots.curves import NO_BANDS
from kindyna_gui.pictures.plots.graph import NO_CHANNEL_BANDS, Bands, GraphPlot
from kindyna_gui.pictures.plots.graph_ranges import GraphRange
from kindyna_gui.pictures.plots.polar import PolarPlot
from kindyna_gui.pictures.plots.quantities import channel_extremes
from kindyna_gui.pictures.plots.xy import XYPlot
from kindyna_gui.pictures.style import LIGHT, SMALL, TEXT, THIN, Theme, font
from kindyna_gui.pictures.units import UNSEEN

if TYPE_CHECKING:
    from core.stability import Figure


# -- a logo on paper, as large as its box lets it be -----------------------------------------------------


def paint_logo(painter: QPainter, logo: Logo, box: QRectF) -> None:
    """Its proportions kept, at the right edge of the box and half way up."""
    drawn = QSvgRenderer(QByteArray(logo.data)) if logo.kind == SVG else QImage.fromData(logo.data)
    size = QSizeF(drawn.defaultSize() if isinstance(drawn, QSvgRenderer) else drawn.size())
    size.scale(box.size(), Qt.AspectRatioMode.KeepAspectRatio)
    room = QRectF(box.right() - size.width(), box.center().y() - 0.5 * size.height(), size.width(), size.height())
    if isinstance(drawn, QSvgRenderer):
        drawn.render(painter, room)
    else:
        painter.drawImage(room, drawn)


# -- sheet file ------------------------------------------------------------------------------------------

UNITS_PER_MM = 100.0  # of the painter, a millimetre
DPI = 2540  # at which that is so
CAPITALS = 0.729  # height of a capital, of the size of the font
SLIM = 0.15  # half the width of an arrowhead, of its length
INK, PAPER = "#000000", "#ffffff"
LETTERS = re.compile(
    rb"beginbfrange.*?endbfrange", re.DOTALL
)  # what the shapes of a font mean: a space is called a tab by Qt
PLACES = re.compile(rb"^\d{10}(?= \d{5} n)", re.MULTILINE)  # of the objects, in the table at the end
START = re.compile(rb"(startxref\n)(\d+)")  # of that table
DATES = re.compile(rb"/(?:CreationDate|ModDate) \([^)]*\)")


class SheetPainter:
    """Paints the items of a sheet on a device of ``DPI``."""

    def __init__(self, painter: QPainter, height: float) -> None:
        """height: of the sheet [mm]."""
        self._painter, self._height = painter, height

    def paint(self, sheet: DrawingSheet) -> None:
        for item in sheet.items:
            PAINTED[type(item)](self, item)

    def _at(self, z: complex) -> QPointF:
        return QPointF(UNITS_PER_MM * z.real, UNITS_PER_MM * (self._height - z.imag))

    def line(self, item: SheetLine) -> None:
        self._painter.setPen(_pen(item.kind))
        self._painter.drawPolyline(QPolygonF([self._at(z) for z in item.points]))

    def circle(self, item: SheetCircle) -> None:
        """A circle of the sheet."""
        middle, radius = self._at(item.centre), UNITS_PER_MM * item.radius
        box = QRectF(middle.x() - radius, middle.y() - radius, 2.0 * radius, 2.0 * radius)
        path = QPainterPath()
        path.arcMoveTo(box, item.start_deg)
        path.arcTo(box, item.start_deg, item.span_deg)
        self._path(path, item.kind)

    def curve(self, item: BezierLoop) -> None:
        """A closed curve of cubic pieces, as one path."""
        path = QPainterPath(self._at(complex(item.points[0, 0])))
        for _, a, b, c in item.points.tolist():
            path.cubicTo(self._at(a), self._at(b), self._at(c))
        path.closeSubpath()
        self._path(path, item.kind)

    def _path(self, path: QPainterPath, kind: str) -> None:
        self._painter.setPen(_pen(kind))
        self._painter.setBrush(Qt.BrushStyle.NoBrush)
        self._painter.drawPath(path)

    def arrow(self, item: ArrowHead) -> None:
        """The filled head of an arrow."""
        back = item.tip - item.length * item.direction
        across = 1j * SLIM * item.length * item.direction
        self._painter.setPen(Qt.PenStyle.NoPen)
        self._painter.setBrush(QBrush(QColor(INK)))
        self._painter.drawPolygon(QPolygonF([self._at(z) for z in (item.tip, back + across, back - across)]))

    def logo(self, item: SheetLogo) -> None:
        """A picture between two corners."""
        paint_logo(self._painter, item.logo, QRectF(self._at(item.low), self._at(item.high)).normalized())

    def text(self, item: SheetText) -> None:
        face = _font(item.height)
        width = QFontMetricsF(face, self._painter.device()).horizontalAdvance(item.text)
        room = UNITS_PER_MM * item.room
        narrow = min(1.0, room / width) if width else 1.0
        self._painter.save()
        self._painter.setFont(face)
        self._painter.setPen(QColor(INK))
        self._painter.translate(self._at(item.at))
        self._painter.scale(narrow, 1.0)
        self._painter.drawText(QPointF(-item.align * width, 0.0), item.text)
        self._painter.restore()


PAINTED: Mapping[type, Callable[[SheetPainter, Any], None]] = MappingProxyType(
    {
        SheetLine: SheetPainter.line, SheetCircle: SheetPainter.circle, BezierLoop: SheetPainter.curve, ArrowHead: SheetPainter.arrow,
        SheetLogo: SheetPainter.logo, SheetText: SheetPainter.text,
    }
)  # fmt: skip


@cache
def _pen(kind: str) -> QPen:
    row = LINE_KINDS[kind]
    width = UNITS_PER_MM * row.width
    pen = QPen(QColor(INK), width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.FlatCap, Qt.PenJoinStyle.MiterJoin)
    if row.dashes:
        pen.setDashPattern([UNITS_PER_MM * dash / width for dash in row.dashes])
    return pen


def _font(height: float) -> QFont:
    """Whose capitals have this height [mm]."""
    return font(round(UNITS_PER_MM * height / CAPITALS))


def _on(device: QPaintDevice, paint: Callable[[QPainter], None]) -> None:
    painter = QPainter(device)
    try:
        paint(painter)
    finally:
        painter.end()


def paint_sheet(painter: QPainter, sheet: DrawingSheet, room: QRect) -> None:
    """The sheet as a white page in the middle of the room, as large as it fits."""
    factor = min(room.width() / sheet.width, room.height() / sheet.height) / UNITS_PER_MM
    page = QRectF(0.0, 0.0, UNITS_PER_MM * sheet.width, UNITS_PER_MM * sheet.height)
    painter.save()
    painter.translate(QRectF(room).center() - page.center() * factor)
    painter.scale(factor, factor)
    painter.fillRect(page, QColor(PAPER))
    SheetPainter(painter, sheet.height).paint(sheet)
    painter.restore()


def vector_svg(title: str, about: str, width: float, height: float, paint: Callable[[QPainter], None]) -> bytes:
    """A page of so many mm as SVG; ``paint`` paints in hundredths of a millimetre."""
    data = QByteArray()
    generator = QSvgGenerator()
    buffer = QBuffer(data)
    generator.setOutputDevice(buffer)
    generator.setResolution(DPI)
    size = QSize(round(UNITS_PER_MM * width), round(UNITS_PER_MM * height))
    generator.setSize(size)
    generator.setViewBox(QRect(0, 0, size.width(), size.height()))
    generator.setTitle(title)
    generator.setDescription(about)
    _on(generator, paint)
    return bytes(data.data())


def vector_pdf(title: str, about: str, width: float, height: float, *pages: Callable[[QPainter], None]) -> bytes:
    """The same as PDF, of as many pages, without the time at which it was written: the same pages give the same bytes."""
    QHashSeed.setDeterministicGlobalSeed()  # several fonts are written in the order of their hashes
    try:
        data = _pdf(title, about, width, height, pages)
    finally:
        QHashSeed.resetRandomGlobalSeed()
    return LETTERS.sub(lambda found: found[0].replace(b"<0009>", b"<0020>"), without_dates(data))


def _pdf(title: str, about: str, width: float, height: float, pages: Sequence[Callable[[QPainter], None]]) -> bytes:
    data = QByteArray()
    buffer = QBuffer(data)
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    writer = QPdfWriter(buffer)
    writer.setResolution(DPI)
    writer.setPageSize(
        QPageSize(QSizeF(width, height), QPageSize.Unit.Millimeter, "", QPageSize.SizeMatchPolicy.ExactMatch)
    )
    writer.setPageMargins(QMarginsF(0.0, 0.0, 0.0, 0.0))
    writer.setTitle(title)
    writer.setCreator("KINDYNA")
    writer.setDocumentXmpMetadata(_xmp(title, about))
    writer.setDocumentId(_identity(title, about))

    def paint(painter: QPainter) -> None:
        for number, each in enumerate(pages):
            if number:
                writer.newPage()
            each(painter)

    _on(writer, paint)
    buffer.close()
    return bytes(data.data())


def without_dates(data: bytes) -> bytes:
    """A PDF without the time at which it was written, whose length depends on the time zone: what the table at the end says of
    places behind it is moved."""
    body, mark, table = data.rpartition(b"\nxref\n")
    cuts = [(found.start(), len(found[0])) for found in DATES.finditer(body)]

    def moved(number: bytes) -> int:
        place = int(number)
        return place - sum(length for at, length in cuts if at < place)

    table = PLACES.sub(lambda found: b"%010d" % moved(found[0]), table)
    table = START.sub(lambda found: found[1] + b"%d" % moved(found[2]), table)
    return DATES.sub(b"", body) + mark + table


def _xmp(title: str, about: str) -> QByteArray:
    """Title and description, as readers of PDF look for them; Qt's own would hold the time."""
    title, about = escape(title), escape(about)
    text = (
        '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
        '<rdf:Description rdf:about="" xmlns:dc="http://purl.org/dc/elements/1.1/">'
        f'<dc:title><rdf:Alt><rdf:li xml:lang="x-default">{title}</rdf:li></rdf:Alt></dc:title>'
        f'<dc:description><rdf:Alt><rdf:li xml:lang="x-default">{about}</rdf:li></rdf:Alt></dc:description>'
        "</rdf:Description></rdf:RDF></x:xmpmeta>"
    )
    return QByteArray(text.encode("utf-8", "replace"))


def _identity(title: str, about: str) -> QUuid:
    """By what the page is, not by chance."""
    return QUuid(str(uuid.uuid5(uuid.NAMESPACE_OID, f"{title}\n{about}")))


Writer = Callable[[str, str, float, float, Callable[[QPainter], None]], bytes]
FILES: Mapping[str, Writer] = MappingProxyType({".pdf": vector_pdf, ".svg": vector_svg})
assert tuple(FILES) == ENDINGS


def sheet_file(sheet: DrawingSheet, ending: str) -> bytes:
    """The sheet as a file of a row of ``FILES``."""
    ensure_app(offscreen=True)
    return FILES[ending](
        sheet.title,
        sheet.about,
        sheet.width,
        sheet.height,
        lambda painter: SheetPainter(painter, sheet.height).paint(sheet),
    )


# -- sheets ----------------------------------------------------------------------------------------------

CELL = (560, 560)  # of a plot on paper, pixels


def columns_for(count: int, width: float, height: float) -> int:
    """Columns of a grid in which so many square plots become largest in the room given."""
    sizes = {c: min(width / c, height / math.ceil(count / c)) for c in range(1, max(1, count) + 1)}
    return max(sizes, key=lambda c: sizes[c])


class PolarSheet(PaperSheet):
    """Polar plots side by side, for files; unseen: pixels by which curves may be off; 0 draws every point; marks: whether
    extremes are marked; bands: as ``set_curves``."""

    def __init__(
        self,
        study: Study,
        rows: Sequence[Sequence[Quantity]],
        theme: Theme,
        unseen: float = 0.0,
        marks: bool = True,
        bands: Mapping[str, np.ndarray] = NO_BANDS,
    ) -> None:
        super().__init__(theme)
        grid = QGridLayout(self)
        grid.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
        columns = math.ceil(math.sqrt(len(rows)))
        for place, row in enumerate(rows):
            plot = PolarPlot(self, theme)
            plot.unseen = unseen
            plot.set_curves(study, row, bands=bands)
            plot.show_extremes(channel_extremes(study, row) if marks else None)
            plot.show_cursor(False)
            grid.addWidget(plot, place // columns, place % columns)
        self.resize(CELL[0] * columns, CELL[1] * math.ceil(len(rows) / columns))


def polar_file(
    study: Study,
    rows: Sequence[Sequence[Quantity]],
    ending: str,
    marks: bool = True,
    bands: Mapping[str, np.ndarray] = NO_BANDS,
) -> bytes:
    """Polar plots as a file, ``.png`` or ``.svg``, their extremes marked, bands shaded. Raises NoSolution where one has no values."""
    if ending == ".svg":
        return svg(PolarSheet(study, rows, LIGHT, marks=marks, bands=bands), study.design.name)
    return png(PolarSheet(study, rows, replace(LIGHT, ratio=RATIO), UNSEEN / RATIO, marks, bands))


WIDTH, HEIGHT = 960, 300  # of one plot
ALIKE = (720, 640)  # of one whose axes have one scale


class XYSheet(PaperSheet):
    """The plots of a figure under its title."""

    def __init__(self, figure: Figure, theme: Theme) -> None:
        super().__init__(theme)
        column = QVBoxLayout(self)
        column.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
        title = QLabel(figure.title)
        title.setStyleSheet(f"color: {theme.ink}; font-size: {SMALL + 2}px")
        column.addWidget(title)
        self.plots: list[XYPlot] = []
        for each in figure.plots:
            plot = XYPlot(each.across, each.upwards, theme=theme)
            plot.show_plot(each)
            column.addWidget(plot, 1)
            self.plots.append(plot)
        sizes = [ALIKE if each.alike else (WIDTH, HEIGHT) for each in figure.plots]
        self.resize(max(width for width, _ in sizes), sum(height for _, height in sizes) + 40)


def figure_file(figure: Figure, ending: str) -> bytes:
    """A figure as a file, ``.png`` or ``.svg``."""
    vector = ending == ".svg"
    sheet = XYSheet(figure, LIGHT if vector else replace(LIGHT, ratio=RATIO))
    sheet.grab()  # the axes find their sizes
    return svg(sheet, figure.title) if vector else png(sheet)


# -- table sheet -----------------------------------------------------------------------------------------

EDGE, GAP, ROOM = 16.0, 18.0, 6.0  # around it, between columns, above and below a row, pixels
WIDEST, WIDEST_TITLE = 380.0, 560.0  # a column, the title, before words are broken
DIGITS = 8
MOST_ROWS = 40
SIGNIFICANT = f".{DIGITS}g"


class TableSheet(QWidget):
    """As large as the table is."""

    def __init__(self, table: FigureTable, theme: Theme = LIGHT) -> None:
        super().__init__()
        self._theme, self._title = theme, table.title
        rows = [[_words(value) for value in row] for row in table.rows]
        left_out = len(rows) - MOST_ROWS
        self._rows = rows[:MOST_ROWS] + (
            [[f"… {left_out} rows more"] + [""] * (len(table.names) - 1)] if left_out > 0 else []
        )
        self._heads = [_head(name) for name in table.names]
        self._right = [all(_is_number(row[i]) or not row[i] for row in rows) for i in range(len(table.names))]
        self._widths = [
            min(WIDEST, max(self._width(text, i) for text in column)) for i, column in enumerate(self._columns())
        ]
        self._heights = [
            max(self._height(text, width) for text, width in zip(row, self._widths, strict=True)) for row in self._rows
        ]
        own = sum(self._widths) + GAP * (len(self._widths) - 1)
        self._across = max(own, min(WIDEST_TITLE, self._title_width))
        self.resize(round(self._across + 2.0 * EDGE), round(self._top + sum(self._heights) + EDGE))

    def _columns(self) -> list[list[str]]:
        return [[head, *(row[i] for row in self._rows)] for i, head in enumerate(self._heads)]

    def _width(self, text: str, column: int) -> float:
        return QFontMetricsF(font(TEXT, bold=text == self._heads[column])).horizontalAdvance(text) + 2.0

    def _height(self, text: str, width: float) -> float:
        box = QFontMetricsF(font(TEXT)).boundingRect(QRectF(0.0, 0.0, width, 1e6), Qt.TextFlag.TextWordWrap, text)
        return float(box.height()) + ROOM

    @property
    def _title_width(self) -> float:
        return QFontMetricsF(font(TEXT + 1, bold=True)).horizontalAdvance(self._title)

    @property
    def _line(self) -> float:
        return QFontMetricsF(font(TEXT)).height() + ROOM

    @property
    def _top(self) -> float:
        """Where the rows begin."""
        return EDGE + self._line + self._title_height

    @property
    def _title_height(self) -> float:
        if not self._title:
            return 0.0
        room = QRectF(0.0, 0.0, self._across, 1e6)
        letters = QFontMetricsF(font(TEXT + 1, bold=True))
        return float(letters.boundingRect(room, Qt.TextFlag.TextWordWrap, self._title).height()) + 2.0 * ROOM

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(self._theme.paper))
        painter.setPen(QColor(self._theme.ink))
        y = EDGE
        if self._title:
            painter.setFont(font(TEXT + 1, bold=True))
            box = QRectF(EDGE, y, self._across, self._title_height)
            painter.drawText(box, int(Qt.AlignmentFlag.AlignLeft | Qt.TextFlag.TextWordWrap), self._title)
            y += self._title_height
        painter.setFont(font(TEXT, bold=True))
        self._row(painter, self._heads, y, self._line)
        y += self._line
        painter.setPen(QPen(QColor(self._theme.ink), THIN))
        painter.drawLine(round(EDGE), round(y - 0.5 * ROOM), round(self.width() - EDGE), round(y - 0.5 * ROOM))
        painter.setFont(font(TEXT))
        for number, (row, height) in enumerate(zip(self._rows, self._heights, strict=True)):
            if number % 2:
                painter.fillRect(
                    QRectF(EDGE - 4.0, y - 0.5 * ROOM, self.width() - 2.0 * EDGE + 8.0, height),
                    QColor(self._theme.band),
                )
            painter.setPen(QColor(self._theme.ink))
            self._row(painter, row, y, height)
            y += height
        painter.end()

    def _row(self, painter: QPainter, row: list[str], y: float, height: float) -> None:
        x = EDGE
        for text, width, right in zip(row, self._widths, self._right, strict=True):
            side = Qt.AlignmentFlag.AlignRight if right else Qt.AlignmentFlag.AlignLeft
            painter.drawText(QRectF(x, y, width, height), int(side | Qt.TextFlag.TextWordWrap), text)
            x += width + GAP


def _head(name: str) -> str:
    """A column's name as words."""
    return name.replace("_", " ")


def _is_number(text: str) -> bool:
    try:
        float(text.replace("\N{MINUS SIGN}", "-"))
    except ValueError:
        return False
    return True


def _words(value: object) -> str:
    """Numbers with as many digits as are read, with a proper minus."""
    text = str(value)
    if not _is_number(text) or text.isdecimal():
        return text
    return format(float(text), SIGNIFICANT).replace("-", "\N{MINUS SIGN}")


# -- a graph as a file: png, svg or pdf ------------------------------------------------------------------

PIXEL = 0.26  # mm of paper that a pixel is


def graph_file(picture: GraphImage, shown: GraphRange | None = None, bands: Bands = NO_CHANNEL_BANDS) -> bytes:
    """The file's bytes; shown: the part of the graph, None: all of it; bands: as ``show_graph``."""
    ensure_app(offscreen=True)
    raster = picture.ending == ".png"
    plot = GraphPlot(theme=replace(LIGHT, ratio=RATIO) if raster else LIGHT)
    plot.resize(picture.width, picture.height)
    plot.show_graph(picture.graph, picture.data, bands=bands)
    plot.grab()  # the axes find their sizes
    plot.show_range(shown or plot.shown)
    if raster:
        return png(plot)
    if picture.ending == ".svg":
        return svg(plot, picture.name)

    def paint(painter: QPainter) -> None:
        painter.scale(PIXEL * UNITS_PER_MM, PIXEL * UNITS_PER_MM)
        QWidget.render(plot, painter, QPoint())

    curves = ", ".join(each.name for each in picture.data.series)
    return vector_pdf(picture.name, f"Curves: {curves}", picture.width * PIXEL, picture.height * PIXEL, paint)
