"""Why a request is refused: one line that names the setting, what it may be and what to do."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context
from math import inf, isfinite

from core.blend.curve import SAME
from core.blend.curves import sequences
from core.blend.openings import dependent, determining, new_settings, openings
from core.blend.range import Range, hull
from core.blend.ranges import ranges_by
from core.blend.request import UNITS, BlendError, Candidate, Request, candidates, renamed, wish_of
from core.blend.wishes import POINT, SETTINGS, Wish, hardest_first


def refusal(request: Request, fitting: Sequence[Candidate], wishes: Sequence[Wish]) -> BlendError:
    """What to tell where no sequence does it: a setting that others determine; else the last to which the others leave
    something, one that is not linear before all others; else the first that is out of what those before it leave."""
    able = [c for c in fitting if not dependent(request, c, wishes)]
    told = None if able else _redundant(request, fitting, wishes)
    if told is not None:
        return told
    for wish in hardest_first(wishes) if able else ():
        others = [w for w in wishes if w is not wish]
        ranges = ranges_by(request, able, others, wish)
        if ranges:
            return _told(request, wish, ranges, others)
    ordered = sorted(wishes, key=lambda w: not w.linear)
    for i, wish in enumerate(ordered):
        ranges = ranges_by(request, fitting, ordered[:i], wish)
        value = _shown_value(request, wish)
        if ranges and not any(r.low <= value <= r.high for r in ranges):
            return _told(request, wish, ranges, ordered[:i])
    names = ", ".join(_named(request, w) for w in wishes)
    return BlendError(f"{names}: these settings leave no range; change one of them")


def _redundant(request: Request, fitting: Sequence[Candidate], wishes: Sequence[Wish]) -> BlendError | None:
    """The refusal of a wish that others determine, with its value, and what may be set instead; None where those others
    are not feasible themselves."""
    for candidate in fitting:
        for wish in hardest_first(wishes):
            others = [w for w in wishes if w is not wish]
            by = determining(request, candidate, wish, others)
            ranges = ranges_by(request, [candidate], by, wish) if by is not None else []
            if by is not None and ranges and all(_is_one(r.low, r.high) for r in ranges):
                name, unit = _name(request, wish), _unit(request, wish.name)
                cause = f" by {', '.join(_named(request, w) for w in by)}" if by else ""
                values = " or ".join(f"{r.low:.9g}" for r in ranges)
                text = f"{_named(request, wish)} {unit}: determined already{cause}: {name} = {values} {unit}"
                return BlendError(f"{text}; {_instead(request, candidate, others)}", name, hull(ranges))
    return None


def _instead(request: Request, candidate: Candidate, wishes: Sequence[Wish]) -> str:
    """``instead set h1 (0 < h1 < 15 mm), h3 or acceleration``: what says something new, and a range."""
    new = new_settings(request, candidate, wishes) if not dependent(request, candidate, wishes) else ()
    if not new:
        return "leave it out" if candidate.freedom < len(wishes) + 1 else "set another one"
    names = [_spelt(request, n) for n in new]
    ranges = ranges_by(request, [candidate], wishes, wish_of(request, new[0], 1.0))
    if ranges:
        text = " or ".join(range_text(r, names[0]) for r in ranges)
        names[0] = f"{names[0]} ({text} {_unit(request, new[0])})"
    return f"instead set {', '.join(names[:-1])} or {names[-1]}" if len(names) > 1 else f"instead set {names[0]}"


def _shown_value(request: Request, wish: Wish) -> float:
    return wish.value + request.start if wish.name == "peak" else wish.value


def _name(request: Request, wish: Wish) -> str:
    """The setting's name as the request spells it."""
    return next((asked for asked in request.settings if renamed(request, asked) == wish.name), wish.name)


def _named(request: Request, wish: Wish) -> str:
    """``point at 120 deg = 5``."""
    at = f" at {wish.at + request.start:.9g} deg" if wish.name == POINT else ""
    return f"{_name(request, wish)}{at} = {_shown_value(request, wish):.9g}"


def _spelt(request: Request, name: str) -> str:
    """As the request spells it: a return alone may count its curves from 1."""
    if any(renamed(request, asked) != asked for asked in request.settings):
        return next((n for n in ("h1", "h2", "h3", "vcv") if renamed(request, n) == name), name)
    return name


def _unit(request: Request, name: str) -> str:
    return UNITS.get(name, "{u}").format(u=request.unit)


def _told(request: Request, wish: Wish, ranges: Sequence[Range], beside: Sequence[Wish]) -> BlendError:
    """The refusal of a wish, with what it may be."""
    unit = _unit(request, wish.name)
    others = ", ".join(_named(request, w) for w in beside)
    tail = f" beside {others}" if others else ""
    name, allowed = _name(request, wish), hull(ranges)
    text = f"{_named(request, wish)} {unit} is not feasible{tail}"
    if _is_one(*allowed):
        text = f"{_named(request, wish)} {unit}: determined already{tail}: {allowed[0]:.9g} {unit}; set another one"
        return BlendError(text, name, allowed)
    told = " or ".join(range_text(r, name) for r in ranges)
    if any(_is_well_within(r, _shown_value(request, wish)) for r in ranges):
        text = f"{_named(request, wish)} {unit}: many motions have it{tail}: it leaves them undetermined"
        return BlendError(f"{text}; set another one, or one within {told} {unit}", name, allowed)
    return BlendError(f"{text}; feasible: {told} {unit}", name, allowed)


def _is_one(low: float, high: float) -> bool:
    """Whether there is but one value."""
    return isfinite(high) and high - low <= SAME * max(abs(low), abs(high))


def _is_well_within(found: Range, value: float) -> bool:
    room = SAME * (found.high - found.low) if isfinite(found.high) else SAME * abs(found.low)
    return found.low + room < value < found.high - room


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
    """How many settings each sequence takes and which of them are still open, or which sequences there are."""
    rows = candidates(request)
    if not rows:
        told = " | ".join(str(s) for s in sequences(request.type, request.constant))
        return BlendError(f"sequence {request.sequence!r}: not of this motion; allowed: {told}")
    counts = sorted({(c.freedom, f"{c.sequence}{' (mirrored)' if c.family.mirrored else ''}") for c in rows})
    wants = "; ".join(f"{name} takes {count} setting{'s' if count != 1 else ''}" for count, name in counts)
    given = ", ".join([*request.settings, *([POINT] * len(request.points))]) or "none"
    known = set().union(*(c.names for c in rows))
    strange = [name for name in request.settings if renamed(request, name) not in known]
    if strange:
        allowed = " | ".join(_spelt(request, name) for name in SETTINGS if name in known)
        text = f"settings given: {given}; {wants}; {', '.join(strange)}: of no curve here; allowed: {allowed}"
        return BlendError(text, strange[0])
    named = {name for opening in openings(request) for name in opening.settings}
    more = f"; still open: {', '.join(_spelt(request, n) for n in SETTINGS if n in named)}" if named else ""
    return BlendError(f"settings given: {given}; {wants}{more}; or ask for the best")
