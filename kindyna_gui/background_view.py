"""A view whose answer takes its time: it is found beside the window, and only while the view can be seen."""

from __future__ import annotations

from PySide6.QtGui import QHideEvent

from core.errors import KindynaError
from kindyna_gui.background import Background
from kindyna_gui.documents.session import Session
from kindyna_gui.player import Player
from kindyna_gui.view import View


class BackgroundView(View):
    """``refresh`` starts the jobs. Another design, a reason for nothing, or a view that is hidden ends what is being computed."""

    def __init__(self, session: Session, player: Player, poll_ms: int | None = None) -> None:
        super().__init__(session, player)
        self._work = Background(self) if poll_ms is None else Background(self, poll_ms)

    def _rest(self) -> None:
        """Nothing is being computed any longer."""
        self._work.stop()

    def invalidate(self) -> None:
        self._rest()
        super().invalidate()

    def show_reason(self, error: KindynaError) -> None:
        self._rest()
        super().show_reason(error)

    @property
    def busy(self) -> bool:
        return self._pause.isActive() or self._work.busy

    def settle(self) -> None:
        super().settle()
        if self._pause.isActive():
            self._pause.stop()
            self.pull()

    def leave(self) -> None:
        self._work.close()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        if self._work.busy:
            self._rest()
            self._stale = True


__all__ = ["BackgroundView"]
