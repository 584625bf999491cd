"""Limits of a search, the form to edit them, and the texts of its result."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from html import escape
from math import isfinite
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QGridLayout, QLabel, QMenu, QPushButton, QToolButton, QVBoxLayout, QWidget

from core.design import NO_UNIT, Design, Info, Unit, entry_at, split_unit
from core.design.fields import in_sentence
from core.find import (
    ANY_PRESSURE,
    CAM_SEARCHES,
    EXTRA,
    FORCE,
    LIMIT_RANGES,
    LIMITS,
    OF_PRESSURE,
    USER,
    LimitValue,
    Solution,
    default_limits,
)
from core.find.rounding import TORQUE, finer_step_text
from core.frozen import frozen
from core.number_text import COMPARED_DIGITS, MOST_DIGITS, RESULT_DIGITS, digits_apart
from core.varying import MACHINE_SEARCHES
from kindyna_gui.documents.figures import column_text, figure_label
from kindyna_gui.forms.fields import UnitLabel, label_html
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.forms.refusal import RefusalLine, accept_in_range
from kindyna_gui.labels import law_label, name_of, sentence
from kindyna_gui.look import coloured, icon
from kindyna_gui.pictures.paper.timing_chart import event_text
from kindyna_gui.pictures.style import SCREEN, SMALL, font
from kindyna_gui.pictures.units import brief, readable_text, signed
from kindyna_gui.rebuilt import ContentArea, clear_menu, fill
from kindyna_gui.settings import in_units, symbol_of

# -- texts -----------------------------------------------------------------------------------------------

_BOUNDS = {"_min": "\u2265", "_max": "\u2264"}
START = MappingProxyType({True: 30.0, False: 1.0})  # first upper and lower limit where the design has no value
START_DIGITS = 2
PRESENT_DIGITS = 6
EXACT_DIGITS = 8  # of the exact value next to a rounded one
TYPED_DIGITS, DEFAULT_DIGITS = 9, 4
MOST_NAMED = 2  # values in the name of a step
MOST_LISTED = 4  # values of a result that are listed
MOST_HELD, MOST_MET = 3, 6  # limits that are named


@frozen
class LimitText:
    """Name of a limited quantity, sign between name and limit, range and unit of the limit."""

    label: str
    sign: str
    info: Info
    unit: Unit

    @property
    def name(self) -> str:
        """Label and sign."""
        return f"{self.label} {self.sign}"


def _entry(design: Design, path: str) -> tuple[Info, Unit]:
    """Range and unit of a field of the design, or of a quantity that is no field."""
    if path in EXTRA:
        return EXTRA[path], NO_UNIT
    entry = entry_at(design, path)
    return (Info(path), split_unit(path)[1]) if entry is None else (entry.info, entry.unit)


def limit_text(design: Design, key: str) -> LimitText:
    """Text of a limit by its key, or of a field's bound by its path with _min or _max."""
    if key in LIMITS:
        row, unit = LIMITS[key], split_unit(key)[1]
        info = LIMIT_RANGES[key]
        return LimitText(info.label, _BOUNDS["_max" if row.is_upper else "_min"], info, unit)
    path, end = key[:-4], key[-4:]
    info, unit = _entry(design, path)
    return LimitText(_field_label(design, path), _BOUNDS[end], replace(info, optional=True), unit)


def title_of(what: str) -> str:
    """Title of a search."""
    return (MACHINE_SEARCHES[what] if what in MACHINE_SEARCHES else CAM_SEARCHES[what]).title


def initial_limits(design: Design, what: str) -> Mapping[str, LimitValue]:
    """Limits of a search before the user types any."""
    if what not in MACHINE_SEARCHES:
        return default_limits(design, what)
    return {
        key: LimitValue(value, "", "")
        for key, value in MACHINE_SEARCHES[what].default_limits(design).items()
        if value is not None
    }


@frozen
class ActiveLimit:
    """A limit that applies; ``is_default``: not typed by the user, with its reason."""

    value: float
    is_default: bool = False
    reason: str = ""


