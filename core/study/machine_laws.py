"""Optimal laws of a design: least peak of torque or contact force, least root mean square of a servo's torque.

The effect of a law is computed by the stages of a study. Statics and kinematics at an angle depend on the motion and its first
two derivatives there, so that their derivatives by these follow from studies whose driver has a slightly different state.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from core.design import ComputedCurve, Design, Motion, OptimalCurve, Segment, faults
from core.design.curves import optimal_task, with_joined_ends
from core.design.motions import needs_machine
from core.design.rules import missing_for_effect
from core.errors import DesignError, Fault, NoSolution
from core.laws import Piece
from core.motion import Angles, MotionState
from core.numerics.derivatives import Derivatives, spread
from core.study.drive_forces import has_servo, servo_torque
from core.study.study import Study

if TYPE_CHECKING:
    from core.laws.local import LocalLaw

STEP = 1e-6  # of s, s', s'': differences for the derivatives of an effect
AT_REST = 1e-9  # of s': slower is rounding


def _torque(study: Study) -> np.ndarray:
    """Torque of the cam; without a cam that of the servo, else that on the output."""
    if study.design.drive.cam is not None:
        return np.asarray(study.dynamics.torque)
    return servo_torque(study) if has_servo(study.design) else np.asarray(study.dynamics.driver)


EFFECTS: Mapping[str, Callable[[Study], np.ndarray]] = MappingProxyType(
    {
        "torque": _torque,
        "contact_force": lambda study: np.asarray(study.dynamics.contact),
        "motor_rms": servo_torque,
    }
)
"""What an optimal law minimises -> function of a study: values (n,) [SI] at its angles."""


class _DrivenStudy(Study):
    """Study of a drive whose driver has a given state."""

    def __init__(self, design: Design, state: MotionState) -> None:
        super().__init__(design, angles=state.angles)
        self._state = state

    @property
    def drive(self) -> MotionState:
        return self._state


class _MachineEffect:
    """Effect of the law of a segment in its machine, of s, s', s'' at u over its span."""

    def __init__(self, design: Design, index: int, minimise: str) -> None:
        self.design, self._effect = design, EFFECTS[minimise]
        study = Study(design)
        self._is_open = "cam" in study.stages and not study.is_form_closed
        compiled = study.uncut
        motion = compiled.motion
        segment = motion.segments[index]
        self._pieces = np.flatnonzero(compiled.segment == index)
        self._begins, self._starts = compiled.starts[self._pieces], compiled.starts[self._pieces[0]]
        self._span = compiled.ends[self._pieces[-1]] - self._starts
        self._level = (motion.first + sum(s.rise for s in motion.segments[:index])) * motion.scale
        self._gain = segment.rise * motion.scale / self._span ** np.arange(3)[:, None]

    def values(self, u: np.ndarray, s: np.ndarray, sign: np.ndarray) -> np.ndarray:
        """Effect at u (k,) of s, s', s'' (3, k), and the contact force of an open cam (r, k); infinite without a solution."""
        theta = self._starts + self._span * u
        piece = self._pieces[np.clip(np.searchsorted(self._begins, theta, side="right") - 1, 0, None)]
        y = np.vstack((self._gain * s, np.zeros_like(u)))
        y[0] += self._level
        state = MotionState(Angles(theta, piece), Derivatives(lambda order: y[order]), sign)
        study = _DrivenStudy(self.design, state)
        try:
            rows = [self._effect(study), *([study.dynamics.contact] if self._is_open else [])]
        except NoSolution:
            return np.full((2, u.size), np.inf)
        values = np.array([spread(row, u.size) for row in rows])
        return np.where(np.isnan(values), 0.0, values)  # a valve train that is loose loads nothing

    def __call__(self, u: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Effects (r, k), and their derivatives (3, r, k) by s, s', s''."""
        steps = np.concatenate(([np.zeros(3)], STEP * np.eye(3), -STEP * np.eye(3)))
        near = s[:, None, :] + steps.T[:, :, None]
        sign = np.sign(self._gain[0]) * np.where(s[1] < -AT_REST, -1.0, 1.0)
        values = self.values(np.tile(u, 7), near.reshape(3, -1), np.tile(sign, 7))
        values = values.reshape(values.shape[0], 7, -1).swapaxes(0, 1)
        with np.errstate(invalid="ignore"):
            return values[0], (values[1:4] - values[4:]) / (2.0 * STEP)


@lru_cache(maxsize=64)
def law_in_machine(segment: Segment, whole_turn: bool) -> LocalLaw:
    """Law that is optimal in its machine, the best of searches from five laws; of least rms acceleration where it has no solution.

    The ends of the segment are resolved. Raises NoOptimalLaw where no law satisfies limits, points, ends and bounds; DesignError
    where the machine has faults, or lacks what the law minimises.
    """
    curve = segment.curve
    assert isinstance(curve, OptimalCurve)
    assert curve.machine is not None
    design, index = curve.machine.design, curve.machine.segment
    wrong = faults(design)
    if needs := missing_for_effect(design.drive, curve.minimise):
        wrong.append(Fault(f"motion.segments[{index}].minimise", curve.minimise, f"needs {needs}", "another aim"))
    if wrong:
        raise DesignError(wrong)
    from core.laws.local import local_law  # imported here to save start-up time

    effect = _MachineEffect(design, index, curve.minimise)
    return local_law(optimal_task(curve, segment, whole_turn), effect)


def with_fixed_laws(design: Design) -> Design:
    """Design whose optimal laws stay as they are where its machine changes: machines are built with the laws of the design."""
    if not any(drive.motion is not None and drive.motion.needs_machine for drive in design.drives):
        return design
    drives = (
        drive if drive.motion is None else replace(drive, motion=_with_fixed_laws(drive.motion))
        for drive in design.drives
    )
    return replace(design, drives=tuple(drives))


def _with_fixed_laws(motion: Motion) -> Motion:
    def fixed(index: int, segment: Segment) -> Segment:
        if not needs_machine(segment.curve):
            return segment
        law = law_in_machine(with_joined_ends(motion, index), len(motion.segments) == 1)
        pieces = (Piece(p.start, tuple(segment.rise * c for c in p.polynomial)) for p in law.pieces)
        return replace(segment, curve=ComputedCurve(tuple(pieces)))

    if not motion.needs_machine:
        return motion
    return replace(motion, segments=tuple(fixed(i, segment) for i, segment in enumerate(motion.segments)))
