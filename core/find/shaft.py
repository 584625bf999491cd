"""Searches for a complete shaft: its flywheel, the phases of its drives, the spring of its balance cam."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.cam import PRESSURE_LIMITS
from core.design import (
    Balancer,
    Design,
    Drive,
    Info,
    Shaft,
    distances,
    get,
    is_assumed,
    numbered,
    only,
    path_of,
    with_phase,
)
from core.design.camshaft import drive_of
from core.design.parts import LINEAR, ROTARY
from core.errors import KindynaError, NoSolution
from core.find.offer import StatedLimits
from core.find.search import Solution
from core.find.trial import PRESSURE_ANGLES, FindingsCheck, TrialDesigns, nearest_accepted
from core.number_text import result_text
from core.numerics.roots import BracketEnds, bounded_minimum, bracketed_root
from core.shaft import (
    AIMS,
    LoadCurve,
    Spacing,
    aim_along,
    balance_drives,
    best_phases,
    fluctuation_with,
    inertia_by_energy,
    inertia_for,
    is_even,
    motor_inertia,
    with_balancer,
)
from core.shaft.flywheel import ROUNDING, energy_range
from core.study import Study, extremes_of
from core.study.drive_forces import best_servo_ratio, servo_part, servo_turn
from core.study.limits import ANY_PRESSURE, CONVEX, LIMITS
from core.study.quantities import has_motor

FLYWHEEL, FLUCTUATION, SLOPE = (
    "shaft.flywheel_inertia_kg_m2",
    "shaft.speed_fluctuation",
    "shaft.motor_slope_nm_s_per_rad",
)
RATE, PRELOAD = "balancer.spring_rate_n_per_mm", "balancer.preload_n"
FORCE = "loads.least_contact_force_n"
ENDS = ("_min", "_max")
TOLERANCE = 1e-9  # of a limit, relative to it
RISE, LEAST_RISE = "balancer.force_rise", 0.25  # of the preload; see ``EXTRA``
RATES = np.exp(np.linspace(0.0, 8.0, 9))  # trial rates, times the softest rate
SCARCE = 0.1  # least of these rates, relative to F0²/(2ΔE), where the softest rate is 0
N_PER_MM = 1e3  # N/m
FINEST, LAST = 1e-2, 1e-9  # tolerance of the preload: of the curve, of the solution
FLAT = 1e-6  # tolerance of the rate with the least preload
STIFFEST = 1e7  # times the softest
GROWTH, MOST = 1.6, 1e7  # factor of a step towards a sufficient preload; its maximum, times the least
CURVE = 73


EXTRA: Mapping[str, Info] = MappingProxyType({
    RISE: Info("Force rise", "of the spring over the stroke, part of its preload: with a quarter it is "
               "compressed by four strokes before it works", 0.0, optional=True)
})  # fmt: skip
"""Limits that are no fields of a design."""


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


class ShaftRow(NamedTuple):
    """A search for a complete shaft.

    Attributes
    ----------
    title : str
        Heading.
    paths : tuple of str
        Beginnings of the paths whose bounds the user may state.
    limits : tuple of str
        Keys of the balance cam's limits.
    search : callable
    help : str
    is_available : callable
        Whether a design has the part searched for.
    default_limits : callable
        Keys of the limits for a design, with their default values, None where there is none.
    aims : dict
        Quantities one of which is minimised, where there is a choice.
    """

    title: str
    paths: tuple[str, ...]
    limits: tuple[str, ...]
    search: Callable[[Design, ShaftRequest], Solution]
    help: str
    is_available: Callable[[Design], bool]
    default_limits: Callable[[Design], Mapping[str, float | None]]
    aims: Mapping[str, str] = MappingProxyType({})


def available_shaft_searches(design: Design) -> tuple[str, ...]:
    """Keys of ``SHAFT_SEARCHES`` that are available for a design."""
    return tuple(what for what, row in SHAFT_SEARCHES.items() if row.is_available(design))


def _wheel_keys(design: Design) -> Mapping[str, float | None]:
    return {
        f"{FLUCTUATION}_max": design.camshaft.speed_fluctuation,
        **dict.fromkeys(f"{FLYWHEEL}{end}" for end in ENDS),
    }


def _spring_keys(design: Design) -> Mapping[str, float | None]:
    paths = (RATE, PRELOAD)
    return {
        ANY_PRESSURE: min(PRESSURE_LIMITS.values()),
        f"{RISE}_min": LEAST_RISE,
        **dict.fromkeys((f"{FORCE}_min", *(f"{p}{end}" for p in paths for end in ENDS))),
        **dict.fromkeys(key for key in LIMITS if key != ANY_PRESSURE),
    }


def find_on_shaft(design: Design, what: str, stated: StatedLimits, aim: str = "peak") -> Solution:
    """Solve a search of ``SHAFT_SEARCHES``; stated as in ``find``, aim of the phases a key of ``AIMS``.

    Raises
    ------
    KindynaError
        Where the search is not available for the design, or it has no such limit.
    """
    row = SHAFT_SEARCHES[what]
    if design.shaft is None:
        raise KindynaError(f"find {what}: this design has no shaft; allowed: one with [shaft]")
    if aim not in AIMS:
        raise KindynaError(f"find {what} for {aim!r}: unknown; allowed: {' | '.join(AIMS)}")
    bounds: dict[str, tuple[float, float]] = {}
    limits: dict[str, float] = {}
    for key, value in {**_unstated(row.default_limits(design), stated), **stated}.items():
        if value is None:
            continue
        path, end = key[:-4], key[-4:]
        if key in row.limits:
            limits[key] = value
        elif end in ENDS and path.startswith(row.paths):
            low, high = bounds.get(path, (-math.inf, math.inf))
            bounds[path] = (value, high) if end == ENDS[0] else (low, value)
            if bounds[path][0] > bounds[path][1]:
                raise KindynaError(f"limit {path}_min = {bounds[path][0]:g}: is above {path}_max = {bounds[path][1]:g}")
        else:
            allowed = " | ".join((*row.limits, *(f"{path} with _min or _max" for path in row.paths)))
            raise KindynaError(f"limit {key!r}: {what} has none of that name; allowed: {allowed}")
    return row.search(design, ShaftRequest(bounds, limits, aim))


def _unstated(defaults: StatedLimits, stated: StatedLimits) -> StatedLimits:
    """Default limits that are not stated; a stated limit of rise or return also replaces that of the full turn."""
    unstated = {key: value for key, value in defaults.items() if key not in stated}
    if not stated.keys().isdisjoint(PRESSURE_ANGLES):
        unstated.pop(ANY_PRESSURE, None)
    return unstated


def _solution(
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


# -- gear of a servo ---------------------------------------------------------------------------------------

RATIO, RMS = "servo.gear_ratio", "servo.rms_nm"


def _geared_drives(design: Design) -> dict[int, Study]:
    """Studies of the drives whose servo has a rotor and a gear, by their number."""
    servos = {i: drive.servo for i, drive in enumerate(design.drives) if drive.servo is not None}
    return {i: Study(only(design, i)) for i, servo in servos.items() if servo.rotor_inertia_kg_m2 > 0.0}


def _gear_ratio(design: Design, request: ShaftRequest) -> Solution:
    """Gear ratio of least rms torque of each servo, limited by its motor's rated speed."""
    geared = _geared_drives(design)
    if all(drive.servo is None or drive.servo.kind == LINEAR for drive in design.drives):
        raise KindynaError(
            f'find gear-ratio: this design has no motor with a gear; allowed: [servo] with kind = "{ROTARY}"'
        )
    if not geared:
        raise KindynaError(
            "servo.rotor_inertia_kg_m2: without a rotor's inertia the torque falls with every larger ratio; state it"
        )
    changed, answer, reached, before, ends = design, {}, {}, {}, []
    curve: list[tuple[float, float]] = []
    for i, study in geared.items():
        path, rms_path = path_of(i, RATIO) if design.listed else RATIO, path_of(i, RMS) if design.listed else RMS
        servo = servo_part(study)

        def rms(ratio: float, study: Study = study, servo: Any = servo) -> float:
            drive = replace(study.design.drive, servo=replace(servo, gear_ratio=ratio))
            return servo_turn(Study(replace(study.design, drives=(drive,)))).rms

        best = best_servo_ratio(study)
        if not math.isfinite(best) or best <= 0.0:
            raise KindynaError(f"{path}: nothing is accelerated, or nothing loads the motor; there is no best ratio")
        fastest = extremes_of(study, "dynamics", ("servo_speed",))["servo_speed"]
        speed = max(abs(fastest.low.value), abs(fastest.high.value)) * 30.0 / math.pi / servo.gear_ratio
        most = math.inf if servo.rated_rpm is None else servo.rated_rpm / speed
        ratio = min(max(best, request.low(path, 0.0)), min(request.high(path), most))
        if ratio == most and most < best:
            ends.append(
                f"{path} = {ratio:.9g}, where the motor reaches its rated speed; without that {result_text(best, 6)}"
            )
        answer[path], reached[rms_path], before[rms_path] = ratio, rms(ratio), rms(servo.gear_ratio)
        curve = curve or [(x, rms(x)) for x in sorted({*(best * np.exp(np.linspace(-1.4, 1.4, 15))).tolist(), ratio})]
        drives = list(changed.drives)
        drives[i] = replace(drives[i], servo=replace(servo, gear_ratio=ratio))
        changed = replace(changed, drives=tuple(drives))
    return _solution(
        "gear ratio of least rms torque",
        design,
        changed,
        answer,
        reached,
        {},
        curve,
        next(iter(reached)),
        (),
        "; ".join(ends),
        before,
    )


