"""A wish for a blended motion, and the answer: the sequence of curves that the tables admit, its spans and heights."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context
from math import inf, isfinite
from types import MappingProxyType

from core.blend.curves import CONSTANT_VELOCITY, MOTION_TYPES, sequences
from core.blend.curves import Sequence as CurveSequence
from core.blend.family import Family, Solution, Task
from core.blend.solver import SAME, Determined, Problem, Range, merged
from core.blend.wishes import POINT, SETTINGS, Wish
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
MOST_BENT = 2
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

    sequence: CurveSequence
    family: Family
    backwards: bool

    @property
    def freedom(self) -> int:
        return len(self.family.free)


def candidates(request: Request) -> list[Candidate]:
    """The sequences of a type of motion with their freedoms, fewest curves first."""
    found = []
    for sequence in sequences(request.type, request.constant):
        if request.sequence and request.sequence.upper() != str(sequence):
            continue
        backwards = len(sequence.rise) < 2 and len(sequence.back) > 1
        shown = _run_backwards(sequence) if backwards or not sequence.rise else sequence
        backwards = shown is not sequence
        plain = Family(shown)
        if _symmetric(shown) and len(shown.rise) > 1 and request.mirrored is not False:
            mirrored = Family(shown, mirrored=True)
            if len(mirrored.free) < len(plain.free) and _strokes(request)[0] == _strokes(request)[1]:
                found.append(Candidate(sequence, mirrored, backwards))
        if request.mirrored is not True:
            found.append(Candidate(sequence, plain, backwards))
    return found


def blend(request: Request) -> Blended:
    """The motion of fewest curves that does what is asked; where it can in several ways, the gentlest. Raises
    BlendError, which names what would be feasible."""
    require_sense(request)
    wishes = wishes_of(request)
    fitting = [c for c in candidates(request) if c.freedom == len(wishes) and means_something(c, wishes)]
    if not fitting:
        raise _wrong_number(request)
    if sum(not w.linear for w in wishes) > MOST_BENT:
        raise BlendError(f"more than {MOST_BENT} of acceleration and points: give a height, speed or length instead")
    for candidate in fitting:
        try:
            solutions = problem_of(request, candidate, wishes).solutions()
        except Determined:
            continue
        if solutions:
            return answered(request, candidate, solutions[0])
    raise refusal(request, fitting, wishes)


def problem_of(request: Request, candidate: Candidate, wishes: Iterable[Wish]) -> Problem:
    """The wishes as the candidate's family solves them."""
    return Problem(candidate.family, task_of(request, candidate), [_as_solved(request, candidate, w) for w in wishes])


def answered(request: Request, candidate: Candidate, solution: Solution) -> Blended:
    """A family's solution as the request wants it: in the order of time, as segments."""
    return Blended(request, *_ordered(candidate, solution))


def feasible_ranges(request: Request, setting: str, at: float = 0.0) -> list[Range]:
    """What a setting may be while the others stay, as the request spells it; empty where they leave nothing.

    The setting need not be among the request's own: its value does not matter. ``point`` is asked for a cam angle
    ``at``. With settings still to come, these are free.
    """
    require_sense(request)
    wish = _read(request, setting, 1.0, at)
    others = [w for w in wishes_of(request) if (w.name, w.at) != (wish.name, wish.at)]
    wishes = [*others, wish]
    able = [c for c in candidates(request) if means_something(c, wishes)]
    exact = [c for c in able if c.freedom == len(wishes)]
    if exact:
        return _ranges(request, exact, wishes, wish)
    return _bounds(request, [c for c in able if c.freedom > len(wishes)], wish, others)


def feasible_range(request: Request, setting: str, at: float = 0.0) -> tuple[float, float] | None:
    """The ends of all of these; None where there are none."""
    found = feasible_ranges(request, setting, at)
    return (found[0].low, found[-1].high) if found else None


