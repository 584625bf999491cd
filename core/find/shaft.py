"""Searches for a complete shaft: its flywheel, the phases of its drives, the spring of its balance cam."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.cam import PRESSURE_LIMITS
from core.design import (
    Design,
    Info,
    Shaft,
    distances,
    is_assumed,
    numbered,
    only,
    path_of,
    phase_path,
    phase_value,
    with_phase_value,
)
from core.design.camshaft import drive_of
from core.design.engine import CRANK_PER_CAM
from core.design.parts import LINEAR, ROTARY
from core.errors import KindynaError
from core.find.balancer import FORCE, LEAST_RISE, PRELOAD, RATE, RISE, ShaftRequest, find_balancer, shaft_solution
from core.find.offer import StatedLimits
from core.find.solution import Judge, Judgement, Solution, out_of_bounds
from core.find.trial import PRESSURE_ANGLES, FindingsCheck, nearest_accepted
from core.number_text import result_text
from core.project.reading_faults import did_you_mean
from core.shaft import (
    AIMS,
    LoadCurve,
    Spacing,
    aim_along,
    best_phases,
    fluctuation_with,
    inertia_by_energy,
    inertia_for,
    motor_inertia,
)
from core.study import Study, extremes_of
from core.study.drive_forces import best_servo_ratio, servo_part, servo_turn
from core.study.limits import ANY_PRESSURE, LIMITS
from core.study.study import has_motor

FLYWHEEL, FLUCTUATION, SLOPE = (
    "shaft.flywheel_inertia_kg_m2",
    "shaft.speed_fluctuation",
    "shaft.motor_slope_nm_s_per_rad",
)
ENDS = ("_min", "_max")
TOLERANCE = 1e-9  # of a limit, relative to it
CURVE = 73


EXTRA: Mapping[str, Info] = MappingProxyType({
    RISE: Info("Force rise", "of the spring over the stroke, part of its preload: with a quarter it is "
               "compressed by four strokes before it works", 0.0, optional=True)
})  # fmt: skip
"""Limits that are no fields of a design."""


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
            raise KindynaError(
                f"limit {key!r}: {what} has none of that name{did_you_mean(key, row.limits)}; allowed: {allowed}"
            )
    return row.search(design, ShaftRequest(bounds, limits, aim))


def _unstated(defaults: StatedLimits, stated: StatedLimits) -> StatedLimits:
    """Default limits that are not stated; a stated limit of rise or return also replaces that of the full turn."""
    unstated = {key: value for key, value in defaults.items() if key not in stated}
    if not stated.keys().isdisjoint(PRESSURE_ANGLES):
        unstated.pop(ANY_PRESSURE, None)
    return unstated


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
    most_ratios: dict[str, float] = {}
    curve: list[tuple[float, float]] = []
    torques: dict[str, tuple[str, Callable[[float], float]]] = {}
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
        most = most_ratios[path] = math.inf if servo.rated_rpm is None else servo.rated_rpm / speed
        ratio = min(max(best, request.low(path, 0.0)), min(request.high(path), most))
        if ratio == most and most < best:
            ends.append(
                f"{path} = {ratio:.9g}, where the motor reaches its rated speed; without that {result_text(best, 6)}"
            )
        answer[path], reached[rms_path], before[rms_path] = ratio, rms(ratio), rms(servo.gear_ratio)
        torques[path] = rms_path, rms
        curve = curve or [(x, rms(x)) for x in sorted({*(best * np.exp(np.linspace(-1.4, 1.4, 15))).tolist(), ratio})]
        changed = _with_ratio(changed, i, ratio)

    def at(values: Mapping[str, float]) -> Judgement:
        candidate = design
        for i, ratio in zip(geared, values.values(), strict=True):
            candidate = _with_ratio(candidate, i, ratio)
        fast = tuple(
            f"{path} = {ratio:.9g}: beyond the rated speed"
            for path, ratio in values.items()
            if ratio > most_ratios[path]
        )
        readings = {name: rms(values[path]) for path, (name, rms) in torques.items()}
        return Judgement(candidate, values, readings, (*out_of_bounds(values, request.bounds), *fast))

    solution = shaft_solution(
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
    return replace(solution, judge=Judge(tuple(answer), at))


def _with_ratio(design: Design, number: int, ratio: float) -> Design:
    drives = list(design.drives)
    servo: Any = drives[number].servo
    drives[number] = replace(drives[number], servo=replace(servo, gear_ratio=ratio))
    return replace(design, drives=tuple(drives))


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
    solution = shaft_solution(
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

    def at(values: Mapping[str, float]) -> Judgement:
        wheel = replace(design, shaft=replace(shaft, flywheel_inertia_kg_m2=values[FLYWHEEL]))
        varies = fluctuation(values[FLYWHEEL])
        uneven = () if varies <= limit * (1.0 + TOLERANCE) else (f"speed fluctuation {result_text(varies, 5)}",)
        return Judgement(wheel, values, {FLUCTUATION: varies}, (*out_of_bounds(values, request.bounds), *uneven))

    assumed = {SLOPE: shaft.motor_slope_nm_s_per_rad} if is_assumed(design, SLOPE) else {}
    return replace(solution, assumed=assumed, judge=Judge((FLYWHEEL,), at))


def _least_inertia(load: LoadCurve, shaft: Shaft, limit: float) -> float:
    """Least flywheel inertia [kg m²] for a limit of the speed fluctuation. Raises KindynaError where none suffices."""
    needed = max(inertia_for(load, shaft, limit) - motor_inertia(shaft), 0.0)
    if needed == math.inf:
        raise KindynaError(f"no flywheel keeps a speed fluctuation of {limit:g}: lower the load, or allow more")
    return needed


def with_least_flywheel(
    design: Design, rounded: Callable[[float], float] | None = None
) -> tuple[Design, Mapping[str, float]]:
    """Return the design with its least flywheel, rounded up on request, and the value by its path.

    Raises KindynaError where none suffices.
    """
    shaft = design.camshaft
    needed = _least_inertia(Study(design).camshaft.load, shaft, shaft.speed_fluctuation)
    needed = rounded(needed) if rounded is not None and needed else needed
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
        path, present = phase_path(design, number), phase_value(design, number, design.drives[number].phase)
        per_phase = 1.0 if design.drives[number].valve is None else CRANK_PER_CAM
        for side, bound in ((1.0, request.low(path)), (-1.0, request.high(path))):
            if math.isfinite(bound):
                spare = math.radians((side * (present - bound) / per_phase + 180.0) % 360.0 - 180.0)
                spacings.append(Spacing(0, i, spare) if side > 0.0 else Spacing(i, 0, spare))
    loads = [study.drive_load(name) for name in study.loading_drives]
    shifts = best_phases(loads, spacings, request.aim).rotations
    checked = FindingsCheck(replace(design, balancer=None))

    def shifted(shifts: np.ndarray) -> tuple[Design, dict[str, float]]:
        changed, answer = replace(design, balancer=None), {}
        for number, shift in zip(numbers[1:], shifts[1:].tolist(), strict=True):
            phase = (design.drives[number].phase + math.degrees(shift)) % 360.0
            answer[phase_path(design, number)] = value = phase_value(design, number, phase)
            changed = with_phase_value(changed, number, value)
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
    first = design.drives[numbers[1]].phase + np.rad2deg(shifts[1] + steps)
    values = (phase_value(design, numbers[1], phase) for phase in np.mod(first, 360.0).tolist())
    curve = sorted(zip(values, line.tolist(), strict=True))
    reached, before = _phase_readings(changed), _phase_readings(design)
    limits = {f"timing[{i}].least_deg": row.least_deg for i, row in enumerate(design.timing)}
    title, figure = f"phases of least {request.aim}", REACHED[request.aim]
    solution = shaft_solution(title, design, changed, answer, reached, limits, curve, figure, reached_before=before)

    def at(values: Mapping[str, float]) -> Judgement:
        shifted_design = replace(design, balancer=None)
        for number in numbers[1:]:
            shifted_design = with_phase_value(shifted_design, number, values[phase_path(design, number)])
        late = tuple(
            f"{row.second} comes too early after {row.first}"
            for row, distance in zip(design.timing, distances(shifted_design), strict=True)
            if not distance.kept
        )
        texts = (*out_of_bounds(values, request.bounds), *late)
        candidate = replace(shifted_design, balancer=design.balancer)
        return Judgement(candidate, values, _phase_readings(candidate), texts or checked.new(shifted_design))

    return replace(solution, next_findings=next_findings, judge=Judge(tuple(answer), at))


def _phase_readings(design: Design) -> Mapping[str, float]:
    """Torque and energy of the cams of a design, and the distances of its timing."""
    total = Study(replace(design, balancer=None)).camshaft
    return {
        "peak_torque_nm": abs(total.peak_torque.value),
        "rms_torque_nm": total.rms_torque,
        "energy_swing_j": total.flywheel.energy_swing,
        **{f"timing[{i}].least_deg": at.after_deg for i, at in enumerate(distances(design))},
    }


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
            lambda design: dict.fromkeys(f"{phase_path(design, i)}{end}" for i in range(1, len(design.drives)) for end in ENDS),
            MappingProxyType(
                {"peak": "Least peak torque", "rms": "Least RMS torque", "fluctuation": "Least fluctuation"}
            ),
        ),
        "balancer": ShaftRow(
            "Spring of the balance cam", (RATE, PRELOAD, FORCE, "balancer.least_contact_force_n", RISE), tuple(LIMITS),
            find_balancer,
            "the spring of least preload with a least contact force, and of such springs the softest whose force rises "
            f"by {LEAST_RISE:g} of the preload ({RISE}_min); "
            f"a softer one would be preloaded by more than {1.0 / LEAST_RISE:g} strokes",
            lambda design: design.balancer is not None, _spring_keys,
        ),
    }
)  # fmt: skip
