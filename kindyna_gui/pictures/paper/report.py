"""The report as a PDF or HTML file.

The PDF is laid out as strips of known height, which fill the pages: a heading stays with the text after it, a picture
with its caption, and a table repeats its header on each page. Lengths are in mm.
"""

from __future__ import annotations

import hashlib
import math
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType

from PySide6.QtCore import QByteArray, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPen
from PySide6.QtSvg import QSvgRenderer

from core import __version__
from core.errors import FileError
from core.frozen import frozen
from core.output.report.document import ENDINGS, PAPERS, Document, html
from core.output.report.parts import Block, ReportEquations, ReportPicture, ReportTable, Section, Sentences
from core.process import user_folder
from core.project.files import read_own, write_all
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.paper.pictures import WIDTH as PIXELS
from kindyna_gui.pictures.paper.pictures import Vector, svg, vector
from kindyna_gui.pictures.paper.sheets import UNITS_PER_MM, paint_logo, vector_pdf
from kindyna_gui.pictures.style import LIGHT, SERIF, font

# -- equations -----------------------------------------------------------------------------------------

SIZE = 24.0  # font size of the typesetter


@frozen(eq=False)
class Typeset:
    """Typeset equation, with width and height as multiples of its font size."""

    width: float
    height: float
    renderer: QSvgRenderer

    def paint(self, painter: QPainter, box: QRectF) -> None:
        """Paint the equation to fill a box."""
        self.renderer.render(painter, box)


@cache
def typeset(mathml: str) -> Typeset:
    """Typeset a MathML element; its outlines are saved in the user's cache, because the typesetter is slow."""
    key = hashlib.sha256(f"{__version__} {SIZE} {mathml}".encode()).hexdigest()
    path = user_folder("cache") / "equations" / f"{key}.svg"
    saved = _saved_equation(path)
    if saved is None:
        width, height, outlines = saved = _typeset(mathml)
        text = f"{width!r} {height!r}\n{outlines}"
        with suppress(FileError):  # without a cache the equation is typeset again next time
            write_all(path.parent, {path.name: f"{hashlib.sha256(text.encode()).hexdigest()}\n{text}"})
    width, height, outlines = saved
    return Typeset(width / SIZE, height / SIZE, QSvgRenderer(QByteArray(outlines.encode())))


def _saved_equation(path: Path) -> tuple[float, float, str] | None:
    """Width, height and outlines of a saved equation; None where the file is missing or damaged."""
    with suppress(OSError, ValueError):
        digest, text = read_own(path).decode().split("\n", 1)
        if hashlib.sha256(text.encode()).hexdigest() == digest:
            size, outlines = text.split("\n", 1)
            width, height = map(float, size.split())
            return width, height, outlines
    return None


