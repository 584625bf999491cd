"""Law picker: the motion laws as curves, with their peak coefficients and a search by name."""

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
from kindyna_gui.rebuilt import call_soon, fill

LEAST_VELOCITY = 1e-9  # a smaller velocity at an end of a law is 0 [rise/span]
COLUMNS = 4
CELL = QSize(142, 106)
CURVE_BOX = QRect(12, 10, 118, 42)  # within a cell
HEADING, MARGIN = 24, 6  # heights in pixels
LIST_HEIGHT = 430  # pixels
STEPS: Mapping[int, tuple[int, int]] = MappingProxyType(
    {
        Qt.Key.Key_Left: (-1, 0),
        Qt.Key.Key_Right: (1, 0),
        Qt.Key.Key_Up: (0, -1),
        Qt.Key.Key_Down: (0, 1),
    }
)
COMMAND_KEYS = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier

# -- search and texts ------------------------------------------------------------------------------------


def matching_laws(text: str) -> dict[str, tuple[str, ...]]:
    """Groups with the laws that have all words of the text in their name or in that of the group."""
    words = text.lower().split()
    result = {}
    for name, slugs in law_groups().items():
        matches = tuple(s for s in slugs if all(w in f"{s} {law_label(s)} {name}".lower() for w in words))
        if matches:
            result[name] = matches
    return result


def peaks_text(slug: str) -> str:
    """Peak coefficients as text, such as ``Cv 1.76  Ca 5.53  Cj 69.5``; what a law without them has instead."""
    law = named_law(slug)
    if law.is_dwell or not law.pieces:
        return law.own
    peak = peaks(law)
    return "  ".join(f"{name} {short(value, 3)}" for name, value in (("Cv", peak.cv), ("Ca", peak.ca), ("Cj", peak.cj)))


def law_tip(slug: str) -> str:
    """Description of a law in one to three lines."""
    law = named_law(slug)
    text = sentence(law.help or law.source)
    if law.pieces and not law.is_dwell:
        text += "\nPeaks for unit rise and span; the jerk at the ends is not included"
        if float(np.abs(law(np.array([0.0, 1.0]))[1]).max()) > LEAST_VELOCITY:
            text += "\nIt starts or ends with a velocity, which jumps at a dwell"
        elif peaks(law).jumps_at_an_end:
            text += "\nIts acceleration jumps at a dwell"
    return text


# -- list of laws ----------------------------------------------------------------------------------------


@frozen
class LawCell:
    """A law and its cell [pixels]."""

    slug: str
    box: QRect


