"""The designs of a study: the combinations of its grid, and at each of these the points of Sobol's sequence, told by their number."""

from __future__ import annotations

import hashlib
import io
import os
import re
import sys
import time
import warnings
import zipfile
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager, suppress
from functools import cached_property, lru_cache
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from core import __version__
from core.design import Design, Info, edited, faults
from core.errors import FileError, KindynaError
from core.frozen import frozen
from core.process import resources
from core.project import dumps, dumps_table
from core.project.files import OwnFolder, is_folder, write_all
from core.study.batch import FAULTY
from core.study.many import many
from core.varying.request import CURVE, GRID, POINTS, StudyOfMany, VariedField

# -- the designs of a study -------------------------------------------------------------------------------------


Column = np.ndarray
"""(m,) numbers of a field, or words (dtype object)."""


@frozen(eq=False)
class Axis:
    """One field with what it is given: count values of the grid, listed or even from low to high; count 0: it takes part in Sobol's
    sequence."""

    field: str
    info: Info
    count: int = 0
    listed: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 0.0

    def at(self, place: np.ndarray) -> Column:
        """The values of the grid with these numbers (m,)."""
        if self.listed:
            kind = object if self.info.choices else float
            return np.array(self.listed, dtype=kind)[place]
        found = self.low + (self.high - self.low) * (place / (self.count - 1))
        found = np.where(place == self.count - 1, self.high, found)
        return np.rint(found) if self.info.whole else found

    def between(self, part: np.ndarray) -> np.ndarray:
        """Values (m,) at parts 0 ... 1 of the way from low to high; of a whole number each is as likely."""
        if self.info.whole:
            return np.minimum(np.floor(self.low + part * (self.high - self.low + 1.0)), self.high)
        return self.low + part * (self.high - self.low)


