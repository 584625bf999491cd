"""Suggestions for misspelled keys and words: whatever is named is accepted when it is written."""

import copy
import random
import re
import tomllib
from collections.abc import Iterator
from typing import Any

import pytest
import tomli_w
from sampled import spread

from core.errors import DesignError, Fault
from core.process import resources
from core.project import loads

EXAMPLES = [
    file.read_text("utf-8")
    for file in sorted((resources() / "examples").glob("*.toml"))
    if "follows" not in (text := file.read_text("utf-8")) and "file = " not in text
]


def tables(value: Any, path: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Every table of a file, with its path."""
    if isinstance(value, dict):
        yield path, value
        for key, inner in value.items():
            yield from tables(inner, f"{path}.{key}".lstrip("."))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from tables(inner, f"{path}[{i}]")


def misspelled(dice: random.Random, word: str) -> str:
    at = dice.randrange(len(word))
    return dice.choice([word[:at] + word[at + 1 :], f"{word[:at]}e{word[at:]}", f"{word}s"])


def faults_in(table: dict[str, Any]) -> tuple[Fault, ...]:
    try:
        loads(tomli_w.dumps(table))
    except DesignError as error:
        return error.faults
    return ()


@pytest.mark.parametrize("seed", spread(list(range(400)), 12))
def test_a_suggested_key_is_accepted_where_it_is_suggested(seed: int) -> None:
    """A key of any table, misspelled, in any other: what is suggested is not there yet, and has no fault with the value that was given."""
    dice = random.Random(seed)
    keys = [
        (key, value) for text in EXAMPLES for _, table in tables(tomllib.loads(text)) for key, value in table.items()
    ]
    for _ in range(8):
        design = tomllib.loads(dice.choice(EXAMPLES))
        path, table = dice.choice(list(tables(design)))
        key, value = dice.choice(keys)
        wrong = misspelled(dice, key)
        if not wrong or wrong in table:
            continue
        table[wrong] = copy.deepcopy(value)
        at = f"{path}.{wrong}".lstrip(".")
        meant = [re.search(r"did you mean '(.*)'", fault.problem) for fault in faults_in(design) if fault.path == at]
        for word in (match[1] for match in meant if match):
            assert word not in table
            table[word] = table.pop(wrong)
            right = f"{path}.{word}".lstrip(".")
            assert not [fault for fault in faults_in(design) if fault.path.startswith(right)], (at, word)


@pytest.mark.parametrize(
    ("line", "by", "key", "meant"),
    [
        ('law = "dwell"', 'law = "dwell"\nrise_m = 5.0', "motion.segments[0].rise_m", None),
        ("cycloidal", "cyclodial", "motion.segments[1].law", "cycloidal"),
        ("span_deg = 90.0", "span_dg = 90.0", "motion.segments[1].span_dg", "span_deg"),
        ("base_radius_mm = 40.0", "base_radius_mm = 40.0\nbase_radus_mm = 40.0", "cam.base_radus_mm", None),
        ("base_radius_mm = 40.0", "base_radus_mm = 40.0", "cam.base_radus_mm", "base_radius_mm"),
    ],
)
def test_nothing_is_suggested_that_would_be_refused(line: str, by: str, key: str, meant: str | None) -> None:
    """A dwell has no rise; what is there already need not be written again."""
    text = """
format = 1
name = "pusher"
[motion]
start_mm = 0.0
[[motion.segments]]
law = "dwell"
span_deg = 180.0
[[motion.segments]]
law = "cycloidal"
span_deg = 90.0
rise_mm = 10.0
[[motion.segments]]
law = "cycloidal"
span_deg = 90
rise_mm = -10.0
[follower]
kind = "translating"
offset_mm = 0.0
[cam]
base_radius_mm = 40.0
roller_radius_mm = 8.0
[shaft]
rotation = "ccw"
speed_rpm = 60.0
"""
    changed = text.replace(line, by, 1)
    assert loads(text).name == "pusher"
    with pytest.raises(DesignError) as caught:
        loads(changed)
    (problem,) = [fault.problem for fault in caught.value.faults if fault.path == key]
    assert ("did you mean" in problem) == (meant is not None)
    assert meant is None or f"did you mean {meant!r}?" in problem
