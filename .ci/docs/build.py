"""Builds the pages in ``out/docs``; the source of Sphinx is written to ``out/docs-source``."""

import os
import shutil
import sys
from pathlib import Path

from built import faults
from sphinx.cmd.build import build_main

HERE, OUT = Path(__file__).parent, Path(__file__).parents[2] / "out"


def main() -> int:
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    from cells import members
    from pages import write

    import kindyna as kd

    source, target = OUT / "docs-source", OUT / "docs"
    for folder in (source, target):
        shutil.rmtree(folder, ignore_errors=True)
    write(source)
    options = ["-q", "-W", "--keep-going", "-b", "html", "-c", str(HERE), "-d", str(source / ".doctrees")]
    if code := build_main([*options, str(source), str(target)]):
        return code
    names = {
        f"kindyna.{name}{'.' * bool(member)}{member}"
        for name in kd.__all__
        for member in ("", *dict(members(getattr(kd, name))))
    }
    wrong = faults(target, sorted(names))
    print(*wrong, sep="\n", end="\n" if wrong else "", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
