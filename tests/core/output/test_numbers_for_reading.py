"""Numbers for reading: digits, groups, minus and exponents of one number, and of every number of the reports of the examples."""

import math
import re

import pytest
from sampled import spread

from core.number_text import compared_texts, count_text, fixed_text, input_text, result_text, signed_text, typeset
from core.output.report import report
from core.process import resources
from core.project import load
from core.study import Study, findings_of

MINUS, NARROW = "\u2212", "\u202f"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (318.64231, "318.6"),
        (-30.0, f"{MINUS}30"),
        (7472.9, "7473"),
        (9999.9, f"10{NARROW}000"),
        (45745.3, f"45{NARROW}750"),
        (-123456789.0, f"{MINUS}123{NARROW}500{NARROW}000"),
        (1e9, f"1{NARROW}000{NARROW}000{NARROW}000"),
        (1.2345678e10, "1.235e10"),
        (1e-4, "0.0001"),
        (9.9999e-5, "0.0001"),
        (1.2345e-5, f"1.234e{MINUS}5"),
        (math.inf, "∞"),
        (-math.inf, f"{MINUS}∞"),
        (math.nan, "none"),
        (None, "none"),
    ],
)
def test_a_result_has_four_digits_groups_of_three_and_no_exponent(value: float | None, text: str) -> None:
    assert result_text(value) == text


def test_a_column_keeps_its_zeros_and_other_digits_are_those_asked_for() -> None:
    assert [result_text(x, padded=True) for x in (25.0, 7.5, 0.0)] == ["25.00", "7.500", "0"]
    assert result_text(45745.3, 6) == f"45{NARROW}745.3"
    assert [fixed_text(x, 1) for x in (-0.04, 359.96, -12345.0)] == ["0.0", "360.0", f"{MINUS}12{NARROW}345.0"]
    assert [signed_text(x) for x in (0.02, -0.02, 0.0)] == ["+0.02", f"{MINUS}0.02", "0"]
    assert count_text(1234567) == f"1{NARROW}234{NARROW}567"


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ((44.44321, 30.0), ["44.443", "30"]),
        ((30.0004, 30.0), ["30.0004", "30"]),
        ((30.0000001, 30.0), ["just above 30", "30"]),
        ((29.99999999, 30.0), ["just below 30", "30"]),
        ((30.0, 30.0), ["30", "30"]),
    ],
)
def test_two_numbers_are_told_apart_with_five_digits_or_six(values: tuple[float, ...], texts: list[str]) -> None:
    assert compared_texts(values) == texts


@pytest.mark.parametrize(
    ("typed", "shown"),
    [
        ("allowed: -360 ... 360 deg", f"allowed: {MINUS}360 ... 360 deg"),
        ("above 0 ... 1e+09 mm", f"above 0 ... 1{NARROW}000{NARROW}000{NARROW}000 mm"),
        ("-30...-20, +-450 mm", f"{MINUS}30...{MINUS}20, ±450 mm"),
        ("cam-2.toml, /tmp/12345/a, 2026-11-29, v1.2.3", "cam-2.toml, /tmp/12345/a, 2026-11-29, v1.2.3"),
    ],
)
def test_a_sentence_gets_the_signs_of_its_numbers_and_keeps_names(typed: str, shown: str) -> None:
    assert typeset(typed) == shown


def test_an_input_keeps_the_digits_that_were_typed() -> None:
    assert [input_text(x) for x in (1302.162, -20000.0, 35.0, 0.1)] == [
        "1302.162",
        f"{MINUS}20{NARROW}000",
        "35",
        "0.1",
    ]


EXAMPLES = sorted(path.stem for path in (resources() / "examples").glob("*.toml"))
NUMBER = re.compile(rf"(?<![\w.(])[-{MINUS}]?\d+(?:{NARROW}\d+)*(?:\.\d+)?(?:e[-+{MINUS}]?\d+)?(?![\w.]*\w)")
INPUTS = ("Follower", "Cam", "Shaft", "Loads", "Motion", "Linkage", "Limits", "Balance cam")


def faults(number: str, most: int) -> list[str]:
    """What is wrong with the text of a number."""
    text = number.replace(MINUS, "").replace(NARROW, "")
    whole = re.split(r"[.e]", number.replace(MINUS, ""))[0]
    digits = re.sub(r"e.*|\.", "", text).strip("0") if "." in text else re.sub(r"e.*", "", text).strip("0")
    return [
        name
        for name, wrong in (
            ("minus", "-" in number),
            ("groups", len(whole) > 4 and not re.fullmatch(rf"\d{{1,3}}(?:{NARROW}\d{{3}})+", whole)),
            ("groups of four digits", NARROW in number and len(whole.replace(NARROW, "")) < 5),
            ("exponent", "e" in number and 1e-4 <= abs(float(number.replace(NARROW, "").replace(MINUS, "-"))) <= 1e9),
            ("digits", len(digits) > most),
        )
        if wrong
    ]


@pytest.mark.parametrize("example", spread(EXAMPLES, 4))
def test_every_number_of_a_report_and_of_its_findings_is_written_in_one_way(example: str) -> None:
    """Inputs have the digits that were typed, results six at most."""
    study = Study(load(resources() / "examples" / f"{example}.toml"), 36)
    heading, wrong = "", []
    lines = report(study).splitlines()
    for line, below in zip(lines, [*lines[1:], ""], strict=True):
        heading = line if below and set(below) == {"-"} else heading
        if "  " in line or heading == "Findings":  # a row of a table; a reason is a text of the file
            most = 17 if heading in INPUTS else 6
            wrong += [(heading, n, faults(n, most)) for n in NUMBER.findall(line) if faults(n, most)]
    wrong += [(f.code, n, faults(n, 6)) for f in findings_of(study) for n in NUMBER.findall(f.message) if faults(n, 6)]
    assert wrong == []
    assert any(NUMBER.findall(line) for line in lines)
