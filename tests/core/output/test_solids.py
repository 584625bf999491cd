"""Surfaces and solids of disk cams, read by a reader of their own and measured against curves from outside the code."""

import math
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from kernel_reader import is_valid, kernel_shape, volumes
from scipy.spatial import cKDTree
from step_reader import Face, StepFile, check_topology, volume
from stl_reader import enclosed_volume, open_sides, read_stl
from surface_command import run, written

from core.output.solids.mesh import bisected_triangles, triangulate

ROOT = Path(__file__).parents[3]
EXAMPLES = ROOT / "resources/examples"
LIFT_KEYS = (
    "thickness_mm = 70.0\nbore_mm = 120.0\nkeyway_width_mm = 32.0\nkeyway_depth_mm = 7.4\nkeyway_angle_deg = 90.0\n"
)
HUB_KEYS = "hub_mm = 200.0\nhub_length_mm = 110.0\n"
BLANK_KEYS = "outer_radius_mm = 160.0\ngroove_depth_mm = 18.0\nhub_length_mm = 50.0\n"
KEYWAY = 32.0 * 7.4  # area beyond the bore's edge, less the segment of the bore's circle [mm²]


def example(folder: Path, name: str, keys: str = "") -> Path:
    """An example with further keys of its cam."""
    text = (EXAMPLES / f"{name}.toml").read_text("utf-8")
    path = folder / f"{name}.toml"
    path.write_text(text.replace("\n[cam]\n", f"\n[cam]\n{keys}", 1), "utf-8")
    return path


BASE, ROLLER, STROKE = 50.0, 12.0, 20.0


def translating(folder: Path, face: str = "roller", rotation: str = "ccw", keys: str = "", form: str = "open") -> Path:
    """A cycloidal rise and return in the direction of y, whose curves are known in closed form."""
    roller = f"roller_radius_mm = {ROLLER}\n" if face == "roller" else ""
    path = folder / f"{face}_{rotation}_{form}.toml"
    path.write_text(
        'format = 1\nname = "Cycloidal ö"\n[motion]\nstart_mm = 0.0\n'
        f'[[motion.segments]]\nlaw = "dwell"\nspan_deg = 60.0\n'
        f'[[motion.segments]]\nlaw = "cycloidal"\nspan_deg = 150.0\nrise_mm = {STROKE}\n'
        f'[[motion.segments]]\nlaw = "cycloidal"\nspan_deg = 150.0\nrise_mm = {-STROKE}\n'
        f'[follower]\nkind = "translating"\nface = "{face}"\noffset_mm = 0.0\n'
        f'[cam]\nbase_radius_mm = {BASE}\n{roller}form = "{form}"\nthickness_mm = 20.0\n{keys}'
        f'[shaft]\nrotation = "{rotation}"\nspeed_rpm = 60.0\n[loads]\n',
        "utf-8",
    )
    return path


def reference_point(theta: np.ndarray, reach: float, rotation: str) -> np.ndarray:
    """The point of the follower (n,) complex in the cam's frame: i (reach + s) turned back by the cam's angle [mm]."""
    rise, turn = math.radians(150.0), math.radians(60.0)
    x = np.clip((theta - turn) / rise, 0.0, 2.0)
    x = np.minimum(x, 2.0 - x)
    s = STROKE * (x - np.sin(2.0 * np.pi * x) / (2.0 * np.pi))
    return 1j * (reach + s) * np.exp((-1j if rotation == "ccw" else 1j) * theta)


def distance(points: np.ndarray, closed: np.ndarray) -> np.ndarray:
    """Distance (n,) of points from a closed polyline through very many: of its lines at the nearest of them."""
    nearest = cKDTree(np.column_stack((closed.real, closed.imag))).query(np.column_stack((points.real, points.imag)))[1]
    best = np.abs(points - closed[nearest])
    for side in (-1, 1):
        a, b = closed[nearest], closed[(nearest + side) % closed.size]
        along = np.clip(((points - a) / np.where(a == b, 1.0, b - a)).real, 0.0, 1.0)
        best = np.minimum(best, np.abs(points - a - along * (b - a)))
    return best


