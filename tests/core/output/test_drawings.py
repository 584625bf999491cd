"""Drawings of mechanisms: what ``pose`` writes and pictures show, against positions that are computed without them."""

from pathlib import Path
from xml.etree import ElementTree

import drawing_readers as drawings
import ezdxf
import numpy as np
import pytest
from sampled import stressed

from core.__main__ import main
from core.project import load
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.toml"))
SVG = drawings.SVG


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
        assert ("PROFILE" in groups) is (design.drives[0].cam is not None)
        layers = {layer.dxf.name for layer in ezdxf.readfile(tmp_path / "p.dxf").layers}
        assert set(groups) <= layers
