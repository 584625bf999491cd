"""Choosing on the sheet with the mouse, by clicks and boxes, and moving ."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QMouseEvent

from core.design import Design, put
from core.design.linkage import FRAME_LINK
from core.errors import DesignError, Fault
from core.mechanism.drawing_edits import with_moved
from core.mechanism.drawn import PointPositions, link_pose
from kindyna_gui.linkage.draw_tools import CHOOSE, TOOLS, Drawing, DrawTool, Snap, grid_step, point_at, snapped
from kindyna_gui.linkage.drawn_linkage import DrawnLinkage

# -- stroke ----------------------------------------------------------------------------------------------

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


# -- choosing --------------------------------------------------------------------------------------------

LOCK_OFF = "Lock takes the lock away"


class Choosing:
    """The mouse while no tool is in hand. length_asked is called with the link and the two points of a length that is clicked."""

    def __init__(self, drawn: DrawnLinkage, length_asked: Callable[[int, str, str], None]) -> None:
        self.drawn, self._length_asked = drawn, length_asked
        self.pressed: QPointF | None = None
        self._drags = ""  # "", "move", "row", "length", "box"
        self._pixel = QPointF()
        self._grabbed = 0j
        self._moved_from: tuple[Design, PointPositions] | None = None
        self._before: tuple[object, float] = None, 0.0  # the session's work and the angle before anything was moved

    @property
    def box(self) -> QRectF | None:
        """The box that is pulled open, in pixels."""
        return None if self._drags != "box" or self.pressed is None else QRectF(self.pressed, self._pixel).normalized()

    def drop(self) -> None:
        """Nothing is held any longer."""
        self.pressed, self._drags, self._moved_from = None, "", None

    def take_back(self) -> bool:
        """What the mouse drags goes back where it was, and is held no longer; False where it drags nothing."""
        if self.pressed is None:
            return False
        moved = self._moved_from is not None
        self.drop()
        if moved:
            work, theta = self._before
            self.drawn.session.end_field_drag("linkage", work)
            self.drawn.player.set_theta(theta)
        self.drawn.changed.emit()
        return True

    def press(self, event: QMouseEvent) -> None:
        picture, pixel = self.drawn.picture, event.position()
        self.pressed = self._pixel = pixel
        at = self.drawn.place_of(pixel)
        self._grabbed, self._moved_from = at, None
        more = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        if not more and (length := picture.length_at(pixel)):
            self._drags = "length"
            self.drawn.choose(links=(length[0],))
            return
        name = point_at(picture.places, at, picture.scale)
        row = "" if name else picture.load_at(at)
        link = None if name or row else picture.link_at(pixel)
        if not (name or row or link):
            self._drags = "box"
            if not more:
                self.drawn.choose()
            return
        self._drags = "row" if row else "move"
        if more:
            self.drawn.choose(
                tuple(self.drawn.points ^ {name} if name else self.drawn.points),
                tuple(self.drawn.links ^ {link} if link else self.drawn.links),
                row,
            )
        elif not (name in self.drawn.points or link in self.drawn.links):
            self.drawn.choose((name,) if name else (), (link,) if link else (), row)

    def move(self, event: QMouseEvent) -> None:
        self._pixel = event.position()
        if self.pressed is None or self._drags in ("", "length"):
            return
        if self._drags == "box":
            self.drawn.canvas.viewport().update()
            return
        if self._moved_from is None:
            if (event.position() - self.pressed).manhattanLength() <= DRAG:
                return
            self._moved_from = self.drawn.sheet
            self._before = self.drawn.session.work, self.drawn.player.theta
            self.drawn.session.begin_drag(self.drawn.canvas)
        design, places = self._moved_from
        if self._drags == "row":
            self._drag_row(design, places, event)
            return
        names = self._moving(design)
        loose = names - self.drawn.locked
        if not loose:
            self.drawn.told.emit(f"Locked: {LOCK_OFF}")
            return
        at, every = self.drawn.place_of(event.position()), tuple(places)
        free = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        first = next(iter(sorted(loose)))
        lead = places[first] if len(loose) == 1 else self._grabbed
        canvas = self.drawn.canvas
        snap = snapped(design.drive.linkage, places, at, canvas.scale_now, None, every, free, canvas.marks)
        way = (
            snap.at if len(loose) == 1 else _rounded(at - self._grabbed, self.drawn.canvas.scale_now, free) + lead
        ) - lead
        to = {name: places[name] + way for name in loose}
        text = f"Move {', '.join(sorted(loose))}"
        path = f"linkage.drawn.{first}"
        self.drawn.make(partial(self._moved, design, to), text, path)

    def release(self, event: QMouseEvent) -> None:
        pressed, drags = self.pressed, self._drags
        self.pressed, self._drags = None, ""
        if pressed is None:
            return
        far = (event.position() - pressed).manhattanLength() > DRAG
        if self._moved_from is not None:
            self._moved_from = None
            self.drawn.session.end_drag()
        if drags == "length" and not far:
            length = self.drawn.picture.length_at(event.position())
            if length is not None:
                self._length_asked(*length)
        elif drags == "box" and far:
            self._choose_in(QRectF(self.drawn.picture.to(self._grabbed), event.position()).normalized())
        self.drawn.changed.emit()

    def _choose_in(self, box: QRectF) -> None:
        picture = self.drawn.picture
        points = {name for name, at in picture.places.items() if box.contains(picture.to(at))}
        whole = {
            link.number
            for link in picture.design.drive.linkage.links
            if link.number != FRAME_LINK and link.places and set(link.places) <= points
        }
        self.drawn.choose(tuple(self.drawn.points | points), tuple(self.drawn.links | whole))

    def _moving(self, design: Design) -> set[str]:
        linkage = design.drive.linkage
        return self.drawn.points | {name for n in self.drawn.links for name in linkage.by_number[n].places}

    def _moved(self, design: Design, to: PointPositions) -> Design:
        made = with_moved(design, to)
        for lock in (lock for lock in self.drawn.locked if ":" in lock):
            number, one, other = lock.split(":")
            before, after = (d.drive.linkage.by_number.get(int(number)) for d in (design, made))
            if before is None or after is None or not {one, other} <= set(before.places):
                continue
            old, new = (abs(each.places[one] - each.places[other]) for each in (before, after))
            if abs(old - new) > 1e-9:
                raise DesignError([Fault("linkage", lock, f"{one}-{other} is locked", LOCK_OFF)])
        return made

    def _drag_row(self, design: Design, places: PointPositions, event: QMouseEvent) -> None:
        """A centre of mass is moved on its link."""
        if not self.drawn.row.startswith("loads.masses"):
            return
        mass = design.drive.loads.masses[int(self.drawn.row[self.drawn.row.index("[") + 1 : -1])]
        at = snapped(
            design.drive.linkage, places, self.drawn.place_of(event.position()), self.drawn.canvas.scale_now
        ).at
        origin, axis = link_pose(design.drive.linkage, mass.link, places)
        local = (at - origin) * axis.conjugate()
        centre = (round(local.real, 3) + 0.0, round(local.imag, 3) + 0.0)
        self.drawn.make(
            lambda: put(design, f"{self.drawn.row}.centre", centre),
            f"Move centre of mass of link {mass.link}",
            f"{self.drawn.row}.centre_x_mm",
        )


def _rounded(way: complex, scale: float, free: bool) -> complex:
    """A move of several points by whole cells of the grid."""
    step = grid_step(scale)
    return way if free else complex(round(way.real / step) * step, round(way.imag / step) * step)
