"""The rows of a graph as numbers: columns, units, differences and axes; a row that fails does not affect the others."""

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
from core.number_text import result_text
from core.numerics.lazy import checkpoint
from core.output.graph.model import ALL, AUTO, LEFT, RIGHT, Graph, GraphAxis, GraphCurve, require_no_cycle
from core.output.graph.sources import ColumnHeading, MissingColumn, Source, column_label
from core.output.lines import text_cell
from core.units import conversion_factor, quantity_kind

# -- the rows of a graph as numbers -----------------------------------------------------------------------------


NO_ANGLES = np.zeros(0)
SPARSE = 10  # isolated values of a column that are joined by lines: fewer are single points
SourceReader = Callable[[str], Source]
"""A row's ``source`` -> its source. Raises KindynaError where there is none."""


@frozen(eq=False)
class Series:
    """One curve.

    Attributes
    ----------
    key : key of its row
    part : index of the drive where the row is for all drives, else -1
    x, y : (n,) values, NaN in gaps [x_unit, y_unit]
    is_ordered : whether x never decreases, so that y is a function of x
    angles : (n,) angles of the turn for a curve of a design, else empty [deg]
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
    is_ordered: bool
    angles: np.ndarray

    def at(self, x: float) -> float:
        """Value y at x, linear between points; NaN beyond the ends and where y is no function of x."""
        return float(np.interp(x, self.x, self.y, np.nan, np.nan)) if self.is_ordered and self.x.size else float("nan")


@frozen(eq=False)
class ValueAxis:
    """An axis of values: side, unit, scale, and the indices of its curves in ``GraphData.series``."""

    side: str
    unit: str
    title: str
    scale: GraphAxis
    series: tuple[int, ...]


@frozen(eq=False)
class GraphData:
    """The numbers of a graph.

    Attributes
    ----------
    faults : key of a row -> reason why it is not drawn
    notes : key -> lines on omitted parts
    missing : key -> description of the column that the design of a row lacks
    """

    series: tuple[Series, ...]
    axes: tuple[ValueAxis, ...]
    x_unit: str
    x_title: str
    faults: Mapping[str, str]
    notes: Mapping[str, tuple[str, ...]]
    missing: Mapping[str, str]


def graph_data(graph: Graph, get_source: SourceReader) -> GraphData:
    """Numbers of all visible rows; a row without numbers is listed in ``faults`` and does not affect the others."""
    drawn: list[Series] = []
    faults: dict[str, str] = {}
    notes: dict[str, tuple[str, ...]] = {}
    missing: dict[str, str] = {}
    for curve in graph.curves:
        if not curve.shown:
            continue
        try:
            require_no_cycle(graph, curve.key)
            lines: list[str] = []
            added = curve_series(graph, curve, get_source, lines)
            if drawn and drawn[0].x_unit and not added[0].x_unit:
                lines.append(f"{added[0].x_label} has no unit: {drawn[0].x_unit} is assumed")
            notes[curve.key] = (*get_source(curve.source).notes, *lines)
            drawn += [_over_x_of(drawn[0], part) if drawn else part for part in added]
        except KindynaError as error:
            faults[curve.key] = " ".join(str(error).split("\n"))
            if isinstance(error, MissingColumn):
                missing[curve.key] = error.description
    axes, series = _axes(graph, drawn)
    for key, line in _below_zero(axes, series):
        notes[key] = (*notes[key], line)
    first = series[0] if series else None
    title = graph.x.title or (first.x_label if first else "")
    return GraphData(tuple(series), axes, first.x_unit if first else "", title, faults, notes, missing)


def curve_series(graph: Graph, curve: GraphCurve, get_source: SourceReader, notes: list[str]) -> list[Series]:
    """Curves of one row: one, or one for each drive. Raises KindynaError.

    Lines on drives without such a curve, where others have one, and on sparse columns go to ``notes``.
    """
    source = get_source(curve.source)
    series, failed = [], 0
    for number, part in enumerate(parts := source.parts(curve.drive)):
        try:
            series.append(_single_series(curve, source, part, number if curve.drive == ALL else -1, notes))
        except KindynaError as error:
            notes.append(str(error))
            failed += 1
            if failed == len(parts):
                raise
    if not curve.minus:
        return series
    row = graph.curve(curve.minus)
    if row is None:
        raise KindynaError("minus: that curve has been removed; choose another, or none")
    subtracted = curve_series(graph, row, get_source, [])
    pairs = zip(series, subtracted if len(subtracted) == len(series) else subtracted[:1] * len(series), strict=True)
    return [difference(first, second, curve.name) for first, second in pairs]


def find_heading(
    headings: tuple[ColumnHeading, ...], name: str, default: int, where: str, is_design: bool = False
) -> ColumnHeading:
    """A column by its name, with or without unit, or by its number from 1. Raises KindynaError, MissingColumn."""
    if not name:
        if len(headings) <= default:
            raise KindynaError(
                f"{where} has {len(headings)} column{'s' if len(headings) != 1 else ''}; x and y need two"
            )
        return headings[default]
    heading = next((row for row in headings if name in (row.name, split_unit(row.name)[0])), None)
    if heading is None and (number := number_from_one(name, len(headings))):
        heading = headings[number - 1]
    if heading is None:
        text = f"{where} has no column {name!r}; choose another"
        if is_design:
            raise MissingColumn(
                text, f"{where} has no {column_label(name)}; the curve is drawn again for a design that has it."
            )
        raise KindynaError(text)
    return heading


def _single_series(curve: GraphCurve, source: Source, part: str, number: int, notes: list[str]) -> Series:
    location = f"{source.name}, {part}" if part else source.name
    headings = source.headings(part)
    across = find_heading(headings, curve.x, 0, location, source.has_angle)
    upwards = find_heading(headings, curve.y, source.default_column(headings), location, source.has_angle)
    x, y, *turn = source.values(part, (across.name, upwards.name, *([headings[0].name] if source.has_angle else [])))
    angles = turn[0] if turn else NO_ANGLES
    is_number = np.isfinite(x)
    if not is_number.all():
        x, y, angles = x[is_number], y[is_number], angles[is_number] if angles.size else angles
    if not (x.size and np.isfinite(y).any()):
        raise KindynaError(f"{location}: {upwards.label} has no numbers over {across.label}")
    has_value = np.isfinite(y)
    if (
        has_value.sum() >= SPARSE and not (has_value[1:] & has_value[:-1]).any()
    ):  # a slower instrument in the same table
        notes.append(
            f"{upwards.label} has values in {has_value.sum()} of {y.size} rows, all isolated: joined across the gaps"
        )
        x, y, angles = x[has_value], y[has_value], angles[has_value] if angles.size else angles
    x_unit, y_unit = curve.x_unit or across.unit, curve.y_unit or upwards.unit
    x, y = _convert(x, across, x_unit, "x"), _convert(y, upwards, y_unit, "y")
    steps = np.diff(x)
    if x.size > 1 and (steps <= 0.0).all():
        x, y, steps, angles = x[::-1], y[::-1], steps[::-1] * -1.0, angles[::-1]
    label = curve.name or upwards.label
    name = f"{label}, {part}" if part and (number >= 0 or not curve.name) else label
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


def _convert(values: np.ndarray, heading: ColumnHeading, unit: str, which: str) -> np.ndarray:
    if unit == heading.unit or not heading.unit:  # a column without a unit has the chosen one
        return values
    if quantity_kind(unit) != quantity_kind(heading.unit):
        raise KindynaError(
            f"{which}: {heading.label} is in {heading.unit}, which cannot be shown in {unit}; choose another unit"
        )
    return values * conversion_factor(heading.unit, unit)


def _over_x_of(first: Series, series: Series) -> Series:
    """A curve with x in the unit of the first curve; x without a unit is unchanged."""
    if series.x_unit == first.x_unit or not (series.x_unit and first.x_unit):
        return replace(series, x_unit=first.x_unit)
    if quantity_kind(series.x_unit) != quantity_kind(first.x_unit):
        units = f"{series.x_unit}, that of the first curve in {first.x_unit}"
        raise KindynaError(f"{series.name}: x is in {units}; choose another column or unit for x")
    return replace(series, x=series.x * conversion_factor(series.x_unit, first.x_unit), x_unit=first.x_unit)


def difference(first: Series, second: Series, name: str = "") -> Series:
    """Difference of two curves in the units of the first, at all x of both within the common range, linear between points.

    Raises KindynaError where they are different quantities, have no common range of x, or x decreases.
    """
    for series in (first, second):
        if not series.is_ordered:
            raise KindynaError(
                f"{series.name}: x decreases, so that there is no unique difference at the same x; choose another column for x"
            )
    for axis, a, b in (("x", first.x_unit, second.x_unit), ("y", first.y_unit, second.y_unit)):
        if quantity_kind(a) != quantity_kind(b) and (axis == "y" or (a and b)):  # x without a unit is unchanged
            units = f"{a or 'no unit'} and in {b or 'no unit'}"
            raise KindynaError(f"{first.name} - {second.name}: {axis} is in {units}; the quantities must be the same")
    x = second.x * (conversion_factor(second.x_unit, first.x_unit) if second.x_unit and first.x_unit else 1.0)
    low, high = max(first.x[0], x[0]), min(first.x[-1], x[-1])
    union = first.x if np.array_equal(first.x, x) else np.union1d(first.x, x)
    union = union[(union >= low) & (union <= high)]
    if not union.size:
        reach = (f"{result_text(ends[0])} ... {result_text(ends[-1])}" for ends in (first.x, x))
        raise KindynaError(
            f"{first.name} - {second.name}: no common range of x ({' and '.join(reach)} {first.x_unit})".replace(
                " )", ")"
            )
        )
    first_y = first.y if union is first.x else np.interp(union, first.x, first.y)
    second_y = np.interp(union, x, second.y) if union is not first.x else second.y
    y = first_y - second_y * conversion_factor(second.y_unit, first.y_unit)
    return replace(first, x=union, y=y, name=name or f"{first.name} − {second.name}", family="", angles=NO_ANGLES)


def _axes(graph: Graph, curves: list[Series]) -> tuple[tuple[ValueAxis, ...], list[Series]]:
    """Axes of the curves, and the curves in the unit of their axis.

    Curves of one kind share an axis, in the unit of the first of them: the first kind on the left, others on the right, unless
    their rows state a side.
    """
    sides = {row.key: row.side for row in graph.curves}
    indices: dict[tuple[str, str], list[int]] = {}
    for i, curve in enumerate(curves):
        kind, side = quantity_kind(curve.y_unit), sides[curve.key]
        if side == AUTO:
            side = next((s for s, k in indices if k == kind), RIGHT if any(s == LEFT for s, _ in indices) else LEFT)
        indices.setdefault((side, kind), []).append(i)
    series, axes = list(curves), []
    first = {LEFT: graph.left, RIGHT: graph.right}
    for (side, _), members in sorted(indices.items(), key=lambda row: (row[0][0] != LEFT, row[1][0])):
        unit = curves[members[0]].y_unit
        for i in members:
            series[i] = replace(curves[i], y=curves[i].y * conversion_factor(curves[i].y_unit, unit), y_unit=unit)
        scale = first.pop(side, GraphAxis())
        title = scale.title or _common([curves[i].y_label for i in members])
        axes.append(ValueAxis(side, unit, title, scale, tuple(members)))
    return tuple(axes), series


def _below_zero(axes: Sequence[ValueAxis], series: Sequence[Series]) -> list[tuple[str, str]]:
    """Key of a row on a logarithmic axis, and a line on its values at or below 0."""
    omitted: Counter[str] = Counter()
    for axis in axes:
        for i in axis.series if axis.scale.log else ():
            omitted[series[i].key] += int((series[i].y <= 0.0).sum())
    return [
        (
            key,
            f"{count} value{'s' * (count > 1)} at or below 0 {'are' if count > 1 else 'is'} not on the logarithmic axis",
        )
        for key, count in omitted.items()
        if count
    ]


def _common(labels: list[str]) -> str:
    """Title of different labels, at most three."""
    different = list({label.casefold(): label for label in reversed(labels)}.values())[::-1]
    return ", ".join(different[:3]) + (" …" if len(different) > 3 else "")


# -- read-outs --------------------------------------------------------------------------------------------------


AT_ONCE = 20_000  # rows between two checkpoints
ANGLE_STEP = 30.0  # degrees between marks
NEAR = 0.04  # relative to the curve's size: closer marks share a label
_SUFFIX = str.maketrans(
    {"/": "_", "²": "2", "³": "3", "·": "", "°": "deg", "µ": "u", " ": "_", "%": "percent", ",": "", '"': ""}
)


@frozen
class GraphPoint:
    """A point of a curve: index in ``GraphData.series``, x and y."""

    series: int
    x: float
    y: float


@frozen
class PointDistance:
    """Distance between two points: Δx, Δy and Δy/Δx.

    y and slope are NaN where the units differ, the slope also where Δx is 0.
    """

    x: float
    y: float
    slope: float


def point_at(data: GraphData, number: int, x: float) -> GraphPoint:
    """Point of a curve at x, linear between points; the nearest point where x decreases along the curve."""
    series = data.series[number]
    if series.is_ordered:
        at = min(max(x, float(series.x[0])), float(series.x[-1]))
        return GraphPoint(number, at, series.at(at))
    i = int(np.argmin(np.abs(series.x - x)))
    return GraphPoint(number, float(series.x[i]), float(series.y[i]))


def angle_at(data: GraphData, point: GraphPoint) -> float:
    """Angle of the turn [deg] at a point of a curve on which x decreases; NaN without an angle, or where x determines it."""
    series = data.series[point.series]
    if series.is_ordered or not series.angles.size:
        return nan
    return float(series.angles[int(np.nanargmin((series.x - point.x) ** 2 + (series.y - point.y) ** 2))])


def angle_marks(series: Series) -> list[tuple[float, float, str]]:
    """Points x, y and label at the multiples of ``ANGLE_STEP``; points close together share a label."""
    if not series.angles.size:
        return []
    order = np.argsort(series.angles, kind="stable")
    angles = np.arange(0.0, 360.0, ANGLE_STEP)
    x, y = (np.interp(angles, series.angles[order], values[order], period=360.0) for values in (series.x, series.y))
    is_finite = np.isfinite(x) & np.isfinite(y)
    if not is_finite.any():
        return []
    width, height = (float(np.ptp(values[is_finite])) or 1.0 for values in (x, y))
    groups: list[list[int]] = []
    for i in np.flatnonzero(is_finite).tolist():
        close = [
            group for group in groups if np.hypot((x[i] - x[group[0]]) / width, (y[i] - y[group[0]]) / height) < NEAR
        ]
        if close:
            close[0].append(i)
        else:
            groups.append([i])
    return [(float(x[group[0]]), float(y[group[0]]), _angle_ranges(group, angles.size)) for group in groups]


def _angle_ranges(indices: list[int], count: int) -> str:
    """Angles in words, neighbours as ranges: ``0°``, ``60-150°``, ``0°, 180°``."""
    begins = [i for i in indices if (i - 1) % count not in indices] or indices[:1]
    ranges = []
    for begin in begins:
        length = next((n for n in range(1, count) if (begin + n) % count not in indices), count)
        end = (begin + length - 1) % count
        ranges.append(f"{begin * ANGLE_STEP:g}°" if length == 1 else f"{begin * ANGLE_STEP:g}-{end * ANGLE_STEP:g}°")
    return ", ".join(ranges)


def point_distance(data: GraphData, first: GraphPoint, second: GraphPoint) -> PointDistance:
    """Distance from the first point to the second."""
    dx, units = second.x - first.x, {data.series[point.series].y_unit for point in (first, second)}
    dy = second.y - first.y if len(units) == 1 else nan
    return PointDistance(dx, dy, dy / dx if dx else nan)


def data_columns(data: GraphData) -> tuple[list[str], list[np.ndarray]]:
    """Names and columns of a table of all curves.

    Over one x where the curves have the same x, or where y is a function of x for all of them: then at every x of any curve,
    linear between points, NaN beyond the ends. Else every curve has a column of x.

    Returns
    -------
    names : list of str
    columns : list of ndarray (n,) [units in the names]

    Raises
    ------
    KindynaError
        The graph has no curve.
    """
    if not data.series:
        raise KindynaError("the graph has no curve, so there are no numbers")
    first, x_name = data.series[0], _column(data.series[0].x_label, data.x_unit)
    names = _distinct_names([x_name, *(_column(curve.name, curve.y_unit) for curve in data.series)])
    if all(np.array_equal(curve.x, first.x) for curve in data.series):
        return names, [first.x, *(curve.y for curve in data.series)]
    if all(curve.is_ordered for curve in data.series):
        x = np.unique(np.concatenate([curve.x for curve in data.series]))
        return names, [x, *(np.interp(x, curve.x, curve.y, nan, nan) for curve in data.series)]
    headings: list[str] = []
    for name, curve in zip(names[1:], data.series, strict=True):
        headings += [_column(f"{curve.x_label} of {curve.name}", curve.x_unit), name]
    return _distinct_names(headings), [column for curve in data.series for column in (curve.x, curve.y)]


def numbers_csv(data: GraphData, delimiter: str = ",") -> str:
    """The table of `data_columns` as text: one header line, empty cells for NaN, numbers that read back to the same bits.

    Raises KindynaError where the graph has no curve.
    """
    names, columns = data_columns(data)
    length = max(column.size for column in columns)
    rows = [delimiter.join(text_cell(name, delimiter) for name in names)]
    for at in range(0, length, AT_ONCE):
        checkpoint()
        part = slice(at, min(at + AT_ONCE, length))
        texts = [[repr(value) if value == value else "" for value in column[part].tolist()] for column in columns]
        rows += map(delimiter.join, zip_longest(*texts, fillvalue=""))
    return "\n".join(rows) + "\n"


def _column(label: str, unit: str) -> str:
    """Label and unit as a column's name: ``Contact force, N`` -> ``contact_force_n``."""
    words = " ".join(label.lower().split()).replace("−", "minus").replace("-", " ").translate(_SUFFIX)
    text = "_".join(part for part in words.split("_") if part)
    return f"{text}_{_spelled(unit)}" if unit else text


def _spelled(unit: str) -> str:
    suffix = next((suffix for suffix, row in UNITS.items() if row.symbol == unit), "")
    return suffix or unit.translate(_SUFFIX).lower()


def _distinct_names(names: list[str]) -> list[str]:
    result: list[str] = []
    for name in names:
        number = 1
        while (text := name if number == 1 else f"{number}_{name}") in result:
            number += 1
        result.append(text)
    return result


# -- image of a graph -------------------------------------------------------------------------------------------


ENDINGS = (".png", ".svg", ".pdf")
DEFAULT_SIZE = (960, 600)
LEAST_SIDE, MOST_SIDE = 240, 8000


@frozen(eq=False)
class GraphImage:
    """An image file of a graph.

    Attributes
    ----------
    graph, data : the graph and its numbers
    ending : ending of the file
    width, height : size [pixels]
    name : title of the file
    """

    graph: Graph
    data: GraphData
    ending: str
    width: int = DEFAULT_SIZE[0]
    height: int = DEFAULT_SIZE[1]
    name: str = "Graph"
