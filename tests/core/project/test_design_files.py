"""core.project: a design file is read with all its faults told at once, and comes back as it was typed."""

import math
import re
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strategies
import tomli_w
from damage import GONE, changed, damage, told, told_or_sound
from hypothesis import given
from hypothesis import strategies as st
from sampled import spread

from core import project
from core.design import (
    FOLLOWER_KINDS,
    Design,
    ElasticShaft,
    NamedCurve,
    RollerCam,
    Segment,
    SplineCurve,
    SplinePoint,
    faults,
    info_of,
    put,
    require_motion,
    with_motion,
)
from core.errors import DesignError, FileError
from core.laws import LAWS

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
LIFT, PICKER = (EXAMPLES / f"{name}.toml" for name in ("transfer_lift", "card_picker"))
TABLES = {path.stem: project.to_table(project.load(path)) for path in (LIFT, PICKER)}


def edited(edits: dict[str, Any], example: str = "transfer_lift") -> dict[str, Any]:
    """The tables of an example with entries replaced, or taken away."""
    return changed(TABLES[example], edits)


def check(edits: dict[str, Any], expected: dict[str, str], example: str = "transfer_lift") -> None:
    """These faults and no others; each line holds its phrase."""
    lines = told(edited(edits, example))
    assert set(lines) == set(expected)
    for path, phrase in expected.items():
        assert phrase in lines[path]


# -- what is right ----------------------------------------------------------------------------------------


@given(strategies.designs())
def test_round_trip(design: Design) -> None:
    assert faults(design) == []
    text = project.dumps(design)
    again = project.loads(text)
    assert again == design
    assert repr(again) == repr(design), "to the last bit, and the sign of zero"
    assert project.dumps(again) == text
    assert project.from_table(project.to_table(design)) == design


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_examples_stand_as_written(path: Path) -> None:
    assert project.dumps(project.load(path)) == path.read_text(encoding="utf-8")


def test_lift() -> None:
    design = project.load(LIFT)
    motion = design.drive.motion
    assert design.name == "Transfer unit, lift drive"
    assert motion.start == 150.0
    assert [(s.span_deg, s.rise, s.curve) for s in motion.segments] == [
        (35.0, 0.0, NamedCurve("dwell")),
        (41.5, -150.0, NamedCurve("modified-sine")),
        (207.0, 0.0, NamedCurve("dwell")),
        (41.5, 150.0, NamedCurve("modified-sine")),
        (35.0, 0.0, NamedCurve("dwell")),
    ]
    assert design.drive.mechanism.layout == "b"
    assert design.drive.loads.external_force_n == -20000.0
    assert "loads.slider_mass_kg" in design.assumed


def test_card_picker() -> None:
    design = project.load(PICKER)
    assert design.drive.cam.base_radius_mm == 50.0
    assert [s.curve.law for s in design.drive.motion.segments] == ["dwell", "c1", "cv1", "h2", "p2", "dwell"]
    assert [s.rise for s in design.drive.motion.segments] == [0.0, 1.0, 18.0, 1.0, -20.0, 0.0]


def test_card_picker_keeps_contact() -> None:
    """Preload and weight alone, friction none, against the largest acceleration, which P2 and H2 share at the top:
    216/41 h/beta^2."""
    design = project.load(PICKER)
    loads, omega = design.drive.loads, math.radians(6.0 * design.shaft.speed_rpm)
    back = design.drive.motion.segments[4]
    largest = 216.0 / 41.0 * abs(back.rise) / 1e3 * (omega / math.radians(back.span_deg)) ** 2
    assert loads.preload_n > 5.0 * loads.follower_mass_kg * largest


def test_order_of_keys() -> None:
    table = project.to_table(project.load(LIFT))
    assert list(table) == ["format", "name", "assumed", "motion", "follower", "cam", "shaft", "loads"]
    assert list(table["follower"])[:2] == ["kind", "layout"]
    assert list(table["motion"]["segments"][1]) == ["law", "span_deg", "rise_mm"]
    assert list(table["motion"]["segments"][0]) == ["law", "span_deg"], "a dwell does not say its rise"
    assert list(table["loads"])[-5:] == [
        "friction",
        "external_force_n",
        "spring_rate_n_per_mm",
        "gravity_m_s2",
        "gravity_angle_deg",
    ]
    text = project.dumps(project.load(LIFT))
    assert text.startswith('format = 1\nname = "Transfer unit, lift drive"\nassumed = [\n    "loads.')
    assert text.count("\n[[motion.segments]]\n") == 5