def _ranges(request: Request, rows: Iterable[Candidate], wishes: Sequence[Wish], wish: Wish) -> list[Range]:
    """What one of the wishes may be by any of the candidates."""
    found = []
    for candidate in rows:
        problem = problem_of(request, candidate, wishes)
        solved = problem.wishes[wishes.index(wish)]
        found += [_shown(r, request, candidate, wish) for r in problem.ranges(solved)]
    return merged(found)


def _bounds(request: Request, rows: Iterable[Candidate], wish: Wish, kept: Sequence[Wish]) -> list[Range]:
    """The same with only some of the others kept."""
    found = []
    for candidate in rows:
        problem = problem_of(request, candidate, [wish, *kept])
        found += [_shown(r, request, candidate, wish) for r in problem.bounds(problem.wishes[0], problem.wishes[1:])]
    return merged(found)


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
    for name, value in request.settings.items():
        if name not in SETTINGS:
            raise BlendError(f"{name}: unknown setting; allowed: {' | '.join(SETTINGS)}")
        if not 0.0 < value < 1e15:
            unit = UNITS.get(name, "{u}").format(u=request.unit)
            raise BlendError(f"{name} = {value:g}: outside its range; allowed: > 0 {unit}", name)
    for at, value in request.points:
        if not (request.start < at < request.end and isfinite(value)):
            raise BlendError(
                f"point at {at:g} deg = {value:g}: outside its range; allowed: {request.start:g} < angle < "
                f"{request.end:g} deg",
                POINT,
            )


def _renamed(request: Request, name: str) -> str:
    """A return alone may count its curves from 1 and call its speed vcv."""
    if MOTION_TYPES[request.type].rise is None:
        return _OF_A_RETURN.get(name, name)
    return name


def _read(request: Request, name: str, value: float, at: float = 0.0) -> Wish:
    """A setting as a wish: angles are counted from the start."""
    name = _renamed(request, name)
    if name == "peak":
        return Wish(name, value - request.start)
    return Wish(name, value, at - request.start if name == POINT else 0.0)


def wishes_of(request: Request) -> list[Wish]:
    """All settings and points."""
    return [
        *(_read(request, name, value) for name, value in request.settings.items()),
        *(_read(request, POINT, value, at) for at, value in request.points),
    ]


def means_something(candidate: Candidate, wishes: Iterable[Wish]) -> bool:
    """Whether every wish is of a curve that the candidate has."""
    rise, back = candidate.sequence.rise, candidate.sequence.back
    names = {"acceleration", POINT}
    if len(rise) > 1:
        names |= {"h1", "h3", "vcv", *(("h2", "length") if len(rise) == 3 else ())}
    if len(back) > 1:
        names |= {"h4", "h6", "vcv2", *(("h5", "length") if len(back) == 3 else ())}
    if rise and back:
        names.add("peak")
    return {w.name for w in wishes} <= names


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


def _run_backwards(sequence: CurveSequence) -> CurveSequence:
    rise = tuple(_MIRROR[name] for name in reversed(sequence.back))
    back = tuple(_MIRROR[name] for name in reversed(sequence.rise))
    return CurveSequence(rise, back)


def _symmetric(sequence: CurveSequence) -> bool:
    return _run_backwards(sequence) == sequence


# -- the answer as it is asked --------------------------------------------------------------------------------


def _ordered(candidate: Candidate, solution: Solution) -> tuple[Solution, tuple[Segment, ...]]:
    """The solution in the order of time, and its segments."""
    heights, spans = solution.heights, solution.spans
    speed, back_speed = solution.speed, solution.back_speed
    if candidate.backwards:
        heights, spans, speed, back_speed = heights[::-1], spans[::-1], back_speed, speed
    shown = Solution(candidate.sequence, heights, spans, speed, back_speed)
    rises = len(candidate.sequence.rise)
    segments = tuple(
        Segment(span, height if i < rises else -height, Named(name.lower()))
        for i, (name, height, span) in enumerate(zip(candidate.sequence.curves, heights, spans, strict=True))
        if span > 0.0
    )
    return shown, segments


