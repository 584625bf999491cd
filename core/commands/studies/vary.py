"""The command ``vary``: a table of many designs, some of whose numbers and words are varied."""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

from core.commands import DONE, Painter
from core.commands.common import as_json, ending_with
from core.design.fields import flag, whole
from core.errors import KindynaError
from core.frozen import frozen
from core.output.summary import to_json
from core.requests import asked, typed
from core.varying import Run, duration, load_study, none_built, workers, write_table
from core.varying.table import PARQUET, headings

MOST_WORKERS = 256


@frozen(kw_only=True)
class Arguments:
    """Which study, where its table goes, and who computes."""

    study: Path = typed("study file (.toml)", "STUDY", type=Path)
    out: Path = typed(
        "the table: a row for each design", type=ending_with("a table", ".csv", PARQUET), metavar="TABLE.csv|.parquet"
    )
    resume: bool = flag("Resume", help="go on where an earlier run of the same study was stopped")
    workers: int = whole("Processes", 1, MOST_WORKERS, default=1, help="processes that compute")
    scheduler: str = asked(
        typed("", default=""), help="compute on the Dask cluster of this scheduler (extra cluster)", metavar="ADDRESS"
    )
    json: bool = as_json()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The table as a file, how many designs it holds and why some have no values on the terminal."""
    study = load_study(arguments.study)
    made = Run(study)
    progress = Progress()
    with workers(arguments.workers, arguments.scheduler) as (executor, ahead):
        made.compute(resume=arguments.resume, executor=executor, ahead=ahead, tell=progress.tell)
    reasons: Counter[str] = Counter()
    built = 0
    for block in made.blocks():
        built += int((~np.isnan(block.value).any(axis=0)).sum())
        reasons.update(block.reason[block.reason != ""].tolist())
    if not built:
        raise KindynaError(none_built(made.count, *reasons.most_common(1)[0]))
    write_table(made, arguments.out)
    if arguments.json:
        data = {
            "designs": made.count,
            "built": built,
            "reasons": dict(reasons.most_common()),
            "columns": headings(made),
        }
        print(to_json(data), end="")
    else:
        print(f"{made.count:,} designs, {built:,} of them with values; {arguments.out}")
        for code, count in reasons.most_common():
            print(f"  {code}: {count:,}")
    return DONE


class Progress:
    """Says now and then how many designs are done, how many a second, and how long the rest takes: at a terminal often, in a log
    seldom."""

    OFTEN, SELDOM = 2.0, 60.0  # seconds between two lines

    def __init__(self) -> None:
        self._start = self._last = time.monotonic()
        self._first: int | None = None

    def tell(self, done: int, count: int) -> None:
        """As ``Run.compute`` calls it."""
        now = time.monotonic()
        self._first = done if self._first is None else self._first
        pause = self.OFTEN if sys.stderr.isatty() else self.SELDOM
        if now - self._last < pause or done == self._first:
            return
        self._last = now
        rate = (done - self._first) / (now - self._start)
        print(
            f"{done:,} of {count:,} designs, {rate:,.0f} a second, {duration((count - done) / rate)} left",
            file=sys.stderr,
        )
