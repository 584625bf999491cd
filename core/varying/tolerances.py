"""What tolerances do: how each quantity depends on each field, the worst case, random machines, and which tolerance to tighten."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, partial
from itertools import product
from math import sqrt

import numpy as np

from core.design import Design, Tolerance, get, only, put
from core.design.limits import NORMAL, UNIFORM
from core.elastic import kinematics_at_motion
from core.errors import KindynaError, NoSolution
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.motion import TURN, degrees
from core.numerics.lazy import checkpoint
from core.study import Study, many, sensitivity
from core.study.batch import design_block, is_batchable
from core.study.quantities import quantity
from core.study.quantity_requests import TORQUE, QuantityRequest, quantity_request
from core.varying.request import StudyFile, StudyLimit, StudyOfMany, StudyQuantity, study_of
from core.varying.space import constant_column

# -- what waves of the profile do at the follower, to first order -----------------------------------------------


ANGLES = 2880  # of the turn, at which extremes with waves are taken
WAVY_MACHINES_AT_ONCE = 64  # machines
DRIVE_TORQUE = "drive_torque"

OF: Mapping[str, Callable[[np.ndarray], np.ndarray]] = {
    "max": lambda f: f.max(axis=-1),
    "min": lambda f: f.min(axis=-1),
    "abs": lambda f: np.abs(f).max(axis=-1),
    "rms": lambda f: np.sqrt((f * f).mean(axis=-1)),
    "mean": lambda f: f.mean(axis=-1),
    "range": lambda f: np.ptp(f, axis=-1),
}
"""What is asked over the turn, of values (..., n) at even angles."""

WAVED: Mapping[str, Callable[[Waves, np.ndarray, Callable[[int], np.ndarray]], np.ndarray]] = {
    "displacement": lambda s, f, wave: f + wave(0),
    "velocity": lambda s, f, wave: f + s.omega * wave(1),
    "acceleration": lambda s, f, wave: f + s.omega**2 * wave(2),
    "jerk": lambda s, f, wave: f + s.omega**3 * wave(3),
    "contact_force": lambda s, f, wave: f + s.pressing * wave(2),
    DRIVE_TORQUE: lambda s, f, wave: f * s.harder(wave(2)),  # T = F_c times a length
    "contact_pressure": lambda s, f, wave: f * np.sqrt(np.maximum(s.harder(wave(2)), 0.0)),  # Hertz, of lines
}
"""Quantity -> its values (..., n) with a wave, of those without one (..., n) and derivatives of the motion's error by the cam angle."""


