"""core.file_names: a text from data is a name of a file on every system, never a path."""

from pathlib import PurePosixPath, PureWindowsPath
from random import Random

import pytest

from core.file_names import LONGEST, file_name

LETTERS = 'aA1 ./\\\\:*?"<>|\0\n\x7f~$캠é-_'
DEVICES = ("con", "PRN", "Aux", "nul", "com1", "LPT9", "com0")


def is_name(text: str) -> bool:
    """Whether it is one part of a path, of POSIX and of Windows, as it is."""
    return text == "" or (
        (PurePosixPath(text).parts == PureWindowsPath(text).parts == (text,) and text.strip(". ") == text)
        and not PureWindowsPath(f"{text}.toml").is_reserved()
        and len(text.encode()) <= LONGEST + 1
        and text.isprintable()
    )


def test_a_text_of_anything_is_a_name() -> None:
    rng = Random(5)
    for _ in range(5000):
        parts = [rng.choice([*LETTERS, *LETTERS, "..", "../", *DEVICES]) for _ in range(rng.choice((1, 2, 3, 9, 400)))]
        assert is_name(file_name("".join(parts))), parts


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Lift 3.2", "Lift 3.2"),
        ("Größe, 캠", "Größe, 캠"),
        ("../../etc/passwd", "-..-etc-passwd"),
        ("CON", "CON_"),
        ("con.v2", "con_.v2"),
        ("com1 .x", "com1_.x"),
        ("...", ""),
        ("a. ", "a"),
    ],
)
def test_what_can_stay_stays(text: str, name: str) -> None:
    assert file_name(text) == name
