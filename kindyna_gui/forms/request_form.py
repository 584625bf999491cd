"""Dialogs of requests: a form with a box for each field, and what is computed for it.

``RequestForm`` is the form of any request; ``RequestDialog`` shows its meaning in words, ``ComputedDialog`` the result
computed in the background, ``PutDialog`` puts a design in place, ``ScaleDialog`` asks for a scale factor.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import Field, replace
from functools import partial
from html import escape
from typing import Any, TypeVar

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLayout,
    QVBoxLayout,
    QWidget,
)

from core.cam import form_row
from core.commands.designs import ScaleArguments
from core.design import Design, scale_text
from core.design.fields import Info, info_of, unit_of
from core.errors import KindynaError
from core.requests import build_request, command_words, field_info, option_info, request_fields
from core.units import Unit
from kindyna_gui.background import Background
from kindyna_gui.dialogs import accept_buttons, give_help
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import add_copy
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import LiveBox, NumberBox
from kindyna_gui.forms.refusal import (
    NO_REMEDIES,
    FloatingRefusal,
    RefusalLine,
    Remedies,
    accept_in_range,
    judge_number,
    value_remedies,
)
from kindyna_gui.labels import allowed_text, sentence
from kindyna_gui.look import MessageLabel, coloured, described
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import STRETCH, connect_all, fill, single_shot, widget_with
from kindyna_gui.settings import in_units, symbol_of

Kind = TypeVar("Kind")
Summary = Callable[[Mapping[str, Any]], str]
"""The meaning of a request in a sentence, from the values of its fields."""
AROUND = QSize(40, 60)  # free on the screen for frame and title, pixels
WAITING = "Calculating ..."
PAUSE_MS = 150  # from the last change to the computation
FORM_WIDTH = 300  # pixels, at least
RESULT_LINES = 5
FACTOR, MASSES = field_info(ScaleArguments, "factor"), field_info(ScaleArguments, "masses")
WIDTH = 380  # of the text of the scale dialog, pixels

# -- dialogs that put a design in place ------------------------------------------------------------------


class PutDialog(QDialog):
    """Two columns above a message and the buttons.

    Subclasses call ``frame`` once, implement ``accept`` with ``put``, and enable ``put_button`` while there is a result.
    ``message`` says what becomes of the design, or what is wrong. ``help_page`` is the page of help, with the words to
    search for after #.
    """

    help_page = "making#Segments"

    def __init__(self, session: Session, title: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        give_help(self, self.help_page)
        self.setWindowTitle(title)
        self._session = session
        self.message = RefusalLine((0, 0, 0, 0))
        self.buttons, self.put_button = accept_buttons(self, "&Put into the design")

    def frame(self, questions: QLayout, width: int, shown: QWidget | QLayout, default: QSize, least: QSize) -> None:
        """Lay out the dialog: ``questions`` in the left column, ``width`` pixels wide, ``shown`` in the right one."""
        questions.setContentsMargins(0, 0, 0, 0)
        questions.setSpacing(6)
        left = widget_with(questions)
        left.setFixedWidth(width)
        middle = fill(QHBoxLayout(), left, (shown, 1), spacing=12)
        footer = fill(QHBoxLayout(), (self.message, 1), self.buttons)
        fill(QVBoxLayout(self), (middle, 1), footer, margins=(12, 10, 12, 10))
        self.setMinimumSize(least)
        self.resize(default.boundedTo(self.screen().availableGeometry().size() - AROUND))

    def show_message(self, text: str, wrong: bool = False, remedies: Remedies = NO_REMEDIES) -> None:
        """Show what the typed values lead to, or why they are wrong, with a button for each remedy."""
        self.message.show_refusal(text, remedies, is_wrong=wrong)

    def ask_number(self, box: NumberBox, accept: Callable[[Any], object], again: Callable[[], object]) -> None:
        """Accept the numbers of a box in its range; while it is refused, nothing can be put into the design.

        ``again`` shows the result of the present numbers.
        """

        def hold_back(*_: object) -> None:
            if box.is_refused:
                self.put_button.setEnabled(False)

        accept_in_range(box, self.message, accept, box.accessibleName())
        connect_all((box.entered, hold_back), (box.unreadable, hold_back), (box.withdrawn, lambda: again()))

    def put(self, design: Design, step: str) -> None:
        """Put a design in place as one undo step and close; where the session refuses it, show why and stay open."""
        with self._session.one_step() as refusals:
            done = self._session.put(design, step)
        if done:
            super().accept()
        else:
            self._session.withdraw("")
            reasons = [f"{name}: {text}" for refusal in refusals for _, name, text in refusal.reasons]
            self.show_message(sentence("; ".join(reasons)), wrong=True)

    def open_once(self) -> None:
        """Open over the window, and delete the dialog when it is closed."""
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.open()


# -- the form of a request -------------------------------------------------------------------------------


class RequestForm(QWidget):
    """One box for each field of a request that has a label, but no files and texts.

    Alternatives have a box for the choice, and the box of the chosen one. ``boxes`` has all by the name of the field or of
    the group of alternatives; ``rows`` is the layout, to which a dialog may add. Signal: ``changed`` with any value.

    ``offered`` gives the choices of a field, where not all of the request's (a single choice is not shown); ``initial`` the
    first value of a field, where not its default; ``above`` rows of the dialog before these, with labels.
    """

    changed = Signal()

    def __init__(
        self,
        kind: type,
        offered: Mapping[str, Sequence[str]] | None = None,
        initial: Mapping[str, Any] | None = None,
        above: Sequence[tuple[str, QWidget | QLayout]] = (),
    ) -> None:
        super().__init__()
        self.kind = kind
        self.boxes: dict[str, Any] = {}
        self._refusals: dict[str, FloatingRefusal] = {}
        self._valid: dict[str, float | None] = {}
        self._last = self._misfit = ""  # the number typed last, and the one that does not fit the others
        self.rows = fill(QFormLayout(self), *above, margins=0)
        self._fields = {field.name: field for field in request_fields(kind) if info_of(field) is not None}
        self._groups: dict[str, list[str]] = {}
        for name, row in self._fields.items():
            self._add(row, tuple((offered or {}).get(name, ())), (initial or {}).get(name, row.default))
        for group in self._groups:
            self._choose(group)

    def _add(self, field: Field[Any], offered: Sequence[str], value: Any) -> None:
        info, option = info_of(field) or Info(""), option_info(field)
        group, alternative = option.one_of
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
            words = {word: option.words.get(word, word[:1].upper() + word[1:]) for word in offered or info.choices}
            default: dict[Any, str] = (
                {} if field.default in info.choices else {field.default: sentence(option.default_text or "default")}
            )
            fill_choices(box, {**default, **words})
            box.currentIndexChanged.connect(self._choice_made)
        else:
            box = RequestBox(field.name, _optional(field, info), unit_of(field))
            box.lineEdit().setPlaceholderText(option.default_text)
            box.typed.connect(self._judge)
            label = _with_unit(info.label, field)
        box.setAccessibleName(info.label)
        tip = [sentence(info.help)] if info.help else []
        if not info.flag and not info.choices:
            tip.append(sentence(f"allowed: {allowed_text(info, unit_of(field))}"))
        box.setToolTip("<br>".join(map(escape, tip)))
        self.boxes[field.name] = box
        self.rows.addRow(label if isinstance(box, RequestBox) or not group else "", box)
        if group:
            self._groups[group].append(field.name)
            self.boxes[group].addItem(alternative, field.name)
        self.show_value(field.name, value)
        if info.choices and len(offered) == 1:
            self.rows.setRowVisible(box, False)

    def _choose(self, group: str) -> None:
        """Show the box of the chosen alternative."""
        chosen = self.boxes[group].currentData()
        for name in self._groups[group]:
            self.rows.setRowVisible(self.boxes[name], name == chosen)
        self.changed.emit()

    def name_row(self, name: str, label: str) -> None:
        """Give a field another label."""
        row: Any = self.rows.labelForField(self.boxes[name])
        row.setText(_with_unit(label, self._fields[name]))
        self.boxes[name].setAccessibleName(label)

    # -- values ---------------------------------------------------------------------------------------------

    @property
    def values(self) -> dict[str, Any]:
        """Values by field; of alternatives only the chosen one's."""
        left_out = {name for group, names in self._groups.items() for name in names if name != self.chosen(group)}
        return {name: self._value(name) for name in self._fields if name not in left_out}

    @property
    def request(self) -> Any:
        """The request with the values of the form."""
        return build_request(self.kind, self.values)

    def chosen(self, group: str) -> str:
        """Return the chosen field of a group of alternatives."""
        name: str = self.boxes[group].currentData()
        return name

    def choose(self, group: str, name: str) -> None:
        """Choose a field of a group of alternatives."""
        self.boxes[group].setCurrentIndex(self.boxes[group].findData(name))

    def _value(self, name: str) -> Any:
        box, field = self.boxes[name], self._fields[name]
        if not box.isEnabledTo(self):  # it has no meaning together with the others
            return field.default
        if isinstance(box, QCheckBox):
            return box.isChecked()
        if isinstance(box, QComboBox):
            return box.currentData()
        number, info = box.value if box.fault() else box.number, info_of(field)
        return number if number is not None and info is not None and info.admits(number) else field.default

    def show_value(self, name: str, value: Any) -> None:
        """Show a value in a field's box."""
        box = self.boxes[name]
        if isinstance(box, QCheckBox):
            box.setChecked(value)
        elif isinstance(box, QComboBox):
            box.setCurrentIndex(box.findData(value))
        else:
            is_default = value is None or (box.info.optional and value == self._fields[name].default)
            before = box.number
            box.set_number(None if is_default else value)
            self._judge(name, is_changed=box.number != before)

    # -- refused numbers ------------------------------------------------------------------------------------

    @property
    def is_valid(self) -> bool:
        """Whether every number that counts is in its range."""
        return not any(self._is_wrong(name) for name in self._fields)

    def _is_wrong(self, name: str) -> bool:
        box = self.boxes[name]
        counts = isinstance(box, RequestBox) and self.rows.isRowVisible(box) and box.isEnabledTo(self)
        return counts and bool(box.fault())

    def _judge(self, name: str, is_changed: bool = True) -> None:
        """Refuse the number of a box that is outside its range, and emit ``changed``."""
        self._last = name
        self._refuse(name)
        if is_changed:
            self.changed.emit()

    def _choice_made(self, *_: object) -> None:
        self._last = ""
        self.changed.emit()

    def note_valid(self) -> None:
        """Note the numbers of a request that can be carried out, to which a remedy goes back."""
        self._valid = {name: box.number for name, box in self.boxes.items() if isinstance(box, RequestBox)}

    def refuse_last(self, why: str) -> None:
        """Refuse the number typed last, which does not fit the others; without a reason accept it."""
        if self._misfit:
            self._refuse(self._misfit)
        self._misfit = self._last if why else ""
        if self._misfit:
            box, valid = self.boxes[self._misfit], self._valid.get(self._misfit)
            back = partial(self.show_value, self._misfit, valid)
            remedies = {} if valid == box.number else value_remedies(box.with_unit, None, valid, box.use, back)
            box.set_refused(True)
            self._refusal_at(self._misfit).show_refusal(sentence(why), remedies)

    def _refuse(self, name: str) -> None:
        """Refuse the number of a box, or clear its refusal."""
        if self.boxes[name].fault() or name in self._refusals:
            judge_number(self._refusal_at(name), self.boxes[name])

    def _refusal_at(self, name: str) -> FloatingRefusal:
        if name not in self._refusals:
            self._refusals[name] = FloatingRefusal(self.boxes[name])
        return self._refusals[name]


