"""View of the list of drives on the shaft, with the form of the selected drive."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QMenu,
    QTableWidget,
    QTableWidgetItem,
    QToolButton,
    QWidget,
)

from core.design import row_at
from core.design.follower_kinds import KIND_LABELS
from core.errors import KindynaError, NoSolution
from core.project import load
from core.study import Study
from kindyna_gui import dialogs, drives
from kindyna_gui.documents.session import BALANCER, Session
from kindyna_gui.drives import DriveRow, drive_rows
from kindyna_gui.files.beginnings import beginning
from kindyna_gui.forms.form import Form
from kindyna_gui.forms.load_rows import list_button, row_of_buttons, taken_by_list
from kindyna_gui.forms.tables import LEADING, copied
from kindyna_gui.labels import reason
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import digits, readable, short
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import ContentArea, add_entry, clear_menu, connect_all, single_shot
from kindyna_gui.requirements import ONE_DRIVE, require_list
from kindyna_gui.settings import Settings
from kindyna_gui.view import View, ViewHost

# -- drives from a file ----------------------------------------------------------------------------------


def add_from_file(session: Session, parent: QWidget) -> bool:
    """Ask for a design file and add its drives to the shaft; False where none is added."""
    path = dialogs.design_to_open(parent, Settings().folder)
    if path is None:
        return False
    try:
        return drives.add(session, load(path))
    except KindynaError as error:
        dialogs.show_faults(parent, f"{path.name} cannot be read.", str(error).splitlines())
        return False


# -- drives view -----------------------------------------------------------------------------------------

HEADINGS = ("Drive", "Phase", "Side", "Peak torque")
TORQUE_MS = 150  # pause in editing before the torques, the slowest column, are calculated
HIGHEST, LOWEST = 210, 60  # height of the form, pixels; it scrolls where it needs more
NAME, PHASE, SIDE, TORQUE = range(4)


class DrivesTable(QTableWidget):
    """Table of the drives: a click or an arrow key selects a row, F2 or a double click renames.

    - moved (-1 or 1): Alt+Up, Alt+Down
    - removed: Delete
    """

    moved = Signal(int)
    removed = Signal()

    def __init__(self) -> None:
        super().__init__(0, len(HEADINGS))
        self.setHorizontalHeaderLabels(list(HEADINGS))
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setEditTriggers(QAbstractItemView.EditTrigger.DoubleClicked | QAbstractItemView.EditTrigger.EditKeyPressed)
        self.setShowGrid(False)
        self.setAlternatingRowColors(True)
        self.setTabKeyNavigation(False)
        self.verticalHeader().hide()
        self.update_style()
        header = self.horizontalHeader()
        header.setHighlightSections(False)
        header.setMinimumSectionSize(30)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(NAME, QHeaderView.ResizeMode.Stretch)
        self.setAccessibleName("Drives on the shaft")

    def update_style(self) -> None:
        """Adapt the row height to the font."""
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + LEADING)

    def sizeHint(self) -> QSize:
        return QSize(280, 150)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not copied(self, event) and not taken_by_list(self, event):
            super().keyPressEvent(event)


class DrivesView(View):
    """List of the drives with buttons, and the form of the selected drive.

    - picture_requested: the user selects a new drive by its picture
    """

    picture_requested = Signal()

    is_design_wide = True
    stages = ("linkage", "dynamics")

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = DrivesTable()
        self.buttons = {
            "add": list_button("Add", "insert", "Add a drive", None),
            "copy": list_button("Copy", "duplicate", "Duplicate the selected drive", partial(drives.copy, session)),
            "remove": list_button(
                "Remove", "delete", "Remove the selected drive (Del)", partial(drives.remove, session)
            ),
            "up": list_button("Up", "up", "Move up (Alt+Up)", partial(drives.move, session, -1)),
            "down": list_button("Down", "down", "Move down (Alt+Down)", partial(drives.move, session, 1)),
        }
        menu = QMenu(self)
        menu.aboutToShow.connect(partial(self._fill, menu))
        self.buttons["add"].setMenu(menu)
        self.buttons["add"].setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        bar = row_of_buttons(self.buttons.values(), above=2)
        self._form_holder = ContentArea(session)
        self._form: Form | None = None
        self._section = ""
        self._torque_timer = single_shot(self, self._show_torques, TORQUE_MS)
        self.set_column(self.table, bar, self._form_holder, grows=self.table)
        connect_all(
            (self.table.currentCellChanged, self._choose),
            (self.table.itemChanged, self._rename),
            (self.table.moved, lambda by: drives.move(self.session, by)),
            (self.table.removed, self._remove),
        )

    # -- from the session ---------------------------------------------------------------------------------

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.picture_requested.connect(window.add_drive_by_picture)

    def refresh(self, study: Study) -> None:
        self._torque_timer.stop()  # it belongs to the previous design
        require_list(self.session.full_design, ONE_DRIVE)
        rows = drive_rows(self.session)
        with QSignalBlocker(self.table):
            if self.table.rowCount() != len(rows):
                self.table.setRowCount(len(rows))
            for number, row in enumerate(rows):
                self._show_row(number, row)
            self.table.setCurrentCell(self.session.chosen, max(self.table.currentColumn(), 0))
        movable = not self.session.is_on_balancer
        last = len(self.session.full_design.drives) - 1
        self.buttons["copy"].setEnabled(movable)
        self.buttons["remove"].setEnabled(last > 0 or not movable)
        self.buttons["up"].setEnabled(movable and self.session.chosen > 0)
        self.buttons["down"].setEnabled(movable and self.session.chosen < last)
        self._show_form()
        if self.table.item(0, TORQUE) is None:
            self._show_torques()
        else:
            self._torque_timer.start()

    def _show_row(self, number: int, row: DriveRow) -> None:
        design = self.session.full_design
        if number < len(design.drives):
            drive = design.drives[number]
            phase, side = f"{short(drive.phase)}°", "mirrored" if drive.mirrored else ""
        else:
            phase, side = f"{short(design.balancer.phase_deg)}°", ""
        for column, text in enumerate((row.name, phase, side)):
            self._write(number, column, text, row.problem)
        name_item = self._cell(number, NAME)
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        name_item.setFlags(flags | Qt.ItemFlag.ItemIsEditable if number < len(design.drives) else flags)
        if name_item.data(Qt.ItemDataRole.UserRole) != row.colour + row.problem:
            name_item.setData(Qt.ItemDataRole.UserRole, row.colour + row.problem)
            name_item.setIcon(row.icon)

    def _cell(self, row: int, column: int) -> QTableWidgetItem:
        """Return the item of a cell, created where it is missing."""
        item: QTableWidgetItem | None = self.table.item(row, column)
        if item is None:
            item = QTableWidgetItem()
            self.table.setItem(row, column, item)
            item.setFlags(Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable)
            if column in (PHASE, TORQUE):
                item.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        return item

    def _write(self, row: int, column: int, text: str, problem: str) -> None:
        """Write a text into a cell, red where there is a problem."""
        item = self._cell(row, column)
        if (item.text(), item.toolTip()) == (text, problem):
            return
        item.setText(text)
        item.setToolTip(problem)
        item.setForeground(QColor(SCREEN.limit) if problem else self.table.palette().text())

    def _show_torques(self) -> None:
        """Fill the column of torques, if the view shows the current design."""
        self._torque_timer.stop()
        if not self.up_to_date:
            return
        with QSignalBlocker(self.table):
            for row in range(self.table.rowCount()):
                self._write(row, TORQUE, *self._torque(row))

    def settle(self) -> None:
        super().settle()
        if self._torque_timer.isActive():
            self._show_torques()

    def _torque(self, number: int) -> tuple[str, str]:
        """Peak torque of a drive as text, and the reason where there is none."""
        shaft = self.session.shaft
        try:
            if number < len(self.session.full_design.drives):
                name = self.session.names[number]
                if name not in shaft.loading_drives:
                    return "not driven by the shaft", ""
                peak = shaft.drive_peak(name).value
            else:
                peak = shaft.balancer_peak.value
        except NoSolution as error:
            return "not calculated", reason(self.session.full_design, error)
        display_unit = readable("N·m", abs(peak))
        return f"{digits(peak / display_unit.size, 4)} {display_unit.symbol}", ""

    def _show_form(self) -> None:
        section = BALANCER if self.session.is_on_balancer else f"drives[{self.session.chosen}]"
        if section != self._section:
            self._section, self._form = section, Form(self.session, section)
            self._form_holder.replace(self._form)
        assert self._form is not None
        self._form.refresh(self.session.full_design)
        height = min(self._form.wanted_height, HIGHEST)
        self._form.setMaximumHeight(height)
        self._form.setMinimumHeight(min(height, LOWEST))

    # -- by the user --------------------------------------------------------------------------------------

    def _choose(self, row: int, *_: object) -> None:
        if row >= 0 and not self.session.choose_drive(row):
            with QSignalBlocker(self.table):
                self.table.setCurrentCell(self.session.chosen, 0)

    def _rename(self, item: QTableWidgetItem) -> None:
        number, name = item.row(), item.text().strip()
        if (
            item.column() == NAME
            and name != self.session.names[number]
            and not drives.rename(self.session, number, name)
        ):
            with QSignalBlocker(self.table):
                item.setText(self.session.names[number])

    def _remove(self) -> None:
        if self.buttons["remove"].isEnabled():
            drives.remove(self.session)

    def _fill(self, menu: QMenu) -> None:
        clear_menu(menu)
        for kind, label in KIND_LABELS.items():
            add_entry(menu, label, partial(self._add, kind), f"Add a drive: {label}")
        add_entry(
            menu,
            "From images...",
            self.picture_requested.emit,
            "Select a follower with its face and the form of its cam, or a linkage",
        )
        from_file = partial(add_from_file, self.session, self)
        add_entry(menu, "From a file...", from_file, "Add all drives of a design file")
        menu.addSeparator()
        add_entry(
            menu,
            "Balance cam",
            partial(drives.add_balancer, self.session),
            "A spring-loaded cam that evens out the torque of the other drives",
            enabled=self.session.full_design.balancer is None,
        )

    def _add(self, slug: str) -> None:
        drives.add(self.session, beginning(slug, name=KIND_LABELS[slug]))

    def focus_field(self, path: str) -> bool:
        """Focus the field of a path, such as ``drives[1].phase_deg``; False where the form has no such field."""
        name, number, inside = row_at(path, "drives")
        if name and not (inside and self.session.choose_drive(number)):
            return False
        self.pull()
        field = None if self._form is None else self._form.fields.get(path)
        if field is not None:
            field.focus()
        return field is not None
