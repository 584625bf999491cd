"""Refined extremes of what plots show: looked for beside the window once editing pauses, and marked unless that is switched off."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from PySide6.QtCore import QObject, QPoint, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QHideEvent

from core.errors import KindynaError
from core.motion.extremes import Extremes
from core.study import Quantity, Study
from kindyna_gui.background import Background
from kindyna_gui.documents.pins import Bands
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.live_plot import LivePlot, LivePolar, PeakDrag
from kindyna_gui.pictures.plots.quantities import channel_extremes
from kindyna_gui.player import Player
from kindyna_gui.view import View

# -- extremes search -------------------------------------------------------------------------------------

PAUSE_MS = 250  # of editing
NAME = "mark extremes"


def marks_action(session: Session) -> QAction:
    """Whether the plots of a window mark extremes: one switch for all of them."""
    action = session.findChild(QAction, NAME)
    if not isinstance(action, QAction):
        action = QAction("Mark extremes", session, checkable=True, checked=True)
        action.setObjectName(NAME)
        action.setStatusTip("Mark the highest and the lowest value of each curve")
    return action


class ExtremesSearch(QObject):
    """The extremes of the channels that one view shows, of the last design that was wanted.

    found   quantity -> its extremes
    """

    found = Signal(object)

    def __init__(self, parent: QObject, session: Session) -> None:
        super().__init__(parent)
        self._session = session
        self._wanted: tuple[Study, tuple[Quantity, ...]] | None = None
        self._done = False
        self._background = Background(self)
        self._background.result.connect(self._answered)
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self._begin)

    @property
    def busy(self) -> bool:
        return self._pause.isActive() or self._background.busy

    def want(self, study: Study, rows: Sequence[Quantity]) -> None:
        """Look for the extremes of these channels once editing pauses; those wanted before are given up."""
        self._background.stop()
        self._wanted, self._done = (study, tuple(rows)), not rows
        self._pause.start() if rows else self._pause.stop()

    def resume(self) -> None:
        """Go on where it was given up."""
        if self._wanted is not None and not self._done and not self.busy:
            self._pause.start()

    def settle(self) -> None:
        """Do now what waits for a pause."""
        if self._pause.isActive():
            self._pause.stop()
            self._begin()

    def stop(self) -> None:
        """Give up what is not found yet."""
        self._pause.stop()
        self._background.stop()

    def close(self) -> None:
        """Give it up, and be sure that nothing is computed any longer."""
        self.stop()
        self._background.close()

    def _begin(self) -> None:
        if self._session.drag_source is not None:  # the mouse draws on: the design at hand is soon another
            self._pause.start()
        elif self._wanted is not None:
            self._background.start([(self._wanted[0], partial(channel_extremes, *self._wanted))])

    def _answered(self, study: Study, made: Mapping[str, Extremes] | KindynaError) -> None:
        if self._wanted is not None and study is self._wanted[0] and not isinstance(made, Exception):
            self._done = True
            self.found.emit(made)


# -- marked view -----------------------------------------------------------------------------------------


class MarkedView(View):
    """A view whose plots mark extremes; subclasses say which are lacking and show them, and call ``look_for_extremes`` once the
    curves of a study are drawn."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.extremes = ExtremesSearch(self, session)
        self.extremes.found.connect(self.show_extremes)
        self.marks = marks_action(session)
        self.marks.toggled.connect(self._switch_marks)
        self.bands = Bands.of(session)
        self.bands.changed.connect(self.invalidate)

    def offer_deeds(self, plot: LivePlot | LivePolar, rows: Callable[[], Sequence[Quantity]]) -> None:
        """The context menu of a plot: what can be done with the first of its quantities, and its own entries. Its peaks are drawn, and a
        click on a limit opens its field."""

        def ask(at: QPoint) -> None:
            from core.find import traded_field
            from kindyna_gui.touch_targets import MouseTarget, open_menu

            if self._host is None:
                return
            there, thing = [] if self.in_trouble else rows(), None
            if there:
                path = traded_field(self.session.design, there[0].name)
                thing = MouseTarget(there[0].label, path, value=next(iter(plot.readings()), ""))
            area = plot.viewport() if isinstance(plot, LivePlot) else plot
            open_menu(thing, self, self._host, area.mapToGlobal(at), plot)

        if isinstance(plot, LivePlot):
            plot.peaks = PeakDrag(self, self.player)
            plot.limit_chosen.connect(self._open_field)
        plot.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        plot.customContextMenuRequested.connect(ask)

    def _open_field(self, path: str) -> None:
        if self._host is not None:
            self._host.focus_field(path)

    def lacking(self, study: Study) -> Sequence[Quantity]:
        """The channels whose extremes are to be found."""
        raise NotImplementedError

    def show_extremes(self, found: Mapping[str, Extremes] | None) -> None:
        """Mark these, by quantity; None: mark none."""
        raise NotImplementedError

    def look_for_extremes(self, study: Study) -> None:
        """Find what is lacking once editing pauses, unless marks are switched off."""
        self.extremes.want(study, self.lacking(study) if self.marks.isChecked() else ())

    def _switch_marks(self, on: bool) -> None:
        if self.up_to_date and not self.in_trouble:
            self.show_extremes(None)
            self.look_for_extremes(self.session.study)
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
