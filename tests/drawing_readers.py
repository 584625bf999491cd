"""Reading drawings and programs without what wrote them: DXF tag by tag, SVG by its paths, G-code move by move; curves densely."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

SVG = "{http://www.w3.org/2000/svg}"


@dataclass
class Entity:
    """A DXF entity: its tags in order, code and text."""

    kind: str
    tags: list[tuple[int, str]] = field(default_factory=list)

    def all(self, code: int) -> np.ndarray:
        return np.array([float(text) for c, text in self.tags if c == code])

    @property
    def layer(self) -> str:
        return next(text for code, text in self.tags if code == 8)


def tags(path: Path) -> Iterator[tuple[int, str]]:
    lines = path.read_text("utf-8").split("\n")
    for code, text in zip(lines[::2], lines[1::2], strict=False):
        yield int(code), text.strip()


def comments(path: Path) -> list[str]:
    return [text for code, text in tags(path) if code == 999]


def header(path: Path, name: str) -> list[float]:
    """Numbers of a header variable."""
    found, rows = False, []
    for code, text in tags(path):
        if code == 9:
            if found:
                break
            found = text == name
        elif found and code != 0:
            rows.append(float(text))
    return rows


def entities(path: Path) -> list[Entity]:
    inside, found = False, []
    for code, text in tags(path):
        if code == 2 and text == "ENTITIES":
            inside = True
        elif code == 0 and inside:
            if text == "ENDSEC":
                break
            found.append(Entity(text))
        elif inside and found:
            found[-1].tags.append((code, text))
    return found


def on_layer(path: Path, layer: str) -> Entity:
    (entity,) = [each for each in entities(path) if each.layer == layer]
    return entity


def arc_chain(entity: Entity) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and bulges of a closed LWPOLYLINE; a bulge of 0 need not be written."""
    assert entity.kind == "LWPOLYLINE"
    assert int(entity.all(70)[0]) & 1, "closed"
    points, bulges = [], []
    for code, text in entity.tags:
        if code == 10:
            points.append(complex(float(text)))
            bulges.append(0.0)
        elif code == 20:
            points[-1] += 1j * float(text)
        elif code == 42:
            bulges[-1] = float(text)
    return np.array(points), np.array(bulges)


