"""Requests for blended motions, the description of their settings, and the resulting segments."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context
from functools import cached_property
from itertools import accumulate
from math import fsum, inf, isfinite
from types import MappingProxyType
from typing import NamedTuple

from core.blend.equations import BlendSolution, BlendTask, Family
from core.blend.sequences import CONSTANT_VELOCITY, MOTION_TYPES, BlendCurve, CurveChain, sequence_error
from core.design import Segment
from core.errors import KindynaError
from core.frozen import frozen

# -- settings ---------------------------------------------------------------------------------------------


class SettingKind(NamedTuple):
    """Kind of a setting: the product c h^height β^span of a curve of height h and span β, or the sum over several curves."""

    height: int
    span: int
    meaning: str
    is_sum: bool = False

    @property
    def unit(self) -> str:
        """Unit as printed; {u} is the unit of the motion."""
        return {(0, 1): "deg", (1, 0): "{u}", (1, -1): "{u}/deg", (1, -2): "{u}/deg^2"}[self.height, self.span]

    def factor(self, curve: BlendCurve) -> float:
        """Factor c of the product, from Yang's Table 1."""
        return {-1: curve.speed, -2: curve.peak}.get(self.span, 1.0)


KINDS: Mapping[str, SettingKind] = MappingProxyType(
    {
        "h": SettingKind(1, 0, "height of that curve"),
        "span": SettingKind(0, 1, "span of that curve"),
        "v": SettingKind(1, -1, "speed of that curve at its moving end"),
        "a": SettingKind(1, -2, "largest acceleration of that curve"),
        "end": SettingKind(0, 1, "cam angle where that curve ends", is_sum=True),
        "rise": SettingKind(1, 0, "height of that rise", is_sum=True),
        "return": SettingKind(1, 0, "height of that return", is_sum=True),
    }
)
"""Kinds by name; the settings of any sequence are named by kind and number, counted from 1."""
POINT = "point"
_KINDS_OF_TYPES = {"vcv": "v", "length": "span", "flat": "span", "peak": "end", "acceleration": "a", POINT: "h"}


def kind_of(name: str) -> SettingKind:
    """Kind of a setting, ``h1`` or ``vcv2``."""
    stem = name.rstrip("0123456789")
    return KINDS[_KINDS_OF_TYPES.get(stem, stem)]


HEIGHTS = ("h1", "h2", "h3", "h4", "h5", "h6")
FLATS = ("flat1", "flat3", "flat4", "flat6")
"""Span [deg] of the constant acceleration inside the curve of that height, which is C1, C2, C3 or C4."""
SIZES = ("a1", "a3", "a4", "a6")
"""Value [per deg²] of that constant acceleration."""
LENGTHS = ("length", "length2")
"""Spans [deg] of the constant velocities, in the order of the motion."""
SPANS = ("span1", "span3", "span4", "span6")
"""Span [deg] of the curve itself, which limits the span of its constant acceleration; no setting of a type of motion."""
SETTINGS = (*HEIGHTS, "vcv", "vcv2", *LENGTHS, "peak", "acceleration", *FLATS, *SIZES)
"""Settings of the four types of motion."""
MAY_VANISH = ("h2", "h5", *LENGTHS)
"""Settings of a type that may be 0: a constant velocity without length."""
LEAST_SPAN = 1e-3
"""Least span [deg] from start to end."""
LEAST_STROKE = 1e-9
NONLINEAR = ("acceleration", *SIZES, POINT)
SAME = 1e-9  # relative width of a range that is one value, and relative gap below which ranges are merged
NEGLIGIBLE = 1e-12  # lower end relative to the upper end, below which it is 0
TIED = 1e-12  # relative difference of equal values
ROUNDING = 1e-13  # relative difference from nine digits that is rounding
RETURN_NAMES: Mapping[str, str] = MappingProxyType(
    {"h4": "h1", "h5": "h2", "h6": "h3", "vcv2": "vcv", "flat4": "flat1", "flat6": "flat3", "a4": "a1", "a6": "a3"}
)
"""Settings of a return -> their names where the motion has no rise: Yang counts its curves from 1."""
_STANDARD_NAMES = {counted: name for name, counted in RETURN_NAMES.items()}


