"""Commands about motions: blend, laws, motion-from, flying-shear, indexer and motion."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from core.blend import (
    CONSTANT_VELOCITY,
    ELEMENTS,
    GOALS,
    KINDS,
    MOTION_TYPES,
    SETTINGS,
    BlendError,
    BlendResult,
    Request,
    best,
    blend,
)
from core.blend.best import with_blend
from core.blend.request import LEAST_STROKE
from core.blend.sequences import motion_type_of, sequence_error
from core.commands import DONE, Painter
from core.commands.common import (
    DriveArguments,
    as_json,
    drive_name,
    ending_with,
    pictures,
    sorted_by,
    verdict,
)
from core.contour import GAP_MM, MOST_GAP_MM, UNITS, read_contour, trace
from core.design import Design, alone, only, split_unit, with_motion_of, with_only
from core.design.fields import choice, flag, number
from core.errors import KindynaError
from core.find import (
    RankingColumn,
    RankingRow,
    blend_candidates,
    law_candidates,
    moving_segments,
    ranking,
    ranking_columns,
    sorted_rows,
)
from core.find.ranking import Candidate
from core.frozen import frozen
from core.laws import LAWS, Peaks, peaks
from core.motion.new_motions import FlyingShear, Indexer, flying_shear, indexer
from core.motion.split import shift_motion
from core.motion.tables import lobe_to_segments
from core.output.channels import new_design_text
from core.output.lines import columns, digits
from core.output.summary import to_json
from core.output.texts import (
    blend_figure,
    blend_text,
    changed_segment_text,
    contour_data,
    contour_text,
    curves_data,
    table_data,
    table_text,
)
from core.project import load, load_one, number_of, save
from core.project.files import read_bytes, write
from core.requests import option, require_in_range, text_option
from core.study import Study

# -- the command ``blend`` --------------------------------------------------------------------------------------


PICTURES = (".png", ".svg")


def _setting(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r}: must be NAME=NUMBER, one of {' | '.join(SETTINGS)}") from None


def _point(text: str) -> tuple[float, float]:
    angle, _, level = text.partition("=")
    try:
        return float(angle), float(level)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r}: must be ANGLE=DISPLACEMENT, two numbers") from None


def _settings(given: Sequence[tuple[str, float]]) -> dict[str, float]:
    """Settings by name. Raises BlendError for a name with two values."""
    settings = dict(given)
    for name, value in given:
        if value != settings[name]:
            raise BlendError(
                f"{name} = {value:g}, {name} = {settings[name]:g}: a setting has one value; give one", name
            )
    return settings


def _curve(text: str) -> str:
    """Read the name of a curve of the table, which may be empty."""
    if text and text.upper() not in ELEMENTS:
        raise argparse.ArgumentTypeError(f"{text!r}: unknown curve; allowed: {' | '.join(ELEMENTS)}")
    return text.upper()


@frozen(kw_only=True)
class BlendArguments:
    """Arguments of ``blend``: a motion and its files, or a curve of the table."""

    type: str | None = choice(
        "Type",
        tuple(MOTION_TYPES),
        default=None,
        help="; ".join(f"{slug}: {row.label[:1].lower()}{row.label[1:]}" for slug, row in MOTION_TYPES.items()),
    )
    stroke: float | None = option(
        number("Stroke", LEAST_STROKE, 1e9, default=None, help="of the rise (mm, or --unit)"), metavar="S"
    )
    return_stroke: float = option(
        number("Return stroke", LEAST_STROKE, 1e9, default=0.0, help="if it differs from the stroke"), metavar="S"
    )
    start: float | None = option(
        number("Cam angle in degrees", 0.0, 360.0, default=None), help="cam angle where it starts", metavar="DEG"
    )
    end: float | None = option(
        number("Cam angle in degrees", 0.0, 360.0, default=None), help="cam angle where it ends", metavar="DEG"
    )
    constant_velocity: str = option(
        choice("Constant velocity", CONSTANT_VELOCITY[1:], default="none", help="without a word: of the rise"),
        nargs="?",
        const="rise",
    )
    set: tuple[tuple[str, float], ...] = text_option(
        f"{' | '.join(SETTINGS)}; flat1: span of a constant acceleration inside the curve of h1, a1: its size; "
        "length, length2: span of the constant velocity, of the return where the rise has one too; with --best the least span",
        default=(),
        action="append",
        type=_setting,
        metavar="NAME=VALUE",
    )
    point: tuple[tuple[float, float], ...] = text_option(
        "a displacement to pass at a cam angle, above the lowest; counts as a setting",
        default=(),
        action="append",
        type=_point,
        metavar="DEG=S",
    )
    sequence: str = text_option(
        "only this sequence, which determines type of motion and constant velocity. A sequence without a type, of any curves "
        f"that join, accepts --set with the curves and strokes counted from 1: {', '.join(f'{name}1' for name in KINDS)}",
        default="",
        metavar="C1-H2-P2",
    )
    best: str | None = choice("Best", tuple(GOALS), default=None, help="goal to minimise over the free settings")
    unit: str = choice("Unit", ("mm", "deg"), default="mm", help="of the stroke")
    out: Path | None = text_option(
        f"displacement, velocity and acceleration as a picture: {' or '.join(PICTURES)}",
        default=None,
        type=ending_with("a picture", *PICTURES),
        metavar="NAME",
    )
    table: str | None = text_option(
        "only print which curve may follow which, with the signs at their ends; CURVE: which curves may follow it, "
        "and why not",
        default=None,
        nargs="?",
        const="",
        type=_curve,
        metavar="CURVE",
    )
    json: bool = as_json()
    into: Path | None = text_option("write the motion into a design file", default=None, type=Path, metavar="DESIGN")
    rank: Path | None = text_option(
        "rank this blend, the other sequences with a solution, and the laws by their peaks in a design at its speed",
        default=None,
        type=Path,
        metavar="DESIGN",
    )
    by: str = sorted_by()
    drive: str = drive_name()


def run_blend(arguments: BlendArguments, painter: Painter | None) -> int:
    """Print a blended motion, paint it or write it into a design; or print the table of curves."""
    if arguments.table is not None:
        words = arguments.table, arguments.type or ""
        print(to_json(table_data(*words)) if arguments.json else table_text(*words), end="")
        return DONE
    blended = _blend(arguments)
    if arguments.rank is not None:
        return _rank_blend(arguments.rank, arguments, blended)
    changes = ""
    if arguments.into is not None:
        machine = load(arguments.into)
        number = number_of(machine, arguments.drive)
        before = only(machine, number)
        after = with_blend(before, blended)
        save(with_only(machine, number, after), arguments.into, in_place=True)
        changes = changed_segment_text(before, after, blended)
    if arguments.out is not None:
        painted = pictures(painter, blend_figure(blended, arguments.out.stem))
        for name, data in painted.items():
            if Path(name).suffix == arguments.out.suffix.lower():
                write(arguments.out, data)
    print(to_json(curves_data(blended)) if arguments.json else blend_text(blended) + changes, end="")
    return DONE


def _blend(arguments: BlendArguments) -> BlendResult:
    """Blend a motion of one of Yang's types, or any sequence of curves. Raises BlendError."""
    constant, motion_type = arguments.constant_velocity, arguments.type
    if arguments.sequence and motion_type is None:
        if fault := sequence_error(arguments.sequence):
            raise BlendError(f"--sequence {arguments.sequence}: {fault}")
        motion_type, constant = motion_type_of(arguments.sequence)
    values: dict[str, Any] = {
        "type": motion_type, "stroke": arguments.stroke, "start": arguments.start, "end": arguments.end,
    }  # fmt: skip
    if motion_type == "":  # any sequence, whose settings may determine the strokes
        values["stroke"] = arguments.stroke or 0.0
    missing = [f"--{name}" for name, value in values.items() if value is None]
    if missing:
        raise BlendError(
            f"blend: {', '.join(missing)}: required for a motion; --table alone prints which curve may follow which"
        )
    if constant == "rise" and arguments.type == "DRD-return":
        constant = "return"  # the only stroke
    request = Request(
        **values,
        constant=constant,
        settings=_settings(arguments.set),
        return_stroke=arguments.return_stroke,
        points=arguments.point,
        sequence=arguments.sequence,
        unit=arguments.unit,
    )
    return best(request, arguments.best) if arguments.best else blend(request)