def _typeset(mathml: str) -> tuple[float, float, str]:
    """Width, height and outlines (SVG) of a MathML element."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # ziamath looks up its fonts with a deprecated function
        import ziamath  # slow to load, so only when an equation is not in the cache

    ziamath.config.svg2 = False  # Qt does not draw symbols that are defined elsewhere in the file
    equation = ziamath.Math(mathml, size=SIZE)
    width, height = equation.getsize()
    return float(width), float(height), str(equation.svg())


# -- page and fonts ------------------------------------------------------------------------------------

LEFT, TOP, BOTTOM = 22.0, 20.0, 20.0  # margins
WIDTH = 170.0  # between the margins, on any paper
POINT = 25.4 / 72.0
BODY, SMALL, TITLE, CHAPTER, HEADING = (size * POINT for size in (8.8, 7.8, 20.0, 13.0, 10.0))  # font sizes, mm
LEADING = 1.42  # height of a line by its font size
ROW_PAD, GAP, CELL = 0.42, 2.8, 3.4  # above and below the text of a row, between blocks, between columns
DOTS = {"\u0307": "˙", "\u0308": "¨"}  # dots of derivatives, which fonts omit or misplace
CLEAR = 0.09  # distance of the dots from their symbol, by the font size
WITH_ACCENT = re.compile("(.[\u0300-\u036f\u20d0-\u20ff])")
# index of a single letter; field paths have none
INDEX = re.compile(r"(?<![\w.])(\w[\u0300-\u036f′]*)_(\w{1,3})(?![\w.\[])")
INDEX_SIZE, INDEX_DROP = 0.72, 0.2  # size of an index and its depth below the line, by the size of the symbol
RULE, THIN, HAIR = 0.3, 0.15, 0.1  # line widths
LEAST = 0.6  # least height of a picture that shrinks to fit the current page, by its full height
SHORT = 75.0  # greatest height of a table that is not divided between pages
LOGO = 50.0, 18.0  # size of the logo on the first page
NUMBER = 20.0  # width of a page number
INDENT, EQUATION_SIZE = 5.0, 3.5  # indent of an equation, and its font size
INK, QUIET, FAINT, WRONG = LIGHT.ink, "#5b646d", "#d9dde0", LIGHT.limit
ALERTS = ("NOT KEPT", "BROKEN")


@frozen(eq=False)
class Strip:
    """Part of the report that is not divided between pages.

    Attributes
    ----------
    height : height [mm]
    paint : paints the strip at a distance from the top of the page [mm]
    above : space above the strip, except at the top of a page [mm]
    joined : whether the next strip is on the same page
    header : strip that is repeated where the table continues on a new page
    min_space : space that must be left on the page, else the strip starts a new page [mm]
    shrink : height by which ``shrunk`` can reduce the strip [mm]
    shrunk : returns the strip with its height reduced [mm]
    """

    height: float
    paint: Callable[[Pen, float], None]
    above: float = 0.0
    joined: bool = False
    header: Strip | None = None
    min_space: float = 0.0
    shrink: float = 0.0
    shrunk: Callable[[float], Strip] | None = None


class Pen:
    """Paints texts, lines and pictures in mm from the left and upper edge of the paper."""

    def __init__(self, painter: QPainter) -> None:
        self.painter = painter

    def text(
        self,
        x: float,
        baseline: float,
        text: str,
        size: float,
        colour: str = INK,
        bold: bool = False,
        align: float = 0.0,
    ) -> None:
        """Write a line that begins at x for ``align`` 0 and ends at x for ``align`` 1."""
        self.painter.setPen(QColor(colour))
        self._text(UNITS_PER_MM * (x - align * width(text, size, bold)), UNITS_PER_MM * baseline, text, size, bold)

    def formula(self, x: float, top: float, equation: Typeset, size: float) -> None:
        """Draw an equation with a font size."""
        box = QRectF(
            UNITS_PER_MM * x,
            UNITS_PER_MM * top,
            UNITS_PER_MM * size * equation.width,
            UNITS_PER_MM * size * equation.height,
        )
        equation.paint(self.painter, box)

    def _text(self, x: float, baseline: float, text: str, size: float, bold: bool = False) -> None:
        """Write a line in units of the painter, with the dots of derivatives centred over their symbols."""
        for part, accent, serifs, is_index in _parts(text):
            part_size = INDEX_SIZE * size if is_index else size
            metrics = _metrics(part_size, bold, serifs)
            self.painter.setFont(_face(part_size, bold, serifs))
            self.painter.drawText(QPointF(x, baseline + (INDEX_DROP * UNITS_PER_MM * size if is_index else 0.0)), part)
            advance = metrics.horizontalAdvance(part)
            if accent:
                middle = x + 0.5 * (advance - metrics.horizontalAdvance(accent))
                dot = metrics.tightBoundingRect(DOTS["\u0307"])  # the box of the round dot reaches down to the baseline
                raised = dot.top() + dot.width() - metrics.tightBoundingRect(part).top() + CLEAR * UNITS_PER_MM * size
                self.painter.drawText(QPointF(middle, baseline - raised), accent)
            x += advance

    def line(self, y: float, begin: float, end: float, thick: float = THIN, colour: str = INK) -> None:
        self.painter.setPen(QPen(QColor(colour), UNITS_PER_MM * thick, Qt.PenStyle.SolidLine, Qt.PenCapStyle.FlatCap))
        self.painter.drawLine(
            QPointF(UNITS_PER_MM * begin, UNITS_PER_MM * y), QPointF(UNITS_PER_MM * end, UNITS_PER_MM * y)
        )

    def vector(self, drawn: Vector, box: QRectF) -> None:
        """Draw a picture into a box [mm]."""
        self.painter.save()
        self.painter.translate(UNITS_PER_MM * box.x(), UNITS_PER_MM * box.y())
        self.painter.scale(UNITS_PER_MM * box.width() / drawn.width, UNITS_PER_MM * box.height() / drawn.height)
        drawn.paint(self.painter)
        self.painter.restore()


@cache
def _face(size: float, bold: bool = False, serif: bool = False) -> QFont:
    """Font of a size [mm]; serifs are for accented letters, because some sans-serif fonts misplace their accents."""
    face = font(round(UNITS_PER_MM * size), bold)
    if serif:
        face.setFamilies([*SERIF, *face.families()])
    for feature in ("liga", "ccmp"):  # a search in the PDF does not find ligatures and composed accents
        face.setFeature(QFont.Tag(feature), 0)
    return face


@cache
def _metrics(size: float, bold: bool, serif: bool = False) -> QFontMetricsF:
    return QFontMetricsF(_face(size, bold, serif))


def _parts(text: str) -> list[tuple[str, str, bool, bool]]:
    """Parts of a line in one font: text, accent to be drawn over it, whether with serifs, whether an index."""
    parts: list[tuple[str, str, bool, bool]] = []
    for number, piece in enumerate(INDEX.sub("\\1\0\\2\0", text).split("\0")):
        for part in WITH_ACCENT.split(piece):
            if len(part) == 2 and part[1] in DOTS:
                parts.append((part[0], DOTS[part[1]], False, False))
            elif part:
                parts.append((part, "", WITH_ACCENT.fullmatch(part) is not None, number % 2 == 1))
    return parts


def width(text: str, size: float, bold: bool = False) -> float:
    """Width of a line of text [mm]."""
    return (
        sum(
            _metrics(INDEX_SIZE * size if is_index else size, bold, serifs).horizontalAdvance(part)
            for part, _, serifs, is_index in _parts(text)
        )
        / UNITS_PER_MM
    )


def wrapped(text: str, size: float, room: float, bold: bool = False) -> list[str]:
    """Lines of a text that fit into a width [mm]; a longer word is divided."""
    lines, line = [], ""
    for word in text.split():
        longer = f"{line} {word}" if line else word
        if width(longer, size, bold) <= room:
            line = longer
            continue
        lines += [line] if line else []
        while width(word, size, bold) > room and len(word) > 1:
            length = next(n for n in range(len(word) - 1, 0, -1) if n == 1 or width(word[:n], size, bold) <= room)
            lines.append(word[:length])
            word = word[length:]
        line = word
    return [*lines, line] if line or not lines else lines


# -- blocks --------------------------------------------------------------------------------------------


def _lines(
    texts: Sequence[str],
    size: float,
    x: float = LEFT,
    colour: str = INK,
    bold: bool = False,
    above: float = 0.0,
    joined: bool = False,
) -> list[Strip]:
    """Strips of wrapped lines; with ``joined`` the last is joined to the next strip."""
    room, height = LEFT + WIDTH - x, LEADING * size
    strips: list[Strip] = []
    lines = [line for text in texts for line in wrapped(text, size, room, bold)]
    for number, line in enumerate(lines):

        def paint(pen: Pen, top: float, line: str = line) -> None:
            pen.text(x, top + 0.75 * height, line, size, colour, bold)

        only_two = number in (0, len(lines) - 2) and len(lines) > 1  # no single line of a paragraph is alone on a page
        strips.append(Strip(height, paint, 0.0 if number else above, joined or only_two))
    return strips


def _sentences(block: Sentences) -> list[Strip]:
    strips: list[Strip] = []
    for text in block.lines:
        size, colour = (SMALL, QUIET) if block.is_remark else (BODY, INK)
        strips += _lines([text], size, colour=colour, above=1.2 if strips else GAP)
    return strips


def _picture(block: ReportPicture, drawn: Vector) -> list[Strip]:
    full_height = WIDTH * drawn.height / drawn.width

    def strip(drawn: Vector, shrink: float) -> Strip:
        height = WIDTH * drawn.height / drawn.width

        def paint(pen: Pen, top: float) -> None:
            pen.vector(drawn, QRectF(LEFT, top, WIDTH, height))

        return Strip(height, paint, GAP, joined=True, shrink=shrink, shrunk=shrunk)

    def shrunk(less: float) -> Strip:
        return strip(vector(block, SCALE, 1.0 - less / full_height), 0.0)

    caption = _lines([block.caption], SMALL, colour=QUIET, above=1.0)
    return [strip(drawn, full_height - math.ceil(LEAST * full_height)), *_on_one_page(caption)]


def _on_one_page(strips: Sequence[Strip]) -> list[Strip]:
    """Join strips, so that they are on one page."""
    return [*(_joined(strip) for strip in strips[:-1]), *strips[-1:]]


def _joined(strip: Strip) -> Strip:
    return replace(strip, joined=True)


def _equations(block: ReportEquations) -> list[Strip]:
    strips: list[Strip] = []
    height = LEADING * BODY
    for row in block.rows:
        source = width(row.source, SMALL) + CELL
        names = wrapped(row.name, BODY, WIDTH - source, bold=True)

        def title(pen: Pen, top: float, name: str = names[0], source: str = row.source) -> None:
            pen.line(top - 1.2, LEFT, LEFT + WIDTH, HAIR, FAINT)
            pen.text(LEFT, top + 0.75 * height, name, BODY, bold=True)
            pen.text(LEFT + WIDTH, top + 0.75 * height, source, SMALL, QUIET, align=1.0)

        equation_strips = [Strip(height, title, GAP)]
        equation_strips += _lines(names[1:], BODY, bold=True)
        for equation in map(typeset, row.mathml):
            size = min(EQUATION_SIZE, (WIDTH - INDENT) / equation.width)

            def formula(pen: Pen, top: float, equation: Typeset = equation, size: float = size) -> None:
                pen.formula(LEFT + INDENT, top, equation, size)

            equation_strips.append(Strip(size * equation.height, formula, above=0.8))
        equation_strips += _lines([row.where], SMALL, colour=QUIET, above=0.8) if row.where else []
        strips += _on_one_page(equation_strips)
    return strips


# -- tables --------------------------------------------------------------------------------------------


def _table(block: ReportTable) -> list[Strip]:
    """Rows of a table, with the header repeated on each page and long texts wrapped."""
    cells = [[str(cell) for cell in row] for row in block.rows]
    flush = [i < block.left or i in block.text_columns for i in range(len(cells[0]))]
    widths = _widths([block.header, *cells] if block.header else cells, flush)
    strips: list[Strip] = []
    if block.title:
        strips += _lines([block.title], SMALL, colour=QUIET, above=GAP, joined=True)
    header = _row(block.header, widths, flush, QUIET, THIN) if block.header else None
    above = 0.6 if block.title else GAP
    if header is not None:
        strips.append(Strip(header.height, header.paint, above, joined=True))
    for number, row in enumerate(cells):
        last = number == len(cells) - 1
        strip = _row(row, widths, flush, INK, THIN if last else HAIR, FAINT if not last else "#b9bfc4")
        near_an_end = number in (0, len(cells) - 2) and not last
        space = above if number == 0 and header is None else 0.0
        strips.append(Strip(strip.height, strip.paint, space, near_an_end, header))
    return _on_one_page(strips) if sum(strip.height for strip in strips) < SHORT else strips


def _widths(rows: Sequence[Sequence[str]], flush: Sequence[bool]) -> list[float]:
    """Widths of the columns with the space between them; the widest columns of words shrink on a narrow page."""
    widths = [max(width(row[i], SMALL) for row in rows) + CELL + 0.01 for i in range(len(rows[0]))]
    widths[-1] -= CELL
    words = [
        max((width(word, SMALL) for row in rows for word in row[i].split()), default=0.0) + CELL
        for i in range(len(rows[0]))
    ]
    while sum(widths) > WIDTH:
        wide = [i for i in range(len(widths)) if widths[i] > words[i] + 1e-9]
        if not wide:
            return [column * WIDTH / sum(widths) for column in widths]
        most = max(wide, key=lambda i: widths[i])
        widths[most] = max(words[most], widths[most] - max(0.2, 0.25 * (sum(widths) - WIDTH)))
    return widths


def _row(
    cells: Sequence[str], widths: Sequence[float], flush: Sequence[bool], colour: str, rule: float, shade: str = INK
) -> Strip:
    """Row of a table with the line below it."""
    step = LEADING * SMALL
    rooms = [column - CELL for column in widths[:-1]] + [widths[-1]]
    columns = [wrapped(cell, SMALL, room) if cell else [] for cell, room in zip(cells, rooms, strict=True)]
    height = max(1, *(len(lines) for lines in columns)) * step + 2.0 * ROW_PAD
    edges = [LEFT, *(LEFT + sum(widths[: i + 1]) for i in range(len(widths)))]

    def paint(pen: Pen, top: float) -> None:
        for column, (lines, (begin, end), left) in enumerate(zip(columns, pairwise(edges), flush, strict=True)):
            right = end if column == len(columns) - 1 else end - CELL
            for number, line in enumerate(lines):
                baseline = top + ROW_PAD + (number + 0.75) * step
                ink, bold = (WRONG, True) if line in ALERTS else (colour, False)
                if left:
                    pen.text(begin, baseline, line, SMALL, ink, bold)
                else:
                    pen.text(right, baseline, line, SMALL, ink, bold, align=1.0)
        pen.line(top + height, LEFT, edges[-1], rule, shade)

    return Strip(height, paint)


# -- pages ---------------------------------------------------------------------------------------------

SCALE = UNITS_PER_MM * WIDTH / PIXELS
"""Units of the page's painter in one pixel of a picture."""
Drawn = Mapping[ReportPicture, Vector]


