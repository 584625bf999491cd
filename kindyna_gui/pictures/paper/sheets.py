"""Files of drawing sheets, plots, tables and graphs: PDF, SVG and PNG.

Equal contents give equal bytes: PDF files have no date and a fixed identity.
"""

from __future__ import annotations

import math
import re
import uuid
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from html import escape
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

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
    QFontMetricsF,
    QImage,
    QPageSize,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPdfWriter,
    QPen,
    QPolygonF,
)
from PySide6.QtSvg import QSvgRenderer
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
from kindyna_gui.pictures.painter import (
    MARGIN,
    Companions,
    PaperSheet,
    curves_file,
    fill_plot,
    no_companions,
    paint_on,
    paper_theme,
    svg_bytes,
    widget_file,
)
from kindyna_gui.pictures.plots.graph import NO_CHANNEL_BANDS, Bands, Dashed, GraphPlot
from kindyna_gui.pictures.plots.graph_ranges import GraphRange
from kindyna_gui.pictures.plots.polar import PolarPlot
from kindyna_gui.pictures.plots.xy import XYPlot
from kindyna_gui.pictures.style import LIGHT, SMALL, TEXT, THIN, Theme, font

if TYPE_CHECKING:
    from core.stability import Figure


# -- drawing sheets ------------------------------------------------------------------------------------

UNITS_PER_MM = 100.0  # units of the painter per millimetre
DPI = 2540  # resolution that gives these units
CAPITALS = 0.729  # height of a capital by the font size
SLIM = 0.15  # half the width of an arrow head by its length
INK, PAPER = "#000000", "#ffffff"
UNICODE_MAP = re.compile(rb"beginbfrange.*?endbfrange", re.DOTALL)  # characters of a font; Qt maps a space to a tab
OBJECT_OFFSETS = re.compile(rb"^\d{10}(?= \d{5} n)", re.MULTILINE)  # entries of the table of objects
TABLE_OFFSET = re.compile(rb"(startxref\n)(\d+)")  # offset of that table
DATES = re.compile(rb"/(?:CreationDate|ModDate) \([^)]*\)")


def paint_logo(painter: QPainter, logo: Logo, box: QRectF) -> None:
    """Paint a logo with its proportions, as large as the box allows, at the right edge at half the height."""
    image = QSvgRenderer(QByteArray(logo.data)) if logo.kind == SVG else QImage.fromData(logo.data)
    size = QSizeF(image.defaultSize() if isinstance(image, QSvgRenderer) else image.size())
    size.scale(box.size(), Qt.AspectRatioMode.KeepAspectRatio)
    target = QRectF(box.right() - size.width(), box.center().y() - 0.5 * size.height(), size.width(), size.height())
    if isinstance(image, QSvgRenderer):
        image.render(painter, target)
    else:
        painter.drawImage(target, image)


class SheetPainter:
    """Paints the items of a sheet on a device of ``DPI``; ``height`` is the height of the sheet [mm]."""

    def __init__(self, painter: QPainter, height: float) -> None:
        self._painter, self._height = painter, height

    def paint(self, sheet: DrawingSheet) -> None:
        for item in sheet.items:
            ITEM_PAINTERS[type(item)](self, item)

    def _at(self, z: complex) -> QPointF:
        return QPointF(UNITS_PER_MM * z.real, UNITS_PER_MM * (self._height - z.imag))

    def line(self, item: SheetLine) -> None:
        self._painter.setPen(_pen(item.kind))
        self._painter.drawPolyline(QPolygonF([self._at(z) for z in item.points]))

    def circle(self, item: SheetCircle) -> None:
        """Paint a circle or an arc."""
        middle, radius = self._at(item.centre), UNITS_PER_MM * item.radius
        box = QRectF(middle.x() - radius, middle.y() - radius, 2.0 * radius, 2.0 * radius)
        path = QPainterPath()
        path.arcMoveTo(box, item.start_deg)
        path.arcTo(box, item.start_deg, item.span_deg)
        self._path(path, item.kind)

    def curve(self, item: BezierLoop) -> None:
        """Paint a closed Bézier curve as one path."""
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
        """Paint a filled arrow head."""
        back = item.tip - item.length * item.direction
        across = 1j * SLIM * item.length * item.direction
        self._painter.setPen(Qt.PenStyle.NoPen)
        self._painter.setBrush(QBrush(QColor(INK)))
        self._painter.drawPolygon(QPolygonF([self._at(z) for z in (item.tip, back + across, back - across)]))

    def logo(self, item: SheetLogo) -> None:
        """Paint a logo between two corners."""
        paint_logo(self._painter, item.logo, QRectF(self._at(item.low), self._at(item.high)).normalized())

    def text(self, item: SheetText) -> None:
        face = font(round(UNITS_PER_MM * item.height / CAPITALS))
        width = QFontMetricsF(face, self._painter.device()).horizontalAdvance(item.text)
        factor = min(1.0, UNITS_PER_MM * item.room / width) if width else 1.0  # a long text is narrowed
        self._painter.save()
        self._painter.setFont(face)
        self._painter.setPen(QColor(INK))
        self._painter.translate(self._at(item.at))
        self._painter.scale(factor, 1.0)
        self._painter.drawText(QPointF(-item.align * width, 0.0), item.text)
        self._painter.restore()


