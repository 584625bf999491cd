"""Answers taken over: by a crank, under the motion of a present design, of two chosen dyads, by the other link; by the command."""

import csv
import json
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.__main__ import main
from core.design import (
    Design,
    LinkageLoads,
    LinkForce,
    LinkMass,
    Motion,
    NamedCurve,
    Segment,
    edited,
    only,
    with_drive,
    with_mechanism,
)
from core.design.motion_edits import of_motion
from core.errors import DesignError
from core.project import dumps, load, loads, save
from core.study import Study, findings_of
from core.synthesis import Answer, BodyPose, Dyad, Swing, Task, load_task, save_task, synthesise
from core.synthesis.chosen import answer_of_dyads, driven_by_other_link
from core.synthesis.path import with_points
from core.synthesis.takeover import taken_over, under_motion

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
POSES = ((0.0, 0.0, 0.0), (60.0, 20.0, 30.0), (110.0, 10.0, 60.0))
TASK = Task(kind="poses", poses=tuple(BodyPose(*row) for row in POSES))
SWING = Task(kind="rocker", rocker=Swing(swing_deg=60.0, time_ratio=1.2, frame_mm=100.0))


@pytest.fixture(scope="module")
def answers() -> tuple[Answer, ...]:
    return synthesise(TASK).answers


def passed(file: Path, folder: Path) -> np.ndarray:
    """Columns P_x_mm, P_y_mm, link3_deg over the turn, as exported."""
    assert main(["export", str(file), "--out", str(folder), "--only", "linkage", "--samples", "720"]) == 0
    with (folder / "linkage.csv").open() as lines:
        rows = list(csv.DictReader(lines))
    return np.array([[float(row[name]) for name in ("P_x_mm", "P_y_mm", "link3_deg")] for row in rows])


def distance(passed: np.ndarray, pose: tuple[float, float, float]) -> np.ndarray:
    """Distance (n,) of exported positions from a pose, in mm, a degree counts as 1 mm."""
    turn = np.mod(passed[:, 2] - pose[2] + 180.0, 360.0) - 180.0
    return np.abs(passed[:, :2] - pose[:2]).sum(axis=1) + np.abs(turn)


@pytest.mark.parametrize("name", ["transfer_lift", "four_bar_coupler_cam", "card_picker", "finger_follower"])
def test_the_present_motion_moves_the_body_from_the_first_pose_to_the_last(name: str, tmp_path: Path) -> None:
    task, file = tmp_path / "task.toml", tmp_path / "moved.toml"
    save_task(TASK, task)
    present = EXAMPLES / f"{name}.toml"
    words = ["synthesise", str(task), "--into", str(file), "--design", str(present), "--under-motion"]
    assert main(words) == 0
    before, after = load(present), load(file)
    assert main(["check", str(file)]) == 0
    motion, driven = before.drive.motion, after.drive.motion
    assert motion is not None
    assert driven is not None
    assert driven.unit == "deg"
    if motion.lobe is None:
        assert [segment.span_deg for segment in driven.segments] == [segment.span_deg for segment in motion.segments]
    assert after.shaft == before.shaft
    rows = passed(file, tmp_path / "out")
    levels = np.cumsum([motion.first, *(segment.rise for segment in motion.segments)])
    at = np.cumsum([0.0, *(segment.span_deg for segment in motion.segments)])
    for level, pose in ((levels.min(), POSES[0]), (levels.max(), POSES[2])):
        angle = next(a for a, s in zip(at, levels, strict=True) if abs(s - level) < 1e-9)
        near = distance(rows, pose)
        assert near.min() < (1e-8 if angle % 0.5 == 0.0 else 1e-2)
        if angle % 0.5 == 0.0:
            assert near[int(angle * 2) % 720] < 1e-8
    assert distance(rows, POSES[1]).min() < 2.0  # passed on the way


def test_a_motion_that_advances_turns_the_driver_fully_and_one_that_returns_cannot() -> None:
    answer = synthesise(SWING).answers[0]
    indexer = of_motion(
        Motion(10.0, (Segment(120.0, 90.0, NamedCurve("cycloidal")), Segment(240.0, 0.0)), "deg", 90.0), "Indexer"
    )
    moved = under_motion(answer, SWING, indexer).design.drive.motion
    assert moved is not None
    assert abs(moved.gain) == pytest.approx(360.0, abs=1e-9)
    assert moved.start == pytest.approx(answer.candidate.linkage.drawn.driver_deg)  # type: ignore[union-attr]
    with pytest.raises(DesignError, match="needs full turns of the driver"):
        under_motion(answer, SWING, load(EXAMPLES / "transfer_lift.toml"))


