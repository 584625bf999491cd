"""The contact force over cam angle and speed as a picture: where the follower is off its cam, and the line where it leaves it."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import QRectF

from core.dynamics import ContactMap
from kindyna_gui.pictures.plots.xy import WHOLE_TURN, Line, XYPlot
from kindyna_gui.pictures.style import BLUE, DASHED, SCREEN, VERMILION, rgb
from kindyna_gui.pictures.units import short

RPM = math.pi / 30.0
FAINT, FULL = 0.06, 0.75  # opacity of no force, of the greatest
LOST = 0.3  # least opacity where the force is negative
ACROSS, UPWARDS = "Cam angle, °", "Camshaft speed, rpm"


def show_map(plot: XYPlot, found: ContactMap, own: float) -> None:
    """Blue where the cam presses the follower, vermilion where it would have to pull; the line between them, and the design's
    speed ``own`` [rpm]."""
    degrees, rpm = np.rad2deg(found.theta), found.omega / RPM
    top, step = float(rpm[-1]), float(rpm[-1]) / rpm.size
    lines = [Line(np.array(WHOLE_TURN), np.array([own, own]), SCREEN.ink, f"{short(own, 6)} rpm", DASHED)]
    for row, label in zip(found.zero / RPM, ("0 N", ""), strict=True):
        shown = np.where(row <= top, row, np.nan)
        if np.isfinite(shown).any():
            lines.append(Line(degrees, shown, VERMILION, label))
    peak = float(found.force.max())
    plot.name_axes(ACROSS, UPWARDS)
    plot.show_lines(lines, note=f"blue: up to {short(peak, 3)} N, orange: off the cam")
    low = float(rpm[0])
    plot.show_image(_coloured(found.force), QRectF(0.0, low - 0.5 * step, 360.0, top - low + step))
    plot.show_range(WHOLE_TURN, (0.0, top))


def _coloured(force: np.ndarray) -> np.ndarray:
    """Colours (n, m, 4) of forces (m, n): the stronger, the fuller."""
    most = float(np.abs(force).max()) or 1.0
    strength = np.sqrt(np.abs(force.T) / most)
    made = np.empty((*strength.shape, 4), dtype=np.ubyte)
    pressed, lost = (np.array(rgb(name), dtype=np.ubyte) for name in (BLUE, VERMILION))
    off = (force.T < 0.0)[..., None]
    made[..., :3] = np.where(off, lost, pressed)
    least = np.where(off[..., 0], LOST, FAINT)
    made[..., 3] = np.round(255.0 * (least + (FULL - least) * strength))
    return made
