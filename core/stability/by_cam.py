"""The nonlinear wind-up (13) of Kim1990 by the cam's own angle τ = y - β [turns], while the cam goes forward.

With the cam's speed v = 1 - β' = Π/D

    dβ/dτ = 1/v - 1,    dΠ/dτ = 2πQ C v + (4π²η² β + 4πζη - 2πQ U)/v - 4πζη,

in which joins stand at known angles, and d, C, U at the nodes are the same in every turn. A leg, some cells none of which
crosses a join, is solved as a whole: Gauss-Legendre collocation in each cell, by Newton's method, the cells linked by the
2 x 2 matrices that carry a state from one to the next. Where the cam all but stands still or turns back its angle is no clock:
there ``Integrator`` goes on by the input's turn.
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

TAIL = 1e-8  # of the largest |β| so far: part of the last Legendre coefficients in it; they leave out less than a tenth of that
SETTLED = 1e-12  # the same of the sweep that is not made
SWEEPS, LINEARISED = 12, 3  # most of a leg; those that linearise anew
TOGETHER = 4.0  # panels of the coefficients per cell
CELLS = 8  # most of a leg
HALVINGS = 1  # of a leg's cells, for those in whose way they are too long
SLOWEST = 0.15  # of the even speed: below, the cam's angle is no clock
BACK = 0.25  # turns of the input by which a trajectory then goes on
INVERSIONS = 5  # of Newton's method, for the cam angle at a time
LEFT = 2.0 / (2 * NODES + 1)  # of a Legendre coefficient in its integral over a step as long as 1, twice
INSIDE = 1e-11  # [turns] so near to the end of a leg it has been passed

_NODES, _WEIGHTS = gauss(NODES)
_WITHIN = integration(NODES)
_TAIL = to_legendre(NODES)[-2:].T


def follow(
    coefficients: Coefficients, eta: np.ndarray, q: np.ndarray, damping: float, start: np.ndarray | None, periods: float
) -> tuple[IntegrationStep, np.ndarray]:
    """All steps of m trajectories over y = 0 ... periods from states (m, 2) or from rest, each one's in their order, and
    whether it arrived (m,): not where the cam only spins. Raises Cancelled where the result is no longer wanted."""
    return _Following(coefficients, eta, q, damping, periods).run(start)


@frozen(eq=False)
class _Leg:
    """Cells (K,) of a turn of the cam between their edges (K + 1,) [turns]; how often they were halved."""

    panels: Panels
    edges: np.ndarray
    halved: int = 0

    def halves(self) -> _Leg:
        """With twice as many cells."""
        middle = 0.5 * (self.edges[1:] + self.edges[:-1])
        return _Leg(self.panels, np.sort(np.append(self.edges, middle)), self.halved + 1)

    def rows(self, edges: np.ndarray) -> np.ndarray:
        """d, C, U (3, n, K, NODES) at the nodes of cells between other edges (n, K + 1)."""
        nodes = edges[:, :-1, None] + np.diff(edges)[..., None] * _NODES
        return self.panels.at(TURN * nodes.ravel(), 3).reshape(3, *nodes.shape)

    @cached_property
    def own(self) -> np.ndarray:
        """Those of its own, n = 1."""
        return self.rows(self.edges[None])


@frozen(eq=False)
class _Cells:
    """N solved cells, each of one trajectory.

    cam, h  (N,) cam angle at its start and length [turns of the cam]
    x       (N, 2) β and Π at its start
    rate    (N, 2, NODES) dβ/dτ and dΠ/dτ
    """

    trajectory: np.ndarray
    cam: np.ndarray
    h: np.ndarray
    x: np.ndarray
    rate: np.ndarray


class _Following(WindUpEquation):
    """Trajectories on their way: cam angles (m,) [turns], states (m, 2), the largest |β| so far (m,)."""

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
            longest = min(wave, 1.0 if dwell else TOGETHER * float(width[first : last + 1].min()))
            edges += [*np.linspace(begin, end, max(1, int(np.ceil((end - begin) / longest - 1e-9))) + 1)[1:]]
        return [_Leg(self.panels, np.array(edges[i : i + CELLS + 1])) for i in range(0, len(edges) - 1, CELLS)]

    def run(self, start: np.ndarray | None) -> tuple[IntegrationStep, np.ndarray]:
        """See ``follow``."""
        self.x = self.resting() if start is None else np.array(start, dtype=float).reshape(-1, 2)
        self.cam, self.largest = -self.x[:, 0], np.abs(self.x[:, 0])
        done_at = self.periods - ARRIVED * (1.0 + self.periods)
        going = np.arange(self.eta.size)
        while going.size:
            checkpoint()
            rest = np.mod(self.cam[going] + INSIDE, 1.0)
            leg = np.searchsorted([each.edges[0] for each in self.legs], rest, side="right") - 1
            mine = int(leg[(self.cam + self.x[:, 0])[going].argmin()])  # the last of them says which leg is next
            self._by_cam(self.legs[mine], going[leg == mine])
            going = going[(self.cam + self.x[:, 0])[going] < done_at]  # nan is not
        if self.cells:
            self.steps.append(self._by_input())
        steps = IntegrationStep.joined(self.steps)
        return steps.only(np.lexsort((steps.y, steps.trajectory))), np.isfinite(self.cam)

    def _by_time(self, index: np.ndarray) -> None:
        """Some trajectories (n,) a little further by the input's turn."""
        integrator = Integrator(self.coefficients, self.eta[index], self.q[index], self.damping)
        y = self.cam[index] + self.x[index, 0]
        run = integrator.run(self.x[index], y, np.minimum(y + BACK, self.periods), keep=True)
        self.steps += [replace(step, trajectory=index[step.trajectory]) for step in run.steps]
        self.x[index], self.cam[index] = run.x, run.y - run.x[:, 0]
        self.largest[index] = np.fmax(self.largest[index], np.abs(run.x[:, 0]))

    @np.errstate(all="ignore")  # nan has not settled
    def _by_cam(self, leg: _Leg, index: np.ndarray) -> None:
        """Trajectories (n,) to the end of the leg in which they are. For those to which its cells are too long these are halved;
        those for which the cam's angle is no clock go by time, and not as far.
        """
        turn = np.floor(self.cam[index, None] + INSIDE)
        edges, rows = leg.edges[None], leg.own
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
            last = beta
            beta, momentum = linear.solve(beta, momentum, *equation.rate(beta, momentum), starts)
            change = np.abs(beta - last).max(axis=(1, 2))
            largest = np.maximum(self.largest[index], np.abs(beta).max(axis=(1, 2)))
            settled = change * np.minimum(change / before, 1.0) <= SETTLED * largest
            grows, before = change > before, np.maximum(change, 1e-300)
            hopeless = ~(change < 1.0) | (sweep > LINEARISED) & grows
            if (settled | hopeless).all():
                break
        rate = np.stack(equation.rate(beta, momentum), axis=2)
        forward = ((momentum > SLOWEST * equation.inertia) & (momentum <= FASTEST)).all(axis=(1, 2))
        left = LEFT * (h * np.abs(rate @ _TAIL).sum(axis=-1)).max(axis=1)
        left[:, 1] /= TURN * np.maximum(1.0, self.eta[index])
        rough = settled & forward & (left.max(axis=1) > TAIL * largest)
        good = settled & forward & ~rough
        if good.any():
            at = index[good]
            whole = np.broadcast_to(edges + turn, (index.size, edges.shape[1]))[good]
            x = starts[:, good]
            begins = x[:-1].swapaxes(0, 1).reshape(-1, 2)
            cells = np.repeat(at, h.shape[1]), whole[:, :-1].ravel(), np.diff(whole).ravel(), begins
            self.cells.append(_Cells(*cells, rate[good].reshape(-1, 2, NODES)))
            self.x[at], self.cam[at], self.largest[at] = x[-1], whole[:, -1], largest[good]
        halved = rough & (leg.halved < HALVINGS)
        if halved.any():
            self._by_cam(leg.halves(), index[halved])
        timed = ~good & ~halved
        if timed.any():
            self._by_time(index[timed])

    def _by_input(self) -> IntegrationStep:
        """The cells as steps by the input's turn, as far as ``periods``."""
        trajectory, cam, h, x, rate = (np.concatenate([getattr(p, f.name) for p in self.cells]) for f in fields(_Cells))
        y = cam + x[:, 0]
        kept = (h > 0.0) & (y < self.periods)
        trajectory, cam, h, x, rate, y = (each[kept] for each in (trajectory, cam, h, x, rate, y))
        whole = h[:, None, None] * integrals(rate)
        whole[..., 0] += x
        slope = 2.0 * np.arange(1, NODES + 1) * whole[:, :1, 1:]
        length = h * (1.0 + rate[:, 0] @ _WEIGHTS)
        asked = np.minimum(length, self.periods - y)
        part = (asked / length)[:, None] * _NODES
        for _ in range(INVERSIONS):
            power = powers(2.0 * part - 1.0, NODES + 1).swapaxes(1, 2)
            beta, momentum = (whole @ power).swapaxes(0, 1)
            late = asked[:, None] * _NODES - h[:, None] * part - (beta - x[:, :1])
            part = part + late / (h[:, None] + (slope @ power[:, :-1])[:, 0])
        turn = np.floor(cam + INSIDE)
        piece = self.begins.searchsorted(TURN * (cam - turn + INSIDE), side="right") - 1
        here = OnPieces(self, trajectory, piece, turn)
        values = np.stack((beta, momentum), axis=-1)
        return IntegrationStep(
            trajectory, y, asked, x, here.rate(y[:, None] + asked[:, None] * _NODES, values), piece, turn
        )


