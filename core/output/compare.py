"""Two designs held against each other: the inputs that differ, the results that both have, the findings that came or went."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from core.findings import Finding
from core.frozen import frozen
from core.output.lines import columns, digits, finding_line, printable
from core.output.report.document import Document
from core.output.report.parts import Number, ReportTable, Section, Sentences, section, table
from core.output.summary import extremes, finding_rows, summary
from core.project.writing import to_table
from core.study import Study, findings_of

HEAD = ("what", "quantity", "of", "a", "b", "change")
LONGEST = 32
"""Letters of a word or list that a table shows."""
SAME = 1e-12
"""Of the size of a result: a smaller change is rounding."""


@frozen
class Difference:
    """An input at its path in the file, or a result: slug of its quantity, of ``max``, ``min`` or empty for a total; None: not there, or
    infinite. size: of what the change is a share: the largest that the quantity becomes in either."""

    quantity: str
    of: str
    a: Any
    b: Any
    size: float = 0.0

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


def compared(a: Study, b: Study) -> Comparison:
    """Two designs, of unlike kinds too. Raises NoAnswer as their stages do."""
    inputs = _differences(dict(_leaves(to_table(a.design))), dict(_leaves(to_table(b.design))))
    found = dict(_results(a)), dict(_results(b))
    sizes = _sizes(*found)
    results = [
        Difference(*key, value, found[1][key], sizes[key[0]]) for key, value in found[0].items() if key in found[1]
    ]
    findings = [{(each.code, each.field): each for each in findings_of(study)} for study in (a, b)]
    return Comparison(
        a.design.name,
        b.design.name,
        tuple(sorted((row for row in inputs if row.a != row.b), key=_worst)),
        tuple(sorted(results, key=_worst)),
        tuple(each for key, each in findings[0].items() if key not in findings[1]),
        tuple(each for key, each in findings[1].items() if key not in findings[0]),
    )


def _worst(row: Difference) -> float:
    return -row.share


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _differences(a: Mapping[str, Any], b: Mapping[str, Any]) -> list[Difference]:
    return [Difference(path, "", a.get(path), b.get(path)) for path in dict.fromkeys((*a, *b))]


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
    for slug, each in study.answering.items():
        if slug:
            yield from _of_extremes(extremes(each, each.stages), f"{slug}.")


def _sizes(*found: Mapping[tuple[str, str], float | None]) -> dict[str, float]:
    """Quantity -> its largest magnitude."""
    sizes: dict[str, float] = {}
    for results in found:
        for (quantity, _), value in results.items():
            sizes[quantity] = max(sizes.get(quantity, 0.0), abs(value or 0.0))
    return sizes


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
    rows = [
        (row.quantity, row.of, *(_shown(value) for value in (row.a, row.b, row.change)))
        for row in (*found.inputs, *found.changed)
    ]
    names = [f"a: {printable(found.a)}", f"b: {printable(found.b)}"]
    lines = columns([HEAD[1:], *rows], left=2) if rows else ["The designs and their results are the same."]
    return "\n".join((*names, *lines, *_finding_lines(found))) + "\n"


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
        ((row.quantity, row.of)[:names] + tuple(_cell(value) for value in (row.a, row.b, row.change))) for row in rows
    ]


def _cell(value: Any) -> str | Number:
    return Number(float(value)) if _is_number(value) else _shown(value)


def _shown(value: Any) -> str:
    if value is None:
        return ""
    if _is_number(value):
        return digits(float(value))
    text = printable(str(value))
    return text if len(text) <= LONGEST else f"{text[:LONGEST]} ..."


def _finding_lines(found: Comparison) -> list[str]:
    return [
        f"{mark}: {finding_line(each)}" for mark, rows in (("gone", found.gone), ("new", found.new)) for each in rows
    ]


__all__ = ["Comparison", "Difference", "as_csv", "as_document", "as_rows", "as_text", "compared"]
