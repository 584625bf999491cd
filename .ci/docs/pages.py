"""All pages, written for Sphinx: the help of the window, the library, notebooks, examples, and tables of core."""

import re
import shutil
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

from cells import FENCE, Kernel, notebook, shown
from core_tables import fields, reference
from library import library
from markup import contents, text, write_page

import kindyna as kd
from core.process import resources
from core.project import load
from core.project.reading_faults import subjects

NOTEBOOKS = ("ten_minutes", "tolerances", "linkage_and_servo")
"""Notebooks in the order in which they are read; others follow by name."""
EXTREMES = (("pressure_angle_deg", "max"), ("torque_nm", "abs"), ("transmission_", "min"), ("driver_torque_nm", "abs"))
"""Beginning of a channel, and which of its values the gallery shows: the first that an example has."""


def write(folder: Path) -> None:
    """Write all pages into an empty folder."""
    guide(folder / "guide")
    library(folder / "library")
    reference(folder / "reference")
    notebooks(folder / "notebooks")
    gallery(folder / "gallery")
    write_page(folder / "index.md", text("index"))


# -- user guide -------------------------------------------------------------------------------------------------


def guide(folder: Path) -> None:
    """The pages of the window's help, with its tables; the fields are those of all kinds of designs."""
    from kindyna_gui.help import PAGES
    from kindyna_gui.places import default_design, help_text
    from kindyna_gui.screenshots import dismiss, hidden_window

    window = hidden_window(load(default_design()), (1280, 800))
    try:
        for name, (_, complete) in PAGES.items():
            page = text(name, fields()) if name == "fields" else complete(help_text(name), window)
            write_page(folder / f"{name}.md", with_outputs(without_window_addresses(page), name))
    finally:
        dismiss(window)
    for ending in ("png", "webp"):
        for picture in (resources() / "help").glob(f"*.{ending}"):
            shutil.copy(picture, folder)
    listed = [name for name in PAGES if name not in ("changes", "python")]
    write_page(folder / "index.md", f"# User guide\n\nThe pages of *Help* in the window.\n\n{contents(listed)}")


def without_window_addresses(page: str) -> str:
    """The page with the words of links that lead to a part of the window, which only the window can open."""
    return re.sub(r"\[([^\]]+)\]\(kindyna:[^)]*\)", r"\1", page)


def with_outputs(page: str, place: str) -> str:
    """The page with the output of each block of Python below it; files that it writes are in a folder that is removed."""
    kernel = Kernel()
    with TemporaryDirectory() as scratch, chdir(scratch):
        return FENCE.sub(lambda block: f"{block[0]}\n\n{raw(shown(*kernel.run(block[1], place)))}\n", page)


def raw(html: str) -> str:
    """HTML between blocks of Markdown."""
    return f"````{{raw}} html\n{html}\n````" if html else ""


# -- notebooks --------------------------------------------------------------------------------------------------


def notebooks(folder: Path) -> None:
    """The notebooks with their outputs."""
    notebooks = {path.stem: path for path in (resources() / "notebooks").glob("*.ipynb")}
    names = sorted(notebooks, key=lambda name: (NOTEBOOKS.index(name) if name in NOTEBOOKS else len(NOTEBOOKS), name))
    for name in names:
        cells = [
            cell.text if cell.kind == "markdown" else f"```python\n{cell.text}\n```"
            for cell in notebook(notebooks[name])
        ]
        page = with_outputs("\n\n".join(cells), notebooks[name].name)
        write_page(folder / f"{name}.md", f"{page}\n\nFor Jupyter: {{download}}`{name}.ipynb <{name}.ipynb>`\n")
        shutil.copy(notebooks[name], folder)
    write_page(folder / "index.md", f"# Notebooks\n\n{contents(names)}")


# -- gallery ----------------------------------------------------------------------------------------------------


def gallery(folder: Path) -> None:
    """A page for each example, and an index with their pictures."""
    index = ["# Gallery", "Every example, with the lines of Python that draw it and list its findings."]
    for title, examples in subjects():
        cards = []
        for row in examples:
            design = kd.example(row.file)
            lines = f"```python\n{example_lines(row.file, design)}\n```"
            page = [
                f"# {row.name}",
                row.text,
                with_outputs(lines, row.file),
                FILE.format(slug=row.file, toml=design.toml),
            ]
            write_page(folder / f"{row.file}.md", "\n\n".join(page))
            write_page(folder / f"{row.file}.toml", design.toml)
            write_page(folder / f"{row.file}.svg", design.study().picture(at_deg=45.0).svg)
            cards.append(CARD.format(slug=row.file, name=row.name, text=row.text))
        index += [f"## {title}", f"````{{container}} cards\n{''.join(cards)}````"]
    slugs = [row.file for _, examples in subjects() for row in examples]
    write_page(folder / "index.md", "\n\n".join([*index, contents(slugs, ":hidden:")]))


CARD = """
```{{container}} card
[![{name}]({slug}.svg)]({slug}.md)

**[{name}]({slug}.md)**: {text}
```
"""

FILE = """<details>
<summary>The file of the design</summary>

{{download}}`{slug}.toml <{slug}.toml>`

```toml
{toml}```

</details>
"""


def example_lines(slug: str, design: kd.Design) -> str:
    """Lines of Python that study an example and draw it."""
    channels = design.study().channels
    name, of = next((name, of) for start, of in EXTREMES for name in channels if name.startswith(start))
    return f"""import kindyna as kd

design = kd.example("{slug}")
study = design.study(samples=720)
extreme = study.extreme("{name}", "{of}")
print(f"{name}: {{extreme.value:.5g}} {{extreme.unit}} at {{extreme.angle_deg:.5g}}°")
for finding in design.findings:
    print(f"{{finding.severity}}: {{finding.message}}")
study.picture(at_deg=extreme.angle_deg)"""
