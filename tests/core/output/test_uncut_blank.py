"""Flanks of a cam in space next to its blank: a cylinder, or a torus about the axis of the turret, with its volume by quadrature."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from kernel_reader import cut_by_sheets, is_valid, kernel_shape, volumes
from sampled import stressed
from step_reader import Face, StepFile, check_topology
from stl_reader import enclosed_volume, open_sides, read_stl
from surface_command import run, written

EXAMPLES = Path(__file__).parents[3] / "resources/examples"
DISTANCE, INNER, LENGTH_OF_ROLLER, HALF, RADIUS = 120.0, 48.0, 16.0, 50.0, 98.0  # of the example
BORE, KEY_WIDTH, KEY_DEPTH = 15.0, 8.0, 3.3
COARSE = ("--tolerance", 0.05)


def indexer(folder: Path, **changes: float | None) -> Path:
    """The globoidal indexer with other keys of its cam; None leaves one out."""
    lines = (EXAMPLES / "globoidal_indexer.toml").read_text("utf-8").splitlines()
    kept = [line for line in lines if line.split(" = ")[0] not in changes]
    at = kept.index("[cam]") + 1
    kept[at:at] = [f"{key} = {value}" for key, value in changes.items() if value is not None]
    path = folder / "indexer.toml"
    path.write_text("\n".join(kept) + "\n", "utf-8")
    return path


def bore_area() -> float:
    """Bore and keyway [mm²]: the keyway's rectangle less the segment of the bore that it covers."""
    half = 0.5 * KEY_WIDTH
    angle = math.asin(half / BORE)
    chord = BORE * math.cos(angle)
    return math.pi * BORE**2 + KEY_WIDTH * (BORE + KEY_DEPTH - chord) - (BORE**2 * angle - half * chord)


def blank_volume(half: float, radius: float) -> float:
    """∫π ρ² dz of the arc about the turret's axis, where it is nearer than the blank radius, less the bore."""
    z = np.linspace(0.0, half, 200_001)
    rho = np.minimum(DISTANCE - np.sqrt(np.maximum(INNER**2 - z**2, 0.0)), radius)
    return 2.0 * math.pi * float(np.trapezoid(rho**2, z)) - 2.0 * half * bore_area()


def surfaces(faces: list[Face]) -> list[str]:
    return sorted(face.surface.kind for face in faces)


@pytest.fixture(scope="module")
def step(tmp_path_factory: pytest.TempPathFactory) -> tuple[StepFile, str]:
    """The file of the indexer, and what the command says of it."""
    folder = tmp_path_factory.mktemp("indexer")
    code, said, _ = run(indexer(folder), "--out", folder / "cam.step", "--solid", *COARSE)
    assert code == 0
    return StepFile((folder / "cam.step").read_bytes()), said.splitlines()[1]


def test_a_globoid_leaves_as_flanks_next_to_its_blank(step: tuple[StepFile, str]) -> None:
    """Blank and floor are tori about the axis of the turret, along both ends of the rollers."""
    file, said = step
    assert said.endswith("flanks and blank are side by side: the blank is not cut")
    assert "Flanks and blank side by side, the blank not cut, of a globoidal cam" in file.header
    assert len(list(file.all("MANIFOLD_SOLID_BREP"))) == 1
    blank, floor, *flanks = file.shells.items()
    assert (blank[0], floor[0]) == ("blank", "floor")
    assert {name.split()[0] for name, _ in flanks} == {"ahead", "behind"}
    for name, faces in file.shells.items():
        check_topology(faces, is_closed=name == "blank")
    assert surfaces(blank[1]).count("TOROIDAL_SURFACE") == surfaces(floor[1]).count("TOROIDAL_SURFACE") == 2
    assert surfaces(blank[1]).count("CYLINDRICAL_SURFACE") == 6, "two at each end, two of the bore"
    for faces, tube in ((blank[1], INNER), (floor[1], INNER + LENGTH_OF_ROLLER)):
        (torus, _) = (face for face in faces if face.surface.kind == "TOROIDAL_SURFACE")
        assert torus.surface.data[1:] == (DISTANCE, tube)
        assert not torus.is_along, "the material is outside of the tube"
        points = torus.polygon(0, 50)
        x, y, z = points.T
        assert np.abs(np.hypot(np.hypot(x, y) - DISTANCE, z) - tube).max() < 1e-9
        assert np.hypot(x, y).max() == pytest.approx(
            RADIUS if tube == INNER else DISTANCE - math.sqrt(tube**2 - HALF**2)
        )


