"""Requests for blended motions, their settings as constraints on a family of motions, and the resulting segments."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from itertools import accumulate, groupby
from math import fsum, isfinite
from types import MappingProxyType
from typing import NamedTuple

from core.blend.equations import BlendSolution, BlendTask, Family
from core.blend.sequences import CONSTANT_VELOCITY, DWELL, ELEMENTS, MOTION_TYPES, sequence_error
from core.design import Segment
from core.errors import KindynaError
from core.frozen import frozen

HEIGHTS = ("h1", "h2", "h3", "h4", "h5", "h6")
FLATS = ("flat1", "flat3", "flat4", "flat6")
"""Span [deg] of the constant acceleration inside the curve of that height, which is C1, C2, C3 or C4."""
SIZES = ("a1", "a3", "a4", "a6")
"""Value [per deg²] of that constant acceleration."""
LENGTHS = ("length", "length2")
"""Spans [deg] of the constant velocities, in the order of the motion."""
SPANS = ("span1", "span3", "span4", "span6")
"""Span [deg] of the curve itself, no setting; it limits the span of its constant acceleration."""
SETTINGS = (*HEIGHTS, "vcv", "vcv2", *LENGTHS, "peak", "acceleration", *FLATS, *SIZES)
MAY_VANISH = ("h2", "h5", *LENGTHS)
"""Settings that may be 0: a constant velocity without length."""
POINT = "point"
LEAST_SPAN = 1e-3
"""Least span [deg] from start to end."""
LEAST_STROKE = 1e-9
NONLINEAR = ("acceleration", *SIZES, POINT)
_PER_DEGREE = {"vcv": 1, "vcv2": 1, "acceleration": 2, **dict.fromkeys(SIZES, 2)}
_SPEEDS = {"vcv": "W", "vcv2": "R"}
SAME_RANGE = 1e-9  # relative gap between two ranges below which they are merged
NEGLIGIBLE = 1e-12  # lower end relative to the upper end, below which it is 0
TIED = 1e-12  # relative difference of equal values
_RETURN_NAMES = {
    "h1": "h4",
    "h2": "h5",
    "h3": "h6",
    "vcv": "vcv2",
    "flat1": "flat4",
    "flat3": "flat6",
    "a1": "a4",
    "a3": "a6",
}
UNITS = {**dict.fromkeys(LENGTHS, "deg"), "peak": "deg", "vcv": "{u}/deg", "vcv2": "{u}/deg", "acceleration": "{u}/deg^2",
         **dict.fromkeys((*FLATS, *SPANS), "deg"), **dict.fromkeys(SIZES, "{u}/deg^2")}  # fmt: skip


class Constraint(NamedTuple):
    """A setting, or a point to pass.

    Attributes
    ----------
    name : name in ``SETTINGS``, or ``point``
    value : its value
    at : cam angle of a point [deg from the start of the curves]
    """

    name: str
    value: float
    at: float = 0.0

    @property
    def linear(self) -> bool:
        """Whether the constraint is a linear equation in x1, x2, ... at given t."""
        return self.name not in NONLINEAR

    @property
    def size(self) -> float:
        """Divisor of a residual: the value, or the stroke (1) for a point and where the value is 0."""
        return 1.0 if self.name == POINT else self.value or 1.0


def has_room(start: float, end: float) -> bool:
    """Whether the curves have room between two cam angles [deg]."""
    return 0.0 <= start <= end - LEAST_SPAN and end <= 360.0


def hardest_first(constraints: Sequence[Constraint]) -> list[Constraint]:
    """Nonlinear constraints first, then linear ones; within each group the last one given first."""
    return sorted(constraints, key=lambda c: (c.linear, -constraints.index(c)))


def unit_of(name: str, task: BlendTask) -> float:
    """Value of a setting that is 1 where stroke of the rise and span are 1."""
    if name in (*LENGTHS, "peak", *FLATS):
        return task.span
    if name in SPANS:  # half cycloid: c h/V
        return 2.0 * task.span
    return task.rise / task.span ** _PER_DEGREE.get(name, 0)


def in_units(constraint: Constraint, task: BlendTask) -> Constraint:
    """Constraint for a stroke and a span of 1."""
    name, value, at_angle = constraint
    return Constraint(name, value / unit_of(name, task), at_angle / task.span)


def height_of(name: str) -> str:
    """Height of the curve to which a constant acceleration belongs: ``h1`` for ``flat1`` or ``a1``."""
    return f"h{name[-1]}"


def speed_at(height: str) -> str:
    """Form of the speed at the moving end of the curve of a height."""
    return "W" if height in HEIGHTS[:3] else "R"


def ratio(name: str, family: Family) -> tuple[str, str]:
    """Numerator and denominator form of a linear setting; an empty name is 1."""
    if name in LENGTHS:
        return ("h2", "W") if name == "length" and family.has_constant_rise else ("h5", "R")
    if name == "peak":
        return "up", "W"
    if name in SPANS:
        return height_of(name), speed_at(height_of(name))
    return _SPEEDS.get(name, name), ""


@frozen
class SettingRange:
    """Range of a setting, low to high; an open end can only be approached."""

    low: float
    high: float
    low_open: bool = False
    high_open: bool = False

    def times(self, factor: float) -> SettingRange:
        """Range in other units; a lower end of 0 to rounding becomes 0."""
        low = 0.0 if isfinite(self.high) and abs(self.low) <= NEGLIGIBLE * abs(self.high) else self.low
        return SettingRange(low * factor, self.high * factor, self.low_open, self.high_open)


def merged(ranges: Iterable[SettingRange]) -> list[SettingRange]:
    """Ranges in ascending order, with overlapping and adjacent ones merged."""
    result: list[SettingRange] = []
    for r in sorted(ranges, key=lambda r: (r.low, r.low_open)):
        if result and r.low <= result[-1].high + SAME_RANGE * abs(result[-1].high):
            last = result.pop()
            high = max(last.high, r.high)
            low_open = last.low_open and (r.low_open or not tied(r.low, last.low))
            open_ = all(q.high_open for q in (last, r) if tied(q.high, high))
            r = SettingRange(last.low, high, low_open, open_)
        result.append(r)
    return result


def tied(a: float, b: float) -> bool:
    """Whether two values are equal to ``TIED`` of the larger one."""
    return a == b or (isfinite(a - b) and abs(a - b) <= TIED * max(abs(a), abs(b)))


# -- request and result -----------------------------------------------------------------------------------


class BlendError(KindynaError):
    """A request that no sequence of curves satisfies; the text names the setting and its feasible range.

    Attributes
    ----------
    setting : name of the setting, empty where the error concerns several
    allowed : (low, high), or None
    """

    def __init__(self, message: str, setting: str = "", allowed: tuple[float, float] | None = None) -> None:
        self.setting, self.allowed = setting, allowed
        super().__init__(message)


@frozen
class Request:
    """Request for a blended motion.

    Attributes
    ----------
    type : ``DRD``, ``DRD-return``, ``DRRD`` or ``RRR``
    stroke : stroke of the rise [unit of the motion]
    start, end : cam angles [deg] between which the curves lie
    constant : strokes with constant velocity: ``none``, ``rise``, ``return`` or ``both``
    settings : h1 ... h6; vcv, vcv2 [per deg]; length, length2 [deg]; peak, a cam angle [deg]; acceleration [per deg²];
        flat1, flat3, flat4, flat6, spans [deg] of constant acceleration inside the curve of that height, each of which
        adds a freedom and determines it; a1, a3, a4, a6, values [per deg²] of these accelerations
    return_stroke : stroke of the return, 0 for that of the rise
    points : precision points (cam angle [deg], displacement above the lowest level); each counts as a setting
    sequence : the only sequence to consider, such as ``C1-H2-P2``; empty for all
    mirrored : whether a return with as many curves as the rise is the rise run backwards; None: where this gives the
        right number of settings
    """

    type: str
    stroke: float
    start: float
    end: float
    constant: str = "none"
    settings: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    return_stroke: float = 0.0
    points: tuple[tuple[float, float], ...] = ()
    sequence: str = ""
    mirrored: bool | None = None
    unit: str = "mm"

    @property
    def strokes(self) -> tuple[float, float]:
        """Strokes of rise and return."""
        return self.stroke, self.return_stroke or self.stroke

    def unit_of(self, setting: str) -> str:
        """Unit of a setting, as printed."""
        return UNITS.get(setting, "{u}").format(u=self.unit)

    def standard_name(self, name: str) -> str:
        """Name of a setting in ``SETTINGS``; a return alone may count its curves from 1 and call its speed vcv."""
        return _RETURN_NAMES.get(name, name) if MOTION_TYPES[self.type].rise is None else name

    def flat_name(self, height: str) -> str:
        """Setting for the span of constant acceleration in the curve of a height; a return alone counts from 1."""
        name = f"flat{height[-1]}"
        names = {standard: requested for requested, standard in _RETURN_NAMES.items()}
        return names.get(name, name) if MOTION_TYPES[self.type].rise is None else name

    def requested_name(self, name: str) -> str:
        """Name of a setting as the request writes it: a return alone may count its curves from 1."""
        counts_from_one = any(self.standard_name(requested) != requested for requested in self.settings)
        names = (*self.settings, *(_RETURN_NAMES if counts_from_one else ()))
        return next((requested for requested in names if self.standard_name(requested) == name), name)

    def constraint(self, name: str, value: float, at: float = 0.0) -> Constraint:
        """A setting as a constraint, with angles measured from the start."""
        name = self.standard_name(name)
        if name == "peak":
            return Constraint(name, value - self.start)
        return Constraint(name, value, at - self.start if name == POINT else 0.0)

    @property
    def constraints(self) -> list[Constraint]:
        """All settings and points that determine a freedom."""
        settings = [self.constraint(name, value) for name, value in self.settings.items() if name not in FLATS]
        return [*settings, *(self.constraint(POINT, value, at) for at, value in self.points)]

    @property
    def flats(self) -> dict[str, float]:
        """Height of a curve -> span of the constant acceleration inside it [deg]."""
        return {height_of(self.standard_name(name)): value for name, value in self.settings.items() if name in FLATS}

    def validate(self) -> None:
        """Raise BlendError where a word is unknown, a number is out of its range or a setting is given twice."""
        if self.type not in MOTION_TYPES:
            raise BlendError(f"type {self.type!r}: unknown; allowed: {' | '.join(MOTION_TYPES)}")
        if self.constant not in CONSTANT_VELOCITY:
            raise BlendError(f"constant velocity {self.constant!r}: unknown; allowed: {' | '.join(CONSTANT_VELOCITY)}")
        row = MOTION_TYPES[self.type]
        for stroke, ends in (("rise", row.rise), ("return", row.back)):
            if ends is None and self.constant in (stroke, "both"):
                raise BlendError(f"constant velocity {self.constant}: {self.type} has no {stroke}")
        for name, value in zip(("stroke", "return stroke"), self.strokes, strict=True):
            if not LEAST_STROKE <= value < 1e9:
                raise BlendError(
                    f"{name} = {value:g}: outside its range; allowed: {LEAST_STROKE:g} ... 1e+09 {self.unit}"
                )
        self.validate_angles()
        self._validate_settings()

    def validate_angles(self) -> None:
        """Raise BlendError where the curves have no room between start and end."""
        if not has_room(self.start, self.end):
            angles = f"start {self.start:g} deg, end {self.end:g} deg"
            raise BlendError(
                f"{angles}: outside their range; allowed: 0 <= start < end <= 360 deg, at least {LEAST_SPAN:g} deg between them"
            )

    def _validate_settings(self) -> None:
        requested_names: dict[str, str] = {}
        for name, value in self.settings.items():
            if name not in SETTINGS:
                raise BlendError(f"{name}: unknown setting; allowed: {' | '.join(SETTINGS)}")
            first = requested_names.setdefault(self.standard_name(name), name)
            if first != name:
                raise BlendError(f"{first}, {name}: two names of the same setting of a return; give one", name)
            least = ">=" if name in MAY_VANISH else ">"
            if not 0.0 <= value < 1e100 or (value == 0.0 and name not in MAY_VANISH):
                raise BlendError(
                    f"{name} = {value:g}: outside its range; allowed: {least} 0 {self.unit_of(name)}", name
                )
        for name in self.settings:
            if name in SIZES and height_of(self.standard_name(name)) not in self.flats:
                raise BlendError(
                    f"{name}: value of a constant acceleration without its span; also give flat{name[-1]}", name
                )
        if self.flats and self.points:
            name = next(name for name in self.settings if name in FLATS)
            raise BlendError(
                f"{name}: a constant acceleration cannot be combined with a point; give a height, speed or length instead",
                name,
            )
        for at, value in self.points:
            if not (self.start < at < self.end and isfinite(value)):
                text = f"point at {at:g} deg = {value:g}: outside its range"
                raise BlendError(f"{text}; allowed: {self.start:g} < angle < {self.end:g} deg", POINT)


KINDS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "h": ("{u}", "height of that curve"),
        "span": ("deg", "span of that curve"),
        "v": ("{u}/deg", "speed of that curve at its moving end"),
        "a": ("{u}/deg^2", "largest acceleration of that curve"),
        "end": ("deg", "cam angle where that curve ends"),
        "rise": ("{u}", "height of that rise"),
        "return": ("{u}", "height of that return"),
    }
)
"""Kind of a setting of any sequence, followed by a number counted from 1 -> its unit and meaning."""


@frozen
class SequenceRequest:
    """Request for any sequence of curves between two cam angles [deg].

    Attributes
    ----------
    curves : names in order, such as ``C1``, ``H2``, ``P2``
    settings : h1, span1 [deg], v1 [per deg], a1 [per deg²], end1, a cam angle [deg], of the curves counted from 1;
        rise1, return1 of the strokes, each of adjacent curves in one direction
    """

    curves: tuple[str, ...]
    start: float
    end: float
    settings: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    unit: str = "mm"

    @property
    def type(self) -> str:
        """Empty: no type of Yang's."""
        return ""

    @property
    def sequence(self) -> str:
        """Names of the curves: ``C1-H2-P2``."""
        return "-".join(self.curves)

    @property
    def is_closed(self) -> bool:
        """Whether the last curve joins the first in the next turn: over the full turn, equal end states, no dwell."""
        joins = ELEMENTS[self.curves[0]].start == ELEMENTS[self.curves[-1]].end != DWELL
        return joins and self.end - self.start == 360.0

    @property
    def strokes(self) -> dict[str, tuple[int, ...]]:
        """Stroke (rise1, return1, ...) -> indices of its curves, in the order of the motion."""
        result: dict[str, tuple[int, ...]] = {}
        counts = {1: 0, -1: 0}
        for sign, run in groupby(range(len(self.curves)), key=lambda i: ELEMENTS[self.curves[i]].velocity_sign):
            counts[sign] += 1
            result[f"{'rise' if sign > 0 else 'return'}{counts[sign]}"] = tuple(run)
        return result

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all settings."""
        rows = list(enumerate((ELEMENTS[name] for name in self.curves), 1))
        return (
            *self.strokes,
            *(f"h{i}" for i, _ in rows),
            *(f"span{i}" for i, _ in rows),
            *(f"v{i}" for i, row in rows if row.speed),
            *(f"a{i}" for i, row in rows if row.peak),
            *(f"end{i}" for i, _ in rows[:-1]),
        )

    @property
    def freedom(self) -> int:
        """Number of settings: heights and spans, minus the joins without dwell, minus the total span."""
        joins = sum(ELEMENTS[name].end != DWELL for name in self.curves[:-1]) + self.is_closed
        return 2 * len(self.curves) - joins - 1

    def unit_of(self, name: str) -> str:
        """Unit of a setting, as printed."""
        return KINDS[name.rstrip("0123456789")][0].format(u=self.unit)

    def validate(self) -> None:
        """Raise BlendError where curves do not join, a setting is unknown or a number is out of its range."""
        if fault := sequence_error(self.sequence):
            raise BlendError(f"sequence {self.sequence}: {fault}")
        if not has_room(self.start, self.end):
            raise BlendError(
                f"start {self.start:g} deg, end {self.end:g} deg: outside their range; allowed: 0 <= start < end <= 360 deg"
            )
        for name, value in self.settings.items():
            if name not in self.names:
                allowed = " | ".join(self.names)
                raise BlendError(f"{name}: no setting of {self.sequence}; allowed: {allowed}", name)
            low, high = (self.start, self.end) if name.startswith("end") else (0.0, 1e100)
            least = LEAST_STROKE if name.startswith(("rise", "return")) else 0.0
            if not (low < value < high and value >= least):
                shown = f"{low:g} < {name} < {high:g}" if high < 1e100 else f"{name} > {low:g}"
                raise BlendError(f"{name} = {value:g}: outside its range; allowed: {shown} {self.unit_of(name)}", name)


@frozen
class BlendResult:
    """A blended motion: curves in order with spans [deg] and signed rises, from ``start`` of the request."""

    request: Request | SequenceRequest
    solution: BlendSolution
    segments: tuple[Segment, ...]

    @property
    def curves(self) -> tuple[str, ...]:
        """Names of the curves, in the order of the motion."""
        return self.solution.sequence.curves

    @property
    def gain(self) -> float:
        """Level at the end of the curves minus level at their start."""
        return fsum(s.rise for s in self.segments)

    @property
    def first_level(self) -> float:
        """Level at the start of the curves above their lowest level."""
        return -min(accumulate((s.rise for s in self.segments), initial=0.0)) + 0.0
