"""The stages as cached functions of only the parts they need: their arguments are their dependencies."""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Callable, Hashable
from functools import lru_cache, wraps
from typing import TYPE_CHECKING, Any

import numpy as np

from core.cam import CamShape, envelope
from core.design import Elastic, Follower, Linkage, Motion, si
from core.dynamics import Forces, Loading, loading_of, newton_euler
from core.errors import NoStability
from core.instant_centres import CentreTable, all_centres
from core.mechanism import Course, CrankProgram, Mechanism, solve_mechanism, unit_speed_kinematics
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, MotionState, degrees, program
from core.numerics.lazy import locked

if TYPE_CHECKING:  # a rigid shaft needs nothing of it
    from core.stability import Coefficients, Stability

KEPT = 24  # results of a stage that are kept, so that undo computes nothing
evaluations: Counter[str] = Counter()
"""How often each stage was really computed; tests read it."""

_caches: list[Any] = []


def remembered(function: Callable[..., Any]) -> Any:
    """An lru_cache that ``clear_caches`` knows; whoever gets a result shares it with others, so none may change it."""

    @wraps(function)
    def locking(*parts: Any) -> Any:
        return locked(function(*parts))

    cached = lru_cache(maxsize=KEPT)(locking)
    _caches.append(cached)
    return cached


def stage(name: str) -> Callable[[Callable[..., Any]], Any]:
    """A counted, remembered stage. ``.__wrapped__`` computes without remembering, for passing cam angles."""

    def wrap(function: Callable[..., Any]) -> Any:
        @wraps(function)
        def counted(*parts: Any) -> Any:
            evaluations[name] += 1
            return function(*parts)

        return remembered(counted)

    return wrap


def clear_caches() -> None:
    """Forget every result and count."""
    for cached in _caches:
        cached.cache_clear()
    program.cache_clear()
    evaluations.clear()


@remembered
def grid(motion: Motion, samples: int) -> Angles:
    """Equally spaced cam angles over one turn, the same object for the same question."""
    return program(motion).angles(np.deg2rad(degrees(samples)), kept=True)


@stage("motion")
def motion_stage(motion: Motion, angles: Angles) -> MotionState:
    return program(motion).state(angles)


@remembered
def crank_grid(course: Course, samples: int) -> Angles:
    """Equally spaced driver angles over one turn, as far as the linkage can be assembled there."""
    run = CrankProgram(course)
    return run.angles(np.deg2rad(run.degrees(samples)), kept=True)


@remembered
def crank_state(course: Course, angles: Angles) -> MotionState:
    return CrankProgram(course).state(angles)


@stage("linkage")
def linkage_stage(mechanism: Mechanism, course: Course, state: MotionState) -> Kinematics:
    return solve_mechanism(mechanism, state, course)


@stage("centres")
def centres_stage(linkage: Linkage, course: Course, state: MotionState) -> CentreTable:
    """By the driver's own coordinate, so that a dwell of the motion has centres too."""
    return all_centres(unit_speed_kinematics(linkage, state.y[0], course), course.plan.size)


@stage("cam")
def cam_stage(kinematics: Kinematics, cam: Any, sense: float) -> CamShape:
    return envelope(kinematics, cam, sense)


@stage("dynamics")
def dynamics_stage(kinematics: Kinematics, shape: CamShape | None, loading: Loading, omega: float) -> Forces:
    return newton_euler(kinematics, shape, loading, omega)


@remembered
def loading_of_drive(mechanism: Follower | Linkage, loads: Any) -> Loading:
    return loading_of(mechanism, loads)


@remembered
def shaft_coefficients(
    motion: Motion, mechanism: Mechanism, course: Course, loading: Loading, inertia: float, stiffness: float, spring: str,
    factor: float,
) -> Coefficients | NoStability:
    """Why there are none is remembered too."""
    from core.stability import coefficients

    compiled = program(motion)
    try:
        return coefficients(
            lambda angles: solve_mechanism(mechanism, compiled.state(angles), course),
            loading, compiled, inertia, stiffness, spring, factor,
        )  # fmt: skip
    except NoStability as error:
        return error


@stage("stability")
def stability_stage(
    motion: Motion, mechanism: Mechanism, course: Course, loading: Loading, cam: Any, sense: float, elastic: Elastic,
    omega: float,
) -> Stability | NoStability:
    from core.stability import stability

    s = si(elastic)
    made = shaft_coefficients(
        motion, mechanism, course, loading, s.camshaft_inertia, s.stiffness, elastic.spring, elastic.spring_factor
    )
    if isinstance(made, NoStability):
        return made
    compiled = program(motion)

    def kinematics_and_shape(angles: Angles) -> tuple[Kinematics, CamShape]:
        kinematics = solve_mechanism(mechanism, compiled.state(angles), course)
        return kinematics, envelope(kinematics, cam, sense)

    return stability(made, elastic, omega, kinematics_and_shape, loading, compiled)


class Memory:
    """Results by a key that names all they depend on; the oldest are forgotten."""

    def __init__(self, most: int = 4 * KEPT) -> None:
        self._most = most
        self._kept: OrderedDict[Hashable, Any] = OrderedDict()

    def get(self, key: Hashable, compute: Callable[[], Any]) -> Any:
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key]
        value = self._kept[key] = compute()
        if len(self._kept) > self._most:
            self._kept.popitem(last=False)
        return value

    def cache_clear(self) -> None:
        self._kept.clear()


memory = Memory()
_caches.append(memory)
