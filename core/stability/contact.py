"""The contact force of a cam that does not turn evenly: what loads, speed and acceleration of the cam each add to it.

F_c = F_0(θ) + F_v(θ) θ̇² + F_a(θ) θ̈, linear in θ̇² and θ̈, so three solutions of the same inverse dynamics give it. In Kim1990
(3) it is K_v X + M_v X'' θ̇² + M_v X' θ̈. A cam on one side only loses its follower where F_c falls below zero; in a dwell
nothing depends on the wind-up, so dwells are left out of that test.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core.cam import CamShape
from core.dynamics import Loading, OutputForce, newton_euler
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, Program
from core.stability.hill.coefficients import RETUNED, Sizes
from core.stability.panels import Panels, fit

KinematicsAndShapeAt = Callable[[Angles], tuple[Kinematics, CamShape]]


@frozen(eq=False)
class Contact:
    """Contact forces by cam angle, as multiples of M X''m ω², M = max J / X'm².

    panels  rows f_0 (to be multiplied by η² where the loads are fixed), f_v, f_a
    fixed   as in ``Coefficients``
    moves   (m,) False on panels where the follower dwells
    unit    M X''m [N s²]: times ω² it is the force 1
    """

    panels: Panels
    fixed: bool
    moves: np.ndarray
    unit: float

    def force(self, values: np.ndarray, eta: float | np.ndarray, speed: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """f from the rows ``values`` (3, ...) at the cam angles, speed θ̇/ω and acceleration θ̈/ω²."""
        standing = values[0] * (eta * eta if self.fixed else 1.0)
        return standing + values[1] * speed * speed + values[2] * acceleration


def contact(
    at: KinematicsAndShapeAt,
    loading: Loading,
    program: Program,
    sizes: Sizes,
    spring: str,
    factor: float,
    q: float,
    stiffness: float,
) -> Contact:
    """The contact forces of a machine: Q, K_s [N m/rad]. Raises NoAnswer where there is no cam."""
    mass = sizes.inertia / sizes.slope**2
    unit = mass * sizes.curvature
    if spring == RETUNED:
        rate = factor * unit / sizes.stroke
        held, scale = Loading((), (OutputForce(rate * sizes.lowest, rate),)), unit
    else:
        # F_0 / (M X''m ω²) = η² F_0 I_c / (K_s M X''m)
        held, scale = loading.smooth, unit * q * stiffness / sizes.inertia
    inertial = loading.inertial

    def functions(angles: Angles) -> np.ndarray:
        kinematics, shape = at(angles)
        standing = newton_euler(kinematics, shape, held, 0.0)
        turning = newton_euler(kinematics, shape, inertial, 1.0)
        speeding_up = newton_euler(kinematics, shape, inertial, 0.0, acceleration=1.0)
        return np.array([standing.contact / scale, turning.contact / unit, speeding_up.contact / unit])

    panels = fit(functions, program, 3)
    return Contact(panels, spring != RETUNED, program.velocity_signs[panels.piece] != 0.0, unit)
