"""core.project and core.design for linkages: faults with their paths, exact round trips, values by path."""

import copy
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import strategies
import tomli_w
from damage import GONE, changed, damage, told, told_or_sound
from hypothesis import given, settings
from hypothesis import strategies as st

from core import project
from core.design import (
    SECTIONS,
    Design,
    Drive,
    Driver,
    Link,
    Linkage,
    LinkageCam,
    LinkageLoads,
    LinkForce,
    LinkMass,
    LinkPoint,
    Roller,
    Side,
    Slider,
    all_paths,
    edited,
    entries,
    faults,
    get,
    put,
    with_assumed,
)

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
NAMES = ("lecture_six_bar", "four_bar_coupler_cam", "slider_crank", "inverted_slider_crank", "cam_slider_linkage")
TABLES = {name: project.to_table(project.load(EXAMPLES / f"{name}.toml")) for name in NAMES}
SIX, CAM, CRANK, INVERTED, LIFT = NAMES


# -- what is right ----------------------------------------------------------------------------------------


def test_the_contracts_own_text_is_read() -> None:
    text = """
format = 1
name = "as the contract spells it"
[linkage]
driver = { link = 2, kind = "crank", speed_rpm = 60.0 }   # or kind = "motion" with [motion]
branch = { B = 1, D = 1 }
[[linkage.links]]
number = 1
points = { O1 = [0.0, 0.0], O2 = [60.0, 0.0] }
[[linkage.links]]
number = 2
points = { O1 = [0.0, 0.0], A = [20.0, 0.0] }
[[linkage.links]]
number = 3
points = { A = [0.0, 0.0], B = [68.97, 0.0] }
[[linkage.links]]
number = 4
points = { O2 = [0.0, 0.0], B = [40.0, 0.0], C = [60.0, 0.0] }
[[linkage.links]]
number = 5
points = { C = [0, 0], D = [60, 0] }
[[linkage.links]]
number = 6
points = { D = [0.0, 0.0] }
[[linkage.sliders]]
link = 6
on = 1
through = [0.0, 0.0]
angle_deg = 0.0
"""
    design = project.loads(text)
    assert design.drive.is_linkage
    assert design.drive.mechanism.driver == Driver(2, "crank", 60.0)
    assert design.drive.mechanism.sides == {"B": 1, "D": 1}
    assert design.drive.mechanism.by_number[4].places == {"O2": 0j, "B": 40.0 + 0j, "C": 60.0 + 0j}
    assert design.drive.mechanism.sliders == (Slider(link=6, on=1),)
    assert design.drive.motion is None
    assert project.loads(project.dumps(design)) == design


NUMBERS = st.floats(-1e9, 1e9, allow_nan=False)
WORDS = st.text("ABCxyz_점é", min_size=1, max_size=4).filter(str.isidentifier)


@st.composite
def linkages(draw: st.DrawFn) -> Design:
    """The structure of a slider-crank, with any numbers, names, masses and entries assumed; crank- or motion-driven."""
    o, a, b, tip = draw(st.lists(WORDS, min_size=4, max_size=4, unique=True))

    def place(name: str) -> LinkPoint:
        return LinkPoint(name, draw(NUMBERS), draw(NUMBERS))

    links = (
        Link(1, (place(o),)),
        Link(2, (place(o), place(a))),
        Link(3, (place(a), place(b), place(tip))),
        Link(7, (place(b),)),
    )
    slider = Slider(
        link=7, on=1, through_x_mm=draw(NUMBERS), through_y_mm=draw(NUMBERS), angle_deg=draw(st.floats(-360.0, 360.0))
    )
    speed = draw(st.floats(-1e5, 1e5).filter(bool))
    branch = draw(st.sampled_from([(), (Side(b, 1),), (Side(b, -1),)]))
    driver, motion, cam = Driver(2, "crank", speed), None, None
    if draw(st.booleans()):
        driver, motion = Driver(2, "motion", speed), draw(strategies.motions("deg"))
        if draw(st.booleans()):
            cam = LinkageCam(link=3, point=tip, face=Roller(draw(st.floats(1e-6, 1e9))))
    mass = draw(st.lists(st.sampled_from([2, 3, 7]), unique=True))
    loads = LinkageLoads(
        gravity_m_s2=draw(st.floats(0.0, 1e15)),
        masses=tuple(LinkMass(link=n, mass_kg=draw(st.floats(0.0, 1e15)), centre_x_mm=draw(NUMBERS)) for n in mass),
        forces=tuple(LinkForce(link=3, point=tip, x_n=draw(NUMBERS)) for _ in range(draw(st.integers(0, 2)))),
    )
    name = draw(st.text(st.characters(exclude_categories=["Cs"]), min_size=1).filter(str.strip))
    design = Design(name, None, (Drive(motion, Linkage(links, (slider,), driver, branch), cam, loads),))
    known = sorted(all_paths(design))
    return replace(design, assumed=tuple(draw(st.lists(st.sampled_from(known), unique=True, max_size=4))))


