"""Data of answers for JSON and tables."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, isfinite
from typing import Any

from core.synthesis.dyads import PIN, Dyad
from core.synthesis.judge import Answer
from core.synthesis.tasks import Synthesis

ANSWER_COLUMNS = (
    "rank",
    "kind",
    "design",
    "error_mm",
    "error_deg",
    "defects",
    "transmission_deg",
    "grashof",
    "length_ratio",
    "size_mm",
    "cognates",
)
"""Columns of ``answers.csv``, and keys of an answer in JSON."""
Names = tuple[str, tuple[str, ...]]


def design_names(answers: Sequence[Answer]) -> list[Names]:
    """File of each answer as a design, and those of its cognates."""
    return [
        (f"rank{i}.toml", tuple(f"rank{i}_cognate{k}.toml" for k in range(1, 1 + len(answer.cognates))))
        for i, answer in enumerate(answers, 1)
    ]


def answer_data(answer: Answer, rank: int, names: Names | None) -> dict[str, Any]:
    """Data of one answer; ``names`` are its files, None where it is not written."""
    return {
        "rank": rank,
        "kind": answer.candidate.kind,
        "design": names[0] if names else None,
        "error_mm": _finite(answer.error_mm),
        "error_deg": _finite(answer.error_deg),
        "defects": list(answer.defects),
        "transmission_deg": answer.transmission_deg,
        "grashof": answer.grashof,
        "length_ratio": _finite(answer.length_ratio),
        "size_mm": answer.size_mm,
        "cognates": list(names[1]) if names else [],
    }


def _finite(value: float) -> float | None:
    """The value; None where the linkage does not reach a position of its task, or a link has no length."""
    return value if isfinite(value) else None


def synthesis_data(synthesis: Synthesis, answers: Sequence[Answer], *, with_designs: bool) -> dict[str, Any]:
    """Data of a synthesis for JSON, with these answers; of a task of poses also the dyads."""
    names: Sequence[Names | None] = design_names(answers) if with_designs else [None] * len(answers)
    data: dict[str, Any] = {
        "answers": [answer_data(row, i, files) for i, (row, files) in enumerate(zip(answers, names, strict=True), 1)]
    }
    if synthesis.dyads:
        data["dyads"] = [dyad_data(dyad) for dyad in synthesis.dyads]
    return data | {"hidden": synthesis.hidden, "complete": synthesis.complete}


def dyad_data(dyad: Dyad) -> dict[str, Any]:
    """Data of a dyad."""
    data: dict[str, Any] = {
        "kind": dyad.kind,
        "fixed": [dyad.fixed.real, dyad.fixed.imag],
        "moving": [dyad.moving.real, dyad.moving.imag],
    }
    return data if dyad.kind == PIN else data | {"line_deg": degrees(dyad.line)}
