"""The wheel: what lies in it, that it is the checkout line by line, and that it runs beside a folder named ``core``."""

import json
import os
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.wheel

ROOT = Path(__file__).parents[3]
PACKAGES = {"kindyna/core/": "core/", "kindyna/resources/": "resources/", "kindyna/CHANGELOG.md": "CHANGELOG.md",
            "kindyna/": "core/public/kindyna/", "kindyna_gui/": "kindyna_gui/"}  # fmt: skip
EXAMPLES = ["transfer_lift", "lecture_six_bar", "groove", "transfer_unit", "rocker_shoe"]
QT = {"PySide6", "shiboken6", "pyqtgraph"}
STUDY = """
design = "lift.toml"
[[vary]]
field = "cam.base_radius_mm"
low = 400.0
high = 460.0
steps = 1200
[[quantities]]
quantity = "pressure_angle_deg"
of = "max"
"""
IMPORT_ALL = """
import importlib, json, pkgutil, sys
found = []
for name in sys.argv[1:]:
    package = importlib.import_module(name)
    modules = [m.name for m in pkgutil.walk_packages(package.__path__, f"{name}.") if "workbook_process" not in m.name]
    found += [importlib.import_module(module).__name__ for module in modules]
print(json.dumps([len(found), sorted(m for m in sys.modules if m.split(".")[0] in ("core", "PySide6"))]))
"""


USE = """
import numpy as np
import kindyna as kd

design: kd.Design = kd.example("transfer_lift").edit({"cam.base_radius_mm": 430.0})
study: kd.Study = design.study(36)
torque: np.ndarray[tuple[int, ...], np.dtype[np.float64]] = study["drive_torque_nm"]
largest: float = float(study.extreme("drive_torque_nm", of="abs"))
messages: list[str] = [finding.message for finding in study.at([0.0, 90.0]).findings]
try:
    kd.design({})
except kd.KindynaError as error:
    paths: list[str] = [fault.path for fault in error.faults]
"""


def run(folder: Path, path: list[Path], *words: str | Path) -> subprocess.CompletedProcess[str]:
    """A process in a folder, with these folders on its path and nothing else of the caller's environment."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "PIP"))}
    environment["PYTHONPATH"] = os.pathsep.join(map(str, path))
    command = list(map(str, words))
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, encoding="utf-8")


@pytest.fixture(scope="module")
def hatchling(tmp_path_factory: pytest.TempPathFactory) -> Path:
    tools = tmp_path_factory.mktemp("tools")
    pip = [sys.executable, "-m", "pip", "install", "-qq", "--disable-pip-version-check", "--target", tools, "hatchling"]
    subprocess.run(list(map(str, pip)), check=True)
    return tools


def built(source: Path, hatchling: Path, kind: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return run(source, [hatchling], sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", folder)


@pytest.fixture(scope="module")
def wheel(hatchling: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    done = built(ROOT, hatchling, "wheel", folder)
    assert done.returncode == 0, done.stderr
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="module")
def sources(hatchling: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The source distribution, unpacked."""
    folder = tmp_path_factory.mktemp("sdist")
    done = built(ROOT, hatchling, "sdist", folder)
    assert done.returncode == 0, done.stderr
    with tarfile.open(next(folder.glob("*.tar.gz"))) as archive:
        archive.extractall(folder, filter="data")
    return next(path for path in folder.iterdir() if path.is_dir())


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of an environment that holds the wheel and nothing else."""
    home = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(home)], check=True)
    interpreter = home / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    pip = [sys.executable, "-m", "pip", "--python", interpreter, "install", "-qq", "--no-deps", "--no-index", wheel]
    subprocess.run(list(map(str, pip)), check=True)
    return interpreter


@pytest.fixture(scope="module")
def libraries(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The packages of this environment except KINDYNA: without and with the window's."""
    folders = tmp_path_factory.mktemp("libraries"), tmp_path_factory.mktemp("window_libraries")
    for entry in Path(sysconfig.get_path("purelib")).iterdir():
        if "kindyna" not in entry.name and entry.suffix != ".pth":
            (folders[1] if entry.name in QT else folders[0]).joinpath(entry.name).symlink_to(entry)
    return folders


