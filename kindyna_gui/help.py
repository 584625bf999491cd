"""The help window: pages of Markdown, some completed with tables of laws, materials, controllers, fields and keys."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QImage, QImageReader, QTextBlockFormat, QTextCharFormat, QTextCursor, QTextDocument
from PySide6.QtWidgets import QHBoxLayout, QListWidget, QListWidgetItem, QTextBrowser, QWidget

from core.design import entries
from core.laws import LAWS
from core.materials import MATERIALS
from core.process import resources
from kindyna_gui.labels import SECTION_NAMES, entry_name, sentence
from kindyna_gui.places import help_text, lesson_files
from kindyna_gui.rebuilt import close_by_escape, fill

_RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
_HEADINGS: Mapping[int, tuple[int, float, float]] = MappingProxyType({1: (2, 0.0, 8.0), 2: (1, 14.0, 4.0)})
"""Level of a heading -> steps larger than the text, room above and below [pixels]."""

# -- completing pages ------------------------------------------------------------------------------------


def _formula(text: str) -> str:
    """A formula as printed: π and raised exponents."""
    raised = re.sub(r"\^(\d+)", lambda m: m[1].translate(_RAISED), text)
    return re.sub(r"(?:(?<=\d) )?\bpi\b(?: (?=\w))?", "π", raised).replace(" - ", " \u2212 ")


def _laws(page: str, host: Any) -> str:
    """Insert the table of laws."""
    rows = "\n".join(
        f"| {law.label} | {law.short_name} | `{slug}` | {_formula(law.source)} |" for slug, law in LAWS.items()
    )
    return page.replace("{laws}", f"| law | in small plots | in the file | formula |\n|---|---|---|---|\n{rows}")


def _materials(page: str, host: Any) -> str:
    """Insert the table of materials."""
    rows = "\n".join(
        f"| {row.name} | `{slug}` | {row.youngs_modulus_gpa:g} | {row.poisson_ratio:g} | {row.source} | "
        f"{'' if row.contact_pressure_mpa is None else f'{row.contact_pressure_mpa:g}'} | {row.pressure_source} |"
        for slug, row in MATERIALS.items()
    )
    header = "| material | in the file | E, GPa | ν | source | allowable pressure, MPa | source |\n"
    return page.replace("{materials}", f"{header}|---|---|---|---|---|---|---|\n{rows}")


def _controllers(page: str, host: Any) -> str:
    """Insert the table of controllers and their open questions."""
    from core.output.controllers.rows import shipped_controllers

    rows = shipped_controllers().values()
    table = "\n".join(f"| {row.label} | `{row.slug}` | {', '.join(row.interpolation)} | {row.source} |" for row in rows)
    facts = "\n".join(f"- **{row.label}**: {'; '.join(row.open)}." for row in rows if row.open)
    header = "| controller | slug | between two rows | source |\n|---|---|---|---|\n"
    return page.replace("{controllers}", header + table).replace("{open}", facts)


def _tutorials(page: str, host: Any) -> str:
    """Insert the steps of every tutorial, each with an image of the window after it."""
    parts = []
    for file in lesson_files():
        lesson = tomllib.loads(file.read_text("utf-8"))
        parts.append(f"## {lesson['title']}\n")
        for number, step in enumerate(lesson["steps"], 1):
            text = re.sub(r"</?b>", "**", re.sub(r"</?i>", "*", step["text"]))
            parts.append(f"{number}. {text}\n\n![Step {number}](tutorial_{file.stem}_{number:02}.webp)\n")
    return page.replace("{tutorials}", "\n".join(parts))


def _as_is(page: str, host: Any) -> str:
    return page


def _fields(page: str, host: Any) -> str:
    """Insert a table of the current design's fields for each section."""
    if host is None:
        return page
    session, tables = host.session, []
    parts = [(session.typed, name) for name in session.typed.tables]
    if session.has_several_drives:
        full = session.typed_full_design
        parts += [(full, name) for name in (f"drives[{session.chosen}]", "balancer") if name in full.tables]
    for design, name in parts:
        cells = [
            (entry_name(design, row), sentence(row.info.help), row.info.allowed(row.unit), f"`{row.path}`")
            for row in entries(design, name)
        ]
        rows = ["| " + " | ".join(cell.replace("|", r"\|") for cell in row) + " |" for row in cells]
        header = "| field | what it is | allowed | in the file |\n|---|---|---|---|"
        title = SECTION_NAMES.get(name, "On the shaft" if name.startswith("drives[") else sentence(name))
        tables.append("\n".join((f"## {title}\n", header, *rows)))
    return page.replace("{fields}", "\n\n".join(tables))


def _keys(page: str, host: Any) -> str:
    """Insert the table of the menus' keys."""
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


# -- pages -----------------------------------------------------------------------------------------------

