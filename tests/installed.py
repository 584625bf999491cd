"""Building the wheel, and processes that know nothing of the checkout."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).parents[1]


def run(folder: Path, path: Sequence[Path], *words: str | Path) -> subprocess.CompletedProcess[str]:
    """A process in a folder, with these folders on its path and nothing else of the caller's environment."""
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "PIP", "PYTEST"))
    }
    environment |= {"PYTHONPATH": os.pathsep.join(map(str, path))} if path else {}
    command = list(map(str, words))
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, encoding="utf-8")


def built(source: Path, kind: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """A wheel or a source distribution of a checkout, in a folder."""
    return run(source, [], sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", folder)