def _rank_blend(path: Path, arguments: BlendArguments, blended: BlendResult) -> int:
    """Print the blend, and its ranking among the other sequences and laws in the design. Raises KindynaError."""
    if arguments.into is not None or arguments.out is not None:
        raise BlendError("--rank: cannot be combined with --into and --out")
    machine = load(path)
    design = only(machine, number_of(machine, arguments.drive))
    candidates = blend_candidates(blended, partial(with_blend, design), arguments.best or "")
    figures, rows = ranked_rows(design, candidates, arguments.by)
    if arguments.json:
        ranking = [{"blend": row.name, **row_data(figures, row)} for row in rows]
        print(to_json({"curves": curves_data(blended), "ranking": ranking}), end="")
    else:
        print(blend_text(blended) + "\n" + ranking_text("motion", figures, rows), end="")
    return DONE


# -- the command ``laws`` ---------------------------------------------------------------------------------------


@frozen(kw_only=True)
class LawsArguments:
    """Arguments of ``laws``: a design in which the laws are ranked, or none for the table of laws."""

    design: Path | None = text_option(
        "rank the laws by their peaks in this design at its speed: torque, wind-up, residual vibration, contact",
        "DESIGN",
        default=None,
        nargs="?",
        type=Path,
    )
    drive: str = drive_name()
    segment: tuple[int, ...] = text_option(
        "segment that gets the law, from 1; repeat it",
        default=(),
        default_text="all that move",
        action="append",
        type=int,
        metavar="N",
    )
    by: str = sorted_by()
    json: bool = as_json("print JSON; infinite = null")


