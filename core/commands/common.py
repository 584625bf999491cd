"""Options of several commands, and the exit code of findings and certificate."""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from core.bounds import number_from_one
from core.commands import DONE, DONE_WITH_ERRORS, Drawn, Painter
from core.design import BALANCER, Design, in_machine, path_in
from core.design.fields import whole
from core.errors import KindynaError, NoSolution
from core.findings import ERROR, Finding, Residual
from core.frozen import frozen
from core.number_text import distinct_texts
from core.output.lines import finding_line
from core.project import load, number_of, one_of
from core.requests import text_option
from core.study import SAMPLES, Study, certificate_of, findings_of

LEAST_SAMPLES, MOST_SAMPLES = 4, 5_000_000


def folder(text: str) -> Path:
    """Read the path of a folder to write to."""
    if not text.strip():
        raise argparse.ArgumentTypeError("empty; give the path of a folder")
    return Path(text)


def ending_with(what: str, *endings: str) -> Callable[[str], Path]:
    """Return a reader of file names with one of these endings."""

    def read(text: str) -> Path:
        path = Path(text)
        if path.suffix.lower() not in endings:
            raise argparse.ArgumentTypeError(f"{text!r}: file of {what}; allowed endings: {', '.join(endings)}")
        return path

    return read


def picture_size(least: int, most: int) -> Callable[[str], tuple[int, int]]:
    """Return a reader of width and height of a picture in pixels, as ``1440x900``."""

    def read(text: str) -> tuple[int, int]:
        sides = text.replace("×", "x").split("x")
        if len(sides) != 2 or not all(number_from_one(side, most) >= least for side in sides):
            allowed = f"WIDTHxHEIGHT, both {least} ... {most} pixels, such as 1440x900"
            raise argparse.ArgumentTypeError(f"{text!r}: size of a picture; allowed: {allowed}")
        return int(sides[0]), int(sides[1])

    return read


# -- options of several commands ------------------------------------------------------------------------


def design_file() -> Any:
    """Option: the design file."""
    return text_option("design file (.toml)", "DESIGN", type=Path)


def drive_name() -> Any:
    """Option: the drive, where a design has several."""
    return text_option("name of one drive of a camshaft", "--drive", default="", metavar="NAME")


@frozen(kw_only=True)
class DriveArguments:
    """Arguments of the commands about one drive: a design, and the name of the drive."""

    design: Path = design_file()
    drive: str = drive_name()


def samples_per_turn(label: str = "Samples per turn", help: str = "cam angles per turn", default: int = SAMPLES) -> Any:
    """Option: the number of samples of a turn."""
    return whole(label, LEAST_SAMPLES, MOST_SAMPLES, default=default, help=help)


def out_folder(help: str, **how: Any) -> Any:
    """Option: a folder for files; without a default the files are written besides the printed text."""
    return text_option(help, "--out", type=folder, metavar="DIR", **{"default": None, **how})


def rounding_data(
    exact: Mapping[str, float], rounding: Mapping[str, float], cost: Mapping[str, Sequence[float]]
) -> dict[str, Any]:
    """Exact values, steps and cost of rounded values, as data; empty without ``--round``."""
    costs = {key: list(ends) for key, ends in cost.items()}
    return {"exact": dict(exact), "rounding": dict(rounding), "cost": costs} if exact else {}


def rounding_lines(
    taken: Mapping[str, float],
    exact: Mapping[str, float],
    rounding: Mapping[str, float],
    cost: Mapping[str, tuple[float, float]],
    requested: float | None,
) -> list[str]:
    """Exact values of rounded ones, steps that are finer than the requested one, and quantities that the rounding changes."""
    from core.find.rounding import finer_step_text  # imported here to save start-up time of the other commands

    lines = []
    for path, value in exact.items():
        finer = finer_step_text(path, value, rounding[path], requested or 0.0) if path in rounding else ""
        if finer or taken[path] != value:
            lines.append(f"  exact {path} = {value:.9g}{f' ({finer})' if finer else ''}")
    for key, ends in cost.items():
        before, after = distinct_texts(ends)
        if before != after:
            lines.append(f"  {key} = {after}, exact {before}")
    return lines


def rounding_step() -> Any:
    """Field ``--round``: None without it, 0 without a step."""
    return text_option(
        "round the values to multiples of STEP, each in its unit, to the side on which every limit holds; without STEP: 0.1 mm, 0.1 deg, "
        "else three significant digits", "--round", default=None, nargs="?", const=0.0, type=_step, metavar="STEP",
    )  # fmt: skip


