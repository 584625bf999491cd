"""Results of the stages, remembered by the parts of the design that they depend on."""

from __future__ import annotations

from collections import Counter, OrderedDict, defaultdict
from collections.abc import Callable, Hashable, Sequence
from functools import lru_cache
from math import degrees
from typing import Any

import numpy as np

from core import dynamics
from core.dynamics import Forces, Friction, Loading
from core.errors import NoAnswer
from core.mechanism import CrankMotion, DriverRanges, Mechanism, solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, MotionState, Program, program
from core.motion import degrees as motion_degrees
from core.motion.extremes import crossings, piecewise_angles
from core.motion.program import CutProgram
from core.numerics.derivatives import spread
from core.numerics.lazy import locked
from core.shaft import LoadCurve, load_curve

# -- what a drive asks of its shaft over one turn, fitted between the angles where it breaks --------------------


Switch = Callable[[Kinematics, Forces], np.ndarray]


def fitted_load(
    solved: Callable[[Angles], tuple[Kinematics, Forces]],
    torque: Callable[[Forces], np.ndarray],
    loading: Loading,
    program: Any,
    slides: Sequence[Friction],
    holds: bool,
) -> LoadCurve:
    """Torque [N m] and reduced inertia [kg m^2] by the angle of cam or crank. Raises NoAnswer as the stage ``dynamics`` does.

    torque: what the shaft is asked for (n,) [N m]; slides: friction in slides; holds: whether the cam holds the follower from both sides
    """
    there = lru_cache(maxsize=1)(solved)  # load and guide are needed at the same angles

    def load(angles: Angles) -> np.ndarray:
        kinematics, forces = there(angles)
        return np.array([torque(forces), loading.inertia(kinematics, 1)[0]])

    def at(switch: Switch) -> Callable[[Angles], np.ndarray]:
        return lambda angles: switch(*there(angles))

    return load_curve(load, program, *(at(switch) for switch in switches_of(loading, slides, holds)), even_at_rest=True)


def switches_of(loading: Loading, slides: Sequence[Friction], holds: bool) -> list[Switch]:
    """Where the sign of one of these (n,) changes, friction breaks the torque: of what a slide that rubs carries; and of what tells which
    flank carries, for with another one friction in the guide grows otherwise."""

    def rubbing(friction: Friction, edge: int) -> Switch:
        def force(kinematics: Kinematics, forces: Forces) -> np.ndarray:
            share = dynamics.carried(kinematics, forces, friction)[edge]
            return np.asarray(share * np.abs(kinematics.motion.velocity_sign))

        return force

    found = [rubbing(f, edge) for f in slides for edge in range(2 if f.length else 1)]
    return [*found, lambda kinematics, forces: forces.carrying] if holds and loading.frictions else found


# -- results of the stages, remembered by the parts of the design that they depend on ---------------------------


KEPT = 24  # results of each kind that are kept, so that undo computes nothing
evaluations: Counter[str] = Counter()
"""How often each stage was really computed; tests read it."""


class Memory:
    """Results by kind and by a key that names all they depend on; of each kind the last ``KEPT`` used are kept.

    Whoever gets a result shares it with others, so its arrays are read-only. ``computed`` counts those made, by kind.
    """

    def __init__(self) -> None:
        self._kept: defaultdict[Hashable, OrderedDict[Hashable, Any]] = defaultdict(OrderedDict)
        self.computed: Counter[Hashable] = Counter()

    def get(self, kind: Hashable, key: Hashable, compute: Callable[[], Any]) -> Any:
        """The result of this kind and key, computed where it is not kept."""
        kept = self._kept[kind]
        try:
            value = kept[key]
            kept.move_to_end(key)
            return value
        except KeyError:  # not computed yet, or forgotten by another thread just now
            self.computed[kind] += 1
        value = kept[key] = locked(compute())
        if len(kept) > KEPT:
            kept.popitem(last=False)
        return value

    def has(self, kind: Hashable, key: Hashable) -> bool:
        """Whether the result of this kind and key is kept."""
        return key in self._kept[kind]

    def clear(self) -> None:
        """Forget all results."""
        self._kept.clear()
        self.computed.clear()


memory = Memory()


def clear_caches() -> None:
    """Forget every result and count."""
    memory.clear()
    program.cache_clear()
    evaluations.clear()


def grid(motion: Any, samples: int) -> Angles:
    """Equally spaced cam angles over one turn, the same object for the same question."""

    def compute() -> Angles:
        return program(motion).angles(np.deg2rad(motion_degrees(samples)), kept=True)

    return memory.get("grid", (motion, samples), compute)


def crank_grid(driver_ranges: DriverRanges, samples: int) -> Angles:
    """Equally spaced driver angles over one turn, as far as the linkage can be assembled there."""
    run = CrankMotion(driver_ranges)
    return memory.get("grid", (driver_ranges, samples), lambda: run.angles(np.deg2rad(run.degrees(samples)), kept=True))


def cut_grid(cut: CutProgram, at: np.ndarray) -> Angles:
    """The angles [deg] (n,) of a turn that is cut, the same object for the same question."""
    return memory.get("grid", (cut, at.size), lambda: cut.angles(np.deg2rad(at), kept=True))


