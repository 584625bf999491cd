"""A balance cam on a spring: the motion whose spring gives what the shaft's torque lacks of its mean, and takes what it has above.

With W(θ) = ∫(T - T̄)dθ, spring rate K and preload F0 the spring's energy F0 x + ½K x² = E0 - W, E0 the greatest W, so that the
motion begins at x = 0:

    x = 2(E0 - W)/(F0 + √(F0² + 2K(E0 - W))),   x' = -(T - T̄)/(F0 + Kx),   x'' = -(T' + Kx'²)/(F0 + Kx).

The torque of this follower is (F0 + Kx)x' = -(T - T̄). It balances one speed. With a mass its kinetic energy joins the spring's: see
``follower_mass``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from math import comb
from typing import Any

import numpy as np

from core.design import (
    Balancer,
    ComputedCurve,
    Design,
    Drive,
    Motion,
    RollerCam,
    Segment,
    Translating,
    TranslatingLoads,
    si,
)
from core.errors import NoSolution
from core.frozen import frozen
from core.laws import Piece, shifted
from core.motion import TURN
from core.numerics.lazy import checkpoint
from core.shaft.curve import NODES, LoadCurve, nodes, polyval, to_powers
from core.shaft.flywheel import energy_range, highest_at, roots_of, unbalanced
from core.shaft.speed import collocation

# -- the motion of a balance cam whose follower has a mass m ----------------------------------------------------


AT_REST = 1e-11  # of the torque's swing: where no more is to be balanced nothing moves
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
class _Followers:
    """Of many balance cams: spring rate [N/m], preload [N], mω² [kg/s²], each (n, 1); swing of the torque [N m]."""

    rate: np.ndarray
    preload: np.ndarray
    inertia: np.ndarray
    swing: float

    @classmethod
    def of(cls, balancers: Sequence[Balancer], omega: float, swing: float) -> _Followers:
        """At a speed [rad/s]."""
        parts = [si(each) for each in balancers]
        rows = [(s.spring_rate, s.preload, s.follower_mass * omega * omega) for s in parts]
        rate, preload, inertia = np.reshape(rows, (-1, 3)).T[:, :, None]
        return cls(rate, preload, inertia, swing)

    def at(self, which: np.ndarray) -> _Followers:
        """Some of them, each as often as it is named."""
        return _Followers(self.rate[which], self.preload[which], self.inertia[which], self.swing)

    def resting(self, energy: np.ndarray) -> np.ndarray:
        """x [m] where the spring alone holds the energy [J], (n, 1)."""
        energy = np.maximum(energy, 0.0)
        return np.asarray(2.0 * energy / (self.preload + np.sqrt(self.preload**2 + 2.0 * self.rate * energy)))


@frozen(eq=False)
class _Parts:
    """The load's panels, cut where T - T̄ changes its sign: panel, where in it a part begins, and how much of it that is; way +1 where x
    grows with the angle, -1 where it falls, 0 where nothing moves. All (p,)."""

    panel: np.ndarray
    low: np.ndarray
    share: np.ndarray
    way: np.ndarray

    @property
    def begins(self) -> np.ndarray:
        """Where in its panel the march through a part begins."""
        return np.where(self.way < 0, self.low + self.share, self.low)

    def runs(self) -> list[np.ndarray]:
        """Numbers of parts of one way, in the order of the march: from the peak of W on."""
        turns = np.flatnonzero(self.way != np.roll(self.way, 1))
        first = int(turns[0]) if turns.size else 0
        order = (first + np.arange(self.way.size)) % self.way.size
        runs = np.split(order, np.flatnonzero(np.diff(self.way[order])) + 1)
        return [run if self.way[run[0]] >= 0 else run[::-1] for run in runs]


Panels = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Start, width (m,) [rad] and coefficients (k, m) of r**k, of x [m] over the turn, x = 0 at the greatest W."""


