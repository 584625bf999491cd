"""Names of the parts, placed where they cover neither the part they name nor, if it can be helped, anything else.

A label keeps its side of the part over the whole turn, so that it does not jump about in motion; of a link that turns
far it may be the link's own side, which goes round with it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np
from PySide6.QtCore import QRectF

from core.frozen import frozen
from core.mechanism.kinematics import REVOLUTE, SLIDING
from kindyna_gui.pictures.drawing.cam_parts import sense_arc
from kindyna_gui.pictures.drawing.geometry import MM, Body, Geometry
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
SAMPLED = 8  # samples of the turn at which free room is searched
DIRECTIONS = np.exp(2j * np.pi * np.arange(16) / 16)
GAPS = (4.0, 17.0, 34.0)  # from the part to its text, pixels
SIDES, SIDE_GAPS = np.tile(DIRECTIONS, len(GAPS)), np.repeat(GAPS, DIRECTIONS.size)  # where a text may stand
FAR_TURN = 90.0  # [deg] of a link over the turn, from which its own sides are tried too
PAD = 3.0  # a text wants so much free paper around, pixels
COVERS, LEAVES, FURTHER = 6.0, 6.0, 0.5  # costs: covering a label, leaving the picture, each longer gap
FIRST = 0.25  # of all costs: those at the first sample
APART = 9.0  # between two labels, pixels
AROUND = 240  # dots of a curve around the cam
STEM_ROOM = STEM * EYE + BUSH  # half the width of a stem with its bush or its spring, in units


TextBox = tuple[np.ndarray, complex]
"""The middle of a text at the samples at which room is searched (k,) [mm], and half its size in pixels."""


@frozen(eq=False)
class Label:
    """A name for what is at ``track`` (n,) [mm] with nothing to be covered within ``room`` [mm] of it; ``foot``: how
    far from there a line to the text starts, where one must always be drawn [mm]; ``turn``: (n,) unit vector that goes
    round with the part, where it turns far."""

    key: str
    text: str
    track: np.ndarray
    room: float
    layer: str
    foot: float | None = None
    turn: np.ndarray | None = None

    @property
    def gaps(self) -> np.ndarray:
        """Pixels from part to text, by side: those that stand, then those that turn with the part."""
        return SIDE_GAPS if self.turn is None else np.append(SIDE_GAPS, np.full(DIRECTIONS.size, GAPS[0]))

    def outwards(self, seen: np.ndarray) -> np.ndarray:
        """Where each side lies (k, c) at the samples ``seen`` (k,), unit vectors."""
        fixed = np.broadcast_to(SIDES, (seen.size, SIDES.size))
        return fixed if self.turn is None else np.hstack([fixed, self.turn[seen][:, None] * DIRECTIONS])


def _lean(outwards: np.ndarray, half: complex) -> np.ndarray:
    """From a text's edge to its middle, half its size being ``half``: so the text lies outside of a point."""
    x, y = np.clip(1.6 * outwards.real, -1.0, 1.0), np.clip(1.6 * outwards.imag, -1.0, 1.0)
    return np.asarray(half.real * x + 1j * half.imag * y)


def _clear(outwards: np.ndarray, half: complex) -> np.ndarray:
    """The same, so far that the text lies outside of a line across the direction, such as a bar that it goes round with."""
    return np.asarray(outwards * (half.real * np.abs(outwards.real) + half.imag * np.abs(outwards.imag)))


def _off(track: np.ndarray, by: complex) -> Callable[[int], complex]:
    """The place at a sample, so far from a moving one: where the mouse drags something, it is seen at one sample alone."""
    return lambda i: track[i] + by


def _beside(label: Label, side: complex, gap: float, half: complex, scale: float) -> Callable[[int], complex]:
    """The same of a text that goes round with its part, on a side of it."""
    turn = label.turn
    assert turn is not None

    def place(i: int) -> complex:
        around = side * turn[i]
        return complex(label.track[i] + around * label.room + (around * gap + _clear(around, half)) / scale)

    return place


