"""core.stability.floquet: one turn, against thirty digits and against laws it was not computed from."""

from dataclasses import replace
from functools import cache

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from large_designs import short_fall
from sampled import spread
from scipy.integrate import solve_ivp
from shafts import HARD, KIM, coefficients

from core.project import loads
from core.stability import APPROXIMATE, EXACT, monodromy
from core.stability.coefficients import INERTIA
from core.stability.floquet import determinant, growth, liouville, zeros_at_standstill
from core.study import Study

POINTS = ((0.85, 0.1, 0.0), (2.0, 0.05, 0.01), (5.3, 0.4, 0.0), (0.3, 1.0, 0.05))


def wave(place: mpmath.mpf, order: int) -> tuple[list, list]:
    """Taylor coefficients by y of cos 4πy and sin 4πy at a place."""
    angle, rate = 4 * mpmath.pi * place, 4 * mpmath.pi
    turned = [mpmath.expj(angle) * (1j * rate) ** k / mpmath.factorial(k) for k in range(order)]
    return [c.real for c in turned], [c.imag for c in turned]


def times(a: list, b: list, k: int) -> mpmath.mpf:
    """The k-th coefficient of a product."""
    return mpmath.fdot(a[: k + 1], b[k::-1])


@cache
def reference(eta: float, q: float, damping: float, equation: str, panels: int = 24, order: int = 36) -> mpmath.matrix:
    """(Dβ')' + 4πζηβ' + 4π²[η² + Q(ψ+κ)]β = 0, or (22), over one turn by power series with thirty digits; as a matrix for
    (√D β, its slope), which starts and ends where D = 1 and C = 0."""
    with mpmath.workdps(30):
        n, h, z = mpmath.mpf(eta), mpmath.mpf(q), mpmath.mpf(damping)
        tau, width = 2 * mpmath.pi, mpmath.mpf(1) / (2 * panels)
        states = [[mpmath.mpf(1), mpmath.mpf(0)], [mpmath.mpf(0), mpmath.mpf(1)]]
        for panel in range(panels):
            c, s = wave(width * panel, order)  # of 2θ
            double = [times(c, c, k) - times(s, s, k) for k in range(order)]  # cos 4θ
            whole = [h * times(s, s, k) * (equation == EXACT) + (k == 0) for k in range(order)]
            inverse: list = []
            for k in range(order):
                inverse.append(((k == 0) - mpmath.fdot(whole[1 : k + 1], inverse[::-1])) / whole[0])
            # ψ = 2a (cos 2θ - cos 4θ), κ = 4 cos 4θ
            stiff = [
                h * (3 * (c[k] - double[k]) + 4 * double[k] * (equation == EXACT)) + n * n * (k == 0)
                for k in range(order)
            ]
            for state in states:
                beta, momentum = [state[0]], [state[1]]
                for k in range(order - 1):
                    slope = times(momentum, inverse, k)
                    beta.append(slope / (k + 1))
                    momentum.append((-2 * tau * z * n * slope - tau**2 * times(stiff, beta, k)) / (k + 1))
                state[:] = [mpmath.fsum(c * width**k for k, c in enumerate(f)) for f in (beta, momentum)]
        decay, omega = tau * z * n / 2, tau * n * mpmath.sqrt(1 - z * z)
        co, si = mpmath.cos(omega / 2) * mpmath.exp(-decay), mpmath.sin(omega / 2) * mpmath.exp(-decay) / omega
        out = mpmath.matrix(2, 2)
        for j, (x, v) in enumerate(states):
            out[0, j] = x * co + (v + 2 * decay * x) * si
            out[1, j] = v * co - (2 * decay * v + (tau * n) ** 2 * x) * si
        return out


@pytest.mark.parametrize(
    ("point", "equation"), spread([(point, each) for point in POINTS for each in (EXACT, APPROXIMATE)], 1)
)
def test_one_turn_is_that_of_thirty_digits(point: tuple[float, float, float], equation: str) -> None:
    eta, q, damping = point
    exact = reference(eta, q, damping, equation)
    found = monodromy(coefficients(KIM), np.array([eta]), np.array([q]), equation, damping)
    scale = np.array([[1.0, 1.0 / (6.3 * eta)], [6.3 * eta, 1.0]])
    off = np.array([[abs(float(exact[i, j] - found.matrix[0, i, j])) for j in range(2)] for i in range(2)]) / scale
    assert off.max() < 2e-14
    assert off.max() <= found.error[0]


@pytest.mark.parametrize("name", HARD)
def test_the_determinant_is_liouvilles(name: str) -> None:
    """exp(-4πζη ∫ dy/D) with damping, 1 without."""
    found = coefficients(HARD[name])
    eta, q = np.meshgrid([1e-9, 0.31, 1.7, 5.6], [1e-6, 0.05, 1.0])
    for damping in (0.0, 0.02, 0.3):
        turn = monodromy(found, eta.ravel(), q.ravel(), EXACT, damping)
        inverse = [(found.panels.weights / (1.0 + each * found.panels.values[INERTIA])).sum() for each in q.ravel()]
        wanted = np.exp(-4.0 * np.pi * damping * eta.ravel() * np.array(inverse))
        assert np.abs(turn.det - wanted).max() < 1e-14
        assert np.abs(determinant(turn.matrix) - wanted).max() < 1e-13
        for each in np.unique(q):
            zero, bound = liouville(found, eta[0], each, EXACT, damping)
            assert (zero <= bound).all()
            assert bound.max() < 1e-11


