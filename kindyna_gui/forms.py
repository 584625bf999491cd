"""The parameters of a design as forms, made from the metadata of its fields."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QFrame, QGridLayout, QHBoxLayout, QLabel, QScrollArea, QTabWidget, QVBoxLayout, QWidget

from core.design import FOLLOWER_KINDS, Design, entries, kind_of
from core.findings import ERROR
from core.project import to_table
from core.study import Study
from kindyna_gui.fields import COLUMNS, Field, NameField, Spec
from kindyna_gui.look import ASSUMED, QUIET, coloured, sign
from kindyna_gui.player import Player
from kindyna_gui.session import Session
from kindyna_gui.view import View
from kindyna_gui.wording import SECTION_NAMES

SECTIONS = ("follower", "cam", "shaft", "loads")


class Form(QScrollArea):
    """The fields of one section, one below the other."""

    def __init__(self, session: Session, section: str) -> None:
        super().__init__()
        self._session, self._section = session, section
        self.fields: dict[str, Field] = {}
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)

    def refresh(self, design: Design) -> None:
        """Show this design; fields are made anew only where another kind of design asks for others."""
        specs = {entry.path: Spec.of(entry) for entry in entries(design, self._section)}
        if set(specs) != set(self.fields):
            order = [f"{self._section}.{key}" for key in to_table(design)[self._section]]  # as the file has it
            self._build([specs[path] for path in order if path in specs])
        for field in self.fields.values():
            field.refresh(design)

    def _build(self, specs: list[Spec]) -> None:
        paper = QWidget()
        grid = QGridLayout(paper)
        grid.setContentsMargins(10, 7, 6, 6)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(3)
        grid.setColumnStretch(1, 1)
        self.fields = {}
        for row, spec in enumerate(specs):
            field = Field(self._session, spec)
            field.setParent(paper)  # goes with it
            field.add_to(grid, 2 * row)
            self.fields[spec.path] = field
        grid.setRowStretch(2 * len(specs), 1)
        self.setWidget(paper)
        # else the fields are squeezed under the scroll bar
        self.setMinimumWidth(paper.minimumSizeHint().width() + self.verticalScrollBar().sizeHint().width())

    @property
    def in_trouble(self) -> bool:
        return any(field.trouble for field in self.fields.values())


class ParametersView(View):
    """Name and parameters of the design: follower, cam, shaft, loads."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.name = NameField(session)
        self.kind = QLabel()
        coloured(self.kind, QUIET)
        self.legend = QLabel(f"<span style='color:{ASSUMED}'>∗</span> assumed, not taken from a source")
        coloured(self.legend, QUIET)
        self.tabs = QTabWidget(documentMode=True)
        self.forms = {section: Form(session, section) for section in SECTIONS}
        for section, form in self.forms.items():
            self.tabs.addTab(form, SECTION_NAMES[section])
        head = QHBoxLayout()
        head.setContentsMargins(8, 5, 8, 3)
        head.addWidget(self.name, 1)
        head.addWidget(self.kind)
        foot = QHBoxLayout()
        foot.setContentsMargins(10, 2, 10, 4)
        foot.addWidget(self.legend)
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
        self.kind.setText(FOLLOWER_KINDS[kind_of(design.drive.follower)].label)
        for form in self.forms.values():
            before = form.widget()
            form.refresh(design)
            if form.widget() is not before:
                for field in form.fields.values():
                    field.trouble_changed.connect(partial(self._show_trouble, form, field))

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
        form = self.forms.get(section)
        if form is None or not form.fields:
            return False
        field = form.fields.get(path) or next(iter(form.fields.values()))
        self.tabs.setCurrentWidget(form)
        form.ensureWidgetVisible(field.editor, 0, 40)
        field.focus()
        return True


__all__ = ["COLUMNS", "Form", "ParametersView"]
