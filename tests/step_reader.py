"""A small reader of STEP files (ISO 10303-21): edges, faces and solids with points on their curves and surfaces."""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.interpolate import BSpline

_TOKEN = re.compile(
    r"\s*(?:'((?:[^']|'')*)'|#(\d+)|\.([A-Z_]+)\.|([-+]?\d+\.?\d*(?:E[-+]?\d+)?)|([A-Z_0-9]+)|([(),$*]))"
)


@dataclass(frozen=True)
class Ref:
    number: int


def _parsed(text: str) -> list[Any]:
    """Values, references, and lists of an entity's parameters; a keyword is a text in front of its list."""
    stack: list[list[Any]] = [[]]
    at = 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        assert match, text[at : at + 40]
        at = match.end()
        string, reference, enumeration, number, keyword, mark = match.groups()
        if string is not None:
            stack[-1].append(string.replace("''", "'"))
        elif reference:
            stack[-1].append(Ref(int(reference)))
        elif enumeration:
            stack[-1].append(f".{enumeration}.")
        elif number:
            stack[-1].append(float(number) if "." in number else int(number))
        elif keyword:
            stack[-1].append(keyword)
        elif mark == "(":
            stack.append([])
        elif mark == ")":
            done = stack.pop()
            stack[-1].append(done)
        elif mark in "$*":
            stack[-1].append(None)
    return stack[0]


@dataclass(frozen=True)
class Curve:
    kind: str
    data: Any

    def at(self, t: np.ndarray) -> np.ndarray:
        """Points (n, 3): of a line and a spline by part of its length 0 ... 1, of a circle by its angle."""
        if self.kind == "LINE":
            origin, vector = self.data
            return origin + t[:, None] * vector
        if self.kind == "CIRCLE":
            (origin, axis, x), radius = self.data
            y = np.cross(axis, x)
            return origin + radius * (np.cos(t)[:, None] * x + np.sin(t)[:, None] * y)
        knots, degree, points = self.data
        return BSpline(knots, points, degree)(knots[0] + t * (knots[-1] - knots[0]))

    def parameters(self, start: np.ndarray, end: np.ndarray, count: int) -> np.ndarray:
        """Parameters from vertex to vertex, along the curve; every knot of a spline is among them."""
        if self.kind == "CIRCLE":
            (origin, axis, x), _ = self.data
            y = np.cross(axis, x)
            low, high = (np.arctan2((p - origin) @ y, (p - origin) @ x) for p in (start, end))
            return np.linspace(low, low + (high - low) % (2.0 * np.pi), count)
        return np.linspace(0.0, 1.0, count)


@dataclass(frozen=True)
class Surface:
    kind: str
    data: Any

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Distance (n,) of points (n, 3) from a plane, cylinder or torus."""
        (origin, axis, _), *size = self.data
        along = (points - origin) @ axis
        if self.kind == "PLANE":
            return np.abs(along)
        across = np.linalg.norm(points - origin - along[:, None] * axis, axis=1) - size[0]
        return np.abs(across) if self.kind == "CYLINDRICAL_SURFACE" else np.abs(np.hypot(across, along) - size[1])

    def at(self, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (n, 3) and unit normals of a B-spline surface, u and v from 0 to 1."""
        (knots_u, knots_v), (degree_u, degree_v), points = self.data
        u, v = (k[0] + x * (k[-1] - k[0]) for k, x in ((knots_u, u), (knots_v, v)))

        def value(du: int, dv: int) -> np.ndarray:
            across = BSpline(knots_v, points.transpose(1, 0, 2), degree_v)
            rows = (across.derivative(dv) if dv else across)(v)  # (n, m, 3)
            basis = BSpline(knots_u, np.eye(points.shape[0]), degree_u)
            weights = (basis.derivative(du) if du else basis)(u)
            return np.einsum("nm,nmk->nk", weights, rows)

        normal = np.cross(value(1, 0), value(0, 1))
        return value(0, 0), normal / np.linalg.norm(normal, axis=1, keepdims=True)


