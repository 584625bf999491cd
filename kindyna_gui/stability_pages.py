"""Parts of the stability view: fields of a point, texts of the results, and the pages below the chart."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from math import degrees, expm1, isfinite
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QScrollArea, QTabWidget, QVBoxLayout, QWidget

from core.design import NO_UNIT, UNITS, Info
from core.errors import NoStability
from core.frozen import frozen
from core.number_text import digits_apart
from core.output.drawing.palette import VERMILION
from core.stability import (
    APPROXIMATE,
    EXACT,
    LOST,
    STABLE,
    UNKNOWN_VERDICT,
    UNSTABLE,
    ForbiddenBand,
    History,
    Machine,
    Stability,
    SteadyTurn,
    Stiffness,
    Tongues,
    Verdict,
    averages_plots,
    coefficients_plot,
    contact_marks,
    harmonics_plot,
    margin_text,
    nearest_bands,
    steady_plots,
)
from kindyna_gui.forms.fields import UnitLabel
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import sentence
from kindyna_gui.look import coloured, described
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import digits, measure, number, short, typed, with_unit
from kindyna_gui.rebuilt import STRETCH, connect_all, fill, widget_with

# -- fields of a point -----------------------------------------------------------------------------------

MOST_ETA, MOST_Q = 60.0, 100.0  # largest frequency and inertia ratio that is computed
DIGITS = 7  # of calculated numbers


class PointFields(QWidget):
    """Fields for η, Q and speed of a point, and a button that returns to the point of the machine.

    - entered (float, float): another η and Q was typed
    - returned: the button was clicked
    """

    entered = Signal(float, float)
    returned = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.eta = NumberBox(Info("Frequency ratio η", low=0.0, high=MOST_ETA, open_low=True, step=0.01), NO_UNIT)
        self.q = NumberBox(Info("Inertia ratio Q", low=0.0, high=MOST_Q, step=0.01), NO_UNIT)
        self.rpm = NumberBox(Info("Speed", low=0.0, high=1e5, open_low=True, step=10.0), UNITS["rpm"])
        self.back = described(QPushButton("Machine's own"), tip="Select the point of the machine again")
        row = fill(QHBoxLayout(self), margins=0)
        for before, box, after in (
            ("Point: η", self.eta, NO_UNIT),
            ("Q", self.q, NO_UNIT),
            ("or at", self.rpm, UNITS["rpm"]),
        ):
            for part in (_quiet(before), box, *([UnitLabel(after)] if after.symbol else [])):
                row.addWidget(part)
        row.addWidget(self.back)
        self._machine: Machine | None = None
        self._point = (0.0, 0.0)
        connect_all(
            (self.eta.entered, self._typed_eta),
            (self.q.entered, self._typed_q),
            (self.rpm.entered, self._typed_rpm),
            (self.back.clicked, self.returned),
        )
        self.setEnabled(False)

    def show_point(self, machine: Machine, eta: float, q: float, is_machine: bool) -> None:
        """Show a point of the chart and discard refused input; ``is_machine``: it is the point of the machine."""
        self._machine, self._point = machine, (eta, q)
        self.eta.show_value(_rounded(eta) if is_machine else eta)
        self.q.show_value(_rounded(q) if is_machine else q)
        self.rpm.show_value(_rounded(machine.rpm(eta)))
        least = machine.rpm(MOST_ETA)
        limits = (
            (self.eta, f"above 0, up to {typed(MOST_ETA)}"),
            (self.q, f"0 ... {typed(MOST_Q)}"),
            (self.rpm, f"{short(least)} rpm and more"),
        )
        for box, allowed in limits:
            box.setToolTip(f"Allowed: {allowed}")
        self.back.setEnabled(not is_machine)
        self.setEnabled(True)

    def _typed_eta(self, value: float) -> None:
        self._enter(self.eta, value, self._point[1])

    def _typed_q(self, value: float) -> None:
        self._enter(self.q, self._point[0], value)

    def _typed_rpm(self, value: float) -> None:
        assert self._machine is not None
        self._enter(self.rpm, self._machine.eta_at(value) if value > 0.0 else 0.0, self._point[1])

    def _enter(self, box: NumberBox, eta: float, q: float) -> None:
        if 0.0 < eta <= MOST_ETA and 0.0 <= q <= MOST_Q:
            self.entered.emit(eta, q)
        else:
            box.set_refused(True)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _quiet(text: str) -> QLabel:
    label = coloured(QLabel(text), SCREEN.quiet)
    return label


# -- texts -----------------------------------------------------------------------------------------------

STEADY, FROM_REST = "steady", "from_rest"
WORDS = {"model", "verdict"}  # columns of text
ROUNDING = 1e-9  # rounding error of a mean torque, as a share of its amplitude
BRIEF = {APPROXIMATE: "approximate (22)", EXACT: "exact (21)"}


def percent(growth: float) -> str:
    """Growth per turn in percent from its logarithm: ``2.3 % a turn``."""
    part = expm1(growth)
    return f"{digits(100.0 * part, 3)} % a turn" if part < 10.0 else f"×{digits(1.0 + part, 3)} a turn"


def speed(rpm: float, figures: int = 4) -> str:
    """Speed [rpm] as text; ∞ where it is unbounded."""
    return digits(rpm, figures) if isfinite(rpm) else "∞"


def speeds(band: ForbiddenBand) -> str:
    """Range of speeds of a forbidden band, with enough digits to tell its ends apart, as far as six do; else one speed."""
    ends = (band.rpm_lo, band.rpm_hi)
    figures = digits_apart([rpm for rpm in ends if isfinite(rpm)])
    return " … ".join(dict.fromkeys(speed(rpm, figures) for rpm in ends))


def tongue_of(tongues: Tongues, eta: float, row: int = 0) -> int | None:
    """Number of the tongue at an η; None between the tongues."""
    for n, (low, high) in enumerate(tongues.edges[row], 1):
        if low <= eta <= high:
            return n
    return None


def speed_text(eta: float, q: float, machine: Machine, verdicts: Sequence[Verdict]) -> str:
    """Speed, masses and the verdict of the exact linear model at a point, in one line."""
    verdict = verdicts[-1]
    state = "clear of every band" if verdict.stable else f"inside a band, the twist grows by {percent(verdict.growth)}"
    return f"{speed(machine.rpm(eta))} rpm with {digits(q / machine.q, 3)} × the moving masses: {state}"


def point_text(eta: float, q: float, machine: Machine | None, verdicts: Sequence[Verdict], tongue: int | None) -> str:
    """Position, tongue and verdicts of a point, in one line."""
    at = f"η = {short(eta)}, Q = {short(q)}"
    if machine is not None:
        at += f", {speed(machine.rpm(eta))} rpm"
    position = f"tongue {tongue}" if tongue is not None else "between tongues"
    models = "; ".join(
        f"{BRIEF[v.model]} {'stable' if v.stable else f'grows {percent(v.growth)}'}"
        for v in verdicts
        if v.model in BRIEF
    )
    return f"{at}: {position}; {models}"


def waiting_text(verdicts: Sequence[Verdict], waiting: bool) -> str:
    """A line for each nonlinear model at a point, as far as they are computed."""
    by_model = {verdict.model: verdict for verdict in verdicts}
    parts = [words(by_model[model]) for model, words in SLOW.items() if model in by_model]
    if waiting:
        parts.append("still computing …" if parts else "nonlinear models: computing …")
    return "\n".join(parts)


def _steady_words(verdict: Verdict) -> str:
    if verdict.stable is None:
        return "steady: no steady response"
    state = f"grows {percent(verdict.growth)}" if verdict.state == UNSTABLE else verdict.state
    return f"steady: {state}, {_twist(verdict)}{_contact_words(verdict)}"


def _rest_words(verdict: Verdict) -> str:
    state = "" if verdict.stable else ", not settled"
    return f"from rest: {_twist(verdict)}{state}{_contact_words(verdict)}"


def _twist(verdict: Verdict) -> str:
    return f"{digits(360.0 * verdict.largest, 3)}°"


def _contact_words(verdict: Verdict) -> str:
    if verdict.contact_lost is None:
        return ""
    return f", {f'{verdict.leaving} ' if verdict.leaving else ''}off the cam at turn {digits(verdict.contact_lost, 4)}"


SLOW: Mapping[str, Callable[[Verdict], str]] = MappingProxyType({STEADY: _steady_words, FROM_REST: _rest_words})


def _cell(text: str, colour: str = "", right: bool = False) -> str:
    style = f' style="color:{colour}"' if colour else ""
    align = ' align="right"' if right else ""
    return f"<td{align}{style}>{escape(text)}&nbsp;&nbsp;</td>"


def _table(header: Sequence[str], rows: Sequence[str]) -> str:
    top = "".join(_cell(text, SCREEN.quiet, right=text not in WORDS) for text in header)
    return f'<table cellspacing="0" cellpadding="2"><tr>{top}</tr>{"".join(f"<tr>{row}</tr>" for row in rows)}</table>'


def verdict_table(verdicts: Sequence[Verdict]) -> str:
    """Table of the verdicts of all models; none is green where the follower leaves the cam in one of them."""
    rows = []
    good = SCREEN.good if all(verdict.contact_lost is None for verdict in verdicts) else ""
    for verdict in verdicts:
        colour = {STABLE: good, UNSTABLE: SCREEN.limit, LOST: SCREEN.limit, UNKNOWN_VERDICT: SCREEN.quiet}[
            verdict.state
        ]
        growth = percent(verdict.growth) if verdict.stable is False and isfinite(verdict.growth) else "–"
        trace = number(verdict.trace, 4) if isfinite(verdict.trace) else "–"
        largest = f"{short(360.0 * verdict.largest)}°" if isfinite(verdict.largest) else "–"
        drive = f"{verdict.leaving} " if verdict.leaving else ""
        leaves = f"{drive}at turn {short(verdict.contact_lost)}" if verdict.contact_lost is not None else "–"
        rows.append(
            _cell(verdict.label)
            + _cell(verdict.state, colour)
            + "".join(_cell(text, right=True) for text in (growth, trace, largest, leaves))
        )
    return _table(("model", "verdict", "grows", "trace", "largest twist", "off the cam"), rows)


def bands_table(rows: Sequence[ForbiddenBand], rpm: float, in_paper: bool = False) -> str:
    """Table of the forbidden bands of speed, with η where it is that of the paper; the band at the machine's speed is red."""
    lines = []
    for band in rows:
        colour = SCREEN.limit if band.contains(rpm) else ""
        ratios = (f"{number(band.eta_lo, 5)} … {number(band.eta_hi, 5)}",) if in_paper else ()
        cells = (
            speeds(band),
            str(band.n),
            *ratios,
            percent(band.growth),
            f"{digits(band.rate, 3)} /s",
            margin_text(band, rpm),
        )
        lines.append("".join(_cell(text, colour, right=True) for text in cells))
    if not lines:
        return "<p>No forbidden speeds.</p>"
    titles = ("rpm", "tongue", "η") if in_paper else ("rpm", "order")
    return _table((*titles, "twist grows by", "rate", "margin"), lines)


