"""Kim, Jeon, Lee and Park 1990: dynamic stability of a single cam drive, from the example file alone.

``kim1990_tongues.json`` holds the edges of its tongues at Q = 0.05, computed with 34 digits.
"""

import json
from functools import cache
from pathlib import Path

import mpmath
import numpy as np
import pytest
from paper_claims import EXAMPLES
from sampled import spread
from shafts import kim, kim_table, leaves_cam

from core.papers.kim1990_chart import averages, runs, shaft_of
from core.stability import (
    APPROXIMATE,
    EXACT,
    History,
    Stability,
    harmonic_tongues,
    kim_edges,
    kim_matrix,
    monodromy,
    refined,
    tongues,
)
from core.stability.coefficients import LOAD_SLOPE
from core.stability.stage import linear_verdicts, rest_verdict

REFERENCE = json.loads((Path(__file__).parent / "kim1990_tongues.json").read_text(encoding="utf-8"))
EXAMPLE = Path(__file__).parents[2] / "resources" / "examples" / "kim_1990.toml"
MODELS = (APPROXIMATE, EXACT)
FIGURES = {9: (0.85, 0.10), 10: (0.90, 0.10), 11: (2.10, 0.05), 12: (2.00, 0.05)}


@cache
def shaft() -> Stability:
    return shaft_of(EXAMPLES)


def printed(model: str) -> np.ndarray:
    return np.array([[float(row["lo"]), float(row["hi"])] for row in REFERENCE[model]])


# -- the cam ----------------------------------------------------------------------------------------------


def test_the_example_is_kims_cam_with_q_of_a_twentieth() -> None:
    found = shaft().coefficients
    assert found.q == pytest.approx(0.05, rel=1e-15)
    assert (found.spring, found.sizes.stroke) == ("retuned", pytest.approx(0.009, rel=1e-15))
    expected = kim_table(found.panels.theta)
    largest = np.abs(expected).max(axis=(1, 2))[:, None, None]
    assert np.abs((found.panels.values - expected) / largest).max() < 1e-13


def test_psi_is_that_of_figure_5_and_has_the_odd_harmonics_of_the_dwell() -> None:
    """ψ = 2a (cos 2θ - cos 4θ) on half the turn: 3 units high and -6 deep, and no half of it repeats the other."""
    psi = shaft().coefficients.panels.values[LOAD_SLOPE]
    # the top of cos 2θ - cos 4θ is 9/8, at cos 2θ = 1/4
    assert psi.min() == pytest.approx(-6.0, abs=1e-2)
    assert psi.max() == pytest.approx(3.375, abs=1e-2)


# -- edges ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", MODELS)
def test_tongue_edges_are_the_reference_to_ten_decimals(model: str) -> None:
    found = tongues(shaft().coefficients, np.array([0.05]), 11, model, error=1e-11)
    assert np.abs(found.edges[0] - printed(model)).max() < 1e-10
    assert found.error.max() <= 1e-11


@pytest.mark.parametrize("model", MODELS)
def test_harmonic_balance_and_monodromy_matrices_give_the_same_edges(model: str) -> None:
    by_harmonics = harmonic_tongues(shaft().coefficients, np.array([0.05]), 11, model)
    by_matrices = refined(shaft().coefficients, by_harmonics)
    apart = np.abs(by_harmonics.edges - by_matrices.edges).max(axis=2)
    assert (apart <= by_harmonics.error + by_matrices.error).all()
    assert np.abs(by_matrices.edges[0] - printed(model)).max() < 1e-12


@pytest.mark.parametrize("model", MODELS)
def test_at_every_edge_a_solution_comes_back_after_one_turn_or_two(model: str) -> None:
    """The trace is 2 (n even) or -2 (n odd), and beyond that between the edges."""
    edges = printed(model)
    sign = np.where(np.arange(1, 12) % 2 == 0, 1.0, -1.0)
    turn = monodromy(shaft().coefficients, edges.ravel(), np.array([0.05]), model)
    assert np.abs(turn.trace.reshape(11, 2) - 2.0 * sign[:, None]).max() < 1e-13
    middle = monodromy(shaft().coefficients, edges.mean(axis=1), np.array([0.05]), model)
    assert (middle.trace * sign > 2.0 - 1e-13).all()
    assert (middle.growth[[0, 1, 2, 3, 4]] > 1e-3).all()


@cache
def integrals() -> list[mpmath.mpc]:
    """ψ_0 ... ψ_10 of (24), with thirty digits."""
    joins = [0, mpmath.pi / 2, mpmath.pi]
    with mpmath.workdps(30):
        return [
            mpmath.quad(lambda t, k=k: kim(mpmath.mpf(t))[4] * mpmath.expj(-k * t), joins) / (2 * mpmath.pi)
            for k in range(11)
        ]