def _ratio_keys(design: Design) -> Mapping[str, float | None]:
    paths = [path_of(i, RATIO) if design.listed else RATIO for i in _geared_drives(design)]
    return dict.fromkeys(f"{path}{end}" for path in paths for end in ENDS)


# -- flywheel ----------------------------------------------------------------------------------------------


def _flywheel(design: Design, request: ShaftRequest) -> Solution:
    """Least flywheel with which the true speed fluctuates within its limit."""
    if not design.listed and not has_motor(design):
        raise KindynaError(
            "find flywheel: no shaft drives this design at constant speed; allowed: a cam, a crank, [[drives]]"
        )
    shaft = design.camshaft
    limit = request.high(FLUCTUATION, shaft.speed_fluctuation)
    if not limit > 0.0:
        raise KindynaError(f"limit {FLUCTUATION}_max = {limit:g}: outside its range; allowed: > 0")
    load, of_motor = Study(design).camshaft.load, motor_inertia(shaft)

    def fluctuation(inertia: float) -> float:
        return fluctuation_with(load, shaft, inertia + of_motor)

    needed = _least_inertia(load, shaft, limit)
    inertia = min(max(needed, request.low(FLYWHEEL, 0.0)), request.high(FLYWHEEL))
    reached = fluctuation(inertia)
    violations: tuple[str, ...] = ()
    if reached > limit * (1.0 + TOLERANCE):
        text = (
            "the motor stalls"
            if reached == math.inf
            else f"speed fluctuation {result_text(reached, 5)}, limit {limit:g}"
        )
        violations = (f"{text}: it requires {result_text(needed)} kg·m²",)
    around = (needed or inertia or inertia_by_energy(load, shaft, limit) or 1.0) * np.exp(np.linspace(-1.4, 1.4, 25))
    curve = [(i, fluctuation(i)) for i in sorted({*around.tolist(), inertia})]
    end = f"{FLYWHEEL} = {inertia:.9g}" if (inertia != needed or not inertia) and not violations else ""
    changed = replace(design, shaft=replace(shaft, flywheel_inertia_kg_m2=inertia))
    before = {FLUCTUATION: fluctuation(shaft.flywheel_inertia_kg_m2)}
    solution = _solution(
        "least flywheel",
        design,
        changed,
        {FLYWHEEL: inertia},
        {FLUCTUATION: reached},
        {FLUCTUATION: limit},
        curve,
        FLUCTUATION,
        violations,
        end,
        before,
    )
    return replace(solution, assumed={SLOPE: shaft.motor_slope_nm_s_per_rad} if is_assumed(design, SLOPE) else {})


