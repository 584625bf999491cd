"""A picture or a drawing under the drawing of a linkage: where it lies, kept in a file beside the design's, and the corners and centres
of a DXF."""

from __future__ import annotations

import cmath
import json
import math
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from core.contour.drawing import DrawingError, text_of
from core.contour.dxf import NoDrawing, read_drawing
from core.contour.polylines import Layout
from core.errors import DesignError, FileError
from core.frozen import frozen
from core.project import parsed
from core.project.files import read_bytes, read_text, remove, write_into

PICTURES = (".png", ".jpg", ".jpeg", ".svg")
DXF = ".dxf"
ENDINGS = (*PICTURES, DXF)
_UNITS_MM = {1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0}  # $INSUNITS -> mm
_RANGES = {
    "x_mm": (-1e6, 1e6), "y_mm": (-1e6, 1e6), "scale_mm_per_unit": (1e-9, 1e6), "angle_deg": (-360.0, 360.0), "opacity": (0.0, 1.0),
}  # fmt: skip


@frozen
class Underlay:
    """Where a picture lies: its origin (of a picture the lower left corner, of a DXF its own) in the plane of the linkage, how many mm a
    unit of it is (of a picture a pixel), by how much it is turned, and how much of it is seen."""

    file: Path
    x_mm: float = 0.0
    y_mm: float = 0.0
    scale_mm_per_unit: float = 1.0
    angle_deg: float = 0.0
    opacity: float = 0.5
    locked: bool = False

    @property
    def _unit(self) -> complex:
        return cmath.rect(self.scale_mm_per_unit, math.radians(self.angle_deg))

    def placed(self, z: Any) -> Any:
        """Points of the picture (n,) complex [its units] in the plane of the linkage [mm]."""
        return complex(self.x_mm, self.y_mm) + self._unit * z

    def local(self, at: complex) -> complex:
        """A place of the plane [mm] in the picture [its units]."""
        return (at - complex(self.x_mm, self.y_mm)) / self._unit

    def moved(self, by: complex) -> Underlay:
        """Shifted [mm]."""
        return replace(self, x_mm=self.x_mm + by.real, y_mm=self.y_mm + by.imag)

    def scaled(self, one: complex, other: complex, distance_mm: float) -> Underlay:
        """So large that two places of it [mm] are so far apart; the first stays. Raises DrawingError."""
        if one == other or not distance_mm > 0.0:
            raise DrawingError(
                f"distance {distance_mm:g} mm of two places of the underlay; allowed: above 0, of two places"
            )
        factor = distance_mm / abs(other - one)
        return replace(self._with_fixed(one, factor), scale_mm_per_unit=self.scale_mm_per_unit * factor)

    def turned(self, one: complex, other: complex, angle_deg: float) -> Underlay:
        """So that the line from one place of it [mm] to another stands at an angle; the first stays."""
        by = angle_deg - math.degrees(cmath.phase(other - one))
        turned = math.remainder(self.angle_deg + by, 360.0)
        return replace(self._with_fixed(one, cmath.rect(1.0, math.radians(by))), angle_deg=turned)

    def _with_fixed(self, at: complex, factor: complex) -> Underlay:
        origin = at + (complex(self.x_mm, self.y_mm) - at) * factor
        return replace(self, x_mm=origin.real, y_mm=origin.imag)


# -- beside the design ------------------------------------------------------------------------------------


def sidecar(design: Path) -> Path:
    """The file that keeps the underlay of a design's file."""
    return design.with_suffix(".underlay.toml")


