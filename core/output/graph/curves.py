"""The rows of a graph as numbers: columns found, units changed, curves subtracted, axes shared out; what fails, fails alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest
from math import nan

import numpy as np

from core.bounds import number_from_one
from core.design import UNITS, split_unit
from core.errors import KindynaError
from core.frozen import frozen
from core.numerics.lazy import checkpoint
from core.output.graph.model import ALL, AUTO, LEFT, RIGHT, Graph, GraphAxis, GraphCurve, require_no_ring
from core.output.graph.sources import ColumnHeading, MissingColumn, Source, words_of
from core.output.lines import text_cell
from core.units import conversion_factor, quantity_kind

# -- the rows of a graph as numbers -----------------------------------------------------------------------------


NO_ANGLES = np.zeros(0)
SPARSE = 10  # values of a column, none next to another, that are joined: fewer are single points
SourceOf = Callable[[str], Source]
"""The source of a row's ``source``. Raises KindynaError where there is none."""


@frozen(eq=False)
class Series:
    """One curve to be drawn: x and y (n,), nan where it is broken, in the units named.

    key       of its row; part: which of the row's drives, from 0, where it stands for each of them, else -1
    ordered   x never goes back, so that y is a function of it
    angles    of the turn [deg] (n,), where the curve is one of a design; else empty
    """

    key: str
    part: int
    name: str
    x: np.ndarray
    y: np.ndarray
    x_unit: str
    y_unit: str
    x_label: str
    y_label: str
    family: str
    ordered: bool
    angles: np.ndarray

    def at(self, x: float) -> float:
        """y at x, linear between its points; nan beyond its ends, or where it has none."""
        return float(np.interp(x, self.x, self.y, np.nan, np.nan)) if self.ordered and self.x.size else float("nan")


@frozen(eq=False)
class AxisOf:
    """An axis of values: its side, its unit, what stands on it (places in ``Plotted.series``), and how it is scaled."""

    side: str
    unit: str
    title: str
    scale: GraphAxis
    series: tuple[int, ...]


@frozen(eq=False)
class Plotted:
    """A graph's numbers. faults: key of a row -> why it is not drawn; notes: key -> what was left out of it; lacking: key -> in words
    what the design of a row, which is not drawn, does not have."""

    series: tuple[Series, ...]
    axes: tuple[AxisOf, ...]
    x_unit: str
    x_title: str
    faults: Mapping[str, str]
    notes: Mapping[str, tuple[str, ...]]
    lacking: Mapping[str, str]


def plotted(graph: Graph, source_of: SourceOf) -> Plotted:
    """The numbers of all rows that are shown; a row that has none is named in ``faults``, and takes no other with it."""
    found: list[Series] = []
    faults: dict[str, str] = {}
    notes: dict[str, tuple[str, ...]] = {}
    lacking: dict[str, str] = {}
    for curve in graph.curves:
        if not curve.shown:
            continue
        try:
            require_no_ring(graph, curve.key)
            missing: list[str] = []
            made = series_of(graph, curve, source_of, missing)
            unlike = bool(found) and bool(found[0].x_unit) and not made[0].x_unit
            taken = [f"{made[0].x_label} has no unit: taken as {found[0].x_unit}"] if unlike else []
            notes[curve.key] = (*source_of(curve.source).notes, *missing, *taken)
            found += [_along(found[0], each) if found else each for each in made]
        except KindynaError as error:
            faults[curve.key] = " ".join(str(error).split("\n"))
            if isinstance(error, MissingColumn):
                lacking[curve.key] = error.words
    axes, series = _axes(graph, found)
    for key, line in _below_zero(axes, series):
        notes[key] = (*notes[key], line)
    first = series[0] if series else None
    title = graph.x.title or (first.x_label if first else "")
    return Plotted(tuple(series), axes, first.x_unit if first else "", title, faults, notes, lacking)


