"""Comparison of two designs: different inputs, common results, and findings of only one of them."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Mapping
from decimal import Decimal
from functools import lru_cache
from typing import Any

from core.design import Design
from core.findings import Finding
from core.frozen import frozen
from core.number_text import distinct_texts, input_text
from core.output.channels import channels
from core.output.explain.shaft import FIGURES, shaft_columns
from core.output.lines import columns, digits, finding_line, printable
from core.output.report.document import Document
from core.output.report.parts import Number, ReportTable, Section, Sentences, section, table
from core.output.summary import extremes, finding_rows, summary
from core.project.writing import to_table
from core.study import Study, findings_of
from core.units import Unit, quantity_kind, split_unit

Results = Mapping[tuple[str, str], float | None]
"""Quantity and its extreme (empty for a total) -> value."""
HEADER = ("what", "quantity", "of", "a", "b", "change")
MOST = 20
"""Results that a text shows: those that changed most."""
LONGEST = 32
"""Longest text in a column of the terminal; longer ones are on separate lines."""
SAME = 1e-12
"""Relative to the size of a result: a smaller change is rounding."""
LEAST_BASE = 0.1
"""Relative to the size of a quantity: the change of a smaller value says little in percent."""
NO_PERCENT = ("length", "angle")
"""Kinds of unit whose changes say more in their unit, such as those of a position."""


@frozen
class Difference:
    """A difference of two designs a and b.

    Attributes
    ----------
    quantity : path of an input in the file, or slug of a result
    of : ``max``, ``min``, or empty for inputs and totals
    a, b : values; None: missing or infinite
    size : largest magnitude of the quantity in both, to which the change is related
    is_input : whether it is an input
    label : name of a result as in plots, without its unit
    """

    quantity: str
    of: str
    a: Any
    b: Any
    size: float = 0.0
    is_input: bool = False
    label: str = ""

    @property
    def unit(self) -> Unit:
        """Unit of a result."""
        return split_unit(self.quantity)[1]

    @property
    def percent(self) -> float | None:
        """Change of a result in percent of the magnitude of a; None where the difference says more."""
        change, base = self.change, abs(self.a) if _is_number(self.a) else 0.0
        if change is None or self.is_input or quantity_kind(self.unit.symbol) in NO_PERCENT:
            return None
        keeps_sign = self.a * self.b > 0.0
        return 100.0 * change / base if keeps_sign and base >= LEAST_BASE * self.size else None

    @property
    def change(self) -> float | None:
        """Difference b - a of numbers, in their unit; None for words and missing values."""
        return self.b - self.a if _is_number(self.a) and _is_number(self.b) else None

    @property
    def share(self) -> float:
        """Change relative to the size: 0 for none, at most 2; infinite for words and for values in one design only."""
        if self.change is None:
            return 0.0 if self.a == self.b else math.inf
        return abs(self.change) / max(self.size, abs(self.a), abs(self.b)) if self.change else 0.0

    @property
    def texts(self) -> tuple[str, str, str]:
        """a, b and change for reading: inputs with all digits, results without rounding errors."""
        change: Any = self.change
        if self.is_input:
            if change is not None:
                change = float(Decimal(repr(self.b)) - Decimal(repr(self.a)))  # exact difference of the typed digits
            return _value_text(self.a, True), _value_text(self.b, True), _value_text(change, True)
        small = SAME * self.size
        values = [0.0 if _is_number(value) and abs(value) <= small else value for value in (self.a, self.b, change)]
        a, b, change = (_value_text(value, False) for value in values)
        if _is_number(values[0]) and _is_number(values[1]):
            a, b = distinct_texts(values[:2])
        return a, b, change


@frozen
class Comparison:
    """Comparison of two designs a and b, the largest changes first.

    Attributes
    ----------
    inputs : different inputs
    results : results of both designs
    gone, new : findings of a only, findings of b only
    """

    a: str
    b: str
    inputs: tuple[Difference, ...]
    results: tuple[Difference, ...]
    gone: tuple[Finding, ...]
    new: tuple[Finding, ...]

    @property
    def changed(self) -> tuple[Difference, ...]:
        """Results that differ."""
        return tuple(row for row in self.results if row.share > SAME)


@frozen(eq=False)
class ComparedDesign:
    """Data of a design for a comparison: inputs by their paths, results, findings by code and field."""

    name: str
    inputs: Mapping[str, Any]
    results: Results
    findings: Mapping[tuple[str, str], Finding]
    labels: Mapping[str, str]


@lru_cache(maxsize=2)  # the current design, and the one that it is compared with
def compared_design(study: Study) -> ComparedDesign:
    """Data of a design for a comparison. Raises NoSolution as the stages do."""
    findings = {(finding.code, finding.field): finding for finding in findings_of(study)}
    inputs, labels = _inputs(study.design), dict(_labels(study))
    return ComparedDesign(study.design.name, inputs, dict(_results(study)), findings, labels)


def compare_designs(a: ComparedDesign, b: ComparedDesign) -> Comparison:
    """Comparison of two designs, which may be of different kinds."""
    sizes = _sizes(a.results, b.results)
    results = [
        Difference(
            *key,
            value,
            b.results[key],
            sizes[key[0]],
            label=b.labels.get(key[0]) or key[0].replace("_", " ").capitalize(),
        )
        for key, value in a.results.items()
        if key in b.results
    ]
    return Comparison(
        a.name,
        b.name,
        _different_inputs(a.inputs, b.inputs),
        tuple(sorted(results, key=_worst)),
        tuple(finding for key, finding in a.findings.items() if key not in b.findings),
        tuple(finding for key, finding in b.findings.items() if key not in a.findings),
    )


def different_inputs(a: Design, b: Design) -> tuple[Difference, ...]:
    """Inputs that differ between two designs, without calculating a result."""
    return _different_inputs(_inputs(a), _inputs(b))


def _inputs(design: Design) -> dict[str, Any]:
    return dict(_entries(to_table(design)))


def _different_inputs(a: Mapping[str, Any], b: Mapping[str, Any]) -> tuple[Difference, ...]:
    rows = [Difference(path, "", a.get(path), b.get(path), is_input=True) for path in dict.fromkeys((*a, *b))]
    return tuple(sorted((row for row in rows if row.a != row.b), key=_worst))


def _worst(row: Difference) -> float:
    return -row.share


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _entries(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Values of a file with their paths; a list of numbers is one value."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _entries(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for i, inner in enumerate(value):
            yield from _entries(inner, f"{path}[{i}]")
    else:
        yield path, value


def _results(study: Study) -> Iterator[tuple[tuple[str, str], float | None]]:
    """Extremes and totals, also of listed drives: quantity and its extreme, value."""
    figures = summary(study)
    yield from _extreme_rows(figures["extremes"])
    for name in ("flywheel", "torque"):
        yield from (
            ((key if name == "flywheel" else f"torque_{key}", ""), value)
            for key, value in figures.get(name, {}).items()
        )
    yield from (
        ((f"{life['roller'].replace(' ', '_')}_life_hours", ""), life["hours"])
        for life in figures.get("rolling_life", ())
    )
    for slug, drive in study.solved_drives.items():
        if slug:
            yield from _extreme_rows(extremes(drive, drive.stages), f"{slug}.")


def _labels(study: Study) -> Iterator[tuple[str, str]]:
    """Results and their names as in plots; those of a listed drive begin with its name."""
    for name, figure in FIGURES.items():
        yield from ((name, figure.label), (f"torque_{name}", figure.label))
    if study.design.listed:
        yield from ((name, column.label) for name, column in shaft_columns(study).items())
    for slug, drive in study.solved_drives.items():
        for row in channels(drive.design):
            yield (f"{slug}.{row.slug}", f"{drive.design.name}: {row.label}") if slug else (row.slug, row.label)


def _sizes(*sets: Results) -> dict[str, float]:
    """Quantity -> its largest magnitude.

    A quantity that is rounding, such as a mean torque, gets the largest magnitude of all quantities in its unit.
    """
    sizes: dict[str, float] = {}
    for results in sets:
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


def _extreme_rows(rows: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[tuple[str, str], float | None]]:
    for slug, sides in rows.items():
        for side in ("max", "min"):
            value = sides[side]["value"]
            yield (prefix + slug, side), value if math.isfinite(value) else None


# -- files and text ----------------------------------------------------------------------------------------


def comparison_data(comparison: Comparison) -> dict[str, Any]:
    """A comparison as data for JSON."""
    return {
        "inputs": [{"path": row.quantity, "a": row.a, "b": row.b} for row in comparison.inputs],
        "results": [
            {"quantity": row.quantity, "of": row.of, "a": row.a, "b": row.b, "change": row.change}
            for row in comparison.results
        ],
        "findings": {"gone": finding_rows(comparison.gone), "new": finding_rows(comparison.new)},
    }


def comparison_csv(comparison: Comparison) -> str:
    """A comparison as CSV: different inputs, all results, findings, a row each."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    for kind, rows in (("input", comparison.inputs), ("result", comparison.results)):
        for row in rows:
            values = (("" if value is None else value) for value in (row.a, row.b, row.change))
            writer.writerow((kind, row.quantity, row.of, *values))
    for finding in comparison.gone:
        writer.writerow(("finding", finding.code, finding.field, finding.message, "", ""))
    for finding in comparison.new:
        writer.writerow(("finding", finding.code, finding.field, "", finding.message, ""))
    return text.getvalue()


