"""The page of the loads: a list with a row for each load, and the form of the selected one below."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import partial

from PySide6.QtCore import QSignalBlocker, QSize, Signal
from PySide6.QtGui import QKeyEvent, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QMenu, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from core.design import Design, Entry, Process, entries, get, load_lists, row_at, with_rows_in_order
from core.design.fields import in_sentence
from core.dynamics import element_at, peak_load
from core.errors import NoSolution
from core.frozen import frozen
from core.number_text import shortest
from core.output.load_text import row_attachments, row_name
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.form import Form
from kindyna_gui.forms.load_rows import AttachmentRows, WhenRow, list_button, row_of_buttons, taken_by_list
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import value_text
from kindyna_gui.pictures.units import digits, readable
from kindyna_gui.rebuilt import add_entry, clear_menu, connect_all, fill, single_shot, widget_with

WHAT = {
    "masses": ("&Mass", "Add a mass and an inertia to a link"),
    "forces": ("&Force", "Add a constant force and a torque on a link"),
    "springs": (
        "&Spring and damper",
        "Add a spring and damper between two points of links, or of a link and the frame",
    ),
    "torsion_springs": ("&Torsion spring and damper", "Add a torsion spring and damper between two links"),
    "pair_friction": ("F&riction", "Add friction in a pin or along a slide"),
    "process": ("&Process force", "Add a force over a part of the turn or of the motion, or as a table"),
    "valve_springs": ("&Valve spring", "Add a helical spring that closes the valve, in place of rate and preload"),
}
"""List of loads -> its entry in the Add menu, and the tip."""
GENERAL = "General values"
_ROW = re.compile(r"(loads\.\w+\[\d+\])")
MOST_VALUES = 3  # values that a line lists
HEADINGS = (
    TableHeading("Load"),
    TableHeading("Where", wide=True, spare=2),
    TableHeading("Value"),
    TableHeading("Largest", number=True, spare=1),
)
PART = 0.38  # largest share of the height for the list
LOWEST = 40  # height of the form, pixels
LARGEST_MS = 150  # from an edit to the computation of the largest forces
LEAST, MOST_ROWS = 3, 8  # rows that the list shows at once

# -- the rows of the list as texts -----------------------------------------------------------------------


@frozen
class LoadRow:
    """A row of the list: path ("" for the values in general); name, attachments and value; and all values as a tip."""

    path: str
    cells: tuple[str, str, str]
    tip: str = ""


def what_of(name: str) -> str:
    """Return the name of a load of a list in a sentence, such as ``spring and damper``."""
    return WHAT[name][0].replace("&", "").lower()


def lines_of(design: Design) -> tuple[LoadRow, ...]:
    """Return the row of the values in general, then a row for each load."""
    texts: dict[str, list[str]] = {}
    for entry in entries(design, "loads"):
        if _is_size(entry):
            row = row_of(entry.path)
            text = value_text(entry.value, entry.unit)
            texts.setdefault(row, []).append(text if row else f"{entry.info.in_sentence} {text}")
    general = texts.get("", [])
    return (
        LoadRow("", (GENERAL, ", ".join(general[:MOST_VALUES]), ""), ", ".join(general) or "No value is given"),
        *_rows(design, texts),
    )


def row_of(path: str) -> str:
    """Return the path of the load that a path belongs to; empty for a value in general."""
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
    """Whether an entry is the size of a load, not its position."""
    key = entry.path.rpartition(".")[2]
    is_position = key in ("x_mm", "y_mm", "centre_x_mm", "centre_y_mm") or key.startswith("gravity") or "_centre" in key
    return isinstance(entry.value, float) and entry.value != 0.0 and not is_position


def _process_text(row: Process) -> str:
    """Return the value of a process force, such as ``-100 N from 0° to 90°``."""
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
    """Return the path of the first size of a load, else of its first value."""
    rows = [entry for entry in entries(design, "loads") if entry.path.startswith(f"{path}.")]
    sizes = [entry.path for entry in rows if entry.value is not None and _is_size(entry)]
    if isinstance(get(design, path), Process):
        sizes = [size for size in sizes if size.endswith(("force_n", "torque_nm"))]
    return next(iter(sizes), next((entry.path for entry in rows), path))


# -- the list and its page -------------------------------------------------------------------------------


def parts_of(path: str) -> tuple[str, int]:
    """Return the name of the list of a load, and its number there."""
    name, number, _ = row_at(path)
    return name.removeprefix("loads."), number


class LoadsTable(RowsTable):
    """The list of the loads.

    Signals: ``moved`` with -1 or 1 for Alt+Up and Alt+Down; ``removed`` for Delete; ``chosen`` with the number of the row
    that becomes the current one.
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
        return QSize(120, self._height(min(self.rows.rowCount(), LEAST)))

    def _height(self, rows: int) -> int:
        row = self.rowHeight(0) if self.rows.rowCount() else self.fontMetrics().height() + 8
        return self.horizontalHeader().sizeHint().height() + 2 * self.frameWidth() + rows * row

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not taken_by_list(self, event):
            super().keyPressEvent(event)


