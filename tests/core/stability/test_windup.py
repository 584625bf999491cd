"""core.stability: the nonlinear wind-up, against another integrator and against the laws it must obey."""

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from references import MP
from sampled import spread, stressed
from scipy.integrate import solve_ivp
from shafts import HARD, KIM, by_runge_kutta, coefficients, kim, of

from core.stability import branch, histories, history, mean_wind_up, shoot, steady_response
from core.stability.integrator import Integrator
from core.stability.windup import History

TAU = 2.0 * np.pi


@pytest.mark.parametrize(
    ("eta", "q", "damping", "periods"),
    spread([(0.85, 0.1, 0.0, 6.0), (2.0, 0.05, 0.0, 12.0), (1.3, 0.3, 0.03, 4.0), (0.9, 0.4, 0.0, 3.0)], 1),
)
def test_the_wind_up_is_that_of_another_integrator(eta: float, q: float, damping: float, periods: float) -> None:
    """At η = 2 the cam turns back eight times and passes joins the wrong way; at Q = 0.4 it rushes through them."""
    run = by_runge_kutta(eta, q, damping, periods)
    y, beta = run.y, run.beta
    gone = history(coefficients(KIM), eta, q, damping, periods)
    assert np.abs(gone.at(y)[0] - beta).max() < 1e-9
    assert (gone.samples.rate >= 1.0).any() == (run.rate >= 1.0).any()
    assert eta != 2.0 or (gone.samples.rate > 1.0).any()


def test_a_cam_that_stands_thrice_at_an_angle_is_followed_through_all() -> None:
    """It turns back and comes again: in the dwell the shaft then stands at the same cam angle at three times."""
    run = by_runge_kutta(0.9, 0.2, 0.0, 5.0)
    gone = history(coefficients(KIM), 0.9, 0.2, 0.0, 5.0)
    assert (gone.samples.rate > 1.0).any()
    assert np.abs(gone.at(run.y)[0] - run.beta).max() < 1e-9
    ends = gone.at(gone.steps.y[1:])
    before = gone.at(np.nextafter(gone.steps.y[1:], 0.0))
    assert all(np.abs(a - b).max() < 1e-11 for a, b in zip(ends, before, strict=True)), "no jump from step to step"


@pytest.mark.parametrize(("name", "eta", "q", "damping", "room"), spread([
    ("kim", 1.3, 0.3, 0.0, 1e-11), ("kim", 1.3, 0.3, 0.03, 1e-11), ("parabolic", 2.4, 0.05, 0.0, 1e-12),
    ("high dwell", 0.9, 0.2, 0.0, 1e-12), ("layout c", 5.1, 0.4, 0.0, 1e-8),
], 2))  # fmt: skip
def test_a_history_goes_on_from_any_of_its_states(name: str, eta: float, q: float, damping: float, room: float) -> None:
    """After a whole turn of the input, where the cam stands within a piece: every later step then lies elsewhere. The last is a
    shaft of five swings in a turn of a slow cam, in which neighbouring histories soon part."""
    found = coefficients(HARD[name])
    whole = history(found, eta, q, damping, 3.0)
    beta, rate = (float(each[0]) for each in whole.at(np.ones(1)))
    inertia = 1.0 + q * found.panels.at(np.array([np.mod(TAU * (1.0 - beta), TAU)]), 1)[0, 0]
    later = history(found, eta, q, damping, 2.0, (beta, inertia * (1.0 - rate)))
    y = np.linspace(0.0, 2.0, 99)
    assert abs(beta) > 1e-4
    for one, other in zip(later.at(y), whole.at(y + 1.0), strict=True):
        assert np.abs(one - other).max() < room * max(1.0, np.abs(other).max())


# -- another integrator, other cams ------------------------------------------------------------------------

Terms = Callable[[float], Sequence[float]]


