"""Effects of tolerances: dependence of quantities on fields, worst case, random machines, and the tolerances to tighten."""

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
from core.errors import KindynaError, NoSolution
from core.frozen import frozen
from core.motion import degrees
from core.numerics.lazy import checkpoint
from core.study import Study, many, sensitivity
from core.study.batch import design_block, is_batchable
from core.study.machine_laws import with_fixed_laws
from core.study.quantities import quantity
from core.study.quantity_requests import QuantityRequest, quantity_request
from core.varying.request import StudyFile, StudyLimit, StudyOfMany, StudyQuantity, study_of
from core.varying.space import constant_column
from core.varying.waves import AllWaves

# -- tolerances -------------------------------------------------------------------------------------------------


MACHINES = 2000
SHARE = 0.9973
CONFIDENCE_Z = 1.959963984540054
"""z of 95 %, two-sided: 1,420 machines without a failure show 99.73 %."""
PERCENTILES = {"p0.135": 0.135, "p5": 5.0, "p50": 50.0, "p95": 95.0, "p99.865": 99.865}
ONE_SIDED = 2.7822
"""z of 99.73 %, one-sided, of a normal distribution."""
ROUNDING = 1e-10
"""Of the largest value of a quantity: a smaller change over a tolerance is rounding."""
HALVINGS = 2  # of a tolerance, at most
MAX_SETS = 20_000  # of tolerances to halve, tried in the order of their cost
MAX_CHECKS = 8  # by random machines, of sets that keep the limits by the linear model
MACHINES_AT_ONCE = 200  # machines

DEFAULT_FIGURES = (
    ("pressure_angle_deg", "max"), ("contact_force_n", "max"), ("contact_pressure_mpa", "max"), ("drive_torque_nm", "abs"),
    ("torque_nm", "abs"), ("driver_torque_nm", "abs"),
)  # fmt: skip
"""Figures of a design without a study file, as far as it has them."""


@frozen
class Share:
    """Share of machines that keep all limits, with its interval of 95 % confidence.

    Attributes
    ----------
    within, machines : int
        Number of machines that keep all limits, and of all machines.

    References
    ----------
    Wilson (1927), Probable inference, the law of succession, and statistical inference.
    """

    within: int
    machines: int

    @property
    def value(self) -> float:
        """Share p of the machines that keep all limits."""
        return self.within / self.machines

    @property
    def interval(self) -> tuple[float, float]:
        """Ends of the interval, (p + z²/2n ∓ z √(p (1 - p)/n + z²/4n²))/(1 + z²/n)."""
        n, p, z = self.machines, self.value, CONFIDENCE_Z
        middle, half = p + z * z / (2 * n), z * sqrt(p * (1.0 - p) / n + z * z / (4 * n * n))
        return max(0.0, (middle - half) / (1.0 + z * z / n)), min(1.0, (middle + half) / (1.0 + z * z / n))


@frozen
class Corner:
    """Worst case of a limit.

    Attributes
    ----------
    limit : StudyLimit
    at : mapping of str -> float
        Field -> its number in the worst case.
    linear, value : float
        Figure by the sensitivities, and as computed; None where the design cannot be built.
    within : bool
        Whether the value keeps the limit.
    """

    limit: StudyLimit
    at: Mapping[str, float]
    linear: float
    value: float | None
    within: bool


@frozen
class TightenedTolerances:
    """Field -> number of halvings of its tolerance; their cost, and the share of machines that keep the limits."""

    halved: Mapping[str, int]
    cost: float
    share: Share


def tolerance_study(design: Design) -> StudyOfMany:
    """Study of a design without a study file: default figures, and the limits of the design, or the typical pressure angle."""
    quantities = [StudyQuantity(slug, of) for slug, of in DEFAULT_FIGURES if _has(design, f"{slug}:{of}")]
    quantities += [StudyQuantity(f"drives[{i}].{slug}", of) for i in range(len(design.drives)) for slug, of in DEFAULT_FIGURES
              if design.listed and _has(design, f"drives[{i}].{slug}:{of}")]  # fmt: skip
    limits = tuple(_design_limits(design))
    return study_of(StudyFile(design="", quantities=tuple(quantities), limits=limits), design)