STIFFNESS, INERTIA = "N·m/rad", "kg·m²"


def shaft_text(stiffness: Stiffness) -> str:
    """Stiffness of the shaft that a speed needs."""
    if stiffness.allowed:
        return f"{speed(stiffness.rpm)} rpm: the present {measure(stiffness.current, STIFFNESS, 5)} is clear of every band."
    softer = f" or at most {measure(stiffness.softer, STIFFNESS, 5)}" if stiffness.softer is not None else ""
    return (
        f"{speed(stiffness.rpm)} rpm: at least {measure(stiffness.stiffer, STIFFNESS, 5)}{softer}; "
        f"the present {measure(stiffness.current, STIFFNESS, 5)} is {'in' if stiffness.inside else 'too near'} a band."
    )


def steady_text(turn: SteadyTurn) -> str:
    """Torque in the shaft and error of each follower in the steady response."""
    mean = 0.0 if abs(turn.mean_torque) < ROUNDING * turn.torque_amplitude else turn.mean_torque
    parts = [f"torque in the shaft {digits(mean, 3)} ± {digits(turn.torque_amplitude, 3)} N·m"]
    for follower, error in zip(turn.followers, turn.errors, strict=True):
        worst = max(error.low, error.high, key=lambda end: abs(end.value))
        unit = UNITS[follower.unit]
        size, at = digits(abs(worst.value) / unit.factor, 3), digits(degrees(worst.theta), 4)
        name = f"error of {follower.name}" if follower.name else "follower's error"
        parts.append(f"{name} {with_unit(size, unit.symbol)} at {at}°")
    return f"Steady response: {'; '.join(parts)}"


