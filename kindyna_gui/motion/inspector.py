"""Page of the motion in the inspector: start, stroke, and law, span, rise and curve of the selected segment."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QComboBox, QFrame, QGridLayout, QLabel, QScrollArea, QVBoxLayout, QWidget

from core.design import NO_UNIT, UNITS, Design, Entry, Motion, entries, get, motion_of
from core.design.edits import is_dwell
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import Field, FieldSpec
from kindyna_gui.forms.form import spec_of
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.forms.parameters_view import ParametersView
from kindyna_gui.labels import law_label, segment_of, value_text
from kindyna_gui.look import described
from kindyna_gui.motion.curve_fields import SegmentCurveForm
from kindyna_gui.motion.header import MotionHeader
from kindyna_gui.motion.law_picker import LawBox
from kindyna_gui.motion.segments_table import COLUMNS, LAW
from kindyna_gui.motion.segments_view import SegmentBar, perform
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import STRETCH, ContentArea, connect_all, fill, widget_with
from kindyna_gui.settings import DISPLAY

SPACING = 6  # pixels between a name and its field


class SegmentField(Field):
    """Field of the span or rise of a segment; its undo steps have the names of the table of segments."""

    def _step(self, value: Any) -> str:
        return f"Change {self._name} to {value_text(value, self.spec.unit)}"

    @property
    def _name(self) -> str:
        return f"{self.spec.info.in_sentence} of segment {(segment_of(self.spec.path) or 0) + 1}"


class LawField(SegmentField):
    """Field of the law of a segment, which opens the law picker."""

    def _step(self, value: Any) -> str:
        return f"Change {self._name} to {law_label(value)}"

    def _words(self) -> WordBox:
        return LawBox()

    def edit(self, value: Any, text: str) -> None:
        """Change the law; the same law again is no edit, which would reset its settings."""
        if not self.is_obsolete and value == self.spec.read(self.session.typed):
            self.session.clear_refusal(self.spec.path)
        else:
            super().edit(value, text)


def _specs(design: Design, index: int) -> list[FieldSpec]:
    """Specifications of a segment's fields but those of its curve; none where the segments follow from a lobe."""
    motion = motion_of(design)
    if motion is not None and motion.lobe is not None:
        return []
    prefix = f"motion.segments[{index}]."
    law = f"{prefix}law"
    others = [
        spec_of(design, entry)
        for entry in entries(design, "motion")
        if entry.path.startswith(tuple(f"{prefix}{key}" for key in ("span", "rise", "fixed")))
    ]
    return [FieldSpec.of(Entry(law, COLUMNS[LAW].info, NO_UNIT, get(design, law), law)), *others]


class WindowField(SegmentField):
    """Field that says whether a segment is a process window."""

    def _step(self, value: Any) -> str:
        number = (segment_of(self.spec.path) or 0) + 1
        return f"Make segment {number} a process window" if value else f"Segment {number} is no process window"


FIELDS: Mapping[str, type[SegmentField]] = MappingProxyType({"law": LawField, "fixed": WindowField})
"""Key of the file -> class of its field; other keys have a ``SegmentField``."""


