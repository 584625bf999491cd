"""Results of a study's stages, cached by the parts of the design they depend on."""

from __future__ import annotations

from collections import Counter, OrderedDict, defaultdict
from collections.abc import Callable, Hashable, Sequence
from functools import lru_cache
from math import degrees
from typing import TYPE_CHECKING, Any

import numpy as np

from core import dynamics
from core.dynamics import Forces, Friction, Loading
from core.errors import NoSolution
from core.mechanism import CrankMotion, DriverRanges, Mechanism, solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, CompiledMotion, MotionState, program
from core.motion import degrees as motion_degrees
from core.motion.extremes import crossings, piecewise_angles
from core.motion.program import SubdividedTurn
from core.numerics.derivatives import spread
from core.numerics.lazy import locked
from core.shaft import LoadCurve, load_curve
from core.shaft.curve import FEW_AT_REST, uncut_panels

if TYPE_CHECKING:
    from core.spatial import Machine

# -- load on the shaft, fitted between the angles at which it breaks ---------------------------------------------


Switch = Callable[[Kinematics, Forces], np.ndarray]


def fit_load_curve(
    solve: Callable[[Angles], tuple[Kinematics, Forces]],
    torque: Callable[[Forces], np.ndarray],
    loading: Loading,
    program: Any,
    slides: Sequence[Friction],
    is_form_closed: bool,
) -> LoadCurve:
    """Torque [N m] and reduced inertia [kg m²] of a drive over one turn of its cam or crank, as polynomials.

    Parameters
    ----------
    solve : callable
        Kinematics and forces at given angles.
    torque : callable
        Torque on the shaft, ndarray (n,) [N m], of these forces.
    loading : Loading
    program : CompiledMotion or CrankMotion
        Pieces of the turn.
    slides : sequence of Friction
        Friction of the sliding pairs.
    is_form_closed : bool
        Whether the cam holds the follower from both sides.

    Returns
    -------
    LoadCurve

    Raises
    ------
    NoSolution
        Where the stage ``dynamics`` has no solution.
    """
    solved = lru_cache(maxsize=1)(solve)  # load and switches are needed at the same angles

    def load(angles: Angles) -> np.ndarray:
        kinematics, forces = solved(angles)
        return np.array([torque(forces), loading.inertia(kinematics, 1)[0]])

    def at_angles(switch: Switch) -> Callable[[Angles], np.ndarray]:
        return lambda angles: switch(*solved(angles))

    switches = map(at_angles, friction_switches(loading, slides, is_form_closed))
    return load_curve(load, program, *switches, even_at_rest=True)


def load_nodes(program: Any) -> Angles:
    """Angles at which the load of a drive is first solved; equal programs return the same object."""
    return uncut_panels(program, FEW_AT_REST)[2]


def friction_switches(loading: Loading, slides: Sequence[Friction], is_form_closed: bool) -> list[Switch]:
    """Functions (n,) whose change of sign breaks the torque by friction.

    These are the normal forces of sliding pairs that rub, and, with a form-closed cam, the force that decides which flank is
    in contact: a change of flank changes the friction in the guide.
    """

    def normal_force(friction: Friction, edge: int) -> Switch:
        def force(kinematics: Kinematics, forces: Forces) -> np.ndarray:
            share = dynamics.edge_forces(kinematics, forces, friction)[edge]
            return np.asarray(share * np.abs(kinematics.motion.velocity_sign))

        return force

    switches = [normal_force(f, edge) for f in slides for edge in range(2 if f.length else 1)]
    if is_form_closed and loading.frictions:
        switches.append(lambda kinematics, forces: forces.signed_contact)
    return switches


# -- cached results ---------------------------------------------------------------------------------------------


MAX_RESULTS = 24  # results of each kind that are cached, so that undo computes nothing
MAX_SEARCHED = 16  # at angles of searches, whose extremes are cached: the drives of a shaft
SEARCHED = "searched"
evaluations: Counter[str] = Counter()
"""Stage -> number of its evaluations; tests read it."""


def is_searched(kind: Hashable) -> bool:
    """Whether results of a kind are those at angles of searches."""
    return isinstance(kind, tuple) and kind[-1] == SEARCHED