@pytest.fixture
def beside(tmp_path: Path) -> Path:
    """A folder with a package named ``core`` that has a module ``project``, too."""
    (tmp_path / "core").mkdir()
    (tmp_path / "core/__init__.py").write_text("", "utf-8")
    (tmp_path / "core/project.py").write_text("NAME = 'another'\n", "utf-8")
    return tmp_path


def origin(name: str) -> Path:
    """The file of the checkout that a file of the wheel is made from."""
    prefix = next(prefix for prefix in PACKAGES if name.startswith(prefix))
    return ROOT / name.replace(prefix, PACKAGES[prefix], 1)


def test_it_holds_two_packages(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    assert {name.split("/")[0] for name in names} == {"kindyna", "kindyna_gui", "kindyna-0.1.0.dist-info"}
    assert {"kindyna/py.typed", "kindyna/resources/examples/transfer_lift.toml"} <= set(names)
    packed = {origin(name) for name in names if ".dist-info/" not in name}
    assert len(packed) == len(names) - len([name for name in names if ".dist-info/" in name])
    wanted = {path for room in ("core", "kindyna_gui") for path in (ROOT / room).rglob("*.py")}
    wanted |= {path for path in (ROOT / "resources").rglob("*") if path.is_file()}
    assert wanted - packed == set()


def test_only_import_statements_differ_from_the_checkout(wheel: Path) -> None:
    archive, changed = zipfile.ZipFile(wheel), 0
    for name in archive.namelist():
        if ".dist-info/" not in name:
            there, here = archive.read(name).decode("latin-1").split("\n"), origin(name).read_bytes().decode("latin-1")
            for line, (packed, original) in enumerate(zip(there, here.split("\n"), strict=True), 1):
                if packed != original:
                    assert packed == original.replace("from core", "from kindyna.core", 1), f"{name}:{line}"
                    assert original.lstrip().startswith("from core")
                    changed += 1
    assert changed > 2500


def test_the_wheel_of_the_source_distribution_is_the_same(
    sources: Path, hatchling: Path, wheel: Path, tmp_path: Path
) -> None:
    done = built(sources, hatchling, "wheel", tmp_path)
    assert done.returncode == 0, done.stderr
    assert next(tmp_path.glob("*.whl")).read_bytes() == wheel.read_bytes()


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("NAME = 'core.papers.yang'", "'core.papers.yang' names a module"),
        ("name = 'yang'\nNAME = f'core.papers.{name}'", "'core.papers.' names a module"),
        ("COMMAND = ['-m', 'core']", "'core' names a module"),
        ("import core.errors", "'import core' cannot be packed"),
        ("NAME = 1; from core.errors import KindynaError", "write one import statement a line"),
    ],
)
def test_what_cannot_be_packed_fails_the_build(
    sources: Path, hatchling: Path, tmp_path: Path, line: str, said: str
) -> None:
    file = sources / "core/units.py"
    text = file.read_text("utf-8")
    try:
        file.write_text(f"{text}\n{line}\n", "utf-8")
        done = built(sources, hatchling, "wheel", tmp_path)
    finally:
        file.write_text(text, "utf-8")
    assert done.returncode != 0
    assert said in done.stderr
    assert "units.py:" in done.stderr
    assert list(tmp_path.glob("*.whl")) == []


@pytest.mark.parametrize("order", ["kindyna.core.project, core.project", "core.project, kindyna.core.project"])
def test_another_core_is_imported_beside_it(
    python: Path, libraries: tuple[Path, Path], beside: Path, order: str
) -> None:
    code = f"import {order}, kindyna; print(core.project.NAME, kindyna.core.project.load.__name__, kindyna.__version__)"
    done = run(beside, [libraries[0]], python, "-c", code)
    assert done.stdout == "another load 0.1.0\n", done.stderr


