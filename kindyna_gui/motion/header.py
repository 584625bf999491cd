"""Start and stroke of the motion, its advance if no cam returns it, and the figures of a turn."""

from __future__ import annotations

import os
from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from core.design import (
    UNITS,
    Design,
    Entry,
    Follows,
    Info,
    entries,
    require_motion,
    span_gap,
    stroke,
    with_motion,
    with_stroke,
)
from core.design.curves import unsolved_segment
from core.design.fields import LONGEST_MM, MAIN
from core.errors import KindynaError
from core.motion.extremes import true_stroke
from core.output.channels import cycle_line, has_cycle
from core.study import Study
from kindyna_gui.dialogs import FIELD, HELP
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import Field, FieldSpec
from kindyna_gui.forms.form import card_button
from kindyna_gui.labels import segment_of, sentence
from kindyna_gui.look import described
from kindyna_gui.rebuilt import STRETCH, ContentArea, fill, widget_with

STROKE = Info(
    "Stroke",
    "highest minus lowest position; a new stroke scales start and rises",
    0.0,
    LONGEST_MM,
    open_low=True,
    step=1.0,
    weight=MAIN,
)
NO_STROKE = "The motion has no stroke yet: give a segment a law and a rise first."
LEAST_WIDTH, MOST_WIDTH = 74, 150  # of a number, pixels
IN_A_ROW = 3  # fields next to each other


def stroke_of(design: Design) -> float:
    """Highest minus lowest position; of an incomplete motion, or while its laws are calculated, of the ends of its segments."""
    motion = require_motion(design)
    is_known = span_gap(motion) == 0.0 and unsolved_segment(motion) is None
    try:
        return true_stroke(motion) if is_known else stroke(motion)
    except KindynaError:  # a spline whose points contradict each other
        return stroke(motion)


def _shown_stroke(design: Design) -> float:
    """Stroke without rounding errors, so that a typed stroke is shown as typed."""
    return float(f"{stroke_of(design):.11g}")


def stroke_entry(design: Design) -> Entry:
    """The stroke as an entry of the motion; 0 if no segment moves."""
    unit = require_motion(design).unit
    path = f"motion.stroke_{unit}"
    return Entry(path, STROKE, UNITS[unit], _shown_stroke(design), path)


def origin_texts(follows: Follows) -> tuple[str, str]:
    """Line that says what a motion follows from, and the list of its files."""
    files = ", ".join(os.path.basename(name) for name in follows.origin.names)
    inverse = follows.origin.inverse
    rows = {
        "from": f"Follows from the table {files}",
        "sum": f"Sum of the motions of {files}",
        "inverse": f"Makes output {inverse.output if inverse else ''} of {files} follow the motion in its file",
    }
    return rows[follows.origin.key], "\n".join(follows.files)


LOBE_TEXTS = ("Follows from a lobe", "Lift, durations, ramp and flats give its segments")


class StrokeField(Field):
    """Field of the stroke, which scales all levels."""

    def __init__(self, session: Session, spec: FieldSpec) -> None:
        super().__init__(session, spec)
        self.editor.setProperty(FIELD, None)  # not in the file
        self.editor.setProperty(HELP, "making#Stroke, above the diagram")

    @property
    def is_waiting(self) -> bool:
        """Whether the levels at the ends of the segments wait; between them an incomplete motion is not known."""
        return self.session.is_waiting(self.spec.path, lambda design: stroke(require_motion(design)))

    def _show(self, design: Design) -> None:
        super()._show(design if self.is_waiting else self.session.design)

    def edit(self, value: Any, text: str) -> None:
        if not self.is_obsolete:
            design = self.session.typed
            changed = with_motion(design, with_stroke(require_motion(design), value, stroke_of(design)))
            self.session.lay_out(changed, text, self.spec.path)


