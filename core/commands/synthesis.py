"""The command ``synthesise``: linkages for a task."""

from __future__ import annotations

import argparse
import csv
import io
import sys
from pathlib import Path
from typing import Any

from core.bounds import number_from_one
from core.commands import DONE, DONE_WITH_ERRORS, Painter
from core.commands.common import as_json, drive_name, out_folder
from core.design import Design, faults, only, with_mechanism
from core.design.fields import flag, whole
from core.errors import DesignError, KindynaError
from core.frozen import frozen
from core.number_text import result_text
from core.output.load_text import part_names
from core.output.summary import to_json
from core.project import dumps, load, number_of, save
from core.project.files import write_into
from core.requests import option, text_option
from core.synthesis import Answer, Dyad, Synthesis, Task, load_task, synthesise
from core.synthesis.chosen import answer_of_dyads, driven_by_other_link
from core.synthesis.results import ANSWER_COLUMNS, answer_data, design_names, synthesis_data
from core.synthesis.takeover import taken_over, under_motion

EXACT = 1e-9
"""Error, of the size or in degrees, that is rounding."""


WRITTEN_KEYS = ("kind", "error_mm", "error_deg", "defects", "transmission_deg", "grashof", "length_ratio", "size_mm")
"""Keys of the written answer in JSON."""


def _count(text: str) -> int:
    number = number_from_one(text, 9999)
    if not number:
        raise argparse.ArgumentTypeError(f"{text!r}: number of a dyad; allowed: 1 ... 9999")
    return number


@frozen(kw_only=True)
class SynthesiseArguments:
    """Arguments of ``synthesise``: a task, a folder for the answers, and a file for one of them."""

    task: Path = text_option("task file (.toml)", "TASK", type=Path)
    out: Path | None = out_folder("write every answer as a design to this folder, and answers.csv")
    into: Path | None = text_option("write one answer as a design", default=None, type=Path, metavar="FILE")
    rank: int = option(whole("Rank", 1, 9999, default=1, help="of the answer that is written, the best is 1"))
    dyads: tuple[int, ...] = text_option(
        "write the linkage of two dyads instead, by their numbers in the list of --json from 1 on",
        default=(),
        nargs=2,
        type=_count,
        metavar=("FIRST", "SECOND"),
    )
    other_driver: bool = option(
        flag("Drive by the other link", help="the other side link drives the written answer, which is judged again")
    )
    design: Path | None = text_option(
        "present design (.toml), whose speed, shaft and loads the written answer keeps",
        default=None,
        type=Path,
        metavar="DESIGN",
    )
    drive: str = drive_name()
    under_motion: bool = option(
        flag("Under the motion", help="the motion of the present design drives the written answer")
    )
    all: bool = option(flag("All", help="list the answers with defects or beyond limits too, behind the others"))
    json: bool = as_json()


def run_synthesise(arguments: SynthesiseArguments, painter: Painter | None) -> int:
    """Print the answers, the best first; write them as designs."""
    _require_consistent(arguments)
    task = load_task(arguments.task)
    synthesis = synthesise(task)
    answers = listed(synthesis, arguments.all)
    judged = answers[0]
    data = synthesis_data(synthesis, answers, with_designs=arguments.out is not None)
    text = synthesis_text(synthesis, answers)
    if arguments.into is not None:
        written, left_out = _write_one(arguments, task, synthesis, answers)
        row = answer_data(written, arguments.rank, None)
        data["into"] = {key: row[key] for key in WRITTEN_KEYS} | {"left_out": left_out}
        if arguments.dyads or arguments.other_driver:
            judged = written
            text += f"{arguments.into}: {_line(written)}\n"
        if left_out:
            text += f"{arguments.into}: without {', '.join(left_out)} of {arguments.design}\n"
    if arguments.out is not None:
        write_answers(answers, arguments.out)
    print(to_json(data) if arguments.json else text, end="")
    if judged.is_good:
        return DONE
    subject = "the best answer" if judged is answers[0] else "the written answer"
    print(f"synthesise: {subject} has {_reasons(judged)}", file=sys.stderr)
    return DONE_WITH_ERRORS


