"""The elastic follower: against closed forms of the one mass, an integration from outside, and the balance of its energy."""

import cmath
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mechanisms import with_loads
from scipy.integrate import solve_ivp

from core.__main__ import main
from core.design import Design, Motion, NamedCurve, PolynomialCurve, Segment, edited, only, with_drive
from core.errors import DesignError, NoSolution
from core.output.export import files
from core.output.report import report
from core.project import from_table, load, save, to_table
from core.study import Study, certificate_of, extremes_of, findings_of, quantities_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
STIFFNESS, RATIO = "loads.follower_stiffness_n_per_mm", "loads.follower_damping_ratio"
MASS, K, RISE, SPAN = 0.5, 80.0, 8.0, 75.0  # kg, N/mm, mm, deg
NATURAL = math.sqrt(K * 1e3 / MASS)


def tappet(law: str, rpm: float = 600.0, ratio: float = 0.0, spring: float = 0.0) -> Design:
    """A mass on a flat face that rises and returns by one law between dwells."""
    curve = PolynomialCurve() if law == "polynomial" else NamedCurve(law)
    rows = (
        (60.0, 0.0, NamedCurve("dwell")),
        (SPAN, RISE, curve),
        (100.0, 0.0, NamedCurve("dwell")),
        (125.0, -RISE, curve),
    )
    motion = Motion(0.0, tuple(Segment(*row) for row in rows))
    design = load(EXAMPLES / "tappet_flat.toml")
    design = with_drive(design, motion=motion, cam=replace(design.drive.cam, base_radius_mm=60.0))
    loads = {"follower_mass_kg": MASS, "spring_rate_n_per_mm": spring, "preload_n": 400.0, "friction": 0.0}
    return edited(
        with_loads(design, **loads, follower_stiffness_n_per_mm=K, follower_damping_ratio=ratio), "shaft.speed_rpm", rpm
    )


def at_periods(law: str, periods: float) -> float:
    """Residual of the rise, parts of it, where it takes so many natural periods."""
    design = tappet(law, rpm=60.0 * SPAN / 360.0 * NATURAL / (2.0 * math.pi * periods))
    return 1e3 * Study(design).follower_response.residuals[1].from_rest / RISE


def test_rises_leave_the_residuals_of_their_closed_forms() -> None:
    """e'' + ν² e = -s'' over the rise 0 ... 1, ν = 2πn: the amplitude |∫ s'' e^{-iνu} du|/ν, by hand for each law."""
    for n in (1.3, 2.5, 3.25, 7.6):
        nu, half = 2.0 * math.pi * n, math.pi * n
        sin, cos = math.sin(half), math.cos(half)
        by_hand = {
            "cycloidal": sin / (math.pi * n * (n * n - 1.0)),
            "simple-harmonic": cos / (4.0 * n * n - 1.0),
            "polynomial": (120.0 * sin / nu**2 + 720.0 * cos / nu**3 - 1440.0 * sin / nu**4) / nu,
        }
        for law, value in by_hand.items():
            assert at_periods(law, n) == pytest.approx(abs(value), rel=1e-10), (law, n)


def test_residuals_vanish_at_the_known_speeds_and_stay_finite_in_resonance() -> None:
    assert max(at_periods("cycloidal", n) for n in (2.0, 3.0, 4.0, 9.0)) < 1e-14
    assert max(at_periods("simple-harmonic", n) for n in (1.5, 2.5, 3.5)) < 1e-14
    assert at_periods("cycloidal", 1.0) == pytest.approx(0.5, rel=1e-12), "the limit of the closed form"
    assert at_periods("simple-harmonic", 0.5) == pytest.approx(math.pi / 4.0, rel=1e-12), "likewise"


def s_of(theta: float) -> float:
    """The cycloidal motion of ``tappet`` [m]."""
    theta = math.degrees(theta) % 360.0
    up, down = (min(max((theta - a) / b, 0.0), 1.0) for a, b in ((60.0, SPAN), (235.0, 125.0)))
    return (
        1e-3
        * RISE
        * (
            (up - math.sin(2.0 * math.pi * up) / (2.0 * math.pi))
            - (down - math.sin(2.0 * math.pi * down) / (2.0 * math.pi))
        )
    )


@pytest.fixture(scope="module")
def damped() -> Study:
    return Study(tappet("cycloidal", ratio=0.04, spring=6.0), 720)


