"""The tables for readers: what each method takes to come within an error, by what KINDYNA takes to come within the same, cold
and warm; never in milliseconds, which are those of one machine."""

from __future__ import annotations

import math
import platform
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from pathlib import Path

from benchmarks.measuring import COLD, WARM, WINDOW, Row
from benchmarks.table import Kernel, kernels

from core.project.files import write_all

BEGIN, END = "<!-- make bench ARGS=--readme: begin -->", "<!-- make bench ARGS=--readme: end -->"
ERRORS = tuple(range(-3, -13, -1))  # powers of ten
SHORT = (-3, -6, -9, -12)
NOISE = 0.03  # of a ratio from one process to the next, however quiet the machine
REGIMES = (WARM, COLD)
NONE = "–"


def power(exponent: int) -> str:
    """10⁻⁶."""
    return f"10{str(exponent).translate(str.maketrans('-0123456789', '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'))}"


def size(value: float) -> str:
    """An error: its power of ten and a digit."""
    if value == 0.0:
        return "0"
    if not math.isfinite(value):
        return "no digit right"
    exponent = math.floor(math.log10(value) + 1e-12)
    digit = round(value / 10.0**exponent)
    return f"1·{power(exponent + 1)}" if digit == 10 else f"{digit}·{power(exponent)}"


@dataclass(frozen=True)
class Ratio:
    """A time by another, and by how much of itself it may differ in the next run."""

    value: float
    noise: float

    @property
    def alike(self) -> bool:
        """No difference that the next run is sure to show."""
        return abs(math.log(self.value)) <= math.log1p(2.0 * self.noise)

    @property
    def digits(self) -> str:
        """One digit, and a second where the noise leaves it: 0.4, 1.3, 12, 300."""
        return _rounded(self.value, self.noise)

    @property
    def words(self) -> str:
        """The same words for who wins and who loses."""
        times = _rounded(max(self.value, 1.0 / self.value), self.noise)
        if self.alike or times == "1":
            return "as fast"
        return f"{times} times {'faster' if self.value < 1.0 else 'slower'}"


def _rounded(value: float, noise: float) -> str:
    step = 10.0 ** math.floor(math.log10(value))
    if noise * value <= 0.05 * step:  # half a step of the second digit
        step /= 10.0
    shown = round(value / step) * step
    if math.floor(math.log10(shown) + 1e-9) > math.floor(math.log10(value)):
        step *= 10.0  # 0.097 is 0.1
    places = max(0, -math.floor(math.log10(step) + 1e-9))
    return f"{shown:.{places}f}"


@dataclass(frozen=True)
class Told:
    """The rows of one kernel at its usual size."""

    kernel: Kernel
    rows: Sequence[Row]

    @classmethod
    def of(cls, kernel: Kernel, rows: Sequence[Row]) -> Told:
        return cls(kernel, [r for r in rows if (r.kernel, r.n) == (kernel.name, kernel.usual)])

    @cached_property
    def rivals(self) -> list[str]:
        """Names of the methods that were measured, ours left out."""
        return [m.name for m in self.kernel.methods[1:] if any(r.method == m.name and not r.note for r in self.rows)]

    def of_method(self, name: str, regime: str) -> list[Row]:
        return [r for r in self.rows if (r.method, r.regime) == (name, regime) and not r.note]

    def quickest(self, name: str, regime: str, exponent: int) -> Row | None:
        """Of a method's settings the quickest that comes within an error."""
        able = [r for r in self.of_method(name, regime) if r.error <= 10.0**exponent]
        return min(able, key=lambda r: r.seconds, default=None)

    def ratio(self, name: str, regime: str, exponent: int) -> Ratio | None:
        """What it takes to come within an error by what we take; None where either does not."""
        theirs, ours = (self.quickest(n, regime, exponent) for n in (name, self.kernel.ours.name))
        if theirs is None or ours is None:
            return None
        return Ratio(theirs.seconds / ours.seconds, math.hypot(theirs.noise, ours.noise, NOISE))

    def changes(self, name: str) -> bool:
        """Whether it is another thing to be compared with us cold."""
        for exponent in ERRORS:
            warm, cold = (self.ratio(name, regime, exponent) for regime in REGIMES)
            if (
                warm
                and cold
                and abs(math.log(cold.value / warm.value)) > math.log1p(2.0 * math.hypot(warm.noise, cold.noise))
            ):
                return True
        return False

    def is_special(self, name: str) -> bool:
        return any(m.special for m in self.kernel.methods if m.name == name)

    def strongest(self, exponent: int, special: bool = True) -> tuple[str, str, Ratio] | None:
        """The rival, the regime and the ratio that are worst for us; special: of those too that were worked out for this one
        case. None where no rival comes within the error."""
        names = [name for name in self.rivals if special or not self.is_special(name)]
        regimes = {name: REGIMES if self.changes(name) else (WARM,) for name in names}
        found = [(name, regime, self.ratio(name, regime, exponent)) for name in names for regime in regimes[name]]
        return min([(n, r, q) for n, r, q in found if q], key=lambda f: f[2].value, default=None)

    def title(self, name: str) -> str:
        """A star for what was worked out for this one case."""
        return f"{name}*" if self.is_special(name) else name

    def least(self, name: str) -> float:
        return min(r.error for r in self.of_method(name, WARM))


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _head(cells: Sequence[str]) -> list[str]:
    return [_line(cells), "|" + "---|" * len(cells)]


