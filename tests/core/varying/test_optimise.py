"""The best design of a study: optima in closed form, a known problem of four variables, the lift, fronts and robust answers."""

import itertools
import json
import re
import shutil
import subprocess
import sys
import threading
from dataclasses import replace

import numpy as np
import pytest
from sampled import stressed

from core.__main__ import main
from core.design import Tolerance, edited, get, only, put
from core.numerics.lazy import Cancelled
from core.process import resources
from core.project import load
from core.study import Study, extremes_of, findings_of, many
from core.study.batch import design_block
from core.study.quantities import quantity
from core.varying import (
    Goal,
    StudyFile,
    StudyLimit,
    VariedField,
    descent,
    load_study,
    optimise,
    remarks,
    study_of,
    with_words,
)
from core.varying.descent import epigraph


def translating():
    """A roller that rises 20 mm by a cycloid over 120°, returns so, and rests in between."""
    design = load(resources() / "examples" / "dwell_rise_dwell.toml")
    segments = design.drive.motion.segments
    rise, back = (replace(segments[5], span_deg=120.0, rise=sign * 20.0) for sign in (1.0, -1.0))
    motion = replace(
        design.drive.motion,
        segments=(rise, replace(segments[0], span_deg=60.0), back, replace(segments[0], span_deg=60.0)),
    )
    design = replace(design, assumed=(), drives=(replace(design.drive, motion=motion),))
    return edited(edited(design, "motion.segments[0].law", "cycloidal"), "motion.segments[2].law", "cycloidal")


def cycloid():
    """Displacement [mm], its first derivative [mm/rad] and its second of the rise, closely spaced."""
    x, beta = np.linspace(0.0, 1.0, 200_001), np.deg2rad(120.0)
    return (
        20.0 * (x - np.sin(2 * np.pi * x) / (2 * np.pi)), 20.0 / beta * (1.0 - np.cos(2 * np.pi * x)),
        20.0 * 2 * np.pi / beta**2 * np.sin(2 * np.pi * x),
    )  # fmt: skip


def best(design, vary, limits, goal, **more):
    """From one start."""
    return optimise(study_of(StudyFile(design="", vary=vary, limits=limits, goals=(goal,), **more), design), starts=1)


def smallest_cam(design):
    """Within a pressure angle of 30°."""
    limits = (StudyLimit("pressure_angle_deg", "max", max=30.0),)
    return best(design, (VariedField("cam.base_radius_mm", 5.0, 120.0),), limits, Goal("radius_mm", "max"))


@pytest.mark.parametrize("offset", [stressed(0.0), 6.0])
def test_the_base_radius_for_a_pressure_angle_is_that_of_the_closed_form(offset):
    """tan ψ = (s' - e)/(s0 + s), s0² = (Rb + Rr)² - e²; on the return -s' - e stands for s' - e."""
    design = put(translating(), "follower.offset_mm", offset)
    s, slope, _ = cycloid()
    rise, back = np.abs(slope - offset), np.abs(-slope - offset)
    s0 = max(((each / np.tan(np.deg2rad(30.0))) - s).max() for each in (rise, back))
    exact = np.hypot(s0, offset) - 10.0
    found = smallest_cam(design)
    assert found.is_feasible
    assert found.answer["cam.base_radius_mm"] == pytest.approx(exact, rel=1e-7)
    assert found.answer["cam.base_radius_mm"] >= exact * (1.0 - 1e-9)
    (binding,) = found.binding
    assert binding.limit == "pressure_angle_deg_max"
    near = many(design, {"cam.base_radius_mm": [exact * 0.999]}, ["pressure_angle_deg:max", "radius_mm:max"])
    slope_of = (found.goals["radius_mm:max"] - near.value["radius_mm:max"][0]) / (
        30.0 - near.value["pressure_angle_deg:max"][0]
    )
    assert binding.per_percent == pytest.approx(slope_of * 0.3, rel=0.01)
    again = smallest_cam(found.design)
    assert again.is_feasible
    assert not again.is_better
    assert again.design == found.design


