"""What a setting of a request may be."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from core.blend.range import Range, hull, merged
from core.blend.request import (
    BlendError,
    Candidate,
    Request,
    candidates,
    means_something,
    problem_of,
    require_sense,
    wish_of,
    wishes_of,
)
from core.blend.wishes import POINT, SETTINGS, Wish
from core.cancellation import checkpoint


def feasible_ranges(request: Request, setting: str, at: float = 0.0) -> list[Range]:
    """What a setting may be while the others stay, as the request spells it; empty where they leave nothing.

    The setting need not be among the request's own: its value does not matter. ``point`` is asked for a cam angle ``at``.
    Where the request with the setting is complete for a sequence, the ranges are those of such sequences; else what is
    still to come is free. One that the others determine has one value. Raises BlendError for a request without sense.
    """
    require_sense(request)
    if setting not in (*SETTINGS, POINT):
        raise BlendError(f"{setting}: unknown setting; allowed: {' | '.join(SETTINGS)}")
    wish = wish_of(request, setting, 1.0, at)
    others = [w for w in wishes_of(request) if (w.name, w.at) != (wish.name, wish.at)]
    wishes = [*others, wish]
    able = [c for c in candidates(request) if c.freedom >= len(wishes) and means_something(c, wishes)]
    exact = [c for c in able if c.freedom == len(wishes)]
    return ranges_by(request, exact or able, others, wish)


def feasible_range(request: Request, setting: str, at: float = 0.0) -> tuple[float, float] | None:
    """The ends of all of these; None where there are none."""
    found = feasible_ranges(request, setting, at)
    return hull(found) if found else None


def ranges_by(request: Request, rows: Iterable[Candidate], others: Sequence[Wish], wish: Wish) -> list[Range]:
    """What a wish may be beside others by any of the candidates."""
    found = []
    for candidate in rows:
        checkpoint()
        problem = problem_of(request, candidate, [*others, wish])
        found += [_shown(r, request, candidate, wish) for r in problem.ranges(len(others))]
    return merged(found)


def _shown(found: Range, request: Request, candidate: Candidate, wish: Wish) -> Range:
    """A range of a family with the angles of the request."""
    if wish.name != "peak":
        return found
    if candidate.backwards:
        end = request.end
        return Range(end - found.high, end - found.low, found.high_open, found.low_open)
    return Range(request.start + found.low, request.start + found.high, found.low_open, found.high_open)
