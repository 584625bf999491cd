"""Where a text may stand without covering others: boxes in pixels, y downwards."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from PySide6.QtCore import QPointF, QRectF, QSizeF

SIDE = 8.0  # of a text from the point it belongs to, pixels
STEPS = 6  # heights of a text that it may be moved up or down


def near(at: QPointF, size: QSizeF, left: bool, taken: Sequence[QRectF], room: QRectF) -> QRectF:
    """The box of a text beside a point: on the wanted side at the point's height if that is free, else as near to it as
    can be; where nothing is free, as if all were."""
    boxes = list(_places(at, size, left))
    inside = [box for box in boxes if room.contains(box)]
    free = (box for box in inside if not any(box.intersects(other) for other in taken))
    return next(free, inside[0] if inside else boxes[0])


def _places(at: QPointF, size: QSizeF, left: bool) -> Iterator[QRectF]:
    for step in range(STEPS):
        for up in (step, -step) if step else (0,):
            for side in (left, not left):
                x = at.x() - SIDE - size.width() if side else at.x() + SIDE
                yield QRectF(QPointF(x, at.y() - (0.5 + 0.5 * up) * size.height()), size)
