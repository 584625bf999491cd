"""Requests of the blend wizard, the settings it offers, and the texts that the wizard shows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from math import fsum, isfinite
from types import MappingProxyType
from typing import Any

from core.blend import (
    CONSTANT_VELOCITY,
    FLATS,
    MOTION_TYPES,
    BlendCandidate,
    BlendError,
    BlendResult,
    Request,
    SettingRange,
    candidates,
    flat_heights,
)
from core.blend.request import RETURN_NAMES, rounded
from core.design import UNITS, Motion, NamedCurve, Segment, join_angles
from core.design.edits import is_dwell
from core.frozen import frozen
from core.number_text import COMPARED_DIGITS, MINUS, MOST_DIGITS, digits_apart, shortest
from core.output.texts import changed_segment, curve_rows, flat_rows
from kindyna_gui.labels import law_label
from kindyna_gui.pictures.units import brief, measure, number, readable, short
from kindyna_gui.settings import size_of

POINT = "point"
AUTOMATIC = ""  # the settings select the sequence
CONSTANT_LAWS = ("cv1", "cv2")  # constant velocity of a rise and of a return
SAME = 1e-9  # a range narrower than this, relative to its ends, is one value
DIGITS = MOST_DIGITS  # of a value that the other settings determine
PENDING = "…"  # shown while a range is computed
HEADINGS = ("Curve", "Height {u}", "Span °", "From °", "To °", "From {u}", "To {u}")

# -- settings --------------------------------------------------------------------------------------------


@frozen
class Setting:
    """A setting of a blend.

    Attributes
    ----------
    symbol : name in the text of its feasible range
    unit : symbol of its unit; {u} is the unit of the motion
    share : initial value as a share of the feasible range
    help : one line for its tip
    """

    name: str
    label: str
    symbol: str
    unit: str
    share: float
    help: str


CURVES: Mapping[str, str] = MappingProxyType(
    {
        "1": "the first curve of the rise",
        "3": "the last curve of the rise",
        "4": "the first curve of the return",
        "6": "the last curve of the return",
    }
)
SETTINGS: Mapping[str, Setting] = MappingProxyType(
    {
        row.name: row
        for row in (
            Setting("h1", "Height of the first curve, h1", "h1", "{u}", 0.1, "height of the first curve of the rise"),
            Setting(
                "h2",
                "Height of the constant velocity, h2",
                "h2",
                "{u}",
                0.8,
                "height of the constant velocity of the rise",
            ),
            Setting("h3", "Height of the last curve, h3", "h3", "{u}", 0.1, "height of the last curve of the rise"),
            Setting(
                "vcv",
                "Constant velocity, Vcv",
                "Vcv",
                "{u}/°",
                0.4,
                "largest velocity of the rise, per degree of cam angle",
            ),
            Setting(
                "h4",
                "Return: height of the first curve, h4",
                "h4",
                "{u}",
                0.1,
                "height of the first curve of the return",
            ),
            Setting(
                "h5",
                "Return: height of the constant velocity, h5",
                "h5",
                "{u}",
                0.8,
                "height of the constant velocity of the return",
            ),
            Setting(
                "h6", "Return: height of the last curve, h6", "h6", "{u}", 0.1, "height of the last curve of the return"
            ),
            Setting(
                "vcv2",
                "Return: constant velocity, Vcv2",
                "Vcv2",
                "{u}/°",
                0.4,
                "largest velocity of the return, per degree of cam angle",
            ),
            Setting(
                "length",
                "Span of the constant velocity",
                "length",
                "°",
                0.5,
                "duration of the constant velocity in cam angle",
            ),
            Setting(
                "length2",
                "Return: span of the constant velocity",
                "length2",
                "°",
                0.5,
                "duration of the constant velocity of the return in cam angle",
            ),
            Setting("peak", "Cam angle of the peak", "peak", "°", 0.5, "cam angle of the highest point"),
            *(
                row
                for i, curve in CURVES.items()
                for row in (
                    Setting(
                        f"flat{i}",
                        f"Span of the constant acceleration a{i}",
                        f"span a{i}",
                        "°",
                        0.5,
                        f"cam angle over which the acceleration of {curve} is constant",
                    ),
                    Setting(
                        f"a{i}",
                        f"Constant acceleration, a{i}",
                        f"a{i}",
                        "{u}/°²",
                        0.5,
                        f"magnitude of the constant acceleration of {curve}",
                    ),
                )
            ),
            Setting(
                "acceleration",
                "Largest acceleration, a",
                "a",
                "{u}/°²",
                0.3,
                "largest acceleration, per degree² of cam angle",
            ),
        )
    }
)
# -- request ---------------------------------------------------------------------------------------------


def default_request(unit: str) -> Request:
    """Request of the form for a motion that has no rise."""
    return Request("DRRD", 20.0, 30.0, 330.0, unit=unit)


def count_given(request: Request) -> int:
    """Number of settings and points that use a degree of freedom; the span of a constant acceleration uses none."""
    return len([name for name in request.settings if name not in FLATS]) + len(request.points)


def constants(motion_type: str) -> tuple[str, ...]:
    """Strokes of a motion type that may have a constant velocity."""
    row = MOTION_TYPES[motion_type]
    missing = {*(("rise", "both") if row.rise is None else ()), *(("return", "both") if row.back is None else ())}
    return tuple(strokes for strokes in CONSTANT_VELOCITY if strokes not in missing)


def has_both(motion_type: str) -> bool:
    """Whether a motion type has a rise and a return."""
    row = MOTION_TYPES[motion_type]
    return row.rise is not None and row.back is not None


# -- settings of a sequence ------------------------------------------------------------------------------


def setting_names(candidate: BlendCandidate) -> frozenset[str]:
    """Settings that apply to a sequence; none if it has no degree of freedom."""
    names = candidate.names if candidate.freedom else frozenset()
    return frozenset(name if candidate.sequence.rise else RETURN_NAMES.get(name, name) for name in names)


def flat_names(candidate: BlendCandidate) -> frozenset[str]:
    """Spans of constant acceleration that apply to a sequence."""
    names = [f"flat{height[-1]}" for height in flat_heights(candidate.sequence)] if candidate.freedom else []
    return frozenset(name if candidate.sequence.rise else RETURN_NAMES.get(name, name) for name in names)


def open_candidates(request: Request) -> list[BlendCandidate]:
    """All sequences of the motion, whatever settings are given."""
    return candidates(replace(request, settings=_flats(request), points=(), sequence=AUTOMATIC, mirrored=None))


def _flats(request: Request) -> dict[str, float]:
    """Spans of constant acceleration among the settings."""
    return {name: value for name, value in request.settings.items() if name in FLATS}


def shown_names(request: Request) -> list[str]:
    """Settings that can be ticked, in the order of the table: of the selected sequence, or of any.

    A constant acceleration excludes precision points.
    """
    flats = _flats(request)
    free, flat = (candidates(replace(request, settings=settings, points=())) for settings in ({}, flats))
    names = frozenset().union(
        *(setting_names(row) | flat_names(row) for row in free), *(setting_names(row) for row in flat if flats)
    )
    if flats:
        names -= {POINT}
    return [name for name in (*SETTINGS, POINT) if name in names]


@frozen
class SequencePlan:
    """Sequence that the given settings lead to.

    Attributes
    ----------
    target : the sequence that requires as many settings as are given, else the one with the fewest more; None where too
        many are given
    missing : number of settings still to be given; negative where too many are given
    """

    target: BlendCandidate | None
    missing: int


def plan(request: Request, goal: str = "") -> SequencePlan:
    """Find the sequence for the settings, and how many settings are missing; with a goal to minimise none is missing."""
    names = {name for name in request.settings if name not in FLATS} | ({POINT} if request.points else set())
    rows = [row for row in candidates(request) if names <= setting_names(row) or not names]
    count = count_given(request)
    suitable = sorted((row for row in rows if row.freedom >= count), key=lambda row: row.freedom)
    if suitable:
        return SequencePlan(suitable[0], 0 if goal else suitable[0].freedom - count)
    return SequencePlan(None, max((row.freedom for row in rows), default=0) - count)


def range_request(request: Request, goal: str = "") -> Request:
    """Request whose feasible ranges are shown; while settings are missing, for the planned sequence."""
    planned = plan(request, goal)
    target = planned.target
    if target is None or not planned.missing or request.sequence:
        return request
    return replace(request, sequence=str(target.sequence), mirrored=target.family.mirrored or None)


def count_text(request: Request, goal: str = "") -> str:
    """Sentence that says how many settings are given and required."""
    planned, count = plan(request, goal), count_given(request)
    missing, sequence = planned.missing, str(planned.target.sequence) if planned.target is not None else ""
    if missing < 0:
        most = count + missing
        problem = f"{count} settings given, {most} possible" if most else "No sequence accepts these settings"
        return f"{problem}: untick {_number(-missing)}"
    if goal:
        return f"{_settings(count)} given; the rest is optimised for the least {goal}"
    if not missing:
        return f"{sequence} requires {_settings(count)}{': given' if count else '; tick any for other curves'}"
    more = f"tick {_number(missing)}{' more' if count else ''}"
    return f"{sequence} requires {_settings(count + missing)}, {count} given: {more}, or optimise the rest"


def _settings(count: int) -> str:
    return f"{count} setting{'' if count == 1 else 's'}" if count else "no setting"


def _number(count: int) -> str:
    return {1: "one", 2: "two", 3: "three", 4: "four"}.get(count, str(count))


def command_options(request: Request, goal: str) -> dict[str, Any]:
    """Return the request as fields of the command ``blend``."""
    return {
        "type": request.type or None,
        "stroke": request.stroke or None,
        "return_stroke": request.return_stroke,
        "start": request.start,
        "end": request.end,
        "constant_velocity": request.constant,
        "set": [f"{name}={value!r}" for name, value in request.settings.items()],
        "point": [f"{angle!r}={level!r}" for angle, level in request.points],
        "sequence": request.sequence,
        "best": goal or None,
        "unit": request.unit,
    }


# -- request of a motion ---------------------------------------------------------------------------------


def first_request(motion: Motion, chosen: int) -> Request:
    """Request that gives the motion around a segment, or around the next one that is no dwell.

    It has the stroke and angles of that motion, and of a blend also the sequence and heights. A motion without any rise
    gives the default request.
    """
    moving = [not is_dwell(s) and s.rise != 0.0 for s in motion.segments]
    count = len(moving)
    at = next((i for k in range(count) if moving[i := (chosen + k) % count]), None)
    if at is None:
        return default_request(motion.unit)
    run = _run_around(at, moving)
    stroke = _run_around(
        at,
        [moves and s.rise * motion.segments[at].rise > 0.0 for moves, s in zip(moving, motion.segments, strict=True)],
    )
    runs = [run, stroke] if list(_directions([motion.segments[i] for i in run])) in ([1], [-1], [1, -1]) else [stroke]
    requests = [_request_of(motion, part) for part in runs]
    return next((request for request, blended in requests if blended), requests[0][0])


def _run_around(at: int, selected: Sequence[bool]) -> list[int]:
    """Return the indices of the selected segments next to each other that include ``at``."""
    first, last = at, at
    while first > 0 and selected[first - 1]:
        first -= 1
    while last + 1 < len(selected) and selected[last + 1]:
        last += 1
    return list(range(first, last + 1))


def _request_of(motion: Motion, run: Sequence[int]) -> tuple[Request, bool]:
    """Return the request for a run of segments, and whether the run is a blend."""
    segments = [motion.segments[i] for i in run]
    begins = (*join_angles(motion), 360.0)
    is_full_turn = len(run) == len(motion.segments)
    kinds: dict[tuple[int, ...], str] = {(1,): "DRD", (-1,): "DRD-return"}
    kind = kinds.get(tuple(_directions(segments)), "RRR" if is_full_turn else "DRRD")
    rise, back = (abs(fsum(s.rise for s in segments if s.rise * direction > 0.0)) for direction in (1, -1))
    equal = abs(rise - back) <= 1e-9 or not (rise and back)
    request = Request(
        type=kind,
        constant=_constant(segments),
        stroke=round(rise or back, 9),
        return_stroke=0.0 if equal else round(back, 9),
        start=begins[run[0]],
        end=begins[run[-1] + 1],
        unit=motion.unit,
    )
    as_blend = _as_blend(request, segments)
    return (replace(request, constant="none"), False) if as_blend is None else (as_blend, True)


def _directions(segments: Sequence[Segment]) -> Iterator[int]:
    """Direction of each stroke: 1 up, -1 down."""
    previous = 0
    for segment in segments:
        direction = 1 if segment.rise > 0.0 else -1
        if direction != previous:
            yield direction
        previous = direction


def _constant(segments: Sequence[Segment]) -> str:
    laws = {s.curve.law for s in segments}
    return {(True, False): "rise", (False, True): "return", (True, True): "both"}.get(
        (CONSTANT_LAWS[0] in laws, CONSTANT_LAWS[1] in laws), "none"
    )


def _as_blend(request: Request, segments: Sequence[Segment]) -> Request | None:
    """Return the request with sequence and heights; None where the segments are not the curves of a sequence."""
    name = "-".join(s.curve.law.upper() for s in segments)
    rows = [row for row in candidates(replace(request, sequence=name)) if not row.family.mirrored]
    if not rows:
        return None
    candidate = rows[0]
    heights = [abs(s.rise) for s in segments]
    rise, back = heights[: len(candidate.sequence.rise)], heights[len(candidate.sequence.rise) :]
    given: dict[str, float] = {}
    for part, first, last in ((rise, "h1", "h3"), (back, "h4", "h6")):
        if len(part) > 1:
            given[first] = part[0]
        if len(part) > 2:
            given[last] = part[-1]
    renamed = RETURN_NAMES if not rise else {}
    settings = {renamed.get(n, n): h for n, h in islice(given.items(), candidate.freedom)}
    plain = replace(request, settings=settings | dict(_constant_accelerations(candidate, segments)))
    target = plan(plain).target
    if target is not None and (target.sequence, target.family.mirrored) == (candidate.sequence, False):
        return plain
    return replace(plain, sequence=name, mirrored=False)


def _constant_accelerations(candidate: BlendCandidate, segments: Sequence[Segment]) -> Iterator[tuple[str, float]]:
    """Yield name and span [deg] of the constant accelerations in the curves of a sequence."""
    spans = {
        s.curve.law.upper(): s.span_deg * s.curve.flat_fraction for s in segments if isinstance(s.curve, NamedCurve)
    }
    renamed = RETURN_NAMES if not candidate.sequence.rise else {}
    for height, curve in flat_heights(candidate.sequence).items():
        if spans[curve]:
            name = f"flat{height[-1]}"
            yield renamed.get(name, name), spans[curve]


# -- texts of ranges -------------------------------------------------------------------------------------


def _text(value: float) -> str:
    return shortest(value).replace("-", MINUS)


def is_single_value(ranges: Sequence[SettingRange]) -> bool:
    """Whether the ranges contain a single value."""
    return bool(ranges) and SettingRange(ranges[0].low, ranges[-1].high).is_single


def range_text(ranges: Sequence[SettingRange], name: str, size: float = 1.0) -> str:
    """Text of a feasible range, such as ``0 < h1 ≤ 19``, in a unit of this size."""
    if not ranges:
        return "no feasible value"
    ranges = [replace(interval, low=interval.low / size, high=interval.high / size) for interval in ranges]
    if is_single_value(ranges):
        return f"= {_text(rounded(ranges[0].low, DIGITS))}, determined by the other settings"
    return with_signs(" or ".join(_range_text(_positive(interval), name) for interval in ranges))


def _range_text(interval: SettingRange, name: str) -> str:
    """Text of one range, with the digits of limits and more only to tell its ends apart."""
    ends = [interval.low, *([interval.high] if isfinite(interval.high) else [])]
    return interval.text(name, digits_apart(ends, COMPARED_DIGITS), SAME, _text)


def _positive(interval: SettingRange) -> SettingRange:
    """Range whose lower end is 0 where it is 0 to rounding."""
    is_zero = isfinite(interval.high) and abs(interval.low) <= SAME * abs(interval.high)
    return replace(interval, low=0.0) if is_zero else interval


def initial_value(ranges: Sequence[SettingRange], share: float) -> float | None:
    """Round value at about this share of the widest range; None without a range."""
    if not ranges:
        return None
    if is_single_value(ranges):
        return rounded(ranges[0].low, DIGITS)
    widest = max(ranges, key=lambda r: r.high - r.low)
    low, high = widest.low, widest.high
    if not isfinite(high):
        return rounded(low * 3.0 if low > 0.0 else 1.0, DIGITS)
    target = low + share * (high - low)
    for digits in (1, 2, 3, 6):
        value = rounded(target, digits)
        if low < value < high:
            return value
    return target


def reason(error: Exception) -> str:
    """Text of an error with ≤ and ≥; its first letter stays small, for h1 is a height and H1 a curve.

    The ranges in it have the digits of limits; the core writes as many as a command needs.
    """
    text = str(error)
    if isinstance(error, BlendError):
        for interval in error.ranges:
            text = text.replace(interval.text(error.setting), _range_text(interval, error.setting))
    return with_signs(text)


def with_signs(text: str) -> str:
    """Text with ≤ and ≥."""
    return text.replace(">=", "≥").replace("<=", "≤")


# -- texts of a blended motion ---------------------------------------------------------------------------


def table(blended: BlendResult) -> list[tuple[str, ...]]:
    """Rows of the table as in Yang's Fig. 4: curve, height, span, start and end."""
    size = size_of(UNITS[blended.request.unit].symbol)
    return [
        (
            row.curve,
            number(abs(row.rise) / size, 4),
            *(number(value, 4) for value in (row.span, row.angle, row.angle + row.span)),
            *(number(value / size, 4) for value in (row.level, row.level + row.rise)),
        )
        for row in curve_rows(blended)
    ]