def _require_consistent(arguments: SynthesiseArguments) -> None:
    """Raise KindynaError for options that need another one, or exclude each other."""
    into, design = arguments.into, arguments.design
    if into is not None and any(
        file is not None and into.resolve() == file.resolve() for file in (arguments.task, design)
    ):
        raise KindynaError(f"--into {into}: is a file that is read; choose another file")
    if arguments.rank > 1 and arguments.dyads:
        raise KindynaError(f"--rank {arguments.rank}: cannot be combined with --dyads; give one of them")
    given = {
        f"--rank {arguments.rank}": arguments.rank > 1,
        "--dyads": bool(arguments.dyads),
        "--other-driver": arguments.other_driver,
        f"--design {design}": design is not None,
    }
    for words, is_given in given.items():
        if is_given and into is None:
            raise KindynaError(f"{words}: only together with --into FILE")
    for words, is_given in {"--under-motion": arguments.under_motion, "--drive": bool(arguments.drive)}.items():
        if is_given and design is None:
            raise KindynaError(f"{words}: only together with --design DESIGN")


def _write_one(
    arguments: SynthesiseArguments, task: Task, synthesis: Synthesis, answers: tuple[Answer, ...]
) -> tuple[Answer, list[str]]:
    """Write the requested answer as a design; it, and the names of the parts of the present design that do not fit it."""
    assert arguments.into is not None
    if arguments.dyads:
        answer = answer_of_dyads(task, *(_numbered(synthesis, number) for number in arguments.dyads))
    elif arguments.rank <= len(answers):
        answer = answers[arguments.rank - 1]
    else:
        raise KindynaError(f"--rank {arguments.rank}: no such answer; allowed: 1 ... {len(answers)}")
    if arguments.other_driver:
        answer = driven_by_other_link(answer, task)
    if arguments.design is None:
        save(answer.candidate.design, arguments.into)
        return answer, []
    machine = load(arguments.design)
    design, left_out = design_in(machine, arguments.drive, answer, task, by_motion=arguments.under_motion)
    save(design, arguments.into)
    return answer, left_out


def design_in(
    machine: Design, drive: str, answer: Answer, task: Task, *, by_motion: bool = False
) -> tuple[Design, list[str]]:
    """A present design with an answer in place of the mechanism of one drive, and the names of the parts that do not fit it."""
    number = number_of(machine, drive)
    present = only(machine, number)
    takeover = under_motion(answer, task, present) if by_motion else taken_over(answer, present)
    design = with_mechanism(machine, number, takeover.design)
    if wrong := faults(design):
        raise DesignError(wrong)
    return design, part_names(present, takeover.left_out)


def _numbered(synthesis: Synthesis, number: int) -> Dyad:
    """Dyad by its number in the list of JSON, which counts from 1."""
    if not synthesis.dyads:
        raise KindynaError("--dyads: only for a task of kind poses")
    if not 1 <= number <= len(synthesis.dyads):
        raise KindynaError(f"--dyads: {number} is no number of a dyad; allowed: 1 ... {len(synthesis.dyads)}")
    return synthesis.dyads[number - 1]


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


def _line(answer: Answer) -> str:
    """The figures of an answer as text, with its defects."""
    line = (
        f"{answer.candidate.kind}, {_error_text(answer)}, transmission angle {result_text(answer.transmission_deg)} deg, "
        f"longest to shortest link {result_text(answer.length_ratio)}, size {result_text(answer.size_mm)} mm"
    )
    return line if answer.is_good else f"{line}; {_reasons(answer)}"


def synthesis_text(synthesis: Synthesis, answers: tuple[Answer, ...]) -> str:
    """The answers as text, a line each, and what they are a part of."""
    lines = [f"{rank}: {_line(answer)}" for rank, answer in enumerate(answers, 1)]
    hidden = len(synthesis.answers) - len(answers)
    if hidden:
        lines.append(f"{hidden} more with defects or beyond limits: --all lists them")
    lines.append("these are all answers" if synthesis.complete else "the best of a sweep: there are more")
    return "\n".join(lines) + "\n"
