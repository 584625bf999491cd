"""Two designs held against each other: the inputs that differ, the results that both have, the findings that came or went."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Mapping
from decimal import Decimal
from typing import Any

from core.findings import Finding
from core.frozen import frozen
from core.output.lines import columns, digits, finding_line, printable, shortest
from core.output.report.document import Document
from core.output.report.parts import Number, ReportTable, Section, Sentences, section, table
from core.output.summary import extremes, finding_rows, summary
from core.project.writing import to_table
from core.study import Study, findings_of
from core.units import split_unit

Results = Mapping[tuple[str, str], float | None]
"""Quantity and what of it -> value."""
HEAD = ("what", "quantity", "of", "a", "b", "change")
LONGEST = 32
"""Letters of a word or list that stands in a column of the terminal; what is longer stands on lines of its own."""
SAME = 1e-12
"""Of the size of a result: a smaller change is rounding."""


@frozen
class Difference:
    """An input at its path in the file, or a result: slug of its quantity, of ``max``, ``min`` or empty for a total; None: not there, or
    infinite. size: of what the change is a share: the largest that the quantity becomes in either; typed: it is an input."""

    quantity: str
    of: str
    a: Any
    b: Any
    size: float = 0.0
    typed: bool = False

    @property
    def change(self) -> float | None:
        """b - a of numbers, in their unit; None of words, and where one is not there."""
        return self.b - self.a if _is_number(self.a) and _is_number(self.b) else None

    @property
    def share(self) -> float:
        """Change over size: 0 for none, at most 2; infinite for words, and where it is there on one side only."""
        if self.change is None:
            return 0.0 if self.a == self.b else math.inf
        return abs(self.change) / max(self.size, abs(self.a), abs(self.b)) if self.change else 0.0

    @property
    def texts(self) -> tuple[str, str, str]:
        """a, b and change for reading: what was typed as it was typed, of a result nothing of rounding."""
        change: Any = self.change
        if self.typed:
            if change is not None:
                change = float(Decimal(repr(self.b)) - Decimal(repr(self.a)))  # of what was typed: nothing of rounding
            return _shown(self.a, True), _shown(self.b, True), _shown(change, True)
        small = SAME * self.size
        values = (0.0 if _is_number(each) and abs(each) <= small else each for each in (self.a, self.b, change))
        a, b, moved = (_shown(each, False) for each in values)
        return a, b, moved


@frozen
class Comparison:
    """Of a and b, worst first: the inputs that differ, the results that both have; findings of a that b lacks, and of b that a lacks."""

    a: str
    b: str
    inputs: tuple[Difference, ...]
    results: tuple[Difference, ...]
    gone: tuple[Finding, ...]
    new: tuple[Finding, ...]

    @property
    def changed(self) -> tuple[Difference, ...]:
        """The results that are not the same."""
        return tuple(row for row in self.results if row.share > SAME)


@frozen(eq=False)
class Side:
    """All of one design that is compared: its name, inputs by their paths, results, findings by code and field."""

    name: str
    inputs: Mapping[str, Any]
    results: Results
    findings: Mapping[tuple[str, str], Finding]


def side_of(study: Study) -> Side:
    """Raises NoSolution as the stages do."""
    findings = {(each.code, each.field): each for each in findings_of(study)}
    return Side(study.design.name, dict(_leaves(to_table(study.design))), dict(_results(study)), findings)


def compared(a: Side, b: Side) -> Comparison:
    """Two designs, of unlike kinds too."""
    inputs = [
        Difference(path, "", a.inputs.get(path), b.inputs.get(path), typed=True)
        for path in dict.fromkeys((*a.inputs, *b.inputs))
    ]
    sizes = _sizes(a.results, b.results)
    results = [
        Difference(*key, value, b.results[key], sizes[key[0]]) for key, value in a.results.items() if key in b.results
    ]
    return Comparison(
        a.name,
        b.name,
        tuple(sorted((row for row in inputs if row.a != row.b), key=_worst)),
        tuple(sorted(results, key=_worst)),
        tuple(each for key, each in a.findings.items() if key not in b.findings),
        tuple(each for key, each in b.findings.items() if key not in a.findings),
    )


def _worst(row: Difference) -> float:
    return -row.share


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """The values of a file with their paths; a list of numbers is one value."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _leaves(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for i, inner in enumerate(value):
            yield from _leaves(inner, f"{path}[{i}]")
    else:
        yield path, value


def _results(study: Study) -> Iterator[tuple[tuple[str, str], float | None]]:
    """Extremes and totals, of drives that are listed their own too: quantity and what of it, value."""
    made = summary(study)
    yield from _of_extremes(made["extremes"])
    for name in ("flywheel", "torque"):
        for key, value in made.get(name, {}).items():
            yield (key if name == "flywheel" else f"torque_{key}", ""), value
    for life in made.get("rolling_life", ()):
        yield (f"{life['roller'].replace(' ', '_')}_life_hours", ""), life["hours"]
    for slug, each in study.solved_drives.items():
        if slug:
            yield from _of_extremes(extremes(each, each.stages), f"{slug}.")


