"""Animations of a mechanism as files, and the images of reports, charts and papers. Equal designs give equal bytes."""

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
from PySide6.QtGui import QColor, QImage
from PySide6.QtWidgets import QWidget

from core.design import Design
from core.errors import KindynaError
from core.output.export import Film
from core.output.position import Snapshot
from core.study import Study
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.painter import PICTURES, SNAPSHOTS, MechanismSheet, chart_file, paint_on
from kindyna_gui.pictures.style import LIGHT

if TYPE_CHECKING:
    from PIL import Image

    from core.commands import Drawn


COLOURS, SAMPLE_FRAMES = 255, 6  # of the palette, and frames from which it is determined
LEAST_SAMPLES = 1440  # of a turn, for smooth outlines
FFMPEG = "ffmpeg"

GoOn = Callable[[int], bool]
"""Function called with the number of finished frames; returns False to stop the work."""

# -- frames ----------------------------------------------------------------------------------------------


class _Stopped(Exception):
    """The user has stopped the work."""


class Camera:
    """Camera that draws the frames of a film."""

    def __init__(self, design: Design, film: Film, layers: Mapping[str, bool]) -> None:
        ensure_app(offscreen=True)
        self._film = film
        samples = film.frames * ceil(LEAST_SAMPLES / film.frames)  # each frame is at a sample
        self._scene: MechanismScene | Assembly
        if design.listed:
            self._scene = Assembly(LIGHT)
            self._scene.show_shaft(Study(design, samples).camshaft, 0, about_shaft=False)
        else:
            self._scene = MechanismScene(theme=LIGHT)
            for name, shown in layers.items():
                self._scene.set_layer(name, shown)
            self._scene.update_study(Study(design, samples))
        self._sheet = MechanismSheet(self._scene, film.width, film.height)
        self._sheet.grab()  # drawing once determines the sizes

    def take(self, frame: int) -> Image.Image:
        """Frame with this number, in full colour."""
        from PIL import Image

        self._scene.set_fraction(frame / self._film.frames)
        image = QImage(self._film.width, self._film.height, QImage.Format.Format_RGB888)
        image.fill(QColor("white"))
        paint_on(image, lambda painter: QWidget.render(self._sheet, painter, QPoint()))
        size = (image.width(), image.height())
        return Image.frombuffer("RGB", size, bytes(image.constBits()), "raw", "RGB", image.bytesPerLine(), 1)


def _packed(frame: Image.Image) -> np.ndarray:
    """Colours of an image as numbers (height, width)."""
    parts = np.asarray(frame, dtype=np.uint32)
    packed: np.ndarray = parts[..., 0] << 16 | parts[..., 1] << 8 | parts[..., 2]
    return packed


