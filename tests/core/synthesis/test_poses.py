"""Linkages that guide a body through poses: pivots, sweeps, the command, refusals."""

import cmath
import json
from math import radians
from pathlib import Path

import numpy as np
import pytest

from core.__main__ import main
from core.errors import DesignError
from core.project import load
from core.study import Study
from core.synthesis import AnswerLimits, Area, BodyPose, Pivot, Task, synthesise, task_of
from core.synthesis.poses import pose_dyads

THREE = (BodyPose(0.0, 0.0, 0.0), BodyPose(30.0, 10.0, 20.0), BodyPose(60.0, 15.0, 45.0))


def test_pivots_are_where_they_were_typed(tmp_path: Path) -> None:
    pivots = Pivot(dyad=1, of="fixed", x_mm=0.0, y_mm=-50.0), Pivot(dyad=2, of="fixed", x_mm=60.0, y_mm=-50.0)
    synthesis = synthesise(Task(kind="poses", poses=THREE, pivots=pivots))
    (answer,) = synthesis.answers
    assert synthesis.complete
    assert synthesis.hidden == 0
    frame = answer.candidate.linkage.by_number[1].places
    assert sorted(frame.values(), key=lambda z: z.real) == [-50j, 60 - 50j]


def test_pivots_lie_on_their_lines() -> None:
    line = (0.0, -40.0, 15.0)
    pivots = (Pivot(of="fixed", line=line),)
    synthesis = synthesise(Task(kind="poses", poses=THREE, pivots=pivots))
    along = cmath.exp(1j * radians(line[2]))
    for answer in synthesis.answers[: synthesis.shown]:
        for z in answer.candidate.linkage.by_number[1].places.values():
            assert abs(((z - complex(line[0], line[1])) / along).imag) < 1e-9


@pytest.mark.parametrize("at", [(0.0, -50.0), (400.0, 90.0)])
def test_one_typed_pivot_leaves_as_many_linkages_as_none(at: tuple[float, float]) -> None:
    for poses in (THREE, THREE[:2]):
        synthesis = synthesise(
            Task(kind="poses", poses=poses, pivots=(Pivot(dyad=2, of="fixed", x_mm=at[0], y_mm=at[1]),))
        )
        shown = synthesis.answers[: synthesis.shown]
        assert len(shown) >= 20
        assert max(answer.error_mm for answer in shown) < 1e-9 * 400.0
        for answer in shown:
            assert complex(*at) in answer.candidate.linkage.by_number[1].places.values()


def test_a_body_that_only_shifts_is_moved_by_parallelograms_that_swing_between_their_dead_positions() -> None:
    poses = BodyPose(0.0, 0.0), BodyPose(30.0, 10.0), BodyPose(60.0, 0.0)
    synthesis = synthesise(Task(kind="poses", poses=poses))
    best = synthesis.answers[0]
    assert synthesis.shown >= 20
    assert not best.turns_fully
    assert best.transmission_deg > 45.0
    linkage = best.candidate.linkage
    (o2, o4), (a, b) = (linkage.by_number[1].places.values(), (linkage.by_number[3].places[name] for name in "AB"))
    assert abs((o4 - o2) - (b - a)) < 1e-9 * 60.0


def test_poses_that_no_linkage_passes_in_their_order_have_linkages_with_that_defect() -> None:
    poses = THREE[0], THREE[2], THREE[1], BodyPose(90.0, 5.0, 60.0)
    synthesis = synthesise(Task(kind="poses", poses=poses, limits=AnswerLimits(order=True)))
    assert synthesis.shown == 0
    assert synthesis.answers[0].defects == ("order",)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_fewer_poses_are_swept_and_met_by_the_solved_linkage(count: int, tmp_path: Path) -> None:
    poses = (*THREE, BodyPose(90.0, 5.0, 60.0))[:count]
    synthesis = synthesise(Task(kind="poses", poses=poses))
    assert not synthesis.complete
    assert 12 <= synthesis.shown <= 24
    worst = max(max(answer.error_mm, answer.error_deg) for answer in synthesis.answers[: synthesis.shown])
    assert worst < 1e-9 * 100.0
    angles = [answer.transmission_deg for answer in synthesis.answers[:5]]
    assert angles == sorted(angles, reverse=True)


@pytest.mark.parametrize("direction", [0.0, 20.0, 45.0, 90.0])
@pytest.mark.stress
def test_two_poses_without_a_turn_have_linkages(direction: float) -> None:
    along = 40.0 * cmath.exp(1j * radians(direction))
    poses = BodyPose(0.0, 0.0, 0.0), BodyPose(along.real, along.imag, 0.0)
    synthesis = synthesise(Task(kind="poses", poses=poses))
    assert synthesis.shown >= 12
    assert max(answer.error_mm for answer in synthesis.answers) < 1e-9 * 40.0


