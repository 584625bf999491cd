"""What the page of stability says in words and small tables; no widget of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from html import escape
from math import degrees, expm1, isfinite
from types import MappingProxyType

from core.design import UNITS
from core.stability import (
    APPROXIMATE,
    EXACT,
    LOST,
    STABLE,
    UNKNOWN_VERDICT,
    UNSTABLE,
    ForbiddenBand,
    Machine,
    Stability,
    SteadyTurn,
    Stiffness,
    Tongues,
    Verdict,
)
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import digits, with_unit

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
