"""Picking and choosing."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Sequence
from dataclasses import replace
from math import floor, log10

import numpy as np
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

# -- picking ---------------------------------------------------------------------------------------------

NEAR, ALONG = 11.0, 7.0  # pixels from a named place, and from a line of a link, within which it is meant
UPON = 2.5  # pixels from its line within which a place on the face of a link is meant to be upon it
MARK_RADIUS = 6.0  # radius of a mark, pixels

Taken = Callable[[Sequence[Target | None]], object]
"""Called with what was chosen, in the order of the holds; with nothing where it shall be placed as it can."""


@frozen
class PickCandidate:
    """What can be chosen, and where it stands now [mm]."""

    held: Target
    at: complex


class Picker(QObject):
    """Asks for one hold after the other, until all are chosen, Return leaves them as they come, or Escape ends it.

    prompted   (text): what is to be clicked now
    over       it has ended; the text says how, empty where something was chosen
    """

    prompted = Signal(str)
    over = Signal(str)

    def __init__(self, canvas: Canvas, scene: MechanismScene) -> None:
        super().__init__(canvas)
        self._canvas, self._scene = canvas, scene
        self._holds: tuple[AttachedEnd, ...] = ()
        self._got: list[Target | None] = []
        self._beside: list[Target | None] = []
        self._taken: Taken | None = None
        self._what = ""
        self._can_be_left = False
        self._under: PickCandidate | None = None

    # -- a question -----------------------------------------------------------------------------------------

    @property
    def active(self) -> bool:
        """Whether something is to be chosen now."""
        return self._taken is not None

    def ask(
        self,
        what: str,
        holds: Sequence[AttachedEnd],
        taken: Taken,
        can_be_left: bool = False,
        beside: Sequence[Target | None] = (),
    ) -> None:
        """Let these be chosen for ``what``; can_be_left: Return takes what comes; beside: where the row holds on besides."""
        self.end("")
        self._what, self._holds, self._taken, self._can_be_left = what, tuple(holds), taken, can_be_left
        self._got, self._beside, self._under = [], list(beside), None
        self._canvas.picking = True
        self._prompt()

    def _prompt(self) -> None:
        ways = [*(["Enter: as it comes"] if self._can_be_left else []), "Esc: none"]
        self.prompted.emit(f"{self._what}: click {wanted_text(self._hold)}. {', '.join(ways)}")
        self._canvas.viewport().update()

    @property
    def _hold(self) -> AttachedEnd:
        return self._holds[len(self._got)]

    def end(self, how: str) -> None:
        """Ask no longer."""
        if self._taken is not None:
            self._taken, self._canvas.picking, self._under = None, False, None
            self._canvas.viewport().update()
            self.over.emit(how)

    def leave(self) -> None:
        """As it comes, where that can be."""
        if self._taken is not None and self._can_be_left:
            self._finish([])

    def _finish(self, got: Sequence[Target | None]) -> None:
        taken = self._taken
        self.end("")
        assert taken is not None
        taken(got)

    def click(self, at: complex) -> None:
        """The mouse was clicked at a place [mm]."""
        found = self.candidate_at(at)
        if found is None:
            self.prompted.emit(f"Nothing there that serves. {self._what}: click {wanted_text(self._hold)}. Esc: none")
            return
        self._got.append(found.held)
        self._under = None
        if len(self._got) == len(self._holds):
            self._finish(self._got)
        else:
            self._prompt()

    def hover(self, at: complex | None) -> None:
        """The mouse is at a place [mm], or elsewhere."""
        under = None if at is None or not self.active else self.candidate_at(at)
        if under != self._under:
            self._under = under
            self._canvas.viewport().update()

    # -- what there is --------------------------------------------------------------------------------------

    @property
    def _geometry(self) -> Geometry | None:
        return self._scene.geometry

    def candidates(self) -> list[PickCandidate]:
        """All with a name that can be chosen now; of several at one place the first is meant."""
        geometry = self._geometry
        if geometry is None or not self.active:
            return []
        drive = geometry.study.design.drive
        hold = replace(self._hold, what=POINT, fields=()) if self._hold.what == LINK and self._hold.free else self._hold
        found = [
            PickCandidate(held, at)
            for held in targets_for(drive, hold)
            for at in places_now(geometry, held, self._scene.index)
        ]
        return [each for each in found if self._suits(each.held)]

    def _suits(self, held: Target) -> bool:
        """A second end stands on another link than the first, and elsewhere."""
        if not isinstance(held, Attachment) or self._geometry is None:
            return True
        points = link_points(self._geometry.study.design.drive).values()
        for other in (*self._got, *self._beside):
            if isinstance(other, Attachment):
                both = {other.point, held.point}
                if held.link == other.link or (None not in both and any(both <= set(names) for names in points)):
                    return False  # they would keep their distance
        return True

    def candidate_at(self, at: complex) -> PickCandidate | None:
        """What a click at a place [mm] means: the nearest with a name, else a place of a link, else of the ground."""
        geometry, scale = self._geometry, self._canvas.scale_now
        if geometry is None:
            return None
        hold = self._hold
        named = [(abs(each.at - at) * scale, i, each) for i, each in enumerate(self.candidates())]
        near = [row for row in named if row[0] <= NEAR]
        if near:
            best = min(near)[2]
            return self._placed(best) if hold.free and hold.what == LINK else best
        if hold.what == PAIR:
            return None
        if hold.what == LINK or hold.free:
            return self._on_link(geometry, at) or self._on_ground(at)
        return None

    def _placed(self, candidate: PickCandidate) -> PickCandidate:
        """The same as a place in the frame of its link."""
        held, geometry = candidate.held, self._geometry
        assert isinstance(held, Attachment)
        assert geometry is not None
        place = attachment_point(held, geometry.study.mechanism)
        return PickCandidate(self._at(held.link, place.at * MM), candidate.at)

    def _at(self, link: int, local: complex) -> Attachment:
        decimals = max(0, floor(log10(self._canvas.scale_now)))
        return Attachment(link=link, x_mm=round(local.real, decimals) + 0.0, y_mm=round(local.imag, decimals) + 0.0)

    def _on_link(self, geometry: Geometry, at: complex) -> PickCandidate | None:
        """A place of the link whose face is uppermost under the mouse, else of that whose line is near; upon its line where no hand
        aims beside it. Of the link alone where that is what is wanted."""
        index, scale = self._scene.index, self._canvas.scale_now
        links = {
            name: number
            for number, name in geometry.study.mechanism.bodies.items()
            if name in geometry.moving and self._suits(Attachment(link=number))
        }
        name, place = self.face_at(geometry, links, at), at
        reach = ALONG if name is None else UPON
        for each in links if name is None else (name,):
            body = geometry.bodies[each]
            nodes = [complex(body.track(node)[index]) for node in geometry.nodes(body).values()]
            for nearest in (nearest_on_segment(at, one, other) for one in nodes for other in nodes):
                if abs(at - nearest) * scale < reach:
                    reach, name, place = abs(at - nearest) * scale, each, nearest
        if name is None:
            return None
        body = geometry.bodies[name]
        local = (place - body.z[index]) * np.exp(-1j * np.deg2rad(body.angle[index]))
        held = self._at(links[name], complex(local)) if self._hold.free else Attachment(link=links[name])
        return PickCandidate(held, place)

    def face_at(self, geometry: Geometry, names: Container[str], at: complex) -> str | None:
        """Of these bodies the one whose bar, lever, plate or block is drawn uppermost at a place [mm]."""
        owners = {f"body.{name}": name for name in geometry.moving}
        owners |= {f"{kind}.{joint.name}": joint.pair.body for joint in geometry.joints for kind in ("block", "stem")}
        parts = [
            (part.z, owners[key], part.item)
            for key, part in self._scene.parts.items()
            if owners.get(key) in names and isinstance(part.item, QGraphicsPathItem)
        ]
        here = QPointF(at.real, at.imag)
        under = [(z, name) for z, name, item in parts if item.path().contains(item.mapFromScene(here))]
        return max(under)[1] if under else None

    def _on_ground(self, at: complex) -> PickCandidate | None:
        if not self._hold.frame or not self._suits(Attachment(link=FRAME_LINK)):
            return None
        return PickCandidate(self._at(FRAME_LINK, at) if self._hold.free else Attachment(link=FRAME_LINK), at)

    # -- as it looks ----------------------------------------------------------------------------------------

    def paint(self, painter: QPainter) -> None:
        """Marks of what can be chosen, a bolder one with its name under the mouse; in pixels of the viewport."""
        if not self.active:
            return
        colour = QColor(SCREEN.chosen)
        painter.setPen(QPen(colour, 1.4))
        fill = QColor(colour)
        fill.setAlpha(50)
        painter.setBrush(fill)
        for at in {each.at for each in self.candidates()}:
            painter.drawEllipse(self._pixel(at), MARK_RADIUS, MARK_RADIUS)
        for held in (*self._got, *self._beside):
            for at in places_now(self._geometry, held, self._scene.index) if self._geometry and held else ():
                painter.setBrush(colour)
                painter.drawEllipse(self._pixel(at), MARK_RADIUS - 1.0, MARK_RADIUS - 1.0)
        if self._under is not None and self._geometry is not None:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(colour, 2.4))
            here = self._pixel(self._under.at)
            painter.drawEllipse(here, MARK_RADIUS + 3.0, MARK_RADIUS + 3.0)
            self._name(painter, here, attachment_text(self._geometry.study.design, self._under.held))

    def _name(self, painter: QPainter, here: QPointF, text: str) -> None:
        font = QFont(self._canvas.font())
        font.setBold(True)
        painter.setFont(font)
        metrics = painter.fontMetrics()
        room = QRectF(
            here.x() + 14.0,
            here.y() - 1.5 * metrics.height(),
            metrics.horizontalAdvance(text) + 8.0,
            metrics.height() + 2.0,
        )
        width = self._canvas.viewport().width()
        if room.right() > width:
            room.moveRight(here.x() - 14.0)
        painter.fillRect(room, self._canvas.palette().base())
        painter.setPen(QColor(SCREEN.chosen))
        painter.drawText(room, Qt.AlignmentFlag.AlignCenter, text)

    def _pixel(self, at: complex) -> QPointF:
        return self._canvas.viewportTransform().map(QPointF(at.real, at.imag))


_WANTED = {POINT: "a point of a link", LINK: "a link", PAIR: "a pin or a slide"}
_NAMED = {"from": "the first point", "to": "the second point", "on": "the link it turns against"}


def wanted_text(hold: AttachedEnd) -> str:
    """What is to be clicked: ``the first point: a joint, a place on a link, or the ground``."""
    text = _NAMED.get(hold.key, _WANTED[hold.what])
    if hold.what == POINT and hold.free:
        return f"{text}: a joint, a place on a link, or the ground"
    if hold.what == LINK and hold.free:
        return f"{text} where its centre of mass is"
    return f"{text}; the ground stands for the frame" if hold.what == LINK else text


def nearest_on_segment(at: complex, one: complex, other: complex) -> complex:
    """The place of a stretch that is nearest to another place."""
    along = other - one
    size = abs(along) ** 2
    share = 0.0 if size == 0.0 else min(max(((at - one) * along.conjugate()).real / size, 0.0), 1.0)
    return one + share * along


def places_now(geometry: Geometry, held: Target, index: int) -> Iterator[complex]:
    """Where a held place stands at a sample [mm]: one place, of a link alone its points, none where there is none."""
    built = geometry.study.mechanism
    if isinstance(held, PairTarget):
        links = {n for n in (held.link, held.other) if n is not None}
        names = pairs_named(held.pair, links, built)[:1]
        yield from (complex(joint.track[index]) for joint in geometry.joints if joint.name in names)
        return
    if held.point is None and held.x_mm is None:
        body = geometry.bodies.get(built.bodies.get(held.link, ""))
        nodes = [] if body is None else [complex(body.track(place)[index]) for place in geometry.nodes(body).values()]
        if nodes:
            yield sum(nodes) / len(nodes)
        return
    place = attachment_point(held, built)
    body = geometry.bodies.get(place.body)
    yield place.at * MM if body is None else complex(body.track(place.at * MM)[index])


# -- load places -----------------------------------------------------------------------------------------

SYMBOLS = frozenset({"spring", "damper", "load", "torque"})
"""What the keys of the drawing's parts begin with that show a row of the loads."""
REACH = 9.0  # pixels from a row within which it is meant
CHOSEN_MARK_RADIUS = 9.0  # radius of the mark of the chosen one, pixels
BETWEEN = 6.0  # width of its line between two ends, pixels