def needed_shaft_text(machine: Machine, eta: float, q: float) -> str:
    """Stiffness and inertia that move the machine to a point of the chart, at its speed and masses."""
    inertia, stiffness = machine.shaft_for(eta, q)
    rpm = machine.rpm(machine.eta)
    return (
        f"At {speed(rpm)} rpm, η = {short(eta)}, Q = {short(q)} needs {measure(stiffness, STIFFNESS, 5)} and "
        f"{measure(inertia, 'kg·m²')} at the cam"
    )


def machine_text(stability: Stability) -> str:
    """Speed and damping of the machine, and the speed up to which the chart is valid."""
    m = stability.machine
    top = f"; not checked above {speed(stability.top_rpm)} rpm" if isfinite(stability.top_rpm) else ""
    damping = f", ζ = {typed(m.damping)}" if m.damping else ""
    return f"{speed(m.rpm(m.eta))} rpm{damping}{top}"


# -- pages -----------------------------------------------------------------------------------------------

SPEEDS, VERDICTS = "Speeds", "Verdicts"
POINTS = 6000  # drawn points of a history
LEAST_WIDTH = 596  # of the table of verdicts, pixels
KILO = 10e3  # force from which the axis is in kN [N]
LAST_TURNS = 5.0  # of a history, drawn in the phase plane
TURN = 360.0
FOLLOWING = "Calculating 30 turns of the shaft from rest …"
SETTLING = "Calculating the steady response …"
AVERAGING = "Calculating the shaft from rest at many speeds …"


