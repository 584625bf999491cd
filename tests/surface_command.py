"""The command ``surface`` in the process of the tests."""

import contextlib
import io
import json
from pathlib import Path

from core.__main__ import main


def run(*words: object) -> tuple[int, str, str]:
    """The command in this process: exit code, what it printed, its faults."""
    said, faults = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(faults):
        code = main(["surface", *map(str, words)])
    return code, said.getvalue(), faults.getvalue()


def written(design: Path, out: Path, *words: object) -> dict[str, float]:
    """What the command says of the file that it wrote."""
    code, said, faults = run(design, "--out", out, "--json", *words)
    assert (code, faults) == (0, ""), faults
    return json.loads(said)
