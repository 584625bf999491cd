"""What notebooks show of designs, studies, and searches: the mechanism with its figures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from core.errors import KindynaError
from core.number_text import count_text, result_text
from core.output.drawing.svg import DECLARATION
from core.study.certificate import certificate_of
from core.study.findings import findings_of
from kindyna._cards import MOST_ROWS, QUIET, card, escaped, message, table, value_text
from kindyna._columns import Columns
from kindyna._pictures import headlines, largest, machine

_MOST_FINDINGS = 20


def _picture(columns: Columns) -> str:
    """Return the mechanism at the first angle at which it can be assembled, or the reason why there is none."""
    try:
        at_deg = 0.0 if columns.full.design.listed else float(columns.full.angle_degrees[0])
        return machine(columns, at_deg).svg.removeprefix(DECLARATION)
    except KindynaError as error:
        return message("error", str(error))


def _largest(columns: Columns) -> str:
    channels = columns.channels
    rows = []
    for name in headlines(columns):
        if (end := largest(columns, name)) is not None:
            channel = channels[name]
            rows.append(
                (
                    escaped(channel.label),
                    result_text(end[0]),
                    escaped(channel.unit),
                    f"{result_text(round(end[1], 2), 5)}°",
                )
            )
    return table(("Largest", "value", "unit", "at"), rows, left=(0, 2))


def _side(*parts: str) -> str:
    cells = "".join(f'<div style="flex:0 1 auto">{part}</div>' for part in parts if part)
    return f'<div style="display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start;margin:.4em 0">{cells}</div>'


def study_html(columns: Columns, kind: str) -> str:
    """Return name, mechanism, largest values, findings and certificate of a study."""
    study = columns.full
    note = f"{kind}, {count_text(columns.angle_deg.size)} angles"
    try:
        rows, proof = findings_of(study), certificate_of(study)
        findings = [message(row.severity, row.message, row.field) for row in rows[:_MOST_FINDINGS]]
        if len(rows) > _MOST_FINDINGS:
            findings.append(f"<div>{len(rows) - _MOST_FINDINGS} further findings</div>")
        kept = sum(row.kept for row in proof.values())
        words = f"Certificate: {kept} of {len(proof)} residuals within their bounds"
        last = f'<div style="{QUIET}">{"" if rows else "No findings. "}{words}</div>'
        return card(study.design.name, note, _side(_picture(columns), _largest(columns)), *findings, last)
    except KindynaError as error:
        return card(study.design.name, kind, message("error", str(error)))


def _changes(before: Mapping[str, Any], answer: Mapping[str, Any]) -> str:
    rows = [(escaped(path), value_text(before.get(path, "")), value_text(value)) for path, value in answer.items()]
    return table(("Changed", "from", "to"), rows[:MOST_ROWS])


def found_html(
    columns: Columns, before: Mapping[str, Any], answer: Mapping[str, Any], reached: Mapping[str, Any]
) -> str:
    """Return what changed, the limits with the values reached, and the mechanism."""
    limits = table(("Limit", "reached"), [(escaped(key), value_text(value)) for key, value in reached.items()])
    both = _changes(before, answer) + limits
    return card(columns.full.design.name, "found within the limits", _side(_picture(columns), both))


def optimum_html(
    columns: Columns,
    before: Mapping[str, Any],
    answer: Mapping[str, Any],
    goal: float,
    binding: Iterable[Mapping[str, Any]],
    note: str,
) -> str:
    """Return what changed, the goal, the binding limits, and the mechanism."""
    rows = [(escaped(row["limit"]), value_text(row["per_percent"])) for row in binding]
    limits = table(("Binding limit", "goal per 1 % of it"), rows)
    both = f"<div>Goal {value_text(goal)}</div>" + _changes(before, answer) + limits
    return card(columns.full.design.name, note, _side(_picture(columns), both))
