"""Cards of what notebooks show: HTML without scripts, whose text has the colours of the notebook."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.number_text import count_text, result_text, typeset
from core.output.drawing.svg import allowed

_COLOURS = {"error": "#b3261e", "warning": "#8a5300", "note": "#2f5f8a"}
QUIET = "opacity:.75"
_CELL = "padding:.1em .8em .1em 0;text-align:{};vertical-align:top"
MOST_ROWS = 12


def escaped(words: object) -> str:
    """Return a text for HTML."""
    return escape(allowed(str(words)))


def value_text(value: Any) -> str:
    """Return a number with six digits, or a word."""
    return (
        result_text(float(value), 6)
        if isinstance(value, int | float | np.number) and not isinstance(value, bool)
        else escaped(value)
    )


def card(title: str, note: str, *parts: str) -> str:
    """Return a card: title, a quiet note behind it, and parts."""
    head = f'<div><strong>{escaped(title)}</strong> <span style="{QUIET}">{escaped(note)}</span></div>'
    return f'<div style="max-width:72em">{head}{"".join(parts)}</div>'


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], left: Collection[int] = (0,)) -> str:
    """Return a table of escaped cells; the columns ``left`` hold words, the others numbers."""

    def line(tag: str, cells: Sequence[str]) -> str:
        sides = ("left" if i in left else "right" for i in range(len(cells)))
        drawn = (f'<{tag} style="{_CELL.format(side)}">{cell}</{tag}>' for side, cell in zip(sides, cells, strict=True))
        return f"<tr>{''.join(drawn)}</tr>"

    body = "".join(line("td", row) for row in rows)
    head = line("th", [escaped(head) for head in heads])
    return f'<table style="border-collapse:collapse;margin:.4em 0">{head}{body}</table>' if body else ""


def _badge(severity: str) -> str:
    colour = _COLOURS.get(severity, _COLOURS["note"])
    return f'<span style="background:{colour};color:#fff;padding:0 .5em;border-radius:.3em">{escaped(severity)}</span>'


def message(severity: str, sentence: str, field: str = "") -> str:
    """Return a sentence with its severity in colour, and the path of a field."""
    path = f' <code style="{QUIET}">{escaped(field)}</code>' if field else ""
    return f'<div style="margin:.25em 0">{_badge(severity)} {escaped(typeset(sentence))}{path}</div>'


def extreme_line(value: float, unit: str, angle_deg: float) -> str:
    """Return value, unit and angle in one line."""
    number = f"{result_text(value, 6)}{'' if unit == '°' else ' '}{escaped(unit)}"
    return f"<div><strong>{number}</strong> at {result_text(angle_deg, 6)}°</div>"


def equation_card(
    name: str, value: str, equation: Iterable[str], source: str, symbols: Iterable[Mapping[str, Any]]
) -> str:
    """Return a quantity with its value, equation, source, and a table of the symbols."""
    lines = "\n".join(map(escaped, equation))
    rows = [
        (
            escaped(row["symbol"]),
            escaped(row["meaning"]),
            value_text(row["value"]),
            escaped(row["unit"]),
            escaped(row.get("from") or ""),
        )
        for row in symbols
    ]
    rest = table(("Symbol", "meaning", "value", "unit", "from"), rows, left=(0, 1, 3, 4))
    return card(name, value, f"<pre>{lines}</pre>", f'<div style="{QUIET}">{escaped(source)}</div>', rest)


def designs_card(columns: Mapping[str, NDArray[Any]], reason: NDArray[np.str_]) -> str:
    """Return the number of designs, the range of each column (m,), and the reasons (m,) of designs without values, counted."""
    rows = []
    for name, column in columns.items():
        if column.dtype.kind in "if":
            known = column[np.isfinite(column)]
            ends = tuple(result_text(float(end), 6) for end in (known.min(), known.max())) if known.size else ("", "")
            rows.append((escaped(name), *ends, count_text(int(known.size))))
        else:
            words = sorted(set(map(str, column.tolist())))
            listed = ", ".join(words[:MOST_ROWS]) + (", ..." if len(words) > MOST_ROWS else "")
            rows.append((escaped(name), escaped(listed), "", count_text(int(column.size))))
    reasons = Counter(code for code in reason.tolist() if code)
    parts = [
        message("warning", f"{count} of {reason.size} designs without values: {code}")
        for code, count in reasons.most_common(MOST_ROWS)
    ]
    return card("Designs", count_text(reason.size), table(("Column", "least", "largest", "known"), rows), *parts)