def _title(document: Document) -> list[Strip]:
    """Title block of the report."""
    strips = _lines(["REPORT"], SMALL, colour=QUIET, joined=True)
    if (logo := document.logo) is not None:
        across, down = LOGO

        def picture(pen: Pen, top: float) -> None:
            box = (LEFT + WIDTH - across, top, across, down)
            paint_logo(pen.painter, logo, QRectF(*(UNITS_PER_MM * edge for edge in box)))

        strips.insert(0, Strip(down, picture, joined=True))
    strips += _lines([document.title], TITLE, bold=True, above=1.0, joined=True)
    height, label = LEADING * BODY + 0.6, 32.0

    def rule(pen: Pen, top: float) -> None:
        pen.line(top, LEFT, LEFT + WIDTH, RULE)

    strips.append(Strip(0.1, rule, 3.0, joined=True))
    for number, (name, text) in enumerate(document.rows):
        for count, line in enumerate(wrapped(text, BODY, WIDTH - label)):

            def paint(pen: Pen, top: float, name: str = "" if count else name, line: str = line) -> None:
                pen.text(LEFT, top + 0.72 * height, name, BODY, QUIET)
                pen.text(LEFT + label, top + 0.72 * height, line, BODY)

            strips.append(Strip(height, paint, 1.8 if number == count == 0 else 0.0, joined=True))
    return [*strips, Strip(0.1, rule, 1.8)]


