"""What a user cannot read in a window: views below their least size, cut texts, tabs behind arrows, what rolls sideways."""

from collections.abc import Iterator

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractScrollArea,
    QCheckBox,
    QComboBox,
    QHeaderView,
    QLabel,
    QLineEdit,
    QListView,
    QRadioButton,
    QTabBar,
    QTableView,
    QToolButton,
    QTreeView,
    QWidget,
)

from kindyna_gui.forms.tab_bars import TabList
from kindyna_gui.pictures.plots.plot import FixedPlot
from kindyna_gui.rebuilt import is_in_sight
from kindyna_gui.view import View
from kindyna_gui.window.main_window import MainWindow

PLOT, MECHANISM = QSize(160, 80), QSize(240, 180)
PARAMETERS, NEAR = 388, 6
WIDE, ROWS = 480, 5  # What changed, Explain
ROOM = 8  # pixels that a button has beside its text at the least
SLACK = 1


def unreadable(window: MainWindow, called: str = "") -> list[str]:
    """One line for each thing that cannot be read; ``called``: the view that the user has just called."""
    views = [view for view in window.findChildren(View) if is_in_sight(view)]
    return [
        *(line for view in views for line in _of_view(window, view)),
        *_of_sizes(window, called),
        *_tabs(window),
        *_cut(window),
    ]


def _name(window: MainWindow, view: View) -> str:
    return next((name for name in (*window.docks, "mechanism") if window.view(name) is view), type(view).__name__)


def _of_view(window: MainWindow, view: View) -> Iterator[str]:
    name = _name(window, view)
    for plot in view.findChildren(FixedPlot):
        box = plot.getViewBox()
        if is_in_sight(plot) and (box.width() < PLOT.width() or box.height() < PLOT.height()):
            yield f"{name}: plot of {box.width():.0f} x {box.height():.0f}"
    for area in view.findChildren(QAbstractScrollArea):
        if (
            is_in_sight(area)
            and area.horizontalScrollBar().maximum() > 0
            and area.horizontalScrollBarPolicy() != Qt.ScrollBarPolicy.ScrollBarAlwaysOff
        ):
            yield f"{name}: {type(area).__name__} rolls sideways by {area.horizontalScrollBar().maximum()}"
    for table in view.findChildren(QAbstractItemView):
        if (
            is_in_sight(table)
            and isinstance(table, QTableView | QTreeView | QListView)
            and not isinstance(table, QHeaderView)
        ):
            yield from _table(name, table)


def _table(name: str, table: QAbstractItemView, least: int = 3) -> Iterator[str]:
    model = table.model()
    if model is None:
        return
    rows = min(least, model.rowCount())
    if rows:
        first, last = (table.visualRect(model.index(row, 0)) for row in (0, rows - 1))
        needed = rows * first.height() if isinstance(table, QTreeView) else last.bottom() - first.top() + 1
        if needed > table.viewport().height() + SLACK:
            yield f"{name}: {rows} rows need {needed}, have {table.viewport().height()}"
    if isinstance(table, QTableView | QTreeView):
        header = table.horizontalHeader() if isinstance(table, QTableView) else table.header()
        if not header.isVisible():
            return
        for i in range(header.count()):
            text = str(model.headerData(i, Qt.Orientation.Horizontal) or "")
            if header.isSectionHidden(i) or not text:
                continue
            if header.fontMetrics().horizontalAdvance(text) + 4 > header.sectionSize(i):
                yield f"{name}: heading {text!r} of {header.sectionSize(i)}"
        if header.length() > table.viewport().width() + SLACK:
            yield f"{name}: columns of {header.length()} in {table.viewport().width()}"


def _of_sizes(window: MainWindow, called: str) -> Iterator[str]:
    parameters = window.docks["parameters"]
    if is_in_sight(parameters) and abs(parameters.width() - PARAMETERS) > NEAR:
        yield f"parameters: {parameters.width()} wide"
    drawing = window.view("mechanism")
    if drawing is not None and is_in_sight(drawing):
        canvas = drawing.canvas if hasattr(drawing, "canvas") else drawing
        if canvas.width() < MECHANISM.width() or canvas.height() < MECHANISM.height():
            yield f"mechanism: {canvas.width()} x {canvas.height()}"
    if called in ("compare", "explain"):
        view = window.view(called)
        assert view is not None
        if view.width() < WIDE:
            yield f"{called}: {view.width()} wide"
        for table in view.findChildren(QAbstractItemView):
            if is_in_sight(table):
                yield from _table(called, table, ROWS)
    if called and called in window.docks:
        view = window.view(called)
        if view is None or not is_in_sight(view):
            yield f"{called}: not in sight"


def _tabs(window: MainWindow) -> Iterator[str]:
    for bar in window.findChildren(QTabBar):
        if not is_in_sight(bar):
            continue
        arrows = [b for b in bar.findChildren(QToolButton) if b.isVisible() and not isinstance(b, TabList)]
        if arrows:
            yield f"tabs {[bar.tabText(i) for i in range(bar.count())]}: behind arrows"
        for i in range(bar.count()):
            wanted = bar.fontMetrics().horizontalAdvance(bar.tabText(i).replace("&", ""))
            if bar.isTabVisible(i) and (wanted > bar.tabRect(i).width() - ROOM or bar.tabRect(i).right() > bar.width()):
                yield f"tab {bar.tabText(i)!r}: cut"


def _cut(window: MainWindow) -> Iterator[str]:
    for each in window.findChildren(QWidget):
        if each.visibleRegion().isEmpty():
            continue
        if isinstance(each, QLabel) and each.text() and each.pixmap().isNull():
            if each.wordWrap():
                if each.heightForWidth(each.width()) > each.height() + SLACK:
                    yield f"label {each.text()!r}: too low"
            elif each.sizeHint().width() > each.width() + SLACK and not each.toolTip():
                yield f"label {each.text()!r}: too narrow"
        elif isinstance(each, QAbstractButton) and each.text() and _shows_text(each):
            wanted = each.sizeHint().width()
            if not isinstance(each, QToolButton | QCheckBox | QRadioButton):
                wanted = each.fontMetrics().horizontalAdvance(each.text().replace("&", "")) + ROOM
            if wanted > each.width() + SLACK:
                yield f"button {each.text()!r}: too narrow"
            if not isinstance(
                each.parentWidget().parentWidget(), QAbstractItemView
            ) and not each.parentWidget().rect().contains(each.geometry()):
                yield f"button {each.text()!r}: beyond its parent"
        elif isinstance(each, QComboBox) and each.lineEdit() is None:
            wanted = each.fontMetrics().horizontalAdvance(each.currentText()) + 20
            if wanted > each.width() and not each.toolTip():
                yield f"choice {each.currentText()!r}: {each.width()} for {wanted}"
        elif isinstance(each, QLineEdit) and each.text() and not each.toolTip():
            wanted = each.fontMetrics().horizontalAdvance(each.text())
            if wanted > each.width():
                yield f"field {each.text()!r}: {each.width()} for {wanted}"


def _shows_text(button: QAbstractButton) -> bool:
    return not isinstance(button, QToolButton) or button.toolButtonStyle() != Qt.ToolButtonStyle.ToolButtonIconOnly