def _shown(found: Range, request: Request, candidate: Candidate, wish: Wish) -> Range:
    """A range of a family with the angles of the request."""
    if wish.name != "peak":
        return found
    if candidate.backwards:
        end = request.end
        return Range(end - found.high, end - found.low, found.high_open, found.low_open)
    return Range(request.start + found.low, request.start + found.high, found.low_open, found.high_open)


def refusal(request: Request, fitting: Sequence[Candidate], wishes: Sequence[Wish]) -> BlendError:
    """What to tell: the last wish to which the others leave something; else the first that is out of all bounds that
    those before it leave."""
    for wish in reversed(wishes):
        ranges = _ranges(request, fitting, wishes, wish)
        if ranges:
            return told(request, wish, ranges, [w for w in wishes if w is not wish])
    ordered = sorted(wishes, key=lambda w: not w.linear)
    for i, wish in enumerate(ordered):
        ranges = _bounds(request, fitting, wish, ordered[:i])
        value = _shown_value(request, wish)
        if ranges and not any(r.low < value < r.high for r in ranges):
            return told(request, wish, ranges, ordered[:i])
    names = ", ".join(_named(request, w) for w in wishes)
    return BlendError(f"{names}: these settings leave no range; change one of them")


def _shown_value(request: Request, wish: Wish) -> float:
    return wish.value + request.start if wish.name == "peak" else wish.value


def _name(request: Request, wish: Wish) -> str:
    """The setting's name as the request spells it."""
    return next((asked for asked in request.settings if _renamed(request, asked) == wish.name), wish.name)


def _named(request: Request, wish: Wish) -> str:
    """``point at 120 deg = 5``."""
    at = f" at {wish.at + request.start:.9g} deg" if wish.name == POINT else ""
    return f"{_name(request, wish)}{at} = {_shown_value(request, wish):.9g}"


def told(request: Request, wish: Wish, ranges: Sequence[Range], beside: Sequence[Wish]) -> BlendError:
    """The refusal of a wish, with what it may be."""
    unit = UNITS.get(wish.name, "{u}").format(u=request.unit)
    others = ", ".join(_named(request, w) for w in beside)
    tail = f" beside {others}" if others else ""
    name, allowed = _name(request, wish), (ranges[0].low, ranges[-1].high)
    text = f"{_named(request, wish)} {unit} is not feasible{tail}"
    if allowed[1] - allowed[0] <= SAME * max(map(abs, allowed)):
        text = f"{_named(request, wish)} {unit}: determined already{tail}: {allowed[0]:.9g} {unit}; set another one"
        return BlendError(text, name, allowed)
    return BlendError(f"{text}; feasible: {' or '.join(range_text(r, name) for r in ranges)} {unit}", name, allowed)


def range_text(found: Range, name: str) -> str:
    """``0.1 < vcv <= 0.2``; ends that are reached are rounded inwards, so that they can be typed."""
    low, high = _rounded(found.low, not found.low_open), _rounded(found.high, not found.high_open, down=True)
    less, most = "<" if found.low_open else "<=", "<" if found.high_open else "<="
    if found.high == inf:
        return f"{name} {'>' if found.low_open else '>='} {low:.9g}"
    return f"{low:.9g} {less} {name} {most} {high:.9g}"


def _rounded(value: float, inwards: bool, down: bool = False) -> float:
    """Nine digits."""
    way = (ROUND_FLOOR if down else ROUND_CEILING) if inwards else ROUND_HALF_EVEN
    return float(Context(prec=9, rounding=way).create_decimal(value))


def _wrong_number(request: Request) -> BlendError:
    rows = candidates(request)
    if not rows:
        known = " | ".join(str(s) for s in sequences(request.type, request.constant))
        return BlendError(f"sequence {request.sequence!r}: not of this motion; allowed: {known}")
    counts = sorted({(c.freedom, str(c.sequence)) for c in rows})
    wants = "; ".join(f"{name} takes {count} setting{'s' if count != 1 else ''}" for count, name in counts)
    given = ", ".join([*request.settings, *([POINT] * len(request.points))]) or "none"
    return BlendError(f"settings given: {given}; {wants}; or ask for the best")
