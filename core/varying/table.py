"""The table of a study: a row for each design, as CSV or Parquet, written block by block."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from core.errors import KindynaError
from core.project.files import write_all
from core.varying.run import BlockOfDesigns, Run

REASON = "reason"
PARQUET = ".parquet"


def write_table(run: Run, out: Path) -> None:
    """Write the table of a run that is computed, whole or not at all. Raises FileError."""
    make = _parquet(run) if out.suffix.lower() == PARQUET else _csv(run)
    write_all(out.parent, {out.name: make})


def headings(run: Run) -> list[str]:
    """The columns: fields, what is asked, reason."""
    return [*(axis.field for axis in run.space.axes), *(row.column for row in run.study.asked), REASON]


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
    schema = pa.schema(zip(names, [*words, *(pa.float64() for _ in run.study.asked), pa.string()], strict=True))
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