def test_nothing_assumed_says_nothing() -> None:
    assert "assumed" not in project.to_table(replace(project.load(LIFT), assumed=()))


@pytest.mark.parametrize(
    ("edits", "path", "value"),
    [
        ({"follower.rod_mm": 845}, "follower.rod_mm", 845.0),
        ({"loads": GONE}, "loads.gravity_m_s2", 9.80665),
        ({"loads.friction": GONE}, "loads.friction", 0.0),
        ({"motion.segments[0].rise_mm": 0}, "motion.segments[0].rise_mm", 0.0),
        ({"motion.segments[1].law": "harmonic"}, "motion.segments[1].law", "harmonic"),
        ({"assumed": []}, "assumed", ()),
        ({"assumed": ["motion.segments[1].law"]}, "assumed", ("motion.segments[1].law",)),
        ({"name": "캠 \n \\ \" ' \t\u2028 \x7f"}, "name", "캠 \n \\ \" ' \t\u2028 \x7f"),
        ({"motion.segments[0].span_deg": 35.0 + 9e-10}, "motion.segments[0].span_deg", 35.0 + 9e-10),
    ],
)
def test_accepted(edits: dict[str, Any], path: str, value: Any) -> None:
    if path == "loads.gravity_m_s2":
        edits = edits | {"assumed": []}
    design = project.loads(tomli_w.dumps(edited(edits)))
    section, _, key = path.partition(".")
    found = getattr(design, section) if not key else project.to_table(design)
    for step in re.findall(r"[a-z_]\w+|\d+", path) if key else ():
        if isinstance(found, dict) and step not in found:
            found = 0.0  # of a dwell
            break
        found = found[int(step) if step.isdigit() else step]
    assert found == value
    assert type(found) is type(value)
    assert project.loads(project.dumps(design)) == design


def test_numbers_become_floats_and_stay_stable() -> None:
    text = project.dumps(project.load(LIFT)).replace("845.0", "845").replace("= 400.0", "= 4e2")
    once = project.dumps(project.loads(text))
    assert "rod_mm = 845.0" in once
    assert "base_radius_mm = 400.0" in once
    assert project.dumps(project.loads(once)) == once


def test_integers_given_in_python_are_written_as_floats() -> None:
    design = put(project.load(LIFT), "follower.rod_mm", 845)
    assert project.loads(project.dumps(design)) == design
    assert "rod_mm = 845.0\n" in project.dumps(design)


