"""Pages below it."""

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
    steady_plots,
)
from kindyna_gui.forms.fields import UnitLabel
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import sentence
from kindyna_gui.look import coloured
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import SCREEN, VERMILION
from kindyna_gui.pictures.units import digits, with_unit

# -- point fields ----------------------------------------------------------------------------------------

MOST_ETA, MOST_Q = 60.0, 100.0  # as far as a point can be followed
DIGITS = 7  # of a speed or of the machine's own figures, which nobody typed


class PointFields(QWidget):
    """η, Q and rpm side by side, and a button back to the machine's own point.

    entered   (float, float): another η and Q was typed
    returned  the machine's own point is wanted
    """

    entered = Signal(float, float)
    returned = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.eta = NumberBox(Info("Frequency ratio η", low=0.0, high=MOST_ETA, open_low=True, step=0.01), NO_UNIT)
        self.q = NumberBox(Info("Inertia ratio Q", low=0.0, high=MOST_Q, step=0.01), NO_UNIT)
        self.rpm = NumberBox(Info("Speed", low=0.0, high=1e5, open_low=True, step=10.0), UNITS["rpm"])
        self.back = QPushButton("Machine's own")
        self.back.setToolTip("Choose the machine's own point again")
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
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
        self.eta.entered.connect(self._typed_eta)
        self.q.entered.connect(self._typed_q)
        self.rpm.entered.connect(self._typed_rpm)
        self.back.clicked.connect(self.returned)
        self.setEnabled(False)

    def show_point(self, machine: Machine, eta: float, q: float, own: bool) -> None:
        """Show a point of this machine's chart; what was typed and refused is forgotten."""
        self._machine, self._point = machine, (eta, q)
        self.eta.show_value(_rounded(eta) if own else eta)
        self.q.show_value(_rounded(q) if own else q)
        self.rpm.show_value(_rounded(machine.rpm(eta)))
        least = machine.rpm(MOST_ETA)
        limits = (
            (self.eta, f"above 0, up to {MOST_ETA:g}"),
            (self.q, f"0 ... {MOST_Q:g}"),
            (self.rpm, f"{least:.5g} rpm and more"),
        )
        for box, allowed in limits:
            box.setToolTip(f"Allowed: {allowed}")
        self.back.setEnabled(not own)
        self.setEnabled(True)

    def _typed_eta(self, value: float) -> None:
        self._take(self.eta, value, self._point[1])

    def _typed_q(self, value: float) -> None:
        self._take(self.q, self._point[0], value)

    def _typed_rpm(self, value: float) -> None:
        assert self._machine is not None
        self._take(self.rpm, self._machine.eta_at(value) if value > 0.0 else 0.0, self._point[1])

    def _take(self, box: NumberBox, eta: float, q: float) -> None:
        if 0.0 < eta <= MOST_ETA and 0.0 <= q <= MOST_Q:
            self.entered.emit(eta, q)
        else:
            box.set_refused(True)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _quiet(text: str) -> QLabel:
    label = QLabel(text)
    coloured(label, SCREEN.quiet)
    return label


# -- texts -----------------------------------------------------------------------------------------------

STEADY, FROM_REST = "steady", "from_rest"
WORDS = {"model", "verdict"}  # columns that hold no numbers
ROUNDING = 1e-9  # of a torque's amplitude: a mean below it is rounding
BRIEF = {APPROXIMATE: "approximate (22)", EXACT: "exact (21)"}


def percent(growth: float) -> str:
    """A logarithm of growth per turn as a share: ``2.3 % a turn``."""
    part = expm1(growth)
    return f"{digits(100.0 * part, 3)} % a turn" if part < 10.0 else f"×{digits(1.0 + part, 3)} a turn"


def speed(rpm: float, figures: int = 4) -> str:
    """A speed [rpm] for the reader, ∞ where nothing bounds it."""
    return digits(rpm, figures) if isfinite(rpm) else "∞"


def speeds(band: ForbiddenBand) -> str:
    """From lowest to highest, with as many figures as tell them apart."""
    for figures in range(4, 12):
        low, high = speed(band.rpm_lo, figures), speed(band.rpm_hi, figures)
        if low != high:
            break
    return f"{low} … {high}"


def tongue_of(found: Tongues, eta: float, row: int = 0) -> int | None:
    """The number of the tongue that holds an η; None between them."""
    for n, (low, high) in enumerate(found.edges[row], 1):
        if low <= eta <= high:
            return n
    return None


def point_text(eta: float, q: float, machine: Machine | None, verdicts: Sequence[Verdict], tongue: int | None) -> str:
    """One line for what is under the mouse."""
    at = f"η = {eta:.4g}, Q = {q:.4g}"
    if machine is not None:
        at += f", {speed(machine.rpm(eta))} rpm"
    place = f"tongue {tongue}" if tongue is not None else "between tongues"
    models = "; ".join(
        f"{BRIEF[v.model]} {'stable' if v.stable else f'grows {percent(v.growth)}'}"
        for v in verdicts
        if v.model in BRIEF
    )
    return f"{at}: {place}; {models}"