class RequestBox(LiveBox):
    """Number of a request; Enter accepts the dialog, unless the number is refused. Signal ``typed`` with its name."""

    typed = Signal(str)

    def __init__(self, name: str, info: Info, unit: Unit) -> None:
        super().__init__(info, unit)
        self._name = name
        self.changed.connect(self._emit_typed)

    def fault(self, info: Info | None = None) -> str:
        is_none = self.info.optional and self.number == self.info.low
        return "" if is_none else super().fault(info)

    def _emit_typed(self) -> None:
        self.typed.emit(self._name)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        super().keyPressEvent(event)
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and not self.fault():
            event.ignore()


def _optional(field: Field[Any], info: Info) -> Info:
    """Range of a number; empty, or 0 where that is excluded, means its default, such as *as the follower*."""
    has_text = bool(option_info(field).default_text) and field.default in (None, info.low)
    return replace(info, optional=True) if has_text or field.default is None else info


def _with_unit(label: str, field: Field[Any]) -> str:
    symbol = symbol_of(unit_of(field).symbol)
    return f"{label}, {symbol}" if symbol else label


# -- dialogs with a computed result ----------------------------------------------------------------------


class ComputedDialog(QDialog):
    """The form of a request on the left with the result in words below it, and the result itself on the right.

    ``computed`` is the result of the request, None while there is none; subclasses say what is computed and how it is shown.
    ``file`` is the file in the title and messages; ``command`` and ``ending`` are the command that does the same and the
    ending of its file; ``help_page`` is the page of help.
    """

    command, ending, help_page = "", "", "tour"

    result: QLabel  # type: ignore[assignment]

    def __init__(self, parent: QWidget, file: str, form: RequestForm, shown: QWidget | QLayout) -> None:
        super().__init__(parent)
        self.setWindowTitle(f"Export {file}")
        give_help(self, self.help_page)
        self.computed: Any = None
        self._work = Background(self)
        self.form, self.result = form, QLabel()
        self.result.setWordWrap(True)
        self.result.setMinimumHeight(RESULT_LINES * self.fontMetrics().lineSpacing())
        self.buttons, self.export = accept_buttons(self, f"Save {file}...")
        self.copy = add_copy(self.buttons, parent, self.command, self.command_options, of_drive=True)
        width = max(FORM_WIDTH, self.form.sizeHint().width())
        for widget in (self.form, self.result):
            widget.setFixedWidth(width)
        left = fill(QVBoxLayout(), self.form, self.result, STRETCH)
        sides = fill(QHBoxLayout(), left, (shown, 1))
        fill(QVBoxLayout(self), sides, self.buttons)
        self._pause = single_shot(self, lambda: self._work.start([("", self.job())]), PAUSE_MS)
        connect_all(
            (self._work.result, self._take),
            (self.finished, self._pause.stop),
            (self.finished, self._work.close),
            (self.form.changed, self.changed),
        )

    # -- for subclasses -------------------------------------------------------------------------------------

    def command_options(self) -> tuple[str, list[str]]:
        """Return the file that the command writes, and its options."""
        return self.ending, command_words(self.form.kind, self.form.values)

    def job(self) -> Callable[[], Any]:
        """Return the function that computes the content of the file for the current request."""
        raise NotImplementedError

    def show_result(self, computed: Any) -> str:
        """Show the result, None where there is none, and return it in words."""
        raise NotImplementedError

    def show_waiting(self) -> None:
        """Show that another result is being computed."""

    def changed(self) -> None:
        """Discard the result, stop the running computation, and start another after a pause unless a number is refused."""
        self.computed = None
        self.form.refuse_last("")
        self.export.setEnabled(False)
        self.copy.setEnabled(self.form.is_valid)
        self.show_waiting()
        self._say(WAITING if self.form.is_valid else "", SCREEN.quiet)
        self._work.stop()
        self._pause.stop()
        if self.form.is_valid:
            self._pause.start()

    # -- the result -----------------------------------------------------------------------------------------

    def _take(self, _: object, result: Any) -> None:
        self.computed = None if isinstance(result, KindynaError) else result
        text = self.show_result(self.computed)
        self._say(str(result) if self.computed is None else text, SCREEN.limit if self.computed is None else SCREEN.ink)
        self.export.setEnabled(self.computed is not None)
        self.copy.setEnabled(self.computed is not None)
        if self.computed is None:
            self.form.refuse_last(str(result))
        else:
            self.form.note_valid()

    def _say(self, text: str, colour: str) -> None:
        self.result.setText(in_units(text))
        coloured(self.result, colour)


