"""The motion of a balance cam whose follower has a mass m: spring and follower together hold what the shaft has given.

    ½mω²x'² + F0 x + ½Kx² = E0 - W(θ)

Where W has a peak or a valley x' is 0. The solution leaves every peak, where the spring is longest, on the one smooth branch, and comes
by itself to the valleys on both sides, as long as F² > 4mω²T' there, F the spring's force: else the follower is still under way when it
should turn, and there is none. Panel by panel from each peak, by collocation at Radau's nodes.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from core.design import Balancer, si
from core.errors import NoAnswer
from core.frozen import frozen
from core.laws import moved
from core.motion import TURN
from core.shaft.curve import polyval
from core.shaft.energy import roots_of
from core.shaft.speed import collocation

AT_REST = 1e-11  # of the torque's swing: where no more is to be balanced nothing moves
RESOLVED = 1e-12  # of the torque's swing: what the last coefficients of a panel may add to it
MET = 1e-7  # of the torque's swing: what the two ways into a valley may differ by
ITERATIONS, CLOSE = 30, 1e-10  # of the speed's size
POLISHED, LEFT = (
    3,
    1e-14,
)  # steps on the torque itself, which begin at the solution; what may be left of the torque's swing
LEAST_SHARE = 2.0**-12


@frozen(eq=False)
class Energy:
    """E0 - W on the load's panels, coefficients of r**k (·, m): energy (NODES + 1), torque T - T̄ (NODES), slope of the torque T'
    (NODES - 1); start, width (m,) [rad]; swing of the torque [N m]."""

    start: np.ndarray
    width: np.ndarray
    energy: np.ndarray
    torque: np.ndarray
    slope: np.ndarray
    swing: float


@frozen(eq=False)
class _Follower:
    """Spring rate [N/m], preload [N], mω² [kg/s²]; swing of the torque [N m]."""

    rate: float
    preload: float
    inertia: float
    swing: float

    def resting(self, energy: float) -> float:
        """x [m] where the spring alone holds the energy [J]."""
        energy = max(energy, 0.0)
        return float(2.0 * energy / (self.preload + np.sqrt(self.preload**2 + 2.0 * self.rate * energy)))


def heavy_panels(energy: Energy, balancer: Balancer, omega: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start, width (m,) [rad] and coefficients (k, m) of r**k, of x [m] over the turn, x = 0 at the greatest W.

    Raises NoAnswer where the follower is too heavy.
    """
    s = si(balancer)
    follower = _Follower(s.spring_rate, s.preload, s.follower_mass * omega * omega, energy.swing)
    parts = _cut_at_turns(energy)
    sign = np.array([_sense(energy, *part) for part in parts])
    start: list[float] = []
    width: list[float] = []
    rows: list[np.ndarray] = []
    ends: list[tuple[float, float, float, float]] = []  # of each panel x and x' at both ends
    first = int(np.flatnonzero(sign != np.roll(sign, 1))[0]) if (sign != sign[0]).any() else 0
    order = [(first + i) % len(parts) for i in range(len(parts))]
    runs: list[list[int]] = []
    for i in order:
        if runs and sign[runs[-1][0]] == sign[i]:
            runs[-1].append(i)
        else:
            runs.append([i])
    for run in runs:
        way = int(sign[run[0]])
        place, begun = None, 0.0
        for i in run if way >= 0 else run[::-1]:
            panel, low, share = parts[i]
            begin = energy.start[panel] + low * energy.width[panel]
            if not way:
                x = follower.resting(float(polyval(low, energy.energy[:, panel])))
                made: list[tuple[float, float, np.ndarray]] = [(0.0, 1.0, np.array([x]))]
            else:
                at = low if way > 0 else low + share
                place = follower.resting(float(polyval(at, energy.energy[:, panel]))) if place is None else place
                made, place, begun = _marched(energy, follower, panel, at, way * share, place, begun)
            for off, part, row in made:
                h = share * part * energy.width[panel]
                row = row if way >= 0 else _mirrored(row)
                start.append(begin + (off if way >= 0 else 1.0 - off - part) * share * energy.width[panel])
                width.append(h)
                rows.append(row)
                slope = row[1:] * np.arange(1, row.size)
                ends.append((row[0], row.sum(), (slope[0] if slope.size else 0.0) / h, slope.sum() / h))
    by_angle = np.argsort(np.mod(np.array(start) + 1e-13, TURN), kind="stable")
    _require_met(follower, np.array(start)[by_angle], np.array(ends)[by_angle])
    coefficients = np.zeros((max(row.size for row in rows), len(rows)))
    for column, i in enumerate(by_angle):
        coefficients[: rows[i].size, column] = rows[i]
    return np.array(start)[by_angle], np.array(width)[by_angle], coefficients


