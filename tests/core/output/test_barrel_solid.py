"""Solid of a barrel cam: a closed body, its volume by an integral of its own, and refusals."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from kernel_reader import is_valid, kernel_shape, volumes
from sampled import stressed
from step_reader import StepFile, check_topology
from stl_reader import enclosed_volume, open_sides, read_stl
from surface_command import run, written

EXAMPLE = Path(__file__).parents[3] / "resources/examples/barrel_feeder.toml"
EXAMPLE_VOLUME = 2_095_683.3  # [mm³] of its solid, by OpenCASCADE
RADIUS, PLAY, INNER, BLANK, LENGTH, BORE = 8.0, 0.3, 40.0, 54.0, 60.0, 30.0
RANGE = {"mm": (3.0, 28.0), "deg": (-8.0, 17.0)}  # of the motion
ARM = 60.0
MOVES = pytest.mark.parametrize("unit", ["mm", "deg"])


def barrel(folder: Path, rotation: str = "ccw", unit: str = "mm", **keys: object) -> Path:
    """A roller, of a slide or on an arm, that rises and returns in half a turn each; the bore has no keyway."""
    cam = {"play_mm": PLAY, "roller_radius_mm": RADIUS, "roller_length_mm": 12.0, "roller_inner_mm": INNER,
           "outer_radius_mm": BLANK, "length_mm": LENGTH, "bore_mm": BORE, **keys}  # fmt: skip
    if unit == "deg":
        cam.setdefault("arm_mm", ARM)
    start, end = RANGE[unit]
    path = folder / "barrel.toml"
    path.write_text(
        f'format = 1\nname = "Barrel"\n[motion]\nstart_{unit} = {start}\n'
        + "".join(
            f'[[motion.segments]]\nlaw = "cycloidal"\nspan_deg = 180.0\nrise_{unit} = {rise}\n'
            for rise in (end - start, start - end)
        )
        + '[cam]\nkind = "barrel"\nform = "groove"\n'
        + "".join(f"{key} = {value}\n" for key, value in cam.items() if value is not None)
        + f'[shaft]\nrotation = "{rotation}"\nspeed_rpm = 60.0\n[loads]\n',
        "utf-8",
    )
    return path


def axis_point(unit: str, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates y and z (n,) [mm] of the roller's axis, which is parallel to x."""
    x = np.minimum(np.mod(theta, 2.0 * np.pi), 2.0 * np.pi - np.mod(theta, 2.0 * np.pi)) / np.pi
    start, end = RANGE[unit]
    s = start + (end - start) * (x - np.sin(2.0 * np.pi * x) / (2.0 * np.pi))
    if unit == "mm":
        return 0.0 * s, s
    return ARM * (np.cos(np.deg2rad(s)) - 1.0), ARM * np.sin(np.deg2rad(s))


def groove_volume(unit: str) -> float:
    """∫∫(z_ahead - z_behind) ρ dα dρ over the unrolled cylinders between floor and blank of a cam that turns counter-clockwise.

    The contact is at r e from the axis (u, y, z), e ∝ (0, z', u - y') across the axis and its velocity against the cam.
    """
    theta, step = 2.0 * np.pi * np.arange(4000) / 4000, 1e-5
    (y, z), after, before = (axis_point(unit, theta + k * step) for k in (0, 1, -1))
    y_1, z_1 = ((b - a) / (2.0 * step) for a, b in zip(before, after, strict=True))
    nodes, weights = np.polynomial.legendre.leggauss(10)
    low, high = INNER - PLAY, BLANK
    total = 0.0
    for node, weight in zip(nodes, weights, strict=True):
        radius = 0.5 * (low + high) + 0.5 * (high - low) * node
        for side, r in ((1.0, RADIUS), (-1.0, RADIUS + PLAY)):
            u = np.full(theta.size, radius)
            for _ in range(60):
                size = np.hypot(u - y_1, z_1)
                across = y + side * r * z_1 / size
                u = np.sqrt(radius**2 - across**2)
            height = z + side * r * (u - y_1) / size
            polar = np.unwrap(np.arctan2(across, u) - theta)
            steps = 0.5 * (np.roll(polar, -1) - np.roll(polar, 1))
            steps[[0, -1]] -= np.pi  # the jump by a full turn
            total += weight * 0.5 * (high - low) * side * radius * float(-(height * steps).sum())
    return total


