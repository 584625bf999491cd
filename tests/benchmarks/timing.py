"""Time and memory, in a way that another machine can repeat.

Times are processor time, of which others who use the machine take none, each with one thread; the best of several runs, of
all methods in turn and between them a yardstick of the same number of angles, so that what slows the processor down for a
while slows all of them. Memory is what numpy and Python held at most while the
method ran (tracemalloc), in a run of its own that is not timed; arrays that compiled code makes for itself do not count.
"""

from __future__ import annotations

import gc
import time
import tracemalloc
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

Run = Callable[[], object]
LEAST = 2e-3  # [s] a run that takes less is repeated, and the mean taken


@dataclass(frozen=True)
class Times:
    """Best seconds of each run, by name, and of the yardstick."""

    seconds: Mapping[str, float]
    yardstick: float


def yardstick(n: int) -> Run:
    """A fixed piece of arithmetic on n angles: a sine, a root, products real and complex, new arrays."""
    angle = np.linspace(0.1, 6.2, n)

    def run() -> object:
        sine = np.sin(angle)
        turned = (sine + 1j * angle) * (angle + 1j * sine)
        return np.sqrt(sine * sine + angle * angle) + turned.real * turned.imag / (1.0 + angle)

    return run


def _once(run: Run, times: int) -> float:
    begin = time.process_time()
    for _ in range(times):
        run()
    return max(time.process_time() - begin, 1e-9) / times


def measure(runs: Mapping[str, Run], n: int, seconds: float, rounds: int = 60) -> Times:
    """All runs in turn, round by round, until ``seconds`` are used up; each at least twice, slow ones as often as fits."""
    every = {"": yardstick(n), **runs}
    best, repeats = {}, {}
    collecting = gc.isenabled()
    gc.disable()
    try:
        for name, run in every.items():
            first = _once(run, 1)
            second = _once(run, 1) if first < seconds / 4 else first
            best[name] = min(first, second)
            repeats[name] = max(1, min(1000, round(LEAST / best[name])))
        share = seconds / len(every)
        for _ in range(rounds):
            for name, run in every.items():
                if share > 0.0 and best[name] * repeats[name] <= share:
                    best[name] = min(best[name], _once(run, repeats[name]))
            seconds -= sum(best[name] * repeats[name] for name in every if best[name] * repeats[name] <= share)
            if seconds <= 0.0:
                break
    finally:
        if collecting:
            gc.enable()
    return Times({name: best[name] for name in runs}, best[""])


def peak_memory(run: Run) -> float:
    """Of one run [MiB]."""
    gc.collect()
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        kept = run()
        _, peak = tracemalloc.get_traced_memory()
        del kept
    finally:
        tracemalloc.stop()
    return (peak - before) / 2**20


def ratios(times: Times, names: Sequence[str]) -> dict[str, float]:
    """Times by the yardstick."""
    return {name: times.seconds[name] / times.yardstick for name in names}
