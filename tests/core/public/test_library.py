"""The library for Python: its arrays are the tables of the command line, its extremes those of ``summary.json``."""

import csv
import io
import json
import math
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kindyna as kd
from core.__main__ import main

EXAMPLES = ["transfer_lift", "lecture_six_bar", "groove", "transfer_unit", "inverted_slider_crank", "kim_1990"]
LIFT = kd.example("transfer_lift")
SIX_BAR = kd.example("lecture_six_bar")
UNIT = kd.example("transfer_unit")


def exported(folder: Path, design: kd.Design, samples: int = 36) -> dict[str, str]:
    """File name -> text of what the command ``export`` writes."""
    design.save(folder / "design.toml")
    words = ["export", str(folder / "design.toml"), "--out", str(folder / "out"), "--samples", str(samples)]
    assert main(words) in (0, 1)
    return {path.name: path.read_text("utf-8") for path in (folder / "out").iterdir() if path.is_file()}


# -- designs --------------------------------------------------------------------------------------------------


def test_examples_are_those_of_the_menu() -> None:
    assert kd.examples()["transfer_lift"] == "Transfer lift"
    assert (LIFT.name, LIFT.kind) == ("Transfer unit, lift drive", "cam-slider")
    assert (SIX_BAR.kind, UNIT.kind) == ("linkage", "shaft")


@pytest.mark.parametrize("slug", EXAMPLES)
def test_a_design_is_its_file(slug: str, tmp_path: Path) -> None:
    design = kd.example(slug)
    design.save(tmp_path / "design.toml")
    text = (tmp_path / "design.toml").read_text("utf-8")
    copies = [kd.open(tmp_path / "design.toml"), kd.design(text), kd.design(design.toml), design.edit(design.fields())]
    copies.append(pickle.loads(pickle.dumps(design)))
    assert all(copy == design and hash(copy) == hash(design) and copy.toml == text for copy in copies)
    assert kd.design({**TABLE, "name": "Cam"}).edit({"name": "Lift"}) == kd.design({**TABLE, "name": "Lift"})


TABLE: dict[str, Any] = {
    "format": 1,
    "motion": {
        "start_mm": 0.0,
        "segments": [
            {"law": "cycloidal", "span_deg": 120.0, "rise_mm": 20.0},
            {"law": "dwell", "span_deg": 120.0},
            {"law": "cycloidal", "span_deg": 120.0, "rise_mm": -20.0},
        ],
    },
}


def test_fields_are_values_of_the_file() -> None:
    fields = LIFT.fields()
    assert fields["cam.base_radius_mm"] == LIFT["cam.base_radius_mm"] == 400.0
    assert fields["motion.segments[1].law"] == "modified-sine"
    assert SIX_BAR.fields()["linkage.links[2].points.B.x_mm"] == SIX_BAR["linkage.links[2].points.B"][0]
    assert UNIT.fields()["drives[0].name"] == "Feed"
    assert all(isinstance(value, bool | int | float | str | None) for value in fields.values())


def test_an_edit_leaves_the_design_and_sets_all_values_at_once() -> None:
    spans = {"motion.segments[1].span_deg": 50.0, "motion.segments[3].span_deg": 40.0}
    edited = LIFT.edit({**spans, "cam.base_radius_mm": 430})
    assert {path: edited[path] for path in spans} == spans
    assert math.fsum(edited[f"motion.segments[{i}].span_deg"] for i in range(5)) == 360.0
    assert (LIFT["cam.base_radius_mm"], edited["cam.base_radius_mm"]) == (400.0, 430.0)
    turned = {
        f"motion.segments[{i}].span_deg": span for i, span in ((3, 50.0), (0, 100.0), (2, 110.0), (1, 60.0), (4, 40.0))
    }
    assert {path: LIFT.edit(turned)[path] for path in turned} == turned
    with pytest.raises(AttributeError):
        LIFT.name = "other"  # type: ignore[misc]


def test_an_edit_is_judged_and_lists_all_faults() -> None:
    with pytest.raises(kd.KindynaError) as caught:
        LIFT.edit({"cam.base_radius_mm": -1.0, "follower.rod_mm": 0.0})
    assert {fault.path for fault in caught.value.faults} == {"cam.base_radius_mm", "follower.rod_mm"}
    assert all(str(fault) in str(caught.value) for fault in caught.value.faults)


