"""Methods with the options of commands give what the commands give; what is wrong is named, and nothing is written."""

import csv
import io
import json
import math
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kindyna as kd
from core.__main__ import main

ROCKER, LIFT, UNIT, BAR = (kd.example(slug) for slug in ("rocker_cam", "transfer_lift", "transfer_unit", "four_bar"))
STUDY = ROCKER.study(36)
BASE, LAW = "cam.base_radius_mm", "motion.segments[1].law"
PRESSURE, TORQUE = "pressure_angle_deg:max", "drive_torque_nm:abs"


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A user's folder with two tables, one of them with two wrong cells."""
    monkeypatch.chdir(tmp_path)
    rows = [f"{angle},{10.0 - 10.0 * math.cos(math.radians(angle)):.4f}" for angle in range(0, 360, 2)]
    Path("lift.csv").write_text("\n".join(["angle_deg,lift_mm", *rows]), "utf-8")
    Path("wrong.csv").write_text("\n".join(["angle_deg,lift_mm", *rows[:9], "18,x", "20,y", *rows[11:]]), "utf-8")


def command(*words: str, codes: tuple[int, ...] = (0, 1)) -> None:
    assert main(list(words)) in codes


# -- fields ---------------------------------------------------------------------------------------------------


def leaves(table: Any, path: str = "") -> Iterator[str]:
    """Paths of the numbers, words and flags of a file."""
    if isinstance(table, dict):
        for key, value in table.items():
            yield from leaves(value, f"{path}.{key}" if path else key)
    elif isinstance(table, list) and all(isinstance(row, dict) for row in table):
        for i, row in enumerate(table):
            yield from leaves(row, f"{path}[{i}]")
    elif not isinstance(table, list):
        yield path


@pytest.mark.parametrize("slug", kd.examples())
@pytest.mark.stress
def test_fields_are_all_values_of_the_file_and_can_be_edited(slug: str) -> None:
    design = kd.example(slug)
    fields = design.fields()
    kinds = ("follower.kind", "cam.kind")
    fixed = {path for path in leaves(tomllib.loads(design.toml)) if path == "format" or path.endswith(kinds)}
    assert set(leaves(tomllib.loads(design.toml))) - fields.keys() == fixed
    assert design.edit(fields) == design
    assert all(design[path] == value and design.edit({path: value}) == design for path, value in fields.items())


def test_events_of_a_sequence_and_points_of_loads_are_fields() -> None:
    event = "Lift.rise.1.start"
    assert UNIT.edit({"timing[0].first": event}).fields()["timing[0].first"] == event
    crank = kd.example("slider_crank")
    assert crank.edit({"loads.forces[0].point": "A", "loads.forces[0].link": 3})["loads.forces[0].point"] == "A"


def completions(thing: object) -> list[str]:
    """Keys that IPython offers in brackets."""
    return list(getattr(thing, "_ipython_key_completions_")())  # noqa: B009


def test_paths_and_channels_complete() -> None:
    assert {BASE, LAW, "shaft.motor_inertia_kg_m2"} <= set(completions(ROCKER))
    assert completions(STUDY) == list(STUDY.channels)
    assert completions(UNIT.study(36)) == list(UNIT.study(36).channels)


# -- the commands ---------------------------------------------------------------------------------------------


def test_all_combinations_are_the_table_of_the_command() -> None:
    result = ROCKER.vary({BASE: (40, 60, 3), LAW: ["cycloidal", "modified-sine"]}, [PRESSURE, "energy_j"])
    ROCKER.save("rocker.toml")
    Path("study.toml").write_text(
        f"""
design = "rocker.toml"
vary = [{{ field = "{BASE}", low = 40.0, high = 60.0, steps = 3 }}, {{ field = "{LAW}", choices = ["cycloidal", "modified-sine"] }}]
quantities = [{{ quantity = "pressure_angle_deg", of = "max" }}, {{ quantity = "energy_j" }}]
""",
        "utf-8",
    )
    command("vary", "study.toml", "--out", "table.csv")
    rows = list(csv.DictReader(io.StringIO(Path("table.csv").read_text("utf-8"))))
    assert result.inputs[BASE].tolist() == [float(row[BASE]) for row in rows] == [40.0, 40.0, 50.0, 50.0, 60.0, 60.0]
    assert result.inputs[LAW].tolist() == [row[LAW] for row in rows]
    assert result.value[PRESSURE].tolist() == [float(row["pressure_angle_deg_max"]) for row in rows]
    assert result.value["energy_j"].tolist() == [float(row["energy_j"]) for row in rows]
    assert result.reason.tolist() == [""] * len(result)
    for i, (radius, law) in enumerate(zip(result.inputs[BASE], result.inputs[LAW], strict=True)):
        extreme = ROCKER.edit({BASE: radius, LAW: str(law)}).study().extreme("pressure_angle_deg")
        assert result.value[PRESSURE][i] == pytest.approx(extreme.value, rel=1e-9)
        assert result.angle_deg[PRESSURE][i] == pytest.approx(extreme.angle_deg, abs=1e-3)
    with pytest.raises(ValueError, match="read-only"):
        result.inputs[LAW][0] = "dwell"


