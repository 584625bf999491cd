"""Waves of a cam profile and their effect on the follower, to first order.

Sources: R. L. Norton, *Cam Design and Manufacturing Handbook*, ch. 16.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from core.design import Design, only
from core.elastic import kinematics_at_motion
from core.errors import NoSolution
from core.mechanism.kinematics import Kinematics
from core.motion import TURN
from core.study import Study
from core.study.quantities import quantity
from core.study.quantity_requests import TORQUE, QuantityRequest

# -- waves of the profile, to first order -----------------------------------------------------------------------


ANGLES = 2880  # of the turn, for extremes with waves
WAVY_MACHINES_AT_ONCE = 64  # machines
DRIVE_TORQUE = "drive_torque"

_STATISTICS: Mapping[str, Callable[[np.ndarray], np.ndarray]] = {
    "max": lambda f: f.max(axis=-1),
    "min": lambda f: f.min(axis=-1),
    "abs": lambda f: np.abs(f).max(axis=-1),
    "rms": lambda f: np.sqrt((f * f).mean(axis=-1)),
    "mean": lambda f: f.mean(axis=-1),
    "range": lambda f: np.ptp(f, axis=-1),
}
"""Statistic over the turn, of values (..., n) at even angles."""

_WITH_WAVE: Mapping[str, Callable[[Waves, np.ndarray, Callable[[int], np.ndarray]], np.ndarray]] = {
    "displacement": lambda s, f, wave: f + wave(0),
    "velocity": lambda s, f, wave: f + s.omega * wave(1),
    "acceleration": lambda s, f, wave: f + s.omega**2 * wave(2),
    "jerk": lambda s, f, wave: f + s.omega**3 * wave(3),
    "contact_force": lambda s, f, wave: f + s.force_per_error * wave(2),
    DRIVE_TORQUE: lambda s, f, wave: f * s.force_ratio(wave(2)),  # T = F_c times a length
    "contact_pressure": lambda s, f, wave: f * np.sqrt(np.maximum(s.force_ratio(wave(2)), 0.0)),  # Hertz, line contact
}
"""Quantity -> its values with a wave, from values (..., n) without and derivatives of the motion's error by the cam angle."""


