"""The Parameters view: the name of a design, and a page with a form for each of its sections."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property, partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol
from weakref import WeakSet

from PySide6.QtCore import QSize, Qt, Signal, SignalInstance
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QHBoxLayout, QLabel, QLineEdit, QScrollBar, QVBoxLayout, QWidget

from core.design import Design
from core.findings import ERROR
from core.study import Study
from core.study.limits import limits_in_force
from core.units import split_unit
from kindyna_gui.documents.session import SHAFT, Session
from kindyna_gui.documents.texts import back_text, misfit_sentences
from kindyna_gui.forms.fields import Field, NameField, in_tab_order
from kindyna_gui.forms.form import EDIT_CARD, Form, IncompleteBar, ValvePage, part_of
from kindyna_gui.forms.loads_page import LoadsPage, first_field, row_of
from kindyna_gui.forms.tab_bars import FittingTabs
from kindyna_gui.labels import SECTION_NAMES
from kindyna_gui.look import coloured, described, sign
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import call_soon, fill
from kindyna_gui.requirements import lists_links
from kindyna_gui.settings import in_units, size_of
from kindyna_gui.view import View, ViewHost

if TYPE_CHECKING:
    from kindyna_gui.forms.nearest_fit import NearestFit

LOADS, LIMITS, MOTION = "loads", "limits", "motion"
CARD_SECTIONS = ("engine", "valve")
"""Sections of which the cam card of a valve train has values."""
LEAST = 285, 116  # pixels; the pages scroll, so a full window need not grow for them
LEAST_OVER_BAR = 84  # height of the pages over the bar about values that do not fit: the tabs, and a field [pixels]
LEAST_HEIGHT = 185  # of the view, at which fields of a page can be read [pixels]
AROUND_LIST = 158  # height of the view without the list of loads [pixels]
SECTIONS = ("follower", "cam", "shaft", "engine", "valve", "loads", "limits", "servo")
EVERY_SECTION = ("follower", "linkage", "cam", "shaft", "engine", "valve", "loads", "limits", "servo")
"""Sections of all kinds of design, in the order of the tabs."""


class Page(Protocol):
    """A page that scrolls, with the fields of a section by their paths."""

    fields_changed: SignalInstance

    @property
    def fields(self) -> dict[str, Field]:
        """Fields by their paths."""

    @property
    def in_trouble(self) -> bool:
        """Whether a value was refused or does not fit the others."""

    def refresh(self, design: Design) -> None:
        """Show a design."""

    def look_for(self, words: str) -> int:
        """Show only the fields whose name has all of these words, and return their number."""

    def unfold(self, path: str) -> None:
        """Show the field of a path, where it is folded or filtered out."""

    def field_at(self, path: str) -> Field | None:
        """Return the field of a path."""

    def verticalScrollBar(self) -> QScrollBar:
        """Return the vertical scroll bar."""

    def ensureWidgetVisible(self, child: QWidget, xmargin: int = ..., ymargin: int = ...) -> None:
        """Scroll to a field."""


def kind_label(design: Design) -> str:
    """Return the kind of mechanism of a design in a few words."""
    return design.drive.label + " and a cam" * (lists_links(design) and design.drive.has_disk)


class ParametersView(View):
    """Name and parameters of the design: follower, cam, shaft, loads, limits.

    Signals: ``load_added`` with the list to which the user adds a load; ``load_picked`` with the path of a load and the key
    of the attachment to be selected in the drawing; ``height_requested`` (pixels, False) with the least height of the list
    of loads and of the fields. ``first`` are pages before the forms.
    """

    load_added = Signal(str)
    load_picked = Signal(str, str)
    height_requested = Signal(int, bool)
    is_design_wide = True

    def __init__(self, session: Session, player: Player, first: Mapping[str, Any] = MappingProxyType({})) -> None:
        super().__init__(session, player)
        self.name = NameField(session)
        self.incomplete_bar = IncompleteBar()
        self.incomplete_bar.drop_requested.connect(session.drop_incomplete)
        session.incomplete_changed.connect(self.invalidate)
        self.kind = coloured(QLabel(), SCREEN.quiet)
        self.legend = described(
            coloured(QLabel(f"<span style='color:{SCREEN.assumed}'>∗</span> assumed"), SCREEN.quiet),
            tip="Not taken from a source",
        )
        self.tabs = FittingTabs()
        self.tabs.setMinimumSize(*LEAST)
        side = self.tabs.fontMetrics().height() - 2
        self.tabs.setIconSize(QSize(side, side))  # no higher than the text: the mark of a wrong value moves no field
        self.tabs.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # Ctrl+Tab changes the page, Tab goes from field to field
        self.loads = LoadsPage(session)
        self.forms: dict[str, Page] = {
            **first,
            **{section: self.loads.form if section == LOADS else Form(session, section) for section in EVERY_SECTION},
        }
        self.pages: dict[str, Any] = {
            **self.forms,
            LOADS: self.loads,
            **{section: ValvePage(self.forms[section]) for section in CARD_SECTIONS},
        }
        for section, page in self.pages.items():
            self.tabs.addTab(page, SECTION_NAMES[section])
        for section, page in self.forms.items():
            page.fields_changed.connect(partial(self._fields_changed, section))
        self.tabs.setCurrentIndex(len(first))
        self.tabs.currentChanged.connect(lambda _: self._show_limits_in_force())
        self.loads.added.connect(self.load_added)
        self.loads.picked.connect(self.load_picked)
        self._watched: WeakSet[Field] = WeakSet()  # fields whose trouble is shown
        self._subject = ""  # the drive that is shown
        self._scrolls: dict[str, tuple[str, int]] = {}
        session.started.connect(self._scrolls.clear)
        header = fill(QHBoxLayout(), (self.name, 1), margins=(8, 5, 8, 3))
        self.filter = described(
            QLineEdit(clearButtonEnabled=True, placeholderText="Filter"),
            name="Filter of fields",
            tip="Show only fields with these words in their name",
        )
        self.filter.setMaximumWidth(110)
        self.filter.textChanged.connect(self._look_for)
        footer = fill(
            QHBoxLayout(),
            self.filter,  # in the header it would take the room of a long name
            (self.legend, 1),
            self.kind,
            margins=(10, 2, 10, 4),
        )
        layout = fill(QVBoxLayout(), header, (self.tabs, 1), self.incomplete_bar, footer, margins=0, spacing=3)
        self.set_content_layout(layout)

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.load_added.connect(window.add_load)
        self.load_picked.connect(window.pick_load)
        for page in (*(self.pages[section] for section in CARD_SECTIONS), self.pages.get(MOTION)):
            if page is not None:
                page.card_requested.connect(partial(window.do, EDIT_CARD))

    def refresh(self, study: Study) -> None:
        typed = self.session.typed
        scroll = self._change_subject()
        waits = self.session.incomplete is not None and not self.session.waits_for.reasons
        self.incomplete_bar.show_reasons(misfit_sentences(self.session) if waits else [], back_text(self.session))
        self.tabs.setMinimumHeight(LEAST_OVER_BAR if waits else LEAST[1])
        if waits or "_nearest_fit" in vars(self):
            self._nearest_fit.restart()
        self.name.refresh(typed)
        self.kind.setText(kind_label(typed))
        parts = {s: self.session.typed_full_design if s == SHAFT else typed for s in self.forms}
        present = [section for section, design in parts.items() if part_of(design, section) is not None]
        for section in sorted(
            parts, key=lambda section: section not in present
        ):  # the next one follows on one that goes
            self.tabs.set_present(self.tabs.indexOf(self.pages[section]), section in present)
        for section in present:
            design, form = parts[section], self.forms[section]
            if section == LOADS:
                self.loads.refresh(study, typed)
            else:
                form.refresh(design)
        self._show_limits_in_force()
        self.height_requested.emit(max(LEAST_HEIGHT, AROUND_LIST + self.loads.list_height), False)
        if scroll is not None:
            self.show_section(scroll[0])
            bar = self.forms[scroll[0]].verticalScrollBar()
            call_soon(bar, partial(bar.setValue, scroll[1]))  # once the fields have their position

    def _show_limits_in_force(self) -> None:
        """Show in the empty fields of the page of limits, while it is in front, the typical limits that apply."""
        page: Any = self.forms[LIMITS]
        is_in_front = self.tabs.currentWidget() is page
        if not is_in_front:
            return
        limits = limits_in_force(self.session.study)
        page.show_defaults(
            {
                f"{LIMITS}.{key}": (short(limit.value / size_of(split_unit(key)[1].symbol)), in_units(limit.reason))
                for key, limit in limits.items()
            }
        )

    def _change_subject(self) -> tuple[str, int] | None:
        """Return the section and scroll at which the drive was left, where another drive was shown before."""
        subject = self.session.names[self.session.chosen] if self.session.has_several_drives else ""
        if subject == self._subject:
            return None
        current = next(name for name, page in self.pages.items() if page is self.tabs.currentWidget())
        self._scrolls[self._subject] = current, self.forms[current].verticalScrollBar().value()
        self._subject = subject
        return self._scrolls.get(subject)

    def _look_for(self, words: str) -> None:
        """Show only the fields with these words, and bring the first page that has one to the front."""
        matches = {section: form.look_for(words) for section, form in self.forms.items()}
        current = next((name for name, page in self.pages.items() if page is self.tabs.currentWidget()), "")
        if words and not matches.get(current):
            for section, count in matches.items():
                if count and self.tabs.is_present(self.tabs.indexOf(self.pages[section])):
                    self.tabs.setCurrentWidget(self.pages[section])
                    break

    def _fields_changed(self, section: str) -> None:
        """Set the Tab order and the mark of a page whose fields have changed."""
        in_tab_order(self.name, self.filter, *(editor for page in self.pages.values() for editor in page.editors))
        for field in set(self.forms[section].fields.values()) - set(self._watched):
            field.trouble_changed.connect(partial(self._show_trouble, section, field))
            self._watched.add(field)
        self._mark_tab(section)

    def settle(self) -> None:
        super().settle()
        self.loads.settle()

    @property
    def busy(self) -> bool:
        return super().busy or ("_nearest_fit" in vars(self) and self._nearest_fit.busy)

    @cached_property
    def _nearest_fit(self) -> NearestFit:
        """The search for a value that fits, created with the first misfit."""
        from kindyna_gui.forms.nearest_fit import NearestFit  # imported here to save start-up time

        return NearestFit(self.session, self.incomplete_bar)

    def leave(self) -> None:
        super().leave()
        if "_nearest_fit" in vars(self):
            self._nearest_fit.close()

    def _show_trouble(self, section: str, field: Field) -> None:
        self._mark_tab(section)
        form = self.forms[section]
        if field.trouble and field.editor.hasFocus():
            form.ensureWidgetVisible(field.editor, 0, 8)

    def _mark_tab(self, section: str) -> None:
        """Mark the tab of a page with a wrong value, since the page may be hidden."""
        tab, wrong = self.tabs.indexOf(self.pages[section]), self.forms[section].in_trouble
        if wrong == self.tabs.tabIcon(tab).isNull():
            self.tabs.setTabIcon(tab, sign(ERROR) if wrong else QIcon())

    def field(self, path: str) -> Field | None:
        """Return the field of a path; None where no form has it."""
        form = self.forms.get(path.partition(".")[0])
        return None if form is None else form.fields.get(path)

    def show_section(self, section: str) -> None:
        """Bring the page of a section to the front, where the design has one."""
        if section in self.pages and self.tabs.is_present(self.tabs.indexOf(self.pages[section])):
            self.tabs.setCurrentWidget(self.pages[section])

    def focus_field(self, path: str) -> bool:
        """Show the field of a path, or the first of a section, and move the focus to it; False where there is none."""
        self.pull()
        section = path.partition(".")[0]
        if part_of(self.session.holder(section), section) is None:
            section = next(name for name in self.forms if part_of(self.session.holder(name), name) is not None)
        form = self.forms.get(section)
        if form is None:
            return False
        if section == LOADS and row_of(path) == path:
            path = first_field(self.session.typed, path)
        self.tabs.setCurrentWidget(self.pages[section])
        field = form.field_at(path)
        if field is None:
            return False
        form.unfold(field.spec.path)
        if section == LOADS:
            self.loads.choose(row_of(path))
        form.ensureWidgetVisible(field.editor, 0, 40)
        call_soon(field.editor, partial(form.ensureWidgetVisible, field.editor, 0, 40))  # once it has its position
        field.focus()
        return True


__all__ = ["Form", "ParametersView"]
