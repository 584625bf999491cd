"""Answers as the command prints and writes them: key by key, ranked, each linkage once, and designs that the other commands accept."""

import csv
import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.__main__ import main
from core.findings import ERROR
from core.project import load
from core.study import Study
from core.study.certificate import certificate_of
from core.study.findings import findings_of
from core.synthesis import Answer, synthesise, task_of

POSES: dict[str, Any] = {
    "kind": "poses",
    "poses": [
        {"x_mm": 0.0, "y_mm": 0.0},
        {"x_mm": 30.0, "y_mm": 10.0, "angle_deg": 10.0},
        {"x_mm": 60.0, "y_mm": 15.0, "angle_deg": 25.0},
        {"x_mm": 90.0, "y_mm": 5.0, "angle_deg": 45.0},
    ],
    "pivots": [{"of": "fixed", "line": [0.0, -80.0, 90.0]}],
}
"""Three pins and a turning guide: three linkages without defects, three with the defect branch."""
ELLIPSE = [[90.0 * math.cos(q), 30.0 * math.sin(q)] for q in np.radians(np.arange(0.0, 360.0, 15.0)).tolist()]
PATH: dict[str, Any] = {"kind": "path", "path": {"points": ELLIPSE, "closed": True}}
ARC = {"kind": "path", "path": {"points": ELLIPSE[:9]}}
SWEEP = {"kind": "poses", "poses": POSES["poses"][:3]}
LOG = [[60.0 * (x - 1.0), 60.0 * math.log2(x)] for x in np.linspace(1.0, 2.0, 9).tolist()]
FREE = {"kind": "angles", "angles": {"pairs": LOG, "frame_mm": 100.0, "free": True}}
ROCKER: dict[str, Any] = {"kind": "rocker", "rocker": {"swing_deg": 60.0, "time_ratio": 1.2, "frame_mm": 100.0}}


def toml(table: dict[str, Any]) -> str:
    """Tables of a task as the text of a file."""

    def value(item: Any) -> str:
        if isinstance(item, dict):
            return "{" + ", ".join(f"{key} = {value(part)}" for key, part in item.items()) + "}"
        return "[" + ", ".join(map(value, item)) + "]" if isinstance(item, list) else json.dumps(item)

    return "".join(f"{key} = {value(item)}\n" for key, item in table.items())