def random_points(faces: list[Face], count: int) -> tuple[np.ndarray, np.ndarray]:
    """Random points and outward normals (n, 3) of the B-spline faces and, about z, of the cylinders larger than a bore."""
    generator = np.random.default_rng(7)
    points, normals = [], []
    for face in faces:
        u, v = generator.uniform(size=(2, count))
        if face.surface.kind == "B_SPLINE_SURFACE_WITH_KNOTS":
            at, normal = face.surface.at(u, v)
        elif face.surface.kind == "CYLINDRICAL_SURFACE" and face.surface.data[1] > 45.0:
            curves = [edge for loop in face.loops for edge, _ in loop if edge.curve.kind == "CIRCLE"]
            low, high = (edge.points(2 * count)[generator.integers(2 * count, size=count)] for edge in curves)
            at = low.copy()
            at[:, 2] += v * (high[0, 2] - low[0, 2])
            normal = at * (1.0, 1.0, 0.0) / face.surface.data[1]
        else:
            continue
        points.append(at)
        normals.append(normal if face.is_along else -normal)
    return np.concatenate(points), np.concatenate(normals)


def turn_angles(count: int) -> np.ndarray:
    return 2.0 * np.pi * np.arange(count) / count


# -- points against closed forms --------------------------------------------------------------------------------


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
@pytest.mark.parametrize("tolerance", [0.002, 0.0001])
def test_a_knifes_cam_is_within_the_stated_deviation(tmp_path: Path, rotation: str, tolerance: float) -> None:
    out = tmp_path / "cam.step"
    facts = written(translating(tmp_path, "knife", rotation), out, "--tolerance", tolerance)
    faces = StepFile(out.read_bytes()).shells["inner"]
    points, normals = random_points(faces, 10_000 // len(faces) + 1)
    exact = reference_point(turn_angles(200_000), BASE, rotation)
    off = distance(points[:, 0] + 1j * points[:, 1], exact)
    assert 0.2 * facts["deviation_mm"] < off.max() <= facts["deviation_mm"] + 2e-7
    assert facts["deviation_mm"] <= tolerance
    assert points[:, 2].min() >= 0.0
    assert points[:, 2].max() <= 20.0
    outwards = ((points * (1.0, 1.0, 0.0)) * normals).sum(axis=1)
    assert outwards.min() > 0.0, "normals point out of the material in both senses of rotation"


@pytest.mark.parametrize("form", ["open", "groove"])
@pytest.mark.stress
def test_a_rollers_flank_is_its_radius_away_from_its_centres(tmp_path: Path, form: str) -> None:
    """No point of a flank is nearer to the roller over the turn than its radius, on the outer flank with its play."""
    play = 0.05
    keys = f"play_mm = {play}\n" if form == "groove" else ""
    out = tmp_path / "cam.step"
    facts = written(translating(tmp_path, keys=keys, form=form), out)
    pitch = reference_point(turn_angles(200_000), BASE + ROLLER, "ccw")
    shells = StepFile(out.read_bytes()).shells
    assert list(shells) == (["inner", "outer"] if form == "groove" else ["inner"])
    for flank, faces in shells.items():
        check_topology(faces, is_closed=False)
        points, normals = random_points(faces, 3_000)
        off = distance(points[:, 0] + 1j * points[:, 1], pitch) - ROLLER - (play if flank == "outer" else 0.0)
        assert np.abs(off).max() <= facts["deviation_mm"] + 2e-7
        side = 1.0 if flank == "inner" else -1.0
        assert (side * (points * normals).sum(axis=1)).min() > 0.0


def test_one_flank_of_a_groove(tmp_path: Path) -> None:
    out = tmp_path / "cam.step"
    facts = written(translating(tmp_path, form="groove"), out, "--flank", "outer")
    assert list(StepFile(out.read_bytes()).shells) == ["outer"]
    assert set(facts) == {"deviation_mm", "faces"}
    assert facts["faces"] == 3, "a dwell, a rise and a return"


def test_a_finer_tolerance_adds_knots(tmp_path: Path) -> None:
    design = translating(tmp_path, "knife")
    sizes = []
    for tolerance in (0.1, 1e-4, 1e-6):
        written(design, tmp_path / "cam.step", "--tolerance", tolerance)
        sizes.append(sum(1 for _ in StepFile((tmp_path / "cam.step").read_bytes()).all("CARTESIAN_POINT")))
    assert sizes == sorted(set(sizes))


# -- solids -----------------------------------------------------------------------------------------------------


def profile_area(design: Path, flank: str = "inner") -> float:
    """Area within an exact profile [mm²], by the trapezoid rule over its polygon of 400,000 corners."""
    from core.project import load
    from core.study import Study

    z = 1e3 * Study(load(design), 400_000).cam.only(flank).flank.profile
    return abs(0.5 * float((z.real * np.roll(z.imag, -1) - z.imag * np.roll(z.real, -1)).sum()))


def bore_area(bore: float, width: float, depth: float) -> float:
    """Area of a bore with its keyway [mm²]: the circle, and the rectangle beyond it less the segment of the circle."""
    radius, half = 0.5 * bore, 0.5 * width
    rise = math.sqrt(radius**2 - half**2)
    segment = radius**2 * math.asin(half / radius) - half * rise
    return math.pi * radius**2 + width * (radius + depth - rise) - segment


def test_the_lifts_cam_is_a_solid_with_bore_and_keyway(tmp_path: Path) -> None:
    design, out = example(tmp_path, "transfer_lift", LIFT_KEYS), tmp_path / "lift.step"
    facts = written(design, out, "--solid")
    step = StepFile(out.read_bytes())
    (name, faces), *others = step.shells.items()
    assert (name, others, len(faces)) == ("cam", [], facts["faces"])
    assert len(faces) == 5 + 2 + 3 + 2, "five edges of the profile, halves of the bore, sides of the keyway, two planes"
    check_topology(faces, is_closed=True)
    expected = 70.0 * (profile_area(design) - bore_area(120.0, 32.0, 7.4))
    assert facts["volume_mm3"] == pytest.approx(expected, rel=2e-6)
    assert volume(faces, 4_000) == pytest.approx(expected, rel=2e-5)
    assert "AUTOMOTIVE_DESIGN" in step.header
    kinds = Counter(face.surface.kind for face in faces)
    assert kinds == {"PLANE": 5, "CYLINDRICAL_SURFACE": 5, "B_SPLINE_SURFACE_WITH_KNOTS": 2}, "dwells are cylinders"


def test_a_hub_rises_above_the_disk(tmp_path: Path) -> None:
    design, out = example(tmp_path, "transfer_lift", LIFT_KEYS + HUB_KEYS), tmp_path / "lift.step"
    facts = written(design, out, "--solid")
    faces = StepFile(out.read_bytes()).shells["cam"]
    check_topology(faces, is_closed=True)
    hub = 40.0 * (math.pi * 100.0**2 - bore_area(120.0, 32.0, 7.4))
    expected = 70.0 * (profile_area(design) - bore_area(120.0, 32.0, 7.4)) + hub
    assert facts["volume_mm3"] == pytest.approx(expected, rel=2e-6)
    assert volume(faces, 4_000) == pytest.approx(expected, rel=2e-5)


def test_a_hub_within_the_disk_is_not_seen(tmp_path: Path) -> None:
    keys = LIFT_KEYS + "hub_mm = 200.0\nhub_length_mm = 70.0\n"
    facts = written(example(tmp_path, "transfer_lift", keys), tmp_path / "lift.step", "--solid")
    assert facts["faces"] == 12


def test_a_groove_in_its_blank(tmp_path: Path) -> None:
    design, out = example(tmp_path, "groove", BLANK_KEYS), tmp_path / "groove.step"
    facts = written(design, out, "--solid")
    faces = StepFile(out.read_bytes()).shells["cam"]
    check_topology(faces, is_closed=True)
    bore = bore_area(40.0, 12.0, 3.3)
    groove = profile_area(design, "outer") - profile_area(design)
    expected = (math.pi * 160.0**2 - bore) * 35.0 - 18.0 * groove + 15.0 * (math.pi * 35.0**2 - bore)
    assert facts["volume_mm3"] == pytest.approx(expected, rel=2e-6)
    assert volume(faces, 4_000) == pytest.approx(expected, rel=2e-5)
    levels = sorted({round(float(f.surface.data[0][0][2]), 9) for f in faces if f.surface.kind == "PLANE"})
    assert [z for z in levels if z in (0.0, 17.0, 35.0, 50.0)] == [0.0, 17.0, 35.0, 50.0]


def test_a_conjugate_pair_is_two_solids_next_to_each_other(tmp_path: Path) -> None:
    design, out = example(tmp_path, "conjugate"), tmp_path / "pair.step"
    facts = written(design, out, "--solid")
    shells = StepFile(out.read_bytes()).shells
    assert list(shells) == ["first cam", "second cam"]
    total = 0.0
    for number, (flank, faces) in enumerate(zip(("inner", "second"), shells.values(), strict=True)):
        check_topology(faces, is_closed=True)
        heights = {
            round(float(z), 9) for face in faces for loop in face.loops for e, _ in loop for z in (e.start[2], e.end[2])
        }
        assert heights == {25.0 * number, 25.0 * (number + 1)}
        expected = 25.0 * (profile_area(design, flank) - math.pi * 20.0**2)
        assert volume(faces, 4_000) == pytest.approx(expected, rel=2e-5)
        total += expected
    assert facts["volume_mm3"] == pytest.approx(total, rel=2e-6)


def test_one_drive_of_a_camshaft(tmp_path: Path) -> None:
    out = tmp_path / "clamp.step"
    facts = written(EXAMPLES / "transfer_unit.toml", out, "--solid", "--drive", "clamp")
    (faces,) = StepFile(out.read_bytes()).shells.values()
    check_topology(faces, is_closed=True)
    assert facts["deviation_mm"] <= 0.002


@pytest.mark.parametrize("ending", ["step", "stl", "csv"])
def test_the_same_design_gives_the_same_bytes(tmp_path: Path, ending: str) -> None:
    design = translating(tmp_path)
    files = [tmp_path / f"{number}.{ending}" for number in range(2)]
    for out in files:
        written(design, out, *(["--samples", 90] if ending == "csv" else ["--solid"]))
    assert files[0].read_bytes() == files[1].read_bytes()


def test_names_in_any_script(tmp_path: Path) -> None:
    out = tmp_path / "cam.step"
    written(translating(tmp_path), out, "--solid")
    assert b"PRODUCT('Cycloidal \\X2\\00F6\\X0\\'" in out.read_bytes()


# -- STL --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "keys"), [("transfer_lift", LIFT_KEYS + HUB_KEYS), ("groove", BLANK_KEYS), ("conjugate", "")]
)
def test_stl_is_watertight_and_has_the_volume(tmp_path: Path, name: str, keys: str) -> None:
    out = tmp_path / "cam.stl"
    facts = written(example(tmp_path, name, keys), out, "--solid", "--tolerance", 0.02)
    normals, corners = read_stl(out)
    is_first = corners[:, :, 2].mean(axis=1) - 0.1 * normals[:, 2] < 25.0  # of the pair, which meets at this height
    for part in (is_first, ~is_first) if name == "conjugate" else (normals[:, 2] < 2.0,):
        assert open_sides(corners[part]) == 0
    assert enclosed_volume(corners) == pytest.approx(facts["volume_mm3"], rel=1e-3)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(across, axis=1)
    assert np.abs(across / size[:, None] - normals)[size > 1e-3].max() < 1e-5


