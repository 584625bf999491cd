"""The wheel: what lies in it, that it is the checkout line by line, and that it runs beside a folder named ``core``."""

import email
import json
import re
import shutil
import sys
import zipfile
from pathlib import Path

import pytest
from installed import ROOT, built, run

pytestmark = pytest.mark.wheel

PACKAGES = {"kindyna/core/": "core/", "kindyna/resources/": "resources/", "kindyna/CHANGELOG.md": "CHANGELOG.md",
            "kindyna/": "core/public/kindyna/", "kindyna_gui/": "kindyna_gui/"}  # fmt: skip
EXAMPLES = ["transfer_lift", "lecture_six_bar", "groove", "transfer_unit", "rocker_shoe"]
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
best: float = design.optimise({"cam.base_radius_mm": (400, 460)}, "drive_torque_nm:abs", {"radius_mm:min": {"min": 380}}).goal
radii: float = design.vary({"cam.base_radius_mm": (400, 460, 3)}, ["life_hours"]).inputs["cam.base_radius_mm"].max()
names: list[str] = [path.name for path in study.export("cam.dxf", tolerance=0.01, as_="arcs")]
lift: kd.Study = kd.measured("lift.csv", speed=300).study()
messages: list[str] = [finding.message for finding in study.at([0.0, 90.0]).findings]
try:
    kd.design({})
except kd.KindynaError as error:
    paths: list[str] = [fault.path for fault in error.faults]