@pytest.fixture
def task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The task of poses as a file in the current folder."""
    monkeypatch.chdir(tmp_path)
    Path("task.toml").write_text(toml(POSES), "utf-8")
    return Path("task.toml")


# -- the command ------------------------------------------------------------------------------------------------


def printed(capsys: pytest.CaptureFixture[str], *words: str, code: int = 0) -> dict[str, Any]:
    assert main(["synthesise", "task.toml", "--json", *words]) == code
    return dict(json.loads(capsys.readouterr().out))


@pytest.mark.usefixtures("task")
def test_answers_are_printed_and_written_key_by_key(capsys: pytest.CaptureFixture[str]) -> None:
    data = printed(capsys, "--out", "out", "--all")
    assert set(data) == {"answers", "dyads", "hidden", "complete"}
    assert (data["hidden"], data["complete"], len(data["answers"])) == (3, True, 6)
    kinds: dict[str, type | tuple[type, ...]] = {
        "rank": int,
        "kind": str,
        "design": str,
        "error_mm": float,
        "error_deg": float,
        "defects": list,
        "transmission_deg": float,
        "grashof": bool,
        "length_ratio": (float, type(None)),
        "size_mm": float,
        "cognates": list,
    }
    for number, row in enumerate(data["answers"], 1):
        assert list(row) == list(kinds)
        assert all(isinstance(row[key], kind) for key, kind in kinds.items())
        assert (row["rank"], row["design"]) == (number, f"rank{number}.toml")
        assert row["kind"] in ("four-bar", "slider-crank", "inverted-slider-crank")
        assert row["defects"] == ([] if number <= 3 else ["branch"])
    for row in data["dyads"]:
        line = [] if row["kind"] == "pin" else ["line_deg"]
        assert list(row) == ["kind", "fixed", "moving", *line]
    with Path("out/answers.csv").open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    assert header == list(kinds)
    for written, row in zip(rows, data["answers"], strict=True):
        for column, text in zip(header, written, strict=True):
            expected = row[column]
            if isinstance(expected, list):
                assert text.split() == expected
            elif isinstance(expected, bool):
                assert text == str(expected).lower()
            elif isinstance(expected, str):
                assert text == expected
            else:
                assert (float(text) if text else None) == expected


@pytest.mark.usefixtures("task")
def test_without_a_folder_there_are_no_files_and_hidden_answers_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    data = printed(capsys)
    assert [row["design"] for row in data["answers"]] == [None] * 3
    assert data["hidden"] == 3
    assert [path.name for path in Path().iterdir()] == ["task.toml"]
    assert main(["synthesise", "task.toml"]) == 0
    text = capsys.readouterr().out.splitlines()
    assert text[3:] == ["3 more with defects or beyond limits: --all lists them", "these are all answers"]


@pytest.mark.usefixtures("task")
def test_one_answer_is_written_by_its_rank(capsys: pytest.CaptureFixture[str]) -> None:
    printed(capsys, "--out", "out", "--all")
    for rank in (1, 3):
        printed(capsys, "--into", "one.toml", "--rank", str(rank))
        assert load(Path("one.toml")) == load(Path(f"out/rank{rank}.toml"))
    printed(capsys, "--into", "one.toml", "--rank", "6", "--all")
    assert load(Path("one.toml")) == load(Path("out/rank6.toml"))
    for words, message in (
        (("--into", "one.toml", "--rank", "4"), "--rank 4: no such answer; allowed: 1 ... 3"),
        (("--rank", "2"), "--rank 2: only together with --into FILE"),
        (("--into", "task.toml"), "--into task.toml: is a file that is read; choose another file"),
    ):
        assert main(["synthesise", "task.toml", *words]) == 2
        assert message in capsys.readouterr().err


def test_a_best_answer_beyond_a_limit_or_with_a_defect_is_an_error(
    task: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    task.write_text(toml(POSES | {"limits": {"transmission_deg_min": 80.0}}), "utf-8")
    assert main(["synthesise", "task.toml", "--into", "best.toml"]) == 1
    captured = capsys.readouterr()
    assert captured.err == "synthesise: the best answer has a value beyond transmission_deg_min\n"
    assert "1: " in captured.out
    assert Path("best.toml").exists()
    data = printed(capsys, code=1)
    assert (len(data["answers"]), data["hidden"]) == (1, 6)


@pytest.mark.stress
def test_cognates_are_written_next_to_their_answer(task: Path, capsys: pytest.CaptureFixture[str]) -> None:
    task.write_text(toml(PATH), "utf-8")
    data = printed(capsys, "--out", "out")
    assert "dyads" not in data
    names = {name for row in data["answers"] for name in (row["design"], *row["cognates"])}
    assert {path.name for path in Path("out").iterdir()} == names | {"answers.csv"}
    assert data["answers"][0]["cognates"] == ["rank1_cognate1.toml", "rank1_cognate2.toml"]


# -- each linkage once ------------------------------------------------------------------------------------------


def sides(answer: Answer) -> tuple[str, np.ndarray, np.ndarray]:
    """Kind; fixed pivot, distance of the pin from P and length of both side links (2, 4) [mm]; line of a slider."""
    links = {number: link.places for number, link in answer.candidate.linkage.by_number.items()}
    rows = []
    for number, pivot, pin in ((2, "O2", "A"), (4, "O4", "B")):
        fixed, side = links[1].get(pivot, 0j), links[number]
        rows.append((fixed.real, fixed.imag, abs(links[3].get(pin, 0j)), abs(side.get(pin, 0j) - side.get(pivot, 0j))))
    lines = [(row.through_x_mm, row.through_y_mm, row.angle_deg) for row in answer.candidate.linkage.sliders]
    return answer.candidate.kind, np.array(rows), np.array(lines)


def is_same(first: Answer, second: Answer) -> bool:
    (kind, rows, lines), (other_kind, other_rows, other_lines) = sides(first), sides(second)
    near = 1e-4 * np.abs(rows).max()
    turned = min(np.abs(rows - other_rows).max(), np.abs(rows - other_rows[::-1]).max())
    return kind == other_kind and turned < near and bool((np.abs(lines - other_lines) < near).all())


TASKS = {"poses": POSES, "rocker": ROCKER, "path": PATH, "sweep": SWEEP, "arc": ARC, "free": FREE}
EVERY_TASK = [
    name if name in ("poses", "rocker", "path") else pytest.param(name, marks=pytest.mark.stress) for name in TASKS
]


@cache
def answers_of(name: str) -> tuple[Answer, ...]:
    return synthesise(task_of(TASKS[name])).answers


@pytest.mark.parametrize("name", EVERY_TASK)
def test_no_linkage_is_listed_twice(name: str) -> None:
    """Cognates neither: a path's answers and their cognates are all different."""
    linkages = [row for answer in answers_of(name) for row in (answer, *answer.cognates)]
    assert len(linkages) >= 2
    same = [(i, k) for i, a in enumerate(linkages) for k, b in enumerate(linkages[:i]) if is_same(a, b)]
    assert same == []


def test_a_path_has_a_dozen_answers_the_closest_first() -> None:
    answers = answers_of("path")
    assert len(answers) == 12
    errors = [answer.error_mm for answer in answers if answer.is_good]
    assert errors == sorted(errors)
    assert errors[0] < 0.005 * 180.0


# -- designs ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", EVERY_TASK)
def test_designs_of_answers_have_no_finding_but_of_their_transmission(name: str) -> None:
    """A crank that cannot turn fully is noted too; every residual of the certificate is within its bound."""
    for answer in answers_of(name):
        for linkage in (answer, *answer.cognates):
            study = Study(linkage.candidate.design)
            rows = findings_of(study)
            assert {row.code for row in rows} <= {"transmission-angle", "swinging-driver"}
            assert ERROR not in {row.severity for row in rows}
            assert all(row.kept for row in certificate_of(study).values())


def test_a_written_answer_is_checked_exported_and_reported(task: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["synthesise", str(task), "--into", "best.toml"]) == 0
    assert main(["check", "best.toml"]) == 0
    assert main(["export", "best.toml", "--out", "tables", "--samples", "36"]) == 0
    assert main(["report", "best.toml", "--out", "report.html"]) == 0
    header = Path("tables/linkage.csv").read_text("utf-8").partition("\n")[0].split(",")
    assert {"driver_angle_deg", "link3_deg", "P_x_mm", "P_y_mm"} <= set(header)
