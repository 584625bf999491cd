"""The limits of a search as rows: name, value, unit, and a button that takes the limit away; below them a menu that adds one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QGridLayout, QLabel, QMenu, QPushButton, QToolButton, QVBoxLayout, QWidget

from core.design import Design
from kindyna_gui.find.texts import ActiveLimit, LimitText, figure_of
from kindyna_gui.forms.field_parts import UnitLabel
from kindyna_gui.forms.fields import label_html
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import allowed_text, no_number
from kindyna_gui.look import coloured, icon
from kindyna_gui.pictures.style import SCREEN, SMALL, font
from kindyna_gui.preferences.units import in_units
from kindyna_gui.rebuilt import Rebuilt, clear_menu

BOX_WIDTH = 96  # pixels


class LimitRows(QWidget):
    """Rows for the limits that hold.

    changed (key, value or None): a limit was typed, or taken away
    wanted  (key): another limit is to be added
    """

    changed = Signal(str, object)
    wanted = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.boxes: dict[str, NumberBox] = {}
        self.removers: dict[str, QToolButton] = {}
        self.reasons: dict[str, QLabel] = {}
        self._names: tuple[str, ...] = ()
        self._explained = False
        self._rows = Rebuilt()
        self.add, self.menu = QPushButton("Add a limit …"), QMenu(self)
        self.add.setAutoDefault(False)
        self.add.clicked.connect(self._offer)
        self.message = QLabel(wordWrap=True)
        coloured(self.message, SCREEN.limit)
        self.message.hide()
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(2)
        column.addWidget(self._rows)
        column.addWidget(self.message)
        column.addWidget(self.add, 0, Qt.AlignmentFlag.AlignLeft)

    def show_limits(
        self, design: Design, limits: Mapping[str, ActiveLimit], others: Sequence[str], explained: bool
    ) -> None:
        """These limits hold, those that nobody typed in grey, explained with their reason below; others may be added."""
        self._explained = explained
        figures = {key: figure_of(design, key) for key in limits}
        names = tuple(f"{key} {figure.name}" for key, figure in figures.items())
        if names != self._names or self._rows.content is None:
            self._names = names
            self._rows.replace(self._made(figures))
            self._tell("")
        for key, held in limits.items():
            if not self.boxes[key].pending:
                self.boxes[key].show_value(held.value)
            self._explain(key, figures[key], held)
        clear_menu(self.menu)
        for key in others:
            if key not in limits:
                action = self.menu.addAction(figure_of(design, key).name)
                action.setData(key)
                action.triggered.connect(partial(self._add, key))
        self.add.setEnabled(not self.menu.isEmpty())

    def _made(self, figures: Mapping[str, LimitText]) -> QWidget:
        content = QWidget()
        grid = QGridLayout(content)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setSpacing(2)
        grid.setColumnStretch(0, 1)
        self.boxes, self.removers, self.reasons = {}, {}, {}
        for row, (key, figure) in enumerate(figures.items()):
            label, box, unit, remover = (
                QLabel(label_html(figure.name)),
                NumberBox(figure.info, figure.unit),
                UnitLabel(figure.unit),
                QToolButton(),
            )
            label.setBuddy(box)
            box.setAccessibleName(figure.name)
            box.setFixedWidth(BOX_WIDTH)
            box.entered.connect(partial(self._enter, key, figure))
            box.unreadable.connect(partial(self._unreadable, key, figure))
            box.withdrawn.connect(partial(self._tell, ""))
            remover.setIcon(icon("close"))
            remover.setAutoRaise(True)
            remover.setToolTip("Take this limit away")
            remover.setAccessibleName(f"Take away {figure.label}")
            remover.clicked.connect(partial(self._remove, key))
            for column, part in enumerate((label, box, unit, remover)):
                grid.addWidget(part, 2 * row, column, Qt.AlignmentFlag.AlignVCenter)
            why = QLabel(wordWrap=True)
            coloured(why, SCREEN.quiet)
            why.setFont(font(SMALL))
            why.hide()  # else the window grows for it, whether there is room or not
            grid.addWidget(why, 2 * row + 1, 0, 1, 4)
            self.boxes[key], self.removers[key], self.reasons[key] = box, remover, why
        return content

    def _explain(self, key: str, figure: LimitText, held: ActiveLimit) -> None:
        """Grey and its reason below it where nobody typed it; what the cross does."""
        box, why = self.boxes[key], self.reasons[key]
        colours = QPalette()
        if held.usual:
            colours.setColor(QPalette.ColorRole.Text, QColor(SCREEN.quiet))
        box.lineEdit().setPalette(colours)
        why.setText(in_units(held.reason))
        why.setVisible(bool(held.reason) and self._explained)
        box.setToolTip("; ".join(text for text in (figure.info.help.partition(";")[0], in_units(held.reason)) if text))
        self.removers[key].setToolTip(
            "Take this limit away" if held.usual else "Take this limit away; a usual one comes back"
        )

    def set_explained(self, explained: bool) -> None:
        """Whether reasons stand below their limits; else they come up where one points."""
        self._explained = explained
        for why in self.reasons.values():
            why.setVisible(bool(why.text()) and explained)

    def focus(self, key: str) -> None:
        """Let a limit be typed."""
        self.boxes[key].setFocus(Qt.FocusReason.OtherFocusReason)
        self.boxes[key].selectAll()

    def _enter(self, key: str, figure: LimitText, value: float | None) -> None:
        if not figure.info.admits(value):
            self.boxes[key].set_refused(True)
            self._tell(f"{figure.label}: outside its range; allowed: {allowed_text(figure.info, figure.unit)}")
            return
        self._tell("")
        if value is not None:
            self.boxes[key].show_value(value)
        self.changed.emit(key, value)

    def _unreadable(self, key: str, figure: LimitText) -> None:
        self.boxes[key].set_refused(True)
        self._tell(f"{figure.label}: {no_number(self.boxes[key].text())}")

    def _remove(self, key: str, _: bool = False) -> None:
        self.changed.emit(key, None)

    def _offer(self) -> None:
        self.menu.popup(self.add.mapToGlobal(self.add.rect().bottomLeft()))

    def _add(self, key: str, _: bool = False) -> None:
        self.wanted.emit(key)

    def _tell(self, text: str) -> None:
        self.message.setText(text)
        self.message.setVisible(bool(text))
