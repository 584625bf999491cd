"""Valve springs over the engine speed and over a turn: harmonics of the lift that meet a spring, and its force with surge."""

from __future__ import annotations

from math import pi

import numpy as np

from core.design.engine import CRANK_PER_CAM
from core.dynamics import HelicalSpring, surge_harmonics
from core.frozen import frozen
from core.study import Study
from core.study.valve_springs import lift_harmonics, springs_of, static_spring_force, valve_spring_force
from core.valves.timing import MM


@frozen
class Resonance:
    """A harmonic of the valve's lift, and the engine speed at which it meets the natural frequency of a spring.

    Attributes
    ----------
    n : number of the harmonic, in periods per turn of the camshaft
    lift_mm : its amplitude in the lift of the valve [mm]
    engine_rpm : engine speed at which it meets the spring [rpm]
    force_n : amplitude of the spring's force at that speed [N], infinite without damping
    """

    n: int
    lift_mm: float
    engine_rpm: float
    force_n: float


def resonances(study: Study) -> tuple[tuple[Resonance, ...], ...]:
    """Harmonics 1 ... 100 of the valve's lift for each valve spring: 2 |c_n| at 120 f₁/n rpm of the engine."""
    harmonics = lift_harmonics(study)
    return tuple(_resonances(spring, harmonics) for spring in springs_of(study.design))


def _resonances(spring: HelicalSpring, harmonics: np.ndarray) -> tuple[Resonance, ...]:
    """Harmonics (m,) [m] at the speeds of a spring; the force is k c_n z cot z at z = π √(1 - 2iζ)."""
    gain = np.inf
    if spring.damping_ratio > 0.0:
        gain = float(np.abs(surge_harmonics((spring,), np.array([0.0, 1.0]), spring.natural)[1]))
    sizes = (2.0 * np.abs(harmonics[1:])).tolist()
    lowest = CRANK_PER_CAM * spring.natural * 30.0 / pi
    return tuple(Resonance(n, MM * size, lowest / n, gain * size if size else 0.0) for n, size in enumerate(sizes, 1))


def spring_forces(study: Study) -> tuple[np.ndarray, np.ndarray]:
    """Force of all valve springs over the turn, without and with surge.

    Parameters
    ----------
    study : Study

    Returns
    -------
    static, true : ndarray (n,) [N]
        At the cam angles of the study; the true force contains the inertia of the springs.
    """
    return static_spring_force(study), valve_spring_force(study)


def engine_rpm(study: Study) -> float:
    """Present speed of the engine [rpm]."""
    return CRANK_PER_CAM * abs(study.omega) * 30.0 / pi


def float_rpm(study: Study) -> float | None:
    """Engine speed from which on the follower leaves the cam without surge [rpm]; None without a disk cam, or where it never does."""
    if not study.has_disk or study.is_form_closed or study.loading.is_empty or study.lift_off is None:
        return None
    return CRANK_PER_CAM * study.lift_off.omega * 30.0 / pi
