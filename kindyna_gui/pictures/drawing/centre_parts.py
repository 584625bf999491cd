"""Instant centres of a linkage, the lines on which Kennedy's theorem finds them, and the paths of its points."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF
from PySide6.QtGui import QPainterPath
from PySide6.QtWidgets import QGraphicsItem, QGraphicsLineItem

from core.instant_centres import CentreTable, KennedyStep, Triangle, line_of
from core.mechanism import ROLLER, link_number
from core.mechanism.kinematics import FRAME
from kindyna_gui.pictures.drawing.free_space import TakenSpace
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.drawing.layers import GHOSTS
from kindyna_gui.pictures.items import DrawnPart, Loop, Outline, Tag
from kindyna_gui.pictures.shapes import at, polyline
from kindyna_gui.pictures.style import BLUE, DOTTED, OUTLINE, SMALL, SPARSE, THIN, Theme, brush
from kindyna_gui.pictures.viewport import Viewport

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
        self._far = {key: centres.far(table.size) for key, centres in table.centres.items()}
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
            kept[triangle] = line_of(self._table.centres, triangle)
        lines: np.ndarray = kept[triangle]
        return lines


def coupler_paths(geometry: Geometry) -> Iterator[np.ndarray]:
    """What ``coupler_curves`` draws (n,) [mm]."""
    return (track for _, track, _ in _paths(geometry))


def _paths(geometry: Geometry) -> Iterator[tuple[str, np.ndarray, bool]]:
    """Every named point of the links: its name, its path (n,) [mm], and whether no pair holds its link on the frame."""
    held = {j.pair.body for j in geometry.joints if j.fixed}
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
        item = Loop(track, pen) if geometry.whole_turn else Outline(polyline(track), pen)
        yield DrawnPart(f"coupler.{name}", item, ("coupler",), Z_COUPLER if free else Z_WAYS)


def ghost_poses(geometry: Geometry, theme: Theme, layer: str) -> Iterator[DrawnPart]:
    """Where the links stand every so many degrees of the turn, as thin lines between their points."""
    turn = np.arange(0, 360, GHOSTS[layer])
    indices = sorted({geometry.nearest(float(theta)) for theta in np.deg2rad(turn)})
    path = QPainterPath()
    for body in geometry.moving.values():
        tracks = [body.track(place)[indices] for place in body.nodes.values()]
        if len(tracks) > 1:
            for places in np.array(tracks).T:
                path.addPath(polyline(np.append(places, places[0]) if places.size > 2 else places))
    yield DrawnPart(f"{layer}.all", Outline(path, theme.pen(theme.quiet, THIN)), (layer,), Z_WAYS)
