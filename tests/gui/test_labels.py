"""kindyna_gui.labels: numbers and names as the window shows them."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mechanisms import with_follower

from core.design import NO_UNIT, UNITS
from core.errors import KindynaError, NoSolution
from core.number_text import shortest
from core.project import load
from core.study import Study
from kindyna_gui.forms.number_box import parsed
from kindyna_gui.labels import name_of, reason, sentence, step_text, value_text
from kindyna_gui.places import example

LIFT = load(example("transfer_lift"))
MM = UNITS["mm"]


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_shown_numbers_read_back_to_the_same_bits(value: float) -> None:
    assert parsed(shortest(value), NO_UNIT) == value


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (-0.0, "0"), (845.0, "845"), (-0.5, "-0.5"), (1302.162, "1302.162"), (1e9, "1000000000"),
     (1e-7, "0.0000001"), (1e-8, "1e-08"), (1e20, "1e+20"), (0.1 + 0.2, "0.30000000000000004")],
)  # fmt: skip
def test_shortest_text(value: float, text: str) -> None:
    assert shortest(value) == text


@pytest.mark.parametrize("text", ["850", " 850.0 ", "850 mm", "850mm", "8.5e2", "+850", "850."])
def test_what_is_a_number(text: str) -> None:
    assert parsed(text, MM) == 850.0


def test_a_true_minus_sign_is_read() -> None:
    assert parsed("\u22123", MM) == -3.0
    assert math.copysign(1.0, parsed("-0", MM) or 0.0) == 1.0


@pytest.mark.parametrize("text", ["", "mm", "8,5", "1_000", "nan", "inf", "1e999", "850 kg", "8 5", "0x10", "٣"])
def test_what_is_no_number(text: str) -> None:
    assert parsed(text, MM) is None


@pytest.mark.parametrize(
    ("path", "name"),
    [("follower.rod_mm", "Rod L2"), ("motion.segments[2].span_deg", "Segment 3, span"),
     ("motion.segments[2].law", "Segment 3, law"), ("motion.segments[2]", "Segment 3"), ("motion.segments", "Motion"),
     ("loads", "Loads"), ("motion.start_mm", "Start"), ("motion.segments[9].span_deg", "Segment 10, span"),
     ("cam.second.roller_radius_mm", "Cam, second, roller radius")],
)  # fmt: skip
def test_fields_have_names(path: str, name: str) -> None:
    assert name_of(LIFT, path) == name


def test_values_and_steps() -> None:
    assert value_text(850.0, MM) == "850 mm"
    assert value_text(41.5, UNITS["deg"]) == "41.5°"
    assert value_text(0.1, NO_UNIT) == "0.1"
    assert value_text("cw", NO_UNIT) == "clockwise"
    assert step_text("Rod L2", 850.0, MM) == "Change rod L2 to 850 mm"


def test_an_error_names_fields_as_the_forms_do() -> None:
    design = with_follower(LIFT, rod_mm=400.0, guide_height_mm=600.0)
    with pytest.raises(NoSolution) as caught:
        _ = Study(design).linkage
    assert "guide_height_mm" in str(caught.value)
    told = reason(design, caught.value)
    assert told.startswith("Rod L2: the rod does not reach the guide in the base position")
    assert told.endswith("or change guide height H or fixed angle")
    assert "_mm" not in told
    assert reason(design, KindynaError("nothing there")) == "Nothing there"


@pytest.mark.parametrize(
    ("told", "shown"),
    [
        ("peak -18 mm/deg^2 at a join", "Peak \u221218 mm/deg² at a join"),
        ("falls to 30.4 deg, usual are 40 deg and more", "Falls to 30.4°, usual are 40° and more"),
        ("smoothing 3 deg^5, from deg to degree", "Smoothing 3 deg^5, from deg to degree"),
        ("allowed: >= 0", "Allowed: ≥ 0"),
    ],
)
def test_sentences_of_the_core_have_the_printers_signs(told: str, shown: str) -> None:
    assert sentence(told) == shown
