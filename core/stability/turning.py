"""The nonlinear wind-up followed by the cam's own angle, while the cam goes forward: joins are passed exactly, and what the
train does is known beforehand at every node.

A leg of the turn is solved as a whole: cells, none across a join, with Gauss-Legendre nodes; the amplitude A of the shaft's
swing (see ``swing``) is the integral of what the train adds to it, and Picard's sweeps find it, for no more than the train's
share is left to them. Where the cam all but stands still its angle is no clock: ``march`` goes on by the input's turn.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from math import pi

import numpy as np

from core.motion import EPS, TURN
from core.stability.coefficients import Coefficients, still
from core.stability.march import Step
from core.stability.nonlinear import Equation, Points
from core.stability.panels import NODES, Panels, gauss, integration, to_legendre
from core.stability.swing import INVERSIONS, Steps, Swing

PANELS = 2.0  # of the coefficients per cell at full accuracy
FULL = 1e-13
PHASE = 2.0  # [rad] of the shaft's own wave per cell, so that its looks miss nothing
LEG = 4.5  # [rad] of it per leg
WIDEST = 0.5  # [turns] of a leg
SWEEPS = 30
HALVINGS = 3  # of the cells of a leg
SLOWEST = 0.2  # of the even speed: below, the cam's angle is no clock
SHARE = 0.25  # of the wanted error that each source of it may use
ROUNDINGS = 32.0  # of a step by the input's turn
INSIDE = 1e-10 / TURN  # [turns] what is no farther from the end of a leg has passed it

_NODES, _WEIGHTS = gauss(NODES)
_WITHIN = integration(NODES).T
_TAIL = to_legendre(NODES)[-2:].T


@dataclass(eq=False)
class Leg:
    """A part of the turn in cells (K,): edges (K + 1,) [turns of the cam]."""

    panels: Panels
    edges: np.ndarray
    halved: int = 0

    def halves(self) -> Leg:
        middle = 0.5 * (self.edges[1:] + self.edges[:-1])
        return Leg(self.panels, np.sort(np.append(self.edges, middle)), self.halved + 1)

    def split(self) -> tuple[Leg, Leg]:
        at = self.edges.size // 2
        return Leg(self.panels, self.edges[: at + 1], self.halved), Leg(self.panels, self.edges[at:], self.halved)

    def nodes(self, edges: np.ndarray) -> np.ndarray:
        """The same cells' nodes (..., K, NODES) between other edges (..., K + 1)."""
        return edges[..., :-1, None] + np.diff(edges)[..., None] * _NODES

    def rows(self, edges: np.ndarray) -> np.ndarray:
        """d, C, U there."""
        place = self.nodes(edges)
        return self.panels.at(TURN * place.ravel(), 3).reshape(3, *place.shape)

    @cached_property
    def own(self) -> np.ndarray:
        return self.rows(self.edges[None])


@dataclass(eq=False)
class Place:
    """Where lanes (L,) are: y, cam angle within the turn [turns], pointer, largest |β| so far."""

    y: np.ndarray
    cam: np.ndarray
    pointer: np.ndarray
    largest: np.ndarray

    def only(self, at: np.ndarray) -> Place:
        return Place(*(getattr(self, f.name)[at] for f in fields(self)))

    def put(self, at: np.ndarray, there: Place) -> None:
        for f in fields(self):
            getattr(self, f.name)[at] = getattr(there, f.name)


@dataclass(frozen=True, eq=False)
class Solved:
    """A leg of some lanes (n,).

    steps    its cells, lane by lane
    place    of the lanes at its end
    settled  (n,) the sweeps have found it
    slow     (n,) the cam all but stands still in it
    fine     (n,) its cells are short enough for the wanted error
    """

    steps: Steps
    place: Place
    settled: np.ndarray
    slow: np.ndarray
    fine: np.ndarray

    def only(self, which: np.ndarray) -> tuple[Steps, Place]:
        """Steps and place of some lanes (n,) bool."""
        cells = self.steps.lane.size // which.size
        return self.steps.only(np.repeat(which, cells)), self.place.only(which)


