"""The motion that does what is asked: sequence by sequence, fewest curves first."""

from __future__ import annotations

from core.blend.refusal import refusal, wrong_number
from core.blend.request import (
    Blended,
    BlendError,
    Request,
    answered,
    candidates,
    means_something,
    problem_of,
    require_sense,
    wishes_of,
)

MOST_BENT = 2  # acceleration and points that are solved for at once


def blend(request: Request) -> Blended:
    """The motion of fewest curves that does what is asked; where it can in several ways, the gentlest. Raises
    BlendError, which names what would be feasible."""
    require_sense(request)
    wishes = wishes_of(request)
    fitting = [c for c in candidates(request) if c.freedom == len(wishes) and means_something(c, wishes)]
    if not fitting:
        raise wrong_number(request)
    if sum(not w.linear for w in wishes) > MOST_BENT:
        raise BlendError(f"more than {MOST_BENT} of acceleration and points: give a height, speed or length instead")
    for candidate in fitting:
        solutions = problem_of(request, candidate, wishes).solutions()
        if solutions:
            return answered(request, candidate, solutions[0])
    raise refusal(request, fitting, wishes)
