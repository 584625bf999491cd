"""Dialog of the surfaces and the solid of a cam, with a shaded drawing that the mouse turns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QColor, QPainter
from PySide6.QtWidgets import QComboBox, QWidget

from core.design import Design
from core.frozen import frozen
from core.numerics.derivatives import seen_from
from core.output.solids.barrel import BarrelSolid, has_closed_groove
from core.output.solids.blank import UncutBlank
from core.output.solids.disk import Prisms
from core.output.solids.mesh import bisected_triangles
from core.output.solids.outline import area, polygon
from core.output.solids.prism import Cap, Prism, in_space
from core.output.solids.surface import (
    SIDES,
    SURFACE_FORMATS,
    SurfaceJob,
    SurfaceRequest,
    drawn_surfaces,
    summary,
    surface_job,
)
from core.study import Study
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.request_form import ComputedDialog, RequestForm, accepted, flanks
from kindyna_gui.look import Picture
from kindyna_gui.pictures.shapes import fit_transform, joined, outline, segments
from kindyna_gui.pictures.style import SCREEN, THIN, brush
from kindyna_gui.pictures.turning import TurnedByMouse

# -- shaded drawing --------------------------------------------------------------------------------------

MARGIN, COARSE, COARSE_SURFACE = 20, 1e-3, 1e-3  # pixels; tolerances of what is drawn, relative to the size
LONGEST = 0.25  # side of a triangle of a sheet relative to the size: longer ones could hide what is in front of them
LIGHT = np.array([-0.45, -0.35, 0.82])
DARKEST, CREASE = 0.62, 0.9  # brightness away from the light; cosine of the angle from which an edge is drawn


@frozen(eq=False)
class SolidPreview:
    """A file of surfaces, and what is drawn: bodies between level planes, or triangles (n, 3, 3) [mm].

    ``is_closed``: the triangles enclose a solid. ``lines`` (n, 3) [mm] are the rims of a blank that the surfaces do not cut.
    """

    job: SurfaceJob
    prisms: tuple[Prism, ...]
    triangles: np.ndarray
    is_closed: bool = False
    lines: tuple[np.ndarray, ...] = ()


class SolidPicture(TurnedByMouse, Picture):
    """Shaded drawing of bodies between level planes, seen from above; a drag turns it, a double click returns.

    What is lower is drawn first, on a level its faces, then the walls of holes, then the others: seen from above this hides
    what is hidden. A wall that passes a level is drawn in parts.
    """

    flattest = 10.0

    def __init__(self) -> None:
        super().__init__("Picture of the surfaces", QSize(300, 300), QSize(460, 420))
        self._polygons: list[tuple[Prism, list[np.ndarray]]] = []
        self.setCursor(Qt.CursorShape.OpenHandCursor)
        self.setToolTip("Drag to turn; double-click for the isometric view")

    def show_picture(self, shown: Any, message: str = "") -> None:
        self._polygons = []
        if shown is not None and shown.prisms:
            size = max(abs(piece.start) for prism in shown.prisms for wall in prism.walls for piece in wall.outline)
            self._polygons = [
                (prism, [polygon(wall.outline, COARSE * size) for wall in prism.walls]) for prism in shown.prisms
            ]
        super().show_picture(shown, message)

    def _seen(self, points: np.ndarray, height: float) -> np.ndarray:
        return seen_from(in_space(points, height), self.turn, self.tilt)

    @property
    def _towards_viewer(self) -> np.ndarray:
        turn, tilt = np.deg2rad((self.turn, self.tilt))
        return np.array([np.sin(turn) * np.cos(tilt), -np.cos(turn) * np.cos(tilt), np.sin(tilt)])

    def draw(self, painter: QPainter) -> None:
        if self.shown.triangles.size:
            self._draw_triangles(painter, self.shown)
            return
        extent = [
            self._seen(points, z)
            for prism, loops in self._polygons
            for wall, points in zip(prism.walls, loops, strict=True)
            for z in (wall.low, wall.high)
        ]
        transform = fit_transform(np.concatenate(extent), self.size(), MARGIN)
        painter.setTransform(transform, True)
        for prism, loops in self._polygons:
            levels = {prism.level(cap.rims[0]) for cap in prism.caps if cap.is_up}
            parts: list[tuple[float, int, Callable[[], None]]] = [
                (level, 0, partial(self._draw_cap, painter, cap, loops, level))
                for cap in prism.caps
                for level in (prism.level(cap.rims[0]),)
                if cap.is_up
            ]
            for wall, points in zip(prism.walls, loops, strict=True):
                heights = sorted({wall.low, wall.high, *(level for level in levels if wall.low < level < wall.high)})
                rank = 1 if area(wall.outline) < 0.0 else 2
                parts += [
                    (
                        low,
                        rank,
                        partial(self._draw_wall, painter, points, (low, high), low == wall.low, bool(prism.caps)),
                    )
                    for low, high in pairwise(heights)
                ]
            for _, _, draw in sorted(parts, key=lambda part: part[:2]):
                draw()

    def _draw_triangles(self, painter: QPainter, shown: SolidPreview) -> None:
        """Triangles from the farthest to the nearest; of sheets those that face away too, which are darker."""
        triangles = shown.triangles
        lines = [seen_from(line, self.turn, self.tilt) for line in shown.lines]
        seen = seen_from(triangles.reshape(-1, 3), self.turn, self.tilt).reshape(-1, 3)
        painter.setTransform(fit_transform(np.concatenate([seen.ravel(), *lines]), self.size(), MARGIN), True)
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        towards = self._towards_viewer
        light = DARKEST + (1.0 - DARKEST) * np.clip(normal @ LIGHT, 0.0, 1.0)
        is_facing = normal @ towards > 0.0
        light = np.where(is_facing, light, DARKEST * DARKEST)
        order = np.argsort(triangles.mean(axis=1) @ towards, kind="stable")
        for i in order[is_facing[order]].tolist() if shown.is_closed else order.tolist():
            colour = self._shade(light[i]).name()
            painter.setPen(SCREEN.pen(colour, THIN))  # no seams
            painter.setBrush(brush(colour))
            painter.drawPath(outline(seen[i]))
        painter.setPen(SCREEN.pen(SCREEN.ink, THIN))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for line in lines:
            painter.drawPath(outline(line))

    def _shade(self, brightness: float) -> QColor:
        colour = QColor(SCREEN.cam)
        return QColor.fromHslF(max(colour.hslHueF(), 0.0), colour.hslSaturationF(), colour.lightnessF() * brightness)

    def _draw_cap(self, painter: QPainter, cap: Cap, loops: Sequence[np.ndarray], level: float) -> None:
        path = joined(*(outline(self._seen(loops[rim.wall], level)) for rim in cap.rims))
        path.setFillRule(Qt.FillRule.OddEvenFill)
        painter.setPen(SCREEN.pen(SCREEN.ink, THIN))
        painter.setBrush(brush(self._shade(1.0).name()))
        painter.drawPath(path)

    def _draw_wall(
        self, painter: QPainter, points: np.ndarray, heights: tuple[float, float], has_rim: bool, is_solid: bool
    ) -> None:
        """Sides that face the viewer; of a sheet also those that face away, first."""
        following = np.roll(points, -1)
        normal = -1j * (following - points) / np.abs(following - points)
        towards = self._towards_viewer
        facing = normal.real * towards[0] + normal.imag * towards[1]
        light = DARKEST + (1.0 - DARKEST) * np.clip(normal.real * LIGHT[0] + normal.imag * LIGHT[1], 0.0, 1.0)
        low, high = (self._seen(points, height) for height in heights)
        shown = facing > 0.0 if is_solid else np.ones(points.size, dtype=bool)
        order = np.flatnonzero(shown)
        for i in order[np.argsort(facing[order] > 0.0, kind="stable")].tolist():
            end = (i + 1) % points.size
            colour = self._shade(light[i] if facing[i] > 0.0 else DARKEST * DARKEST)
            painter.setPen(SCREEN.pen(colour.name(), THIN))  # no seams
            painter.setBrush(brush(colour.name()))
            painter.drawPath(outline(np.array([low[i], low[end], high[end], high[i]])))
        before = np.roll(normal, 1)
        is_sharp = (before * normal.conj()).real < CREASE
        upright = np.flatnonzero((shown != np.roll(shown, 1)) | (is_sharp & shown) | (is_sharp & np.roll(shown, 1)))
        lines = [(complex(low[i]), complex(high[i])) for i in upright]
        lower = [(complex(low[i]), complex(low[(i + 1) % points.size])) for i in order] if has_rim else []
        upper = [] if is_solid else [(complex(high[i]), complex(high[(i + 1) % points.size])) for i in order]
        painter.setPen(SCREEN.pen(SCREEN.ink, THIN))
        painter.drawPath(segments([*lines, *lower, *upper]))


# -- dialog ----------------------------------------------------------------------------------------------


class SurfaceDialog(ComputedDialog):
    """Dialog for the format, flank and tolerance of a file of surfaces, or of the solid, with a drawing."""

    command, help_page = "surface", "tour#Export > Solid and surfaces"

    def __init__(self, parent: QWidget, design: Design) -> None:
        self._design, self.format, self.picture = design, QComboBox(), SolidPicture()
        self._solid = design.drive.has_disk or has_closed_groove(design)  # as chosen last for a format that has solids
        offered = flanks(design) if design.drive.has_disk else {"flank": SIDES}
        form = RequestForm(SurfaceRequest, offered, {"solid": self._solid}, [("Format", self.format)])
        super().__init__(parent, "surfaces", form, self.picture)
        fill_choices(self.format, self._formats())
        self.form.boxes["solid"].toggled.connect(self._show_rows)
        self.format.currentIndexChanged.connect(self._show_format)
        self._show_format()

    def _formats(self) -> dict[str, str]:
        rows = {
            ending: row for ending, row in SURFACE_FORMATS.items() if row.has_disks or has_closed_groove(self._design)
        }
        return {ending: f"{row.label} ({ending})" for ending, row in rows.items()}

    @property
    def ending(self) -> str:  # type: ignore[override]
        """Ending of the selected format: ``.step``."""
        ending: str = self.format.currentData()
        return ending

    def _show_format(self) -> None:
        """Show the fields that the selected format has."""
        has_solids, solid = SURFACE_FORMATS[self.ending].has_solids, self.form.boxes["solid"]
        solid.blockSignals(True)
        solid.setChecked(has_solids and self._solid)
        solid.setEnabled(has_solids)
        solid.blockSignals(False)
        self._show_rows()
        self.changed()

    def _show_rows(self) -> None:
        """A solid has all flanks, and so has the path of a cutter."""
        row = SURFACE_FORMATS[self.ending]
        solid, flank = self.form.boxes["solid"], self.form.boxes["flank"]
        if solid.isEnabled():
            self._solid = solid.isChecked()
        has_all = solid.isChecked() or not row.has_disks
        if has_all:
            flank.setCurrentIndex(0)
        flank.setEnabled(not has_all)
        for name in {name for other in SURFACE_FORMATS.values() for name in other.fields}:
            self.form.rows.setRowVisible(self.form.boxes[name], name in row.fields)

    def job(self) -> Callable[[], SolidPreview]:
        return partial(_preview, self._design, self.ending, self.form.request)

    def show_waiting(self) -> None:
        self.picture.wait()

    def show_result(self, computed: SolidPreview | None) -> str:
        self.picture.show_picture(computed)
        return "" if computed is None else f"{summary(computed.job)}."


def _preview(design: Design, ending: str, request: SurfaceRequest) -> SolidPreview:
    job = surface_job(Study(design), Path(f"surface{ending}"), request)
    surfaces = drawn_surfaces(job)
    if isinstance(surfaces, Prisms):
        return SolidPreview(job, surfaces.prisms, np.zeros((0, 3, 3)))
    size = max(float(np.abs(body.vertices).max()) for body in surfaces.bodies)
    tolerance = COARSE_SURFACE * size
    if isinstance(surfaces, UncutBlank):
        sheets = bisected_triangles(surfaces.sheet_triangles(tolerance), LONGEST * size)
        return SolidPreview(job, (), sheets, lines=surfaces.rims(tolerance))
    return SolidPreview(job, (), surfaces.triangles(tolerance), is_closed=isinstance(surfaces, BarrelSolid))


def ask_surface(parent: QWidget, design: Design) -> tuple[SurfaceJob, str] | None:
    """Ask for a file of surfaces; return its content and ending, None where the user cancels."""
    dialog = SurfaceDialog(parent, design)
    result: SolidPreview | None = accepted(dialog)
    return None if result is None else (result.job, dialog.ending)
