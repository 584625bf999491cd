"""Forms of requests."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import Field
from html import escape
from typing import Any, TypeVar

from PySide6.QtCore import QSize, Qt, QTimer, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLayout,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from core.cam import form_row
from core.commands.designs import ScaleArguments
from core.design import Design, scale_text
from core.design.fields import Info, info_of, unit_of
from core.errors import KindynaError
from core.requests import build_request, command_words, field_info, option_info, request_fields
from kindyna_gui.background import Background
from kindyna_gui.dialogs import give_help
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import add_copy
from kindyna_gui.forms.fields import Amount, fill_choices
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import sentence
from kindyna_gui.look import MessageLabel, coloured
from kindyna_gui.pictures.style import SCREEN

# -- put dialog ------------------------------------------------------------------------------------------

AROUND = QSize(40, 60)  # left free on the screen, with frame and title


class PutDialog(QDialog):
    """Two columns above a message and the buttons.

    Subclasses call ``frame`` once and implement ``accept`` with ``put``.

    message      what would become of the design, or what is wrong
    put_button   enabled by the subclass while there is something to put
    help_page    on what is put, with the words to look for there behind #
    """

    help_page = "making#Segments"

    def __init__(self, session: Session, title: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        give_help(self, self.help_page)
        self.setWindowTitle(title)
        self._session = session
        self.message = MessageLabel(SCREEN.quiet)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.put_button = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.put_button.setText("&Put into the design")
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)

    def frame(self, questions: QLayout, width: int, shown: QWidget | QLayout, usual: QSize, least: QSize) -> None:
        """Lay out the dialog. questions: the left column, ``width`` pixels wide; shown: the right one; usual and least: its size."""
        questions.setContentsMargins(0, 0, 0, 0)
        questions.setSpacing(6)
        left = QWidget()
        left.setLayout(questions)
        left.setFixedWidth(width)
        middle = QHBoxLayout()
        middle.setSpacing(12)
        middle.addWidget(left)
        if isinstance(shown, QLayout):
            middle.addLayout(shown, 1)
        else:
            middle.addWidget(shown, 1)
        foot = QHBoxLayout()
        foot.addWidget(self.message, 1)
        foot.addWidget(self.buttons)
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 10, 12, 10)
        column.addLayout(middle, 1)
        column.addLayout(foot)
        self.setMinimumSize(least)
        self.resize(usual.boundedTo(self.screen().availableGeometry().size() - AROUND))

    def show_message(self, text: str, wrong: bool = False) -> None:
        """What the values typed lead to; wrong: why they cannot be."""
        coloured(self.message, SCREEN.limit if wrong else SCREEN.quiet)
        self.message.show_message(text)

    def put(self, design: Design, step: str) -> None:
        """Put a design in place as one step of this name and close; where the session refuses it, show why and stay open."""
        session = self._session
        refused: list[str] = []

        def listen(refusal: Refusal) -> None:
            refused.extend(f"{name}: {text}" for _, name, text in refusal.reasons)

        session.refused.connect(listen)
        session.end_gesture()
        done = session.put(design, step)
        session.refused.disconnect(listen)
        session.end_gesture()
        if done:
            super().accept()
        else:
            session.withdraw("")
            self.show_message(sentence("; ".join(refused)), wrong=True)

    def open_once(self) -> None:
        """Open over its window; it is deleted once closed."""
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.open()


# -- request form ----------------------------------------------------------------------------------------

Kind = TypeVar("Kind")

DECIMALS = 6


class RequestForm(QWidget):
    """One box for each field of a request that has a label; of alternatives a box that says which, and the chosen one's. Files and
    texts are no part of it.

    changed  another value stands in a box
    boxes    by the field's name, alternatives' choices by that of their group
    rows     the layout, for what a dialog asks besides
    offered  field -> its choices, where not all of the request's; a single one is not asked for
    first    field -> the value it begins with, where not its default
    above    what a dialog asks before these, with labels; Tab goes through it first
    """

    changed = Signal()

    def __init__(
        self,
        kind: type,
        offered: Mapping[str, Sequence[str]] | None = None,
        first: Mapping[str, Any] | None = None,
        above: Sequence[tuple[str, QWidget | QLayout]] = (),
    ) -> None:
        super().__init__()
        self.kind = kind
        self.boxes: dict[str, Any] = {}
        self.rows = QFormLayout(self)
        self.rows.setContentsMargins(0, 0, 0, 0)
        for label, field in above:
            self.rows.addRow(label, field)
        self._fields = {each.name: each for each in request_fields(kind) if info_of(each) is not None}
        self._groups: dict[str, list[str]] = {}
        for name, each in self._fields.items():
            self._add(each, tuple((offered or {}).get(name, ())), (first or {}).get(name, each.default))
        for group in self._groups:
            self._choose(group)

    def _add(self, each: Field[Any], offered: Sequence[str], value: Any) -> None:
        info, how = info_of(each) or Info(""), option_info(each)
        group, way = how.one_of
        if group and group not in self.boxes:
            self._groups[group] = []
            self.boxes[group] = QComboBox(self)
            self.rows.addRow(group, self.boxes[group])
            self.boxes[group].currentIndexChanged.connect(lambda _: self._choose(group))
        label = info.label
        if info.flag:
            box: Any = QCheckBox(info.label)
            box.toggled.connect(self.changed)
            label = ""
        elif info.choices:
            box = QComboBox(self)
            words = {word: how.words.get(word, word[:1].upper() + word[1:]) for word in offered or info.choices}
            usual: dict[Any, str] = (
                {} if each.default in info.choices else {each.default: sentence(how.default_text or "as usual")}
            )
            fill_choices(box, {**usual, **words})
            box.currentIndexChanged.connect(self.changed)
        else:
            box = Amount()
            _limit(box, each, info)
            box.valueChanged.connect(self.changed)
        box.setAccessibleName(info.label)
        tip = [sentence(info.help)] if info.help else []
        if not info.flag and not info.choices:
            tip.append(sentence(f"allowed: {info.allowed(unit_of(each))}"))
        box.setToolTip("<br>".join(map(escape, tip)))
        self.boxes[each.name] = box
        self.rows.addRow("" if group else label, box)
        if group:
            self._groups[group].append(each.name)
            self.boxes[group].addItem(way, each.name)
        self.show_value(each.name, value)
        if info.choices and len(offered) == 1:
            self.rows.setRowVisible(box, False)

    def _choose(self, group: str) -> None:
        """Show the chosen one's box."""
        chosen = self.boxes[group].currentData()
        for name in self._groups[group]:
            self.rows.setRowVisible(self.boxes[name], name == chosen)
        self.changed.emit()

    def name_row(self, name: str, label: str) -> None:
        """Call a field otherwise."""
        row: Any = self.rows.labelForField(self.boxes[name])
        row.setText(label)
        self.boxes[name].setAccessibleName(label)

    # -- values ---------------------------------------------------------------------------------------------

    @property
    def values(self) -> dict[str, Any]:
        """By field, of alternatives the chosen one's."""
        left_out = {name for group, names in self._groups.items() for name in names if name != self.chosen(group)}
        return {name: self._value(name) for name in self._fields if name not in left_out}

    @property
    def request(self) -> Any:
        """What is wanted."""
        return build_request(self.kind, self.values)

    def chosen(self, group: str) -> str:
        """The field of a group that is given."""
        name: str = self.boxes[group].currentData()
        return name

    def choose(self, group: str, name: str) -> None:
        """Give this field of a group."""
        self.boxes[group].setCurrentIndex(self.boxes[group].findData(name))

    def _value(self, name: str) -> Any:
        box, each = self.boxes[name], self._fields[name]
        if not box.isEnabledTo(self):  # what makes no sense beside the others
            return each.default
        if isinstance(box, QCheckBox):
            return box.isChecked()
        if isinstance(box, QComboBox):
            return box.currentData()
        if box.specialValueText() and box.value() == box.minimum():
            return each.default
        info = info_of(each)
        return int(box.value()) if info is not None and info.whole else box.value()

    def show_value(self, name: str, value: Any) -> None:
        """Show a value in a field's box."""
        box = self.boxes[name]
        if isinstance(box, QCheckBox):
            box.setChecked(value)
        elif isinstance(box, QComboBox):
            box.setCurrentIndex(box.findData(value))
        elif value is not None:
            box.setValue(value)
        else:
            box.setValue(box.minimum())


