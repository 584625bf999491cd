"""The nonlinear wind-up followed by the cam's own angle, while the cam goes forward: joins are passed exactly, and what the
train does is known beforehand at every node.

A leg of the turn is solved as a whole: cells, none across a join, with Gauss-Legendre nodes; the amplitude A of the shaft's
swing (see ``swing``) is the integral of what the train adds to it, and Picard's sweeps find it, for no more than the train's
share is left to them. Where the cam all but stands still its angle is no clock: ``march`` goes on by the input's turn.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from core.cancellation import checkpoint
from core.motion import EPS, TURN
from core.stability import march
from core.stability.coefficients import Coefficients
from core.stability.lanes import Lanes
from core.stability.legs import Leg, legs_of, nodes
from core.stability.march import Step
from core.stability.nonlinear import Equation, Points
from core.stability.panels import NODES, gauss, integration, to_legendre
from core.stability.swing import INVERSIONS, Steps, Swing

SWEEPS = 30
HALVINGS = 3  # of the cells of a leg
SLOWEST = 0.2  # of the even speed: below, the cam's angle is no clock
ASTRAY = 1e-3  # of its duration: a cell so far off stands in another swing of the shaft
SHARE = 0.25  # of the wanted error that each source of it may use
ROUNDINGS = 2.0  # of a cell
LEFT = 2.0 / (2 * NODES + 1)  # of a Legendre coefficient in its integral over a step 1 long; twice: left out, and misread
MARCHED = 32.0  # of a step by the input's turn
CLOSE = 1e-9  # [turns] a step of Newton's method no longer is the last: the next would be its square
INSIDE = 1e-10 / TURN  # [turns] what is no farther from the end of a leg has passed it

_NODES, _WEIGHTS = gauss(NODES)
_WITHIN = integration(NODES).T
_TAIL = to_legendre(NODES)[-2:].T


@dataclass(eq=False)
class Place(Lanes):
    """Where lanes (L,) are: y, cam angle within the turn [turns], pointer, largest |β| so far."""

    y: np.ndarray
    cam: np.ndarray
    pointer: np.ndarray
    largest: np.ndarray

    def put(self, at: np.ndarray, there: Place) -> None:
        for f in fields(self):
            getattr(self, f.name)[at] = getattr(there, f.name)


@dataclass(frozen=True, eq=False)
class Solved:
    """A leg of some lanes (n,).

    steps    its cells, lane by lane
    place    of the lanes at its end
    settled  (n,) the sweeps have found it
    slow     (n,) the cam all but stands still in it, or it only spins: its angle is no clock
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
class _Found:
    """What the sweeps have found of cells (n, K).

    begun, gains   (n, K) A at their starts and what it gains in them
    slope, speed   (n, K, NODES) dA by the cam's turn, and how fast that turns by the input's
    after          (n, K) about when their ends are reached, by the input's turn from the leg's start
    largest, left, settled  (n,) |β| so far; the change of the sweep that was not made; whether that is nothing
    wild           (n,) the cam only spins, or nothing was found
    slack, most    (n, K) what the panels of the coefficients leave out of the slope, and its largest value
    """

    begun: np.ndarray
    gains: np.ndarray
    slope: np.ndarray
    speed: np.ndarray
    after: np.ndarray
    largest: np.ndarray
    left: np.ndarray
    settled: np.ndarray
    wild: np.ndarray
    slack: np.ndarray
    most: np.ndarray


