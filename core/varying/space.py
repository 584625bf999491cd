"""Designs of a study, by number: the combinations of its grid and, at every one of them, the points of Sobol's sequence."""

from __future__ import annotations

import hashlib
import io
import os
import re
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
from core.number_text import count_text, result_text
from core.process import resources, user_folder
from core.project import dumps, dumps_table
from core.project.files import OwnFolder, is_folder, write_all
from core.study.batch import FAULTY
from core.study.many import Many, many
from core.varying.request import CURVE, GRID, POINTS, StudyOfMany, VariedField

# -- the designs of a study -------------------------------------------------------------------------------------


Column = np.ndarray
"""Numbers of a field (m,), or words (m,) of dtype object."""


@frozen(eq=False)
class Axis:
    """A varied field.

    Attributes
    ----------
    field : str
    info : Info
    count : int
        Number of its values on the grid; 0 where it takes part in Sobol's sequence.
    listed : tuple
        Listed values; empty where they are even from low to high.
    low, high : float
    """

    field: str
    info: Info
    count: int = 0
    listed: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 0.0

    def at(self, index: np.ndarray) -> Column:
        """Values of the grid.

        Parameters
        ----------
        index : ndarray (m,), dimensionless
            Numbers of the values, from 0.

        Returns
        -------
        ndarray (m,) [unit of the field]
        """
        if self.listed:
            kind = object if self.info.choices else float
            return np.array(self.listed, dtype=kind)[index]
        values = self.low + (self.high - self.low) * (index / (self.count - 1))
        values = np.where(index == self.count - 1, self.high, values)
        return np.rint(values) if self.info.whole else values

    def between(self, part: np.ndarray) -> np.ndarray:
        """Values at parts of the interval from low to high; whole numbers are equally likely.

        Parameters
        ----------
        part : ndarray (m,), dimensionless
            From 0 to 1.

        Returns
        -------
        ndarray (m,) [unit of the field]
        """
        if self.info.whole:
            return np.minimum(np.floor(self.low + part * (self.high - self.low + 1.0)), self.high)
        return self.low + part * (self.high - self.low)


