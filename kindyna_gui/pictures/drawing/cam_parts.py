"""Cam, coloured profile."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QLinearGradient, QPainter, QPainterPath, QPolygonF
from PySide6.QtWidgets import QGraphicsItem, QGraphicsLineItem, QStyleOptionGraphicsItem, QWidget

from core.cam import INNER, OUTER, PRESSURE_LIMITS, SECOND, Flank
from core.errors import KindynaError, NoSolution
from core.frozen import frozen
from core.mechanism.kinematics import REVOLUTE, SLIDING
from core.study.extremes import has_undercut
from core.study.limits import limit_of
from kindyna_gui.pictures.drawing.geometry import MM, Geometry, Joint
from kindyna_gui.pictures.items import DrawnPart, Loop, Outline, Tag, pinned, text_size, turning
from kindyna_gui.pictures.shapes import arc_arrow, at, bearing, circle, cross, joined, outline, segments
from kindyna_gui.pictures.style import (
    BLUE,
    CHAIN,
    DASHED,
    DOTTED,
    ORANGE,
    OUTLINE,
    SKY,
    SPARSE,
    THIN,
    VERMILION,
    YELLOW,
    Theme,
    brush,
    no_pen,
    rgb,
)
from kindyna_gui.pictures.units import readable, short, with_unit

# -- cam parts -------------------------------------------------------------------------------------------

Z_CAM, Z_CURVES, Z_SHAFT, Z_NORMAL = 2.0, 2.5, 3.5, 8.0
RIM = 1.2  # of the plate of a grooved cam beyond its groove, in units
ARROW_START, ARROW_SPAN = 200.0, 80.0  # of the arrow of rotation, deg


def cam(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """All that turns with the camshaft, and the shaft in its bearing."""
    if not geometry.with_cam:
        return
    if geometry.profile.size:
        item = Loop(geometry.profile, theme.pen(theme.cam_line, OUTLINE), brush(theme.cam))
        yield DrawnPart("cam", item, ("cam",), Z_CAM, turning(item, geometry.turned))
        yield from _zero_mark(geometry, theme)
        for name, radius in geometry.bored:
            path = _bore(geometry.keyway) if name == "bore" and geometry.keyway else circle(radius)
            edge = Outline(path, theme.pen(theme.cam_line, THIN))
            yield DrawnPart(name, edge, ("cam",), Z_CURVES, turning(edge, geometry.turned))
        for flank in geometry.further:
            yield from FURTHER[flank.name](flank.profile * MM, geometry, theme)
        if geometry.pitch.size:
            pitch = Loop(geometry.pitch, theme.pen(theme.quiet, THIN, CHAIN))
            yield DrawnPart("pitch", pitch, ("pitch",), Z_CURVES, turning(pitch, geometry.turned))
    yield DrawnPart(
        "base", Outline(circle(geometry.base_radius), theme.pen(theme.cam_line, THIN, DOTTED)), ("base",), Z_CURVES
    )
    yield from _shaft(geometry, theme)


def _bore(keyway: Sequence[complex]) -> QPainterPath:
    """A bore with its keyway, by the corners of that: round from its last to its first."""
    first, last = keyway[0], keyway[-1]
    span = float(np.mod(np.angle(first / last), 2.0 * np.pi))
    return outline(np.append(last * np.exp(1j * np.linspace(0.0, span, 360)), keyway[:-1]))


def _groove(profile: np.ndarray, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """The plate outside the groove, whose rim the design leaves open, and the outer flank."""
    rim = float(np.abs(profile).max()) + RIM * geometry.unit
    plate = Outline(joined(circle(rim), outline(profile)), None, brush(theme.cam, 0.5))
    yield DrawnPart("plate", plate, ("cam",), Z_CAM - 0.2, turning(plate, geometry.turned))
    yield DrawnPart("rim", Outline(circle(rim), theme.pen(theme.cam_line, THIN, SPARSE)), ("cam",), Z_CAM - 0.1)
    line = Loop(profile, theme.pen(theme.cam_line, OUTLINE))
    yield DrawnPart("outer", line, ("cam",), Z_CAM, turning(line, geometry.turned))


def _second_cam(profile: np.ndarray, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """The other cam of a conjugate pair, behind the first; where that hides it, its edge is dashed."""
    item = Loop(profile, theme.pen(theme.second_line, OUTLINE), brush(theme.second))
    yield DrawnPart("second", item, ("cam",), Z_CAM - 0.5, turning(item, geometry.turned))
    hidden = Loop(profile, theme.pen(theme.second_line, THIN, DASHED))
    yield DrawnPart("second.hidden", hidden, ("cam",), Z_CAM + 0.1, turning(hidden, geometry.turned))


FURTHER: Mapping[str, Callable[[np.ndarray, Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {OUTER: _groove, SECOND: _second_cam}
)
"""Flank of a cam besides the first -> how it is drawn."""


def _zero_mark(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """A radial tick up to where the cam's own +x leaves the outline."""
    edge, inner = edge_radius(geometry.profile), 0.76 * geometry.bearing_room
    tick = Outline(segments([(inner + 0j, edge + 0j)]), theme.pen(theme.cam_line, THIN))
    yield DrawnPart("zero", tick, ("cam",), Z_CURVES, turning(tick, geometry.turned))
    tag = Tag("0°", theme.cam_line, theme)
    track = inner * np.exp(1j * np.deg2rad(geometry.turned))
    yield DrawnPart("zero.text", tag, ("cam", "labels"), Z_CURVES, _inwards(tag, track))


