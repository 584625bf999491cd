"""No file makes a reader raise, fill the memory or take for ever: each is read in a process of its own with little of both."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

pytest.importorskip("resource")

from hostile import CELLS, CRASHED, READERS, outcomes, workbook

SEEDS = 200  # of each reader


def _controller(more: str, row: str = "{master}\\t{slave}") -> str:
    columns = 'columns = ["master", "slave"]'
    return f'[[controllers]]\nslug = "own"\nlabel = "Own"\ninterpolation = ["linear"]\n{columns}\nrow = "{row}"\n{more}'


def _dxf(entities: str, blocks: str = "") -> str:
    return f"0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"


def _table(head: str = "angle,lift", more: str = "") -> str:
    return "\n".join([head, *(f"{a},{a * (360 - a) / 1e4}" for a in range(0, 360, 4))]) + more


def _block(name: str, entities: str) -> str:
    return f"0\nBLOCK\n2\n{name}\n0\nLINE\n10\n0\n20\n0\n11\n1\n21\n1\n{entities}0\nENDBLK\n"


def _insert(name: str, columns: int = 1, rows: int = 1) -> str:
    return f"0\nINSERT\n2\n{name}\n10\n1\n70\n{columns}\n71\n{rows}\n44\n2\n45\n3\n"


def _doubled(k: int) -> str:
    return _block(f"B{k}", 2 * _insert(f"B{k - 1}"))


def _long_line(i: int) -> str:
    """A side of a zigzag, each of which is beside all others."""
    return f"0\nLINE\n10\n{100 * (i % 2)}\n20\n{0.01 * i}\n11\n{100 - 100 * (i % 2)}\n21\n{0.01 * (i + 1)}\n"


def _png(side: int) -> bytes:
    """The head of a picture that says how large it is."""
    head = b"IHDR" + struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    body = zlib.compress(bytes(100_000))
    parts = (head, b"IDAT" + body, b"IEND")
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(part) - 4) + part + struct.pack(">I", zlib.crc32(part)) for part in parts
    )


def _sparse() -> str:
    names = [f"column_{i}" for i in range(4000)]
    return "\n".join((",".join(names), ",".join("1" * 4000), *(["1,2"] * 200_000)))


CASES: dict[str, tuple[str, Callable[[], str | bytes], str]] = {
    "attribute of a number": ("controllers", lambda: _controller("", "{master.__class__}\\t{slave}"), "own: controllers[0].row"),
    "format spec": ("controllers", lambda: _controller("", "{master:{slave.__class__}}\\t{slave}"), "own: controllers[0].row"),
    "width": ("controllers", lambda: _controller("", "{master:>999999999}\\t{slave}"), "own: controllers[0].row"),
    "conversion": ("controllers", lambda: _controller("", "{master!r}\\t{slave}"), "own: controllers[0].row"),
    "single brace": ("controllers", lambda: _controller("", "{master}\\t{slave}}"), "own: controllers[0].row"),
    "place of no name": ("controllers", lambda: _controller('header = "{0}"'), "own: controllers[0].header"),
    "codec that is none": ("controllers", lambda: _controller('encoding = "zip"'), "own: controllers[0].encoding"),
    "path as ending": ("controllers", lambda: _controller('extension = "./../../e.txt"'), "own: controllers[0].extension"),
    "braces": ("controllers", lambda: _controller("", "{{{master}}}\\t{slave}"), ""),
    "long header": ("measured", lambda: _table("(" * 500_000), ""),
    "quotes without end": ("measured", lambda: _table(more='\n"' + "1," * 400_000), "2 are required"),
    "field beyond the csv module's": ("measured", lambda: _table(more='\n"' + "1" * 500_000 + '",2'), "required: a number"),
    "digits without end": ("measured", lambda: _table(more="\n" + "1" * 900_000 + "x,2"), "required: a number"),
    "wide table": ("graph", lambda: ",".join("a" * 300_000) + "\n" + ",".join("1" * 300_000), "16384 columns"),
    "many columns of few cells": ("graph", _sparse, "20000000 cells"),
    "comments of Pyslvs": ("pyslvs", lambda: "M[" + "#[" * 400_000, "no list of joints"),
    "blanks of Pyslvs": ("pyslvs", lambda: "M[J[R, A" + " " * 900_000 + "x]]", "unknown"),
    "elements in each other": ("linkage2", lambda: "<linkage2>" + "<a>" * 300_000, "nested"),
    "number of an address": ("pmks", lambda: _with_checksum("0.0.A.000.00A,A," + "Z" * 300 + ",0,0...."), "is not a number"),
    "keys of many parts": ("design", lambda: "x = {" + "a." * 400_000 + "a = 1}", "50 parts"),
    "lists in each other": ("design", lambda: "x = " + "[" * 500_000, "nested too deeply"),
    "digits of a number": ("design", lambda: "x = 1." + "0" * 900_000, "too many digits"),
    "array that contains itself": ("underlay", lambda: _dxf(_insert("B", 30_000, 30_000), _block("B", _insert("B", 9, 9))), ""),
    "spoiled entity": ("underlay", lambda: _dxf("0\nCIRCLE\n10\nx\n40\n1\n0\nSPLINE\n71\n99999\n40\n1\n10\n1\n"), ""),
    "no entity": ("underlay", lambda: "5\n1\n", "not a DXF"),
    "overlapping lines": ("motion-from", lambda: _dxf("".join(map(_long_line, range(19_000)))), ""),
    "large picture": ("logo", lambda: _png(30_000), ""),
    "graph of lists": ("graph-setup", lambda: "[" * 900_000, "not a graph"),
    "text that is no UTF-8": ("arguments", lambda: b"linkage-from\n\xed\xa0\x80\n--out\no.toml", ""),
    "number of a row": ("arguments", lambda: b"explain\nX\nloads.friction[" + b"9" * 5000 + b"]", "cannot be read"),
}  # fmt: skip
SLOW_CASES: dict[str, tuple[str, Callable[[], str | bytes], str]] = {
    "blanks of a header": ("measured", lambda: _table(" \t" * 400_000 + "x"), ""),
    "underscores": ("measured", lambda: _table("angle," + "_" * 900_000), ""),
    "comments": ("measured", lambda: "#a\n" * 300_000 + _table(), ""),
    "wide rows": ("graph", lambda: ("1," * 16_000 + "1\n") * 30, ""),
    "block of blocks": ("underlay", lambda: _dxf(_insert("B40"), "".join(map(_doubled, range(41)))), ""),
    "quoted keys": ("design", lambda: 'x = {"=,[".' + "a." * 400_000 + "a = 1}", "50 parts"),
}  # fmt: skip
"""Others of a kind that ``CASES`` has, each dear for its size."""


def _with_checksum(text: str) -> str:
    letters = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"
    return f"?{text}{letters[len(text) % 62]}"


def _refused_well(result: dict[str, object]) -> str:
    """What is wrong with an outcome; empty where nothing is."""
    said = str(result["said"])
    if result["code"] not in (0, 1, 2):
        how = "raised" if result["code"] == CRASHED else f"exit {result['code']}"
        return f"{result['reader']} {result['which']}: {how}: {said[-500:]}"
    if "Traceback" in said or (result["code"] == 2 and not said.strip()):
        return f"{result['reader']} {result['which']}: {said[-500:] or 'refused without a word'}"
    return ""


def _wrong_outcomes(
    cases: dict[str, tuple[str, Callable[[], str | bytes], str]], seeds: Sequence[int], folder: Path
) -> list[str]:
    """What is wrong with the outcomes of cases, and of some seeds of every reader, all read by one process."""
    rows: list[tuple[str, int | str]] = []
    for i, (reader, data, _) in enumerate(cases.values()):
        content = data()
        (folder / str(i)).write_bytes(content if isinstance(content, bytes) else content.encode())
        rows.append((reader, str(folder / str(i))))
    rows += [(name, seed) for name in READERS if name != "workbook" for seed in seeds]
    results = outcomes(rows)
    assert len(results) == len(rows)
    return [wrong for result in results if (wrong := _refused_well(result))] + [
        f"{name}: {result}"
        for (name, (_, _, phrase)), result in zip(cases.items(), results, strict=False)
        if phrase and (phrase not in result["said"] or result["code"] != 2)
    ]


def test_files_that_once_ran_away_and_a_hostile_file_of_every_reader_end_in_a_line(tmp_path: Path) -> None:
    assert not _wrong_outcomes(CASES, (1,), tmp_path)


@pytest.mark.stress
def test_more_files_that_once_ran_away_and_two_hostile_files_of_every_reader_end_in_a_line(tmp_path: Path) -> None:
    assert not _wrong_outcomes(SLOW_CASES, (0, 2), tmp_path)


@pytest.mark.parametrize(
    ("cells", "sheets", "code", "phrase"),
    [
        (CELLS, None, 0, ""),
        (CELLS + '<row><c r="XFD1048576"><v>1</v></c></row>', None, 2, "500 MB"),
        (CELLS + '<row><c r="ZZ100000"><v>1</v></c></row>', None, 2, "500 MB"),
        (CELLS + '<row><c r="1A"><v>1</v></c></row>', None, 2, "cannot be read"),
        (CELLS, "", 2, "no sheet"),
    ],
    ids=["good", "last cell", "far cell", "cell of no name", "no sheet"],
)
def test_a_workbook_is_read_within_limits(
    tmp_path: Path, cells: str, sheets: str | None, code: int, phrase: str
) -> None:
    pytest.importorskip("python_calamine")
    (tmp_path / "x").write_bytes(workbook(cells) if sheets is None else workbook(cells, sheets))
    (result,) = outcomes([("workbook", str(tmp_path / "x"))])
    assert (result["code"], phrase in result["said"]) == (code, True), result


@pytest.mark.fuzz
@pytest.mark.parametrize("reader", READERS)
def test_hostile_files_are_read_or_refused(reader: str) -> None:
    if reader == "workbook":
        pytest.importorskip("python_calamine")
    results = outcomes([(reader, seed) for seed in range(SEEDS)])
    assert len(results) == SEEDS
    assert not [wrong for result in results if (wrong := _refused_well(result))]