class Space:
    """All designs of a study by number: the first field changes slowest, Sobol's points fastest."""

    def __init__(self, study: StudyOfMany) -> None:
        rows = study.file.vary
        if not rows:
            raise KindynaError("vary: no field is varied; give at least one [[vary]]")
        bounds_only = sum(row.low is not None and row.steps is None and row.points is None for row in rows)
        self.study = study
        self.axes = tuple(_axis(row, study.infos[row.field], bounds_only) for row in rows)
        points = [row.points for row in rows if row.points is not None]
        self.sobol = [axis for axis in self.axes if not axis.count]
        self.points = (points[0] if points else POINTS) if self.sobol else 1
        self.grid = [axis for axis in self.axes if axis.count]
        self.shape = tuple(axis.count for axis in self.grid)

    @cached_property
    def count(self) -> int:
        """Number of designs."""
        return prod(self.shape) * self.points

    def require_few(self) -> None:
        """Raise KindynaError for too many designs, with the time that they would take."""
        if self.count <= MAX_DESIGNS:
            return
        columns = self.columns(0, PROBE)
        study_values(self.study, {path: column[:1] for path, column in columns.items()})  # loads all modules
        start = time.perf_counter()
        study_values(self.study, columns)
        rate = PROBE / (time.perf_counter() - start)
        grid = " x ".join(str(axis.count) for axis in self.grid)
        product = f"{grid} values" if self.points == 1 else f"{grid}{' x ' * bool(grid)}{self.points} points"
        steps = "fewer steps, or points = 4096 in place of the steps of every field"
        fewer = steps if self.points == 1 else "fewer points, as points = 4096"
        raise KindynaError(
            f"vary: {count_text(self.count)} designs ({product}) are too many: about "
            f"{duration(self.count / rate)} at {result_text(rate)} a second; "
            f"allowed: at most {count_text(MAX_DESIGNS)}; give {fewer}"
        )

    def columns(self, first: int, last: int) -> dict[str, Column]:
        """Field -> its values (m,), of the designs from ``first`` to ``last``, exclusive."""
        number = np.arange(first, last)
        indices = np.unravel_index(number // self.points, self.shape) if self.shape else ()
        columns = {axis.field: axis.at(index) for axis, index in zip(self.grid, indices, strict=True)}
        if self.sobol:
            parts = self._parts(number)
            columns |= {axis.field: axis.between(parts[:, i]) for i, axis in enumerate(self.sobol)}
        return {axis.field: columns[axis.field] for axis in self.axes}

    def _parts(self, number: np.ndarray) -> np.ndarray:
        """Points (m, d) of Sobol's sequence, of designs with consecutive numbers (m,)."""
        points = []
        while number.size:
            start = int(number[0] % self.points)
            count = min(number.size, self.points - start)
            points.append(sobol(len(self.sobol), self.study.file.seed, start, count))
            number = number[count:]
        return np.concatenate(points)


def sobol(dimensions: int, seed: int, start: int, count: int) -> np.ndarray:
    """Points of a scrambled Sobol sequence.

    Parameters
    ----------
    dimensions : int
        Number d of dimensions.
    seed : int
        Seed of the scrambling.
    start, count : int
        Number of the first point, and how many follow.

    Returns
    -------
    ndarray (count, d), dimensionless
        From 0 to 1.

    References
    ----------
    Joe and Kuo (2008), Constructing Sobol sequences with better two-dimensional projections; directions as in scipy.
    """
    from scipy.stats import qmc

    sequence = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that it is balanced only at powers of 2
        if start:
            sequence.fast_forward(start)
        return np.asarray(sequence.random(count))


def none_built_text(count: int, code: str, often: int) -> str:
    """Message that none of the designs can be built, with the most frequent reason."""
    return (
        f"vary: none of the {count_text(count)} designs can be built, most ({count_text(often)}) for {code}; vary "
        "other fields, or other bounds"
    )


def study_values(
    study: StudyOfMany, columns: Mapping[str, Column], *, polish: bool = True, executor: Any = None
) -> Many:
    """Figures of designs with given values of fields.

    Parameters
    ----------
    study : StudyOfMany
    columns : mapping of str -> ndarray (m,)
        Field -> its values, numbers or words.
    polish : bool
        Refine the extremes.
    executor : concurrent.futures.Executor or None
        Evaluates blocks of designs.

    Returns
    -------
    Many
    """
    keys = [row.key for row in study.quantities]
    m = len(next(iter(columns.values())))
    value, angle_deg = ({key: np.full(m, np.nan) for key in keys} for _ in range(2))
    reason = np.full(m, "", dtype=object)
    discrete = {path: column for path, column in columns.items() if is_discrete(study.infos[path])}
    numbers = {path: column for path, column in columns.items() if path not in discrete}
    for words, which in _groups(discrete, m):
        design = with_words(study.base, words)
        if design is None:
            reason[which] = FAULTY
            continue
        rows = {path: column[which] for path, column in numbers.items()} or constant_column(design, len(which))
        results = many(design, rows, keys, polish=polish, executor=executor)
        for key in keys:
            value[key][which], angle_deg[key][which] = results.value[key], results.angle_deg[key]
        reason[which] = results.reason
    return Many(value, angle_deg, reason)


def is_discrete(info: Info) -> bool:
    """Whether a field is a word or a whole number, so that designs with different values are computed separately."""
    return bool(info.choices) or info.whole


def with_words(design: Design, words: Mapping[str, Any]) -> Design | None:
    """The design with these words and whole numbers; None where they exclude each other."""
    for path, value in words.items():
        try:
            design = edited(design, path, value)
        except KindynaError:
            return None
    return None if words and faults(design) else design


QUIET_LAWS = ("cycloidal", "modified-sine", "modified-trapezoid", "3-4-5", "4-5-6-7")


def valid_words(design: Design, path: str, words: Sequence[str]) -> tuple[str, ...]:
    """Words, of those given, that are valid at a path of the design."""
    return tuple(word for word in words if with_words(design, {path: word}) is not None)


def _groups(columns: Mapping[str, Column], m: int) -> list[tuple[dict[str, Any], np.ndarray]]:
    """Combinations of words with the numbers (n,) of their designs, in the order of their first design."""
    groups: dict[tuple[Any, ...], list[int]] = {}
    for i, row in enumerate(zip(*(_plain(column) for column in columns.values()), strict=True)):
        groups.setdefault(row, []).append(i)
    if not columns:
        return [({}, np.arange(m))]
    return [(dict(zip(columns, row, strict=True)), np.array(which)) for row, which in groups.items()]


def _plain(column: Column) -> Sequence[Any]:
    return [value if isinstance(value, str) else int(value) for value in column.tolist()]


def constant_column(design: Design, m: int) -> dict[str, np.ndarray]:
    """Path of a number of the design with the number repeated, since ``many`` needs a varied number.

    Parameters
    ----------
    design : Design
    m : int
        Number of designs.

    Returns
    -------
    dict of str -> ndarray (m,) [unit of the field]
    """
    from core.design.paths import entries

    for name in design.tables:
        for entry in entries(design, name):
            info = entry.info
            if not (info.choices or info.whole or info.flag) and type(entry.value) in (int, float):
                return {entry.path: np.full(m, float(entry.value))}
    raise KindynaError("vary: this design has no number")


def _axis(row: VariedField, info: Info, bounds_only: int) -> Axis:
    """Axis of a row; ``bounds_only`` counts the rows of the study with neither steps nor points."""
    if row.values or row.choices:
        listed = row.values or row.choices
        return Axis(row.field, info, len(listed), listed)
    assert row.low is not None, "a rule of the file"
    assert row.high is not None, "a rule of the file"
    steps = row.steps
    if steps is None and row.points is None and bounds_only < 3:
        steps = max(2, int(row.high - row.low) + 1) if info.whole else (CURVE if bounds_only == 1 else GRID)
    if steps is None:
        return Axis(row.field, info, low=row.low, high=row.high)
    return Axis(row.field, info, steps, low=row.low, high=row.high)


# -- all designs of a study, block by block ---------------------------------------------------------------------


BLOCK = 1024  # designs
MAX_DESIGNS = 10_000_000
PROBE = 256  # designs from which the time of too many is estimated
CACHE = ".kindyna-studies"
STUDIES = "studies"  # the same in the user's cache
MAX_RUNS = 8  # saved next to a design
TRIES = 3  # of a block whose process died

ProgressCallback = Callable[[int, int], None]
"""Called with the number of computed designs, and of all; an exception stops the run, and computed blocks stay saved."""


@frozen(eq=False)
class BlockOfDesigns:
    """Results of some designs of a study.

    Attributes
    ----------
    columns : mapping of str -> ndarray (m,)
        Field -> its values.
    value : ndarray (q, m)
        Figures of the study; NaN where a design has none.
    reason : ndarray (m,)
        Code that says why a design has no value; else empty.
    """

    columns: Mapping[str, Column]
    value: np.ndarray
    reason: np.ndarray


class Run:
    """Computation of a study; ``blocks`` gives the results in order, with one block in memory at a time."""

    def __init__(self, study: StudyOfMany, folder: Path | None = None) -> None:
        """Prepare a run with the folder of its results, by default ``cache_folder``. Raises FileError where it is not writable."""
        if not study.quantities:
            raise KindynaError(
                "quantities: no quantity is requested; give at least one [[quantities]], [[limits]] or [[goals]]"
            )
        self.study, self.space = study, Space(study)
        self.count = self.space.count
        self.space.require_few()
        self.block_count = -(-self.count // BLOCK)
        self._results = _run_folder(study, folder)

    @property
    def folder(self) -> Path:
        """Folder of the results."""
        return self._results.path

    def compute(
        self,
        *,
        resume: bool = False,
        executor: Executor | None = None,
        ahead: int = 1,
        progress: ProgressCallback | None = None,
    ) -> None:
        """Compute all blocks, or with ``resume`` those without saved results; ``ahead`` blocks are submitted at a time.

        A block whose process died is computed again. Raises FileError where results cannot be saved.
        """
        if not resume or not self._results.is_own():
            self.delete_results()
        _delete_old_runs(self.folder)
        todo = deque(i for i in range(self.block_count) if self._block(i) is None)
        done = self.count - sum(self._size(i) for i in todo)
        tries: Counter[int] = Counter()
        running: dict[Future[bytes], int] = {}
        while todo or running:
            if progress is not None:
                progress(done, self.count)
            if executor is None:
                i = todo.popleft()
                self._save(i, block_data(self.study, i))
                done += self._size(i)
                continue
            while todo and len(running) < ahead:
                running[executor.submit(block_data, self.study, todo[0])] = todo[0]
                todo.popleft()
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                i = running.pop(future)
                error = future.exception()
                if error is None:
                    self._save(i, future.result())
                    done += self._size(i)
                elif isinstance(error, KindynaError | ValueError | TypeError) or tries[i] + 1 >= TRIES:
                    raise error
                else:
                    tries[i] += 1
                    todo.appendleft(i)
        if progress is not None:
            progress(done, self.count)

    def blocks(self) -> Iterator[BlockOfDesigns]:
        """All blocks in order, of a run that has been computed."""
        for i in range(self.block_count):
            results = self._block(i)
            if results is None:
                raise KindynaError(f"{self.folder}: block {i} of the results is missing; run the study again")
            yield BlockOfDesigns(self.space.columns(i * BLOCK, i * BLOCK + self._size(i)), *results)

    def delete_results(self) -> None:
        """Delete the saved results."""
        self._results.delete()

    def _size(self, i: int) -> int:
        return min(BLOCK, self.count - i * BLOCK)

    def _save(self, i: int, data: bytes) -> None:
        self._results.write(_name(i), data)

    def _block(self, i: int) -> tuple[np.ndarray, np.ndarray] | None:
        """Values and reasons of a block; None where it is not saved, or damaged."""
        data = self._results.read(_name(i))
        if data is None:
            return None
        try:
            with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
                value, reason = arrays["value"], arrays["reason"]
        except (ValueError, OSError, KeyError, EOFError, MemoryError, zipfile.BadZipFile):
            return None
        is_complete = value.shape == (len(self.study.quantities), self._size(i)) and reason.shape == (self._size(i),)
        return (value, reason) if is_complete else None


def _name(i: int) -> str:
    return f"{i:05d}.npz"


def block_data(study: StudyOfMany, i: int) -> bytes:
    """Results of a block of a study, as saved."""
    space = _space(study)
    results = study_values(study, space.columns(i * BLOCK, min((i + 1) * BLOCK, space.count)))
    data = io.BytesIO()
    np.savez(data, value=np.array(list(results.value.values())), reason=results.reason.astype(str))
    return data.getvalue()


@lru_cache(maxsize=1)
def _space(study: StudyOfMany) -> Space:
    return Space(study)


def study_key(study: StudyOfMany) -> str:
    """Name of the folder of results, by all they depend on: design, varied fields, figures, seed and version of KINDYNA."""
    requested = "\n".join(row.key for row in study.quantities)
    varied = "\n".join(dumps_table(row) for row in study.file.vary)
    text = "\n\n".join([__version__, dumps(study.base), varied, requested, str(study.file.seed), str(BLOCK)])
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def _delete_old_runs(folder: Path) -> None:
    """Delete the oldest runs next to this one."""
    with suppress(OSError):
        others = [
            path for path in folder.parent.iterdir() if path != folder and re.fullmatch(r"[0-9a-f]{24}", path.name)
        ]
        runs = [run for run in map(OwnFolder, others) if run.is_own()]
        for run in sorted(runs, key=lambda run: run.path.lstat().st_mtime, reverse=True)[MAX_RUNS - 1 :]:
            run.delete()


def cache_folder(study: StudyOfMany) -> Path:
    """Folder of results: next to the design, or in the user's cache.

    The cache is used for a design that ships with KINDYNA, and where the folder is not writable, or a link or a file has its name.
    """
    folder = study.folder.resolve()
    local = folder / CACHE
    existing = local if os.path.lexists(local) else folder
    is_shipped = folder.is_relative_to(resources().resolve())
    return (
        local
        if not is_shipped and is_folder(existing) and os.access(existing, os.W_OK)
        else user_folder("cache") / STUDIES
    )


def _run_folder(study: StudyOfMany, folder: Path | None) -> OwnFolder:
    """Folder of a run; in the user's cache where something else has its name. Raises FileError."""
    key = study_key(study)
    for base in (cache_folder(study) if folder is None else folder, user_folder("cache") / STUDIES):
        run = OwnFolder(base / key)
        if run.is_usable():
            return run
    raise FileError(f"{run.path}: cannot be written: it is a link, or contains other files; move it")


def duration(seconds: float) -> str:
    """A time in words: ``40 s``, ``3 min``, ``2.5 h``, ``12 days``."""
    for size, unit, most in ((1.0, "s", 90.0), (60.0, "min", 90.0), (3600.0, "h", 48.0)):
        if seconds < most * size:
            return f"{result_text(seconds / size, 3)} {unit}"
    return f"{result_text(seconds / 86400.0, 3)} days"


# -- processes ---------------------------------------------------------------------------------------------


@contextmanager
def workers(count: int, scheduler: str = "") -> Iterator[tuple[Executor | None, int]]:
    """Executor of blocks, and how many blocks to submit at a time.

    None for a single process, else processes of this computer, or a Dask cluster by the address of its scheduler. Raises
    KindynaError where the scheduler does not respond.
    """
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
    """Spawned processes of this computer; where one dies, new processes replace them all for the tasks that follow."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._pool = self._new_pool()

    def _new_pool(self) -> Any:
        import multiprocessing
        from concurrent.futures import ProcessPoolExecutor

        context = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(self._count, mp_context=context, initializer=_ignore_interrupts)

    def submit(self, fn: Any, /, *args: Any, **named: Any) -> Any:
        """Submit a task, as ``Executor.submit``."""
        from concurrent.futures.process import BrokenProcessPool

        try:
            return self._pool.submit(fn, *args, **named)
        except BrokenProcessPool:
            self._pool.shutdown(wait=False, cancel_futures=True)
            self._pool = self._new_pool()
            return self._pool.submit(fn, *args, **named)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Stop the processes, as ``Executor.shutdown``."""
        self._pool.shutdown(wait=wait, cancel_futures=cancel_futures)


def _ignore_interrupts() -> None:
    """Leave interrupts (Ctrl+C) to the parent process."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)


CONNECT_TIMEOUT = 10.0  # [s] of a scheduler


@contextmanager
def _cluster(address: str) -> Iterator[tuple[Executor, int]]:
    try:
        from distributed import Client
    except ImportError:
        raise KindynaError(
            "--scheduler: Dask is not installed; install the extra cluster: pip install kindyna[cluster]"
        ) from None
    try:
        client = Client(address, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        why = str(error).partition("\n")[0] or type(error).__name__
        raise KindynaError(f"--scheduler {address}: does not respond ({why}); start one, or leave it out") from None
    try:
        yield client.get_executor(retries=TRIES, pure=False), 2 * max(1, sum(client.nthreads().values()))
    finally:
        client.close()


# -- the table of a study ---------------------------------------------------------------------------------------


REASON = "reason"
PARQUET = ".parquet"


def write_table(run: Run, out: Path) -> None:
    """Write the table of a computed run, completely or not at all. Raises FileError."""
    write_all(out.parent, {out.name: _parquet(run) if out.suffix.lower() == PARQUET else _csv(run)})


def headings(run: Run) -> list[str]:
    """Columns of the table: fields, figures, reason."""
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
    """Shortest text of a number that reads back to the same bits; empty for NaN."""
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
            yield sink.take()
    yield sink.take()


def _columns(block: BlockOfDesigns) -> list[Any]:
    figures = ([None if value != value else value for value in row] for row in block.value.tolist())
    return [*(column.tolist() for column in block.columns.values()), *figures, block.reason.tolist()]


class _Sink(io.RawIOBase):
    """File in memory whose new bytes are taken out after every block."""

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

    def take(self) -> bytes:
        """Bytes written since the last call."""
        data = b"".join(self._parts)
        self._parts.clear()
        return data
