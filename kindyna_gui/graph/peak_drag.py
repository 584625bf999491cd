"""A peak of a curve drawn up and down with the mouse: the field that is traded for it follows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QKeyEvent

from core.design import entry_at, get, put, split_unit
from kindyna_gui.labels import no_number, sentence, value_text
from kindyna_gui.pictures.units import measure
from kindyna_gui.player import Player
from kindyna_gui.view import View

if TYPE_CHECKING:  # made when a peak is first taken
    from core.find import Trade
    from kindyna_gui.touched import BesideMouse

PULLED = ("pressure_angle",)  # beginnings of the quantities whose peaks are drawn
DECIMALS = 2  # of the field meanwhile


class PeakDrag:
    """What the mouse does with the peaks of a view's plots; one drag is one step.

    lines   what answers beside the mouse, each with whether a limit is passed
    """

    def __init__(self, view: View, player: Player) -> None:
        self._view, self._session, self._player = view, view.session, player
        self._trade: Trade | None = None
        self._work: object = None
        self._unit, self._typed = "", ""
        self._beside: BesideMouse | None = None
        self.lines: list[tuple[str, bool]] = []

    def can_take(self, name: str) -> bool:
        """Whether the peaks of a quantity can be drawn."""
        cam = self._session.design.drive.cam
        return name.startswith(PULLED) and hasattr(cam, "base_radius_mm") and not self._session.on_balancer

    def take(self, name: str, unit: str, highest: bool) -> bool:
        """Hold the highest or lowest value of a quantity in this unit; False where nothing is traded for it."""
        from core.find import trade

        self._trade = trade(self._session.design, name, highest) if self.can_take(name) else None
        if self._trade is None:
            return False
        self._player.play(False)
        self._session.take_hold(self._view)
        self._work, self._unit, self._typed = self._session.work, unit, ""
        self._answer()
        return True

    def drag(self, wanted: float) -> None:
        """The peak is drawn to this value."""
        if self._trade is not None and not self._typed:
            self._put(self._trade.field_value(wanted, self._present), wanted, DECIMALS)

    @property
    def _present(self) -> float:
        """The value of the field now: a drag goes on from there, where several values give a peak."""
        return float(get(self._session.design, self._trade.path)) if self._trade is not None else 0.0

    def _put(self, value: float | None, wanted: float, decimals: int) -> bool:
        held = self._trade
        assert held is not None
        entry = entry_at(self._session.design, held.path)
        assert entry is not None
        info = entry.info
        value = None if value is None else round(value, decimals)
        if value is None or not info.admits(value):
            self._answer(f"No {info.in_sentence} gives {measure(wanted, self._unit)}")
            return False
        done = self._session.put(put(self._session.design, held.path, value), f"Change {info.in_sentence}", held.path)
        self._answer("" if done else f"{info.label} {value_text(value, split_unit(held.path)[1])} is not possible")
        return done

    def _answer(self, why_not: str = "") -> None:
        from kindyna_gui.touched import answers

        assert self._trade is not None
        stages = tuple(self._session.stages_on_screen())
        self.lines = answers(self._session.study, self._trade.path, stages)
        self.lines += [(why_not, True)] if why_not else []

    def key(self, event: QKeyEvent) -> bool:
        """Escape takes the drag back; a number that is typed meanwhile is the peak that Return gives; False: the key is another's."""
        from kindyna_gui.touched import typed_on

        held = self._trade
        if held is None:
            return False
        if event.key() == Qt.Key.Key_Escape:
            self.drop(back=True)
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            from kindyna_gui.forms.typed_number import parsed

            wanted = parsed(self._typed, split_unit(held.key.partition(":")[0])[1]) if self._typed else None
            if wanted is None:
                self._answer(sentence(no_number(self._typed)))
            elif self._put(held.exact_field_value(wanted, self._present), wanted, 12):
                self.drop()
            self._typed = ""
        else:
            typed = typed_on(self._typed, event)
            if typed is None:
                return False
            self._typed = typed
        return True

    def drop(self, back: bool = False) -> None:
        """Let go; back: it goes back where it was."""
        held, self._trade = self._trade, None
        if held is not None:
            self._session.let_go(held.path, self._work if back else None)

    @property
    def active(self) -> bool:
        """Whether a peak is held."""
        return self._trade is not None

    def tell(self, on_screen: QPoint) -> None:
        """What answers, beside the mouse."""
        from kindyna_gui.touched import BesideMouse

        if self._beside is None:
            self._beside = BesideMouse(self._view)
        typed = [(f"{self._typed}_", False)] if self._typed else []
        self._beside.tell([*typed, *self.lines] if self.active else [], on_screen)


__all__ = ["PeakDrag"]
