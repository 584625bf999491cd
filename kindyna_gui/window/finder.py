"""Edit > Find anything: searches commands, fields, channels, examples, help and findings by words or symbols.

A value after the name of a field sets the field. ``rank`` orders the matches; ``SOURCES`` lists what is searched.
"""

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
from core.units import compatible_units, unit_symbol
from kindyna_gui.forms.form import rows_of
from kindyna_gui.forms.number_box import parsed
from kindyna_gui.forms.tables import RowsModel, TableHeading, TableRow
from kindyna_gui.help import sections
from kindyna_gui.labels import allowed_text, choice_text, entry_name, no_number, sentence, step_text, value_text
from kindyna_gui.look import described
from kindyna_gui.motion.header import stroke_entry
from kindyna_gui.pictures.units import legible
from kindyna_gui.rebuilt import fill
from kindyna_gui.settings import symbol_of
from kindyna_gui.window.base import Window
from kindyna_gui.window.result_plots import show_quantity

MOST = 40  # largest number of rows in the list
WIDTH, ROW, SHOWN = 620, 24, 14  # width of the list and height of a row [pixels]; rows visible without scrolling
NOTHING = "No match for"
REFUSED = "Refused"  # kind of a value that a field does not take
HINT = "Command, field, channel, example, help, finding; base radius 420 sets the field"
_MOVES = MappingProxyType(
    {Qt.Key.Key_Up: -1, Qt.Key.Key_Down: 1, Qt.Key.Key_PageUp: -SHOWN, Qt.Key.Key_PageDown: SHOWN}
)
BY_WEIGHT, SYMBOL = 0.2, 3.0  # rank added for each weight a field lacks; rank subtracted for a symbol
FIRST, SECOND, AFTER_NAMES = -100.0, -50.0, 10.0
"""Rank added for a value to set; for one that is refused; for an amount in an unknown unit: ``segment 2 span`` is a name."""
_AMOUNT = re.compile(r"[-+\u2212]?[\d.,]+\s*((?:[^\W\d_]|[°%\"/]).*)|[-+\u2212]?\d+,\d+")
_WORD = re.compile(r"[\w°%µ/|∠.+-]+")


@frozen
class Match:
    """One thing that can be found.

    Attributes
    ----------
    kind, title, tip : str
        As listed.
    detail : str
        Its keys, value or unit.
    words : str
        Folded title, symbol and further words; the first ``title_length`` characters are the title.
    act : Callable
        Called when it is chosen.
    entry, path : Entry, str
        Of a field, with its path in the design's file.
    """

    kind: str
    title: str
    detail: str
    tip: str
    words: str
    title_length: int
    act: Callable[[], object]
    entry: Entry | None = None
    path: str = ""


@lru_cache(maxsize=8192)
def folded(text: str) -> str:
    """Return a text without capitals, accents and subscripts: ``α₀`` and ``α_0`` become ``α0``."""
    plain = unicodedata.normalize("NFKC", text).casefold().replace("_", "").replace("\u2212", "-")
    return "".join(letter for letter in plain if not unicodedata.combining(letter) and letter not in "&…")


def greek_names(symbol: str) -> str:
    """Return the names of the Greek letters in a symbol: ``alpha``."""
    names = (unicodedata.name(letter, "") for letter in symbol)
    return " ".join(name.rpartition(" ")[2].lower() for name in names if name.startswith("GREEK"))


def _match(
    kind: str, title: str, detail: str, tip: str, act: Callable[[], object], more: str = "", **field: Any
) -> Match:
    name = folded(title)
    return Match(kind, title, detail, tip, f"{name} {folded(more)} {folded(tip)}", len(name), act, **field)


# -- what is searched -------------------------------------------------------------------------------------


def _commands(window: Window) -> Iterator[Match]:
    """Entries of all menus for the current design."""
    for top in window.menuBar().actions():
        menu = top.menu()
        if isinstance(menu, QMenu):
            menu.aboutToShow.emit()
            yield from _entries(window, menu, _plain(top.text()), "")


