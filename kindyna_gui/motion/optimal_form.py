"""Rows of an optimal law in the form of a segment: aim, ends, limits, cycles and obstacles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QLineEdit, QScrollArea, QVBoxLayout, QWidget

from core.design import NO_UNIT, CurveBound, Design, entries, get, put, require_motion
from core.design.curves import least_limit
from core.number_text import shortest
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import Field, FieldSpec
from kindyna_gui.forms.number_box import parsed, row_height
from kindyna_gui.forms.refusal import NO_REMEDIES, FloatingRefusal, Remedies
from kindyna_gui.labels import segment_of
from kindyna_gui.look import described
from kindyna_gui.rebuilt import fill
from kindyna_gui.settings import point

LEFT, RIGHT = 0, 3  # columns of a grid at which the two halves begin
ROWS: tuple[tuple[str, int, int], ...] = (
    ("minimise", 0, LEFT), ("start", 1, LEFT), ("end", 2, LEFT), ("intervals", 3, LEFT),
    ("limits.velocity", 0, RIGHT), ("limits.acceleration", 1, RIGHT), ("limits.jerk", 2, RIGHT),
)  # fmt: skip
"""Key of a field, and its row and half of the grid."""
LISTS: tuple[tuple[str, str, int, int, int, str], ...] = (
    ("vibration_free", "Vibration-free", 1, 3, RIGHT,
     "Cycles a span of undamped followers that are at rest after it, such as 3.3; several with semicolons"),
    ("below", "Below", 3, 4, LEFT,
     "Obstacles that the law passes below: from, to and most of the rise, as fractions, such as 0 0.5 0.35; several with semicolons"),
    ("above", "Above", 3, 4, RIGHT,
     "Obstacles that the law passes above: from, to and least of the rise, as fractions, such as 0.6 1 0.7; several with semicolons"),
)  # fmt: skip
"""Key of a list, its name, numbers a row, row and half of the grid, and its tip."""


def limit_step(path: str, limit: float) -> str:
    """Name of the undo step that changes a limit."""
    return f"Change {path.rpartition('.')[2]} limit of segment {(segment_of(path) or 0) + 1} to {shortest(limit)}"


def refusal_of_limit(session: Session, typed: Design, path: str) -> tuple[str, Remedies]:
    """Why no law keeps a limit of a typed design, and a button that takes the least one; empty where a law keeps it."""
    index, name = segment_of(path) or 0, path.rpartition(".")[2]
    limit, least = get(typed, path), least_limit(require_motion(typed), index, name)
    if limit is None or least is None or least <= limit:
        return "", NO_REMEDIES

    def use() -> None:
        session.end_gesture()
        session.edit(path, least, limit_step(path, least))
        session.end_gesture()

    text = f"No law keeps a {name} limit of {shortest(limit)} together with the other limits; the least one is {shortest(least)}"
    return text, {f"Use {shortest(least)}": use}


def scrolled_grid(paper: QWidget) -> QGridLayout:
    """Grid of rows that scroll where a form is lower than all of them."""
    inner, area = QWidget(), QScrollArea(widgetResizable=True)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setWidget(inner)
    area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    fill(QVBoxLayout(paper), area, margins=0)
    return fill(QGridLayout(inner), margins=(0, 0, 4, 0), spacing=(6, 2))


def add_rows(
    session: Session, design: Design, index: int, grid: QGridLayout, register: Callable[[FieldSpec], Field]
) -> list[ListLine]:
    """Add the rows of an optimal law to a grid; returns the lines of its lists."""
    path = f"motion.segments[{index}]"
    specs = {entry.path: entry for entry in entries(design, "motion") if segment_of(entry.path) == index}
    for key, row, column in ROWS:
        field = register(replace(FieldSpec.of(specs[f"{path}.{key}"]), can_be_assumed=False))
        grid.addWidget(field.label, row, column)
        grid.addWidget(field.editor, row, column + 1)
        field.editor.setMinimumWidth(1)
        if field.unit is not None:
            field.unit.setParent(field.editor)
            field.unit.hide()
    lines = []
    for key, name, count, row, column, tip in LISTS:
        line = ListLine(session, f"{path}.{key}", name, count, tip)
        label = described(QLabel(name), tip=tip)
        label.setBuddy(line)
        grid.addWidget(label, row, column)
        grid.addWidget(line, row, column + 1)
        lines.append(line)
    for row in range(1 + max(row for _, row, _ in ROWS) + 1):
        grid.setRowMinimumHeight(row, row_height(lines[0]))
    for column in (LEFT + 1, RIGHT + 1):
        grid.setColumnStretch(column, 1)
    return lines


class ListLine(QLineEdit):
    """Line with rows of numbers: the numbers separated by spaces, the rows by semicolons."""

    def __init__(self, session: Session, path: str, name: str, count: int, tip: str) -> None:
        super().__init__()
        self._session, self.path, self._name, self._count = session, path, name, count
        described(self, tip=tip)
        self.setAccessibleName(name)
        self.setPlaceholderText("none")
        self.setMinimumWidth(1)
        self.editingFinished.connect(self._enter)
        session.refused.connect(lambda refusal: self._show_refusal(refusal.at(self.path)))
        session.accepted.connect(lambda path: self._show_refusal("") if path == self.path else None)

    @cached_property
    def refusal(self) -> FloatingRefusal:
        """The refusal of a text, created with the first one."""
        return FloatingRefusal(self)

    def _show_refusal(self, text: str) -> None:
        if text or "refusal" in vars(self):
            self.refusal.show_refusal(text, NO_REMEDIES)

    def show_design(self, design: Design) -> None:
        """Show the list of a design, unless a text is being typed."""
        if not self.isModified():
            self.setText(self._text(get(design, self.path)))

    def _text(self, rows: Sequence[Any]) -> str:
        numbers = [(row.start, row.end, row.rise) if isinstance(row, CurveBound) else (row,) for row in rows]
        text = "; ".join(" ".join(shortest(value) for value in row) for row in numbers)
        return text.replace(".", point())

    def _enter(self) -> None:
        if not self.isModified():
            return
        rows = [text.split() for text in self.text().split(";") if text.strip()]
        numbers = [[number for token in row if (number := parsed(token, NO_UNIT)) is not None] for row in rows]
        if any(not len(row) == len(typed) == self._count for row, typed in zip(numbers, rows, strict=True)):
            wanted = "one number" if self._count == 1 else f"{self._count} numbers"
            self._session.refuse(self.path, f"{self.text()}: enter {wanted} a row, and semicolons between rows")
            return
        self.setModified(False)
        value: Any = tuple(CurveBound(*row) if self._count > 1 else row[0] for row in numbers)
        design = put(self._session.typed, self.path, value)
        self._session.end_gesture()
        self._session.lay_out(design, f"Change {self._name.lower()} to {self.text() or 'none'}", self.path)
        self._session.end_gesture()