def run_laws(arguments: LawsArguments, painter: Painter | None) -> int:
    """Print the laws with their peak coefficients, or ranked in a design."""
    if arguments.design is not None:
        _rank_laws(arguments.design, arguments)
    elif arguments.segment or arguments.by or arguments.drive:
        raise KindynaError("--segment, --by, --drive: laws are ranked in a design; name its file")
    elif arguments.json:
        print(to_json([{"law": slug, **_coefficients(peaks(law))} for slug, law in LAWS.items()]), end="")
    else:
        print(_text(), end="")
    return DONE


def _rank_laws(path: Path, arguments: LawsArguments) -> None:
    """Print the ranking of the laws in a design. Raises KindynaError."""
    machine = load(path)
    design = only(machine, number_of(machine, arguments.drive))
    numbers = [number - 1 for number in arguments.segment] or moving_segments(design)
    moving = moving_segments(design)
    if not moving:
        raise KindynaError("laws: no segment of this design's motion moves; give it one with a rise")
    for segment in numbers:
        if segment not in moving:
            allowed = " | ".join(str(i + 1) for i in moving)
            raise KindynaError(f"--segment {segment + 1}: no segment with a rise; allowed: {allowed}")
    figures, rows = ranked_rows(design, law_candidates(design, numbers), arguments.by)
    if arguments.json:
        print(
            to_json([{"law": row.name, **_coefficients_of(row.name), **row_data(figures, row)} for row in rows]),
            end="",
        )
    else:
        print(ranking_text("law", figures, rows), end="")


def _coefficients_of(slug: str) -> Mapping[str, float | None]:
    """Peak coefficients of a law; None where the settings of a segment determine it."""
    return _coefficients(peaks(LAWS[slug])) if slug in LAWS else dict.fromkeys(("cv", "ca", "cj", "cm"))


def _coefficients(peak: Peaks) -> dict[str, float]:
    """Peak coefficients for unit rise and span."""
    return {"cv": peak.cv, "ca": peak.ca, "cj": peak.cj, "cm": peak.cm}


def _text() -> str:
    rows: list[tuple[str, ...]] = [("law", "velocity", "acceleration", "jerk", "torque", "")]
    for slug, law in LAWS.items():
        peak = peaks(law)
        numbers = [digits(value) for value in _coefficients(peak).values()]
        rows.append((slug, *numbers, "acceleration jumps at an end" if peak.jumps_at_an_end else ""))
    return "\n".join(columns(rows)) + "\n"


# -- the command ``motion-from`` --------------------------------------------------------------------------------


def _centre(text: str) -> complex:
    try:
        x, y = map(float, text.split(","))
    except ValueError:
        x = y = math.nan
    if not (math.isfinite(x) and math.isfinite(y)):
        raise argparse.ArgumentTypeError(
            f"{text!r}: must be X,Y: two numbers with decimal points, in the drawing's units"
        )
    return complex(x, y)


@frozen(kw_only=True)
class MotionFromArguments(DriveArguments):
    """Arguments of ``motion-from``: a curve, a design, and how the drawing is read."""

    curve: Path = text_option(
        "drawing with one closed curve of lines and arcs; the layer PROFILE, where it has a curve",
        "CURVE.dxf",
        type=Path,
    )
    out: Path = text_option(
        "design file to write: the design with the motion and the base radius of the curve",
        type=Path,
        metavar="FILE.toml",
    )
    units: str = option(
        choice("Units", tuple(UNITS), default="", help="of the drawing"), default_text="as its header states"
    )
    centre: complex | None = text_option(
        "position of the cam centre, in the drawing's units",
        default=None,
        default_text="its origin",
        type=_centre,
        metavar="X,Y",
    )
    gap_mm: float = number(
        "Gap", 0.0, MOST_GAP_MM, default=GAP_MM, help="largest distance of two free ends of lines and arcs that join"
    )
    json: bool = as_json()


def run_motion_from(arguments: MotionFromArguments, painter: Painter | None) -> int:
    """Write the design with the motion; print the curve, and the jumps of velocity and acceleration."""
    machine = load(arguments.design)
    number = number_of(machine, arguments.drive)
    design = only(machine, number)
    contour = read_contour(
        read_bytes(arguments.curve), arguments.curve.name, arguments.units, arguments.centre, arguments.gap_mm
    )
    traced = trace(design, contour)
    code = verdict(Study(traced.design), ("motion", "cam"))
    save(with_only(machine, number, traced.design), arguments.out)
    print(to_json(contour_data(traced)) if arguments.json else contour_text(traced), end="")
    return code