def test_listed_values_and_processes_give_the_same_figures() -> None:
    one = ROCKER.vary({BASE: np.linspace(44.0, 50.0, 4), "follower.arm_mm": [88.0, 90.0]}, [PRESSURE])
    two = ROCKER.vary({BASE: (44, 50, 4), "follower.arm_mm": [88, 90]}, [PRESSURE], workers=2)
    for path in one.inputs:
        np.testing.assert_array_equal(one.inputs[path], two.inputs[path])
    np.testing.assert_array_equal(one.value[PRESSURE], two.value[PRESSURE])


def test_a_design_without_a_solution_has_its_reason() -> None:
    result = ROCKER.vary({"follower.arm_mm": [20.0, 90.0]}, [PRESSURE])
    assert (bool(result.reason[0]), result.reason[1]) == (True, "")
    assert np.isnan(result.value[PRESSURE]).tolist() == [True, False]


@pytest.mark.parametrize("step", [None, 0.5])
@pytest.mark.stress
def test_the_best_design_is_that_of_the_command(step: float | None, capsys: pytest.CaptureFixture[str]) -> None:
    options = {} if step is None else {"round": step}
    limits = {PRESSURE: {"max": 35}, "radius_mm:min": {"min": 41.0}}
    best = ROCKER.optimise({BASE: (40, 90), LAW: ["cycloidal", "modified-sine"]}, TORQUE, limits, **options)
    ROCKER.save("rocker.toml")
    Path("study.toml").write_text(
        f"""
design = "rocker.toml"
vary = [{{ field = "{BASE}", low = 40.0, high = 90.0 }}, {{ field = "{LAW}", choices = ["cycloidal", "modified-sine"] }}]
limits = [{{ quantity = "pressure_angle_deg", of = "max", max = 35.0 }}, {{ quantity = "radius_mm", of = "min", min = 41.0 }}]
goals = [{{ quantity = "drive_torque_nm", of = "abs" }}]
""",
        "utf-8",
    )
    words = ["optimise", "study.toml", "--into", "best.toml", "--json"]
    command(*words, *([] if step is None else ["--round", str(step)]))
    row = json.loads(capsys.readouterr().out)
    assert dict(best.answer) == row["answer"]
    assert (best.goal, list(best.binding)) == (row["goal"], row["binding"])
    assert (best.starts, best.agreeing) == (row["starts"], row["agreeing"])
    assert best.design == kd.open("best.toml")
    assert best.answer[BASE] % 0.5 == 0.0 or step is None


def test_the_fastest_lift_is_found_by_a_goal_and_by_the_search_of_the_command() -> None:
    speed, force = "shaft.speed_rpm", {"contact_force_n:abs": {"max": 60e3}}
    best = LIFT.optimise({speed: (20, 60)}, limits=force, maximise=speed)
    assert best.goal == best.answer[speed] == best.design[speed]
    fastest = LIFT.find("top-speed", {"contact_force_n": 60e3}, vary=[f"{speed}=20:60"])
    assert fastest.answer[speed] == pytest.approx(best.goal, rel=1e-8)
    assert fastest.design[speed] == fastest.answer[speed] == fastest.curve[-1, 1]
    assert fastest.binding[0]["limit"] == "contact_force_n_abs"
    assert repr(fastest).startswith(f"<kindyna.FindResult {speed} = ")
    assert LIFT.optimise({speed: (10, 60)}, speed, force).answer == {speed: 10.0}
    with pytest.raises(ValueError, match="give one of the two"):
        LIFT.optimise({speed: (20, 60)})


