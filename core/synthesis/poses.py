"""Linkages that guide a body through two to five poses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import combinations
from math import radians

import numpy as np

from core.errors import MISSING, DesignError, Fault
from core.frozen import frozen
from core.numerics.lazy import checkpoint
from core.synthesis.candidates import KINDS, Candidate, driver_angles, is_degenerate, linkage_of
from core.synthesis.dyads import PIN, Dyad, ScaledPoses, dyads_through, is_inside, sweeps
from core.synthesis.judge import position_errors
from core.synthesis.sieve import best_pairs
from core.synthesis.task import FIXED, Area, BodyPose, Task, pivots_of, task_size

MOST_CARDS = 24
"""Pairs of a sweep that are judged."""
REACH = 2.0
"""Where a task has no area, its size by which the box of the poses is enlarged to all sides; also the reach of swept moving pivots."""
TRIALS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 45.0)
"""Turns [deg], and shifts [% of the size], of one pose that are tried where poses have no two dyads."""


@frozen(eq=False)
class PoseDyads:
    """Dyads of a task of poses, by the conditions on each of the two; the lists are one where these are equal.

    Attributes
    ----------
    first, second : tuple of Dyad
    complete : bool
        Whether these are all dyads, not those of a sweep.
    """

    first: tuple[Dyad, ...]
    second: tuple[Dyad, ...]
    complete: bool

    @property
    def all(self) -> tuple[Dyad, ...]:
        """Both lists, each dyad once."""
        return tuple(dict.fromkeys((*self.first, *self.second)))

    def are_pair(self, a: Dyad, b: Dyad) -> bool:
        """Whether one of two dyads fits the conditions on the first dyad, and the other one those on the second."""
        return (a in self.first and b in self.second) or (b in self.first and a in self.second)


@lru_cache(maxsize=4)
def pose_dyads(task: Task) -> PoseDyads:
    """All dyads through the poses of a task, or those of a sweep of the conditions that are missing; cached."""
    first = _dyads(task.poses, task, 1)
    second = first if pivots_of(task, 1) == pivots_of(task, 2) else _dyads(task.poses, task, 2)
    return PoseDyads(first[0], second[0], first[1] and second[1])


def _dyads(poses: Sequence[BodyPose], task: Task, number: int) -> tuple[tuple[Dyad, ...], bool]:
    """Dyads of one side, and whether they are all."""
    size = task_size([pose.z for pose in poses])
    scaled = ScaledPoses.of(poses, size or _span(task.area))
    area = task.area or _area(poses, REACH * scaled.size)
    conditions = pivots_of(task, number)
    sets = sweeps(len(poses), conditions, area, REACH * scaled.size)
    complete = len(sets) == 1
    dyads = []
    for pivots in sets:
        checkpoint()
        dyads += dyads_through(scaled, pivots)
    if task.area is not None or not (complete or any(pivot.of == FIXED for pivot in conditions)):
        dyads = [dyad for dyad in dyads if is_inside(dyad, area)]
    if not complete:
        farthest = 4.0 * REACH * scaled.size
        dyads = [dyad for dyad in dyads if abs(dyad.moving) <= farthest]
    return _distinct(dyads, scaled.size), complete


def _distinct(dyads: Sequence[Dyad], size: float) -> tuple[Dyad, ...]:
    """Dyads without repetition: a sweep meets a guide on each of its lines."""

    def key(dyad: Dyad) -> tuple[str, complex, complex, float]:
        fixed, moving = (complex(round(z.real / size, 6), round(z.imag / size, 6)) for z in (dyad.fixed, dyad.moving))
        return dyad.kind, fixed, moving, round(dyad.line, 6)

    return tuple({key(dyad): dyad for dyad in dyads}.values())


def _span(area: Area | None) -> float:
    return 0.0 if area is None else max(area.high_x_mm - area.low_x_mm, area.high_y_mm - area.low_y_mm)


def _area(poses: Sequence[BodyPose], margin: float) -> Area:
    """Box of the poses, enlarged by a margin [mm]."""
    x, y = [pose.x_mm for pose in poses], [pose.y_mm for pose in poses]
    return Area(min(x) - margin, min(y) - margin, max(x) + margin, max(y) + margin)


def candidates(task: Task) -> Iterator[tuple[Candidate, ...]]:
    """Linkages through the poses of a task; each with either side link as its driver.

    Raises
    ------
    DesignError
        There are no two real dyads, and the message names the smallest tried turn or shift of one pose that gives two; or no two of
        them make a linkage.
    """
    dyads = pose_dyads(task)
    if not _has_pair(dyads):
        raise DesignError([_no_dyads(task)])
    z, angles = body_positions(task)
    pairs = list(_pairs(dyads, z, np.exp(1j * angles), task))
    if not pairs:
        raise DesignError([_no_pair()])
    for first, second in pairs:
        checkpoint()
        yield linkages_of(first, second, task)


def body_positions(task: Task) -> tuple[np.ndarray, np.ndarray]:
    """Origins and angles of the body at the poses of a task.

    Returns
    -------
    tuple of ndarray (n,) complex [mm] and ndarray (n,) [rad]
    """
    return np.array([pose.z for pose in task.poses]), np.array([radians(pose.angle_deg) for pose in task.poses])


def linkages_of(first: Dyad, second: Dyad, task: Task) -> tuple[Candidate, ...]:
    """Linkages of two dyads through the poses of a task, the first one with two pins: driven by it, and by the second one if it has two."""
    z, angles = body_positions(task)
    drivers = [(first, second)] if second.kind != PIN else [(first, second), (second, first)]
    return tuple(_candidate(driver, other, z, angles) for driver, other in drivers)


def is_degenerate_pair(first: Dyad, second: Dyad, task: Task) -> bool:
    """Whether two dyads are one, or have a link without length, for the size of a task's poses."""
    return is_degenerate(first, second, _pair_size(task, pose_dyads(task)))


