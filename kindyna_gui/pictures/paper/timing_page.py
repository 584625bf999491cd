"""The timing chart as a file: a page with the chart, and the sequence conditions or the timing of the valves below it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter

from core.design import Design
from core.output.timing import ENDINGS, events_csv
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.painter import paint_on, png_bytes
from kindyna_gui.pictures.paper.crank_chart import CrankChart
from kindyna_gui.pictures.paper.sheets import FILES, UNITS_PER_MM
from kindyna_gui.pictures.paper.timing_chart import CRANK, DEGREES, ChartHighlights, Reference, TimingChart
from kindyna_gui.pictures.style import LIGHT, SMALL, TEXT, Theme, font
from kindyna_gui.pictures.units import typed

PIXEL = 0.26  # mm of paper per pixel of the chart
# Page width, heights of rows and axis, margin, pixels.
WIDTH, BAND, PANEL, AXIS, MARGIN = 1060.0, 92.0, 320.0, 48.0, 28.0
TITLE, FILE_LINE = 46.0, 15.0  # heights of the title and of a line of the list
DOTS = 2.0  # dots of a PNG per pixel


def timing_chart(
    design: Design, width: float, height: float, unit: str, theme: Theme, reference: Reference | None = None
) -> TimingChart:
    """Return the chart of a design over the axis of a unit; the parameters are those of ``TimingChart``."""
    chart = CrankChart if unit == CRANK else TimingChart
    return chart(design, width, height, unit, theme, reference)


def timing_file(
    design: Design, ending: str, unit: str = DEGREES, pair: Sequence[int] = (), reference: Reference | None = None
) -> bytes:
    """Write the chart as a file.

    Parameters
    ----------
    design : Design
    ending : str
        One of ``ENDINGS``.
    unit : str
        Unit of the axis.
    pair : sequence of int
        Two drives whose overlap is shaded, or none.
    reference : Reference, optional
        A second design, drawn dashed.

    Returns
    -------
    bytes
    """
    assert ending in ENDINGS
    if ending == ".csv":
        return events_csv(design).encode()
    ensure_app(offscreen=True)
    chart = _chart(design, unit, reference)
    height = chart.height + TITLE + FILE_LINE * len(chart.lines(pair)) + 2.5 * MARGIN

    def paint(scale: float) -> Callable[[QPainter], None]:
        return lambda painter: _paint(painter, chart, tuple(pair), scale)

    if ending == ".png":
        image = QImage(round(WIDTH * DOTS), round(height * DOTS), QImage.Format.Format_RGB32)
        paint_on(image, paint(DOTS))
        return png_bytes(image)
    description = f"Timing chart: {chart.content}"
    return FILES[ending](design.name, description, WIDTH * PIXEL, height * PIXEL, paint(PIXEL * UNITS_PER_MM))


def _paint(painter: QPainter, chart: TimingChart, pair: tuple[int, ...], scale: float) -> None:
    """Paint the page; ``scale`` is the number of device units per pixel."""
    theme, design, lines = chart.theme, chart.design, chart.lines(pair)
    painter.scale(scale, scale)
    painter.setRenderHint(QPainter.RenderHint.TextAntialiasing)
    height = chart.height + TITLE + FILE_LINE * len(lines) + 2.5 * MARGIN
    painter.fillRect(QRectF(0.0, 0.0, WIDTH, height), QColor(theme.paper))
    painter.translate(MARGIN, MARGIN)
    painter.setPen(QColor(theme.ink))
    painter.setFont(font(TEXT + 3, bold=True))
    painter.drawText(QRectF(0.0, 0.0, chart.width, 20.0), Qt.AlignmentFlag.AlignVCenter, design.name)
    painter.setFont(font(SMALL))
    painter.setPen(QColor(theme.quiet))
    subtitle = f"Timing chart. {typed(design.speed_rpm)} rpm: a turn takes {chart.degrees_and_ms(360.0).split('  ')[1]}"
    painter.drawText(QRectF(0.0, 20.0, chart.width, 16.0), Qt.AlignmentFlag.AlignVCenter, subtitle)
    painter.translate(0.0, TITLE)
    chart.paint(painter, ChartHighlights(pair=pair))
    painter.translate(0.0, chart.height + 0.5 * MARGIN)
    for number, (text, is_violated) in enumerate(lines):
        painter.setPen(QColor(theme.limit if is_violated else theme.ink))
        painter.drawText(QRectF(0.0, FILE_LINE * number, chart.width, FILE_LINE), Qt.AlignmentFlag.AlignVCenter, text)


def _chart(design: Design, unit: str, reference: Reference | None) -> TimingChart:
    rows = CrankChart.panel_count(design) * PANEL if unit == CRANK else len(design.drives) * BAND
    return timing_chart(design, WIDTH - 2.0 * MARGIN, rows + AXIS, unit, LIGHT, reference)