def test_rounded_dimensions_are_those_of_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    LIFT.save("lift.toml")
    for value, words in ((True, ["--round"]), (5, ["--round", "5"])):
        result = LIFT.find("base-radius", {"pressure_angle_return_deg": 20}, round=value)
        command("find", "lift.toml", "base-radius", "--limit", "pressure_angle_return_deg=20", "--json", *words)
        assert dict(result.answer) == json.loads(capsys.readouterr().out)["answer"]
    assert result.answer[BASE] % 5.0 == 0.0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"as_": "motion"}, []),
        ({"error": 0.05}, ["--error", "0.05"]),
        ({"error": {"s": 0.05}, "leave_out": [3, 5]}, ["--error", "s=0.05", "--leave-out", "3,5"]),
        ({"leave_out": "3-9", "no_laws": True}, ["--leave-out", "3-9", "--no-laws"]),
        (
            {"column": "lift_mm", "speed": 300, "lowest": 1.5},
            ["--column", "lift_mm", "--speed", "300", "--lowest", "1.5"],
        ),
        ({"columns": {"s": "lift_mm"}, "lift": [1, 2.5]}, ["--columns", "s=lift_mm", "--lift", "1", "--lift", "2.5"]),
    ],
)
@pytest.mark.stress
def test_a_measured_motion_is_that_of_the_command(options: dict[str, Any], words: list[str]) -> None:
    command("measured", "lift.csv", "--into", "new.toml", "--as", "motion", *words)
    design = kd.measured("lift.csv", **options)
    assert design == kd.open("new.toml")
    assert (design.kind, design.name) == ("motion", "lift")


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("cam.dxf", {"tolerance": 0.01, "as_": "arcs"}, ["--tolerance", "0.01", "--as", "arcs"]),
        ("cam.svg", {}, []),
        ("cam.csv", {"samples": 90, "cutter": 8}, ["--samples", "90", "--cutter", "8"]),
        (
            "cam.nc",
            {"spacing": 2, "cutter": 5, "conventional": True, "feed": 100.0},
            ["--spacing", "2", "--cutter", "5", "--conventional", "--feed", "100"],
        ),
    ],
)
@pytest.mark.stress
def test_a_profile_is_that_of_the_command(name: str, options: dict[str, Any], words: list[str]) -> None:
    ROCKER.save("rocker.toml")
    Path("command").mkdir()
    command("profile", "rocker.toml", "--out", f"command/{name}", *words)
    paths = STUDY.export(name, **options)
    assert [path.as_posix() for path in paths] == [name, f"{name}.json"]
    assert all(path.read_bytes() == Path("command", path).read_bytes() for path in paths)


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [("cam.step", {"solid": True}, ["--solid"]), ("cam.stl", {"tolerance": 0.1}, ["--tolerance", "0.1"])],
)
def test_surfaces_are_those_of_the_command(name: str, options: dict[str, Any], words: list[str]) -> None:
    UNIT.save("unit.toml")
    command("surface", "unit.toml", "--drive", "Clamp", "--out", f"command_{name}", *words)
    assert UNIT.study(36).export(name, drive="Clamp", **options) == [Path(name)]
    assert Path(name).read_bytes() == Path(f"command_{name}").read_bytes()


def test_a_drive_of_a_shaft_is_chosen_as_by_the_command() -> None:
    UNIT.save("unit.toml")
    command("profile", "unit.toml", "--out", "command.csv", "--drive", "Lift", "--samples", "36")
    command("ecam", "unit.toml", "--out", "command.txt", "--drive", "Lift", "--controller", "sew-tab")
    study = UNIT.study(36)
    study.export("library.csv", drive="Lift", samples=36)
    study.ecam("sew-tab", "library.txt", drive="Lift")
    UNIT.study(drive="Lift").export("drive.csv", samples=36)
    for name in ("library.csv", "drive.csv"):
        assert Path(name).read_bytes() == Path("command.csv").read_bytes()
    assert Path("library.txt").read_bytes() == Path("command.txt").read_bytes()


def test_stages_and_a_report_are_those_of_the_command() -> None:
    ROCKER.save("rocker.toml")
    command("export", "rocker.toml", "--out", "command", "--samples", "36", "--only", "motion", "cam")
    paths = STUDY.export("library", only=["motion", "cam"])
    assert {path.name: path.read_bytes() for path in paths} == {
        path.name: path.read_bytes() for path in Path("command").iterdir()
    }
    words = ["--without", "profile", "equations", "--author", "A. <B>", "--paper", "Letter", "--samples", "36"]
    command("report", "rocker.toml", "--out", "command.html", *words)
    STUDY.export("library.html", without=["profile", "equations"], author="A. <B>", paper="Letter")
    assert Path("library.html").read_bytes() == Path("command.html").read_bytes()