class Constraint(NamedTuple):
    """A setting with its value, or a point to pass; cam angles are counted from the start of the curves.

    Attributes
    ----------
    name : name in ``Request.names``, or ``point``
    value : its value
    at : cam angle of a point [deg]
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
    """Value of a setting that is 1 where stroke of the rise and span are 1; spans of half cycloids are 2 h/V."""
    kind = kind_of(name)
    unit = task.rise / task.span**-kind.span if kind.height else task.span
    return 2.0 * unit if name in SPANS else unit


def in_units(constraint: Constraint, task: BlendTask) -> Constraint:
    """Constraint for a stroke and a span of 1."""
    name, value, at_angle = constraint
    return Constraint(name, value / unit_of(name, task), at_angle / task.span)


def height_of(name: str) -> str:
    """Height of the curve to which a constant acceleration belongs: ``h1`` for ``flat1`` or ``a1``."""
    return f"h{name[-1]}"


def ratio(name: str, family: Family) -> tuple[str, str]:
    """Numerator and denominator form of a linear setting; an empty name is 1."""
    if name in LENGTHS:
        return ("h2", "W") if name == "length" and family.has_constant_rise else ("h5", "R")
    if name == "peak":
        return "up", "W"
    if name in SPANS:
        return height_of(name), "W" if height_of(name) in HEIGHTS[:3] else "R"
    return {"vcv": "W", "vcv2": "R"}.get(name, name), ""


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

    def shifted(self, offset: float) -> SettingRange:
        """Range with both ends larger by an offset."""
        return SettingRange(self.low + offset, self.high + offset, self.low_open, self.high_open)

    @property
    def is_single(self) -> bool:
        """Whether the range is one value."""
        return isfinite(self.high) and self.high - self.low <= SAME * max(abs(self.low), abs(self.high))

    def text(
        self, name: str, digits: int = 9, same: float = ROUNDING, show: Callable[[float], str] = "{:.9g}".format
    ) -> str:
        """Range as text, ``0.1 < vcv <= 0.2``; closed ends are rounded inwards, so that they can be entered.

        An end that is a round number but for a relative difference ``same`` is rounded to it.
        """
        low = show(rounded(self.low, digits, ROUND_HALF_EVEN if self.low_open else ROUND_CEILING, same))
        if self.high == inf:
            return f"{name} {'>' if self.low_open else '>='} {low}"
        high = show(rounded(self.high, digits, ROUND_HALF_EVEN if self.high_open else ROUND_FLOOR, same))
        return f"{low} {'<' if self.low_open else '<='} {name} {'<' if self.high_open else '<='} {high}"


def nearest_feasible(ranges: Sequence[SettingRange], value: float) -> float | None:
    """Feasible value nearest to an infeasible one, rounded inwards; None where no end of a range can be entered."""
    lows = [rounded(r.low, 9, ROUND_CEILING, SAME) for r in ranges if not r.low_open and r.low > value]
    highs = [rounded(r.high, 9, ROUND_FLOOR, SAME) for r in ranges if not r.high_open and r.high < value]
    return min((*lows, *highs), key=lambda end: abs(end - value), default=None)


def rounded(value: float, digits: int, rounding: str = ROUND_HALF_EVEN, same: float = 0.0) -> float:
    """Value rounded as given to some digits, but to the nearest where its relative difference is at most ``same``."""
    nearest, directed = (
        float(Context(prec=digits, rounding=r).create_decimal(value)) for r in (ROUND_HALF_EVEN, rounding)
    )
    return nearest if abs(nearest - value) <= same * abs(value) else directed


def merged(ranges: Iterable[SettingRange]) -> list[SettingRange]:
    """Ranges in ascending order, with overlapping and adjacent ones merged."""
    result: list[SettingRange] = []
    for r in sorted(ranges, key=lambda r: (r.low, r.low_open)):
        if result and r.low <= result[-1].high + SAME * abs(result[-1].high):
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
    ranges : feasible ranges of the setting in the message
    """

    def __init__(
        self,
        message: str,
        setting: str = "",
        allowed: tuple[float, float] | None = None,
        ranges: Sequence[SettingRange] = (),
    ) -> None:
        self.setting, self.allowed, self.ranges = setting, allowed, tuple(ranges)
        super().__init__(message)


