"""The command ``centres``: instant centres and velocities of a mechanism at one position, as JSON."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np

from core.bounds import PROGRAM_BYTES
from core.commands import DONE, Painter
from core.commands.common import as_json, design_file, drive_name, ending_with, out_folder, pictures, samples_per_turn
from core.design import Design, require_linkage
from core.design.fields import choice, flag, number, whole
from core.design.topology import driver_turns
from core.errors import KindynaError
from core.frozen import frozen
from core.linkage_programs import FORMATS, LinkageImport, read_linkage
from core.linkage_programs.design import UNITS, decoded
from core.mechanism.drivers import Circuit, circuits, with_drawn_pose, with_signs
from core.output.lines import printable
from core.output.position import (
    WRITERS,
    Layers,
    LayerShapes,
    centres_data,
    curves_file,
    path_csv,
    path_layers,
    point_curves,
    pose_file,
    repeated_pose_layers,
    snapshot,
)
from core.output.summary import to_json
from core.project import dumps, load, load_one
from core.project.files import read_bytes, write, write_into
from core.requests import option, text_option
from core.study import Study

# -- the command ``centres`` ------------------------------------------------------------------------------------


@frozen(kw_only=True)
class CentresArguments:
    """Of which design, and at which angle."""

    design: Path = design_file()
    drive: str = drive_name()
    angle_deg: float = option(number("Angle of the driver or the cam in degrees"), help="of the driver, or of the cam")
    out: Path | None = out_folder("also write them there, with pictures")


def run_centres(arguments: CentresArguments, painter: Painter | None) -> int:
    """Instant centres and velocities at one position, as JSON; with a folder those of a linkage also drawn."""
    study = Study(load_one(arguments.design, arguments.drive))
    text = to_json(centres_data(study, arguments.angle_deg))
    if arguments.out is not None:
        made: dict[str, str | bytes] = {"centres.json": text}
        if study.design.drive.links:
            made.update(pictures(painter, snapshot(study, arguments.angle_deg)))
        write_into(arguments.out, made)
    print(text, end="")
    return DONE


# -- the command ``circuits`` -----------------------------------------------------------------------------------


DRAWN_CIRCUIT, SIGNS = "drawn", "signs"


@frozen(kw_only=True)
class CircuitsArguments:
    """Of which design, and what is written."""

    design: Path = design_file()
    take: int = option(whole("Circuit", 1, 999, default=1, help="its number in the list; 1 is the design's own"))
    told: str = option(
        choice(
            "Told by", (DRAWN_CIRCUIT, SIGNS), default=DRAWN_CIRCUIT, help="how the file says which circuit it is in"
        ),
        "--as",
    )
    out: Path | None = text_option(
        "design to write, in the circuit taken",
        default=None,
        default_text="none",
        type=ending_with("a design", ".toml"),
        metavar="DESIGN.toml",
    )
    json: bool = as_json()


def run_circuits(arguments: CircuitsArguments, painter: Painter | None) -> int:
    """The circuits by number with the range of the driver in each; a design in one of them."""
    design = require_linkage(load_one(arguments.design))
    found = circuits(design)
    if arguments.take > len(found):
        raise KindynaError(f"circuit = {arguments.take}: there is none of this number; allowed: 1 ... {len(found)}")
    if arguments.out is not None:
        write(arguments.out, dumps(_as(found[arguments.take - 1], arguments.told)))
    rows = [_row(design, i, circuit) for i, circuit in enumerate(found, 1)]
    print(to_json({"circuits": rows}) if arguments.json else "".join(map(_line, rows)), end="")
    return DONE


def _as(circuit: Circuit, told: str) -> Design:
    design = circuit.design
    if told == SIGNS:
        return with_signs(design)
    return (
        design
        if design.drive.linkage.drawn is not None
        else with_drawn_pose(design, Study(design).at_theta(np.zeros(1)).linkage)
    )


def _row(design: Design, number: int, circuit: Circuit) -> dict[str, object]:
    turns = driver_turns(design.drive.linkage)
    ends = [float(np.rad2deg(end)) if turns else 1e3 * end for end in (circuit.range.low, circuit.range.high)]
    return {"number": number, "here": circuit.is_current, "driver_deg" if turns else "driver_mm": ends}


def _line(row: dict[str, object]) -> str:
    key = next(key for key in row if key.startswith("driver"))
    low, high = row[key]  # type: ignore[misc]
    own = ", the design's own" if row["here"] else ""
    return f"{row['number']}: driver {low:.6g} ... {high:.6g} {key.removeprefix('driver_')}{own}\n"  # type: ignore[has-type]


# -- the command ``curves`` -------------------------------------------------------------------------------------


@frozen(kw_only=True)
class CurvesArguments:
    """Of which design, and which points."""

    design: Path = design_file()
    drive: str = drive_name()
    out: Path = text_option("file to write", type=ending_with("curves", ".csv", *WRITERS), metavar="FILE.csv|.dxf|.svg")
    points: tuple[str, ...] = text_option(
        "of these points only", default=(), default_text="all that move", nargs="+", metavar="NAME"
    )
    time_marks: int = option(
        whole("Time marks", 0, 3600, default=0, help="small circles at so many equal times of a turn")
    )
    samples: int = samples_per_turn()


def run_curves(arguments: CurvesArguments, painter: Painter | None) -> int:
    """The curves as a table, or drawn, a layer a point; of a part in space as it looks from above and aside (isometric)."""
    whole = Study(load(arguments.design), arguments.samples)
    if not arguments.drive and whole.design.listed and whole.camshaft.has_transfer_path:
        return _of_part(whole, arguments.out)
    study = Study(load_one(arguments.design, arguments.drive), arguments.samples)
    found = point_curves(study, arguments.points, arguments.time_marks)
    write(arguments.out, curves_file(study, found, arguments.out.suffix.lower()))
    print(arguments.out)
    return DONE


def _of_part(study: Study, out: Path) -> int:
    ending = out.suffix.lower()
    if ending in WRITERS:
        comment = f"{study.design.name}: path of the part that is carried, isometric, mm"
        write(out, WRITERS[ending]((comment,), path_layers(study)))
    else:
        write(out, path_csv(study))
    print(out)
    return DONE


# -- the command ``pose`` ---------------------------------------------------------------------------------------


@frozen(kw_only=True)
class PoseArguments:
    """Of which design, and at which angle."""

    design: Path = design_file()
    drive: str = drive_name()
    angle_deg: float = option(number("Angle of the driver or the cam in degrees"), help="of the driver, or of the cam")
    every_deg: float = option(
        number("Ghost poses every", 0.0, 360.0, default=0.0, help="degrees of the turn; 0: none"), "--every"
    )
    underlay: bool = option(
        flag("Underlay", help="with the lines of the DXF that lies under the drawing of the design")
    )
    out: Path = text_option("file to write", type=ending_with("a drawing", *WRITERS), metavar="FILE.dxf|.svg")


def run_pose(arguments: PoseArguments, painter: Painter | None) -> int:
    """The drawing, a layer a link."""
    study = Study(load_one(arguments.design, arguments.drive))
    more = dict(repeated_pose_layers(study, arguments.every_deg)) if arguments.every_deg else {}
    if arguments.underlay:
        more |= _underlay(arguments.design)
    theta = float(np.deg2rad(arguments.angle_deg))
    write(arguments.out, pose_file(study, theta, arguments.out.suffix.lower(), more))
    print(arguments.out)
    return DONE


def _underlay(design: Path) -> Layers:
    """The lines of the DXF under a design; none where it is missing, or a picture, which is said. Raises FileError of its placement."""
    from core.contour.underlay import ENDINGS, IMAGES, read_lines, read_underlay, sidecar

    underlay = read_underlay(design)
    if underlay is None:
        print(f"underlay: there is no {sidecar(design).name}; Underlay in the window places one", file=sys.stderr)
    elif underlay.file.suffix.lower() in IMAGES:
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
            return {"UNDERLAY": LayerShapes(tuple((underlay.to_plane(z), False) for z in drawn.lines))}
    return {}


# -- the command ``linkage-from`` -------------------------------------------------------------------------------


@frozen(kw_only=True)
class LinkageFromArguments:
    """What is read, and how."""

    text: str = text_option(
        "a .linkage2 file, a file with a Pyslvs expression or the address of PMKS+, or one of these two itself",
        "FILE|TEXT",
    )
    out: Path = text_option("design file to write", type=ending_with("a design", ".toml"), metavar="DESIGN.toml")
    format: str = option(
        choice("Program", tuple(FORMATS), default="", help="whose text it is"), default_text="as it begins"
    )
    units: str = option(
        choice("Units", tuple(UNITS), default="", help="of lengths"), default_text="as it says, else mm"
    )
    mirror: bool = option(flag("Mirror", help="turn it over about the x axis: for programs whose y points down"))
    inputs: tuple[str, ...] = text_option(
        "a joint that is driven; again for another", "--input", default=(), action="append", metavar="JOINT"
    )
    json: bool = as_json()


def run_linkage_from(arguments: LinkageFromArguments, painter: Painter | None) -> int:
    """The design as a file; how many links and joints it has, and what was left out."""
    text, name = arguments.text, ""
    if len(text) < 4096 and "\n" not in text and os.path.exists(text):
        name = Path(text).stem
        text = decoded(read_bytes(text, PROGRAM_BYTES))
    made = read_linkage(
        text, arguments.format, name=name, units=arguments.units, mirror=arguments.mirror, inputs=arguments.inputs
    )
    write(arguments.out, dumps(made.design))
    print(to_json(_data(made)) if arguments.json else _text(made), end="")
    return DONE


def _data(made: LinkageImport) -> dict[str, object]:
    left = [{"what": each.what, "why": each.why} for each in made.left_out]
    return {"links": made.links, "joints": made.joints, "left_out": left}


def _text(made: LinkageImport) -> str:
    lines = [f"{printable(made.design.name)}: {made.links} links, {made.joints} joints"]
    lines += [f"left out: {printable(each.what)}: {printable(each.why)}" for each in made.left_out]
    return "\n".join(lines) + "\n"
