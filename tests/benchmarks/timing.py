"""Time, in a way that another machine can repeat.

Times are processor time, of which others who use the machine take none, each with one thread; the best of several runs, of
all methods in turn, so that what slows the processor down for a while slows all of them. What the best of every other round
differs by from the best of the rest is the noise of a time.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

Run = Callable[[], object]
LEAST = 2e-3  # [s] a run that takes less is repeated, and the mean taken; ...
LEAST_FRESH = 3e-4  # ... less often where it is made anew each time, which takes its own
LONG = 1.0  # [s] a run that takes more is taken once
UNKNOWN = 0.3  # noise of a time that was taken once


@dataclass(frozen=True)
class Times:
    """Best seconds of each run, by name; and by how much of itself each may differ in the next run."""

    seconds: Mapping[str, float]
    noise: Mapping[str, float]


@dataclass(frozen=True)
class Fresh:
    """A run that is made anew each time, outside the clock. ``alone``: made immediately before it, so that no other run
    comes between."""

    make: Callable[[], Run]
    alone: bool = False


def _once(run: Run | Fresh, times: int) -> float:
    runs = [run.make() for _ in range(times)] if isinstance(run, Fresh) else [run] * times
    begin = time.process_time()
    for each in runs:
        each()
    return max(time.process_time() - begin, 1e-9) / times


def measure(every: Mapping[str, Run | Fresh], seconds: float, rounds: int = 60) -> Times:
    """All runs in turn, round by round, until ``seconds`` are used up; each at least twice, if it is no long one."""
    halves: dict[str, list[float]] = {}
    repeats = {}
    collecting = gc.isenabled()
    gc.disable()
    try:
        for name, run in every.items():
            first = _once(run, 1)
            halves[name] = [first, _once(run, 1)] if first < min(max(seconds, 0.01), LONG) else [first]
            least = LEAST_FRESH if isinstance(run, Fresh) else LEAST
            alone = isinstance(run, Fresh) and run.alone
            repeats[name] = 1 if alone else max(1, min(1000, round(least / min(halves[name]))))
        share = seconds / len(every)
        for count in range(rounds):
            spent = 0.0
            for name, run in every.items():
                least = min(halves[name])
                if share > 0.0 and least * repeats[name] <= share:
                    taken = _once(run, repeats[name])
                    halves[name][count % 2] = min(halves[name][count % 2], taken)
                    spent += least * repeats[name]
            seconds -= spent
            gc.collect(1)
            if seconds <= 0.0 or not spent:
                break
    finally:
        if collecting:
            gc.enable()
    best = {name: min(told) for name, told in halves.items()}
    noise = {name: max(told) / min(told) - 1.0 if len(told) > 1 else UNKNOWN for name, told in halves.items()}
    return Times(best, noise)