def _turn(geometry: Geometry, *bodies: str) -> np.ndarray | None:
    """The unit vector that goes round with the first of these links of a linkage that turns far (n,)."""
    for name in bodies if geometry.numbered else ():
        body = geometry.bodies[name]
        if np.ptp(body.angle) > FAR_TURN:
            return body.turn
    return None


def names(geometry: Geometry) -> Iterator[Label]:
    """What is named: cam, roller, bodies, pins, instant centre."""
    unit = geometry.unit
    fixed = np.zeros(geometry.samples, dtype=complex)
    if geometry.face_radius:
        yield Label("roller", geometry.study.design.drive.face.noun, geometry.reference, geometry.face_radius, "roller")
    for name, track, radius in geometry.further_rollers:
        yield Label(f"roller.{name}", f"{name} roller", track, radius, "roller")
    slides = {j.pair.body: j for j in geometry.joints if j.pair.kind == SLIDING}
    for body in geometry.moving.values():
        places = list(geometry.nodes(body).values())
        name = body.name.removeprefix("link") if geometry.numbered else body.name.replace("_", " ")
        if body.name in slides:
            yield Label(body.name, name, *_of_slide(geometry, body.name, slides), "linkage")
        elif len(places) > 1:
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
            turn = None if joint.fixed else _turn(geometry, joint.pair.on, joint.pair.body)
            yield Label(f"pin.{joint.name}", joint.name.replace("_", " "), joint.track, room, "linkage", None, turn)
    yield from _free_points(geometry)
    if geometry.profile.size:
        yield Label("cam", "cam", fixed, float(np.abs(geometry.profile).max()), "cam", 0.93 * geometry.bearing_room)
        if np.isfinite(geometry.centre).any():
            yield Label("centre", "Q", geometry.centre, 1.6 * unit, "centre")


def bars(body: Body, geometry: Geometry) -> list[tuple[complex, complex]]:
    """The ends of a body's bars in its frame [mm]: those of a lever go out from its fixed pivot."""
    nodes = geometry.nodes(body)
    pivots = [j.pair.point for j in geometry.joints if j.fixed and j.pair.kind == REVOLUTE and j.pair.body == body.name]
    starts = [nodes[name] for name in pivots if name in nodes][:1] or list(nodes.values())
    return [(start, end) for start in starts for end in nodes.values() if start != end]


def _free_points(geometry: Geometry) -> Iterator[Label]:
    """The points of links that no pair is at, such as coupler points; only a linkage has any."""
    if not geometry.numbered:
        return
    from core.mechanism import ROLLER

    pinned_points = {joint.pair.point for joint in geometry.joints}
    for body in geometry.moving.values():
        for name, place in body.points.items():
            if name not in pinned_points and not (name == ROLLER or name.isdecimal()):
                yield Label(f"point.{body.name}.{name}", name, body.track(place), 1.3 * EYE * geometry.unit, "linkage")


def _of_slide(geometry: Geometry, name: str, slides: dict) -> tuple[np.ndarray, float]:
    joint, unit = slides[name], geometry.unit
    if is_stem(joint, geometry):
        beyond = max(geometry.face_radius, abs(geometry.face_held.real) if not geometry.face_radius else 0.0)
        return joint.track + joint.outwards * joint.line * (beyond + 0.9 * unit), STEM_ROOM * unit
    return joint.track, 0.5 * float(np.hypot(BLOCK_LENGTH, BLOCK_HEIGHT)) * unit


def spread_samples(geometry: Geometry) -> np.ndarray:
    """Samples (k,) that show the drawing as different as it gets: spread half over the turn, half over the paths of
    follower and instant centre."""
    n = geometry.samples
    spread = np.full(n, 1.0 / n)
    for track in (geometry.reference, geometry.centre):
        finite = np.where(np.isfinite(track), track, 0.0)
        distance = np.minimum(np.abs(np.diff(finite, prepend=finite[:1])), 10.0 * geometry.unit)
        spread += distance / (distance.sum() or 1.0)
    marks = np.floor(np.cumsum(spread) / spread.sum() * (SAMPLED - 1e-9))
    return np.flatnonzero(np.diff(marks, prepend=-1.0) > 0.0)