def _sizes(*found: Results) -> dict[str, float]:
    """Quantity -> its largest magnitude; of one that is rounding beside the largest in its unit, as a mean torque or the couple on a guide
    may be, that one's."""
    sizes: dict[str, float] = {}
    for results in found:
        for (quantity, _), value in results.items():
            sizes[quantity] = max(sizes.get(quantity, 0.0), abs(value or 0.0))
    units = {quantity: split_unit(quantity)[1].symbol for quantity in sizes}
    largest: dict[str, float] = {}
    for quantity, size in sizes.items():
        largest[units[quantity]] = max(largest.get(units[quantity], 0.0), size)
    return {
        quantity: size if size > SAME * largest[units[quantity]] else largest[units[quantity]]
        for quantity, size in sizes.items()
    }


def _of_extremes(rows: Mapping[str, Any], before: str = "") -> Iterator[tuple[tuple[str, str], float | None]]:
    for slug, sides in rows.items():
        for side in ("max", "min"):
            value = sides[side]["value"]
            yield (before + slug, side), value if math.isfinite(value) else None


# -- as files and text -------------------------------------------------------------------------------------


def as_rows(found: Comparison) -> dict[str, Any]:
    """For JSON."""
    return {
        "inputs": [{"path": row.quantity, "a": row.a, "b": row.b} for row in found.inputs],
        "results": [
            {"quantity": row.quantity, "of": row.of, "a": row.a, "b": row.b, "change": row.change}
            for row in found.results
        ],
        "findings": {"gone": finding_rows(found.gone), "new": finding_rows(found.new)},
    }


def as_csv(found: Comparison) -> str:
    """Inputs that differ, then all results, then findings: one row each."""
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(HEAD)
    for what, rows in (("input", found.inputs), ("result", found.results)):
        for row in rows:
            values = (("" if value is None else value) for value in (row.a, row.b, row.change))
            out.writerow((what, row.quantity, row.of, *values))
    for finding in found.gone:
        out.writerow(("finding", finding.code, finding.field, finding.message, "", ""))
    for finding in found.new:
        out.writerow(("finding", finding.code, finding.field, "", finding.message, ""))
    return text.getvalue()


def as_text(found: Comparison) -> str:
    """What differs, for the terminal."""
    rows = [(row.quantity, row.of, *row.texts) for row in (*found.inputs, *found.changed)]
    short = [row for row in rows if max(map(len, row[2:])) <= LONGEST]
    names = [f"a: {printable(found.a)}", f"b: {printable(found.b)}"]
    lines = columns([HEAD[1:], *short], left=2) if short else []
    lines += [f"{name}\n  a: {a}\n  b: {b}" for name, _, a, b, _ in rows if max(len(a), len(b)) > LONGEST]
    same = [] if rows else ["The designs and their results are the same."]
    return "\n".join((*names, *lines, *same, *_finding_lines(found))) + "\n"


def as_document(found: Comparison) -> Document:
    """As a page to hand on."""
    head = ("a", "b", "Change")
    inputs = table(
        ("Input", *head), _cells(found.inputs, 1), slug="inputs", keys=[row.quantity for row in found.inputs]
    )
    results = table(("Result", "of", *head), _cells(found.changed, 2), left=2, slug="results")
    lines = _finding_lines(found) or ["The same."]
    return Document(
        f"{printable(found.a)} and {printable(found.b)}",
        (
            ("a", printable(found.a)),
            ("b", printable(found.b)),
            ("Inputs that differ", str(len(found.inputs))),
            ("Results that differ", str(len(found.changed))),
        ),
        (
            *_chapter("Inputs that differ", inputs),
            *_chapter("Results that differ, the largest share first", results),
            Section("Findings that came or went", (Sentences(tuple(lines)),), 1),
        ),
    )


def _chapter(title: str, rows: ReportTable) -> list[Section]:
    return [Section(each.title, each.blocks, 1) for each in section(title, rows)]


def _cells(rows: Iterable[Difference], names: int) -> list[tuple[str | Number, ...]]:
    return [
        (row.quantity, row.of)[:names]
        + tuple(
            Number(value) if isinstance(value, float) and not row.typed else text
            for value, text in zip((row.a, row.b, row.change), row.texts, strict=True)
        )
        for row in rows
    ]


def _shown(value: Any, typed: bool) -> str:
    """typed: with all its digits."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return shortest(value) if typed else digits(value)
    return printable(", ".join(map(str, value)) if isinstance(value, list) else str(value))


def _finding_lines(found: Comparison) -> list[str]:
    return [
        f"{mark}: {finding_line(each)}" for mark, rows in (("gone", found.gone), ("new", found.new)) for each in rows
    ]


__all__ = ["Comparison", "Difference", "as_csv", "as_document", "as_rows", "as_text", "compared", "side_of"]
