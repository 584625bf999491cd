"""What the papers say against what comes out here, as files: the rows as text and as JSON, their figures as tables."""

from __future__ import annotations

import csv as comma
from collections import Counter
from collections.abc import Iterable, Sequence
from io import StringIO
from textwrap import wrap
from typing import Any

import numpy as np

from core.output.export import csv
from core.output.stability_files import UNSEEN, tables
from core.papers import VERDICTS, Claim, Examples, FigureTable
from core.papers.kim1990.chart import FIGURES, ROWS, averages, runs
from core.papers.kim1990.sheets import DISPLACEMENT
from core.plot import Figure
from core.stability import Chart, Stability, averages_plots, chart, coefficients_plot, history_plot

LINE = 108  # characters of a claim's line
HARD_SPACE = "\N{NO-BREAK SPACE}"


def rows_data(claims: Sequence[Claim]) -> list[dict[str, str]]:
    """One row a claim; ``file``: its table, relative to the folder of all papers."""
    return [
        {
            "paper": c.paper,
            "where": c.where,
            "says": c.says,
            "here": c.here,
            "verdict": c.verdict,
            "file": table_file(c),
        }
        for c in claims
    ]


def table_file(claim: Claim) -> str:
    """Where its numbers stand; pictures have the same name with another ending."""
    return f"{claim.paper}/{claim.name}.csv"


def table_text(table: FigureTable) -> str:
    """As CSV: numbers alone as in every other table; where there are words, these as they are."""
    if not any(isinstance(column, tuple) for column in table.columns):
        return csv(table.names, [np.asarray(column) for column in table.columns])
    text = StringIO()
    writer = comma.writer(text, lineterminator="\n")
    writer.writerow(table.names)
    writer.writerows([_cell(value) for value in row] for row in table.rows)
    return text.getvalue()


def _cell(value: Any) -> str:
    return value if isinstance(value, str) else repr(float(value))


def tables_of(claims: Sequence[Claim]) -> dict[str, str | bytes]:
    """File name -> text of the tables of the claims, each once."""
    first = {table_file(claim): claim for claim in reversed(claims)}
    return {name: table_text(first[name].table) for name in dict.fromkeys(table_file(claim) for claim in claims)}


# -- as text ------------------------------------------------------------------------------------------------


def claims_text(head: str, claims: Sequence[Claim]) -> str:
    """The claims of a paper against ours under a heading, and how many there are of each verdict, with what it means."""
    lines = [head, "=" * len(head)]
    for claim in claims:
        lines += ["", f"{claim.where}: {claim.verdict}"]
        for who, sentence in (("the paper", claim.says), ("here", claim.here)):
            start = f"    {who + ':':<11}"
            kept = sentence.replace(" = ", f"{HARD_SPACE}={HARD_SPACE}")
            rows = wrap(kept, LINE, initial_indent=start, subsequent_indent=" " * len(start))
            lines += [row.replace(HARD_SPACE, " ") for row in rows]
    counts = [(verdict, count, VERDICTS[verdict]) for verdict, count in counted(claims)]
    return (
        "\n".join([*lines, "", *(f"{count:4d}  {verdict:<14}{meaning}" for verdict, count, meaning in counts)]) + "\n"
    )


def counted(claims: Iterable[Claim]) -> list[tuple[str, int]]:
    """The verdicts that there are, in the order of their table, and how many of each."""
    counts = Counter(claim.verdict for claim in claims)
    return [(verdict, counts[verdict]) for verdict in VERDICTS if counts[verdict]]


# -- Kim1990's, of the example or of a file like it -----------------------------------------------------------


def kim_files(
    examples: Examples, shaft: Stability, periods: float, eta_max: float
) -> tuple[dict[str, str | bytes], Chart, tuple[Figure, ...]]:
    """Kim1990's Figs. 4 to 12: the tables they are drawn from, the chart, which is Fig. 8, and the others."""
    damping = shaft.machine.damping
    histories, means = runs(examples, periods, damping), averages(examples, ROWS, eta_max, damping)
    made = tables(shaft, np.array(sorted({q for _, _, q, _ in FIGURES})), histories, means, eta_max)
    wind_up, slope = averages_plots(means)
    profile = DISPLACEMENT.drawing
    assert profile is not None
    numbered = {
        5: coefficients_plot(shaft.coefficients, ("ψ",)),
        6: wind_up,
        7: slope,
        **{number: history_plot(each) for (number, *_), each in zip(FIGURES, histories, strict=True)},
    }
    figures = [Figure(f"figure_{n}", f"Kim1990 Fig. {n}", (plot,)) for n, plot in numbered.items()]
    fourth = profile(examples)
    assert isinstance(fourth, Figure)
    drawn = chart(shaft.coefficients, None, "Kim1990 Fig. 8", eta_max=eta_max, error=UNSEEN)
    return {**made, "figure_4.csv": table_text(DISPLACEMENT.table(examples))}, drawn, (fourth, *figures)
