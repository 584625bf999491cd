"""The form of a section of a design: its fields one below the other, and the bar about values that do not fit.

Fields that are seldom needed are folded behind a button, as long as others are shown.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.design import ELEMENT_LISTS, Design, Entry, by_weight, entries, get, is_assumed
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import BACK
from kindyna_gui.forms.fields import COLUMNS, Field, FieldSpec
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import entry_label, heading_of
from kindyna_gui.look import coloured, described, text_button
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import STRETCH, ContentArea, fill, remove_part

LAST_VALID = "The drawing and the plots still show the last valid values."
MOST_REASONS = 3  # in the bar about values that do not fit
POINT_FIELDS = 24  # points of a force table with fields of their own; the full table goes through the clipboard
_STRUCTURE = frozenset({"number", "link", "other", "on", "kind"})
"""Keys of a linkage's structure, which its file, a preset or the Linkage menu sets: no dimensions."""
_NOT_WITH_TABLE = ("force_n", "torque_nm")
_POINT = re.compile(r"\.points\[(\d+)\]")
_OF_ELEMENT = re.compile(rf"loads\.({'|'.join((*ELEMENT_LISTS, 'valve_springs'))})\[")

# -- the bar about values that do not fit ----------------------------------------------------------------


class IncompleteBar(QWidget):
    """A bar that is shown while typed values do not fit together.

    Signals: ``close_requested`` when the button that completes the motion is clicked; ``use_requested`` when that of the
    nearest fitting value is; ``drop_requested`` when the button back to the last valid values is clicked.
    """

    close_requested = Signal()
    use_requested = Signal()
    drop_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.trouble, self.remedy = QLabel(wordWrap=True), QLabel(wordWrap=True)
        coloured(self.trouble, SCREEN.limit)
        coloured(self.remedy, SCREEN.quiet)
        self.close_button, self.drop_button = text_button("Close the motion"), text_button(BACK)
        self.drop_button.setToolTip("Restore the last valid values; Undo returns to what you typed")
        self.use_button = text_button("")
        self.use_button.setToolTip("Enter the nearest value that fits the others")
        for button, signal in (
            (self.close_button, self.close_requested),
            (self.use_button, self.use_requested),
            (self.drop_button, self.drop_requested),
        ):
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            button.clicked.connect(lambda _=False, signal=signal: signal.emit())
        self.remedy.setToolTip(LAST_VALID)
        grid = fill(QGridLayout(self), margins=(10, 2, 6, 3), spacing=2)
        grid.setColumnStretch(0, 1)
        grid.addWidget(self.trouble, 0, 0, 1, 4)
        grid.addWidget(self.remedy, 1, 0, 1, 4)
        for column, button in enumerate((self.close_button, self.use_button, self.drop_button), 1):
            grid.addWidget(button, 2, column)
        self.show_use("")
        self.hide()

    def show_use(self, text: str) -> None:
        """Show the button that enters the nearest fitting value; it is hidden without a text."""
        self.use_button.setText(text)
        self.use_button.setVisible(bool(text))

    def show_reasons(self, reasons: Sequence[str], back: str = BACK, closing: str = "") -> None:
        """Show why the values do not fit, and what would close the motion ('' where no single change does).

        The bar is hidden where there are no reasons; it shows as many as it has room for, and its tip all of them.
        ``back`` is the text of the button to the last valid values.
        """
        more = f" (and {len(reasons) - MOST_REASONS} more)" if len(reasons) > MOST_REASONS else ""
        self.trouble.setText("\n".join(reasons[:MOST_REASONS]) + more)
        self.trouble.setToolTip("\n".join((*reasons, LAST_VALID)))
        self.drop_button.setText(back)
        self.remedy.setText(f"Would close the motion: {closing}")
        self.remedy.setVisible(bool(closing))
        self.close_button.setVisible(bool(closing))
        self.close_button.setToolTip(f"Apply: {closing}" if closing else "")
        self.setVisible(bool(reasons))


# -- the rows of a form ----------------------------------------------------------------------------------


def rows_of(design: Design, section: str) -> list[Entry]:
    """Return the entries of a section that have a row, the most important first."""
    return by_weight(
        row
        for row in entries(design, section)
        if row.path.rpartition(".")[2] not in _STRUCTURE and _is_applicable(design, row)
    )


