"""A request for a blended motion, the sequences of curves that may meet it, and the answer as segments."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import accumulate
from math import fsum, isfinite
from types import MappingProxyType

from core.blend.curves import CONSTANT, CONSTANT_VELOCITY, ELEMENTS, MOTION_TYPES, Sequence, sequences
from core.blend.family import Family, Solution, Task
from core.blend.settings import MAY_VANISH, POINT, SETTINGS, Constraint
from core.blend.solver import Problem
from core.design import Named, Segment
from core.errors import KindynaError

_MIRROR = {
    "C1": "C4", "C2": "C3", "C3": "C2", "C4": "C1", "C5": "C6", "C6": "C5", "CV1": "CV2", "CV2": "CV1",
    "H1": "H4", "H2": "H3", "H3": "H2", "H4": "H1", "H5": "H6", "H6": "H5", "P1": "P2", "P2": "P1",
}  # fmt: skip
_MIRRORED_SETTING = {
    "h1": "h6", "h2": "h5", "h3": "h4", "h4": "h3", "h5": "h2", "h6": "h1", "vcv": "vcv2", "vcv2": "vcv",
}  # fmt: skip
_OF_A_RETURN = {"h1": "h4", "h2": "h5", "h3": "h6", "vcv": "vcv2"}
_CURVES = {name: Named(name.lower()) for name in ELEMENTS}
ROUNDING = 1e-13  # a share of the span; a constant velocity as short is none
UNITS = {"length": "deg", "peak": "deg", "vcv": "{u}/deg", "vcv2": "{u}/deg", "acceleration": "{u}/deg^2"}


class BlendError(KindynaError):
    """A request that no sequence of curves meets; the text names the setting and its feasible range.

    setting  its name, empty where the request as a whole is wrong; allowed (low, high) or None
    """

    def __init__(self, message: str, setting: str = "", allowed: tuple[float, float] | None = None) -> None:
        self.setting, self.allowed = setting, allowed
        super().__init__(message)


@dataclass(frozen=True)
class Request:
    """The motion that is wanted.

    type      ``DRD``, ``DRD-return``, ``DRRD`` or ``RRR``
    stroke    of the rise [unit of the motion]; ``return_stroke`` the same where not given (0)
    start, end  cam angles [deg] the blended curves take
    constant  constant velocity in ``none``, ``rise``, ``return`` or ``both``
    settings  h1 ... h6, vcv, vcv2 [per deg], length, peak [deg; peak is a cam angle], acceleration [per deg²]
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

    def constraint(self, name: str, value: float, at: float = 0.0) -> Constraint:
        """A setting as a constraint: angles are counted from the start."""
        name = self.renamed(name)
        if name == "peak":
            return Constraint(name, value - self.start)
        return Constraint(name, value, at - self.start if name == POINT else 0.0)

    @property
    def constraints(self) -> list[Constraint]:
        """All settings and points."""
        settings = [self.constraint(name, value) for name, value in self.settings.items()]
        return [*settings, *(self.constraint(POINT, value, at) for at, value in self.points)]

    def require_sense(self) -> None:
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
            if not 0.0 < value < 1e9:
                raise BlendError(f"{name} = {value:g}: outside its range; allowed: > 0 {self.unit}")
        if not 0.0 <= self.start < self.end <= 360.0:
            angles = f"start {self.start:g} deg, end {self.end:g} deg"
            raise BlendError(f"{angles}: outside their range; allowed: 0 <= start < end <= 360 deg")
        self._require_settings()

    def _require_settings(self) -> None:
        meant: dict[str, str] = {}
        for name, value in self.settings.items():
            if name not in SETTINGS:
                raise BlendError(f"{name}: unknown setting; allowed: {' | '.join(SETTINGS)}")
            other = meant.setdefault(self.renamed(name), name)
            if other != name:
                raise BlendError(f"{other}, {name}: two names of one setting where there is only a return; give one", name)
            least = ">=" if name in MAY_VANISH else ">"
            if not 0.0 <= value < 1e100 or (value == 0.0 and name not in MAY_VANISH):
                raise BlendError(f"{name} = {value:g}: outside its range; allowed: {least} 0 {self.unit_of(name)}", name)
        for at, value in self.points:
            if not (self.start < at < self.end and isfinite(value)):
                text = f"point at {at:g} deg = {value:g}: outside its range"
                raise BlendError(f"{text}; allowed: {self.start:g} < angle < {self.end:g} deg", POINT)


