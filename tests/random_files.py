"""Files of every kind for a user who opens anything: designs, tables, and both of them damaged in a repeatable manner."""

from __future__ import annotations

import math
from pathlib import Path
from random import Random

ENTRIES = ("nan", "inf", "-1", "0", "1e300", '"x"', "[]", "true", "{}", "1979-05-27")  # in place of an entry of a file


def damaged(text: str, rng: Random) -> bytes:
    """A design's text with something wrong in it, or nothing."""
    lines = text.splitlines()
    for _ in range(rng.choice((0, 1, 1, 2, 6))):
        i = rng.randrange(len(lines))
        key, equals, _ = lines[i].partition("=")
        kind = rng.randrange(6)
        if kind == 0:
            del lines[i]
        elif kind == 1:
            lines.insert(i, lines[rng.randrange(len(lines))])
        elif kind == 2:
            lines[i] = "".join(rng.sample(lines[i], len(lines[i])))
        elif equals:
            lines[i] = f"{key}= {rng.choice(ENTRIES)}"
        if not lines:
            lines = ["#"]
    data = "\n".join(lines).encode()
    return rng.choice((data, data, data, data[: rng.randrange(len(data) + 1)], b"\xff\x00" + data))


def table(rng: Random) -> bytes:
    """A measured lift over the cam angle; some rows, or the whole of its format, may be wrong."""
    rows = rng.choice((2, 36, 360))
    mark, point = rng.choice(((",", "."), (";", ","), ("\t", "."), (" ", ".")))
    lines = rng.choice(([], ["angle_deg,lift_mm"], ["Winkel;Hub", "°;mm"], ["\x9b31m"]))[:]
    for i in range(rows):
        angle = 360.0 * i / rows
        lift = 4.5 * (1.0 - math.cos(math.radians(angle))) * (1.0 + 1e-4 * rng.random())
        lines.append(mark.join(f"{x:.6g}".replace(".", point) for x in (angle, lift)))
    for _ in range(rng.choice((0, 0, 1, 5))):
        lines[rng.randrange(len(lines))] = rng.choice(("", "12", "a b c", "0,0", "1e400;nan", "1 2 3 4 5"))
    return "\n".join(lines).encode(rng.choice(("utf-8", "utf-16", "latin-1")), "replace")


def write_files(folder: Path, designs: list[Path], rng: Random) -> list[Path]:
    """Write designs, good and damaged, and tables into a folder; all paths, some of which cannot be read."""
    folder.mkdir(parents=True, exist_ok=True)
    for i in range(24):
        text = rng.choice(designs).read_text(encoding="utf-8")
        (folder / f"damaged_{i}.toml").write_bytes(damaged(text, rng))
    for path in designs:
        (folder / path.name).write_bytes(path.read_bytes())
    for i in range(12):
        (folder / f"lift_{i}.csv").write_bytes(table(rng))
    (folder / "empty.toml").write_bytes(b"")
    (folder / "a folder.toml").mkdir(exist_ok=True)
    return [
        *sorted(folder.iterdir()),
        folder / "there is none.toml",
        folder / "nowhere" / "x.toml",
        Path("/proc/x.toml"),
    ]


__all__ = ["write_files"]