@dataclass(frozen=True, eq=False)
class _Train:
    """Q d/D, 2πQ C/D, 2πQ U/D, 2a and 4π²η² of some lanes: of what n is made."""

    heavy: np.ndarray
    pull: np.ndarray
    load: np.ndarray
    drag: np.ndarray
    stiff: np.ndarray

    def added(self, beta: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """n = (2πQ (C (1-β')² + U) + Q d (2a β' + 4π²η² β)) / D."""
        speed = 1.0 - rate
        return self.pull * speed * speed + self.load + self.heavy * (self.drag * rate + self.stiff * beta)


class Turning(Equation):
    """The equation of some points, ready to be followed by the cam's angle to a wanted error of β, relative to the largest."""

    def __init__(self, coefficients: Coefficients, points: Points, error: float, periods: float) -> None:
        super().__init__(coefficients, points)
        self.swing = Swing.of(self.eta, self.damping)
        self.error, self.periods = error, periods
        self.legs = self._first_legs()

    # -- cells and legs ---------------------------------------------------------------------------------

    def _first_legs(self) -> list[Leg]:
        """Cells of some panels each, narrower where the fastest wave asks for it, gathered to legs."""
        panels, fastest = self.coefficients.panels, 2.0 * pi * float(self.eta.max())
        together = max(1, round(PANELS * (self.error / FULL) ** (1.0 / NODES)))
        edges = [0.0]
        for first, last in zip(self.first, self.last, strict=True):
            resting = still(panels)[first : last + 1].all()
            marks = panels.start[first : last + 1 : last + 1 - first if resting else together] / TURN
            for low, high in zip(marks, [*marks[1:], (panels.start[last] + panels.width[last]) / TURN], strict=True):
                parts = max(1, int(np.ceil(fastest * (high - low) / PHASE)))
                edges += [*np.linspace(low, high, parts + 1)[1:]]
        edges[-1] = 1.0
        legs, begin = [], 0
        for i in range(1, len(edges)):
            reach = edges[min(i + 1, len(edges) - 1)] - edges[begin]
            if i + 1 == len(edges) or fastest * reach > LEG or reach > WIDEST + INSIDE:
                legs.append(Leg(panels, np.array(edges[begin : i + 1])))
                begin = i
        return legs

    # -- states -----------------------------------------------------------------------------------------

    def place(self, lane: np.ndarray, y: np.ndarray, state: np.ndarray, largest: np.ndarray) -> Place:
        """Where lanes (n,) with states (n, 2) = (β, Π) stand."""
        beta, momentum = state.T
        cam = np.mod(y - beta, 1.0)
        cam = np.where(cam + INSIDE >= 1.0, 0.0, cam)
        begins = self._begins
        near = np.searchsorted(begins, cam + INSIDE, side="right") - 1
        cam = np.maximum(cam, begins[near])
        rate = 1.0 - momentum / self._inertia(lane, cam)
        return Place(y, cam, self.swing.only(lane).pointer(beta, rate), np.maximum(largest, np.abs(beta)))

    def states(self, lane: np.ndarray, place: Place) -> np.ndarray:
        """The states (n, 2) of lanes (n,)."""
        beta, rate = self.swing.only(lane).read(place.pointer)
        return np.stack((beta, self._inertia(lane, place.cam) * (1.0 - rate)), axis=1)

    def _inertia(self, lane: np.ndarray, cam: np.ndarray) -> np.ndarray:
        """D (n,)."""
        return np.asarray(1.0 + self.q[lane] * self.coefficients.panels.at(TURN * cam, 1)[0])

    @property
    def _begins(self) -> np.ndarray:
        return np.array([leg.edges[0] for leg in self.legs])

    def leg_of(self, cam: np.ndarray) -> np.ndarray:
        """The legs (n,) in which cam angles (n,) [turns] stand."""
        return np.searchsorted(self._begins, cam, side="right") - 1

    def _train(self, lane: np.ndarray, rows: np.ndarray) -> _Train:
        """What the train does to lanes (n,) where d, C, U are rows (3, n or 1, ...)."""
        d, c, u = rows
        deep = (slice(None),) + (None,) * (d.ndim - 1)
        q, load, swing = self.q[lane][deep], self._load[lane][deep], self.swing.only(lane)
        whole = 1.0 + q * d
        drag, stiff = 2.0 * swing.decay[deep], self.stiff[lane][deep]
        return _Train(q * d / whole, TURN * q * c / whole, load * u / whole, drag, stiff)

    def from_march(self, step: Step) -> Steps:
        """Steps by the input's turn, in these terms."""
        part = np.concatenate(([0.0], _NODES))
        x = step.within(np.broadcast_to(part, (step.lane.size, part.size)))
        gone = step.h[:, None] * part
        rows = self.local(3, step.piece, step.turn, TURN * (step.y[:, None] + gone - x[..., 0]))
        beta, rate = x[..., 0], 1.0 - x[..., 1] / (1.0 + self.q[step.lane, None] * rows[0])
        swing = self.swing.only(step.lane)
        added = self._train(step.lane, rows).added(beta, rate)
        slope = (added * np.exp(-swing.wave[:, None] * gone))[:, 1:]
        start = swing.pointer(beta[:, 0], rate[:, 0])
        inner = step.h * np.abs(slope @ _TAIL).sum(axis=1)
        outer = ROUNDINGS * EPS * (np.abs(start) + np.abs(step.h) * np.abs(slope).max(axis=1))
        wrong = np.stack((inner, outer), axis=1)
        return Steps(step.lane, step.y, step.h, step.h, np.zeros(step.h.size), start, slope, wrong)

    # -- a leg ------------------------------------------------------------------------------------------

    def solve(self, leg: Leg, lane: np.ndarray, place: Place) -> Solved:
        """The leg from where the lanes (n,) stand in it."""
        inside = place.cam > leg.edges[0]
        edges = np.maximum(leg.edges, place.cam[:, None]) if inside.any() else leg.edges[None]
        rows = leg.rows(edges) if inside.any() else leg.own
        swing = self.swing.only(lane)
        train = self._train(lane, rows)
        wave = swing.wave[:, None, None]
        h = np.diff(edges)
        gone = leg.nodes(edges) - edges[:, :1, None]
        start = place.pointer[:, None, None]
        first = swing.read(place.pointer)[0][:, None, None]
        size = np.abs(place.pointer)
        before = np.full(lane.size, 1e-300)
        amplitude, beta = np.broadcast_to(start, train.heavy.shape), first
        share = SHARE * self.error * (leg.edges[-1] - leg.edges[0]) / self.periods * swing.omega
        for _ in range(SWEEPS):
            turned = np.exp(wave * (gone + beta - first))
            beta, rate = swing.read(turned * amplitude)
            speed = 1.0 - rate
            slope = train.added(beta, rate) / (turned * speed)
            gains = h * (slope @ _WEIGHTS)
            begun = start + (np.cumsum(gains, axis=1) - gains)[..., None]
            new = begun + h[..., None] * (slope @ _WITHIN)
            change = np.abs(new - amplitude).max(axis=(1, 2))
            amplitude = new
            size = np.maximum(size, np.abs(new).max(axis=(1, 2)))
            largest = np.maximum(place.largest, np.abs(beta).max(axis=(1, 2)))
            # the next change is to this one at most as this one to the last
            left = change * np.minimum(change / before, 1.0)
            settled = left <= np.maximum(share * largest, 4.0 * EPS * size)
            before = np.maximum(change, 1e-300)
            if (settled | ~np.isfinite(change)).all():
                break
        return self._told(lane, place, edges, begun[..., 0], gains, slope, left, largest, settled, speed)

    def _told(
        self, lane: np.ndarray, place: Place, edges: np.ndarray, begun: np.ndarray, gains: np.ndarray,
        slope: np.ndarray, left: np.ndarray, largest: np.ndarray, settled: np.ndarray, speed: np.ndarray,
    ) -> Solved:  # fmt: skip
        """What is kept of a leg, and what it may be wrong by.

        Within a cell A is wrong by what a polynomial leaves out of its slope, about the last Legendre coefficients. At the
        cell's end that is weighed with how the end depends on it, of which all that a polynomial holds integrates to nothing:
        it is as much smaller as the coefficients are than the slope.
        """
        swing = self.swing.only(lane)
        n, cells = gains.shape
        h = np.broadcast_to(np.diff(edges), gains.shape)
        wave, omega = swing.wave[:, None], swing.omega[:, None]
        tail = np.abs(slope @ _TAIL).sum(axis=2)
        most = np.abs(slope).max(axis=2)
        slack = self.coefficients.panels.tail * most
        inner = h * (tail + slack)
        outer = h * (tail * tail / np.where(most > 0.0, most, 1.0) + slack)
        outer += (left / cells)[:, None] + 2.0 * EPS * np.abs(begun)
        # the input's turn at the cells' ends
        passed, after = np.broadcast_to(edges[:, 1:] - edges[:, :1], gains.shape), begun + gains
        first = swing.read(place.pointer)[0][:, None]
        ends = passed + swing.read(np.exp(wave * passed) * after)[0] - first
        for _ in range(INVERSIONS):
            pointer = np.exp(wave * ends) * after
            beta, rate = swing.read(pointer)
            move = (passed + beta - first - ends) / (1.0 - rate)
            ends = ends + move
            if not np.abs(move).max() > 8.0 * EPS:
                break
        pointer = np.exp(wave * ends) * after
        starts = np.concatenate((np.zeros((n, 1)), ends[:, :-1]), axis=1)
        back = np.exp(wave * starts)  # each step counts its amplitude from its own start
        allowed = SHARE * self.error * (omega * largest[:, None])
        rough = inner > np.maximum(allowed, 64.0 * EPS * np.abs(begun) + 2.0 * h * slack)
        steps = Steps(
            np.repeat(lane, cells),
            (place.y[:, None] + starts).ravel(),
            (ends - starts).ravel(),
            h.ravel(),
            np.ones(n * cells),
            (back * begun).ravel(),
            (back[..., None] * slope).reshape(n * cells, NODES),
            np.stack((inner, outer), axis=-1).reshape(n * cells, 2),
        )
        slow = ~(speed.min(axis=(1, 2)) > SLOWEST)  # nan is
        cam = np.full(n, edges[0, -1] % 1.0)
        after_all = Place(place.y + ends[:, -1], cam, pointer[:, -1], largest)
        return Solved(steps, after_all, settled, slow, ~rough.any(axis=1))