def flanks(design: Design) -> dict[str, tuple[str, ...]]:
    """Return the flanks of a design's cam that a form offers."""
    assert design.drive.has_disk, "a design without cam has no profile"
    return {"flank": form_row(design.drive.cam.form).flanks}


def accepted(dialog: ComputedDialog) -> Any:
    """Run the dialog and return its result; None where the user cancels."""
    result = dialog.computed if dialog.exec() == QDialog.DialogCode.Accepted else None
    dialog.deleteLater()
    return result


# -- dialogs with a summary ------------------------------------------------------------------------------


class RequestDialog(QDialog):
    """A form with a summary in words below it.

    ``command`` is the command that does the same, ``reads`` whether it reads a design, ``of_drive`` whether it is for one
    drive, ``file_option`` its option for the file that it writes; ``help_page`` is the page of help.
    """

    command, reads, of_drive, file_option, help_page = "", True, False, "--out", "tour"

    def __init__(self, parent: QWidget, title: str, form: RequestForm, accept: str, summary: Summary) -> None:
        super().__init__(parent)
        give_help(self, self.help_page)
        self.setWindowTitle(title)
        self.form, self.summary = form, QLabel(wordWrap=True)
        coloured(self.summary, SCREEN.quiet)
        buttons, self.accept_button = accept_buttons(self, accept)
        self.copy = add_copy(
            buttons,
            parent,
            self.command,
            self.command_options,
            of_drive=self.of_drive,
            reads=self.reads,
            file_option=self.file_option,
        )
        column = QVBoxLayout(self)
        for widget in (form, self.summary, buttons):
            column.addWidget(widget)
        self._summary = summary
        form.changed.connect(self.update_summary)
        self.summary.setText(summary(form.values))

    @property
    def is_complete(self) -> bool:
        """Whether the request can be accepted."""
        return self.form.is_valid

    def update_summary(self) -> None:
        """Show the meaning of the request; one with a refused number can neither be accepted nor copied."""
        is_complete = self.is_complete
        self.accept_button.setEnabled(is_complete)
        self.copy.setEnabled(is_complete)
        if self.form.is_valid:
            self.summary.setText(self._summary(self.form.values))

    def command_options(self) -> tuple[str, list[str]]:
        """Return the file that the command writes, and its options."""
        raise NotImplementedError

    def values(self) -> dict[str, Any] | None:
        """Run the dialog and return the values by field; None where the user cancels."""
        values = self.form.values if self.exec() == QDialog.DialogCode.Accepted else None
        self.deleteLater()
        return values


