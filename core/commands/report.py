"""The command ``report``: all there is to say of a design, with pictures where someone paints them."""

from __future__ import annotations

import argparse

from core.commands import Painter
from core.commands.common import design_and_samples, folder, pictures, verdict
from core.output.export import files
from core.output.report import report
from core.project import load
from core.project.files import write_all
from core.study import Study


def words(parser: argparse.ArgumentParser) -> None:
    design_and_samples(parser)
    parser.add_argument("--out", type=folder, metavar="DIR", help="also write report, summary and pictures there")


def run(words: argparse.Namespace, painter: Painter | None) -> int:
    """The report on the terminal; with a folder, also as files."""
    study = Study(load(words.design), words.samples)
    text = report(study)
    if words.out is not None:
        made: dict[str, str | bytes] = {"report.txt": text, "summary.json": files(study)["summary.json"]}
        made.update(pictures(painter, study))
        write_all(words.out, made)
    print(text, end="")
    return verdict(study)
