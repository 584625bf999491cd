"""The linkage on the canvas: layout at the current angle, selection, mobility, and edits as undo steps."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

from PySide6.QtCore import QObject, QPointF, QRectF, Signal
from PySide6.QtWidgets import QWidget

from core.design import Design
from core.design.linkage import CRANK, FRAME_LINK
from core.errors import DesignError, KindynaError
from core.mechanism import CrankMotion, body_name
from core.mechanism.drawn import PointPositions, drawn_position, frame_link, point_positions, with_positions
from core.mechanism.unfinished import DrivenPart, Mobility, driven_part_of, mobility
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import reason
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.linkage.draw_tools import DrawingEdit
from kindyna_gui.linkage.linkage_sketch import LinkageSketch
from kindyna_gui.linkage.snapping import point_at
from kindyna_gui.player import Player


class DrawnLinkage(QObject):
    """The linkage as drawn, and the selection: points, links, or a row of the loads.

    message  (text): what an edit did, or why it is not possible
    changed  the design or the selection has changed
    """

    message = Signal(str)
    changed = Signal()

    def __init__(self, canvas: Canvas, session: Session, player: Player, owner: QWidget) -> None:
        super().__init__(owner)
        self.canvas, self.session, self.player = canvas, session, player
        self.active = False
        self.points: set[str] = set()
        self.links: set[int] = set()
        self.row = ""
        self.locked: set[str] = set()
        self._layout: tuple[object, Design, PointPositions] | None = None
        self._mobility: tuple[Design, Mobility, DrivenPart | None] | None = None
        self.lengths: dict[tuple[int, str, str], QRectF] = {}

    @property
    def layout(self) -> tuple[Design, PointPositions]:
        """The design as typed, drawn at the current angle, and the positions of its points [mm]."""
        typed = self.session.typed
        key = (typed, self.player.theta)
        if self._layout is None or self._layout[0] != key:
            self._layout = (key, *self._layout_now(typed))
        return self._layout[1], self._layout[2]

    def clear_layout(self) -> None:
        """Compute the layout again at its next use."""
        self._layout = None

    def _layout_now(self, typed: Design) -> tuple[Design, PointPositions]:
        linkage = typed.drive.linkage
        if self.session.incomplete is None:
            try:
                kinematics = self.session.at(self.player.theta).linkage
                fixed = frame_link(linkage).places
                positions = {
                    name: complex(kinematics.bodies[body_name(link.number)].position(name)[0]) * 1e3
                    for link in linkage.links
                    if link.number != FRAME_LINK
                    for name in link.places
                    if name not in fixed
                }
                return with_positions(typed, {**positions, **fixed}), {**positions, **fixed}
            except (KindynaError, KeyError):
                pass
        if linkage.drawn is not None and (driven := self._mobility_and_driven()[1]) is not None:
            try:
                driven_positions = driven.positions(self.player.theta)
                return with_positions(typed, driven_positions), driven_positions
            except KindynaError:
                pass
        return typed, point_positions(linkage)

    @property
    def sketch(self) -> LinkageSketch:
        design, positions = self.layout
        transform = self.canvas.viewportTransform()
        to = lambda at: transform.map(QPointF(at.real, at.imag))  # noqa: E731
        return LinkageSketch(design, positions, to, self.canvas.scale_now, self.lengths)

    def part_at(self, pixel: QPointF) -> tuple[str, str, int | None]:
        """Return the point, the row of the loads, or the link under a pixel, in this priority; the others are empty."""
        sketch, at = self.sketch, self.canvas.position_at(pixel)
        name = point_at(sketch.positions, at, sketch.scale)
        row = "" if name else sketch.load_at(at)
        return name, row, None if name or row else sketch.link_at(pixel)

    # -- mobility -------------------------------------------------------------------------------------------------

    @property
    def mobility(self) -> Mobility:
        """What the drawing lacks to be a mechanism."""
        return self._mobility_and_driven()[0]

    def _mobility_and_driven(self) -> tuple[Mobility, DrivenPart | None]:
        """Return the mobility of the drawing, and the part that the driver moves if the drawing is incomplete."""
        design = self.session.typed
        if design.drive.linkage.drawn is None:
            design = self.layout[0]
        if self._mobility is None or self._mobility[0] is not design:
            state = mobility(design.drive.linkage)
            self._mobility = (design, state, None if state.is_finished else driven_part_of(design, state))
        return self._mobility[1:]

    @property
    def static_links(self) -> frozenset[int]:
        """Links of an incomplete drawing that do not follow the driver; none while drawing if nothing moves."""
        state, driven = self._mobility_and_driven()
        if state.is_finished or (driven is None and self.active):
            return frozenset()
        return frozenset(self.layout[0].drive.linkage.by_number) - (frozenset(state.driven) if driven else frozenset())

    def state_text(self) -> str:
        """Text that says what the drawing lacks to be a mechanism, and what to do."""
        design, positions = self.layout
        if not positions:
            return "The canvas is empty: set a fixed pivot with Ground, or draw a bar"
        if len(design.drive.links) < 2:
            return "Draw a bar from a pivot"
        return "; ".join(self.mobility.sentences) or "1 degree of freedom, set by the driver: the linkage moves"

    # -- selection ------------------------------------------------------------------------------------------------

    def choose(self, points: Sequence[str] = (), links: Sequence[int] = (), row: str = "") -> None:
        """Select these, as far as the design has them."""
        link_points = {link.number: link.places for link in self.session.typed.drive.links}
        self.points = {name for name in points if any(name in names for names in link_points.values())}
        self.links = {n for n in links if n in link_points}
        self.row = row if row and row in self.sketch.load_positions() else ""
        self.changed.emit()

    @property
    def selected_links(self) -> set[int]:
        """The selected links, and the links all of whose points are selected."""
        return self.links | links_within(self.layout[0], self.points)

    def selected_point(self) -> str:
        """Return the selected point; empty, with a message, unless exactly one is selected."""
        if len(self.points) == 1:
            return next(iter(self.points))
        self.message.emit("Select one pin")
        return ""

    # -- one action, one undo step --------------------------------------------------------------------------------

    def apply(self, edit: Callable[[], DrawingEdit | Design], text: str = "", path: str = "") -> bool:
        """Apply an edit as one undo step; if it is not possible, say why and return False."""
        try:
            result = edit()
        except KindynaError as error:
            self.message.emit(refusal_text(self.layout[0], error))
            return False
        if not isinstance(result, DrawingEdit):
            result = DrawingEdit(result, text, tuple(self.points), tuple(self.links), self.row)
        if not path:
            self.session.end_gesture()
        if not self.session.lay_out(result.design, result.text or text, path):
            return False
        if not path:
            self.session.end_gesture()
            self.message.emit(result.text or text)
        self.choose(result.points, result.links, result.row)
        if (theta := self._drawn_theta(result.design)) is not None:
            self.player.set_theta(theta)
        return True

    def _drawn_theta(self, design: Design) -> float | None:
        """Angle of the crank as drawn [rad]; None for a driver that follows a motion."""
        drawn = design.drive.linkage.drawn
        if drawn is None or design.drive.linkage.driver.kind != CRANK or drawn.driver_deg is None:
            return None
        if self.session.incomplete is None and not self.session.is_incomplete_linkage:
            try:
                return CrankMotion(self.session.study.driver_ranges).theta(drawn_position(drawn))
            except KindynaError:
                return None
        driven = self._mobility_and_driven()[1]
        return None if driven is None else driven.drawn_theta


def links_within(design: Design, points: Collection[str]) -> set[int]:
    """Numbers of the moving links all of whose points are in ``points``."""
    return {
        link.number
        for link in design.drive.linkage.links
        if link.number != FRAME_LINK and link.places and set(link.places) <= set(points)
    }


def refusal_text(design: Design, error: KindynaError) -> str:
    """Return the reason why something cannot be drawn, in a sentence."""
    if isinstance(error, DesignError):
        fault = error.faults[0]
        return f"{fault.problem}: {fault.allowed}"
    return reason(design, error)
