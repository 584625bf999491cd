"""A table of fields."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QScrollArea, QToolButton, QVBoxLayout, QWidget

from core.design import ELEMENT_LISTS, Design, Entry, by_weight, entries, get, is_assumed
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import COLUMNS, Field, FieldSpec
from kindyna_gui.labels import entry_label, heading_of
from kindyna_gui.look import coloured, text_button
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import Rebuilt

# -- draft bar -------------------------------------------------------------------------------------------

KEPT = "Drawings and plots keep the last that fits."


class IncompleteBar(QWidget):
    """Shown while something does not fit together, hidden else.

    close_requested   the button that makes the motion whole was clicked
    drop_requested    the button back to the last that fitted was clicked
    """

    close_requested = Signal()
    drop_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.trouble, self.remedy = QLabel(wordWrap=True), QLabel(wordWrap=True)
        coloured(self.trouble, SCREEN.limit)
        coloured(self.remedy, SCREEN.quiet)
        self.close_button, self.drop_button = text_button("Close it"), text_button("Drop")
        self.drop_button.setToolTip("Back to the last that fitted together; Undo brings what was typed back")
        for button, signal in ((self.close_button, self.close_requested), (self.drop_button, self.drop_requested)):
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            button.clicked.connect(lambda _=False, signal=signal: signal.emit())
        self.remedy.setToolTip(KEPT)
        grid = QGridLayout(self)
        grid.setContentsMargins(10, 2, 6, 3)
        grid.setSpacing(2)
        grid.setColumnStretch(0, 1)
        grid.addWidget(self.trouble, 0, 0, 1, 3)
        grid.addWidget(self.remedy, 1, 0)
        for column, button in enumerate((self.close_button, self.drop_button), 1):
            grid.addWidget(button, 1, column, Qt.AlignmentFlag.AlignTop)
        self.hide()

    def show_reasons(self, misses: Sequence[str], closing: str = "", tip: Sequence[str] = ()) -> None:
        """Show the sentences of ``misses`` and what would close the motion ('' where nothing simple would); none hides the bar. tip:
        more of it."""
        self.trouble.setText("\n".join(misses))
        self.trouble.setToolTip("\n".join((*tip, KEPT)))
        self.remedy.setText(f"Would close it: {closing}" if closing else KEPT)
        self.close_button.setVisible(bool(closing))
        self.close_button.setToolTip(f"Put in {closing}" if closing else "")
        self.setVisible(bool(misses))


# -- form ------------------------------------------------------------------------------------------------

_STRUCTURE = frozenset({"number", "link", "other", "on", "kind"})
"""What a linkage consists of, rather than its dimensions: it is laid out in its file, begun from a preset, or chosen in the
menu Compo."""
_OF_NO_TABLE = ("force_n", "torque_nm")
POINT_FIELDS = 24  # of a table of force that have fields of their own; the whole goes by the clipboard
_POINT = re.compile(r"\.points\[(\d+)\]")
_OF_ELEMENT = re.compile(rf"loads\.({'|'.join(ELEMENT_LISTS)})\[")


def rows_of(design: Design, section: str) -> list[Entry]:
    """The rows of a section, what matters most first."""
    return by_weight(
        row
        for row in entries(design, section)
        if row.path.rpartition(".")[2] not in _STRUCTURE and _stands(design, row)
    )


def _stands(design: Design, row: Entry) -> bool:
    """Whether an entry can be given as it stands: of a force element those that are left open belong to another way to attach it,
    or to switch it; but a slide may have a length."""
    head, _, key = row.path.rpartition(".")
    if not _OF_ELEMENT.match(row.path):
        return True
    point = _POINT.search(row.path)
    if point is not None and int(point[1]) >= POINT_FIELDS:
        return False
    if row.value is not None:
        return key not in _OF_NO_TABLE or not get(design, head).points
    return key == "length_mm" and get(design, f"{head}.radius_mm") is None


def _spec_of(design: Design, row: Entry) -> FieldSpec:
    """A row of a linkage: named after what it belongs to; a side is chosen of two."""
    info = replace(row.info, label=entry_label(design, row))
    if row.path.startswith("linkage.branch."):
        info = replace(info, choices=(1, -1))  # type: ignore[arg-type]
    if info.flag:
        info = replace(info, choices=(False, True))  # type: ignore[arg-type]
    return FieldSpec.of(replace(row, info=info))


def _folding(rows: list[Entry]) -> frozenset[str]:
    """The paths of what nobody has needed yet, beside fields that stand there; of a list of parts nothing."""
    left = frozenset(row.path for row in rows if row.info.folds(row.value) and "[" not in row.path)
    return left if 1 < len(left) < len(rows) else frozenset()


def part_of(design: Design, section: str) -> Any:
    """The table of the design that a form shows; None where its kind has none of that name."""
    return design.tables.get(section)


class Heading(QLabel):
    """What the fields below belong to."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        bold = self.font()
        bold.setBold(True)
        self.setFont(bold)
        self.setContentsMargins(0, 5, 0, 1)


