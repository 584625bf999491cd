"""The command ``curves``: what points of a linkage run through, or a part in space that drives carry together."""

from __future__ import annotations

from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import design_file, drive_name, ending_with, samples_per_turn
from core.design.fields import whole
from core.frozen import frozen
from core.output.linkage_drawing import DRAWN, curves_file, part_layers, part_table, point_curves
from core.project import load, load_one
from core.project.files import write
from core.requests import asked, typed
from core.study import Study


@frozen(kw_only=True)
class Arguments:
    """Of which design, and which points."""

    design: Path = design_file()
    drive: str = drive_name()
    out: Path = typed("file to write", type=ending_with("curves", ".csv", *DRAWN), metavar="FILE.csv|.dxf|.svg")
    points: tuple[str, ...] = typed(
        "of these points only", default=(), usual="all that move", nargs="+", metavar="NAME"
    )
    time_marks: int = asked(
        whole("Time marks", 0, 3600, default=0, help="small circles at so many equal times of a turn")
    )
    samples: int = samples_per_turn()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The curves as a table, or drawn, a layer a point; of a part in space as it looks from above and aside (isometric)."""
    whole = Study(load(arguments.design), arguments.samples)
    if not arguments.drive and whole.design.listed and whole.camshaft.carries:
        return _of_part(whole, arguments.out)
    study = Study(load_one(arguments.design, arguments.drive), arguments.samples)
    found = point_curves(study, arguments.points, arguments.time_marks)
    write(arguments.out, curves_file(study, found, arguments.out.suffix.lower()))
    print(arguments.out)
    return DONE


def _of_part(study: Study, out: Path) -> int:
    ending = out.suffix.lower()
    if ending in DRAWN:
        comment = f"{study.design.name}: path of the part that is carried, isometric, mm"
        write(out, DRAWN[ending]((comment,), part_layers(study)))
    else:
        write(out, part_table(study))
    print(out)
    return DONE
