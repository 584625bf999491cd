"""The command line: ``python -m core COMMAND ...``, and the same behind ``kindyna --headless`` with pictures.

Exit codes: 0 done; 1 done and all files written, but a finding is an error; 2 nothing done.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import NoReturn

from core.blend import CONSTANT_VELOCITY, GOALS, MOTION_TYPES, SETTINGS, Request, best, blend
from core.centring import centres_data
from core.charting import stability_command, stability_words
from core.design import require_single_cam
from core.errors import KindynaError
from core.export import export, files
from core.files import write_all
from core.findings import ERROR
from core.making import blend_text, curves_data, into_design, laws_data, laws_text
from core.measured import measured_motion, measured_words
from core.project import load, save
from core.report import finding_line, printable, report
from core.stability import Chart, Figure
from core.study import SAMPLES, Study
from core.summary import to_json

DONE, DONE_WITH_ERRORS, NOTHING_DONE = 0, 1, 2
MOST_LINES = 100
LEAST_SAMPLES, MOST_SAMPLES = 4, 5_000_000

Painter = Callable[[Study | Chart | Figure], Mapping[str, bytes]]
"""Paints a study, or a chart or another figure of stability: file name -> content."""


class _Parser(argparse.ArgumentParser):
    """Says what is wrong with the words in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(NOTHING_DONE, f"{self.prog}: {message}; see {self.prog} --help\n")


@dataclass(frozen=True)
class Command:
    """One row: its help, the words it takes, what it does; ``run`` returns the exit code."""

    help: str
    words: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace, Painter | None], int]