def _heading(section: Section, number: int) -> list[Strip]:
    if not section.title:
        return []
    if section.level > 1:
        return _lines([section.title], HEADING, bold=True, above=4.4, joined=True)
    indent = width("00", CHAPTER) + 3.0
    strips = _lines([section.title], CHAPTER, LEFT + indent, bold=True, above=8.0, joined=True)
    first = strips[0]

    def paint(pen: Pen, top: float) -> None:
        first.paint(pen, top)
        pen.text(LEFT, top + 0.75 * LEADING * CHAPTER, str(number), CHAPTER, QUIET)

    def rule(pen: Pen, top: float) -> None:
        pen.line(top, LEFT, LEFT + WIDTH, THIN, "#b9bfc4")

    return [
        Strip(first.height, paint, first.above, True, min_space=45.0),
        *strips[1:],
        Strip(0.1, rule, 0.8, joined=True),
    ]


def _block(block: Block, drawn: Drawn) -> list[Strip]:
    if isinstance(block, Sentences):
        return _sentences(block)
    if isinstance(block, ReportTable):
        return _table(block.without_empty_columns)
    if isinstance(block, ReportPicture):
        return _picture(block, drawn[block]) if block in drawn else []
    return _equations(block)


def strips_of(document: Document, drawn: Drawn) -> Iterator[Strip]:
    """Strips of a document from top to bottom, without the pictures that are not in ``drawn``."""
    yield from _title(document)
    number = 0
    for section in document.sections:
        number += section.level == 1
        yield from _heading(section, number)
        for index, block in enumerate(section.blocks):
            strips = _block(block, drawn)
            before_table = any(
                isinstance(following, ReportTable) for following in section.blocks[index + 1 : index + 2]
            )
            # a first remark, or the sentence before a table, is on the page of the next block
            leads = index == 0 and isinstance(block, Sentences) and (block.is_remark or before_table)
            yield from map(_joined, strips) if leads else strips