@pytest.mark.parametrize("name", ["kim", "fixed", "layout c"])
def test_the_slope_is_the_derivative_by_eta(name: str) -> None:
    found = coefficients(HARD[name])
    for damping in (0.0, 0.05):
        eta = np.array([0.4, 1.3, 4.4])
        step = 1e-3
        sides = [monodromy(found, eta + k * step, np.array([0.2]), EXACT, damping).matrix for k in (-2, -1, 1, 2)]
        by_difference = (sides[0] - 8.0 * sides[1] + 8.0 * sides[2] - sides[3]) / (12.0 * step)
        slope = monodromy(found, eta, np.array([0.2]), EXACT, damping).slope
        assert np.abs(by_difference - slope).max() < 1e-7 * np.abs(slope).max()


def test_a_cam_that_is_no_load_swings_as_a_plain_shaft() -> None:
    eta = np.array([1e-6, 0.25, 1.5, 40.0])
    turn = monodromy(coefficients(KIM), eta, np.array([0.0]))
    assert np.abs(turn.trace - 2.0 * np.cos(2.0 * np.pi * eta)).max() < 1e-12


def test_points_worked_on_in_parts_are_the_same() -> None:
    eta = np.linspace(0.1, 5.5, 2000)
    q = np.linspace(0.01, 0.3, 2000)
    whole = monodromy(coefficients(KIM), eta, q)
    parts = monodromy(coefficients(KIM), eta[[3, 1500]], q[[3, 1500]])
    assert np.abs(whole.matrix[[3, 1500]] - parts.matrix).max() < 1e-12


@given(st.floats(-3.0, 3.0), st.floats(1e-6, 1.0))
def test_growth_is_that_of_the_larger_multiplier(trace: float, det: float) -> None:
    told = float(growth(np.array([trace]), np.array([det]))[0])
    roots = np.roots([1.0, -trace, det])
    # a double root of np.roots is good to half the digits
    assert np.exp(told) == pytest.approx(np.abs(roots).max(), rel=1e-7)


@given(st.sampled_from(sorted(HARD)), st.floats(0.05, 5.6), st.floats(1e-6, 1.0))
def test_time_run_backwards_has_the_same_trace(name: str, eta: float, q: float) -> None:
    """The mirrored equation: M⁻¹ has the trace of M, so its own turn, run over the panels from the last, must too."""
    found = coefficients(HARD[name])
    panels = found.panels
    width = panels.width[::-1]
    values = panels.values[:, ::-1, ::-1].copy()
    values[1] *= -1.0  # C is odd
    values[2] *= -1.0  # and so is U
    ends = np.cumsum(width)
    back = replace(
        found, panels=replace(panels, start=ends - width, width=width, piece=panels.piece[::-1], values=values)
    )
    one, other = (monodromy(f, np.array([eta]), np.array([q])) for f in (found, back))
    assert abs(one.trace - other.trace)[0] <= 4.0 * (one.error + other.error)[0]


@pytest.mark.parametrize("q", [0.05, 20.0, 300.0])
def test_zeros_at_standstill_are_those_of_another_integrator(q: float) -> None:
    """ζ'' + 4π² Q ψ ζ = 0 through one turn, ψ = 3 (cos 2θ - cos 4θ) on its first half."""

    def rate(y: float, state: np.ndarray) -> list[float]:
        theta = 2.0 * np.pi * y
        psi = 3.0 * (np.cos(2.0 * theta) - np.cos(4.0 * theta)) if y < 0.5 else 0.0
        return [state[1], -4.0 * np.pi**2 * q * psi * state[0]]

    first = solve_ivp(rate, (0.0, 0.5), [1.0, 0.0], rtol=1e-10, atol=1e-12, max_step=1e-3)
    value, slope = first.y[:, -1]
    zeros = int((np.diff(np.sign(first.y[0])) != 0).sum()) + int(value * (value + 0.5 * slope) < 0.0)
    assert zeros_at_standstill(coefficients(KIM), q, APPROXIMATE) == zeros
    assert zeros > 2 or q < 1.0


def test_liouville_is_kept_where_a_turn_grows_beyond_all_digits() -> None:
    """A fall of 0.09°: by e^230 a turn. The determinant of the turn has no digit left, that of every panel has; and the
    panels are as narrow as the peaks at the ends of the fall, so that nothing of these is lost."""
    made = Study(loads(short_fall(0.09))).flexible_shaft()
    turn = monodromy(made.coefficients, np.array([1.0]), np.array([made.machine.q]), EXACT)
    assert turn.growth[0] > 200.0
    assert abs(float(determinant(turn.matrix)[0]) - 1.0) > 0.5
    assert made.coefficients.panels.tail < 1e-8
    zero, bound = liouville(made.coefficients, np.array([0.5, 1.0, 5.0]), made.machine.q, EXACT)
    assert (zero <= bound).all()
    assert bound.max() < 1e-10
    assert zeros_at_standstill(made.coefficients, made.machine.q) > 13, "all eleven tongues stand at η² < 0"
    proof = made.certificate
    assert proof["tongue_residual"].note == "11 of 11 tongues (too few harmonics) left out"
    assert proof["tongue_error"].value == 0.0
