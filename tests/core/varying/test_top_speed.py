"""The greatest speed within limits: a goal that is a varied field, and the search for the top speed."""

import json
from dataclasses import replace
from math import pi, sqrt
from pathlib import Path

import pytest

from core.__main__ import main
from core.design import Design, NamedCurve, Segment, get, put, with_drive
from core.process import resources
from core.project import load, save
from core.varying import Goal, StudyFile, StudyLimit, VariedField, load_study, optimise, save_study, study_of

SPEED = "shaft.speed_rpm"
STROKE, RATE, PRELOAD, MASS, LEAST = 8.0, 18.0, 140.0, 0.12, 20.0  # mm, N/mm, N, kg, N


def example(name: str) -> Design:
    return load(resources() / "examples" / f"{name}.toml")


def flat_follower() -> Design:
    """A flat tappet that rises and returns by a half cosine each, over 180 deg, without friction."""
    design = example("tappet_flat")
    rise, back = (Segment(180.0, sign * STROKE, NamedCurve("simple-harmonic")) for sign in (1.0, -1.0))
    motion = replace(design.drive.motion, segments=(rise, back))
    design = replace(with_drive(design, motion=motion), assumed=())
    for path in ("loads.friction", "loads.contact_friction"):
        design = put(design, path, 0.0)
    return design


def top_speed_of_flat_follower(least: float) -> float:
    """Speed [rpm] at which the contact force is ``least`` [N] at the top.

    With s = h (1 - cos θ)/2 the force m ω² s'' + c s + P + m g is linear in cos θ: F = c h + P + m g - m ω² h/2 at the top.
    """
    force = RATE * STROKE + PRELOAD + MASS * 9.80665 - least
    return sqrt(2.0 * force / (MASS * STROKE * 1e-3)) * 30.0 / pi


def speed_study(design: Design, *vary: VariedField, minimise: bool = False, **limits: tuple[str, float]) -> StudyFile:
    """Study whose goal is the speed; a limit is a column with a statistic and a bound, least for "min"."""
    rows = tuple(
        StudyLimit(name, of, **{"min" if of == "min" else "max": bound}) for name, (of, bound) in limits.items()
    )
    return StudyFile(design="", vary=vary, limits=rows, goals=(Goal(field=SPEED, minimise=minimise),))


@pytest.mark.parametrize("least", [0.0, LEAST])
def test_the_top_speed_of_a_flat_follower_by_contact_force_is_that_of_the_closed_form(least: float) -> None:
    design, exact = flat_follower(), top_speed_of_flat_follower(least)
    rows = (VariedField(SPEED, 120.0, 12000.0), VariedField("cam.base_radius_mm", 20.0, 30.0))
    found = optimise(study_of(speed_study(design, *rows, contact_force_n=("min", least)), design), starts=2)
    assert found.is_feasible
    assert found.before == {SPEED: 1200.0}
    assert found.goals[SPEED] == found.answer[SPEED] == get(found.design, SPEED)
    assert exact * (1.0 - 2e-6) <= found.answer[SPEED] <= exact
    assert found.binding[0].limit == "contact_force_n_min"
    # 1 % of the limit: F/100 less force is c h + P + m g - F of the square of the speed
    per_percent = 0.01 * least * exact / (2.0 * (RATE * STROKE + PRELOAD + MASS * 9.80665 - least))
    assert found.binding[0].per_percent == pytest.approx(per_percent, rel=1e-4)


def test_a_goal_that_is_a_field_is_minimised_too_and_traded_for_a_quantity() -> None:
    """The lowest speed is its bound; of speed and contact force each point of the front is faster or presses less."""
    design = flat_follower()
    rows = (VariedField(SPEED, 600.0, 2400.0),)
    slow = optimise(study_of(speed_study(design, *rows, minimise=True, contact_force_n=("min", LEAST)), design))
    assert slow.answer == {SPEED: 600.0}
    study = speed_study(design, VariedField(SPEED, 600.0, 12000.0), contact_force_n=("min", LEAST))
    both = replace(study, goals=(*study.goals, Goal("contact_force_n", "max")))
    front = optimise(study_of(both, design)).front
    points = [(point[SPEED], point["contact_force_n_max"]) for point in front]
    assert len(points) > 5
    assert sorted(points) == sorted(points, key=lambda point: point[1])


STUDY = """\
design = "tappet.toml"

[[vary]]
field = "shaft.speed_rpm"
low = 120.0
high = 12000.0

[[vary]]
field = "motion.segments[0].law"
choices = ["simple-harmonic", "cycloidal"]

[[limits]]
quantity = "contact_force_n"
of = "min"
min = 20.0

[[goals]]
field = "shaft.speed_rpm"
minimise = false
"""


def test_a_file_with_such_a_goal_is_optimised_written_and_read_back(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save(flat_follower(), tmp_path / "tappet.toml")
    path = tmp_path / "study.toml"
    path.write_text(STUDY, "utf-8")
    assert main(["optimise", str(path), "--into", str(tmp_path / "fast.toml"), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["goal"] == data["answer"][SPEED] == get(load(tmp_path / "fast.toml"), SPEED)
    assert data["before"] == 1200.0
    exact = top_speed_of_flat_follower(LEAST)
    assert exact * (1.0 - 2e-6) <= data["goal"] <= exact
    assert main(["optimise", str(path), "--round", "--json"]) == 0
    rounded = json.loads(capsys.readouterr().out)
    assert rounded["goal"] == rounded["answer"][SPEED] == float(f"{exact - 5.0:.3g}")
    study = load_study(path)
    save_study(study.file, tmp_path / "again.toml")
    assert load_study(tmp_path / "again.toml").file == study.file
    assert 'field = "shaft.speed_rpm"\nminimise = false\n' in (tmp_path / "again.toml").read_text("utf-8")


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        ('field = "cam.base_radius_mm"', "goals[0].field = 'cam.base_radius_mm': is not varied"),
        ('field = "motion.segments[0].law"', "goals[0].field = 'motion.segments[0].law': is a word"),
        ('field = "shaft.speed_rpm"\nquantity = "radius_mm"\nof = "max"', "cannot be combined with a quantity"),
        ("minimise = true", "goals[0].quantity: missing"),
    ],
)
def test_a_goal_that_no_study_can_have_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], goal: str, words: str
) -> None:
    save(flat_follower(), tmp_path / "tappet.toml")
    path = tmp_path / "study.toml"
    path.write_text(STUDY.partition("[[goals]]")[0] + f"[[goals]]\n{goal}\n", "utf-8")
    assert main(["optimise", str(path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert words in error