@pytest.mark.parametrize("half", spread([False, True], 1))
def test_the_eleven_by_eleven_matrix_is_the_papers(half: bool) -> None:
    """Its entries from the integrals (24), its determinant (32) zero at the edges it gives."""
    with mpmath.workdps(30):
        c = integrals()
        ours = kim_matrix(shaft().coefficients, 0.05, half)
        for i in range(11):
            for j in range(11):
                k = i - j
                entry = -mpmath.mpf("0.05") * (c[k] if k >= 0 else mpmath.conj(c[-k]))
                entry += (i - 5 + (0.5 if half else 0)) ** 2 if i == j else 0
                assert abs(complex(ours[i, j]) - complex(entry)) < 1e-14
        edges = kim_edges(shaft().coefficients, 0.05)
        for n, pair in enumerate(edges, 1):
            for eta in pair if n % 2 == half else ():
                k = mpmath.matrix(11, 11)
                for i in range(11):
                    for j in range(11):
                        k[i, j] = mpmath.mpc(ours[i, j]) - (mpmath.mpf(eta) ** 2 if i == j else 0)
                # of the product of what the other eigenvalues leave
                others = mpmath.mpf(1)
                for value in np.linalg.eigvalsh(ours):
                    others *= max(abs(value - eta**2), 1e-4)
                assert abs(mpmath.det(k)) < 1e-9 * others


def test_eleven_by_eleven_is_good_to_four_decimals_but_not_to_six() -> None:
    off = np.abs(kim_edges(shaft().coefficients, 0.05) - printed(APPROXIMATE)[:9]).max(axis=1)
    assert off.max() < 1e-4
    assert off.min() > 1e-6


def test_tongues_stand_at_every_half() -> None:
    """Not only at whole η, as the paper has it: those at 1/2 and 3/2 are among the three widest."""
    for model in MODELS:
        found = tongues(shaft().coefficients, np.array([0.05]), 11, model)
        width = found.edges[0, :, 1] - found.edges[0, :, 0]
        assert (
            (width > 100.0 * found.error[0]).all() if model == EXACT else (width[:9] > 100.0 * found.error[0, :9]).all()
        )
        assert np.abs(found.edges[0].mean(axis=1) - 0.5 * np.arange(1, 12)).max() < 0.04
        assert {1, 3} & set(np.argsort(-width)[:3] + 1)


def test_22_is_not_consistent_to_first_order_in_q() -> None:
    """As Q goes to 0 the tongues of (21) move by Q times a constant, those of (22) by Q²."""
    for q in (1e-4, 1e-5):
        for model, least, most in ((EXACT, 0.5, 0.7), (APPROXIMATE, 0.0, 0.02)):
            found = tongues(shaft().coefficients, np.array([q]), 11, model, error=1e-12)
            shift = (found.edges[0, 10].mean() - 5.5) / q
            assert least <= shift <= most


# -- damping ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("model", "lo", "hi"), [(APPROXIMATE, 0.4727817089, 0.5122493880), (EXACT, 0.4757282863, 0.5246729308)]
)
def test_a_hundredth_of_damping_narrows_the_first_tongue(model: str, lo: float, hi: float) -> None:
    found = tongues(shaft().coefficients, np.array([0.1]), 1, model, damping=0.01)
    assert found.edges[0, 0] == pytest.approx([lo, hi], abs=1e-10)


def test_damping_closes_tongues_from_their_tips() -> None:
    """For each tongue the rows below some Q are closed and those above are open, and more damping raises that Q."""
    q = np.linspace(0.004, 0.12, 15)
    tips = []
    for damping in (0.001, 0.004, 0.016):
        found = tongues(shaft().coefficients, q, 5, EXACT, damping)
        opened = np.isfinite(found.edges).all(axis=2)
        free = tongues(shaft().coefficients, q, 5, EXACT)
        for n in range(5):
            rows = opened[:, n]
            assert not (rows[:-1] & ~rows[1:]).any(), "no tongue closes again as Q grows"
            inside = found.edges[rows, n]
            assert (inside[:, 0] > free.edges[rows, n, 0]).all()
            assert (inside[:, 1] < free.edges[rows, n, 1]).all()
        tips.append(np.where(opened.any(axis=0), opened.argmax(axis=0), q.size))
    assert (np.diff(tips, axis=0) >= 0).all()
    assert tips[0].tolist() < tips[1].tolist() < tips[2].tolist()
    assert (tips[2] > tips[0]).sum() >= 4


# -- time histories, Figs. 9-12 ---------------------------------------------------------------------------


@cache
def gone() -> dict[int, History]:
    return {number: run for number, at in FIGURES.items() for run in runs(EXAMPLES) if (run.eta, run.q) == at}


