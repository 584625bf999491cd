"""What a picture of a mechanism must hold, and at which scale it fills a sheet."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import numpy as np
from PySide6.QtCore import QRectF

from core.instant_centres import CentreTable
from core.instant_centres.construction import Key
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.drawing.overlay import BOTTOM_STRIP, TOP_STRIP
from kindyna_gui.pictures.items import DrawnPart
from kindyna_gui.preferences.units import sized

FAR_CENTRES = 12.0  # sizes of the mechanism
MARGIN_UNITS = 4.5  # around all that moves, in units of the symbols
_STANDING = ("rails", "ground", "pedestal", "rim", "dimensions")


def whole(geometry: Geometry, parts: Iterable[DrawnPart]) -> QRectF:
    """The rectangle that holds the mechanism over the whole turn [mm]: all that moves, the ground it stands on, and
    the instant centre where it is near."""
    low, high = geometry.core_box
    rect = QRectF(low.real, low.imag, (high - low).real, (high - low).imag)
    for part in parts:
        if part.move is None and part.key.partition(".")[0] in _STANDING:
            rect = rect.united(part.item.boundingRect())
        if part.move is not None and part.key.startswith(("spring.", "load.")):
            for i in range(0, geometry.samples, max(1, geometry.samples // 8)):
                part.move(i)
                rect = rect.united(part.item.sceneBoundingRect())
        if part.move is not None and part.key.startswith("stem."):
            for i in (int(np.argmin(np.abs(geometry.reference))), int(np.argmax(np.abs(geometry.reference)))):
                part.move(i)
                rect = rect.united(part.item.sceneBoundingRect())
    q = geometry.near_centres
    if q.size:
        x, y = q.real, q.imag
        left, below = float(x.min()), float(y.min())
        rect = rect.united(QRectF(left, below, float(x.max()) - left + 1e-9, float(y.max()) - below + 1e-9))
    room = MARGIN_UNITS * geometry.unit
    return rect.adjusted(-room, -room, room, room)


def with_centres(rect: QRectF, table: CentreTable, index: int, only: Collection[Key] | None = None) -> QRectF:
    """A rectangle [mm] that holds another one and the instant centres at a sample, all or the chosen ones, but those farther away than
    ``FAR_CENTRES`` of its size, beside which the mechanism would be a dot."""
    reach = FAR_CENTRES * max(rect.width(), rect.height())
    edge, middle = 0.03 * max(rect.width(), rect.height()), complex(rect.center().x(), rect.center().y())
    for key, centres in table.centres.items():
        if (only is not None and key not in only) or centres.far(table.size)[index]:
            continue
        place = MM * complex(centres.finite[index])
        if abs(place - middle) <= reach:
            rect = rect.united(QRectF(place.real - edge, place.imag - edge, 2.0 * edge, 2.0 * edge))
    return rect


def fitted(rect: QRectF, width: float, height: float, list_height: float = 0.0) -> tuple[QRectF, float]:
    """What a picture of so many pixels shows when a rectangle [mm] fills it between the strips that texts need:
    visible rectangle [mm] and scale [pixels per mm]. list_height: of a list at the top [pixels]."""
    top = sized(TOP_STRIP) + list_height
    room = max(height - top - sized(BOTTOM_STRIP), 0.3 * height)
    scale = min(width / rect.width(), room / rect.height())
    visible = _about(rect, width, height, scale)
    visible.translate(0.0, -0.5 * (sized(BOTTOM_STRIP) - top) / scale)
    return visible, scale


def filled(rect: QRectF, width: float, height: float) -> tuple[QRectF, float]:
    """The same without strips for texts."""
    scale = min(width / rect.width(), height / rect.height())
    return _about(rect, width, height, scale), scale


def _about(rect: QRectF, width: float, height: float, scale: float) -> QRectF:
    visible = QRectF(0.0, 0.0, width / scale, height / scale)
    visible.moveCenter(rect.center())
    return visible
