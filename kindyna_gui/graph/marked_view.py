"""What the views with plots over the cam angle share: extremes that are found beside the window and marked."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QHideEvent

from core.motion.extremes import Extremes
from core.study import Quantity, Study
from kindyna_gui.documents.bands import Bands
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.extremes_search import ExtremesSearch, marks_action
from kindyna_gui.graph.live_plot import LivePlot, LivePolar
from kindyna_gui.graph.peak_drag import PeakDrag
from kindyna_gui.player import Player
from kindyna_gui.view import View


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
            from core.find import traded
            from kindyna_gui.touched import Thing, open_menu

            if self._host is None:
                return
            there, thing = [] if self.in_trouble else rows(), None
            if there:
                path = traded(self.session.design, there[0].name)
                thing = Thing(there[0].label, path, value=next(iter(plot.readings()), ""))
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
