"""Drawing of a general linkage's instant centres, velocity ratios, coupler curves and ghost poses.

Also the circle diagram, which shows how Kennedy's theorem gives each instant centre from the known ones.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
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
from core.output.drawing.palette import BLUE, GREEN, PURPLE, VERMILION
from kindyna_gui.pictures.drawing.free_space import OccupiedSpace
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.drawing.labels import drawing_dots
from kindyna_gui.pictures.drawing.overlay import MARGIN, Group
from kindyna_gui.pictures.drawing.parts import GHOST_POSES
from kindyna_gui.pictures.items import DrawnPart, Loop, Outline, Tag, Viewport
from kindyna_gui.pictures.shapes import at, polyline
from kindyna_gui.pictures.style import DOTTED, OUTLINE, SCREEN, SMALL, SPARSE, THIN, Theme, brush, font
from kindyna_gui.pictures.units import digits
from kindyna_gui.settings import sized

# -- instant centres -----------------------------------------------------------------------------------

Z_LINES, Z_PATHS, Z_COUPLER, Z_CENTRES = 7.0, 0.5, 6.8, 13.0  # coupler curves are in front of the links
DOT, EDGE, ARROW = 4.5, 26.0, 15.0  # radius of a centre, distance and length of an arrow at the edge, pixels
Key = tuple[str, str]


def centre_name(key: Key) -> str:
    """Name of a centre, such as ``13``; ``3,12`` where a number has two digits."""
    first, second = (link_number(body) for body in key)
    return f"{first}{second}" if max(first, second) < 10 else f"{first},{second}"


class _Mark:
    """One centre with its number: a dot where it is visible, else an arrow at the edge that points to it."""

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
        self.tag = Tag("", theme.text_colour(colour), theme, SMALL, (0.5, 0.5), backing=True)
        self.name = centre_name(key)

    def show(self, on: bool) -> None:
        for item in (self.dot, self.arrow, self.tag):
            item.setVisible(on)

    def place(self, centre: complex, infinite: bool, viewport: Viewport, space: OccupiedSpace) -> complex:
        """Place the mark of a centre [mm], or of a direction where ``infinite``; returns the mark's position [mm]."""
        visible = not infinite and viewport.holds(centre)
        self.dot.setVisible(visible)
        self.arrow.setVisible(not visible)
        position = centre
        if visible:
            self.dot.setPos(at(centre))
        else:
            direction = centre if infinite else centre - viewport.centre
            position = space.inwards(viewport.edge(direction, EDGE))
            self.arrow.setPos(at(position))
            self.arrow.setRotation(float(-np.degrees(np.angle(direction))))
        self.tag.set_text(f"{self.name} ∞" if infinite else self.name)
        space.dot(position, DOT if visible else 0.5 * ARROW)
        return position


class CentreMarks:
    """Marks of all centres of a table, or of those in ``only``."""

    def __init__(
        self, table: CentreTable, theme: Theme, viewport: Viewport, space: Callable[[], OccupiedSpace]
    ) -> None:
        self._table, self._viewport, self._space = table, viewport, space
        self.marks = [_Mark(key, key in table.primary, theme) for key in table.centres]
        self._far = {key: centres.is_far(table.size) for key, centres in table.centres.items()}
        self.only: frozenset[Key] | None = None
        self._placed: list[tuple[_Mark, complex]] = []
        self.item = Group([item for mark in self.marks for item in (mark.dot, mark.arrow, mark.tag)])

    def dots(self, i: int, space: OccupiedSpace) -> None:
        """Place the marks at a sample; ``move`` places their numbers after everything else."""
        self._placed = []
        for mark in self.marks:
            centres = self._table.centres[mark.key]
            point, weight = complex(centres.point[i]), float(centres.weight[i])
            shown = (self.only is None or mark.key in self.only) and not point == weight == 0.0
            mark.show(shown)
            if shown:
                far = bool(self._far[mark.key][i])
                position = mark.place(point if far else point / weight * MM, far, self._viewport, space)
                self._placed.append((mark, position))

    def move(self, i: int) -> None:
        space = self._space()
        for mark, position in self._placed:
            space.place_text(mark.tag, (position,))