@pytest.mark.stress
def test_of_several_drives_the_curvature_of_one_bounds_its_cam_as_if_it_were_alone():
    unit, answers = load(resources() / "examples" / "transfer_unit.toml"), []
    for design, at in ((unit, "drives[0]."), (only(unit, 0), "")):
        vary = VariedField(f"{at}cam.base_radius_mm", 300.0, 500.0)
        limits = (StudyLimit(f"{at}profile_curvature_per_mm", "max", max=0.006),)
        goals = (Goal(f"{at}radius_mm", "max"),)
        study = study_of(StudyFile(design="", vary=(vary,), limits=limits, goals=goals), design)
        found = optimise(study, starts=1)
        assert found.is_feasible
        answers += found.answer.values()
    assert answers[0] == pytest.approx(answers[1], rel=1e-6)
    assert 301.0 < answers[0] < 499.0


@pytest.mark.stress
def test_the_spring_preload_is_that_of_the_closed_form():
    """F = (P + c s + m g + m ω² s'')/cos ψ >= 30 N, without friction: P = max(30 cos ψ - c s - m g - m ω² s'')."""
    design = put(translating(), "shaft.speed_rpm", 300.0)
    s, slope, second = cycloid()
    cosine = np.cos(np.arctan(slope / (60.0 + s)))
    omega = 300.0 * np.pi / 30.0
    exact = (30.0 * cosine - 0.5 * s - 9.80665 - 1e-3 * omega**2 * second).max()
    found = best(
        design,
        (VariedField("loads.preload_n", 0.0, 400.0),),
        (StudyLimit("contact_force_n", "min", min=30.0),),
        Goal("contact_force_n", "max"),
    )
    assert found.is_feasible
    assert found.answer["loads.preload_n"] == pytest.approx(exact, rel=1e-7)


@pytest.mark.stress
@pytest.mark.parametrize("least", [30.0, 5.0])
def test_the_longest_crank_is_that_of_the_closed_form_close_to_the_edge_of_grashof(least):
    """(d + a)² = b² + c² + 2 b c cos μ stretched, (d - a)² = b² + c² - 2 b c cos μ folded; d + a = b + c is the edge of Grashof."""
    design, crank = load(resources() / "examples" / "four_bar.toml"), "linkage.links[1].points.A.x_mm"
    file = StudyFile(
        design="", vary=(VariedField(crank, 10.0, 90.0),), limits=(StudyLimit("transmission_B_deg", "min", min=least),),
        goals=(Goal("link4_deg", "range", minimise=False),),
    )  # fmt: skip
    found = optimise(study_of(file, design), starts=1)
    cosine = 2.0 * 90.0 * 70.0 * np.cos(np.deg2rad(least))
    exact = min(np.sqrt(90.0**2 + 70.0**2 + cosine) - 100.0, 100.0 - np.sqrt(90.0**2 + 70.0**2 - cosine))
    assert found.is_feasible
    assert exact * (1.0 - 1e-7) < found.answer[crank] <= exact
    assert [each.limit for each in found.binding] == ["transmission_B_deg_min"]


def test_the_solver_finds_the_optimum_of_rosen_and_suzuki():
    """Hock and Schittkowski 43: f = -44 at (0, 1, 2, -1)."""
    a = np.array([[1.0, 1, 2, 1], [1, 1, 1, 1], [1, 2, 1, 2], [2, 1, 1, 0]])
    b = np.array([[-5.0, -5, -21, 7], [1, -1, 1, -1], [-1, 0, 0, -1], [2, -1, 0, -1]])

    def rows(x):
        return a @ (x * x) + b @ x, 2.0 * a * x + b

    found = epigraph(
        rows, np.array([np.nan, 8.0, 10.0, 5.0]), np.ones(4), np.zeros(4), np.full(4, -10.0), np.full(4, 10.0)
    )
    assert found == pytest.approx([0.0, 1.0, 2.0, -1.0], abs=1e-6)
    assert rows(found)[0][0] == pytest.approx(-44.0, abs=1e-9)


def test_the_largest_of_several_functions_is_made_least():
    """Minimise max(|x - 1|, |x + y|, |y - 2|): 1 at (0, 1)."""
    a, c = np.array([[1.0, 0], [1, 1], [0, 1]]), np.array([-1.0, 0, -2])
    signed, offset = np.vstack([a, -a]), np.concatenate([c, -c])
    found = epigraph(
        lambda x: (signed @ x + offset, signed),
        np.full(6, np.nan),
        np.ones(6),
        np.array([3.0, 3.0]),
        *np.array([[-5.0] * 2, [5.0] * 2]),
    )
    assert np.abs(a @ found + c).max() == pytest.approx(1.0, abs=1e-9)


