"""A cam in space over the turn: at each cam angle the worst value along its rollers of every figure by which it is judged."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from math import asin, pi

import numpy as np

from core.errors import NoCam, angle_ranges
from core.frozen import frozen
from core.numerics.lazy import Lazy, lazy
from core.spatial.contact import AHEAD, BEHIND, SIDES, MotionRows, SpatialFlank, flank, sliding
from core.spatial.kinds import Machine, lever_arm

NODES = np.array([0.0, 1e-5, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0 - 1e-5, 1.0])
"""Parts of the roller's length at which a figure is first computed; next to an end they show whether it has its extreme there."""
GOLDEN = 0.5 * (5.0**0.5 - 1.0)
SEARCHES = 40  # steps of the golden section
AT_PITCH = 1.0 + 1e-9  # a roller at one pitch is counted

Figure = Callable[[SpatialFlank], np.ndarray]


@frozen
class RollerAt:
    """A roller on the turret at n cam angles.

    Attributes
    ----------
    number : ndarray (n,) int, dimensionless
        Number of the roller, from 1.
    offset : ndarray (n,) [m or rad]
        Its motion less that of the design.
    touches : ndarray (n,) bool, dimensionless
        Whether it is in the blank.
    """

    number: np.ndarray
    offset: np.ndarray
    touches: np.ndarray


def rollers_at(machine: Machine, y: np.ndarray) -> tuple[RollerAt, ...]:
    """Rollers near the cam, the lowest first; a roller that is not on a turret always touches.

    Parameters
    ----------
    machine : Machine
    y : ndarray (n,) [m or rad]
        Motion.

    Returns
    -------
    tuple of RollerAt
        A roller is in the blank where the middle of its axis is within the blank's length; where that is not known, within one pitch.
    """
    n = y.size
    if not machine.is_turret:
        one, always = np.ones(n, dtype=int), np.ones(n, dtype=bool)
        if machine.is_rib:
            return tuple(
                RollerAt(k * one, np.full(n, side * 0.5 * machine.distance), always) for k, side in ((1, -1), (2, 1))
            )
        return (RollerAt(one, np.zeros(n), always),)
    steps = np.round(y / machine.pitch)
    nearest = y - steps * machine.pitch
    count = int(turret_limit(machine) * AT_PITCH / machine.pitch + 0.5)
    result = []
    for k in range(-count, count + 1):
        angle = nearest + k * machine.pitch
        number = (np.mod(k - steps, machine.rollers) + 1).astype(int)
        touches = (np.abs(angle) <= turret_limit(machine) * AT_PITCH) & (np.abs(angle) < 0.5 * pi)
        result.append(RollerAt(number, angle - y, touches))
    return tuple(result)


def turret_limit(machine: Machine) -> float:
    """Greatest angle of a turret's roller that is in the blank [rad]: by the blank's length, else one pitch."""
    if machine.length is None:
        return machine.pitch
    return asin(min(1.0, 0.5 * machine.length / lever_arm(machine, machine.middle)))


def handover_angles(machine: Machine) -> tuple[float, ...]:
    """Angles of the turret within one pitch [rad] at which a roller enters or leaves the blank, or takes over from its neighbour."""
    if not machine.is_turret:
        return ()
    limit, pitch = turret_limit(machine), machine.pitch
    return tuple(sorted({float(np.mod(angle, pitch)) for angle in (limit, -limit, 0.0, 0.5 * pitch)}))