def _inwards(tag: Tag, track: np.ndarray) -> Callable[[int], None]:
    """The text stands a constant number of pixels towards the centre from its place."""
    move, towards = pinned(tag, track), -track / np.abs(track)

    def follow(i: int) -> None:
        move(i)
        tag.shift(13.0 * towards.real[i], -10.0 * towards.imag[i])

    return follow


def edge_radius(profile: np.ndarray) -> float:
    """Where the cam's +x axis leaves the outline [mm]."""
    after = np.roll(profile, -1)
    cut = np.flatnonzero((profile.imag <= 0.0) != (after.imag <= 0.0))
    one, other = profile[cut], after[cut]
    return float((one.real - one.imag * (other.real - one.real) / (other.imag - one.imag)).max())


def shaft_radius(geometry: Geometry) -> float:
    """Of the camshaft's bearing [mm]."""
    return min(2.0 * geometry.unit, 0.3 * geometry.bearing_room)


def sense_arc(geometry: Geometry) -> tuple[float, float, float]:
    """The arrow that shows the sense of rotation: radius [mm], start and span [deg]."""
    radius = max(1.6 * shaft_radius(geometry), 0.5 * geometry.bearing_room)
    for _, other in geometry.bored:  # it must not look like a part of them
        radius = 1.25 * other if 0.85 * other < radius < 1.2 * other else radius
    start = ARROW_START if geometry.sense > 0 else ARROW_START + ARROW_SPAN
    return radius, start, geometry.sense * ARROW_SPAN


