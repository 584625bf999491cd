"""The table for readers: each kernel's alternatives by the time KINDYNA takes and the error it makes, never in
milliseconds, which are those of one machine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from benchmarks.measuring import WINDOW, Row
from benchmarks.table import kernels

from core.project.files import write_all

BEGIN, END = "<!-- make bench ARGS=--readme: begin -->", "<!-- make bench ARGS=--readme: end -->"
AS_GOOD = 4.0  # an error up to so many times ours counts as the same
NOT_SHORT = ("monodromy",)  # beside the tongues, which it gives where there is damping
NOISE = 1.05  # times nearer than this are the same


def _power(value: float) -> str:
    if value == 0.0:
        return "0"
    if not math.isfinite(value):
        return "no digit right"
    digits = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    exponent = math.floor(math.log10(value))
    return f"{value / 10.0**exponent:.1f}·10{str(exponent).translate(digits)}"


def times(ratio: float) -> str:
    """Two digits: ×0.85, ×3.2, ×320, ×6800."""
    size = 10.0 ** (1 - math.floor(math.log10(ratio)))
    shown = round(ratio * size) / size
    return f"×{shown:.0f}" if shown >= 10.0 else f"×{shown:.2g}"


def best(rows: Sequence[Row]) -> Row:
    """Of a method's settings the one of least error; of those about as good the quickest."""
    least = min(row.error for row in rows)
    return min((r for r in rows if r.error <= AS_GOOD * least), key=lambda r: r.seconds)


def beside(row: Row, ours: Sequence[Row]) -> Row:
    """Of our settings the quickest that is as accurate as the row; where none is, the most accurate."""
    as_good = [r for r in ours if r.error <= row.error]
    return min(as_good, key=lambda r: r.seconds) if as_good else best(ours)


def verdict(row: Row, ours: Row) -> str:
    """What the row means: whether we lose, and to what."""
    as_good, ratio = row.error <= AS_GOOD * ours.error, row.seconds / ours.seconds
    if as_good and ratio * NOISE < 1.0:
        return f"KINDYNA is slower by {times(1.0 / ratio)}"
    if as_good and ratio <= NOISE:
        return "as fast, as accurate"
    if as_good:
        return "as accurate"
    if ratio < 1.0:
        return "faster, less accurate"
    return ""


def markdown(rows: Sequence[Row]) -> str:
    """One line per kernel and method, each in its most accurate setting, beside ours of the same error or less; where
    ours has settings, a line for each."""
    lines = [
        "| kernel | method | time by KINDYNA's | true error | |",
        "|---|---|---|---|---|",
    ]
    for kernel in kernels():
        usual = [r for r in rows if r.kernel == kernel.name and r.n == kernel.usual]
        ours = [r for r in usual if r.method == kernel.ours.name]
        title = kernel.title
        for method in kernel.methods:
            told = [r for r in usual if r.method == method.name]
            if told and told[0].note:
                lines.append(f"| {title} | {method.name} | | | {told[0].note} |")
            for row in () if not told or told[0].note else told if method.ours else [best(told)]:
                setting = f", {method.knob} {row.setting}" if row.setting else ""
                by = ours[0] if method.ours else beside(row, ours)
                note = "" if method.ours else verdict(row, by)
                ratio, error = times(row.seconds / by.seconds), _power(row.error)
                lines.append(f"| {title} | {method.name}{setting} | {ratio} | {error} | {note} |")
                title = ""
            title = ""
    return "\n".join(lines) + "\n" + _window(rows)


def short(rows: Sequence[Row]) -> str:
    """Ten lines: of each kernel the strongest alternative, the quickest that is as accurate as ours, else the most accurate."""
    lines = ["| kernel | KINDYNA's error | strongest alternative | time by KINDYNA's | its error | |", "|---|---|---|---|---|---|"]
    for kernel in [k for k in kernels() if k.name not in NOT_SHORT]:
        usual = [r for r in rows if r.kernel == kernel.name and r.n == kernel.usual and not r.note]
        ours = [r for r in usual if r.method == kernel.ours.name]
        others = [r for r in usual if r.method != kernel.ours.name]
        if not ours or not others:
            continue
        as_good = [r for r in others if r.error <= AS_GOOD * beside(r, ours).error]
        row = min(as_good, key=lambda r: r.seconds / beside(r, ours).seconds) if as_good else best(others)
        by = beside(row, ours)
        knob = next(method.knob for method in kernel.methods if method.name == row.method)
        setting = f", {knob} {row.setting}" if row.setting else ""
        ratio = times(row.seconds / by.seconds)
        error, other = _power(by.error), f"{row.method}{setting}"
        lines.append(f"| {kernel.title} | {error} | {other} | {ratio} | {_power(row.error)} | {verdict(row, by)} |")
    return "\n".join(lines) + "\n"


def _window(rows: Sequence[Row]) -> str:
    """What the window takes by a bare repaint of the same widgets; nothing where it was not measured."""
    told = [r for r in rows if r.kernel in WINDOW]
    if not told:
        return ""
    lines = ["", "| in the window | plots beside the drawing | time by a bare repaint of the same widgets |", "|---|---|---|"]
    lines += [f"| {r.kernel}: {r.method} | {r.n or ''} | {times(r.times_yardstick)} |" for r in told]
    return "\n".join(lines) + "\n"


def into_page(path: Path, table: str) -> None:
    """The table between its two markers, which must stand in the file."""
    text = path.read_text(encoding="utf-8")
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise SystemExit(f"{path}: no place for the table: the lines {BEGIN} and {END} are missing")
    write_all(path.parent, {path.name: f"{before}{BEGIN}\n{table}{END}{after}"})
