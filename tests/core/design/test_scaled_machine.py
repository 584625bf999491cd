"""A machine of another size: what is measured in mm grows by the factor, angles and what is chosen or given stay."""

import json
from pathlib import Path

import numpy as np
import pytest
from sampled import spread

from core.__main__ import main
from core.design import all_paths, faults, get, only, rescaled, split_unit
from core.errors import DesignError
from core.output.channels import channels, existing
from core.project import load
from core.study import Study

EXAMPLES = sorted((Path(__file__).parents[3] / "resources" / "examples").glob("*.toml"))
POWERS = {"mm": 1, "mm/s": 1, "mm/s²": 1, "mm/s³": 1, "m/s²": 1, "m/s³": 1, "m/s": 1, "m": 1, "1/mm": -1}
OF_ANY_SIZE = [path for path in EXAMPLES if 'minimise = "torque"' not in path.read_text("utf-8")]
"""The law of least torque is another one at another size: weight and friction do not grow as inertia does."""
COMPUTED = "cam_slider_linkage"  # whose places have all 17 digits
LIFT = load(next(path for path in EXAMPLES if path.stem == "transfer_lift"))


@pytest.mark.parametrize("factor", [0.1, 3.7])
@pytest.mark.parametrize("path", spread(OF_ANY_SIZE, 8), ids=lambda path: path.stem)
def test_a_scaled_mechanism_moves_as_the_original_does_at_its_size(path: Path, factor: float) -> None:
    whole = load(path)
    scaled = rescaled(whole, factor)
    assert faults(scaled) == []
    for number in range(len(whole.drives)):
        before, after = Study(only(whole, number), 90), Study(only(scaled, number), 90)
        rows = [row for row in channels(before.design) if row.stage in ("motion", "linkage", "cam")]
        rows = existing(before, [row for row in rows if row.stage in before.stages])
        assert rows
        for row in rows:
            one, other = row.values(before), row.values(after)
            wanted = one * factor ** POWERS.get(row.unit.symbol, 0)
            finite = np.isfinite(wanted)
            size = max(np.max(np.abs(wanted[finite]), initial=0.0), 1e-3)
            off = (other - wanted + 180.0) % 360.0 - 180.0 if row.unit.symbol == "°" else other - wanted
            assert np.array_equal(finite, np.isfinite(other)), row.slug
            assert np.max(np.abs(off[finite]), initial=0.0) <= 1e-9 * size, row.slug


@pytest.mark.parametrize("path", [path for path in EXAMPLES if path.stem != COMPUTED], ids=lambda path: path.stem)
def test_a_tenth_ten_times_is_the_design_again(path: Path) -> None:
    """The products are those of decimal numbers: nothing is left of them."""
    whole = load(path)
    assert rescaled(rescaled(whole, 0.1), 10.0) == whole
    assert rescaled(rescaled(whole, 0.1, masses=False), 10.0, masses=False) == whole


def test_masses_grow_by_the_third_power_inertias_by_the_fifth_and_forces_stay() -> None:
    powers = {"mm": 1, "kg": 3, "kg·m²": 5}
    for masses in (True, False):
        scaled = rescaled(LIFT, 2.0, masses=masses)
        for path in all_paths(LIFT):
            value = get(LIFT, path)
            if isinstance(value, float) and not path.startswith("motion"):
                unit = split_unit(path.rpartition(".")[2])[1].symbol
                power = powers.get(unit, 0) if masses or unit == "mm" else 0
                assert get(scaled, path) == value * 2.0**power, path


def test_a_valve_train_of_another_size_has_springs_and_piston_of_that_size(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The rate grows by the factor, forces by its square, stresses stay; durations and overlap stay, lifts and clearance grow."""
    train, out = str(next(path for path in EXAMPLES if path.stem == "valve_train")), tmp_path / "double.toml"
    cards = []
    assert main(["scale", train, "2", "--out", str(out)]) == 0
    assert "Valve springs follow their dimensions: rates × 2, forces × 4" in capsys.readouterr().out
    for path, lifts in ((train, "0.15,1.27"), (str(out), "0.3,2.54")):
        assert main(["valve", path, "--json", "--at", lifts]) == 0
        cards.append(json.loads(capsys.readouterr().out))
    for one, other in zip(*(card["valves"] for card in cards), strict=True):
        for key in (
            "lobe_lift_mm",
            "valve_lift_mm",
            "lift_at_tdc_mm",
            "convex_radius_mm",
            "concave_radius_mm",
            "lash_mm",
        ):
            assert other[key] == pytest.approx(2.0 * one[key], rel=1e-9), key
        assert other["rocker_ratio"] == pytest.approx(one["rocker_ratio"], rel=1e-9)
        assert other["clearance"]["least_mm"] == pytest.approx(2.0 * one["clearance"]["least_mm"], rel=1e-9)
        for before, after in zip(one["events"], other["events"], strict=True):
            ends = ("opens_deg", "closes_deg")
            assert [after[end] for end in ends] == pytest.approx([before[end] for end in ends], abs=1e-9)
        for before, after in zip(one["springs"], other["springs"], strict=True):
            powers = {"rate_n_per_mm": 1, "seat_n": 2, "open_n": 2, "bind_mm": 1, "natural_hz": -1, "goodman": 0}
            for key, power in powers.items():
                assert after[key] == pytest.approx(before[key] * 2.0**power, rel=1e-9), key
            assert after["stress_mpa"] == pytest.approx(before["stress_mpa"], rel=1e-9)
    areas = [card["pairs"][0]["overlap_area_mm_deg"] for card in cards]
    assert areas[1] == pytest.approx(2.0 * areas[0], rel=1e-9)
    assert main(["scale", str(out), "0.5", "--out", str(tmp_path / "same.toml")]) == 0
    assert load(tmp_path / "same.toml") == load(train)
    assert (tmp_path / "same.toml").read_text("utf-8") == Path(train).read_text("utf-8")


@pytest.mark.parametrize("factor", [0.0, -1.0, float("nan")])
def test_a_factor_is_above_zero(factor: float) -> None:
    with pytest.raises(DesignError, match="factor"):
        rescaled(LIFT, factor)


def test_the_command_writes_the_scaled_design(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lift, out = str(next(path for path in EXAMPLES if path.stem == "transfer_lift")), tmp_path / "small.toml"
    assert main(["scale", lift, "0.1", "--out", str(out)]) == 0
    assert load(out) == rescaled(LIFT, 0.1)
    assert "Lengths × 0.1, masses × 0.001" in capsys.readouterr().out
    assert main(["scale", lift, "0.1", "--out", str(out), "--keep-masses"]) == 0
    assert get(load(out), "loads.arm_mass_kg") == 664.0
    assert main(["scale", str(out), "2", "--out", str(out)]) == 2, "no command writes onto what it reads"
    assert main(["scale", lift, "1e9", "--out", str(tmp_path / "large.toml")]) == 2
    assert "follower.rod_mm = 845000000000.0: outside its range" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["small.toml"]
