"""What a measured cam deviates, drawn around its profile many times larger, between the lines of its tolerance."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QPainter, QPaintEvent, QTransform
from PySide6.QtWidgets import QSizePolicy, QWidget

from core.frozen import frozen
from core.motion import TURN
from core.output.files.inspection import ProfileComparison
from kindyna_gui.pictures.shapes import at, circle, outline, polyline, segments
from kindyna_gui.pictures.style import CHAIN, OUTLINE, SCREEN, THIN, brush, no_pen

DRAWN = 1440  # points of the profile
MARGIN = 44  # pixels, in which the cam angles stand
DOT, RING, CROSS = 2.4, 8.0, 5.0  # pixels
STEP_DEG = 30
GAP, REACH = 6.0, 18.0  # from what is drawn to the end of the strokes and to the names of cam angles, pixels
WIDE_GAP = 10.0  # deg without a row, across which no line is drawn


@frozen(eq=False)
class ShownComparison:
    """A comparison with the profile: its points (n,) [mm] and normals away from the cam (n,)."""

    comparison: ProfileComparison
    profile: np.ndarray
    normal: np.ndarray


def shown(comparison: ProfileComparison) -> ShownComparison:
    """Everything that is drawn, computed."""
    at_probe = comparison.setup
    there = at_probe.exact(at_probe.study.program.angles(TURN * np.arange(DRAWN) / DRAWN))
    comparison.findings  # noqa: B018 - here, not in the window's thread
    return ShownComparison(comparison, there.z, at_probe.side * 1j * there.tangent)


def magnified(result: ProfileComparison, factor: float) -> np.ndarray:
    """The measured rows (n,) [mm] in the cam's own frame, so many times as far from the profile as they are."""
    return np.asarray(
        result.table.contact + factor * result.setup.outward * result.normal_deviation * result.table.normal
    )