def parabolic(theta: float) -> tuple[float, float, float]:
    """d, C, U of Kim's valve train with two parabolic strokes of 120° each and a dwell: X from 0 to 1, X'm = 2/φ, X''m = 4/φ²."""
    span = TAU / 3.0
    if theta >= 2.0 * span:
        return 0.0, 0.0, 0.0
    rising = theta < span
    part = (theta if rising else 2.0 * span - theta) / span
    x, x1, x2 = (2 * part**2, 4 * part, 4.0) if part < 0.5 else (1 - 2 * (1 - part) ** 2, 4 * (1 - part), -4.0)
    x1 *= 1.0 if rising else -1.0
    return (x1 / 2.0) ** 2, x1 * x2 / span / 4.0, 1.5 * x * x1 / span


def by_dop853(terms: Terms, ends: Sequence[float], eta: float, q: float, y: np.ndarray) -> np.ndarray:
    """β (n,) at y (n,) from rest by scipy, restarted where the cam comes to an end of a piece; it never turns back."""
    state, begin, low, parts = [0.0, 0.0], 0.0, 0.0, []
    for high in [turn * TAU + end for turn in range(int(y[-1]) + 2) for end in ends]:
        if begin > y[-1]:
            break

        def slopes(t: float, s: np.ndarray, low: float = low, high: float = high) -> list[float]:
            theta = min(max(TAU * (t - s[0]), np.nextafter(low, high)), np.nextafter(high, low))
            d, c, u = terms(theta % TAU)
            return [s[1], (TAU * q * (c * (1.0 - s[1]) ** 2 + u) - (TAU * eta) ** 2 * s[0]) / (1.0 + q * d)]

        def at_end(t: float, s: np.ndarray, high: float = high) -> float:
            return TAU * (t - s[0]) - high

        at_end.terminal = True  # type: ignore[attr-defined]
        run = solve_ivp(
            slopes, (begin, 2.0 * y[-1]), state, "DOP853", events=at_end, dense_output=True, rtol=1e-12, atol=1e-16
        )
        assert (run.y[1] < 1.0).all()
        parts.append(run.sol(y[(y >= begin) & (y < run.t[-1])])[0])
        begin, low, state = float(run.t[-1]), high, run.y[:, -1].tolist()
    return np.concatenate(parts)


@pytest.mark.parametrize(("name", "eta", "q"), [("parabolic", 2.4, 0.05), ("layout c", 2.6, 0.1)])
def test_the_wind_up_is_that_of_dop853(name: str, eta: float, q: float) -> None:
    """A parabolic law by its formulas, at whose joins C jumps, and a layout of the cam slider under its own loads."""
    found, y = coefficients(HARD[name]), np.linspace(0.0, 0.999, 200)
    fixed = np.array([1.0, 1.0, eta**2 if found.fixed else 1.0])
    terms = parabolic if name == "parabolic" else lambda theta: fixed * found.panels.at(np.array([theta]), 3)[:, 0]
    first = np.flatnonzero(np.diff(found.panels.piece, append=-1))
    ends = found.panels.start[first] + found.panels.width[first]
    beta = by_dop853(terms, ends, eta, q, y)
    assert np.abs(history(found, eta, q, 0.0, 1.0).at(y)[0] - beta).max() < 3e-11 * np.abs(beta).max()


# -- accuracy ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("eta", "turns"), spread([(3.3, 10.0), (41.7, 2.0)], 1))
def test_a_bare_shaft_swings_as_in_closed_form_to_the_last_turn(eta: float, turns: float) -> None:
    """At Q = 0, cos 2πηy: what each of hundreds of steps is off by adds up."""
    y = np.linspace(0.0, turns, 301)
    gone = history(coefficients(KIM), eta, 0.0, 0.0, turns, (0.02, 1.0))
    wave = np.array([float(MP.cos(2 * MP.pi * MP.mpf(eta) * MP.mpf(t))) for t in y])
    assert np.abs(gone.at(y)[0] / 0.02 - wave).max() < 1e-10