def crank_state(driver_ranges: DriverRanges, angles: Angles) -> MotionState:
    """The crank's own angle in place of a motion."""

    def compute() -> MotionState:
        return CrankMotion(driver_ranges).state(angles)

    return memory.get("crank", (driver_ranges, angles), compute) if angles.kept else compute()


# -- the angles at which the torque of a study jumps or breaks, but for the joins of its motion -----------------


def cuts(
    loading: Loading, driven: Any, uncut: Any, mechanism: Mechanism, course_of: Callable[[], DriverRanges]
) -> tuple[float, ...]:
    """Angles [rad] in rising order at which a process force switches, and at which friction turns round in a pin; none where the
    mechanism cannot be solved, which its own stage says. driven: the motion, or a crank's ranges; uncut: its program."""
    try:
        switches = memory.get("switches", (driven, loading.switches), lambda: tuple(loading.cuts(uncut).tolist()))
        pairs = tuple(friction.pair for friction in loading.frictions)
        key = (driven, mechanism, pairs)
        back = memory.get("turning back", key, lambda: _turning_back(pairs, uncut, mechanism, course_of))
    except NoAnswer:
        return ()
    return tuple(sorted({*switches, *back}))


def _turning_back(
    pairs: tuple[str, ...], uncut: Any, mechanism: Mechanism, course_of: Callable[[], DriverRanges]
) -> tuple[float, ...]:
    """Angles [rad] at which one of these pairs slips the other way."""
    if not pairs:
        return ()
    angles, driver_ranges = piecewise_angles(uncut), course_of()
    sampled = solve_mechanism(mechanism, uncut.state(angles), driver_ranges)
    turning = [name for name in pairs if name != sampled.driver_name]
    if not turning:
        return ()

    def slips(kinematics: Kinematics) -> np.ndarray:
        return np.array([spread(kinematics.slip(name), kinematics.theta.size) for name in turning])

    def slip(at: Angles) -> np.ndarray:
        return slips(solve_mechanism(mechanism, uncut.state(at), driver_ranges))

    return tuple(crossings(slip, angles, slips(sampled)).theta.tolist())


# -- where there is no answer: by bisection, so that it does not depend on a sampling ---------------------------

MOST = 1000  # angles that are tried; motions of many more pieces are sampled more coarsely
_PARTS = np.linspace(0.0, 1.0, 9)[1:-1, None]  # of the interval between an angle that fails and one that does not


def failing_ranges(study_at: Callable[[Angles], Any], stage: str, program: Program) -> list[tuple[float, float]]:
    """Ranges of cam angles [deg] at which the stage raises NoAnswer; study_at gives the study at any cam angles."""
    angles = piecewise_angles(program)
    step = max(1, angles.theta.size // MOST)
    theta, piece = angles.theta[::step], angles.piece[::step]
    bad = _failing(study_at, stage, theta, piece)
    first, after = np.flatnonzero(np.diff(bad, prepend=False, append=False)).reshape(-1, 2).T
    ends = np.array([first, after - 1])  # of each range: the first and the last sample that fails
    beyond = np.clip([first - 1, after], 0, theta.size - 1)
    found = theta[ends]
    inner = (piece[beyond] == piece[ends]) & ~bad[beyond]
    found[inner] = _edges(study_at, stage, theta[beyond[inner]], theta[ends[inner]], piece[ends[inner]])
    return [(degrees(begin), degrees(end)) for begin, end in found.T]


def _edges(
    study_at: Callable[[Angles], Any], stage: str, good: np.ndarray, bad: np.ndarray, piece: np.ndarray
) -> np.ndarray:
    """The last angles (m,) [rad] that fail, next to ones that do not, between angles (m,) that do not and that do: each interval is cut
    into many parts at a time, since many angles cost hardly more than one."""
    columns = np.arange(good.size)
    while good.size:
        theta = good + (bad - good) * _PARTS
        if not ((theta != good) & (theta != bad)).any():
            break
        fails = _failing(study_at, stage, theta.ravel(), np.tile(piece, len(_PARTS))).reshape(theta.shape)
        theta = np.vstack((good, theta, bad))
        at = np.where(fails.any(axis=0), fails.argmax(axis=0), len(_PARTS))  # the last part before the first that fails
        good, bad = theta[at, columns], theta[at + 1, columns]
    return bad


def _failing(study_at: Callable[[Angles], Any], stage: str, theta: np.ndarray, piece: np.ndarray) -> np.ndarray:
    """At which angles (n,) [rad], each in its piece (n,), the stage raises NoAnswer."""
    bad, rest = np.zeros(theta.size, dtype=bool), np.argsort(theta, kind="stable")
    while rest.size:
        try:
            getattr(study_at(Angles(theta[rest], piece[rest])), stage)
            break
        except NoAnswer as error:
            at = np.rad2deg(theta[rest])
            named = [(low <= at) & (at <= high) for low, high in error.cam_angles]
            failed = np.any(named, axis=0) if named else np.ones(rest.size, dtype=bool)
            if rest.size > 1 and not (named and failed.any()):  # it does not say where: each angle by itself
                failed = np.array([_failing(study_at, stage, theta[[i]], piece[[i]])[0] for i in rest])
                bad[rest[failed]] = True
                break
            bad[rest[failed]] = True
            rest = rest[~failed]
    return bad