def _pair_size(task: Task, dyads: PoseDyads) -> float:
    z, _ = body_positions(task)
    return float(np.ptp(np.abs(z - z[0]))) or max(abs(dyad.moving) for dyad in dyads.all)


def _pairs(dyads: PoseDyads, z: np.ndarray, turn: np.ndarray, task: Task) -> Iterator[tuple[Dyad, Dyad]]:
    size = _pair_size(task, dyads)
    if dyads.complete:
        rows = combinations(dyads.first, 2) if dyads.first == dyads.second else _product(dyads)
        pairs = [(a, b) if a.kind == PIN else (b, a) for a, b in rows]
    else:
        sides = dyads.first, dyads.second
        pairs = best_pairs(sides, z, turn, MOST_CARDS, order=task.limits.order)
        pairs = pairs or best_pairs(sides, z, turn, MOST_CARDS, with_defects=True)
    for first, second in pairs:
        if first.kind == PIN and not is_degenerate(first, second, max(size, abs(first.fixed - z[0]))):
            yield first, second


def _product(dyads: PoseDyads) -> Iterator[tuple[Dyad, Dyad]]:
    return ((a, b) for a in dyads.first for b in dyads.second if a != b)


def _has_pair(dyads: PoseDyads) -> bool:
    return len(dyads.all) >= 2 and bool(dyads.first) and bool(dyads.second)


def _candidate(first: Dyad, second: Dyad, z: np.ndarray, angles: np.ndarray) -> Candidate:
    linkage = linkage_of(first, second, complex(z[0]), float(angles[0]))
    positions = driver_angles(first, z, np.exp(1j * angles))
    return Candidate(linkage, KINDS[second.kind], positions, position_errors(z, angles))


def _no_pair() -> Fault:
    """Fault of poses whose dyads make no linkage."""
    return Fault("poses", MISSING, "every two dyads have a pivot in common", "other poses or pivots, or a larger area")


def _no_dyads(task: Task) -> Fault:
    """Fault of poses without two real dyads, with the smallest tried change of one pose that has some."""
    size = task_size([pose.z for pose in task.poses]) or 1.0
    allowed = "other poses"
    for trial in TRIALS:
        checkpoint()
        for i, pose in enumerate(task.poses):
            shift = 0.01 * trial * size
            changes = {
                **{f"turned by {s * trial:g} deg": (0.0, 0.0, s * trial) for s in (1, -1)},
                **{f"moved by {s * shift:.4g} mm in x": (s * shift, 0.0, 0.0) for s in (1, -1)},
                **{f"moved by {s * shift:.4g} mm in y": (0.0, s * shift, 0.0) for s in (1, -1)},
            }
            for text, (x, y, turn) in changes.items():
                moved = BodyPose(pose.x_mm + x, pose.y_mm + y, pose.angle_deg + turn)
                poses = (*task.poses[:i], moved, *task.poses[i + 1 :])
                if all(len(_dyads(poses, task, number)[0]) >= 2 for number in (1, 2)):
                    return Fault("poses", MISSING, "have no two dyads", f"poses[{i}] {text}")
    return Fault("poses", MISSING, "have no two dyads", allowed)
