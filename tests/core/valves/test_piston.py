"""Clearance between valve and piston: reference numbers, the crank by its geometry, limits, findings and files."""

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from valve_trains import FLAT_TAPPET, LOBE_A

from core.__main__ import main
from core.design import Design, put
from core.project import load, loads
from core.study import Study, extremes_of, findings_of
from core.study.quantities import names_of, quantities_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
TEXT = (
    'format = 1\nname = "Piston"\n'
    + LOBE_A
    + FLAT_TAPPET
    + """[shaft]
rotation = "cw"
speed_rpm = 1000.0
[engine]
stroke_mm = 84.0
rod_mm = 138.0
pin_offset_mm = {offset}
[valve]
centre_deg = {centre}
lash_mm = {lash}
angle_deg = 15.0
clearance_mm = 6.0
pocket = "{pocket}"
"""
)


def text(pocket: str = "flat", centre: float = 108.0, offset: float = 0.0, lash: float = 0.0) -> str:
    return TEXT.format(pocket=pocket, centre=centre, offset=offset, lash=lash)


def design(**how: object) -> Design:
    return loads(text(**how))


def least(design: Design, folder: Path, capsys: pytest.CaptureFixture[str]) -> tuple[float, float]:
    from core.project import save

    save(design, folder / "piston.toml")
    assert main(["valve", str(folder / "piston.toml"), "--json"]) == 0
    clearance = json.loads(capsys.readouterr().out)["valves"][0]["clearance"]
    return clearance["least_mm"], clearance["crank_deg"]


@pytest.mark.parametrize(("pocket", "clearance", "crank"), [("flat", 4.7408415, 6.636), ("parallel", 4.6691542, 7.115)])
def test_the_reference_clearances(
    pocket: str, clearance: float, crank: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    value, at = least(design(pocket=pocket), tmp_path, capsys)
    assert value == pytest.approx(clearance, abs=5e-8)
    assert at == pytest.approx(crank, abs=5e-4)
    value, at = least(design(pocket=pocket, centre=-108.0), tmp_path, capsys)  # an exhaust valve is its mirror image
    assert (value, at) == pytest.approx((clearance, -crank), abs=5e-4)


def by_points(crank: np.ndarray, offset: float) -> np.ndarray:
    """Piston below its highest position [mm]: pin of the crank, and the piston on its line by the rod, from vectors."""
    throw, rod = 42.0, 138.0
    highest = math.asin(offset / (throw + rod))
    pin = throw * np.exp(
        1j * (np.deg2rad(crank) + highest)
    )  # real part: along the cylinder, imaginary: to where the crank turns
    height = pin.real + np.sqrt(rod**2 - (pin.imag - offset) ** 2)
    return math.sqrt((throw + rod) ** 2 - offset**2) - height


@pytest.mark.parametrize("pocket", ["flat", "parallel"])
@pytest.mark.parametrize("offset", [1.2, *(pytest.param(offset, marks=pytest.mark.stress) for offset in (0.0, -9.0))])
@pytest.mark.parametrize("lash", [0.15, pytest.param(0.0, marks=pytest.mark.stress)])
def test_clearance_at_many_angles_of_the_crank(
    pocket: str, offset: float, lash: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    typed = design(pocket=pocket, offset=offset, lash=lash)
    crank = -360.0 + 720.0 * np.arange(100_000) / 100_000
    travel = by_points(crank, offset)
    assert travel.min() == pytest.approx(0.0, abs=1e-12)
    study = Study(typed).at_theta(np.deg2rad((180.0 + (crank - 108.0) / 2.0) % 360.0))
    lift = np.maximum(1e3 * study.motion.displacement[0] - lash, 0.0)
    slope = math.cos(math.radians(15.0))
    expected = 6.0 + (travel - lift * slope if pocket == "flat" else travel * slope - lift)
    assert 1e3 * quantities_of(study)["piston_clearance"].value(study) == pytest.approx(expected, abs=1e-9)
    value, at = least(typed, tmp_path, capsys)
    assert value == pytest.approx(expected.min(), abs=1e-6)
    assert at == pytest.approx(crank[expected.argmin()], abs=0.02)
    assert value <= expected.min() + 1e-12


def test_clearance_is_a_column_a_limit_and_a_finding(tmp_path: Path) -> None:
    path = tmp_path / "piston.toml"
    path.write_text(text(), encoding="utf-8")
    assert main(["export", str(path), "--out", str(tmp_path / "out"), "--samples", "720"]) == 0
    with (tmp_path / "out" / "kinematics.csv").open(encoding="utf-8") as file:
        column = [float(row["piston_clearance_mm"]) for row in csv.DictReader(file)]
    assert min(column) == pytest.approx(4.7408, abs=2e-3)

    def codes(design: Design) -> dict[str, tuple[str, str]]:
        return {finding.code: (finding.severity, finding.field) for finding in findings_of(Study(design))}

    assert "piston-clearance" not in codes(put(design(), "limits.piston_clearance_mm", 4.74))
    limited = codes(put(design(), "limits.piston_clearance_mm", 4.75))
    assert limited["piston-clearance"] == ("warning", "limits.piston_clearance_mm")
    assert "piston-valve" not in codes(put(design(), "valve.clearance_mm", 1.26))
    hits = put(design(), "valve.clearance_mm", 1.25)
    assert codes(hits)["piston-valve"] == ("error", "valve.clearance_mm")
    assert main(["check", str(path)]) == 0


def test_without_angle_or_clearance_there_is_no_piston() -> None:
    for key in ("valve.angle_deg", "valve.clearance_mm"):
        assert "piston_clearance" not in names_of(put(design(), key, None))


def test_the_example_has_two_valves_over_a_piston(capsys: pytest.CaptureFixture[str]) -> None:
    path = EXAMPLES / "valve_train.toml"
    assert not list(findings_of(Study(load(path))))
    assert main(["valve", str(path), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [valve["drive"] for valve in data["valves"]] == ["Inlet", "Exhaust"]
    assert all(0.0 < valve["clearance"]["least_mm"] < 6.0 for valve in data["valves"])
    assert all(valve["springs"][0]["goodman"] > 1.0 for valve in data["valves"])
    assert data["pairs"][0]["separation_deg"] == pytest.approx(109.0)
    assert main(["valve", str(path)]) == 0
    assert "least clearance to the piston" in capsys.readouterr().out


@pytest.mark.parametrize(("offset", "rod"), [(0.0, 42.0), (10.0, 52.0), (-10.0, 51.0)])
def test_a_rod_that_is_too_short_is_one_line(
    offset: float, rod: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text(offset=offset).replace("138.0", str(rod)), encoding="utf-8")
    assert main(["check", str(path)]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "engine.rod_mm" in line


def test_extremes_follow_the_centre() -> None:
    """A later centre leaves more room: extremes are not those of the earlier design."""
    values = [
        extremes_of(Study(design(centre=centre)), "linkage", ("piston_clearance",))["piston_clearance"].low.value
        for centre in (100.0, 108.0, 116.0)
    ]
    assert values == sorted(values)
    assert values[0] < values[-1] - 1e-4
