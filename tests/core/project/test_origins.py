"""Motions that follow from other files: tables, sums, and the inverse of a linkage; forward again through the linkage."""

import math
from pathlib import Path

import numpy as np
import pytest
from feeds import FEED, FOUR_BAR
from sampled import spread, stressed

from core.__main__ import main
from core.design import put
from core.errors import DesignError
from core.project import load, save
from core.project.origins import with_unlinked_motion
from core.study import Study

HEAD = 'format = 1\nname = "Driven"\n'
SLIDER_CRANK = """
[linkage]
driver = { link = 2, kind = "crank", speed_rpm = 60.0 }
[[linkage.links]]
number = 1
points = { O = [0.0, 0.0] }
[[linkage.links]]
number = 2
points = { O = [0.0, 0.0], A = [50.0, 0.0] }
[[linkage.links]]
number = 3
points = { A = [0.0, 0.0], B = [180.0, 0.0] }
[[linkage.links]]
number = 4
points = { B = [0.0, 0.0] }
[[linkage.sliders]]
link = 4
on = 1
through = [0.0, 10.0]
angle_deg = 0.0
"""
TO_AND_FRO = """
[[motion.segments]]
law = "modified-sine"
span_deg = 120.0
rise_{0} = {1}
[[motion.segments]]
law = "dwell"
span_deg = 60.0
[[motion.segments]]
law = "3-4-5"
span_deg = 180.0
rise_{0} = -{1}
"""


def crank(text: str) -> str:
    """The linkage with a crank at speed."""
    return text.replace('kind = "motion"', 'kind = "crank", speed_rpm = 60.0')


def inverse(folder: Path, linkage: str, output: str, start: float, rise: float, unit: str) -> Path:
    """A design whose crank makes the output go to and fro; the linkage stands in the folder."""
    (folder / "linkage.toml").write_text(HEAD + crank(linkage), encoding="utf-8")
    path = folder / "inverse.toml"
    motion = f'[motion]\nstart_{unit} = {start}\ninverse = {{ linkage = "linkage.toml", output = "{output}" }}\n'
    path.write_text(HEAD + motion + TO_AND_FRO.format(unit, rise).replace("= --", "= "), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("linkage", "output", "start", "rise", "unit"),
    [(SLIDER_CRANK, "4", 150.0, 60.0, "mm"), stressed(FOUR_BAR, "4", 120.0, 8.0, "deg")],
)
def test_forward_again_the_output_does_what_was_typed(tmp_path, linkage, output, start, rise, unit):
    path = inverse(tmp_path, linkage, output, start, rise, unit)
    driven = linkage.replace('kind = "crank", speed_rpm = 60.0', 'kind = "motion"')
    (tmp_path / "driven.toml").write_text(path.read_text(encoding="utf-8") + driven, encoding="utf-8")
    (tmp_path / "typed.toml").write_text(
        HEAD + f"[motion]\nstart_{unit} = {start}\n" + TO_AND_FRO.format(unit, rise).replace("= --", "= "),
        encoding="utf-8",
    )
    theta = np.deg2rad(np.arange(0.1, 360.0, 0.37))
    kinematics = Study(load(tmp_path / "driven.toml")).at_theta(theta).linkage
    got = kinematics.coordinates[f"slide{output}" if unit == "mm" else f"link{output}"]
    wanted = Study(load(tmp_path / "typed.toml")).at_theta(theta).linkage.motion.displacement
    for order in range(4):
        assert np.abs(got[order] - wanted[order]).max() <= 1e-12 * np.abs(wanted[order]).max()