@settings(max_examples=30, derandomize=True, database=None)
@given(linkages().filter(lambda d: not faults(d)))
def test_a_linkage_comes_back_from_its_file_to_the_last_bit(design: Design) -> None:
    text = project.dumps(design)
    again = project.loads(text)
    assert again == design
    assert repr(again) == repr(design), "the sign of zero too"
    assert project.dumps(again) == text
    assert project.from_table(project.to_table(design)) == design


def test_points_driver_and_branch_stand_on_one_line_each() -> None:
    text = project.dumps(project.load(EXAMPLES / f"{SIX}.toml"))
    assert 'driver = { link = 2, kind = "crank", speed_rpm = 60.0 }\n' in text
    assert "branch = { B = 1, D = 1 }\n" in text
    assert "points = { O2 = [0.0, 0.0], B = [40.0, 0.0], C = [60.0, 0.0] }\n" in text
    assert "[[linkage.sliders]]\nlink = 6\non = 1\nthrough = [0.0, 0.0]\nangle_deg = 0.0\n" in text
    assert "[loads]" not in project.dumps(project.load(EXAMPLES / "four_bar.toml")), "nothing to say"
    assert "[motion]" not in text


def test_a_drawing_whose_frame_holds_nothing_yet_is_saved_and_opened(tmp_path: Path) -> None:
    text = 'format = 1\nname = "New"\n\n[linkage]\ndrawn = {}\n\n[[linkage.links]]\nnumber = 1\npoints = {}\n'
    design = project.loads_drawing(text)
    assert project.save(design, tmp_path / "new.toml") == text
    assert project.load_drawing(tmp_path / "new.toml") == design


def test_a_motion_driver_need_not_say_its_speed() -> None:
    table = changed(TABLES[CAM], {"linkage.driver": {"link": 4, "kind": "motion"}})
    design = project.loads(tomli_w.dumps(table))
    assert design.drive.is_linkage
    assert design.drive.mechanism.driver.speed_rpm == 60.0


