"""Small pictures of designs, without texts, by which they are chosen."""

from __future__ import annotations

from functools import lru_cache

from PySide6.QtCore import QPoint, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtWidgets import QWidget

from core.design import Design
from core.errors import KindynaError
from core.study import Study
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.drawing.layers import EVERY_LAYER
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.files import MechanismSheet

SAMPLES = 180  # of a turn
TURNED = 0.125  # of a turn, at which the mechanism stands
_LEFT_OUT = ("labels", "scale", "pitch", "base", "normal", "centre", "loads")


def _mechanism(design: Design, width: int, height: int) -> MechanismSheet:
    scene = MechanismScene()
    for layer in EVERY_LAYER:
        scene.set_layer(layer, layer not in _LEFT_OUT and EVERY_LAYER[layer].shown)
    scene.update_study(Study(design, SAMPLES))
    assert scene.overlay is not None
    scene.overlay.angle.hide()
    scene.set_fraction(TURNED)
    return MechanismSheet(scene, width, height, scene.fill(width, height))


def _drives(design: Design, width: int, height: int) -> MechanismSheet:
    scene = Assembly()
    scene.show_shaft(Study(design, SAMPLES).camshaft, 0, about_shaft=False, layers=())
    for part in (scene.overlay.angle, scene.overlay.bar, *(figure.tag for figure in scene.figures.values())):
        part.hide()
    scene.set_fraction(TURNED)
    scene.fit(width, height)  # as many drives in a row as suit the picture
    whole = scene.fit_rect()
    scale = min(width / whole.width(), height / whole.height())
    room = QRectF(0.0, 0.0, width / scale, height / scale)
    room.moveCenter(whole.center())
    return MechanismSheet(scene, width, height, (room, scale))


@lru_cache(maxsize=128)
def thumbnail(design: Design, width: int, height: int, ratio: float = 1.0) -> QImage:
    """A small picture of the mechanism, or of all drives; empty where it has no position."""
    picture = QImage(QSize(width, height) * ratio, QImage.Format.Format_RGB32)
    picture.setDevicePixelRatio(ratio)
    picture.fill(Qt.GlobalColor.white)
    try:
        sheet = (_drives if design.listed else _mechanism)(design, width, height)
    except KindynaError:
        return picture
    sheet.grab(QRect(0, 0, 1, 1))  # sizes are settled by drawing once
    painter = QPainter(picture)
    QWidget.render(sheet, painter, QPoint())
    painter.end()
    sheet.deleteLater()
    return picture
