"""What several commands ask for, and the exit code that findings ask for."""

from __future__ import annotations

import argparse
import sys
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
from core.project import load, number_of, one_of
from core.requests import text_option
from core.study import SAMPLES, Study, certificate_of, findings_of

LEAST_SAMPLES, MOST_SAMPLES = 4, 5_000_000


def folder(text: str) -> Path:
    """A folder to write to."""
    if not text.strip():
        raise argparse.ArgumentTypeError("a folder is wanted, nothing was given")
    return Path(text)


def ending_with(what: str, *endings: str) -> Callable[[str], Path]:
    """Reads the name of a file with one of these endings."""

    def read(text: str) -> Path:
        path = Path(text)
        if path.suffix.lower() not in endings:
            raise argparse.ArgumentTypeError(f"{text!r}: file of {what}; allowed endings: {', '.join(endings)}")
        return path

    return read


def picture_size(least: int, most: int) -> Callable[[str], tuple[int, int]]:
    """Reads the width and height of a picture [pixels]: ``1440x900``."""

    def read(text: str) -> tuple[int, int]:
        sides = text.replace("×", "x").split("x")
        if len(sides) != 2 or not all(number_from_one(side, most) >= least for side in sides):
            allowed = f"WIDTHxHEIGHT, each {least} ... {most} pixels, such as 1440x900"
            raise argparse.ArgumentTypeError(f"{text!r}: size of a picture; allowed: {allowed}")
        return int(sides[0]), int(sides[1])

    return read


# -- fields that the requests of several commands have -----------------------------------------------------


def design_file() -> Any:
    """The design file."""
    return text_option("design file (.toml)", "DESIGN", type=Path)


def drive_name() -> Any:
    """Which drive of several."""
    return text_option("which drive of a camshaft", "--drive", default="", metavar="NAME")


def samples_per_turn(label: str = "Samples per turn", help: str = "cam angles per turn", default: int = SAMPLES) -> Any:
    """How finely a turn is tabulated."""
    return whole(label, LEAST_SAMPLES, MOST_SAMPLES, default=default, help=help)


def out_folder(help: str, **how: Any) -> Any:
    """A folder for files; without a default it is beside what is printed."""
    return text_option(help, "--out", type=folder, metavar="DIR", **{"default": None, **how})


def as_json(help: str = "print JSON") -> Any:
    """Whether JSON is printed."""
    return text_option(help, "--json", default=False, action="store_true")


def sorted_by() -> Any:
    """The figure that a ranking is sorted by."""
    return text_option(
        "what the rows are sorted by, as JSON names it (peak_torque_nm)", "--by", default="", metavar="COLUMN"
    )


def studied(design: Design, samples: int = SAMPLES) -> Study:
    """The study of a design. Raises NoSolution where it lists its drives and none of them has an answer."""
    study = Study(design, samples)
    if not study.solved_drives:
        raise next(iter(study.camshaft.failures.values()))
    return study


def one_studied(path: Path, drive: str) -> Study:
    """The study of the one drive, or of the balance cam, which is shown as one more. Raises as ``one_of``; NoSolution."""
    design = load(path)
    if drive == BALANCER and design.balancer is not None and (balancer := Study(design).camshaft.balancer) is not None:
        return Study(in_machine(design, balancer.design))
    return Study(one_of(design, drive))


def require_cam(study: Study, command: str) -> None:
    """Raises KindynaError for a design without a cam."""
    if "cam" not in study.stages:
        raise KindynaError(f"{command}: this design has no cam; allowed: one with [cam]")


def require_shaft(study: Study) -> None:
    """Raises KindynaError for a design whose shaft turns nothing."""
    if "stability" not in study.stages:
        raise KindynaError("stability: no shaft turns a cam or a crank in this design; allowed: one with [shaft]")


def field_of_file(whole: Design, number: int, field: str) -> str:
    """The field of one drive in the whole file."""
    return field if field.startswith("shaft") else path_in(whole, number, field)


def named_in_file(error: KindynaError, arguments: argparse.Namespace) -> KindynaError:
    """What has no answer, of one drive of several, named by the field of the whole file; any other error as it is."""
    drive = getattr(arguments, "drive", None)
    if drive is None or drive == BALANCER or not isinstance(error, NoSolution):
        return error
    if error.field.startswith(("shaft", "drives[", "balancer")):  # of the whole file already
        return error
    whole = load(arguments.design)
    return type(error)(
        error.problem, field_of_file(whole, number_of(whole, drive), error.field), error.hint, error.cam_angles
    )


def in_file(findings: Iterable[Finding], whole: Design, number: int) -> list[Finding]:
    """Findings of one drive by the fields of the whole file."""
    return [replace(each, field=field_of_file(whole, number, each.field)) for each in findings]


def verdict(study: Study, stages: Sequence[str] = ()) -> int:
    """The exit code: whether a finding of the stages (all where none is named) is an error, or a residual exceeds its bound."""
    return verdict_on(findings_of(study, tuple(stages)), certificate_of(study, tuple(stages)))


def verdict_on(findings: Iterable[Finding], certificate: Mapping[str, Residual]) -> int:
    """The exit code: whether one of these findings is an error, or a residual of the certificate exceeds its bound."""
    bad = any(f.severity == ERROR for f in findings) or not all(residual.kept for residual in certificate.values())
    return DONE_WITH_ERRORS if bad else DONE


def pictures(painter: Painter | None, *drawn: Drawn) -> Mapping[str, bytes]:
    """File name -> content; where nobody paints, a line says so."""
    if painter is None:
        print("pictures left out: they need kindyna --headless", file=sys.stderr)
        return {}
    return {name: data for each in drawn for name, data in painter(each).items()}
