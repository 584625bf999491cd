"""Dimensions of the view: a text beside the view with a leader to what it names, placed so that nothing lies over another."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import combinations
from math import asin, degrees, radians

import numpy as np

from core.cam import form_row, keyway_unknown
from core.frozen import frozen
from core.materials import MATERIALS
from core.numerics.derivatives import cross
from core.output.files.made import touching
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
    DrawingRequest,
    DrawingSheet,
    Figures,
    Item,
    Logo,
    PaperLayout,
    ProfilePoint,
    SheetCircle,
    SheetLine,
    SheetLogo,
    SheetText,
    extent,
    figures,
    layout,
    logo_of,
    scale_for,
)
from core.output.lines import printable
from core.study import Study

# -- dimensions of the view -------------------------------------------------------------------------------------


WIDE = 0.84  # mean width of a letter, of the height of its capitals
ROUNDS = 3  # in which every text looks for a better place
CROSSING, COVERING, NEARNESS = (
    1e3,
    1e4,
    40.0,
)  # what is worst: texts over lines; then lines over lines; then leaders that lie close
TIP = 0.02  # of a leader: where it may touch the outline
ABOVE, BELOW = (2.1, 0.5), (-1.5, -3.1)  # baselines of two lines beyond a shoulder, in heights of capitals
CLOSE = 3.0  # mm between a leader and another's tip

Segment = tuple[complex, complex]


@frozen
class Callout:
    """
    lines   of text, both beyond the leader's shoulder, so that no leader runs through them
    tips    where its arrow may point: places on the sheet [mm]
    centre  of a radius, which is drawn from there to the tip; None where the arrow comes from outside
    """

    lines: tuple[str, ...]
    tips: tuple[complex, ...]
    centre: complex | None = None

    def width(self, height: float) -> float:
        """Room of its texts [mm]."""
        return WIDE * height * max(len(line) for line in self.lines) + height


@frozen
class _Placed:
    """A callout at one of its tips; its leader comes from ``end`` of its shoulder."""

    callout: Callout
    tip: complex
    shoulder: Segment
    end: complex

    @property
    def segments(self) -> list[Segment]:
        inner = [] if self.callout.centre is None else [(self.callout.centre, self.tip)]
        return [(self.end, self.tip), *inner]


@frozen
class Surroundings:
    """Where callouts are placed: along the top and the foot of ``field``, on the side of ``middle`` (y) where their tips are;
    height of their letters [mm]; ``kept``: lines that no leader shall cross; ``edge`` (n,): the closed outline of the part, which
    none shall cross without need."""

    field: Box
    middle: float
    height: float
    kept: Sequence[Segment]
    edge: np.ndarray

    @property
    def rows(self) -> Box:
        """Its top and foot are where shoulders lie."""
        texts = 4.0 * self.height
        return Box(self.field.left, self.field.bottom + texts, self.field.right, self.field.top - texts)

    def entered(self, end: complex, tip: complex) -> int:
        """How often a leader crosses the outline, its tip aside."""
        a, along = end, (1.0 - TIP) * (tip - end)
        c, d = self.edge, np.roll(self.edge, -1)
        apart = (cross(along, c - a) > 0.0) != (cross(along, d - a) > 0.0)
        return int(np.count_nonzero(apart & ((cross(d - c, a - c) > 0.0) != (cross(d - c, a + along - c) > 0.0))))


def callouts(wanted: Sequence[Callout], around: Surroundings) -> list[Item]:
    """All of them drawn.

    Each tries its tips in turn and keeps the one with which leaders cross least, others' choices standing, until none changes.
    """
    chosen = [0] * len(wanted)

    def cost(choice: Sequence[int]) -> float:
        return _cost(_placed_callouts(wanted, choice, around), around)

    order = sorted(range(len(wanted)), key=lambda i: len(wanted[i].tips))
    for _ in range(ROUNDS):
        before = list(chosen)
        for i in order:
            chosen[i] = min(range(len(wanted[i].tips)), key=lambda tip: cost([*chosen[:i], tip, *chosen[i + 1 :]]))
        if chosen == before:
            break
    return [item for each in _placed_callouts(wanted, chosen, around) for item in _drawn(each, around.height)]


def _placed_callouts(wanted: Sequence[Callout], choice: Sequence[int], around: Surroundings) -> list[_Placed]:
    """Texts in their rows above and below, in the order of their tips from left to right, as near to them as there is room."""
    made, rows, height = [], around.rows, around.height
    for y, above in ((rows.top, True), (rows.bottom, False)):
        here = []
        for each, tip in zip(wanted, [each.tips[i] for each, i in zip(wanted, choice, strict=True)], strict=True):
            if (tip.imag >= around.middle) == above:
                end, width = _best_end(tip, each.centre, rows, y), each.width(height)
                begin = end - width if tip.real < rows.middle.real else end
                here.append((end, begin, width, tip, each))
        here.sort(key=lambda row: row[:2])
        starts = _in_a_row([begin for _, begin, *_ in here], [width for _, _, width, *_ in here], rows, 2.0 * height)
        for (_, _, width, tip, each), start in zip(here, starts, strict=True):
            shoulder = complex(start, y), complex(start + width, y)
            made.append(_Placed(each, tip, shoulder, min(shoulder, key=partial(_detour, tip, around))))
    return made


def _detour(tip: complex, around: Surroundings, end: complex) -> tuple[int, float]:
    """How often a leader from that end crosses the outline, and how long it is."""
    return around.entered(end, tip), abs(end - tip)


def _best_end(tip: complex, centre: complex | None, rows: Box, y: float) -> float:
    """Where a leader would best reach its text: where the radius meets the row, else a little outside of the tip."""
    if centre is not None and abs(tip.imag - centre.imag) > 1e-6:
        along = (tip - centre) / (tip.imag - centre.imag)
        return min(max((centre + along * (y - centre.imag)).real, rows.left), rows.right)
    return tip.real + 0.4 * (tip.real - rows.middle.real)


def _in_a_row(wanted: Sequence[float], widths: Sequence[float], rows: Box, gap: float) -> list[float]:
    """Left ends of texts that shall begin there, moved apart and into the row."""
    starts: list[float] = []
    edge = rows.left
    for begin, width in zip(wanted, widths, strict=True):
        starts.append(max(edge, begin))
        edge = starts[-1] + width + gap
    edge = rows.right
    for i in range(len(starts) - 1, -1, -1):
        starts[i] = min(starts[i], edge - widths[i])
        edge = starts[i] - gap
    return starts


def _cost(placed: Sequence[_Placed], around: Surroundings) -> float:
    total = 0.0
    for each in placed:
        total += sum(abs(b - a) for a, b in each.segments)
        total += CROSSING * sum(_crosses(segment, other) for segment in each.segments for other in around.kept)
        total += CROSSING * around.entered(each.end, each.tip)
        total += COVERING * max(0.0, around.field.left - each.shoulder[0].real)
    for one, other in combinations(placed, 2):
        total += CROSSING * sum(_crosses(a, b) for a in one.segments for b in other.segments)
        total += NEARNESS * (_beside(one, other.tip) + _beside(other, one.tip))
        total += COVERING * sum(_crosses(a, other.shoulder) for a in one.segments)
        total += COVERING * sum(_crosses(b, one.shoulder) for b in other.segments)
    return total


def _beside(one: _Placed, tip: complex) -> bool:
    return any(_distance(segment, tip) < CLOSE for segment in one.segments)


def _distance(segment: Segment, point: complex) -> float:
    a, b = segment
    along, away = b - a, point - a
    part = (away * along.conjugate()).real / max(abs(along) ** 2, 1e-12)
    return abs(away - min(max(part, 0.0), 1.0) * along)


def _crosses(one: Segment, other: Segment) -> bool:
    """Whether two segments cross inside; those that begin at the same place do not."""
    (a, b), (c, d) = one, other
    if {a, b} & {c, d}:
        return False
    return _side(a, b, c) * _side(a, b, d) < 0.0 and _side(c, d, a) * _side(c, d, b) < 0.0


def _side(a: complex, b: complex, c: complex) -> float:
    """Positive where c is to the left of the way from a to b."""
    return ((b - a).conjugate() * (c - a)).imag


def _drawn(each: _Placed, height: float) -> list[Item]:
    (left, right), end, tip, centre = each.shoulder, each.end, each.tip, each.callout.centre
    items: list[Item] = [SheetLine((right if end == left else left, end, tip), THIN)]
    origin = end if centre is None else centre
    if centre is not None:
        items.append(SheetLine((centre, tip), THIN))
    items.append(ArrowHead(tip, (tip - origin) / abs(tip - origin), 1.2 * height))
    room = (right - left).real - 0.5 * height
    middle = 0.5 * (left + right)
    heights = ABOVE if tip.imag < end.imag else BELOW
    for line, y in zip(each.callout.lines, heights, strict=True):
        items.append(SheetText(middle + 1j * y * height, line, height, room, 0.5))
    return items


# -- the tables of a drawing ------------------------------------------------------------------------------------


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


def _placed_cells(label: str, place: ProfilePoint | None) -> tuple[str, ...]:
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
        _placed_cells("Smallest radius", values.smallest),
        _placed_cells("Largest radius", values.largest),
        _placed_cells("Least convex radius of curvature", values.convex),
        _placed_cells("Least concave radius of curvature", values.concave),
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


def title_rows(values: Figures, scale: str, request: DrawingRequest) -> list[list[tuple[str, str, float]]]:
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
    values: Figures, layout: PaperLayout, scale: str, request: DrawingRequest, logo: Logo | None = None
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


# -- the view of the cam along its shaft ------------------------------------------------------------------------


SIDE, BAND = 13.0, 23.0  # mm on A4: free beside the cam, and above and below it for texts
TEXTS_OFF = 25.0  # mm on A4: how far above and below the cam texts are at most
MARGIN = 3.0  # mm on A4: free along the edge of the field
BEYOND = 4.0  # mm on A4: how far centre lines run beyond what they halve
TURN_FROM, TURN_BY = 155.0, 50.0  # degrees: where the arrow of the rotation is
TURN_OFF = 6.5  # mm on A4: how far it is from the cam
STEP, OFF_AXES = 15.0, 9.0  # degrees between places at which a circle may be named, and from the centre lines
MOST_TIPS = 12
EDGES = 60  # of the outline that leaders shall not cross


@frozen
class ViewPlacement:
    """Where the cam is on the sheet: its centre [mm], millimetres of paper per millimetre."""

    centre: complex
    scale: float

    def __call__(self, z: complex) -> complex:
        return self.centre + self.scale * z


def view(values: Figures, layout: PaperLayout) -> tuple[tuple[int, int], list[Item]]:
    """The scale, paper : cam, and everything in the field of the view. Raises KindynaError for a cam too large for any scale."""
    unit, field = layout.unit, layout.view
    low, high = extent(values.chains)
    size = high - low
    scale = scale_for(size.real, size.imag, (field.width - 2.0 * SIDE * unit, field.height - 2.0 * BAND * unit))
    factor = scale[0] / scale[1]
    placing = ViewPlacement(field.middle - 0.5 * factor * (low + high), factor)
    corner, other = placing(low), placing(high)
    bounds = Box(corner.real, corner.imag, other.real, other.imag)
    items: list[Item] = [BezierLoop(placing.centre + factor * chain.points) for chain in values.chains]
    items += _circles(values, placing)
    items += _edges(values, placing)
    items += _axes(bounds, placing, BEYOND * unit)
    zero, label = _zero(values, bounds, placing, unit)
    turning, chord = _rotation(values, placing, unit)
    margin, off = MARGIN * unit, TEXTS_OFF * unit
    room = Box(
        field.left + margin,
        max(field.bottom + margin, bounds.bottom - off),
        field.right - margin,
        min(field.top - margin, bounds.top + off),
    )
    outline = max((chain.vertices for chain in values.chains), key=lambda z: float(np.abs(z).max()))
    edge = placing.centre + factor * outline[:: max(1, outline.size // EDGES)]
    named = callouts(
        _callouts(values, placing), Surroundings(room, placing.centre.imag, LETTERS * unit, [label, *chord], edge)
    )
    return scale, [*items, *zero, *turning, *named]


def _circles(values: Figures, placing: ViewPlacement) -> Iterator[Item]:
    known = values.cam
    if "base_radius_mm" in known:
        yield SheetCircle(placing.centre, known["base_radius_mm"] * placing.scale, DASHED)
    if "hub_mm" in known:
        yield SheetCircle(placing.centre, 0.5 * known["hub_mm"] * placing.scale, OUTLINE)
    if "bore_mm" in known:
        start, span = 0.0, 360.0
        if _keyway(values):  # where it opens the bore is no edge
            half = degrees(asin(known["keyway_width_mm"] / known["bore_mm"]))
            start, span = known["keyway_angle_deg"] + half, 360.0 - 2.0 * half
        yield SheetCircle(placing.centre, 0.5 * known["bore_mm"] * placing.scale, OUTLINE, start, span)


def _keyway(values: Figures) -> list[Edge]:
    """Its two sides and the bottom, none where it is not known."""
    return [shape for shape in LAYERS["KEYWAY"].shapes(values.job) if isinstance(shape, Edge)]


def _edges(values: Figures, placing: ViewPlacement) -> Iterator[Item]:
    for edge in _keyway(values):
        yield SheetLine((placing(edge.start), placing(edge.end)), OUTLINE)


def _axes(bounds: Box, placing: ViewPlacement, beyond: float) -> Iterator[Item]:
    centre = placing.centre
    yield SheetLine((complex(bounds.left - beyond, centre.imag), complex(bounds.right + beyond, centre.imag)), CENTRE)
    yield SheetLine((complex(centre.real, bounds.bottom - beyond), complex(centre.real, bounds.top + beyond)), CENTRE)


def _zero(values: Figures, bounds: Box, placing: ViewPlacement, unit: float) -> tuple[list[Item], Segment]:
    """The angle-zero mark with its text, and where that stands."""
    marks = [shape for shape in LAYERS["ZERO"].shapes(values.job) if isinstance(shape, Edge)]
    height = LETTERS * unit
    at = complex(bounds.right + (BEYOND + 1.0) * unit, placing.centre.imag - 0.5 * height)
    room = (SIDE - BEYOND - 2.0) * unit
    lines: list[Item] = [SheetLine((placing(mark.start), placing(mark.end)), OUTLINE) for mark in marks]
    return [*lines, SheetText(at, "0°", height, room)], (at, at + room)


def _rotation(values: Figures, placing: ViewPlacement, unit: float) -> tuple[list[Item], list[Segment]]:
    """An arc beside the cam with an arrow in the sense in which it turns, and its chord."""
    z = np.concatenate([chain.vertices for chain in values.chains])
    bearing = np.mod(np.degrees(np.angle(z)), 360.0)
    beside = np.abs(bearing - TURN_FROM - 0.5 * TURN_BY) <= 0.5 * TURN_BY
    radius = placing.scale * float(np.abs(z[beside]).max(initial=float(values.smallest.value))) + TURN_OFF * unit
    first, last = (cmath.rect(1.0, radians(angle)) for angle in (TURN_FROM, TURN_FROM + TURN_BY))
    sense = values.job.study.sense
    end = last if sense > 0.0 else first
    length = 1.6 * LETTERS * unit
    back = end * cmath.exp(-0.5j * sense * length / radius)  # along the chord of its own length
    arrow = ArrowHead(placing.centre + radius * end, 1j * sense * back, length)
    arc = SheetCircle(placing.centre, radius, THIN, TURN_FROM, TURN_BY)
    return [arc, arrow], [(placing.centre + radius * first, placing.centre + radius * last)]


# -- dimensions ------------------------------------------------------------------------------------------------


def _callouts(values: Figures, placing: ViewPlacement) -> list[Callout]:
    known, centre = values.cam, placing.centre
    base = known.get("base_radius_mm")
    least = values.smallest
    on_base = base is not None and abs(least.value - base) <= EQUAL * base

    def radial(place: ProfilePoint, text: str) -> Callout:
        return Callout((f"R {number(place.value)}", text), _tips(place.all, placing), centre)

    found = [
        radial(values.largest, f"largest, at {_angle(values.largest)}"),
        radial(least, "smallest = base circle" if on_base else f"smallest, at {_angle(least)}"),
    ]
    for place, text in ((values.convex, "convex"), (values.concave, "concave")):
        if place is not None:
            found.append(
                Callout((f"least {text} R {number(place.value)}", f"at {_angle(place)}"), _tips(place.all, placing))
            )
    circles = [] if base is None or on_base else [(base, f"R {number(base)}", "base circle")]
    for name, text in (("bore_mm", "bore"), ("hub_mm", "hub")):
        if name in known:
            circles.append((0.5 * known[name], f"⌀ {number(known[name])}", text))
    for radius, size, text in circles:
        around = _around(radius, values if text == "bore" else None)
        found.append(Callout((size, text), _tips(around, placing)))
    sides = _keyway(values)
    if sides:
        width, depth, angle = (
            number(known[name]) for name in ("keyway_width_mm", "keyway_depth_mm", "keyway_angle_deg")
        )
        middles = [placing(0.5 * (side.start + side.end)) for side in (sides[0], sides[-1])]
        found.append(Callout((f"keyway {width} × {depth}", f"at {angle}°"), tuple(middles)))
    return found


def _angle(place: ProfilePoint) -> str:
    return f"cam {number(place.cam_angle_deg, 1)}°"


def _around(radius: float, without: Figures | None) -> np.ndarray:
    """Points of a circle about the cam centre, those of the keyway left out."""
    angles = np.arange(0.5 * STEP, 360.0, STEP)
    if without is not None and _keyway(without):
        known = without.cam
        half = degrees(asin(known["keyway_width_mm"] / known["bore_mm"])) + 0.5 * STEP
        angles = angles[np.abs(np.mod(angles - known["keyway_angle_deg"] + 180.0, 360.0) - 180.0) > half]
    return radius * np.exp(1j * np.radians(angles))


def _tips(z: np.ndarray, placing: ViewPlacement) -> tuple[complex, ...]:
    """Some of these points of the cam on the sheet, away from the centre lines where there is a choice."""
    bearing = np.mod(np.degrees(np.angle(z)) + 45.0, 90.0) - 45.0
    free = z[np.abs(bearing) >= OFF_AXES]
    chosen = free if free.size else z
    chosen = chosen[np.unique(np.linspace(0, chosen.size - 1, min(chosen.size, MOST_TIPS)).round().astype(int))]
    return tuple(placing(complex(each)) for each in chosen)


# -- the drawing of a cam ---------------------------------------------------------------------------------------


USUAL = DrawingRequest()

ENDINGS = (".pdf", ".svg")
"""Of the files that a drawing is painted to."""


def drawing(study: Study, request: DrawingRequest = USUAL) -> DrawingSheet:
    """The sheet of one flank of the study's cam.

    Raises as ``core.output.files.files.job_of`` does, and KindynaError for a paper that is not known.
    """
    room = layout(request.paper)
    values = figures(study, request.flank)
    (on_paper, real), seen = view(values, room)
    scale = f"{on_paper}:{real}"
    items: list[Item] = [
        SheetLine(room.frame.corners, FRAME),
        SheetLine((room.view.corners[1], room.view.corners[2]), FRAME),
        *seen,
    ]
    bottom, table = points_table(values, room)
    end, dimensions = dimensions_table(values, room, bottom - GAP * room.unit)
    logo, lacking = logo_of(request)
    title = title_block(values, room, scale, request, logo)
    items += [*table, *dimensions, *title, *_notes(values, room, end)]
    name = printable(study.design.name)
    about = f"Cam {name}, {request.flank} flank, scale {scale}, millimetres; the cam turns {SENSES[study.sense][1]}"
    return DrawingSheet(room.width, room.height, name, about, tuple(items), lacking)


def _notes(values: Figures, room: PaperLayout, top: float) -> list[Item]:
    """What the tables mean, below them."""
    unit, column = room.unit, room.column
    lines = (
        "Table of points: distance of the profile from the cam centre at the cam angle, and",
        "its polar angle, counter-clockwise from the zero mark. Drawn at cam angle 0;",
        f"the cam turns {SENSES[values.job.study.sense][1]}.",
    )
    width = column.width - 2.0 * PAD * unit
    first = complex(column.left + PAD * unit, top - 2.2 * SMALL * unit)
    return [SheetText(first - 1j * i * 1.8 * SMALL * unit, line, SMALL * unit, width) for i, line in enumerate(lines)]