class Turning(Equation):
    """The equation of some points, ready to be followed by the cam's angle to a wanted error of β, relative to the largest."""

    def __init__(self, coefficients: Coefficients, points: Points, error: float, periods: float) -> None:
        super().__init__(coefficients, points)
        self.swing = Swing.of(self.eta, self.damping)
        self.error, self.periods = error, periods
        self.legs = legs_of(coefficients.panels, float(self.eta.max()), error)

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

    def from_march(self, step: Step) -> Steps:
        """Steps by the input's turn, in these terms."""
        part = np.concatenate(([0.0], _NODES))
        x = step.within(np.broadcast_to(part, (step.lane.size, part.size)))
        gone = step.h[:, None] * part
        rows = self.local(3, step.piece, step.turn, TURN * (step.y[:, None] + gone - x[..., 0]))
        beta, rate = x[..., 0], 1.0 - x[..., 1] / (1.0 + self.q[step.lane, None] * rows[0])
        swing = self.swing.only(step.lane)
        added = self.train(step.lane, rows).added(beta, rate)
        slope = (added * np.exp(-swing.wave[:, None] * gone))[:, 1:]
        start = swing.pointer(beta[:, 0], rate[:, 0])
        inner = step.h * LEFT * np.abs(slope @ _TAIL).sum(axis=1)
        outer = MARCHED * EPS * (np.abs(start) + np.abs(step.h) * np.abs(slope).max(axis=1))
        wrong = np.stack((inner, outer), axis=1)
        return Steps(step.lane, step.y, step.h, step.h, np.zeros(step.h.size), start, slope, wrong)

    # -- a leg ------------------------------------------------------------------------------------------

    @np.errstate(all="ignore")  # a lane that comes to nothing is told as slow
    def solve(self, leg: Leg, lane: np.ndarray, place: Place) -> Solved:
        """The leg from where the lanes (n,) stand in it."""
        inside = (place.cam > leg.edges[0]).any()
        edges = np.maximum(leg.edges, place.cam[:, None]) if inside else leg.edges[None]
        found = self._swept(leg, lane, place, edges, leg.rows(edges) if inside else leg.own)
        ends, pointer = self._ends(lane, place, edges, found)
        h = np.broadcast_to(np.diff(edges), found.gains.shape)
        starts = np.concatenate((np.zeros((lane.size, 1)), ends[:, :-1]), axis=1)
        back = np.exp(self.swing.only(lane, 1).wave * starts)  # each step counts its amplitude from its own start
        inner, outer = self._wrong(found, h)
        steps = Steps(
            np.repeat(lane, h.shape[1]),
            (place.y[:, None] + starts).ravel(),
            (ends - starts).ravel(),
            h.ravel(),
            np.ones(h.size),
            (back * found.begun).ravel(),
            (back[..., None] * found.slope).reshape(h.size, NODES),
            np.stack((inner, outer), axis=-1).reshape(h.size, 2),
        )
        arrived = Place(place.y + ends[:, -1], np.full(lane.size, leg.edges[-1] % 1.0), pointer, found.largest)
        # shorter cells leave less out, but no less than the coefficients' own panels and rounding do
        least = 64.0 * EPS * np.abs(found.begun) + 2.0 * h * found.slack
        allowed = SHARE * self.error * (self.swing.omega[lane] * found.largest)[:, None]
        fine = (inner <= np.maximum(allowed, least)).all(axis=1)
        forward = (found.speed.min(axis=(1, 2)) > SLOWEST) & (ends >= starts).all(axis=1)
        # the cam may stand at an angle thrice where it has turned back: then the durations are not those of its speed
        lasted, due = ends - starts, h * ((1.0 / found.speed) @ _WEIGHTS)
        same = (np.abs(lasted - due) <= ASTRAY * lasted).all(axis=1)
        return Solved(steps, arrived, found.settled & same, ~forward | found.wild, fine)

    def _swept(self, leg: Leg, lane: np.ndarray, place: Place, edges: np.ndarray, rows: np.ndarray) -> _Found:
        """Picard's sweeps through cells with these edges (n or 1, K + 1) and rows d, C, U at their nodes."""
        swing, train = self.swing.only(lane, 2), self.train(lane, rows)
        wave, h = swing.wave, np.diff(edges)
        start = place.pointer[:, None, None]
        first = start.imag / swing.omega
        turn = nodes(edges) - edges[:, :1, None]
        gone = turn - first
        share = SHARE * self.error * (leg.edges[-1] - leg.edges[0]) / self.periods * self.swing.omega[lane]
        floor = 4.0 * EPS * np.abs(place.pointer)
        most_late = 0.5 / np.abs(wave)
        before = np.full(lane.size, 1e-300)
        amplitude = np.broadcast_to(start, train.heavy.shape)
        for _ in range(SWEEPS):
            checkpoint()
            turned = np.exp(wave * turn)
            pointer = turned * amplitude
            beta, rate = swing.read(pointer)
            # the input is there already, or not yet, where the shaft is wound up otherwise than at the last sweep
            late = np.clip((gone + beta - turn) / (1.0 - rate), -most_late, most_late)
            turn = turn + late
            along = 1.0 + wave * late
            turned = turned * along
            beta, rate = swing.read(pointer * along)
            speed = 1.0 - rate
            slope = train.added(beta, rate) / (turned * speed)
            gains = h * (slope @ _WEIGHTS)
            begun = start[..., 0] + (np.cumsum(gains, axis=1) - gains)
            new = begun[..., None] + h[..., None] * (slope @ _WITHIN)
            change = np.abs(new - amplitude).max(axis=(1, 2))
            amplitude = new
            largest = np.maximum(place.largest, np.abs(beta).max(axis=(1, 2)))
            # the next change is to this one at most as this one to the last
            left = change * np.minimum(change / before, 1.0)
            settled = left <= np.maximum(share * largest, np.maximum(floor, 4.0 * EPS * np.abs(begun).max(axis=1)))
            before = np.maximum(change, 1e-300)
            if (settled | ~np.isfinite(change)).all():
                break
        wild = ~(np.abs(speed / (1.0 - train.heavy)).max(axis=(1, 2)) <= march.FASTEST)  # nan is
        # a guess of the input's turns at the cells' ends
        after = turn[..., -1] + h * (1.0 - _NODES[-1]) / speed[..., -1]
        most = np.abs(slope).max(axis=2)
        slack = self.coefficients.panels.tail * most
        return _Found(begun, gains, slope, speed, after, largest, left, settled, wild, slack, most)

    def _wrong(self, found: _Found, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What A may be wrong by within cells (n, K) of lengths h, and at their ends.

        Within, by the integral of what a polynomial leaves out of its slope, about the last Legendre coefficients. At the end
        that is weighed with how the end depends on it, of which all that a polynomial holds integrates to nothing (the nodes
        are Gauss's): it is as much smaller as those coefficients are than the slope. To that come what the panels of the
        coefficients leave out, the sweep that was not made, and roundings.
        """
        tail = np.abs(found.slope @ _TAIL).sum(axis=2)
        unmade = (found.left / h.shape[1])[:, None] + ROUNDINGS * EPS * np.abs(found.begun)
        outer = h * (tail * tail / np.where(found.most > 0.0, found.most, 1.0) + found.slack) + unmade
        return h * (LEFT * tail + found.slack), outer

    def _ends(self, lane: np.ndarray, place: Place, edges: np.ndarray, found: _Found) -> tuple[np.ndarray, np.ndarray]:
        """The input's turns at the cells' ends (n, K), counted from the leg's start, and the pointer (n,) at the leg's end, by
        Newton's method."""
        swing, amplitude = self.swing.only(lane, 1), found.begun + found.gains
        passed = edges[:, 1:] - edges[:, :1] - place.pointer.imag[:, None] / swing.omega
        ends, most = found.after, 0.5 / np.abs(swing.wave)
        for _ in range(INVERSIONS):
            beta, rate = swing.read(np.exp(swing.wave * ends) * amplitude)
            move = np.clip((passed + beta - ends) / (1.0 - rate), -most, most)
            ends = ends + move
            if not np.abs(move).max() > CLOSE:
                break
        return ends, np.exp(swing.wave[:, 0] * ends[:, -1]) * amplitude[:, -1]
