"""The timing chart as a file: a page as PDF, SVG or PNG, or the table of its events."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter

from core.design import Design, together
from core.output.timing import ENDINGS, events_csv
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.paper import png_bytes
from kindyna_gui.pictures.sheet_file import FILES, UNITS
from kindyna_gui.pictures.style import LIGHT, SMALL, TEXT, font
from kindyna_gui.pictures.timing_chart import DEGREES, ChartHighlights, TimingChart, plain

PIXEL = 0.26  # mm of paper that a pixel of the chart is
WIDTH, BAND, AROUND, MARGIN = 1060.0, 92.0, 48.0, 28.0  # of the page, a band, axis, edge, pixels
TITLE, LINE = 46.0, 15.0  # heights of the title and of a line of the list
DOTS = 2.0  # of a PNG, per pixel


def timing_file(design: Design, ending: str, unit: str = DEGREES, pair: Sequence[int] = ()) -> bytes:
    """The chart as one of ``ENDINGS``; unit: what its axis counts in; pair: two drives whose common movement is shaded."""
    assert ending in ENDINGS
    if ending == ".csv":
        return events_csv(design).encode()
    ensure_app(offscreen=True)
    height = _chart_height(design) + TITLE + LINE * len(_lines(design, pair)) + 2.5 * MARGIN

    def paint(scale: float) -> Callable[[QPainter], None]:
        return lambda painter: _paint(painter, design, unit, tuple(pair), scale)

    if ending == ".png":
        return _png(height, paint(DOTS))
    about = "Timing chart: motions of all drives over the machine angle"
    return FILES[ending](design.name, about, WIDTH * PIXEL, height * PIXEL, paint(PIXEL * UNITS))


def _png(height: float, paint: Callable[[QPainter], None]) -> bytes:
    image = QImage(round(WIDTH * DOTS), round(height * DOTS), QImage.Format.Format_RGB32)
    painter = QPainter(image)
    try:
        paint(painter)
    finally:
        painter.end()
    return png_bytes(image)


def _paint(painter: QPainter, design: Design, unit: str, pair: tuple[int, ...], scale: float) -> None:
    """The page, a pixel of the chart being so many units of the device."""
    theme = LIGHT
    chart = TimingChart(design, WIDTH - 2.0 * MARGIN, _chart_height(design), unit, theme)
    lines = _lines(design, pair, chart)
    painter.scale(scale, scale)
    painter.setRenderHint(QPainter.RenderHint.TextAntialiasing)
    painter.fillRect(
        QRectF(0.0, 0.0, WIDTH, chart.height + TITLE + LINE * len(lines) + 2.5 * MARGIN), QColor(theme.paper)
    )
    painter.translate(MARGIN, MARGIN)
    painter.setPen(QColor(theme.ink))
    painter.setFont(font(TEXT + 3, bold=True))
    painter.drawText(QRectF(0.0, 0.0, chart.width, 20.0), Qt.AlignmentFlag.AlignVCenter, design.name)
    painter.setFont(font(SMALL))
    painter.setPen(QColor(theme.quiet))
    about = f"Timing chart. {design.speed_rpm:g} rpm: a turn takes {chart.both(360.0).split('  ')[1]}"
    painter.drawText(QRectF(0.0, 20.0, chart.width, 16.0), Qt.AlignmentFlag.AlignVCenter, about)
    painter.translate(0.0, TITLE)
    chart.paint(painter, ChartHighlights(pair=pair))
    painter.translate(0.0, chart.height + 0.5 * MARGIN)
    for number, (text, wrong) in enumerate(lines):
        painter.setPen(QColor(theme.limit if wrong else theme.ink))
        painter.drawText(QRectF(0.0, LINE * number, chart.width, LINE), Qt.AlignmentFlag.AlignVCenter, text)


def _chart_height(design: Design) -> float:
    return BAND * len(design.drives) + AROUND


def _lines(design: Design, pair: Sequence[int], chart: TimingChart | None = None) -> list[tuple[str, bool]]:
    """What stands below the chart, and whether it is wrong: each distance, and where the two drives move together."""
    made = []
    for row, each in enumerate(design.timing):
        kept = chart is None or chart.distances[row].kept
        at = "" if chart is None else chart.at_least(row)
        made.append((f"{plain(each.second)} after {plain(each.first)}: {at}{'' if kept else ', broken'}", not kept))
    if len(pair) == 2:
        names = " and ".join(chart.bands[number].name for number in pair) if chart is not None else ""
        parts = together(design, *pair) if chart is not None else ()
        text = (
            ", ".join(f"{chart.text(begin)} - {chart.text(end % 360.0)}" for begin, end in parts)
            if chart is not None
            else ""
        )
        made.append((f"{names} both move: {text or 'never'}", False))
    return made


__all__ = ["timing_file"]