def heavy_panels(energy: Energy, balancers: Sequence[Balancer], omega: float) -> list[Panels | NoSolution]:
    """Of many balance cams of one load at a speed [rad/s]; NoSolution of those whose follower is too heavy. What one gives does not depend
    on the others."""
    followers = _Followers.of(balancers, omega, energy.swing)
    parts = _cut_at_turns(energy)
    runs = parts.runs()
    still = [run for run in runs if not parts.way[run[0]]]
    pieces, lost = _marched(energy, followers, parts, [run for run in runs if parts.way[run[0]]])
    return [
        _too_heavy(lost[k])
        if k in lost
        else _assembled(energy, followers.at(np.array([k])), parts, pieces.of(k), still)
        for k in range(len(balancers))
    ]


def _assembled(
    energy: Energy, follower: _Followers, parts: _Parts, moving: _Pieces, still: Sequence[np.ndarray]
) -> Panels | NoSolution:
    """The pieces of one balance cam by the angle, those in which nothing moves among them."""
    rest = np.concatenate([np.zeros(0, dtype=int), *still])
    x = follower.resting(polyval(parts.low[rest], energy.energy[:, parts.panel[rest]]))
    rows = np.zeros((rest.size, moving.rows.shape[1]))
    rows[:, 0] = x.ravel()
    part = np.concatenate((moving.part, rest))
    off, much = (np.append(each, np.full(rest.size, one)) for each, one in ((moving.off, 0.0), (moving.much, 1.0)))
    rows, back = np.vstack((moving.rows, rows)), parts.way[part] < 0
    rows[back] = _through(_mirror(rows.shape[1]), rows[back])
    wide = parts.share[part] * energy.width[parts.panel[part]]
    width = much * wide
    start = energy.start[parts.panel[part]] + parts.low[part] * energy.width[parts.panel[part]]
    start = start + np.where(back, 1.0 - off - much, off) * wide
    slope = rows[:, 1:] * np.arange(1, rows.shape[1])
    ends = np.column_stack((rows[:, 0], rows.sum(axis=1), slope[:, 0] / width, slope.sum(axis=1) / width))
    order = np.argsort(np.mod(start + 1e-13, TURN), kind="stable")
    if (unmet := _unmet(follower, ends[order])) is not None:
        return _too_heavy(float(start[order][unmet]))
    return start[order], width[order], rows[order].T


def _cut_at_turns(energy: Energy) -> _Parts:
    panel, root = roots_of(energy.torque)
    still = np.abs(energy.torque).sum(axis=0) <= AT_REST * energy.swing
    inside = (root > 1e-9) & (root < 1.0 - 1e-9) & ~still[panel]
    every = np.arange(energy.start.size)
    panel = np.concatenate((every, panel[inside]))
    low = np.concatenate((np.zeros(every.size), root[inside]))
    order = np.lexsort((low, panel))
    panel, low = panel[order], low[order]
    share = np.where(np.append(np.diff(panel) == 0, False), np.append(low[1:], 1.0), 1.0) - low
    torque = polyval((low + share * np.linspace(0.0, 1.0, 9)[:, None]), energy.torque[:, panel][:, None])
    way = np.where(torque.sum(axis=0) > 0.0, -1, 1)
    return _Parts(panel, low, share, np.where(np.abs(torque).max(axis=0) <= AT_REST * energy.swing, 0, way))


@frozen(eq=False)
class _Pieces:
    """Of which balance cam, of which part, where in it they begin, how much of it they are, each (n,), and coefficients (n, k) of x by
    their own r, in the direction of the march."""

    owner: np.ndarray
    part: np.ndarray
    off: np.ndarray
    much: np.ndarray
    rows: np.ndarray

    def of(self, owner: int) -> _Pieces:
        """Those of one."""
        mine = self.owner == owner
        return _Pieces(*(each[mine] for each in vars(self).values()))