def figures(blended: BlendResult, rpm: float) -> list[str]:
    """Lines with the constant velocities and the largest acceleration, by cam angle and at the shaft's speed."""
    unit, rate = UNITS[blended.request.unit].symbol, 6.0 * rpm  # [deg/s]
    rows = []
    for segment in blended.segments:
        if segment.curve.law in ("cv1", "cv2"):
            speed = abs(segment.rise) / segment.span_deg
            shown = _at_speed(speed * rate, f"{unit}/s")
            rows.append(
                f"{segment.curve.law.upper()} runs at {brief(speed, f'{unit}/°')} ({shown}) for {short(segment.span_deg)}°"
            )
    for flat in flat_rows(blended):
        shown = _at_speed(flat.acceleration * rate**2, f"{unit}/s²")
        size = brief(flat.acceleration, f"{unit}/°²").replace("-", MINUS)
        rows.append(
            f"{flat.curve}: constant acceleration {size} ({shown}) over {short(flat.span)}° from {short(flat.angle)}°"
        )
    peak = blended.solution.peak_acceleration
    rows.append(
        f"Largest acceleration {brief(peak, f'{unit}/°²')} ({_at_speed(peak * rate**2, f'{unit}/s²')} at {short(rpm)} rpm)"
    )
    return rows


def _at_speed(value: float, symbol: str) -> str:
    display_unit = readable(symbol, value)
    return measure(value / display_unit.size, display_unit.symbol)


def effect(before: Motion, after: Motion, blended: BlendResult) -> str:
    """Sentence that says what else the blend changes in the motion."""
    if not any(s.rise and s not in blended.segments for s in after.segments):
        return "The motion consists of these curves and the dwells before and after them."
    if not any(s.rise for s in before.segments):
        return "The motion has no return, so the same curves in reverse bring the follower back."
    changed = changed_segment(before, after, blended)
    if changed is None:
        return "The rest of the motion does not change."
    n, segment = changed
    height = brief(segment.rise, UNITS[after.unit].symbol)
    return f"Segment {n}, {law_label(segment.curve.law)}, then rises by {height} to close the motion; the rest does not change."
