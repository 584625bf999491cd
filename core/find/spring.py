"""Searches for the contact with an open cam: least preload or rate of the closing spring, and the lift-off speed."""

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
from core.find.goals import CAM_SEARCHES, INSTALLED, LIFT_OFF, PRELOADS, SPRING_RATES, WIRE, has, speed_path
from core.find.offer import StatedLimits, available_searches, search_request
from core.find.rounding import TORQUE, cam_torque, rounded, rounded_flywheel
from core.find.shaft import SHAFT_SEARCHES, available_shaft_searches, find_on_shaft, with_least_flywheel
from core.find.solution import Judge, Judgement, Solution, out_of_bounds, search_with_findings
from core.find.trial import (
    RPM,
    ContactLimit,
    FindingsCheck,
    MachineOf,
    has_uneven_speed,
    nearest_accepted,
    same_design,
)
from core.findings import Finding, Remedy
from core.motion import Angles
from core.motion.extremes import piecewise_angles
from core.number_text import result_text
from core.numerics.roots import BracketEnds, bounded_minimum, bracketed_root
from core.study import Study
from core.study.limits import FORCE

# -- contact with an open cam -----------------------------------------------------------------------------------

TOLERANCE = 1e-9  # of a force, relative to the size of the forces
SAFE = 5e-10  # relative safety margin of a result
RATES, RATE_RANGE = 17, 2.0  # of the curve: number, and greatest multiple of the present rate
FEWER = 7  # number of rates where friction makes every value a search of its own
# Of the curve of forces: number, and greatest multiple of the result or the present speed.
SPEEDS, SPEED_RANGE = 33, 1.4
SLENDER = 20.0  # greatest spring index D/d of a result: a more slender spring is not wound
GROWTH, MOST = 2.0, 1e9  # factor of a step towards a sufficient value; greatest value, times the first
ROUGH = 1e-3  # relative error of samples
SLOWER = 9  # trial speeds below the lift-off speed, where the machine has new findings with this
STEPS = 40  # trial values above the least one, a quarter of a step each, where the machine has new findings with this


class ContactRequest(NamedTuple):
    """Contact limit, bounds of the value in the unit of the file, and the reason of a lower bound that is a default."""

    contact: ContactLimit
    low: float
    most: float
    why: str


def find_for_contact(design: Design, what: str, stated: StatedLimits, machine: MachineOf = same_design) -> Solution:
    """Solve a search of ``CAM_SEARCHES`` that seeks contact of the follower with an open cam.

    Parameters
    ----------
    design : Design
    what : str
        Key of ``CAM_SEARCHES``.
    stated : dict
        ``loads.least_contact_force_n_min``, ``shaft.speed_rpm_max``, bounds of the value.
    machine : callable
        Design -> the machine that contains it.

    Returns
    -------
    Solution

    Raises
    ------
    KindynaError
        Where the design has no such field or limit.
    NoSolution
        Where the cam holds the follower from both sides, no force presses it on the cam, or friction jams.
    """
    row = CAM_SEARCHES[what]
    paths = row.fields(design, {})
    if not design.drive.has_disk:
        raise KindynaError(f"find {what}: this design has no cam; allowed: one with [cam]")
    missing = [path for path in paths if not has(design, path)]
    if missing:
        hint = "; its constant force is loads.external_force_n" if has(design, "loads.external_force_n") else ""
        raise KindynaError(f"find {what}: this design has no {', '.join(missing)}{hint}")
    _ = Study(design).contact_force  # raises where no contact force exists
    limits = search_request(design, what, stated)
    low, most = limits.bounds.get(paths[0], (None, None))
    if low is not None and most is not None and low > most:
        raise KindynaError(f"limit {paths[0]}_min = {low:g}: is above {paths[0]}_max = {most:g}")
    request = ContactRequest(
        limits.contact or ContactLimit(0.0, design.speed_rpm * RPM),
        0.0 if low is None else low,
        math.inf if most is None else most,
        next((f" ({bound.reason})" for bound in limits.default_bounds.values()), ""),
    )
    solver = _lift_off if row.target == LIFT_OFF else _spring
    return search_with_findings(
        lambda checked: solver(design, paths[0], request, checked), design, machine, limits.waived
    )


