"""The summary that stands beside a table which cannot say itself what it is."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from pathlib import Path

from core.errors import FileError
from core.project.files import read_text

SUMMARY = "summary.json"


def require_own(path: Path, keys: Collection[str]) -> None:
    """A summary that stands at this path already must be of such a table, too, with these keys: that of an export is not replaced
    unasked. Raises FileError."""
    if not path.exists():
        return
    try:
        own = set(facts_in(read_text(path))) >= set(keys)
    except ValueError:
        own = False
    if not own:
        raise FileError(f"{path}: cannot be written: it belongs to something else; choose another folder")


def facts_in(text: str) -> Mapping[str, object]:
    """What a summary says. Raises ValueError where it is none."""
    data = json.loads(text)
    if not isinstance(data, dict):
        raise ValueError("no table")
    return data


__all__ = ["SUMMARY", "facts_in", "require_own"]