# -- scale the design ------------------------------------------------------------------------------------


class ScaleDialog(QDialog):
    """The scale factor, whether masses are scaled, and the effect in words."""

    def __init__(self, parent: QWidget, design: Design) -> None:
        super().__init__(parent)
        self.setWindowTitle("Scale the design")
        self.design = design
        self.factor = described(LiveBox(FACTOR), name=FACTOR.label, tip=sentence(FACTOR.help))
        self.factor.set_number(1.0)
        self.masses = QCheckBox(MASSES.label)
        self.masses.setChecked(True)
        self.text = MessageLabel(SCREEN.quiet)
        self.text.setFixedWidth(WIDTH)
        self.buttons, self.scale_button = accept_buttons(self, "Scale")
        self.copy = add_copy(
            self.buttons,
            parent,
            "scale",
            lambda: (
                "scaled.toml",
                command_words(ScaleArguments, {"factor": self.factor.value, "masses": self.masses.isChecked()}),
            ),
        )
        give_help(self, "tour#Scale the design")
        form = fill(QFormLayout(), (FACTOR.label, self.factor), self.masses)
        fill(QVBoxLayout(self), form, self.text, self.buttons)
        self.refusal = FloatingRefusal(self.factor)
        self.factor.changed.connect(self._show)
        self.masses.toggled.connect(self._show)
        self._show()
        self.factor.selectAll()

    def _show(self, *_: object) -> None:
        is_valid = judge_number(self.refusal, self.factor)
        for button in (self.scale_button, self.copy):
            button.setEnabled(is_valid)
        if is_valid:
            self.text.show_message(scale_text(self.design, self.factor.number or 1.0, self.masses.isChecked()))

    def accept(self) -> None:
        """Accept the factor as it is typed, confirmed or not."""
        self.factor.confirm()
        if not self.factor.is_refused:
            super().accept()


def ask_scale(parent: QWidget, design: Design) -> tuple[float, bool] | None:
    """Ask for the scale factor of a design and whether masses are scaled too; None where the user cancels."""
    dialog = ScaleDialog(parent, design)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    scale = dialog.factor.value or 1.0, dialog.masses.isChecked()
    dialog.deleteLater()
    return scale if accepted else None