def active_limits(
    keys: Sequence[str], defaults: Mapping[str, LimitValue], typed: Mapping[str, float | None]
) -> Mapping[str, ActiveLimit]:
    """Limits that apply, in the order of the keys; a typed limit replaces only the default limit of its key."""
    over_turn = typed.get(ANY_PRESSURE) is not None  # replaces the typical limits of rise and return
    limits = {
        key: ActiveLimit(float(f"{limit.value:.{DEFAULT_DIGITS}g}"), True, limit.reason)
        for key, limit in defaults.items()
        if not (over_turn and key in OF_PRESSURE and limit.source != USER)
    }
    limits |= {key: ActiveLimit(value) for key, value in typed.items() if value is not None}
    return {key: limits[key] for key in keys if key in limits and typed.get(key, 0.0) is not None}


def choices_of(design: Design, what: str) -> Mapping[str, str]:
    """Choices of a search in addition to its limits: the field to vary, or the quantity to minimise."""
    return (
        MACHINE_SEARCHES[what].aims
        if what in MACHINE_SEARCHES
        else {path: name_of(design, path) for path in CAM_SEARCHES[what].choices(design)}
    )


def keys_of(design: Design, what: str, paths: tuple[str, ...]) -> tuple[str, ...]:
    """Keys of all quantities that can be limited when these fields are varied."""
    return (
        tuple(MACHINE_SEARCHES[what].default_limits(design))
        if what in MACHINE_SEARCHES
        else CAM_SEARCHES[what].keys(design, paths)
    )


def start_value(key: str, solution: Solution | None) -> float:
    """First value of an added limit: that of the current design, rounded."""
    present: float | None = None
    if solution is not None:
        path = key[:-4]
        present = solution.before.get(key) if key in LIMITS else solution.present.get(path, solution.before.get(path))
    if present is None or not isfinite(present) or (key in LIMITS and present <= 0.0):
        return START[LIMITS[key].is_upper] if key in LIMITS else 0.0
    return float(f"{present:.{START_DIGITS}g}")


def axis_title(design: Design, key: str) -> str:
    """Title of the axis for a limit or a field of the design."""
    label, unit = _label_of(design, key)
    return f"{label}, {symbol_of(unit.symbol)}" if unit.symbol else label


def _label_of(design: Design, key: str) -> tuple[str, Unit]:
    if key in LIMITS:
        text = limit_text(design, key)
        return text.label, text.unit
    if ":" in key:
        return figure_label(design, key), split_unit(key.partition(":")[0])[1]
    if "." in key:
        return _field_label(design, key), _entry(design, key)[1]
    name, unit = split_unit(key)
    return sentence(name.replace("_", " ").replace("rms", "RMS")), unit


_ROW = re.compile(r"(drives|timing)\[(\d+)\]\.(?:phase|least)_deg")


def _field_label(design: Design, path: str) -> str:
    """Name of a field; of a phase with its drive, of a sequence condition with its events."""
    match = _ROW.fullmatch(path)
    if match is None:
        return EXTRA[path].label if path in EXTRA else name_of(design, path)
    if match[1] == "drives":
        return f"{design.drives[int(match[2])].name}: phase"
    row = design.timing[int(match[2])]
    return f"{event_text(row.first)} to {event_text(row.second)}"


def unit_of(design: Design, key: str) -> Unit:
    """Unit of a limit or a field of the design."""
    return _label_of(design, key)[1]


def value_of(design: Design, path: str, value: float, most: int) -> str:
    """Label, value and unit of a field: ``Base radius 62.884 mm``."""
    label, unit = _label_of(design, path)
    return f"{label} {brief(value if abs(value) > 1e-9 else 0.0, unit.symbol, most)}"  # less is a rounded zero


def _reached(value: float, unit: Unit, limit: float | None = None) -> str:
    """Value reached; next to its limit with as many digits as tell it apart from this."""
    if not isfinite(value):
        return "none"
    most = RESULT_DIGITS if limit is None else digits_apart([value, limit], COMPARED_DIGITS)
    return brief(value, unit.symbol, most)


