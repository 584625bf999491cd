"""Flanks of cams in space as STEP, STL and CSV, measured against rollers that a test moves by its own equations."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from kernel_reader import face_points, is_valid, kernel_shape
from sampled import stressed
from step_reader import Face, StepFile, check_topology
from surface_command import run, written

ROOT = Path(__file__).parents[3]
EXAMPLES = ROOT / "resources/examples"
RADIUS, PLAY, TURNS = 8.0, 0.1, 6  # mm; rollers on the turret
INNER, LENGTH, STROKE = 40.0, 12.0, 25.0  # mm; the stroke also deg
ARM = 60.0
DISTANCE = 100.0  # between the axes of cam and turret


def cycloidal(x: np.ndarray) -> np.ndarray:
    return x - np.sin(2.0 * np.pi * x) / (2.0 * np.pi)


def barrel(folder: Path, rotation: str = "ccw", taper: float = 0.0, form: str = "groove", unit: str = "mm") -> Path:
    """A roller on a slide or an arm: a dwell of 60°, a cycloidal rise and a return of 150° each."""
    arm = f"arm_mm = {ARM}\n" if unit == "deg" else ""
    keys = arm + (f"play_mm = {PLAY}\n" if form == "groove" else "roller_distance_mm = 24.0\n")
    path = folder / f"barrel_{rotation}_{form}.toml"
    path.write_text(
        f'format = 1\nname = "Barrel"\n[motion]\nstart_{unit} = 0.0\n[[motion.segments]]\nlaw = "dwell"\nspan_deg = 60.0\n'
        f'[[motion.segments]]\nlaw = "cycloidal"\nspan_deg = 150.0\nrise_{unit} = {STROKE}\n'
        f'[[motion.segments]]\nlaw = "cycloidal"\nspan_deg = 150.0\nrise_{unit} = {-STROKE}\n'
        f'[cam]\nkind = "barrel"\nform = "{form}"\n{keys}roller_radius_mm = {RADIUS}\nroller_length_mm = {LENGTH}\n'
        f'roller_inner_mm = {INNER}\nroller_taper_deg = {taper}\n[shaft]\nrotation = "{rotation}"\nspeed_rpm = 60.0\n[loads]\n',
        "utf-8",
    )
    return path


def barrel_motion(theta: np.ndarray) -> np.ndarray:
    x = np.clip((np.mod(theta, 2.0 * np.pi) - math.radians(60.0)) / math.radians(150.0), 0.0, 2.0)
    return STROKE * cycloidal(np.minimum(x, 2.0 - x))


def indexer(folder: Path, rotation: str = "ccw", taper: float = 0.0) -> Path:
    """A globoidal indexer of six stops: a dwell of 240°, and a cycloidal step of 60° in 120°."""
    path = folder / "indexer.toml"
    path.write_text(
        'format = 1\nname = "Indexer"\n[motion]\nstart_deg = 30.0\nadvance_deg = 60.0\n'
        '[[motion.segments]]\nlaw = "dwell"\nspan_deg = 240.0\n'
        '[[motion.segments]]\nlaw = "cycloidal"\nspan_deg = 120.0\nrise_deg = 60.0\n'
        f'[cam]\nkind = "globoidal"\ncentre_distance_mm = {DISTANCE}\nform = "rib"\nroller_radius_mm = {RADIUS}\n'
        f"roller_length_mm = {LENGTH}\nroller_inner_mm = {INNER}\nrollers = {TURNS}\nlength_mm = 82.0\n"
        f'roller_taper_deg = {taper}\n[shaft]\nrotation = "{rotation}"\nspeed_rpm = 60.0\n[loads]\n',
        "utf-8",
    )
    return path


Axis = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Point and direction (k, 3) of a roller's axis at cam angles (k,), in the global frame."""