@dataclass(frozen=True)
class Edge:
    number: int
    start: np.ndarray
    end: np.ndarray
    curve: Curve

    def points(self, count: int) -> np.ndarray:
        return self.curve.at(self.curve.parameters(self.start, self.end, count))


@dataclass(frozen=True)
class Face:
    surface: Surface
    loops: tuple[tuple[tuple[Edge, bool], ...], ...]
    is_along: bool

    def polygon(self, loop: int, count: int) -> np.ndarray:
        """Points (n, 3) of a loop in its order."""
        parts = [e.points(count)[:: 1 if forward else -1][:-1] for e, forward in self.loops[loop]]
        return np.concatenate(parts)


class StepFile:
    """The entities of a file."""

    def __init__(self, content: bytes) -> None:
        text = content.decode("ascii")
        assert text.startswith("ISO-10303-21;\nHEADER;")
        assert text.endswith("END-ISO-10303-21;\n")
        self.header, data = text.split("DATA;")
        self.entities: dict[int, tuple[str, list[Any]]] = {}
        for number, body in re.findall(r"#(\d+)\s*=\s*((?:[^;']|'(?:[^']|'')*')*);", data):
            parsed = _parsed(body)
            name, arguments = (parsed[0], parsed[1]) if isinstance(parsed[0], str) else ("", parsed[0])
            self.entities[int(number)] = (name, arguments)
        for _, arguments in self.entities.values():
            for reference in _references(arguments):
                assert reference.number in self.entities, f"#{reference.number} is not in the file"

    def all(self, name: str) -> Iterator[list[Any]]:
        return (arguments for kind, arguments in self.entities.values() if kind == name)

    def get(self, reference: Ref) -> tuple[str, list[Any]]:
        return self.entities[reference.number]

    def point(self, reference: Ref) -> np.ndarray:
        kind, arguments = self.get(reference)
        assert kind in ("CARTESIAN_POINT", "DIRECTION", "VERTEX_POINT")
        return self.point(arguments[1]) if kind == "VERTEX_POINT" else np.array(arguments[1], dtype=float)

    def _placement(self, reference: Ref) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        _, (_, origin, axis, x) = self.get(reference)
        return self.point(origin), self.point(axis), self.point(x)

    def _curve(self, reference: Ref) -> Curve:
        kind, arguments = self.get(reference)
        if kind == "LINE":
            _, (_, direction, length) = self.get(arguments[2])
            return Curve(kind, (self.point(arguments[1]), length * self.point(direction)))
        if kind == "CIRCLE":
            return Curve(kind, (self._placement(arguments[1]), arguments[2]))
        assert kind == "B_SPLINE_CURVE_WITH_KNOTS"
        _, degree, points, _, _, _, multiplicities, knots, _ = arguments
        control = np.array([self.point(p) for p in points])
        repeated = np.repeat(np.array(knots), multiplicities)
        assert repeated.size == len(control) + degree + 1
        return Curve(kind, (repeated, degree, control))

    def surface(self, reference: Ref) -> Surface:
        kind, arguments = self.get(reference)
        if kind in ("PLANE", "CYLINDRICAL_SURFACE", "TOROIDAL_SURFACE"):
            return Surface(kind, (self._placement(arguments[1]), *arguments[2:]))
        assert kind == "B_SPLINE_SURFACE_WITH_KNOTS"
        _, degree_u, degree_v, rows, _, _, _, _, times_u, times_v, knots_u, knots_v, _ = arguments
        points = np.array([[self.point(p) for p in row] for row in rows])
        knots = np.repeat(np.array(knots_u), times_u), np.repeat(np.array(knots_v), times_v)
        assert knots[0].size == points.shape[0] + degree_u + 1
        assert knots[1].size == points.shape[1] + degree_v + 1
        return Surface(kind, (knots, (degree_u, degree_v), points))

    def _edge(self, reference: Ref) -> Edge:
        _, (_, start, end, curve, same) = self.get(reference)
        assert same == ".T."
        return Edge(reference.number, self.point(start), self.point(end), self._curve(curve))

    def _face(self, reference: Ref) -> Face:
        kind, (_, bounds, surface, along) = self.get(reference)
        assert kind == "ADVANCED_FACE"
        loops = []
        for number, bound in enumerate(bounds):
            kind, (_, loop, orientation) = self.get(bound)
            assert (kind, orientation) == ("FACE_BOUND" if number else "FACE_OUTER_BOUND", ".T.")
            _, (_, steps) = self.get(loop)
            arguments = [self.get(step)[1] for step in steps]
            loops.append(tuple((self._edge(edge), forward == ".T.") for _, _, _, edge, forward in arguments))
        return Face(self.surface(surface), tuple(loops), along == ".T.")

    @cached_property
    def shells(self) -> dict[str, list[Face]]:
        """Name of each solid or sheet -> its faces."""
        result = {}
        for name in ("MANIFOLD_SOLID_BREP", "SHELL_BASED_SURFACE_MODEL"):
            for label, shell in self.all(name):
                shell = shell if isinstance(shell, Ref) else shell[0]
                kind, (_, faces) = self.get(shell)
                assert kind == ("CLOSED_SHELL" if name == "MANIFOLD_SOLID_BREP" else "OPEN_SHELL")
                result[label] = [self._face(face) for face in faces]
        return result


