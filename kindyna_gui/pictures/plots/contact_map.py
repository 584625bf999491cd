"""The contact force over cam angle and speed as a picture: where the follower is off its cam, and the line where it leaves it."""

from __future__ import annotations

import math

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor

from core.dynamics import ContactMap
from kindyna_gui.pictures.plots.xy import WHOLE_TURN, Line, XYPlot
from kindyna_gui.pictures.style import BLUE, DASHED, VERMILION
from kindyna_gui.pictures.units import short

RPM = math.pi / 30.0
FAINT, FULL = 0.06, 0.75  # opacity of no force, of the greatest
LOST = 0.3  # least opacity where the force is negative
ACROSS, UPWARDS = "Cam angle, °", "Camshaft speed, rpm"


class ContactMapPlot(XYPlot):
    """Blue where the cam presses the follower, vermilion where it would have to pull; the line between them, and the design's speed."""

    def __init__(self) -> None:
        super().__init__(ACROSS, UPWARDS)
        self.image = pg.ImageItem()
        self._include(self.image, -5.0)
        self.image.hide()

    def show_map(self, found: ContactMap, own: float) -> None:
        """Draw a map; own: the design's speed [rpm]."""
        degrees, rpm = np.rad2deg(found.theta), found.omega / RPM
        top = float(rpm[-1])
        self.image.setImage(_coloured(found.force))
        step = top / rpm.size
        self.image.setRect(QRectF(0.0, float(rpm[0]) - 0.5 * step, 360.0, top - float(rpm[0]) + step))
        self.image.show()
        lines = [Line(np.array(WHOLE_TURN), np.array([own, own]), self._theme.ink, f"{short(own, 6)} rpm", DASHED)]
        for row, label in zip(found.zero / RPM, ("0 N", ""), strict=True):
            shown = np.where(row <= top, row, np.nan)
            if np.isfinite(shown).any():
                lines.append(Line(degrees, shown, VERMILION, label))
        peak = float(found.force.max())
        self.show_lines(lines, note=f"blue: up to {short(peak, 3)} N, orange: off the cam")
        self._view.setRange(xRange=WHOLE_TURN, yRange=(0.0, top), padding=0.0)
        self._lay()

    def show_message(self, text: str) -> None:
        """A text in place of the map."""
        if hasattr(self, "image"):  # the base begins with a message
            self.image.hide()
        super().show_message(text)


def _coloured(force: np.ndarray) -> np.ndarray:
    """Colours (n, m, 4) of forces (m, n): the stronger, the fuller."""
    most = float(np.abs(force).max()) or 1.0
    strength = np.sqrt(np.abs(force.T) / most)
    made = np.empty((*strength.shape, 4), dtype=np.ubyte)
    pressed, lost = (np.array(QColor(name).getRgb()[:3], dtype=np.ubyte) for name in (BLUE, VERMILION))
    off = (force.T < 0.0)[..., None]
    made[..., :3] = np.where(off, lost, pressed)
    least = np.where(off[..., 0], LOST, FAINT)
    made[..., 3] = np.round(255.0 * (least + (FULL - least) * strength))
    return made
