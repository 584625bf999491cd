"""Values typed while drawing: input boxes at the mouse, and the edits that their values make."""

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

from core.design import NO_UNIT, UNITS, Design, SecondDriver, Unit, put
from core.design.linkage import FRAME_LINK, GEAR, RACK, WHEELS
from core.design.topology import input_slides
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism.drawing_edits import with_length, with_local_point, with_moved, with_name
from core.mechanism.drawn import assembled, with_input_values
from core.output.lines import shortest
from kindyna_gui.forms.number_box import parsed
from kindyna_gui.linkage.draw_tools import DrawingEdit, Snap, row_index, snap_at
from kindyna_gui.linkage.drawing_mouse import ToolInput
from kindyna_gui.linkage.drawn_linkage import DrawnLinkage, refusal_text
from kindyna_gui.look import described
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import fill

Typed = float | str | None
"""Value of an input box; None if the box is empty."""
AcceptFunction = Callable[[Sequence[Typed]], str]
"""Called with the values of the boxes; returns why they are not valid, or an empty text."""

BOX_OFFSET = QPoint(16, 12)  # from the mouse, pixels
MM, DEG, KG, KG_M2, N = UNITS["mm"], UNITS["deg"], UNITS["kg"], UNITS["kg_m2"], UNITS["n"]
RATE = UNITS["n_per_mm"]

# -- input boxes -----------------------------------------------------------------------------------------


@frozen
class Box:
    """One input box: label, unit of its number (None for a text), initial text."""

    label: str
    unit: Unit | None
    text: str = ""


class TypedBoxes(QFrame):
    """Input boxes at the mouse: Tab moves between them, Enter accepts the values, Esc cancels."""

    def __init__(self, parent: QWidget, drawing: QWidget) -> None:
        super().__init__(parent)
        self._area, self._drawing = parent, drawing
        self.setObjectName("typed boxes")
        self.setAutoFillBackground(True)
        self.setStyleSheet(f"#typed\\ boxes {{ background: {SCREEN.paper}; border: 1px solid {SCREEN.line}; }}")
        self._row = fill(QHBoxLayout(self), margins=(5, 3, 5, 3), spacing=4)
        self._boxes: list[tuple[Box, QLineEdit]] = []
        self._accept: AcceptFunction | None = None
        self.hide()

    @property
    def open(self) -> bool:
        """Whether boxes are open."""
        return self._accept is not None

    def ask(self, at: QPoint, boxes: Sequence[Box], accept: AcceptFunction, typed: str = "", first: int = 0) -> None:
        """Open boxes at a pixel of the parent; ``typed`` is the character that opened them."""
        self.close_all()
        self._accept = accept
        for box in boxes:
            edit = described(QLineEdit(box.text), name=box.label)
            edit.setFixedWidth(74 if box.unit is not None else 110)
            self._row.addWidget(QLabel(f"{box.label}"))
            self._row.addWidget(edit)
            if box.unit is not None and box.unit.symbol:
                self._row.addWidget(QLabel(box.unit.symbol))
            self._boxes.append((box, edit))
        self.adjustSize()
        room = self._area.rect().adjusted(2, 2, -2 - self.width(), -2 - self.height())
        position = at + BOX_OFFSET
        self.move(max(room.left(), min(position.x(), room.right())), max(room.top(), min(position.y(), room.bottom())))
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
        # other keys do not reach the drawing

    def focusNextPrevChild(self, next: bool) -> bool:
        edits = [edit for _, edit in self._boxes]
        focused = [i for i, edit in enumerate(edits) if edit.hasFocus()]
        if not focused:
            return super().focusNextPrevChild(next)
        edit = edits[(focused[0] + (1 if next else -1)) % len(edits)]
        edit.setFocus(Qt.FocusReason.TabFocusReason)
        edit.selectAll()
        return True

    def take(self) -> None:
        """Accept the values; a box without a valid number gets a red frame, and the boxes stay open."""
        values: list[Typed] = []
        wrong = False
        for box, edit in self._boxes:
            text = edit.text().strip()
            value: Typed = text
            if box.unit is not None:
                value = parsed(text, box.unit) if text else None
            bad = box.unit is not None and bool(text) and value is None
            edit.setStyleSheet(f"border: 1px solid {SCREEN.limit};" if bad else "")
            edit.setToolTip("A number, optionally with a unit: 12.5, 3*12, 1 in" if bad else "")
            wrong = wrong or bad
            values.append(value)
        if wrong or self._accept is None:
            return
        accept = self._accept
        if why := accept(values):
            for _, edit in self._boxes:
                edit.setToolTip(why)
            self._boxes[0][1].setStyleSheet(f"border: 1px solid {SCREEN.limit};")
        elif self._accept is accept:
            self.close_all()

    def close_all(self) -> None:
        """Close the boxes without accepting their values."""
        self._accept = None
        self._boxes.clear()
        focus = self.window().focusWidget()
        had_focus = focus is not None and self.isAncestorOf(focus)
        self.hide()
        while (item := self._row.takeAt(0)) is not None:
            widget = item.widget()
            if widget is not None:
                widget.hide()
                widget.deleteLater()
        if had_focus:
            self._drawing.setFocus()