def _entries(window: Window, menu: QMenu, top: str, below: str) -> Iterator[Match]:
    for action in menu.actions():
        text, inner = _plain(action.text()), action.menu()
        if not action.isVisible() or action.isSeparator() or action.objectName().startswith("show_help"):
            continue
        if isinstance(inner, QMenu):
            yield from _entries(window, inner, top, text)
        else:
            kind = "Example" if below == "Examples" else "Command"
            title = f"{below}: {text}" if below and kind == "Command" else text
            keys = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
            if action.isEnabled():
                yield _match(kind, title, keys, action.statusTip(), action.trigger, top)
            else:  # listed too, else Enter would trigger another command
                say = partial(window.status.show_message, f"{title} is not available now")
                yield _match(kind, title, "not available", action.statusTip(), say, top)


def _plain(text: str) -> str:
    return text.partition("\t")[0].replace("&&", "\0").replace("&", "").replace("\0", "&").removesuffix("...")


def _fields(window: Window) -> Iterator[Match]:
    """Fields of the current drive, then of the other drives on its shaft."""
    session = window.session
    design, full = session.typed, session.typed_full_design
    for table in design.tables:
        holder = session.holder(table)
        if table == "motion":
            stroke = stroke_entry(design)
            yield _field(window, design, stroke, stroke.path, "")
        yield from (_field(window, holder, row, row.path, "") for row in rows_of(holder, table))
    for i in range(len(full.drives) if full.listed else 0):
        if i != session.chosen:
            drive = only(full, i)
            for table in drive.tables:
                if table != "shaft":
                    for row in rows_of(drive, table):
                        yield _field(window, drive, row, path_of(i, row.path), f"{full.drives[i].name}: ")


def _field(window: Window, design: Design, row: Entry, path: str, drive: str) -> Match:
    name = f"{drive}{entry_name(design, row)}"
    symbol = symbol_of(row.unit.symbol)
    number = isinstance(row.value, int | float) and not row.info.choices and not row.info.flag
    shown = value_text(row.value, row.unit) if number else choice_text(row.value) if row.value is not None else symbol
    return _match(
        "Field",
        name,
        shown,
        sentence(row.info.help),
        partial(window.focus_field, path),
        greek_names(name),
        entry=row,
        path=path,
    )


def _channels(window: Window) -> Iterator[Match]:
    """Channels of the design; choosing one shows its plot, or else adds it to the graph."""
    for name in names_of(window.session.design):
        row = quantity(name)
        if row.slug:
            act = partial(show_quantity, window, name)
            symbol = legible(row.symbol)
            more = f"{symbol} {row.symbol} {greek_names(row.symbol)} {row.slug}"
            yield _match(
                "Channel", row.label, f"{symbol}, {row.unit.symbol}".rstrip(", "), legible(row.equation), act, more
            )


def _paths(window: Window) -> Iterator[Match]:
    """Paths of the points of a linkage; choosing one shows it in the drawing."""
    if window.session.typed.drive.links:
        from kindyna_gui.linkage.point_paths import path_points

        for name in path_points(window.session.typed.drive.linkage):
            more = "show trace of the point, coupler curve"
            yield _match(
                "Command", f"Path of {name}", "", "Show the path of this point", partial(_trace, window, name), more
            )


def _trace(window: Window, name: str) -> None:
    view: Any = window.show_view("mechanism")
    if not view.paths.is_shown(name):
        view.paths.toggle(name)


def _help(window: Window) -> Iterator[Match]:
    """Pages and sections of the help."""
    for page, title, heading, text in sections():
        name = f"{title}: {heading}" if heading else title
        yield _match("Help", name, "", "", partial(window.show_help, page, heading), text)


def _findings(window: Window) -> Iterator[Match]:
    study = window.session.full_study
    try:
        findings = findings_of(study, tuple(window.stages_on_screen()))
    except KindynaError:
        return
    for finding in findings:
        yield _match("Finding", sentence(finding.message), "", "", partial(window.focus_field, finding.field))


SOURCES = (_commands, _paths, _fields, _channels, _findings, _help)
"""Sources in the order in which equal matches are listed."""


# -- how matches are ranked -------------------------------------------------------------------------------