class Waves:
    """The waves of a study's profile at its cam angles (n,). Raises NoSolution where there is no cam.

    way  |b| (n,), of the point of the follower's body where it touches the first flank
    """

    def __init__(self, study: Study) -> None:
        assert study.design.waviness is not None, "as the caller saw"
        self.study, self.waves, self.theta = study, study.design.waviness, study.theta
        self.omega: float = study.omega
        (self.flank, *_), self.amplitude = study.cam.flanks, 1e-3 * self.waves.amplitude_mm
        self.loaded = not study.loading.is_empty and study.jam is None
        moving = self.moving.bodies[self.flank.body]
        way = moving.origin[1] + 1j * moving.turn[1] * (self.flank.contact - moving.origin[0])
        self.way = np.abs((np.conj(self.flank.normal) * way).real)

    def at(self, theta: np.ndarray) -> Waves:
        """The same at other cam angles (n,) [rad]."""
        return Waves(self.study.at_theta(theta))

    def error(self, lobes: np.ndarray, phase: np.ndarray) -> Callable[[int], np.ndarray]:
        """Derivatives by the cam angle (m, n) of the motion's error [m or rad], of waves of (m,) lobes and phases."""
        n, angle = lobes[:, None], lobes[:, None] * self.theta + phase[:, None]
        return lambda order: self.amplitude / self.way * n**order * np.cos(angle + 0.25 * order * TURN)

    @cached_property
    def moving(self) -> Kinematics:
        """The mechanism where it stands, with derivatives by the motion."""
        return kinematics_at_motion(
            self.study.mechanism, self.study.driver_ranges, self.study.motion.displacement[0], 1.0
        )

    @cached_property
    def mass(self) -> np.ndarray:
        """J (n,) [kg, or kg m²], of all that moves, in the coordinate of the motion."""
        return np.asarray(self.study.loading.inertia(self.moving, 1)[0])

    @cached_property
    def pressing(self) -> np.ndarray:
        """(n,) [N] of a second derivative of the error by the cam angle of 1."""
        return self.mass * self.omega**2 / self.way

    def harder(self, second: np.ndarray) -> np.ndarray:
        """How many times as hard the cam presses (..., n) with a second derivative of the error."""
        force = self.study.dynamics.contact
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(force == 0.0, 1.0, 1.0 + self.pressing * second / force)

    def more(self, asked: str, own: np.ndarray, wave: Callable[[int], np.ndarray]) -> np.ndarray:
        """By how much (..., n) a wave changes a quantity of these values (..., n)."""
        return WAVED[asked](self, own, wave) - own

    def all_at_once(self, sign: float, order: int) -> np.ndarray:
        """Derivatives of the error (n,), everywhere as large as a wave of the most lobes makes them."""
        return sign * self.amplitude / self.way * float(self.waves.lobes_to) ** order

    def changes(self, asked: str) -> bool:
        """Whether waves change a quantity."""
        return asked in WAVED and (self.loaded or quantity(asked).stage == "motion")

    def summary(self) -> dict[str, float]:
        """Along the path of the contact, where the flank is steepest: the error e/cos ψ [mm] and, by the most lobes n, the acceleration
        e (n ω)²/cos ψ [mm/s²]; the contact force that these ask [N], and the least that they leave on an open cam.

        Of an elastic follower at how many lobes it resounds; the most |z/s| = k/|k + ks - m Ω² + i c Ω|, Ω = n ω, of any of the
        lobes, and k |1 - z/s| of its error [N].
        """
        steepest, most = float(np.abs(self.flank.pressure_angle).max()), self.waves.lobes_to
        lift = 1e3 * self.amplitude / np.cos(steepest) if steepest < 0.25 * TURN else np.inf
        found = {
            "lift_error_mm": float(lift),
            "pressure_angle_deg": float(np.rad2deg(steepest)),
            "acceleration_mm_s2": float(lift * (most * self.omega) ** 2),
        }
        if self.loaded:
            more = self.pressing * self.amplitude / self.way * most**2
            found["contact_force_n"] = float(more.max())
            if not self.study.is_form_closed:
                found["least_contact_force_n"] = float((self.study.dynamics.contact - more).min())
        if not self.study.is_elastic or not self.loaded:
            return found
        one, lobes = self.study.elasticity.middle, np.arange(self.waves.lobes_from, most + 1)
        omega = lobes * abs(self.omega)
        ratio = one.stiffness / (one.stiffness + one.closing - one.mass * omega**2 + 1j * one.damping * omega)
        worst = int(np.abs(ratio).argmax())
        error = self.amplitude / float(self.way.min())
        return found | {
            "natural_lobes": float(one.natural_frequency / abs(self.omega)),
            "amplified": float(abs(ratio[worst])),
            "amplified_lobes": int(lobes[worst]),
            "elastic_contact_force_n": float(
                (one.stiffness * np.abs(1.0 - ratio)).max() * error / float(self.way.min())
            ),
        }


Waved = tuple[Waves, str, np.ndarray]
"""Waves, the quantity that they change, and its values (n,) without them."""


