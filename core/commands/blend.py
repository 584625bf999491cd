"""The command ``blend``: a motion blended from elementary curves."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from core.blend import (
    CONSTANT_VELOCITY,
    ELEMENTS,
    GOALS,
    MOTION_TYPES,
    SETTINGS,
    Blended,
    BlendError,
    Request,
    SequenceRequest,
    best,
    best_of_sequence,
    blend,
    blend_sequence,
)
from core.blend.apply import into_design
from core.blend.request import KINDS, LEAST_STROKE
from core.blend.succession import broken_at, type_of
from core.commands import DONE, Painter
from core.commands.common import as_json, drive_name, ending_with, pictures, sorted_by
from core.design import only, with_only
from core.design.fields import choice, number
from core.frozen import frozen
from core.output.blend_figure import blend_figure
from core.output.blend_text import beside_text, blend_text, curves_data, table_data, table_text
from core.output.summary import to_json
from core.project import load, number_of, save
from core.project.files import write
from core.requests import asked, typed

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


def _curve(text: str) -> str:
    """A curve of the table, or none."""
    if text and text.upper() not in ELEMENTS:
        raise argparse.ArgumentTypeError(f"{text!r}: unknown curve; allowed: {' | '.join(ELEMENTS)}")
    return text.upper()


def _typed(sequence: str) -> tuple[str, str]:
    """The type of motion that a sequence is, and its constant velocity; empty where it is of none. Raises BlendError."""
    if broken := broken_at(sequence):
        raise BlendError(f"--sequence {sequence}: {broken}")
    return type_of(sequence)


def _types_help() -> str:
    return "; ".join(f"{slug}: {row.label[:1].lower()}{row.label[1:]}" for slug, row in MOTION_TYPES.items())


@frozen(kw_only=True)
class Arguments:
    """The motion that is wanted, and where it goes; or what is asked of the table of the curves."""

    type: str | None = choice("Type", tuple(MOTION_TYPES), default=None, help=_types_help())
    stroke: float | None = asked(
        number("Stroke", LEAST_STROKE, 1e9, default=None, help="of the rise (mm, or --unit)"), metavar="S"
    )
    return_stroke: float = asked(
        number("Return stroke", LEAST_STROKE, 1e9, default=0.0, help="where it differs"), metavar="S"
    )
    start: float | None = asked(
        number("Cam angle in degrees", 0.0, 360.0, default=None), help="cam angle where it starts", metavar="DEG"
    )
    end: float | None = asked(
        number("Cam angle in degrees", 0.0, 360.0, default=None), help="cam angle where it ends", metavar="DEG"
    )
    constant_velocity: str = asked(
        choice("Constant velocity", CONSTANT_VELOCITY[1:], default="none", help="plain = rise"), nargs="?", const="rise"
    )
    set: tuple[tuple[str, float], ...] = typed(
        f"{' | '.join(SETTINGS)}; flat1: span of a constant acceleration inside the curve of h1, a1: its size; "
        "length, length2: span of the constant velocity, of the return where the rise has one too; with --best the least span",
        default=(),
        action="append",
        type=_setting,
        metavar="NAME=VALUE",
    )
    point: tuple[tuple[float, float], ...] = typed(
        "a displacement to pass at a cam angle, above the lowest; counts as a setting",
        default=(),
        action="append",
        type=_point,
        metavar="DEG=S",
    )
    sequence: str = typed(
        "this sequence and no other; it says its type of motion and constant velocity itself. One of no type, of any curves "
        f"that join, takes --set with the curves and strokes counted from 1: {', '.join(f'{name}1' for name in KINDS)}",
        default="",
        metavar="C1-H2-P2",
    )
    best: str | None = choice(
        "Best", tuple(GOALS), default=None, help="the gentlest, over what the settings leave free"
    )
    unit: str = choice("Unit", ("mm", "deg"), default="mm", help="of the stroke")
    out: Path | None = typed(
        f"displacement, velocity and acceleration as a picture: {' or '.join(PICTURES)}",
        default=None,
        type=ending_with("a picture", *PICTURES),
        metavar="NAME",
    )
    table: str | None = typed(
        "print which curve may follow which, with the signs at their ends, and do nothing else; CURVE: what may follow it, "
        "and why not",
        default=None,
        nargs="?",
        const="",
        type=_curve,
        metavar="CURVE",
    )
    json: bool = as_json()
    into: Path | None = typed("write it into a design file", default=None, type=Path, metavar="DESIGN")
    rank: Path | None = typed(
        "rank this blend, the other sequences that answer, and the laws by what each costs in a design at its speed",
        default=None,
        type=Path,
        metavar="DESIGN",
    )
    by: str = sorted_by()
    drive: str = drive_name()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """A blended motion, printed and perhaps painted or written into a design; or the table of the curves."""
    if arguments.table is not None:
        words = arguments.table, arguments.type or ""
        print(to_json(table_data(*words)) if arguments.json else table_text(*words), end="")
        return DONE
    constant, motion_type = arguments.constant_velocity, arguments.type
    if arguments.sequence and motion_type is None:
        motion_type, constant = _typed(arguments.sequence)
    blended = _of_a_sequence(arguments) if motion_type == "" else _of_a_type(arguments, motion_type, constant)
    if arguments.rank is not None:
        return _rank(arguments.rank, arguments, blended)
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


def _require(missing: Sequence[str]) -> None:
    if missing:
        raise BlendError(
            f"blend: {', '.join(missing)}: wanted for a motion; --table alone prints which curve may follow which"
        )


def _of_a_type(arguments: Arguments, motion_type: str | None, constant: str) -> Blended:
    """A motion of one of Yang's types. Raises BlendError."""
    wanted: dict[str, Any] = {name: getattr(arguments, name) for name in _WANTED} | {"type": motion_type}
    _require([f"--{name}" for name, value in wanted.items() if value is None])
    if constant == "rise" and arguments.type == "DRD-return":
        constant = "return"  # plain: of the one stroke there is
    request = Request(
        **wanted,
        constant=constant,
        settings=_settings(arguments.set),
        return_stroke=arguments.return_stroke,
        points=arguments.point,
        sequence=arguments.sequence,
        unit=arguments.unit,
    )
    return best(request, arguments.best) if arguments.best else blend(request)


