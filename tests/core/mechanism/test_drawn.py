"""A linkage as it is drawn: the nearest assembly, what names it, a crank to and fro, and the same by signs."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkages import SLIDING_GROUP, four_bar, link, slider_crank

from core.__main__ import main
from core.design import Design, Drawn, LinkPoint, get, put, with_drive
from core.errors import DesignError, NoPosition
from core.mechanism.drivers import with_drawn_pose, with_signs
from core.project import load, save
from core.study import Study, findings_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
LINKAGES = sorted(p.stem for p in EXAMPLES.glob("*.toml") if "\n[linkage]\n" in p.read_text("utf-8"))


def drawn(design: Design, driver_deg: float | None = None, driver_mm: float | None = None, **points: complex) -> Design:
    places = tuple(LinkPoint(name, z.real, z.imag) for name, z in points.items())
    linkage = replace(design.drive.linkage, branch=(), drawn=Drawn(driver_deg, driver_mm, places))
    return with_drive(design, mechanism=linkage)


@pytest.mark.parametrize("name", LINKAGES)
def test_examples_drawn_at_any_angle_run_as_by_their_signs_and_come_back_to_them(name: str) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    whole = Study(design, 36)
    for theta in whole.theta[[1, 17]]:
        as_drawn = with_drawn_pose(design, whole.at_theta(np.array([theta])).linkage)
        assert as_drawn.drive.linkage.branch == ()
        study = Study(as_drawn, 36)
        for body, pose in whole.linkage.bodies.items():
            assert np.abs(study.linkage.bodies[body].z - pose.z).max() <= 1e-12 * np.abs(pose.z).max()
        back = with_signs(as_drawn).drive.linkage
        assert back.drawn is None
        assert set(design.drive.linkage.branch) <= set(back.branch)


def test_a_rough_pose_is_enough_and_the_other_side_is_the_other_assembly() -> None:
    bar = four_bar(60.0, 20.0, 50.0, 40.0)
    for side, b in ((1, 40 + 35j), (-1, 40 - 35j)):
        assert [s.side for s in with_signs(drawn(bar, 45.0, B=b)).drive.linkage.branch] == [side]


def test_a_group_is_assembled_as_drawn() -> None:
    whole = Study(SLIDING_GROUP, 24)
    pose = whole.at_theta(whole.theta[[5]]).linkage
    made = Study(with_drawn_pose(SLIDING_GROUP, pose), 24)
    for body, each in whole.linkage.bodies.items():
        assert np.abs(made.linkage.bodies[body].z[0] - each.z[0]).max() <= 1e-9 * np.abs(each.z[0]).max()


def test_a_crank_that_cannot_turn_swings_between_the_dead_centres_of_the_drawn_circuit(tmp_path: Path) -> None:
    bar = drawn(four_bar(60.0, 40.0, 50.0, 35.0), 15.0, A=38.6 + 10.4j, B=65 - 35j)
    save(bar, tmp_path / "bar.toml")
    assert main(["export", str(tmp_path / "bar.toml"), "--out", str(tmp_path), "--samples", "720"]) == 0
    with (tmp_path / "linkage.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0])[:2] == ["cycle_deg", "driver_angle_deg"]
    end = math.degrees(math.acos((60.0**2 + 40.0**2 - 85.0**2) / (2 * 60.0 * 40.0)))  # both rods stretched
    for row in rows:
        cycle, q = float(row["cycle_deg"]), float(row["driver_angle_deg"])
        assert q == pytest.approx(end * (cycle / 90.0 - 1.0 if cycle < 180.0 else 3.0 - cycle / 90.0), abs=1e-7)
        b = complex(float(row["B_x_mm"]), float(row["B_y_mm"])) - 60.0
        assert abs(abs(b) - 35.0) < 1e-10
    forth, back = rows[100], rows[len(rows) - 1 - 100]
    assert float(forth["B_x_mm"]) == pytest.approx(float(back["B_x_mm"]), abs=1e-9)
    assert float(forth["B_vx_mm_s"]) == pytest.approx(-float(back["B_vx_mm_s"]), abs=1e-6)
    speed = math.hypot(float(forth["A_vx_mm_s"]), float(forth["A_vy_mm_s"]))
    assert speed == pytest.approx(40.0 * 2.0 * math.pi, rel=1e-9)  # 60 rpm, there and back
    (found,) = [f for f in findings_of(Study(load(tmp_path / "bar.toml"))) if f.code == "swinging-driver"]
    assert found.severity == "note"
    assert found.values["low"] == pytest.approx(-end, abs=1e-9)
    assert found.values["high"] == pytest.approx(end, abs=1e-9)


def test_of_two_circuits_the_drawn_one_is_run_and_the_other_listed() -> None:
    bar = four_bar(60.0, 40.0, 60.0, 30.0)  # locks stretched and folded
    for at, side in ((50.0, 1.0), (-50.0, -1.0)):
        study = Study(drawn(bar, at, B=complex(85, side * 15)), 36)
        (found,) = [f for f in findings_of(study) if f.code == "swinging-driver"]
        assert found.values["low"] < at < found.values["high"]
        assert "could be assembled within" in found.message


def test_a_tie_is_refused_and_a_tracer_breaks_it() -> None:
    inverted = load(EXAMPLES / "inverted_slider_crank.toml")
    whole = Study(inverted, 36)
    here = with_drawn_pose(inverted, whole.at_theta(whole.theta[[3]]).linkage)
    frame = set(inverted.drive.linkage.by_number[1].places)
    shared = [p for p in here.drive.linkage.drawn.points if p.name == "A" or p.name in frame]
    tied = put(here, "linkage.drawn", replace(here.drive.linkage.drawn, points=tuple(shared)))
    with pytest.raises(NoPosition, match="equally near to the drawing") as refused:
        _ = Study(tied).linkage
    assert "\n" not in str(refused.value)
    bar = four_bar(60.0, 20.0, 50.0, 40.0)
    links = (*bar.drive.linkage.links[:2], link(3, A=(0, 0), B=(50, 0), C=(20, 15)), bar.drive.linkage.links[3])
    traced = with_drive(bar, mechanism=replace(bar.drive.linkage, links=links))
    assert with_signs(drawn(traced, 45.0, C=20 + 40j)).drive.linkage.branch[0].side == 1


def test_what_is_drawn_is_read_and_written_and_its_faults_are_named(tmp_path: Path) -> None:
    bar = drawn(four_bar(60.0, 20.0, 50.0, 40.0), 45.0, A=14 + 14j, B=40 + 35j)
    save(bar, tmp_path / "bar.toml")
    assert load(tmp_path / "bar.toml") == bar
    assert get(bar, "linkage.drawn.B.y_mm") == 35.0
    text = (tmp_path / "bar.toml").read_text("utf-8")
    wrong = text.replace("A = [14.0", "Q = [14.0").replace("driver_deg", "driver_mm")
    (tmp_path / "wrong.toml").write_text(wrong.replace("drawn =", "branch = { B = 1 }\ndrawn ="), "utf-8")
    with pytest.raises(DesignError) as refused:
        load(tmp_path / "wrong.toml")
    paths = {fault.path for fault in refused.value.faults}
    assert {"linkage.branch", "linkage.drawn.Q", "linkage.drawn.driver_mm", "linkage.drawn.driver_deg"} <= paths


def test_a_motion_is_drawn_at_cam_angle_0() -> None:
    design = load(EXAMPLES / "four_bar_coupler_cam.toml")
    study = Study(design, 36)
    here = with_drawn_pose(design, study.at_theta(np.zeros(1)).linkage)
    unplaced = replace(here.drive.linkage.drawn, driver_deg=None, driver_mm=None)
    made = Study(put(here, "linkage.drawn", unplaced), 36)
    assert np.array_equal(made.linkage.follower.z, study.linkage.follower.z)


def test_a_slider_crank_is_drawn_by_its_slide() -> None:
    crank = slider_crank(20.0, 60.0, 5.0)
    assert Study(drawn(crank, 30.0, B=75 + 5j), 24).linkage.bodies["link4"].x[0].min() > 0.0
    assert Study(drawn(crank, 30.0, B=-40 + 5j), 24).linkage.bodies["link4"].x[0].max() < 0.0