PAGES: Mapping[str, tuple[str, Callable[[str, Any], str]]] = MappingProxyType(
    {
        "tour": ("Tour", _as_is),
        "tutorials": ("Tutorials", _tutorials),
        "shortcuts": ("Shortcuts", _keys),
        "preferences": ("Preferences", _as_is),
        "fields": ("Fields of this design", _fields),
        "python": ("From Python", _as_is),
        "making": ("Making a motion", _as_is),
        "blending": ("Blended motions", _as_is),
        "followers": ("Followers", _materials),
        "spatial": ("Cams in space", _as_is),
        "finding": ("Finding dimensions", _as_is),
        "studies": ("Studies of many designs", _as_is),
        "linkages": ("Linkages", _as_is),
        "camshaft": ("Several cams on one shaft", _as_is),
        "timing": ("Timing of several drives", _as_is),
        "clearance": ("Clearance of moving parts", _as_is),
        "valves": ("Valve trains", _as_is),
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
"""File of ``resources/help`` -> title, and the function that completes the page for a window."""


@cache
def sections() -> tuple[tuple[str, str, str, str], ...]:
    """Return the sections of all pages: page, its title, heading (empty before the first one), and text."""
    rows: list[tuple[str, str, str, str]] = []
    for name, (title, _) in PAGES.items():
        introduction, *parts = re.split(r"^##+ ", help_text(name), flags=re.MULTILINE)
        rows.append((name, title, "", introduction))
        rows += [(name, title, *part.partition("\n")[::2]) for part in parts]
    return tuple(rows)


def space(page: QTextDocument) -> None:
    """Set the size of headings and the space around paragraphs, which Markdown does not define.

    One edit for all: else each change of a cell would lay out its table again.
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
            characters = QTextCharFormat()
            characters.setProperty(QTextCharFormat.Property.FontSizeAdjustment, larger)
            cursor.select(QTextCursor.SelectionType.BlockUnderCursor)
            cursor.mergeCharFormat(characters)
        block = block.next()
    edit.endEditBlock()


# -- the window ------------------------------------------------------------------------------------------


def _main_window(widget: QWidget | None) -> Any:
    """The main window around a widget, None if there is none."""
    while widget is not None and not hasattr(widget, "actions_by_key"):
        widget = widget.parentWidget()
    return widget


class HelpText(QTextBrowser):
    """Text of a page; its images are in the folder of help, and no wider than the text."""

    def loadResource(self, kind: int, name: QUrl | str) -> Any:
        if kind != QTextDocument.ResourceType.ImageResource.value:
            return super().loadResource(kind, name)
        reader = QImageReader(str(resources() / "help" / QUrl(name).fileName()))
        ratio, size = self.devicePixelRatioF(), reader.size()
        beside = self.verticalScrollBar().sizeHint().width() + 2 * self.frameWidth()
        width = ratio * (self.width() - beside - 2.0 * self.document().documentMargin())
        if size.width() > width:
            reader.setScaledSize(size.scaled(round(width), size.height(), Qt.AspectRatioMode.KeepAspectRatio))
        image = reader.read().convertToFormat(QImage.Format.Format_RGB888)  # a page has up to forty images
        image.setDevicePixelRatio(ratio)
        return image


class HelpWindow(QWidget):
    """Pages at the left, text at the right; links lead from page to page."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self._host = _main_window(parent)
        self.setWindowTitle("KINDYNA help")
        self.resize(820, 640)
        self.list = QListWidget()
        self.list.setFixedWidth(180)
        self.list.setSpacing(2)
        for name, (title, _) in PAGES.items():
            item = QListWidgetItem(title, self.list)
            item.setData(Qt.ItemDataRole.UserRole, name)
        self.text = HelpText(openLinks=False)
        self.text.document().setDocumentMargin(20)
        self.text.anchorClicked.connect(self._follow)
        self.list.currentItemChanged.connect(lambda item, _: self._show(item.data(Qt.ItemDataRole.UserRole)))
        fill(QHBoxLayout(self), self.list, (self.text, 1), margins=6)
        close_by_escape(self)

    def open(self, name: str, words: str = "") -> None:
        """Show a page in front of all windows, scrolled to these words."""
        self.show()  # before the page, whose images are as wide as the text
        row = list(PAGES).index(name)
        if self.list.currentRow() == row:
            self._show(name)  # completed for the current design
        self.list.setCurrentRow(row)
        self.raise_()
        self.activateWindow()
        if words:
            self.text.moveCursor(QTextCursor.MoveOperation.End)  # so that the match comes to the top
            match = self.text.document().find(words)
            self.text.setTextCursor(match if not match.isNull() else QTextCursor(self.text.document()))

    def _show(self, name: str) -> None:
        self.text.setMarkdown(PAGES[name][1](help_text(name), self._host))
        space(self.text.document())

    def _follow(self, link: QUrl) -> None:
        name = link.toString().removesuffix(".md")
        if name in PAGES:
            self.list.setCurrentRow(list(PAGES).index(name))
