"""Linkages drawn by edits alone: what comes out is what a file would say, and every other number stays as typed."""

import cmath
import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from linkages import four_bar, link

from core.design import (
    NO_DRIVER,
    Attachment,
    Design,
    Drive,
    LinkageLoads,
    LinkMass,
    Slider,
    faults,
    with_drive,
    with_new_row,
)
from core.errors import DesignError, NoPosition
from core.mechanism.drawing_edits import (
    empty_linkage,
    with_driving_link,
    with_ground,
    with_joined,
    with_length,
    with_link,
    with_mirrored,
    with_moved,
    with_name,
    with_pin,
    with_slider,
    with_split,
    with_traced_point,
    with_welded,
    without,
)
from core.mechanism.drawing_references import part_of, with_part
from core.mechanism.drawing_targets import DrawingTarget
from core.mechanism.drawn import assembled, link_pose, point_positions, with_positions
from core.mechanism.drivers import with_roller
from core.project import dumps, loads

SHEET = Design("sheet", None, (Drive(None, empty_linkage(), None, LinkageLoads()),))


def drawn_four_bar() -> Design:
    """By four tools: two pivots, three bars, a driver; coordinates of a grid."""
    design = with_ground(with_ground(SHEET, DrawingTarget(0j)), DrawingTarget(100 + 0j))
    design = with_link(design, [DrawingTarget(0j, "O1"), DrawingTarget(0 + 30j)])
    design = with_link(design, [DrawingTarget(0 + 30j, "A"), DrawingTarget(80 + 70j)])
    design = with_link(design, [DrawingTarget(80 + 70j, "B"), DrawingTarget(100 + 0j, "O2")])
    return with_driving_link(design, 2)


def shape(design: Design, number: int) -> dict[str, complex]:
    return dict(design.drive.linkage.by_number[number].places)


def open_by(design: Design) -> float:
    """How far any point is from where any of its links has it [mm]."""
    linkage = design.drive.linkage
    places = point_positions(linkage)
    worst = 0.0
    for each in linkage.links:
        origin, axis = link_pose(linkage, each.number, places)
        worst = max([worst, *(abs(origin + at * axis - places[name]) for name, at in each.places.items())])
    return worst


def test_bars_between_clicks_are_the_links_of_a_file() -> None:
    design = drawn_four_bar()
    assert shape(design, 1) == {"O1": 0j, "O2": 100 + 0j}
    assert shape(design, 2) == {"O1": 0j, "A": 30 + 0j}
    assert shape(design, 3) == {"A": 0j, "B": pytest.approx(math.hypot(80, 40), abs=1e-9)}
    assert shape(design, 4) == {"B": 0j, "O2": pytest.approx(math.hypot(20, 70), abs=1e-9)}
    linkage = design.drive.linkage
    assert linkage.drawn is not None
    assert linkage.drawn.driver_deg == 90.0
    assert linkage.drawn.places == {"A": 30j, "B": 80 + 70j}
    assert open_by(design) < 1e-8


def test_a_bar_of_a_typed_length_has_every_digit() -> None:
    typed = 68.97436047612022
    design = with_link(SHEET, [DrawingTarget(0j), DrawingTarget(cmath.rect(typed, 0.3))], length_mm=typed)
    assert shape(design, 2) == {"A": 0j, "B": typed + 0j}


def test_a_click_on_a_bar_makes_it_a_plate_with_a_pin() -> None:
    design = drawn_four_bar()
    design = with_link(design, [DrawingTarget(40 + 50j, link=3), DrawingTarget(40 + 90j)])
    assert shape(design, 3)["C"] == pytest.approx(math.hypot(40, 20), abs=1e-9)
    assert shape(design, 5) == {"C": 0j, "D": 40 + 0j}


def test_two_pins_between_two_links_are_refused() -> None:
    design = with_link(SHEET, [DrawingTarget(0j), DrawingTarget(50 + 0j)])
    with pytest.raises(DesignError, match="twice"):
        with_link(design, [DrawingTarget(0j, "A"), DrawingTarget(50 + 0j, "B")])
    with pytest.raises(DesignError, match="two different points"):
        with_link(design, [DrawingTarget(0j, "A"), DrawingTarget(0j)])


