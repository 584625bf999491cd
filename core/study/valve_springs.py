"""Valve springs of a study: harmonics of the valve's lift, the force with surge, and the contact force that results from it."""

from __future__ import annotations

from functools import reduce

import numpy as np

from core.design import Design
from core.dynamics import HARMONICS, HelicalSpring, helical_springs, periodic_sum, surge_harmonics
from core.motion import TURN
from core.motion.extremes import turn_quadrature
from core.study.member_quantities import valve_lift
from core.study.stages import memory
from core.study.study import Study

NODES = 24
PANEL = np.deg2rad(6.0)  # in which these nodes integrate 100 harmonics


def springs_of(design: Design) -> tuple[HelicalSpring, ...]:
    """Valve springs of the drive of a design."""
    return helical_springs(design.drive.loads)


def lift_harmonics(study: Study) -> np.ndarray:
    """Harmonics c_0 … c_100 of the valve's lift by cam angle, c_n = ∫ y e^{-inθ} dθ/2π, the lash taken off.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (101,) complex [m]
    """

    def compute() -> np.ndarray:
        angles, weights = turn_quadrature(study.program, panel=PANEL, count=NODES)
        values = valve_lift(study.at(angles)) * weights / TURN
        return np.exp(-1j * np.arange(HARMONICS + 1)[:, None] * angles.theta) @ values

    harmonics: np.ndarray = memory.get("lift harmonics", study.depends_on("linkage"), compute)
    return harmonics


def valve_spring_force(study: Study) -> np.ndarray:
    """Force of all valve springs in their periodic surge, F_s = F_0 + k y_v + F_w, with the inertia of the springs.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [N]

    References
    ----------
    Marti, NACA TM 818; the wave in the spring, u_tt + 2ζω₁ u_t = c² u_xx.
    """
    springs = springs_of(study.design)
    harmonics = surge_harmonics(springs, lift_harmonics(study), study.omega)
    return sum(spring.preload for spring in springs) + periodic_sum(harmonics, study.theta)


def static_spring_force(study: Study) -> np.ndarray:
    """Force of all valve springs without surge, F_0 + k y_v.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [N]
    """
    springs = springs_of(study.design)
    return sum(spring.preload for spring in springs) + sum(spring.rate for spring in springs) * valve_lift(study)


def stressed_spring(study: Study) -> HelicalSpring:
    """Spring with the greatest shear stress, at the first angle of a study."""
    lift = float(valve_lift(study)[0])
    return max(springs_of(study.design), key=lambda spring: spring.stress(lift))


def valve_spring_stress(study: Study) -> np.ndarray:
    """Greatest corrected shear stress of the valve springs without surge, τ_s = K 8 F D/(π d³), K = (4C + 2)/(4C - 3), C = D/d.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [Pa]

    References
    ----------
    Shigley, *Mechanical Engineering Design*, ch. 10 (Bergsträsser).
    """
    lift, springs = valve_lift(study), springs_of(study.design)
    stresses = [spring.stress_per_force * (spring.preload + spring.rate * lift) for spring in springs]
    return np.asarray(reduce(np.maximum, stresses))


def surging_contact_force(study: Study) -> np.ndarray:
    """Contact force with the surge of the springs while the valve is open; NaN where it is closed.

    The static force and a third of the springs' mass are replaced by the force with surge, through the train.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [N]
    """
    third = sum(spring.active_mass for spring in springs_of(study.design)) / 3.0
    excess = valve_spring_force(study) - static_spring_force(study) - third * valve_lift(study, 2)
    ratio = 1.0 if study.design.drive.is_valve_motion else np.abs(study.linkage.slip("valve_guide"))
    change = -study.mechanism.driver_sign * excess * ratio / study.dynamics.lever
    is_open = (valve_lift(study) > 0.0) & (study.loading.acting(study.linkage) > 0.0)
    return np.where(is_open, study.dynamics.contact + change, np.nan)
