"""Rows of an optimal law in the form of a segment: aim, ends and limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QScrollArea, QVBoxLayout, QWidget

from core.design import Design, entries, get, require_motion
from core.design.curves import least_limit
from core.number_text import shortest
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import Field, FieldSpec
from kindyna_gui.forms.number_box import row_height
from kindyna_gui.forms.refusal import NO_REMEDIES, Remedies
from kindyna_gui.labels import segment_of
from kindyna_gui.look import coloured
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import fill

LOCAL = "Local: best of searches from five laws"
LEFT, RIGHT = 0, 3  # columns of a grid at which the two halves begin
ROWS: tuple[tuple[str, int, int], ...] = (
    ("minimise", 0, LEFT), ("start", 1, LEFT), ("end", 2, LEFT), ("intervals", 3, LEFT),
    ("limits.velocity", 0, RIGHT), ("limits.acceleration", 1, RIGHT), ("limits.jerk", 2, RIGHT),
)  # fmt: skip
"""Key of a field, and its row and half of the grid."""


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


def add_rows(design: Design, index: int, grid: QGridLayout, register: Callable[[FieldSpec], Field]) -> QLabel:
    """Add the rows of an optimal law to a grid; returns the note of a law that is optimal in its machine."""
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
        grid.setRowMinimumHeight(row, row_height(field.editor))
    for column in (LEFT + 1, RIGHT + 1):
        grid.setColumnStretch(column, 1)
    note = coloured(QLabel(LOCAL), SCREEN.quiet)
    grid.addWidget(note, 3, RIGHT, 1, 2)
    return note
