"""What is made: tolerances of the design, which of them counts, which to tighten, bands in the plots."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QCheckBox, QLabel, QVBoxLayout, QWidget

from core.design import Design
from core.varying import Made
from core.varying.tolerances import SHARE
from kindyna_gui.documents.bands import scatters
from kindyna_gui.look import coloured
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.studies.rows import ToleranceRows, WaveRow
from kindyna_gui.studies.texts import parts_html, tighter_html

NO_TOLERANCE = "Without tolerances every machine is as designed."


class MadePage(QWidget):
    """The form of the tolerances, and what follows from them for what is asked."""

    def __init__(self) -> None:
        super().__init__()
        self.rows, self.waves = ToleranceRows(), WaveRow()
        self.bands = QCheckBox("Bands in the plots")
        self.bands.setToolTip(
            "Over the cam angle: between which values 90 % of 2000 machines lie, and, paler, 99.73 % (percentiles 0.135 … 99.865)"
        )
        self.tighter, self.parts = QLabel(wordWrap=True), QLabel()
        for label in (self.tighter, self.parts):
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.note = QLabel(wordWrap=True)
        coloured(self.note, SCREEN.quiet)
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 6, 6, 6)
        column.setSpacing(8)
        for part in (self.rows, self.waves, self.bands, self.tighter, self.note, self.parts):
            column.addWidget(part)
        column.addStretch(1)

    def show_design(self, design: Design) -> None:
        """The tolerances of this design."""
        self.rows.show_rows(design)
        self.waves.show_waves(design.waviness)
        self.waves.setVisible(any(drive.cam is not None for drive in design.drives))
        self.bands.setEnabled(scatters(design))

    def show_made(self, design: Design, made: Made | None, sought: bool = False) -> None:
        """What follows from them; None: nothing yet. sought: whether it is known which to tighten."""
        few = made is not None and made.share is not None and made.share.value < SHARE
        text = (
            ""
            if not few
            else tighter_html(design, made)
            if sought and made is not None
            else "Which to tighten is sought …"
        )
        self.tighter.setText(text)
        self.tighter.setVisible(bool(text))
        self.parts.setText("" if made is None else parts_html(design, made))
        self.note.setText(
            NO_TOLERANCE
            if not scatters(design)
            else ""
            if made is None
            else "Part of what each quantity scatters, and its change by one unit more:"
        )
        self.note.setVisible(bool(self.note.text()))


__all__ = ["MadePage"]
