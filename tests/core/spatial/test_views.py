"""Side view and end view of a cam in space: closed forms, and the projection of the facets of its body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sampled import spread

from core.spatial import Machine, MotionRows
from core.spatial.picture import Blank, cam_facets
from core.spatial.views import CamViews, cam_views

GROOVE = Machine("barrel", "mm", 0.008, 0.0, 0.04, 0.052, 1, 0.0, 0.0002, 0.0, 0.08, False)
RIB = replace(GROOVE, distance=0.03, play=0.0, is_rib=True)
ARM = replace(GROOVE, unit="deg", lever=0.06, play=0.0)
TURRET = Machine("globoidal", "deg", 0.016, 0.0, 0.048, 0.064, 6, 0.12, 0.0, 0.0, 0.1, True)
BLANK = Blank(0.05, 0.015, 0.0)


def still(theta: np.ndarray) -> MotionRows:
    return MotionRows(theta, 0.0 * theta, 0.0 * theta, 0.0 * theta)


def swings(size: float):
    return lambda theta: MotionRows(theta, size * np.sin(theta), size * np.cos(theta), -size * np.sin(theta))


def indexes(theta: np.ndarray) -> MotionRows:
    """A cycloidal index by one pitch over the turn, from half a pitch."""
    pitch, turn = np.pi / 3.0, 2.0 * np.pi
    return MotionRows(
        theta,
        0.5 * pitch + pitch * (theta / turn - np.sin(theta) / turn),
        pitch / turn * (1.0 - np.cos(theta)),
        pitch / turn * np.sin(theta),
    )


def inside(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Whether points (k,) are in a polygon (n,), by the number of its sides above each."""
    start, end = corners[:, None], np.roll(corners, -1)[:, None]
    crosses = (start.real > points.real) != (end.real > points.real)
    with np.errstate(divide="ignore", invalid="ignore"):
        height = start.imag + (points.real - start.real) * (end.imag - start.imag) / (end.real - start.real)
    return (crosses & (height > points.imag)).sum(axis=0) % 2 == 1


def covered(views: CamViews, angle: float, points: np.ndarray) -> np.ndarray:
    areas = [views.outline(angle), *(area for _, edge in views.edges_at(angle) for area in views.down_to_axis(edge))]
    return np.any([inside(area, points) for area in areas], axis=0)


def test_the_outline_of_a_dwell_has_the_groove_on_both_sides() -> None:
    views = cam_views(GROOVE, still, 1.0, BLANK)
    outline = views.outline(0.7) - views.origin
    area = 0.5 * abs(np.sum(outline.real * np.roll(outline.imag, -1) - outline.imag * np.roll(outline.real, -1)))
    assert area == pytest.approx(0.08 * 0.1 - 2.0 * 0.0162 * 0.01, rel=1e-9)
    assert views.guide == pytest.approx(0.05 + 0.3 * 0.05)


def test_a_roller_fits_its_groove_in_the_section() -> None:
    """Of a dwell the groove is at the roller's radius on the flank ahead, and at that and the play on the flank behind."""
    views = cam_views(GROOVE, still, 1.0, BLANK)
    (roller,) = views.rollers(0.0)
    assert (roller.side.real.min(), roller.side.real.max()) == pytest.approx((-0.008, 0.008), abs=1e-9)
    heights = views.section(0.3)
    floor = heights[np.isclose(heights.imag, 0.04) & (np.abs(heights.real) < 0.02)]
    assert (floor.real.min(), floor.real.max()) == pytest.approx((-0.0082, 0.008), abs=1e-9)
    assert (roller.side - views.origin).imag.min() == pytest.approx(0.04)
    assert (roller.end - views.end_origin).imag.max() == pytest.approx(0.05)


BODIES = [
    (GROOVE, swings(0.012), 0.001, 1.0), (ARM, swings(0.2), 0.001, 1.0), (GROOVE, swings(0.012), 0.001, -1.0),
    (RIB, swings(0.006), 0.001, -1.0), (ARM, swings(0.2), 0.001, -1.0), (TURRET, indexes, 0.003, 1.0),
    (RIB, swings(0.006), 0.001, 1.0), (TURRET, indexes, 0.003, -1.0),
]  # fmt: skip


