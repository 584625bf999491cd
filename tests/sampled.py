"""Sweeps over all that there is: some of them in every run, the others under ``make stress``."""

from collections.abc import Sequence
from typing import Any

import pytest


def stressed(*values: Any) -> Any:
    """One set of arguments that is for ``make stress`` alone."""
    return pytest.param(*values, marks=pytest.mark.stress)


def spread(values: Sequence[Any], ordinary: int) -> list[Any]:
    """Parameters of a sweep: so many, evenly spread from the first to the last, in every run, each other one under stress.

    values   a plain tuple among them is one set of several arguments; what pytest.param has made keeps its name
    """
    last = len(values) - 1
    kept = {round(i * last / max(ordinary - 1, 1)) for i in range(ordinary)}
    made = []
    for i, value in enumerate(values):
        each = value
        if not hasattr(value, "marks"):
            each = pytest.param(*value) if type(value) is tuple else pytest.param(value)
        marks = [*each.marks, *([] if i in kept else [pytest.mark.stress])]
        made.append(pytest.param(*each.values, marks=marks, id=each.id))
    return made