def test_an_inverse_that_meets_a_dead_centre_is_refused_with_the_angle(tmp_path, capsys):
    path = inverse(tmp_path, SLIDER_CRANK, "4", 150.0, 85.0, "mm")  # reaches to sqrt(230^2 - 10^2) = 229.78 mm
    assert main(["check", str(path)]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "motion.inverse" in told
    assert "dead centre" in told
    assert "at cam angle" in told
    path = inverse(tmp_path, SLIDER_CRANK, "4", 300.0, 10.0, "mm")
    assert main(["check", str(path)]) == 2
    assert "motion.start_mm = 300.0: at cam angle 0 deg" in capsys.readouterr().err
    path = inverse(tmp_path, SLIDER_CRANK, "7", 150.0, 10.0, "mm")
    assert main(["check", str(path)]) == 2
    assert "motion.inverse.output = '7'" in capsys.readouterr().err


# output, where it starts, its exact dead centres: sums and differences of crank and rod; by the law of cosines
INLINE = SLIDER_CRANK.replace("[0.0, 10.0]", "[0.0, 0.0]").replace("50.0", "40.0").replace("180.0", "140.0")
ROCKER = [180.0 - math.degrees(math.acos((100.0**2 + 60.0**2 - reach**2) / 12000.0)) for reach in (70.0, 110.0)]
DEAD_CENTRES = {
    "at the far end": (SLIDER_CRANK, "4", 200.0, math.sqrt(230.0**2 - 10.0**2)),
    "at the near end": (SLIDER_CRANK, "4", 200.0, math.sqrt(130.0**2 - 10.0**2)),
    "inline, on a sample": (INLINE, "4", 140.0, 180.0),
    "inline, from end to end": (INLINE, "4", 100.0, 180.0),
    "of a rocker": (crank(FOUR_BAR), "4", 0.5 * sum(ROCKER), ROCKER[0]),
}


@pytest.mark.parametrize("case", spread(list(reversed(DEAD_CENTRES)), 1))
def test_an_output_that_reaches_a_dead_centre_and_no_farther_is_refused(case, tmp_path, capsys):
    """Where it stops there its crank has an acceleration without a limit; a thousandth less is a motion like any other."""
    linkage, output, start, end = DEAD_CENTRES[case]
    unit = "deg" if case == "of a rocker" else "mm"
    assert main(["check", str(inverse(tmp_path, linkage, output, start, end - start, unit))]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "meets a dead centre" in told
    assert f"at cam angle {0 if 'from end' in case else 120} deg" in told
    if "from end" not in case:
        shorter = (1.0 - 1e-3) * (end - start)
        assert main(["check", str(inverse(tmp_path, linkage, output, start, shorter, unit))]) == 0


@pytest.mark.stress
def test_a_crank_goes_on_turn_by_turn_where_its_output_does(tmp_path, capsys):
    double_crank = FOUR_BAR.replace("[100.0, 0.0]", "[20.0, 0.0]", 1).replace("A = [20.0", "A = [60.0")
    path = inverse(tmp_path, double_crank, "4", 100.0, 0.0, "deg")
    text = path.read_text(encoding="utf-8").partition("[[motion.segments]]")[0]
    text = text.replace("inverse =", "advance_deg = 360.0\ninverse =")
    step = '[[motion.segments]]\nlaw = "cycloidal"\nspan_deg = 180.0\nrise_deg = 180.0\n'
    path.write_text(text + 2 * step, encoding="utf-8")
    motion = load(path).drive.motion
    assert motion.advance == 360.0
    assert main(["check", str(path)]) == 0
    assert "jump" not in capsys.readouterr().out


def test_a_sum_is_the_sum_everywhere_and_is_saved_as_typed(tmp_path):
    other = FEED.replace("advance_mm = 300.0", "").replace("rise_mm = 150.0", "rise_mm = 3.0", 1)
    other = other.replace("rise_mm = 150.0", "rise_mm = -3.0").replace("span_deg = 120.0", "span_deg = 110.0", 1)
    other = other.replace("span_deg = 120.0", "span_deg = 130.0")
    (tmp_path / "a.toml").write_text(FEED, encoding="utf-8")
    (tmp_path / "b.toml").write_text(other, encoding="utf-8")
    path = tmp_path / "sum.toml"
    path.write_text(HEAD + '[motion]\nsum = ["a.toml", "./b.toml"]\n', encoding="utf-8")
    theta = np.deg2rad(np.arange(0.05, 360.0, 0.31))
    parts = [Study(load(tmp_path / name)).at_theta(theta).linkage.motion.y for name in ("a.toml", "b.toml")]
    made = load(path)
    got = Study(made).at_theta(theta).linkage.motion.y
    for order in range(4):
        assert np.abs(got[order] - sum(part[order] for part in parts)).max() <= 1e-12 * np.abs(got[order]).max()
    assert made.drive.motion.advance == 300.0
    save(made, path, in_place=True)
    assert '"./b.toml"' in path.read_text(encoding="utf-8")
    assert load(path) == made
    (tmp_path / "further").mkdir()
    save(made, tmp_path / "further" / "sum.toml")  # from another folder the same files
    assert '"../a.toml"' in (tmp_path / "further" / "sum.toml").read_text(encoding="utf-8")
    own = with_unlinked_motion(made)
    save(own, tmp_path / "own.toml")
    again = Study(load(tmp_path / "own.toml")).at_theta(theta).linkage.motion.y
    assert np.abs(again[0] - got[0]).max() <= 1e-9 * 0.3
    with pytest.raises(DesignError, match=r"follows from a\.toml, \./b\.toml"):
        save(put(made, "motion.segments[0].span_deg", 100.0), tmp_path / "changed.toml")


def test_a_motion_from_a_table_is_what_measured_finds(tmp_path, capsys):
    (tmp_path / "feed.toml").write_text(
        FEED.replace("advance_mm = 300.0", "").replace("rise_mm = 150.0", "rise_mm = -150.0", 1), encoding="utf-8"
    )
    main(["export", str(tmp_path / "feed.toml"), "--out", str(tmp_path / "tables"), "--samples", "720"])
    path = tmp_path / "tool.toml"
    table = '{ table = "tables/kinematics.csv", column = "displacement_mm", angle_column = "cam_angle_deg" }'
    path.write_text(HEAD + f"[motion]\nfrom = {table}\n", encoding="utf-8")
    assert main(["check", str(path)]) == 0
    assert [segment.curve.law for segment in load(path).drive.motion.segments] == [
        "3-4-5",
        "dwell",
        "cycloidal",
        "dwell",
    ]
    path.write_text(path.read_text(encoding="utf-8").replace("tables/", "none/"), encoding="utf-8")
    capsys.readouterr()
    assert main(["check", str(path)]) == 2
    told = capsys.readouterr().err
    assert told.startswith("motion.from.table = 'none/kinematics.csv'")
    assert "no such file" in told


def test_cycles_of_files_are_refused_in_one_line(tmp_path, capsys):
    for name, other in (("a.toml", "b.toml"), ("b.toml", "c.toml"), ("c.toml", "a.toml")):
        (tmp_path / name).write_text(HEAD + f'[motion]\nsum = ["{other}"]\n', encoding="utf-8")
    for command in ("check", "export"):
        assert main([command, str(tmp_path / "a.toml"), *(["--out", str(tmp_path / "x")] * (command == "export"))]) == 2
        told = capsys.readouterr().err
        assert told.count("\n") == 1
        assert "motion.sum[0] = 'b.toml'" in told
        assert "a.toml > b.toml > c.toml > a.toml" in told
    (tmp_path / "a.toml").write_text(HEAD + '[motion]\nsum = ["a.toml"]\nstart_mm = 1.0\n', encoding="utf-8")
    assert main(["check", str(tmp_path / "a.toml")]) == 2
    assert "motion.start_mm = 1.0: follows from motion.sum" in capsys.readouterr().err
