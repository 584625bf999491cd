"""Which settings a request may still take, within which ranges, and which of its settings others determine."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import combinations
from typing import NamedTuple

import numpy as np

from core.blend.evaluator import Evaluator, Place
from core.blend.family import Family, Task
from core.blend.request import BlendError, Candidate, Request, candidates
from core.blend.settings import POINT, SETTINGS, Constraint, Range, merged
from core.numerics.cancellation import checkpoint

_DRAWN, _KEPT = 4000, 8  # points of which so many feasible ones are kept
_ZERO = 1e-9  # a direction shorter than this is none


# -- ranges -----------------------------------------------------------------------------------------------


def feasible_ranges(request: Request, setting: str, at: float = 0.0) -> list[Range]:
    """What a setting may be while the others stay, as the request spells it; empty where they leave nothing.

    The setting need not be among the request's own: its value does not matter. A ``point`` lies at a cam angle ``at``.
    Where the request with the setting is complete for a sequence, the ranges are those of such sequences; else what is
    still to come is free. One that the others determine has one value. Raises BlendError for a request without sense.
    """
    request.require_sense()
    if setting not in (*SETTINGS, POINT):
        raise BlendError(f"{setting}: unknown setting; allowed: {' | '.join(SETTINGS)}")
    mine = request.constraint(setting, 1.0, at)
    others = [c for c in request.constraints if (c.name, c.at) != (mine.name, mine.at)]
    able = [c for c in candidates(request) if c.takes([*others, mine])]
    complete = [c for c in able if c.freedom == len(others) + 1]
    return ranges_by(request, complete or able, others, mine)


def ranges_by(request: Request, rows: Iterable[Candidate], others: Sequence[Constraint], mine: Constraint) -> list[Range]:
    """What a setting may be beside other constraints by any of the candidates."""
    found = []
    for candidate in rows:
        checkpoint()
        ranges = candidate.problem(request, [*others, mine]).ranges(len(others))
        found += [_shown(r, request, candidate) for r in ranges] if mine.name == "peak" else ranges
    return merged(found)


def _shown(found: Range, request: Request, candidate: Candidate) -> Range:
    """A range of the peak as cam angles."""
    if candidate.backwards:
        return Range(request.end - found.high, request.end - found.low, found.high_open, found.low_open)
    return Range(request.start + found.low, request.start + found.high, found.low_open, found.high_open)


# -- which settings are new -------------------------------------------------------------------------------


class Opening(NamedTuple):
    """How many settings a sequence still takes, and which say something new."""

    missing: int
    settings: tuple[str, ...]


def openings(request: Request) -> list[Opening]:
    """The sequences that take the settings of a request, fewest curves first; none that these settings overfill, or whose
    curves lack one of them, or in which one of them follows from the others. Of a return alone the settings are counted
    from h4 and vcv2. Raises BlendError for a request without sense."""
    request.require_sense()
    given = request.constraints
    found = []
    for candidate in candidates(request):
        if candidate.takes(given) and not dependent(request, candidate, given):
            missing = candidate.freedom - len(given)
            found.append(Opening(missing, new_settings(request, candidate, given) if missing else ()))
    return found


def dependent(request: Request, candidate: Candidate, constraints: Sequence[Constraint]) -> bool:
    """Whether one of the constraints follows from the others, whatever their values."""
    return _rank(request, candidate, constraints) < len(constraints)


def determining(
    request: Request, candidate: Candidate, mine: Constraint, others: Sequence[Constraint]
) -> tuple[Constraint, ...] | None:
    """The fewest of the others that determine a setting; None where it says something new beside all of them."""
    for count in range(len(others) + 1):
        for few in combinations(others, count):
            if not dependent(request, candidate, few) and dependent(request, candidate, [*few, mine]):
                return few
    return None


def new_settings(request: Request, candidate: Candidate, constraints: Sequence[Constraint]) -> tuple[str, ...]:
    """Settings that the constraints do not determine, as the request may spell them."""
    given = {c.name for c in constraints}
    able = [n for n in SETTINGS if n in candidate.names - given and request.renamed(n) == n]
    return tuple(n for n in able if not dependent(request, candidate, [*constraints, Constraint(n, 1.0)]))


def _rank(request: Request, candidate: Candidate, constraints: Sequence[Constraint]) -> int:
    """How many of the constraints say something new: the greatest number of independent directions at any point."""
    if not constraints or not candidate.freedom:
        return 0
    problem = candidate.problem(request, constraints)
    strokes = problem.task.back / problem.task.rise
    rows = np.array([_directions(problem.family, strokes, c.name, c.at) for c in problem.constraints])
    return max(int(np.sum(np.linalg.svd(rows[:, i], compute_uv=False) > _ZERO)) for i in range(rows.shape[1]))


@lru_cache(maxsize=1024)
def _directions(family: Family, strokes: float, name: str, at: float) -> np.ndarray:
    """In which direction a setting grows, at some points (points, free numbers): of length 1, or 0."""
    evaluator = Evaluator(family, Task(1.0, strokes, 1.0))
    t, *x = np.array([(t, *x) for t, x in _points(family, strokes)]).T
    found = evaluator.setting(Constraint(name, 1.0, at), evaluator.forms(t, np.array(x).reshape(-1, t.size), slopes=True))
    slopes = (found[1:] * np.abs([t, *x])).T
    sizes = np.linalg.norm(slopes, axis=1, keepdims=True)
    grows = sizes > _ZERO * np.abs(found[0])[:, None]
    return np.where(grows, slopes / np.where(grows, sizes, 1.0), 0.0)


@lru_cache(maxsize=256)
def _points(family: Family, strokes: float) -> list[Place]:
    """Some feasible points, always the same."""
    evaluator = Evaluator(family, Task(1.0, strokes, 1.0))
    chance = np.random.default_rng(1995)
    t = chance.random(_DRAWN)
    t = np.sqrt(strokes) * t / (1.0 - t) if evaluator.equations.top == np.inf else t
    x = chance.random((len(evaluator.equations.numbers), _DRAWN)) * np.array(evaluator.equations.tops)[:, None]
    found: list[Place] = []
    for place in zip(t.tolist(), map(tuple, x.T.tolist()), strict=True):
        if evaluator.is_feasible(place):
            found.append(place)
            if len(found) == _KEPT:
                break
    return found
