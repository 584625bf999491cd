"""Centres, ratios, constructions."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QGraphicsItem, QGraphicsLineItem, QSizePolicy, QWidget

from core.instant_centres import (
    CHAINS,
    CentreTable,
    Construction,
    KennedyStep,
    RatioArms,
    Triangle,
    ratio_arms,
    triangle_line,
)
from core.mechanism import ROLLER, body_name, link_number
from core.mechanism.kinematics import FRAME
from kindyna_gui.pictures.drawing.free_space import TakenSpace
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.drawing.labels import ink
from kindyna_gui.pictures.drawing.overlay import MARGIN
from kindyna_gui.pictures.drawing.parts import GHOST_POSES
from kindyna_gui.pictures.items import DrawnPart, Loop, Outline, Tag, Viewport
from kindyna_gui.pictures.shapes import at, polyline
from kindyna_gui.pictures.style import (
    BLUE,
    DOTTED,
    GREEN,
    OUTLINE,
    PURPLE,
    SCREEN,
    SMALL,
    SPARSE,
    THIN,
    VERMILION,
    Theme,
    brush,
    font,
)
from kindyna_gui.pictures.units import digits
from kindyna_gui.settings import sized

# -- centre parts ----------------------------------------------------------------------------------------

Z_LINES, Z_WAYS, Z_COUPLER, Z_CENTRES = 7.0, 0.5, 6.8, 13.0  # a coupler curve is seen over its own plate
DOT, EDGE, ARROW = 4.5, 26.0, 15.0  # radius of a centre, distance of an arrow from the edge, its length, pixels
Key = tuple[str, str]


def centre_name(key: Key) -> str:
    """``13``; with a comma where a number has two digits."""
    one, other = (link_number(body) for body in key)
    return f"{one}{other}" if max(one, other) < 10 else f"{one},{other}"


class Group(QGraphicsItem):
    """Holds others; nothing of its own."""

    def __init__(self, children: Sequence[QGraphicsItem]) -> None:
        super().__init__()
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemHasNoContents)
        for child in children:
            child.setParentItem(self)

    def boundingRect(self) -> QRectF:
        return QRectF()

    def paint(self, *_: object) -> None:
        """Nothing of its own."""


class _Mark:
    """One centre: a dot where it is visible, else an arrow at the edge that points to it; its number beside."""

    def __init__(self, key: Key, known: bool, theme: Theme) -> None:
        colour = theme.ink if known else theme.limit
        dot = QPainterPath()
        dot.addEllipse(QPointF(0.0, 0.0), DOT, DOT)
        self.key = key
        self.dot = Outline(dot, theme.pen(colour, OUTLINE), brush(colour if known else theme.paper))
        shaft = QPainterPath(QPointF(-ARROW, 0.0))
        shaft.lineTo(0.0, 0.0)
        for x, y in ((-7.0, -3.5), (-7.0, 3.5), (0.0, 0.0)):
            shaft.lineTo(x, y)
        self.arrow = Outline(shaft, theme.pen(colour, OUTLINE), brush(colour))
        for item in (self.dot, self.arrow):
            item.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIgnoresTransformations)
        self.tag = Tag("", theme.letters(colour), theme, SMALL, (0.5, 0.5), backing=True)
        self.name = centre_name(key)

    def show(self, on: bool) -> None:
        for item in (self.dot, self.arrow, self.tag):
            item.setVisible(on)

    def place(self, place: complex, infinite: bool, viewport: Viewport, room: TakenSpace) -> complex:
        """place [mm], or where ``infinite`` a direction; returns where its number belongs [mm]."""
        seen = not infinite and viewport.holds(place)
        self.dot.setVisible(seen)
        self.arrow.setVisible(not seen)
        here = place
        if not seen:
            towards = place if infinite else place - viewport.centre
            here = room.inwards(viewport.edge(towards, EDGE))
            self.arrow.setPos(at(here))
            self.arrow.setRotation(float(-np.degrees(np.angle(towards))))
        else:
            self.dot.setPos(at(place))
        self.tag.set_text(f"{self.name} ∞" if infinite else self.name)
        room.dot(here, DOT if seen else 0.5 * ARROW)
        return here


class CentreMarks:
    """Marks for all centres of a table, or for the chosen ones (``only``), at one sample after the other."""

    def __init__(self, table: CentreTable, theme: Theme, viewport: Viewport, room: Callable[[], TakenSpace]) -> None:
        self._table, self._viewport, self._room = table, viewport, room
        self.marks = [_Mark(key, key in table.primary, theme) for key in table.centres]
        self._far = {key: centres.is_far(table.size) for key, centres in table.centres.items()}
        self.only: frozenset[Key] | None = None
        self._placed: list[tuple[_Mark, complex]] = []
        self.item = Group([item for mark in self.marks for item in (mark.dot, mark.arrow, mark.tag)])

    def dots(self, i: int, room: TakenSpace) -> None:
        """Put the marks where their centres are; their numbers follow once all else has its place."""
        self._placed = []
        for mark in self.marks:
            centres = self._table.centres[mark.key]
            point, weight = complex(centres.point[i]), float(centres.weight[i])
            shown = (self.only is None or mark.key in self.only) and not point == weight == 0.0
            mark.show(shown)
            if shown:
                far = bool(self._far[mark.key][i])
                here = mark.place(point if far else point / weight * MM, far, self._viewport, room)
                self._placed.append((mark, here))

    def move(self, i: int) -> None:
        room = self._room()
        for mark, here in self._placed:
            room.settle(mark.tag, (here,))


class KennedyLines:
    """The two lines that give each centre, of all centres or of the chosen ones."""

    def __init__(self, table: CentreTable, steps: Sequence[KennedyStep], theme: Theme, viewport: Viewport) -> None:
        self._table, self._viewport = table, viewport
        self.rows: list[tuple[KennedyStep, Triangle, QGraphicsLineItem]] = []
        for step in steps:
            for triangle in step.triangles[:2]:
                line = QGraphicsLineItem()
                line.setPen(theme.pen(theme.quiet, THIN, SPARSE))
                self.rows.append((step, triangle, line))
        self._loud = theme.pen(theme.limit, OUTLINE)
        self._quiet = theme.pen(theme.quiet, THIN, SPARSE)
        self.only: Key | None = None
        self.hidden = False
        self.item = Group([line for _, _, line in self.rows])

    def emphasise(self, key: Key | None) -> None:
        """Draw only the lines of one centre, and these boldly; None: quietly those of all."""
        self.only = key
        for _, _, line in self.rows:
            line.setPen(self._quiet if key is None else self._loud)

    def move(self, i: int) -> None:
        for step, triangle, item in self.rows:
            wanted = not self.hidden and (self.only is None or step.key == self.only)
            ends = self._ends(triangle, i) if wanted else None
            item.setVisible(ends is not None)
            if ends is not None:
                item.setLine(QLineF(at(ends[0]), at(ends[1])))

    def _ends(self, triangle: Triangle, i: int) -> tuple[complex, complex] | None:
        line = self._line(triangle)[:, i]
        return self._viewport.across(line * np.array([1.0, 1.0, MM]))

    def _line(self, triangle: Triangle) -> np.ndarray:
        kept = self.__dict__.setdefault("_lines", {})
        if triangle not in kept:
            kept[triangle] = triangle_line(self._table.centres, triangle)
        lines: np.ndarray = kept[triangle]
        return lines


def coupler_paths(geometry: Geometry) -> Iterator[np.ndarray]:
    """What ``coupler_curves`` draws (n,) [mm]."""
    return (track for _, track, _ in _paths(geometry))


def _paths(geometry: Geometry) -> Iterator[tuple[str, np.ndarray, bool]]:
    """Every named point of the links: its name, its path (n,) [mm], and whether no pair holds its link on the frame."""
    held = {j.pair.body for j in geometry.joints if j.is_fixed}
    pinned = {name for body in held | {FRAME} for name in geometry.bodies[body].points}
    seen: set[str] = set()
    for body in geometry.moving.values():
        for name, place in body.points.items():
            if name in seen or name == ROLLER or name.isdecimal() or name in geometry.bodies[FRAME].points:
                continue
            seen.add(name)
            yield name, body.track(place), name not in pinned


def coupler_curves(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """The path of every named point over the turn: of points on links that no pair holds on the frame boldly."""
    for name, track, free in _paths(geometry):
        pen = theme.pen(theme.seen(BLUE), OUTLINE) if free else theme.pen(theme.quiet, THIN, DOTTED)
        item = Loop(track, pen) if geometry.is_full_turn else Outline(polyline(track), pen)
        yield DrawnPart(f"coupler.{name}", item, ("coupler",), Z_COUPLER if free else Z_WAYS)


def ghost_poses(geometry: Geometry, theme: Theme, layer: str) -> Iterator[DrawnPart]:
    """Where the links stand every so many degrees of the turn, as thin lines between their points."""
    turn = np.arange(0, 360, GHOST_POSES[layer])
    indices = sorted({geometry.nearest(float(theta)) for theta in np.deg2rad(turn)})
    path = QPainterPath()
    for body in geometry.moving.values():
        tracks = [body.track(place)[indices] for place in body.nodes.values()]
        if len(tracks) > 1:
            for places in np.array(tracks).T:
                path.addPath(polyline(np.append(places, places[0]) if places.size > 2 else places))
    yield DrawnPart(f"{layer}.all", Outline(path, theme.pen(theme.quiet, THIN)), (layer,), Z_WAYS)


# -- ratio parts -----------------------------------------------------------------------------------------

Z_RATIOS = 9.0
COLOURS = (BLUE, VERMILION, PURPLE, "#8C6D1F", "#00796B")  # of one ratio after the other
OFF, STEP = 15.0, 9.0  # from the line of the centres to the first dimension, and from one to the next, pixels
HEAD, TICK = 6.0, 4.0  # of a dimension line: its heads, and how far its ends reach beyond it, pixels
LINE, UNDER_ANGLE = 17.0, 28.0  # of the list: its lines, its place under the angle, pixels
FIGURES = 4
ALONG, GAPS = (0.5, 0.3, 0.7, 0.1, 0.9), (2.0, 10.0, 22.0, 38.0)  # where a length may stand
Pairs = Callable[[CentreTable, str], Sequence[tuple[str, str]]]


def ratio_text(arms: RatioArms, i: int, base_speed: float, body_speed: float) -> str:
    """One ratio in figures at a sample; speeds [rad/s] of both links. Of a body that does not turn, its velocity."""
    body, base = link_number(arms.body), link_number(arms.base)
    names = tuple(f"I{centre_name(key)}" for key in (arms.base_key, arms.body_key, arms.common_key))
    above, below = float(arms.base_arm[i]) * MM, float(arms.body_arm[i]) * MM
    ratio, far = float(arms.ratio[i]), (math.isinf(above), math.isinf(below))
    if far == (False, True):
        formula = f"ω{base} · {names[0]}{names[2]} = {_figure(base_speed)} rad/s × {_figure(above)} mm"
        return f"v{body} = {formula} = {_figure(abs(base_speed) * above)} mm/s"
    if far == (True, False):
        formula = f"v{base} / {names[1]}{names[2]} = {_figure(abs(body_speed * below))} mm/s / {_figure(abs(below))} mm"
        return f"ω{body} = {formula} = {_figure(body_speed)} rad/s"
    if math.isnan(ratio):
        return f"ω{body}/ω{base}: the centres coincide"
    if far == (True, True):
        return f"ω{body}/ω{base} = {_figure(ratio)}, {names[2]} at infinity"
    by = f"{names[0]}{names[2]} / {names[1]}{names[2]} = {_figure(above)} / {_figure(below)} mm"
    return f"ω{body}/ω{base} = {by} = {_figure(ratio)}"


def _figure(value: float) -> str:
    return digits(float(f"{value:.9g}") if abs(value) > 1e-9 else 0.0, FIGURES)


class _Dimension:
    """The distance between two centres beside their line, with its length in the middle."""

    def __init__(self, start: Key, end: Key, colour: str, theme: Theme) -> None:
        self.start, self.end = start, end
        self.line = Outline(QPainterPath(), theme.pen(colour, OUTLINE), brush(colour))
        self.tag = Tag("", theme.letters(colour), theme, SMALL, (0.5, 0.5), backing=True)
        self.name = f"I{centre_name(start)}I{centre_name(end)}"

    def show(self, on: bool) -> None:
        self.line.setVisible(on)
        self.tag.setVisible(on)

    def lay(
        self, start: complex, end: complex, off: complex, length: float, viewport: Viewport, room: TakenSpace
    ) -> None:
        """start, end: the centres [mm]; off: how far beside them [mm]; length: the number shown, with its sign [mm]."""
        pixel = 1.0 / viewport.scale
        part = _seen(start + off, end + off, viewport)
        self.show(part is not None and abs(end - start) > 2.0 * HEAD * pixel)
        if part is None or not self.line.isVisible():
            return
        along = (end - start) / abs(end - start)
        path = QPainterPath()
        one, other = (start + off + t * (end - start) for t in part)
        _stroke(path, one, other)
        for foot, whole, direction in ((start, part[0] <= 0.0, along), (end, part[1] >= 1.0, -along)):
            if whole:
                _stroke(path, foot, foot + off * (1.0 + TICK * pixel / abs(off)))
                tip = foot + off
                for side in (0.35j, -0.35j):
                    _stroke(path, tip, tip + HEAD * pixel * direction * (1.0 + side))
        self.line.redraw(path)
        self.tag.set_text(f"{self.name} {_figure(length)} mm")
        room.settle(self.tag, [one + t * (other - one) for t in ALONG], GAPS)


def _stroke(path: QPainterPath, start: complex, end: complex) -> None:
    path.moveTo(start.real, start.imag)
    path.lineTo(end.real, end.imag)


def _seen(start: complex, end: complex, viewport: Viewport) -> tuple[float, float] | None:
    """The visible part of a stretch, from 0 at its start to 1 at its end; None where nothing of it is."""
    direction = end - start
    if direction == 0.0:
        return None
    normal = 1j * direction
    ends = viewport.across(np.array([normal.real, normal.imag, -(normal.conjugate() * start).real]))
    if ends is None:
        return None
    low, high = sorted(((e - start) * direction.conjugate()).real / abs(direction) ** 2 for e in ends)
    low, high = max(low, 0.0), min(high, 1.0)
    return (low, high) if low < high else None


class RatioDimensions:
    """Every ratio of a chain at one sample after the other: two dimensions each, and a line of the list under the angle."""

    def __init__(
        self, geometry: Geometry, pairs: Pairs, theme: Theme, viewport: Viewport, room: Callable[[], TakenSpace]
    ) -> None:
        self._geometry, self._viewport, self._room = geometry, viewport, room
        self._table = geometry.study.centres
        driver = body_name(geometry.study.design.drive.linkage.driver.link)
        self.rows: list[tuple[RatioArms, tuple[_Dimension, _Dimension], Tag]] = []
        for number, (body, base) in enumerate(pairs(self._table, driver)):
            colour = theme.seen(COLOURS[number % len(COLOURS)])
            arms = ratio_arms(self._table, body, base)
            lines = (
                _Dimension(arms.base_key, arms.common_key, colour, theme),
                _Dimension(arms.body_key, arms.common_key, colour, theme),
            )
            self.rows.append((arms, lines, Tag("", theme.letters(colour), theme, SMALL, (0.0, 0.0), backing=True)))
        items = [item for _, lines, tag in self.rows for d in lines for item in (d.line, d.tag)]
        self.item = Group([*items, *(tag for _, _, tag in self.rows)])

    @property
    def texts(self) -> list[str]:
        """The list as it stands."""
        return [tag.text for _, _, tag in self.rows]

    def move(self, i: int) -> None:
        for number, (arms, (base, body), _) in enumerate(self.rows):
            places = [self._at(key, i) for key in (arms.base_key, arms.body_key, arms.common_key)]
            spans = ((base, places[0], 1.0, arms.base_arm[i]), (body, places[1], -1.0, arms.body_arm[i]))
            for line, place, side, length in spans:
                end = places[2]
                line.show(False)
                if place is None or end is None or place == end or not math.isfinite(length):
                    continue
                across = 1j * self._along(places) * side * (OFF + STEP * number) / self._viewport.scale
                line.lay(place, end, across, float(length) * MM, self._viewport, self._room())

    def _at(self, key: Key, i: int) -> complex | None:
        """Where a centre is [mm]; None at infinity."""
        centre = self._table.centres[key]
        point, weight = complex(centre.point[i]), float(centre.weight[i])
        return None if bool(self._far(key)[i]) else point / weight * MM

    def _far(self, key: Key) -> np.ndarray:
        kept = self.__dict__.setdefault("_kept", {})
        if key not in kept:
            kept[key] = self._table.centres[key].is_far(self._table.size)
        far: np.ndarray = kept[key]
        return far

    @staticmethod
    def _along(places: Sequence[complex | None]) -> complex:
        """The direction of the line of the centres, the same for both senses along it."""
        finite = [p for p in places if p is not None]
        direction = max((b - a for a in finite for b in finite), key=abs)
        direction = direction / abs(direction)
        return direction if direction.real > 0.0 or (direction.real == 0.0 and direction.imag > 0.0) else -direction

    # -- the list ---------------------------------------------------------------------------------------------

    @property
    def height(self) -> float:
        """Of the list [pixels]."""
        return LINE * len(self.rows)

    def list(self, i: int, room: TakenSpace, down: float) -> None:
        """All ratios in figures, one below the other under the angle; down: so many pixels further."""
        omega, bodies = self._geometry.study.omega, self._geometry.kinematics.bodies
        seen, scale = self._viewport.visible, self._viewport.scale
        x, y = seen.left() * scale + MARGIN, -seen.bottom() * scale + sized(UNDER_ANGLE) + down
        for number, (arms, _, tag) in enumerate(self.rows):
            tag.set_text(
                ratio_text(arms, i, *(float(bodies[name].turn[1][i]) * omega for name in (arms.base, arms.body)))
            )
            tag.setPos(QPointF(x / scale, -(y + LINE * number) / scale))
            room.take(QRectF(x, y + LINE * number, tag.size[0], LINE))


# -- construct -------------------------------------------------------------------------------------------

# Each layer is read and drawn when it is first shown.


class Construct:
    """The layers of one reading; ``begin`` before each move, ``show_step`` for the circle diagram.

    texts   gives the boxes of the labels that are shown, in pixels of the whole scene
    """

    def __init__(
        self, geometry: Geometry, theme: Theme, viewport: Viewport, texts: Callable[[], list[QRectF]], step: int | None
    ) -> None:
        self._geometry, self._theme, self._viewport, self._texts = geometry, theme, viewport, texts
        self._step, self._made = step, set[str]()
        self._index = 0
        self._room: TakenSpace | None = None
        self.marks: CentreMarks | None = None
        self.kennedy: KennedyLines | None = None
        self.ratios: dict[str, RatioDimensions] = {}

    def parts(self, layer: str) -> Iterator[DrawnPart]:
        """The parts of a layer, made the first time it is shown."""
        if layer not in self._made:
            self._made.add(layer)
            yield from _LAYERS[layer](self, layer)
            self.show_step(self._step)

    def begin(self, index: int) -> None:
        """The drawing moves to a sample: all texts find their places anew."""
        self._index, self._room = index, None

    def room(self) -> TakenSpace:
        """What is taken at the sample at hand."""
        if self._room is None:
            drawn = ink(self._geometry, np.array([self._index]), ())
            self._room = TakenSpace(self._viewport, drawn, self._texts())
            down = 0.0
            for ratios in self._listed():
                ratios.list(self._index, self._room, down)
                down += ratios.height
            if self.marks is not None and self.marks.item.isVisible():
                self.marks.dots(self._index, self._room)
        return self._room

    @property
    def strip(self) -> float:
        """Height of what is listed at the top of the picture [pixels]."""
        return sum(ratios.height for ratios in self._listed())

    def _listed(self) -> list[RatioDimensions]:
        return [ratios for ratios in self.ratios.values() if ratios.item.isVisible()]

    def show_step(self, step: int | None) -> None:
        """Only the centres known at a step of the circle diagram, and the lines that find the next; None: all."""
        self._step = step
        if self.marks is None and self.kennedy is None:
            return
        plan = self._geometry.study.centres.construction
        known = None if step is None else frozenset((*plan.known, *(w.key for w in plan.steps[:step])))
        wanted = plan.steps[step - 1].key if step and step <= len(plan.steps) else None
        if self.marks is not None:
            self.marks.only = known
        if self.kennedy is not None:
            self.kennedy.emphasise(wanted if step is not None else None)
            self.kennedy.hidden = step == 0

    # -- layers ---------------------------------------------------------------------------------------------

    def _centres(self, layer: str) -> Iterator[DrawnPart]:
        self.marks = CentreMarks(self._geometry.study.centres, self._theme, self._viewport, self.room)
        yield DrawnPart(f"{layer}.all", self.marks.item, (layer,), Z_CENTRES, self.marks.move)

    def _kennedy(self, layer: str) -> Iterator[DrawnPart]:
        table = self._geometry.study.centres
        self.kennedy = KennedyLines(table, table.construction.steps, self._theme, self._viewport)
        yield DrawnPart(f"{layer}.all", self.kennedy.item, (layer,), Z_LINES, self.kennedy.move)

    def _ratios(self, layer: str) -> Iterator[DrawnPart]:
        drawn = RatioDimensions(self._geometry, CHAINS[layer], self._theme, self._viewport, self.room)
        self.ratios[layer] = drawn
        yield DrawnPart(f"{layer}.all", drawn.item, (layer,), Z_RATIOS, drawn.move)

    def paths(self) -> list[np.ndarray]:
        """The coupler curves (n,) [mm]."""
        return list(coupler_paths(self._geometry))

    def _coupler(self, layer: str) -> Iterator[DrawnPart]:
        yield from coupler_curves(self._geometry, self._theme)

    def _poses(self, layer: str) -> Iterator[DrawnPart]:
        yield from ghost_poses(self._geometry, self._theme, layer)


_LAYERS: Mapping[str, Callable[[Construct, str], Iterator[DrawnPart]]] = MappingProxyType(
    {
        "centres": Construct._centres,
        "kennedy": Construct._kennedy,
        "ratios": Construct._ratios,
        "chain": Construct._ratios,
        "coupler": Construct._coupler,
        **dict.fromkeys(GHOST_POSES, Construct._poses),
    }
)


# -- circle diagram --------------------------------------------------------------------------------------

_TINTS = (BLUE, GREEN)  # of the two triangles


class Diagram(QWidget):
    """Links as numbers on a circle, centres as lines between them."""

    NUMBER = 11.0  # radius of a number's disc, pixels

    def __init__(self) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAccessibleName("Circle diagram")
        self.bodies: tuple[str, ...] = ()
        self.solid: tuple[tuple[str, str], ...] = ()
        self.dotted: tuple[tuple[str, str], ...] = ()
        self.wanted: KennedyStep | None = None

    def sizeHint(self) -> QSize:
        return QSize(220, 200)

    def minimumSizeHint(self) -> QSize:
        return QSize(120, 110)

    def show_step(self, bodies: tuple[str, ...], plan: Construction, step: int) -> None:
        """step: 0 shows what is known at sight; then one centre more each time."""
        self.bodies = bodies
        self.wanted = plan.steps[step - 1] if step else None
        self.solid = (*plan.known, *(w.key for w in plan.steps[: max(step - 1, 0)]))
        self.dotted = tuple(w.key for w in plan.steps[max(step - 1, 0) :])
        self.update()

    def place(self, body: str) -> QPointF:
        """Where a link's number stands; the first at the top, then clockwise [pixels]."""
        part = self.bodies.index(body) / len(self.bodies)
        radius = 0.5 * min(self.width(), self.height()) - self.NUMBER - 4.0
        turn = cmath.rect(radius, 2.0 * math.pi * part - math.pi / 2.0 - math.pi / len(self.bodies))
        return QPointF(self.width() / 2.0 + turn.real, self.height() / 2.0 + turn.imag)

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.fillRect(self.rect(), QColor(SCREEN.paper))
        if self.bodies:
            self._paint(painter)
        painter.end()

    def _paint(self, painter: QPainter) -> None:
        middle = QPointF(self.width() / 2.0, self.height() / 2.0)
        radius = abs(complex((self.place(self.bodies[0]) - middle).x(), (self.place(self.bodies[0]) - middle).y()))
        painter.setPen(QPen(QColor(SCREEN.shaft), 1.0))
        painter.drawEllipse(middle, radius, radius)
        if self.wanted is not None:
            for triangle, colour in zip(self.wanted.triangles, _TINTS, strict=False):
                tint = QColor(colour)
                tint.setAlphaF(0.16)
                painter.setPen(Qt.PenStyle.NoPen)
                painter.setBrush(tint)
                painter.drawPolygon(QPolygonF([self.place(b) for b in (*self.wanted.key, triangle.third)]))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for keys, pen in (
            (self.dotted, QPen(QColor(SCREEN.quiet), 1.0, Qt.PenStyle.DotLine)),
            (self.solid, QPen(QColor(SCREEN.ink), 1.5)),
        ):
            painter.setPen(pen)
            for key in keys:
                painter.drawLine(self.place(key[0]), self.place(key[1]))
        if self.wanted is not None:
            painter.setPen(QPen(QColor(SCREEN.limit), 2.0, Qt.PenStyle.DotLine))
            painter.drawLine(self.place(self.wanted.key[0]), self.place(self.wanted.key[1]))
        painter.setFont(font(12))
        for body in self.bodies:
            box = QRectF(0.0, 0.0, 2.0 * self.NUMBER, 2.0 * self.NUMBER)
            box.moveCenter(self.place(body))
            painter.setPen(QPen(QColor(SCREEN.ink), 1.0))
            painter.setBrush(QColor(SCREEN.paper))
            painter.drawEllipse(box)
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, str(link_number(body)))


def construction_text(plan: Construction, step: int) -> str:
    """A sentence that describes a step."""
    if step == 0:
        names = ", ".join(centre_name(key) for key in plan.known)
        return f"Known at sight, by pins and guides: {names}. Wanted: {len(plan.steps)} more."
    wanted = plan.steps[step - 1]
    lines = [
        f"{centre_name(t.first)}\u2013{centre_name(t.second)} (links {_three(wanted, t.third)})"
        for t in wanted.triangles[:2]
    ]
    return f"{centre_name(wanted.key)} lies on the lines {' and '.join(lines)}: where they cross."


def _three(wanted: KennedyStep, third: str) -> str:
    return ", ".join(str(n) for n in sorted(link_number(body) for body in (*wanted.key, third)))
