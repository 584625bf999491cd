"""Picking of load attachments in the drawing by clicks, and the rows of the loads at a position."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Sequence
from dataclasses import replace
from math import floor, log10

from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFont, QPainter, QPen
from PySide6.QtWidgets import QGraphicsPathItem

from core.design import (
    FRAME_LINK,
    HOLDS,
    LINK,
    PAIR,
    POINT,
    AttachedEnd,
    Attachment,
    PairTarget,
    Target,
    get,
    link_points,
    load_lists,
    targets_for,
)
from core.dynamics import Torsion, attachment_point, element_at, pairs_named, row_of_element
from core.errors import NoSolution
from core.frozen import frozen
from core.output.load_text import attachment_text
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.drawing.load_parts import spirals
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.style import SCREEN

NEAR, ALONG = 11.0, 7.0  # snap distances from a named point and from a line of a link, pixels
UPON = 2.5  # snap distance to its line from a position on the face of a link, pixels
MARK_RADIUS = 6.0  # radius of a mark, pixels
REACH = 9.0  # distance within which a row of the loads is hit, pixels
ROW_MARK_RADIUS = 9.0  # radius of the mark of the selected row, pixels
ROW_LINE_WIDTH = 6.0  # width of its line between two ends, pixels
SYMBOLS = frozenset({"spring", "damper", "load", "torque"})
"""First words of the keys of the parts that show a row of the loads."""

PickFunction = Callable[[Sequence[Target | None]], object]
"""Called with the picked attachments in their order; with an empty sequence for the suggested ones."""

# -- picking ---------------------------------------------------------------------------------------------


@frozen
class PickCandidate:
    """An attachment that can be picked, and its current position [mm]."""

    target: Target
    at: complex


class Picker(QObject):
    """Lets the user pick attachments one after the other; Return accepts the suggested ones, Escape cancels.

    prompted   (text): what to click next
    ended      (text): picking has ended; the text says why, and is empty after a pick
    """

    prompted = Signal(str)
    ended = Signal(str)

    def __init__(self, canvas: Canvas, scene: MechanismScene) -> None:
        super().__init__(canvas)
        self._canvas, self._scene = canvas, scene
        self._ends: tuple[AttachedEnd, ...] = ()
        self._picked: list[Target | None] = []
        self._other_ends: list[Target | None] = []
        self._accept: PickFunction | None = None
        self._what = ""
        self._is_optional = False
        self._under: PickCandidate | None = None

    # -- start, clicks, end ---------------------------------------------------------------------------------

    @property
    def active(self) -> bool:
        """Whether an attachment is being picked."""
        return self._accept is not None

    def start(
        self,
        what: str,
        ends: Sequence[AttachedEnd],
        accept: PickFunction,
        is_optional: bool = False,
        other_ends: Sequence[Target | None] = (),
    ) -> None:
        """Start picking the attachments of ``what``.

        With ``is_optional`` Return accepts the suggested ones; ``other_ends`` are the other attachments of the same row.
        """
        self.end("")
        self._what, self._ends, self._accept, self._is_optional = what, tuple(ends), accept, is_optional
        self._picked, self._other_ends, self._under = [], list(other_ends), None
        self._canvas.picking = True
        self._prompt()

    def _prompt(self) -> None:
        keys = [*(["Enter accepts the suggested attachment"] if self._is_optional else []), "Esc cancels"]
        self.prompted.emit(f"{self._what}: click {prompt_text(self._current)}. {', '.join(keys)}")
        self._canvas.viewport().update()

    @property
    def _current(self) -> AttachedEnd:
        return self._ends[len(self._picked)]

    def end(self, how: str) -> None:
        """End picking; ``how`` says why."""
        if self._accept is not None:
            self._accept, self._canvas.picking, self._under = None, False, None
            self._canvas.viewport().update()
            self.ended.emit(how)

    def skip(self) -> None:
        """Accept the suggested attachments, if allowed."""
        if self._accept is not None and self._is_optional:
            self._finish([])

    def _finish(self, picked: Sequence[Target | None]) -> None:
        accept = self._accept
        self.end("")
        assert accept is not None
        accept(picked)

    def click(self, at: complex) -> None:
        """Pick the attachment at a position [mm]."""
        candidate = self.candidate_at(at)
        if candidate is None:
            self.prompted.emit(f"Nothing to select here. {self._what}: click {prompt_text(self._current)}. Esc cancels")
            return
        self._picked.append(candidate.target)
        self._under = None
        if len(self._picked) == len(self._ends):
            self._finish(self._picked)
        else:
            self._prompt()

    def hover(self, at: complex | None) -> None:
        """Highlight the attachment at a position [mm]; None: the mouse is not on the canvas."""
        under = None if at is None or not self.active else self.candidate_at(at)
        if under != self._under:
            self._under = under
            self._canvas.viewport().update()

    # -- candidates -----------------------------------------------------------------------------------------

    @property
    def _geometry(self) -> Geometry | None:
        return self._scene.geometry

    def candidates(self) -> list[PickCandidate]:
        """Return the named attachments that can be picked; at equal positions the first has priority."""
        geometry = self._geometry
        if geometry is None or not self.active:
            return []
        drive = geometry.study.design.drive
        end = (
            replace(self._current, what=POINT, fields=())
            if self._current.what == LINK and self._current.free
            else self._current
        )
        return [
            PickCandidate(target, at)
            for target in targets_for(drive, end)
            if self._is_valid(target)
            for at in target_positions(geometry, target, self._scene.index)
        ]

    def _is_valid(self, target: Target) -> bool:
        """Whether the distance to the other ends can change: not the same link, nor two points of one link."""
        if not isinstance(target, Attachment) or self._geometry is None:
            return True
        points = link_points(self._geometry.study.design.drive).values()
        for end in (*self._picked, *self._other_ends):
            if isinstance(end, Attachment):
                both = {end.point, target.point}
                if target.link == end.link or (None not in both and any(both <= set(names) for names in points)):
                    return False
        return True

    def candidate_at(self, at: complex) -> PickCandidate | None:
        """Return the attachment at a position [mm]: the nearest named one, else a position on a link or the ground."""
        geometry, scale = self._geometry, self._canvas.scale_now
        if geometry is None:
            return None
        end = self._current
        distances = [(abs(row.at - at) * scale, i, row) for i, row in enumerate(self.candidates())]
        near = [row for row in distances if row[0] <= NEAR]
        if near:
            best = min(near)[2]
            return self._placed(best) if end.free and end.what == LINK else best
        if end.what == PAIR:
            return None
        if end.what == LINK or end.free:
            return self._on_link(geometry, at) or self._on_ground(at)
        return None

    def _placed(self, candidate: PickCandidate) -> PickCandidate:
        """Replace a named point by its coordinates in the frame of its link."""
        target, geometry = candidate.target, self._geometry
        assert isinstance(target, Attachment)
        assert geometry is not None
        point = attachment_point(target, geometry.study.mechanism)
        return PickCandidate(self._at(target.link, point.at * MM), candidate.at)

    def _at(self, link: int, local: complex) -> Attachment:
        decimals = max(0, floor(log10(self._canvas.scale_now)))
        return Attachment(link=link, x_mm=round(local.real, decimals) + 0.0, y_mm=round(local.imag, decimals) + 0.0)

    def _on_link(self, geometry: Geometry, at: complex) -> PickCandidate | None:
        """Attachment to the uppermost link under the mouse, else to the link whose line is near, snapped to the line.

        Without coordinates where only the link is picked.
        """
        from core.mechanism.drawing_targets import (
            nearest_on_segment,
        )  # imported at the first click: the start is shorter

        index, scale = self._scene.index, self._canvas.scale_now
        links = {
            name: number
            for number, name in geometry.study.mechanism.bodies.items()
            if name in geometry.moving and self._is_valid(Attachment(link=number))
        }
        name, position = self.face_at(geometry, links, at), at
        reach = ALONG if name is None else UPON
        for candidate in links if name is None else (name,):
            body = geometry.bodies[candidate]
            nodes = [complex(body.track(node)[index]) for node in geometry.nodes(body).values()]
            for nearest in (nearest_on_segment(at, start, end) for start in nodes for end in nodes):
                if abs(at - nearest) * scale < reach:
                    reach, name, position = abs(at - nearest) * scale, candidate, nearest
        if name is None:
            return None
        body = geometry.bodies[name]
        local = (position - body.z[index]) * body.turn[index].conjugate()
        target = self._at(links[name], complex(local)) if self._current.free else Attachment(link=links[name])
        return PickCandidate(target, position)

    def face_at(self, geometry: Geometry, names: Container[str], at: complex) -> str | None:
        """Return the uppermost of these bodies whose bar, lever, plate or block is drawn at a position [mm]."""
        owners = {f"body.{name}": name for name in geometry.moving}
        owners |= {f"{kind}.{joint.name}": joint.pair.body for joint in geometry.joints for kind in ("block", "stem")}
        parts = [
            (part.z, owners[key], part.item)
            for key, part in self._scene.parts.items()
            if owners.get(key) in names and isinstance(part.item, QGraphicsPathItem)
        ]
        point = QPointF(at.real, at.imag)
        under = [(z, name) for z, name, item in parts if item.path().contains(item.mapFromScene(point))]
        return max(under)[1] if under else None

    def _on_ground(self, at: complex) -> PickCandidate | None:
        if not self._current.frame or not self._is_valid(Attachment(link=FRAME_LINK)):
            return None
        return PickCandidate(self._at(FRAME_LINK, at) if self._current.free else Attachment(link=FRAME_LINK), at)

    # -- painting -------------------------------------------------------------------------------------------

    def paint(self, painter: QPainter) -> None:
        """Mark the candidates, and name the one under the mouse; in pixels of the viewport."""
        if not self.active:
            return
        colour = QColor(SCREEN.chosen)
        painter.setPen(QPen(colour, 1.4))
        fill = QColor(colour)
        fill.setAlpha(50)
        painter.setBrush(fill)
        for at in {candidate.at for candidate in self.candidates()}:
            painter.drawEllipse(self._canvas.pixel_at(at), MARK_RADIUS, MARK_RADIUS)
        for target in (*self._picked, *self._other_ends):
            for at in target_positions(self._geometry, target, self._scene.index) if self._geometry and target else ():
                painter.setBrush(colour)
                painter.drawEllipse(self._canvas.pixel_at(at), MARK_RADIUS - 1.0, MARK_RADIUS - 1.0)
        if self._under is not None and self._geometry is not None:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(colour, 2.4))
            pixel = self._canvas.pixel_at(self._under.at)
            painter.drawEllipse(pixel, MARK_RADIUS + 3.0, MARK_RADIUS + 3.0)
            self._name(painter, pixel, attachment_text(self._geometry.study.design, self._under.target))

    def _name(self, painter: QPainter, pixel: QPointF, text: str) -> None:
        font = QFont(self._canvas.font())
        font.setBold(True)
        painter.setFont(font)
        metrics = painter.fontMetrics()
        room = QRectF(
            pixel.x() + 14.0,
            pixel.y() - 1.5 * metrics.height(),
            metrics.horizontalAdvance(text) + 8.0,
            metrics.height() + 2.0,
        )
        width = self._canvas.viewport().width()
        if room.right() > width:
            room.moveRight(pixel.x() - 14.0)
        painter.fillRect(room, self._canvas.palette().base())
        painter.setPen(QColor(SCREEN.chosen))
        painter.drawText(room, Qt.AlignmentFlag.AlignCenter, text)


_KIND_TEXTS = {POINT: "a point of a link", LINK: "a link", PAIR: "a pin or a slide"}
_KEY_TEXTS = {"from": "the first point", "to": "the second point", "on": "the link it turns against"}


def prompt_text(end: AttachedEnd) -> str:
    """Text that says what to click: ``the first point: a joint, any point on a link, or the ground``."""
    text = _KEY_TEXTS.get(end.key, _KIND_TEXTS[end.what])
    if end.what == POINT and end.free:
        return f"{text}: a joint, any point on a link, or the ground"
    if end.what == LINK and end.free:
        return f"{text} where its centre of mass is"
    return f"{text}, or the ground" if end.what == LINK and end.frame else text


def target_positions(geometry: Geometry, target: Target, index: int) -> Iterator[complex]:
    """Yield the positions of an attachment at a sample [mm]: one, for a link without a point its centre, or none."""
    built = geometry.study.mechanism
    if isinstance(target, PairTarget):
        links = {n for n in (target.link, target.other) if n is not None}
        names = pairs_named(target.pair, links, built)[:1]
        yield from (complex(joint.track[index]) for joint in geometry.joints if joint.name in names)
        return
    if target.point is None and target.x_mm is None:
        body = geometry.bodies.get(built.bodies.get(target.link, ""))
        nodes = [] if body is None else [complex(body.track(node)[index]) for node in geometry.nodes(body).values()]
        if nodes:
            yield sum(nodes) / len(nodes)
        return
    point = attachment_point(target, built)
    body = geometry.bodies.get(point.body)
    yield point.at * MM if body is None else complex(body.track(point.at * MM)[index])


# -- rows of the loads -----------------------------------------------------------------------------------


def row_positions(geometry: Geometry, path: str, index: int) -> list[complex]:
    """Return the position of a row of the loads at a sample [mm], or of its two ends; empty if it has none."""
    design = geometry.study.design
    positions: list[complex] = []
    try:
        row = get(design, path)
        element = element_at(geometry.study.loading, path)
        if isinstance(element, Torsion):
            return [complex(track[index]) for track in spirals(element, geometry)]
        for end in HOLDS[path.partition(".")[2].partition("[")[0]]:
            target = end.read(row)
            positions += (
                [_output(geometry, index)] if target is None else list(target_positions(geometry, target, index))[:1]
            )
    except (KeyError, NoSolution):
        return []
    return positions


def _output(geometry: Geometry, index: int) -> complex:
    """Position of the driven point of the output [mm]."""
    kinematics = geometry.kinematics
    return complex(kinematics.bodies[kinematics.output].position(kinematics.driver_pair.point)[index]) * MM


def row_paths(geometry: Geometry) -> Iterator[str]:
    """Yield the paths of the rows of the loads."""
    drive = geometry.study.design.drive
    for name in load_lists(drive):
        yield from (f"loads.{name}[{i}]" for i in range(len(getattr(drive.loads, name))))


def rows_at(canvas: Canvas, at: complex) -> list[str]:
    """Return the rows of the loads at a position [mm], the nearest first."""
    from core.mechanism.drawn import nearest_on_segment  # as above

    geometry = canvas.drawn.geometry
    if geometry is None:
        return []
    near = []
    for i, path in enumerate(row_paths(geometry)):
        ends = row_positions(geometry, path, canvas.drawn.index)
        if ends:
            distance = abs(at - nearest_on_segment(at, ends[0], ends[-1])) * canvas.scale_now
            near.append((distance, i, path))
    paths = [path for distance, _, path in sorted(near) if distance <= REACH]
    return list(dict.fromkeys((*paths, *_drawn_at(canvas, at))))


def _drawn_at(canvas: Canvas, at: complex) -> Iterator[str]:
    """Yield the rows whose symbols are drawn at a position [mm]; an empty path for a load without a row."""
    reach = REACH / canvas.scale_now
    under = QRectF(at.real - reach, at.imag - reach, 2.0 * reach, 2.0 * reach)
    scene = canvas.drawn
    for key, part in scene.parts.items() if isinstance(scene, MechanismScene) else ():
        what, _, name = key.partition(".")
        item = part.item
        drawn = what in SYMBOLS and isinstance(item, QGraphicsPathItem) and item.isVisible() and item.opacity() > 0.0
        if drawn and item.mapToScene(item.path()).intersects(under):  # type: ignore[attr-defined]
            yield row_of_element(name)


def next_row(rows: list[str], chosen: str) -> str:
    """Return the row that the next click selects: the one after ``chosen``, else the first."""
    return rows[(rows.index(chosen) + 1) % len(rows)] if chosen in rows else rows[0]


def paint_row(canvas: Canvas, painter: QPainter, path: str) -> None:
    """Mark the selected row; in pixels of the viewport."""
    geometry = canvas.drawn.geometry
    if geometry is None or not path:
        return
    pixels = [canvas.pixel_at(at) for at in row_positions(geometry, path, canvas.drawn.index)]
    pale = QColor(SCREEN.chosen)
    pale.setAlpha(70)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    if len(pixels) > 1:
        painter.setPen(QPen(pale, ROW_LINE_WIDTH, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        painter.drawLine(pixels[0], pixels[-1])
    painter.setPen(QPen(QColor(SCREEN.chosen), 1.6))
    for pixel in pixels:
        painter.drawEllipse(pixel, ROW_MARK_RADIUS, ROW_MARK_RADIUS)
