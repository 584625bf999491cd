"""The window on a real display: the tests of the main window once more, on an X server of their own."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

HERE = Path(__file__).parents[1]
OF_WINDOW = (
    "window/test_main_window.py",
    "forms/test_parameters.py",
    "motion/test_segments_table.py",
    "findings/test_findings.py",
)
XVFB = shutil.which("Xvfb")
PATIENCE = 60  # seconds


@pytest.fixture
def display() -> Iterator[str]:
    """A display that the server chose itself."""
    if XVFB is None:
        pytest.skip("no Xvfb here")
    read, write = os.pipe()
    command = [XVFB, "-displayfd", str(write), "-screen", "0", "1440x900x24", "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        with os.fdopen(read, encoding="utf-8") as answer:
            number = answer.readline().strip()
        if not number:
            pytest.skip("Xvfb does not start here")
        yield f":{number}"
    finally:
        server.terminate()
        server.wait(PATIENCE)


WAY = (
    "open_edit_save or typed_and_entered or dragging_the_name or law_is_chosen or turns_the_cam_and_leads or is_kept"
    " or keys_of_the_window"
)


@pytest.mark.stress
@pytest.mark.skipif(bool(os.environ.get("KINDYNA_TEST_XVFB")), reason="this is that run")
def test_the_users_way_on_a_real_window(display: str, tmp_path: Path) -> None:
    environment = os.environ | {"DISPLAY": display, "KINDYNA_TEST_XVFB": "1", "QT_QPA_PLATFORM": "xcb"}
    environment.pop("PYTEST_ADDOPTS", None)
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-p",
            "no:cacheprovider",
            "-p",
            "no:xdist",
            f"--basetemp={tmp_path / 'inner'}",
            "-k",
            WAY,
            *(str(HERE / name) for name in OF_WINDOW),
        ],
        env=environment,
        cwd=HERE.parents[1],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
        encoding="utf-8",
    )
    if "no Qt platform plugin could be initialized" in done.stderr:
        pytest.skip("the libraries of a real window are missing")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "7 passed" in done.stdout