# -- faults -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("example", "edits", "expected"),
    [
        # kinds
        (SIX, {"drives": [{}]}, {"drives": "cannot be combined with linkage"}),
        (SIX, {"shaft": {}}, {"shaft.rotation": "missing", "shaft.speed_rpm": "missing"}),
        (SIX, {"format": 2, "name": " "}, {"format": "unknown format", "name": "empty"}),
        # the table
        (SIX, {"linkage": 3}, {"linkage": "must be a table"}),
        (SIX, {"linkage.extra": 3}, {"linkage.extra": "unknown key"}),
        (SIX, {"linkage.links": GONE}, {"linkage.links": "missing"}),
        (SIX, {"linkage.links": {}}, {"linkage.links": "must be a list of tables; allowed: [[linkage.links]]"}),
        (SIX, {"linkage.links[2]": 5}, {"linkage.links[2]": "must be a table"}),
        (SIX, {"linkage.links[2].number": GONE}, {"linkage.links[2].number": "missing; allowed: 1 ... 999"}),
        (SIX, {"linkage.links[2].number": 3.0}, {"linkage.links[2].number": "must be a whole number"}),
        (SIX, {"linkage.links[2].number": True}, {"linkage.links[2].number": "must be a whole number"}),
        (SIX, {"linkage.links[2].number": 4}, {"linkage.links[3].number": "given twice",
                                               "loads.masses[1].link": "no such moving link"}),
        (SIX, {"linkage.links[0].number": 9}, {"linkage.links": "no frame; allowed: a link with number = 1",
                                               "linkage.sliders[0].on": "no such link"}),
        (SIX, {"linkage.links[2].extra": 3}, {"linkage.links[2].extra": "unknown key"}),
        # points
        (SIX, {"linkage.links[2].points": GONE}, {"linkage.links[2].points": "missing"}),
        (SIX, {"linkage.links[2].points": [1.0]}, {"linkage.links[2].points": "must be a table"}),
        (SIX, {"linkage.links[2].points.B": 4.0}, {"linkage.links[2].points.B": "must be two numbers; allowed: [x, y]"}),
        (SIX, {"linkage.links[2].points.B": [1.0, 2.0, 3.0]}, {"linkage.links[2].points.B": "must be two numbers"}),
        (SIX, {"linkage.links[2].points.B": [1.0, "x"]}, {"linkage.links[2].points.B": "must be a number"}),
        (SIX, {"linkage.links[2].points.B": [1.0, 1e10]}, {"linkage.links[2].points.B": "outside its range"}),
        (SIX, {"linkage.links[2].points.B": [math.nan, 0.0]}, {"linkage.links[2].points.B": "outside its range"}),
        (SIX, {"linkage.links[2].points": {"A": [0.0, 0.0], "B": [9.0, 0.0], "a,b": [1.0, 1.0]}},
         {"linkage.links[2].points": "no name of a point"}),
        (SIX, {"linkage.links[2].points.B": [0.0, 0.0]}, {"linkage.links[2].points.B": "coincides with A"}),
        (SIX, {"linkage.links[4].points.B": [5.0, 5.0]}, {"linkage.links[4].points": "two pins make them one body"}),
        # structure
        (SIX, {"linkage.links[5].points": {"E": [0.0, 0.0]}}, {"linkage": "mobility (Grübler) is not 1: the driver does not determine"}),
        (SIX, {"linkage.links[6]": {"number": 7, "points": {"Q": [0.0, 0.0]}}}, {"linkage.links[6]": "is joined to no other"}),
        (SIX, {"linkage.links[0].points.C": [10.0, 50.0]},
         {"linkage.links[3].points": "two pins make them one body"}),
        # sliders
        (SIX, {"linkage.sliders[0].link": 8}, {"linkage.sliders[0].link": "no such link; allowed: 1 | 2 | 3"}),
        (SIX, {"linkage.sliders[0].on": 6}, {"linkage.sliders[0].on": "a link cannot slide on itself"}),
        (SIX, {"linkage.sliders[0]": {"link": 1, "on": 6}}, {"linkage.sliders[0].link": "the frame does not slide"}),
        (SIX, {"linkage.sliders[0].angle_deg": 400.0}, {"linkage.sliders[0].angle_deg": "outside its range; allowed: -360 ... 360 °"}),
        (SIX, {"linkage.sliders[0].through": [0.0]}, {"linkage.sliders[0].through": "must be two numbers"}),
        (SIX, {"linkage.sliders[0].angle": 0.0}, {"linkage.sliders[0].angle": "wrong unit; allowed: angle_deg"}),
        (SIX, {"linkage.sliders[1]": {"link": 6, "on": 4}}, {"linkage.sliders[1].link": "slides twice"}),
        # driver
        (SIX, {"linkage.driver": GONE}, {"linkage.driver": "missing"}),
        (SIX, {"linkage.driver.link": GONE}, {"linkage.driver.link": "missing"}),
        (SIX, {"linkage.driver.link": 9}, {"linkage.driver.link": "no such moving link; allowed: 2 | 3 | 4 | 5 | 6"}),
        (SIX, {"linkage.driver.link": 1}, {"linkage.driver": "missing"}),
        (SIX, {"linkage.driver.link": 3}, {"linkage.driver.link": "has no single pair with the frame"}),
        (SIX, {"linkage.driver.link": 6}, {"linkage.driver.kind": "link 6 slides on the frame; allowed: motion"}),
        (SIX, {"linkage.driver.kind": "crnk"}, {"linkage.driver.kind": "did you mean 'crank'?"}),
        (SIX, {"linkage.driver.kind": GONE}, {"linkage.driver.kind": "missing; allowed: crank | motion"}),
        (SIX, {"linkage.driver.speed_rpm": GONE}, {"linkage.driver.speed_rpm": "missing"}),
        (SIX, {"linkage.driver.speed_rpm": 0.0}, {"linkage.driver.speed_rpm": "must not be 0"}),
        (SIX, {"linkage.driver.speed_rpm": "fast"}, {"linkage.driver.speed_rpm": "must be a number"}),
        (SIX, {"linkage.driver.kind": "motion"}, {"motion": "missing; allowed: a table [motion] that the driver follows"}),
        # branches
        (SIX, {"linkage.branch.B": 2}, {"linkage.branch.B": "allowed"}),
        (SIX, {"linkage.branch.B": 0}, {"linkage.branch.B": "no side; allowed: 1 | -1"}),
        (SIX, {"linkage.branch.B": "left"}, {"linkage.branch.B": "no side"}),
        (SIX, {"linkage.branch.A": 1}, {"linkage.branch.A": "no joint with two sides; allowed: B | D"}),
        (SIX, {"linkage.branch": [1]}, {"linkage.branch": "must be a table"}),
        (INVERTED, {"linkage.branch": {"4": 1}}, {"linkage.branch.4": "no joint with two sides; allowed: 3"}),
        # motion, cam, loads
        (SIX, {"motion": TABLES[CAM]["motion"]}, {"motion": "no driver follows it"}),
        (CAM, {"motion.start_deg": GONE}, {"motion.start_deg": "missing"}),
        (CAM, {"motion.start_deg": GONE, "motion.start_mm": 3.0}, {"motion.start_mm": "wrong unit; allowed: start_deg"}),
        (LIFT, {"motion.segments[1].rise_mm": -140.0}, {"motion.segments": "rises add up to 10 mm"}),
        (CAM, {"cam.link": 9}, {"cam.link": "no such moving link; allowed: 2 | 3 | 4"}),
        (CAM, {"cam.point": "X"}, {"cam.point": "link 3 has no such point; allowed: A | B | C"}),
        (CAM, {"cam.point": 3}, {"cam.point": "must be text"}),
        (CAM, {"cam.roller_radius_mm": 0.0}, {"cam.roller_radius_mm": "outside its range"}),
        (CAM, {"cam.base_radius_mm": 50.0}, {"cam.base_radius_mm": "unknown key"}),
        (SIX, {"cam": TABLES[CAM]["cam"]}, {"cam": "a cam needs a motion", "cam.point": "no such point"}),
        (CRANK, {"loads.masses[0].link": 1}, {"loads.masses[0].link": "outside its range"}),
        (CRANK, {"loads.masses[0].link": 4}, {"loads.masses[1].link": "has its mass already, in another row"}),
        (CRANK, {"loads.masses[0].mass": 4}, {"loads.masses[0].mass": "wrong unit"}),
        (CRANK, {"loads.masses[0].centre": 4}, {"loads.masses[0].centre": "must be two numbers"}),
        (CRANK, {"loads.forces[0].point": "Q"}, {"loads.forces[0].point": "link 4 has no such point; allowed: B"}),
        (CRANK, {"loads.friction": 0.1}, {"loads.friction": "unknown key"}),
        # assumed
        (SIX, {"assumed": ["linkage.links[0].points.O1", "linkage.links[9].points"]}, {"assumed[1]": "no such entry"}),
        (SIX, {"assumed": 3}, {"assumed": "must be a list of field paths"}),
        (SIX, {"assumed": ["motion.start_deg"]}, {"assumed[0]": "no such entry"}),
    ],
)  # fmt: skip
def test_faults(example: str, edits: dict[str, Any], expected: dict[str, str]) -> None:
    """These and no others; each line holds its phrase."""
    lines = told(changed(TABLES[example], edits))
    # what loses its table may be assumed
    lines = {path: line for path, line in lines.items() if not path.startswith("assumed") or "assumed" in edits}
    assert set(lines) == set(expected), lines
    for path, phrase in expected.items():
        assert phrase in lines[path]


