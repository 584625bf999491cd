"""The contact force of a cam that does not turn evenly: what loads, speed and acceleration of the cam each add to it.

F_c = F_0(θ) + F_v(θ) θ̇² + F_a(θ) θ̈, linear in θ̇² and θ̈, so three solutions of the same inverse dynamics give it. In Kim1990
(3) it is K_v X + M_v X'' θ̇² + M_v X' θ̈. A cam on one side only loses its follower where F_c falls below zero; in a dwell
nothing depends on the wind-up, so dwells are left out of that test.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

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
class Touching:
    """A follower on its cam, one of those that a shaft drives.

    at       its kinematics and its cam's shape at any of its own angles
    program  pieces of its motion by its own angle
    sizes    its own, by which its valve spring is retuned; without inertia it has none
    own      its own angles at those of the shaft, and +1, or -1 where they fall as the shaft turns
    name     of its drive, and number in the list of drives
    """

    at: KinematicsAndShapeAt
    loading: Loading
    program: Program
    sizes: Sizes
    own: Callable[[Angles], Angles] = lambda angles: angles
    sense: float = 1.0
    name: str = ""
    number: int = 0


@frozen(eq=False)
class ShaftContacts:
    """Contact forces of k followers by the shaft's angle, as multiples of M X''m ω², M = max J / X'm².

    panels  for each follower rows f_0 (to be multiplied by η² where the loads are fixed), f_v, f_a
    fixed   as in ``Coefficients``
    moves   (k, m) False on panels where the follower dwells
    unit    M X''m [N s²]: times ω² it is the force 1
    names   of the drives, and their numbers in the list (k,)
    """

    panels: Panels
    fixed: bool
    moves: np.ndarray
    unit: float
    names: tuple[str, ...] = ("",)
    numbers: tuple[int, ...] = (0,)

    def force(
        self, values: np.ndarray, eta: float | np.ndarray, speed: np.ndarray, acceleration: np.ndarray
    ) -> np.ndarray:
        """f (...) from the rows ``values`` (3, ...) at the cam angles, speed θ̇/ω and acceleration θ̈/ω²."""
        standing = values[0] * (eta * eta if self.fixed else 1.0)
        return np.asarray(standing + values[1] * speed * speed + values[2] * acceleration)


def contact(
    followers: Sequence[Touching], turn: Any, sizes: Sizes, spring: str, factor: float, q: float, stiffness: float
) -> ShaftContacts:
    """The contact forces of a machine: Q, K_s [N m/rad]; turn: pieces of the shaft's turn, in none of which one of the followers has a
    join; sizes: of all together. Raises NoAnswer where there is no cam."""
    unit = _unit(sizes)
    # F_0 / (M X''m ω²) = η² F_0 I_c / (K_s M X''m)
    scale = unit if spring == RETUNED else unit * q * stiffness / sizes.inertia

    def held(each: Touching) -> Loading:
        if spring != RETUNED:
            return each.loading.smooth
        rate = factor * _unit(each.sizes) / each.sizes.stroke if each.sizes.inertia else 0.0
        return Loading((), (OutputForce(rate * each.sizes.lowest, rate),))

    loads = [(each, held(each), each.loading.inertial) for each in followers]

    def functions(angles: Angles) -> np.ndarray:
        rows = []
        for each, standing, inertial in loads:
            kinematics, shape = each.at(each.own(angles))
            rows += [
                newton_euler(kinematics, shape, standing, 0.0).contact / scale,
                newton_euler(kinematics, shape, inertial, 1.0).contact / unit,
                each.sense * newton_euler(kinematics, shape, inertial, 0.0, acceleration=1.0).contact / unit,
            ]
        return np.array(rows)

    panels = fit(functions, turn, 3 * len(followers))
    middle = Angles(panels.start + 0.5 * panels.width, panels.piece)
    moves = np.array([each.program.velocity_signs[each.own(middle).piece] != 0.0 for each in followers])
    names, numbers = tuple(each.name for each in followers), tuple(each.number for each in followers)
    return ShaftContacts(panels, spring != RETUNED, moves, unit, names, numbers)


def _unit(sizes: Sizes) -> float:
    return sizes.inertia / sizes.slope**2 * sizes.curvature
