"""The branch a linkage follows: the side of each dyad, bridges over change points, and the first guesses of Newton's method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from core.frozen import frozen
from core.mechanism.kinematics import Pose
from core.mechanism.linkage import SolutionPlan
from core.numerics.derivatives import Chain, Derivatives, Rows, unit

# -- paths of groups, and bridges over change points ------------------------------------------------------------


HALF = 0.01  # half the width of a bridge, in units of the driver's coordinate scale


@frozen(eq=False)
class GroupPath:
    """Path of a group of k links through its driver positions.

    Attributes
    ----------
    at : ndarray (m,) [rad or m]
        Driver positions, rising.
    states : ndarray (m, 4, 3k)
        Coordinates of the group there with three derivatives: x and y in units of the size, angle [rad].
    """

    at: np.ndarray
    states: np.ndarray

    @property
    def low(self) -> float:
        """First driver position [rad or m]."""
        return float(self.at[0])

    @property
    def high(self) -> float:
        """Last driver position [rad or m]."""
        return float(self.at[-1])

    def first_guess(self, q: np.ndarray) -> np.ndarray:
        """Approximate coordinates by the Taylor series of the nearest node.

        Distances are relative to the spacing of the nodes, since near a dead centre the series converges only that far.

        Parameters
        ----------
        q : ndarray (n,) [rad or m]
            Driver positions.

        Returns
        -------
        ndarray (3k, n), dimensionless
            First guess of `groups.newton`.
        """
        gaps = np.diff(self.at)
        reach = np.minimum(np.append(np.inf, gaps), np.append(gaps, np.inf))
        nearest = np.searchsorted(self.at[:-1] + gaps * reach[:-1] / (reach[:-1] + reach[1:]), q)
        step = q - self.at[nearest]
        x, v, a, j = (self.states[nearest, k].T for k in range(4))
        return np.asarray(x + step * (v + step * (a / 2.0 + step * j / 6.0)))


@frozen(eq=False)
class Bridge:
    """Polynomials for the two links of a dyad near a change point, where its equations are 0/0 although the links move smoothly.

    Attributes
    ----------
    at, half : float
        Change point and half the width [rad or m].
    links : tuple of int
        Numbers of the two links.
    power : ndarray (8, 6) [m or rad]
        Coefficients by powers of (q - at)/half, of x, y and angle of the first link, then of the second. They agree with the
        closed form and its three derivatives at both ends.
    """

    at: float
    half: float
    links: tuple[int, int]
    power: np.ndarray

    def covers(self, q: np.ndarray) -> np.ndarray:
        """Whether driver positions are on the bridge.

        Parameters
        ----------
        q : ndarray (n,) [rad or m]

        Returns
        -------
        ndarray (n,) of bool, dimensionless
        """
        return np.abs(q - self.at) < self.half

    def apply(self, q: Derivatives, poses: dict[int, Pose]) -> None:
        """Replace the poses of both links, infinite or NaN in the closed form, where the driver position q (n,) is on the bridge."""
        mask = self.covers(q[0])
        if not mask.any():
            return
        rows = Chain(lambda order, _: self._row(q, mask, order))
        for i, link in enumerate(self.links):
            poses[link] = _spliced_pose(poses[link], rows, 3 * i, mask)

    def _row(self, q: Derivatives, mask: np.ndarray, order: int) -> np.ndarray:
        """Derivative of this order (6, m) of the six coordinates at the m positions on the bridge, by the chain rule."""
        from numpy.polynomial.polynomial import polyder, polyval

        u = (q[0][mask] - self.at) / self.half
        x = [polyval(u, polyder(self.power, k)) / self.half**k for k in range(order + 1)]
        if order == 0:
            return np.asarray(x[0])
        v, *more = (np.broadcast_to(q[k], mask.size)[mask] for k in range(1, order + 1))
        if order == 1:
            return np.asarray(x[1] * v)
        if order == 2:
            return np.asarray(x[2] * v * v + x[1] * more[0])
        return np.asarray(x[3] * v * v * v + 3.0 * x[2] * v * more[0] + x[1] * more[1])


def _spliced_pose(pose: Pose, rows: Chain, first: int, mask: np.ndarray) -> Pose:
    """The pose (n,) with x, y and angle from rows first, first + 1, first + 2 of the chain where mask is True."""

    def spliced(part: Derivatives, bridge_row: Callable[[Rows], np.ndarray]) -> Derivatives:
        part = part.without_warnings()

        def row(order: int) -> np.ndarray:
            values = np.array(np.broadcast_to(part[order], mask.size))
            values[mask] = bridge_row(rows[order])
            return values

        return Derivatives(row)

    def heading() -> np.ndarray:
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            values = np.array(np.broadcast_to(pose.unit, mask.size))
        values[mask] = unit(rows[0][first + 2])
        return values

    origin = spliced(pose.origin, lambda row: row[first] + 1j * row[first + 1])
    return Pose(origin, spliced(pose.turn, lambda row: row[first + 2]), unit=heading)


def bridge(at: float, half: float, links: tuple[int, int], states: np.ndarray) -> Bridge:
    """Bridge of degree 7 through given states at both ends.

    Parameters
    ----------
    at, half : float
        Change point and half the width [rad or m].
    links : tuple of int
        Numbers of the two links.
    states : ndarray (2, 4, 6) [m or rad]
        At both ends, x, y and angle of both links with three derivatives by q.

    Returns
    -------
    Bridge
    """
    right = (states * half ** np.arange(4.0)[:, None]).reshape(8, 6)
    return Bridge(at, half, links, np.linalg.solve(_end_powers(), right))


@lru_cache(maxsize=1)
def _end_powers() -> np.ndarray:
    """Powers of -1 and of 1 with three derivatives (8, 8)."""
    from numpy.polynomial.polynomial import polyder, polyval

    return np.array([polyval(u, polyder(np.eye(8), order)) for u in (-1.0, 1.0) for order in range(4)])


@dataclass
class Branch:
    """Assembly of a linkage, by the index of a step of its plan, as far as it has been solved.

    Attributes
    ----------
    start : float
        Driver position [rad or m] at which the stated sides hold.
    chosen : dict of int to (float, float)
        Side +1 or -1 of a drawn dyad, and the driver position [rad or m] of the drawing.
    tracks : dict of int to GroupPath
        Paths of groups.
    changes : dict of int to ndarray (m,) [rad or m]
        Change points of dyads, rising.
    bridges : dict of int to tuple of Bridge
        Bridges over the change points.
    """

    start: float = 0.0
    chosen: dict[int, tuple[float, float]] = field(default_factory=dict)
    tracks: dict[int, GroupPath] = field(default_factory=dict)
    changes: dict[int, np.ndarray] = field(default_factory=dict)
    bridges: dict[int, tuple[Bridge, ...]] = field(default_factory=dict)

    def side(self, step: int, stated: float, q: np.ndarray) -> float | np.ndarray:
        """Side of a dyad at driver positions; it changes its sign at each change point.

        Parameters
        ----------
        step : int
            Index of the dyad's step.
        stated : float
            Side +1 or -1 at `start`; `chosen` goes first.
        q : ndarray (n,) [rad or m]
            Driver positions.

        Returns
        -------
        float or ndarray (n,), dimensionless
            +1 or -1.
        """
        changes = self.changes.get(step)
        stated, start = self.chosen.get(step, (stated, self.start))
        if changes is None or not changes.size:
            return stated
        passed = np.searchsorted(changes, q) - np.searchsorted(changes, start + 1e-9)
        return np.where(passed % 2 == 0, stated, -stated)


# -- kind of a four-bar (Grashof) -------------------------------------------------------------------------------


CHANGE = 1e-12  # relative difference below which shortest + longest equals the sum of the other two


@frozen
class FourBar:
    """Lengths [m] of ground, crank (the driver), coupler and rocker, and the kind in Grashof's terms."""

    ground: float
    crank: float
    coupler: float
    rocker: float
    kind: str


_BY_SHORTEST = {"ground": "double crank", "crank": "crank-rocker", "coupler": "double rocker", "rocker": "rocker-crank"}


def four_bar(plan: SolutionPlan) -> FourBar | None:
    """Four-bar of the driver and a dyad RRR between driver and frame; None where the linkage contains none.

    Grashof's condition: where shortest + longest < sum of the other two, the shortest link rotates fully against its neighbours.
    """
    for step, joints in plan.steps:
        ends = (
            {joints[0].first.link: (joints[0], 0), joints[2].first.link: (joints[2], 1)} if step.kind == "RRR" else {}
        )
        driver = plan.driver
        if set(ends) != {driver.first.link, driver.second.link} or not driver.revolute:
            continue
        (frame_joint, frame_side), (crank_joint, _) = ends[driver.first.link], ends[driver.second.link]
        coupler_joint = joints[1]
        rods = (
            abs(coupler_joint.first.point - joints[0].second.point),
            abs(coupler_joint.second.point - joints[2].second.point),
        )
        lengths = {
            "ground": abs(frame_joint.first.point - driver.first.point),
            "crank": abs(crank_joint.first.point - driver.second.point),
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
