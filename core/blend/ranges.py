"""What would be feasible: the ranges of a setting, and the one line that names them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context
from math import inf, isfinite

from core.blend.curves import sequences
from core.blend.request import (
    UNITS,
    BlendError,
    Candidate,
    Request,
    candidates,
    means_something,
    problem_of,
    renamed,
    require_sense,
    wish_of,
    wishes_of,
)
from core.blend.solver import SAME, Range, merged
from core.blend.wishes import POINT, Wish, hardest_first


def feasible_ranges(request: Request, setting: str, at: float = 0.0) -> list[Range]:
    """What a setting may be while the others stay, as the request spells it; empty where they leave nothing.

    The setting need not be among the request's own: its value does not matter. ``point`` is asked for a cam angle
    ``at``. With settings still to come, these are free.
    """
    require_sense(request)
    wish = wish_of(request, setting, 1.0, at)
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


def _shown(found: Range, request: Request, candidate: Candidate, wish: Wish) -> Range:
    """A range of a family with the angles of the request."""
    if wish.name != "peak":
        return found
    if candidate.backwards:
        end = request.end
        return Range(end - found.high, end - found.low, found.high_open, found.low_open)
    return Range(request.start + found.low, request.start + found.high, found.low_open, found.high_open)


def refusal(request: Request, fitting: Sequence[Candidate], wishes: Sequence[Wish]) -> BlendError:
    """What to tell: the last wish to which the others leave something, one that is not linear before all others; else
    the first that is out of all bounds that those before it leave."""
    for wish in hardest_first(wishes):
        ranges = _ranges(request, fitting, wishes, wish)
        if ranges:
            return _told(request, wish, ranges, [w for w in wishes if w is not wish])
    ordered = sorted(wishes, key=lambda w: not w.linear)
    for i, wish in enumerate(ordered):
        ranges = _bounds(request, fitting, wish, ordered[:i])
        value = _shown_value(request, wish)
        if ranges and not any(r.low < value < r.high for r in ranges):
            return _told(request, wish, ranges, ordered[:i])
    names = ", ".join(_named(request, w) for w in wishes)
    return BlendError(f"{names}: these settings leave no range; change one of them")


def _shown_value(request: Request, wish: Wish) -> float:
    return wish.value + request.start if wish.name == "peak" else wish.value


def _name(request: Request, wish: Wish) -> str:
    """The setting's name as the request spells it."""
    return next((asked for asked in request.settings if renamed(request, asked) == wish.name), wish.name)


def _named(request: Request, wish: Wish) -> str:
    """``point at 120 deg = 5``."""
    at = f" at {wish.at + request.start:.9g} deg" if wish.name == POINT else ""
    return f"{_name(request, wish)}{at} = {_shown_value(request, wish):.9g}"


def _told(request: Request, wish: Wish, ranges: Sequence[Range], beside: Sequence[Wish]) -> BlendError:
    """The refusal of a wish, with what it may be."""
    unit = UNITS.get(wish.name, "{u}").format(u=request.unit)
    others = ", ".join(_named(request, w) for w in beside)
    tail = f" beside {others}" if others else ""
    name, allowed = _name(request, wish), (ranges[0].low, ranges[-1].high)
    text = f"{_named(request, wish)} {unit} is not feasible{tail}"
    if isfinite(allowed[1]) and allowed[1] - allowed[0] <= SAME * max(map(abs, allowed)):
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


def wrong_number(request: Request) -> BlendError:
    """How many settings each sequence takes, or which sequences there are."""
    rows = candidates(request)
    if not rows:
        known = " | ".join(str(s) for s in sequences(request.type, request.constant))
        return BlendError(f"sequence {request.sequence!r}: not of this motion; allowed: {known}")
    counts = sorted({(c.freedom, str(c.sequence)) for c in rows})
    wants = "; ".join(f"{name} takes {count} setting{'s' if count != 1 else ''}" for count, name in counts)
    given = ", ".join([*request.settings, *([POINT] * len(request.points))]) or "none"
    return BlendError(f"settings given: {given}; {wants}; or ask for the best")
