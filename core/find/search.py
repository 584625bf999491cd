"""The answer to a search: a bracketed root of what is left of the limits, or an optimum that is checked on both sides."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import field, replace
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import Design, get
from core.errors import KindynaError, NoSolution
from core.find.goals import (
    ENDS,
    LARGEST,
    LEAST_PRESSURE,
    NARROWEST,
    SMALLEST,
    WANTED,
    Box,
    LimitReading,
    SearchRow,
    bounded,
    has,
)
from core.find.offer import Request, Stated, request
from core.find.trial import NEEDED, FindingsCheck, Outcome, Put, Trials, alone, nearest
from core.findings import ERROR
from core.frozen import frozen
from core.motion.extremes import find_extremes
from core.numerics.roots import EPS, BracketEnds, bounded_minimum, bracketed_root
from core.study import Study, findings_of
from core.study.limits import ANY_PRESSURE, CONVEX, LIMITS

NEARER = 1e-3  # of the distance between two values tried: how near samples take an answer before it is refined
BEST = 1e-5  # the same of the best where nothing serves
FINEST = 1e-9  # the same, to which an optimum is refined
LAST = 1e-13  # of the value, to which a root is
BESIDE = 1e-4  # of the distance between two values tried: where an optimum is checked
EXCLUDED = 1e3  # [deg] more than any pressure angle: of what does not keep its limits
AT_LIMIT = 1e-6  # margin below which a limit holds the answer
SAME = 1e-9  # [deg] pressure angles that do not differ
ALIKE = 1e-5  # the same, of samples
ROOT_DIGITS, OPTIMUM_DIGITS = 9, 6  # the place of a flat minimum has half the digits of what is least there
BEST_DIGITS = 4  # of what is the best where nothing serves, found with samples
CLOSE = 17  # values of the curve beside the answer
BEYOND, LEAST_BEYOND = 0.5, 0.3  # how far it goes on: of the distance to the present value, of the answer at least
OPEN_PRESSURE = 90.0  # [deg] no limit

At = Callable[[float], Outcome]
"""A value -> what it reaches."""


_EMPTY: Mapping[str, Any] = MappingProxyType({})


@frozen
class Solution:
    """What was found.

    design    with the answer; with what it names in ``taken`` in place of that
    answer    path -> value as in the file
    reached   limit -> value there, in its unit; infinite where there is no such figure
    limits    limit -> what it must keep
    curve     value of the first field, what is reached with it: of ``curve_of``
    near      the values of the first field around the answer and the present one, in which the curve is close
    present   path -> value in the design before; None where it has none
    before    limit, of all that there are -> value reached there; empty where there is no cam with the present values
    against   what stands against it; empty where the answer serves
    end       bound that the answer stands at, where no limit holds it; empty else
    digits    significant digits of the answer that are certain
    reasons   limit -> why that is its value, of those that nobody stated
    held_by   what the next value would be complained of that is none of the limits
    besides   notes that come with the answer, where none does without
    taken     path -> value that goes into the machine besides: a speed below an answer that is a fact, the flywheel that it takes now
    whole     the machine with all that; None: the design is all of it
    assumed   path -> value of what the answer rests on and nobody gave
    """

    wanted: str
    design: Design
    answer: Mapping[str, float]
    reached: Mapping[str, float]
    limits: Mapping[str, float]
    curve: tuple[tuple[float, float], ...]
    curve_of: str
    near: tuple[float, float]
    present: Mapping[str, float | None]
    before: Mapping[str, float]
    against: tuple[str, ...] = ()
    end: str = ""
    digits: int = ROOT_DIGITS
    reasons: Mapping[str, str] = field(default_factory=lambda: _EMPTY)
    held_by: tuple[str, ...] = ()
    besides: tuple[str, ...] = ()
    taken: Mapping[str, float] = field(default_factory=lambda: _EMPTY)
    whole: Design | None = None
    assumed: Mapping[str, float] = field(default_factory=lambda: _EMPTY)

    @property
    def serves(self) -> bool:
        """Whether nothing speaks against the answer."""
        return not self.against

    @property
    def machine(self) -> Design:
        """With the answer."""
        return self.design if self.whole is None else self.whole

    @property
    def errors(self) -> tuple[str, ...]:
        """What no limit of the search says and is wrong all the same with the cam of the answer, as it was before: its hub, its cutter."""
        if not self.serves or all(drive.cam is None for drive in self.design.drives):
            return ()
        found = findings_of(Study(self.design), ("cam",))
        return tuple(finding.message for finding in found if finding.severity == ERROR)


def sought(
    search: Callable[[FindingsCheck], Solution], design: Design, machine: Put, waived: Collection[str]
) -> Solution:
    """What a search finds that adds nothing to what ``check`` finds in the machine; where notes stand against everything, with these."""
    checked = FindingsCheck(design, machine, waived)
    found = search(checked)
    if found.serves or not checked.noted:
        return found
    found = search(FindingsCheck(design, machine, waived, notes=False))
    return replace(found, besides=checked.new(found.design)) if found.serves else found


def find(
    design: Design,
    what: str,
    stated: Stated,
    *,
    place: str = "",
    machine: Put = alone,
    tell: Callable[[int], object] = lambda count: None,
) -> Solution:
    """The value of a row of ``WANTED`` under the limits stated, and under the design's own and the usual ones where none is (``request``).
    The cam is not undercut in any case, and ``check`` finds nothing in the machine that it does not find now. Where no value serves: the
    best that there is, and what stands against it.

    stated: key of a limit, or path of a field with _min or _max -> value; None: that one does not hold. place: of the fields of which one
    is varied. machine: the design -> the whole that it belongs to. tell: called with how many designs were evaluated, after each. Raises
    KindynaError where there is no such thing to seek, no such limit, or no value at all with which there is a cam.
    """
    if what not in WANTED:
        raise KindynaError(f"find {what!r}: unknown; allowed: {' | '.join(WANTED)}")
    row = WANTED[what]
    if design.drive.cam is None:
        raise KindynaError(f"find {what}: this design has no cam; allowed: one with [cam]")
    wish = request(design, what, stated, place)
    paths = row.fields(design, wish.bounds)
    _require(design, what, paths, wish.bounds)
    if row.wanted == NARROWEST:
        return _narrowest_face(design, paths, wish.bounds)
    study = Study(design)
    for key in stated:
        if key in wish.limits and (lacking := LIMITS[key].missing(study)):
            raise KindynaError(f"limit {key}: this design has no such figure yet; give it {lacking}")
    wish.limits.setdefault(CONVEX, 0.0)
    solver = _SOLVERS[len(paths), row.wanted]

    def search(checked: FindingsCheck) -> Solution:
        return solver(row, Trials(design, paths, wish.limits, tell, wish.contact, checked, row.put), wish)

    try:
        return sought(search, design, machine, wish.waived)
    except KindynaError as error:
        _require_cam(design, what, error)
        raise


# -- what is asked -----------------------------------------------------------------------------------------


def _require_cam(design: Design, what: str, cause: KindynaError) -> None:
    """Where nothing serves because the design has no cam as it stands, says why it has none."""
    try:
        _ = Study(design).cam
    except NoSolution as error:
        problem = f"find {what} gives none, for it cannot be assembled as it stands: {error.problem}"
        raise type(error)(problem, error.field, error.hint, error.cam_angles) from cause


def _require(design: Design, what: str, paths: tuple[str, ...], box: Box) -> None:
    """The design has the fields; bounds are those of the fields, and in order."""
    if missing := [path for path in paths if not has(design, path)]:
        raise KindynaError(f"find {what}: this design has no {', '.join(missing)}")
    for path, (low, high) in box.items():
        if path not in paths:
            raise KindynaError(f"limit of {path}: {what} does not vary it; it varies {', '.join(paths)}")
        if low is not None and high is not None and low >= high:
            raise KindynaError(f"limit {path}_min = {low:g}: is not below {path}_max = {high:g}")


# -- smallest, largest -------------------------------------------------------------------------------------


def _outermost(row: SearchRow, trials: Trials, wish: Request) -> Solution:
    """The smallest or the largest value that keeps every limit: the outermost side of those that do is bracketed by a scan, then
    the root of the least margin is refined. Where something new is to be complained of there, the next value with which nothing is."""
    path = trials.paths[0]
    low, high = wish.bounds.get(path, (None, None))
    values = bounded(row.values(trials.design, path), low, high)
    order = values if row.wanted == SMALLEST else values[::-1]
    trials.scan((x,) for x in order.tolist())
    sampled = np.array([_or_least(trials.at(x, refined=False).margin) for x in order.tolist()])
    first = next((i for i in np.flatnonzero(sampled >= 0.0).tolist() if trials.at(float(order[i])).kept), None)
    if first is None:
        best = _best(trials, values)
        if not trials.at(best).kept:
            return _solved(row, trials, (best,), values)
        first = int(np.searchsorted(values, best))  # between two values tried
        first = first if row.wanted == SMALLEST else values.size - first
        order = np.insert(order, first, best)
    end = ""
    found = float(order[first])
    if first:
        found = _kept_side(trials, float(order[first - 1]), found)
        beyond_it = trials.at(float(order[first - 1])).problem if trials.at(found).margin > AT_LIMIT else ""
        end = f"{path} = {found:.9g} (beyond it: {beyond_it})" if beyond_it else ""
    else:
        bound = low if row.wanted == SMALLEST else high
        usual = wish.at_bound.get(f"{path}{ENDS[0] if row.wanted == SMALLEST else ENDS[1]}")
        why = f" ({usual.reason})" if usual else "" if bound is not None else ", the last value tried"
        end = f"{path} = {found:.9g}{why}"
    if new := trials.new(found):
        present = float(get(trials.design, path))
        tried = (present,) if trials.checked.noted else (present, *order[first:].tolist())
        good = next((x for x in tried if (x - found) * (order[-1] - found) > 0.0 and trials.serves(x)), None)
        if good is None:
            return _solved(row, trials, (found,), values, against=new)
        found, beyond = nearest(lambda x, quick: trials.serves(x, quick=quick), found, good, trials.checked.part)
        return _solved(row, trials, (found,), values, held_by=trials.new(beyond))
    return _solved(row, trials, (found,), values, end)


def _or_least(margin: float) -> float:
    return margin if margin == margin else -np.inf


def _kept_side(trials: Trials, bad: float, good: float) -> float:
    """The value next to where the least margin passes 0, on its good side: with samples first, then with what is refined."""

    def margin(x: float, refined: bool) -> float:
        return trials.at(x, refined=refined).margin

    sampled = partial(margin, refined=False)
    near = bracketed_root(sampled, BracketEnds(bad, sampled(bad), good, sampled(good)), NEARER * abs(good - bad)).b
    bad = _towards(bad, near, lambda x: not margin(x, True) > 0.0)
    beyond = _towards(good, near, lambda x: margin(x, True) > 0.0)
    root = bracketed_root(
        partial(margin, refined=True),
        BracketEnds(bad, margin(bad, True), beyond, margin(beyond, True)),
        LAST * abs(beyond),
    )
    found, step = root.b, np.copysign(EPS * abs(root.b), good - root.a)
    while not trials.at(found).kept and (good - found) * step > 0.0:
        found, step = found + step, 2.0 * step
    return float(found)


def _towards(end: float, near: float, fits: Callable[[float], bool]) -> float:
    """The first value that fits, from near towards the end in growing steps; the end where none does before it."""
    step = (end - near) * NEARER
    while not fits(near) and abs(end - near) > abs(step):
        near, step = near + step, 4.0 * step
    return near if fits(near) else end


def _best(trials: Trials, values: np.ndarray) -> float:
    """The value with the greatest least margin, where none is positive. Raises KindynaError where there is no cam with any."""
    margins = np.array([_or_least(trials.at(x, refined=False).margin) for x in values.tolist()])
    if not (margins > -np.inf).any():
        problem = trials.at(float(values[-1])).problem
        raise KindynaError(f"no value of {trials.paths[0]} from {values[0]:.6g} to {values[-1]:.6g} serves: {problem}")
    top = int(np.argmax(margins))
    low, high = values[max(top - 1, 0)], values[min(top + 1, values.size - 1)]
    finest = BEST * float(high - low)
    best, _ = bounded_minimum(lambda x: -_or_least(trials.at(x, refined=False).margin), float(low), float(high), finest)
    return max((best, float(values[top])), key=lambda x: _or_least(trials.at(x).margin))


# -- least pressure angle ----------------------------------------------------------------------------------


def _merit(outcome: Outcome) -> float:
    """The greatest pressure angle [deg]; more than any where a limit is exceeded, by how much; infinite without a cam."""
    if not outcome.readings:
        return np.inf
    return outcome.pressures[-1] if outcome.kept else EXCLUDED * (1.0 - outcome.margin)


def _least_pressure(row: SearchRow, trials: Trials, wish: Request) -> Solution:
    path = trials.paths[0]
    values = bounded(row.values(trials.design, path), *wish.bounds.get(path, (None, None)))
    at = trials.at
    trials.scan((x,) for x in values.tolist())
    merits = np.array([_merit(at(x, refined=False)) for x in values.tolist()])
    _require_effect(trials, merits)
    if not (merits < EXCLUDED).any():
        return _solved(row, trials, (_best(trials, values),), values)
    top = int(np.argmin(merits))
    around = float(values[max(top - 1, 0)]), float(values[min(top + 1, values.size - 1)])
    found = _or_zero(optimum(partial(at, refined=True), partial(at, refined=False), *around), around[1] - around[0])
    return _solved_nearby(row, trials, (found,), [(x,) for x in values.tolist()], values, _end_of(path, found, values))


def _solved_nearby(
    row: SearchRow,
    trials: Trials,
    found: tuple[float, ...],
    tried: Sequence[tuple[float, ...]],
    values: np.ndarray,
    end: str,
) -> Solution:
    """An optimum; where something new is to be complained of there, the point next to it with which nothing is, on the way to the present
    values, else to the best of those tried."""
    new = trials.new(*found)
    if not new or not trials.at(*found).kept:
        return _solved(row, trials, found, values, end)
    present = tuple(float(get(trials.design, path)) for path in trials.paths)
    others = [] if trials.checked.noted else sorted(tried, key=lambda each: _merit(trials.at(*each, refined=False)))
    good = next(
        (each for each in (present, *others) if _merit(trials.at(*each)) < EXCLUDED and trials.serves(*each)), None
    )
    if good is None:
        return _solved(row, trials, found, values, end, against=new)

    def between(part: float) -> tuple[float, ...]:
        return tuple(a + part * (b - a) for a, b in zip(found, good, strict=True)) if part < 1.0 else good

    part, beyond = nearest(
        lambda part, quick: trials.serves(*between(part), quick=quick), 0.0, 1.0, trials.checked.part
    )
    return _solved(row, trials, between(part), values, held_by=trials.new(*between(beyond)))


def _require_effect(trials: Trials, merits: np.ndarray) -> None:
    serving = merits[merits < EXCLUDED]
    if serving.size > 1 and np.ptp(serving) < SAME:
        raise KindynaError(
            f"the pressure angle of a {trials.design.drive.face.noun} does not depend on {', '.join(trials.paths)}"
        )


def _end_of(path: str, found: float, values: np.ndarray) -> str:
    return f"{path} = {found:.9g}" if found in (values[0], values[-1]) else ""


def _or_zero(value: float, size: float) -> float:
    """0 for what rounding leaves of it."""
    return 0.0 if abs(value) < FINEST * size else value


def optimum(at: At, rough: At, first: float, last: float) -> float:
    """Where the greatest pressure angle is least, of the values from first to last that keep every limit.

    There it is flat, or two stretches of the motion have the same one, or a limit is reached, or the values end: each is looked for
    in what rough outcomes leave of the bracket, and the best of them is checked on both sides.
    """
    width = last - first

    def merit(x: float) -> float:
        return _merit(at(x))

    near, least = bounded_minimum(lambda x: _merit(rough(x)), first, last, NEARER * width)
    near = min((x for x in (first, last) if _merit(rough(x)) <= least), key=lambda x: _merit(rough(x)), default=near)
    low, near = _downhill(merit, near, first, 2.0 * NEARER * width)
    high, near = _downhill(merit, near, last, 2.0 * NEARER * width)
    found = min((near, low, high, *_corners(at, low, near, high)), key=merit)
    beside = [x for x in (found - BESIDE * width, found + BESIDE * width) if first <= x <= last]
    if low < found < high and (found == near or any(merit(x) < merit(found) for x in beside)):
        flat, _ = bounded_minimum(merit, low, high, FINEST * width)
        found = min((found, flat), key=merit)
    return found


def _downhill(merit: Callable[[float], float], near: float, end: float, step: float) -> tuple[float, float]:
    """From near towards the end in growing steps as long as it goes down: the first value that is no better, or the end, and the best
    one before it."""
    low = near
    while low != end:
        low = max(low - step, end) if end < near else min(low + step, end)
        if merit(low) >= merit(near):
            break
        near, step = low, 2.0 * step
    return low, near


def _corners(at: At, low: float, near: float, high: float) -> list[float]:
    """Where between three values rise and return come to the same pressure angle, or a limit is reached."""
    found = []

    def apart(x: float) -> float:
        outcome = at(x)
        return outcome.pressures[0] - outcome.pressures[1] if outcome.pressures else np.nan

    def left(x: float) -> float:
        return at(x).margin

    for a, b in ((low, near), (high, near)):
        if a == b:
            continue
        if at(a).kept != at(b).kept:
            good, bad = (a, b) if at(a).kept else (b, a)
            root = bracketed_root(left, BracketEnds(bad, left(bad), good, left(good)), LAST * abs(good - bad))
            found.append(root.b)
        elif apart(a) * apart(b) < 0.0:
            root = bracketed_root(apart, BracketEnds(a, apart(a), b, apart(b)), LAST * max(abs(a), abs(b)))
            found += [root.a, root.b]
    return found


def _least_pressure_of_two(row: SearchRow, trials: Trials, wish: Request) -> Solution:
    """The same of two fields: for each value of the second the first is the best that there is."""
    first, second = (
        bounded(row.values(trials.design, path), *wish.bounds.get(path, (None, None)), (9,)) for path in trials.paths
    )
    tried = [(x, y) for x in first.tolist() for y in second.tolist()]
    trials.scan(tried)
    merits = np.array([_merit(trials.at(*each, refined=False)) for each in tried]).reshape(first.size, -1).T
    _require_effect(trials, merits)
    if not np.isfinite(merits).any():
        raise KindynaError(f"no pivot in the box serves: {trials.at(float(first[0]), float(second[0])).problem}")

    def best_at(y: float, refined: bool, low: float, high: float) -> float:
        exact, rough = (partial(lambda x, how: trials.at(x, y, refined=how), how=how) for how in (refined, False))
        return optimum(exact, rough, low, high)

    def along(y: float, refined: bool) -> tuple[float, float]:
        """The best first value there, and what it reaches."""
        x = best_at(y, refined, *_room(first, line[-1], refined))
        line.append(x)
        return _merit(trials.at(x, y, refined=refined)), x

    j, i = divmod(int(np.argmin(merits)), first.size)
    line = [float(first[i])]
    low, high = float(second[max(j - 1, 0)]), float(second[min(j + 1, second.size - 1)])
    y, least = bounded_minimum(lambda y: along(y, False)[0], low, high, NEARER * (high - low))
    y = min((end for end in (low, high) if along(end, False)[0] <= least), default=y)
    present = get(trials.design, trials.paths[1])
    if second[0] <= present <= second[-1] and along(present, False)[0] <= least + ALIKE:
        y = present  # only the distance of a pivot from the cam centre counts
    y = _vertex(lambda y: along(y, True)[0], y, float(second[0]), float(second[-1]))
    x = along(y, True)[1]
    ends_text = [text for text in (_end_of(trials.paths[0], x, first), _end_of(trials.paths[1], y, second)) if text]
    return _solved_nearby(row, trials, (x, y), tried, first, " and ".join(ends_text))


def _room(values: np.ndarray, near: float, refined: bool) -> tuple[float, float]:
    """The values beside one: as far as the next ones tried, or a little of that where samples have come near."""
    step = float(values[1] - values[0]) * (0.1 if refined else 1.0)
    return max(near - step, float(values[0])), min(near + step, float(values[-1]))


def _vertex(value: Callable[[float], float], near: float, low: float, high: float) -> float:
    """Where a function is least that samples found to be so near a place: the vertex of the parabola through it and its neighbours,
    which move on as long as one of them is better."""
    step = 0.005 * (high - low)
    known = {near: value(near)}
    while step > FINEST * (high - low):
        places = [min(max(near + by, low), high) for by in (-step, 0.0, step)]
        known |= {place: value(place) for place in places if place not in known}
        left, middle, right = (known[place] for place in places)
        same = SAME * max(1.0, abs(middle))  # the merit of what does not serve is larger by far
        if places[0] < places[1] < places[2] and middle <= min(left, right) + same:
            bend = left - 2.0 * middle + right
            vertex = near + 0.5 * step * (left - right) / bend if bend > same else near
            known |= {vertex: value(vertex)}
            return min((near, vertex), key=known.__getitem__)
        better = min(places, key=known.__getitem__)
        near, step = (better, 2.0 * step) if better != near else (near, 0.25 * step)
    return near


# -- flat face ---------------------------------------------------------------------------------------------


def _narrowest_face(design: Design, paths: tuple[str, ...], box: Box) -> Solution:
    """The face that just holds the span of the contact, centred on it as far as the bounds let it."""
    study = Study(design)
    if not design.drive.face.straight:
        raise KindynaError(f"find face-width: a {design.drive.face.noun} has no width; allowed: a flat face")
    contact = find_extremes(lambda angles: {"": study.at(angles).cam.flank.on_face}, study.program)[""]
    span = (1e3 * contact.low.value, 1e3 * contact.high.value)
    (half_low, half_high), (low, high) = (box.get(path, (None, None)) for path in paths)

    def needed(centre: float) -> float:
        return max(abs(end - centre) for end in span)

    middle = _or_zero(0.5 * (span[0] + span[1]), span[1] - span[0])
    centre = max(middle if high is None else min(middle, high), -np.inf if low is None else low)
    half = max(needed(centre), half_low or 0.0)
    against: tuple[str, ...] = ()
    if half_high is not None and half > half_high:
        against = (
            f"the contact runs from {span[0]:.6g} to {span[1]:.6g} mm: half a width of {half:.9g} mm, limit {half_high:g} mm",
        )
    values = dict(zip(paths, (half, centre), strict=True))
    centres = np.linspace(span[0], span[1], 49).tolist()
    present = {path: get(design, path) for path in paths}
    widest = max(needed(centres[0]), half, present[paths[0]] or 0.0)
    return Solution(
        NARROWEST,
        Trials(design, paths, {}).with_values((half, centre)),
        values,
        {"contact_on_face_min_mm": span[0], "contact_on_face_max_mm": span[1]},
        {},
        tuple((needed(at), at) for at in centres),
        paths[1],
        (0.0, widest),
        present,
        {},
        against,
    )


# -- the answer --------------------------------------------------------------------------------------------


def _solved(
    row: SearchRow,
    trials: Trials,
    found: tuple[float, ...],
    values: np.ndarray,
    end: str = "",
    held_by: tuple[str, ...] = (),
    against: tuple[str, ...] = (),
) -> Solution:
    outcome = trials.at(*found)
    readings = (*outcome.readings, *(trials.forces(*found) if outcome.readings else ()))
    made = trials.with_values(found)
    reached = outcome.reached(row.wanted == LEAST_PRESSURE) | {each.key: each.reached for each in readings}
    tightest = outcome.readings[0].key
    if row.wanted == LEAST_PRESSURE or tightest in NEEDED:
        reached.setdefault(ANY_PRESSURE, outcome.pressures[-1])
    shown = ANY_PRESSURE if row.wanted == LEAST_PRESSURE else tightest
    answer = {**dict(zip(trials.paths, found, strict=True)), **row.beside(made, trials.paths[0])}
    present = {path: get(trials.design, path) for path in answer}
    near = _near(found[0], present[trials.paths[0]], values)
    curve = []
    shown_at = sorted({*values.tolist(), *np.linspace(*near, CLOSE).tolist(), found[0]})
    trials.scan((x, *found[1:]) for x in shown_at if x != found[0])
    for x in shown_at:
        there = trials.at(x, *found[1:], refined=x == found[0])
        if there.readings:
            curve.append((x, _shown(there, shown)))
    against = (*(reading.text for reading in outcome.readings if not reading.kept), *against)
    digits = OPTIMUM_DIGITS if row.wanted == LEAST_PRESSURE else ROOT_DIGITS
    if against or (held_by and trials.checked.noted):
        digits = BEST_DIGITS
    return Solution(
        row.wanted,
        made,
        answer,
        reached,
        {each.key: each.limit for each in readings},
        tuple(curve),
        shown,
        near,
        present,
        _reached_before(trials),
        against,
        end,
        digits,
        {each.key: each.reason for each in readings if each.reason},
        held_by,
    )


def _near(found: float, present: float, values: np.ndarray) -> tuple[float, float]:
    """The answer and the present value, and something on both sides, as far as values were tried."""
    beyond = max(BEYOND * abs(found - present), min(LEAST_BEYOND * abs(found), LEAST_BEYOND * float(np.ptp(values))))
    low, high = (
        max(min(found, present) - beyond, float(values[0])),
        min(max(found, present) + beyond, float(values[-1])),
    )
    return min(low, found), max(high, found)


def _reached_before(trials: Trials) -> Mapping[str, float]:
    """What the design at hand reaches of every limit of the cam's shape, and of those of forces that are stated."""
    open_limits = {key: OPEN_PRESSURE if row.is_upper else 0.0 for key, row in LIMITS.items() if not row.needs_forces}
    present = Trials(trials.design, (), open_limits | trials.limits, contact=trials.contact)
    readings = present.at().readings
    return {reading.key: reading.reached for reading in (*readings, *(present.forces() if readings else ()))}


def _shown(outcome: Outcome, key: str) -> float:
    """What is reached of a limit, or the pressure angle; NaN where a limit does not hold there."""
    readings: dict[str, LimitReading] = {reading.key: reading for reading in outcome.readings}
    return (
        readings[key].reached if key in readings else outcome.pressures[NEEDED.index(key)] if key in NEEDED else np.nan
    )


_SOLVERS: Mapping[tuple[int, str], Callable[[SearchRow, Trials, Request], Solution]] = {
    (1, SMALLEST): _outermost,
    (1, LARGEST): _outermost,
    (1, LEAST_PRESSURE): _least_pressure,
    (2, LEAST_PRESSURE): _least_pressure_of_two,
}
"""By the number of fields that are varied, and what is wanted."""