@pytest.mark.parametrize(
    ("figure", "largest", "within"),
    [(9, 0.096809987222, 1e-12), (11, 0.03073731393, 5e-12), (10, 0.148417, 5e-7), (12, 0.1724, 5e-5)],
)
def test_the_published_histories_reach_their_largest_wind_up(figure: int, largest: float, within: float) -> None:
    assert gone()[figure].largest[0] == pytest.approx(largest, abs=within)
    for row in REFERENCE["nonlinear_from_rest"]:
        if (row["eta"], row["Q"]) == FIGURES[figure]:
            assert gone()[figure].largest[0] == pytest.approx(row["max_wind_up"], abs=within)


@pytest.mark.parametrize("figure", FIGURES)
def test_each_model_says_its_own_of_the_published_points(figure: int) -> None:
    """Figs. 9 and 11 are stable in every model. Fig. 10 the paper calls unstable: every model says stable, a bounded beat.
    Fig. 12 it calls unstable: only (22) says so; its growth is a primary resonance, in which the follower leaves the cam.
    """
    eta, q = FIGURES[figure]
    approximate, exact = linear_verdicts(shaft().coefficients, eta, q)
    rest = rest_verdict(gone()[figure])
    assert approximate.stable is (figure != 12)
    assert exact.stable is True
    assert rest.stable is True, "the wind-up has passed its largest"
    if figure == 12:
        assert approximate.trace == pytest.approx(2.0036, abs=5e-5)
    # the paper: below Q = 0.1 the follower never leaves the cam
    wanted = {11: 2.2750, 12: 3.3019}.get(figure)
    assert rest.contact_lost == (None if wanted is None else pytest.approx(wanted, abs=5e-5))


@pytest.mark.parametrize(("figure", "y"), [(9, None), (11, 2.27504), (12, 3.30185)])
def test_the_follower_leaves_the_cam_where_another_integrator_says(figure: int, y: float | None) -> None:
    """Fig. 12: at y = 3.3019. A reading of the force every 200th of a turn, as Runge-Kutta steps would give it, is negative
    from 3.305 on: that figure is the same loss, seen later."""
    eta, q = FIGURES[figure]
    own, other = gone()[figure].contact_lost, leaves_cam(eta, q, 4.0)
    if y is None:
        assert own is None
        assert other is None
        return
    assert own == pytest.approx(y, abs=1e-5)
    assert own == pytest.approx(other, abs=1e-9)
    read = np.arange(1, 800) / 200.0
    force = gone()[figure].force(read)
    moving = np.mod(2.0 * np.pi * (read - gone()[figure].at(read)[0]), 2.0 * np.pi) < np.pi
    seen = read[moving & (force < 0.0)][0]
    assert seen == pytest.approx(np.ceil(200.0 * y) / 200.0)
    assert figure != 12 or seen == pytest.approx(3.305)


def test_in_the_dwell_there_is_no_force_and_no_loss() -> None:
    y = np.linspace(0.0, 30.0, 6001)
    for history in gone().values():
        theta = np.mod(2.0 * np.pi * (y - history.at(y)[0]), 2.0 * np.pi)
        assert not history.force(y)[(theta > np.pi + 1e-9) & (theta < 2.0 * np.pi - 1e-9)].any()
    assert gone()[9].contact_lost is gone()[10].contact_lost is None


def test_fig_11_loses_contact_again_and_again() -> None:
    """In 18 of its 30 turns; the first time little: a fortieth of the force that the start of the rise needs."""
    y = np.linspace(0.0, 30.0, 12001)
    force = gone()[11].force(y)
    turns = {int(at) for at in y[force < -1e-9]}
    assert (min(turns), len(turns)) == (2, 18)
    assert force[y < 3.0].min() == pytest.approx(-0.0228, abs=2e-4)
    assert force.min() < -0.4


@pytest.mark.stress
def test_averages_of_the_first_turn_fit_figures_6_and_7() -> None:
    """The mean wind-up stays within 0.02 for Q up to 0.1, and both means grow with Q and with speed; the follower stays on
    the cam as far as Q = 0.2, and leaves it at 0.5."""
    means = averages(EXAMPLES, (0.05, 0.1, 0.2, 0.5), 5.0)
    largest = means.wind_up.max(axis=1)
    assert 0.018 < largest[1] < 0.02 < largest[2]
    for rows in (means.wind_up, means.slope):
        assert (np.diff(rows[:3], axis=0) > 0.0).all()
    assert means.wind_up[1, 0] > 5.0 * means.wind_up[1, -1]
    assert means.is_contact_lost is not None
    assert means.is_contact_lost.any(axis=1).tolist() == [False, False, False, True]
