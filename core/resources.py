"""Where the program's own files are: inside the installed package, else in the checkout."""

from __future__ import annotations

from pathlib import Path

_ROOT = Path(__file__).resolve().parents[1]


def resources() -> Path:
    """The folder of examples, materials, help, icons and translations."""
    installed = _ROOT / "kindyna_gui" / "resources"
    return installed if installed.is_dir() else _ROOT / "resources"
