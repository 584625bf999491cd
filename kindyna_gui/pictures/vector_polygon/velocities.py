"""The velocity polygon as a diagram: every point's velocity from the pole o_v, between their ends the differences V_PA."""

from __future__ import annotations

import numpy as np

from core.instant_centres import ABSOLUTE, POLE, TURNING, Corner, PolygonSide, VelocityPolygon
from core.mechanism import link_number
from kindyna_gui.pictures.vector_polygon.sheet import Kind, PolygonCorner, PolygonDiagram, PolygonVector, box_of

VELOCITIES = Kind("velocity", "mm/s", 1e3, "Nothing moves at this angle.")


def vector_name(side: PolygonSide) -> tuple[str, str]:
    """``V`` and its index: of a point, ``BA`` of B against A; of a block on a link, ``A3A4``."""
    p, a = _point(side.end), _point(side.start)
    if side.kind == ABSOLUTE:
        return "V", p
    if side.kind == TURNING:
        return "V", f"{p}{a}"
    return "V", f"{side.end[0]}{link_number(side.body)}{_point(side.start)}"


def corner_name(corner: Corner) -> tuple[str, str]:
    """``a`` and its index, the link where the point only coincides with it; ``o`` and ``v`` of the pole."""
    if corner == POLE:
        return "o", "v"
    return corner[0].lower(), str(link_number(corner[1])) if corner[1] else ""


def _point(corner: Corner) -> str:
    return f"{corner[0]}{link_number(corner[1])}" if corner[1] else corner[0]


def velocity_box(polygon: VelocityPolygon, omega: float) -> tuple[complex, complex]:
    """What a sheet must hold of all velocities over the turn [m/s]."""
    return box_of(
        np.array([*np.broadcast_arrays(np.zeros_like(polygon.longest, dtype=complex), *polygon.corners.values())])
        * omega
    )


def step_text(polygon: VelocityPolygon, count: int) -> str:
    """What the last of so many steps draws: a velocity from the pole, a difference, or the sum of both."""
    if not count:
        return "From the pole: all velocities start there"
    done = polygon.steps[:count]
    side, name = done[-1], "_".join(vector_name(done[-1]))
    if side.kind != ABSOLUTE:
        if side.kind != TURNING:
            return f"{name} along the guide"
        return f"{name} across the line from {_point(side.start)} to {_point(side.end)}"
    by = next((each for each in done if each.kind != ABSOLUTE and each.end == side.end), None)
    if by is None:
        return f"{name} from the pole"
    first = next(("_".join(vector_name(each)) for each in done if each.kind == ABSOLUTE and each.end == by.start), "")
    return f"{name} = {first} + {'_'.join(vector_name(by))}"


def velocity_diagram(polygon: VelocityPolygon, omega: float, steps: int | None = None) -> PolygonDiagram:
    """Of one position; steps: only so many vectors in the order of their construction, None: all."""
    sides = polygon.sides if steps is None else polygon.steps[:steps]
    place = {POLE: 0j, **{key: complex(v[0]) * omega for key, v in polygon.corners.items()}}
    reached = {POLE, *(end for side in sides for end in (side.start, side.end))}
    known = {key: v for key, v in place.items() if np.isfinite(v) and key in reached}
    strokes = [
        PolygonVector(
            *vector_name(s),
            place[s.start],
            complex(s.vector[0]) * omega,
            plain=s.kind != ABSOLUTE,
            dashed=s.kind not in (ABSOLUTE, TURNING),
        )
        for s in sides
        if {s.start, s.end} <= set(known)
    ]
    whole = [(body, corners) for body, corners in polygon.images.items() if set(corners) <= set(known)]
    images = [(link_number(body), tuple(place[c] for c in corners)) for body, corners in whole]
    return PolygonDiagram(
        VELOCITIES,
        tuple(strokes),
        tuple(PolygonCorner(*corner_name(key), v) for key, v in known.items()),
        tuple(images),
    )
