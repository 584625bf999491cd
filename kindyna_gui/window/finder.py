"""Find anything: commands, fields, channels, examples, help, findings by words or symbol; a value behind a field's name sets it."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtGui import QFocusEvent, QKeyEvent, QKeySequence
from PySide6.QtWidgets import QAbstractItemView, QFrame, QHeaderView, QLineEdit, QMenu, QTableView, QVBoxLayout, QWidget
from shiboken6 import isValid

from core.design import Design, Entry, only, path_of
from core.design.fields import USUAL
from core.errors import KindynaError
from core.frozen import frozen
from core.study import findings_of, names_of, quantity
from core.units import compatible_units
from kindyna_gui.forms.form import rows_of
from kindyna_gui.forms.number_box import parsed
from kindyna_gui.forms.tables import RowsModel, TableHeading, TableRow
from kindyna_gui.help import sections
from kindyna_gui.labels import allowed_text, choice_text, entry_name, no_number, sentence, step_text, value_text
from kindyna_gui.motion.head import stroke_entry
from kindyna_gui.pictures.units import legible
from kindyna_gui.settings import symbol_of
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import VIEWS

MOST = 40  # rows that are listed
WIDTH, ROW, SHOWN = 620, 24, 14  # pixels of list and row; rows without rolling
NOTHING = "Nothing is called"
HINT = "Command, field, channel, example, help, finding; base radius 420 sets it"
_MOVES = MappingProxyType(
    {Qt.Key.Key_Up: -1, Qt.Key.Key_Down: 1, Qt.Key.Key_PageUp: -SHOWN, Qt.Key.Key_PageDown: SHOWN}
)
BY_WEIGHT, SYMBOL = 0.2, 3.0  # of a field's rank; less for one that is its symbol
FIRST, BEHIND_NAMES = -100.0, 10.0  # of values that are set; of those refused: a name ``segment 2 span`` is no amount
_AMOUNT = re.compile(r"[-+\u2212]?[\d.,]+\s*([^\W\d_]|[°%\"/]).*|[-+\u2212]?\d+,\d+")
_WORD = re.compile(r"[\w°%µ/|∠.+-]+")


@frozen
class Found:
    """One thing that can be found.

    kind    what it is, in a word
    title   as it is called; beside: its keys, value or unit; tip: what it is about
    words   title, symbol and more, folded; the title's own stand first, up to ``own`` characters
    act     what choosing it does
    entry   of a field, with its path in the whole file of the drive that holds it
    """

    kind: str
    title: str
    beside: str
    tip: str
    words: str
    own: int
    act: Callable[[], object]
    entry: Entry | None = None
    path: str = ""


@lru_cache(maxsize=8192)
def folded(text: str) -> str:
    """A text without capitals, indices set low, marks and accents: ``α₀`` and ``α_0`` are ``α0``."""
    plain = unicodedata.normalize("NFKC", text).casefold().replace("_", "").replace("\u2212", "-")
    return "".join(letter for letter in plain if not unicodedata.combining(letter) and letter not in "&…")


def spelled(symbol: str) -> str:
    """The Greek letters of a symbol, spelled for keyboards without them: ``alpha``."""
    names = (unicodedata.name(letter, "") for letter in symbol)
    return " ".join(name.rpartition(" ")[2].lower() for name in names if name.startswith("GREEK"))


def _found(
    kind: str, title: str, beside: str, tip: str, act: Callable[[], object], more: str = "", **field: Any
) -> Found:
    own = folded(title)
    return Found(kind, title, beside, tip, f"{own} {folded(more)} {folded(tip)}", len(own), act, **field)


# -- what can be found ------------------------------------------------------------------------------------


def _commands(window: Window) -> Iterator[Found]:
    """The entries of all menus, as they stand now."""
    for top in window.menuBar().actions():
        menu = top.menu()
        if isinstance(menu, QMenu):
            menu.aboutToShow.emit()
            yield from _of_menu(window, menu, _plain(top.text()), "")


def _of_menu(window: Window, menu: QMenu, top: str, below: str) -> Iterator[Found]:
    for action in menu.actions():
        text, inner = _plain(action.text()), action.menu()
        if not action.isVisible() or action.isSeparator() or action.objectName().startswith("show_help"):
            continue
        if isinstance(inner, QMenu):
            yield from _of_menu(window, inner, top, text)
        else:
            kind = "Example" if below == "Examples" else "Command"
            title = f"{below}: {text}" if below and kind == "Command" else text
            keys = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
            if action.isEnabled():
                yield _found(kind, title, keys, action.statusTip(), action.trigger, top)
            else:  # else another one would be first, and done in its place
                say = partial(window.status.show_message, f"{title} cannot be done now")
                yield _found(kind, title, "not now", action.statusTip(), say, top)


def _plain(text: str) -> str:
    return text.partition("\t")[0].replace("&&", "\0").replace("&", "").replace("\0", "&").removesuffix("...")


def _fields(window: Window) -> Iterator[Found]:
    """Every field of the drive at hand, then of the others on its shaft."""
    session = window.session
    design, whole = session.typed, session.typed_full_design
    for table in design.tables:
        holder = session.holder(table)
        if table == "motion":
            stroke = stroke_entry(design)
            yield _field(window, design, stroke, stroke.path, "")
        yield from (_field(window, holder, row, row.path, "") for row in rows_of(holder, table))
    for i in range(len(whole.drives) if whole.listed else 0):
        if i != session.chosen:
            drive = only(whole, i)
            for table in drive.tables:
                if table != "shaft":
                    for row in rows_of(drive, table):
                        yield _field(window, drive, row, path_of(i, row.path), f"{whole.drives[i].name}: ")


def _field(window: Window, design: Design, row: Entry, path: str, drive: str) -> Found:
    name = f"{drive}{entry_name(design, row)}"
    symbol = symbol_of(row.unit.symbol)
    number = isinstance(row.value, int | float) and not row.info.choices and not row.info.flag
    shown = value_text(row.value, row.unit) if number else choice_text(row.value) if row.value is not None else symbol
    return _found(
        "Field",
        name,
        shown,
        sentence(row.info.help),
        partial(window.focus_field, path),
        spelled(name),
        entry=row,
        path=path,
    )


def _channels(window: Window) -> Iterator[Found]:
    """Every channel of the design: its plot, else a curve more in the graph."""
    plots = {name: view for view, row in VIEWS.items() for name in row.quantities}
    for name in names_of(window.session.design):
        row = quantity(name)
        if row.slug:
            act = partial(window.show_view, plots[name]) if name in plots else partial(_draw, window, name)
            symbol = legible(row.symbol)
            more = f"{symbol} {row.symbol} {spelled(row.symbol)} {row.slug}"
            yield _found(
                "Channel", row.label, f"{symbol}, {row.unit.symbol}".rstrip(", "), legible(row.equation), act, more
            )


def _draw(window: Window, name: str) -> None:
    window.show_task("graph")
    view: Any = window.show_view("curves")
    view.show_channel(name)


def _help(window: Window) -> Iterator[Found]:
    """The pages of the help, and their sections."""
    for page, title, heading, text in sections():
        name = f"{title}: {heading}" if heading else title
        yield _found("Help", name, "", "", partial(window.show_help, page, heading), text)


def _findings(window: Window) -> Iterator[Found]:
    study = window.session.full_study
    try:
        found = findings_of(study, tuple(window.stages_on_screen()))
    except KindynaError:
        return
    for finding in found:
        yield _found("Finding", sentence(finding.message), "", "", partial(window.focus_field, finding.field))


SOURCES = (_commands, _fields, _channels, _findings, _help)
"""In the order in which equals are listed."""


# -- what matches -------------------------------------------------------------------------------------------


def rank(found: Found, words: list[str]) -> float | None:
    """How well something matches: less is better; None where a word is not in it. Of fields that match alike the weightier comes
    first, what is limited before its limit."""
    cost = 0.0
    if found.entry is not None:
        is_limit = found.entry.path.startswith("limits.")
        cost = BY_WEIGHT * (USUAL - found.entry.info.weight + is_limit)
    for word in words:
        at = found.words.find(word)
        if at < 0:
            return None
        begins = at == 0 or not found.words[at - 1].isalnum()
        cost += (0.0 if at == 0 else 1.0 if begins else 3.0) if at < found.own else 12.0
        if len(word) == 1 and word in found.words[: found.own].split():  # a symbol, ``H``, before what begins with it
            cost -= SYMBOL
    return cost + 0.02 * found.own


def splits(text: str) -> Iterator[tuple[list[str], str]]:
    """A name and a value behind it, in every way a text can be read so."""
    parts = text.split()
    for at in range(1, len(parts)):
        yield _WORD.findall(folded(" ".join(parts[:at]))), " ".join(parts[at:])


def is_amount(text: str) -> bool:
    """Whether a text is one number and one unit, of whatever kind, or a number with a comma."""
    return _AMOUNT.fullmatch(text) is not None and len(text.split()) <= 2


def value_in(entry: Entry, text: str) -> Any:
    """The value that a text behind a field's name means; None where it means none."""
    if entry.info.choices:
        words = {folded(str(word)): word for word in entry.info.choices}
        words |= {folded(choice_text(str(word))): word for word in entry.info.choices}
        return words.get(folded(text))
    if entry.info.flag or not re.match(r"[-+.(\d\u2212]", text):
        return None
    value = parsed(text, entry.unit)
    return int(value) if value is not None and entry.info.whole and value == int(value) else value


