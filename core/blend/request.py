"""A request for a blended motion, as the families of curves see it, and the answer as segments."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from math import isfinite
from types import MappingProxyType

from core.blend.curves import CONSTANT, CONSTANT_VELOCITY, ELEMENTS, MOTION_TYPES, Sequence, sequences
from core.blend.family import Family, Solution, Task
from core.blend.solver import Problem
from core.blend.wishes import MAY_VANISH, POINT, SETTINGS, Wish
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
    """A wish that no sequence of curves fulfils; the text names the setting and its feasible range.

    setting  its name, empty where the wish as a whole is wrong; allowed (low, high) or None
    """

    def __init__(self, message: str, setting: str = "", allowed: tuple[float, float] | None = None) -> None:
        self.setting, self.allowed = setting, allowed
        super().__init__(message)


@dataclass(frozen=True)
class Request:
    """What is asked.

    type      ``DRD``, ``DRD-return``, ``DRRD`` or ``RRR``
    stroke    of the rise [unit of the motion]; ``return_stroke`` the same where not given (0)
    start, end  cam angles [deg] the blended curves take
    constant  constant velocity in ``none``, ``rise``, ``return`` or ``both``
    settings  h1 ... h6, vcv, vcv2 [per deg], length, peak [deg; peak is a cam angle], acceleration [per deg²]
    points    (cam angle [deg], displacement above the lowest level): precision points to pass, each counts as a setting
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


@dataclass(frozen=True)
class Blended:
    """The answer: curves in order with their spans [deg] and signed rises, from cam angle ``start``."""

    request: Request
    solution: Solution
    segments: tuple[Segment, ...]

    @property
    def curves(self) -> tuple[str, ...]:
        return self.solution.sequence.curves


@dataclass(frozen=True)
class Candidate:
    """A sequence with the family that solves it, perhaps run backwards."""

    sequence: Sequence
    family: Family
    backwards: bool

    @property
    def freedom(self) -> int:
        return self.family.freedom

    @cached_property
    def names(self) -> frozenset[str]:
        """What can be wished of its curves."""
        rise, back = self.sequence.rise, self.sequence.back
        names = {"acceleration", POINT}
        if len(rise) > 1:
            names |= {"h1", "h3", "vcv", *(("h2", "length") if len(rise) == 3 else ())}
        if len(back) > 1:
            names |= {"h4", "h6", "vcv2", *(("h5", "length") if len(back) == 3 else ())}
        if rise and back:
            names.add("peak")
        return frozenset(names)


def candidates(request: Request) -> list[Candidate]:
    """The sequences of a type of motion with their freedoms, fewest curves first."""
    rise, back = _strokes(request)
    made = _candidates(request.type, request.constant, request.sequence.upper(), request.mirrored, rise == back)
    return list(made)


@lru_cache(maxsize=64)
def _candidates(
    motion_type: str, constant: str, only: str, wanted_mirrored: bool | None, equal: bool
) -> tuple[Candidate, ...]:
    found = []
    for sequence in sequences(motion_type, constant):
        if only and only != str(sequence):
            continue
        backwards = len(sequence.rise) < 2 and len(sequence.back) > 1
        shown = _run_backwards(sequence) if backwards or not sequence.rise else sequence
        backwards = shown is not sequence
        plain = Family(shown)
        if _symmetric(shown) and len(shown.rise) > 1 and wanted_mirrored is not False:
            mirrored = Family(shown, mirrored=True)
            if mirrored.freedom < plain.freedom and equal:
                found.append(Candidate(sequence, mirrored, backwards))
        if wanted_mirrored is not True:
            found.append(Candidate(sequence, plain, backwards))
    return tuple(found)


def problem_of(request: Request, candidate: Candidate, wishes: Iterable[Wish]) -> Problem:
    """The wishes as the candidate's family solves them."""
    return Problem(candidate.family, task_of(request, candidate), [_as_solved(request, candidate, w) for w in wishes])


def answered(request: Request, candidate: Candidate, solution: Solution) -> Blended:
    """A family's solution as the request wants it: in the order of time, as segments."""
    return Blended(request, *_ordered(candidate, solution))


# -- the wish as the families see it --------------------------------------------------------------------------


def _strokes(request: Request) -> tuple[float, float]:
    return request.stroke, request.return_stroke or request.stroke