class Form(QScrollArea):
    """The fields of one section, one below the other.

    What nobody has needed yet is folded away behind a button with its count, as long as other fields stand there; it stays in sight
    once it has another value, until another design begins.

    group_of: path -> the group it belongs to, of which only one is shown at a time; what stands in the fields of the others stays
    head_of: group -> what stands above its fields
    """

    def __init__(
        self,
        session: Session,
        section: str,
        group_of: Callable[[str], str] = lambda path: "",
        head_of: Callable[[str], QWidget | None] = lambda group: None,
    ) -> None:
        super().__init__()
        self._group_of, self._head_of, self._group = group_of, head_of, ""
        self._groups: dict[str, QWidget] = {}
        self._session, self._section = session, section
        self.fields: dict[str, Field] = {}
        self._place = Rebuilt(session)
        self.setWidget(self._place)
        self._shown: tuple[Any, Any, Any] | None = None
        self._values: dict[str, tuple[Any, bool]] = {}
        self._heads: list[str] = []
        self._folded: frozenset[str] = frozenset()
        self._unfolded, self._wanted = False, ""
        self._begun = False  # another design
        session.started.connect(self._begin)
        self.more: QToolButton
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)

    @property
    def wanted_height(self) -> int:
        """Of all fields, without a scroll bar [pixels]."""
        return self._place.sizeHint().height()

    def refresh(self, design: Design) -> None:
        """Show this design; fields are made anew only where another kind of design has others, and left alone
        where they show what they did."""
        shown = (part_of(design, self._section), design.assumed, self._session.incomplete)
        before, self._shown = self._shown, shown
        same = before is not None and shown[0] is before[0] and shown[1] == before[1] and shown[2] is before[2]
        if same and not self._begun:
            return
        anew = before is None or shown[2] is not before[2]  # what waits may be other values
        rows = rows_of(design, self._section)
        heads = [heading_of(design, row.path) for row in rows]
        folded = _folding(rows)
        if [row.path for row in rows] != list(self.fields) or heads != self._heads:
            self._heads, self._values = heads, {}
            self._folded = folded
            self._build([_spec_of(design, row) for row in rows])
        elif not self._folded <= folded or self._begun:
            self._folded = folded if self._begun else self._folded & folded
            self._unfolded = self._unfolded and not self._begun
            self._show_rows()
        self._begun = False
        for row in rows:
            state = row.value, is_assumed(design, row.path)
            if anew or self._values.get(row.path) != state:
                self._values[row.path] = state
                self.fields[row.path].refresh(design)

    def _begin(self) -> None:
        self._begun = True

    def _build(self, specs: list[FieldSpec]) -> None:
        paper = QWidget()
        column = QVBoxLayout(paper)
        column.setContentsMargins(10, 7, 6, 6)
        column.setSpacing(0)
        self.fields, self._groups = {}, {}
        grid, before = QGridLayout(), ""
        for spec, head in zip(specs, self._heads, strict=True):
            group = self._group_of(spec.path)
            if group not in self._groups:
                part = self._groups[group] = QWidget()
                grid, before = _grid(part), ""
                above = self._head_of(group)
                if above is not None:
                    grid.addWidget(above, grid.rowCount(), 0, 1, COLUMNS)
                column.addWidget(part)
                part.setVisible(group == self._group)
            if head and head != before:
                grid.addWidget(Heading(head), grid.rowCount(), 0, 1, COLUMNS)
            before = head
            field = Field(self._session, spec)
            field.setParent(paper)  # goes with it
            field.add_to(grid, grid.rowCount())
            self.fields[spec.path] = field
        self.more = text_button("", flat=True)
        self.more.clicked.connect(lambda: self._fold(not self._unfolded))
        column.addWidget(self.more)
        column.addStretch(1)
        self._place.replace(paper)
        self._show_rows()
        # else the fields are squeezed under the scroll bar
        self.setMinimumWidth(paper.minimumSizeHint().width() + self.verticalScrollBar().sizeHint().width())

    def _fold(self, unfolded: bool) -> None:
        self._unfolded = unfolded
        self._show_rows()

    def unfold(self, path: str) -> None:
        """Show the field of a path, if it is folded away or not among those looked for."""
        if self._wanted and not self._is_wanted(path):
            self.look_for("")
        if path in self._folded and not self._unfolded:
            self._fold(True)

    @property
    def editors(self) -> list[QWidget]:
        """In the order of Tab."""
        return [field.editor for field in self.fields.values()]

    def field_at(self, path: str) -> Field | None:
        """The field of a path, else the first; None where there is none."""
        return self.fields.get(path) or next(iter(self.fields.values()), None)

    def look_for(self, words: str) -> int:
        """Show only the fields whose name has all of these words; how many there are."""
        self._wanted = words.casefold()
        self._show_rows()
        return sum(self._is_wanted(path) for path in self.fields)

    def _is_wanted(self, path: str) -> bool:
        spec = self.fields[path].spec
        name = f"{spec.info.label} {path}".casefold().replace("_", " ")
        return all(word in name for word in self._wanted.split())

    def _show_rows(self) -> None:
        if not self.fields:
            return
        for path, field in self.fields.items():
            shown = self._is_wanted(path) if self._wanted else self._unfolded or path not in self._folded
            for widget in field.widgets():
                widget.setVisible(shown and (widget is not field.message or bool(field.trouble)))
        self.more.setText("Fewer" if self._unfolded else f"{len(self._folded)} more")
        self.more.setToolTip("Fields that are seldom needed, or left open")
        self.more.setVisible(not self._wanted and any(self._group_of(path) == self._group for path in self._folded))

    def show_group(self, group: str) -> None:
        """Show the fields of this group, and of no other."""
        if group != self._group:
            self._group = group
            for name, part in self._groups.items():
                part.setVisible(name == group)
            self._show_rows()
            self.verticalScrollBar().setValue(0)

    @property
    def in_trouble(self) -> bool:
        """Whether a field shows what cannot be."""
        return any(field.trouble for field in self.fields.values())


def _grid(part: QWidget) -> QGridLayout:
    grid = QGridLayout(part)
    grid.setContentsMargins(0, 0, 0, 0)
    grid.setHorizontalSpacing(6)
    grid.setVerticalSpacing(3)
    grid.setColumnStretch(1, 1)
    return grid