class _ByCam:
    """The equation for n trajectories at nodes (n, K, s), with d, C, U (1 or n, K, s) there."""

    def __init__(self, equation: _Following, index: np.ndarray, d: np.ndarray, c: np.ndarray, u: np.ndarray) -> None:
        eta, q = equation.eta[index, None, None], equation.q[index, None, None]
        self.inertia, self.pull = 1.0 + q * d, TURN * q * c
        self.stiff, self.damp = 4.0 * pi * pi * eta * eta, 4.0 * pi * equation.damping * eta
        self.rest = self.damp - TURN * q * (eta * eta * u if equation.fixed else u)

    def rate(self, beta: np.ndarray, momentum: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """dβ/dτ and dΠ/dτ."""
        slow = self.inertia / momentum
        return slow - 1.0, self.pull / slow + (self.stiff * beta + self.rest) * slow - self.damp

    def jacobian(self, beta: np.ndarray, momentum: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """dβ/dτ by Π, dΠ/dτ by β and by Π."""
        slow = self.inertia / momentum
        own = self.pull - (self.stiff * beta + self.rest) * slow * slow
        return -slow * slow / self.inertia, self.stiff * slow, own / self.inertia


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
        # from a start (1, 0) or (0, 1): β and Π at the nodes (2, n, K, s, 2), and at the end (n, K, 2, 2)
        by_beta, by_momentum = self._cells(np.zeros_like(a), b), self._cells(a, e)
        self.nodes, self.carry = np.empty((2, *a.shape, 2)), np.empty((*a.shape[:2], 2, 2))
        for start, told in enumerate((by_beta, by_momentum)):
            for row in (0, 1):
                self.nodes[row, ..., start] = told[row] + (row == start)
                self.carry[..., row, start] = told[2 + row] + (row == start)

    def _cells(self, of_beta: np.ndarray, of_momentum: np.ndarray) -> tuple[np.ndarray, ...]:
        """β, Π (n, K, s) at the nodes and what they gain (n, K) over the cells with these right sides, from (0, 0)."""
        p = (self.inverse @ (of_momentum + self.b * self._integral(of_beta))[..., None])[..., 0]
        momentum = self._integral(p)
        q = of_beta + self.a * momentum
        return self._integral(q), momentum, (self.h * q) @ _WEIGHTS, (self.h * p) @ _WEIGHTS

    def _integral(self, rate: np.ndarray) -> np.ndarray:
        return self.h * (rate @ _WITHIN.T)

    def solve(
        self, beta: np.ndarray, momentum: np.ndarray, by_beta: np.ndarray, by_momentum: np.ndarray, starts: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """β and Π (n, K, s) of the equation that has the rates ``by_beta``, ``by_momentum`` at β and Π, from starts[0] (n, 2);
        the states at the cells' ends go to starts[1:] (K, n, 2)."""
        right = by_beta - self.a * momentum, by_momentum - self.b * beta - self.e * momentum
        beta, momentum, *gains = self._cells(*right)
        for row in (0, 1):
            starts[1:, :, row] = gains[row].T
        for k in range(1, starts.shape[0]):
            starts[k] += (self.carry[:, k - 1] @ starts[k - 1, ..., None])[..., 0]
        begun = (self.nodes @ starts[:-1].swapaxes(0, 1)[..., None])[..., 0]
        return beta + begun[0], momentum + begun[1]