def test_what_cannot_drive_is_refused_in_a_sentence(answers: tuple[Answer, ...]) -> None:
    with pytest.raises(DesignError, match="has no motion"):
        under_motion(answers[0], TASK, load(EXAMPLES / "four_bar.toml"))
    still = of_motion(Motion(1.0, (Segment(360.0, 0.0),), "mm"), "Still")
    with pytest.raises(DesignError, match="does not move"):
        under_motion(answers[0], TASK, still)
    indexer = of_motion(Motion(0.0, (Segment(360.0, 90.0, NamedCurve("cycloidal")),), "deg", 90.0), "Indexer")
    swinging = next(answer for answer in answers if not answer.turns_fully)
    with pytest.raises(DesignError, match="cannot turn fully"):
        under_motion(swinging, TASK, indexer)


def with_loads() -> Design:
    """The example of a four-bar with a mass of the coupler, and forces at a point that answers have and at one that they do not have."""
    design = load(EXAMPLES / "four_bar.toml")
    mass = LinkMass(link=3, mass_kg=2.0, centre_x_mm=5.0)
    forces = (LinkForce(link=3, point="C", y_n=-50.0), LinkForce(link=4, point="B", x_n=20.0))
    loads = LinkageLoads(gravity_m_s2=1.62, masses=(mass,), forces=forces)
    marks = ("loads.masses[0].mass_kg", "loads.forces[0].y_n", "loads.forces[1].x_n")
    return replace(with_drive(edited(design, "linkage.driver.speed_rpm", -90.0), loads=loads), assumed=marks)


def test_loads_speed_and_marks_of_the_present_design_stay_where_they_fit(answers: tuple[Answer, ...]) -> None:
    present = with_loads()
    takeover = taken_over(answers[0], present)
    design, loads = takeover.design, takeover.design.drive.loads
    assert takeover.left_out == ("loads.forces[0]",)
    assert loads.masses == present.drive.loads.masses
    assert loads.forces == present.drive.loads.forces[1:]
    assert loads.gravity_m_s2 == 1.62
    assert [mark for mark in design.assumed if not mark.startswith("motion.")] == ["loads.masses[0].mass_kg"]
    assert design.drive.linkage.driver.speed_rpm == -90.0
    assert design.drive.linkage.links == answers[0].candidate.linkage.links


def test_without_masses_the_links_are_steel_bars_and_assumed(answers: tuple[Answer, ...], tmp_path: Path) -> None:
    design = taken_over(answers[0], load(EXAMPLES / "transfer_lift.toml")).design
    crank = design.drive.linkage.by_number[2].places
    length = abs(crank["A"] - crank["O2"])
    row = next(row for row in design.drive.loads.masses if row.link == 2)
    assert row.mass_kg == pytest.approx(7850.0 * 0.02 * 0.01 * 1e-3 * length, rel=6e-3)
    assert row.inertia_kg_m2 == pytest.approx(row.mass_kg * (1e-3 * length) ** 2 / 12.0, rel=6e-3)
    assert row.centre_x_mm == pytest.approx(0.5 * length, rel=6e-3)
    assert [mark for mark in design.assumed if mark.endswith("mass_kg")] == [
        f"loads.masses[{i}].mass_kg" for i in range(3)
    ]
    save(design, tmp_path / "design.toml")
    assert load(tmp_path / "design.toml") == design


def test_a_driver_that_cannot_turn_fully_runs_loaded_between_the_first_pose_and_the_last(
    answers: tuple[Answer, ...], tmp_path: Path
) -> None:
    assert not answers[0].turns_fully
    save_task(TASK, tmp_path / "task.toml")
    file, present = tmp_path / "design.toml", EXAMPLES / "four_bar.toml"
    assert main(["synthesise", str(tmp_path / "task.toml"), "--into", str(file), "--design", str(present)]) == 0
    design = load(file)
    assert design == taken_over(answers[0], load(present)).design
    assert "motion.segments[1].rise_deg" in design.assumed
    rows = passed(file, tmp_path / "out")
    assert distance(rows, POSES[0])[0] < 1e-8  # at rest during the first dwell
    assert distance(rows, POSES[2])[2 * 190] < 1e-8  # and during the second
    assert main(["export", str(file), "--out", str(tmp_path / "out"), "--samples", "360"]) == 0
    with (tmp_path / "out" / "dynamics.csv").open() as lines:
        torque = np.array([float(line["driver_torque_nm"]) for line in csv.DictReader(lines)])
    assert 0.01 < np.abs(torque).max() < 10.0


