"""Four-bars for a path: known ones found again, open paths, timing, cognates, and refusals."""

from pathlib import Path

import numpy as np
import pytest
from drawn_cams import drawn

from core.__main__ import main
from core.errors import DesignError
from core.mechanism.driver_ranges import driver_ranges_of
from core.mechanism.solving import unit_speed_kinematics
from core.process import resources
from core.project import load
from core.synthesis import Answer, load_task, synthesise, task_of


def coupler_curve(
    crank: float, coupler: float, rocker: float, frame: float, tracer: complex, q: np.ndarray
) -> np.ndarray:
    """Points of a coupler by intersection of two circles, for the crank's pivot at 0 and the frame along x."""
    pin = crank * np.exp(1j * q)
    d = frame - pin
    r = np.abs(d)
    x = (r**2 + coupler**2 - rocker**2) / (2.0 * r)
    rod = d / r * (x + 1j * np.sqrt(coupler**2 - x**2)) / coupler
    return pin + tracer * rod


def rows(z: np.ndarray) -> list[list[float]]:
    return [[float(p.real), float(p.imag)] for p in z]


def size(z: np.ndarray) -> float:
    return float(np.hypot(np.ptp(z.real), np.ptp(z.imag)))


def traced(answer: Answer, count: int = 2000) -> np.ndarray:
    """Curve of P [mm] by the solved kinematics of an answer."""
    linkage = answer.candidate.linkage
    ranges = driver_ranges_of(linkage)
    low, high = ranges.ranges[0].low, ranges.ranges[0].high
    inset = 1e-9 * (high - low)
    at = np.linspace(low + inset, high - inset, count)
    return 1e3 * unit_speed_kinematics(linkage, at, ranges).bodies["link3"].fixed_point(0j)[0]


TURN = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
FINE = np.linspace(0.0, 2.0 * np.pi, 1440, endpoint=False)
HOEKEN = 20.0 * coupler_curve(1.0, 2.5, 2.5, 2.0, 5.0 + 0j, TURN)
"""Crank, coupler, rocker, frame 1 : 2.5 : 2.5 : 2, tracer at 5."""


def test_hoekens_linkage_is_found_from_points_of_its_curve() -> None:
    best, *_ = synthesise(task_of({"kind": "path", "path": {"points": rows(HOEKEN), "closed": True}})).answers
    assert best.error_mm < 1e-8
    assert not best.defects
    assert best.grashof
    linkages = [row.candidate.linkage for row in (best, *best.cognates)]
    ratios = []
    for linkage in linkages:
        frame, coupler = linkage.by_number[1].places, linkage.by_number[3].places
        crank = abs(linkage.by_number[2].places["A"])
        lengths = (
            crank,
            abs(coupler["B"] - coupler["A"]),
            abs(linkage.by_number[4].places["B"]),
            abs(frame["O4"] - frame["O2"]),
        )
        ratios.append([length / crank for length in lengths])
    assert any(np.allclose(ratio, (1.0, 2.5, 2.5, 2.0), atol=1e-6) for ratio in ratios)


def test_cognates_trace_the_same_curve() -> None:
    """The distance of their points from the curve, by Newton's method on its closed form, is below 1e-9 of its size."""

    def curve(q: np.ndarray) -> np.ndarray:
        return 20.0 * coupler_curve(1.0, 3.0, 2.8, 3.3, 1.6 + 1.4j, q)

    best, *_ = synthesise(task_of({"kind": "path", "path": {"points": rows(curve(TURN)), "closed": True}})).answers
    assert len(best.cognates) == 2
    for linkage in (best, *best.cognates):
        assert linkage.error_mm < 1e-9 * size(curve(TURN))
        z = traced(linkage, 60)
        q = FINE[np.abs(curve(FINE) - z[:, None]).argmin(axis=1)]
        for _ in range(8):
            tangent = (curve(q + 1e-6) - curve(q - 1e-6)) / 2e-6
            q = q + (np.conj(tangent) * (z - curve(q))).real / np.abs(tangent) ** 2
        assert np.abs(z - curve(q)).max() < 1e-9 * size(curve(TURN))


@pytest.mark.parametrize("count", [2, pytest.param(30, marks=pytest.mark.stress)])
@pytest.mark.stress
def test_random_closed_curves_are_met_within_a_percent(count: int) -> None:
    rng, errors = np.random.default_rng(77), list[float]()
    while len(errors) < count:
        coupler, rocker, frame = 1.0 + 4.0 * rng.random(3)
        if not (frame + 1.05 < coupler + rocker and abs(frame - 1.0) > abs(coupler - rocker) + 0.05):
            continue
        tracer = coupler * complex(*rng.uniform(-1.0, 1.5, 2))
        z = (
            37.0
            * np.exp(1j * rng.uniform(0, 6))
            * coupler_curve(1.0, coupler, rocker, frame, tracer, np.linspace(0, 2 * np.pi, 40, endpoint=False))
            + 50
        )
        best, *_ = synthesise(task_of({"kind": "path", "path": {"points": rows(z), "closed": True}})).answers
        errors.append(best.error_mm / size(z))
    assert max(errors) < 0.01
    assert sum(error < 0.001 for error in errors) >= 0.86 * count


def test_an_open_path_is_met_within_a_percent() -> None:
    z = 20.0 * coupler_curve(1.0, 2.5, 2.5, 2.0, 5.0 + 0j, np.radians(np.linspace(100.0, 260.0, 17)))
    synthesis = synthesise(task_of({"kind": "path", "path": {"points": rows(z)}}))
    assert not synthesis.complete
    best = synthesis.answers[0]
    assert best.error_mm < 0.01 * size(z)
    assert not best.defects
    curve = traced(best)
    assert max(np.abs(curve - p).min() for p in z) < 0.01 * size(z)