class Memory:
    """Results by kind and by a key that names all they depend on; of each kind the last ``MAX_RESULTS`` used are cached.

    Results are shared, so their arrays are read-only. ``computed`` counts evaluations by kind.
    """

    def __init__(self) -> None:
        self._cached: defaultdict[Hashable, OrderedDict[Hashable, Any]] = defaultdict(OrderedDict)
        self.computed: Counter[Hashable] = Counter()

    def get(self, kind: Hashable, key: Hashable, compute: Callable[[], Any], is_locked: bool = False) -> Any:
        """Result of this kind and key, computed where it is not cached; ``is_locked``: it is read-only already."""
        cached = self._cached[kind]
        try:
            value = cached[key]
            cached.move_to_end(key)
            return value
        except KeyError:  # not computed yet, or removed by another thread just now
            self.computed[kind] += 1
        value = cached[key] = compute() if is_locked else locked(compute())
        if len(cached) > (MAX_SEARCHED if is_searched(kind) else MAX_RESULTS):
            cached.popitem(last=False)
        return value

    def has(self, kind: Hashable, key: Hashable) -> bool:
        """Whether the result of this kind and key is cached."""
        return key in self._cached[kind]

    def clear(self) -> None:
        """Remove all results and counts."""
        self._cached.clear()
        self.computed.clear()


memory = Memory()


def clear_caches() -> None:
    """Remove every cached result and count of all studies."""
    memory.clear()
    program.cache_clear()
    evaluations.clear()


# -- angles -----------------------------------------------------------------------------------------------------


def grid(motion: Any, samples: int) -> Angles:
    """Equally spaced cam angles over one turn; equal arguments return the same object."""

    def compute() -> Angles:
        return program(motion).angles(np.deg2rad(motion_degrees(samples)), cached=True)

    return memory.get("grid", (motion, samples), compute)


def crank_grid(driver_ranges: DriverRanges, samples: int) -> Angles:
    """Equally spaced driver angles over one turn, as far as the linkage can be assembled; cached as by `grid`."""

    def compute() -> Angles:
        crank = CrankMotion(driver_ranges)
        return crank.angles(np.deg2rad(crank.degrees(samples)), cached=True)

    return memory.get("grid", (_crank_key(driver_ranges), samples), compute)


def _crank_key(driver_ranges: DriverRanges) -> Hashable:
    """All on which the motion of a crank depends: linkages that turn fully share their angles."""
    return driver_ranges.ranges, driver_ranges.is_swinging, driver_ranges.turns, driver_ranges.motions


def cut_grid(cut: SubdividedTurn, at_degrees: np.ndarray) -> Angles:
    """Angles of a turn that is cut into further pieces; equal arguments return the same object.

    Parameters
    ----------
    cut : SubdividedTurn
    at_degrees : ndarray (n,) [deg]
        Equally spaced; their number is the key of the cache.

    Returns
    -------
    Angles (n,)
    """
    return memory.get("grid", (cut, at_degrees.size), lambda: cut.angles(np.deg2rad(at_degrees), cached=True))


def crank_state(driver_ranges: DriverRanges, angles: Angles) -> MotionState:
    """State of the driver where a crank drives: its angle takes the role of the motion."""

    def compute() -> MotionState:
        return CrankMotion(driver_ranges).state(angles)

    return memory.get("crank", (_crank_key(driver_ranges), angles), compute) if angles.cached else compute()


# -- angles at which the torque jumps or breaks, except the joins of the motion ----------------------------------


def torque_breaks(
    loading: Loading, driver: Any, uncut: Any, mechanism: Mechanism, driver_ranges: Callable[[], DriverRanges]
) -> tuple[float, ...]:
    """Cam angles [rad], rising, at which a process force switches or the friction in a pin reverses.

    Parameters
    ----------
    loading : Loading
    driver : Motion or DriverRanges
        The motion, or the ranges of a crank: key of the cache.
    uncut : CompiledMotion or CrankMotion
        The program of the driver without these angles.
    mechanism : Mechanism
    driver_ranges : callable
        Ranges of the driver, evaluated where a pin rubs.

    Returns
    -------
    tuple of float [rad]
        Empty where the mechanism cannot be solved; the stage ``linkage`` reports that.
    """
    try:
        switches = memory.get("switches", (driver, loading.switches), lambda: tuple(loading.cuts(uncut).tolist()))
        pairs = tuple(friction.pair for friction in loading.frictions)
        key = (driver, mechanism, pairs)
        reversals = memory.get("turning back", key, lambda: _reversals(pairs, uncut, mechanism, driver_ranges))
    except NoSolution:
        return ()
    return tuple(sorted({*switches, *reversals}))


def roller_handovers(machine: Machine, motion: Any) -> tuple[float, ...]:
    """Cam angles [rad], rising, at which a roller of a turret enters or leaves the blank, or its neighbour takes over."""
    from core.spatial import handover_angles  # imported here to save start-up time

    def compute() -> tuple[float, ...]:
        uncut = program(motion)
        angles = piecewise_angles(uncut)
        y, pitch = uncut.state(angles).displacement[0], machine.pitch
        steps = np.arange(np.floor(y.min() / pitch) - 1.0, np.ceil(y.max() / pitch) + 1.0)
        levels = (steps[:, None] * pitch + np.array(handover_angles(machine))).ravel()

        def distances(angles: Angles) -> np.ndarray:
            return spread(uncut.state(angles).displacement[0], angles.theta.size) - levels[:, None]

        return tuple(sorted(set(crossings(distances, angles, distances(angles)).theta.tolist())))

    result: tuple[float, ...] = memory.get("handovers", (machine, motion), compute)
    return result


