"""Model of a report: sections of sentences, tables, pictures and equations, from which text, HTML and PDF are written."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

from core.frozen import frozen
from core.number_text import MINUS, RESULT_DIGITS
from core.output.lines import columns, digits, printable

if TYPE_CHECKING:
    from core.output.report.equations import Equation
    from core.study import Study


# -- blocks and sections ----------------------------------------------------------------------------------------


ROUNDING = 1e-12
"""Fraction of the size of a quantity below which a value is rounding."""


@frozen
class Number:
    """A computed number as it is printed.

    Attributes
    ----------
    value : as in ``summary.json``; None where it is infinite
    most : greatest number of digits
    size : size of its quantity; a value that is rounding against it is printed as 0
    """

    value: float | None
    most: int = RESULT_DIGITS
    size: float = 0.0

    def __str__(self) -> str:
        if self.value is not None and abs(self.value) <= ROUNDING * self.size:
            return "0"
        return digits(self.value, self.most)


Cell: TypeAlias = "str | Number"


@frozen
class Sentences:
    """Lines of text; with ``is_remark`` a remark on the block above."""

    lines: tuple[str, ...]
    is_remark: bool = False


@frozen
class ReportTable:
    """Rows of cells.

    Attributes
    ----------
    rows : cells of every row
    header : titles of the columns; empty where they need none
    left : number of columns that are flush left, from the first one
    title : line above the table
    slug, keys : names of the table and of its rows, for programs that read the report
    """

    rows: tuple[tuple[Cell, ...], ...]
    header: tuple[str, ...] = ()
    left: int = 1
    title: str = ""
    slug: str = ""
    keys: tuple[str, ...] = ()

    @property
    def without_empty_columns(self) -> ReportTable:
        """The table without its empty columns."""
        filled = [i for i in range(len(self.rows[0]) if self.rows else 0) if any(str(row[i]) for row in self.rows)]
        rows = tuple(tuple(row[i] for i in filled) for row in self.rows)
        return replace(self, rows=rows, header=tuple(self.header[i] for i in filled) if self.header else ())

    @property
    def text_columns(self) -> frozenset[int]:
        """Columns of words, which are flush left: units, sources, remarks."""
        if not self.rows:
            return frozenset()
        return frozenset(
            i
            for i in range(len(self.rows[0]))
            if not any(
                isinstance(row[i], Number) or str(row[i]).lstrip(f"+-{MINUS}")[:1].isdigit() for row in self.rows
            )
        )


@frozen(eq=False)
class ReportPicture:
    """A picture of a study, by the name that the painter knows; with a caption."""

    name: str
    study: Study
    caption: str


@frozen
class ReportEquations:
    """Equations with their sources."""

    rows: tuple[Equation, ...]


Block: TypeAlias = "Sentences | ReportTable | ReportPicture | ReportEquations"


@frozen(eq=False)
class Section:
    """Blocks below a title; level 1 is a chapter, level 2 a section of a chapter."""

    title: str
    blocks: tuple[Block, ...]
    level: int = 2


def table(
    header: Sequence[str],
    rows: Iterable[Sequence[Cell]],
    left: int = 1,
    title: str = "",
    slug: str = "",
    keys: Iterable[str] = (),
) -> ReportTable:
    """A table of rows."""
    return ReportTable(tuple(tuple(row) for row in rows), tuple(header), left, title, slug, tuple(keys))


def section(title: str, *blocks: Block | None) -> list[Section]:
    """A section of the blocks that are not None and not tables without rows; an empty list where no block is left."""
    filled = tuple(
        block for block in blocks if block is not None and not (isinstance(block, ReportTable) and not block.rows)
    )
    return [Section(title, filled)] if filled else []


# -- plain text ------------------------------------------------------------------------------------------------


def text(name: str, sections: Iterable[Section]) -> str:
    """The sections as plain text below the design's name, without pictures and equations."""
    name = printable(name)
    return "\n".join([name, "=" * len(name), *lines(sections)]) + "\n"


def lines(sections: Iterable[Section]) -> Iterator[str]:
    """Lines of the sections, an empty line before every section."""
    for part in sections:
        yield from ("", part.title, "-" * len(part.title))
        for number, block in enumerate(part.blocks):
            if number:
                yield ""
            yield from block_lines(block)


def block_lines(block: Block) -> Iterator[str]:
    """Lines of a table or of sentences; a picture or an equation has none."""
    if isinstance(block, Sentences):
        yield from block.lines
    elif isinstance(block, ReportTable):
        if block.title:
            yield block.title
        rows = [[str(cell) for cell in row] for row in block.rows]
        yield from columns([block.header, *rows] if block.header else rows, block.left)
