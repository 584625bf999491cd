"""The parameters of a design as forms, made from the metadata of its fields."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QFrame, QGridLayout, QHBoxLayout, QLabel, QScrollArea, QTabWidget, QVBoxLayout, QWidget

from core.design import FOLLOWER_KINDS, Design, Entry, entries, is_assumed, kind_of
from core.findings import ERROR
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.field_parts import in_tab_order
from kindyna_gui.forms.fields import COLUMNS, Field, NameField, Spec
from kindyna_gui.labels import SECTION_NAMES, entry_label, heading_of
from kindyna_gui.look import ASSUMED, QUIET, coloured, sign
from kindyna_gui.rebuilt import Rebuilt
from kindyna_gui.requirements import lists_links
from kindyna_gui.view import View
from kindyna_gui.window.player import Player

SECTIONS = ("follower", "cam", "shaft", "loads", "limits")
EVERY_SECTION = ("follower", "linkage", "cam", "shaft", "loads", "limits")  # of all kinds of design, in the order of tabs


_STRUCTURE = frozenset({"number", "link", "on", "kind"})
"""What a linkage consists of, rather than its dimensions: it is laid out in its file, begun from a preset, or chosen in the
menu Compo."""


def rows_of(design: Design, section: str) -> list[Entry]:
    """The rows of a section, in the order of the file."""
    return [row for row in entries(design, section) if row.path.rpartition(".")[2] not in _STRUCTURE]


def _spec_of(design: Design, row: Entry) -> Spec:
    """A row of a linkage: named after what it belongs to; a side is chosen of two."""
    info = replace(row.info, label=entry_label(design, row))
    if row.path.startswith("linkage.branch."):
        info = replace(info, choices=(1, -1))
    return Spec.of(replace(row, info=info))


def _part(design: Design, section: str) -> Any:
    """The table of the design that a form shows; None where its kind has none of that name."""
    return design.tables.get(section)


class Heading(QLabel):
    """What the fields below belong to."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        bold = self.font()
        bold.setBold(True)
        self.setFont(bold)
        self.setContentsMargins(0, 5, 0, 1)


class Form(QScrollArea):
    """The fields of one section, one below the other."""

    def __init__(self, session: Session, section: str) -> None:
        super().__init__()
        self._session, self._section = session, section
        self.fields: dict[str, Field] = {}
        self._place = Rebuilt(session)
        self.setWidget(self._place)
        self._shown: tuple[Any, Any] | None = None
        self._values: dict[str, tuple[Any, bool]] = {}
        self._heads: list[str] = []
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)

    def refresh(self, design: Design) -> None:
        """Show this design; fields are made anew only where another kind of design has others, and left alone
        where they show what they did."""
        shown = (_part(design, self._section), design.assumed)
        if self._shown is not None and shown[0] is self._shown[0] and shown[1] == self._shown[1]:
            return
        self._shown = shown
        rows = rows_of(design, self._section)
        heads = [heading_of(design, row.path) for row in rows]
        if [row.path for row in rows] != list(self.fields) or heads != self._heads:
            self._heads, self._values = heads, {}
            self._build([_spec_of(design, row) for row in rows])
        for row in rows:
            shown = row.value, is_assumed(design, row.path)
            if self._values.get(row.path) != shown:
                self._values[row.path] = shown
                self.fields[row.path].refresh(design)

    def _build(self, specs: list[Spec]) -> None:
        paper = QWidget()
        grid = QGridLayout(paper)
        grid.setContentsMargins(10, 7, 6, 6)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(3)
        grid.setColumnStretch(1, 1)
        self.fields = {}
        row = 0
        for i, spec in enumerate(specs):
            if self._heads[i] and self._heads[i] != (self._heads[i - 1] if i else ""):
                grid.addWidget(Heading(self._heads[i]), row, 0, 1, COLUMNS)
                row += 1
            field = Field(self._session, spec)
            field.setParent(paper)  # goes with it
            field.add_to(grid, row)
            row += 2
            self.fields[spec.path] = field
        grid.setRowStretch(row, 1)
        self._place.replace(paper)
        # else the fields are squeezed under the scroll bar
        self.setMinimumWidth(paper.minimumSizeHint().width() + self.verticalScrollBar().sizeHint().width())

    @property
    def in_trouble(self) -> bool:
        return any(field.trouble for field in self.fields.values())


