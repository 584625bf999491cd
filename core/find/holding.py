"""What keeps the follower on an open cam: the least preload or rate of its closing spring, and the speed up to which it stays there."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from core.design import Design, edited, get
from core.dynamics import ContactForce, LeastForce, loading_of, newton_euler
from core.errors import KindynaError
from core.find.solution import Solution
from core.find.trial import highest_of_samples
from core.find.wanted import FORCE, LIFT_OFF, PRELOADS, SPRING_RATES, WANTED, has, speed_path
from core.motion import Angles
from core.motion.extremes import find_highest, piecewise_angles
from core.numerics.search import Ends, bracketed_root
from core.study import Study

RPM = math.pi / 30.0
KEPT = 1e-9  # of the size of the forces: by which a limit may be missed
NO_EFFECT = 1e-6  # of the greatest effect on the contact force: where a spring's rate does nothing
RATES, BESIDE = 17, 2.0  # of the curve: how many, and up to which multiple of the rate at hand
FEWER = 7  # the same where friction makes every value a search of its own
SPEEDS, BEYOND = 33, 1.4  # of the curve of forces: how many, and up to which multiple of the answer or the speed at hand
GROWTH, MOST = 2.0, 1e9  # steps towards a value that serves; the most tried, times the first
ROUGH = 1e-3  # of the value: how far samples may be off
SLOWLY = 1e-6  # of a speed: in place of standstill


class Request(NamedTuple):
    """force [N] to be kept up to the speed high [rad/s]; low, most: bounds of the value sought, in the unit of the file."""

    force: float
    high: float
    low: float
    most: float


class Needed(NamedTuple):
    """The least value that serves, and the greatest that does; lack [N]: what is missing where the value changes nothing; its angle."""

    least: float
    most: float
    lack: float
    theta: float


def find_holding(design: Design, what: str, stated: Mapping[str, float], alone: bool = False) -> Solution:
    """The answer of a row of ``WANTED`` that keeps contact; stated: ``loads.least_contact_force_n_min``, ``shaft.speed_rpm_max``, bounds
    of the value sought; alone: no others hold. Raises KindynaError where the design has no such field or limit, NoAnswer where the
    cam holds the follower from both sides, nothing presses it, or friction jams."""
    row = WANTED[what]
    paths = row.fields(design, {})
    if design.drive.cam is None:
        raise KindynaError(f"find {what}: this design has no cam; allowed: one with [cam]")
    missing = [path for path in paths if not has(design, path)]
    if missing:
        hint = "; its constant force is loads.external_force_n" if has(design, "loads.external_force_n") else ""
        raise KindynaError(f"find {what}: this design has no {', '.join(missing)}{hint}")
    allowed = row.keys(paths)
    for key in stated:
        if key not in allowed:
            raise KindynaError(f"limit {key!r}: {what} has none of that name; allowed: {' | '.join(allowed)}")
    limits = {**row.usual(design), **stated} if not alone else {**dict.fromkeys((f"{FORCE}_min",), 0.0), **stated}
    speed = limits.get(f"{speed_path(design)}_max", design.speed_rpm)
    if not speed > 0.0:
        raise KindynaError(f"limit {speed_path(design)}_max = {speed:g}: outside its range; allowed: > 0 rpm")
    force = limits[f"{FORCE}_min"]
    if force < 0.0:
        raise KindynaError(f"limit {FORCE}_min = {force:g}: outside its range; allowed: >= 0 N")
    low, most = limits.get(f"{paths[0]}_min", 0.0), limits.get(f"{paths[0]}_max", math.inf)
    if low > most:
        raise KindynaError(f"limit {paths[0]}_min = {low:g}: is above {paths[0]}_max = {most:g}")
    request = Request(force, speed * RPM, low, most)
    return _lift_off(design, paths[0], request) if row.wanted == LIFT_OFF else _spring(design, paths[0], request)


def _where(design: Design, found: LeastForce, force: float) -> str:
    at = f"at {math.degrees(found.theta):.5g} deg and {abs(found.omega) / RPM:.6g} rpm"
    return f"contact force {found.value:.6g} N {at}, limit {force:g} N"


# -- lift-off ----------------------------------------------------------------------------------------------


def _lift_off(design: Design, path: str, request: Request) -> Solution:
    """The speed at which the least contact force falls to the one that is to be kept."""
    contact = Study(design).contact_force
    found = contact.lift_off(request.force)
    if found is None:
        raise KindynaError("find lift-off-speed: the follower stays on the cam at any speed up to 100000 rpm")
    if not found.omega:
        standing = contact.least(0.0)
        raise KindynaError(
            f"find lift-off-speed: {_where(design, standing, request.force)}: it does not stay there at any speed; find preload gives "
            "the spring that it needs"
        )
    rpm = found.omega / RPM
    own = design.speed_rpm
    speeds = sorted({*np.linspace(0.02, BEYOND * max(rpm, min(own, 3.0 * rpm)), SPEEDS).tolist(), rpm})
    angles = piecewise_angles(contact.program)
    at = _sampled(contact, angles)
    curve = tuple((x, request.force if x == rpm else at(x * RPM)) for x in speeds)
    reached, before = contact.at_own(found.omega).value, contact.at_own(own * RPM).value
    if abs(reached - request.force) <= KEPT * (request.force + abs(before)):
        reached = request.force  # but for rounding
    return Solution(
        LIFT_OFF, edited(design, path, math.copysign(rpm, get(design, path))), {path: rpm}, {FORCE: reached}, {FORCE: request.force},
        curve, FORCE, (curve[0][0], curve[-1][0]), {path: own}, {FORCE: before},
    )  # fmt: skip


def _sampled(contact: ContactForce, angles: Angles) -> Callable[[float], float]:
    """Speed [rad/s] -> the least of the forces sampled over the turn [N]."""
    if contact.rubs:
        return lambda omega: float(contact.at_speed(angles, omega).min())
    parts = contact.parts(angles)
    return lambda omega: float(parts.force(omega).min())


# -- the closing spring ------------------------------------------------------------------------------------


class _Springs:
    """Designs that differ in the closing spring; values in the unit of the file."""

    def __init__(self, design: Design, request: Request) -> None:
        self.design, self.request = design, request
        study = Study(design)
        study.contact_force  # noqa: B018 - raises where there is none to speak of
        self.study, self.program = study, study.program
        self.preload = next((path for path in PRELOADS if has(design, path)), "")
        self.rate = next(path for path in SPRING_RATES if has(design, path))
        self.at = lru_cache(maxsize=4)(lambda angles: (study.at(angles).linkage, study.at(angles).cam))

    def made(self, values: Mapping[str, float]) -> Design:
        design = self.design
        for path, value in values.items():
            design = edited(design, path, value)
        return design

    def contact(self, values: Mapping[str, float]) -> ContactForce:
        drive = self.made(values).drive
        return ContactForce(self.at, loading_of(drive.mechanism, drive.loads, self.study.mechanism), self.program, self.study.omega)

    def effect(self, path: str, angles: Angles) -> np.ndarray:
        """What one unit of a field adds to the contact force (n,)."""
        off = {name: 0.0 for name in (self.preload, self.rate) if name}
        with_one, without = (replace(self.contact({**off, path: x}).loading, masses=(), frictions=()) for x in (1.0, 0.0))
        place = self.at(angles)
        return np.asarray(newton_euler(*place, with_one, 0.0).contact - newton_euler(*place, without, 0.0).contact)

    def needed(self, path: str, others: Mapping[str, float]) -> Needed:
        """What the field must be, with these values of the others, so that the force is kept at every angle and speed."""
        contact, request = self.contact({**others, path: 0.0}), self.request
        if contact.rubs:
            return self._needed_with_friction(path, others)
        greatest = float(np.abs(self.effect(path, piecewise_angles(self.program))).max(initial=0.0))

        def bounds(angles: Angles) -> dict[str, np.ndarray]:
            effect = self.effect(path, angles)
            lack = request.force - contact.parts(angles).least(request.high)[0]
            none = np.abs(effect) <= NO_EFFECT * greatest
            with np.errstate(divide="ignore", invalid="ignore"):
                ratio = lack / effect
            return {
                "least": np.where(~none & (effect > 0.0), ratio, np.nan),
                "most": np.where(~none & (effect < 0.0), -ratio, np.nan),
                "lack": np.where(none, lack, np.nan),
            }

        found = find_highest(bounds, self.program)
        return Needed(found["least"].value, -found["most"].value, found["lack"].value, found["lack"].theta)

    def _needed_with_friction(self, path: str, others: Mapping[str, float]) -> Needed:
        """By a root of the least force, which grows with the value: of samples first, then refined beside that."""
        near = self._rough(path, others)

        def spare(value: float) -> float:
            return self.contact({**others, path: value}).least(self.request.high).value - self.request.force

        low, high, finest = near * (1.0 - ROUGH), near * (1.0 + ROUGH), 1e-12 * near
        if not math.isfinite(near):
            worst = self._stalled(path, others)
            return Needed(-math.inf, math.inf, self.request.force - worst.value, worst.theta)
        bad, good = spare(low), spare(high)
        while bad >= 0.0 and low > finest:
            low, high, good = 0.5 * low, low, bad
            bad = spare(low)
        while good < 0.0:
            low, bad, high = high, good, GROWTH * high
            good = spare(high)
        least = bracketed_root(spare, Ends(low, bad, high, good), finest).b if bad < 0.0 else 0.0
        return Needed(least, math.inf, -math.inf, 0.0)

    def _stalled(self, path: str, others: Mapping[str, float]) -> LeastForce:
        """The least force with a value beyond which more of it does not enlarge that any more."""

        def least(value: float) -> LeastForce:
            return self.contact({**others, path: value}).least(self.request.high)

        value = abs(get(self.design, path)) or 1.0
        worst = least(value)
        while value <= MOST:
            value *= GROWTH
            grown = least(value)
            if grown.value <= worst.value + KEPT * (self.request.force + abs(worst.value)):
                return worst
            worst = grown
        return worst

    def _rough(self, path: str, others: Mapping[str, float]) -> float:
        """The same by samples of the turn, at standstill and at the highest speed; infinite where no value serves."""
        angles, high = piecewise_angles(self.program), self.request.high

        def spare(value: float) -> float:
            at = _sampled(self.contact({**others, path: value}), angles)
            return min(at(SLOWLY * high), at(high)) - self.request.force

        bad, good, first = 0.0, abs(get(self.design, path)) or 1.0, spare(0.0)
        if first >= 0.0:
            return 0.0
        last = spare(good)
        while last < 0.0:
            grown = spare(GROWTH * good)
            if good > MOST or grown <= last:  # it changes nothing where the force is least, or for the worse
                return math.inf
            bad, first, good, last = good, last, GROWTH * good, grown
        return bracketed_root(spare, Ends(bad, first, good, last), 0.1 * ROUGH * good).b

    def trade(self, around: float) -> list[tuple[float, float]]:
        """Rates, and the least preload that serves with each; around: a rate that the curve is to show."""
        rubs = self.contact({}).rubs
        most = BESIDE * max(around, get(self.design, self.rate)) or self._usual_rate()
        if rubs:
            rates = np.linspace(0.0, most, FEWER).tolist()
            return [(rate, self._rough(self.preload, {self.rate: rate})) for rate in rates]
        angles = piecewise_angles(self.program)
        theta = 0.5 * (angles.theta[1:] + angles.theta[:-1])
        same = angles.piece[1:] == angles.piece[:-1]
        theta, piece = np.concatenate((angles.theta, theta[same])), np.concatenate((angles.piece, angles.piece[1:][same]))
        order = np.lexsort((theta, piece))
        angles = Angles(theta[order], piece[order])
        parts = self.contact({self.rate: 0.0, self.preload: 0.0}).parts(angles)
        lack = self.request.force - parts.least(self.request.high)[0]
        by_preload, by_rate = self.effect(self.preload, angles), self.effect(self.rate, angles)
        rates = np.linspace(0.0, most, RATES).tolist()
        return [(rate, max(highest_of_samples((lack - rate * by_rate) / by_preload, angles).value, 0.0)) for rate in rates]

    def _usual_rate(self) -> float:
        """The rate whose spring at the largest motion is as strong as the preload needed without it; where no spring is needed 1."""
        angles = piecewise_angles(self.program)
        preload, rate = (float(np.abs(self.effect(path, angles)).max()) for path in (self.preload, self.rate))
        needed = max(self.needed(self.preload, {self.rate: 0.0}).least, 0.0)
        return needed * preload / rate if needed and rate else 1.0


def _spring(design: Design, path: str, request: Request) -> Solution:
    """The least preload for the present rate, or the least rate for the present preload."""
    springs = _Springs(design, request)
    needed = springs.needed(path, {})
    size = KEPT * (request.force + abs(springs.contact({}).least(request.high).value))
    value = max(needed.least, request.low, 0.0 if path in SPRING_RATES else request.low)
    value = min(value, request.most)
    if not math.isfinite(value):
        value = request.low
    if needed.lack > size:  # where it changes nothing the force is too small already: no value is better than the present one
        value = min(max(get(design, path), request.low), request.most)
    found = springs.contact({path: value}).least(request.high)
    against: tuple[str, ...] = ()
    if needed.lack > size and found.value < request.force - size:
        text = f"contact force {request.force - needed.lack:.6g} N at {math.degrees(needed.theta):.5g} deg, limit {request.force:g} N"
        against = (f"{text}: the spring's rate adds nothing where the motion is 0{_by_preload(springs, path, value)}",)
    elif found.value < request.force - size:
        against = (_where(design, found, request.force) + (f": it takes {path} = {needed.least:.9g}" if value < needed.least else ""),)
    end = f"{path} = {value:.9g}" if found.value > request.force + size else ""
    other = springs.rate if path == springs.preload else springs.preload
    reached = {FORCE: found.value}
    before = {FORCE: springs.contact({}).least(request.high).value, speed_path(design): design.speed_rpm}
    if other:
        curve = [(p, rate) for rate, p in springs.trade(0.0)] if path == springs.preload else springs.trade(value)
        reached[other] = before[other] = get(design, other)
        if not against and not end:  # the answer lies on the curve
            curve = sorted([*curve, (value, get(design, other))], key=lambda point: point[0 if path == springs.rate else 1])
    else:
        angles = piecewise_angles(springs.program)
        rates = np.linspace(0.0, BESIDE * max(value, get(design, path)) or 1.0, RATES).tolist()
        curve = [(x, min(_sampled(springs.contact({path: x}), angles)(w) for w in (SLOWLY * request.high, request.high))) for x in rates]
    finite = tuple((x, y) for x, y in curve if math.isfinite(x) and math.isfinite(y))
    ends = [value, get(design, path), *(x for x, _ in finite)]
    near = min(ends), max(ends)
    return Solution(
        WANTED["preload" if path == springs.preload else "spring"].wanted, springs.made({path: value}), {path: value}, reached,
        {FORCE: request.force}, finite, other or FORCE, near, {path: get(design, path)}, before, against, end,
    )  # fmt: skip


def _by_preload(springs: _Springs, path: str, rate: float) -> str:
    """What would help: the preload that is needed with this rate."""
    if not springs.preload:
        return ""
    needed = springs.needed(springs.preload, {path: rate}).least
    return f"; with this rate it takes {springs.preload} = {needed:.9g}"

