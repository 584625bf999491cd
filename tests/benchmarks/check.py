"""``make bench-check``: our own times by the yardstick of the same run, against the limits in limits.json."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from benchmarks.table import Kernel, kernels
from benchmarks.timing import Fresh, measure

from core.process import keep_freed_memory
from core.project.files import write_all

FILE = Path(__file__).with_name("limits.json")
WORSE = 1.3  # times a limit that is too much
TRIES = 6
SECONDS = 0.4  # for one kernel at one size
ROUNDS = 7  # of the window

Limits = Mapping[str, float]


def keys() -> dict[str, Callable[[], float]]:
    """What is checked, ``linkage 3600``, and how it is looked at: every kernel, and the window."""
    made = {f"{k.name} {n}": (lambda k=k, n=n: look(k, n)) for k in kernels() for n in k.sizes}
    return {**made, **windows()}


def windows() -> dict[str, Callable[[], float]]:
    """Edits, drags and frames with twelve plots by a bare repaint; one measurement serves each of them once."""
    from benchmarks import window

    known: dict[str, float] = {}

    def told(name: str) -> float:
        if name not in known:
            rows = window.measure(ROUNDS, (window.MANY,), more=False)
            bare = {row.kernel: row.seconds for row in rows if row.method == window.BARE}
            known.update({f"{r.kernel}: {r.method}": r.seconds / bare[r.kernel] for r in rows})
        return known.pop(name)

    return {name: (lambda name=name: told(name)) for name in window.names()}


def look(kernel: Kernel, n: int, seconds: float = SECONDS) -> float:
    """Time of our method, with all that may be kept, by that of the yardstick."""
    there, setting = kernel.given(kernel.grid(n)), kernel.ours.settings[0]
    run = Fresh(lambda: partial(kernel.ours.cold, kernel.again(there), setting))
    told = measure({"ours": run}, max(n, 360), seconds)
    return told.seconds["ours"] / told.yardstick


def failing(limits: Limits, told: Callable[[str], float], names: Sequence[str], tries: int = TRIES) -> dict[str, float]:
    """The best of several looks at each name that stays beyond its limit. Who is beyond is looked at again, so that a
    machine that was busy for a while fails nobody."""
    best: dict[str, float] = {}
    left = list(names)
    for _ in range(tries):
        for name in left:
            best[name] = min(best.get(name, float("inf")), told(name))
        left = [name for name in left if best[name] > WORSE * limits.get(name, 0.0)]
        if not left:
            break
    return {name: best[name] for name in left}


def taken(told: Callable[[str], float], names: Sequence[str], looks: int = 3) -> dict[str, float]:
    """New limits: the best of several looks at each name, all of them in turn, so that one measurement serves all of the window."""
    every = [{name: told(name) for name in names} for _ in range(looks)]
    return {name: round(min(found[name] for found in every), 3) for name in names}


def main(argv: Sequence[str] | None = None) -> int:
    words = argparse.ArgumentParser(prog="make bench-check", description="Fails where a kernel has become slower.")
    words.add_argument("--update", action="store_true", help="take the present times as the limits")
    words.add_argument("--only", nargs="+", metavar="NAME", help="look at these alone, as this process finds them")
    asked = words.parse_args(argv)
    keep_freed_memory()
    every = keys()

    def told(name: str) -> float:
        value = every[name]()
        print(f"{name}: {value:.2f} yardsticks", flush=True)
        return value

    if asked.update:
        write_all(FILE.parent, {FILE.name: json.dumps(taken(told, list(every)), indent=1) + "\n"})
        return 0
    limits = json.loads(FILE.read_text(encoding="utf-8"))
    slow = failing(limits, told, asked.only or list(every))
    if slow and not asked.only:  # where memory lies may slow a whole process: another one shall say the same
        again = [sys.executable, str(FILE.with_name("run.py")), "--check", "--only", *slow]
        return subprocess.run(again, check=False).returncode
    for name, value in slow.items():
        limit = limits.get(name)
        was = "has no limit" if limit is None else f"was {limit:.2f}, {value / limit - 1.0:.0%} slower"
        print(f"SLOWER: {name}: {value:.2f} yardsticks, {was}")
    stale = sorted(set(limits) - set(every))
    for name in stale:
        print(f"limits.json: {name} is no longer measured; make bench-check ARGS=--update")
    return 1 if slow or stale else 0
