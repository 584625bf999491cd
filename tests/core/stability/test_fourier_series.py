"""core.stability.coefficients and harmonics: coefficients of functions in pieces, and multiplication by them."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sampled import spread
from shafts import HARD, KIM, A, coefficients, kim, moved

from core.stability.coefficients import (
    APPROXIMATE,
    CENTRIPETAL,
    CURVATURE,
    EXACT,
    INERTIA,
    LOAD_SLOPE,
    Basis,
    basis,
    fourier,
    product,
    truncation,
    weight_and_potential,
)

ORDERS = (0, 1, 2, 7, 24)


def exact(function: object, k: int) -> mpmath.mpc:
    """(1/2π) ∫ f e^{-ikθ} over 0 ... π in pieces that the wave does not outrun."""
    cuts = mpmath.linspace(0, mpmath.pi, 3 + k // 8)
    return mpmath.quad(lambda t: function(t) * mpmath.expj(-k * t), cuts) / (2 * mpmath.pi)


@pytest.mark.parametrize("k", spread(ORDERS, 1))
def test_kims_coefficients_to_all_digits(k: int) -> None:
    """ψ in closed form; 1/D, (C/D)², which no polynomial is, by integration with twenty digits; κ, which jumps."""
    found = coefficients(KIM)
    w, p = weight_and_potential(found, EXACT, np.array([0.3]))
    by_hand = [
        (found.panels.values[LOAD_SLOPE], lambda t: kim(t)[4], 0),
        (found.panels.values[CURVATURE], lambda t: kim(t)[3], 0),
        (w[0], lambda t: 1 / (1 + mpmath.mpf("0.3") * kim(t)[0]), 1),
        (p[0], lambda t: _potential(t), 0),
    ]
    with mpmath.workdps(20):
        for values, function, rest in by_hand:
            wanted = exact(function, k)
            if rest and k == 0:
                wanted += mpmath.mpf(1) / 2  # the dwell
            elif rest:
                cuts = mpmath.linspace(mpmath.pi, 2 * mpmath.pi, 3 + k // 8)
                wanted += mpmath.quad(lambda t: mpmath.expj(-k * t), cuts) / (2 * mpmath.pi)
            assert abs(complex(fourier(found.panels, values, k)[k]) - complex(wanted)) < 2e-15


def _potential(t: mpmath.mpf) -> mpmath.mpf:
    d, c, _, _, psi = kim(t)
    whole = 1 + mpmath.mpf("0.3") * d
    return mpmath.mpf("0.3") * psi / whole + (mpmath.mpf("0.3") * c / whole) ** 2


def test_psi_in_closed_form() -> None:
    """c_k of 2a (cos 2θ - cos 4θ) on half a turn: a/2 at k = 2, -a/2 at 4, nothing at other even k, and for odd k
    2i (a/π) k [1/(4-k²) - 1/(16-k²)]."""
    c = fourier(coefficients(KIM).panels, coefficients(KIM).panels.values[LOAD_SLOPE], 60)
    for k in range(61):
        wanted: complex = {2: A / 2, 4: -A / 2}.get(k, 0.0)
        if k % 2:
            wanted = 2j * A / np.pi * k * (1.0 / (4 - k * k) - 1.0 / (16 - k * k))
        assert abs(c[k] - wanted) < 5e-15  # of 6, a hundred roundings


@pytest.mark.parametrize("name", HARD)
def test_the_series_sum_to_the_function_in_the_mean(name: str) -> None:
    """Parseval, with jumps: what is missing falls like 1/N."""
    found = coefficients(HARD[name])
    for row in (INERTIA, CENTRIPETAL, LOAD_SLOPE):
        values = found.panels.values[row]
        whole = (found.panels.weights * values**2).sum()
        c = fourier(found.panels, values, 1000)
        sums = np.abs(c[0]) ** 2 + 2.0 * np.cumsum(np.abs(c[1:]) ** 2)
        assert sums[-1] <= whole * (1.0 + 1e-12)
        assert whole - sums[-1] <= 2.1 * (whole - sums[499]) / 2.0 + 1e-13 * whole
        assert whole - sums[-1] < 2e-3 * whole


def test_what_the_polynomials_leave_is_told() -> None:
    found = coefficients(KIM)
    w, p = weight_and_potential(found, EXACT, np.array([0.05, 30.0]))
    told = truncation(found.panels, np.stack((w, p)))
    assert (told[:, 0] < 1e-14).all()
    assert told[1, 1] > 1e-9, "panels made for Q up to 1 are coarse for 30"


# -- matrices ---------------------------------------------------------------------------------------------


def wave(numbers: Basis, theta: np.ndarray) -> np.ndarray:
    """The functions of a basis (n, angles), orthonormal in the mean over two turns."""
    even = np.where(numbers.cosines == 0.0, 1.0, np.sqrt(2.0))[:, None] * np.cos(np.outer(numbers.cosines, theta))
    return np.concatenate((even, np.sqrt(2.0) * np.sin(np.outer(numbers.sines, theta))))


@pytest.mark.parametrize("half", [False, True])
def test_multiplying_is_a_matrix(half: bool) -> None:
    """Against sums over equally spaced angles, which are exact for so few harmonics."""
    rng = np.random.default_rng(5)
    c = rng.normal(size=13) + 1j * rng.normal(size=13)
    c[0] = c[0].real
    theta = 4.0 * np.pi * np.arange(256) / 256
    function = (c[0] + 2.0 * (c[1:, None] * np.exp(1j * np.outer(np.arange(1, 13), theta))).sum(axis=0)).real
    inner, outer = basis(-1, 4, half), basis(4, 8, half)
    for left, right in ((inner, inner), (outer, inner)):
        by_sum = (wave(left, theta) * function) @ wave(right, theta).T / theta.size
        assert np.abs(product(c[None], left, right)[0] - by_sum).max() < 1e-13
    assert basis(-1, 4, half).numbers.size == (8 if half else 9)


@given(st.floats(0.01, 2.0), st.sampled_from(["kim", "parabolic", "no dwell"]))
def test_products_are_symmetric_and_between_the_bounds_of_the_function(q: float, name: str) -> None:
    found = coefficients(HARD[name])
    w, _ = weight_and_potential(found, EXACT, np.array([q]))
    numbers = basis(-1, 9, True)
    matrix = product(fourier(found.panels, w, 18), numbers, numbers)[0]
    assert np.array_equal(matrix, matrix.T)
    values = np.linalg.eigvalsh(matrix)
    assert w.min() - 1e-12 <= values[0] <= values[-1] <= w.max() + 1e-12


def test_22_leaves_out_inertia_and_centripetal_terms() -> None:
    found = coefficients(KIM)
    w, p = weight_and_potential(found, APPROXIMATE, np.array([0.2]))
    assert (w == 1.0).all()
    assert np.array_equal(p[0], 0.2 * found.panels.values[LOAD_SLOPE])
    fixed = coefficients(HARD["fixed"])
    w, p = weight_and_potential(fixed, APPROXIMATE, np.array([0.2]))
    assert not p.any()
    assert np.array_equal(w[0], 1.0 + 0.2 * fixed.panels.values[LOAD_SLOPE])


def test_a_cam_of_two_equal_halves_has_no_odd_harmonics() -> None:
    twice = moved(
        (90.0, 9.0, "simple-harmonic"),
        (90.0, 0.0, "simple-harmonic"),
        (90.0, 9.0, "simple-harmonic"),
        (90.0, 0.0, "simple-harmonic"),
    )
    c = fourier(coefficients(twice).panels, coefficients(twice).panels.values[LOAD_SLOPE], 20)
    assert np.abs(c[1::2]).max() < 1e-14
    assert np.abs(c[2]) > 0.1
