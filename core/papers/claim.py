"""A statement of a paper and the numbers computed here; its verdict is a function of these numbers."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from functools import cached_property
from math import isfinite, isnan
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, TypeVar, cast

import numpy as np

from core.design import Design
from core.frozen import frozen
from core.plot import Figure, Plot, PlotCurve
from core.process import resources
from core.project import load
from core.study import Camshaft, Study

if TYPE_CHECKING:
    from core.stability import Chart


# -- example files, each studied once ---------------------------------------------------------------------------

T = TypeVar("T")

SAMPLES = 720  # of a turn
NONE: Mapping[str, Design] = MappingProxyType({})


class Examples:
    """Studies of the examples by the names of their files; ``designs`` replaces some of these."""

    def __init__(self, designs: Mapping[str, Design] = NONE) -> None:
        self._designs = dict(designs)
        self._cache: dict[Hashable, Any] = {}

    def design(self, name: str) -> Design:
        """Design of an example."""
        if name not in self._designs:
            self._designs[name] = load(resources() / "examples" / f"{name}.toml")
        return self._designs[name]

    def study(self, name: str) -> Study:
        """Study of an example."""
        return self.once(("study", name), lambda: Study(self.design(name), SAMPLES))

    def shaft(self, name: str) -> Camshaft[Study]:
        """Camshaft of an example with all its drives."""
        return self.study(name).camshaft

    @property
    def cached_keys(self) -> frozenset[Hashable]:
        """Keys of the results that are already computed."""
        return frozenset(self._cache)

    def once(self, key: Hashable, compute: Callable[[], T]) -> T:
        """Result that several claims share, computed at its first use."""
        if key not in self._cache:
            self._cache[key] = compute()
        return cast("T", self._cache[key])


# -- figures and tables of a paper ------------------------------------------------------------------------------


Column: TypeAlias = "np.ndarray | tuple[str, ...]"


@frozen(eq=False)
class FigureTable:
    """Columns of numbers or words of equal length; ``title`` is its heading in an image."""

    names: tuple[str, ...]
    columns: tuple[Column, ...]
    title: str = ""

    @property
    def rows(self) -> Iterator[tuple[Any, ...]]:
        """Rows of the table."""
        return zip(*(column if isinstance(column, tuple) else column.tolist() for column in self.columns), strict=True)


@frozen(eq=False)
class MechanismPicture:
    """A mechanism at one angle of its cam or crank [deg].

    Attributes
    ----------
    study : Study
    angle_deg : float
    layers : tuple of str
        Additional layers of the drawing.
    step : int or None
        Step of the circle diagram.
    title : str
    without : tuple of str
        Default layers that are left out.
    """

    study: Study
    angle_deg: float
    layers: tuple[str, ...] = ()
    step: int | None = None
    title: str = ""
    without: tuple[str, ...] = ()


@frozen(eq=False)
class MechanismRow:
    """Mechanisms in rows of ``columns``, each below its own title."""

    mechanisms: tuple[MechanismPicture, ...]
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
    """A figure or table of a paper.

    Attributes
    ----------
    name : str
        Name of its files.
    title : str
        Heading of its image.
    table : callable
        Its numbers, from the examples.
    drawing : callable or None
        Its image, from the examples; None: the table.
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
    """A plot of columns by the first one, closed at 360°; columns that do not exist are left out, and so is an empty plot."""

    axis: str
    lines: tuple[PlotLine, ...]
    quiet: bool = False
    fit: bool = False


Columns: TypeAlias = "Mapping[str, np.ndarray]"
Marks: TypeAlias = "tuple[tuple[float, str], ...]"


def closed(column: np.ndarray) -> np.ndarray:
    """Append the first value of a column over one turn to its end.

    Parameters
    ----------
    column : ndarray (n,), dimensionless
        The result has its unit.

    Returns
    -------
    ndarray (n + 1,), dimensionless
    """
    return np.append(column, column[:1])


