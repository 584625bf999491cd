"""One statement of a paper against the numbers that come out here; its verdict follows from these numbers alone."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from functools import cached_property
from math import isfinite, isnan
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from core.design import Design
from core.frozen import frozen
from core.plot import Figure, Plot, PlotCurve
from core.process import resources
from core.project import load
from core.study import Camshaft, Study

if TYPE_CHECKING:
    from core.stability import Chart


# -- the example files that the claims and figures of the papers are computed of, each studied once -------------


SAMPLES = 720  # of a turn
NONE: Mapping[str, Design] = MappingProxyType({})


class Examples:
    """Studies of the examples by the names of their files; ``designs``: others in their places."""

    def __init__(self, designs: Mapping[str, Design] = NONE) -> None:
        self._designs = dict(designs)
        self._made: dict[Hashable, Any] = {}

    def design(self, name: str) -> Design:
        if name not in self._designs:
            self._designs[name] = load(resources() / "examples" / f"{name}.toml")
        return self._designs[name]

    def study(self, name: str) -> Study:
        """Of a design."""
        study: Study = self.once(("study", name), lambda: Study(self.design(name), SAMPLES))
        return study

    def shaft(self, name: str) -> Camshaft[Study]:
        """What all drives of a design do together."""
        return self.study(name).camshaft

    @property
    def made(self) -> frozenset[Hashable]:
        """The keys of what is there already."""
        return frozenset(self._made)

    def once(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """What several claims need, made for the first of them."""
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]


# -- A figure or table of a paper -------------------------------------------------------------------------------


Column: TypeAlias = "np.ndarray | tuple[str, ...]"


@frozen(eq=False)
class FigureTable:
    """Columns of numbers or of words, all as long as each other; ``title`` stands above it where it is painted."""

    names: tuple[str, ...]
    columns: tuple[Column, ...]
    title: str = ""

    @property
    def rows(self) -> Iterator[tuple[Any, ...]]:
        return zip(*(column if isinstance(column, tuple) else column.tolist() for column in self.columns), strict=True)


@frozen(eq=False)
class MechanismPicture:
    """A mechanism at one angle of its cam or crank [deg], with layers of its drawing, and without some that are usual; step: of the
    circle diagram."""

    study: Study
    angle_deg: float
    layers: tuple[str, ...] = ()
    step: int | None = None
    title: str = ""
    without: tuple[str, ...] = ()


@frozen(eq=False)
class MechanismRow:
    """Mechanisms beside each other, each under its own title, in rows of so many."""

    posed: tuple[MechanismPicture, ...]
    columns: int
    title: str = ""


@frozen(eq=False)
class Polygon:
    """The velocity polygon of a mechanism at one angle [deg]."""

    study: Study
    angle_deg: float
    title: str = ""


@frozen(eq=False)
class ShaftPicture:
    """All drives of a shaft at one machine angle [deg]."""

    study: Camshaft[Study]
    angle_deg: float
    title: str = ""


Drawing: TypeAlias = "FigureTable | Figure | Chart | MechanismPicture | MechanismRow | Polygon | ShaftPicture"


@frozen(eq=False)
class PaperFigure:
    """One figure or table.

    name      of its files; title, above its picture
    table     its numbers
    drawing   what is painted; None: the table
    """

    name: str
    title: str
    table: Callable[[Examples], FigureTable]
    drawing: Callable[[Examples], Drawing] | None = None


CAM_ANGLE = "Cam angle, °"


class PlotLine(NamedTuple):
    """A column of a table as a line of a plot."""

    column: str
    label: str = ""
    dashed: bool = False
    family: str = ""


class Lines(NamedTuple):
    """A plot of columns by the first one, closed at 360°; what is not there has no line, and a plot without one is left out."""

    axis: str
    lines: tuple[PlotLine, ...]
    quiet: bool = False
    fit: bool = False


Columns: TypeAlias = "Mapping[str, np.ndarray]"
Marks: TypeAlias = "tuple[tuple[float, str], ...]"


def closed(column: np.ndarray) -> np.ndarray:
    """A column (n,) over one turn with its first value at the end (n + 1,)."""
    return np.append(column, column[:1])


def by_angle(columns: Columns, plots: Iterable[Lines], marks: Marks = ()) -> tuple[Plot, ...]:
    """The plots of some columns, of which the first is the cam angle [deg]; marks: of the first plot."""
    degrees = np.append(next(iter(columns.values())), 360.0)
    made: list[Plot] = []
    for each in plots:
        there = [line for line in each.lines if line.column in columns]
        curves = tuple(
            PlotCurve(degrees, closed(columns[line.column]), line.label, i, line.dashed, line.family)
            for i, line in enumerate(there)
        )
        if curves:
            made.append(Plot(CAM_ANGLE, each.axis, curves, () if made else marks, quiet=each.quiet, fit=each.fit))
    return tuple(made)


def plotted(
    name: str, title: str, table: Callable[[Examples], FigureTable], plots: Callable[[Examples], tuple[Plot, ...]]
) -> PaperFigure:
    """Of plots."""
    return PaperFigure(name, title, table, lambda examples: Figure(name, title, plots(examples)))


def of_columns(name: str, title: str, columns: Callable[[Examples], Columns], *plots: Lines) -> PaperFigure:
    """Whose columns are its table and its plots."""
    return plotted(name, title, lambda e: table_by_column(columns(e)), lambda e: by_angle(columns(e), plots))


def table_by_column(columns: Columns) -> FigureTable:
    """A table of columns, name -> values."""
    return FigureTable(tuple(columns), tuple(columns.values()))


def posed_sheet(
    name: str,
    title: str,
    example: str,
    angle_deg: float,
    table: Callable[[Examples], FigureTable],
    *layers: str,
    step: int | None = None,
    without: tuple[str, ...] = (),
) -> PaperFigure:
    """Of an example at one angle."""
    return PaperFigure(
        name,
        title,
        table,
        lambda examples: MechanismPicture(examples.study(example), angle_deg, layers, step, title, without),
    )


WORDS = {
    "printed": "off as printed", "corrected": "off as corrected", "off": "off", "bound": "may be off by", "eta": "η",
    "used": "off where it is used", "elsewhere": "off elsewhere", "in_doubles": "in doubles, °",
    "numerators": "numerator of the tangent of half the angle, root", "denominator": "its denominator", "ours": "angle here, °",
    "weight": "μW, N", "rubbed": "largest μ|N|, N", "fitted": "columns that make the motion", "columns": "columns", "rows": "rows",
    "velocity_off": "velocity off, mm/s", "acceleration_off": "acceleration off, mm/s²",
    "velocity_jump": "largest jump of velocity, of its largest", "acceleration_jump": "largest jump of acceleration, of its largest",
    "constant": "constant acceleration, mm/°²", "span": "over a span of, °", "crank_pin": "crank pin's velocity, cm/s",
    "own": "link 3 of the example, cm", "asked": "link 3 for a rocker at 60°, cm", "rocker": "rocker with link 3 as printed, °",
    "omega_3": "ω3 with link 3 as printed, rpm", "own_omega_3": "ω3 of the example, rpm", "symbol": "symbol as printed",
    "needed": "what belongs there", "known": "value of", "factor": "a of the softest spring", "times": "1/X'm², 1/m²",
    "acceleration": "largest acceleration a thousandth above the lower end, mm/°²",
    "errors": "findings that are errors", "cutter": "largest cutter radius, mm", "gap": "profile's ends apart, mm", "kept": "proofs kept",
    "proofs": "proofs",
}  # fmt: skip
"""Names of numbers -> what they are, with their unit, where the table of a claim is of these."""


def table_of(numbers: Mapping[str, Any], title: str = "") -> FigureTable:
    """The numbers of a claim, one a line; parts of tuples and arrays are numbered from 1."""
    rows = [row for name, value in numbers.items() for row in _lines(WORDS.get(name, name.replace("_", " ")), value)]
    return FigureTable(
        ("quantity", "value"), tuple(tuple(str(part) for part in column) for column in zip(*rows, strict=True)), title
    )


def _lines(name: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        for part, each in value._asdict().items():
            yield from _lines(f"{name}, {part}", each)
    elif isinstance(value, Mapping):
        for part, each in value.items():
            yield from _lines(f"{name}, {part}", each)
    elif isinstance(value, np.ndarray | list | tuple):
        for i, each in enumerate(value, 1):
            yield from _lines(f"{name} {i}", each)
    elif hasattr(value, "__dataclass_fields__"):
        for part in value.__dataclass_fields__:
            yield from _lines(f"{name}, {part}", getattr(value, part))
    elif isinstance(value, float | np.floating):
        yield name, repr(float(value)) if isfinite(value) else "infinite"
    else:
        yield name, "" if value is None else str(value)


# -- one statement of a paper against the numbers that come out here --------------------------------------------


AGREES, DIFFERS, MISPRINT, METHOD, CONVENTION = "agrees", "differs", "misprint", "method", "convention"
LIMIT, ROUNDED, CONTRADICTION, AS_SCANNED = "limit", "rounded", "contradiction", "as-scanned"
VERDICTS: Mapping[str, str] = MappingProxyType({
    AGREES: "what comes out here is what the paper says",
    DIFFERS: "what comes out here is something else",
    MISPRINT: "wrong as the text reads",
    METHOD: "an error of the authors' reasoning",
    CONVENTION: "right in its own convention of signs",
    LIMIT: "right where it is used, singular or approximate elsewhere",
    ROUNDED: "right but for the digits that are printed or carried",
    CONTRADICTION: "the paper against itself",
    AS_SCANNED: "wrong as the text reads, in dots, primes, indices, ρ or j that the scan may have lost",
})  # fmt: skip
"""Kind of verdict -> what it means."""

Numbers = Mapping[str, Any]
Judgement = tuple[str, str]
"""Verdict and sentence."""
Judge = Callable[..., Judgement]


@frozen(eq=False)
class Row:
    """One row of a paper's table.

    where, says  the place and what stands there
    numbers      what is computed of the examples: all that verdict and sentence depend on
    judge        plain function of these numbers
    example      the file that it is about
    sheet        the figure or table that it belongs to; None: its own numbers are the table
    """

    where: str
    says: str
    numbers: Callable[[Examples], Numbers]
    judge: Judge
    example: str
    sheet: PaperFigure | None = None


@frozen(eq=False)
class Claim:
    """A row of a paper with the examples that it is computed of, each part when it is read."""

    paper: str
    row: Row
    examples: Examples
    given: Numbers | None = None

    @property
    def where(self) -> str:
        return self.row.where

    @property
    def says(self) -> str:
        return self.row.says

    @property
    def judge(self) -> Judge:
        return self.row.judge

    @cached_property
    def numbers(self) -> Numbers:
        if self.given is not None:
            return self.given
        made: Numbers = self.examples.once((self.paper, self.where), lambda: self.row.numbers(self.examples))
        return made

    @cached_property
    def judgement(self) -> Judgement:
        return self.row.judge(**self.numbers)

    @property
    def verdict(self) -> str:
        """Whether that is the same."""
        return self.judgement[0]

    @property
    def here(self) -> str:
        """What comes out here, in words."""
        return self.judgement[1]

    # -- its figure or table --------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """Of its files."""
        return slug(self.where) if self.row.sheet is None else self.row.sheet.name

    @property
    def title(self) -> str:
        return f"{self.where}: {self.says}" if self.row.sheet is None else self.row.sheet.title

    @cached_property
    def table(self) -> FigureTable:
        return table_of(self.numbers, self.title) if self.row.sheet is None else self.row.sheet.table(self.examples)

    @cached_property
    def drawing(self) -> Drawing:
        """What is painted: the table itself where there is nothing else."""
        if self.row.sheet is None or self.row.sheet.drawing is None:
            return self.table
        return self.row.sheet.drawing(self.examples)


def slug(where: str) -> str:
    """``(18)`` -> ``eq_18``; ``Table 2, I_L`` -> ``table_2_i_l``."""
    text = where.replace("→", "to").replace("§", "section ")
    text = f"eq {text}" if text.startswith("(") else text
    return re.sub(r"\W+", "_", text.lower()).strip("_")


# -- what a verdict is made of ------------------------------------------------------------------------------


class ComparedNumber(NamedTuple):
    """A number as printed and as it comes out here, how far apart they may be, and how far where the print is rounded on the way."""

    printed: float
    here: float
    within: float
    unit: str = ""
    rounded: float = 0.0

    @property
    def apart(self) -> float:
        return abs(self.here - self.printed)

    @property
    def same(self) -> bool:
        return self.apart <= self.within


def agreement(kept: object) -> str:
    """The word for a statement that is kept, or is not."""
    return AGREES if kept else DIFFERS


def parted(kind: str, wrong_as_printed: bool, wrong_as_corrected: bool) -> str:
    """Of this kind where the print is wrong and what should stand there is not."""
    if not wrong_as_printed:
        return AGREES
    return DIFFERS if wrong_as_corrected else kind


def as_printed(**rows: ComparedNumber) -> Judgement:
    """Agrees where every number is the printed one; rounded where some are so but for a rounding on the way."""
    parts = [f"{name} = {_figure(row.here)}{row.unit and ' ' + row.unit}" for name, row in rows.items()]
    apart = {name: row for name, row in rows.items() if not row.same}
    rounded = all(row.apart <= row.rounded for row in apart.values())
    verdict = AGREES if not apart else ROUNDED if rounded else DIFFERS
    words = ", ".join(f"{name} is printed {_figure(row.printed)}" for name, row in apart.items())
    return verdict, ", ".join(parts) + (f"; {'rounded on the way,' if rounded else 'but'} {words}" if apart else "")


def kept(sentence: str) -> Judge:
    """Agrees where ``off`` is not above ``bound``; the sentence is filled with the numbers."""

    def judge(off: float, bound: float, **more: Any) -> Judgement:
        return agreement(off <= bound), sentence.format(off=off, bound=bound, **more)

    return judge


def mended(kind: str, sentence: str) -> Judge:
    """Of this kind where the print is off by more than ``bound`` and what should stand there is not: ``printed`` and ``corrected`` say by
    how much."""

    def judge(printed: float, corrected: float, bound: float, **more: Any) -> Judgement:
        verdict = parted(kind, not printed <= bound, not corrected <= bound)
        return verdict, sentence.format(printed=printed, corrected=corrected, bound=bound, **more)

    return judge


def limited(sentence: str) -> Judge:
    """A limit where the print is off by no more than ``bound`` as it is ``used``, and by more ``elsewhere``."""

    def judge(used: float, elsewhere: float, bound: float, **more: Any) -> Judgement:
        verdict = parted(LIMIT, not max(used, elsewhere) <= bound, not used <= bound)
        return verdict, sentence.format(used=used, elsewhere=elsewhere, bound=bound, **more)

    return judge


def named(kind: str, sentence: str) -> Judge:
    """Of this kind where the printed ``symbol`` is not that of the quantity that belongs there, ``needed``: of those in ``known``,
    symbol -> value, one must be that within ``bound`` of it."""

    def judge(symbol: str, needed: float, known: Mapping[str, float], bound: float, **more: Any) -> Judgement:
        fitting = [each for each, value in known.items() if abs(needed / value - 1.0) <= bound]
        verdict = parted(kind, symbol not in fitting, not fitting)
        return verdict, sentence.format(symbol=symbol, needed=needed, fitting=" or ".join(fitting) or "nothing", **more)

    return judge


def _figure(value: float) -> str:
    return "nothing" if isnan(value) else f"{value:.10g}"
