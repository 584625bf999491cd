"""Every kind of dyad between two links that move in every way: to all digits, three derivatives included."""

from dataclasses import replace

import pytest
from dyad_cases import DYAD_CASES, DYAD_ROUNDINGS, NUMBERS, DyadCase
from sampled import spread

from core.mechanism.dyads import DYADS


@pytest.mark.parametrize("quick", [1.0, 40.0])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("case", spread(DYAD_CASES.values(), 5), ids=DYAD_CASES)
def test_angles_rates_and_joint_of_a_dyad_keep_their_digits(case: DyadCase, side: int, quick: float) -> None:
    """``quick``: of links that turn so many times as fast, whose derivatives are so many times larger, order by order."""
    numbers = tuple(v * quick ** (i % 4) for i, v in enumerate(NUMBERS))
    errors = replace(case, side=side, numbers=numbers).errors(DYAD_ROUNDINGS)
    assert [i for i, (error, bound) in enumerate(errors) if not error <= bound] == [], errors


def test_no_kind_of_dyad_is_left_out() -> None:
    assert {case.kind for case in DYAD_CASES.values()} == set(DYADS)
