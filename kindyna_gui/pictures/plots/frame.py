"""The frame of a plot: what it shows at which size, and the layers of what stands in it."""

from __future__ import annotations

from core.frozen import frozen

LEFT_WIDTH, TOP_HEIGHT, BOTTOM_HEIGHT = 66, 17, 38  # of the axes, pixels
Z_BANDS, Z_GRID, Z_ZERO, Z_LIMIT, Z_REFERENCE, Z_CURVE, Z_CURSOR = -90.0, -80.0, -70.0, 5.0, 8.0, 10.0, 20.0


@frozen
class Frame:
    """What a plot shows at which size: values from low to high over first ... last, a turn of the cam [deg] by
    default, on width x height pixels."""

    low: float
    high: float
    width: float
    height: float
    first: float = 0.0
    last: float = 360.0

    def pixel(self, value: float) -> float:
        """Height of a value above the axis, pixels."""
        return (value - self.low) / (self.high - self.low) * self.height

    def value(self, pixel: float) -> float:
        return self.low + pixel / self.height * (self.high - self.low)