def test_byte_order_mark_and_windows_lines(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xef\xbb\xbf" + LIFT.read_bytes().replace(b"\n", b"\r\n"))
    assert project.load(path) == project.load(LIFT)


# -- single faults ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("path", "value", "phrase"),
    [
        # the head
        ("format", GONE, "missing; allowed: 1"),
        ("format", 2, "= 2: unknown format; allowed: 1"),
        ("format", 1.0, "unknown format"),
        ("format", True, "unknown format"),
        ("format", "1", "unknown format"),
        ("name", GONE, "missing"),
        ("name", "", "empty"),
        ("name", " \t\n", "empty"),
        ("name", 3, "must be text"),
        ("unit", "mm", "unknown key"),
        ("motions", {}, "= {}: unknown key; allowed:"),  # motion is there already
        # words
        ("follower.kind", "cam_slider", "did you mean 'cam-slider'?); allowed: cam-slider | translating"),
        ("follower.kind", "Cam Slider", "did you mean 'cam-slider'?"),
        ("follower.kind", "geneva", "unknown word; allowed: cam-slider | translating"),
        ("follower.kind", 3, "must be text; allowed: cam-slider"),
        ("follower.kind", GONE, "missing; allowed: cam-slider"),
        ("follower.layout", "z", "= 'z': unknown word; allowed: a | b | c | d | e | f | g | h"),
        ("follower.layout", "B", "did you mean 'b'?"),
        ("follower.layout", "", "unknown word"),
        ("follower.layout", "ab", "unknown word"),
        ("follower.layout", GONE, "missing; allowed: a | b"),
        ("follower.layout", 2, "must be text; allowed: a | b"),
        ("follower.layout", "c", "has the cam right of the pivot"),
        ("follower.pivot_x_mm", 0.0, "left or right"),
        ("cam.form", "opne", "did you mean 'open'?"),
        ("shaft.rotation", "CCW", "did you mean 'ccw'?); allowed: ccw | cw"),
        ("shaft.rotation", "left", "unknown word; allowed: ccw | cw"),
        ("motion.segments[1].law", "modified sine", "did you mean 'modified-sine'?"),
        ("motion.segments[1].law", "cyclodial", "did you mean 'cycloidal'?"),
        ("motion.segments[1].law", "zigzag", "unknown law; allowed: dwell | "),
        ("motion.segments[1].law", GONE, "missing; allowed: dwell | "),
        ("motion.segments[1].law", 5, "must be text; allowed: dwell | "),
        ("motion.segments[1].law", ["dwell"], "must be text; allowed: dwell | "),
        # numbers
        ("follower.rod_mm", GONE, "missing; allowed: above 0 ... 1e+09 mm"),
        ("follower.rod_mm", -5.0, "= -5.0: outside its range; allowed: above 0 ... 1e+09 mm"),
        ("follower.rod_mm", 0, "outside its range"),
        ("follower.rod_mm", math.nan, "= nan: outside its range"),
        ("follower.rod_mm", math.inf, "= inf: outside its range"),
        ("follower.rod_mm", True, "must be a number; allowed: above 0"),
        ("follower.rod_mm", "845", "= '845': must be a number; allowed: above 0"),
        ("follower.rod_mm", [845.0], "must be a number"),
        ("follower.rod_mm", {"value": 845.0}, "must be a number"),
        ("follower.rod_mm", 10**400, "too large for a number; allowed: above 0"),
        ("loads.rod_centre", 1.01, "allowed: 0 ... 1"),
        ("loads.friction", -0.1, "outside its range"),
        ("loads.external_force_n", -math.inf, "any number of N"),
        ("loads.gravity_angle_deg", 361, "-360 ... 360"),
        ("shaft.speed_rpm", GONE, "missing; allowed: above 0 ... 100000 rpm"),
        ("shaft.speed_rpm", 0.0, "outside its range"),
        ("cam.base_radius_mm", GONE, "missing; allowed: above 0"),
        ("motion.start_mm", GONE, "missing; allowed: any number of mm"),
        ("motion.start_mm", math.nan, "outside its range"),
        ("motion.start_mm", "150", "must be a number; allowed: any number of mm"),
        ("motion.segments[1].span_deg", GONE, "missing; allowed: 1e-06 ... 360"),
        ("motion.segments[1].span_deg", "41.5", "must be a number"),
        ("motion.segments[1].span_deg", math.nan, "outside its range"),
        ("motion.segments[1].rise_mm", GONE, "missing; allowed: any number of mm"),
        ("motion.segments[1].rise_mm", False, "must be a number"),
        ("motion.segments[1].rise_mm", math.nan, "outside its range"),
        # keys
        ("cam.base_radius", 400.0, "wrong unit; allowed: base_radius_mm"),
        ("cam.hole", 40.0, "unknown key; allowed: base_radius_mm | roller_radius_mm | form"),
        ("cam.thicknes_mm", 40.0, "did you mean 'thickness_mm'?"),
        ("shaft.speed_deg", 40.0, "wrong unit; allowed: speed_rpm"),
        ("shaft.sense", "ccw", "unknown key"),
        ("loads.follower_mass_kg", 1.0, "unknown key"),
        ("follower.offset_mm", 1.0, "unknown key"),
        ("motion.unit", "mm", "unknown key; allowed: start_mm | advance_mm | lobe | segments"),
        ("motion.start", 150.0, "wrong unit; allowed: start_mm"),
        ("motion.start_deg", 150.0, "wrong unit; allowed: start_mm"),
        ("motion.segments[1].rise_deg", 10.0, "wrong unit; allowed: rise_mm"),
        ("motion.segments[0].rise_deg", 10.0, "wrong unit; allowed: rise_mm"),
        ("motion.segments[1].curve", "dwell", "unknown key; allowed: span_deg | rise_mm | law"),
        ("motion.segments[1].crossing", 0.5, "unknown key"),
        # tables
        ("motion", GONE, "missing; allowed: a table [motion] with start_mm"),
        ("cam", GONE, "missing; allowed: a table [cam] with base_radius_mm, roller_radius_mm"),
        ("shaft", GONE, "missing; allowed: a table [shaft] with rotation, speed_rpm"),
        ("follower", GONE, "missing; allowed: exactly one of [follower] | [linkage] | [[drives]]"),
        ("follower", 3, "= 3: must be a table; allowed: [follower]"),
        ("cam", [1], "must be a table"),
        ("shaft", "ccw", "must be a table"),
        ("motion", True, "must be a table"),
        ("loads", 1.0, "must be a table"),
        ("linkage", {}, "cannot be combined with follower: a design is of one kind; allowed: exactly one of"),
        ("drives", [{}], "cannot be combined with follower: a design is of one kind; allowed: exactly one of"),
        # lists
        ("motion.segments", GONE, "no segments"),
        ("motion.segments", [], "no segments"),
        ("motion.segments", {}, "must be a list of tables; allowed: [[motion.segments]]"),
        ("motion.segments", "dwell", "must be a list of tables"),
        ("motion.segments", 7, "must be a list of tables"),
        ("motion.segments[2]", 7, "must be a table"),
        ("motion.segments[2]", [], "must be a table"),
        # sums
        ("motion.segments[2].span_deg", 206.0, "motion.segments"),
        ("motion.segments[1].rise_mm", -149.0, "motion.segments"),
        ("motion.segments[0].rise_mm", 1e-3, "a dwell does not rise"),
        # assumed
        ("assumed", "loads.friction", "must be a list of field paths"),
        ("assumed", 1, "must be a list of field paths"),
        ("assumed[1]", 7, "must be a field path"),
        ("assumed[0]", "loads.frction", "no such entry in this design (did you mean 'loads.friction'?)"),
        ("assumed[0]", "loads", "no such entry"),
        ("assumed[0]", "", "no such entry"),
        ("assumed[0]", "loads.follower_mass_kg", "no such entry"),
        ("assumed[0]", "motion.start_deg", "no such entry"),
        ("assumed[0]", "motion.start", "no such entry"),
        ("assumed[0]", "motion.segments[5].rise_mm", "no such entry"),
        ("assumed[0]", "motion.segments[1].rise_deg", "no such entry"),
        ("assumed[0]", "motion.segments", "no such entry"),
    ],
)
def test_fault(path: str, value: Any, phrase: str) -> None:
    """This fault alone; that of a sum stands at the segments."""
    lines = told(edited({path: value}))
    if phrase == "motion.segments":
        path, phrase = "motion.segments", "a sum of"
    if path == "motion.segments[0].rise_mm":
        assert lines.pop("motion.segments")
    if path in ("follower", "loads", "motion") or path.startswith("follower.kind"):
        # without the table, the paths that are assumed in it may be unknown, but nothing else is told
        lines = {at: line for at, line in lines.items() if not at.startswith("assumed")}
    assert set(lines) == {path}
    assert phrase in lines[path]
    assert lines[path].startswith(path)