def _samples(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = 0
    if not LEAST_SAMPLES <= value <= MOST_SAMPLES:
        raise argparse.ArgumentTypeError(f"{text!r}: samples per turn; allowed: {LEAST_SAMPLES} ... {MOST_SAMPLES}")
    return value


def _design(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("design", metavar="DESIGN", type=Path, help="design file (.toml)")


def _design_and_samples(parser: argparse.ArgumentParser) -> None:
    _design(parser)
    parser.add_argument("--samples", type=_samples, default=SAMPLES, metavar="N", help="cam angles per turn")


def _report_words(parser: argparse.ArgumentParser) -> None:
    _design_and_samples(parser)
    parser.add_argument("--out", type=_folder, metavar="DIR", help="also write report, summary and pictures there")


def _folder(text: str) -> Path:
    if not text.strip():
        raise argparse.ArgumentTypeError("a folder is wanted, nothing was given")
    return Path(text)


def _export_words(parser: argparse.ArgumentParser) -> None:
    _design_and_samples(parser)
    parser.add_argument("--out", type=_folder, default=Path("out"), metavar="DIR", help="folder to write to (out)")
    parser.add_argument("--only", nargs="+", default=[], metavar="STAGE", help="stages to compute and write")


def _verdict(study: Study, stages: Sequence[str] = ()) -> int:
    return DONE_WITH_ERRORS if any(f.severity == ERROR for f in study.findings(tuple(stages))) else DONE


def check(words: argparse.Namespace, painter: Painter | None) -> int:
    """Findings and certificate of a design."""
    study = Study(load(words.design))
    found, proof = study.findings(), study.certificate()
    for finding in found:
        print(finding_line(finding, study.angle_name))
    for name, residual in proof.items():
        if not residual.kept:
            print(f"certificate: {name} = {residual.value:.3g} exceeds its bound {residual.bound:.3g}")
    kept = sum(residual.kept for residual in proof.values())
    print(
        f"{printable(study.design.name)}: {len(found)} findings, {kept} of {len(proof)} residuals within their bounds"
    )
    return _verdict(study)


def full_report(words: argparse.Namespace, painter: Painter | None) -> int:
    """The report on the terminal; with a folder, also as files."""
    study = Study(load(words.design), words.samples)
    text = report(study)
    if words.out is not None:
        made: dict[str, str | bytes] = {"report.txt": text, "summary.json": files(study)["summary.json"]}
        made.update(_pictures(study, painter))
        write_all(words.out, made)
    print(text, end="")
    return _verdict(study)


def export_tables(words: argparse.Namespace, painter: Painter | None) -> int:
    """Tables and summary into a folder."""
    study = Study(load(words.design), words.samples)
    for path in export(study, words.out, words.only):
        print(path)
    return _verdict(study, words.only)


def _laws_words(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print JSON; infinite = null")


def _setting(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r}: must be NAME=NUMBER, one of {' | '.join(SETTINGS)}") from None


def _blend_words(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--type", required=True, choices=tuple(MOTION_TYPES), help="motion")
    parser.add_argument("--stroke", required=True, type=float, metavar="S", help="of the rise (mm, or --unit)")
    parser.add_argument("--return-stroke", type=float, default=0.0, metavar="S", help="where it differs")
    parser.add_argument("--start", required=True, type=float, metavar="DEG", help="cam angle where it starts")
    parser.add_argument("--end", required=True, type=float, metavar="DEG", help="cam angle where it ends")
    parser.add_argument(
        "--constant-velocity",
        nargs="?",
        const="rise",
        default="none",
        choices=CONSTANT_VELOCITY[1:],
        help="plain = rise",
    )
    parser.add_argument(
        "--set", action="append", default=[], type=_setting, metavar="NAME=VALUE", help=" | ".join(SETTINGS)
    )
    parser.add_argument("--sequence", default="", metavar="C1-H2-P2", help="this sequence and no other")
    parser.add_argument("--best", choices=tuple(GOALS), help="the gentlest, over what the settings leave free")
    parser.add_argument("--unit", choices=("mm", "deg"), default="mm")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--into", type=Path, metavar="DESIGN", help="write it into a design file")


def laws(words: argparse.Namespace, painter: Painter | None) -> int:
    """The table of laws with their peak coefficients."""
    print(to_json(laws_data()) if words.json else laws_text(), end="")
    return DONE


def blend_motion(words: argparse.Namespace, painter: Painter | None) -> int:
    """A blended motion, printed and perhaps written into a design."""
    constant = words.constant_velocity
    if constant == "rise" and words.type == "DRD-return":
        constant = "return"  # plain: of the one stroke there is
    request = Request(
        type=words.type,
        stroke=words.stroke,
        start=words.start,
        end=words.end,
        constant=constant,
        settings=dict(words.set),
        return_stroke=words.return_stroke,
        sequence=words.sequence,
        unit=words.unit,
    )
    found = best(request, words.best) if words.best else blend(request)
    if words.into is not None:
        save(into_design(require_single_cam(load(words.into)), found), words.into)
    print(to_json(curves_data(found)) if words.json else blend_text(found), end="")
    return DONE


def _centres_words(parser: argparse.ArgumentParser) -> None:
    _design(parser)
    parser.add_argument("--angle", type=_angle, required=True, metavar="DEG", help="of the driver")


def _angle(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.inf
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r}: angle of the driver in degrees; allowed: any number")
    return value


def centres(words: argparse.Namespace, painter: Painter | None) -> int:
    """Instant centres and velocities of a linkage at one position, as JSON."""
    print(to_json(centres_data(Study(load(words.design)), words.angle)), end="")
    return DONE


def _pictures(study: Study, painter: Painter | None) -> Mapping[str, bytes]:
    if painter is None:
        print("pictures left out: they need kindyna --headless", file=sys.stderr)
        return {}
    return painter(study)


COMMANDS: Mapping[str, Command] = MappingProxyType(
    {
        "check": Command("findings and proof of a design", _design, check),
        "report": Command("the whole report of a design", _report_words, full_report),
        "export": Command("tables as CSV and figures as JSON", _export_words, export_tables),
        "centres": Command("instant centres and velocities of a linkage at one position", _centres_words, centres),
        "laws": Command("the motion laws and their peak coefficients", _laws_words, laws),
        "blend": Command("a motion blended from elementary curves", _blend_words, blend_motion),
        "stability": Command("chart and forbidden speeds of a flexible camshaft", stability_words, stability_command),
        "measured": Command("a motion from a measured table", measured_words, measured_motion),
    }
)


def parser(program: str, rows: Mapping[str, Command] = COMMANDS) -> argparse.ArgumentParser:
    """All commands with their words."""
    made = _Parser(prog=program, description="Cam and mechanism design without a window.", allow_abbrev=False)
    commands = made.add_subparsers(metavar="COMMAND", required=True, dest="command")
    for name, row in rows.items():
        row.words(commands.add_parser(name, help=row.help, description=row.help, allow_abbrev=False))
    return made


def main(
    argv: Sequence[str] | None = None,
    painter: Painter | None = None,
    program: str = "python -m core",
    extra: Mapping[str, Command] = MappingProxyType({}),
) -> int:
    """Run one command; returns the exit code. painter paints pictures, None leaves them out; extra: more commands."""
    rows = {**COMMANDS, **extra}
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")
    try:
        words = parser(program, rows).parse_args(argv)
    except SystemExit as stop:
        return int(stop.code or 0)
    try:
        return rows[words.command].run(words, painter)
    except KindynaError as error:
        lines = str(error).split("\n")
        rest = len(lines) - MOST_LINES
        print(
            "\n".join(lines[:MOST_LINES]), *([f"and {rest} more faults"] if rest > 0 else []), sep="\n", file=sys.stderr
        )
        return NOTHING_DONE
    except BrokenPipeError:
        # the reader went away; nothing is left to tell it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return NOTHING_DONE


if __name__ == "__main__":
    sys.exit(main())