class DeviationPicture(QWidget):
    """Draws the last comparison, faintly while another is computed; ``factor``: how many times larger deviations are drawn."""

    def __init__(self) -> None:
        super().__init__()
        self.shown: ShownComparison | None = None
        self.factor = 100.0
        self.message = ""
        self._faint, self._chosen = False, -1
        self.setAccessibleName("Deviations from the profile, magnified")
        self.setMinimumSize(420, 380)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def sizeHint(self) -> QSize:
        return QSize(560, 560)

    def show_comparison(self, made: ShownComparison | None, message: str = "") -> None:
        """Draw what was measured beside the profile; None: the message alone."""
        self.shown, self.message, self._faint, self._chosen = made, message, False, -1
        self.update()

    def magnify(self, factor: float) -> None:
        """Draw deviations so many times as large as they are."""
        self.factor = factor
        self.update()

    def point_out(self, row: int) -> None:
        """Ring a row, none where negative."""
        self._chosen = row
        self.update()

    def wait(self) -> None:
        self._faint = True
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), brush(SCREEN.paper))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._faint:
            painter.setOpacity(0.35)
        if self.shown is not None:
            self._draw(painter, self.shown)
        elif self.message:
            painter.setPen(SCREEN.pen(SCREEN.quiet))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, self.message)
        painter.end()

    # -- what is drawn -------------------------------------------------------------------------------------------

    def _draw(self, painter: QPainter, made: ShownComparison) -> None:
        result, factor = made.comparison, self.factor
        band = result.setup.request.tolerance_mm * factor
        sides = [made.profile + sign * band * made.normal for sign in (-1.0, 1.0)]
        outward = result.setup.outward
        measured = magnified(result, factor)
        largest = max(band, factor * float(np.abs(result.normal_deviation).max()))
        outer = made.profile + outward * largest * made.normal
        mm = self._scale(outer)
        painter.setPen(SCREEN.pen(SCREEN.cam_line, THIN))
        painter.setBrush(brush(SCREEN.cam) if outward > 0.0 else Qt.BrushStyle.NoBrush)
        painter.drawPath(mm.map(outline(made.profile)))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(SCREEN.pen(SCREEN.limit, THIN))
        for curve in sides:
            painter.drawPath(mm.map(outline(curve)))
        self._name_angles(painter, result, mm, outer)
        painter.setPen(SCREEN.pen(SCREEN.family("displacement"), OUTLINE))
        for stretch in _stretches(result.table.degrees):
            painter.drawPath(mm.map(polyline(measured[stretch].tolist())))
        painter.setPen(no_pen())
        painter.setBrush(brush(SCREEN.limit))
        for place in measured[result.is_outside].tolist():
            painter.drawEllipse(mm.map(at(place)), DOT, DOT)
        self._mark(painter, result, mm, measured)
        painter.setPen(SCREEN.pen(SCREEN.quiet))
        place = self.rect().adjusted(8, 4, -8, -4)
        painter.drawText(
            place,
            Qt.AlignmentFlag.AlignBottom | Qt.AlignmentFlag.AlignLeft,
            f"Deviation × {factor:g} (blue), tolerance (red), cam angles",
        )

    def _mark(self, painter: QPainter, result: ProfileComparison, mm: QTransform, measured: np.ndarray) -> None:
        """The largest deviation with its value and angle, and the row that was pointed out."""
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if 0 <= self._chosen < measured.size and self._chosen != result.worst_row:
            chosen = mm.map(at(complex(measured[self._chosen])))
            painter.strokePath(circle(RING, complex(chosen.x(), chosen.y())), SCREEN.pen(SCREEN.ink, OUTLINE))
        row = result.worst_row
        place, centre = mm.map(at(complex(measured[row]))), mm.map(QPointF(0.0, 0.0))
        spot = complex(place.x(), place.y())
        inwards = complex(centre.x(), centre.y()) - spot
        inwards /= abs(inwards) or 1.0
        colour = SCREEN.limit if result.is_outside[row] else SCREEN.ink
        text = f"{1e3 * result.normal_deviation[row]:+.4g} µm at {result.table.degrees[row]:.4g}°"
        size = painter.fontMetrics().size(0, text)
        foot = spot + inwards * (RING + 26.0)
        painter.strokePath(circle(RING, spot), SCREEN.pen(colour, OUTLINE))
        painter.strokePath(segments([(spot + inwards * RING, foot)]), SCREEN.pen(colour, THIN))
        # the text lies further inwards, where the cam is plain
        middle = foot + complex(inwards.real * (0.5 * size.width() + 4.0), inwards.imag * (0.5 * size.height() + 4.0))
        box = QRectF(
            middle.real - 0.5 * size.width() - 3.0, middle.imag - 0.5 * size.height(), size.width() + 6.0, size.height()
        )
        painter.fillRect(box, brush(SCREEN.paper))
        painter.setPen(SCREEN.pen(colour))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _name_angles(self, painter: QPainter, result: ProfileComparison, mm: QTransform, outer: np.ndarray) -> None:
        """Where each cam angle is measured, just outside of all that is drawn; the cam centre with its mark."""
        centre = mm.map(QPointF(0.0, 0.0))
        place, setup = complex(centre.x(), centre.y()), result.setup
        painter.setPen(SCREEN.pen(SCREEN.quiet, THIN))
        painter.drawPath(segments([(place - CROSS, place + CROSS), (place - 1j * CROSS, place + 1j * CROSS)]))
        around = np.angle(outer)
        order = np.argsort(around)
        for degrees in range(0, 360, STEP_DEG):
            turned = setup.direction - setup.study.sense * np.deg2rad(degrees)
            line = complex(np.cos(turned), -np.sin(turned))  # pixels run downwards
            reach = mm.m11() * float(np.interp(turned, around[order], np.abs(outer[order]), period=TURN))
            painter.setPen(SCREEN.pen(SCREEN.faint, THIN, CHAIN))
            painter.drawPath(segments([(place, place + (reach + GAP) * line)]))
            painter.setPen(SCREEN.pen(SCREEN.quiet, THIN))
            tip = place + (reach + REACH) * line
            painter.drawText(
                QRectF(tip.real - 20.0, tip.imag - 8.0, 40.0, 16.0), Qt.AlignmentFlag.AlignCenter, f"{degrees}°"
            )

    def _scale(self, outer: np.ndarray) -> QTransform:
        """From mm, y upwards, to pixels: all that is drawn in sight."""
        z = np.append(outer, 0.0)
        low, high = complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
        size, middle = high - low, 0.5 * (low + high)
        scale = min((self.width() - 2 * MARGIN) / size.real, (self.height() - 2 * MARGIN) / size.imag)
        made = QTransform().translate(0.5 * self.width(), 0.5 * self.height())
        return made.scale(scale, -scale).translate(-middle.real, -middle.imag)


def _stretches(degrees: np.ndarray) -> list[np.ndarray]:
    """Rows in the order of their cam angles, cut where a gap is too wide for a line; the last joins the first."""
    order = np.argsort(degrees, kind="stable")
    if not order.size:
        return []
    closed = np.append(order, order[0])
    steps = np.diff(np.append(degrees[order], degrees[order[0]] + 360.0))
    wide = steps > max(WIDE_GAP, 3.0 * float(np.median(steps)))
    return [part for part in np.split(closed, np.flatnonzero(wide) + 1) if part.size > 1]


__all__ = ["DeviationPicture", "ShownComparison", "magnified", "shown"]