def waiting_text(verdicts: Sequence[Verdict], waiting: bool) -> str:
    """A line for each nonlinear model at what is under the mouse, as far as they have answered."""
    by_model = {verdict.model: verdict for verdict in verdicts}
    parts = [words(by_model[model]) for model, words in SLOW.items() if model in by_model]
    if waiting:
        parts.append("still computing …" if parts else "nonlinear models: computing …")
    return "\n".join(parts)


def _steady_words(verdict: Verdict) -> str:
    if verdict.stable is None:
        return "steady: no response found"
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


def _table(head: Sequence[str], rows: Sequence[str]) -> str:
    top = "".join(_cell(text, SCREEN.quiet, right=text not in WORDS) for text in head)
    return f'<table cellspacing="0" cellpadding="2"><tr>{top}</tr>{"".join(f"<tr>{row}</tr>" for row in rows)}</table>'


def verdict_table(verdicts: Sequence[Verdict]) -> str:
    """All models side by side. Where one of them finds that the follower leaves the cam, none is shown in green."""
    rows = []
    good = SCREEN.good if all(verdict.contact_lost is None for verdict in verdicts) else ""
    for verdict in verdicts:
        colour = {STABLE: good, UNSTABLE: SCREEN.limit, LOST: SCREEN.limit, UNKNOWN_VERDICT: SCREEN.quiet}[
            verdict.state
        ]
        growth = percent(verdict.growth) if verdict.stable is False and isfinite(verdict.growth) else "–"
        trace = f"{verdict.trace:.4f}" if isfinite(verdict.trace) else "–"
        largest = f"{360.0 * verdict.largest:.4g}°" if isfinite(verdict.largest) else "–"
        who = f"{verdict.leaving} " if verdict.leaving else ""
        lost = f"{who}at turn {verdict.contact_lost:.4g}" if verdict.contact_lost is not None else "–"
        rows.append(
            _cell(verdict.label)
            + _cell(verdict.state, colour)
            + "".join(_cell(text, right=True) for text in (growth, trace, largest, lost))
        )
    return _table(("model", "verdict", "grows", "trace", "largest twist", "off the cam"), rows)


def bands_table(rows: Sequence[ForbiddenBand], rpm: float) -> str:
    """The forbidden bands of speed, the one that holds the machine's speed in red."""
    lines = []
    for band in rows:
        colour = SCREEN.limit if band.contains(rpm) else ""
        cells = (
            str(band.n),
            speeds(band),
            f"{band.eta_lo:.5f} … {band.eta_hi:.5f}",
            percent(band.growth),
            f"{digits(band.rate, 3)} /s",
        )
        lines.append("".join(_cell(text, colour, right=True) for text in cells))
    if not lines:
        return "<p>No speed is forbidden.</p>"
    return _table(("tongue", "speeds, rpm", "η", "twist grows by", "rate"), lines)


def shaft_text(found: Stiffness) -> str:
    """What a wanted speed asks of the shaft."""
    if found.allowed:
        return f"{speed(found.rpm)} rpm: the present {digits(found.current, 5)} N·m/rad keeps clear of every band."
    softer = f" or at most {digits(found.softer, 5)}" if found.softer is not None else ""
    return (
        f"{speed(found.rpm)} rpm: at least {digits(found.stiffer, 5)} N·m/rad{softer}; "
        f"the present {digits(found.current, 5)} stands {'in' if found.inside else 'too near'} a band."
    )


def steady_text(turn: SteadyTurn) -> str:
    """What the steady response does to the shaft and to each follower."""
    mean = 0.0 if abs(turn.mean_torque) < ROUNDING * turn.torque_amplitude else turn.mean_torque
    parts = [f"torque in the shaft {digits(mean, 3)} ± {digits(turn.torque_amplitude, 3)} N·m"]
    for each, found in zip(turn.followers, turn.errors, strict=True):
        worst = max(found.low, found.high, key=lambda side: abs(side.value))
        unit = UNITS[each.unit]
        size, at = digits(abs(worst.value) / unit.factor, 3), digits(degrees(worst.theta), 4)
        name = f"error of {each.name}" if each.name else "follower's error"
        parts.append(f"{name} {with_unit(size, unit.symbol)} at {at}°")
    return f"Steady response: {'; '.join(parts)}"


def wanted_text(machine: Machine, eta: float, q: float) -> str:
    """The shaft that a point of the chart needs at the machine's own speed and masses."""
    inertia, stiffness = machine.shaft_for(eta, q)
    rpm = machine.rpm(machine.eta)
    return (
        f"At {speed(rpm)} rpm, η = {eta:.4g}, Q = {q:.4g} needs {digits(stiffness, 5)} N·m/rad and "
        f"{digits(inertia, 4)} kg·m² at the cam"
    )


def machine_text(found: Stability) -> str:
    """The machine in one line; the chart says its η and Q."""
    m = found.machine
    top = f"; above {speed(found.top_rpm)} rpm nothing holds" if isfinite(found.top_rpm) else ""
    damping = f", ζ = {m.damping:g}" if m.damping else ""
    return f"{speed(m.rpm(m.eta))} rpm{damping}{top}"


__all__ = [
    "bands_table", "machine_text", "percent", "point_text", "shaft_text", "speed", "steady_text", "tongue_of", "verdict_table",
    "waiting_text", "wanted_text",
]  # fmt: skip


# -- pages -----------------------------------------------------------------------------------------------

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