def _is_applicable(design: Design, row: Entry) -> bool:
    """Whether an entry can be given: an empty one of a load belongs to another attachment or schedule, but for a slide's length."""
    parent, _, key = row.path.rpartition(".")
    if not _OF_ELEMENT.match(row.path):
        return True
    point = _POINT.search(row.path)
    if point is not None and int(point[1]) >= POINT_FIELDS:
        return False
    if row.value is not None:
        return key not in _NOT_WITH_TABLE or not get(design, parent).points
    return key == "length_mm" and get(design, f"{parent}.radius_mm") is None


def spec_of(design: Design, row: Entry) -> FieldSpec:
    """Return the specification of a row: its label with its link or load, and the choices of a sign or a flag."""
    info = replace(row.info, label=entry_label(design, row))
    if row.path.startswith("linkage.branch."):
        info = replace(info, choices=(1, -1))  # type: ignore[arg-type]
    if info.flag:
        info = replace(info, choices=(False, True))  # type: ignore[arg-type]
    return FieldSpec.of(replace(row, info=info))


def _folding(rows: list[Entry]) -> frozenset[str]:
    """Return the paths to fold: fields with their default, if others are shown; none in a list of parts."""
    foldable = frozenset(row.path for row in rows if row.info.folds(row.value) and "[" not in row.path)
    return foldable if 1 < len(foldable) < len(rows) else frozenset()


def part_of(design: Design, section: str) -> Any:
    """Return the table of the design that a form shows; None where a design of this kind has no such table."""
    return design.tables.get(section)