def test_many_faults_are_told_at_once() -> None:
    lines = told(
        changed(
            TABLES[SIX],
            {
                "linkage.links[2].points.B": [1.0],
                "linkage.links[3].numbr": 4,
                "linkage.sliders[0].angle_deg": "x",
                "linkage.driver.speed_rpm": 0.0,
                "linkage.branch.B": 5,
                "loads": {"gravity_m_s2": -1.0},
                "assumed": [],
                "nmae": "x",
            },
        )
    )
    assert set(lines) == {
        "linkage.links[2].points.B",
        "linkage.links[3].numbr",
        "linkage.sliders[0].angle_deg",
        "linkage.driver.speed_rpm",
        "linkage.branch.B",
        "loads.gravity_m_s2",
        "nmae",
    }


def test_parts_that_are_held_too_fast_and_too_loosely_are_named() -> None:
    """Mobility 1 in all, but links 5, 6 make a rigid frame and link 7 hangs loose."""
    links = (
        *project.load(EXAMPLES / "four_bar.toml").drive.mechanism.links,
        Link(5, (LinkPoint("P", 0.0, 0.0), LinkPoint("Q", 10.0, 0.0))),
    )
    frame = replace(
        links[0],
        points=(*links[0].points, LinkPoint("P", 200.0, 0.0), LinkPoint("Q", 210.0, 0.0), LinkPoint("R", 0.0, 50.0)),
    )
    loose = Link(6, (LinkPoint("R", 0.0, 0.0), LinkPoint("S", 10.0, 0.0)))
    more = Link(7, (LinkPoint("S", 0.0, 0.0), LinkPoint("T", 10.0, 0.0)))
    design = Design(
        "odd", None, (Drive(None, Linkage((frame, *links[1:], loose, more), (), Driver(2)), None, LinkageLoads()),)
    )
    told_faults = {f.path: str(f) for f in faults(design)}
    assert "linkage.links[4].points" in told_faults or "linkage" in told_faults


