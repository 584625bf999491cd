"""Drawings of mechanisms: what ``pose`` writes and pictures show, against positions that are computed without them."""

import math
import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import drawing_readers as drawings
import ezdxf
import numpy as np
import pytest
from mechanisms import LIFT
from sampled import stressed

from core.__main__ import main
from core.output.drawing.picture import mechanism_picture
from core.project import load
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.toml"))
SVG = drawings.SVG
MOST_BYTES = 200_000


def posed(design: Path, angle: float, out: Path) -> Path:
    assert main(["pose", str(design), "--angle", str(angle), "--out", str(out)]) == 0
    return out


def drawn(text: str | bytes) -> dict[str, ElementTree.Element]:
    """Groups of a drawing by their name."""
    root = ElementTree.fromstring(text)
    return {group.get("id", ""): group for group in root.iter(f"{SVG}g")}


def corners(shape: ElementTree.Element) -> np.ndarray:
    """Points of a line, y upwards."""
    pairs = (pair.split(",") for pair in shape.get("points", "").split())
    return np.array([complex(float(x), -float(y)) for x, y in pairs])


def centre(circle: ElementTree.Element) -> complex:
    return complex(float(circle.get("cx", "nan")), -float(circle.get("cy", "nan")))


# -- the command ``pose`` ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [0.0, 100.0])
def test_a_pose_has_the_cam_turned_and_the_roller_on_it(angle: float, tmp_path: Path) -> None:
    """The cam turns by the angle, the roller's rim touches the profile, and its centre is on the pitch curve."""
    path, design = EXAMPLES / "transfer_lift.toml", load(EXAMPLES / "transfer_lift.toml")
    groups = drawn(posed(path, angle, tmp_path / "p.svg").read_bytes())
    (profile,), (pitch,) = (groups[name].findall(f"{SVG}polygon") for name in ("PROFILE", "PITCH"))
    at_zero = Study(design).cam.flank.profile * 1e3
    assert np.abs(corners(profile) - at_zero * np.exp(1j * np.deg2rad(angle))).max() < 1e-9
    (roller,) = groups["FACE"].findall(f"{SVG}circle")
    radius = float(roller.get("r", "nan"))
    assert radius == design.drive.cam.roller_radius_mm
    step = np.abs(np.diff(corners(pitch))).max()  # of the polygon
    assert np.abs(corners(pitch) - centre(roller)).min() < 1e-9 + 0.5 * step
    assert np.abs(corners(profile) - centre(roller)).min() == pytest.approx(radius, abs=step**2 / radius)


@pytest.mark.parametrize("ending", ["svg", "dxf"])
def test_a_pose_of_a_follower_has_its_arm_rod_and_slider(ending: str, tmp_path: Path) -> None:
    """Lengths of the file are found between the points of the drawing."""
    follower = load(EXAMPLES / "transfer_lift.toml").drive.follower
    out = posed(EXAMPLES / "transfer_lift.toml", 60.0, tmp_path / f"p.{ending}")
    if ending == "svg":
        rod = corners(drawn(out.read_bytes())["ROD"].find(f"{SVG}polyline"))
        pivot = centre(drawn(out.read_bytes())["FRAME"].find(f"{SVG}circle"))
    else:
        space = ezdxf.readfile(out).modelspace()
        (line,) = space.query('LWPOLYLINE[layer=="ROD"]')
        rod = np.array([complex(x, y) for x, y in line.get_points("xy")])
        (pin,) = space.query('CIRCLE[layer=="FRAME"]')
        pivot = complex(pin.dxf.center.x, pin.dxf.center.y)
    assert abs(rod[1] - rod[0]) == pytest.approx(follower.rod_mm, abs=1e-9)
    assert abs(rod[0] - pivot) == pytest.approx(follower.slider_arm_mm, abs=1e-9)
    assert pivot == complex(follower.pivot_x_mm, follower.pivot_y_mm)


