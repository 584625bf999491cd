"""The motion as a table of segments, with start and stroke above it."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QMenu,
    QToolButton,
    QVBoxLayout,
)

from core.design import UNITS, Info, entries, insert_segment, remove_segment, stroke, with_assumed
from core.design.fields import LONGEST_MM
from core.study import Study
from kindyna_gui.fields import Field, Spec
from kindyna_gui.look import WRONG, coloured, icon
from kindyna_gui.player import Player
from kindyna_gui.segments_model import LAW, RISE, SPAN, SegmentsModel
from kindyna_gui.segments_table import SegmentsTable
from kindyna_gui.session import Session
from kindyna_gui.view import View
from kindyna_gui.wording import segment_of

_KEYS = {"law": LAW, "span_deg": SPAN, "rise_mm": RISE, "rise_deg": RISE}


class SegmentsView(View):
    """Start, stroke and the segments between."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.model = SegmentsModel(session, self)
        self.table = SegmentsTable(session, self.model)
        self.fields: dict[str, Field] = {}
        self._head = QGridLayout()
        self._head.setContentsMargins(10, 6, 6, 2)
        self._head.setHorizontalSpacing(6)
        self._head.setVerticalSpacing(3)
        self._head.setColumnStretch(1, 1)
        self.message = QLabel(wordWrap=True)
        self.message.setMargin(6)
        coloured(self.message, WRONG)
        self.message.hide()
        foot = QHBoxLayout()
        foot.setContentsMargins(8, 2, 8, 5)
        self.insert_button = self._button("insert", "Insert", "A dwell behind the chosen segment (Ins)", self.insert)
        self.delete_button = self._button("delete", "Delete", "Take the chosen segment away (Del)", self.delete)
        foot.addWidget(self.insert_button)
        foot.addWidget(self.delete_button)
        foot.addStretch(1)
        layout = QVBoxLayout()
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(2)
        layout.addLayout(self._head)
        layout.addWidget(self.table, 1)
        layout.addWidget(self.message)
        layout.addLayout(foot)
        self.set_content_layout(layout)
        self.model.told.connect(self._tell)
        self.table.insert_wanted.connect(self.insert)
        self.table.delete_wanted.connect(self.delete)
        self.table.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.table.customContextMenuRequested.connect(self._open_menu)

    def _button(self, name: str, text: str, tip: str, slot: Any) -> QToolButton:
        button = QToolButton(autoRaise=True)
        button.setText(text)
        button.setIcon(icon(name))
        button.setToolTip(tip)
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        button.clicked.connect(lambda: slot())
        return button

    # -- showing ------------------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        motion = study.design.drive.motion
        specs = self._specs(study)
        if [spec.path for spec in specs] != list(self.fields):
            self._build(specs)
        for field in self.fields.values():
            field.refresh(study.design)
        moves = stroke(motion) != 0.0
        stroke_field = self.fields[f"motion.stroke_{motion.unit}"]
        stroke_field.editor.setEnabled(moves)
        at, count = self.table.currentIndex(), self.model.rowCount()
        place = (at.row(), at.column())
        self.model.show(study)
        if self.model.rowCount() != count or not self.table.currentIndex().isValid():
            self.choose(*place)
        self.delete_button.setEnabled(self.model.rowCount() > 1)

    def _specs(self, study: Study) -> list[Spec]:
        motion = study.design.drive.motion
        info = Info(
            "Stroke",
            "highest minus lowest position; start and rises grow along",
            0.0,
            LONGEST_MM,
            open_low=True,
            step=1.0,
        )
        start = [Spec.of(e) for e in entries(study.design, "motion") if segment_of(e.path) is None]
        path = f"motion.stroke_{motion.unit}"
        return [*start, Spec(path, info, UNITS[motion.unit], lambda d: stroke(d.drive.motion), can_be_assumed=False)]

    def _build(self, specs: list[Spec]) -> None:
        for field in self.fields.values():
            for widget in field.widgets():
                widget.deleteLater()
            field.deleteLater()
        self.fields = {}
        for row, spec in enumerate(specs):
            field = Field(self.session, spec)
            field.setParent(self)
            field.add_to(self._head, 2 * row)
            self.fields[spec.path] = field

    def _tell(self, text: str) -> None:
        self.message.setText(text)
        self.message.setVisible(bool(text))

    # -- changing -----------------------------------------------------------------------------------------

    @property
    def chosen(self) -> int:
        """The chosen segment; the last one where none is."""
        row = self.table.currentIndex().row()
        return row if row >= 0 else self.model.rowCount() - 1

    def choose(self, row: int, column: int = LAW) -> None:
        """Choose a cell."""
        row = max(0, min(row, self.model.rowCount() - 1))
        self.table.setCurrentIndex(self.model.index(row, max(0, column)))

    def insert(self) -> None:
        """A dwell behind the chosen segment, of half its span."""
        row = self.chosen
        if self.session.put(insert_segment(self.session.design, row), f"Insert segment behind segment {row + 1}"):
            self.pull()
            self.choose(row + 1)

    def delete(self) -> None:
        """Take the chosen segment away."""
        row = self.chosen
        if self.model.rowCount() > 1:
            self.session.put(remove_segment(self.session.design, row), f"Delete segment {row + 1}")

    def focus_field(self, path: str) -> bool:
        """Bring the field or cell of a path before the reader; ``motion.start`` will do for ``motion.start_mm``."""
        self.pull()
        for own, field in self.fields.items():
            if own == path or own.rpartition("_")[0] == path:
                field.focus()
                return True
        row = segment_of(path) or 0
        self.choose(row, _KEYS.get(path.rpartition(".")[2], LAW))
        self.table.setFocus(Qt.FocusReason.OtherFocusReason)
        return path.startswith("motion")

    def _open_menu(self, place: QPoint) -> None:
        index = self.table.indexAt(place)
        path = self.model.path(index.row(), index.column()) if index.isValid() else ""
        menu = QMenu(self.table)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        if path and index.column() in (LAW, SPAN, RISE):
            on = path in self.session.design.assumed
            assumed = menu.addAction("Assumed, not taken from a source", lambda: self._assume(path, not on))
            assumed.setCheckable(True)
            assumed.setChecked(on)
            menu.addSeparator()
        menu.addAction(icon("insert"), "Insert segment", self.insert)
        menu.addAction(icon("delete"), "Delete segment", self.delete).setEnabled(self.model.rowCount() > 1)
        menu.popup(self.table.viewport().mapToGlobal(place))

    def _assume(self, path: str, on: bool) -> None:
        key, number = path.rpartition(".")[2].partition("_")[0], segment_of(path) or 0
        text = f"Mark {key} of segment {number + 1} as {'assumed' if on else 'known'}"
        self.session.put(with_assumed(self.session.design, path, on), text)