@pytest.mark.stress
def test_all_lengths_of_the_lift_lower_its_contact_force_by_two_fifths():
    study = load_study(resources() / "studies" / "lift_all_lengths.toml")
    found = optimise(study, starts=1)
    assert found.is_feasible
    assert found.is_better
    key = "contact_force_n:max"
    assert found.goals[key] <= 0.6 * found.before[key]
    over = extremes_of(Study(found.design), "cam", ("pressure_angle", "profile_curvature"))
    assert np.rad2deg(over["pressure_angle"].high.value) <= 30.0
    assert 1.0 / over["profile_curvature"].high.value >= 0.075
    for row in study.file.vary:
        own, answer = get(study.base, row.field), found.answer[row.field]
        assert abs(answer / own - 1.0) <= 0.2 + 1e-5
    assert not {each.code for each in findings_of(Study(found.design))} - {
        each.code for each in findings_of(Study(study.base))
    }
    rng, paths = np.random.default_rng(0), [row.field for row in study.file.vary]
    low, high = (np.array([getattr(row, end) for row in study.file.vary]) for end in ("low", "high"))
    answer = np.array([found.answer[path] for path in paths])
    beside = np.clip(
        answer[:, None] + rng.normal(0.0, 0.003, (len(paths), 500)) * (high - low)[:, None], low[:, None], high[:, None]
    )
    near = many(
        found.design,
        dict(zip(paths, beside, strict=True)),
        [key, "pressure_angle_deg:max", "profile_curvature_per_mm:max"],
    )
    within = (near.value["pressure_angle_deg:max"] <= 30.0) & (near.value["profile_curvature_per_mm:max"] <= 1 / 75.0)
    assert near.value[key][within].min() >= found.goals[key] * (1.0 - 1e-7)


@pytest.mark.stress
def test_of_the_least_peak_torque_is_said_what_the_force_fixes_and_which_law_gives_more():
    """At the answer the force on the guide changes its sign between two peaks of the same height: with both the multipliers are right."""
    study = load_study(resources() / "studies" / "lift_least_torque.toml")
    found = optimise(study, starts=1)
    key = "drive_torque_nm:abs"
    assert found.is_feasible
    assert found.goals[key] < 0.9635 * found.before[key]
    wider = [replace(each, max=30.3) if each.quantity == "pressure_angle_deg" else each for each in study.file.limits]
    relaxed = optimise(study_of(replace(study.file, limits=tuple(wider)), found.design), starts=1)
    per_percent = {each.limit: each.per_percent for each in found.binding}
    assert relaxed.goals[key] - found.goals[key] == pytest.approx(per_percent["pressure_angle_deg_max"], rel=0.05)
    at_bounds = {
        row.field
        for row in study.file.vary
        if min(abs(found.answer[row.field] - end) for end in (row.low, row.high)) < 1e-9
    }
    assert at_bounds < set(per_percent)
    fixed, law = remarks(study, found)
    torque = extremes_of(Study(found.design), "dynamics", ("drive_torque",))["drive_torque"]
    peak = max(torque.low, torque.high, key=lambda end: abs(end.value))
    slope = quantity("velocity").value(there := Study(found.design).at_theta(np.array([peak.theta])))[0] / there.omega
    assert f"{20000.0 * slope:.4g} of {found.goals[key]:.4g} N·m are force times y'" in fixed
    assert f"at {np.rad2deg(peak.theta):.4g}°" in fixed
    name, value = re.search(r"\((\S+)\), with the same numbers brings the first goal to ([0-9.]+) N·m", law).groups()
    design = with_words(found.design, {f"motion.segments[{i}].law": name for i in (1, 3)})
    asked = many(design, {"cam.base_radius_mm": [found.answer["cam.base_radius_mm"]]}, [key, "pressure_angle_deg:max"])
    assert asked.value[key][0] == pytest.approx(float(value), rel=1e-4)
    assert asked.value[key][0] < 0.9 * found.goals[key]
    assert asked.value["pressure_angle_deg:max"][0] <= 30.0
    codes = {each.code for each in findings_of(Study(design))}
    assert codes <= {"convex-radius"}  # of which the study states its own limit


