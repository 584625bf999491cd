"""The command ``synthesise``: linkages for a task."""

from __future__ import annotations

import csv
import io
import sys
from pathlib import Path
from typing import Any

from core.commands import DONE, DONE_WITH_ERRORS, Painter
from core.commands.common import as_json, out_folder
from core.design.fields import flag, whole
from core.errors import KindynaError
from core.frozen import frozen
from core.number_text import result_text
from core.output.summary import to_json
from core.project import dumps, save
from core.project.files import write_into
from core.requests import option, text_option
from core.synthesis import Answer, Synthesis, load_task, synthesise
from core.synthesis.results import ANSWER_COLUMNS, answer_data, design_names, synthesis_data

EXACT = 1e-9
"""Error, of the size or in degrees, that is rounding."""


@frozen(kw_only=True)
class SynthesiseArguments:
    """Arguments of ``synthesise``: a task, a folder for the answers, and a file for one of them."""

    task: Path = text_option("task file (.toml)", "TASK", type=Path)
    out: Path | None = out_folder("write every answer as a design to this folder, and answers.csv")
    into: Path | None = text_option("write one answer as a design", default=None, type=Path, metavar="FILE")
    rank: int = option(whole("Rank", 1, 9999, default=1, help="of the answer that is written, the best is 1"))
    all: bool = option(flag("All", help="list the answers with defects or beyond limits too, behind the others"))
    json: bool = as_json()


def run_synthesise(arguments: SynthesiseArguments, painter: Painter | None) -> int:
    """Print the answers, the best first; write them as designs."""
    if arguments.into is not None and arguments.into.resolve() == arguments.task.resolve():
        raise KindynaError(f"--into {arguments.into}: is the task that is read; choose another file")
    if arguments.rank > 1 and arguments.into is None:
        raise KindynaError(f"--rank {arguments.rank}: only together with --into FILE")
    synthesis = synthesise(load_task(arguments.task))
    answers = listed(synthesis, arguments.all)
    if arguments.into is not None:
        if arguments.rank > len(answers):
            raise KindynaError(f"--rank {arguments.rank}: no such answer; allowed: 1 ... {len(answers)}")
        save(answers[arguments.rank - 1].candidate.design, arguments.into)
    if arguments.out is not None:
        write_answers(answers, arguments.out)
    data = synthesis_data(synthesis, answers, with_designs=arguments.out is not None)
    print(to_json(data) if arguments.json else synthesis_text(synthesis, answers), end="")
    best = answers[0]
    if best.is_good:
        return DONE
    print(f"synthesise: the best answer has {_reasons(best)}", file=sys.stderr)
    return DONE_WITH_ERRORS


def listed(synthesis: Synthesis, include_hidden: bool) -> tuple[Answer, ...]:
    """Answers that are shown; with hidden ones behind them, or where there is no other."""
    return synthesis.answers if include_hidden else synthesis.answers[: max(synthesis.shown, 1)]


def write_answers(answers: tuple[Answer, ...], folder: Path) -> None:
    """Write all answers and their cognates as designs, and ``answers.csv``, completely or not at all."""
    files: dict[str, str | bytes] = {}
    for answer, (name, cognates) in zip(answers, design_names(answers), strict=True):
        files[name] = dumps(answer.candidate.design)
        files |= {file: dumps(row.candidate.design) for file, row in zip(cognates, answer.cognates, strict=True)}
    text = io.StringIO()
    table = csv.DictWriter(text, ANSWER_COLUMNS, lineterminator="\n")
    table.writeheader()
    for rank, (answer, names) in enumerate(zip(answers, design_names(answers), strict=True), 1):
        table.writerow({column: _cell(value) for column, value in answer_data(answer, rank, names).items()})
    write_into(folder, files | {"answers.csv": text.getvalue()})


def _cell(value: Any) -> str:
    """A value as text in a table: lists by spaces, true and false as in JSON."""
    if isinstance(value, list):
        return " ".join(value)
    return str(value).lower() if isinstance(value, bool) else "" if value is None else str(value)


def _error_text(answer: Answer) -> str:
    """The largest errors as text; ``exact`` where they are rounding."""
    if answer.error_mm <= EXACT * answer.size_mm and answer.error_deg <= EXACT:
        return "exact"
    errors = ((answer.error_mm, "mm"), (answer.error_deg, "deg"))
    return "error " + ", ".join(f"{result_text(error)} {unit}" for error, unit in errors if error > 0.0)


def _reasons(answer: Answer) -> str:
    defects = [f"the defect {defect}" for defect in answer.defects]
    return ", ".join([*defects, *(f"a value beyond {limit}" for limit in answer.violated)])


def synthesis_text(synthesis: Synthesis, answers: tuple[Answer, ...]) -> str:
    """The answers as text, a line each, and what they are a part of."""
    lines = []
    for rank, answer in enumerate(answers, 1):
        line = (
            f"{rank}: {answer.candidate.kind}, {_error_text(answer)}, transmission angle {result_text(answer.transmission_deg)} deg, "
            f"longest to shortest link {result_text(answer.length_ratio)}, size {result_text(answer.size_mm)} mm"
        )
        lines.append(line if answer.is_good else f"{line}; {_reasons(answer)}")
    hidden = len(synthesis.answers) - len(answers)
    if hidden:
        lines.append(f"{hidden} more with defects or beyond limits: --all lists them")
    lines.append("these are all answers" if synthesis.complete else "the best of a sweep: there are more")
    return "\n".join(lines) + "\n"
