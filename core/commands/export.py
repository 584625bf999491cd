"""The command ``export``: tables and summary into a folder."""

from __future__ import annotations

import argparse
from pathlib import Path

from core.commands import Painter
from core.commands.common import design_and_samples, folder, studied, verdict
from core.output.export import bounded, export
from core.output.shaft_files import shaft_bounded, shaft_streams
from core.project import load
from core.project.files import write_all
from core.study import ShaftStudy


def options(parser: argparse.ArgumentParser) -> None:
    design_and_samples(parser)
    parser.add_argument("--out", type=folder, default=Path("out"), metavar="DIR", help="folder to write to (out)")
    parser.add_argument("--only", nargs="+", default=[], metavar="STAGE", help="stages to compute and write")


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """Tables and summary into a folder."""
    study = studied(load(arguments.design), arguments.samples)
    if isinstance(study, ShaftStudy):
        made, judged = shaft_streams(study, arguments.only), shaft_bounded(study)
        write_all(arguments.out, made)
        print(*(arguments.out / name for name in made), sep="\n")
        return verdict(judged, arguments.only)
    for path in export(study, arguments.out, arguments.only):
        print(path)
    return verdict(bounded(study), arguments.only)