def distance_from_turret(points: np.ndarray) -> np.ndarray:
    """Distance (n,) from the circle on which the axis of the turret moves around the cam."""
    return np.hypot(DISTANCE - np.hypot(points[:, 0], points[:, 1]), points[:, 2])


def test_the_flanks_extend_beyond_blank_and_floor(step: tuple[StepFile, str]) -> None:
    """They can cut the blank: between floor and blank, and until the roller has left it or the next one continues at cam angle 0."""
    ends = 0
    t = np.linspace(0.0, 1.0, 9)
    for name, faces in step[0].shells.items():
        if name in ("blank", "floor"):
            continue
        for face in faces:
            inner, outer = (face.surface.at(t, np.full(9, v))[0] for v in (0.0, 1.0))
            assert distance_from_turret(inner).max() < INNER - 0.2
            assert distance_from_turret(outer).min() > INNER + LENGTH_OF_ROLLER + 0.2
        for face, u in ((faces[0], 0.0), (faces[-1], 1.0)):
            points, _ = face.surface.at(np.full(9, u), t)
            rho = np.hypot(points[:, 0], points[:, 1])
            outside = (np.abs(points[:, 2]) > HALF) | (rho > RADIUS) | (distance_from_turret(points) < INNER + 1e-6)
            ends += bool(outside.all())
    assert ends == 4, "each flank enters once and leaves once"


@pytest.mark.parametrize(
    ("changes", "half", "radius"),
    [({}, HALF, RADIUS), stressed({"length_mm": 70.0, "outer_radius_mm": None}, 35.0, np.inf)],
)
def test_the_volume_is_that_of_the_blank(
    tmp_path: Path, changes: dict[str, float | None], half: float, radius: float
) -> None:
    code, said, _ = run(indexer(tmp_path, **changes), "--out", tmp_path / "cam.step", "--solid", "--json", *COARSE)
    facts = json.loads(said)
    assert code in (0, 1), "a finding of the shorter blank"
    assert facts["blank_is_cut"] is False
    assert facts["volume_mm3"] == pytest.approx(blank_volume(half, radius), rel=1e-8)


def rib(folder: Path) -> Path:
    """The barrel feeder with a rib between two rollers."""
    text = (EXAMPLES / "barrel_feeder.toml").read_text("utf-8")
    path = folder / "rib.toml"
    path.write_text(text.replace('form = "groove"\nplay_mm = 0.02', 'form = "rib"\nroller_distance_mm = 30.0'), "utf-8")
    return path


def test_a_rib_leaves_next_to_a_cylinder(tmp_path: Path) -> None:
    facts = written(rib(tmp_path), tmp_path / "cam.step", "--solid", *COARSE)
    shells = StepFile((tmp_path / "cam.step").read_bytes()).shells
    assert list(shells) == ["blank", "floor", "ahead 1", "behind 2"]
    check_topology(shells["blank"], is_closed=True)
    rho = np.hypot(*shells["ahead 1"][0].polygon(0, 9)[:, :2].T)
    assert (rho.min(), rho.max()) == (pytest.approx(70.0 - 0.24, abs=1e-3), pytest.approx(82.0 + 0.24, abs=1e-3))
    (low, high) = (
        face.surface.data[0][0][2] for face in shells["blank"] if face.surface.kind == "PLANE" and len(face.loops) == 2
    )
    assert (low, high) == (20.0 - 55.0, 20.0 + 55.0), "about the middle of the motion"
    assert {face.surface.data[1] for face in shells["floor"]} == {70.0}
    assert facts["volume_mm3"] == pytest.approx(110.0 * (math.pi * 82.0**2 - 1_000.0), rel=1e-2)