def series_of(graph: Graph, curve: GraphCurve, source_of: SourceOf, missing: list[str]) -> list[Series]:
    """The curves of one row: one, or one for each drive; a line goes to ``missing`` for drives that have none, others having one, and
    for a column so sparse that its values are joined across the gaps. Raises KindynaError."""
    source = source_of(curve.source)
    made, failed = [], 0
    for number, part in enumerate(parts := source.parts(curve.drive)):
        try:
            made.append(_plain(curve, source, part, number if curve.drive == ALL else -1, missing))
        except KindynaError as error:
            missing.append(str(error))
            failed += 1
            if failed == len(parts):
                raise
    if not curve.minus:
        return made
    other = graph.curve(curve.minus)
    if other is None:
        raise KindynaError("minus: that curve has been removed; choose another, or none")
    others = series_of(graph, other, source_of, [])
    pairs = zip(made, others if len(others) == len(made) else others[:1] * len(made), strict=True)
    return [difference(one, less, curve.name) for one, less in pairs]


def heading_of(
    headings: tuple[ColumnHeading, ...], name: str, usual: int, where: str, of_design: bool = False
) -> ColumnHeading:
    """A column by its name, with its unit or without, or its number from 1. Raises KindynaError, Lacking."""
    if not name:
        if len(headings) <= usual:
            raise KindynaError(
                f"{where} has {len(headings)} column{'s' if len(headings) != 1 else ''}; x and y want two"
            )
        return headings[usual]
    named = next((each for each in headings if name in (each.name, split_unit(each.name)[0])), None)
    if named is None and (number := number_from_one(name, len(headings))):
        named = headings[number - 1]
    if named is None:
        text = f"{where} has no column {name!r} (any longer); choose another"
        if of_design:
            raise MissingColumn(
                text, f"{where} has no {words_of(name)}; the curve comes back with a design that has it."
            )
        raise KindynaError(text)
    return named


def _plain(curve: GraphCurve, source: Source, part: str, number: int, missing: list[str]) -> Series:
    where = f"{source.name}, {part}" if part else source.name
    headings = source.headings(part)
    across = heading_of(headings, curve.x, 0, where, source.turns)
    upwards = heading_of(headings, curve.y, source.usual(headings), where, source.turns)
    x, y, *turn = source.values(part, (across.name, upwards.name, *([headings[0].name] if source.turns else [])))
    angles = turn[0] if turn else NO_ANGLES
    there = np.isfinite(x)
    if not there.all():
        x, y, angles = x[there], y[there], angles[there] if angles.size else angles
    if not (x.size and np.isfinite(y).any()):
        raise KindynaError(f"{where}: {upwards.label} has no numbers over {across.label}")
    filled = np.isfinite(y)
    if filled.sum() >= SPARSE and not (filled[1:] & filled[:-1]).any():  # as of a slower instrument in the same table
        missing.append(
            f"{upwards.label} has values in {filled.sum()} of {y.size} rows, none next to another: joined across the gaps"
        )
        x, y, angles = x[filled], y[filled], angles[filled] if angles.size else angles
    x_unit, y_unit = curve.x_unit or across.unit, curve.y_unit or upwards.unit
    x, y = _changed(x, across, x_unit, "x"), _changed(y, upwards, y_unit, "y")
    steps = np.diff(x)
    if x.size > 1 and (steps <= 0.0).all():
        x, y, steps, angles = x[::-1], y[::-1], steps[::-1] * -1.0, angles[::-1]
    named = curve.name or upwards.label
    name = f"{named}, {part}" if part and (number >= 0 or not curve.name) else named
    name = name if curve.name or not curve.source else f"{name}, {source.name}"
    return Series(
        curve.key,
        number,
        name,
        x,
        y,
        x_unit,
        y_unit,
        across.label,
        upwards.label,
        upwards.family,
        bool((steps >= 0.0).all()),
        angles,
    )


