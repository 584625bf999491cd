"""The angles at which the torque of a study jumps or breaks, but for the joins of its motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from core.errors import NoAnswer
from core.mechanism import solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import Angles
from core.motion.extremes import piecewise_angles
from core.motion.roots import crossings
from core.numerics.vectors import spread
from core.study.stages import memory

if TYPE_CHECKING:
    from core.study.study import Study


def cuts(study: Study) -> tuple[float, ...]:
    """Angles [rad] in rising order at which a process force switches, and at which friction turns round in a pin; none where the
    mechanism cannot be solved, which its own stage says."""
    loads = study.design.drive.loads
    if not (loads.process or loads.pair_friction):
        return ()
    try:
        loading, driven = study.loading, study.course if study.by_crank else study.design.drive.motion
        switches = memory.get("switches", (driven, loading.switches), lambda: tuple(loading.cuts(study.uncut).tolist()))
        pairs = tuple(friction.pair for friction in loading.frictions)
        back = memory.get("turning back", (driven, study.mechanism, pairs), lambda: _turning_back(study, pairs))
    except NoAnswer:
        return ()
    return tuple(sorted({*switches, *back}))


def _turning_back(study: Study, pairs: tuple[str, ...]) -> tuple[float, ...]:
    """Angles [rad] at which one of these pairs slips the other way."""
    if not pairs:
        return ()
    uncut = study.uncut
    angles = piecewise_angles(uncut)
    sampled = solve_mechanism(study.mechanism, uncut.state(angles), study.course)
    turning = [name for name in pairs if name != sampled.driver_name]
    if not turning:
        return ()

    def slips(kinematics: Kinematics) -> np.ndarray:
        return np.array([spread(kinematics.slip(name), kinematics.theta.size) for name in turning])

    def slip(at: Angles) -> np.ndarray:
        return slips(solve_mechanism(study.mechanism, uncut.state(at), study.course))

    return tuple(crossings(slip, angles, slips(sampled)).theta.tolist())