class Waves:
    """Waves of a study's profile, at its cam angles. Raises NoSolution where there is no cam.

    Attributes
    ----------
    theta : ndarray (n,) [rad]
        Cam angles of the study.
    omega : float [rad/s]
    amplitude : float [m]
    normal_per_motion : ndarray (n,) [m/m or m/rad]
        |b|, displacement of the contact point along the normal of the first flank, by the motion.
    has_forces : bool
        Whether loads press the follower on the cam, and no friction jams.
    """

    def __init__(self, study: Study) -> None:
        assert study.design.waviness is not None, "a design with waviness"
        self.study, self.waves, self.theta = study, study.design.waviness, study.theta
        self.omega: float = study.omega
        (self.flank, *_), self.amplitude = study.cam.flanks, 1e-3 * self.waves.amplitude_mm
        self.has_forces = not study.loading.is_empty and study.jam is None
        pose = self.motion_kinematics.bodies[self.flank.body]
        displacement = pose.origin[1] + 1j * pose.turn[1] * (self.flank.contact - pose.origin[0])
        self.normal_per_motion = np.abs((np.conj(self.flank.normal) * displacement).real)

    def at(self, theta: np.ndarray) -> Waves:
        """Waves of the same profile at other cam angles.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Cam angles.

        Returns
        -------
        Waves
        """
        return Waves(self.study.at_theta(theta))

    def error(self, lobes: np.ndarray, phase: np.ndarray) -> Callable[[int], np.ndarray]:
        """Error of the motion by waves, as a function of the order of its derivative by the cam angle.

        Parameters
        ----------
        lobes : ndarray (m,), dimensionless
            Number of lobes of m waves.
        phase : ndarray (m,) [rad]
            Their phases.

        Returns
        -------
        callable
            Order -> ndarray (m, n) [m or rad].
        """
        n, angle = lobes[:, None], lobes[:, None] * self.theta + phase[:, None]
        return lambda order: self.amplitude / self.normal_per_motion * n**order * np.cos(angle + 0.25 * order * TURN)

    @cached_property
    def motion_kinematics(self) -> Kinematics:
        """Kinematics of the mechanism, with derivatives by the motion."""
        return kinematics_at_motion(
            self.study.mechanism, self.study.driver_ranges, self.study.motion.displacement[0], 1.0
        )

    @cached_property
    def mass(self) -> np.ndarray:
        """Reduced mass of all moving parts (n,) [kg or kg m²], in the coordinate of the motion."""
        return np.asarray(self.study.loading.inertia(self.motion_kinematics, 1)[0])

    @cached_property
    def force_per_error(self) -> np.ndarray:
        """Contact force by the second derivative of the error by the cam angle (n,) [N/m or N/rad]."""
        return self.mass * self.omega**2 / self.normal_per_motion

    def force_ratio(self, second: np.ndarray) -> np.ndarray:
        """Contact force with waves over that without.

        Parameters
        ----------
        second : ndarray (..., n) [m or rad]
            Second derivative of the error by the cam angle.

        Returns
        -------
        ndarray (..., n), dimensionless
        """
        force = self.study.dynamics.contact
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(force == 0.0, 1.0, 1.0 + self.force_per_error * second / force)

    def change(self, name: str, values: np.ndarray, wave: Callable[[int], np.ndarray]) -> np.ndarray:
        """Change of a quantity by a wave.

        Parameters
        ----------
        name : str
            Name of the quantity.
        values : ndarray (..., n) [SI unit of the quantity]
            Its values without the wave.
        wave : callable
            Order -> derivative of the motion's error, ndarray (..., n) [m or rad], as by `error`.

        Returns
        -------
        ndarray (..., n) [SI unit of the quantity]
        """
        return _WITH_WAVE[name](self, values, wave) - values

    def worst_error(self, sign: float, order: int) -> np.ndarray:
        """Greatest derivative of the error at every cam angle, by a wave with the most lobes.

        Parameters
        ----------
        sign : float
            Side of the error, +1 or -1.
        order : int
            Order of the derivative by the cam angle.

        Returns
        -------
        ndarray (n,) [m or rad]
        """
        return sign * self.amplitude / self.normal_per_motion * float(self.waves.lobes_to) ** order

    def changes(self, name: str) -> bool:
        """Whether waves change a quantity."""
        return name in _WITH_WAVE and (self.has_forces or quantity(name).stage == "motion")

    def summary(self) -> dict[str, float]:
        """Greatest effects of the waves, by column.

        Along the path of the contact, at the greatest pressure angle ψ: the error e/cos ψ [mm], and with the most lobes n the
        acceleration e (n ω)²/cos ψ [mm/s²]; the change of the contact force [N], and the least contact force of an open cam.

        Of an elastic follower: the number of lobes at resonance, the greatest amplification |z/s| = k/|k + ks - m Ω² + i c Ω|,
        Ω = n ω, over all numbers of lobes, and the force k |1 - z/s| by its error [N].
        """
        steepest, most = float(np.abs(self.flank.pressure_angle).max()), self.waves.lobes_to
        lift = 1e3 * self.amplitude / np.cos(steepest) if steepest < 0.25 * TURN else np.inf
        effects = {
            "lift_error_mm": float(lift),
            "pressure_angle_deg": float(np.rad2deg(steepest)),
            "acceleration_mm_s2": float(lift * (most * self.omega) ** 2),
        }
        if self.has_forces:
            change = self.force_per_error * self.amplitude / self.normal_per_motion * most**2
            effects["contact_force_n"] = float(change.max())
            if not self.study.is_form_closed:
                least = self.study.dynamics.contact - change
                is_loose = np.equal(self.study.loading.acting(self.study.linkage), 0.0)  # below the lash of a valve
                effects["least_contact_force_n"] = float(np.where(is_loose, np.inf, least).min())
        if not self.study.is_elastic or not self.has_forces:
            return effects
        model, lobes = self.study.elasticity.middle, np.arange(self.waves.lobes_from, most + 1)
        omega = lobes * abs(self.omega)
        ratio = model.stiffness / (model.stiffness + model.closing - model.mass * omega**2 + 1j * model.damping * omega)
        worst = int(np.abs(ratio).argmax())
        error = self.amplitude / float(self.normal_per_motion.min())
        return effects | {
            "natural_lobes": float(model.natural_frequency / abs(self.omega)),
            "amplified": float(abs(ratio[worst])),
            "amplified_lobes": int(lobes[worst]),
            "elastic_contact_force_n": float(
                (model.stiffness * np.abs(1.0 - ratio)).max() * error / float(self.normal_per_motion.min())
            ),
        }


WavedQuantity = tuple[Waves, str, np.ndarray]
"""Waves, the quantity that they change, and its values (n,) without waves."""


