"""What a linkage looks like at one angle, and what its points run through, as DXF and SVG: a layer a link, or a point; in millimetres."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from xml.sax.saxutils import escape

import numpy as np

from core.design import FRAME_LINK, Design, require_linkage
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism import body_name
from core.numerics.projection import ISOMETRIC, seen_from
from core.output.lines import text_cell
from core.output.profile.dxf import METRIC, MILLIMETRES, VERSION, without_clock
from core.study import Study

_MM = 1e3
_PIN = 0.012  # radius of a pin, parts of the size
_BLOCK = 0.035  # half the length of a block
_MARGIN = 0.05
COLOURS = (7, 5, 3, 1, 6, 4, 2, 30)  # of DXF, a link or a point after the other
STROKES = ("#000000", "#0072b2", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#e69f00", "#7f7f7f")


@frozen(eq=False)
class LayerShapes:
    """Lines through points (n,) complex [mm], closed or not, and circles (centre, radius)."""

    lines: tuple[tuple[np.ndarray, bool], ...] = ()
    circles: tuple[tuple[complex, float], ...] = ()


Layers = Mapping[str, LayerShapes]


@frozen(eq=False)
class PointCurves:
    """Name of a point -> where it is (n,) complex [mm] at the angles [deg] (n,) of a turn; closed: they come back; marks: places at
    equal times."""

    angle_column: str
    angles: np.ndarray
    curves: Mapping[str, np.ndarray]
    closed: bool
    marks: Mapping[str, np.ndarray]


def point_names(design: Design) -> tuple[str, ...]:
    """The points of a linkage that move, in the order of its links."""
    linkage = require_linkage(design).drive.linkage
    fixed = linkage.by_number[FRAME_LINK].places
    names = (name for n in sorted(linkage.by_number) for name in linkage.by_number[n].places)
    return tuple(dict.fromkeys(name for name in names if name not in fixed))


def point_curves(study: Study, names: Sequence[str] = (), time_marks: int = 0) -> PointCurves:
    """The curves of points, of all that move where none is named. Raises KindynaError for a name that none has, NoAnswer."""
    there = point_names(study.design)
    if unknown := [name for name in names if name not in there]:
        raise KindynaError(f"points: no moving point is called {', '.join(unknown)}; allowed: {' | '.join(there)}")
    wanted = tuple(names) or there
    marked = {}
    if time_marks:
        marked = _places(study.at_theta(np.linspace(0.0, 2.0 * np.pi, time_marks, endpoint=False)), wanted)
    whole = study.angle_degrees.size == study.samples and not study.swings
    return PointCurves(study.angle_column, study.angle_degrees, _places(study, wanted), whole, marked)


def _places(study: Study, names: Sequence[str]) -> dict[str, np.ndarray]:
    kinematics = study.linkage
    return {name: kinematics.bodies[kinematics.body_of(name)].place(name) * _MM for name in names}


def curves_table(curves: PointCurves) -> str:
    """As CSV: the angle, then x and y of each point."""
    names = [text_cell(f"{name}_{axis}_mm") for name in curves.curves for axis in "xy"]
    columns = [curves.angles, *(part for z in curves.curves.values() for part in (z.real, z.imag))]
    rows = np.column_stack(columns).tolist()
    head = ",".join([curves.angle_column, *names])
    return "\n".join([head, *(",".join(map(repr, row)) for row in rows)]) + "\n"


def part_table(study: Study) -> str:
    """The path in space of the part that the drives carry, as CSV."""
    shaft = study.camshaft
    rows = np.column_stack((shaft.angle_degrees, study.camshaft.carried_path * _MM)).tolist()
    return "\n".join(["machine_angle_deg,x_mm,y_mm,z_mm", *(",".join(map(repr, row)) for row in rows)]) + "\n"


def part_layers(study: Study) -> dict[str, LayerShapes]:
    """The same as it looks from above and aside, with the three axes as long as the path is large."""
    path = study.camshaft.carried_path * _MM
    size = float(np.ptp(path, axis=0).max()) or 1.0
    axes = {
        name: LayerShapes(((seen_from(np.array([np.zeros(3), size * each]), *ISOMETRIC), False),))
        for name, each in zip(("X", "Y", "Z"), np.eye(3), strict=True)
    }
    return {"PATH": LayerShapes(((seen_from(path, *ISOMETRIC), True),)), **axes}


def curve_layers(curves: PointCurves) -> dict[str, LayerShapes]:
    """A layer a point: its curve, and its marks."""
    size = max((float(np.ptp(z.real) + np.ptp(z.imag)) for z in curves.curves.values()), default=1.0) or 1.0
    return {
        name: LayerShapes(
            ((z, curves.closed),), tuple((complex(m), 0.2 * _PIN * size) for m in curves.marks.get(name, ()))
        )
        for name, z in curves.curves.items()
    }


def pose_layers(study: Study) -> dict[str, LayerShapes]:
    """A layer a link at the first angle of the study: its points joined as they follow each other, its pins, its block on a guide."""
    linkage, kinematics = require_linkage(study.design).drive.linkage, study.linkage
    size = study.driver_ranges.plan.size * _MM
    sliding = {slider.link: slider for slider in linkage.sliders}
    guides: dict[int, list[tuple[np.ndarray, bool]]] = {}
    layers: dict[str, LayerShapes] = {}
    blocks = {}
    for number, slider in sliding.items():
        body = kinematics.bodies[body_name(number)]
        at, axis = complex(body.z[0, 0]) * _MM, complex(body.unit[0])
        half = _BLOCK * size
        corners = np.array([-half - 0.6j * half, half - 0.6j * half, half + 0.6j * half, -half + 0.6j * half])
        blocks[number] = (at + corners * axis, True)
        guides.setdefault(slider.on, []).append((at + np.array([-4.0, 4.0]) * half * axis, False))
    for number in sorted(linkage.by_number):
        body = kinematics.bodies[body_name(number)]
        z = np.array([complex(body.place(name)[0]) * _MM for name in linkage.by_number[number].places])
        lines = [(z, z.size > 2)] if z.size > 1 and number != FRAME_LINK else []
        lines += [blocks[number]] if number in blocks else []
        lines += guides.get(number, [])
        layers[f"LINK_{number}"] = LayerShapes(tuple(lines), tuple((complex(p), _PIN * size) for p in z))
    return layers


def ghost_layers(study: Study, every_deg: float) -> dict[str, LayerShapes]:
    """A layer with the lines of all links every so many degrees of the turn, where the linkage stands there."""
    wanted = np.deg2rad(np.arange(0.0, 360.0, every_deg))
    there = study.at_theta(wanted[study.uncut.within(wanted)] if study.by_crank else wanted)
    lines: list[tuple[np.ndarray, bool]] = []
    for number, link in require_linkage(study.design).drive.linkage.by_number.items():
        if number != FRAME_LINK and len(link.points) > 1:
            body = there.linkage.bodies[body_name(number)]
            poses = np.array([np.broadcast_to(body.place(name), there.theta.shape) for name in link.places]).T * _MM
            lines += [(z, z.size > 2) for z in poses]
    return {"GHOSTS": LayerShapes(tuple(lines))}


def dxf(comment: Sequence[str], layers: Layers) -> bytes:
    """The file: comments, then the shapes on their layers."""
    import ezdxf

    with without_clock():
        drawing = ezdxf.new(VERSION)
        drawing.header["$INSUNITS"], drawing.header["$MEASUREMENT"] = MILLIMETRES, METRIC
        space = drawing.modelspace()
        for i, (name, shapes) in enumerate(layers.items()):
            drawing.layers.add(name, color=COLOURS[i % len(COLOURS)])
            on = {"layer": name}
            for z, closed in shapes.lines:
                space.add_lwpolyline(np.column_stack((z.real, z.imag)).tolist(), close=closed, dxfattribs=on)
            for centre, radius in shapes.circles:
                space.add_circle((centre.real, centre.imag), radius, dxfattribs=on)
        stream = io.StringIO()
        drawing.write(stream)
    head = "".join(f"999\n{line}\n" for line in comment)
    return (head + stream.getvalue()).encode("utf-8", "replace")


def pose_file(study: Study, theta: float, ending: str, more: Layers | None = None) -> bytes:
    """The links at an angle [rad] of the driver or the cam, and more layers, as a row of ``DRAWN``."""
    layers = {**pose_layers(study.at_theta(np.array([theta]))), **(more or {})}
    return DRAWN[ending]((f"{study.design.name} at {np.rad2deg(theta):g} deg, mm",), layers)


def curves_file(study: Study, curves: PointCurves, ending: str) -> bytes:
    """The curves as a row of ``DRAWN``, else as CSV."""
    if ending in DRAWN:
        return DRAWN[ending]((f"{study.design.name}: curves of points, mm",), curve_layers(curves))
    return curves_table(curves).encode()


def svg(comment: Sequence[str], layers: Layers) -> bytes:
    """The same to scale: one unit is one millimetre, y upwards."""
    return "\n".join(_svg_lines(comment, layers)).encode("utf-8", "replace")


def _svg_lines(comment: Sequence[str], layers: Layers) -> Iterator[str]:
    every = [z for shapes in layers.values() for z, _ in shapes.lines]
    every += [np.array([c - r * (1 + 1j), c + r * (1 + 1j)]) for s in layers.values() for c, r in s.circles]
    z = np.concatenate(every)
    margin = _MARGIN * max(float(np.ptp(z.real)), float(np.ptp(z.imag)), 1e-9)
    x, y = float(z.real.min()) - margin, -float(z.imag.max()) - margin
    width, height = float(np.ptp(z.real)) + 2.0 * margin, float(np.ptp(z.imag)) + 2.0 * margin
    yield '<?xml version="1.0" encoding="UTF-8"?>'
    size = f'width="{width:.6g}mm" height="{height:.6g}mm" viewBox="{x:.9g} {y:.9g} {width:.9g} {height:.9g}"'
    yield f'<svg xmlns="http://www.w3.org/2000/svg" {size} fill="none" stroke-width="{0.003 * max(width, height):.4g}">'
    yield f"<title>{escape(comment[0])}</title>"
    for i, (name, shapes) in enumerate(layers.items()):
        yield f'<g id="{escape(name)}" stroke="{STROKES[i % len(STROKES)]}">'
        for line, closed in shapes.lines:
            points = " ".join(f"{at.real + 0.0!r},{0.0 - at.imag!r}" for at in line.tolist())
            yield f'<{"polygon" if closed else "polyline"} points="{points}"/>'
        for centre, radius in shapes.circles:
            yield f'<circle cx="{centre.real!r}" cy="{0.0 - centre.imag!r}" r="{radius!r}"/>'
        yield "</g>"
    yield "</svg>\n"


DRAWN = {".dxf": dxf, ".svg": svg}
"""Ending of a file -> what writes it."""