def test_a_place_within_a_millionth_of_a_pin_is_that_pin() -> None:
    """By every edit that adds a place; a millionth further away it is another one."""
    design, near, away = drawn_four_bar(), 80 + 70j + 9e-7j, 80 + 70j + 2e-6j
    assert list(shape(with_link(design, [DrawingTarget(0 + 99j), DrawingTarget(near)]), 5)) == ["C", "B"]
    assert list(shape(with_link(design, [DrawingTarget(0 + 99j), DrawingTarget(away)]), 5)) == ["C", "D"]
    assert list(shape(with_slider(design, DrawingTarget(near), 0 + 70j, 0.0), 5)) == ["B"]
    bar = with_link(SHEET, [DrawingTarget(0j), DrawingTarget(80 + 70j)])
    assert shape(with_ground(bar, DrawingTarget(near)), 1) == {"B": 80 + 70j}
    assert with_pin(design, DrawingTarget(near)) == design
    with pytest.raises(DesignError, match="away from its pins"):
        with_traced_point(design, DrawingTarget(near, link=3))
    twice = with_link(
        with_link(SHEET, [DrawingTarget(0j), DrawingTarget(40j)]), [DrawingTarget(40j), DrawingTarget(1j)]
    )
    assert list(shape(twice, 3)) == ["B", "C"]


def test_a_place_on_the_line_of_a_bar_is_on_that_bar() -> None:
    """A bar, a pivot, or a block; but not a second point of the new link on the same bar, nor off the end of the bar."""
    design = drawn_four_bar()
    design = with_link(design, [DrawingTarget(40 + 50j + 5e-7j), DrawingTarget(40 + 99j)])
    assert shape(design, 3)["C"] == pytest.approx(math.hypot(40, 20), abs=1e-6)
    assert list(shape(design, 5)) == ["C", "D"]
    assert "E" not in shape(with_link(design, [DrawingTarget(96 + 84j), DrawingTarget(60 + 99j)]), 3)
    assert "E" in shape(with_ground(design, DrawingTarget(20 + 40j)), 1)
    assert "O3" not in shape(with_ground(design, DrawingTarget(0 + 10j)), 2)
    assert "E" in shape(with_slider(design, DrawingTarget(0 + 10j), 10j, 0.0), 2)
    along = with_link(design, [DrawingTarget(80 + 70j, "B"), DrawingTarget(20 + 40j)])
    assert list(shape(along, 6)) == ["B", "E"]
    assert "E" not in shape(along, 3)


def test_a_point_that_is_moved_onto_a_pin_joins_it() -> None:
    design = with_link(drawn_four_bar(), [DrawingTarget(0 + 99j), DrawingTarget(50 + 99j)])
    joined = with_moved(design, {"D": 80 + 70j + 5e-7j})
    assert list(shape(joined, 5)) == ["C", "B"]
    assert list(shape(with_moved(design, {"D": 100 + 0j}), 5)) == ["C", "O2"]
    apart = with_split(joined, "B")
    assert set(point_positions(with_moved(apart, {"A": 5 + 30j, "B": 80 + 70j}).drive.linkage)) >= {"B", "D"}
    with pytest.raises(DesignError, match="coincide"):
        with_moved(design, {"C": 50 + 99j})


def test_a_pin_that_waits_is_taken_up_by_the_link_that_comes() -> None:
    design = with_pin(SHEET, DrawingTarget(10 + 10j))
    assert len(design.drive.linkage.links) == 2
    design = with_link(design, [DrawingTarget(10 + 10j, "A"), DrawingTarget(50 + 10j)])
    assert [each.number for each in design.drive.linkage.links] == [1, 3]
    fixed = with_ground(with_pin(SHEET, DrawingTarget(10 + 10j)), DrawingTarget(10 + 10j, "A"))
    assert [each.number for each in fixed.drive.linkage.links] == [1]
    assert shape(fixed, 1) == {"A": 10 + 10j}


