"""core.motion.extremes: every change of sign, to the last bits, across kinks, between samples and at joins."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanisms import levels
from references import EPS

from core.motion import TURN, Angles, CompiledMotion
from core.motion.extremes import crossings, piecewise_angles

ONE = CompiledMotion(levels(0.0, (360.0, 0.0, "dwell")))
HALVES = CompiledMotion(levels(0.0, (180.0, 10.0, "cycloidal"), (180.0, 0.0, "cycloidal")))


def found(quantity, program: CompiledMotion = ONE) -> Angles:
    angles = piecewise_angles(program)
    return crossings(quantity, angles, quantity(angles))


@settings(max_examples=30)
@given(st.floats(0.05, 6.2), st.floats(0.1, 9.0), st.floats(-1.0, 1.0))
def test_a_root_is_found_to_the_last_bits_whatever_the_slopes_on_its_sides(
    place: float, steeper: float, bend: float
) -> None:
    """Slope 1 on the left, another on the right, and a bend: as a guide's force with friction has them."""

    def quantity(angles: Angles) -> np.ndarray:
        h = angles.theta - place
        return np.where(h < 0.0, h, steeper * h) * (1.0 + 0.1 * bend * h)

    roots = found(quantity)
    assert roots.theta == pytest.approx([place], abs=2 * EPS * TURN)
    assert roots.piece.tolist() == [0]


@pytest.mark.parametrize("apart", [0.3, 0.03, 3e-3, 1e-3])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_two_changes_between_two_samples_are_seen(apart: float, sign: float) -> None:
    """A parabola that dips below zero over less than the degree between samples; and one that only nearly does."""
    middle = math.radians(100.3)
    half = 0.5 * apart
    roots = found(lambda a: sign * ((a.theta - middle) ** 2 - half * half))
    assert roots.theta == pytest.approx([middle - half, middle + half], abs=8 * EPS * TURN / apart)
    assert found(lambda a: sign * ((a.theta - middle) ** 2 + half * half)).theta.size == 0


def test_a_jump_of_sign_at_a_join_is_no_root_and_one_inside_a_piece_is() -> None:
    jump = found(lambda a: np.where(a.piece == 0, 1.0, -1.0), HALVES)
    assert jump.theta.size == 0
    inside = found(lambda a: np.where(a.theta < 1.0, 1.0, -1.0), HALVES)
    assert inside.theta == pytest.approx([1.0], abs=2 * EPS * TURN)
    both = found(lambda a: np.sin(a.theta - 1.0), HALVES)
    assert both.theta == pytest.approx([1.0, 1.0 + math.pi], abs=4 * EPS * TURN)
    assert both.piece.tolist() == [0, 1]


def test_a_sample_that_is_zero_counts_once_where_the_sign_changes_and_not_where_it_does_not() -> None:
    angles = Angles(np.linspace(0.0, 4.0, 9), np.zeros(9, dtype=int))
    for function, roots in (
        (lambda t: t - 2.0, [2.0]),
        (lambda t: (t - 2.0) ** 2, []),
        (lambda t: t * 0.0, []),
        (lambda t: (t - 0.5) * (t - 1.75), [0.5, 1.75]),
    ):
        told = crossings(lambda a, f=function: f(a.theta), angles, function(angles.theta))
        assert told.theta == pytest.approx(roots, abs=4 * EPS)
