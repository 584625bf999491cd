"""Results of the stages, remembered by the parts of the design that they depend on."""

from __future__ import annotations

from collections import Counter, OrderedDict, defaultdict
from collections.abc import Callable, Hashable
from typing import Any

import numpy as np

from core.mechanism import CrankProgram, DriverRanges
from core.motion import Angles, MotionState, degrees, program
from core.motion.cuts import CutProgram
from core.numerics.lazy import locked

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
        return program(motion).angles(np.deg2rad(degrees(samples)), kept=True)

    return memory.get("grid", (motion, samples), compute)


def crank_grid(driver_ranges: DriverRanges, samples: int) -> Angles:
    """Equally spaced driver angles over one turn, as far as the linkage can be assembled there."""
    run = CrankProgram(driver_ranges)
    return memory.get("grid", (driver_ranges, samples), lambda: run.angles(np.deg2rad(run.degrees(samples)), kept=True))


def cut_grid(cut: CutProgram, at: np.ndarray) -> Angles:
    """The angles [deg] (n,) of a turn that is cut, the same object for the same question."""
    return memory.get("grid", (cut, at.size), lambda: cut.angles(np.deg2rad(at), kept=True))


def crank_state(driver_ranges: DriverRanges, angles: Angles) -> MotionState:
    """The crank's own angle in place of a motion."""

    def compute() -> MotionState:
        return CrankProgram(driver_ranges).state(angles)

    return memory.get("crank", (driver_ranges, angles), compute) if angles.kept else compute()