def test_a_small_torque_is_named_with_its_digits_and_a_limit_that_none_keeps_with_what_is_reached():
    rocker = load(resources() / "examples" / "rocker_cam.toml")
    asked = StudyFile(
        design="",
        vary=(VariedField("cam.base_radius_mm", 44.0, 46.0),),
        limits=(StudyLimit("pressure_angle_deg", "max", max=40.0),),
        goals=(Goal("drive_torque_nm", "abs"),),
    )
    study = study_of(asked, rocker)
    found = optimise(study, starts=1)
    assert re.search(
        r"force times y' alone is 5\.\d{3} N·m, more than all 5\.\d{3} N·m, at 121\.\d°", remarks(study, found)[0]
    )
    strict = study_of(replace(asked, limits=(replace(asked.limits[0], max=5.0),)), rocker)
    missed = optimise(strict, starts=1)
    assert not missed.is_feasible
    reached = extremes_of(Study(missed.design), "cam", ("pressure_angle",))["pressure_angle"].high.value
    (said,) = remarks(strict, missed)
    assert said == f"pressure_angle_deg:max = {np.rad2deg(reached):.5g}, most 5"


def two_numbers(design):
    """The smallest cam within 30°, by base radius and offset."""
    vary = (VariedField("cam.base_radius_mm", 5.0, 120.0), VariedField("follower.offset_mm", -10.0, 10.0))
    limits, goals = (StudyLimit("pressure_angle_deg", "max", max=30.0),), (Goal("radius_mm", "max"),)
    return study_of(StudyFile(design="", vary=vary, limits=limits, goals=goals), design)


def test_six_starts_advance_in_step_and_hardly_need_more_solutions_than_one(monkeypatch):
    blocks, steps, study = [], [], two_numbers(translating())
    monkeypatch.setattr(descent, "design_block", lambda *rows: blocks.append(rows[2].shape[1]) or design_block(*rows))
    single = optimise(study, starts=1)
    count = len(blocks)
    blocks.clear()
    found = optimise(study, lambda fields, goal, start: steps.append((start, fields)), starts=6)
    assert (found.starts, found.agreeing) == (6, 6)
    assert found.goals == pytest.approx(single.goals, rel=1e-6)
    assert list(found.answer.values()) == pytest.approx(list(single.answer.values()), rel=1e-6, abs=1e-6)
    assert len(blocks) < 2 * count
    assert [start for start, _ in steps[:6]] == [1, 2, 3, 4, 5, 6]
    ends = [dict(steps)[start] for start in range(1, 7)]
    assert all(np.allclose(list(end.values()), list(found.answer.values()), atol=0.2) for end in ends)


@pytest.mark.stress
def test_of_equally_good_designs_that_of_the_first_start_is_chosen():
    """The largest contact force depends on the sum of base radius and roller radius: the starts end at different radii."""
    study = load_study(resources() / "studies" / "lift_all_lengths.toml")
    found, first = optimise(study), optimise(study, starts=1)
    assert found.agreeing == 6
    assert list(found.answer.values()) == pytest.approx(list(first.answer.values()), rel=1e-9)


def test_a_search_that_is_stopped_stops_all_starts():
    study, steps = two_numbers(translating()), []

    def stop(fields, goal, start):
        steps.append(start)
        if len(steps) == 8:
            raise Cancelled

    before = threading.active_count()
    with pytest.raises(Cancelled):
        optimise(study, stop)
    assert len(steps) == 8
    assert threading.active_count() == before


def test_the_statistics_of_scipy_are_not_loaded():
    code = "import sys; from core.__main__ import main; main(sys.argv[1:]); print('scipy.stats' in sys.modules)"
    words = [sys.executable, "-c", code, "optimise", str(resources() / "studies" / "lift_smallest_cam.toml"), "--json"]
    told = subprocess.run(
        words, capture_output=True, text=True, check=True, cwd=resources().parent, encoding="utf-8"
    ).stdout
    assert told.endswith("}\nFalse\n")