def _changed(values: np.ndarray, heading: ColumnHeading, unit: str, which: str) -> np.ndarray:
    if unit == heading.unit or not heading.unit:  # what says no unit has the one that is chosen
        return values
    if quantity_kind(unit) != quantity_kind(heading.unit):
        raise KindynaError(
            f"{which}: {heading.label} is in {heading.unit}, which is no measure in {unit}; choose another unit"
        )
    return values * conversion_factor(heading.unit, unit)


def _along(first: Series, series: Series) -> Series:
    """Over the x of the first curve; what has no unit is taken as it is."""
    if series.x_unit == first.x_unit or not (series.x_unit and first.x_unit):
        return replace(series, x_unit=first.x_unit)
    if quantity_kind(series.x_unit) != quantity_kind(first.x_unit):
        units = f"{series.x_unit}, that of the first curve in {first.x_unit}"
        raise KindynaError(f"{series.name}: x is in {units}; choose another column or unit for x")
    return replace(series, x=series.x * conversion_factor(series.x_unit, first.x_unit), x_unit=first.x_unit)


def difference(one: Series, less: Series, name: str = "") -> Series:
    """``one`` less ``less`` in the units of one, at every x of either that both reach, linear between their points.

    Raises KindynaError where they measure different things, have no x in common, or x goes back.
    """
    for each in (one, less):
        if not each.ordered:
            raise KindynaError(
                f"{each.name}: x goes back, so that nothing can be subtracted at the same x; choose another column for x"
            )
    for which, a, b in (("x", one.x_unit, less.x_unit), ("y", one.y_unit, less.y_unit)):
        if quantity_kind(a) != quantity_kind(b) and (which == "y" or (a and b)):  # x without a unit is taken as it is
            units = f"{a or 'no unit'} and in {b or 'no unit'}"
            raise KindynaError(f"{one.name} - {less.name}: {which} is in {units}; only like can be subtracted")
    x = less.x * (conversion_factor(less.x_unit, one.x_unit) if less.x_unit and one.x_unit else 1.0)
    low, high = max(one.x[0], x[0]), min(one.x[-1], x[-1])
    union = one.x if np.array_equal(one.x, x) else np.union1d(one.x, x)
    union = union[(union >= low) & (union <= high)]
    if not union.size:
        reach = (f"{ends[0]:.6g} ... {ends[-1]:.6g}" for ends in (one.x, x))
        raise KindynaError(
            f"{one.name} - {less.name}: no x in common ({' and '.join(reach)} {one.x_unit})".replace(" )", ")")
        )
    of_one = one.y if union is one.x else np.interp(union, one.x, one.y)
    other = np.interp(union, x, less.y) if union is not one.x else less.y
    y = of_one - other * conversion_factor(less.y_unit, one.y_unit)
    return replace(one, x=union, y=y, name=name or f"{one.name} − {less.name}", family="", angles=NO_ANGLES)


def _axes(graph: Graph, found: list[Series]) -> tuple[tuple[AxisOf, ...], list[Series]]:
    """Curves of one kind on one axis, in the unit of the first of them; the first kind on the left, others on the right, where their
    rows do not say otherwise."""
    sides = {curve.key: curve.side for curve in graph.curves}
    places: dict[tuple[str, str], list[int]] = {}
    for i, each in enumerate(found):
        kind, side = quantity_kind(each.y_unit), sides[each.key]
        if side == AUTO:
            side = next((s for s, k in places if k == kind), RIGHT if any(s == LEFT for s, _ in places) else LEFT)
        places.setdefault((side, kind), []).append(i)
    series, axes = list(found), []
    first = {LEFT: graph.left, RIGHT: graph.right}
    for (side, _), members in sorted(places.items(), key=lambda row: (row[0][0] != LEFT, row[1][0])):
        unit = found[members[0]].y_unit
        for i in members:
            series[i] = replace(found[i], y=found[i].y * conversion_factor(found[i].y_unit, unit), y_unit=unit)
        scale = first.pop(side, GraphAxis())
        title = scale.title or _common([found[i].y_label for i in members])
        axes.append(AxisOf(side, unit, title, scale, tuple(members)))
    return tuple(axes), series


