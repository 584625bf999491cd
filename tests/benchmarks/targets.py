"""What the design asks of run time and accuracy, and what this machine needs for it; where it misses, why."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf

import numpy as np
from benchmarks import cams, designs, forces, hill, linkages, processes, window, windups
from benchmarks.measuring import FULL, Plan, Row
from benchmarks.table import Kernel, kernels
from benchmarks.timing import Fresh, Run, measure
from linkages import chain
from mechanisms import LIFT
from shafts import KIM, of
from stress_cases import CASES

from core.design import put
from core.dynamics import newton_euler
from core.stability import EXACT, tongues
from core.stability.critical_speeds import MOST_Q, ROWS
from core.study import Study, certificate_of, findings_of, many

USUAL = 3600
TRIES = 4
EDITS, FRAMES = window.EDIT_KERNEL, window.FRAME_KERNEL
SIX_BAR_EDITS, SIX_BAR_DRAGS, SIX_BAR_FRAMES = window.SIX_BAR_KERNELS
CHART = MOST_Q * np.arange(1, ROWS + 1) / ROWS  # as it is drawn for Kim1990's shaft
WANTED = 1e-8  # of tongue edges
FRAME_MS = 1e3 / 60.0
MANY, MOST = 1_000_000, 3_000_000  # angles of an export


@dataclass(frozen=True)
class Target:
    """What, how much is allowed, how much it takes, in which unit; why it takes more, where it does."""

    what: str
    allowed: float
    taken: float
    unit: str = "ms"
    why: str = ""

    @property
    def met(self) -> bool:
        return self.taken <= self.allowed


def _ours(kernel: Kernel) -> Fresh:
    given = kernel.again(kernel.given(kernel.grid(kernel.usual)))
    return Fresh(lambda: partial(kernel.ours.cold, kernel.again(given), None))


def _frictionless() -> Run:
    study = Study(put(LIFT, "loads.friction", 0.0), USUAL)
    _ = study.dynamics
    return lambda: newton_euler(study.linkage, study.cam, study.loading, study.omega).torque


def _edges(rows: np.ndarray) -> Callable[[], object]:
    found = of(KIM).coefficients
    return lambda: tongues(found, rows, hill.COUNT, EXACT, error=WANTED)


def _many(row: designs.Designs) -> Run:
    columns = replace(row, count=10_000).columns
    return lambda: many(row.design, columns, row.asked, polish=False)


def _certificate() -> Fresh:
    """Of a linkage that is solved already."""

    def make() -> Run:
        study = Study(chain(60))
        _ = study.linkage, study.dynamics
        return lambda: certificate_of(study)

    return Fresh(make)


def _kernels() -> dict[str, tuple[float, Run | Fresh]]:
    """What is run here: allowed milliseconds, and what is run."""
    roller, *_, lift, _ = designs.ROWS
    return {
        "linkage: positions, velocities, accelerations, 3600 angles": (0.2, _ours(linkages.KERNEL)),
        "contact force and torque without friction, 3600 angles": (0.25, _frictionless()),
        "wind-up of five turns": (5.0, _ours(windups.KERNEL)),
        **{
            f"profile, pressure angle and curvature, {what}, 3600 angles": (0.15, run)
            for what, run in cams.under_faces(USUAL).items()
        },
        "whole chain motion to torque, 3600 angles": (1.5, _ours(forces.CHAIN)),
        "findings of one design": (5.0, lambda: findings_of(Study(forces.anew(LIFT)))),
        "10,000 designs, three extremes, unpolished: translating roller": (250.0, _many(roller)),
        "10,000 designs, three extremes, unpolished: cam-slider with friction": (500.0, _many(lift)),
        f"tongues up to 11 for Q = {hill.Q:g}, to 1e-8": (1.0, _edges(np.array([hill.Q]))),
        "chart of 64 rows of tongues up to 11": (40.0, _edges(CHART)),
        "certificate of 60 links": (100.0, _certificate()),
    }


def _timed(seconds: float) -> list[Target]:
    """Best of several runs. Who misses is looked at again, so that a machine that was busy for a while fails nobody."""
    runs = _kernels()
    found = {what: Target(what, allowed, inf) for what, (allowed, _) in runs.items()}
    for _ in range(TRIES):
        left = {what: runs[what][1] for what, target in found.items() if not target.met}
        if not left:
            break
        for what, taken in measure(left, seconds).seconds.items():
            found[what] = replace(found[what], taken=min(found[what].taken, 1e3 * taken))
    return list(found.values())


def _accurate(whole: bool) -> Iterator[Target]:
    """Errors against 50-digit values, what balances, and the stress cases by their bounds; whole: at all their values."""
    for kernel in kernels():
        if kernel.name in ("linkage", "dyads"):
            yield Target(f"{kernel.title}: largest error", 1e-12, _least(kernel), "")
        if kernel.name == "profile":
            yield Target("profile of a cam of 1 m under a roller: largest error", 1e-10, 1e3 * _least(kernel), "mm")
    yield Target("power balance of the lift", 1e-12, certificate_of(Study(LIFT, USUAL))["power_balance"].value, "")
    looks = ((case, value) for case in CASES for value in (case.values if whole else case.some[:2]))
    worst = max(case.look(value).ratio for case, value in looks)
    yield Target("stress cases, dead centres included: error by its bound", 1.0, worst, "")


def _least(kernel: Kernel) -> float:
    return kernel.error(kernel.ours, kernel.ours.settings[0])


def _in_the_window(rows: Sequence[Row]) -> list[Target]:
    """From the rows of ``make bench``, the slowest of each."""

    def worst(what: str, allowed: float, kernel: str, n: int) -> Target:
        row = max((row for row in rows if (row.kernel, row.n) == (kernel, n)), key=lambda row: row.seconds)
        ms = 1e3 * row.seconds
        bare = "an empty window" if kernel == window.START_KERNEL else "a bare repaint of the same widgets"
        why = f"{ms / row.times_bare:.2g} ms of that are {bare}, the rest is calculation and drawing"
        return Target(what, allowed, ms, why=why)

    return [
        worst("edit until six plots and the mechanism are painted, findings later", 20.0, EDITS, window.SOME),
        worst("edit of a six-bar until three plots and the mechanism are painted", 33.0, SIX_BAR_EDITS, window.FEW),
        worst("move of a join of the motion with twelve plots at 1920 x 1080", 12.0, window.DRAG_KERNEL, window.MANY),
        worst("move of a six-bar's joint with twelve plots at 1920 x 1080", 12.0, SIX_BAR_DRAGS, window.MANY),
        worst("frame of the animation with twelve plots", FRAME_MS, FRAMES, window.MANY),
        worst("frame of a six-bar with its table of centres and three plots", 8.0, SIX_BAR_FRAMES, window.FEW),
        worst("frame of the same at 1920 x 1080", 12.0, window.WIDE_KERNEL, window.FEW),
        worst("frame of several drives with three plots", FRAME_MS, window.DRIVES_KERNEL, window.FEW),
        worst("start until the mechanism of the lift is drawn, warm", 300.0, window.START_KERNEL, 0),
    ]


def _of_processes(starts: int, large: bool) -> Iterator[Target]:
    took = processes.check(starts)
    parts = f"{took.bare:.2g} s are Python with numpy alone"
    yield Target("`check` of the lift by Python with numpy alone", 1.7, took.whole / took.bare, "times", parts)
    if large:
        yield Target("export of 1,000,000 angles", 5.0, processes.export(MANY).seconds, "s")
        yield Target("memory of an export of 3,000,000 angles", 0.3, processes.export(MOST).peak_mib / 1024.0, "GiB")


def measured(rows: Sequence[Row], plan: Plan = FULL) -> list[Target]:
    """Every target; those of the window as their own rows have them."""
    timed = _timed(plan.targets)
    return [*timed, *_accurate(plan.large), *_in_the_window(rows), *_of_processes(plan.starts, plan.large)]


def as_csv(targets: Sequence[Target]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("what", "unit", "allowed", "taken", "met"))
    writer.writerows((t.what, t.unit, f"{t.allowed:.4g}", f"{t.taken:.3g}", "yes" if t.met else "no") for t in targets)
    return text.getvalue()


HEAD = (
    "## Targets",
    "",
    "Targets of KINDYNA's design, and the values of this run on its machine: processor time, the least of several runs, in the"
    " window the median; errors relative to the largest value. The next run can differ by the noise above; another machine has"
    " other times.",
    "",
    "| what | target | measured | |",
    "|---|---|---|---|",
)


def markdown(targets: Sequence[Target]) -> str:
    """The section of the help; nothing where none was measured."""
    if not targets:
        return ""
    return "\n".join([*HEAD, *(_line(t) for t in targets)]) + "\n"


def _line(target: Target) -> str:
    unit = f" {target.unit}" if target.unit else ""
    verdict = "met" if target.met else "; ".join(filter(None, ("**missed**", target.why)))
    return f"| {target.what} | ≤ {target.allowed:.3g}{unit} | {target.taken:.3g}{unit} | {verdict} |"
