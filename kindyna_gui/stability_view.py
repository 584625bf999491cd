"""Stability of the flexible camshaft: the chart of tongues, what every model says of a point, and the wind-up there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import (
    QComboBox,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QScrollArea,
    QSplitter,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from core.design import UNITS, Info, with_elastic
from core.errors import KindynaError
from core.stability import EXACT, Chart, History, Stability, Verdict, chart
from core.study import Study
from kindyna_gui.lanes import Job, Lane
from kindyna_gui.look import QUIET, WRONG, coloured
from kindyna_gui.number_box import NumberBox
from kindyna_gui.pictures.chart import ACROSS, UPWARDS
from kindyna_gui.pictures.style import LIGHT, VERMILION
from kindyna_gui.pictures.xy import Line, XYPlot
from kindyna_gui.player import Player
from kindyna_gui.session import Session
from kindyna_gui.shown_kinds import NO_SHAFT, NotHere, only_cams
from kindyna_gui.stability_chart import StabilityChart
from kindyna_gui.stability_words import (
    bands_table,
    machine_text,
    point_text,
    shaft_text,
    tongue_of,
    verdict_table,
    wanted_text,
)
from kindyna_gui.view import View

COARSE, FINE = 10, 64  # rows of Q: at once, and once there is time
PAUSE_MS = 150  # of editing or pointing, before what takes long is begun
POINTS = 2400  # of a history that is drawn
LAST_TURNS = 5.0  # of a history, drawn as phase plane
TURN = 360.0
RIGID = "The camshaft is rigid. Stability > Flexible shaft gives it a stiffness and an inertia to begin with."
PLOTS = (
    ("Wind-up", "Turns of the input", "Twist, °"),
    ("Phase plane", "Twist, °", "Twist rate, ° per turn"),
    ("Spectrum", "Order, × shaft speed", "Twist, °"),
    ("Contact force", "Turns of the input", "Contact force, N"),
)


class StabilityView(View):
    """The page of stability.

    The coarse chart is drawn at once; the fine one, the verdicts and the history of the point that is looked at are
    computed beside the window and given up where the design changes.
    """

    stages = ("stability",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.found: Stability | None = None
        self.point: tuple[float, float] | None = None  # looked at; None: the machine's own
        self.wanted: tuple[float, float] | None = None  # where the machine's point has been drawn to
        self.gone: History | None = None
        self.said: tuple[Verdict, ...] = ()
        self.chart = StabilityChart()
        self.chart.setMinimumHeight(180)
        self.fine, self.looks = Lane(), Lane()
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self._begin)
        self._drawn: set[int] = set()
        self._lay_out()
        self._connect()

    # -- building -------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        self.head, self.reading = QLabel(), QLabel()
        for label in (self.head, self.reading):
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
            label.setMinimumWidth(1)
        coloured(self.reading, QUIET)
        self.progress = QProgressBar(textVisible=False, minimum=0, maximum=0)
        self.progress.setFixedSize(70, 8)
        self.progress.hide()
        self.across, self.upwards = self._choice(ACROSS), self._choice(UPWARDS)
        self.use = QPushButton("Use this shaft")
        self.use.setToolTip("Put the stiffness and inertia that this point needs into the design, as one step")
        self.use.hide()
        tools = QHBoxLayout()
        tools.setContentsMargins(8, 4, 8, 0)
        tools.addWidget(self.head, 1)
        tools.addWidget(self.progress)
        for text, box in (("across", self.across), ("upwards", self.upwards)):
            name = QLabel(text)
            coloured(name, QUIET)
            tools.addWidget(name)
            tools.addWidget(box)
        foot = QHBoxLayout()
        foot.setContentsMargins(8, 0, 8, 2)
        foot.addWidget(self.reading, 1)
        foot.addWidget(self.use)
        upper = QWidget()
        column = QVBoxLayout(upper)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(2)
        column.addLayout(tools)
        column.addWidget(self.chart, 1)
        column.addLayout(foot)
        self.tabs = QTabWidget(documentMode=True)
        self.verdicts, self.speeds = self._page(), self._page()
        self.tabs.addTab(self.verdicts, "Verdicts")
        self.tabs.addTab(self._speeds_page(), "Speeds")
        self.plots: dict[str, XYPlot] = {}
        for name, across, upwards in PLOTS:
            self.plots[name] = XYPlot(across, upwards)
            self.tabs.addTab(self.plots[name], name)
        parted = QSplitter(Qt.Orientation.Vertical, childrenCollapsible=False)
        parted.addWidget(upper)
        parted.addWidget(self.tabs)
        parted.setStretchFactor(0, 3)
        parted.setStretchFactor(1, 2)
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

    @staticmethod
    def _page() -> QLabel:
        label = QLabel(alignment=Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft, margin=8)
        label.setTextFormat(Qt.TextFormat.RichText)
        label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        return label

    def _speeds_page(self) -> QScrollArea:
        """The forbidden bands, and the shaft that a wanted speed asks for."""
        self.speed = NumberBox(Info("Speed", low=0.0, high=1e5, open_low=True, step=10.0), UNITS["rpm"])
        self.needed = QLabel(wordWrap=True)
        self.needed.setMinimumWidth(1)
        row = QHBoxLayout()
        row.setContentsMargins(8, 6, 8, 0)
        name = QLabel("To run at")
        row.addWidget(name)
        row.addWidget(self.speed)
        row.addWidget(QLabel("rpm"))
        row.addWidget(self.needed, 1)
        paper = QWidget()
        column = QVBoxLayout(paper)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(row)
        column.addWidget(self.speeds)
        column.addStretch(1)
        area = QScrollArea(widgetResizable=True)
        area.setFrameShape(QScrollArea.Shape.NoFrame)
        area.setWidget(paper)
        return area

    def _connect(self) -> None:
        self.chart.hovered.connect(self._hover)
        self.chart.picked.connect(self.look_at)
        self.chart.pulled.connect(self._pulled)
        self.chart.released.connect(self._released)
        self.fine.answered.connect(self._refined)
        self.looks.answered.connect(self._looked)
        self.across.currentIndexChanged.connect(self._draw_chart)
        self.upwards.currentIndexChanged.connect(self._draw_chart)
        self.tabs.currentChanged.connect(self._draw_tab)
        self.speed.entered.connect(self._needs)
        self.use.clicked.connect(self.use_wanted)
        self.session.started.connect(self._another_design)

    # -- showing --------------------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        self._stop()
        self.wanted = None
        self.use.hide()
        self.found = None
        design = only_cams(study.design, NO_SHAFT)
        if design.shaft.elastic is None:
            raise NotHere(RIGID)
        self.found = found = study.flexible_shaft()
        machine = found.machine
        self.head.setText(machine_text(found))
        self.reading.setText("")
        self.speed.show_value(round(machine.rpm(machine.eta), 6))
        self.drawn = self._chart(found, study.design.name, COARSE)()
        self._draw_chart()
        self._forget_look()
        self._draw_tab()
        self._pause.start()

    @staticmethod
    def _chart(found: Stability, name: str, rows: int) -> Callable[[], Chart]:
        return partial(chart, found.coefficients, found.machine, name, rows=rows, damping=found.machine.damping)

    def _another_design(self) -> None:
        self.point = None

    def _draw_chart(self, *_: object) -> None:
        self.chart.show_chart(self.drawn, self.across.currentData(), self.upwards.currentData())
        self.chart.look_at(*(self.point or (None,)))

    @property
    def busy(self) -> bool:
        """Something that is shown is still to come."""
        return self._pause.isActive() or self.fine.busy or self.looks.busy

    def _stop(self) -> None:
        self._pause.stop()
        self.fine.stop()
        self.looks.stop()
        self.progress.hide()

    def settle(self) -> None:
        """Do now what waits for a pause, and wait for it."""
        if self._pause.isActive():
            self._pause.stop()
            self._begin()

    def _begin(self) -> None:
        """Ask for what takes longer: the fine chart once, then all about the point."""
        if self.found is None or not self.on_screen():
            return
        self.progress.show()
        if self.drawn.q.size < FINE:
            self.fine.ask([("chart", self._chart(self.found, self.drawn.name, FINE))])
        self._ask_for_point()

    def _ask_for_point(self) -> None:
        assert self.found is not None
        eta, q = self.looked_at
        self.progress.show()
        jobs: list[Job] = [
            (("history", eta, q), partial(self.found.history, eta=eta, q=q)),
            (("verdicts", eta, q), partial(self.found.verdicts, eta, q)),
        ]
        if "bands" not in vars(self.found):  # kept there once they are known
            jobs.insert(0, (("bands", eta, q), lambda found=self.found: found.bands))
        self.looks.ask(jobs)

    def _refined(self, asked: str, found: Chart | KindynaError) -> None:
        if isinstance(found, Chart):
            self.drawn = found
            self._draw_chart()
        self._rest()

    def _rest(self) -> None:
        self.progress.setVisible(self.fine.busy or self.looks.busy)

    def _looked(self, asked: tuple[str, float, float], found: Any) -> None:
        if isinstance(found, History):
            self.gone = found
        elif asked[0] == "verdicts" and not isinstance(found, KindynaError):
            self.said = found
        self._drawn.clear()
        self._draw_tab()
        self._rest()

    # -- a point --------------------------------------------------------------------------------------------

    @property
    def looked_at(self) -> tuple[float, float]:
        """The point that is looked at: one that was picked, or the machine's own."""
        assert self.found is not None
        return self.point or (self.found.machine.eta, self.found.machine.q)

    def look_at(self, eta: float, q: float) -> None:
        """Pick a point of the chart: verdicts, history, phase plane, spectrum and contact force are of it."""
        self.point = (eta, q)
        self.chart.look_at(eta, q)
        self._forget_look()
        self._drawn.clear()
        self._draw_tab()
        if self.found is not None:
            self._ask_for_point()

    def _forget_look(self) -> None:
        self.gone, self.said = None, ()
        self._drawn.clear()

    def _hover(self, point: tuple[float, float] | None) -> None:
        if self.found is None or self.wanted is not None:
            return
        if point is None:
            self.reading.setText("")
            return
        eta, q = point
        found = self.found
        row = found.tongues(EXACT, max(eta + 0.5, 1.0), q)
        self.reading.setText(point_text(eta, q, found.machine, found.quick(eta, q), tongue_of(row, eta)))

    def _pulled(self, eta: float, q: float) -> None:
        assert self.found is not None
        self.wanted = (eta, q)
        self.chart.move_own(eta, q)
        self.reading.setText(wanted_text(self.found.machine, eta, q))

    def _released(self, kept: bool) -> None:
        if not kept:
            self.wanted = None
            self.reading.setText("")
            if self.found is not None:
                self._draw_chart()
        self.use.setVisible(self.wanted is not None)

    def use_wanted(self) -> None:
        """Put the shaft of the wanted point into the design."""
        if self.wanted is None or self.found is None:
            return
        elastic = self.session.design.shaft.elastic
        inertia, stiffness = self.found.machine.shaft_for(*self.wanted)
        made = replace(
            elastic,
            camshaft_inertia_kg_m2=float(f"{inertia:.6g}"),
            stiffness_nm_per_rad=float(f"{stiffness:.6g}"),
        )
        self.session.end_gesture()
        self.session.put(
            with_elastic(self.session.design, made), f"Move shaft to η = {self.wanted[0]:.4g}, Q = {self.wanted[1]:.4g}"
        )
        self.session.end_gesture()

    def _needs(self, rpm: float) -> None:
        if self.found is not None:
            try:
                self.needed.setText(shaft_text(self.found.stiffness_for(rpm)))
                coloured(self.needed, QUIET)
            except KindynaError as error:
                self.needed.setText(str(error))
                coloured(self.needed, WRONG)

    # -- the tabs -------------------------------------------------------------------------------------------

    def _draw_tab(self, *_: object) -> None:
        """Only the page in front is drawn."""
        index = self.tabs.currentIndex()
        if self.found is None or index in self._drawn:
            return
        self._drawn.add(index)
        name = self.tabs.tabText(index)
        if name == "Verdicts":
            self._show_verdicts()
        elif name == "Speeds":
            self._show_speeds()
        elif self.gone is None:
            self.plots[name].show_message("Following the shaft through 30 turns …")
        else:
            DRAW[name](self.plots[name], self.gone, self.found)

    def _show_verdicts(self) -> None:
        assert self.found is not None
        eta, q = self.looked_at
        where = "" if self.point is None else "the picked point, "
        told = self.said or self.found.quick(eta, q)
        wait = "" if self.said else f"<p style='color:{QUIET}'>The nonlinear models are still to come.</p>"
        self.verdicts.setText(f"<p>{where}η = {eta:.5g}, Q = {q:.5g}</p>{verdict_table(told)}{wait}")

    def _show_speeds(self) -> None:
        assert self.found is not None
        machine = self.found.machine
        if "bands" in vars(self.found):
            self.speeds.setText(bands_table(self.found.bands, machine.rpm(machine.eta)))
            self._needs(self.speed.value)
        else:
            self.speeds.setText("Looking for the forbidden bands …")


