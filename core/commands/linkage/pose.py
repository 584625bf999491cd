"""The command ``pose``: a linkage drawn at one angle."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from core.commands import DONE, Painter
from core.commands.common import design_file, drive_name, ending_with
from core.design.fields import flag, number
from core.errors import KindynaError
from core.frozen import frozen
from core.output.linkage_drawing import DRAWN, Layers, LayerShapes, ghost_layers, pose_file
from core.project import load_one
from core.project.files import write
from core.requests import asked, typed
from core.study import Study


@frozen(kw_only=True)
class Arguments:
    """Of which design, and at which angle."""

    design: Path = design_file()
    drive: str = drive_name()
    angle_deg: float = asked(number("Angle of the driver or the cam in degrees"), help="of the driver, or of the cam")
    every_deg: float = asked(
        number("Ghost poses every", 0.0, 360.0, default=0.0, help="degrees of the turn; 0: none"), "--every"
    )
    underlay: bool = asked(flag("Underlay", help="with the lines of the DXF that lies under the drawing of the design"))
    out: Path = typed("file to write", type=ending_with("a drawing", *DRAWN), metavar="FILE.dxf|.svg")


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The drawing, a layer a link."""
    study = Study(load_one(arguments.design, arguments.drive))
    more = dict(ghost_layers(study, arguments.every_deg)) if arguments.every_deg else {}
    if arguments.underlay:
        more |= _underlay(arguments.design)
    theta = float(np.deg2rad(arguments.angle_deg))
    write(arguments.out, pose_file(study, theta, arguments.out.suffix.lower(), more))
    print(arguments.out)
    return DONE


def _underlay(design: Path) -> Layers:
    """The lines of the DXF under a design; none where it is missing, or a picture, which is said. Raises FileError of its placement."""
    from core.contour.underlay import ENDINGS, PICTURES, read_lines, read_underlay, sidecar

    underlay = read_underlay(design)
    if underlay is None:
        print(f"underlay: there is no {sidecar(design).name}; Underlay in the window places one", file=sys.stderr)
    elif underlay.file.suffix.lower() in PICTURES:
        print(
            f"underlay: {underlay.file.name} is a picture, left out; of {' | '.join(ENDINGS)} a DXF has lines",
            file=sys.stderr,
        )
    else:
        try:
            drawn = read_lines(underlay.file)
        except KindynaError as error:
            print(f"underlay: left out: {error}", file=sys.stderr)
        else:
            return {"UNDERLAY": LayerShapes(tuple((underlay.placed(z), False) for z in drawn.lines))}
    return {}