def _has(design: Design, key: str) -> bool:
    try:
        quantity_request(design, key)
    except ValueError:
        return False
    return True


def _design_limits(design: Design) -> Iterator[StudyLimit]:
    """Limits of a design as limits of quantities; without a limit of the pressure angle, the typical one."""
    from core.study.limits import LIMITS

    if design.listed or not design.drive.has_disk:
        return
    limits = design.drive.limits
    typical = LIMITS["pressure_angle_rise_deg"].typical(Study(design))
    angles = [a for a in (limits.pressure_angle_rise_deg, limits.pressure_angle_return_deg) if a is not None]
    steepest = min(angles) if angles else None if typical is None else typical.value
    if steepest is not None:
        yield StudyLimit("pressure_angle_deg", "max", max=steepest)
    if limits.convex_radius_mm is not None and _has(design, "profile_curvature_per_mm:max"):
        yield StudyLimit("profile_curvature_per_mm", "max", max=1.0 / limits.convex_radius_mm)
    for name in ("contact_force_n", "contact_pressure_mpa"):
        if getattr(limits, name) is not None and _has(design, f"{name}:max"):
            yield StudyLimit(name, "max", max=getattr(limits, name))


def bounds_of(limits: Sequence[StudyLimit]) -> Iterator[tuple[StudyLimit, float, float]]:
    """Limits, the side of a bound, +1 for the greatest value, and the bound."""
    for limit in limits:
        for side, bound in ((-1.0, limit.min), (1.0, limit.max)):
            if bound is not None:
                yield limit, side, bound


