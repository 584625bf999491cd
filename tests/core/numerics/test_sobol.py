"""Sobol's points are those of scipy."""

import warnings

import numpy as np
import pytest
from scipy.stats import qmc

from core.numerics.sobol import sobol


@pytest.mark.parametrize(
    ("dimensions", "seed", "start", "count"), [(1, 0, 0, 1), (9, 1, 0, 1024), (9, 4, 37, 100), (60, 5, 1000, 33)]
)
def test_scrambled_points_are_those_of_scipy(dimensions: int, seed: int, start: int, count: int) -> None:
    sequence = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed))
    if start:
        sequence.fast_forward(start)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that it is balanced only at powers of 2
        expected = sequence.random(count)
    assert sobol(dimensions, seed, start, count).tolist() == expected.tolist()
