"""The steady response of a flexible shaft over a turn: followers' errors, torque in the shaft, harmonics true and linear."""

import csv
import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from sampled import spread, stressed
from scipy.integrate import solve_ivp
from shafts import HARD, KIM, by_runge_kutta, coefficients, kim, of, with_elastic

from core.__main__ import main
from core.design import as_list, copy_drive, with_phase
from core.output.channels import channel
from core.project import save
from core.stability import APPROXIMATE, EXACT, SteadyTurn, steady_turn
from core.study import Study, extremes_of

TAU = 2.0 * np.pi
ETA, Q, DAMPING = of(KIM).machine.eta, 0.05, 0.2
DAMPED = with_elastic(KIM, damping_ratio=DAMPING)


def lift(theta: np.ndarray) -> np.ndarray:
    """Kim's cam with its 9 mm: 1 - cos 2θ over half a turn, then rest."""
    theta = np.mod(theta, TAU)
    return np.where(theta < np.pi, 4.5 * (1.0 - np.cos(2.0 * theta)), 0.0)


@cache
def turn() -> SteadyTurn:
    found = of(DAMPED).steady_turn
    assert found is not None
    return found


def table(path: Path) -> dict[str, np.ndarray]:
    names, *rows = csv.reader(path.read_text("utf-8").splitlines())
    return dict(zip(names, np.array(rows, dtype=float).T, strict=True))


def test_a_damped_shaft_comes_to_it_from_rest_and_follower_and_torque_follow() -> None:
    """Another integrator, from rest through six turns: what is left of the start is e^-25 of it."""
    run = by_runge_kutta(ETA, Q, DAMPING, 6.0)
    last = run.y > 5.0
    theta, beta = TAU * (run.y[last] - 5.0), run.beta[last]
    assert np.abs(turn().wind_up(theta) - TAU * beta).max() < 1e-8
    assert np.abs(turn().torque(theta) - 85.0 * TAU * beta).max() < 1e-6
    error = lift(theta - TAU * beta) - lift(theta)
    assert np.abs(1e3 * turn().error(theta) - error).max() < 1e-7
    assert np.abs(error).max() > 0.05
    at = np.deg2rad(np.array([10.0, 50.0, 200.0]))
    study = Study(DAMPED).at_theta(at)
    there = turn().wind_up(at)
    assert channel(DAMPED, "wind_up_deg").values(study) == pytest.approx(np.rad2deg(there))
    assert channel(DAMPED, "shaft_torque_nm").values(study) == pytest.approx(85.0 * there)
    assert channel(DAMPED, "follower_error_mm").values(study) == pytest.approx(lift(at - there) - lift(at), abs=1e-12)


def test_its_figures_are_those_of_dense_samples() -> None:
    theta = TAU * np.arange(100_000) / 100_000
    wind_up, error = turn().wind_up(theta), 1e3 * turn().error(theta)
    study = Study(DAMPED)
    found = extremes_of(study, "stability")
    assert found["wind_up"].high.value == pytest.approx(wind_up.max(), rel=1e-7)
    assert found["shaft_torque"].low.value == pytest.approx(85.0 * wind_up.min(), rel=1e-7)
    assert 1e3 * found["follower_error"].low.value == pytest.approx(error.min(), rel=1e-7)
    assert theta[error.argmin()] == pytest.approx(found["follower_error"].low.theta, abs=1e-3)
    assert turn().mean_torque == pytest.approx(85.0 * wind_up.mean(), abs=1e-9)
    assert turn().torque_amplitude == pytest.approx(85.0 * np.ptp(wind_up) / 2.0, rel=1e-7)
    dense = np.fft.rfft(wind_up / TAU)[:31] / theta.size
    assert np.abs(turn().harmonics(30) - dense).max() < 1e-12


