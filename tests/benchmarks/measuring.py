"""The run of ``make bench``: every method of every kernel at every size, as rows of one table."""

from __future__ import annotations

import argparse
import csv
import io
import math
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from benchmarks.table import Kernel, Method, forget, kernels
from benchmarks.timing import Fresh, Run, measure, peak_memory

from core.process import keep_freed_memory
from core.project.files import write_all

ROOT = Path(__file__).parents[2]
OUT = ROOT / "out" / "bench"
FEWEST = 36  # angles of an even grid; for fewer its differences mean nothing
MOST_MEMORY_RUN = 0.2  # [s] longer ones are not repeated to measure their memory, ...
MOST_MEMORY_LOOP = 0.05  # ... nor loops of Python, which take many times as long then


T = TypeVar("T")
WARM, COLD = "warm", "cold"
SMALL = -9  # power of ten: an error within which methods are compared at other sizes


@dataclass(frozen=True)
class Row:
    """One line of the CSV; times by the yardstick and by our method in its usual setting, in the same regime. noise: by how
    much of itself the time may differ in another run."""

    kernel: str
    method: str
    n: int
    seconds: float
    error: float
    peak_memory_mib: float
    setting: str
    times_yardstick: float
    times_ours: float
    note: str
    regime: str = WARM
    noise: float = 0.0


WINDOW = (  # kernels of the window, which window.py measures
    "edit to paint", "drag to paint", "animation", "tables to paint, after a pause", "edit to paint, six-bar",
    "drag to paint, six-bar", "animation, six-bar", "animation, six-bar at 1920 x 1080", "animation, several drives", "start",
)  # fmt: skip
COLUMNS = tuple(field.name for field in fields(Row))


@dataclass(frozen=True)
class Plan:
    """How long and how much: seconds for a method at the usual size, and for one at each other size; how many sizes and
    settings; the longest single run [s] that a size may be expected to take."""

    usual: float = 0.04
    growth: float = 0.03
    sizes: int = 99
    settings: int = 99
    longest: float = 0.2
    rounds: int = 9  # of the window
    starts: int = 5  # of processes
    targets: float = 1.5  # seconds for those of kernels
    large: bool = True  # exports of millions of angles


FULL = Plan()
QUICK = Plan(
    usual=0.03, growth=0.02, sizes=2, settings=1, longest=0.1, rounds=3, starts=1, targets=0.3, large=False,
)  # fmt: skip


def _text(setting: Any) -> str:
    """Numbers only: what else a setting holds stands in the method's name."""
    numbers = setting if isinstance(setting, tuple) else (setting,)
    return ", ".join(f"{number:g}" for number in numbers if isinstance(number, int | float))


def _lacking(kernel: Kernel, method: Method) -> Row:
    nan = math.nan
    return Row(kernel.name, method.name, kernel.usual, nan, nan, nan, "", nan, nan, f"{method.lacks} is not installed")


def _memory(run: Run | Fresh, seconds: float, method: Method) -> float:
    run = run.make() if isinstance(run, Fresh) else run
    return peak_memory(run) if seconds <= (MOST_MEMORY_LOOP if method.one_by_one else MOST_MEMORY_RUN) else math.nan


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


def at_usual_size(kernel: Kernel, plan: Plan) -> Iterator[Row]:
    """Every method with each of its settings, warm and cold: time and true error. A method that keeps nothing is the same
    in both."""
    there = kernel.again(kernel.given(kernel.grid(kernel.usual)))
    told = [(m, s) for m in kernel.methods if not m.lacks for s in m.settings[: plan.settings]]
    runs = {}
    for i, (method, setting) in enumerate(told):
        runs[f"{WARM} {i}"] = warm_run(kernel, method, there, setting)
        if method.ours or method.keeps:
            runs[f"{COLD} {i}"] = cold_run(kernel, method, there, setting)
        if not method.one_by_one:
            once(runs[f"{WARM} {i}"])  # compile, import, fill caches
    times = measure(runs, kernel.usual, plan.usual * len(runs))
    for i, (method, setting) in enumerate(told):
        error = kernel.error(method, setting)
        usual = setting == method.settings[0]
        memory = _memory(runs[f"{WARM} {i}"], times.seconds[f"{WARM} {i}"], method) if usual else math.nan
        for regime in (WARM, COLD):
            name = f"{regime} {i}" if f"{regime} {i}" in runs else f"{WARM} {i}"
            seconds = times.seconds[name]
            yield Row(
                kernel.name,
                method.name,
                kernel.usual,
                seconds,
                error,
                memory,
                _text(setting),
                seconds / times.yardstick,
                seconds / times.seconds[f"{regime} 0"],
                "",
                regime,
                times.noise[name],
            )
    for method in kernel.methods:
        if method.lacks:
            yield _lacking(kernel, method)


Grown = tuple[Method, Any, Row]  # a method, its setting at a size, what it took at the usual one