@settings(max_examples=50, derandomize=True, database=None)
@given(st.data())
def test_any_damage_is_told(data: st.DataObject) -> None:
    table = copy.deepcopy(TABLES[data.draw(st.sampled_from(NAMES))])
    for _ in range(data.draw(st.integers(1, 4))):
        damage(table, data)
    told_or_sound(table)


# -- values by path ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_every_entry_is_found_and_put_by_its_path(name: str) -> None:
    design = project.load(EXAMPLES / f"{name}.toml")
    seen = set()
    for section in SECTIONS:
        for entry in entries(design, section):
            assert entry.path not in seen
            seen.add(entry.path)
            assert get(design, entry.path) == entry.value
            if isinstance(entry.value, float):
                moved = put(design, entry.path, entry.value + 1.0)
                assert get(moved, entry.path) == entry.value + 1.0
                assert put(moved, entry.path, entry.value) == design
    assert any(path.endswith(".points.A.x_mm") or path.endswith(".points.B.x_mm") for path in seen)


def test_points_and_lines_are_pairs_by_path() -> None:
    design = project.load(EXAMPLES / f"{SIX}.toml")
    moved = edited(design, "linkage.links[3].points.C", (61.0, 2.0))
    assert get(moved, "linkage.links[3].points.C") == (61.0, 2.0)
    assert moved.drive.mechanism.by_number[4].places["C"] == 61.0 + 2.0j
    lifted = edited(moved, "linkage.sliders[0].through", (0.0, 5.0))
    assert get(lifted, "linkage.sliders[0].through") == (0.0, 5.0)
    other = edited(lifted, "linkage.branch.B", -1)
    assert other.drive.mechanism.sides == {"B": -1, "D": 1}
    assert edited(other, "name", "another").name == "another"
    assert get(other, "linkage.branch.D") == 1


def test_a_motions_segments_keep_the_turn_whole() -> None:
    """A longer segment takes its span from the next, a changed rise is given back."""
    design = project.load(EXAMPLES / f"{CAM}.toml")
    longer = edited(design, "motion.segments[0].span_deg", 70.0)
    assert [s.span_deg for s in longer.drive.motion.segments] == [70.0, 90.0, 60.0, 140.0]
    higher = edited(longer, "motion.segments[1].rise_deg", 15.0)
    assert [s.rise for s in higher.drive.motion.segments] == [0.0, 15.0, 0.0, -15.0]
    assert [s.rise for s in edited(higher, "motion.stroke_deg", 30.0).drive.motion.segments] == [0.0, 30.0, 0.0, -30.0]
    assert faults(higher) == []


def test_what_is_assumed_keeps_the_order_of_the_file() -> None:
    design = replace(project.load(EXAMPLES / f"{CAM}.toml"), assumed=())
    for path in ("loads.forces[0].y_n", "linkage.links[2].points", "motion.start_deg"):
        design = with_assumed(design, path, True)
    assert design.assumed == ("motion.start_deg", "linkage.links[2].points", "loads.forces[0].y_n")
    assert with_assumed(design, "linkage.links[2].points", False).assumed == ("motion.start_deg", "loads.forces[0].y_n")
    assert project.loads(project.dumps(design)) == design


def test_what_is_assumed_of_a_curve_may_outlive_its_law() -> None:
    """Another law leaves the mark where it is; the file still is read."""
    design = with_assumed(project.load(EXAMPLES / f"{CAM}.toml"), "motion.segments[1].crossover", True)
    design = edited(design, "motion.segments[1].law", "scca")
    assert "motion.segments[1].crossover" in design.assumed
    assert project.loads(project.dumps(design)) == design
    lines = told(changed(project.to_table(design), {"assumed": ["motion.segments[1].crossing"]}))
    assert set(lines) == {"assumed[0]"}


@pytest.mark.parametrize(
    "path",
    [
        "linkage.links[9].number",
        "linkage.links[0].points.X",
        "linkage.nothing",
        "shaft.speed_rpm",
        "motion.start_deg",
        "x",
        "",
    ],
)
def test_a_path_that_leads_nowhere_says_so(path: str) -> None:
    design = project.load(EXAMPLES / f"{SIX}.toml")
    with pytest.raises(KeyError):
        get(design, path)
    with pytest.raises(KeyError):
        put(design, path, 1.0)
