"""The dialog before a report is written: which kind of file, what stands in it, and whether it is opened."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

from PySide6.QtCore import QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLineEdit,
    QVBoxLayout,
    QWidget,
)

from core.frozen import frozen
from core.output.report.document import PAPERS, PARTS, Cover
from core.requests import command_words
from kindyna_gui.dialogs import give_help
from kindyna_gui.documents.as_command import add_copy
from kindyna_gui.settings import Settings

KINDS = {".pdf": "PDF, pages to print", ".html": "HTML, one page for any browser"}
LINES, KEPT = ("customer", "author", "company", "revision", "date", "logo"), ("customer", "author", "company", "logo")
"""What the first page may say, and what of it is the same the next time."""


def kept_cover() -> dict[str, str]:
    """What a first page said the last time, or stands in the preferences."""
    settings = Settings()
    return {**{name: settings.written(name) for name in KEPT}, "paper": settings.written("paper") or next(iter(PAPERS))}


@frozen
class ReportWanted:
    """Ending of the file, the parts that stand in it, what its first page says, whether it is opened when it is written."""

    ending: str
    parts: tuple[str, ...]
    cover: Cover
    opened: bool


class ReportDialog(QDialog):
    """Kind of file and a box for each part that may be left out."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._settings = Settings()
        self.setWindowTitle("Report")
        self.kind = QComboBox()
        for ending, name in KINDS.items():
            self.kind.addItem(name, ending)
        self.parts = {name: QCheckBox(text) for name, text in PARTS.items()}
        self.opened = QCheckBox("Open it")
        kept = kept_cover()
        self.lines = {name: QLineEdit(kept.get(name, "")) for name in LINES}
        self.paper = QComboBox()
        self.paper.addItems(list(PAPERS))
        self.paper.setCurrentText(kept["paper"])
        boxes = QVBoxLayout()
        for box in self.parts.values():
            box.setChecked(True)
            boxes.addWidget(box)
        form = QFormLayout()
        form.addRow("File", self.kind)
        for name, line in self.lines.items():
            line.setPlaceholderText("none")
            form.addRow(name.capitalize(), line)
        form.addRow("Paper", self.paper)
        form.addRow("With", boxes)
        form.addRow("Then", self.opened)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.button(QDialogButtonBox.StandardButton.Ok).setText("Save report...")
        add_copy(buttons, parent, "report", self._asked)
        give_help(self, "tour#writes one file to hand on")
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addLayout(form)
        column.addWidget(buttons)

    @property
    def wanted(self) -> ReportWanted:
        """Kind of file, chapters, and whether it is opened then."""
        parts = tuple(name for name, box in self.parts.items() if box.isChecked())
        texts = {name: box.text().strip() for name, box in self.lines.items()}
        cover = Cover(**texts, paper=self.paper.currentText())
        return ReportWanted(self.kind.currentData(), parts, cover, self.opened.isChecked())

    def _asked(self) -> tuple[str, list[str]]:
        wanted = self.wanted
        without = [name for name in PARTS if name not in wanted.parts]
        cover = command_words(Cover, {each.name: getattr(wanted.cover, each.name) for each in fields(Cover)})
        return wanted.ending, [*cover, *(["--without", *without] if without else [])]

    def remember(self) -> None:
        """For the next report: who makes them for whom, and on which paper."""
        for name in KEPT:
            self._settings.write(name, self.lines[name].text().strip())
        self._settings.write("paper", self.paper.currentText())


def report_wanted(parent: QWidget) -> ReportWanted | None:
    """Ask what a report shall hold; None where the user cancels."""
    dialog = ReportDialog(parent)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    wanted = dialog.wanted
    if accepted:
        dialog.remember()
    dialog.deleteLater()
    return wanted if accepted else None


def open_outside(path: Path) -> None:
    """Show a file in the program that the desktop has for it."""
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(path.resolve())))


__all__ = ["ReportDialog", "ReportWanted", "open_outside", "report_wanted"]
