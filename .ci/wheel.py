"""Packs the wheel: ``core`` of the checkout is ``kindyna.core`` there, and the imports that name it follow.

Only import statements change, each on its own line, so that the line of a traceback is the line in the checkout.
"""

import ast
import re
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

PACKAGES = {"core/public/kindyna": "kindyna", "core": "kindyna/core", "kindyna_gui": "kindyna_gui"}
STATEMENT = re.compile(r"(\s*from )(core\b)")
MODULE = re.compile(r"(?<![\w.-])core\.\w|^core\.?$|-m core\b")


def rewritten(source: str, name: str) -> str:
    """The source with ``from kindyna.core`` for ``from core``. Raises ValueError where that cannot be written."""
    tree, lines = ast.parse(source), source.split("\n")
    documentation = {node.value for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        at = f"{name}:{getattr(node, 'lineno', 0)}"
        if isinstance(node, ast.Import) and any(alias.name.split(".")[0] == "core" for alias in node.names):
            raise ValueError(f"{at}: 'import core' cannot be packed; write 'from core... import ...'")
        if isinstance(node, ast.Constant) and node not in documentation and MODULE.search(str(node.value)):
            raise ValueError(f"{at}: {node.value!r} names a module; write it relative to the package (__package__)")
        if isinstance(node, ast.ImportFrom) and not node.level and str(node.module).split(".")[0] == "core":
            line = lines[node.lineno - 1]
            if not STATEMENT.match(line):
                raise ValueError(f"{at}: {line.strip()!r} cannot be packed; write one import statement a line")
            lines[node.lineno - 1] = STATEMENT.sub(r"\1kindyna.\2", line, count=1)
    return "\n".join(lines)


class Hook(BuildHookInterface):
    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if version == "editable":
            return
        root, self.folder = Path(self.root), TemporaryDirectory()
        for number, (source, target) in enumerate(PACKAGES.items()):
            build_data["force_include"][f"{self.folder.name}/{number}"] = target
            for path in [*(root / source).rglob("*.py"), root / source / "py.typed"]:
                if source == "core" and path.is_relative_to(root / "core/public"):
                    continue
                copy = Path(self.folder.name, str(number), path.relative_to(root / source))
                copy.parent.mkdir(parents=True, exist_ok=True)
                text = path.read_text("utf-8")
                copy.write_text(rewritten(text, str(path)) if path.suffix == ".py" else text, "utf-8", newline="\n")
        build_data["force_include"]["CHANGELOG.md"] = "kindyna/CHANGELOG.md"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        if version != "editable":
            self.folder.cleanup()