@frozen(eq=False)
class SpatialShape:
    """Figures of a cam in space at n cam angles, each the worst along the roller.

    On a turret pressure angle, curvature and sliding are those of the roller in the blank with the least pressure angle.

    Attributes
    ----------
    machine : Machine
    motion : MotionRows
        Cam angles and motion.
    sense : float
        Sense of rotation.
    offset : ndarray (n,) [m or rad]
        Motion of the roller in contact, less that of the design; 0 where there is no turret.
    number : ndarray (n,) int, dimensionless
        Number of that roller.
    touching : ndarray (n,) int, dimensionless
        Number of rollers in the blank.
    pressure_angle : ndarray (n,) [rad]
        Largest along the roller.
    curvature : ndarray (n,) [1/m]
        Largest normal curvature of a flank, that of the most convex line of contact.
    sliding : ndarray (n,) [m/rad]
        Largest sliding speed, by cam angle.
    margin : ndarray (n,), dimensionless
        Least margin of the flanks of all rollers in the blank; not positive where a flank is undercut.
    gain_ahead, gain_behind : ndarray (n,) [1 or m]
        Work of one newton of contact on each flank, in the roller's middle, per unit of the motion.
    """

    machine: Machine
    motion: MotionRows
    sense: float
    offset: np.ndarray
    number: np.ndarray
    touching: np.ndarray
    pressure_angle: Lazy[np.ndarray] = Lazy(lambda shape: shape.worst(lambda flank: flank.pressure_angle))
    curvature: Lazy[np.ndarray] = Lazy(lambda shape: shape.worst(lambda flank: flank.curvature))
    sliding: Lazy[np.ndarray] = Lazy(lambda shape: _largest_sliding(shape))
    margin: Lazy[np.ndarray] = Lazy(lambda shape: _least_margin(shape))
    gain_ahead: Lazy[np.ndarray] = Lazy(lambda shape: shape.in_middle(AHEAD).gain[0])
    gain_behind: Lazy[np.ndarray] = Lazy(lambda shape: shape.in_middle(BEHIND).gain[0])

    @property
    def theta(self) -> np.ndarray:
        """Cam angles (n,) [rad]."""
        return self.motion.theta

    @lazy
    def tracks(self) -> tuple[tuple[str, MotionRows], ...]:
        """Both flanks on which the shape is judged: side, and the motion of the roller on it."""
        if self.machine.is_rib and not self.machine.is_turret:
            half = 0.5 * self.machine.distance
            return (AHEAD, self.motion.shifted(-half)), (BEHIND, self.motion.shifted(half))
        motion = self.motion.shifted(self.offset)
        return tuple((side, motion) for side in SIDES)

    def in_middle(self, side: str) -> SpatialFlank:
        """Flank of a side in the roller's middle (1, n)."""
        return flank(self.machine, dict(self.tracks)[side], np.array([[self.machine.middle]]), self.sense, side)

    def at_ends(self, side: str) -> SpatialFlank:
        """Flank of a side at the inner and the outer end of the roller (2, n)."""
        ends = np.array([[self.machine.inner], [self.machine.outer]])
        return flank(self.machine, dict(self.tracks)[side], ends, self.sense, side)

    def margin_at(self, u: np.ndarray) -> np.ndarray:
        """Least margin of the flanks of all rollers in the blank at some distances along them.

        Parameters
        ----------
        u : ndarray (m,) [m]
            Distances.

        Returns
        -------
        ndarray (n,), dimensionless
        """
        rows = [
            np.where(touches, flank(self.machine, motion, u[:, None], self.sense, side).margin, np.inf).min(axis=0)
            for side, motion, touches in _flank_motions(self)
        ]
        return np.asarray(np.min(rows, axis=0))

    def along_length(self, rows: int) -> dict[str, SpatialFlank]:
        """Side -> flank at equally spaced distances along the roller (rows, n), the inner end first."""
        u = np.linspace(self.machine.inner, self.machine.outer, rows)[:, None]
        return {side: flank(self.machine, motion, u, self.sense, side) for side, motion in self.tracks}

    def worst(self, figure: Figure) -> np.ndarray:
        """Largest value of a figure along the roller, on either flank.

        Parameters
        ----------
        figure : callable
            Figure of a flank, ndarray (m, n) [any unit].

        Returns
        -------
        ndarray (n,) [unit of the figure]
        """
        values = [along_roller(self.machine, motion, self.sense, side, figure)[0] for side, motion in self.tracks]
        return np.maximum(*values)

    def worst_line(self, figure: Figure) -> SpatialFlank:
        """Flank (1, 1) at the first cam angle and the distance along the roller where a figure is largest."""
        first = {side: MotionRows(*(row[:1] for row in motion)) for side, motion in self.tracks}
        places = {side: along_roller(self.machine, motion, self.sense, side, figure) for side, motion in first.items()}
        side = max(places, key=lambda side: float(places[side][0][0]))
        return flank(self.machine, first[side], places[side][1][None], self.sense, side)


def spatial_shape(machine: Machine, motion: MotionRows, sense: float) -> SpatialShape:
    """Shape of a cam in space.

    Parameters
    ----------
    machine : Machine
    motion : MotionRows
        Cam angles and motion of the design.
    sense : float
        Sense of rotation, ±1.

    Returns
    -------
    SpatialShape

    Raises
    ------
    NoCam
        Where no roller of a turret is in the blank, or a roller has no line of contact.
    """
    rollers = rollers_at(machine, motion.y)
    offset, number = np.zeros(motion.y.size), np.ones(motion.y.size, dtype=int)
    touching = sum((roller.touches.astype(int) for roller in rollers), np.zeros(motion.y.size, dtype=int))
    if machine.is_turret:
        nothing = touching == 0
        NoCam.raise_where(nothing, partial(_no_roller, motion.theta, nothing))
        middle = np.array([[machine.middle]])
        steepness = np.array(
            [
                np.where(
                    roller.touches, flank(machine, motion.shifted(roller.offset), middle, sense, AHEAD).pressure_angle[0], np.inf
                )
                for roller in rollers
            ]
        )  # fmt: skip
        chosen = np.argmin(np.round(steepness, 12), axis=0), np.arange(motion.y.size)
        offset = np.array([roller.offset for roller in rollers])[chosen]
        number = np.array([roller.number for roller in rollers])[chosen]
    shape = SpatialShape(machine, motion, sense, offset, number, touching)
    if machine.taper:
        failed = np.isnan(shape.margin)
        NoCam.raise_where(failed, partial(_no_contact, motion.theta, failed))
    return shape


