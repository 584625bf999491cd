"""Dimensions of a cam for its drawing, and the lines, circles, curves, arrows and texts of a sheet [mm].

Points on a sheet are complex, measured from its lower left corner, y upwards.
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
from core.number_text import result_text
from core.output.files.fitted_curve import FittedCurve, exact_curve, fit_curve
from core.output.files.profile_curve import ExactCurve
from core.output.files.profile_files import ProfileDrawing
from core.output.files.profile_fit import Cubics
from core.output.files.profile_request import ProfileRequest, flank_choice
from core.project.files import read_bytes
from core.requests import text_option
from core.study import Study

# -- dimensions of a cam ----------------------------------------------------------------------------------------


BLANK = (
    "base_radius_mm", "thickness_mm", "bore_mm", "hub_mm", "keyway_width_mm", "keyway_depth_mm", "keyway_angle_deg",
)  # fmt: skip
POINTS = 36  # rows of the table of points
SEARCHED = 720  # angles at which an arc of constant radius is searched
EQUAL = 1e-9  # relative difference of equal radii
SPANS, MOST_SPANS = 360, 23_040  # of the curve as drawn, at first and at most
DRAWN = 1e-5  # allowed error of the curve as drawn, relative to the cam's size
STRAIGHT = 1e-9  # relative to 1/size: a smaller curvature counts as straight


@frozen(eq=False)
class ProfilePoint:
    """An extreme of the profile.

    Attributes
    ----------
    value : its value [mm]
    cam_angle_deg : its cam angle [deg]
    z : its point of the profile [mm]
    points : (k,) all sampled points with the same value, complex [mm]
    """

    value: float
    cam_angle_deg: float
    z: complex
    points: np.ndarray


@frozen(eq=False)
class CamDimensions:
    """Dimensions of a cam for the drawing of one flank.

    Attributes
    ----------
    job : the chosen flank with its curve as drawn
    others : curves of the other flanks of this body
    smallest, largest : extreme radius from the cam centre
    convex, concave : least radius of curvature where the profile is convex or concave; None where it never is
    table : (36, 3) cam angle [deg], radius [mm], polar angle [deg]
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
        """Curves as drawn, the one of the chosen flank first."""
        return _cubics(self.job.main), *self.others

    @property
    def cam(self) -> Mapping[str, float]:
        """Given dimensions of the blank by the names of their fields [mm or deg]."""
        cam = self.job.study.design.drive.cam
        values = {name: getattr(cam, name, None) for name in BLANK}
        if self.job.request.flank != form_row(cam.form).flanks[0]:
            values["base_radius_mm"] = None  # belongs to the first flank
        return {name: value for name, value in values.items() if value is not None}


def cam_dimensions(study: Study, flank: str) -> CamDimensions:
    """Dimensions of one flank. Raises NoSuchStage, NoCam, KindynaError as `exact_curve`."""
    first = exact_curve(study, ProfileRequest(flank, samples=POINTS, fit="spline"))
    around = study.program.angles(np.deg2rad(degrees(SEARCHED)))
    z = first(around).z
    job = _job(study, first, ProfileRequest(flank, samples=SPANS, fit="spline"))
    names = form_row(study.design.drive.cam.form).flanks
    walls = [replace(job.request, flank=name) for name in names if name != flank and OUTER in names]  # of one groove
    others = tuple(_cubics(_job(study, exact_curve(study, wall), wall).main) for wall in walls)

    def quantities(angles: Angles) -> dict[str, np.ndarray]:
        samples = first(angles)
        return {"radius": np.abs(samples.z), "curvature": -study.sense * samples.curvature}

    extremes = find_extremes(quantities, study.program)
    size = extremes["radius"].high.value
    convex, concave = extremes["curvature"].high, extremes["curvature"].low
    sampled = quantities(around)

    def profile_point(name: str, extreme: Extreme, value: float) -> ProfilePoint:
        equal_points = z[np.abs(sampled[name] - extreme.value) <= EQUAL * abs(extreme.value)]
        point = complex(first(study.program.angles(np.array([extreme.theta]))).z[0])
        return ProfilePoint(value, float(np.rad2deg(extreme.theta)), point, np.append(equal_points, point))

    return CamDimensions(
        job,
        others,
        profile_point("radius", extremes["radius"].low, extremes["radius"].low.value),
        profile_point("radius", extremes["radius"].high, size),
        profile_point("curvature", convex, 1.0 / convex.value) if convex.value * size > STRAIGHT else None,
        profile_point("curvature", concave, -1.0 / concave.value) if concave.value * size < -STRAIGHT else None,
        _table(study, first),
    )


