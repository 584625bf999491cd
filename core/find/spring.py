"""What keeps the follower on an open cam: the least preload or rate of its closing spring, and the speed up to which it stays there."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.design import Design, drive_in, edited, get, only, path_in
from core.dynamics import ContactForce, LeastForce, loading_of
from core.errors import KindynaError
from core.find import search
from core.find.goals import LIFT_OFF, PRELOADS, SPRING_RATES, WANTED, has, speed_path
from core.find.offer import Stated, offered, request
from core.find.search import Solution, sought
from core.find.shaft import ON_SHAFT, find_on_shaft, offered_on_shaft, with_least_flywheel
from core.find.trial import RPM, FindingsCheck, KeptForce, Put, alone, nearest, uneven
from core.findings import Finding, Remedy
from core.motion import Angles
from core.motion.extremes import piecewise_angles
from core.numerics.roots import BracketEnds, bounded_minimum, bracketed_root
from core.study import Study
from core.study.limits import FORCE

# -- what keeps the follower on an open cam ---------------------------------------------------------------------


KEPT = 1e-9  # of the size of the forces: by which a limit may be missed
SAFE = 5e-10  # of an answer, by which it lies on the safe side of what it must keep
RATES, BESIDE = 17, 2.0  # of the curve: how many, and up to which multiple of the rate at hand
FEWER = 7  # the same where friction makes every value a search of its own
SPEEDS, BEYOND = (
    33,
    1.4,
)  # of the curve of forces: how many, and up to which multiple of the answer or the speed at hand
GROWTH, MOST = 2.0, 1e9  # steps towards a value that serves; the most tried, times the first
ROUGH = 1e-3  # of the value: how far samples may be off
SLOWER = 9  # speeds tried below that of lift-off, where that is complained of
STEPS = 40  # tried towards a stiffer spring, quarters of a step, where a weaker one is complained of


class HoldingRequest(NamedTuple):
    """What is to be kept; low, most: bounds of the value sought, in the unit of the file; why: of a lower one that nobody stated."""

    contact: KeptForce
    low: float
    most: float
    why: str


def find_holding(design: Design, what: str, stated: Stated, machine: Put = alone) -> Solution:
    """The answer of a row of ``WANTED`` that keeps contact; stated: ``loads.least_contact_force_n_min``, ``shaft.speed_rpm_max``, bounds
    of the value sought; machine: as for ``find``. Raises KindynaError where the design has no such field or limit, NoSolution where the
    cam holds the follower from both sides, nothing presses it, or friction jams."""
    row = WANTED[what]
    paths = row.fields(design, {})
    if design.drive.cam is None:
        raise KindynaError(f"find {what}: this design has no cam; allowed: one with [cam]")
    missing = [path for path in paths if not has(design, path)]
    if missing:
        hint = "; its constant force is loads.external_force_n" if has(design, "loads.external_force_n") else ""
        raise KindynaError(f"find {what}: this design has no {', '.join(missing)}{hint}")
    _ = Study(design).contact_force  # raises where there is none to speak of
    asked = request(design, what, stated)
    low, most = asked.bounds.get(paths[0], (None, None))
    if low is not None and most is not None and low > most:
        raise KindynaError(f"limit {paths[0]}_min = {low:g}: is above {paths[0]}_max = {most:g}")
    wish = HoldingRequest(
        asked.contact or KeptForce(0.0, design.speed_rpm * RPM),
        0.0 if low is None else low,
        math.inf if most is None else most,
        next((f" ({each.reason})" for each in asked.at_bound.values()), ""),
    )
    search = _lift_off if row.wanted == LIFT_OFF else _spring
    return sought(lambda checked: search(design, paths[0], wish, checked), design, machine, asked.waived)


def _where(design: Design, found: LeastForce, force: float, reason: str = "") -> str:
    at = f"at {math.degrees(found.theta):.5g} deg and {abs(found.omega) / RPM:.6g} rpm"
    return f"contact force {found.value:.6g} N {at}, limit {force:.6g} N" + (f" ({reason})" if reason else "")


# -- lift-off ----------------------------------------------------------------------------------------------


def _lift_off(design: Design, path: str, wish: HoldingRequest, checked: FindingsCheck) -> Solution:
    """The speed at which the least contact force falls to the one that is to be kept; into the design goes one just below it, with which
    nothing new is to be complained of."""
    contact, force = Study(design).contact_force, wish.contact.force or 0.0
    found = contact.lift_off(force)
    if found is None:
        raise KindynaError("find lift-off-speed: the follower stays on the cam at any speed up to 100000 rpm")
    if not found.omega:
        standing = contact.least(0.0)
        raise KindynaError(
            f"find lift-off-speed: {_where(design, standing, force)}: it does not stay there at any speed; find preload gives "
            "the spring that it needs"
        )
    rpm = found.omega / RPM
    own = design.speed_rpm
    speeds = sorted({*np.linspace(0.02, BEYOND * max(rpm, min(own, 3.0 * rpm)), SPEEDS).tolist(), rpm})
    angles = piecewise_angles(contact.program)
    at = _sampled(contact, angles)
    curve = tuple((x, force if x == rpm else at(x * RPM)) for x in speeds)
    reached, before = contact.least_at_speed(found.omega).value, contact.least_at_speed(own * RPM).value
    if abs(reached - force) <= KEPT * (force + abs(before)):
        reached = force  # but for rounding

    def turning(speed: float) -> Design:
        return edited(design, path, math.copysign(speed, get(design, path)))

    def serves(speed: float, quick: bool = False) -> bool:
        return not checked.new(turning(speed), quick)

    taken = rpm * (1.0 - SAFE)
    if held_by := checked.new(turning(taken)):
        good = next((x for x in (*np.linspace(rpm, 0.0, SLOWER)[1:-1].tolist(), own) if x < taken and serves(x)), None)
        if good is not None:
            taken, beyond = nearest(serves, taken, good, checked.part)
            held_by = checked.new(turning(beyond))
    return Solution(
        LIFT_OFF,
        turning(taken),
        {path: rpm},
        {FORCE: reached},
        {FORCE: force},
        curve,
        FORCE,
        (curve[0][0], curve[-1][0]),
        {path: own},
        {FORCE: before},
        held_by=held_by,
        taken={path: taken},
    )


def _sampled(contact: ContactForce, angles: Angles) -> Callable[[float], float]:
    """Speed [rad/s] -> the least of the forces sampled over the turn [N]."""
    if contact.has_friction:
        return lambda omega: float(contact.at_speed(angles, omega).min())
    parts = contact.terms(angles)
    return lambda omega: float(parts.force(omega).min())


# -- the closing spring ------------------------------------------------------------------------------------


class _Springs:
    """Designs that differ in the closing spring; values in the unit of the file."""

    def __init__(self, design: Design, kept: KeptForce) -> None:
        self.design, self.kept = design, kept
        self.study = Study(design)
        self.program = self.study.program
        self.preload = next((path for path in PRELOADS if has(design, path)), "")
        self.rate = next(path for path in SPRING_RATES if has(design, path))
        self.at = lru_cache(maxsize=4)(lambda angles: (self.study.at(angles).linkage, self.study.at(angles).cam))

    def made(self, values: Mapping[str, float]) -> Design:
        design = self.design
        for path, value in values.items():
            design = edited(design, path, value)
        return design

    def contact(self, values: Mapping[str, float]) -> ContactForce:
        drive = self.made(values).drive
        return ContactForce(
            self.at, loading_of(drive.mechanism, drive.loads, self.study.mechanism), self.program, self.study.omega
        )

    def limit(self, values: Mapping[str, float]) -> tuple[float, str]:
        """The force that is to be kept [N], and why; of the largest one with these values."""
        stated = self.kept.force is not None
        return self.kept.of(0.0 if stated else self.contact(values).greatest(self.kept.high))

    def spare(self, values: Mapping[str, float]) -> float:
        """What the least force is above the one to be kept [N], refined."""
        return self.contact(values).least(self.kept.high).value - self.limit(values)[0]

    def needed(self, path: str, others: Mapping[str, float]) -> float:
        """The least value of a field that serves with these of the others; infinite where none does. The spare force over a value is a
        concave curve, or nearly so: by a root of it, of samples first, then refined beside that."""
        near = self.rough(path, others)
        if not math.isfinite(near):
            return math.inf

        def spare(value: float) -> float:
            return self.spare({**others, path: value})

        low, high, finest = near * (1.0 - ROUGH), near * (1.0 + ROUGH), 1e-12 * near
        bad, good = spare(low), spare(high)
        while bad >= 0.0 and low > finest:
            low, high, good = 0.5 * low, low, bad
            bad = spare(low)
        while good < 0.0 and high < MOST * near:
            low, bad, high = high, good, GROWTH * high
            good = spare(high)
        if good < 0.0:
            return math.inf
        return bracketed_root(spare, BracketEnds(low, bad, high, good), finest).b * (1.0 + SAFE) if bad < 0.0 else 0.0

    def rough(self, path: str, others: Mapping[str, float]) -> float:
        """The same by samples of the turn."""
        angles, high = piecewise_angles(self.program), self.kept.high

        def spare(value: float) -> float:
            least, largest = self.contact({**others, path: value}).sampled(angles, high)
            return least - (self.kept.of(largest)[0])

        bad, good, first = 0.0, abs(get(self.design, path)) or 1.0, spare(0.0)
        if first >= 0.0:
            return 0.0
        last = spare(good)
        while last < 0.0:
            grown = spare(GROWTH * good)
            if good > MOST:
                return math.inf
            if grown <= last:  # beyond the most that there is
                top, least = bounded_minimum(lambda value: -spare(value), bad, GROWTH * good, ROUGH * good)
                if least > 0.0:
                    return math.inf
                good, last = top, -least
                break
            bad, first, good, last = good, last, GROWTH * good, grown
        return bracketed_root(spare, BracketEnds(bad, first, good, last), 0.1 * ROUGH * good).b

    def stalled(self, path: str) -> LeastForce:
        """The least force with a value beyond which more of it does not enlarge that any more."""

        def least(value: float) -> LeastForce:
            return self.contact({path: value}).least(self.kept.high)

        value = abs(get(self.design, path)) or 1.0
        worst = least(value)
        while value <= MOST:
            value *= GROWTH
            grown = least(value)
            if grown.value <= worst.value + KEPT * abs(worst.value):
                return worst
            worst = grown
        return worst

    def trade(self, around: float) -> list[tuple[float, float]]:
        """Rates, and the least preload that serves with each; around: a rate that the curve is to show."""
        most = BESIDE * max(around, get(self.design, self.rate)) or self._usual_rate()
        rates = np.linspace(0.0, most, FEWER if self.contact({}).has_friction else RATES).tolist()
        return [(rate, self.rough(self.preload, {self.rate: rate})) for rate in rates]

    def _usual_rate(self) -> float:
        """The rate whose spring at the largest motion is as strong as the preload needed without it; where no spring is needed 1."""
        stroke = float(np.abs(self.study.at(piecewise_angles(self.program)).motion.displacement[0]).max())
        stroke *= 1e3 if self.rate == SPRING_RATES[0] else 1.0
        needed = self.needed(self.preload, {self.rate: 0.0})
        return needed / stroke if stroke and math.isfinite(needed) and needed else 1.0


def _spring(design: Design, path: str, wish: HoldingRequest, checked: FindingsCheck) -> Solution:
    """The least preload for the present rate, or the least rate for the present preload."""
    springs, present = _Springs(design, wish.contact), get(design, path)
    needed = springs.needed(path, {})
    against: tuple[str, ...] = ()
    held_by: tuple[str, ...] = ()
    value = min(max(needed, wish.low), wish.most)

    def serves(value: float, quick: bool = False) -> bool:
        return springs.spare({path: value}) >= 0.0 and not checked.new(springs.made({path: value}), quick)

    if math.isinf(needed):  # no value is better than the present one
        value = min(max(present, wish.low), wish.most)
        against = (_in_vain(springs, path, value),)
    elif value < needed:
        limit, reason = springs.limit({path: value})
        found = springs.contact({path: value}).least(wish.contact.high)
        against = (f"{_where(design, found, limit, reason)}: it takes {path} = {needed:.9g}",)
    elif held_by := checked.new(springs.made({path: value})):
        more = (
            [] if checked.noted else ((value or abs(present) or 1.0) * GROWTH ** (0.25 * np.arange(1, STEPS))).tolist()
        )
        good = next((x for x in (present, *more) if value < x <= wish.most and serves(x)), None)
        against = held_by
        if good is not None:
            value, beyond = nearest(serves, value, good, checked.part)
            against, held_by = (), checked.new(springs.made({path: beyond}))
    found, (limit, reason) = springs.contact({path: value}).least(wish.contact.high), springs.limit({path: value})
    end = f"{path} = {value:.9g}{wish.why}" if (value > needed or not value) and not held_by else ""
    other = springs.rate if path == springs.preload else springs.preload
    reached = {FORCE: found.value}
    before = {FORCE: springs.contact({}).least(wish.contact.high).value, speed_path(design): design.speed_rpm}
    if other:
        curve = [(p, rate) for rate, p in springs.trade(0.0)] if path == springs.preload else springs.trade(value)
        reached[other] = before[other] = get(design, other)
        if not against and not end:  # the answer lies on the curve
            curve = sorted(
                [*curve, (value, get(design, other))], key=lambda point: point[0 if path == springs.rate else 1]
            )
    else:
        angles = piecewise_angles(springs.program)
        rates = np.linspace(0.0, BESIDE * max(value, present) or 1.0, RATES).tolist()
        curve = [(x, springs.contact({path: x}).sampled(angles, wish.contact.high)[0]) for x in rates]
    finite = tuple((x, y) for x, y in curve if math.isfinite(x) and math.isfinite(y))
    ends = [value, present, *(x for x, _ in finite)]
    return Solution(
        WANTED["preload" if path == springs.preload else "spring"].wanted,
        springs.made({path: value}),
        {path: value},
        reached,
        {FORCE: limit},
        finite,
        other or FORCE,
        (min(ends), max(ends)),
        {path: present},
        before,
        against,
        end,
        reasons={FORCE: reason} if reason else {},
        held_by=() if against else held_by,
    )


def _in_vain(springs: _Springs, path: str, value: float) -> str:
    """That no value helps, and what would: the preload that is needed with this rate."""
    worst = springs.stalled(path)
    limit, _ = springs.limit({path: value})
    text = (
        f"contact force {worst.value:.6g} N at {math.degrees(worst.theta):.5g} deg, limit {limit:.6g} N: the spring's "
    )
    if path == springs.preload or not springs.preload:
        return f"{text}force does not help there"
    needed = springs.needed(springs.preload, {path: value})
    with_it = f"; with this rate it takes {springs.preload} = {needed:.9g}" if math.isfinite(needed) else ""
    return f"{text}rate adds nothing where the motion is 0{with_it}"


# -- what mends a finding of a design ---------------------------------------------------------------------------


def remedy_of(design: Design, finding: Finding) -> Remedy:
    """The remedy of the finding's row with the field where it leads; without a search that the design has nothing for."""
    row, own = finding.remedy, drive_in(design, finding.field)
    inside = finding.field if own is None else own[1]
    if row.find and not (row.of in ("", inside) and row.find in _searches(design, own)):
        row = Remedy()
    field = row.field if own is None or not row.field else path_in(design, own[0], row.field)
    return row._replace(field=field or finding.field)


