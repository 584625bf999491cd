"""The command ``find``: the dimension that just keeps its limits, or the best of them."""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from core.commands import DONE, DONE_WITH_ERRORS, NOTHING_DONE, Painter
from core.commands.common import as_json, design_file, drive_name, in_file, studied
from core.design import only, with_only
from core.design.fields import choice
from core.errors import KindynaError
from core.find import BOUNDS, LIMITS, ON_SHAFT, SEARCHES, WANTED, Solution, Stated, alone, find
from core.findings import ERROR
from core.frozen import frozen
from core.output.lines import finding_line
from core.output.summary import to_json
from core.project import load, number_of, save
from core.requests import asked, typed
from core.shaft import AIMS
from core.study import findings_of
from core.study.limits import FieldBound, Limit

PATIENCE = 2.0  # seconds between two lines that say how far it is


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


def _limits_help() -> str:
    keys = f"{' | '.join(LIMITS)} (radii of the profile), or the path of a varied field with _min or _max"
    table: Mapping[str, Limit | FieldBound] = {**LIMITS, **BOUNDS}
    usual = "; ".join(f"{key} {row.help}" for key, row in table.items() if row.help)
    return f"{keys}. What is not stated has the design's own limit, else the usual one: {usual}. none: no limit"


@frozen(kw_only=True)
class Arguments:
    """What is sought, in which design, and within which limits."""

    design: Path = design_file()
    drive: str = drive_name()
    what: str = typed("; ".join(f"{name}: {words}" for name, words in SEARCHES.items()), "WHAT")
    limit: tuple[tuple[str, float | None], ...] = typed(
        _limits_help(), default=(), action="append", type=_limit, metavar="KEY=VALUE"
    )
    aim: str = asked(
        choice("Aim", tuple(AIMS), default="peak", help="what of the torque the best phases make least"), "--for"
    )
    into: Path | None = typed("write the design with the answer", default=None, type=Path, metavar="FILE")
    json: bool = as_json()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The answer, or the best that there is and what stands against it."""
    whole, what = load(arguments.design), arguments.what
    if what in ON_SHAFT and arguments.drive:
        raise KindynaError(f"--drive {arguments.drive}: {what} is sought for the whole shaft; leave --drive out")
    number = 0 if what in ON_SHAFT else number_of(whole, arguments.drive)
    design = whole if what in ON_SHAFT else only(whole, number)
    solution = find(
        design,
        what,
        _limits(arguments.limit),
        aim=arguments.aim,
        tell=_Progress().tell,
        machine=alone if what in ON_SHAFT else partial(with_only, whole, number),
    )
    print(to_json(_data(solution)) if arguments.json else _text(solution), end="")
    if not solution.serves:
        print(f"no value serves; what stands against the best: {'; '.join(solution.against)}", file=sys.stderr)
        return NOTHING_DONE
    if arguments.into is not None:
        save(solution.machine, arguments.into)
    holding = what in WANTED and WANTED[what].holding
    study, stages = studied(solution.design), ("dynamics",) if what in ON_SHAFT or holding else ("cam",)
    errors = [finding for finding in findings_of(study, stages) if finding.severity == ERROR]
    for finding in errors if what in ON_SHAFT else in_file(errors, whole, number):
        print(finding_line(finding, study.angle_name), file=sys.stderr)
    return DONE_WITH_ERRORS if errors else DONE


class _Progress:
    """Says now and then how many designs were tried, to a reader at a terminal."""

    def __init__(self) -> None:
        self._last = time.monotonic()

    def tell(self, count: int) -> None:
        now = time.monotonic()
        if now - self._last > PATIENCE and sys.stderr.isatty():
            self._last = now
            print(f"{count} designs tried ...", file=sys.stderr)


def _limits(given: Sequence[tuple[str, float | None]]) -> Stated:
    """By key; raises KindynaError where a key is given two values."""
    limits = dict(given)
    for key, value in given:
        if value != limits[key]:
            both = (f"{key} = {'none' if each is None else f'{each:g}'}" for each in (value, limits[key]))
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
        "against": list(solution.against),
        "end": solution.end,
        "held_by": list(solution.held_by),
        "besides": list(solution.besides),
        "taken": dict(solution.taken),
        "assumed": dict(solution.assumed),
    }


def _text(solution: Solution) -> str:
    heading = f"{solution.wanted}:" if solution.serves else "the best that there is:"
    lines = [heading, *(f"  {path} = {value:.9g}" for path, value in solution.answer.items()), "reached:"]
    for key, value in solution.reached.items():
        number = f"{value:.7g}" if math.isfinite(value) else "none"
        limit, reason = solution.limits.get(key), solution.reasons.get(key)
        against = "" if limit is None else ", not undercut" if not limit and key in LIMITS else f", limit {limit:.6g}"
        lines.append(f"  {key} = {number}{against}{f' ({reason})' if reason else ''}")
    lines += [f"it rests on {path} = {value:.9g}, which is assumed" for path, value in solution.assumed.items()]
    if solution.end:
        lines.append(f"no limit holds it: it stands at the end, {solution.end}")
    lines += [f"beyond it: {text}" for text in solution.held_by]
    lines += [f"comes with it: {text}" for text in solution.besides]
    lines += [f"goes into the design: {path} = {value:.12g}" for path, value in solution.taken.items()]
    return "\n".join(lines) + "\n"