@pytest.mark.parametrize("section", ["follower", "cam", "shaft", "loads", "motion"])
@pytest.mark.parametrize("example", spread(sorted(TABLES), 3))
def test_every_number_is_guarded(section: str, example: str) -> None:
    for key, value in TABLES[example][section].items():
        if isinstance(value, float):
            for bad in (math.nan, math.inf, True, "1", 10**999, {}, []):
                check({f"{section}.{key}": bad}, {f"{section}.{key}": "allowed: "}, example)


@pytest.mark.parametrize("kind", FOLLOWER_KINDS)
def test_every_required_key_is_missed(kind: str) -> None:
    row = FOLLOWER_KINDS[kind]
    table = {"format": 1, "name": "x", "motion": {}, "follower": {"kind": kind}, "cam": {}, "shaft": {}}
    lines = told(table)
    for section, part in (("follower", row.follower), ("cam", RollerCam), ("loads", row.loads)):
        for field in fields(part):
            required = field.default is field.default_factory
            assert (f"{section}.{field.name}" in lines) == required
            if required:
                assert "missing; allowed: " in lines[f"{section}.{field.name}"]
                assert info_of(field)
    assert lines["motion.segments"]


def test_an_empty_row_of_drives() -> None:
    lines = told({"format": 2, "drives": [{}]})
    own = {f"drives[0].{name}" for name in ("name", "motion", "follower", "cam")}
    assert set(lines) == {"format", "name", "shaft", *own}
    assert "exactly one of [drives.follower] | [drives.linkage]" in lines["drives[0].follower"]


