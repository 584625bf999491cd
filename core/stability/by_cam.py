"""The nonlinear wind-up (13) of Kim1990 by the cam's own angle τ = y - β [turns], while the cam rotates forward.

With the cam's speed v = 1 - β' = Π/D

    dβ/dτ = 1/v - 1,    dΠ/dτ = 2πQ C v + (4π²η² β + 4πζη - 2πQ U)/v - 4πζη,

in which joins are at known angles, and d, C, U at the nodes are the same in every turn. A leg, several cells none of
which
crosses a join, is solved as one system: Gauss-Legendre collocation in each cell, by Newton's method, the cells linked
by the
2 x 2 matrices that carry a state from one to the next. Where the cam almost stops or reverses its angle is no
independent
variable: there ``Integrator`` continues by the input's turn.
"""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cached_property
from math import pi

import numpy as np

from core.frozen import frozen
from core.motion import TURN
from core.numerics.lazy import checkpoint
from core.numerics.roots import gauss
from core.stability.coefficients import Coefficients, is_dwell
from core.stability.integrator import ARRIVED, FASTEST, PHASE, IntegrationStep, Integrator, OnPieces, WindUpEquation
from core.stability.panels import NODES, Panels, integrals, integration, powers, to_legendre

TAIL = (
    1e-8  # greatest last Legendre coefficients relative to the largest |β| so far; a tenth of it bounds the truncation
)
SETTLED = 1e-12  # greatest change by the next sweep, relative to the same
SWEEPS, LINEARISED = 12, 3  # most sweeps of a leg; the first of them linearise again
PANELS_PER_CELL = 4.0  # panels of the coefficients per cell
CELLS = 8  # most cells of a leg
HALVINGS = 1  # of a leg's cells, for trajectories that need shorter ones
SLOWEST = 0.15  # of the even speed: below it the cam's angle is no independent variable
INPUT_TURNS = 0.25  # turns of the input over which such a trajectory is then integrated
INVERSIONS = 5  # steps of Newton's method for the cam angle at a time
REMAINDER = 2.0 / (2 * NODES + 1)  # share of a Legendre coefficient in its integral over a step of length 1, twice
INSIDE = 1e-11  # [turns] a trajectory this close to the end of a leg is beyond it

_NODES, _WEIGHTS = gauss(NODES)
_WITHIN = integration(NODES)
_TAIL = to_legendre(NODES)[-2:].T


def follow(
    coefficients: Coefficients, eta: np.ndarray, q: np.ndarray, damping: float, start: np.ndarray | None, periods: float
) -> tuple[IntegrationStep, np.ndarray]:
    """Integrate m trajectories over y = 0 ... periods.

    Parameters
    ----------
    coefficients : Coefficients
    eta, q : ndarray (m,), dimensionless
    damping : float
        Damping ratio ζ.
    start : ndarray (m, 2) [turns], dimensionless, or None
        States (β, Π) at y = 0; None from rest.
    periods : float
        Turns of the input.

    Returns
    -------
    steps : IntegrationStep
        All steps, ordered by trajectory and time.
    arrived : ndarray (m,) of bool, dimensionless
        False where the cam runs away.

    Raises
    ------
    Cancelled
        Where the calculation is cancelled.
    """
    return _TrajectorySet(coefficients, eta, q, damping, periods).run(start)


@frozen(eq=False)
class _Leg:
    """Cells (K,) of a turn of the cam between their edges (K + 1,) [turns], and their number of halvings."""

    panels: Panels
    edges: np.ndarray
    halved: int = 0

    def halves(self) -> _Leg:
        """Return the leg with twice as many cells."""
        middle = 0.5 * (self.edges[1:] + self.edges[:-1])
        return _Leg(self.panels, np.sort(np.append(self.edges, middle)), self.halved + 1)

    def rows(self, edges: np.ndarray) -> np.ndarray:
        """d, C, U (3, n, K, NODES) at the nodes of cells between the given edges (n, K + 1)."""
        nodes = edges[:, :-1, None] + np.diff(edges)[..., None] * _NODES
        return self.panels.at(TURN * nodes.ravel(), 3).reshape(3, *nodes.shape)

    @cached_property
    def own_rows(self) -> np.ndarray:
        """d, C, U (3, 1, K, NODES) at the nodes of its own cells."""
        return self.rows(self.edges[None])


