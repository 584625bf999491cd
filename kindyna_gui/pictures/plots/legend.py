"""Names of curves above a plot: on as many lines as its width needs, never wider than it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape

from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QFontMetricsF
from PySide6.QtWidgets import QGraphicsTextItem, QGraphicsWidget

from core.frozen import frozen
from kindyna_gui.pictures.style import SMALL, font
from kindyna_gui.preferences.units import sized

LEGEND_HEIGHT = 18.0  # of the first line, pixels
LEAST_LINES = 2  # may always be taken
CUT = "…"
APART = "\u00a0\u00a0 "  # between names


@frozen
class Entry:
    """A name, with the colour of its curve and what stands for its stroke."""

    colour: str
    name: str
    mark: str = "—"


def rows_of(widths: Sequence[float], apart: float, room: float, most: int) -> list[list[int]]:
    """What stands on each line, by number: one beside the other as far as there is room; as many on each line as it
    takes where that would be more than so many lines."""
    rows = _filled(widths, apart, room)
    if len(rows) <= most:
        return rows
    each = -(-len(widths) // most)
    return [list(range(i, min(i + each, len(widths)))) for i in range(0, len(widths), each)]


def _filled(widths: Sequence[float], apart: float, room: float) -> list[list[int]]:
    rows: list[list[int]] = []
    used = 0.0
    for i, width in enumerate(widths):
        if rows and used + apart + width <= room:
            rows[-1].append(i)
            used += apart + width
        else:
            rows.append([i])
            used = width
    return rows


def cut(text: str, room: float, advance: Callable[[str], float]) -> str:
    """A text, its end left out where it is wider than the room."""
    if advance(text) <= room:
        return text
    kept = next((n for n in range(len(text) - 1, 0, -1) if advance(text[:n].rstrip() + CUT) <= room), 1)
    return text[:kept].rstrip() + CUT


class Legend(QGraphicsTextItem):
    """The entries laid out in the room they are given; nothing is done where neither changes."""

    def __init__(self, parent: QGraphicsWidget, ink: str, centred: bool = False) -> None:
        super().__init__(parent)
        self._entries: tuple[Entry, ...] = ()
        self._note, self._centred = "", centred
        self._laid: tuple[object, ...] = ()
        self.setDefaultTextColor(QColor(ink))
        self.height = 0.0
        self.letter()

    def letter(self) -> None:
        """Be written in the letters of now; to be fitted then."""
        self.setFont(font(SMALL))
        self._metrics = QFontMetricsF(self.font())
        self.setPlainText(APART)
        self._line = self.boundingRect().height()
        self.setPlainText("")
        self._laid = ()

    @property
    def text(self) -> str:
        """The legend as plain text."""
        return self.toPlainText()

    def set_entries(self, entries: Sequence[Entry], note: str = "") -> None:
        """note: behind the last name, where one line has room for all."""
        self._entries, self._note = tuple(entries), note

    def fit(self, room: QRectF) -> None:
        """Stand at the top of this room, no wider, and no higher if more than two lines; ``height`` is what that
        takes. A name that has no room is cut."""
        most = max(LEAST_LINES, 1 + int((room.height() - sized(LEGEND_HEIGHT)) / self._metrics.lineSpacing()))
        wanted = (self._entries, self._note, room.width(), most)
        if wanted != self._laid:
            self._laid = wanted
            self._write(room.width() - 2.0 * self.document().documentMargin(), most)
        box = self.boundingRect()
        if self._centred:
            box.moveCenter(QRectF(room.left(), room.top(), room.width(), self.height).center())
            self.setPos(box.topLeft())
        else:
            self.setPos(room.topLeft())

    def _write(self, room: float, most: int) -> None:
        advance = self._metrics.horizontalAdvance
        widths, apart = [advance(f"{e.mark} {e.name}") for e in self._entries], advance(APART)
        rows = rows_of(widths, apart, room, most)
        shares = [self._share([widths[i] for i in row], room - apart * (len(row) - 1)) for row in rows]
        parts = [[self._html(self._entries[i], share) for i in row] for row, share in zip(rows, shares, strict=True)]
        if self._note and sum(widths) + apart * len(widths) + advance(self._note) <= room:
            parts = [[*(part for row in parts for part in row), escape(self._note)]]
        self.setHtml("<br>".join(APART.join(row) for row in parts))
        more = self.boundingRect().height() - self._line
        self.height = sized(LEGEND_HEIGHT) + max(more, 0.0) if rows else 0.0

    @staticmethod
    def _share(widths: Sequence[float], room: float) -> float:
        """How wide an entry on a line may be: as it is where all have room."""
        return room if sum(widths) <= room else room / len(widths)

    def _html(self, entry: Entry, room: float) -> str:
        advance = self._metrics.horizontalAdvance
        name = cut(entry.name, room - advance(f"{entry.mark} "), advance)
        return f'<span style="color:{entry.colour};font-weight:bold">{entry.mark}</span> {escape(name)}'


__all__ = ["LEGEND_HEIGHT", "Entry", "Legend", "cut", "rows_of"]