class LawGrid(QWidget):
    """The laws that match the search, by groups.

    ``picked`` (slug) is emitted when a law is clicked.
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
        """Show these laws under their headings; the first becomes current if the current one is not among them."""
        cells, headings, y = [], [], 0
        for name, slugs in rows.items():
            headings.append((y, name))
            y += HEADING
            for i, slug in enumerate(slugs):
                corner = QPoint(MARGIN + i % COLUMNS * CELL.width(), y + i // COLUMNS * CELL.height())
                cells.append(LawCell(slug, QRect(corner, CELL)))
            y += -(-len(slugs) // COLUMNS) * CELL.height() + MARGIN
        self.cells, self._headings = tuple(cells), tuple(headings)
        if self.current not in {cell.slug for cell in cells}:
            self.current = cells[0].slug if cells else ""
        self.setFixedSize(2 * MARGIN + COLUMNS * CELL.width(), max(y, HEADING))
        self.update()

    def box(self, slug: str) -> QRect:
        """Cell of a law; empty if it is not shown."""
        return next((cell.box for cell in self.cells if cell.slug == slug), QRect())

    def choose(self, slug: str) -> None:
        """Make this law the current one."""
        if slug != self.current:
            self.current = slug
            self.update()

    def step(self, dx: int, dy: int) -> None:
        """Move to the next law sideways, or to the nearest one in the row above or below."""
        if not self.cells:
            return
        order = [cell.slug for cell in self.cells]
        at = order.index(self.current)
        if dx:
            self.choose(order[min(max(at + dx, 0), len(order) - 1)])
            return
        box = self.cells[at].box
        ahead = [cell for cell in self.cells if (cell.box.top() - box.top()) * dy > 0]
        if ahead:
            top = min((cell.box.top() for cell in ahead), key=lambda y: abs(y - box.top()))
            row = [cell for cell in ahead if cell.box.top() == top]
            self.choose(min(row, key=lambda cell: abs(cell.box.left() - box.left())).slug)

    def at(self, position: QPoint) -> str:
        """Law at a position; empty where there is none."""
        return next((cell.slug for cell in self.cells if cell.box.contains(position)), "")

    # -- events ------------------------------------------------------------------------------------------

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
        paint_law(painter, QRectF(CURVE_BOX.translated(cell.box.topLeft())), cell.slug, SCREEN)
        name_box = QRect(cell.box.left() + 3, cell.box.top() + CURVE_BOX.bottom() + 5, CELL.width() - 6, 30)
        painter.setFont(font(SMALL))
        painter.setPen(QColor(SCREEN.ink))
        name = wrapped(law_label(cell.slug), name_box.width())
        painter.drawText(name_box, Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignVCenter, name)
        painter.setFont(font(SMALL - 1))
        painter.setPen(QColor(SCREEN.quiet))
        footer = QRect(cell.box.left() + 2, cell.box.bottom() - 17, CELL.width() - 4, 14)
        painter.drawText(footer, Qt.AlignmentFlag.AlignCenter, peaks_text(cell.slug))

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
    """Pop-up window with the laws and a search line.

    Signals: ``picked`` (slug) at Enter or a click; ``closed`` when the window closes without a selection.
    """

    picked = Signal(str)
    closed = Signal()

    def __init__(self, parent: QWidget, current: str, typed: str = "") -> None:
        super().__init__(parent, Qt.WindowType.Popup, frameShape=QFrame.Shape.Box)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setStyleSheet(f"LawPicker {{ border: 1px solid {SCREEN.line}; }}")
        self.grid = LawGrid()
        self.grid.choose(current)
        self.filter = QLineEdit(
            typed, placeholderText="Type a part of the name, such as cycl, 3-4-5, blending", clearButtonEnabled=True
        )
        self.filter.textChanged.connect(self._filter)
        self.filter.installEventFilter(self)
        self.no_match = coloured(
            QLabel("No name of a law contains this text.", alignment=Qt.AlignmentFlag.AlignCenter), SCREEN.quiet
        )
        self.no_match.hide()
        legend = coloured(
            QLabel(
                f"<span style='color:{SCREEN.family('displacement')}'>—</span> displacement&nbsp;&nbsp; "
                f"<span style='color:{SCREEN.family('acceleration')}'>—</span> acceleration&nbsp;&nbsp; "
                "Cv Ca Cj: peaks for unit rise and span"
            ),
            SCREEN.quiet,
        )
        self.area = QScrollArea()
        self.area.setFrameShape(QFrame.Shape.NoFrame)
        self.area.setWidget(self.grid)
        self.area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.area.viewport().setStyleSheet(f"background: {SCREEN.paper};")
        fill(QVBoxLayout(self), self.filter, self.no_match, (self.area, 1), legend, margins=6, spacing=4)
        bar = self.area.verticalScrollBar().sizeHint().width()
        self.area.setFixedWidth(self.grid.width() + bar)
        self.area.setMinimumHeight(min(LIST_HEIGHT, self.grid.height()))
        self.setFocusProxy(self.filter)
        self.grid.picked.connect(self._pick)
        self._is_done = False
        if typed:
            self._filter(typed)

    def open_at(self, cell: QRect) -> None:
        """Open below a cell [pixels on the screen], or above it where there is no room below."""
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
        laws = matching_laws(text)
        self.grid.show_laws(laws)
        self.no_match.setVisible(not laws)
        self._reveal()

    def _pick(self, slug: str) -> None:
        self._is_done = True
        self.close()
        self.picked.emit(slug)

    def hideEvent(self, event: QEvent) -> None:
        super().hideEvent(event)  # type: ignore[arg-type]
        if not self._is_done:
            self._is_done = True
            self.closed.emit()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Pass arrows and Enter to the grid, all other keys to the line."""
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


class LawBox(WordBox):
    """Box with the name of a law, which opens the picker.

    ``cancelled`` is emitted when the picker closes without a selection.
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
        """Open the picker with this text in its search line."""
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
        if event.text().strip() and event.text().isprintable() and not event.modifiers() & COMMAND_KEYS:
            self.open(event.text())
        else:
            super().keyPressEvent(event)