@frozen(eq=False)
class _Cells:
    """N solved cells, each of one trajectory.

    Attributes
    ----------
    cam, h : ndarray (N,) [turns of the cam]
        Cam angle at the start, and length.
    x : ndarray (N, 2) [turns], dimensionless
        β and Π at the start.
    rate : ndarray (N, 2, NODES), dimensionless
        dβ/dτ and dΠ/dτ.
    """

    trajectory: np.ndarray
    cam: np.ndarray
    h: np.ndarray
    x: np.ndarray
    rate: np.ndarray


class _TrajectorySet(WindUpEquation):
    """Current cam angles (m,) [turns], states (m, 2) and largest |β| so far (m,) of m trajectories."""

    def __init__(
        self, coefficients: Coefficients, eta: np.ndarray, q: np.ndarray, damping: float, periods: float
    ) -> None:
        super().__init__(coefficients, eta, q, damping)
        self.coefficients, self.periods = coefficients, periods
        self.legs = self._legs()
        self.cells: list[_Cells] = []
        self.steps: list[IntegrationStep] = []

    def _legs(self) -> list[_Leg]:
        width = self.panels.width / TURN
        dwells = np.logical_and.reduceat(is_dwell(self.panels), self.first)
        edges, wave = [0.0], PHASE / (2.0 * pi * float(self.eta.max()))
        for first, last, begin, end, dwell in zip(
            self.first, self.last, self.begins / TURN, self.ends / TURN, dwells, strict=True
        ):
            longest = min(wave, 1.0 if dwell else PANELS_PER_CELL * float(width[first : last + 1].min()))
            edges += [*np.linspace(begin, end, max(1, int(np.ceil((end - begin) / longest - 1e-9))) + 1)[1:]]
        return [_Leg(self.panels, np.array(edges[i : i + CELLS + 1])) for i in range(0, len(edges) - 1, CELLS)]

    def run(self, start: np.ndarray | None) -> tuple[IntegrationStep, np.ndarray]:
        """Integrate from states or from rest; see ``follow``."""
        self.x = self.resting() if start is None else np.array(start, dtype=float).reshape(-1, 2)
        self.cam, self.largest = -self.x[:, 0], np.abs(self.x[:, 0])
        final_y = self.periods - ARRIVED * (1.0 + self.periods)
        active = np.arange(self.eta.size)
        while active.size:
            checkpoint()
            leg_angle = np.mod(self.cam[active] + INSIDE, 1.0)
            number = np.searchsorted([leg.edges[0] for leg in self.legs], leg_angle, side="right") - 1
            slowest = int(number[(self.cam + self.x[:, 0])[active].argmin()])  # the trajectory furthest behind is next
            self._by_cam(self.legs[slowest], active[number == slowest])
            active = active[(self.cam + self.x[:, 0])[active] < final_y]  # nan is not
        if self.cells:
            self.steps.append(self._by_input())
        steps = IntegrationStep.joined(self.steps)
        return steps.select(np.lexsort((steps.y, steps.trajectory))), np.isfinite(self.cam)

    def _by_time(self, index: np.ndarray) -> None:
        """Integrate trajectories (n,) over a short part of the input's turn."""
        integrator = Integrator(self.coefficients, self.eta[index], self.q[index], self.damping)
        y = self.cam[index] + self.x[index, 0]
        run = integrator.run(self.x[index], y, np.minimum(y + INPUT_TURNS, self.periods), keep=True)
        self.steps += [replace(step, trajectory=index[step.trajectory]) for step in run.steps]
        self.x[index], self.cam[index] = run.x, run.y - run.x[:, 0]
        self.largest[index] = np.fmax(self.largest[index], np.abs(run.x[:, 0]))

    @np.errstate(all="ignore")  # nan has not settled
    def _by_cam(self, leg: _Leg, index: np.ndarray) -> None:
        """Integrate trajectories (n,) to the end of their leg.

        Cells that are too long for a trajectory are halved. Where the cam's angle is no independent variable the
        trajectory is integrated by time, and not as far.
        """
        turn = np.floor(self.cam[index, None] + INSIDE)
        edges, rows = leg.edges[None], leg.own_rows
        if (self.cam[index, None] > turn + edges[:, :1] + INSIDE).any():
            edges = np.maximum(edges, self.cam[index, None] - turn)
            rows = leg.rows(edges)
        h, equation = np.diff(edges)[..., None], _ByCam(self, index, *rows)
        starts = np.empty((h.shape[1] + 1, index.size, 2))
        starts[0] = self.x[index]
        beta = np.broadcast_to(self.x[index, :1, None], equation.inertia.shape)
        momentum, before = equation.inertia, np.full(index.size, 1e-300)
        for sweep in range(SWEEPS):
            if sweep < LINEARISED:
                linear = _Linear(h, *equation.jacobian(beta, momentum))
            previous = beta
            beta, momentum = linear.solve(beta, momentum, *equation.rate(beta, momentum), starts)
            change = np.abs(beta - previous).max(axis=(1, 2))
            largest = np.maximum(self.largest[index], np.abs(beta).max(axis=(1, 2)))
            settled = change * np.minimum(change / before, 1.0) <= SETTLED * largest
            grows, before = change > before, np.maximum(change, 1e-300)
            failing = ~(change < 1.0) | (sweep > LINEARISED) & grows
            if (settled | failing).all():
                break
        rate = np.stack(equation.rate(beta, momentum), axis=2)
        forward = ((momentum > SLOWEST * equation.inertia) & (momentum <= FASTEST)).all(axis=(1, 2))
        truncation = REMAINDER * (h * np.abs(rate @ _TAIL).sum(axis=-1)).max(axis=1)
        truncation[:, 1] /= TURN * np.maximum(1.0, self.eta[index])
        is_rough = settled & forward & (truncation.max(axis=1) > TAIL * largest)
        accepted = settled & forward & ~is_rough
        if accepted.any():
            at = index[accepted]
            cell_edges = np.broadcast_to(edges + turn, (index.size, edges.shape[1]))[accepted]
            x = starts[:, accepted]
            begins = x[:-1].swapaxes(0, 1).reshape(-1, 2)
            cells = np.repeat(at, h.shape[1]), cell_edges[:, :-1].ravel(), np.diff(cell_edges).ravel(), begins
            self.cells.append(_Cells(*cells, rate[accepted].reshape(-1, 2, NODES)))
            self.x[at], self.cam[at], self.largest[at] = x[-1], cell_edges[:, -1], largest[accepted]
        halved = is_rough & (leg.halved < HALVINGS)
        if halved.any():
            self._by_cam(leg.halves(), index[halved])
        by_time = ~accepted & ~halved
        if by_time.any():
            self._by_time(index[by_time])

    def _by_input(self) -> IntegrationStep:
        """The cells as steps by the input's turn, as far as ``periods``."""
        trajectory, cam, h, x, rate = (np.concatenate([getattr(p, f.name) for p in self.cells]) for f in fields(_Cells))
        y = cam + x[:, 0]
        within_periods = (h > 0.0) & (y < self.periods)
        trajectory, cam, h, x, rate, y = (column[within_periods] for column in (trajectory, cam, h, x, rate, y))
        polynomial = h[:, None, None] * integrals(rate)
        polynomial[..., 0] += x
        slope = 2.0 * np.arange(1, NODES + 1) * polynomial[:, :1, 1:]
        length = h * (1.0 + rate[:, 0] @ _WEIGHTS)
        requested = np.minimum(length, self.periods - y)
        part = (requested / length)[:, None] * _NODES
        for _ in range(INVERSIONS):
            power = powers(2.0 * part - 1.0, NODES + 1).swapaxes(1, 2)
            beta, momentum = (polynomial @ power).swapaxes(0, 1)
            time_error = requested[:, None] * _NODES - h[:, None] * part - (beta - x[:, :1])
            part = part + time_error / (h[:, None] + (slope @ power[:, :-1])[:, 0])
        turn = np.floor(cam + INSIDE)
        piece = self.begins.searchsorted(TURN * (cam - turn + INSIDE), side="right") - 1
        current = OnPieces(self, trajectory, piece, turn)
        values = np.stack((beta, momentum), axis=-1)
        return IntegrationStep(
            trajectory, y, requested, x, current.rate(y[:, None] + requested[:, None] * _NODES, values), piece, turn
        )


