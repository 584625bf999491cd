"""Where a measured motion stands still and where it turns: dwells and reversals, and the strokes between them."""

from __future__ import annotations

from itertools import pairwise
from math import sqrt

import numpy as np

from core.frozen import frozen
from core.measured.rows import TurnRows

LEAST_STEPS = 4  # of a dwell, whose rows agree within the error
AGREE = 3.5  # errors that a row of a dwell may be off on either side
TREND = 16.0  # of χ²: what a parabola may explain of the rows of a dwell
_CORES = (1.0, 0.9, 0.8, 0.7, 0.6)  # of the rows that agree, of which a dwell may be the middle: a law leaves it slowly
MOST_SEARCHED = 7200  # rows that dwells are searched in; of longer tables every so many
STEP = 20.0  # errors by which the levels of two neighbouring dwells differ; by less, the shorter is a slow part of the way to the other
PASSES = 5.0  # standard errors by which the slope of a dwell is less than that of a slow part of a stroke
PROMINENCE = 20.0  # errors by which a reversal stands out of what is around it
SLOW = 0.04  # of the largest velocity of its stroke: a row that is slower between faster ones is a rest
_NOISE = 0.01  # of the largest velocity, that the error may make in a slope


@frozen(eq=False)
class Rest:
    """Where the velocity is zero: a dwell, or a place without length.

    first, last  rows, counted on beyond the turn
    level        of a dwell; None of another rest
    """

    first: int
    last: int
    level: float | None = None


@frozen(eq=False)
class Turned:
    """Rows laid out from one that moves on, over a little more than a turn where a stroke passes its end.

    x, values  as of ``TurnRows``, (2n,), the second turn behind the first
    count      n
    """

    rows: TurnRows
    count: int
    x: np.ndarray
    values: dict[int, np.ndarray]


