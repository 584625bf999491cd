"""Commands of ``kindyna --headless`` that paint, most of them in a hidden window, in addition to those of the core.

Qt is imported only when one of them runs.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from core.commands import DONE, DONE_WITH_ERRORS, Command, Painter
from core.commands.common import as_json, design_file, drive_name, ending_with, folder, picture_size, studied, verdict
from core.design import distances
from core.design.fields import choice, flag
from core.frozen import frozen
from core.output.export import FORMATS as FILMS
from core.output.export import Film
from core.output.timing import ENDINGS as CHARTS
from core.project import load, load_one
from core.project.files import write, write_into
from core.requests import text_option
from core.study import Study

PAGE, PICTURES = ".html", ".png"
NO_DESKTOP = "This plugin does not support"
SIZE = picture_size(320, 8000)


def film_name(text: str) -> Path:
    """Return the path of an animation; without an ending it is a folder for its frames."""
    return ending_with("an animation", *FILMS, PAGE)(text) if Path(text).suffix else folder(text)


@frozen(kw_only=True)
class Screenshots:
    """Options of ``screenshots``: design, folder, size of the window."""

    design: Path = design_file()
    out: Path = text_option("folder to write to", default=Path("out"), type=Path, metavar="DIR")
    size: tuple[int, int] = text_option(
        "of the window", default=(1440, 900), default_text="1440x900", type=SIZE, metavar="WxH"
    )


@frozen(kw_only=True)
class Animation:
    """Options of ``animation``: design, file, frames, size."""

    design: Path = design_file()
    out: Path = text_option(
        ".gif, .webp, .mp4 (by ffmpeg); .html: a web page with a model to play or drag; a folder: an image of each frame",
        default=Path("out.gif"),
        type=film_name,
        metavar="FILE|DIR",
    )
    film: Film = Film()
    size: tuple[int, int] = text_option(
        "in pixels", default=(800, 600), default_text="800x600", type=SIZE, metavar="WxH"
    )


def _drawing_options() -> type:
    from core.output.files.cam_drawing import ENDINGS
    from core.output.files.sheet import DrawingRequest

    @frozen(kw_only=True)
    class Drawing:
        """Options of ``drawing``: design, file, drive, sheet."""

        design: Path = design_file()
        out: Path = text_option(
            f"file to write: {' or '.join(ENDINGS)}", type=ending_with("a drawing", *ENDINGS), metavar="FILE"
        )
        drive: str = drive_name()
        request: DrawingRequest = DrawingRequest()

    return Drawing


@frozen(kw_only=True)
class Timing:
    """Options of ``timing``: design, file, unit of the axis."""

    design: Path = design_file()
    out: Path = text_option(
        ".pdf, .svg or .png; .csv: the events as a table", type=ending_with("a timing chart", *CHARTS), metavar="FILE"
    )
    axis: str = choice(
        "Axis", ("deg", "ms", "crank"), default="deg", help="unit of the axis; crank: valve lifts over crank degrees"
    )


def _handover_options() -> type:
    from core.output.handover import HandoverRequest

    @frozen(kw_only=True)
    class HandOver:
        """Options of ``handover``: design, folder or archive, content."""

        design: Path = design_file()
        out: Path = text_option("folder, empty or new, or NAME.zip", type=folder, metavar="DIR|NAME.zip")
        request: HandoverRequest = HandoverRequest()
        json: bool = as_json("print contents.json")

    return HandOver


@frozen(kw_only=True)
class Tutorial:
    """Options of ``tutorial``: lesson, whether it is played, images."""

    name: str = text_option("lift, linkage, camshaft, or a file of steps", "NAME")
    play: bool = flag(
        "Play", help="perform the steps with mouse and keys in a hidden window; exit 1 at the step that fails"
    )
    out: Path | None = text_option(
        "folder for an image after each step, as WebP", default=None, type=Path, metavar="DIR"
    )
    size: tuple[int, int] = text_option(
        "of the window", default=(1280, 720), default_text="1280x720", type=SIZE, metavar="WxH"
    )


@frozen
class NoOptions:
    """Options of a command without any."""


def hide_windows() -> None:
    """Keep all windows off the desktop; called before an application exists."""
    os.environ["QT_QPA_PLATFORM"] = "offscreen"


@contextmanager
def quiet() -> Iterator[None]:
    """Suppress messages of Qt about windows without a desktop; all others are printed."""
    from PySide6.QtCore import qInstallMessageHandler

    def listen(kind: object, context: object, text: str) -> None:
        if not text.startswith(NO_DESKTOP):
            print(text, file=sys.stderr)

    before = qInstallMessageHandler(listen)
    try:
        yield
    finally:
        qInstallMessageHandler(before)


def screenshots(arguments: Screenshots, painter: Painter | None) -> int:
    """Write images of the window and of every view."""
    design = load(arguments.design)
    code = verdict(studied(design))
    hide_windows()
    from kindyna_gui.screenshots import shots

    with quiet():
        images = shots(design, arguments.size)
    write_into(arguments.out, images)
    for name in images:
        print(arguments.out / name)
    return code


def animation(arguments: Animation, painter: Painter | None) -> int:
    """Write an animation of one turn of the mechanism."""
    design = load(arguments.design)
    study = studied(design)
    code = verdict(study)
    if arguments.out.suffix.lower() == PAGE:
        from core.output.handover import write_page

        write_page(study, arguments.out)
        print(arguments.out)
        return code
    hide_windows()
    from kindyna_gui.pictures.film import pictures as pictures_of
    from kindyna_gui.pictures.film import shoot
    from kindyna_gui.player import initial_speed

    width, height = arguments.size
    ending, seconds = arguments.out.suffix.lower() or PICTURES, initial_speed(study.omega).seconds
    film = replace(arguments.film, ending=ending, width=width, height=height, seconds=seconds)
    with quiet():
        if ending == PICTURES:
            write_into(arguments.out.with_suffix(""), pictures_of(design, film) or {})
        else:
            write(arguments.out, shoot(design, film) or b"")
    print(arguments.out)
    return code


def drawing(arguments: Any, painter: Painter | None) -> int:
    """Write the workshop drawing of a cam."""
    from core.output.files.cam_drawing import drawing as drawn

    study = Study(load_one(arguments.design, arguments.drive))
    page = drawn(study, arguments.request)
    hide_windows()
    from kindyna_gui.pictures.paper.sheets import sheet_file

    with quiet():
        data = sheet_file(page, arguments.out.suffix.lower())
    write(arguments.out, data)
    print(arguments.out)
    if page.missing:
        print(page.missing, file=sys.stderr)
    return verdict(study, ("cam",))


def timing(arguments: Timing, painter: Painter | None) -> int:
    """Write the timing chart of a shaft, or its events as a table."""
    design = load(arguments.design)
    hide_windows()
    from kindyna_gui.pictures.paper.timing_page import timing_file

    with quiet():
        data = timing_file(design, arguments.out.suffix.lower(), arguments.axis)
    write(arguments.out, data)
    print(arguments.out)
    return DONE if all(row.kept for row in distances(design)) else DONE_WITH_ERRORS


def handover(arguments: Any, painter: Painter | None) -> int:
    """Write the files for workshop, controls and buyer into a folder or archive."""
    from core.output.handover import handover as files_of
    from core.output.summary import to_json
    from core.requests import require_in_range

    require_in_range(arguments.request)
    study = studied(load(arguments.design))
    result = files_of(study, arguments.request)
    hide_windows()
    from kindyna_gui.pictures.paper.handover import paint_handover

    with quiet():
        more = paint_handover(study, arguments.request)
    assert more is not None
    result = result.with_files(*more)
    result.write(arguments.out)
    if arguments.json:
        print(to_json(result.contents), end="")
    else:
        print("\n".join([str(arguments.out), *(f"  {file.name}: {file.what}" for file in result.files)]))
        for name, reason in result.left_out:
            print(f"left out: {name}: {reason}", file=sys.stderr)
    return verdict(study)


def tutorial(arguments: Tutorial, painter: Painter | None) -> int:
    """Play a lesson with mouse and keys in a hidden window, or print its steps."""
    hide_windows()
    from kindyna_gui.places import default_design
    from kindyna_gui.screenshots import dismiss, hidden_window, rest, webp
    from kindyna_gui.window.tutorial import begin, read, steps_played
    from kindyna_gui.window.tutorial_steps import CannotDo

    lesson = read(arguments.name)
    if not arguments.play:
        for number, step in enumerate(lesson.steps, 1):
            print(f"{number}. {step.plain}")
        return DONE
    with quiet():
        window = hidden_window(load(default_design()), arguments.size)
        pictures: dict[str, bytes] = {}
        try:
            for number, step in steps_played(begin(window, lesson)):
                print(f"ok {number}: {step.plain}", flush=True)
                if arguments.out is not None:
                    rest(window)
                    pictures[f"tutorial_{lesson.name}_{number:02}.webp"] = webp(window)
        except CannotDo as error:
            print(f"FAILED {lesson.name}, {error}", flush=True)
            return DONE_WITH_ERRORS
        finally:
            dismiss(window)
    if arguments.out is not None:
        write_into(arguments.out, pictures)
    return DONE


def selftest(arguments: NoOptions, painter: Painter | None) -> int:
    """Test every example in a hidden window: edit, undo, turn, export, compare."""
    hide_windows()
    from kindyna_gui.selftest import verdicts

    failed = False
    with quiet():
        for name, trouble, summary in verdicts():
            print(f"FAILED {name}: {trouble}" if trouble else f"ok {name}: {summary}", flush=True)
            failed = failed or bool(trouble)
    return DONE_WITH_ERRORS if failed else DONE


COMMANDS: Mapping[str, Command] = MappingProxyType(
    {
        "screenshots": Command("every view of the window as PNG", lambda: Screenshots, screenshots),
        "animation": Command(
            "one turn of the mechanism as GIF or WebP, or as a web page", lambda: Animation, animation
        ),
        "drawing": Command("the cam as a drawing for the workshop, PDF or SVG", _drawing_options, drawing),
        "timing": Command(
            "the timing chart of a shaft as PDF, SVG or PNG, or its events as CSV", lambda: Timing, timing
        ),
        "handover": Command(
            "profiles, drawings, inspection, a controller's tables, report, web page and the design in one folder or archive",
            _handover_options,
            handover,
        ),
        "tutorial": Command("print the steps of a lesson, or play it", lambda: Tutorial, tutorial),
        "selftest": Command(
            "test every example in a hidden window and compare with the core", lambda: NoOptions, selftest
        ),
    }
)