def _no_roller(theta: np.ndarray, nothing: np.ndarray) -> NoCam:
    ranges = angle_ranges(theta, nothing)
    return NoCam(
        "no roller of the turret is in the blank", "cam.length_mm", "enlarge the length, or add rollers", ranges
    )


def _no_contact(theta: np.ndarray, failed: np.ndarray) -> NoCam:
    problem = (
        "the conical roller has no line of contact with the cam: its cone is too wide for this speed of the motion"
    )
    return NoCam(problem, "cam.roller_taper_deg", "reduce the taper", angle_ranges(theta, failed))


def along_roller(
    machine: Machine, motion: MotionRows, sense: float, side: str, figure: Figure, largest: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """Largest or least value of a figure along the roller: at an end, or refined by golden section.

    Parameters
    ----------
    machine : Machine
    motion : MotionRows
        Cam angles and motion of the roller.
    sense : float
    side : str
    figure : callable
        Figure of a flank, ndarray (m, n) [any unit].
    largest : bool
        Whether the largest value is computed, else the least.

    Returns
    -------
    value : ndarray (n,) [unit of the figure]
    u : ndarray (n,) [m]
        Distance along the axis at which it occurs.
    """
    sign = 1.0 if largest else -1.0
    nodes = machine.inner + (machine.outer - machine.inner) * NODES
    value = sign * figure(flank(machine, motion, nodes[:, None], sense, side))
    best = np.argmax(value, axis=0)
    result, place = np.take_along_axis(value, best[None], axis=0)[0], nodes[best]
    inside = np.flatnonzero((best > 0) & (best < NODES.size - 1) & (np.ptp(value, axis=0) > 1e-12 * np.abs(result)))
    if inside.size:
        part = MotionRows(*(row[inside] for row in motion))

        def at(u: np.ndarray) -> np.ndarray:
            return np.asarray(sign * figure(flank(machine, part, u[None], sense, side))[0])

        place[inside], result[inside] = _golden(at, nodes[best[inside] - 1], nodes[best[inside] + 1])
    return sign * result, place


def _golden(
    value: Callable[[np.ndarray], np.ndarray], low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Place and largest value (k,) between the ends (k,) of each interval, where it has one peak."""
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    of_left, of_right = value(left), value(right)
    for _ in range(SEARCHES):
        is_left = of_left > of_right
        low, high = np.where(is_left, low, left), np.where(is_left, right, high)
        new = np.where(is_left, high - GOLDEN * (high - low), low + GOLDEN * (high - low))
        at_new = value(new)
        left, right = np.where(is_left, new, right), np.where(is_left, left, new)
        of_left, of_right = np.where(is_left, at_new, of_right), np.where(is_left, of_left, at_new)
    return np.where(of_left > of_right, left, right), np.maximum(of_left, of_right)


def _largest_sliding(shape: SpatialShape) -> np.ndarray:
    values = []
    for side, _ in shape.tracks:
        values.append(sliding(shape.at_ends(side), shape.in_middle(side)).max(axis=0))  # it grows from the middle
    return np.maximum(*values)


def _flank_motions(shape: SpatialShape) -> Iterator[tuple[str, MotionRows, np.ndarray]]:
    """Side, motion of its roller and mask (n,) of every flank in the blank."""
    if not shape.machine.is_turret:
        yield from ((side, motion, np.ones(motion.y.size, dtype=bool)) for side, motion in shape.tracks)
        return
    for roller in rollers_at(shape.machine, shape.motion.y):
        yield from ((side, shape.motion.shifted(roller.offset), roller.touches) for side in SIDES)


def _least_margin(shape: SpatialShape) -> np.ndarray:
    machine = shape.machine
    rows = [
        np.where(touches, along_roller(machine, motion, shape.sense, side, lambda flank: flank.margin, largest=False)[0], np.inf)
        for side, motion, touches in _flank_motions(shape)
    ]  # fmt: skip
    return np.asarray(np.min(rows, axis=0))
