"""Several drives on one shaft: each a study of its own, by its own angle; their torques, speed and stability together, by machine
angle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from core import shaft
from core.design import BALANCER, Design, Shaft, contradiction, distances, excess, only, path_of, slugs
from core.dynamics import power_terms
from core.errors import KindynaError, NoAnswer, NoStability
from core.findings import ERROR, NOTE, WARNING, Finding, Residual
from core.motion import TURN, degrees
from core.motion.extremes import Extreme, Range, find_extremes
from core.motion.turn import Place, Turn
from core.shaft import Flywheel, LoadCurve, balance_drive, combined, levels, peaks, rms
from core.study.stages import evaluations, memory, whole_shaft
from core.study.study import SAMPLES, STAGES, Study

if TYPE_CHECKING:
    from core.stability import Stability

_ORDER = {ERROR: 0, WARNING: 1, NOTE: 2}
_DYNAMICS = ("dynamics",)


class ShaftStudy:
    """A shaft with its drives at equally spaced machine angles, or at the angles given.

    ``drives`` holds the study of each drive alone (``design.only``), so that an edit of one computes that one anew. The machine
    angle θ counts as the shaft turns; a drive's own angle is θ less its phase, for a mirrored one too, whose torque turns the same
    shaft. A drive that has no answer is in ``failures``, and takes no other with it: only what needs all raises its NoAnswer.
    """

    def __init__(self, design: Design, samples: int = SAMPLES, theta: np.ndarray | None = None) -> None:
        self.design = design
        self.samples = samples
        self._given = theta

    # -- drives and angles ----------------------------------------------------------------------------------

    @cached_property
    def drives(self) -> Mapping[str, Study]:
        """Name -> study by its own angle, in the order of the list."""
        return {
            drive.name or self.design.name: Study(only(self.design, i), self.samples)
            for i, drive in enumerate(self.design.drives)
        }

    @cached_property
    def slugs(self) -> Mapping[str, str]:
        """Name -> as columns and folders have it."""
        return dict(zip(self.drives, slugs(self.design), strict=True))

    def number(self, name: str) -> int:
        """Of the drive in the list."""
        return list(self.drives).index(name)

    @cached_property
    def stages(self) -> tuple[str, ...]:
        """Those that any of the drives has."""
        return tuple(name for name in STAGES if any(name in study.stages for study in self.drives.values()))

    @property
    def angle_name(self) -> str:
        """What the angles of its drives' findings are called."""
        return "cam angle"

    @property
    def omega(self) -> float:
        """[rad/s] of the shaft, counted as it turns."""
        return self.design.speed_rpm * TURN / 60.0

    @property
    def angle_degrees(self) -> np.ndarray:
        """The equally spaced machine angles of the tables [deg] (n,), each rounded once."""
        return degrees(self.samples)

    @cached_property
    def theta(self) -> np.ndarray:
        """Machine angles (n,) [rad]."""
        return np.deg2rad(self.angle_degrees) if self._given is None else self._given

    def at_theta(self, theta: np.ndarray) -> ShaftStudy:
        """The same shaft at any machine angles (n,) [rad]; at a join the right-hand limit."""
        there = ShaftStudy(self.design, self.samples, np.atleast_1d(theta))
        for name in ("drives", "failures", "_balance"):  # what there is does not depend on the angles
            if name in vars(self):
                vars(there)[name] = vars(self)[name]
        return there

    @cached_property
    def places(self) -> Mapping[str, Place]:
        """Name -> where it stands on the shaft."""
        rows = zip(self.drives.items(), self.design.drives, strict=True)
        return {name: _place(study, drive.phase_deg) for (name, study), drive in rows}

    def there(self, name: str) -> Study:
        """The study of a drive at these machine angles."""
        return _there(self.drives[name], self.places[name], self.samples, self._given)

    # -- who has an answer ----------------------------------------------------------------------------------

    @cached_property
    def carried(self) -> tuple[str, ...]:
        """The drives that the shaft carries; a motion that no cam makes is driven by something else."""
        return tuple(name for name, study in self.drives.items() if study.loads_shaft)

    @cached_property
    def failures(self) -> Mapping[str, NoAnswer]:
        """Name -> why it has none, of the drives that cannot be assembled or jam; its field is that of the whole file."""
        found = {}
        for i, (name, study) in enumerate(self.drives.items()):
            try:
                if study.loads_shaft:
                    study.require_load()
                else:
                    _ = study.linkage
            except NoAnswer as error:
                found[name] = type(error)(error.problem, path_of(i, error.field), error.hint, error.cam_angles)
        return found

    def _require_all(self, what: str) -> None:
        """Raises NoAnswer for the first drive that is missing."""
        for name in self.carried:
            if name in self.failures:
                error = self.failures[name]
                problem = f"{what} lacks the drive {name}: {error.problem}"
                raise type(error)(problem, error.field, error.hint, error.cam_angles)

    # -- torque ---------------------------------------------------------------------------------------------

    def drive_torque(self, name: str) -> np.ndarray:
        """What one drive asks of the shaft at constant speed (n,) [N m]. Raises NoAnswer where it has none."""
        if name in self.failures:
            raise self.failures[name]
        study, place = self.drives[name], self.places[name]
        if self._given is None and (order := _on_grid(place, self.samples)) is not None:
            return np.asarray(study.shaft_torque[order])
        return self.there(name).shaft_torque

    def drive_load(self, name: str) -> LoadCurve:
        """The same as a curve by machine angle."""
        if name in self.failures:
            raise self.failures[name]
        parts = self.drives[name].depends_on("dynamics"), self.places[name]
        curve: LoadCurve = memory.get("load on shaft", parts, lambda: combined([self._turned_load(name)]))
        return curve

    def _turned_load(self, name: str) -> tuple[LoadCurve, Place]:
        return self.drives[name].load_curve, Place(self.places[name].phase)

    def drive_peak(self, name: str) -> Extreme:
        """That of the greatest size of what one drive asks of the shaft [N m], by machine angle. Raises NoAnswer as ``drive_load``."""
        return _greatest(peaks(self.drive_load(name)))

    @property
    def cams_torque(self) -> np.ndarray:
        """That of all drives, without the balance cam (n,) [N m]. Raises NoAnswer, which names the drive that is missing."""
        self._require_all("the shaft's torque")
        return np.asarray(sum((self.drive_torque(name) for name in self.carried), np.zeros(self.theta.size)))

    @property
    def torque(self) -> np.ndarray:
        """What the shaft must be given at constant speed (n,) [N m], by all drives and the balance cam."""
        return self.cams_torque if self.balancer is None else self.cams_torque + self.balancer_torque

    @property
    def _key(self) -> tuple[Any, ...]:
        return tuple((self.drives[name].depends_on("dynamics"), self.places[name]) for name in self.carried)

    @property
    def cams_load(self) -> LoadCurve:
        """The sum of the drives as one curve, without the balance cam. Raises NoAnswer as ``cams_torque``."""
        self._require_all("the shaft's torque")

        def compute() -> LoadCurve:
            evaluations["shaft load"] += 1
            return combined([self._turned_load(name) for name in self.carried])

        curve: LoadCurve = memory.get("shaft load", self._key, compute)
        return curve

    @property
    def load(self) -> LoadCurve:
        """The sum of all, the balance cam included."""
        balance = self._balance
        if balance is None:
            return self.cams_load
        key = self._key, self.design.balancer, self.omega
        places = [(self.cams_load, Place()), (balance[0].load_curve, balance[1])]
        curve: LoadCurve = memory.get("balanced load", key, lambda: combined(places))
        return curve

    @cached_property
    def _balance(self) -> tuple[Study, Place] | None:
        """The study of the balance cam by its own angle, and where it stands."""
        part = self.design.balancer
        if part is None:
            return None
        key = self._key, part, self.omega
        drive = memory.get("balance cam", key, lambda: balance_drive(self.cams_load, part, self.omega))
        camshaft = self.design.camshaft
        alone = Design(BALANCER, Shaft(camshaft.rotation, camshaft.speed_rpm), (drive,))
        study = Study(alone, self.samples)
        return study, _place(study, part.phase_deg)

    @property
    def balancer(self) -> Study | None:
        """The balance cam as a drive of its own, by its own angle; None where the design has none. Raises NoAnswer where nothing
        can balance the torque, or the torque has no answer."""
        return None if self._balance is None else self._balance[0]

    @property
    def balancer_place(self) -> Place:
        """Where the balance cam stands on the shaft. Raises NoAnswer as ``balancer``."""
        assert self._balance is not None, "a design without [balancer]"
        return self._balance[1]

    @property
    def balancer_peak(self) -> Extreme:
        """The torque of the greatest size that the balance cam asks of the shaft [N m], by its own angle."""
        assert self._balance is not None, "a design without [balancer]"
        return _greatest(peaks(self._balance[0].load_curve))

    @property
    def balancer_torque(self) -> np.ndarray:
        """That of the balance cam (n,) [N m], of a design that has one."""
        assert self._balance is not None, "a design without [balancer]"
        study, place = self._balance
        return _there(study, place, self.samples, self._given).shaft_torque

    # -- figures of the sum ---------------------------------------------------------------------------------

    @property
    def mean_torque(self) -> float:
        """T̄ [N m]."""
        return self.load.mean

    @property
    def rms_torque(self) -> float:
        """√(mean of T²) [N m]."""
        return rms(self.load)

    @property
    def peaks(self) -> Range:
        """Lowest and highest torque [N m], by machine angle."""
        return peaks(self.load)

    @property
    def peak_torque(self) -> Extreme:
        """That of the greatest size."""
        return _greatest(self.peaks)

    @property
    def peak_power(self) -> float:
        """The most that the shaft takes at constant speed [W]."""
        return self.peaks.high.value * self.omega

    @property
    def levelled(self) -> bool:
        """Whether flywheel or motor make the motor's torque another than the shaft's."""
        return levels(self.design.camshaft)

    @property
    def flywheel(self) -> Flywheel:
        """Sizing, true speed and motor torque, by machine angle. Raises NoAnswer as ``torque``."""
        camshaft = self.design.camshaft

        def compute() -> Flywheel:
            evaluations["flywheel"] += 1
            return Flywheel(lambda angles: self.at_theta(angles.theta).torque, self.load, camshaft)

        wheel: Flywheel = memory.get("flywheel", (self._key, self.design.balancer, camshaft), compute)
        return wheel

    @cached_property
    def turn(self) -> Turn:
        """The pieces of the machine's turn, between the joins of all drives that have an answer."""
        return Turn(
            [(self.drives[name].program, self.places[name]) for name in self.carried if name not in self.failures]
        )

    @property
    def motor_torque(self) -> np.ndarray:
        """T̄ + k(ω̄ - ω) (n,) [N m]; the shaft's without a flywheel. Raises NoAnswer where the motor stalls."""
        return self.flywheel.motor_torque(self.turn.angles(self.theta)) if self.levelled else self.torque

    @property
    def speed(self) -> np.ndarray:
        """The true speed of the shaft (n,) [rad/s]; constant without a flywheel. Raises NoAnswer where the motor stalls."""
        return (
            self.flywheel.speed(self.turn.angles(self.theta)) if self.levelled else np.full(self.theta.size, self.omega)
        )

    @property
    def motor_range(self) -> Mapping[str, Range]:
        """Refined extremes of ``motor_torque`` [N m], ``speed`` [rad/s] and ``motor_power`` [W]. Raises NoAnswer where it stalls."""
        if not self.levelled:
            low, high = self.peaks.low, self.peaks.high
            power = Range(Extreme(low.value * self.omega, low.theta), Extreme(high.value * self.omega, high.theta))
            steady = Extreme(self.omega, 0.0)
            return {"motor_torque": self.peaks, "speed": Range(steady, steady), "motor_power": power}
        wheel = self.flywheel

        def values(angles: Any) -> Mapping[str, np.ndarray]:
            torque, speed = wheel.motor_torque(angles), wheel.speed(angles)
            return {"motor_torque": torque, "speed": speed, "motor_power": torque * speed}

        key = self._key, self.design.balancer, self.design.camshaft
        found: Mapping[str, Range] = memory.get("motor range", key, lambda: find_extremes(values, self.turn))
        return found

    # -- the flexible shaft ---------------------------------------------------------------------------------

    @property
    def stability(self) -> Stability | None:
        """Of all drives together; None where the shaft is rigid, or nothing excites it."""
        try:
            return self.flexible_shaft()
        except NoStability:
            return None

    def flexible_shaft(self) -> Stability:
        """The same. Raises NoStability, which says why there is none; NoAnswer where a drive is missing."""
        elastic = self.design.camshaft.elastic
        if elastic is None:
            raise NoStability("the camshaft is rigid", "shaft", "give camshaft_inertia_kg_m2 and stiffness_nm_per_rad")
        self._require_all("the flexible shaft")
        rows = [(self.number(name), self.drives[name], self.places[name]) for name in self.carried]
        key = self._key, self.carried, elastic, self.omega
        found = memory.get("whole shaft", key, lambda: whole_shaft(self.carried, rows, elastic, self.omega))
        if isinstance(found, NoStability):
            raise found
        stable: Stability = found
        return stable

    # -- findings -------------------------------------------------------------------------------------------

    def findings(self, stages: Sequence[str] = ()) -> tuple[Finding, ...]:
        """What each drive exceeds, its name among the values, and what the whole does; the gravest first."""
        found: list[Finding] = []
        for i, (name, study) in enumerate(self.drives.items()):
            found += [
                replace(f, field=path_of(i, f.field), values={**f.values, "drive": name})
                for f in _of_drive(study, stages)
            ]
        found += [_failure(name, error) for name, error in self.failures.items()]
        found += self._timing_findings() if not stages or "motion" in stages else []
        if not stages or "dynamics" in stages:
            found += self._shaft_findings()
        if not stages or "stability" in stages:
            found += self._stability_findings()
        return tuple(sorted(found, key=lambda f: _ORDER[f.severity]))

    def _timing_findings(self) -> list[Finding]:
        found = []
        for i, (row, at) in enumerate(zip(self.design.timing, distances(self.design), strict=True)):
            if not at.kept:
                values: dict[str, float | str] = {"first": row.first, "second": row.second, "after_deg": at.after_deg}
                values |= {"least_deg": row.least_deg, "first_deg": at.first_deg, "second_deg": at.second_deg}
                found.append(Finding("timing-broken", ERROR, f"timing[{i}]", None, values))
        if ring := contradiction(self.design):
            rows = ", ".join(f"timing[{i}]" for i in ring)
            too_much: dict[str, float | str] = {"rows": rows, "excess_deg": excess(self.design, ring)}
            found.append(Finding("timing-contradicts", ERROR, f"timing[{ring[0]}]", None, too_much))
        return found

    def _shaft_findings(self) -> list[Finding]:
        if self.failures.keys() & set(self.carried):
            return []
        found = []
        try:
            study = self.balancer
        except NoAnswer as error:
            return [_failure("the balance cam", error)]
        if study is not None:
            for each in _of_drive(study, ()):
                found.append(replace(each, field=_of_balancer(each.field), values={**each.values, "drive": BALANCER}))
        return found + shaft.findings(self.flywheel) if self.levelled else found

    def _stability_findings(self) -> list[Finding]:
        if self.design.camshaft.elastic is None or self.failures.keys() & set(self.carried):
            return []
        from core.stability import findings

        try:
            return findings(self.flexible_shaft())
        except NoStability as error:
            return [Finding("no-stability", NOTE, error.field, None, {"why": error.problem, "hint": error.hint})]

    # -- proof ----------------------------------------------------------------------------------------------

    def certificate(self, stages: Sequence[str] = ()) -> dict[str, Residual]:
        """Each residual with its bound: those of each drive by its slug, and the power balance of the sum."""
        proof: dict[str, Residual] = {}
        for name, study in self.drives.items():
            if name not in self.failures:
                own = tuple(stage for stage in stages if stage in study.stages)
                proof |= {
                    f"{self.slugs[name]}.{key}": r
                    for key, r in (study.certificate(own) if own or not stages else {}).items()
                }
        if (not stages or "dynamics" in stages) and not self.failures and self.carried:
            proof["power_balance"] = self._power_balance(proof)
        if not stages or "stability" in stages:
            found = None if self.failures else self.stability
            proof |= {} if found is None else found.certificate
        return proof

    def _power_balance(self, proof: Mapping[str, Residual]) -> Residual:
        """What the curve of the sum gives at these angles against where each drive, by its own angle, takes it: into kinetic and
        potential energy and friction; relative to the peak of these terms."""
        terms, derived = [], 0.0
        for name in self.carried:
            there = self.there(name)
            terms += power_terms(there.linkage, there.dynamics, there.loading)
            derived += (
                proof[f"{self.slugs[name]}.power_balance"].derived
                if f"{self.slugs[name]}.power_balance" in proof
                else 0.0
            )
        given = shaft.value(self.cams_load, self.theta) * self.omega
        peak = max(float(np.abs(term).max(initial=0.0)) for term in [*terms, given]) or 1.0
        return Residual(float(np.abs(given - sum(terms)).max()) / peak, derived)


