"""A sheet of the core as PDF or SVG, painted by one painter for both: a hundred units are a millimetre of paper."""

from __future__ import annotations

import re
import uuid
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import Any
from xml.sax.saxutils import escape

from PySide6.QtCore import (
    QBuffer,
    QByteArray,
    QHashSeed,
    QIODevice,
    QMarginsF,
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
    QPageSize,
    QPaintDevice,
    QPainter,
    QPainterPath,
    QPdfWriter,
    QPen,
    QPolygonF,
)
from PySide6.QtSvg import QSvgGenerator

from core.output.files.cam_drawing import ENDINGS
from core.output.files.sheet import (
    LINE_KINDS,
    ArrowHead,
    BezierLoop,
    DrawingSheet,
    SheetCircle,
    SheetLine,
    SheetLogo,
    SheetText,
)
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.logo import paint_logo
from kindyna_gui.pictures.style import font

UNITS = 100.0  # of the painter, a millimetre
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
        return QPointF(UNITS * z.real, UNITS * (self._height - z.imag))

    def line(self, item: SheetLine) -> None:
        self._painter.setPen(_pen(item.kind))
        self._painter.drawPolyline(QPolygonF([self._at(z) for z in item.points]))

    def circle(self, item: SheetCircle) -> None:
        """A circle of the sheet."""
        middle, radius = self._at(item.centre), UNITS * item.radius
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
        room = UNITS * item.room
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
    width = UNITS * row.width
    pen = QPen(QColor(INK), width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.FlatCap, Qt.PenJoinStyle.MiterJoin)
    if row.dashes:
        pen.setDashPattern([UNITS * dash / width for dash in row.dashes])
    return pen


def _font(height: float) -> QFont:
    """Whose capitals have this height [mm]."""
    return font(round(UNITS * height / CAPITALS))


def _on(device: QPaintDevice, paint: Callable[[QPainter], None]) -> None:
    painter = QPainter(device)
    try:
        paint(painter)
    finally:
        painter.end()


def paint_sheet(painter: QPainter, sheet: DrawingSheet, room: QRect) -> None:
    """The sheet as a white page in the middle of the room, as large as it fits."""
    factor = min(room.width() / sheet.width, room.height() / sheet.height) / UNITS
    page = QRectF(0.0, 0.0, UNITS * sheet.width, UNITS * sheet.height)
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
    size = QSize(round(UNITS * width), round(UNITS * height))
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


__all__ = ["FILES", "UNITS", "paint_sheet", "sheet_file"]