def solid_volume(unit: str) -> float:
    return math.pi * (BLANK**2 - (0.5 * BORE) ** 2) * LENGTH - groove_volume(unit)


@pytest.mark.parametrize(
    ("rotation", "unit"), [("ccw", "mm"), ("cw", "deg"), stressed("cw", "mm"), stressed("ccw", "deg")]
)
def test_the_solid_is_closed_and_has_its_volume(tmp_path: Path, rotation: str, unit: str) -> None:
    out = tmp_path / "cam.step"
    code, said, faults = run(barrel(tmp_path, rotation, unit), "--out", out, "--solid", "--json")
    assert (code, faults) == (0, "")
    facts = json.loads(said)
    assert 0.0 < facts["deviation_mm"] <= 0.002
    (faces,) = StepFile(out.read_bytes()).shells.values()
    check_topology(faces, is_closed=True, accuracy=2e-6)
    assert len(faces) == facts["faces"]
    z = np.concatenate([face.polygon(0, 9)[:, 2] for face in faces])
    middle = 0.5 * sum(RANGE["mm"]) if unit == "mm" else 0.0
    assert (z.min(), z.max()) == (middle - 0.5 * LENGTH, middle + 0.5 * LENGTH)
    assert facts["volume_mm3"] == pytest.approx(solid_volume(unit), rel=2e-7)


@pytest.mark.parametrize(("unit", "taper"), [("mm", 5.0), ("deg", 0.0), stressed("deg", -5.0)])
def test_stl_is_watertight_and_has_the_volume(tmp_path: Path, unit: str, taper: float) -> None:
    """Triangles of walls, cylinders, ends and bore have their sides in common."""
    out = tmp_path / "cam.stl"
    design = barrel(tmp_path, "cw", unit, roller_taper_deg=taper, length_mm=70.0)
    facts = written(design, out, "--solid", "--tolerance", 0.02)
    assert facts["deviation_mm"] <= 0.02
    normals, corners = read_stl(out)
    assert open_sides(corners) == 0
    assert enclosed_volume(corners) == pytest.approx(facts["volume_mm3"], rel=5e-4)
    middles = corners.mean(axis=1)
    on_blank = np.hypot(corners[..., 0], corners[..., 1]).min(axis=1) > BLANK - 1e-3
    upright = on_blank & (np.abs(normals[:, 2]) < 0.1)
    assert ((middles * normals)[upright, :2].sum(axis=1) > BLANK - 0.02).all(), "the blank's normals point outwards"


@pytest.mark.stress
def test_the_example_leaves_with_its_keyway(tmp_path: Path) -> None:
    out = tmp_path / "cam.step"
    assert run(EXAMPLE, "--out", out, "--solid")[0] == 0
    (faces,) = StepFile(out.read_bytes()).shells.values()
    check_topology(faces, is_closed=True, accuracy=2e-6)
    assert len(faces) == 21, "8 of the walls, 6 of the cylinders, 5 of bore and keyway, 2 ends"


def enlarged_example(folder: Path, factor: float) -> Path:
    """The example, which has dwells, with all lengths enlarged."""
    path = folder / f"times_{factor:g}.toml"
    larger = re.sub(
        r"(_mm = )(\S+)", lambda found: f"{found[1]}{factor * float(found[2])!r}", EXAMPLE.read_text("utf-8")
    )
    path.write_text(larger, "utf-8")
    return path