def test_a_report_is_printed_without_an_application_in_this_process() -> None:
    pytest.importorskip("PySide6")
    assert STUDY.export("report.pdf", author="A. B.", without=("equations", "profile")) == [Path("report.pdf")]
    assert Path("report.pdf").read_bytes().startswith(b"%PDF")


def test_a_table_for_a_controller_is_that_of_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    ROCKER.save("rocker.toml")
    words = ["--points", "60", "--master", "counts", "--master-per-turn", "4096", "--cycle", "2", "--reverse"]
    more = ["--out", "command.txt", "--controller", "codesys-xyva", "--curve", "command.csv", "--json"]
    command("ecam", "rocker.toml", *more, *words)
    options = {"points": 60, "master": "counts", "master_per_turn": 4096, "cycle": 2, "reverse": True}
    facts = STUDY.ecam("codesys-xyva", out="library.txt", curve="library.csv", **options)
    assert facts == json.loads(capsys.readouterr().out)
    for ending in ("txt", "csv"):
        assert Path(f"library.{ending}").read_bytes() == Path(f"command.{ending}").read_bytes()
    before = sorted(Path().iterdir())
    assert STUDY.ecam("codesys-xyva", **options) == facts
    assert sorted(Path().iterdir()) == before


SERVO = """
format = 1
name = "Turntable"
[motion]
start_deg = 0.0
segments = [{ law = "modified-sine", span_deg = 120.0, rise_deg = 90.0 }, { law = "dwell", span_deg = 60.0 },
            { law = "cycloidal", span_deg = 180.0, rise_deg = -90.0 }]
[servo]
kind = "rotary"
gear_ratio = 10.0
rotor_inertia_kg_m2 = 2e-4
inertia_kg_m2 = 0.05
"""


@pytest.mark.parametrize("of", ["max", *(pytest.param(of, marks=pytest.mark.stress) for of in ("abs", "rms"))])
@pytest.mark.stress
def test_the_torque_of_a_servo_has_the_name_of_its_channel_in_all_figures(of: str) -> None:
    design, ratio = kd.design(SERVO), "servo.gear_ratio"
    figure, quantity = f"motor_torque_nm:{of}", f"servo_torque_nm:{of}"
    many = design.many({ratio: [10.0, 20.0]}, [figure, quantity])
    torque = design.study(20_000)["motor_torque_nm"]
    expected = {"max": torque.max(), "abs": np.abs(torque).max(), "rms": np.sqrt(np.mean(torque**2))}[of]
    assert many.value[figure][0] == pytest.approx(expected, rel=1e-6)
    np.testing.assert_array_equal(many.value[figure], many.value[quantity])
    np.testing.assert_array_equal(design.vary({ratio: [10.0, 20.0]}, [figure]).value[figure], many.value[figure])
    limits = {"motor_speed_rpm:abs": {"max": 2000.0}}
    best = design.optimise({ratio: (5.0, 60.0)}, figure, limits)
    assert best.answer == design.optimise({ratio: (5.0, 60.0)}, quantity, limits).answer
    assert float(best.design.study().extreme("motor_speed_rpm", "abs")) <= 2000.0 * (1.0 + 1e-9)


LOADED = SERVO.partition("[servo]")[0] + "[loads]\ninertia_kg_m2 = 0.1\ntorque_nm = 3.0\n"


@pytest.mark.parametrize(
    ("text", "path", "numbers", "name"),
    [
        (SERVO, "motion.segments[0].rise_deg", [80.0, 90.0], "motor_torque_nm"),
        (SERVO, "motion.segments[0].rise_deg", [80.0, 90.0], "motor_speed_rpm"),
        (LOADED, "loads.inertia_kg_m2", [0.1, 0.2], "torque_nm"),
        (LOADED, "loads.inertia_kg_m2", [0.1, 0.2], "power_w"),
    ],
)
def test_motions_without_a_mechanism_are_evaluated_together(
    text: str, path: str, numbers: list[float], name: str
) -> None:
    design = kd.design(text)
    many = design.many({path: numbers}, [f"{name}:max"])
    for number, value in zip(numbers, many.value[f"{name}:max"], strict=True):
        assert value == pytest.approx(float(design.edit({path: number}).study().extreme(name)), rel=1e-9)


def test_a_figure_of_a_shaft_with_its_own_motor_is_that_of_the_shaft() -> None:
    design = kd.design(ROCKER.toml + '\n[servo]\nkind = "rotary"\ngear_ratio = 20.0\n')
    many = design.many({BASE: [45.0]}, ["motor_torque_nm:max", "servo_torque_nm:max"])
    for name in ("motor_torque_nm", "servo_torque_nm"):
        assert many.value[f"{name}:max"][0] == pytest.approx(design.study().extreme(name).value, rel=1e-9)
    assert many.value["motor_torque_nm:max"][0] != many.value["servo_torque_nm:max"][0]