@dataclass
class ChartPoint:
    """A point of the chart with its results so far.

    ``is_machine``: the point of the machine. ``steady``: the steady response, None before it is computed, empty where
    there is none.
    """

    eta: float
    q: float
    is_machine: bool
    history: History | None = None
    verdicts: tuple[Verdict, ...] = ()
    steady: tuple[SteadyTurn, ...] | None = None


def steady_turns(stability: Stability, eta: float, q: float) -> tuple[SteadyTurn, ...]:
    """Return the steady response at a point; empty where there is none."""
    turn = stability.steady_turn_at(eta, q)
    return () if turn is None else (turn,)


class PagePlots(dict[str, tuple[XYPlot, ...]]):
    """Plots of each page by its name, created next to each other in its layout when they are first drawn."""

    def __init__(self, pages: Mapping[str, QHBoxLayout]) -> None:
        super().__init__()
        self._pages = pages

    def __missing__(self, name: str) -> tuple[XYPlot, ...]:
        plots = self[name] = tuple(XYPlot(across, upwards) for across, upwards in PLOTS[name].axes)
        fill(self._pages[name], *((plot, 1) for plot in plots))
        return plots


class StabilityPages(QTabWidget):
    """Pages with verdicts, speeds and plots, of which only the visible one is drawn.

    - result_requested (str): the visible page waits for this cached property of ``Stability``
    """

    result_requested = Signal(str)

    def __init__(self) -> None:
        super().__init__(documentMode=True)
        self.stability: Stability | None = None
        self.chosen: ChartPoint | None = None
        self._drawn: set[int] = set()
        self.verdicts, self.speeds = _text(), _text()
        # a line for each drive: it wraps, which the table above does not
        self.steady = QLabel(wordWrap=True, margin=8, textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse)
        self._in_paper = True
        self.addTab(self._speeds_page(), SPEEDS)
        self.addTab(_scrolled(self.verdicts, self.steady), VERDICTS)
        pages = {name: fill(QHBoxLayout(), margins=0, spacing=0) for name in PLOTS}
        self.plots = PagePlots(pages)
        for name, page in pages.items():
            self.addTab(widget_with(page), name)
        self.setMinimumWidth(max(LEAST_WIDTH, self.tabBar().sizeHint().width()))
        self.currentChanged.connect(self._draw)
        self.speed.entered.connect(self._show_needed)

    def _speeds_page(self) -> QScrollArea:
        """Page with the forbidden bands, and the stiffness that a speed needs."""
        self.speed = NumberBox(Info("Speed", low=0.0, high=1e5, open_low=True, step=10.0), UNITS["rpm"])
        self.needed = QLabel(wordWrap=True)
        self.needed.setMinimumWidth(1)
        row = fill(
            QHBoxLayout(),
            QLabel("To run at"),
            self.speed,
            UnitLabel(UNITS["rpm"]),
            (self.needed, 1),
            margins=(8, 6, 8, 0),
        )
        return _scrolled(row, self.speeds)

    # -- content --------------------------------------------------------------------------------------------

    def show_as_in_paper(self, on: bool) -> None:
        """Show all pages, or only those that answer a designer."""
        self._in_paper = on
        for index in range(self.count()):
            row = PLOTS.get(self.tabText(index))
            self.setTabVisible(index, on or (row is not None and not row.in_paper) or self.tabText(index) == SPEEDS)
        if not on:
            self.show_page(SPEEDS)
        self.redraw()

    def show_shaft(self, stability: Stability, point: ChartPoint) -> None:
        """Show another shaft, and the selected point of its chart."""
        self.stability = stability
        self.speed.show_value(round(stability.machine.rpm(stability.machine.eta), 6))
        self.show_point(point)

    def show_point(self, point: ChartPoint) -> None:
        """Show another point, or further results of the same point."""
        self.chosen = point
        self.redraw()

    def fade(self, on: bool) -> None:
        """Grey out the texts while new ones are calculated; the focus does not change."""
        for label in (self.verdicts, self.speeds, self.needed):
            label.setEnabled(not on)

    def redraw(self) -> None:
        """Draw the visible page again, and the others when they are shown."""
        self._drawn.clear()
        self._draw()

    @property
    def missing_result(self) -> str:
        """The cached property of ``Stability`` that the visible page waits for; empty where there is none."""
        row = PLOTS.get(self.tabText(self.currentIndex()))
        return (
            row.needs
            if row is not None and self.stability is not None and row.needs not in vars(self.stability)
            else ""
        )

    def show_page(self, name: str) -> None:
        """Show the page of this name."""
        self.setCurrentIndex([self.tabText(i) for i in range(self.count())].index(name))

    def _draw(self, *_: object) -> None:
        index = self.currentIndex()
        if self.stability is None or self.chosen is None or index in self._drawn:
            return
        self._drawn.add(index)
        name = self.tabText(index)
        if name == VERDICTS:
            self._show_verdicts(self.stability, self.chosen)
        elif name == SPEEDS:
            self._show_speeds(self.stability)
        else:
            self._show_plots(self.stability, self.chosen, name)

    def _show_plots(self, stability: Stability, point: ChartPoint, name: str) -> None:
        row = PLOTS[name]
        waits = WAITING[row.result](point) if row.result else AVERAGING if self.missing_result else ""
        if waits:
            for plot in self.plots[name]:
                plot.show_message(waits)
            if row.needs:
                self.result_requested.emit(row.needs)
        else:
            row.draw(self.plots[name], stability, point)

    def _show_verdicts(self, stability: Stability, point: ChartPoint) -> None:
        verdicts = point.verdicts or stability.linear_at(point.eta, point.q)
        position = "" if point.is_machine else "selected point, "
        wait = "" if point.verdicts else f"<p style='color:{SCREEN.quiet}'>Calculating the nonlinear models …</p>"
        self.verdicts.setText(
            f"<p>{position}η = {short(point.eta)}, Q = {short(point.q)}</p>{verdict_table(verdicts)}{wait}"
        )
        self.steady.setText(steady_text(point.steady[0]) if point.steady else "")
        self.steady.setVisible(bool(point.steady))

    def _show_speeds(self, stability: Stability) -> None:
        if "bands" in vars(stability):
            machine = stability.machine
            rows = stability.bands if self._in_paper else nearest_bands(stability, len(stability.bands))
            self.speeds.setText(bands_table(rows, machine.rpm(machine.eta), self._in_paper))
            if self.speed.value is not None:
                self._show_needed(self.speed.value)
        else:
            self.speeds.setText("Calculating the forbidden bands …")

    def _show_needed(self, rpm: float) -> None:
        if self.stability is not None:
            try:
                self.needed.setText(shaft_text(self.stability.stiffness_for(rpm)))
                coloured(self.needed, SCREEN.quiet)
            except NoStability as error:
                self.needed.setText(sentence(f"{error.problem}; {error.hint}"))
                coloured(self.needed, SCREEN.limit)


