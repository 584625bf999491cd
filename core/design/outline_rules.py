"""Rules of outlines and clearances: bodies exist, outlines are closed and cross nothing, bodies of a clearance share a layer."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from core.design.camshaft import drive_names
from core.design.design import Design
from core.design.followers import Groove
from core.design.outline_bodies import (
    Body,
    body_named,
    body_of,
    body_words,
    drive_number,
    outlined_bodies,
    share_layer,
)
from core.design.outlines import CAM, CARRIED, FRAME, FREE, ROLLER, Outline
from core.errors import MISSING, Fault

ROUNDING = 1e-9  # relative: corners so near to each other, or to a side, touch


def outline_faults(design: Design) -> Iterator[Fault]:
    """Faults of the outlines and clearances of a design, in the order of the file."""
    for i, outline in enumerate(design.outlines):
        path = f"outlines[{i}]"
        drive_faults = list(_drive(design, outline, path))
        yield from drive_faults
        if not drive_faults:
            yield from _body(design, outline, path)
        yield from _shape(design, outline, path)
        if outline.layer[0] >= outline.layer[1]:
            value = [outline.layer_from_mm, outline.layer_to_mm]
            yield Fault(f"{path}.layer_to_mm", value, "the layer ends before it begins", "layer_from_mm < layer_to_mm")
    yield from _clearances(design)


def _drive(design: Design, outline: Outline, path: str) -> Iterator[Fault]:
    """An outline names its drive where the design lists its drives, but that of the transferred part."""
    path, names = f"{path}.drive", " | ".join(drive_names(design))
    if outline.drive is None:
        if design.listed and outline.of not in FREE:
            yield Fault(path, MISSING, f"missing: which drive has {outline.of!r}", names)
    elif not design.listed:
        yield Fault(path, outline.drive, "this design has one drive, without a name", "leave it out")
    elif outline.of == CARRIED:
        yield Fault(path, outline.drive, "all drives transfer the part together", "leave it out")
    elif drive_number(design, outline.drive) is None:
        yield Fault(path, outline.drive, "no drive of that name", names)


def _body(design: Design, outline: Outline, path: str) -> Iterator[Fault]:
    """The body exists; a transferred part has a plane, and something that transfers it."""
    number = drive_number(design, outline.drive) if outline.drive else None if design.listed else 0
    if body_of(design, outline) is None:
        words = list(FREE) if number is None else [*body_words(design.drives[number]), FRAME]
        yield Fault(f"{path}.of", outline.of, "unknown body", " | ".join(words))
    elif outline.of == CARRIED:
        if not any(drive.carries for drive in design.drives):
            yield Fault(f"{path}.of", outline.of, "no drive transfers a part", "carries = [x, y, z] of a drive")
        if outline.plane is None:
            yield Fault(f"{path}.plane", MISSING, "missing: the transferred part moves in space", "xy | xz | yz")
    elif outline.plane is not None and outline.of != FRAME:
        problem = "only the transferred part has one, and the frame next to it"
        yield Fault(f"{path}.plane", outline.plane, problem, "leave it out")


def _shape(design: Design, outline: Outline, path: str) -> Iterator[Fault]:
    """An outline is closed, by corners, a drawing, or what its body gives."""
    if outline.file is not None:
        if not outline.file.strip():
            yield Fault(f"{path}.file", outline.file, "empty", "the path of a drawing (.dxf)")
        if outline.points:
            yield Fault(f"{path}.points", MISSING, f"cannot be combined with {path}.file", "one of them")
    elif not outline.points:
        yield from _without_points(design, outline, path)
    elif len(outline.points) < 3 and not outline.round_mm:
        value = f"{len(outline.points)} points"
        yield Fault(f"{path}.points", value, "the outline is open", "three points at least, or round_mm > 0")
    else:
        yield from _is_simple(outline, path)


def _without_points(design: Design, outline: Outline, path: str) -> Iterator[Fault]:
    body = body_of(design, outline)
    if body is None or body.name == ROLLER:
        return
    number = body.drive
    if number is not None and body.name == CAM:
        if isinstance(design.drives[number].cam.form, Groove):
            problem = "missing: a cam with a groove has no outer profile of its own"
            yield Fault(f"{path}.points", MISSING, problem, "points, or file")
        return
    if number is None or not outline.round_mm:
        allowed = "points, or file" if number is None else "points, file, or round_mm around the points of the link"
        yield Fault(f"{path}.points", MISSING, "missing", allowed)


def _is_simple(outline: Outline, path: str) -> Iterator[Fault]:
    """No two corners coincide, and no two sides cross."""
    z = np.array([complex(point.x_mm, point.y_mm) for point in outline.points])
    count, near = z.size, ROUNDING * float(np.abs(z).max(initial=1e-9))
    if not np.isfinite(z).all():
        return
    first, second = np.triu_indices(count, 1)
    if (same := np.flatnonzero(np.abs(z[second] - z[first]) <= near)).size:
        i, j = int(first[same[0]]), int(second[same[0]])
        value = [outline.points[j].x_mm, outline.points[j].y_mm]
        yield Fault(
            f"{path}.points[{j}]", value, f"is the same as points[{i}]", "a point once; the outline closes itself"
        )
    elif count > 2 and (crossing := _crossing(z)) is not None:
        i, j = crossing
        problem = f"crosses itself: the side from corner {i + 1} meets the side from corner {j + 1}"
        yield Fault(f"{path}.points", f"{count} points", problem, "corners in their order around the body")


def _crossing(z: np.ndarray) -> tuple[int, int] | None:
    """First two sides that meet, except neighbours at their corner; None where no sides meet."""
    ends, count = np.roll(z, -1), z.size
    i, j = np.triu_indices(count, 1)
    neighbours = (j - i == 1) | (j - i == count - 1)
    a, b, c, d = z[i], ends[i], z[j], ends[j]

    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
        """Twice the area of the triangle, 0 where r is on the line from p to q to rounding."""
        area = ((q - p).conj() * (r - p)).imag
        return np.where(np.abs(area) <= ROUNDING * np.abs(q - p) * np.maximum(np.abs(r - p), np.abs(q - p)), 0.0, area)

    def between(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
        along = ((q - p).conj() * (r - p)).real
        return (along >= 0.0) & (along <= np.abs(q - p) ** 2)

    sides = side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)
    meets = (sides[0] * sides[1] < 0.0) & (sides[2] * sides[3] < 0.0)
    for on, p, q, r in zip(sides, (a, a, c, c), (b, b, d, d), (c, d, a, b), strict=True):
        meets |= (on == 0.0) & between(p, q, r)
    # neighbours meet at their corner; they overlap where the other end of one is on the other
    folds = np.where(j - i == 1, (sides[1] == 0.0) & between(a, b, d), (sides[0] == 0.0) & between(a, b, c))
    folds |= np.where(j - i == 1, (sides[2] == 0.0) & between(c, d, a), (sides[3] == 0.0) & between(c, d, b))
    found = np.flatnonzero(np.where(neighbours, folds, meets))
    return (int(i[found[0]]), int(j[found[0]])) if found.size else None


def _clearances(design: Design) -> Iterator[Fault]:
    """A clearance names two bodies with outlines that have a common layer."""
    names = outlined_bodies(design)
    by_body: dict[Body, list[Outline]] = {body: [] for body in names}
    for outline in design.outlines:
        if (body := body_of(design, outline)) is not None:
            by_body[body].append(outline)
    allowed = " | ".join(names.values()) or "none: the design has no outline"
    seen: set[frozenset[Body]] = set()
    for i, row in enumerate(design.clearances):
        path, bodies = f"clearances[{i}].between", [body_named(design, text) for text in row.between]
        if len(row.between) != 2 or len(set(bodies)) < len(bodies):
            yield Fault(path, list(row.between), "must be the names of two bodies", allowed)
            continue
        wrong = [text for text, body in zip(row.between, bodies, strict=True) if body not in names]
        if wrong:
            yield Fault(path, wrong[0], "unknown body, or without an outline", allowed)
            continue
        first, second = (by_body[body] for body in bodies if body is not None)
        pair = frozenset(body for body in bodies if body is not None)
        if not any(share_layer(a, b) for a, b in product(first, second)):
            yield Fault(path, list(row.between), "these bodies have no common layer", "bodies that could meet")
        elif pair in seen:
            yield Fault(path, list(row.between), "given twice", "a pair of bodies once")
        seen.add(pair)