@frozen(eq=False)
class DrawnDots:
    """What is drawn, as dots: places (k, m) [mm], radii (m,) [mm], and how much it matters not to cover them (m,)."""

    place: np.ndarray
    radius: np.ndarray
    weight: np.ndarray


def ink(
    geometry: Geometry,
    seen: np.ndarray,
    strokes: Sequence[tuple[np.ndarray, np.ndarray]],
    curves: Sequence[np.ndarray] = (),
) -> DrawnDots:
    """The drawing as dots at the samples ``seen`` (k,); strokes: from (n,) to (n,) [mm], such as arrows; curves: lines (m,) [mm]
    that stand, such as the paths of points."""
    unit = geometry.unit
    rows: list[tuple[np.ndarray, float, float]] = []

    def dots(one: np.ndarray, other: np.ndarray, radius: float, weight: float) -> None:
        count = int(np.clip(np.abs(other - one).max() / (1.2 * unit), 2, 60))
        part = np.linspace(0.0, 1.0, count)
        rows.append((one[:, None] + (other - one)[:, None] * part, radius, weight))

    for body in geometry.moving.values():
        ends = [body.track(p)[seen] for p in geometry.nodes(body).values()]
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
    for track, radius in [*rounds, *((track, radius) for _, track, radius in geometry.further_rollers)]:
        rows.append((track[seen][:, None] + radius * around, 0.0, 0.8))
        rows.append((track[seen][:, None], unit, 1.5))
    if geometry.face_outline.size and not geometry.face_radius:
        turn = np.exp(1j * np.deg2rad(geometry.face_angle[seen]))
        places = [geometry.reference[seen] + corner * turn for corner in geometry.face_outline]
        for one, other in pairwise(places):
            dots(one, other, 0.0, 1.0)
    if geometry.profile.size:
        thin = slice(None, None, max(1, geometry.samples // AROUND))
        turn = np.exp(1j * np.deg2rad(geometry.turned[seen]))[:, None]
        for loop in (geometry.profile, geometry.pitch, *(flank.profile * MM for flank in geometry.further)):
            rows.append((loop[thin] * turn, 0.0, 0.9))
        for radius in (geometry.base_radius, *(radius for _, radius in geometry.bored)):
            rows.append((np.tile(radius * around, (seen.size, 1)), 0.0, 0.6))
        centre = np.where(np.isfinite(geometry.centre[seen]), geometry.centre[seen], 0.0)
        dots(geometry.reference[seen], centre, 0.0, 0.6)
    if geometry.with_cam:
        rows.append((np.zeros((seen.size, 1), dtype=complex), 2.0 * unit, 1.0))
        radius, begin, span = sense_arc(geometry)
        arc = radius * np.exp(1j * np.deg2rad(begin + span * np.linspace(0.0, 1.0, 16)))
        rows.append((np.tile(arc, (seen.size, 1)), 0.4 * unit, 0.8))
    for joint in geometry.joints:
        track = joint.track[seen]
        if joint.pair.kind == SLIDING:
            line, over = joint.line * np.ones(seen.size), 4.2 * unit
            dots(joint.root + (joint.low - over) * line, joint.root + (joint.high + over) * line, 2.5 * unit, 0.7)
            rows.append((track[:, None], 0.6 * BLOCK_LENGTH * unit, 1.0))
            if is_stem(joint, geometry):
                end = (bush_start(joint, geometry) + bush_length(joint, geometry)) * unit
                dots(track, joint.root + joint.outwards * line * end, STEM_ROOM * unit, 1.0)
        elif joint.fixed:
            down = ground_direction(joint, geometry) * unit
            rows.append((track[:, None] + down * np.array([1.0, 2.2, 3.0]), 1.6 * unit, 1.0))
    rows += [(np.tile(curve, (seen.size, 1)), 0.0, 0.7) for curve in curves]
    for start, end in strokes:
        dots(start[seen], np.where(np.isfinite(end), end, start)[seen], 0.5 * unit, 0.7)
    place = np.concatenate([p for p, _, _ in rows], axis=1)
    sizes = [p.shape[1] for p, _, _ in rows]
    return DrawnDots(place, np.repeat([r for _, r, _ in rows], sizes), np.repeat([w for _, _, w in rows], sizes))


class Labels:
    """The labels of one drawing: tags, and how they are laid for a picture of a given scale."""

    def __init__(self, geometry: Geometry, theme: Theme) -> None:
        self._geometry = geometry
        self._strokes: Sequence[tuple[np.ndarray, np.ndarray]] = ()
        self._curves: Sequence[np.ndarray] = ()
        self._still: int | None = None
        self._rows = [(label, Tag(label.text, theme.ink, theme)) for label in names(geometry)]
        self._moves: dict[str, Move] = {}
        self.sides: dict[str, int] = {}

    def renew(self, geometry: Geometry) -> bool:
        """Name the parts of another drawing with the same texts; False, and nothing done, where it has others."""
        rows = list(names(geometry))
        if [(label.key, label.text) for label in rows] != [(label.key, label.text) for label, _ in self._rows]:
            return False
        self._geometry = geometry
        self._rows = [(label, tag) for label, (_, tag) in zip(rows, self._rows, strict=True)]
        for cached in ("samples", "_ink"):
            self.__dict__.pop(cached, None)
        return True

    @cached_property
    def samples(self) -> np.ndarray:
        """Where room is searched (k,)."""
        return spread_samples(self._geometry) if self._still is None else np.array([self._still])

    @cached_property
    def _ink(self) -> DrawnDots:
        return ink(self._geometry, self.samples, self._strokes, self._curves)

    def parts(self) -> Iterator[DrawnPart]:
        """The texts as parts of the drawing, which move with what they name."""
        for label, tag in self._rows:
            self._moves[label.key] = pinned(tag, label.track)
            yield DrawnPart(f"label.{label.key}", tag, ("labels", label.layer), Z_LABEL, self._mover(label.key))

    def _mover(self, key: str) -> Move:
        return lambda i: self._moves[key](i)

    def avoid(self, strokes: Sequence[tuple[np.ndarray, np.ndarray]], curves: Sequence[np.ndarray] = ()) -> None:
        """Keep clear of these too: from (n,) to (n,) [mm], and lines (m,) [mm] that stand. Takes effect when next arranged."""
        self._strokes, self._curves = strokes, curves
        self.__dict__.pop("_ink", None)

    def stand_still(self, index: int) -> None:
        """Care for this sample alone. Takes effect when next arranged."""
        if index != self._still:
            self._still = index
            for cached in ("samples", "_ink"):
                self.__dict__.pop(cached, None)

    def arrange(self, corners: tuple[complex, complex], scale: float, texts: Sequence[TextBox] = ()) -> None:
        """Lay all labels; corners: lower left and upper right of what is visible [mm], scale in pixels per mm; texts: others, which
        stay where they are."""
        self._choose(corners, scale, texts)
        self.lay(scale)

    def keep(self, sides: Mapping[str, int], scale: float) -> bool:
        """Lay all labels on the sides they had in another drawing of the same parts; False where parts are new, or one
        that turned far no longer does."""
        if any(sides.get(label.key, label.gaps.size) >= label.gaps.size for label, _ in self._rows):
            return False
        self.sides = dict(sides)
        self.lay(scale)
        return True

    def lay(self, scale: float) -> None:
        """Put each label on its side."""
        for label, tag in self._rows:
            side, half = self.sides[label.key], complex(*tag.size) / 2
            gap = float(label.gaps[side])
            if side >= SIDES.size and label.turn is not None:
                tag.shift(0.0, 0.0)
                tag.lead(False)
                self._moves[label.key] = standing_at(
                    tag, _beside(label, DIRECTIONS[side - SIDES.size], gap, half, scale)
                )
                continue
            outwards = complex(SIDES[side])
            start = label.room if label.foot is None else label.foot
            push = outwards * (gap + (label.room - start) * scale) + complex(_lean(SIDES[side], half))
            tag.shift(push.real, -push.imag)
            tag.lead(gap > GAPS[0] or label.foot is not None)
            self._moves[label.key] = standing_at(tag, _off(label.track, outwards * start))

    def boxes(self, scale: float) -> list[QRectF]:
        """The texts that are shown, in pixels of the whole scene, y downwards; scale in pixels per mm."""
        shown = [(tag.pos() * scale, tag.pixel_box()) for _, tag in self._rows if tag.isVisible()]
        return [box.translated(place.x(), -place.y()) for place, box in shown]

    def _choose(self, corners: tuple[complex, complex], scale: float, texts: Sequence[TextBox]) -> None:
        """Find the best side of each part."""
        taken = [(middle, half.real / scale, half.imag / scale) for middle, half in texts]
        for label, tag in self._rows:
            half = complex(*tag.size) / 2
            outwards = label.outwards(self.samples)
            centre = np.where(np.isfinite(label.track), label.track, 0.0)[self.samples][:, None]
            fixed, around = outwards[:, : SIDES.size], outwards[:, SIDES.size :]
            lean = np.hstack([_lean(fixed, half), _clear(around, half)])
            centre = centre + outwards * label.room + (outwards * label.gaps + lean) / scale
            cost = self._covered(centre, half / scale, scale)
            cost += FURTHER * np.searchsorted(GAPS, label.gaps)
            cost += _leaving(centre, half / scale, corners) * LEAVES
            for other, a, b in taken:
                apart = (
                    np.abs((centre - other[:, None]).real) - a - half.real / scale,
                    np.abs((centre - other[:, None]).imag) - b - half.imag / scale,
                )
                cost += COVERS * _over_turn(np.maximum(*apart) < APART / scale)
            best = self.sides[label.key] = int(np.argmin(cost))
            taken.append((centre[:, best], half.real / scale, half.imag / scale))

    def _covered(self, centre: np.ndarray, half: complex, scale: float) -> np.ndarray:
        """How much ink boxes around ``centre`` (k, c) cover, mean over the turn (c,)."""
        ink, pad = self._ink, PAD / scale
        low = complex(centre.real.min(), centre.imag.min()) - half * 1.5 - complex(pad, pad)
        high = complex(centre.real.max(), centre.imag.max()) + half * 1.5 + complex(pad, pad)
        p, r = ink.place, ink.radius
        near = (
            (p.real + r > low.real) & (p.real - r < high.real) & (p.imag + r > low.imag) & (p.imag - r < high.imag)
        ).any(axis=0)
        p, r, weight = p[:, near], r[near], ink.weight[near]
        x = _beyond(centre.real, p.real, half.real)
        y = _beyond(centre.imag, p.imag, half.imag)
        at = np.flatnonzero(np.maximum(x, y) < np.float32(r + pad))  # few are so near
        dot, (k, sides) = at % r.size, centre.shape
        gap = np.hypot(np.maximum(x.ravel()[at], 0.0), np.maximum(y.ravel()[at], 0.0)) - r[dot]
        covered = np.clip(1.0 - gap / pad, 0.0, 1.0) * weight[dot]
        return _over_turn(np.bincount(at // r.size, covered, k * sides).reshape(k, sides))


def _leaving(centre: np.ndarray, half: complex, corners: tuple[complex, complex]) -> np.ndarray:
    low, high = corners
    out = (
        (centre.real - half.real < low.real)
        | (centre.real + half.real > high.real)
        | (centre.imag - half.imag < low.imag)
        | (centre.imag + half.imag > high.imag)
    )
    return _over_turn(out)


def _beyond(centre: np.ndarray, dots: np.ndarray, half: float) -> np.ndarray:
    """How far dots (k, m) lie beyond the edges of boxes around ``centre`` (k, c) along one axis, (k, c, m): the largest arrays of the
    drawing, in half the precision."""
    apart = centre.astype(np.float32)[:, :, None] - dots.astype(np.float32)[:, None, :]
    np.abs(apart, out=apart)
    apart -= np.float32(half)
    return np.asarray(apart)


def _over_turn(cost: np.ndarray) -> np.ndarray:
    """Mean of costs (k, c) over the turn (c,); what is seen first, and longest, counts for a quarter."""
    return np.asarray(cost.mean(axis=0) * (1.0 - FIRST) + cost[0] * FIRST)
