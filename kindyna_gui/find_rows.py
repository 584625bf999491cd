"""Limits and texts of Find."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from html import escape
from math import isfinite
from types import MappingProxyType

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QGridLayout, QLabel, QMenu, QPushButton, QToolButton, QVBoxLayout, QWidget

from core.design import NO_UNIT, Design, Info, Limits, Unit, entry_at, info_of, split_unit
from core.find import (
    ANY_PRESSURE,
    CAM_SEARCHES,
    EXTRA,
    FORCE,
    LIMITS,
    OF_PRESSURE,
    SHAFT_SEARCHES,
    USER,
    LimitValue,
    Solution,
    default_limits,
)
from core.frozen import frozen
from kindyna_gui.forms.fields import UnitLabel, label_html
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import allowed_text, in_sentence, name_of, no_number, sentence
from kindyna_gui.look import coloured, icon
from kindyna_gui.pictures.paper.timing_chart import plain
from kindyna_gui.pictures.style import SCREEN, SMALL, font
from kindyna_gui.pictures.units import MINUS, brief, measure, number, with_unit
from kindyna_gui.rebuilt import Rebuilt, clear_menu
from kindyna_gui.settings import in_units, size_of, symbol_of

# -- texts -----------------------------------------------------------------------------------------------

_OWN: Mapping[str, Info | None] = MappingProxyType({each.name: info_of(each) for each in fields(Limits)})
_BESIDE_OWN: Mapping[str, Info] = MappingProxyType(
    {
        "pressure_angle_deg": Info(
            "Pressure angle", "greatest over the whole turn", 0.0, 90.0, open_low=True, step=1.0, optional=True
        ),
        "contact_on_face_mm": Info(
            "Contact on the face", "farthest from its centre", 0.0, open_low=True, optional=True
        ),
    }
)
"""Limits of a search that a design has none of."""
_BOUNDS = {"_min": "\u2265", "_max": "\u2264"}
DECIMALS = 4  # of what is reached
START = MappingProxyType(
    {True: 30.0, False: 1.0}
)  # of an upper limit, of a lower one, where the design has nothing to go by
START_DIGITS = 2
PRESENT_DIGITS = 6
TYPED_DIGITS, USUAL_DIGITS = 9, 4
MOST_NAMED = 2  # values in the name of a step


@frozen
class LimitText:
    """What can be limited: its name, the sign between name and limit, range and unit of the limit."""

    label: str
    sign: str
    info: Info
    unit: Unit

    @property
    def name(self) -> str:
        return f"{self.label} {self.sign}"


def _entry(design: Design, path: str) -> tuple[Info, Unit]:
    """Range and unit of a field of the design, or of what is none of its fields."""
    if path in EXTRA:
        return EXTRA[path], NO_UNIT
    entry = entry_at(design, path)
    return (Info(path), split_unit(path)[1]) if entry is None else (entry.info, entry.unit)


def figure_of(design: Design, key: str) -> LimitText:
    """Of the key of a limit, or the path of a field with _min or _max."""
    if key in LIMITS:
        row, unit = LIMITS[key], split_unit(key)[1]
        info = _OWN.get(key) or _BESIDE_OWN[key]
        return LimitText(info.label, _BOUNDS["_max" if row.is_upper else "_min"], info, unit)
    path, end = key[:-4], key[-4:]
    info, unit = _entry(design, path)
    return LimitText(_owned(design, path), _BOUNDS[end], replace(info, optional=True), unit)


def title_of(what: str) -> str:
    """Of a search."""
    return (SHAFT_SEARCHES[what] if what in SHAFT_SEARCHES else CAM_SEARCHES[what]).title


def usual_of(design: Design, what: str) -> Mapping[str, LimitValue]:
    """Those that hold where the user has typed none."""
    if what not in SHAFT_SEARCHES:
        return default_limits(design, what)
    return {
        key: LimitValue(value, "", "")
        for key, value in SHAFT_SEARCHES[what].default_limits(design).items()
        if value is not None
    }


@frozen
class ActiveLimit:
    """A limit that holds; usual: nobody typed it, for which there is the reason."""

    value: float
    usual: bool = False
    reason: str = ""


def holding(
    keys: Sequence[str], usual: Mapping[str, LimitValue], typed: Mapping[str, float | None]
) -> Mapping[str, ActiveLimit]:
    """The limits that hold, by key in their order; one that is typed takes the place of the same one only."""
    over_turn = typed.get(ANY_PRESSURE) is not None  # which stands for rise and return
    found = {
        key: ActiveLimit(float(f"{each.value:.{USUAL_DIGITS}g}"), True, each.reason)
        for key, each in usual.items()
        if not (over_turn and key in OF_PRESSURE and each.source != USER)
    }
    found |= {key: ActiveLimit(value) for key, value in typed.items() if value is not None}
    return {key: found[key] for key in keys if key in found and typed.get(key, 0.0) is not None}


def places_of(design: Design, what: str) -> Mapping[str, str]:
    """What is to be chosen beside the limits: of the fields that may be varied one, or of what may be least."""
    return (
        SHAFT_SEARCHES[what].aims
        if what in SHAFT_SEARCHES
        else {path: name_of(design, path) for path in CAM_SEARCHES[what].choices(design)}
    )


def keys_of(design: Design, what: str, paths: tuple[str, ...]) -> tuple[str, ...]:
    """Everything that may be limited when these fields are varied."""
    return (
        tuple(SHAFT_SEARCHES[what].default_limits(design))
        if what in SHAFT_SEARCHES
        else CAM_SEARCHES[what].keys(design, paths)
    )


def start_value(key: str, solution: Solution | None) -> float:
    """With which a limit begins: what the design at hand has, rounded."""
    known: float | None = None
    if solution is not None:
        known = (
            solution.before.get(key) if key in LIMITS else solution.present.get(key[:-4], solution.before.get(key[:-4]))
        )
    if known is None or not isfinite(known) or (key in LIMITS and known <= 0.0):
        return START[LIMITS[key].is_upper] if key in LIMITS else 0.0
    return float(f"{known:.{START_DIGITS}g}")


def axis_title(design: Design, key: str) -> str:
    """Of a limit, or of a field of the design."""
    label, unit = _label_of(design, key)
    return f"{label}, {symbol_of(unit.symbol)}" if unit.symbol else label


def _label_of(design: Design, key: str) -> tuple[str, Unit]:
    if key in LIMITS:
        figure = figure_of(design, key)
        return figure.label, figure.unit
    if "." in key:
        return _owned(design, key), _entry(design, key)[1]
    name, unit = split_unit(key)
    return sentence(name.replace("_", " ").replace("rms", "RMS")), unit


_ROW = re.compile(r"(drives|timing)\[(\d+)\]\.(?:phase|least)_deg")


def _owned(design: Design, path: str) -> str:
    """A field's name, of a drive's phase and a row of the timing with what it is of."""
    match = _ROW.fullmatch(path)
    if match is None:
        return EXTRA[path].label if path in EXTRA else name_of(design, path)
    if match[1] == "drives":
        return f"{design.drives[int(match[2])].name}: phase"
    row = design.timing[int(match[2])]
    return f"{plain(row.first)} to {plain(row.second)}"


def unit_of(design: Design, key: str) -> Unit:
    """Of a limit, or of a field of the design."""
    return _label_of(design, key)[1]


def value_of(design: Design, path: str, value: float, most: int) -> str:
    """``Base radius 62.884 mm``."""
    label, unit = _label_of(design, path)
    size = abs(value) if abs(value) > 1e-9 else 0.0  # what rounding leaves of a zero
    return f"{label} {measure(value if size else 0.0, unit.symbol, most)}"


def _reached(value: float, unit: Unit) -> str:
    if not isfinite(value):
        return "none"
    text, zero = number(value / size_of(unit.symbol), DECIMALS), number(0.0, DECIMALS)
    return with_unit(text if text != f"{MINUS}{zero}" else zero, symbol_of(unit.symbol))


def answer_html(design: Design, solution: Solution) -> str:
    """The answer, what it reaches, and what stands against it or where it ends."""
    lines = []
    if not solution.is_valid:
        lines.append(f"<span style='color:{SCREEN.limit}'>No value serves. The best that there is:</span>")
    for path, value in solution.answer.items():
        text = escape(value_of(design, path, value, solution.digits))
        lines.append(f"<b>{text}</b>{_now(_present(design, path, solution.present[path]))}")
    unsaid = {
        key for key, limit in solution.limits.items() if limit == 0.0 and key in LIMITS and key != solution.curve_of
    }
    said = [
        key
        for key in solution.reached
        if key not in unsaid and (key not in LIMITS or key in solution.limits or key == solution.curve_of)
    ]
    kept = [key for key in said if key in solution.limits and (key in LIMITS or key == FORCE)][
        1:
    ]  # the first is the tightest
    lines += [_line(design, solution, key) for key in said if key not in kept]
    if kept:
        others = "; ".join(
            f"{_label_of(design, key)[0]} {_reached(solution.reached[key], unit_of(design, key))}" for key in kept
        )
        lines.append(f"<span style='color:{SCREEN.quiet}'>Kept as well: {escape(others)}</span>")
    for path, value in solution.assumed.items():
        lines.append(
            escape(f"With an assumed {in_sentence(_label_of(design, path)[0])} of {_present(design, path, value)}.")
        )
    if solution.end:
        why = solution.end.partition(" (")[2].removesuffix(")")
        lines.append(f"No limit holds it: it stands at the end of its range{f', {escape(why)}' if why else ''}.")
    lines += [f"Beyond it: {escape(text)}" for text in solution.next_findings]
    lines += [f"With it comes: {escape(text)}" for text in solution.notes]
    lines += [_taken(design, solution, path) for path in solution.applied]
    lines += [f"<span style='color:{SCREEN.limit}'>But {escape(text)}</span>" for text in solution.errors]
    if not solution.is_valid:
        lines += [
            f"<span style='color:{SCREEN.limit}'>Against it: {escape(sentence(text))}</span>"
            for text in solution.violations
        ]
    return "<br>".join(map(in_units, lines))


def _taken(design: Design, solution: Solution, path: str) -> str:
    """What goes into the machine besides the answer, or in place of it."""
    text = value_of(design, path, solution.applied[path], solution.digits)
    if path in solution.answer and text == value_of(design, path, solution.answer[path], solution.digits):
        return "Taken over just below it, so that it holds."
    return f"Into the design goes, too: {escape(text)}{'' if path in solution.answer else ', so that the speed stays as even as it may'}."


def _present(design: Design, path: str, value: float | None) -> str:
    """What the design at hand has instead."""
    return "none" if value is None else brief(value, _label_of(design, path)[1].symbol, PRESENT_DIGITS)


def _now(text: str) -> str:
    return f" <span style='color:{SCREEN.quiet}'>now {escape(text)}</span>"


def _line(design: Design, solution: Solution, key: str) -> str:
    label, unit = _label_of(design, key)
    text = f" {_reached(solution.reached[key], unit)}"
    limit = solution.limits.get(key)
    if limit is not None:
        digits = USUAL_DIGITS if key in solution.reasons else TYPED_DIGITS
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
    """A number as it was typed; fewer digits of one that nobody typed."""
    return brief(value, unit.symbol, digits)


def step_name(design: Design, what: str, solution: Solution) -> str:
    """Of the step of the undo stack."""
    taken = {**solution.answer, **solution.applied}
    if len(taken) > MOST_NAMED:
        return f"Take over {in_sentence(title_of(what)) if what in CAM_SEARCHES else solution.target}"
    return f"Take over {', '.join(in_sentence(value_of(design, path, value, 6)) for path, value in taken.items())}"


# -- limit rows ------------------------------------------------------------------------------------------

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