def test_stl_keeps_its_tolerance(tmp_path: Path) -> None:
    """The middles of its sides, which are farthest from a convex cam, are within the stated deviation."""
    out = tmp_path / "cam.stl"
    facts = written(translating(tmp_path, "knife"), out, "--tolerance", 0.01)
    _, corners = read_stl(out)
    assert open_sides(corners) > 0, "flanks alone are open"
    middles = 0.5 * (corners + np.roll(corners, 1, axis=1)).reshape(-1, 3)
    exact = reference_point(turn_angles(200_000), BASE, "ccw")
    off = distance(middles[:, 0] + 1j * middles[:, 1], exact)
    assert 0.3 * facts["deviation_mm"] < off.max() <= facts["deviation_mm"] <= 0.01


def test_triangles_of_polygons_with_holes() -> None:
    """Their areas add up, none is turned over, in polygons with up to three holes."""
    generator = np.random.default_rng(3)
    for case in range(60):
        theta = 2.0 * np.pi * np.arange(generator.integers(5, 120)) / 120
        theta = theta * 120 / theta.size
        radius = 10.0 * (1.0 + 0.4 * np.cos(generator.integers(2, 9) * theta + case)) + generator.uniform(
            0.0, 0.5, theta.size
        )
        loops = [radius * np.exp(1j * theta)]
        for hole in range(case % 4):
            turn = np.exp(-2j * np.pi * np.arange(corners := generator.integers(3, 60)) / corners)
            loops.append(2.5 * np.exp(2j * np.pi * hole / 3 + 1j * case) + generator.uniform(0.5, 1.8) * turn)
        z = np.concatenate(loops)[triangulate(loops)]
        areas = 0.5 * (np.conj(z[:, 1] - z[:, 0]) * (z[:, 2] - z[:, 0])).imag
        expected = sum(0.5 * float((np.conj(loop) * np.roll(loop, -1)).imag.sum()) for loop in loops)
        assert areas.min() > -1e-12
        assert areas.sum() == pytest.approx(expected, rel=1e-12)


