"""What is constructed on the drawing of a linkage: centres, the lines that find them, velocity ratios, paths of points.

Each layer is read and drawn when it is first shown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QRectF

from core.instant_centres import CHAINS
from kindyna_gui.pictures.drawing.centre_parts import (
    Z_CENTRES,
    Z_LINES,
    CentreMarks,
    KennedyLines,
    coupler_curves,
    coupler_paths,
    ghost_poses,
)
from kindyna_gui.pictures.drawing.free_space import TakenSpace
from kindyna_gui.pictures.drawing.geometry import Geometry
from kindyna_gui.pictures.drawing.labels import ink
from kindyna_gui.pictures.drawing.layers import GHOSTS
from kindyna_gui.pictures.drawing.ratio_parts import Z_RATIOS, RatioDimensions
from kindyna_gui.pictures.items import DrawnPart
from kindyna_gui.pictures.style import Theme
from kindyna_gui.pictures.viewport import Viewport


class Construct:
    """The layers of one reading; ``begin`` before each move, ``show_step`` for the circle diagram.

    texts   gives the boxes of the labels that are shown, in pixels of the whole scene
    """

    def __init__(
        self, geometry: Geometry, theme: Theme, viewport: Viewport, texts: Callable[[], list[QRectF]], step: int | None
    ) -> None:
        self._geometry, self._theme, self._viewport, self._texts = geometry, theme, viewport, texts
        self._step, self._made = step, set[str]()
        self._index = 0
        self._room: TakenSpace | None = None
        self.marks: CentreMarks | None = None
        self.kennedy: KennedyLines | None = None
        self.ratios: dict[str, RatioDimensions] = {}

    def parts(self, layer: str) -> Iterator[DrawnPart]:
        """The parts of a layer, made the first time it is shown."""
        if layer not in self._made:
            self._made.add(layer)
            yield from _LAYERS[layer](self, layer)
            self.show_step(self._step)

    def begin(self, index: int) -> None:
        """The drawing moves to a sample: all texts find their places anew."""
        self._index, self._room = index, None

    def room(self) -> TakenSpace:
        """What is taken at the sample at hand."""
        if self._room is None:
            drawn = ink(self._geometry, np.array([self._index]), ())
            self._room = TakenSpace(self._viewport, drawn, self._texts())
            down = 0.0
            for ratios in self._listed():
                ratios.list(self._index, self._room, down)
                down += ratios.height
            if self.marks is not None and self.marks.item.isVisible():
                self.marks.dots(self._index, self._room)
        return self._room

    @property
    def strip(self) -> float:
        """Height of what is listed at the top of the picture [pixels]."""
        return sum(ratios.height for ratios in self._listed())

    def _listed(self) -> list[RatioDimensions]:
        return [ratios for ratios in self.ratios.values() if ratios.item.isVisible()]

    def show_step(self, step: int | None) -> None:
        """Only the centres known at a step of the circle diagram, and the lines that find the next; None: all."""
        self._step = step
        if self.marks is None and self.kennedy is None:
            return
        plan = self._geometry.study.centres.construction
        known = None if step is None else frozenset((*plan.known, *(w.key for w in plan.steps[:step])))
        wanted = plan.steps[step - 1].key if step and step <= len(plan.steps) else None
        if self.marks is not None:
            self.marks.only = known
        if self.kennedy is not None:
            self.kennedy.emphasise(wanted if step is not None else None)
            self.kennedy.hidden = step == 0

    # -- layers ---------------------------------------------------------------------------------------------

    def _centres(self, layer: str) -> Iterator[DrawnPart]:
        self.marks = CentreMarks(self._geometry.study.centres, self._theme, self._viewport, self.room)
        yield DrawnPart(f"{layer}.all", self.marks.item, (layer,), Z_CENTRES, self.marks.move)

    def _kennedy(self, layer: str) -> Iterator[DrawnPart]:
        table = self._geometry.study.centres
        self.kennedy = KennedyLines(table, table.construction.steps, self._theme, self._viewport)
        yield DrawnPart(f"{layer}.all", self.kennedy.item, (layer,), Z_LINES, self.kennedy.move)

    def _ratios(self, layer: str) -> Iterator[DrawnPart]:
        drawn = RatioDimensions(self._geometry, CHAINS[layer], self._theme, self._viewport, self.room)
        self.ratios[layer] = drawn
        yield DrawnPart(f"{layer}.all", drawn.item, (layer,), Z_RATIOS, drawn.move)

    def paths(self) -> list[np.ndarray]:
        """The coupler curves (n,) [mm]."""
        return list(coupler_paths(self._geometry))

    def _coupler(self, layer: str) -> Iterator[DrawnPart]:
        yield from coupler_curves(self._geometry, self._theme)

    def _poses(self, layer: str) -> Iterator[DrawnPart]:
        yield from ghost_poses(self._geometry, self._theme, layer)


_LAYERS: Mapping[str, Callable[[Construct, str], Iterator[DrawnPart]]] = MappingProxyType(
    {
        "centres": Construct._centres,
        "kennedy": Construct._kennedy,
        "ratios": Construct._ratios,
        "chain": Construct._ratios,
        "coupler": Construct._coupler,
        **dict.fromkeys(GHOSTS, Construct._poses),
    }
)