def test_every_module_is_imported_without_qt_and_with_it(
    python: Path, libraries: tuple[Path, Path], tmp_path: Path
) -> None:
    done = run(tmp_path, [libraries[0]], python, "-c", IMPORT_ALL, "kindyna")
    assert done.returncode == 0, done.stderr
    count, unwanted = json.loads(done.stdout)
    assert (count > 250, unwanted) == (True, [])
    done = run(tmp_path, list(libraries), python, "-c", IMPORT_ALL, "kindyna_gui")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)[0] > 150


@pytest.mark.parametrize("example", EXAMPLES)
def test_its_tables_are_those_of_the_checkout(
    python: Path, libraries: tuple[Path, Path], beside: Path, example: str
) -> None:
    file = ROOT / "resources/examples" / f"{example}.toml"
    done = run(beside, [libraries[0]], python, "-m", "kindyna", "export", file, "--out", "wheel")
    assert done.returncode == 0, done.stderr
    assert run(ROOT, [], sys.executable, "-m", "core", "export", file, "--out", beside / "checkout").returncode == 0
    folders = [beside / "wheel", beside / "checkout"]
    files = [{path.relative_to(at): path.read_bytes() for path in at.rglob("*") if path.is_file()} for at in folders]
    assert files[0] == files[1] != {}


def test_worker_processes_import_it_beside_another_core(
    python: Path, libraries: tuple[Path, Path], beside: Path
) -> None:
    (beside / "lift.toml").write_bytes((ROOT / "resources/examples/transfer_lift.toml").read_bytes())
    (beside / "study.toml").write_text(STUDY, "utf-8")
    tables = []
    for workers in ("1", "2"):
        words = ["vary", "study.toml", "--out", f"{workers}.csv", "--workers", workers]
        done = run(beside, [libraries[0]], python, "-m", "kindyna", *words)
        assert done.returncode == 0, done.stderr
        tables.append((beside / f"{workers}.csv").read_text("utf-8").splitlines())
    assert len(tables[0]) == 1201
    assert tables[0] == tables[1]


def test_a_traceback_names_the_line_of_the_checkout(python: Path, libraries: tuple[Path, Path], tmp_path: Path) -> None:
    code = "from kindyna.core.project import load; load('nowhere.toml')"
    lines = run(tmp_path, [libraries[0]], python, "-c", code).stderr.splitlines()
    framed = [
        (line.split('"')[1], int(line.split("line ")[1].split(",")[0])) for line in lines if "kindyna/core" in line
    ]
    assert framed != []
    for place, line in framed:
        packed = Path(place).read_text("utf-8").split("\n")[line - 1]
        assert packed == origin(f"kindyna/{place.split('kindyna/', 1)[1]}").read_text("utf-8").split("\n")[line - 1]


def test_its_window_paints_beside_another_core(python: Path, libraries: tuple[Path, Path], beside: Path) -> None:
    script = python.with_name("kindyna.exe" if sys.platform == "win32" else "kindyna")
    words = ["--headless", "report", ROOT / "resources/examples/slider_crank.toml", "--out", "report.pdf"]
    done = run(beside, [beside, *libraries], script, *words)
    assert done.returncode == 0, done.stderr
    assert (beside / "report.pdf").read_bytes().startswith(b"%PDF")


def test_a_type_checker_sees_its_types(python: Path, libraries: tuple[Path, Path], tmp_path: Path) -> None:
    (tmp_path / "use.py").write_text(USE, "utf-8")
    purelib = run(tmp_path, [], python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))")
    links = Path(purelib.stdout.strip(), "libraries.pth")
    links.write_text(str(libraries[0]), "utf-8")
    try:
        done = run(tmp_path, [], sys.executable, "-m", "mypy", "--strict", "--python-executable", python, "use.py")
    finally:
        links.unlink()
    assert done.returncode == 0, done.stdout
