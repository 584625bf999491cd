"""Values typed while drawing: input boxes at the mouse, and the edits that their values make."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QLineEdit, QVBoxLayout, QWidget

from core.design import NO_UNIT, UNITS, Design, SecondDriver, Unit, put
from core.design.linkage import FRAME_LINK, GEAR, RACK, WHEELS
from core.design.topology import input_slides
from core.errors import DesignError, KindynaError
from core.frozen import frozen
from core.mechanism.drawing_edits import with_length, with_local_point, with_moved, with_name
from core.mechanism.drawn import assembled, fault, link_pose, unit_vector, with_input_values
from core.number_text import shortest
from kindyna_gui.forms.number_box import parsed
from kindyna_gui.forms.refusal import RefusalLine
from kindyna_gui.labels import no_number, sentence
from kindyna_gui.linkage.draw_tools import DIRECTION, LENGTH, LOCAL, POSITION, Drawing, DrawingEdit, row_index
from kindyna_gui.linkage.drawing_mouse import ToolInput
from kindyna_gui.linkage.drawn_linkage import DrawnLinkage, refusal_text
from kindyna_gui.linkage.snapping import LINE, Snap, snap_at
from kindyna_gui.look import described
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import fill
from kindyna_gui.settings import number_text, symbol_of

Typed = float | str | None
"""Value of an input box; None if the box is empty."""
PlaceFunction = Callable[[Sequence[Typed]], Snap]
"""Position of typed values; raises DesignError where they give none."""
AcceptFunction = Callable[[Sequence[Typed]], str]
"""Called with the values of the boxes; returns why they are not valid, or an empty text."""

BOX_OFFSET = QPoint(16, 12)  # from the mouse, pixels
REFUSAL_WIDTH = 260  # of the line below the boxes, pixels
MM, DEG, KG, KG_M2, N = UNITS["mm"], UNITS["deg"], UNITS["kg"], UNITS["kg_m2"], UNITS["n"]
RATE = UNITS["n_per_mm"]

# -- input boxes -----------------------------------------------------------------------------------------


@frozen
class Box:
    """One input box: label, unit of its number (None for a text), initial text, and the number that this is, rounded."""

    label: str
    unit: Unit | None
    text: str = ""
    value: float | None = None


class TypedBoxes(QFrame):
    """Input boxes at the mouse: Tab moves between them, Enter accepts the values, Esc cancels.

    The line below the boxes says why a value was refused, with a button that restores it.

    Signals: ``message`` with the reason why a value is not valid; ``edited`` with the values while they are typed; ``closed``.
    """

    message = Signal(str)
    edited = Signal(list)
    closed = Signal()

    def __init__(self, parent: QWidget, drawing: QWidget) -> None:
        super().__init__(parent)
        self._area, self._drawing = parent, drawing
        self.setObjectName("typed boxes")
        self.setAutoFillBackground(True)
        self.setStyleSheet(f"#typed\\ boxes {{ background: {SCREEN.paper}; border: 1px solid {SCREEN.line}; }}")
        self._row = fill(QHBoxLayout(), spacing=4)
        self.refusal = RefusalLine()
        fill(QVBoxLayout(self), self._row, self.refusal, margins=(5, 3, 5, 3), spacing=0)
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
                self._row.addWidget(QLabel(symbol_of(box.unit.symbol)))
            edit.textChanged.connect(self._text_changed)
            self._boxes.append((box, edit))
        self._place(at + BOX_OFFSET)
        self.show()
        self.raise_()
        edit = self._boxes[first][1]
        edit.setFocus()
        edit.selectAll()
        if typed:
            edit.setText(typed)
            edit.end(False)

    def _place(self, position: QPoint) -> None:
        """Put the boxes at a pixel of the parent, as far as they have room there."""
        self.adjustSize()
        room = self._area.rect().adjusted(2, 2, -2 - self.width(), -2 - self.height())
        self.move(max(room.left(), min(position.x(), room.right())), max(room.top(), min(position.y(), room.bottom())))

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
        wrong = ""
        for box, edit in self._boxes:
            is_wrong = box.unit is not None and bool(edit.text().strip()) and _value(box, edit) is None
            self._mark(edit, f"{box.label}: {no_number(edit.text().strip())}" if is_wrong else "")
            wrong = wrong or edit.toolTip()
        accept = self._accept
        if accept is None:
            return
        if not wrong and (wrong := accept([_value(*row) for row in self._boxes])):
            self._mark(self._boxes[0][1], wrong)
        if wrong:
            self.message.emit(wrong)
            self._show_refusal(wrong)
        elif self._accept is accept:
            self.close_all()

    def _show_refusal(self, why: str) -> None:
        """Say below the boxes why the first marked one is refused, with a button that restores its text."""
        box, edit = next(row for row in self._boxes if row[1].toolTip())
        unit = "" if box.unit is None else f" {symbol_of(box.unit.symbol)}".replace(" °", "°")
        back = f"Back to {box.text}{unit}" if box.text else "Leave it empty"
        remedies = {back: partial(self._restore, box, edit)} if edit.text() != box.text else {}
        self.refusal.setMinimumWidth(min(REFUSAL_WIDTH, self._area.width() - 20))
        self.refusal.show_refusal(sentence(why), remedies)
        self._place(self.pos())

    def _restore(self, box: Box, edit: QLineEdit) -> None:
        """Restore the text that a refused box was opened with."""
        edit.setText(box.text)
        self._mark(edit, "")
        self.refusal.show_refusal("")
        self.adjustSize()
        edit.setFocus()
        edit.selectAll()

    def _mark(self, edit: QLineEdit, why: str) -> None:
        """Mark a box whose value is not valid, or is valid again."""
        edit.setStyleSheet(f"border: 1px solid {SCREEN.limit};" if why else "")
        edit.setToolTip(why)

    def _text_changed(self) -> None:
        self.edited.emit([_value(*row) for row in self._boxes])

    def close_all(self) -> None:
        """Close the boxes without accepting their values."""
        was_open, self._accept = self.open, None
        self._boxes.clear()
        self.refusal.show_refusal("")
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
        if was_open:
            self.closed.emit()


def _value(box: Box, edit: QLineEdit) -> Typed:
    """Value of an input box."""
    text = edit.text().strip()
    if box.value is not None and text == box.text:
        return box.value
    return text if box.unit is None else parsed(text, box.unit) if text else None


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


_SINGULAR = {"masses": "mass", "forces": "force", "springs": "spring"}


def _with_row_values(
    design: Design, row: str, fields: Sequence[tuple[str, str, Any]], values: Sequence[Typed]
) -> Design:
    """The design with the typed values of a row of the loads."""
    for (_, name, _), value in zip(fields, values, strict=True):
        if isinstance(value, float):
            design = put(design, f"{row}.{name}", value)
    return design


class TypedValues:
    """Opens input boxes at the mouse, ``at`` [pixels], and applies their values."""

    def __init__(self, drawn: DrawnLinkage, tool_input: ToolInput) -> None:
        self.drawn, self.tool_input = drawn, tool_input
        self.boxes = TypedBoxes(drawn.canvas.viewport(), drawn.canvas)
        self.boxes.message.connect(drawn.message)
        self.boxes.edited.connect(self._preview)
        self.boxes.closed.connect(self._closed)
        self.at = QPoint()
        self._mouse: Snap | None = None
        self._place: PlaceFunction | None = None
        self._place_boxes: dict[str, tuple[tuple[Box, ...], PlaceFunction]] = {
            POSITION: ((Box("x", MM), Box("y", MM)), self._at_position),
            LOCAL: ((Box("x", MM), Box("y", MM)), self._at_local),
            LENGTH: ((Box("length", MM), Box("angle", DEG)), self._at_line),
            DIRECTION: ((Box("angle", DEG),), self._at_angle),
        }

    def type_first(self, text: str) -> None:
        """Open the boxes that a digit belongs to: of the next click of a tool that has been clicked, of the selection, of a tool."""
        self.boxes.close_all()
        clicks = len(self.tool_input.snaps)
        if not clicks and (request := self._selection_boxes()):
            self.boxes.ask(self.at, *request, text)
        elif kind := self.tool_input.tool.boxes_at(clicks):
            self._mouse = self.tool_input.mouse
            if kind in ROW_BOXES:
                boxes = tuple(Box(label, unit) for label, _, unit in ROW_BOXES[kind])
                self.boxes.ask(self.at, boxes, partial(self._set_new_row, ROW_BOXES[kind]), text)
            else:
                boxes, self._place = self._place_boxes[kind]
                self.boxes.ask(self.at, boxes, self._set_place, text)
        elif self.tool_input.tool.clicks:
            self.drawn.message.emit(self.tool_input.prompt)
        else:
            self.type_values()

    def _set_place(self, values: Sequence[Typed]) -> str:
        """Click at the typed position."""
        assert self._place is not None
        try:
            snap = self._place(values)
        except DesignError as error:
            return refusal_text(self.drawn.layout[0], error)
        has_length = self._place == self._at_line and self.tool_input.tool.clicks == 2  # a plate has no length
        length = values[0] if has_length and isinstance(values[0], float) else None
        self.boxes.close_all()
        self.tool_input.set(snap, length, typed=True)
        return ""

    def _preview(self, values: Sequence[Typed]) -> None:
        """Show the mark of the values typed so far, which is what Enter joins."""
        with suppress(DesignError):
            if self._place is not None:
                self.tool_input.mouse = self._place(values)
                self.drawn.canvas.viewport().update()

    def _closed(self) -> None:
        """Show the mark of the mouse again."""
        if self._place is not None:
            self._place, self.tool_input.mouse = None, self._mouse
            self.drawn.canvas.viewport().update()

    def _at_line(self, values: Sequence[Typed]) -> Snap:
        """Return the end of a line from the last click by length and angle; an empty box follows the mouse."""
        start, mouse = self._line
        length = values[0] if isinstance(values[0], float) else abs(mouse.at - start)
        angle = values[1] if isinstance(values[1], float) else math.degrees(cmath.phase(mouse.at - start))
        if not length > 0.0:
            raise fault(f"a length of {shortest(length)} mm", "above 0")
        # without a typed angle the pin under the mouse is joined, at the typed length
        return mouse if mouse.point and values[1] is None else self._snap_at(start + length * unit_vector(angle))

    def _at_angle(self, values: Sequence[Typed]) -> Snap:
        """Return a position on a line through the last click at an angle, as far away as the mouse."""
        start, mouse = self._line
        angle = values[0] if isinstance(values[0], float) else math.degrees(cmath.phase(mouse.at - start))
        return self._snap_at(start + (abs(mouse.at - start) or 1.0) * unit_vector(angle))

    @property
    def _line(self) -> tuple[complex, Snap]:
        """Position of the last click, and what the mouse snapped to when the boxes were opened."""
        start = self.tool_input.snaps[-1].at if self.tool_input.snaps else 0j
        return start, self._mouse or Snap(start + 1.0)

    def _at_position(self, values: Sequence[Typed]) -> Snap:
        x, y = (value if isinstance(value, float) else 0.0 for value in values)
        return self._snap_at(complex(x, y))

    def _at_local(self, values: Sequence[Typed]) -> Snap:
        """Return a position in the frame of the link under the mouse; the global position where there is no link."""
        mouse = self._mouse
        if mouse is None or mouse.link is None:
            return self._at_position(values)
        design, positions = self.drawn.layout
        origin, axis = link_pose(design.drive.linkage, mouse.link, positions)
        x, y = (value if isinstance(value, float) else 0.0 for value in values)
        return Snap(origin + complex(x, y) * axis, LINE, link=mouse.link)

    def _set_new_row(self, fields: Sequence[tuple[str, str, Any]], values: Sequence[Typed]) -> str:
        """Add the load of the tool at the mouse, with typed values."""
        apply, mouse = self.tool_input.tool.apply, self._mouse
        if mouse is None or apply is None:
            return self.tool_input.prompt
        drawing = Drawing(*self.drawn.layout, (mouse,), None, self.drawn.canvas.scale_now)

        def added() -> DrawingEdit:
            edit = apply(drawing)
            return replace(edit, design=_with_row_values(edit.design, edit.row, fields, values))

        return self._apply(added)

    def _snap_at(self, position: complex) -> Snap:
        """Snap of a typed position."""
        design, positions = self.drawn.layout
        return snap_at(design.drive.linkage, positions, position, self.tool_input.barred)

    def _apply(self, edit: Callable[[], DrawingEdit | Design], text: str = "") -> str:
        """Apply an edit as one undo step; returns why it is refused, as the boxes then stay open."""
        try:
            result = edit()
        except KindynaError as error:
            return refusal_text(self.drawn.layout[0], error)
        with self.drawn.session.one_step() as refusals:
            self.drawn.apply(lambda: result, text)
        return "; ".join(f"{name}: {why}" for refusal in refusals for _, name, why in refusal.reasons)

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

        kind = row.partition("[")[0].rpartition(".")[2]
        return self._apply(
            lambda: _with_row_values(self.drawn.layout[0], row, fields, values), f"Set {_SINGULAR[kind]}"
        )

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
        length = abs(positions[second] - positions[first])
        rect = self.drawn.lengths.get((number, first, second))
        at = rect.center().toPoint() if rect is not None else self.at
        self.boxes.ask(
            at,
            (Box(f"{first}-{second}", MM, number_text(length, MM), length),),
            partial(self._set_length, number, first, second),
        )

    def _set_length(self, number: int, first: str, second: str, values: Sequence[Typed]) -> str:
        (value,) = values
        if not isinstance(value, float):
            return ""
        design, _ = self.drawn.layout
        text = f"Make {first}-{second} {shortest(value)} mm long"
        return self._apply(lambda: assembled(with_length(design, number, first, second, value)), text)

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
