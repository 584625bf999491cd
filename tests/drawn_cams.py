"""Cams drawn as the textbooks draw them, in DXF files: lines and arcs with what is known of them in closed form."""

import cmath
import io
import math
from dataclasses import dataclass

import ezdxf
import numpy as np


def drawn(*shapes: tuple[object, ...], unit: int = 4, layer: str = "0") -> bytes:
    """A drawing of ``line``, ``arc``, ``circle``, ``lwpolyline`` ... with their arguments; unit: $INSUNITS."""
    drawing = ezdxf.new("R2010")
    drawing.header["$INSUNITS"] = unit
    for kind, *arguments in shapes:
        *places, options = arguments if isinstance(arguments[-1], dict) else (*arguments, {})
        getattr(drawing.modelspace(), f"add_{kind}")(*places, **options, dxfattribs={"layer": layer})
    stream = io.StringIO()
    drawing.write(stream)
    return stream.getvalue().encode()


def _xy(z: complex) -> tuple[float, float]:
    return z.real, z.imag


def _arc(centre: complex, start: complex, end: complex) -> tuple[object, ...]:
    """Counter-clockwise."""
    angles = (math.degrees(cmath.phase(z - centre)) for z in (start, end))
    return ("arc", _xy(centre), abs(start - centre), *angles)


@dataclass(frozen=True)
class NosedCam:
    """A base circle, a nose whose centre lies at a distance on the x axis, and flanks: lines, or arcs of a radius."""

    base: float = 25.0
    nose: float = 8.0
    distance: float = 24.0
    flank: float = math.inf

    @property
    def centre(self) -> complex:
        """Of the upper flank's arc: it touches base circle and nose from outside."""
        far, near, d = self.flank - self.base, self.flank - self.nose, self.distance
        x = (far * far - near * near + d * d) / (2.0 * d)
        return complex(x, -math.sqrt(far * far - x * x))

    @property
    def normals(self) -> tuple[complex, complex]:
        """Where the upper flank leaves the base circle, and where it meets the nose."""
        if math.isinf(self.flank):
            n = cmath.rect(1.0, math.acos((self.base - self.nose) / self.distance))
            return n, n
        c = self.centre
        return -c / abs(c), (self.distance - c) / abs(self.distance - c)

    @property
    def joints(self) -> tuple[complex, complex]:
        first, last = self.normals
        return self.base * first, self.distance + self.nose * last

    @property
    def shapes(self) -> list[tuple[object, ...]]:
        p, q = self.joints
        straight = math.isinf(self.flank)
        flanks = (
            [("line", _xy(p), _xy(q)), ("line", _xy(p.conjugate()), _xy(q.conjugate()))]
            if straight
            else [_arc(self.centre, q, p), _arc(self.centre.conjugate(), p.conjugate(), q.conjugate())]
        )
        return [flanks[0], _arc(complex(self.distance), q.conjugate(), q), flanks[1], _arc(0j, p, p.conjugate())]

    def distance_of(self, z: np.ndarray) -> np.ndarray:
        """Of points (n,) from the outline: by which of its parts they lie at, seen along the normals at the joints."""
        z = np.where(z.imag < 0.0, z.conj(), z)
        (first, last), (p, q) = self.normals, self.joints
        on_base = ((z - p) * (1j * first).conjugate()).real >= 0.0
        on_nose = ((z - q) * (1j * last).conjugate()).real <= 0.0
        flank = ((z - p) * first.conjugate()).real if math.isinf(self.flank) else np.abs(z - self.centre) - self.flank
        rest = np.where(on_nose, np.abs(z - self.distance) - self.nose, flank)
        return np.abs(np.where(on_base, np.abs(z) - self.base, rest))