@pytest.mark.parametrize(("machine", "state", "margin", "sense"), spread(BODIES, 3))
def test_the_side_view_is_the_projection_of_the_body(machine: Machine, state, margin: float, sense: float) -> None:
    """Random points are in the drawing where they are in a projected facet, but for points near an outline.

    The facets of a globoidal blank are chords of its arcs, and coarse at its ends.
    """
    views = cam_views(machine, state, sense, BLANK)
    facets = cam_facets(machine, state, sense, BLANK, 360)
    points = views.origin + np.random.default_rng(4).uniform(-1.0, 1.0, (2, 300)).T @ np.array([0.1, 0.034j])
    if machine.slides:
        points = views.origin + 1j * (points - views.origin)
    for angle in (0.4, 2.9):
        flat = views.origin + facets.moved(angle).corners @ views.axes.side
        in_body = np.any([inside(corners, points) for corners in flat], axis=0)
        drawn = covered(views, angle, points)
        near = [points + margin * np.exp(2j * np.pi * k / 8) for k in range(8)]
        sure = np.all([covered(views, angle, row) == drawn for row in near], axis=0)
        assert sure.mean() > 0.75
        assert (drawn == in_body)[sure].all()


@pytest.mark.parametrize(("machine", "state", "sense"), [(TURRET, indexes, 1.0), (ARM, swings(0.2), -1.0)])
def test_material_under_edges_is_drawn_by_areas_of_one_orientation(machine: Machine, state, sense: float) -> None:
    """A painter that fills by winding number fills all of them: none runs clockwise or crosses itself."""
    views = cam_views(machine, state, sense, BLANK)
    for angle in (0.4, 2.0, 4.5):
        areas = [area for _, edge in views.edges_at(angle) for area in views.down_to_axis(edge)]
        assert len(areas) > 3
        for area in areas:
            side = (area - views.origin) * np.conj(complex(views.axes.side[2]))
            assert (side.imag >= 0.0).all() or (side.imag <= 0.0).all()
            assert (np.roll(area, -1) * np.conj(area)).imag.sum() >= 0.0


def test_rollers_are_where_their_motion_puts_them() -> None:
    arm = cam_views(ARM, still, 1.0, BLANK)
    assert arm.roller_track(np.array([0.3]))[0] == pytest.approx(0.06 * np.exp(0.3j))  # about the pivot at the origin
    (roller,) = arm.rollers(0.3)
    assert np.abs(roller.side - 0.06 * np.exp(0.3j)) == pytest.approx(0.008)
    turret = cam_views(TURRET, indexes, 1.0, BLANK)
    assert turret.roller_track(np.array([0.3]))[0] == pytest.approx(0.056 * np.exp(0.3j))
    rollers = list(turret.rollers(np.pi / 6.0))
    assert [roller.number for roller in rollers if roller.in_blank] == [1, 6]
    assert max(np.abs(roller.side).max() for roller in rollers) == pytest.approx(turret.turret_reach)


def test_the_views_are_aligned_and_do_not_overlap() -> None:
    for machine, state, is_above in ((GROOVE, still, False), (ARM, swings(0.2), True), (TURRET, indexes, True)):
        side, end = cam_views(machine, state, 1.0, BLANK).boxes
        middle = [0.5 * (low + high) for low, high in (side, end)]
        if is_above:
            assert middle[0].real == pytest.approx(middle[1].real)
            assert end[0].imag > side[1].imag
        else:
            assert middle[0].imag == pytest.approx(middle[1].imag)
            assert end[0].real > side[1].real


def test_a_groove_that_leaves_its_blank_is_drawn_as_far_as_the_blank() -> None:
    short = cam_views(replace(GROOVE, length=0.03), swings(0.012), 1.0, BLANK)
    assert short.ends == pytest.approx((-0.015, 0.015))
    outline = short.outline(0.7) - short.origin
    assert (outline.real.min(), outline.real.max()) == pytest.approx((-0.015, 0.015))
    assert all(np.abs((line - short.origin).real).max() <= 0.015 for _, line in short.edges_at(0.7))


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_the_groove_is_at_the_roller_where_the_motion_is_at_its_peak(sense: float) -> None:
    """At the cam angle 90° of a swing y sin θ the slide stands still: the groove reaches from y - r - play to y + r."""
    views = cam_views(GROOVE, swings(0.012), sense, BLANK)
    outline = views.outline(sense * np.pi / 2.0) - views.origin
    outline = outline[np.abs(outline.real) < 0.039]
    above = outline[np.isclose(outline.imag, 0.04, atol=1e-5)]
    assert (above.real.min(), above.real.max()) == pytest.approx((0.012 - 0.0082, 0.012 + 0.008), abs=2e-5)
    below = outline[np.isclose(outline.imag, -0.04, atol=1e-5)]
    assert (below.real.min(), below.real.max()) == pytest.approx((-0.012 - 0.0082, -0.012 + 0.008), abs=2e-5)