class Scatter:
    """Machines built to the tolerances of a design."""

    def __init__(self, study: StudyOfMany, tolerances: Sequence[Tolerance] | None = None) -> None:
        """Set up with the tolerances of the design, or with others in their place."""
        self.design = with_fixed_laws(study.base)
        self.study = replace(study, base=self.design)
        self.tolerances = tuple(self.design.tolerances if tolerances is None else tolerances)
        if not self.tolerances and self.design.waviness is None:
            raise KindynaError("tolerances: this design has none; give at least one [[tolerances]], or [waviness]")
        if not study.quantities:
            raise KindynaError("quantities: no quantity is requested; give at least one [[quantities]] or [[limits]]")
        self.nominal = {row.field: float(get(self.design, row.field)) for row in self.tolerances}
        self.keys = [row.key for row in study.quantities]

    # -- sensitivities -------------------------------------------------------------------------------------

    def slopes(self) -> np.ndarray:
        """Derivatives of the figures by the fields; 0 where the full tolerance changes a figure by rounding only.

        Returns
        -------
        ndarray (k, q) [unit of the figure by unit of the field]
        """
        if not self.nominal:
            return np.zeros((0, len(self.keys)))
        slopes = sensitivity(Study(self.design), list(self.nominal), self.keys)
        widths = np.array([2.0 * row.half for row in self.tolerances])[:, None]
        slopes[np.abs(slopes) * widths < ROUNDING * self._largest()] = 0.0
        return slopes

    def _largest(self) -> np.ndarray:
        """Largest size (q,) of the quantities over the turn, in the nominal design."""
        keys = [row.key if row.of is None else f"{row.quantity}:abs" for row in self.study.quantities]
        results = many(self.design, constant_column(self.design, 1), keys)
        return np.array([abs(float(results.value[key][0])) for key in keys])

    def parts(self, slopes: np.ndarray) -> np.ndarray:
        """Parts of the variance of every figure by its fields, to first order: (S σ)² over their sum.

        Parameters
        ----------
        slopes : ndarray (k, q) [unit of the figure by unit of the field]
            Derivatives S.

        Returns
        -------
        ndarray (k, q), dimensionless
        """
        variance = (slopes * np.array([row.deviation for row in self.tolerances])[:, None]) ** 2
        total = variance.sum(axis=0)
        return np.divide(variance, total, out=np.zeros_like(variance), where=total > 0.0)

    def corners(self, slopes: np.ndarray) -> list[Corner]:
        """Worst case of every limit: every field at the end of its tolerance that the sign of its slope decides.

        Parameters
        ----------
        slopes : ndarray (k, q) [unit of the figure by unit of the field]

        Returns
        -------
        list of Corner
        """
        corners = []
        nominal = self._one(self.nominal)
        for limit, side, bound in self.bounds():
            q = self.keys.index(limit.key)
            steps = np.array(
                [_worst_end(row, side * slope) for row, slope in zip(self.tolerances, slopes[:, q], strict=True)]
            )
            at = {path: value + step for (path, value), step in zip(self.nominal.items(), steps.tolist(), strict=True)}
            waves = self.waves.worst(quantity_request(self.design, limit.key), side)
            value = float(self._one(at)[q]) + waves
            linear = float(nominal[q] + slopes[:, q] @ steps) + waves
            within = bool(side * value <= side * bound)
            corners.append(Corner(limit, at, linear, None if np.isnan(value) else value, within))
        return corners

    def bounds(self) -> Iterator[tuple[StudyLimit, float, float]]:
        """Limits of the study with their sides and bounds, as by ``bounds_of``."""
        return bounds_of(self.study.file.limits)

    # -- random machines -----------------------------------------------------------------------------------

    def machines(self, count: int, seed: int) -> dict[str, np.ndarray]:
        """Numbers of the fields in random machines.

        Returns
        -------
        dict of str -> ndarray (count,) [unit of the field]
        """
        if not self.tolerances:
            return constant_column(self.design, count)
        rng = np.random.default_rng(seed)
        return {row.field: self.nominal[row.field] + _random_deviations(row, rng, count) for row in self.tolerances}

    def _values(self, columns: Mapping[str, np.ndarray]) -> np.ndarray:
        results = many(self.design, columns, self.keys)
        return np.array([results.value[key] for key in self.keys])

    def _one(self, numbers: Mapping[str, float]) -> np.ndarray:
        """Figures (q,) of the design with these numbers."""
        columns = {path: np.array([number]) for path, number in numbers.items()}
        return self._values(columns or constant_column(self.design, 1))[:, 0]

    def values(self, count: int, seed: int) -> np.ndarray:
        """Figures of random machines, every one with its own wave.

        Returns
        -------
        ndarray (q, count) [unit of the figure]
            NaN where a machine cannot be built.
        """
        values = self._values(self.machines(count, seed))
        for row, key in zip(values, self.keys, strict=True):
            row += self.waves.shifts(quantity_request(self.design, key), count, seed)
        return values

    @cached_property
    def waves(self) -> AllWaves:
        """Waves of the profiles of the nominal design."""
        return AllWaves(self.design)

    def within_limits(self, values: np.ndarray) -> np.ndarray:
        """Mask of machines that can be built and keep all limits.

        Parameters
        ----------
        values : ndarray (q, m) [unit of the figure]

        Returns
        -------
        ndarray (m,), dimensionless
        """
        good = ~np.isnan(values).all(axis=0)
        for limit, side, bound in self.bounds():
            good &= side * values[self.keys.index(limit.key)] <= side * bound
        return good

    def share(self, count: int, seed: int) -> Share:
        """Share of random machines that keep all limits."""
        return Share(int(self.within_limits(self.values(count, seed)).sum()), count)

    def bands(
        self, count: int, seed: int, samples: int = 360, only: Sequence[str] | None = None
    ) -> dict[str, np.ndarray]:
        """Percentiles of quantities over the cam angle, of random machines.

        Parameters
        ----------
        count : int
            Number of machines.
        seed : int
        samples : int
            Number n of cam angles.
        only : sequence of str or None
            Columns to compute; None for all of the study.

        Returns
        -------
        dict of str -> ndarray (p, n) [unit of the column]
            Percentiles as listed in ``PERCENTILES``.
        """
        slugs = (row.key.partition(":")[0] for row in self.study.quantities if row.of is not None)
        columns = [slug for slug in dict.fromkeys(slugs) if only is None or slug in only]
        names = {slug: quantity_request(self.design, f"{slug}:max") for slug in columns}
        names = {slug: request for slug, request in names.items() if request.name and request.drive is None}
        machines = self.machines(count, seed)
        theta = np.deg2rad(degrees(samples))
        quick = {slug: request for slug, request in names.items() if self.is_quick(request)}
        values = {slug: np.full((count, samples), np.nan) for slug in names}
        waves = self.waves.by_drive[None].at(theta) if None in self.waves.by_drive else None
        wave = waves.error(*self.waves.random_waves(None, count, seed)) if waves is not None else None
        for first in range(0, count, MACHINES_AT_ONCE):
            checkpoint()
            rows = np.array([row[first : first + MACHINES_AT_ONCE] for row in machines.values()])
            separate = self._batch_values(
                quick, rows, theta, {slug: values[slug][first : first + MACHINES_AT_ONCE] for slug in quick}
            )
            for k in range(rows.shape[1]):
                rest = names if separate[k] else {slug: r for slug, r in names.items() if slug not in quick}
                if rest:
                    checkpoint()
                    self._machine_values(rest, rows[:, k], theta, {slug: values[slug][first + k] for slug in rest})
        for slug, request in names.items():
            if waves is not None and wave is not None and waves.changes(request.name):
                values[slug] += waves.change(request.name, values[slug] * request.unit, wave) / request.unit
        levels = list(PERCENTILES.values())
        present = {slug: rows for slug, rows in values.items() if not np.isnan(rows).all()}
        return {slug: np.nanpercentile(rows, levels, axis=0) for slug, rows in present.items()}

    def is_quick(self, request: QuantityRequest) -> bool:
        """Whether a quantity is computed for many machines at once, at common cam angles."""
        varies_motion = any(path.startswith("motion.") for path in self.nominal)
        return not varies_motion and is_batchable(self.design, list(self.machines(1, 0)), request)

    def _batch_values(
        self, names: Mapping[str, QuantityRequest], rows: np.ndarray, theta: np.ndarray, into: Mapping[str, np.ndarray]
    ) -> np.ndarray:
        """Write quantities of machines with numbers (k, m) at cam angles (n,) into rows (m, n); mask (m,) of machines left out."""
        if not names:
            return np.zeros(rows.shape[1], dtype=bool)
        block = design_block(self.design, list(self.machines(1, 0)), rows)
        m, angles = block.count, block.program.angles(theta)
        owner = np.repeat(np.arange(m), theta.size)
        state = block.state(np.tile(angles.theta, m), np.tile(angles.piece, m), owner)
        values = block.values([request.name for request in names.values()], state, owner)
        for slug, request in names.items():
            failed = block.failed_at(quantity(request.name).stage)
            into[slug][~failed] = (values[request.name].reshape(m, theta.size) / request.unit)[~failed]
        return block.separate

    def _machine_values(
        self,
        names: Mapping[str, QuantityRequest],
        numbers: np.ndarray,
        theta: np.ndarray,
        into: Mapping[str, np.ndarray],
    ) -> None:
        """Write quantities of a single machine with numbers (k,) at cam angles (n,) into rows (n,)."""
        design = self.design
        for path, value in zip(self.machines(1, 0), numbers.tolist(), strict=True):
            design = put(design, path, value)
        study = Study(design)
        for row in into.values():
            row[:] = np.nan
        with suppress(NoSolution):
            at_angles = study.at(study.program.angles(theta))
            for slug, request in names.items():
                with suppress(NoSolution):  # where the motor stalls, other quantities have values
                    into[slug][:] = quantity(request.name).value(at_angles) / request.unit

    # -- tolerances to tighten -----------------------------------------------------------------------------

    def tightened(self, count: int, seed: int, slopes: np.ndarray, share: float = SHARE) -> TightenedTolerances | None:
        """Cheapest tolerances to halve, once or twice, so that this share of random machines keeps the limits.

        Sets that keep the limits by the sensitivities are checked by random machines in the order of their cost.

        Parameters
        ----------
        count : int
            Number of random machines.
        seed : int
        slopes : ndarray (k, q) [unit of the figure by unit of the field]
        share : float

        Returns
        -------
        TightenedTolerances or None
            None where no set is sufficient.
        """
        if not self.tolerances:  # waves alone
            return None
        middles = {path: x + row.middle for (path, x), row in zip(self.nominal.items(), self.tolerances, strict=True)}
        nominal = self._one(middles)
        deviation = np.array([row.deviation for row in self.tolerances])
        costs = np.array([1.0 if row.cost is None else row.cost for row in self.tolerances])
        distance = np.array(
            [side * (bound - nominal[self.keys.index(limit.key)]) for limit, side, bound in self.bounds()]
        )
        slope = np.array([slopes[:, self.keys.index(limit.key)] for limit, _, _ in self.bounds()]).reshape(
            -1, deviation.size
        )
        checked = 0
        for times in _sets_by_cost(costs):
            spread = np.sqrt(((slope * deviation / 2.0**times) ** 2).sum(axis=1))
            if (distance < ONE_SIDED * spread).any():
                continue
            tighter = [_halved(row, int(n)) for row, n in zip(self.tolerances, times, strict=True)]
            reached = Scatter(self.study, tighter).share(count, seed)
            checked += 1
            if reached.value >= share:
                halved = {row.field: int(n) for row, n in zip(self.tolerances, times, strict=True) if n}
                return TightenedTolerances(halved, float(costs @ times), reached)
            if checked == MAX_CHECKS:
                break
        return None


