"""What a drive asks of its shaft over one turn, fitted between the angles where it breaks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from core import dynamics
from core.dynamics import Forces, Friction, Loading
from core.mechanism.kinematics import Kinematics
from core.motion import Angles
from core.shaft import LoadCurve, load_curve

Switch = Callable[[Kinematics, Forces], np.ndarray]


def fitted_load(
    solved: Callable[[Angles], tuple[Kinematics, Forces]],
    torque: Callable[[Forces], np.ndarray],
    loading: Loading,
    program: Any,
    slides: Sequence[Friction],
    holds: bool,
) -> LoadCurve:
    """Torque [N m] and reduced inertia [kg m^2] by the angle of cam or crank. Raises NoAnswer as the stage ``dynamics`` does.

    torque: what the shaft is asked for (n,) [N m]; slides: friction in slides; holds: whether the cam holds the follower from both sides
    """
    there = lru_cache(maxsize=1)(solved)  # load and guide are needed at the same angles

    def load(angles: Angles) -> np.ndarray:
        kinematics, forces = there(angles)
        return np.array([torque(forces), loading.inertia(kinematics, 1)[0]])

    def at(switch: Switch) -> Callable[[Angles], np.ndarray]:
        return lambda angles: switch(*there(angles))

    return load_curve(load, program, *(at(switch) for switch in switches_of(loading, slides, holds)), even_at_rest=True)


def switches_of(loading: Loading, slides: Sequence[Friction], holds: bool) -> list[Switch]:
    """Where the sign of one of these (n,) changes, friction breaks the torque: of what a slide that rubs carries; and of what tells which
    flank carries, for with another one friction in the guide grows otherwise."""

    def rubbing(friction: Friction, edge: int) -> Switch:
        def force(kinematics: Kinematics, forces: Forces) -> np.ndarray:
            share = dynamics.carried(kinematics, forces, friction)[edge]
            return np.asarray(share * np.abs(kinematics.motion.velocity_sign))

        return force

    found = [rubbing(f, edge) for f in slides for edge in range(2 if f.length else 1)]
    return [*found, lambda kinematics, forces: forces.carrying] if holds and loading.frictions else found
