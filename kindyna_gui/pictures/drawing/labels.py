"""Labels of the parts, placed where they cover as little of the drawing as possible.

A label stays on one side of its part over the turn, so that it does not jump during motion. The label of a link that
turns far may stay on a side of the link instead, and turn with it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property, partial
from itertools import pairwise

import numpy as np
from PySide6.QtCore import QRectF

from core.frozen import frozen
from core.mechanism import ROLLER
from core.mechanism.kinematics import REVOLUTE, SLIDING
from kindyna_gui.pictures.drawing.cam_parts import rotation_arc
from kindyna_gui.pictures.drawing.geometry import MM, Body, Geometry, Joint
from kindyna_gui.pictures.drawing.parts import (
    BLOCK_HEIGHT,
    BLOCK_LENGTH,
    BUSH,
    STEM,
    bush_length,
    bush_start,
    drawn_joints,
    ground_direction,
    is_stem,
)
from kindyna_gui.pictures.items import DrawnPart, Move, Tag, pinned, standing_at
from kindyna_gui.pictures.shapes import BAR, EYE
from kindyna_gui.pictures.style import Theme

Z_LABEL = 12.0
MOST_SAMPLES = 8  # samples of the turn at which free space is searched
DIRECTIONS = np.exp(2j * np.pi * np.arange(16) / 16)
GAPS = (4.0, 17.0, 34.0)  # from the part to its text, pixels
SIDES, SIDE_GAPS = np.tile(DIRECTIONS, len(GAPS)), np.repeat(GAPS, DIRECTIONS.size)  # positions of a text
LEAN_X, LEAN_Y = (
    np.clip(1.6 * part, -1.0, 1.0) for part in (SIDES.real, SIDES.imag)
)  # of its centre, by half its size
FAR_TURN = 90.0  # [deg] rotation over the turn above which a label may turn with its link
PAD = 3.0  # free margin around a text, pixels
COVERS, LEAVES, FURTHER = 6.0, 6.0, 0.5  # costs: covering a label, leaving the view, a longer gap
FIRST = 0.25  # weight of the first sample in the costs
LABEL_GAP = 9.0  # between two labels, pixels
AROUND = 240  # dots of a curve around the cam
STEM_ROOM = STEM * EYE + BUSH  # half the width of a stem with its bush or its spring, in units


Strokes = Sequence[tuple[np.ndarray, np.ndarray]]
"""Start (n,) and end (n,) of moving strokes [mm], such as arrows."""
TextBox = tuple[np.ndarray, complex]
"""Centre of a text at the k samples of the search (k,) [mm], and half its size [pixels]."""


@frozen(eq=False)
class Label:
    """Label of a part.

    Attributes
    ----------
    track : path of the labelled point (n,) [mm]
    room : radius around the point that the label must not cover [mm]
    line_start : distance from the point at which a line to the label always starts [mm]; None without such a line
    turn : unit vector that rotates with the part (n,); None where the part does not turn far
    """

    key: str
    text: str
    track: np.ndarray
    room: float
    layer: str
    line_start: float | None = None
    turn: np.ndarray | None = None

    @cached_property
    def gaps(self) -> np.ndarray:
        """Gap from part to text for every side [pixels]: first the fixed sides, then those that turn with the part."""
        return SIDE_GAPS if self.turn is None else np.append(SIDE_GAPS, np.full(DIRECTIONS.size, GAPS[0]))

    def outwards(self, samples: np.ndarray) -> np.ndarray:
        """Directions of the sides at the given samples (k,): unit vectors (k, c)."""
        fixed = np.broadcast_to(SIDES, (samples.size, SIDES.size))
        return fixed if self.turn is None else np.hstack([fixed, self.turn[samples][:, None] * DIRECTIONS])


def _clear(outwards: np.ndarray, half: complex) -> np.ndarray:
    """Offset from a line across the direction, such as a turning bar, to the centre of a text outside the line."""
    return np.asarray(outwards * (half.real * np.abs(outwards.real) + half.imag * np.abs(outwards.imag)))


def _offset_position(track: np.ndarray, offset: complex, i: int) -> complex:
    """Position at a sample of a text next to a path (n,); one sample is enough while a part is dragged."""
    return complex(track[i] + offset)


def _turning_position(label: Label, side: complex, gap: float, half: complex, scale: float) -> Callable[[int], complex]:
    """Position at a sample of a text that turns with its part."""
    turn = label.turn
    assert turn is not None

    def position(i: int) -> complex:
        direction = side * turn[i]
        return complex(label.track[i] + direction * label.room + (direction * gap + _clear(direction, half)) / scale)

    return position


def _turn(geometry: Geometry, *bodies: str) -> np.ndarray | None:
    """Unit vector (n,) that rotates with the first of the links that turns far; None where none does."""
    for name in bodies if geometry.has_numbered_links else ():
        body = geometry.bodies[name]
        if body.swing > FAR_TURN:
            return body.turn
    return None


def labels_of(geometry: Geometry) -> Iterator[Label]:
    """Labels of the cam, rollers, bodies, pins, free points and the instant centre."""
    unit = geometry.unit
    fixed = np.zeros(geometry.samples, dtype=complex)
    if geometry.face_radius:
        yield Label("roller", geometry.study.design.drive.face.noun, geometry.reference, geometry.face_radius, "roller")
    for name, track, radius in geometry.other_rollers:
        yield Label(f"roller.{name}", f"{name} roller", track, radius, "roller")
    if geometry.space is not None:
        machine = geometry.space.machine
        track = geometry.space.roller_track(geometry.study.surface.motion.y) * MM
        yield Label("roller", "roller 1" if machine.rollers > 1 else "roller", track, machine.radius * MM, "roller")
    slides = {j.pair.body: j for j in geometry.joints if j.pair.kind == SLIDING}
    for body in geometry.moving.values():
        points = list(geometry.nodes(body).values())
        name = body.name.removeprefix("link") if geometry.has_numbered_links else body.name.replace("_", " ")
        if body.name in slides:
            yield Label(body.name, name, *_slide_label(geometry, slides[body.name]), "linkage")
        elif len(points) > 1:
            ends = max(bars(body, geometry), key=lambda e: abs(e[0] - e[1]))
            yield Label(
                body.name,
                name,
                body.track(sum(ends) / 2),
                1.5 * BAR * unit,
                "linkage",
                None,
                _turn(geometry, body.name),
            )
    for joint in drawn_joints(geometry):
        if joint.pair.kind == REVOLUTE:
            on_block = joint.pair.body in slides or joint.pair.on in slides
            room = 0.5 * BLOCK_HEIGHT * unit if on_block else 1.3 * EYE * unit
            turn = None if joint.is_fixed else _turn(geometry, joint.pair.on, joint.pair.body)
            yield Label(f"pin.{joint.name}", joint.name.replace("_", " "), joint.track, room, "linkage", None, turn)
    yield from _free_points(geometry)
    if geometry.profile.size:
        yield Label("cam", "cam", fixed, float(np.abs(geometry.profile).max()), "cam", 0.93 * geometry.bearing_room)
        if np.isfinite(geometry.centre).any():
            yield Label("centre", "Q", geometry.centre, 1.6 * unit, "centre")


def bars(body: Body, geometry: Geometry) -> list[tuple[complex, complex]]:
    """Ends of a body's bars in the frame of the body [mm]; the bars of a lever start at its fixed pivot."""
    nodes = geometry.nodes(body)
    pivots = [
        j.pair.point for j in geometry.joints if j.is_fixed and j.pair.kind == REVOLUTE and j.pair.body == body.name
    ]
    starts = [nodes[name] for name in pivots if name in nodes][:1] or list(nodes.values())
    return [(start, end) for start in starts for end in nodes.values() if start != end]