def _of_a_sequence(arguments: Arguments) -> Blended:
    """Any curves of the table in a row; a stroke is that of the first rise, or return where there is none. Raises BlendError."""
    _require([f"--{name}" for name in ("start", "end") if getattr(arguments, name) is None])
    if arguments.point:
        raise BlendError(
            "--point: only of the four types of motion; set the cam angle where a curve ends: --set end2=120"
        )
    assert arguments.start is not None
    assert arguments.end is not None
    request = SequenceRequest(
        tuple(arguments.sequence.upper().split("-")), arguments.start, arguments.end, {}, arguments.unit
    )
    names = [name for name in ("rise1", "return1") if name in request.strokes]
    values = arguments.stroke, arguments.return_stroke
    strokes = {name: value for name, value in zip(names, values, strict=False) if value}
    request = replace(request, settings=strokes | _settings(arguments.set))
    return best_of_sequence(request, arguments.best) if arguments.best else blend_sequence(request)


def _rank(path: Path, arguments: Arguments, blended: Blended) -> int:
    """Print the blend, and what it and all in its place cost in the design. Raises KindynaError."""
    from core.commands.ranked import data_of, rows_of, text_of
    from core.find import blend_candidates

    if arguments.into is not None or arguments.out is not None:
        raise BlendError("--rank: a blend is ranked in a design, nothing is written; leave --into and --out out")
    whole = load(path)
    design = only(whole, number_of(whole, arguments.drive))
    candidates = blend_candidates(blended, partial(into_design, design), arguments.best or "")
    figures, rows = rows_of(design, candidates, arguments.by)
    if arguments.json:
        ranking = [{"blend": row.name, **data_of(figures, row)} for row in rows]
        print(to_json({"curves": curves_data(blended), "ranking": ranking}), end="")
    else:
        print(blend_text(blended) + "\n" + text_of("in its place", figures, rows), end="")
    return DONE
