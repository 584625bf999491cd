"""Which settings say something new: what a request may still take, and which of its settings others determine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

import numpy as np

from core.blend.family import Family, Task
from core.blend.metering import Meter
from core.blend.request import (
    Candidate,
    Request,
    candidates,
    means_something,
    problem_of,
    renamed,
    require_sense,
    wishes_of,
)
from core.blend.wishes import POINT, SETTINGS, Wish

_DRAWN, _KEPT = 4000, 8  # points of which so many feasible ones are kept
_ZERO = 1e-9  # a direction shorter than this is none


@dataclass(frozen=True)
class Opening:
    """A sequence that a request may become: how many settings it still takes, and which of them say something new.

    mirrored: with the return as the rise run backwards
    """

    sequence: str
    mirrored: bool
    missing: int
    settings: tuple[str, ...]


def openings(request: Request) -> list[Opening]:
    """The sequences that take the settings of a request, fewest curves first; none that these settings overfill, or of
    whose curves they do not speak, or in which one of them follows from the others. Raises BlendError for a request
    without sense."""
    require_sense(request)
    wishes = wishes_of(request)
    found = []
    for candidate in candidates(request):
        missing = candidate.freedom - len(wishes)
        if missing < 0 or not means_something(candidate, wishes) or dependent(request, candidate, wishes):
            continue
        new = new_settings(request, candidate, wishes) if missing else ()
        found.append(Opening(str(candidate.sequence), candidate.family.mirrored, missing, new))
    return found


def open_settings(request: Request) -> tuple[str, ...]:
    """Names of the settings that may be added to a request, in the order of ``SETTINGS``; of which each sequence of
    ``openings`` takes some. Of a return alone they are counted from h4 and vcv2."""
    named = {name for opening in openings(request) for name in opening.settings}
    return tuple(name for name in SETTINGS if name in named)


def missing_settings(request: Request) -> tuple[int, ...]:
    """How many settings a request still wants, by the sequence that is meant: (0,) for one that is complete, (1, 2) where
    one setting more gives the shortest sequence and two give another; empty where no sequence takes them."""
    return tuple(sorted({opening.missing for opening in openings(request)}))


def freedoms(request: Request) -> list[tuple[str, int]]:
    """How many settings each sequence of a request takes in all."""
    require_sense(request)
    return [(str(c.sequence), c.freedom) for c in candidates(request)]


# -- what follows from what -------------------------------------------------------------------------------


def dependent(request: Request, candidate: Candidate, wishes: Sequence[Wish]) -> bool:
    """Whether one of the wishes follows from the others, whatever their values."""
    return _rank(request, candidate, wishes) < len(wishes)


def determining(request: Request, candidate: Candidate, wish: Wish, others: Sequence[Wish]) -> tuple[Wish, ...] | None:
    """The fewest of the others that determine a wish; None where it says something new beside all of them."""
    for count in range(len(others) + 1):
        for few in combinations(others, count):
            if not dependent(request, candidate, few) and dependent(request, candidate, [*few, wish]):
                return few
    return None


def new_settings(request: Request, candidate: Candidate, wishes: Sequence[Wish]) -> tuple[str, ...]:
    """Settings that the wishes do not determine, as the request may spell them."""
    given = {w.name for w in wishes}
    able = [n for n in SETTINGS if n not in given and renamed(request, n) == n]
    added = ((n, Wish(n, 1.0)) for n in able)
    return tuple(
        n for n, w in added if means_something(candidate, [w]) and not dependent(request, candidate, [*wishes, w])
    )


def _rank(request: Request, candidate: Candidate, wishes: Sequence[Wish]) -> int:
    """How many of the wishes say something new: the greatest number of independent directions at any point."""
    if not wishes or not candidate.freedom:
        return 0
    problem = problem_of(request, candidate, wishes)
    family, ratio = problem.family, problem.task.back / problem.task.rise
    rows = np.array([_directions(family, ratio, w.name, w.at) for w in problem.wishes])
    return max(int(np.sum(np.linalg.svd(rows[:, i], compute_uv=False) > _ZERO)) for i in range(rows.shape[1]))


@lru_cache(maxsize=1024)
def _directions(family: Family, ratio: float, name: str, at: float) -> np.ndarray:
    """In which direction a setting grows, at some points (points, free numbers): of length 1, or 0."""
    meter = Meter(family, Task(1.0, ratio, 1.0))
    rows = []
    for t, *x in _points(family, ratio):
        value, slope = meter.measure(Wish(name, 1.0, at if name == POINT else 0.0), t, x)
        slope = slope * np.abs([t, *x])
        size = float(np.linalg.norm(slope))
        rows.append(slope / size if size > _ZERO * abs(value) else np.zeros_like(slope))
    return np.array(rows)


@lru_cache(maxsize=256)
def _points(family: Family, ratio: float) -> tuple[tuple[float, ...], ...]:
    """Some feasible points, always the same."""
    meter = Meter(family, Task(1.0, ratio, 1.0))
    chance = np.random.default_rng(1995)
    t = chance.random(_DRAWN)
    t = np.sqrt(ratio) * t / (1.0 - t) if meter.equations.top == np.inf else t
    x = chance.random((len(meter.equations.numbers), _DRAWN)) * np.array(meter.equations.tops)[:, None]
    good = np.flatnonzero(meter.feasible(t, x))[:_KEPT]
    return tuple((float(t[i]), *(float(v) for v in x[:, i])) for i in good)