def solution_html(design: Design, solution: Solution) -> str:
    """Values of a solution, the limits it reaches or violates, and the notes on it."""
    lines = []
    if not solution.is_valid:
        lines.append(f"<span style='color:{SCREEN.limit}'>No value meets all limits. The closest:</span>")
    for path, value in [*solution.answer.items()][: None if len(solution.answer) <= MOST_LISTED else 1]:
        text = escape(_taken_text(design, solution, path, value))
        lines.append(f"<b>{text}</b>{_now(_present(design, path, solution.present[path]))}")
    listed = [
        key
        for key in solution.reached
        if key == solution.curve_of or key not in LIMITS or solution.limits.get(key, 0.0) != 0.0
    ]
    if len(solution.answer) > MOST_LISTED:
        lines.append(f"{len(solution.answer) - 1} other numbers and laws change: point here for all of them.")
    lines += _held_by(design, solution)
    met = [key for key in listed if key in solution.limits and (key in LIMITS or key == FORCE or ":" in key)]
    others = met[1:]  # the first is the tightest
    lines += [_line(design, solution, key) for key in listed if key not in others]
    if TORQUE in solution.before and TORQUE in solution.cost:
        taken, present = solution.cost[TORQUE][1], solution.before[TORQUE]
        torques = [readable_text(torque, "N·m", digits_apart([taken, present])) for torque in (taken, present)]
        lines += [f"Torque {torques[0]}{_now(torques[1])}"] if torques[0] != torques[1] else []
    if others:
        texts = (
            f"{_label_of(design, key)[0]} {_reached(solution.reached[key], unit_of(design, key))}"
            for key in others[:MOST_MET]
        )
        lines.append(f"<span style='color:{SCREEN.quiet}'>Also met: {escape('; '.join(texts))}</span>")
    for path, value in solution.assumed.items():
        lines.append(
            escape(f"With an assumed {in_sentence(_label_of(design, path)[0])} of {_present(design, path, value)}.")
        )
    if solution.end:
        why = solution.end.partition(" (")[2].removesuffix(")")
        lines.append(f"Limited by the search range only{f': {escape(why)}' if why else ''}.")
    lines += [f"Beyond it: {escape(text)}" for text in solution.next_findings]
    lines += [f"Note: {escape(text)}" for text in solution.notes]
    lines += [_applied_text(design, solution, path) for path in solution.applied if path not in solution.rounding]
    lines += [f"<span style='color:{SCREEN.limit}'>But {escape(text)}</span>" for text in solution.errors]
    if not solution.is_valid:
        lines += [
            f"<span style='color:{SCREEN.limit}'>Violated: {escape(sentence(text))}</span>"
            for text in solution.violations
        ]
    return "<br>".join(map(in_units, lines))


def _held_by(design: Design, solution: Solution) -> list[str]:
    """What holds a result first, second and third, and what 1 % of relief of each gives."""
    unit = unit_of(design, solution.curve_of).symbol
    names = [column_text(design, limit) for limit, _ in solution.binding[:MOST_HELD]]
    names = [name if ": " in name else in_sentence(name) for name in names]  # the name of a drive stays as it is
    return [
        f"Held by {escape(name)}: "
        + (
            f"1 % of relief gives {escape(brief(abs(change), unit))}"
            if change
            else "relief of this limit alone gives nothing"
        )
        for name, (_, change) in zip(names, solution.binding, strict=False)
    ]


def answers_tip(design: Design, solution: Solution) -> str:
    """All numbers and laws of a result with the present ones, one a line; empty where the result lists them itself."""
    if len(solution.answer) <= MOST_LISTED:
        return ""
    taken = (
        value_of(design, path, value, MOST_DIGITS)
        if path in solution.rounding
        else _taken_text(design, solution, path, value)
        for path, value in solution.answer.items()
    )
    return "\n".join(
        f"{text}, now {_present(design, path, solution.present[path])}"
        for text, path in zip(taken, solution.answer, strict=True)
    )


