"""Loads."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import partial

from PySide6.QtCore import QSignalBlocker, QSize, QTimer, Signal
from PySide6.QtGui import QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QMenu, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from core.design import Design, Entry, Process, entries, get, load_lists, row_at, with_rows_in_order
from core.dynamics import element_at, peak_load
from core.errors import NoSolution
from core.frozen import frozen
from core.output.lines import shortest
from core.output.load_text import row_attachments, row_name
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.form import Form
from kindyna_gui.forms.load_rows import AttachmentRows, WhenRow, list_button, row_of_buttons, taken_by_list
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import value_text
from kindyna_gui.pictures.units import digits, readable
from kindyna_gui.rebuilt import clear_menu

# -- load texts ------------------------------------------------------------------------------------------

WHAT = {
    "masses": ("&Mass", "A mass and an inertia on a link"),
    "forces": ("&Force", "A constant force and a torque on a link"),
    "springs": ("&Spring and damper", "Between two points of links, or of a link and the frame"),
    "torsion_springs": ("&Torsion spring and damper", "Between two links"),
    "pair_friction": ("F&riction", "In a pin or along a slide"),
    "process": ("&Process force", "Over a part of the turn, at a part of the motion, or as a table"),
}
"""List of the loads -> its entry in the menu, and what it is."""
GENERAL = "In general"
_ROW = re.compile(r"(loads\.\w+\[\d+\])")
MOST_VALUES = 3  # values that a line names


@frozen
class LoadRow:
    """A row of the list: its path, empty for what belongs to no list; name, place and value; all of them as a tip."""

    path: str
    cells: tuple[str, str, str]
    tip: str = ""


def what_of(name: str) -> str:
    """What a row of a list is called in a sentence: ``spring and damper``."""
    return WHAT[name][0].replace("&", "").lower()


def lines_of(design: Design) -> tuple[LoadRow, ...]:
    """Of what belongs to no list, then of each row."""
    texts: dict[str, list[str]] = {}
    for entry in entries(design, "loads"):
        if _is_size(entry):
            row = row_of(entry.path)
            text = value_text(entry.value, entry.unit)
            texts.setdefault(row, []).append(text if row else f"{entry.info.in_sentence} {text}")
    own = texts.get("", [])
    return (
        LoadRow("", (GENERAL, ", ".join(own[:MOST_VALUES]), ""), ", ".join(own) or "Nothing is given"),
        *_rows(design, texts),
    )


def row_of(path: str) -> str:
    """The row of the loads that a path leads into; empty for what belongs to no list."""
    match = _ROW.match(path)
    return match[1] if match else ""


def _rows(design: Design, texts: Mapping[str, list[str]]) -> Iterator[LoadRow]:
    for name in load_lists(design.drive):
        for i, row in enumerate(getattr(design.drive.loads, name)):
            path = f"loads.{name}[{i}]"
            where = row_attachments(design, path)
            value = _process_text(row) if isinstance(row, Process) else ", ".join(texts.get(path, [])[:MOST_VALUES])
            cells = (row_name(design, path), where, value)
            yield LoadRow(path, cells, ": ".join(cell for cell in cells if cell))


def _is_size(entry: Entry) -> bool:
    """Whether an entry says how large a load is, not where it is."""
    key = entry.path.rpartition(".")[2]
    place = key in ("x_mm", "y_mm", "centre_x_mm", "centre_y_mm") or key.startswith("gravity") or "_centre" in key
    return isinstance(entry.value, float) and entry.value != 0.0 and not place


def _process_text(row: Process) -> str:
    """``-100 N from 0° to 90°``."""
    size = ", ".join(
        f"{shortest(value)} {unit}" for value, unit in ((row.force_n, "N"), (row.torque_nm, "N·m")) if value
    )
    if row.points:
        return f"table of {len(row.points)} rows"
    for unit, low, high in (
        ("°", row.cam_from_deg, row.cam_to_deg),
        (" mm", row.position_from_mm, row.position_to_mm),
        ("° of motion", row.position_from_deg, row.position_to_deg),
    ):
        if low is not None and high is not None:
            return f"{size or '0 N'} from {shortest(low)} to {shortest(high)}{unit}"
    return size


def first_field(design: Design, path: str) -> str:
    """The path of the first value of a row that says how large it is, else of its first."""
    own = [entry for entry in entries(design, "loads") if entry.path.startswith(f"{path}.")]
    sizes = [entry.path for entry in own if entry.value is not None and _is_size(entry)]
    if isinstance(get(design, path), Process):
        sizes = [each for each in sizes if each.endswith(("force_n", "torque_nm"))]
    return next(iter(sizes), next((entry.path for entry in own), path))


# -- loads page ------------------------------------------------------------------------------------------

HEADINGS = (
    TableHeading("Load"),
    TableHeading("Where", wide=True),
    TableHeading("Value"),
    TableHeading("Largest", number=True),
)
PART = 0.38  # of the height, which the list has at the most
LOWEST = 40  # of the form, pixels
LARGEST_MS = 150  # after an edit, before the largest forces are found anew
LEAST, MOST_ROWS = 1, 8  # rows that the list shows at once


def parts_of(path: str) -> tuple[str, int]:
    """The list of a row of the loads, and its number there."""
    name, number, _ = row_at(path)
    return name.removeprefix("loads."), number


class LoadsTable(RowsTable):
    """The list itself.

    moved     (-1 or 1): Alt+Up, Alt+Down
    removed   Delete
    chosen    (number): another row is the current one
    """

    moved = Signal(int)
    removed = Signal()
    chosen = Signal(int)

    def __init__(self) -> None:
        super().__init__(HEADINGS)
        self.setWordWrap(False)
        self.setAccessibleName("Loads")
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Maximum)
        self.selectionModel().currentRowChanged.connect(lambda now, _: self.chosen.emit(now.row()))

    def sizeHint(self) -> QSize:
        return QSize(240, self._height(min(max(self.rows.rowCount(), 2), MOST_ROWS)))

    def minimumSizeHint(self) -> QSize:
        return QSize(120, self._height(LEAST))

    def _height(self, rows: int) -> int:
        row = self.rowHeight(0) if self.rows.rowCount() else self.fontMetrics().height() + 8
        return self.horizontalHeader().sizeHint().height() + 2 * self.frameWidth() + rows * row

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not taken_by_list(self, event):
            super().keyPressEvent(event)


class LoadsPage(QWidget):
    """List, buttons, and the fields of the chosen row: in its first row what belongs to no list.

    added    (list): a row more is wanted in one of the lists of the loads
    picked   (path, key): where a row holds on is to be chosen in the drawing
    """

    added = Signal(str)
    picked = Signal(str, str)

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.holds: dict[str, AttachmentRows] = {}
        self.whens: dict[str, WhenRow] = {}
        self.table = LoadsTable()
        self.form = Form(session, "loads", row_of, self._holds)
        self._lines: tuple[LoadRow, ...] = ()
        self._study: Study | None = None
        self._largest: dict[str, str] = {}
        self.buttons = {
            "add": list_button(
                "Add", "insert", "A mass, a spring, friction or a force more, where you click in the drawing", None
            ),
            "copy": list_button("Copy", "duplicate", "The chosen row once more", self._copy),
            "remove": list_button("Remove", "delete", "Take the chosen row away (Del)", self._remove),
            "up": list_button("Up", "", "Further up among its kind (Alt+Up)", partial(self._move, -1)),
            "down": list_button("Down", "", "Further down among its kind (Alt+Down)", partial(self._move, 1)),
        }
        self.menu = QMenu(self)
        self.menu.aboutToShow.connect(self._fill)
        self.buttons["add"].setMenu(self.menu)
        self.buttons["add"].setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        bar = row_of_buttons(self.buttons.values())
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.table)
        column.addLayout(bar)
        column.addWidget(self.form, 1)
        self.form.setMinimumHeight(LOWEST)
        self._later = QTimer(self, singleShot=True, interval=LARGEST_MS)
        self._later.timeout.connect(self._find_largest)
        self.table.chosen.connect(self._choose)
        self.table.moved.connect(self._move)
        self.table.removed.connect(self._remove)
        session.load_chosen.connect(self._show_chosen)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """The list leaves the form the larger part."""
        super().resizeEvent(event)
        self.table.setMaximumHeight(max(int(PART * self.height()), self.table.minimumSizeHint().height()))

    # -- from the session ---------------------------------------------------------------------------------

    def refresh(self, study: Study, design: Design) -> None:
        """Show the loads of a design as typed; what is largest over the turn of this study follows once editing pauses."""
        self._study = study
        self.form.refresh(design)
        lines = lines_of(design)
        if [line.path for line in lines] != [line.path for line in self._lines]:
            self._largest = {}
        if lines != self._lines:
            self._lines = lines
            self._show_lines()
            self.table.setVisible(len(lines) > 1)  # with nothing but the first the form says all of it
        self._later.start()
        self._show_chosen()

    def _show_lines(self) -> None:
        with QSignalBlocker(self.table):
            before = self.table.rows.rowCount()
            self.table.update_rows(
                [TableRow((*line.cells, self._largest.get(line.path, "")), tip=line.tip) for line in self._lines]
            )
            if before != len(self._lines):
                self.table.updateGeometry()

    def _find_largest(self) -> None:
        """The last column."""
        self._later.stop()
        if self._study is None:
            return
        try:
            found = dict(_largest_texts(self._study, self._lines))
        except NoSolution:
            found = {}
        if found != self._largest:
            self._largest = found
            self._show_lines()
            self._show_chosen()

    def settle(self) -> None:
        """Do now what waits for a pause."""
        if self._later.isActive():
            self._find_largest()

    def _show_chosen(self) -> None:
        paths = [line.path for line in self._lines]
        chosen = self._session.load if self._session.load in paths else ""
        number = paths.index(chosen) if chosen else 0
        with QSignalBlocker(self.table):
            if self.table.currentIndex().row() != number and paths:
                self.table.selectRow(number)
        self.form.show_group(chosen)
        if chosen in self.holds:
            self.holds[chosen].refresh(self._session.typed)
        if chosen in self.whens:
            self.whens[chosen].refresh(self._session.typed)
        name, index = parts_of(chosen) if chosen else ("", 0)
        count = self._count(name) if name else 0
        for key in ("copy", "remove"):
            self.buttons[key].setEnabled(bool(name))
        self.buttons["up"].setEnabled(bool(name) and index > 0)
        self.buttons["down"].setEnabled(bool(name) and index < count - 1)

    def _count(self, name: str) -> int:
        """The rows of one of the lists."""
        return len(getattr(self._session.typed.drive.loads, name))

    def _holds(self, group: str) -> QWidget | None:
        """The head of a row's form."""
        if not group:
            self.holds, self.whens = {}, {}  # the form is made anew
            return None
        rows = self.holds[group] = AttachmentRows(self._session, group)
        rows.picked.connect(partial(self.picked.emit, group))
        if parts_of(group)[0] != "process":
            return rows
        both = QWidget()
        column = QVBoxLayout(both)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        self.whens[group] = WhenRow(self._session, group)
        column.addWidget(rows)
        column.addWidget(self.whens[group])
        return both

    @property
    def editors(self) -> list[QWidget]:
        """In the order of Tab: of each row where it holds on, when it works, then its values."""
        found: list[QWidget] = []
        group = ""
        for path, field in self.form.fields.items():
            if row_of(path) != group:
                group = row_of(path)
                for head in (self.holds.get(group), self.whens.get(group)):
                    found += [] if head is None else head.editors
            found.append(field.editor)
        return found

    # -- by the user ----------------------------------------------------------------------------------------

    def _fill(self) -> None:
        clear_menu(self.menu)
        for name in load_lists(self._session.typed.drive):
            text, tip = WHAT[name]
            action = self.menu.addAction(text)
            action.setStatusTip(tip)
            action.triggered.connect(partial(self._add, name))

    def _add(self, name: str, *_: object) -> None:
        self.added.emit(name)

    def choose(self, path: str) -> None:
        """Choose a row; empty: the first."""
        self._session.choose_load(path)

    def _choose(self, number: int) -> None:
        if 0 <= number < len(self._lines):
            self._session.choose_load(self._lines[number].path)

    def _copy(self) -> None:
        path = self._session.load
        if path:
            name, index = parts_of(path)
            count = self._count(name)
            self._in_order([*range(index + 1), *range(index, count)], index + 1, "Copy")

    def _remove(self) -> None:
        path = self._session.load
        if path:
            name, index = parts_of(path)
            count = self._count(name)
            self._in_order([i for i in range(count) if i != index], min(index, count - 2), "Remove")

    def _move(self, by: int) -> None:
        path = self._session.load
        if path:
            name, index = parts_of(path)
            order = list(range(self._count(name)))
            if 0 <= index + by < len(order):
                order[index], order[index + by] = order[index + by], order[index]
                self._in_order(order, index + by, "Move")

    def _in_order(self, order: list[int], chosen: int, verb: str) -> None:
        """The rows of the chosen one's list in another order, as one step."""
        path = self._session.load
        name, _ = parts_of(path)
        design = self._session.typed
        self._session.end_gesture()
        if self._session.lay_out(reordered(design, name, order), f"{verb} {row_name(design, path).lower()}"):
            self._session.choose_load(f"loads.{name}[{chosen}]" if chosen >= 0 else "")
        self._session.end_gesture()


def reordered(design: Design, name: str, order: list[int]) -> Design:
    """The design with the rows of one of its lists of loads in this order."""
    return with_rows_in_order(design, f"loads.{name}", order)


def _largest_texts(study: Study, lines: tuple[LoadRow, ...]) -> list[tuple[str, str]]:
    """Row -> its largest force, or torque, over the turn at the speed of the shaft."""
    found = []
    for line in lines:
        element = element_at(study.loading, line.path)
        if element is None:
            continue
        size, unit = peak_load(element, study.linkage, study.omega)
        rung = readable(unit, size)
        found.append((line.path, f"{digits(size / rung.size, 3)} {rung.symbol}"))
    return found
