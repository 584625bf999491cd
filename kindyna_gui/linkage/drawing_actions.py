"""Actions on the selection of a drawing, one row each: entries of the menus and keys."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtGui import QGuiApplication

from core.design import Design, get, with_rows_in_order
from core.design.linkage import FRAME_LINK
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism.drawing_edits import (
    with_driving_link,
    with_ground,
    with_joined,
    with_mirrored,
    with_split,
    with_welded,
    without,
)
from core.mechanism.drawing_references import part_of, with_part
from core.mechanism.drawing_targets import DrawingTarget
from core.project import dumps, loads
from kindyna_gui.linkage.draw_tools import DrawingEdit
from kindyna_gui.linkage.drawn_linkage import DrawnLinkage
from kindyna_gui.linkage.point_paths import PointPaths
from kindyna_gui.linkage.snapping import grid_step
from kindyna_gui.linkage.typed_values import TypedValues

SHIFT_CELLS = 4  # offset of a copy from its original, cells of the grid


class SelectionActions:
    """Edits of the selected parts; a message says what to select where an action needs another selection."""

    def __init__(self, drawn: DrawnLinkage, typed: TypedValues, paths: PointPaths) -> None:
        self.drawn, self.typed, self.paths = drawn, typed, paths

    def delete(self) -> None:
        """Delete the selected parts."""
        design, _ = self.drawn.layout
        if self.drawn.row:
            kind, _, rest = self.drawn.row.partition("[")
            rows = len(get(design, kind))
            left = [i for i in range(rows) if i != int(rest[:-1])]
            self.drawn.apply(
                lambda: DrawingEdit(with_rows_in_order(design, kind, left), ""), f"Delete {kind.rpartition('.')[2]} row"
            )
            return
        links = set(self.drawn.links)
        points = self.drawn.points - {n for k in links for n in design.drive.linkage.by_number[k].places}
        if not links and not points:
            self.drawn.message.emit("Select a link or a point first")
            return
        parts = [*(f"link {n}" for n in sorted(links)), *sorted(points)]
        self.drawn.apply(lambda: DrawingEdit(without(design, points, links), f"Delete {', '.join(parts)}"))

    def duplicate(self) -> None:
        """Insert a copy of the selected links next to them."""
        if self._has_links():
            links = self.drawn.selected_links
            self._insert(part_of(self.drawn.layout[0], links), f"Duplicate {_links_text(links)}")

    def copy(self) -> None:
        """Copy the selected links to the clipboard, as the text of a design."""
        if self._has_links():
            QGuiApplication.clipboard().setText(dumps(part_of(self.drawn.layout[0], self.drawn.selected_links)))
            self.drawn.message.emit("Copied: paste it here or in another design")

    def paste(self) -> None:
        """Insert links from the clipboard."""
        try:
            part = loads(QGuiApplication.clipboard().text(), unfinished=True)
            if not part.drive.links:
                raise KeyError
        except (KindynaError, KeyError, ValueError):
            self.drawn.message.emit("The clipboard has no links: Ctrl+C copies the selected ones")
            return
        self._insert(part, "")

    def _insert(self, part: Design, text: str) -> None:
        """Insert links of another design; without a text the step is named after their new numbers."""
        shift = SHIFT_CELLS * grid_step(self.drawn.canvas.scale_now) * (1.0 - 1.0j)

        def pasted() -> DrawingEdit:
            design, links = with_part(self.drawn.layout[0], part, shift)
            return DrawingEdit(design, text or f"Paste {_links_text(links)}", links=links)

        self.drawn.apply(pasted)

    def mirror(self) -> None:
        """Mirror the selected links in the vertical line through their middle."""
        design, positions = self.drawn.layout
        links = self.drawn.selected_links
        if self._has_links():
            names = {name for n in links for name in design.drive.linkage.by_number[n].places}
            x = [positions[name].real for name in names]
            middle = complex(0.5 * (min(x) + max(x)), 0.0)
            self.drawn.apply(lambda: with_mirrored(design, links, middle, 1j), f"Mirror {_links_text(links)}")

    def join(self) -> None:
        """Join the two selected pins into one."""
        if len(self.drawn.points) != 2:
            self.drawn.message.emit("Select two pins to join: click the first, then the second with Shift")
            return
        first, second = sorted(self.drawn.points)
        self.drawn.apply(
            lambda: DrawingEdit(
                with_joined(self.drawn.layout[0], first, second), f"Join {second} to {first}", points=(first,)
            )
        )

    def split(self) -> None:
        """Split the selected pin: every link on it gets its own point."""
        if name := self.drawn.selected_point():
            self.drawn.apply(lambda: with_split(self.drawn.layout[0], name), f"Split {name}")

    def weld(self) -> None:
        """Weld the two selected links into one plate."""
        links = sorted(self.drawn.selected_links)
        if len(links) != 2:
            self.drawn.message.emit("Select two links to weld: click the first, then the second with Shift")
            return
        first, second = links
        text = f"Weld link {second} to link {first}"
        self.drawn.apply(lambda: DrawingEdit(with_welded(self.drawn.layout[0], first, second), text, links=(first,)))

    def ground(self) -> None:
        """Fix the selected points to the ground, or weld the selected link to it."""
        design, _ = self.drawn.layout
        if self.drawn.points:
            names = sorted(self.drawn.points)

            def grounded() -> Design:
                changed = design
                for name in names:
                    changed = with_ground(changed, DrawingTarget(0j, name))
                return changed

            self.drawn.apply(grounded, f"Ground {', '.join(names)}")
        elif len(self.drawn.links) == 1:
            (number,) = self.drawn.links
            self.drawn.apply(
                lambda: DrawingEdit(with_welded(design, FRAME_LINK, number), f"Fix link {number} to the ground")
            )
        else:
            self.drawn.message.emit("Select the pin or the link to fix to the ground")

    def drive(self) -> None:
        """Make the selected link the driver."""
        if len(self.drawn.links) == 1:
            (number,) = self.drawn.links
            self.drawn.apply(lambda: with_driving_link(self.drawn.layout[0], number), f"Drive link {number}")
        else:
            self.drawn.message.emit("Select the link that is to drive")

    def lock(self) -> None:
        """Lock the selected points and lengths against dragging, or unlock them."""
        design, _ = self.drawn.layout
        keys = set(self.drawn.points)
        for number in self.drawn.links:
            link = design.drive.linkage.by_number[number]
            if len(link.points) == 2:
                keys.add(":".join((str(number), *link.places)))
        if keys:
            self.drawn.locked = self.drawn.locked - keys if keys <= self.drawn.locked else self.drawn.locked | keys
            self.drawn.message.emit(
                "Locked against dragging" if keys <= self.drawn.locked else "Unlocked: can be dragged"
            )
            self.drawn.changed.emit()

    def show_path(self) -> None:
        """Show or hide the path of the selected point."""
        if name := self.drawn.selected_point():
            self.paths.toggle(name)

    def choose_all(self) -> None:
        """Select all parts of the drawing."""
        design, positions = self.drawn.layout
        self.drawn.choose(tuple(positions), tuple(n for n in design.drive.linkage.by_number if n != FRAME_LINK))

    def _has_links(self) -> bool:
        if not self.drawn.selected_links:
            self.drawn.message.emit("Select links first: click one, or drag a box around several")
        return bool(self.drawn.selected_links)


@frozen
class DrawingAction:
    """One action: object name, menu text, key, tip, function, and the kinds of parts whose menus show it."""

    name: str
    text: str
    key: str
    tip: str
    run: Callable[[SelectionActions], None]
    kinds: tuple[str, ...]


ACTIONS: tuple[DrawingAction, ...] = (
    DrawingAction("values", "&Type values...", "Shift+Return", "Length of a bar, coordinates of a point, values of a load",
                  lambda actions: actions.typed.type_values(), ("point", "link", "row")),
    DrawingAction("delete", "&Delete", "Delete", "Delete the selected parts, with the loads attached to them",
                  SelectionActions.delete, ("point", "link", "row")),
    DrawingAction("duplicate", "D&uplicate", "Ctrl+D", "Duplicate the selected links",
                  SelectionActions.duplicate, ("link",)),
    DrawingAction("copy", "&Copy", "Ctrl+C", "Copy the selected links, for this or another design",
                  SelectionActions.copy, ("link",)),
    DrawingAction("paste", "&Paste", "Ctrl+V", "Insert the copied links",
                  SelectionActions.paste, ("link", "canvas")),
    DrawingAction("mirror", "&Mirror", "Ctrl+Shift+M", "Mirror the selected links in the vertical line through their middle",
                  SelectionActions.mirror, ("link",)),
    DrawingAction("join", "&Join pins", "Ctrl+J", "Join the two selected pins into one",
                  SelectionActions.join, ("point",)),
    DrawingAction("split", "&Split pin", "Ctrl+Shift+J", "Split the selected pin: every link on it gets its own point",
                  SelectionActions.split, ("point",)),
    DrawingAction("weld", "&Weld links", "Ctrl+W", "Weld the two selected links into one plate",
                  SelectionActions.weld, ("link",)),
    DrawingAction("fix", "&Fix to ground", "Ctrl+Shift+G",
                  "Make the selected pin a pivot, or the selected link part of the ground",
                  SelectionActions.ground, ("point", "link")),
    DrawingAction("drive", "D&rive", "Ctrl+R", "Make the selected link the driver",
                  SelectionActions.drive, ("link",)),
    DrawingAction("lock", "&Lock", "Ctrl+Shift+L",
                  "Lock the selected point, or the length of the selected bar, against dragging",
                  SelectionActions.lock, ("point", "link")),
    DrawingAction("path", "Show &path", "Ctrl+Shift+T", "Show or hide the path that the selected point traces, its coupler curve",
                  SelectionActions.show_path, ("point",)),
    DrawingAction("rename", "R&ename...", "F2", "Rename the selected point",
                  lambda actions: actions.typed.rename(), ("point",)),
    DrawingAction("all", "Choose &all", "Ctrl+A", "Select all parts",
                  SelectionActions.choose_all, ("canvas",)),
)  # fmt: skip


def _links_text(links: Sequence[int] | set[int]) -> str:
    numbers = ", ".join(map(str, sorted(links)))
    return f"link {numbers}" if len(links) == 1 else f"links {numbers}"
