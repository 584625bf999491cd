"""The branch that a linkage follows: which side of a dyad holds where, over change points, and where Newton starts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from core.frozen import frozen
from core.mechanism.kinematics import Pose
from core.mechanism.linkage import SolutionPlan
from core.numerics.derivatives import Chain, Derivatives, Rows, unit

# -- the branch that a linkage follows --------------------------------------------------------------------------


HALF = 0.01  # half the width of a bridge, in units of the driver's coordinate scale


@frozen(eq=False)
class GroupPath:
    """A group's path: driver positions (m,), and there its coordinates with three derivatives (m, 4, 3k)."""

    at: np.ndarray
    states: np.ndarray

    @property
    def low(self) -> float:
        """Its first driver position [rad or m]."""
        return float(self.at[0])

    @property
    def high(self) -> float:
        """Its last driver position [rad or m]."""
        return float(self.at[-1])

    def start(self, q: np.ndarray) -> np.ndarray:
        """Coordinates near those at q (3k, n), by Taylor from the nearest node, distances measured by how close the nodes stand:
        beside a dead centre they close in on it, and their Taylor series reach no farther than that."""
        gaps = np.diff(self.at)
        reach = np.minimum(np.append(np.inf, gaps), np.append(gaps, np.inf))
        nearest = np.searchsorted(self.at[:-1] + gaps * reach[:-1] / (reach[:-1] + reach[1:]), q)
        step = q - self.at[nearest]
        x, v, a, j = (self.states[nearest, k].T for k in range(4))
        return np.asarray(x + step * (v + step * (a / 2.0 + step * j / 6.0)))


@frozen(eq=False)
class Bridge:
    """A dyad's two links over a change point, where its equations are 0/0 although the links move on smoothly.

    at, half   the change point and half the width [rad or m]
    links      their numbers
    power      (8, 6) coefficients, by (q - at)/half, of x, y, angle of the first link, then of the second: they agree
               with the closed form and its three derivatives at both ends
    """

    at: float
    half: float
    links: tuple[int, int]
    power: np.ndarray

    def within(self, q: np.ndarray) -> np.ndarray:
        """(n,) where the driver stands on the bridge."""
        return np.abs(q - self.at) < self.half

    def apply(self, q: Derivatives, poses: dict[int, Pose]) -> None:
        """Replace both links' poses, which are infinite or nan here, where the driver at q (n,) stands on the bridge."""
        there = self.within(q[0])
        if not there.any():
            return
        rows = Chain(lambda order, _: self._row(q, there, order))
        for i, link in enumerate(self.links):
            poses[link] = _over(poses[link], rows, 3 * i, there)

    def _row(self, q: Derivatives, there: np.ndarray, order: int) -> np.ndarray:
        """Derivative of this order of the six (6, m), by what q's are by, of the m positions on the bridge (chain rule)."""
        from numpy.polynomial.polynomial import polyder, polyval

        u = (q[0][there] - self.at) / self.half
        x = [polyval(u, polyder(self.power, k)) / self.half**k for k in range(order + 1)]
        if order == 0:
            return np.asarray(x[0])
        v, *more = (np.broadcast_to(q[k], there.size)[there] for k in range(1, order + 1))
        if order == 1:
            return np.asarray(x[1] * v)
        if order == 2:
            return np.asarray(x[2] * v * v + x[1] * more[0])
        return np.asarray(x[3] * v * v * v + 3.0 * x[2] * v * more[0] + x[1] * more[1])


def _over(pose: Pose, rows: Chain, first: int, there: np.ndarray) -> Pose:
    """A pose (n,) that is x, y, angle of the chain from row ``first`` on where the driver stands on the bridge."""

    def spliced(part: Derivatives, on: Callable[[Rows], np.ndarray]) -> Derivatives:
        part = part.without_warnings()

        def row(order: int) -> np.ndarray:
            values = np.array(np.broadcast_to(part[order], there.size))
            values[there] = on(rows[order])
            return values

        return Derivatives(row)

    def heading() -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            values = np.array(np.broadcast_to(pose.unit, there.size))
        values[there] = unit(rows[0][first + 2])
        return values

    origin = spliced(pose.origin, lambda row: row[first] + 1j * row[first + 1])
    return Pose(origin, spliced(pose.turn, lambda row: row[first + 2]), unit=heading)


