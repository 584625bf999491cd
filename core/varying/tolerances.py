"""What tolerances do: how each quantity depends on each field, the worst case, random machines, and which tolerance to tighten."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from itertools import product
from math import sqrt

import numpy as np

from core.design import Design, Tolerance, get, put
from core.design.limits import NORMAL, UNIFORM
from core.errors import KindynaError, NoAnswer
from core.frozen import frozen
from core.motion import degrees
from core.numerics.cancellation import checkpoint
from core.study import Study, many, sensitivity
from core.study.batches.asked import Asked, asked_of
from core.study.batches.batch import at_once, together
from core.study.quantities import quantity
from core.varying.request import AskedFor, Bounded, StudyFile, StudyOfMany, study_of
from core.varying.space import as_it_is
from core.varying.waves import AllWaves

MACHINES = 2000
SHARE = 0.9973
CONFIDENT = 1.959963984540054
"""z of 95 %, two-sided: 1,420 machines none of which fails show 99.73 %."""
PERCENTILES = {"p0.135": 0.135, "p5": 5.0, "p50": 50.0, "p95": 95.0, "p99.865": 99.865}
ONE_SIDED = 2.7822
"""z that 99.73 % of a normal distribution lie below."""
ROUNDING = 1e-10
"""Of the largest value of a quantity: a smaller change over a tolerance is none."""
HALVINGS = 2  # of a tolerance, at most
MOST_SETS = 20_000  # of tolerances to halve, tried in the order of their cost
CHECKED = 8  # of these, that keep the limits by the linear model
AT_ONCE = 200  # machines

USUAL = (
    ("pressure_angle_deg", "max"), ("contact_force_n", "max"), ("contact_pressure_mpa", "max"), ("drive_torque_nm", "abs"),
    ("torque_nm", "abs"), ("driver_torque_nm", "abs"),
)  # fmt: skip
"""What is asked of a design for which no study states it, as far as it has that."""


@frozen
class Share:
    """Of n machines: how many keep all limits, and the interval (Wilson 1927) in which their share lies with 95 %."""

    within: int
    machines: int

    @property
    def value(self) -> float:
        """The share itself."""
        return self.within / self.machines

    @property
    def interval(self) -> tuple[float, float]:
        """(p + z²/2n ∓ z sqrt(p (1 - p)/n + z²/4n²)) / (1 + z²/n)."""
        n, p, z = self.machines, self.value, CONFIDENT
        middle, room = p + z * z / (2 * n), z * sqrt(p * (1.0 - p) / n + z * z / (4 * n * n))
        return max(0.0, (middle - room) / (1.0 + z * z / n)), min(1.0, (middle + room) / (1.0 + z * z / n))


@frozen
class Corner:
    """The worst case of one bound of a limit: the fields there, the value by the sensitivities and as computed, None where it cannot
    be built; whether it keeps the limit."""

    limit: Bounded
    at: Mapping[str, float]
    linear: float
    value: float | None
    within: bool


@frozen
class Tightened:
    """Field -> how often its tolerance is halved; what that costs; the share of machines then."""

    halved: Mapping[str, int]
    cost: float
    share: Share


def tolerance_study(design: Design) -> StudyOfMany:
    """A design with what is asked of it where no study says: usual quantities, and its own limits, or the usual pressure angle."""
    asked = [AskedFor(slug, of) for slug, of in USUAL if _has(design, f"{slug}:{of}")]
    asked += [AskedFor(f"drives[{i}].{slug}", of) for i in range(len(design.drives)) for slug, of in USUAL
              if design.listed and _has(design, f"drives[{i}].{slug}:{of}")]  # fmt: skip
    limits = tuple(_own_limits(design))
    return study_of(StudyFile(design="", quantities=tuple(asked), limits=limits), design)


def _has(design: Design, key: str) -> bool:
    try:
        asked_of(design, key)
    except ValueError:
        return False
    return True


def _own_limits(design: Design) -> Iterator[Bounded]:
    """The limits that its file states, as those of quantities; where it states none of the pressure angle, the usual one."""
    from core.study.limits import LIMITS

    if design.listed or design.drive.cam is None:
        return
    own = design.drive.limits
    usual = LIMITS["pressure_angle_rise_deg"].usual(Study(design))
    angles = [each for each in (own.pressure_angle_rise_deg, own.pressure_angle_return_deg) if each is not None]
    steepest = min(angles) if angles else None if usual is None else usual.value
    if steepest is not None:
        yield Bounded("pressure_angle_deg", "max", max=steepest)
    if own.convex_radius_mm is not None and _has(design, "profile_curvature_per_mm:max"):
        yield Bounded("profile_curvature_per_mm", "max", max=1.0 / own.convex_radius_mm)
    for name in ("contact_force_n", "contact_pressure_mpa"):
        if getattr(own, name) is not None and _has(design, f"{name}:max"):
            yield Bounded(name, "max", max=getattr(own, name))


def bounds_of(limits: Sequence[Bounded]) -> Iterator[tuple[Bounded, float, float]]:
    """Each limit with the side of one of its bounds, +1 for the greatest value, and that bound."""
    for limit in limits:
        for side, bound in ((-1.0, limit.min), (1.0, limit.max)):
            if bound is not None:
                yield limit, side, bound


class Scatter:
    """The machines that are made of a design."""

    def __init__(self, study: StudyOfMany, tolerances: Sequence[Tolerance] | None = None) -> None:
        """tolerances: in place of the design's own."""
        self.study, self.design = study, study.base
        self.tolerances = tuple(self.design.tolerances if tolerances is None else tolerances)
        if not self.tolerances and self.design.waviness is None:
            raise KindynaError("tolerances: this design has none; state at least one [[tolerances]], or [waviness]")
        if not study.asked:
            raise KindynaError("quantities: none is asked for; state at least one [[quantities]] or [[limits]]")
        self.own = {row.field: float(get(self.design, row.field)) for row in self.tolerances}
        self.keys = [row.key for row in study.asked]

    # -- by the sensitivities ------------------------------------------------------------------------------

    def slopes(self) -> np.ndarray:
        """(k, q) of each quantity by each field, in the units of both; 0 where the whole tolerance changes it by rounding alone."""
        if not self.own:
            return np.zeros((0, len(self.keys)))
        slopes = sensitivity(Study(self.design), list(self.own), self.keys)
        widths = np.array([2.0 * row.half for row in self.tolerances])[:, None]
        slopes[np.abs(slopes) * widths < ROUNDING * self._largest()] = 0.0
        return slopes

    def _largest(self) -> np.ndarray:
        """(q,) the largest size over the turn of what is asked, of the design itself."""
        keys = [row.key if row.of is None else f"{row.quantity}:abs" for row in self.study.asked]
        found = many(self.design, as_it_is(self.design, 1), keys)
        return np.array([abs(float(found.value[key][0])) for key in keys])

    def parts(self, slopes: np.ndarray) -> np.ndarray:
        """(k, q) which part of a quantity's variance comes from a field, to first order: (S σ)² over the sum of these."""
        variance = (slopes * np.array([row.deviation for row in self.tolerances])[:, None]) ** 2
        total = variance.sum(axis=0)
        return np.divide(variance, total, out=np.zeros_like(variance), where=total > 0.0)

    def corners(self, slopes: np.ndarray) -> list[Corner]:
        """The worst case of each limit: every field at that end which the sign of its slope asks for, computed there."""
        found = []
        nominal = self._one(self.own)
        for limit, side, bound in self.bounds():
            q = self.keys.index(limit.key)
            steps = np.array(
                [_end(row, side * slope) for row, slope in zip(self.tolerances, slopes[:, q], strict=True)]
            )
            at = {path: value + step for (path, value), step in zip(self.own.items(), steps.tolist(), strict=True)}
            asked = asked_of(self.design, limit.key)
            waves = self.waves.worst(asked, side)
            value = float(self._one(at)[q]) + waves
            linear = float(nominal[q] + slopes[:, q] @ steps) + waves
            within = bool(side * value <= side * bound)
            found.append(Corner(limit, at, linear, None if np.isnan(value) else value, within))
        return found

    def bounds(self) -> Iterator[tuple[Bounded, float, float]]:
        """Those of the study."""
        return bounds_of(self.study.file.limits)

    # -- random machines -----------------------------------------------------------------------------------

    def machines(self, count: int, seed: int) -> dict[str, np.ndarray]:
        """Field -> its numbers (count,) in machines drawn by chance."""
        if not self.tolerances:
            return as_it_is(self.design, count)
        rng = np.random.default_rng(seed)
        return {row.field: self.own[row.field] + _drawn(row, rng, count) for row in self.tolerances}

    def _values(self, columns: Mapping[str, np.ndarray]) -> np.ndarray:
        found = many(self.design, columns, self.keys)
        return np.array([found.value[key] for key in self.keys])

    def _one(self, numbers: Mapping[str, float]) -> np.ndarray:
        """What is asked (q,) of the design with these numbers."""
        return self._values({path: np.array([each]) for path, each in numbers.items()} or as_it_is(self.design, 1))[
            :, 0
        ]

    def values(self, count: int, seed: int) -> np.ndarray:
        """What is asked (q, count) of machines drawn by chance, each with a wave of its own; NaN of one that cannot be built."""
        found = self._values(self.machines(count, seed))
        for row, key in zip(found, self.keys, strict=True):
            row += self.waves.shifts(asked_of(self.design, key), count, seed)
        return found

    @cached_property
    def waves(self) -> AllWaves:
        """Of the profiles of the design as it is."""
        return AllWaves(self.design)

    def kept(self, values: np.ndarray) -> np.ndarray:
        """Which machines (m,) of values (q, m) can be built and keep all limits."""
        good = ~np.isnan(values).all(axis=0)
        for limit, side, bound in self.bounds():
            good &= side * values[self.keys.index(limit.key)] <= side * bound
        return good

    def share(self, count: int, seed: int) -> Share:
        """Of machines drawn by chance."""
        return Share(int(self.kept(self.values(count, seed)).sum()), count)

    def bands(
        self, count: int, seed: int, samples: int = 360, only: Sequence[str] | None = None
    ) -> dict[str, np.ndarray]:
        """Column -> percentiles (p, samples) over the cam angle of what machines drawn by chance have there; of these columns only."""
        asked = (row.key.partition(":")[0] for row in self.study.asked if row.of is not None)
        columns = [slug for slug in dict.fromkeys(asked) if only is None or slug in only]
        names = {slug: asked_of(self.design, f"{slug}:max") for slug in columns}
        names = {slug: each for slug, each in names.items() if each.name and each.drive is None}
        machines = self.machines(count, seed)
        theta = np.deg2rad(degrees(samples))
        quick = {slug: each for slug, each in names.items() if self.quick(each)}
        found = {slug: np.full((count, samples), np.nan) for slug in names}
        waves = self.waves.each[None].at(theta) if None in self.waves.each else None
        wave = waves.error(*self.waves.drawn(None, count, seed)) if waves is not None else None
        for first in range(0, count, AT_ONCE):
            checkpoint()
            rows = np.array([row[first : first + AT_ONCE] for row in machines.values()])
            alone = self._at_once(quick, rows, theta, {slug: found[slug][first : first + AT_ONCE] for slug in quick})
            for k in range(rows.shape[1]):
                left = names if alone[k] else {slug: each for slug, each in names.items() if slug not in quick}
                if left:
                    checkpoint()
                    self._by_itself(left, rows[:, k], theta, {slug: found[slug][first + k] for slug in left})
        for slug, each in names.items():
            if waves is not None and wave is not None and waves.changes(each.name):
                found[slug] += waves.more(each.name, found[slug] * each.unit, wave) / each.unit
        levels = list(PERCENTILES.values())
        present = {slug: rows for slug, rows in found.items() if not np.isnan(rows).all()}
        return {slug: np.nanpercentile(rows, levels, axis=0) for slug, rows in present.items()}

    def quick(self, asked: Asked) -> bool:
        """Whether a quantity is computed of many machines at once, at the same angles of all."""
        moved = any(path.startswith("motion.") for path in self.own)
        return not moved and together(self.design, list(self.machines(1, 0)), asked)

    def _at_once(
        self, names: Mapping[str, Asked], rows: np.ndarray, theta: np.ndarray, into: Mapping[str, np.ndarray]
    ) -> np.ndarray:
        """Quantities of machines with these numbers (k, m) at cam angles (n,) into (m, n) each; which of them (m,) are to be computed by
        themselves instead."""
        if not names:
            return np.zeros(rows.shape[1], dtype=bool)
        one = at_once(self.design, list(self.machines(1, 0)), rows)
        m, angles = one.count, one.program.angles(theta)
        owner = np.repeat(np.arange(m), theta.size)
        state = one.state(np.tile(angles.theta, m), np.tile(angles.piece, m), owner)
        values = one.values([each.name for each in names.values()], state, owner)
        for slug, each in names.items():
            lost = one.lost_at(quantity(each.name).stage)
            into[slug][~lost] = (values[each.name].reshape(m, theta.size) / each.unit)[~lost]
        return one.apart

    def _by_itself(
        self, names: Mapping[str, Asked], numbers: np.ndarray, theta: np.ndarray, into: Mapping[str, np.ndarray]
    ) -> None:
        """The same of one machine, by its own turn."""
        design = self.design
        for path, value in zip(self.machines(1, 0), numbers.tolist(), strict=True):
            design = put(design, path, value)
        study = Study(design)
        for row in into.values():
            row[:] = np.nan
        with suppress(NoAnswer):
            there = study.at(study.program.angles(theta))
            for slug, each in names.items():
                with suppress(NoAnswer):  # where the motor stalls, the rest is there
                    into[slug][:] = quantity(each.name).value(there) / each.unit

    # -- which to tighten ----------------------------------------------------------------------------------

    def tightened(self, count: int, seed: int, slopes: np.ndarray, share: float = SHARE) -> Tightened | None:
        """The cheapest tolerances to halve, once or twice, with which the limits are kept by that share of random machines: sets in the
        order of their cost that do by the sensitivities, the first of them that does in fact. None where there is none."""
        if not self.tolerances:  # waves alone
            return None
        middles = {path: self.own[path] + row.middle for path, row in zip(self.own, self.tolerances, strict=True)}
        nominal = self._one(middles)
        deviation = np.array([row.deviation for row in self.tolerances])
        worth = np.array([1.0 if row.cost is None else row.cost for row in self.tolerances])
        room = np.array([side * (bound - nominal[self.keys.index(limit.key)]) for limit, side, bound in self.bounds()])
        slope = np.array([slopes[:, self.keys.index(limit.key)] for limit, _, _ in self.bounds()]).reshape(
            -1, deviation.size
        )
        checked = 0
        for times in _sets_by_cost(worth):
            spread = np.sqrt(((slope * deviation / 2.0**times) ** 2).sum(axis=1))
            if (room < ONE_SIDED * spread).any():
                continue
            fewer = [_halved(row, int(n)) for row, n in zip(self.tolerances, times, strict=True)]
            found = Scatter(self.study, fewer).share(count, seed)
            checked += 1
            if found.value >= share:
                halved = {row.field: int(n) for row, n in zip(self.tolerances, times, strict=True) if n}
                return Tightened(halved, float(worth @ times), found)
            if checked == CHECKED:
                break
        return None