def _job(study: Study, exact: ExactCurve, request: ProfileRequest) -> ProfileDrawing:
    """The curve of a flank, with as many points as the accuracy requires."""
    while True:
        main = fit_curve(study, exact, request)
        if main.deviation <= DRAWN * main.curve.size or request.value >= MOST_SPANS:
            return ProfileDrawing(study, request, main)
        request = replace(request, samples=4 * int(request.value))


def _cubics(curve: FittedCurve) -> Cubics:
    assert isinstance(curve.chain, Cubics)
    return curve.chain


def _table(study: Study, exact: ExactCurve) -> np.ndarray:
    angles = degrees(POINTS)
    z = exact(study.program.angles(np.deg2rad(angles))).z
    return np.column_stack((angles, np.abs(z), np.mod(np.rad2deg(np.angle(z)), 360.0)))


def extent(chains: tuple[Cubics, ...]) -> tuple[complex, complex]:
    """Lower left and upper right corner [mm] of closed chains of cubics and the cam centre, by dense points."""
    t = np.linspace(0.0, 1.0, 9)
    weights = np.stack(((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3))
    z = np.append(np.concatenate([(chain.points @ weights).ravel() for chain in chains]), 0j)
    return complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())


# -- papers and standard scales ---------------------------------------------------------------------------------


PAPERS: Mapping[str, tuple[float, float]] = MappingProxyType({"A4": (297.0, 210.0), "A3": (420.0, 297.0)})
"""Width and height [mm] in landscape."""

FILING, EDGE = 20.0, 10.0  # mm: edges of ISO 5457, the wide one for filing
A4_HEIGHT = 190.0  # mm inside the frame of an A4 sheet: on larger paper texts and tables are scaled
COLUMN = 96.0  # mm on A4, width of tables and title block

STEPS, DECADES = (1, 2, 5), range(5)
SCALES: tuple[tuple[int, int], ...] = tuple(
    sorted(
        {pair for step in STEPS for decade in DECADES for pair in ((step * 10**decade, 1), (1, step * 10**decade))},
        key=lambda pair: -pair[0] / pair[1],
    )
)
"""Scales of ISO 5455, paper : cam, from the largest."""


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
        """Centre [mm]."""
        return 0.5 * complex(self.left + self.right, self.bottom + self.top)

    @property
    def corners(self) -> tuple[complex, ...]:
        """Corners counter-clockwise from the lower left one, which is repeated at the end [mm]."""
        low, high = complex(self.left, self.bottom), complex(self.right, self.top)
        return low, complex(self.right, self.bottom), high, complex(self.left, self.top), low


@frozen
class PaperLayout:
    """Fields of a sheet of paper [mm].

    Attributes
    ----------
    width, height : size of the paper
    frame : the drawing frame
    view : field of the view
    column : field of tables and title block
    unit : size of texts and tables relative to A4
    """

    width: float
    height: float
    frame: Box
    view: Box
    column: Box
    unit: float


def layout(paper: str) -> PaperLayout:
    """Fields of a row of ``PAPERS``. Raises KindynaError for any other paper."""
    size = PAPERS.get(paper)
    if size is None:
        raise KindynaError(f"paper {paper!r}: unknown; allowed: {', '.join(PAPERS)}")
    width, height = size
    frame = Box(FILING, EDGE, width - EDGE, height - EDGE)
    unit = frame.height / A4_HEIGHT
    boundary = frame.right - COLUMN * unit
    return PaperLayout(
        width,
        height,
        frame,
        Box(frame.left, frame.bottom, boundary, frame.top),
        Box(boundary, frame.bottom, frame.right, frame.top),
        unit,
    )


def scale_for(width: float, height: float, field: tuple[float, float]) -> tuple[int, int]:
    """Largest standard scale at which width and height [mm] fit into a field [mm]. Raises KindynaError where none does."""
    for on_paper, real in SCALES:
        if width * on_paper <= field[0] * real and height * on_paper <= field[1] * real:
            return on_paper, real
    least = f"{SCALES[-1][0]}:{SCALES[-1][1]}"
    raise KindynaError(
        f"a cam of {result_text(max(width, height))} mm does not fit on the sheet at {least}, the smallest scale; choose larger paper"
    )


# -- author, company and logo -----------------------------------------------------------------------------------