def _shaft(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    outer = shaft_radius(geometry)
    bush, lines, shaft = bearing(0.55 * outer, outer)
    yield DrawnPart("shaft.bush", Outline(bush, theme.pen(theme.ink, THIN), brush(theme.paper)), ("ground",), Z_SHAFT)
    yield DrawnPart("shaft.hatching", Outline(lines, theme.pen(theme.quiet, THIN)), ("ground",), Z_SHAFT + 0.1)
    yield DrawnPart("shaft", Outline(shaft, theme.pen(theme.ink, THIN), brush(theme.shaft)), ("cam",), Z_SHAFT + 0.2)
    radius, start, span = sense_arc(geometry)
    line, head = arc_arrow(radius, start, span, min(1.6 * geometry.unit, 0.3 * radius))
    yield DrawnPart("sense", Outline(line, theme.pen(theme.cam_line, THIN)), ("cam",), Z_SHAFT)
    yield DrawnPart(
        "sense.head", Outline(head, theme.pen(theme.cam_line, THIN), brush(theme.cam_line)), ("cam",), Z_SHAFT
    )


def contact(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """The common normal from the contact through the roller's centre to the instant centre, which lies on it."""
    if geometry.shape is None:
        return
    line = QGraphicsLineItem()
    line.setPen(theme.pen(theme.quiet, THIN))
    yield DrawnPart("normal", line, ("normal",), Z_NORMAL, _normal_move(line, geometry))
    dot = Outline(circle(0.35 * geometry.unit), theme.pen(theme.ink, THIN), brush(theme.ink))
    yield DrawnPart("contact", dot, ("normal",), Z_NORMAL + 0.1, pinned(dot, geometry.contact))
    size = 0.8 * geometry.unit
    mark = Outline(joined(cross(1.5 * size), circle(0.55 * size)), theme.pen(theme.limit, OUTLINE))
    yield DrawnPart("centre", mark, ("centre",), Z_NORMAL + 2.0, pinned(mark, centre_within_reach(geometry)))
    ground = next((j for j in geometry.joints if j.name == geometry.kinematics.ground), None)
    if ground is None:  # the roller's link is held by no pair of its own: the line turns with its pole
        return
    ends = CENTRE_LINES[ground.pair.kind](ground, geometry)
    yield DrawnPart(
        "centre.line", Outline(segments([ends]), theme.pen(theme.quiet, THIN, SPARSE)), ("centre",), Z_NORMAL - 0.5
    )


def _reach(geometry: Geometry) -> float:
    low, high = geometry.core_box
    return 4.0 * abs(high - low)


def centre_within_reach(geometry: Geometry) -> np.ndarray:
    """The instant centre (n,) [mm], infinite also where it is too far to be drawn."""
    q = geometry.centre
    near = np.abs(np.where(np.isfinite(q), q, 0.0)) < 10.0 * _reach(geometry)
    return np.where(np.isfinite(q) & near, q, complex(np.inf, np.inf))


def _normal_move(line: QGraphicsLineItem, geometry: Geometry) -> Callable[[int], None]:
    assert geometry.shape is not None
    normal, start = geometry.shape.flank.normal, geometry.contact - geometry.face_radius * geometry.shape.flank.normal
    with np.errstate(invalid="ignore"):
        along = ((geometry.centre - start) * normal.conjugate()).real
    finite, reach = np.isfinite(along), _reach(geometry)
    overshoot = 2.0 * geometry.unit
    along = np.clip(np.where(finite, along, 0.0), -reach, reach)
    low = np.where(finite, np.minimum(along, -overshoot), -reach)
    high = np.where(finite, np.maximum(along, geometry.face_radius), reach)
    one, other = start + low * normal, start + high * normal

    def move(i: int) -> None:
        line.setLine(QLineF(at(one[i]), at(other[i])))

    return move


def _line_of_centres(ground: Joint, geometry: Geometry) -> tuple[complex, complex]:
    return 0j, complex(ground.track[0])


def _across_the_guide(ground: Joint, geometry: Geometry) -> tuple[complex, complex]:
    reach = float(np.abs(geometry.near_centres).max(initial=0.0)) + 6.0 * geometry.unit
    return -1j * reach * ground.line, 1j * reach * ground.line


CENTRE_LINES: Mapping[str, Callable[[Joint, Geometry], tuple[complex, complex]]] = MappingProxyType(
    {REVOLUTE: _line_of_centres, SLIDING: _across_the_guide}
)
"""The line on which the instant centre stays (Kennedy), by the kind of pair that holds the follower."""


# -- profile colours -------------------------------------------------------------------------------------

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


# -- the values at a place of the profile, under the mouse -----------------------------------------------

PROFILES: Mapping[str, str] = MappingProxyType({INNER: "Profile", OUTER: "Outer flank", SECOND: "Second cam"})
STRAIGHT = 1e4  # a radius of curvature above so many sizes of the cam is none


@frozen
class ProfileReading:
    """place: of the profile [mm] in the cam's own frame; cam_angle [deg] at which it is touched; radius from the cam centre
    [mm]; pressure_angle [deg]; curvature [1/mm], positive where the cam is convex; flank: its name. Where forces are drawn also
    force [N] on the flank and pressure [MPa] there, else None."""

    flank: str
    place: complex
    cam_angle: float
    radius: float
    pressure_angle: float
    curvature: float
    force: float | None = None
    pressure: float | None = None

    @property
    def text(self) -> str:
        """In one line."""
        bend = abs(self.curvature)
        if bend * self.radius * STRAIGHT < 1.0:
            curved = "straight"
        else:
            curved = f"{'convex' if self.curvature > 0.0 else 'concave'} R {short(1.0 / bend, 4)} mm"
        return (
            f"{PROFILES[self.flank]} at {self.cam_angle:.1f}°: radius {self.radius:.2f} mm, pressure angle "
            f"{self.pressure_angle:.1f}°, {curved}{self._loaded}"
        )

    @property
    def _loaded(self) -> str:
        """Force and pressure, as far as they are known."""
        text = ""
        if self.force is not None:
            rung = readable("N", abs(self.force))
            text = f", force {with_unit(short(self.force / rung.size, 4), rung.symbol)}"
        return text if self.pressure is None else f"{text}, contact pressure {short(self.pressure, 4)} MPa"


def on_cam(geometry: Geometry, index: int, at: complex) -> bool:
    """Whether a place [mm] of the global frame lies on the cam while the drawing stands at a sample."""
    if not geometry.profile.size:
        return False
    own = at * np.exp(-1j * np.deg2rad(geometry.turned[index]))
    outline = QPolygonF([QPointF(p.real, p.imag) for p in geometry.profile])
    return outline.containsPoint(QPointF(own.real, own.imag), Qt.FillRule.OddEvenFill)


def reading_at(
    geometry: Geometry, index: int, at: complex, reach: float, by_forces: bool = False
) -> ProfileReading | None:
    """The sample of the profile that is nearest to a place [mm] of the global frame while the drawing stands at a sample, no
    farther than ``reach`` [mm]; None where none is. by_forces: with force and contact pressure there."""
    if geometry.shape is None:
        return None
    local = at * np.exp(-1j * np.deg2rad(geometry.turned[index]))
    near = [(flank, np.abs(flank.profile * MM - local)) for flank in geometry.shape.flanks]
    flank, away = min(near, key=lambda each: float(each[1].min()))
    i = int(away.argmin())
    if away[i] > reach:
        return None
    place = complex(flank.profile[i] * MM)
    return ProfileReading(
        flank.name,
        place,
        float(geometry.cam_angle[i]),
        abs(place),
        float(np.rad2deg(flank.pressure_angle[i])),
        float(flank.profile_curvature[i] / MM),
        *(_loads_at(geometry, flank.name, i) if by_forces else ()),
    )


def _loads_at(geometry: Geometry, flank: str, i: int) -> tuple[float | None, float | None]:
    """Force [N] on a flank and contact pressure [MPa] at a sample, as far as they have an answer."""
    study, shape = geometry.study, geometry.shape
    assert shape is not None
    try:
        force = next(c.force[i] for f, c in zip(shape.flanks, study.dynamics.contacts, strict=True) if f.name == flank)
        stress = study.stress.get(flank) if study.jam is None and not has_undercut(study) else None
    except NoSolution:
        return None, None
    pressure = None if stress is None else float(stress.pressure[i]) / MPA
    return float(force) if np.isfinite(force) else None, pressure
