"""The random user of ``random_user.py`` at the window, each seed in a process of its own."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

PROGRAM = Path(__file__).resolve().parents[2] / "random_user.py"
BUDGET_S = int(os.environ.get("KINDYNA_FUZZ_SECONDS", "600"))
FIRST = int(os.environ.get("KINDYNA_FUZZ_SEED", "101"))
WARM = 3000  # actions until every kind of design and of result has been seen
STARTING_S = 12  # of the budget goes into finding the tests and starting windows
SEEDS = min(20, max(2, BUDGET_S // 15))
PATIENCE_S = 120  # beyond its own time, before a user counts as hanging


def use(seed: int, notes: Path, most: Sequence[str], patience: float) -> None:
    """Run one user; fails with what it says, or with its last actions where its process dies or hangs."""
    command = [sys.executable, "-X", "faulthandler", str(PROGRAM), str(seed), "--notes", str(notes), *most]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=patience, encoding="utf-8")
        code, said = done.returncode, done.stdout + done.stderr
    except subprocess.TimeoutExpired as error:
        code, said = None, "".join(t.decode() for t in (error.stdout, error.stderr) if isinstance(t, bytes))
    if code != 0:
        last = notes.read_text(encoding="utf-8").splitlines()[-40:] if notes.is_file() else []
        what = "hangs" if code is None else f"died of signal {-code}" if code < 0 else "found something wrong"
        pytest.fail(
            "\n".join((f"the random user of seed {seed} {what}", *([] if code == 1 else last), said)), pytrace=False
        )


@pytest.mark.stress
@pytest.mark.parametrize("seed", [1])
def test_a_random_user_finds_nothing_wrong(seed: int, tmp_path: Path) -> None:
    use(seed, tmp_path / "notes.txt", ("--actions", "12"), PATIENCE_S)


@pytest.mark.soak
def test_a_window_that_is_used_for_long_stays_small(tmp_path: Path) -> None:
    """Five thousand actions once its caches are filled: the random user says what it grew by."""
    use(7, tmp_path / "notes.txt", ("--actions", str(WARM + 5000), "--warm", str(WARM)), 3600.0)


@pytest.mark.fuzz
@pytest.mark.parametrize("seed", range(FIRST, FIRST + SEEDS))
def test_random_users_find_nothing_wrong_for_long(seed: int, tmp_path: Path) -> None:
    share = max(BUDGET_S - STARTING_S, STARTING_S) / SEEDS
    use(seed, tmp_path / "notes.txt", ("--seconds", str(share)), share + PATIENCE_S)