def test_no_place_within_a_step_is_misread() -> None:
    """At Q = 1 the cam slows down so much within a step that half of its turn is by far not half of its time."""
    gone, y = history(coefficients(KIM), 1.45, 1.0, 0.02, 1.0), np.linspace(0.0, 1.0, 20_001)
    beta, rate = gone.at(y)
    assert np.abs(np.diff(beta) - 0.5 * np.diff(y) * (rate[1:] + rate[:-1])).max() < 1e-9


def test_the_wind_up_keeps_twelve_digits() -> None:
    """Kim's cam at the benchmark's point against 50-digit values."""
    from benchmarks.exact import DAMPING, SPEED, TURNS, exact

    there = exact("wind-up")
    found = history(coefficients(KIM), SPEED, 0.05, DAMPING, TURNS)
    assert there.error([found.at(np.array(there.at))[0]]) <= 1e-12


def test_points_side_by_side_are_the_points_alone() -> None:
    found = coefficients(KIM)
    eta, q = np.array([0.85, 2.0, 4.7]), np.array([0.1, 0.05, 0.9])
    together = histories(found, eta, q, 0.0, 2.0)
    y = np.linspace(0.0, 2.0, 99)
    for i, one in enumerate(together):
        assert np.abs(one.at(y)[0] - history(found, eta[i], q[i], 0.0, 2.0).at(y)[0]).max() < 1e-11


@given(st.floats(0.3, 5.6), st.floats(1e-3, 0.5), st.sampled_from([0.0, 0.02]))
@settings(max_examples=8)
def test_a_history_satisfies_equation_13(eta: float, q: float, damping: float) -> None:
    """By finite differences of what it tells, away from the joins."""
    gone = history(coefficients(KIM), eta, q, damping, 1.0)
    y, h = np.linspace(0.03, 0.45, 9), 2e-3 / max(1.0, eta)
    beta = [gone.at(y + k * h)[0] for k in (-2, -1, 0, 1, 2)]
    first = (beta[0] - 8.0 * beta[1] + 8.0 * beta[3] - beta[4]) / (12.0 * h)
    second = (-beta[0] + 16.0 * beta[1] - 30.0 * beta[2] + 16.0 * beta[3] - beta[4]) / (12.0 * h * h)
    theta = TAU * (y - beta[2])
    d, c, u, _, _ = np.array([kim(float(t)) for t in theta]).T
    left = (1.0 + q * d) * second - TAU * q * c * (1.0 - first) ** 2 + 2.0 * TAU * damping * eta * first
    left += (TAU * eta) ** 2 * beta[2]
    away = np.abs(np.mod(theta, np.pi) - np.pi / 2) < np.pi / 2 - 0.1
    assert np.abs((left - TAU * q * u)[away]).max() < 1e-4 * max(1.0, np.abs(TAU * q * u).max())
    assert np.abs(first - gone.at(y)[1])[away].max() < 1e-6


# -- derivatives ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "damping"),
    [stressed("kim", 0.0), stressed("parabolic", 0.05), ("high dwell", 0.0), stressed("layout c", 0.05)],
)
def test_the_derivatives_of_a_turn_are_differences_of_turns(name: str, damping: float) -> None:
    """By the state at the start and by η, through joins at which C jumps."""
    found, eta, q = coefficients(HARD[name]), 1.7, 0.2
    start, step = np.array([0.01, 1.03]), 1e-4
    integrator = Integrator(found, eta, q, damping)
    change = integrator.run(start, 0.0, 1.3, change=True).change
    assert change is not None

    def end(shift: np.ndarray) -> np.ndarray:
        other = Integrator(found, eta + shift[2], q, damping)
        return other.run(start + shift[:2], 0.0, 1.3).x[0]

    for column in range(3):
        unit = np.eye(3)[column] * step
        by_difference = (end(-2 * unit) - 8.0 * end(-unit) + 8.0 * end(unit) - end(2 * unit)) / (12.0 * step)
        # steps pass a join sooner or later: where C jumps the differences are good to their first order in it
        assert np.abs(by_difference - change[0, :, column]).max() < 2e-6 * max(1.0, np.abs(change[0]).max())


