"""core.stability: what is drawn besides the chart, the means of the first turn, and what a study keeps of a shaft."""

from __future__ import annotations

import re

import numpy as np
import pytest
from mechanisms import LIFT, with_loads
from shafts import KIM, coefficients, kim_table, of, with_elastic

from core.output.report import report
from core.output.summary import summary
from core.stability import (
    averages_plots,
    coefficients_plot,
    first_guess,
    history,
    history_plot,
    mean_wind_up,
    tongues_of_order,
)
from core.stability.windup import etas
from core.study import Study

FEW = np.arange(0.5, 5.6, 0.5)


# -- means ------------------------------------------------------------------------------------------------


def test_means_are_those_of_each_history() -> None:
    found = of(KIM)
    means = mean_wind_up(found.coefficients, (0.05, 0.5), FEW[:5], 0.01, found.contact, periods=2.0)
    assert means.wind_up.shape == means.slope.shape == (2, 5)
    assert means.is_contact_lost is not None
    for row, column in ((0, 3), (1, 0), (1, 2)):
        one = history(found.coefficients, means.eta[column], means.q[row], 0.01, 2.0, contact=found.contact)
        assert (means.wind_up[row, column], means.slope[row, column]) == pytest.approx(one.averages(), rel=1e-9)
        assert means.is_contact_lost[row, column] == (one.contact_lost is not None)
    assert means.is_contact_lost.any()
    assert not means.is_contact_lost.all()


def test_a_far_chart_has_no_more_means_than_a_near_one() -> None:
    assert etas(5.6)[[0, 1, -1]] == pytest.approx([0.5, 0.55, 5.6])
    assert etas(20.0)[[0, -1]] == pytest.approx([0.5, 20.0])
    assert etas(20.0).size == etas(5.6).size == 103
    assert etas(0.4).tolist() == [0.5]


def test_the_rows_of_a_machine_are_kims_where_its_q_is_kims() -> None:
    assert of(KIM).averages(eta_max=0.5).q == pytest.approx([0.05, 0.1, 0.2, 0.5, 1.0])


# -- figures ----------------------------------------------------------------------------------------------


def test_means_are_solid_where_contact_is_kept_and_dashed_where_it_is_lost() -> None:
    found = of(KIM)
    means = mean_wind_up(found.coefficients, (0.05, 0.5), FEW, contact=found.contact)
    assert means.is_contact_lost is not None
    wind_up, slope = averages_plots(means)
    for plot, rows in ((wind_up, means.wind_up), (slope, means.slope)):
        kept, solid, dashed = plot.curves
        assert [c.label for c in plot.curves] == ["Q = 0.05", "0.5", ""]
        assert [c.row for c in plot.curves] == [0, 1, 1]
        assert [c.dashed for c in plot.curves] == [False, False, True]
        assert np.array_equal(kept.y, rows[0])
        assert np.array_equal(np.isnan(solid.y), means.is_contact_lost[1])
        assert np.array_equal(np.where(np.isnan(solid.y), dashed.y, solid.y), rows[1]), "no piece is missing"
        overlap = np.isfinite(solid.y) & np.isfinite(dashed.y)
        assert 1 <= overlap.sum() <= 2, "they meet"
        assert "dashed" in plot.note
    still = averages_plots(mean_wind_up(found.coefficients, (0.05,), FEW, contact=found.contact))
    assert not still[0].note


def test_terms_are_kims() -> None:
    plot = coefficients_plot(coefficients(KIM))
    degrees = plot.curves[0].x
    d, c, u, _, psi = kim_table(np.deg2rad(degrees[:-1]))
    for curve, row in zip(plot.curves, (psi, d, c, u), strict=True):
        assert np.abs(curve.y[:-1] - row).max() < 1e-11, curve.label
        assert curve.y[-1] == curve.y[0]
    assert [curve.label for curve in coefficients_plot(coefficients(KIM), ("ψ",)).curves] == ["ψ = U'"]


def test_a_history_is_marked_where_the_follower_leaves_the_cam() -> None:
    found = of(KIM)
    plot = history_plot(found.history(3.0, 2.1, 0.05))
    (curve,) = plot.curves
    assert np.abs(curve.y - history(found.coefficients, 2.1, 0.05, 0.0, 3.0).at(curve.x)[0]).max() < 1e-12
    assert [round(at, 4) for at, _ in plot.marks] == [2.275]
    assert history_plot(found.history(2.0, 2.1, 0.05)).marks == ()


# -- what a study keeps -----------------------------------------------------------------------------------


def test_the_last_history_is_kept_and_no_other() -> None:
    found = of(KIM)
    first = found.history(1.0, 2.1, 0.05)
    assert found.history(1.0, 2.1, 0.05) is first
    other = found.history(1.0, 2.2, 0.05)
    assert other.eta == 2.2
    assert found.history(1.0, 2.1, 0.05) is not first
    assert found.history(2.0, 2.1, 0.05).ended == 2.0
    own = found.history(1.0)
    assert (own.eta, own.q) == (found.machine.eta, found.machine.q)


def test_the_chart_reaches_as_far_as_the_machine() -> None:
    assert of(KIM).eta_max == 5.6
    slow = of(with_elastic(KIM, stiffness_nm_per_rad=85.0 * 9.0))
    assert slow.eta_max == pytest.approx(1.06 * slow.machine.eta)
    assert of(with_elastic(KIM, stiffness_nm_per_rad=85e4)).eta_max == 20.0


def test_the_certificate_and_the_report_say_what_error_was_reached() -> None:
    """A row that stays short of the wanted error is told, not hidden."""
    found = of(KIM)
    reached = float(found.exact.error.max())
    proof = found.certificate["tongue_error"]
    assert (proof.value, proof.kept) == (reached, True)
    study = Study(KIM, 36)
    told = summary(study, ("stability",))["stability"]
    assert (told["harmonics"], told["edge_error"]) == (found.exact.order, reached)
    assert re.search(rf"Error of an edge η +{reached:.0e}\n".replace("e-", "e\u2212"), report(study))
    poor = of(with_elastic(KIM, damping_ratio=1e-9))
    vars(poor)["exact"] = tongues_of_order(found.coefficients, np.array([0.05]), 11, 8)
    assert poor.certificate["tongue_error"].value == poor.exact.error.max() > 1e-8
    assert not poor.certificate["tongue_error"].kept


def test_a_first_guess_is_a_usual_shaft() -> None:
    study = Study(LIFT, 720)
    guess = first_guess(study.linkage, study.loading, study.omega)
    assert guess is not None
    machine = of(
        with_elastic(
            LIFT,
            camshaft_inertia_kg_m2=guess.camshaft_inertia_kg_m2,
            stiffness_nm_per_rad=guess.stiffness_nm_per_rad,
            spring="fixed",
        )
    ).machine
    assert (machine.q, machine.eta) == (pytest.approx(0.05, rel=0.01), pytest.approx(10.25, rel=0.01))
    nothing = Study(with_loads(KIM, follower_mass_kg=0.0), 36)
    assert first_guess(nothing.linkage, nothing.loading, nothing.omega) is None
