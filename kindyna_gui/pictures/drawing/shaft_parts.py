"""A flexible shaft (Kim1990 Fig. 1): the pulley that drives it, its spring, and how far the cam stays behind, drawn larger.

The cam stands where the drawing has it; the pulley is ahead of it by the wind-up of the steady response, times a round number
that is stated beside it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtGui import QPainterPath

from core.errors import NoSolution, ResultPending
from kindyna_gui.pictures.drawing.cam_parts import edge_radius
from kindyna_gui.pictures.drawing.geometry import Geometry
from kindyna_gui.pictures.drawing.layers import TWIST
from kindyna_gui.pictures.items import DrawnPart, Outline, Tag, pinned, turning
from kindyna_gui.pictures.shapes import circle, joined, polyline, segments
from kindyna_gui.pictures.style import DASHED, OUTLINE, TEXT, THIN, VERMILION, Theme, brush
from kindyna_gui.pictures.units import digits, nice_below

if TYPE_CHECKING:
    from core.stability import SteadyTurn

SEEN = 30.0  # [deg] the largest twist is drawn at most so large, unless it is larger
COILS, POINTS = 3, 240  # turns of the spring at rest, and points of its line
INNER, OUTER = 0.3, 0.66  # its ends, in parts of the room about the cam's centre
BEYOND, RIM = 1.06, 0.95  # of the pulley's rim: beyond the cam's edge; its inner edge in parts of the outer
Z_PULLEY, Z_SPRING, Z_TWIST = 0.5, 3.2, 8.5


def shaft(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Pulley, spring and twist; a sentence in their place where there is no steady response."""
    turn, why = _steady(geometry)
    rim = _rim(geometry)
    below = float(geometry.reference.imag.mean()) >= 0.0  # away from the follower
    said = Tag("", theme.letters(VERMILION), theme, TEXT, lean=(0.5, 0.0 if below else 1.0), backing=True)
    said.setPos(0.0, -BEYOND * rim if below else BEYOND * rim)
    if turn is None:
        said.set_text(why)
        yield DrawnPart("twist.text", said, (TWIST,), Z_TWIST)
        return
    twist = np.rad2deg(turn.wind_up_at_cam(geometry.study.theta))
    times = magnification(twist)
    drawn = geometry.sense * times * twist
    ahead = geometry.turned + drawn
    room = geometry.bearing_room
    pulley = Outline(joined(circle(rim), circle(RIM * rim)), theme.pen(theme.quiet, OUTLINE))
    yield DrawnPart("twist.pulley", pulley, (TWIST,), Z_PULLEY)
    spoke = Outline(segments([(OUTER * room + 0j, rim + 0j)]), theme.pen(theme.seen(VERMILION), OUTLINE))
    yield DrawnPart("twist.input", spoke, (TWIST,), Z_SPRING, turning(spoke, ahead))
    behind = Outline(
        segments([(edge_radius(geometry.profile) + 0j, rim + 0j)]), theme.pen(theme.cam_line, THIN, DASHED)
    )
    fixed = Outline(
        circle(0.4 * geometry.unit, INNER * room + 0j),
        theme.pen(theme.seen(VERMILION), THIN),
        brush(theme.seen(VERMILION)),
    )
    yield DrawnPart("twist.fixed", fixed, (TWIST,), Z_SPRING, turning(fixed, geometry.turned))
    yield DrawnPart("twist.cam", behind, (TWIST,), Z_SPRING, turning(behind, geometry.turned))
    spring, arc = (Outline(QPainterPath(), theme.pen(theme.seen(VERMILION), width)) for width in (THIN, 3.0))

    def move(i: int) -> None:
        """In the cam's frame: the spring's inner end stays on the cam, its outer end and the arc's go with the pulley."""
        spring.redraw(_spiral(INNER * room, OUTER * room, geometry.sense * 360.0 * COILS + drawn[i]))
        arc.redraw(_spiral(RIM * rim, RIM * rim, drawn[i]))
        for item in (spring, arc):
            item.setRotation(float(geometry.turned[i]))
        said.set_text(f"Twist {digits(twist[i], 3)}\N{DEGREE SIGN}, drawn {times:g} \N{MULTIPLICATION SIGN} as large")

    yield DrawnPart("twist.spring", spring, (TWIST,), Z_SPRING, move)
    yield DrawnPart("twist.arc", arc, (TWIST,), Z_TWIST)
    yield DrawnPart("twist.text", said, (TWIST,), Z_TWIST)
    name = Tag("input", theme.letters(VERMILION), theme, backing=True)
    yield DrawnPart(
        "twist.name", name, (TWIST, "labels"), Z_TWIST, pinned(name, BEYOND * rim * np.exp(1j * np.deg2rad(ahead)))
    )


def magnification(twist: np.ndarray) -> float:
    """A round number that makes the largest twist (n,) [deg] well visible; 1 where it is that already."""
    largest = float(np.abs(twist).max(initial=0.0))
    return max(1.0, nice_below(SEEN / largest)) if largest > 0.0 else 1.0


def _steady(geometry: Geometry) -> tuple[SteadyTurn | None, str]:
    """The steady response, or why there is none to be drawn."""
    if geometry.profile.size:
        try:
            return geometry.study.steady_turn, ""
        except ResultPending as error:
            return None, f"{error.problem[:1].upper()}{error.problem[1:]}"
        except NoSolution:
            pass
    return None, "The flexible shaft has no steady response to be drawn"


def _rim(geometry: Geometry) -> float:
    """Beyond the cam, and where its roller runs [mm]."""
    curves = [each for each in (geometry.profile, geometry.pitch) if each.size]
    far = max((float(np.abs(each).max()) for each in curves), default=geometry.base_radius)
    return BEYOND * far


def _spiral(inner: float, outer: float, span: float) -> QPainterPath:
    """From a radius at angle 0 to another at the angle ``span`` [deg], about the origin."""
    part = np.linspace(0.0, 1.0, POINTS)
    return polyline((inner + (outer - inner) * part) * np.exp(1j * np.deg2rad(span) * part))


__all__ = ["magnification", "shaft"]