def test_sequence_conditions_follow_the_strokes_of_a_driver_that_turns_the_other_way(
    answers: tuple[Answer, ...], tmp_path: Path
) -> None:
    save_task(TASK, tmp_path / "task.toml")
    file, unit = tmp_path / "unit.toml", EXAMPLES / "transfer_unit.toml"
    words = ["synthesise", str(tmp_path / "task.toml"), "--into", str(file), "--design", str(unit)]
    assert main([*words, "--drive", "Feed", "--under-motion"]) == 0
    rise = load(file).drives[0].motion.segments[0].rise  # type: ignore[union-attr]
    assert rise < 0.0  # where that of the unit rises
    assert load(file).timing[0].second == "Feed.return.1.start"
    assert main(["check", str(file)]) == 0


def test_a_parallelogram_swings_between_the_poses_and_never_folds() -> None:
    shifts = Task(kind="poses", poses=(BodyPose(0.0, 0.0), BodyPose(30.0, 10.0), BodyPose(60.0, 0.0)))
    takeover = taken_over(synthesise(shifts).answers[0], load(EXAMPLES / "four_bar.toml"))
    study = Study(takeover.design)
    assert not {finding.code for finding in findings_of(study)} & {"change-point", "dead-centre", "transmission"}
    body = study.linkage.bodies["link3"]
    assert np.abs(body.angle[0]).max() < 1e-9
    x = 1e3 * body.fixed_point(0j)[0].real
    assert (x.min(), x.max()) == pytest.approx((0.0, 60.0), abs=1e-6)
    assert np.isfinite(study.dynamics.torque).all()


def test_a_driver_that_turns_fully_is_a_crank() -> None:
    design = taken_over(synthesise(SWING).answers[0], load(EXAMPLES / "transfer_lift.toml")).design
    assert design.drive.motion is None
    assert design.drive.by_crank


def test_a_drive_of_a_shaft_is_replaced_and_the_others_stay(answers: tuple[Answer, ...]) -> None:
    machine = load(EXAMPLES / "transfer_unit.toml")
    index = next(i for i, drive in enumerate(machine.drives) if drive.name == "Lift")
    changed = with_mechanism(machine, index, under_motion(answers[0], TASK, only(machine, index)).design)
    assert [drive.name for drive in changed.drives] == [drive.name for drive in machine.drives]
    assert changed.drives[index].linkage.links == answers[0].candidate.linkage.links
    assert changed.drives[index].linkage.driver.kind == "motion"
    assert changed.drives[:index] == machine.drives[:index]
    assert changed.shaft == machine.shaft


# -- composed answers -------------------------------------------------------------------------------------------


def numbers(answer: Answer, dyads: tuple[Dyad, ...]) -> list[int]:
    """Numbers of the dyads of an answer in a list, the driver's first, from 1 on."""
    frame, coupler = (answer.candidate.linkage.by_number[n].places for n in (1, 3))
    pivots = [(frame[g], coupler[a]) for g, a in (("O2", "A"), ("O4", "B"))]
    return [next(i for i, dyad in enumerate(dyads, 1) if (dyad.fixed, dyad.moving) == pivot) for pivot in pivots]


