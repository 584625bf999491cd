"""Checks the types in the Python of pages, README and notebooks, as a user's ``mypy --strict`` does."""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from cells import blocks, notebook
from mypy.main import main

ROOT = Path(__file__).parents[2]


def scripts() -> dict[str, str]:
    """Name -> the Python of a page or a notebook, without the values that its cells only show."""
    pages = [ROOT / "README.md", *sorted((ROOT / "resources/help").glob("*.md"))]
    result = {page.stem: "\n".join(blocks(page.read_text("utf-8"))) for page in pages}
    for path in (ROOT / "resources/notebooks").glob("*.ipynb"):
        result[path.stem] = "\n".join(cell.text for cell in notebook(path) if cell.kind == "code")
    return {name: text for name, text in result.items() if text}


with TemporaryDirectory() as folder:
    for name, text in scripts().items():
        Path(folder, f"{name.lower()}_page.py").write_text(text, "utf-8", newline="\n")
    options = ["--strict", "--allow-redefinition", "--config-file", str(ROOT / "pyproject.toml")]
    sys.argv[1:] = [*options, *map(str, sorted(Path(folder).iterdir()))]
    main(clean_exit=True)