class Space:
    """All designs of a study, numbered: the first field changes slowest, Sobol's points fastest."""

    def __init__(self, study: StudyOfMany) -> None:
        rows = study.file.vary
        if not rows:
            raise KindynaError("vary: no field is varied; state at least one [[vary]]")
        bare = sum(row.low is not None and row.steps is None and row.points is None for row in rows)
        self.study = study
        self.axes = tuple(_axis(row, study.infos[row.field], bare) for row in rows)
        stated = [row.points for row in rows if row.points is not None]
        self.sobol = [axis for axis in self.axes if not axis.count]
        self.points = (stated[0] if stated else POINTS) if self.sobol else 1
        self.grid = [axis for axis in self.axes if axis.count]
        self.shape = tuple(axis.count for axis in self.grid)

    @cached_property
    def count(self) -> int:
        """How many designs there are."""
        return prod(self.shape) * self.points

    def columns(self, first: int, last: int) -> dict[str, Column]:
        """Field -> its values (m,), of the designs from ``first`` up to, but without, ``last``."""
        number = np.arange(first, last)
        places = np.unravel_index(number // self.points, self.shape) if self.shape else ()
        found = {axis.field: axis.at(place) for axis, place in zip(self.grid, places, strict=True)}
        if self.sobol:
            parts = self._parts(number)
            found |= {axis.field: axis.between(parts[:, i]) for i, axis in enumerate(self.sobol)}
        return {axis.field: found[axis.field] for axis in self.axes}

    def _parts(self, number: np.ndarray) -> np.ndarray:
        """Points of Sobol's sequence (m, d) of the designs of these numbers, which follow each other."""
        found = []
        while number.size:
            start = int(number[0] % self.points)
            now = min(number.size, self.points - start)
            found.append(sobol(len(self.sobol), self.study.file.seed, start, now))
            number = number[now:]
        return np.concatenate(found)


def sobol(dimensions: int, seed: int, start: int, count: int) -> np.ndarray:
    """Points (count, d) of a scrambled Sobol sequence from number ``start`` on, in 0 ... 1 (Joe and Kuo 2008, as scipy has it)."""
    from scipy.stats import qmc

    sequence = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that it is balanced only at powers of 2
        if start:
            sequence.fast_forward(start)
        return np.asarray(sequence.random(count))


def none_built_text(count: int, code: str, often: int) -> str:
    """That none of so many designs can be built, and the commonest reason."""
    return f"vary: none of the {count:,} designs can be built, most ({often:,}) for {code}; vary other fields, or other bounds"


def study_values(
    study: StudyOfMany, columns: Mapping[str, Column], *, polish: bool = True, executor: Any = None
) -> tuple[np.ndarray, np.ndarray]:
    """What is asked (q, m) of designs with these values of fields, and why one has none (m,)."""
    keys = [row.key for row in study.quantities]
    m = len(next(iter(columns.values())))
    value, reason = np.full((len(keys), m), np.nan), np.full(m, "", dtype=object)
    by_hand = {path: column for path, column in columns.items() if is_discrete(study.infos[path])}
    numbers = {path: column for path, column in columns.items() if path not in by_hand}
    for words, which in _groups(by_hand, m):
        design = with_words(study.base, words)
        if design is None:
            reason[which] = FAULTY
            continue
        rows = {path: column[which] for path, column in numbers.items()} or constant_column(design, len(which))
        found = many(design, rows, keys, polish=polish, executor=executor)
        value[:, which] = [found.value[key] for key in keys]
        reason[which] = found.reason
    return value, reason


def is_discrete(info: Info) -> bool:
    """Whether a field is put into the design, rather than varied with it: a word, or a whole number."""
    return bool(info.choices) or info.whole


def with_words(design: Design, words: Mapping[str, Any]) -> Design | None:
    """The design with these words and whole numbers; None where they do not go together."""
    for path, value in words.items():
        try:
            design = edited(design, path, value)
        except KindynaError:
            return None
    return None if words and faults(design) else design


def _groups(columns: Mapping[str, Column], m: int) -> list[tuple[dict[str, Any], np.ndarray]]:
    """Words that go together -> which designs (n,) have them, in the order in which they come first."""
    found: dict[tuple[Any, ...], list[int]] = {}
    for i, row in enumerate(zip(*(_plain(column) for column in columns.values()), strict=True)):
        found.setdefault(row, []).append(i)
    if not columns:
        return [({}, np.arange(m))]
    return [(dict(zip(columns, row, strict=True)), np.array(which)) for row, which in found.items()]


def _plain(column: Column) -> Sequence[Any]:
    return [value if isinstance(value, str) else int(value) for value in column.tolist()]


def constant_column(design: Design, m: int) -> dict[str, np.ndarray]:
    """A number of the design, m times: something is varied in ``many``."""
    from core.design.paths import entries

    for name in design.tables:
        for each in entries(design, name):
            info = each.info
            if not (info.choices or info.whole or info.flag) and type(each.value) in (int, float):
                return {each.path: np.full(m, float(each.value))}
    raise KindynaError("vary: this design has no number")


def _axis(row: VariedField, info: Info, bare: int) -> Axis:
    if row.values or row.choices:
        listed = row.values or row.choices
        return Axis(row.field, info, len(listed), listed)
    assert row.low is not None, "a rule of the file"
    assert row.high is not None, "a rule of the file"
    steps = row.steps
    if steps is None and row.points is None and bare < 3:
        steps = max(2, int(row.high - row.low) + 1) if info.whole else (CURVE if bare == 1 else GRID)
    if steps is None:
        return Axis(row.field, info, low=row.low, high=row.high)
    return Axis(row.field, info, steps, low=row.low, high=row.high)


# -- all designs of a study, block by block ---------------------------------------------------------------------


BLOCK = 1024  # designs
MOST_DESIGNS = 10_000_000
PROBE = 256  # designs by which it is estimated how long too many would take
CACHE = ".kindyna-studies"
MOST_RUNS = 8  # kept beside a design
TRIES = 3  # of a block whose process died

ProgressCallback = Callable[[int, int], None]
"""Designs that are done, and all. What it raises stops the run; what is done is kept."""


@frozen(eq=False)
class BlockOfDesigns:
    """Some designs of a study: their fields, what is asked of each (q, m), and why one has none (m,)."""

    columns: Mapping[str, Column]
    value: np.ndarray
    reason: np.ndarray


class Run:
    """A study computed, or to be computed. ``blocks`` gives the results in their order, one block in memory at a time."""

    def __init__(self, study: StudyOfMany, folder: Path | None = None) -> None:
        """folder: where results are kept; as ``cache_folder`` where it is None. Raises FileError where they cannot be kept."""
        if not study.quantities:
            raise KindynaError(
                "quantities: none is asked for; state at least one [[quantities]], [[limits]] or [[goals]]"
            )
        self.study, self.space = study, Space(study)
        self.count = self.space.count
        if self.count > MOST_DESIGNS:
            raise KindynaError(self._too_many())
        self.blocks_count = -(-self.count // BLOCK)
        self._kept = _run_folder(study, folder)

    @property
    def folder(self) -> Path:
        """Where results are kept."""
        return self._kept.path

    def _too_many(self) -> str:
        columns = self.space.columns(0, PROBE)
        study_values(
            self.study, {path: column[:1] for path, column in columns.items()}
        )  # with all that is loaded for it
        start = time.perf_counter()
        study_values(self.study, columns)
        rate = PROBE / (time.perf_counter() - start)
        grid = " x ".join(str(each.count) for each in self.space.grid)
        made = f"{grid} values" if self.space.points == 1 else f"{grid}{' x ' * bool(grid)}{self.space.points} points"
        steps = "fewer steps, or points = 4096 in place of the steps of every field"
        fewer = steps if self.space.points == 1 else "fewer points, as points = 4096"
        return (
            f"vary: {self.count:,} designs ({made}) are too many: some {duration(self.count / rate)} at {rate:,.0f} a second; "
            f"allowed: at most {MOST_DESIGNS:,}; give {fewer}"
        )

    def compute(
        self,
        *,
        resume: bool = False,
        executor: Executor | None = None,
        ahead: int = 1,
        tell: ProgressCallback | None = None,
    ) -> None:
        """Compute the blocks that are not kept, or all of them unless it is to resume; ahead: blocks handed out at a time.

        A block whose process died is computed again. Raises FileError where results cannot be kept.
        """
        if not resume or not self._kept.is_own():
            self.forget()
        _forget_old(self.folder)
        todo = deque(i for i in range(self.blocks_count) if self._block(i) is None)
        done = self.count - sum(self._size(i) for i in todo)
        tries: Counter[int] = Counter()
        at_work: dict[Future[bytes], int] = {}
        while todo or at_work:
            if tell is not None:
                tell(done, self.count)
            if executor is None:
                i = todo.popleft()
                self._keep(i, block_data(self.study, i))
                done += self._size(i)
                continue
            while todo and len(at_work) < ahead:
                at_work[executor.submit(block_data, self.study, todo[0])] = todo[0]
                todo.popleft()
            for future in wait(at_work, return_when=FIRST_COMPLETED).done:
                i = at_work.pop(future)
                error = future.exception()
                if error is None:
                    self._keep(i, future.result())
                    done += self._size(i)
                elif isinstance(error, KindynaError | ValueError | TypeError) or tries[i] + 1 >= TRIES:
                    raise error
                else:
                    tries[i] += 1
                    todo.appendleft(i)
        if tell is not None:
            tell(done, self.count)

    def blocks(self) -> Iterator[BlockOfDesigns]:
        """All blocks in their order, of a run that is computed."""
        for i in range(self.blocks_count):
            kept = self._block(i)
            if kept is None:
                raise KindynaError(f"{self.folder}: block {i} of the results is gone; run it again")
            yield BlockOfDesigns(self.space.columns(i * BLOCK, i * BLOCK + self._size(i)), *kept)

    def forget(self) -> None:
        """Take away what is kept."""
        self._kept.delete()

    def _size(self, i: int) -> int:
        return min(BLOCK, self.count - i * BLOCK)

    def _keep(self, i: int, data: bytes) -> None:
        self._kept.write(_name(i), data)

    def _block(self, i: int) -> tuple[np.ndarray, np.ndarray] | None:
        """Values and reasons of a block; None where it is not kept, or not as it was written."""
        data = self._kept.read(_name(i))
        if data is None:
            return None
        try:
            with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
                value, reason = arrays["value"], arrays["reason"]
        except (ValueError, OSError, KeyError, EOFError, MemoryError, zipfile.BadZipFile):
            return None
        right = value.shape == (len(self.study.quantities), self._size(i)) and reason.shape == (self._size(i),)
        return (value, reason) if right else None


def _name(i: int) -> str:
    return f"{i:05d}.npz"


def block_data(study: StudyOfMany, i: int) -> bytes:
    """One block of a study, as it is kept."""
    space = _space(study)
    value, reason = study_values(study, space.columns(i * BLOCK, min((i + 1) * BLOCK, space.count)))
    data = io.BytesIO()
    np.savez(data, value=value, reason=reason.astype(str))
    return data.getvalue()


@lru_cache(maxsize=1)
def _space(study: StudyOfMany) -> Space:
    return Space(study)


def study_key(study: StudyOfMany) -> str:
    """What the results depend on, as the name of a folder: the design, what is varied and asked, and the version of the program."""
    asked = "\n".join(row.key for row in study.quantities)
    varied = "\n".join(dumps_table(row) for row in study.file.vary)
    text = "\n\n".join([__version__, dumps(study.base), varied, asked, str(study.file.seed), str(BLOCK)])
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def _forget_old(folder: Path) -> None:
    """Of the runs kept beside a design take away the oldest, but this one."""
    with suppress(OSError):
        others = [
            path for path in folder.parent.iterdir() if path != folder and re.fullmatch(r"[0-9a-f]{24}", path.name)
        ]
        runs = [run for run in map(OwnFolder, others) if run.is_own()]
        for run in sorted(runs, key=lambda run: run.path.lstat().st_mtime, reverse=True)[MOST_RUNS - 1 :]:
            run.delete()


def cache_folder(study: StudyOfMany) -> Path:
    """Where results are kept: beside the design; in the user's cache for a design that ships with the program, and where the user cannot
    write or has put a link or a file in that place."""
    folder = study.folder.resolve()
    beside = folder / CACHE
    place = beside if os.path.lexists(beside) else folder
    shipped = folder.is_relative_to(resources().resolve())
    return beside if not shipped and is_folder(place) and os.access(place, os.W_OK) else user_cache()


def user_cache() -> Path:
    """The folder of results in the user's cache, which the desktop names."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home()) / "KINDYNA" / "studies"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "KINDYNA" / "studies"


def _run_folder(study: StudyOfMany, folder: Path | None) -> OwnFolder:
    """The folder of a run; in the user's cache where another of its name is in that place. Raises FileError."""
    key = study_key(study)
    for base in (cache_folder(study) if folder is None else folder, user_cache()):
        run = OwnFolder(base / key)
        if run.is_usable():
            return run
    raise FileError(f"{run.path}: cannot be written: it is a link, or holds files of others; move it away")


def duration(seconds: float) -> str:
    """A time in words: ``40 s``, ``3 min``, ``2.5 h``, ``12 days``."""
    for size, unit, most in ((1.0, "s", 90.0), (60.0, "min", 90.0), (3600.0, "h", 48.0)):
        if seconds < most * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 86400.0:.3g} days"


# -- processes ---------------------------------------------------------------------------------------------


@contextmanager
def workers(count: int, scheduler: str = "") -> Iterator[tuple[Executor | None, int]]:
    """What blocks are handed to, and how many at a time: nobody, so that they are computed here; processes of this machine; a Dask
    cluster by its scheduler's address. Raises KindynaError where that does not answer."""
    if scheduler:
        with _cluster(scheduler) as (executor, ahead):
            yield executor, ahead
    elif count < 2:
        yield None, 1
    else:
        pool = RestartingProcessPool(count)
        try:
            yield pool, 2 * count
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


class RestartingProcessPool(Executor):
    """Processes of this machine (spawned); where one of them dies, others take their places for what comes then."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._pool = self._started()

    def _started(self) -> Any:
        import multiprocessing
        from concurrent.futures import ProcessPoolExecutor

        context = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(self._count, mp_context=context, initializer=_left_to_the_parent)

    def submit(self, fn: Any, /, *args: Any, **named: Any) -> Any:
        """As ``Executor.submit``."""
        from concurrent.futures.process import BrokenProcessPool

        try:
            return self._pool.submit(fn, *args, **named)
        except BrokenProcessPool:
            self._pool.shutdown(wait=False, cancel_futures=True)
            self._pool = self._started()
            return self._pool.submit(fn, *args, **named)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """As ``Executor.shutdown``."""
        self._pool.shutdown(wait=wait, cancel_futures=cancel_futures)


def _left_to_the_parent() -> None:
    """An interrupt (Ctrl+C) is the parent's to answer."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)


CONNECTING = 10.0  # seconds that a scheduler is waited for


@contextmanager
def _cluster(address: str) -> Iterator[tuple[Executor, int]]:
    try:
        from distributed import Client
    except ImportError:
        raise KindynaError(
            "--scheduler: Dask is not installed; install the extra cluster: pip install kindyna[cluster]"
        ) from None
    try:
        client = Client(address, timeout=CONNECTING, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        why = str(error).partition("\n")[0] or type(error).__name__
        raise KindynaError(f"--scheduler {address}: does not answer ({why}); start one, or leave it out") from None
    try:
        yield client.get_executor(retries=TRIES, pure=False), 2 * max(1, sum(client.nthreads().values()))
    finally:
        client.close()


# -- the table of a study ---------------------------------------------------------------------------------------


REASON = "reason"
PARQUET = ".parquet"


def write_table(run: Run, out: Path) -> None:
    """Write the table of a run that is computed, whole or not at all. Raises FileError."""
    make = _parquet(run) if out.suffix.lower() == PARQUET else _csv(run)
    write_all(out.parent, {out.name: make})


def headings(run: Run) -> list[str]:
    """The columns: fields, what is asked, reason."""
    return [*(axis.field for axis in run.space.axes), *(row.column for row in run.study.quantities), REASON]


def _csv(run: Run) -> Iterator[bytes]:
    yield ",".join(headings(run)).encode() + b"\n"
    for block in run.blocks():
        columns = [
            *(column.tolist() for column in block.columns.values()),
            *block.value.tolist(),
            block.reason.tolist(),
        ]
        yield "".join(",".join(map(_cell, row)) + "\n" for row in zip(*columns, strict=True)).encode()


def _cell(value: Any) -> str:
    """A number by the shortest text that reads back to the same bits; nothing where there is none."""
    return value if isinstance(value, str) else "" if value != value else repr(value)


def _parquet(run: Run) -> Iterator[bytes]:
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError:
        raise KindynaError(
            "--out: Parquet needs pyarrow; install the extra parquet: pip install kindyna[parquet], or name a .csv"
        ) from None
    names = headings(run)
    words = [pa.string() if axis.info.choices else pa.float64() for axis in run.space.axes]
    schema = pa.schema(zip(names, [*words, *(pa.float64() for _ in run.study.quantities), pa.string()], strict=True))
    sink = _Sink()
    with parquet.ParquetWriter(sink, schema) as writer:
        for block in run.blocks():
            writer.write_table(pa.table(_columns(block), schema=schema))
            yield sink.taken()
    yield sink.taken()


def _columns(block: BlockOfDesigns) -> list[Any]:
    asked = ([None if value != value else value for value in row] for row in block.value.tolist())
    return [*(column.tolist() for column in block.columns.values()), *asked, block.reason.tolist()]


class _Sink(io.RawIOBase):
    """A file in memory of which what was written is taken away as it comes."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._size = 0

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        part = bytes(data)
        self._parts.append(part)
        self._size += len(part)
        return len(part)

    def tell(self) -> int:
        return self._size

    def taken(self) -> bytes:
        """What was written since the last time."""
        data = b"".join(self._parts)
        self._parts.clear()
        return data