def _taken_text(design: Design, solution: Solution, path: str, value: Any) -> str:
    """Value of a result; a rounded one with the exact value and, after the last number, with the cost of the rounding."""
    label, unit = _label_of(design, path)
    if isinstance(value, str):
        return f"{label} {law_label(value)}"
    if path not in solution.rounding or value == solution.exact[path]:
        return value_of(
            design, path, value, MOST_DIGITS if path in solution.rounding else min(solution.digits, EXACT_DIGITS)
        )
    text = f"{label} {brief(value, unit.symbol, MOST_DIGITS)}, exact {brief(solution.exact[path], unit.symbol, EXACT_DIGITS)}"
    cost = _cost_text(design, solution) if path == [*solution.rounding][-1] else ""
    finer = finer_step_text(path, solution.exact[path], solution.rounding[path])
    return f"{text}{f': {cost}' if cost else ''}{f' ({finer})' if finer else ''}"


def _cost_text(design: Design, solution: Solution) -> str:
    """Tightest limit with the rounded result, and the change of the torque by rounding."""
    texts = []
    key = next((key for key in solution.cost if key in LIMITS), "")
    if key:
        label, unit = _label_of(design, key)
        texts.append(f"{in_sentence(label)} {brief(solution.cost[key][1], unit.symbol)}")
    exact, taken = solution.cost.get(TORQUE, solution.cost.get("peak_torque_nm", (0.0, 0.0)))
    if exact and (change := round(100.0 * (taken / exact - 1.0), 2)):
        texts.append(f"torque {signed(change)} % by rounding")
    return ", ".join(texts)


def _applied_text(design: Design, solution: Solution, path: str) -> str:
    """Value that is applied in addition to the result, or in place of it."""
    most = MOST_DIGITS if solution.rounding else solution.digits
    text = value_of(design, path, solution.applied[path], most)
    if path in solution.answer and text == value_of(design, path, solution.answer[path], most):
        return "Applied just below this value, so that the limit is met."
    reason = "" if path in solution.answer else ", so that the speed stays within its allowed fluctuation"
    return f"Also changes: {escape(text)}{reason}."


def _present(design: Design, path: str, value: Any) -> str:
    """Value of the current design, a number or a law."""
    if isinstance(value, str):
        return law_label(value)
    return "none" if value is None else brief(value, _label_of(design, path)[1].symbol, PRESENT_DIGITS)


def _now(text: str) -> str:
    return f" <span style='color:{SCREEN.quiet}'>now {escape(text)}</span>"


def _line(design: Design, solution: Solution, key: str) -> str:
    label, unit = _label_of(design, key)
    limit = solution.limits.get(key)
    text = f" {_reached(solution.reached[key], unit, limit)}"
    if limit is not None:
        digits = DEFAULT_DIGITS if key in solution.reasons else TYPED_DIGITS
        text += (
            f", limit {typed_text(limit, unit, digits)}"
            if limit or key not in LIMITS
            else ": beyond it the cam is undercut"
        )
    return (
        label_html(label)
        + escape(text)
        + (_now(_reached(solution.before[key], unit)) if key in solution.before else "")
    )


def typed_text(value: float, unit: Unit, digits: int = TYPED_DIGITS) -> str:
    """A limit as the user typed it; default limits have fewer digits."""
    return brief(value, unit.symbol, digits)


def step_name(design: Design, what: str, solution: Solution) -> str:
    """Name of the undo step."""
    changes = {**solution.answer, **solution.applied}
    if len(changes) > MOST_NAMED:
        return f"Take over {in_sentence(title_of(what)) if what in CAM_SEARCHES else solution.target}"
    return f"Take over {', '.join(in_sentence(value_of(design, path, value, 6)) for path, value in changes.items())}"


# -- limit rows ------------------------------------------------------------------------------------------

BOX_WIDTH = 108  # pixels; numbers in inches have ten digits