# -- studies --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("slug", EXAMPLES)
def test_channels_are_the_columns_of_the_tables(slug: str, tmp_path: Path) -> None:
    design = kd.example(slug)
    study, names = design.study(36), set()
    for file, text in exported(tmp_path, design).items():
        if file.endswith(".csv") and file != "tongues.csv":
            header, *rows = csv.reader(io.StringIO(text))
            for name, values in zip(header, np.array(rows, dtype=float).T, strict=True):
                np.testing.assert_array_equal(study[name], values, err_msg=name)
                names.add(name)
            np.testing.assert_array_equal(study.angle_deg, study[header[0]])
    assert names == set(study.channels)
    assert all(study.channels[name].name == name and name.endswith(study.channels[name].name) for name in names)


@pytest.mark.parametrize("slug", ["transfer_lift", "lecture_six_bar", "transfer_unit"])
@pytest.mark.stress
def test_extremes_are_those_of_the_summary(slug: str, tmp_path: Path) -> None:
    design = kd.example(slug)
    figures, study = json.loads(exported(tmp_path, design)["summary.json"]), design.study(36)
    for name, row in figures["extremes"].items():
        low, high, largest = (study.extreme(name, of) for of in ("min", "max", "abs"))
        assert (low.value, low.angle_deg) == (row["min"]["value"], row["min"]["cam_angle_deg"]), name
        assert (high.value, high.angle_deg) == (row["max"]["value"], row["max"]["cam_angle_deg"]), name
        assert float(largest) == max(abs(low.value), abs(high.value))
        assert low.value <= study[name].min() + 1e-9 * abs(low.value)
    assert {name: list(pair) for name, pair in study.certificate.items()} == {
        name: [row["value"], row["bound"]] for name, row in figures["certificate"].items()
    }
    assert [finding.message for finding in study.findings] == [row["message"] for row in figures["findings"]]


def test_values_at_other_angles() -> None:
    study = LIFT.study()
    at = study.at([10.0, 90.0, 359.0])
    for name in ("drive_torque_nm", "pressure_angle_deg", "x_mm"):
        np.testing.assert_allclose(at[name], study[name][[10, 90, 359]], rtol=1e-12)
    assert at.angle_deg.tolist() == [10.0, 90.0, 359.0]
    torque = UNIT.study().at([45.0])["torque_nm"]
    np.testing.assert_allclose(torque, UNIT.study()["torque_nm"][45], rtol=1e-12)


def test_arrays_are_read_only() -> None:
    study = LIFT.study(36)
    for array in (
        study.angle_deg,
        study["x_mm"],
        study.at([1.0])["x_mm"],
        study.profile(),
        study.point("arm", "roller"),
    ):
        assert array.dtype == np.float64
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_profile_and_points_are_those_of_the_tables() -> None:
    lift, groove, bar = LIFT.study(36), kd.example("groove").study(36), SIX_BAR.study(36)
    np.testing.assert_array_equal(lift.profile(), np.column_stack((lift["x_mm"], lift["y_mm"])))
    np.testing.assert_array_equal(
        groove.profile("outer"), np.column_stack((groove["outer_x_mm"], groove["outer_y_mm"]))
    )
    np.testing.assert_allclose(bar.point(3, "B"), np.column_stack((bar["B_x_mm"], bar["B_y_mm"])), rtol=0, atol=1e-12)
    np.testing.assert_array_equal(bar.point(1, "O2"), [[60.0, 0.0]] * 36)


def test_drives_are_studied_by_their_own_angle() -> None:
    study = UNIT.study(36)
    assert list(study.drives) == ["Feed", "Clamp", "Lift", "Torque"]
    np.testing.assert_array_equal(study.drives["Lift"]["x_mm"], UNIT.study(36, drive="Lift")["x_mm"])
    assert list(LIFT.study(36).to_dict("x_mm", "y_mm")) == ["x_mm", "y_mm"]


def test_export_writes_what_the_command_writes(tmp_path: Path) -> None:
    (tmp_path / "command").mkdir()
    texts = exported(tmp_path / "command", SIX_BAR)
    paths = SIX_BAR.study(36).export(tmp_path / "library")
    assert {path.name: path.read_text("utf-8") for path in paths} == texts


@pytest.mark.stress
def test_a_drive_exports_its_channels(tmp_path: Path) -> None:
    study = UNIT.study(36).drives["Lift"]
    study.export(tmp_path)
    columns = {
        name for path in tmp_path.glob("*.csv") for name in path.read_text("utf-8").partition("\n")[0].split(",")
    }
    assert columns == set(study.channels)
    UNIT.study(36).export(tmp_path / "shaft")
    for path in tmp_path.glob("*.*"):
        assert path.read_bytes() == (tmp_path / "shaft" / "lift" / path.name).read_bytes()