def test_the_steady_response_is_that_of_an_integration(damped: Study) -> None:
    """From its own state at angle 0 the equation of motion leads through the same turn, and back to that state."""
    omega, k, ks = damped.omega, K * 1e3, 6e3
    c = 2.0 * 0.04 * math.sqrt(MASS * (k + ks))
    e, speed = damped.elastic_error(), damped.elastic_error(1)

    def change(t: float, z: np.ndarray) -> tuple[float, float]:
        return z[1], -(c * z[1] + k * (z[0] - s_of(omega * t)) + ks * z[0]) / MASS

    t, z, path = 0.0, [e[0], speed[0]], []
    for end, count in zip((60.0, 135.0, 235.0, 360.0), (120, 150, 200, 250), strict=True):
        at = np.deg2rad(np.append(np.arange(round(2 * math.degrees(omega * t)), round(2 * end)) / 2.0, end)) / omega
        assert at.size == count + 1
        found = solve_ivp(change, (t, at[-1]), z, "DOP853", at, rtol=1e-12, atol=1e-16)
        path += [z - s_of(omega * a) for a, z in zip(at[:-1], found.y[0], strict=False)]
        t, z = at[-1], found.y[:, -1]
    size = np.abs(e).max()
    assert np.abs(np.array(path) - e).max() < 1e-9 * size
    assert abs(z[0] - e[0]) < 1e-9 * size, "periodic"
    residual = damped.follower_response.residuals[1].steady
    start = damped.at_theta(np.deg2rad([135.0]))
    about = start.elastic_error()[0] + ks / (k + ks) * 1e-3 * RISE
    width = NATURAL * math.sqrt((k + ks) / k * (1.0 - 0.04**2))
    there = complex(about, (start.elastic_error(1)[0] + 0.04 * NATURAL * math.sqrt((k + ks) / k) * about) / width)
    assert residual == pytest.approx(abs(there), rel=1e-9)


def test_what_the_cam_gives_the_mass_its_damper_takes(damped: Study) -> None:
    """Over a steady turn ∮ k (s - z) ż dt = ∮ c ż² dt: mass and springs give back all that they take."""
    x, w = np.polynomial.legendre.leggauss(60)
    given = taken = 0.0
    for a, b in zip(damped.program.starts, damped.program.ends, strict=True):
        study = damped.at_theta(0.5 * (a + b) + 0.5 * (b - a) * x)
        speed = study.motion.displacement[1] * study.omega + study.elastic_error(1)
        given += 0.5 * (b - a) * (w @ (-K * 1e3 * study.elastic_error() * speed))
        taken += 0.5 * (b - a) * (w @ (2.0 * 0.04 * math.sqrt(MASS * (K + 6.0) * 1e3) * speed**2))
    assert given == pytest.approx(taken, rel=1e-9)
    assert taken > 0.0
    assert certificate_of(damped, ("dynamics",))["elastic_follower_energy"].kept


def test_the_contact_force_is_that_of_the_follower_s_spring(damped: Study) -> None:
    """On a flat face the cam presses with k (s - z), preload and weight."""
    force = damped.elastic_contact_force
    assert force == pytest.approx(-K * 1e3 * damped.elastic_error() + 400.0 + MASS * 9.80665, rel=1e-9)


def test_where_the_elastic_follower_leaves_the_cam_a_finding_says_so(damped: Study) -> None:
    """Less preload is less force, newton for newton."""
    least = extremes_of(damped, "dynamics", ("elastic_contact_force",))["elastic_contact_force"].low
    assert "elastic-separation" not in [finding.code for finding in findings_of(damped)]
    study = Study(edited(damped.design, "loads.preload_n", 400.0 - least.value - 2.0))
    assert study.dynamics.contact.min() > 0.0
    (found,) = [finding for finding in findings_of(study) if finding.code == "elastic-separation"]
    assert found.values["force_n"] == pytest.approx(-2.0, abs=1e-6)
    assert found.cam_angle_deg == pytest.approx(math.degrees(least.theta), abs=1e-6)


