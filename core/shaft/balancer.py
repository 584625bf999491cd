"""Balance cam on a spring, whose torque compensates the deviation of the shaft's torque from its mean.

With W(θ) = ∫(T - T̄)dθ, spring rate K and preload F0 the spring's energy is F0 x + ½K x² = E0 - W, E0 the greatest W,
so that the motion begins at x = 0:

    x = 2(E0 - W)/(F0 + √(F0² + 2K(E0 - W))),   x' = -(T - T̄)/(F0 + Kx),   x'' = -(T' + Kx'²)/(F0 + Kx).

The torque of this follower is (F0 + Kx)x' = -(T - T̄). It balances one speed. With a mass its kinetic energy adds to
the spring's: see ``follower_mass``.
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
from core.number_text import result_text
from core.numerics.lazy import checkpoint
from core.shaft.curve import NODES, LoadCurve, nodes, polyval, to_powers
from core.shaft.flywheel import energy_range, highest_at, sign_changes, torque_deviation
from core.shaft.speed import collocation

# -- balance cam whose follower has a mass ----------------------------------------------------------------------


AT_REST = 1e-11  # of the torque's swing: a smaller torque leaves the follower at rest
MATCH = 1e-7  # of the torque's swing: tolerance of the two solutions that meet in a minimum of W
ITERATIONS, CLOSE = 30, 1e-10  # of the speed's size
POLISH_STEPS = 3  # of Newton's method on the torque itself
TORQUE_TOLERANCE = 1e-14  # of the torque's swing
LEAST_SHARE = 2.0**-12


@frozen(eq=False)
class Energy:
    """Energy E0 - W on the load's m panels, as coefficients of r**k.

    Attributes
    ----------
    start, width : ndarray (m,) [rad]
    energy : ndarray (NODES + 1, m) [J]
    torque : ndarray (NODES, m) [N m]
        T - T̄.
    slope : ndarray (NODES - 1, m) [N m/rad]
        T'.
    swing : float
        Of the torque [N m].
    """

    start: np.ndarray
    width: np.ndarray
    energy: np.ndarray
    torque: np.ndarray
    slope: np.ndarray
    swing: float


@frozen(eq=False)
class _Followers:
    """Followers of n balance cams: spring rate [N/m], preload [N], mω² [kg/s²], each (n, 1); torque swing [N m]."""

    rate: np.ndarray
    preload: np.ndarray
    inertia: np.ndarray
    swing: float

    @classmethod
    def of(cls, balancers: Sequence[Balancer], omega: float, swing: float) -> _Followers:
        """Followers of balance cams at a speed [rad/s]."""
        parts = [si(balancer) for balancer in balancers]
        rows = [(s.spring_rate, s.preload, s.follower_mass * omega * omega) for s in parts]
        rate, preload, inertia = np.reshape(rows, (-1, 3)).T[:, :, None]
        return cls(rate, preload, inertia, swing)

    def at(self, which: np.ndarray) -> _Followers:
        """Selected followers, repeated as often as they are named."""
        return _Followers(self.rate[which], self.preload[which], self.inertia[which], self.swing)

    def resting(self, energy: np.ndarray) -> np.ndarray:
        """Position x [m] where the spring alone stores the energy [J], (n, 1)."""
        energy = np.maximum(energy, 0.0)
        return np.asarray(2.0 * energy / (self.preload + np.sqrt(self.preload**2 + 2.0 * self.rate * energy)))


@frozen(eq=False)
class _Parts:
    """Parts of the load's panels between sign changes of T - T̄, all (p,).

    panel: index of the panel; low, share: begin of the part in it, and its fraction; direction: +1 where x grows with
    the angle, -1 where it decreases, 0 at rest.
    """

    panel: np.ndarray
    low: np.ndarray
    share: np.ndarray
    direction: np.ndarray

    @property
    def begins(self) -> np.ndarray:
        """Coordinate in the panel at which the integration of a part begins."""
        return np.where(self.direction < 0, self.low + self.share, self.low)

    def runs(self) -> list[np.ndarray]:
        """Indices of consecutive parts of one direction, in the order of the integration: from a maximum of W on."""
        changes = np.flatnonzero(self.direction != np.roll(self.direction, 1))
        first = int(changes[0]) if changes.size else 0
        order = (first + np.arange(self.direction.size)) % self.direction.size
        runs = np.split(order, np.flatnonzero(np.diff(self.direction[order])) + 1)
        return [run if self.direction[run[0]] >= 0 else run[::-1] for run in runs]


Panels = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Start, width (m,) [rad] and coefficients (k, m) of r**k of x [m] over the turn, x = 0 at the greatest W."""


