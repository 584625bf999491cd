"""The run of ``make bench``: every method of every kernel with each of its settings, warm and cold, as rows of one table."""

from __future__ import annotations

import argparse
import csv
import io
import math
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import astuple, dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from benchmarks.table import Kernel, Method, forget, kernels
from benchmarks.timing import Fresh, Run, measure

from core.process import keep_freed_memory
from core.project.files import write_all

ROOT = Path(__file__).parents[2]
OUT, HELP, PICTURE = ROOT / "out" / "bench", ROOT / "resources" / "help", "speed.png"
T = TypeVar("T")
WARM, COLD = "warm", "cold"


@dataclass(frozen=True)
class Row:
    """One line of the CSV; in the window the time by a bare repaint too. noise: by how much of itself the time
    may differ in another run."""

    kernel: str
    method: str
    n: int
    seconds: float
    error: float
    setting: str
    times_bare: float = math.nan
    note: str = ""
    regime: str = WARM
    noise: float = 0.0


WINDOW = (  # kernels of the window, which window.py measures
    "edit to paint", "edit to paint, by one without a pin",
    "drag to paint", "animation", "tables to paint, after a pause", "edit to paint, six-bar",
    "drag to paint, six-bar", "drag to paint, eight-bar",
    "animation, six-bar", "animation, six-bar at 1920 x 1080", "animation, several drives", "start",
)  # fmt: skip


@dataclass(frozen=True)
class Plan:
    """How long and how much: seconds for a method, and how many of its settings."""

    usual: float = 0.04
    settings: int = 99
    rounds: int = 9  # of the window
    starts: int = 5  # of processes
    targets: float = 1.5  # seconds for those of kernels
    large: bool = True  # exports of millions of angles


FULL = Plan()
QUICK = Plan(
    usual=0.03, settings=1, rounds=3, starts=1, targets=0.3, large=False,
)  # fmt: skip


def _text(setting: Any) -> str:
    """Numbers only: what else a setting holds stands in the method's name."""
    numbers = setting if isinstance(setting, tuple) else (setting,)
    return ", ".join(f"{number:g}" for number in numbers if isinstance(number, int | float))


def warm_run(kernel: Kernel, method: Method, there: Any, setting: Any) -> Run | Fresh:
    """With what may be kept; ours each time on what nobody has read yet, the others on what lies there read."""
    kept = method.kept(there, setting)
    if not method.ours:
        return partial(method.solve, there, kept)
    return Fresh(lambda: partial(method.solve, kernel.again(there), kept))


def cold_run(kernel: Kernel, method: Method, there: Any, setting: Any) -> Run | Fresh:
    """The same with nothing kept: whatever is kept is made within the time."""
    if not method.ours:
        return partial(method.cold, there, setting)

    def make() -> Run:
        given = kernel.again(there)
        forget()
        return partial(method.cold, given, setting)

    return Fresh(make, alone=True)


def once(run: Run | Fresh) -> object:
    return run.make()() if isinstance(run, Fresh) else run()


def of_kernel(kernel: Kernel, plan: Plan) -> Iterator[Row]:
    """Every method with each of its settings, warm and cold: time and true error. A method that keeps nothing is the same
    in both."""
    there = kernel.again(kernel.given(kernel.grid(kernel.usual)))
    told = [(m, s) for m in kernel.methods if not m.lacks for s in m.settings[: plan.settings]]
    runs = {}
    for i, (method, setting) in enumerate(told):
        runs[f"{WARM} {i}"] = warm_run(kernel, method, there, setting)
        if method.ours or method.keeps:
            runs[f"{COLD} {i}"] = cold_run(kernel, method, there, setting)
        once(runs[f"{WARM} {i}"])  # compile, import, fill caches
    times = measure(runs, plan.usual * len(runs))
    for i, (method, setting) in enumerate(told):
        error = kernel.error(method, setting)
        for regime in (WARM, COLD):
            name = f"{regime} {i}" if f"{regime} {i}" in runs else f"{WARM} {i}"
            seconds = times.seconds[name]
            row = kernel.name, method.name, kernel.usual, seconds, error, _text(setting)
            yield Row(*row, regime=regime, noise=times.noise[name])
    for method in (m for m in kernel.methods if m.lacks):
        nan, note = math.nan, f"{method.lacks} is not installed"
        yield Row(kernel.name, method.name, kernel.usual, nan, nan, "", note=note)


def _told(what: str, run: Callable[[], list[T]]) -> list[T]:
    """What comes of a run, and how long it took."""
    began = time.perf_counter()
    made = run()
    print(f"{what}: {time.perf_counter() - began:.1f} s", flush=True)
    return made


def measured(plan: Plan) -> list[Row]:
    keep_freed_memory()  # as every study does
    return [row for kernel in kernels() for row in _told(kernel.name, lambda k=kernel: list(of_kernel(k, plan)))]


def in_the_window(plan: Plan) -> list[Row]:
    """Edits, drags and frames of the animation; they go by a bare repaint of the same widgets."""
    from benchmarks import window

    told = window.measure(plan.rounds) + window.starts(plan.starts)
    bare = {(row.kernel, row.n): row.seconds for row in told if row.method == window.BARE}
    return [Row(*r, math.nan, "", r.seconds / bare[r.kernel, r.n]) for r in told if r.method != window.BARE]


def as_csv(rows: Sequence[Row]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(field.name for field in fields(Row))
    for row in rows:
        writer.writerow(["" if isinstance(v, float) and math.isnan(v) else v for v in astuple(row)])
    return text.getvalue()


def main(argv: Sequence[str] | None = None) -> int:
    words = argparse.ArgumentParser(prog="make bench", description="Run time against true error.")
    words.add_argument("--quick", action="store_true", help="fewer settings")
    words.add_argument("--readme", action="store_true", help="put the table and the picture into the help")
    words.add_argument("--out", type=Path, default=OUT, help="folder")
    asked = words.parse_args(argv)
    warnings.simplefilter("ignore")  # of methods that are made to fail
    plan = QUICK if asked.quick else FULL
    rows = [*measured(plan), *_told("window", lambda: in_the_window(plan))]
    from benchmarks import picture, ratios, targets

    found = _told("targets", lambda: targets.measured(rows, plan))
    table = ratios.markdown(rows, targets.markdown(found))
    files = {"bench.csv": as_csv(rows), "targets.csv": targets.as_csv(found), "bench.md": table}
    write_all(asked.out, {**files, PICTURE: picture.picture(rows)})
    if asked.readme:
        ratios.into_page(HELP / "speed.md", table)
        write_all(HELP, {PICTURE: picture.picture(rows)})
    print(f"{table}\n{asked.out}: bench.csv, targets.csv, bench.md, {PICTURE}")
    return 0