@pytest.mark.parametrize("name", ["transfer_lift", *map(stressed, NAMES)])
def test_every_example_has_a_pose_and_ghosts(name: str, tmp_path: Path) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    drives = [["--drive", drive.name] for drive in design.drives] if design.listed else [[]]
    for drive in drives:
        words = ["pose", str(EXAMPLES / f"{name}.toml"), "--angle", "30", "--every", "90", *drive]
        assert main([*words, "--out", str(tmp_path / "p.svg")]) == 0
        assert main([*words, "--out", str(tmp_path / "p.dxf")]) == 0
        groups = drawn((tmp_path / "p.svg").read_bytes())
        assert ("PROFILE" in groups) is design.drives[0].has_disk
        layers = {layer.dxf.name for layer in ezdxf.readfile(tmp_path / "p.dxf").layers}
        assert set(groups) <= layers


# -- pictures ---------------------------------------------------------------------------------------------------


def circles(text: str) -> np.ndarray:
    """Centres of all circles of a picture, y upwards."""
    root = ElementTree.fromstring(text.encode())
    return np.array([centre(circle) for circle in root.iter(f"{SVG}circle")])


@pytest.mark.parametrize("name", ["lecture_six_bar", *map(stressed, NAMES)])
def test_a_picture_is_small_well_formed_and_the_same_again(name: str) -> None:
    study = Study(load(EXAMPLES / f"{name}.toml"), 1440)
    text = mechanism_picture(study, 40.0)
    assert text == mechanism_picture(Study(load(EXAMPLES / f"{name}.toml"), 1440), 40.0)
    assert len(text.encode()) < MOST_BYTES
    root = ElementTree.fromstring(text.encode())
    assert {element.tag.removeprefix(SVG) for element in root.iter()}.isdisjoint(
        {"script", "image", "a", "foreignObject"}
    )
    assert "href" not in text
    assert "url(" not in text


def test_pins_are_where_the_crank_and_the_slider_are() -> None:
    """In millimetres, by the triangle of crank and connecting rod."""
    design = load(EXAMPLES / "slider_crank.toml")
    crank, rod = (
        abs(np.subtract(*[complex(p.x_mm, p.y_mm) for p in link.points])) for link in design.drive.linkage.links[1:3]
    )
    pins = circles(mechanism_picture(Study(design), 50.0))
    a = crank * np.exp(1j * np.deg2rad(50.0))
    b = a.real + math.sqrt(rod**2 - a.imag**2)
    for point in (0.0, a, b):
        assert np.abs(pins - point).min() < 0.01


def test_the_cam_of_a_picture_is_turned_by_the_angle() -> None:
    """Each point of the thinned profile is within a tenth of a pixel of the turned profile."""
    study = Study(load(EXAMPLES / "tappet_flat.toml"), 3600)
    root = ElementTree.fromstring(mechanism_picture(study, 70.0).encode())
    mm_per_pixel = float(root.get("viewBox", "").split()[2]) / float(root.get("width", "nan"))
    cams = [shape for shape in root.iter(f"{SVG}polygon") if "kd-f-cam" in (shape.get("class") or "").split()]
    (drawn_profile,) = (shape for shape in cams if len(corners(shape)) > 20)
    turned = study.cam.flank.profile * 1e3 * np.exp(1j * np.deg2rad(70.0) * study.sense)
    distances = [np.abs(turned - point).min() for point in corners(drawn_profile)]
    assert max(distances) < 0.1 * mm_per_pixel
    assert turned.size > 5 * len(distances)


def test_a_name_stays_text_and_colours_follow_dark_paper() -> None:
    text = mechanism_picture(Study(replace(LIFT, name="<script>alert(1)</script> & \x01"), 90))
    root = ElementTree.fromstring(text.encode())
    title = root.find(f"{SVG}title")
    assert title is not None
    assert title.text == "<script>alert(1)</script> & \N{REPLACEMENT CHARACTER}"
    style = root.find(f"{SVG}style")
    assert style is not None
    rules = set(re.findall(r"\.(kd-[fs]-[a-z0-9-]+)\{", style.text or ""))
    used = {name for element in root.iter() for name in (element.get("class") or "").split()}
    assert used == rules, "every colour has its twin on dark paper"
    assert "kd-f-paper" in rules