def test_a_block_slides_on_the_frame_or_on_a_link() -> None:
    design = with_link(with_ground(SHEET, DrawingTarget(0j)), [DrawingTarget(0j, "O1"), DrawingTarget(30j)])
    design = with_link(design, [DrawingTarget(30j, "A"), DrawingTarget(120 + 0j)])
    on_frame = with_slider(design, DrawingTarget(120 + 0j, "B"), 0j, 0.0)
    assert on_frame.drive.linkage.sliders == (Slider(link=4, on=1, through_x_mm=0.0, through_y_mm=0.0, angle_deg=0.0),)
    assert shape(on_frame, 4) == {"B": 0j}
    axis = complex(120, -30) / abs(complex(120, -30))
    on_rod = with_slider(design, DrawingTarget(60 + 15j), 60 + 15j, math.degrees(cmath.phase(axis)), on=3)
    (slider,) = on_rod.drive.linkage.sliders
    assert (slider.link, slider.on, slider.angle_deg) == (4, 3, pytest.approx(0.0, abs=1e-9))
    assert slider.through_x_mm == pytest.approx(abs(complex(60, -15)), abs=1e-9)


def test_only_what_is_moved_changes_its_numbers() -> None:
    design = drawn_four_bar()
    moved = with_moved(design, {"B": 90 + 60j})
    assert shape(moved, 2) == shape(design, 2)
    assert shape(moved, 1) == shape(design, 1)
    assert shape(moved, 3)["B"] == pytest.approx(math.hypot(90, 30), abs=1e-9)
    assert open_by(moved) < 1e-8
    turned = with_moved(design, {"A": 30 + 0j})  # the crank is turned only: its length stays to the last digit
    assert shape(turned, 2) == shape(design, 2)
    assert turned.drive.linkage.drawn is not None
    assert turned.drive.linkage.drawn.driver_deg == 0.0


def test_what_slides_keeps_to_its_line_when_it_is_moved() -> None:
    design = with_slider(
        with_link(SHEET, [DrawingTarget(0j), DrawingTarget(50 + 20j)]), DrawingTarget(50 + 20j, "B"), 0 + 20j, 0.0
    )
    assert point_positions(with_moved(design, {"B": 70 + 45j}).drive.linkage)["B"] == 70 + 20j


def test_a_typed_length_is_exact_and_the_drawing_is_put_together_again() -> None:
    design = drawn_four_bar()
    for number, one, other, value in ((3, "A", "B", 90.0), (4, "B", "O2", 70.0)):
        design = assembled(with_length(design, number, one, other, value))
    assert shape(design, 3) == {"A": 0j, "B": 90 + 0j}
    assert abs(shape(design, 4)["O2"]) == 70.0
    assert shape(design, 2)["A"] == 30 + 0j
    assert open_by(design) < 1e-8
    assert design.drive.linkage.drawn is not None
    assert design.drive.linkage.drawn.driver_deg == 90.0
    with pytest.raises(NoPosition, match="do not meet"):
        assembled(with_length(design, 3, "A", "B", 900.0))


def test_pins_are_joined_and_split() -> None:
    design = with_ground(SHEET, DrawingTarget(0j))
    design = with_link(design, [DrawingTarget(0j, "O1"), DrawingTarget(40 + 0j)])
    design = with_link(design, [DrawingTarget(41 + 3j), DrawingTarget(90 + 0j)])
    joined = with_joined(design, "A", "B")
    assert point_positions(joined.drive.linkage) == {"O1": 0j, "A": 40 + 0j, "C": 90 + 0j}
    assert list(shape(joined, 3)) == ["A", "C"]
    assert shape(joined, 3)["C"] == 50 + 0j
    apart = with_split(joined, "A")
    assert point_positions(apart.drive.linkage)["B"] == 40 + 0j
    assert (list(shape(apart, 2)), list(shape(apart, 3))) == (["O1", "A"], ["B", "C"])
    with pytest.raises(DesignError, match="both on link 2"):
        with_joined(design, "O1", "A")


def test_welded_links_keep_their_places_and_their_mass() -> None:
    design = with_link(
        with_link(SHEET, [DrawingTarget(0j), DrawingTarget(60 + 0j)]),
        [DrawingTarget(60 + 0j, "B"), DrawingTarget(60 + 80j)],
    )
    masses = (LinkMass(link=2, mass_kg=1.0, inertia_kg_m2=0.1), LinkMass(link=3, mass_kg=3.0, inertia_kg_m2=0.2))
    design = with_drive(design, loads=LinkageLoads(masses=masses))
    before = point_positions(design.drive.linkage)
    welded = with_welded(design, 2, 3)
    assert shape(welded, 2) == pytest.approx({"A": 0j, "B": 60 + 0j, "C": 60 + 80j})
    assert point_positions(welded.drive.linkage) == pytest.approx(before)
    (mass,) = welded.drive.loads.masses
    assert (mass.mass_kg, mass.centre_x_mm, mass.centre_y_mm) == (4.0, 45.0, 0.0)
    # about the common centre, 45 mm from one mass and 15 mm from the other: both have theirs at their first point
    assert mass.inertia_kg_m2 == pytest.approx(0.1 + 0.2 + 1.0 * 0.045**2 + 3.0 * 0.015**2)