def _sets_by_cost(costs: np.ndarray) -> list[np.ndarray]:
    """Numbers of halvings (k,), the cheapest sets first; of many tolerances only sets of the cheapest ones."""
    levels = HALVINGS + 1
    k = costs.size
    if levels**k <= MAX_SETS:
        sets = [np.array(times) for times in product(range(levels), repeat=k)]
    else:
        sets = [np.zeros(k, dtype=int)]
        order = np.argsort(costs)
        for n in range(1, HALVINGS * k + 1):  # the cheapest ones, one after the other
            times = np.zeros(k, dtype=int)
            for i in range(n):
                times[order[i % k]] += 1
            sets.append(times)
    return sorted(sets, key=lambda times: (float(costs @ times), int(times.sum())))


def _halved(row: Tolerance, times: int) -> Tolerance:
    part = 0.5**times
    sigma = None if row.sigma is None else row.sigma * part
    middle, half = row.middle, row.half * part
    return replace(row, plus=max(0.0, middle + half), minus=max(0.0, half - middle), sigma=sigma)


def _worst_end(row: Tolerance, slope: float) -> float:
    """Deviation at which a figure of this slope is greatest."""
    return row.plus if slope > 0.0 else -row.down


def _random_deviations(row: Tolerance, rng: np.random.Generator, count: int) -> np.ndarray:
    """Random deviations (count,) by the distribution of a tolerance."""
    if row.distribution == NORMAL:
        return row.middle + row.deviation * rng.standard_normal(count)
    if row.distribution == UNIFORM:
        return row.middle + row.half * (2.0 * rng.random(count) - 1.0)
    return row.middle + row.half * rng.choice([-1.0, 1.0], count)