def _step(text: str) -> float:
    try:
        step = float(text)
    except ValueError:
        step = math.nan
    if not 0.0 < step < math.inf:
        raise argparse.ArgumentTypeError(
            f"{text!r}: step of the values; allowed: above 0, a number with a decimal point"
        )
    return step


def as_json(help: str = "print JSON") -> Any:
    """Option: print JSON."""
    return text_option(help, "--json", default=False, action="store_true")


def sorted_by() -> Any:
    """Option: the column by which a ranking is sorted."""
    return text_option(
        "column by which the rows are sorted, as in JSON (peak_torque_nm)", "--by", default="", metavar="COLUMN"
    )


def studied(design: Design, samples: int = SAMPLES) -> Study:
    """The study of a design. Raises NoSolution where none of several drives has a solution."""
    return solved(Study(design, samples))


def solved(study: Study) -> Study:
    """The study. Raises NoSolution where none of several drives has a solution."""
    if not study.solved_drives:
        raise next(iter(study.camshaft.failures.values()))
    return study


def one_studied(design: Design, drive: str) -> Study:
    """The study of a drive by its name, or of the balance cam. Raises KindynaError for an unknown name, and NoSolution."""
    if drive == BALANCER and design.balancer is not None and (balancer := Study(design).camshaft.balancer) is not None:
        return Study(in_machine(design, balancer.design))
    return Study(one_of(design, drive))


def require_cam(study: Study, command: str) -> None:
    """Raise KindynaError for a design without a cam."""
    if not study.has_disk:
        kind, allowed = ("disk cam", "one with a disk cam") if study.has_surface else ("cam", "one with [cam]")
        raise KindynaError(f"{command}: this design has no {kind}; allowed: {allowed}")


def require_shaft(study: Study) -> None:
    """Raise KindynaError for a design without a shaft that turns a cam or a crank."""
    if "stability" not in study.stages:
        raise KindynaError("stability: no shaft turns a cam or a crank in this design; allowed: one with [shaft]")


def field_of_file(design: Design, number: int, field: str) -> str:
    """Path of a field of a drive in the file of several drives."""
    return field if field.startswith("shaft") else path_in(design, number, field)


def named_in_file(error: KindynaError, arguments: argparse.Namespace) -> KindynaError:
    """The error with the path of its field in the file, where a drive of several has no solution; any other error unchanged."""
    drive = getattr(arguments, "drive", None)
    if drive is None or drive == BALANCER or not isinstance(error, NoSolution):
        return error
    if error.field.startswith(("shaft", "drives[", "balancer")):  # already a path of the file
        return error
    design = load(arguments.design)
    return type(error)(
        error.problem, field_of_file(design, number_of(design, drive), error.field), error.hint, error.cam_angles
    )


def in_file(findings: Iterable[Finding], design: Design, number: int) -> list[Finding]:
    """Findings of a drive with the paths of their fields in the file."""
    return [replace(finding, field=field_of_file(design, number, finding.field)) for finding in findings]


def verdict(study: Study, stages: Sequence[str] = ()) -> int:
    """Exit code of the stages, of all where none is named: an error among the findings, or a residual above its bound."""
    return verdict_on(findings_of(study, tuple(stages)), certificate_of(study, tuple(stages)))


def verdict_on(findings: Iterable[Finding], certificate: Mapping[str, Residual]) -> int:
    """Exit code of findings and certificate: an error among the findings, or a residual above its bound."""
    bad = any(f.severity == ERROR for f in findings) or not all(residual.kept for residual in certificate.values())
    return DONE_WITH_ERRORS if bad else DONE


def print_errors(study: Study, findings: Iterable[Finding]) -> int:
    """Print findings that are errors to stderr, and return the exit code."""
    rows = list(findings)
    for finding in rows:
        print(finding_line(finding, study.angle_name), file=sys.stderr)
    return DONE_WITH_ERRORS if rows else DONE


class Progress:
    """Prints a line of progress, every ``PATIENCE`` seconds, on a terminal."""

    PATIENCE = 2.0  # seconds between two lines

    def __init__(self) -> None:
        self._last = time.monotonic()

    def report(self, line: str) -> None:
        """Print a line where enough time has passed since the last one."""
        now = time.monotonic()
        if now - self._last > self.PATIENCE and sys.stderr.isatty():
            self._last = now
            print(line, file=sys.stderr)


def pictures(painter: Painter | None, *drawn: Drawn) -> Mapping[str, bytes]:
    """File name -> content of pictures; empty without a painter, with a message."""
    if painter is None:
        print("pictures left out: they need kindyna --headless", file=sys.stderr)
        return {}
    return {name: data for subject in drawn for name, data in painter(subject).items()}
