"""A wind-up followed from turn to turn: by the cam's angle where the cam goes forward, which is quick, and by the input's
turn where it all but stands still or turns back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.cancellation import checkpoint
from core.stability.coefficients import Coefficients
from core.stability.march import ARRIVED, March
from core.stability.nonlinear import Points
from core.stability.swing import Steps
from core.stability.turning import HALVINGS, Turning

BACK = 0.25  # turns of the input by which a lane goes on where the cam's angle is no clock


def follow(
    coefficients: Coefficients, points: Points, start: np.ndarray | None, periods: float, error: float
) -> tuple[Steps, np.ndarray]:
    """All steps of lanes (L,) from states (L, 2) = (β, Π) or from rest, and where they end (L,) [turns of the input]."""
    return _Following(coefficients, points, periods, error).run(start)


class _Following:
    def __init__(self, coefficients: Coefficients, points: Points, periods: float, error: float) -> None:
        self._turning = Turning(coefficients, points, error, periods)
        self._periods, self._done_at = periods, periods - ARRIVED * (1.0 + periods)
        self._steps: list[Steps] = []

    def run(self, start: np.ndarray | None) -> tuple[Steps, np.ndarray]:
        turning = self._turning
        lanes, nothing = np.arange(turning.eta.size), np.zeros(turning.eta.size)
        states = turning.resting() if start is None else np.array(start, dtype=float).reshape(lanes.size, 2)
        self._place = turning.place(lanes, nothing, states, nothing)
        going = lanes
        while going.size:
            checkpoint()
            # the one that is behind says which leg is next, and all that stand in it go along
            leg = turning.leg_of(self._place.cam[going])
            mine = leg[self._place.y[going].argmin()]
            self._by_time(self._by_cam(int(mine), going[leg == mine]))
            going = going[self._place.y[going] < self._done_at]  # nan is not
        steps = Steps.joined(self._steps)
        ended = np.full(lanes.size, float(self._periods))
        for lane in np.flatnonzero(np.isnan(self._place.y)):
            last = np.flatnonzero(steps.lane == lane)[-1]
            ended[lane] = steps.y[last] + steps.h[last]
        return steps, ended

    def _by_cam(self, index: int, lane: np.ndarray) -> np.ndarray:
        """The lanes to the end of their leg; the ones among them for which the cam's angle is no clock. For those that are
        not fine yet the leg is made so, and they are left where they are."""
        turning, leg = self._turning, self._turning.legs[index]
        solved = turning.solve(leg, lane, self._place.only(lane))
        rough = ~solved.fine & (leg.halved < HALVINGS)
        good = solved.settled & ~solved.slow & ~rough
        alone = ~solved.settled & (leg.edges.size == 2)
        if (~solved.settled & ~solved.slow & ~alone).any():
            turning.legs[index : index + 1] = leg.split()
        elif (rough & ~solved.slow & ~alone).any():
            turning.legs[index] = leg.halves()
        steps, place = solved.only(good)
        self._place.put(lane[good], place)
        self._keep(steps)
        return lane[solved.slow | alone]

    def _by_time(self, lane: np.ndarray) -> None:
        """The lanes a little way by the input's turn."""
        if lane.size == 0:
            return
        turning, place = self._turning, self._place.only(lane)
        march = March(turning.coefficients, Points(turning.eta[lane], turning.q[lane], turning.damping))
        gone = march.run(turning.states(lane, place), place.y, np.minimum(place.y + BACK, self._periods), keep=True)
        for step in gone.steps:
            self._keep(turning.from_march(replace(step, lane=lane[step.lane])))
        self._place.put(lane, turning.place(lane, gone.y, gone.x, place.largest))

    def _keep(self, steps: Steps) -> None:
        """As far as is asked for; what has no length is no step."""
        over = self._periods - self._done_at
        asked = (steps.length > 0.0) & (steps.y < self._done_at)
        beyond = asked & (steps.by_cam > 0.0) & (steps.y + steps.h > self._periods + over)
        self._steps.append(steps.only(np.flatnonzero(asked & ~beyond)))
        if beyond.any():
            last = steps.only(np.flatnonzero(beyond))
            self._steps.append(last.cut(self._turning.swing.only(last.lane), self._periods - last.y))
