"""Views whose plots mark extremes, which are computed in the background once editing pauses."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, QPoint, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QHideEvent, QKeyEvent

from core.errors import KindynaError
from core.motion.extremes import Extremes
from core.study import Quantity, Study
from kindyna_gui.background import Background
from kindyna_gui.documents.pins import Bands, Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.live_plot import LivePlot, PeakDrag
from kindyna_gui.pictures.plots.curves import TurnCurves
from kindyna_gui.pictures.plots.quantities import channel_extremes
from kindyna_gui.player import Player, obey
from kindyna_gui.view import AFTER_DRAG_MS, View

if TYPE_CHECKING:
    from kindyna_gui.graph.live_polar import LivePolar

PAUSE_MS = 250  # without a change, before extremes are computed
NAME = "mark extremes"


def marks_action(session: Session) -> QAction:
    """Return the action that switches the marks of extremes in all plots of a window."""
    action = session.findChild(QAction, NAME)
    if not isinstance(action, QAction):
        action = QAction("Mark extremes", session, checkable=True, checked=True)
        action.setObjectName(NAME)
        action.setStatusTip("Mark the highest and the lowest value of every curve")
    return action


class ExtremesSearch(QObject):
    """Extremes of the channels of one view, of the design requested last.

    Signal ``finished`` (mapping): quantity -> Extremes.
    """

    finished = Signal(object)

    def __init__(self, parent: QObject, session: Session) -> None:
        super().__init__(parent)
        self._session = session
        self._request: tuple[Study, tuple[Quantity, ...]] | None = None
        self._done = False
        self._background = Background(self)
        self._background.result.connect(self._receive)
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self._begin)
        session.drag_ended.connect(self._drag_ended)

    @property
    def busy(self) -> bool:
        """Whether extremes are being computed, or about to be."""
        return self._pause.isActive() or self._background.busy

    def request(self, study: Study, rows: Sequence[Quantity]) -> None:
        """Compute the extremes of these channels once editing pauses, in place of those requested before."""
        self._background.stop()
        self._request, self._done = (study, tuple(rows)), not rows
        self._pause.start(PAUSE_MS) if rows else self._pause.stop()

    def resume(self) -> None:
        """Continue a computation that was stopped."""
        if self._request is not None and not self._done and not self.busy:
            self._pause.start(PAUSE_MS)

    def settle(self) -> None:
        """Start now what waits for a pause."""
        if self._pause.isActive():
            self._pause.stop()
            self._begin()

    def stop(self) -> None:
        """Stop the computation."""
        self._pause.stop()
        self._background.stop()

    def close(self) -> None:
        """Stop for good."""
        self.stop()
        self._background.close()

    def _drag_ended(self) -> None:
        if self._pause.isActive():
            self._pause.start(AFTER_DRAG_MS)

    def _begin(self) -> None:
        if self._session.drag_source is not None:  # the mouse still changes the design
            self._pause.start(PAUSE_MS)
        elif self._request is not None:
            self._background.start([(self._request[0], partial(channel_extremes, *self._request))])

    def _receive(self, study: Study, result: Mapping[str, Extremes] | KindynaError) -> None:
        if self._request is not None and study is self._request[0] and not isinstance(result, Exception):
            self._done = True
            self.finished.emit(result)


class MarkedView(View):
    """A view whose plots mark extremes.

    Subclasses implement ``lacking``, ``show_extremes`` and ``turn_plots``, and call ``request_extremes`` after drawing the
    curves.
    """

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.extremes = ExtremesSearch(self, session)
        self.extremes.finished.connect(self.show_extremes)
        self.marks = marks_action(session)
        self.marks.toggled.connect(self._switch_marks)
        self.bands = Bands.of(session)
        self.pins = Pins.of(session)
        for others in (self.bands, self.pins):
            others.changed.connect(self.invalidate)
        self.pin_note = ""  # why the pinned variant lacks the curves that were drawn last

    def companions(self, rows: Sequence[Quantity]) -> dict[str, Any]:
        """Return what a plot draws next to these quantities: the bands of machines, and the pinned variant."""
        reference, self.pin_note = self.pins.reference(rows)
        name = "" if self.pins.front is None else self.pins.front.name
        return {"bands": self.bands.read(rows), "reference": reference, "reference_name": name}

    def turn_plots(self) -> Sequence[TurnCurves]:
        """Return the plots over one turn, whose cursor has values."""
        return ()

    def show_outdated(self) -> None:
        self.extremes.stop()
        self.show_extremes(None)
        for plot in self.turn_plots():
            plot.show_cursor(False)

    def pull(self) -> None:
        for plot in self.turn_plots() if self._stale else ():
            plot.show_cursor(True)
        super().pull()

    def _turn(self, theta: float) -> None:
        """Stop playing, and set the cam angle [rad]."""
        self.player.play(False)
        self.player.set_theta(theta)

    def lacking(self, study: Study) -> Sequence[Quantity]:
        """Return the channels whose extremes are not marked yet."""
        raise NotImplementedError

    def show_extremes(self, extremes: Mapping[str, Extremes] | None) -> None:
        """Mark the extremes, by quantity; None removes the marks."""
        raise NotImplementedError

    def request_extremes(self, study: Study) -> None:
        """Compute the extremes that are not marked yet once editing pauses, unless marks are switched off."""
        self.extremes.request(study, self.lacking(study) if self.marks.isChecked() else ())

    def _switch_marks(self, on: bool) -> None:
        if self.up_to_date and not self.in_trouble:
            self.show_extremes(None)
            self.request_extremes(self.session.study)
            self.extremes.settle()

    @property
    def busy(self) -> bool:
        return self.on_screen() and self.extremes.busy

    def settle(self) -> None:
        self.extremes.settle()

    def leave(self) -> None:
        self.extremes.close()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self.extremes.stop()


class PlotsView(MarkedView):
    """A view whose plots over one turn set the cam angle and open menus; the keys control the player."""

    def offer_actions(
        self,
        plot: LivePlot | LivePolar,
        rows: Callable[[], Sequence[Quantity]],
        exports: Sequence[tuple[str, Callable[[], object]]] = (),
    ) -> None:
        """Connect a plot of these quantities: its angle, the drag of its peaks, the click on a limit, its context menu.

        exports: text and function of the entries of the menu before the marks.
        """

        def open_at(at: QPoint) -> None:
            from core.find import traded_field
            from kindyna_gui.touch_targets import MouseTarget, open_menu

            if self._host is None:
                return
            shown, target = [] if self.in_trouble else rows(), None
            if shown:
                path = traded_field(self.session.design, shown[0].name)
                target = MouseTarget(shown[0].label, path, value=next(iter(plot.readings()), ""))
            area = plot.viewport() if isinstance(plot, LivePlot) else plot
            open_menu(target, self, self._host, area.mapToGlobal(at), plot)

        for text, slot in exports:
            action = QAction(text, plot)
            action.triggered.connect(slot)
            plot.addAction(action)
        plot.addAction(self.marks)
        if isinstance(plot, LivePlot):
            plot.peaks = PeakDrag(self, self.player)
            plot.limit_chosen.connect(self._open_field)
            plot.addAction(plot.full_range_action)
        plot.angle_moved.connect(self._turn)
        plot.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        plot.customContextMenuRequested.connect(open_at)

    def _open_field(self, path: str) -> None:
        if self._host is not None:
            self._host.focus_field(path)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not obey(self.player, event):
            super().keyPressEvent(event)