def _cut_at_turns(energy: Energy) -> list[tuple[int, float, float]]:
    """The load's panels, cut where T - T̄ changes its sign: panel, where in it a part begins, and how much of it that is."""
    panel, root = roots_of(energy.torque)
    still = np.abs(energy.torque).sum(axis=0) <= AT_REST * energy.swing
    parts = []
    for i in range(energy.start.size):
        cuts = [] if still[i] else sorted(r for r in root[panel == i].tolist() if 1e-9 < r < 1.0 - 1e-9)
        edges = [0.0, *cuts, 1.0]
        parts += [(i, a, b - a) for a, b in pairwise(edges)]
    return parts


def _sense(energy: Energy, panel: int, low: float, share: float) -> int:
    """+1 where x grows with the angle, -1 where it falls, 0 where nothing moves."""
    torque = polyval(low + share * np.linspace(0.0, 1.0, 9), energy.torque[:, panel])
    if np.abs(torque).max() <= AT_REST * energy.swing:
        return 0
    return -1 if torque.sum() > 0.0 else 1


def _marched(
    energy: Energy, follower: _Follower, panel: int, at: float, share: float, place: float, begun: float
) -> tuple[list[tuple[float, float, np.ndarray]], float, float]:
    """x over a part of a panel from r = at on (share < 0: backwards), from x = place: of pieces of it where they begin, how much they
    are (of the part), and coefficients by their own r; and x and the speed at its end; begun: the speed at its start."""
    x, integrals, to_chebyshev, _ = collocation()
    made, off, piece = [], 0.0, 1.0
    while off < 1.0 - 1e-12:
        r = at + share * (off + piece * x)
        h = abs(share) * piece * float(energy.width[panel])
        torque = polyval(r, energy.torque[:, panel])
        given = -np.sign(share) * h * (integrals @ torque)
        speed = _solved(follower, given, torque, h * integrals, place, begun)
        bend = None if speed is None else _bent(follower, -np.sign(share) * torque, h, place, begun, speed)
        fine = False
        if speed is not None and bend is not None:
            row = _placed(bend, h, place, begun)
            last = float(np.abs(to_chebyshev[-2:] @ bend).sum())
            fine = (
                last * (h * (follower.preload + follower.rate * row.sum()) + follower.inertia * speed.max())
                <= RESOLVED * follower.swing
            )
        if bend is None and piece <= LEAST_SHARE:
            raise _too_heavy(float(energy.start[panel] + at * energy.width[panel]))
        if bend is None or (not fine and piece > LEAST_SHARE):
            piece *= 0.5
            continue
        made.append((off, piece, row))
        place, begun = float(row.sum()), begun + float(h * (integrals[-1] @ bend))
        off += piece
        piece = min(2.0 * piece, 1.0 - off) if off < 1.0 else piece
    return made, place, begun


