"""What a command takes from its start to its end, as a process of its own: processor time, and memory at most."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
LIFT = str(ROOT / "resources" / "examples" / "transfer_lift.toml")
NUMPY = ("-c", "import numpy")
CHECK = ("-m", "core", "check", LIFT)
STARTS = 5


@dataclass(frozen=True)
class Used:
    """Seconds of the processor, of all threads; MiB that the process held at most."""

    seconds: float
    peak_mib: float


def used(words: Sequence[str]) -> Used:
    """By Python with these words, its compiled modules kept from run to run. Raises RuntimeError where it fails."""
    env = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    process = subprocess.Popen([sys.executable, *words], cwd=ROOT, env=env, stdout=subprocess.DEVNULL)
    _, status, spent = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"{' '.join(words)}: exit code {process.returncode}")
    return Used(spent.ru_utime + spent.ru_stime, spent.ru_maxrss / 1024.0)


def starts(times: int = STARTS) -> dict[tuple[str, ...], float]:
    """Least seconds of ``check`` of the lift, and of Python with numpy alone; in turn, the first of each not counted."""
    taken: dict[tuple[str, ...], list[float]] = {NUMPY: [], CHECK: []}
    for count in range(times + 1):
        for words, found in taken.items():
            seconds = used(words).seconds
            if count:
                found.append(seconds)
    return {words: min(found) for words, found in taken.items()}


def export(angles: int) -> Used:
    """All tables of the lift at so many cam angles."""
    with TemporaryDirectory() as folder:
        return used(("-m", "core", "export", LIFT, "--out", folder, "--samples", str(angles)))
