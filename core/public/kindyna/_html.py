"""What notebooks show: designs, studies and results as HTML without scripts, whose text has the colours of the notebook."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from core.errors import KindynaError
from core.number_text import count_text, result_text, typeset
from core.output.drawing.svg import DECLARATION, allowed
from core.study.certificate import certificate_of
from core.study.findings import findings_of
from kindyna._columns import Columns
from kindyna._pictures import headlines, largest, machine

if TYPE_CHECKING:
    from kindyna._design import Design, FindResult, Optimum
    from kindyna._results import Explanation, Extreme, Finding, ManyResult

_COLOURS = {"error": "#b3261e", "warning": "#8a5300", "note": "#2f5f8a"}
_QUIET = "opacity:.75"
_CELL = "padding:.1em .8em .1em 0;text-align:{};vertical-align:top"
_MOST_ROWS, _MOST_FINDINGS = 12, 20


def _text(words: object) -> str:
    return escape(allowed(str(words)))


def _shown(value: Any) -> str:
    return (
        result_text(float(value), 6)
        if isinstance(value, int | float | np.number) and not isinstance(value, bool)
        else _text(value)
    )


def _card(title: str, note: str, *parts: str) -> str:
    """Return a card: title, a quiet note behind it, and parts."""
    head = f'<div><strong>{_text(title)}</strong> <span style="{_QUIET}">{_text(note)}</span></div>'
    return f'<div style="max-width:72em">{head}{"".join(parts)}</div>'


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]], left: Collection[int] = (0,)) -> str:
    """Return a table of escaped cells; the columns ``left`` hold words, the others numbers."""

    def line(tag: str, cells: Sequence[str]) -> str:
        sides = ("left" if i in left else "right" for i in range(len(cells)))
        drawn = (f'<{tag} style="{_CELL.format(side)}">{cell}</{tag}>' for side, cell in zip(sides, cells, strict=True))
        return f"<tr>{''.join(drawn)}</tr>"

    body = "".join(line("td", row) for row in rows)
    head = line("th", [_text(head) for head in heads])
    return f'<table style="border-collapse:collapse;margin:.4em 0">{head}{body}</table>' if body else ""


def _badge(severity: str) -> str:
    colour = _COLOURS.get(severity, _COLOURS["note"])
    return f'<span style="background:{colour};color:#fff;padding:0 .5em;border-radius:.3em">{_text(severity)}</span>'


def _message(severity: str, message: str, field: str = "") -> str:
    path = f' <code style="{_QUIET}">{_text(field)}</code>' if field else ""
    return f'<div style="margin:.25em 0">{_badge(severity)} {_text(typeset(message))}{path}</div>'


def _picture(columns: Columns, at_deg: float = 0.0) -> str:
    try:
        return machine(columns, at_deg).svg.removeprefix(DECLARATION)
    except KindynaError as error:
        return _message("error", str(error))


def _largest(columns: Columns) -> str:
    channels = columns.channels
    rows = []
    for name in headlines(columns):
        if (end := largest(columns, name)) is not None:
            channel = channels[name]
            rows.append(
                (_text(channel.label), result_text(end[0]), _text(channel.unit), f"{result_text(round(end[1], 2), 5)}°")
            )
    return _table(("Largest", "value", "unit", "at"), rows, left=(0, 2))


def _side(*parts: str) -> str:
    cells = "".join(f'<div style="flex:0 1 auto">{part}</div>' for part in parts if part)
    return f'<div style="display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start;margin:.4em 0">{cells}</div>'


def study_html(columns: Columns, kind: str) -> str:
    """Return name, mechanism, largest values, findings and certificate of a study."""
    study = columns.full
    note = f"{kind}, {count_text(columns.angle_deg.size)} angles"
    try:
        found, proof = findings_of(study), certificate_of(study)
        findings = [_message(row.severity, row.message, row.field) for row in found[:_MOST_FINDINGS]]
        if len(found) > _MOST_FINDINGS:
            findings.append(f"<div>{len(found) - _MOST_FINDINGS} further findings</div>")
        kept = sum(row.kept for row in proof.values())
        words = f"Certificate: {kept} of {len(proof)} residuals within their bounds"
        last = f'<div style="{_QUIET}">{"" if found else "No findings. "}{words}</div>'
        return _card(study.design.name, note, _side(_picture(columns), _largest(columns)), *findings, last)
    except KindynaError as error:
        return _card(study.design.name, kind, _message("error", str(error)))


def design_html(design: Design) -> str:
    """Return what its study shows; of a design without a solution its name and the reason."""
    try:
        return design.study()._repr_html_()
    except KindynaError as error:
        return _card(design.name, design.kind, _message("error", str(error)))


def extreme_html(extreme: Extreme) -> str:
    """Return value, unit and angle in one line."""
    value = f"{result_text(extreme.value, 6)}{'' if extreme.unit == '°' else ' '}{_text(extreme.unit)}"
    return f"<div><strong>{value}</strong> at {result_text(extreme.angle_deg, 6)}°</div>"


def finding_html(finding: Finding) -> str:
    """Return a finding in its colour."""
    return _message(finding.severity, finding.message, finding.field)


def explanation_html(explanation: Explanation) -> str:
    """Return value, equation, source, and a table of the symbols."""
    lines = "\n".join(_text(line) for line in explanation.equation)
    rows = [
        (
            _text(row["symbol"]),
            _text(row["meaning"]),
            _shown(row["value"]),
            _text(row["unit"]),
            _text(row.get("from") or ""),
        )
        for row in explanation.symbols
    ]
    value = f"{result_text(explanation.value, 6)} {explanation.unit}"
    source = f'<div style="{_QUIET}">{_text(explanation.source)}</div>'
    table = _table(("Symbol", "meaning", "value", "unit", "from"), rows, left=(0, 1, 3, 4))
    return _card(explanation.quantity, value, f"<pre>{lines}</pre>", source, table)


def many_html(many: ManyResult) -> str:
    """Return the number of designs, ranges of inputs and figures, and the reasons of designs without values, counted."""
    rows = []
    for name, column in [*many.inputs.items(), *many.value.items()]:
        if column.dtype.kind in "if":
            known = column[np.isfinite(column)]
            ends = (
                (result_text(float(known.min()), 6), result_text(float(known.max()), 6))
                if known.size
                else ("none", "none")
            )
            rows.append((_text(name), *ends, count_text(int(known.size))))
        else:
            words = sorted(set(map(str, column.tolist())))
            shown = ", ".join(words[:_MOST_ROWS]) + (", ..." if len(words) > _MOST_ROWS else "")
            rows.append((_text(name), _text(shown), "", count_text(int(column.size))))
    reasons = Counter(reason for reason in many.reason.tolist() if reason)
    parts = [
        _message("warning", f"{count} of {len(many)} designs without values: {reason}")
        for reason, count in reasons.most_common(_MOST_ROWS)
    ]
    return _card("Designs", count_text(len(many)), _table(("Column", "least", "largest", "known"), rows), *parts)


def _changes(before: Mapping[str, Any], answer: Mapping[str, Any]) -> str:
    rows = [(_text(path), _shown(before.get(path, "")), _shown(value)) for path, value in answer.items()]
    return _table(("Changed", "from", "to"), rows[:_MOST_ROWS])


def found_html(result: FindResult) -> str:
    """Return what changed, the limits with the values reached, and the mechanism."""
    reached = _table(("Limit", "reached"), [(_text(key), _shown(value)) for key, value in result.reached.items()])
    both = _changes(result._before, result.answer) + reached
    return _card(result.design.name, "found within the limits", _side(_picture(result.design.study()._columns), both))


def optimum_html(optimum: Optimum) -> str:
    """Return what changed, the goal, the binding limits, and the mechanism."""
    note = f"best of {optimum.starts} starts, {optimum.agreeing} of which lead to it"
    binding = _table(
        ("Binding limit", "goal per 1 % of it"),
        [(_text(row["limit"]), _shown(row["per_percent"])) for row in optimum.binding],
    )
    goal = f"<div>Goal {_shown(optimum.goal)}</div>"
    both = goal + _changes(optimum._before, optimum.answer) + binding
    return _card(optimum.design.name, note, _side(_picture(optimum.design.study()._columns), both))
