"""A widget on paper: its PNG and SVG bytes, and the sheet on which plots are laid out for a file."""

from __future__ import annotations

from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QPoint, QRect, QSize
from PySide6.QtGui import QColor, QImage, QImageWriter, QPaintDevice, QPainter, QPalette
from PySide6.QtSvg import QSvgGenerator
from PySide6.QtWidgets import QWidget

from kindyna_gui.pictures.style import Theme

MARGIN = 8  # around the plots, pixels
RATIO = 2.0  # dots per pixel of a PNG
LIGHTLY = 70  # of Qt's 0 ... 100 of a PNG: zlib's level 3, where 6 is usual
ENLARGED = 64.0  # how far a reader may zoom into an SVG before its curves show corners


class PaperSheet(QWidget):
    """A widget in the colour of a theme's paper; subclasses lay out their plots ``MARGIN`` from its edges."""

    def __init__(self, theme: Theme) -> None:
        super().__init__()
        paper = QPalette(self.palette())
        paper.setColor(QPalette.ColorRole.Window, QColor(theme.paper))
        self.setPalette(paper)
        self.setAutoFillBackground(True)


def png(widget: QWidget, ratio: float = RATIO) -> bytes:
    """A widget as PNG, ``ratio`` dots per pixel; draw with a theme of the same ratio."""
    image = QImage(widget.size() * ratio, QImage.Format.Format_RGB32)
    image.setDevicePixelRatio(ratio)
    image.fill(QColor("white"))
    _draw(widget, image)
    return png_bytes(image)


def png_bytes(image: QImage) -> bytes:
    """An image as PNG: a fifth larger than Qt would make it, in two thirds of the time."""
    data = QByteArray()
    buffer = QBuffer(data)
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    writer = QImageWriter(buffer, b"PNG")
    writer.setQuality(LIGHTLY)
    writer.write(image)
    return bytes(data.data())


def svg(widget: QWidget, title: str = "") -> bytes:
    """A widget as SVG."""
    data = QByteArray()
    buffer = QBuffer(data)
    generator = QSvgGenerator()
    generator.setOutputDevice(buffer)
    generator.setResolution(widget.logicalDpiX())
    generator.setSize(QSize(widget.width(), widget.height()))
    generator.setViewBox(QRect(0, 0, widget.width(), widget.height()))
    generator.setTitle(title)
    generator.setDescription("")
    _draw(widget, generator)
    return bytes(data.data())


def _draw(widget: QWidget, device: QPaintDevice) -> None:
    """As the screen would show it: a graphics view's own ``render`` would leave out what is measured in pixels."""
    widget.grab(QRect(0, 0, 1, 1))  # sizes of all that is inside are settled by drawing once
    painter = QPainter(device)
    try:
        QWidget.render(widget, painter, QPoint())
    finally:
        painter.end()