def test_a_written_answer_runs_through_the_poses(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    task, out = tmp_path / "task.toml", tmp_path / "out"
    lines = [f"[[poses]]\nx_mm = {p.x_mm}\ny_mm = {p.y_mm}\nangle_deg = {p.angle_deg}" for p in THREE]
    task.write_text('kind = "poses"\n' + "\n".join(lines), "utf-8")
    assert main(["synthesise", str(task), "--out", str(out), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert {"answers", "dyads", "hidden", "complete"} == set(data)
    first = data["answers"][0]
    assert first["rank"] == 1
    assert first["design"] == "rank1.toml"
    assert first["error_mm"] < 1e-9
    header, row, *_ = (out / "answers.csv").read_text("utf-8").splitlines()
    assert (
        header == "rank,kind,design,error_mm,error_deg,defects,transmission_deg,grashof,length_ratio,size_mm,cognates"
    )
    assert row.startswith("1,")
    design = load(out / "rank1.toml")
    assert main(["check", str(out / "rank1.toml")]) == 0
    linkage = design.drive.linkage
    pose = THREE[1]
    a = linkage.by_number[3].places["A"]
    q = cmath.phase(
        complex(pose.x_mm, pose.y_mm) + a * cmath.exp(1j * radians(pose.angle_deg)) - linkage.by_number[1].places["O2"]
    )
    study = Study(design)
    crank = study.linkage.bodies["link2"].angle[0]
    nearest = int(np.abs(np.exp(1j * crank) - cmath.exp(1j * q)).argmin())
    body = study.linkage.bodies["link3"]
    assert abs(1e3 * body.fixed_point(0j)[0][nearest] - complex(pose.x_mm, pose.y_mm)) < 2.0


EQUAL = [{"x_mm": 1.0, "y_mm": 2.0, "angle_deg": 3.0}] * 2
ROWS = [{"x_mm": p.x_mm, "y_mm": p.y_mm, "angle_deg": p.angle_deg} for p in THREE]


@pytest.mark.parametrize(
    ("table", "field"),
    [
        ({"poses": EQUAL}, r"poses\[1\]: is equal to poses\[0\]"),
        ({"poses": ROWS[:1]}, "poses: 1 pose; allowed: 2 ... 5"),
        ({"poses": [dict(row, x_mm=k * 9.0) for k, row in enumerate(ROWS * 2)]}, "poses: 6 poses; allowed: 2 ... 5"),
        (
            {"poses": [{"x_mm": x, "y_mm": 2.0 * x} for x in (0.0, 10.0, 30.0)]},
            "poses: are all on one line without a turn",
        ),
        (
            {
                "poses": [{"x_mm": 5.0 - y, "y_mm": y, "angle_deg": a} for y, a in ((0.0, 0.0), (5.0, 90.0))]
                + [{"x_mm": 0.0, "y_mm": -5.0, "angle_deg": -90.0}]
            },
            r"poses: are turns about one point, where a single pivot guides the body: \(0, 0\) mm; allowed: a shift of one pose",
        ),
        (
            {"poses": ROWS, "pivots": [{"of": "fixed", "x_mm": 0.0, "y_mm": 0.0}] * 2},
            r"pivots\[1\]: the fixed pivot of dyad 1",
        ),
        (
            {
                "poses": ROWS,
                "pivots": [{"of": "fixed", "x_mm": 0.0, "y_mm": 0.0}, {"of": "moving", "line": [0.0, 0.0, 9.0]}],
            },
            r"pivots\[1\]: the pivots of dyad 1 set 3 conditions, 3 poses leave 2",
        ),
        ({"poses": ROWS, "pivots": [{"of": "fixed", "line": [0.0, 1.0]}]}, r"pivots\[0\].line"),
        (
            {"poses": ROWS, "path": {"points": [[0.0, 0.0], [1.0, 2.0], [3.0, 1.0]]}},
            "path: is not used by a task of kind poses",
        ),
        ({"poses": ROWS, "area": {"low": [5.0, 0.0], "high": [1.0, 9.0]}}, "area.high"),
        (
            {"poses": ROWS, "pivots": [{"of": "fixed", "x_mm": 0.0, "y_mm": 0.0}]},
            r"pivots\[0\]: a position belongs to one dyad, not to both; allowed: dyad = 1 \| 2",
        ),
        (
            {
                "poses": ROWS,
                "pivots": [{"dyad": 2, "of": "fixed", "x_mm": 0.0, "y_mm": 70.0}],
                "area": {"low": [-90.0, -90.0], "high": [90.0, 60.0]},
            },
            r"pivots\[0\]: y = 70 mm is outside of the area; allowed: y = -90 ... 60 mm",
        ),
    ],
)
def test_bad_tasks_are_refused_with_their_field(table: dict[str, object], field: str) -> None:
    with pytest.raises(DesignError, match=field) as refused:
        synthesise(task_of({"kind": "poses", **table}))
    assert len(str(refused.value).splitlines()) == 1


def test_poses_without_dyads_name_the_change_that_gives_some(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        poses = tuple(BodyPose(*map(float, rng.normal(size=2) * 50.0), float(rng.uniform(0, 360))) for _ in range(5))
        if not pose_dyads(Task(kind="poses", poses=poses)).all:
            break
    task = tmp_path / "task.toml"
    lines = [f"[[poses]]\nx_mm = {p.x_mm}\ny_mm = {p.y_mm}\nangle_deg = {p.angle_deg}" for p in poses]
    task.write_text('kind = "poses"\n' + "\n".join(lines), "utf-8")
    assert main(["synthesise", str(task)]) == 2
    message = capsys.readouterr().err
    assert "poses: have no two dyads; allowed: poses[" in message
    assert len(message.splitlines()) == 1


def test_the_curve_of_dyads_through_four_poses_is_swept_in_both_directions() -> None:
    """Exchanging x and y of all poses and turning the other way round mirrors the dyads; a sweep along x alone would not."""
    poses = ((0.0, 0.0, 0.0), (60.0, 20.0, 30.0), (110.0, 10.0, 60.0), (140.0, -20.0, 80.0))
    area = Area(-300.0, -300.0, 300.0, 300.0)
    there = Task(kind="poses", poses=tuple(BodyPose(*pose) for pose in poses), area=area)
    mirrored = Task(kind="poses", poses=tuple(BodyPose(y, x, 90.0 - a) for x, y, a in poses), area=area)
    fixed, swapped = (sorted((d.fixed for d in pose_dyads(task).all), key=abs) for task in (there, mirrored))
    assert len(fixed) == len(swapped) > 60
    for z in fixed:
        assert min(abs(complex(z.imag, z.real) - other) for other in swapped) < 1e-5
