"""A small log-log chart, painted: axes by powers of ten, curves of points, direct labels. Nothing of the window is used."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPen

_MIDDLE = Qt.AlignmentFlag.AlignVCenter
AT_LEFT, AT_RIGHT = Qt.AlignmentFlag.AlignLeft | _MIDDLE, Qt.AlignmentFlag.AlignRight | _MIDDLE
INK, QUIET, FAINT, LIMIT = "#202020", "#707070", "#E4E4E4", "#C00000"
# Okabe and Ito; black is ours
COLOURS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A7A7A", "#6A51A3", "#8C6D1F")
LEFT, RIGHT, TOP, BOTTOM = 54.0, 12.0, 24.0, 36.0


@dataclass(frozen=True)
class Curve:
    """points (x, y); filled marks, joined by a line where ``joined``; dashed where it is only to compare."""

    name: str
    points: Sequence[tuple[float, float]]
    colour: str
    joined: bool = True
    dashed: bool = False
    strong: bool = False


@dataclass(frozen=True)
class Chart:
    """title; names of the axes; curves; a horizontal line not to be passed; whether x falls to the right; least range
    of y in powers of ten."""

    title: str
    across: str
    up: str
    curves: Sequence[Curve]
    limit: float | None = None
    falling: bool = False
    y_range: tuple[int, int] | None = None


def font(size: float, bold: bool = False) -> QFont:
    made = QFont("DejaVu Sans")
    made.setPixelSize(round(size))
    made.setBold(bold)
    return made


def _decades(values: Sequence[float], wanted: tuple[int, int] | None) -> tuple[int, int]:
    good = [math.log10(v) for v in values if v > 0.0 and math.isfinite(v)]
    low, high = (math.floor(min(good) - 0.05), math.ceil(max(good) + 0.05)) if good else (0, 1)
    if wanted:
        low, high = min(low, wanted[0]), max(high, wanted[1])
    return low, max(high, low + 1)


def power(exponent: int) -> str:
    """10⁻³; 1 and 10 as they are."""
    digits = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return {0: "1", 1: "10"}.get(exponent, f"10{str(exponent).translate(digits)}")


def paint(painter: QPainter, area: QRectF, chart: Chart) -> None:
    """The chart within the area, its title above, axes left and below."""
    inner = area.adjusted(LEFT, TOP, -RIGHT, -BOTTOM)
    points = [p for curve in chart.curves for p in curve.points]
    x_low, x_high = _decades([x for x, _ in points], None)
    limits = [] if chart.limit is None else [chart.limit]
    y_low, y_high = _decades([y for _, y in points] + limits, chart.y_range)

    def place(x: float, y: float) -> QPointF:
        across = (math.log10(x) - x_low) / (x_high - x_low)
        up = (math.log10(y) - y_low) / (y_high - y_low)
        across = 1.0 - across if chart.falling else across
        return QPointF(inner.left() + inner.width() * across, inner.bottom() - inner.height() * up)

    painter.setFont(font(13, bold=True))
    painter.setPen(QColor(INK))
    painter.drawText(QRectF(area.left() + 4, area.top(), area.width(), TOP - 4), AT_LEFT, chart.title)
    painter.setFont(font(11))
    step_x, step_y = (math.ceil((high - low) / most) for low, high, most in ((x_low, x_high, 7), (y_low, y_high, 7)))
    for exponent in range(x_low, x_high + 1):
        at = place(10.0**exponent, 10.0**y_low)
        painter.setPen(QColor(FAINT))
        painter.drawLine(at, QPointF(at.x(), inner.top()))
        if (exponent - x_low) % step_x == 0:
            painter.setPen(QColor(QUIET))
            painter.drawText(
                QRectF(at.x() - 30, inner.bottom() + 2, 60, 15), Qt.AlignmentFlag.AlignCenter, power(exponent)
            )
    for exponent in range(y_low, y_high + 1):
        at = place(10.0**x_high if chart.falling else 10.0**x_low, 10.0**exponent)
        painter.setPen(QColor(FAINT))
        painter.drawLine(QPointF(inner.left(), at.y()), QPointF(inner.right(), at.y()))
        if (exponent - y_low) % step_y == 0:
            painter.setPen(QColor(QUIET))
            painter.drawText(QRectF(area.left(), at.y() - 8, LEFT - 6, 16), AT_RIGHT, power(exponent))
    painter.setPen(QColor(QUIET))
    painter.drawText(
        QRectF(inner.left(), inner.bottom() + 17, inner.width(), 16), Qt.AlignmentFlag.AlignCenter, chart.across
    )
    painter.save()
    painter.translate(area.left() + 9, inner.center().y())
    painter.rotate(-90.0)
    painter.drawText(QRectF(-110, -8, 220, 16), Qt.AlignmentFlag.AlignCenter, chart.up)
    painter.restore()
    if chart.limit is not None:
        painter.setPen(QPen(QColor(LIMIT), 1.0))
        painter.drawLine(place(10.0**x_low, chart.limit), place(10.0**x_high, chart.limit))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
    for curve in sorted(chart.curves, key=lambda c: c.strong):
        _paint_curve(painter, curve, [place(x, y) for x, y in curve.points if x > 0.0 and y > 0.0 and math.isfinite(y)])
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)


def _paint_curve(painter: QPainter, curve: Curve, spots: Sequence[QPointF]) -> None:
    pen = QPen(QColor(curve.colour), 1.6 if curve.strong else 1.0)
    if curve.dashed:
        pen.setStyle(Qt.PenStyle.DashLine)
    painter.setPen(pen)
    if curve.joined:
        for a, b in pairwise(spots):
            painter.drawLine(a, b)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(curve.colour))
    size = 4.0 if curve.strong else 2.6
    for spot in spots:
        painter.drawEllipse(spot, size, size)
    painter.setBrush(Qt.BrushStyle.NoBrush)


def legend(painter: QPainter, area: QRectF, rows: Sequence[tuple[str, str]]) -> None:
    """Names with their colours, one below the other."""
    painter.setFont(font(11))
    metrics = QFontMetricsF(painter.font())
    for i, (name, colour) in enumerate(rows):
        y = area.top() + TOP + 6 + 17 * i
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(colour))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        painter.drawEllipse(QPointF(area.left() + 8, y), 4.0 if i == 0 else 3.0, 4.0 if i == 0 else 3.0)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        painter.setPen(QColor(INK))
        room = area.width() - 22
        painter.drawText(QPointF(area.left() + 18, y + 4), metrics.elidedText(name, Qt.TextElideMode.ElideRight, room))
