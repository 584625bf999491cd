"""`make run` before there is an environment: what is missing is named, and nothing half made is left."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
TOOLS = {
    "id": "echo 1000",
    "sudo": "exit 1",
    "apt-get": "exit 1",
    "dpkg-query": "exit 1",
    "bare-python": f'case "$*" in *ensurepip*) exit 1;; esac; exec {sys.executable} "$@"',
    "failing-python": f'case "$*" in *"-m venv"*) mkdir .venv; exit 3;; esac; exec {sys.executable} "$@"',
}
"""Of a plain user on a Debian; two Pythons: one without its package of environments, one that cannot write one."""


@pytest.mark.skipif(shutil.which("make") is None, reason="there is no make")
@pytest.mark.parametrize(
    ("python", "missing"),
    [("bare-python", "python3-venv libegl1 fonts-nanum"), ("failing-python", "libegl1 fonts-nanum")],
)
def test_a_plain_user_is_told_once_what_is_missing_and_keeps_no_environment(
    python: str, missing: str, tmp_path: Path
) -> None:
    for name, line in TOOLS.items():
        tool = tmp_path / "bin" / name
        tool.parent.mkdir(exist_ok=True)
        tool.write_text(f"#!/bin/sh\n{line}\n", "utf-8")
        tool.chmod(0o755)
    home = tmp_path / "checkout"
    home.mkdir()
    for file in ("Makefile", "pyproject.toml"):
        shutil.copy(ROOT / file, home)
    command = ["make", "run", f"PYTHON={python}", "SYSTEM_PACKAGES=libegl1 fonts-nanum"]
    path = f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}"
    run = subprocess.run(
        command, cwd=home, env={**os.environ, "PATH": path}, capture_output=True, text=True, encoding="utf-8"
    )
    said = run.stdout + run.stderr
    assert run.returncode == 2
    assert f"Missing system packages (to be installed by an administrator): {missing}\n" in said
    assert said.count("python3-venv") == missing.count("python3-venv")
    assert "Traceback" not in said
    assert not (home / ".venv").exists()
