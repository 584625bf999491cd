"""The stages as cached functions of only the parts they need: their arguments are their dependencies."""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Callable, Hashable
from functools import lru_cache, wraps
from typing import TYPE_CHECKING, Any

import numpy as np

from core.cam import CamShape, envelope
from core.design import Cam, Elastic, Follower, Loads, Motion, si
from core.dynamics import Forces, Loading, loading_of, newton_euler
from core.errors import NoStability
from core.followers import built
from core.keeping import locked
from core.mechanism.assembly import solve_mechanism
from core.motion import Angles, MotionState, degrees, program
from core.train import Train

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


@stage("linkage")
def linkage_stage(follower: Follower, reach: float, motion: MotionState) -> Train:
    return solve_mechanism(built(follower, reach), motion)


@stage("cam")
def cam_stage(train: Train, cam: Cam, sense: float) -> CamShape:
    return envelope(train, cam, sense)


@stage("dynamics")
def dynamics_stage(train: Train, shape: CamShape | None, loading: Loading, omega: float) -> Forces:
    return newton_euler(train, shape, loading, omega)


@remembered
def shaft_coefficients(
    motion: Motion, follower: Follower, reach: float, loads: Loads, inertia: float, stiffness: float, spring: str, factor: float
) -> Coefficients | NoStability:
    """Why there are none is remembered too."""
    from core.stability import coefficients

    compiled = program(motion)
    try:
        return coefficients(
            lambda angles: solve_mechanism(built(follower, reach), compiled.state(angles)),
            loading(follower, loads), compiled, inertia, stiffness, spring, factor,
        )  # fmt: skip
    except NoStability as error:
        return error


@stage("stability")
def stability_stage(
    motion: Motion, follower: Follower, reach: float, loads: Loads, cam: Cam, sense: float, elastic: Elastic, omega: float
) -> Stability | NoStability:
    from core.stability import stability

    s = si(elastic)
    made = shaft_coefficients(
        motion, follower, reach, loads, s.camshaft_inertia, s.stiffness, elastic.spring, elastic.spring_factor
    )
    if isinstance(made, NoStability):
        return made
    compiled = program(motion)

    def train_and_shape(angles: Angles) -> tuple[Train, CamShape]:
        train = solve_mechanism(built(follower, reach), compiled.state(angles))
        return train, envelope(train, cam, sense)

    return stability(made, elastic, omega, train_and_shape, loading(follower, loads), compiled)


@remembered
def loading(follower: Follower, loads: Loads) -> Loading:
    return loading_of(follower, loads)


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
