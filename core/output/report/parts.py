"""What a report is made of: sections of sentences, tables, pictures and equations. Texts, HTML and PDF are written from the same."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

from core.frozen import frozen
from core.output.lines import columns, digits, printable

if TYPE_CHECKING:
    from core.output.report.equations import Equation
    from core.study import Study


# -- what a report is made of -----------------------------------------------------------------------------------


ROUNDING = 1e-12
"""Of the size of a channel: a smaller value is not certain."""


@frozen
class Number:
    """A computed number: its value as in ``summary.json`` (None: infinite), of which so many digits are for reading; size: of the
    channel that it belongs to, of which what is rounding counts as 0."""

    value: float | None
    most: int = 6
    size: float = 0.0

    def __str__(self) -> str:
        if self.value is not None and abs(self.value) <= ROUNDING * self.size:
            return "0"
        return digits(self.value, self.most)


Cell: TypeAlias = "str | Number"


@frozen
class Sentences:
    """Lines of text. mark: whether they are a remark to what stands above."""

    lines: tuple[str, ...]
    mark: bool = False


@frozen
class ReportTable:
    """Rows of cells, the first ``left`` columns flush left.

    head   of the columns, empty where they need none; title: a line above
    slug   of what the rows are, for programs that read the report; keys: of each row
    """

    rows: tuple[tuple[Cell, ...], ...]
    head: tuple[str, ...] = ()
    left: int = 1
    title: str = ""
    slug: str = ""
    keys: tuple[str, ...] = ()

    @property
    def filled(self) -> ReportTable:
        """Without the columns in which nothing stands."""
        keep = [i for i in range(len(self.rows[0]) if self.rows else 0) if any(str(row[i]) for row in self.rows)]
        rows = tuple(tuple(row[i] for i in keep) for row in self.rows)
        return replace(self, rows=rows, head=tuple(self.head[i] for i in keep) if self.head else ())

    @property
    def words(self) -> frozenset[int]:
        """Columns of words, which stand flush left wherever words are laid out in columns: units, sources, remarks."""
        if not self.rows:
            return frozenset()
        return frozenset(
            i
            for i in range(len(self.rows[0]))
            if not any(isinstance(row[i], Number) or _is_number(str(row[i])) for row in self.rows)
        )


def _is_number(text: str) -> bool:
    return text.lstrip("+-")[:1].isdigit()


@frozen(eq=False)
class ReportPicture:
    """A picture of a study, by the name that who paints knows it by; with a caption."""

    name: str
    of: Study
    caption: str


@frozen
class ReportEquations:
    """Equations, each with its source."""

    rows: tuple[Equation, ...]


Block: TypeAlias = "Sentences | ReportTable | ReportPicture | ReportEquations"


@frozen(eq=False)
class Section:
    """Blocks below a title; level: 1 a chapter, 2 a section of one."""

    title: str
    blocks: tuple[Block, ...]
    level: int = 2


def table(
    head: Sequence[str],
    rows: Iterable[Sequence[Cell]],
    left: int = 1,
    title: str = "",
    slug: str = "",
    keys: Iterable[str] = (),
) -> ReportTable:
    """A table of any rows."""
    return ReportTable(tuple(tuple(row) for row in rows), tuple(head), left, title, slug, tuple(keys))


def section(title: str, *blocks: Block | None) -> list[Section]:
    """A section of the blocks that there are; none where there is none, or where no table has rows."""
    there = tuple(
        block for block in blocks if block is not None and not (isinstance(block, ReportTable) and not block.rows)
    )
    return [Section(title, there)] if there else []


# -- A report as plain text -------------------------------------------------------------------------------------


def text(name: str, sections: Iterable[Section]) -> str:
    """The sections below the design's name, lines ending with a newline; pictures and equations have no place in it."""
    name = printable(name)
    return "\n".join([name, "=" * len(name), *lines(sections)]) + "\n"


def lines(sections: Iterable[Section]) -> Iterator[str]:
    """Each section after an empty line."""
    for each in sections:
        yield from ("", each.title, "-" * len(each.title))
        for number, block in enumerate(each.blocks):
            if number:
                yield ""
            yield from block_lines(block)


def block_lines(block: Block) -> Iterator[str]:
    """The lines of a table or of sentences; of pictures and equations none."""
    if isinstance(block, Sentences):
        yield from block.lines
    elif isinstance(block, ReportTable):
        if block.title:
            yield block.title
        rows = [[str(cell) for cell in row] for row in block.rows]
        yield from columns([block.head, *rows] if block.head else rows, block.left)
