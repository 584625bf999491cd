"""Commands of ``kindyna --headless`` that paint, most of them a window which is never shown: they are added to those of the core.

Nothing of Qt is imported before one of them runs.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType

from core.commands import DONE, DONE_WITH_ERRORS, Command, Painter
from core.commands.common import drive_option, studied, verdict
from core.design import distances
from core.project import load, load_one
from core.project.files import write, write_all
from core.study import Study

USUAL_SIZE = (1440, 900)
LEAST_SIDE, MOST_SIDE = 320, 8000
FRAMES, FILM_SIZE = 72, (800, 600)
MOST_FRAMES = 360
FILMS = (".gif", ".webp")
NO_DESKTOP = "This plugin does not support"


def size(text: str) -> tuple[int, int]:
    """``1440x900``."""
    match = re.fullmatch(r"(\d+)[x×](\d+)", text)
    sides = (int(match[1]), int(match[2])) if match else (0, 0)
    if not all(LEAST_SIDE <= side <= MOST_SIDE for side in sides):
        allowed = f"WIDTHxHEIGHT, each {LEAST_SIDE} ... {MOST_SIDE} pixels, such as 1440x900"
        raise argparse.ArgumentTypeError(f"{text!r}: size of a picture; allowed: {allowed}")
    return sides


def frames(text: str) -> int:
    """Frames of a turn."""
    value = int(text) if text.isdecimal() else 0
    if not 2 <= value <= MOST_FRAMES:
        raise argparse.ArgumentTypeError(f"{text!r}: frames per turn; allowed: 2 ... {MOST_FRAMES}")
    return value


def film(text: str) -> Path:
    """A file that an animation can be written to."""
    path = Path(text)
    if path.suffix.lower() not in FILMS:
        raise argparse.ArgumentTypeError(f"{text!r}: file of an animation; allowed endings: {', '.join(FILMS)}")
    return path


def sheet(text: str) -> Path:
    """A file that a drawing can be written to."""
    from core.output.drawing import ENDINGS

    path = Path(text)
    if path.suffix.lower() not in ENDINGS:
        raise argparse.ArgumentTypeError(f"{text!r}: file of a drawing; allowed endings: {', '.join(ENDINGS)}")
    return path


def chart(text: str) -> Path:
    """A file that a timing chart can be written to."""
    from core.output.timing import ENDINGS

    path = Path(text)
    if path.suffix.lower() not in ENDINGS:
        raise argparse.ArgumentTypeError(f"{text!r}: file of a timing chart; allowed endings: {', '.join(ENDINGS)}")
    return path


def _screenshot_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("design", metavar="DESIGN", type=Path, help="design file (.toml)")
    parser.add_argument("--out", type=Path, default=Path("out"), metavar="DIR", help="folder to write to (out)")
    parser.add_argument("--size", type=size, default=USUAL_SIZE, metavar="WxH", help="of the window (1440x900)")


def _animation_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("design", metavar="DESIGN", type=Path, help="design file (.toml)")
    parser.add_argument("--out", type=film, default=Path("out.gif"), metavar="FILE", help=".gif or .webp (out.gif)")
    parser.add_argument("--frames", type=frames, default=FRAMES, metavar="N", help=f"per turn ({FRAMES})")
    parser.add_argument("--size", type=size, default=FILM_SIZE, metavar="WxH", help="in pixels (800x600)")


def _no_options(parser: argparse.ArgumentParser) -> None:
    """Takes none."""


def _drawing_options(parser: argparse.ArgumentParser) -> None:
    from core.output.drawing import ENDINGS, PAPERS
    from core.output.profile import ALL_FLANKS

    parser.add_argument("design", metavar="DESIGN", type=Path, help="design file (.toml)")
    parser.add_argument(
        "--out", type=sheet, required=True, metavar="FILE", help=f"file to write: {' or '.join(ENDINGS)}"
    )
    parser.add_argument("--paper", choices=tuple(PAPERS), default="A4", help="size of the sheet, lying (A4)")
    parser.add_argument("--flank", default="inner", choices=ALL_FLANKS, help="which side of the cam (inner)")
    drive_option(parser)
    parser.add_argument("--date", default="", metavar="TEXT", help="for the field of the title block, empty without it")


def _timing_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("design", metavar="DESIGN", type=Path, help="design file (.toml)")
    parser.add_argument(
        "--out", type=chart, required=True, metavar="FILE", help=".pdf, .svg or .png; .csv: the events as a table"
    )
    parser.add_argument("--axis", choices=("deg", "ms"), default="deg", help="what its axis counts in (deg)")


def never_shown() -> None:
    """Whatever the desktop is, nothing may appear on it. To be called before there is an application."""
    os.environ["QT_QPA_PLATFORM"] = "offscreen"


@contextmanager
def quiet() -> Iterator[None]:
    """Leaves out what Qt prints about windows without a desktop; everything else is printed."""
    from PySide6.QtCore import qInstallMessageHandler

    def listen(kind: object, context: object, text: str) -> None:
        if not text.startswith(NO_DESKTOP):
            print(text, file=sys.stderr)

    before = qInstallMessageHandler(listen)
    try:
        yield
    finally:
        qInstallMessageHandler(before)


def screenshots(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """The window and every view of it as pictures."""
    design = load(arguments.design)
    code = verdict(studied(design))
    never_shown()
    from kindyna_gui.screenshots import shots

    with quiet():
        made = shots(design, arguments.size)
    write_all(arguments.out, made)
    for name in made:
        print(arguments.out / name)
    return code


def animation(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """One turn of the mechanism as an animation."""
    design = load(arguments.design)
    study = studied(design)
    code = verdict(study)
    never_shown()
    from kindyna_gui.pictures.film import Film, shoot
    from kindyna_gui.player import usual

    wanted = Film(arguments.out.suffix.lower(), arguments.frames, *arguments.size, usual(study.omega).seconds)
    with quiet():
        data = shoot(design, wanted)
    assert data is not None
    write(arguments.out, data)
    print(arguments.out)
    return code


def drawing(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """The drawing of the cam for the workshop."""
    from core.output.drawing import drawing as drawn

    study = Study(load_one(arguments.design, arguments.drive))
    page = drawn(study, arguments.flank, arguments.paper, arguments.date)
    never_shown()
    from kindyna_gui.pictures.sheet_file import sheet_file

    with quiet():
        data = sheet_file(page, arguments.out.suffix.lower())
    write(arguments.out, data)
    print(arguments.out)
    return verdict(study, ("cam",))


def timing(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """The timing chart of a shaft, or its events as a table."""
    design = load(arguments.design)
    never_shown()
    from kindyna_gui.pictures.timing_file import timing_file

    with quiet():
        data = timing_file(design, arguments.out.suffix.lower(), arguments.axis)
    write(arguments.out, data)
    print(arguments.out)
    return DONE if all(row.kept for row in distances(design)) else DONE_WITH_ERRORS


def selftest(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """Every example through the window: edit, undo, turn, export, compare."""
    never_shown()
    from kindyna_gui.selftest import verdicts

    failed = False
    with quiet():
        for name, trouble, summary in verdicts():
            print(f"FAILED {name}: {trouble}" if trouble else f"ok {name}: {summary}", flush=True)
            failed = failed or bool(trouble)
    return DONE_WITH_ERRORS if failed else DONE


COMMANDS: Mapping[str, Command] = MappingProxyType(
    {
        "screenshots": Command("every view of the window as PNG", _screenshot_options, screenshots),
        "animation": Command("one turn of the mechanism as GIF or WebP", _animation_options, animation),
        "drawing": Command("the cam as a drawing for the workshop, PDF or SVG", _drawing_options, drawing),
        "timing": Command(
            "the timing chart of a shaft as PDF, SVG or PNG, or its events as CSV", _timing_options, timing
        ),
        "selftest": Command("try every example through the window and compare with the core", _no_options, selftest),
    }
)
