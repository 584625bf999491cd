"""The circuits of a linkage as pictures, of which one is chosen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLabel, QVBoxLayout, QWidget

from core.design import Design
from core.design.topology import driver_turns
from core.mechanism.drivers import Circuit
from kindyna_gui.dialogs import give_help
from kindyna_gui.documents.as_command import add_copy
from kindyna_gui.look import coloured
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.window.gallery import BELOW, BESIDE, MOST_COLUMNS, THUMBS, GalleryChoice, Pictures


def _choice(number: int, circuit: Circuit) -> GalleryChoice:
    ends = np.array([circuit.range.low, circuit.range.high])
    turns = driver_turns(circuit.design.drive.linkage)
    low, high = np.rad2deg(ends) if turns else 1e3 * ends
    span = f"driver {low:.4g} ... {high:.4g} {'°' if turns else 'mm'}"
    own = " (as it is now)" if circuit.is_current else ""
    return GalleryChoice(f"{number}: {span}{own}", f"Circuit {number}: {span}{own}", lambda: circuit.design)


class CircuitsDialog(QDialog):
    """A picture of each circuit with the range of its driver; chosen: the circuit whose picture was double clicked or taken."""

    def __init__(self, parent: QWidget, found: Sequence[Circuit]) -> None:
        super().__init__(parent)
        give_help(self, "linkages#Circuits")
        self.setWindowTitle("Circuits of the linkage")
        self._found = found
        self.pictures = Pictures([_choice(i, circuit) for i, circuit in enumerate(found, 1)], THUMBS[0])
        self.pictures.setAccessibleName("Circuits")
        while self.pictures.paint_next():
            pass
        hint = QLabel("The ways to put these links together; the driver takes none of them into another.")
        coloured(hint, SCREEN.quiet)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        add_copy(buttons, parent, "circuits", lambda: ("taken.toml", ["--take", str(self.pictures.currentRow() + 1)]))
        self.pictures.itemActivated.connect(lambda _: self.accept())
        column = QVBoxLayout(self)
        column.addWidget(self.pictures, 1)
        column.addWidget(hint)
        column.addWidget(buttons)
        columns = min(len(found), MOST_COLUMNS - 2)
        rows = -(-len(found) // max(columns, 1))
        grid = THUMBS[0] + BESIDE
        self.resize(max(columns, 2) * grid.width() + 60, min(rows, 3) * grid.height() + BELOW.height())
        self.pictures.setCurrentRow(next((i for i, circuit in enumerate(found) if circuit.is_current), 0))

    @property
    def chosen(self) -> Circuit:
        """The circuit whose picture is marked."""
        return self._found[self.pictures.currentRow()]


def circuit_wanted(parent: QWidget, found: Sequence[Circuit]) -> Design | None:
    """Ask for a circuit; None where the user stays with the one that is there."""
    dialog = CircuitsDialog(parent, found)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    chosen = dialog.chosen
    dialog.deleteLater()
    return chosen.design if accepted and not chosen.is_current else None


__all__ = ["CircuitsDialog", "circuit_wanted"]
