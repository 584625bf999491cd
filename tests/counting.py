"""What a run costs in counts that no busy machine changes: calls of functions, and bytes that are held at most."""

import sys
import tracemalloc
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Cost:
    """calls: of Python's and of built-in functions; peak: bytes of Python's and numpy's at most, beyond those before."""

    calls: int
    peak: int


def calls(run: Callable[[], object]) -> int:
    """How many functions a run calls."""
    count, before = 0, sys.getprofile()

    def seen(frame: Any, event: str, arg: Any) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(seen)
    try:
        run()
    finally:
        sys.setprofile(before)
    return count


def peak(run: Callable[[], object]) -> int:
    """How many bytes a run holds at most, beyond those before it."""
    already = tracemalloc.is_tracing()
    if not already:
        tracemalloc.start()
    try:
        tracemalloc.reset_peak()
        before, _ = tracemalloc.get_traced_memory()
        run()
        return tracemalloc.get_traced_memory()[1] - before
    finally:
        if not already:
            tracemalloc.stop()


def cost(fresh: Callable[[], Callable[[], object]]) -> Cost:
    """Of a run that is made anew for each of the two, for counting slows counting."""
    return Cost(calls(fresh()), peak(fresh()))