class KennedyLines:
    """The two lines of Kennedy's theorem through each centre, or through the centre ``only``."""

    def __init__(self, table: CentreTable, steps: Sequence[KennedyStep], theme: Theme, viewport: Viewport) -> None:
        self._table, self._viewport = table, viewport
        self._lines: dict[Triangle, np.ndarray] = {}
        self.rows: list[tuple[KennedyStep, Triangle, QGraphicsLineItem]] = []
        for step in steps:
            for triangle in step.triangles[:2]:
                line = QGraphicsLineItem()
                line.setPen(theme.pen(theme.quiet, THIN, SPARSE))
                self.rows.append((step, triangle, line))
        self._emphasised = theme.pen(theme.limit, OUTLINE)
        self._quiet = theme.pen(theme.quiet, THIN, SPARSE)
        self.only: Key | None = None
        self.hidden = False
        self.item = Group([line for _, _, line in self.rows])

    def emphasise(self, key: Key | None) -> None:
        """Draw only the lines of one centre, boldly; None draws the lines of all centres as thin lines."""
        self.only = key
        for _, _, line in self.rows:
            line.setPen(self._quiet if key is None else self._emphasised)

    def move(self, i: int) -> None:
        for step, triangle, item in self.rows:
            shown = not self.hidden and (self.only is None or step.key == self.only)
            line = self._line(triangle)[:, i] * np.array([1.0, 1.0, MM]) if shown else None
            ends = self._viewport.across(line) if line is not None else None
            item.setVisible(ends is not None)
            if ends is not None:
                item.setLine(QLineF(at(ends[0]), at(ends[1])))

    def _line(self, triangle: Triangle) -> np.ndarray:
        if triangle not in self._lines:
            self._lines[triangle] = triangle_line(self._table.centres, triangle)
        return self._lines[triangle]


def _paths(geometry: Geometry) -> Iterator[tuple[str, np.ndarray, bool]]:
    """Name and path (n,) [mm] of each named point, and whether its link is a coupler, without a pair on the frame."""
    grounded = {j.pair.body for j in geometry.joints if j.is_fixed}
    grounded_points = {name for body in grounded | {FRAME} for name in geometry.bodies[body].points}
    names: set[str] = set()
    for body in geometry.moving.values():
        for name, point in body.points.items():
            if name in names or name == ROLLER or name.isdecimal() or name in geometry.bodies[FRAME].points:
                continue
            names.add(name)
            yield name, body.track(point), name not in grounded_points