def require_sense(request: Request) -> None:
    if request.type not in MOTION_TYPES:
        raise BlendError(f"type {request.type!r}: unknown; allowed: {' | '.join(MOTION_TYPES)}")
    if request.constant not in CONSTANT_VELOCITY:
        raise BlendError(f"constant velocity {request.constant!r}: unknown; allowed: {' | '.join(CONSTANT_VELOCITY)}")
    row = MOTION_TYPES[request.type]
    if (row.rise is None and request.constant in ("rise", "both")) or (
        row.back is None and request.constant in ("return", "both")
    ):
        missing = "rise" if row.rise is None else "return"
        raise BlendError(f"constant velocity {request.constant}: {request.type} has no {missing}")
    for name, value in (("stroke", request.stroke), ("return stroke", _strokes(request)[1])):
        if not 0.0 < value < 1e9:
            raise BlendError(f"{name} = {value:g}: outside its range; allowed: > 0 {request.unit}")
    if not (0.0 <= request.start < request.end <= 360.0):
        raise BlendError(
            f"start {request.start:g} deg, end {request.end:g} deg: outside their range; "
            "allowed: 0 <= start < end <= 360 deg"
        )
    meant: dict[str, str] = {}
    for name, value in request.settings.items():
        if name not in SETTINGS:
            raise BlendError(f"{name}: unknown setting; allowed: {' | '.join(SETTINGS)}")
        other = meant.setdefault(renamed(request, name), name)
        if other != name:
            raise BlendError(f"{other}, {name}: two names of one setting where there is only a return; give one", name)
        least = ">=" if name in MAY_VANISH else ">"
        if not 0.0 <= value < 1e100 or (value == 0.0 and name not in MAY_VANISH):
            unit = UNITS.get(name, "{u}").format(u=request.unit)
            raise BlendError(f"{name} = {value:g}: outside its range; allowed: {least} 0 {unit}", name)
    for at, value in request.points:
        if not (request.start < at < request.end and isfinite(value)):
            raise BlendError(
                f"point at {at:g} deg = {value:g}: outside its range; allowed: {request.start:g} < angle < "
                f"{request.end:g} deg",
                POINT,
            )


def renamed(request: Request, name: str) -> str:
    """A return alone may count its curves from 1 and call its speed vcv."""
    if MOTION_TYPES[request.type].rise is None:
        return _OF_A_RETURN.get(name, name)
    return name


def wish_of(request: Request, name: str, value: float, at: float = 0.0) -> Wish:
    """A setting as a wish: angles are counted from the start."""
    name = renamed(request, name)
    if name == "peak":
        return Wish(name, value - request.start)
    return Wish(name, value, at - request.start if name == POINT else 0.0)


def wishes_of(request: Request) -> list[Wish]:
    """All settings and points."""
    return [
        *(wish_of(request, name, value) for name, value in request.settings.items()),
        *(wish_of(request, POINT, value, at) for at, value in request.points),
    ]


def means_something(candidate: Candidate, wishes: Iterable[Wish]) -> bool:
    """Whether every wish is of a curve that the candidate has."""
    return {w.name for w in wishes} <= candidate.names


def task_of(request: Request, candidate: Candidate) -> Task:
    """Strokes and span as the candidate's family sees them."""
    rise, back = _strokes(request)
    row = MOTION_TYPES[request.type]
    rise, back = (rise if row.rise else 0.0), (back if row.back else 0.0)
    if candidate.backwards:
        rise, back = back, rise
    return Task(rise, back, request.end - request.start)


def _as_solved(request: Request, candidate: Candidate, wish: Wish) -> Wish:
    """The wish as the candidate's family spells it, whose time may run backwards."""
    if not candidate.backwards:
        return wish
    span = request.end - request.start
    value = span - wish.value if wish.name == "peak" else wish.value
    return Wish(_MIRRORED_SETTING.get(wish.name, wish.name), value, span - wish.at if wish.name == POINT else 0.0)


def _run_backwards(sequence: Sequence) -> Sequence:
    rise = tuple(_MIRROR[name] for name in reversed(sequence.back))
    back = tuple(_MIRROR[name] for name in reversed(sequence.rise))
    return Sequence(rise, back)


def _symmetric(sequence: Sequence) -> bool:
    return _run_backwards(sequence) == sequence


# -- the answer as it is asked --------------------------------------------------------------------------------


def _ordered(candidate: Candidate, solution: Solution) -> tuple[Solution, tuple[Segment, ...]]:
    """The solution in the order of time, and its segments."""
    heights, spans = solution.heights, solution.spans
    if candidate.backwards:
        heights, spans = heights[::-1], spans[::-1]
        solution = Solution(candidate.sequence, heights, spans, solution.back_speed, solution.speed)
    none = ROUNDING * sum(spans)
    rows = zip(candidate.sequence.curves, heights, spans, strict=True)
    segments = [
        Segment(span, ELEMENTS[name].way * height, _CURVES[name])
        for name, height, span in rows
        if span > (none if name in CONSTANT else 0.0)
    ]
    return solution, tuple(segments)