def _least_inertia(load: LoadCurve, shaft: Shaft, limit: float) -> float:
    """Least flywheel inertia [kg m²] for a limit of the speed fluctuation. Raises KindynaError where none suffices."""
    needed = max(inertia_for(load, shaft, limit) - motor_inertia(shaft), 0.0)
    if needed == math.inf:
        raise KindynaError(f"no flywheel keeps a speed fluctuation of {limit:g}: lower the load, or allow more")
    return needed


def with_least_flywheel(design: Design) -> tuple[Design, Mapping[str, float]]:
    """Return the design with its least flywheel, and the value by its path. Raises KindynaError where none suffices."""
    shaft = design.camshaft
    needed = _least_inertia(Study(design).camshaft.load, shaft, shaft.speed_fluctuation)
    return replace(design, shaft=replace(shaft, flywheel_inertia_kg_m2=needed)), {FLYWHEEL: needed}


# -- phases ------------------------------------------------------------------------------------------------

REACHED: Mapping[str, str] = MappingProxyType(
    {"peak": "peak_torque_nm", "rms": "rms_torque_nm", "fluctuation": "energy_swing_j"}
)


def _phases(design: Design, request: ShaftRequest) -> Solution:
    """Phases of least peak torque, rms torque or energy swing that satisfy the timing; the first drive is fixed."""
    if len(design.drives) < 2:
        raise KindynaError("find phases: this design has one drive alone; allowed: two or more under [[drives]]")
    study = Study(replace(design, balancer=None)).camshaft
    numbers = [study.drive_number(name) for name in study.loading_drives]
    index = {number: i for i, number in enumerate(numbers)}  # drives that do not load the shaft move with the first
    spacings = [
        Spacing(
            index.get(numbered(design, drive_of(row.first)), 0),
            index.get(numbered(design, drive_of(row.second)), 0),
            math.radians(at.spare_deg),
        )
        for row, at in zip(design.timing, distances(design), strict=True)
    ]
    for i, number in enumerate(numbers):
        path, present = f"drives[{number}].phase_deg", design.drives[number].phase_deg
        for side, bound in ((1.0, request.low(path)), (-1.0, request.high(path))):
            if math.isfinite(bound):
                spare = math.radians((side * (present - bound) + 180.0) % 360.0 - 180.0)
                spacings.append(Spacing(0, i, spare) if side > 0.0 else Spacing(i, 0, spare))
    loads = [study.drive_load(name) for name in study.loading_drives]
    shifts = best_phases(loads, spacings, request.aim).rotations
    checked = FindingsCheck(replace(design, balancer=None))

    def shifted(shifts: np.ndarray) -> tuple[Design, dict[str, float]]:
        changed, answer = replace(design, balancer=None), {}
        for number, shift in zip(numbers[1:], shifts[1:].tolist(), strict=True):
            phase = (design.drives[number].phase_deg + math.degrees(shift)) % 360.0
            changed, answer[f"drives[{number}].phase_deg"] = with_phase(changed, number, phase), phase
        return changed, answer

    if next_findings := checked.new(shifted(shifts)[0]):  # as far towards them as the machine has no new finding
        direction = (shifts + math.pi) % (2.0 * math.pi) - math.pi
        part, beyond = nearest_accepted(
            lambda part, quick: not checked.new(shifted(part * direction)[0], quick), 1.0, 0.0, checked.tolerance
        )
        shifts, next_findings = part * direction, checked.new(shifted(beyond * direction)[0])
    changed, answer = shifted(shifts)
    changed = replace(changed, balancer=design.balancer)
    steps = np.arange(CURVE) * (2.0 * math.pi / (CURVE - 1))
    line = aim_along(loads, shifts, 1, steps, request.aim)
    first = design.drives[numbers[1]].phase_deg + np.rad2deg(shifts[1] + steps)
    curve = sorted(zip(np.mod(first, 360.0).tolist(), line.tolist(), strict=True))
    reached, before = _phase_readings(changed), _phase_readings(design)
    limits = {f"timing[{i}].least_deg": row.least_deg for i, row in enumerate(design.timing)}
    title, figure = f"phases of least {request.aim}", REACHED[request.aim]
    solution = _solution(title, design, changed, answer, reached, limits, curve, figure, reached_before=before)
    return replace(solution, next_findings=next_findings)