def test_what_is_taken_away_takes_its_loads_along() -> None:
    design = drawn_four_bar()
    design = with_new_row(design, "loads.masses", [Attachment(link=3, x_mm=1.0, y_mm=2.0)])
    design = with_new_row(design, "loads.masses", [Attachment(link=4, x_mm=1.0, y_mm=2.0)])
    design = replace(design, assumed=("loads.masses[0].mass_kg",))
    left = without(design, links=[3])
    assert [each.number for each in left.drive.linkage.links] == [1, 2, 4]
    assert [row.link for row in left.drive.loads.masses] == [4]
    assert [each.number for each in without(design, points=["B"]).drive.linkage.links] == [1, 2]
    assert without(design, points=["O2"]).drive.linkage.by_number[1].places == {"O1": 0j}


def led_by_a_slide(links: str = "", sliders: str = "", rest: str = "") -> Design:
    """A slider-crank that its block drives, with more links and lines."""
    return loads(
        f"""
format = 1
name = "slides"
[motion]
start_mm = 10.0
segments = [{{ law = "cycloidal", span_deg = 180.0, rise_mm = 20.0 }}, {{ law = "cycloidal", span_deg = 180.0, rise_mm = -20.0 }}]
[linkage]
driver = {{ link = 2, kind = "motion", speed_rpm = 60.0 }}
drawn = {{ driver_mm = 10.0, A = [10, 0], B = [60, 40] }}
links = [
    {{ number = 1, points = {{ O4 = [90, 0] }} }}, {{ number = 2, points = {{ A = [0, 0] }} }},
    {{ number = 3, points = {{ A = [0, 0], B = [64.03, 0] }} }}, {{ number = 4, points = {{ O4 = [0, 0], B = [50, 0] }} }}, {links}
]
sliders = [{{ link = 2, on = 1 }}, {sliders}]
{rest}""",
        unfinished=True,
    )


def blocks_on_blocks() -> Design:
    links = "{ number = 5, points = { P = [0, 0] } }, { number = 6, points = { Q = [0, 0] } }, "
    links += "{ number = 7, points = { C = [0, 0], D = [60, 0] } }"
    sliders = "{ link = 5, on = 3, angle_deg = 20 }, { link = 6, on = 5, angle_deg = 70 }, { link = 7, on = 6, angle_deg = 10 }"
    return led_by_a_slide(links, sliders, '[[loads.pair_friction]]\npair = "6"\ncoefficient = 0.1\n')


@pytest.mark.parametrize(
    ("gone", "links", "sliding"),
    [(3, [1, 2, 4, 7], ["2"]), (5, [1, 2, 3, 4, 7], ["2"]), (6, [1, 2, 3, 4, 5, 7], ["2", "5"]), (2, [1, 3, 4, 5, 6, 7], ["5", "6", "7"])],
)  # fmt: skip
def test_what_slides_on_a_deleted_link_goes_with_it_down_the_chain(
    gone: int, links: list[int], sliding: list[str]
) -> None:
    """A block on a block is nothing by itself; a bar with two pins stays, without its line. The drawing can be saved and read."""
    drawn = blocks_on_blocks()
    left = without(drawn, links=[gone])
    linkage = left.drive.linkage
    assert [each.number for each in linkage.links] == links
    assert [str(each.link) for each in linkage.sliders] == sliding
    assert len(left.drive.loads.pair_friction) == ("6" in sliding)
    assert linkage.driver == (NO_DRIVER if gone == 2 else drawn.drive.linkage.driver)
    assert loads(dumps(left), unfinished=True) == left


