"""Distance of outlines of lines and arcs at any pose, by brute force over points of both."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from core.clearance import Placement, ShapePair, distances, nearest_points
from core.clearance.shapes import closed_curve, encloses_points, polygon
from core.contour.elements import arc, arc_of_bulge

LAYER = (-1.0, 1.0)
COUNT = 400  # points of an element


def random_curve(rng: np.random.Generator, corners: int) -> list:
    """Closed chain of lines and arcs around the origin [mm], convex and hollow ones."""
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, corners))
    z = rng.uniform(20.0, 60.0, corners) * np.exp(1j * angles)
    bulges = rng.choice([0.0, 0.25, -0.25, 0.1], corners)
    return [arc_of_bulge(*row) for row in zip(z.tolist(), np.roll(z, -1).tolist(), bulges.tolist(), strict=True)]


def points(curve: list) -> np.ndarray:
    return np.concatenate([element.at(np.linspace(0.0, 1.0, COUNT)) for element in curve]) * 1e-3


@settings(max_examples=15)
@given(st.integers(0, 10_000))
def test_the_distance_is_that_of_the_nearest_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    curves = random_curve(rng, 6), random_curve(rng, 5)
    pair = ShapePair.of(*(closed_curve(curve, 0.0, LAYER) for curve in curves))
    origin = rng.uniform(0.02, 0.16, 4) * np.exp(1j * rng.uniform(0.0, 6.3, 4))
    placement = Placement(origin, np.exp(1j * rng.uniform(0.0, 6.3, 4)))
    values = distances(pair, placement).value
    first, second = map(points, curves)
    tree = cKDTree(np.c_[first.real, first.imag])
    for i, value in enumerate(values.tolist()):
        z = placement.origin[i] + placement.unit[i] * second
        nearest = float(tree.query(np.c_[z.real, z.imag])[0].min())
        one = placement.part(slice(i, i + 1))
        if value > 0.0:
            assert value - 1e-12 <= nearest <= np.hypot(value, 4e-4)
            _, p, q = nearest_points(pair, one)
            assert abs(p[0] - q[0]) == pytest.approx(value, abs=1e-12)
        else:  # they cross, or one is inside the other
            back = ((first[:1] - placement.origin[i]) * placement.unit[i].conj()).ravel()
            inside = encloses_points(pair.first, 0, z[:1])[0] or encloses_points(pair.second, 0, back)[0]
            assert inside or nearest < 4e-4


def test_a_circle_against_a_bar_by_hand() -> None:
    """A circle of 8 mm, 30 mm above the middle of a bar with round ends of 5 mm; then beyond its end; then on its axis."""
    bar, circle = polygon(np.array([-0.04, 0.04 + 0j]), 0.005, LAYER), polygon(np.zeros(1, dtype=complex), 0.008, LAYER)
    pair = ShapePair.of(bar, circle)
    at = np.array([0.03j, 0.07 + 0.04j, 0.06 + 0j, 0.001j])
    values = distances(pair, Placement(at, np.ones(4, dtype=complex))).value
    assert values * 1e3 == pytest.approx([17.0, 50.0 - 13.0, 20.0 - 13.0, 1.0 - 13.0])
    _, p, q = nearest_points(pair, Placement(at, np.ones(4, dtype=complex)))
    assert (p[0], q[0]) == pytest.approx((0.005j, 0.022j))
    assert np.abs(p - q)[:3] * 1e3 == pytest.approx([17.0, 37.0, 7.0])


def test_a_shape_inside_another_one_meets_it_and_layers_that_touch_do_not() -> None:
    ring = closed_curve([arc(0j, 50.0, 0.0, np.pi), arc(0j, 50.0, np.pi, np.pi)], 0.0, (0.0, 0.01))
    small = polygon(np.array([0.0, 0.01, 0.01j]), 0.0, (0.0, 0.005))
    here = Placement(np.array([0.01 + 0j, 0.08 + 0j]), np.ones(2, dtype=complex))
    assert distances(ShapePair.of(ring, small), here).value.tolist() == pytest.approx([0.0, 0.03])
    beside = polygon(np.array([0.0, 0.01, 0.01j]), 0.0, (0.01, 0.02))
    assert not ShapePair.of(ring, beside).common.any()


def test_an_arc_hollow_towards_the_other_body() -> None:
    """A point in a half ring of 40 mm, 10 mm from its centre: the nearest point is across the hollow."""
    half = [arc(0j, 40.0, np.pi, np.pi), arc_of_bulge(40.0 + 0j, 60.0 + 0j, 0.0), arc(0j, 60.0, 0.0, -np.pi)]
    half.append(arc_of_bulge(-60.0 + 0j, -40.0 + 0j, 0.0))
    pair = ShapePair.of(closed_curve(half, 0.0, LAYER), polygon(np.zeros(1, dtype=complex), 0.001, LAYER))
    at = Placement(np.array([-0.01j, 0.05j, 0.05 + 0.02j]), np.ones(3, dtype=complex))
    assert distances(pair, at).value * 1e3 == pytest.approx([29.0, np.hypot(40.0, 50.0) - 1.0, 19.0])