def test_an_explanation_is_that_of_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    LIFT.save(tmp_path / "lift.toml")
    for name, at in (("pressure_angle_deg", None), ("drive_torque_nm", 90.0), ("needed_inertia_kg_m2", None)):
        words = ["explain", str(tmp_path / "lift.toml"), name, *([] if at is None else ["--at", str(at)])]
        explanation = LIFT.study(3600).explain(name, at)
        assert main(words) == 0
        assert str(explanation) == capsys.readouterr().out
        assert main([*words, "--json"]) == 0
        row = json.loads(capsys.readouterr().out)
        for key in ("quantity", "value", "unit", "source", "residual", "bound"):
            assert getattr(explanation, key) == row[key], key
        assert [list(explanation.equation), list(explanation.symbols)] == [row["equation"], row["symbols"]]


def test_figures_of_valves_are_those_of_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    train = tmp_path / "train.toml"
    kd.example("valve_train").save(train)
    study = kd.open(train).study()
    for words, lifts in (([], None), (["--at", "0.15,2mm"], np.array([0.15, 2.0]))):
        assert main(["valve", str(train), "--json", *words]) == 0
        printed = json.loads(capsys.readouterr().out)
        assert study.valves(lifts) == printed
        assert study.drives["Exhaust"].valves(lifts)["valves"][0]["events"] == printed["valves"][1]["events"]
    with pytest.raises(ValueError, match="at_mm = -1"):
        study.valves([1.0, -1.0])
    with pytest.raises(kd.KindynaError, match="no drive of this design moves a valve"):
        kd.example("four_bar").study().valves()


def test_many_designs_are_those_edited_one_by_one() -> None:
    radii, quantities = [380.0, 400.0, 430.0], ["pressure_angle_deg:max", "drive_torque_nm:abs"]
    result = LIFT.many({"cam.base_radius_mm": radii}, quantities)
    assert (len(result), result.inputs["cam.base_radius_mm"].tolist(), result.reason.tolist()) == (3, radii, [""] * 3)
    for i, radius in enumerate(radii):
        study = LIFT.edit({"cam.base_radius_mm": radius}).study()
        for quantity in quantities:
            name, of = quantity.split(":")
            assert result.value[quantity][i] == pytest.approx(study.extreme(name, of).value, rel=1e-9)
            assert result.angle_deg[quantity][i] == pytest.approx(
                study.extreme(name, of).angle_deg, abs=1e-3
            )  # of a flat peak
    with pytest.raises(ValueError, match="read-only"):
        result.value[quantities[0]][0] = 0.0


def test_find_and_compare_are_the_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    LIFT.save(tmp_path / "a.toml")
    result = LIFT.find("base-radius", {"pressure_angle_return_deg": 20.0})
    words = ["find", str(tmp_path / "a.toml"), "base-radius", "--limit", "pressure_angle_return_deg=20"]
    assert main([*words, "--into", str(tmp_path / "b.toml"), "--json"]) == 0
    row = json.loads(capsys.readouterr().out)
    assert (dict(result.answer), dict(result.reached), result.curve.tolist()) == (
        row["answer"],
        row["reached"],
        row["curve"],
    )
    assert result.design == kd.open(tmp_path / "b.toml")
    assert main(["compare", str(tmp_path / "a.toml"), str(tmp_path / "b.toml"), "--json"]) == 0
    assert LIFT.compare(result.design) == json.loads(capsys.readouterr().out)


def test_find_raises_with_the_best_where_no_value_satisfies_the_limits() -> None:
    with pytest.raises(kd.KindynaError, match=r"no value satisfies every limit.*cam.base_radius_mm = \d+.*violates"):
        LIFT.find("base-radius", {"pressure_angle_return_deg": 0.5})


def test_a_frame_needs_pandas(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"kindyna\[frames\]"):
        LIFT.study(36).to_frame()


def test_a_frame_has_the_angle_as_its_index() -> None:
    pytest.importorskip("pandas")
    frame = LIFT.study(36).to_frame("x_mm", "y_mm")
    assert (frame.index.name, list(frame.columns), frame.shape) == ("cam_angle_deg", ["x_mm", "y_mm"], (36, 2))


# -- what is wrong --------------------------------------------------------------------------------------------