def heavy_panels(energy: Energy, balancers: Sequence[Balancer], omega: float) -> list[Panels | NoSolution]:
    """Motions of many balance cams with a follower's mass under one load, at a speed [rad/s].

    NoSolution replaces a motion whose follower is too heavy. The results are independent of each other.
    """
    followers = _Followers.of(balancers, omega, energy.swing)
    parts = _divide_at_sign_changes(energy)
    runs = parts.runs()
    at_rest = [run for run in runs if not parts.direction[run[0]]]
    pieces, too_heavy = _integrate_runs(energy, followers, parts, [run for run in runs if parts.direction[run[0]]])
    return [
        _too_heavy(too_heavy[k])
        if k in too_heavy
        else _assemble(energy, followers.at(np.array([k])), parts, pieces.of(k), at_rest)
        for k in range(len(balancers))
    ]


def _assemble(
    energy: Energy, follower: _Followers, parts: _Parts, moving: _Pieces, at_rest: Sequence[np.ndarray]
) -> Panels | NoSolution:
    """Pieces of one balance cam in the order of the angle, with those at rest."""
    rest = np.concatenate([np.zeros(0, dtype=int), *at_rest])
    x = follower.resting(polyval(parts.low[rest], energy.energy[:, parts.panel[rest]]))
    rows = np.zeros((rest.size, moving.rows.shape[1]))
    rows[:, 0] = x.ravel()
    part = np.concatenate((moving.part, rest))
    offset, share = (
        np.append(values, np.full(rest.size, fill)) for values, fill in ((moving.offset, 0.0), (moving.share, 1.0))
    )
    rows, is_reversed = np.vstack((moving.rows, rows)), parts.direction[part] < 0
    rows[is_reversed] = _matmul(_mirror(rows.shape[1]), rows[is_reversed])
    part_width = parts.share[part] * energy.width[parts.panel[part]]
    width = share * part_width
    start = energy.start[parts.panel[part]] + parts.low[part] * energy.width[parts.panel[part]]
    start = start + np.where(is_reversed, 1.0 - offset - share, offset) * part_width
    slope = rows[:, 1:] * np.arange(1, rows.shape[1])
    ends = np.column_stack((rows[:, 0], rows.sum(axis=1), slope[:, 0] / width, slope.sum(axis=1) / width))
    order = np.argsort(np.mod(start + 1e-13, TURN), kind="stable")
    if (mismatch := _mismatch(follower, ends[order])) is not None:
        return _too_heavy(float(start[order][mismatch]))
    return start[order], width[order], rows[order].T


def _divide_at_sign_changes(energy: Energy) -> _Parts:
    panel, root = sign_changes(energy.torque)
    at_rest = np.abs(energy.torque).sum(axis=0) <= AT_REST * energy.swing
    inside = (root > 1e-9) & (root < 1.0 - 1e-9) & ~at_rest[panel]
    panels = np.arange(energy.start.size)
    panel = np.concatenate((panels, panel[inside]))
    low = np.concatenate((np.zeros(panels.size), root[inside]))
    order = np.lexsort((low, panel))
    panel, low = panel[order], low[order]
    share = np.where(np.append(np.diff(panel) == 0, False), np.append(low[1:], 1.0), 1.0) - low
    torque = polyval((low + share * np.linspace(0.0, 1.0, 9)[:, None]), energy.torque[:, panel][:, None])
    direction = np.where(torque.sum(axis=0) > 0.0, -1, 1)
    return _Parts(panel, low, share, np.where(np.abs(torque).max(axis=0) <= AT_REST * energy.swing, 0, direction))


