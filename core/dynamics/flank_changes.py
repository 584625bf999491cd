"""Where the contact of a groove or of a conjugate pair goes over to the other flank."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from core.cam import form_row
from core.dynamics.forces import Forces
from core.findings import NOTE, Finding
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, Program
from core.motion.extremes import piecewise_angles
from core.motion.roots import crossings

NOTHING = 1e-11  # of the largest force: a force below it has no direction

At = Callable[[Angles], tuple[Kinematics, Forces]]


@frozen
class FlankChange:
    """theta [rad]; to: number of the flank that carries from there on; impact [m/s]: speed of what strikes it across the
    play, along the normal; None without play, or where it comes back to the flank that it left: see ``with_impacts``."""

    theta: float
    to: int
    impact: float | None = None


def flank_changes(at: At, program: Program) -> tuple[FlankChange, ...]:
    """The cam angles at which F_c changes its sign, refined, in their order; jumps at joins of the motion included."""
    found = sign_changes(lambda there: at(there)[1].carrying, program)
    return tuple(FlankChange(theta, int(sign < 0.0)) for theta, sign in sorted(found) if sign != 0.0)


def sign_changes(force_at: Callable[[Angles], np.ndarray], program: Program) -> list[tuple[float, float]]:
    """The cam angles [rad] at which a force (n,) changes its sign, refined, jumps included, each with the sign afterwards. A force that
    is nothing beside the largest has none."""
    angles = piecewise_angles(program)
    forces = force_at(angles)
    least = NOTHING * float(np.abs(forces).max(initial=0.0))

    def carrying(there: Angles) -> np.ndarray:
        force = force_at(there)
        return np.where(np.abs(force) <= least, 0.0, force)

    value = np.where(np.abs(forces) <= least, 0.0, forces)
    roots = crossings(carrying, angles, value)
    inner = list(zip(roots.theta.tolist(), roots.piece.tolist(), strict=True))
    found = [(theta, _sign_after(carrying, theta, piece, program)) for theta, piece in inner]
    found += _jumps(angles, value, inner)
    return found


def _sign_after(carrying: Callable[[Angles], np.ndarray], theta: float, piece: int, program: Program) -> float:
    end = float(program.ends[piece])
    there = np.minimum(theta + 10.0 ** np.arange(-9.0, -2.0), end)
    signs = np.sign(carrying(Angles(there, np.full(there.size, piece))))
    return next((float(sign) for sign in signs if sign), 0.0)


def _jumps(angles: Angles, value: np.ndarray, inner: list[tuple[float, int]]) -> list[tuple[float, float]]:
    """Changes that are no root inside a piece: at joins, and after stretches without force; angle and sign afterwards."""
    loaded = np.flatnonzero(value)
    found = []
    for i, j in zip(np.roll(loaded, 1).tolist(), loaded.tolist(), strict=True):
        if value[i] * value[j] > 0.0 or (j == i + 1 and angles.piece[i] == angles.piece[j]):
            continue
        if any(angles.theta[i] <= theta <= angles.theta[j] and i < j for theta, _ in inner):
            continue
        before = j - 1 if j > i + 1 or i > j else j
        start = float(angles.theta[before if before >= 0 and angles.piece[before] == angles.piece[j] else j])
        found.append((start, float(np.sign(value[j]))))
    return found


def change_findings(changes: tuple[FlankChange, ...], form: Any) -> list[Finding]:
    """A note for each change."""
    found = []
    for change in changes:
        values: dict[str, float | str] = {"to": form_row(form).sides[change.to]}
        if change.impact is not None:
            values |= {"play_mm": form.play_mm, "impact_m_s": change.impact}
        found.append(Finding("flank-change", NOTE, "loads", math.degrees(change.theta), values))
    return found
