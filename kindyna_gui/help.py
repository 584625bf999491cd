"""The help: a few pages of Markdown in a window of their own."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QTextBlockFormat, QTextCharFormat, QTextCursor, QTextDocument
from PySide6.QtWidgets import QHBoxLayout, QListWidget, QListWidgetItem, QTextBrowser, QWidget

from core.design import entries
from core.laws import LAWS
from core.materials import MATERIALS
from kindyna_gui.labels import SECTION_NAMES, entry_name, sentence
from kindyna_gui.places import help_text, lesson_files

_RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
_HEADINGS: Mapping[int, tuple[int, float, float]] = MappingProxyType({1: (2, 0.0, 8.0), 2: (1, 14.0, 4.0)})
"""Level of a heading -> steps larger than the text, room above and below [pixels]."""


def _formula(text: str) -> str:
    """A formula as printed: π and raised exponents."""
    raised = re.sub(r"\^(\d+)", lambda m: m[1].translate(_RAISED), text)
    return re.sub(r"(?:(?<=\d) )?\bpi\b(?: (?=\w))?", "π", raised).replace(" - ", " \u2212 ")


def _laws(page: str, host: Any) -> str:
    """The table of laws stands in the core, not in the page."""
    rows = "\n".join(
        f"| {law.label} | {law.short_name} | `{slug}` | {_formula(law.source)} |" for slug, law in LAWS.items()
    )
    return page.replace("{laws}", f"| law | in small plots | in the file | formula |\n|---|---|---|---|\n{rows}")


def _materials(page: str, host: Any) -> str:
    """So does that of materials."""
    rows = "\n".join(
        f"| {each.name} | `{slug}` | {each.youngs_modulus_gpa:g} | {each.poisson_ratio:g} | {each.source} | "
        f"{'' if each.contact_pressure_mpa is None else f'{each.contact_pressure_mpa:g}'} | {each.pressure_source} |"
        for slug, each in MATERIALS.items()
    )
    head = "| material | in the file | E, GPa | ν | source | bears MPa | source |\n|---|---|---|---|---|---|---|\n"
    return page.replace("{materials}", head + rows)


def _controllers(page: str, host: Any) -> str:
    """And that of controllers, with what is open of each."""
    from core.output.controllers.rows import shipped_controllers

    rows = shipped_controllers().values()
    table = "\n".join(f"| {row.label} | `{row.slug}` | {', '.join(row.interpolation)} | {row.source} |" for row in rows)
    facts = "\n".join(f"- **{row.label}**: {'; '.join(row.open)}." for row in rows if row.open)
    head = "| controller | slug | between two rows | source |\n|---|---|---|---|\n"
    return page.replace("{controllers}", head + table).replace("{open}", facts)


def _tutorials(page: str, host: Any) -> str:
    """The steps of every lesson, each with the window as it is when it is done."""
    parts = []
    for file in lesson_files():
        lesson = tomllib.loads(file.read_text("utf-8"))
        parts.append(f"## {lesson['title']}\n")
        for number, step in enumerate(lesson["steps"], 1):
            text = re.sub(r"</?b>", "**", re.sub(r"</?i>", "*", step["text"]))
            parts.append(f"{number}. {text}\n\n![Step {number}](tutorial_{file.stem}_{number:02}.png)\n")
    return page.replace("{tutorials}", "\n".join(parts))


def _as_is(page: str, host: Any) -> str:
    return page


def _fields(page: str, host: Any) -> str:
    """Every field of the design at hand, from what is known of it."""
    if host is None:
        return page
    session, tables = host.session, []
    parts = [(session.typed, name) for name in session.typed.tables]
    if session.several:
        whole = session.typed_full_design
        parts += [(whole, name) for name in (f"drives[{session.chosen}]", "balancer") if name in whole.tables]
    for design, name in parts:
        cells = [
            (entry_name(design, row), sentence(row.info.help), row.info.allowed(row.unit), f"`{row.path}`")
            for row in entries(design, name)
        ]
        rows = ["| " + " | ".join(cell.replace("|", r"\|") for cell in row) + " |" for row in cells]
        head = "| field | what it is | allowed | in the file |\n|---|---|---|---|"
        title = SECTION_NAMES.get(name, "On the shaft" if name.startswith("drives[") else sentence(name))
        tables.append("\n".join((f"## {title}\n", head, *rows)))
    return page.replace("{fields}", "\n\n".join(tables))


def _keys(page: str, host: Any) -> str:
    """The keys of the menus."""
    if host is None:
        return page
    rows = [
        f"| **{action.shortcut().toString()}** | {action.text().replace('&', '').removesuffix('...')} | {action.statusTip()} |"
        for action in host.actions_by_key.values()
        if not action.shortcut().isEmpty()
    ]
    return page.replace("{keys}", "\n".join(("| key | command | |\n|---|---|---|", *rows)))


def _without_comments(page: str, host: Any) -> str:
    return re.sub(r"<!--.*?-->\n?", "", page)


PAGES: Mapping[str, tuple[str, Callable[[str, Any], str]]] = MappingProxyType(
    {
        "tour": ("Tour", _as_is),
        "tutorials": ("Tutorials", _tutorials),
        "shortcuts": ("Shortcuts", _keys),
        "preferences": ("Preferences", _as_is),
        "fields": ("Fields of this design", _fields),
        "making": ("Making a motion", _as_is),
        "blending": ("Blended motions", _as_is),
        "followers": ("Followers", _materials),
        "finding": ("Finding dimensions", _as_is),
        "studies": ("Studies of many designs", _as_is),
        "linkages": ("Linkages", _as_is),
        "camshaft": ("Several cams on one shaft", _as_is),
        "timing": ("Timing of several drives", _as_is),
        "stability": ("Stability of the camshaft", _as_is),
        "papers": ("The four papers", _as_is),
        "controllers": ("Controllers", _controllers),
        "graphs": ("Curves on one graph", _as_is),
        "laws": ("Laws and conventions", _laws),
        "speed": ("Run time against error", _without_comments),
        "architecture": ("Architecture", _as_is),
        "changes": ("What has changed", _as_is),
    }
)
"""File of ``resources/help`` -> title, and what completes the page: with tables, with what the window at hand shows."""


@cache
def sections() -> tuple[tuple[str, str, str, str], ...]:
    """What can be looked for: page, its title, heading, the text below it; without heading what stands before the first."""
    found: list[tuple[str, str, str, str]] = []
    for name, (title, _) in PAGES.items():
        first, *others = re.split(r"^##+ ", help_text(name), flags=re.MULTILINE)
        found.append((name, title, "", first))
        found += [(name, title, *each.partition("\n")[::2]) for each in others]
    return tuple(found)


def space(page: QTextDocument) -> None:
    """Give headings their size and every paragraph some room: Markdown knows neither.

    As one edit: else each change of a cell would lay its whole table out anew.
    """
    edit = QTextCursor(page)
    edit.beginEditBlock()
    block = page.begin()
    while block.isValid():
        cursor, form = QTextCursor(block), QTextBlockFormat(block.blockFormat())
        larger, above, below = _HEADINGS.get(form.headingLevel(), (0, 0.0, 2.0 if block.textList() else 7.0))
        form.setTopMargin(above)
        form.setBottomMargin(0.0 if cursor.currentTable() else below)
        cursor.setBlockFormat(form)
        if larger:
            letters = QTextCharFormat()
            letters.setProperty(QTextCharFormat.Property.FontSizeAdjustment, larger)
            cursor.select(QTextCursor.SelectionType.BlockUnderCursor)
            cursor.mergeCharFormat(letters)
        block = block.next()
    edit.endEditBlock()


def _with_session(widget: QWidget | None) -> Any:
    """The window around a widget; None where it stands alone."""
    while widget is not None and not hasattr(widget, "actions_by_key"):
        widget = widget.parentWidget()
    return widget


class HelpWindow(QWidget):
    """Pages at the left, text at the right; links lead from page to page."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self._host = _with_session(parent)
        self.setWindowTitle("KINDYNA help")
        self.resize(820, 640)
        self.list = QListWidget()
        self.list.setFixedWidth(180)
        self.list.setSpacing(2)
        for name, (title, _) in PAGES.items():
            item = QListWidgetItem(title, self.list)
            item.setData(Qt.ItemDataRole.UserRole, name)
        self.text = QTextBrowser()
        self.text.setOpenLinks(False)
        self.text.document().setDocumentMargin(20)
        self.text.anchorClicked.connect(self._follow)
        self.list.currentItemChanged.connect(lambda item, _: self._show(item.data(Qt.ItemDataRole.UserRole)))
        layout = QHBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addWidget(self.list)
        layout.addWidget(self.text, 1)

    def open(self, name: str, words: str = "") -> None:
        """Show a page, in front of everything, at these words."""
        row = list(PAGES).index(name)
        if self.list.currentRow() == row:
            self._show(name)  # of what the window shows now
        self.list.setCurrentRow(row)
        self.show()
        self.raise_()
        self.activateWindow()
        if words:
            self.text.moveCursor(QTextCursor.MoveOperation.End)  # so that the place found comes to the top
            found = self.text.document().find(words)
            self.text.setTextCursor(found if not found.isNull() else QTextCursor(self.text.document()))

    def _show(self, name: str) -> None:
        self.text.setMarkdown(PAGES[name][1](help_text(name), self._host))
        space(self.text.document())

    def _follow(self, link: QUrl) -> None:
        name = link.toString().removesuffix(".md")
        if name in PAGES:
            self.list.setCurrentRow(list(PAGES).index(name))
