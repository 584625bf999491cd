"""Drawing of a cam: the view with its dimensions, tables of points and dimensions, and a title block."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Sequence
from itertools import combinations
from math import asin, degrees, radians

import numpy as np

from core.cam import form_row, keyway_unknown
from core.frozen import frozen
from core.materials import MATERIALS
from core.numerics.derivatives import cross
from core.output.files.fitted_curve import contact_face
from core.output.files.profile_files import LAYERS, SENSES
from core.output.files.profile_files import LineShape as Edge
from core.output.files.sheet import (
    CENTRE,
    DASHED,
    EQUAL,
    FRAME,
    OUTLINE,
    THIN,
    ArrowHead,
    BezierLoop,
    Box,
    CamDimensions,
    DrawingRequest,
    DrawingSheet,
    Item,
    Logo,
    PaperLayout,
    ProfilePoint,
    SheetCircle,
    SheetLine,
    SheetLogo,
    SheetText,
    cam_dimensions,
    extent,
    layout,
    read_logo,
    scale_for,
)
from core.output.lines import printable
from core.study import Study

# -- dimensions of the view -------------------------------------------------------------------------------------


WIDE = 0.84  # mean width of a character, relative to the height of capitals
ROUNDS = 3  # in which every text may change its tip
CROSSING, COVERING, NEARNESS = 1e3, 1e4, 40.0  # costs: lines across lines, texts over lines, leaders close together
TIP = 0.02  # part of a leader at its tip that may cross the outline
ABOVE, BELOW = (2.1, 0.5), (-1.5, -3.1)  # baselines of two lines above and below a shoulder, in heights of capitals
CLOSE = 3.0  # mm between a leader and the tip of another

Segment = tuple[complex, complex]


@frozen
class Callout:
    """A dimension with a leader.

    Attributes
    ----------
    lines : both lines of text, beyond the leader's shoulder, so that no leader crosses them
    tips : possible points of the arrow on the sheet [mm]
    centre : start of the line of a radius [mm]; None where the arrow comes from outside
    """

    lines: tuple[str, ...]
    tips: tuple[complex, ...]
    centre: complex | None = None

    def width(self, height: float) -> float:
        """Width of the texts [mm] for a height of the capitals [mm]."""
        return WIDE * height * max(len(line) for line in self.lines) + height


@frozen
class _PlacedCallout:
    """A callout at one of its tips; its leader begins at ``end`` of its shoulder."""

    callout: Callout
    tip: complex
    shoulder: Segment
    end: complex

    @property
    def segments(self) -> list[Segment]:
        inner = [] if self.callout.centre is None else [(self.callout.centre, self.tip)]
        return [(self.end, self.tip), *inner]


@frozen
class CalloutField:
    """Field in which callouts are placed, above or below the view.

    Attributes
    ----------
    field : rectangle with the callouts along its upper and lower edge
    middle : y that separates the tips of the upper from those of the lower callouts [mm]
    height : height of the capitals [mm]
    obstacles : lines that no leader may cross
    edge : (n,) complex points of the closed outline of the part [mm], which leaders cross only where necessary
    """

    field: Box
    middle: float
    height: float
    obstacles: Sequence[Segment]
    edge: np.ndarray

    @property
    def rows(self) -> Box:
        """Rectangle whose upper and lower edge are the shoulders."""
        texts = 4.0 * self.height
        return Box(self.field.left, self.field.bottom + texts, self.field.right, self.field.top - texts)

    def crossings(self, end: complex, tip: complex) -> int:
        """Number of crossings of a leader with the outline, its tip excluded."""
        a, along = end, (1.0 - TIP) * (tip - end)
        c, d = self.edge, np.roll(self.edge, -1)
        is_separated = (cross(along, c - a) > 0.0) != (cross(along, d - a) > 0.0)
        return int(
            np.count_nonzero(is_separated & ((cross(d - c, a - c) > 0.0) != (cross(d - c, a + along - c) > 0.0)))
        )


def callouts(requested: Sequence[Callout], around: CalloutField) -> list[Item]:
    """Leaders and texts of all callouts.

    For each callout in turn the tip is chosen with which leaders cross least, until no choice changes.
    """
    chosen = [0] * len(requested)

    def cost(choice: Sequence[int]) -> float:
        return _cost(_placed_callouts(requested, choice, around), around)

    order = sorted(range(len(requested)), key=lambda i: len(requested[i].tips))
    for _ in range(ROUNDS):
        before = list(chosen)
        for i in order:
            chosen[i] = min(range(len(requested[i].tips)), key=lambda tip: cost([*chosen[:i], tip, *chosen[i + 1 :]]))
        if chosen == before:
            break
    return [item for placed in _placed_callouts(requested, chosen, around) for item in _items(placed, around.height)]


def _placed_callouts(requested: Sequence[Callout], choice: Sequence[int], around: CalloutField) -> list[_PlacedCallout]:
    """Texts in rows above and below the view, in the order of their tips, as near to them as possible."""
    placed, rows, height = [], around.rows, around.height
    for y, is_above in ((rows.top, True), (rows.bottom, False)):
        row = []
        for callout, i in zip(requested, choice, strict=True):
            tip = callout.tips[i]
            if (tip.imag >= around.middle) == is_above:
                end, width = _best_end(tip, callout.centre, rows, y), callout.width(height)
                begin = end - width if tip.real < rows.middle.real else end
                row.append((end, begin, width, tip, callout))
        row.sort(key=lambda entry: entry[:2])
        starts = _without_overlap([entry[1] for entry in row], [entry[2] for entry in row], rows, 2.0 * height)
        for (_, _, width, tip, callout), start in zip(row, starts, strict=True):
            shoulder = complex(start, y), complex(start + width, y)
            detours = [(around.crossings(end, tip), abs(end - tip)) for end in shoulder]
            placed.append(_PlacedCallout(callout, tip, shoulder, shoulder[detours.index(min(detours))]))
    return placed


def _best_end(tip: complex, centre: complex | None, rows: Box, y: float) -> float:
    """Best x for the start of a leader: where the radius meets the row, else a little outside of the tip."""
    if centre is not None and abs(tip.imag - centre.imag) > 1e-6:
        along = (tip - centre) / (tip.imag - centre.imag)
        return min(max((centre + along * (y - centre.imag)).real, rows.left), rows.right)
    return tip.real + 0.4 * (tip.real - rows.middle.real)


def _without_overlap(requested: Sequence[float], widths: Sequence[float], rows: Box, gap: float) -> list[float]:
    """Left ends of texts, shifted from the requested ones until they neither overlap nor leave the row."""
    starts: list[float] = []
    edge = rows.left
    for begin, width in zip(requested, widths, strict=True):
        starts.append(max(edge, begin))
        edge = starts[-1] + width + gap
    edge = rows.right
    for i in range(len(starts) - 1, -1, -1):
        starts[i] = min(starts[i], edge - widths[i])
        edge = starts[i] - gap
    return starts


def _cost(placed: Sequence[_PlacedCallout], around: CalloutField) -> float:
    total = 0.0
    for callout in placed:
        total += sum(abs(b - a) for a, b in callout.segments)
        total += CROSSING * sum(_crosses(segment, line) for segment in callout.segments for line in around.obstacles)
        total += CROSSING * around.crossings(callout.end, callout.tip)
        total += COVERING * max(0.0, around.field.left - callout.shoulder[0].real)
    for first, second in combinations(placed, 2):
        total += CROSSING * sum(_crosses(a, b) for a in first.segments for b in second.segments)
        total += NEARNESS * (_is_near(first, second.tip) + _is_near(second, first.tip))
        total += COVERING * sum(_crosses(a, second.shoulder) for a in first.segments)
        total += COVERING * sum(_crosses(b, first.shoulder) for b in second.segments)
    return total


def _is_near(placed: _PlacedCallout, tip: complex) -> bool:
    return any(_distance(segment, tip) < CLOSE for segment in placed.segments)


def _distance(segment: Segment, point: complex) -> float:
    a, b = segment
    along, offset = b - a, point - a
    part = (offset * along.conjugate()).real / max(abs(along) ** 2, 1e-12)
    return abs(offset - min(max(part, 0.0), 1.0) * along)


def _crosses(first: Segment, second: Segment) -> bool:
    """Whether two segments cross inside; segments with a common end do not."""
    (a, b), (c, d) = first, second
    if {a, b} & {c, d}:
        return False
    return _orientation(a, b, c) * _orientation(a, b, d) < 0.0 and _orientation(c, d, a) * _orientation(c, d, b) < 0.0


def _orientation(a: complex, b: complex, c: complex) -> float:
    """Positive where c is to the left of the line from a to b."""
    return ((b - a).conjugate() * (c - a)).imag


def _items(placed: _PlacedCallout, height: float) -> list[Item]:
    (left, right), end, tip, centre = placed.shoulder, placed.end, placed.tip, placed.callout.centre
    items: list[Item] = [SheetLine((right if end == left else left, end, tip), THIN)]
    origin = end if centre is None else centre
    if centre is not None:
        items.append(SheetLine((centre, tip), THIN))
    items.append(ArrowHead(tip, (tip - origin) / abs(tip - origin), 1.2 * height))
    room = (right - left).real - 0.5 * height
    middle = 0.5 * (left + right)
    heights = ABOVE if tip.imag < end.imag else BELOW
    items.extend(
        SheetText(middle + 1j * y * height, line, height, room, 0.5)
        for line, y in zip(placed.callout.lines, heights, strict=True)
    )
    return items


# -- the tables of a drawing ------------------------------------------------------------------------------------


SMALL, LARGE = 1.7, 2.3  # mm on A4: heights of texts in tables and of other texts
ROW, GAP, PAD = 3.75, 3.0, 1.0  # mm on A4: height of a row, between tables, left and right of a text
TITLE_ROW, LABEL = 7.6, 1.3  # mm on A4: rows of the title block, height of the names of its fields
BASE = 0.29  # baseline above the lower edge of a row, relative to its height
DECIMALS = 3
LOGO = ""  # name of the field of the logo

HALVES = (0.19, 0.405, 0.405)  # widths of the columns of a half of the table of points
DIMENSIONS = (0.45, 0.19, 0.15, 0.21)


def number(value: float, decimals: int = DECIMALS) -> str:
    """A length or an angle without trailing zeros and without minus zero."""
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def fixed_decimals(value: float) -> str:
    """A length or an angle with all decimals, for a column."""
    return f"{value:.{DECIMALS}f}"


def _grid(box: Box, widths: Sequence[float], rows: int) -> Iterator[Item]:
    """A frame, thin lines between rows and columns; widths are parts of the box."""
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


def points_table(values: CamDimensions, layout: PaperLayout) -> tuple[float, list[Item]]:
    """Lower end of the table of points, and its items: cam angle, radius, polar angle every 10 degrees, in two halves."""
    unit, column = layout.unit, layout.column
    header = ("cam °", "radius mm", "polar °")
    rows = [
        (number(angle), fixed_decimals(radius), fixed_decimals(round(polar, DECIMALS) % 360.0))
        for angle, radius, polar in values.table
    ]
    half = len(rows) // 2
    bottom = column.top - (half + 1) * ROW * unit
    middle = 0.5 * (column.left + column.right)
    boxes = Box(column.left, bottom, middle, column.top), Box(middle, bottom, column.right, column.top)
    items: list[Item] = []
    for box, part in zip(boxes, (rows[:half], rows[half:]), strict=True):
        items += _table(box, HALVES, [header, *part], unit)
    return bottom, items


def _extreme_cells(label: str, extreme: ProfilePoint | None) -> tuple[str, ...]:
    return (
        (label, "none", "", "")
        if extreme is None
        else (label, number(extreme.value), number(extreme.cam_angle_deg), "")
    )


def dimension_rows(values: CamDimensions) -> list[tuple[str, ...]]:
    """Rows of name, millimetres or degrees, cam angle, and an empty field for the tolerance."""
    labels = (
        ("base_radius_mm", "Base radius"), ("bore_mm", "Bore ⌀"), ("hub_mm", "Hub ⌀"), ("keyway_width_mm", "Keyway width"),
        ("keyway_depth_mm", "Keyway depth, from the bore"), ("keyway_angle_deg", "Keyway angle, °"), ("thickness_mm", "Thickness"),
    )  # fmt: skip
    present = (*values.cam, *keyway_unknown(values.job.study.design.drive.cam))
    blank = [
        (label, number(values.cam[name]) if name in values.cam else "not given", "", "")
        for name, label in labels
        if name in present
    ]
    return [
        ("Dimension", "mm", "at cam °", "Tolerance"),
        _extreme_cells("Smallest radius", values.smallest),
        _extreme_cells("Largest radius", values.largest),
        _extreme_cells("Least convex radius of curvature", values.convex),
        _extreme_cells("Least concave radius of curvature", values.concave),
        *blank,
    ]


def dimensions_table(values: CamDimensions, layout: PaperLayout, top: float) -> tuple[float, list[Item]]:
    """Lower end of the table of dimensions below ``top``, and its items."""
    rows, unit = dimension_rows(values), layout.unit
    box = Box(layout.column.left, top - len(rows) * ROW * unit, layout.column.right, top)
    return box.bottom, list(_table(box, DIMENSIONS, rows, unit, left=1))


def mechanism_text(study: Study) -> str:
    """The mechanism of the drive in a few words."""
    return study.design.drive.label


def face_text(values: CamDimensions) -> str:
    """The face that touches the flank, with its radius without play."""
    job = values.job
    face, cam = contact_face(job.study, job.request), job.study.design.drive.cam
    first = job.request.flank == form_row(cam.form).flanks[0]
    radius = face.radius_mm - (0.0 if first else cam.form.play_mm)
    return f"{face.noun.capitalize()}{f', radius {number(radius)} mm' if radius else ''}"


def _material(study: Study) -> str:
    slug = study.design.drive.cam.material
    return "" if slug is None else MATERIALS[slug].name


def title_rows(values: CamDimensions, scale: str, request: DrawingRequest) -> list[list[tuple[str, str, float]]]:
    """Rows of fields of the title block: name, entry, part of the width."""
    study = values.job.study
    thickness = f"{number(values.cam['thickness_mm'])} mm" if "thickness_mm" in values.cam else ""
    flank = f"Cam profile, {values.job.request.flank} flank"
    date, author, company = map(printable, (request.date, request.author, request.company))
    company_row = [[("Company", company, 0.64), (LOGO, "", 0.36)]] if company.strip() or request.logo else []
    return [
        *company_row,
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
    values: CamDimensions, layout: PaperLayout, scale: str, request: DrawingRequest, logo: Logo | None = None
) -> list[Item]:
    """Title block in the lower right corner."""
    unit, column = layout.unit, layout.column
    rows = title_rows(values, scale, request)
    height = TITLE_ROW * unit
    items: list[Item] = []
    y = column.bottom
    for row in [[("Title", printable(values.job.study.design.name), 1.0)], *reversed(rows)]:
        x, row_height = column.left, height * (1.25 if len(row) == 1 else 1.0)
        for label, text, width in row:
            box = Box(x, y, x + width * column.width, y + row_height)
            items += _field(box, label, text, unit, LARGE if len(row) > 1 else 1.5 * LARGE)
            if label == LOGO and logo is not None:
                edge = 0.6 * PAD * unit * (1.0 + 1.0j)
                items.append(SheetLogo(box.corners[0] + edge, box.corners[2] - edge, logo))
            x = box.right
        y += row_height
    items.append(SheetLine(Box(column.left, column.bottom, column.right, y).corners, FRAME))
    return items


def _field(box: Box, label: str, text: str, unit: float, height: float) -> Iterator[Item]:
    pad = PAD * unit
    yield SheetLine(box.corners, THIN)
    if label:
        top = complex(box.left + pad, box.top - pad - LABEL * unit)
        yield SheetText(top, label, LABEL * unit, box.width - 2.0 * pad)
    if text:
        yield SheetText(complex(box.left + pad, box.bottom + 1.3 * pad), text, height * unit, box.width - 2.0 * pad)


# -- the view of the cam along its shaft ------------------------------------------------------------------------


SIDE, BAND = 13.0, 23.0  # mm on A4: margins left and right of the cam, and above and below it for texts
TEXTS_OFF = 25.0  # mm on A4: largest distance of texts above and below the cam
MARGIN = 3.0  # mm on A4: along the edge of the field
BEYOND = 4.0  # mm on A4: length of centre lines beyond the cam
TURN_FROM, TURN_BY = 155.0, 50.0  # degrees: start and length of the arrow of rotation
TURN_OFF = 6.5  # mm on A4: its distance from the cam
STEP, OFF_AXES = 15.0, 9.0  # degrees between possible tips on a circle, and from the centre lines
MOST_TIPS = 12
EDGES = 60  # of the outline that leaders should not cross


@frozen
class ViewPlacement:
    """Position of the cam on the sheet: its centre [mm], and the scale, paper : cam."""

    centre: complex
    scale: float

    def __call__(self, z: complex) -> complex:
        """Point on the sheet [mm] of a point of the cam [mm]."""
        return self.centre + self.scale * z


def draw_view(values: CamDimensions, layout: PaperLayout) -> tuple[tuple[int, int], list[Item]]:
    """The scale, paper : cam, and the items of the view. Raises KindynaError for a cam too large for any scale."""
    unit, field = layout.unit, layout.view
    low, high = extent(values.chains)
    size = high - low
    scale = scale_for(size.real, size.imag, (field.width - 2.0 * SIDE * unit, field.height - 2.0 * BAND * unit))
    factor = scale[0] / scale[1]
    placement = ViewPlacement(field.middle - 0.5 * factor * (low + high), factor)
    corner, opposite = placement(low), placement(high)
    bounds = Box(corner.real, corner.imag, opposite.real, opposite.imag)
    items: list[Item] = [BezierLoop(placement.centre + factor * chain.points) for chain in values.chains]
    items += _circles(values, placement)
    items += [SheetLine((placement(edge.start), placement(edge.end)), OUTLINE) for edge in _keyway(values)]
    items += _axes(bounds, placement, BEYOND * unit)
    zero, label = _zero(values, bounds, placement, unit)
    arrow, chord = _rotation(values, placement, unit)
    margin, off = MARGIN * unit, TEXTS_OFF * unit
    callout_field = Box(
        field.left + margin,
        max(field.bottom + margin, bounds.bottom - off),
        field.right - margin,
        min(field.top - margin, bounds.top + off),
    )
    outline = max((chain.vertices for chain in values.chains), key=lambda z: float(np.abs(z).max()))
    edge = placement.centre + factor * outline[:: max(1, outline.size // EDGES)]
    labels = callouts(
        _callouts(values, placement),
        CalloutField(callout_field, placement.centre.imag, LARGE * unit, [label, *chord], edge),
    )
    return scale, [*items, *zero, *arrow, *labels]


def _circles(values: CamDimensions, placement: ViewPlacement) -> Iterator[Item]:
    given = values.cam
    if "base_radius_mm" in given:
        yield SheetCircle(placement.centre, given["base_radius_mm"] * placement.scale, DASHED)
    if "hub_mm" in given:
        yield SheetCircle(placement.centre, 0.5 * given["hub_mm"] * placement.scale, OUTLINE)
    if "bore_mm" in given:
        start, span = 0.0, 360.0
        if _keyway(values):  # the opening of the keyway is no edge
            half = degrees(asin(given["keyway_width_mm"] / given["bore_mm"]))
            start, span = given["keyway_angle_deg"] + half, 360.0 - 2.0 * half
        yield SheetCircle(placement.centre, 0.5 * given["bore_mm"] * placement.scale, OUTLINE, start, span)


def _keyway(values: CamDimensions) -> list[Edge]:
    """Its sides and the bottom; empty where its dimensions are not given."""
    return [shape for shape in LAYERS["KEYWAY"].shapes(values.job) if isinstance(shape, Edge)]


def _axes(bounds: Box, placement: ViewPlacement, beyond: float) -> Iterator[Item]:
    centre = placement.centre
    yield SheetLine((complex(bounds.left - beyond, centre.imag), complex(bounds.right + beyond, centre.imag)), CENTRE)
    yield SheetLine((complex(centre.real, bounds.bottom - beyond), complex(centre.real, bounds.top + beyond)), CENTRE)


def _zero(values: CamDimensions, bounds: Box, placement: ViewPlacement, unit: float) -> tuple[list[Item], Segment]:
    """The angle-zero mark with its text, and the line that this text covers."""
    marks = [shape for shape in LAYERS["ZERO"].shapes(values.job) if isinstance(shape, Edge)]
    height = LARGE * unit
    at = complex(bounds.right + (BEYOND + 1.0) * unit, placement.centre.imag - 0.5 * height)
    room = (SIDE - BEYOND - 2.0) * unit
    lines: list[Item] = [SheetLine((placement(mark.start), placement(mark.end)), OUTLINE) for mark in marks]
    return [*lines, SheetText(at, "0°", height, room)], (at, at + room)


def _rotation(values: CamDimensions, placement: ViewPlacement, unit: float) -> tuple[list[Item], list[Segment]]:
    """An arc next to the cam with an arrow in the sense of rotation, and its chord."""
    z = np.concatenate([chain.vertices for chain in values.chains])
    bearing = np.mod(np.degrees(np.angle(z)), 360.0)
    is_in_arc = np.abs(bearing - TURN_FROM - 0.5 * TURN_BY) <= 0.5 * TURN_BY
    radius = placement.scale * float(np.abs(z[is_in_arc]).max(initial=float(values.smallest.value))) + TURN_OFF * unit
    first, last = (cmath.rect(1.0, radians(angle)) for angle in (TURN_FROM, TURN_FROM + TURN_BY))
    rotation_sign = values.job.study.sense
    end = last if rotation_sign > 0.0 else first
    length = 1.6 * LARGE * unit
    back = end * cmath.exp(-0.5j * rotation_sign * length / radius)  # direction of the chord of the arrowhead
    arrow = ArrowHead(placement.centre + radius * end, 1j * rotation_sign * back, length)
    arc = SheetCircle(placement.centre, radius, THIN, TURN_FROM, TURN_BY)
    return [arc, arrow], [(placement.centre + radius * first, placement.centre + radius * last)]


# -- dimensions ------------------------------------------------------------------------------------------------


def _callouts(values: CamDimensions, placement: ViewPlacement) -> list[Callout]:
    given, centre = values.cam, placement.centre
    base = given.get("base_radius_mm")
    least = values.smallest
    on_base = base is not None and abs(least.value - base) <= EQUAL * base

    def radial(extreme: ProfilePoint, text: str) -> Callout:
        return Callout((f"R {number(extreme.value)}", text), _tips(extreme.points, placement), centre)

    result = [
        radial(values.largest, f"largest, at {_angle(values.largest)}"),
        radial(least, "smallest = base circle" if on_base else f"smallest, at {_angle(least)}"),
    ]
    for extreme, text in ((values.convex, "convex"), (values.concave, "concave")):
        if extreme is not None:
            result.append(
                Callout(
                    (f"least {text} R {number(extreme.value)}", f"at {_angle(extreme)}"),
                    _tips(extreme.points, placement),
                )
            )
    circles = [] if base is None or on_base else [(base, f"R {number(base)}", "base circle")]
    circles.extend(
        (0.5 * given[name], f"⌀ {number(given[name])}", text)
        for name, text in (("bore_mm", "bore"), ("hub_mm", "hub"))
        if name in given
    )
    for radius, size, text in circles:
        points = _circle_points(radius, values if text == "bore" else None)
        result.append(Callout((size, text), _tips(points, placement)))
    sides = _keyway(values)
    if sides:
        width, depth, angle = (
            number(given[name]) for name in ("keyway_width_mm", "keyway_depth_mm", "keyway_angle_deg")
        )
        middles = [placement(0.5 * (side.start + side.end)) for side in (sides[0], sides[-1])]
        result.append(Callout((f"keyway {width} × {depth}", f"at {angle}°"), tuple(middles)))
    return result


def _angle(extreme: ProfilePoint) -> str:
    return f"cam {number(extreme.cam_angle_deg, 1)}°"


def _circle_points(radius: float, dimensions: CamDimensions | None) -> np.ndarray:
    """Points of a circle about the cam centre, except at the keyway."""
    angles = np.arange(0.5 * STEP, 360.0, STEP)
    if dimensions is not None and _keyway(dimensions):
        given = dimensions.cam
        half = degrees(asin(given["keyway_width_mm"] / given["bore_mm"])) + 0.5 * STEP
        angles = angles[np.abs(np.mod(angles - given["keyway_angle_deg"] + 180.0, 360.0) - 180.0) > half]
    return radius * np.exp(1j * np.radians(angles))


def _tips(z: np.ndarray, placement: ViewPlacement) -> tuple[complex, ...]:
    """Some of these points of the cam on the sheet, away from the centre lines where possible."""
    bearing = np.mod(np.degrees(np.angle(z)) + 45.0, 90.0) - 45.0
    free = z[np.abs(bearing) >= OFF_AXES]
    chosen = free if free.size else z
    chosen = chosen[np.unique(np.linspace(0, chosen.size - 1, min(chosen.size, MOST_TIPS)).round().astype(int))]
    return tuple(placement(complex(point)) for point in chosen)


# -- the drawing of a cam ---------------------------------------------------------------------------------------


DEFAULT_REQUEST = DrawingRequest()

ENDINGS = (".pdf", ".svg")
"""Endings of files for drawings."""


def drawing(study: Study, request: DrawingRequest = DEFAULT_REQUEST) -> DrawingSheet:
    """The sheet of one flank of the study's cam.

    Raises NoSuchStage, NoCam, KindynaError as `exact_curve`, and KindynaError for an unknown paper.
    """
    fields = layout(request.paper)
    values = cam_dimensions(study, request.flank)
    (on_paper, real), view_items = draw_view(values, fields)
    scale = f"{on_paper}:{real}"
    items: list[Item] = [
        SheetLine(fields.frame.corners, FRAME),
        SheetLine((fields.view.corners[1], fields.view.corners[2]), FRAME),
        *view_items,
    ]
    bottom, table = points_table(values, fields)
    end, dimensions = dimensions_table(values, fields, bottom - GAP * fields.unit)
    logo, missing = read_logo(request)
    title = title_block(values, fields, scale, request, logo)
    items += [*table, *dimensions, *title, *_notes(values, fields, end)]
    name = printable(study.design.name)
    about = f"Cam {name}, {request.flank} flank, scale {scale}, millimetres; the cam turns {SENSES[study.sense][1]}"
    return DrawingSheet(fields.width, fields.height, name, about, tuple(items), missing)


def _notes(values: CamDimensions, fields: PaperLayout, top: float) -> list[Item]:
    """Explanation of the tables, below them."""
    unit, column = fields.unit, fields.column
    lines = (
        "Table of points: distance of the profile from the cam centre at the cam angle, and",
        "its polar angle, counter-clockwise from the zero mark. Drawn at cam angle 0;",
        f"the cam turns {SENSES[values.job.study.sense][1]}.",
    )
    width = column.width - 2.0 * PAD * unit
    first = complex(column.left + PAD * unit, top - 2.2 * SMALL * unit)
    return [SheetText(first - 1j * i * 1.8 * SMALL * unit, line, SMALL * unit, width) for i, line in enumerate(lines)]