def _marched(
    energy: Energy, followers: _Followers, parts: _Parts, runs: Sequence[np.ndarray]
) -> tuple[_Pieces, dict[int, float]]:
    """x of all balance cams through all runs side by side, from the peak on, where it rests; and those that are too heavy: number ->
    angle [rad] where."""
    x, integrals, to_chebyshev, _ = collocation()
    begins, way = parts.begins, parts.way.astype(float)
    torques = polyval(begins + way * parts.share * x[:, None], energy.torque[:, parts.panel][:, None]).T
    owner = np.repeat(np.arange(followers.rate.size), len(runs))
    lane = np.tile(np.arange(len(runs)), followers.rate.size)
    queue = np.full((len(runs), max(map(len, runs), default=0) + 1), -1)
    for i, run in enumerate(runs):
        queue[i, : run.size] = run
    turn = np.zeros(owner.size, dtype=int)
    first = queue[lane, 0]
    stored = polyval(begins[first], energy.energy[:, parts.panel[first]])
    place = followers.at(owner).resting(stored[:, None])
    begun, off, much = np.zeros_like(place), np.zeros(owner.size), np.ones(owner.size)
    found: list[tuple[np.ndarray, ...]] = [(*np.zeros((2, 0), dtype=int), *np.zeros((2, 0)), np.zeros((0, x.size + 2)))]
    lost: dict[int, tuple[int, float]] = {}
    going = np.arange(owner.size)
    while going.size:
        checkpoint()
        part, one = queue[lane[going], turn[going]], followers.at(owner[going])
        at, piece = off[going], much[going]
        torque = torques[part]
        if (piece < 1.0).any():
            r = begins[part] + (way * parts.share)[part] * (at + piece * x[:, None])
            torque = polyval(r, energy.torque[:, parts.panel[part]][:, None]).T
        h = (parts.share[part] * piece * energy.width[parts.panel[part]])[:, None]
        given, ways = -way[part][:, None] * h * _through(integrals, torque), way[part][:, None]
        with np.errstate(all="ignore"):  # of those that have no solution
            speed, solved = _solved(one, given, torque, h, place[going], begun[going])
            bend, solved = _bent(one, -ways * torque, h, place[going], begun[going], speed, solved)
            rows = _placed(bend, h, place[going], begun[going])
            last = np.abs(_through(to_chebyshev[-2:], bend)).sum(axis=1, keepdims=True)
            force = one.preload + one.rate * rows.sum(axis=1, keepdims=True)
            left = last * (h * force + one.inertia * speed.max(axis=1, keepdims=True))
            fine = solved & (left <= RESOLVED * one.swing).ravel()
        finest = piece <= LEAST_SHARE
        for i in np.flatnonzero(~solved & finest).tolist():
            angle = float(energy.start[parts.panel[part[i]]] + begins[part[i]] * energy.width[parts.panel[part[i]]])
            k = int(owner[going[i]])
            lost[k] = min(lost.get(k, (len(runs), 0.0)), (int(lane[going[i]]), angle))
        taken = fine | (solved & finest)
        on, ended = going[taken], rows[taken]
        found.append((owner[on], part[taken], at[taken], piece[taken], ended))
        place[on] = ended.sum(axis=1, keepdims=True)
        begun[on] += h[taken] * _through(integrals[-1:], bend[taken])
        off[on] += piece[taken]
        much[on] = np.minimum(2.0 * piece[taken], 1.0 - off[on])
        much[going[~taken]] *= 0.5
        over = on[off[on] >= 1.0 - 1e-12]
        turn[over], off[over], much[over] = turn[over] + 1, 0.0, 1.0
        dead = (~solved & finest) | (queue[lane[going], turn[going]] < 0)
        going = going[~dead]
    return _Pieces(*map(np.concatenate, zip(*found, strict=True))), {k: angle for k, (_, angle) in lost.items()}


