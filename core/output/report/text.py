"""A report as plain text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from core.output.lines import columns, printable
from core.output.report.parts import Block, ReportTable, Section, Sentences


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


__all__ = ["block_lines", "lines", "text"]
