"""A wish for a blended motion, and the answer: the sequence of curves that the tables admit, its spans and heights."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from core.blend.curves import CONSTANT_VELOCITY, MOTION_TYPES, Sequence, sequences
from core.blend.family import Family, Solution, Task
from core.blend.solver import SETTINGS, Infeasible, Problem
from core.design import Named, Segment
from core.errors import KindynaError

_MIRROR = {
    "C1": "C4", "C2": "C3", "C3": "C2", "C4": "C1", "C5": "C6", "C6": "C5", "CV1": "CV2", "CV2": "CV1",
    "H1": "H4", "H2": "H3", "H3": "H2", "H4": "H1", "H5": "H6", "H6": "H5", "P1": "P2", "P2": "P1",
}  # fmt: skip
_MIRRORED_SETTING = {
    "h1": "h6", "h2": "h5", "h3": "h4", "h4": "h3", "h5": "h2", "h6": "h1", "vcv": "vcv2", "vcv2": "vcv",
}  # fmt: skip
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
    """The gentlest motion that does what is asked. Raises BlendError, which names what would be feasible."""
    _require_sense(request)
    settings = _renamed(request)
    fitting = [c for c in candidates(request) if c.freedom == len(settings) and _means_something(c, settings)]
    if not fitting:
        raise _wrong_number(request, settings)
    refusals: list[Infeasible] = []
    for candidate in fitting:
        task, wanted = _task(request, candidate, settings)
        try:
            solution = Problem(candidate.family, task, wanted).solve()[0]
        except Infeasible as refusal:
            refusals.append(_shown(refusal, request, candidate))
            continue
        return answered(request, candidate, solution)
    raise _told(request, refusals[0])


def prepared(request: Request, candidate: Candidate) -> tuple[Task, dict[str, float]]:
    """The task and the settings as the candidate's family spells them. Raises BlendError where one means nothing."""
    _require_sense(request)
    settings = _renamed(request)
    if not _means_something(candidate, settings):
        raise BlendError(f"{candidate.sequence}: has no use for all of {', '.join(settings)}")
    return _task(request, candidate, settings)


def answered(request: Request, candidate: Candidate, solution: Solution) -> Blended:
    """A family's solution as the request wants it: in the order of time, as segments."""
    return Blended(request, *_ordered(candidate, solution))


def feasible_range(request: Request, setting: str) -> tuple[float, float] | None:
    """What a setting may be while the others stay, as the request spells it; None where they leave nothing.

    The setting need not be among the request's own: its value does not matter.
    """
    _require_sense(request)
    settings = {**_renamed(request), _renamed_one(request, setting): 1.0}
    for candidate in candidates(request):
        if candidate.freedom == len(settings) and _means_something(candidate, settings):
            task, wanted = _task(request, candidate, settings)
            name = _spelled(candidate, _renamed_one(request, setting))
            allowed = Problem(candidate.family, task, wanted).range_of(name)
            if allowed is not None:
                return _range_shown(allowed, request, candidate, name)
    return None


# -- the wish as the families see it --------------------------------------------------------------------------


def _strokes(request: Request) -> tuple[float, float]:
    return request.stroke, request.return_stroke or request.stroke


def _require_sense(request: Request) -> None:
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
            raise BlendError(f"{name} = {value:g}: outside its range; allowed: > 0", name)


def _renamed_one(request: Request, name: str) -> str:
    """A return alone may count its curves from 1 and call its speed vcv."""
    if MOTION_TYPES[request.type].rise is None:
        return {"h1": "h4", "h2": "h5", "h3": "h6", "vcv": "vcv2"}.get(name, name)
    return name


def _renamed(request: Request) -> dict[str, float]:
    return {_renamed_one(request, name): value for name, value in request.settings.items()}


def _means_something(candidate: Candidate, settings: Mapping[str, float]) -> bool:
    rise, back = candidate.sequence.rise, candidate.sequence.back
    names = {"acceleration"}
    if len(rise) > 1:
        names |= {"h1", "h3", "vcv", *(("h2", "length") if len(rise) == 3 else ())}
    if len(back) > 1:
        names |= {"h4", "h6", "vcv2", *(("h5", "length") if len(back) == 3 else ())}
    if rise and back:
        names.add("peak")
    return set(settings) <= names


def _task(request: Request, candidate: Candidate, settings: Mapping[str, float]) -> tuple[Task, dict[str, float]]:
    rise, back = _strokes(request)
    row = MOTION_TYPES[request.type]
    rise, back = (rise if row.rise else 0.0), (back if row.back else 0.0)
    if candidate.backwards:
        rise, back = back, rise
    span = request.end - request.start
    wanted = {}
    for name, value in settings.items():
        if name == "peak":
            value = request.end - value if candidate.backwards else value - request.start
        wanted[_spelled(candidate, name)] = value
    return Task(rise, back, span), wanted


def _spelled(candidate: Candidate, name: str) -> str:
    return _MIRRORED_SETTING.get(name, name) if candidate.backwards else name


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


def _range_shown(
    allowed: tuple[float, float], request: Request, candidate: Candidate, name: str
) -> tuple[float, float]:
    low, high = allowed
    if name == "peak":
        return (
            (request.end - high, request.end - low)
            if candidate.backwards
            else (request.start + low, request.start + high)
        )
    return low, high


def _shown(refusal: Infeasible, request: Request, candidate: Candidate) -> Infeasible:
    """The refusal with the names and angles of the request."""
    name, value = refusal.setting, refusal.value
    if name == "peak":
        value = request.end - value if candidate.backwards else request.start + value
    allowed = None if refusal.allowed is None else _range_shown(refusal.allowed, request, candidate, name)
    spelled = _MIRRORED_SETTING.get(name, name) if candidate.backwards else name
    for asked in request.settings:
        if _renamed_one(request, asked) == spelled:
            spelled = asked
            break
    return Infeasible(spelled, value, allowed)


def _told(request: Request, refusal: Infeasible) -> BlendError:
    unit = UNITS.get(refusal.setting, "{u}").format(u=request.unit)
    others = ", ".join(f"{n} = {v:g}" for n, v in request.settings.items() if n != refusal.setting)
    beside = f" beside {others}" if others else ""
    text = f"{refusal.setting} = {refusal.value:.9g} {unit} is not feasible{beside}"
    if refusal.allowed is None:
        return BlendError(f"{text}; these settings leave no range: change {others or 'the stroke'}", refusal.setting)
    low, high = refusal.allowed
    return BlendError(f"{text}; feasible: {low:.9g} ... {high:.9g} {unit}", refusal.setting, refusal.allowed)


def _wrong_number(request: Request, settings: Mapping[str, float]) -> BlendError:
    rows = candidates(request)
    if not rows:
        known = " | ".join(str(s) for s in sequences(request.type, request.constant))
        return BlendError(f"sequence {request.sequence!r}: not of this motion; allowed: {known}")
    told = sorted({(c.freedom, str(c.sequence)) for c in rows})
    wants = "; ".join(f"{name} takes {count} setting{'s' if count != 1 else ''}" for count, name in told)
    given = ", ".join(request.settings) or "none"
    return BlendError(f"settings given: {given}; {wants}; or ask for the best")
