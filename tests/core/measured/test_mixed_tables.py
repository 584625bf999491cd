"""core.measured: laws, blends and lobes with noise, rounded, rows of them spoiled: what is said of them is right, or they are refused."""

import os
from collections.abc import Sequence

import pytest
from mixed_tables import Verdict, mixed_table, verdict

SEEDS = (10, 11, 34, 153, 336)  # strokes and tips between rows, jumps of the velocity, runs at a dwell's end
MANY = 1000
MOST_REFUSED = 0.02  # of the tables
LEAST_RECOGNISED = 0.95  # of those with errors below 1e-4 of the stroke that only one law fits


def proved(seeds: Sequence[int]) -> None:
    """Strokes, dwells, spoiled rows and laws of all tables."""
    found: dict[int, Verdict] = {seed: verdict(mixed_table(seed)) for seed in seeds}
    assert {seed: each.faults for seed, each in found.items() if each.faults} == {}
    told = [each.recognised for each in found.values() if each.recognised is not None]
    assert sum(each.refused for each in found.values()) <= MOST_REFUSED * len(seeds)
    assert sum(told) >= LEAST_RECOGNISED * len(told) > 0.0


def test_mixed_tables_are_read_as_they_were_made() -> None:
    proved(SEEDS[:2])


@pytest.mark.stress
def test_more_mixed_tables_are_read_as_they_were_made() -> None:
    proved(SEEDS)


@pytest.mark.stress
def test_a_thousand_mixed_tables_are_read_as_they_were_made() -> None:
    first = int(os.environ.get("KINDYNA_FUZZ_SEED", "0"))
    proved(range(first, first + MANY))