# -- CSV --------------------------------------------------------------------------------------------------------


def test_bisected_triangles_cover_the_same_area() -> None:
    generator = np.random.default_rng(2)
    triangles = generator.uniform(size=(20, 3, 3))

    def areas(corners: np.ndarray) -> np.ndarray:
        return 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])

    parts = bisected_triangles(triangles, 0.2)
    assert np.linalg.norm(np.roll(parts, 1, axis=1) - parts, axis=2).max() <= 0.2
    assert np.abs(areas(parts).sum(axis=0) - areas(triangles).sum(axis=0)).max() < 1e-12, "with the same sense"


def test_a_table_of_points_and_normals(tmp_path: Path) -> None:
    """Points and normals against their closed form: the roller's centre less its radius along the normal."""
    out = tmp_path / "flank.csv"
    written(translating(tmp_path), out, "--samples", 360, "--along", 3)
    header, *lines = out.read_text("utf-8").splitlines()
    names = header.split(",")
    assert names == [
        "flank", "roller", "cam_angle_deg", "u_mm", "x_mm", "y_mm", "z_mm", "nx", "ny", "nz", "pressure_angle_deg",
        "curvature_per_mm",
    ]  # fmt: skip
    assert len(lines) == 3 * 360
    assert {line.split(",")[0] for line in lines} == {"inner"}
    rows = np.array([[float(word) for word in line.split(",")[1:]] for line in lines])
    column = dict(zip(names[1:], rows.T, strict=True))
    assert set(column["roller"]) == {1.0}
    assert np.array_equal(column["u_mm"], np.tile([0.0, 10.0, 20.0], 360))
    assert np.array_equal(column["u_mm"], column["z_mm"])
    theta = np.deg2rad(column["cam_angle_deg"])
    z, normal = column["x_mm"] + 1j * column["y_mm"], column["nx"] + 1j * column["ny"]
    assert np.abs(np.abs(normal) - 1.0).max() < 1e-12
    assert np.abs(z - ROLLER * normal - reference_point(theta, BASE + ROLLER, "ccw")).max() < 1e-9
    assert (z * np.conj(normal)).real.max() < 0.0, "from the roller into the cam"
    step = 1e-5
    reach = [np.abs(reference_point(theta + side * step, BASE + ROLLER, "ccw")) for side in (-1.0, 0.0, 1.0)]
    angle = np.rad2deg(np.arctan(np.abs(reach[2] - reach[0]) / (2.0 * step * reach[1])))  # tan ψ = |s'|/(r + s)
    assert np.abs(angle - column["pressure_angle_deg"]).max() < 1e-5
    dwell = column["cam_angle_deg"] < 59.0
    assert column["curvature_per_mm"][dwell] == pytest.approx(1.0 / BASE)


