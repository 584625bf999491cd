"""A linkage of another program: its text, how it is read, and what it becomes."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QPixmap
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPlainTextEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from core.bounds import PROGRAM_BYTES
from core.design import faults
from core.errors import KindynaError
from core.linkage_programs import Made, read_linkage
from core.linkage_programs.design import UNITS, decoded
from core.mechanism.unfinished import mobility
from core.requests import command_words
from kindyna_gui import dialogs
from kindyna_gui.documents.as_command import add_copy_of, spelled
from kindyna_gui.labels import sentence
from kindyna_gui.look import coloured
from kindyna_gui.note import MessageLabel, bold_label
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.thumbnails import thumbnail

TITLE, FILES = "Import linkage", "Linkages (*.linkage2 *.pyslvs *.txt);;All files (*)"
PICTURE, MOST_SHOWN = QSize(380, 270), 12


class LinkageDialog(QDialog):
    """made: the design that the text is; None where it is none."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        dialogs.give_help(self, "linkages#From other programs")
        self.setWindowTitle(TITLE)
        self._name, self._file = "", ("", "")  # what was opened: its path, and its text
        self.made: Made | None = None
        self.text, self.units, self.mirror, self.inputs = QPlainTextEdit(), QComboBox(), QCheckBox(), QListWidget()
        self.text.setTabChangesFocus(True)
        self.text.setPlaceholderText("Paste a Pyslvs expression, M[J[R, ...], or the address of PMKS+, or open a file")
        self.open_button = QPushButton("&Open a file...")
        self.units.addItem("as the text says, else mm", "")
        for unit in UNITS:
            self.units.addItem(unit, unit)
        self.mirror.setText("Turn it over about the x axis: where its y points down")
        self.text.setAccessibleName("Text of the linkage")
        self.inputs.setAccessibleName("Inputs")
        self.inputs.setFixedHeight(86)
        self.inputs.setToolTip("The joints that drive; of several the first is the driver, the others turn with it")
        self.picture, self.message = QLabel(), MessageLabel(SCREEN.quiet)
        self.picture.setFixedSize(PICTURE)
        form = QFormLayout()
        form.addRow("Lengths in", self.units)
        form.addRow("Inputs", self.inputs)
        form.addRow(self.mirror)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.ok = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.ok.setText("Begin")
        add_copy_of(self.buttons, self._as_command)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addWidget(bold_label("Of Pyslvs, PMKS+ or Linkage"))
        column.addWidget(self.text, 1)
        column.addWidget(self.open_button)
        column.addLayout(form)
        column.addWidget(self.picture, 0, Qt.AlignmentFlag.AlignHCenter)
        column.addWidget(self.message)
        column.addWidget(self.buttons)
        self.resize(560, 700)
        self.open_button.clicked.connect(self._open)
        self.text.textChanged.connect(self._afresh)
        self.units.currentIndexChanged.connect(self._read)
        self.mirror.toggled.connect(self._read)
        self.inputs.itemChanged.connect(self._read)
        self._read()

    def _open(self) -> None:
        opened = dialogs.opened_file(self, TITLE, FILES, PROGRAM_BYTES)
        if opened is not None:
            path, data = opened
            self._name = path.stem
            self.text.setPlainText(decoded(data))
            self._file = str(path), self.text.toPlainText()

    def _as_command(self) -> str:
        from core.commands.linkages import LinkageFromArguments

        (path, read), text = self._file, self.text.toPlainText()
        items = [self.inputs.item(i) for i in range(self.inputs.count())]
        driven = [item.text() for item in items if item.checkState() is Qt.CheckState.Checked]
        asked = {
            "text": path if path and text == read else text.strip(),
            "out": f"{self._name or 'linkage'}.toml",
            "units": self.units.currentData(),
            "mirror": self.mirror.isChecked(),
            "inputs": driven if self.made is not None and tuple(driven) != self.made.inputs else [],
        }
        return spelled("linkage-from", command_words(LinkageFromArguments, asked))

    def _afresh(self) -> None:
        """Another text: its own inputs."""
        self.inputs.clear()
        self._read()

    def _read(self, *_: object) -> None:
        """What the text is, read as asked for."""
        self.made = None
        text = self.text.toPlainText()
        items = [self.inputs.item(i) for i in range(self.inputs.count())]
        inputs = tuple(item.text() for item in items if item.checkState() is Qt.CheckState.Checked)
        try:
            if text.strip():
                units = self.units.currentData()
                self.made = read_linkage(
                    text, name=self._name, units=units, mirror=self.mirror.isChecked(), inputs=inputs
                )
        except KindynaError as error:
            self._say(sentence(str(error).splitlines()[0]), wrong=True)
        self.ok.setEnabled(self.made is not None)
        if self.made is None:
            self.picture.setPixmap(QPixmap())
            if not text.strip():
                self._say("")
            return
        if not items:
            self._list_inputs(self.made)
        self._show(self.made)

    def _list_inputs(self, made: Made) -> None:
        self.inputs.blockSignals(True)
        for name in made.could_drive:
            item = QListWidgetItem(name, self.inputs)
            item.setCheckState(Qt.CheckState.Checked if name in made.inputs else Qt.CheckState.Unchecked)
        self.inputs.blockSignals(False)

    def _show(self, made: Made) -> None:
        lines = [f"{made.links} links, {made.joints} joints"]
        lines += [f"Left out: {each.what}: {each.why}" for each in made.left_out[:MOST_SHOWN]]
        if (more := len(made.left_out) - MOST_SHOWN) > 0:
            lines.append(f"and {more} more that are left out")
        picture = QPixmap()
        if faults(made.design):
            lines += [sentence(text) for text in mobility(made.design.drive.linkage).sentences]
        else:
            ratio = self.devicePixelRatioF()
            picture = QPixmap.fromImage(thumbnail(made.design, PICTURE.width(), PICTURE.height(), ratio))
        self.picture.setPixmap(picture)
        self._say("\n".join(lines))

    def _say(self, text: str, wrong: bool = False) -> None:
        coloured(self.message, SCREEN.limit if wrong else SCREEN.quiet)
        self.message.show_message(text)


def linkage_wanted(parent: QWidget) -> Made | None:
    """Ask for a linkage of another program; None where the user thinks better of it."""
    dialog = LinkageDialog(parent)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    made = dialog.made if accepted else None
    dialog.deleteLater()
    return made


__all__ = ["LinkageDialog", "linkage_wanted"]