# -- what is wrong --------------------------------------------------------------------------------------------

NAMES = [
    (lambda: STUDY.export("a.dxf", tolerence=0.1), "tolerence", "tolerance"),
    (lambda: STUDY.export("a.dxf", as_="arc"), "arc", "arcs"),
    (lambda: STUDY.export("a.html", without=["input"]), "input", "inputs"),
    (lambda: STUDY.export("a.dfx"), ".dfx", ".dxf"),
    (lambda: STUDY.export("out", only=["cams"]), "cams", "cam"),
    (lambda: UNIT.study(36).export("a.dxf", drive="Lft"), "Lft", "Lift"),
    (lambda: STUDY.ecam("sew-tb", "a.txt"), "sew-tb", "sew-tab"),
    (lambda: STUDY.ecam("sew-tab", "a.txt", pionts=20), "pionts", "points"),
    (lambda: STUDY.ecam("sew-tab", "a.txt", of="displacment_deg"), "displacment_deg", "displacement_deg"),
    (lambda: STUDY.explain("pressure_angle"), "pressure_angle", "did you mean 'pressure_angle_deg'"),
    (lambda: UNIT.study(36).explain("torque"), "torque", "did you mean 'torque_nm'"),
    (lambda: kd.measured("lift.csv", colum="a"), "colum", "column"),
    (lambda: kd.measured("lift.csv", column="lft"), "lft", "lift_mm"),
    (lambda: ROCKER.vary({"cam.base_radus_mm": [40]}, [PRESSURE]), "cam.base_radus_mm", BASE),
    (lambda: ROCKER.vary({BASE: [40]}, ["pressure_angel_deg:max"]), "pressure_angel_deg", "pressure_angle_deg"),
    (lambda: ROCKER.vary({LAW: ["cyclodal"]}, [PRESSURE]), "cyclodal", "cycloidal"),
    (lambda: ROCKER.many({BASE: [44]}, ["pressure_angel_deg:max"]), "pressure_angel_deg", "pressure_angle_deg"),
    (lambda: ROCKER.optimise({"cam.base_radus_mm": (40, 90)}, TORQUE), "cam.base_radus_mm", BASE),
    (lambda: ROCKER.optimise({BASE: (40, 90)}, "drive_torqe_nm:abs"), "drive_torqe_nm", "drive_torque_nm"),
    (lambda: ROCKER.optimise({BASE: (40, 90)}, TORQUE, {PRESSURE: {"maxi": 3}}), "maxi", "max"),
    (lambda: ROCKER.optimise({BASE: (40, 90)}, TORQUE, rond=1), "rond", "round"),
    (lambda: ROCKER.find("base-radius", {"pressure_angle_ris_deg": 25}), "pressure_angle_ris_deg", "pressure_angle_rise_deg"),
    (lambda: ROCKER.find("base-radius", for_="rm"), "rm", "rms"),
    (lambda: ROCKER.edit({LAW: "cyclodal"}), "cyclodal", "cycloidal"),
    (lambda: ROCKER.edit({"cam.form": "opn"}), "opn", "open"),
]  # fmt: skip


@pytest.mark.parametrize(("wrong", "named", "nearest"), NAMES)
def test_an_unknown_name_is_named_with_the_nearest(wrong: Callable[[], object], named: str, nearest: str) -> None:
    before = sorted(Path().iterdir())
    with pytest.raises((KeyError, ValueError, kd.KindynaError)) as caught:
        wrong()
    assert named in str(caught.value)
    assert nearest in str(caught.value)
    assert sorted(Path().iterdir()) == before


@pytest.mark.parametrize(
    ("design", "name", "having"),
    [
        (BAR, "pressure_angle_deg", "a cam"),
        (LIFT, "outer_x_mm", "a groove"),
        (ROCKER, "velocity_mm_s", "in mm"),
        (LIFT, "link3_deg", "linkage"),
        (kd.example("rocker_flat"), "pitch_x_mm", "a roller"),
        (ROCKER, "servo_torque_nm", "servo"),
        (UNIT, "x_mm", "Lift"),
    ],
)
def test_a_channel_that_a_design_lacks_names_the_designs_that_have_it(
    design: kd.Design, name: str, having: str
) -> None:
    with pytest.raises(KeyError, match=f"{name}: .*{having}"):
        design.study(36)[name]


