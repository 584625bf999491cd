"""Integration of the nonlinear wind-up (13) of Kim1990, in the states (β, Π), over the input's turn y.

Gauss-Legendre collocation with s = 16 stages, order 2s, solved by a simplified Newton method (Hairer, Nørsett, Wanner:
Solving Ordinary Differential Equations II, IV.5 and IV.8). The collocation polynomial of each step is the dense output.
The coefficients of the equation may jump where two pieces of the motion join; a step that would cross a join is
shortened until it ends on the join, in either sense of rotation. m points of the chart are integrated in parallel,
arrays (m, ...).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from math import pi

import numpy as np

from core.frozen import frozen
from core.motion import EPS, TURN
from core.numerics.lazy import checkpoint
from core.numerics.roots import gauss
from core.stability.coefficients import Coefficients, is_dwell
from core.stability.panels import NODES, integrals, integration, powers

# -- equation (13) of Kim1990 with the sign of its η² term corrected -----------------------------------------------

FAR = 3.0  # [half widths of a panel] limit of extrapolation: a step that goes so far fails, and must not overflow

Numbers = float | np.ndarray


class WindUpEquation:
    """Equation (13) at m points of the chart.

    Attributes
    ----------
    eta, q : ndarray (m,), dimensionless
    damping : float
        Damping ratio.
    begins, ends : ndarray (pieces,) [rad]
        Cam angles of the motion's pieces.
    """

    def __init__(self, coefficients: Coefficients, eta: Numbers, q: Numbers, damping: float = 0.0) -> None:
        panels = coefficients.panels
        self.panels, self.fixed, self.damping = panels, coefficients.fixed, damping
        # the panels of a piece are consecutive
        self.first = np.flatnonzero(np.diff(panels.piece, prepend=-1))
        self.last = np.append(self.first[1:], panels.count) - 1
        self.begins = panels.start[self.first]
        self.ends = np.append(self.begins[1:], TURN)
        self.eta, self.q = np.broadcast_arrays(np.atleast_1d(eta).astype(float), np.atleast_1d(q).astype(float))

    def resting(self) -> np.ndarray:
        """States of β = β' = 0 at y = 0, where Π = D.

        Returns
        -------
        ndarray (m, 2) [turns], dimensionless
            β in turns, Π without unit.
        """
        d = self.panels.at(np.zeros(1), 1)[0, 0]
        return np.stack((np.zeros(self.eta.size), 1.0 + self.q * d), axis=1)


class OnPieces:
    """Equation (13) for n trajectories, each on a piece of the motion with polynomials extrapolated beyond its ends.

    Attributes
    ----------
    index : ndarray (n,) of int
        Points of the chart.
    piece, turn : ndarray (n,) of int
        Piece of the motion and full turns of the cam.
    begin, end : ndarray (n, 1) [rad]
        Cam angles at which the piece begins and ends.
    """

    def __init__(self, equation: WindUpEquation, index: np.ndarray, piece: np.ndarray, turn: np.ndarray) -> None:
        self.equation, self.index, self.piece, self.turn = equation, index, piece, turn
        self._panels, self._per_width = equation.panels, 2.0 / equation.panels.width
        self._full = TURN * turn[:, None]
        self.begin, self.end = equation.begins[piece, None] + self._full, equation.ends[piece, None] + self._full
        self._first, self._last = equation.first[piece, None], equation.last[piece, None]
        self._eta, self._q = equation.eta[index, None], equation.q[index, None]
        self._stiff, self._damp = 4.0 * pi * pi * self._eta**2, 4.0 * pi * equation.damping * self._eta
        self._pull, self._load = TURN * self._q, TURN * self._q * (self._eta**2 if equation.fixed else 1.0)

    def _local(self, rows: int, theta: np.ndarray) -> np.ndarray:
        """The first ``rows`` of d, C, U, κ, ψ (rows, n, s) at cam angles (n, s) [rad]."""
        rest = theta - self._full
        at = self._panels.start.searchsorted(rest, side="right") - 1
        at = np.minimum(np.maximum(at, self._first), self._last)
        t = (rest - self._panels.start[at]) * self._per_width[at] - 1.0
        t = np.minimum(np.maximum(t, -FAR), FAR)
        return np.einsum("nsrk,nsk->rns", self._panels.powers[at, :rows], powers(t, NODES))

    def rate(self, y: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Derivatives β' and Π' of the states, by (13).

        Parameters
        ----------
        y : ndarray (n, s) [turns of the input]
            s times for each of n trajectories.
        x : ndarray (n, s, 2) [turns], dimensionless
            States (β, Π).

        Returns
        -------
        ndarray (n, s, 2), dimensionless
            β' in turns per turn, Π' per turn.

        References
        ----------
        Kim (1990), eq. (13), with the sign of its η² term corrected.
        """
        return self._rate(x, *self._local(3, TURN * (y - x[..., 0])))

    def _rate(self, x: np.ndarray, d: np.ndarray, c: np.ndarray, u: np.ndarray) -> np.ndarray:
        speed = x[..., 1] / (1.0 + self._q * d)
        out = np.empty_like(x)
        out[..., 0] = 1.0 - speed
        out[..., 1] = (
            self._pull * c * speed * speed - self._load * u + self._stiff * x[..., 0] + self._damp * out[..., 0]
        )
        return out

    def velocities(self, y: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First and second derivative of the wind-up, by (13).

        Parameters
        ----------
        y : ndarray (n, s) [turns of the input]
        x : ndarray (n, s, 2) [turns], dimensionless
            States (β, Π).

        Returns
        -------
        rate, acceleration : ndarray (n, s), dimensionless
            β' and β''.
        """
        d, c, u = self._local(3, TURN * (y - x[..., 0]))
        inertia = 1.0 + self._q * d
        speed = x[..., 1] / inertia
        force = self._pull * c * speed * speed + self._load * u - self._stiff * x[..., 0]
        return 1.0 - speed, (force - self._damp * (1.0 - speed)) / inertia

    def rate_and_jacobian(self, y: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of the states, and the derivatives of these by β, Π and η.

        Parameters
        ----------
        y : ndarray (n, s) [turns of the input]
        x : ndarray (n, s, 2) [turns], dimensionless
            States (β, Π).

        Returns
        -------
        rate : ndarray (n, s, 2), dimensionless
            β' and Π'.
        jacobian : ndarray (n, s, 2, 3), dimensionless
            Last axis: by β, Π and η.
        """
        d, c, u, k, u1 = self._local(5, TURN * (y - x[..., 0]))
        inertia = 1.0 + self._q * d
        speed = x[..., 1] / inertia
        by_theta = -2.0 * self._q * c * speed / inertia  # of the speed
        force = self._pull * (k * speed * speed + 2.0 * c * speed * by_theta) - self._load * u1 - self._damp * by_theta
        out = np.zeros((*x.shape, 3))
        out[..., 0, 0] = TURN * by_theta
        out[..., 0, 1] = -1.0 / inertia
        out[..., 1, 0] = -TURN * force + self._stiff
        out[..., 1, 1] = (2.0 * self._pull * c * speed - self._damp) / inertia
        out[..., 1, 2] = 2.0 * TURN * TURN * self._eta * x[..., 0] + 2.0 * TURN * self.equation.damping * (1.0 - speed)
        if self.equation.fixed:
            out[..., 1, 2] -= 2.0 * self._pull * self._eta * u
        return self._rate(x, d, c, u), out


# -- integration -------------------------------------------------------------------------------------------------

STAGES = 16
PHASE = 3.5  # [rad] longest step, in the phase of the shaft's own vibration
PANELS = 2.0  # longest step, in panels of the coefficients
SWEEPS = 16  # most Newton iterations of a step
SETTLED = 32.0 * EPS  # residual of a stage at which the iteration ends, relative to 1 + the largest rate
ATTEMPTS = 60  # most lengths tried for a step
LANDED = 1e-12  # [rad] largest distance from a join at which a step ends on it
LEAST = 1e-12  # [turns] shortest step: below it the state is on the join
OUTSIDE = 1e-10  # [rad] distance beyond a join that still counts as its piece
ARRIVED = 16.0 * EPS  # relative distance from the end of the integration that is neglected
FASTEST = 30.0  # largest |Π|, which is 1 in even rotation: beyond it the cam only spins and the integration ends

Turns = float | np.ndarray

_NODES, _WEIGHTS = gauss(STAGES)
_NODES_AND_ENDS = np.concatenate(([0.0], _NODES, [1.0]))  # start, nodes, end of a step
_WITHIN = integration(STAGES)
_TO_NODES = np.vstack(
    (np.zeros(STAGES), _WITHIN, _WEIGHTS)
)  # from the rates at the nodes to their integrals up to there


@frozen(eq=False)
class IntegrationStep:
    """n steps, each of one trajectory.

    Attributes
    ----------
    trajectory : ndarray (n,) of int
        Index of the trajectory.
    y, h : ndarray (n,) [turns of the input]
        Start and length.
    x : ndarray (n, 2) [turns], dimensionless
        β and Π at the start.
    rate : ndarray (n, STAGES, 2), dimensionless
        dβ/dy and dΠ/dy at the nodes.
    piece, turn : ndarray (n,) of int
        Piece of the motion and full turns of the cam that contain the step.
    """

    trajectory: np.ndarray
    y: np.ndarray
    h: np.ndarray
    x: np.ndarray
    rate: np.ndarray
    piece: np.ndarray
    turn: np.ndarray

    @staticmethod
    def joined(parts: Sequence[IntegrationStep]) -> IntegrationStep:
        """Steps of all parts in their order."""
        return IntegrationStep(
            *(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(IntegrationStep))
        )

    def select(self, index: np.ndarray) -> IntegrationStep:
        """Return some of the steps.

        Parameters
        ----------
        index : ndarray (k,), dimensionless
            Indices of steps, or a mask (n,).

        Returns
        -------
        IntegrationStep
        """
        return IntegrationStep(*(getattr(self, f.name)[index] for f in fields(self)))

    @cached_property
    def powers(self) -> np.ndarray:
        """Coefficients (n, 2, STAGES + 1) of t**k, t = -1 ... 1 over the step, of β [turns] and Π, dimensionless."""
        result = self.h[:, None, None] * integrals(self.rate.swapaxes(1, 2))
        result[..., 0] += self.x
        return np.asarray(result)

    def within(self, part: np.ndarray) -> np.ndarray:
        """States at fractions of the steps; at 0 exactly the states of the start.

        Parameters
        ----------
        part : ndarray (n, k), dimensionless
            Fractions 0 ... 1 of the steps; (1, k) for the same fractions of every step.

        Returns
        -------
        ndarray (n, k, 2) [turns], dimensionless
            β and Π.
        """
        inside = powers(2.0 * part - 1.0, STAGES + 1) @ self.powers.swapaxes(1, 2)
        return np.where((part == 0.0)[..., None], self.x[:, None], inside)

    def at_nodes(self) -> tuple[np.ndarray, np.ndarray]:
        """Times and states at the start, at the nodes and at the end of the steps.

        Returns
        -------
        y : ndarray (n, STAGES + 2) [turns of the input]
        x : ndarray (n, STAGES + 2, 2) [turns], dimensionless
            β and Π.
        """
        h = self.h[:, None]
        return self.y[:, None] + h * _NODES_AND_ENDS, self.x[:, None] + h[..., None] * (_TO_NODES @ self.rate)


@frozen(eq=False)
class Trajectories:
    """Ends of m trajectories.

    Attributes
    ----------
    y : ndarray (m,) [turns of the input]
        Their ends; NaN where the integration failed or |Π| exceeded FASTEST.
    x : ndarray (m, 2) [turns], dimensionless
        β and Π at the end, NaN as y.
    change : ndarray (m, 2, 3), dimensionless, or None
        Derivatives of x by β and Π at the start and by η, where requested.
    steps : tuple of IntegrationStep
        All steps in the order of their integration, where requested; else empty.
    """

    y: np.ndarray
    x: np.ndarray
    change: np.ndarray | None
    steps: tuple[IntegrationStep, ...]


@dataclass(eq=False)
class _State:
    """Integration state of m parallel trajectories, arrays (m, ...); see ``Trajectories`` and ``IntegrationStep``."""

    y: np.ndarray
    until: np.ndarray
    x: np.ndarray
    piece: np.ndarray
    turn: np.ndarray
    change: np.ndarray | None


class Integrator(WindUpEquation):
    """Integrator of equation (13) for m points of the chart."""

    def __init__(self, coefficients: Coefficients, eta: Turns, q: Turns, damping: float = 0.0) -> None:
        super().__init__(coefficients, eta, q, damping)
        panels = coefficients.panels
        width = np.where(is_dwell(panels), TURN, panels.width)
        self._widest = PANELS * np.minimum.reduceat(width, self.first) / TURN  # by piece
        self._waves = PHASE / (2.0 * pi * np.maximum(self.eta, 1e-3))

    def run(self, start: np.ndarray, y0: Turns, y1: Turns, *, change: bool = False, keep: bool = False) -> Trajectories:
        """Integrate trajectories from y0 to y1.

        Parameters
        ----------
        start : ndarray (m, 2) [turns], dimensionless
            States (β, Π) at y0.
        y0, y1 : float or ndarray (m,) [turns of the input]
        change : bool
            Also compute the derivatives of the end states.
        keep : bool
            Also return all steps.

        Returns
        -------
        Trajectories

        Raises
        ------
        Cancelled
            Where the calculation is cancelled.
        """
        count = self.eta.size
        until = np.full(count, y1, dtype=float)
        state = _State(
            np.full(count, y0, dtype=float),
            until,
            np.array(start, dtype=float).reshape(count, 2),
            np.zeros(count, dtype=int),
            np.zeros(count, dtype=int),
            np.tile(np.eye(2, 3), (count, 1, 1)) if change else None,
        )
        self._find_piece(state)
        steps: list[IntegrationStep] = []
        final_y = until - ARRIVED * (1.0 + np.abs(until))
        active = np.flatnonzero(state.y < final_y)
        while active.size:
            checkpoint()
            new_steps = self._advance(state, active)
            if keep:
                steps += new_steps
            state.y[np.abs(state.x[:, 1]) > FASTEST] = np.nan
            active = active[state.y[active] < final_y[active]]  # nan is not
        state.x[np.isnan(state.y)] = np.nan
        state.y[:] = np.where(state.y >= final_y, until, state.y)
        return Trajectories(state.y, state.x, state.change, tuple(steps))

    def _find_piece(self, state: _State) -> None:
        """Find the piece of each trajectory; on a join, the piece that it enters."""
        theta = TURN * (state.y - state.x[:, 0])
        state.turn[:] = np.floor((theta + OUTSIDE) / TURN)
        cam_angle = theta - TURN * state.turn
        state.piece[:] = np.clip(np.searchsorted(self.begins - OUTSIDE, cam_angle, side="right") - 1, 0, None)
        reversing = np.flatnonzero((np.abs(cam_angle - self.begins[state.piece]) <= OUTSIDE) & (state.x[:, 1] < 0.0))
        self._leave(state, reversing, np.full(reversing.size, -1))

    def _on(self, state: _State, index: np.ndarray) -> OnPieces:
        """Equation of trajectories (n,) on their current pieces."""
        return OnPieces(self, index, state.piece[index], state.turn[index])

    def _advance(self, state: _State, index: np.ndarray) -> list[IntegrationStep]:
        """One step of each trajectory (n,). Where no length succeeds its y and x become NaN."""
        current = self._on(state, index)
        rate, h, target = self._first_guess(state, current)
        accepted: list[IntegrationStep] = []
        for _ in range(ATTEMPTS):
            trial, settled = self._collocate(state, current, h, target, rate)
            h, (y, x) = trial.h, trial.at_nodes()
            theta = TURN * (y - x[..., 0])
            outside = np.where(theta > current.end + OUTSIDE, 1, np.where(theta < current.begin - OUTSIDE, -1, 0))
            outside[:, 0] = 0
            outside[target != 0, -1] = 0  # a landing ends on the join, whatever rounding says
            possible = settled & (h > 0.0) & (h <= (state.until[current.index] - trial.y) * (1.0 + 4.0 * EPS))
            good = possible & ~outside.any(axis=1)
            if good.all():
                self._accept(state, trial, x[:, -1], target)
                return [*accepted, trial]
            if good.any():
                accepted.append(trial.select(good))
                self._accept(state, accepted[-1], x[good, -1], target[good])
            h, target = _next_guess(current, h, possible, theta, outside)
            current, rate, h, target = self._on(state, current.index[~good]), rate[~good], h[~good], target[~good]
            crossing = np.flatnonzero(h < LEAST)
            if crossing.size:  # on a join and moves to the other side
                at = current.index[crossing]
                theta_now = TURN * (state.y[at, None] - state.x[at, :1])
                before = np.abs(theta_now - current.begin[crossing]) <= np.abs(theta_now - current.end[crossing])
                self._leave(state, at, np.where(before[:, 0], -1, 1))
                current = self._on(state, current.index)
                rate[crossing], h[crossing], target[crossing] = self._first_guess(state, self._on(state, at))
        state.y[current.index], state.x[current.index] = np.nan, np.nan
        return accepted

    def _first_guess(self, state: _State, current: OnPieces) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """First attempt at the next step: rates (n, 1, 2) at its start, its length (n,) and its target.

        The target is the end (+1) or the beginning (-1) of the piece, or none (0).
        """
        y, x = state.y[current.index, None], state.x[current.index, None]
        rate = current.rate(y, x)
        h = np.minimum(self._longest(current), state.until[current.index] - y[:, 0])
        theta, speed = TURN * (y - x[..., 0]), TURN * (1.0 - rate[..., 0])
        with np.errstate(divide="ignore", invalid="ignore"):
            time_to_join = (np.where(speed > 0.0, current.end - theta, current.begin - theta) / speed)[:, 0]
        is_near = (time_to_join > LEAST) & (time_to_join <= 1.05 * h)
        return rate, np.where(is_near, time_to_join, h), np.where(is_near, np.where(speed[:, 0] > 0.0, 1, -1), 0)

    def _longest(self, current: OnPieces) -> np.ndarray:
        """Longest step (n,) [turns] that the coefficients and the shaft's wave allow."""
        return np.minimum(self._widest[current.piece], self._waves[current.index])

    def _collocate(
        self, state: _State, current: OnPieces, h: np.ndarray, target: np.ndarray, rate: np.ndarray
    ) -> tuple[IntegrationStep, np.ndarray]:
        """Steps of length h (n,), or of such a length that they end at their target, and whether each converged (n,).

        Newton's method with the derivatives at the first guess, a straight line from the start with its rates (n, 1,
        2). The
        length of a step with a target is part of the same iteration, by Newton's method for the cam angle at its end.
        """
        y, x, n = state.y[current.index], state.x[current.index], h.size
        lands, limit = target != 0, 1.5 * self._longest(current)
        target_angle = np.where(target > 0, current.end[:, 0], current.begin[:, 0]) if lands.any() else None
        h = y + np.clip(h, -limit, limit) - y  # so that y + h is exact: the steps add up without rounding
        rate = rate.repeat(STAGES, axis=1)
        solve = None
        for _ in range(SWEEPS):
            times, values = y[:, None] + h[:, None] * _NODES, x[:, None] + h[:, None, None] * (_WITHIN @ rate)
            if solve is None:
                new_rate, jacobian = current.rate_and_jacobian(times, values)
                solve = np.linalg.inv(_system(h, jacobian[..., :2]))
            else:
                new_rate = current.rate(times, values)
            residual = new_rate - rate
            rate = rate + (solve @ residual.reshape(n, -1, 1)).reshape(rate.shape)
            settled = np.abs(residual).max(axis=(1, 2)) <= SETTLED * (1.0 + np.abs(rate).max(axis=(1, 2)))
            if target_angle is not None:
                angle_error = target_angle - TURN * (y + h - x[:, 0] - h * (rate[:, :, 0] @ _WEIGHTS))
                speed = TURN * (1.0 - rate[:, -1, 0])
                moves = lands & (speed != 0.0) & (np.abs(angle_error) > SETTLED * (1.0 + np.abs(target_angle)))
                step = np.where(moves, angle_error / np.where(moves, speed, 1.0), 0.0)
                most = 0.5 * np.abs(h) + LEAST
                h = np.where(moves, y + np.clip(h + np.clip(step, -most, most), -limit, limit) - y, h)
                settled &= ~lands | (np.abs(angle_error) <= LANDED)
            if settled.all():
                break
        return IntegrationStep(current.index, y, h, x, rate, current.piece, current.turn), settled

    def _accept(self, state: _State, step: IntegrationStep, x: np.ndarray, target: np.ndarray) -> None:
        """Move the trajectories to the ends x (n, 2) of their steps."""
        index, is_landed = step.trajectory, target != 0
        if state.change is not None:
            state.change[index] = self._changed_derivatives(step, state.change[index])
        y, until = step.y + step.h, state.until[index]
        state.y[index] = np.where(~is_landed & (y >= until * (1.0 - 4.0 * EPS)), until, y)
        state.x[index] = x
        self._leave(state, index[is_landed], target[is_landed])

    def _changed_derivatives(self, step: IntegrationStep, before: np.ndarray) -> np.ndarray:
        """Derivatives (n, 2, 3) of the state at the steps' ends: the same collocation of the variational equation."""
        y, x = step.at_nodes()
        current = OnPieces(self, step.trajectory, step.piece, step.turn)
        _, full = current.rate_and_jacobian(y[:, 1:-1], x[:, 1:-1])
        n = step.trajectory.size
        jacobian, by_eta = full[..., :2], full[..., 2]
        # (1 - h A ⊗ J) rates = J before + by_eta
        right = jacobian @ before[:, None]
        right[..., 2] += by_eta
        rates = np.linalg.solve(_system(step.h, jacobian), right.reshape(n, 2 * STAGES, 3)).reshape(n, STAGES, 2, 3)
        return before + step.h[:, None, None] * np.einsum("s,nskl->nkl", _WEIGHTS, rates)

    def _leave(self, state: _State, index: np.ndarray, velocity_sign: np.ndarray) -> None:
        """Move trajectories into the piece after (velocity_sign +1) or before (-1) the current one.

        Where C jumps at the join the derivatives jump too: a state that differs by δx passes the join later by
        δτ = δβ/(1-β'), and δx changes by (f⁻ - f⁺) δτ, f the rates on both sides.
        """
        if index.size == 0:
            return
        old, turn, count = state.piece[index], state.turn[index], self.begins.size
        new, new_turn = (old + velocity_sign) % count, turn + (old + velocity_sign) // count
        if state.change is not None:
            y, x = state.y[index, None], state.x[index, None]
            before, after = (OnPieces(self, index, *side).rate(y, x)[:, 0] for side in ((old, turn), (new, new_turn)))
            speed = 1.0 - before[:, 0]
            with np.errstate(divide="ignore", invalid="ignore"):
                jump = np.where(speed != 0.0, (before[:, 1] - after[:, 1]) / speed, 0.0)
            state.change[index, 1] += jump[:, None] * state.change[index, 0]
        state.piece[index], state.turn[index] = new, new_turn


def _system(h: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
    """Matrix 1 - h A ⊗ J (n, 2s, 2s) of steps h (n,) with derivatives of the rates at their nodes (n, s, 2, 2)."""
    inner = np.einsum("n,ij,nikl->nikjl", h, _WITHIN, jacobian)
    return np.asarray(np.eye(2 * STAGES) - inner.reshape(h.size, 2 * STAGES, 2 * STAGES))


def _next_guess(
    current: OnPieces, h: np.ndarray, possible: np.ndarray, theta: np.ndarray, outside: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Length and target (n,) of the next attempt.

    A step that converged but left its piece ends on the join it crossed; any other has no target and half the length.
    """
    first, at = (outside != 0).argmax(axis=1), np.arange(h.size)
    side, crossed = outside[at, first], possible & (first > 0)
    target_angle = np.where(side > 0, current.end[:, 0], current.begin[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.clip((target_angle - theta[at, first - 1]) / (theta[at, first] - theta[at, first - 1]), 0.0, 1.0)
    part = _NODES_AND_ENDS[first - 1] + np.nan_to_num(part) * (_NODES_AND_ENDS[first] - _NODES_AND_ENDS[first - 1])
    # it leaves the piece before the first node: the cam reverses at the end of the piece, so the step is shortened
    crosses_at_start = crossed & (first == 1) & (part <= 1e-6)
    new = np.where(crossed, np.where(crosses_at_start, _NODES[0], part) * h, 0.5 * np.abs(h))
    return new, np.where(crossed & ~crosses_at_start, side, 0)
