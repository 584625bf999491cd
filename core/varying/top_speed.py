"""Top speed: the fastest machine within its limits, as a study of speed, spans, laws and phases, and as a search."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import fsum
from typing import Any

from core.design import Design, distances, drive_names, entry_at, get, named_event, only, path_in, phase_path, varied
from core.design.camshaft import drive_of
from core.design.edits import is_dwell
from core.design.motions import NamedCurve, OptimalCurve, SccaCurve
from core.errors import KindynaError
from core.find import Solution, StatedLimits
from core.find.goals import speed_path
from core.find.solution import Judge, Judgement, out_of_bounds
from core.find.trial import FindingsCheck
from core.motion import program
from core.number_text import result_text
from core.study import Study, many
from core.study.limits import LIMITS, limits_in_force
from core.varying.machine_limits import FORCE_MIN, ROWS, machine_limits
from core.varying.optimum import STARTS, Optimum, optimise, waived, with_flywheel
from core.varying.request import Goal, StudyFile, StudyOfMany, VariedField, study_of
from core.varying.space import QUIET_LAWS, constant_column, valid_words
from core.varying.tolerances import bounds_of

TOP_SPEED = "top-speed"
TITLE = "Top speed"
SPEED_RANGE = (0.1, 10.0)  # of the present speed
SPAN_RANGE = (0.5, 2.0)  # of the present span
PHASE_RANGE = 60.0  # [deg] to either side of the present phase
MOST_LAWS = 25  # combinations of laws
DIGITS = 6  # certain digits of the result

# -- what is varied ---------------------------------------------------------------------------------------------


def top_speed_study(design: Design, vary: Sequence[VariedField] = (), stated: StatedLimits | None = None) -> StudyFile:
    """Study whose goal is the speed, within the limits of the design, of its drives and of their servos.

    Parameters
    ----------
    design : Design
    vary : sequence of VariedField
        Varied fields next to the speed; without any: spans and laws of segments that are no process windows, and phases.
    stated : dict
        Key of a limit (``machine_limits``), or path of a varied number with _min or _max -> its value, None: no such limit.

    Raises
    ------
    KindynaError
        Where the design has no speed, or no such limit.
    """
    path = speed_path(design)
    entry = entry_at(design, path)
    if entry is None or not entry.value:
        raise KindynaError(f"find {TOP_SPEED}: the design has no speed; give {path}")
    low, high = sorted(part * float(entry.value) for part in SPEED_RANGE)
    others = [row for row in vary if row.field != path] if vary else list(_ready_fields(design))
    rows = [next((row for row in vary if row.field == path), VariedField(path, low, high)), *others]
    rest = dict(stated or {})
    rows = [_bounded(row, rest.pop(f"{row.field}_min", None), rest.pop(f"{row.field}_max", None)) for row in rows]
    return StudyFile(
        design="",
        seed=1,
        vary=tuple(rows),
        limits=machine_limits(design, rest),
        goals=(Goal(field=path, minimise=float(entry.value) < 0.0),),
    )


def _bounded(row: VariedField, low: float | None, high: float | None) -> VariedField:
    """Row with other bounds where they are stated. Raises KindynaError for reversed bounds."""
    row = replace(row, low=row.low if low is None else low, high=row.high if high is None else high)
    if row.low is not None and row.high is not None and not row.low < row.high:
        raise KindynaError(
            f"{row.field} = {row.low:g} ... {row.high:g}: bounds are reversed; state both, as --vary {row.field}=LOW:HIGH"
        )
    return row


def _ready_fields(design: Design) -> Iterator[VariedField]:
    """Spans, phases and laws of all drives, as far as they may change."""
    names = list(drive_names(design)) if design.listed else []
    ordered = {
        names.index(drive_of(named_event(design, event))) for row in design.timing for event in (row.first, row.second)
    }
    for number in range(len(design.drives)):
        yield from _spans(design, number, with_dwells=number in ordered)
    for number in sorted(ordered)[1:]:
        path = phase_path(design, number)
        present = float(get(design, path))
        yield VariedField(path, present - PHASE_RANGE, present + PHASE_RANGE)
    yield from _laws(design)


def _spans(design: Design, number: int, with_dwells: bool) -> Iterator[VariedField]:
    """Spans of a drive but one, which makes up for them; dwells only where their ends must follow other drives."""
    single = only(design, number)
    free, motion = _free_segments(single), single.drive.motion
    segments = () if motion is None else motion.segments
    last = max(free, key=lambda i: (is_dwell(segments[i]), segments[i].span_deg), default=-1)
    rows = [i for i in free if i != last and (with_dwells or not is_dwell(segments[i]))]
    total, left = (fsum(segments[i].span_deg for i in free if (i in rows) == varies) for varies in (True, False))
    shortest, longest = SPAN_RANGE
    if rows and not with_dwells:  # the others lose half of their spans at most
        longest = min(longest, 1.0 + (1.0 - shortest) * left / total)
    for i in rows:
        low, high = (float(f"{part * segments[i].span_deg:.6g}") for part in (shortest, longest))
        yield VariedField(path_in(design, number, f"motion.segments[{i}].span_deg"), low, min(high, 360.0))


def _free_segments(design: Design) -> list[int]:
    """Segments of a drive whose span may change: no process windows, of a motion that is typed and at rest at all joins."""
    motion = design.drive.motion
    if motion is None or motion.is_computed or motion.lobe is not None or motion.needs_machine:
        return []
    if not program(motion).is_rest_to_rest:
        return []
    scalable = all(
        isinstance(s.curve, NamedCurve | SccaCurve) or (isinstance(s.curve, OptimalCurve) and not s.curve.points)
        for s in motion.segments
        if not s.fixed
    )
    return [i for i, segment in enumerate(motion.segments) if not segment.fixed] if scalable else []


def _laws(design: Design) -> Iterator[VariedField]:
    """Laws of moving segments, the present one and as many quiet ones as all segments can have in few combinations."""
    moving = []
    for number in range(len(design.drives)):
        single = only(design, number)
        for i in _free_segments(single):
            segment = single.drive.motion.segments[i]  # type: ignore[union-attr]
            if segment.rise and isinstance(segment.curve, NamedCurve):
                moving.append((path_in(design, number, f"motion.segments[{i}].law"), segment.curve.law))
    count = next((n for n in range(len(QUIET_LAWS), 1, -1) if n ** len(moving) <= MOST_LAWS), 0)
    for path, law in moving if count else ():
        words = valid_words(design, path, (law, *(word for word in QUIET_LAWS if word != law)))[:count]
        if len(words) > 1:
            yield VariedField(field=path, choices=words)


# -- the request ------------------------------------------------------------------------------------------------


def has_top_speed(design: Design) -> bool:
    """Whether a design has a speed, and a drive with a motion."""
    entry = entry_at(design, speed_path(design))
    return entry is not None and bool(entry.value) and any(drive.motion is not None for drive in design.drives)


def default_limits(design: Design) -> Mapping[str, float | None]:
    """Keys of limits for a design, with the values that apply to its only drive; those of several drives differ."""
    single = None if design.listed else design
    typical = {} if single is None else {key: row.value for key, row in limits_in_force(Study(single)).items()}
    keys = [key for key in ROWS if key in LIMITS or key == FORCE_MIN]
    values = {key: None if single is None else ROWS[key].own(single) or typical.get(key) for key in keys}
    path = speed_path(design)
    return {**values, f"{path}_min": None, f"{path}_max": None}


# -- the search -------------------------------------------------------------------------------------------------


Steps = list[tuple[int, float]]
"""Number of the start and speed of every intermediate design of a search."""


def find_top_speed(
    design: Design,
    stated: StatedLimits,
    vary: Sequence[VariedField] = (),
    notify: Callable[[int], object] = lambda count: None,
) -> Solution:
    """Fastest machine within its limits.

    Parameters
    ----------
    design : Design
    stated, vary
        As of ``top_speed_study``.
    notify : callable
        Called with the number of steps so far.

    Returns
    -------
    Solution
        Its curve has the speed after each step of the search.

    Raises
    ------
    KindynaError
        Where nothing bounds the speed, or the request is wrong.
    """
    study = study_of(top_speed_study(design, vary, stated), design)
    path = study.file.goals[0].field
    fastest = _fastest_bound(study)
    is_stated = any(row.field == path for row in vary) or any(f"{path}{end}" in stated for end in ("_min", "_max"))
    if not is_stated and not _judged(study, varied(design, {path: fastest})).violations:
        raise KindynaError(_unbounded_text(path, fastest))
    steps: Steps = []

    def step(fields: Mapping[str, Any], goal: float, start: int) -> None:
        steps.append((start, goal))
        notify(len(steps))

    optimum = optimise(study, step, _starts(study.file))
    if optimum.is_feasible and not is_stated and abs(optimum.goals[path] - fastest) <= 1e-9 * abs(fastest):
        raise KindynaError(_unbounded_text(path, fastest))
    return _solution(study, optimum, steps)


def _unbounded_text(path: str, fastest: float) -> str:
    return (
        f"find {TOP_SPEED}: nothing bounds the speed up to {result_text(abs(fastest))} rpm; state a limit, as --limit "
        f"contact_force_n=5000 or --limit drive_torque_nm:abs=200, or the highest speed, --limit {path}_max=..."
    )


def _starts(file: StudyFile) -> int:
    """Starts of the search; fewer where it has many combinations of laws."""
    combinations = math.prod(len(row.choices) for row in file.vary if row.choices)
    return max(1, STARTS // combinations)


def _fastest_bound(study: StudyOfMany) -> float:
    """Bound of the speed in the direction of the goal."""
    goal = study.file.goals[0]
    row = next(row for row in study.file.vary if row.field == goal.field)
    end = row.low if goal.minimise else row.high
    assert end is not None, "a rule of the file"
    return end


def _judged(study: StudyOfMany, design: Design) -> Judgement:
    """Limits of a study that a design reaches, those that it violates, and its new findings; notes are none."""
    reached = _reached(study, design)
    violations = [
        f"{key} = {result_text(reached[key])}, {'most' if side > 0.0 else 'least'} {bound:g}"
        for key, side, bound in _bounds(study)
        if not side * reached[key] <= side * bound
    ]
    machine, also_set = with_flywheel(design, study.base)
    checked = FindingsCheck(study.base, waived=waived(study.file), notes=False)
    answer = {row.field: get(design, row.field) for row in study.file.vary} | dict(also_set)
    return Judgement(machine, answer, reached, tuple(violations) or checked.new(machine))


def _late(base: Design, design: Design) -> tuple[str, ...]:
    """Sequence conditions that a design violates, and the design of the study does not."""
    rows = zip(design.timing, distances(base), distances(design), strict=True)
    return tuple(f"{row.second} comes too early after {row.first}" for row, was, at in rows if was.kept and not at.kept)


def _bounds(study: StudyOfMany) -> Iterator[tuple[str, float, float]]:
    """Key, side and bound of the limits of figures."""
    return ((limit.key, side, bound) for limit, side, bound in bounds_of(study.file.limits))


def _reached(study: StudyOfMany, design: Design) -> dict[str, float]:
    """Figures that are limited; NaN where the design has none."""
    keys = [row.key for row in study.quantities]
    values = many(design, constant_column(design, 1), keys).value if keys else {}
    return {key: float(values[key][0]) for key in keys}


def _solution(study: StudyOfMany, optimum: Optimum, steps: Steps) -> Solution:
    """Solution of the search from its optimum and its steps."""
    path, base = study.file.goals[0].field, study.base
    judged = _judged(study, optimum.design)
    rows = {row.field: (row.low, row.high) for row in study.file.vary if not row.choices}
    words = {row.field: optimum.answer[row.field] for row in study.file.vary if row.choices}
    solution_fields = dict.fromkeys((path, *optimum.answer))
    curve = _curve(steps, optimum.goals[path])
    at_bound = next((row for row in optimum.binding if row.limit == path), None)

    def at(values: Mapping[str, float]) -> Judgement:
        candidate = varied(optimum.design, values)
        answer: dict[str, Any] = {field: words.get(field, values.get(field)) for field in solution_fields}
        if violations := (*out_of_bounds(values, rows), *_late(base, candidate)):
            return Judgement(candidate, answer, {}, violations)
        return _judged(study, candidate)._replace(answer=answer)

    return Solution(
        "top speed",
        optimum.design,
        answer={field: optimum.answer[field] for field in solution_fields},
        reached=_tightest_first(judged.reached, optimum),
        limits={key: bound for key, _, bound in _bounds(study)},
        curve=curve,
        curve_of=path,
        near=(1.0, float(len(curve))),
        curve_over="step of the search",
        present={field: get(base, field) for field in optimum.answer},
        before=_reached(study, base),
        violations=() if optimum.is_feasible else (judged.violations or (optimum.rejection or "no design",)),
        end="" if at_bound is None else f"{path} = {optimum.answer[path]:.9g}",
        digits=DIGITS,
        notes=FindingsCheck(base, waived=waived(study.file)).new(optimum.design) if optimum.is_feasible else (),
        next_findings=(optimum.rejection,) if optimum.rejection and optimum.is_feasible else (),
        applied=dict(optimum.also_set),
        complete=optimum.design,
        judge=Judge(tuple(rows), at),
        binding=tuple((row.limit, row.per_percent) for row in optimum.binding),
    )


def _tightest_first(reached: Mapping[str, float], optimum: Optimum) -> Mapping[str, float]:
    """Figures in the order in which their limits hold the speed, then the others."""
    order = [row.limit for row in optimum.binding]
    rank = {key: order.index(column) for key in reached if (column := key.replace(":", "_")) in order}
    return {key: reached[key] for key in sorted(reached, key=lambda key: rank.get(key, len(order)))}


def _curve(steps: Steps, speed: float) -> tuple[tuple[float, float], ...]:
    """Number of the step and speed after it, of the start that came nearest to a speed."""
    last = dict(steps)
    best = min(last, key=lambda start: abs(last[start] - speed), default=0)
    return tuple((float(i), goal) for i, goal in enumerate((goal for start, goal in steps if start == best), 1))
