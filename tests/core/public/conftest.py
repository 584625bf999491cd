"""An environment that holds the wheel and nothing else, for the tests with the marker ``wheel``."""

import subprocess
import sys
import sysconfig
import tarfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from installed import ROOT, built, run

WINDOW = ("PySide6", "shiboken6", "pyqtgraph")


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    done = built(ROOT, "wheel", folder)
    assert done.returncode == 0, done.stderr
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="session")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The source distribution, unpacked."""
    folder = tmp_path_factory.mktemp("sdist")
    done = built(ROOT, "sdist", folder)
    assert done.returncode == 0, done.stderr
    with tarfile.open(next(folder.glob("*.tar.gz"))) as archive:
        archive.extractall(folder, filter="data")
    return next(path for path in folder.iterdir() if path.is_dir())


@pytest.fixture(scope="session")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of that environment."""
    home = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(home)], check=True)
    interpreter = home / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    pip = [sys.executable, "-m", "pip", "--python", interpreter, "install", "-qq", "--no-deps", "--no-index", wheel]
    subprocess.run(list(map(str, pip)), check=True)
    return interpreter


@pytest.fixture(scope="session")
def libraries(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Path], list[Path]]:
    """Paths to the packages of this environment: without and with the window's. As a path they do not lead to the checkout."""
    packages, without = Path(sysconfig.get_path("purelib")), tmp_path_factory.mktemp("without_the_window")
    assert not (packages / "kindyna").exists(), "install the checkout with pip install -e"
    for name in WINDOW:
        line = f'raise ModuleNotFoundError("No module named {name!r}", name={name!r})\n'
        (without / f"{name}.py").write_text(line, "utf-8")
    return [without, packages], [packages]


@pytest.fixture
def beside(tmp_path: Path) -> Path:
    """A folder with a package named ``core`` that has a module ``project``, too."""
    (tmp_path / "core").mkdir()
    (tmp_path / "core/__init__.py").write_text("", "utf-8")
    (tmp_path / "core/project.py").write_text("NAME = 'another'\n", "utf-8")
    return tmp_path


@pytest.fixture
def with_libraries(python: Path, libraries: tuple[list[Path], list[Path]], tmp_path: Path) -> Iterator[Path]:
    """The interpreter of that environment, which has the libraries whatever its path is."""
    purelib = run(tmp_path, [], python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))")
    links = Path(purelib.stdout.strip(), "libraries.pth")
    links.write_text(str(libraries[1][0]), "utf-8")
    yield python
    links.unlink()