def pages(strips: Sequence[Strip], room: float) -> list[list[tuple[Strip, float]]]:
    """Fill pages with strips.

    Joined strips are on one page, unless they are longer than a page. A picture shrinks where it then fits the page.

    Parameters
    ----------
    strips : sequence of Strip
    room : float [mm]
        Height of a page between its margins.

    Returns
    -------
    list of list of (Strip, float) [mm]
        Strips of each page with their distance from its top.
    """
    result: list[list[tuple[Strip, float]]] = [[]]
    at, first = 0.0, 0
    while first < len(strips):
        last = first
        while strips[last].joined and last + 1 < len(strips):
            last += 1
        group = strips[first : last + 1]
        height = sum(strip.height + strip.above for strip in group)
        left, shrink = room - at, sum(strip.shrink for strip in group)
        if result[-1] and left < height <= left + shrink:
            less = height - left
            group = [s if s.shrunk is None else s.shrunk(less * s.shrink / shrink) for s in group]
            height = left
        if result[-1] and (height > left or left < group[0].min_space):
            result.append([])
            at = 0.0
        for strip in group:
            if result[-1] and at + strip.above + strip.height > room + 1e-6:  # a group that is longer than a page
                result.append([])
                at = 0.0
            if not result[-1] and strip.header is not None:
                result[-1].append((strip.header, 0.0))
                at = strip.header.height
            elif result[-1]:
                at += strip.above
            result[-1].append((strip, at))
            at += strip.height
        first = last + 1
    return result


