"""Bodies as STEP files: ISO 10303-21, schema AUTOMOTIVE_DESIGN (AP214), in mm, without a date.

Sources: ISO 10303-21 (the encoding of the file), 10303-42 (geometry and topology), 10303-214 (the schema).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from core.output.solids.body import (
    Body,
    CircleCurve,
    CylinderSurface,
    Edge,
    KnotVector,
    LineCurve,
    PlaneSurface,
    SplineCurve,
    SplineSurface,
    TorusSurface,
)

SCHEMA = "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }"
NO_DATE = "2000-01-01T00:00:00"
"""The same design gives the same bytes."""
ACCURACY = 1e-6
"""Stated accuracy of the file [mm]: points closer than this are the same point."""
_LINE = 100  # characters after which a list continues on the next line


def step_bytes(name: str, about: Sequence[str], bodies: Sequence[Body], points: Mapping[str, np.ndarray]) -> bytes:
    """A STEP file of solids, of open sheets, and of points.

    Parameters
    ----------
    name : str
        Name of the part.
    about : sequence of str
        Description in the header of the file.
    bodies : sequence of Body
    points : mapping of str -> ndarray (3,) [mm]
        Points that are marked, by their names.

    Returns
    -------
    bytes
    """
    data = _Entities()
    shape, context = _product(data, name)
    axes = data.placement((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    solids = [_solid(data, body) for body in bodies if body.is_closed]
    sheets = [_sheet(data, body) for body in bodies if not body.is_closed]
    marks = [data.add(f"CARTESIAN_POINT({text(label)},{numbers(at)})") for label, at in points.items()]
    if marks:
        marks = [data.add(f"GEOMETRIC_SET('pins',{references(marks)})")]
    for kind, items in (
        ("ADVANCED_BREP_SHAPE_REPRESENTATION", solids),
        ("MANIFOLD_SURFACE_SHAPE_REPRESENTATION", sheets),
        ("GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION", marks),
    ):
        if items:
            representation = data.add(f"{kind}('',{references([axes, *items])},#{context})")
            data.add(f"SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})")
    header = [
        "ISO-10303-21;",
        "HEADER;",
        f"FILE_DESCRIPTION(({','.join(map(text, about))}),'2;1');",
        f"FILE_NAME({text(name)},'{NO_DATE}',(''),(''),'KINDYNA','KINDYNA','');",
        f"FILE_SCHEMA(('{SCHEMA}'));",
        "ENDSEC;",
        "DATA;",
    ]
    lines = [f"#{number}={entity};" for number, entity in enumerate(data.entities, 1)]
    return "\n".join([*header, *lines, "ENDSEC;", "END-ISO-10303-21;", ""]).encode("ascii")


# -- values -----------------------------------------------------------------------------------------------------


def real(value: float) -> str:
    """A number as ISO 10303-21 requires it, with a decimal point: the shortest text that reads back to the same bits."""
    mantissa, e, exponent = repr(float(value) + 0.0).partition("e")
    return f"{mantissa if '.' in mantissa else mantissa + '.'}{e.upper()}{exponent}"


def numbers(values: Iterable[float]) -> str:
    """A list of numbers."""
    return f"({','.join(map(real, values))})"


def references(entities: Iterable[int]) -> str:
    """A list of entities."""
    return f"({','.join(f'#{entity}' for entity in entities)})"


def text(value: str) -> str:
    r"""A text: apostrophes and backslashes doubled, other than ASCII as \X2\...\X0\ or \X4\...\X0\."""
    return "'" + "".join(map(_character, value)) + "'"


def _character(c: str) -> str:
    if c in "'\\":
        return 2 * c
    if " " <= c <= "~":
        return c
    return f"\\X2\\{ord(c):04X}\\X0\\" if ord(c) < 0x10000 else f"\\X4\\{ord(c):08X}\\X0\\"


class _Entities:
    """Entities of a file, numbered from 1; points and directions of equal coordinates are one entity."""

    def __init__(self) -> None:
        self.entities: list[str] = []
        self._numbers: dict[str, int] = {}

    def add(self, entity: str) -> int:
        """Add an entity and return its number."""
        self.entities.append(entity)
        return len(self.entities)

    def shared(self, entity: str) -> int:
        """Number of an entity that is added once."""
        if entity not in self._numbers:
            self._numbers[entity] = self.add(entity)
        return self._numbers[entity]

    def point(self, at: Iterable[float]) -> int:
        return self.shared(f"CARTESIAN_POINT('',{numbers(at)})")

    def direction(self, along: Iterable[float]) -> int:
        return self.shared(f"DIRECTION('',{numbers(along)})")

    def placement(self, at: Iterable[float], axis: Any) -> int:
        """A frame with this z axis; its x axis is at right angles."""
        across = (1.0, 0.0, 0.0) if abs(axis[2]) > 0.5 else (0.0, 0.0, 1.0)
        return self.add(f"AXIS2_PLACEMENT_3D('',#{self.point(at)},#{self.direction(axis)},#{self.direction(across)})")


# -- product ----------------------------------------------------------------------------------------------------


def _product(data: _Entities, name: str) -> tuple[int, int]:
    """The part: number of its shape, and of the context of its representations, which states the units."""
    application = data.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')")
    data.add(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{application})")
    product_context = data.add(f"PRODUCT_CONTEXT('',#{application},'mechanical')")
    product = data.add(f"PRODUCT({text(name)},{text(name)},'',(#{product_context}))")
    data.add(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))")
    formation = data.add(f"PRODUCT_DEFINITION_FORMATION('','',#{product})")
    definition_context = data.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')")
    definition = data.add(f"PRODUCT_DEFINITION('design','',#{formation},#{definition_context})")
    shape = data.add(f"PRODUCT_DEFINITION_SHAPE('','',#{definition})")
    length = data.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
    angle = data.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    solid_angle = data.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    accuracy = data.add(
        f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({real(ACCURACY)}),#{length},'distance_accuracy_value','')"
    )
    context = data.add(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{accuracy}))"
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid_angle}))REPRESENTATION_CONTEXT('','3D'))"
    )
    return shape, context


# -- bodies -----------------------------------------------------------------------------------------------------


def _solid(data: _Entities, body: Body) -> int:
    shell = data.add(f"CLOSED_SHELL('',{references(_faces(data, body))})")
    return data.add(f"MANIFOLD_SOLID_BREP({text(body.name)},#{shell})")


def _sheet(data: _Entities, body: Body) -> int:
    shell = data.add(f"OPEN_SHELL('',{references(_faces(data, body))})")
    return data.add(f"SHELL_BASED_SURFACE_MODEL({text(body.name)},(#{shell}))")


def _faces(data: _Entities, body: Body) -> list[int]:
    points = [data.point(at) for at in body.vertices]
    vertices = [data.add(f"VERTEX_POINT('',#{point})") for point in points]
    edges = [
        data.add(
            f"EDGE_CURVE('',#{vertices[edge.start]},#{vertices[edge.end]},"
            f"#{_CURVES[type(edge.curve)](data, edge, body.vertices)},.T.)"
        )
        for edge in body.edges
    ]
    faces = []
    for face in body.faces:
        bounds = []
        for number, loop in enumerate(face.loops):
            steps = [
                data.add(f"ORIENTED_EDGE('',*,*,#{edges[edge]},{_logical(is_forward)})") for edge, is_forward in loop
            ]
            edge_loop = data.add(f"EDGE_LOOP('',{references(steps)})")
            bounds.append(data.add(f"{'FACE_BOUND' if number else 'FACE_OUTER_BOUND'}('',#{edge_loop},.T.)"))
        surface = _SURFACES[type(face.surface)](data, face.surface)
        faces.append(data.add(f"ADVANCED_FACE('',{references(bounds)},#{surface},{_logical(face.is_along)})"))
    return faces


def _logical(value: bool) -> str:
    return ".T." if value else ".F."


# -- curves and surfaces ----------------------------------------------------------------------------------------


def _line(data: _Entities, edge: Edge, vertices: np.ndarray) -> int:
    start, end = vertices[edge.start], vertices[edge.end]
    length = float(np.linalg.norm(end - start))
    vector = data.add(f"VECTOR('',#{data.direction((end - start) / length)},{real(length)})")
    return data.add(f"LINE('',#{data.point(start)},#{vector})")


def _circle(data: _Entities, edge: Edge, vertices: np.ndarray) -> int:
    curve: Any = edge.curve
    return data.add(f"CIRCLE('',#{data.placement(curve.centre, curve.axis)},{real(curve.radius)})")


def _knots(*bases: KnotVector) -> str:
    """Multiplicities of all directions, then their knots."""
    multiplicities = ",".join(f"({','.join(map(str, basis.multiplicities))})" for basis in bases)
    return f"{multiplicities},{','.join(numbers(basis.knots) for basis in bases)},.UNSPECIFIED."


def _spline_curve(data: _Entities, edge: Edge, vertices: np.ndarray) -> int:
    curve: Any = edge.curve
    points = references(data.point(at) for at in curve.points)
    return data.add(
        f"B_SPLINE_CURVE_WITH_KNOTS('',{curve.basis.degree},{points},.UNSPECIFIED.,.F.,.F.,{_knots(curve.basis)})"
    )


def _plane(data: _Entities, surface: PlaneSurface) -> int:
    return data.add(f"PLANE('',#{data.placement(surface.origin, surface.normal)})")


def _cylinder(data: _Entities, surface: CylinderSurface) -> int:
    placement = data.placement(surface.origin, surface.axis)
    return data.add(f"CYLINDRICAL_SURFACE('',#{placement},{real(surface.radius)})")


def _torus(data: _Entities, surface: TorusSurface) -> int:
    placement = data.placement(surface.centre, surface.axis)
    return data.add(f"TOROIDAL_SURFACE('',#{placement},{real(surface.major_radius)},{real(surface.minor_radius)})")


def _spline_surface(data: _Entities, surface: SplineSurface) -> int:
    rows = ",".join(references(data.point(at) for at in row) for row in surface.points)
    return data.add(
        f"B_SPLINE_SURFACE_WITH_KNOTS('',{surface.along.degree},{surface.across.degree},({rows}),.UNSPECIFIED.,"
        f".F.,.F.,.F.,{_knots(surface.along, surface.across)})"
    )


_CURVES: Mapping[type, Callable[[_Entities, Edge, np.ndarray], int]] = MappingProxyType(
    {LineCurve: _line, CircleCurve: _circle, SplineCurve: _spline_curve}
)
_SURFACES: Mapping[type, Callable[[_Entities, Any], int]] = MappingProxyType(
    {PlaneSurface: _plane, CylinderSurface: _cylinder, TorusSurface: _torus, SplineSurface: _spline_surface}
)
