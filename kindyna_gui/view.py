"""What every view shares: it pulls from the session when, and only when, it is on the screen."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QLabel, QStackedLayout, QVBoxLayout, QWidget

from core.errors import KindynaError
from core.study import Study
from kindyna_gui.player import Player
from kindyna_gui.session import Session


class View(QWidget):
    """A widget over the session's study.

    Subclasses state ``stages``, the stages they read, and implement ``refresh`` (the design changed) and
    ``follow`` (the cam angle changed). Neither is called while the view is hidden or tabbed behind another: it then
    only remembers that it is out of date. Where a stage has no answer the view says why in place of its content.
    """

    stages: tuple[str, ...] = ()

    def __init__(self, session: Session, player: Player, content: QWidget | None = None) -> None:
        super().__init__()
        self.session, self.player = session, player
        self._stale = True
        self._content = content if content is not None else QWidget()
        self._trouble = QLabel(alignment=Qt.AlignmentFlag.AlignCenter, wordWrap=True)
        self._trouble.setMargin(24)
        self._trouble.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        layout = QStackedLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._content)
        layout.addWidget(self._trouble)
        session.design_changed.connect(self.invalidate)
        player.angle_changed.connect(self._angle_changed)

    @property
    def content(self) -> QWidget:
        return self._content

    def set_content_layout(self, layout: QVBoxLayout) -> None:
        self._content.setLayout(layout)

    # -- for subclasses -----------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        """Show this study."""

    def follow(self, theta: float) -> None:
        """Show this cam angle [rad]."""

    # -- when ---------------------------------------------------------------------------------------------

    def on_screen(self) -> bool:
        """True where something of the view can be seen; a dock tabbed behind another answers isVisible() all the
        same, but its visible region is empty."""
        return self.isVisible() and not self.visibleRegion().isEmpty()

    def invalidate(self) -> None:
        """The design changed: refresh now if on screen, else when shown."""
        self._stale = True
        if self.on_screen():
            self.pull()

    def pull(self) -> None:
        """Refresh if out of date."""
        if not self._stale:
            return
        self._stale = False
        layout = self.layout()
        assert isinstance(layout, QStackedLayout)
        try:
            self.refresh(self.session.study)
            layout.setCurrentWidget(self._content)
            self.follow(self.player.theta)
        except KindynaError as error:
            self._trouble.setText(str(error))
            layout.setCurrentWidget(self._trouble)

    def _angle_changed(self, theta: float) -> None:
        if self.on_screen() and not self._stale:
            self.follow(theta)

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        QTimer.singleShot(0, self._pull_if_seen)

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)

    def event(self, event: QEvent) -> bool:
        # a dock coming to the front of its tabs gets no showEvent, but it is painted
        if event.type() == QEvent.Type.Paint and self._stale:
            QTimer.singleShot(0, self._pull_if_seen)
        return super().event(event)

    def _pull_if_seen(self) -> None:
        if self.on_screen():
            self.pull()
            self.follow_if_fresh()

    def follow_if_fresh(self) -> None:
        """Catch up with the cam angle after having been hidden."""
        if not self._stale:
            self.follow(self.player.theta)


__all__ = ["QObject", "View"]