def turned(rows: TurnRows) -> Turned:
    """The rows from the steepest place on."""
    y = rows.values[0]
    step = max(1, y.size // MOST_SEARCHED)
    first = int(np.argmax(np.abs(np.roll(y, -step) - y)))
    x = np.roll(rows.x, -first)
    x = np.where(np.arange(x.size) >= x.size - first, x + 360.0, x)
    twice = {order: np.tile(np.roll(values, -first), 2) for order, values in rows.values.items()}
    return Turned(rows, y.size, np.append(x, x + 360.0), twice)


def rests(at: Turned, with_dwells: bool = True) -> list[Rest]:
    """The dwells and other rests of a turn in order; none where nothing moves as far as the error."""
    step = -(-at.count // MOST_SEARCHED)
    some = np.arange(0, at.count, step)
    y, error = at.values[0][some], at.rows.errors[0]
    found = [Rest(int(some[a]), int(some[b]), level) for a, b, level in _dwells(y, error)] if with_dwells else []
    found = _levelled(_still(at, _standing(at, _whole(at, found, step))), at, error)
    found = _apart(at, found, error)
    reversals = _reversals(at, some, found, error)
    return sorted([*found, *reversals], key=lambda rest: rest.first)


def _dwells(y: np.ndarray, error: float) -> list[tuple[int, int, float]]:
    """First and last row and level of each, the longest first."""
    windows = sorted(_windows(y, 2.0 * AGREE * error), key=lambda w: w[0] - w[1])
    free, found = np.ones(y.size, dtype=bool), []
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
            found.append(core)
    return found


def _windows(y: np.ndarray, reach: float) -> list[tuple[int, int]]:
    """The longest runs (first, last) whose values are within a reach, one for each last row."""
    found, low, high, first = [], [0], [0], 0
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
            found.append((before, i - 1))
    if y.size - 1 - first >= LEAST_STEPS:
        found.append((first, y.size - 1))
    return found


def _core(y: np.ndarray, first: int, last: int, error: float) -> tuple[int, int, float] | None:
    """The rows in the middle of those that agree that show no trend, and further ones beside them as long as four in a row do not leave
    their level."""
    count = last - first + 1
    for share in _CORES:
        width = max(LEAST_STEPS + 1, round(share * count))
        a = first + (count - width) // 2
        rows = y[a : a + width]
        level = float(np.median(rows)) if error <= 1e-9 * float(np.ptp(y)) else float(rows.mean())
        u = np.linspace(-1.0, 1.0, width)
        shape = np.polynomial.legendre.legvander(u, 2)
        explained = shape @ np.linalg.lstsq(shape, rows - level, rcond=None)[0]
        if float(explained @ explained) > TREND * error**2:
            continue
        b = a + width - 1
        while a > first and _level(y[a - 1 : b], level, error, True):
            a -= 1
        while b < last and _level(y[a + 1 : b + 2], level, error, False):
            b += 1
        return a, b, level
    return None


def _level(rows: np.ndarray, level: float, error: float, first: bool) -> bool:
    """Whether the rows next to an end of a dwell are level: the means of the first, or last, 1, 4, 8 and 16 of them."""
    for count in (1, 4, 8, 16):
        some = rows[:count] if first else rows[-count:]
        if abs(float(some.mean()) - level) > AGREE * error / sqrt(some.size):
            return False
    return True


def _whole(at: Turned, found: list[Rest], step: int) -> list[Rest]:
    """The same among all rows, where only every so many were searched."""
    if step == 1:
        return found
    y, reach, whole = at.values[0], AGREE * at.rows.errors[0], []
    for rest in found:
        a, b, level = rest.first, rest.last, float(rest.level or 0.0)
        low, high = max(a - step + 1, 1), min(b + step - 1, at.count - 1)
        while a >= low and abs(y[a - 1] - level) <= reach:
            a -= 1
        while b < high and abs(y[b + 1] - level) <= reach:
            b += 1
        whole.append(Rest(a, b, level))
    return whole


def _standing(at: Turned, found: list[Rest]) -> list[Rest]:
    """The same without slow parts of a stroke: rows that pass their level no slower than as many on either side, whose slope is between
    those of both sides, and of a dwell far less."""
    y, error, kept = at.values[0], at.rows.errors[0], []
    for rest in found:
        m = rest.last - rest.first + 1
        first = rest.first + (at.count if rest.first < m else 0)
        if 3 * m <= at.count:
            before, own, behind = (y[k : k + m] for k in (first - m, first, first + m))
            rise = 0.5 * (float(behind.mean()) - float(before.mean()))  # over as many rows
            place = np.arange(m) - 0.5 * (m - 1)
            slope = float(place @ (own - own[0])) / float(place @ place)
            slower = (rise / m - slope) * np.sign(rise)
            passes = (float(behind.mean()) - float(own.mean())) * (float(own.mean()) - float(before.mean())) > 0.0
            if passes and slower <= PASSES * error * sqrt(12.5 / m**3):
                continue
        kept.append(rest)
    return kept


def _apart(at: Turned, found: list[Rest], error: float) -> list[Rest]:
    """Neighbours between which no row leaves their levels are one dwell: where these differ, it is a drift, and the longer one counts."""
    kept: list[Rest] = []
    for rest in found:
        if kept:
            last = kept[-1]
            low, high = sorted((float(last.level or 0.0), float(rest.level or 0.0)))
            between = at.values[0][min(last.last, rest.first) : max(last.last, rest.first) + 1]
            if (
                high - low <= STEP * error
                and between.min() >= low - 0.5 * STEP * error
                and between.max() <= high + 0.5 * STEP * error
            ):
                longer = max(last, rest, key=lambda each: each.last - each.first)
                kept[-1] = Rest(last.first, rest.last, longer.level) if high == low else longer
                continue
        kept.append(rest)
    return kept


def _still(at: Turned, found: list[Rest]) -> list[Rest]:
    """The same without the rows at their ends that have a velocity, where it was measured."""
    if 1 not in at.values:
        return found
    still = ~(np.abs(at.values[1]) > AGREE * at.rows.errors[1])  # a cell that is left out says nothing
    kept = []
    for rest in found:
        rows = np.flatnonzero(still[rest.first : rest.last + 1]) + rest.first
        if rows.size > LEAST_STEPS:
            kept.append(Rest(int(rows[0]), int(rows[-1]), rest.level))
    return kept


def _levelled(found: list[Rest], at: Turned, error: float) -> list[Rest]:
    """Dwells whose levels agree within their errors stand at one level."""
    by_level = sorted(found, key=lambda rest: float(rest.level or 0.0))
    groups: list[list[Rest]] = []
    for rest in by_level:
        if groups:
            last = groups[-1][-1]
            bound = 3.0 * error * sqrt(sum(1.0 / (each.last - each.first + 1) for each in (last, rest)))
            if abs(float(rest.level or 0.0) - float(last.level or 0.0)) <= bound:
                groups[-1].append(rest)
                continue
        groups.append([rest])
    levelled = []
    for group in groups:
        counts = [each.last - each.first + 1 for each in group]
        level = float(np.average([float(each.level or 0.0) for each in group], weights=counts))
        spread = error / sqrt(sum(counts))
        levelled += [Rest(each.first, each.last, shortest(level, spread)) for each in group]
    return sorted(levelled, key=lambda rest: rest.first)


def slopes(at: Turned) -> np.ndarray:
    """The velocity (2n,) [per deg]: as measured, else of the fewest rows whose error leaves it clear."""
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
        usual = float(np.median(distance))
        if sqrt(2.0) * error / usual <= _NOISE * max(float(v.max()), -float(v.min())) or usual > 8.0:
            return np.tile(v, 2)
        width = -(-5 * width // 4)


def _reversals(at: Turned, some: np.ndarray, dwells: list[Rest], error: float) -> list[Rest]:
    """Rests outside of dwells: where the motion turns, and where it slows down to nothing and goes on."""
    y, v = at.values[0], np.abs(slopes(at))
    found: list[Rest] = []
    spans = (
        [(a.last, b.first) for a, b in pairwise([*dwells, _again(dwells[0], at.count)])] if dwells else [(0, at.count)]
    )
    for first, last in spans:
        part = some[(some > first) & (some < last)] if dwells else some
        if last > at.count:
            part = np.append(part, some[some < last - at.count] + at.count)
        if part.size < 2 * LEAST_STEPS:
            continue
        height = float(np.ptp(y[first : last + 1]))
        prominence = max(PROMINENCE * error, 0.01 * height)
        around = part if dwells else np.concatenate((part, part + at.count))
        places: set[int] = set()
        for sign in (1.0, -1.0):
            places |= {int(around[k]) for k in _peaks(sign * y[around], prominence)}
        top = float(v[first : last + 1].max())
        for k in _peaks(-v[around], 0.3 * top):
            if v[around[k]] < SLOW * top and all(abs(around[k] - other) > LEAST_STEPS for other in places):
                places.add(int(around[k]))
        step = int(some[1] - some[0])
        if step > 1:  # of a longer table: the very row
            places = {p - step + 1 + int(np.argmin(v[p - step + 1 : p + step])) for p in places}
        inside = {place % at.count for place in places if first + 1 < place < last - 1 or not dwells}
        found += [Rest(place, place) for place in inside]
    return found


def _peaks(values: np.ndarray, prominence: float) -> list[int]:
    """Where values (n,) are largest between two places that lie lower by the prominence; the middle where it is several in a row. As
    ``scipy.signal.find_peaks``, which takes longer to import than a table to be fitted."""
    found, top, low = [], 0, np.inf
    rising = False
    each = values.tolist()
    for i, value in enumerate(each):
        if rising and value > each[top]:
            top = i
        elif rising and value <= each[top] - prominence:
            last = top
            while each[last + 1] == each[top]:
                last += 1
            found.append((top + last) // 2)
            rising, low = False, value
        elif not rising:
            low = min(low, value)
            if value >= low + prominence:
                rising, top = True, i
    return found


def _again(rest: Rest, count: int) -> Rest:
    return Rest(rest.first + count, rest.last + count, rest.level)


def shortest(value: float, spread: float) -> float:
    """The number of fewest decimals within two spreads around a value."""
    for decimals in range(13):
        rounded = round(value, decimals)
        if abs(rounded - value) <= 2.0 * spread:
            return rounded + 0.0
    return value


__all__ = ["Rest", "Turned", "rests", "shortest", "slopes", "turned"]