def _force_text(least: LeastForce, limit: float, reason: str = "") -> str:
    at = f"at {result_text(math.degrees(least.theta))} deg and {result_text(abs(least.omega) / RPM)} rpm"
    return f"contact force {result_text(least.value, 5)} N {at}, limit {result_text(limit, 5)} N" + (
        f" ({reason})" if reason else ""
    )


# -- lift-off ----------------------------------------------------------------------------------------------


def _lift_off(design: Design, path: str, request: ContactRequest, checked: FindingsCheck) -> Solution:
    """Speed at which the least contact force falls to its limit.

    The design receives a speed just below it, with which the machine has no new finding.
    """
    contact, force = Study(design).contact_force, request.contact.force or 0.0
    least = contact.lift_off(force)
    if least is None:
        raise KindynaError("find lift-off-speed: the follower stays on the cam at any speed up to 100000 rpm")
    if not least.omega:
        raise KindynaError(
            f"find lift-off-speed: {_force_text(contact.least(0.0), force)}: it is below the limit at every speed; "
            "find preload gives the required spring"
        )
    rpm = least.omega / RPM
    present = design.speed_rpm
    speeds = sorted({*np.linspace(0.02, SPEED_RANGE * max(rpm, min(present, 3.0 * rpm)), SPEEDS).tolist(), rpm})
    angles = piecewise_angles(contact.program)
    least_force = _sampled_force(contact, angles)
    curve = tuple((x, force if x == rpm else least_force(x * RPM)) for x in speeds)
    reached, before = contact.least_at_speed(least.omega).value, contact.least_at_speed(present * RPM).value
    if abs(reached - force) <= TOLERANCE * (force + abs(before)):
        reached = force  # apart from rounding

    def with_speed(speed: float) -> Design:
        return edited(design, path, math.copysign(speed, get(design, path)))

    def is_accepted(speed: float, quick: bool = False) -> bool:
        return not checked.new(with_speed(speed), quick)

    def at(values: Mapping[str, float]) -> Judgement:
        speed = values[path]
        least = contact.least_at_speed(speed * RPM)
        worst = LeastForce(least.value, least.theta, speed * RPM)
        short = () if speed < rpm and least.value >= force else (_force_text(worst, force),)
        return Judgement(with_speed(speed), values, {FORCE: least.value}, short or checked.new(with_speed(speed)))

    applied = rpm * (1.0 - SAFE)
    if next_findings := checked.new(with_speed(applied)):
        slower = (*np.linspace(rpm, 0.0, SLOWER)[1:-1].tolist(), present)
        good = next((x for x in slower if x < applied and is_accepted(x)), None)
        if good is not None:
            applied, beyond = nearest_accepted(is_accepted, applied, good, checked.tolerance)
            next_findings = checked.new(with_speed(beyond))
    return Solution(
        LIFT_OFF,
        with_speed(applied),
        {path: rpm},
        {FORCE: reached},
        {FORCE: force},
        curve,
        FORCE,
        (curve[0][0], curve[-1][0]),
        {path: present},
        {FORCE: before},
        next_findings=next_findings,
        applied={path: applied},
        judge=Judge((path,), at),
    )


def _sampled_force(contact: ContactForce, angles: Angles) -> Callable[[float], float]:
    """Speed [rad/s] -> least of the contact forces [N] sampled over the turn."""
    if contact.has_friction:
        return lambda omega: float(np.nanmin(contact.at_speed(angles, omega)))
    parts = contact.terms(angles)
    return lambda omega: float(parts.force(omega).min())


# -- the closing spring ------------------------------------------------------------------------------------