def _free_points(geometry: Geometry) -> Iterator[Label]:
    """Labels of the points of a linkage that are not in a pair, such as coupler points."""
    if not geometry.has_numbered_links:
        return
    pinned_points = {joint.pair.point for joint in geometry.joints}
    for body in geometry.moving.values():
        for name, point in body.points.items():
            if name not in pinned_points and not (name == ROLLER or name.isdecimal()):
                yield Label(f"point.{body.name}.{name}", name, body.track(point), 1.3 * EYE * geometry.unit, "linkage")


def _slide_label(geometry: Geometry, joint: Joint) -> tuple[np.ndarray, float]:
    """Labelled point (n,) [mm] of a sliding body, and the radius that its label must not cover [mm]."""
    unit = geometry.unit
    if is_stem(joint, geometry):
        beyond = max(geometry.face_radius, abs(geometry.face_attachment.real) if not geometry.face_radius else 0.0)
        return joint.track + joint.outward_sign * joint.line * (beyond + 0.9 * unit), STEM_ROOM * unit
    return joint.track, 0.5 * float(np.hypot(BLOCK_LENGTH, BLOCK_HEIGHT)) * unit


def spread_samples(geometry: Geometry) -> np.ndarray:
    """Samples (k,) spread half over the cam angle, half over the paths of follower and instant centre."""
    n = geometry.samples
    spread = np.full(n, 1.0 / n)
    for track in (geometry.reference, geometry.centre):
        finite = np.where(np.isfinite(track), track, 0.0)
        distance = np.minimum(np.abs(np.diff(finite, prepend=finite[:1])), 10.0 * geometry.unit)
        spread += distance / (distance.sum() or 1.0)
    marks = np.floor(np.cumsum(spread) / spread.sum() * (MOST_SAMPLES - 1e-9))
    return np.flatnonzero(np.diff(marks, prepend=-1.0) > 0.0)


