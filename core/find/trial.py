"""Designs with other values in the fields that are varied: what each reaches of the limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from core.cam import PRESSURE_LIMITS
from core.design import Design, edited, part_faults
from core.errors import DesignError, NoAnswer
from core.find.limits import LIMITS, Curve, Reading
from core.mechanism.kinematics import REVOLUTE
from core.motion import Angles
from core.motion.extremes import Extreme, find_highest, piecewise_angles
from core.numerics.cancellation import checkpoint
from core.study import Study


class Outcome(NamedTuple):
    """What a design reaches: its limits, the tightest first; pressures: the greatest pressure angle [deg] where the motion rises,
    where it returns, and over the turn. Both empty where there is no cam: then problem says why."""

    readings: tuple[Reading, ...]
    pressures: tuple[float, ...]
    problem: str = ""

    @property
    def margin(self) -> float:
        """The least of all limits; NaN where there is no cam."""
        return self.readings[0].margin if self.readings else float("nan")

    @property
    def kept(self) -> bool:
        return bool(self.readings) and all(each.kept for each in self.readings)


NEEDED = ("pressure_angle_rise_deg", "pressure_angle_return_deg", "pressure_angle_deg")


class Trials:
    """Designs that differ in the values of some fields, judged by limits: key -> value in its unit.

    Evaluated by samples of every segment, or refined to the true extremes, which takes some times as long.
    tell: called with how many were evaluated, after each.
    """

    def __init__(
        self, design: Design, paths: Sequence[str], limits: Mapping[str, float], tell: Callable[[int], object] = lambda count: None
    ) -> None:
        self.design, self.paths, self.limits, self._tell = design, tuple(paths), dict(limits), tell
        self._kept: dict[tuple[tuple[float, ...], bool], Outcome] = {}

    def with_values(self, values: Sequence[float]) -> Design:
        """The design with these values. Raises DesignError where it has faults."""
        made = self.design
        for path, value in zip(self.paths, values, strict=True):
            made = edited(made, path, float(value))
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

    def _evaluated(self, values: Sequence[float], refined: bool) -> Outcome:
        try:
            study = Study(self.with_values(values))
            highest = self._highest(study, refined)
        except (NoAnswer, DesignError) as error:
            return Outcome((), (), str(error).partition("\n")[0])
        readings = []
        for key, limit in self.limits.items():
            found = [
                Reading(key, limit, curve.reached(top.value), curve.margin(top.value, limit), top.theta, curve.whose)
                for curve, top in highest[key]
                if top.value > -np.inf
            ]
            readings.append(min(found, key=_margin, default=Reading(key, limit, np.nan, np.inf, 0.0)))
        pressures = tuple(max((top.value for _, top in highest[key]), default=-np.inf) for key in NEEDED)
        return Outcome(tuple(sorted(readings, key=_margin)), pressures)

    @np.errstate(invalid="ignore", over="ignore", divide="ignore")
    def _highest(self, study: Study, refined: bool) -> Mapping[str, list[tuple[Curve, Extreme]]]:
        """Key -> the figures of its flanks, each with its highest value over the turn."""
        keys = dict.fromkeys((*self.limits, *NEEDED))

        def curves(angles: Angles) -> dict[str, Curve]:
            there = study.at(angles)
            return {f"{key} {i}": curve for key in keys for i, curve in enumerate(LIMITS[key].curves(there))}

        angles = piecewise_angles(study.program)
        made = curves(angles)
        if refined:
            tops = find_highest(lambda at: {name: curve.value for name, curve in curves(at).items()}, study.program)
        else:
            tops = {name: highest_of_samples(curve.value, angles) for name, curve in made.items()}
        return {key: [(curve, tops[name]) for name, curve in made.items() if name.partition(" ")[0] == key] for key in keys}


def _margin(reading: Reading) -> float:
    return reading.margin


def highest_of_samples(value: np.ndarray, angles: Angles) -> Extreme:
    """The highest of samples (n,), or of the parabola through it and its neighbours in the same segment."""
    value = np.where(np.isnan(value), -np.inf, value)
    i = int(np.argmax(value))
    theta, top = angles.theta, float(value[i])
    if 0 < i < value.size - 1 and angles.piece[i - 1] == angles.piece[i + 1] and np.isfinite(value[i - 1 : i + 2]).all():
        before, after = theta[i - 1] - theta[i], theta[i + 1] - theta[i]
        left, right = (value[i - 1] - top) / before, (value[i + 1] - top) / after
        bend = (right - left) / (after - before)
        slope = left - bend * before
        if bend < 0.0:
            top -= 0.25 * slope * slope / bend
    return Extreme(float(top), float(theta[i]))


def usual_pressure(design: Design) -> float:
    """The usual limit of the pressure angle [deg], by what holds the follower; the lower one where that cannot be told."""
    try:
        linkage = Study(design).linkage
    except NoAnswer:
        return min(PRESSURE_LIMITS.values())
    ground = linkage.pairs.get(linkage.ground)
    return PRESSURE_LIMITS[ground.kind if ground else REVOLUTE]