def coupler_curves(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Paths of all named points over the turn; the curves of coupler points are bold."""
    for name, track, on_coupler in _paths(geometry):
        pen = theme.pen(theme.seen(BLUE), OUTLINE) if on_coupler else theme.pen(theme.quiet, THIN, DOTTED)
        item = Loop(track, pen) if geometry.is_full_turn else Outline(polyline(track), pen)
        yield DrawnPart(f"coupler.{name}", item, ("coupler",), Z_COUPLER if on_coupler else Z_PATHS)


def ghost_poses(geometry: Geometry, theme: Theme, layer: str) -> Iterator[DrawnPart]:
    """Poses of the links at equal steps of the turn, as thin lines between their points."""
    turn = np.arange(0, 360, GHOST_POSES[layer])
    indices = sorted({geometry.nearest(float(theta)) for theta in np.deg2rad(turn)})
    path = QPainterPath()
    for body in geometry.moving.values():
        tracks = [body.track(node)[indices] for node in body.nodes.values()]
        if len(tracks) > 1:
            for pose in np.array(tracks).T:
                path.addPath(polyline(np.append(pose, pose[0]) if pose.size > 2 else pose))
    yield DrawnPart(f"{layer}.all", Outline(path, theme.pen(theme.quiet, THIN)), (layer,), Z_PATHS)


# -- velocity ratios -----------------------------------------------------------------------------------

Z_RATIOS = 9.0
COLOURS = (BLUE, VERMILION, PURPLE, "#8C6D1F", "#00796B")  # colours of the ratios in turn
OFFSET, STEP = 15.0, 9.0  # from the line of the centres to the first dimension, and from one to the next, pixels
ARROW_HEAD, TICK = 6.0, 4.0  # arrow head of a dimension, and extension line beyond the dimension, pixels
LINE, UNDER_ANGLE = 17.0, 28.0  # height of a line of the list, and distance of the list from the top, pixels
DIGITS = 4
ALONG, GAPS = (0.5, 0.3, 0.7, 0.1, 0.9), (2.0, 10.0, 22.0, 38.0)  # positions of a length along and across its line
Pairs = Callable[[CentreTable, str], Sequence[tuple[str, str]]]


def ratio_text(arms: RatioArms, i: int, base_speed: float, body_speed: float) -> str:
    """Text of a velocity ratio at a sample; a body that does not turn has its velocity. Speeds in rad/s."""
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
    fraction = f"{names[0]}{names[2]} / {names[1]}{names[2]} = {_figure(above)} / {_figure(below)} mm"
    return f"ω{body}/ω{base} = {fraction} = {_figure(ratio)}"


def _figure(value: float) -> str:
    return digits(float(f"{value:.9g}") if abs(value) > 1e-9 else 0.0, DIGITS)


class _Dimension:
    """Dimension of the distance between two centres, parallel to their line."""

    def __init__(self, start: Key, end: Key, colour: str, theme: Theme) -> None:
        self.start, self.end = start, end
        self.line = Outline(QPainterPath(), theme.pen(colour, OUTLINE), brush(colour))
        self.tag = Tag("", theme.text_colour(colour), theme, SMALL, (0.5, 0.5), backing=True)
        self.name = f"I{centre_name(start)}I{centre_name(end)}"

    def show(self, on: bool) -> None:
        self.line.setVisible(on)
        self.tag.setVisible(on)

    def lay(
        self, start: complex, end: complex, offset: complex, length: float, viewport: Viewport, space: OccupiedSpace
    ) -> None:
        """Draw the dimension between two centres [mm] at an offset [mm]; ``length`` [mm] is shown with its sign."""
        pixel = 1.0 / viewport.scale
        part = _visible_part(start + offset, end + offset, viewport)
        self.show(part is not None and abs(end - start) > 2.0 * ARROW_HEAD * pixel)
        if part is None or not self.line.isVisible():
            return
        along = (end - start) / abs(end - start)
        path = QPainterPath()
        first, second = (start + offset + t * (end - start) for t in part)
        _stroke(path, first, second)
        for centre, is_visible, direction in ((start, part[0] <= 0.0, along), (end, part[1] >= 1.0, -along)):
            if is_visible:
                _stroke(path, centre, centre + offset * (1.0 + TICK * pixel / abs(offset)))
                tip = centre + offset
                for side in (0.35j, -0.35j):
                    _stroke(path, tip, tip + ARROW_HEAD * pixel * direction * (1.0 + side))
        self.line.redraw(path)
        self.tag.set_text(f"{self.name} {_figure(length)} mm")
        space.place_text(self.tag, [first + t * (second - first) for t in ALONG], GAPS)


def _stroke(path: QPainterPath, start: complex, end: complex) -> None:
    path.moveTo(start.real, start.imag)
    path.lineTo(end.real, end.imag)


def _visible_part(start: complex, end: complex, viewport: Viewport) -> tuple[float, float] | None:
    """Visible range of a line segment, from 0 at its start to 1 at its end; None where it is not visible."""
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
    """Velocity ratios of a chain: two dimensions for each ratio, and a list below the angle."""

    def __init__(
        self, geometry: Geometry, pairs: Pairs, theme: Theme, viewport: Viewport, space: Callable[[], OccupiedSpace]
    ) -> None:
        self._geometry, self._viewport, self._space = geometry, viewport, space
        self._table = geometry.study.centres
        self._far: dict[Key, np.ndarray] = {}
        driver = body_name(geometry.study.design.drive.linkage.driver.link)
        self.rows: list[tuple[RatioArms, tuple[_Dimension, _Dimension], Tag]] = []
        for number, (body, base) in enumerate(pairs(self._table, driver)):
            colour = theme.seen(COLOURS[number % len(COLOURS)])
            arms = ratio_arms(self._table, body, base)
            lines = (
                _Dimension(arms.base_key, arms.common_key, colour, theme),
                _Dimension(arms.body_key, arms.common_key, colour, theme),
            )
            self.rows.append((arms, lines, Tag("", theme.text_colour(colour), theme, SMALL, (0.0, 0.0), backing=True)))
        items = [item for _, lines, tag in self.rows for d in lines for item in (d.line, d.tag)]
        self.item = Group([*items, *(tag for _, _, tag in self.rows)])

    @property
    def texts(self) -> list[str]:
        """Lines of the list."""
        return [tag.text for _, _, tag in self.rows]

    def move(self, i: int) -> None:
        for number, (arms, (base, body), _) in enumerate(self.rows):
            centres = [self._position(key, i) for key in (arms.base_key, arms.body_key, arms.common_key)]
            spans = ((base, centres[0], 1.0, arms.base_arm[i]), (body, centres[1], -1.0, arms.body_arm[i]))
            for line, start, side, length in spans:
                end = centres[2]
                line.show(False)
                if start is None or end is None or start == end or not math.isfinite(length):
                    continue
                across = 1j * self._along(centres) * side * (OFFSET + STEP * number) / self._viewport.scale
                line.lay(start, end, across, float(length) * MM, self._viewport, self._space())

    def _position(self, key: Key, i: int) -> complex | None:
        """Position of a centre at a sample [mm]; None at infinity."""
        centre = self._table.centres[key]
        if key not in self._far:
            self._far[key] = centre.is_far(self._table.size)
        return None if self._far[key][i] else complex(centre.point[i]) / float(centre.weight[i]) * MM

    @staticmethod
    def _along(centres: Sequence[complex | None]) -> complex:
        """Direction of the line of the centres; opposite directions count as one."""
        finite = [p for p in centres if p is not None]
        direction = max((b - a for a in finite for b in finite), key=abs)
        direction = direction / abs(direction)
        return direction if direction.real > 0.0 or (direction.real == 0.0 and direction.imag > 0.0) else -direction

    # -- the list --------------------------------------------------------------------------------------

    @property
    def height(self) -> float:
        """Height of the list [pixels]."""
        return LINE * len(self.rows)

    def list(self, i: int, space: OccupiedSpace, down: float) -> None:
        """Write the list at a sample, ``down`` [pixels] below its highest position."""
        omega, bodies = self._geometry.study.omega, self._geometry.kinematics.bodies
        visible, scale = self._viewport.visible, self._viewport.scale
        x, y = visible.left() * scale + MARGIN, -visible.bottom() * scale + sized(UNDER_ANGLE) + down
        for number, (arms, _, tag) in enumerate(self.rows):
            tag.set_text(
                ratio_text(arms, i, *(float(bodies[name].turn[1][i]) * omega for name in (arms.base, arms.body)))
            )
            tag.setPos(QPointF(x / scale, -(y + LINE * number) / scale))
            space.reserve(QRectF(x, y + LINE * number, tag.size[0], LINE))


# -- layers of a general linkage -----------------------------------------------------------------------


class LinkageLayers:
    """Layers of one linkage, each drawn when it is first shown.

    Call ``begin`` before each move, and ``show_step`` for a step of the circle diagram. ``texts`` returns the boxes of
    the visible labels in pixels of the scene.
    """

    def __init__(
        self, geometry: Geometry, theme: Theme, viewport: Viewport, texts: Callable[[], list[QRectF]], step: int | None
    ) -> None:
        self._geometry, self._theme, self._viewport, self._texts = geometry, theme, viewport, texts
        self._step, self._drawn_layers = step, set[str]()
        self._index = 0
        self._space: OccupiedSpace | None = None
        self.marks: CentreMarks | None = None
        self.kennedy: KennedyLines | None = None
        self.ratios: dict[str, RatioDimensions] = {}

    def parts(self, layer: str) -> Iterator[DrawnPart]:
        """Draw a layer; nothing where it is drawn already."""
        if layer not in self._drawn_layers:
            self._drawn_layers.add(layer)
            yield from _LAYERS[layer](self, layer)
            self.show_step(self._step)

    def begin(self, index: int) -> None:
        """Prepare a move to a sample, where all texts are placed again."""
        self._index, self._space = index, None

    def space(self) -> OccupiedSpace:
        """Occupied space at the current sample."""
        if self._space is None:
            drawn = drawing_dots(self._geometry, np.array([self._index]), ())
            self._space = OccupiedSpace(self._viewport, drawn, self._texts())
            down = 0.0
            for ratios in self._listed():
                ratios.list(self._index, self._space, down)
                down += ratios.height
            if self.marks is not None and self.marks.item.isVisible():
                self.marks.dots(self._index, self._space)
        return self._space

    @property
    def strip(self) -> float:
        """Height of the lists at the top of the view [pixels]."""
        return sum(ratios.height for ratios in self._listed())

    def _listed(self) -> list[RatioDimensions]:
        return [ratios for ratios in self.ratios.values() if ratios.item.isVisible()]

    def show_step(self, step: int | None) -> None:
        """Show the known centres at a step of the circle diagram, and the lines of the next one; None shows all."""
        self._step = step
        if self.marks is None and self.kennedy is None:
            return
        plan = self._geometry.study.centres.construction
        known = None if step is None else frozenset((*plan.known, *(w.key for w in plan.steps[:step])))
        target = plan.steps[step - 1].key if step and step <= len(plan.steps) else None
        if self.marks is not None:
            self.marks.only = known
        if self.kennedy is not None:
            self.kennedy.emphasise(target if step is not None else None)
            self.kennedy.hidden = step == 0

    # -- layers ----------------------------------------------------------------------------------------

    def _centres(self, layer: str) -> Iterator[DrawnPart]:
        self.marks = CentreMarks(self._geometry.study.centres, self._theme, self._viewport, self.space)
        yield DrawnPart(f"{layer}.all", self.marks.item, (layer,), Z_CENTRES, self.marks.move)

    def _kennedy(self, layer: str) -> Iterator[DrawnPart]:
        table = self._geometry.study.centres
        self.kennedy = KennedyLines(table, table.construction.steps, self._theme, self._viewport)
        yield DrawnPart(f"{layer}.all", self.kennedy.item, (layer,), Z_LINES, self.kennedy.move)

    def _ratios(self, layer: str) -> Iterator[DrawnPart]:
        drawn = RatioDimensions(self._geometry, CHAINS[layer], self._theme, self._viewport, self.space)
        self.ratios[layer] = drawn
        yield DrawnPart(f"{layer}.all", drawn.item, (layer,), Z_RATIOS, drawn.move)

    def paths(self, names: Collection[str] | None = None) -> list[np.ndarray]:
        """Paths of the coupler layer (n,) [mm], of all points or of these."""
        return [track for name, track, _ in _paths(self._geometry) if names is None or name in names]

    def _poses(self, layer: str) -> Iterator[DrawnPart]:
        yield from ghost_poses(self._geometry, self._theme, layer)


_LAYERS: Mapping[str, Callable[[LinkageLayers, str], Iterator[DrawnPart]]] = MappingProxyType(
    {
        "centres": LinkageLayers._centres,
        "kennedy": LinkageLayers._kennedy,
        "ratios": LinkageLayers._ratios,
        "chain": LinkageLayers._ratios,
        "coupler": lambda layers, _: coupler_curves(layers._geometry, layers._theme),
        **dict.fromkeys(GHOST_POSES, LinkageLayers._poses),
    }
)


# -- circle diagram ------------------------------------------------------------------------------------

_TINTS = (BLUE, GREEN)  # tints of the two triangles


class CircleDiagram(QWidget):
    """Circle diagram: links as numbers on a circle, centres as lines between them."""

    NUMBER = 11.0  # radius of a number's disc, pixels

    def __init__(self) -> None:
        super().__init__(accessibleName="Circle diagram")
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.bodies: tuple[str, ...] = ()
        self.solid: tuple[tuple[str, str], ...] = ()
        self.dotted: tuple[tuple[str, str], ...] = ()
        self.target: KennedyStep | None = None

    def sizeHint(self) -> QSize:
        return QSize(220, 200)

    def minimumSizeHint(self) -> QSize:
        return QSize(120, 110)

    def show_step(self, bodies: tuple[str, ...], plan: Construction, step: int) -> None:
        """Show a step: 0 shows the primary centres, each further step one more centre."""
        self.bodies = bodies
        self.target = plan.steps[step - 1] if step else None
        self.solid = (*plan.known, *(w.key for w in plan.steps[: max(step - 1, 0)]))
        self.dotted = tuple(w.key for w in plan.steps[max(step - 1, 0) :])
        self.update()

    def number_position(self, body: str) -> QPointF:
        """Position of a link's number [pixels], clockwise from the top."""
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
        offset = self.number_position(self.bodies[0]) - middle
        radius = abs(complex(offset.x(), offset.y()))
        painter.setPen(QPen(QColor(SCREEN.shaft), 1.0))
        painter.drawEllipse(middle, radius, radius)
        if self.target is not None:
            for triangle, colour in zip(self.target.triangles, _TINTS, strict=False):
                tint = QColor(colour)
                tint.setAlphaF(0.16)
                painter.setPen(Qt.PenStyle.NoPen)
                painter.setBrush(tint)
                painter.drawPolygon(QPolygonF([self.number_position(b) for b in (*self.target.key, triangle.third)]))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for keys, pen in (
            (self.dotted, QPen(QColor(SCREEN.quiet), 1.0, Qt.PenStyle.DotLine)),
            (self.solid, QPen(QColor(SCREEN.ink), 1.5)),
        ):
            painter.setPen(pen)
            for key in keys:
                painter.drawLine(self.number_position(key[0]), self.number_position(key[1]))
        if self.target is not None:
            painter.setPen(QPen(QColor(SCREEN.limit), 2.0, Qt.PenStyle.DotLine))
            painter.drawLine(self.number_position(self.target.key[0]), self.number_position(self.target.key[1]))
        painter.setFont(font(12))
        for body in self.bodies:
            box = QRectF(0.0, 0.0, 2.0 * self.NUMBER, 2.0 * self.NUMBER)
            box.moveCenter(self.number_position(body))
            painter.setPen(QPen(QColor(SCREEN.ink), 1.0))
            painter.setBrush(QColor(SCREEN.paper))
            painter.drawEllipse(box)
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, str(link_number(body)))


def construction_text(plan: Construction, step: int) -> str:
    """Sentence that describes a step of the circle diagram."""
    if step == 0:
        names = ", ".join(centre_name(key) for key in plan.known)
        return f"Pins and guides give the centres {names}. {len(plan.steps)} more are to be constructed."
    target = plan.steps[step - 1]
    lines = []
    for triangle in target.triangles[:2]:
        links = sorted(link_number(body) for body in (*target.key, triangle.third))
        ends = f"{centre_name(triangle.first)}\u2013{centre_name(triangle.second)}"
        lines.append(f"{ends} (links {', '.join(map(str, links))})")
    return f"{centre_name(target.key)} is the intersection of the lines {' and '.join(lines)}."