class AllWaves:
    """Waves of all cams of a design, independent of each other.

    Attributes
    ----------
    by_drive : dict
        Number of a drive, or None for the only drive of a design -> its waves, where it has any.
    """

    def __init__(self, design: Design) -> None:
        self.design = design
        singles = {i: replace(only(design, i), waviness=design.waviness) for i in range(len(design.drives))}
        waves = {i if design.listed else None: waves_of(Study(single)) for i, single in singles.items()}
        self.by_drive = {number: w for number, w in waves.items() if w is not None}

    def random_waves(self, number: int | None, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
        """Random waves of a drive in machines; all numbers of lobes and all phases are equally likely.

        Parameters
        ----------
        number : int or None
            Number of the drive.
        count : int
            Number of machines.
        seed : int

        Returns
        -------
        lobes : ndarray (count,), dimensionless
        phase : ndarray (count,) [rad]
        """
        rng, waves = np.random.default_rng([seed + (number or 0), 1]), self.by_drive[number].waves
        return rng.integers(waves.lobes_from, waves.lobes_to + 1, count), TURN * rng.random(count)

    def shifts(self, request: QuantityRequest, count: int, seed: int) -> np.ndarray:
        """Changes of a figure by waves, in random machines.

        Parameters
        ----------
        request : QuantityRequest
        count : int
            Number of machines.
        seed : int

        Returns
        -------
        ndarray (count,) [unit of the figure]
        """
        nominal, waved = self._waved(request)
        if request.statistic not in _STATISTICS or not waved:
            return np.zeros(count)
        random = [self.random_waves(number, count, seed) for number in waved]
        statistic, shifts = _STATISTICS[request.statistic], np.zeros(count)
        for part in (slice(i, i + WAVY_MACHINES_AT_ONCE) for i in range(0, count, WAVY_MACHINES_AT_ONCE)):
            values = np.tile(nominal, (shifts[part].size, 1))
            for (waves, name, drive_values), (lobes, phase) in zip(waved.values(), random, strict=True):
                values += waves.change(name, drive_values, waves.error(lobes[part], phase[part]))
            shifts[part] = statistic(values) - statistic(nominal)
        return shifts / request.unit

    def worst(self, request: QuantityRequest, side: float) -> float:
        """Greatest change of an extreme towards a side, +1 upwards, in its unit, by waves with the most lobes in their worst phase."""
        nominal, waved = self._waved(request)
        if request.statistic not in ("max", "min", "abs") or not waved:
            return 0.0
        statistic, shifts = _STATISTICS[request.statistic], []
        for end in (np.maximum, np.minimum):
            changes = [
                end(*(waves.change(name, values, partial(waves.worst_error, sign)) for sign in (1.0, -1.0)))
                for waves, name, values in waved.values()
            ]
            shifts.append(float(statistic(nominal + np.sum(changes, axis=0)) - statistic(nominal)))
        return side * max(side * shift for shift in shifts) / request.unit

    def _waved(self, request: QuantityRequest) -> tuple[np.ndarray, Mapping[int | None, WavedQuantity]]:
        """Values (n,) of the requested quantity without waves, and by drive the quantities that waves change."""
        if request.key.partition(":")[0] == TORQUE and self.design.listed:
            return self._torque
        waves = self.by_drive.get(request.drive)
        if waves is None or not waves.changes(request.name):
            return np.zeros(0), {}
        values = quantity(request.name).value(waves.study)
        return values, {request.drive: (waves, request.name, values)}

    @cached_property
    def _torque(self) -> tuple[np.ndarray, Mapping[int | None, WavedQuantity]]:
        """Total torque of all drives at even machine angles, and the torques of drives with waves."""
        theta = np.arange(ANGLES) * TURN / ANGLES
        with suppress(NoSolution):
            shaft, waved = Study(self.design).camshaft.at_theta(theta), dict[int | None, WavedQuantity]()
            for name in shaft.loading_drives:
                number = shaft.drive_number(name)
                if number in self.by_drive and self.by_drive[number].changes(DRIVE_TORQUE):
                    waves = self.by_drive[number].at(shaft.positions[name].drive_angle(theta))
                    waved[number] = waves, DRIVE_TORQUE, shaft.drive_torque(name)
            return shaft.torque, waved
        return np.zeros(0), {}


def waves_of(study: Study) -> Waves | None:
    """Waves of a design's profile at even angles; None without waviness, or where no cam is possible."""
    if study.design.listed or study.design.waviness is None or not study.has_disk:
        return None
    try:
        return Waves(study.at_theta(np.arange(ANGLES) * TURN / ANGLES))
    except NoSolution:
        return None