def _searches(design: Design, own: tuple[int, str] | None) -> tuple[str, ...]:
    """Those of the shaft, and of the drive that a finding is of."""
    return (*offered_on_shaft(design), *(() if own is None else offered(only(design, own[0]))))


# -- all that can be sought, in one drive or in a whole shaft ---------------------------------------------------


SEARCHES: Mapping[str, str] = MappingProxyType(
    {what: row.help for what, row in WANTED.items()} | {what: row.help for what, row in ON_SHAFT.items()}
)
"""What is sought -> in words."""


def find(design: Design, what: str, stated: Stated, *, aim: str = "peak", machine: Put = alone, **how: Any) -> Solution:
    """The answer of a row of ``WANTED``, by ``find_holding`` or by ``solution.find`` with ``how`` it says, or of ``ON_SHAFT``; machine: the
    design -> the whole that it belongs to. Raises KindynaError."""
    if what not in SEARCHES:
        raise KindynaError(f"find {what!r}: unknown; allowed: {' | '.join(SEARCHES)}")
    if what in ON_SHAFT:
        found = find_on_shaft(design, what, stated, aim)
    elif WANTED[what].holding:
        found = find_holding(design, what, stated, machine)
    else:
        found = search.find(design, what, stated, machine=machine, **how)
    return found if what == FLYWHEEL_GOAL else _with_flywheel(found, machine(design), machine(found.design))


FLYWHEEL_GOAL = "flywheel"


def _with_flywheel(found: Solution, before: Design, made: Design) -> Solution:
    """The machine with the answer; where the load of its shaft has grown so that the speed fluctuates more than it may, which it did not
    before, with the flywheel that this takes."""
    if found.serves and not found.besides and uneven(made) and not uneven(before):
        whole, wheel = with_least_flywheel(made)
        design = whole if made == found.design else found.design
        return replace(found, design=design, whole=whole, taken={**found.taken, **wheel})
    return replace(found, whole=made)
