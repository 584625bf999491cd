"""Options that several commands take, and the exit code that findings ask for."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from core.commands import DONE, DONE_WITH_ERRORS, Drawn, Painter
from core.design import Design, in_machine, path_of
from core.errors import KindynaError, NoAnswer
from core.findings import ERROR, Finding
from core.project import load, number_of, one_of
from core.study import BALANCER, SAMPLES, ShaftStudy, Study

LEAST_SAMPLES, MOST_SAMPLES = 4, 5_000_000


def number(what: str, allowed: str, fits: Callable[[float], bool] = math.isfinite) -> Callable[[str], float]:
    """Reads a number, with a decimal point; says what it is and what is allowed where it is none, or does not fit."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not (math.isfinite(value) and fits(value)):
            point = " (with a decimal point, no comma)" if "," in text else ""
            raise argparse.ArgumentTypeError(f"{text!r}: {what}; allowed: {allowed}{point}")
        return value

    return read


def within(low: float, high: float, what: str) -> Callable[[str], float]:
    """Reads a number above low and not above high."""
    return number(what, f"above {low:g} ... {high:g}", lambda value: low < value <= high)


def samples(text: str) -> int:
    """Cam angles per turn."""
    try:
        value = int(text)
    except ValueError:
        value = 0
    if not LEAST_SAMPLES <= value <= MOST_SAMPLES:
        raise argparse.ArgumentTypeError(f"{text!r}: samples per turn; allowed: {LEAST_SAMPLES} ... {MOST_SAMPLES}")
    return value


def folder(text: str) -> Path:
    """A folder to write to."""
    if not text.strip():
        raise argparse.ArgumentTypeError("a folder is wanted, nothing was given")
    return Path(text)


def design_file(parser: argparse.ArgumentParser) -> None:
    """The design file."""
    parser.add_argument("design", metavar="DESIGN", type=Path, help="design file (.toml)")


def drive_option(parser: argparse.ArgumentParser) -> None:
    """Which drive of several."""
    parser.add_argument("--drive", default="", metavar="NAME", help="which drive of a camshaft")


def design_and_samples(parser: argparse.ArgumentParser) -> None:
    """The design file, and how finely it is tabulated."""
    design_file(parser)
    parser.add_argument(
        "--samples", type=samples, default=SAMPLES, metavar="N", help=f"cam angles per turn ({SAMPLES})"
    )


def out_folder(parser: argparse.ArgumentParser, help: str) -> None:
    """A folder for files, beside what is printed."""
    parser.add_argument("--out", type=folder, metavar="DIR", help=help)


def studied(design: Design, samples: int = SAMPLES) -> Study | ShaftStudy:
    """The study of a design; of several drives that of their shaft. Raises NoAnswer where none of the drives has an answer."""
    if not design.listed:
        return Study(design, samples)
    study = ShaftStudy(design, samples)
    if len(study.failures) == len(study.drives):
        raise next(iter(study.failures.values()))
    return study


def one_studied(path: Path, drive: str) -> Study:
    """The study of the one drive, or of the balance cam, which is shown as one more. Raises as ``one_of``; NoAnswer."""
    design = load(path)
    if drive == BALANCER and design.balancer is not None and (balancer := ShaftStudy(design).balancer) is not None:
        return Study(in_machine(design, balancer.design))
    return Study(one_of(design, drive))


def require_cam(study: Study, command: str) -> None:
    """Raises KindynaError for a design without a cam."""
    if "cam" not in study.stages:
        raise KindynaError(f"{command}: this design has no cam; allowed: one with [cam]")


def require_shaft(study: Study) -> None:
    """Raises KindynaError for a design without a cam on a shaft."""
    if "stability" not in study.stages:
        raise KindynaError("stability: no shaft turns a cam in this design; allowed: one with [cam] and [shaft]")


def field_of_file(whole: Design, number: int, field: str) -> str:
    """The field of one drive in the whole file."""
    return path_of(number, field) if whole.listed and not field.startswith("shaft") else field


def named_in_file(error: KindynaError, arguments: argparse.Namespace) -> KindynaError:
    """What has no answer, of one drive of several, named by the field of the whole file; any other error as it is."""
    drive = getattr(arguments, "drive", None)
    if drive is None or drive == BALANCER or not isinstance(error, NoAnswer):
        return error
    whole = load(arguments.design)
    return type(error)(
        error.problem, field_of_file(whole, number_of(whole, drive), error.field), error.hint, error.cam_angles
    )


def in_file(findings: Iterable[Finding], whole: Design, number: int) -> list[Finding]:
    """Findings of one drive by the fields of the whole file."""
    return [replace(each, field=field_of_file(whole, number, each.field)) for each in findings]


def verdict(study: Study | ShaftStudy, stages: Sequence[str] = ()) -> int:
    """The exit code: whether a finding of the stages (all where none is named) is an error."""
    return DONE_WITH_ERRORS if any(f.severity == ERROR for f in study.findings(tuple(stages))) else DONE


def pictures(painter: Painter | None, *drawn: Drawn) -> Mapping[str, bytes]:
    """File name -> content; where nobody paints, a line says so."""
    if painter is None:
        print("pictures left out: they need kindyna --headless", file=sys.stderr)
        return {}
    return {name: data for each in drawn for name, data in painter(each).items()}
