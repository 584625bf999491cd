"""Pictures and what notebooks show: well-formed, without scripts, small, and with the numbers of the study."""

import re
import tomllib
from collections.abc import Callable
from operator import methodcaller
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from sampled import stressed

import kindyna as kd

SVG = "{http://www.w3.org/2000/svg}"
MOST_BYTES = 200_000
notebook: Callable[[Any], str] = methodcaller("_repr_html_")
"""What a notebook shows of a result."""
LIFT = kd.example("transfer_lift")
STRANGE = "<script>alert('a')</script> & \"b\""


def read(text: str) -> ElementTree.Element:
    """Parse a picture or HTML that must be well-formed, small, without scripts and addresses."""
    assert len(text.encode()) <= MOST_BYTES
    root = ElementTree.fromstring(text.encode())
    names = {element.tag.removeprefix(SVG) for element in root.iter()}
    assert names.isdisjoint({"script", "image", "img", "iframe", "link", "object", "foreignObject"})
    attributes = {key for element in root.iter() for key in element.attrib}
    assert not {key for key in attributes if key.startswith("on") or key.endswith("href") or key == "src"}
    assert "url(" not in text
    assert "@import" not in text
    return root


def words(root: ElementTree.Element) -> str:
    return " ".join(" ".join(root.itertext()).split())


def lines(root: ElementTree.Element, family: str) -> np.ndarray:
    """Points (n, 2) of the curves of a family in pixels, y down."""
    shapes = (shape for shape in root.iter(f"{SVG}polyline") if shape.get("class") == f"kd-s-{family}")
    pairs = [pair.split(",") for shape in shapes for pair in shape.get("points", "").split()]
    return np.array(pairs, dtype=float)


def frame(root: ElementTree.Element) -> tuple[float, float]:
    """Left and right end of the first plot in pixels."""
    box = next(shape for shape in root.iter(f"{SVG}rect") if shape.get("class") == "kd-s-quiet")
    left = float(box.get("x", "nan"))
    return left, left + float(box.get("width", "nan"))


# -- plots ----------------------------------------------------------------------------------------------------


def test_a_plot_has_the_values_of_the_channel() -> None:
    """Read off between the numbers of the axis, each drawn point is on the curve of the channel within half a pixel."""
    study = LIFT.study(samples=1440)
    root = read(study.plot("pressure_angle_deg").svg)
    points, (left, right) = lines(root, "pressure-angle"), frame(root)
    points = points[points[:, 0] >= left]
    angles = (points[:, 0] - left) / (right - left) * 360.0
    numbers = [text for text in root.iter(f"{SVG}text") if text.get("text-anchor") == "end"]
    at = [float(text.get("y", "nan")) - 4.0 for text in numbers]  # the middle of its digits
    scale, offset = np.polyfit(at, [float(text.text or "nan") for text in numbers], 1)
    read_off, values = scale * points[:, 1] + offset, study["pressure_angle_deg"]
    exact = np.interp(angles, np.append(study.angle_deg, 360.0), np.append(values, values[0]))
    assert np.abs(read_off - exact).max() < 0.6 * abs(scale)
    assert 30 < len(points) < 720, "points that no pixel shows are left out"


def test_each_unit_has_its_plot_with_marked_extremes_and_segments() -> None:
    names = ("displacement_mm", "contact_force_n", "drive_torque_nm", "pressure_angle_deg")
    study = LIFT.study()
    root = read(study.plot(*names).svg)
    heads = {"".join(text.itertext()) for text in root.iter(f"{SVG}text")}
    assert {
        "Displacement, mm",
        "Contact force, kN",
        "Cam torque, kN·m",
        "Pressure angle, °",
        "Cam angle, °",
        "Dwell",
    } <= heads
    peak = study.extreme("pressure_angle_deg")
    assert f"{peak.value:.4g} at {peak.angle_deg:.2f}°" in heads
    together = read(study.plot("displacement_mm", "displacement_mm").svg)
    assert len(together.findall(f".//{SVG}rect[@class='kd-s-quiet']")) == 1


def test_a_plot_of_a_crank_and_of_a_shaft_and_at_angles() -> None:
    crank = read(kd.example("four_bar").study().plot("link3_deg", "link4_rad_s").svg)
    assert "Driver angle, °" in words(crank)
    shaft = read(kd.example("transfer_unit").study().plot("torque_nm").svg)
    assert "Machine angle, °" in words(shaft)
    part = read(LIFT.study().at(np.linspace(40.0, 80.0, 81)).plot("velocity_mm_s").svg)
    assert " 45 50 55 " in words(part)
    with pytest.raises(KeyError, match="pressure_angle_deg"):
        LIFT.study().plot("pressure_angel_deg")


# -- pictures -------------------------------------------------------------------------------------------------


def test_a_picture_is_saved_whole(tmp_path: Path) -> None:
    picture = LIFT.study().picture(at_deg=60)
    picture.save(tmp_path / "lift.svg")
    assert (tmp_path / "lift.svg").read_text("utf-8") == picture.svg
    assert "Cam angle 60°" in words(read(picture.svg))
    assert repr(picture).startswith("<kindyna.Picture ")
    with pytest.raises(ValueError, match=r"\.svg"):
        picture.save(tmp_path / "lift.png")
    assert [path.name for path in tmp_path.iterdir()] == ["lift.svg"]
    for wrong in (float("nan"), "60"):
        with pytest.raises((TypeError, ValueError), match="at_deg"):
            LIFT.study().picture(at_deg=wrong)  # type: ignore[arg-type]


