"""A linkage as it is drawn: the sheet as it stands, what is chosen on it, what it lacks, and edits of it, each one step."""

from __future__ import annotations

from collections.abc import Callable, Sequence

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
from kindyna_gui.linkage.draw_tools import Made
from kindyna_gui.linkage.sketch_picture import SketchPicture
from kindyna_gui.player import Player


class DrawnLinkage(QObject):
    """The design's linkage as it is drawn, and what of it is chosen: points, links, or a row of the loads.

    told     (text): what has been done, or why it cannot be
    changed  another design, or something else is chosen
    """

    told = Signal(str)
    changed = Signal()

    def __init__(self, canvas: Canvas, session: Session, player: Player, owner: QWidget) -> None:
        super().__init__(owner)
        self.canvas, self.session, self.player = canvas, session, player
        self.active = False
        self.points: set[str] = set()
        self.links: set[int] = set()
        self.row = ""
        self.locked: set[str] = set()
        self._sheet: tuple[object, Design, PointPositions] | None = None
        self._lack: tuple[Design, Mobility, DrivenPart | None] | None = None
        self.lengths: dict[tuple[int, str, str], QRectF] = {}

    @property
    def sheet(self) -> tuple[Design, PointPositions]:
        """The design as typed, drawn as it stands now, and where its points are."""
        typed = self.session.typed
        key = (typed, self.player.theta)
        if self._sheet is None or self._sheet[0] != key:
            self._sheet = (key, *self._as_it_stands(typed))
        return self._sheet[1], self._sheet[2]

    def forget_sheet(self) -> None:
        """The sheet is laid out anew when it is next asked for."""
        self._sheet = None

    def _as_it_stands(self, typed: Design) -> tuple[Design, PointPositions]:
        linkage = typed.drive.linkage
        if self.session.incomplete is None:
            try:
                kinematics = self.session.at(self.player.theta).linkage
                fixed = frame_link(linkage).places
                places = {
                    name: complex(kinematics.bodies[body_name(link.number)].position(name)[0]) * 1e3
                    for link in linkage.links
                    if link.number != FRAME_LINK
                    for name in link.places
                    if name not in fixed
                }
                return with_positions(typed, {**places, **fixed}), {**places, **fixed}
            except (KindynaError, KeyError):
                pass
        if linkage.drawn is not None and (led := self._lacking()[1]) is not None:
            try:
                moved = led.positions(self.player.theta)
                return with_positions(typed, moved), moved
            except KindynaError:
                pass
        return typed, point_positions(linkage)

    @property
    def picture(self) -> SketchPicture:
        design, places = self.sheet
        transform = self.canvas.viewportTransform()
        to = lambda at: transform.map(QPointF(at.real, at.imag))  # noqa: E731
        return SketchPicture(design, places, to, self.canvas.scale_now, self.lengths)

    def place_of(self, pixel: QPointF) -> complex:
        """The place on the sheet [mm] at a pixel."""
        inverse, _ = self.canvas.viewportTransform().inverted()
        at = inverse.map(pixel)
        return complex(at.x(), at.y())

    # -- what it lacks --------------------------------------------------------------------------------------------

    @property
    def lack(self) -> Mobility:
        """What the drawing lacks to be a mechanism."""
        return self._lacking()[0]

    def _lacking(self) -> tuple[Mobility, DrivenPart | None]:
        """The same, and what the driver moves although it lacks something."""
        design = self.session.typed
        if design.drive.linkage.drawn is None:
            design = self.sheet[0]
        if self._lack is None or self._lack[0] is not design:
            lack = mobility(design.drive.linkage)
            self._lack = (design, lack, None if lack.is_finished else driven_part_of(design, lack))
        return self._lack[1:]

    @property
    def still(self) -> frozenset[int]:
        """The links that do not move with the driver, where others do; all while nothing is drawn and nothing moves."""
        lack, led = self._lacking()
        if lack.is_finished or (led is None and self.active):
            return frozenset()
        return frozenset(self.sheet[0].drive.linkage.by_number) - (frozenset(lack.driven) if led else frozenset())

    def state_text(self) -> str:
        """What the drawing lacks to be a mechanism, and what to do."""
        design, places = self.sheet
        if not places:
            return "An empty sheet: set a fixed pivot with Ground, or draw a bar"
        if len(design.drive.links) < 2:
            return "Draw a bar from a pivot"
        return "; ".join(self.lack.sentences) or "1 degree of freedom, which the driver leads: it moves"

    # -- what is chosen -------------------------------------------------------------------------------------------

    def choose(self, points: Sequence[str] = (), links: Sequence[int] = (), row: str = "") -> None:
        """These are chosen, as far as they are there."""
        there = {link.number: link.places for link in self.session.typed.drive.links}
        self.points = {name for name in points if any(name in own for own in there.values())}
        self.links = {n for n in links if n in there}
        self.row = row if row and row in self.picture.load_places() else ""
        self.changed.emit()

    @property
    def chosen_links(self) -> set[int]:
        """The links chosen; where points alone are, those that they make up whole."""
        design, _ = self.sheet
        whole = {
            link.number
            for link in design.drive.linkage.links
            if link.number != FRAME_LINK and link.places and set(link.places) <= self.points
        }
        return self.links | whole

    def one_point(self) -> str:
        """The point, where one alone is chosen; else empty, which is told."""
        if len(self.points) == 1:
            return next(iter(self.points))
        self.told.emit("Choose one pin")
        return ""

    # -- one action, one step -------------------------------------------------------------------------------------

    def make(self, make: Callable[[], Made | Design], text: str = "", path: str = "") -> bool:
        """Put what an edit makes in place as one step; where it cannot be made, say why."""
        try:
            made = make()
        except KindynaError as error:
            self.told.emit(why(self.sheet[0], error))
            return False
        made = made if isinstance(made, Made) else Made(made, text, tuple(self.points), tuple(self.links), self.row)
        if not path:
            self.session.end_gesture()
        if not self.session.lay_out(made.design, made.text or text, path):
            return False
        if not path:
            self.session.end_gesture()
            self.told.emit(made.text or text)
        self.choose(made.points, made.links, made.row)
        if (theta := self._drawn_theta(made.design)) is not None:
            self.player.set_theta(theta)
        return True

    def _drawn_theta(self, design: Design) -> float | None:
        """The angle at which a crank stands as it is drawn; None of one that follows a motion."""
        drawn = design.drive.linkage.drawn
        if drawn is None or design.drive.linkage.driver.kind != CRANK or drawn.driver_deg is None:
            return None
        if self.session.incomplete is None and not self.session.is_incomplete_linkage:
            try:
                return CrankMotion(self.session.study.driver_ranges).theta(drawn_position(drawn))
            except KindynaError:
                return None
        led = self._lacking()[1]
        return None if led is None else led.drawn_theta


def why(design: Design, error: KindynaError) -> str:
    """Why something cannot be drawn, in a sentence."""
    if isinstance(error, DesignError):
        fault = error.faults[0]
        return f"{fault.problem}: {fault.allowed}"
    return reason(design, error)


__all__ = ["DrawnLinkage", "why"]
