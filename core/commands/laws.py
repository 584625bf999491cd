"""The command ``laws``: the table of laws with their peak coefficients."""

from __future__ import annotations

import argparse

from core.commands import DONE, Painter
from core.making import laws_data, laws_text
from core.summary import to_json


def words(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print JSON; infinite = null")


def run(words: argparse.Namespace, painter: Painter | None) -> int:
    """The table of laws with their peak coefficients."""
    print(to_json(laws_data()) if words.json else laws_text(), end="")
    return DONE
