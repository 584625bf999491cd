"""core.stability: tongue edges, by harmonic balance and by monodromy matrices, and what both say they may be wrong by."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanisms import LIFT, SMOOTH, with_drive, with_loads
from sampled import spread
from shafts import HARD, KIM, coefficients, moved, of, with_elastic

from core.design import Design, Motion
from core.errors import NoStability
from core.stability import (
    APPROXIMATE,
    EXACT,
    Coefficients,
    Tongues,
    chart,
    harmonic_tongues,
    monodromy,
    refined,
    tongues,
    tongues_of_order,
)
from core.stability.coefficients import LOAD_SLOPE, fourier
from core.stability.critical_speeds import coefficients_at_speed
from core.study import Study, certificate_of, findings_of

MODELS = (APPROXIMATE, EXACT)
Q = np.array([1e-6, 0.02, 0.3, 1.0])


def agree(one: Tongues, other: Tongues) -> None:
    """Each edge to within what both say they may be wrong by."""
    apart = np.abs(one.edges - other.edges).max(axis=2)
    assert (apart <= one.error + other.error).all(), (apart / (one.error + other.error)).max()


# -- two ways ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", spread(MODELS, 5))
@pytest.mark.parametrize("name", HARD)
def test_harmonic_balance_and_monodromy_agree_within_their_stated_errors(name: str, model: str) -> None:
    found = coefficients(HARD[name])
    by_harmonics = harmonic_tongues(found, Q, 9, model, error=1e-9, most_order=34)
    by_matrices = refined(found, by_harmonics)
    agree(by_harmonics, by_matrices)
    assert by_matrices.error.max() < 1e-10
    assert (np.diff(by_matrices.edges.reshape(Q.size, -1), axis=1) >= -1e-15).all(), "edges rise with n"


def shafts() -> st.SearchStrategy[Design]:
    """Kim's machine with a rise, a dwell or none, a return and another dwell or none, of any smooth law or parabolic."""
    laws = st.sampled_from([*SMOOTH, "parabolic"])
    spans = st.tuples(st.floats(25.0, 120.0), st.sampled_from([0.0, 40.0, 90.0]), st.floats(25.0, 120.0))

    def build(spans: tuple[float, float, float], up: str, down: str, spring: str, rest: bool) -> Design:
        rise, top, fall = spans
        if not rest:
            fall = 360.0 - rise - top
        steps = [(rise, 9.0, up), *([(top, 9.0, "dwell")] if top else []), (fall, 0.0, down)]
        left = 360.0 - rise - top - fall
        return moved(*steps, *([(left, 0.0, "dwell")] if rest else []), spring=spring)

    return st.builds(build, spans, laws, laws, st.sampled_from(["fixed", "retuned"]), st.booleans())


@settings(max_examples=13)
@given(shafts(), st.floats(1e-6, 1.0))
def test_any_cam_has_the_same_tongues_both_ways(design: Design, q: float) -> None:
    found = coefficients(design)
    by_harmonics = harmonic_tongues(found, np.array([q]), 7, EXACT, error=1e-9, most_order=28)
    agree(by_harmonics, refined(found, by_harmonics))


@settings(max_examples=13)
@given(shafts(), st.floats(1e-3, 1.0))
def test_between_the_edges_it_grows_and_between_the_tongues_it_does_not(design: Design, q: float) -> None:
    found = coefficients(design)
    edges = tongues(found, np.array([q]), 5, EXACT, error=1e-11).edges[0]
    wide = edges[:, 1] - edges[:, 0] > 1e-6
    inside = monodromy(found, edges.mean(axis=1)[wide], np.array([q]))
    assert (np.abs(inside.trace) > 2.0).all()
    gaps = 0.5 * (edges[:-1, 1] + edges[1:, 0])
    assert (np.abs(monodromy(found, gaps[gaps > 0.0], np.array([q])).trace) < 2.0).all()


def test_an_edge_of_the_wrong_tongue_would_be_noticed() -> None:
    """The stated errors are no loose excuse: they are a thousandth of the tongues' distance at most, and far less of
    their widths."""
    found = harmonic_tongues(coefficients(KIM), np.array([0.05]), 11)
    assert found.error.max() < 1e-8
    assert (found.edges[0, :, 1] - found.edges[0, :, 0] > 1e3 * found.error[0]).all()