@pytest.mark.parametrize("factor", [4.0, stressed(30.0), stressed(100.0)])
def test_large_cams_with_dwells_leave_too(tmp_path: Path, factor: float) -> None:
    out = tmp_path / "cam.step"
    code, printed, faults = run(enlarged_example(tmp_path, factor), "--out", out, "--solid", "--json")
    assert (code, faults) == (0, "")
    assert json.loads(printed)["volume_mm3"] == pytest.approx(factor**3 * EXAMPLE_VOLUME, rel=3e-8)
    if factor > 4.0:
        (faces,) = StepFile(out.read_bytes()).shells.values()
        check_topology(faces, is_closed=True, accuracy=2e-6)


@pytest.mark.parametrize(("ending", "tolerance"), [("step", "1e-10"), ("stl", "1e-5")])
def test_a_tolerance_that_requires_too_much_is_named_as_typed(tmp_path: Path, ending: str, tolerance: str) -> None:
    design = enlarged_example(tmp_path, 30.0)
    code, _, faults = run(design, "--out", tmp_path / f"cam.{ending}", "--tolerance", tolerance)
    assert code == 2
    assert f"tolerance {float(tolerance):g} mm: it requires too many" in faults


@pytest.mark.parametrize(
    ("unit", "keys", "said"),
    [
        ("mm", {"length_mm": 41.0}, "cam.length_mm: 41 mm: the groove reaches 20.8 mm"),
        ("mm", {"length_mm": None}, "cam.length_mm: missing"),
        ("mm", {"keyway_width_mm": 8.0}, "cam.keyway_depth_mm: missing"),
        ("mm", {"keyway_width_mm": 8.0, "keyway_depth_mm": 26.0, "keyway_angle_deg": 0.0}, "cam.keyway_depth_mm = 26.0: reaches the floor"),
        ("mm", {"roller_taper_deg": 30.0, "outer_radius_mm": 54.5}, "cam.roller_taper_deg: 30 deg: the cone of the roller ends"),
        ("deg", {"length_mm": 30.0}, "cam.length_mm: 30 mm: the groove reaches "),
        ("deg", {"arm_mm": 1200.0, "length_mm": 900.0}, "cam.roller_inner_mm: the flank ahead does not extend from the floor"),
    ],
)  # fmt: skip
def test_faults_are_named_in_one_line(tmp_path: Path, unit: str, keys: dict[str, object], said: str) -> None:
    code, _, faults = run(barrel(tmp_path, unit=unit, **keys), "--out", tmp_path / "cam.step", "--solid")
    assert code == 2
    assert said in faults
    assert faults.count("\n") == 1


@pytest.mark.stress
@MOVES
@pytest.mark.parametrize("rotation", ["ccw", "cw"])
@pytest.mark.parametrize("taper", [0.0, 5.0, -5.0])
def test_a_kernel_reads_a_valid_solid(tmp_path: Path, rotation: str, unit: str, taper: float) -> None:
    """OpenCASCADE reads one valid solid with the stated volume; a cone's walls on an arm have seams that are helices."""
    out = tmp_path / "cam.step"
    facts = written(barrel(tmp_path, rotation, unit, roller_taper_deg=taper, length_mm=70.0), out, "--solid")
    shape = kernel_shape(out)
    assert is_valid(shape)
    assert volumes(shape, 1e-5) == [pytest.approx(facts["volume_mm3"], rel=1e-8)]


@pytest.mark.stress
@pytest.mark.parametrize("rotation", ["ccw", "cw"])
def test_the_roller_may_move_where_the_walls_are_joined(tmp_path: Path, rotation: str) -> None:
    """At cam angles 0 and 180° both walls are at different angles around the cam; helices on floor and blank join them."""
    design = barrel(tmp_path, rotation)
    conditions = "start = { velocity = 0.15, acceleration = 0.0 }\nend = { velocity = 0.15, acceleration = 0.0 }\n"
    text = design.read_text("utf-8").replace('law = "cycloidal"\n', f'law = "polynomial"\n{conditions}')
    design.write_text(text, "utf-8")
    facts = written(design, tmp_path / "cam.step", "--solid")
    shape = kernel_shape(tmp_path / "cam.step")
    assert is_valid(shape)
    assert volumes(shape, 1e-5) == [pytest.approx(facts["volume_mm3"], rel=1e-8)]
    (faces,) = StepFile((tmp_path / "cam.step").read_bytes()).shells.values()
    check_topology(faces, is_closed=True, accuracy=2e-6)
    rims = [edge for face in faces if face.surface.kind == "CYLINDRICAL_SURFACE" for edge, _ in face.loops[0]]
    helices = {
        edge.number for edge in rims if edge.curve.kind not in ("LINE", "CIRCLE") and len(edge.curve.data[2]) == 8
    }
    assert len(helices) == 2, "across the floor; those on the blank are upright"


