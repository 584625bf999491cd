"""Valves on the crank: printed cards, references of an independent calculation, phases, files, and the command ``valve``."""

import csv
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from core.__main__ import main
from core.design import Design, Valve, all_paths, edited, events, get, only, put, with_phase
from core.errors import DesignError
from core.motion import program
from core.project import dumps, loads
from core.study import Study, many
from core.valves import valve_data, valve_pairs, valve_timings

ENGINE = "[engine]\nstroke_mm = 84.0\nrod_mm = 138.0\n"
LOBE = "lift_mm = 9.0\nduration = [[0.15, 270.0], [1.27, 210.0]]\nramp_mm = 0.2\nramp_runup_deg = 8.0\n"
DRIVE = """[[drives]]
name = "{name}"
[drives.motion]
start_mm = 0.0
[drives.motion.lobe]
{lobe}[drives.follower]
kind = "translating"
face = "flat"
[drives.cam]
base_radius_mm = 18.0
[drives.valve]
centre_deg = {centre}
{valve}[drives.loads]
follower_mass_kg = 0.14
spring_rate_n_per_mm = 30.0
preload_n = 300.0
gravity_m_s2 = 0.0
"""


def text(inlet: float = 108.0, exhaust: float = -108.0, lobe: str = LOBE, valve: str = "", engine: str = ENGINE) -> str:
    drives = "".join(
        DRIVE.format(name=name, centre=centre, lobe=lobe, valve=valve)
        for name, centre in (("Inlet", inlet), ("Exhaust", exhaust))
    )
    return f'format = 1\nname = "Head"\n[shaft]\nrotation = "ccw"\nspeed_rpm = 1000.0\n{engine}{drives}'


def machine(**how: Any) -> Design:
    return loads(text(**how))


def card(design: Design, *lifts: float) -> dict:
    return valve_data(valve_timings(design), lifts or (1.27,))


def events_of(valve: dict, of: str = "lobe") -> list[tuple[float, float, float]]:
    return [(e["opens_deg"], e["closes_deg"], e["duration_deg"]) for e in valve["events"] if e["of"] == of]


# -- printed cards --------------------------------------------------------------------------------------------


def test_opening_and_closing_of_printed_cards() -> None:
    """23/67 is 270° at 112°; 277° at 0.050 inch about 106.5° is 32/65."""
    for duration, centre, before, after in ((270.0, 112.0, 23.0, 67.0), (277.0, 106.5, 32.0, 65.0)):
        lobe = f"lift_mm = 11.0\nduration = [[0.1, {duration + 40.0}], [1.27, {duration}]]\n"
        ((opens, closes, total),) = events_of(card(machine(inlet=centre, lobe=lobe))["valves"][0])
        assert (opens, closes - 180.0) == pytest.approx((-before, after), abs=1e-9)
        assert total == pytest.approx(duration, abs=1e-9)


def test_separation_and_advance_of_a_printed_card() -> None:
    """A separation of 102° advanced by 4° has its centres at 98° and 106°."""
    (pair,) = valve_pairs(valve_timings(machine(inlet=98.0, exhaust=-106.0)))
    assert (pair.separation, pair.advance) == (102.0, 4.0)


# -- references -----------------------------------------------------------------------------------------------


def test_the_reference_lobe_on_its_crank() -> None:
    data = card(machine(), 0.1524, 1.27)
    inlet, pair = data["valves"][0], data["pairs"][0]
    assert inlet["lift_at_tdc_mm"] == pytest.approx(0.9510424900, abs=1e-10)
    assert pair["overlap_area_mm_deg"] == pytest.approx(22.5555585, abs=1e-7)
    assert inlet["least_tappet_diameter_mm"] == pytest.approx(26.1852838, abs=1e-7)
    assert inlet["velocity_mm_per_deg"] == pytest.approx([-0.2285097089, 0.2285097089], abs=1e-10)
    assert inlet["acceleration_mm_per_deg2"] == pytest.approx([-0.0069889235, 0.0308074523], abs=1e-10)
    assert inlet["intensity_deg"] == pytest.approx({"0.1016": 79.36, "0.1524": 59.04, "0.508": 16.7061947869}, abs=1e-9)
    assert inlet["convex_radius_mm"] == pytest.approx(4.0567173, abs=1e-6)
    assert "concave_radius_mm" not in inlet
    assert [(row["of"], row["at_mm"]) for row in pair["overlap"]] == [
        (of, at) for at in (0.1524, 1.27) for of in ("lobe", "valve")
    ]
    assert [row["deg"] for row in pair["overlap"]] == pytest.approx([53.04, 53.04, -6.0, -6.0], abs=1e-9)
    assert {"springs", "clearance", "rocker_ratio"} & inlet.keys() == set()


