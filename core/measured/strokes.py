"""Dwells and reversals of a measured motion, between which its strokes are."""

from __future__ import annotations

from itertools import pairwise
from math import sqrt

import numpy as np

from core.frozen import frozen
from core.measured.rows import TurnRows

LEAST_STEPS = 4  # least number of steps of a dwell
AGREE = 3.5  # largest deviation of a row from its dwell, in errors
TREND = 16.0  # largest part of χ² of a dwell that a parabola may explain
_CORES = (
    1.0,
    0.9,
    0.8,
    0.7,
    0.6,
)  # fractions of agreeing rows, in their middle, that may be a dwell: a law leaves it slowly
MOST_SEARCHED = 7200  # rows that are searched for dwells; longer tables are sampled
STEP = 20.0  # least difference of the levels of neighbouring dwells, in errors; else the shorter is a slow part of a stroke
PASSES = 5.0  # least difference of the slopes of a dwell and of a slow part of a stroke, in standard errors
PROMINENCE = 20.0  # least prominence of a reversal, in errors
SLOW = 0.04  # velocity relative to the largest one of its stroke, below which a minimum is a rest
_NOISE = 0.01  # largest error of a slope relative to the largest velocity


@frozen(eq=False)
class Rest:
    """Position where the velocity is zero: a dwell, or a single row.

    Attributes
    ----------
    first, last : rows, which may exceed the turn
    level : level of a dwell; None for a single row
    """

    first: int
    last: int
    level: float | None = None


@frozen(eq=False)
class UnrolledRows:
    """Rows over two turns, starting at a row in motion.

    Attributes
    ----------
    x : ndarray (2n,) [deg]
        Cam angles of ``rows``, continued beyond the turn.
    values : dict of int to ndarray (2n,) [unit of the motion per deg^order]
        Values of ``rows`` by the order of the derivative.
    count : number n of rows per turn
    """

    rows: TurnRows
    count: int
    x: np.ndarray
    values: dict[int, np.ndarray]