def turned(points: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Points (n, 3) rotated about z by angles that broadcast to (n, k): (n, k, 3)."""
    x, y, z = (points[:, i, None] for i in range(3))
    c, s = np.cos(angle), np.sin(angle)
    return np.stack((c * x - s * y, s * x + c * y, z + 0.0 * c), axis=-1)


def gaps(
    points: np.ndarray, axis: Axis, sense: float, theta: np.ndarray, taper: float
) -> tuple[np.ndarray, np.ndarray]:
    """Distance of points (n, 3) of the cam from a conical roller at angles (n, k) or (1, k), and the vectors from its axis.

    (ρ - r + (u - u_0) tan τ) cos τ at the distance ρ from the axis and u along it; the roller is only as long as it is.
    """
    origin, along = (row.reshape(*theta.shape, 3) for row in axis(theta.ravel()))
    away = turned(points, sense * theta) - origin
    u = (away * along).sum(axis=-1)
    across = away - u[..., None] * along
    tan = math.tan(math.radians(taper))
    gap = (np.linalg.norm(across, axis=-1) - RADIUS + (u - INNER) * tan) / math.hypot(1.0, tan)
    return np.where((u > INNER - 0.5) & (u < INNER + LENGTH + 0.5), gap, np.inf), across


def least_gap(points: np.ndarray, axis: Axis, sense: float, taper: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Least distance (n,) of points of the cam from a roller over the turn, and the vector (n, 3) from its axis then.

    The least of samples of a quarter of a degree, about it of finer ones, and of the parabola through those.
    """
    coarse, fine = 2.0 * np.pi * np.arange(1440) / 1440, np.linspace(-1.0, 1.0, 41) * np.pi / 720.0
    result, vectors = [], []
    for i in range(0, len(points), 400):
        part = points[i : i + 400]
        best = coarse[gaps(part, axis, sense, coarse[None], taper)[0].argmin(axis=1)]
        theta = best[:, None] + fine
        gap, across = gaps(part, axis, sense, theta, taper)
        rows, k = np.arange(len(part)), gap.argmin(axis=1)
        left, middle, right = (gap[rows, (k + step).clip(0, fine.size - 1)] for step in (-1, 0, 1))
        with np.errstate(invalid="ignore", divide="ignore"):
            drop = (right - left) ** 2 / (8.0 * (left - 2.0 * middle + right))
        result.append(middle - np.where((left > middle) & (middle < right) & np.isfinite(drop), drop, 0.0))
        vectors.append(turned(across[rows, k], -sense * theta[rows, k][:, None])[:, 0])
    return np.concatenate(result), np.concatenate(vectors)


def slide_axis(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Axis of the barrel's roller, along x at the height of the motion."""
    zero = 0.0 * theta
    return np.stack((zero, zero, barrel_motion(theta)), axis=-1), np.stack((zero + 1.0, zero, zero), axis=-1)


def arm_axis(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Axis of the roller of a barrel cam on an arm, which stays parallel to x."""
    phi, zero = np.deg2rad(barrel_motion(theta)), 0.0 * theta
    origin = np.stack((zero, ARM * (np.cos(phi) - 1.0), ARM * np.sin(phi)), axis=-1)
    return origin, np.stack((zero + 1.0, zero, zero), axis=-1)


def turret_axis(k: int) -> Axis:
    """Axis of a roller of the indexer, k steps from the first one, which starts at 30°."""

    def at(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        turn, rest = np.divmod(theta, 2.0 * np.pi)
        x = np.clip((rest - math.radians(240.0)) / math.radians(120.0), 0.0, 1.0)
        phi = math.radians(30.0) + 2.0 * np.pi / TURNS * (cycloidal(x) + k + turn)
        zero = 0.0 * theta
        return np.stack((zero + DISTANCE, zero, zero), axis=-1), np.stack((-np.cos(phi), zero, np.sin(phi)), axis=-1)

    return at


def random_points(faces: list[Face], count: int) -> tuple[np.ndarray, np.ndarray]:
    """Random points and outward normals (n, 3) of B-spline faces."""
    generator = np.random.default_rng(5)
    at = [face.surface.at(*generator.uniform(size=(2, count))) for face in faces]
    normals = [normal if face.is_along else -normal for (_, normal), face in zip(at, faces, strict=True)]
    return np.concatenate([points for points, _ in at]), np.concatenate(normals)


def check_barrel(name: str, points: np.ndarray, unit: str, sense: float, taper: float, deviation: float) -> np.ndarray:
    """Points of a flank are the play away from the roller over the turn, and nowhere nearer; returns the vectors from its axis."""
    gap, away = least_gap(points, slide_axis if unit == "mm" else arm_axis, sense, taper)
    play = PLAY * math.cos(math.radians(taper)) if name.startswith("behind") else 0.0
    assert np.abs(gap - play).max() <= deviation + 1e-6
    assert np.sign(away[:, 2]).tolist() == [1.0 if name.startswith("ahead") else -1.0] * len(away)
    return away


def check_indexer(points: np.ndarray, sense: float, taper: float, deviation: float) -> None:
    """No point is inside of any roller, and each touches one."""
    nearest = np.min([least_gap(points, turret_axis(k), sense, taper)[0] for k in range(-2, 2)], axis=0)
    assert np.abs(nearest).max() <= deviation + 1e-6


@pytest.mark.parametrize(
    ("rotation", "taper", "unit"),
    [("ccw", 0.0, "mm"), ("cw", 5.0, "deg"), stressed("cw", 0.0, "mm"), stressed("ccw", -5.0, "deg")],
)
def test_a_barrels_flanks_touch_its_roller(tmp_path: Path, rotation: str, taper: float, unit: str) -> None:
    """Points of the file are on the cylindrical or conical roller over the turn, with the play behind it, and nowhere in it."""
    out = tmp_path / "cam.step"
    facts = written(barrel(tmp_path, rotation, taper, unit=unit), out)
    assert 0.0 < facts["deviation_mm"] <= 0.002
    shells = StepFile(out.read_bytes()).shells
    assert list(shells) == ["ahead 1", "behind 1"]
    for name, faces in shells.items():
        check_topology(faces, is_closed=False)
        assert len(faces) == 3, "a dwell, a rise and a return"
        points, normals = random_points(faces, 100)
        away = check_barrel(name, points, unit, 1.0 if rotation == "ccw" else -1.0, taper, facts["deviation_mm"])
        assert (away * normals).sum(axis=1).max() < 0.0, "normals point out of the cam, towards the roller"


@pytest.mark.parametrize(("rotation", "taper"), [("cw", 8.0), stressed("ccw", 0.0)])
def test_an_indexers_flanks_touch_its_rollers(tmp_path: Path, rotation: str, taper: float) -> None:
    """The six-stop globoidal indexer, 2 µm true: no point is in any roller, and each is on one."""
    out = tmp_path / "cam.step"
    facts = written(indexer(tmp_path, rotation, taper), out)
    assert facts["deviation_mm"] <= 0.002
    shells = StepFile(out.read_bytes()).shells
    assert {name.split()[0] for name in shells} == {"ahead", "behind"}
    for faces in shells.values():
        check_topology(faces, is_closed=False)
        points, _ = random_points(faces, 10)
        check_indexer(points, 1.0 if rotation == "ccw" else -1.0, taper, facts["deviation_mm"])


@pytest.mark.stress
@pytest.mark.parametrize("rotation", ["ccw", "cw"])
@pytest.mark.parametrize("taper", [0.0, 8.0, -5.0])
@pytest.mark.parametrize("kind", ["mm", "deg", "indexer"])
def test_ten_thousand_points_of_a_kernel_are_within_the_deviation(
    tmp_path: Path, kind: str, taper: float, rotation: str
) -> None:
    """OpenCASCADE finds the flanks of cylinders and cones valid, and its points on the faces are on the rollers."""
    out, sense = tmp_path / "cam.step", 1.0 if rotation == "ccw" else -1.0
    is_indexer = kind == "indexer"
    design = indexer(tmp_path, rotation, taper) if is_indexer else barrel(tmp_path, rotation, taper, unit=kind)
    deviation = written(design, out)["deviation_mm"]
    shape = kernel_shape(out)
    assert is_valid(shape)
    names = [name for name, faces in StepFile(out.read_bytes()).shells.items() for _ in faces]
    faces = face_points(shape, 10_000 // len(names) + 1)
    assert len(faces) == len(names)
    for name, points in zip(names, faces, strict=True):
        if is_indexer:
            check_indexer(points, sense, taper, deviation)
        else:
            check_barrel(name, points, kind, sense, taper, deviation)


def test_a_rib_of_a_slide_has_one_flank_a_roller(tmp_path: Path) -> None:
    out = tmp_path / "cam.step"
    written(barrel(tmp_path, form="rib"), out)
    shells = StepFile(out.read_bytes()).shells
    assert list(shells) == ["ahead 1", "behind 2"], "ahead of the lower roller, behind the upper one"
    low, high = (random_points(faces, 20)[0][:, 2] for faces in shells.values())
    assert low.min() == pytest.approx(-12.0 + RADIUS, abs=1e-3)
    assert high.min() == pytest.approx(12.0 - RADIUS, abs=0.5)


def test_a_table_of_a_barrel_in_closed_form(tmp_path: Path) -> None:
    """p = (u, 0, y) + r e with e = (0, y', u)/√(u² + y'²) turned back by the cam's angle, tan ψ = |y'|/u."""
    out = tmp_path / "flank.csv"
    written(barrel(tmp_path), out, "--samples", 120, "--along", 4, "--flank", "ahead")
    header, *lines = out.read_text("utf-8").splitlines()
    rows = np.array([[float(word) for word in line.split(",")[1:]] for line in lines])
    column = dict(zip(header.split(",")[1:], rows.T, strict=True))
    assert {line.split(",")[0] for line in lines} == {"ahead"}
    assert len(lines) == 480
    u, theta = column["u_mm"], np.deg2rad(column["cam_angle_deg"])
    assert np.unique(u.round(9)).tolist() == [40.0, 44.0, 48.0, 52.0]
    y, step = barrel_motion(theta), 1e-5
    slope = (barrel_motion(theta + step) - barrel_motion(theta - step)) / (2.0 * step)
    size = np.hypot(u, slope)
    e = np.stack((0.0 * u, slope / size, u / size), axis=-1)
    at = np.stack((u, 0.0 * u, y), axis=-1) + RADIUS * e
    point, normal = (turned(v, -theta[:, None])[:, 0] for v in (at, e))
    assert np.abs(point - np.stack([column[f"{k}_mm"] for k in "xyz"], axis=-1)).max() < 1e-6
    assert np.abs(normal - np.stack([column[f"n{k}"] for k in "xyz"], axis=-1)).max() < 1e-7
    assert np.abs(np.rad2deg(np.arctan(np.abs(slope) / u)) - column["pressure_angle_deg"]).max() < 1e-5


def test_a_table_of_an_indexer_has_the_rollers_in_the_blank(tmp_path: Path) -> None:
    out = tmp_path / "flank.csv"
    written(indexer(tmp_path), out, "--samples", 36, "--along", 3)
    rows = [line.split(",") for line in out.read_text("utf-8").splitlines()[1:]]
    assert {row[0] for row in rows} == {"ahead", "behind"}
    keys = [(row[0], int(row[1]), float(row[2]), float(row[3])) for row in rows]
    assert keys == sorted(keys), "by flank, roller, cam angle and u"
    in_dwell = {int(row[1]) for row in rows if float(row[2]) == 100.0}
    assert in_dwell == {1, 6}, "at 30° and -30°"
    for row in rows:
        phi = math.radians(30.0) + math.radians(60.0) * (
            float(cycloidal(np.clip((np.deg2rad(float(row[2])) - math.radians(240.0)) / math.radians(120.0), 0.0, 1.0)))
            + int(row[1]) - 1
        )  # fmt: skip
        assert abs(float(row[3]) * math.sin(phi)) <= 41.0 + 1e-6


def test_stl_of_flanks_keeps_its_tolerance(tmp_path: Path) -> None:
    out = tmp_path / "cam.stl"
    facts = written(barrel(tmp_path), out, "--flank", "ahead", "--tolerance", 0.02)
    content = out.read_bytes()
    rows = np.frombuffer(content, dtype=[("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")], offset=84)
    corners = rows["p"].astype(float)[::37]
    middles = (0.5 * (corners + np.roll(corners, 1, axis=1))).reshape(-1, 3)[:400]
    gap, _ = least_gap(middles, slide_axis, 1.0)
    assert np.abs(gap).max() <= facts["deviation_mm"] <= 0.02


@pytest.mark.parametrize("ending", ["step", "stl", "csv"])
def test_the_same_design_gives_the_same_bytes(tmp_path: Path, ending: str) -> None:
    design = indexer(tmp_path)
    files = [tmp_path / f"{number}.{ending}" for number in range(2)]
    for out in files:
        written(design, out, "--tolerance", 0.05, "--samples", 12)
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.parametrize(
    ("words", "said"),
    [(["--flank", "inner"], "allowed: ahead, behind, both"), (["--solid"], "cam.outer_radius_mm: missing")],
)
def test_faults_are_named_in_one_line(tmp_path: Path, words: list[str], said: str) -> None:
    code, _, faults = run(barrel(tmp_path), "--out", tmp_path / "cam.step", *words)
    assert code == 2
    assert said in faults
    assert faults.count("\n") == 1


def test_an_arm_that_turns_around_is_refused_at_the_angle(tmp_path: Path) -> None:
    design = barrel(tmp_path, unit="deg")
    text = design.read_text("utf-8").replace("start_deg = 0.0", "start_deg = -180.0\nadvance_deg = 360.0")
    text = text.replace("rise_deg = 25.0", "rise_deg = 180.0").replace("rise_deg = -25.0", "rise_deg = 180.0")
    design.write_text(text, "utf-8")
    code, _, faults = run(design, "--out", tmp_path / "cam.step")
    assert (code, faults.count("\n")) == (2, 1)
    assert faults.startswith("cam.roller_radius_mm: the flank ahead has an edge at cam angle 135 deg")


@pytest.mark.stress
@pytest.mark.parametrize("name", ["barrel_feeder", "globoidal_indexer"])
def test_a_kernel_reads_valid_flanks(tmp_path: Path, name: str) -> None:
    """OpenCASCADE reads the file and finds every face and edge valid."""
    out = tmp_path / "cam.step"
    written(EXAMPLES / f"{name}.toml", out)
    assert is_valid(kernel_shape(out))