class MotionHeader(QWidget):
    """The fields that belong to no segment; built again when the motion has another unit.

    With ``is_narrow`` more fields than fit in a row are one below the other, and the buttons below their text.

    Signal ``card_requested``: the button that opens the cam card of a valve train is clicked.
    """

    card_requested = Signal()

    def __init__(self, session: Session, is_narrow: bool = False) -> None:
        super().__init__()
        self._session, self._is_narrow = session, is_narrow
        self.fields: dict[str, Field] = {}
        self.has_stroke = False
        self._fields_area = ContentArea(session)
        self.origin, self.unlink_button = QLabel(), QPushButton("Unlink from the files")
        self.unlink_button.setToolTip("Keep the motion as it is now, and edit it here")
        self.unlink_button.clicked.connect(self._unlink)
        self.card_button = card_button()
        self.card_button.clicked.connect(lambda: self.card_requested.emit())
        buttons = fill(
            QHBoxLayout(), self.card_button, self.unlink_button, *([STRETCH] if is_narrow else []), margins=0
        )
        row = QVBoxLayout() if is_narrow else QHBoxLayout()
        self._following = widget_with(fill(row, (self.origin, 1), buttons, margins=(10, 2, 6, 4)))
        self._following.hide()
        self.cycle = described(
            QLabel(), tip="Figures of one turn; energy with recovery is reduced by the energy of braking"
        )
        self.cycle.setContentsMargins(10, 0, 6, 3)
        self.cycle.hide()
        parts = (self._following, self._fields_area) if is_narrow else (self._fields_area, self._following)
        fill(QVBoxLayout(self), *parts, self.cycle, margins=0)

    def show_motion(self, design: Design) -> None:
        """Show the values of a design's motion."""
        motion = require_motion(design)
        specs = self._specs(design)
        if [spec.path for spec in specs] != list(self.fields):
            self._build(specs)
        for field in self.fields.values():
            field.refresh(design)
        self.has_stroke = stroke_of(design) != 0.0
        stroke_field = self.fields[f"motion.stroke_{motion.unit}"]
        stroke_field.editor.setToolTip(stroke_field.label.toolTip() if self.has_stroke else NO_STROKE)
        self._following.setVisible(motion.is_computed)
        self.card_button.setVisible(motion.lobe is not None and design.drive.valve is not None)
        if motion.is_computed:
            text, tip = LOBE_TEXTS if motion.follows is None else origin_texts(motion.follows)
            self.origin.setText(text)
            self.origin.setToolTip(tip)
            self.unlink_button.setText("Lobe to segments" if motion.follows is None else "Unlink from the files")
        for field in self.fields.values():
            field.editor.setEnabled(motion.follows is None and (self.has_stroke or field is not stroke_field))

    def show_cycle(self, study: Study) -> None:
        """Show the figures of a turn of a motion without a cam."""
        text = sentence(cycle_line(study)) if has_cycle(study) else ""
        self.cycle.setText(text)
        self.cycle.setVisible(bool(text))

    def _unlink(self) -> None:
        from core.motion.tables import lobe_to_segments
        from core.project.origins import with_unlinked_motion

        design = self._session.design
        if require_motion(design).follows is None:
            self._session.put(lobe_to_segments(design), "Lobe to segments", "motion.segments")
        else:
            self._session.put(with_unlinked_motion(design), "Unlink the motion from its files", "motion.segments")

    @staticmethod
    def _specs(design: Design) -> list[FieldSpec]:
        motion = require_motion(design)
        unit = motion.unit
        returns = design.drive.has_disk and motion.advance is None
        start = [
            FieldSpec.of(e)
            for e in entries(design, "motion")
            if segment_of(e.path) is None and not (returns and e.path == f"motion.advance_{unit}")
        ]
        path = f"motion.stroke_{unit}"
        return [*start, FieldSpec(path, STROKE, UNITS[unit], _shown_stroke, can_be_assumed=False)]

    def _build(self, specs: list[FieldSpec]) -> None:
        paper = QWidget()
        rows = fill(QGridLayout(paper), margins=(10, 5, 6, 2), spacing=(10, 4))
        self.fields = {}
        columns = 1 if self._is_narrow and len(specs) > IN_A_ROW else min(len(specs), IN_A_ROW)
        for i, spec in enumerate(specs):
            field = (StrokeField if spec.info is STROKE else Field)(self._session, spec)
            field.setParent(paper)  # deleted together
            grid = fill(QGridLayout(), spacing=(5, 2))
            grid.setColumnStretch(1, 1)
            field.add_to(grid, 0)
            field.editor.setMinimumWidth(LEAST_WIDTH)  # two fit next to each other in a narrow dock
            field.editor.setMaximumWidth(MOST_WIDTH)
            rows.addLayout(grid, i // columns, i % columns)
            self.fields[spec.path] = field
        for column in range(columns):
            rows.setColumnStretch(column, 1)
        rows.setColumnStretch(columns, 2)
        self._fields_area.replace(paper)

    def focus_field(self, path: str) -> bool:
        """Show and focus the field of a path; ``motion.start`` is enough for ``motion.start_mm``."""
        for field_path, field in self.fields.items():
            if path in (field_path, field_path.rpartition("_")[0]):
                field.focus()
                return True
        return False


__all__ = ["MotionHeader"]