def _below_zero(axes: Sequence[AxisOf], series: Sequence[Series]) -> list[tuple[str, str]]:
    """Of rows on logarithmic axes: key, and how many values have no place there."""
    lost: Counter[str] = Counter()
    for axis in axes:
        for i in axis.series if axis.scale.log else ():
            lost[series[i].key] += int((series[i].y <= 0.0).sum())
    return [
        (
            key,
            f"{count} value{'s' * (count > 1)} at or below 0 {'are' if count > 1 else 'is'} not on the logarithmic axis",
        )
        for key, count in lost.items()
        if count
    ]


def _common(labels: list[str]) -> str:
    """A title of labels: each once, the first three."""
    different = list({label.casefold(): label for label in reversed(labels)}.values())[::-1]
    return ", ".join(different[:3]) + (" …" if len(different) > 3 else "")


# -- what is read off a graph -----------------------------------------------------------------------------------


AT_ONCE = 20_000  # rows between two looks at whether they are still wanted
EACH = 30.0  # degrees
APART = 0.04  # of the curve's size: marks closer together are at one place
_SUFFIX = str.maketrans(
    {"/": "_", "²": "2", "³": "3", "·": "", "°": "deg", "µ": "u", " ": "_", "%": "percent", ",": "", '"': ""}
)


@frozen
class GraphPoint:
    """A point of a curve: which (place in ``Plotted.series``), x, y."""

    series: int
    x: float
    y: float


@frozen
class PointDistance:
    """What lies between two points: Δx, Δy and Δy/Δx; y and slope are nan where the curves are in different units, the slope where the
    points stand above each other."""

    x: float
    y: float
    slope: float


def point_at(found: Plotted, number: int, x: float) -> GraphPoint:
    """The point of a curve at x, linear between its points; of one that goes back, its nearest point."""
    series = found.series[number]
    if series.ordered:
        at = min(max(x, float(series.x[0])), float(series.x[-1]))
        return GraphPoint(number, at, series.at(at))
    i = int(np.argmin(np.abs(series.x - x)))
    return GraphPoint(number, float(series.x[i]), float(series.y[i]))


def angle_at(found: Plotted, point: GraphPoint) -> float:
    """The angle of the turn [deg] at a point of a curve that goes back; nan where there is none, or where x says it."""
    series = found.series[point.series]
    if series.ordered or not series.angles.size:
        return nan
    return float(series.angles[int(np.nanargmin((series.x - point.x) ** 2 + (series.y - point.y) ** 2))])


def angle_marks(series: Series) -> list[tuple[float, float, str]]:
    """x, y and the angle in words wherever a curve's angle is a multiple of ``EACH``; those at one place have one text."""
    if not series.angles.size:
        return []
    order = np.argsort(series.angles, kind="stable")
    angles = np.arange(0.0, 360.0, EACH)
    x, y = (np.interp(angles, series.angles[order], values[order], period=360.0) for values in (series.x, series.y))
    there = np.isfinite(x) & np.isfinite(y)
    if not there.any():
        return []
    wide, high = (float(np.ptp(values[there])) or 1.0 for values in (x, y))
    places: list[list[int]] = []
    for i in np.flatnonzero(there).tolist():
        near = [place for place in places if np.hypot((x[i] - x[place[0]]) / wide, (y[i] - y[place[0]]) / high) < APART]
        if near:
            near[0].append(i)
        else:
            places.append([i])
    return [(float(x[place[0]]), float(y[place[0]]), _in_runs(place, angles.size)) for place in places]


def _in_runs(places: list[int], count: int) -> str:
    """``0°``, ``60-150°``, ``0°, 180°``: which of so many angles, neighbours as one."""
    begins = [i for i in places if (i - 1) % count not in places] or places[:1]
    runs = []
    for begin in begins:
        length = next((n for n in range(1, count) if (begin + n) % count not in places), count)
        end = (begin + length - 1) % count
        runs.append(f"{begin * EACH:g}°" if length == 1 else f"{begin * EACH:g}-{end * EACH:g}°")
    return ", ".join(runs)


