"""Form of the curve of a segment: settings of its law, ends of a polynomial, points of a spline."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QGridLayout,
    QLabel,
    QVBoxLayout,
    QWidget,
)

from core.design import (
    ComputedCurve,
    Design,
    Motion,
    NamedCurve,
    OptimalCurve,
    PolynomialCurve,
    PolynomialEnd,
    SccaCurve,
    SplineCurve,
    TableCurve,
    entries,
    get,
    require_motion,
)
from core.design.motions import needs_machine
from core.laws import find_law, peaks
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import Field, FieldSpec
from kindyna_gui.forms.number_box import NumberBox, row_height
from kindyna_gui.labels import law_label, segment_of, value_text
from kindyna_gui.look import coloured
from kindyna_gui.motion.curve_lists import (
    OPTIMAL_LISTS,
    ListsTable,
    OptionalBox,
    entry_info,
    motion_unit,
    name_in_sentence,
)
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import ContentArea, connect_all, fill

if TYPE_CHECKING:
    pass
from kindyna_gui.settings import symbol_of

CURVE_KEYS = ("crossover", "cv_fraction", "ramp_fraction", "flat_fraction")
END_KEYS = ("start", "end")
# -- fields ----------------------------------------------------------------------------------------------


def end_specs(motion: Motion, path: str) -> Iterator[FieldSpec]:
    """Yield the fields of one end of a polynomial; path such as ``motion.segments[1].start``."""
    for field in fields(PolynomialEnd):
        field_path = f"{path}.{field.name}"
        unit = motion_unit(field.name, motion)
        yield FieldSpec(field_path, entry_info(field), unit, partial(get, path=field_path), can_be_assumed=False)


class CurveField(Field):
    """Field of a curve, whose undo steps name the segment."""

    def _step(self, value: Any) -> str:
        name = name_in_sentence(self.session.typed, self.spec.path)
        return f"Change {name} to {value_text(value, self.spec.unit)}"


class EndField(CurveField):
    """Field of an end of a polynomial; a jerk may be left open."""

    hint = "free"

    def _number_box(self) -> NumberBox:
        if not self.spec.info.optional:
            return super()._number_box()
        box = OptionalBox(self.spec.info, self.spec.unit, hint=self.hint)
        connect_all(
            (box.entered, self._enter),
            (box.emptied, self._leave_open),
            (
                box.unreadable,
                lambda: self.session.refuse(
                    self.spec.path, "not a number; enter a number, or nothing to leave it open"
                ),
            ),
            (box.withdrawn, lambda: self.session.clear_refusal(self.spec.path)),
            (box.finished, self.session.end_gesture),
            (self.label.dragged, box.stepBy),
            (self.label.released, self._label_released),
        )
        return box

    def _leave_open(self) -> None:
        self.edit(None, f"Leave {name_in_sentence(self.session.typed, self.spec.path)} open")


class LimitField(EndField):
    """Field of a limit, which may be left out; where no law keeps it, a button takes the least one."""

    hint = "none"

    def _show_refusals(self) -> None:
        super()._show_refusals()
        if ".limits." in self.spec.path and self._misfit and not self._refusals and not self.is_obsolete:
            from kindyna_gui.motion.optimal_form import refusal_of_limit  # imported here to save start-up time

            self.message.show_refusal(*refusal_of_limit(self.session, self.session.typed, self.spec.path))


# -- form of a curve -------------------------------------------------------------------------------------


def has_crossover(motion: Motion, index: int) -> bool:
    """Whether the crossover from acceleration to deceleration can be set."""
    curve = motion.segments[index].curve
    law = find_law(curve.law) if isinstance(curve, NamedCurve) else None
    return law is not None and law.is_symmetric and peaks(law).ca > 0.0


def keys_of_form(motion: Motion, index: int) -> tuple[str, ...]:
    """Keys of the curve that have a field; of a named curve only those that its law has."""
    curve = motion.segments[index].curve
    law = find_law(curve.law) if isinstance(curve, NamedCurve) else None
    if law is None:
        return CURVE_KEYS
    return (
        *(("crossover",) if has_crossover(motion, index) else ()),
        *(("flat_fraction",) if law.flat is not None else ()),
    )


def kind_of_form(motion: Motion, index: int) -> type | None:
    """Class of the curve whose form is shown; None if the curve has no settings."""
    curve = motion.segments[index].curve
    return None if isinstance(curve, NamedCurve) and not keys_of_form(motion, index) else type(curve)


class SegmentCurveForm(QWidget):
    """Form of the curve of a segment; built again only for another kind of curve or another segment."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__()
        self._session, self._player = session, player
        self._shown: tuple[int, type | str, tuple[str, ...]] = (-1, "", ())
        self.fields: dict[str, Field] = {}
        self.points: ListsTable | None = None
        self._note: QLabel | None = None
        self._form_area = ContentArea(session, player)
        self._column = fill(QVBoxLayout(self), self._form_area, margins=(10, 3, 6, 0), spacing=2)
        self.update_style()

    def update_style(self) -> None:
        """Keep room for at least one row, so that selecting a segment moves nothing."""
        self.setMinimumHeight(row_height(self) + 5)

    def show_segment(self, design: Design, index: int) -> None:
        """Show the curve of a segment."""
        motion = require_motion(design)
        kind = kind_of_form(motion, index)
        shown = (index, kind or motion.segments[index].curve.law, keys_of_form(motion, index))
        if shown != self._shown:
            self._shown = shown
            self._build(design, index, kind)
        for field in self.fields.values():
            field.refresh(design)
        if self.points is not None:
            self.points.show_segment(design, index)
        if self._note is not None:
            self._note.setVisible(needs_machine(motion.segments[index].curve))

    def _build(self, design: Design, index: int, kind: type | None) -> None:
        self._paper = QWidget()
        self.fields, self.points, self._note = {}, None, None
        if kind is None:
            self._add_sentence(f"{law_label(require_motion(design).segments[index].curve.law)}: no further settings")
        else:
            FORMS[kind](self, design, index)
        self._form_area.replace(self._paper)

    def _add_sentence(self, text: str) -> None:
        label = coloured(QLabel(text, wordWrap=True), SCREEN.quiet)
        self._grid().addWidget(label, 0, 0)

    # -- forms of the kinds of curves --------------------------------------------------------------------

    def _rows(self, design: Design, index: int, keys: tuple[str, ...] = ()) -> QGridLayout:
        """Add a row for each key: crossover, or widths."""
        grid, keys = self._grid(), keys or keys_of_form(require_motion(design), index)
        for entry in entries(design, "motion"):
            if segment_of(entry.path) == index and entry.path.rpartition(".")[2] in keys:
                field = self._register(CurveField(self._session, FieldSpec.of(entry)))
                field.add_to(grid, 2 * len(self.fields))
        grid.setColumnStretch(1, 1)
        return grid

    def _ends(self, design: Design, index: int) -> None:
        """Add a row for each end: velocity, acceleration and jerk, with units in the headings."""
        grid, motion = self._grid(), require_motion(design)
        for row, end in enumerate(END_KEYS, 1):
            name = QLabel(f"{end.capitalize()} ")
            grid.addWidget(name, 2 * row, 0)
            for column, spec in enumerate(end_specs(motion, f"motion.segments[{index}].{end}"), 1):
                field = self._register(EndField(self._session, spec))
                field.editor.setMinimumWidth(1)
                field.editor.setAccessibleName(f"{end.capitalize()}, {spec.info.label.lower()}")
                if row == 1:
                    heading = coloured(QLabel(f"{spec.info.label} {symbol_of(spec.unit.symbol)}"), SCREEN.quiet)
                    grid.addWidget(heading, 0, column, Qt.AlignmentFlag.AlignRight)
                    grid.setColumnStretch(column, 1)
                for unused in (field.label, field.unit):
                    if unused is not None:
                        unused.setParent(self._paper)
                        unused.hide()
                grid.addWidget(field.editor, 2 * row, column)

    def _points(self, design: Design, index: int) -> None:
        """Add the table of points of a spline."""
        self._add_points(self._grid())

    def _table(self, design: Design, index: int) -> None:
        """Add the conditions at the ends of a table, and its rows."""
        self._add_points(self._rows(design, index, END_KEYS))

    def _optimal(self, design: Design, index: int) -> None:
        """Add aim, ends, limits and obstacles of an optimal law, and its points."""
        from kindyna_gui.motion.optimal_form import add_rows, scrolled_grid  # imported here to save start-up time

        settings = QWidget()
        self._note = add_rows(
            design, index, scrolled_grid(settings), lambda spec: self._register(LimitField(self._session, spec))
        )
        self.points = ListsTable(self._session, self._player, OPTIMAL_LISTS, settings)
        fill(QVBoxLayout(self._paper), self.points, margins=0)

    def _add_points(self, grid: QGridLayout) -> None:
        self.points = ListsTable(self._session, self._player)
        grid.addWidget(self.points, grid.rowCount(), 0, 1, -1)

    def _computed(self, design: Design, index: int) -> None:
        """Add a sentence that says what the curve follows from."""
        motion = require_motion(design)
        self._add_sentence(
            "This curve follows from the lobe: change its lift, durations or ramp, or choose Lobe to segments"
            if motion.lobe is not None
            else "This curve follows from other files"
            if motion.follows is not None
            else "This curve follows from the torque of the drives: change the drives, or the spring of the balance cam"
        )

    def _grid(self) -> QGridLayout:
        grid = fill(QGridLayout(self._paper), margins=0, spacing=(6, 2))
        return grid

    def _register(self, field: Field) -> Field:
        field.setParent(self._paper)  # deleted together
        self.fields[field.spec.path] = field
        return field

    # -- focus -------------------------------------------------------------------------------------------

    def focus_field(self, path: str) -> bool:
        """Show and focus the field of a path; False if the form does not have it."""
        field = self.fields.get(path)
        if field is not None:
            if self.points is not None:
                self.points.choose_settings()
            field.focus()
            return True
        key = path.partition("]")[2].strip(".").partition("[")[0]
        if self.points is not None and self.points.choose(key):
            self.points.table.setFocus(Qt.FocusReason.OtherFocusReason)
            return True
        return False


FORMS: Mapping[type, Callable[[SegmentCurveForm, Design, int], object]] = MappingProxyType(
    {
        NamedCurve: SegmentCurveForm._rows,
        SccaCurve: SegmentCurveForm._rows,
        PolynomialCurve: SegmentCurveForm._ends,
        SplineCurve: SegmentCurveForm._points,
        TableCurve: SegmentCurveForm._table,
        OptimalCurve: SegmentCurveForm._optimal,
        ComputedCurve: SegmentCurveForm._computed,
    }
)
"""Class of a curve -> function that lays out its form."""