class Finder(QFrame):
    """A line above a list, over the window; Enter does what is chosen, Escape goes back to where the keys were."""

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window = window
        self.all: list[Found] = []
        self.shown: list[Found] = []
        self._back: QWidget | None = None
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setAutoFillBackground(True)
        self.line = _Line(self)
        self.line.setPlaceholderText(HINT)
        self.line.setAccessibleName("Find anything")
        self.line.textChanged.connect(self._search)
        self.rows = RowsModel(
            (TableHeading("Kind"), TableHeading("What", wide=True), TableHeading("Keys, value", number=True))
        )
        self.rows.setParent(self)
        self.list = QTableView(self)
        self.list.setModel(self.rows)
        self.list.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.list.setShowGrid(False)
        self.list.setWordWrap(False)
        self.list.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.list.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.list.horizontalHeader().hide()
        self.list.verticalHeader().hide()
        self.list.verticalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.list.verticalHeader().setDefaultSectionSize(ROW)
        self.list.setColumnWidth(0, 80)
        self.list.setColumnWidth(2, 150)
        self.list.horizontalHeader().setSectionResizeMode(1, QHeaderView.ResizeMode.Stretch)
        self.list.clicked.connect(lambda _: self.take())
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(self.line)
        column.addWidget(self.list)
        self.hide()

    def open(self) -> None:
        """Come to the front, empty; where it is there already, go."""
        if self.isVisible():
            self.leave()
            return
        self._back = self._window.focusWidget()
        self._window.documents.settle()
        self.all = [found for source in SOURCES for found in source(self._window)]
        room = self._window.contentsRect()
        width = min(WIDTH, room.width() - 20)
        self.setGeometry((room.width() - width) // 2, 60, width, 60 + ROW * SHOWN)
        self.line.clear()
        self._search("")
        self.show()
        self.raise_()
        self.line.setFocus(Qt.FocusReason.ShortcutFocusReason)

    def leave(self) -> None:
        """Go, and give the keys back."""
        self.hide()
        if self._back is not None and isValid(self._back) and self._back.isVisible():
            self._back.setFocus(Qt.FocusReason.OtherFocusReason)
        self._back = None

    def _search(self, text: str) -> None:
        words = _WORD.findall(folded(text))
        ranked = [(cost, i, found) for i, found in enumerate(self.all) if (cost := rank(found, words)) is not None]
        ranked += self._settings(text, len(self.all))
        ranked.sort(key=lambda each: each[:2])
        self.shown = [found for _, _, found in ranked[:MOST]]
        rows = [TableRow((found.kind, found.title, found.beside), tip=found.tip) for found in self.shown]
        self.rows.show(rows or [TableRow(("", f"{NOTHING} {text.strip()}", ""))])
        if self.shown:
            self.list.selectRow(0)

    def _settings(self, text: str, first: int) -> Iterator[tuple[float, int, Found]]:
        """Fields that a typed value is for; they come before all else, those that refuse its unit behind what is called so."""
        for words, typed in splits(text):
            for i, found in enumerate(self.all):
                if found.entry is not None and (cost := rank(found, words)) is not None and cost < 10.0:
                    made = self._setting(found, typed)
                    if made is not None:
                        yield cost + (FIRST if made.kind == "Set" else BEHIND_NAMES), first + i, made

    def _setting(self, found: Found, typed: str) -> Found | None:
        assert found.entry is not None
        info, unit = found.entry.info, found.entry.unit
        value = value_in(found.entry, typed)
        if value is None:
            return self._refusal(found, typed)
        shown = value_text(value, unit) if not info.choices else choice_text(str(value))
        if not info.admits(value):
            tip = f"outside its range; allowed: {allowed_text(info, unit)}"
            return _found("Set", f"{found.title}: {shown} is {tip}", "", tip, found.act)
        return _found("Set", f"{found.title} to {shown}", found.beside, found.tip, partial(self._set, found, value))

    def _refusal(self, found: Found, typed: str) -> Found | None:
        """Why a number with a unit behind it, ``420 kg``, sets nothing; None where it is no such thing."""
        entry = found.entry
        if entry is None or entry.info.choices or entry.info.flag or not is_amount(typed):
            return None
        units = ", ".join(compatible_units(entry.unit.symbol))
        tip = f"its units are {units}" if units else "it has no unit"
        if "," in typed and value_in(entry, typed.replace(",", ".")) is not None:
            tip = no_number(typed)
        return _found("Refused", f"{found.title}: {typed} is none of its values; {tip}", "", tip, found.act)

    def _set(self, found: Found, value: Any) -> None:
        session, entry = self._window.session, found.entry
        assert entry is not None
        session.end_gesture()
        text = step_text(found.title, value, entry.unit)
        if session.edit(found.path, value, text):
            self._window.status.show_message(text)
        session.end_gesture()

    def take(self) -> None:
        """Do what is chosen."""
        if self.shown:
            found = self.shown[self.list.currentIndex().row()]
            self.leave()
            found.act()

    def move_by(self, rows: int) -> None:
        """Choose another row."""
        if self.shown:
            self.list.selectRow(min(max(self.list.currentIndex().row() + rows, 0), len(self.shown) - 1))


class _Line(QLineEdit):
    """Where is typed; the keys that choose go to the list."""

    def __init__(self, finder: Finder) -> None:
        super().__init__(finder)
        self._finder = finder

    def keyPressEvent(self, event: QKeyEvent) -> None:
        key = Qt.Key(event.key())
        if key in _MOVES:
            self._finder.move_by(_MOVES[key])
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._finder.take()
        elif key == Qt.Key.Key_Escape:
            self._finder.leave()
        else:
            super().keyPressEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        if event.reason() in (Qt.FocusReason.MouseFocusReason, Qt.FocusReason.TabFocusReason):
            self._finder.hide()


__all__ = ["Finder", "Found", "folded", "rank", "splits", "value_in"]
