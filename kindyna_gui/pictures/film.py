"""Animations."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping
from io import BytesIO
from math import ceil
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QPoint
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtWidgets import QWidget

from core.design import Design
from core.errors import KindynaError
from core.output.export import Film
from core.output.position import Snapshot
from core.study import Study
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.painter import PICTURES, MechanismSheet, chart_file
from kindyna_gui.pictures.style import LIGHT

if TYPE_CHECKING:
    from PIL import Image

    from core.commands import Drawn


# -- film ------------------------------------------------------------------------------------------------

# The same design gives the same bytes.

COLOURS, SAMPLE_FRAMES = 255, 6  # of the palette, and frames it is made from
LEAST_SAMPLES = 1440  # of a turn, for smooth outlines

GoOn = Callable[[int], bool]
"""Takes the frames done; False stops the work."""


class _Stopped(Exception):
    """The user has had enough."""


def _one(design: Design, samples: int, layers: Mapping[str, bool]) -> MechanismScene:
    """A mechanism with these layers."""
    scene = MechanismScene(theme=LIGHT)
    for name, shown in layers.items():
        scene.set_layer(name, shown)
    scene.update_study(Study(design, samples))
    return scene


def _all(design: Design, samples: int) -> Assembly:
    """All drives of a shaft, side by side."""
    scene = Assembly(LIGHT)
    scene.show_shaft(Study(design, samples).camshaft, 0, about_shaft=False)
    return scene


class Camera:
    """Takes pictures of a mechanism at any part of the turn."""

    def __init__(self, design: Design, film: Film, layers: Mapping[str, bool]) -> None:
        ensure_app(offscreen=True)
        self._film = film
        # so many samples that each frame falls on one
        samples = film.frames * ceil(LEAST_SAMPLES / film.frames)
        self._scene = _all(design, samples) if design.listed else _one(design, samples, layers)
        self._sheet = MechanismSheet(self._scene, film.width, film.height)
        self._sheet.grab()  # sizes are settled by drawing once

    def take(self, frame: int) -> Image.Image:
        """The frame of this number, in full colour."""
        from PIL import Image

        self._scene.set_fraction(frame / self._film.frames)
        image = QImage(self._film.width, self._film.height, QImage.Format.Format_RGB888)
        image.fill(QColor("white"))
        painter = QPainter(image)
        try:
            QWidget.render(self._sheet, painter, QPoint())
        finally:
            painter.end()
        size = (image.width(), image.height())
        return Image.frombuffer("RGB", size, bytes(image.constBits()), "raw", "RGB", image.bytesPerLine(), 1)


def _packed(frame: Image.Image) -> np.ndarray:
    """Colours as one number each (height, width)."""
    parts = np.asarray(frame, dtype=np.uint32)
    packed: np.ndarray = parts[..., 0] << 16 | parts[..., 1] << 8 | parts[..., 2]
    return packed


class Palette:
    """The commonest colours of a few frames spread over the turn: papers and fills keep theirs to the bit, the shades
    of their edges take the nearest. (Pillow's own look-up is coarser and would turn white paper grey.)"""

    def __init__(self, camera: Camera, film: Film) -> None:
        pixels = np.concatenate(
            [_packed(camera.take(film.frames * i // SAMPLE_FRAMES)).ravel() for i in range(SAMPLE_FRAMES)]
        )
        colours, counts = np.unique(pixels, return_counts=True)
        self._colours = colours[np.lexsort((colours, -counts.astype(np.int64)))][:COLOURS]
        self._known = np.full(1 << 24, -1, dtype=np.int16)
        self._known[self._colours] = np.arange(self._colours.size)

    def reduce(self, frame: Image.Image) -> Image.Image:
        """The frame in these colours."""
        from PIL import Image

        packed = _packed(frame)
        indices = self._known[packed]
        new = np.unique(packed[indices < 0])
        if new.size:
            apart = [_part(new, i)[:, None] - _part(self._colours, i) for i in range(3)]
            self._known[new] = np.argmin(sum(d * d for d in apart), axis=1)
            indices = self._known[packed]
        reduced = Image.fromarray(indices.astype(np.uint8), "P")
        reduced.putpalette([int(_part(colour, i)) for colour in self._colours for i in range(3)])
        return reduced


def _part(packed: np.ndarray, which: int) -> np.ndarray:
    """Red, green or blue of packed colours."""
    part: np.ndarray = (packed >> (16 - 8 * which) & 255).astype(np.int64)
    return part


def _turn(camera: Camera, film: Film, go_on: GoOn) -> Image.Image:
    """The turn as an image of many frames, each drawn when Pillow comes to it: so it is encoded before the next is drawn."""
    from PIL import Image

    class Turn(Image.Image):
        n_frames, is_animated = film.frames, True

        def __init__(self) -> None:
            super().__init__()
            self._frame = -1
            self.seek(0)

        def tell(self) -> int:
            return self._frame

        def seek(self, frame: int) -> None:
            if frame == film.frames:
                raise EOFError
            if frame == self._frame:
                return
            if frame > self._frame and not go_on(frame):
                raise _Stopped
            taken = camera.take(frame)
            self._frame, self._size, self._mode, self.im = frame, taken.size, taken.mode, taken.im

    return Turn()


class _Watched(BytesIO):
    """A file that calls ``go_on`` before each part is written, and stops where that returns False."""

    def __init__(self, go_on: Callable[[], bool]) -> None:
        super().__init__()
        self._go_on = go_on

    def write(self, data: Any) -> int:
        if not self._go_on():
            raise _Stopped
        return super().write(data)


def _gif(camera: Camera, film: Film, go_on: GoOn) -> bytes:
    palette, target = Palette(camera, film), _Watched(lambda: go_on(film.frames))
    frames = (palette.reduce(camera.take(n)) for n in range(film.frames) if _allowed(go_on, n))
    next(frames).save(
        target, "GIF", save_all=True, append_images=frames, duration=film.delays, loop=0, optimize=False, disposal=1
    )
    return target.getvalue()


def _webp(camera: Camera, film: Film, go_on: GoOn) -> bytes:
    target = BytesIO()
    turn = _turn(camera, film, go_on)
    turn.save(target, "WEBP", save_all=True, duration=film.delays, loop=0, lossless=True, quality=60, method=2)
    return target.getvalue()


def _allowed(go_on: GoOn, number: int) -> bool:
    if not go_on(number):
        raise _Stopped
    return True


def _mp4(camera: Camera, film: Film, go_on: GoOn) -> bytes:
    """By the program ffmpeg, which takes the frames as they are drawn. Raises KindynaError where there is none, or it fails."""
    program = shutil.which(FFMPEG)
    if program is None:
        raise KindynaError(
            "MP4: no ffmpeg is found on the PATH; install it, or take .gif, .webp, .html or a folder of pictures"
        )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.mp4"
        size, rate = f"{film.width // 2 * 2}x{film.height // 2 * 2}", f"{film.frames / film.seconds:.6g}"
        command = [program, "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", rate,
                   "-i", "-", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-fflags", "+bitexact", "-flags:v", "+bitexact",
                   str(path)]  # fmt: skip
        with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as running:
            assert running.stdin is not None
            assert running.stderr is not None
            try:
                for number in range(film.frames):
                    _allowed(go_on, number)
                    frame = camera.take(number)
                    running.stdin.write(frame.crop((0, 0, film.width // 2 * 2, film.height // 2 * 2)).tobytes())
                running.stdin.close()
            except BrokenPipeError:
                pass  # it says why
            except _Stopped:
                running.kill()
                raise
            said = running.stderr.read().decode("utf-8", "replace").strip()
        if running.returncode != 0 or not path.is_file():
            raise KindynaError(f"MP4: ffmpeg fails: {said.splitlines()[-1] if said else running.returncode}")
        return path.read_bytes()


def pictures(
    design: Design, film: Film, layers: Mapping[str, bool] = MappingProxyType({}), go_on: GoOn | None = None
) -> dict[str, bytes] | None:
    """File name -> picture, one for each frame; None where ``go_on`` stopped it. Raises as ``shoot``."""
    camera, made = Camera(design, film, layers), {}
    for number in range(film.frames):
        if go_on is not None and not go_on(number):
            return None
        target = BytesIO()
        camera.take(number).save(target, "PNG")
        made[f"frame_{number:03d}.png"] = target.getvalue()
    return made


FFMPEG = "ffmpeg"
WRITERS: Mapping[str, Callable[[Camera, Film, GoOn], bytes]] = MappingProxyType(
    {".gif": _gif, ".webp": _webp, ".mp4": _mp4}
)
"""Of the files that hold all frames."""


def shoot(
    design: Design, film: Film, layers: Mapping[str, bool] = MappingProxyType({}), go_on: GoOn | None = None
) -> bytes | None:
    """One turn as an animation that repeats for ever; None where ``go_on`` stopped it.

    layers: those of ``mechanism.LAYERS`` that shall be other than usual. Raises NoSolution where the design has no
    mechanism.
    """
    camera = Camera(design, film, layers)
    try:
        return WRITERS[film.ending](camera, film, go_on or (lambda _: True))
    except _Stopped:
        return None


# -- painter ---------------------------------------------------------------------------------------------


def paint(drawn: Drawn) -> dict[str, bytes]:
    """The pictures of a report, of a linkage at one angle, of a chart, of another figure, of a paper, of a graph: file name -> content;
    of a report to hand on: its ending -> content. Raises NoSolution where the design has none."""
    from core.output.report.document import Printed

    ensure_app(offscreen=True)
    if isinstance(drawn, Printed):
        from kindyna_gui.pictures.paper.report import report_file

        return {drawn.ending: report_file(drawn.document, drawn.ending) or b""}
    if isinstance(drawn, Study):
        without = () if "cam" in drawn.stages else ("cam.png",)
        return {name: draw(drawn) for name, draw in PICTURES.items() if name not in without}
    if isinstance(drawn, Snapshot):
        from kindyna_gui.pictures.painter import SNAPSHOTS

        return {
            f"{name}{ending}": draw(drawn, ending) for name, draw in SNAPSHOTS.items() for ending in (".svg", ".png")
        }
    from core.output.graph.curves import GraphImage

    if isinstance(drawn, GraphImage):
        from kindyna_gui.pictures.paper.sheets import graph_file

        return {f"graph{drawn.ending}": graph_file(drawn)}
    from core.plot import Figure
    from core.stability import Chart
    from kindyna_gui.pictures.paper.sheets import figure_file

    if isinstance(drawn, Chart) and drawn.machine is not None:
        return {f"stability{ending}": chart_file(drawn, ending) for ending in (".svg", ".png")}
    if not isinstance(drawn, Figure):
        from kindyna_gui.pictures.paper.paper_figures import paper_file

        if isinstance(drawn, Chart):
            return {f"stability{ending}": paper_file(drawn, ending) for ending in (".svg", ".png")}
        return {f"figure{ending}": paper_file(drawn, ending) for ending in (".svg", ".png")}
    return {f"{drawn.name}{ending}": figure_file(drawn, ending) for ending in (".svg", ".png")}