def test_a_driver_that_slid_and_now_turns_has_no_motion_in_mm() -> None:
    slides = led_by_a_slide()
    assert faults(slides) == []
    turns = with_driving_link(slides, 4)
    assert turns.drive.motion is None
    assert turns.drive.linkage.driver.kind == "crank"
    assert faults(turns) == []
    back = with_driving_link(turns, 2)
    assert back.drive.motion is not None
    assert (back.drive.motion.unit, faults(back)) == ("mm", [])
    on_cam = with_roller(slides, 4, "B")
    led = with_driving_link(on_cam, 4)
    assert led.drive.motion is not None
    assert (led.drive.motion.unit, led.drive.linkage.driver.kind, faults(led)) == ("deg", "motion", [])


def test_a_name_is_changed_wherever_it_stands() -> None:
    design = with_drive(drawn_four_bar(), loads=LinkageLoads(masses=(LinkMass(link=2),)))
    design = with_new_row(design, "loads.forces", [Attachment(link=3, point="B")])
    named = with_name(design, "B", "Knee")
    assert {n for each in named.drive.linkage.links for n in each.places} == {"O1", "O2", "A", "Knee"}
    assert named.drive.loads.forces[0].point == "Knee"
    assert named.drive.linkage.drawn is not None
    assert "Knee" in named.drive.linkage.drawn.places
    for wrong in ("A", "2x", ""):
        with pytest.raises(DesignError):
            with_name(design, "B", wrong)


def test_copies_stand_beside_with_numbers_and_names_of_their_own() -> None:
    design = with_new_row(drawn_four_bar(), "loads.masses", [Attachment(link=3, x_mm=1.0, y_mm=2.0)])
    twice, links = with_part(design, part_of(design, [2, 3, 4]), 200 + 50j)
    assert links == (5, 6, 7)
    one, other = point_positions(design.drive.linkage), point_positions(twice.drive.linkage)
    assert {name: other[name] for name in one} == one
    assert sorted((at - (200 + 50j) for name, at in other.items() if name not in one), key=abs) == pytest.approx(
        sorted(one.values(), key=abs)
    )
    assert [row.link for row in twice.drive.loads.masses] == [3, 6]
    assert list(shape(twice, 6).values()) == list(shape(design, 3).values())


def test_mirrored_twice_is_what_it_was() -> None:
    design = with_traced_point(drawn_four_bar(), DrawingTarget(40 + 80j, link=3))
    once = with_mirrored(design, [2, 3, 4], 50 + 0j, 1j)
    assert point_positions(once.drive.linkage)["A"] == 100 + 30j
    assert point_positions(once.drive.linkage)["O1"] == 100 + 0j
    assert open_by(once) < 1e-8
    again = with_mirrored(once, [2, 3, 4], 50 + 0j, 1j)
    assert again.drive.linkage.links == design.drive.linkage.links


@settings(max_examples=60)
@given(st.lists(st.tuples(st.integers(0, 8), st.integers(-90, 90), st.integers(-90, 90)), min_size=1, max_size=12))
def test_whatever_is_drawn_stands_where_it_was_clicked(steps: list[tuple[int, int, int]]) -> None:
    """Bars, pivots, points, moves, splits and deletions in any order: every link has its points where they are drawn."""
    design = SHEET
    for kind, x, y in steps:
        linkage, at = design.drive.linkage, complex(x, y)
        places = point_positions(linkage)
        names, links = sorted(places), [each.number for each in linkage.links if each.number != 1]
        spot = (
            DrawingTarget(places[names[x % len(names)]], names[x % len(names)])
            if names and x % 2
            else DrawingTarget(at)
        )
        try:
            if kind < 4:
                design = with_link(design, [spot, DrawingTarget(spot.at + at)])
            elif kind == 4:
                design = with_ground(design, spot)
            elif kind == 5 and links:
                design = with_traced_point(design, DrawingTarget(at, link=links[x % len(links)]))
            elif kind == 6 and names:
                design = with_moved(design, {names[x % len(names)]: at})
            elif kind == 7 and names:
                design = with_split(design, names[x % len(names)])
            elif links:
                design = without(design, links=[links[x % len(links)]])
        except DesignError:
            continue
        assert open_by(design) < 1e-7, (kind, x, y)


def test_a_design_with_signs_is_drawn_from_where_it_stands() -> None:
    design = with_positions(four_bar(100, 30, 90, 70), {"A": 30j, "B": 80 + 70j})
    assert design.drive.linkage.branch == ()
    assert design.drive.linkage.links == four_bar(100, 30, 90, 70).drive.linkage.links
    assert link(3, A=(0, 0), B=(90, 0)) in design.drive.linkage.links