@dataclass(frozen=True)
class Blended:
    """The answer: curves in order with their spans [deg] and signed rises, from cam angle ``start``."""

    request: Request
    solution: Solution
    segments: tuple[Segment, ...]

    @property
    def curves(self) -> tuple[str, ...]:
        return self.solution.sequence.curves

    @property
    def gain(self) -> float:
        """How much higher the curves end than they start."""
        return fsum(s.rise for s in self.segments)

    @property
    def first_level(self) -> float:
        """Where they start above their lowest level."""
        return -min(accumulate((s.rise for s in self.segments), initial=0.0)) + 0.0


@dataclass(frozen=True)
class Candidate:
    """A sequence with the family that solves it; backwards: of which it is the motion run backwards."""

    sequence: Sequence
    family: Family
    backwards: bool

    @property
    def freedom(self) -> int:
        return self.family.freedom

    @cached_property
    def names(self) -> frozenset[str]:
        """What can be set of its curves."""
        rise, back = self.sequence.rise, self.sequence.back
        names = {"acceleration", POINT}
        if len(rise) > 1:
            names |= {"h1", "h3", "vcv", *(("h2", "length") if len(rise) == 3 else ())}
        if len(back) > 1:
            names |= {"h4", "h6", "vcv2", *(("h5", "length") if len(back) == 3 else ())}
        if rise and back:
            names.add("peak")
        return frozenset(names)

    def has(self, constraints: Iterable[Constraint]) -> bool:
        """Whether every constraint is of a curve that it has."""
        return {c.name for c in constraints} <= self.names

    def takes(self, constraints: list[Constraint]) -> bool:
        """The same, and they are not too many."""
        return len(constraints) <= self.freedom and self.has(constraints)

    def problem(self, request: Request, constraints: Iterable[Constraint]) -> Problem:
        """Strokes, span and constraints as its family solves them, whose time may run backwards."""
        row, span = MOTION_TYPES[request.type], request.end - request.start
        rise, back = (stroke if ends else 0.0 for stroke, ends in zip(request.strokes, (row.rise, row.back), strict=True))
        if not self.backwards:
            return Problem(self.family, Task(rise, back, span), list(constraints))
        return Problem(self.family, Task(back, rise, span), [_run_backwards(c, span) for c in constraints])

    def answer(self, request: Request, solution: Solution) -> Blended:
        """A solution of its family as the request wants it: in the order of time, as segments; a constant velocity of no
        length is none."""
        heights, spans = solution.heights, solution.spans
        if self.backwards:
            heights, spans = heights[::-1], spans[::-1]
            solution = Solution(self.sequence, heights, spans, solution.back_speed, solution.speed)
        none = ROUNDING * sum(spans)
        segments = [
            Segment(span, ELEMENTS[name].velocity_sign * height, _CURVES[name])
            for name, height, span in zip(self.sequence.curves, heights, spans, strict=True)
            if span > (none if name in CONSTANT else 0.0)
        ]
        return Blended(request, solution, tuple(segments))


def candidates(request: Request) -> list[Candidate]:
    """The sequences of a type of motion with their freedoms, fewest curves first."""
    rise, back = request.strokes
    return list(_candidates(request.type, request.constant, request.sequence.upper(), request.mirrored, rise == back))


@lru_cache(maxsize=64)
def _candidates(
    motion_type: str, constant: str, only: str, wanted_mirrored: bool | None, equal: bool
) -> tuple[Candidate, ...]:
    found = []
    for sequence in sequences(motion_type, constant):
        if only and only != str(sequence):
            continue
        backwards = len(sequence.rise) < 2 and (len(sequence.back) > 1 or not sequence.rise)
        solved = _mirror(sequence) if backwards else sequence
        if _mirror(solved) == solved and len(solved.rise) > 1 and wanted_mirrored is not False:
            mirrored = Family(solved, mirrored=True)
            if mirrored.freedom < Family(solved).freedom and equal:
                found.append(Candidate(sequence, mirrored, backwards))
        if wanted_mirrored is not True:
            found.append(Candidate(sequence, Family(solved), backwards))
    return tuple(found)


def _mirror(sequence: Sequence) -> Sequence:
    """The curves of the motion run backwards."""
    rise, back = (tuple(_MIRROR[name] for name in reversed(stroke)) for stroke in (sequence.back, sequence.rise))
    return Sequence(rise, back)


def _run_backwards(constraint: Constraint, span: float) -> Constraint:
    """The same of the motion run backwards."""
    name, value, at = constraint
    return Constraint(
        _MIRRORED_SETTING.get(name, name), span - value if name == "peak" else value, span - at if name == POINT else 0.0
    )