# -- order ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", MODELS)
def test_orders_beyond_fifty_lose_no_digit(model: str) -> None:
    """Where rounding of η² would have eaten 1e-12 at 50 harmonics and 1e-11 at 200."""
    found = coefficients(KIM)
    best = refined(found, tongues_of_order(found, np.array([0.05]), 11, 24, model))
    for order in (50, 100, 200):
        again = tongues_of_order(found, np.array([0.05]), 11, order, model)
        assert np.abs(again.edges - best.edges).max() < 2e-14
        assert np.abs(again.edges - best.edges).max() < again.error.max() < 1e-12
        assert again.order == order


def test_more_harmonics_bring_the_stated_error_down_and_it_stays_above_the_true_one() -> None:
    for name in ("kim", "parabolic"):
        found = coefficients(HARD[name])
        best = refined(found, harmonic_tongues(found, np.array([0.3]), 7))
        stated, true = [], []
        for order in (8, 12, 18, 27, 40):
            each = tongues_of_order(found, np.array([0.3]), 7, order)
            stated.append(float(each.error.max()))
            true.append(float(np.abs(each.edges - best.edges).max()))
        assert (np.diff(stated) < 0.0).all()
        assert all(t <= s for t, s in zip(true, stated, strict=True))
        assert stated[-1] < 1e-6 * stated[0] if name == "kim" else stated[-1] < 1e-2 * stated[0]


def test_the_order_is_the_least_that_reaches_the_wanted_error() -> None:
    orders = [harmonic_tongues(coefficients(KIM), np.array([0.05]), 11, error=e) for e in (1e-8, 1e-10, 5e-12)]
    assert orders[0].order < orders[1].order < orders[2].order
    for each, wanted in zip(orders, (1e-8, 1e-10, 5e-12), strict=True):
        assert each.error.max() <= wanted


def test_an_error_that_the_most_harmonics_do_not_reach_is_told_or_refined() -> None:
    found = coefficients(HARD["parabolic"])
    poor = harmonic_tongues(found, np.array([1.0]), 11, error=1e-12, most_order=20)
    assert (poor.order, poor.error.max() > 1e-12) == (20, True)
    fine = tongues(found, np.array([1.0]), 11, error=1e-12, most_order=20)
    assert fine.error.max() < 1e-11
    assert fine.method != poor.method
    agree(poor, fine)


def test_too_few_harmonics_for_the_tongues_asked_for_are_refused() -> None:
    with pytest.raises(ValueError, match="12 tongues need harmonics up to 6"):
        tongues_of_order(coefficients(KIM), np.array([0.05]), 12, 5)


def test_rows_together_are_rows_alone() -> None:
    found, q = coefficients(KIM), np.linspace(0.001, 0.9, 9)
    whole = harmonic_tongues(found, q, 8)
    for i in (0, 4, 8):
        agree(
            Tongues(
                **{**vars(whole), "q": q[i : i + 1], "edges": whole.edges[i : i + 1], "error": whole.error[i : i + 1]}
            ),
            harmonic_tongues(found, q[i : i + 1], 8),
        )


# -- what does not matter ---------------------------------------------------------------------------------

STEPS = ((70.0, 9.0, "parabolic"), (30.0, 9.0, "dwell"), (110.0, 0.0, "cycloidal"), (150.0, 0.0, "dwell"))
BACK = ((110.0, 9.0, "cycloidal"), (30.0, 9.0, "dwell"), (70.0, 0.0, "parabolic"), (150.0, 0.0, "dwell"))


@pytest.mark.parametrize("spring", ["fixed", "retuned"])
def test_a_motion_run_backwards_has_the_same_tongues(spring: str) -> None:
    one, other = (tongues(coefficients(moved(*s, spring=spring)), Q, 7, error=1e-11) for s in (STEPS, BACK))
    agree(one, other)
    assert one.edges[2, 0, 1] - one.edges[2, 0, 0] > 1e-3