class LimitRows(QWidget):
    """Rows to edit the limits that apply.

    - changed (key, value or None): a limit was typed, or removed
    - added (key): the user adds a limit
    """

    changed = Signal(str, object)
    added = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.boxes: dict[str, NumberBox] = {}
        self.removers: dict[str, QToolButton] = {}
        self.reasons: dict[str, QLabel] = {}
        self._names: tuple[str, ...] = ()
        self._explained = False
        self._rows = ContentArea()
        self.add, self.menu = QPushButton("Add a limit …"), QMenu(self)
        self.add.setAutoDefault(False)
        self.add.clicked.connect(self._offer)
        self.message = RefusalLine((0, 0, 0, 0))
        fill(
            QVBoxLayout(self), self._rows, self.message, (self.add, 0, Qt.AlignmentFlag.AlignLeft), margins=0, spacing=2
        )

    def show_limits(
        self, design: Design, limits: Mapping[str, ActiveLimit], others: Sequence[str], explained: bool
    ) -> None:
        """Show the limits that apply, default limits in grey.

        ``others``: keys that the user can add. ``explained``: show the reason below each limit.
        """
        self._explained = explained
        texts = {key: limit_text(design, key) for key in limits}
        names = tuple(f"{key} {text.name}" for key, text in texts.items())
        if names != self._names or self._rows.content is None:
            self._names = names
            self._rows.replace(self._build(texts))
            self.message.show_refusal("")
        for key, limit in limits.items():
            if not self.boxes[key].pending:
                self.boxes[key].show_value(limit.value)
            self._explain(key, texts[key], limit)
        clear_menu(self.menu)
        for key in others:
            if key not in limits:
                action = self.menu.addAction(limit_text(design, key).name)
                action.setData(key)
                action.triggered.connect(partial(self._add, key))
        self.add.setEnabled(not self.menu.isEmpty())

    def _build(self, texts: Mapping[str, LimitText]) -> QWidget:
        content = QWidget()
        grid = fill(QGridLayout(content), margins=0, spacing=2)
        grid.setColumnStretch(0, 1)
        grid.setColumnMinimumWidth(1, BOX_WIDTH)  # the boxes give up theirs with another theme
        self.boxes, self.removers, self.reasons = {}, {}, {}
        for row, (key, text) in enumerate(texts.items()):
            label, box, unit, remover = (
                QLabel(label_html(text.name)),
                NumberBox(text.info, text.unit),
                UnitLabel(text.unit),
                QToolButton(),
            )
            label.setBuddy(box)
            box.setAccessibleName(text.name)
            box.setFixedWidth(BOX_WIDTH)
            accept_in_range(box, self.message, partial(self.changed.emit, key), text.label)
            remover.setIcon(icon("close"))
            remover.setAutoRaise(True)
            remover.setToolTip("Remove this limit")
            remover.setAccessibleName(f"Remove {text.label}")
            remover.clicked.connect(partial(self._remove, key))
            for column, part in enumerate((label, box, unit, remover)):
                grid.addWidget(part, 2 * row, column, Qt.AlignmentFlag.AlignVCenter)
            why = coloured(QLabel(wordWrap=True), SCREEN.quiet)
            why.setFont(font(SMALL))
            why.hide()  # else the window grows for it, whether there is room or not
            grid.addWidget(why, 2 * row + 1, 0, 1, 4)
            self.boxes[key], self.removers[key], self.reasons[key] = box, remover, why
        return content

    def _explain(self, key: str, text: LimitText, limit: ActiveLimit) -> None:
        """Show a default limit in grey with its reason, and the tips of the row."""
        box, why = self.boxes[key], self.reasons[key]
        colours = QPalette()
        if limit.is_default:
            colours.setColor(QPalette.ColorRole.Text, QColor(SCREEN.quiet))
        box.lineEdit().setPalette(colours)
        why.setText(in_units(limit.reason))
        why.setVisible(bool(limit.reason) and self._explained)
        box.setToolTip("; ".join(filter(None, (text.info.help.partition(";")[0], in_units(limit.reason)))))
        self.removers[key].setToolTip(
            "Remove this limit" if limit.is_default else "Remove this limit; a typical limit applies again"
        )

    def set_explained(self, explained: bool) -> None:
        """Show the reasons below their limits, or only in the tips."""
        self._explained = explained
        for why in self.reasons.values():
            why.setVisible(bool(why.text()) and explained)

    def focus(self, key: str) -> None:
        """Give the focus to a limit and select its text."""
        self.boxes[key].setFocus(Qt.FocusReason.OtherFocusReason)
        self.boxes[key].selectAll()

    def _remove(self, key: str, _: bool = False) -> None:
        self.changed.emit(key, None)

    def _offer(self) -> None:
        self.menu.popup(self.add.mapToGlobal(self.add.rect().bottomLeft()))

    def _add(self, key: str, _: bool = False) -> None:
        self.added.emit(key)