def _limit(box: Amount, each: Field[Any], info: Info) -> None:
    """Range, decimals and unit of a number; where nothing may be given, the lowest stands for that."""
    usual = option_info(each).default_text
    may_be_none = bool(usual) and (each.default is None or each.default == info.low)
    box.setDecimals(0 if info.whole else DECIMALS)
    least = info.low if may_be_none or not info.open_low else info.low + 10.0**-DECIMALS
    box.setRange(least, info.high)
    symbol = unit_of(each).symbol
    box.setSuffix(symbol if symbol in ("", "°") else f" {symbol}")
    box.setSpecialValueText(usual if may_be_none else "")


# -- computed dialog -------------------------------------------------------------------------------------

WAITING = "computing ..."
PAUSE_MS = 150  # after the last change before anything is computed
FORM_WIDTH = 300  # pixels, at least
RESULT_LINES = 5


class ComputedDialog(QDialog):
    """The form of a request on the left, what comes of it in words below, and shown on the right. ``made`` is what was computed
    for the request, None while there is none; subclasses say what is computed and how it is shown.

    what: the file, as the title and messages call it.
    command, ending: of the command line that asks for the same, and of the file that it writes; help_page: on this export
    """

    command, ending, help_page = "", "", "tour"

    result: QLabel  # type: ignore[assignment]

    def __init__(self, parent: QWidget, what: str, form: RequestForm, shown: QWidget | QLayout) -> None:
        super().__init__(parent)
        self.setWindowTitle(f"Export {what}")
        give_help(self, self.help_page)
        self.made: Any = None
        self._work = Background(self)
        self.form, self.result = form, QLabel()
        self.result.setWordWrap(True)
        self.result.setMinimumHeight(RESULT_LINES * self.fontMetrics().lineSpacing())
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.export: QPushButton = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.export.setText(f"Save {what}...")
        add_copy(self.buttons, parent, self.command, self.asked, of_drive=True)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        left = QVBoxLayout()
        width = max(FORM_WIDTH, self.form.sizeHint().width())
        for widget in (self.form, self.result):
            widget.setFixedWidth(width)
            left.addWidget(widget)
        left.addStretch(1)
        sides = QHBoxLayout()
        sides.addLayout(left)
        if isinstance(shown, QLayout):
            sides.addLayout(shown, 1)
        else:
            sides.addWidget(shown, 1)
        column = QVBoxLayout(self)
        column.addLayout(sides)
        column.addWidget(self.buttons)
        self._pause = QTimer(self, interval=PAUSE_MS, singleShot=True)
        self._pause.timeout.connect(lambda: self._work.start([("", self.job())]))
        self._work.result.connect(self._take)
        self.finished.connect(self._pause.stop)
        self.finished.connect(self._work.close)
        self.form.changed.connect(self.changed)

    # -- for subclasses -------------------------------------------------------------------------------------

    def asked(self) -> tuple[str, list[str]]:
        """What the command writes, and its options."""
        return self.ending, command_words(self.form.kind, self.form.values)

    def job(self) -> Callable[[], Any]:
        """What computes what the file will hold, for the request as it is now."""
        raise NotImplementedError

    def show_result(self, made: Any) -> str:
        """Show what was computed, None where there is no answer; in words."""
        raise NotImplementedError

    def show_waiting(self) -> None:
        """Show that something else is being computed."""

    def changed(self) -> None:
        """What was computed is void, what is being computed is given up."""
        self.made = None
        self.export.setEnabled(False)
        self.show_waiting()
        self._tell(WAITING, SCREEN.quiet)
        self._work.stop()
        self._pause.start()

    # -- what comes of it -----------------------------------------------------------------------------------

    def _take(self, _: object, result: Any) -> None:
        self.made = None if isinstance(result, KindynaError) else result
        text = self.show_result(self.made)
        self._tell(str(result) if self.made is None else text, SCREEN.limit if self.made is None else SCREEN.ink)
        self.export.setEnabled(self.made is not None)

    def _tell(self, text: str, colour: str) -> None:
        self.result.setText(text)
        coloured(self.result, colour)