def _sets_by_cost(worth: np.ndarray) -> list[np.ndarray]:
    """How often each tolerance is halved (k,), the cheapest sets first; of many tolerances only those sets of the fewest."""
    levels = HALVINGS + 1
    k = worth.size
    if levels**k <= MOST_SETS:
        sets = [np.array(each) for each in product(range(levels), repeat=k)]
    else:
        sets = [np.zeros(k, dtype=int)]
        order = np.argsort(worth)
        for n in range(1, HALVINGS * k + 1):  # the cheapest ones, one after the other
            each = np.zeros(k, dtype=int)
            for i in range(n):
                each[order[i % k]] += 1
            sets.append(each)
    return sorted(sets, key=lambda times: (float(worth @ times), int(times.sum())))


def _halved(row: Tolerance, times: int) -> Tolerance:
    part = 0.5**times
    sigma = None if row.sigma is None else row.sigma * part
    middle, half = row.middle, row.half * part
    return replace(row, plus=max(0.0, middle + half), minus=max(0.0, half - middle), sigma=sigma)


def _end(row: Tolerance, slope: float) -> float:
    """The deviation at which something of this slope is largest."""
    return row.plus if slope > 0.0 else -row.down


def _drawn(row: Tolerance, rng: np.random.Generator, count: int) -> np.ndarray:
    """Deviations (count,)."""
    if row.distribution == NORMAL:
        return row.middle + row.deviation * rng.standard_normal(count)
    if row.distribution == UNIFORM:
        return row.middle + row.half * (2.0 * rng.random(count) - 1.0)
    return row.middle + row.half * rng.choice([-1.0, 1.0], count)
