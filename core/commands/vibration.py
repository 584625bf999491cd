"""The command ``vibration``: how an elastic follower vibrates in its dwells, and its response spectrum over speeds."""

from __future__ import annotations

import argparse
from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import as_json, design_file, drive_name, require_cam
from core.design.fields import whole
from core.frozen import frozen
from core.output.summary import to_json
from core.output.vibration_files import SPEEDS, elastic_lines, elastic_rows, spectrum_csv, spectrum_table, speeds_of
from core.project import load_one
from core.project.files import write_all
from core.requests import typed
from core.study import Study

FASTEST = 1e5


def _speeds(text: str) -> tuple[float, float]:
    low, colon, high = text.partition(":")
    try:
        ends = float(low), float(high)
    except ValueError:
        ends = (0.0, 0.0)
    if not (colon and 0.0 < ends[0] < ends[1] <= FASTEST):
        raise argparse.ArgumentTypeError(f"{text!r}: range of speeds; allowed: A:B in rpm, 0 < A < B <= {FASTEST:g}")
    return ends


@frozen(kw_only=True)
class Arguments:
    """Whose vibration, and the speeds of its spectrum."""

    design: Path = design_file()
    drive: str = drive_name()
    speeds: tuple[float, float] | None = typed(
        "of the spectrum, in rpm", default=None, usual="up to twice the design's", type=_speeds, metavar="A:B"
    )
    count: int = whole("Speeds of the spectrum", 2, 5000, default=SPEEDS, help="speeds of the spectrum")
    out: Path | None = typed("the spectrum as a table", default=None, type=Path, metavar="FILE.csv")
    json: bool = as_json("figures and spectrum as JSON")


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The residual vibration in each dwell on the terminal; the spectrum as a file. A follower that is rigid has neither."""
    study = Study(load_one(arguments.design, arguments.drive))
    require_cam(study, "vibration")
    study.elasticity  # noqa: B018 - raises, and says why, where nothing vibrates
    low, high = arguments.speeds or (None, None)
    found = None
    if arguments.out is not None or arguments.json:
        found = study.vibration(speeds_of(study, low, high, arguments.count))
    if arguments.out is not None and found is not None:
        write_all(arguments.out.parent, {arguments.out.name: spectrum_csv(study, found)})
    if arguments.json and found is not None:
        table = {name: column.tolist() for name, column in spectrum_table(study, found).items()}
        print(to_json({**elastic_rows(study), "spectrum": table}), end="")
    else:
        print("\n".join(elastic_lines(study)))
    return DONE