def _solved(
    follower: _Follower, given: np.ndarray, torque: np.ndarray, integrals: np.ndarray, place: float, begun: float
) -> np.ndarray | None:
    """The speed dx/dθ >= 0 at the nodes in the direction of the march, by Newton's method from that without a mass; given: what the
    shaft has given from the start on [J], where x = place and the speed = begun."""
    pull = follower.preload + follower.rate * place
    speed = np.abs(torque) / np.sqrt(pull**2 + 2.0 * follower.rate * np.maximum(given, 0.0))
    size = follower.swing / pull
    for _ in range(ITERATIONS):
        more = integrals @ speed
        left = 0.5 * follower.inertia * (speed**2 - begun**2) + (pull + 0.5 * follower.rate * more) * more - given
        jacobian = (pull + follower.rate * more)[:, None] * integrals
        jacobian[np.arange(speed.size), np.arange(speed.size)] += follower.inertia * speed
        change = np.linalg.solve(jacobian, -left)
        speed = speed + change
        if not np.isfinite(speed).all():
            return None
        if float(np.abs(change).max()) <= CLOSE * size:
            break
    return speed if float(np.abs(change).max()) <= CLOSE * size and float(speed.min()) >= -1e-9 * size else None


def _bent(
    follower: _Follower, taken: np.ndarray, h: float, place: float, begun: float, speed: np.ndarray
) -> np.ndarray | None:
    """d²x/dθ² at the nodes by Newton's method on the torque itself, (F + mω²x'')x' = taken, from the speed that the energy gives: so
    that what is left of the torque is rounding, also where the speed is small against its own rounding."""
    x, integrals, _, _ = collocation()
    rise, climb = h * integrals, np.vander(x, _twice().shape[0], increasing=True) @ _twice() * h * h
    bend = np.linalg.solve(rise, speed - begun)
    pull = follower.preload + follower.rate * (place + h * begun * x)
    for _ in range(POLISHED):
        speed = begun + rise @ bend
        force = pull + follower.rate * (climb @ bend) + follower.inertia * bend
        left = taken - force * speed
        if float(np.abs(left).max()) <= LEFT * follower.swing:
            break
        jacobian = speed[:, None] * follower.rate * climb + force[:, None] * rise
        jacobian[np.arange(x.size), np.arange(x.size)] += follower.inertia * speed
        bend = bend + np.linalg.solve(jacobian, left)
        if not np.isfinite(bend).all():
            return None
    return bend


def _placed(bend: np.ndarray, h: float, place: float, begun: float) -> np.ndarray:
    """Coefficients of r**k of x, of which the second derivative is given at the nodes, over a width h."""
    row = h * h * (_twice() @ bend)
    row[:2] += place, h * begun
    return np.asarray(row)


@lru_cache(maxsize=1)
def _twice() -> np.ndarray:
    """From values at the nodes (NODES,) the power coefficients (NODES + 2,) of their integral's integral."""
    _, _, _, integral = collocation()
    return np.vstack((np.zeros((1, integral.shape[1])), integral / np.arange(1, integral.shape[0] + 1)[:, None]))


def _mirrored(row: np.ndarray) -> np.ndarray:
    """p(1 - r) of p(r)."""
    shifted = np.array(moved(row.tolist(), 1.0))
    return shifted * (-1.0) ** np.arange(shifted.size)


def _require_met(follower: _Follower, start: np.ndarray, ends: np.ndarray) -> None:
    """Raises NoAnswer where two ways into a valley end at different places, or under way."""
    force = follower.preload + follower.rate * np.abs(ends[:, 0])
    place = np.abs(ends[:, 0] - np.roll(ends[:, 1], 1)) * force
    speed = np.abs(ends[:, 2] - np.roll(ends[:, 3], 1)) * force
    worst = int(np.argmax(np.maximum(place, speed)))
    if max(place[worst], speed[worst]) > MET * follower.swing:
        raise _too_heavy(float(start[worst]))


def _too_heavy(angle: float) -> NoAnswer:
    at: Any = float(np.rad2deg(angle) % 360.0)
    return NoAnswer(
        "the follower is too heavy for its spring: it is still under way where it should turn,",
        "balancer.follower_mass_kg",
        "lower it, or enlarge spring_rate_n_per_mm or preload_n",
        [(at, at)],
    )
