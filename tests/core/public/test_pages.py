"""What a reader copies from the pages, the README, the docstrings and the notebooks: it runs, and every name is described."""

import doctest
import html
import inspect
import re
import shlex
import tomllib
from pathlib import Path

import pytest
from built import faults
from cells import Kernel, blocks, docstring_examples, members, notebook
from core_tables import commands, controllers, fields, findings, laws

import kindyna as kd
from core.__main__ import parser
from core.commands import COMMANDS
from core.findings import ROWS
from core.laws import LAWS
from core.output.controllers.rows import shipped_controllers
from kindyna_gui import headless

ROOT = Path(__file__).parents[3]
PAGES = [ROOT / "README.md", *sorted((ROOT / "resources/help").glob("*.md"))]
NOTEBOOKS = sorted((ROOT / "resources/notebooks").glob("*.ipynb"))
INDENTED = re.compile(r"(?<=\n\n)(?:    .*\n(?:\n(?=    ))?)+")
PUBLIC = [(name, getattr(kd, name)) for name in kd.__all__]
FUNCTIONS = [(name, item) for name, item in PUBLIC if not isinstance(item, type)]
METHODS = [(f"{kind}.{name}", item) for kind, owner in PUBLIC for name, item in members(owner) if callable(item)]


def indented(page: Path, *starts: str) -> list[str]:
    """Indented blocks of a page that start like that, and fenced ones of TOML where that is one."""
    text = page.read_text("utf-8")
    found = [re.sub("^    ", "", block, flags=re.MULTILINE) for block in INDENTED.findall(text)]
    fenced = re.findall(r"^```toml\n(.*?)^```$", text, re.MULTILINE | re.DOTALL) if "[" in starts else []
    return [block for block in found if block.startswith(starts)] + fenced


def needs_pandas(code: str) -> None:
    if "to_frame" in code or "pandas" in code:
        pytest.importorskip("pandas")


# -- what runs ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "page", [page for page in PAGES if blocks(page.read_text("utf-8"))], ids=lambda page: page.stem
)
def test_python_of_pages_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    kernel, code = Kernel(), blocks(page.read_text("utf-8"))
    needs_pandas("".join(code))
    for number, block in enumerate(code, 1):
        kernel.run(block, f"{page.name}, block {number}")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
@pytest.mark.stress
def test_cells_of_notebooks_run(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    cells, kernel = notebook(path), Kernel()
    needs_pandas("".join(cell.text for cell in cells))
    shown = [
        kernel.run(cell.text, f"{path.name}[{number}]") for number, cell in enumerate(cells) if cell.kind == "code"
    ]
    assert sum(value is not None or printed != "" for printed, value in shown) >= 3


@pytest.mark.parametrize("example", [row for row in docstring_examples(kd) if row.examples], ids=lambda row: row.name)
def test_examples_of_docstrings_run(example: doctest.DocTest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    needs_pandas(example.docstring or "")
    report: list[str] = []
    assert doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example, out=report.append).failed == 0, "".join(
        report
    )


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_commands_and_files_of_pages_are_read(page: Path) -> None:
    """A synopsis too: its first alternatives, with what is in brackets."""
    rows = {**COMMANDS, **headless.COMMANDS}
    lines = "".join(indented(page, "kindyna --headless", "python -m"))
    for line in re.sub(r"\n +", " ", lines).splitlines():
        words = [
            word.partition("|")[0]
            for word in shlex.split(re.sub(r"[\[\]]|^.*?(?:--headless|-m core|-m kindyna) ", "", line))
        ]
        parser("kindyna", rows).parse_args(words)
    for block in indented(page, "["):
        assert tomllib.loads(re.sub(r"^ *\.\.\.$", "", block, flags=re.MULTILINE)) != {}
    targets = re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE)
    named = re.findall(r"^make ([\w-]+)", "".join(indented(page, "make")), re.MULTILINE)
    assert set(named) <= set(targets)