def test_a_roller_has_hollow_flanks() -> None:
    roller = text().replace('face = "flat"', 'face = "roller"').replace("= 18.0", "= 18.0\nroller_radius_mm = 9.0")
    inlet = card(loads(roller))["valves"][0]
    assert inlet["concave_radius_mm"] == pytest.approx(20.482739, abs=1e-6)
    assert inlet["convex_radius_mm"] == pytest.approx(12.9872, abs=1e-4)
    assert "least_tappet_diameter_mm" not in inlet


def test_a_wider_cam_needs_a_larger_tappet() -> None:
    design = machine()
    assert card(put(design, "drives[0].cam.thickness_mm", 12.0))["valves"][0][
        "least_tappet_diameter_mm"
    ] == pytest.approx(math.hypot(26.1852838, 12.0), abs=1e-7)


def test_the_speed_of_float_is_that_of_the_engine() -> None:
    """The spring's inertia force meets its force at the nose: ω² = (k L + F0)/(m N), the engine at twice the speed."""
    spring, mass = 29.9029378, 0.14 + 33.562774e-3 / 3.0
    design = machine()
    for path, value in {"spring_rate_n_per_mm": spring, "preload_n": 313.9808, "follower_mass_kg": mass}.items():
        design = put(design, f"drives[0].loads.{path}", value)
    assert card(design)["valves"][0]["float_rpm"] == pytest.approx(7830.5049, abs=1e-3)


# -- lash and overlap, by quadrature of the motion ------------------------------------------------------------


def lift(design: Design, number: int, crank: float) -> float:
    """Valve lift [mm] at a crank angle, by the machine's own angle."""
    drive = design.drives[number]
    compiled = program(drive.motion)
    theta = np.array([np.deg2rad((crank / 2.0 - drive.phase) % 360.0)])
    return max(1e3 * float(compiled.state(compiled.angles(theta)).y[0, 0]) - drive.valve.lash_mm, 0.0)


@pytest.mark.parametrize("lash", [0.0, 0.15, 0.6])
def test_lash_closes_the_valve(lash: float) -> None:
    design = machine(valve=f"lash_mm = {lash}\n")
    data = card(design, 1.0)
    inlet, pair = data["valves"][0], data["pairs"][0]
    assert inlet["valve_lift_mm"] == pytest.approx(9.0 - lash, abs=1e-12)
    assert inlet["lobe_lift_mm"] == pytest.approx(9.0, abs=1e-12)
    ((opens, closes, _),) = events_of(inlet, "valve")
    assert lift(design, 0, opens) == pytest.approx(1.0, abs=1e-9)
    assert lift(design, 0, closes) == pytest.approx(1.0, abs=1e-9)
    assert inlet["lift_at_tdc_mm"] == pytest.approx(lift(design, 0, 0.0), abs=1e-12)
    area = quad(
        lambda crank: min(lift(design, 0, crank), lift(design, 1, crank)),
        -80.0, 80.0, points=(-70.0, -50.0, -20.0, 0.0, 20.0, 50.0, 70.0), epsabs=1e-8, limit=400,
    )[0]  # fmt: skip
    assert pair["overlap_area_mm_deg"] == pytest.approx(area, abs=1e-6)
    if lash == 0.15:  # on the ramp: 0.01 mm per cam degree at 6000 degrees a second
        assert inlet["opening_velocity_mm_s"] == pytest.approx(60.0, rel=1e-9)
        assert inlet["seating_velocity_mm_s"] == pytest.approx(60.0, rel=1e-9)
    if lash == 0.6:
        assert inlet["seating_velocity_mm_s"] > 300.0, "beyond the ramp"