def _references(values: list[Any]) -> Iterator[Ref]:
    for value in values:
        if isinstance(value, Ref):
            yield value
        elif isinstance(value, list):
            yield from _references(value)


def check_topology(faces: list[Face], is_closed: bool, accuracy: float = 1e-9) -> None:
    """Loops are closed, vertices and edges are on their curves and surfaces, edges are used twice in opposite directions."""
    uses: Counter[tuple[int, bool]] = Counter()
    for face in faces:
        for loop in face.loops:
            uses.update((edge.number, forward) for edge, forward in loop)
            ends = [(e.start, e.end) if forward else (e.end, e.start) for e, forward in loop]
            for (_, end), (start, _) in zip(ends, ends[1:] + ends[:1], strict=True):
                assert np.abs(end - start).max() <= accuracy
            for edge, _ in loop:
                points = edge.points(50)
                assert np.abs(points[[0, -1]] - (edge.start, edge.end)).max() <= accuracy
                assert np.abs(edge.start - edge.end).max() > accuracy, "no edge ends where it begins"
                if face.surface.kind != "B_SPLINE_SURFACE_WITH_KNOTS":
                    assert face.surface.distance(points).max() <= accuracy
                else:
                    _check_side(face.surface, edge, points, accuracy)
    assert set(uses.values()) == {1}
    numbers = {number for number, _ in uses}
    pairs = [uses[number, True] + uses[number, False] for number in numbers]
    assert set(pairs) <= ({2} if is_closed else {1, 2})


def _check_side(surface: Surface, edge: Edge, points: np.ndarray, accuracy: float) -> None:
    """The edge is one of the four sides of its surface."""
    t = np.linspace(0.0, 1.0, 50)
    zero, one = np.zeros(50), np.ones(50)
    sides = [surface.at(*uv)[0] for uv in ((t, zero), (t, one), (zero, t), (one, t))]
    best = min(min(np.abs(side - points).max(), np.abs(side[::-1] - points).max()) for side in sides)
    assert best <= accuracy


def volume(faces: list[Face], count: int) -> float:
    """Volume [mm³] by the divergence theorem, ∫z n_z dA over the level planes; the walls have to be upright."""
    total = 0.0
    for face in faces:
        if face.surface.kind != "PLANE" or abs(face.surface.data[0][1][2]) < 0.5:
            continue
        for number in range(len(face.loops)):
            x, y, z = face.polygon(number, count).T
            area = 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
            total += float(z[0]) * area  # counter-clockwise seen from outside: negative from below
    return total