@pytest.mark.parametrize("spring", ["fixed", "retuned"])
def test_where_the_turn_begins_does_not_matter(spring: str) -> None:
    motion = moved(*STEPS, spring=spring).drive.motion
    shifted = Motion(9.0, (*motion.segments[1:], motion.segments[0]), "mm")
    design = with_drive(moved(*STEPS, spring=spring), motion=shifted)
    agree(
        tongues(coefficients(moved(*STEPS, spring=spring)), Q, 7, error=1e-11),
        tongues(coefficients(design), Q, 7, error=1e-11),
    )


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_size_does_not_matter(scale: float) -> None:
    """Masses and the shaft's inertia a thousand times as large: the same Q; stiffness only moves η."""
    large = with_elastic(
        with_loads(KIM, follower_mass_kg=0.2 * scale),
        camshaft_inertia_kg_m2=0.000324 * scale,
        stiffness_nm_per_rad=3.0 * scale,
    )
    one, other = coefficients(KIM), coefficients(large)
    assert other.q == pytest.approx(one.q, rel=1e-14)
    agree(tongues(one, Q, 7, error=1e-11), tongues(other, Q, 7, error=1e-11))


def test_the_sense_of_rotation_and_the_cam_do_not_matter() -> None:
    for change in (
        lambda d: replace(d, shaft=replace(d.shaft, rotation="cw")),
        lambda d: with_drive(d, cam=replace(d.drive.cam, base_radius_mm=55.0)),
    ):
        assert np.array_equal(coefficients(KIM).panels.values, coefficients(change(KIM)).panels.values)


def test_a_fixed_spring_is_the_retuned_one_at_the_speed_it_was_tuned_for() -> None:
    """Held at the loads of one speed, the fixed spring's equation is that of a retuned one: the traces at that η are the
    same, and so is what a stiffer shaft would do."""
    found = of(HARD["layout c"])
    eta = found.machine.eta
    held = coefficients_at_speed(found.coefficients, eta)
    q = np.array([found.machine.q])
    assert held.spring == "retuned"
    one, other = (monodromy(c, np.array([eta]), q) for c in (found.coefficients, held))
    assert np.abs(one.matrix - other.matrix).max() < 1e-12 * np.abs(one.matrix).max()
    elsewhere = [monodromy(c, np.array([eta + 0.7]), q).trace[0] for c in (found.coefficients, held)]
    assert abs(elsewhere[0] - elsewhere[1]) > 1e-4


# -- narrow, closed, at the edge of the chart -------------------------------------------------------------


def test_the_first_order_widths_are_the_fourier_coefficients() -> None:
    """(22) for small Q: the edges of tongue n stand at η² = n²/4 ± Q |ψ_n|."""
    for name in ("kim", "parabolic", "no dwell"):
        found = coefficients(HARD[name])
        psi = np.abs(fourier(found.panels, found.panels.values[LOAD_SLOPE], 11))[1:]
        edges = tongues(found, np.array([1e-7]), 11, APPROXIMATE, error=1e-13).edges[0]
        width = (edges[:, 1] - edges[:, 0]) * np.arange(1, 12)  # η times 2 is n
        assert np.abs(width - 2e-7 * psi).max() < 1e-13 + 2e-7 * 2e-6


@pytest.mark.parametrize("n", [1, 4, 7])
def test_tongues_a_millionth_wide_keep_both_edges(n: int) -> None:
    """Found as pairs: neither is lost, swapped or blurred by the other, down to widths of 1e-9."""
    found = coefficients(KIM)
    psi = abs(fourier(found.panels, found.panels.values[LOAD_SLOPE], n)[n])
    for width in (1e-6, 1e-9):
        q = np.array([0.5 * width * n / psi]) if psi > 1e-9 else np.array([width])
        pair = tongues(found, q, n, APPROXIMATE, error=1e-13).edges[0, n - 1]
        again = refined(found, harmonic_tongues(found, q, n, APPROXIMATE)).edges[0, n - 1]
        assert np.abs(pair - again).max() < 1e-14
        assert pair[1] - pair[0] == pytest.approx(2.0 * q[0] * psi / n, abs=1e-14 + 1e-3 * width)


def test_a_cam_of_two_equal_halves_closes_the_odd_tongues() -> None:
    """Its period is half a turn: what the dwell of Kim's cam opens is shut, to rounding."""
    twice = moved(
        (90.0, 9.0, "simple-harmonic"),
        (90.0, 0.0, "simple-harmonic"),
        (90.0, 9.0, "simple-harmonic"),
        (90.0, 0.0, "simple-harmonic"),
    )
    edges = tongues(coefficients(twice), np.array([0.2]), 9, error=1e-13).edges[0]
    width = edges[:, 1] - edges[:, 0]
    assert width[::2].max() < 1e-13
    assert width[1] > 0.05


