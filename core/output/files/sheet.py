"""What stands on a sheet of paper: lines, circles, curves, arrows and texts [mm], without anything that paints them.

Places are complex, from the lower left corner of the sheet, y upwards.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TypeAlias
from xml.parsers import expat

import numpy as np

from core.bounds import NESTING, PIXELS
from core.cam import OUTER, form_row
from core.design.fields import choice
from core.errors import FileError, KindynaError
from core.frozen import frozen
from core.motion import Angles, degrees
from core.motion.extremes import Extreme, find_extremes
from core.output.files.made import FittedCurve, exact_curve, fitted
from core.output.files.profile_curve import Exact
from core.output.files.profile_files import ProfileDrawing
from core.output.files.profile_fit import Cubics
from core.output.files.profile_request import ProfileRequest, flank_choice
from core.project.files import read_bytes
from core.requests import text_option
from core.study import Study

# -- what a drawing of a cam states in figures ------------------------------------------------------------------


BLANK = (
    "base_radius_mm", "thickness_mm", "bore_mm", "hub_mm", "keyway_width_mm", "keyway_depth_mm", "keyway_angle_deg",
)  # fmt: skip
POINTS = 36  # rows of the table of points
SEARCHED = 720  # angles at which a stretch of constant radius is looked for
EQUAL = 1e-9  # relative: radii that are one
SPANS, MOST_SPANS = 360, 23_040  # of the curve as drawn, at first and at most
DRAWN = 1e-5  # of the cam's size: how far the curve as drawn may be off
STRAIGHT = 1e-9  # of 1/size: what is less curved is straight


@frozen(eq=False)
class ProfilePoint:
    """A value, the cam angle [deg] where it stands, the point of the profile there [mm], and all points that have the value."""

    value: float
    cam_angle_deg: float
    z: complex
    all: np.ndarray


@frozen(eq=False)
class Figures:
    """
    job       the chosen flank, its curve as drawn and exactly; ``others`` are the curves of the other flanks of this body
    smallest  radius from the cam centre [mm], and ``largest``
    convex    least radius of curvature [mm] where the profile is convex, and ``concave``; None where it is so nowhere
    table     (36, 3): cam angle [deg], radius [mm], polar angle [deg]
    """

    job: ProfileDrawing
    others: tuple[Cubics, ...]
    smallest: ProfilePoint
    largest: ProfilePoint
    convex: ProfilePoint | None
    concave: ProfilePoint | None
    table: np.ndarray

    @property
    def chains(self) -> tuple[Cubics, ...]:
        """All curves as drawn, the chosen flank's first."""
        return _cubics(self.job.main), *self.others

    @property
    def cam(self) -> Mapping[str, float]:
        """What is known of the blank, by the fields' names [mm, deg]."""
        cam = self.job.study.design.drive.cam
        values = {name: getattr(cam, name, None) for name in BLANK}
        if self.job.request.flank != form_row(cam.form).flanks[0]:
            values["base_radius_mm"] = None  # it is that of the first flank
        return {name: value for name, value in values.items() if value is not None}


def figures(study: Study, flank: str) -> Figures:
    """The figures of one flank.

    Raises as ``core.output.files.files.job_of`` does: NoSuchStage, NoCam, KindynaError.
    """
    first = exact_curve(study, ProfileRequest(flank, samples=POINTS, fit="spline"))
    around = study.program.angles(np.deg2rad(degrees(SEARCHED)))
    z = first(around).z
    job = _job(study, first, ProfileRequest(flank, samples=SPANS, fit="spline"))
    there = form_row(study.design.drive.cam.form).flanks
    walls = [
        replace(job.request, flank=name) for name in there if name != flank and OUTER in there
    ]  # of a groove, in the same body
    others = tuple(_cubics(_job(study, exact_curve(study, wall), wall).main) for wall in walls)

    def quantities(angles: Angles) -> dict[str, np.ndarray]:
        samples = first(angles)
        return {"radius": np.abs(samples.z), "curvature": -study.sense * samples.curvature}

    found = find_extremes(quantities, study.program)
    size = found["radius"].high.value
    bend, hollow = found["curvature"].high, found["curvature"].low
    sampled = quantities(around)

    def place(name: str, extreme: Extreme, value: float) -> ProfilePoint:
        same = z[np.abs(sampled[name] - extreme.value) <= EQUAL * abs(extreme.value)]
        at = complex(first(study.program.angles(np.array([extreme.theta]))).z[0])
        return ProfilePoint(value, float(np.rad2deg(extreme.theta)), at, np.append(same, at))

    return Figures(
        job,
        others,
        place("radius", found["radius"].low, found["radius"].low.value),
        place("radius", found["radius"].high, size),
        place("curvature", bend, 1.0 / bend.value) if bend.value * size > STRAIGHT else None,
        place("curvature", hollow, -1.0 / hollow.value) if hollow.value * size < -STRAIGHT else None,
        _table(study, first),
    )


