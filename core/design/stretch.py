"""A curve made longer or higher: the same shape over another span, between other levels."""

from __future__ import annotations

from collections.abc import Callable

from core.design.parts import Curve, End, Point, Polynomial, Spline

Scale = Callable[[float], float]


def stretched(curve: Curve, span: float, height: float) -> Curve:
    """The curve of a segment whose span and rise are multiplied by these: the same shape, larger or smaller."""
    return scaled(curve, span, lambda value: value * height)


def scaled(curve: Curve, span: float, level: Scale) -> Curve:
    """The curve of a segment whose span is multiplied by ``span`` and whose levels are scaled by a linear function."""
    if isinstance(curve, Polynomial):
        return Polynomial(_end(curve.start, span, level), _end(curve.end, span, level))
    if isinstance(curve, Spline):
        return Spline(tuple(_point(point, span, level) for point in curve.points))
    return curve


def times(value: float | None, by: float) -> float | None:
    """The product, where there is a value."""
    return None if value is None else value * by


def _over(value: float | None, level: Scale, span: float) -> float | None:
    return None if value is None else level(value) / span


def _end(end: End, span: float, level: Scale) -> End:
    return End(level(end.velocity) / span, level(end.acceleration) / span**2, _over(end.jerk, level, span**3))


def _point(point: Point, span: float, level: Scale) -> Point:
    return Point(
        point.at_deg * span,
        _over(point.value, level, 1.0),
        _over(point.velocity, level, span),
        _over(point.acceleration, level, span**2),
    )


__all__ = ["scaled", "stretched", "times"]