VALUES = [
    (lambda: STUDY.export("a.dxf", tolerance="0.1"), "tolerance"),
    (lambda: STUDY.export("a.dxf", tolerance=math.nan), "tolerance"),
    (lambda: STUDY.export("a.dxf", tolerance=-1), "tolerance"),
    (lambda: STUDY.export("a.dxf", samples=0), "samples"),
    (lambda: STUDY.export("a.dxf", samples=1e9), "samples"),
    (lambda: STUDY.export("a.dxf", samples=2.5), "samples"),
    (lambda: STUDY.export("a.dxf", samples=[[1]]), "samples"),
    (lambda: STUDY.export("a.dxf", samples=10, spacing=1), "spacing"),
    (lambda: STUDY.export("a.dxf", flank="outer"), "outer"),
    (lambda: STUDY.export("a.dxf", drive="Lift"), "Lift"),
    (lambda: STUDY.export("a.nc", as_="spline"), "spline"),
    (lambda: STUDY.export("a.html", paper="A5"), "A5"),
    (lambda: STUDY.export("a.html", logo="no.png"), "no.png"),
    (lambda: STUDY.export(""), "target"),
    (lambda: STUDY.export(3), "target"),  # type: ignore[arg-type]
    (lambda: BAR.study(36).export("a.dxf"), "cam"),
    (lambda: UNIT.study(36).export("a.dxf"), "Lift"),
    (lambda: STUDY.ecam("sew-tab", "a.txt", points=2), "points"),
    (lambda: STUDY.ecam("sew-tab", "a.txt", points=1.5), "points"),
    (lambda: STUDY.ecam("sew-tab", "a.txt", error=0.1, points=20), "points"),
    (lambda: STUDY.ecam("sew-tab", "a.txt", cycle=math.inf), "cycle"),
    (lambda: STUDY.ecam("sew-tab", "a.txt", curve="a.xls"), "curve"),
    (lambda: STUDY.ecam("sew-tab", "a.txt", reverse=1), "reverse"),
    (lambda: STUDY.ecam(3, "a.txt"), "controller"),  # type: ignore[arg-type]
    (lambda: STUDY.ecam("sew-tab", 3), "out"),  # type: ignore[arg-type]
    (lambda: BAR.study(36).ecam("sew-tab", "a.txt"), "motion"),
    (lambda: kd.measured("nowhere.csv"), "nowhere.csv"),
    (lambda: kd.measured(3), "table"),  # type: ignore[arg-type]
    (lambda: kd.measured("lift.csv", error="x"), "error"),
    (lambda: kd.measured("lift.csv", error=math.nan), "error"),
    (lambda: kd.measured("lift.csv", error={"s": 0.1, "q": 1}), "q=1"),
    (lambda: kd.measured("lift.csv", leave_out=[1, "a"]), "leave_out"),
    (lambda: kd.measured("lift.csv", lift=[[1.0]]), "lift"),
    (lambda: kd.measured("lift.csv", half="yes"), "half"),
    (lambda: kd.measured("lift.csv", as_="segment"), "segment"),
    (lambda: kd.measured("lift.csv", speed="300"), "speed"),
    (lambda: kd.measured("lift.csv", speed=0), "speed"),
    (lambda: ROCKER.vary({BASE: (40, 50)}, [PRESSURE]), BASE),
    (lambda: ROCKER.vary({BASE: (40, 50, 1)}, [PRESSURE]), BASE),
    (lambda: ROCKER.vary({BASE: (40, 50, 10**9)}, [PRESSURE]), "1000000000"),
    (lambda: ROCKER.vary({BASE: (60, 50, 3)}, [PRESSURE]), BASE),
    (lambda: ROCKER.vary({BASE: [[40]]}, [PRESSURE]), BASE),
    (lambda: ROCKER.vary({BASE: ["a"]}, [PRESSURE]), BASE),
    (lambda: ROCKER.vary({BASE: []}, [PRESSURE]), BASE),
    (lambda: ROCKER.vary({BASE: [40, math.nan]}, [PRESSURE]), BASE),
    (lambda: ROCKER.vary({BASE: 40}, [PRESSURE]), BASE),
    (lambda: ROCKER.vary({"name": ["a", "b"]}, [PRESSURE]), "name"),
    (lambda: ROCKER.vary({}, [PRESSURE]), "vary"),
    (lambda: ROCKER.vary({BASE: [40]}, PRESSURE), "quantities"),
    (lambda: ROCKER.vary({BASE: [40]}, []), "quantities"),
    (lambda: ROCKER.vary({BASE: [40]}, [PRESSURE], workers=0), "workers"),
    (lambda: ROCKER.optimise({BASE: (90, 40)}, TORQUE), BASE),
    (lambda: ROCKER.optimise({BASE: (40, 90, 3)}, TORQUE), BASE),
    (lambda: ROCKER.optimise({BASE: (40, "x")}, TORQUE), BASE),  # type: ignore[dict-item]
    (lambda: ROCKER.optimise({BASE: (40, 90)}, "drive_torque_nm"), "drive_torque_nm"),
    (lambda: ROCKER.optimise({BASE: (40, 90)}, 3), "minimise"),  # type: ignore[arg-type]
    (lambda: ROCKER.optimise({BASE: (40, 90)}, TORQUE, {PRESSURE: 35}), PRESSURE),  # type: ignore[dict-item]
    (lambda: ROCKER.optimise({BASE: (40, 90)}, TORQUE, {PRESSURE: {"max": math.nan}}), PRESSURE),
    (lambda: ROCKER.optimise({BASE: (40, 90)}, TORQUE, 3), "limits"),  # type: ignore[arg-type]
    (lambda: ROCKER.optimise(3, TORQUE), "vary"),  # type: ignore[arg-type]
    (lambda: ROCKER.find("base-radius", 3), "limits"),  # type: ignore[arg-type]
    (lambda: ROCKER.find("base-radius", round=-1), "round"),
    (lambda: ROCKER.save(""), "path"),
    (lambda: ROCKER.many({BASE: [44]}, 5), "quantities"),  # type: ignore[arg-type]
    (lambda: ROCKER.vary({BASE: [44]}, None), "quantities"),  # type: ignore[arg-type]
]  # fmt: skip