def rank(match: Match, words: list[str]) -> float | None:
    """Return how well a match fits the words, less is better; None where a word is missing.

    Of fields that fit equally, the more important comes first, and a value before its limit.
    """
    cost = 0.0
    if match.entry is not None:
        is_limit = match.entry.path.startswith("limits.")
        cost = BY_WEIGHT * (USUAL - match.entry.info.weight + is_limit)
    for word in words:
        at = match.words.find(word)
        if at < 0:
            return None
        begins = at == 0 or not match.words[at - 1].isalnum()
        cost += (0.0 if at == 0 else 1.0 if begins else 3.0) if at < match.title_length else 12.0
        if len(word) == 1 and word in match.words[: match.title_length].split():  # a symbol comes before longer words
            cost -= SYMBOL
    return cost + 0.02 * match.title_length


def splits(text: str) -> Iterator[tuple[list[str], str]]:
    """Yield each way to read a text as the words of a name and a value."""
    parts = text.split()
    for at in range(1, len(parts)):
        yield _WORD.findall(folded(" ".join(parts[:at]))), " ".join(parts[at:])


def rank_of_amount(text: str) -> float | None:
    """Rank added for a number with a unit, or with a comma, that a field refuses; None where the text is no such number."""
    match = _AMOUNT.fullmatch(text) if len(text.split()) <= 2 else None
    if match is None:
        return None
    return SECOND if match[1] is None or unit_symbol(match[1]) else AFTER_NAMES


def value_in(entry: Entry, text: str) -> Any:
    """Return the value that a text means for a field; None where it is not a value of the field."""
    if entry.info.choices:
        words = {folded(str(word)): word for word in entry.info.choices}
        words |= {folded(choice_text(str(word))): word for word in entry.info.choices}
        return words.get(folded(text))
    if entry.info.flag or not re.match(r"[-+.(\d\u2212]", text):
        return None
    value = parsed(text, entry.unit)
    return int(value) if value is not None and entry.info.whole and value == int(value) else value