def test_pieces_cut_small_say_the_same_as_whole_ones() -> None:
    """Short pieces take the series, long ones the closed form; 'modified-trapezoid' has sines and polynomials."""
    study = Study(tappet("modified-trapezoid", ratio=0.02, spring=3.0))
    rows = np.array([0.3, 5.0, 40.0, 200.0])
    found = study.vibration(rows)
    for i, omega in enumerate(rows.tolist()):
        own = Study(edited(study.design, "shaft.speed_rpm", omega * 30.0 / math.pi)).follower_response.residuals
        assert found.residual[0, :, i] == pytest.approx([r.from_rest for r in own], rel=1e-7)
        assert found.residual[1, :, i] == pytest.approx([r.steady for r in own], rel=1e-7)


def test_equivalents_of_an_arm_are_moments_about_its_pivot() -> None:
    design = edited(edited(load(EXAMPLES / "rocker_cam.toml"), STIFFNESS, 200.0), RATIO, 0.03)
    study = Study(design)
    one = study.elasticity.middle
    assert one.mass == pytest.approx(0.0012 + 0.8 * 0.04**2 + 1.2e-5 + 0.15 * 0.09**2, rel=1e-12)
    assert one.stiffness == pytest.approx(200e3 * 0.09**2, rel=1e-12)
    pivot, roller = complex(95.0, 30.0), Study(design).at_theta(np.array([0.0])).linkage.follower.origin[0][0] * 1e3
    middle = (roller - pivot) * cmath.exp(-1j * math.radians(9.0)) / 90.0  # half the rise; on the right it falls
    weight = -(0.8 * 0.04 + 0.15 * 0.09) * 9.80665 * middle.imag  # V = m g r sin φ
    assert one.closing == pytest.approx(40.0 + weight, rel=1e-9)
    assert one.damping_ratio == pytest.approx(0.03, rel=1e-12)
    assert [round(math.degrees(r.dwell.start), 9) for r in study.follower_response.residuals] == [0.0, 170.0]
    assert study.elasticity.lever_arm == pytest.approx(0.09, rel=1e-12)


def test_a_dwell_that_passes_360_is_one_and_further_springs_and_dampers_count() -> None:
    lift = edited(load(EXAMPLES / "transfer_lift.toml"), STIFFNESS, 3000.0)
    row = json.loads(files(Study(lift, 8))["summary.json"])["elastic_follower"]["residual"][0]
    assert row["steady_mm"] == pytest.approx(1e3 * Study(lift).follower_response.residuals[0].steady), "of the slider"
    spans = [(math.degrees(r.dwell.start), math.degrees(r.dwell.end)) for r in Study(lift).follower_response.residuals]
    assert spans == [pytest.approx((76.5, 283.5)), pytest.approx((325.0, 35.0))]
    table = to_table(tappet("cycloidal", ratio=0.01))
    ends = {"from": {"link": 1, "at": [0.0, 300.0]}, "to": {"link": 2, "point": "roller"}}
    table["loads"]["springs"] = [ends | {"rate_n_per_mm": 2.0, "damping_n_s_per_mm": 0.02}]
    one = Study(from_table(table)).elasticity.middle
    assert one.closing == pytest.approx(2e3, rel=1e-9)
    assert one.dampers == pytest.approx(20.0, rel=1e-9)
    assert one.damping == pytest.approx(20.0 + 0.02 * math.sqrt(MASS * 82e3), rel=1e-9)


def test_what_has_no_answer_says_what_to_do() -> None:
    rigid = Study(edited(tappet("cycloidal"), STIFFNESS, 0.0))
    assert "elastic_error" not in quantities_of(rigid)
    with pytest.raises(NoSolution, match="the follower is rigid; enter its stiffness"):
        _ = rigid.elasticity
    ringing = Study(tappet("cycloidal", rpm=NATURAL / 7.0 * 30.0 / math.pi))
    assert not ringing.vibrates
    (finding,) = [f for f in findings_of(ringing) if f.code == "no-elastic-follower"]
    assert "vibrates 7 times in a turn without damping" in finding.message
    assert "elastic_error" not in extremes_of(ringing, "dynamics")
    assert ringing.follower_response.residuals[1].steady == math.inf
    table = to_table(tappet("cycloidal"))
    over = {"from": {"link": 1, "at": [20.0, 64.0]}, "to": {"link": 2, "at": [0.0, 0.0]}, "free_length_mm": 120.0}
    table["loads"]["springs"] = [
        over | {"rate_n_per_mm": 200.0}
    ]  # pressed together across the guide: it wants to get away
    with pytest.raises(
        NoSolution, match=r"push the follower's mass away .* times as strongly as its stiffness holds it"
    ):
        _ = Study(from_table(table)).elasticity
    weightless = Study(edited(tappet("cycloidal"), "loads.follower_mass_kg", 0.0))
    with pytest.raises(NoSolution, match="without a mass does not vibrate"):
        _ = weightless.elasticity
    with pytest.raises(DesignError, match=r"follower_damping_ratio = 1\.2: .*allowed: 0 \.\.\. 0\.99"):
        from_table(
            {
                **to_table(tappet("cycloidal")),
                "loads": {**to_table(tappet("cycloidal"))["loads"], "follower_damping_ratio": 1.2},
            }
        )
    crank = to_table(load(EXAMPLES / "slider_crank.toml"))
    crank.setdefault("loads", {})["follower_stiffness_n_per_mm"] = 50.0
    with pytest.raises(
        DesignError, match=r"follower_stiffness_n_per_mm = 50\.0: there is no cam that drives an elastic follower"
    ):
        from_table(crank)


