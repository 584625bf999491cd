"""What is sought for a whole shaft: its flywheel, the phases of its drives, the spring of its balance cam."""

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
from core.find.offer import Stated
from core.find.search import Solution
from core.find.trial import NEEDED, FindingsCheck, Trials, nearest
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
KEPT = 1e-9  # by which a limit may be missed, as a part of it
RISE, LEAST_RISE = "balancer.force_rise", 0.25  # of the preload; see ``EXTRA``
RATES = np.exp(np.linspace(0.0, 8.0, 9))  # times the softest, or where that is 0 times
SCARCE = 0.1  # of F0²/(2ΔE)
N_PER_MM = 1e3  # N/m
FINEST, LAST = 1e-2, 1e-9  # of the preload: of the curve, of the answer
FLAT = 1e-6  # of the rate with which the preload is least
STIFFEST = 1e7  # times the softest
GROWTH, MOST = 1.6, 1e7  # steps towards a preload that serves; the most of it, times the least
CURVE = 73


EXTRA: Mapping[str, Info] = MappingProxyType({
    RISE: Info("Force rise", "of the spring over the stroke, part of its preload: with a quarter it is "
               "compressed by four strokes before it works", 0.0, optional=True)
})  # fmt: skip
"""What is limited and is no field of a design."""


class ShaftRequest(NamedTuple):
    """What is asked of a search: bounds of fields, limits of the balance cam, and what of the torque is to be least."""

    bounds: Mapping[str, tuple[float, float]]
    limits: Mapping[str, float]
    aim: str

    def low(self, path: str, otherwise: float = -math.inf) -> float:
        """The lower bound stated for a field, in the unit of the file."""
        found = self.bounds.get(path, (-math.inf, math.inf))[0]
        return otherwise if found == -math.inf else found

    def high(self, path: str, otherwise: float = math.inf) -> float:
        """The upper bound stated for a field, in the unit of the file."""
        found = self.bounds.get(path, (-math.inf, math.inf))[1]
        return otherwise if found == math.inf else found


class ShaftRow(NamedTuple):
    """title as a heading; paths whose bounds may be stated, by their beginnings; limits: keys of the balance cam's limits; search;
    there: whether a design has such a thing; stated: the keys that a design's search takes, with the values that hold where no others
    are stated, None where none does; aims: what may be least, where there is a choice."""

    title: str
    paths: tuple[str, ...]
    limits: tuple[str, ...]
    search: Callable[[Design, ShaftRequest], Solution]
    help: str
    there: Callable[[Design], bool]
    stated: Callable[[Design], Mapping[str, float | None]]
    aims: Mapping[str, str] = MappingProxyType({})


def offered_on_shaft(design: Design) -> tuple[str, ...]:
    """The rows of ``ON_SHAFT`` that a design has something for."""
    return tuple(what for what, row in ON_SHAFT.items() if row.there(design))


def _turns_shaft(design: Design) -> bool:
    return design.shaft is not None and any(drive.loads_shaft for drive in design.drives)


def _wheel_keys(design: Design) -> Mapping[str, float | None]:
    ends = dict.fromkeys(f"{FLYWHEEL}{end}" for end in ENDS)
    return {f"{FLUCTUATION}_max": design.camshaft.speed_fluctuation, **ends}


def _phase_keys(design: Design) -> Mapping[str, float | None]:
    return dict.fromkeys(f"drives[{i}].phase_deg{end}" for i in range(1, len(design.drives)) for end in ENDS)


def _spring_keys(design: Design) -> Mapping[str, float | None]:
    paths = (RATE, PRELOAD)
    return {
        ANY_PRESSURE: min(PRESSURE_LIMITS.values()),
        f"{RISE}_min": LEAST_RISE,
        **dict.fromkeys((f"{FORCE}_min", *(f"{p}{end}" for p in paths for end in ENDS))),
        **dict.fromkeys(key for key in LIMITS if key != ANY_PRESSURE),
    }


def find_on_shaft(design: Design, what: str, stated: Stated, aim: str = "peak") -> Solution:
    """The answer of a row of ``ON_SHAFT``; stated as for ``find``. aim: a key of ``AIMS``, of the phases.

    Raises KindynaError where the design has no such thing, or a limit is none of this search.
    """
    row = ON_SHAFT[what]
    if design.shaft is None:
        raise KindynaError(f"find {what}: this design has no shaft; allowed: one with [shaft]")
    if aim not in AIMS:
        raise KindynaError(f"find {what} for {aim!r}: unknown; allowed: {' | '.join(AIMS)}")
    bounds: dict[str, tuple[float, float]] = {}
    limits: dict[str, float] = {}
    for key, value in {**_defaults(row.stated(design), stated), **stated}.items():
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