def test_stl_of_a_blank_is_watertight(tmp_path: Path) -> None:
    out = tmp_path / "cam.stl"
    assert written(indexer(tmp_path), out, "--solid", *COARSE)["deviation_mm"] <= 0.05
    _, corners = read_stl(out)
    rho, z = np.hypot(corners[..., 0], corners[..., 1]), corners[..., 2]
    tube = np.hypot(DISTANCE - rho, z)
    on_blank = (np.abs(tube - INNER) < 1e-4) | (np.abs(np.abs(z) - HALF) < 1e-6) | (np.abs(rho - RADIUS) < 1e-4)
    blank = corners[on_blank.all(axis=1) | (rho < BORE + KEY_DEPTH + 1.0).all(axis=1)]
    assert open_sides(blank) == 0
    assert enclosed_volume(blank) == pytest.approx(blank_volume(HALF, RADIUS), rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"length_mm": None}, "cam.length_mm: missing: the length of the blank"),
        ({"outer_radius_mm": None}, "cam.outer_radius_mm: missing: the arc about the turret's axis ends 48 mm"),
        ({"outer_radius_mm": 130.0}, "cam.outer_radius_mm: 130 mm: the arc about the turret's axis ends 48 mm"),
        ({"outer_radius_mm": 56.0}, "cam.outer_radius_mm: 56 mm: the rollers do not reach into the blank"),
    ],
)
def test_faults_are_named_in_one_line(tmp_path: Path, changes: dict[str, float | None], said: str) -> None:
    code, _, faults = run(indexer(tmp_path, **changes), "--out", tmp_path / "cam.step", "--solid")
    assert code == 2
    assert said in faults
    assert faults.count("\n") == 1


@pytest.mark.stress
@pytest.mark.parametrize("changes", [{}, {"length_mm": 70.0, "outer_radius_mm": None}, {"outer_radius_mm": 70.0}])
def test_a_kernel_reads_valid_bodies(tmp_path: Path, changes: dict[str, float | None]) -> None:
    """OpenCASCADE finds blank, floor and flanks valid, and the volume of the blank."""
    out = tmp_path / "cam.step"
    facts = json.loads(run(indexer(tmp_path, **changes), "--out", out, "--solid", "--json")[1])
    shape = kernel_shape(out)
    assert is_valid(shape)
    assert volumes(shape, 1e-5) == [pytest.approx(facts["volume_mm3"], rel=1e-7)]


@pytest.mark.stress
def test_a_kernel_cuts_the_blank_by_the_sheets(tmp_path: Path) -> None:
    """OpenCASCADE cuts the blank of a rib into core, rib and both sides, that of an indexer into core, rib and groove."""
    for design, count in ((rib(tmp_path), 4), (indexer(tmp_path), 3)):
        out = tmp_path / "cam.step"
        facts = written(design, out, "--solid")
        parts = cut_by_sheets(kernel_shape(out))
        assert is_valid(parts)
        sizes = sorted(volumes(parts, 1e-6))
        assert len(sizes) == count
        assert sum(sizes) == pytest.approx(facts["volume_mm3"], rel=1e-6)
        if count == 4:
            bore = math.pi * 17.5**2 + 10.0 * 3.3  # less the segment, below the accuracy asked for
            assert sizes[-1] == pytest.approx(110.0 * (math.pi * 70.0**2 - bore), rel=1e-3), "core up to the floor"
            assert sizes[1] == pytest.approx(sizes[2], rel=1e-6), "rise and return have laws of equal means"
        else:
            z = np.linspace(0.0, HALF, 200_001)
            floor = DISTANCE - np.sqrt((INNER + LENGTH_OF_ROLLER) ** 2 - z**2)
            core = 2.0 * math.pi * float(np.trapezoid(floor**2, z)) - 2.0 * HALF * bore_area()
            assert sizes[-1] == pytest.approx(core, rel=1e-5)