def unrolled(rows: TurnRows) -> UnrolledRows:
    """Rows over two turns, starting at the largest velocity."""
    y = rows.values[0]
    step = max(1, y.size // MOST_SEARCHED)
    first = int(np.argmax(np.abs(np.roll(y, -step) - y)))
    x = np.roll(rows.x, -first)
    x = np.where(np.arange(x.size) >= x.size - first, x + 360.0, x)
    twice = {order: np.tile(np.roll(values, -first), 2) for order, values in rows.values.items()}
    return UnrolledRows(rows, y.size, np.append(x, x + 360.0), twice)


def rests(at: UnrolledRows, with_dwells: bool = True) -> list[Rest]:
    """Dwells and other rests of a turn in order; empty where nothing moves by more than the error."""
    step = -(-at.count // MOST_SEARCHED)
    sampled = np.arange(0, at.count, step)
    y, error = at.values[0][sampled], at.rows.errors[0]
    dwells = [Rest(int(sampled[a]), int(sampled[b]), level) for a, b, level in _dwells(y, error)] if with_dwells else []
    dwells = _with_common_levels(
        _without_moving_rows(at, _without_slow_parts(at, _among_all_rows(at, dwells, step))), at, error
    )
    dwells = _merged(at, dwells, error)
    reversals = _reversals(at, sampled, dwells, error)
    return sorted([*dwells, *reversals], key=lambda rest: rest.first)


def _dwells(y: np.ndarray, error: float) -> list[tuple[int, int, float]]:
    """First row, last row and level of each dwell, the longest first."""
    windows = sorted(_windows(y, 2.0 * AGREE * error), key=lambda w: w[0] - w[1])
    free, result = np.ones(y.size, dtype=bool), []
    for first, last in windows:
        if last - first < LEAST_STEPS:
            break
        if not free[first : last + 1].all():
            inside = np.flatnonzero(free[first : last + 1]) + first
            if inside.size <= LEAST_STEPS or inside[-1] - inside[0] != inside.size - 1:
                continue
            first, last = int(inside[0]), int(inside[-1])
        core = _core(y, first, last, error)
        if core is not None:
            free[first : last + 1] = False
            result.append(core)
    return result


def _windows(y: np.ndarray, reach: float) -> list[tuple[int, int]]:
    """Longest runs (first, last) whose values are within a range, at most one for each last row."""
    result, low, high, first = [], [0], [0], 0
    for i, value in enumerate(y.tolist()):
        while low and y[low[-1]] >= value:
            low.pop()
        while high and y[high[-1]] <= value:
            high.pop()
        low.append(i)
        high.append(i)
        before = first
        while y[high[0]] - y[low[0]] > reach:
            first += 1
            low, high = [k for k in low if k >= first], [k for k in high if k >= first]
        if first > before and i - 1 - before >= LEAST_STEPS:
            result.append((before, i - 1))
    if y.size - 1 - first >= LEAST_STEPS:
        result.append((first, y.size - 1))
    return result


def _core(y: np.ndarray, first: int, last: int, error: float) -> tuple[int, int, float] | None:
    """Rows in the middle of agreeing ones that show no trend, extended while the next rows keep their level."""
    count = last - first + 1
    for fraction in _CORES:
        width = max(LEAST_STEPS + 1, round(fraction * count))
        a = first + (count - width) // 2
        rows = y[a : a + width]
        level = float(np.median(rows)) if error <= 1e-9 * float(np.ptp(y)) else float(rows.mean())
        u = np.linspace(-1.0, 1.0, width)
        shape = np.polynomial.legendre.legvander(u, 2)
        explained = shape @ np.linalg.lstsq(shape, rows - level, rcond=None)[0]
        if float(explained @ explained) > TREND * error**2:
            continue
        b = a + width - 1
        while a > first and _is_level(y[a - 1 : b], level, error, True):
            a -= 1
        while b < last and _is_level(y[a + 1 : b + 2], level, error, False):
            b += 1
        return a, b, level
    return None


def _is_level(rows: np.ndarray, level: float, error: float, first: bool) -> bool:
    """Whether the rows at an end of a dwell are level: the means of the first, or last, 1, 4, 8 and 16 of them."""
    for count in (1, 4, 8, 16):
        end_rows = rows[:count] if first else rows[-count:]
        if abs(float(end_rows.mean()) - level) > AGREE * error / sqrt(end_rows.size):
            return False
    return True


def _among_all_rows(at: UnrolledRows, dwells: list[Rest], step: int) -> list[Rest]:
    """Dwells extended to all rows, where only a sample was searched."""
    if step == 1:
        return dwells
    y, reach, result = at.values[0], AGREE * at.rows.errors[0], []
    for rest in dwells:
        a, b, level = rest.first, rest.last, float(rest.level or 0.0)
        low, high = max(a - step + 1, 1), min(b + step - 1, at.count - 1)
        while a >= low and abs(y[a - 1] - level) <= reach:
            a -= 1
        while b < high and abs(y[b + 1] - level) <= reach:
            b += 1
        result.append(Rest(a, b, level))
    return result


def _without_slow_parts(at: UnrolledRows, dwells: list[Rest]) -> list[Rest]:
    """Dwells without slow parts of a stroke.

    A slow part passes its level, and its slope is not significantly below that of as many rows on either side.
    """
    y, error, result = at.values[0], at.rows.errors[0], []
    for rest in dwells:
        m = rest.last - rest.first + 1
        first = rest.first + (at.count if rest.first < m else 0)
        if 3 * m <= at.count:
            before, inside, after = (y[k : k + m] for k in (first - m, first, first + m))
            rise = 0.5 * (float(after.mean()) - float(before.mean()))  # over m rows
            position = np.arange(m) - 0.5 * (m - 1)
            slope = float(position @ (inside - inside[0])) / float(position @ position)
            slower = (rise / m - slope) * np.sign(rise)
            passes = (float(after.mean()) - float(inside.mean())) * (float(inside.mean()) - float(before.mean())) > 0.0
            if passes and slower <= PASSES * error * sqrt(12.5 / m**3):
                continue
        result.append(rest)
    return result


def _merged(at: UnrolledRows, dwells: list[Rest], error: float) -> list[Rest]:
    """Neighbouring dwells without rows outside their levels are merged; where they drift, the longer one is used."""
    result: list[Rest] = []
    for rest in dwells:
        if result:
            last = result[-1]
            low, high = sorted((float(last.level or 0.0), float(rest.level or 0.0)))
            between = at.values[0][min(last.last, rest.first) : max(last.last, rest.first) + 1]
            if (
                high - low <= STEP * error
                and between.min() >= low - 0.5 * STEP * error
                and between.max() <= high + 0.5 * STEP * error
            ):
                longer = max(last, rest, key=lambda dwell: dwell.last - dwell.first)
                result[-1] = Rest(last.first, rest.last, longer.level) if high == low else longer
                continue
        result.append(rest)
    return result


def _without_moving_rows(at: UnrolledRows, dwells: list[Rest]) -> list[Rest]:
    """Dwells without the rows at their ends that have a measured velocity."""
    if 1 not in at.values:
        return dwells
    is_at_rest = ~(np.abs(at.values[1]) > AGREE * at.rows.errors[1])  # a missing cell may be at rest
    result = []
    for rest in dwells:
        rows = np.flatnonzero(is_at_rest[rest.first : rest.last + 1]) + rest.first
        if rows.size > LEAST_STEPS:
            result.append(Rest(int(rows[0]), int(rows[-1]), rest.level))
    return result


def _with_common_levels(dwells: list[Rest], at: UnrolledRows, error: float) -> list[Rest]:
    """Dwells whose levels agree within their errors get a common level."""
    by_level = sorted(dwells, key=lambda rest: float(rest.level or 0.0))
    groups: list[list[Rest]] = []
    for rest in by_level:
        if groups:
            last = groups[-1][-1]
            bound = 3.0 * error * sqrt(sum(1.0 / (dwell.last - dwell.first + 1) for dwell in (last, rest)))
            if abs(float(rest.level or 0.0) - float(last.level or 0.0)) <= bound:
                groups[-1].append(rest)
                continue
        groups.append([rest])
    result = []
    for group in groups:
        counts = [dwell.last - dwell.first + 1 for dwell in group]
        level = float(np.average([float(dwell.level or 0.0) for dwell in group], weights=counts))
        spread = error / sqrt(sum(counts))
        result += [Rest(dwell.first, dwell.last, shortest(level, spread)) for dwell in group]
    return sorted(result, key=lambda rest: rest.first)


def slopes(at: UnrolledRows) -> np.ndarray:
    """Velocity as measured, else from differences over the fewest rows that make its error small.

    Parameters
    ----------
    at : UnrolledRows

    Returns
    -------
    ndarray (2n,) [unit of the motion per deg]
    """
    if 1 in at.values and np.isfinite(at.values[1]).all():
        return at.values[1]
    n, width, error = at.count, 1, at.rows.errors[0]
    while True:
        x, y = at.x[:n], at.values[0][:n]
        distance = np.concatenate((x[width:n], x[:width] + 360.0))
        distance -= np.concatenate((x[n - width : n] - 360.0, x[: n - width]))
        v = np.concatenate((y[width:n], y[:width]))
        v -= np.concatenate((y[n - width : n], y[: n - width]))
        v /= distance
        typical = float(np.median(distance))
        if sqrt(2.0) * error / typical <= _NOISE * max(float(v.max()), -float(v.min())) or typical > 8.0:
            return np.tile(v, 2)
        width = -(-5 * width // 4)


def _reversals(at: UnrolledRows, sampled: np.ndarray, dwells: list[Rest], error: float) -> list[Rest]:
    """Rests outside of dwells: reversals, and positions where the motion slows down to rest and continues."""
    y, v = at.values[0], np.abs(slopes(at))
    result: list[Rest] = []
    spans = (
        [(a.last, b.first) for a, b in pairwise([*dwells, _next_turn(dwells[0], at.count)])]
        if dwells
        else [(0, at.count)]
    )
    for first, last in spans:
        part = sampled[(sampled > first) & (sampled < last)] if dwells else sampled
        if last > at.count:
            part = np.append(part, sampled[sampled < last - at.count] + at.count)
        if part.size < 2 * LEAST_STEPS:
            continue
        height = float(np.ptp(y[first : last + 1]))
        prominence = max(PROMINENCE * error, 0.01 * height)
        candidates = part if dwells else np.concatenate((part, part + at.count))
        positions: set[int] = set()
        for sign in (1.0, -1.0):
            positions |= {int(candidates[k]) for k in _peaks(sign * y[candidates], prominence)}
        top = float(v[first : last + 1].max())
        for k in _peaks(-v[candidates], 0.3 * top):
            if v[candidates[k]] < SLOW * top and all(abs(candidates[k] - known) > LEAST_STEPS for known in positions):
                positions.add(int(candidates[k]))
        step = int(sampled[1] - sampled[0])
        if step > 1:  # the exact row of a sampled table
            positions = {p - step + 1 + int(np.argmin(v[p - step + 1 : p + step])) for p in positions}
        inside = {position % at.count for position in positions if first + 1 < position < last - 1 or not dwells}
        result += [Rest(position, position) for position in inside]
    return result


def _peaks(values: np.ndarray, prominence: float) -> list[int]:
    """Positions of the peaks of values (n,) with a prominence; the middle of equal values.

    ``scipy.signal.find_peaks`` takes longer to import than a table to be fitted.
    """
    peaks, top, low = [], 0, np.inf
    rising = False
    items = values.tolist()
    for i, value in enumerate(items):
        if rising and value > items[top]:
            top = i
        elif rising and value <= items[top] - prominence:
            last = top
            while items[last + 1] == items[top]:
                last += 1
            peaks.append((top + last) // 2)
            rising, low = False, value
        elif not rising:
            low = min(low, value)
            if value >= low + prominence:
                rising, top = True, i
    return peaks


def _next_turn(rest: Rest, count: int) -> Rest:
    return Rest(rest.first + count, rest.last + count, rest.level)


def shortest(value: float, spread: float) -> float:
    """Number with the fewest decimals within two spreads of a value."""
    for decimals in range(13):
        rounded = round(value, decimals)
        if abs(rounded - value) <= 2.0 * spread:
            return rounded + 0.0
    return value
