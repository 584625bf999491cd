"""core.units: one row for each kind of unit; exact sizes, what may be typed, what is shown."""

import math
from fractions import Fraction

import pytest

from core.units import KINDS, UNITS, accepted_units, conversion_factor, display_units, quantity_kind, split_unit


@pytest.mark.parametrize(
    ("before", "after", "size"),
    [  # the yard, the pound and the gravity by definition
        ("in", "mm", 25.4), ("ft", "in", 12.0), ("thou", "µm", 25.4), ("lbf", "N", 4.4482216152605), ("g", "mm/s²", 9806.65),
        ("rpm", "°/s", 6.0), ("Hz", "rpm", 60.0), ("turns", "°", 360.0), ("rad", "°", math.degrees(1.0)), ("N/mm²", "MPa", 1.0),
        ("mm/rad", "mm/°", math.radians(1.0)), ("bar", "Pa", 1e5), ("kN/mm", "N/m", 1e6), ("1/m", "1/mm", 1e-3),
    ],
)  # fmt: skip
def test_a_change_is_rounded_once(before: str, after: str, size: float) -> None:
    assert conversion_factor(before, after) == size
    assert quantity_kind(before) == quantity_kind(after)


def test_units_that_measure_something_else_are_not_changed() -> None:
    with pytest.raises(KeyError):
        conversion_factor("mm", "N")


def test_a_unit_is_accepted_with_and_without_its_signs() -> None:
    inertia = accepted_units("kg·m²")
    assert {inertia[text] for text in ("kg·m²", "kg m2", "kgm^2")} == {1}
    assert inertia["kg cm2"] == Fraction(1, 10**4)
    assert accepted_units("mm")['"'] == Fraction(127, 5)
    assert accepted_units("N·m/rad")["Nm/deg"] == math.degrees(1.0)
    assert accepted_units("m/s²")["g"] == Fraction("9.80665")
    assert accepted_units("") == {}


def test_a_length_per_turn_is_a_length_with_its_unit() -> None:
    assert split_unit("servo.travel_mm_per_turn") == ("servo.travel", UNITS["mm"])


def test_every_kind_is_whole() -> None:
    """What is stored and shown, and what spellings mean, are units of the row; no ending and no symbol is two rows'."""
    ends = [end for kind in KINDS.values() for end in kind.stored]
    symbols = [symbol for kind in KINDS.values() for symbol in kind.sizes]
    assert len(set(ends)) == len(ends) == len(UNITS)
    assert len(set(symbols)) == len(symbols)
    for kind in KINDS.values():
        assert {*kind.stored.values(), *kind.shown} <= {*kind.units}
        assert {*kind.typed.values()} <= {*kind.sizes}
        for symbol in kind.units:
            rungs = display_units(symbol)
            assert [size for _, size, _ in rungs] == sorted((size for _, size, _ in rungs), reverse=True)
            assert rungs[-1][2] == 0.0
