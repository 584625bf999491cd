"""A measured motion as segments: dwells that stand exactly still, laws where they are recognised, tables between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import sqrt

import numpy as np

from core.design import Motion, Segment, SplinePoint, TableCurve, join_angles
from core.errors import KindynaError
from core.frozen import frozen
from core.laws.polynomial import quintics
from core.measured.recognition import FAR, WELL, Stroke, joined, recognise, tiers
from core.measured.rows import TurnRows
from core.measured.smoothing import End, smooth
from core.measured.strokes import LEAST_STEPS, Rest, Turned, rests, turned
from core.motion import Angles, program
from core.motion.split import with_segment_split

MOST_THROUGH = (
    1000  # rows without velocities that a curve of least jerk goes through; more are smoothed as far as they are exact
)
SHORT = 0.1  # of the strokes beside it: a dwell shorter than this may be the crest of a flat law
LONGEST_CREST = 60.0  # degrees
SHOWN = 0.02  # of the largest acceleration: what jumps by less at a dwell is the truncation of its rows
JUMP = 8.0  # times what is usual: by how much velocities change more than their accelerations say where one jumps
LEVEL = 10.0  # errors that the ends of a stretch may stand apart that is made a dwell
FAR_ERRORS, FAR_SHARE = 10.0, 1e-3  # errors, share of the stroke: the larger is what a row may be off its law or table
TABLE, DWELL = "table", "dwell"
MOST_FITTED = 600  # rows, or means of as many, that tell where a dwell is left
FINE = 1e-6  # of the largest value: rows with smaller errors are met within two of their last digit
LEFT_BY = (
    1e-2,
    1e-3,
    1e-4,
    0.0,
)  # of the largest value, up to which rows beside a dwell tell where it is left, at least ``ONSET``
ONSET = 60.0  # errors, up to which the rows beside a dwell tell where it is left


@frozen
class SegmentFit:
    """What was found between two cam angles: law, start [deg] in the turn, span, rise; of rows numbered along the turn.

    ambiguous  laws of which none is named, as they fit as well as each other
    """

    law: str
    start_deg: float
    span_deg: float
    rise: float
    ambiguous: tuple[str, ...] = ()


@frozen
class AccelerationJump:
    """Where the acceleration jumps: cam angle [deg], before and behind, by degrees."""

    angle: float
    before: float
    after: float


@frozen(eq=False)
class Structure:
    """motion: over the turn; found: its segments as they were recognised, one that passes cam angle 0 in one; free: values that were
    chosen; smoothing: λ of the first stretch that was smoothed, 0 without one."""

    motion: Motion
    segments: tuple[SegmentFit, ...]
    jumps: tuple[AccelerationJump, ...]
    freedom: float
    smoothing: float


@frozen(eq=False)
class _Part:
    """A stretch in order: [start, end] deg counted on, levels at both ends; what it is. bends: the acceleration jumps where the dwell
    before it, or behind it, is left. number: of the stroke that is a law."""

    start: float
    end: float
    low: float
    high: float
    stroke: Stroke | None = None
    dwells: bool = False
    ambiguous: tuple[str, ...] = ()
    bends: tuple[bool, bool] = (False, False)
    number: int = -1


Switches = Sequence[tuple[float, str]]
"""Cam angles [deg], and what the segment there shall be in place of what is found: table, dwell, or a named law."""


class SwitchError(KindynaError):
    """A segment cannot be what the user wants it to be."""


def segment_kinds() -> tuple[str, ...]:
    """What a segment can be made: a table, a dwell, or one of the named laws."""
    return (TABLE, DWELL, *(candidate.name for candidate in tiers(1.0)[0]))


def structured(
    rows: TurnRows,
    unit: str,
    with_laws: bool = True,
    with_dwells: bool = True,
    switches: Switches = (),
) -> Structure | None:
    """The segments of a motion; None where nothing tells where one begins. switches: what the segment at a cam angle [deg] shall be, of
    ``segment_kinds``, in place of what is found there.

    Raises SwitchError where a law or a dwell cannot lie there.
    """
    at = turned(rows)
    found = rests(at, with_dwells)
    if not found or (len(found) == 1 and found[0].last - found[0].first >= at.count - 2):
        if found and found[0].level is not None:
            motion = Motion(found[0].level, (Segment(360.0, 0.0),), unit)
            return Structure(motion, (SegmentFit("dwell", 0.0, 360.0, 0.0),), (), 1.0, 0.0)
        return None
    found, strokes = _recognised(at, found, with_laws)
    if not any(strokes_of[0] for strokes_of in strokes) and not any(rest.level is not None for rest in found):
        return None
    found, strokes = _from_a_rest(at, found, strokes)
    strokes = _switched_strokes(at, found, strokes, switches)
    while True:
        parts = _joined_tables(_switched_parts(_parts(at, found, strokes), switches, rows.errors[0], unit))
        if len(parts) == 1 and not parts[0].dwells and parts[0].stroke is None:
            return None
        result = _Assembly(at, parts, unit).structure()
        wrong = set() if switches else _far_laws(at, parts, result.motion)
        if not wrong:
            return result
        strokes = [(None, ()) if k in wrong else each for k, each in enumerate(strokes)]


def far(error: float, stroke: float) -> float:
    """What a row may be off a law or a table, at most."""
    return max(FAR_ERRORS * error, FAR_SHARE * stroke)


def _far_laws(at: Turned, parts: list[_Part], motion: Motion) -> set[int]:
    """The strokes, by number, whose law is far off a row."""
    x, y, compiled = at.rows.x, at.rows.values[0], program(motion)
    off = np.abs(y - compiled.state(compiled.angles(np.deg2rad(x))).displacement[0] / motion.scale)
    wrong = x[off > far(at.rows.errors[0], float(np.ptp(y)))]
    return {
        part.number
        for part in parts
        if part.stroke is not None and np.any(np.mod(wrong - part.start, 360.0) <= part.end - part.start)
    }


# -- what the user makes of them --------------------------------------------------------------------------


def _switched_strokes(
    at: Turned, found: list[Rest], strokes: list[_Recognised], switches: Switches
) -> list[_Recognised]:
    """The strokes between rests, those at the cam angles [deg] of switches as tables or the laws that are wanted there."""
    strokes = list(strokes)
    for angle, wanted in switches:
        if wanted not in segment_kinds():
            raise SwitchError(f"segment at {angle:g} deg: {wanted!r} is none; allowed: {', '.join(segment_kinds())}")
        for k, (rest, behind) in enumerate(pairwise(_around(at, found))):
            start = _angle(at, rest.last)
            if wanted == DWELL or (angle - start) % 360.0 >= _angle(at, behind.first) - start:
                continue
            if wanted == TABLE:
                strokes[k] = None, ()
                continue
            stroke, _ = recognise(at, rest, behind, wanted)
            if stroke is None or stroke.end - stroke.start < LEAST_STEPS * 360.0 / at.count:
                raise SwitchError(f"segment at {angle:g} deg: too short or too low to be {wanted}; make it a table")
            strokes[k] = stroke, ()
    return strokes


def _switched_parts(parts: list[_Part], switches: Switches, error: float, unit: str) -> list[_Part]:
    """The same, dwells and tables at the cam angles [deg] of switches exchanged."""
    begin = parts[0].start
    for angle, wanted in switches:
        place = begin + (angle - begin) % 360.0
        k = next((k for k, part in enumerate(parts) if part.start <= place < part.end), len(parts) - 1)
        part = parts[k]
        if wanted == TABLE and part.dwells:
            parts[k] = replace(part, dwells=False)
        elif wanted == DWELL and not part.dwells:
            if abs(part.high - part.low) > LEVEL * error:
                raise SwitchError(
                    f"segment at {angle:g} deg: its ends stand {abs(part.high - part.low):.4g} {unit} apart; a dwell's stand at one level"
                )
            parts[k] = replace(part, dwells=True, stroke=None, high=part.low)
            behind = (k + 1) % len(parts)
            parts[behind] = replace(parts[behind], low=part.low)
            if parts[behind].dwells:
                parts[behind] = replace(parts[behind], high=part.low)
        elif wanted not in (TABLE, DWELL) and part.stroke is None:
            raise SwitchError(f"segment at {angle:g} deg: it stands still, and cannot be {wanted}")
    return parts


def _joined_tables(parts: list[_Part]) -> list[_Part]:
    """The same, dwells or tables that follow on each other as one."""

    def alike(one: _Part, other: _Part) -> bool:
        return one.stroke is None and other.stroke is None and one.dwells == other.dwells

    if len(parts) > 1 and alike(parts[-1], parts[0]):
        last = parts[-1]
        parts = [replace(last, start=last.start - 360.0, end=parts[0].start), *parts[:-1]]
    made = parts[:1]
    for part in parts[1:]:
        last = made[-1]
        if alike(last, part):
            made[-1] = replace(
                last,
                end=part.end,
                high=part.high,
                ambiguous=last.ambiguous + part.ambiguous,
                bends=(last.bends[0], part.bends[1]),
            )
        else:
            made.append(part)
    return made


# -- laws -------------------------------------------------------------------------------------------------

_Recognised = tuple[Stroke | None, tuple[str, ...]]


def _top(rest: Rest) -> Rest:
    """A reversal in place of a dwell."""
    middle = (rest.first + rest.last) // 2
    return Rest(middle, middle)


def _later(rest: Rest, count: int) -> Rest:
    return replace(rest, first=rest.first + count, last=rest.last + count)


def _around(at: Turned, found: Sequence[Rest]) -> list[Rest]:
    return [*found, _later(found[0], at.count)]


def _recognised(at: Turned, found: list[Rest], with_laws: bool) -> tuple[list[Rest], list[_Recognised]]:
    """The laws of all strokes; short dwells that are the crest of a stroke and its return are none."""
    if not with_laws:
        return found, [(None, ())] * len(found)

    known: dict[tuple[int, int, float | None, int, int, float | None], _Recognised] = {}

    def laws(found: list[Rest]) -> list[_Recognised]:
        answers = []
        for a, b in pairwise(_around(at, found)):
            key = (a.first, a.last, a.level, b.first, b.last, b.level)
            if key not in known:
                stroke, rivals = recognise(at, a, b)
                known[key] = stroke, tuple(rivals)
            answers.append(known[key])
        return answers

    def without(found: list[Rest], some: list[Rest]) -> tuple[list[Rest], list[_Recognised]] | None:
        """The same with a reversal in place of each of some dwells, where every stroke beside them is a law then."""
        changed = [_top(each) if each in some else each for each in found]
        answers = laws(changed)
        beside = {k for i, each in enumerate(found) if each in some for k in (i - 1, i)}
        return (changed, answers) if all(answers[k][0] is not None for k in beside) else None

    strokes = laws(found)
    doubtful = [rest for i, rest in enumerate(found) if len(found) > 1 and _is_doubtful(at, found, strokes, i)]
    for some in [doubtful, *([each] for each in doubtful if len(doubtful) > 1)]:
        changed = without(found, some) if some else None
        if changed is not None:
            found, strokes = changed
    return found, strokes


def _is_doubtful(at: Turned, found: list[Rest], strokes: list[_Recognised], i: int) -> bool:
    """Whether a dwell may be the crest of a stroke and its return: those beside it leave it no span, or are no law while it is short."""
    rest, left, right = found[i], strokes[i - 1][0], strokes[i][0]
    if rest.level is None or at.x[rest.last] - at.x[rest.first] > LONGEST_CREST:
        return False
    if left is not None and right is not None:
        gap = (right.start - left.end + 180.0) % 360.0 - 180.0
        return gap <= max(
            4.0 * (left.spread[1] + right.spread[0]), LEAST_STEPS * 360.0 / at.count
        )  # no dwell is shorter
    beside = (rest.first - found[i - 1].last) % at.count + (found[(i + 1) % len(found)].first - rest.last) % at.count
    return rest.last - rest.first <= max(SHORT * beside, 3 * LEAST_STEPS)


def _from_a_rest(at: Turned, found: list[Rest], strokes: list[_Recognised]) -> tuple[list[Rest], list[_Recognised]]:
    """In an order that begins with a dwell, else behind a stroke that is no law."""
    first = next((i for i, rest in enumerate(found) if rest.level is not None), None)
    if first is None:
        first = next((i for i, (stroke, _) in enumerate(strokes) if stroke is None), 0)
    turned_rests = [*found[first:], *(_later(rest, at.count) for rest in found[:first])]
    return turned_rests, [*strokes[first:], *strokes[:first]]


def _parts(at: Turned, found: list[Rest], strokes: list[_Recognised]) -> list[_Part]:
    """Dwells, laws and what is left between them, from the first rest to the same a turn later."""
    closed = _around(at, found)
    laws: list[Stroke | None] = [stroke for stroke, _ in strokes]
    i = 0
    while i < len(laws):  # those that meet at reversals are fitted together
        j = i
        while j < len(laws) and laws[j] is not None and (j == i or closed[j].level is None):
            j += 1
        if j > i:
            chain = [
                _moved(at, stroke, rest, behind)
                for stroke, rest, behind in zip(laws[i:j], closed[i:j], closed[i + 1 :], strict=False)
            ]
            together = joined(at, chain)
            laws[i:j] = [None] * (j - i) if together is None else [_at_zero(each) for each in together]
        i = max(j, i + 1)
    if closed[0].level is None and all(laws):  # all around: its first and last rest are the same
        first, last = laws[0], laws[-1]
        assert first is not None
        assert last is not None
        angle, level = 0.5 * (first.start + last.end - 360.0), 0.5 * (first.low + last.high)
        laws[0], laws[-1] = replace(first, start=angle, low=level), replace(last, end=angle + 360.0, high=level)
        if len(laws) == 1:
            laws[0] = replace(first, start=angle, low=level, end=angle + 360.0, high=level)
    parts: list[_Part] = []
    gaps = [behind.first - rest.last for rest, behind in pairwise(closed)]
    dwells: list[tuple[float, float] | None] = []
    for k, rest in enumerate(closed[:-1]):
        stroke, before = laws[k], laws[k - 1]
        if rest.level is None:
            dwells.append(None)
            continue
        start = (
            before.end - (360.0 if k == 0 else 0.0) if before is not None else onset(at, rest, False, gaps[k - 1])[0]
        )
        end = stroke.start if stroke is not None else onset(at, rest, True, gaps[k])[0]
        dwells.append((start, end) if end - start > 360.0 / at.count else None)  # a crest is left where it is reached
    closed = _around(at, [_top(rest) if dwell is None else rest for rest, dwell in zip(found, dwells, strict=True)])
    for k, (rest, behind) in enumerate(pairwise(closed)):
        stroke, before, dwell = laws[k], laws[k - 1], dwells[k]
        if dwell is not None and rest.level is not None:
            parts.append(_Part(*dwell, rest.level, rest.level, dwells=True))
        if stroke is not None:
            parts.append(_Part(stroke.start, stroke.end, stroke.low, stroke.high, stroke, number=k))
            continue
        after = laws[(k + 1) % len(laws)]
        y = at.values[0]
        start, low = (
            (before.end - (360.0 if k == 0 else 0.0), before.high)
            if before is not None
            else (_angle(at, rest.last), float(y[rest.last % at.count]))
        )
        bends = [False, False]
        if rest.level is not None:
            (start, bends[0]), low = onset(at, rest, True, gaps[k]), rest.level
        if behind.level is not None:
            (end, bends[1]), high = onset(at, behind, False, gaps[k]), behind.level
        elif after is not None:
            end, high = after.start + (360.0 if k == len(laws) - 1 else 0.0), after.low
        else:
            end, high = _angle(at, behind.first), float(y[behind.first % at.count])
        if (
            parts and parts[-1].stroke is None and not parts[-1].dwells
        ):  # two that are no law meet at a reversal: one table
            until = parts[-1]
            parts[-1] = replace(
                until, end=end, high=high, ambiguous=until.ambiguous + strokes[k][1], bends=(until.bends[0], bends[1])
            )
        else:
            parts.append(_Part(start, end, low, high, ambiguous=strokes[k][1], bends=(bends[0], bends[1])))
    return parts


def _at_zero(stroke: Stroke) -> Stroke:
    """A stroke whose ends stand at cam angle 0 where they do within their errors."""
    ends = [
        round(end / 360.0) * 360.0 if abs(end - round(end / 360.0) * 360.0) <= 4.0 * spread + 1e-9 else end
        for end, spread in zip((stroke.start, stroke.end), stroke.spread, strict=True)
    ]
    return replace(stroke, start=ends[0], end=ends[1])


def onset(at: Turned, rest: Rest, behind: bool, gap: int) -> tuple[float, bool]:
    """Where a dwell is left, behind it or before it [deg], and whether with a jump of acceleration: of c |θ - θ₀|ᵖ, p = 3, 4 or 2, the one
    that fits the rows beside the dwell best; 2 only where the others do clearly worse. No later than the first row that has left its level.
    Exact rows tell it themselves. gap: rows to the next rest, of which half are looked at."""
    edge, n = (rest.last if behind else rest.first), at.count
    if at.rows.exact:
        return _angle(at, edge), False
    sign, error, height = (1 if behind else -1), at.rows.errors[0], at.rows.sizes[0]
    most = min(n // 4, max(gap // 2, 1))
    away = np.abs(at.values[0][(edge + sign * np.arange(most)) % n] - float(rest.level or 0.0))
    fine = error <= FINE * height
    for share in LEFT_BY if fine else LEFT_BY[:1]:  # as far as one power follows rows that are known so well
        left = away >= max(ONSET * error, share * height)
        beyond, bends, explained = _onset(at, rest, behind, int(np.argmax(left)) if left.any() else most)
        if explained:
            break
    gone = np.flatnonzero(away > FAR * error)  # from the first of these rows on nothing is level
    if gone.size:
        level, moving = (abs(_angle(at, edge + sign * k) - _angle(at, edge)) for k in (int(gone[0]) - 1, int(gone[0])))
        if beyond >= moving or (fine and not explained):
            beyond, bends = level, False
    angle = _angle(at, edge) + sign * beyond
    zero = 360.0 * round(angle / 360.0)
    return zero if abs(angle - zero) < 0.5 * 360.0 / n else angle, bends  # not so near beside cam angle 0


def _onset(at: Turned, rest: Rest, behind: bool, reach: int) -> tuple[float, bool, bool]:
    """How far from its last row [deg] a dwell is left, by so many rows beyond it; whether the acceleration jumps there, and whether the
    rows agree with that."""
    sign, edge, n = (1, rest.last, at.count) if behind else (-1, rest.first, at.count)
    inside = min((rest.last - rest.first) // 2, 2 * reach + LEAST_STEPS)
    numbers = edge + sign * np.arange(-inside, reach + 1)
    together = -(-numbers.size // MOST_FITTED)  # rows that count as one, their mean
    numbers = numbers[: numbers.size // together * together]
    x = sign * (at.x[numbers % n] + 360.0 * (numbers // n) - _angle(at, edge)).reshape(-1, together).mean(axis=1)
    off = (at.values[0][numbers % n] - float(rest.level or 0.0)) / at.rows.errors[0]
    off = sqrt(together) * off.reshape(-1, together).mean(axis=1)
    best: dict[int, tuple[float, float]] = {}
    for power in (3, 4, 2):
        tried = np.linspace(x[0], x[-2], 241)
        basis = np.maximum(x[None, :] - tried[:, None], 0.0) ** power
        square = (basis**2).sum(axis=1)
        left = float(off @ off) - np.where(square > 0.0, (basis @ off) ** 2 / np.where(square > 0.0, square, 1.0), 0.0)
        k = int(np.argmin(left))
        best[power] = float(left[k]), float(tried[k])
    smooth_power = min((3, 4), key=lambda power: best[power][0])
    bends = best[2][0] < best[smooth_power][0] - 2.0 * WELL
    left_over, beyond = best[2 if bends else smooth_power]
    return beyond, bends, left_over <= off.size + 5.0 * sqrt(2.0 * off.size)


def _angle(at: Turned, row: int) -> float:
    return float(at.x[row % at.count]) + 360.0 * (row // at.count)


def _moved(at: Turned, stroke: Stroke | None, rest: Rest, behind: Rest) -> Stroke:
    """A stroke with its rests and angles counted as those around it."""
    assert stroke is not None
    middle = 0.5 * (_angle(at, rest.last) + _angle(at, behind.first))
    turns = 360.0 * round((middle - 0.5 * (stroke.start + stroke.end)) / 360.0)
    return replace(stroke, left=rest, right=behind, start=stroke.start + turns, end=stroke.end + turns)


# -- segments ---------------------------------------------------------------------------------------------


def difference(after: float, before: float) -> float:
    """after - before, without the last bits that binary numbers leave where both are decimals."""
    whole = after - before
    return (
        rounded + 0.0
        if abs((rounded := round(whole, 9)) - whole) < 1e-15 * max(abs(after), abs(before), 1.0)
        else whole
    )


class _Assembly:
    """The parts as segments from their first on, and then from cam angle 0 on."""

    def __init__(self, at: Turned, parts: list[_Part], unit: str) -> None:
        self.at, self.parts, self.unit = at, parts, unit
        self.jumps: list[AccelerationJump] = []
        self.freedom, self.smoothing = 0.0, 0.0

    def structure(self) -> Structure:
        begin = self.parts[0].start
        segments: list[Segment] = []
        found: list[SegmentFit] = []
        total = 0.0
        for i, part in enumerate(self.parts):
            end = part.end if i + 1 < len(self.parts) else begin + 360.0
            start = self.parts[i].start
            span, rise = difference(end, start), difference(part.high, part.low)
            if span <= 1e-6:
                continue
            if part.dwells:
                segments.append(Segment(span, 0.0))
                found.append(SegmentFit("dwell", start % 360.0, span, 0.0))
                self.freedom += 1.0
            elif part.stroke is not None:
                whole = part.stroke.candidate.curves(part.stroke.fractions)
                made, angle, level = [], start, part.low
                for k, (share, height, curve) in enumerate(whole):
                    last = k + 1 == len(whole)
                    next_angle = end if last else angle + share * span
                    next_level = part.high if last else level + height * rise
                    made.append(Segment(difference(next_angle, angle), difference(next_level, level), curve))
                    found.append(SegmentFit(curve.law, angle % 360.0, made[-1].span_deg, made[-1].rise))
                    angle, level = next_angle, next_level
                segments += made
                self.freedom += 2.0 + len(part.stroke.fractions)
            else:
                before = self.parts[i - 1]
                after = self.parts[(i + 1) % len(self.parts)]
                for segment in self._tables(part, start, end, before, after):
                    segments.append(segment)
                    found.append(
                        SegmentFit("table", (start + total) % 360.0, segment.span_deg, segment.rise, part.ambiguous)
                    )
                    total += segment.span_deg
                total = 0.0
        return Structure(
            _from_zero(begin, self.parts[0].low, segments, self.unit),
            tuple(sorted(found, key=lambda each: each.start_deg)),
            tuple(self.jumps),
            self.freedom,
            self.smoothing,
        )

    def _tables(self, part: _Part, start: float, end: float, before: _Part, after: _Part) -> list[Segment]:
        """What is no law: tables from rest to rest, as smooth as the errors allow, one more where the acceleration jumps."""
        at, n = self.at, self.at.count
        x = np.concatenate((at.x[:n] - 360.0, at.x[:n], at.x[:n] + 360.0))
        inside = np.flatnonzero((x > start + 1e-9) & (x < end - 1e-9))
        angles, numbers = x[inside], inside % n
        values = {order: y[numbers] for order, y in at.values.items()}
        ends = _end(part.low, before, False), _end(part.high, after, True)
        rows = at.rows
        if (
            rows.exact
            and {0, 1, 2} <= values.keys()
            and all(rows.errors[k] <= 1.001e-10 * rows.sizes[k] for k in (1, 2))
        ):
            return self._through_all(start, end, angles, values, ends)
        if rows.exact and angles.size <= MOST_THROUGH:
            made = [SplinePoint(0.0, 0.0, *ends[0][1:])]
            made += [
                SplinePoint(
                    difference(a, start), float(y - part.low), *((float(v),) if 1 in values and np.isfinite(v) else ())
                )
                for a, y, v in zip(angles.tolist(), values[0], values.get(1, values[0]), strict=True)
            ]
            made.append(SplinePoint(difference(end, start), part.high - part.low, *ends[1][1:]))
            self.freedom += angles.size
            return [Segment(difference(end, start), difference(part.high, part.low), TableCurve(tuple(made)))]
        ends = tuple(
            (*end_state[:2], None) if bends else end_state for end_state, bends in zip(ends, part.bends, strict=True)
        )  # type: ignore[assignment]
        fitted = smooth(angles, values, rows.errors, start, end, ends)
        for place, state, bends in ((start, 0, part.bends[0]), (end, -1, part.bends[1])):
            if bends:
                jump = float(fitted.states[state, 2])
                self.jumps.append(AccelerationJump(place % 360.0, *((0.0, jump) if state == 0 else (jump, 0.0))))
        self.freedom += fitted.freedom
        self.smoothing = self.smoothing or fitted.smoothing
        return [_segment(fitted.knots, fitted.states, part.low, part.high)]

    def _row(self, angle: float) -> int | None:
        """The row that stands at a cam angle [deg]."""
        near = np.flatnonzero(np.abs(np.mod(self.at.rows.x - angle + 180.0, 360.0) - 180.0) < 1e-9)
        return int(near[0]) if near.size else None

    def _through_all(
        self, start: float, end: float, angles: np.ndarray, values: dict[int, np.ndarray], ends: tuple[End, End]
    ) -> list[Segment]:
        """Quintics through exact rows, cut where the acceleration jumps."""
        y = np.array([values[k] for k in range(3)])
        first, last = (np.array([[float(v) if v is not None else np.nan] for v in side]) for side in ends)
        whole = np.isfinite(y).all(axis=0)  # a row with a cell that is left out is met by the others alone
        x, states = np.concatenate(([start], angles[whole], [end])), np.hstack((first, y[:, whole], last))
        h, largest = np.diff(x), self.at.rows.sizes[2]
        if self._row(start) is not None and not np.isnan(row := self.at.rows.values[2][self._row(start)]):
            states[2, 0] = row
            if abs(row) > SHOWN * largest and ends[0][2] == 0.0:
                self.jumps.append(AccelerationJump(start % 360.0, 0.0, float(row)))
        last_left = (
            2.0 * (states[1, -1] - states[1, -2]) / h[-1] - states[2, -2]
        )  # of a row at a jump only the right side is known
        if self._row(end) is not None and ends[1][2] == 0.0 and abs(last_left) > SHOWN * largest:
            states[2, -1] = last_left
            self.jumps.append(AccelerationJump(end % 360.0, float(last_left), 0.0))
        missed = np.diff(states[1]) - 0.5 * h * (states[2, :-1] + states[2, 1:])
        size = np.abs(missed) / h
        usual = np.median(size) + 1e-9 * self.at.rows.sizes[2]
        around = np.maximum(np.roll(size, 2), np.roll(size, -2))
        cuts = np.flatnonzero((size > JUMP * np.maximum(usual, around)) & (size > 2e-3 * self.at.rows.sizes[2]))
        cuts = cuts[
            (cuts > 0) & (cuts < h.size - 2)
        ].tolist()  # where a dwell is left between two rows nothing need jump
        made: list[Segment] = []
        begin = 0
        for cut in [*cuts, h.size - 1]:
            part = states[:, begin : cut + 2].copy()
            if cut in cuts:
                after = float(states[2, cut + 1])
                part[2, -1] = 2.0 * (states[1, cut + 1] - states[1, cut]) / h[cut] - states[2, cut]
                self.jumps.append(AccelerationJump(float(x[cut + 1] % 360.0), float(part[2, -1]), after))
            keep = _thinned(x[begin : cut + 2], part, self.at.rows)
            made.append(_segment(x[begin : cut + 2][keep], part.T[keep], float(part[0, 0]), float(part[0, -1])))
            self.freedom += 3.0 * keep.size
            begin = cut + 1
        return made


def _end(level: float, beside: _Part, behind: bool) -> End:
    """What is known of an end: it stands still, with the acceleration of the law beside it."""
    if beside.dwells:
        return (level, 0.0, 0.0)
    if beside.stroke is None:
        return (level, None, None)
    return (level, 0.0, _end_acceleration(beside, start=behind))


def _end_acceleration(part: _Part, start: bool) -> float:
    assert part.stroke is not None
    table = part.stroke.candidate.table(part.stroke.fractions)
    assert table is not None
    u = np.array([0.0 if start else 1.0])
    return float(table.at(u)[2][0]) * (part.high - part.low) / (part.end - part.start) ** 2


def _segment(knots: np.ndarray, states: np.ndarray, low: float, high: float) -> Segment:
    start = float(knots[0])
    places = [difference(place, start) for place in knots.tolist()]
    heights = (states[:, 0] - low).tolist()
    heights[0], heights[-1] = 0.0, difference(high, low)
    points = tuple(
        SplinePoint(*row) for row in zip(places, heights, states[:, 1].tolist(), states[:, 2].tolist(), strict=True)
    )
    return Segment(places[-1], heights[-1], TableCurve(points))


def _quintic(knots: np.ndarray, states: np.ndarray, x: np.ndarray, order: int = 0) -> np.ndarray:
    """s⁽ᵏ⁾ (n,) of the curve with these states (m, 3) at knots (m,)."""
    i = np.clip(np.searchsorted(knots, x, side="right") - 1, 0, knots.size - 2)
    rows = quintics(np.diff(knots), states[:-1, :, None], states[1:, :, None])[:, :, 0]
    w, found = x - knots[i], np.zeros(x.size)
    for power in range(5, order - 1, -1):
        found = found * w + float(np.prod(np.arange(power - order + 1, power + 1))) * rows[i, power]
    return found


def _thinned(x: np.ndarray, states: np.ndarray, rows: TurnRows) -> np.ndarray:
    """The fewest rows, found by halving, whose quintics meet all others: numbers (k,)."""
    keep = np.unique(np.linspace(0, x.size - 1, min(x.size, 13)).astype(int))
    while keep.size < x.size:
        off = np.zeros(x.size, dtype=bool)
        for order in range(3):
            curve = _quintic(x[keep], states.T[keep], x, order)
            off |= np.abs(curve - states[order]) > rows.errors[order]
        off[keep] = False
        if not off.any():
            break
        interval = np.unique(np.searchsorted(keep, np.flatnonzero(off)))
        keep = np.union1d(keep, (keep[interval - 1] + keep[interval]) // 2)
    return keep


# -- cam angle 0 ------------------------------------------------------------------------------------------


def _from_zero(begin: float, level: float, segments: list[Segment], unit: str) -> Motion:
    """The segments in order from cam angle 0 on; the one that passes it is cut there. A law that is cut is no law of the table any more,
    and becomes one of rows that hold it."""
    motion = Motion(level, tuple(segments), unit)
    cut = (-begin) % 360.0
    if cut < 1e-9 or cut > 360.0 - 1e-9:
        return motion
    starts = np.array(join_angles(motion))
    near = int(np.argmin(np.abs(starts - cut)))
    if abs(starts[near] - cut) > 1e-9:
        index = int(np.searchsorted(starts, cut)) - 1
        segment = motion.segments[index]
        law = segment.curve.law
        if law == "dwell":
            parts = (
                Segment(difference(cut, float(starts[index])), 0.0),
                Segment(difference(float(starts[index]) + segment.span_deg, cut), 0.0),
            )
            return Motion(
                level + sum(s.rise for s in motion.segments[:index]),
                (parts[1], *motion.segments[index + 1 :], *motion.segments[:index], parts[0]),
                unit,
            )
        if not isinstance(segment.curve, TableCurve) and law not in ("constant-velocity", "cv1", "cv2"):
            motion = replace(
                motion, segments=tuple(_as_table(motion, i) if i == index else s for i, s in enumerate(motion.segments))
            )
        motion = with_segment_split(motion, index, cut)
        near = index + 1
    height = level + sum(s.rise for s in motion.segments[:near])
    return Motion(height, (*motion.segments[near:], *motion.segments[:near]), unit)


def _as_table(motion: Motion, index: int) -> Segment:
    """A segment as a table whose quintics hold its curve: to 1e-9 of its acceleration."""
    compiled, segment = program(motion), motion.segments[index]
    start, span = join_angles(motion)[index], segment.span_deg
    own = np.flatnonzero(compiled.segment == index)
    joints = np.append(np.rad2deg(compiled.starts[own]), start + span)

    def states(x: np.ndarray) -> np.ndarray:
        piece = own[np.clip(np.searchsorted(joints, x, side="right") - 1, 0, own.size - 1)]
        y = compiled.state(Angles(np.deg2rad(x), piece)).displacement
        return np.array([y[k] * np.deg2rad(1.0) ** k for k in range(3)]) / motion.scale

    x = np.unique(np.concatenate([np.linspace(a, b, 5) for a, b in pairwise(joints)]))
    size = float(np.abs(states(x)[2]).max())
    for _ in range(8):
        y = states(x)
        y[2, -1] = states(np.array([x[-1]]))[2, 0]
        middle = 0.5 * (x[:-1] + x[1:])
        off = np.abs(_quintic(x, y.T, middle, 2) - states(middle)[2]) > 1e-9 * size
        if not off.any():
            break
        x = np.sort(np.append(x, middle[off]))
    y = states(x)
    return _segment(x, y.T, float(y[0, 0]), float(y[0, 0]) + segment.rise)


__all__ = [
    "DWELL",
    "LEVEL",
    "TABLE",
    "AccelerationJump",
    "SegmentFit",
    "Structure",
    "SwitchError",
    "Switches",
    "difference",
    "far",
    "segment_kinds",
    "structured",
]