def flanks(design: Design) -> dict[str, tuple[str, ...]]:
    """The flanks that a form offers of a design's cam."""
    assert design.drive.cam is not None, "a design without cam has no profile"
    return {"flank": form_row(design.drive.cam.form).flanks}


def accepted(dialog: ComputedDialog) -> Any:
    """What was computed, once the user has accepted it; None where the user cancels."""
    made = dialog.made if dialog.exec() == QDialog.DialogCode.Accepted else None
    dialog.deleteLater()
    return made


# -- request dialog --------------------------------------------------------------------------------------

Told = Callable[[Mapping[str, Any]], str]
"""What a request means, in a sentence, by the values of its fields."""


class RequestDialog(QDialog):
    """form: for what a dialog asks besides; accept_button: says what is done then; told: the words below.

    command  of the command line that asks for the same; reads: it is on a design; help_page: on it
    """

    command, reads, help_page = "", True, "tour"

    def __init__(self, parent: QWidget, title: str, form: RequestForm, accept: str, told: Told) -> None:
        super().__init__(parent)
        give_help(self, self.help_page)
        self.setWindowTitle(title)
        self.form, self.told = form, QLabel(wordWrap=True)
        coloured(self.told, SCREEN.quiet)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.accept_button = buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.accept_button.setText(accept)
        add_copy(buttons, parent, self.command, self.asked, reads=self.reads)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        for widget in (form, self.told, buttons):
            column.addWidget(widget)
        form.changed.connect(lambda: self.told.setText(told(form.values)))
        self.told.setText(told(form.values))

    def asked(self) -> tuple[str, list[str]]:
        """What the command writes, and its options."""
        raise NotImplementedError

    def values(self) -> dict[str, Any] | None:
        """Ask; what stands in the form by field, None where the user cancels."""
        values = self.form.values if self.exec() == QDialog.DialogCode.Accepted else None
        self.deleteLater()
        return values