def _phase_readings(design: Design) -> Mapping[str, float]:
    """Torque and energy of the cams of a design, and the distances of its timing."""
    total = Study(replace(design, balancer=None)).camshaft
    return {
        "peak_torque_nm": abs(total.peak_torque.value),
        "rms_torque_nm": total.rms_torque,
        "energy_swing_j": total.flywheel.energy_swing,
        **{f"timing[{i}].least_deg": at.after_deg for i, at in enumerate(distances(design))},
    }


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


def _balancer(design: Design, request: ShaftRequest) -> Solution:
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
    bounds = (request.low(RATE), request.high(RATE), stiffest)
    return _spring_solution(trials, rate, preload, curve, (), f"{RATE} = {rate:.9g}" if rate in bounds else "")


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
    return _solution(
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
    return _spring_solution(trials, best, most, (), tuple(violations), "")


SHAFT_SEARCHES: Mapping[str, ShaftRow] = MappingProxyType(
    {
        "flywheel": ShaftRow(
            "Least flywheel", (FLYWHEEL, FLUCTUATION), (), _flywheel,
            "the least flywheel for the allowed fluctuation of speed",
            lambda design: design.shaft is not None and any(drive.loads_shaft for drive in design.drives), _wheel_keys,
        ),
        "gear-ratio": ShaftRow(
            "Gear ratio of the servo", (RATIO, "drives["), (), _gear_ratio,
            "the gear ratio of the servo with the least rms torque of its motor, within its rated speed",
            lambda design: any(drive.servo is not None and drive.servo.kind == ROTARY for drive in design.drives),
            _ratio_keys,
        ),
        "phases": ShaftRow(
            "Best phases", ("drives[",), (), _phases,
            "the phases of least peak torque that keep the timing; --for rms or fluctuation: least of these",
            lambda design: len(design.drives) > 1,
            lambda design: dict.fromkeys(f"drives[{i}].phase_deg{end}" for i in range(1, len(design.drives)) for end in ENDS),
            MappingProxyType(
                {"peak": "Least peak torque", "rms": "Least RMS torque", "fluctuation": "Least fluctuation"}
            ),
        ),
        "balancer": ShaftRow(
            "Spring of the balance cam", (RATE, PRELOAD, FORCE, "balancer.least_contact_force_n", RISE), tuple(LIMITS),
            _balancer,
            "the spring of least preload with a least contact force, and of such springs the softest whose force rises "
            f"by {LEAST_RISE:g} of the preload ({RISE}_min); "
            f"a softer one would be preloaded by more than {1.0 / LEAST_RISE:g} strokes",
            lambda design: design.balancer is not None, _spring_keys,
        ),
    }
)  # fmt: skip
