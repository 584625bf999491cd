"""A picture of the points of a profile file on its curve, with the place where it deviates most."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QSize
from PySide6.QtGui import QPainter, QPaintEvent, QTransform
from PySide6.QtWidgets import QSizePolicy, QWidget

from core.frozen import frozen
from core.output.files.profile_files import ProfileDrawing
from kindyna_gui.pictures.shapes import at, circle, outline, segments
from kindyna_gui.pictures.style import CHAIN, OUTLINE, SCREEN, THIN, brush, no_pen

DRAWN = 1440  # points of the curve
MARGIN = 24  # pixels
MOST_DOTS = 2000  # beyond these they are too close to be told apart
DOT, RING = 2.2, 8.0  # radii, pixels
CROSS = 5.0  # half the size of the cam centre's mark, pixels


@frozen(eq=False)
class Preview:
    """What is shown, all in mm: the curve of the file (n,), its points (m,), where it deviates most, and the profiles beside it: of
    a cutter's path its own, of a drawing those of all flanks, each (k,)."""

    job: ProfileDrawing
    curve: np.ndarray
    points: np.ndarray
    worst: complex
    profiles: tuple[np.ndarray, ...]


def preview(job: ProfileDrawing) -> Preview:
    """The picture of a job."""
    main, part = job.main, np.arange(DRAWN) / DRAWN
    beside = [drawn.curve.at(drawn.curve.length * part) for drawn in job.profiles.values() if drawn is not main]
    if job.request.cutter_mm and not beside:
        beside = [job.profile]
    return Preview(job, main.curve.at(main.curve.length * part), main.chain.vertices, main.worst, tuple(beside))


class PreviewPicture(QWidget):
    """Draws the last preview, faintly while another is computed."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.shown: Preview | None = None
        self._faint = False
        self.setAccessibleName("Picture of the profile")
        self.setMinimumSize(300, 300)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def sizeHint(self) -> QSize:
        return QSize(420, 420)

    def show_preview(self, shown: Preview | None) -> None:
        """Draw this profile; None: nothing."""
        self.shown, self._faint = shown, False
        self.update()

    def wait(self) -> None:
        self._faint = True
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), brush(SCREEN.paper))
        if self.shown is None:
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._faint:
            painter.setOpacity(0.35)
        self._draw(painter, self.shown)

    def _draw(self, painter: QPainter, shown: Preview) -> None:
        mm = self._scale(shown)
        painter.setPen(SCREEN.pen(SCREEN.quiet, THIN, CHAIN))
        for profile in shown.profiles:
            painter.drawPath(mm.map(outline(profile)))
        painter.setPen(SCREEN.pen(SCREEN.ink, OUTLINE))
        painter.drawPath(mm.map(outline(shown.curve)))
        centre = mm.map(QPointF(0.0, 0.0))
        painter.setPen(SCREEN.pen(SCREEN.quiet, THIN))
        place = complex(centre.x(), centre.y())
        painter.drawPath(segments([(place - CROSS, place + CROSS), (place - 1j * CROSS, place + 1j * CROSS)]))
        painter.setPen(no_pen())
        painter.setBrush(brush(SCREEN.family("displacement")))
        some = shown.points[:: 1 + shown.points.size // MOST_DOTS]
        for dot in (mm.map(at(z)) for z in some.tolist()):
            painter.drawEllipse(dot, DOT, DOT)
        worst = mm.map(at(shown.worst))
        painter.strokePath(circle(RING, complex(worst.x(), worst.y())), SCREEN.pen(SCREEN.limit, OUTLINE))

    def _scale(self, shown: Preview) -> QTransform:
        """From mm, y upwards, to pixels: all of the picture in sight."""
        z = np.concatenate((shown.curve, *shown.profiles, [0.0]))
        low, high = complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
        size, middle = high - low, 0.5 * (low + high)
        scale = min((self.width() - 2 * MARGIN) / size.real, (self.height() - 2 * MARGIN) / size.imag)
        made = QTransform().translate(0.5 * self.width(), 0.5 * self.height())
        return made.scale(scale, -scale).translate(-middle.real, -middle.imag)