def _text() -> QLabel:
    label = QLabel(
        alignment=Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft,
        margin=8,
        textFormat=Qt.TextFormat.RichText,
        textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse,
    )
    return label


def _scrolled(*parts: QWidget | QHBoxLayout) -> QScrollArea:
    """Stack widgets and rows in an area that scrolls where it is too low."""
    paper = widget_with(fill(QVBoxLayout(), *parts, STRETCH, margins=0))
    area = QScrollArea(widgetResizable=True)
    area.setFrameShape(QScrollArea.Shape.NoFrame)
    area.setWidget(paper)
    return area


# -- plots --------------------------------------------------------------------------------------------------


def _samples(run: History, begin: float = 0.0) -> np.ndarray:
    return np.linspace(begin, run.ended, POINTS)


def _wind_up(plots: tuple[XYPlot, ...], stability: Stability, point: ChartPoint) -> None:
    run = _history(point)
    y = _samples(run)
    plots[0].show_lines([Line(y, TURN * run.at(y)[0], SCREEN.ink)], contact_marks(run))


def _phase(plots: tuple[XYPlot, ...], stability: Stability, point: ChartPoint) -> None:
    run = _history(point)
    beta, rate = run.at(_samples(run, max(0.0, run.ended - LAST_TURNS)))
    plots[0].show_lines([Line(TURN * beta, TURN * rate, SCREEN.ink)], square=True)