@frozen(eq=False)
class _Pieces:
    """Pieces of the motions, in the direction of integration.

    owner, part: indices of balance cam and part; offset, share: begin of the piece in the part, and its fraction, each
    (n,); rows: coefficients (n, k) of x by the piece's r.
    """

    owner: np.ndarray
    part: np.ndarray
    offset: np.ndarray
    share: np.ndarray
    rows: np.ndarray

    def of(self, owner: int) -> _Pieces:
        """Pieces of one balance cam."""
        mask = self.owner == owner
        return _Pieces(*(values[mask] for values in vars(self).values()))


def _integrate_runs(
    energy: Energy, followers: _Followers, parts: _Parts, runs: Sequence[np.ndarray]
) -> tuple[_Pieces, dict[int, float]]:
    """Motions of all balance cams through all runs in parallel, from the maxima of W on, where the follower rests.

    Also returns the followers that are too heavy: index -> angle [rad].
    """
    x, integrals, to_chebyshev, _ = collocation()
    begins, direction = parts.begins, parts.direction.astype(float)
    torques = polyval(begins + direction * parts.share * x[:, None], energy.torque[:, parts.panel][:, None]).T
    owner = np.repeat(np.arange(followers.rate.size), len(runs))
    run_index = np.tile(np.arange(len(runs)), followers.rate.size)
    queue = np.full((len(runs), max(map(len, runs), default=0) + 1), -1)
    for i, run in enumerate(runs):
        queue[i, : run.size] = run
    turn = np.zeros(owner.size, dtype=int)
    first = queue[run_index, 0]
    stored = polyval(begins[first], energy.energy[:, parts.panel[first]])
    position = followers.at(owner).resting(stored[:, None])
    speed0, offset, share = np.zeros_like(position), np.zeros(owner.size), np.ones(owner.size)
    pieces: list[tuple[np.ndarray, ...]] = [
        (*np.zeros((2, 0), dtype=int), *np.zeros((2, 0)), np.zeros((0, x.size + 2)))
    ]
    too_heavy: dict[int, tuple[int, float]] = {}
    active = np.arange(owner.size)
    while active.size:
        checkpoint()
        part, follower = queue[run_index[active], turn[active]], followers.at(owner[active])
        begin, piece = offset[active], share[active]
        torque = torques[part]
        if (piece < 1.0).any():
            r = begins[part] + (direction * parts.share)[part] * (begin + piece * x[:, None])
            torque = polyval(r, energy.torque[:, parts.panel[part]][:, None]).T
        h = (parts.share[part] * piece * energy.width[parts.panel[part]])[:, None]
        work, signs = -direction[part][:, None] * h * _matmul(integrals, torque), direction[part][:, None]
        with np.errstate(all="ignore"):  # of those that have no solution
            speed, solved = _solve_speed(follower, work, torque, h, position[active], speed0[active])
            acceleration, solved = _solve_acceleration(
                follower, -signs * torque, h, position[active], speed0[active], speed, solved
            )
            rows = _position_rows(acceleration, h, position[active], speed0[active])
            last = np.abs(_matmul(to_chebyshev[-2:], acceleration)).sum(axis=1, keepdims=True)
            force = follower.preload + follower.rate * rows.sum(axis=1, keepdims=True)
            residual = last * (h * force + follower.inertia * speed.max(axis=1, keepdims=True))
            is_resolved = solved & (residual <= RESOLVED * follower.swing).ravel()
        finest = piece <= LEAST_SHARE
        for i in np.flatnonzero(~solved & finest).tolist():
            angle = float(energy.start[parts.panel[part[i]]] + begins[part[i]] * energy.width[parts.panel[part[i]]])
            k = int(owner[active[i]])
            too_heavy[k] = min(too_heavy.get(k, (len(runs), 0.0)), (int(run_index[active[i]]), angle))
        accepted = is_resolved | (solved & finest)
        advanced, accepted_rows = active[accepted], rows[accepted]
        pieces.append((owner[advanced], part[accepted], begin[accepted], piece[accepted], accepted_rows))
        position[advanced] = accepted_rows.sum(axis=1, keepdims=True)
        speed0[advanced] += h[accepted] * _matmul(integrals[-1:], acceleration[accepted])
        offset[advanced] += piece[accepted]
        share[advanced] = np.minimum(2.0 * piece[accepted], 1.0 - offset[advanced])
        share[active[~accepted]] *= 0.5
        finished = advanced[offset[advanced] >= 1.0 - 1e-12]
        turn[finished], offset[finished], share[finished] = turn[finished] + 1, 0.0, 1.0
        done = (~solved & finest) | (queue[run_index[active], turn[active]] < 0)
        active = active[~done]
    return _Pieces(*map(np.concatenate, zip(*pieces, strict=True))), {k: angle for k, (_, angle) in too_heavy.items()}


