"""The table of a servo controller becomes the motion, exactly as the controller runs it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QSize
from PySide6.QtWidgets import QComboBox, QFormLayout, QVBoxLayout, QWidget

from core.design import require_motion
from core.errors import KindynaError
from core.motion import program
from core.output.controllers.motion import ControllerMotion, motion_text, read_motion, with_controller_motion
from core.output.controllers.rows import INTERPOLATIONS, controllers
from core.requests import command_words
from kindyna_gui import dialogs
from kindyna_gui.documents.as_command import add_copy_of, of_session, spelled
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.amount import fill_choices
from kindyna_gui.forms.put_dialog import PutDialog
from kindyna_gui.labels import sentence
from kindyna_gui.note import bold_label
from kindyna_gui.pictures.plots.xy import Dots, Line, XYPlot
from kindyna_gui.pictures.style import SCREEN

TITLE, FILES = "Import controller table", "Tables of controllers (*)"
WIDTH, USUAL, LEAST = 330, QSize(900, 480), QSize(700, 360)
POINTS = 1441  # of the curve


class ControllerTableDialog(PutDialog):
    """``found`` is the motion of the file, None where the chosen controller has no such files."""

    help_page = "controllers#Import controller table"

    def __init__(self, session: Session, path: Path, data: bytes, parent: QWidget | None = None) -> None:
        super().__init__(session, TITLE, parent)
        self._path, self._data, self._rows = path, data, controllers()
        self._unit = require_motion(session.design).unit
        self.found: ControllerMotion | None = None
        self.controller, self.interpolation, self.plot = QComboBox(), QComboBox(), XYPlot("", "")
        self.form = QFormLayout()
        self.form.addRow("Controller", self.controller)
        self.form.addRow("Between two rows", self.interpolation)
        left = QVBoxLayout()
        left.addWidget(bold_label(path.name))
        left.addLayout(self.form)
        left.addStretch(1)
        self.frame(left, WIDTH, self.plot, USUAL, LEAST)
        add_copy_of(self.buttons, self._as_command)
        fill_choices(self.controller, {slug: row.label for slug, row in self._rows.items()})
        self.controller.setMinimumContentsLength(24)
        self.controller.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.controller.currentIndexChanged.connect(self._suit_controller)
        self.interpolation.currentIndexChanged.connect(self._read)
        fitting = next((i for i, slug in enumerate(self._rows) if self._motion(slug, None)[0] is not None), 0)
        self.controller.setCurrentIndex(fitting)
        self._suit_controller()

    def _motion(self, slug: str, interpolation: str | None) -> tuple[ControllerMotion | None, str]:
        """What the file is to a controller, or why it is nothing."""
        try:
            return read_motion(self._rows[slug], self._data, interpolation, self._unit), ""
        except KindynaError as error:
            return None, str(error)

    def _suit_controller(self) -> None:
        row = self._rows[self.controller.currentData()]
        usual: dict[Any, str] = {} if row.interpolation_asked else {None: "As the file says, or usual"}
        known = {name: sentence(name.replace("-", " ")) for name in INTERPOLATIONS if name in row.interpolation}
        self.interpolation.blockSignals(True)
        fill_choices(self.interpolation, {**usual, **known})
        self.interpolation.blockSignals(False)
        self.form.setRowVisible(self.interpolation, self.interpolation.count() > 1)
        self._read()

    def _read(self) -> None:
        self.found, wrong = self._motion(self.controller.currentData(), self.interpolation.currentData())
        self.put_button.setEnabled(self.found is not None)
        if self.found is None:
            self.plot.show_message("")
            self.show_message(sentence(wrong), wrong=True)
            return
        self.show_message(motion_text(self.found).strip())
        motion = self.found.motion
        compiled = program(motion)
        ends = np.rad2deg(np.append(compiled.starts, compiled.ends[-1]))
        curve, rows = (
            compiled.state(compiled.angles(np.deg2rad(x))).displacement[0] / motion.scale
            for x in (np.linspace(0.0, 360.0, POINTS)[:-1], ends[:-1])
        )
        self.plot.name_axes("Cam angle, °", f"Displacement, {'°' if motion.unit == 'deg' else motion.unit}")
        line = Line(np.linspace(0.0, 360.0, POINTS)[:-1], curve, SCREEN.family("displacement"))
        self.plot.show_lines([line], fit=True, dots=[Dots(ends[:-1], rows, SCREEN.ink, 4.0)])

    def _as_command(self) -> str:
        from core.commands.tables import MeasuredArguments

        asked = {"table": self._path, "controller": self.controller.currentData(), **of_session(self._session)}
        return spelled("measured", command_words(MeasuredArguments, asked))

    def accept(self) -> None:
        """Put the motion into the design as one step."""
        if self.found is not None:
            self.put(with_controller_motion(self._session.design, self.found), f"Import {self._path.name}")


def import_controller(session: Session, parent: QWidget) -> None:
    """Ask for a file and open the dialog over a window."""
    opened = dialogs.opened_file(parent, TITLE, FILES)
    if opened is not None:
        ControllerTableDialog(session, *opened, parent).open_once()


__all__ = ["ControllerTableDialog", "import_controller"]