def test_curvature_of_a_grooves_flanks_is_that_of_the_material(tmp_path: Path) -> None:
    out = tmp_path / "flank.csv"
    written(translating(tmp_path, form="groove"), out, "--samples", 36, "--along", 2)
    rows = [line.split(",") for line in out.read_text("utf-8").splitlines()[1:]]
    dwell = {row[0]: row for row in rows if row[2] == "10.0"}
    assert float(dwell["inner"][-1]) == pytest.approx(1.0 / BASE)
    assert float(dwell["outer"][-1]) == pytest.approx(-1.0 / (BASE + 2.0 * ROLLER))
    for row in dwell.values():  # into the cam: away from the roller's centre between both flanks
        x, y, nx, ny = (float(row[i]) for i in (4, 5, 7, 8))
        assert abs(complex(x, y) - ROLLER * complex(nx, ny)) == pytest.approx(BASE + ROLLER)


# -- faults -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("keys", "words", "said"),
    [
        ("", ["--solid"], "cam.thickness_mm: missing"),
        ("thickness_mm = 70.0\nkeyway_width_mm = 10.0\n", ["--solid"], "cam.bore_mm: missing"),
        ("thickness_mm = 70.0\nhub_length_mm = 90.0\n", ["--solid"], "cam.hub_mm: missing"),
        ("thickness_mm = 70.0\nbore_mm = 900.0\n", ["--solid"], "cam.bore_mm: 900 mm"),
        (LIFT_KEYS + "hub_mm = 810.0\nhub_length_mm = 90.0\n", ["--solid"], "cam.hub_mm: 810 mm"),
        (LIFT_KEYS + "hub_mm = 130.0\nhub_length_mm = 90.0\n", ["--solid"], "the keyway reaches 69.27 mm"),
        (LIFT_KEYS, ["--flank", "outer"], "flank 'outer'"),
        (LIFT_KEYS, ["--flank", "inner", "--solid"], "cannot be combined with a solid"),
        (LIFT_KEYS, ["--tolerance", "1e-12"], "below the accuracy"),
    ],
)
def test_faults_name_the_field_in_one_line(tmp_path: Path, keys: str, words: list[str], said: str) -> None:
    out = tmp_path / "cam.step"
    code, _, faults = run(example(tmp_path, "transfer_lift", keys), "--out", out, *words)
    assert code == 2
    assert said in faults
    assert faults.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ("", "cam.outer_radius_mm: missing"),
        ("outer_radius_mm = 160.0\n", "cam.groove_depth_mm: missing"),
        ("outer_radius_mm = 140.0\ngroove_depth_mm = 18.0\n", "cam.outer_radius_mm: 140 mm: the groove reaches 142"),
        (
            "outer_radius_mm = 160.0\ngroove_depth_mm = 35.0\n",
            "cam.groove_depth_mm = 35.0: not less than the thickness",
        ),
    ],
)
def test_a_groove_names_what_its_blank_lacks(tmp_path: Path, keys: str, said: str) -> None:
    code, _, faults = run(example(tmp_path, "groove", keys), "--out", tmp_path / "cam.step", "--solid")
    assert code == 2
    assert said in faults