def _solve_speed(
    follower: _Followers, work: np.ndarray, torque: np.ndarray, h: np.ndarray, position: np.ndarray, speed0: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Speed dx/dθ >= 0 at the nodes (n, k) in the direction of integration, and the mask (n,) of solutions.

    Newton's method from the speed without a mass. work: energy from the shaft since the start [J], where x = position
    and the speed is speed0.
    """
    _, integrals, _, _ = collocation()
    force0 = follower.preload + follower.rate * position
    speed = np.abs(torque) / np.sqrt(force0**2 + 2.0 * follower.rate * np.maximum(work, 0.0))
    size = (follower.swing / force0).ravel()
    rise, diagonal = h[:, :, None] * integrals, np.arange(speed.shape[1])
    is_converged, open_rows = np.zeros(size.size, dtype=bool), np.arange(size.size)
    for _ in range(ITERATIONS):
        open_follower, current = follower.at(open_rows), speed[open_rows]
        advance = _matmul(integrals, current) * h[open_rows]
        required = (
            0.5 * open_follower.inertia * (current**2 - speed0[open_rows] ** 2)
            + (force0[open_rows] + 0.5 * open_follower.rate * advance) * advance
        )
        jacobian = (force0[open_rows] + open_follower.rate * advance)[:, :, None] * rise[open_rows]
        jacobian[:, diagonal, diagonal] += open_follower.inertia * current
        change = np.linalg.solve(jacobian, (work[open_rows] - required)[:, :, None])[:, :, 0]
        speed[open_rows] = current + change
        largest = np.abs(change).max(axis=1)
        is_converged[open_rows] = largest <= CLOSE * size[open_rows]
        open_rows = open_rows[~is_converged[open_rows] & np.isfinite(largest)]
        if not open_rows.size:
            break
    return speed, is_converged & (speed.min(axis=1) >= -1e-9 * size)


def _solve_acceleration(
    follower: _Followers,
    target: np.ndarray,
    h: np.ndarray,
    position: np.ndarray,
    speed0: np.ndarray,
    speed: np.ndarray,
    solved: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration d²x/dθ² at the nodes (n, k), by Newton's method on the torque, (F + mω²x'')x' = target.

    It starts from the speed of the energy equation, so that the residual of the torque is rounding, also where the
    speed is small relative to its rounding. Also returns the mask (n,) of solutions.
    """
    x, integrals, _, _ = collocation()
    acceleration = _matmul(_inverse(), (speed - speed0) / h)
    force0 = follower.preload + follower.rate * (position + h * speed0 * x)
    open_rows, diagonal = np.flatnonzero(solved), np.arange(x.size)
    for _ in range(POLISH_STEPS):
        open_follower, current, widths = follower.at(open_rows), acceleration[open_rows], h[open_rows]
        rate = speed0[open_rows] + widths * _matmul(integrals, current)
        force = (
            force0[open_rows]
            + open_follower.rate * widths * widths * _matmul(_double_integral_at_nodes(), current)
            + open_follower.inertia * current
        )
        residual = target[open_rows] - force * rate
        far = np.abs(residual).max(axis=1) > TORQUE_TOLERANCE * follower.swing
        open_rows, open_follower, current, widths, rate, force = (
            open_rows[far],
            open_follower.at(far),
            current[far],
            widths[far],
            rate[far],
            force[far],
        )
        if not open_rows.size:
            break
        jacobian = (rate * open_follower.rate * widths * widths)[:, :, None] * _double_integral_at_nodes() + (
            force * widths
        )[:, :, None] * integrals
        jacobian[:, diagonal, diagonal] += open_follower.inertia * rate
        acceleration[open_rows] = current + np.linalg.solve(jacobian, residual[far][:, :, None])[:, :, 0]
    return acceleration, solved & np.isfinite(acceleration).all(axis=1)


def _matmul(matrix: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Product of each row of values (n, k) with a matrix (j, k), (n, j), in an order of summation independent of n."""
    return np.asarray(np.multiply(values[:, None, :], matrix, order="C").sum(axis=2))


@lru_cache(maxsize=1)
def _inverse() -> np.ndarray:
    """Matrix from integrals from 0 to each node to the values at the nodes."""
    return np.linalg.inv(collocation()[1])


@lru_cache(maxsize=1)
def _double_integral_at_nodes() -> np.ndarray:
    """Matrix from values at the nodes to their double integrals there."""
    return np.vander(collocation()[0], _double_integral().shape[0], increasing=True) @ _double_integral()


@lru_cache(maxsize=1)
def _mirror(count: int) -> np.ndarray:
    """Matrix from coefficients (count,) of p(r) to those of p(1 - r)."""
    return np.array([[(-1.0) ** j * comb(k, j) for k in range(count)] for j in range(count)])


def _position_rows(acceleration: np.ndarray, h: np.ndarray, position: np.ndarray, speed0: np.ndarray) -> np.ndarray:
    """Coefficients (n, k) of r**k of x, from its second derivative at the nodes, over widths h."""
    rows = h * h * _matmul(_double_integral(), acceleration)
    rows[:, :2] += np.hstack((position, h * speed0))
    return np.asarray(rows)


@lru_cache(maxsize=1)
def _double_integral() -> np.ndarray:
    """Matrix from values at the nodes (NODES,) to the power coefficients (NODES + 2,) of their double integral."""
    _, _, _, integral = collocation()
    return np.vstack((np.zeros((1, integral.shape[1])), integral / np.arange(1, integral.shape[0] + 1)[:, None]))


def _mismatch(follower: _Followers, ends: np.ndarray) -> int | None:
    """Index of the piece where two solutions that meet in a minimum of W differ; None without one."""
    force = follower.preload.ravel() + follower.rate.ravel() * np.abs(ends[:, 0])
    position = np.abs(ends[:, 0] - np.roll(ends[:, 1], 1)) * force
    speed = np.abs(ends[:, 2] - np.roll(ends[:, 3], 1)) * force
    worst = int(np.argmax(np.maximum(position, speed)))
    return worst if max(position[worst], speed[worst]) > MATCH * follower.swing else None


def _too_heavy(angle: float) -> NoSolution:
    degrees: Any = float(np.rad2deg(angle) % 360.0)
    return NoSolution(
        "the follower is too heavy for its spring: it still moves where it should reverse,",
        "balancer.follower_mass_kg",
        "lower it, or enlarge spring_rate_n_per_mm or preload_n",
        [(degrees, degrees)],
    )


# -- balance cam on a spring ------------------------------------------------------------------------------------


JUMP = 1e-9  # of the torque's swing: more from one panel to the next is a jump
RESOLVED = 1e-12  # of the torque's swing: largest share of the last coefficients of a panel
HALVINGS = 30
LEAST_PRELOAD = 1e-5  # of the spring's greatest force: with less the motion turns as sharply as at a kink
LEAST_SWING = 1e-12  # of the torque's size: a smaller swing is rounding
MM = 1e3


def balance_drive(load: LoadCurve, balancer: Balancer, omega: float) -> Drive:
    """The balance cam as a drive, whose cam angle is the machine angle less the balancer's phase.

    load: the torque to balance at the speed omega [rad/s]. Raises NoSolution where the torque jumps, or no follower
    exists.

    References
    ----------
    Energy of its spring, x = 2(E_0 - W)/(F_0 + √(F_0² + 2 K (E_0 - W))).
    """
    (drive,) = balance_drives(load, [balancer], omega)
    if isinstance(drive, NoSolution):
        raise drive
    return drive


def balance_drives(load: LoadCurve, balancers: Sequence[Balancer], omega: float) -> list[Drive | NoSolution]:
    """Drives of many balance cams of one load; the followers of all of them have a mass, or none.

    NoSolution replaces the drive of a balance cam that does not exist. Raises NoSolution where the torque jumps.
    """
    _require_smooth(load)
    energy, faults = _energy(load), [_slack_fault(load, balancer) for balancer in balancers]
    valid = [balancer for balancer, fault in zip(balancers, faults, strict=True) if fault is None]
    has_mass = bool(valid) and bool(valid[0].follower_mass_kg)
    panels = iter(heavy_panels(energy, valid, omega) if has_mass else [_panels(energy, each) for each in valid])
    return [fault or _drive(balancer, next(panels)) for balancer, fault in zip(balancers, faults, strict=True)]


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
    """The motion [mm] by the cam angle of the balance cam.

    x'' is fitted, x and x' are its integrals, so that the torque error is rounding.
    """
    pieces = _pieces_by_cam_angle(start, width, MM * coefficients, np.deg2rad(balancer.phase_deg) % TURN)
    first = pieces[0].polynomial[0]
    shifted = tuple(Piece(p.start, (p.polynomial[0] - first, *p.polynomial[1:])) for p in pieces)
    return Motion(first, (Segment(360.0, 0.0, ComputedCurve(shifted)),))


def _require_smooth(load: LoadCurve) -> None:
    """Raise NoSolution where the torque jumps: the motion would have a corner there."""
    ends, swing = load.torque.sum(axis=0), _swing(load)
    jump = np.roll(load.torque[0], -1) - ends
    jumps = np.abs(jump) > JUMP * swing
    if jumps.any():
        worst = int(np.argmax(np.abs(jump)))
        angles = np.sort(np.rad2deg((load.start + load.width)[jumps] % TURN))
        raise NoSolution(
            f"the torque that it balances jumps, by up to {result_text(abs(float(jump[worst])))} N·m,",
            "balancer",
            "smooth the motions there, so that no acceleration jumps",
            [(float(a), float(a)) for a in angles],
        )


def _slack_fault(load: LoadCurve, balancer: Balancer) -> NoSolution | None:
    """NoSolution where the preload is too small; otherwise None."""
    s = si(balancer)
    low, high = energy_range(load)
    least = LEAST_PRELOAD * np.sqrt(2.0 * s.spring_rate * (high - low))
    if s.preload >= least:
        return None
    angle = float(np.rad2deg(highest_at(load)))
    return NoSolution(
        f"with {balancer.preload_n:g} N its spring is slack where the motion is least, and the motion has a kink there,",
        "balancer.preload_n",
        f"enlarge it, to {result_text(least, 3)} N at least",
        [(angle, angle)],
    )


def _swing(load: LoadCurve) -> float:
    """Largest deviation of the torque from its mean [N m], at least its rounding."""
    x, _ = nodes()
    values = polyval(x, torque_deviation(load)[:, :, None])
    return float(max(np.abs(values).max(), LEAST_SWING * np.abs(load.mean)))


def _energy(load: LoadCurve) -> Energy:
    torque = torque_deviation(load)
    orders = np.arange(1, NODES + 1)[:, None]
    work = load.width * torque / orders
    gains = work.sum(axis=0)
    _, highest = energy_range(load)
    begins = highest - np.concatenate(([0.0], np.cumsum(gains)[:-1]))
    return Energy(
        load.start, load.width, np.vstack((begins, -work)), torque, orders[:-1] * torque[1:] / load.width, _swing(load)
    )


def _panels(energy: Energy, balancer: Balancer) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start, width (m,) [rad] and coefficients (NODES + 2, m) of r**k of x [m]: the load's panels, halved as needed."""
    x, to_chebyshev = nodes()
    parent, low, share = np.arange(energy.start.size), np.zeros(energy.start.size), np.ones(energy.start.size)
    parts: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for remaining in range(HALVINGS, -1, -1):
        width = share * energy.width[parent]
        _, _, acceleration, force = _motion(
            energy, balancer, np.repeat(parent, NODES), (low[:, None] + share[:, None] * x).ravel()
        )
        chebyshev = to_chebyshev @ acceleration.reshape(-1, NODES).T
        last = np.abs(chebyshev[-2:]).sum(axis=0) * width * force.reshape(-1, NODES).max(axis=1)
        is_resolved = (last <= RESOLVED * energy.swing) | (remaining == 0)
        position, rate, _, _ = _motion(energy, balancer, parent[is_resolved], low[is_resolved])
        parts.append(
            _integrate(
                energy,
                parent[is_resolved],
                low[is_resolved],
                width[is_resolved],
                chebyshev[:, is_resolved],
                position,
                rate,
            )
        )
        if is_resolved.all():
            break
        parent, share = np.repeat(parent[~is_resolved], 2), np.repeat(0.5 * share[~is_resolved], 2)
        low = np.repeat(low[~is_resolved], 2)
        low[1::2] += share[1::2]
    start, width = np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])
    order = np.argsort(start)
    return start[order], width[order], np.concatenate([part[2] for part in parts], axis=1)[:, order]