@given(st.sampled_from(sorted(HARD)), st.floats(0.4, 5.0), st.floats(1e-4, 0.4))
@settings(max_examples=10)
def test_without_damping_a_turn_keeps_areas(name: str, eta: float, q: float) -> None:
    integrator = Integrator(coefficients(HARD[name]), eta, q)
    change = integrator.run(integrator.resting(), 0.0, 1.0, change=True).change
    assert change is not None
    if np.isfinite(change).all():
        assert np.linalg.det(change[0, :, :2]) == pytest.approx(
            1.0, abs=1e-11 * max(1.0, np.abs(change[0, :, :2]).max() ** 2)
        )


# -- figures of a history ---------------------------------------------------------------------------------


@cache
def gone() -> History:
    return history(coefficients(KIM), 2.0, 0.05, 0.0, 5.0, contact=of(KIM).contact)


def test_the_largest_wind_up_is_refined() -> None:
    y = np.linspace(0.0, 5.0, 100_001)
    beta = np.abs(gone().at(y)[0])
    largest, at = gone().largest
    assert beta.max() <= largest + 1e-12
    assert largest - beta.max() < 1e-7
    assert abs(gone().at(np.array([at]))[0][0]) == pytest.approx(largest, abs=1e-15)
    assert abs(gone().at(np.array([at]))[1][0]) < 1e-9


def test_the_averages_are_those_of_many_samples() -> None:
    one = history(coefficients(KIM), 2.0, 0.05, 0.0, 1.0)
    y = np.linspace(0.0, 1.0, 50_001)
    beta, rate = one.at(y)
    for mean, values in zip(one.averages(), (beta, rate), strict=True):
        assert mean == pytest.approx(np.trapezoid(np.abs(values), y), rel=1e-6)
    many = mean_wind_up(coefficients(KIM), [0.1, 0.05], np.array([1.3, 2.0]))
    assert [many.wind_up[1, 1], many.slope[1, 1]] == pytest.approx(one.averages(), rel=1e-9)
    assert many.is_contact_lost is None


def test_the_contact_force_is_that_of_the_followers_own_motion() -> None:
    """M Ẍ + K_v X by differences of where the follower is, which the pressure angle enlarges."""
    y, h = np.linspace(0.05, 3.2, 60), 2e-4
    theta = [TAU * (t - gone().at(t)[0]) for t in (y - h, y, y + h)]
    moving = (np.mod(theta[1], TAU) > 0.1) & (np.mod(theta[1], TAU) < 3.0)
    x = [np.where(np.mod(t, TAU) < np.pi, (1.0 - np.cos(2.0 * t)) / 2.0, 0.0) for t in theta]
    second = (x[0] - 2.0 * x[1] + x[2]) / (h * TAU) ** 2
    force = second / 2.0 + 1.5 * x[1]  # X''m = 2, X_m = 1
    slope = 9.0 * np.sin(2.0 * theta[1])
    along = np.cos(np.arctan2(slope, 40.0 + 9.0 * x[1]))
    assert np.abs(gone().force(y) * along - force)[moving].max() < 1e-5
    assert moving.sum() > 15


def test_the_follower_leaves_the_cam_where_the_force_first_vanishes() -> None:
    lost = gone().contact_lost
    assert lost == pytest.approx(3.30185, abs=1e-5)
    assert lost is not None
    assert abs(gone().force(np.array([lost]))[0]) < 1e-9
    y = np.linspace(0.0, lost, 20_000)[:-1]
    beta, _ = gone().at(y)
    moving = np.mod(TAU * (y - beta), TAU) < np.pi - 1e-9
    assert (gone().force(y)[moving] > -1e-9).all()
    assert not gone().force(y)[~moving].any(), "in the dwell there is no force, and no loss either"


def test_the_spectrum_names_the_waves() -> None:
    """A shaft that nothing loads swings at η with the amplitude it was given."""
    plain = history(coefficients(KIM), 3.0, 0.0, 0.0, 16.0, (0.02, 1.0))
    order, amplitude = plain.spectrum()
    assert order[amplitude.argmax()] == pytest.approx(3.0)
    assert amplitude.max() == pytest.approx(0.02, rel=1e-3)
    assert amplitude[np.abs(order - 3.0) > 0.5].max() < 1e-4