def tangents(p: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions [rad] of each arc where it starts and where it ends: chord less, and plus, half the turn."""
    chord = np.angle(np.roll(p, -1) - p)
    return chord - 2.0 * np.arctan(b), chord + 2.0 * np.arctan(b)


def along_arcs(p: np.ndarray, b: np.ndarray, count: int) -> np.ndarray:
    """Points of a closed chain of arcs, so many on each, by its turning: a chord of part of the turn from the start."""
    part = np.arange(count) / count
    turn, chord = 4.0 * np.arctan(b)[:, None], (np.roll(p, -1) - p)[:, None]
    bent = np.abs(turn) > 1e-9
    share = np.where(bent, np.sin(0.5 * turn * part) / np.where(bent, np.sin(0.5 * turn), 1.0), part)
    return (p[:, None] + chord * share * np.exp(0.5j * turn * (part - 1.0))).ravel()


def along_spline(entity: Entity, count: int) -> np.ndarray:
    """Points of a SPLINE, so many in each span of its knots, by de Boor."""
    assert entity.kind == "SPLINE"
    degree, knots = int(entity.all(71)[0]), entity.all(40)
    points = entity.all(10) + 1j * entity.all(20)
    assert knots.size == points.size + degree + 1 == int(entity.all(72)[0])
    assert points.size == int(entity.all(73)[0])
    ends = np.unique(knots)
    u = (ends[:-1, None] + np.diff(ends)[:, None] * (np.arange(count) / count)).ravel()
    k = np.searchsorted(knots, u, side="right") - 1
    d = [points[k - degree + j] for j in range(degree + 1)]
    for level in range(1, degree + 1):
        for j in range(degree, level - 1, -1):
            low, high = knots[k - degree + j], knots[k + 1 + j - level]
            share = (u - low) / (high - low)
            d[j] = (1.0 - share) * d[j - 1] + share * d[j]
    assert abs(points[0] - points[-1]) == 0.0, "closed"
    return d[degree]


def along_dxf(path: Path, layer: str, count: int) -> np.ndarray:
    entity = on_layer(path, layer)
    return along_spline(entity, count) if entity.kind == "SPLINE" else along_arcs(*arc_chain(entity), count)


def along_svg(path: Path, layer: str, count: int) -> np.ndarray:
    """Points of the one path of a layer, y upwards; commands M, L, C, A, Z."""
    group = next(g for g in ElementTree.parse(path).getroot().iter(f"{SVG}g") if g.get("id") == layer)
    (drawn,) = group.findall(f"{SVG}path")
    words = re.findall(r"[MLCAZ]|[-+.\deE]+", drawn.get("d", ""))
    part, here, start, found = np.arange(count) / count, 0j, 0j, []
    while words:
        command = words.pop(0)
        take = {"M": 2, "L": 2, "C": 6, "A": 7, "Z": 0}[command]
        v = [float(words.pop(0)) for _ in range(take)]
        end = complex(v[-2], v[-1]) if v else start
        if command == "M":
            start = end
        elif command == "C":
            a, b = complex(v[0], v[1]), complex(v[2], v[3])
            q = 1.0 - part
            found.append(q**3 * here + 3 * q**2 * part * a + 3 * q * part**2 * b + part**3 * end)
        elif command == "A":
            radius, sweep = v[0], v[4]
            assert v[0] == v[1]
            assert v[3] == 0.0, "the shorter way"
            half = np.arcsin(min(abs(end - here) / (2.0 * radius), 1.0)) * (1.0 if sweep else -1.0)
            share = np.sin(half * part) / np.sin(half)
            found.append(here + (end - here) * share * np.exp(1j * half * (part - 1.0)))
        elif end != here:
            found.append(here + (end - here) * part)
        here = end
    return np.concatenate(found).conj()


def along_csv(path: Path, count: int) -> np.ndarray:
    rows = np.genfromtxt(path, delimiter=",", names=True)
    p = rows["x_mm"] + 1j * rows["y_mm"]
    return along_arcs(p, np.zeros(p.size), count)


class Move(NamedTuple):
    """A move of the machine: rapid or not, to where [mm], at which feed [mm/min]; of an arc its centre [mm], and whether it turns left
    (G3)."""

    rapid: bool
    place: complex
    z: float
    feed: float
    centre: complex | None = None
    left: bool = False


def gcode(path: Path) -> tuple[list[Move], list[str], list[str]]:
    """The moves of a program in millimetres, absolute; its remarks before the first move; its other words in order. Any word that it
    does not know stops it."""
    text = path.read_bytes().decode("ascii")
    lines = text.splitlines()
    assert lines[0] == lines[-1] == "%"
    assert text.count("%") == 2, "it ends a program wherever it stands"
    moves, remarks, words = [], [], []
    way, feed, at = 0, 0.0, {"X": float("nan"), "Y": float("nan"), "Z": float("nan")}
    for line in lines[1:-1]:
        assert not re.search("[;!?~]", line), "what begins a comment, or is obeyed within one, on some machines"
        remarks += [] if moves else re.findall(r"\(([^()]*)\)", line)
        found = re.findall(r"([A-Z])(-?\d+\.?\d*)", re.sub(r"\([^()]*\)", "", line))
        assert "".join(letter + number for letter, number in found) == re.sub(r"\([^()]*\)|\s", "", line), line
        here, to_centre = complex(at["X"], at["Y"]), {}
        for letter, number in found:
            if letter + number in ("G0", "G1", "G2", "G3"):
                way = int(number)
            elif letter in at:
                at[letter] = float(number)
            elif letter in "IJ":
                to_centre[letter] = float(number)
            elif letter == "F":
                feed = float(number)
            else:
                words.append(letter + number)
        assert set(to_centre) == (set("IJ") if way in (2, 3) else set()), line
        if any(letter in at for letter, _ in found):
            centre = here + complex(to_centre["I"], to_centre["J"]) if to_centre else None
            moves.append(Move(way == 0, complex(at["X"], at["Y"]), at["Z"], feed, centre, way == 3))
    return moves, remarks, words


def along_moves(moves: list[Move], count: int, late: bool = False) -> np.ndarray:
    """Points of the moves from the first one's place to the last one's, so many on each. On an arc the angle about its centre runs from
    one end to the other its way; where the ends are not equally far from the centre, the machine spreads that over the arc, or (late)
    makes it up at the end."""
    part, found = np.arange(count) / count, []
    for before, move in pairwise(moves):
        start, end = before.place, move.place
        if move.centre is None:
            found.append(start + (end - start) * part)
            continue
        one, other = start - move.centre, end - move.centre
        sense = 1.0 if move.left else -1.0
        turn = (sense * np.angle(other / one)) % (2.0 * np.pi)
        size = abs(one) + (0.0 if late else abs(other) - abs(one)) * part
        found.append(move.centre + size * one / abs(one) * np.exp(1j * sense * turn * part))
    return np.append(np.concatenate(found), moves[-1].place)
