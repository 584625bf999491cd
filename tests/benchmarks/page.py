"""One page of charts: for each kernel time against error, time against size and memory; then the stress cases."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from benchmarks.chart import COLOURS, Chart, Curve, font, legend, paint
from benchmarks.measuring import WARM, Row
from benchmarks.stress import Look
from benchmarks.table import Kernel, kernels
from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QRect, QRectF, QSize
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtSvg import QSvgGenerator

from kindyna_gui.pictures.app import ensure_app

WIDE, HIGH, EDGE, HEAD = 330.0, 232.0, 16.0, 74.0
ACROSS = 4  # charts in a row: error, growth, memory, names
RATIO = 2


def _of(rows: Sequence[Row], kernel: str) -> dict[str, list[Row]]:
    found: dict[str, list[Row]] = {}
    for row in rows:
        if row.kernel == kernel and row.regime == WARM and not row.note:
            found.setdefault(row.method, []).append(row)
    return found


def _kernel_charts(rows: Sequence[Row], kernel: Kernel, methods: Mapping[str, list[Row]]) -> list[Chart]:
    title, usual, unit = kernel.title, kernel.usual, kernel.unit
    precision, growth, memory = [], [], []
    for i, (name, told) in enumerate(methods.items()):
        colour, strong = COLOURS[i % len(COLOURS)], i == 0
        here = sorted((r for r in told if r.n == usual), key=lambda r: r.error)
        precision.append(Curve(name, [(max(r.error, 1e-17), r.times_ours) for r in here], colour, strong=strong))
        first = next(r for r in told if r.n == usual)
        at = {r.n: r for r in reversed(told) if r.n != usual}  # in the usual setting, which comes first
        sizes = sorted([*at.values(), first], key=lambda r: r.n)
        growth.append(Curve(name, [(r.n, r.times_yardstick) for r in sizes], colour, strong=strong))
        memory.append(
            Curve(name, [(r.n, r.peak_memory_mib) for r in sizes if r.peak_memory_mib > 0.0], colour, strong=strong)
        )
    made = [Chart(title, "largest true error, relative", "time / KINDYNA's", precision, limit=1.0, y_range=(-1, 1))]
    if len({r.n for r in rows}) > 1:
        made.append(Chart("Growth", unit, "time / yardstick's", growth))
        made.append(Chart("Memory", unit, "peak MiB", memory))
    return made


def _stress_charts(looks: Sequence[Look]) -> list[Chart]:
    made = []
    for name in dict.fromkeys(look.case for look in looks):
        told = [look for look in looks if look.case == name]
        places = [(look.value, look) for look in told if look.value > 0.0]
        curves = [Curve("KINDYNA", [(v, max(k.sample.ratio, 1e-9)) for v, k in places], COLOURS[0], strong=True)]
        printed = [(v, k.sample.printed / k.sample.bound) for v, k in places if math.isfinite(k.sample.printed)]
        if printed:
            curves.append(Curve("as printed", [(v, max(p, 1e-9)) for v, p in printed], COLOURS[2], dashed=True))
        falling = told[0].value > told[-1].value
        made.append(Chart(name, told[0].axis, "error / bound", curves, limit=1.0, falling=falling, y_range=(-3, 1)))
    return made


Places = list[tuple[QRectF, Chart]]
Legends = list[tuple[QRectF, list[tuple[str, str]]]]


def _layout(rows: Sequence[Row], looks: Sequence[Look]) -> tuple[Places, Legends, float]:
    charts, legends = [], []
    y = HEAD
    for kernel in kernels():
        methods = _of(rows, kernel.name)
        if not methods:
            continue
        own = [r for r in rows if r.kernel == kernel.name]
        told = _kernel_charts(own, kernel, methods)
        for i, chart in enumerate(told):
            charts.append((QRectF(EDGE + WIDE * i, y, WIDE, HIGH), chart))
        names = [(name, COLOURS[i % len(COLOURS)]) for i, name in enumerate(methods)]
        legends.append((QRectF(EDGE + WIDE * len(told) + 8, y, WIDE - 8, HIGH), names))
        y += HIGH + 10
    y += 34
    for i, chart in enumerate(_stress_charts(looks)):
        charts.append((QRectF(EDGE + WIDE * (i % ACROSS), y + (HIGH + 6) * (i // ACROSS), WIDE, HIGH), chart))
    count = len(dict.fromkeys(look.case for look in looks))
    return charts, legends, y + (HIGH + 6) * math.ceil(count / ACROSS) + EDGE


def _paint(painter: QPainter, rows: Sequence[Row], looks: Sequence[Look]) -> None:
    charts, legends, _ = _layout(rows, looks)
    painter.setPen(QColor("#202020"))
    painter.setFont(font(18, bold=True))
    painter.drawText(QRectF(EDGE, 12, 1200, 26), "Run time against true error")
    painter.setFont(font(12))
    usual = "3600 cam angles, unless said otherwise, warm; ratios of the best of several runs in turn; errors against 50-digit values"
    painter.drawText(QRectF(EDGE, 38, 1300, 20), usual)
    stress_top = min((area.top() for area, chart in charts if chart.up == "error / bound"), default=0.0)
    if stress_top:
        painter.setFont(font(18, bold=True))
        told = "Towards numerical breakdown: error / derived bound (red: the bound; dashed: as the paper prints it)"
        painter.drawText(QRectF(EDGE, stress_top - 32, 1300, 26), told)
    for area, chart in charts:
        paint(painter, area, chart)
    for area, names in legends:
        legend(painter, area, names)


def painted(rows: Sequence[Row], looks: Sequence[Look]) -> dict[str, bytes]:
    """bench.png and bench.svg."""
    ensure_app()
    width, height = round(2 * EDGE + ACROSS * WIDE), round(_layout(rows, looks)[2])
    image = QImage(QSize(width, height) * RATIO, QImage.Format.Format_RGB32)
    image.setDevicePixelRatio(RATIO)
    image.fill(QColor("white"))
    painter = QPainter(image)
    _paint(painter, rows, looks)
    painter.end()
    return {
        "bench.png": _bytes(lambda buffer: image.save(buffer, "PNG")),
        "bench.svg": _svg(rows, looks, width, height),
    }


def _bytes(write) -> bytes:  # type: ignore[no-untyped-def]
    data = QByteArray()
    buffer = QBuffer(data)
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    write(buffer)
    buffer.close()
    return bytes(data.data())


def _svg(rows: Sequence[Row], looks: Sequence[Look], width: int, height: int) -> bytes:
    def write(buffer: QBuffer) -> None:
        generator = QSvgGenerator()
        generator.setOutputDevice(buffer)
        generator.setResolution(96)
        generator.setSize(QSize(width, height))
        generator.setViewBox(QRect(0, 0, width, height))
        generator.setTitle("Run time against true error")
        painter = QPainter(generator)
        painter.fillRect(QRect(0, 0, width, height), QColor("white"))
        _paint(painter, rows, looks)
        painter.end()

    return _bytes(write)