def test_a_coupler_point_of_a_picture_is_that_of_the_study() -> None:
    """In millimetres, y down."""
    study = kd.example("four_bar").study()
    x, y = study.at([40.0]).point(3, "C")[0]
    circles = read(study.picture(at_deg=40).svg).iter(f"{SVG}circle")
    centres = np.array([[float(circle.get("cx", "nan")), -float(circle.get("cy", "nan"))] for circle in circles])
    assert np.abs(centres - [x, y]).max(axis=1).min() < 0.01


# -- what notebooks show --------------------------------------------------------------------------------------


@pytest.mark.parametrize("slug", ["transfer_unit", "four_bar", *map(stressed, kd.examples())])
def test_every_example_shows_itself(slug: str) -> None:
    design = kd.example(slug)
    text = notebook(design)
    root = read(text)
    assert text == notebook(kd.example(slug))
    assert words(root).startswith(design.name)
    assert root.find(f".//{SVG}svg") is not None
    for finding in design.findings:
        assert finding.field in text
    assert re.search(r"Certificate: (\d+) of \1 residuals within their bounds", text)


def test_the_largest_values_are_the_extremes() -> None:
    study = LIFT.study()
    text = words(read(notebook(study)))
    for name in ("pressure_angle_deg", "velocity_mm_s"):
        end = study.extreme(name, "abs")
        assert f"{study.channels[name].label} {end.value:.4g} {end.unit} {round(end.angle_deg, 2):.5g}°" in text


def test_findings_have_their_colour_and_names_stay_text() -> None:
    strange = kd.example("kim_1990").edit({"name": STRANGE})
    root = read(notebook(strange))
    assert STRANGE in words(root)
    assert "warning" in {element.text for element in root.iter("span") if "#8a5300" in (element.get("style") or "")}
    first = read(notebook(strange.findings[0]))
    assert strange.findings[0].field in words(first)
    assert STRANGE in words(read(strange.study().plot().svg))


def test_a_design_without_a_solution_says_why() -> None:
    impossible = LIFT.edit({"cam.base_radius_mm": 5.0})
    text = words(read(notebook(impossible)))
    assert "the roller cannot reach the base circle" in text


def test_a_crank_that_cannot_turn_is_drawn_where_it_can_be() -> None:
    crank = kd.example("four_bar").edit({"linkage.links[1].points.A.x_mm": 90.0})
    text = words(read(notebook(crank)))
    assert f"Driver angle {crank.study().angle_deg[0]:g}°" in text
    assert "error the crank cannot turn fully" in text
    assert len(lines(read(crank.study().plot("link3_deg").svg), "angle")) > 10


def test_a_shaft_without_a_solution_says_why() -> None:
    lift = tomllib.loads(LIFT.edit({"cam.base_radius_mm": 5.0}).toml)
    drive = {"name": "A", **{key: lift[key] for key in ("motion", "follower", "cam", "loads")}}
    unit = kd.design({"format": 1, "name": "Unit", "shaft": lift["shaft"], "drives": [drive]})
    assert "drives[0].follower.roller_arm_mm: the roller cannot reach" in words(read(notebook(unit)))


def shown(result: Any) -> str:
    return words(read(notebook(result))).replace("\N{NARROW NO-BREAK SPACE}", "")


def test_results_show_what_changed_and_what_was_found() -> None:
    found = LIFT.find("base-radius", limits={"pressure_angle_return_deg": 20})
    assert "cam.base_radius_mm" in shown(found)
    assert f"cam.base_radius_mm 400 {found.answer['cam.base_radius_mm']:.6g}" in shown(found)
    rocker = kd.example("rocker_cam")
    best = rocker.optimise(
        {"cam.base_radius_mm": (40, 90)}, "drive_torque_nm:abs", {"pressure_angle_deg:max": {"max": 35}}
    )
    changed = f"{rocker['cam.base_radius_mm']:g} {best.answer['cam.base_radius_mm']:.6g}"
    assert f"Goal {best.goal:.6g} Changed from to cam.base_radius_mm {changed}" in shown(best)
    many = LIFT.many({"cam.base_radius_mm": [5.0, 390.0, 410.0]}, ["pressure_angle_deg:max"])
    known = many.value["pressure_angle_deg:max"][1:]
    ends = f"{known.min():.6g} {known.max():.6g}"
    assert f"Designs 3 Column least largest known cam.base_radius_mm 5 410 3 pressure_angle_deg:max {ends} 2" in shown(
        many
    )
    assert f"1 of 3 designs without values: {many.reason[0]}" in shown(many)
    peak = LIFT.study().extreme("pressure_angle_deg")
    assert shown(peak) == f"{peak.value:.6g}° at {peak.angle_deg:.6g}°"
    explained = LIFT.study().explain("pressure_angle_deg", at_deg=60)
    assert explained.equation[0].replace(" ", "") in shown(explained).replace(" ", "")
    swing = kd.synthesise({"kind": "rocker", "rocker": {"swing_deg": 60.0, "frame_mm": 100.0}})
    assert "Linkages for a task 1 linkage, 0 hidden" in shown(swing)
    assert f"{swing.answers[0].transmission_deg:.6g}" in shown(swing)
