"""What is done with what is chosen on the sheet, a row each: in the menus and by keys."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtGui import QGuiApplication

from core.design import Design, get, with_rows_in_order
from core.design.linkage import FRAME_LINK
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism.drawing_edits import (
    part_of,
    with_driving_link,
    with_ground,
    with_joined,
    with_mirrored,
    with_part,
    with_split,
    with_welded,
    without,
)
from core.mechanism.drawn import DrawingTarget
from core.project import dumps, loads
from kindyna_gui.linkage.draw_tools import Made, grid_step
from kindyna_gui.linkage.drawn_linkage import DrawnLinkage
from kindyna_gui.linkage.typed_values import TypedValues

SHIFT_CELLS = 4  # by which a copy stands beside what it is of


class Deeds:
    """Deeds with what is chosen; those for which it does not do say what to choose."""

    def __init__(self, drawn: DrawnLinkage, typed: TypedValues) -> None:
        self.drawn, self.typed = drawn, typed

    def delete(self) -> None:
        """What is chosen is taken away."""
        design, _ = self.drawn.sheet
        if self.drawn.row:
            kind, _, rest = self.drawn.row.partition("[")
            rows = len(get(design, kind))
            left = [i for i in range(rows) if i != int(rest[:-1])]
            self.drawn.make(
                lambda: Made(with_rows_in_order(design, kind, left), ""), f"Delete {kind.rpartition('.')[2]} row"
            )
            return
        links = set(self.drawn.links)
        points = self.drawn.points - {n for k in links for n in design.drive.linkage.by_number[k].places}
        if not links and not points:
            self.drawn.told.emit("Nothing is chosen")
            return
        what = [*(f"link {n}" for n in sorted(links)), *sorted(points)]
        self.drawn.make(lambda: Made(without(design, points, links), f"Delete {', '.join(what)}"))

    def duplicate(self) -> None:
        """The chosen links once more, beside them."""
        self._paste_part(part_of(self.drawn.sheet[0], self.drawn.chosen_links), "Duplicate", self.drawn.chosen_links)

    def copy(self) -> None:
        """The chosen links onto the clipboard, as the text of a design."""
        if self._some_links():
            QGuiApplication.clipboard().setText(dumps(part_of(self.drawn.sheet[0], self.drawn.chosen_links)))
            self.drawn.told.emit("Copied: paste it here or in another design")

    def paste(self) -> None:
        """Links from the clipboard, beside what is there."""
        try:
            part = loads(QGuiApplication.clipboard().text(), unfinished=True)
            if not part.drive.links:
                raise KeyError
        except (KindynaError, KeyError, ValueError):
            self.drawn.told.emit("The clipboard holds no links: Ctrl+C copies those that are chosen")
            return
        self._paste_part(part, "Paste", ())

    def _paste_part(self, part: Design, what: str, chosen: Sequence[int] | set[int]) -> None:
        if what == "Duplicate" and not self._some_links():
            return
        shift = SHIFT_CELLS * grid_step(self.drawn.canvas.scale_now) * (1.0 - 1.0j)

        def made() -> Made:
            design, links = with_part(self.drawn.sheet[0], part, shift)
            return Made(design, f"{what} {_links_text(chosen or links)}", links=links)

        self.drawn.make(made)

    def mirror(self) -> None:
        """The chosen links mirrored in the upright line through their middle."""
        design, places = self.drawn.sheet
        links = self.drawn.chosen_links
        if self._some_links():
            names = {name for n in links for name in design.drive.linkage.by_number[n].places}
            x = [places[name].real for name in names]
            middle = complex(0.5 * (min(x) + max(x)), 0.0)
            self.drawn.make(lambda: with_mirrored(design, links, middle, 1j), f"Mirror {_links_text(links)}")

    def join(self) -> None:
        """The two chosen pins become one."""
        if len(self.drawn.points) != 2:
            self.drawn.told.emit("Choose two pins to be joined: click one, Shift and click the other")
            return
        one, other = sorted(self.drawn.points)
        self.drawn.make(
            lambda: Made(with_joined(self.drawn.sheet[0], one, other), f"Join {other} to {one}", points=(one,))
        )

    def split(self) -> None:
        """The chosen pin comes apart."""
        if name := self.drawn.one_point():
            self.drawn.make(lambda: with_split(self.drawn.sheet[0], name), f"Split {name}")

    def weld(self) -> None:
        """The two chosen links become one plate."""
        links = sorted(self.drawn.chosen_links)
        if len(links) != 2:
            self.drawn.told.emit("Choose two links to be welded: click one, Shift and click the other")
            return
        one, other = links
        self.drawn.make(
            lambda: Made(with_welded(self.drawn.sheet[0], one, other), f"Weld link {other} to link {one}", links=(one,))
        )

    def ground(self) -> None:
        """The chosen points are fixed to the ground; the chosen link is welded to it."""
        design, _ = self.drawn.sheet
        if self.drawn.points:
            names = sorted(self.drawn.points)

            def made() -> Design:
                changed = design
                for name in names:
                    changed = with_ground(changed, DrawingTarget(0j, name))
                return changed

            self.drawn.make(made, f"Ground {', '.join(names)}")
        elif len(self.drawn.links) == 1:
            (number,) = self.drawn.links
            self.drawn.make(lambda: Made(with_welded(design, FRAME_LINK, number), f"Fix link {number} to the ground"))
        else:
            self.drawn.told.emit("Choose a pin, or a link, to be fixed to the ground")

    def drive(self) -> None:
        """The chosen link drives."""
        if len(self.drawn.links) == 1:
            (number,) = self.drawn.links
            self.drawn.make(lambda: with_driving_link(self.drawn.sheet[0], number), f"Drive link {number}")
        else:
            self.drawn.told.emit("Choose the link that drives")

    def lock(self) -> None:
        """The chosen points and lengths cannot be dragged, or can again."""
        design, _ = self.drawn.sheet
        keys = set(self.drawn.points)
        for number in self.drawn.links:
            link = design.drive.linkage.by_number[number]
            if len(link.points) == 2:
                keys.add(":".join((str(number), *link.places)))
        if keys:
            self.drawn.locked = self.drawn.locked - keys if keys <= self.drawn.locked else self.drawn.locked | keys
            self.drawn.told.emit("Locked against dragging" if keys <= self.drawn.locked else "Free to be dragged again")
            self.drawn.changed.emit()

    def choose_all(self) -> None:
        """Everything that is drawn."""
        design, places = self.drawn.sheet
        self.drawn.choose(tuple(places), tuple(n for n in design.drive.linkage.by_number if n != FRAME_LINK))

    def _some_links(self) -> bool:
        if not self.drawn.chosen_links:
            self.drawn.told.emit("Choose links first: a click on one, or a box around them")
        return bool(self.drawn.chosen_links)


@frozen
class Deed:
    """What is done with what is chosen: a row of the menus, with its key; kinds: in whose menus it stands."""

    name: str
    text: str
    key: str
    tip: str
    do: Callable[[Deeds], None]
    kinds: tuple[str, ...]


DEEDS: tuple[Deed, ...] = (
    Deed("values", "&Type values...", "Shift+Return", "Length of a bar, coordinates of a point, values of a load",
         lambda deeds: deeds.typed.type_values(), ("point", "link", "row")),
    Deed("delete", "&Delete", "Delete", "Take away what is chosen, and what holds on to it", Deeds.delete,
         ("point", "link", "row")),
    Deed("duplicate", "D&uplicate", "Ctrl+D", "The chosen links once more, beside them", Deeds.duplicate, ("link",)),
    Deed("copy", "&Copy", "Ctrl+C", "The chosen links, for here or for another design", Deeds.copy, ("link",)),
    Deed("paste", "&Paste", "Ctrl+V", "The links that were copied", Deeds.paste, ("link", "sheet")),
    Deed("mirror", "&Mirror", "Ctrl+Shift+M", "The chosen links, in the upright line through their middle",
         Deeds.mirror, ("link",)),
    Deed("join", "&Join pins", "Ctrl+J", "Two chosen pins become one", Deeds.join, ("point",)),
    Deed("split", "&Split pin", "Ctrl+Shift+J", "Every link on the chosen pin gets a point of its own", Deeds.split,
         ("point",)),
    Deed("weld", "&Weld links", "Ctrl+W", "Two chosen links become one plate", Deeds.weld, ("link",)),
    Deed("fix", "&Fix to ground", "Ctrl+Shift+G", "The chosen pin becomes a pivot; a link becomes part of the ground",
         Deeds.ground, ("point", "link")),
    Deed("drive", "D&rive", "Ctrl+R", "The chosen link drives", Deeds.drive, ("link",)),
    Deed("lock", "&Lock", "Ctrl+Shift+L", "The chosen point, or the length of the chosen bar, cannot be dragged",
         Deeds.lock, ("point", "link")),
    Deed("rename", "R&ename...", "F2", "Another name for the chosen point", lambda deeds: deeds.typed.rename(), ("point",)),
    Deed("all", "Choose &all", "Ctrl+A", "Everything that is drawn", Deeds.choose_all, ("sheet",)),
)  # fmt: skip


def _links_text(links: Sequence[int] | set[int]) -> str:
    numbers = ", ".join(map(str, sorted(links)))
    return f"link {numbers}" if len(links) == 1 else f"links {numbers}"


__all__ = ["DEEDS", "Deeds"]
