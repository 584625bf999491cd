"""What a file of Linkage or an address of PMKS+ says besides its joints: layers, names, inputs by hand and to and fro, slots, ranges."""

from pathlib import Path

import pytest
from all_loops import Model, address, linkage2

from core.__main__ import main
from core.design import MOTION, faults
from core.errors import DesignError
from core.linkage_programs import LinkageImport, read_linkage
from core.project import load_drawing
from core.study import Study

PIXEL = 25.4 / 96.0  # mm
BAR = Model(
    at={"O": 0j, "A": 60 + 40j, "B": 250 + 190j, "C": 300 - 10j},
    links={"crank": ("O", "A"), "coupler": ("A", "B"), "rocker": ("B", "C")},
    anchors=("O", "C"),
)
SLIDER = Model(
    at={"O": 0j, "A": 60 + 40j, "S": 250 + 0j, "L": 200 + 0j, "R": 400 + 0j},
    links={"crank": ("O", "A"), "rod": ("A", "S")},
    anchors=("O", "L", "R"),
    slots={"S": ("frame", "L", "R", 0.0)},
)
TURNS = {"O": 'input="true" rpm="30"'}
BARS = [("YR", "AB", "AB"), ("YR", "BC", "BC"), ("YR", "CD", "CD")]
GROUNDED, INPUT, SLIDES = 4, 2, 1


def listed(made: LinkageImport) -> dict[str, str]:
    return {each.what: each.why for each in made.left_out}


def slotted(flags: int, *slot: str) -> str:
    """A crank whose pin carries a block in the slot of an arm; slot: what the address says of it."""
    rows = [
        (GROUNDED | INPUT * (flags == SLIDES), "A", 0j, 0), (0, "B", 1.5 + 0.5j, 0), (flags, "S", 1.5 + 0.5j, 1, *slot),
        (GROUNDED, "D", -4j, 0), (0, "E", 2.1 + 2.3j, 0),
    ]  # fmt: skip
    return address(rows, [("YR", "AB", "AB"), ("YP", "BS", "BS"), ("YR", "DE", "DE")])


@pytest.mark.parametrize(("layer", "links"), [("16", 4), ("17", 4), ("0", 4), ("32", 4), ("4294967295", 4), ("1", 3)])
def test_a_link_is_of_the_mechanism_where_one_of_its_layers_is(layer: str, links: int) -> None:
    made = read_linkage(linkage2(BAR, TURNS).replace('<Link id="2" layer="16"', f'<Link id="2" layer="{layer}"'))
    assert made.links == links