def test_drives_of_motions_alone_are_told_in_a_line_each() -> None:
    motion = {"start_mm": 0.0, "segments": [{"law": "dwell", "span_deg": 360.0}]}
    shaft = {"speed_rpm": 60.0, "rotation": "ccw"}
    drives = [{"name": name, "motion": motion} for name in "ab"]
    lines = told({"format": 1, "name": "x", "shaft": shaft, "drives": drives})
    assert set(lines) == {"drives[0].motion", "drives[1].motion"}
    assert "a motion alone is a separate file; allowed: exactly one of [drives.follower]" in lines["drives[0].motion"]


# -- a flexible shaft -------------------------------------------------------------------------------------

ELASTIC = {"shaft.camshaft_inertia_kg_m2": 60, "shaft.stiffness_nm_per_rad": 1.6e6}


def test_the_elasticity_of_a_shaft_stands_flat_in_its_table() -> None:
    design = project.from_table(edited(ELASTIC))
    assert design.shaft.elastic == ElasticShaft(60.0, 1.6e6)
    table = project.to_table(design)["shaft"]
    assert list(table)[-5:] == [
        "camshaft_inertia_kg_m2",
        "stiffness_nm_per_rad",
        "damping_ratio",
        "spring",
        "spring_factor",
    ]
    assert table["spring"] == "fixed"
    assert project.loads(project.dumps(design)) == design
    assert project.from_table(edited({})).shaft.elastic is None
    assert "stiffness_nm_per_rad" not in project.to_table(project.from_table(edited({})))["shaft"]


@pytest.mark.parametrize(
    ("edits", "expected"),
    [
        ({"shaft.damping_ratio": 0.1}, {
            "shaft.camshaft_inertia_kg_m2": "missing; allowed: > 0", "shaft.stiffness_nm_per_rad": "missing; allowed: > 0"}),
        (ELASTIC | {"shaft.stiffness_nm_per_rad": 0.0}, {"shaft.stiffness_nm_per_rad": "> 0 N·m/rad"}),
        (ELASTIC | {"shaft.damping_ratio": "much"}, {"shaft.damping_ratio": "must be a number; allowed: 0 ... 0.99"}),
        (ELASTIC | {"shaft.spring": "retunned"}, {"shaft.spring": "did you mean 'retuned'?"}),
        (ELASTIC | {"shaft.spring": 3}, {"shaft.spring": "must be text"}),
        (ELASTIC | {"shaft.damping": 0.1}, {"shaft.damping": "did you mean 'damping_ratio'?"}),
        ({"shaft.stiffness_n_per_mm": 1.0}, {"shaft.stiffness_n_per_mm": "wrong unit; allowed: stiffness_nm_per_rad"}),
        ({"shaft.elastic": {}}, {"shaft.elastic": "unknown key"}),
        (ELASTIC | {"shaft.elastic": 1}, {"shaft.elastic": "unknown key"}),
        ({"assumed": ["shaft.stiffness_nm_per_rad"]}, {"assumed[0]": "no such entry in this design"}),
        (ELASTIC | {"shaft.speed_rpm": -1.0, "shaft.spring_factor": math.nan, "assumed": ["shaft.elastic"]},
         {"shaft.speed_rpm": "above 0", "shaft.spring_factor": "allowed: 0", "assumed[0]": "no such entry"}),
    ],
)  # fmt: skip
def test_faults_of_a_flexible_shaft(edits: dict[str, Any], expected: dict[str, str]) -> None:
    check(edits, expected)


def test_what_is_assumed_of_a_flexible_shaft_is_kept() -> None:
    design = project.from_table(edited(ELASTIC | {"assumed": ["shaft.stiffness_nm_per_rad", "shaft.damping_ratio"]}))
    assert design.assumed == ("shaft.stiffness_nm_per_rad", "shaft.damping_ratio")
    assert project.loads(project.dumps(design)) == design


