"""The bar of what does not fit together yet: what is missing, and two buttons, to close a motion or to go back."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QWidget

from kindyna_gui.look import coloured, text_button
from kindyna_gui.pictures.style import SCREEN

KEPT = "Drawings and plots keep the last that fits."


class DraftBar(QWidget):
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

    def show_draft(self, misses: Sequence[str], closing: str = "", tip: Sequence[str] = ()) -> None:
        """Show the sentences of ``misses`` and what would close the motion ('' where nothing simple would); none hides the bar. tip:
        more of it."""
        self.trouble.setText("\n".join(misses))
        self.trouble.setToolTip("\n".join((*tip, KEPT)))
        self.remedy.setText(f"Would close it: {closing}" if closing else KEPT)
        self.close_button.setVisible(bool(closing))
        self.close_button.setToolTip(f"Put in {closing}" if closing else "")
        self.setVisible(bool(misses))


__all__ = ["DraftBar"]