def kind_label(study: Study) -> str:
    """What kind of mechanism a design is, in a few words."""
    if lists_links(study.design):
        links = len(study.design.drive.mechanism.links)
        return f"Linkage of {links} links{' and a cam' if study.design.drive.cam is not None else ''}"
    return FOLLOWER_KINDS[kind_of(study.design.drive.mechanism)].label


class ParametersView(View):
    """Name and parameters of the design: follower, cam, shaft, loads, limits."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.name = NameField(session)
        self.kind = QLabel()
        coloured(self.kind, QUIET)
        self.legend = QLabel(f"<span style='color:{ASSUMED}'>∗</span> assumed, not taken from a source")
        coloured(self.legend, QUIET)
        self.tabs = QTabWidget(documentMode=True)
        self.tabs.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # Ctrl+Tab changes the page, Tab goes from field to field
        self.forms = {section: Form(session, section) for section in EVERY_SECTION}
        for section, form in self.forms.items():
            self.tabs.addTab(form, SECTION_NAMES[section])
        head = QHBoxLayout()
        head.setContentsMargins(8, 5, 8, 3)
        head.addWidget(self.name)
        foot = QHBoxLayout()
        foot.setContentsMargins(10, 2, 10, 4)
        foot.addWidget(self.legend, 1)
        foot.addWidget(self.kind)
        layout = QVBoxLayout()
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(3)
        layout.addLayout(head)
        layout.addWidget(self.tabs, 1)
        layout.addLayout(foot)
        self.set_content_layout(layout)

    def refresh(self, study: Study) -> None:
        design = study.design
        self.name.refresh(design)
        self.kind.setText(kind_label(study))
        for section, form in self.forms.items():
            present, tab = _part(design, section) is not None, self.tabs.indexOf(form)
            if present != self.tabs.isTabVisible(tab):  # else Qt would lay out the whole window anew all the same
                self.tabs.setTabVisible(tab, present)
            if not present:
                continue
            before = form.fields
            form.refresh(design)
            if form.fields is not before:
                self._order_fields()
                for field in form.fields.values():
                    field.trouble_changed.connect(partial(self._show_trouble, form, field))

    def _order_fields(self) -> None:
        fields = [field.editor for form in self.forms.values() for field in form.fields.values()]
        in_tab_order(self.name, *fields)

    def _show_trouble(self, form: Form, field: Field) -> None:
        """A tab shows that something in it is wrong, for it may stand behind another."""
        self.tabs.setTabIcon(self.tabs.indexOf(form), sign(ERROR) if form.in_trouble else QIcon())
        if field.trouble and field.editor.hasFocus():
            # once it has its place: below the last field it would be out of sight
            QTimer.singleShot(0, field.message, partial(form.ensureWidgetVisible, field.message, 0, 8))

    def field(self, path: str) -> Field | None:
        """The row of a path, None where the forms have none."""
        return next((form.fields[path] for form in self.forms.values() if path in form.fields), None)

    def focus_field(self, path: str) -> bool:
        """Bring the field of a path, or the first of a section, before the reader; False where there is none."""
        self.pull()
        section = path.partition(".")[0]
        design = self.session.design
        if _part(design, section) is None:
            section = next(name for name in EVERY_SECTION if _part(design, name) is not None)
        form = self.forms.get(section)
        if form is None or not form.fields:
            return False
        field = form.fields.get(path) or next(iter(form.fields.values()))
        self.tabs.setCurrentWidget(form)
        form.ensureWidgetVisible(field.editor, 0, 40)
        field.focus()
        return True


__all__ = ["COLUMNS", "Form", "ParametersView"]