# -- many faults ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("edits", "expected"),
    [
        (
            {"cam.hole": 1.0, "motion.segments[2].span_deg": 200.0, "follower.rod_mm": -1.0},
            {"cam.hole": "unknown key", "motion.segments": "353 deg", "follower.rod_mm": "range"},
        ),
        (  # in one table
            {
                "follower.rod_mm": -1.0,
                "follower.layout": "c",
                "follower.slider_arm_mm": GONE,
                "follower.pivot_y_mm": "x",
                "follower.extra": 1,
            },
            {
                "follower.rod_mm": "range",
                "follower.layout": "cam right of the pivot",
                "follower.slider_arm_mm": "missing",
                "follower.pivot_y_mm": "must be a number",
                "follower.extra": "unknown key",
            },
        ),
        (  # the sums are told whatever else is wrong with the motion
            {
                "motion.start_mm": GONE,
                "motion.extra": 1,
                "motion.segments[1].law": "modifed-sine",
                "motion.segments[1].rise_mm": -140.0,
                "motion.segments[2].span_deg": 206.0,
                "motion.segments[3].extra": 1,
                "motion.segments[4].rise_deg": 1.0,
            },
            {
                "motion.start_mm": "missing",
                "motion.extra": "unknown key",
                "motion.segments[1].law": "did you mean 'modified-sine'?",
                "motion.segments": "rises add up to 10 mm",
                "motion.segments[3].extra": "unknown key",
                "motion.segments[4].rise_deg": "wrong unit",
            },
        ),
        (  # but not sums of what is unknown
            {
                "motion.segments[1].rise_mm": GONE,
                "motion.segments[2].span_deg": "207",
                "motion.segments[4]": 3,
            },
            {
                "motion.segments[1].rise_mm": "missing",
                "motion.segments[2].span_deg": "must be a number",
                "motion.segments[4]": "must be a table",
            },
        ),
        (  # numbers too large to add
            {"motion.segments[1].rise_mm": 1.5e308, "motion.segments[3].rise_mm": 1.5e308},
            {
                "motion.segments": "rises add up to inf mm",
                "motion.segments[1].rise_mm": "up to +-1e+15",
                "motion.segments[3].rise_mm": "up to +-1e+15",
            },
        ),
        (
            {"motion.segments[1].rise_mm": math.inf, "motion.segments[3].rise_mm": -math.inf},
            {"motion.segments[1].rise_mm": "range", "motion.segments[3].rise_mm": "range"},
        ),
        (  # a misspelt kind hides nothing
            {"follower.kind": "cam-slidr", "follower.rod_mm": 0.0, "loads.extra": 1, "cam.form": 3},
            {
                "follower.kind": "did you mean",
                "follower.rod_mm": "range",
                "loads.extra": "unknown key",
                "cam.form": "text",
            },
        ),
        (  # nor does an unknown one hide what all kinds share
            {"follower.kind": "x", "shaft.speed_rpm": -1, "cam.form": 3, "motion.start_mm": math.nan},
            {
                "follower.kind": "unknown word",
                "shaft.speed_rpm": "range",
                "cam.form": "text",
                "motion.start_mm": "range",
            },
        ),
        (
            {"motion": 1, "follower.rod_mm": 0.0, "cam": GONE, "shaft": [], "loads": "x", "format": 3},
            {
                "format": "unknown format",
                "motion": "table",
                "follower.rod_mm": "range",
                "cam": "missing",
                "shaft": "table",
                "loads": "table",
            },
        ),
    ],
)
def test_all_at_once(edits: dict[str, Any], expected: dict[str, str]) -> None:
    lines = {}
    with pytest.raises(DesignError) as caught:
        project.loads(tomli_w.dumps(edited(edits)))
    for fault in caught.value.faults:
        lines[fault.path] = f"{lines.get(fault.path, '')}{fault}"
    assert set(lines) == set(expected)
    for path, phrase in expected.items():
        assert phrase in lines[path]


def test_nothing_at_all() -> None:
    assert set(told("")) == {"format", "name", "follower", "motion", "cam", "shaft"}