STUDY = LIFT.study(36)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (lambda: kd.example("transfr_lift"), ("transfr_lift", "transfer_lift")),
        (lambda: LIFT["cam.base_radus_mm"], ("cam.base_radus_mm", "cam.base_radius_mm")),
        (lambda: LIFT.edit({"follower.rodd_mm": 1.0}), ("follower.rodd_mm", "follower.rod_mm")),
        (lambda: STUDY["drive_torqe_nm"], ("drive_torqe_nm", "drive_torque_nm")),
        (lambda: STUDY.extreme("drive_torqe_nm"), ("drive_torqe_nm", "drive_torque_nm")),
        (lambda: STUDY.profile("outer"), ("outer", "inner")),
        (lambda: STUDY.point("arms", "pivot"), ("arms", "arm")),
        (lambda: STUDY.point("arm", "pivott"), ("pivott", "pivot")),
        (lambda: UNIT.study(drive="Lft"), ("Lft", "Lift")),
        (lambda: LIFT.find("base-radus"), ("base-radus", "base-radius")),
        (lambda: LIFT.many({"cam.base_radus_mm": [1.0]}, ["x_mm:max"]), ("cam.base_radus_mm", "cam.base_radius_mm")),
        (lambda: STUDY.explain("drive_torqe_nm"), ("drive_torqe_nm", "drive_torque_nm")),
    ],
)
def test_an_unknown_name_is_named_with_the_nearest(wrong: Callable[[], object], named: tuple[str, str]) -> None:
    with pytest.raises((KeyError, kd.KindynaError)) as caught:
        wrong()
    assert all(name in str(caught.value) for name in named)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (lambda: LIFT.edit({"cam.base_radius_mm": "400"}), "cam.base_radius_mm"),
        (lambda: LIFT.edit({"cam.base_radius_mm": math.nan}), "cam.base_radius_mm"),
        (lambda: LIFT.edit({"cam.base_radius_mm": True}), "cam.base_radius_mm"),
        (lambda: LIFT.edit({"cam.base_radius_mm": None}), "cam.base_radius_mm"),
        (lambda: LIFT.edit({"follower.layout": 3}), "follower.layout"),
        (lambda: LIFT.edit({"motion.segments[1].law": None}), "motion.segments[1].law"),
        (lambda: LIFT.edit([("cam.base_radius_mm", 1.0)]), "values"),  # type: ignore[arg-type]
        (lambda: STUDY.at([0.0, math.inf]), "angles_deg"),
        (lambda: STUDY.at([[0.0]]), "angles_deg"),
        (lambda: STUDY.at(["0"]), "angles_deg"),
        (lambda: STUDY.at([]), "angles_deg"),
        (lambda: STUDY.extreme("x_mm", of="mean"), "mean"),
        (lambda: LIFT.study(3), "samples"),
        (lambda: LIFT.study(36.5), "samples"),  # type: ignore[arg-type]
        (lambda: LIFT.many({"cam.base_radius_mm": [[1.0]]}, ["x_mm:max"]), "cam.base_radius_mm"),
        (lambda: LIFT.many({"cam.base_radius_mm": [400.0, math.nan]}, ["x_mm:max"]), "cam.base_radius_mm"),
        (lambda: LIFT.many({"cam.base_radius_mm": [400.0]}, "x_mm:max"), "quantities"),
        (lambda: LIFT.many({"cam.base_radius_mm": [400.0]}, ["x_mm:most"]), "most"),
        (lambda: LIFT.many({}, ["x_mm:max"]), "values"),
        (lambda: LIFT.find("base-radius", {"pressure_angle_return_deg": math.nan}), "pressure_angle_return_deg"),
        (lambda: LIFT.find("base-radius", {"pressure_angle": 3.0}), "pressure_angle"),
        (lambda: LIFT.compare("lift"), "Design"),  # type: ignore[arg-type]
        (lambda: STUDY.explain("x_mm", math.nan), "at_deg"),
        (lambda: kd.design(3), "table"),  # type: ignore[arg-type]
        (lambda: kd.open(3), "path"),  # type: ignore[arg-type]
        (lambda: kd.open("nowhere.toml"), "nowhere.toml"),
        (lambda: kd.design("format = "), "not TOML"),
        (lambda: STUDY.extreme("cam_angle_deg"), "cam_angle_deg"),
        (lambda: UNIT.study(36).profile(), "Lift"),
        (lambda: SIX_BAR.study(36).profile(), "cam"),
    ],
)
def test_a_wrong_value_is_named_in_one_line(wrong: Callable[[], object], named: str) -> None:
    with pytest.raises((TypeError, ValueError, kd.KindynaError)) as caught:
        wrong()
    assert named in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("thing", [LIFT, STUDY, UNIT, *STUDY.channels.values(), STUDY.extreme("x_mm"), *UNIT.findings])
def test_a_repr_is_short(thing: object) -> None:
    lines = repr(thing).split("\n")
    assert len(lines) <= 6
    assert max(map(len, lines)) <= 120
