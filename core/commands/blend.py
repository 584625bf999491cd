"""The command ``blend``: a motion blended from elementary curves."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from core.blend import (
    CONSTANT_VELOCITY,
    ELEMENTS,
    GOALS,
    MOTION_TYPES,
    SETTINGS,
    Blended,
    BlendError,
    Request,
    best,
    blend,
)
from core.blend.apply import into_design
from core.commands import DONE, Painter
from core.commands.common import drive_option, number, pictures
from core.design import only, with_only
from core.output.blend_figure import blend_figure
from core.output.blend_text import beside_text, blend_text, curves_data, table_data, table_text
from core.output.summary import to_json
from core.project import load, number_of, save
from core.project.files import write

PICTURES = (".png", ".svg")
_WANTED = ("type", "stroke", "start", "end")


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
    """By name; raises BlendError where a name is given two values."""
    settings = dict(given)
    for name, value in given:
        if value != settings[name]:
            raise BlendError(
                f"{name} = {value:g}, {name} = {settings[name]:g}: a setting has one value; give one", name
            )
    return settings


def _picture(text: str) -> Path:
    if Path(text).suffix.lower() not in PICTURES:
        raise argparse.ArgumentTypeError(f"{text!r}: file of a picture; allowed endings: {', '.join(PICTURES)}")
    return Path(text)


def _curve(text: str) -> str:
    """A curve of the table, or none."""
    if text and text.upper() not in ELEMENTS:
        raise argparse.ArgumentTypeError(f"{text!r}: unknown curve; allowed: {' | '.join(ELEMENTS)}")
    return text.upper()


def options(parser: argparse.ArgumentParser) -> None:
    types = "; ".join(f"{slug}: {row.label[:1].lower()}{row.label[1:]}" for slug, row in MOTION_TYPES.items())
    angle = number("cam angle in degrees", "0 ... 360")
    parser.add_argument("--type", choices=tuple(MOTION_TYPES), help=types)
    parser.add_argument("--stroke", type=number("stroke", "above 0"), metavar="S", help="of the rise (mm, or --unit)")
    parser.add_argument(
        "--return-stroke", type=number("return stroke", "above 0"), default=0.0, metavar="S", help="where it differs"
    )
    parser.add_argument("--start", type=angle, metavar="DEG", help="cam angle where it starts")
    parser.add_argument("--end", type=angle, metavar="DEG", help="cam angle where it ends")
    where = CONSTANT_VELOCITY[1:]
    parser.add_argument(
        "--constant-velocity", nargs="?", const="rise", default="none", choices=where, help="plain = rise"
    )
    flat = "flat1: span of a constant acceleration inside the curve of h1, a1: its size"
    names = (
        f"{' | '.join(SETTINGS)}; {flat}; with --best, length is the least length of the stretch at constant velocity"
    )
    parser.add_argument("--set", action="append", default=[], type=_setting, metavar="NAME=VALUE", help=names)
    point = "a displacement to pass at a cam angle, above the lowest; counts as a setting"
    parser.add_argument("--point", action="append", default=[], type=_point, metavar="DEG=S", help=point)
    parser.add_argument("--sequence", default="", metavar="C1-H2-P2", help="this sequence and no other")
    parser.add_argument("--best", choices=tuple(GOALS), help="the gentlest, over what the settings leave free")
    parser.add_argument("--unit", choices=("mm", "deg"), default="mm", help="of the stroke (mm)")
    picture = f"displacement, velocity and acceleration as a picture: {' or '.join(PICTURES)}"
    parser.add_argument("--out", type=_picture, metavar="NAME", help=picture)
    table = "print which curve may follow which, with the signs at their ends, and do nothing else; CURVE: what may follow it, and why not"
    parser.add_argument("--table", nargs="?", const="", type=_curve, metavar="CURVE", help=table)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--into", type=Path, metavar="DESIGN", help="write it into a design file")
    ranked = (
        "rank this blend, the other sequences that answer, and the laws by what each costs in a design at its speed"
    )
    parser.add_argument("--rank", type=Path, metavar="DESIGN", help=ranked)
    parser.add_argument(
        "--by", default="", metavar="COLUMN", help="what the rows are sorted by, as JSON names it (peak_torque_nm)"
    )
    drive_option(parser)


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """A blended motion, printed and perhaps painted or written into a design; or the table of the curves."""
    if arguments.table is not None:
        words = arguments.table, arguments.type or ""
        print(to_json(table_data(*words)) if arguments.json else table_text(*words), end="")
        return DONE
    missing = [f"--{name}" for name in _WANTED if getattr(arguments, name) is None]
    if missing:
        raise BlendError(
            f"blend: {', '.join(missing)}: wanted for a motion; --table alone prints which curve may follow which"
        )
    constant = arguments.constant_velocity
    if constant == "rise" and arguments.type == "DRD-return":
        constant = "return"  # plain: of the one stroke there is
    request = Request(
        type=arguments.type,
        stroke=arguments.stroke,
        start=arguments.start,
        end=arguments.end,
        constant=constant,
        settings=_settings(arguments.set),
        return_stroke=arguments.return_stroke,
        points=tuple(arguments.point),
        sequence=arguments.sequence,
        unit=arguments.unit,
    )
    blended = best(request, arguments.best) if arguments.best else blend(request)
    if arguments.rank is not None:
        return _rank(arguments, blended)
    beside = ""
    if arguments.into is not None:
        whole = load(arguments.into)
        number = number_of(whole, arguments.drive)
        before = only(whole, number)
        made = into_design(before, blended)
        save(with_only(whole, number, made), arguments.into, in_place=True)
        beside = beside_text(before, made, blended)
    if arguments.out is not None:
        painted = pictures(painter, blend_figure(blended, arguments.out.stem))
        for name, data in painted.items():
            if Path(name).suffix == arguments.out.suffix.lower():
                write(arguments.out, data)
    print(to_json(curves_data(blended)) if arguments.json else blend_text(blended) + beside, end="")
    return DONE


def _rank(arguments: argparse.Namespace, blended: Blended) -> int:
    """Print the blend, and what it and all in its place cost in the design. Raises KindynaError."""
    from core.commands.ranked import data_of, rows_of, text_of
    from core.find import blend_candidates

    if arguments.into is not None or arguments.out is not None:
        raise BlendError("--rank: a blend is ranked in a design, nothing is written; leave --into and --out out")
    whole = load(arguments.rank)
    design = only(whole, number_of(whole, arguments.drive))
    candidates = blend_candidates(blended, partial(into_design, design), arguments.best or "")
    figures, rows = rows_of(design, candidates, arguments.by)
    if arguments.json:
        ranking = [{"blend": row.name, **data_of(figures, row)} for row in rows]
        print(to_json({"curves": curves_data(blended), "ranking": ranking}), end="")
    else:
        print(blend_text(blended) + "\n" + text_of("in its place", figures, rows), end="")
    return DONE
