"""Values typed while drawing."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QLineEdit, QWidget

from core.design import NO_UNIT, UNITS, Design, SecondDriver, Unit, edited, put, with_drive
from core.design.linkage import FRAME_LINK, GEAR, RACK, WHEELS
from core.design.topology import input_slides
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism.drawing_edits import with_length, with_moved, with_name
from core.mechanism.drawn import assembled, point_positions, with_input_values, with_positions
from core.output.lines import shortest
from kindyna_gui.forms.number_box import parsed
from kindyna_gui.linkage.choosing import Stroke
from kindyna_gui.linkage.draw_tools import Made, Snap
from kindyna_gui.linkage.drawn_linkage import DrawnLinkage, why
from kindyna_gui.pictures.style import SCREEN

# -- typed boxes -----------------------------------------------------------------------------------------

Typed = float | str | None
Taken = Callable[[Sequence[Typed]], str]
"""Called with what stands in the boxes, None where nothing does; answers why that cannot be, or with nothing."""

BESIDE = QPoint(16, 12)  # pixels from the mouse


@frozen
class Box:
    """One box: its label, the unit of its number, or None where it takes a text; and what stands in it at first."""

    label: str
    unit: Unit | None
    text: str = ""


class TypedBoxes(QFrame):
    """Tab goes from box to box, Enter takes what stands there, Esc leaves all as it is."""

    def __init__(self, parent: QWidget, drawing: QWidget) -> None:
        super().__init__(parent)
        self._sheet, self._drawing = parent, drawing
        self.setObjectName("typed boxes")
        self.setAutoFillBackground(True)
        self.setStyleSheet(f"#typed\\ boxes {{ background: {SCREEN.paper}; border: 1px solid {SCREEN.line}; }}")
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(5, 3, 5, 3)
        self._row.setSpacing(4)
        self._boxes: list[tuple[Box, QLineEdit]] = []
        self._taken: Taken | None = None
        self.hide()

    @property
    def open(self) -> bool:
        return self._taken is not None

    def ask(self, at: QPoint, boxes: Sequence[Box], taken: Taken, typed: str = "", first: int = 0) -> None:
        """Open at a pixel of the parent; typed: the first character, which opened it."""
        self.close_all()
        self._taken = taken
        for box in boxes:
            edit = QLineEdit(box.text)
            edit.setAccessibleName(box.label)
            edit.setFixedWidth(74 if box.unit is not None else 110)
            self._row.addWidget(QLabel(f"{box.label}"))
            self._row.addWidget(edit)
            if box.unit is not None and box.unit.symbol:
                self._row.addWidget(QLabel(box.unit.symbol))
            self._boxes.append((box, edit))
        self.adjustSize()
        room = self._sheet.rect().adjusted(2, 2, -2 - self.width(), -2 - self.height())
        place = at + BESIDE
        self.move(max(room.left(), min(place.x(), room.right())), max(room.top(), min(place.y(), room.bottom())))
        self.show()
        self.raise_()
        edit = self._boxes[first][1]
        edit.setFocus()
        edit.selectAll()
        if typed:
            edit.setText(typed)
            edit.end(False)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.take()
        elif event.key() == Qt.Key.Key_Escape:
            self.close_all()
        # nothing goes on to the drawing behind

    def focusNextPrevChild(self, next: bool) -> bool:
        edits = [edit for _, edit in self._boxes]
        at = next_index(edits, next)
        if at is None:
            return super().focusNextPrevChild(next)
        edits[at].setFocus(Qt.FocusReason.TabFocusReason)
        edits[at].selectAll()
        return True

    def take(self) -> None:
        """What stands in the boxes is meant; one that is no number is framed red, and all stay open."""
        values: list[Typed] = []
        wrong = False
        for box, edit in self._boxes:
            text = edit.text().strip()
            value: Typed = text
            if box.unit is not None:
                value = parsed(text, box.unit) if text else None
            bad = box.unit is not None and bool(text) and value is None
            edit.setStyleSheet(f"border: 1px solid {SCREEN.limit};" if bad else "")
            edit.setToolTip("A number, with a unit if you like: 12.5, 3*12, 1 in" if bad else "")
            wrong = wrong or bad
            values.append(value)
        if wrong or self._taken is None:
            return
        taken = self._taken
        if why := taken(values):
            for _, edit in self._boxes:
                edit.setToolTip(why)
            self._boxes[0][1].setStyleSheet(f"border: 1px solid {SCREEN.limit};")
        elif self._taken is taken:
            self.close_all()

    def close_all(self) -> None:
        """Nothing is typed any longer."""
        self._taken = None
        self._boxes.clear()
        had = self.isAncestorOf(self.window().focusWidget()) if self.window().focusWidget() is not None else False
        self.hide()
        while (item := self._row.takeAt(0)) is not None:
            widget = item.widget()
            if widget is not None:
                widget.hide()
                widget.deleteLater()
        if had:
            self._drawing.setFocus()


def next_index(edits: Sequence[QLineEdit], forward: bool) -> int | None:
    """Which box comes after the one that has the focus; None where none has it."""
    now = next((i for i, edit in enumerate(edits) if edit.hasFocus()), None)
    return None if now is None else (now + (1 if forward else -1)) % len(edits)


# -- typed values ----------------------------------------------------------------------------------------

MM, DEG, KG, KG_M2, N = UNITS["mm"], UNITS["deg"], UNITS["kg"], UNITS["kg_m2"], UNITS["n"]
RATE = UNITS["n_per_mm"]

ROW_BOXES: Mapping[str, tuple[tuple[str, str, Any], ...]] = MappingProxyType(
    {
        "masses": (
            ("mass", "mass_kg", KG),
            ("inertia", "inertia_kg_m2", KG_M2),
            ("x", "centre_x_mm", MM),
            ("y", "centre_y_mm", MM),
        ),
        "forces": (("x", "x_n", N), ("y", "y_n", N)),
        "springs": (("rate", "rate_n_per_mm", RATE), ("free length", "free_length_mm", MM)),
        "drivers": (
            ("ratio", "ratio", NO_UNIT),
            ("offset", "offset_deg", DEG),
            ("wheels", "first", NO_UNIT),
            (":", "second", NO_UNIT),
            ("module", "module_mm", MM),
            ("kind", "kind", None),
        ),
    }
)
"""List of the loads, or of second inputs (their wheels are teeth where a module is typed, else radii) ->
label, field and unit of what is typed once a row of it is chosen."""
RACK_OFFSET = ("offset", "offset_mm", MM)
"""Of a second input that slides."""


class TypedValues:
    """Opens the boxes at the mouse, and does what is typed there. at: the pixel of the mouse."""

    def __init__(self, drawn: DrawnLinkage, stroke: Stroke) -> None:
        self.drawn, self.stroke = drawn, stroke
        self.boxes = TypedBoxes(drawn.canvas.viewport(), drawn.canvas)
        self.at = QPoint()

    def type_first(self, text: str) -> None:
        """A digit opens the boxes of what can be typed now."""
        if self.stroke.snaps and self.stroke.tool.clicks > 1:
            self.boxes.ask(self.at, (Box("length", MM), Box("angle", DEG)), self._take_line, text)
        elif wanted := self._boxes_of_chosen():
            boxes, taken = wanted
            self.boxes.ask(self.at, boxes, taken, text)
        elif self.stroke.tool.clicks:
            self.boxes.ask(self.at, (Box("x", MM), Box("y", MM)), self._take_place, text)

    def _take_line(self, values: Sequence[Typed]) -> str:
        """Length and angle of a line from the last place; where one is not typed it is the mouse's."""
        if not self.stroke.snaps:
            return ""
        start = self.stroke.snaps[-1].at
        mouse = self.stroke.mouse or Snap(start + 1.0)
        way = mouse.at - start
        length = values[0] if isinstance(values[0], float) else abs(way)
        turned = values[1] if isinstance(values[1], float) else math.degrees(cmath.phase(way))
        if not length > 0.0:
            return "a length above 0"
        exact = values[0] if isinstance(values[0], float) else None
        straight = {0.0: 1.0 + 0j, 90.0: 1j, 180.0: -1.0 + 0j, -90.0: -1j, 270.0: -1j}
        end = start + length * straight.get(turned, cmath.exp(1j * math.radians(turned)))
        self.boxes.close_all()
        snap = Snap(end)
        if mouse.point and values[1] is None:  # the pin under the mouse, at this length from here
            snap = mouse
        else:
            _, places = self.drawn.sheet
            near = next((name for name, at in places.items() if abs(at - end) < 1e-6), "")
            snap = Snap(places[near], point=near) if near else snap
        self.stroke.set(snap, exact if self.stroke.tool.name == "bar" else None, typed=True)
        return ""

    def _take_place(self, values: Sequence[Typed]) -> str:
        x, y = (value if isinstance(value, float) else 0.0 for value in values)
        _, places = self.drawn.sheet
        near = next((name for name, at in places.items() if abs(at - complex(x, y)) < 1e-6), "")
        self.boxes.close_all()
        self.stroke.set(Snap(complex(x, y), point=near), typed=True)
        return ""

    def type_values(self) -> None:
        """Type the values of what is chosen."""
        wanted = self._boxes_of_chosen()
        if wanted is None:
            self.drawn.told.emit("Choose a point, a bar or a load whose values are to be typed")
        else:
            self.boxes.ask(self.at, *wanted)

    def _boxes_of_chosen(self) -> tuple[tuple[Box, ...], Callable[[Sequence[Typed]], str]] | None:
        """What can be typed of what is chosen: values of a load, coordinates of a point, length of a bar."""
        linkage = self.drawn.sheet[0].drive.linkage
        if self.drawn.row:
            kind = self.drawn.row.partition("[")[0].rpartition(".")[2]
            fields = ROW_BOXES.get(kind, ())
            if kind == "drivers" and input_slides(
                linkage, linkage.drivers[int(self.drawn.row[len("linkage.drivers[") : -1])]
            ):
                fields = tuple(
                    RACK_OFFSET if name == "offset_deg" else (label, name, unit) for label, name, unit in fields
                )
            return tuple(Box(label, unit) for label, _, unit in fields), partial(self._take_row, self.drawn.row, fields)
        if len(self.drawn.points) == 1 and not self.drawn.links:
            (name,) = self.drawn.points
            return (Box("x", MM), Box("y", MM)), partial(self._take_point, name)
        if (
            len(self.drawn.links) == 1
            and len(linkage.by_number[min(self.drawn.links)].points) == 2
            and not self.drawn.points
        ):
            link = linkage.by_number[min(self.drawn.links)]
            return (Box("length", MM),), partial(self._take_length, link.number, *link.places)
        return None

    def _take_row(self, row: str, fields: Sequence[tuple[str, str, Any]], values: Sequence[Typed]) -> str:
        if row.startswith("linkage.drivers"):
            return self._take_input(int(row[row.index("[") + 1 : -1]), values)

        def made() -> Design:
            design, _ = self.drawn.sheet
            for (_, name, _), value in zip(fields, values, strict=True):
                if isinstance(value, float):
                    design = put(design, f"{row}.{name}", value)
            return design

        kind = row.partition("[")[0].rpartition(".")[2]
        self.boxes.close_all()
        self.drawn.make(made, f"Set {({'masses': 'mass', 'forces': 'force', 'springs': 'spring'})[kind]}")
        return ""

    def _take_input(self, index: int, values: Sequence[Typed]) -> str:
        """Ratio, offset and wheels of a second input: wheels typed without a ratio say it, a ratio without wheels does away with them."""
        design, _ = self.drawn.sheet
        old = design.drive.linkage.drivers[index]
        ratio, offset, first, second, module = (value if isinstance(value, float) else None for value in values[:5])
        kind = str(values[5] or "").strip().lower() or None
        if kind is not None and kind not in WHEELS:
            return " | ".join(WHEELS)
        if (first is None) != (second is None):
            return "both wheels, or none"
        row = replace(old, kind=kind or old.kind)
        if ratio is not None or first is not None:
            row = SecondDriver(
                link=old.link, on=old.on, ratio=ratio, offset_deg=old.offset_deg, offset_mm=old.offset_mm, kind=kind
            )
        if first is not None and second is not None:
            if min(first, second) < 0.0 or not max(first, second):
                return "wheels above 0, of a rack 0"
            kind = kind or (GEAR if min(first, second) else RACK)
            if module is None:
                row = replace(row, radius_first_mm=first, radius_second_mm=second, kind=kind)
            elif first % 1.0 or second % 1.0:
                return "whole numbers of teeth"
            else:
                row = replace(row, teeth_first=int(first), teeth_second=int(second), module_mm=module, kind=kind)
        self.boxes.close_all()
        self.drawn.make(lambda: with_input_values(design, index, row, offset), f"Set second input of link {old.link}")
        return ""

    def _take_point(self, name: str, values: Sequence[Typed]) -> str:
        """Coordinates in the frame of the one link that has the point; of a pin on the sheet."""
        design, places = self.drawn.sheet
        linkage = design.drive.linkage
        having = [link for link in linkage.links if name in link.places]
        local = having[0].places[name] if len(having) == 1 else places[name]
        x, y = (
            value if isinstance(value, float) else old
            for value, old in zip(values, (local.real, local.imag), strict=True)
        )
        text = f"Put {name} at {shortest(x)}, {shortest(y)} mm"
        self.boxes.close_all()
        if len(having) == 1 and having[0].number != FRAME_LINK:
            at = linkage.links.index(having[0])

            def made() -> Design:
                moved = edited(design, f"linkage.links[{at}].points.{name}", (x, y))
                return with_positions(moved, point_positions(_undrawn(moved, name).drive.linkage))

            self.drawn.make(made, text)
        else:
            self.drawn.make(lambda: with_moved(design, {name: complex(x, y)}), text)
        return ""

    def ask_length(self, number: int, one: str, other: str) -> None:
        """Type another length of a link at its number in the drawing."""
        design, _ = self.drawn.sheet
        places = design.drive.linkage.by_number[number].places
        value = shortest(abs(places[other] - places[one]))
        rect = self.drawn.lengths.get((number, one, other))
        at = rect.center().toPoint() if rect is not None else self.at
        self.boxes.ask(at, (Box(f"{one}-{other}", MM, value),), partial(self._take_length, number, one, other))

    def _take_length(self, number: int, one: str, other: str, values: Sequence[Typed]) -> str:
        (value,) = values
        self.boxes.close_all()
        if isinstance(value, float):
            design, _ = self.drawn.sheet
            text = f"Make {one}-{other} {shortest(value)} mm long"
            self.drawn.make(lambda: assembled(with_length(design, number, one, other, value)), text)
        return ""

    def rename(self) -> None:
        """Another name for the chosen point."""
        if name := self.drawn.one_point():
            at = self.drawn.picture.to(self.drawn.sheet[1][name]).toPoint()

            def taken(values: Sequence[Typed]) -> str:
                new = str(values[0] or "")
                try:
                    made = with_name(self.drawn.sheet[0], name, new)
                except KindynaError as error:
                    return why(self.drawn.sheet[0], error)
                self.boxes.close_all()
                self.drawn.make(lambda: Made(made, f"Rename {name} to {new}", points=(new,)))
                return ""

            self.boxes.ask(at, (Box("name", None, name),), taken)


def _undrawn(design: Design, name: str) -> Design:
    """The design without the place of one point, which then follows from its link."""
    linkage = design.drive.linkage
    assert linkage.drawn is not None
    points = tuple(p for p in linkage.drawn.points if p.name != name)
    return with_drive(design, mechanism=replace(linkage, drawn=replace(linkage.drawn, points=points)))