class AllWaves:
    """Those of all cams of a design, each cam with waves of its own.

    each   number of a drive, None of the only one of a design -> its waves, where it has any
    """

    def __init__(self, design: Design) -> None:
        self.design = design
        alone = {i: replace(only(design, i), waviness=design.waviness) for i in range(len(design.drives))}
        made = {i if design.listed else None: waves_of(Study(each)) for i, each in alone.items()}
        self.each = {number: waves for number, waves in made.items() if waves is not None}

    def drawn(self, number: int | None, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
        """Of machines (count,) how many lobes the wave of a drive has, each as likely, and its phase [rad], by chance."""
        rng, waves = np.random.default_rng([seed + (number or 0), 1]), self.each[number].waves
        return rng.integers(waves.lobes_from, waves.lobes_to + 1, count), TURN * rng.random(count)

    def shifts(self, asked: QuantityRequest, count: int, seed: int) -> np.ndarray:
        """By how much (count,) waves change what is asked over the turn, in its unit, of machines drawn by chance."""
        own, changed = self._changed(asked)
        if asked.statistic not in OF or not changed:
            return np.zeros(count)
        drawn, of = [self.drawn(number, count, seed) for number in changed], OF[asked.statistic]
        found = np.zeros(count)
        for part in (slice(i, i + WAVY_MACHINES_AT_ONCE) for i in range(0, count, WAVY_MACHINES_AT_ONCE)):
            values = np.tile(own, (found[part].size, 1))
            for (waves, name, alone), (lobes, phase) in zip(changed.values(), drawn, strict=True):
                values += waves.more(name, alone, waves.error(lobes[part], phase[part]))
            found[part] = of(values) - of(own)
        return found / asked.unit

    def worst(self, asked: QuantityRequest, side: float) -> float:
        """By how much an extreme changes at most towards a side, +1 upwards, in its unit, with waves of the most lobes in their worst
        phases."""
        own, changed = self._changed(asked)
        if asked.statistic not in ("max", "min", "abs") or not changed:
            return 0.0
        of, ends = OF[asked.statistic], []
        for end in (np.maximum, np.minimum):
            more = [
                end(*(waves.more(name, alone, partial(waves.all_at_once, sign)) for sign in (1.0, -1.0)))
                for waves, name, alone in changed.values()
            ]
            ends.append(float(of(own + np.sum(more, axis=0)) - of(own)))
        return side * max(side * each for each in ends) / asked.unit

    def _changed(self, asked: QuantityRequest) -> tuple[np.ndarray, Mapping[int | None, Waved]]:
        """The values (n,) without waves of what is asked, and what waves change of it, by drive."""
        if asked.key.partition(":")[0] == TORQUE and self.design.listed:
            return self._torque
        waves = self.each.get(asked.drive)
        if waves is None or not waves.changes(asked.name):
            return np.zeros(0), {}
        own = quantity(asked.name).value(waves.study)
        return own, {asked.drive: (waves, asked.name, own)}

    @cached_property
    def _torque(self) -> tuple[np.ndarray, Mapping[int | None, Waved]]:
        """That of all drives at even machine angles, and of each that has waves."""
        theta = np.arange(ANGLES) * TURN / ANGLES
        with suppress(NoSolution):
            shaft, found = Study(self.design).camshaft.at_theta(theta), dict[int | None, Waved]()
            for name in shaft.loading_drives:
                number = shaft.drive_number(name)
                if number in self.each and self.each[number].changes(DRIVE_TORQUE):
                    there = self.each[number].at(shaft.positions[name].drive_angle(theta))
                    found[number] = there, DRIVE_TORQUE, shaft.drive_torque(name)
            return shaft.torque, found
        return np.zeros(0), {}


def waves_of(study: Study) -> Waves | None:
    """The waves of a design's profile at even angles; None where none are stated, or there is no cam that can be made."""
    if study.design.listed or study.design.waviness is None or "cam" not in study.stages:
        return None
    try:
        return Waves(study.at_theta(np.arange(ANGLES) * TURN / ANGLES))
    except NoSolution:
        return None


# -- what tolerances do -----------------------------------------------------------------------------------------


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
MACHINES_AT_ONCE = 200  # machines

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

    limit: StudyLimit
    at: Mapping[str, float]
    linear: float
    value: float | None
    within: bool


@frozen
class TightenedTolerances:
    """Field -> how often its tolerance is halved; what that costs; the share of machines then."""

    halved: Mapping[str, int]
    cost: float
    share: Share


def tolerance_study(design: Design) -> StudyOfMany:
    """A design with what is asked of it where no study says: usual quantities, and its own limits, or the usual pressure angle."""
    asked = [StudyQuantity(slug, of) for slug, of in USUAL if _has(design, f"{slug}:{of}")]
    asked += [StudyQuantity(f"drives[{i}].{slug}", of) for i in range(len(design.drives)) for slug, of in USUAL
              if design.listed and _has(design, f"drives[{i}].{slug}:{of}")]  # fmt: skip
    limits = tuple(_own_limits(design))
    return study_of(StudyFile(design="", quantities=tuple(asked), limits=limits), design)


def _has(design: Design, key: str) -> bool:
    try:
        quantity_request(design, key)
    except ValueError:
        return False
    return True


def _own_limits(design: Design) -> Iterator[StudyLimit]:
    """The limits that its file states, as those of quantities; where it states none of the pressure angle, the usual one."""
    from core.study.limits import LIMITS

    if design.listed or design.drive.cam is None:
        return
    own = design.drive.limits
    usual = LIMITS["pressure_angle_rise_deg"].typical(Study(design))
    angles = [each for each in (own.pressure_angle_rise_deg, own.pressure_angle_return_deg) if each is not None]
    steepest = min(angles) if angles else None if usual is None else usual.value
    if steepest is not None:
        yield StudyLimit("pressure_angle_deg", "max", max=steepest)
    if own.convex_radius_mm is not None and _has(design, "profile_curvature_per_mm:max"):
        yield StudyLimit("profile_curvature_per_mm", "max", max=1.0 / own.convex_radius_mm)
    for name in ("contact_force_n", "contact_pressure_mpa"):
        if getattr(own, name) is not None and _has(design, f"{name}:max"):
            yield StudyLimit(name, "max", max=getattr(own, name))


def bounds_of(limits: Sequence[StudyLimit]) -> Iterator[tuple[StudyLimit, float, float]]:
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
        if not study.quantities:
            raise KindynaError("quantities: none is asked for; state at least one [[quantities]] or [[limits]]")
        self.own = {row.field: float(get(self.design, row.field)) for row in self.tolerances}
        self.keys = [row.key for row in study.quantities]

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
        keys = [row.key if row.of is None else f"{row.quantity}:abs" for row in self.study.quantities]
        found = many(self.design, constant_column(self.design, 1), keys)
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
            asked = quantity_request(self.design, limit.key)
            waves = self.waves.worst(asked, side)
            value = float(self._one(at)[q]) + waves
            linear = float(nominal[q] + slopes[:, q] @ steps) + waves
            within = bool(side * value <= side * bound)
            found.append(Corner(limit, at, linear, None if np.isnan(value) else value, within))
        return found

    def bounds(self) -> Iterator[tuple[StudyLimit, float, float]]:
        """Those of the study."""
        return bounds_of(self.study.file.limits)

    # -- random machines -----------------------------------------------------------------------------------

    def machines(self, count: int, seed: int) -> dict[str, np.ndarray]:
        """Field -> its numbers (count,) in machines drawn by chance."""
        if not self.tolerances:
            return constant_column(self.design, count)
        rng = np.random.default_rng(seed)
        return {row.field: self.own[row.field] + _drawn(row, rng, count) for row in self.tolerances}

    def _values(self, columns: Mapping[str, np.ndarray]) -> np.ndarray:
        found = many(self.design, columns, self.keys)
        return np.array([found.value[key] for key in self.keys])

    def _one(self, numbers: Mapping[str, float]) -> np.ndarray:
        """What is asked (q,) of the design with these numbers."""
        return self._values(
            {path: np.array([each]) for path, each in numbers.items()} or constant_column(self.design, 1)
        )[:, 0]

    def values(self, count: int, seed: int) -> np.ndarray:
        """What is asked (q, count) of machines drawn by chance, each with a wave of its own; NaN of one that cannot be built."""
        found = self._values(self.machines(count, seed))
        for row, key in zip(found, self.keys, strict=True):
            row += self.waves.shifts(quantity_request(self.design, key), count, seed)
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
        asked = (row.key.partition(":")[0] for row in self.study.quantities if row.of is not None)
        columns = [slug for slug in dict.fromkeys(asked) if only is None or slug in only]
        names = {slug: quantity_request(self.design, f"{slug}:max") for slug in columns}
        names = {slug: each for slug, each in names.items() if each.name and each.drive is None}
        machines = self.machines(count, seed)
        theta = np.deg2rad(degrees(samples))
        quick = {slug: each for slug, each in names.items() if self.quick(each)}
        found = {slug: np.full((count, samples), np.nan) for slug in names}
        waves = self.waves.each[None].at(theta) if None in self.waves.each else None
        wave = waves.error(*self.waves.drawn(None, count, seed)) if waves is not None else None
        for first in range(0, count, MACHINES_AT_ONCE):
            checkpoint()
            rows = np.array([row[first : first + MACHINES_AT_ONCE] for row in machines.values()])
            alone = self._at_once(
                quick, rows, theta, {slug: found[slug][first : first + MACHINES_AT_ONCE] for slug in quick}
            )
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

    def quick(self, asked: QuantityRequest) -> bool:
        """Whether a quantity is computed of many machines at once, at the same angles of all."""
        moved = any(path.startswith("motion.") for path in self.own)
        return not moved and is_batchable(self.design, list(self.machines(1, 0)), asked)

    def _at_once(
        self, names: Mapping[str, QuantityRequest], rows: np.ndarray, theta: np.ndarray, into: Mapping[str, np.ndarray]
    ) -> np.ndarray:
        """Quantities of machines with these numbers (k, m) at cam angles (n,) into (m, n) each; which of them (m,) are to be computed by
        themselves instead."""
        if not names:
            return np.zeros(rows.shape[1], dtype=bool)
        one = design_block(self.design, list(self.machines(1, 0)), rows)
        m, angles = one.count, one.program.angles(theta)
        owner = np.repeat(np.arange(m), theta.size)
        state = one.state(np.tile(angles.theta, m), np.tile(angles.piece, m), owner)
        values = one.values([each.name for each in names.values()], state, owner)
        for slug, each in names.items():
            lost = one.failed_at(quantity(each.name).stage)
            into[slug][~lost] = (values[each.name].reshape(m, theta.size) / each.unit)[~lost]
        return one.separate

    def _by_itself(
        self,
        names: Mapping[str, QuantityRequest],
        numbers: np.ndarray,
        theta: np.ndarray,
        into: Mapping[str, np.ndarray],
    ) -> None:
        """The same of one machine, by its own turn."""
        design = self.design
        for path, value in zip(self.machines(1, 0), numbers.tolist(), strict=True):
            design = put(design, path, value)
        study = Study(design)
        for row in into.values():
            row[:] = np.nan
        with suppress(NoSolution):
            there = study.at(study.program.angles(theta))
            for slug, each in names.items():
                with suppress(NoSolution):  # where the motor stalls, the rest is there
                    into[slug][:] = quantity(each.name).value(there) / each.unit

    # -- which to tighten ----------------------------------------------------------------------------------

    def tightened(self, count: int, seed: int, slopes: np.ndarray, share: float = SHARE) -> TightenedTolerances | None:
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
                return TightenedTolerances(halved, float(worth @ times), found)
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