def _grown(kernel: Kernel, plan: Plan, usual: Sequence[Row], n: int) -> Iterator[Grown]:
    """Each method in its usual setting and in the quickest that came within a small error, as long as a run of it does not
    take too long."""
    by = n / kernel.usual
    for method in kernel.methods:
        if method.lacks or (method.on_grid and n < FEWEST):
            continue
        rows = [r for r in usual if (r.method, r.regime) == (method.name, WARM)]
        told = [
            (method, other, row)
            for row, s in zip(rows, method.settings, strict=False)
            for other in method.at_size(s, by)
        ]
        able = [t for t in told if t[2].error <= 10.0**SMALL]
        quickest = min(able, key=lambda t: t[2].seconds, default=None)
        chosen = [t for t in told if t is quickest or t[2] is rows[0]]  # the usual setting first
        yield from (t for t in chosen if method.ours or t[2].seconds * by <= plan.longest)


def growth(kernel: Kernel, plan: Plan, usual: Sequence[Row]) -> Iterator[Row]:
    """Methods at the other sizes, warm."""
    for n in [n for n in kernel.sizes[: plan.sizes] if n != kernel.usual]:
        there = kernel.again(kernel.given(kernel.grid(n)))
        told = list(_grown(kernel, plan, usual, n))
        runs = {str(i): warm_run(kernel, method, there, setting) for i, (method, setting, _) in enumerate(told)}
        times = measure(runs, n, plan.growth * len(runs))
        ours = times.seconds["0"]
        for i, (method, setting, row) in enumerate(told):
            seconds = times.seconds[str(i)]
            yield Row(
                kernel.name,
                method.name,
                n,
                seconds,
                row.error,
                _memory(runs[str(i)], seconds, method),
                _text(setting),
                seconds / times.yardstick,
                seconds / ours,
                "",
                WARM,
                times.noise[str(i)],
            )


def _told(what: str, run: Callable[[], T]) -> T:
    """What comes of a run, and how long it took."""
    began = time.perf_counter(), time.process_time()
    made = run()
    print(
        f"{what}: {time.perf_counter() - began[0]:.1f} s, {time.process_time() - began[1]:.1f} s of the processor",
        flush=True,
    )
    return made


def measured(plan: Plan) -> list[Row]:
    keep_freed_memory()  # as every study does

    def every(kernel: Kernel) -> list[Row]:
        usual = list(at_usual_size(kernel, plan))
        return [*usual, *growth(kernel, plan, usual)]

    return [row for kernel in kernels() for row in _told(kernel.name, partial(every, kernel))]


def in_the_window(plan: Plan) -> list[Row]:
    """Edits, drags and frames of the animation; their yardstick is a bare repaint of the same widgets."""
    from benchmarks import window

    told = window.measure(plan.rounds) + window.starts(plan.starts)
    bare = {(row.kernel, row.n): row.seconds for row in told if row.method == window.BARE}
    nan = math.nan
    return [
        Row(r.kernel, r.method, r.n, r.seconds, nan, nan, "", r.seconds / bare[r.kernel, r.n], nan, "")
        for r in told
        if r.method != window.BARE
    ]


def as_csv(rows: Sequence[Row]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows:
        writer.writerow(["" if isinstance(v, float) and math.isnan(v) else v for v in asdict(row).values()])
    return text.getvalue()


def main(argv: Sequence[str] | None = None) -> int:
    words = argparse.ArgumentParser(prog="make bench", description="Run time against true error.")
    words.add_argument("--quick", action="store_true", help="fewer sizes and settings, half a minute")
    words.add_argument(
        "--readme", action="store_true", help="put the table into the help, ten rows of it into README.md"
    )
    words.add_argument("--out", type=Path, default=OUT, help="folder")
    asked = words.parse_args(argv)
    warnings.simplefilter("ignore")  # of methods that are made to fail
    began = time.perf_counter()
    plan = QUICK if asked.quick else FULL
    rows = [*measured(plan), *_told("window", lambda: in_the_window(plan))]
    from benchmarks import counts, page, ratios, stress, targets

    cases = _told("stress", lambda: stress.measured(asked.quick))
    large = _told("counts", lambda: list(counts.rows()))
    found = _told("targets", lambda: targets.measured(rows, large, cases, plan))
    table, goals, bounds = ratios.markdown(rows, targets.markdown(found)), targets.as_csv(found), counts.as_csv(large)
    texts = {
        "bench.csv": as_csv(rows),
        "targets.csv": goals,
        "counts.csv": bounds,
        "stress.csv": stress.as_csv(cases),
        "bench.md": table,
    }
    write_all(asked.out, texts)
    write_all(asked.out, page.painted(rows, cases))
    if asked.readme:
        ratios.into_page(ROOT / "README.md", f"{ratios.short(rows)}{ratios.left_out(rows)}\n{ratios.noise(rows)}")
        ratios.into_page(ROOT / "resources/help/speed.md", table)
    print(table)
    print(goals)
    print(bounds)
    made = "bench.csv, bench.svg, bench.png, bench.md, targets.csv, counts.csv, stress.csv"
    print(f"{asked.out}: {made}; {time.perf_counter() - began:.0f} s")
    return 0