def bridge(at: float, half: float, links: tuple[int, int], states: np.ndarray) -> Bridge:
    """The bridge through states (2, 4, 6): at both ends x, y, angle of both links and three derivatives by q."""
    right = (states * half ** np.arange(4.0)[:, None]).reshape(8, 6)
    return Bridge(at, half, links, np.linalg.solve(_at_ends(), right))


@lru_cache(maxsize=1)
def _at_ends() -> np.ndarray:
    """(8, 8): the powers of -1 and 1 with three derivatives."""
    from numpy.polynomial.polynomial import polyder, polyval

    return np.array([polyval(u, polyder(np.eye(8), order)) for u in (-1.0, 1.0) for order in range(4)])


@dataclass
class Branch:
    """Which of its assemblies a linkage is in, by step of its plan, as far as it has been solved: tracks of groups; change
    points of dyads (rising, (m,)), the driver position from which their sides count, and the bridges over them; chosen: side of a
    dyad, and the driver position at which it is drawn so."""

    start: float = 0.0
    chosen: dict[int, tuple[float, float]] = field(default_factory=dict)
    tracks: dict[int, GroupPath] = field(default_factory=dict)
    changes: dict[int, np.ndarray] = field(default_factory=dict)
    bridges: dict[int, tuple[Bridge, ...]] = field(default_factory=dict)

    def side(self, step: int, stated: float, q: np.ndarray) -> float | np.ndarray:
        """+1 or -1 of a step's dyad at q (n,): as stated at the start of the range, or as chosen where it is drawn, the other one
        beyond each change point."""
        changes = self.changes.get(step)
        stated, start = self.chosen.get(step, (stated, self.start))
        if changes is None or not changes.size:
            return stated
        passed = np.searchsorted(changes, q) - np.searchsorted(changes, start + 1e-9)
        return np.where(passed % 2 == 0, stated, -stated)


# -- what kind of four-bar it is (Grashof) ----------------------------------------------------------------------


CHANGE = 1e-12  # relative: shortest + longest this near to the sum of the others is equality


@frozen
class FourBar:
    """Ground, crank (the driver), coupler and rocker lengths [m]; kind as a designer says it."""

    ground: float
    crank: float
    coupler: float
    rocker: float
    kind: str


_BY_SHORTEST = {"ground": "double crank", "crank": "crank-rocker", "coupler": "double rocker", "rocker": "rocker-crank"}


def four_bar(plan: SolutionPlan) -> FourBar | None:
    """The four-bar of the driver and a dyad RRR on it and the frame; None where the linkage holds none.

    Grashof: shortest + longest < the other two: the shortest link turns fully against its neighbours.
    """
    for step, joints in plan.steps:
        ends = (
            {joints[0].first.link: (joints[0], 0), joints[2].first.link: (joints[2], 1)} if step.kind == "RRR" else {}
        )
        driver = plan.driver
        if set(ends) != {driver.first.link, driver.second.link} or not driver.revolute:
            continue
        (on_frame, frame_side), (on_crank, _) = ends[driver.first.link], ends[driver.second.link]
        inner = joints[1]
        rods = (
            abs(inner.first.point - joints[0].second.point),
            abs(inner.second.point - joints[2].second.point),
        )
        lengths = {
            "ground": abs(on_frame.first.point - driver.first.point),
            "crank": abs(on_crank.first.point - driver.second.point),
            "coupler": rods[1 - frame_side],
            "rocker": rods[frame_side],
        }
        return FourBar(**lengths, kind=_kind(lengths))
    return None


def _kind(lengths: dict[str, float]) -> str:
    short, *others, long = sorted(lengths.values())
    surplus = short + long - sum(others)
    if abs(surplus) <= CHANGE * long:
        return "change point"
    if surplus > 0.0:
        return "triple rocker"
    return _BY_SHORTEST[next(name for name, length in lengths.items() if length == short)]