def infeasible(text: str, name: str, ranges: Sequence[SettingRange], unit: str, other_settings: str) -> BlendError:
    """Refusal of a setting, with its feasible ranges under other settings."""
    tail = f" with {other_settings}" if other_settings else ""
    shown = " or ".join(r.text(name) for r in ranges) or "none"
    allowed = (ranges[0].low, ranges[-1].high) if ranges else None
    return BlendError(f"{text} is not feasible{tail}; feasible: {shown} {unit}", name, allowed, ranges)


@frozen
class Request:
    """Request for a blended motion of one of Yang's types, or of any sequence of curves.

    Attributes
    ----------
    type : ``DRD``, ``DRD-return``, ``DRRD`` or ``RRR``; empty for any curves that join, as ``sequence`` names them
    stroke : stroke of the rise [unit of the motion]; of any sequence that of the first stroke in the order rise, return,
        0 where the settings determine it
    start, end : cam angles [deg] between which the curves lie
    constant : strokes with constant velocity: ``none``, ``rise``, ``return`` or ``both``; only of a type
    settings : of a type: h1 ... h6; vcv, vcv2 [per deg]; length, length2 [deg]; peak, a cam angle [deg]; acceleration
        [per deg²]; flat1, flat3, flat4, flat6, spans [deg] of constant acceleration inside the curve of that height, each
        of which adds a freedom and determines it; a1, a3, a4, a6, values [per deg²] of these accelerations. Of any
        sequence: h1, span1 [deg], v1 [per deg], a1 [per deg²], end1, a cam angle [deg], of the curves counted from 1;
        rise1, return1 of the strokes, each of adjacent curves in one direction
    return_stroke : stroke of the return, 0 for that of the rise; of any sequence that of the first return, 0 where the
        settings determine it
    points : precision points (cam angle [deg], displacement above the lowest level); each counts as a setting; only of a
        type
    sequence : the only sequence to consider, such as ``C1-H2-P2``; empty for all of the type
    mirrored : whether a return with as many curves as the rise is the rise run backwards; None: where this gives the
        right number of settings; only of a type
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
        """Strokes of rise and return of a type."""
        return self.stroke, self.return_stroke or self.stroke

    @cached_property
    def chain(self) -> CurveChain:
        """Curves of any sequence."""
        return CurveChain(tuple(self.sequence.upper().split("-")), self.end - self.start == 360.0)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all settings."""
        return SETTINGS if self.type else self.chain.names

    @property
    def given(self) -> Mapping[str, float]:
        """Settings with their values, the strokes of any sequence among them."""
        if self.type:
            return self.settings
        names = [name for name in ("rise1", "return1") if name in self.chain.strokes]
        strokes = dict(zip(names, (self.stroke, self.return_stroke), strict=False))
        return {name: value for name, value in strokes.items() if value} | dict(self.settings)

    def unit_of(self, setting: str) -> str:
        """Unit of a setting, as printed."""
        return kind_of(setting).unit.format(u=self.unit)

    def offset_of(self, setting: str) -> float:
        """Start of the curves, from which cam angles are counted, for a setting that is a cam angle; else 0."""
        return self.start if kind_of(setting) is KINDS["end"] else 0.0

    def standard_name(self, name: str) -> str:
        """Name of a setting in ``names``; a return alone may count its curves from 1 and call its speed vcv."""
        return _STANDARD_NAMES.get(name, name) if self.type and MOTION_TYPES[self.type].rise is None else name

    def flat_name(self, height: str) -> str:
        """Setting for the span of constant acceleration in the curve of a height; a return alone counts from 1."""
        name = f"flat{height[-1]}"
        return RETURN_NAMES.get(name, name) if MOTION_TYPES[self.type].rise is None else name

    def requested_name(self, name: str) -> str:
        """Name of a setting as the request writes it: a return alone may count its curves from 1."""
        counts_from_one = any(self.standard_name(requested) != requested for requested in self.settings)
        names = (*self.settings, *(_STANDARD_NAMES if counts_from_one else ()))
        return next((requested for requested in names if self.standard_name(requested) == name), name)

    def constraint(self, name: str, value: float, at: float = 0.0) -> Constraint:
        """A setting as a constraint, with angles measured from the start."""
        name = self.standard_name(name)
        return Constraint(name, value - self.offset_of(name), at - self.start if name == POINT else 0.0)

    @property
    def constraints(self) -> list[Constraint]:
        """All settings and points that determine a freedom."""
        settings = [self.constraint(name, value) for name, value in self.given.items() if name not in FLATS]
        return [*settings, *(self.constraint(POINT, value, at) for at, value in self.points)]

    @property
    def flats(self) -> dict[str, float]:
        """Height of a curve -> span of the constant acceleration inside it [deg]."""
        return {height_of(self.standard_name(name)): value for name, value in self.settings.items() if name in FLATS}

    # -- validity -----------------------------------------------------------------------------------------

    def validate(self) -> None:
        """Raise BlendError where a word is unknown, a number is out of its range or a setting is given twice."""
        if self.type not in MOTION_TYPES and (self.type or not self.sequence):
            raise BlendError(f"type {self.type!r}: unknown; allowed: {' | '.join(MOTION_TYPES)}")
        if self.type:
            self._validate_strokes()
        elif fault := sequence_error(self.sequence):
            raise BlendError(f"sequence {self.sequence}: {fault}")
        elif self.points:
            remedy = "set the cam angle where a curve ends: --set end2=120"
            raise BlendError(f"--point: only of the four types of motion; {remedy}")
        self.validate_angles()
        requested_names: dict[str, str] = {}
        for name, value in self.given.items():
            first = requested_names.setdefault(self.standard_name(name), name)
            if first != name:
                raise BlendError(f"{first}, {name}: two names of the same setting of a return; give one", name)
            self._validate_setting(name, value)
        if self.type:
            self._validate_combinations()

    def _validate_strokes(self) -> None:
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

    def validate_angles(self) -> None:
        """Raise BlendError where the curves have no room between start and end."""
        if not has_room(self.start, self.end):
            angles = f"start {self.start:g} deg, end {self.end:g} deg"
            raise BlendError(
                f"{angles}: outside their range; allowed: 0 <= start < end <= 360 deg, at least {LEAST_SPAN:g} deg between them"
            )

    def _validate_setting(self, name: str, value: float) -> None:
        """Raise BlendError where a setting does not exist or its value is outside its range."""
        if name not in self.names:
            fault = "unknown setting" if self.type else f"no setting of {self.chain}"
            raise BlendError(f"{name}: {fault}; allowed: {' | '.join(self.names)}", "" if self.type else name)
        is_angle = not self.type and kind_of(name) is KINDS["end"]
        low, high = (self.start, self.end) if is_angle else (0.0, 1e100)
        may_vanish = bool(self.type) and name in MAY_VANISH
        least = LEAST_STROKE if name.startswith(("rise", "return")) else 0.0
        if not (low < value < high and value >= least) and not (value == 0.0 and may_vanish):
            allowed = f"{low:g} < {name} < {high:g}" if is_angle else f"{'>=' if may_vanish else '>'} 0"
            if not (self.type or is_angle):
                allowed = f"{name} {allowed}"
            raise BlendError(f"{name} = {value:g}: outside its range; allowed: {allowed} {self.unit_of(name)}", name)

    def _validate_combinations(self) -> None:
        """Raise BlendError where settings of a type cannot be combined, or a point is outside the curves."""
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


@frozen
class BlendResult:
    """A blended motion: curves in order with spans [deg] and signed rises, from ``start`` of the request."""

    request: Request
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
