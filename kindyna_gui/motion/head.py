"""Start and stroke of the motion, and its advance where no cam brings it back, side by side."""

from __future__ import annotations

import os
from typing import Any

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
from core.design.fields import LONGEST_MM, MAIN
from core.errors import KindynaError
from core.motion.extremes import true_stroke
from core.output.channels import cycle_line, has_cycle
from core.study import Study
from kindyna_gui.dialogs import FIELD, HELP
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import Field, FieldSpec
from kindyna_gui.labels import segment_of
from kindyna_gui.rebuilt import ContentArea

STROKE = Info(
    "Stroke",
    "highest minus lowest position; start and rises grow along",
    0.0,
    LONGEST_MM,
    open_low=True,
    step=1.0,
    weight=MAIN,
)
NO_STROKE = "Nothing moves yet: give a segment a law and a rise first, then the stroke can be changed."
LEAST, MOST = 74, 150  # width of a number, pixels


def stroke_of(design: Design) -> float:
    """Highest minus lowest position; of a motion that is not whole, of the ends of its segments."""
    motion = require_motion(design)
    try:
        return true_stroke(motion) if span_gap(motion) == 0.0 else stroke(motion)
    except KindynaError:  # a spline whose points contradict each other
        return stroke(motion)


def _shown_stroke(design: Design) -> float:
    """To the digits that extremes are sure of: a stroke that was typed is read as it was."""
    return float(f"{stroke_of(design):.11g}")


def stroke_entry(design: Design) -> Entry:
    """The stroke as an entry of the motion's table; where nothing moves it is 0."""
    unit = require_motion(design).unit
    path = f"motion.stroke_{unit}"
    return Entry(path, STROKE, UNITS[unit], _shown_stroke(design), path)


def origin_texts(follows: Follows) -> tuple[str, str]:
    """Where a motion follows from, in a line, and its files."""
    files = ", ".join(os.path.basename(name) for name in follows.origin.names)
    inverse = follows.origin.inverse
    rows = {
        "from": f"Follows from the table {files}",
        "sum": f"Sum of the motions of {files}",
        "inverse": f"Makes output {inverse.output if inverse else ''} of {files} do what its file asks",
    }
    return rows[follows.origin.key], "\n".join(follows.files)


class StrokeField(Field):
    """The stroke: all levels grow with it."""

    def __init__(self, session: Session, spec: FieldSpec) -> None:
        super().__init__(session, spec)
        self.editor.setProperty(FIELD, None)  # no value of the file
        self.editor.setProperty(HELP, "making#Stroke, above the diagram")

    def edit(self, value: Any, text: str) -> None:
        if not self.obsolete:
            design, now = self.session.typed, stroke_of(self.session.typed)
            changed = with_motion(design, with_stroke(require_motion(design), value, now))
            self.session.lay_out(changed, text, self.spec.path)


class MotionHead(QWidget):
    """The fields that belong to no segment; made anew where the motion has another unit.

    troubles   what is wrong with them, for a place where it pushes nothing aside
    """

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.fields: dict[str, Field] = {}
        self.moves = False  # there is a stroke to be changed
        self._place, self.troubles = ContentArea(session), ContentArea(session)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._place)
        self.origin, self.own_button = QLabel(), QPushButton("Make it a motion of its own")
        self.own_button.setToolTip("Then it can be edited, and no longer follows from these files")
        self.own_button.clicked.connect(self._make_own)
        self._following = QWidget()
        row = QHBoxLayout(self._following)
        row.setContentsMargins(10, 2, 6, 4)
        row.addWidget(self.origin, 1)
        row.addWidget(self.own_button)
        self._following.hide()
        self.cycle = QLabel()
        self.cycle.setContentsMargins(10, 0, 6, 3)
        self.cycle.setToolTip("Over a turn; energy with recovery: less what braking gives back")
        self.cycle.hide()
        column.addWidget(self._following)
        column.addWidget(self.cycle)

    def show_motion(self, design: Design) -> None:
        """Show them of a design's motion."""
        motion = require_motion(design)
        specs = self._specs(design)
        if [spec.path for spec in specs] != list(self.fields):
            self._build(specs)
        for field in self.fields.values():
            field.refresh(design)
        self.moves = stroke_of(design) != 0.0
        field = self.fields[f"motion.stroke_{motion.unit}"]
        field.editor.setEnabled(self.moves)
        field.editor.setToolTip(field.label.toolTip() if self.moves else NO_STROKE)
        self._following.setVisible(motion.follows is not None)
        if motion.follows is not None:
            text, tip = origin_texts(motion.follows)
            self.origin.setText(text)
            self.origin.setToolTip(tip)
        for each in self.fields.values():
            each.editor.setEnabled(motion.follows is None and (self.moves or each is not field))

    def show_cycle(self, study: Study) -> None:
        """The figures of a turn of a motion that no cam makes."""
        text = cycle_line(study) if has_cycle(study) else ""
        self.cycle.setText(text[:1].upper() + text[1:])
        self.cycle.setVisible(bool(text))

    def _make_own(self) -> None:
        from core.project.origins import with_unlinked_motion

        self._session.put(with_unlinked_motion(self._session.design), "Make the motion its own", "motion.segments")

    @staticmethod
    def _specs(design: Design) -> list[FieldSpec]:
        motion = require_motion(design)
        unit = motion.unit
        comes_back = design.drive.cam is not None and motion.advance is None
        start = [
            FieldSpec.of(e)
            for e in entries(design, "motion")
            if segment_of(e.path) is None and not (comes_back and e.path == f"motion.advance_{unit}")
        ]
        path = f"motion.stroke_{unit}"
        return [*start, FieldSpec(path, STROKE, UNITS[unit], _shown_stroke, can_be_assumed=False)]

    def _build(self, specs: list[FieldSpec]) -> None:
        paper, troubles = QWidget(), QWidget()
        below = QVBoxLayout(troubles)
        below.setContentsMargins(0, 0, 0, 0)
        row = QHBoxLayout(paper)
        row.setContentsMargins(10, 5, 6, 2)
        row.setSpacing(10)
        self.fields = {}
        for spec in specs:
            field = (StrokeField if spec.info is STROKE else Field)(self._session, spec)
            field.setParent(paper)  # goes with it
            grid = QGridLayout()
            grid.setHorizontalSpacing(5)
            grid.setVerticalSpacing(2)
            grid.setColumnStretch(1, 1)
            field.add_to(grid, 0, below)
            field.editor.setMinimumWidth(LEAST)  # both stand side by side in a narrow dock
            field.editor.setMaximumWidth(MOST)
            row.addLayout(grid, 1)
            self.fields[spec.path] = field
        row.addStretch(2)
        self._place.replace(paper)
        self.troubles.replace(troubles)

    def focus_field(self, path: str) -> bool:
        """Bring the field of a path before the reader; ``motion.start`` will do for ``motion.start_mm``."""
        for own, field in self.fields.items():
            if own == path or own.rpartition("_")[0] == path:
                field.focus()
                return True
        return False


__all__ = ["MotionHead"]
