"""The profile coloured by pressure angle, curvature or contact pressure, each with its scale of colours."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QRectF
from PySide6.QtGui import QBrush, QColor, QLinearGradient, QPainter, QPainterPath
from PySide6.QtWidgets import QGraphicsItem, QStyleOptionGraphicsItem, QWidget

from core.cam import PRESSURE_LIMITS, Flank
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism.kinematics import REVOLUTE
from core.study.extremes import has_undercut
from core.study.limits import limit_of
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.items import DrawnPart, text_size, turning
from kindyna_gui.pictures.shapes import outline
from kindyna_gui.pictures.style import BLUE, ORANGE, SKY, VERMILION, YELLOW, Theme, no_pen, rgb
from kindyna_gui.pictures.units import short

COLOURS = 24  # between the ends of a scale
WIDTH = 4.0  # of the coloured line, pixels
MOST = 720  # pieces of a coloured line
DIGITS = 2  # of the radius at the end of a scale
MPA = 1e6  # Pa in one
USUAL_PART = 98.0  # per cent of the profile whose curvature lies on the scale; a tip has the colour of its end
NEUTRAL = "#B4BCC3"
APART = 8.0  # between the texts of a scale, pixels
Z_COLOURS = 2.7


@frozen
class ColourScale:
    """Colours over a range of values, those beyond it in the colour of the nearer end, or ``beyond`` above it.

    stops   part of the range 0 ... 1 and colour; ticks: value and text
    """

    title: str
    low: float
    high: float
    stops: tuple[tuple[float, str], ...]
    ticks: tuple[tuple[float, str], ...]
    beyond: str = ""

    def part(self, values: np.ndarray) -> np.ndarray:
        """Where values (n,) stand in the range, 0 ... 1, and 2 beyond it where that has a colour of its own."""
        part = (values - self.low) / (self.high - self.low)
        over = (part > 1.0 + 1e-9) & bool(self.beyond)
        return np.where(over, 2.0, np.clip(np.nan_to_num(part, nan=1.0), 0.0, 1.0))

    def colour(self, part: float) -> QColor:
        """The colour at a part of the range."""
        if part > 1.0:
            return QColor(self.beyond)
        places = [place for place, _ in self.stops]
        channels = np.array([rgb(colour) for _, colour in self.stops], dtype=float)
        return QColor(*(round(float(np.interp(part, places, channel))) for channel in channels.T))

    def gradient(self, width: float) -> QLinearGradient:
        """From left to right over so many pixels."""
        gradient = QLinearGradient(0.0, 0.0, width, 0.0)
        for part, colour in self.stops:
            gradient.setColorAt(part, QColor(colour))
        return gradient


def _pressure_scale(geometry: Geometry, theme: Theme) -> ColourScale:
    """From 0 to the usual limit; what exceeds it has the colour of limits."""
    kinematics = geometry.kinematics
    kind = kinematics.pairs[kinematics.ground].kind if kinematics.ground else REVOLUTE
    limit = PRESSURE_LIMITS[kind]
    ticks = tuple((part * limit, f"{short(part * limit)}°") for part in (0.0, 0.5, 1.0))
    stops = ((0.0, SKY), (0.45, YELLOW), (0.75, ORANGE), (1.0, VERMILION))
    return ColourScale("Pressure angle to the usual limit", 0.0, limit, stops, ticks, theme.limit)


def _curvature_scale(geometry: Geometry, theme: Theme) -> ColourScale:
    """From concave to convex, named by the radii at the ends; only the convex half where nothing is concave."""
    assert geometry.shape is not None
    bends = np.concatenate([_curvature(geometry, flank) for flank in geometry.shape.flanks])
    bends = bends[np.isfinite(bends)]
    size = float(np.percentile(np.abs(bends), USUAL_PART)) if bends.size else 0.0
    radius = float(f"{1.0 / size:.{DIGITS}g}") if size else 1.0
    convex = ((0.0, NEUTRAL), (0.5, ORANGE), (1.0, VERMILION))
    ends = ((0.0, "straight"), (1.0 / radius, f"convex R {short(radius)}"))
    if not (bends < 0.0).any():
        return ColourScale("Radius of curvature, mm", 0.0, 1.0 / radius, convex, ends)
    both = ((0.0, BLUE), (0.25, SKY), *((0.5 + 0.5 * part, colour) for part, colour in convex))
    ticks = ((-1.0 / radius, f"concave R {short(radius)}"), *ends)
    return ColourScale("Radius of curvature, mm", -1.0 / radius, 1.0 / radius, both, ticks)


def _stress_scale(geometry: Geometry, theme: Theme) -> ColourScale | None:
    """From 0 to what the user or the materials allow, beyond which is the colour of limits; to the highest where none is known."""
    study = geometry.study
    try:
        if not study.stress or has_undercut(study) or study.jam is not None:
            return None
        highest = max((float(np.max(each.pressure)) for each in study.stress.values()), default=0.0) / MPA
    except KindynaError:
        return None
    allowed = limit_of(study, "contact_pressure_mpa")
    top = float(f"{highest:.{DIGITS}g}") or 1.0 if allowed is None else allowed.value  # 1: nothing presses
    ticks = tuple(
        (part * top, f"{short(part * top, 4)} MPa" if part == 1.0 else short(part * top, 4)) for part in (0.0, 0.5, 1.0)
    )
    stops = ((0.0, NEUTRAL), (0.25, SKY), (0.5, YELLOW), (0.75, ORANGE), (1.0, VERMILION))
    title = "Contact pressure" if allowed is None else "Contact pressure to what is allowed"
    return ColourScale(title, 0.0, top, stops, ticks, "" if allowed is None else theme.limit)


def _stress(geometry: Geometry, flank: Flank) -> np.ndarray:
    """[MPa]"""
    return np.asarray(geometry.study.stress[flank.name].pressure / MPA)


def _pressure_angle(geometry: Geometry, flank: Flank) -> np.ndarray:
    return np.rad2deg(flank.pressure_angle)


def _curvature(geometry: Geometry, flank: Flank) -> np.ndarray:
    """[1/mm]"""
    return np.asarray(flank.profile_curvature / MM)


@frozen
class Colouring:
    """scale: of a study's cam, None where it has no such values; values: of a flank, on that scale (n,)."""

    scale: Callable[[Geometry, Theme], ColourScale | None]
    values: Callable[[Geometry, Flank], np.ndarray]