# -- edits by typed values -------------------------------------------------------------------------------

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
"""List of the loads, or of second inputs -> label, field and unit of the values of a selected row.

The wheels of a second input are teeth if a module is typed, else radii.
"""
RACK_OFFSET = ("offset", "offset_mm", MM)
"""Offset of a second input that slides."""


class TypedValues:
    """Opens input boxes at the mouse, ``at`` [pixels], and applies their values."""

    def __init__(self, drawn: DrawnLinkage, tool_input: ToolInput) -> None:
        self.drawn, self.tool_input = drawn, tool_input
        self.boxes = TypedBoxes(drawn.canvas.viewport(), drawn.canvas)
        self.at = QPoint()

    def type_first(self, text: str) -> None:
        """Open the boxes that a digit belongs to: a line, the selection, or a position."""
        if self.tool_input.snaps and self.tool_input.tool.clicks > 1:
            self.boxes.ask(self.at, (Box("length", MM), Box("angle", DEG)), self._set_line, text)
        elif request := self._selection_boxes():
            boxes, accept = request
            self.boxes.ask(self.at, boxes, accept, text)
        elif self.tool_input.tool.clicks:
            self.boxes.ask(self.at, (Box("x", MM), Box("y", MM)), self._set_position, text)

    def _set_line(self, values: Sequence[Typed]) -> str:
        """Set a line from the last click by length and angle; an empty box follows the mouse."""
        if not self.tool_input.snaps:
            return ""
        start = self.tool_input.snaps[-1].at
        mouse = self.tool_input.mouse or Snap(start + 1.0)
        vector = mouse.at - start
        length = values[0] if isinstance(values[0], float) else abs(vector)
        angle = values[1] if isinstance(values[1], float) else math.degrees(cmath.phase(vector))
        if not length > 0.0:
            return "a length above 0"
        exact = values[0] if isinstance(values[0], float) else None
        straight = {0.0: 1.0 + 0j, 90.0: 1j, 180.0: -1.0 + 0j, -90.0: -1j, 270.0: -1j}
        end = start + length * straight.get(angle, cmath.exp(1j * math.radians(angle)))
        self.boxes.close_all()
        # without a typed angle the pin under the mouse is joined, at the typed length
        snap = mouse if mouse.point and values[1] is None else self._snap_at(end)
        self.tool_input.set(snap, exact if self.tool_input.tool.name == "bar" else None, typed=True)
        return ""

    def _set_position(self, values: Sequence[Typed]) -> str:
        x, y = (value if isinstance(value, float) else 0.0 for value in values)
        self.boxes.close_all()
        self.tool_input.set(self._snap_at(complex(x, y)), typed=True)
        return ""

    def _snap_at(self, position: complex) -> Snap:
        """Snap of a typed position."""
        design, positions = self.drawn.layout
        return snap_at(design.drive.linkage, positions, position, self.tool_input.barred)

    def _apply(self, edit: Callable[[], DrawingEdit | Design], text: str = "") -> str:
        """Close the boxes and apply an edit; returns an empty text, as the values are valid."""
        self.boxes.close_all()
        self.drawn.apply(edit, text)
        return ""

    def type_values(self) -> None:
        """Open the boxes with the values of the selection."""
        request = self._selection_boxes()
        if request is None:
            self.drawn.message.emit("Select a point, a bar or a load first, then type its values")
        else:
            self.boxes.ask(self.at, *request)

    def _selection_boxes(self) -> tuple[tuple[Box, ...], AcceptFunction] | None:
        """Boxes for the selection: values of a load, coordinates of a point, or the length of a bar."""
        linkage = self.drawn.layout[0].drive.linkage
        if self.drawn.row:
            kind = self.drawn.row.partition("[")[0].rpartition(".")[2]
            fields = ROW_BOXES.get(kind, ())
            if kind == "drivers" and input_slides(linkage, linkage.drivers[row_index(self.drawn.row)]):
                fields = tuple(
                    RACK_OFFSET if name == "offset_deg" else (label, name, unit) for label, name, unit in fields
                )
            return tuple(Box(label, unit) for label, _, unit in fields), partial(self._set_row, self.drawn.row, fields)
        if len(self.drawn.points) == 1 and not self.drawn.links:
            (name,) = self.drawn.points
            return (Box("x", MM), Box("y", MM)), partial(self._set_point, name)
        if (
            len(self.drawn.links) == 1
            and len(linkage.by_number[min(self.drawn.links)].points) == 2
            and not self.drawn.points
        ):
            link = linkage.by_number[min(self.drawn.links)]
            return (Box("length", MM),), partial(self._set_length, link.number, *link.places)
        return None

    def _set_row(self, row: str, fields: Sequence[tuple[str, str, Any]], values: Sequence[Typed]) -> str:
        if row.startswith("linkage.drivers"):
            return self._set_input(row_index(row), values)

        def changed() -> Design:
            design, _ = self.drawn.layout
            for (_, name, _), value in zip(fields, values, strict=True):
                if isinstance(value, float):
                    design = put(design, f"{row}.{name}", value)
            return design

        kind = row.partition("[")[0].rpartition(".")[2]
        return self._apply(changed, f"Set {({'masses': 'mass', 'forces': 'force', 'springs': 'spring'})[kind]}")

    def _set_input(self, index: int, values: Sequence[Typed]) -> str:
        """Set ratio, offset and wheels of a second input; wheels give the ratio, a ratio alone removes the wheels."""
        design, _ = self.drawn.layout
        old = design.drive.linkage.drivers[index]
        ratio, offset, first, second, module = (value if isinstance(value, float) else None for value in values[:5])
        kind = str(values[5] or "").strip().lower() or None
        if kind is not None and kind not in WHEELS:
            return " | ".join(WHEELS)
        if (first is None) != (second is None):
            return "give both wheels, or none"
        row = replace(old, kind=kind or old.kind)
        if ratio is not None or first is not None:
            row = SecondDriver(
                link=old.link, on=old.on, ratio=ratio, offset_deg=old.offset_deg, offset_mm=old.offset_mm, kind=kind
            )
        if first is not None and second is not None:
            if min(first, second) < 0.0 or not max(first, second):
                return "the size of a wheel is above 0, that of a rack is 0"
            kind = kind or (GEAR if min(first, second) else RACK)
            if module is None:
                row = replace(row, radius_first_mm=first, radius_second_mm=second, kind=kind)
            elif first % 1.0 or second % 1.0:
                return "numbers of teeth are whole numbers"
            else:
                row = replace(row, teeth_first=int(first), teeth_second=int(second), module_mm=module, kind=kind)
        return self._apply(
            lambda: with_input_values(design, index, row, offset), f"Set second input of link {old.link}"
        )

    def _set_point(self, name: str, values: Sequence[Typed]) -> str:
        """Set the coordinates of a point: in the frame of its link, for a pin in the global frame."""
        design, positions = self.drawn.layout
        linkage = design.drive.linkage
        links = [link for link in linkage.links if name in link.places]
        local = links[0].places[name] if len(links) == 1 else positions[name]
        x, y = (
            value if isinstance(value, float) else old
            for value, old in zip(values, (local.real, local.imag), strict=True)
        )
        text = f"Put {name} at {shortest(x)}, {shortest(y)} mm"
        if len(links) == 1 and links[0].number != FRAME_LINK:
            number = links[0].number
            return self._apply(lambda: with_local_point(design, number, name, complex(x, y)), text)
        return self._apply(lambda: with_moved(design, {name: complex(x, y)}), text)

    def ask_length(self, number: int, first: str, second: str) -> None:
        """Open the box of a length next to its value in the drawing."""
        design, _ = self.drawn.layout
        positions = design.drive.linkage.by_number[number].places
        value = shortest(abs(positions[second] - positions[first]))
        rect = self.drawn.lengths.get((number, first, second))
        at = rect.center().toPoint() if rect is not None else self.at
        self.boxes.ask(at, (Box(f"{first}-{second}", MM, value),), partial(self._set_length, number, first, second))

    def _set_length(self, number: int, first: str, second: str, values: Sequence[Typed]) -> str:
        (value,) = values
        self.boxes.close_all()
        if isinstance(value, float):
            design, _ = self.drawn.layout
            text = f"Make {first}-{second} {shortest(value)} mm long"
            self.drawn.apply(lambda: assembled(with_length(design, number, first, second, value)), text)
        return ""

    def rename(self) -> None:
        """Open the box with the name of the selected point."""
        if name := self.drawn.selected_point():
            at = self.drawn.sketch.to(self.drawn.layout[1][name]).toPoint()

            def accept(values: Sequence[Typed]) -> str:
                new = str(values[0] or "")
                try:
                    design = with_name(self.drawn.layout[0], name, new)
                except KindynaError as error:
                    return refusal_text(self.drawn.layout[0], error)
                return self._apply(lambda: DrawingEdit(design, f"Rename {name} to {new}", points=(new,)))

            self.boxes.ask(at, (Box("name", None, name),), accept)