class LoadsPage(QWidget):
    """List, buttons, and the fields of the selected load; the first row has the values in general.

    Signals: ``added`` with the list to which the user adds a load; ``picked`` with the path of a load and the key of the
    attachment to be selected in the drawing.
    """

    added = Signal(str)
    picked = Signal(str, str)

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.attachments: dict[str, AttachmentRows] = {}
        self.whens: dict[str, WhenRow] = {}
        self.table = LoadsTable()
        self.form = Form(session, "loads", row_of, self._header)
        self._lines: tuple[LoadRow, ...] = ()
        self._study: Study | None = None
        self._largest: dict[str, str] = {}
        self.buttons = {
            "add": list_button(
                "Add", "insert", "Add a mass, a spring, friction or a force where you click in the drawing", None
            ),
            "copy": list_button("Copy", "duplicate", "Duplicate the selected load", self._copy),
            "remove": list_button("Remove", "delete", "Remove the selected load (Del)", self._remove),
            "up": list_button("Up", "", "Move up among loads of its kind (Alt+Up)", partial(self._move, -1)),
            "down": list_button("Down", "", "Move down among loads of its kind (Alt+Down)", partial(self._move, 1)),
        }
        self.menu = QMenu(self)
        self.menu.aboutToShow.connect(self._fill)
        self.buttons["add"].setMenu(self.menu)
        self.buttons["add"].setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        bar = row_of_buttons(self.buttons.values())
        fill(QVBoxLayout(self), self.table, bar, (self.form, 1), margins=0, spacing=0)
        self.form.setMinimumHeight(LOWEST)
        self._later = single_shot(self, self._find_largest, LARGEST_MS)
        connect_all(
            (self.table.chosen, self._choose),
            (self.table.moved, self._move),
            (self.table.removed, self._remove),
            (session.load_chosen, self._show_chosen),
            (session.drag_ended, self._later.start),
        )

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Leave the larger part of the height to the form."""
        super().resizeEvent(event)
        self.table.setMaximumHeight(max(int(PART * self.height()), self.table.minimumSizeHint().height()))

    @property
    def list_height(self) -> int:
        """Least height of the list of loads; 0 where the form shows all."""
        return 0 if self.table.isHidden() else self.table.minimumSizeHint().height()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if self.form.fields:
            self._show_chosen()

    # -- from the session ---------------------------------------------------------------------------------

    def refresh(self, study: Study, design: Design) -> None:
        """Show the loads of a design as typed; the largest forces over the turn follow when editing pauses."""
        self._study = study
        self.form.refresh(design)
        lines = lines_of(design)
        if [line.path for line in lines] != [line.path for line in self._lines]:
            self._largest = {}
        if lines != self._lines:
            self._lines = lines
            self._show_lines()
            self.table.setVisible(len(lines) > 1)  # the form shows everything where there is only the first row
        if self._session.drag_source is None:
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
        """Compute and show the last column."""
        self._later.stop()
        if self._study is None:
            return
        try:
            largest = dict(_largest_texts(self._study, self._lines))
        except NoSolution:
            largest = {}
        if largest != self._largest:
            self._largest = largest
            self._show_lines()
            self._show_chosen()

    def settle(self) -> None:
        """Compute now what waits for a pause."""
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
        if chosen in self.attachments:
            self.attachments[chosen].refresh(self._session.typed)
        if chosen in self.whens:
            self.whens[chosen].refresh(self._session.typed)
        name, index = parts_of(chosen) if chosen else ("", 0)
        count = self._count(name) if name else 0
        for key in ("copy", "remove"):
            self.buttons[key].setEnabled(bool(name))
        self.buttons["up"].setEnabled(bool(name) and index > 0)
        self.buttons["down"].setEnabled(bool(name) and index < count - 1)

    def _count(self, name: str) -> int:
        """Return the number of loads in a list."""
        return len(getattr(self._session.typed.drive.loads, name))

    def _header(self, group: str) -> QWidget | None:
        """Return the rows above the fields of a load: its attachments, and when it acts."""
        if not group:
            self.attachments, self.whens = {}, {}  # the form is created again
            return None
        rows = self.attachments[group] = AttachmentRows(self._session, group)
        rows.picked.connect(partial(self.picked.emit, group))
        if parts_of(group)[0] != "process":
            return rows
        self.whens[group] = WhenRow(self._session, group)
        both = widget_with(fill(QVBoxLayout(), rows, self.whens[group], margins=0, spacing=0))
        return both

    @property
    def editors(self) -> list[QWidget]:
        """Editors in the order of Tab: the attachments of each load, when it acts, then its values."""
        editors: list[QWidget] = []
        if not self.form.is_built:
            return editors
        group = ""
        for path, field in self.form.fields.items():
            if row_of(path) != group:
                group = row_of(path)
                for rows in (self.attachments.get(group), self.whens.get(group)):
                    editors += [] if rows is None else rows.editors
            editors.append(field.editor)
        return editors

    # -- by the user ----------------------------------------------------------------------------------------

    def _fill(self) -> None:
        clear_menu(self.menu)
        for name in load_lists(self._session.typed.drive):
            text, tip = WHAT[name]
            add_entry(self.menu, text, partial(self.added.emit, name), tip)

    def choose(self, path: str) -> None:
        """Select a load; with an empty path the first row."""
        self._session.choose_load(path)

    def _choose(self, number: int) -> None:
        if 0 <= number < len(self._lines):
            self._session.choose_load(self._lines[number].path)

    def _copy(self) -> None:
        path = self._session.load
        if path:
            name, index = parts_of(path)
            count = self._count(name)
            self._in_order([*range(index + 1), *range(index, count)], index + 1, "Duplicate")

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
        """Reorder the list of the selected load, as one undo step."""
        path = self._session.load
        name, _ = parts_of(path)
        design = self._session.typed
        with self._session.one_step():
            if self._session.lay_out(reordered(design, name, order), f"{verb} {in_sentence(row_name(design, path))}"):
                self._session.choose_load(f"loads.{name}[{chosen}]" if chosen >= 0 else "")


def reordered(design: Design, name: str, order: list[int]) -> Design:
    """Return the design with the loads of a list in this order."""
    return with_rows_in_order(design, f"loads.{name}", order)


def _largest_texts(study: Study, lines: tuple[LoadRow, ...]) -> list[tuple[str, str]]:
    """Return the path of each load with its largest force, or torque, over the turn at the speed of the shaft."""
    texts = []
    for line in lines:
        element = element_at(study.loading, line.path)
        if element is None:
            continue
        size, unit = peak_load(element, study.linkage, study.omega)
        unit_shown = readable(unit, size)
        texts.append((line.path, f"{digits(size / unit_shown.size, 3)} {unit_shown.symbol}"))
    return texts