LAWS = ("cycloidal", "modified-sine", "simple-harmonic", "3-4-5", "4-5-6-7", "modified-trapezoid")


def random_barrel(folder: Path, generator: np.random.Generator) -> Path:
    """Two to four segments of random laws, spans and rises under a random roller of a slide or an arm."""
    unit, count = generator.choice(["mm", "deg"]), int(generator.integers(2, 5))
    spans = generator.uniform(40.0, 140.0, count)
    rises = generator.uniform(-1.0, 1.0, count)
    rises -= rises.mean()
    rises *= generator.uniform(5.0, 40.0) / np.abs(rises).max()
    inner, length = generator.uniform(25.0, 70.0), generator.uniform(6.0, 16.0)
    keys = {
        "roller_radius_mm": generator.uniform(4.0, 12.0), "roller_length_mm": length, "roller_inner_mm": inner,
        "outer_radius_mm": inner + generator.uniform(0.6, 1.1) * length, "length_mm": generator.uniform(80.0, 220.0),
        "play_mm": generator.choice([0.0, 0.02, 0.5]), "roller_taper_deg": generator.choice([0.0, 3.0, -4.0, 9.0]),
        "bore_mm": 0.8 * inner, **({"arm_mm": generator.uniform(40.0, 120.0)} if unit == "deg" else {}),
    }  # fmt: skip
    path = folder / "random.toml"
    path.write_text(
        f'format = 1\nname = "Random"\n[motion]\nstart_{unit} = {generator.uniform(-15.0, 5.0)}\n'
        + "".join(
            f'[[motion.segments]]\nlaw = "{generator.choice(LAWS)}"\nspan_deg = {span}\nrise_{unit} = {rise}\n'
            for span, rise in zip(360.0 * spans / spans.sum(), rises, strict=True)
        )
        + '[cam]\nkind = "barrel"\nform = "groove"\n'
        + "".join(f"{key} = {float(value)!r}\n" for key, value in keys.items())
        + f'[shaft]\nrotation = "{generator.choice(["ccw", "cw"])}"\nspeed_rpm = 60.0\n[loads]\n',
        "utf-8",
    )
    return path


@pytest.mark.stress
def test_random_grooves_are_valid_solids_or_refused_in_one_line(tmp_path: Path) -> None:
    """STEP is valid for OpenCASCADE with the stated volume, STL watertight, unless the flank has an edge or leaves the blank."""
    generator, solids, refused = np.random.default_rng(3), 0, []
    for _ in range(16):
        design = random_barrel(tmp_path, generator)
        code, said, faults = run(design, "--out", tmp_path / "cam.step", "--solid", "--json")
        if code == 2:
            assert faults.count("\n") == 1
            refused.append(faults)
            continue
        facts, shape = json.loads(said), kernel_shape(tmp_path / "cam.step")
        assert is_valid(shape)
        assert volumes(shape, 1e-5) == [pytest.approx(facts["volume_mm3"], rel=1e-7)]
        assert run(design, "--out", tmp_path / "cam.stl", "--solid", "--tolerance", 0.05)[0] == code
        _, corners = read_stl(tmp_path / "cam.stl")
        assert open_sides(corners) == 0
        assert enclosed_volume(corners) == pytest.approx(facts["volume_mm3"], rel=2e-3)
        solids += 1
    assert solids >= 10, refused
