"""Commands about positions of mechanisms: centres, circuits, curves, pose and linkage-from."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np

from core.bounds import PROGRAM_BYTES
from core.commands import DONE, Painter
from core.commands.common import (
    DriveArguments,
    as_json,
    design_file,
    ending_with,
    out_folder,
    pictures,
    samples_per_turn,
)
from core.design import Design, require_linkage
from core.design.fields import choice, flag, number, whole
from core.design.topology import driver_turns
from core.errors import KindynaError
from core.frozen import frozen
from core.linkage_programs import FORMATS, read_linkage
from core.linkage_programs.design import UNITS, decoded
from core.mechanism.drivers import Circuit, circuits, with_drawn_pose, with_signs
from core.number_text import result_text
from core.output.drawing.curves import curves_file, path_csv, path_layers, point_curves
from core.output.drawing.layers import WRITERS, Layers, LayerShapes
from core.output.drawing.mechanism import pose_file, repeated_pose_layers
from core.output.lines import printable
from core.output.position import centres_data, snapshot
from core.output.summary import to_json
from core.project import dumps, load, load_one
from core.project.files import read_bytes, write, write_into
from core.requests import option, text_option
from core.study import Study

# -- the command ``centres`` ------------------------------------------------------------------------------------


@frozen(kw_only=True)
class CentresArguments(DriveArguments):
    """Arguments of the command: a design, an angle and a file or folder."""

    angle_deg: float = option(
        number("Angle of the driver or the cam in degrees"), help="angle of the driver, or of the cam"
    )
    out: Path | None = out_folder("also write them to this folder, with pictures")


def run_centres(arguments: CentresArguments, painter: Painter | None) -> int:
    """Print instant centres and velocities at one position as JSON; with a folder, draw those of a linkage."""
    study = Study(load_one(arguments.design, arguments.drive))
    text = to_json(centres_data(study, arguments.angle_deg))
    if arguments.out is not None:
        files: dict[str, str | bytes] = {"centres.json": text}
        if study.design.drive.links:
            files.update(pictures(painter, snapshot(study, arguments.angle_deg)))
        write_into(arguments.out, files)
    print(text, end="")
    return DONE


# -- the command ``circuits`` -----------------------------------------------------------------------------------


DRAWN_CIRCUIT, SIGNS = "drawn", "signs"


@frozen(kw_only=True)
class CircuitsArguments:
    """Arguments of ``circuits``: a design, a circuit and a file."""

    design: Path = design_file()
    take: int = option(whole("Circuit", 1, 999, default=1, help="its number in the list; 1 is the current one"))
    method: str = option(
        choice("Stated by", (DRAWN_CIRCUIT, SIGNS), default=DRAWN_CIRCUIT, help="how the file states its circuit"),
        "--as",
    )
    out: Path | None = text_option(
        "design to write, in this circuit",
        default=None,
        default_text="none",
        type=ending_with("a design", ".toml"),
        metavar="DESIGN.toml",
    )
    json: bool = as_json()


def run_circuits(arguments: CircuitsArguments, painter: Painter | None) -> int:
    """Print the circuits with the range of their driver; write a design in one of them."""
    design = require_linkage(load_one(arguments.design))
    all_circuits = circuits(design)
    if arguments.take > len(all_circuits):
        raise KindynaError(f"circuit = {arguments.take}: no such circuit; allowed: 1 ... {len(all_circuits)}")
    if arguments.out is not None:
        write(arguments.out, dumps(_as(all_circuits[arguments.take - 1], arguments.method)))
    rows = [_row(design, i, circuit) for i, circuit in enumerate(all_circuits, 1)]
    print(to_json({"circuits": rows}) if arguments.json else "".join(map(_line, rows)), end="")
    return DONE


def _as(circuit: Circuit, method: str) -> Design:
    design = circuit.design
    if method == SIGNS:
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
    present = ", the current one" if row["here"] else ""
    return (
        f"{row['number']}: driver {result_text(low)} ... {result_text(high)} {key.removeprefix('driver_')}{present}\n"  # type: ignore[has-type]
    )


# -- the command ``curves`` -------------------------------------------------------------------------------------


@frozen(kw_only=True)
class CurvesArguments(DriveArguments):
    """Arguments of ``curves``: a design and its points."""

    out: Path = text_option("file to write", type=ending_with("curves", ".csv", *WRITERS), metavar="FILE.csv|.dxf|.svg")
    points: tuple[str, ...] = text_option(
        "only these points", default=(), default_text="all moving points", nargs="+", metavar="NAME"
    )
    time_marks: int = option(whole("Time marks", 0, 3600, default=0, help="number of circles at equal times of a turn"))
    samples: int = samples_per_turn()


def run_curves(arguments: CurvesArguments, painter: Painter | None) -> int:
    """Write the curves of points as a table or a drawing; the path of a part in space is drawn isometric."""
    study = Study(load(arguments.design), arguments.samples)
    if not arguments.drive and study.design.listed and study.camshaft.has_transfer_path:
        return _write_path(study, arguments.out)
    study = Study(load_one(arguments.design, arguments.drive), arguments.samples)
    curves = point_curves(study, arguments.points, arguments.time_marks)
    write(arguments.out, curves_file(study, curves, arguments.out.suffix.lower()))
    print(arguments.out)
    return DONE


def _write_path(study: Study, out: Path) -> int:
    ending = out.suffix.lower()
    if ending in WRITERS:
        comment = f"{study.design.name}: path of the transferred part, isometric, mm"
        write(out, WRITERS[ending]((comment,), path_layers(study)))
    else:
        write(out, path_csv(study))
    print(out)
    return DONE


# -- the command ``pose`` ---------------------------------------------------------------------------------------


@frozen(kw_only=True)
class PoseArguments(DriveArguments):
    """Arguments of the command: a design, an angle and a file or folder."""

    angle_deg: float = option(
        number("Angle of the driver or the cam in degrees"), help="angle of the driver, or of the cam"
    )
    every_deg: float = option(
        number(
            "Repeat the pose every", 0.0, 360.0, default=0.0, help="repeat the pose in steps of this angle; 0: one pose"
        ),
        "--every",
    )
    underlay: bool = option(flag("Underlay", help="draw the lines of the DXF underlay of the design too"))
    out: Path = text_option("file to write", type=ending_with("a drawing", *WRITERS), metavar="FILE.dxf|.svg")


def run_pose(arguments: PoseArguments, painter: Painter | None) -> int:
    """Write the drawing, with a layer for every link, and for the cam."""
    study = Study(load_one(arguments.design, arguments.drive))
    more = dict(repeated_pose_layers(study, arguments.every_deg)) if arguments.every_deg else {}
    if arguments.underlay:
        more |= _underlay(arguments.design)
    theta = float(np.deg2rad(arguments.angle_deg))
    write(arguments.out, pose_file(study, theta, arguments.out.suffix.lower(), more))
    print(arguments.out)
    return DONE


def _underlay(design: Path) -> Layers:
    """Lines of the DXF underlay of a design; empty where it is missing or an image, with a message. Raises FileError."""
    from core.contour.underlay import IMAGES, read_lines, read_underlay, sidecar

    underlay = read_underlay(design)
    if underlay is None:
        print(f"underlay: there is no {sidecar(design).name}; add one with Underlay in the window", file=sys.stderr)
    elif underlay.file.suffix.lower() in IMAGES:
        print(
            f"underlay: {underlay.file.name} is an image without lines, left out; allowed: a DXF",
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
    """Arguments of ``linkage-from``: a file or text, and how it is read."""

    text: str = text_option(
        "a .linkage2 file, a file with a Pyslvs expression or a PMKS+ address, or the expression or address itself",
        "FILE|TEXT",
    )
    out: Path = text_option("design file to write", type=ending_with("a design", ".toml"), metavar="DESIGN.toml")
    format: str = option(
        choice("Program", tuple(FORMATS), default="", help="program that wrote the text"),
        default_text="by its beginning",
    )
    units: str = option(choice("Units", tuple(UNITS), default="", help="of lengths"), default_text="as stated, else mm")
    mirror: bool = option(flag("Mirror", help="mirror about the x axis, for programs whose y axis points down"))
    inputs: tuple[str, ...] = text_option(
        "a driven joint; repeat it", "--input", default=(), action="append", metavar="JOINT"
    )
    json: bool = as_json()


def run_linkage_from(arguments: LinkageFromArguments, painter: Painter | None) -> int:
    """Write the design; print its number of links and joints, and what was left out."""
    text, name = arguments.text, ""
    if len(text) < 4096 and "\n" not in text and os.path.exists(text):
        name = Path(text).stem
        text = decoded(read_bytes(text, PROGRAM_BYTES))
    result = read_linkage(
        text, arguments.format, name=name, units=arguments.units, mirror=arguments.mirror, inputs=arguments.inputs
    )
    write(arguments.out, dumps(result.design))
    if arguments.json:
        left_out = [{"what": part.what, "why": part.why} for part in result.left_out]
        print(to_json({"links": result.links, "joints": result.joints, "left_out": left_out}), end="")
    else:
        print(f"{printable(result.design.name)}: {result.links} links, {result.joints} joints")
        for part in result.left_out:
            print(f"left out: {printable(part.what)}: {printable(part.why)}")
    return DONE