def front_and_grid(count):
    """Points (n, 2) of the front of the size of a cam and its pressure angle, and those of a grid of base radius and offset."""
    design, keys = translating(), ["radius_mm:max", "pressure_angle_deg:max"]
    file = StudyFile(
        design="", goals=(Goal("radius_mm", "max"), Goal("pressure_angle_deg", "max")),
        vary=(VariedField("cam.base_radius_mm", 20.0, 100.0), VariedField("follower.offset_mm", -10.0, 10.0)),
    )  # fmt: skip
    front = optimise(study_of(file, design), starts=1).front
    radius, offset = (
        each.ravel() for each in np.meshgrid(np.linspace(20.0, 100.0, count), np.linspace(-10.0, 10.0, count))
    )
    grid = many(design, {"cam.base_radius_mm": radius, "follower.offset_mm": offset}, keys)
    points = np.array([[each["radius_mm_max"], each["pressure_angle_deg_max"]] for each in front])
    return points, np.array([grid.value[key] for key in keys]).T


def dominated(points, grid):
    return [(grid < point * (1.0 - 1e-9)).all(axis=1).any() for point in points]


def test_two_goals_give_a_front_none_of_whose_points_is_dominated():
    points, grid = front_and_grid(20)
    assert len(points) >= 20
    assert (np.diff(points[:, 0]) > 0.0).all()
    assert (np.diff(points[:, 1]) < 0.0).all()
    assert not any(dominated(points, grid))
    assert all(dominated(1.1 * points[1:-1], grid)), "the grid lies close behind it"


@pytest.mark.fuzz
def test_no_point_of_a_grid_of_two_hundred_dominates_the_front():
    assert not any(dominated(*front_and_grid(200)))


@pytest.mark.fuzz
def test_no_pivot_of_a_grid_of_four_hundred_is_better_than_the_best():
    design, x, y = load(resources() / "examples" / "transfer_lift.toml"), "follower.pivot_x_mm", "follower.pivot_y_mm"
    pressure, torque = "pressure_angle_deg:max", "drive_torque_nm:abs"
    vary = (VariedField(x, 750.0, 1000.0), VariedField(y, -150.0, 0.0))
    found = best(design, vary, (StudyLimit("drive_torque_nm", "abs", max=7500.0),), Goal("pressure_angle_deg", "max"))
    assert found.is_better
    across, along = (np.linspace(row.low, row.high, 400) for row in vary)
    rough, places = [], [dict(zip((x, y), each, strict=True)) for each in ((across, np.full(400, at)) for at in along)]
    for place in places:
        row = many(design, place, [pressure, torque], polish=False)
        rough.append(np.where(row.value[torque] <= 7500.0 * 1.002, row.value[pressure], np.inf))
    i, j = np.unravel_index(np.argsort(np.array(rough), axis=None)[:2000], (400, 400))
    exact = many(design, {x: across[j], y: along[i]}, [pressure, torque]).value
    within = exact[torque] <= 7500.0
    assert within.sum() > 100
    assert found.goals[pressure] <= exact[pressure][within].min() < found.goals[pressure] * 1.01


def test_a_robust_answer_keeps_its_limit_in_the_machines_that_are_made():
    design = replace(
        translating(), tolerances=(Tolerance("cam.base_radius_mm", 0.6), Tolerance("follower.offset_mm", 0.3))
    )
    vary, limits = (
        (VariedField("cam.base_radius_mm", 5.0, 120.0),),
        (StudyLimit("pressure_angle_deg", "max", max=30.0),),
    )
    plain = best(design, vary, limits, Goal("radius_mm", "max"))
    sure = best(design, vary, limits, Goal("radius_mm", "max"), robust=0.9973)
    assert sure.is_feasible
    assert sure.share.interval[0] >= 0.9973
    assert sure.share.machines >= 1420
    assert (
        plain.answer["cam.base_radius_mm"]
        < sure.answer["cam.base_radius_mm"]
        < plain.answer["cam.base_radius_mm"] + 3.0
    )


def test_side_face_and_sense_are_each_tried_and_what_is_no_better_changes_nothing():
    design = load(resources() / "examples" / "rocker_cam.toml")
    words = {"follower.side": ("left", "right"), "follower.face": ("roller", "knife"), "shaft.rotation": ("ccw", "cw")}
    vary = tuple(VariedField(path, choices=each) for path, each in words.items())
    found = best(design, vary, (), Goal("contact_force_n", "max"))
    forces = {}
    for each in itertools.product(*words.values()):
        made = with_words(design, dict(zip(words, each, strict=True)))
        forces[each] = many(made, {"loads.gravity_m_s2": [9.80665]}, ["contact_force_n:max"]).value[
            "contact_force_n:max"
        ][0]
    assert found.goals["contact_force_n:max"] == min(forces.values())
    assert forces[tuple(found.answer.values())] == min(forces.values())
    assert found.is_better
    four_bar = load(
        resources() / "examples" / "four_bar.toml"
    )  # in its mirror image the transmission angle is the same
    branch, goal = (
        VariedField("linkage.branch.B", low=-1.0, high=1.0),
        Goal("transmission_B_deg", "min", minimise=False),
    )
    same = best(four_bar, (branch,), (), goal)
    assert same.is_feasible
    assert not same.is_better
    assert same.design == four_bar
    other = best(four_bar, (branch,), (), Goal("link3_deg", "mean"))
    assert other.answer == {"linkage.branch.B": -get(four_bar, "linkage.branch.B")}


