"""Solid of a barrel cam: a closed body, its volume by an integral of its own, and refusals."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from step_reader import StepFile, check_topology
from surface_command import run

EXAMPLE = Path(__file__).parents[3] / "resources/examples/barrel_feeder.toml"
RADIUS, PLAY, INNER, BLANK, LENGTH, STROKE, BORE = 8.0, 0.3, 40.0, 54.0, 60.0, 25.0, 30.0


def barrel(folder: Path, rotation: str = "ccw", **keys: object) -> Path:
    """A roller that rises and returns in half a turn each, from y = 3 mm; the bore has no keyway."""
    cam = {"play_mm": PLAY, "roller_radius_mm": RADIUS, "roller_length_mm": 12.0, "roller_inner_mm": INNER,
           "outer_radius_mm": BLANK, "length_mm": LENGTH, "bore_mm": BORE, **keys}  # fmt: skip
    path = folder / "barrel.toml"
    path.write_text(
        'format = 1\nname = "Barrel"\n[motion]\nstart_mm = 3.0\n'
        + "".join(
            f'[[motion.segments]]\nlaw = "cycloidal"\nspan_deg = 180.0\nrise_mm = {rise}\n'
            for rise in (STROKE, -STROKE)
        )
        + '[cam]\nkind = "barrel"\nform = "groove"\n'
        + "".join(f"{key} = {value}\n" for key, value in cam.items() if value is not None)
        + f'[shaft]\nrotation = "{rotation}"\nspeed_rpm = 60.0\n[loads]\n',
        "utf-8",
    )
    return path


def groove_volume() -> float:
    """∫∫(z_ahead - z_behind) ρ dα dρ over the unrolled cylinders between floor and blank."""
    theta = 2.0 * np.pi * np.arange(4000) / 4000
    x = np.where(theta < np.pi, theta, 2.0 * np.pi - theta) / np.pi
    y = STROKE * (x - np.sin(2.0 * np.pi * x) / (2.0 * np.pi))
    slope = np.where(theta < np.pi, 1.0, -1.0) * STROKE / np.pi * (1.0 - np.cos(2.0 * np.pi * x))
    nodes, weights = np.polynomial.legendre.leggauss(10)
    low, high = INNER - PLAY, BLANK
    total = 0.0
    for node, weight in zip(nodes, weights, strict=True):
        radius = 0.5 * (low + high) + 0.5 * (high - low) * node
        for side, r in ((1.0, RADIUS), (-1.0, RADIUS + PLAY)):
            u = np.full(theta.size, radius)
            for _ in range(60):  # u² + (r e_y)² = ρ² with e = ∓(0, y', -u)/√(u² + y'²)
                u = np.sqrt(radius**2 - (r * slope) ** 2 / (u**2 + slope**2))
            size = np.hypot(u, slope)
            z = y + side * r * u / size
            polar = np.unwrap(np.arctan2(side * r * slope / size, u) - theta)
            steps = 0.5 * (np.roll(polar, -1) - np.roll(polar, 1))
            steps[[0, -1]] -= np.pi  # the jump by a full turn
            total += weight * 0.5 * (high - low) * side * radius * float(-(z * steps).sum())
    return total


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
def test_the_solid_is_closed_and_has_its_volume(tmp_path: Path, rotation: str) -> None:
    out = tmp_path / "cam.step"
    code, said, faults = run(barrel(tmp_path, rotation), "--out", out, "--solid", "--json")
    assert (code, faults) == (0, "")
    facts = json.loads(said)
    assert 0.0 < facts["deviation_mm"] <= 0.002
    (faces,) = StepFile(out.read_bytes()).shells.values()
    check_topology(faces, is_closed=True, accuracy=2e-6)
    assert len(faces) == facts["faces"]
    z = np.concatenate([face.polygon(0, 9)[:, 2] for face in faces])
    assert (z.min(), z.max()) == (3.0 + 0.5 * STROKE - 0.5 * LENGTH, 3.0 + 0.5 * STROKE + 0.5 * LENGTH)
    blank = math.pi * (BLANK**2 - (0.5 * BORE) ** 2) * LENGTH
    assert facts["volume_mm3"] == pytest.approx(blank - groove_volume(), rel=2e-7)


@pytest.mark.stress
def test_the_example_leaves_with_its_keyway(tmp_path: Path) -> None:
    out = tmp_path / "cam.step"
    assert run(EXAMPLE, "--out", out, "--solid")[0] == 0
    (faces,) = StepFile(out.read_bytes()).shells.values()
    check_topology(faces, is_closed=True, accuracy=2e-6)
    assert len(faces) == 21, "8 of the walls, 6 of the cylinders, 5 of bore and keyway, 2 ends"


@pytest.mark.parametrize(
    ("keys", "words", "said"),
    [
        ({"length_mm": 41.0}, (), "cam.length_mm: 41 mm: the groove reaches 20.8 mm"),
        ({"length_mm": None}, (), "cam.length_mm: missing"),
        ({"keyway_width_mm": 8.0}, (), "cam.keyway_depth_mm: missing"),
        ({"keyway_width_mm": 8.0, "keyway_depth_mm": 26.0, "keyway_angle_deg": 0.0}, (), "cam.keyway_depth_mm: "),
        ({"form": "'rib'"}, (), "only a barrel cam with a groove"),
    ],
)
def test_faults_are_named_in_one_line(
    tmp_path: Path, keys: dict[str, object], words: tuple[object, ...], said: str
) -> None:
    design = barrel(tmp_path, **keys)
    if "form" in keys:
        text = design.read_text("utf-8").replace('form = "groove"\n', "").replace(f"play_mm = {PLAY}\n", "")
        design.write_text(text.replace("[shaft]", "roller_distance_mm = 24.0\n[shaft]"), "utf-8")
    code, _, faults = run(design, "--out", tmp_path / "cam.step", "--solid", *words)
    assert code == 2
    assert said in faults
    assert faults.count("\n") == 1


@pytest.mark.stress
def test_triangles_of_the_solid_are_refused(tmp_path: Path) -> None:
    code, _, faults = run(barrel(tmp_path), "--out", tmp_path / "cam.stl", "--solid")
    assert (code, faults.count("\n")) == (2, 1)
    assert "allowed: .step" in faults


@pytest.mark.stress
@pytest.mark.parametrize("rotation", ["ccw", "cw"])
def test_a_kernel_reads_a_valid_solid(tmp_path: Path, rotation: str) -> None:
    """OpenCASCADE reads one valid solid with the stated volume."""
    pytest.importorskip("OCP")
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader

    out = tmp_path / "cam.step"
    facts = json.loads(run(barrel(tmp_path, rotation), "--out", out, "--solid", "--json")[1])
    reader = STEPControl_Reader()
    reader.ReadFile(str(out))
    reader.TransferRoots()
    solid, properties = reader.OneShape(), GProp_GProps()
    assert BRepCheck_Analyzer(solid, True).IsValid()
    BRepGProp.VolumeProperties_s(solid, properties, 1e-5)
    assert properties.Mass() == pytest.approx(facts["volume_mm3"], rel=1e-8)
