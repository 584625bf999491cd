"""Its request and texts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context
from math import fsum, isfinite
from types import MappingProxyType
from typing import Any

from core.blend import (
    CONSTANT_VELOCITY,
    FLATS,
    MOTION_TYPES,
    BlendCandidate,
    BlendResult,
    Request,
    SettingRange,
    candidates,
    flat_heights,
)
from core.design import UNITS, Motion, NamedCurve, Segment, join_angles
from core.design.edits import is_dwell
from core.frozen import frozen
from core.output.lines import shortest
from core.output.texts import changed_segment, curve_rows, flat_rows
from kindyna_gui.labels import law_label
from kindyna_gui.pictures.units import MINUS, brief, measure, number, readable, short
from kindyna_gui.settings import size_of

# -- request ---------------------------------------------------------------------------------------------

POINT = "point"
AUTOMATIC = ""


@frozen
class Setting:
    """One row of the table of settings.

    symbol  its name in the text of its range
    per     its unit, {u} being that of the motion
    share   where in its feasible range a value begins when the setting is ticked
    help    what it is
    """

    name: str
    label: str
    symbol: str
    per: str
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
            Setting("h1", "h1", "h1", "{u}", 0.1, "height of the first curve of the rise"),
            Setting("h2", "h2", "h2", "{u}", 0.8, "height of the constant velocity of the rise"),
            Setting("h3", "h3", "h3", "{u}", 0.1, "height of the last curve of the rise"),
            Setting("vcv", "Vcv", "Vcv", "{u}/°", 0.4, "largest velocity of the rise, per degree of cam angle"),
            Setting("h4", "h4", "h4", "{u}", 0.1, "height of the first curve of the return"),
            Setting("h5", "h5", "h5", "{u}", 0.8, "height of the constant velocity of the return"),
            Setting("h6", "h6", "h6", "{u}", 0.1, "height of the last curve of the return"),
            Setting("vcv2", "Vcv2", "Vcv2", "{u}/°", 0.4, "largest velocity of the return, per degree of cam angle"),
            Setting("length", "Length", "length", "°", 0.5, "cam angle that the constant velocity takes"),
            Setting(
                "length2", "Length 2", "length2", "°", 0.5, "cam angle that the constant velocity of the return takes"
            ),
            Setting("peak", "Peak at", "peak", "°", 0.5, "cam angle of the highest point"),
            *(
                row
                for i, curve in CURVES.items()
                for row in (
                    Setting(
                        f"flat{i}",
                        f"Const. a{i}",
                        f"span a{i}",
                        "°",
                        0.5,
                        f"cam angle over which {curve} accelerates constantly",
                    ),
                    Setting(
                        f"a{i}",
                        f"Size of a{i}",
                        f"a{i}",
                        "{u}/°²",
                        0.5,
                        f"size of the constant acceleration of {curve}",
                    ),
                )
            ),
            Setting("acceleration", "Accel.", "a", "{u}/°²", 0.3, "largest acceleration, per degree² of cam angle"),
        )
    }
)
OF_A_RETURN = MappingProxyType(
    {"h4": "h1", "h5": "h2", "h6": "h3", "vcv2": "vcv", "flat4": "flat1", "flat6": "flat3", "a4": "a1", "a6": "a3"}
)
"""A return alone counts its curves from 1, as Yang does."""


@frozen
class WizardRequest:
    """The answers so far.

    given   settings and their values, in the order of ticking; points: (cam angle [deg], level above the lowest)
    sequence, mirrored   one of the candidates; empty and None: the one that takes as many settings as are given
    goal    what is minimised over whatever the settings leave free; empty: nothing
    """

    type: str = "DRRD"
    constant: str = "none"
    stroke: float = 20.0
    return_stroke: float = 0.0
    start: float = 30.0
    end: float = 330.0
    given: tuple[tuple[str, float], ...] = ()
    points: tuple[tuple[float, float], ...] = ()
    sequence: str = AUTOMATIC
    mirrored: bool | None = None
    goal: str = ""
    unit: str = "mm"

    @property
    def solver_request(self) -> Request:
        """The request as ``core.blend`` takes it."""
        both = MOTION_TYPES[self.type].rise is not None and MOTION_TYPES[self.type].back is not None
        return Request(
            type=self.type,
            stroke=self.stroke,
            start=self.start,
            end=self.end,
            constant=self.constant,
            settings=dict(self.given),
            return_stroke=self.return_stroke if both else 0.0,
            points=self.points,
            sequence=self.sequence,
            mirrored=self.mirrored,
            unit=self.unit,
        )

    @property
    def count(self) -> int:
        """Number of settings and points that take a freedom: the span of a constant acceleration brings its own."""
        return len([name for name, _ in self.given if name not in FLATS]) + len(self.points)

    @property
    def flats(self) -> tuple[tuple[str, float], ...]:
        """The spans of constant acceleration among the settings."""
        return tuple((name, value) for name, value in self.given if name in FLATS)


def constants(motion_type: str) -> tuple[str, ...]:
    """The strokes of a motion that may have a constant velocity."""
    row = MOTION_TYPES[motion_type]
    absent = {*(("rise", "both") if row.rise is None else ()), *(("return", "both") if row.back is None else ())}
    return tuple(word for word in CONSTANT_VELOCITY if word not in absent)


def has_both(motion_type: str) -> bool:
    """Whether a motion rises and returns."""
    row = MOTION_TYPES[motion_type]
    return row.rise is not None and row.back is not None


# -- which settings, and how many -------------------------------------------------------------------------


def names_of(candidate: BlendCandidate) -> frozenset[str]:
    """The settings that mean something for a sequence; none where nothing of it is free."""
    names = candidate.names if candidate.freedom else frozenset()
    return frozenset(name if candidate.sequence.rise else OF_A_RETURN.get(name, name) for name in names)


def flats_of(candidate: BlendCandidate) -> frozenset[str]:
    """The spans of a constant acceleration that a sequence may take."""
    names = [f"flat{height[-1]}" for height in flat_heights(candidate.sequence)] if candidate.freedom else []
    return frozenset(name if candidate.sequence.rise else OF_A_RETURN.get(name, name) for name in names)


def open_candidates(request: WizardRequest) -> list[BlendCandidate]:
    """The sequences of the motion, whatever is given; those that are alike in sequence and mirroring once."""
    free = replace(request, given=request.flats, points=(), sequence=AUTOMATIC, mirrored=None)
    return candidates(free.solver_request)


def shown_names(request: WizardRequest) -> list[str]:
    """The settings that can be ticked, in the order of the table: of the chosen sequence, or of any; no points beside a
    constant acceleration."""
    able, flat = (candidates(replace(request, given=given, points=()).solver_request) for given in ((), request.flats))
    known = frozenset().union(
        *(names_of(row) | flats_of(row) for row in able), *(names_of(row) for row in flat if request.flats)
    )
    if request.flats:
        known -= {POINT}
    return [name for name in (*SETTINGS, POINT) if name in known]


@frozen
class SequencePlan:
    """The sequence that a number of settings leads to.

    target   takes as many settings as are given, or is the first to take more; None: none takes so many
    missing  how many settings are missing, below 0: too many
    """

    target: BlendCandidate | None
    missing: int


def plan(request: WizardRequest) -> SequencePlan:
    """The sequence that takes the settings, and how many are missing; with a goal none is."""
    names = {name for name, _ in request.given if name not in FLATS} | ({POINT} if request.points else set())
    rows = [row for row in candidates(request.solver_request) if names <= names_of(row) or not names]
    able = sorted((row for row in rows if row.freedom >= request.count), key=lambda row: row.freedom)
    if able:
        return SequencePlan(able[0], 0 if request.goal else able[0].freedom - request.count)
    most = max((row.freedom for row in rows), default=0)
    return SequencePlan(None, most - request.count)


def ranged(request: WizardRequest) -> Request:
    """The request whose feasible ranges are shown: while settings are missing, that of the planned sequence."""
    wanted = plan(request)
    if wanted.target is None or not wanted.missing or request.sequence:
        return request.solver_request
    target = wanted.target
    return replace(request.solver_request, sequence=str(target.sequence), mirrored=target.family.mirrored or None)


def count_text(request: WizardRequest) -> str:
    """How many settings are given and needed, in a sentence."""
    wanted, count = plan(request), request.count
    if wanted.missing < 0:
        most = count + wanted.missing
        problem = f"No sequence takes {count} of these" if not most else f"{count} settings given, {most} can be met"
        return f"{problem}: untick {_number(-wanted.missing)}"
    if request.goal:
        return f"{_settings(count)} given; the rest is chosen for the least {request.goal}"
    if not wanted.missing:
        return f"{_sequence(wanted)} requires {_settings(count)}{': given' if count else '; tick any for other curves'}"
    more = f"tick {_number(wanted.missing)}{' more' if count else ''}"
    return (
        f"{_sequence(wanted)} requires {_settings(count + wanted.missing)}, {count} given: {more}, or optimise the rest"
    )


def _sequence(wanted: SequencePlan) -> str:
    return str(wanted.target.sequence) if wanted.target is not None else ""


def _settings(count: int) -> str:
    return f"{count} setting{'' if count == 1 else 's'}" if count else "no setting"


def _number(count: int) -> str:
    return {1: "one", 2: "two", 3: "three", 4: "four"}.get(count, str(count))


def words_of(request: WizardRequest) -> dict[str, Any]:
    """The request as the command ``blend`` has it, by the names of its fields."""
    asked = request.solver_request
    return {
        "type": asked.type,
        "stroke": asked.stroke,
        "return_stroke": asked.return_stroke,
        "start": asked.start,
        "end": asked.end,
        "constant_velocity": asked.constant,
        "set": [f"{name}={value!r}" for name, value in asked.settings.items()],
        "point": [f"{angle!r}={level!r}" for angle, level in asked.points],
        "sequence": asked.sequence,
        "best": request.goal or None,
        "unit": asked.unit,
    }


CONSTANT = ("cv1", "cv2")


def first_request(motion: Motion, chosen: int) -> WizardRequest:
    """The request that would lead to the motion about the chosen segment, or the next that moves: its stroke, its angles,
    and where it is a blend its sequence and heights. For a motion without any rise: the default request."""
    moving = [not is_dwell(s) and s.rise != 0.0 for s in motion.segments]
    count = len(moving)
    at = next((i for k in range(count) if moving[i := (chosen + k) % count]), None)
    if at is None:
        return WizardRequest(unit=motion.unit)
    run = _about(at, moving)
    stroke = _about(
        at, [on and s.rise * motion.segments[at].rise > 0.0 for on, s in zip(moving, motion.segments, strict=True)]
    )
    runs = [run, stroke] if list(_directions([motion.segments[i] for i in run])) in ([1], [-1], [1, -1]) else [stroke]
    requests = [_request_of(motion, part) for part in runs]
    return next((request for request, blended in requests if blended), requests[0][0])


def _about(at: int, on: Sequence[bool]) -> list[int]:
    """The run of segments about one, all of which are on."""
    first, last = at, at
    while first > 0 and on[first - 1]:
        first -= 1
    while last + 1 < len(on) and on[last + 1]:
        last += 1
    return list(range(first, last + 1))


def _request_of(motion: Motion, run: Sequence[int]) -> tuple[WizardRequest, bool]:
    """The request for a run of segments, and whether the run is a blend."""
    segments = [motion.segments[i] for i in run]
    begins = (*join_angles(motion), 360.0)
    whole = len(run) == len(motion.segments)
    kinds: dict[tuple[int, ...], str] = {(1,): "DRD", (-1,): "DRD-return"}
    kind = kinds.get(tuple(_directions(segments)), "RRR" if whole else "DRRD")
    rise, back = (abs(fsum(s.rise for s in segments if s.rise * direction > 0.0)) for direction in (1, -1))
    equal = abs(rise - back) <= 1e-9 or not (rise and back)
    request = WizardRequest(
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
    """1 up, -1 down, once for each stretch."""
    before = 0
    for segment in segments:
        direction = 1 if segment.rise > 0.0 else -1
        if direction != before:
            yield direction
        before = direction


def _constant(segments: Sequence[Segment]) -> str:
    laws = {s.curve.law for s in segments}
    return {(True, False): "rise", (False, True): "return", (True, True): "both"}.get(
        (CONSTANT[0] in laws, CONSTANT[1] in laws), "none"
    )


def _as_blend(request: WizardRequest, segments: Sequence[Segment]) -> WizardRequest | None:
    """With sequence and heights, where the segments are the curves of a sequence; else None."""
    name = "-".join(s.curve.law.upper() for s in segments)
    rows = [row for row in candidates(replace(request, sequence=name).solver_request) if not row.family.mirrored]
    if not rows:
        return None
    candidate = rows[0]
    heights = [abs(s.rise) for s in segments]
    rise, back = heights[: len(candidate.sequence.rise)], heights[len(candidate.sequence.rise) :]
    given: list[tuple[str, float]] = []
    for part, first, last in ((rise, "h1", "h3"), (back, "h4", "h6")):
        if len(part) > 1:
            given.append((first, part[0]))
        if len(part) > 2:
            given.append((last, part[-1]))
    renamed = OF_A_RETURN if not rise else {}
    kept = tuple((renamed.get(n, n), h) for n, h in given[: candidate.freedom])
    plain = replace(request, given=(*kept, *_flats_of_segments(candidate, segments)))
    target = plan(plain).target
    if target is not None and (target.sequence, target.family.mirrored) == (candidate.sequence, False):
        return plain
    return replace(plain, sequence=name, mirrored=False)


def _flats_of_segments(candidate: BlendCandidate, segments: Sequence[Segment]) -> Iterator[tuple[str, float]]:
    """The spans of constant acceleration in the curves of a sequence."""
    spans = {
        s.curve.law.upper(): s.span_deg * s.curve.flat_fraction for s in segments if isinstance(s.curve, NamedCurve)
    }
    renamed = OF_A_RETURN if not candidate.sequence.rise else {}
    for height, curve in flat_heights(candidate.sequence).items():
        if spans[curve]:
            name = f"flat{height[-1]}"
            yield renamed.get(name, name), spans[curve]


# -- texts -----------------------------------------------------------------------------------------------

SAME = 1e-9  # a range narrower than this is one value
DIGITS = 6
UNASKED = "…"


def rounded(value: float, inwards: bool, down: bool = False) -> float:
    """A few digits; an end that is reached is rounded inwards, so that it can be typed, unless it misses a round number
    by no more than rounding."""
    nearest = float(Context(prec=DIGITS, rounding=ROUND_HALF_EVEN).create_decimal(value))
    if not inwards or abs(nearest - value) <= SAME * abs(value):
        return nearest
    return float(Context(prec=DIGITS, rounding=ROUND_FLOOR if down else ROUND_CEILING).create_decimal(value))


def _text(value: float) -> str:
    return shortest(value).replace("-", MINUS)


def is_one(ranges: Sequence[SettingRange]) -> bool:
    """Whether the ranges hold a single value."""
    low, high = (ranges[0].low, ranges[-1].high) if ranges else (0.0, 1.0)
    return isfinite(high) and high - low <= SAME * max(abs(low), abs(high))


def range_text(ranges: Sequence[SettingRange], name: str, size: float = 1.0) -> str:
    """``0 < h1 ≤ 19``, in a unit of this size; a text of its own where the other settings leave no value, or a single one."""
    if not ranges:
        return "nothing fits"
    ranges = [replace(each, low=each.low / size, high=each.high / size) for each in ranges]
    if is_one(ranges):
        return f"= {_text(rounded(ranges[0].low, False))}, given by the rest"
    return " or ".join(_interval_text(interval, name) for interval in ranges)


def _interval_text(interval: SettingRange, name: str) -> str:
    least = 0.0 if isfinite(interval.high) and abs(interval.low) <= SAME * abs(interval.high) else interval.low
    low = rounded(least, not interval.low_open)
    less, most = "<" if interval.low_open else "≤", "<" if interval.high_open else "≤"
    if not isfinite(interval.high):
        return f"{name} {'>' if interval.low_open else '≥'} {_text(low)}"
    return f"{_text(low)} {less} {name} {most} {_text(rounded(interval.high, not interval.high_open, down=True))}"


def begin_of(ranges: Sequence[SettingRange], share: float) -> float | None:
    """A round value inside the widest of the ranges, at about that share of it; None where there is none."""
    if not ranges:
        return None
    if is_one(ranges):
        return rounded(ranges[0].low, False)
    widest = max(ranges, key=lambda r: r.high - r.low)
    low, high = widest.low, widest.high
    if not isfinite(high):
        return rounded(low * 3.0 if low > 0.0 else 1.0, False)
    wanted = low + share * (high - low)
    for digits in (1, 2, 3, 6):
        value = float(Context(prec=digits, rounding=ROUND_HALF_EVEN).create_decimal(wanted))
        if low < value < high:
            return value
    return wanted


def reason(error: Exception) -> str:
    """Why there is no such motion; a small letter stays small, for h1 is a height and H1 a curve."""
    return str(error).replace(">=", "≥").replace("<=", "≤")


# -- the answer -------------------------------------------------------------------------------------------

HEADINGS = ("Curve", "Height {u}", "Span °", "From °", "To °", "From {u}", "To {u}")


def table(blended: BlendResult) -> list[tuple[str, ...]]:
    """Rows as Yang's Fig. 4 has them: curve, height, span, and where it starts and ends."""
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
    """Constant velocities and the largest acceleration, by cam angle and at the speed of the shaft."""
    unit, rate = UNITS[blended.request.unit].symbol, 6.0 * rpm  # degrees of cam angle in a second
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
    rung = readable(symbol, value)
    return measure(value / rung.size, rung.symbol)


def effect(before: Motion, after: Motion, blended: BlendResult) -> str:
    """What else of the motion is changed by the blend, in a sentence."""
    if not any(s.rise and s not in blended.segments for s in after.segments):
        return "These curves and the dwells about them make the whole turn."
    if not any(s.rise for s in before.segments):
        return "Nothing else moves yet, so the same curves run backwards bring the follower back."
    changed = changed_segment(before, after, blended)
    if changed is None:
        return "The rest of the motion stays."
    n, segment = changed
    height = brief(round(segment.rise, 6), UNITS[after.unit].symbol, 10)
    return f"The rest stays, but segment {n}, {law_label(segment.curve.law)}, then rises by {height} to come back."
