"""Law picker."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QEvent, QObject, QPoint, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QHelpEvent, QKeyEvent, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QFrame, QLabel, QLineEdit, QScrollArea, QToolTip, QVBoxLayout, QWidget

from core.frozen import frozen
from core.laws import EVERY_LAW, law_groups, named_law, peaks
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.labels import law_label, sentence
from kindyna_gui.look import coloured
from kindyna_gui.pictures.items import wrapped
from kindyna_gui.pictures.plots.quantities import paint_law
from kindyna_gui.pictures.style import SCREEN, SMALL, font
from kindyna_gui.pictures.units import short
from kindyna_gui.rebuilt import call_soon

# -- law list --------------------------------------------------------------------------------------------

MOVING = 1e-9  # a velocity at an end above this is one [rise/span]


def matching(text: str) -> dict[str, tuple[str, ...]]:
    """The groups with those laws that have all words of a text in their name or that of their group."""
    words = text.lower().split()
    kept = {}
    for name, slugs in law_groups().items():
        hits = tuple(s for s in slugs if all(w in f"{s} {law_label(s)} {name}".lower() for w in words))
        if hits:
            kept[name] = hits
    return kept


def peaks_text(slug: str) -> str:
    """``Cv 1.76  Ca 5.53  Cj 69.5``; what the law has instead where there are none."""
    law = named_law(slug)
    if law.is_dwell or not law.pieces:
        return law.own
    own = peaks(law)
    rows = (("Cv", own.cv), ("Ca", own.ca), ("Cj", own.cj))
    return "  ".join(f"{name} {short(value, 3)}" for name, value in rows)


def law_tip(slug: str) -> str:
    """What a law is, in a line or two."""
    law = named_law(slug)
    text = sentence(law.help or law.source)
    if law.pieces and not law.is_dwell:
        text += "\nPeaks for unit rise and span; jerk counts the inside of the law only"
        if float(np.abs(law(np.array([0.0, 1.0]))[1]).max()) > MOVING:
            text += "\nIt begins or ends in motion: the velocity jumps where it meets a dwell"
        elif peaks(law).jumps_at_an_end:
            text += "\nIts acceleration jumps where it meets a dwell"
    return text


# -- law picker ------------------------------------------------------------------------------------------

COLUMNS = 4
CELL = QSize(142, 106)
PICTURE = QRect(12, 10, 118, 42)  # within a cell
HEADING, MARGIN = 24, 6  # heights in pixels
ROOM = 430  # height of the list, pixels
STEPS: Mapping[int, tuple[int, int]] = MappingProxyType(
    {
        Qt.Key.Key_Left: (-1, 0),
        Qt.Key.Key_Right: (1, 0),
        Qt.Key.Key_Up: (0, -1),
        Qt.Key.Key_Down: (0, 1),
    }
)


@frozen
class LawCell:
    slug: str
    box: QRect


class LawGrid(QWidget):
    """The laws that match the search, group by group.

    picked  (slug): a law was clicked
    """

    picked = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.cells: tuple[LawCell, ...] = ()
        self.current = ""
        self._headings: tuple[tuple[int, str], ...] = ()
        self.setMouseTracking(True)
        self.show_laws(law_groups())

    def show_laws(self, rows: Mapping[str, tuple[str, ...]]) -> None:
        """Show these laws under their headings; the current one stays where it is among them, else the first is."""
        cells, headings, y = [], [], 0
        for name, slugs in rows.items():
            headings.append((y, name))
            y += HEADING
            for i, slug in enumerate(slugs):
                place = QPoint(MARGIN + i % COLUMNS * CELL.width(), y + i // COLUMNS * CELL.height())
                cells.append(LawCell(slug, QRect(place, CELL)))
            y += -(-len(slugs) // COLUMNS) * CELL.height() + MARGIN
        self.cells, self._headings = tuple(cells), tuple(headings)
        if self.current not in {cell.slug for cell in cells}:
            self.current = cells[0].slug if cells else ""
        self.setFixedSize(2 * MARGIN + COLUMNS * CELL.width(), max(y, HEADING))
        self.update()

    def box(self, slug: str) -> QRect:
        """Where a law stands."""
        return next((cell.box for cell in self.cells if cell.slug == slug), QRect())

    def choose(self, slug: str) -> None:
        """Mark this law as the current one."""
        if slug != self.current:
            self.current = slug
            self.update()

    def step(self, dx: int, dy: int) -> None:
        """Go to the next law sideways, or to the nearest one in the row above or below."""
        if not self.cells:
            return
        order = [cell.slug for cell in self.cells]
        at = order.index(self.current)
        if dx:
            self.choose(order[min(max(at + dx, 0), len(order) - 1)])
            return
        here = self.cells[at].box
        ahead = [c for c in self.cells if (c.box.top() - here.top()) * dy > 0]
        if ahead:
            row = min(ahead, key=lambda c: abs(c.box.top() - here.top())).box.top()
            inside = [c for c in ahead if c.box.top() == row]
            self.choose(min(inside, key=lambda c: abs(c.box.left() - here.left())).slug)

    def at(self, place: QPoint) -> str:
        """The law at a place; empty where there is none."""
        return next((cell.slug for cell in self.cells if cell.box.contains(place)), "")

    # -- events -------------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for y, name in self._headings:
            painter.setFont(font(SMALL, bold=True))
            painter.setPen(QColor(SCREEN.quiet))
            box = QRect(MARGIN + 4, y, self.width(), HEADING)
            painter.drawText(box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, name)
        for cell in self.cells:
            if cell.box.intersects(event.rect()):
                self._paint(painter, cell)
        painter.end()

    def _paint(self, painter: QPainter, cell: LawCell) -> None:
        if cell.slug == self.current:
            painter.setPen(SCREEN.pen(SCREEN.chosen))
            painter.setBrush(QColor(SCREEN.chosen_row))
            painter.drawRoundedRect(QRectF(cell.box).adjusted(1.5, 1.5, -1.5, -1.5), 3.0, 3.0)
        paint_law(painter, QRectF(PICTURE.translated(cell.box.topLeft())), cell.slug, SCREEN)
        under = QRect(cell.box.left() + 3, cell.box.top() + PICTURE.bottom() + 5, CELL.width() - 6, 30)
        painter.setFont(font(SMALL))
        painter.setPen(QColor(SCREEN.ink))
        name = wrapped(law_label(cell.slug), under.width())
        painter.drawText(under, Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignVCenter, name)
        painter.setFont(font(SMALL - 1))
        painter.setPen(QColor(SCREEN.quiet))
        foot = QRect(cell.box.left() + 2, cell.box.bottom() - 17, CELL.width() - 4, 14)
        painter.drawText(foot, Qt.AlignmentFlag.AlignCenter, peaks_text(cell.slug))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        slug = self.at(event.position().toPoint())
        if slug:
            self.choose(slug)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        slug = self.at(event.position().toPoint())
        if slug and event.button() == Qt.MouseButton.LeftButton:
            self.picked.emit(slug)

    def event(self, event: QEvent) -> bool:
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            slug = self.at(event.pos())
            QToolTip.showText(event.globalPos(), f"{law_label(slug)}\n{law_tip(slug)}" if slug else "", self)
            return True
        return super().event(event)


class LawPicker(QFrame):
    """The laws in a window of their own that closes by itself.

    picked  (slug): Enter, or a click
    closed  without a choice
    """

    picked = Signal(str)
    closed = Signal()

    def __init__(self, parent: QWidget, current: str, typed: str = "") -> None:
        super().__init__(parent, Qt.WindowType.Popup)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setFrameShape(QFrame.Shape.Box)
        self.setStyleSheet(f"LawPicker {{ border: 1px solid {SCREEN.line}; }}")
        self.grid = LawGrid()
        self.grid.choose(current)
        self.filter = QLineEdit(typed)
        self.filter.setPlaceholderText("Type a part of the name, such as cycl, 3-4-5, blending")
        self.filter.setClearButtonEnabled(True)
        self.filter.textChanged.connect(self._filter)
        self.filter.installEventFilter(self)
        self.nothing = QLabel("No law has this in its name.", alignment=Qt.AlignmentFlag.AlignCenter)
        coloured(self.nothing, SCREEN.quiet)
        self.nothing.hide()
        legend = QLabel(
            f"<span style='color:{SCREEN.family('displacement')}'>—</span> displacement&nbsp;&nbsp; "
            f"<span style='color:{SCREEN.family('acceleration')}'>—</span> acceleration&nbsp;&nbsp; "
            "Cv Ca Cj: peaks for unit rise and span"
        )
        coloured(legend, SCREEN.quiet)
        self.area = QScrollArea()
        self.area.setFrameShape(QFrame.Shape.NoFrame)
        self.area.setWidget(self.grid)
        self.area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.area.viewport().setStyleSheet(f"background: {SCREEN.paper};")
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 6)
        column.setSpacing(4)
        column.addWidget(self.filter)
        column.addWidget(self.nothing)
        column.addWidget(self.area, 1)
        column.addWidget(legend)
        bar = self.area.verticalScrollBar().sizeHint().width()
        self.area.setFixedWidth(self.grid.width() + bar)
        self.area.setMinimumHeight(min(ROOM, self.grid.height()))
        self.setFocusProxy(self.filter)
        self.grid.picked.connect(self._pick)
        self._chosen = False
        if typed:
            self._filter(typed)

    def open_at(self, cell: QRect) -> None:
        """Open below a cell, or above it where there is no room; the cell in places of the screen."""
        self.adjustSize()
        room = self.screen().availableGeometry()
        x = max(room.left(), min(cell.left(), room.right() - self.width()))
        below = cell.bottom() + 1
        y = below if below + self.height() <= room.bottom() else max(room.top(), cell.top() - self.height())
        self.move(x, y)
        self.show()
        self.filter.setFocus(Qt.FocusReason.PopupFocusReason)
        call_soon(self.grid, self._reveal)

    def _reveal(self) -> None:
        box = self.grid.box(self.grid.current)
        self.area.ensureVisible(box.center().x(), box.center().y(), 0, CELL.height() // 2 + HEADING)

    def _filter(self, text: str) -> None:
        rows = matching(text)
        self.grid.show_laws(rows)
        self.nothing.setVisible(not rows)
        self._reveal()

    def _pick(self, slug: str) -> None:
        self._chosen = True
        self.close()
        self.picked.emit(slug)

    def hideEvent(self, event: QEvent) -> None:
        super().hideEvent(event)  # type: ignore[arg-type]
        if not self._chosen:
            self._chosen = True
            self.closed.emit()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Arrows and Enter belong to the grid, all other keys to the line."""
        if not isinstance(event, QKeyEvent) or event.type() != QEvent.Type.KeyPress:
            return False
        if event.key() in STEPS:
            self.grid.step(*STEPS[event.key()])
            self._reveal()
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Tab):
            if self.grid.current:
                self._pick(self.grid.current)
        elif event.key() == Qt.Key.Key_Escape:
            self.close()
        else:
            return False
        return True


_COMMANDS = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier


class LawBox(WordBox):
    """The name of a law; its list is the picker.

    cancelled  the picker was closed without a choice
    """

    cancelled = Signal()

    def __init__(self) -> None:
        super().__init__()
        for slug in EVERY_LAW:
            self.addItem(law_label(slug), slug)
        self.picker: LawPicker | None = None

    def showPopup(self) -> None:
        self.open("")

    def open(self, typed: str) -> None:
        """Open the picker, with this typed already."""
        if self.picker is not None:
            return
        self.picker = LawPicker(self, self.currentData(), typed)
        self.picker.picked.connect(self._picked)
        self.picker.closed.connect(self._closed)
        self.picker.open_at(QRect(self.mapToGlobal(QPoint(0, 0)), self.size()))

    def hidePopup(self) -> None:
        if self.picker is not None:
            self.picker.close()

    def _picked(self, slug: str) -> None:
        self.picker = None
        index = self.findData(slug)
        self.setCurrentIndex(index)
        self.activated.emit(index)

    def _closed(self) -> None:
        self.picker = None
        self.cancelled.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.text().strip() and event.text().isprintable() and not event.modifiers() & _COMMANDS:
            self.open(event.text())
        else:
            super().keyPressEvent(event)
