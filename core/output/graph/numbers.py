"""What is read off a graph: values at an x, two points and their difference, and all its curves as a table."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest
from math import nan

import numpy as np

from core.design import UNITS
from core.errors import KindynaError
from core.frozen import frozen
from core.numerics.cancellation import checkpoint
from core.output.graph.curves import Plotted, Series
from core.output.lines import text_cell

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


__all__ = ["GraphPoint", "PointDistance", "angle_at", "angle_marks", "columns_of", "gap", "numbers_csv", "point_at"]
