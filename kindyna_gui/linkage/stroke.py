"""The tool in hand: the places set with it by clicks, pulls and numbers, until it makes what it makes."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QMouseEvent

from core.design.linkage import FRAME_LINK
from kindyna_gui.linkage.draw_tools import CHOOSE, TOOLS, Drawing, DrawTool
from kindyna_gui.linkage.drawn_linkage import DrawnLinkage
from kindyna_gui.linkage.snapping import Snap, snapped

DRAG = 4.0  # pixels that the mouse goes before a press is a drag


class Stroke:
    """What is begun with the tool in hand.

    snaps    the places set
    mouse    the place under the mouse, as it is taken
    pressed  the pixel where the mouse went down
    """

    def __init__(self, drawn: DrawnLinkage) -> None:
        self.drawn = drawn
        self.tool: DrawTool = TOOLS[CHOOSE]
        self.snaps: list[Snap] = []
        self.mouse: Snap | None = None
        self.pressed: QPointF | None = None
        self._pulls = False

    @property
    def prompt(self) -> str:
        """What is to be clicked next."""
        prompts = self.tool.prompts
        return f"{self.tool.text}: {prompts[min(len(self.snaps), len(prompts) - 1)]}"

    def drop(self) -> None:
        """Nothing is begun any longer."""
        self.snaps, self.pressed, self._pulls = [], None, False

    def press(self, event: QMouseEvent) -> None:
        self.pressed = event.position()
        self.mouse = self._snap(event)
        if self.tool.clicks > 1 and not self.snaps:
            self.snaps = [self.mouse]
            self._pulls = True
        self.drawn.changed.emit()

    def move(self, event: QMouseEvent) -> None:
        self.mouse = self._snap(event)
        self.drawn.canvas.viewport().update()

    def release(self, event: QMouseEvent) -> None:
        pressed, pulls = self.pressed, self._pulls
        self.pressed, self._pulls = None, False
        if pressed is None:
            return
        if not pulls or (event.position() - pressed).manhattanLength() > DRAG:  # drawn in one pull
            self.set(self._snap(event))
        else:
            self.drawn.changed.emit()

    def _snap(self, event: QMouseEvent) -> Snap:
        design, places = self.drawn.sheet
        start = self.snaps[-1].at if self.snaps else None
        free = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        return snapped(
            design.drive.linkage,
            places,
            self.drawn.place_of(event.position()),
            self.drawn.canvas.scale_now,
            start,
            (),
            free,
            self.drawn.canvas.marks,
        )

    def set(self, snap: Snap, length_mm: float | None = None, typed: bool = False) -> bool:
        """One place more for the tool; with the last one it makes what it makes."""
        self.snaps = [*filter(self._is_there, self.snaps), snap]
        if len(self.snaps) < self.tool.clicks:
            self.drawn.changed.emit()
            return True
        return self.finish(length_mm, typed)

    def _is_there(self, snap: Snap) -> bool:
        """Whether the drawing still has what a place was set on."""
        design, places = self.drawn.sheet
        links = design.drive.linkage.by_number
        return snap.point in places if snap.point else snap.link in (None, FRAME_LINK, *links)

    def finish(self, length_mm: float | None = None, typed: bool = False) -> bool:
        """The tool makes what it makes of the places that it has."""
        snaps, make = tuple(self.snaps), self.tool.make
        if make is None or len(snaps) < min(self.tool.clicks, 2):
            return False
        design, places = self.drawn.sheet
        drawing = Drawing(design, places, snaps, length_mm, self.drawn.canvas.scale_now)
        self.snaps = []
        done = self.drawn.make(partial(make, drawing))
        if done and typed and self.tool.clicks == 1:
            self.drawn.choose()
        self.drawn.changed.emit()
        return done


__all__ = ["DRAG", "Stroke"]