def relative_error(value: np.ndarray, true: np.ndarray) -> float:
    """Largest difference relative to the largest true value.

    Parameters
    ----------
    value, true : ndarray (n,), dimensionless
        Of the same unit.
    """
    return float(np.abs(value - true).max() / np.abs(true).max())


def by_angle(columns: Columns, plots: Iterable[Lines], marks: Marks = ()) -> tuple[Plot, ...]:
    """Plots of columns over the first one, the cam angle [deg]; marks: of the first plot."""
    degrees = np.append(next(iter(columns.values())), 360.0)
    result: list[Plot] = []
    for plot in plots:
        present = [line for line in plot.lines if line.column in columns]
        curves = tuple(
            PlotCurve(degrees, closed(columns[line.column]), line.label, i, line.dashed, line.family)
            for i, line in enumerate(present)
        )
        if curves:
            result.append(Plot(CAM_ANGLE, plot.axis, curves, () if result else marks, quiet=plot.quiet, fit=plot.fit))
    return tuple(result)


def plot_figure(
    name: str, title: str, table: Callable[[Examples], FigureTable], plots: Callable[[Examples], tuple[Plot, ...]]
) -> PaperFigure:
    """Figure of plots."""
    return PaperFigure(name, title, table, lambda examples: Figure(name, title, plots(examples)))


def column_figure(name: str, title: str, columns: Callable[[Examples], Columns], *plots: Lines) -> PaperFigure:
    """Figure whose columns are both its table and its plots."""
    return plot_figure(name, title, lambda e: table_by_column(columns(e)), lambda e: by_angle(columns(e), plots))


def table_by_column(columns: Columns) -> FigureTable:
    """Table of columns, name -> values."""
    return FigureTable(tuple(columns), tuple(columns.values()))


def mechanism_figure(
    name: str,
    title: str,
    example: str,
    angle_deg: float,
    table: Callable[[Examples], FigureTable],
    *layers: str,
    step: int | None = None,
    without: tuple[str, ...] = (),
) -> PaperFigure:
    """Figure of an example's mechanism at one angle."""
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
    "weight": "μW, N", "friction": "largest μ|N|, N", "fitted": "columns that make the motion", "columns": "columns", "rows": "rows",
    "velocity_off": "velocity off, mm/s", "acceleration_off": "acceleration off, mm/s²",
    "velocity_jump": "largest jump of velocity, of its largest", "acceleration_jump": "largest jump of acceleration, of its largest",
    "constant": "constant acceleration, mm/°²", "span": "over a span of, °", "crank_pin": "crank pin's velocity, cm/s",
    "own": "link 3 of the example, cm", "required": "link 3 for a rocker at 60°, cm",
    "rocker": "rocker with link 3 as printed, °",
    "omega_3": "ω3 with link 3 as printed, rpm", "own_omega_3": "ω3 of the example, rpm", "symbol": "symbol as printed",
    "needed": "what belongs there", "known": "value of", "factor": "a of the softest spring", "times": "1/X'm², 1/m²",
    "acceleration": "largest acceleration a thousandth above the lower end, mm/°²",
    "errors": "findings that are errors", "cutter": "largest cutter radius, mm", "gap": "distance of the profile's ends, mm",
    "passed": "proofs satisfied", "proofs": "proofs",
}  # fmt: skip
"""Names of numbers -> title with unit, in the table of a claim's numbers."""


def numbers_table(numbers: Mapping[str, Any], title: str = "") -> FigureTable:
    """Table of a claim's numbers, one in each line; parts of tuples and arrays are numbered from 1."""
    rows = [row for name, value in numbers.items() for row in _lines(WORDS.get(name, name.replace("_", " ")), value)]
    return FigureTable(
        ("quantity", "value"), tuple(tuple(str(part) for part in column) for column in zip(*rows, strict=True)), title
    )


