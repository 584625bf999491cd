"""The command ``report``: all there is to say of a design, with pictures where someone paints them."""

from __future__ import annotations

import argparse

from core.commands import Painter
from core.commands.common import design_and_samples, out_folder, pictures, verdict
from core.output.export import files
from core.output.report import report
from core.project import load
from core.project.files import write_all
from core.study import Study


def options(parser: argparse.ArgumentParser) -> None:
    design_and_samples(parser)
    out_folder(parser, "also write report, summary and pictures there")


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """The report on the terminal; with a folder, also as files."""
    study = Study(load(arguments.design), arguments.samples)
    text = report(study)
    if arguments.out is not None:
        made: dict[str, str | bytes] = {"report.txt": text, "summary.json": files(study)["summary.json"]}
        made.update(pictures(painter, study))
        write_all(arguments.out, made)
    print(text, end="")
    return verdict(study)
