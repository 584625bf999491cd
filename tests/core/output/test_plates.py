"""Plates of bodies with outlines: their area and height, their pins as points, and what they lack."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
import surface_command
from step_reader import StepFile, check_topology, volume

FOUR_BAR = Path(__file__).parents[3] / "resources/examples/four_bar.toml"
LAYER = "layer_from_mm = 2.0\nlayer_to_mm = 8.0\n"
SQUARE = "points = [[0, 0], [30, 0], [30, 20], [0, 20]]\n"
CLOCKWISE = "points = [[0, 0], [0, 20], [30, 20], [30, 0]]\n"
HOLLOW = "points = [[0, 0], [30, 0], [30, 20], [20, 10], [0, 20]]\n"


def run(
    folder: Path, outline: str, *words: object, of: str = "link 3", name: str = "plate.step"
) -> tuple[int, str, str]:
    """The command in this process on a four-bar with an outline: exit code, what it printed, its faults."""
    design = folder / "design.toml"
    design.write_text(f'{FOUR_BAR.read_text("utf-8")}\n[[outlines]]\nof = "link 3"\n{outline}', "utf-8")
    return surface_command.run(design, "--out", folder / name, "--of", of, "--json", *words)


@pytest.mark.parametrize(
    ("outline", "area", "faces"),
    [
        (SQUARE, 600.0, 6),
        (CLOCKWISE, 600.0, 6),
        (HOLLOW, 450.0, 7),
        (f"{SQUARE}round_mm = 5.0\n", 600.0 + 5.0 * 100.0 + 25.0 * math.pi, 10),
        ("points = [[0, 0], [40, 0]]\nround_mm = 5.0\n", 400.0 + 25.0 * math.pi, 6),
        ("points = [[7, 3]]\nround_mm = 5.0\n", 25.0 * math.pi, 4),
    ],
)
def test_a_plate_has_the_area_of_its_outline(tmp_path: Path, outline: str, area: float, faces: int) -> None:
    """The polygon, grown by a: A + a L + π a²."""
    code, said, faults = run(tmp_path, outline + LAYER)
    assert (code, faults) == (0, "")
    facts = json.loads(said)
    assert facts["volume_mm3"] == pytest.approx(6.0 * area)
    assert facts["faces"] == faces
    shell = StepFile((tmp_path / "plate.step").read_bytes()).shells["link 3"]
    check_topology(shell, is_closed=True)
    assert volume(shell, 3000) == pytest.approx(6.0 * area, rel=1e-5)
    levels = {float(edge.start[2]) for face in shell for loop in face.loops for edge, _ in loop}
    assert levels == {2.0, 8.0}


def test_pins_of_a_plate_are_points_in_its_frame(tmp_path: Path) -> None:
    from core.project import load

    assert run(tmp_path, SQUARE + LAYER)[0] == 0
    step = StepFile((tmp_path / "plate.step").read_bytes())
    ((_, references),) = step.all("GEOMETRIC_SET")
    points = np.array([step.point(reference) for reference in references])
    links = {link.number: link.places for link in load(FOUR_BAR).drive.links}
    shared = [z for name, z in links[3].items() if any(name in places for n, places in links.items() if n != 3)]
    assert sorted(map(tuple, points.tolist())) == sorted((z.real, z.imag, 2.0) for z in shared)


def test_a_plate_as_stl(tmp_path: Path) -> None:
    code, said, _ = run(tmp_path, f"{SQUARE}round_mm = 5.0\n{LAYER}", "--tolerance", 0.01, name="plate.stl")
    assert code == 0
    rows = np.frombuffer(
        (tmp_path / "plate.stl").read_bytes(), dtype=[("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")], offset=84
    )
    corners = rows["p"].astype(float)
    enclosed = float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6.0
    assert enclosed == pytest.approx(json.loads(said)["volume_mm3"], rel=1e-3)


@pytest.mark.parametrize(
    ("outline", "words", "of", "said"),
    [
        (SQUARE, [], "link 3", "has no thickness; allowed: layer_from_mm below layer_to_mm"),
        (SQUARE + LAYER, [], "link 9", "allowed: link 3"),
        (f"{HOLLOW}round_mm = 5.0\n{LAYER}", [], "link 3", "has a hollow"),
        (SQUARE + LAYER, ["--flank", "inner"], "link 3", "cannot be combined with a plate"),
    ],
)
def test_faults_of_plates(tmp_path: Path, outline: str, words: list[str], of: str, said: str) -> None:
    code, _, faults = run(tmp_path, outline, *words, of=of)
    assert code == 2
    assert said in faults
    assert faults.count("\n") == 1