def _defaults(usual: Stated, stated: Stated) -> Stated:
    """Of what is not stated; the pressure angle of rise or return stated, that of the whole turn has none."""
    unsaid = {key: value for key, value in usual.items() if key not in stated}
    if not stated.keys().isdisjoint(NEEDED):
        unsaid.pop(ANY_PRESSURE, None)
    return unsaid


def _answered(
    wanted: str,
    before: Design,
    made: Design,
    answer: Mapping[str, float],
    reached: Mapping[str, float],
    limits: Mapping[str, float],
    curve: Sequence[tuple[float, float]],
    curve_of: str,
    against: tuple[str, ...] = (),
    end: str = "",
    reached_before: Mapping[str, float] = MappingProxyType({}),
) -> Solution:
    """A solution; curve: finite points, of which each value is one; reached_before: with the present values."""
    points = dict(sorted((float(x), float(y)) for x, y in curve if math.isfinite(y)))
    first = next(iter(answer.values()), 0.0)
    near = (min(points, default=first), max(points, default=first))
    lacks = before.balancer is None  # then the search began with one of its own
    present = {path: None if lacks and path in (RATE, PRELOAD) else get(before, path) for path in answer}
    return Solution(
        wanted,
        made,
        answer,
        reached,
        limits,
        tuple(points.items()),
        curve_of,
        near,
        present,
        reached_before,
        against,
        end,
    )


def _load(design: Design) -> LoadCurve:
    """Of the whole shaft, or of the one drive. Raises NoSolution."""
    return Study(design).camshaft.load


# -- gear of a servo ---------------------------------------------------------------------------------------

RATIO, RMS = "servo.gear_ratio", "servo.rms_nm"


def _geared(design: Design) -> dict[int, Study]:
    """Number of each drive whose servo has a rotor and a gear -> its study."""
    servos = {i: drive.servo for i, drive in enumerate(design.drives) if drive.servo is not None}
    return {i: Study(only(design, i)) for i, servo in servos.items() if servo.rotor_inertia_kg_m2 > 0.0}


