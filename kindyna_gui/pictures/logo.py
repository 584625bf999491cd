"""A logo on paper, as large as its box lets it be."""

from __future__ import annotations

from PySide6.QtCore import QByteArray, QRectF, QSizeF, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtSvg import QSvgRenderer

from core.output.files.sheet import SVG, Logo


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


__all__ = ["paint_logo"]