def test_a_history_that_cannot_be_followed_ends_early_and_says_so() -> None:
    wild = history(coefficients(KIM), 2.0, 0.05, 0.0, 3.0, (0.9, 29.0))
    assert wild.ended < 3.0
    assert wild.steps.y[-1] + wild.steps.h[-1] == pytest.approx(wild.ended)
    assert np.isfinite(wild.at(np.linspace(0.0, wild.ended, 50))[0]).all()


# -- steady response --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("eta", "q"), spread([(0.85, 0.1), (1.5, 0.05), (2.1, 0.05), (5.25, 0.2)], 2))
def test_a_steady_response_repeats_and_its_matrix_is_its_stability(eta: float, q: float) -> None:
    found = coefficients(KIM)
    steady = steady_response(found, eta, q)
    assert steady is not None
    turns = history(found, eta, q, 0.0, 3.0, (float(steady.state[0]), float(steady.state[1])))
    y = np.linspace(0.0, 1.0, 50)
    assert np.abs(turns.at(y)[0] - turns.at(y + 1.0)[0]).max() < 1e-10
    assert steady.stable is (eta != 1.5), "at 1.5 it lies in the third tongue"
    # a small departure goes where the matrix says
    off = np.array([1e-6, -2e-6])
    integrator = Integrator(found, eta, q)
    moved = integrator.run(steady.state + off, 0.0, 1.0).x[0] - steady.state
    assert np.abs(moved - steady.matrix @ off).max() < 1e-9  # of 3e-5, to second order


def test_as_the_load_vanishes_the_last_word_is_that_of_21() -> None:
    """The response is of the order of Q, and so is the difference of the traces."""
    from core.stability import monodromy

    found = coefficients(KIM)
    for q in (1e-3, 1e-4):
        steady = steady_response(found, 1.3, q)
        assert steady is not None
        linear = float(monodromy(found, np.array([1.3]), np.array([q])).trace[0])
        assert abs(steady.trace - linear) < 10.0 * q**2
        assert abs(steady.state[0]) < 2.0 * q


def test_damping_makes_the_steady_response_attract() -> None:
    found = coefficients(KIM)
    steady = steady_response(found, 2.1, 0.05, 0.1)
    assert steady is not None
    assert steady.growth < -1.0
    late = history(found, 2.1, 0.05, 0.1, 11.0)
    assert late.at(np.array([11.0]))[0][0] == pytest.approx(steady.state[0], abs=1e-6)
    assert abs(steady.state[0]) > 1e-3


@pytest.mark.stress
def test_the_branch_of_steady_responses_goes_through_its_fold() -> None:
    """Near η = 2 the resonance bends: along its arc η turns back, and the trace passes 2 there."""
    found = coefficients(KIM)
    start = shoot(found, 2.2, 0.05, 0.0, None)
    assert start is not None
    seen = []
    for point in branch(found, start, -1.0):
        seen.append(point)
        if len(seen) > 3 and seen[-1].eta > seen[-2].eta:
            break
    assert 2.0 < seen[-1].eta < 2.05, "it never comes to 2: from below another branch does"
    assert all(p.residual < 1e-9 for p in seen)
    assert seen[-1].trace > 1.999 > seen[0].trace
    wind_up = [abs(p.state[1] - 1.0) for p in seen]
    assert wind_up[-1] > 10.0 * wind_up[0]


def test_a_search_that_runs_wild_finds_nothing() -> None:
    assert shoot(coefficients(KIM), 2.0, 0.05, 0.0, np.array([0.9, 20.0])) is None


def test_a_cam_that_only_spins_is_lost_and_told_so() -> None:
    lost = Integrator(coefficients(KIM), np.array([0.5]), np.array([1.0])).run(np.array([0.0, 40.0]), 0.0, 1.0)
    assert np.isnan(lost.y).all()
    assert np.isnan(lost.x).all()