class _Springs:
    """Designs that differ in the closing spring; values in the unit of the file.

    The search is for the least *effort*: preload, rate, diameter of the wire, or the compression of an installed valve spring.
    """

    def __init__(self, design: Design, contact_limit: ContactLimit) -> None:
        self.design, self.contact_limit = design, contact_limit
        self.study = Study(design)
        self.program = self.study.program
        self.is_typed = has(design, INSTALLED)
        self.preload = INSTALLED if self.is_typed else next((path for path in PRELOADS if has(design, path)), "")
        self.rate = WIRE if self.is_typed else next(path for path in SPRING_RATES if has(design, path))
        self._free = design.drive.loads.valve_springs[0].free_mm if self.is_typed else 0.0
        self.at = lru_cache(maxsize=4)(lambda angles: (self.study.at(angles).linkage, self.study.at(angles).cam))

    def effort(self, path: str, value: float) -> float:
        """Effort of a field's value, and the value of an effort: of the installed length the free length less this one."""
        return self._free - value if path == INSTALLED else value

    def present(self, path: str) -> float:
        """Effort of the present design."""
        return self.effort(path, get(self.design, path))

    def with_values(self, values: Mapping[str, float]) -> Design:
        design = self.design
        for path, value in values.items():
            design = edited(design, path, value)
        return design

    def contact(self, values: Mapping[str, float]) -> ContactForce:
        drive = self.with_values(values).drive
        loading = loading_of(drive.mechanism, drive.loads, self.study.mechanism, self.study.lash)
        return ContactForce(self.at, loading, self.program, self.study.omega)

    def limit(self, values: Mapping[str, float]) -> tuple[float, str]:
        """Least force [N] that is required with these values, and the reason."""
        stated = self.contact_limit.force is not None
        return self.contact_limit.limit(0.0 if stated else self.contact(values).greatest(self.contact_limit.high))

    def spare(self, values: Mapping[str, float]) -> float:
        """Excess [N] of the least force over the required one, refined."""
        return self.contact(values).least(self.contact_limit.high).value - self.limit(values)[0]

    def needed(self, path: str, others: Mapping[str, float]) -> float:
        """Least sufficient effort of a field with these values of the others; infinite where none suffices.

        The excess force is a concave function of the effort, or nearly so: its root is computed by samples first, then
        refined.
        """
        near = self.rough(path, others)
        if not math.isfinite(near):
            return math.inf

        def spare(effort: float) -> float:
            return self.spare({**others, path: self.effort(path, effort)})

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
        """Least sufficient effort of a field, by samples of the turn."""
        angles, high = piecewise_angles(self.program), self.contact_limit.high

        def spare(effort: float) -> float:
            least, largest = self.contact({**others, path: self.effort(path, effort)}).sampled(angles, high)
            return least - (self.contact_limit.limit(largest)[0])

        bad, good, first = 0.0, abs(self.present(path)) or 1.0, spare(0.0)
        if first >= 0.0:
            return 0.0
        last = spare(good)
        while last < 0.0:
            grown = spare(GROWTH * good)
            if good > MOST:
                return math.inf
            if grown <= last:  # beyond the maximum
                top, least = bounded_minimum(lambda value: -spare(value), bad, GROWTH * good, ROUGH * good)
                if least > 0.0:
                    return math.inf
                good, last = top, -least
                break
            bad, first, good, last = good, last, GROWTH * good, grown
        return bracketed_root(spare, BracketEnds(bad, first, good, last), 0.1 * ROUGH * good).b

    def stalled(self, path: str) -> LeastForce:
        """Least force with the value beyond which a larger one does not increase this force."""

        def least(effort: float) -> LeastForce:
            return self.contact({path: self.effort(path, effort)}).least(self.contact_limit.high)

        value = abs(self.present(path)) or 1.0
        worst = least(value)
        while value <= MOST:
            value *= GROWTH
            grown = least(value)
            if grown.value <= worst.value + TOLERANCE * abs(worst.value):
                return worst
            worst = grown
        return worst

    def trade(self, around: float) -> list[tuple[float, float]]:
        """Rates with the least sufficient preload of each; around: a rate within the curve."""
        most = RATE_RANGE * max(around, get(self.design, self.rate)) or self._typical_rate()
        rates = np.linspace(0.0, most, FEWER if self.contact({}).has_friction else RATES).tolist()
        return [(rate, self.rough(self.preload, {self.rate: rate})) for rate in rates]

    def _typical_rate(self) -> float:
        """Rate whose force at the largest motion is the preload required without it; 1 where none is required."""
        stroke = float(np.abs(self.study.at(piecewise_angles(self.program)).motion.displacement[0]).max())
        stroke *= 1e3 if self.rate == SPRING_RATES[0] else 1.0
        needed = self.needed(self.preload, {self.rate: 0.0})
        return needed / stroke if stroke and math.isfinite(needed) and needed else 1.0