def comparison_text(comparison: Comparison) -> str:
    """Differences as text for the terminal."""
    changed = comparison.changed
    rows = [(row.quantity, row.of, *row.texts) for row in (*comparison.inputs, *changed[:MOST])]
    short = [row for row in rows if max(map(len, row[2:])) <= LONGEST]
    names = [f"a: {printable(comparison.a)}", f"b: {printable(comparison.b)}"]
    lines = columns([HEADER[1:], *short], left=2) if short else []
    lines += [f"{name}\n  a: {a}\n  b: {b}" for name, _, a, b, _ in rows if max(len(a), len(b)) > LONGEST]
    message = [] if rows else ["The designs and their results are the same."]
    if len(changed) > MOST:
        message = [f"{len(changed) - MOST} more results changed less; --json and --out list them."]
    return "\n".join((*names, *lines, *message, *_finding_lines(comparison))) + "\n"


def comparison_document(comparison: Comparison) -> Document:
    """A comparison as a document."""
    header = ("a", "b", "Change")
    inputs = table(
        ("Input", *header),
        _cells(comparison.inputs, 1),
        slug="inputs",
        keys=[row.quantity for row in comparison.inputs],
    )
    results = table(("Result", "of", *header), _cells(comparison.changed, 2), left=2, slug="results")
    lines = _finding_lines(comparison) or ["The same."]
    return Document(
        f"{printable(comparison.a)} and {printable(comparison.b)}",
        (
            ("a", printable(comparison.a)),
            ("b", printable(comparison.b)),
            ("Inputs that differ", str(len(comparison.inputs))),
            ("Results that differ", str(len(comparison.changed))),
        ),
        (
            *_chapter("Inputs that differ", inputs),
            *_chapter("Results that differ, the largest share first", results),
            Section("New and removed findings", (Sentences(tuple(lines)),), 1),
        ),
    )


def _chapter(title: str, rows: ReportTable) -> list[Section]:
    return [Section(part.title, part.blocks, 1) for part in section(title, rows)]


def _cells(rows: Iterable[Difference], names: int) -> list[tuple[str | Number, ...]]:
    return [
        (row.quantity, row.of)[:names]
        + tuple(
            Number(value) if isinstance(value, float) and not row.is_input else text
            for value, text in zip((row.a, row.b, row.change), row.texts, strict=True)
        )
        for row in rows
    ]


def _value_text(value: Any, is_input: bool) -> str:
    """A value in words; an input with all its digits."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return input_text(value) if is_input else digits(value)
    return printable(", ".join(map(str, value)) if isinstance(value, list) else str(value))


def _finding_lines(comparison: Comparison) -> list[str]:
    return [
        f"{mark}: {finding_line(finding)}"
        for mark, rows in (("gone", comparison.gone), ("new", comparison.new))
        for finding in rows
    ]