SVG = "image/svg+xml"


@frozen(eq=False)
class Logo:
    """An image file: its media type and its bytes."""

    kind: str
    data: bytes


@frozen
class Letterhead:
    """Author and company as text; the logo as the path of a file."""

    author: str = text_option("author", default="", metavar="TEXT")
    company: str = text_option("company", default="", metavar="TEXT")
    logo: str = text_option("logo of the company: PNG, JPEG or SVG", default="", metavar="FILE")


def read_logo(letterhead: Letterhead) -> tuple[Logo | None, str]:
    """The logo, or None and the reason in one line; the document is written without it."""
    if not letterhead.logo.strip():
        return None, ""
    try:
        data = read_bytes(letterhead.logo)
    except FileError as error:
        return None, f"{error}; the logo is omitted"
    kind = _svg_type(data) if data.lstrip()[:1] == b"<" else _image_type(data)
    if not kind:
        allowed = f"PNG or JPEG of at most {PIXELS / 1e6:g} megapixels, or SVG"
        return None, f"{letterhead.logo}: cannot be read as an image; allowed: {allowed}; the logo is omitted"
    return Logo(kind, data), ""


def _svg_type(data: bytes) -> str:
    """Media type of an SVG image; empty for another, a broken or a too deeply nested file."""
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


def _image_type(data: bytes) -> str:
    """Media type of a PNG or JPEG image; empty for another, a broken or a too large file."""
    from PIL import Image  # loading it takes longer than a small report

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(io.BytesIO(data), formats=("PNG", "JPEG")) as image:
                if image.width * image.height > PIXELS:
                    return ""
                image.load()
                return str(image.get_format_mimetype())
    except Exception:  # a broken file makes the decoders raise anything
        return ""


# -- request ----------------------------------------------------------------------------------------------------


@frozen
class DrawingRequest(Letterhead):
    """A drawing of one flank of the cam.

    Attributes
    ----------
    flank : name of one of the cam's flanks
    paper : row of ``PAPERS``
    author, company, logo, date : entries of the title block
    """

    paper: str = choice("Paper", tuple(PAPERS), default="A4", help="size of the sheet, landscape")
    flank: str = flank_choice()
    date: str = text_option("date in the title block; empty: none", default="", metavar="TEXT")


# -- items of a sheet -------------------------------------------------------------------------------------------


OUTLINE, THIN, CENTRE, DASHED, FRAME = "outline", "thin", "centre", "dashed", "frame"


@frozen
class LineKind:
    """Width [mm]; lengths of dashes and gaps in turn [mm]."""

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
"""Lines of ISO 128: visible edges, dimensions, axes, circles that are not edges, frames."""


@frozen
class SheetLine:
    """A line through all points; ``kind`` is a row of ``LINE_KINDS``."""

    points: tuple[complex, ...]
    kind: str = THIN


@frozen
class SheetCircle:
    """A circle, or its arc from ``start_deg`` over ``span_deg`` counter-clockwise."""

    centre: complex
    radius: float
    kind: str = THIN
    start_deg: float = 0.0
    span_deg: float = 360.0


@frozen(eq=False)
class BezierLoop:
    """A closed chain of cubics.

    Attributes
    ----------
    points : (n, 4) complex Bézier points [mm]
    """

    points: np.ndarray
    kind: str = OUTLINE


@frozen
class ArrowHead:
    """A filled arrowhead: its tip, unit vector and length."""

    tip: complex
    direction: complex
    length: float


@frozen
class SheetText:
    """One line of text.

    Attributes
    ----------
    at : point on its baseline [mm]
    height : height of its capitals [mm]
    room : largest width [mm]; a longer text is condensed
    align : 0, 0.5, 1: the text begins, is centred, ends at this point
    """

    at: complex
    text: str
    height: float
    room: float
    align: float = 0.0


@frozen(eq=False)
class SheetLogo:
    """An image, as large as fits between the lower left and the upper right corner."""

    low: complex
    high: complex
    logo: Logo


Item: TypeAlias = "SheetLine | SheetCircle | BezierLoop | ArrowHead | SheetText | SheetLogo"


@frozen(eq=False)
class DrawingSheet:
    """A drawing on a sheet of paper.

    Attributes
    ----------
    width, height : size [mm]
    title, about : name and description
    items : contents
    missing : what is omitted and why, in one line
    """

    width: float
    height: float
    title: str
    about: str
    items: tuple[Item, ...]
    missing: str = ""
