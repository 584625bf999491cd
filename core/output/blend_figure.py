"""A blended motion as a figure: displacement, velocity and acceleration by cam angle, below each other on one axis."""

from __future__ import annotations

import numpy as np

from core.blend import ELEMENTS, MOTION_TYPES, Blended, Request, blend
from core.design import UNITS
from core.laws import LAWS, PieceTable
from core.motion.curves import shape_of
from core.output.blend_text import curve_rows
from core.plot import Figure, Plot, PlotCurve

SAMPLES = 181
"""Cam angles of each curve, its ends among them."""
_QUANTITIES = (("Displacement", ""), ("Velocity", "/°"), ("Acceleration", "/°²"))


def blend_figure(blended: Blended, name: str = "blend") -> Figure:
    """Every curve from its own formula, velocity and acceleration by degrees of cam angle; where curves meet stands the name
    of the one that begins."""
    u = np.linspace(0.0, 1.0, SAMPLES)
    angles, values, marks = [], [], []
    for row, segment in zip(curve_rows(blended), blended.segments, strict=True):
        shape = shape_of(segment, False, "motion.segments")
        y = shape.gain * PieceTable(shape.pieces).at(u).all[:3] / segment.span_deg ** np.arange(3)[:, None]
        y[0] += row.level
        angles.append(row.angle + segment.span_deg * u)
        values.append(y)
        marks.append((row.angle, row.curve))
    x, y = np.concatenate(angles), np.concatenate(values, axis=1)
    symbol = UNITS[blended.request.unit].symbol
    plots = tuple(
        Plot(
            "Cam angle, °",
            f"{title}, {symbol}{per}",
            (PlotCurve(x, y[k], family=title.lower()),),
            () if k else tuple(marks),
            quiet=True,
        )
        for k, (title, per) in enumerate(_QUANTITIES)
    )
    return Figure(name, ", ".join(filter(None, ("-".join(blended.curves), blended.request.type))), plots)


def curve_shape(curve: str) -> np.ndarray:
    """An elementary curve alone over 0 ... 1, its displacement above its lowest level: u, s, v, a (4, n)."""
    u = np.linspace(0.0, 1.0, SAMPLES)
    s, v, a = ELEMENTS[curve].velocity_sign * LAWS[curve.lower()](u)[:3]
    return np.array([u, s - s.min(), v, a])


def type_shape(motion_type: str) -> np.ndarray:
    """A type of motion of fewest curves, stroke 1, with the dwells it has: cam angle [deg], s, v, a (4, n)."""
    row = MOTION_TYPES[motion_type]
    rests = (0, 0) in (row.rise or row.back or ())
    request = Request(motion_type, 1.0, *((60.0, 300.0) if rests else (0.0, 360.0)))
    plots = blend_figure(blend(request)).plots
    made = np.array([plots[0].curves[0].x, *(plot.curves[0].y for plot in plots)])
    if not rests:  # one turn after another
        return np.hstack([made, made + np.array([[360.0], [0.0], [0.0], [0.0]])])
    (low, high), (start, end) = made[0, [0, -1]], made[1, [0, -1]]
    still = [
        np.array([angles, [level] * 2, [0.0] * 2, [0.0] * 2])
        for angles, level in (((0.0, low), start), ((high, 360.0), end))
    ]
    return np.hstack([still[0], made, still[1]])
