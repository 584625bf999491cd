"""A figure or table of a paper: its numbers as columns, and what is painted of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from math import isfinite
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from core.frozen import frozen
from core.plot import Figure, Plot, PlotCurve
from core.study import Camshaft, Study

if TYPE_CHECKING:
    from core.papers.examples import Examples
    from core.stability import Chart

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
