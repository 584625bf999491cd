"""core.stability in the words of a machine: speeds, stiffness, findings, verdicts, chart, study, report."""

import math
import re
from collections import Counter
from dataclasses import astuple, replace
from threading import Event

import numpy as np
import pytest
from mechanisms import LAYOUT_DESIGNS, LIFT, PUSHER, with_cam, with_loads, with_shaft
from sampled import spread
from shafts import HARD, KIM, KIM_SHAFT, coefficients, of, with_elastic

from core.design import Design, ElasticShaft, entries, faults, get, put
from core.design import with_elastic as with_shaft_of
from core.numerics.lazy import Cancelled, cancellable
from core.output.report import report
from core.output.summary import summary
from core.stability import (
    EXACT,
    Chart,
    Machine,
    bands,
    chart,
    count_up_to,
    monodromy,
    stiffness_for,
    tongues,
)
from core.study import STAGES, Study, certificate_of, evaluations, findings_of

RPM = 30.0 / np.pi  # revolutions per minute in one radian per second


def at_eta(eta: float, **values: float | str) -> Design:
    """Kim's machine with the shaft that puts it there."""
    inertia, omega = KIM_SHAFT.camshaft_inertia_kg_m2, 1500.0 / RPM
    return with_elastic(KIM, stiffness_nm_per_rad=inertia * (eta * omega) ** 2, **values)


# -- speeds -----------------------------------------------------------------------------------------------


def test_a_machine_knows_its_place_in_the_chart() -> None:
    machine = of(KIM).machine
    assert machine.eta == pytest.approx(math.sqrt(85.0 / 0.000324) / (1500.0 * math.pi / 30.0), rel=1e-15)
    assert machine.rpm(machine.eta) == pytest.approx(1500.0, rel=1e-14)
    assert machine.rpm(0.0) == math.inf
    inertia, stiffness = machine.shaft_for(2.1, 0.1)
    there = of(with_elastic(KIM, camshaft_inertia_kg_m2=inertia, stiffness_nm_per_rad=stiffness)).machine
    assert (there.eta, there.q) == (pytest.approx(2.1, rel=1e-13), pytest.approx(0.1, rel=1e-13))


@pytest.mark.parametrize("name", spread(["kim", "layout c"], 1))
def test_bands_are_tongues_as_speeds_with_their_largest_growth(name: str) -> None:
    found = of(HARD[name])
    row = tongues(found.coefficients, np.array([found.machine.q]), 6)
    told = bands(found.coefficients, found.machine, row)
    assert [b.n for b in told] == sorted(b.n for b in told)
    for band in told:
        assert band.rpm_lo < band.worst_rpm < band.rpm_hi
        for rpm in (band.rpm_lo, band.rpm_hi):
            turn = monodromy(found.coefficients, np.array([found.machine.natural * RPM / rpm]), row.q)
            assert abs(abs(turn.trace[0]) - 2.0) < 1e-6
        eta = np.linspace(band.eta_lo, band.eta_hi, 501)
        seen = monodromy(found.coefficients, eta, row.q).growth
        assert seen.max() <= band.growth * (1.0 + 1e-4)
        assert band.growth <= seen.max() * (1.0 + 1e-4)
        assert band.rate == pytest.approx(band.growth * band.worst_rpm / 60.0)
        assert band.contains(band.worst_rpm)
        assert band.distance(band.worst_rpm) == 0.0
        assert band.distance(2.0 * band.rpm_hi) == pytest.approx(0.5)


def test_faster_than_all_bands_is_infinite_where_the_first_tongue_reaches_zero() -> None:
    found = of(with_elastic(LIFT, camshaft_inertia_kg_m2=60.0, stiffness_nm_per_rad=1.6e6, spring="fixed"))
    first = found.bands[0]
    assert (first.n, first.eta_lo, first.rpm_hi) == (1, 0.0, math.inf)
    assert math.isfinite(first.rate)


