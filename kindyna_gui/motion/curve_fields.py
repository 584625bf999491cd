"""What the curve of the chosen segment takes besides span and rise: crossover, widths, ends, points."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QVBoxLayout, QWidget

from core.design import (
    ComputedCurve,
    Design,
    Motion,
    NamedCurve,
    PolynomialCurve,
    SccaCurve,
    SplineCurve,
    TableCurve,
    entries,
    require_motion,
)
from core.laws import find_law, peaks
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import Field, FieldSpec
from kindyna_gui.forms.number_box import row_height
from kindyna_gui.labels import law_label, segment_of
from kindyna_gui.look import coloured
from kindyna_gui.motion.fields import CurveField, EndField, end_specs
from kindyna_gui.motion.points import PointsTable
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.preferences.units import symbol_of
from kindyna_gui.rebuilt import Rebuilt

_CURVE_KEYS = ("crossover", "cv_fraction", "ramp_fraction", "flat_fraction")
_ENDS = ("start", "end")


def crosses(motion: Motion, index: int) -> bool:
    """Whether the place where the segment turns from acceleration to deceleration can be chosen."""
    curve = motion.segments[index].curve
    law = find_law(curve.law) if isinstance(curve, NamedCurve) else None
    return law is not None and law.symmetric and peaks(law).ca > 0.0


def keys_of_form(motion: Motion, index: int) -> tuple[str, ...]:
    """The entries of the segment's curve that are fields of a row each: of a curve known by its name only what its law takes."""
    curve = motion.segments[index].curve
    law = find_law(curve.law) if isinstance(curve, NamedCurve) else None
    if law is None:
        return _CURVE_KEYS
    return (*(("crossover",) if crosses(motion, index) else ()), *(("flat_fraction",) if law.flat is not None else ()))


def kind_of_form(motion: Motion, index: int) -> type | None:
    """The kind of curve whose form is shown; None where the curve takes nothing more."""
    curve = motion.segments[index].curve
    return None if isinstance(curve, NamedCurve) and not keys_of_form(motion, index) else type(curve)


class SegmentCurveForm(QWidget):
    """The form of one segment's curve; made anew only for another kind of curve or another segment.

    error_changed (str): what is wrong with a point of a spline, empty when nothing is
    """

    error_changed = Signal(str)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__()
        self._session, self._player = session, player
        self._shown: tuple[int, type | str, tuple[str, ...]] = (-1, "", ())
        self.fields: dict[str, Field] = {}
        self.points: PointsTable | None = None
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(10, 3, 6, 0)
        self._column.setSpacing(2)
        self._place = Rebuilt(session, player)
        self._column.addWidget(self._place)
        self.redress()

    def redress(self) -> None:
        """One row always, so that choosing a segment moves nothing."""
        self.setMinimumHeight(row_height(self) + 5)

    def show_segment(self, design: Design, index: int) -> None:
        """Show the curve of a segment."""
        motion = require_motion(design)
        kind = kind_of_form(motion, index)
        wanted = (index, kind or motion.segments[index].curve.law, keys_of_form(motion, index))
        if wanted != self._shown:
            self._shown = wanted
            self._build(design, index, kind)
        for field in self.fields.values():
            field.refresh(design)
        if self.points is not None:
            self.points.show_segment(design, index)

    def _build(self, design: Design, index: int, kind: type | None) -> None:
        self._paper = QWidget()
        self.fields, self.points = {}, None
        if kind is None:
            self._nothing(design, index)
        else:
            FORMS[kind](self, design, index)
        self._place.replace(self._paper)

    def _nothing(self, design: Design, index: int) -> None:
        self._sentence(f"{law_label(require_motion(design).segments[index].curve.law)}: span and rise say everything")

    def _sentence(self, text: str) -> None:
        label = QLabel(text)
        label.setWordWrap(True)
        coloured(label, SCREEN.quiet)
        self._grid().addWidget(label, 0, 0)

    # -- forms --------------------------------------------------------------------------------------------

    def _rows(self, design: Design, index: int, keys: tuple[str, ...] = ()) -> QGridLayout:
        """Crossover, or widths: a row each."""
        grid, keys = self._grid(), keys or keys_of_form(require_motion(design), index)
        for entry in entries(design, "motion"):
            if segment_of(entry.path) == index and entry.path.rpartition(".")[2] in keys:
                field = self._keep(CurveField(self._session, FieldSpec.of(entry)))
                field.add_to(grid, 2 * len(self.fields))
        grid.setColumnStretch(1, 1)
        return grid

    def _ends(self, design: Design, index: int) -> None:
        """Velocity, acceleration and jerk at both ends: a row for each end, units in the headings."""
        grid, motion = self._grid(), require_motion(design)
        for row, end in enumerate(_ENDS, 1):
            name = QLabel(f"{end.capitalize()} ")
            grid.addWidget(name, 2 * row, 0)
            for column, spec in enumerate(end_specs(motion, f"motion.segments[{index}].{end}"), 1):
                field = self._keep(EndField(self._session, spec))
                field.editor.setMinimumWidth(1)
                field.editor.setAccessibleName(f"{end.capitalize()}, {spec.info.label.lower()}")
                if row == 1:
                    head = QLabel(f"{spec.info.label} {symbol_of(spec.unit.symbol)}")
                    coloured(head, SCREEN.quiet)
                    grid.addWidget(head, 0, column, Qt.AlignmentFlag.AlignRight)
                    grid.setColumnStretch(column, 1)
                for unused in (field.label, field.unit):
                    if unused is not None:
                        unused.setParent(self._paper)
                        unused.hide()
                grid.addWidget(field.editor, 2 * row, column)
                grid.addWidget(field.message, 2 * row + 1, 0, 1, 4)

    def _points(self, design: Design, index: int) -> None:
        """The points of a spline: a table."""
        self._add_points(self._grid())

    def _table(self, design: Design, index: int) -> None:
        """What the curve does at its ends, where the rows leave it open, and the rows."""
        self._add_points(self._rows(design, index, _ENDS))

    def _add_points(self, grid: QGridLayout) -> None:
        self.points = PointsTable(self._session, self._player)
        self.points.model.error_changed.connect(self.error_changed)
        grid.addWidget(self.points, grid.rowCount(), 0, 1, -1)

    def _computed(self, design: Design, index: int) -> None:
        """Nothing to type."""
        from_files = require_motion(design).follows is not None
        self._sentence(
            "It follows from other files"
            if from_files
            else "It follows from the torque of the drives: change these, or the spring of the balance cam"
        )

    def _grid(self) -> QGridLayout:
        grid = QGridLayout(self._paper)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(2)
        return grid

    def _keep(self, field: Field) -> Field:
        field.setParent(self._paper)  # goes with it
        self.fields[field.spec.path] = field
        return field

    # -- for the view -------------------------------------------------------------------------------------

    def focus_field(self, path: str) -> bool:
        """Bring the entry of a path before the reader; False where it is not here."""
        field = self.fields.get(path)
        if field is not None:
            field.focus()
            return True
        if self.points is not None and ".points" in path:
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
        ComputedCurve: SegmentCurveForm._computed,
    }
)
"""Kind of curve -> what lays out its form."""

__all__ = ["SegmentCurveForm", "crosses", "kind_of_form"]