@pytest.mark.parametrize(("wrong", "named"), VALUES)
def test_a_wrong_value_is_named_in_one_line(wrong: Callable[[], object], named: str) -> None:
    before = sorted(Path().iterdir())
    with pytest.raises((KeyError, TypeError, ValueError, kd.KindynaError)) as caught:
        wrong()
    assert named in str(caught.value)
    assert "\n" not in str(caught.value)
    assert sorted(Path().iterdir()) == before


ARGUMENTS = [
    (lambda: STUDY.ecam("sew-tab", "a.txt", of="displacment_deg"), "of displacment_deg"),
    (lambda: STUDY.ecam("sew-tab", "a.txt", points=2), "points"),
    (lambda: STUDY.ecam("codesys-cambuilder", "a.txt", as_="placed", error=0.1, segment=99), "segment 99"),
    (lambda: ROCKER.study(drive="Lift"), "leave drive out"),
    (lambda: UNIT.find("base-radius"), "choose one with drive: Feed | Clamp | Lift | Torque"),
    (lambda: UNIT.study(36).export("a.dxf"), "choose one with drive: Feed | Clamp | Lift | Torque"),
    (lambda: STUDY.explain("pressure_angle_deg", at_deg=400), "at 400"),
]


@pytest.mark.parametrize(("wrong", "named"), ARGUMENTS)
def test_an_error_names_the_arguments_of_the_method(wrong: Callable[[], object], named: str) -> None:
    with pytest.raises(kd.KindynaError) as caught:
        wrong()
    assert named in str(caught.value)
    assert "--" not in str(caught.value)


def test_all_that_is_wrong_is_named_at_once() -> None:
    with pytest.raises(kd.KindynaError) as caught:
        ROCKER.vary({BASE: [-1.0, 40.0, -2.0], LAW: ["dwel"]}, ["pressure_angle_deg:mx", "x_nm:max"])
    assert [fault.path for fault in caught.value.faults] == [
        "pressure_angle_deg:mx, of",
        f"{BASE}, values[0]",
        f"{BASE}, values[2]",
        f"{LAW}, choices[0]",
        "x_nm:max",
    ]
    with pytest.raises(kd.KindynaError) as caught:
        LIFT.edit({"cam.form": "opn", BASE: -1.0, "shaft.rotation": "cccw"})
    assert {fault.path for fault in caught.value.faults} == {"cam.form", BASE, "shaft.rotation"}
    with pytest.raises(kd.KindynaError) as caught:
        kd.measured("wrong.csv")
    assert [fault.path for fault in caught.value.faults] == ["line 11", "line 12"]
    assert all(str(fault) in str(caught.value) for fault in caught.value.faults)


def test_where_no_design_satisfies_the_limits_the_best_is_named() -> None:
    with pytest.raises(kd.KindynaError, match=rf"{BASE} = 40, violates: pressure_angle_deg:max = \d+.*most 3$"):
        ROCKER.optimise({BASE: (40, 90)}, TORQUE, {PRESSURE: {"max": 3}})