def row_places(geometry: Geometry, path: str, index: int) -> list[complex]:
    """Where a row of the loads stands at a sample [mm]: one place, or its two ends; none where it cannot be said."""
    design = geometry.study.design
    found: list[complex] = []
    try:
        row = get(design, path)
        element = element_at(geometry.study.loading, path)
        if isinstance(element, Torsion):
            return [complex(track[index]) for track in spirals(element, geometry)]
        for hold in HOLDS[path.partition(".")[2].partition("[")[0]]:
            held = hold.read(row)
            found += [_output(geometry, index)] if held is None else list(places_now(geometry, held, index))[:1]
    except (KeyError, NoSolution):
        return []
    return found


def _output(geometry: Geometry, index: int) -> complex:
    """The point of the output that its motion moves."""
    kinematics = geometry.kinematics
    return complex(kinematics.bodies[kinematics.output].position(kinematics.driver_pair.point)[index]) * MM


def row_paths(geometry: Geometry) -> Iterator[str]:
    """The rows of the loads by their paths."""
    drive = geometry.study.design.drive
    for name in load_lists(drive):
        yield from (f"loads.{name}[{i}]" for i in range(len(getattr(drive.loads, name))))


def rows_at(canvas: Canvas, at: complex) -> list[str]:
    """The rows of the loads under a place [mm], the nearest first."""
    geometry = canvas.drawn.geometry
    if geometry is None:
        return []
    near = []
    for i, path in enumerate(row_paths(geometry)):
        places = row_places(geometry, path, canvas.drawn.index)
        if places:
            distance = abs(at - nearest_on_segment(at, places[0], places[-1])) * canvas.scale_now
            near.append((distance, i, path))
    found = [path for distance, _, path in sorted(near) if distance <= REACH]
    return list(dict.fromkeys((*found, *_drawn_at(canvas, at))))


def _drawn_at(canvas: Canvas, at: complex) -> Iterator[str]:
    """The rows whose symbols are drawn at a place [mm]; empty for the loads that have no row."""
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
    """Of the rows under the mouse the one that a further click means."""
    return rows[(rows.index(chosen) + 1) % len(rows)] if chosen in rows else rows[0]


def paint_row(canvas: Canvas, painter: QPainter, path: str) -> None:
    """Mark the chosen row; in pixels of the viewport."""
    geometry = canvas.drawn.geometry
    if geometry is None or not path:
        return
    pixels = [
        canvas.viewportTransform().map(QPointF(at.real, at.imag))
        for at in row_places(geometry, path, canvas.drawn.index)
    ]
    pale = QColor(SCREEN.chosen)
    pale.setAlpha(70)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    if len(pixels) > 1:
        painter.setPen(QPen(pale, BETWEEN, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        painter.drawLine(pixels[0], pixels[-1])
    painter.setPen(QPen(QColor(SCREEN.chosen), 1.6))
    for pixel in pixels:
        painter.drawEllipse(pixel, CHOSEN_MARK_RADIUS, CHOSEN_MARK_RADIUS)
