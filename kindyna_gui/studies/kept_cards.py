"""Cards of the board between runs of the program: in a file of each design in the user's folder, written whole or not at all."""

from __future__ import annotations

import json
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

from core.bounds import bounded_json
from core.errors import KindynaError
from core.project import dumps, loads
from core.project.files import read_text, write_into
from kindyna_gui.places import state_folder
from kindyna_gui.studies.board import Card

FOLDER = "boards"


def _file(of: str) -> Path:
    return state_folder() / FOLDER / f"{sha256(of.encode()).hexdigest()[:24]}.json"


def read_cards(of: str) -> list[Card]:
    """Those of a design, by its file or its name; none where nothing was kept, or what was kept cannot be read."""
    try:
        rows = bounded_json(read_text(_file(of)))["cards"]
        return [
            Card(loads(row["design"]), {name: (value, text) for name, (value, text) in row["values"].items()})
            for row in rows
        ]
    except (OSError, ValueError, KeyError, TypeError, AttributeError, KindynaError):
        return []


def write_cards(of: str, cards: Sequence[Card]) -> None:
    """Keep them. Raises FileError."""
    rows = [{"design": dumps(card.design), "values": dict(card.values)} for card in cards]
    text = json.dumps({"of": of, "cards": rows}, ensure_ascii=False, indent=1)
    write_into(_file(of).parent, {_file(of).name: text})


__all__ = ["read_cards", "write_cards"]
