"""Drawing of the cam, the contact and the coloured profile, and the values at a point of the profile.

Lengths are in mm, angles in degrees. Curves of the cam are given in the frame of the cam and rotate with it.
"""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QLineF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QLinearGradient, QPainter, QPainterPath, QPolygonF
from PySide6.QtWidgets import QGraphicsItem, QGraphicsLineItem, QStyleOptionGraphicsItem, QWidget

from core.cam import INNER, OUTER, PRESSURE_LIMITS, SECOND, Flank
from core.errors import KindynaError, NoSolution
from core.frozen import frozen
from core.mechanism.kinematics import REVOLUTE, SLIDING
from core.output.drawing.palette import BLUE, ORANGE, SKY, VERMILION, YELLOW
from core.study.extremes import has_undercut
from core.study.limits import limit_of
from kindyna_gui.pictures.drawing.geometry import MM, Geometry, Joint
from kindyna_gui.pictures.items import DrawnPart, Loop, Outline, Tag, pinned, standing_at, text_size, turning
from kindyna_gui.pictures.shapes import arc_arrow, at, bearing, circle, cross, joined, keyed_bore, outline, segments
from kindyna_gui.pictures.style import CHAIN, DASHED, DOTTED, OUTLINE, SPARSE, THIN, Theme, brush, no_pen, rgb
from kindyna_gui.pictures.units import number, readable_text, short

if TYPE_CHECKING:
    from kindyna_gui.pictures.drawing.spatial_parts import EdgeReading

# -- cam and shaft -------------------------------------------------------------------------------------

Z_CAM, Z_CURVES, Z_SHAFT, Z_NORMAL = 2.0, 2.5, 3.5, 8.0
RIM = 1.2  # width of the plate of a grooved cam outside the groove, in units
ARROW_START, ARROW_SPAN = 200.0, 80.0  # start and span of the arrow of rotation, deg