def _reversals(
    pairs: tuple[str, ...], uncut: Any, mechanism: Mechanism, driver_ranges: Callable[[], DriverRanges]
) -> tuple[float, ...]:
    """Angles [rad] at which the slip of a pair changes its sign; the driver's pair never reverses."""
    if not pairs:
        return ()
    angles, ranges = piecewise_angles(uncut), driver_ranges()
    sampled = solve_mechanism(mechanism, uncut.state(angles), ranges)
    reversing = [name for name in pairs if name != sampled.driver_name]
    if not reversing:
        return ()

    def slips(kinematics: Kinematics) -> np.ndarray:
        return np.array([spread(kinematics.slip(name), kinematics.theta.size) for name in reversing])

    def slips_at(angles: Angles) -> np.ndarray:
        return slips(solve_mechanism(mechanism, uncut.state(angles), ranges))

    return tuple(crossings(slips_at, angles, slips(sampled)).theta.tolist())


# -- ranges without a solution: by bisection, so that they do not depend on the sampling -------------------------

MAX_ANGLES = 1000  # programs of more angles are sampled more coarsely
_PARTS = np.linspace(0.0, 1.0, 9)[1:-1, None]  # of the interval between an angle that fails and one that does not


def failing_ranges(study_at: Callable[[Angles], Any], stage: str, program: CompiledMotion) -> list[tuple[float, float]]:
    """Ranges of cam angles [deg] at which a stage raises NoSolution.

    Parameters
    ----------
    study_at : callable
        The study at given angles.
    stage : str
    program : CompiledMotion
        Pieces of the turn.

    Returns
    -------
    list of (float, float) [deg]
    """
    angles = piecewise_angles(program)
    step = max(1, angles.theta.size // MAX_ANGLES)
    theta, piece = angles.theta[::step], angles.piece[::step]
    fails = _fails(study_at, stage, theta, piece)
    first, after = np.flatnonzero(np.diff(fails, prepend=False, append=False)).reshape(-1, 2).T
    ends = np.array([first, after - 1])  # of each range: the first and the last sample that fails
    outside = np.clip([first - 1, after], 0, theta.size - 1)
    ranges = theta[ends]
    inner = (piece[outside] == piece[ends]) & ~fails[outside]
    ranges[inner] = _edges(study_at, stage, theta[outside[inner]], theta[ends[inner]], piece[ends[inner]])
    return [(degrees(begin), degrees(end)) for begin, end in ranges.T]


def _edges(
    study_at: Callable[[Angles], Any], stage: str, good: np.ndarray, bad: np.ndarray, piece: np.ndarray
) -> np.ndarray:
    """Last failing angles (m,) [rad] between angles (m,) that do not fail and angles (m,) that do.

    Each interval is cut into several parts at a time, since many angles cost hardly more than one.
    """
    columns = np.arange(good.size)
    while good.size:
        theta = good + (bad - good) * _PARTS
        if not ((theta != good) & (theta != bad)).any():
            break
        fails = _fails(study_at, stage, theta.ravel(), np.tile(piece, len(_PARTS))).reshape(theta.shape)
        theta = np.vstack((good, theta, bad))
        at = np.where(fails.any(axis=0), fails.argmax(axis=0), len(_PARTS))  # the last part before the first that fails
        good, bad = theta[at, columns], theta[at + 1, columns]
    return bad


def _fails(study_at: Callable[[Angles], Any], stage: str, theta: np.ndarray, piece: np.ndarray) -> np.ndarray:
    """Mask (n,) of the angles (n,) [rad], each in its piece (n,), at which the stage raises NoSolution."""
    fails, rest = np.zeros(theta.size, dtype=bool), np.argsort(theta, kind="stable")
    while rest.size:
        try:
            getattr(study_at(Angles(theta[rest], piece[rest])), stage)
            break
        except NoSolution as error:
            at = np.rad2deg(theta[rest])
            in_ranges = [(low <= at) & (at <= high) for low, high in error.cam_angles]
            failed = np.any(in_ranges, axis=0) if in_ranges else np.ones(rest.size, dtype=bool)
            if rest.size > 1 and not (in_ranges and failed.any()):  # the error names no angle: evaluate them one by one
                failed = np.array([_fails(study_at, stage, theta[[i]], piece[[i]])[0] for i in rest])
                fails[rest[failed]] = True
                break
            fails[rest[failed]] = True
            rest = rest[~failed]
    return fails
