"""What the user requests of a blend: the answers to Yang's questions (Fig. 4) as data, what follows from them, and the
request that the motion in place would have come from. No Qt."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import fsum
from types import MappingProxyType
from typing import Any

from core.blend import CONSTANT_VELOCITY, FLATS, MOTION_TYPES, BlendCandidate, Request, candidates, flat_heights
from core.design import Motion, NamedCurve, Segment, join_angles
from core.design.edits import is_dwell
from core.frozen import frozen

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


__all__ = [
    "AUTOMATIC",
    "OF_A_RETURN",
    "POINT",
    "SETTINGS",
    "SequencePlan",
    "Setting",
    "WizardRequest",
    "constants",
    "count_text",
    "first_request",
    "flats_of",
    "has_both",
    "names_of",
    "open_candidates",
    "plan",
    "ranged",
    "shown_names",
    "words_of",
]