# -- the commands ``flying-shear`` and ``indexer`` --------------------------------------------------------------


@frozen(kw_only=True)
class NewDesignArguments:
    """Arguments of a command that begins a design with a motion: the motion and a file."""

    request: Any = None
    out: Path = text_option("design file to write", type=Path, metavar="FILE.toml")


@frozen(kw_only=True)
class FlyingShearArguments(NewDesignArguments):
    """Arguments of ``flying-shear``: the motion and a file."""

    request: FlyingShear = FlyingShear()


@frozen(kw_only=True)
class IndexerArguments(NewDesignArguments):
    """Arguments of ``indexer``: the motion and a file."""

    request: Indexer = Indexer()


def _begin(arguments: Any, painter: Painter | None, make: Callable[[Any], Design]) -> int:
    """Write a new design to a file, print its peaks, and return the exit code."""
    require_in_range(arguments.request)
    design = make(arguments.request)
    save(design, arguments.out)
    print(new_design_text(design))
    return DONE


run_flying_shear, run_indexer = partial(_begin, make=flying_shear), partial(_begin, make=indexer)


# -- the command ``motion`` -------------------------------------------------------------------------------------


@frozen(kw_only=True)
class MotionArguments:
    """Arguments of ``motion``: a design, and a file for the motion or a design to write it into."""

    design: Path = text_option("design, or file of a motion (.toml)", "DESIGN", type=Path)
    drive: str = drive_name()
    shift_deg: float = option(
        number("Shift", -360.0, 360.0, default=0.0, help="delay of the motion: at DEG it has the value it had at 0")
    )
    segments: bool = flag("Segments", help="replace a lobe by the laws and tables of its segments")
    out: Path | None = text_option("file of the motion alone to write", default=None, type=Path, metavar="FILE.toml")
    into: Path | None = text_option("design file to write the motion into", default=None, type=Path, metavar="DESIGN")
    into_drive: str = text_option(
        "drive of that design that gets the motion", "--into-drive", default="", metavar="NAME"
    )


def run_motion(arguments: MotionArguments, painter: Painter | None) -> int:
    """Write the motion, and print its peaks."""
    if (arguments.out is None) == (arguments.into is None):
        raise KindynaError("motion: give --out FILE.toml, or --into DESIGN")
    source = load_one(arguments.design, arguments.drive)
    shifted = shift_motion(alone(source), arguments.shift_deg)
    if arguments.segments:
        shifted = lobe_to_segments(shifted)
    if arguments.out is not None:
        save(shifted, arguments.out)
    elif arguments.into is not None:
        machine = load(arguments.into)
        index = number_of(machine, arguments.into_drive)
        save(with_only(machine, index, with_motion_of(only(machine, index), shifted)), arguments.into, in_place=True)
    print(new_design_text(shifted))
    return DONE


# -- rankings of laws and blends in a design --------------------------------------------------------------------


def ranked_rows(
    design: Design, candidates: Mapping[str, Candidate], by: str
) -> tuple[tuple[RankingColumn, ...], list[RankingRow]]:
    """Columns of a ranking, and its rows sorted by a column, by the first one where none is named. Raises KindynaError."""
    figures = ranking_columns(design)
    if not figures:
        raise KindynaError("this design cannot rank motions: it needs a cam and loads; add both, or omit the design")
    keys = [figure.key for figure in figures]
    if by and by not in keys:  # the unit may be left out
        by = next((key for key in keys if split_unit(key)[0] == by), by)
    if by and by not in keys:
        raise KindynaError(f"--by {by}: this design has no such figure; allowed: {' | '.join(keys)}")
    return figures, sorted_rows(list(ranking(candidates, figures)), keys.index(by) if by else 0)


def row_data(figures: Sequence[RankingColumn], row: RankingRow) -> dict[str, Any]:
    """Data of a row for JSON; ``problem`` is empty where the design has a solution with that motion."""
    values = zip(figures, row.figures, strict=True)
    return {**{figure.key: value for figure, value in values}, "problem": row.problem}


def ranking_text(heading: str, figures: Sequence[RankingColumn], rows: Sequence[RankingRow]) -> str:
    """Table of a ranking; a row without figures ends with its reason."""
    table: list[tuple[str, ...]] = [(heading, *(f"{figure.title} {figure.symbol}" for figure in figures), "")]
    table.extend(
        (row.name, *("–" if value is None else digits(value) for value in row.figures), row.problem) for row in rows
    )
    widths = columns([row[:-1] for row in table])
    return "\n".join(f"{line}  {row[-1]}".rstrip() for line, row in zip(widths, table, strict=True)) + "\n"