COLOURINGS: Mapping[str, Colouring] = MappingProxyType(
    {
        "pressure_colours": Colouring(_pressure_scale, _pressure_angle),
        "curvature_colours": Colouring(_curvature_scale, _curvature),
        "stress_colours": Colouring(_stress_scale, _stress),
    }
)
"""Layer -> what the profile is coloured by."""


class ColouredLoop(QGraphicsItem):
    """A closed line whose pieces have the colours of their values: points (n,) [mm], part of the scale (n,).

    Filled ribbons, as wide in pixels as ``look`` is told: a pen of that width would take a hundred times as long.
    """

    def __init__(self, points: np.ndarray, parts: np.ndarray, scale: ColourScale) -> None:
        super().__init__()
        step = max(1, points.size // MOST)
        points, parts = points[::step], parts[::step]
        along = np.roll(points, -1) - np.roll(points, 1)
        self._points, self._across = _closed(points), _closed(1j * along / np.where(along == 0.0, 1.0, np.abs(along)))
        bins = np.minimum(np.round(_closed(parts) * COLOURS), COLOURS + 1).astype(int)
        cuts = np.flatnonzero(np.diff(bins)) + 1
        self._runs = list(zip([0, *cuts], [*cuts, bins.size], strict=True))
        self._brushes = [QBrush(scale.colour(bins[start] / COLOURS)) for start, _ in self._runs]
        self._paths: list[QPainterPath] = []
        self._scale = 0.0
        x, y = points.real, points.imag
        self._bounds = QRectF(float(x.min()), float(y.min()), float(np.ptp(x)), float(np.ptp(y)))

    def look(self, scale: float) -> None:
        """Be drawn at so many pixels per mm."""
        if scale != self._scale:
            self._scale, half = scale, 0.5 * WIDTH / scale * self._across
            one, other = self._points + half, self._points - half
            self._paths = [
                outline(np.concatenate((one[start : stop + 1], other[start : stop + 1][::-1])))
                for start, stop in self._runs
            ]
            self.update()

    @property
    def colours(self) -> set[str]:
        """Those of its pieces."""
        return {brush.color().name() for brush in self._brushes}

    def boundingRect(self) -> QRectF:
        return self._bounds

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        painter.setPen(no_pen())
        for fill, path in zip(self._brushes, self._paths, strict=False):
            painter.fillPath(path, fill)


def _closed(values: np.ndarray) -> np.ndarray:
    return np.append(values, values[:1])


def scale_of(layer: str, geometry: Geometry, theme: Theme) -> ColourScale | None:
    """The scale of a layer of colours; None of any other, and where there is no cam."""
    return COLOURINGS[layer].scale(geometry, theme) if layer in COLOURINGS and geometry.shape is not None else None


def coloured(layer: str, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Every flank in the colours of a layer."""
    scale = scale_of(layer, geometry, theme)
    if scale is None or geometry.shape is None:
        return
    for flank in geometry.shape.flanks:
        item = ColouredLoop(flank.profile * MM, scale.part(COLOURINGS[layer].values(geometry, flank)), scale)
        yield DrawnPart(f"{layer}.{flank.name}", item, ("cam", layer), Z_COLOURS, turning(item, geometry.turned))


def colour_bar(scale: ColourScale, width: float) -> Iterator[tuple[float, str]]:
    """Where the ticks of a scale stand on a bar of so many pixels, and their texts."""
    for value, text in scale.ticks:
        yield width * (value - scale.low) / (scale.high - scale.low), text


def bar_width(scale: ColourScale) -> float:
    """The least width of a bar [pixels] on which the texts of the ticks, each within its ends, stand clear of each other."""
    ticks = [(part, text_size(text)[0]) for part, text in colour_bar(scale, 1.0)]
    return max(
        ((APART + one + part * other - at * one) / (part - at) for (at, one), (part, other) in pairwise(ticks)),
        default=0.0,
    )
