"""Edit > Preferences: units, look, and the texts of reports; Reset shows the defaults."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from types import MappingProxyType

from PySide6.QtGui import QImageReader
from PySide6.QtWidgets import (
    QApplication,
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QGroupBox,
    QHBoxLayout,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from kindyna_gui import settings
from kindyna_gui.dialogs import give_help
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import NameBox
from kindyna_gui.forms.refusal import RefusalLine
from kindyna_gui.labels import sentence
from kindyna_gui.look import apply_preferences, described
from kindyna_gui.rebuilt import STRETCH, fill
from kindyna_gui.settings import FONTS, INCH, PAPERS, THEMES, UNITS, Preferences


class PreferencesDialog(QDialog):
    """A field for each preference; ``preferences`` has the values shown."""

    def __init__(self, parent: QWidget, now: Preferences) -> None:
        super().__init__(parent)
        self.setWindowTitle("Preferences")
        give_help(self, "preferences")
        self.units = {kind: QComboBox() for kind in UNITS}
        for kind, box in self.units.items():
            fill_choices(box, {unit: unit for unit in UNITS[kind]})
        self.comma = QCheckBox("Decimal comma")
        self.theme, self.font_size, self.paper = QComboBox(), QComboBox(), QComboBox()
        fill_choices(self.theme, dict(THEMES))
        for size, text in FONTS.items():
            self.font_size.addItem(text, size)
        fill_choices(self.paper, {name: name for name in PAPERS})
        self.still = described(
            QCheckBox("Reduced motion"), tip="Menus and docks appear at once; nothing moves except an animation"
        )
        self.author, self.company, self.logo = QLineEdit(), QLineEdit(), NameBox()
        self.message = RefusalLine((0, 0, 0, 0))
        self._first_logo = now.logo
        self.logo.textChanged.connect(self._check_logo)
        right = fill(QVBoxLayout(), self._look(), self._paper(), STRETCH)
        sides = fill(QHBoxLayout(), self._units(), (right, 1))
        standard = QDialogButtonBox.StandardButton
        self.buttons = QDialogButtonBox(standard.Ok | standard.Cancel | standard.Reset)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self.buttons.button(standard.Reset).clicked.connect(lambda: self.show_all(Preferences()))
        fill(QVBoxLayout(self), sides, self.message, self.buttons)
        self.show_all(now)

    def _units(self) -> QGroupBox:
        group = QGroupBox("Units on display")
        form = QFormLayout(group)
        for kind, box in self.units.items():
            box.setAccessibleName(kind)
            form.addRow(sentence(kind), box)
        all_of = QHBoxLayout()
        for text, units in (("All metric", {}), ("All in inches", dict(INCH))):
            button = QPushButton(text, autoDefault=False)
            button.clicked.connect(lambda _=False, units=units: self.show_units(units))
            all_of.addWidget(button)
        form.addRow(all_of)
        form.addRow(self.comma)
        group.setToolTip("Files, tables and commands always use the first unit of each list")
        return group

    def _look(self) -> QGroupBox:
        group = QGroupBox("Look")
        fill(QFormLayout(group), ("Theme", self.theme), ("Font size", self.font_size), self.still)
        return group

    def _paper(self) -> QGroupBox:
        group = QGroupBox("Reports and drawings")
        browse = QPushButton("Browse...", autoDefault=False)
        browse.clicked.connect(self._browse)
        row = fill(QHBoxLayout(), (self.logo, 1), browse)
        fill(
            QFormLayout(group), ("Paper", self.paper), ("Author", self.author), ("Company", self.company), ("Logo", row)
        )
        return group

    def _browse(self) -> None:
        name, _ = QFileDialog.getOpenFileName(self, "Logo", self.logo.text(), "Pictures (*.png *.svg *.jpg)")
        if name:
            self.logo.setText(name)

    def _check_logo(self, *_: object) -> None:
        """Refuse a logo that cannot be read."""
        logo, first = self.logo.text().strip(), self._first_logo
        is_wrong = bool(logo) and not is_image(logo)
        back = {f"Back to {Path(first).name}": first} if first and is_image(first) else {}
        texts = {**back, "Leave it empty": ""}
        remedies = {text: partial(self.logo.setText, path) for text, path in texts.items()}
        self.logo.set_refused(is_wrong)
        why = f"Logo: {logo} cannot be read as an image; allowed: a PNG, SVG or JPEG file. It is omitted."
        self.message.show_refusal(why if is_wrong else "", remedies)

    def show_units(self, units: dict[str, str]) -> None:
        """Show these units; for other kinds the units of files."""
        for kind, box in self.units.items():
            box.setCurrentIndex(box.findData(units.get(kind, UNITS[kind][0])))

    def show_all(self, preferences: Preferences) -> None:
        """Show these preferences."""
        self.show_units(dict(preferences.units))
        self.comma.setChecked(preferences.comma)
        for box, value in (
            (self.theme, preferences.theme),
            (self.font_size, preferences.font),
            (self.paper, preferences.paper),
        ):
            box.setCurrentIndex(box.findData(value))
        self.still.setChecked(preferences.still)
        for line, text in (
            (self.author, preferences.author),
            (self.company, preferences.company),
            (self.logo, preferences.logo),
        ):
            line.setText(text)

    @property
    def preferences(self) -> Preferences:
        """Preferences shown in the fields."""
        units = {kind: box.currentData() for kind, box in self.units.items() if box.currentIndex() > 0}
        return Preferences(
            MappingProxyType(units),
            self.comma.isChecked(),
            self.theme.currentData(),
            self.font_size.currentData(),
            self.still.isChecked(),
            self.paper.currentData(),
            *(line.text().strip() for line in (self.author, self.company, self.logo)),
        )


def is_image(path: str) -> bool:
    """Whether a file is an image that can be read."""
    return Path(path).is_file() and QImageReader(path).canRead()


def change_preferences(parent: QWidget) -> None:
    """Ask for preferences, save them and apply them; nothing changes where the user cancels."""
    dialog = PreferencesDialog(parent, settings.read())
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    chosen = dialog.preferences
    dialog.deleteLater()
    if accepted:
        settings.write(chosen)
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        apply_preferences(chosen, app)


__all__ = ["PreferencesDialog", "change_preferences"]
