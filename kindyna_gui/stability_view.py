"""View of the stability of the shaft: the chart over η and Q, the reading under the mouse, and the pages below.

Slow results are calculated in the background. They stop where the design changes or the view leaves the screen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QHideEvent, QPalette, QShowEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from core.design import with_elastic
from core.errors import KindynaError
from core.stability import EDGE_ERROR, EXACT, Chart, Stability, Verdict, chart, nearest_bands, speed_sentence
from core.study import Study
from kindyna_gui.background import Background, Job
from kindyna_gui.documents.session import Session
from kindyna_gui.look import answer_label, coloured, described
from kindyna_gui.pictures.plots.mouse import DraggablePoint
from kindyna_gui.pictures.plots.stability_chart import ACROSS, UPWARDS, ChartPlot
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import connect_all, fill, single_shot, widget_with
from kindyna_gui.requirements import NO_SHAFT, RIGID_SHAFT, Unavailable, turned_shaft
from kindyna_gui.settings import Settings
from kindyna_gui.stability_pages import (
    ChartPoint,
    PointFields,
    StabilityPages,
    machine_text,
    needed_shaft_text,
    point_text,
    speed_text,
    steady_turns,
    tongue_of,
    waiting_text,
)
from kindyna_gui.view import View

# -- chart -----------------------------------------------------------------------------------------------


class StabilityChart(DraggablePoint, ChartPlot):
    """The chart and its reactions to the mouse; all points are (η, Q)."""

    def point_at(self, pixel: QPointF) -> tuple[float, float] | None:
        return ChartPlot.point_at(self, pixel)

    def own_pixel(self) -> QPointF | None:
        machine = self.chart.machine if self.chart is not None and not self.is_plain else None
        return None if machine is None or not self.machine_point.isVisible() else self.pixel(machine.eta, machine.q)


# -- reading under the mouse -----------------------------------------------------------------------------

EDGE_TOLERANCE = 1e-6  # of η, for the edges of a tongue
EDGE, MARGIN = 6, 4  # between text and axes, and around the text, pixels
REST_MS = 220  # rest of the mouse before slow results are calculated


class PointReading(QLabel):
    """Reading of a point in three lines: position, tongue and linear models; steady response; history from rest.

    The steady response and the history take a second or more. They are calculated in the background, until the mouse
    moves. The text covers the half of the chart without the mouse, and ignores the mouse.

    - changed: a calculation has ended or was stopped
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
        self.background.result.connect(self._add_verdict)
        self._pause = single_shot(self, self._start, REST_MS)
        self._stability: Stability | None = None
        self.point: tuple[float, float] | None = None
        self.verdicts: tuple[Verdict, ...] = ()
        self._tongue: int | None = None

    @property
    def busy(self) -> bool:
        """Whether results are being calculated, or wait for the mouse to rest."""
        return self._pause.isActive() or self.background.busy

    def stop(self) -> None:
        """Stop the calculation; the text stays."""
        self._pause.stop()
        self.background.stop()
        self.changed.emit()

    def show_text(self, text: str) -> None:
        """Show a text in place of a point."""
        self.stop()
        self.point, self.verdicts = None, ()
        self._write(text)

    def _write(self, text: str) -> None:
        self.setText(text)
        self.setVisible(bool(text))
        if text:
            self._lay_out(max(self.fontMetrics().horizontalAdvance(line) for line in text.splitlines()))

    def _lay_out(self, width: int) -> None:
        """Place the text at the upper or lower edge of the chart, away from the mouse."""
        box = self._chart.getViewBox().sceneBoundingRect().toRect()
        self.resize(min(width + 2 * MARGIN + 2, box.width() - 2 * EDGE), 1)
        self.resize(self.width(), self.heightForWidth(self.width()))
        low = self._chart.mouse_at.y() < box.center().y()
        self.move(box.left() + EDGE, box.bottom() - EDGE - self.height() if low else box.top() + EDGE)

    def show_point(self, stability: Stability, point: tuple[float, float]) -> None:
        """Show the reading of a point (η, Q)."""
        self.stop()
        self._stability, self.point = stability, point
        eta, q = point
        self.verdicts = stability.linear_at(eta, q)
        if self._chart.is_plain:
            self._write(speed_text(eta, q, stability.machine, self.verdicts))
            return
        self._tongue = tongue_of(stability.tongues(EXACT, max(eta + 0.5, 1.0), q, EDGE_TOLERANCE), eta)
        self._pause.start()
        self._show()

    def _start(self) -> None:
        assert self._stability is not None
        assert self.point is not None
        eta, q = self.point
        self.background.start(
            [
                (self.point, partial(self._stability.rest_at, eta, q)),
                (self.point, partial(self._stability.steady_at, eta, q)),
            ]
        )
        self._show()
        self.changed.emit()

    def _add_verdict(self, point: tuple[float, float], verdict: Any) -> None:
        if point == self.point and isinstance(verdict, Verdict):
            self.verdicts = (*self.verdicts, verdict)
        self._show()
        self.changed.emit()

    def _show(self) -> None:
        assert self._stability is not None
        if self.point is not None:
            first = point_text(*self.point, self._stability.machine, self.verdicts, self._tongue)
            self._write(f"{first}\n{waiting_text(self.verdicts, self.busy)}")