def short(rows: Sequence[Row]) -> str:
    """Of each kernel the strongest rival at some errors, and whether it wins."""
    lines = _head(["kernel", "least error", *(f"within {power(e)}" for e in SHORT)])
    for kernel in kernels():
        told = Told.of(kernel, rows)
        if told.of_method(kernel.ours.name, WARM):
            cells = [_strongest(told, exponent) for exponent in SHORT]
            lines.append(_line([kernel.title, size(told.least(kernel.ours.name)), *cells]))
    return "\n".join(lines) + "\n"


def _strongest(told: Told, exponent: int) -> str:
    """The strongest rival; where that has a star, the strongest without one too."""
    found = [told.strongest(exponent), told.strongest(exponent, special=False)]
    texts = [
        f"{told.title(n)}{f', {r}' if told.changes(n) else ''}: {ratio.words}" for n, r, ratio in filter(None, found)
    ]
    return "; ".join(dict.fromkeys(texts)) or "no rival among those tried"


def markdown(rows: Sequence[Row], goals: str = "") -> str:
    """A line for each kernel; then for each kernel every method at every error, warm and cold; the window; the targets."""
    whole = (_whole(Told.of(kernel, rows)) for kernel in kernels())
    parts = [noise(rows), short(rows), *whole, _window(rows), goals]
    return "\n".join(part for part in parts if part)


def noise(rows: Sequence[Row]) -> str:
    """How still the machine was."""
    told = sorted(r.noise for r in rows if r.noise > 0.0 and r.kernel not in WINDOW)
    if not told:
        return ""
    half, most = (100.0 * v for v in (statistics.median(told), told[int(0.95 * (len(told) - 1))]))
    with_what = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    text = f"Noise of the run: at most {half:.1f} % for half of its times, at most {most:.0f} % for 95 in 100"
    return f"{text}; one thread, Python {platform.python_version()}, {with_what}.\n"


def _whole(told: Told) -> str:
    kernel, name = told.kernel, told.kernel.ours.name
    if not told.of_method(name, WARM):
        return ""
    count = "" if kernel.unit == "cam angles" else f", {kernel.usual} {kernel.unit}"
    lines = [
        f"## {kernel.title}",
        "",
        f"Input of every method: {kernel.handed}. Computed beforehand when warm: {kernel.warm}.",
        "",
    ]
    lines += _head([f"method{count}", "", "least error", *(power(e) for e in ERRORS)])
    lines.append(_line([name, "", size(told.least(name)), *_own(told)]))
    for method in kernel.methods[1:]:
        lacking = [r for r in told.rows if r.method == method.name and r.note]
        if lacking:
            lines.append(_line([method.name, lacking[0].note, *[NONE] * (1 + len(ERRORS))]))
        elif method.name in told.rivals:
            regimes = REGIMES if told.changes(method.name) else (WARM,)
            for i, regime in enumerate(regimes):
                first = ("", "") if i else (told.title(method.name), size(told.least(method.name)))
                lines.append(
                    _line([first[0], regime if len(regimes) > 1 else "", first[1], *_cells(told, method.name, regime)])
                )
    cold = _cold(told)
    return "\n".join(lines) + "\n" + (f"\n{cold}\n" if cold else "")


def _cells(told: Told, name: str, regime: str) -> list[str]:
    ratios = [told.ratio(name, regime, exponent) for exponent in ERRORS]
    return [NONE if ratio is None else ratio.digits for ratio in ratios]


def _own(told: Told) -> list[str]:
    """We by the quickest of our own settings."""
    name = told.kernel.ours.name
    quickest = min(told.of_method(name, WARM), key=lambda r: r.seconds)
    able = [told.quickest(name, WARM, exponent) for exponent in ERRORS]
    ratios = [
        None if r is None else Ratio(r.seconds / quickest.seconds, math.hypot(r.noise, quickest.noise, NOISE))
        for r in able
    ]
    return [NONE if ratio is None else "1" if ratio.alike else ratio.digits for ratio in ratios]


def _cold(told: Told) -> str:
    """What we ourselves take longer."""
    warm, cold = (told.of_method(told.kernel.ours.name, regime) for regime in REGIMES)
    if not warm or not cold:
        return ""
    ratio = Ratio(cold[0].seconds / warm[0].seconds, math.hypot(cold[0].noise, warm[0].noise, NOISE))
    return "" if ratio.alike else f"KINDYNA cold takes {ratio.value:.2g} times as long as warm."


def _window(rows: Sequence[Row]) -> str:
    """What the window takes by a bare repaint of the same widgets; nothing where it was not measured."""
    told = [r for r in rows if r.kernel in WINDOW]
    if not told:
        return ""
    text = (
        "Processor time of the window's thread, divided by that of a bare repaint of the same widgets; for the start, that of the"
        " whole process, divided by that of an empty window. Work of other threads is not included, nor work that waits until"
        " editing pauses, which has its own row. *Targets* gives milliseconds."
    )
    lines = ["## In the window", "", text, ""]
    lines += _head(["what", "plots next to the drawing", "time"])
    for row in told:
        ratio = Ratio(row.times_bare, max(NOISE, row.noise))
        lines.append(_line([f"{row.kernel}: {row.method}", str(row.n or ""), ratio.digits]))
    return "\n".join(lines) + "\n"


def into_page(path: Path, table: str) -> None:
    """The table between its two markers, which must stand in the file."""
    text = path.read_text(encoding="utf-8")
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise SystemExit(f"{path}: no place for the table: the lines {BEGIN} and {END} are missing")
    write_all(path.parent, {path.name: f"{before}{BEGIN}\n{table}{END}{after}"})
