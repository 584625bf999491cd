"""Designs with other values in the fields that are varied: what each reaches of the limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from core.design import Design, edited, part_faults
from core.errors import DesignError, NoSolution
from core.find.goals import LimitReading
from core.findings import ERROR, NOTE, Finding
from core.mechanism.kinematics import Kinematics
from core.motion import Angles
from core.motion.extremes import Extreme, find_highest, piecewise_angles
from core.numerics.lazy import checkpoint, column
from core.study import Study, findings_of
from core.study.limits import FORCE, FORCE_PART, LIMITS, POLAR, USER_BOUNDS, Curve, bounded_quantities, needs_torque

# -- what ``check`` finds in the machine at hand ----------------------------------------------------------------


Put = Callable[[Design], Design]
"""The design of one drive -> the machine that it belongs to."""
SAME = 1e-9  # of a value, to which it is the last one that serves ...
NEAR = 1e-4  # ... and where only notes stand against the next one
UNEVEN = "speed-fluctuates"
ENLARGED = 1.5  # times its size: so much may a flywheel grow that goes into the machine with the answer
Found = Mapping[tuple[str, str], Finding]


def alone(design: Design) -> Design:
    """A design that is the whole machine."""
    return design


class FindingsCheck:
    """The findings of the machine that a design belongs to.

    machine  the design of one drive -> the whole; waived: codes that a search may bring, since their limits were stated in it
    notes    whether a note counts, too
    noted    notes, and nothing graver, stood against a design
    """

    def __init__(self, design: Design, machine: Put = alone, waived: Collection[str] = (), notes: bool = True) -> None:
        self._machine, self._waived, self._notes, self._suspect = machine, frozenset(waived), notes, ""
        self.noted = False
        before = Study(machine(design))
        self._stages = before.stages
        self._before = cache(lambda stage: _known(before, stage))

    @property
    def part(self) -> float:
        """To which an answer is sought."""
        return NEAR if self.noted else SAME

    def new(self, made: Design, quick: bool = False) -> tuple[str, ...]:
        """What would be found with another design in its place and is not now, in words, of the first stage in which something is. Where
        there is no answer now: its errors. quick: in the stage only in which something was found last."""
        study = Study(self._machine(made))
        order = sorted(self._stages, key=lambda stage: stage != self._suspect)
        for stage in order[:1] if quick else order:
            before = self._before(stage)
            try:
                found = _found(study, stage)
            except NoSolution as error:
                return (str(error).partition("\n")[0],)
            new = [
                each
                for key, each in found.items()
                if each.code not in self._waived
                and not _mended(each)
                and (each.severity == ERROR if before is None else key not in before)
                and (self._notes or each.severity != NOTE)
            ]
            if new:
                self._suspect = stage
                self.noted |= all(each.severity == NOTE for each in new)
                return tuple(_words(each) for each in new)
        return ()


def uneven(machine: Design) -> bool:
    """Whether its speed is found to fluctuate by more than wanted."""
    study = Study(machine)
    return "dynamics" in study.stages and any(code == UNEVEN for code, _ in _known(study, "dynamics") or ())


def _found(study: Study, stage: str) -> Found:
    """By code and field. Raises NoSolution."""
    return {(each.code, each.field): each for each in findings_of(study, (stage,))}


def _known(study: Study, stage: str) -> Found | None:
    """None where the machine has no answer there, or one of its drives has none at all."""
    try:
        found = _found(study, stage)
    except NoSolution:
        return None
    return None if any(code == "no-drive" for code, _ in found) else found


def _mended(finding: Finding) -> bool:
    """Whether a flywheel not much larger than the fitted one keeps the speed even."""
    percent, wanted = (finding.values.get(name) for name in ("percent", "wanted_percent"))
    return (
        finding.code == UNEVEN
        and isinstance(percent, float)
        and isinstance(wanted, float)
        and percent <= ENLARGED * wanted
    )


def _words(finding: Finding) -> str:
    drive = finding.values.get("drive")
    return f"{drive}: {finding.message}" if drive else finding.message


def nearest(serves: Callable[[float, bool], bool], bad: float, good: float, part: float = SAME) -> tuple[float, float]:
    """The value next to ``bad`` that serves, on the way from it to one that does, and the one beyond that does not: by halves, to a part of
    the larger one.

    serves: value, whether a quick look will do -> whether it serves
    """
    finest = part * max(abs(good), abs(bad))
    for quick in (True, False):
        near = good
        while abs(near - bad) > finest:
            middle = 0.5 * (bad + near)
            near, bad = (middle, bad) if serves(middle, quick) else (near, middle)
        if serves(near, False):
            return near, bad
        bad = near
    return good, bad


# -- the samples of many trial designs at once ------------------------------------------------------------------


MOTION = "motion."
PutValue = Callable[[Design, str, Any], Design]
"""The design with another number, or a column of them, at a path."""


class Top(NamedTuple):
    """The highest value of a figure over the turn, and the greatest of its sizes."""

    curve: Curve
    found: Extreme
    size: float


Tops = Mapping[str, Sequence[Top]]
"""Key of a limit -> the figures of its flanks."""


def curves_of(study: Study, keys: Sequence[str]) -> dict[str, tuple[Curve, ...]]:
    """Key -> the figures of its flanks, at the cam angles of a study."""
    return {key: tuple(LIMITS[key].curves(study)) for key in keys}


class Sampled(NamedTuple):
    """Of one of many designs: its number; its limits, None where it has no answer; the linkage of all, of whose pairs the kinds are
    its."""

    number: int
    tops: Tops | None
    linkage: Kinematics


def sampled_together(
    design: Design, paths: Sequence[str], rows: np.ndarray, put: PutValue, keys: Sequence[str]
) -> Iterator[Sampled]:
    """The designs with other numbers (p, m) at these paths, by samples of every piece of the motion: those of them that can be
    computed together."""
    from core.study.batch import is_batchable
    from core.study.quantity_requests import QuantityRequest
    from core.study.stages_of_many import MAX_POSITIONS, DesignBlock

    read = [name for key in keys if key in USER_BOUNDS for name in bounded_quantities(design, key)]
    if not rows.size or not all(is_batchable(design, paths, QuantityRequest("", name, "max", 1.0)) for name in read):
        return
    stage = "dynamics" if any(LIMITS[key].needs_forces for key in keys) else "cam"
    size = max(1, MAX_POSITIONS // piecewise_angles(Study(design).uncut).theta.size)
    for first in range(0, rows.shape[1], size):
        checkpoint()
        moved, fixed = design, {}
        for path, row in zip(paths, rows[:, first : first + size], strict=True):
            if path.startswith(MOTION):
                moved = put(moved, path, column(row))
            else:
                fixed[path] = row
        motion = None if moved is design else moved.drive.motion
        one = DesignBlock(design, fixed, motion, rows[0, first : first + size].size)
        angles = piecewise_angles(one.program)
        try:
            linkage, curves = one.read(
                stage, *one.spread(angles), lambda there: (there.linkage, curves_of(there, keys))
            )
        except NoSolution:  # all of them
            continue
        tops = tops_of(curves, one.count, angles)
        lost = one.failed_at(stage)
        for k in np.flatnonzero(~one.separate).tolist():
            yield Sampled(first + k, None if lost[k] else tops[k], linkage)


def tops_of(curves: Mapping[str, Sequence[Curve]], count: int, angles: Angles) -> list[Tops]:
    """The limits of each of so many designs, by their samples one after the other."""
    every = [curve for rows in curves.values() for curve in rows]
    samples = np.array([curve.value for curve in every]).reshape(len(every) * count, -1)
    value, theta = (each.reshape(-1, count).tolist() for each in highest_of_samples(samples, angles))
    sizes = [
        np.reshape(curve.size, (count, -1)).max(axis=1).tolist() if np.ndim(curve.size) else [float(curve.size)] * count
        for curve in every
    ]
    found: list[Tops] = []
    for k in range(count):
        tops = iter(Top(curve, Extreme(value[i][k], theta[i][k]), sizes[i][k]) for i, curve in enumerate(every))
        found.append({key: [next(tops) for _ in rows] for key, rows in curves.items()})
    return found


def highest_of_samples(value: np.ndarray, angles: Angles) -> tuple[np.ndarray, np.ndarray]:
    """The highest of samples (m, n) at angles (n,), or of the parabola through it and its neighbours in the same segment, and the angle
    of the sample [rad], both (m,)."""
    value = np.where(np.isnan(value), -np.inf, value)
    top, last = value.argmax(axis=1), angles.theta.size - 1
    index = np.clip(top[:, None] + np.arange(-1, 2), 0, last)
    x, y = angles.theta[index], np.take_along_axis(value, index, axis=1)
    piece = angles.piece[index]
    inside = (top > 0) & (top < last) & (piece[:, 0] == piece[:, 2]) & np.isfinite(y).all(axis=1)
    x, y = x[inside], y[inside]
    before, after = x[:, 0] - x[:, 1], x[:, 2] - x[:, 1]
    left, right = (y[:, 0] - y[:, 1]) / before, (y[:, 2] - y[:, 1]) / after
    bend = (right - left) / (after - before)
    slope = left - bend * before
    highest = value[np.arange(top.size), top]
    highest[inside] -= np.where(bend < 0.0, 0.25 * slope * slope / np.where(bend < 0.0, bend, 1.0), 0.0)
    return highest, angles.theta[top]


# -- designs with other values in the fields that are varied ----------------------------------------------------


class Outcome(NamedTuple):
    """What a design reaches: its limits, the tightest first; pressures: the greatest pressure angle [deg] where the motion rises,
    where it returns, and over the turn. Both empty where there is no cam: then problem says why, but of samples."""

    readings: tuple[LimitReading, ...]
    pressures: tuple[float, ...]
    problem: str = ""

    @property
    def margin(self) -> float:
        """The least of all limits; NaN where there is no cam."""
        return self.readings[0].margin if self.readings else float("nan")

    @property
    def kept(self) -> bool:
        """Whether the design has a cam and keeps all limits."""
        return bool(self.readings) and all(each.kept for each in self.readings)

    def reached(self, pressures: bool = False) -> dict[str, float]:
        """Limit -> value reached; where one is of the pressure angle, or on demand, that of rise and return too."""
        reached = {reading.key: reading.reached for reading in self.readings}
        if pressures or not reached.keys().isdisjoint(NEEDED):
            stretches = zip(NEEDED[:2], self.pressures, strict=False)
            reached |= {key: value for key, value in stretches if math.isfinite(value) and key not in reached}
        return reached


TINY = 1e-300  # [N]
RPM = math.pi / 30.0  # of a speed of the shaft [rad/s]
NEEDED = ("pressure_angle_rise_deg", "pressure_angle_return_deg", "pressure_angle_deg")


class KeptForce(NamedTuple):
    """What keeps the follower on the cam: force [N] up to the speed high [rad/s]; None: the usual one."""

    force: float | None
    high: float

    def of(self, largest: float) -> tuple[float, str]:
        """The force [N] of a design whose largest is that, why, and up to which speed."""
        fast = f"up to {self.high / RPM:.6g} rpm"
        if self.force is not None:
            return self.force, fast
        return FORCE_PART * largest, f"{100.0 * FORCE_PART:g} % of the largest, {largest:.5g} N, {fast}"


class Trials:
    """Designs that differ in the values of some fields, judged by limits: key -> value in its unit, None: what is usual for each of them.

    Evaluated by samples of every segment, many at once where they are known before, or refined to the true extremes.
    contact: the force that is kept besides, on an open cam. checked: the machine that they belong to. put: design, path, value -> the
    design with it. tell: called with how many were evaluated, after each.
    """

    def __init__(
        self,
        design: Design,
        paths: Sequence[str],
        limits: Mapping[str, float | None],
        tell: Callable[[int], object] = lambda count: None,
        contact: KeptForce | None = None,
        checked: FindingsCheck | None = None,
        put: PutValue = edited,
    ) -> None:
        self.design, self.paths, self.limits, self.contact = design, tuple(paths), dict(limits), contact
        self.checked = checked or FindingsCheck(design)
        self._tell, self._put = tell, put
        self._kept: dict[tuple[tuple[float, ...], bool], Outcome] = {}
        self._short = False  # whether it was the forces
        self._of_forces: dict[tuple[float, ...], tuple[LimitReading, ...]] = {}

    def with_values(self, values: Sequence[float]) -> Design:
        """The design with these values. Raises DesignError where it has faults."""
        made = self.design
        for path, value in zip(self.paths, values, strict=True):
            made = self._put(made, path, float(value))
        tables = {path.partition(".")[0] for path in self.paths}
        if found := [fault for name in sorted(tables) for fault in part_faults(made.tables[name], name)]:
            raise DesignError(found)
        return made

    def at(self, *values: float, refined: bool = True) -> Outcome:
        """What the design with these values reaches."""
        key = (values, refined)
        if key not in self._kept:
            checkpoint()
            self._kept[key] = self._evaluated(values, refined)
            self._tell(len(self._kept))
        return self._kept[key]

    def scan(self, tried: Iterable[tuple[float, ...]]) -> None:
        """Look at the samples of all these at once, as far as that can be, before they are asked for one by one."""
        made = {}
        for values in tried:
            with suppress(DesignError):
                if (values, False) not in self._kept:
                    made[values] = self.with_values(values)
        asked, designs, rows = list(made), list(made.values()), np.array([*made]).T
        for number, tops, linkage in sampled_together(self.design, self.paths, rows, self._put, self._keys):
            study = Study(designs[number])
            vars(study)["linkage"] = linkage  # of which a usual limit reads the kinds of its pairs
            self._kept[asked[number], False] = Outcome((), ()) if tops is None else self._outcome(study, tops)
        self._tell(len(self._kept))

    @property
    def _keys(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys((*self.limits, *NEEDED)))

    def forces(self, *values: float) -> tuple[LimitReading, ...]:
        """What the forces ask for, which takes longer than the shape: that the follower is kept on the cam, and the room for a shaft that
        carries the torque. Nothing where there are none, or friction jams."""
        if values not in self._of_forces:
            self._of_forces[values] = tuple(self._forces_of(Study(self.with_values(values))))
        return self._of_forces[values]

    def _forces_of(self, study: Study) -> Iterator[LimitReading]:
        try:
            if self.contact is not None:
                yield _contact_reading(study, self.contact)
            if self._by_torque(study) and (usual := LIMITS[POLAR].typical(study)):
                nearest = _highest(study.at(piecewise_angles(study.program)), (POLAR,))[POLAR]
                yield _reading(POLAR, nearest, usual.value, usual.reason)
        except NoSolution:
            return

    def _by_torque(self, study: Study) -> bool:
        return POLAR in self.limits and self.limits[POLAR] is None and needs_torque(study)

    def new(self, *values: float, quick: bool = False) -> tuple[str, ...]:
        """What the forces stand against with these values, and what else the machine would be complained of that it is not now; quick: of
        what was found last only."""
        if self._short or not quick:
            short = tuple(each.text for each in self.forces(*values) if not each.kept)
            self._short = bool(short) or (quick and self._short)
            if short or quick:
                return short
        return self.checked.new(self.with_values(values), quick)

    def serves(self, *values: float, quick: bool = False) -> bool:
        """Whether every limit is kept, and nothing new is to be complained of; quick: as for ``FindingsCheck.new``."""
        return self.at(*values).kept and not self.new(*values, quick=quick)

    def _evaluated(self, values: Sequence[float], refined: bool) -> Outcome:
        try:
            study = Study(self.with_values(values))
            there = study.at(piecewise_angles(study.program))
            return self._outcome(there, _highest(there, self._keys, refined))
        except (NoSolution, DesignError) as error:
            return Outcome((), (), str(error).partition("\n")[0])

    def _outcome(self, study: Study, tops: Tops) -> Outcome:
        readings = []
        for key, stated in self.limits.items():
            usual = (
                LIMITS[key].typical(study) if stated is None and not (key == POLAR and self._by_torque(study)) else None
            )
            limit = usual.value if usual else stated
            if limit is not None:
                readings.append(_reading(key, tops[key], limit, usual.reason if usual else ""))
        pressures = tuple(max((top.found.value for top in tops[key]), default=-np.inf) for key in NEEDED)
        return Outcome(tuple(sorted(readings, key=_margin)), pressures)


@np.errstate(invalid="ignore", over="ignore", divide="ignore")
def _highest(there: Study, keys: Sequence[str], refined: bool = True) -> Tops:
    """The figures of limits over the turn; there: a design at samples of every segment."""
    made = curves_of(there, keys)
    if not refined:
        return tops_of(made, 1, there.angles)[0]
    found = find_highest(
        lambda at: {
            f"{key} {i}": curve.value
            for key, rows in curves_of(there.at(at), keys).items()
            for i, curve in enumerate(rows)
        },
        there.program,
    )
    return {
        key: [Top(curve, found[f"{key} {i}"], float(np.max(curve.size))) for i, curve in enumerate(rows)]
        for key, rows in made.items()
    }


def _reading(key: str, tops: Sequence[Top], limit: float, reason: str) -> LimitReading:
    """Of the flank on which least is left."""
    found = [
        LimitReading(
            key,
            limit,
            curve.reached(top.value, size),
            curve.margin(top.value, limit, size),
            top.theta,
            reason,
            curve.whose,
        )
        for curve, top, size in tops
        if top.value > -np.inf
    ]
    return min(found, key=_margin, default=LimitReading(key, limit, np.nan, np.inf, 0.0))


def _contact_reading(study: Study, kept: KeptForce) -> LimitReading:
    """The least contact force up to the speed, beside what is to be kept."""
    found, largest = study.contact_force.least(kept.high), study.contact_force.greatest(kept.high)
    limit, reason = kept.of(largest)
    return LimitReading(
        FORCE, limit, found.value, (found.value - limit) / max(abs(largest), abs(limit), TINY), found.theta, reason
    )


def _margin(reading: LimitReading) -> float:
    return reading.margin
