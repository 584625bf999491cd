"""A request for a blended motion, its settings as constraints on a family of motions, and the answer as segments."""

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
"""Span of the constant acceleration inside the curve of that height [deg]: C1, C2, C3 or C4."""
SIZES = ("a1", "a3", "a4", "a6")
"""Its size [per deg²]."""
LENGTHS = ("length", "length2")
"""Span of the constant velocity [deg]: of the rise, or of a return that alone has one; of the return beside one of the rise."""
SPANS = ("span1", "span3", "span4", "span6")
"""Span of the curve itself: none to be set, but what limits that of its constant acceleration."""
SETTINGS = (*HEIGHTS, "vcv", "vcv2", *LENGTHS, "peak", "acceleration", *FLATS, *SIZES)
MAY_VANISH = ("h2", "h5", *LENGTHS)
"""What may be 0: a constant velocity of no length, where the curves about it meet."""
POINT = "point"
LEAST_SPAN = 1e-3
"""Degrees from start to end: no cam shows a shorter motion, and its acceleration would be no number any longer."""
LEAST_STROKE = 1e-9
NONLINEAR = ("acceleration", *SIZES, POINT)
_PER_DEGREE = {"vcv": 1, "vcv2": 1, "acceleration": 2, **dict.fromkeys(SIZES, 2)}
_SPEEDS = {"vcv": "W", "vcv2": "R"}
ALIKE = 1e-9  # two ranges that are nearer to each other are one
NONE = 1e-12  # a share of the upper end that is 0
TIED = 1e-12  # values that are the same but for rounding
_OF_A_RETURN = {
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
    """name of ``SETTINGS`` or ``point``, its value, and where a point lies [deg from the start of the curves]."""

    name: str
    value: float
    at: float = 0.0

    @property
    def linear(self) -> bool:
        """Whether it is a linear equation in x1, x2, ... with t given."""
        return self.name not in NONLINEAR

    @property
    def size(self) -> float:
        """By what a miss is divided: the value, or the stroke (1) for a point and for what shall be 0."""
        return 1.0 if self.name == POINT else self.value or 1.0


def has_room(start: float, end: float) -> bool:
    """Whether curves have room between two cam angles [deg]."""
    return 0.0 <= start <= end - LEAST_SPAN and end <= 360.0


def hardest_first(constraints: Sequence[Constraint]) -> list[Constraint]:
    """Those that are not linear, then the others, of each the last given first."""
    return sorted(constraints, key=lambda c: (c.linear, -constraints.index(c)))


def unit_of(name: str, task: BlendTask) -> float:
    """What a setting is where stroke of the rise and span are 1 and so is the setting."""
    if name in (*LENGTHS, "peak", *FLATS):
        return task.span
    if name in SPANS:  # c h/V of half a cycloid
        return 2.0 * task.span
    return task.rise / task.span ** _PER_DEGREE.get(name, 0)


def in_units(constraint: Constraint, task: BlendTask) -> Constraint:
    """The constraint for a stroke and a span of 1."""
    name, value, at_angle = constraint
    return Constraint(name, value / unit_of(name, task), at_angle / task.span)


def height_of(name: str) -> str:
    """The height of the curve that a setting of a constant acceleration is of: ``h1`` of ``flat1`` or ``a1``."""
    return f"h{name[-1]}"


def speed_at(height: str) -> str:
    """The speed at the moving end of the curve of that height."""
    return "W" if height in HEIGHTS[:3] else "R"


def ratio(name: str, family: Family) -> tuple[str, str]:
    """A linear setting as a form divided by another; an empty name is 1."""
    if name in LENGTHS:
        return ("h2", "W") if name == "length" and family.has_constant_rise else ("h5", "R")
    if name == "peak":
        return "up", "W"
    if name in SPANS:
        return height_of(name), speed_at(height_of(name))
    return _SPEEDS.get(name, name), ""


@frozen
class SettingRange:
    """What a setting may be, from low to high; an open end can only be approached."""

    low: float
    high: float
    low_open: bool = False
    high_open: bool = False

    def times(self, factor: float) -> SettingRange:
        """In other units; a lower end that is 0 but for rounding is 0."""
        low = 0.0 if isfinite(self.high) and abs(self.low) <= NONE * abs(self.high) else self.low
        return SettingRange(low * factor, self.high * factor, self.low_open, self.high_open)


def merged(ranges: Iterable[SettingRange]) -> list[SettingRange]:
    """The same values in order, ranges that meet made one."""
    result: list[SettingRange] = []
    for r in sorted(ranges, key=lambda r: (r.low, r.low_open)):
        if result and r.low <= result[-1].high + ALIKE * abs(result[-1].high):
            last = result.pop()
            high = max(last.high, r.high)
            low_open = last.low_open and (r.low_open or not tied(r.low, last.low))
            open_ = all(q.high_open for q in (last, r) if tied(q.high, high))
            r = SettingRange(last.low, high, low_open, open_)
        result.append(r)
    return result


def tied(a: float, b: float) -> bool:
    """Whether two values are the same but for ``TIED`` of the larger."""
    return a == b or (isfinite(a - b) and abs(a - b) <= TIED * max(abs(a), abs(b)))


# -- request and answer -----------------------------------------------------------------------------------


class BlendError(KindynaError):
    """A request that no sequence of curves meets; the text names the setting and its feasible range.

    setting  its name, empty where the request as a whole is wrong; allowed (low, high) or None
    """

    def __init__(self, message: str, setting: str = "", allowed: tuple[float, float] | None = None) -> None:
        self.setting, self.allowed = setting, allowed
        super().__init__(message)


@frozen
class Request:
    """The motion that is wanted.

    type      ``DRD``, ``DRD-return``, ``DRRD`` or ``RRR``
    stroke    of the rise [unit of the motion]; ``return_stroke`` the same where not given (0)
    start, end  cam angles [deg] the blended curves take
    constant  constant velocity in ``none``, ``rise``, ``return`` or ``both``
    settings  h1 ... h6, vcv, vcv2 [per deg], length, length2, peak [deg; peak is a cam angle], acceleration [per deg²]; flat1, flat3,
              flat4, flat6 [deg]: span of a constant acceleration inside the curve of that height, which is a freedom and its
              value at once; a1, a3, a4, a6 [per deg²]: its size
    points    (cam angle [deg], displacement above the lowest level): precision points to pass, each counts as a setting
    sequence  such as ``C1-H2-P2``: this one and no other
    mirrored  whether a return of as many curves as the rise is the rise run backwards; None: where that makes the
              number of settings right
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
        """Of rise and return."""
        return self.stroke, self.return_stroke or self.stroke

    def unit_of(self, setting: str) -> str:
        """Unit of a setting, as it is printed."""
        return UNITS.get(setting, "{u}").format(u=self.unit)

    def renamed(self, name: str) -> str:
        """A return alone may count its curves from 1 and call its speed vcv."""
        return _OF_A_RETURN.get(name, name) if MOTION_TYPES[self.type].rise is None else name

    def spelled_flat(self, height: str) -> str:
        """The span of a constant acceleration inside the curve of a height; of a return alone it counts from 1."""
        name = f"flat{height[-1]}"
        counted = {of: given for given, of in _OF_A_RETURN.items()}
        return counted.get(name, name) if MOTION_TYPES[self.type].rise is None else name

    def spelled(self, name: str) -> str:
        """A setting's name as the request spells it, whose settings may count from 1 where there is a return alone."""
        counts_from_one = any(self.renamed(given) != given for given in self.settings)
        able = (*self.settings, *(_OF_A_RETURN if counts_from_one else ()))
        return next((given for given in able if self.renamed(given) == name), name)

    def constraint(self, name: str, value: float, at: float = 0.0) -> Constraint:
        """A setting as a constraint: angles are counted from the start."""
        name = self.renamed(name)
        if name == "peak":
            return Constraint(name, value - self.start)
        return Constraint(name, value, at - self.start if name == POINT else 0.0)

    @property
    def constraints(self) -> list[Constraint]:
        """All settings and points that take a freedom."""
        settings = [self.constraint(name, value) for name, value in self.settings.items() if name not in FLATS]
        return [*settings, *(self.constraint(POINT, value, at) for at, value in self.points)]

    @property
    def flats(self) -> dict[str, float]:
        """Height of a curve -> span of the constant acceleration inside it [deg]."""
        return {height_of(self.renamed(name)): value for name, value in self.settings.items() if name in FLATS}

    def validate(self) -> None:
        """Raises BlendError where a word is unknown, a number is out of its range or a setting is named twice."""
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
        self._require_settings()

    def validate_angles(self) -> None:
        """Raises BlendError where the curves have no room between start and end."""
        if not has_room(self.start, self.end):
            angles = f"start {self.start:g} deg, end {self.end:g} deg"
            raise BlendError(
                f"{angles}: outside their range; allowed: 0 <= start < end <= 360 deg, at least {LEAST_SPAN:g} deg apart"
            )

    def _require_settings(self) -> None:
        meant: dict[str, str] = {}
        for name, value in self.settings.items():
            if name not in SETTINGS:
                raise BlendError(f"{name}: unknown setting; allowed: {' | '.join(SETTINGS)}")
            other = meant.setdefault(self.renamed(name), name)
            if other != name:
                raise BlendError(
                    f"{other}, {name}: two names of one setting where there is only a return; give one", name
                )
            least = ">=" if name in MAY_VANISH else ">"
            if not 0.0 <= value < 1e100 or (value == 0.0 and name not in MAY_VANISH):
                raise BlendError(
                    f"{name} = {value:g}: outside its range; allowed: {least} 0 {self.unit_of(name)}", name
                )
        for name in self.settings:
            if name in SIZES and height_of(self.renamed(name)) not in self.flats:
                raise BlendError(
                    f"{name}: size of a constant acceleration without its span; give flat{name[-1]} too", name
                )
        if self.flats and self.points:
            name = next(name for name in self.settings if name in FLATS)
            raise BlendError(
                f"{name}: no constant acceleration beside a point to pass; give a height, speed or length instead", name
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
"""What can be set of any sequence, each with a number, counted from 1: its unit and what it is."""


@frozen
class SequenceRequest:
    """Any curves of the table in a row, between two cam angles [deg].

    curves    names in order, such as ``C1``, ``H2``, ``P2``
    settings  h1, span1, v1 [per deg], a1 [per deg²], end1 [cam angle, deg] of the curves counted from 1; rise1, return1 of the
              strokes, each a run of curves in one direction
    """

    curves: tuple[str, ...]
    start: float
    end: float
    settings: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    unit: str = "mm"

    @property
    def type(self) -> str:
        """None of Yang's types of motion."""
        return ""

    @property
    def sequence(self) -> str:
        """``C1-H2-P2``."""
        return "-".join(self.curves)

    @property
    def closes(self) -> bool:
        """Whether the last curve joins the first in the next turn: over the whole turn, ends alike and no dwell."""
        alike = ELEMENTS[self.curves[0]].start == ELEMENTS[self.curves[-1]].end != DWELL
        return alike and self.end - self.start == 360.0

    @property
    def strokes(self) -> dict[str, tuple[int, ...]]:
        """rise1, return1, ... -> its curves, in the order of the motion."""
        result: dict[str, tuple[int, ...]] = {}
        counts = {1: 0, -1: 0}
        for sign, run in groupby(range(len(self.curves)), key=lambda i: ELEMENTS[self.curves[i]].velocity_sign):
            counts[sign] += 1
            result[f"{'rise' if sign > 0 else 'return'}{counts[sign]}"] = tuple(run)
        return result

    @property
    def names(self) -> tuple[str, ...]:
        """All that can be set."""
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
        """How many settings it takes: heights and spans, less the joins that are no dwell, less the whole span."""
        joins = sum(ELEMENTS[name].end != DWELL for name in self.curves[:-1]) + self.closes
        return 2 * len(self.curves) - joins - 1

    def unit_of(self, name: str) -> str:
        """Unit of a setting, as it is printed."""
        return KINDS[name.rstrip("0123456789")][0].format(u=self.unit)

    def validate(self) -> None:
        """Raises BlendError where curves do not join, a setting is unknown or a number is out of its range."""
        if broken := sequence_error(self.sequence):
            raise BlendError(f"sequence {self.sequence}: {broken}")
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
    """The answer: curves in order with their spans [deg] and signed rises, from cam angle ``start``."""

    request: Request | SequenceRequest
    solution: BlendSolution
    segments: tuple[Segment, ...]

    @property
    def curves(self) -> tuple[str, ...]:
        """Names of the curves, in the order of the motion."""
        return self.solution.sequence.curves

    @property
    def gain(self) -> float:
        """How much higher the curves end than they start."""
        return fsum(s.rise for s in self.segments)

    @property
    def first_level(self) -> float:
        """Where they start above their lowest level."""
        return -min(accumulate((s.rise for s in self.segments), initial=0.0)) + 0.0