"""


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


def test_the_wheel_of_the_source_distribution_is_the_same(sources: Path, wheel: Path, tmp_path: Path) -> None:
    done = built(sources, "wheel", tmp_path)
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
def test_what_cannot_be_packed_fails_the_build(sources: Path, tmp_path: Path, line: str, said: str) -> None:
    file = sources / "core/units.py"
    text = file.read_text("utf-8")
    try:
        file.write_text(f"{text}\n{line}\n", "utf-8")
        done = built(sources, "wheel", tmp_path)
    finally:
        file.write_text(text, "utf-8")
    assert done.returncode != 0
    assert said in done.stderr
    assert "units.py:" in done.stderr
    assert list(tmp_path.glob("*.whl")) == []


@pytest.mark.parametrize("order", ["kindyna.core.project, core.project", "core.project, kindyna.core.project"])
def test_another_core_is_imported_beside_it(
    python: Path, libraries: tuple[list[Path], list[Path]], beside: Path, order: str
) -> None:
    code = f"import {order}, kindyna; print(core.project.NAME, kindyna.core.project.load.__name__, kindyna.__version__)"
    done = run(beside, libraries[0], python, "-c", code)
    assert done.stdout == "another load 0.1.0\n", done.stderr


def test_every_module_is_imported_without_qt_and_with_it(
    python: Path, libraries: tuple[list[Path], list[Path]], tmp_path: Path
) -> None:
    done = run(tmp_path, libraries[0], python, "-c", IMPORT_ALL, "kindyna")
    assert done.returncode == 0, done.stderr
    count, unwanted = json.loads(done.stdout)
    assert (count > 250, unwanted) == (True, [])
    done = run(tmp_path, libraries[1], python, "-c", IMPORT_ALL, "kindyna_gui")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)[0] > 150


@pytest.mark.parametrize("example", EXAMPLES)
def test_its_tables_are_those_of_the_checkout(
    python: Path, libraries: tuple[list[Path], list[Path]], beside: Path, example: str
) -> None:
    file = ROOT / "resources/examples" / f"{example}.toml"
    done = run(beside, libraries[0], python, "-m", "kindyna", "export", file, "--out", "wheel")
    assert done.returncode == 0, done.stderr
    assert run(ROOT, [], sys.executable, "-m", "core", "export", file, "--out", beside / "checkout").returncode == 0
    folders = [beside / "wheel", beside / "checkout"]
    files = [{path.relative_to(at): path.read_bytes() for path in at.rglob("*") if path.is_file()} for at in folders]
    assert files[0] == files[1] != {}


def test_worker_processes_import_it_beside_another_core(
    python: Path, libraries: tuple[list[Path], list[Path]], beside: Path
) -> None:
    (beside / "lift.toml").write_bytes((ROOT / "resources/examples/transfer_lift.toml").read_bytes())
    (beside / "study.toml").write_text(STUDY, "utf-8")
    tables = []
    for workers in ("1", "2"):
        words = ["vary", "study.toml", "--out", f"{workers}.csv", "--workers", workers]
        done = run(beside, libraries[0], python, "-m", "kindyna", *words)
        assert done.returncode == 0, done.stderr
        tables.append((beside / f"{workers}.csv").read_text("utf-8").splitlines())
    assert len(tables[0]) == 1201
    assert tables[0] == tables[1]


def test_a_traceback_names_the_line_of_the_checkout(
    python: Path, libraries: tuple[list[Path], list[Path]], tmp_path: Path
) -> None:
    code = "from kindyna.core.project import load; load('nowhere.toml')"
    lines = run(tmp_path, libraries[0], python, "-c", code).stderr.splitlines()
    framed = [
        (line.split('"')[1], int(line.split("line ")[1].split(",")[0])) for line in lines if "kindyna/core" in line
    ]
    assert framed != []
    for place, line in framed:
        packed = Path(place).read_text("utf-8").split("\n")[line - 1]
        assert packed == origin(f"kindyna/{place.split('kindyna/', 1)[1]}").read_text("utf-8").split("\n")[line - 1]


def test_its_window_paints_beside_another_core(
    python: Path, libraries: tuple[list[Path], list[Path]], beside: Path
) -> None:
    script = python.with_name("kindyna.exe" if sys.platform == "win32" else "kindyna")
    words = ["--headless", "report", ROOT / "resources/examples/slider_crank.toml", "--out", "report.pdf"]
    done = run(beside, [beside, *libraries[1]], script, *words)
    assert done.returncode == 0, done.stderr
    assert (beside / "report.pdf").read_bytes().startswith(b"%PDF")


def test_a_type_checker_sees_its_types(with_libraries: Path, tmp_path: Path) -> None:
    (tmp_path / "use.py").write_text(USE, "utf-8")
    words = ["-m", "mypy", "--strict", "--python-executable", with_libraries, "use.py"]
    done = run(tmp_path, [], sys.executable, *words)
    assert done.returncode == 0, done.stdout


def test_it_is_small_and_says_what_it_is(wheel: Path) -> None:
    assert wheel.stat().st_size < 4_000_000
    archive = zipfile.ZipFile(wheel)
    parts = {part for name in archive.namelist() for part in name.split("/")}
    assert [part for part in parts if part.startswith(("tests", "test_", "conftest"))] == []
    said = email.message_from_bytes(archive.read("kindyna-0.1.0.dist-info/METADATA"))
    assert (said["Author"], said["License-Expression"]) == ("KINDYNA developers", "MIT")
    assert {"frames", "docs"} <= set(said.get_all("Provides-Extra", []))
    assert "Operating System :: Microsoft :: Windows" in said.get_all("Classifier", [])
    needed = [row.split(">=")[0] for row in said.get_all("Requires-Dist", []) if "extra" not in row]
    assert {"pandas", "matplotlib", "Sphinx", "pytest"}.isdisjoint(needed)


def test_its_selftest_runs_beside_another_core(
    python: Path, libraries: tuple[list[Path], list[Path]], beside: Path
) -> None:
    """Each example with the verdict that it has in the checkout."""
    words = ["-m", "kindyna_gui", "--headless", "selftest"]
    done = run(beside, [beside, *libraries[1]], python, *words)
    here = run(ROOT, [], sys.executable, *words)
    assert (done.returncode, done.stdout) == (here.returncode, here.stdout), done.stderr
    assert len(done.stdout.splitlines()) > 20


IN_THE_WHEEL = [(r"^(\s*from )core\b", r"\1kindyna.core"), (r'"core(\.\w)', r'"kindyna.core\1'), (r'"core"', '"kindyna"'),
                (r"-m core\b", "-m kindyna")]  # fmt: skip
"""Name of a module in the tests -> its name in the wheel."""


def test_the_tests_of_commands_and_jobs_pass_with_it(with_libraries: Path, beside: Path) -> None:
    others = shutil.ignore_patterns("__pycache__", "gui", "benchmarks", "test_make.py")
    shutil.copytree(ROOT / "tests", beside / "tests", ignore=others)
    shutil.copytree(ROOT / "resources", beside / "resources")
    shutil.copy(ROOT / "pyproject.toml", beside)
    for path in (beside / "tests").rglob("*.py"):
        text = path.read_text("utf-8")
        for here, there in IN_THE_WHEEL:
            text = re.sub(here, there, text, flags=re.MULTILINE)
        path.write_text(text, "utf-8")
    tests = ["tests/core/commands", "tests/core/public/test_jobs.py"]
    done = run(beside, [], with_libraries, "-m", "pytest", "-q", "-n", "2", *tests)
    assert done.returncode == 0, done.stdout
    assert int(re.findall(r"(\d+) passed", done.stdout)[-1]) > 200