def pdf(document: Document, drawn: Drawn) -> bytes:
    """Write a document as PDF, with its pictures drawn for ``SCALE``."""
    across, down = PAPERS[document.paper]
    page_strips = pages(list(strips_of(document, drawn)), down - TOP - BOTTOM)
    first, *more = wrapped(document.title, SMALL, WIDTH - NUMBER)
    name = f"{first} ..." if more else first

    def page(number: int) -> Callable[[QPainter], None]:
        def paint(painter: QPainter) -> None:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            pen = Pen(painter)
            for strip, at in page_strips[number]:
                strip.paint(pen, TOP + at)
            footer = down - 0.55 * BOTTOM
            pen.line(footer - 4.0, LEFT, LEFT + WIDTH, HAIR, FAINT)
            pen.text(LEFT, footer, name, SMALL, QUIET)
            pen.text(LEFT + WIDTH, footer, f"{number + 1} / {len(page_strips)}", SMALL, QUIET, align=1.0)

        return paint

    return vector_pdf(document.title, "Report", across, down, *(page(number) for number in range(len(page_strips))))


# -- file ----------------------------------------------------------------------------------------------

GoOn = Callable[[int], bool]
"""Receives the number of finished pictures; returns whether to continue."""


@frozen(eq=False)
class ReportFileType:
    """One file type: scale of its pictures, function that writes the file, and whether equations are typeset for it."""

    scale: float
    write: Callable[[Document, Mapping[ReportPicture, Vector]], bytes]
    has_typeset_equations: bool


def html_bytes(document: Document, drawn: Mapping[ReportPicture, Vector]) -> bytes:
    """Write a document as HTML with its pictures."""
    return html(document, {picture: svg(image, picture.caption) for picture, image in drawn.items()}).encode()


KINDS: Mapping[str, ReportFileType] = MappingProxyType(
    {".html": ReportFileType(1.0, html_bytes, False), ".pdf": ReportFileType(SCALE, pdf, True)}
)
assert tuple(KINDS) == ENDINGS


def report_file(document: Document, ending: str, go_on: GoOn = lambda done: True) -> bytes | None:
    """Write a report as a file of a type of ``KINDS``; None where ``go_on`` stopped it.

    Raises NoSolution where a picture has none.
    """
    ensure_app(offscreen=True)
    file_type, drawn = KINDS[ending], {}
    for number, picture in enumerate(document.pictures):
        if not go_on(number):
            return None
        drawn[picture] = vector(picture, file_type.scale)
    if file_type.has_typeset_equations:  # one by one, because the first report typesets for seconds
        for equation in document.equations:
            if not go_on(len(drawn)):
                return None
            typeset(equation)
    return file_type.write(document, drawn) if go_on(len(drawn)) else None
