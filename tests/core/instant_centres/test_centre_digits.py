"""Kennedy's construction keeps its digits: where two lines through given centres cross, against fifty digits."""

from pathlib import Path

import numpy as np
import pytest
from references import EPS, MP

from core.instant_centres.construction import kennedy
from core.project import load
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
Vector = list  # three numbers of mpmath


def across(a: Vector, b: Vector) -> Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def of_length_1(a: Vector) -> Vector:
    length = MP.sqrt(MP.fsum(x * x for x in a))
    return [x / length for x in a]


@pytest.mark.parametrize("name", ["four_bar", "slider_crank", "inverted_slider_crank"])
def test_a_centre_found_by_two_lines_keeps_its_digits(name: str) -> None:
    """Of four links each centre that is wanted has two triangles. What the lines carry of their centres' roundings is the
    stated error bound; made from them are four products each, and as many sums."""
    study = Study(load(EXAMPLES / f"{name}.toml"), 24)
    assert study.design.drive.is_linkage
    table = study.centres
    assert len(table.construction.steps) == 2
    for wanted in table.construction.steps:
        found = kennedy(table.centres, wanted, table.size)
        told = found.homogeneous * np.array([[1.0 / table.size], [1.0 / table.size], [1.0]])
        for i in range(study.theta.size):
            lines = []
            for triangle in wanted.triangles:
                ends = [table.centres[key].homogeneous[:, i] for key in (triangle.first, triangle.second)]
                scaled = [
                    [MP.mpf(v[0]) / MP.mpf(table.size), MP.mpf(v[1]) / MP.mpf(table.size), MP.mpf(v[2])] for v in ends
                ]
                lines.append(across(*scaled))
            exact = of_length_1(across(*lines))
            off = MP.sqrt(MP.fsum(x * x for x in across(exact, of_length_1([MP.mpf(v) for v in told[:, i]]))))
            assert float(off) <= 4.0 * EPS * float(np.broadcast_to(found.error_bound, study.theta.shape)[i]), (
                wanted.key,
                i,
            )
