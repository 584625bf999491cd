"""Where the contact of a groove or of a conjugate pair goes over to the other flank, and how hard it strikes there."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from core.dynamics.elements import Loading
from core.dynamics.forces import Forces
from core.findings import NOTE, Finding
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.motion import TURN, Angles, Program
from core.motion.extremes import piecewise_angles
from core.motion.roots import crossings
from core.numerics.vectors import dot

NOTHING = 1e-11  # of the largest force: a force below it has no direction
NODES = 12  # of a panel
PANEL = math.radians(2.0)
HALVINGS = 60  # to the angle of landing
NAMES = {"groove": ("inner flank", "outer flank"), "conjugate": ("first roller", "second roller")}

At = Callable[[Angles], tuple[Kinematics, Forces]]


@frozen
class FlankChange:
    """theta [rad]; to: number of the flank that carries from there on; impact [m/s]: speed of what strikes it across the
    play, along the normal; None without play, or where the force turns round again before the play is crossed."""

    theta: float
    to: int
    impact: float | None = None


def flank_changes(at: At, program: Program, loading: Loading, play: float) -> tuple[FlankChange, ...]:
    """The cam angles at which F_c changes its sign, refined, in their order; jumps at joins of the motion included.

    Impact: with the old contact gone the follower moves freely until it has crossed the play. Along the normal at the flank
    it goes to, gap'' = a = Q λ/M by time: Q the generalised force by which the cam had to drive, λ the flank's lever, M the
    moved masses, all by the driver's coordinate. It strikes with v = ∫a dt where ∬a dt² = play: v = √(2 a play) where a jumps,
    v = (9/2 · ȧ play²)^(1/3) where it grows from zero, to first order in the play. What the play changes of a itself is left out.
    """
    found = sign_changes(lambda there: at(there)[1].carrying, program)
    changes = sorted((theta, int(sign < 0.0)) for theta, sign in found if sign != 0.0)
    speeds = _impacts(at, program, loading, play, changes) if play > 0.0 and changes else [None] * len(changes)
    return tuple(FlankChange(theta, to, speed) for (theta, to), speed in zip(changes, speeds, strict=True))


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


def _impacts(
    at: At, program: Program, loading: Loading, play: float, changes: list[tuple[float, int]]
) -> list[float | None]:
    """The speed at each change [m/s], from the relative acceleration on panels that begin where the contact is lost."""
    from numpy.polynomial import chebyshev

    edges = []
    for a, b in zip(program.starts, program.ends, strict=True):
        even = np.linspace(a, b, max(2, math.ceil((b - a) / PANEL)) + 1)
        edges.append(np.unique(np.concatenate((even, [theta for theta, _ in changes if a < theta < b]))))
    start, width = np.concatenate([e[:-1] for e in edges]), np.concatenate([np.diff(e) for e in edges])
    piece = np.repeat(np.arange(len(edges)), [e.size - 1 for e in edges])
    x = chebyshev.chebpts1(NODES)
    theta = start[:, None] + width[:, None] * (0.5 + 0.5 * x)
    kinematics, forces = at(Angles(theta.ravel(), np.repeat(piece, NODES)))
    needed = sum(each.force * each.lever for each in forces.contacts)
    by_lever = needed / _mass(kinematics, loading) / forces.omega**2  # gap'' by angle, but for the lever of the flank
    fit = np.linalg.inv(chebyshev.chebvander(x, NODES - 1))
    speeds: list[float | None] = []
    for begin, to in changes:
        rows = (by_lever * forces.contacts[to].lever).reshape(-1, NODES) @ fit.T
        first = int(np.searchsorted(start, begin, side="left")) % start.size
        speed = _landing(rows, 0.5 * width, first, play) if np.isfinite(rows).all() else None
        speeds.append(None if speed is None else speed * forces.omega)
    return speeds


def _landing(rows: np.ndarray, half: np.ndarray, first: int, play: float) -> float | None:
    """d gap/dθ [m] where the gap that opens at panel ``first`` has grown to the play; rows (m, NODES): Chebyshev coefficients of
    gap'', half (m,): half widths [rad]."""
    from numpy.polynomial import chebyshev

    gap, rate, gone = 0.0, 0.0, 0.0
    for k in range(first, first + half.size):
        i = k % half.size
        velocity = chebyshev.chebint(rows[i] * half[i], lbnd=-1.0)
        velocity[0] += rate
        place = chebyshev.chebint(velocity * half[i], lbnd=-1.0)
        place[0] += gap
        after, gone = float(chebyshev.chebval(1.0, place)), gone + 2.0 * half[i]
        if after >= play:
            low, high = -1.0, 1.0
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if chebyshev.chebval(middle, place) >= play else (middle, high)
            return float(chebyshev.chebval(high, velocity))
        gap, rate = after, float(chebyshev.chebval(1.0, velocity))
        if rate <= 0.0 or gone > TURN:
            return None
    return None


@np.errstate(divide="ignore")
def _mass(kinematics: Kinematics, loading: Loading) -> np.ndarray:
    """M (n,) = Σ m|∂z/∂q|² + I (∂α/∂q)² [kg, or kg m²], q the driver's coordinate: it exists in dwells too."""
    total = np.zeros(kinematics.theta.size)
    for mass in loading.masses:
        pose, part = kinematics.by_driver[mass.body], mass.inertia
        speed = pose.carried(part.centre)[1]
        total = total + part.mass * dot(speed, speed) + part.about_centre * pose.turn[1] ** 2
    return total


def change_findings(changes: tuple[FlankChange, ...], form: Any) -> list[Finding]:
    """A note for each change."""
    found = []
    for change in changes:
        values: dict[str, float | str] = {"to": NAMES[form.form][change.to]}
        if change.impact is not None:
            values |= {"play_mm": form.play_mm, "impact_m_s": change.impact}
        found.append(Finding("flank-change", NOTE, "loads", math.degrees(change.theta), values))
    return found
