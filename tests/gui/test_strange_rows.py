"""A row added to one table is everywhere right: the tests of ``strange_rows``, in a process whose tables have rows of a stranger."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from sampled import stressed

HERE = Path(__file__).parent
PATIENCE = 120  # seconds


@pytest.mark.parametrize("chosen", ["not stress", stressed("stress")])
@pytest.mark.stress
def test_one_row_is_all_that_a_law_a_unit_a_quantity_or_a_limit_needs(chosen: str) -> None:
    words = [
        "-q",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:xdist",
        "-p",
        "strangers",
        "-m",
        chosen,
        str(HERE / "strange_rows.py"),
    ]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(HERE.parent), str(HERE.parents[1])))}
    environment.pop("PYTEST_ADDOPTS", None)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *words],
        env=environment,
        cwd=HERE.parents[1],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
        encoding="utf-8",
    )
    assert done.returncode == 0, done.stdout + done.stderr
