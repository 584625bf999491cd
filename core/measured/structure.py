"""Segments of a measured motion: dwells, laws where they are recognised, tables between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import sqrt

import numpy as np

from core.design import Motion, Segment, SplinePoint, TableCurve
from core.errors import KindynaError
from core.frozen import frozen
from core.measured.candidates import Stroke, tiers
from core.measured.recognition import FAR, WELL, fitted_together, recognise
from core.measured.rows import TurnRows
from core.measured.segments import difference, quintic_segment, thin_knots, with_start_at_zero
from core.measured.smoothing import End, smooth
from core.measured.strokes import LEAST_STEPS, Rest, UnrolledRows, rests, unrolled
from core.motion import program
from core.number_text import result_text

MOST_THROUGH = 1000  # greatest number of exact rows without velocities through which a curve of least jerk passes
SHORT = 0.1  # length of a dwell relative to its strokes, below which it may be the crest of a flat law
LONGEST_CREST = 60.0  # [deg]
SHOWN = 0.02  # least jump of the acceleration at a dwell relative to the largest one; less is rounding of the rows
JUMP = 8.0  # least residual of a velocity change at a jump of the acceleration, in typical residuals
LEVEL = 10.0  # largest difference of the ends of an interval that becomes a dwell, in errors
FAR_ERRORS, FAR_SHARE = 10.0, 1e-3  # errors, fraction of the stroke: the larger is the limit of the residual of a row
TABLE, DWELL = "table", "dwell"
MOST_FITTED = 600  # rows, or means of rows, from which the end of a dwell is computed
FINE = 1e-6  # error relative to the largest value, below which rows are fitted to two units of their last digit
LEFT_BY = (
    1e-2,
    1e-3,
    1e-4,
    0.0,
)  # displacements for the end of a dwell relative to the largest one, at least ``ONSET``
ONSET = 60.0  # displacement up to which rows show the end of a dwell, in errors


@frozen
class SegmentFit:
    """Recognised segment: law, start [deg] within the turn, span [deg], rise [unit of the motion].

    ``ambiguous``: names of several laws that fit equally well, so that the segment is a table.
    """

    law: str
    start_deg: float
    span_deg: float
    rise: float
    ambiguous: tuple[str, ...] = ()


@frozen
class AccelerationJump:
    """Jump of the acceleration: cam angle [deg], acceleration before and after, by degrees."""

    angle: float
    before: float
    after: float


@frozen(eq=False)
class Structure:
    """A motion of recognised segments.

    Attributes
    ----------
    motion : motion over the turn
    segments : its segments as recognised, undivided at cam angle 0
    jumps : jumps of the acceleration
    freedom : number of fitted values
    smoothing : λ of the first smoothed table, 0 without one
    """

    motion: Motion
    segments: tuple[SegmentFit, ...]
    jumps: tuple[AccelerationJump, ...]
    freedom: float
    smoothing: float


@frozen(eq=False)
class _Part:
    """Interval [start, end] deg, which may exceed the turn, with its levels and its meaning.

    ``jumps_at_ends``: whether the acceleration jumps at its start and end, next to a dwell; ``number``: number of a
    stroke with a law.
    """

    start: float
    end: float
    low: float
    high: float
    stroke: Stroke | None = None
    is_dwell: bool = False
    ambiguous: tuple[str, ...] = ()
    jumps_at_ends: tuple[bool, bool] = (False, False)
    number: int = -1


Switches = Sequence[tuple[float, str]]
"""Cam angles [deg], and the required kind of the segment there: table, dwell, or a named law."""


class SwitchError(KindynaError):
    """A segment cannot have its required kind."""


def segment_kinds() -> tuple[str, ...]:
    """Kinds that a segment can be given: a table, a dwell, or a named law."""
    return (TABLE, DWELL, *(candidate.name for candidate in tiers(1.0)[0]))


def motion_structure(
    rows: TurnRows,
    unit: str,
    with_laws: bool = True,
    with_dwells: bool = True,
    switches: Switches = (),
) -> Structure | None:
    """Segments of a motion; None where no segment can be separated.

    ``switches``: required kinds of the segments at cam angles [deg]. Raises SwitchError where a segment cannot have its
    required kind.
    """
    at = unrolled(rows)
    turn_rests = rests(at, with_dwells)
    if not turn_rests or (len(turn_rests) == 1 and turn_rests[0].last - turn_rests[0].first >= at.count - 2):
        if turn_rests and turn_rests[0].level is not None:
            motion = Motion(turn_rests[0].level, (Segment(360.0, 0.0),), unit)
            return Structure(motion, (SegmentFit("dwell", 0.0, 360.0, 0.0),), (), 1.0, 0.0)
        return None
    turn_rests, strokes = _recognised_laws(at, turn_rests, with_laws)
    if not any(law[0] for law in strokes) and not any(rest.level is not None for rest in turn_rests):
        return None
    turn_rests, strokes = _from_a_rest(at, turn_rests, strokes)
    strokes = _switched_strokes(at, turn_rests, strokes, switches)
    while True:
        parts = _with_merged_parts(_switched_parts(_parts(at, turn_rests, strokes), switches, rows.errors[0], unit))
        if len(parts) == 1 and not parts[0].is_dwell and parts[0].stroke is None:
            return None
        result = _Assembly(at, parts, unit).structure()
        wrong_laws = set() if switches else _far_laws(at, parts, result.motion)
        if not wrong_laws:
            return result
        strokes = [(None, ()) if k in wrong_laws else stroke_law for k, stroke_law in enumerate(strokes)]


def far(error: float, stroke: float) -> float:
    """Largest accepted residual of a row."""
    return max(FAR_ERRORS * error, FAR_SHARE * stroke)


def _far_laws(at: UnrolledRows, parts: list[_Part], motion: Motion) -> set[int]:
    """Numbers of the strokes whose law is far from a row."""
    x, y, compiled = at.rows.x, at.rows.values[0], program(motion)
    distance = np.abs(y - compiled.state(compiled.angles(np.deg2rad(x))).displacement[0] / motion.scale)
    wrong_angles = x[distance > far(at.rows.errors[0], float(np.ptp(y)))]
    return {
        part.number
        for part in parts
        if part.stroke is not None and np.any(np.mod(wrong_angles - part.start, 360.0) <= part.end - part.start)
    }


# -- required kinds ---------------------------------------------------------------------------------------


def _switched_strokes(
    at: UnrolledRows, turn_rests: list[Rest], strokes: list[_StrokeLaw], switches: Switches
) -> list[_StrokeLaw]:
    """Strokes between rests, with the required tables and laws."""
    strokes = list(strokes)
    for angle, kind in switches:
        if kind not in segment_kinds():
            raise SwitchError(f"segment at {angle:g} deg: unknown kind {kind!r}; allowed: {', '.join(segment_kinds())}")
        for k, (rest, next_rest) in enumerate(pairwise(_closed(at, turn_rests))):
            start = _angle(at, rest.last)
            if kind == DWELL or (angle - start) % 360.0 >= _angle(at, next_rest.first) - start:
                continue
            if kind == TABLE:
                strokes[k] = None, ()
                continue
            stroke, _ = recognise(at, rest, next_rest, kind)
            if stroke is None or stroke.end - stroke.start < LEAST_STEPS * 360.0 / at.count:
                raise SwitchError(f"segment at {angle:g} deg: too short or too low to be {kind}; select table instead")
            strokes[k] = stroke, ()
    return strokes


def _switched_parts(parts: list[_Part], switches: Switches, error: float, unit: str) -> list[_Part]:
    """Parts with the required dwells and tables."""
    begin = parts[0].start
    for angle, kind in switches:
        position = begin + (angle - begin) % 360.0
        k = next((k for k, part in enumerate(parts) if part.start <= position < part.end), len(parts) - 1)
        part = parts[k]
        if kind == TABLE and part.is_dwell:
            parts[k] = replace(part, is_dwell=False)
        elif kind == DWELL and not part.is_dwell:
            if abs(part.high - part.low) > LEVEL * error:
                rise = f"{result_text(abs(part.high - part.low))} {unit}"
                raise SwitchError(
                    f"segment at {angle:g} deg: its ends differ by {rise}; the ends of a dwell have one level"
                )
            parts[k] = replace(part, is_dwell=True, stroke=None, high=part.low)
            following = (k + 1) % len(parts)
            parts[following] = replace(parts[following], low=part.low)
            if parts[following].is_dwell:
                parts[following] = replace(parts[following], high=part.low)
        elif kind not in (TABLE, DWELL) and part.stroke is None:
            raise SwitchError(f"segment at {angle:g} deg: it is a dwell, and cannot be {kind}")
    return parts


def _with_merged_parts(parts: list[_Part]) -> list[_Part]:
    """Parts with adjacent dwells, and adjacent tables, merged."""

    def is_same_kind(left: _Part, right: _Part) -> bool:
        return left.stroke is None and right.stroke is None and left.is_dwell == right.is_dwell

    if len(parts) > 1 and is_same_kind(parts[-1], parts[0]):
        last = parts[-1]
        parts = [replace(last, start=last.start - 360.0, end=parts[0].start), *parts[:-1]]
    result = parts[:1]
    for part in parts[1:]:
        last = result[-1]
        if is_same_kind(last, part):
            result[-1] = replace(
                last,
                end=part.end,
                high=part.high,
                ambiguous=last.ambiguous + part.ambiguous,
                jumps_at_ends=(last.jumps_at_ends[0], part.jumps_at_ends[1]),
            )
        else:
            result.append(part)
    return result


# -- laws -------------------------------------------------------------------------------------------------

_StrokeLaw = tuple[Stroke | None, tuple[str, ...]]


def _as_reversal(rest: Rest) -> Rest:
    """Reversal in the middle of a dwell."""
    middle = (rest.first + rest.last) // 2
    return Rest(middle, middle)


def _next_turn(rest: Rest, count: int) -> Rest:
    return replace(rest, first=rest.first + count, last=rest.last + count)


def _closed(at: UnrolledRows, turn_rests: Sequence[Rest]) -> list[Rest]:
    return [*turn_rests, _next_turn(turn_rests[0], at.count)]


def _recognised_laws(at: UnrolledRows, turn_rests: list[Rest], with_laws: bool) -> tuple[list[Rest], list[_StrokeLaw]]:
    """Rests and laws of all strokes; a short dwell that is the crest of a stroke and its return becomes a reversal."""
    if not with_laws:
        return turn_rests, [(None, ())] * len(turn_rests)

    known: dict[tuple[int, int, float | None, int, int, float | None], _StrokeLaw] = {}

    def laws(turn_rests: list[Rest]) -> list[_StrokeLaw]:
        result = []
        for a, b in pairwise(_closed(at, turn_rests)):
            key = (a.first, a.last, a.level, b.first, b.last, b.level)
            if key not in known:
                stroke, rivals = recognise(at, a, b)
                known[key] = stroke, tuple(rivals)
            result.append(known[key])
        return result

    def without(turn_rests: list[Rest], crests: list[Rest]) -> tuple[list[Rest], list[_StrokeLaw]] | None:
        """Rests and laws with reversals in place of some dwells; None unless all strokes next to these have a law."""
        changed = [_as_reversal(rest) if rest in crests else rest for rest in turn_rests]
        result = laws(changed)
        neighbours = {k for i, rest in enumerate(turn_rests) if rest in crests for k in (i - 1, i)}
        return (changed, result) if all(result[k][0] is not None for k in neighbours) else None

    strokes = laws(turn_rests)
    doubtful = [
        rest for i, rest in enumerate(turn_rests) if len(turn_rests) > 1 and _is_doubtful(at, turn_rests, strokes, i)
    ]
    for crests in [doubtful, *([rest] for rest in doubtful if len(doubtful) > 1)]:
        changed = without(turn_rests, crests) if crests else None
        if changed is not None:
            turn_rests, strokes = changed
    return turn_rests, strokes


def _is_doubtful(at: UnrolledRows, turn_rests: list[Rest], strokes: list[_StrokeLaw], i: int) -> bool:
    """Whether a dwell may be the crest of a stroke and its return.

    The laws next to it leave it no span, or have not been recognised while it is short.
    """
    rest, left, right = turn_rests[i], strokes[i - 1][0], strokes[i][0]
    if rest.level is None or at.x[rest.last] - at.x[rest.first] > LONGEST_CREST:
        return False
    if left is not None and right is not None:
        gap = (right.start - left.end + 180.0) % 360.0 - 180.0
        return gap <= max(
            4.0 * (left.spread[1] + right.spread[0]), LEAST_STEPS * 360.0 / at.count
        )  # least span of a dwell
    strokes_length = (rest.first - turn_rests[i - 1].last) % at.count + (
        turn_rests[(i + 1) % len(turn_rests)].first - rest.last
    ) % at.count
    return rest.last - rest.first <= max(SHORT * strokes_length, 3 * LEAST_STEPS)


def _from_a_rest(
    at: UnrolledRows, turn_rests: list[Rest], strokes: list[_StrokeLaw]
) -> tuple[list[Rest], list[_StrokeLaw]]:
    """Rests and laws in an order that starts with a dwell, else after a stroke without a law."""
    first = next((i for i, rest in enumerate(turn_rests) if rest.level is not None), None)
    if first is None:
        first = next((i for i, (stroke, _) in enumerate(strokes) if stroke is None), 0)
    shifted = [*turn_rests[first:], *(_next_turn(rest, at.count) for rest in turn_rests[:first])]
    return shifted, [*strokes[first:], *strokes[:first]]


def _parts(at: UnrolledRows, turn_rests: list[Rest], strokes: list[_StrokeLaw]) -> list[_Part]:
    """Dwells, laws and remaining intervals, from the first rest to the same rest a turn later."""
    closed = _closed(at, turn_rests)
    laws: list[Stroke | None] = [stroke for stroke, _ in strokes]
    i = 0
    while i < len(laws):  # strokes joined at reversals are fitted together
        j = i
        while j < len(laws) and laws[j] is not None and (j == i or closed[j].level is None):
            j += 1
        if j > i:
            chain = [
                _in_turn_of_rests(at, stroke, rest, next_rest)
                for stroke, rest, next_rest in zip(laws[i:j], closed[i:j], closed[i + 1 :], strict=False)
            ]
            fitted = fitted_together(at, chain)
            laws[i:j] = [None] * (j - i) if fitted is None else [_at_zero(law) for law in fitted]
        i = max(j, i + 1)
    if closed[0].level is None and all(laws):  # laws all around: the first and the last rest are the same
        first, last = laws[0], laws[-1]
        assert first is not None
        assert last is not None
        angle, level = 0.5 * (first.start + last.end - 360.0), 0.5 * (first.low + last.high)
        laws[0], laws[-1] = replace(first, start=angle, low=level), replace(last, end=angle + 360.0, high=level)
        if len(laws) == 1:
            laws[0] = replace(first, start=angle, low=level, end=angle + 360.0, high=level)
    parts: list[_Part] = []
    gaps = [next_rest.first - rest.last for rest, next_rest in pairwise(closed)]
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
        dwells.append((start, end) if end - start > 360.0 / at.count else None)  # else a crest without span
    closed = _closed(
        at, [_as_reversal(rest) if dwell is None else rest for rest, dwell in zip(turn_rests, dwells, strict=True)]
    )
    for k, (rest, next_rest) in enumerate(pairwise(closed)):
        stroke, before, dwell = laws[k], laws[k - 1], dwells[k]
        if dwell is not None and rest.level is not None:
            parts.append(_Part(*dwell, rest.level, rest.level, is_dwell=True))
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
        jumps = [False, False]
        if rest.level is not None:
            (start, jumps[0]), low = onset(at, rest, True, gaps[k]), rest.level
        if next_rest.level is not None:
            (end, jumps[1]), high = onset(at, next_rest, False, gaps[k]), next_rest.level
        elif after is not None:
            end, high = after.start + (360.0 if k == len(laws) - 1 else 0.0), after.low
        else:
            end, high = _angle(at, next_rest.first), float(y[next_rest.first % at.count])
        if parts and parts[-1].stroke is None and not parts[-1].is_dwell:  # one table across the reversal
            previous = parts[-1]
            parts[-1] = replace(
                previous,
                end=end,
                high=high,
                ambiguous=previous.ambiguous + strokes[k][1],
                jumps_at_ends=(previous.jumps_at_ends[0], jumps[1]),
            )
        else:
            parts.append(_Part(start, end, low, high, ambiguous=strokes[k][1], jumps_at_ends=(jumps[0], jumps[1])))
    return parts


def _at_zero(stroke: Stroke) -> Stroke:
    """Stroke whose ends are moved to cam angle 0 where their errors allow."""
    ends = [
        round(end / 360.0) * 360.0 if abs(end - round(end / 360.0) * 360.0) <= 4.0 * spread + 1e-9 else end
        for end, spread in zip((stroke.start, stroke.end), stroke.spread, strict=True)
    ]
    return replace(stroke, start=ends[0], end=ends[1])


def onset(at: UnrolledRows, rest: Rest, at_end: bool, gap: int) -> tuple[float, bool]:
    """Cam angle [deg] where a dwell ends, or starts, and whether the acceleration jumps there.

    The displacement is c |θ - θ₀|ᵖ with the power p = 3, 4 or 2 that fits the neighbouring rows best, 2 only where the
    others are clearly worse. The angle is not beyond the first row that has left the level. Exact rows give it
    directly.

    Parameters
    ----------
    at : UnrolledRows
    rest : Rest
        The dwell.
    at_end : bool
        Its end, else its start.
    gap : int
        Number of rows to the next rest; half of them are used.

    Returns
    -------
    tuple of float [deg] and bool
    """
    edge, n = (rest.last if at_end else rest.first), at.count
    if at.rows.exact:
        return _angle(at, edge), False
    sign, error, height = (1 if at_end else -1), at.rows.errors[0], at.rows.sizes[0]
    reach = min(n // 4, max(gap // 2, 1))
    displacement = np.abs(at.values[0][(edge + sign * np.arange(reach)) % n] - float(rest.level or 0.0))
    fine = error <= FINE * height
    for limit in LEFT_BY if fine else LEFT_BY[:1]:  # smaller until one power fits such rows
        has_left = displacement >= max(ONSET * error, limit * height)
        distance, jumps, explained = _onset_distance(
            at, rest, at_end, int(np.argmax(has_left)) if has_left.any() else reach
        )
        if explained:
            break
    outside = np.flatnonzero(displacement > FAR * error)  # no row is level from the first of these on
    if outside.size:
        level, first_outside = (
            abs(_angle(at, edge + sign * k) - _angle(at, edge)) for k in (int(outside[0]) - 1, int(outside[0]))
        )
        if distance >= first_outside or (fine and not explained):
            distance, jumps = level, False
    angle = _angle(at, edge) + sign * distance
    zero = 360.0 * round(angle / 360.0)
    return zero if abs(angle - zero) < 0.5 * 360.0 / n else angle, jumps  # an angle close to 0 is 0


def _onset_distance(at: UnrolledRows, rest: Rest, at_end: bool, reach: int) -> tuple[float, bool, bool]:
    """Distance [deg] from the last row of a dwell to its end, whether the acceleration jumps, whether rows agree."""
    sign, edge, n = (1, rest.last, at.count) if at_end else (-1, rest.first, at.count)
    inside = min((rest.last - rest.first) // 2, 2 * reach + LEAST_STEPS)
    numbers = edge + sign * np.arange(-inside, reach + 1)
    rows_per_mean = -(-numbers.size // MOST_FITTED)  # rows are replaced by means
    numbers = numbers[: numbers.size // rows_per_mean * rows_per_mean]
    x = sign * (at.x[numbers % n] + 360.0 * (numbers // n) - _angle(at, edge)).reshape(-1, rows_per_mean).mean(axis=1)
    errors = (at.values[0][numbers % n] - float(rest.level or 0.0)) / at.rows.errors[0]
    errors = sqrt(rows_per_mean) * errors.reshape(-1, rows_per_mean).mean(axis=1)
    best: dict[int, tuple[float, float]] = {}
    for power in (3, 4, 2):
        distances = np.linspace(x[0], x[-2], 241)
        basis = np.maximum(x[None, :] - distances[:, None], 0.0) ** power
        square = (basis**2).sum(axis=1)
        residuals = float(errors @ errors) - np.where(
            square > 0.0, (basis @ errors) ** 2 / np.where(square > 0.0, square, 1.0), 0.0
        )
        k = int(np.argmin(residuals))
        best[power] = float(residuals[k]), float(distances[k])
    smooth_power = min((3, 4), key=lambda power: best[power][0])
    jumps = best[2][0] < best[smooth_power][0] - 2.0 * WELL
    residual, distance = best[2 if jumps else smooth_power]
    return distance, jumps, residual <= errors.size + 5.0 * sqrt(2.0 * errors.size)


def _angle(at: UnrolledRows, row: int) -> float:
    return float(at.x[row % at.count]) + 360.0 * (row // at.count)


def _in_turn_of_rests(at: UnrolledRows, stroke: Stroke | None, rest: Rest, next_rest: Rest) -> Stroke:
    """Stroke with these rests, and its angles in their turn."""
    assert stroke is not None
    middle = 0.5 * (_angle(at, rest.last) + _angle(at, next_rest.first))
    turns = 360.0 * round((middle - 0.5 * (stroke.start + stroke.end)) / 360.0)
    return replace(stroke, left=rest, right=next_rest, start=stroke.start + turns, end=stroke.end + turns)


# -- segments ---------------------------------------------------------------------------------------------


class _Assembly:
    """Assembly of the parts into segments, starting at cam angle 0."""

    def __init__(self, at: UnrolledRows, parts: list[_Part], unit: str) -> None:
        self.at, self.parts, self.unit = at, parts, unit
        self.jumps: list[AccelerationJump] = []
        self.freedom, self.smoothing = 0.0, 0.0

    def structure(self) -> Structure:
        begin = self.parts[0].start
        segments: list[Segment] = []
        fits: list[SegmentFit] = []
        table_span = 0.0
        for i, part in enumerate(self.parts):
            end = part.end if i + 1 < len(self.parts) else begin + 360.0
            start = self.parts[i].start
            span, rise = difference(end, start), difference(part.high, part.low)
            if span <= 1e-6:
                continue
            if part.is_dwell:
                segments.append(Segment(span, 0.0))
                fits.append(SegmentFit("dwell", start % 360.0, span, 0.0))
                self.freedom += 1.0
            elif part.stroke is not None:
                curves = part.stroke.candidate.curves(part.stroke.fractions)
                law_segments, angle, level = [], start, part.low
                for k, (share, height, curve) in enumerate(curves):
                    last = k + 1 == len(curves)
                    next_angle = end if last else angle + share * span
                    next_level = part.high if last else level + height * rise
                    law_segments.append(Segment(difference(next_angle, angle), difference(next_level, level), curve))
                    fits.append(SegmentFit(curve.law, angle % 360.0, law_segments[-1].span_deg, law_segments[-1].rise))
                    angle, level = next_angle, next_level
                segments += law_segments
                self.freedom += 2.0 + len(part.stroke.fractions)
            else:
                before = self.parts[i - 1]
                after = self.parts[(i + 1) % len(self.parts)]
                for segment in self._tables(part, start, end, before, after):
                    segments.append(segment)
                    fits.append(
                        SegmentFit(
                            "table", (start + table_span) % 360.0, segment.span_deg, segment.rise, part.ambiguous
                        )
                    )
                    table_span += segment.span_deg
                table_span = 0.0
        return Structure(
            with_start_at_zero(begin, self.parts[0].low, segments, self.unit),
            tuple(sorted(fits, key=lambda fit: fit.start_deg)),
            tuple(self.jumps),
            self.freedom,
            self.smoothing,
        )

    def _tables(self, part: _Part, start: float, end: float, before: _Part, after: _Part) -> list[Segment]:
        """Tables of a part without a law, as smooth as the errors allow; one more where the acceleration jumps."""
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
            points = [SplinePoint(0.0, 0.0, *ends[0][1:])]
            points += [
                SplinePoint(
                    difference(a, start), float(y - part.low), *((float(v),) if 1 in values and np.isfinite(v) else ())
                )
                for a, y, v in zip(angles.tolist(), values[0], values.get(1, values[0]), strict=True)
            ]
            points.append(SplinePoint(difference(end, start), part.high - part.low, *ends[1][1:]))
            self.freedom += angles.size
            return [Segment(difference(end, start), difference(part.high, part.low), TableCurve(tuple(points)))]
        ends = tuple(
            (*end_state[:2], None) if jumps else end_state
            for end_state, jumps in zip(ends, part.jumps_at_ends, strict=True)
        )  # type: ignore[assignment]
        curve = smooth(angles, values, rows.errors, start, end, ends)
        for angle, state, jumps in ((start, 0, part.jumps_at_ends[0]), (end, -1, part.jumps_at_ends[1])):
            if jumps:
                jump = float(curve.states[state, 2])
                self.jumps.append(AccelerationJump(angle % 360.0, *((0.0, jump) if state == 0 else (jump, 0.0))))
        self.freedom += curve.freedom
        self.smoothing = self.smoothing or curve.smoothing
        return [quintic_segment(curve.knots, curve.states, part.low, part.high)]

    def _row(self, angle: float) -> int | None:
        """Number of the row at a cam angle [deg]."""
        near = np.flatnonzero(np.abs(np.mod(self.at.rows.x - angle + 180.0, 360.0) - 180.0) < 1e-9)
        return int(near[0]) if near.size else None

    def _through_all(
        self, start: float, end: float, angles: np.ndarray, values: dict[int, np.ndarray], ends: tuple[End, End]
    ) -> list[Segment]:
        """Quintics through exact rows, divided where the acceleration jumps."""
        y = np.array([values[k] for k in range(3)])
        first, last = (np.array([[float(v) if v is not None else np.nan] for v in side]) for side in ends)
        is_complete = np.isfinite(y).all(axis=0)  # incomplete rows are not used
        x, states = np.concatenate(([start], angles[is_complete], [end])), np.hstack((first, y[:, is_complete], last))
        h, largest = np.diff(x), self.at.rows.sizes[2]
        if self._row(start) is not None and not np.isnan(row := self.at.rows.values[2][self._row(start)]):
            states[2, 0] = row
            if abs(row) > SHOWN * largest and ends[0][2] == 0.0:
                self.jumps.append(AccelerationJump(start % 360.0, 0.0, float(row)))
        last_left = (
            2.0 * (states[1, -1] - states[1, -2]) / h[-1] - states[2, -2]
        )  # a row at a jump has only the right limit
        if self._row(end) is not None and ends[1][2] == 0.0 and abs(last_left) > SHOWN * largest:
            states[2, -1] = last_left
            self.jumps.append(AccelerationJump(end % 360.0, float(last_left), 0.0))
        residuals = np.diff(states[1]) - 0.5 * h * (states[2, :-1] + states[2, 1:])
        size = np.abs(residuals) / h
        typical = np.median(size) + 1e-9 * self.at.rows.sizes[2]
        neighbours = np.maximum(np.roll(size, 2), np.roll(size, -2))
        cuts = np.flatnonzero((size > JUMP * np.maximum(typical, neighbours)) & (size > 2e-3 * self.at.rows.sizes[2]))
        cuts = cuts[(cuts > 0) & (cuts < h.size - 2)].tolist()  # the end of a dwell between two rows is no jump
        segments: list[Segment] = []
        begin = 0
        for cut in [*cuts, h.size - 1]:
            part = states[:, begin : cut + 2].copy()
            if cut in cuts:
                after = float(states[2, cut + 1])
                part[2, -1] = 2.0 * (states[1, cut + 1] - states[1, cut]) / h[cut] - states[2, cut]
                self.jumps.append(AccelerationJump(float(x[cut + 1] % 360.0), float(part[2, -1]), after))
            selected = thin_knots(x[begin : cut + 2], part, self.at.rows)
            segments.append(
                quintic_segment(x[begin : cut + 2][selected], part.T[selected], float(part[0, 0]), float(part[0, -1]))
            )
            self.freedom += 3.0 * selected.size
            begin = cut + 1
        return segments


def _end(level: float, neighbour: _Part, at_start: bool) -> End:
    """State known at an end: at rest, with the acceleration of the neighbouring law."""
    if neighbour.is_dwell:
        return (level, 0.0, 0.0)
    if neighbour.stroke is None:
        return (level, None, None)
    return (level, 0.0, _end_acceleration(neighbour, start=at_start))


def _end_acceleration(part: _Part, start: bool) -> float:
    assert part.stroke is not None
    table = part.stroke.candidate.table(part.stroke.fractions)
    assert table is not None
    u = np.array([0.0 if start else 1.0])
    return float(table.at(u)[2][0]) * (part.high - part.low) / (part.end - part.start) ** 2