# -- plots of a history -------------------------------------------------------------------------------------


def _samples(gone: History, begin: float = 0.0) -> np.ndarray:
    return np.linspace(begin, gone.ended, POINTS)


def _lost(gone: History) -> tuple[tuple[float, str], ...]:
    return () if gone.contact_lost is None else ((gone.contact_lost, f"leaves the cam at {gone.contact_lost:.4g}"),)


def _wind_up(plot: XYPlot, gone: History, found: Stability) -> None:
    y = _samples(gone)
    plot.show_lines([Line(y, TURN * gone.at(y)[0], LIGHT.ink)], _lost(gone))


def _phase(plot: XYPlot, gone: History, found: Stability) -> None:
    y = _samples(gone, max(0.0, gone.ended - LAST_TURNS))
    beta, rate = gone.at(y)
    plot.show_lines([Line(TURN * beta, TURN * rate, LIGHT.ink)], square=True)


def _spectrum(plot: XYPlot, gone: History, found: Stability) -> None:
    order, size = gone.spectrum()
    plot.show_lines([Line(order, TURN * size, VERMILION)])


def _contact(plot: XYPlot, gone: History, found: Stability) -> None:
    if gone.contact is None:
        plot.show_message("No contact force: the follower has no cam that it could leave.")
        return
    y = _samples(gone)
    unit = gone.contact.unit * found.machine.omega_at(gone.eta) ** 2
    plot.show_lines([Line(y, unit * gone.force(y), LIGHT.ink)], _lost(gone))


DRAW: dict[str, Callable[[XYPlot, History, Stability], None]] = {
    "Wind-up": _wind_up,
    "Phase plane": _phase,
    "Spectrum": _spectrum,
    "Contact force": _contact,
}

__all__ = ["StabilityView"]