class Heading(QLabel):
    """The heading of the fields below it."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        bold = self.font()
        bold.setBold(True)
        self.setFont(bold)
        self.setContentsMargins(0, 5, 0, 1)


# -- the form --------------------------------------------------------------------------------------------


class Form(QScrollArea):
    """The fields of one section, one below the other.

    Fields are created when the form is first shown, or when one of them is needed: a value is refused, or waits for others.
    Fields with their default are folded behind a button with their number, as long as others are shown. A field with another
    value remains visible until another design is opened.

    Signal ``fields_changed``: other fields were created.

    ``group_of`` returns the group of a path; one group is shown at a time, and typed values in the others remain.
    ``header_of`` returns the widget above the fields of a group, or None.
    """

    fields_changed = Signal()

    def __init__(
        self,
        session: Session,
        section: str,
        group_of: Callable[[str], str] = lambda path: "",
        header_of: Callable[[str], QWidget | None] = lambda group: None,
    ) -> None:
        super().__init__()
        self._group_of, self._header_of, self._group = group_of, header_of, ""
        self._groups: dict[str, QWidget] = {}
        self._session, self._section = session, section
        self._fields: dict[str, Field] = {}
        self._waiting: Design | None = None  # to be shown with the fields
        self._content = ContentArea(session)
        self.setWidget(self._content)
        self._shown: tuple[Any, Any, Any] | None = None
        self._states: dict[str, tuple[Any, bool, bool, str]] = {}  # value, assumed, waiting, misfit
        self._headings: list[str] = []
        self._folded: frozenset[str] = frozenset()
        self._unfolded, self._filter = False, ""
        self._is_other_design = False
        session.started.connect(self._begin)
        session.refused.connect(self._build_for)
        self.more: QToolButton
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)

    @property
    def wanted_height(self) -> int:
        """Height of all fields, without a scroll bar [pixels]."""
        self._catch_up()
        return self._content.sizeHint().height()

    @property
    def is_built(self) -> bool:
        """Whether the form has fields already."""
        return bool(self._fields)

    @property
    def fields(self) -> dict[str, Field]:
        """Fields by their paths, created now where the form has not been shown."""
        self._catch_up()
        return self._fields

    def refresh(self, design: Design) -> None:
        """Show a design now, or when the fields are created."""
        self._waiting = design
        if self.is_built or self.isVisible() or self._session.incomplete is not None:
            self._catch_up()

    def _catch_up(self) -> None:
        design, self._waiting = self._waiting, None
        if design is not None:
            self._refresh(design)

    def _build_for(self, refusal: Refusal) -> None:
        """Create the fields where one of them has to show a refusal."""
        if not self.is_built and any(path.startswith(f"{self._section}.") for path, _, _ in refusal.reasons):
            for field in self.fields.values():
                field.show_refusal(refusal)

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._catch_up()

    def _refresh(self, design: Design) -> None:
        """Create fields only where this kind of design has others, and refresh them only where a value has changed."""
        shown = (part_of(design, self._section), design.assumed, self._session.incomplete)
        before, self._shown = self._shown, shown
        same = before is not None and shown[0] is before[0] and shown[1] == before[1] and shown[2] is before[2]
        if same and not self._is_other_design:
            return
        rows = rows_of(design, self._section)
        headings = [heading_of(design, row.path) for row in rows]
        folded = _folding(rows)
        are_others = False
        if [row.path for row in rows] != list(self._fields) or headings != self._headings:
            self._headings, self._folded = headings, folded
            self._build([spec_of(design, row) for row in rows])
            are_others = True
        elif not self._folded <= folded or self._is_other_design:
            self._folded = folded if self._is_other_design else self._folded & folded
            self._unfolded = self._unfolded and not self._is_other_design
            self._show_rows()
        self._is_other_design = False
        values, misfit = self._valid_values(), self._session.misfit
        for row in rows:
            is_waiting = values is not None and (row.path not in values or values[row.path] != row.value)
            state = row.value, is_assumed(design, row.path), is_waiting, misfit.at(row.path)
            if self._states.get(row.path) != state:
                self._states[row.path] = state
                self._fields[row.path].refresh(design)
        if are_others:
            self.fields_changed.emit()

    def show_defaults(self, defaults: Mapping[str, tuple[str, str]]) -> None:
        """Show by the paths of empty fields the values that apply, with their reasons."""
        for path, field in self._fields.items():
            if isinstance(field.editor, NumberBox):
                field.show_default(*defaults.get(path, ("", "")))

    def _valid_values(self) -> Mapping[str, Any] | None:
        """Return the values of the last valid design, while what is typed does not fit; else None."""
        if self._session.incomplete is None or self._session.is_incomplete_linkage:
            return None
        valid = self._session.valid_holder(self._section)
        if part_of(valid, self._section) is None:
            return {}
        return {row.path: row.value for row in entries(valid, self._section)}

    def _begin(self) -> None:
        self._is_other_design = True

    def _build(self, specs: list[FieldSpec]) -> None:
        """Create fields; on a page without groups those of the same design that were there before only move."""
        groups: dict[str, list[tuple[str, FieldSpec]]] = {}
        for heading, spec in zip(self._headings, specs, strict=True):
            groups.setdefault(self._group_of(spec.path), []).append((heading, spec))
        kept: dict[str, Field] = {}
        if not self._is_other_design and [*groups] == [*self._groups] == [""]:
            kept = {
                s.path: self._fields[s.path] for s in specs if s.path in self._fields and self._fields[s.path].shows(s)
            }
            self._empty(kept)
        else:
            self._begin_page(groups)
        self._fields = {spec.path: kept.get(spec.path) or Field(self._session, spec) for spec in specs}
        self._states = {path: state for path, state in self._states.items() if path in kept}
        for group, rows in groups.items():
            part, before = self._groups[group], ""
            grid = part.layout()
            assert isinstance(grid, QGridLayout)
            grid.setEnabled(False)  # else it is laid out again for each widget that is shown
            header = self._header_of(group)
            if header is not None:
                grid.addWidget(header, 0, 0, 1, COLUMNS)
            for row, (heading, spec) in enumerate(rows):
                if heading and heading != before:
                    grid.addWidget(Heading(heading), 3 * row + 1, 0, 1, COLUMNS)
                before, field = heading, self._fields[spec.path]
                field.setParent(part)  # deleted together
                field.add_to(grid, 3 * row + 2)
        self._show_rows()
        for part in self._groups.values():
            grid = part.layout()
            assert grid is not None
            grid.setEnabled(True)
            grid.invalidate()
        # else the fields are squeezed under the scroll bar
        paper = self._content.content
        assert paper is not None
        self.setMinimumWidth(paper.minimumSizeHint().width() + self.verticalScrollBar().sizeHint().width())

    def _begin_page(self, groups: Iterable[str]) -> None:
        """Begin a page without fields."""
        paper = QWidget()
        column = fill(QVBoxLayout(paper), margins=(10, 7, 6, 6), spacing=0)
        self._groups = {group: QWidget() for group in groups}
        for group, part in self._groups.items():
            grid = fill(QGridLayout(part), margins=0, spacing=(6, 3))
            grid.setColumnStretch(1, 1)
            column.addWidget(part)
            part.setVisible(group == self._group)
        self.more = text_button("", flat=True)
        self.more.clicked.connect(lambda: self._fold(not self._unfolded))
        column.addWidget(self.more)
        column.addStretch(1)
        self._content.replace(paper)

    def _empty(self, kept: Mapping[str, Field]) -> None:
        """Remove headings and fields from the page, but for the fields that are kept."""
        (part,) = self._groups.values()
        grid, removed = part.layout(), QWidget(part)
        assert grid is not None
        while (item := grid.takeAt(0)) is not None:
            if isinstance(heading := item.widget(), Heading):
                heading.setParent(removed)
        for path, field in self._fields.items():
            if path not in kept:
                for child in (field, *field.widgets()):
                    child.setParent(removed)
        remove_part(removed, self._session)

    def _fold(self, unfolded: bool) -> None:
        self._unfolded = unfolded
        self._show_rows()

    def unfold(self, path: str) -> None:
        """Show the field of a path, where it is folded or filtered out."""
        if self._filter and not self._matches_filter(path):
            self.look_for("")
        if path in self._folded and not self._unfolded:
            self._fold(True)

    @property
    def editors(self) -> list[QWidget]:
        """Editors in the order of Tab."""
        return [field.editor for field in self._fields.values()]

    def field_at(self, path: str) -> Field | None:
        """Return the field of a path, else the first field; None where the form is empty."""
        return self.fields.get(path) or next(iter(self.fields.values()), None)

    def look_for(self, words: str) -> int:
        """Show only the fields whose name has all of these words, and return their number."""
        self._filter = words.casefold()
        self._show_rows()
        return sum(self._matches_filter(path) for path in self.fields)

    def _matches_filter(self, path: str) -> bool:
        spec = self.fields[path].spec
        name = f"{spec.info.label} {path}".casefold().replace("_", " ")
        return all(word in name for word in self._filter.split())

    def _show_rows(self) -> None:
        if not self._fields:
            return
        for path, field in self._fields.items():
            shown = self._matches_filter(path) if self._filter else self._unfolded or path not in self._folded
            for widget in field.widgets():
                widget.setVisible(shown)
        self.more.setText("Fewer" if self._unfolded else f"{len(self._folded)} more")
        self.more.setToolTip("More fields")
        self.more.setVisible(not self._filter and any(self._group_of(path) == self._group for path in self._folded))

    def show_group(self, group: str) -> None:
        """Show the fields of this group only."""
        if group != self._group:
            self._group = group
            for name, part in self._groups.items():
                part.setVisible(name == group)
            self._show_rows()
            self.verticalScrollBar().setValue(0)

    @property
    def in_trouble(self) -> bool:
        """Whether a value was refused or does not fit the others."""
        return any(field.trouble for field in self._fields.values())


# -- page with the button of the cam card -------------------------------------------------------------------

EDIT_CARD = "designing.edit_valve_train"
"""Key of the menu entry that the button calls."""


def card_button() -> QPushButton:
    """Return the button that opens the cam card of a design's valves."""
    return described(
        QPushButton("Edit valve train..."),
        tip="Edit inlet and exhaust valve by their cam card: durations, centres, lash, ratio",
    )


class ValvePage(QWidget):
    """A form of a section with the button of the cam card above it.

    Signal ``card_requested``: the button is clicked.
    """

    card_requested = Signal()

    def __init__(self, form: Any) -> None:
        super().__init__()
        self._form: Form = form
        self.button = card_button()
        self.button.clicked.connect(lambda: self.card_requested.emit())
        row = fill(QHBoxLayout(), self.button, STRETCH, margins=(10, 6, 6, 0))
        fill(QVBoxLayout(self), row, (form, 1), margins=0, spacing=0)

    @property
    def editors(self) -> list[QWidget]:
        """Button and editors in the order of Tab."""
        return [self.button, *self._form.editors]
