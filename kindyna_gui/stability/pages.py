"""The pages below the chart of stability: verdicts, speeds, and plots of the chosen point."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QScrollArea, QTabWidget, QVBoxLayout, QWidget

from core.design import UNITS, Info
from core.errors import NoStability
from core.frozen import frozen
from core.stability import (
    History,
    Stability,
    SteadyTurn,
    Verdict,
    averages_plots,
    coefficients_plot,
    contact_marks,
    harmonics_plot,
    steady_plots,
)
from kindyna_gui.forms.field_parts import UnitLabel
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import sentence
from kindyna_gui.look import coloured
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import SCREEN, VERMILION
from kindyna_gui.stability.texts import bands_table, shaft_text, steady_text, verdict_table

POINTS = 6000  # of a history that is drawn
LEAST_WIDTH = 596  # the table of verdicts needs it
KILO = 10e3  # N, from where on kN are counted
LAST_TURNS = 5.0  # of a history, drawn as phase plane
TURN = 360.0
FOLLOWING = "Following the shaft through 30 turns …"
SETTLING = "Looking for the steady response …"
AVERAGING = "Following the shaft from rest at many speeds …"


@dataclass
class ChartPoint:
    """What is known of a point of the chart; ``own``: it is the machine's; ``steady``: the steady response, None before it has been
    looked for, empty where there is none."""

    eta: float
    q: float
    own: bool
    history: History | None = None
    verdicts: tuple[Verdict, ...] = ()
    steady: tuple[SteadyTurn, ...] | None = None


def steady_turns(found: Stability, eta: float, q: float) -> tuple[SteadyTurn, ...]:
    """The steady response at a point, with all that is drawn of it; none where there is none."""
    turn = found.steady_turn_at(eta, q)
    return () if turn is None else (turn,)


class StabilityPages(QTabWidget):
    """One page in front of the others; only that is drawn.

    lacking   (str): a page has come to the front that waits for what is named, a cached property of ``Stability``
    """

    lacking = Signal(str)

    def __init__(self) -> None:
        super().__init__(documentMode=True)
        self.found: Stability | None = None
        self.chosen: ChartPoint | None = None
        self._drawn: set[int] = set()
        self.verdicts, self.speeds = _text(), _text()
        # as long as there are drives, so that it must wrap, which the table above must not
        self.steady = QLabel(wordWrap=True, margin=8)
        self.steady.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.addTab(_rolled(self.verdicts, self.steady), "Verdicts")
        self.addTab(self._speeds_page(), "Speeds")
        self.plots: dict[str, tuple[XYPlot, ...]] = {}
        for name, row in PLOTS.items():
            self.plots[name] = tuple(XYPlot(across, upwards) for across, upwards in row.axes)
            self.addTab(_beside(self.plots[name]), name)
        self.setMinimumWidth(max(LEAST_WIDTH, self.tabBar().sizeHint().width()))
        self.currentChanged.connect(self._draw)
        self.speed.entered.connect(self._needs)

    def _speeds_page(self) -> QScrollArea:
        """The forbidden bands, and the shaft that a wanted speed asks for."""
        self.speed = NumberBox(Info("Speed", low=0.0, high=1e5, open_low=True, step=10.0), UNITS["rpm"])
        self.needed = QLabel(wordWrap=True)
        self.needed.setMinimumWidth(1)
        row = QHBoxLayout()
        row.setContentsMargins(8, 6, 8, 0)
        row.addWidget(QLabel("To run at"))
        row.addWidget(self.speed)
        row.addWidget(UnitLabel(UNITS["rpm"]))
        row.addWidget(self.needed, 1)
        return _rolled(row, self.speeds)

    # -- what is shown --------------------------------------------------------------------------------------

    def show_shaft(self, found: Stability, point: ChartPoint) -> None:
        """Another shaft, and the point of its chart that is chosen."""
        self.found = found
        self.speed.show_value(round(found.machine.rpm(found.machine.eta), 6))
        self.show_point(point)

    def show_point(self, point: ChartPoint) -> None:
        """Another point, or more of it is known."""
        self.chosen = point
        self.redraw()

    def fade(self, on: bool) -> None:
        """Texts stand back while others are computed in their place; what has the focus keeps it."""
        for label in (self.verdicts, self.speeds, self.needed):
            label.setEnabled(not on)

    def redraw(self) -> None:
        """What is drawn is out of date."""
        self._drawn.clear()
        self._draw()

    @property
    def lacks(self) -> str:
        """The cached property of the shaft for which the page in front waits, '' where there is none."""
        row = PLOTS.get(self.tabText(self.currentIndex()))
        return row.needs if row is not None and self.found is not None and row.needs not in vars(self.found) else ""

    def show_page(self, name: str) -> None:
        """Bring the page of this name to the front."""
        self.setCurrentIndex([self.tabText(i) for i in range(self.count())].index(name))

    def _draw(self, *_: object) -> None:
        index = self.currentIndex()
        if self.found is None or self.chosen is None or index in self._drawn:
            return
        self._drawn.add(index)
        name = self.tabText(index)
        if name == "Verdicts":
            self._show_verdicts(self.found, self.chosen)
        elif name == "Speeds":
            self._show_speeds(self.found)
        else:
            self._show_plots(self.found, self.chosen, name)

    def _show_plots(self, found: Stability, point: ChartPoint, name: str) -> None:
        row = PLOTS[name]
        waits = WAITING[row.of](point) if row.of else AVERAGING if self.lacks else ""
        if waits:
            for plot in self.plots[name]:
                plot.show_message(waits)
            if row.needs:
                self.lacking.emit(row.needs)
        else:
            row.draw(self.plots[name], found, point)

    def _show_verdicts(self, found: Stability, point: ChartPoint) -> None:
        verdicts = point.verdicts or found.linear_at(point.eta, point.q)
        where = "" if point.own else "the picked point, "
        wait = "" if point.verdicts else f"<p style='color:{SCREEN.quiet}'>The nonlinear models are still to come.</p>"
        self.verdicts.setText(f"<p>{where}η = {point.eta:.5g}, Q = {point.q:.5g}</p>{verdict_table(verdicts)}{wait}")
        self.steady.setText(steady_text(point.steady[0]) if point.steady else "")
        self.steady.setVisible(bool(point.steady))

    def _show_speeds(self, found: Stability) -> None:
        if "bands" in vars(found):
            machine = found.machine
            self.speeds.setText(bands_table(found.bands, machine.rpm(machine.eta)))
            if self.speed.value is not None:
                self._needs(self.speed.value)
        else:
            self.speeds.setText("Looking for the forbidden bands …")

    def _needs(self, rpm: float) -> None:
        if self.found is not None:
            try:
                self.needed.setText(shaft_text(self.found.stiffness_for(rpm)))
                coloured(self.needed, SCREEN.quiet)
            except NoStability as error:
                self.needed.setText(sentence(f"{error.problem}; {error.hint}"))
                coloured(self.needed, SCREEN.limit)


def _text() -> QLabel:
    label = QLabel(alignment=Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft, margin=8)
    label.setTextFormat(Qt.TextFormat.RichText)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    return label


def _rolled(*parts: QWidget | QHBoxLayout) -> QScrollArea:
    """Rows one below the other that can be rolled where the page is too low."""
    paper = QWidget()
    column = QVBoxLayout(paper)
    column.setContentsMargins(0, 0, 0, 0)
    for part in parts:
        column.addWidget(part) if isinstance(part, QWidget) else column.addLayout(part)
    column.addStretch(1)
    area = QScrollArea(widgetResizable=True)
    area.setFrameShape(QScrollArea.Shape.NoFrame)
    area.setWidget(paper)
    return area


def _beside(plots: tuple[XYPlot, ...]) -> QWidget:
    if len(plots) == 1:
        return plots[0]
    page = QWidget()
    row = QHBoxLayout(page)
    row.setContentsMargins(0, 0, 0, 0)
    row.setSpacing(0)
    for plot in plots:
        row.addWidget(plot, 1)
    return page


# -- plots --------------------------------------------------------------------------------------------------


def _samples(run: History, begin: float = 0.0) -> np.ndarray:
    return np.linspace(begin, run.ended, POINTS)


def _wind_up(plots: tuple[XYPlot, ...], found: Stability, point: ChartPoint) -> None:
    run = _history(point)
    y = _samples(run)
    plots[0].show_lines([Line(y, TURN * run.at(y)[0], SCREEN.ink)], contact_marks(run))


def _phase(plots: tuple[XYPlot, ...], found: Stability, point: ChartPoint) -> None:
    run = _history(point)
    beta, rate = run.at(_samples(run, max(0.0, run.ended - LAST_TURNS)))
    plots[0].show_lines([Line(TURN * beta, TURN * rate, SCREEN.ink)], square=True)


def _spectrum(plots: tuple[XYPlot, ...], found: Stability, point: ChartPoint) -> None:
    order, size = _history(point).spectrum(max(12.0, 1.25 * point.eta))
    plots[0].show_lines([Line(order, TURN * size, VERMILION)])


def _contact(plots: tuple[XYPlot, ...], found: Stability, point: ChartPoint) -> None:
    run = _history(point)
    if run.contact is None:
        plots[0].show_message("No contact force: the follower has no cam that it could leave.")
        return
    y = _samples(run)
    unit = run.contact.unit * found.machine.omega_at(run.eta) ** 2
    force = unit * run.forces(y)
    name, per = ("kN", 1e3) if np.abs(force).max() >= KILO else ("N", 1.0)
    plots[0].name_axes("Turns of the input", f"Force, {name}")
    drives = zip(force / per, run.contact.names, run.contact.numbers, strict=True)
    lines = [Line(y, each, SCREEN.drive(number) if name else SCREEN.ink, name) for each, name, number in drives]
    plots[0].show_lines(lines, contact_marks(run))


def _history(point: ChartPoint) -> History:
    assert point.history is not None
    return point.history


def _steady(plots: tuple[XYPlot, ...], found: Stability, point: ChartPoint) -> None:
    if not point.steady:
        _no_response(plots)
        return
    wind_up, *errors = steady_plots(point.steady[0])
    plots[0].show_plot(wind_up)
    if not errors:
        plots[1].show_message("No follower has a motion of its own.")
    for plot, error in zip(plots[1:], errors, strict=False):  # of those that slide, and of those that swing
        plot.show_plot(error)
    plots[2].setVisible(len(errors) > 1)


def _harmonics(plots: tuple[XYPlot, ...], found: Stability, point: ChartPoint) -> None:
    if point.steady:
        plots[0].show_plot(harmonics_plot(point.steady[0]))
    else:
        _no_response(plots)


def _no_response(plots: tuple[XYPlot, ...]) -> None:
    for plot in plots:
        plot.show_message("No steady response was found at this point.")


def _averages(plots: tuple[XYPlot, ...], found: Stability, point: ChartPoint) -> None:
    for plot, drawn in zip(plots, averages_plots(found.first_turn), strict=True):
        plot.show_plot(drawn)


def _terms(plots: tuple[XYPlot, ...], found: Stability, point: ChartPoint) -> None:
    plots[0].show_plot(coefficients_plot(found.coefficients))


@frozen
class StabilityPage:
    """A page of plots: titles of their axes, what draws them; ``of``: what of the point it waits for, a row of ``WAITING``;
    ``needs``: a cached property of ``Stability`` that it waits for."""

    axes: tuple[tuple[str, str], ...]
    draw: Callable[[tuple[XYPlot, ...], Stability, ChartPoint], None]
    of: str = "history"
    needs: str = ""


WAITING: Mapping[str, Callable[[ChartPoint], str]] = MappingProxyType(
    {
        "history": lambda point: FOLLOWING if point.history is None else "",
        "steady": lambda point: SETTLING if point.steady is None else "",
    }
)
"""What a page says while what it shows of a point is still to come; empty once that is known."""

PLOTS: Mapping[str, StabilityPage] = MappingProxyType(
    {
        "Wind-up": StabilityPage((("Turns of the input", "Twist, °"),), _wind_up),
        "Phase": StabilityPage((("Twist, °", "Rate, °/turn"),), _phase),
        "Spectrum": StabilityPage((("Order, × shaft speed", "Twist, °"),), _spectrum),
        "Contact": StabilityPage((("Turns of the input", "Force, N"),), _contact),
        "Steady": StabilityPage((("", ""), ("", ""), ("", "")), _steady, of="steady"),
        "Harmonics": StabilityPage((("", ""),), _harmonics, of="steady"),
        "Averages": StabilityPage((("", ""), ("", "")), _averages, of="", needs="first_turn"),
        "Terms": StabilityPage((("", ""),), _terms, of=""),
    }
)

__all__ = ["ChartPoint", "StabilityPages", "steady_turns"]
