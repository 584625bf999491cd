"""The command ``report``: all there is to say of a design, with pictures where someone paints them."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

from core.commands import Painter
from core.commands.common import design_file, out_folder, pictures, samples_per_turn, studied, verdict
from core.errors import KindynaError
from core.frozen import frozen
from core.output.export import bounded
from core.output.report import report
from core.output.report.document import ENDINGS, PARTS, Cover, Printed, document
from core.output.summary import summary, to_json
from core.project import load
from core.project.files import write, write_into
from core.requests import typed
from core.study import Study


@frozen(kw_only=True)
class Arguments:
    """Of which design, where to, and what of a file to hand on is left out."""

    design: Path = design_file()
    samples: int = samples_per_turn()
    out: Path | None = out_folder(
        "also write report, summary and pictures there; NAME.html or NAME.pdf: instead, one file to hand on"
    )
    without: tuple[str, ...] = typed(
        f"what to leave out of the file to hand on: {', '.join(PARTS)}",
        default=(),
        nargs="+",
        choices=tuple(PARTS),
        metavar="PART",
    )
    cover: Cover = Cover()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The report on the terminal; with a folder, also as files."""
    study = studied(load(arguments.design), arguments.samples)
    if arguments.out is not None and arguments.out.suffix.lower() in ENDINGS:
        return _to_hand_on(study, arguments, painter)
    text = report(study)
    if arguments.out is not None:
        made: dict[str, str | bytes] = {"report.txt": text, "summary.json": to_json(summary(bounded(study)))}
        write_into(arguments.out, {**made, **_pictures(study, painter)})
    print(text, end="")
    return verdict(study)


def _pictures(study: Study, painter: Painter | None) -> Mapping[str, bytes]:
    """Those of each drive that is listed in a folder of its slug."""
    if painter is None:
        return pictures(painter)
    drawn = ((slug, painter(each)) for slug, each in study.answering.items())
    return {f"{slug}/{name}".removeprefix("/"): data for slug, found in drawn for name, data in found.items()}


def _to_hand_on(study: Study, arguments: Arguments, painter: Painter | None) -> int:
    """One file that needs nothing beside it."""
    out = arguments.out
    assert out is not None
    ending = out.suffix.lower()
    made = document(study, [name for name in PARTS if name not in arguments.without], arguments.cover)
    if made.lacking:
        print(made.lacking, file=sys.stderr)
    painted = painter(Printed(made, ending)) if painter is not None else {}
    if ending not in painted:
        if ending != ".html":
            raise KindynaError(f"{out}: a PDF is painted, which needs kindyna --headless; NAME.html is written without")
        if painter is None and made.pictures:
            print("pictures left out: they need kindyna --headless", file=sys.stderr)
        from core.output.report.html import html

        painted = {ending: html(made, {}).encode()}
    write(out, painted[ending])
    print(out)
    return verdict(study)