def test_the_command_writes_the_spectrum_that_the_study_has(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    design = edited(edited(load(EXAMPLES / "rocker_cam.toml"), STIFFNESS, 60.0), RATIO, 0.03)
    path, table = tmp_path / "rocker.toml", tmp_path / "spectrum.csv"
    save(design, path)
    assert main(["vibration", str(path), "--speeds", "100:300", "--count", "5", "--out", str(table)]) == 0
    study, printed = Study(design), capsys.readouterr().out
    own = study.follower_response.residuals
    assert "Natural frequency 59.94 Hz: 11.99 periods a turn" in printed
    for residual in own:
        assert f"{math.degrees(residual.steady):.4f}" in printed
        assert f"{residual.steady * 90.0:.4f}" in printed, "at the roller's centre"
    rows = [line.split(",") for line in table.read_text("utf-8").splitlines()]
    assert [float(row[0]) for row in rows[1:]] == pytest.approx([100.0, 150.0, 200.0, 250.0, 300.0], rel=1e-15)
    last = dict(zip(rows[0], map(float, rows[-1]), strict=True))
    assert last["residual2_deg"] == pytest.approx(math.degrees(own[1].from_rest), rel=1e-9)
    assert last["steady_residual1_mm"] == pytest.approx(90.0 * own[0].steady, rel=1e-9)
    highest = extremes_of(study, "dynamics", ("elastic_acceleration",))["elastic_acceleration"]
    peak = math.degrees(max(-highest.low.value, highest.high.value))
    assert last["steady_largest_acceleration_deg_s2"] == pytest.approx(peak, rel=1e-3)
    assert main(["vibration", str(path), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert len(data["spectrum"]["speed_rpm"]) == 200
    assert data["residual"] == json.loads(files(Study(design, 8))["summary.json"])["elastic_follower"]["residual"]
    assert "from 170.0 °" in report(study)
    head = files(Study(design, 8))["dynamics.csv"].splitlines()[0].split(",")
    assert {
        "elastic_displacement_deg",
        "elastic_error_deg",
        "elastic_acceleration_deg_s2",
        "elastic_contact_force_n",
    } <= set(head)


def test_the_command_refuses_a_rigid_follower_and_wrong_speeds(capsys: pytest.CaptureFixture[str]) -> None:
    rigid = str(EXAMPLES / "rocker_cam.toml")
    assert main(["vibration", rigid]) == 2
    assert capsys.readouterr().err == "loads.follower_stiffness_n_per_mm: the follower is rigid; enter its stiffness\n"
    assert main(["vibration", rigid, "--speeds", "300:100"]) == 2
    assert "'300:100': range of speeds; allowed: A:B in rpm" in capsys.readouterr().err


def test_the_chosen_drive_of_several_vibrates_as_by_itself() -> None:
    unit = load(EXAMPLES / "transfer_unit.toml")
    number = next(i for i, drive in enumerate(unit.drives) if drive.cam is not None)
    whole = edited(edited(unit, f"drives[{number}].{STIFFNESS}", 3000.0), f"drives[{number}].{RATIO}", 0.02)
    alone = Study(only(whole, number))
    assert alone.is_elastic
    assert (
        Study(whole).drives[unit.drives[number].name].follower_response.residuals == alone.follower_response.residuals
    )
