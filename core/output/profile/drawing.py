"""What a drawing of the profile holds, layer by layer; written by ``dxf`` and ``svg``. One row a layer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import partial
from itertools import pairwise
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np

from core.cam import OUTER, SECOND, form_row, keyway_corners, keyway_unknown
from core.errors import NoCam
from core.frozen import frozen
from core.output.profile.curve import MM
from core.output.profile.digits import rounded_up
from core.output.profile.fits import FITS, Arcs, Cubics
from core.output.profile.made import FittedCurve, beside, exact_curve, fitted, touching
from core.output.profile.points import SAMPLINGS
from core.output.profile.request import Request
from core.study import Study

ZERO = (
    0.75,
    0.95,
)  # of the way from the centre to the profile: the angle-zero mark, which ends on no curve, or CAD would chain them
SENSES: Mapping[float, tuple[str, str]] = MappingProxyType(
    {1.0: ("ccw", "counter-clockwise"), -1.0: ("cw", "clockwise")}
)


@frozen
class CircleShape:
    """About the cam centre [mm]."""

    radius: float


@frozen
class LineShape:
    """From point to point [mm]."""

    start: complex
    end: complex


Shape: TypeAlias = "Arcs | Cubics | CircleShape | LineShape"


@frozen(eq=False)
class ProfileDrawing:
    """The study, what was asked of it, and the curve that came of it; profiles: flank -> its profile, of all flanks of the cam, where
    a drawing is to be made."""

    study: Study
    request: Request
    main: FittedCurve
    profiles: Mapping[str, FittedCurve] = field(default_factory=dict)

    @property
    def profile(self) -> np.ndarray:
        """Points (n,) complex [mm] of the profile, at the angles of the study."""
        return self.study.cam.only(self.request.flank).flank.profile * MM


def drawn_profiles(study: Study, request: Request, main: FittedCurve, least_mm: float) -> dict[str, FittedCurve]:
    """The profiles of ``ProfileDrawing``, sampled and fitted as its curve. Raises NoCam, which names the flank, KindynaError."""

    def made(flank: str) -> FittedCurve:
        if flank == request.flank and not request.cutter_mm:
            return main
        alone = replace(request, flank=flank, cutter_mm=0.0)
        try:
            return fitted(study, exact_curve(study, alone), alone, least_mm)
        except NoCam as error:
            raise NoCam(f"{flank} flank: {error.problem}", error.field, error.hint, error.cam_angles) from None

    return {flank: made(flank) for flank in _flanks(study)}


def _flanks(study: Study) -> tuple[str, ...]:
    return form_row(study.design.drive.cam.form).flanks


def _layer(study: Study, flank: str) -> str:
    """Where its profile stands: the walls of a groove have their names, of a pair the second cam has."""
    return "PROFILE" if flank == _flanks(study)[0] and OUTER not in _flanks(study) else f"PROFILE_{flank.upper()}"


@frozen
class DrawingLayer:
    """One row: its DXF colour, its colour in SVG, its line type, and what stands on it, which may be nothing."""

    colour: int
    stroke: str
    line: str
    shapes: Callable[[ProfileDrawing], Iterator[Shape]]


def _profile(layer: str, job: ProfileDrawing) -> Iterator[Shape]:
    """Beside a cutter's path it is drawn for comparison."""
    yield from (drawn.chain for flank, drawn in job.profiles.items() if _layer(job.study, flank) == layer)


def _cutter(job: ProfileDrawing) -> Iterator[Shape]:
    if job.request.cutter_mm:
        yield job.main.chain


def _pitch(second: bool, job: ProfileDrawing) -> Iterator[Shape]:
    """Both walls of a groove have one, each cam of a pair its own."""
    if second and SECOND not in _flanks(job.study):
        return
    request = replace(job.request, flank=SECOND if second else _flanks(job.study)[0])
    radius = touching(job.study, request).radius_mm
    if radius:
        yield beside(job.study, request, radius)


def _base(job: ProfileDrawing) -> Iterator[Shape]:
    radius: float | None = getattr(
        job.study.design.drive.cam, "base_radius_mm", None
    )  # a linkage gives its cam the size
    if radius is not None:
        yield CircleShape(radius)


def _bore(job: ProfileDrawing) -> Iterator[Shape]:
    diameter = job.study.design.drive.cam.bore_mm
    if diameter is not None:
        yield CircleShape(0.5 * diameter)


def _keyway(job: ProfileDrawing) -> Iterator[Shape]:
    """The sides and the bottom of the keyway, from the bore outwards."""
    yield from (LineShape(start, end) for start, end in pairwise(keyway_corners(job.study.design.drive.cam)))


def _zero(job: ProfileDrawing) -> Iterator[Shape]:
    """A radial line towards the nearest profile, along the cam's own x axis, which is the global one at cam angle 0."""
    edge = min(_edge(flank.profile * MM) for flank in job.study.cam.flanks)
    yield LineShape(complex(ZERO[0] * edge), complex(ZERO[1] * edge))


