"""Chart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from PySide6.QtCore import QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QHideEvent, QPalette, QShowEvent
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QProgressBar, QPushButton, QSplitter, QVBoxLayout, QWidget

from core.design import with_elastic
from core.errors import KindynaError
from core.stability import EDGE_ERROR, EXACT, Chart, Stability, Verdict, chart
from core.study import Study
from kindyna_gui.background import Background, Job
from kindyna_gui.documents.session import Session
from kindyna_gui.look import coloured
from kindyna_gui.pictures.plots.stability_chart import ACROSS, UPWARDS, ChartPlot
from kindyna_gui.pictures.plots.xy import DraggablePoint
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_SHAFT, RIGID_SHAFT, Unavailable, turned_shaft
from kindyna_gui.stability_pages import (
    ChartPoint,
    PointFields,
    StabilityPages,
    machine_text,
    point_text,
    steady_turns,
    tongue_of,
    waiting_text,
    wanted_text,
)
from kindyna_gui.view import View

# -- chart -----------------------------------------------------------------------------------------------


class StabilityChart(DraggablePoint, ChartPlot):
    """The chart with its reactions; all points are (η, Q)."""

    def point_at(self, pixel: QPointF) -> tuple[float, float] | None:
        return ChartPlot.point_at(self, pixel)

    def own_pixel(self) -> QPointF | None:
        machine = self.chart.machine if self.chart is not None else None
        return None if machine is None or not self.machine_point.isVisible() else self.pixel(machine.eta, machine.q)


# -- point reading ---------------------------------------------------------------------------------------

EDGE_TOLERANCE = 1e-6  # of η: a tongue's edge may be off by that
EDGE, MARGIN = 6, 4  # between the text and the axes, and around it, pixels
REST_MS = 220  # the mouse rests, before what takes long is begun


class PointReading(QLabel):
    """Three lines: the place, its tongue and the linear models; the steady response; the history from rest.

    The latter two take a second and more: they are computed beside the window, and given up where the mouse moves on.
    It stands over the chart, in that half where the mouse is not, and lets the mouse through.

    changed   something that was still to come has come, or is given up
    """

    changed = Signal()

    def __init__(self, chart: StabilityChart) -> None:
        super().__init__(chart)
        self._chart = chart
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setWordWrap(True)
        self.setMargin(MARGIN)
        self.setBackgroundRole(QPalette.ColorRole.Base)
        self.setAutoFillBackground(True)
        self.hide()
        coloured(self, SCREEN.quiet)
        self.background = Background(self)
        self.background.result.connect(self._answered)
        self._pause = QTimer(self, singleShot=True, interval=REST_MS)
        self._pause.timeout.connect(self._ask)
        self._found: Stability | None = None
        self.point: tuple[float, float] | None = None
        self.verdicts: tuple[Verdict, ...] = ()
        self._tongue: int | None = None

    @property
    def busy(self) -> bool:
        return self._pause.isActive() or self.background.busy

    def stop(self) -> None:
        """Give up what is being computed; what is shown stays."""
        self._pause.stop()
        self.background.stop()
        self.changed.emit()

    def show_text(self, text: str) -> None:
        """Something else than a point."""
        self.stop()
        self.point, self.verdicts = None, ()
        self._write(text)

    def _write(self, text: str) -> None:
        self.setText(text)
        self.setVisible(bool(text))
        if text:
            self._place(max(self.fontMetrics().horizontalAdvance(line) for line in text.splitlines()))

    def _place(self, width: int) -> None:
        """Below the upper edge of the chart, or above the lower one, away from the mouse."""
        box = self._chart.getViewBox().sceneBoundingRect().toRect()
        self.resize(min(width + 2 * MARGIN + 2, box.width() - 2 * EDGE), 1)
        self.resize(self.width(), self.heightForWidth(self.width()))
        low = self._chart.mouse_at.y() < box.center().y()
        self.move(box.left() + EDGE, box.bottom() - EDGE - self.height() if low else box.top() + EDGE)

    def show_point(self, found: Stability, point: tuple[float, float]) -> None:
        """Tell of a point (η, Q)."""
        self.stop()
        self._found, self.point = found, point
        eta, q = point
        self.verdicts = found.linear_at(eta, q)
        self._tongue = tongue_of(found.tongues(EXACT, max(eta + 0.5, 1.0), q, EDGE_TOLERANCE), eta)
        self._pause.start()
        self._show()

    def _ask(self) -> None:
        assert self._found is not None
        assert self.point is not None
        eta, q = self.point
        self.background.start(
            [
                (self.point, partial(self._found.rest_at, eta, q)),
                (self.point, partial(self._found.steady_at, eta, q)),
            ]
        )
        self._show()
        self.changed.emit()

    def _answered(self, point: tuple[float, float], verdict: Any) -> None:
        if point == self.point and isinstance(verdict, Verdict):
            self.verdicts = (*self.verdicts, verdict)
        self._show()
        self.changed.emit()

    def _show(self) -> None:
        assert self._found is not None
        if self.point is not None:
            first = point_text(*self.point, self._found.machine, self.verdicts, self._tongue)
            self._write(f"{first}\n{waiting_text(self.verdicts, self.busy)}")


# -- stability view --------------------------------------------------------------------------------------

COARSE, FINE = 10, 64  # rows of Q: first, and once there is time
CHART_TOLERANCE = 1e-3  # of η: an edge off by less is not seen in the coarse chart
SHARES = (9, 4)  # of the height: chart, pages
PAUSE_MS = 150  # of editing, before what takes long is begun
SOON_MS = 15  # after an edit: all that is on screen is painted first
ANEW = "The chart is being computed anew …"


class StabilityView(View):
    """The page of stability.

    The first coarse chart is drawn at once; the fine one, the verdicts and the history of the chosen point are
    computed beside the window and given up where the design changes or the page leaves the screen. No edit waits for a
    chart: the one before stays, marked, until the new one is computed beside the window.

    found   the shaft that the page is of; None while another is being computed
    drawn   the chart that is shown; None before the first
    """

    is_design_wide = True
    stages = ("stability",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.found: Stability | None = None
        self.drawn: Chart | None = None
        self.chosen: ChartPoint | None = None
        self.picked: tuple[float, float] | None = None  # None: the machine's own point is chosen
        self.wanted: tuple[float, float] | None = None  # where the machine's point has been drawn to
        self.chart, self.pages = StabilityChart(), StabilityPages()
        self.fields = PointFields()
        self.reading = PointReading(self.chart)
        self.chart.setMinimumHeight(180)
        self.anew, self.fine, self.point_jobs, self.means = Background(), Background(), Background(), Background()
        self._soon_anew = QTimer(self, singleShot=True, interval=SOON_MS)
        self._soon_anew.timeout.connect(self._compute_anew)
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self._begin)
        self._lay_out()
        self._connect()

    # -- building -------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        self.head = QLabel()
        self.head.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.head.setMinimumWidth(1)
        self.progress = QProgressBar(textVisible=False, minimum=0, maximum=0)
        self.progress.setAccessibleName("Computing")
        self.progress.setFixedSize(70, 8)
        self.progress.hide()
        self.across, self.upwards = self._choice(ACROSS), self._choice(UPWARDS)
        self.use = QPushButton("Use this shaft")
        self.use.setToolTip("Put the stiffness and inertia that this point needs into the design, as one step")
        self.use.hide()
        tools = QHBoxLayout()
        tools.setContentsMargins(8, 2, 8, 0)
        tools.addWidget(self.fields)
        tools.addSpacing(8)
        tools.addWidget(self.head, 1)
        tools.addSpacing(8)
        tools.addWidget(self.progress)
        tools.addWidget(self.use)
        for text, box in (("across", self.across), ("upwards", self.upwards)):
            name = QLabel(text)
            coloured(name, SCREEN.quiet)
            tools.addWidget(name)
            tools.addWidget(box)
        upper = QWidget()
        column = QVBoxLayout(upper)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(2)
        column.addLayout(tools)
        column.addWidget(self.chart, 1)
        parted = QSplitter(Qt.Orientation.Vertical, childrenCollapsible=False)
        parted.addWidget(upper)
        parted.addWidget(self.pages)
        for index, share in enumerate(SHARES):
            parted.setStretchFactor(index, share)
        parted.setSizes([1000 * share for share in SHARES])
        layout = QVBoxLayout()
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(parted)
        self.set_content_layout(layout)

    @staticmethod
    def _choice(rows: Any) -> QComboBox:
        box = QComboBox()
        for name, row in rows.items():
            box.addItem(row.label, name)
        box.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        return box

    def _connect(self) -> None:
        self.chart.hovered.connect(self._hover)
        self.chart.picked.connect(self._pick)
        self.fields.entered.connect(self.look_at)
        self.fields.returned.connect(self.look_at_own)
        self.chart.dragged.connect(self._pulled)
        self.chart.released.connect(self._released)
        self.reading.changed.connect(self._rest)
        self.pages.lacking.connect(self._lacks)
        self.anew.result.connect(self._computed_anew)
        self.fine.result.connect(self._refined)
        self.point_jobs.result.connect(self._known)
        self.means.result.connect(self._known)
        self.across.currentIndexChanged.connect(self._draw_chart)
        self.upwards.currentIndexChanged.connect(self._draw_chart)
        self.use.clicked.connect(self.use_wanted)
        self.session.started.connect(self._another_design)

    # -- showing --------------------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        self._stop()
        self.wanted = self.found = None
        self.use.hide()
        try:
            if turned_shaft(self.session.full_study, NO_SHAFT).elastic is None:
                raise Unavailable(RIGID_SHAFT)
            if self.drawn is None:
                self._show(*self._computed(self.session.full_study))
                return
        except KindynaError:
            self.drawn = None
            raise
        self._mark(ANEW)
        self._soon_anew.start()

    def _computed(self, study: Study) -> tuple[Stability, Chart, str]:
        """What the page shows first, with the text of its head. Raises NoStability, NoSolution."""
        found = study.flexible_shaft()
        drawn = self._chart(found, study.design.name, COARSE, CHART_TOLERANCE, coarse=True)()
        return found, drawn, machine_text(found)

    def _show(self, found: Stability, drawn: Chart, text: str) -> None:
        self.found, self.drawn = found, drawn
        self._mark("")
        self.head.setText(text)
        self.chosen = self._unknown(found)
        self._draw_chart()
        self._pause.start()
        self._show_fields(found, self.chosen)
        self.pages.show_shaft(found, self.chosen)

    def _mark(self, text: str) -> None:
        """Where there is a text, what is shown is of the design before: it stands back, and nothing can be read off it."""
        if text:
            self.head.setText(text)
            self.reading.show_text("")
        self.chart.fade(bool(text))
        self.pages.fade(bool(text))
        self._rest()

    def _compute_anew(self) -> None:
        """Begin what an edit has made necessary, beside the window."""
        if self.on_screen():
            study = self.session.full_study
            self.anew.start([(study, partial(self._computed, study))])
            self._rest()

    def _computed_anew(self, study: Study, made: tuple[Stability, Chart, str] | KindynaError) -> None:
        if study is self.session.full_study:
            if isinstance(made, KindynaError):
                self.drawn = None
                self.show_reason(made)
            else:
                self._show(*made)
        self._rest()

    @staticmethod
    def _chart(found: Stability, name: str, rows: int, error: float, coarse: bool = False) -> Callable[[], Chart]:
        m = found.machine
        return partial(
            chart,
            found.coefficients,
            m,
            name,
            rows=rows,
            damping=m.damping,
            eta_max=found.eta_max,
            error=error,
            coarse=coarse,
        )

    def _another_design(self) -> None:
        self.picked = self.drawn = None

    def _unknown(self, found: Stability) -> ChartPoint:
        """The chosen point, of which nothing is known yet: one that was picked, or the machine's own."""
        return ChartPoint(*(self.picked or (found.machine.eta, found.machine.q)), own=self.picked is None)

    def _draw_chart(self, *_: object) -> None:
        if self.drawn is None:
            return
        self.chart.show_chart(self.drawn, self.across.currentData(), self.upwards.currentData())
        self.chart.ring_point(*(self.picked or (None,)))

    # -- what takes longer ----------------------------------------------------------------------------------

    @property
    def busy(self) -> bool:
        """Something that is shown is still to come."""
        return self._pause.isActive() or self._soon_anew.isActive() or self._computing or self.reading.busy

    @property
    def _computing(self) -> bool:
        return any(each.busy for each in self._background)

    @property
    def _background(self) -> tuple[Background, ...]:
        return self.anew, self.fine, self.point_jobs, self.means, self.reading.background

    def _stop(self) -> None:
        self._pause.stop()
        self._soon_anew.stop()
        for each in (self.anew, self.fine, self.point_jobs, self.means, self.reading):  # which stops its own
            each.stop()
        self._rest()

    def leave(self) -> None:
        self._stop()
        for each in self._background:
            each.close()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        if not event.spontaneous():  # else the whole window is put away for a while
            self._stop()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if not self.up_to_date or self.in_trouble:
            return
        if self.found is None:
            self._soon_anew.start()
        elif self._lacking:
            self._pause.start()

    @property
    def _lacking(self) -> bool:
        """Something that is shown has been given up, or never requested."""
        if self.found is None or self.chosen is None or self.drawn is None:
            return False
        whole = self.drawn.q.size >= FINE and not self.pages.lacks
        return not whole or bool(self._jobs(self.found, self.chosen))

    def settle(self) -> None:
        """Do now what waits for a pause."""
        for timer, begin in ((self._soon_anew, self._compute_anew), (self._pause, self._begin)):
            if timer.isActive():
                timer.stop()
                begin()

    def _begin(self) -> None:
        """Ask for what takes longer: the fine chart once, then all about the point."""
        if self.found is None or self.drawn is None or not self.on_screen():
            return
        if self.drawn.q.size < FINE:
            self.fine.start([("chart", self._chart(self.found, self.drawn.name, FINE, EDGE_ERROR))])
        self._ask_for_point(self.found)
        self.pages.redraw()

    def _ask_for_point(self, found: Stability) -> None:
        assert self.chosen is not None
        self.point_jobs.start(self._jobs(found, self.chosen))
        self._rest()

    @staticmethod
    def _jobs(found: Stability, point: ChartPoint) -> list[Job]:
        """What is not known yet of the chosen point, and of the shaft."""
        eta, q = point.eta, point.q
        rows: list[tuple[bool, Job]] = [
            ("bands" in vars(found), ("bands", lambda: found.bands)),  # kept there once they are known
            (point.history is not None, ("history", partial(found.history, eta=eta, q=q))),
            (point.steady is not None, ("steady", partial(steady_turns, found, eta, q))),
            (bool(point.verdicts), ("verdicts", partial(found.verdicts, eta, q))),
        ]
        return [job for known, job in rows if not known]

    def _lacks(self, name: str) -> None:
        """A page in front waits for a cached property of the shaft."""
        if self.found is not None and not self.means.busy and not self._pause.isActive():
            self.means.start([(name, partial(getattr, self.found, name))])
            self._rest()

    def _refined(self, name: str, found: Chart | KindynaError) -> None:
        if isinstance(found, Chart):
            self.drawn = found
            self._draw_chart()
        self._rest()

    def _rest(self) -> None:
        self.progress.setVisible(self._computing or self._soon_anew.isActive())

    def _known(self, name: str, found: Any) -> None:
        """More is known of the chosen point, or of the shaft."""
        if (
            self.chosen is not None
            and not isinstance(found, KindynaError)
            and name in ("history", "steady", "verdicts")
        ):
            setattr(self.chosen, name, found)
        self.pages.redraw()
        self._rest()

    # -- a point --------------------------------------------------------------------------------------------

    def look_at(self, eta: float, q: float) -> None:
        """Pick a point of the chart: verdicts, history, phase plane, spectrum and contact force are of it."""
        self._choose((eta, q))

    def look_at_own(self) -> None:
        """Back to the machine's own point."""
        self._choose(None)

    def _pick(self, eta: float, q: float) -> None:
        """By the mouse: no pixel stands for more digits."""
        self.look_at(float(f"{eta:.5g}"), float(f"{q:.5g}"))

    def _choose(self, point: tuple[float, float] | None) -> None:
        self.picked = point
        self.chart.ring_point(*(point or (None,)))
        if self.found is not None:
            self.chosen = self._unknown(self.found)
            self._show_fields(self.found, self.chosen)
            self.pages.show_point(self.chosen)
            self._ask_for_point(self.found)

    def _show_fields(self, found: Stability, point: ChartPoint) -> None:
        self.fields.show_point(found.machine, point.eta, point.q, point.own)

    def _hover(self, point: tuple[float, float] | None) -> None:
        if self.found is None or self.wanted is not None:
            return
        if point is None:
            self.reading.show_text("")
        else:
            self.reading.show_point(self.found, point)

    def _pulled(self, eta: float, q: float) -> None:
        if self.found is None:
            return
        self.wanted = (eta, q)
        self.chart.move_machine_point(eta, q)
        self.reading.show_text(wanted_text(self.found.machine, eta, q))

    def _released(self, kept: bool) -> None:
        if not kept:
            self.wanted = None
            self.reading.show_text("")
            if self.found is not None:
                self._draw_chart()
        self.use.setVisible(self.wanted is not None)

    def use_wanted(self) -> None:
        """Put the shaft of the wanted point into the design."""
        if self.wanted is None or self.found is None:
            return
        elastic = self.session.full_design.shaft.elastic
        inertia, stiffness = self.found.machine.shaft_for(*self.wanted)
        made = replace(
            elastic,
            camshaft_inertia_kg_m2=float(f"{inertia:.6g}"),
            stiffness_nm_per_rad=float(f"{stiffness:.6g}"),
        )
        self.session.end_gesture()
        self.session.put_full_design(
            with_elastic(self.session.full_design, made),
            f"Move shaft to η = {self.wanted[0]:.4g}, Q = {self.wanted[1]:.4g}",
        )
        self.session.end_gesture()