def _solved(
    one: _Followers, given: np.ndarray, torque: np.ndarray, h: np.ndarray, place: np.ndarray, begun: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The speed dx/dθ >= 0 at the nodes (n, k) in the direction of the march, by Newton's method from that without a mass, and which are
    solved (n,); given: what the shaft has given from the start on [J], where x = place and the speed = begun."""
    _, integrals, _, _ = collocation()
    pull = one.preload + one.rate * place
    speed = np.abs(torque) / np.sqrt(pull**2 + 2.0 * one.rate * np.maximum(given, 0.0))
    size = (one.swing / pull).ravel()
    rise, diagonal = h[:, :, None] * integrals, np.arange(speed.shape[1])
    near, left = np.zeros(size.size, dtype=bool), np.arange(size.size)
    for _ in range(ITERATIONS):
        own, now = one.at(left), speed[left]
        more = _through(integrals, now) * h[left]
        missing = 0.5 * own.inertia * (now**2 - begun[left] ** 2) + (pull[left] + 0.5 * own.rate * more) * more
        jacobian = (pull[left] + own.rate * more)[:, :, None] * rise[left]
        jacobian[:, diagonal, diagonal] += own.inertia * now
        change = np.linalg.solve(jacobian, (given[left] - missing)[:, :, None])[:, :, 0]
        speed[left] = now + change
        largest = np.abs(change).max(axis=1)
        near[left] = largest <= CLOSE * size[left]
        left = left[~near[left] & np.isfinite(largest)]
        if not left.size:
            break
    return speed, near & (speed.min(axis=1) >= -1e-9 * size)


def _bent(
    one: _Followers,
    taken: np.ndarray,
    h: np.ndarray,
    place: np.ndarray,
    begun: np.ndarray,
    speed: np.ndarray,
    solved: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """d²x/dθ² at the nodes (n, k) by Newton's method on the torque itself, (F + mω²x'')x' = taken, from the speed that the energy gives:
    so that what is left of the torque is rounding, also where the speed is small against its own rounding; and which are solved (n,)."""
    x, integrals, _, _ = collocation()
    bend = _through(_inverse(), (speed - begun) / h)
    pull = one.preload + one.rate * (place + h * begun * x)
    left, diagonal = np.flatnonzero(solved), np.arange(x.size)
    for _ in range(POLISHED):
        own, now, wide = one.at(left), bend[left], h[left]
        rate = begun[left] + wide * _through(integrals, now)
        force = pull[left] + own.rate * wide * wide * _through(_climb(), now) + own.inertia * now
        missing = taken[left] - force * rate
        far = np.abs(missing).max(axis=1) > LEFT * one.swing
        left, own, now, wide, rate, force = left[far], own.at(far), now[far], wide[far], rate[far], force[far]
        if not left.size:
            break
        jacobian = (rate * own.rate * wide * wide)[:, :, None] * _climb() + (force * wide)[:, :, None] * integrals
        jacobian[:, diagonal, diagonal] += own.inertia * rate
        bend[left] = now + np.linalg.solve(jacobian, missing[far][:, :, None])[:, :, 0]
    return bend, solved & np.isfinite(bend).all(axis=1)


def _through(matrix: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Each row of values (n, k) through a matrix (j, k): (n, j), in one order of summation whatever n is."""
    return np.asarray(np.multiply(values[:, None, :], matrix, order="C").sum(axis=2))


@lru_cache(maxsize=1)
def _inverse() -> np.ndarray:
    """From integrals from 0 to each node to the values at the nodes."""
    return np.linalg.inv(collocation()[1])


@lru_cache(maxsize=1)
def _climb() -> np.ndarray:
    """From values at the nodes to their integrals' integrals there."""
    return np.vander(collocation()[0], _twice().shape[0], increasing=True) @ _twice()


@lru_cache(maxsize=1)
def _mirror(count: int) -> np.ndarray:
    """From coefficients (count,) of p(r) to those of p(1 - r)."""
    return np.array([[(-1.0) ** j * comb(k, j) for k in range(count)] for j in range(count)])


def _placed(bend: np.ndarray, h: np.ndarray, place: np.ndarray, begun: np.ndarray) -> np.ndarray:
    """Coefficients (n, k) of r**k of x, of which the second derivative is given at the nodes, over widths h."""
    rows = h * h * _through(_twice(), bend)
    rows[:, :2] += np.hstack((place, h * begun))
    return np.asarray(rows)


@lru_cache(maxsize=1)
def _twice() -> np.ndarray:
    """From values at the nodes (NODES,) the power coefficients (NODES + 2,) of their integral's integral."""
    _, _, _, integral = collocation()
    return np.vstack((np.zeros((1, integral.shape[1])), integral / np.arange(1, integral.shape[0] + 1)[:, None]))


def _unmet(follower: _Followers, ends: np.ndarray) -> int | None:
    """Number of the piece before which two ways into a valley end at different places, or under way; None where none do."""
    force = follower.preload.ravel() + follower.rate.ravel() * np.abs(ends[:, 0])
    place = np.abs(ends[:, 0] - np.roll(ends[:, 1], 1)) * force
    speed = np.abs(ends[:, 2] - np.roll(ends[:, 3], 1)) * force
    worst = int(np.argmax(np.maximum(place, speed)))
    return worst if max(place[worst], speed[worst]) > MET * follower.swing else None


def _too_heavy(angle: float) -> NoSolution:
    at: Any = float(np.rad2deg(angle) % 360.0)
    return NoSolution(
        "the follower is too heavy for its spring: it is still under way where it should turn,",
        "balancer.follower_mass_kg",
        "lower it, or enlarge spring_rate_n_per_mm or preload_n",
        [(at, at)],
    )


# -- A balance cam on a spring ----------------------------------------------------------------------------------


JUMP = 1e-9  # of the torque's swing: more from one panel to the next is a jump
RESOLVED = 1e-12  # of the torque's swing: what the last coefficients of a panel may add to it
HALVINGS = 30
LEAST_PRELOAD = 1e-5  # of the spring's greatest force: with less the motion turns as sharply as at a kink
LEAST_SWING = 1e-12  # of the torque's size: less is rounding, and nothing to be balanced
MM = 1e3


def balance_drive(load: LoadCurve, balancer: Balancer, omega: float) -> Drive:
    """The balance cam as a drive of its own, whose cam angle is the machine angle less the balancer's phase.

    load: what is to be balanced at the speed omega [rad/s]. Raises NoSolution where the torque jumps, or nothing follows it.

    References
    ----------
    Energy of its spring, x = 2(E_0 - W)/(F_0 + √(F_0² + 2 K (E_0 - W))).
    """
    (found,) = balance_drives(load, [balancer], omega)
    if isinstance(found, NoSolution):
        raise found
    return found


def balance_drives(load: LoadCurve, balancers: Sequence[Balancer], omega: float) -> list[Drive | NoSolution]:
    """The same of many balance cams of one load; those with a mass on their followers, or none of them. In place of one that has no
    answer why it has none. Raises NoSolution where the torque jumps."""
    _require_smooth(load)
    energy, found = _energy(load), [_too_slack(load, each) for each in balancers]
    good = [each for each, fault in zip(balancers, found, strict=True) if fault is None]
    heavy = bool(good) and bool(good[0].follower_mass_kg)
    made = iter(heavy_panels(energy, good, omega) if heavy else [_panels(energy, each) for each in good])
    return [fault or _drive(each, next(made)) for each, fault in zip(balancers, found, strict=True)]


def _drive(balancer: Balancer, panels: Panels | NoSolution) -> Drive | NoSolution:
    if isinstance(panels, NoSolution):
        return panels
    loads = TranslatingLoads(
        spring_rate_n_per_mm=balancer.spring_rate_n_per_mm,
        preload_n=balancer.preload_n,
        gravity_m_s2=0.0,
        follower_mass_kg=balancer.follower_mass_kg,
    )
    cam = RollerCam(base_radius_mm=balancer.base_radius_mm, roller_radius_mm=balancer.roller_radius_mm)
    return Drive(motion=_motion_of(balancer, *panels), mechanism=Translating(), cam=cam, loads=loads)


def _motion_of(balancer: Balancer, start: np.ndarray, width: np.ndarray, coefficients: np.ndarray) -> Motion:
    """The motion [mm] by the cam's own angle: pieces of which x'' is fitted and x and x' are its integrals, so that the torque that
    it leaves is rounding."""
    pieces = _by_own_angle(start, width, MM * coefficients, np.deg2rad(balancer.phase_deg) % TURN)
    first = pieces[0].polynomial[0]
    shifted = tuple(Piece(p.start, (p.polynomial[0] - first, *p.polynomial[1:])) for p in pieces)
    return Motion(first, (Segment(360.0, 0.0, ComputedCurve(shifted)),))


def _require_smooth(load: LoadCurve) -> None:
    """Raises NoSolution where the torque jumps: the motion would have a corner there."""
    ends, swing = load.torque.sum(axis=0), _swing(load)
    jump = np.roll(load.torque[0], -1) - ends
    jumps = np.abs(jump) > JUMP * swing
    if jumps.any():
        worst = int(np.argmax(np.abs(jump)))
        angles = np.sort(np.rad2deg((load.start + load.width)[jumps] % TURN))
        raise NoSolution(
            f"the torque that it balances jumps, by up to {abs(float(jump[worst])):.6g} N m,",
            "balancer",
            "smooth the motions there, so that no acceleration jumps",
            [(float(a), float(a)) for a in angles],
        )


def _too_slack(load: LoadCurve, balancer: Balancer) -> NoSolution | None:
    """What stands against its preload."""
    s = si(balancer)
    low, high = energy_range(load)
    least = LEAST_PRELOAD * np.sqrt(2.0 * s.spring_rate * (high - low))
    if s.preload >= least:
        return None
    angle = float(np.rad2deg(highest_at(load)))
    return NoSolution(
        f"with {balancer.preload_n:g} N its spring is slack where the motion is least, and the motion has a kink there,",
        "balancer.preload_n",
        f"enlarge it, to {least:.3g} N at least",
        [(angle, angle)],
    )


def _swing(load: LoadCurve) -> float:
    """How far the torque goes from its mean [N m]; at least what rounding makes of it."""
    x, _ = nodes()
    values = polyval(x, unbalanced(load)[:, :, None])
    return float(max(np.abs(values).max(), LEAST_SWING * np.abs(load.mean)))


def _energy(load: LoadCurve) -> Energy:
    torque = unbalanced(load)
    orders = np.arange(1, NODES + 1)[:, None]
    given = load.width * torque / orders
    gained = given.sum(axis=0)
    _, highest = energy_range(load)
    begins = highest - np.concatenate(([0.0], np.cumsum(gained)[:-1]))
    return Energy(
        load.start, load.width, np.vstack((begins, -given)), torque, orders[:-1] * torque[1:] / load.width, _swing(load)
    )


def _panels(energy: Energy, balancer: Balancer) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start, width (m,) [rad] and coefficients (NODES + 2, m) of r**k, of x [m]: the load's panels, halved where that takes more."""
    x, to_chebyshev = nodes()
    parent, low, share = np.arange(energy.start.size), np.zeros(energy.start.size), np.ones(energy.start.size)
    done: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for left in range(HALVINGS, -1, -1):
        width = share * energy.width[parent]
        _, _, bend, force = _motion(
            energy, balancer, np.repeat(parent, NODES), (low[:, None] + share[:, None] * x).ravel()
        )
        chebyshev = to_chebyshev @ bend.reshape(-1, NODES).T
        last = np.abs(chebyshev[-2:]).sum(axis=0) * width * force.reshape(-1, NODES).max(axis=1)
        fine = (last <= RESOLVED * energy.swing) | (left == 0)
        place, rate, _, _ = _motion(energy, balancer, parent[fine], low[fine])
        done.append(_integrated(energy, parent[fine], low[fine], width[fine], chebyshev[:, fine], place, rate))
        if fine.all():
            break
        parent, share = np.repeat(parent[~fine], 2), np.repeat(0.5 * share[~fine], 2)
        low = np.repeat(low[~fine], 2)
        low[1::2] += share[1::2]
    start, width = np.concatenate([part[0] for part in done]), np.concatenate([part[1] for part in done])
    order = np.argsort(start)
    return start[order], width[order], np.concatenate([part[2] for part in done], axis=1)[:, order]


def _integrated(
    energy: Energy,
    parent: np.ndarray,
    low: np.ndarray,
    width: np.ndarray,
    chebyshev: np.ndarray,
    place: np.ndarray,
    rate: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start, width and coefficients of x, from the Chebyshev coefficients of x'', and x and x' where a panel begins."""
    bend = to_powers(NODES) @ chebyshev
    k = np.arange(NODES)[:, None]
    return (
        energy.start[parent] + low * energy.width[parent],
        width,
        np.vstack((place, width * rate, width**2 * bend / ((k + 1) * (k + 2)))),
    )


def _motion(energy: Energy, balancer: Balancer, panel: np.ndarray, r: np.ndarray) -> tuple[np.ndarray, ...]:
    """x [m], x', x'' and the spring's force [N] (n,) at places r of the load's panels."""
    s = si(balancer)
    stored = np.maximum(polyval(r, energy.energy[:, panel]), 0.0)
    torque, slope = (polyval(r, row[:, panel]) for row in (energy.torque, energy.slope))
    force = np.sqrt(s.preload**2 + 2.0 * s.spring_rate * stored)
    rate = -torque / force
    return 2.0 * stored / (s.preload + force), rate, -(slope + s.spring_rate * rate**2) / force, force


def _by_own_angle(start: np.ndarray, width: np.ndarray, coefficients: np.ndarray, phase: float) -> list[Piece]:
    """Pieces over u = 0 ... 1 of the cam's own turn, which begins at the machine angle ``phase``."""
    cut = int(np.searchsorted(start, phase, side="right")) - 1
    rows = [(float(a), float(h), c) for a, h, c in zip(start - phase, width, coefficients.T, strict=True)]
    begins, wide, row = rows[cut]
    ahead, tail = rows[cut + 1 :], [(a + TURN, h, c) for a, h, c in rows[:cut]]
    if begins < 0.0:
        tail.append((begins + TURN, wide, row))
        row = np.array(shifted(row.tolist(), -begins / wide))
        begins = 0.0
    pieces = []
    for a, h, c in [(begins, wide, row), *ahead, *tail]:
        pieces.append(Piece(a / TURN, tuple((c * (TURN / h) ** np.arange(c.size)).tolist())))
    return pieces


FIRST_STROKE = 0.1  # [m] of a balance cam to begin with
SHARE = 0.25  # of the energy that its preload takes


def with_balancer(design: Design, energy_swing: float) -> Design:
    """The design with a balance cam to begin with, marked as assumed; energy_swing [J] of its torque."""
    marks = tuple(
        f"balancer.{key}" for key in ("spring_rate_n_per_mm", "preload_n", "base_radius_mm", "roller_radius_mm")
    )
    return replace(design, balancer=first_balancer(energy_swing), assumed=(*design.assumed, *marks))


def first_balancer(energy_swing: float) -> Balancer:
    """A balance cam to begin with, whose follower runs 100 mm for so much energy [J]: F0 s + ½ k s² = ΔE. All of it is to be changed."""
    work = max(energy_swing, 1.0)
    rate, preload = 2.0 * (1.0 - SHARE) * work / FIRST_STROKE**2, SHARE * work / FIRST_STROKE
    return Balancer(
        spring_rate_n_per_mm=float(f"{rate / 1e3:.3g}"),
        preload_n=float(f"{preload:.3g}"),
        base_radius_mm=200.0,
        roller_radius_mm=50.0,
    )