class Finder(QFrame):
    """A search line above a list, over the window; Enter chooses a row, Escape returns the focus."""

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window = window
        self.all: list[Match] = []
        self.shown: list[Match] = []
        self._back: QWidget | None = None
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setAutoFillBackground(True)
        self.line = described(_Line(self), name="Find anything")
        self.line.setPlaceholderText(HINT)
        self.line.textChanged.connect(self._search)
        self.rows = RowsModel(
            (TableHeading("Kind"), TableHeading("What", wide=True), TableHeading("Keys, value", number=True))
        )
        self.rows.setParent(self)
        self.list = QTableView(self, showGrid=False, wordWrap=False)
        self.list.setModel(self.rows)
        self.list.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.list.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.list.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.list.horizontalHeader().hide()
        self.list.verticalHeader().hide()
        self.list.verticalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.list.verticalHeader().setDefaultSectionSize(ROW)
        self.list.setColumnWidth(0, 80)
        self.list.setColumnWidth(2, 150)
        self.list.horizontalHeader().setSectionResizeMode(1, QHeaderView.ResizeMode.Stretch)
        self.list.clicked.connect(lambda _: self.choose())
        fill(QVBoxLayout(self), self.line, self.list, margins=6)
        self.hide()

    def open(self) -> None:
        """Show the finder, empty; hide it if it is visible."""
        if self.isVisible():
            self.leave()
            return
        self._back = self._window.focusWidget()
        self._window.documents.settle()
        self.all = [match for source in SOURCES for match in source(self._window)]
        room = self._window.contentsRect()
        width = min(WIDTH, room.width() - 20)
        self.setGeometry((room.width() - width) // 2, 60, width, 60 + ROW * SHOWN)
        self.line.clear()
        self._search("")
        self.show()
        self.raise_()
        self.line.setFocus(Qt.FocusReason.ShortcutFocusReason)

    def leave(self) -> None:
        """Hide the finder and return the focus."""
        self.hide()
        if self._back is not None and isValid(self._back) and self._back.isVisible():
            self._back.setFocus(Qt.FocusReason.OtherFocusReason)
        self._back = None

    def _search(self, text: str) -> None:
        words = _WORD.findall(folded(text))
        ranked = [(cost, i, match) for i, match in enumerate(self.all) if (cost := rank(match, words)) is not None]
        ranked += self._settings(text, len(self.all))
        ranked.sort(key=lambda row: row[:2])
        self.shown = [match for _, _, match in ranked[:MOST]]
        rows = [TableRow((match.kind, match.title, match.detail), tip=match.tip) for match in self.shown]
        self.rows.show(rows or [TableRow(("", f"{NOTHING} {text.strip()}", ""))])
        self.list.clearSpans()
        for number, row in enumerate(rows):
            if not row.cells[-1]:  # a sentence, such as that of a refused value, has the room of keys and values too
                self.list.setSpan(number, 1, 1, 2)
        if self.shown:
            self.list.selectRow(0)

    def _settings(self, text: str, first: int) -> Iterator[tuple[float, int, Match]]:
        """Fields that a typed value can set, then those that refuse it, ranked before all matches."""
        for words, typed in splits(text):
            for i, match in enumerate(self.all):
                if match.entry is not None and (cost := rank(match, words)) is not None and cost < 10.0:
                    added, setting = self._setting(match, typed)
                    if setting is not None:
                        yield cost + added, first + i, setting

    def _setting(self, match: Match, typed: str) -> tuple[float, Match | None]:
        """Rank to add, and what setting a field to a typed value does; None where the text is no value."""
        assert match.entry is not None
        info, unit = match.entry.info, match.entry.unit
        value = value_in(match.entry, typed)
        if value is None:
            return self._refusal(match, typed)
        shown = value_text(value, unit) if not info.choices else choice_text(str(value))
        if not info.admits(value):
            tip = f"outside its range; allowed: {allowed_text(info, unit)}"
            return FIRST, _match(REFUSED, f"{match.title}: {shown} is {tip}", "", tip, match.act)
        act = partial(self._set, match, value)
        return FIRST, _match("Set", f"{match.title} to {shown}", match.detail, match.tip, act)

    def _refusal(self, match: Match, typed: str) -> tuple[float, Match | None]:
        """Why a number with a unit, ``420 kg``, cannot be set; None where the text is no such number."""
        entry, added = match.entry, rank_of_amount(typed)
        if entry is None or entry.info.choices or entry.info.flag or added is None:
            return AFTER_NAMES, None
        units = ", ".join(compatible_units(entry.unit.symbol))
        tip = f"its units are {units}" if units else "it has no unit"
        if "," in typed and value_in(entry, typed.replace(",", ".")) is not None:
            tip = no_number(typed)
        return added, _match(REFUSED, f"{match.title}: {typed} is not a valid value; {tip}", "", tip, match.act)

    def _set(self, match: Match, value: Any) -> None:
        session, entry = self._window.session, match.entry
        assert entry is not None
        text = step_text(match.title, value, entry.unit)
        with session.one_step():
            if session.edit(match.path, value, text):
                self._window.status.show_message(text)

    def enter(self) -> None:
        """Act on the selected row, unless it is a refused value, whose reason it states."""
        if self.shown and self.shown[self.list.currentIndex().row()].kind != REFUSED:
            self.choose()

    def choose(self) -> None:
        """Act on the selected row; a refused value shows its field."""
        if self.shown:
            match = self.shown[self.list.currentIndex().row()]
            self.leave()
            match.act()

    def move_by(self, rows: int) -> None:
        """Select a row further down, or up where ``rows`` is negative."""
        if self.shown:
            self.list.selectRow(min(max(self.list.currentIndex().row() + rows, 0), len(self.shown) - 1))


class _Line(QLineEdit):
    """The search line; keys that select or choose a row act on the list."""

    def __init__(self, finder: Finder) -> None:
        super().__init__(finder)
        self._finder = finder

    def keyPressEvent(self, event: QKeyEvent) -> None:
        key = Qt.Key(event.key())
        if key in _MOVES:
            self._finder.move_by(_MOVES[key])
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._finder.enter()
        elif key == Qt.Key.Key_Escape:
            self._finder.leave()
        else:
            super().keyPressEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        if event.reason() in (Qt.FocusReason.MouseFocusReason, Qt.FocusReason.TabFocusReason):
            self._finder.hide()


__all__ = ["Finder", "Match", "folded", "rank", "splits", "value_in"]
