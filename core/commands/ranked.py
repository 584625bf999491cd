"""What laws and blends cost in a design, as the commands ``laws`` and ``blend`` print it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from core.design import Design, split_unit
from core.errors import KindynaError
from core.find import Ranked, RankingColumn, figures_of, in_order, ranking
from core.find.ranking import Candidate
from core.output.lines import columns, digits


def rows_of(
    design: Design, candidates: Mapping[str, Candidate], by: str
) -> tuple[tuple[RankingColumn, ...], list[Ranked]]:
    """The columns, and the rows in the order of one of them, by its key; of the first where none is named. Raises KindynaError."""
    figures = figures_of(design)
    if not figures:
        raise KindynaError(
            "this design has nothing to rank by: it needs a cam, and loads; give it both, or leave the design out"
        )
    keys = [figure.key for figure in figures]
    if by and by not in keys:  # the unit may be left out
        by = next((key for key in keys if split_unit(key)[0] == by), by)
    if by and by not in keys:
        raise KindynaError(f"--by {by}: this design has no such figure; allowed: {' | '.join(keys)}")
    return figures, in_order(list(ranking(candidates, figures)), keys.index(by) if by else 0)


def data_of(figures: Sequence[RankingColumn], row: Ranked) -> dict[str, Any]:
    """For JSON; ``problem`` is empty where the design takes it."""
    values = zip(figures, row.figures, strict=True)
    return {**{figure.key: value for figure, value in values}, "problem": row.problem}


def text_of(heading: str, figures: Sequence[RankingColumn], rows: Sequence[Ranked]) -> str:
    """A table with the reason at the end of each row that has no figures."""
    table: list[tuple[str, ...]] = [(heading, *(f"{figure.title} {figure.symbol}" for figure in figures), "")]
    for row in rows:
        table.append((row.name, *("–" if value is None else digits(value, 5) for value in row.figures), row.problem))
    widths = columns([row[:-1] for row in table])
    return "\n".join(f"{line}  {row[-1]}".rstrip() for line, row in zip(widths, table, strict=True)) + "\n"