@pytest.mark.parametrize(("eta", "q"), [stressed(ETA, Q), (0.85, 0.1)])
def test_where_the_cam_stands_the_wind_up_is_that_of_the_input_ahead_of_it(eta: float, q: float) -> None:
    """Wind-up of one degree, and of seventeen."""
    found = steady_turn(coefficients(KIM), eta, q)
    assert found is not None
    cam = TAU * np.arange(500) / 500
    ahead = found.wind_up_at_cam(cam)
    assert np.abs(found.wind_up(cam + ahead) - ahead).max() < 1e-12
    assert np.abs(ahead - found.wind_up(cam)).max() > 1e-4


def linear_rates(equation: str, damping: float, y: float, state: np.ndarray, loaded: float) -> list[float]:
    """(Dβ')' + 4πζηβ' + 4π²[η² + Q(ψ + κ)]β = 2πQ(C + U), and Kim1990 (22): D = 1, κ = 0, C in its load φ alone."""
    d, c, u, k, psi = kim(TAU * y)
    load = c + u
    if equation == APPROXIMATE:
        d, c, k = 0.0, 0.0, 0.0
    right = (
        loaded * TAU * Q * load
        - 2.0 * TAU * (Q * c + damping * ETA) * state[1]
        - TAU**2 * (ETA**2 + Q * (psi + k)) * state[0]
    )
    return [state[1], right / (1.0 + Q * d)]


@pytest.mark.parametrize(("equation", "damping"), [stressed(EXACT, 0.0), (APPROXIMATE, 0.0), (EXACT, DAMPING)])
def test_the_linear_harmonics_are_those_of_the_periodic_solution(equation: str, damping: float) -> None:
    """Kim1990 (27), γ = 0, against the equation itself: three solutions of it make the one that comes back to its start."""

    def through(start: list[float], loaded: float) -> np.ndarray:
        parts, state = [], np.array(start)
        for half in (0.0, 0.5):  # what jumps does so between them
            y = np.linspace(half, half + 0.5, 513)
            run = solve_ivp(
                lambda y, s: linear_rates(equation, damping, y, s, loaded),
                (y[0], y[-1] * (1.0 - 1e-16)),
                state,
                "DOP853",
                t_eval=np.minimum(y, y[-1] * (1.0 - 1e-16)),
                rtol=1e-11,
                atol=1e-14,
            )
            parts.append(run.y[:, :-1])
            state = run.y[:, -1]
        return np.concatenate((*parts, state[:, None]), axis=1)

    own, one, other = through([0.0, 0.0], 1.0), through([1.0, 0.0], 0.0), through([0.0, 1.0], 0.0)
    start = np.linalg.solve(np.eye(2) - np.array([one[:, -1], other[:, -1]]).T, own[:, -1])
    beta = (own + start[0] * one + start[1] * other)[0, :-1]
    dense = np.fft.rfft(beta)[:13] / beta.size
    from core.stability.tongues import forced_response

    found = forced_response(coefficients(KIM), ETA, Q, damping, equation)
    assert np.abs(found[:13] - dense).max() < 1e-8 * np.abs(dense).max() + 1e-11
    assert np.abs(dense).max() > 1e-4


@pytest.mark.parametrize("name", spread(["parabolic", "fixed"], 1))
def test_as_the_load_vanishes_the_true_harmonics_become_the_linear_ones(name: str) -> None:
    """Where C jumps in the middle of a rise, and where the spring is the same at all speeds: what is left, Qβ², falls as Q³."""
    left = []
    for q in (1e-2, 1e-3):
        found = steady_turn(coefficients(HARD[name]), 2.7, q)
        assert found is not None
        left.append(np.abs(found.harmonics(12) - found.linear(12)[EXACT]).max() / q**3)
    assert left[1] == pytest.approx(left[0], rel=0.1)