def _spring(design: Design, path: str, request: ContactRequest, checked: FindingsCheck) -> Solution:
    """Least preload for the present rate, or least rate for the present preload."""
    springs = _Springs(design, request.contact)
    needed, present = springs.needed(path, {}), springs.present(path)
    violations: tuple[str, ...] = ()
    next_findings: tuple[str, ...] = ()
    low, most = sorted(springs.effort(path, bound) for bound in (request.low, request.most))
    why = request.why
    if path == WIRE:
        slender = design.drive.loads.valve_springs[0].coil_mm / SLENDER
        thinnest, reason = (
            (slender, f"its coil is {SLENDER:g} wires wide") if slender < present else (present, "present")
        )
        low, why = (min(thinnest, most), f" ({reason})") if low < thinnest else (low, why)
    effort = min(max(needed, low), most)

    def values_at(effort: float) -> dict[str, float]:
        return {path: springs.effort(path, effort)}

    def at(values: Mapping[str, float]) -> Judgement:
        least, (limit, reason) = springs.contact(values).least(request.contact.high), springs.limit(values)
        short = () if springs.spare(values) >= 0.0 else (_force_text(least, limit, reason),)
        texts = (*out_of_bounds(values, {path: (request.low, request.most)}), *short)
        new_design = springs.with_values(values)
        return Judgement(new_design, values, {FORCE: least.value}, texts or checked.new(new_design))

    def is_accepted(effort: float, quick: bool = False) -> bool:
        values = values_at(effort)
        return springs.spare(values) >= 0.0 and not checked.new(springs.with_values(values), quick)

    if math.isinf(needed):  # no value is better than the present one
        effort = min(max(present, low), most)
        violations = (_ineffective_text(springs, path, effort),)
    elif effort < needed:
        limit, reason = springs.limit(values_at(effort))
        least = springs.contact(values_at(effort)).least(request.contact.high)
        required = f"{path} = {values_at(needed)[path]:.9g}"
        violations = (f"{_force_text(least, limit, reason)}: it requires {required}",)
    elif next_findings := checked.new(springs.with_values(values_at(effort))):
        more = (
            []
            if checked.has_notes
            else ((effort or abs(present) or 1.0) * GROWTH ** (0.25 * np.arange(1, STEPS))).tolist()
        )
        good = next((x for x in (present, *more) if effort < x <= most and is_accepted(x)), None)
        violations = next_findings
        if good is not None:
            effort, beyond = nearest_accepted(is_accepted, effort, good, checked.tolerance)
            violations, next_findings = (), checked.new(springs.with_values(values_at(beyond)))
    answer = values_at(effort)
    value = answer[path]
    least, (limit, reason) = springs.contact(answer).least(request.contact.high), springs.limit(answer)
    end = f"{path} = {value:.9g}{why}" if (effort > needed or not effort) and not next_findings else ""
    second_field = "" if springs.is_typed else springs.rate if path == springs.preload else springs.preload
    reached = {FORCE: least.value}
    before = {FORCE: springs.contact({}).least(request.contact.high).value, speed_path(design): design.speed_rpm}
    if second_field:
        curve = [(p, rate) for rate, p in springs.trade(0.0)] if path == springs.preload else springs.trade(value)
        reached[second_field] = before[second_field] = get(design, second_field)
        if not violations and not end:  # the solution is on the curve
            curve = sorted(
                [*curve, (value, get(design, second_field))], key=lambda point: point[0 if path == springs.rate else 1]
            )
    else:
        angles = piecewise_angles(springs.program)
        efforts = np.linspace(0.0, RATE_RANGE * max(effort, present) or 1.0, RATES).tolist()
        values = sorted(springs.effort(path, x) for x in efforts)
        curve = [(x, springs.contact({path: x}).sampled(angles, request.contact.high)[0]) for x in values]
    finite = tuple((x, y) for x, y in curve if math.isfinite(x) and math.isfinite(y))
    present_value = get(design, path)
    ends = [value, present_value, *(x for x, _ in finite)]
    return Solution(
        CAM_SEARCHES["preload" if path == springs.preload else "spring"].target,
        springs.with_values(answer),
        answer,
        reached,
        {FORCE: limit},
        finite,
        second_field or FORCE,
        (min(ends), max(ends)),
        {path: present_value},
        before,
        violations,
        end,
        reasons={FORCE: reason} if reason else {},
        next_findings=() if violations else next_findings,
        judge=Judge((path,), at),
    )