def read_underlay(design: Path) -> Underlay | None:
    """The underlay of a design's file; None where it has none. Raises FileError."""
    path = sidecar(design)
    if not path.is_file():
        return None
    try:
        table = parsed(read_text(path), str(path))
    except DesignError as error:
        raise FileError(f"{error}; mend it, or delete it") from None
    file, locked = table.pop("file", None), table.pop("locked", False)
    if not isinstance(file, str) or not file:
        raise FileError(f"{path}: file: the name of a picture is wanted: {' | '.join(ENDINGS)}")
    if not isinstance(locked, bool):
        raise FileError(f"{path}: locked: {locked!r}; allowed: true | false")
    for name, value in table.items():
        if name not in _RANGES:
            raise FileError(f"{path}: {name}: unknown; allowed: file, {', '.join(_RANGES)}, locked")
        low, high = _RANGES[name]
        if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
            raise FileError(f"{path}: {name}: {value!r}; allowed: {low:g} ... {high:g}")
    return Underlay(path.parent / file, **{name: float(value) for name, value in table.items()}, locked=locked)


def keep_underlay(design: Path, underlay: Underlay | None) -> None:
    """Write it beside the design's file; None takes it away. Raises FileError, also where a file in that place is no underlay, or
    is to be taken away and was not written here."""
    path = sidecar(design)
    before = read_underlay(design)
    if underlay is not None:
        write_into(path.parent, {path.name: _text(path.parent, underlay)})
    elif before is not None:
        if read_text(path) != _text(path.parent, before):
            raise FileError(f"{path}: was not written by this program; delete it")
        remove(path)


def _text(folder: Path, underlay: Underlay) -> str:
    try:
        file = Path(os.path.relpath(underlay.file, folder)).as_posix()
    except ValueError:  # on another drive
        file = underlay.file.as_posix()
    rows = [f"file = {json.dumps(file, ensure_ascii=False)}"]
    rows += [f"{name} = {getattr(underlay, name)!r}" for name in _RANGES]
    return "\n".join([*rows, f"locked = {str(underlay.locked).lower()}"]) + "\n"


# -- a DXF ------------------------------------------------------------------------------------------------


@frozen(eq=False)
class DxfLines:
    """The lines of a DXF [its units], each through points (n,) complex; its corners and centres (k,) complex; the mm of a unit, 1 where its
    header states none; and what is left out of it, a line each."""

    lines: tuple[np.ndarray, ...]
    corners: np.ndarray
    centres: np.ndarray
    unit_mm: float
    notes: tuple[str, ...] = ()


def read_lines(path: Path) -> DxfLines:
    """The lines of the model space of a DXF, blocks included, without layers that are off or frozen. Raises FileError, DrawingError."""
    data = read_bytes(path)
    try:
        drawing = read_drawing(text_of(data))
    except NoDrawing as error:
        raise DrawingError(
            f"{path.name}: not a DXF drawing in text form ({' '.join(str(error).split())[:120]})"
        ) from None
    layout = Layout(drawing)
    drawn = layout.model()
    lines = np.split(_flat(drawn.points), drawn.starts[1:]) if drawn.starts.size else []
    corners, centres = (np.unique(_flat(each)) for each in (drawn.corners, drawn.centres))
    return DxfLines(tuple(lines), corners, centres, _UNITS_MM.get(drawing.unit, 1.0), tuple(layout.notes))


def _flat(points: np.ndarray) -> np.ndarray:
    """Points (n, 3) in the plane, complex; rounded by less than anybody draws, so that ends that meet are one corner."""
    known = points[np.isfinite(points).all(axis=1)] if len(points) else points
    return np.round(known[:, 0], 9) + 1j * np.round(known[:, 1], 9) + 0.0


def snap_points(underlay: Underlay) -> tuple[np.ndarray, np.ndarray]:
    """The corners (n,) and the centres (k,) of a DXF as it lies under the linkage, complex [mm]. Raises FileError, DrawingError."""
    drawn = read_lines(underlay.file)
    return underlay.placed(drawn.corners), underlay.placed(drawn.centres)


__all__ = [
    "DXF", "ENDINGS", "DxfLines", "Underlay", "keep_underlay", "read_lines", "read_underlay", "sidecar", "snap_points",
]  # fmt: skip