def test_two_chosen_dyads_are_the_answer_of_the_sweep(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    synthesis = synthesise(TASK)
    listed = synthesis.answers[3]
    first, second = numbers(listed, synthesis.dyads)
    answer = answer_of_dyads(TASK, synthesis.dyads[second - 1], synthesis.dyads[first - 1])
    assert answer.candidate.linkage == listed.candidate.linkage
    assert answer.transmission_deg == listed.transmission_deg
    save_task(TASK, tmp_path / "task.toml")
    words = ["synthesise", str(tmp_path / "task.toml"), "--into", str(tmp_path / "a.toml"), "--json"]
    assert main([*words, "--dyads", str(first), str(second)]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["into"]["transmission_deg"] == listed.transmission_deg
    assert load(tmp_path / "a.toml").drive.linkage == listed.candidate.linkage


def test_dyads_that_make_no_linkage_are_refused() -> None:
    dyads = synthesise(TASK).dyads
    with pytest.raises(DesignError, match="one dyad"):
        answer_of_dyads(TASK, dyads[0], dyads[0])
    guides = Dyad("guide", 0j, 1j, 0.5), Dyad("guide", 1.0 + 0j, 2j, 0.7)
    with pytest.raises(DesignError, match="could be the crank"):
        answer_of_dyads(TASK, *guides)


def test_the_other_link_drives_and_is_judged_again(answers: tuple[Answer, ...]) -> None:
    for answer in answers[:6]:
        changed = driven_by_other_link(answer, TASK)
        before, after = answer.candidate.linkage, changed.candidate.linkage
        assert after.by_number[1].places["O2"] == before.by_number[1].places["O4"]
        assert after.by_number[2].places["A"] == pytest.approx(before.by_number[4].places["B"])
        assert changed.length_ratio == pytest.approx(answer.length_ratio)
        assert changed.grashof == answer.grashof
        back = driven_by_other_link(changed, TASK)
        assert back.defects == answer.defects
        assert back.transmission_deg == pytest.approx(answer.transmission_deg, abs=1e-9)
    assert any(driven_by_other_link(answer, TASK).defects != answer.defects for answer in answers)


def test_only_a_pinned_link_of_a_task_without_a_driver_can_be_the_other_driver(answers: tuple[Answer, ...]) -> None:
    swing = synthesise(SWING).answers[0]
    with pytest.raises(DesignError, match="states the motion of the driver"):
        driven_by_other_link(swing, SWING)
    with pytest.raises(DesignError, match="sliding pair"):
        driven_by_other_link(replace(answers[0], candidate=replace(answers[0].candidate, kind="slider-crank")), TASK)


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (["--under-motion"], "--under-motion: only together with --design DESIGN"),
        (["--dyads", "1", "2"], "--dyads: only together with --into FILE"),
        (["--dyads", "1", "9000", "--into", "a.toml"], "9000 is no number of a dyad; allowed: 1 ... "),
        (["--dyads", "0", "2", "--into", "a.toml"], "number of a dyad; allowed: 1 ... "),
        (["--other-driver"], "--other-driver: only together with --into FILE"),
        (["--dyads", "1", "2", "--rank", "2", "--into", "a.toml"], "cannot be combined with --dyads"),
    ],
)
def test_options_that_do_not_fit_are_refused(
    words: list[str], problem: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    save_task(TASK, "task.toml")
    assert main(["synthesise", "task.toml", *words]) == 2
    assert problem in capsys.readouterr().err
    assert not Path("a.toml").exists()


# -- everything -------------------------------------------------------------------------------------------------

PRESENT = (
    "transfer_lift", "four_bar_coupler_cam", "slider_crank", "finger_follower", "barrel_feeder", "globoidal_indexer", "stephenson_six_bar",
)  # fmt: skip


def every_task() -> dict[str, Task]:
    more = (*POSES, (140.0, -20.0, 80.0), (160.0, -60.0, 95.0))
    tasks = {f"{n} poses": Task(kind="poses", poses=tuple(BodyPose(*row) for row in more[:n])) for n in (2, 4, 5)}
    files = (Path(__file__).parents[3] / "resources" / "tasks").glob("*.toml")
    return {path.stem: load_task(path) for path in files} | tasks


@pytest.mark.stress
@pytest.mark.parametrize("name", sorted(every_task()))
def test_every_linkage_runs_with_finite_forces_in_place_of_any_design(name: str) -> None:
    task = with_points(every_task()[name])
    for answer in synthesise(task).answers[:6]:
        for present in (load(EXAMPLES / f"{example}.toml") for example in PRESENT):
            takeovers = [taken_over(answer, present)]
            with suppress(DesignError):  # no motion, or one that cannot drive it, as it says
                takeovers.append(under_motion(answer, task, present))
            for takeover in takeovers:
                study = Study(takeover.design, 180)
                assert np.isfinite(study.dynamics.driver).all()
                assert not [f for f in findings_of(study, ("linkage", "dynamics")) if f.severity == "error"]
                assert loads(dumps(takeover.design)) == takeover.design