# -- phases ---------------------------------------------------------------------------------------------------


def test_the_centre_is_the_phase_of_its_drive() -> None:
    """(centre + cylinder)/2 less the nose: in the events of the timing, and in the torque of the shaft."""
    design = machine(valve="cylinder_deg = 180.0\n")
    assert [drive.phase for drive in design.drives] == [(54.0 + 90.0 - 180.0) % 360.0, (-54.0 + 90.0 - 180.0) % 360.0]
    plain = (
        text().replace("[drives.valve]\ncentre_deg = 108.0\n", "").replace("[drives.valve]\ncentre_deg = -108.0\n", "")
    )
    plain = plain.replace('name = "Inlet"\n', 'name = "Inlet"\nphase_deg = -126.0\n')
    plain = plain.replace('name = "Exhaust"\n', 'name = "Exhaust"\nphase_deg = 126.0\n')
    typed, by_centre = loads(plain), machine()
    assert events(typed) == pytest.approx(events(by_centre))
    torque = [Study(each).camshaft.peak_torque.value for each in (typed, by_centre)]
    assert torque[1] == pytest.approx(torque[0], rel=1e-12)
    values = np.array([100.0, 108.0, 120.0])
    varied = many(by_centre, {"drives[0].valve.centre_deg": values}, ["torque_nm:max"]).value["torque_nm:max"]
    shifted = many(typed, {"drives[0].phase_deg": values / 2.0 - 180.0}, ["torque_nm:max"]).value["torque_nm:max"]
    assert varied == pytest.approx(shifted, rel=1e-9)


def test_a_cylinder_recurs_after_a_cycle_of_the_crank() -> None:
    """540° and -180° are the same cylinder, 180° is another one."""
    for inlet, exhaust, is_pair in ((540.0, -180.0, True), (720.0, 0.0, True), (180.0, 540.0, False)):
        design = put(machine(), "drives[0].valve.cylinder_deg", inlet)
        pairs = card(put(design, "drives[1].valve.cylinder_deg", exhaust))["pairs"]
        assert [pair["separation_deg"] for pair in pairs] == [108.0] * is_pair


def test_segments_have_their_nose_where_they_are_highest() -> None:
    """A dwell at the top: its middle; a polynomial that turns inside: where it turns."""
    rows = '[[drives.motion.segments]]\nlaw = "{}"\nspan_deg = {}\nrise_mm = {}\n'
    dwell = "".join(
        rows.format(*row) for row in (("3-4-5", 60, 8), ("dwell", 40, 0), ("3-4-5", 80, -8), ("dwell", 180, 0))
    )
    points = ", ".join(
        f"{{ at_deg = {at}, value = {value} }}" for at, value in ((0.0, 0.0), (130.0, 7.0), (250.0, 1.0))
    )
    spline = rows.format("spline", 360, 0) + f"points = [{points}]\n"
    for segments in (dwell, spline):
        design = loads(text().replace(f"[drives.motion.lobe]\n{LOBE}", segments))
        drive = design.drives[0]
        nose = (54.0 - drive.phase) % 360.0
        compiled = program(drive.motion)
        theta = np.deg2rad(np.linspace(0.0, 360.0, 720001))
        y = compiled.state(compiled.angles(theta)).y[0]
        top = np.rad2deg(theta[y >= y.max() - 1e-15])
        assert nose == pytest.approx(0.5 * (top[0] + top[-1]), abs=1e-2)
        assert 1e3 * y.max() == pytest.approx(lift(design, 0, 108.0), abs=1e-9)