class MotionPage(QScrollArea):
    """Page of the motion, which is updated only while it is visible.

    ``fields_changed`` is emitted when the page shows other fields, ``card_requested`` to open the cam card of a valve train.
    """

    fields_changed = Signal()
    card_requested = Signal()

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__()
        self._session = session
        self._player = player
        self._shown: tuple[Motion, object, int, tuple[str, ...]] | None = None
        self._built = (-1, "", False)
        self.fields: dict[str, Field] = {}
        self.header = MotionHeader(session, is_narrow=True)
        self.segment = described(QComboBox(), name="Segment", tip="Select the segment to edit below")
        self.curve = SegmentCurveForm(session, player)
        self.bar = SegmentBar()
        self._segment_area = ContentArea(session)
        self._rows: dict[str, Field] = {}
        label = QLabel("Segment ")
        label.setBuddy(self.segment)
        self._indent = label.sizeHint().width()
        chooser = fill(QGridLayout(), margins=(10, 6, 6, 0))
        chooser.setHorizontalSpacing(SPACING)
        chooser.addWidget(label, 0, 0)
        chooser.addWidget(self.segment, 0, 1)
        chooser.setColumnStretch(1, 1)
        paper = widget_with(
            fill(
                QVBoxLayout(),
                self.header,
                chooser,
                self._segment_area,
                self.curve,
                self.bar,
                STRETCH,
                margins=(0, 0, 0, 4),
                spacing=1,
            )
        )
        self.setWidget(paper)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        connect_all(
            (self.segment.activated, session.choose_segment),
            (self.bar.action_requested, self._act),
            (self.header.card_requested, self.card_requested),
            (session.segment_chosen, self._show_soon),
            (DISPLAY.changed, self._show_anew),
        )

    @property
    def in_trouble(self) -> bool:
        """Whether a field shows a value that is not possible."""
        return any(field.trouble for field in self.fields.values())

    def refresh(self, design: Design) -> None:
        """Show the motion of the design as typed, once the page is visible."""
        self._show_soon()

    def _show_soon(self) -> None:
        if self.isVisible():
            self._show()

    def _show_anew(self) -> None:
        self._shown = None
        self._show_soon()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._show()

    def _show(self) -> None:
        design, index, before = self._session.typed, self._session.segment, self._shown
        motion = motion_of(design)
        if motion is None:
            return
        shown = self._shown = (motion, self._session.incomplete, index, design.assumed)
        if before is not None and before[0] is motion and before[1] is shown[1] and before[2:] == shown[2:]:
            return
        self.header.show_motion(design)
        names = [
            f"{number}  {law_label(segment.curve.law)}, {value_text(segment.span_deg, UNITS['deg'])}"
            for number, segment in enumerate(motion.segments, 1)
        ]
        with QSignalBlocker(self.segment):
            if names != [self.segment.itemText(i) for i in range(self.segment.count())]:
                self.segment.clear()
                self.segment.addItems(names)
            self.segment.setCurrentIndex(index)
        built = index, motion.unit, motion.lobe is not None
        if self._built != built:
            self._built = built
            self._build(_specs(design, index))
        self.curve.show_segment(design, index)
        self.bar.show_segment(design, index)
        for field in self._rows.values():
            field.refresh(design)
        fixed = motion.is_computed or self._session.is_on_balancer
        for path, field in self._rows.items():
            field.editor.setEnabled(not fixed and not (".rise" in path and is_dwell(motion.segments[index])))
        self.curve.setEnabled(not fixed)
        fields = {**self.header.fields, **self._rows, **self.curve.fields}
        if list(fields.values()) != list(self.fields.values()):
            self.fields = fields
            self.fields_changed.emit()

    def _build(self, specs: list[FieldSpec]) -> None:
        paper = QWidget()
        grid = fill(QGridLayout(paper), margins=(10, 3, 6, 0), spacing=(SPACING, 3))
        grid.setColumnMinimumWidth(0, self._indent)
        grid.setColumnStretch(1, 1)
        self._rows = {}
        for spec in specs:
            field = FIELDS.get(spec.path.rpartition(".")[2], SegmentField)(self._session, spec)
            field.setParent(paper)  # deleted together
            field.add_to(grid, grid.rowCount())
            self._rows[spec.path] = field
        self._segment_area.replace(paper)

    def _act(self, name: str, _: object) -> None:
        chosen = perform(self._session, name, self._session.segment, self._player.theta)
        if chosen is not None:
            self._session.choose_segment(chosen)

    @property
    def editors(self) -> list[QWidget]:
        """Editors in the order of Tab."""
        of_header = [field.editor for field in self.header.fields.values()]
        of_segment = [field.editor for field in (*self._rows.values(), *self.curve.fields.values())]
        return [*of_header, self.segment, *of_segment, *self.bar.buttons.values()]

    # -- interface of the pages of the inspector ---------------------------------------------------------

    def look_for(self, words: str) -> int:
        """Nothing is hidden here; how many of the fields have all of these words in their names."""
        self._show()
        names = [f"{field.spec.info.label} {path}".casefold().replace("_", " ") for path, field in self.fields.items()]
        return sum(all(word in name for word in words.casefold().split()) for name in names)

    def unfold(self, path: str) -> None:
        """Show the segment of a path."""
        index = segment_of(path)
        if index is not None:
            self._session.choose_segment(index)

    def field_at(self, path: str) -> Field | None:
        """Show the segment of a path and return the field; None for a path without a field, such as a point of a table.

        ``motion.start`` is enough for ``motion.start_mm``; the path of a segment gives its span.
        """
        self.unfold(path)
        self._show()
        match = next((field for name, field in self.fields.items() if path in (name, name.rpartition("_")[0])), None)
        if match is None and segment_of(path) is None:
            return next(iter(self.fields.values()), None)
        return match or self.fields.get(f"{path}.span_deg")


def inspector(session: Session, player: Player) -> ParametersView:
    """Parameters of a design, with the page of its motion."""
    return ParametersView(session, player, {"motion": MotionPage(session, player)})


__all__ = ["MotionPage", "inspector"]