# -- stiffness --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("spring", ["fixed", "retuned"])
def test_the_stiffness_that_is_told_keeps_clear_and_what_is_forbidden_grows(spring: str) -> None:
    """In the second tongue: on either side of it the shaft holds, whatever its loads make of the speed."""
    found = of(at_eta(1.005, spring=spring))
    needed = stiffness_for(found.coefficients, found.machine, 1500.0, 6)
    assert not needed.allowed
    assert needed.softer is not None
    assert needed.softer < needed.current < needed.stiffer
    for stiffness, grows in ((needed.stiffer, False), (needed.softer, False), (needed.current, True)):
        there = of(with_elastic(at_eta(1.005, spring=spring), stiffness_nm_per_rad=stiffness))
        assert (there.linear[-1].growth > 1e-3) is grows
    n, low, high = next(f for f in needed.forbidden if f[1] < needed.current < f[2])
    assert n == 2
    for edge in (low, high):
        there = of(with_elastic(at_eta(1.005, spring=spring), stiffness_nm_per_rad=edge))
        assert abs(there.linear[-1].trace - 2.0) < 1e-6


def test_a_shaft_that_is_clear_may_stay() -> None:
    found = of(KIM)
    needed = found.stiffness_for(1500.0)
    assert needed.allowed
    assert needed.stiffer == needed.softer == needed.current == 85.0
    assert not found.stiffness_for(1500.0 * found.machine.eta / 1.005).allowed


# -- findings ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("design", "code", "severity"),
    [
        (at_eta(1.0), "unstable-speed", "error"),
        (at_eta(3.01838), "unstable-speed", "warning"),
        (at_eta(1.03), "near-unstable-speed", "note"),
        (at_eta(1.25), "", ""),
        (at_eta(1.0, damping_ratio=0.06), "", ""),
    ],
)
def test_the_own_speed_among_the_bands_is_told(design: Design, code: str, severity: str) -> None:
    told = findings_of(Study(design, 36), ("stability",))
    assert [(f.code, f.severity) for f in told] == ([(code, severity)] if code else [])
    for finding in told:
        assert finding.field == "shaft.stiffness_nm_per_rad"
        assert "1500 rpm" in finding.message
        low, high = re.findall(r"([\d.]+) \.\.\. ([\d.]+) rpm", finding.message)[0]
        assert (float(low) < 1500.0 < float(high)) is (code == "unstable-speed")


def test_far_beyond_the_chart_the_growth_of_the_own_point_decides() -> None:
    found = of(KIM)
    edges = tongues(found.coefficients, np.array([0.05]), 131, error=1e-10).edges[0, 130]
    inside = at_eta(float(edges.mean()))
    told = findings_of(Study(inside, 36), ("stability",))
    assert [f.code for f in told] == ["unstable-shaft"]
    assert "% per turn" in told[0].message


# -- verdicts ---------------------------------------------------------------------------------------------


@pytest.mark.stress
def test_verdicts_stand_side_by_side() -> None:
    found = of(KIM)
    told = found.verdicts(2.1, 0.05)
    assert [v.model for v in told] == ["approx_22", "exact_21", "steady", "from_rest"]
    assert all(v.label for v in told)
    assert told[0].trace == pytest.approx(1.6224, abs=1e-4)
    assert told[1].trace == pytest.approx(1.7083, abs=1e-4)
    assert told[2].trace == pytest.approx(1.6957, abs=1e-4)
    assert told[3].contact_lost == pytest.approx(2.2750, abs=1e-4)
    assert told[3].largest > told[2].largest > 0.01
    assert found.own_verdicts[:2] == found.linear


# -- chart ------------------------------------------------------------------------------------------------


def test_the_chart_is_edges_and_the_machine_stands_in_it() -> None:
    found = of(KIM)
    drawn = chart(found.coefficients, found.machine, "Kim", rows=12)
    assert isinstance(drawn, Chart)
    assert (np.diff(drawn.q) > 0.0).all()
    assert drawn.q[-1] >= 1.2 * found.machine.q
    assert drawn.tongues[EXACT].edges.shape == (12, 11, 2)
    assert drawn.machine is found.machine
    for n in (1, 4, 11):
        (outline,) = drawn.outline(n)
        assert outline[0].tolist() == [0.5 * n, 0.0], "from its tip"
        assert outline.shape == (25, 2)
        turned = np.roll(outline, -1, axis=0)
        area = 0.5 * abs((outline[:, 0] * turned[:, 1] - turned[:, 0] * outline[:, 1]).sum())
        width = drawn.tongues[EXACT].edges[:, n - 1, 1] - drawn.tongues[EXACT].edges[:, n - 1, 0]
        assert area == pytest.approx(np.trapezoid(np.append(0.0, width), np.append(0.0, drawn.q)), rel=1e-9)


