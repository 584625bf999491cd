"""Trial designs with other values in the varied fields, their findings, and their readings of the limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from core.design import Design, edited, part_faults
from core.design.rules import spatial_faults
from core.errors import DesignError, NoSolution
from core.find.goals import LimitReading
from core.findings import ERROR, NOTE, Finding
from core.mechanism.kinematics import Kinematics
from core.motion import Angles
from core.motion.extremes import Extreme, find_highest, piecewise_angles
from core.number_text import result_text
from core.numerics.lazy import checkpoint, column
from core.study import Study, findings_of
from core.study.limits import FORCE, FORCE_PART, LIMITS, POLAR, USER_BOUNDS, Curve, bounded_quantities, needs_torque

# -- new findings of the machine --------------------------------------------------------------------------------

MachineOf = Callable[[Design], Design]
"""The design of one drive -> the machine that contains it."""
SAME = 1e-9  # relative tolerance of the last accepted value ...
NEAR = 1e-4  # ... and where only notes are found with the next one
UNEVEN = "speed-fluctuates"
ENLARGED = 1.5  # greatest growth of a flywheel that is changed together with the result
FindingsByField = Mapping[tuple[str, str], Finding]


def same_design(design: Design) -> Design:
    """Machine of a design that is a machine by itself: the design."""
    return design


class FindingsCheck:
    """Findings that a trial design adds to those of the machine.

    Attributes
    ----------
    machine : callable
        Design of one drive -> the machine.
    waived : collection of str
        Codes of findings that are allowed, since the search states their limits.
    notes : bool
        Whether a note counts.
    has_notes : bool
        Whether a design was rejected for notes only.
    """

    def __init__(
        self, design: Design, machine: MachineOf = same_design, waived: Collection[str] = (), notes: bool = True
    ) -> None:
        self._machine, self._waived, self._notes, self._suspect = machine, frozenset(waived), notes, ""
        self.has_notes = False
        before = Study(machine(design))
        self._stages = before.stages
        self._before = cache(lambda stage: _findings_or_none(before, stage))

    @property
    def tolerance(self) -> float:
        """Relative tolerance of a result."""
        return NEAR if self.has_notes else SAME

    def new(self, design: Design, quick: bool = False) -> tuple[str, ...]:
        """Messages of the new findings with another design, of the first stage that has any.

        In a stage that cannot be computed: the error. ``quick``: only the stage of the last new finding.
        """
        study = Study(self._machine(design))
        order = sorted(self._stages, key=lambda stage: stage != self._suspect)
        for stage in order[:1] if quick else order:
            before = self._before(stage)
            try:
                findings = _findings(study, stage)
            except NoSolution as error:
                return (str(error).partition("\n")[0],)
            new = [
                finding
                for key, finding in findings.items()
                if finding.code not in self._waived
                and not _is_remedied_by_flywheel(finding)
                and (finding.severity == ERROR if before is None else key not in before)
                and (self._notes or finding.severity != NOTE)
            ]
            if new:
                self._suspect = stage
                self.has_notes |= all(finding.severity == NOTE for finding in new)
                return tuple(
                    f"{drive}: {row.message}" if (drive := row.values.get("drive")) else row.message for row in new
                )
        return ()


def has_uneven_speed(machine: Design) -> bool:
    """Whether the speed fluctuates by more than its limit."""
    study = Study(machine)
    findings = _findings_or_none(study, "dynamics") if "dynamics" in study.stages else None
    return any(code == UNEVEN for code, _ in findings or ())


def _findings(study: Study, stage: str) -> FindingsByField:
    """Findings by code and field. Raises NoSolution."""
    return {(finding.code, finding.field): finding for finding in findings_of(study, (stage,))}


def _findings_or_none(study: Study, stage: str) -> FindingsByField | None:
    """Findings by code and field, None where the machine or one of its drives cannot be computed."""
    try:
        findings = _findings(study, stage)
    except NoSolution:
        return None
    return None if any(code == "no-drive" for code, _ in findings) else findings


def _is_remedied_by_flywheel(finding: Finding) -> bool:
    """Whether a flywheel not much larger than the present one keeps the speed even."""
    percent, limit = (finding.values.get(name) for name in ("percent", "wanted_percent"))
    return (
        finding.code == UNEVEN
        and isinstance(percent, float)
        and isinstance(limit, float)
        and percent <= ENLARGED * limit
    )


def nearest_accepted(
    is_accepted: Callable[[float, bool], bool], bad: float, good: float, tolerance: float = SAME
) -> tuple[float, float]:
    """Last accepted value from ``good`` towards ``bad`` and the next, rejected one, by bisection.

    is_accepted: value, whether a quick check is sufficient -> whether the value is accepted.
    """
    finest = tolerance * max(abs(good), abs(bad))
    for quick in (True, False):
        near = good
        while abs(near - bad) > finest:
            middle = 0.5 * (bad + near)
            near, bad = (middle, bad) if is_accepted(middle, quick) else (near, middle)
        if is_accepted(near, False):
            return near, bad
        bad = near
    return good, bad


# -- samples of many trial designs together ---------------------------------------------------------------------

MOTION = "motion."
PutValue = Callable[[Design, str, Any], Design]
"""Design, path, number or column of numbers -> the design with it at the path."""


class Peak(NamedTuple):
    """Highest value of a figure over the turn, and its greatest size."""

    curve: Curve
    extreme: Extreme
    size: float


Peaks = Mapping[str, Sequence[Peak]]
"""Key of a limit -> the peaks of its flanks."""


def curves_of(study: Study, keys: Sequence[str]) -> dict[str, tuple[Curve, ...]]:
    """Key of a limit -> the curves of its flanks, at the cam angles of a study."""
    return {key: tuple(LIMITS[key].curves(study)) for key in keys}


class SampledDesign(NamedTuple):
    """Samples of one of many designs.

    Attributes
    ----------
    number : int
        Index of the design.
    peaks : Peaks or None
        None where it cannot be computed.
    linkage : Kinematics
        Of all designs together; it has the same kinds of pairs as each of them.
    """

    number: int
    peaks: Peaks | None
    linkage: Kinematics


def sample_designs(
    design: Design, paths: Sequence[str], rows: np.ndarray, put: PutValue, keys: Sequence[str]
) -> Iterator[SampledDesign]:
    """Sample the designs with other values in some fields, as far as they can be computed together.

    Parameters
    ----------
    design : Design
    paths : sequence of str
        Paths of p fields.
    rows : ndarray (p, m) [unit of the field]
        Values of the fields in m designs.
    put : callable
    keys : sequence of str
        Keys of the limits.

    Yields
    ------
    SampledDesign
    """
    from core.study.batch import is_batchable
    from core.study.quantity_requests import QuantityRequest
    from core.study.stages_of_many import DesignBlock, equal_parts

    if not design.drive.has_disk:
        return
    read = [name for key in keys if key in USER_BOUNDS for name in bounded_quantities(design, key)]
    if not rows.size or not all(is_batchable(design, paths, QuantityRequest("", name, "max", 1.0)) for name in read):
        return
    stage = "dynamics" if any(LIMITS[key].needs_forces for key in keys) else "cam"
    for part in equal_parts(rows.shape[1], piecewise_angles(Study(design).uncut).theta.size):
        checkpoint()
        with_motion, fixed = design, {}
        for path, row in zip(paths, rows[:, part], strict=True):
            if path.startswith(MOTION):
                with_motion = put(with_motion, path, column(row))
            else:
                fixed[path] = row
        motion = None if with_motion is design else with_motion.drive.motion
        batch = DesignBlock(design, fixed, motion, rows[0, part].size)
        angles = piecewise_angles(batch.program)
        try:
            linkage, curves = batch.read(
                stage, *batch.spread(angles), lambda study: (study.linkage, curves_of(study, keys))
            )
        except NoSolution:  # of any design
            continue
        peaks = curve_peaks(curves, batch.count, angles)
        failed = batch.failed_at(stage)
        yield from (
            SampledDesign(part.start + k, None if failed[k] else peaks[k], linkage)
            for k in np.flatnonzero(~batch.separate).tolist()
        )


def curve_peaks(curves: Mapping[str, Sequence[Curve]], count: int, angles: Angles) -> list[Peaks]:
    """Peaks of the limits of each design; the samples of ``count`` designs follow one another."""
    every = [curve for rows in curves.values() for curve in rows]
    samples = np.array([curve.value for curve in every]).reshape(len(every) * count, -1)
    value, theta = (column.reshape(-1, count).tolist() for column in highest_of_samples(samples, angles))
    sizes = [
        np.reshape(curve.size, (count, -1)).max(axis=1).tolist() if np.ndim(curve.size) else [float(curve.size)] * count
        for curve in every
    ]
    result: list[Peaks] = []
    for k in range(count):
        peaks = iter(Peak(curve, Extreme(value[i][k], theta[i][k]), sizes[i][k]) for i, curve in enumerate(every))
        result.append({key: [next(peaks) for _ in rows] for key, rows in curves.items()})
    return result


def highest_of_samples(value: np.ndarray, angles: Angles) -> tuple[np.ndarray, np.ndarray]:
    """Highest sample of each row, or vertex of the parabola through it and its neighbours in the same piece.

    Parameters
    ----------
    value : ndarray (m, n), dimensionless
        The result has their unit.
    angles : Angles
        n cam angles.

    Returns
    -------
    highest : ndarray (m,), dimensionless
    theta : ndarray (m,) [rad]
        Angle of the highest sample.
    """
    value = np.where(np.isnan(value), -np.inf, value)
    top, last = value.argmax(axis=1), angles.theta.size - 1
    index = np.clip(top[:, None] + np.arange(-1, 2), 0, last)
    x, y = angles.theta[index], np.take_along_axis(value, index, axis=1)
    piece = angles.piece[index]
    inside = (top > 0) & (top < last) & (piece[:, 0] == piece[:, 2]) & np.isfinite(y).all(axis=1)
    x, y = x[inside], y[inside]
    before, after = x[:, 0] - x[:, 1], x[:, 2] - x[:, 1]
    left, right = (y[:, 0] - y[:, 1]) / before, (y[:, 2] - y[:, 1]) / after
    curvature = (right - left) / (after - before)
    slope = left - curvature * before
    highest = value[np.arange(top.size), top]
    highest[inside] -= np.where(curvature < 0.0, 0.25 * slope * slope / np.where(curvature < 0.0, curvature, 1.0), 0.0)
    return highest, angles.theta[top]


# -- trial designs ----------------------------------------------------------------------------------------------


class Outcome(NamedTuple):
    """Readings of a design; empty where it has no cam.

    Attributes
    ----------
    readings : tuple of LimitReading
        The tightest first.
    pressures : tuple of float
        Greatest pressure angle [deg] where the motion rises, where it returns, and over the turn.
    problem : str
        Why the design has no cam; empty for samples.
    """

    readings: tuple[LimitReading, ...]
    pressures: tuple[float, ...]
    problem: str = ""

    @property
    def margin(self) -> float:
        """Least margin of all limits; NaN where there is no cam."""
        return self.readings[0].margin if self.readings else float("nan")

    @property
    def is_valid(self) -> bool:
        """Whether the design has a cam and satisfies all limits."""
        return bool(self.readings) and all(reading.is_satisfied for reading in self.readings)

    def reached(self, pressures: bool = False) -> dict[str, float]:
        """Limit -> value reached, with both pressure angles of rise and return where one is limited, or on request."""
        reached = {reading.key: reading.reached for reading in self.readings}
        if pressures or not reached.keys().isdisjoint(PRESSURE_ANGLES):
            stretches = zip(PRESSURE_ANGLES[:2], self.pressures, strict=False)
            reached |= {key: value for key, value in stretches if math.isfinite(value) and key not in reached}
        return reached


TINY = 1e-300  # [N]
RPM = math.pi / 30.0  # of a speed of the shaft [rad/s]
PRESSURE_ANGLES = ("pressure_angle_rise_deg", "pressure_angle_return_deg", "pressure_angle_deg")


class ContactLimit(NamedTuple):
    """Least contact force [N] up to the speed ``high`` [rad/s]; None: the typical part of the largest force."""

    force: float | None
    high: float

    def limit(self, largest: float) -> tuple[float, str]:
        """Least force [N] of a design with the given largest force, and the reason with the highest speed."""
        fast = f"up to {result_text(self.high / RPM)} rpm"
        if self.force is not None:
            return self.force, fast
        return FORCE_PART * largest, f"{100.0 * FORCE_PART:g} % of the largest, {result_text(largest)} N, {fast}"


class TrialDesigns:
    """Designs that differ in the values of some fields, and their readings of limits.

    They are evaluated by samples of every segment, many together where they are known in advance, or refined to the
    true extremes.

    Attributes
    ----------
    design : Design
    paths : sequence of str
        Paths of the varied fields.
    limits : dict
        Key of a limit -> value in its unit, None: the typical value for each design.
    notify : callable
        Called with the number of evaluated designs after each of them.
    contact : ContactLimit or None
        Least contact force on an open cam.
    checked : FindingsCheck
        Findings of the machine that contains the design.
    put : callable
        Design, path, value -> the design with the value.
    """

    def __init__(
        self,
        design: Design,
        paths: Sequence[str],
        limits: Mapping[str, float | None],
        notify: Callable[[int], object] = lambda count: None,
        contact: ContactLimit | None = None,
        checked: FindingsCheck | None = None,
        put: PutValue = edited,
    ) -> None:
        self.design, self.paths, self.limits, self.contact = design, tuple(paths), dict(limits), contact
        self.checked = checked or FindingsCheck(design)
        self._notify, self._put = notify, put
        self._outcomes: dict[tuple[tuple[float, ...], bool], Outcome] = {}
        self._is_force_short = False  # whether the last rejection was by a force
        self._force_readings: dict[tuple[float, ...], tuple[LimitReading, ...]] = {}

    def with_values(self, values: Sequence[float]) -> Design:
        """Return the design with these values. Raises DesignError where it has faults."""
        design = self.design
        for path, value in zip(self.paths, values, strict=True):
            design = self._put(design, path, float(value))
        tables = {path.partition(".")[0] for path in self.paths}
        faults = [fault for name in sorted(tables) for fault in part_faults(design.tables[name], name)]
        if faults := faults or list(spatial_faults(design.drive)):
            raise DesignError(faults)
        return design

    def at(self, *values: float, refined: bool = True) -> Outcome:
        """Outcome of the design with these values."""
        key = (values, refined)
        if key not in self._outcomes:
            checkpoint()
            self._outcomes[key] = self._evaluated(values, refined)
            self._notify(len(self._outcomes))
        return self._outcomes[key]

    def scan(self, points: Iterable[tuple[float, ...]]) -> None:
        """Sample all these values together, as far as that is possible, before they are read one by one."""
        trials = {}
        for values in points:
            with suppress(DesignError):
                if (values, False) not in self._outcomes:
                    trials[values] = self.with_values(values)
        requested, designs, rows = list(trials), list(trials.values()), np.array([*trials]).T
        for number, peaks, linkage in sample_designs(self.design, self.paths, rows, self._put, self._keys):
            study = Study(designs[number])
            vars(study)["linkage"] = linkage  # a typical limit reads the kinds of its pairs
            self._outcomes[requested[number], False] = Outcome((), ()) if peaks is None else self._outcome(study, peaks)
        self._notify(len(self._outcomes))

    @property
    def _keys(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys((*self.limits, *PRESSURE_ANGLES)))

    def forces(self, *values: float) -> tuple[LimitReading, ...]:
        """Readings of the limits of forces: contact of the follower, and space for a shaft that transmits the torque.

        Empty where there are no forces, or friction jams. They take longer than the limits of the shape.
        """
        if values not in self._force_readings:
            self._force_readings[values] = tuple(self._read_forces(Study(self.with_values(values))))
        return self._force_readings[values]

    def _read_forces(self, study: Study) -> Iterator[LimitReading]:
        try:
            if self.contact is not None:
                yield _contact_reading(study, self.contact)
            if self._by_torque(study) and (typical := LIMITS[POLAR].typical(study)):
                peaks = _highest(study.at(piecewise_angles(study.program)), (POLAR,))[POLAR]
                yield _reading(POLAR, peaks, typical.value, typical.reason)
        except NoSolution:
            return

    def _by_torque(self, study: Study) -> bool:
        return POLAR in self.limits and self.limits[POLAR] is None and needs_torque(study)

    def new(self, *values: float, quick: bool = False) -> tuple[str, ...]:
        """Violated limits of forces with these values, else messages of the machine's new findings.

        ``quick``: only of the kind that was violated last.
        """
        if self._is_force_short or not quick:
            violations = tuple(reading.text for reading in self.forces(*values) if not reading.is_satisfied)
            self._is_force_short = bool(violations) or (quick and self._is_force_short)
            if violations or quick:
                return violations
        return self.checked.new(self.with_values(values), quick)

    def is_accepted(self, *values: float, quick: bool = False) -> bool:
        """Whether every limit is satisfied and the machine has no new finding; ``quick`` as for ``new``."""
        return self.at(*values).is_valid and not self.new(*values, quick=quick)

    def _evaluated(self, values: Sequence[float], refined: bool) -> Outcome:
        try:
            study = Study(self.with_values(values))
            sampled = study.at(piecewise_angles(study.program))
            return self._outcome(sampled, _highest(sampled, self._keys, refined))
        except (NoSolution, DesignError) as error:
            return Outcome((), (), str(error).partition("\n")[0])

    def _outcome(self, study: Study, peaks: Peaks) -> Outcome:
        readings = []
        for key, stated in self.limits.items():
            typical = (
                LIMITS[key].typical(study) if stated is None and not (key == POLAR and self._by_torque(study)) else None
            )
            limit = typical.value if typical else stated
            if limit is not None:
                readings.append(_reading(key, peaks[key], limit, typical.reason if typical else ""))
        pressures = tuple(max((peak.extreme.value for peak in peaks[key]), default=-np.inf) for key in PRESSURE_ANGLES)
        return Outcome(tuple(sorted(readings, key=_margin)), pressures)


@np.errstate(invalid="ignore", over="ignore", divide="ignore")
def _highest(study: Study, keys: Sequence[str], refined: bool = True) -> Peaks:
    """Peaks of the limits over the turn, from a study at samples of every segment."""
    curves = curves_of(study, keys)
    if not refined:
        return curve_peaks(curves, 1, study.angles)[0]
    extremes = find_highest(
        lambda angles: {
            f"{key} {i}": curve.value
            for key, rows in curves_of(study.at(angles), keys).items()
            for i, curve in enumerate(rows)
        },
        study.program,
    )
    return {
        key: [Peak(curve, extremes[f"{key} {i}"], float(np.max(curve.size))) for i, curve in enumerate(rows)]
        for key, rows in curves.items()
    }


def _reading(key: str, peaks: Sequence[Peak], limit: float, reason: str) -> LimitReading:
    """Reading of the flank with the least margin."""
    readings = [
        LimitReading(
            key,
            limit,
            curve.reached(extreme.value, size),
            curve.margin(extreme.value, limit, size),
            extreme.theta,
            reason,
            curve.whose,
        )
        for curve, extreme, size in peaks
        if extreme.value > -np.inf
    ]
    return min(readings, key=_margin, default=LimitReading(key, limit, np.nan, np.inf, 0.0))


def _contact_reading(study: Study, contact: ContactLimit) -> LimitReading:
    """Reading of the least contact force up to the highest speed."""
    least, largest = study.contact_force.least(contact.high), study.contact_force.greatest(contact.high)
    limit, reason = contact.limit(largest)
    return LimitReading(
        FORCE, limit, least.value, (least.value - limit) / max(abs(largest), abs(limit), TINY), least.theta, reason
    )


def _margin(reading: LimitReading) -> float:
    return reading.margin