def test_the_driver_is_at_its_angles_at_the_points() -> None:
    timing = np.degrees(TURN) + 33.0
    table = {"kind": "path", "path": {"points": rows(HOEKEN), "closed": True, "driver_deg": timing.tolist()}}
    best, *_ = synthesise(task_of(table)).answers
    assert best.error_mm < 1e-8
    steps = np.diff(np.unwrap(best.candidate.positions))
    assert np.allclose(steps, np.radians(15.0), atol=1e-12)


@pytest.mark.stress
def test_limits_hide_answers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    task = tmp_path / "task.toml"
    task.write_text(
        f'kind = "path"\n[path]\npoints = {rows(HOEKEN)}\nclosed = true\n[limits]\ntransmission_deg_min = 89.0\n',
        "utf-8",
    )
    assert main(["synthesise", str(task), "--all"]) == 1
    captured = capsys.readouterr()
    assert "beyond transmission_deg_min" in captured.out
    assert "beyond transmission_deg_min" in captured.err


@pytest.mark.stress
def test_points_come_from_a_table_next_to_the_task(tmp_path: Path) -> None:
    lines = ["x_mm;y_mm", *(f"{z.real};{z.imag}" for z in HOEKEN)]
    (tmp_path / "curve.csv").write_text("\n".join(lines), "utf-8")
    (tmp_path / "task.toml").write_text('kind = "path"\n[path]\nfile = "curve.csv"\nclosed = true\n', "utf-8")
    assert main(["synthesise", str(tmp_path / "task.toml"), "--into", str(tmp_path / "best.toml")]) == 0
    assert load(tmp_path / "best.toml").drive.linkage.by_number[3].places["P"] == 0j


@pytest.mark.stress
def test_the_curve_of_a_drawing_is_a_path(tmp_path: Path) -> None:
    ring = drawn(("circle", (30.0, 20.0), 25.0))
    (tmp_path / "ring.dxf").write_bytes(ring)
    (tmp_path / "task.toml").write_text('kind = "path"\n[path]\nfile = "ring.dxf"\nclosed = true\n', "utf-8")
    answer, *_ = synthesise(load_task(tmp_path / "task.toml")).answers
    assert answer.error_mm < 0.01 * 50.0
    assert np.abs(np.abs(traced(answer) - (30.0 + 20.0j)) - 25.0).max() < 0.5


@pytest.mark.parametrize("is_closed", [False, True])
@pytest.mark.parametrize(
    "z",
    [
        np.linspace(0.0, 1.0, 200) * (3e3 + 1e3j),
        np.repeat(np.exp(1j * np.linspace(0.0, 5.0, 20)), 2),
        1e-4 * (np.abs(np.cos(TURN)) + 1j * np.abs(np.sin(TURN))),
        1e5 + np.cos(TURN) + 1j * np.sin(2.0 * TURN),
        np.array([0.0, 1.0, 1j]),
    ],
    ids=["line", "repeated", "tiny", "eight", "three"],
)
@pytest.mark.stress
def test_paths_of_any_kind_have_linkages_with_finite_figures(z: np.ndarray, is_closed: bool) -> None:
    answers = synthesise(task_of({"kind": "path", "path": {"points": rows(z), "closed": is_closed}})).answers
    assert all(np.isfinite((answer.transmission_deg, answer.size_mm)).all() for answer in answers)
    assert len(answers) >= 8
    assert answers[0].error_mm < 0.2 * size(z)


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ({"points": [[0.0, 0.0], [1.0, 1.0]]}, "path.points: 2 points; allowed: 3 ... 2000"),
        ({"points": [[1.0, 1.0]] * 4}, "path.points: are all equal"),
        ({"points": rows(HOEKEN), "file": "a.csv"}, "path.points: cannot be combined with file"),
        ({}, "path.points: missing"),
        ({"points": rows(HOEKEN), "driver_deg": [1.0, 2.0]}, "path.driver_deg: 2 numbers for 24 points"),
        (
            {"points": rows(HOEKEN), "driver_deg": [30.0 * k for k in range(24)]},
            r"path.driver_deg = \d+.0: is the angle of two different points; allowed: each angle of a turn once",
        ),
        ({"points": rows(HOEKEN), "weights": [0.0] * 24}, "path.weights: has a weight that is not positive"),
    ],
)
def test_bad_paths_are_refused_with_their_field(path: dict[str, object], message: str) -> None:
    with pytest.raises(DesignError, match=message):
        synthesise(task_of({"kind": "path", "path": path}))


def test_a_missing_file_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "task.toml").write_text('kind = "path"\n[path]\nfile = "curve.csv"\n', "utf-8")
    assert main(["synthesise", str(tmp_path / "task.toml")]) == 2
    assert "curve.csv" in capsys.readouterr().err


@pytest.mark.parametrize(
    "task",
    [
        "hoeken_line",
        "quick_return",
        *(
            pytest.param(t, marks=pytest.mark.stress)
            for t in ("chebyshev_line", "watt_line", "roberts_line", "arc_dwell")
        ),
    ],
)
@pytest.mark.stress
def test_ready_tasks_have_an_answer_within_a_percent(task: str) -> None:
    answer, *_ = synthesise(load_task(resources() / "tasks" / f"{task}.toml")).answers
    assert answer.is_good
    assert answer.error_mm < 0.01 * answer.size_mm
    assert answer.error_deg < 1e-9