# -- scale dialog ----------------------------------------------------------------------------------------

FACTOR, MASSES = field_info(ScaleArguments, "factor"), field_info(ScaleArguments, "masses")
WIDTH = 380  # of the text, pixels


class ScaleDialog(QDialog):
    """A factor, a box for the masses, and below what that does."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle("Scale the design")
        self.factor = NumberBox(FACTOR)
        self.factor.show_value(1.0)
        self.factor.setToolTip(sentence(FACTOR.help))
        self.factor.setAccessibleName(FACTOR.label)
        self.masses = QCheckBox(MASSES.label)
        self.masses.setChecked(True)
        self.text = MessageLabel(SCREEN.quiet)
        self.text.setFixedWidth(WIDTH)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.scale_button = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.scale_button.setText("Scale")
        add_copy(
            self.buttons,
            parent,
            "scale",
            lambda: (
                "scaled.toml",
                command_words(ScaleArguments, {"factor": self.factor.value, "masses": self.masses.isChecked()}),
            ),
        )
        give_help(self, "tour#Scale the design")
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        form = QFormLayout()
        form.addRow(FACTOR.label, self.factor)
        form.addRow(self.masses)
        column = QVBoxLayout(self)
        column.addLayout(form)
        column.addWidget(self.text)
        column.addWidget(self.buttons)
        self.factor.entered.connect(self._enter)
        self.factor.unreadable.connect(self._refuse)
        self.masses.toggled.connect(self._show)
        self._show()
        self.factor.selectAll()

    def _enter(self, value: float) -> None:
        if FACTOR.admits(value):
            self.factor.show_value(value)
            self._show()
        else:
            self._refuse()

    def _refuse(self) -> None:
        self.factor.set_refused(True)
        self.scale_button.setEnabled(False)
        self.text.show_message("The factor is a number above 0: 0.1, or 1/10.")

    def _show(self, *_: object) -> None:
        self.scale_button.setEnabled(True)
        self.text.show_message(scale_text(self.factor.value or 1.0, self.masses.isChecked()))

    def accept(self) -> None:
        """What stands in the field counts, confirmed or not."""
        self.factor.confirm()
        if not self.factor.refused:
            super().accept()


def ask_scale(parent: QWidget) -> tuple[float, bool] | None:
    """Ask for a factor and whether masses grow along; None where the user cancels."""
    dialog = ScaleDialog(parent)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    wanted = dialog.factor.value or 1.0, dialog.masses.isChecked()
    dialog.deleteLater()
    return wanted if accepted else None