@pytest.mark.parametrize(
    "result",
    [
        lambda: ROCKER.optimise({BASE: (40, 90)}, TORQUE),
        lambda: LIFT.find("base-radius"),
        lambda: ROCKER.vary(
            {BASE: [44], "follower.arm_mm": (88, 90, 2)},
            [PRESSURE, TORQUE, "acceleration_deg_s2:abs", "velocity_deg_s:abs"],
        ),
    ],
    ids=["Optimum", "Answer", "Table"],
)
def test_a_repr_is_short(result: Callable[[], object]) -> None:
    lines = repr(result()).split("\n")
    assert len(lines) <= 6
    assert max(map(len, lines)) <= 120


def test_a_table_of_designs_is_a_frame() -> None:
    pytest.importorskip("pandas")
    frame = ROCKER.vary({BASE: [44.0, 45.0], LAW: ["cycloidal", "modified-sine"]}, [PRESSURE]).to_frame()
    assert list(frame.columns) == [BASE, LAW, PRESSURE, "reason"]
    assert frame[BASE].tolist() == [44.0, 44.0, 45.0, 45.0]
    assert frame[LAW].tolist() == ["cycloidal", "modified-sine"] * 2


# -- synthesis ------------------------------------------------------------------------------------------------

TASK = """kind = "poses"
poses = [{x_mm = 0.0, y_mm = 0.0}, {x_mm = 30.0, y_mm = 10.0, angle_deg = 10.0},
         {x_mm = 60.0, y_mm = 15.0, angle_deg = 25.0}, {x_mm = 90.0, y_mm = 5.0, angle_deg = 45.0}]
pivots = [{of = "fixed", line = [0.0, -80.0, 90.0]}]
"""
"""Four dyads, three linkages without defects and three with."""


def test_linkages_for_a_task_are_those_of_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    Path("task.toml").write_text(TASK, "utf-8")
    command("synthesise", "task.toml", "--all", "--json", "--out", "answers")
    printed = json.loads(capsys.readouterr().out)
    for task in (tomllib.loads(TASK), "task.toml"):
        result = kd.synthesise(task)
        assert (result.complete, len(result.hidden)) == (printed["complete"], printed["hidden"])
        assert json.loads(json.dumps(result.dyads)) == printed["dyads"]
        for answer, row in zip((*result.answers, *result.hidden), printed["answers"], strict=True):
            for key in ("kind", "error_mm", "error_deg", "transmission_deg", "grashof", "length_ratio", "size_mm"):
                assert getattr(answer, key) == row[key], key
            assert list(answer.defects) == row["defects"]
            assert answer.design == kd.open(Path("answers", row["design"]))


def test_a_linkage_of_a_task_replaces_a_mechanism_and_changes_its_driver() -> None:
    Path("task.toml").write_text(TASK, "utf-8")
    BAR.save("bar.toml")
    command("synthesise", "task.toml", "--design", "bar.toml", "--into", "loaded.toml")
    command("synthesise", "task.toml", "--other-driver", "--into", "other.toml")
    command("synthesise", "task.toml", "--dyads", "1", "3", "--into", "dyads.toml")
    result = kd.synthesise("task.toml")
    assert result.answers[0].taken_over(BAR) == kd.open("loaded.toml")
    assert result.answers[0].driven_by_other_link().design == kd.open("other.toml")
    assert result.of_dyads(0, 2).design == kd.open("dyads.toml")


@pytest.mark.parametrize(
    ("task", "error", "text"),
    [
        (
            {"kind": "rocker", "rocker": {"swing_deg": 190.0, "frame_mm": 9.0}},
            kd.KindynaError,
            "rocker.swing_deg = 190",
        ),
        ({"kind": "spiral"}, kd.KindynaError, "kind = 'spiral'"),
        ("missing.toml", kd.KindynaError, "missing.toml"),
        (7, TypeError, "task = 7"),
    ],
)
def test_a_wrong_task_is_named(task: Any, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        kd.synthesise(task)


def test_wrong_dyads_and_designs_are_named() -> None:
    result = kd.synthesise(tomllib.loads(TASK))
    with pytest.raises(IndexError, match=r"second = 9999: no such dyad; allowed: 0 \.\.\. \d+"):
        result.of_dyads(0, 9999)
    with pytest.raises(TypeError, match="design = 3"):
        result.answers[0].taken_over(3)  # type: ignore[arg-type]