def test_near_eta_zero_edges_stay_real_and_the_bottom_is_told() -> None:
    """η² of the lowest edges may be negative: then they stand at 0; where it is positive all below it is unstable."""
    found = coefficients(LIFT_RETUNED)
    q = np.linspace(0.05, 3.0, 20)
    row = tongues(found, q, 4, error=1e-10)
    assert (row.edges >= 0.0).all()
    assert (row.edges[-1, 0] == 0.0).any()
    assert np.isfinite(row.error).all()
    for i in np.flatnonzero(row.bottom > 1e-3):
        below = monodromy(found, np.array([0.9 * row.bottom[i]]), q[i : i + 1])
        assert below.trace[0] > 2.0


LIFT_RETUNED = with_elastic(LIFT, camshaft_inertia_kg_m2=60.0, stiffness_nm_per_rad=1.6e6)


def test_a_load_stiffer_than_the_shaft_still_has_its_tongues() -> None:
    """1 + Qψ1 below zero in places: η² is found from a pencil that is definite, not from its weight."""
    soft = with_elastic(HARD["fixed"], stiffness_nm_per_rad=2.0)
    found = coefficients(soft)
    assert (1.0 + found.q * found.panels.values[LOAD_SLOPE]).min() < -0.2
    by_harmonics = harmonic_tongues(found, np.array([found.q]), 5, error=1e-9, most_order=34)
    agree(by_harmonics, refined(found, by_harmonics))


def test_a_load_far_stiffer_than_the_shaft_is_told() -> None:
    study = Study(with_elastic(HARD["fixed"], stiffness_nm_per_rad=1e-3), 8)
    assert [f.code for f in findings_of(study, ("stability",))] == ["no-stability"]
    assert certificate_of(study, ("stability",)) == {}
    with pytest.raises(NoStability, match="does not hold the cam"):
        _ = study.flexible_shaft().exact


def test_q_far_beyond_one_says_how_well_it_is_known() -> None:
    found = coefficients(KIM)
    row = tongues(found, np.array([20.0]), 7)
    turn = monodromy(found, row.edges[row.edges > 0.0], np.array([20.0]))
    assert row.error.max() < 1e-7
    assert np.abs(np.abs(turn.trace) - 2.0).max() < 1e-6


@pytest.mark.stress
def test_edges_at_the_largest_q_are_found_from_more_harmonics() -> None:
    """Between two wide tongues the shaft is stable for 1e-4 of η only: forty harmonics begin too far from it."""
    found, far = coefficients(HARD["lift"]), np.array([100.0])
    row = tongues(found, far, 9)
    assert row.order > 40
    edges, sign = row.edges.ravel(), np.repeat(np.where(np.arange(9) % 2 == 0, -2.0, 2.0), 2)
    turn = monodromy(found, edges[edges > 0.0], far)
    off = np.abs(turn.trace - sign[edges > 0.0])
    assert (off <= 1e-6 * np.maximum(1.0, np.abs(np.trace(turn.slope, axis1=1, axis2=2)) * 1e-3)).all()
    poor = tongues(found, far, 9, most_order=20)
    agree(poor, row)


def test_an_approximation_at_the_largest_q_is_answered() -> None:
    """The valve spring is made for the speed, so no load is stiffer than the shaft however large Q is."""
    found, far = coefficients(KIM), np.array([100.0])
    edges = tongues(found, far, 4, APPROXIMATE).edges
    assert np.array_equal(edges, np.zeros((1, 4, 2))), "η² is negative at all of them, so far do they lean"
    more = tongues(found, far, 11, APPROXIMATE)
    assert more.edges[0, -1, 0] > 2.0
    assert more.error.max() < 1e-6
    agree(more, tongues_of_order(found, far, 11, 70, APPROXIMATE))


def test_a_refusal_names_the_row_that_asks_too_much() -> None:
    with pytest.raises(NoStability, match=r"at Q = 20 the load is stiffer than the shaft.* or decrease Q"):
        tongues(coefficients(HARD["fixed"]), np.array([0.05, 20.0]), 4)


