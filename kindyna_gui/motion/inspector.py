"""The motion in the inspector: start and stroke, and of the chosen segment law, span, rise and what its curve takes."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QComboBox, QFrame, QGridLayout, QLabel, QScrollArea, QVBoxLayout, QWidget

from core.design import NO_UNIT, UNITS, Design, Entry, Motion, Segment, entries, get, motion_of
from core.design.edits import is_dwell
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import Field, FieldSpec
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.forms.parameters_view import ParametersView
from kindyna_gui.labels import law_label, segment_of, value_text
from kindyna_gui.motion.curve_fields import SegmentCurveForm
from kindyna_gui.motion.head import MotionHead
from kindyna_gui.motion.law_picker import LawBox
from kindyna_gui.motion.segments_table import COLUMNS, LAW
from kindyna_gui.motion.segments_view import SegmentBar, perform
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import ContentArea
from kindyna_gui.settings import DISPLAY

SPACING = 6  # pixels between a name and its field


class SegmentField(Field):
    """Span or rise of a segment; its steps are called as in the table of segments."""

    def _step(self, value: Any) -> str:
        return f"Change {self._named} to {value_text(value, self.spec.unit)}"

    @property
    def _named(self) -> str:
        return f"{self.spec.info.in_sentence} of segment {(segment_of(self.spec.path) or 0) + 1}"


class LawField(SegmentField):
    """The law of a segment, picked from pictures."""

    def _step(self, value: Any) -> str:
        return f"Change {self._named} to {law_label(value)}"

    def _words(self) -> WordBox:
        return LawBox()

    def edit(self, value: Any, text: str) -> None:
        """The law that is there already is no edit: what was set of it would be lost."""
        if not self.obsolete and value == self.spec.read(self.session.typed):
            self.session.clear_refusal(self.spec.path)
        else:
            super().edit(value, text)


def _specs(design: Design, index: int) -> list[FieldSpec]:
    """Law, span and rise of a segment."""
    head = f"motion.segments[{index}]"
    law = f"{head}.law"
    of_segment = [
        FieldSpec.of(entry)
        for entry in entries(design, "motion")
        if entry.path.startswith(f"{head}.") and entry.path.rpartition(".")[2].startswith(("span", "rise"))
    ]
    return [FieldSpec.of(Entry(law, COLUMNS[LAW].info, NO_UNIT, get(design, law), law)), *of_segment]


def _name(number: int, segment: Segment) -> str:
    """A segment as the list of them names it."""
    return f"{number}  {law_label(segment.curve.law)}, {value_text(segment.span_deg, UNITS['deg'])}"


class MotionPage(QScrollArea):
    """The page of the motion; what it shows is made once it is in sight, and follows only while it is.

    fields_changed   others stand there than before
    """

    fields_changed = Signal()

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__()
        self._session = session
        self._player = player
        self._shown: tuple[Motion, object, int, tuple[str, ...]] | None = None
        self._built = (-1, "")
        self.fields: dict[str, Field] = {}
        self.head = MotionHead(session)
        self.which = QComboBox()
        self.which.setAccessibleName("Segment")
        self.which.setToolTip("The segment whose law, span and rise stand below")
        self.curve = SegmentCurveForm(session, player)
        self.bar = SegmentBar()
        self._place = ContentArea(session)
        self._rows: dict[str, Field] = {}
        label = QLabel("Segment ")
        label.setBuddy(self.which)
        self._indent = label.sizeHint().width()
        chooser = QGridLayout()
        chooser.setContentsMargins(10, 6, 6, 0)
        chooser.setHorizontalSpacing(SPACING)
        chooser.addWidget(label, 0, 0)
        chooser.addWidget(self.which, 0, 1)
        chooser.setColumnStretch(1, 1)
        paper = QWidget()
        column = QVBoxLayout(paper)
        column.setContentsMargins(0, 0, 0, 4)
        column.setSpacing(1)
        column.addWidget(self.head)
        column.addWidget(self.head.troubles)
        column.addLayout(chooser)
        column.addWidget(self._place)
        column.addWidget(self.curve)
        column.addWidget(self.bar)
        column.addStretch(1)
        self.setWidget(paper)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.which.activated.connect(session.choose_segment)
        self.bar.wanted.connect(self._act)
        session.segment_chosen.connect(self._show_soon)
        DISPLAY.changed.connect(self._show_anew)

    @property
    def in_trouble(self) -> bool:
        """Whether a field shows what cannot be."""
        return any(field.trouble for field in self.fields.values())

    def refresh(self, design: Design) -> None:
        """Show the motion of the design as typed, as soon as the page is in sight."""
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
        self.head.show_motion(design)
        names = [_name(number, segment) for number, segment in enumerate(motion.segments, 1)]
        with QSignalBlocker(self.which):
            if names != [self.which.itemText(i) for i in range(self.which.count())]:
                self.which.clear()
                self.which.addItems(names)
            self.which.setCurrentIndex(index)
        if self._built != (index, motion.unit):
            self._built = index, motion.unit
            self._build(_specs(design, index))
        self.curve.show_segment(design, index)
        self.bar.show_segment(design, index)
        for field in self._rows.values():
            field.refresh(design)
        fixed = motion.follows is not None or self._session.on_balancer
        for path, field in self._rows.items():
            field.editor.setEnabled(not fixed and not (".rise" in path and is_dwell(motion.segments[index])))
        self.curve.setEnabled(not fixed)
        every = {**self.head.fields, **self._rows, **self.curve.fields}
        if list(every.values()) != list(self.fields.values()):
            self.fields = every
            self.fields_changed.emit()

    def _build(self, specs: list[FieldSpec]) -> None:
        paper = QWidget()
        grid = QGridLayout(paper)
        grid.setContentsMargins(10, 3, 6, 0)
        grid.setHorizontalSpacing(SPACING)
        grid.setColumnMinimumWidth(0, self._indent)
        grid.setVerticalSpacing(3)
        grid.setColumnStretch(1, 1)
        self._rows = {}
        for spec in specs:
            field = (LawField if spec.info.choices else SegmentField)(self._session, spec)
            field.setParent(paper)  # goes with it
            field.add_to(grid, grid.rowCount())
            self._rows[spec.path] = field
        self._place.replace(paper)

    def _act(self, name: str, _: object) -> None:
        chosen = perform(self._session, name, self._session.segment, self._player.theta)
        if chosen is not None:
            self._session.choose_segment(chosen)

    @property
    def editors(self) -> list[QWidget]:
        """In the order of Tab."""
        below = [field.editor for field in (*self._rows.values(), *self.curve.fields.values())]
        heads = [field.editor for field in self.head.fields.values()]
        return [*heads, self.which, *below, *self.bar.buttons.values()]

    # -- as the other pages of the inspector ----------------------------------------------------------------

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
        """The field of a path, whose segment is then shown; ``motion.start`` will do for ``motion.start_mm``. Of a segment as a whole
        its span; None of what has none, a point of a table."""
        self.unfold(path)
        self._show()
        named = next((field for own, field in self.fields.items() if path in (own, own.rpartition("_")[0])), None)
        if named is None and segment_of(path) is None:
            return next(iter(self.fields.values()), None)
        return named or self.fields.get(f"{path}.span_deg")


def inspector(session: Session, player: Player) -> ParametersView:
    """The parameters of a design, its motion among them."""
    return ParametersView(session, player, {"motion": MotionPage(session, player)})


__all__ = ["MotionPage", "inspector"]
