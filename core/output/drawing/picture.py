"""Picture of a mechanism: links, pins, slides on their guides, supports, cam and follower's face, at one angle.

Coordinates are millimetres, with the y axis down; symbols, lines and texts have a size in pixels. All pictures of a design show
the same part of the plane, which the mechanism needs over the turn.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import product

import numpy as np

from core.cam import OUTER, SECOND
from core.mechanism.kinematics import FRAME
from core.number_text import result_text
from core.output.drawing import svg
from core.output.drawing.mechanism import drawn_bodies, face_shapes
from core.output.drawing.scales import UNSEEN, needed, nice_below, readable_unit
from core.output.drawing.scene import Scene, Slide, edge_radius
from core.output.drawing.sheet import (
    CHAIN,
    DASHED,
    DOTTED,
    OUTLINE,
    SMALL,
    THIN,
    paint,
    picture,
    text_width,
)
from core.study import Study

WIDTH, HEIGHT = 520.0, 400.0  # largest picture of one mechanism, pixels
LEAST_SIDE, LEAST_MM = 200.0, 1e-6  # least width, pixels; half the size of a mechanism that is a point
# Around the mechanism; above it for the angle, below it for the scale bar, pixels.
MARGIN, TOP, BOTTOM = 12.0, 26.0, 28.0
COLUMNS, CELL = 2, (380.0, 300.0)  # pictures of several drives in a row, and their size, pixels

PIN, BAR, RIM = 3.2, 7.0, 9.4  # radius of a pin, width of a link without and with its outlines, pixels
BLOCK, BLOCK_HEIGHT = 26.0, 16.0
# Halves of the triangle's base and of the ground; height of the triangle.
PEDESTAL, PEDESTAL_HEIGHT, GROUND = 9.0, 15.0, 14.0
HATCH, HATCH_DEPTH = 4.5, 5.0
# Around a stem: thickness, length, distance to the face, end of the stem.
BUSH, BUSH_LENGTH, BUSH_ROOM, BEYOND = 8.0, 34.0, 14.0, 10.0
STEM = 4.5  # half the width of a stem
SHAFT, CROSS = 7.0, 11.0  # radius of a camshaft, half the length of its centre lines
RIM_OF_GROOVE = 9.0  # of the plate outside a groove
ARROW_START, ARROW_SPAN, ARROW = 200.0, 80.0, 9.0  # arrow of rotation: start and span [deg], length of its head
# Distances of a label from its point, and number of directions, that are tried.
LABEL_GAPS, LABEL_STEPS = (8.0, 13.0, 19.0), 16
CLEAR = 5.0  # free around a label
LARGE_DISC = 30.0  # radius of a roller from which on the name of its centre is inside
WEB = 34.0  # reach of the web between two arms of a lever
_GROUND_ENDS = PEDESTAL_HEIGHT + HATCH_DEPTH + GROUND * np.array([-1j, 1j])
_BLOCK_CORNERS = 0.5 * BLOCK * np.array([-1.0, 1.0, 1.0, -1.0]) + 0.5j * BLOCK_HEIGHT * np.array([-1.0, -1.0, 1.0, 1.0])
SCALE_BAR = 110.0  # largest length of the scale bar


def mechanism_picture(study: Study, at_deg: float = 0.0) -> str:
    """Picture of a mechanism, or of all drives of a shaft, at an angle [deg] of cam, driver or machine, as SVG.

    Raises NoSolution where the mechanism cannot be assembled at this angle.
    """
    name = "machine angle" if study.design.listed else study.angle_name
    angle = f"{name} {result_text(at_deg, 6)}°".capitalize()
    if not study.design.listed:
        return _single(study, at_deg, angle)
    cells: list[str] = []
    rows = [(name, drive) for name, drive in study.drives.items() if name not in study.camshaft.failures]
    phases = {drive.name: drive.phase_deg for drive in study.design.drives}
    if not rows:
        raise next(iter(study.camshaft.failures.values()))
    columns = min(COLUMNS, len(rows))
    for i, (name, drive) in enumerate(rows):
        machine = _Machine(drive, at_deg - phases[name], *CELL)
        middle = machine.box_middle
        x, y = (i % columns + 0.5) * CELL[0], TOP + (i // columns + 0.5) * CELL[1]
        scale = 1.0 / machine.mm
        move = f"translate({svg.text_of(x - scale * middle.real, 2)} {svg.text_of(y + scale * middle.imag, 2)})"
        cells += svg.group(machine.lines(), transform=f"{move} scale({svg.text_of(scale, 6)})")
        title = svg.text(
            name, x=x - 0.5 * CELL[0] + MARGIN, y=y - 0.5 * CELL[1] + SMALL, font_size=SMALL, **paint("ink")
        )
        cells.append(title)
    cells.append(svg.text(angle, x=MARGIN, y=18.0, font_size=SMALL, **paint("quiet")))
    width, height = columns * CELL[0], TOP + math.ceil(len(rows) / columns) * CELL[1]
    return picture(cells, width, height, study.design.name, f"Drives at {angle[:1].lower()}{angle[1:]}")


def _single(study: Study, at_deg: float, angle: str) -> str:
    machine = _Machine(study, at_deg, WIDTH, HEIGHT)
    mm, low, high = machine.mm, *machine.view
    width, height = (high - low).real / mm, (high - low).imag / mm
    box = {"x": low.real, "y": -high.imag, "width": (high - low).real, "height": (high - low).imag}
    note = ", the cam has no solution" if machine.full.has_cam and machine.full.shape is None else ""
    at = complex(low.real + MARGIN * mm, high.imag - 18.0 * mm)
    lines = [*machine.lines(), machine.text(angle + note, at, "quiet")]
    about = f"Mechanism at {angle[:1].lower()}{angle[1:]}{note}"
    return picture(
        lines, round(width), round(height), study.design.name, about, {k: machine.short(v) for k, v in box.items()}
    )


class _Machine:
    """One mechanism within a width and height in pixels."""

    def __init__(self, study: Study, at_deg: float, width: float, height: float) -> None:
        self.full = Scene(study)
        self.scene = Scene(study.at_theta(np.deg2rad([at_deg])))
        self._room = complex(width - 2.0 * MARGIN, height - TOP - BOTTOM)
        self.mm = self._scale(*self._box(0.0))
        low, high = self._box(self.mm)
        self.mm = self._scale(low, high)
        middle, least = 0.5 * (low + high), self.mm * (LEAST_SIDE - complex(2.0 * MARGIN, TOP + BOTTOM).real)
        half = 0.5 * complex(max((high - low).real, least), max((high - low).imag, 0.5 * least))
        edge = self.mm * complex(MARGIN, BOTTOM)
        self.view = middle - half - edge, middle + half + self.mm * complex(MARGIN, TOP)
        self._decimals = max(0, math.ceil(2.0 - math.log10(self.mm)))

    @property
    def box_middle(self) -> complex:
        """Middle of the view [mm]."""
        return 0.5 * sum(self.view)

    def _scale(self, low: complex, high: complex) -> float:
        """Size of a pixel [mm]."""
        return max((high - low).real / self._room.real, (high - low).imag / self._room.imag)

    def short(self, value: float) -> float:
        """Coordinate [mm] rounded to a hundredth of a pixel."""
        return round(float(value), self._decimals) + 0.0

    # -- size ------------------------------------------------------------------------------------------

    def _box(self, mm: float) -> tuple[complex, complex]:
        """Lower left and upper right corner [mm] of everything that is drawn over the turn, with symbols for pixels of a size."""
        z = np.concatenate([*self._tracks(), *self._symbol_ends(mm)])
        low, high = complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
        room = (1.5 * RIM * mm or LEAST_MM) * (1 + 1j)
        return low - room, high + room

    def _tracks(self) -> Iterator[np.ndarray]:
        full = self.full
        for _, _, paths in drawn_bodies(full):
            yield from paths
        yield from (slide.z for slide in full.slides)
        radii = [float(np.abs(z).max()) for z in (*full.flanks.values(), full.pitch) if z.size]
        if full.has_cam:
            radius = max(radii, default=0.0)
            yield radius * np.array([-1.0, 1.0, -1j, 1j])
        if full.face is not None:
            body = full.face_body
            for corner in full.face.outline:
                yield body.z + corner * body.unit
            for radius, z in full.further_rollers:
                yield from (z + radius * step for step in (1.0, -1.0, 1j, -1j))

    def _symbol_ends(self, mm: float) -> list[np.ndarray]:
        ends = [at + direction * mm * _GROUND_ENDS for at, direction in self._supports]
        for slide in self.full.slides:
            if slide.on == FRAME:
                along = np.array([slide.low - mm * BLOCK, slide.high + mm * BLOCK])
                across = 1j * mm * (0.5 * BLOCK_HEIGHT + HATCH_DEPTH)
                ends += [slide.z[0] + slide.line[0] * (along + side * across) for side in (-1.0, 1.0)]
        if (stem := self.full.stem) is not None:
            start, length = self._bush(stem, mm)
            top = start + length + mm * BEYOND + (stem.high - stem.low)
            across = 1j * mm * (STEM + BUSH)
            ends.append(stem.z[0] + stem.outwards * stem.line[0] * np.array([top + across, top - across]))
        return ends

    @cached_property
    def _supports(self) -> list[tuple[complex, complex]]:
        """Pivots on the frame and the direction of their ground: downwards, unless a link is in the way during the turn."""
        return [(at, self._ground_direction(name, at)) for name, at in self.full.pivots.items()]

    def _ground_direction(self, name: str, at: complex) -> complex:
        body = self.full.bodies[self.full.kinematics.pairs[name].body]
        links = [body.track(point) - at for point in body.points]
        away = [z / np.abs(z) for z in links if np.abs(z).min() > 1e-9 * max(1.0, np.abs(z).max())]
        directions = (-1j, -1 + 0j, 1 + 0j, 1j)
        worst = [max((float((z * complex(d).conjugate()).real.max()) for z in away), default=0.0) for d in directions]
        return directions[next((i for i, w in enumerate(worst) if w < 0.4), int(np.argmin(worst)))]

    # -- elements --------------------------------------------------------------------------------------

    def lines(self) -> list[str]:
        """All elements, from the back to the front."""
        parts = [
            *self._cam(),
            *self._ground(),
            *self._links(),
            *self._face(),
            *self._pins(),
            *self._labels(),
            *self._scale_bar(),
        ]
        return svg.group(
            parts, stroke_width=self.short(THIN * self.mm), stroke_linejoin="round", stroke_linecap="round"
        )

    def _line(
        self,
        z: Sequence[complex] | np.ndarray,
        is_closed: bool,
        fill: str = "none",
        stroke: str = "none",
        **more: svg.Value | None,
    ) -> str:
        points = np.asarray(z, dtype=complex)
        if points.size > 3:
            points = points[needed(points, UNSEEN * self.mm)]
        return svg.polyline(points, is_closed, self._decimals, **paint(fill, stroke), **more)

    def _circle(
        self, centre: complex, radius: float, fill: str = "none", stroke: str = "none", **more: svg.Value | None
    ) -> str:
        return svg.circle(centre, radius, self._decimals, **paint(fill, stroke), **more)

    def _width(self, pixels: float) -> float:
        return self.short(pixels * self.mm)

    def _dashes(self, pattern: tuple[float, ...]) -> str:
        return " ".join(svg.text_of(part * self.mm, self._decimals) for part in pattern)

    def text(self, label: str, at: complex, role: str, anchor: str | None = None) -> str:
        """Text that begins at a point [mm]."""
        move = f"translate({svg.point(at, ' ', self._decimals)}) scale({self.mm:.6g})"  # the size of the text stays in pixels
        return svg.text(label, transform=move, font_size=SMALL, text_anchor=anchor, **paint(role))

    # -- cam -------------------------------------------------------------------------------------------

    def _cam(self) -> Iterator[str]:
        full = self.full
        if not full.has_cam:
            return
        turn = complex(np.exp(1j * self.scene.cam_angle[0]))
        flanks, outline = full.flanks, self._width(OUTLINE)
        if SECOND in flanks:
            yield self._line(flanks[SECOND] * turn, True, "second", "second-line", stroke_width=outline)
        if OUTER in flanks:
            rim = float(np.abs(flanks[OUTER]).max()) + RIM_OF_GROOVE * self.mm
            yield self._circle(0j, rim, "cam", "cam-line", stroke_dasharray=self._dashes(DOTTED))
            yield self._line(flanks[OUTER] * turn, True, "paper", "cam-line", stroke_width=outline)
        for flank, profile in flanks.items():
            if flank not in (OUTER, SECOND):
                yield self._line(profile * turn, True, "cam", "cam-line", stroke_width=outline)
                edge = edge_radius(profile)
                yield self._line([0.76 * edge * turn, edge * turn], False, "none", "cam-line")
        if SECOND in flanks:  # its hidden edge
            yield self._line(flanks[SECOND] * turn, True, "none", "second-line", stroke_dasharray=self._dashes(DASHED))
        if full.pitch.size and full.face is not None and full.face.radius:
            yield self._line(full.pitch * turn, True, "none", "quiet", stroke_dasharray=self._dashes(CHAIN))
        for radius in full.circles.values():
            yield self._circle(0j, radius, "none", "cam-line")
        if full.keyway:
            yield self._line(np.array(full.keyway) * turn, False, "none", "cam-line")
        yield from self._rotation()
        shaft = min(SHAFT * self.mm, 0.3 * self._least_radius)
        yield self._circle(0j, shaft, "shaft", "ink")
        for end in (1.0, 1j):
            yield self._line([-CROSS / SHAFT * shaft * end, CROSS / SHAFT * shaft * end], False, "none", "ink")

    @property
    def _least_radius(self) -> float:
        """Least distance of a profile from the centre [mm]; that of a symbol without a profile."""
        return min((float(np.abs(z).min()) for z in self.full.flanks.values()), default=4.0 * SHAFT * self.mm)

    def _rotation(self) -> Iterator[str]:
        """Arc with an arrow in the sense of rotation, clear of hub and bore."""
        radius, sense = 0.5 * self._least_radius, self.full.sense
        for hole in self.full.circles.values():
            radius = 1.25 * hole if 0.85 * hole < radius < 1.2 * hole else radius
        start = ARROW_START if sense > 0 else ARROW_START + ARROW_SPAN
        end = math.radians(start + sense * ARROW_SPAN)
        head = min(ARROW * self.mm, 0.3 * radius)
        angles = np.linspace(math.radians(start), end - sense * 0.7 * head / radius, 41)
        yield self._line(radius * np.exp(1j * angles), False, "none", "cam-line")
        tip = cmath.rect(radius, end)
        chord = tip - cmath.rect(radius, end - sense * head / radius)
        yield self._line(_arrow_head(tip, chord / abs(chord), head), True, "cam-line")

    # -- supports and slides ---------------------------------------------------------------------------

    def _ground(self) -> Iterator[str]:
        mm = self.mm
        for at, direction in self._supports:
            turn = 1j * direction  # the symbol is drawn downwards
            corners = np.array([0j, complex(-PEDESTAL, -PEDESTAL_HEIGHT), complex(PEDESTAL, -PEDESTAL_HEIGHT)])
            yield self._line(at + mm * turn * corners, True, "paper", "ink")
            ends = mm * turn * np.array([complex(-GROUND, -PEDESTAL_HEIGHT), complex(GROUND, -PEDESTAL_HEIGHT)])
            yield self._line(at + ends, False, "none", "ink")
            yield self._hatching(complex(at + ends[0]), complex(at + ends[1]))
        for slide in self.full.slides:
            if slide.on == FRAME and slide is not self.full.stem:
                yield from self._rails(slide)
        if self.full.stem is not None:
            yield from self._bushes(self.full.stem)

    def _rails(self, slide: Slide) -> Iterator[str]:
        along = np.array([slide.low - self.mm * BLOCK, slide.high + self.mm * BLOCK])
        for side in (1.0, -1.0):
            ends = slide.z[0] + slide.line[0] * (along + 0.5j * side * self.mm * BLOCK_HEIGHT)
            yield self._line(ends, False, "none", "ink")
            first, last = (1, 0) if side > 0 else (0, 1)
            yield self._hatching(complex(ends[first]), complex(ends[last]))

    def _bush(self, stem: Slide, mm: float) -> tuple[float, float]:
        """Start of a stem's bush outwards from the first position, beyond the farthest one, and its length [mm]."""
        farthest = stem.high if stem.outwards > 0 else -stem.low
        return farthest + self._back(stem) + mm * BUSH_ROOM, max(BUSH_LENGTH * mm, 0.5 * (stem.high - stem.low))

    def _back(self, stem: Slide) -> float:
        """Distance from the follower's reference point to the back of its face, outwards [mm]."""
        face = self.full.face
        if face is None:
            return 0.0
        outwards = stem.outwards * stem.line[0] / self.full.face_body.unit[0]
        return face.radius if self._rolls else float((face.outline * np.conj(outwards)).real.max())

    def _bushes(self, stem: Slide) -> Iterator[str]:
        direction, mm = stem.outwards * stem.line[0], self.mm
        start, length = self._bush(stem, mm)
        for side in (1.0, -1.0):
            inner, outer = side * (STEM + 1.0) * mm, side * (STEM + BUSH) * mm
            ends = np.array([complex(start, outer), complex(start + length, outer)])
            box = [*ends, complex(start + length, inner), complex(start, inner)]
            yield self._line(stem.z[0] + direction * np.array(box), True, "paper", "ink")
            first, last = stem.z[0] + direction * ends
            yield self._hatching(
                *((complex(first), complex(last)) if side > 0 else (complex(last), complex(first))), BUSH - 1.0
            )

    def _hatching(self, start: complex, end: complex, depth: float = HATCH_DEPTH) -> str:
        """Short strokes at 45° on the right of the line from start to end."""
        length, mm = abs(end - start), self.mm
        along = (end - start) / length
        count = max(2, min(200, round(length / (HATCH * mm))))
        parts = []
        for i in range(count):
            middle, half = length * (i + 0.5) / count, 0.5 * depth * mm
            near, far = min(middle + half, length), max(middle - half, 0.0)
            drop = -2.0j * half if depth == HATCH_DEPTH else -1j * (near - far)
            ends = (start + along * at for at in (complex(near), far + drop))
            parts.append("M{}L{}".format(*(svg.point(z, " ", self._decimals) for z in ends)))
        return svg.element("path", d="".join(parts), **paint("none", "quiet"))

    # -- bodies ----------------------------------------------------------------------------------------

    def _links(self) -> Iterator[str]:
        stem = self.full.stem
        slides = () if stem is not None else self.scene.slides
        yield from (self._block(slide) for slide in slides if slide.on == FRAME)
        bodies = (row for row in drawn_bodies(self.scene) if row[1] != FRAME)
        for number, (layer, name, _) in enumerate(bodies):
            fill = f"link-{number}"
            parts: list[str] = []
            if stem is not None and name == stem.body:
                parts += self._stem(stem, fill)
            for role, width in (("ink", RIM), (fill, BAR)):
                for z, closed in self._pieces(name):
                    inside = role if closed else "none"
                    parts.append(self._line(z, closed, inside, role, stroke_width=self._width(width)))
            yield from svg.group(parts, id=layer) if parts else ()
        yield from (self._block(slide) for slide in slides if slide.on != FRAME)

    def _block(self, slide: Slide) -> str:
        corners = complex(slide.z[0]) + complex(slide.line[0]) * self.mm * _BLOCK_CORNERS
        return self._line(corners, True, "slider", "ink", stroke_width=self._width(OUTLINE))

    def _nodes(self, name: str) -> list[complex]:
        """Distinct points between which a body is drawn; the body of a face that is not round ends at its back."""
        scene, face = self.scene, self.full.face
        z = [complex(path[0]) for _, body, paths in drawn_bodies(scene) if body == name for path in paths]
        if face is not None and face.attachment and name == scene.kinematics.carrier and self.full.stem is None:
            reference = complex(scene.face_body.z[0])
            z = [at for at in z if abs(at - reference) > 1e-9 * abs(reference)]
            z.append(complex(scene.face_body.placed(np.array([face.attachment]))[0]))
        return _distinct(z)

    def _pieces(self, name: str) -> list[tuple[Sequence[complex], bool]]:
        """Lines of a body: a bar, a lever with arms from its fixed pivot and webs between them, or a plate."""
        z = self._nodes(name)
        if len(z) < 3:
            return [(z, False)] if len(z) == 2 else []
        hubs = [at for key, at in self.full.pivots.items() if self.full.kinematics.pairs[key].body == name]
        if not hubs:
            return [(z, True)]
        hub = hubs[0]
        arms = sorted((at - hub for at in z if abs(at - hub) > 1e-9 * abs(z[0] - z[1])), key=cmath.phase)
        pieces: list[tuple[Sequence[complex], bool]] = [([hub, hub + arm], False) for arm in arms]
        for arm, following in zip(arms, arms[1:] + arms[:1], strict=True):
            if 0.0 < math.degrees(cmath.phase(following / arm)) < 170.0:
                reach = min(WEB * self.mm, 0.4 * abs(arm), 0.4 * abs(following))
                pieces.append(([hub, hub + reach * arm / abs(arm), hub + reach * following / abs(following)], True))
        return pieces

    def _stem(self, stem: Slide, fill: str) -> Iterator[str]:
        direction, mm = stem.outwards * stem.line[0], self.mm
        start, length = self._bush(stem, mm)
        low = stem.low if stem.outwards > 0 else -stem.high
        ends = np.array([0.0 if self._rolls else self._back(stem), start + length + BEYOND * mm - low])
        half = 1j * STEM * mm
        box = [ends[0] + half, ends[1] + half, ends[1] - half, ends[0] - half]
        at = complex(self.scene.bodies[stem.body].z[0])
        yield self._line(at + direction * np.array(box), True, fill, "ink", stroke_width=self._width(OUTLINE))

    @property
    def _rolls(self) -> bool:
        return self.full.face is not None and self.full.face.rolls

    @cached_property
    def _face_circles(self) -> tuple[tuple[complex, float], ...]:
        shapes = face_shapes(self.full, self.scene)
        return () if shapes is None else shapes.circles

    def _face(self) -> Iterator[str]:
        shapes = face_shapes(self.full, self.scene)
        if shapes is None:
            return
        outline = self._width(OUTLINE)
        parts = [self._line(z, closed, "link-0", "ink", stroke_width=outline) for z, closed in shapes.lines]
        for centre, radius in shapes.circles:
            parts.append(self._circle(centre, radius, "roller", "ink", stroke_width=outline))
            reach = min(radius, 1.6 * PIN * self.mm)
            parts += [
                self._line([centre - reach * end, centre + reach * end], False, "none", "ink") for end in (1.0, 1j)
            ]
        yield from svg.group(parts, id="FACE")

    def _pins(self) -> Iterator[str]:
        for at in self._pin_positions():
            yield self._circle(at, PIN * self.mm, "paper", "ink", stroke_width=self._width(OUTLINE))

    def _pin_positions(self) -> list[complex]:
        """Pairs that turn, and other points of links of a linkage."""
        scene, stem = self.scene, self.full.stem
        z = [
            complex(path[0])
            for _, name, paths in drawn_bodies(scene)
            for path in paths
            if stem is None or name != stem.body
        ]
        marked = [circle for circle, _ in self._face_circles] if self._rolls else []
        if self.full.face is not None and self.full.face.attachment:
            marked.append(complex(scene.face_body.z[0]))
        z = [at for at in z if all(abs(at - mark) > 1e-9 * abs(mark) for mark in marked)]
        return _distinct(z)

    # -- texts -----------------------------------------------------------------------------------------

    def _labels(self) -> Iterator[str]:
        """Names of the points of a linkage, each where it covers least."""
        scene = self.scene
        if not scene.study.design.drive.links:
            return
        names: dict[str, complex] = {}
        for number, body in sorted(scene.study.mechanism.bodies.items()):
            for name in scene.study.mechanism.linkage.by_number[number].places:
                names.setdefault(name, complex(scene.bodies[body].track(name)[0]))
        obstacles = self._obstacles()
        low, high = self.view
        for name, at in names.items():
            half = 0.5 * complex(text_width(name), SMALL) * self.mm
            centres = []
            disc = max((r for centre, r in self._face_circles if abs(centre - at) < PIN * self.mm), default=0.0)
            inner = disc if disc < LARGE_DISC * self.mm else 0.0
            for gap, i in product(LABEL_GAPS, range(LABEL_STEPS)):
                direction = cmath.exp(2.0j * math.pi * (i + 2.0) / LABEL_STEPS)  # at the upper right first
                reach = (
                    (gap - 0.5 * SMALL) * self.mm + abs(direction.real) * half.real + abs(direction.imag) * half.imag
                )
                reach += inner
                centres.append(at + direction * reach)
            room = half + CLEAR * self.mm * (1 + 1j)
            costs = [_covered(obstacles, centre, room) + 1e3 * _leaves(centre, half, low, high) for centre in centres]
            best = centres[int(np.argmin(costs))]
            grid = np.linspace(-1.0, 1.0, 7)
            obstacles = np.append(obstacles, [best + x * half.real + 1j * y * half.imag for x in grid for y in grid])
            yield self.text(name, best - 0.36j * SMALL * self.mm, "ink", "middle")

    def _obstacles(self) -> np.ndarray:
        """Points (n,) complex [mm] that labels should not cover."""
        mm = self.mm
        parts = [np.array([*self._pin_positions(), *(centre for centre, _ in self._face_circles)])]
        for _, name, _ in drawn_bodies(self.scene):
            for z, closed in self._pieces(name) if name != FRAME else ():
                parts += [_between(a, b, mm) for a, b in zip(z, [*z[1:], z[0]] if closed else z[1:], strict=False)]
        for at, direction in self._supports:
            parts.append(
                at + direction * mm * np.array([complex(x, y) for x in range(5, 21, 5) for y in range(-15, 16, 5)])
            )
        for slide in self.scene.slides:
            parts.append(slide.z[0] + slide.line[0] * mm * np.append(_BLOCK_CORNERS, 0.5 * _BLOCK_CORNERS))
        for slide in self.full.slides:
            ends = slide.z[0] + slide.line[0] * np.array([slide.low - BLOCK * mm, slide.high + BLOCK * mm])
            side = 0.5j * BLOCK_HEIGHT * mm * slide.line[0]
            parts += [_between(ends[0] + offset, ends[1] + offset, mm) for offset in (side, -side) if slide.on == FRAME]
        turn = np.exp(1j * self.scene.cam_angle[0])
        parts += [profile[:: max(1, profile.size // 200)] * turn for profile in self.full.flanks.values()]
        around = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 60))
        parts += [centre + radius * around * size for centre, radius in self._face_circles for size in (0.5, 0.8, 1.0)]
        return np.concatenate(parts)

    def _scale_bar(self) -> Iterator[str]:
        length, (low, _) = nice_below(SCALE_BAR * self.mm), self.view
        start = low + complex(MARGIN, 11.0) * self.mm
        ticks = 3.0j * self.mm
        yield self._line([start + ticks, start, start + length, start + length + ticks], False, "none", "quiet")
        unit = readable_unit("mm", length)
        label = f"{result_text(length / unit.size)} {unit.symbol}"
        yield self.text(label, start + length + complex(6.0, -3.0) * self.mm, "quiet")


def _arrow_head(tip: complex, along: complex, size: float) -> list[complex]:
    base = tip - along * size
    return [tip, base + 0.27j * along * size, base - 0.27j * along * size]


def _distinct(points: Sequence[complex]) -> list[complex]:
    size = max(map(abs, points), default=0.0)
    result: list[complex] = []
    for point in points:
        if all(abs(point - other) > 1e-9 * size for other in result):
            result.append(point)
    return result


def _between(start: complex, end: complex, mm: float) -> np.ndarray:
    """Points of a line every three pixels of a size."""
    return np.linspace(start, end, max(2, int(abs(end - start) / (3.0 * mm))))


def _covered(points: np.ndarray, centre: complex, half: complex) -> int:
    """Number of points in a box.

    Parameters
    ----------
    points : ndarray (n,) complex [mm]
    centre, half : complex [mm]
        Middle of the box, and half of its width and height.

    Returns
    -------
    int
    """
    inside = (np.abs(points.real - centre.real) <= half.real) & (np.abs(points.imag - centre.imag) <= half.imag)
    return int(np.count_nonzero(inside))


def _leaves(centre: complex, half: complex, low: complex, high: complex) -> bool:
    """Whether a box leaves the view."""
    first, last = centre - half, centre + half
    return first.real < low.real or first.imag < low.imag or last.real > high.real or last.imag > high.imag