def _spectrum(plots: tuple[XYPlot, ...], stability: Stability, point: ChartPoint) -> None:
    order, size = _history(point).spectrum(max(12.0, 1.25 * point.eta))
    plots[0].show_lines([Line(order, TURN * size, VERMILION)])


def _contact(plots: tuple[XYPlot, ...], stability: Stability, point: ChartPoint) -> None:
    run = _history(point)
    if run.contact is None:
        plots[0].show_message("No contact force: the follower has no cam.")
        return
    y = _samples(run)
    unit = run.contact.unit * stability.machine.omega_at(run.eta) ** 2
    force = unit * run.forces(y)
    name, per = ("kN", 1e3) if np.abs(force).max() >= KILO else ("N", 1.0)
    plots[0].name_axes("Turns of the input", f"Force, {name}")
    drives = zip(force / per, run.contact.names, run.contact.numbers, strict=True)
    lines = [Line(y, f, SCREEN.drive(number) if name else SCREEN.ink, name) for f, name, number in drives]
    plots[0].show_lines(lines, contact_marks(run))


def _history(point: ChartPoint) -> History:
    assert point.history is not None
    return point.history


def _steady(plots: tuple[XYPlot, ...], stability: Stability, point: ChartPoint) -> None:
    if not point.steady:
        _no_response(plots)
        return
    wind_up, *errors = steady_plots(point.steady[0])
    plots[0].show_plot(wind_up)
    if not errors:
        plots[1].show_message("No follower is driven by a motion.")
    for plot, error in zip(plots[1:], errors, strict=False):  # of translating followers, and of oscillating ones
        plot.show_plot(error)
    plots[2].setVisible(len(errors) > 1)


def _harmonics(plots: tuple[XYPlot, ...], stability: Stability, point: ChartPoint) -> None:
    if point.steady:
        plots[0].show_plot(harmonics_plot(point.steady[0]))
    else:
        _no_response(plots)


def _no_response(plots: tuple[XYPlot, ...]) -> None:
    for plot in plots:
        plot.show_message("No steady response at this point.")


def _averages(plots: tuple[XYPlot, ...], stability: Stability, point: ChartPoint) -> None:
    for plot, drawn in zip(plots, averages_plots(stability.first_turn), strict=True):
        plot.show_plot(drawn)


def _terms(plots: tuple[XYPlot, ...], stability: Stability, point: ChartPoint) -> None:
    plots[0].show_plot(coefficients_plot(stability.coefficients))


@frozen
class StabilityPage:
    """A page of plots: the titles of their axes, and the function that draws them.

    ``result``: result of the point that the page shows, a key of ``WAITING``, or empty. ``needs``: cached property of
    ``Stability`` that the page shows, or empty. ``in_paper``: whether it is shown only as in the paper.
    """

    axes: tuple[tuple[str, str], ...]
    draw: Callable[[tuple[XYPlot, ...], Stability, ChartPoint], None]
    result: str = "history"
    needs: str = ""
    in_paper: bool = False


WAITING: Mapping[str, Callable[[ChartPoint], str]] = MappingProxyType(
    {
        "history": lambda point: FOLLOWING if point.history is None else "",
        "steady": lambda point: SETTLING if point.steady is None else "",
    }
)
"""Message of a page while its result is calculated; empty once it is known."""

PLOTS: Mapping[str, StabilityPage] = MappingProxyType(
    {
        "Wind-up": StabilityPage((("Turns of the input", "Twist, °"),), _wind_up),
        "Phase": StabilityPage((("Twist, °", "Rate, °/turn"),), _phase, in_paper=True),
        "Spectrum": StabilityPage((("Order, × shaft speed", "Twist, °"),), _spectrum, in_paper=True),
        "Contact": StabilityPage((("Turns of the input", "Force, N"),), _contact),
        "Steady": StabilityPage((("", ""), ("", ""), ("", "")), _steady, result="steady"),
        "Harmonics": StabilityPage((("", ""),), _harmonics, result="steady", in_paper=True),
        "Averages": StabilityPage((("", ""), ("", "")), _averages, result="", needs="first_turn", in_paper=True),
        "Terms": StabilityPage((("", ""),), _terms, result="", in_paper=True),
    }
)
