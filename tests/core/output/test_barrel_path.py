"""G-code of a barrel's groove: a machine with a rotary axis follows the file, and its cutter is held against the exact flanks."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from surface_command import run

import kindyna as kd

EXAMPLE = Path(__file__).parents[3] / "resources/examples/barrel_feeder.toml"
RADIUS, PLAY, INNER, LENGTH, BLANK = 8.0, 0.3, 40.0, 12.0, 54.0
STROKE, ARM, SWING = 25.0, 60.0, math.radians(24.0)


def design(folder: Path, rotation: str = "ccw", unit: str = "mm", **keys: object) -> Path:
    """A dwell of 60°, a cycloidal rise and a return of 150° each, of a slide or an arm."""
    rise = STROKE if unit == "mm" else math.degrees(SWING)
    cam = {
        "kind": "'barrel'", "form": "'groove'", "play_mm": PLAY, "roller_radius_mm": RADIUS, "roller_length_mm": LENGTH,
        "roller_inner_mm": INNER, "outer_radius_mm": BLANK, **({} if unit == "mm" else {"arm_mm": ARM}), **keys,
    }  # fmt: skip
    path = folder / "barrel.toml"
    path.write_text(
        f'format = 1\nname = "Förderer (1)"\n[motion]\nstart_{unit} = 0.0\n[[motion.segments]]\nlaw = "dwell"\nspan_deg = 60.0\n'
        f'[[motion.segments]]\nlaw = "cycloidal"\nspan_deg = 150.0\nrise_{unit} = {rise}\n'
        f'[[motion.segments]]\nlaw = "cycloidal"\nspan_deg = 150.0\nrise_{unit} = {-rise}\n[cam]\n'
        + "".join(f"{key} = {value}\n" for key, value in cam.items() if value is not None)
        + f'[shaft]\nrotation = "{rotation}"\nspeed_rpm = 60.0\n[loads]\n',
        "utf-8",
    )
    return path


def lift(theta: np.ndarray) -> np.ndarray:
    """The motion over its rise, 0 to 1."""
    x = np.clip((np.mod(theta, 2.0 * np.pi) - math.radians(60.0)) / math.radians(150.0), 0.0, 2.0)
    x = np.minimum(x, 2.0 - x)
    return x - np.sin(2.0 * np.pi * x) / (2.0 * np.pi)


def roller_axis(theta: np.ndarray, sense: float, unit: str, u: np.ndarray) -> np.ndarray:
    """Points (n, 3) [mm] of the roller's axis in the frame of the cam."""
    if unit == "mm":
        at = np.stack((u, 0.0 * u, STROKE * lift(theta)), axis=-1)
    else:
        phi = SWING * lift(theta)
        at = np.stack((u, ARM * (np.cos(phi) - 1.0), ARM * np.sin(phi)), axis=-1)
    return turned(at, -sense * theta)


