"""A small picture of a motion law: its displacement, and its acceleration thin behind."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainter, QPolygonF

from core.design import Curve, PolynomialCurve, PolynomialEnd, Segment, SplineCurve, SplinePoint, TableCurve, curve_of
from core.laws import PieceTable, find_law
from core.motion.curves import segment_shape
from kindyna_gui.pictures.style import THIN, Theme

SAMPLES = 49  # angles on each piece of a law
SPAN = 90.0  # of the segment that is drawn, degrees
_EXAMPLES: Mapping[str, Curve] = MappingProxyType(
    {
        "polynomial": PolynomialCurve(PolynomialEnd(), PolynomialEnd(velocity=0.02)),
        "table": TableCurve(
            tuple(SplinePoint(SPAN * u, u * u * (3.0 - 2.0 * u)) for u in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0))
        ),
        "spline": SplineCurve((SplinePoint(22.0, 0.55), SplinePoint(48.0, 0.3), SplinePoint(70.0, 0.8))),
    }
)
"""Examples drawn for the laws whose curve follows from their parameters alone."""


def _segment(slug: str) -> Segment:
    law = find_law(slug)
    rise = 0.0 if law is not None and law.is_dwell else -1.0 if law is not None and law.rises < 0 else 1.0
    return Segment(SPAN, rise, _EXAMPLES.get(slug) or curve_of(slug))


@lru_cache(maxsize=128)
def curves_of(slug: str) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """Displacement and acceleration of a law over u = 0 ... 1, each (n,) places and (n,) values scaled to -1 ... 1:
    the displacement begins at 0, or ends there where the law is a return; the acceleration breaks where it jumps."""
    shape = segment_shape(_segment(slug), False, slug)
    table, starts = PieceTable(shape.pieces), [piece.start for piece in shape.pieces]
    places, rows = [], []
    for i, (start, end) in enumerate(zip(starts, [*starts[1:], 1.0], strict=True)):
        w = np.linspace(0.0, end - start, SAMPLES)
        places.append(start + w)
        row = table.rows(np.full(w.size, i), w)
        rows.append(shape.gain * np.array([row(0), row(2)]))
    u, (height, y2) = np.concatenate(places), np.concatenate(rows, axis=1)
    height += 1.0 if shape.gain < 0.0 else 0.0
    largest = float(np.abs(y2).max())
    acceleration = y2 / largest if largest > 1e-9 else np.zeros_like(u)
    return (u, height), (u, acceleration)


def prescribed(slug: str) -> tuple[tuple[float, float], ...]:
    """Points that the picture's curve is made to pass, (u, s) each."""
    curve = _EXAMPLES.get(slug)
    points = curve.points if isinstance(curve, SplineCurve) else ()
    return tuple((p.at_deg / SPAN, p.value) for p in points if p.value is not None)


def paint_law(painter: QPainter, box: QRectF, slug: str, theme: Theme) -> None:
    """Paint a law into a box: s from bottom to top, a about the middle."""
    displacement, acceleration = curves_of(slug)
    left, width, low, high, middle = box.left(), box.width(), box.bottom(), box.top(), box.center().y()
    painter.setPen(theme.pen(theme.faint))
    painter.drawLine(QPointF(left, middle), QPointF(box.right(), middle))
    painter.setPen(theme.pen(theme.family("acceleration"), 0.8))
    painter.setOpacity(0.7)
    # from the axis and back to it: a jump at an end is part of the law
    painter.drawPolyline(
        _polygon(
            np.concatenate(([0.0], acceleration[0], [1.0])),
            np.concatenate(([0.0], acceleration[1], [0.0])),
            left,
            width,
            middle,
            middle - high,
        )
    )
    painter.setOpacity(1.0)
    painter.setPen(theme.pen(theme.family("displacement"), 1.6))
    painter.drawPolyline(_polygon(*displacement, left, width, low, low - high))
    painter.setPen(theme.pen(theme.family("displacement"), THIN))
    painter.setBrush(theme.paper)
    for u, s in prescribed(slug):
        painter.drawRect(QRectF(left + u * width - 2.0, low - s * (low - high) - 2.0, 4.0, 4.0))


def _polygon(u: np.ndarray, v: np.ndarray, left: float, width: float, zero: float, height: float) -> QPolygonF:
    return QPolygonF([QPointF(x, y) for x, y in zip(left + u * width, zero - v * height, strict=True)])


__all__ = ["curves_of", "paint_law", "prescribed"]