def _job(study: Study, exact: Exact, request: ProfileRequest) -> ProfileDrawing:
    """The curve of a flank, of as many points as it takes."""
    while True:
        main = fitted(study, exact, request)
        if main.deviation <= DRAWN * main.curve.size or request.value >= MOST_SPANS:
            return ProfileDrawing(study, request, main)
        request = replace(request, samples=4 * int(request.value))


def _cubics(drawn: FittedCurve) -> Cubics:
    assert isinstance(drawn.chain, Cubics)
    return drawn.chain


def _table(study: Study, exact: Exact) -> np.ndarray:
    angles = degrees(POINTS)
    z = exact(study.program.angles(np.deg2rad(angles))).z
    return np.column_stack((angles, np.abs(z), np.mod(np.rad2deg(np.angle(z)), 360.0)))


def extent(chains: tuple[Cubics, ...]) -> tuple[complex, complex]:
    """Lower left and upper right corner [mm] of closed chains of cubics, the cam centre included; by points close to each other."""
    t = np.linspace(0.0, 1.0, 9)
    weights = np.stack(((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3))
    z = np.append(np.concatenate([(chain.points @ weights).ravel() for chain in chains]), 0j)
    return complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())


# -- papers, the standard scales, and the fields into which a sheet is divided ----------------------------------


PAPERS: Mapping[str, tuple[float, float]] = MappingProxyType({"A4": (297.0, 210.0), "A3": (420.0, 297.0)})
"""Width and height [mm], lying."""

FILING, EDGE = 20.0, 10.0  # mm: edges of ISO 5457, the wide one for filing
USUAL = 190.0  # mm inside the frame of an A4: on larger paper texts and tables grow alike
COLUMN = 96.0  # of tables and title block, on A4

STEPS, DECADES = (1, 2, 5), range(5)
SCALES: tuple[tuple[int, int], ...] = tuple(
    sorted(
        {pair for step in STEPS for decade in DECADES for pair in ((step * 10**decade, 1), (1, step * 10**decade))},
        key=lambda pair: -pair[0] / pair[1],
    )
)
"""Of ISO 5455, paper : cam, from the largest."""


@frozen
class Box:
    """A rectangle on the sheet [mm]."""

    left: float
    bottom: float
    right: float
    top: float

    @property
    def width(self) -> float:
        """Width [mm]."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Height [mm]."""
        return self.top - self.bottom

    @property
    def middle(self) -> complex:
        """Its middle [mm]."""
        return 0.5 * complex(self.left + self.right, self.bottom + self.top)

    @property
    def corners(self) -> tuple[complex, ...]:
        """All round and back to the first."""
        low, high = complex(self.left, self.bottom), complex(self.right, self.top)
        return low, complex(self.right, self.bottom), high, complex(self.left, self.top), low


@frozen
class PaperLayout:
    """A paper: its size, the frame, the field of the view and that of the tables; ``unit`` is how much larger than on A4 texts
    and tables are."""

    width: float
    height: float
    frame: Box
    view: Box
    column: Box
    unit: float


def layout(paper: str) -> PaperLayout:
    """The fields of a row of ``PAPERS``. Raises KindynaError for any other paper."""
    size = PAPERS.get(paper)
    if size is None:
        raise KindynaError(f"paper {paper!r}: not known; allowed: {', '.join(PAPERS)}")
    width, height = size
    frame = Box(FILING, EDGE, width - EDGE, height - EDGE)
    unit = frame.height / USUAL
    divide = frame.right - COLUMN * unit
    return PaperLayout(
        width,
        height,
        frame,
        Box(frame.left, frame.bottom, divide, frame.top),
        Box(divide, frame.bottom, frame.right, frame.top),
        unit,
    )


def scale_for(width: float, height: float, room: tuple[float, float]) -> tuple[int, int]:
    """The largest standard scale at which width and height [mm] have room [mm]. Raises KindynaError where none is small enough."""
    for on_paper, real in SCALES:
        if width * on_paper <= room[0] * real and height * on_paper <= room[1] * real:
            return on_paper, real
    least = f"{SCALES[-1][0]}:{SCALES[-1][1]}"
    raise KindynaError(
        f"a cam of {max(width, height):.6g} mm has no room on the sheet at {least}, the smallest scale; take larger paper"
    )


# -- who makes reports and drawings -----------------------------------------------------------------------------


SVG = "image/svg+xml"


@frozen(eq=False)
class Logo:
    """A picture file: its media type and its bytes."""

    kind: str
    data: bytes