def test_the_command_tries_words_and_writes_the_best_design(tmp_path, capsys):
    shutil.copy(resources() / "examples" / "transfer_lift.toml", tmp_path / "lift.toml")
    text = """design = "lift.toml"
[[vary]]
field = "motion.segments[1].law"
choices = ["modified-sine", "cycloidal", "modified-trapezoid"]
[[vary]]
field = "motion.segments[3].law"
choices = ["modified-sine", "cycloidal", "modified-trapezoid"]
[[goals]]
quantity = "acceleration_mm_s2"
of = "abs"
"""
    (tmp_path / "study.toml").write_text(text, "utf-8")
    assert main(["optimise", str(tmp_path / "study.toml"), "--into", str(tmp_path / "best.toml"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["answer"] == {
        "motion.segments[1].law": "modified-trapezoid",
        "motion.segments[3].law": "modified-trapezoid",
    }
    assert [each.curve.law for each in load(tmp_path / "best.toml").drive.motion.segments[1::2]] == [
        "modified-trapezoid"
    ] * 2
    (tmp_path / "study.toml").write_text(
        text + '[[limits]]\nquantity = "pressure_angle_deg"\nof = "max"\nmax = 5.0\n', "utf-8"
    )
    assert main(["optimise", str(tmp_path / "study.toml"), "--into", str(tmp_path / "none.toml"), "--json"]) == 2
    assert "no design satisfies the limits" in capsys.readouterr().err
    assert not (tmp_path / "none.toml").exists()
    far = text + '[[vary]]\nfield = "follower.pivot_x_mm"\nlow = 3000.0\nhigh = 3100.0\n'
    (tmp_path / "study.toml").write_text(far, "utf-8")
    assert main(["optimise", str(tmp_path / "study.toml"), "--into", str(tmp_path / "none.toml")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "none of the 128 designs can be built, most (128) for no-assembly" in said


READY = sorted(path.stem for path in (resources() / "studies").glob("*.toml"))


@pytest.mark.parametrize("name", READY)
def test_each_study_that_comes_with_the_program_fits_its_design(name):
    assert load_study(resources() / "studies" / f"{name}.toml").file.goals


@pytest.mark.fuzz
@pytest.mark.parametrize("name", READY)
def test_none_of_ten_thousand_neighbours_of_an_answer_is_better(name, tmp_path, capsys):
    path = resources() / "studies" / f"{name}.toml"
    assert main(["optimise", str(path), "--into", str(tmp_path / "best.toml"), "--json"]) == 0
    told, study, best = json.loads(capsys.readouterr().out), load_study(path), load(tmp_path / "best.toml")
    assert told["better"]
    assert {each.code for each in findings_of(Study(best))} <= {each.code for each in findings_of(Study(study.base))}
    numbers = [row for row in study.file.vary if row.low is not None]
    if not numbers:
        return
    rng = np.random.default_rng(0)
    low, high = (np.array([getattr(row, end) for row in numbers])[:, None] for end in ("low", "high"))
    answer = np.array([told["answer"][row.field] for row in numbers])[:, None]
    reach = 10.0 ** rng.uniform(-6.0, -1.0, 10_000)  # of the bounds
    beside = np.clip(answer + (high - low) * reach * rng.normal(size=(len(numbers), 10_000)), low, high)
    near = many(
        best, dict(zip((row.field for row in numbers), beside, strict=True)), [row.key for row in study.quantities]
    )
    within = np.all([near.value[each.key] <= each.max for each in study.file.limits], axis=0)
    assert within.sum() > 100
    goal = study.file.goals[0]
    assert near.value[goal.key][within].min() >= told["goal"] * (1.0 - 2e-6)