# -- stability view --------------------------------------------------------------------------------------

COARSE, FINE = 10, 64  # rows of Q in the first chart, and in the fine one
CHART_TOLERANCE = 1e-3  # of η, for the edges in the coarse chart
SHARES = (9, 4)  # height of chart and pages
PAUSE_MS = 150  # pause in editing before slow results are calculated
SOON_MS = 15  # after an edit, so that the window is painted first
UPDATING = "Calculating the forbidden speeds …"
NEAREST = 5  # forbidden bands in the chart over the speed


class StabilityView(View):
    """Stability of the shaft: chart, fields of the selected point, and pages.

    The verdict on the machine's speed and a coarse chart are calculated in the background, then the fine chart, and verdicts
    and history of the selected point. After an edit the previous chart stays, greyed out, until the new one is known.

    - ``stability``: results of the shaft; None while they are calculated again
    - ``drawn``: the chart on screen; None before the first
    - ``target``: where the point of the machine was dragged to; None where it was not
    """

    is_design_wide = True
    stages = ("stability",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.stability: Stability | None = None
        self.drawn: Chart | None = None
        self.chosen: ChartPoint | None = None
        self.picked: tuple[float, float] | None = None  # selected point; None: that of the machine
        self.target: tuple[float, float] | None = None
        self.chart, self.pages = StabilityChart(), StabilityPages()
        self.fields = PointFields()
        self.reading = PointReading(self.chart)
        self.chart.setMinimumHeight(180)
        self.update_jobs, self.fine, self.point_jobs, self.shaft_jobs = (
            Background(),
            Background(),
            Background(),
            Background(),
        )
        self._soon_update = single_shot(self, self._start_update, SOON_MS)
        self._pause = single_shot(self, self._begin, PAUSE_MS)
        self._lay_out()
        self._connect()

    # -- layout ---------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        self.header = QLabel(textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse)
        self.header.setMinimumWidth(1)
        self.verdict = answer_label()
        self.as_paper = described(
            QCheckBox("As in the paper"),
            tip="Show frequency ratio η, inertia ratio Q, and the verdicts of all models, as in Kim 1990",
        )
        self.as_paper.setChecked(Settings().as_in_paper)
        self.progress = described(QProgressBar(textVisible=False, minimum=0, maximum=0), name="Computing")
        self.progress.setFixedSize(70, 8)
        self.progress.hide()
        self.across, self.upwards = self._choice(ACROSS), self._choice(UPWARDS)
        self.use = described(
            QPushButton("Use this shaft"),
            tip="Use the stiffness and inertia of this point in the design (one undo step)",
        )
        self.use.hide()
        answer = fill(
            QHBoxLayout(), (self.verdict, 1), 8, self.progress, self.use, 8, self.as_paper, margins=(0, 0, 8, 0)
        )
        row = fill(QHBoxLayout(), self.fields, 8, (self.header, 1), margins=(8, 2, 8, 0))
        for text, box in (("across", self.across), ("upwards", self.upwards)):
            name = coloured(QLabel(text), SCREEN.quiet)
            row.addWidget(name)
            row.addWidget(box)
        self.tools = widget_with(row)
        upper = widget_with(fill(QVBoxLayout(), answer, self.tools, (self.chart, 1), margins=0, spacing=2))
        splitter = QSplitter(Qt.Orientation.Vertical, childrenCollapsible=False)
        splitter.addWidget(upper)
        splitter.addWidget(self.pages)
        for index, share in enumerate(SHARES):
            splitter.setStretchFactor(index, share)
        splitter.setSizes([1000 * share for share in SHARES])
        self.set_column(splitter, grows=splitter)
        self.tools.setVisible(self.as_paper.isChecked())
        self.pages.show_as_in_paper(self.as_paper.isChecked())

    @staticmethod
    def _choice(rows: Any) -> QComboBox:
        box = QComboBox()
        for name, row in rows.items():
            box.addItem(row.label, name)
        box.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        return box

    def _connect(self) -> None:
        connect_all(
            (self.chart.hovered, self._hover),
            (self.chart.picked, self._pick),
            (self.fields.entered, self.look_at),
            (self.fields.returned, self.look_at_machine),
            (self.chart.dragged, self._pulled),
            (self.chart.released, self._released),
            (self.reading.changed, self._show_progress),
            (self.pages.result_requested, self._compute_for_page),
            (self.update_jobs.result, self._show_update),
            (self.fine.result, self._show_fine_chart),
            (self.point_jobs.result, self._store_result),
            (self.shaft_jobs.result, self._store_result),
            (self.across.currentIndexChanged, self._draw_chart),
            (self.upwards.currentIndexChanged, self._draw_chart),
            (self.use.clicked, self.use_target),
            (self.as_paper.toggled, self._switch),
            (self.session.started, self._forget_design),
        )

    def _switch(self, in_paper: bool) -> None:
        """Show the stability as in the paper, or as a designer reads it; the next start does the same."""
        Settings().as_in_paper = in_paper
        self.tools.setVisible(in_paper)
        self.pages.show_as_in_paper(in_paper)
        self.reading.show_text("")
        self.look_at_machine()
        self._draw_chart()

    # -- content --------------------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        self._stop()
        self.target = self.stability = None
        self.use.hide()
        try:
            if turned_shaft(self.session.full_study, NO_SHAFT).elastic is None:
                raise Unavailable(RIGID_SHAFT)
        except KindynaError:
            self.drawn = None
            raise
        self._mark(UPDATING)
        self._soon_update.start()

    def _computed(self, study: Study) -> tuple[Stability, Chart, str]:
        """Compute the shaft, its coarse chart and the verdict on its speed. Raises NoStability, NoSolution."""
        stability = study.flexible_shaft()
        drawn = self._chart(stability, study.design.name, COARSE, CHART_TOLERANCE, coarse=True)()
        return stability, drawn, speed_sentence(stability)

    def _show(self, stability: Stability, drawn: Chart, verdict: str) -> None:
        self.stability, self.drawn = stability, drawn
        self._mark("")
        self.verdict.setText(verdict)
        self.header.setText(machine_text(stability))
        self.chosen = self._new_point(stability)
        self._draw_chart()
        self._pause.start()
        self._show_fields(stability, self.chosen)
        self.pages.show_shaft(stability, self.chosen)

    def _mark(self, text: str) -> None:
        """Grey out the results of the previous design while a text is shown; empty: show the results."""
        if text:
            self.verdict.setText(text)
            self.reading.show_text("")
        self.chart.fade(bool(text))
        self.pages.fade(bool(text))
        self._show_progress()

    def _start_update(self) -> None:
        """Compute shaft, verdict and chart in the background."""
        if self.on_screen():
            study = self.session.full_study
            self.update_jobs.start([(study, partial(self._computed, study))])
            self._show_progress()

    def _show_update(self, study: Study, result: tuple[Stability, Chart, str] | KindynaError) -> None:
        if study is self.session.full_study:
            if isinstance(result, KindynaError):
                self.drawn = None
                self.show_reason(result)
            else:
                self._show(*result)
        self._show_progress()

    def on_paper(self, part: QWidget, paint: Callable[[QWidget], bytes]) -> bytes:
        def paint_results(part: QWidget) -> bytes:
            if self.stability is None and not self.in_trouble:  # they are still calculated
                self._stop()
                self._show(*self._computed(self.session.full_study))
            return paint(part)

        return super().on_paper(part, paint_results)

    @staticmethod
    def _chart(stability: Stability, name: str, rows: int, error: float, coarse: bool = False) -> Callable[[], Chart]:
        m = stability.machine
        return partial(
            chart,
            stability.coefficients,
            m,
            name,
            rows=rows,
            damping=m.damping,
            eta_max=stability.eta_max,
            error=error,
            coarse=coarse,
        )

    def _forget_design(self) -> None:
        self.picked = self.drawn = None

    def _new_point(self, stability: Stability) -> ChartPoint:
        """Return the selected point, or that of the machine, without results."""
        machine = stability.machine
        return ChartPoint(*(self.picked or (machine.eta, machine.q)), is_machine=self.picked is None)

    def _draw_chart(self, *_: object) -> None:
        if self.drawn is None:
            return
        if self.as_paper.isChecked():
            self.chart.show_chart(self.drawn, self.across.currentData(), self.upwards.currentData())
        elif self.stability is not None:
            self.chart.show_speeds(self.drawn, nearest_bands(self.stability, NEAREST))
        self.chart.ring_point(*(self.picked or (None,)))

    # -- slow results ---------------------------------------------------------------------------------------

    @property
    def busy(self) -> bool:
        """Whether results on screen are still being calculated."""
        return self._pause.isActive() or self._soon_update.isActive() or self._computing or self.reading.busy

    @property
    def _computing(self) -> bool:
        return any(jobs.busy for jobs in self._background)

    @property
    def _background(self) -> tuple[Background, ...]:
        return self.update_jobs, self.fine, self.point_jobs, self.shaft_jobs, self.reading.background

    def _stop(self) -> None:
        self._pause.stop()
        self._soon_update.stop()
        for jobs in (self.update_jobs, self.fine, self.point_jobs, self.shaft_jobs, self.reading):
            jobs.stop()
        self._show_progress()

    def leave(self) -> None:
        self._stop()
        for jobs in self._background:
            jobs.close()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        if not event.spontaneous():  # a spontaneous event means that the window is minimised
            self._stop()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if not self.up_to_date or self.in_trouble:
            return
        if self.stability is None:
            self._soon_update.start()
        elif self._is_incomplete:
            self._pause.start()

    @property
    def _is_incomplete(self) -> bool:
        """Whether a result on screen was stopped or never started."""
        if self.stability is None or self.chosen is None or self.drawn is None:
            return False
        is_drawn = self.drawn.q.size >= FINE and not self.pages.missing_result
        return not is_drawn or bool(self._jobs(self.stability, self.chosen))

    def settle(self) -> None:
        """Start now what waits for a pause."""
        for timer, begin in ((self._soon_update, self._start_update), (self._pause, self._begin)):
            if timer.isActive():
                timer.stop()
                begin()

    def _begin(self) -> None:
        """Start the slow results: the fine chart once, then those of the point."""
        if self.stability is None or self.drawn is None or not self.on_screen():
            return
        if self.drawn.q.size < FINE:
            self.fine.start([("chart", self._chart(self.stability, self.drawn.name, FINE, EDGE_ERROR))])
        self._start_point(self.stability)
        self.pages.redraw()

    def _start_point(self, stability: Stability) -> None:
        assert self.chosen is not None
        self.point_jobs.start(self._jobs(stability, self.chosen))
        self._show_progress()

    @staticmethod
    def _jobs(stability: Stability, point: ChartPoint) -> list[Job]:
        """Return jobs for the missing results of a point and of the shaft."""
        eta, q = point.eta, point.q
        rows: list[tuple[bool, Job]] = [
            ("bands" in vars(stability), ("bands", lambda: stability.bands)),  # a cached property
            (point.history is not None, ("history", partial(stability.history, eta=eta, q=q))),
            (point.steady is not None, ("steady", partial(steady_turns, stability, eta, q))),
            (bool(point.verdicts), ("verdicts", partial(stability.verdicts, eta, q))),
        ]
        return [job for known, job in rows if not known]

    def _compute_for_page(self, name: str) -> None:
        """Compute the cached property that the visible page waits for."""
        if self.stability is not None and not self.shaft_jobs.busy and not self._pause.isActive():
            self.shaft_jobs.start([(name, partial(getattr, self.stability, name))])
            self._show_progress()

    def _show_fine_chart(self, name: str, result: Chart | KindynaError) -> None:
        if isinstance(result, Chart):
            self.drawn = result
            self._draw_chart()
        self._show_progress()

    def _show_progress(self) -> None:
        self.progress.setVisible(self._computing or self._soon_update.isActive())

    def _store_result(self, name: str, result: Any) -> None:
        """Store a result of the selected point, and draw it or that of the shaft."""
        is_of_point = name in ("history", "steady", "verdicts")
        if self.chosen is not None and is_of_point and not isinstance(result, KindynaError):
            setattr(self.chosen, name, result)
        self.pages.redraw()
        self._show_progress()

    # -- selected point -------------------------------------------------------------------------------------

    def look_at(self, eta: float, q: float) -> None:
        """Select a point of the chart; the pages show its results."""
        self._choose((eta, q))

    def look_at_machine(self) -> None:
        """Select the point of the machine."""
        self._choose(None)

    def _pick(self, eta: float, q: float) -> None:
        """Select a point by the mouse, rounded to the resolution of a pixel; only as in the paper, where it is typed too."""
        if not self.as_paper.isChecked():
            return
        self.look_at(float(f"{eta:.5g}"), float(f"{q:.5g}"))

    def _choose(self, point: tuple[float, float] | None) -> None:
        self.picked = point
        self.chart.ring_point(*(point or (None,)))
        if self.stability is not None:
            self.chosen = self._new_point(self.stability)
            self._show_fields(self.stability, self.chosen)
            self.pages.show_point(self.chosen)
            self._start_point(self.stability)

    def _show_fields(self, stability: Stability, point: ChartPoint) -> None:
        self.fields.show_point(stability.machine, point.eta, point.q, point.is_machine)

    def _hover(self, point: tuple[float, float] | None) -> None:
        if self.stability is None or self.target is not None:
            return
        if point is None:
            self.reading.show_text("")
        else:
            self.reading.show_point(self.stability, point)

    def _pulled(self, eta: float, q: float) -> None:
        if self.stability is None:
            return
        self.target = (eta, q)
        self.chart.move_machine_point(eta, q)
        self.reading.show_text(needed_shaft_text(self.stability.machine, eta, q))

    def _released(self, is_dropped: bool) -> None:
        if not is_dropped:
            self.target = None
            self.reading.show_text("")
            if self.stability is not None:
                self._draw_chart()
        self.use.setVisible(self.target is not None)

    def use_target(self) -> None:
        """Put the shaft that the dragged point needs into the design."""
        if self.target is None or self.stability is None:
            return
        elastic = self.session.full_design.shaft.elastic
        inertia, stiffness = self.stability.machine.shaft_for(*self.target)
        moved = replace(
            elastic,
            camshaft_inertia_kg_m2=float(f"{inertia:.6g}"),
            stiffness_nm_per_rad=float(f"{stiffness:.6g}"),
        )
        text = f"Move shaft to η = {short(self.target[0])}, Q = {short(self.target[1])}"
        with self.session.one_step():
            self.session.put_full_design(with_elastic(self.session.full_design, moved), text)
