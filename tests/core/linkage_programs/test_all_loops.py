"""Files of Linkage and addresses of PMKS+ open at their size and turn their way: against Newton's method on all loop equations."""

import math

import numpy as np
import pytest
from all_loops import FRAME, Model, address, linkage2, triangle

from core.design import MOTION, faults
from core.linkage_programs import read_linkage
from core.study import Study

PIXEL = 25.4 / 96.0  # mm


def turned(rpm):
    """Turn [rad] over time [s] of an input of Linkage: a positive speed is clockwise."""
    return lambda time: -rpm * 2.0 * math.pi / 60.0 * time


def positions(made, names, times):
    """Positions [mm] of points of an imported design at times [s] since it stood as drawn."""
    study, driver = Study(made.design, 36), made.design.drive.linkage.driver
    drawn = made.design.drive.linkage.drawn
    turn = driver.speed_rpm * 2.0 * math.pi / 60.0 * times
    theta = turn if driver.kind == MOTION else (turn + math.radians(drawn.driver_deg or 0.0)) / study.turns
    kinematics = study.at_theta(np.mod(theta, 2.0 * math.pi)).linkage
    return {name: kinematics.bodies[kinematics.body_of(name)].position(name) * 1e3 for name in names}


def compare(model, text, seconds, size, tolerance, named, steps=90):
    made = read_linkage(text)
    assert faults(made.design) == []
    times = np.linspace(0.0, seconds, steps, endpoint=False)
    reference = model.solved(times)
    points = {name for link in made.design.drive.linkage.links for name in link.places}
    compared = [joint for joint in reference if named(joint) in points]
    moving = [joint for joint in compared if np.ptp(np.abs(reference[joint] - reference[joint][0])) > 1e-3]
    assert moving
    here = positions(made, [named(joint) for joint in compared], times)
    for joint in compared:
        assert np.abs(here[named(joint)] - size * reference[joint]).max() < tolerance, joint
    return made


FOUR_BAR = Model(
    at={"O": 0j, "A": 60 + 40j, "B": 250 + 190j, "C": 300 - 10j, "P": 180 + 260j},
    links={"crank": ("O", "A"), "coupler": ("A", "B", "P"), "rocker": ("B", "C")},
    anchors=("O", "C"),
    turning={"O": (turned(20.0), "crank", FRAME)},
)
WHITWORTH = Model(
    at={"O": 0j, "A": 90 + 0j, "C": 0 - 150j, "D": 0 + 0j + 162 + 120j},
    links={"crank": ("O", "A"), "arm": ("C", "D")},
    anchors=("O", "C"),
    slots={"A": ("arm", "C", "D", 0.0)},
    turning={"O": (turned(-12.0), "crank", FRAME)},
)
_ON_ARM = 0.55  # of the arm: where a pin of the frame is in its slot
HELD = Model(  # the slot of the coupler runs over a pin of the frame
    at={"O": 0j, "A": 40 + 30j, "D": 340 - 60j, "F": (1 - _ON_ARM) * (40 + 30j) + _ON_ARM * (340 - 60j)},
    links={"crank": ("O", "A"), "coupler": ("A", "D")},
    anchors=("O", "F"),
    slots={"F": ("coupler", "A", "D", 0.0)},
    turning={"O": (turned(15.0), "crank", FRAME)},
)
_CENTRE, _RADIUS = 250 - 20j, 160.0
_LIMITS = tuple(_CENTRE + _RADIUS * np.exp(1j * a) for a in (1.0, 2.4))


def curved(sign):
    """A crank and a rod to a pin in a curved slot of the frame."""
    ends = ("S", "E") if sign > 0 else ("E", "S")
    return Model(
        at={"O": 0j, "A": 50 + 0j, "B": _CENTRE + _RADIUS * np.exp(1.7j), "S": _LIMITS[0], "E": _LIMITS[1]},
        links={"crank": ("O", "A"), "rod": ("A", "B"), "plate": ("S", "E")},
        anchors=("O", "S", "E"),
        slots={"B": (FRAME, *ends, sign * _RADIUS)},
        turning={"O": (turned(15.0), "crank", FRAME)},
    )


def boom(throw, cpm, start):
    def law(time):
        way = start + 2.0 * throw * abs(cpm) / 60.0 * time
        return math.copysign(1.0, cpm) * (triangle(way, throw) - triangle(start, throw))

    return Model(
        at={"O": 0j, "B": 300 + 180j, "F": 240 - 120j, "T": 520 + 300j},
        links={"boom": ("O", "B", "T"), "cylinder": ("F", "B")},
        anchors=("O", "F"),
        lengths={"cylinder": law},
    )


