"""The tables of a drawing: points of the profile, dimensions with an empty column for their tolerances, title block."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from core.cam import form_row, keyway_unknown
from core.materials import MATERIALS
from core.output.drawing.figures import Figures, ProfilePoint
from core.output.drawing.paper import Box, PaperLayout
from core.output.drawing.request import Request
from core.output.drawing.sheet import FRAME, THIN, Item, SheetLine, SheetLogo, SheetText
from core.output.letterhead import Logo
from core.output.lines import printable
from core.output.profile.drawing import SENSES
from core.output.profile.made import touching
from core.study import Study

SMALL, LETTERS = 1.7, 2.3  # mm on A4: heights of texts in tables, and of what stands alone
ROW, GAP, PAD = 3.75, 3.0, 1.0  # mm on A4: height of a row, between tables, beside a text
TITLE_ROW, LABEL = 7.6, 1.3  # mm on A4: of the title block, height of the names of its fields
BASE = 0.29  # of a row: the baseline above its foot
DECIMALS = 3
LOGO = ""  # the name of a field in which it stands

HALVES = (0.19, 0.405, 0.405)  # widths of the columns of a half of the table of points
DIMENSIONS = (0.45, 0.19, 0.15, 0.21)


def number(value: float, decimals: int = DECIMALS) -> str:
    """A length or an angle, without zeros at its end and without minus zero."""
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def fixed(value: float) -> str:
    """With all decimals, as in a column."""
    return f"{value:.{DECIMALS}f}"


def _bearing(degrees: float) -> float:
    """What rounds to 360 is 0."""
    return float(round(degrees, DECIMALS) % 360.0)


def _grid(box: Box, widths: Sequence[float], rows: int) -> Iterator[Item]:
    """Frame, a thin line below each row and between columns; widths are parts of the box."""
    yield SheetLine(box.corners, FRAME)
    for i in range(1, rows):
        y = box.top - box.height * i / rows
        yield SheetLine((complex(box.left, y), complex(box.right, y)))
    x = box.left
    for width in widths[:-1]:
        x += width * box.width
        yield SheetLine((complex(x, box.bottom), complex(x, box.top)))


def _cells(
    box: Box, widths: Sequence[float], rows: Sequence[Sequence[str]], unit: float, left: int = 0
) -> Iterator[Item]:
    """Texts of a grid, the first ``left`` columns flush left, the others right."""
    height, pad = box.height / len(rows), PAD * unit
    for i, row in enumerate(rows):
        y, x = box.top - height * (i + 1 - BASE), box.left
        for j, (text, width) in enumerate(zip(row, widths, strict=True)):
            begin, end = x + pad, x + width * box.width - pad
            x += width * box.width
            if text:
                at = complex(begin, y) if j < left else complex(end, y)
                yield SheetText(at, text, SMALL * unit, end - begin, 0.0 if j < left else 1.0)


def _table(
    box: Box, widths: Sequence[float], rows: Sequence[Sequence[str]], unit: float, left: int = 0
) -> Iterator[Item]:
    yield from _grid(box, widths, len(rows))
    yield from _cells(box, widths, rows, unit, left)


def points_table(values: Figures, layout: PaperLayout) -> tuple[float, list[Item]]:
    """Cam angle, radius and polar angle at every 10 degrees, in two halves; and where it ends."""
    unit, column = layout.unit, layout.column
    head = ("cam °", "radius mm", "polar °")
    rows = [(number(angle), fixed(radius), fixed(_bearing(polar))) for angle, radius, polar in values.table]
    half = len(rows) // 2
    bottom = column.top - (half + 1) * ROW * unit
    middle = 0.5 * (column.left + column.right)
    boxes = Box(column.left, bottom, middle, column.top), Box(middle, bottom, column.right, column.top)
    items: list[Item] = []
    for box, part in zip(boxes, (rows[:half], rows[half:]), strict=True):
        items += _table(box, HALVES, [head, *part], unit)
    return bottom, items


def _placed(label: str, place: ProfilePoint | None) -> tuple[str, ...]:
    return (label, "none", "", "") if place is None else (label, number(place.value), number(place.cam_angle_deg), "")


def dimension_rows(values: Figures) -> list[tuple[str, ...]]:
    """Name, millimetres or degrees, cam angle, and an empty field for the tolerance."""
    known = (
        ("base_radius_mm", "Base radius"), ("bore_mm", "Bore ⌀"), ("hub_mm", "Hub ⌀"), ("keyway_width_mm", "Keyway width"),
        ("keyway_depth_mm", "Keyway depth, from the bore"), ("keyway_angle_deg", "Keyway angle, °"), ("thickness_mm", "Thickness"),
    )  # fmt: skip
    wanted = (*values.cam, *keyway_unknown(values.job.study.design.drive.cam))
    blank = [
        (label, number(values.cam[name]) if name in values.cam else "not given", "", "")
        for name, label in known
        if name in wanted
    ]
    return [
        ("Dimension", "mm", "at cam °", "Tolerance"),
        _placed("Smallest radius", values.smallest),
        _placed("Largest radius", values.largest),
        _placed("Least convex radius of curvature", values.convex),
        _placed("Least concave radius of curvature", values.concave),
        *blank,
    ]


def dimensions_table(values: Figures, layout: PaperLayout, top: float) -> tuple[float, list[Item]]:
    """The dimensions, below ``top``; and where the table ends."""
    rows, unit = dimension_rows(values), layout.unit
    box = Box(layout.column.left, top - len(rows) * ROW * unit, layout.column.right, top)
    return box.bottom, list(_table(box, DIMENSIONS, rows, unit, left=1))


def mechanism_text(study: Study) -> str:
    """What the cam moves, in a few words."""
    drive = study.design.drive
    return drive.label


def face_text(values: Figures) -> str:
    """What touches the flank, with its radius, of which a play is no part."""
    job = values.job
    face, cam = touching(job.study, job.request), job.study.design.drive.cam
    first = job.request.flank == form_row(cam.form).flanks[0]
    radius = face.radius_mm - (0.0 if first else cam.form.play_mm)
    return f"{face.noun.capitalize()}{f', radius {number(radius)} mm' if radius else ''}"


def _material(study: Study) -> str:
    slug = study.design.drive.cam.material
    return "" if slug is None else MATERIALS[slug].name


def title_rows(values: Figures, scale: str, request: Request) -> list[list[tuple[str, str, float]]]:
    """Rows of fields: name, what stands there, part of the width."""
    study = values.job.study
    thickness = f"{number(values.cam['thickness_mm'])} mm" if "thickness_mm" in values.cam else ""
    flank = f"Cam profile, {values.job.request.flank} flank"
    date, author, company = map(printable, (request.date, request.author, request.company))
    maker = [[("Company", company, 0.64), (LOGO, "", 0.36)]] if company.strip() or request.logo else []
    return [
        *maker,
        [("Follower", mechanism_text(study), 0.5), ("Face", face_text(values), 0.5)],
        [
            ("Material", _material(study), 0.36),
            ("Thickness", thickness, 0.24),
            ("Sense of rotation", SENSES[study.sense][1], 0.4),
        ],
        [("Drawn", author, 0.36), ("Checked", "", 0.36), ("Date", date, 0.28)],
        [("Scale", scale, 0.18), ("Sheet", request.paper, 0.14), ("Units", "mm, degrees", 0.3), ("Part", flank, 0.38)],
    ]


def title_block(
    values: Figures, layout: PaperLayout, scale: str, request: Request, logo: Logo | None = None
) -> list[Item]:
    """The title block in the lower right corner."""
    unit, column = layout.unit, layout.column
    rows = title_rows(values, scale, request)
    height = TITLE_ROW * unit
    items: list[Item] = []
    y = column.bottom
    for row in [[("Title", printable(values.job.study.design.name), 1.0)], *reversed(rows)]:
        x, tall = column.left, height * (1.25 if len(row) == 1 else 1.0)
        for label, text, width in row:
            box = Box(x, y, x + width * column.width, y + tall)
            items += _field(box, label, text, unit, LETTERS if len(row) > 1 else 1.5 * LETTERS)
            if label == LOGO and logo is not None:
                edge = 0.6 * PAD * unit * (1.0 + 1.0j)
                items.append(SheetLogo(box.corners[0] + edge, box.corners[2] - edge, logo))
            x = box.right
        y += tall
    items.append(SheetLine(Box(column.left, column.bottom, column.right, y).corners, FRAME))
    return items


def _field(box: Box, label: str, text: str, unit: float, letters: float) -> Iterator[Item]:
    pad = PAD * unit
    yield SheetLine(box.corners, THIN)
    if label:
        top = complex(box.left + pad, box.top - pad - LABEL * unit)
        yield SheetText(top, label, LABEL * unit, box.width - 2.0 * pad)
    if text:
        yield SheetText(complex(box.left + pad, box.bottom + 1.3 * pad), text, letters * unit, box.width - 2.0 * pad)


__all__ = ["dimensions_table", "number", "points_table", "title_block"]
