"""The nonlinear equation of the wind-up marched in time.

Steps are Gauss-Legendre collocations of order 32; one that would cross a join of the motion lands on it instead, whichever
way the cam turns. Many points of the chart go side by side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from math import pi

import numpy as np

from core.cancellation import checkpoint
from core.motion import EPS, TURN
from core.stability.arrays import Arrays
from core.stability.coefficients import Coefficients, is_dwell
from core.stability.nonlinear import Equation, Points
from core.stability.panels import gauss, integrals, integration, powers

STAGES = 16
PHASE = 2.5  # [rad] of the shaft's own wave per step
PANELS = 2.0  # of the coefficients per step, about
SWEEPS = 40
SETTLED = 32.0 * EPS
ATTEMPTS = 60
LANDED = 1e-12  # [rad] from a join
LEAST = 1e-12  # of a turn: what is no farther from a join is on it ...
OUTSIDE = 1e-10  # [rad] ... and what goes on beyond it no farther than that has not passed it
ARRIVED = 16.0 * EPS  # of the time: so near its end nothing happens any more
FASTEST = 30.0  # momentum in that of an even turn: a lane beyond is lost, it only spins

Turns = float | np.ndarray

_NODES, _WEIGHTS = gauss(STAGES)
_WITH_END = np.append(_NODES, 1.0)
_WITHIN = integration(STAGES)


@dataclass(frozen=True, eq=False)
class Step(Arrays):
    """One step of some lanes.

    lane         (n,) which
    y, h         (n,) where it starts and how long it is [turns of the input]
    x            (n, 2) β and Π at its start
    rate         (n, STAGES, 2) their derivatives at the nodes of the step
    piece, turn  (n,) of the motion, and of the cam
    """

    lane: np.ndarray
    y: np.ndarray
    h: np.ndarray
    x: np.ndarray
    rate: np.ndarray
    piece: np.ndarray
    turn: np.ndarray

    @staticmethod
    def joined(parts: Sequence[Step]) -> Step:
        """All of them, in their order."""
        return Step(*(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(Step)))

    @cached_property
    def powers(self) -> np.ndarray:
        """Coefficients (n, 2, STAGES + 1) of t**k, t = -1 ... 1 over the step, of β and Π: the integrals of the polynomials
        through the derivatives at the nodes."""
        found = self.h[:, None, None] * integrals(self.rate.swapaxes(1, 2))
        found[..., 0] += self.x
        return np.asarray(found)

    def within(self, part: np.ndarray) -> np.ndarray:
        """β and Π (n, k, 2) at parts (n or 1, k) of the step, 0 ... 1; at 0 they are those of its start to the last digit."""
        inside = powers(2.0 * part - 1.0, STAGES + 1) @ self.powers.swapaxes(1, 2)
        return np.where((part == 0.0)[..., None], self.x[:, None], inside)


@dataclass(frozen=True, eq=False)
class Trajectories:
    """Where the lanes have come to.

    y, x    (L,), (L, 2): β and Π there; nan where a lane was lost
    change  (L, 2, 3) their derivatives by β and Π at the start and by η, where asked for
    steps   all steps, where kept
    """

    y: np.ndarray
    x: np.ndarray
    change: np.ndarray | None
    steps: tuple[Step, ...]


@dataclass(eq=False)
class _State:
    """Where the lanes are now, and until where they go; see ``Trajectories`` and ``Step``."""

    y: np.ndarray
    until: np.ndarray
    x: np.ndarray
    piece: np.ndarray
    turn: np.ndarray
    change: np.ndarray | None


class Integrator(Equation):
    """The equation of some points, ready to be marched."""

    def __init__(self, coefficients: Coefficients, points: Points) -> None:
        super().__init__(coefficients, points)
        panels = coefficients.panels
        width = np.where(is_dwell(panels), TURN, panels.width)
        self._widest = PANELS * np.minimum.reduceat(width, self.first) / TURN  # by piece
        self._waves = PHASE / (2.0 * pi * np.maximum(self.eta, 1e-3))

    def _longest(self, state: _State, lane: np.ndarray) -> np.ndarray:
        """The longest step (n,) [turns] that the coefficients and the shaft's wave allow."""
        return np.minimum(self._widest[state.piece[lane]], self._waves[lane])

    def run(self, start: np.ndarray, y0: Turns, y1: Turns, *, change: bool = False, keep: bool = False) -> Trajectories:
        """From states (L, 2) = (β, Π) at y0 to y1 [turns of the input], all lanes' or each one's own (L,); change: with
        their derivatives; keep: with all steps."""
        lanes = self.eta.size
        until = np.full(lanes, y1, dtype=float)
        state = _State(
            np.full(lanes, y0, dtype=float),
            until,
            np.array(start, dtype=float).reshape(lanes, 2),
            np.zeros(lanes, dtype=int),
            np.zeros(lanes, dtype=int),
            np.tile(np.eye(2, 3), (lanes, 1, 1)) if change else None,
        )
        self._place(state)
        steps: list[Step] = []
        done_at = until - ARRIVED * (1.0 + np.abs(until))
        going = np.flatnonzero(state.y < done_at)
        while going.size:
            checkpoint()
            done = self._advance(state, going)
            if keep:
                steps += done
            state.y[np.abs(state.x[:, 1]) > FASTEST] = np.nan
            going = going[state.y[going] < done_at[going]]  # nan is not
        state.x[np.isnan(state.y)] = np.nan
        state.y[:] = np.where(state.y >= done_at, until, state.y)
        return Trajectories(state.y, state.x, state.change, tuple(steps))

    def _place(self, state: _State) -> None:
        """Find the piece of each lane; where it stands on a join, that on the side it goes to."""
        theta = TURN * (state.y - state.x[:, 0])
        state.turn[:] = np.floor((theta + OUTSIDE) / TURN)
        rest = theta - TURN * state.turn
        state.piece[:] = np.clip(np.searchsorted(self.begins - OUTSIDE, rest, side="right") - 1, 0, None)
        back = np.flatnonzero((np.abs(rest - self.begins[state.piece]) <= OUTSIDE) & (state.x[:, 1] < 0.0))
        self._leave(state, back, np.full(back.size, -1))

    def _ends(self, state: _State, lane: np.ndarray) -> np.ndarray:
        """Cam angles (n, 2) where the lanes' pieces begin and end."""
        piece, full = state.piece[lane], TURN * state.turn[lane]
        return np.stack((self.begins[piece] + full, self.ends[piece] + full), axis=1)

    def _advance(self, state: _State, lane: np.ndarray) -> list[Step]:
        """One step of each lane named. A lane that does not get on is lost: nan."""
        h, aim = self._first_guess(state, lane)
        done: list[Step] = []
        for _ in range(ATTEMPTS):
            ends = self._ends(state, lane)
            trial, h, settled = self._collocate(state, lane, h, aim, ends)
            theta = TURN * (state.y[lane, None] + h[:, None] * _WITH_END - trial.within(_WITH_END[None])[..., 0])
            outside = np.where(theta > ends[:, 1:] + OUTSIDE, 1, np.where(theta < ends[:, :1] - OUTSIDE, -1, 0))
            outside[aim != 0, -1] = 0  # a landing ends on the join, whatever rounding says
            left = outside.any(axis=1)
            inside_time = (h > 0.0) & (h <= (state.until[lane] - state.y[lane]) * (1.0 + 4.0 * EPS))
            good = settled & ~left & inside_time
            if good.all():
                self._accept(state, trial, aim)
                return [*done, trial]
            if good.any():
                done.append(trial.only(good))
                self._accept(state, done[-1], aim[good])
            h, aim = _next_guess(trial, h, aim, settled & left & inside_time, theta, outside, ends)
            lane, h, aim = lane[~good], h[~good], aim[~good]
            crossing = np.flatnonzero(h < LEAST)
            if crossing.size:  # on a join and moves to the other side
                at = lane[crossing]
                theta_now = TURN * (state.y[at] - state.x[at, 0])
                near = np.abs(theta_now[:, None] - self._ends(state, at)).argmin(axis=1)
                self._leave(state, at, 2 * near - 1)
                h[crossing], aim[crossing] = self._first_guess(state, at)
        state.y[lane], state.x[lane] = np.nan, np.nan
        return done

    def _first_guess(self, state: _State, lane: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Length of the step, and whether it is to land on the end (+1) or beginning (-1) of the piece, or nowhere (0)."""
        h = np.minimum(self._longest(state, lane), state.until[lane] - state.y[lane])
        theta = TURN * (state.y[lane] - state.x[lane, 0])
        low, high = self._ends(state, lane).T
        d = self.local(1, state.piece[lane], state.turn[lane], theta[:, None])[0, :, 0]
        speed = TURN * state.x[lane, 1] / (1.0 + self.q[lane] * d)
        with np.errstate(divide="ignore", invalid="ignore"):
            needed = np.where(speed > 0.0, high - theta, low - theta) / speed
        soon = (needed > LEAST) & (needed <= 1.05 * h)
        return np.where(soon, needed, h), np.where(soon, np.where(speed > 0.0, 1, -1), 0)

    def _collocate(
        self, state: _State, lane: np.ndarray, h: np.ndarray, aim: np.ndarray, ends: np.ndarray
    ) -> tuple[Step, np.ndarray, np.ndarray]:
        """Steps of length h, or such that they land; whether each has settled (n,).

        Newton's method, simplified: with the derivatives at a first guess, in which the state moves on evenly.
        """
        piece, turn = state.piece[lane], state.turn[lane]
        y, x, n = state.y[lane], state.x[lane], lane.size
        goal = np.where(aim > 0, ends[:, 1], ends[:, 0])
        lands, any_lands = aim != 0, bool(aim.any())
        limit = 1.5 * self._longest(state, lane)
        h = y + np.clip(h, -limit, limit) - y  # so that y + h is exact: the steps add up without rounding
        rate = self.rate(lane, piece, turn, y[:, None], x[:, None]).repeat(STAGES, axis=1)
        first = x[:, None] + h[:, None, None] * (_WITHIN @ rate)
        jacobian = self.jacobian(lane, piece, turn, y[:, None] + h[:, None] * _NODES, first)[..., :2]
        solve = np.linalg.inv(self._system(h, jacobian))
        for _ in range(SWEEPS):
            values = x[:, None] + h[:, None, None] * (_WITHIN @ rate)
            residual = self.rate(lane, piece, turn, y[:, None] + h[:, None] * _NODES, values) - rate
            rate = rate + (solve @ residual.reshape(n, -1, 1)).reshape(rate.shape)
            settled = np.abs(residual).max(axis=(1, 2)) <= SETTLED * (1.0 + np.abs(rate).max(axis=(1, 2)))
            if any_lands:
                miss = goal - TURN * (y + h - x[:, 0] - h * (rate[:, :, 0] @ _WEIGHTS))
                speed = TURN * (1.0 - rate[:, -1, 0])
                moves = lands & (speed != 0.0) & (np.abs(miss) > SETTLED * (1.0 + np.abs(goal)))
                step = np.where(moves, miss / np.where(moves, speed, 1.0), 0.0)
                most = 0.5 * np.abs(h) + LEAST
                h = np.where(moves, y + np.clip(h + np.clip(step, -most, most), -limit, limit) - y, h)
                settled &= ~lands | (np.abs(miss) <= LANDED)
            if settled.all():
                break
        return Step(lane, y, h, x, rate, piece, turn), h, settled

    def _system(self, h: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
        """1 - h A ⊗ J (n, 2s, 2s) of steps h (n,) and derivatives of the rates at their nodes (n, s, 2, 2)."""
        inner = np.einsum("n,ij,nikl->nikjl", h, _WITHIN, jacobian)
        return np.asarray(np.eye(2 * STAGES) - inner.reshape(h.size, 2 * STAGES, 2 * STAGES))

    def _accept(self, state: _State, step: Step, aim: np.ndarray) -> None:
        """The lanes are at the ends of their steps."""
        lane = step.lane
        if state.change is not None:
            state.change[lane] = self._changed(step, state.change[lane])
        x = step.x + step.h[:, None] * np.einsum("s,nsk->nk", _WEIGHTS, step.rate)
        y = step.y + step.h
        landed = aim != 0
        until = state.until[lane]
        y = np.where(~landed & (y >= until * (1.0 - 4.0 * EPS)), until, y)
        state.y[lane], state.x[lane] = y, x
        self._leave(state, lane[landed], aim[landed])

    def _changed(self, step: Step, before: np.ndarray) -> np.ndarray:
        """The derivatives (n, 2, 3) at the end of a step: the same collocation for the linear equation they obey."""
        y = step.y[:, None] + step.h[:, None] * _NODES
        x = step.x[:, None] + step.h[:, None, None] * (_WITHIN @ step.rate)
        full = self.jacobian(step.lane, step.piece, step.turn, y, x)
        n = step.lane.size
        jacobian, by_eta = full[..., :2], full[..., 2]
        # (1 - h A ⊗ J) rates = J before + by_eta
        right = jacobian @ before[:, None]
        right[..., 2] += by_eta
        rates = np.linalg.solve(self._system(step.h, jacobian), right.reshape(n, 2 * STAGES, 3)).reshape(
            n, STAGES, 2, 3
        )
        return before + step.h[:, None, None] * np.einsum("s,nskl->nkl", _WEIGHTS, rates)

    def _leave(self, state: _State, lane: np.ndarray, velocity_sign: np.ndarray) -> None:
        """Put lanes into the piece after (velocity_sign +1) or before (-1) theirs; where C jumps there, so do the derivatives.

        A state that is off by δx passes the join by δτ = δβ/(1-β') later, and δx jumps by (f⁻ - f⁺) δτ.
        """
        if lane.size == 0:
            return
        old, turn, count = state.piece[lane], state.turn[lane], self.begins.size
        new, new_turn = (old + velocity_sign) % count, turn + (old + velocity_sign) // count
        if state.change is not None:
            y, x = state.y[lane, None], state.x[lane, None]
            here, there = self.rate(lane, old, turn, y, x)[:, 0], self.rate(lane, new, new_turn, y, x)[:, 0]
            speed = 1.0 - here[:, 0]
            with np.errstate(divide="ignore", invalid="ignore"):
                jump = np.where(speed != 0.0, (here[:, 1] - there[:, 1]) / speed, 0.0)
            state.change[lane, 1] += jump[:, None] * state.change[lane, 0]
        state.piece[lane], state.turn[lane] = new, new_turn


def _next_guess(
    trial: Step, h: np.ndarray, aim: np.ndarray, crossed: np.ndarray, theta: np.ndarray, outside: np.ndarray, ends: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Length and aim (n,) of the next attempt: a step that left its piece is to land where it did; any other is tried
    free and half as long."""
    first = (outside != 0).argmax(axis=1)
    at = np.arange(h.size)
    side = outside[at, first]
    before_part = np.where(first > 0, _WITH_END[first - 1], 0.0)
    start = TURN * (trial.y - trial.x[:, 0])
    before = np.where(first > 0, theta[at, first - 1], start)
    goal = np.where(side > 0, ends[:, 1], ends[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.clip((goal - before) / (theta[at, first] - before), 0.0, 1.0)
    part = before_part + np.nan_to_num(part) * (_WITH_END[first] - before_part)
    # a piece is left at once where the cam turns back on its very end: then look closer
    at_once = crossed & (first == 0) & (part <= 1e-6)
    new = np.where(crossed, np.where(at_once, _NODES[0] * h, part * h), 0.5 * np.abs(h))
    return new, np.where(crossed & ~at_once, side, 0)
