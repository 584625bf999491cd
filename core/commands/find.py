"""The command ``find``: the value of a dimension, or the phases of a shaft, that limits allow."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from core.commands import NOTHING_DONE, Painter
from core.commands.common import (
    DriveArguments,
    Progress,
    as_json,
    in_file,
    print_errors,
    rounding_data,
    rounding_lines,
    rounding_step,
    studied,
)
from core.design import Design, only, with_only
from core.design.fields import choice
from core.errors import KindynaError
from core.find import BOUNDS, CAM_SEARCHES, LIMITS, Solution, StatedLimits, same_design
from core.find.rounding import NO_ROUNDING, TORQUE
from core.findings import ERROR
from core.frozen import frozen
from core.number_text import COMPARED_DIGITS, distinct_texts, result_text
from core.output.summary import to_json
from core.project import load, number_of, save
from core.requests import option, text_option
from core.shaft import AIMS
from core.study import findings_of
from core.study.limits import FieldBound, Limit
from core.varying import MACHINE_SEARCHES, SEARCHES, TOP_SPEED, VariedField
from core.varying import search as search_design


def _limit(text: str) -> tuple[str, float | None]:
    key, equals, value = text.partition("=")
    if equals and value == "none":
        return key, None
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not equals or not math.isfinite(number):
        raise argparse.ArgumentTypeError(
            f"{text!r}: must be KEY=VALUE, the value a number with a decimal point, or none"
        )
    return key, number


def _varied(text: str) -> VariedField:
    path, equals, bounds = text.partition("=")
    low, colon, high = bounds.partition(":")
    try:
        numbers = float(low), float(high)
    except ValueError:
        numbers = math.nan, math.nan
    if not (equals and colon and all(map(math.isfinite, numbers))):
        raise argparse.ArgumentTypeError(f"{text!r}: must be PATH=LOW:HIGH, two numbers with a decimal point")
    return VariedField(path, *numbers)


def _limits_help() -> str:
    keys = f"{' | '.join(LIMITS)} (radii of the profile), or the path of a varied field with _min or _max"
    table: Mapping[str, Limit | FieldBound] = {**LIMITS, **BOUNDS}
    typical = "; ".join(f"{key} {row.help}" for key, row in table.items() if row.help)
    return f"{keys}. A limit that is not given is that of the design, else the typical one: {typical}. none: no limit"


@frozen(kw_only=True)
class FindArguments(DriveArguments):
    """Arguments of ``find``: a design, a dimension and its limits."""

    what: str = text_option("; ".join(f"{name}: {words}" for name, words in SEARCHES.items()), "WHAT")
    limit: tuple[tuple[str, float | None], ...] = text_option(
        _limits_help(), default=(), action="append", type=_limit, metavar="KEY=VALUE"
    )
    vary: tuple[VariedField, ...] = text_option(
        f"a number that {TOP_SPEED} varies, and its bounds; replaces spans, laws and phases",
        default=(),
        action="append",
        type=_varied,
        metavar="PATH=LOW:HIGH",
    )
    aim: str = option(
        choice("Aim", tuple(AIMS), default="peak", help="property of the torque that the phases minimise"), "--for"
    )
    into: Path | None = text_option("write the design with the solution", default=None, type=Path, metavar="FILE")
    round: float | None = rounding_step()
    json: bool = as_json()


def run_find(arguments: FindArguments, painter: Painter | None) -> int:
    """Print the solution, or the best value and the limits that it violates."""
    machine, what = load(arguments.design), arguments.what
    progress = Progress()
    solution = search(machine, arguments, lambda count: progress.report(f"{count} designs tried ..."))
    print(to_json(_data(solution)) if arguments.json else _text(solution, arguments.round), end="")
    if not solution.is_valid:
        print(
            f"no value satisfies every limit; the best one violates: {'; '.join(solution.violations)}", file=sys.stderr
        )
        return NOTHING_DONE
    if arguments.into is not None:
        save(solution.machine, arguments.into)
    is_contact_search = what in CAM_SEARCHES and CAM_SEARCHES[what].seeks_contact
    number = 0 if what in MACHINE_SEARCHES else number_of(machine, arguments.drive)
    study, stages = (
        studied(solution.design),
        ("dynamics",) if what in MACHINE_SEARCHES or is_contact_search else ("cam",),
    )
    errors = [finding for finding in findings_of(study, stages) if finding.severity == ERROR]
    return print_errors(study, errors if what in MACHINE_SEARCHES else in_file(errors, machine, number))


def search(machine: Design, arguments: FindArguments, notify: Callable[[int], None] = lambda count: None) -> Solution:
    """Search as requested in a design; ``notify`` gets the number of designs tried. Raises KindynaError for a wrong request."""
    what = arguments.what
    if what in MACHINE_SEARCHES and arguments.drive:
        raise KindynaError(f"--drive {arguments.drive}: {what} belongs to the whole shaft; omit --drive")
    number = 0 if what in MACHINE_SEARCHES else number_of(machine, arguments.drive)
    return search_design(
        machine if what in MACHINE_SEARCHES else only(machine, number),
        what,
        _limits(arguments.limit),
        aim=arguments.aim,
        vary=arguments.vary,
        rounding=arguments.round,
        notify=notify,
        machine=same_design if what in MACHINE_SEARCHES else partial(with_only, machine, number),
    )


def _limits(given: Sequence[tuple[str, float | None]]) -> StatedLimits:
    """Limits by key. Raises KindynaError for a key with two values."""
    limits = dict(given)
    for key, value in given:
        if value != limits[key]:
            both = (f"{key} = {'none' if bound is None else f'{bound:g}'}" for bound in (value, limits[key]))
            raise KindynaError(f"limit {', '.join(both)}: a limit has one value; give one")
    return limits


def _data(solution: Solution) -> dict[str, object]:
    return {
        "answer": dict(solution.answer),
        "reached": dict(solution.reached),
        "curve": [list(point) for point in solution.curve],
        "limits": dict(solution.limits),
        "reasons": dict(solution.reasons),
        "curve_of": solution.curve_of,
        "against": list(solution.violations),
        "end": solution.end,
        "held_by": list(solution.next_findings),
        "binding": [{"limit": limit, "per_percent": change} for limit, change in solution.binding],
        "besides": list(solution.notes),
        "taken": dict(solution.applied),
        "assumed": dict(solution.assumed),
        **rounding_data(solution.exact, solution.rounding, solution.cost),
    }


def _value_text(value: object) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def _text(solution: Solution, step: float | None) -> str:
    heading = f"{solution.target}:" if solution.is_valid else "the best value, which violates limits:"
    lines = [heading, *(f"  {path} = {_value_text(value)}" for path, value in solution.answer.items())]
    lines += rounding_lines(solution.answer, solution.exact, solution.rounding, solution.cost, step)
    if TORQUE in solution.before:
        taken, present = distinct_texts((solution.cost[TORQUE][1], solution.before[TORQUE]))
        lines.append(f"  {TORQUE} = {taken}, now {present}")
    lines.append("reached:")
    for key, value in solution.reached.items():
        limit, reason = solution.limits.get(key), solution.reasons.get(key)
        number, *limits = distinct_texts([value] if limit is None else [value, limit], COMPARED_DIGITS)
        against = ", not undercut" if limit == 0.0 and key in LIMITS else "".join(f", limit {text}" for text in limits)
        lines.append(f"  {key} = {number}{against}{f' ({reason})' if reason else ''}")
    lines += [f"it depends on {path} = {value:.9g}, which is assumed" for path, value in solution.assumed.items()]
    lines += [
        f"held by {limit}: "
        + (
            f"1 % of relief changes {solution.curve_of} by {result_text(change)}"
            if change
            else "relief of this limit alone changes nothing"
        )
        for limit, change in solution.binding
    ]
    if solution.end:
        lines.append(f"limited by the search range only: {solution.end}")
    lines += [f"beyond it: {text}" for text in solution.next_findings]
    lines += [text if text == NO_ROUNDING else f"also changes: {text}" for text in solution.notes]
    lines += [f"set in the design: {path} = {value:.12g}" for path, value in solution.applied.items()]
    return "\n".join(lines) + "\n"