def test_a_phase_is_written_as_a_centre(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """``find phases`` and a drag of the timing write the centre; the phase itself is no field of such a drive."""
    design = machine()
    turned = with_phase(design, 0, 230.0)
    assert turned.drives[0].valve.centre_deg == pytest.approx(100.0, abs=1e-9)
    assert turned.drives[0].phase == pytest.approx(230.0, abs=1e-9)
    assert "drives[0].phase_deg" not in list(all_paths(design))
    assert "drives[0].valve.centre_deg" in list(all_paths(design))
    path = tmp_path / "head.toml"
    path.write_text(text(), encoding="utf-8")
    assert main(["find", str(path), "phases", "--limit", "drives[1].valve.centre_deg_min=-120",
                 "--limit", "drives[1].valve.centre_deg_max=-100", "--json"]) == 0  # fmt: skip
    answer = json.loads(capsys.readouterr().out)["answer"]
    assert list(answer) == ["drives[1].valve.centre_deg"]
    assert -120.0 - 1e-6 <= answer["drives[1].valve.centre_deg"] <= -100.0 + 1e-6


# -- files ----------------------------------------------------------------------------------------------------


def test_engine_and_valve_are_read_and_written() -> None:
    design = machine(
        valve='cylinder_deg = 540.0\nlash_mm = 0.1\nangle_deg = 15.0\nclearance_mm = 6.0\npocket = "parallel"\n'
    )
    assert loads(dumps(design)) == design
    assert "phase_deg" not in dumps(design)
    assert design.drives[1].valve.pocket == "parallel"
    assert get(design, "engine.rod_mm") == 138.0
    assert get(edited(design, "engine.rod_mm", 140.0), "engine.rod_mm") == 140.0
    assert get(edited(design, "drives[1].valve.lash_mm", 0.2), "drives[1].valve.lash_mm") == 0.2
    alone = only(design, 0)
    assert loads(dumps(alone)) == alone
    single = text().partition("[[drives]]")[0] + DRIVE.format(name="x", centre=108.0, lobe=LOBE, valve="").replace(
        '[[drives]]\nname = "x"\n', ""
    ).replace("[drives.", "[")
    (ours,), (theirs,) = (events_of(card(each)["valves"][0]) for each in (loads(single), machine()))
    assert ours == pytest.approx(theirs)


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        (lambda t: t.replace(ENGINE, ""), "drives[0].valve", "engine"),
        (lambda t: t.replace("rod_mm = 138.0", "rod_mm = 42.0"), "engine.rod_mm", "> 42 mm"),
        (lambda t: t.replace("rod_mm = 138.0", "rod_mm = 50.0\npin_offset_mm = -9.0"), "engine.rod_mm", "> 51 mm"),
        (lambda t: t.replace("stroke_mm = 84.0\n", ""), "engine.stroke_mm", "missing"),
        (lambda t: t.replace('name = "Inlet"', 'name = "Inlet"\nphase_deg = 0.0'), "drives[0].phase_deg", "centre_deg"),
        (
            lambda t: t.replace("centre_deg = 108.0", "centre_deg = 108.0\nlash_mm = 9.5"),
            "drives[0].valve.lash_mm",
            "<= 9",
        ),
        (lambda t: t.replace("centre_deg = 108.0", "centre_deg = 108.0\nlink = 6"), "drives[0].valve.link", "linkage"),
        (lambda t: t.replace("centre_deg = 108.0\n", ""), "drives[0].valve.centre_deg", "missing"),
        (
            lambda t: t.replace("centre_deg = 108.0", 'centre_deg = 108.0\npocket = "round"'),
            "drives[0].valve.pocket",
            "flat",
        ),
    ],
)
def test_bad_values_are_one_line_with_the_field(
    change: Callable[[str], str], field: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(change(text()), encoding="utf-8")
    assert main(["valve", str(path)]) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if "[1]" not in line]
    assert len(lines) == 1, lines
    assert field in lines[0]
    assert words in lines[0]


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ("[1.27, 210.0]]", "[9.5, 210.0]]", "motion.lobe.duration[1]"),
        (", [1.27, 210.0]]", "]", "motion.lobe"),
        ("lift_mm = 9.0", "lift_mm = -9.0", "motion.lobe.lift_mm"),
        ("ramp_mm = 0.2", "ramp_mm = 0.03", "motion.lobe.ramp_runup_deg"),
    ],
)
def test_a_lobe_with_a_fault_has_a_lift_above_the_lash(
    old: str, new: str, field: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A lobe that cannot be solved is one fault, and no second one about the lash."""
    path = tmp_path / "bad.toml"
    path.write_text(text(valve="lash_mm = 0.1\n").replace(old, new, 1), encoding="utf-8")
    assert main(["check", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"drives[0].{field}")


def test_a_valve_of_a_linkage_is_one_of_its_sliders() -> None:
    def example(name: str) -> str:
        return (Path(__file__).parents[3] / "resources" / "examples" / f"{name}.toml").read_text("utf-8") + ENGINE

    with pytest.raises(DesignError, match="no motion that opens it"):
        loads(example("slider_crank") + "[valve]\ncentre_deg = 108.0\n")
    linkage = example("cam_slider_linkage") + "[valve]\ncentre_deg = 108.0\n"
    for link in ("", "link = 3\n"):
        with pytest.raises(DesignError, match=r"valve\.link.*no slider of this linkage; allowed: 2"):
            loads(linkage + link)
    design = loads(linkage + "link = 2\nlash_mm = 0.5\n")
    assert design.drive.valve == Valve(centre_deg=108.0, link=2, lash_mm=0.5)
    (valve,) = card(design, 10.0)["valves"]
    assert (valve["lobe_lift_mm"], valve["valve_lift_mm"]) == pytest.approx((150.0, 149.5)), "the driver is the valve"


# -- the command ----------------------------------------------------------------------------------------------


def test_the_command_prints_what_it_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "head.toml"
    path.write_text(text(valve="lash_mm = 0.1\n"), encoding="utf-8")
    assert main(["valve", str(path), "--json", "--at", "0.15,0.050in,1mm,20thou"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [e["at_mm"] for e in data["valves"][0]["events"]] == [0.15, 0.15, 1.27, 1.27, 1.0, 1.0, 0.508, 0.508]
    assert [v["drive"] for v in data["valves"]] == ["Inlet", "Exhaust"]
    assert [(p["intake"], p["exhaust"]) for p in data["pairs"]] == [("Inlet", "Exhaust")]
    assert main(["valve", str(path), "--drive", "exhaust"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("Exhaust: centre")
    assert "  lobe at 1.27 mm: opens 33.00 BBDC, closes 3.00 BTDC, 210.00 deg" in lines
    for bad in (
        ["--at", "0"],
        ["--at", "3furlong"],
        ["--drive", "third"],
        ["--step", "7", "--drive", "inlet", "--table", "t.csv"],
    ):
        assert main(["valve", str(path), *bad]) == 2
        assert len(capsys.readouterr().err.strip().splitlines()) == 1
    drive = DRIVE.format(name="x", centre=1.0, lobe=LOBE, valve="").replace("[drives.valve]\ncentre_deg = 1.0\n", "")
    path.write_text(text().partition("[engine]")[0] + drive, encoding="utf-8")
    assert main(["valve", str(path)]) == 2
    assert "[valve]" in capsys.readouterr().err


@pytest.mark.parametrize(("unit", "size", "step"), [("mm", 1.0, 1.0), ("in", 25.4, 0.5)])
def test_the_table_for_the_grinder(unit: str, size: float, step: float, tmp_path: Path) -> None:
    path, table = tmp_path / "head.toml", tmp_path / "lift.csv"
    path.write_text(text(), encoding="utf-8")
    words = ["--drive", "Inlet", "--unit", unit, "--step", str(step), "--table", str(table)]
    assert main(["valve", str(path), *words]) == 0
    with table.open(encoding="utf-8", newline="") as file:
        names, *rows = csv.reader(file)
    assert names == ["cam_deg_from_nose", f"lift_{unit}"]
    values = np.array(rows, dtype=float)
    assert values[:, 0] == pytest.approx(np.arange(-180.0, 180.0 + step / 2.0, step), abs=1e-12)
    design = loads(text())
    assert values[:, 1] * size == pytest.approx([lift(design, 0, 108.0 + 2.0 * a) for a in values[:, 0]], abs=1e-12)
    assert values[len(values) // 2, 1] * size == pytest.approx(9.0, abs=1e-12)