class Palette:
    """Palette of the most frequent colours in a few frames of the film.

    Paper and fills keep their exact colours; the shades of their edges are replaced by the nearest colour. Pillow's own
    search is coarser: it would make white paper grey.
    """

    def __init__(self, camera: Camera, film: Film) -> None:
        pixels = np.concatenate(
            [_packed(camera.take(film.frames * i // SAMPLE_FRAMES)).ravel() for i in range(SAMPLE_FRAMES)]
        )
        colours, counts = np.unique(pixels, return_counts=True)
        self._colours = colours[np.lexsort((colours, -counts.astype(np.int64)))][:COLOURS]
        self._index = np.full(1 << 24, -1, dtype=np.int16)  # of every colour, -1 before it has occurred
        self._index[self._colours] = np.arange(self._colours.size)

    def reduce(self, frame: Image.Image) -> Image.Image:
        """Frame in the colours of the palette."""
        from PIL import Image

        packed = _packed(frame)
        indices = self._index[packed]
        new = np.unique(packed[indices < 0])
        if new.size:
            differences = [_part(new, i)[:, None] - _part(self._colours, i) for i in range(3)]
            self._index[new] = np.argmin(sum(d * d for d in differences), axis=1)
            indices = self._index[packed]
        reduced = Image.fromarray(indices.astype(np.uint8), "P")
        reduced.putpalette([int(_part(colour, i)) for colour in self._colours for i in range(3)])
        return reduced


def _part(packed: np.ndarray, index: int) -> np.ndarray:
    """Red, green or blue (index 0, 1, 2) of packed colours."""
    part: np.ndarray = (packed >> (16 - 8 * index) & 255).astype(np.int64)
    return part


# -- files of animations ---------------------------------------------------------------------------------


def _turn(camera: Camera, film: Film, go_on: GoOn) -> Image.Image:
    """The turn as an image of many frames, each drawn when Pillow seeks it, so that it is encoded before the next one."""
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
            image = camera.take(frame)
            self._frame, self._size, self._mode, self.im = frame, image.size, image.mode, image.im

    return Turn()


class _Watched(BytesIO):
    """File that calls ``go_on`` before each write, and raises _Stopped where that returns False."""

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
    """Encode the frames with the program ffmpeg as they are drawn."""
    program = shutil.which(FFMPEG)
    if program is None:
        raise KindynaError(
            "MP4: ffmpeg is not on the PATH; install it, or choose .gif, .webp, .html or a folder of images"
        )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.mp4"
        size, rate = f"{film.width // 2 * 2}x{film.height // 2 * 2}", f"{film.frames / film.seconds:.6g}"
        command = [program, "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", rate,
                   "-i", "-", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-fflags", "+bitexact", "-flags:v", "+bitexact",
                   str(path)]  # fmt: skip
        with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            assert process.stdin is not None
            assert process.stderr is not None
            try:
                for number in range(film.frames):
                    _allowed(go_on, number)
                    frame = camera.take(number)
                    process.stdin.write(frame.crop((0, 0, film.width // 2 * 2, film.height // 2 * 2)).tobytes())
                process.stdin.close()
            except BrokenPipeError:
                pass  # ffmpeg writes the reason
            except _Stopped:
                process.kill()
                raise
            output = process.stderr.read().decode("utf-8", "replace").strip()
        if process.returncode != 0 or not path.is_file():
            raise KindynaError(f"MP4: ffmpeg fails: {output.splitlines()[-1] if output else process.returncode}")
        return path.read_bytes()


WRITERS: Mapping[str, Callable[[Camera, Film, GoOn], bytes]] = MappingProxyType(
    {".gif": _gif, ".webp": _webp, ".mp4": _mp4}
)
"""Ending of an animation's file -> its writer."""


def pictures(
    design: Design, film: Film, layers: Mapping[str, bool] = MappingProxyType({}), go_on: GoOn | None = None
) -> dict[str, bytes] | None:
    """One turn as PNG images.

    Parameters and exceptions are those of `shoot`.

    Returns
    -------
    dict of str to bytes
        File name -> content of each frame; None where ``go_on`` stopped the work.
    """
    camera, images = Camera(design, film, layers), {}
    for number in range(film.frames):
        if go_on is not None and not go_on(number):
            return None
        target = BytesIO()
        camera.take(number).save(target, "PNG")
        images[f"frame_{number:03d}.png"] = target.getvalue()
    return images


def shoot(
    design: Design, film: Film, layers: Mapping[str, bool] = MappingProxyType({}), go_on: GoOn | None = None
) -> bytes | None:
    """One turn as an animation in a continuous loop.

    Parameters
    ----------
    design : Design
    film : Film
        Size, duration and ending of the file.
    layers : mapping of str to bool
        Layers of the drawing to show or hide, different from the default.
    go_on : GoOn, optional

    Returns
    -------
    bytes
        Content of the file; None where ``go_on`` stopped the work.

    Raises
    ------
    NoSolution
        Where the design has no mechanism.
    KindynaError
        Where ffmpeg, which MP4 needs, is missing or fails.
    """
    camera = Camera(design, film, layers)
    try:
        return WRITERS[film.ending](camera, film, go_on or (lambda _: True))
    except _Stopped:
        return None


# -- images by kind --------------------------------------------------------------------------------------


def paint(drawn: Drawn) -> dict[str, bytes]:
    """Images of a report, snapshot, chart, figure or graph.

    Returns
    -------
    dict of str to bytes
        File name -> content; of a printed report its ending -> content.

    Raises
    ------
    NoSolution
        Where the design has no solution.
    """
    from core.output.report.document import Printed

    ensure_app(offscreen=True)
    if isinstance(drawn, Printed):
        from kindyna_gui.pictures.paper.report import report_file

        return {drawn.ending: report_file(drawn.document, drawn.ending) or b""}
    if isinstance(drawn, Study):
        return {name: draw(drawn) for name, draw in PICTURES.items() if name != "cam.png" or "cam" in drawn.stages}
    from core.output.graph.curves import GraphImage

    if isinstance(drawn, GraphImage):
        from kindyna_gui.pictures.paper.sheets import graph_file

        return {f"graph{drawn.ending}": graph_file(drawn)}
    drawings: Mapping[str, Callable[[Any, str], bytes]] = SNAPSHOTS if isinstance(drawn, Snapshot) else _drawings(drawn)
    return {f"{name}{ending}": draw(drawn, ending) for name, draw in drawings.items() for ending in (".svg", ".png")}


def _drawings(drawn: Drawn) -> dict[str, Callable[[Any, str], bytes]]:
    """File name without ending -> function that draws a chart, or a figure."""
    from core.plot import Figure
    from core.stability import Chart
    from kindyna_gui.pictures.paper.sheets import figure_file

    if isinstance(drawn, Figure):
        return {drawn.name: figure_file}
    from kindyna_gui.pictures.paper.paper_figures import paper_file

    if isinstance(drawn, Chart):
        return {"stability": paper_file if drawn.machine is None else chart_file}
    return {"figure": paper_file}