@frozen(eq=False)
class DrawnDots:
    """The drawing as dots.

    Attributes
    ----------
    points : positions at k samples (k, m) [mm]
    radius : radii (m,) [mm]
    weight : cost of covering a dot (m,)
    """

    points: np.ndarray
    radius: np.ndarray
    weight: np.ndarray


def drawing_dots(
    geometry: Geometry,
    samples: np.ndarray,
    strokes: Strokes,
    curves: Sequence[np.ndarray] = (),
) -> DrawnDots:
    """The drawing as dots.

    Parameters
    ----------
    geometry : Geometry
    samples : ndarray (k,)
        Indices of the samples.
    strokes : sequence of ndarray (n,), ndarray (n,) [mm]
        Start and end of moving strokes, such as arrows.
    curves : sequence of ndarray (m,) [mm]
        Fixed curves, such as the paths of points.

    Returns
    -------
    DrawnDots
    """
    unit = geometry.unit
    rows: list[tuple[np.ndarray, float, float]] = []

    def dots(start: np.ndarray, end: np.ndarray, radius: float, weight: float) -> None:
        count = int(np.clip(np.abs(end - start).max() / (1.2 * unit), 2, 60))
        part = np.linspace(0.0, 1.0, count)
        rows.append((start[:, None] + (end - start)[:, None] * part, radius, weight))

    for body in geometry.moving.values():
        ends = [body.track(p)[samples] for p in geometry.nodes(body).values()]
        middle = sum(ends) / max(len(ends), 1)
        for i, end in enumerate(ends[1:]):
            dots(ends[i], end, BAR * unit, 1.0)
            if len(ends) > 2:
                dots(ends[0], end, BAR * unit, 1.0)
                dots(middle, end, 2.0 * unit, 1.0)
        if len(ends) > 1:
            rows.append((np.stack(ends, axis=1), EYE * unit, 1.5))
    around = np.exp(2j * np.pi * np.arange(80) / 80)
    rounds = [(geometry.reference, geometry.face_radius)] if geometry.face_radius else []
    for track, radius in [*rounds, *((track, radius) for _, track, radius in geometry.other_rollers)]:
        rows.append((track[samples][:, None] + radius * around, 0.0, 0.8))
        rows.append((track[samples][:, None], unit, 1.5))
    if geometry.face_outline.size and not geometry.face_radius:
        turn = geometry.face_turn[samples]
        corners = [geometry.reference[samples] + corner * turn for corner in geometry.face_outline]
        for start, end in pairwise(corners):
            dots(start, end, 0.0, 1.0)
    if geometry.profile.size:
        thin = slice(None, None, max(1, geometry.samples // AROUND))
        turn = np.exp(1j * np.deg2rad(geometry.cam_rotation[samples]))[:, None]
        for loop in (geometry.profile, geometry.pitch, *(flank.profile * MM for flank in geometry.other_flanks)):
            rows.append((loop[thin] * turn, 0.0, 0.9))
        for radius in (geometry.base_radius, *(radius for _, radius in geometry.known_circles)):
            rows.append((np.tile(radius * around, (samples.size, 1)), 0.0, 0.6))
        centre = np.where(np.isfinite(geometry.centre[samples]), geometry.centre[samples], 0.0)
        dots(geometry.reference[samples], centre, 0.0, 0.6)
    if geometry.has_cam:
        rows.append((np.zeros((samples.size, 1), dtype=complex), 2.0 * unit, 1.0))
        radius, begin, span = rotation_arc(geometry)
        arc = radius * np.exp(1j * np.deg2rad(begin + span * np.linspace(0.0, 1.0, 16)))
        rows.append((np.tile(arc, (samples.size, 1)), 0.4 * unit, 0.8))
    for low, high in geometry.view_boxes:
        for start, end in pairwise((low, complex(high.real, low.imag), high, complex(low.real, high.imag), low)):
            dots(start + 0.0 * samples, end + 0.0 * samples, 0.0, 0.9)
    for joint in geometry.joints:
        track = joint.track[samples]
        if joint.pair.kind == SLIDING:
            line, over = joint.line * np.ones(samples.size), 4.2 * unit
            dots(joint.root + (joint.low - over) * line, joint.root + (joint.high + over) * line, 2.5 * unit, 0.7)
            rows.append((track[:, None], 0.6 * BLOCK_LENGTH * unit, 1.0))
            if is_stem(joint, geometry):
                end = (bush_start(joint, geometry) + bush_length(joint, geometry)) * unit
                dots(track, joint.root + joint.outward_sign * line * end, STEM_ROOM * unit, 1.0)
        elif joint.is_fixed:
            down = ground_direction(joint, geometry) * unit
            rows.append((track[:, None] + down * np.array([1.0, 2.2, 3.0]), 1.6 * unit, 1.0))
    rows += [(np.tile(curve, (samples.size, 1)), 0.0, 0.7) for curve in curves]
    for start, end in strokes:
        dots(start[samples], np.where(np.isfinite(end), end, start)[samples], 0.5 * unit, 0.7)
    points = np.concatenate([p for p, _, _ in rows], axis=1)
    sizes = [p.shape[1] for p, _, _ in rows]
    return DrawnDots(points, np.repeat([r for _, r, _ in rows], sizes), np.repeat([w for _, _, w in rows], sizes))


class Labels:
    """The labels of one drawing, and their layout for a view of a given scale."""

    def __init__(self, geometry: Geometry, theme: Theme) -> None:
        self._geometry = geometry
        self._obstacles: Callable[[], tuple[Strokes, Sequence[np.ndarray]]] = lambda: ((), ())
        self._fixed_sample: int | None = None
        self._rows = [(label, Tag(label.text, theme.ink, theme)) for label in labels_of(geometry)]
        self._moves: dict[str, Move] = {}
        self.sides: dict[str, int] = {}

    def renew(self, geometry: Geometry) -> bool:
        """Move the labels to another drawing; returns False, without a change, where its labels differ."""
        rows = list(labels_of(geometry))
        if [(label.key, label.text) for label in rows] != [(label.key, label.text) for label, _ in self._rows]:
            return False
        self._geometry = geometry
        self._rows = [(label, tag) for label, (_, tag) in zip(rows, self._rows, strict=True)]
        for cached in ("samples", "_dots"):
            self.__dict__.pop(cached, None)
        return True

    @cached_property
    def samples(self) -> np.ndarray:
        """Samples at which free space is searched (k,)."""
        return spread_samples(self._geometry) if self._fixed_sample is None else np.array([self._fixed_sample])

    @cached_property
    def _dots(self) -> DrawnDots:
        return drawing_dots(self._geometry, self.samples, *self._obstacles())

    def parts(self) -> Iterator[DrawnPart]:
        """The labels as parts of the drawing, which move with the labelled parts."""
        for label, tag in self._rows:
            self._moves[label.key] = pinned(tag, label.track)
            yield DrawnPart(f"label.{label.key}", tag, ("labels", label.layer), Z_LABEL, self._mover(label.key))

    def _mover(self, key: str) -> Move:
        return lambda i: self._moves[key](i)

    def avoid(self, obstacles: Callable[[], tuple[Strokes, Sequence[np.ndarray]]]) -> None:
        """Avoid strokes from (n,) to (n,) [mm] and fixed curves (m,) [mm], from the next ``arrange`` on, which reads them."""
        self._obstacles = obstacles
        self.__dict__.pop("_dots", None)

    def use_sample(self, index: int) -> None:
        """Consider only one sample, from the next ``arrange`` on."""
        if index != self._fixed_sample:
            self._fixed_sample = index
            for cached in ("samples", "_dots"):
                self.__dict__.pop(cached, None)

    def arrange(self, corners: tuple[complex, complex], scale: float, texts: Sequence[TextBox] = ()) -> None:
        """Find the best side for all labels and lay them.

        Parameters
        ----------
        corners : tuple of complex [mm]
            Lower left and upper right corner of the view.
        scale : float [pixels per mm]
        texts : sequence of TextBox
            Other texts, which do not move.
        """
        self._choose(corners, scale, texts)
        self.lay(scale)

    def reuse_sides(self, sides: Mapping[str, int], scale: float) -> bool:
        """Lay all labels on the sides of an earlier drawing; returns False where a label is new or has no such side."""
        if any(sides.get(label.key, label.gaps.size) >= label.gaps.size for label, _ in self._rows):
            return False
        self.sides = dict(sides)
        self.lay(scale)
        return True

    def lay(self, scale: float) -> None:
        """Place all labels on their sides."""
        for label, tag in self._rows:
            side, half = self.sides[label.key], complex(*tag.size) / 2
            gap = float(label.gaps[side])
            if side >= SIDES.size and label.turn is not None:
                tag.shift(0.0, 0.0)
                tag.lead(False)
                self._moves[label.key] = standing_at(
                    tag, _turning_position(label, DIRECTIONS[side - SIDES.size], gap, half, scale)
                )
                continue
            outwards = complex(SIDES[side])
            start = label.room if label.line_start is None else label.line_start
            lean = complex(half.real * LEAN_X[side], half.imag * LEAN_Y[side])
            push = outwards * (gap + (label.room - start) * scale) + lean
            tag.shift(push.real, -push.imag)
            tag.lead(gap > GAPS[0] or label.line_start is not None)
            self._moves[label.key] = standing_at(tag, partial(_offset_position, label.track, outwards * start))

    def boxes(self, scale: float) -> list[QRectF]:
        """Boxes of the visible labels in pixels of the scene, y downwards; scale in pixels per mm."""
        shown = [(tag.pos() * scale, tag.pixel_box()) for _, tag in self._rows if tag.isVisible()]
        return [box.translated(position.x(), -position.y()) for position, box in shown]

    def _choose(self, corners: tuple[complex, complex], scale: float, texts: Sequence[TextBox]) -> None:
        """Find the best side for each label."""
        taken = [(middle, half.real / scale, half.imag / scale) for middle, half in texts]
        for label, tag in self._rows:
            half = complex(*tag.size) / 2
            outwards = label.outwards(self.samples)
            centre = np.where(np.isfinite(label.track), label.track, 0.0)[self.samples][:, None]
            fixed = np.broadcast_to(half.real * LEAN_X + 1j * half.imag * LEAN_Y, (self.samples.size, SIDES.size))
            lean = np.hstack([fixed, _clear(outwards[:, SIDES.size :], half)])
            centre = centre + outwards * label.room + (outwards * label.gaps + lean) / scale
            cost = self._covered(centre, half / scale, scale)
            cost += FURTHER * np.searchsorted(GAPS, label.gaps)
            cost += _leaving(centre, half / scale, corners) * LEAVES
            for middle, half_width, half_height in taken:
                gaps = (
                    np.abs((centre - middle[:, None]).real) - half_width - half.real / scale,
                    np.abs((centre - middle[:, None]).imag) - half_height - half.imag / scale,
                )
                cost += COVERS * _over_turn(np.maximum(*gaps) < LABEL_GAP / scale)
            best = self.sides[label.key] = int(np.argmin(cost))
            taken.append((centre[:, best], half.real / scale, half.imag / scale))

    def _covered(self, centre: np.ndarray, half: complex, scale: float) -> np.ndarray:
        """Weight of the dots that boxes around ``centre`` (k, c) cover, averaged over the turn (c,)."""
        dots, pad = self._dots, PAD / scale
        low = complex(centre.real.min(), centre.imag.min()) - half * 1.5 - complex(pad, pad)
        high = complex(centre.real.max(), centre.imag.max()) + half * 1.5 + complex(pad, pad)
        p, r = dots.points, dots.radius
        near = (
            (p.real + r > low.real) & (p.real - r < high.real) & (p.imag + r > low.imag) & (p.imag - r < high.imag)
        ).any(axis=0)
        p, r, weight = p[:, near], r[near], dots.weight[near]
        x = _beyond(centre.real, p.real, half.real)
        y = _beyond(centre.imag, p.imag, half.imag)
        at = np.flatnonzero(np.maximum(x, y) < np.float32(r + pad))  # only a few dots are this near
        dot, (k, sides) = at % r.size, centre.shape
        gap = np.hypot(np.maximum(x.ravel()[at], 0.0), np.maximum(y.ravel()[at], 0.0)) - r[dot]
        covered = np.clip(1.0 - gap / pad, 0.0, 1.0) * weight[dot]
        return _over_turn(np.bincount(at // r.size, covered, k * sides).reshape(k, sides))


def _leaving(centre: np.ndarray, half: complex, corners: tuple[complex, complex]) -> np.ndarray:
    """Fraction of the turn in which boxes around ``centre`` (k, c) leave the view (c,)."""
    low, high = corners
    out = (
        (centre.real - half.real < low.real)
        | (centre.real + half.real > high.real)
        | (centre.imag - half.imag < low.imag)
        | (centre.imag + half.imag > high.imag)
    )
    return _over_turn(out)


def _beyond(centre: np.ndarray, dots: np.ndarray, half: float) -> np.ndarray:
    """Distances (k, c, m) of dots (k, m) from the edges of boxes around ``centre`` (k, c) along one axis.

    These are the largest arrays of the drawing, so they have single precision.
    """
    distance = centre.astype(np.float32)[:, :, None] - dots.astype(np.float32)[:, None, :]
    np.abs(distance, out=distance)
    distance -= np.float32(half)
    return np.asarray(distance)


def _over_turn(cost: np.ndarray) -> np.ndarray:
    """Mean of costs (k, c) over the turn (c,); the first sample, which is visible longest, counts for a quarter."""
    return np.asarray(cost.mean(axis=0) * (1.0 - FIRST) + cost[0] * FIRST)