# -- what is described ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "item"), [*FUNCTIONS, *METHODS], ids=lambda row: row if isinstance(row, str) else "")
def test_parameters_are_described_and_an_example_follows(name: str, item: object) -> None:
    section = re.search(r"\nParameters\n-+\n(.*?)(?=\n\w[\w ]*\n---|\Z)", inspect.getdoc(item) or "", re.DOTALL)
    described = re.findall(
        r"^\*{0,2}(\w[\w, ]*?)(?: : .+)?\n    \S", f"\n{section[1] if section else ''}", re.MULTILINE
    )
    parameters = [row for row in inspect.signature(item).parameters if row != "self"]  # type: ignore[arg-type]
    assert [word for words in described for word in words.split(", ")] == parameters
    assert re.search(r"^Examples\n-+\n>>> ", inspect.getdoc(item) or "", re.MULTILINE)


@pytest.mark.parametrize(("name", "item"), PUBLIC, ids=lambda row: row if isinstance(row, str) else "")
def test_names_have_a_text_an_example_and_members_with_texts(name: str, item: object) -> None:
    text = inspect.getdoc(item) or ""
    assert re.search(r"^Examples\n-+\n>>> ", text, re.MULTILINE)
    fields = re.findall(r"^(\w[\w, ]*?) : ", text.partition("\nAttributes\n")[2], re.MULTILINE)
    described = {word for words in fields for word in words.split(", ")}
    unnamed = [(member, value) for member, value in members(item) if member not in described]
    assert [member for member, value in unnamed if isinstance(value, str) or not inspect.getdoc(value)] == []


# -- built pages ----------------------------------------------------------------------------------------------


def test_tables_list_every_row_of_core() -> None:
    rows = {laws: LAWS, findings: ROWS, commands: {**COMMANDS, **headless.COMMANDS}, controllers: shipped_controllers()}
    for table, names in rows.items():
        listed = set(re.findall(r"<code>([\w.-]+)</code>|^## ([\w-]+)$", table(), re.MULTILINE))
        assert set(names) - {word for words in listed for word in words} == set()
    assert {"cam.base_radius_mm", "linkage.links[i].points.NAME.x_mm"} <= set(
        re.findall(r"<code>(.*?)</code>", html.unescape(fields()))
    )


def test_findings_have_a_severity_that_their_table_lists() -> None:
    listed = dict(re.findall(r"<code>([\w.-]+)</code> \| ([\w ]+) \|", findings()))
    assert set(listed) == set(ROWS)
    rocker, lift, bar = (kd.example(slug) for slug in ("rocker_cam", "transfer_lift", "four_bar"))
    designs = [
        *map(kd.example, ("kim_1990", "groove", "lecture_six_bar")),
        rocker.edit({"cam.thickness_mm": None, "limits.contact_pressure_mpa": 100.0}),
        rocker.edit({"shaft.speed_rpm": 3000.0}),
        lift.edit({"cam.base_radius_mm": 150.0}),
        bar.edit({"linkage.links[1].points.A.x_mm": 200.0}),
    ]
    shown = {(finding.code, finding.severity) for design in designs for finding in design.findings}
    assert len(shown) > 8
    assert {severity for _, severity in shown} == {"error", "warning", "note"}
    assert [row for row in shown if row[1] not in listed[row[0]].split(" or ")] == []


def test_faults_of_built_pages_are_listed(tmp_path: Path) -> None:
    good = (
        '<a href="#there" id="there"></a><a href="b.html#here"></a><a href="https://example.org"></a><img src="c.svg"/>'
    )
    bad = (
        '<p id="here"></p><a href="#nowhere"></a><a href="d.html"></a><a href="kindyna:motion"></a><img src="https://example.org/e.png">'
        '<link rel="stylesheet" href="//example.org/f.css"><p style="background: url(http://example.org/g.png)"></p>'
    )
    for name, text in {
        "a.html": good,
        "b.html": bad,
        "c.svg": "<svg/>",
        "h.css": "@import 'https://example.org/i.css';",
    }.items():
        (tmp_path / name).write_text(text, "utf-8")
    assert sorted(faults(tmp_path, {"there", "missing"})) == [
        "b.html: #nowhere leads to no anchor",
        "b.html: d.html leads to no file",
        "b.html: kindyna:motion leads to no file",
        "b.html: loads //example.org/f.css",
        "b.html: loads http://example.org/g.png",
        "b.html: loads https://example.org/e.png",
        "h.css: loads https://example.org/i.css",
        "missing: no page has this anchor",
    ]