def gap(found: Plotted, first: GraphPoint, second: GraphPoint) -> PointDistance:
    """From the first point to the second."""
    across, units = second.x - first.x, {found.series[each.series].y_unit for each in (first, second)}
    up = second.y - first.y if len(units) == 1 else nan
    return PointDistance(across, up, up / across if across else nan)


def columns_of(found: Plotted) -> tuple[list[str], list[np.ndarray]]:
    """Names and columns of a table: over one x where the curves have the same, or where each is a function of it (then at every x of
    any of them, linear between its points, nan beyond its ends); else each with an x of its own."""
    if not found.series:
        raise KindynaError("the graph has no curve, so there are no numbers")
    first, across = found.series[0], _column(found.series[0].x_label, found.x_unit)
    names = _distinct([across, *(_column(each.name, each.y_unit) for each in found.series)])
    if all(np.array_equal(each.x, first.x) for each in found.series):
        return names, [first.x, *(each.y for each in found.series)]
    if all(each.ordered for each in found.series):
        x = np.unique(np.concatenate([each.x for each in found.series]))
        return names, [x, *(np.interp(x, each.x, each.y, nan, nan) for each in found.series)]
    pairs = [
        (_column(f"{each.x_label} of {each.name}", each.x_unit), each.x, name, each.y)
        for name, each in _named(names, found.series)
    ]
    return _distinct([name for row in pairs for name in (row[0], row[2])]), [
        column for row in pairs for column in (row[1], row[3])
    ]


def _named(names: Sequence[str], series: Sequence[Series]) -> list[tuple[str, Series]]:
    return list(zip(names[1:], series, strict=True))


def numbers_csv(found: Plotted, delimiter: str = ",") -> str:
    """The same as text: one header line, cells without a number empty, every number the shortest that reads back to the same bits.
    Raises KindynaError where the graph has no curve."""
    names, columns = columns_of(found)
    length = max(column.size for column in columns)
    rows = [delimiter.join(text_cell(name, delimiter) for name in names)]
    for at in range(0, length, AT_ONCE):
        checkpoint()
        part = slice(at, min(at + AT_ONCE, length))
        texts = [[repr(value) if value == value else "" for value in column[part].tolist()] for column in columns]
        rows += map(delimiter.join, zip_longest(*texts, fillvalue=""))
    return "\n".join(rows) + "\n"


def _column(label: str, unit: str) -> str:
    """``Contact force, N`` -> ``contact_force_n``, which reads back with its unit."""
    words = " ".join(label.lower().split()).replace("−", "minus").replace("-", " ").translate(_SUFFIX)
    text = "_".join(part for part in words.split("_") if part)
    return f"{text}_{_spelled(unit)}" if unit else text


def _spelled(unit: str) -> str:
    own = next((suffix for suffix, row in UNITS.items() if row.symbol == unit), "")
    return own or unit.translate(_SUFFIX).lower()


def _distinct(names: list[str]) -> list[str]:
    made: list[str] = []
    for name in names:
        number = 1
        while (text := name if number == 1 else f"{number}_{name}") in made:
            number += 1
        made.append(text)
    return made


# -- A graph to be painted as a file ----------------------------------------------------------------------------


ENDINGS = (".png", ".svg", ".pdf")
USUAL_SIZE = (960, 600)
LEAST_SIDE, MOST_SIDE = 240, 8000


@frozen(eq=False)
class GraphPicture:
    """The graph, its numbers, the ending of the file, its size in pixels; name: for the title of the file."""

    graph: Graph
    found: Plotted
    ending: str
    width: int = USUAL_SIZE[0]
    height: int = USUAL_SIZE[1]
    name: str = "Graph"