def cam(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Cam, pitch curve, base circle, and the camshaft in its bearing."""
    if not geometry.has_cam:
        return
    if geometry.profile.size:
        item = Loop(geometry.profile, theme.pen(theme.cam_line, OUTLINE), brush(theme.cam))
        yield DrawnPart("cam", item, ("cam",), Z_CAM, turning(item, geometry.cam_rotation))
        yield from _zero_mark(geometry, theme)
        for name, radius in geometry.known_circles:
            path = keyed_bore(geometry.keyway) if name == "bore" and geometry.keyway else circle(radius)
            edge = Outline(path, theme.pen(theme.cam_line, THIN))
            yield DrawnPart(name, edge, ("cam",), Z_CURVES, turning(edge, geometry.cam_rotation))
        for flank in geometry.other_flanks:
            yield from FLANK_PARTS[flank.name](flank.profile * MM, geometry, theme)
        if geometry.pitch.size:
            pitch = Loop(geometry.pitch, theme.pen(theme.quiet, THIN, CHAIN))
            yield DrawnPart("pitch", pitch, ("pitch",), Z_CURVES, turning(pitch, geometry.cam_rotation))
    yield DrawnPart(
        "base", Outline(circle(geometry.base_radius), theme.pen(theme.cam_line, THIN, DOTTED)), ("base",), Z_CURVES
    )
    yield from _shaft(geometry, theme)


def _groove(profile: np.ndarray, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Outer flank and the plate outside the groove; the rim is a broken line, because the design does not define it."""
    rim = float(np.abs(profile).max()) + RIM * geometry.unit
    plate = Outline(joined(circle(rim), outline(profile)), None, brush(theme.cam, 0.5))
    yield DrawnPart("plate", plate, ("cam",), Z_CAM - 0.2, turning(plate, geometry.cam_rotation))
    yield DrawnPart("rim", Outline(circle(rim), theme.pen(theme.cam_line, THIN, SPARSE)), ("cam",), Z_CAM - 0.1)
    line = Loop(profile, theme.pen(theme.cam_line, OUTLINE))
    yield DrawnPart("outer", line, ("cam",), Z_CAM, turning(line, geometry.cam_rotation))


def _second_cam(profile: np.ndarray, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Second cam of a conjugate pair, behind the first cam, with its hidden edge dashed."""
    item = Loop(profile, theme.pen(theme.second_line, OUTLINE), brush(theme.second))
    yield DrawnPart("second", item, ("cam",), Z_CAM - 0.5, turning(item, geometry.cam_rotation))
    hidden = Loop(profile, theme.pen(theme.second_line, THIN, DASHED))
    yield DrawnPart("second.hidden", hidden, ("cam",), Z_CAM + 0.1, turning(hidden, geometry.cam_rotation))


FLANK_PARTS: Mapping[str, Callable[[np.ndarray, Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {OUTER: _groove, SECOND: _second_cam}
)
"""Function that draws each flank other than the first."""


def _zero_mark(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Radial tick at cam angle 0, up to the profile."""
    edge, inner = edge_radius(geometry.profile), 0.76 * geometry.bearing_room
    tick = Outline(segments([(inner + 0j, edge + 0j)]), theme.pen(theme.cam_line, THIN))
    yield DrawnPart("zero", tick, ("cam",), Z_CURVES, turning(tick, geometry.cam_rotation))
    tag = Tag("0°", theme.cam_line, theme)

    def move(i: int) -> None:
        outwards = geometry.cam_turn(i)
        tag.setPos(at(inner * outwards))
        tag.shift(-13.0 * outwards.real, 10.0 * outwards.imag)  # towards the cam centre

    yield DrawnPart("zero.text", tag, ("cam", "labels"), Z_CURVES, move)


def edge_radius(profile: np.ndarray) -> float:
    """Radius at which the +x axis of the cam leaves the profile [mm]."""
    after = np.roll(profile, -1)
    cut = np.flatnonzero((profile.imag <= 0.0) != (after.imag <= 0.0))
    start, end = profile[cut], after[cut]
    return float((start.real - start.imag * (end.real - start.real) / (end.imag - start.imag)).max())


def shaft_radius(geometry: Geometry) -> float:
    """Outer radius of the camshaft's bearing [mm]."""
    return min(2.0 * geometry.unit, 0.3 * geometry.bearing_room)


def rotation_arc(geometry: Geometry) -> tuple[float, float, float]:
    """Radius [mm], start and span [deg] of the arrow that shows the sense of rotation."""
    radius = max(1.6 * shaft_radius(geometry), 0.5 * geometry.bearing_room)
    for _, hole in geometry.known_circles:  # the arrow is clear of the hub and the bore
        radius = 1.25 * hole if 0.85 * hole < radius < 1.2 * hole else radius
    start = ARROW_START if geometry.rotation_sign > 0 else ARROW_START + ARROW_SPAN
    return radius, start, geometry.rotation_sign * ARROW_SPAN


def _shaft(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    outer = shaft_radius(geometry)
    bush, lines, shaft = bearing(0.55 * outer, outer)
    yield DrawnPart("shaft.bush", Outline(bush, theme.pen(theme.ink, THIN), brush(theme.paper)), ("ground",), Z_SHAFT)
    yield DrawnPart("shaft.hatching", Outline(lines, theme.pen(theme.quiet, THIN)), ("ground",), Z_SHAFT + 0.1)
    yield DrawnPart("shaft", Outline(shaft, theme.pen(theme.ink, THIN), brush(theme.shaft)), ("cam",), Z_SHAFT + 0.2)
    radius, start, span = rotation_arc(geometry)
    line, tip = arc_arrow(radius, start, span, min(1.6 * geometry.unit, 0.3 * radius))
    yield DrawnPart("sense", Outline(line, theme.pen(theme.cam_line, THIN)), ("cam",), Z_SHAFT)
    yield DrawnPart(
        "sense.head", Outline(tip, theme.pen(theme.cam_line, THIN), brush(theme.cam_line)), ("cam",), Z_SHAFT
    )


def in_space(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Side view and end view of a cam in space."""
    if geometry.surface is not None:
        from kindyna_gui.pictures.drawing.spatial_parts import cam_in_space  # few designs have a cam in space

        yield from cam_in_space(geometry, theme)


def contact(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Common normal through the contact, the roller's centre and the instant centre."""
    if geometry.shape is None:
        return
    line = QGraphicsLineItem()
    line.setPen(theme.pen(theme.quiet, THIN))
    yield DrawnPart("normal", line, ("normal",), Z_NORMAL, _normal_move(line, geometry))
    dot = Outline(circle(0.35 * geometry.unit), theme.pen(theme.ink, THIN), brush(theme.ink))
    yield DrawnPart("contact", dot, ("normal",), Z_NORMAL + 0.1, standing_at(dot, geometry.contact))
    size = 0.8 * geometry.unit
    mark = Outline(joined(cross(1.5 * size), circle(0.55 * size)), theme.pen(theme.limit, OUTLINE))
    yield DrawnPart("centre", mark, ("centre",), Z_NORMAL + 2.0, pinned(mark, centre_within_reach(geometry)))
    ground = next((j for j in geometry.joints if j.name == geometry.kinematics.ground), None)
    if ground is None:  # no pair joins the roller's link to the frame: the line turns with its pole
        return
    ends = CENTRE_LINES[ground.pair.kind](ground, geometry)
    yield DrawnPart(
        "centre.line", Outline(segments([ends]), theme.pen(theme.quiet, THIN, SPARSE)), ("centre",), Z_NORMAL - 0.5
    )


def _reach(geometry: Geometry) -> float:
    low, high = geometry.core_box
    return 4.0 * abs(high - low)


def centre_within_reach(geometry: Geometry) -> np.ndarray:
    """Instant centre (n,) [mm]; infinite also where it is too far away to be drawn."""
    q = geometry.centre
    near = np.abs(np.where(np.isfinite(q), q, 0.0)) < 10.0 * _reach(geometry)
    return np.where(np.isfinite(q) & near, q, complex(np.inf, np.inf))


def _normal_move(line: QGraphicsLineItem, geometry: Geometry) -> Callable[[int], None]:
    assert geometry.shape is not None
    normals, reach = geometry.shape.flank.normal, _reach(geometry)

    def move(i: int) -> None:
        normal = complex(normals[i])
        start = geometry.contact(i) - geometry.face_radius * normal
        low, high = -reach, reach
        if cmath.isfinite(centre := complex(geometry.centre[i])):
            along = min(max(((centre - start) * normal.conjugate()).real, -reach), reach)
            low, high = min(along, -2.0 * geometry.unit), max(along, geometry.face_radius)
        line.setLine(QLineF(at(start + low * normal), at(start + high * normal)))

    return move


def _line_of_centres(ground: Joint, geometry: Geometry) -> tuple[complex, complex]:
    return 0j, complex(ground.track[0])


def _across_the_guide(ground: Joint, geometry: Geometry) -> tuple[complex, complex]:
    reach = float(np.abs(geometry.near_centres).max(initial=0.0)) + 6.0 * geometry.unit
    return -1j * reach * ground.line, 1j * reach * ground.line


CENTRE_LINES: Mapping[str, Callable[[Joint, Geometry], tuple[complex, complex]]] = MappingProxyType(
    {REVOLUTE: _line_of_centres, SLIDING: _across_the_guide}
)
"""Line that contains the instant centre (Kennedy), by the kind of pair between follower and frame."""


# -- coloured profile ----------------------------------------------------------------------------------

COLOURS = 24  # colours of a scale
WIDTH = 4.0  # width of the coloured line, pixels
MOST_PIECES = 720  # pieces of a coloured line
DIGITS = 2  # significant digits of the value at the end of a scale
MPA = 1e6  # Pa in one MPa
CURVATURE_PERCENTILE = 98.0  # of the profile's curvature on the scale; sharper tips have the end colour
NEUTRAL = "#B4BCC3"
TICK_GAP = 8.0  # least distance between the texts of a scale, pixels
Z_COLOURS = 2.7


@frozen
class ColourScale:
    """Colours over a range of values; values outside have the colour of the nearer end.

    Attributes
    ----------
    title : title of the scale, with the unit
    low, high : range of the values
    stops : colours at fractions of the range, 0 ... 1
    ticks : values and their texts
    beyond : colour of the values above the range; "" for the end colour
    """

    title: str
    low: float
    high: float
    stops: tuple[tuple[float, str], ...]
    ticks: tuple[tuple[float, str], ...]
    beyond: str = ""

    def part(self, values: np.ndarray) -> np.ndarray:
        """Fractions of the range (n,), 0 ... 1; 2 for values above the range where ``beyond`` is set."""
        part = (values - self.low) / (self.high - self.low)
        over = (part > 1.0 + 1e-9) & bool(self.beyond)
        return np.where(over, 2.0, np.clip(np.nan_to_num(part, nan=1.0), 0.0, 1.0))

    def colour(self, part: float) -> QColor:
        """Colour at a fraction of the range."""
        if part > 1.0:
            return QColor(self.beyond)
        fractions = [fraction for fraction, _ in self.stops]
        channels = np.array([rgb(colour) for _, colour in self.stops], dtype=float)
        return QColor(*(round(float(np.interp(part, fractions, channel))) for channel in channels.T))

    def gradient(self, width: float) -> QLinearGradient:
        """Gradient from left to right over a width [pixels]."""
        gradient = QLinearGradient(0.0, 0.0, width, 0.0)
        for part, colour in self.stops:
            gradient.setColorAt(part, QColor(colour))
        return gradient


def _pressure_scale(geometry: Geometry, theme: Theme) -> ColourScale:
    """Scale from 0 to the typical limit; larger values have the colour of limits."""
    kinematics = geometry.kinematics
    kind = kinematics.pairs[kinematics.ground].kind if kinematics.ground else REVOLUTE
    limit = PRESSURE_LIMITS[kind]
    ticks = tuple((part * limit, f"{short(part * limit)}°") for part in (0.0, 0.5, 1.0))
    stops = ((0.0, SKY), (0.45, YELLOW), (0.75, ORANGE), (1.0, VERMILION))
    return ColourScale("Pressure angle up to the typical limit", 0.0, limit, stops, ticks, theme.limit)


def _curvature_scale(geometry: Geometry, theme: Theme) -> ColourScale:
    """Scale from concave to convex with the radii at its ends; only the convex half where nothing is concave."""
    assert geometry.shape is not None
    curvature = np.concatenate([_curvature(geometry, flank) for flank in geometry.shape.flanks])
    curvature = curvature[np.isfinite(curvature)]
    size = float(np.percentile(np.abs(curvature), CURVATURE_PERCENTILE)) if curvature.size else 0.0
    radius = float(f"{1.0 / size:.{DIGITS}g}") if size else 1.0
    convex = ((0.0, NEUTRAL), (0.5, ORANGE), (1.0, VERMILION))
    ends = ((0.0, "straight"), (1.0 / radius, f"convex R {short(radius)}"))
    if not (curvature < 0.0).any():
        return ColourScale("Radius of curvature, mm", 0.0, 1.0 / radius, convex, ends)
    both = ((0.0, BLUE), (0.25, SKY), *((0.5 + 0.5 * part, colour) for part, colour in convex))
    ticks = ((-1.0 / radius, f"concave R {short(radius)}"), *ends)
    return ColourScale("Radius of curvature, mm", -1.0 / radius, 1.0 / radius, both, ticks)


def _stress_scale(geometry: Geometry, theme: Theme) -> ColourScale | None:
    """Scale from 0 to the allowable pressure, with the colour of limits above; else to the highest pressure."""
    study = geometry.study
    try:
        if not study.stress or has_undercut(study) or study.jam is not None:
            return None
        highest = max((float(np.max(stress.pressure)) for stress in study.stress.values()), default=0.0) / MPA
    except KindynaError:
        return None
    allowable = limit_of(study, "contact_pressure_mpa")
    # 1 MPa where all pressures are 0
    top = float(f"{highest:.{DIGITS}g}") or 1.0 if allowable is None else allowable.value
    ticks = (0.0, short(0.0, 4)), (0.5 * top, short(0.5 * top, 4)), (top, f"{short(top, 4)} MPa")
    stops = ((0.0, NEUTRAL), (0.25, SKY), (0.5, YELLOW), (0.75, ORANGE), (1.0, VERMILION))
    title = "Contact pressure" if allowable is None else "Contact pressure up to the allowable value"
    return ColourScale(title, 0.0, top, stops, ticks, "" if allowable is None else theme.limit)


def _stress(geometry: Geometry, flank: Flank) -> np.ndarray:
    """Contact pressure (n,) [MPa]."""
    return np.asarray(geometry.study.stress[flank.name].pressure / MPA)


def _pressure_angle(geometry: Geometry, flank: Flank) -> np.ndarray:
    return np.rad2deg(flank.pressure_angle)


def _curvature(geometry: Geometry, flank: Flank) -> np.ndarray:
    """Curvature of the profile (n,) [1/mm]."""
    return np.asarray(flank.profile_curvature / MM)


@frozen
class Colouring:
    """Quantity that colours the profile: its scale, None without values, and its values (n,) on a flank."""

    scale: Callable[[Geometry, Theme], ColourScale | None]
    values: Callable[[Geometry, Flank], np.ndarray]


COLOURINGS: Mapping[str, Colouring] = MappingProxyType(
    {
        "pressure_colours": Colouring(_pressure_scale, _pressure_angle),
        "curvature_colours": Colouring(_curvature_scale, _curvature),
        "stress_colours": Colouring(_stress_scale, _stress),
    }
)
"""Quantity that colours the profile, by layer."""


class ColouredLoop(QGraphicsItem):
    """Closed curve in the colours of its values.

    The pieces are filled ribbons whose width ``look`` keeps constant in pixels: a pen of this width would be a hundred
    times slower.

    Parameters
    ----------
    points : ndarray (n,) [mm]
    parts : ndarray (n,), fractions of the scale
    scale : ColourScale
    """

    def __init__(self, points: np.ndarray, parts: np.ndarray, scale: ColourScale) -> None:
        super().__init__()
        step = max(1, points.size // MOST_PIECES)
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
        """Draw the curve for a scale [pixels per mm]."""
        if scale != self._scale:
            self._scale, half = scale, 0.5 * WIDTH / scale * self._across
            left, right = self._points + half, self._points - half
            self._paths = [
                outline(np.concatenate((left[start : stop + 1], right[start : stop + 1][::-1])))
                for start, stop in self._runs
            ]
            self.update()

    @property
    def colours(self) -> set[str]:
        """Colours of the pieces."""
        return {brush.color().name() for brush in self._brushes}

    def boundingRect(self) -> QRectF:
        return self._bounds

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        painter.setPen(no_pen())
        for fill, path in zip(self._brushes, self._paths, strict=False):
            painter.fillPath(path, fill)


def _closed(values: np.ndarray) -> np.ndarray:
    return np.append(values, values[:1])


def colour_scale(layer: str, geometry: Geometry, theme: Theme) -> ColourScale | None:
    """Scale of a colour layer; None for other layers and without a cam."""
    return COLOURINGS[layer].scale(geometry, theme) if layer in COLOURINGS and geometry.shape is not None else None


def coloured_profile(layer: str, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """All flanks in the colours of a layer."""
    scale = colour_scale(layer, geometry, theme)
    if scale is None or geometry.shape is None:
        return
    for flank in geometry.shape.flanks:
        item = ColouredLoop(flank.profile * MM, scale.part(COLOURINGS[layer].values(geometry, flank)), scale)
        yield DrawnPart(f"{layer}.{flank.name}", item, ("cam", layer), Z_COLOURS, turning(item, geometry.cam_rotation))


def colour_bar(scale: ColourScale, width: float) -> Iterator[tuple[float, str]]:
    """Positions of the ticks on a bar of ``width`` [pixels], with their texts."""
    for value, text in scale.ticks:
        yield width * (value - scale.low) / (scale.high - scale.low), text


def bar_width(scale: ColourScale) -> float:
    """Least width of a bar [pixels] on which the texts of the ticks do not touch each other."""
    ticks = [(part, text_size(text)[0]) for part, text in colour_bar(scale, 1.0)]
    least = 0.0
    for (left, left_size), (right, right_size) in pairwise(ticks):
        least = max(least, (TICK_GAP + left_size + right * right_size - left * left_size) / (right - left))
    return least


# -- values at a point of the profile ------------------------------------------------------------------

PROFILES: Mapping[str, str] = MappingProxyType({INNER: "Profile", OUTER: "Outer flank", SECOND: "Second cam"})
STRAIGHT = 1e4  # a radius of curvature above this many cam radii counts as straight


@frozen
class ProfileReading:
    """Values at a point of the profile.

    Attributes
    ----------
    flank : name of the flank
    point : position in the frame of the cam [mm]
    cam_angle : cam angle at which the follower touches the point [deg]
    radius : distance from the cam centre [mm]
    pressure_angle : [deg]
    curvature : [1/mm], positive where the cam is convex
    force, pressure : contact force [N] and contact pressure [MPa]; None where they are not shown
    """

    flank: str
    point: complex
    cam_angle: float
    radius: float
    pressure_angle: float
    curvature: float
    force: float | None = None
    pressure: float | None = None

    def position(self, cam_turn: complex) -> complex:
        """Position in the drawing [mm] while the x axis of the cam has this direction."""
        return self.point * cam_turn

    @property
    def text(self) -> str:
        """The values in one line."""
        curvature = abs(self.curvature)
        if curvature * self.radius * STRAIGHT < 1.0:
            shape = "straight"
        else:
            shape = f"{'convex' if self.curvature > 0.0 else 'concave'} R {short(1.0 / curvature, 4)} mm"
        text = (
            f"{PROFILES[self.flank]} at {number(self.cam_angle, 1)}°: radius {number(self.radius, 2)} mm, pressure angle "
            f"{number(self.pressure_angle, 1)}°, {shape}"
        )
        if self.force is not None:
            text += f", force {readable_text(self.force, 'N')}"
        return text if self.pressure is None else f"{text}, contact pressure {short(self.pressure, 4)} MPa"


def on_cam(geometry: Geometry, index: int, point: complex) -> bool:
    """Whether a point of the global frame [mm] is on the cam at a sample, of a cam in space on its end view."""
    if geometry.space is not None:
        from kindyna_gui.pictures.drawing.spatial_parts import on_end_view  # as in ``in_space``

        return on_end_view(geometry, point)
    if not geometry.profile.size:
        return False
    local = point * np.exp(-1j * np.deg2rad(geometry.cam_rotation[index]))
    polygon = QPolygonF([at(p) for p in geometry.profile])
    return polygon.containsPoint(at(local), Qt.FillRule.OddEvenFill)


def reading_at(
    geometry: Geometry, index: int, point: complex, reach: float, with_forces: bool = False
) -> ProfileReading | EdgeReading | None:
    """Values at the sample of the profile nearest to a point of the global frame [mm] while the cam is at a sample.

    Returns None where the profile is farther away than ``reach`` [mm]. ``with_forces`` adds contact force and pressure.
    """
    if geometry.space is not None:
        from kindyna_gui.pictures.drawing.spatial_parts import edge_reading  # as in ``in_space``

        return edge_reading(geometry, index, point, reach)
    if geometry.shape is None:
        return None
    local = point * np.exp(-1j * np.deg2rad(geometry.cam_rotation[index]))
    distances = [(flank, np.abs(flank.profile * MM - local)) for flank in geometry.shape.flanks]
    flank, distance = min(distances, key=lambda row: float(row[1].min()))
    i = int(distance.argmin())
    if distance[i] > reach:
        return None
    nearest = complex(flank.profile[i] * MM)
    return ProfileReading(
        flank.name,
        nearest,
        float(geometry.cam_angle[i]),
        abs(nearest),
        float(np.rad2deg(flank.pressure_angle[i])),
        float(flank.profile_curvature[i] / MM),
        *(_loads_at(geometry, flank.name, i) if with_forces else ()),
    )


def _loads_at(geometry: Geometry, flank: str, i: int) -> tuple[float | None, float | None]:
    """Contact force [N] and contact pressure [MPa] on a flank at a sample; None without a solution."""
    study, shape = geometry.study, geometry.shape
    assert shape is not None
    try:
        force = next(c.force[i] for f, c in zip(shape.flanks, study.dynamics.contacts, strict=True) if f.name == flank)
        stress = study.stress.get(flank) if study.jam is None and not has_undercut(study) else None
    except NoSolution:
        return None, None
    pressure = None if stress is None else float(stress.pressure[i]) / MPA
    return float(force) if np.isfinite(force) else None, pressure