def _greatest(found: Range) -> Extreme:
    return max((found.low, found.high), key=lambda extreme: abs(extreme.value))


def _place(study: Study, phase_deg: float) -> Place:
    return Place(float(np.deg2rad(phase_deg % 360.0)), study.turning)


def _there(study: Study, place: Place, samples: int, theta: np.ndarray | None) -> Study:
    """A drive's study at machine angles; at equally spaced ones it is remembered."""
    turn = Turn([(study.program, place)])
    if theta is not None:
        return study.at(turn.own(0, turn.angles(theta)))

    def compute() -> Any:
        return turn.own(0, turn.angles(np.deg2rad(degrees(samples))), kept=True)

    return Study(study.design, samples, memory.get("grid", (study.program, samples, place), compute))


def _on_grid(place: Place, samples: int) -> np.ndarray | None:
    """The numbers (n,) of the own grid's angles at the machine's, where both grids fall together; else None."""
    steps = place.phase * samples / TURN
    if abs(steps - round(steps)) > 1e-9:
        return None
    return np.asarray((int(place.sense) * (np.arange(samples) - round(steps))) % samples)


def _of_drive(study: Study, stages: Sequence[str]) -> Iterator[Finding]:
    """Its findings, stage by stage as far as it has answers."""
    for stage in study.stages:
        if stages and stage not in stages:
            continue
        try:
            yield from study.findings((stage,))
        except KindynaError:
            return


def _failure(name: str, error: NoAnswer) -> Finding:
    at = error.cam_angles[0][0] if error.cam_angles else None
    return Finding("no-drive", ERROR, error.field, at, {"drive": name, "why": error.problem, "hint": error.hint})


def _of_balancer(field: str) -> str:
    """The balancer's field that a finding of it as a drive names."""
    table, _, key = field.partition(".")
    return f"{BALANCER}.{key}" if table in ("cam", "loads") else BALANCER