@frozen
class Letterhead:
    """As text; logo: a file."""

    author: str = text_option("by whom", default="", metavar="TEXT")
    company: str = text_option("of which company", default="", metavar="TEXT")
    logo: str = text_option("its logo: PNG, JPEG or SVG", default="", metavar="FILE")


def logo_of(head: Letterhead) -> tuple[Logo | None, str]:
    """The logo, and in a line why there is none where one was named: what is written is written without it."""
    if not head.logo.strip():
        return None, ""
    try:
        data = read_bytes(head.logo)
    except FileError as error:
        return None, f"{error}; the logo is left out"
    kind = _svg(data) if data.lstrip()[:1] == b"<" else _image(data)
    if not kind:
        allowed = f"PNG or JPEG of at most {PIXELS / 1e6:g} megapixels, or SVG"
        return None, f"{head.logo}: is no picture that can be read; allowed: {allowed}; the logo is left out"
    return Logo(kind, data), ""


def _svg(data: bytes) -> str:
    """Media type of a picture in XML; empty of another, of what is broken, or nested too deeply."""
    parser, names = expat.ParserCreate(), list[str]()
    root: list[str] = []

    def start(name: str, attributes: dict[str, str]) -> None:
        root[:] = root or [name]
        names.append(name)
        if len(names) > NESTING:
            raise ValueError("nested too deeply")

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: names.pop()
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, ValueError, LookupError):
        return ""
    return SVG if root[0].rpartition(":")[2] == "svg" else ""


def _image(data: bytes) -> str:
    """Media type of a PNG or JPEG; empty of another, of what is broken, or too large."""
    from PIL import Image  # loading it takes longer than a small report

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(io.BytesIO(data), formats=("PNG", "JPEG")) as picture:
                if picture.width * picture.height > PIXELS:
                    return ""
                picture.load()
                return str(picture.get_format_mimetype())
    except Exception:  # what is broken makes the decoders raise anything
        return ""


# -- what a drawing of a cam shall be like ----------------------------------------------------------------------


@frozen
class DrawingRequest(Letterhead):
    """flank: name of one of the cam's; paper: row of ``PAPERS``; author, company, logo, date: what stands in the title block."""

    paper: str = choice("Paper", tuple(PAPERS), default="A4", help="size of the sheet, lying")
    flank: str = flank_choice()
    date: str = text_option("for the field of the title block, empty without it", default="", metavar="TEXT")


# -- what stands on a sheet of paper ----------------------------------------------------------------------------


OUTLINE, THIN, CENTRE, DASHED, FRAME = "outline", "thin", "centre", "dashed", "frame"


@frozen
class LineKind:
    """Width [mm]; dashes [mm], drawn and left out in turn."""

    width: float
    dashes: tuple[float, ...] = ()


LINE_KINDS: Mapping[str, LineKind] = MappingProxyType(
    {
        OUTLINE: LineKind(0.5),
        THIN: LineKind(0.18),
        CENTRE: LineKind(0.18, (6.0, 1.2, 0.6, 1.2)),
        DASHED: LineKind(0.18, (2.0, 1.0)),
        FRAME: LineKind(0.35),
    }
)
"""Lines of ISO 128: visible edges, dimensions, axes, circles that are no edges, frames."""


@frozen
class SheetLine:
    """From point to point, through all of them; ``kind`` is a row of ``LINE_KINDS``."""

    points: tuple[complex, ...]
    kind: str = THIN


@frozen
class SheetCircle:
    """All of a circle, or the arc of so many degrees counter-clockwise from ``start_deg``."""

    centre: complex
    radius: float
    kind: str = THIN
    start_deg: float = 0.0
    span_deg: float = 360.0


@frozen(eq=False)
class BezierLoop:
    """A closed chain of cubics: their Bézier points (n, 4)."""

    points: np.ndarray
    kind: str = OUTLINE


@frozen
class ArrowHead:
    """A filled arrowhead: its tip, the unit vector in which it points, its length."""

    tip: complex
    direction: complex
    length: float


@frozen
class SheetText:
    """One line: where it stands on its baseline, height of its capitals, the width that it has at most: what is longer is
    condensed; align: 0 begins there, 0.5 has its middle there, 1 ends there."""

    at: complex
    text: str
    height: float
    room: float
    align: float = 0.0


@frozen(eq=False)
class SheetLogo:
    """A picture as large as it fits between two corners, lower left and upper right."""

    low: complex
    high: complex
    logo: Logo


Item: TypeAlias = "SheetLine | SheetCircle | BezierLoop | ArrowHead | SheetText | SheetLogo"


@frozen(eq=False)
class DrawingSheet:
    """A sheet of paper: its size [mm], a title, sentences that say what it is, and what stands on it; lacking: what should and does not,
    in a line."""

    width: float
    height: float
    title: str
    about: str
    items: tuple[Item, ...]
    lacking: str = ""