def _edge(z: np.ndarray) -> float:
    """Where the x axis leaves a closed curve through points (n,)."""
    after = np.roll(z, -1)
    cut = np.flatnonzero((z.imag <= 0.0) != (after.imag <= 0.0))
    one, other = z[cut], after[cut]
    return float((one.real - one.imag * (other.real - one.real) / (other.imag - one.imag)).max())


PROFILES = ("PROFILE", "PROFILE_INNER", "PROFILE_OUTER", "PROFILE_SECOND")
LAYERS: Mapping[str, DrawingLayer] = MappingProxyType(
    {
        **{name: DrawingLayer(7, "#000000", "CONTINUOUS", partial(_profile, name)) for name in PROFILES},
        "CUTTER": DrawingLayer(1, "#d55e00", "CONTINUOUS", _cutter),
        "PITCH": DrawingLayer(5, "#0072b2", "CENTER", partial(_pitch, False)),
        "PITCH_SECOND": DrawingLayer(5, "#0072b2", "CENTER", partial(_pitch, True)),
        "BASE": DrawingLayer(8, "#808080", "DASHED", _base),
        "BORE": DrawingLayer(7, "#000000", "CONTINUOUS", _bore),
        "KEYWAY": DrawingLayer(7, "#000000", "CONTINUOUS", _keyway),
        "ZERO": DrawingLayer(3, "#009e73", "CONTINUOUS", _zero),
    }
)


def layers(job: ProfileDrawing) -> dict[str, list[Shape]]:
    """Name -> what stands on it; those with nothing on them are left out."""
    drawn = {name: list(row.shapes(job)) for name, row in LAYERS.items()}
    return {name: shapes for name, shapes in drawn.items() if shapes}


def reach(drawn: Mapping[str, Sequence[Shape]]) -> float:
    """Largest distance of anything drawn from the cam centre [mm]; of curves that of their points."""
    return max(_reach(shape) for shapes in drawn.values() for shape in shapes)


def _reach(shape: Shape) -> float:
    if isinstance(shape, CircleShape):
        return shape.radius
    return abs(shape.end) if isinstance(shape, LineShape) else float(np.abs(shape.vertices).max())


def facts(job: ProfileDrawing) -> dict[str, Any]:
    """What the file is, as JSON says it: on the terminal, and beside the file."""
    request, main = job.request, job.main
    several = {_layer(job.study, flank): {"flank": flank, **_figures(drawn)} for flank, drawn in job.profiles.items()}
    return {
        "design": job.study.design.name,
        "curve": "path of the cutter's centre" if request.cutter_mm else "profile",
        "flank": request.flank,
        "cutter_radius_mm": request.cutter_mm or None,
        "rotation": SENSES[job.study.sense][0],
        "units": {"length": "mm", "angle": "deg"},
        "origin": "cam centre; the x axis is the global one at cam angle 0",
        "sampling": SAMPLINGS[request.sampling].text.format(value=request.value),
        "fit": FITS[request.fit].label,
        **_figures(main),
        "tolerance_mm": request.tolerance_mm,
        **({"layers": several} if len(several) > 1 else {}),
    }


def _figures(drawn: FittedCurve) -> dict[str, Any]:
    return {"points": drawn.count, "length_mm": drawn.curve.length, "deviation_mm": drawn.deviation}


def _one_line(text: str) -> str:
    """Without what ends a line, and what no drawing may hold."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))


def comment(job: ProfileDrawing) -> list[str]:
    """The same in lines, for a drawing."""
    stated = facts(job)
    radius = f", radius {job.request.cutter_mm!r} mm" if job.request.cutter_mm else ""
    allowed = "" if stated["tolerance_mm"] is None else f", tolerance {stated['tolerance_mm']!r} mm"
    missing = ", ".join(f"cam.{name}" for name in keyway_unknown(job.study.design.drive.cam))
    keyway = [f"Keyway: not drawn, as not given: {missing}"] if missing else []
    return [
        f"Design: {_one_line(stated['design'])}",
        f"Curve: {stated['curve']}{radius}, {stated['flank']} flank",
        f"Cam turns {SENSES[job.study.sense][1]} ({stated['rotation']}) as drawn",
        f"Units: mm; origin: {stated['origin']}",
        f"Points: {stated['points']}, {stated['sampling']}; {stated['fit']}",
        f"Length: {stated['length_mm']:.9g} mm",
        f"Deviation from the exact curve: at most {rounded_up(stated['deviation_mm'], 4)!r} mm{allowed}",
        *(
            f"Layer {name}: profile, {row['flank']} flank, {row['points']} points, at most {rounded_up(row['deviation_mm'], 4)!r} mm"
            for name, row in stated.get("layers", {}).items()
        ),
        *keyway,
    ]