ITEM_PAINTERS: Mapping[type, Callable[[SheetPainter, Any], None]] = MappingProxyType(
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


def paint_sheet(painter: QPainter, sheet: DrawingSheet, room: QRect) -> None:
    """Paint the sheet as a white page, centred and as large as the space allows."""
    factor = min(room.width() / sheet.width, room.height() / sheet.height) / UNITS_PER_MM
    page = QRectF(0.0, 0.0, UNITS_PER_MM * sheet.width, UNITS_PER_MM * sheet.height)
    painter.save()
    painter.translate(QRectF(room).center() - page.center() * factor)
    painter.scale(factor, factor)
    painter.fillRect(page, QColor(PAPER))
    SheetPainter(painter, sheet.height).paint(sheet)
    painter.restore()


def vector_svg(title: str, about: str, width: float, height: float, paint: Callable[[QPainter], None]) -> bytes:
    """Write a page of a size [mm] as SVG; ``paint`` paints in hundredths of a millimetre."""
    size = QSize(round(UNITS_PER_MM * width), round(UNITS_PER_MM * height))
    return svg_bytes(size, DPI, title, about, paint)


def vector_pdf(title: str, about: str, width: float, height: float, *pages: Callable[[QPainter], None]) -> bytes:
    """Write pages of a size [mm] as PDF; each function paints one page in hundredths of a millimetre."""
    QHashSeed.setDeterministicGlobalSeed()  # several fonts are written in the order of their hashes
    try:
        data = _pdf(title, about, width, height, pages)
    finally:
        QHashSeed.resetRandomGlobalSeed()
    return UNICODE_MAP.sub(lambda match: match[0].replace(b"<0009>", b"<0020>"), without_dates(data))


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
    writer.setDocumentId(QUuid(str(uuid.uuid5(uuid.NAMESPACE_OID, f"{title}\n{about}"))))

    def paint(painter: QPainter) -> None:
        for number, paint_page in enumerate(pages):
            if number:
                writer.newPage()
            paint_page(painter)

    paint_on(writer, paint)
    buffer.close()
    return bytes(data.data())


def without_dates(data: bytes) -> bytes:
    """Remove the dates from a PDF, and correct the offsets in the table at its end."""
    body, mark, table = data.rpartition(b"\nxref\n")
    cuts = [(match.start(), len(match[0])) for match in DATES.finditer(body)]

    def corrected(number: bytes) -> int:
        offset = int(number)
        return offset - sum(length for start, length in cuts if start < offset)

    table = OBJECT_OFFSETS.sub(lambda match: b"%010d" % corrected(match[0]), table)
    table = TABLE_OFFSET.sub(lambda match: match[1] + b"%d" % corrected(match[2]), table)
    return DATES.sub(b"", body) + mark + table


def _xmp(title: str, about: str) -> QByteArray:
    """Metadata with title and description; Qt's metadata would contain the time."""
    title, about = escape(title, quote=False), escape(about, quote=False)
    text = (
        '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
        '<rdf:Description rdf:about="" xmlns:dc="http://purl.org/dc/elements/1.1/">'
        f'<dc:title><rdf:Alt><rdf:li xml:lang="x-default">{title}</rdf:li></rdf:Alt></dc:title>'
        f'<dc:description><rdf:Alt><rdf:li xml:lang="x-default">{about}</rdf:li></rdf:Alt></dc:description>'
        "</rdf:Description></rdf:RDF></x:xmpmeta>"
    )
    return QByteArray(text.encode("utf-8", "replace"))


Writer = Callable[[str, str, float, float, Callable[[QPainter], None]], bytes]
FILES: Mapping[str, Writer] = MappingProxyType({".pdf": vector_pdf, ".svg": vector_svg})
assert tuple(FILES) == ENDINGS


def sheet_file(sheet: DrawingSheet, ending: str) -> bytes:
    """Write a sheet as a file with an ending of ``FILES``."""
    ensure_app(offscreen=True)
    return FILES[ending](
        sheet.title,
        sheet.about,
        sheet.width,
        sheet.height,
        lambda painter: SheetPainter(painter, sheet.height).paint(sheet),
    )


# -- plots ---------------------------------------------------------------------------------------------

CELL = (560, 560)  # size of a polar plot, pixels
WIDTH, HEIGHT = 960, 300  # size of a plot, pixels
EQUAL_SCALES = (720, 640)  # size of a plot with equal scales on both axes, pixels


def columns_for(count: int, width: float, height: float) -> int:
    """Columns of the grid in which ``count`` square plots are largest in a space of this size."""
    sizes = {c: min(width / c, height / math.ceil(count / c)) for c in range(1, max(1, count) + 1)}
    return max(sizes, key=lambda c: sizes[c])


class PolarSheet(PaperSheet):
    """Polar plots in a grid, for files.

    Parameters
    ----------
    study : Study
    rows : sequence of sequences of Quantity
        Curves of each plot.
    theme : Theme
    unseen : float [pixels]
        Allowed deviation of the drawn curves; 0 draws every point.
    marks : bool
        Mark the extremes.
    companions : callable
        Quantities of a plot -> what is drawn next to them, as arguments of `PolarPlot.set_curves`.
    """

    def __init__(
        self,
        study: Study,
        rows: Sequence[Sequence[Quantity]],
        theme: Theme,
        unseen: float = 0.0,
        marks: bool = True,
        companions: Companions = no_companions,
    ) -> None:
        super().__init__(theme)
        grid = QGridLayout(self)
        grid.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
        columns = math.ceil(math.sqrt(len(rows)))
        for number, row in enumerate(rows):
            plot = PolarPlot(self, theme)
            fill_plot(plot, study, row, unseen, marks, companions)
            grid.addWidget(plot, number // columns, number % columns)
        self.resize(CELL[0] * columns, CELL[1] * math.ceil(len(rows) / columns))


polar_file = partial(curves_file, sheet=PolarSheet)
"""Write polar plots as a file; parameters as for `curves_file`."""


class XYSheet(PaperSheet):
    """Plots of a figure under its title."""

    def __init__(self, figure: Figure, theme: Theme) -> None:
        super().__init__(theme)
        column = QVBoxLayout(self)
        column.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
        title = QLabel(figure.title)
        title.setStyleSheet(f"color: {theme.ink}; font-size: {SMALL + 2}px")
        column.addWidget(title)
        self.plots: list[XYPlot] = []
        for row in figure.plots:
            plot = XYPlot(row.across, row.upwards, theme=theme)
            plot.show_plot(row)
            column.addWidget(plot, 1)
            self.plots.append(plot)
        sizes = [EQUAL_SCALES if row.alike else (WIDTH, HEIGHT) for row in figure.plots]
        self.resize(max(width for width, _ in sizes), sum(height for _, height in sizes) + 40)


def figure_file(figure: Figure, ending: str) -> bytes:
    """Write a figure as a file, ``.png`` or ``.svg``."""
    sheet = XYSheet(figure, paper_theme(ending))
    sheet.grab()  # the axes compute their sizes
    return widget_file(sheet, ending, figure.title)


# -- tables --------------------------------------------------------------------------------------------

EDGE, GAP, ROOM = 16.0, 18.0, 6.0  # margin, space between columns, space for a row beyond its text, pixels
WIDEST, WIDEST_TITLE = 380.0, 560.0  # greatest width of a column and of the title, pixels
DIGITS = 8
MOST_ROWS = 40
SIGNIFICANT = f".{DIGITS}g"


class TableSheet(QWidget):
    """A table of a figure, as large as its contents."""

    def __init__(self, table: FigureTable, theme: Theme = LIGHT) -> None:
        super().__init__()
        self._theme, self._title = theme, table.title
        rows = [[_words(value) for value in row] for row in table.rows]
        self._rows = rows[:MOST_ROWS]
        if len(rows) > MOST_ROWS:
            self._rows.append([f"… {len(rows) - MOST_ROWS} more rows"] + [""] * (len(table.names) - 1))
        self._headers = [name.replace("_", " ") for name in table.names]
        self._right = [all(_is_number(row[i]) or not row[i] for row in rows) for i in range(len(table.names))]
        self._widths = [
            min(WIDEST, max(self._width(text, i) for text in column))
            for i, column in enumerate(zip(self._headers, *self._rows, strict=True))
        ]
        self._heights = [
            max(self._height(text, width) for text, width in zip(row, self._widths, strict=True)) for row in self._rows
        ]
        table_width = sum(self._widths) + GAP * (len(self._widths) - 1)
        title_width = QFontMetricsF(font(TEXT + 1, bold=True)).horizontalAdvance(self._title)
        self._across = max(table_width, min(WIDEST_TITLE, title_width))
        self.resize(
            round(self._across + 2.0 * EDGE), round(EDGE + self._line + self._title_height + sum(self._heights) + EDGE)
        )

    def _width(self, text: str, column: int) -> float:
        return QFontMetricsF(font(TEXT, bold=text == self._headers[column])).horizontalAdvance(text) + 2.0

    def _height(self, text: str, width: float) -> float:
        box = QFontMetricsF(font(TEXT)).boundingRect(QRectF(0.0, 0.0, width, 1e6), Qt.TextFlag.TextWordWrap, text)
        return float(box.height()) + ROOM

    @property
    def _line(self) -> float:
        return QFontMetricsF(font(TEXT)).height() + ROOM

    @property
    def _title_height(self) -> float:
        if not self._title:
            return 0.0
        box = QRectF(0.0, 0.0, self._across, 1e6)
        metrics = QFontMetricsF(font(TEXT + 1, bold=True))
        return float(metrics.boundingRect(box, Qt.TextFlag.TextWordWrap, self._title).height()) + 2.0 * ROOM

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
        self._row(painter, self._headers, y, self._line)
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


def _is_number(text: str) -> bool:
    try:
        float(text.replace("\N{MINUS SIGN}", "-"))
    except ValueError:
        return False
    return True


def _words(value: object) -> str:
    """Value as a text; numbers with ``DIGITS`` digits and a minus sign."""
    text = str(value)
    if not _is_number(text) or text.isdecimal():
        return text
    return format(float(text), SIGNIFICANT).replace("-", "\N{MINUS SIGN}")


# -- graphs --------------------------------------------------------------------------------------------

PIXEL = 0.26  # mm of paper per pixel


def graph_file(
    picture: GraphImage,
    shown: GraphRange | None = None,
    bands: Bands = NO_CHANNEL_BANDS,
    reference: Dashed | None = None,
) -> bytes:
    """Write a graph as PNG, SVG or PDF; ``shown`` is the visible part, None for all, the others as in ``show_graph``."""
    ensure_app(offscreen=True)
    plot = GraphPlot(theme=paper_theme(picture.ending))
    plot.resize(picture.width, picture.height)
    plot.show_graph(picture.graph, picture.data, bands=bands, reference=reference)
    plot.grab()  # the axes compute their sizes
    plot.show_range(shown or plot.shown)
    if picture.ending != ".pdf":
        return widget_file(plot, picture.ending, picture.name)

    def paint(painter: QPainter) -> None:
        painter.scale(PIXEL * UNITS_PER_MM, PIXEL * UNITS_PER_MM)
        QWidget.render(plot, painter, QPoint())

    curves = ", ".join(series.name for series in picture.data.series)
    return vector_pdf(picture.name, f"Curves: {curves}", picture.width * PIXEL, picture.height * PIXEL, paint)