def _gear_ratio(design: Design, wish: ShaftRequest) -> Solution:
    """The gear ratio of least rms torque of each servo, no larger than its motor's rated speed allows."""
    there = _geared(design)
    if all(drive.servo is None or drive.servo.kind == LINEAR for drive in design.drives):
        raise KindynaError(
            f'find gear-ratio: this design has no motor with a gear; allowed: [servo] with kind = "{ROTARY}"'
        )
    if not there:
        raise KindynaError(
            "servo.rotor_inertia_kg_m2: without a rotor's inertia the torque falls with every larger ratio; state it"
        )
    made, answer, reached, before, ends = design, {}, {}, {}, []
    curve: list[tuple[float, float]] = []
    for i, study in there.items():
        path, own = path_of(i, RATIO) if design.listed else RATIO, path_of(i, RMS) if design.listed else RMS
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
        found = min(max(best, wish.low(path, 0.0)), min(wish.high(path), most))
        if found == most and most < best:
            ends.append(f"{path} = {found:.9g}, where the motor reaches its rated speed; without that {best:.9g}")
        answer[path], reached[own], before[own] = found, rms(found), rms(servo.gear_ratio)
        curve = curve or [(x, rms(x)) for x in sorted({*(best * np.exp(np.linspace(-1.4, 1.4, 15))).tolist(), found})]
        drives = list(made.drives)
        drives[i] = replace(drives[i], servo=replace(servo, gear_ratio=found))
        made = replace(made, drives=tuple(drives))
    return _answered(
        "gear ratio of least rms torque",
        design,
        made,
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
    paths = [path_of(i, RATIO) if design.listed else RATIO for i in _geared(design)]
    return dict.fromkeys(f"{path}{end}" for path in paths for end in ENDS)


# -- flywheel ----------------------------------------------------------------------------------------------


def _flywheel(design: Design, wish: ShaftRequest) -> Solution:
    """The least flywheel with which the true speed fluctuates no more than it may."""
    if not design.listed and not has_motor(design):
        raise KindynaError(
            "find flywheel: no shaft drives this design at constant speed; allowed: a cam, a crank, [[drives]]"
        )
    shaft = design.camshaft
    wanted = wish.high(FLUCTUATION, shaft.speed_fluctuation)
    if not wanted > 0.0:
        raise KindynaError(f"limit {FLUCTUATION}_max = {wanted:g}: outside its range; allowed: > 0")
    load, own = _load(design), motor_inertia(shaft)

    def reach(inertia: float) -> float:
        return fluctuation_with(load, shaft, inertia + own)

    needed = _least_inertia(load, shaft, wanted)
    found = min(max(needed, wish.low(FLYWHEEL, 0.0)), wish.high(FLYWHEEL))
    reached = reach(found)
    against: tuple[str, ...] = ()
    if reached > wanted * (1.0 + KEPT):
        text = "the motor stalls" if reached == math.inf else f"speed fluctuation {reached:.6g}, limit {wanted:g}"
        against = (f"{text}: it takes {needed:.6g} kg·m²",)
    around = (needed or found or inertia_by_energy(load, shaft, wanted) or 1.0) * np.exp(np.linspace(-1.4, 1.4, 25))
    curve = [(i, reach(i)) for i in sorted({*around.tolist(), found})]
    end = f"{FLYWHEEL} = {found:.9g}" if (found != needed or not found) and not against else ""
    made = replace(design, shaft=replace(shaft, flywheel_inertia_kg_m2=found))
    before = {FLUCTUATION: reach(shaft.flywheel_inertia_kg_m2)}
    solution = _answered(
        "least flywheel",
        design,
        made,
        {FLYWHEEL: found},
        {FLUCTUATION: reached},
        {FLUCTUATION: wanted},
        curve,
        FLUCTUATION,
        against,
        end,
        before,
    )
    return replace(solution, assumed={SLOPE: shaft.motor_slope_nm_s_per_rad} if is_assumed(design, SLOPE) else {})


def _least_inertia(load: LoadCurve, shaft: Shaft, wanted: float) -> float:
    """Of a flywheel [kg m²] with which the speed fluctuates by no more. Raises KindynaError where none does."""
    needed = max(inertia_for(load, shaft, wanted) - motor_inertia(shaft), 0.0)
    if needed == math.inf:
        raise KindynaError(f"no flywheel keeps a speed fluctuation of {wanted:g}: lower the load, or allow more")
    return needed


def with_least_flywheel(design: Design) -> tuple[Design, Mapping[str, float]]:
    """The design with the answer of ``find flywheel`` where nothing is stated, and this. Raises KindynaError."""
    shaft = design.camshaft
    needed = _least_inertia(_load(design), shaft, shaft.speed_fluctuation)
    return replace(design, shaft=replace(shaft, flywheel_inertia_kg_m2=needed)), {FLYWHEEL: needed}


# -- phases ------------------------------------------------------------------------------------------------

REACHED: Mapping[str, str] = MappingProxyType(
    {"peak": "peak_torque_nm", "rms": "rms_torque_nm", "fluctuation": "energy_swing_j"}
)


def _phases(design: Design, wish: ShaftRequest) -> Solution:
    """The phases of least peak torque, or root mean square, or swing of energy, that keep the timing; the first drive stays."""
    if len(design.drives) < 2:
        raise KindynaError("find phases: this design has one drive alone; allowed: two or more under [[drives]]")
    study = Study(replace(design, balancer=None)).camshaft
    numbers = [study.drive_number(name) for name in study.loading_drives]
    place = {number: i for i, number in enumerate(numbers)}  # what the shaft does not carry stays with the first
    spacings = [
        Spacing(
            place.get(numbered(design, drive_of(row.first)), 0),
            place.get(numbered(design, drive_of(row.second)), 0),
            math.radians(at.spare_deg),
        )
        for row, at in zip(design.timing, distances(design), strict=True)
    ]
    for i, number in enumerate(numbers):
        path, now = f"drives[{number}].phase_deg", design.drives[number].phase_deg
        for side, bound in ((1.0, wish.low(path)), (-1.0, wish.high(path))):
            if math.isfinite(bound):
                spare = math.radians((side * (now - bound) + 180.0) % 360.0 - 180.0)
                spacings.append(Spacing(0, i, spare) if side > 0.0 else Spacing(i, 0, spare))
    loads = [study.drive_load(name) for name in study.loading_drives]
    turned, checked = best_phases(loads, spacings, wish.aim).rotations, FindingsCheck(replace(design, balancer=None))

    def placed(turned: np.ndarray) -> tuple[Design, dict[str, float]]:
        made, answer = replace(design, balancer=None), {}
        for number, by in zip(numbers[1:], turned[1:].tolist(), strict=True):
            phase = (design.drives[number].phase_deg + math.degrees(by)) % 360.0
            made, answer[f"drives[{number}].phase_deg"] = with_phase(made, number, phase), phase
        return made, answer

    if held_by := checked.new(
        placed(turned)[0]
    ):  # as far towards them as nothing is to be complained of that is not now
        way = (turned + math.pi) % (2.0 * math.pi) - math.pi
        part, beyond = nearest(
            lambda part, quick: not checked.new(placed(part * way)[0], quick), 1.0, 0.0, checked.part
        )
        turned, held_by = part * way, checked.new(placed(beyond * way)[0])
    made, answer = placed(turned)
    made = replace(made, balancer=design.balancer)
    steps = np.arange(CURVE) * (2.0 * math.pi / (CURVE - 1))
    line = aim_along(loads, turned, 1, steps, wish.aim)
    first = design.drives[numbers[1]].phase_deg + np.rad2deg(turned[1] + steps)
    curve = sorted(zip(np.mod(first, 360.0).tolist(), line.tolist(), strict=True))
    reached, before = (_with_phases(each) for each in (made, design))
    kept = {f"timing[{i}].least_deg": row.least_deg for i, row in enumerate(design.timing)}
    title = f"phases of least {wish.aim}"
    solution = _answered(title, design, made, answer, reached, kept, curve, REACHED[wish.aim], reached_before=before)
    return replace(solution, held_by=held_by)


def _with_phases(design: Design) -> Mapping[str, float]:
    """What the cams of a design ask of the shaft, and how its timing is kept."""
    total = Study(replace(design, balancer=None)).camshaft
    return {
        "peak_torque_nm": abs(total.peak_torque.value),
        "rms_torque_nm": total.rms_torque,
        "energy_swing_j": total.flywheel.energy_swing,
        **{f"timing[{i}].least_deg": at.after_deg for i, at in enumerate(distances(design))},
    }


# -- balancer ----------------------------------------------------------------------------------------------


class _Balances(Trials):
    """Balance cams of one torque by spring rate [N/mm] and preload [N], each a design of its own."""

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
        """The energy that the spring takes up [J]."""
        low, high = energy_range(self.load)
        return high - low

    def most_preload(self, rate: float) -> float:
        """With which the force still grows as it shall [N]."""
        most = 2.0 * self.swing * N_PER_MM * rate * (1.0 + ROUNDING)
        return math.sqrt(most / self.growth) if self.growth else math.inf

    def rise_of(self, rate: float, preload: float) -> float:
        """By how much of the preload the force grows."""
        return math.sqrt(1.0 + 2.0 * rate * N_PER_MM * self.swing / preload / preload) - 1.0

    def part(self, rate: float, preload: float) -> Balancer:
        return replace(self.balancer, spring_rate_n_per_mm=rate, preload_n=preload)

    def prepare(self, values: Sequence[tuple[float, float]]) -> None:
        """Make the cams of these rates and preloads side by side."""
        self._prepared = self._made(values)

    def _made(self, values: Sequence[tuple[float, float]]) -> Mapping[tuple[float, float], Drive | NoSolution]:
        parts = [self.part(*each) for each in values]
        drives = balance_drives(self.load, parts, self.design.camshaft.speed_rpm * math.pi / 30.0)
        return dict(zip(values, drives, strict=True))

    def with_values(self, values: tuple[float, float]) -> Design:  # type: ignore[override]
        if values not in self._prepared and values not in self._last:
            self._last = self._made([values])  # its limits and its least force are looked at one after the other
        drive = {**self._prepared, **self._last}[values]
        if isinstance(drive, NoSolution):
            raise drive
        shaft = self.design.camshaft
        return Design("balancer", Shaft(shaft.rotation, shaft.speed_rpm), (drive,))

    def least_force(self, rate: float, preload: float) -> float:
        """The least contact force [N]: the preload itself where the follower has no mass, for there the spring is longest."""
        if not self.balancer.follower_mass_kg:
            return preload
        if (rate, preload) not in self._forces:
            study = Study(self.with_values((rate, preload)))
            self._forces[rate, preload] = extremes_of(study, "dynamics", ("contact_force",))["contact_force"].low.value
        return self._forces[rate, preload]

    def spare(self, rate: float, preload: float, refined: bool = False) -> float:
        """What is left of the tightest limit; -inf where there is no cam."""
        outcome = self.at(rate, preload, refined=refined)
        if not outcome.readings:
            return -math.inf
        held = (self.least_force(rate, preload) - self.force) / preload if self.balancer.follower_mass_kg else math.inf
        return min(outcome.margin, held)


def _balancer(design: Design, wish: ShaftRequest) -> Solution:
    """The least preload, not below the force that is stated (else the present preload), with which some spring keeps the limits of the
    balance cam and its own force grows enough; of such springs the softest. Where there is no balance cam, of one to begin with.

    The force of a spring of rate K that takes up the whole swing of energy ΔE grows from F0 to √(F0² + 2KΔE): by r of F0 from
    K = F0²((1 + r)² - 1)/(2ΔE) on. There the search begins, wherever the present rate may be.
    """
    if not design.listed:
        raise KindynaError("find balancer: this design has one drive alone; allowed: drives under [[drives]]")
    begun = design if design.balancer is not None else with_balancer(design, Study(design).flywheel.energy_swing)
    part = begun.balancer
    assert part is not None
    force = max(wish.low(FORCE, 0.0), wish.low("balancer.least_contact_force_n", 0.0), 0.0)
    least = max(force, wish.low(PRELOAD, 0.0)) or part.preload_n
    most = wish.high(PRELOAD, least * MOST)
    if least > most:
        raise KindynaError(f"limit {PRELOAD}_max = {most:g}: is below the force {least:g} N that the spring must keep")
    trials = _Balances(design, begun, {CONVEX: None, **wish.limits}, force, wish.low(RISE, 0.0))
    if is_even(trials.load):
        raise KindynaError(
            "find balancer: the torque does not swing, so that there is nothing to balance; leave the balance cam out"
        )
    scale = least * least / (2.0 * trials.swing * N_PER_MM)
    softest = max(scale * trials.growth, wish.low(RATE, 0.0))
    if softest > wish.high(RATE):
        return _unserved(trials, [wish.high(RATE)], least, most)
    first_rate = max(softest, scale * SCARCE)
    rates = _between(first_rate * RATES, softest, wish.high(RATE))

    def preload_of(rate: float, finest: float, near: float, refined: bool = False) -> float:
        return _least_preload(trials, rate, least, min(most, trials.most_preload(rate)), finest, refined, near)

    if part.follower_mass_kg:
        trials.prepare([(rate, least) for rate in rates])
    preloads: list[float] = []
    for rate in rates[::-1]:  # a softer spring mostly takes more preload
        preloads.insert(0, preload_of(rate, FINEST, preloads[0] if preloads else least))
    stiffest = min(STIFFEST * first_rate, wish.high(RATE))
    while least < preloads[-1] == min(preloads) < math.inf and rates[-1] < stiffest:
        rates.append(min(math.e * rates[-1], stiffest))
        preloads.append(preload_of(rates[-1], FINEST, least))
    if not np.isfinite(preloads).any():
        return _unserved(trials, rates, least, most)
    best = min(preloads)
    first = preloads.index(best)  # the softest of those
    rate = rates[first]
    if best <= least and first:
        rate = _softest(trials, rates[first - 1], rate, best)
    elif best > least and 0 < first < len(rates) - 1:
        rate, _ = bounded_minimum(lambda x: preload_of(x, LAST, 0.0), rates[first - 1], rates[first + 1], FLAT * rate)
    preload = preload_of(rate, LAST, best / GROWTH, refined=True)
    curve = [*zip(rates, preloads, strict=True), (rate, preload)]
    bounds = (wish.low(RATE), wish.high(RATE), stiffest)
    return _sprung(trials, rate, preload, curve, (), f"{RATE} = {rate:.9g}" if rate in bounds else "")


def _between(rates: np.ndarray, low: float, high: float) -> list[float]:
    inside = rates[(rates > low) & (rates < high)].tolist()
    ends = [bound for bound in (low, high) if math.isfinite(bound)]
    if len(inside) < 5 and len(ends) == 2:
        inside = np.linspace(low, high, 9)[1:-1].tolist() if high > low else []
    return sorted({*inside, *ends})


def _least_preload(
    trials: _Balances, rate: float, least: float, most: float, finest: float, refined: bool = False, near: float = 0.0
) -> float:
    """The least preload with which this spring keeps all limits of the cam; infinite where none does. near: where it may be."""

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


def _softest(trials: _Balances, bad: float, good: float, preload: float) -> float:
    """The softest spring with which this preload keeps all limits, between one that does not and one that does."""

    def spare(rate: float) -> float:
        return trials.spare(rate, preload, refined=True)

    if spare(bad) >= 0.0:  # at the very limit, where only rounding took it for one that does not
        return bad
    if spare(good) < 0.0:
        return good
    return bracketed_root(spare, BracketEnds(bad, spare(bad), good, spare(good)), LAST * good).b


def _sprung(
    trials: _Balances,
    rate: float,
    preload: float,
    curve: Sequence[tuple[float, float]],
    against: tuple[str, ...],
    end: str,
) -> Solution:
    outcome = trials.at(rate, preload)
    reached = outcome.reached()
    force = trials.least_force(rate, preload)
    reached |= {FORCE: force, RISE: trials.rise_of(rate, preload)}
    made = replace(trials.design, balancer=trials.part(rate, preload))
    own = trials.balancer.spring_rate_n_per_mm, trials.balancer.preload_n
    before = (
        {} if trials.before.balancer is None else {reading.key: reading.reached for reading in trials.at(*own).readings}
    )
    if before:
        before |= {FORCE: trials.least_force(*own), RISE: trials.rise_of(*own)}
    kept = {key: limit for key, limit in ((FORCE, trials.force), (RISE, trials.rise)) if limit}
    limits = {each.key: each.limit for each in outcome.readings} | kept
    return _answered(
        "least preload",
        trials.before,
        made,
        {RATE: rate, PRELOAD: preload},
        reached,
        limits,
        curve,
        PRELOAD,
        against,
        end,
        before,
    )


def _unserved(trials: _Balances, rates: list[float], least: float, most: float) -> Solution:
    """The best that there is: the stiffest spring with the preload that keeps the limits of the cam, else with the most preload, and what
    stands against it."""
    preload = _least_preload(trials, rates[-1], least, most, LAST, refined=True)
    best = rates[-1] if preload < math.inf else max(rates, key=lambda rate: trials.spare(rate, most))
    most = min(preload, most)
    outcome = trials.at(best, most)
    if not outcome.readings:
        raise KindynaError(f"no spring balances this torque: {outcome.problem}")
    against = [reading.text for reading in outcome.readings if not reading.kept]
    if trials.rise_of(best, most) < trials.rise:
        against.append(
            f"its force grows by {trials.rise_of(best, most):.4g} of the preload, limit {trials.rise:g}: take a stiffer spring"
        )
    force = trials.least_force(best, most)
    if force < trials.force:
        against.append(
            f"the follower is pressed too little: least contact force {force:.6g} N, limit {trials.force:g} N"
        )
    return _sprung(trials, best, most, (), tuple(against), "")


ON_SHAFT: Mapping[str, ShaftRow] = MappingProxyType(
    {
        "flywheel": ShaftRow(
            "Least flywheel", (FLYWHEEL, FLUCTUATION), (), _flywheel, "the least flywheel for the fluctuation of speed that is allowed",
            _turns_shaft, _wheel_keys,
        ),
        "gear-ratio": ShaftRow(
            "Gear ratio of the servo", (RATIO, "drives["), (), _gear_ratio,
            "the gear ratio of the servo with the least rms torque of its motor, no larger than its rated speed allows",
            lambda design: any(drive.servo is not None and drive.servo.kind == ROTARY for drive in design.drives), _ratio_keys,
        ),
        "phases": ShaftRow(
            "Best phases", ("drives[",), (), _phases,
            "the phases of least peak torque that keep the timing; --for rms or fluctuation: least of these",
            lambda design: len(design.drives) > 1, _phase_keys,
            MappingProxyType({"peak": "Least peak torque", "rms": "Least RMS torque", "fluctuation": "Least fluctuation"}),
        ),
        "balancer": ShaftRow(
            "Spring of the balance cam", (RATE, PRELOAD, FORCE, "balancer.least_contact_force_n", RISE), tuple(LIMITS), _balancer,
            f"the spring of least preload that stays above a force, and of such springs the softest whose force grows by {LEAST_RISE:g} of "
            f"the preload ({RISE}_min); a softer one would be compressed by more than {1.0 / LEAST_RISE:g} strokes before it works",
            lambda design: design.balancer is not None, _spring_keys,
        ),
    }
)  # fmt: skip
