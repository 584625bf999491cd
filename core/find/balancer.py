"""Search for the spring of a balance cam, and the request and solution of every search for a complete shaft."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from core.design import Balancer, Design, Drive, Shaft, get
from core.errors import KindynaError, NoSolution
from core.find.solution import Judge, Judgement, Solution, out_of_bounds
from core.find.trial import TrialDesigns
from core.number_text import result_text
from core.numerics.roots import BracketEnds, bounded_minimum, bracketed_root
from core.shaft import LoadCurve, balance_drives, is_even, with_balancer
from core.shaft.flywheel import ROUNDING, energy_range
from core.study import Study, extremes_of
from core.study.limits import CONVEX

RATE, PRELOAD = "balancer.spring_rate_n_per_mm", "balancer.preload_n"
FORCE = "loads.least_contact_force_n"
RISE, LEAST_RISE = "balancer.force_rise", 0.25  # of the preload; see ``EXTRA``
RATES = np.exp(np.linspace(0.0, 8.0, 9))  # trial rates, times the softest rate
SCARCE = 0.1  # least of these rates, relative to F0²/(2ΔE), where the softest rate is 0
N_PER_MM = 1e3  # N/m
FINEST, LAST = 1e-2, 1e-9  # tolerance of the preload: of the curve, of the solution
FLAT = 1e-6  # tolerance of the rate with the least preload
STIFFEST = 1e7  # times the softest
GROWTH, MOST = 1.6, 1e7  # factor of a step towards a sufficient preload; its maximum, times the least


# -- requests and solutions of a shaft ------------------------------------------------------------


class ShaftRequest(NamedTuple):
    """Bounds of fields, limits of the balance cam, and the property of the torque that a search minimises."""

    bounds: Mapping[str, tuple[float, float]]
    limits: Mapping[str, float]
    aim: str

    def low(self, path: str, otherwise: float = -math.inf) -> float:
        """Stated lower bound of a field, in the unit of the file."""
        bound = self.bounds.get(path, (-math.inf, math.inf))[0]
        return otherwise if bound == -math.inf else bound

    def high(self, path: str, otherwise: float = math.inf) -> float:
        """Stated upper bound of a field, in the unit of the file."""
        bound = self.bounds.get(path, (-math.inf, math.inf))[1]
        return otherwise if bound == math.inf else bound


def shaft_solution(
    target: str,
    before: Design,
    design: Design,
    answer: Mapping[str, float],
    reached: Mapping[str, float],
    limits: Mapping[str, float],
    curve: Sequence[tuple[float, float]],
    curve_of: str,
    violations: tuple[str, ...] = (),
    end: str = "",
    reached_before: Mapping[str, float] = MappingProxyType({}),
) -> Solution:
    """Solution with the finite points of the curve, one for each value; reached_before: with the present values."""
    points = dict(sorted((float(x), float(y)) for x, y in curve if math.isfinite(y)))
    first = next(iter(answer.values()), 0.0)
    near = (min(points, default=first), max(points, default=first))
    is_new = before.balancer is None  # then the search added a balance cam
    present = {path: None if is_new and path in (RATE, PRELOAD) else get(before, path) for path in answer}
    return Solution(
        target,
        design,
        answer,
        reached,
        limits,
        tuple(points.items()),
        curve_of,
        near,
        present,
        reached_before,
        violations,
        end,
    )


# -- balancer ----------------------------------------------------------------------------------------------


class _BalanceCams(TrialDesigns):
    """Trial balance cams of one torque by spring rate [N/mm] and preload [N]."""

    def __init__(
        self, before: Design, design: Design, limits: Mapping[str, float | None], force: float, rise: float
    ) -> None:
        super().__init__(design, (RATE, PRELOAD), limits)
        assert design.balancer is not None
        self.before, self.balancer, self.force, self.rise = before, design.balancer, force, rise
        self.growth = (1.0 + rise) ** 2 - 1.0
        self._prepared: Mapping[tuple[float, float], Drive | NoSolution] = {}
        self._last: Mapping[tuple[float, float], Drive | NoSolution] = {}
        self._forces: dict[tuple[float, float], float] = {}

    @cached_property
    def load(self) -> LoadCurve:
        return Study(self.design).camshaft.cams_load

    @cached_property
    def swing(self) -> float:
        """Energy that the spring stores [J]."""
        low, high = energy_range(self.load)
        return high - low

    def most_preload(self, rate: float) -> float:
        """Greatest preload [N] with which the force still rises enough."""
        most = 2.0 * self.swing * N_PER_MM * rate * (1.0 + ROUNDING)
        return math.sqrt(most / self.growth) if self.growth else math.inf

    def rise_of(self, rate: float, preload: float) -> float:
        """Rise of the force as a part of the preload."""
        return math.sqrt(1.0 + 2.0 * rate * N_PER_MM * self.swing / preload / preload) - 1.0

    def part(self, rate: float, preload: float) -> Balancer:
        return replace(self.balancer, spring_rate_n_per_mm=rate, preload_n=preload)

    def prepare(self, values: Sequence[tuple[float, float]]) -> None:
        """Design the cams of these rates and preloads together."""
        self._prepared = self._design_cams(values)

    def _design_cams(self, values: Sequence[tuple[float, float]]) -> Mapping[tuple[float, float], Drive | NoSolution]:
        parts = [self.part(rate, preload) for rate, preload in values]
        drives = balance_drives(self.load, parts, self.design.camshaft.speed_rpm * math.pi / 30.0)
        return dict(zip(values, drives, strict=True))

    def with_values(self, values: tuple[float, float]) -> Design:  # type: ignore[override]
        if values not in self._prepared and values not in self._last:
            self._last = self._design_cams([values])  # its limits and its least force are evaluated one after the other
        drive = {**self._prepared, **self._last}[values]
        if isinstance(drive, NoSolution):
            raise drive
        shaft = self.design.camshaft
        return Design("balancer", Shaft(shaft.rotation, shaft.speed_rpm), (drive,))

    def least_force(self, rate: float, preload: float) -> float:
        """Least contact force [N]; where the follower has no mass, the preload, which is the least spring force."""
        if not self.balancer.follower_mass_kg:
            return preload
        if (rate, preload) not in self._forces:
            study = Study(self.with_values((rate, preload)))
            self._forces[rate, preload] = extremes_of(study, "dynamics", ("contact_force",))["contact_force"].low.value
        return self._forces[rate, preload]

    def spare(self, rate: float, preload: float, refined: bool = False) -> float:
        """Margin of the tightest limit; -inf where there is no cam."""
        outcome = self.at(rate, preload, refined=refined)
        if not outcome.readings:
            return -math.inf
        if not self.balancer.follower_mass_kg:
            return outcome.margin
        return min(outcome.margin, (self.least_force(rate, preload) - self.force) / preload)


def find_balancer(design: Design, request: ShaftRequest) -> Solution:
    """Least preload with which a spring satisfies the limits of the balance cam and its force rises enough.

    It is not below the stated force, else the present preload; of several springs it is the softest. A design without a
    balance cam is searched with a first guess of one.

    The force of a spring of rate K that stores the energy swing ΔE rises from F0 to √(F0² + 2KΔE): by r of F0 from
    K = F0²((1 + r)² - 1)/(2ΔE) on. There the search begins, whatever the present rate.
    """
    if not design.listed:
        raise KindynaError("find balancer: this design has one drive alone; allowed: drives under [[drives]]")
    balanced = design if design.balancer is not None else with_balancer(design, Study(design).flywheel.energy_swing)
    part = balanced.balancer
    assert part is not None
    force = max(request.low(FORCE, 0.0), request.low("balancer.least_contact_force_n", 0.0), 0.0)
    least = max(force, request.low(PRELOAD, 0.0)) or part.preload_n
    most = request.high(PRELOAD, least * MOST)
    if least > most:
        raise KindynaError(f"limit {PRELOAD}_max = {most:g}: is below the force {least:g} N that the spring must keep")
    trials = _BalanceCams(design, balanced, {CONVEX: None, **request.limits}, force, request.low(RISE, 0.0))
    if is_even(trials.load):
        raise KindynaError(
            "find balancer: the torque is constant, so that there is nothing to balance; leave the balance cam out"
        )
    scale = least * least / (2.0 * trials.swing * N_PER_MM)
    softest = max(scale * trials.growth, request.low(RATE, 0.0))
    if softest > request.high(RATE):
        return _invalid_solution(trials, [request.high(RATE)], least, most)
    first_rate = max(softest, scale * SCARCE)
    rates = _between(first_rate * RATES, softest, request.high(RATE))

    def preload_of(rate: float, finest: float, near: float, refined: bool = False) -> float:
        return _least_preload(trials, rate, least, min(most, trials.most_preload(rate)), finest, refined, near)

    if part.follower_mass_kg:
        trials.prepare([(rate, least) for rate in rates])
    preloads: list[float] = []
    for rate in rates[::-1]:  # a softer spring usually requires more preload
        preloads.insert(0, preload_of(rate, FINEST, preloads[0] if preloads else least))
    stiffest = min(STIFFEST * first_rate, request.high(RATE))
    while least < preloads[-1] == min(preloads) < math.inf and rates[-1] < stiffest:
        rates.append(min(math.e * rates[-1], stiffest))
        preloads.append(preload_of(rates[-1], FINEST, least))
    if not np.isfinite(preloads).any():
        return _invalid_solution(trials, rates, least, most)
    best = min(preloads)
    first = preloads.index(best)  # the softest of those
    rate = rates[first]
    if best <= least and first:
        rate = _softest(trials, rates[first - 1], rate, best)
    elif best > least and 0 < first < len(rates) - 1:
        rate, _ = bounded_minimum(lambda x: preload_of(x, LAST, 0.0), rates[first - 1], rates[first + 1], FLAT * rate)
    preload = preload_of(rate, LAST, best / GROWTH, refined=True)
    curve = [*zip(rates, preloads, strict=True), (rate, preload)]
    ends = (request.low(RATE), request.high(RATE), stiffest)
    bounds = {RATE: ends[:2], PRELOAD: (least, most)}
    end = f"{RATE} = {rate:.9g}" if rate in ends else ""
    return _spring_solution(trials, rate, preload, curve, (), end, bounds)


def _between(rates: np.ndarray, low: float, high: float) -> list[float]:
    """Trial rates between the bounds, and the bounds."""
    inside = rates[(rates > low) & (rates < high)].tolist()
    ends = [bound for bound in (low, high) if math.isfinite(bound)]
    if len(inside) < 5 and len(ends) == 2:
        inside = np.linspace(low, high, 9)[1:-1].tolist() if high > low else []
    return sorted({*inside, *ends})


def _least_preload(
    trials: _BalanceCams,
    rate: float,
    least: float,
    most: float,
    finest: float,
    refined: bool = False,
    near: float = 0.0,
) -> float:
    """Least preload with which this spring satisfies all limits of the cam, infinite where none does."""

    def spare(preload: float) -> float:
        return trials.spare(rate, preload, refined)

    if most < least:
        return math.inf
    if spare(least) >= 0.0:
        return least
    bad, good = least, min(max(near, least) * GROWTH, most)
    while not spare(good) >= 0.0:
        if good >= most:
            return math.inf
        bad, good = good, min(GROWTH * good, most)
    return bracketed_root(spare, BracketEnds(bad, spare(bad), good, spare(good)), finest * good).b


def _softest(trials: _BalanceCams, bad: float, good: float, preload: float) -> float:
    """Softest spring with which this preload satisfies all limits, between a rate that does not and one that does."""

    def spare(rate: float) -> float:
        return trials.spare(rate, preload, refined=True)

    if spare(bad) >= 0.0:  # at the limit, where only rounding rejected it
        return bad
    if spare(good) < 0.0:
        return good
    return bracketed_root(spare, BracketEnds(bad, spare(bad), good, spare(good)), LAST * good).b


def _spring_solution(
    trials: _BalanceCams,
    rate: float,
    preload: float,
    curve: Sequence[tuple[float, float]],
    violations: tuple[str, ...],
    end: str,
    bounds: Mapping[str, tuple[float, float]],
) -> Solution:
    """Solution with a spring of this rate and preload."""
    outcome = trials.at(rate, preload)
    reached = outcome.reached()
    force = trials.least_force(rate, preload)
    reached |= {FORCE: force, RISE: trials.rise_of(rate, preload)}
    design = replace(trials.design, balancer=trials.part(rate, preload))
    present = trials.balancer.spring_rate_n_per_mm, trials.balancer.preload_n
    readings = () if trials.before.balancer is None else trials.at(*present).readings
    before = {reading.key: reading.reached for reading in readings}
    if before:
        before |= {FORCE: trials.least_force(*present), RISE: trials.rise_of(*present)}
    spring_limits = {key: limit for key, limit in ((FORCE, trials.force), (RISE, trials.rise)) if limit}
    limits = {reading.key: reading.limit for reading in outcome.readings} | spring_limits

    def at(values: Mapping[str, float]) -> Judgement:
        point = values[RATE], values[PRELOAD]
        trial = trials.at(*point)
        if not trial.readings:
            return Judgement(design, values, {}, (trial.problem,))
        readings = trial.reached() | {FORCE: trials.least_force(*point), RISE: trials.rise_of(*point)}
        short = tuple(f"{key} = {readings[key]:.9g}" for key, limit in spring_limits.items() if readings[key] < limit)
        texts = (*out_of_bounds(values, bounds), *short, *(r.text for r in trial.readings if not r.is_satisfied))
        return Judgement(replace(trials.design, balancer=trials.part(*point)), values, readings, texts)

    solution = shaft_solution(
        "least preload",
        trials.before,
        design,
        {RATE: rate, PRELOAD: preload},
        reached,
        limits,
        curve,
        PRELOAD,
        violations,
        end,
        before,
    )
    return replace(solution, judge=Judge((RATE, PRELOAD), at))


def _invalid_solution(trials: _BalanceCams, rates: list[float], least: float, most: float) -> Solution:
    """Best spring where none satisfies every limit, with the limits it violates.

    It is the stiffest one with the preload that satisfies the limits of the cam, else one with the greatest preload.
    """
    preload = _least_preload(trials, rates[-1], least, most, LAST, refined=True)
    best = rates[-1] if preload < math.inf else max(rates, key=lambda rate: trials.spare(rate, most))
    most = min(preload, most)
    outcome = trials.at(best, most)
    if not outcome.readings:
        raise KindynaError(f"no spring balances this torque: {outcome.problem}")
    violations = [reading.text for reading in outcome.readings if not reading.is_satisfied]
    rise = trials.rise_of(best, most)
    if rise < trials.rise:
        violations.append(
            f"its force rises by {result_text(rise)} of the preload, limit {trials.rise:g}: use a stiffer spring"
        )
    force = trials.least_force(best, most)
    if force < trials.force:
        violations.append(
            f"the contact force is too small: least contact force {result_text(force, 5)} N, limit {trials.force:g} N"
        )
    return _spring_solution(trials, best, most, (), tuple(violations), "", {})