def test_a_damped_chart_has_no_tips_at_zero() -> None:
    found = of(with_elastic(KIM, damping_ratio=0.01))
    drawn = chart(found.coefficients, found.machine, rows=10, damping=0.01)
    assert drawn.outline(9) == []
    (outline,) = drawn.outline(1)
    assert outline[:, 1].min() > 0.0


@pytest.mark.parametrize("eta", spread([1.02, 2.53, 14.03], 1))
def test_the_bands_near_the_machine_are_those_of_all_that_are(eta: float) -> None:
    found = of(at_eta(eta))
    rpm = found.machine.rpm(eta)
    near = sorted(found.bands, key=lambda band: band.distance(rpm))[: len(found.near_bands)]
    assert 0 < len(near) < len(found.bands)
    for one, other in zip(found.near_bands, sorted(near, key=lambda band: band.n), strict=True):
        assert astuple(one) == pytest.approx(astuple(other), rel=1e-12, abs=1e-13)


def test_findings_of_a_slow_machine_look_at_the_bands_near_it_alone() -> None:
    """There may be a hundred: they are computed for whoever asks for them, not at every edit."""
    study = Study(at_eta(14.03))
    findings_of(study, ("stability",))
    assert study.stability is not None
    assert "near_bands" in vars(study.stability)
    assert "bands" not in vars(study.stability)


def test_a_chart_that_nobody_wants_any_more_stops() -> None:
    found, flag = of(KIM), Event()
    flag.set()
    with cancellable(flag), pytest.raises(Cancelled):
        chart(found.coefficients, found.machine, rows=3)
    assert chart(found.coefficients, found.machine, rows=3).q.size == 3


def test_marked_rows_are_in_sight() -> None:
    found = of(KIM)
    drawn = chart(found.coefficients, None, rows=4, marked=(0.4,))
    assert drawn.q[-1] > 0.4
    assert drawn.machine is None
    assert [count_up_to(eta) for eta in (0.3, 0.5, 5.6, 6.0)] == [1, 1, 11, 12]


# -- study ------------------------------------------------------------------------------------------------


def counted(design: Design) -> Counter[str]:
    before = Counter(evaluations)
    study = Study(design, 36)
    assert study.stability is not None
    return Counter(evaluations) - before


def test_a_flexible_shaft_is_studied_once_and_kept() -> None:
    assert counted(KIM) == {"stability": 1}, "it samples no motion and solves no linkage of the study"
    assert counted(KIM) == {}
    assert counted(replace(KIM, name="another", assumed=("shaft.speed_rpm",))) == {}
    assert counted(with_shaft(KIM, flywheel_inertia_kg_m2=3.0)) == {}


@pytest.mark.parametrize(
    "change",
    [
        lambda d: with_shaft(d, speed_rpm=1000.0),
        lambda d: with_elastic(d, damping_ratio=0.01),
        lambda d: with_shaft(d, rotation="cw"),
        lambda d: with_cam(d, base_radius_mm=31.0, roller_radius_mm=9.0),
    ],
)
def test_what_leaves_the_coefficients_alone_keeps_them(change: object) -> None:
    one = of(KIM).coefficients
    other = Study(change(KIM), 36).flexible_shaft()
    assert other.coefficients is one
    assert other is not of(KIM)


@pytest.mark.parametrize(
    "change",
    [
        lambda d: with_loads(d, follower_mass_kg=0.3),
        lambda d: with_elastic(d, camshaft_inertia_kg_m2=0.001),
        lambda d: with_elastic(d, spring="fixed"),
        lambda d: with_elastic(d, spring_factor=2.0),
    ],
)
def test_what_touches_the_coefficients_makes_new_ones(change: object) -> None:
    one, other = of(KIM).coefficients, Study(change(KIM), 36).flexible_shaft().coefficients
    assert other is not one
    assert other.q != one.q or not np.array_equal(other.panels.values, one.panels.values)


