"""Curves of points of a linkage, and the path of a part in space: as tables and as layers of a drawing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from core.design import FRAME_LINK, Design, require_linkage
from core.errors import KindynaError
from core.frozen import frozen
from core.numerics.derivatives import ISOMETRIC, seen_from
from core.output.drawing.layers import WRITERS, LayerShapes
from core.output.lines import text_cell
from core.study import Study

_MM = 1e3
_MARK = 0.2 * 0.012  # radius of a mark at equal times, relative to the size


@frozen(eq=False)
class PointCurves:
    """Curves of points over a turn.

    Attributes
    ----------
    angles : (n,) angles of the turn [deg]
    curves : name of a point -> (n,) complex positions [mm]
    is_closed : whether the curves are closed
    marks : name of a point -> (k,) complex positions at equal times [mm]
    """

    angle_column: str
    angles: np.ndarray
    curves: Mapping[str, np.ndarray]
    is_closed: bool
    marks: Mapping[str, np.ndarray]


def point_names(design: Design) -> tuple[str, ...]:
    """Moving points of a linkage, in the order of its links."""
    linkage = require_linkage(design).drive.linkage
    fixed = linkage.by_number[FRAME_LINK].places
    names = (name for n in sorted(linkage.by_number) for name in linkage.by_number[n].places)
    return tuple(dict.fromkeys(name for name in names if name not in fixed))


def point_curves(study: Study, names: Sequence[str] = (), time_marks: int = 0) -> PointCurves:
    """Curves of the named points, or of all moving points. Raises KindynaError for an unknown name, NoSolution."""
    available = point_names(study.design)
    if unknown := [name for name in names if name not in available]:
        raise KindynaError(
            f"points: no moving point has the name {', '.join(unknown)}; allowed: {' | '.join(available)}"
        )
    selected = tuple(names) or available
    marks = {}
    if time_marks:
        marks = _positions(study.at_theta(np.linspace(0.0, 2.0 * np.pi, time_marks, endpoint=False)), selected)
    is_full_turn = study.angle_degrees.size == study.samples and not study.swings
    return PointCurves(study.angle_column, study.angle_degrees, _positions(study, selected), is_full_turn, marks)


def _positions(study: Study, names: Sequence[str]) -> dict[str, np.ndarray]:
    kinematics = study.linkage
    return {name: kinematics.bodies[kinematics.body_of(name)].position(name) * _MM for name in names}


def curves_csv(curves: PointCurves) -> str:
    """Curves of points as CSV: the angle, then x and y of each point."""
    names = [text_cell(f"{name}_{axis}_mm") for name in curves.curves for axis in "xy"]
    columns = [curves.angles, *(part for z in curves.curves.values() for part in (z.real, z.imag))]
    return _csv([curves.angle_column, *names], np.column_stack(columns))


def _csv(names: Sequence[str], rows: np.ndarray) -> str:
    return "\n".join([",".join(names), *(",".join(map(repr, row)) for row in rows.tolist())]) + "\n"


def path_csv(study: Study) -> str:
    """Path in space of the part that the drives carry, as CSV."""
    rows = np.column_stack((study.camshaft.angle_degrees, study.camshaft.transfer_path * _MM))
    return _csv(["machine_angle_deg", "x_mm", "y_mm", "z_mm"], rows)


def path_layers(study: Study) -> dict[str, LayerShapes]:
    """Path in space in an isometric view, with the three axes."""
    path = study.camshaft.transfer_path * _MM
    size = float(np.ptp(path, axis=0).max()) or 1.0
    axes = {
        name: LayerShapes(((seen_from(np.array([np.zeros(3), size * direction]), *ISOMETRIC), False),))
        for name, direction in zip(("X", "Y", "Z"), np.eye(3), strict=True)
    }
    return {"PATH": LayerShapes(((seen_from(path, *ISOMETRIC), True),)), **axes}


def curve_layers(curves: PointCurves) -> dict[str, LayerShapes]:
    """A layer for each point: its curve and its marks."""
    size = max((float(np.ptp(z.real) + np.ptp(z.imag)) for z in curves.curves.values()), default=1.0) or 1.0
    return {
        name: LayerShapes(
            ((z, curves.is_closed),), tuple((complex(m), _MARK * size) for m in curves.marks.get(name, ()))
        )
        for name, z in curves.curves.items()
    }


def curves_file(study: Study, curves: PointCurves, ending: str) -> bytes:
    """Curves of points in a format of ``WRITERS``, else as CSV."""
    if ending in WRITERS:
        return WRITERS[ending]((f"{study.design.name}: curves of points, mm",), curve_layers(curves))
    return curves_csv(curves).encode()
