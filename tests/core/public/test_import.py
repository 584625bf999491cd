"""``import kindyna`` in a checkout: what it loads, what is in its way, and its command line."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
LIFT = ROOT / "resources/examples/transfer_lift.toml"


def python(folder: Path, *words: str | Path) -> subprocess.CompletedProcess[str]:
    """A process of the environment of the tests, in a folder."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [sys.executable, *map(str, words)]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, encoding="utf-8")


def test_the_library_loads_neither_a_window_nor_a_library_of_others(tmp_path: Path) -> None:
    unwanted = "{'PySide6', 'pyqtgraph', 'kindyna_gui', 'pandas', 'matplotlib', 'scipy'}"
    code = f"import sys, kindyna; print(sorted({unwanted} & sys.modules.keys()), kindyna.__version__)"
    assert python(tmp_path, "-c", code).stdout == "[] 0.1.0\n"


def test_it_lists_what_is_public() -> None:
    import kindyna

    names = [name for name in dir(kindyna) if not (name.startswith("__") and name.endswith("__"))]
    assert names == sorted(kindyna.__all__)
    assert all(hasattr(kindyna, name) for name in names)


@pytest.mark.parametrize("is_imported", [False, True])
@pytest.mark.parametrize("file", ["core/__init__.py", "core.py"])
def test_another_core_is_named_in_one_line(tmp_path: Path, file: str, is_imported: bool) -> None:
    (tmp_path / file).parent.mkdir(exist_ok=True)
    (tmp_path / file).write_text("", "utf-8")
    done = python(tmp_path, "-c", "import core, kindyna" if is_imported else "import kindyna")
    last = done.stderr.splitlines()[-1]
    named = tmp_path / ("core.py" if file == "core.py" else "core")
    assert last.startswith(f"ImportError: {named} is imported as core in place of {ROOT / 'core'}")
    assert "rename it" in last


def test_a_core_without_a_file_is_refused_too(tmp_path: Path) -> None:
    code = "import sys, types; sys.modules['core'] = types.ModuleType('core'); import kindyna"
    assert "ImportError: a module without a file is imported as core" in python(tmp_path, "-c", code).stderr


def test_a_folder_that_is_no_package_is_not_in_the_way(tmp_path: Path) -> None:
    (tmp_path / "core").mkdir()
    (tmp_path / "core/project.py").write_text("", "utf-8")
    code = "import kindyna, core.project; print(core.project.load.__name__)"
    assert python(tmp_path, "-c", code).stdout == "load\n"


def test_its_command_line_is_that_of_the_core(tmp_path: Path) -> None:
    both = [python(tmp_path, "-m", package, "check", LIFT) for package in ("kindyna", "core")]
    assert both[0].stdout == both[1].stdout != ""
    assert both[0].returncode == both[1].returncode == 0
    assert "usage: python -m kindyna [" in python(tmp_path, "-m", "kindyna", "--help").stdout