def test_the_other_stages_do_not_mind_the_shaft() -> None:
    rigid = with_shaft_of(KIM, None)
    assert np.array_equal(Study(rigid, 36).dynamics.torque, Study(KIM, 36).dynamics.torque)
    assert findings_of(Study(rigid, 36)) == findings_of(Study(KIM, 36))


@pytest.mark.parametrize("name", HARD)
def test_the_certificate_is_kept(name: str) -> None:
    proof = certificate_of(Study(HARD[name], 36), ("stability",))
    assert set(proof) == {"tongue_residual", "tongue_error", "liouville"}
    assert all(residual.kept for residual in proof.values()), proof


@pytest.mark.stress
def test_the_report_and_the_summary_tell_of_the_shaft_where_it_bends() -> None:
    text = report(Study(at_eta(0.5), 36))
    section = text.split("Stability of the flexible shaft\n")[1].split("\nFindings\n")[0]
    assert re.search(r"tongue 1 +14\d\d\.\d+ +15\d\d\.\d+", section)
    assert "unstable" in section
    assert "a stiffness from" in section
    assert "error: 1500 rpm is in a forbidden band" in text
    told = summary(Study(KIM, 36), ("stability",))["stability"]
    assert told["q"] == pytest.approx(0.05)
    assert [b["n"] for b in told["bands"]] == list(range(1, 12))
    assert told["verdicts"][1]["stable"] is True
    for rigid in (PUSHER, LAYOUT_DESIGNS["a"]):
        assert "Stability" not in report(Study(rigid, 36))
        assert "stability" not in summary(Study(rigid, 36), STAGES)


# -- the design -------------------------------------------------------------------------------------------


def test_a_rigid_shaft_has_no_entries_of_elasticity_and_a_flexible_one_has_them_flat() -> None:
    names = ["camshaft_inertia_kg_m2", "stiffness_nm_per_rad", "damping_ratio", "spring", "spring_factor"]
    assert not any(e.path.endswith(tuple(names)) for e in entries(PUSHER, "shaft"))
    flexible = with_shaft_of(PUSHER, ElasticShaft(0.5, 900.0))
    assert [e.path for e in entries(flexible, "shaft")][-5:] == [f"shaft.{n}" for n in names]
    assert all(e.info.label for e in entries(flexible, "shaft"))
    changed = put(flexible, "shaft.stiffness_nm_per_rad", 901.0)
    assert get(changed, "shaft.stiffness_nm_per_rad") == 901.0
    assert get(put(changed, "shaft.spring", "retuned"), "shaft.spring") == "retuned"
    for path in ("shaft.stiffness_nm_per_rad", "shaft.spring"):
        with pytest.raises(KeyError):
            get(PUSHER, path)
        with pytest.raises(KeyError):
            put(PUSHER, path, 1.0)


def test_a_shaft_made_rigid_again_is_assumed_no_more() -> None:
    flexible = replace(
        with_shaft_of(PUSHER, ElasticShaft(0.5, 900.0)), assumed=("shaft.speed_rpm", "shaft.stiffness_nm_per_rad")
    )
    rigid = with_shaft_of(flexible, None)
    assert rigid.assumed == ("shaft.speed_rpm",)
    assert rigid.shaft == PUSHER.shaft


@pytest.mark.parametrize(
    ("key", "value"),
    [("camshaft_inertia_kg_m2", 0.0), ("stiffness_nm_per_rad", -1.0), ("damping_ratio", 1.0), ("spring", "loose"),
     ("spring_factor", -0.1), ("stiffness_nm_per_rad", math.nan)],
)  # fmt: skip
def test_values_out_of_range_are_faults_with_their_path(key: str, value: float | str) -> None:
    told = faults(with_elastic(KIM, **{key: value}))
    assert [f.path for f in told] == [f"shaft.{key}"]
    assert not faults(KIM)


def test_machines_of_plain_numbers() -> None:
    machine = Machine(2.0, 800.0, 10.0, 0.0, 0.1, 0.2)
    assert (machine.natural, machine.eta) == (20.0, 2.0)
    assert coefficients(KIM).fixed is False