def _integrate(
    energy: Energy,
    parent: np.ndarray,
    low: np.ndarray,
    width: np.ndarray,
    chebyshev: np.ndarray,
    position: np.ndarray,
    rate: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start, width and coefficients of x, from the Chebyshev coefficients of x'', and x and x' at the begins."""
    acceleration = to_powers(NODES) @ chebyshev
    k = np.arange(NODES)[:, None]
    return (
        energy.start[parent] + low * energy.width[parent],
        width,
        np.vstack((position, width * rate, width**2 * acceleration / ((k + 1) * (k + 2)))),
    )


def _motion(energy: Energy, balancer: Balancer, panel: np.ndarray, r: np.ndarray) -> tuple[np.ndarray, ...]:
    """X [m], x', x'' and the spring's force [N] (n,) at coordinates r of the load's panels."""
    s = si(balancer)
    stored = np.maximum(polyval(r, energy.energy[:, panel]), 0.0)
    torque, slope = (polyval(r, row[:, panel]) for row in (energy.torque, energy.slope))
    force = np.sqrt(s.preload**2 + 2.0 * s.spring_rate * stored)
    rate = -torque / force
    return 2.0 * stored / (s.preload + force), rate, -(slope + s.spring_rate * rate**2) / force, force


def _pieces_by_cam_angle(start: np.ndarray, width: np.ndarray, coefficients: np.ndarray, phase: float) -> list[Piece]:
    """Pieces over u = 0 ... 1 of the balance cam's turn, which begins at the machine angle ``phase``."""
    cut = int(np.searchsorted(start, phase, side="right")) - 1
    rows = [(float(a), float(h), c) for a, h, c in zip(start - phase, width, coefficients.T, strict=True)]
    begins, h0, row = rows[cut]
    ahead, tail = rows[cut + 1 :], [(a + TURN, h, c) for a, h, c in rows[:cut]]
    if begins < 0.0:
        tail.append((begins + TURN, h0, row))
        row = np.array(shifted(row.tolist(), -begins / h0))
        begins = 0.0
    pieces = []
    for a, h, c in [(begins, h0, row), *ahead, *tail]:
        pieces.append(Piece(a / TURN, tuple((c * (TURN / h) ** np.arange(c.size)).tolist())))
    return pieces


FIRST_STROKE = 0.1  # [m] of a new balance cam
SHARE = 0.25  # of the energy, of its preload


def with_balancer(design: Design, energy_swing: float) -> Design:
    """The design with a new balance cam, whose values are marked as assumed; energy_swing [J]: of its torque."""
    marks = tuple(
        f"balancer.{key}" for key in ("spring_rate_n_per_mm", "preload_n", "base_radius_mm", "roller_radius_mm")
    )
    return replace(design, balancer=first_balancer(energy_swing), assumed=(*design.assumed, *marks))


def first_balancer(energy_swing: float) -> Balancer:
    """A new balance cam to start from, with a stroke of 100 mm for the energy swing [J]: F0 s + ½ k s² = ΔE."""
    work = max(energy_swing, 1.0)
    rate, preload = 2.0 * (1.0 - SHARE) * work / FIRST_STROKE**2, SHARE * work / FIRST_STROKE
    return Balancer(
        spring_rate_n_per_mm=float(f"{rate / 1e3:.3g}"),
        preload_n=float(f"{preload:.3g}"),
        base_radius_mm=200.0,
        roller_radius_mm=50.0,
    )
