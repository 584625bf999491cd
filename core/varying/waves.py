"""What waves of the profile do at the follower, to first order: a wave e cos(nθ + φ) along the profile's normal moves the motion by
e cos(nθ + φ)/|b|, b = dn/dy the way of the contact along that normal for a motion of 1 (cos ψ of a translating roller); its acceleration is
larger by (n ω)² times that, and the cam has to press the harder for it, by J/|b| times the acceleration, J the mass in the coordinate of
the motion (Norton, Cam Design and Manufacturing Handbook, ch. 16, of the error of a profile).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from core.design import Design, only
from core.elastic import by_motion
from core.errors import NoAnswer
from core.mechanism.kinematics import Kinematics
from core.motion import TURN
from core.study import Study
from core.study.batches.asked import TORQUE, Asked
from core.study.quantities import quantity

ANGLES = 2880  # of the turn, at which extremes with waves are taken
AT_ONCE = 64  # machines
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
    """The waves of a study's profile at its cam angles (n,). Raises NoAnswer where there is no cam.

    way  |b| (n,), of the point of the follower's body where it touches the first flank
    """

    def __init__(self, study: Study) -> None:
        assert study.design.waviness is not None, "as the caller saw"
        self.study, self.waves, self.theta = study, study.design.waviness, study.theta
        self.omega: float = study.omega
        (self.flank, *_), self.amplitude = study.cam.flanks, 1e-3 * self.waves.amplitude_mm
        self.loaded = not study.loading.empty and study.jam is None
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
        return by_motion(self.study.mechanism, self.study.driver_ranges, self.study.motion.displacement[0], 1.0)

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
            if not self.study.holds:
                found["least_contact_force_n"] = float((self.study.dynamics.contact - more).min())
        if not self.study.is_elastic or not self.loaded:
            return found
        one, lobes = self.study.elasticity.middle, np.arange(self.waves.lobes_from, most + 1)
        omega = lobes * abs(self.omega)
        ratio = one.stiffness / (one.stiffness + one.closing - one.mass * omega**2 + 1j * one.damping * omega)
        worst = int(np.abs(ratio).argmax())
        error = self.amplitude / float(self.way.min())
        return found | {
            "natural_lobes": float(one.natural / abs(self.omega)),
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

    def shifts(self, asked: Asked, count: int, seed: int) -> np.ndarray:
        """By how much (count,) waves change what is asked over the turn, in its unit, of machines drawn by chance."""
        own, changed = self._changed(asked)
        if asked.of not in OF or not changed:
            return np.zeros(count)
        drawn, of = [self.drawn(number, count, seed) for number in changed], OF[asked.of]
        found = np.zeros(count)
        for part in (slice(i, i + AT_ONCE) for i in range(0, count, AT_ONCE)):
            values = np.tile(own, (found[part].size, 1))
            for (waves, name, alone), (lobes, phase) in zip(changed.values(), drawn, strict=True):
                values += waves.more(name, alone, waves.error(lobes[part], phase[part]))
            found[part] = of(values) - of(own)
        return found / asked.unit

    def worst(self, asked: Asked, side: float) -> float:
        """By how much an extreme changes at most towards a side, +1 upwards, in its unit, with waves of the most lobes in their worst
        phases."""
        own, changed = self._changed(asked)
        if asked.of not in ("max", "min", "abs") or not changed:
            return 0.0
        of, ends = OF[asked.of], []
        for end in (np.maximum, np.minimum):
            more = [
                end(*(waves.more(name, alone, partial(waves.all_at_once, sign)) for sign in (1.0, -1.0)))
                for waves, name, alone in changed.values()
            ]
            ends.append(float(of(own + np.sum(more, axis=0)) - of(own)))
        return side * max(side * each for each in ends) / asked.unit

    def _changed(self, asked: Asked) -> tuple[np.ndarray, Mapping[int | None, Waved]]:
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
        with suppress(NoAnswer):
            shaft, found = Study(self.design).camshaft.at_theta(theta), dict[int | None, Waved]()
            for name in shaft.carried:
                number = shaft.number(name)
                if number in self.each and self.each[number].changes(DRIVE_TORQUE):
                    there = self.each[number].at(shaft.places[name].own(theta))
                    found[number] = there, DRIVE_TORQUE, shaft.drive_torque(name)
            return shaft.torque, found
        return np.zeros(0), {}


def waves_of(study: Study) -> Waves | None:
    """The waves of a design's profile at even angles; None where none are stated, or there is no cam that can be made."""
    if study.design.listed or study.design.waviness is None or "cam" not in study.stages:
        return None
    try:
        return Waves(study.at_theta(np.arange(ANGLES) * TURN / ANGLES))
    except NoAnswer:
        return None