def test_names_are_read_as_linkage_writes_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Not escaped, repeated, blank, in the letters of Windows, attributes without a blank between them."""
    flags = {"O": 'input="true" rpm="30"', "A": 'name="Kurbel & Käfer"', "B": 'name="Kurbel & Käfer"', "C": 'name=" "'}
    text = linkage2(BAR, flags).replace('" x="', '"x="')
    (tmp_path / "bar.linkage2").write_bytes(text.encode("cp1252"))
    assert main(["linkage-from", str(tmp_path / "bar.linkage2"), "--out", str(tmp_path / "bar.toml")]) == 0
    assert "left out" not in capsys.readouterr().out
    linkage = load_drawing(tmp_path / "bar.toml").drive.linkage
    assert linkage.drawn.places.keys() == {"Kurbel___Käfer", "Kurbel___Käfer_2"}
    assert linkage.by_number[1].places.keys() == {"C0", "C3"}


def test_dots_of_one_connector_and_slots_without_ends_are_no_loose_links() -> None:
    model = Model(**vars(BAR) | {"links": BAR.links | {"dot": ("B",), "pin": ("C",)}})
    slider = {"A": 'slider="true"'}
    made = read_linkage(linkage2(model, TURNS | slider))
    assert made.links == 4
    assert faults(made.design) == []
    assert listed(made) == {"slot of C1": "it has no two limits: the joint is free"}
    apart = Model(**vars(BAR) | {"slots": {"B": ("", "A", "C", 0.0)}})  # no link has both ends
    assert listed(read_linkage(linkage2(apart, TURNS))) == {
        "slot of C2": "its two limits are on no common link: the joint is free"
    }


def test_what_turns_by_hand_or_to_and_fro_beside_another_is_said() -> None:
    hand = read_linkage(linkage2(BAR, {"O": TURNS["O"] + ' alwaysmanual="true"'}))
    assert listed(hand) == {"input at C0": "operated by hand in the file: driven at the speed in it"}
    five = Model(
        at=BAR.at | {"D": 330 - 60j},
        links={"crank": ("O", "A"), "coupler": ("A", "B"), "rocker": ("B", "C"), "second": ("C", "D")},
        anchors=("O", "D"),
    )
    swing = {"O": 'input="true" rpm="30" limitangle="40"', "D": 'input="true" rpm="-15"'}
    made = read_linkage(linkage2(five, swing))
    linkage = made.design.drive.linkage
    assert (linkage.driver.speed_rpm, [row.ratio for row in linkage.drivers]) == (15.0, [0.0])
    assert listed(made) == {"motion of C0": "its cycle differs from that of C4: it is at rest"}
    both = {
        "O": 'input="true" rpm="30" limitangle="40" startoffset="10"',
        "D": 'input="true" rpm="-15" limitangle="20" startoffset="5"',
    }
    made = read_linkage(linkage2(five, both))
    assert made.design.drive.linkage.driver.kind == MOTION
    assert [row.ratio for row in made.design.drive.linkage.drivers] == [-0.5]
    assert faults(made.design) == []
    bars = read_linkage(linkage2(BAR, TURNS, {"coupler": 'actuator="true" throw="5"', "rocker": 'actuator="true"'}))
    assert listed(bars) == {
        "actuator 1": "another input drives: it is a bar of its drawn length", "actuator 2": "it has no throw: it is a bar",
    }  # fmt: skip


def test_an_assumed_driver_is_listed() -> None:
    assert "input" not in listed(read_linkage(linkage2(BAR, TURNS)))
    made = read_linkage(linkage2(BAR, {}))
    assert made.design.drive.linkage.driver.speed_rpm == 60.0
    assert listed(made) == {"input": "not in the text: C0, on the frame, is driven instead, at 60 rpm"}


def test_a_path_that_is_shown_is_no_slot_and_gravity_may_be_off() -> None:
    rows = [(22, "A", 0j, 0), (16, "B", 2j, 0), (16, "C", 5 + 4j, 0), (20, "D", 6 + 0j, 0)]
    text = address(rows, BARS)
    assert read_linkage(text).left_out == ()
    assert read_linkage(text).design.drive.loads.gravity_m_s2 == 9.80665
    weightless = text.replace("00.Fe", "40.Fe", 1)  # flag 8
    assert read_linkage(weightless).design.drive.loads.gravity_m_s2 == 0.0


def test_an_input_at_a_slide_or_a_moving_pin_drives_there() -> None:
    grounded = address(
        [(GROUNDED, "A", 0j, 0), (0, "B", 1.2 + 0.5j, 0), (0, "C", 5 + 0j, 0), (7, "S", 5 + 0j, 0)],
        [("YR", "AB", "AB"), ("YR", "BC", "BC"), ("YP", "CS", "CS")],
    )
    for text in (grounded, slotted(INPUT | SLIDES, "DE", "D", "E")):
        made = read_linkage(text)
        driver = made.design.drive.linkage.driver
        slider = next(row for row in made.design.drive.linkage.sliders if row.link == driver.link)
        assert (driver.kind, driver.on, made.inputs) == (MOTION, slider.on, ("S",))
        assert "assumed" in listed(made)["motion of S"]
        assert "motion.segments[1].rise_mm" in made.design.assumed
        study = Study(made.design, 36)
        assert abs(study.linkage.motion.displacement[0]).max() > 1e-3
        assert study.linkage.residual.max() < 1e-12
    inner = address(
        [(GROUNDED, "A", 0j, 0), (INPUT, "B", 3 + 4j, 0), (0, "C", 4.5 + 4j, 0), (GROUNDED, "D", 6 + 0j, 0)], BARS
    )
    made = read_linkage(inner)
    assert (made.design.drive.linkage.driver.on, made.inputs, made.could_drive) == (2, ("B",), ("A", "B", "D"))


@pytest.mark.parametrize(
    "slot", [("DE",), ("DE", "D"), ("DE", "", "E"), ("DE", "D", "D"), ("DE", "D", "A"), ("XY", "D", "E")]
)
def test_half_a_slot_is_refused(slot: tuple[str, ...]) -> None:
    assert faults(read_linkage(slotted(SLIDES, "DE", "D", "E")).design) == []
    with pytest.raises(
        DesignError, match=r"slot of joint S: .*; allowed: none, or a link and two of its joints"
    ) as refused:
        read_linkage(slotted(SLIDES, *slot))
    assert "\n" not in str(refused.value)


DRAWING = linkage2(BAR).replace('layer="16"', 'layer="1"')
REFUSED = {
    "2023": ("https://app.pmksplus.com/?j=A,0,0,,RP;B,1,1,,R&l=AB,1,1,0&f=", "2023"),
    "drawing only": (DRAWING, "no mechanism"),
    "nothing": ("<linkage2/>", "no mechanism"),
    "frame only": ("M[J[R, P[0, 0], L[ground]]]", "no mechanism"),
    "far": (linkage2(BAR, TURNS).replace('x="250.0"', 'x="2.5e300"'), "joint C2: x"),
    "near the end of numbers": (linkage2(BAR, TURNS).replace('x="250.0"', 'x="-1.7e308"'), "joint C2: x"),
    "speed": (linkage2(BAR, {"O": 'input="true" rpm="1e7"'}), "joint C0: linkage.driver.speed_rpm"),
    "swing": (linkage2(BAR, {"O": TURNS["O"] + ' limitangle="1e-9"'}), "joint C0: linkage.driver.speed_rpm"),
    "stroke": (linkage2(BAR, {}, {"crank": 'actuator="true" throw="1e20"'}), "actuator 0: motion"),
    "arc": (linkage2(Model(**vars(SLIDER) | {"slots": {"S": ("frame", "L", "R", 1e200)}}), TURNS), "joint C2_centre"),
    "nested": ("<linkage2>" + "<a>" * 100, "nested"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_no_design_can_hold_is_refused_with_the_joint(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, said = REFUSED[name]
    (tmp_path / "file").write_text(text, "utf-8")
    assert main(["linkage-from", str(tmp_path / "file"), "--out", str(tmp_path / "out.toml")]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "out.toml").exists()


def test_wheels_whose_sizes_are_absurd_and_pins_at_one_place_are_read() -> None:
    model = Model(
        **vars(BAR) | {"at": BAR.at | {"B2": BAR.at["B"]}, "links": BAR.links | {"coupler": ("A", "B", "B2")}}
    )
    ratios = '<ratio type="gears"><link id="0" size="1e-300"/><link id="2" size="1e300"/></ratio>'
    made = read_linkage(linkage2(model, TURNS, ratios=ratios))
    assert listed(made) == {"gears of link0 and link2": "their sizes differ 1e+06 times or more"}
    assert faults(made.design) == []
