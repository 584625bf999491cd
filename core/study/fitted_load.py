"""What a study asks of its shaft over one turn, fitted between the angles where it breaks."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from core import dynamics
from core.dynamics import Friction
from core.mechanism.kinematics import SLIDING
from core.motion import Angles
from core.shaft import LoadCurve, load_curve

if TYPE_CHECKING:
    from core.study.study import Study


def fitted_load(study: Study) -> LoadCurve:
    """Torque [N m] and reduced inertia [kg m^2] by the angle of cam or crank. Raises NoAnswer as the stage ``dynamics`` does."""
    there = lru_cache(maxsize=1)(study.at)  # load and guide are needed at the same angles
    frictions = study.loading.frictions

    def load(angles: Angles) -> np.ndarray:
        at = there(angles)
        return np.array([at.shaft_torque, study.loading.inertia(at.linkage)[0]])

    def rubbing(friction: Friction, edge: int) -> Callable[[Angles], np.ndarray]:
        """What a slide carries where it rubs: friction turns round with its sign."""

        def force(angles: Angles) -> np.ndarray:
            at = there(angles)
            share = dynamics.carried(at.linkage, at.dynamics, friction)[edge]
            return np.asarray(share * np.abs(at.drive.velocity_sign))

        return force

    def carrying(angles: Angles) -> np.ndarray:
        """Which flank carries: with another one friction in the guide grows otherwise."""
        return there(angles).dynamics.carrying

    slides = [f for f in frictions if study.linkage.pairs[f.pair].kind == SLIDING]
    switches = [rubbing(f, edge) for f in slides for edge in range(2 if f.length else 1)]
    changes = carrying if study.holds and frictions else None
    return load_curve(load, study.program, *switches, changes)