class _ByCam:
    """The equation for n trajectories at nodes (n, K, s), with d, C, U (1 or n, K, s) at the nodes."""

    def __init__(
        self, equation: _TrajectorySet, index: np.ndarray, d: np.ndarray, c: np.ndarray, u: np.ndarray
    ) -> None:
        eta, q = equation.eta[index, None, None], equation.q[index, None, None]
        self.inertia, self.pull = 1.0 + q * d, TURN * q * c
        self.stiff, self.damp = 4.0 * pi * pi * eta * eta, 4.0 * pi * equation.damping * eta
        self.rest = self.damp - TURN * q * (eta * eta * u if equation.fixed else u)

    def rate(self, beta: np.ndarray, momentum: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rates dβ/dτ and dΠ/dτ."""
        slow = self.inertia / momentum
        return slow - 1.0, self.pull / slow + (self.stiff * beta + self.rest) * slow - self.damp

    def jacobian(self, beta: np.ndarray, momentum: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Derivatives of dβ/dτ by Π, and of dΠ/dτ by β and by Π."""
        slow = self.inertia / momentum
        by_speed = self.pull - (self.stiff * beta + self.rest) * slow * slow
        return -slow * slow / self.inertia, self.stiff * slow, by_speed / self.inertia


class _Linear:
    """The linear equation r_β = g_β + a Π, r_Π = g_Π + b β + e Π in cells of lengths h (1 or n, K, 1), by collocation.

    The rates r_Π of a cell are M (g_Π + b h A g_β + ...), M = (1 - h e A - h² b A a A)⁻¹.
    """

    def __init__(self, h: np.ndarray, a: np.ndarray, b: np.ndarray, e: np.ndarray) -> None:
        self.a, self.b, self.e, self.h = a, b, e, h
        along = h[..., None] * _WITHIN
        system = -(b[..., None] * along) @ (a[..., None] * along) - e[..., None] * along
        system[..., range(NODES), range(NODES)] += 1.0
        self.inverse = np.linalg.inv(system)
        # solutions from (1, 0) and (0, 1): β and Π at the nodes (2, n, K, s, 2), and at the end (n, K, 2, 2)
        by_beta, by_momentum = self._cells(np.zeros_like(a), b), self._cells(a, e)
        self.nodes, self.carry = np.empty((2, *a.shape, 2)), np.empty((*a.shape[:2], 2, 2))
        for start, solution in enumerate((by_beta, by_momentum)):
            for row in (0, 1):
                self.nodes[row, ..., start] = solution[row] + (row == start)
                self.carry[..., row, start] = solution[2 + row] + (row == start)

    def _cells(self, beta_rate: np.ndarray, momentum_rate: np.ndarray) -> tuple[np.ndarray, ...]:
        """β, Π (n, K, s) at the nodes and their gains (n, K) over the cells for given right sides, from (0, 0)."""
        p = (self.inverse @ (momentum_rate + self.b * self._integral(beta_rate))[..., None])[..., 0]
        momentum = self._integral(p)
        q = beta_rate + self.a * momentum
        return self._integral(q), momentum, (self.h * q) @ _WEIGHTS, (self.h * p) @ _WEIGHTS

    def _integral(self, rate: np.ndarray) -> np.ndarray:
        return self.h * (rate @ _WITHIN.T)

    def solve(
        self, beta: np.ndarray, momentum: np.ndarray, by_beta: np.ndarray, by_momentum: np.ndarray, starts: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Solve for β and Π (n, K, s), given the rates ``by_beta``, ``by_momentum`` at β and Π, from starts[0] (n, 2).

        The states at the cells' ends are written to starts[1:] (K, n, 2).
        """
        right_sides = by_beta - self.a * momentum, by_momentum - self.b * beta - self.e * momentum
        beta, momentum, *gains = self._cells(*right_sides)
        for row in (0, 1):
            starts[1:, :, row] = gains[row].T
        for k in range(1, starts.shape[0]):
            starts[k] += (self.carry[:, k - 1] @ starts[k - 1, ..., None])[..., 0]
        homogeneous = (self.nodes @ starts[:-1].swapaxes(0, 1)[..., None])[..., 0]
        return beta + homogeneous[0], momentum + homogeneous[1]