def test_translating() -> None:
    check(
        {"follower.face": "flatt", "follower.rod_mm": 1.0, "loads.preload_n": "x", "motion.start_deg": 1.0},
        {
            "follower.face": "unknown word (did you mean 'flat'?); allowed: roller | flat | knife | shoe",
            "follower.rod_mm": "unknown key",
            "loads.preload_n": "must be a number",
            "motion.start_deg": "wrong unit",
        },
        "card_picker",
    )


@given(st.data())
def test_any_damage_is_told(data: st.DataObject) -> None:
    """Whatever is put wherever: a design without faults, or one line for each fault."""
    table = edited({}, data.draw(st.sampled_from(sorted(TABLES))))
    for _ in range(data.draw(st.integers(1, 5))):
        damage(table, data)
    told_or_sound(table)


# -- values that are hard to show --------------------------------------------------------------------------


@pytest.mark.parametrize(
    "entry",
    [
        '"a\\nb" = 1',
        '"a\\u2028b" = "x\\ny"',
        f"{'k' * 5000} = 1",
        f'k = "{"v" * 5000}"',
        f"k = 0x{'f' * 9000}",
        "k = 2024-01-01",
        "k = 1979-05-27T07:32:00Z",
        f"k = {'[' * 80}{']' * 80}",
        "".join(f"k{i} = {i}\n" for i in range(200)),
        "'' = 1",
    ],
)
@pytest.mark.parametrize("table", ["cam", "motion", None])
def test_each_fault_is_one_short_line(entry: str, table: str | None) -> None:
    text = LIFT.read_text("utf-8")
    text = text.replace(f"[{table}]\n", f"[{table}]\n{entry}\n") if table else f"{entry}\n{text}"
    for line in told(text).values():
        assert len(line) < 400
        assert line.isprintable()


def test_faults_do_not_depend_on_hashing() -> None:
    extra = {f"cam.k{i}": i for i in range(9, 0, -1)}
    assert list(told(edited(extra))) == sorted(extra)


# -- what is no TOML --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "phrase"),
    [
        ("format = ", "(at line 1, column 10, the end)"),
        ("format = 1\nname = 'x\n", "line 3, column 1"),
        ("format = 1\nformat = 1\n", "at line 2"),
        ("[motion\n", "line 1, column 8"),
        ("\x00\x01\x02", "line 1, column 1"),
        ("PK\x03\x04", "line 1"),
        ("{'json': 1}", "line 1, column 1"),
        ("x = 1" + "0" * 5000, "too many digits"),
        ("k" * 9000 + " x", "line 1, column 9002"),
        ("a = " + "[" * 100_000, "nested too deeply"),
        ("a = " + "{a = " * 10_000, "nested too deeply"),
        ("a." * 100_000 + "a = 1", "more than 50 parts (at line 1)"),
        ("x = 1\n[" + "a." * 100_000 + "a]", "more than 50 parts (at line 2)"),
        ("x = 2024-13-45", "line 1"),
        ("x = 1\ry = 2", "line 1"),
    ],
)
def test_no_toml(text: str, phrase: str) -> None:
    with pytest.raises(DesignError) as caught:
        project.loads(text, source="lift.toml")
    (fault,) = caught.value.faults
    line = str(fault)
    assert line.startswith("lift.toml: not TOML: ")
    assert phrase in line
    assert line.isprintable()
    assert len(line) < 250


def test_deep_tables_are_faults_like_others() -> None:
    deep: dict[str, Any] = {}
    for _ in range(100_000):
        deep = {"a": deep}
    with pytest.raises(DesignError, match=r"a = .*: unknown key"):
        project.from_table(edited({}) | deep)


def test_dots_elsewhere_are_no_key() -> None:
    text = LIFT.read_text("utf-8")
    assert project.loads(f"# {'.' * 99}\n{text}") == project.load(LIFT)
    numbers = f"x = [\n  {', '.join(['0.5'] * 99)}\n]\n"
    assert set(told(numbers + text)) == {"x"}
    dotted = put(project.load(LIFT), "name", "a.b = " + "x." * 100)
    assert project.loads(project.dumps(dotted)) == dotted


def many_segments(number: int, law: str = "dwell") -> str:
    head, tail = LIFT.read_text("utf-8").split("[[motion.segments]]", 1)
    segment = f'[[motion.segments]]\nlaw = "{law}"\nspan_deg = {360.0 / number!r}\n'
    return head + segment * number + tail[tail.index("[follower]") :]