def test_a_table_holds_no_solid_and_a_drive_is_named(tmp_path: Path) -> None:
    design = translating(tmp_path)
    assert run(design, "--out", tmp_path / "cam.csv", "--solid")[0] == 2
    code, _, faults = run(design, "--out", tmp_path / "cam.iges")
    assert code == 2
    assert ".step, .stl, .csv" in faults
    code, _, faults = run(EXAMPLES / "four_bar.toml", "--out", tmp_path / "cam.step")
    assert code == 2
    assert "no cam" in faults
    path = tmp_path / "unit.toml"
    path.write_text((EXAMPLES / "transfer_unit.toml").read_text("utf-8").replace("thickness_mm = 70.0\n", ""), "utf-8")
    code, _, faults = run(path, "--out", tmp_path / "cam.step", "--drive", "feed")
    assert code == 2
    assert "drives[0].cam.thickness_mm: missing" in faults


# -- a kernel ---------------------------------------------------------------------------------------------------


@pytest.mark.stress
@pytest.mark.parametrize(
    ("name", "keys"), [("transfer_lift", LIFT_KEYS + HUB_KEYS), ("groove", BLANK_KEYS), ("conjugate", "")]
)
def test_a_kernel_reads_valid_solids(tmp_path: Path, name: str, keys: str) -> None:
    """OpenCASCADE reads the file, finds every face and edge valid, and measures the stated volume."""
    out = tmp_path / "cam.step"
    facts = written(example(tmp_path, name, keys), out, "--solid")
    shape = kernel_shape(out)
    assert is_valid(shape)
    assert sum(volumes(shape, 1e-9)) == pytest.approx(facts["volume_mm3"], rel=2e-5)