def wiper(limit, rpm, start):
    def law(time):
        way = start + 6.0 * abs(rpm) * time
        return -math.copysign(1.0, rpm) * math.radians(triangle(way, limit) - triangle(start, limit))

    return Model(
        at={**FOUR_BAR.at},
        links=FOUR_BAR.links,
        anchors=FOUR_BAR.anchors,
        turning={"O": (law, "crank", FRAME)},
    )


GEARED = Model(  # a five-bar whose two cranks are geared 1 : -2 by a wheel on each pivot
    at={"O": 0j, "A": 50 + 20j, "B": 160 + 210j, "C": 300 + 60j, "D": 260 + 0j},
    links={"crank": ("O", "A"), "left": ("A", "B"), "right": ("B", "C"), "second": ("C", "D")},
    anchors=("O", "D"),
    turning={"O": (turned(10.0), "crank", FRAME)},
    wheels=(("crank", "second", FRAME, -2.0),),
)
ORBIT = Model(  # a sun that stands still, a chain to a wheel on the arm, a gear to a wheel with a hand
    at={"O": 0j, "P": 200 + 0j, "Q": 310 + 0j, "H": 330 + 90j},
    links={"sun": ("O",), "arm": ("O", "P", "Q"), "wheel": ("P",), "hand": ("Q", "H")},
    anchors=("O",),
    turning={"O": (turned(6.0), "arm", FRAME)},
    wheels=(("sun", "wheel", "arm", 1.5), ("wheel", "hand", "arm", -3.0)),
    level=(("sun", FRAME),),
)
TWO_ARMS = Model(  # both links on the driven anchor turn with it
    at={"O": 0j, "A": 60 + 10j, "E": -20 + 50j, "B": 220 + 130j, "C": 260 - 20j, "G": -200 + 110j, "H": -230 - 40j},
    links={"crank": ("O", "A"), "other": ("O", "E"), "rod": ("A", "B"), "rocker": ("B", "C"), "left": ("E", "G"), "far": ("G", "H")},
    anchors=("O", "C", "H"),
    turning={"O": (turned(30.0), "crank", FRAME), "O2": (turned(30.0), "other", FRAME)},
)  # fmt: skip
_DRIVEN = 'input="true" rpm="{}"'
CASES = {
    "inches": (FOUR_BAR, linkage2(FOUR_BAR, {"O": _DRIVEN.format(20)}, program='units="Inches" scalefactor="10"'), 3.0),
    "moving slot": (WHITWORTH, linkage2(WHITWORTH, {"O": _DRIVEN.format(-12)}), 5.0),
    "anchored slider": (HELD, linkage2(HELD, {"O": _DRIVEN.format(15)}), 4.0),
    "arc": (curved(1), linkage2(curved(1), {"O": _DRIVEN.format(15)}), 4.0),
    "arc, other side": (curved(-1), linkage2(curved(-1), {"O": _DRIVEN.format(15)}), 4.0),
    "actuator": (boom(60.0, 6.0, 0.0), linkage2(boom(60.0, 6.0, 0.0), {}, {"cylinder": 'actuator="true" throw="60" cpm="6"'}), 10.0),
    "actuator inwards": (
        boom(70.0, -5.0, 90.0),
        linkage2(boom(70.0, -5.0, 90.0), {}, {"cylinder": 'actuator="true" throw="70" cpm="-5" startoffset="90"'}),
        12.0,
    ),
    "swinging input": (
        wiper(70.0, 20.0, 20.0),
        linkage2(FOUR_BAR, {"O": _DRIVEN.format(20) + ' limitangle="70" startoffset="20"'}),
        70.0 / 60.0,
    ),
    "gears": (
        GEARED,
        linkage2(
            GEARED, {"O": _DRIVEN.format(10)}, {"crank": 'gear="true"', "second": 'gear="true"'},
            ratios='<ratio type="gears" sizeassize="false"><link id="3" size="10"/><link id="0" size="20"/></ratio>',
        ),
        12.0,
    ),
    "orbit": (
        ORBIT,
        linkage2(
            ORBIT, {"O": _DRIVEN.format(6)}, {"sun": 'gear="true" fastenconnector="0"', "wheel": 'gear="true"', "hand": 'gear="true"'},
            ratios='<ratio type="chain" sizeassize="true"><link id="0" size="75"/><link id="2" size="50"/></ratio>'
            '<ratio type="gears"><link id="2" size="6"/><link id="3" size="2"/></ratio>',
        ),
        10.0,
    ),
    "two links on a driven anchor": (TWO_ARMS, linkage2(TWO_ARMS, {"O": _DRIVEN.format(30)}), 2.0),
    "repeated ids": (
        FOUR_BAR, linkage2(FOUR_BAR, {"O": _DRIVEN.format(20)}, ids=dict.fromkeys(FOUR_BAR.links, 0)), 3.0,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
@pytest.mark.stress
def test_a_file_of_linkage_is_at_every_time_where_all_its_loops_close(name: str) -> None:
    model, text, seconds = CASES[name]
    number = {joint: f"C{i}" for i, joint in enumerate(model.at)}
    compare(model, text, seconds, PIXEL, 1e-8, number.__getitem__)


def ccw(rpm):
    return turned(-rpm)


P_FOUR_BAR = Model(
    at={"A": 0j, "B": 0 + 2j, "C": 5 + 4j, "D": 6 + 0j},
    links={"AB": ("A", "B"), "BC": ("B", "C"), "CD": ("C", "D")},
    anchors=("A", "D"),
    turning={"A": (ccw(10.0), "AB", FRAME)},
)
_BARS = [("YR", "AB", "AB"), ("YR", "BC", "BC"), ("YR", "CD", "CD")]


def p_slot(rod):
    """A block of a crank pin in the slot of an arm; ``rod``: the whole link that the pin carries, where it is welded to the block."""
    return Model(
        at={"A": 0j, "B": 1.5 + 0.5j, "D": -4j, "E": 1.5 * 1.4 + (0.5 + 4) * 1.4j - 4j},
        links={"AB": ("A", "B"), "DE": ("D", "E")},
        anchors=("A", "D"),
        slots={"B": ("DE", "D", "E", 0.0)},
        turning={"A": (ccw(10.0), "AB", FRAME)},
    )


P_GROUNDED = Model(
    at={"A": 0j, "B": 1.2 + 0.5j, "C": 5 + 0j, "X": 4 + 0j, "Y": 7 + 0j},
    links={"AB": ("A", "B"), "BC": ("B", "C"), "bed": ("X", "Y")},
    anchors=("A", "X", "Y"),
    slots={"C": (FRAME, "X", "Y", 0.0)},
    turning={"A": (ccw(-10.0), "AB", FRAME)},
)
P_INNER = Model(
    at={"A": 0j, "B": 3 + 4j, "C": 4.5 + 4j, "D": 6 + 0j},
    links=P_FOUR_BAR.links,
    anchors=("A", "D"),
    turning={"B": (ccw(10.0), "BC", "AB")},
)
P_CASES = {
    "shown paths": (
        P_FOUR_BAR,
        address([(22, "A", 0j, 0), (16, "B", 2j, 0), (16, "C", 5 + 4j, 0), (20, "D", 6 + 0j, 0)], _BARS),
    ),
    "slot": (
        p_slot(None),
        address(
            [
                (6, "A", 0j, 0), (0, "B", 1.5 + 0.5j, 0), (1, "S", 1.5 + 0.5j, -2.3, "DE", "D", "E"), (4, "D", -4j, 0),
                (0, "E", p_slot(None).at["E"], 0),
            ],
            [("YR", "AB", "AB"), ("YP", "BS", "BS"), ("YR", "DE", "DE")],
        ),
    ),
    "grounded slide, clockwise": (
        P_GROUNDED,
        address(
            [(6, "A", 0j, 0), (0, "B", 1.2 + 0.5j, 0), (0, "C", 5 + 0j, 0), (5, "S", 5 + 0j, 0, "", "", "")],
            [("YR", "AB", "AB"), ("YR", "BC", "BC"), ("YP", "CS", "CS")],
            clockwise=True,
        ),
    ),
    "input at a moving pin": (
        P_INNER,
        address([(4, "A", 0j, 0), (2, "B", 3 + 4j, 0), (0, "C", 4.5 + 4j, 0), (4, "D", 6 + 0j, 0)], _BARS),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", P_CASES)
def test_an_address_is_at_every_time_where_all_its_loops_close(name: str) -> None:
    model, text = P_CASES[name]
    compare(model, text, 6.0, 10.0, 1e-8, str)