@pytest.mark.stress
def test_many_segments() -> None:
    design = project.loads(many_segments(3_600))
    assert design.drive.motion.segments[-1] == Segment(0.1, 0.0, NamedCurve("dwell"))
    assert len(told(many_segments(3_000, "dwel"))) == 3_000


# -- files ------------------------------------------------------------------------------------------------


def test_load_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "broken.toml"
    path.write_text("name = ", "utf-8")
    with pytest.raises(DesignError, match=re.escape(f"{path}: not TOML: ")):
        project.load(path)
    with pytest.raises(FileError, match="no such file"):
        project.load(tmp_path / "none.toml")
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(FileError, match="UTF-8"):
        project.load(str(path))


def test_save(tmp_path: Path) -> None:
    design, path = project.load(LIFT), tmp_path / "lift.toml"
    project.save(design, path)
    assert path.read_bytes() == LIFT.read_bytes()
    project.save(replace(design, name="other"), str(path))
    assert project.load(path).name == "other"


@pytest.mark.parametrize(
    ("path", "value"),
    [("follower.rod_mm", -1.0), ("name", ""), ("assumed", ("x",)), ("motion.segments", ()), ("motion.start", math.nan)],
)
def test_save_keeps_the_old_file_rather_than_write_one_that_cannot_be_read(
    tmp_path: Path, path: str, value: Any
) -> None:
    file = tmp_path / "lift.toml"
    file.write_text("old", "utf-8")
    with pytest.raises(DesignError):
        project.save(put(project.load(LIFT), path, value), file)
    assert file.read_text("utf-8") == "old"
    assert list(tmp_path.iterdir()) == [file]


def test_save_a_name_that_no_file_can_hold(tmp_path: Path) -> None:
    with pytest.raises((FileError, DesignError)):
        project.save(replace(project.load(LIFT), name="\ud800"), tmp_path / "a")
    assert list(tmp_path.iterdir()) == []


def test_nan_of_python_is_a_fault_too() -> None:
    table = edited({"follower.rod_mm": math.nan, "motion.start_mm": math.nan})
    with pytest.raises(DesignError, match=r"follower\.rod_mm = nan"):
        project.from_table(table)


def test_every_law_has_a_slug_that_is_read() -> None:
    for law in LAWS:
        moved = (1,) if LAWS[law].rises < 0 else (1, 3)  # the one that returns
        edits = {f"motion.segments[{i}].law": law for i in moved}
        if LAWS[law].is_dwell:
            edits |= {f"motion.segments[{i}].rise_mm": 0.0 for i in (1, 3)}
        project.from_table(edited(edits))


def test_numbers_of_numpy_are_written_as_numbers() -> None:
    """What fits and blends put into a design may be of numpy's kind."""
    lift = project.load(LIFT)
    motion = require_motion(lift)
    segments = tuple(replace(s, rise=np.float64(s.rise), span_deg=np.float64(s.span_deg)) for s in motion.segments)
    points = SplineCurve((SplinePoint(np.float64(10.0), np.float64(-50.0), np.float64(0.0)),))
    bent = (segments[0], replace(segments[1], curve=points), *segments[2:])
    for each in (segments, bent):
        design = with_motion(lift, replace(motion, start=np.float64(motion.start), segments=each))
        assert project.loads(project.dumps(design)) == design


def test_a_table_is_kept_as_rows_of_numbers() -> None:
    rows = (SplinePoint(0.0, 0.0), SplinePoint(20.0, -60.0, -3.5), SplinePoint(41.5, -150.0, 0.0, 0.25))
    design = put(put(project.load(LIFT), "motion.segments[1].law", "table"), "motion.segments[1].points", rows)
    text = project.dumps(design)
    assert "    [0.0, 0.0],\n    [20.0, -60.0, -3.5],\n    [41.5, -150.0, 0.0, 0.25],\n" in text
    assert project.loads(text) == design
    check(
        {
            "motion.segments[1].law": "table",
            "motion.segments[1].points": [[0.0], [20.0, "a"], [41.5, -150.0, 0.0, 0.0, 0.0]],
        },
        {
            "motion.segments[1].points[0]": "must be a row of numbers",
            "motion.segments[1].points[1].value": "must be a number",
            "motion.segments[1].points[2]": "must be a row of numbers",
        },
    )