def _ineffective_text(springs: _Springs, path: str, effort: float) -> str:
    """Text for a search in which no value suffices, with the preload that would with this rate."""
    worst, value = springs.stalled(path), springs.effort(path, effort)
    limit, _ = springs.limit({path: value})
    text = (
        f"contact force {result_text(worst.value, 5)} N at {result_text(math.degrees(worst.theta), 5)} deg, limit "
        f"{result_text(limit, 5)} N: the spring's "
    )
    if path == springs.preload or not springs.preload:
        return f"{text}force does not help there"
    needed = springs.effort(springs.preload, springs.needed(springs.preload, {path: value}))
    required = f"; with this rate it requires {springs.preload} = {needed:.9g}" if math.isfinite(needed) else ""
    return f"{text}rate adds nothing where the motion is 0{required}"


# -- remedies of findings ---------------------------------------------------------------------------------------


def remedy_of(design: Design, finding: Finding) -> Remedy:
    """Remedy of a finding with its field; without a search that is not available for the design."""
    row, drive_field = finding.remedy, drive_in(design, finding.field)
    path = finding.field if drive_field is None else drive_field[1]
    of_drive = () if drive_field is None else available_searches(only(design, drive_field[0]))
    if row.find and not (row.of in ("", path) and row.find in (*available_shaft_searches(design), *of_drive)):
        row = Remedy()
    field = row.field if drive_field is None or not row.field else path_in(design, drive_field[0], row.field)
    return row._replace(field=field or finding.field)


# -- all searches -----------------------------------------------------------------------------------------------


SEARCHES: Mapping[str, str] = MappingProxyType(
    {what: row.help for what, row in CAM_SEARCHES.items()} | {what: row.help for what, row in SHAFT_SEARCHES.items()}
)
"""Key of a search -> its help."""


def find(
    design: Design,
    what: str,
    stated: StatedLimits,
    *,
    aim: str = "peak",
    machine: MachineOf = same_design,
    rounding: float | None = None,
    **options: Any,
) -> Solution:
    """Solve a search of one drive or of a shaft, with the machine it belongs to.

    Parameters
    ----------
    design : Design
    what : str
        Key of ``SEARCHES``.
    stated : dict
        Key of a limit, or path of a field with _min or _max -> value; None removes the limit.
    aim : str
        Quantity that the phases of a shaft minimise.
    machine : callable
        Design -> the machine that contains it.
    rounding : float or None
        Step to which the values are rounded, each in its unit; 0: that of each field; None: exact values.
    **options
        `choice` and `notify` of ``search.find``.

    Returns
    -------
    Solution

    Raises
    ------
    KindynaError
        Where the search or a limit does not exist, or no value gives a cam.
    """
    if what not in SEARCHES:
        raise KindynaError(f"find {what!r}: unknown; allowed: {' | '.join(SEARCHES)}")
    if what in SHAFT_SEARCHES:
        solution = find_on_shaft(design, what, stated, aim)
    elif CAM_SEARCHES[what].seeks_contact:
        solution = find_for_contact(design, what, stated, machine)
    else:
        solution = search.find(design, what, stated, machine=machine, **options)
    if what != "flywheel":
        solution = _with_flywheel(solution, machine(design), machine(solution.design))
    return solution if rounding is None else round_solution(solution, design, rounding, machine)


def round_solution(solution: Solution, design: Design, step: float = 0.0, machine: MachineOf = same_design) -> Solution:
    """Return the solution of a search in a design with rounded values, with the flywheel that these make necessary.

    Parameters
    ----------
    solution : Solution
    design : Design
        In which it was found.
    step : float
        Step of the values, each in its unit; 0: that of each field.
    machine : callable
        Design -> the machine that contains it.
    """
    result = rounded(solution, step)
    if TORQUE in result.cost and math.isfinite(torque := cam_torque(design)):
        result = replace(result, before={**result.before, TORQUE: torque})
    return (
        _with_flywheel(result, machine(design), machine(result.design), rounded_flywheel) if result.rounding else result
    )


def _with_flywheel(
    solution: Solution, before: Design, machine: Design, size: Callable[[float], float] | None = None
) -> Solution:
    """Add the machine to a solution, with the flywheel that the solution makes necessary.

    This is where the speed of the machine fluctuates beyond its limit with the solution, and within it before. ``size``
    rounds its inertia up.
    """
    if solution.is_valid and not solution.notes and has_uneven_speed(machine) and not has_uneven_speed(before):
        complete, wheel = with_least_flywheel(machine, size)
        design = complete if machine == solution.design else solution.design
        return replace(solution, design=design, complete=complete, applied={**solution.applied, **wheel})
    return replace(solution, complete=machine)