def _lines(name: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        for part, content in value._asdict().items():
            yield from _lines(f"{name}, {part}", content)
    elif isinstance(value, Mapping):
        for part, content in value.items():
            yield from _lines(f"{name}, {part}", content)
    elif isinstance(value, np.ndarray | list | tuple):
        for i, content in enumerate(value, 1):
            yield from _lines(f"{name} {i}", content)
    elif hasattr(value, "__dataclass_fields__"):
        for part in value.__dataclass_fields__:
            yield from _lines(f"{name}, {part}", getattr(value, part))
    elif isinstance(value, float | np.floating):
        yield name, repr(float(value)) if isfinite(value) else "infinite"
    else:
        yield name, "" if value is None else str(value)


# -- claims and verdicts ----------------------------------------------------------------------------------------

AGREES, DIFFERS, MISPRINT, METHOD, CONVENTION = "agrees", "differs", "misprint", "method", "convention"
LIMIT, ROUNDED, CONTRADICTION, AS_SCANNED = "limit", "rounded", "contradiction", "as-scanned"
VERDICTS: Mapping[str, str] = MappingProxyType({
    AGREES: "KINDYNA's result is that of the paper",
    DIFFERS: "KINDYNA's result is different",
    MISPRINT: "the printed text is wrong",
    METHOD: "an error of the authors' reasoning",
    CONVENTION: "right in its own convention of signs",
    LIMIT: "right where it is used, singular or approximate elsewhere",
    ROUNDED: "right except for printed or intermediate digits",
    CONTRADICTION: "the paper contradicts itself",
    AS_SCANNED: "the scanned text is wrong, in dots, primes, indices, ρ or j that the scan may have lost",
})  # fmt: skip
"""Kind of verdict -> its meaning."""

Numbers = Mapping[str, Any]
Judgement = tuple[str, str]
"""Verdict and sentence."""
Judge = Callable[..., Judgement]


@frozen(eq=False)
class Row:
    """A row of a paper's table.

    Attributes
    ----------
    where, says : str
        Position in the paper, and its statement.
    numbers : callable
        Numbers computed from the examples, on which verdict and sentence depend.
    judge : callable
        Function of these numbers.
    example : str
        Name of the example file.
    sheet : PaperFigure or None
        Figure or table to which it belongs; None: the table of its numbers.
    """

    where: str
    says: str
    numbers: Callable[[Examples], Numbers]
    judge: Judge
    example: str
    sheet: PaperFigure | None = None


@frozen(eq=False)
class Claim:
    """A row of a paper with the examples; each part is computed at its first access."""

    paper: str
    row: Row
    examples: Examples
    given: Numbers | None = None

    @property
    def where(self) -> str:
        """Position in the paper."""
        return self.row.where

    @property
    def says(self) -> str:
        """Statement of the paper."""
        return self.row.says

    @property
    def judge(self) -> Judge:
        """Function of the numbers that gives verdict and sentence."""
        return self.row.judge

    @cached_property
    def numbers(self) -> Numbers:
        """Numbers computed from the examples, or the given ones."""
        if self.given is not None:
            return self.given
        return self.examples.once((self.paper, self.where), lambda: self.row.numbers(self.examples))

    @cached_property
    def judgement(self) -> Judgement:
        """Verdict and sentence."""
        return self.row.judge(**self.numbers)

    @property
    def verdict(self) -> str:
        """Kind of verdict, a key of `VERDICTS`."""
        return self.judgement[0]

    @property
    def here(self) -> str:
        """Result here, as a sentence."""
        return self.judgement[1]

    # -- its figure or table --------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """Name of its files."""
        return slug(self.where) if self.row.sheet is None else self.row.sheet.name

    @property
    def title(self) -> str:
        """Heading of its figure or table."""
        return f"{self.where}: {self.says}" if self.row.sheet is None else self.row.sheet.title

    @cached_property
    def table(self) -> FigureTable:
        """Table of its figure, else of its numbers."""
        if self.row.sheet is None:
            return numbers_table(self.numbers, self.title)
        return self.row.sheet.table(self.examples)

    @cached_property
    def drawing(self) -> Drawing:
        """Image of its figure, else its table."""
        if self.row.sheet is None or self.row.sheet.drawing is None:
            return self.table
        return self.row.sheet.drawing(self.examples)


def slug(where: str) -> str:
    """File name of a position in a paper: ``(18)`` -> ``eq_18``; ``Table 2, I_L`` -> ``table_2_i_l``."""
    text = where.replace("→", "to").replace("§", "section ")
    text = f"eq {text}" if text.startswith("(") else text
    return re.sub(r"\W+", "_", text.lower()).strip("_")


# -- judges -------------------------------------------------------------------------------------------------


class ComparedNumber(NamedTuple):
    """A number as printed and as computed here.

    Attributes
    ----------
    printed, here : float
    within : float
        Difference up to which they agree.
    unit : str
    rounded : float
        Difference up to which rounded intermediate results explain it.
    """

    printed: float
    here: float
    within: float
    unit: str = ""
    rounded: float = 0.0

    @property
    def difference(self) -> float:
        """Distance of both numbers."""
        return abs(self.here - self.printed)

    @property
    def is_equal(self) -> bool:
        """Whether both numbers agree."""
        return self.difference <= self.within


def agreement(is_true: object) -> str:
    """Verdict on a statement that is true or not."""
    return AGREES if is_true else DIFFERS


def correction_verdict(kind: str, wrong_as_printed: bool, wrong_as_corrected: bool) -> str:
    """Return this kind of verdict where the print is wrong and its correction is not."""
    if not wrong_as_printed:
        return AGREES
    return DIFFERS if wrong_as_corrected else kind


def judge_numbers(**rows: ComparedNumber) -> Judgement:
    """Agrees where every number is the printed one; rounded where rounded intermediate results explain the others."""
    parts = [f"{name} = {_figure(row.here)}{row.unit and ' ' + row.unit}" for name, row in rows.items()]
    different = {name: row for name, row in rows.items() if not row.is_equal}
    rounded = all(row.difference <= row.rounded for row in different.values())
    verdict = AGREES if not different else ROUNDED if rounded else DIFFERS
    words = ", ".join(f"{name} is printed {_figure(row.printed)}" for name, row in different.items())
    reason = "intermediate results rounded," if rounded else "but"
    return verdict, ", ".join(parts) + (f"; {reason} {words}" if different else "")


def within_bound(sentence: str) -> Judge:
    """Agrees where ``off`` is not above ``bound``; the sentence is a format of the numbers."""

    def judge(off: float, bound: float, **more: Any) -> Judgement:
        return agreement(off <= bound), sentence.format(off=off, bound=bound, **more)

    return judge


def corrected_print(kind: str, sentence: str) -> Judge:
    """Verdict of this kind where the error ``printed`` of the print exceeds ``bound`` and that ``corrected`` does not."""

    def judge(printed: float, corrected: float, bound: float, **more: Any) -> Judgement:
        verdict = correction_verdict(kind, not printed <= bound, not corrected <= bound)
        return verdict, sentence.format(printed=printed, corrected=corrected, bound=bound, **more)

    return judge


def valid_where_used(sentence: str) -> Judge:
    """Verdict LIMIT where the error is at most ``bound`` as the print is ``used``, and larger ``elsewhere``."""

    def judge(used: float, elsewhere: float, bound: float, **more: Any) -> Judgement:
        verdict = correction_verdict(LIMIT, not max(used, elsewhere) <= bound, not used <= bound)
        return verdict, sentence.format(used=used, elsewhere=elsewhere, bound=bound, **more)

    return judge


def wrong_symbol(kind: str, sentence: str) -> Judge:
    """Verdict of this kind where the printed ``symbol`` is not that of the required quantity, ``needed``.

    Of the symbols in ``known``, symbol -> value, one must have this value within ``bound``.
    """

    def judge(symbol: str, needed: float, known: Mapping[str, float], bound: float, **more: Any) -> Judgement:
        fitting = [name for name, value in known.items() if abs(needed / value - 1.0) <= bound]
        verdict = correction_verdict(kind, symbol not in fitting, not fitting)
        return verdict, sentence.format(symbol=symbol, needed=needed, fitting=" or ".join(fitting) or "nothing", **more)

    return judge


def _figure(value: float) -> str:
    return "nothing" if isnan(value) else f"{value:.10g}"