@pytest.mark.stress
def test_every_drive_of_a_shaft_has_its_error(tmp_path: Path) -> None:
    """Two of Kim's cams, the second a quarter of a turn behind."""
    two = with_phase(copy_drive(as_list(DAMPED, "Inlet"), 0), 1, 90.0)
    save(two, tmp_path / "two.toml")
    study = Study(two)
    found = study.flexible_shaft().steady_turn
    assert found is not None
    assert (
        main(
            [
                "stability",
                str(tmp_path / "two.toml"),
                "--out",
                str(tmp_path / "out"),
                "--periods",
                "1",
                "--eta-max",
                "1",
            ]
        )
        == 0
    )
    rows = table(tmp_path / "out" / "orbit.csv")
    slugs = list(study.camshaft.slugs.values())
    assert list(rows) == [
        "input_angle_deg",
        "wind_up_deg",
        *(f"{slug}_follower_error_mm" for slug in slugs),
        "shaft_torque_nm",
    ]
    at, behind = np.deg2rad(rows["input_angle_deg"]), np.deg2rad(rows["wind_up_deg"])
    assert rows["shaft_torque_nm"] == pytest.approx(85.0 * behind)
    for slug, phase in zip(slugs, (0.0, np.pi / 2.0), strict=True):
        wanted = lift(at - behind - phase) - lift(at - phase)
        assert np.abs(rows[f"{slug}_follower_error_mm"] - wanted).max() < 1e-11
        assert np.abs(wanted).max() > 0.05
    steady = json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))["stability"]["steady"]
    assert [each["drive"] for each in steady["follower_error"]] == list(study.camshaft.slugs)
    assert steady["shaft_torque_amplitude_nm"] == pytest.approx(np.ptp(rows["shaft_torque_nm"]) / 2.0, rel=1e-4)


@pytest.mark.stress
def test_the_command_prints_the_verdicts_of_a_point_and_of_a_speed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Kim1990 Figs. 9 and 11 at their own η and Q: wind-up through 30 turns from rest, 0.09681 and 0.03074 of a turn."""
    save(KIM, tmp_path / "kim.toml")
    assert main(["stability", str(tmp_path / "kim.toml"), "--at", "0.85,0.10", "--at", "2.1,0.05"]) == 0
    ninth, eleventh = (part.splitlines() for part in capsys.readouterr().out.split("\nAt η = ")[1:])
    models = [
        "Linearised, approximate (22)",
        "Linearised, exact (21)",
        "About the true steady response",
        "Nonlinear, from rest (13)",
    ]
    for part, rest in ((ninth, "stable"), (eleventh, "contact lost")):
        assert [line[:31].strip() for line in part[1:5]] == models
        assert [line[31:60].strip().partition("  ")[0] for line in part[1:5]] == [*3 * ["stable"], rest]
    assert ninth[0].startswith("0.8500, Q = 0.1000, ")
    assert ninth[4].split()[-1] == f"{360.0 * 0.096809987222:.4g}"
    assert eleventh[4].split()[-2:] == [f"{360.0 * 0.03073731393:.4g}", "2.275"]
    assert main(["stability", str(tmp_path / "kim.toml"), "--at", "3000 rpm", "--periods", "1"]) == 0
    assert "\nAt η = 1.630, Q = 0.05000, 3000 rpm" in capsys.readouterr().out, "the machine's own Q"
    assert main(["stability", str(tmp_path / "kim.toml"), "--at", "fast rpm"]) == 2
    assert main(["stability", str(tmp_path / "kim.toml"), "--at", "1rpm"]) == 2
    assert "allowed: 81.519 rpm and more" in capsys.readouterr().err


def test_a_shaft_without_a_steady_response_has_none_of_its_tables(tmp_path: Path) -> None:
    """So slow that the shaft swings more than sixty times in a turn: it is not followed so far."""
    slow = with_elastic(KIM, stiffness_nm_per_rad=31000.0)
    assert extremes_of(Study(slow), "stability") == {}
    save(slow, tmp_path / "slow.toml")
    assert (
        main(
            [
                "export",
                str(tmp_path / "slow.toml"),
                "--out",
                str(tmp_path / "out"),
                "--samples",
                "36",
                "--only",
                "stability",
            ]
        )
        == 0
    )
    assert "orbit.csv" not in {path.name for path in (tmp_path / "out").iterdir()}
    told = json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))["stability"]
    assert told["stiffness"] is None, "nor are tongues looked for so far"
    assert "steady" not in told
    assert [verdict["model"] for verdict in told["verdicts"]] == [APPROXIMATE, EXACT]