def test_a_chart_ends_where_a_fixed_load_would_be_stiffer_than_the_shaft() -> None:
    """A machine that has an answer has a chart, though there is none at 1.6 times its Q."""
    kim = HARD["fixed"]
    largest = of(kim).machine.inertia
    heavy = of(with_elastic(kim, camshaft_inertia_kg_m2=largest / 2.0, stiffness_nm_per_rad=85.0 / 40.0))
    assert heavy.machine.q == pytest.approx(2.0)
    with pytest.raises(NoStability):
        heavy.tongues(q=3.2)
    drawn = chart(heavy.coefficients, heavy.machine, rows=4)
    assert drawn.q[-1] == pytest.approx(2.0)
    assert chart(coefficients(kim), of(kim).machine, rows=4).q[-1] == pytest.approx(0.12)


# -- damping ----------------------------------------------------------------------------------------------


def companion(found: Coefficients, q: float, damping: float, order: int) -> np.ndarray:
    """All edges with damping, by harmonic balance: the real eigenvalues η of
    (R T[D] R - Q T[ψ+κ] - 2iζηR - η²) a = 0, made linear."""
    rows, span = found.panels.values, 2 * order + 1
    d, c, pull = (fourier(found.panels, rows[i], span) for i in (0, 1, LOAD_SLOPE))
    real = []
    for half in (False, True):
        r = np.arange(-order, order) + 0.5 if half else np.arange(-order, order + 1.0)
        at = (np.arange(r.size)[:, None] - np.arange(r.size)).astype(int)
        t = [np.where(at >= 0, f[np.abs(at)], f[np.abs(at)].conj()) for f in (d, 1j * np.arange(span + 1) * c, pull)]
        stiff = np.diag(r * r) + q * (r[:, None] * t[0] * r - t[1] - t[2])
        whole = np.block([[np.zeros(stiff.shape), np.eye(r.size)], [stiff, -2j * damping * np.diag(r)]])
        eta = np.linalg.eigvals(whole)
        real.append(eta.real[(np.abs(eta.imag) < 1e-6) & (eta.real > 0.1)])
    return np.sort(np.concatenate(real))


@pytest.mark.parametrize("damping", [0.002, 0.01, 0.02])
def test_damped_edges_are_those_of_the_quadratic_eigenvalue_problem(damping: float) -> None:
    found = coefficients(KIM)
    edges = tongues(found, np.array([0.1]), 9, damping=damping).edges[0]
    by_harmonics = companion(found, 0.1, damping, 40)
    opened = edges[np.isfinite(edges[:, 0])].ravel()
    assert by_harmonics[by_harmonics < 4.6] == pytest.approx(np.sort(opened), abs=2e-7)


def test_with_damping_an_edge_is_where_a_multiplier_is_one() -> None:
    found = coefficients(HARD["layout c"])
    row = tongues(found, np.array([0.2, 0.6]), 6, damping=0.01)
    opened = np.isfinite(row.edges).all(axis=2)
    assert opened.any()
    assert not opened.all()
    for i, j in zip(*np.nonzero(opened), strict=True):
        turn = monodromy(found, row.edges[i, j], row.q[i : i + 1], EXACT, 0.01)
        sign = 1.0 if j % 2 else -1.0
        # det(M - s) = 1 - s trace + det
        assert np.abs(1.0 - sign * turn.trace + turn.det).max() < 1e-9
    for i, j in zip(*np.nonzero(~opened), strict=True):
        near = np.linspace(0.5 * j + 0.3, 0.5 * j + 0.7, 200)
        assert monodromy(found, near, row.q[i : i + 1], EXACT, 0.01).growth.max() < 1e-9


def test_the_tip_of_a_damped_tongue_is_found_from_both_sides() -> None:
    """Just open, then just closed, a millionth of Q apart."""
    found = coefficients(KIM)
    low, high = 0.0, 0.1
    for _ in range(22):
        middle = 0.5 * (low + high)
        if np.isnan(tongues(found, np.array([middle]), 2, damping=0.02).edges[0, 1, 0]):
            low = middle
        else:
            high = middle
    edges = tongues(found, np.array([high]), 2, damping=0.02).edges[0, 1]
    assert 0.0 <= edges[1] - edges[0] < 1e-3
    assert 0.02 < high < 0.1