def turned(points: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Points (n, 3) rotated about z by one angle each."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack((c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1], points[:, 2]), axis=-1)


def flank_points(side: str, sense: float, unit: str) -> tuple[np.ndarray, np.ndarray]:
    """Points and normals (n, 3) of an exact flank: across the roller's axis and its velocity against the cam."""
    theta = np.linspace(0.0, 2.0 * np.pi, 97)[:-1]
    u = INNER + LENGTH * np.tile([0.0, 0.5, 1.0], 32)
    step = 1e-4
    at, after, before = (roller_axis(theta + k * step, sense, unit, u) for k in (0, 1, -1))
    along = turned(np.tile([1.0, 0.0, 0.0], (96, 1)), -sense * theta)
    normal = np.cross(along, after - before)
    normal *= (np.sign(normal[:, 2]) * (1.0 if side == "ahead" else -1.0) / np.linalg.norm(normal, axis=1))[:, None]
    return at + (RADIUS + (PLAY if side == "behind" else 0.0)) * normal, normal


class MachineFile:
    """Axis of the cutter at many moments while it cuts, pass by pass: A [rad], X, Y, Z [mm], and the minutes of each move."""

    def __init__(self, text: str) -> None:
        self.passes: list[np.ndarray] = []
        self.feeds: list[float] = []
        at = dict.fromkeys("XYZA", 0.0)
        for line in text.splitlines():
            if line == "G93":
                self.passes.append(np.zeros((0, 4)))
            if (line.startswith("G1") and "A" in line) or line.startswith(("G0 X", "G0 Z", "G1 Z", "G1 X")):
                words = {axis: float(value) for axis, value in re.findall(r"([XYZAF])(-?\d+\.\d*)", line)}
                rate = words.pop("F", 0.0)
                start = np.array(list(at.values()))
                at.update(words)
                end = np.array(list(at.values()))
                if "A" in words and line.startswith("G1"):
                    count = math.ceil(abs(end[3] - start[3]) / 0.02) + 1
                    moments = start + (end - start) * np.linspace(0.0, 1.0, count)[:, None]
                    moments[:, 3] = np.deg2rad(moments[:, 3])
                    self.passes[-1] = np.concatenate((self.passes[-1], moments))
                    x, y, _, a = end - start
                    self.feeds.append(rate * math.hypot(x, y, math.radians(a) * BLANK))

    def axis(self, number: int, u: float) -> np.ndarray:
        """Points (n, 3) of the cutter's axis in the frame of the cam: growing A moves it counter-clockwise about z."""
        x, y, _, a = self.passes[number].T
        return turned(np.stack((0.0 * x + u, -y, x), axis=-1), a)

    def distances(self, points: np.ndarray) -> np.ndarray:
        """Least distance (n,) of points from the axis of the cutter."""
        origin = np.concatenate([self.axis(k, 0.0) for k in range(len(self.passes))])
        along = np.concatenate([self.axis(k, 1.0) for k in range(len(self.passes))]) - origin
        result = []
        for point in points:
            away = point - origin
            across = away - (away * along).sum(axis=1)[:, None] * along
            ahead = (away * along).sum(axis=1) > 0.0
            result.append(np.linalg.norm(across[ahead], axis=1).min())
        return np.array(result)


@pytest.mark.parametrize(("rotation", "unit"), [("ccw", "mm"), ("cw", "deg")])
def test_the_cutter_leaves_the_exact_flanks(tmp_path: Path, rotation: str, unit: str) -> None:
    """Every point of both flanks is the cutter's radius from its axis at some moment, and never nearer, within the deviation."""
    out = tmp_path / "cam.nc"
    code, said, faults = run(design(tmp_path, rotation, unit), "--out", out, "--tolerance", 0.002, "--json")
    assert (code, faults) == (0, "")
    deviation = json.loads(said)["deviation_mm"]
    assert 0.0 < deviation <= 0.002
    file = MachineFile(out.read_text("ascii"))
    assert len(file.passes) == 2, "one on the axis, one for the play"
    for side in ("ahead", "behind"):
        points, _ = flank_points(side, 1.0 if rotation == "ccw" else -1.0, unit)
        assert np.abs(file.distances(points) - RADIUS).max() <= deviation + 1e-5
    floor = BLANK - (INNER - PLAY)
    assert {z for part in file.passes for z in part[:, 2].tolist()} == {BLANK - floor}
    assert np.allclose(file.feeds, 200.0, rtol=1e-3), "at the face of the blank"


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
@pytest.mark.parametrize("words", [(), ("--conventional",)])
def test_each_flank_is_cut_in_climb_milling(tmp_path: Path, rotation: str, words: tuple[str, ...]) -> None:
    """A tooth of M3 moves against the travel of the cutter where it climbs: ahead on the axis, behind in the pass for the play."""
    out = tmp_path / "cam.nc"
    assert run(design(tmp_path, rotation), "--out", out, "--step", 5.0, *words)[0] == 0
    file = MachineFile(out.read_text("ascii"))
    assert len(file.passes) == 4, "14.3 mm in three steps, and the play"
    for number, part in enumerate(file.passes):
        points = file.axis(number, INNER)
        travel = points[2] - points[0]
        along = file.axis(number, 1.0)[0] - file.axis(number, 0.0)[0]
        into_cam = np.array([0.0, 0.0, 1.0 if number < 3 else -1.0])  # in the dwell
        tooth = -np.cross(along, into_cam)
        assert (float(tooth @ travel) < 0.0) == (not words)
        assert abs(part[-1, 3] - part[0, 3]) == pytest.approx(2.0 * np.pi)


def test_without_play_one_pass_cuts_both_flanks(tmp_path: Path) -> None:
    out = tmp_path / "cam.nc"
    code, said, _ = run(design(tmp_path, play_mm=0.0), "--out", out)
    assert code == 0
    text = out.read_text("ascii")
    assert "(With M3: flank ahead climb milling, flank behind conventional)" in text
    assert "(Design: Forderer [1])" in text
    assert len(MachineFile(text).passes) == 1
    assert "points of the cutter's path" in said


def test_the_same_design_gives_the_same_path(tmp_path: Path) -> None:
    files = [tmp_path / f"{number}.nc" for number in range(2)]
    for out in files:
        assert run(EXAMPLE, "--out", out)[0] == 0
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.parametrize(
    ("unit", "keys", "words", "said"),
    [
        ("mm", {"roller_taper_deg": 5.0}, (), "cam.roller_taper_deg = 5: "),
        ("mm", {"form": "'rib'", "play_mm": None, "roller_distance_mm": 24.0}, (), "cam.form = 'rib': "),
        ("deg", {"rollers": 6}, (), "cam.rollers = 6: "),
        ("deg", {"kind": "'globoidal'", "arm_mm": None, "centre_distance_mm": 90.0}, (), "cam.kind = 'globoidal': "),
        ("mm", {"outer_radius_mm": None}, (), "cam.outer_radius_mm: missing"),
        ("mm", {}, ("--flank", "ahead"), "flank 'ahead': the path cuts both flanks"),
        ("mm", {}, ("--solid",), "G-code has the path of a cutter, no solid"),
        ("mm", {}, ("--tolerance", 1e-4), "tolerance 0.0001 mm: below the accuracy"),
        ("mm", {}, ("--depth", 54.0), "depth 54 mm: the cutter reaches the axis"),
    ],
)  # fmt: skip
def test_faults_are_named_in_one_line(
    tmp_path: Path, unit: str, keys: dict[str, object], words: tuple[object, ...], said: str
) -> None:
    out = tmp_path / "cam.nc"
    code, _, faults = run(design(tmp_path, unit=unit, **keys), "--out", out, *words)
    assert code == 2
    assert said in faults
    assert faults.count("\n") == 1
    assert not out.exists()


def test_a_disk_cam_is_sent_to_the_command_profile(tmp_path: Path) -> None:
    code, _, faults = run(EXAMPLE.with_name("groove.toml"), "--out", tmp_path / "cam.nc")
    assert (code, faults.count("\n")) == (2, 1)
    assert "written by the command profile" in faults


def test_python_writes_the_path_of_the_command(tmp_path: Path) -> None:
    files = [tmp_path / f"{number}.nc" for number in range(2)]
    assert run(EXAMPLE, "--out", files[0], "--feed", 300)[0] == 0
    kd.open(EXAMPLE).study().export(files[1], feed=300.0)
    assert files[0].read_bytes() == files[1].read_bytes()
