"""Designs with other values in the fields that are varied: what each reaches of the limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from core.design import Design, edited, part_faults
from core.errors import DesignError, NoAnswer
from core.find.checked import FindingsCheck
from core.find.reading import LimitReading
from core.find.scan import Put, Top, Tops, curves_of, sampled_together, tops_of
from core.motion.extremes import find_highest, piecewise_angles
from core.numerics.cancellation import checkpoint
from core.study import Study
from core.study.limits import FORCE, FORCE_PART, LIMITS, POLAR, by_torque


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
        put: Put = edited,
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
            if self._by_torque(study) and (usual := LIMITS[POLAR].usual(study)):
                nearest = _highest(study.at(piecewise_angles(study.program)), (POLAR,))[POLAR]
                yield _reading(POLAR, nearest, usual.value, usual.reason)
        except NoAnswer:
            return

    def _by_torque(self, study: Study) -> bool:
        return POLAR in self.limits and self.limits[POLAR] is None and by_torque(study)

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
        except (NoAnswer, DesignError) as error:
            return Outcome((), (), str(error).partition("\n")[0])

    def _outcome(self, study: Study, tops: Tops) -> Outcome:
        readings = []
        for key, stated in self.limits.items():
            usual = (
                LIMITS[key].usual(study) if stated is None and not (key == POLAR and self._by_torque(study)) else None
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
