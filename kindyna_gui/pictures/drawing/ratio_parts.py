"""Velocity ratios on the drawing: the two distances on the line of three centres, as dimensions, and the ratio in figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainterPath

from core.instant_centres import CentreTable, RatioArms, ratio_arms
from core.mechanism import body_name, link_number
from kindyna_gui.pictures.drawing.centre_parts import Group, Key, centre_name
from kindyna_gui.pictures.drawing.free_space import TakenSpace
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.drawing.overlay import MARGIN
from kindyna_gui.pictures.items import Outline, Tag
from kindyna_gui.pictures.style import BLUE, OUTLINE, PURPLE, SMALL, VERMILION, Theme, brush
from kindyna_gui.pictures.units import digits
from kindyna_gui.pictures.viewport import Viewport
from kindyna_gui.preferences.units import sized

Z_RATIOS = 9.0
COLOURS = (BLUE, VERMILION, PURPLE, "#8C6D1F", "#00796B")  # of one ratio after the other
OFF, STEP = 15.0, 9.0  # from the line of the centres to the first dimension, and from one to the next, pixels
HEAD, TICK = 6.0, 4.0  # of a dimension line: its heads, and how far its ends reach beyond it, pixels
LINE, UNDER_ANGLE = 17.0, 28.0  # of the list: its lines, its place under the angle, pixels
FIGURES = 4
ALONG, GAPS = (0.5, 0.3, 0.7, 0.1, 0.9), (2.0, 10.0, 22.0, 38.0)  # where a length may stand
Pairs = Callable[[CentreTable, str], Sequence[tuple[str, str]]]


def ratio_text(arms: RatioArms, i: int, base_speed: float, body_speed: float) -> str:
    """One ratio in figures at a sample; speeds [rad/s] of both links. Of a body that does not turn, its velocity."""
    body, base = link_number(arms.body), link_number(arms.base)
    names = tuple(f"I{centre_name(key)}" for key in (arms.other, arms.own, arms.common))
    above, below = float(arms.base_arm[i]) * MM, float(arms.body_arm[i]) * MM
    ratio, far = float(arms.ratio[i]), (math.isinf(above), math.isinf(below))
    if far == (False, True):
        formula = f"ω{base} · {names[0]}{names[2]} = {_figure(base_speed)} rad/s × {_figure(above)} mm"
        return f"v{body} = {formula} = {_figure(abs(base_speed) * above)} mm/s"
    if far == (True, False):
        formula = f"v{base} / {names[1]}{names[2]} = {_figure(abs(body_speed * below))} mm/s / {_figure(abs(below))} mm"
        return f"ω{body} = {formula} = {_figure(body_speed)} rad/s"
    if math.isnan(ratio):
        return f"ω{body}/ω{base}: the centres coincide"
    if far == (True, True):
        return f"ω{body}/ω{base} = {_figure(ratio)}, {names[2]} at infinity"
    by = f"{names[0]}{names[2]} / {names[1]}{names[2]} = {_figure(above)} / {_figure(below)} mm"
    return f"ω{body}/ω{base} = {by} = {_figure(ratio)}"


def _figure(value: float) -> str:
    return digits(float(f"{value:.9g}") if abs(value) > 1e-9 else 0.0, FIGURES)


class _Dimension:
    """The distance between two centres beside their line, with its length in the middle."""

    def __init__(self, start: Key, end: Key, colour: str, theme: Theme) -> None:
        self.start, self.end = start, end
        self.line = Outline(QPainterPath(), theme.pen(colour, OUTLINE), brush(colour))
        self.tag = Tag("", theme.letters(colour), theme, SMALL, (0.5, 0.5), backing=True)
        self.name = f"I{centre_name(start)}I{centre_name(end)}"

    def show(self, on: bool) -> None:
        self.line.setVisible(on)
        self.tag.setVisible(on)

    def lay(
        self, start: complex, end: complex, off: complex, length: float, viewport: Viewport, room: TakenSpace
    ) -> None:
        """start, end: the centres [mm]; off: how far beside them [mm]; length: the number shown, with its sign [mm]."""
        pixel = 1.0 / viewport.scale
        part = _seen(start + off, end + off, viewport)
        self.show(part is not None and abs(end - start) > 2.0 * HEAD * pixel)
        if part is None or not self.line.isVisible():
            return
        along = (end - start) / abs(end - start)
        path = QPainterPath()
        one, other = (start + off + t * (end - start) for t in part)
        _stroke(path, one, other)
        for foot, whole, direction in ((start, part[0] <= 0.0, along), (end, part[1] >= 1.0, -along)):
            if whole:
                _stroke(path, foot, foot + off * (1.0 + TICK * pixel / abs(off)))
                tip = foot + off
                for side in (0.35j, -0.35j):
                    _stroke(path, tip, tip + HEAD * pixel * direction * (1.0 + side))
        self.line.redraw(path)
        self.tag.set_text(f"{self.name} {_figure(length)} mm")
        room.settle(self.tag, [one + t * (other - one) for t in ALONG], GAPS)


def _stroke(path: QPainterPath, start: complex, end: complex) -> None:
    path.moveTo(start.real, start.imag)
    path.lineTo(end.real, end.imag)


def _seen(start: complex, end: complex, viewport: Viewport) -> tuple[float, float] | None:
    """The visible part of a stretch, from 0 at its start to 1 at its end; None where nothing of it is."""
    direction = end - start
    if direction == 0.0:
        return None
    normal = 1j * direction
    ends = viewport.across(np.array([normal.real, normal.imag, -(normal.conjugate() * start).real]))
    if ends is None:
        return None
    low, high = sorted(((e - start) * direction.conjugate()).real / abs(direction) ** 2 for e in ends)
    low, high = max(low, 0.0), min(high, 1.0)
    return (low, high) if low < high else None


class RatioDimensions:
    """Every ratio of a chain at one sample after the other: two dimensions each, and a line of the list under the angle."""

    def __init__(
        self, geometry: Geometry, pairs: Pairs, theme: Theme, viewport: Viewport, room: Callable[[], TakenSpace]
    ) -> None:
        self._geometry, self._viewport, self._room = geometry, viewport, room
        self._table = geometry.study.centres
        driver = body_name(geometry.study.design.drive.linkage.driver.link)
        self.rows: list[tuple[RatioArms, tuple[_Dimension, _Dimension], Tag]] = []
        for number, (body, base) in enumerate(pairs(self._table, driver)):
            colour = theme.seen(COLOURS[number % len(COLOURS)])
            arms = ratio_arms(self._table, body, base)
            lines = _Dimension(arms.other, arms.common, colour, theme), _Dimension(arms.own, arms.common, colour, theme)
            self.rows.append((arms, lines, Tag("", theme.letters(colour), theme, SMALL, (0.0, 0.0), backing=True)))
        items = [item for _, lines, tag in self.rows for d in lines for item in (d.line, d.tag)]
        self.item = Group([*items, *(tag for _, _, tag in self.rows)])

    @property
    def texts(self) -> list[str]:
        """The list as it stands."""
        return [tag.text for _, _, tag in self.rows]

    def move(self, i: int) -> None:
        for number, (arms, (base, body), _) in enumerate(self.rows):
            places = [self._at(key, i) for key in (arms.other, arms.own, arms.common)]
            spans = ((base, places[0], 1.0, arms.base_arm[i]), (body, places[1], -1.0, arms.body_arm[i]))
            for line, place, side, length in spans:
                end = places[2]
                line.show(False)
                if place is None or end is None or place == end or not math.isfinite(length):
                    continue
                across = 1j * self._along(places) * side * (OFF + STEP * number) / self._viewport.scale
                line.lay(place, end, across, float(length) * MM, self._viewport, self._room())

    def _at(self, key: Key, i: int) -> complex | None:
        """Where a centre is [mm]; None at infinity."""
        centre = self._table.centres[key]
        point, weight = complex(centre.point[i]), float(centre.weight[i])
        return None if bool(self._far(key)[i]) else point / weight * MM

    def _far(self, key: Key) -> np.ndarray:
        kept = self.__dict__.setdefault("_kept", {})
        if key not in kept:
            kept[key] = self._table.centres[key].far(self._table.size)
        far: np.ndarray = kept[key]
        return far

    @staticmethod
    def _along(places: Sequence[complex | None]) -> complex:
        """The direction of the line of the centres, the same for both senses along it."""
        finite = [p for p in places if p is not None]
        direction = max((b - a for a in finite for b in finite), key=abs)
        direction = direction / abs(direction)
        return direction if direction.real > 0.0 or (direction.real == 0.0 and direction.imag > 0.0) else -direction

    # -- the list ---------------------------------------------------------------------------------------------

    @property
    def height(self) -> float:
        """Of the list [pixels]."""
        return LINE * len(self.rows)

    def list(self, i: int, room: TakenSpace, down: float) -> None:
        """All ratios in figures, one below the other under the angle; down: so many pixels further."""
        omega, bodies = self._geometry.study.omega, self._geometry.kinematics.bodies
        seen, scale = self._viewport.visible, self._viewport.scale
        x, y = seen.left() * scale + MARGIN, -seen.bottom() * scale + sized(UNDER_ANGLE) + down
        for number, (arms, _, tag) in enumerate(self.rows):
            tag.set_text(
                ratio_text(arms, i, *(float(bodies[name].turn[1][i]) * omega for name in (arms.base, arms.body)))
            )
            tag.setPos(QPointF(x / scale, -(y + LINE * number) / scale))
            room.take(QRectF(x, y + LINE * number, tag.size[0], LINE))
