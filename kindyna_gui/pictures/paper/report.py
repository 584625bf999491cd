"""Report as PDF, HTML."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from types import MappingProxyType

from PySide6.QtCore import QByteArray, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPen
from PySide6.QtSvg import QSvgRenderer

from core.frozen import frozen
from core.output.report.document import ENDINGS, PAPERS, Document, html
from core.output.report.parts import Block, ReportEquations, ReportPicture, ReportTable, Section, Sentences
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.paper.pictures import WIDTH as PIXELS
from kindyna_gui.pictures.paper.pictures import Vector, svg, vector
from kindyna_gui.pictures.paper.sheets import UNITS_PER_MM, paint_logo, vector_pdf
from kindyna_gui.pictures.style import LIGHT, SERIF, font

# -- typeset ---------------------------------------------------------------------------------------------

SIZE = 24.0  # of the letters, in which widths and heights are counted


@frozen(eq=False)
class Typeset:
    """An equation: its width and height as parts of the size of its letters, and what paints it into a box."""

    width: float
    height: float
    renderer: QSvgRenderer

    def paint(self, painter: QPainter, box: QRectF) -> None:
        """It fills the box."""
        self.renderer.render(painter, box)


@cache
def typeset(mathml: str) -> Typeset:
    """The equation of a MathML element."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # it finds its fonts the old way
        import ziamath  # loading it takes as long as a small report

    ziamath.config.svg2 = False  # Qt draws no symbols that are defined elsewhere
    made = ziamath.Math(mathml, size=SIZE)
    width, height = made.getsize()
    return Typeset(width / SIZE, height / SIZE, QSvgRenderer(QByteArray(made.svg().encode())))


# -- pdf -------------------------------------------------------------------------------------------------

# Blocks are laid out as lines of known height, from which pages are filled: a heading stays with what follows it, a picture with its
# caption, a table goes on over the page with its head repeated.

LEFT, TOP, FOOT = 22.0, 20.0, 20.0  # margins
WIDTH = 170.0  # of what is inside, on any paper
POINT = 25.4 / 72.0
BODY, SMALL, TITLE, CHAPTER, HEADING = (size * POINT for size in (8.8, 7.8, 20.0, 13.0, 10.0))  # letters, mm
LEADING = 1.42  # of a line, of the size of its letters
ROW_PAD, GAP, CELL = 0.42, 2.8, 3.4  # beside a row's text, between blocks, between columns
OVER = {"\u0307": "˙", "\u0308": "¨"}  # dots, which fonts lose, or put into tall letters and beside others
CLEAR = 0.09  # of the size of the letters: what such dots stand above theirs
WITH_ACCENT = re.compile("(.[\u0300-\u036f\u20d0-\u20ff])")
INDEX = re.compile(
    r"(?<![\w.])(\w[\u0300-\u036f′]*)_(\w{1,3})(?![\w.\[])"
)  # of a single letter: no path of a field has one
LOW, DOWN = 0.72, 0.2  # size of an index, and how far it stands below the line, of the size of its letter
RULE, THIN, HAIR = 0.3, 0.15, 0.1  # widths of lines
LEAST = 0.6  # of its height, that a picture keeps where it gives way so as to stand on the page at hand
SHORT = 75.0  # a table that is no higher is not divided
LOGO = 50.0, 18.0  # room of one on the first page
NUMBER = 20.0  # left free for that of a page
INDENT, MATHS = 5.0, 3.5  # of an equation, and size of its letters
INK, QUIET, FAINT, WRONG = LIGHT.ink, "#5b646d", "#d9dde0", LIGHT.limit
WORDS_OF_ALARM = ("NOT KEPT", "BROKEN")


@frozen(eq=False)
class Strip:
    """What cannot be divided between two pages: its height [mm], and what paints it at so many mm from the top of its page.

    above   left free above it, but not at the top of a page
    joined  stays on one page with the strip that follows; head: painted again where the strips of its table go on on a page
    begins  starts a new page where less than this is left of it
    lower   the same with so many mm less, up to ``gives``
    """

    height: float
    paint: Callable[[Pen, float], None]
    above: float = 0.0
    joined: bool = False
    head: Strip | None = None
    begins: float = 0.0
    gives: float = 0.0
    lower: Callable[[float], Strip] | None = None


class Pen:
    """Paints texts and lines, in mm from the left and upper edge of the paper."""

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
        """align: 0 begins at x, 1 ends there."""
        self.painter.setPen(QColor(colour))
        self._letters(UNITS_PER_MM * (x - align * width(text, size, bold)), UNITS_PER_MM * baseline, text, size, bold)

    def formula(self, x: float, top: float, equation: Typeset, size: float) -> None:
        """A typeset equation with letters of this size."""
        box = QRectF(
            UNITS_PER_MM * x,
            UNITS_PER_MM * top,
            UNITS_PER_MM * size * equation.width,
            UNITS_PER_MM * size * equation.height,
        )
        equation.paint(self.painter, box)

    def _letters(self, x: float, baseline: float, text: str, size: float, bold: bool = False) -> None:
        """A line from x on, in dots of the painter; the dots of derivatives over the middle of their letters."""
        for part, accent, serifs, low in _parts(text):
            tall = LOW * size if low else size
            metrics = _metrics(tall, bold, serifs)
            self.painter.setFont(_face(tall, bold, serifs))
            self.painter.drawText(QPointF(x, baseline + (DOWN * UNITS_PER_MM * size if low else 0.0)), part)
            advance = metrics.horizontalAdvance(part)
            if accent:
                middle = x + 0.5 * (advance - metrics.horizontalAdvance(accent))
                dot = metrics.tightBoundingRect(
                    OVER["\u0307"]
                )  # as high as it is wide; the box reaches down to the baseline
                raised = dot.top() + dot.width() - metrics.tightBoundingRect(part).top() + CLEAR * UNITS_PER_MM * size
                self.painter.drawText(QPointF(middle, baseline - raised), accent)
            x += advance

    def line(self, y: float, begin: float, end: float, thick: float = THIN, colour: str = INK) -> None:
        self.painter.setPen(QPen(QColor(colour), UNITS_PER_MM * thick, Qt.PenStyle.SolidLine, Qt.PenCapStyle.FlatCap))
        self.painter.drawLine(
            QPointF(UNITS_PER_MM * begin, UNITS_PER_MM * y), QPointF(UNITS_PER_MM * end, UNITS_PER_MM * y)
        )

    def vector(self, drawn: Vector, box: QRectF) -> None:
        """box in mm."""
        self.painter.save()
        self.painter.translate(UNITS_PER_MM * box.x(), UNITS_PER_MM * box.y())
        self.painter.scale(UNITS_PER_MM * box.width() / drawn.width, UNITS_PER_MM * box.height() / drawn.height)
        drawn.paint(self.painter)
        self.painter.restore()


# -- letters ------------------------------------------------------------------------------------------------


@cache
def _face(size: float, bold: bool = False, serif: bool = False) -> QFont:
    """Serifs are for equations, and for letters with an accent: of the fonts without them some put accents far above Greek letters."""
    made = font(round(UNITS_PER_MM * size), bold)
    if serif:
        made.setFamilies([*SERIF, *made.families()])
    for feature in ("liga", "ccmp"):  # no search finds a letter that is drawn together with its neighbour or its accent
        made.setFeature(QFont.Tag(feature), 0)
    return made


@cache
def _metrics(size: float, bold: bool, serif: bool = False) -> QFontMetricsF:
    return QFontMetricsF(_face(size, bold, serif))


def _parts(text: str) -> list[tuple[str, str, bool, bool]]:
    """Of a line the letters in one face with an accent to be set over them, whether that face has serifs, and whether they are the index
    of the letter before."""
    made: list[tuple[str, str, bool, bool]] = []
    for number, piece in enumerate(INDEX.sub("\\1\0\\2\0", text).split("\0")):
        for part in WITH_ACCENT.split(piece):
            if len(part) == 2 and part[1] in OVER:
                made.append((part[0], OVER[part[1]], False, False))
            elif part:
                made.append((part, "", WITH_ACCENT.fullmatch(part) is not None, number % 2 == 1))
    return made


def width(text: str, size: float, bold: bool = False) -> float:
    """Of a line of text [mm]."""
    return (
        sum(
            _metrics(LOW * size if low else size, bold, serifs).horizontalAdvance(part)
            for part, _, serifs, low in _parts(text)
        )
        / UNITS_PER_MM
    )


def wrapped(text: str, size: float, room: float, bold: bool = False) -> list[str]:
    """Lines that have room; a word that is longer is divided."""
    lines, line = [], ""
    for word in text.split():
        longer = f"{line} {word}" if line else word
        if width(longer, size, bold) <= room:
            line = longer
            continue
        lines += [line] if line else []
        while width(word, size, bold) > room and len(word) > 1:
            fits = next(n for n in range(len(word) - 1, 0, -1) if n == 1 or width(word[:n], size, bold) <= room)
            lines.append(word[:fits])
            word = word[fits:]
        line = word
    return [*lines, line] if line or not lines else lines


# -- blocks -------------------------------------------------------------------------------------------------


def _lines(
    texts: Sequence[str],
    size: float,
    x: float = LEFT,
    colour: str = INK,
    bold: bool = False,
    above: float = 0.0,
    joined: bool = False,
) -> list[Strip]:
    """Wrapped lines, each a strip; all joined where the last is."""
    room, height = LEFT + WIDTH - x, LEADING * size
    strips: list[Strip] = []
    lines = [line for text in texts for line in wrapped(text, size, room, bold)]
    for number, line in enumerate(lines):

        def paint(pen: Pen, top: float, line: str = line) -> None:
            pen.text(x, top + 0.75 * height, line, size, colour, bold)

        only_two = number in (0, len(lines) - 2) and len(lines) > 1  # no line of a paragraph stands alone
        strips.append(Strip(height, paint, 0.0 if number else above, joined or only_two))
    return strips


def _sentences(block: Sentences) -> list[Strip]:
    strips: list[Strip] = []
    for text in block.lines:
        size, colour = (SMALL, QUIET) if block.is_remark else (BODY, INK)
        strips += _lines([text], size, colour=colour, above=1.2 if strips else GAP)
    return strips


def _picture(block: ReportPicture, drawn: Vector) -> list[Strip]:
    whole = WIDTH * drawn.height / drawn.width

    def strip(drawn: Vector, gives: float) -> Strip:
        height = WIDTH * drawn.height / drawn.width

        def paint(pen: Pen, top: float) -> None:
            pen.vector(drawn, QRectF(LEFT, top, WIDTH, height))

        return Strip(height, paint, GAP, joined=True, gives=gives, lower=lower)

    def lower(less: float) -> Strip:
        return strip(vector(block, SCALE, 1.0 - less / whole), 0.0)

    caption = _lines([block.caption], SMALL, colour=QUIET, above=1.0)
    return [strip(drawn, whole - math.ceil(LEAST * whole)), *_kept_together(caption)]


def _kept_together(strips: Sequence[Strip]) -> list[Strip]:
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

        own = [Strip(height, title, GAP)]
        own += _lines(names[1:], BODY, bold=True)
        for equation in map(typeset, row.mathml):
            size = min(MATHS, (WIDTH - INDENT) / equation.width)

            def formula(pen: Pen, top: float, equation: Typeset = equation, size: float = size) -> None:
                pen.formula(LEFT + INDENT, top, equation, size)

            own.append(Strip(size * equation.height, formula, above=0.8))
        own += _lines([row.where], SMALL, colour=QUIET, above=0.8) if row.where else []
        strips += _kept_together(own)
    return strips


# -- tables -------------------------------------------------------------------------------------------------


def _table(block: ReportTable) -> list[Strip]:
    """Rows with their head repeated on every page; columns as wide as they need, text wrapped where that is too much."""
    cells = [[str(cell) for cell in row] for row in block.rows]
    flush = [i < block.left or i in block.text_columns for i in range(len(cells[0]))]
    widths = _widths([block.header, *cells] if block.header else cells, flush)
    strips: list[Strip] = []
    if block.title:
        strips += _lines([block.title], SMALL, colour=QUIET, above=GAP, joined=True)
    head = _row(block.header, widths, flush, QUIET, THIN) if block.header else None
    above = 0.6 if block.title else GAP
    if head is not None:
        strips.append(Strip(head.height, head.paint, above, joined=True))
    for number, row in enumerate(cells):
        last = number == len(cells) - 1
        made = _row(row, widths, flush, INK, THIN if last else HAIR, FAINT if not last else "#b9bfc4")
        near_an_end = number in (0, len(cells) - 2) and not last
        strips.append(Strip(made.height, made.paint, above if number == 0 and head is None else 0.0, near_an_end, head))
    return _kept_together(strips) if sum(each.height for each in strips) < SHORT else strips


def _widths(rows: Sequence[Sequence[str]], flush: Sequence[bool]) -> list[float]:
    """Of the columns with the space between them; the widest columns of words give way where the page is too narrow."""
    widths = [max(width(row[i], SMALL) for row in rows) + CELL + 0.01 for i in range(len(rows[0]))]
    widths[-1] -= CELL
    words = [
        max((width(word, SMALL) for row in rows for word in row[i].split()), default=0.0) + CELL
        for i in range(len(rows[0]))
    ]
    while sum(widths) > WIDTH:
        wide = [i for i in range(len(widths)) if widths[i] > words[i] + 1e-9]
        if not wide:
            return [each * WIDTH / sum(widths) for each in widths]
        most = max(wide, key=lambda i: widths[i])
        widths[most] = max(words[most], widths[most] - max(0.2, 0.25 * (sum(widths) - WIDTH)))
    return widths


def _row(
    cells: Sequence[str], widths: Sequence[float], flush: Sequence[bool], colour: str, rule: float, shade: str = INK
) -> Strip:
    """A row of a table with the line below it."""
    step = LEADING * SMALL
    columns = [wrapped(cell, SMALL, each) if cell else [] for cell, each in zip(cells, _rooms(widths), strict=True)]
    height = max(1, *(len(lines) for lines in columns)) * step + 2.0 * ROW_PAD
    edges = [LEFT, *(LEFT + sum(widths[: i + 1]) for i in range(len(widths)))]

    def paint(pen: Pen, top: float) -> None:
        for lines, (begin, end), left, last in zip(columns, pairwise(edges), flush, _is_last(widths), strict=True):
            for number, line in enumerate(lines):
                baseline = top + ROW_PAD + (number + 0.75) * step
                ink, bold = (WRONG, True) if line in WORDS_OF_ALARM else (colour, False)
                if left:
                    pen.text(begin, baseline, line, SMALL, ink, bold)
                else:
                    pen.text(end - (0.0 if last else CELL), baseline, line, SMALL, ink, bold, align=1.0)
        pen.line(top + height, LEFT, edges[-1], rule, shade)

    return Strip(height, paint)


def _rooms(widths: Sequence[float]) -> list[float]:
    """What of each column its text may take."""
    return [each if last else each - CELL for each, last in zip(widths, _is_last(widths), strict=True)]


def _is_last(widths: Sequence[float]) -> list[bool]:
    return [i == len(widths) - 1 for i in range(len(widths))]


# -- the document -------------------------------------------------------------------------------------------

SCALE = UNITS_PER_MM * WIDTH / PIXELS
"""Dots of the paper's painter that are a pixel of a picture."""
Drawn = Mapping[ReportPicture, Vector]


def _title(document: Document) -> list[Strip]:
    """The title block."""
    strips = _lines(["REPORT"], SMALL, colour=QUIET, joined=True)
    if (logo := document.logo) is not None:
        across, down = LOGO

        def picture(pen: Pen, top: float) -> None:
            box = (LEFT + WIDTH - across, top, across, down)
            paint_logo(pen.painter, logo, QRectF(*(UNITS_PER_MM * each for each in box)))

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


def _heading(each: Section, number: int) -> list[Strip]:
    if not each.title:
        return []
    if each.level > 1:
        return _lines([each.title], HEADING, bold=True, above=4.4, joined=True)
    indent = width("00", CHAPTER) + 3.0
    strips = _lines([each.title], CHAPTER, LEFT + indent, bold=True, above=8.0, joined=True)
    first = strips[0]

    def paint(pen: Pen, top: float) -> None:
        first.paint(pen, top)
        pen.text(LEFT, top + 0.75 * LEADING * CHAPTER, str(number), CHAPTER, QUIET)

    def rule(pen: Pen, top: float) -> None:
        pen.line(top, LEFT, LEFT + WIDTH, THIN, "#b9bfc4")

    return [Strip(first.height, paint, first.above, True, begins=45.0), *strips[1:], Strip(0.1, rule, 0.8, joined=True)]


def _block(block: Block, drawn: Drawn) -> list[Strip]:
    if isinstance(block, Sentences):
        return _sentences(block)
    if isinstance(block, ReportTable):
        return _table(block.without_empty_columns)
    if isinstance(block, ReportPicture):
        return _picture(block, drawn[block]) if block in drawn else []
    return _equations(block)


def _is_table(blocks: Sequence[Block]) -> bool:
    return any(isinstance(block, ReportTable) for block in blocks)


def strips_of(document: Document, drawn: Drawn) -> Iterator[Strip]:
    """The whole document from top to bottom; pictures that are not drawn are left out."""
    yield from _title(document)
    number = 0
    for each in document.sections:
        number += each.level == 1
        yield from _heading(each, number)
        for place, block in enumerate(each.blocks):
            made = _block(block, drawn)
            follows = each.blocks[place + 1 : place + 2]  # a remark to it, or what a table shows
            ahead = place == 0 and isinstance(block, Sentences) and (block.is_remark or _is_table(follows))
            yield from map(_joined, made) if ahead else made


def pages(strips: Sequence[Strip], room: float) -> list[list[tuple[Strip, float]]]:
    """The strips of each page with their distance from its top [mm]: what is joined is not parted, unless it is longer than a page; a
    picture is drawn lower where it stands on the page at hand so.

    room: height of the inside of a page [mm]
    """
    made: list[list[tuple[Strip, float]]] = [[]]
    at, first = 0.0, 0
    while first < len(strips):
        last = first
        while strips[last].joined and last + 1 < len(strips):
            last += 1
        group = strips[first : last + 1]
        height = sum(each.height + each.above for each in group)
        left = room - at
        if made[-1] and left < height <= left + sum(each.gives for each in group):
            group = _lowered(group, height - left)
            height = left
        if made[-1] and (height > left or left < group[0].begins):
            made.append([])
            at = 0.0
        for each in group:
            if made[-1] and at + each.above + each.height > room + 1e-6:  # a group that is longer than a page
                made.append([])
                at = 0.0
            if not made[-1] and each.head is not None:
                made[-1].append((each.head, 0.0))
                at = each.head.height
            elif made[-1]:
                at += each.above
            made[-1].append((each, at))
            at += each.height
        first = last + 1
    return made


def _lowered(group: Sequence[Strip], less: float) -> list[Strip]:
    """A group with its pictures lower by so many mm together."""
    gives = sum(each.gives for each in group)
    return [each if each.lower is None else each.lower(less * each.gives / gives) for each in group]


def pdf(document: Document, drawn: Drawn) -> bytes:
    """The document as PDF, with its pictures, which are drawn for ``SCALE``."""
    across, down = PAPERS[document.paper]
    laid = pages(list(strips_of(document, drawn)), down - TOP - FOOT)
    first, *more = wrapped(document.title, SMALL, WIDTH - NUMBER)
    name = f"{first} ..." if more else first

    def page(number: int) -> Callable[[QPainter], None]:
        def paint(painter: QPainter) -> None:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            pen = Pen(painter)
            for strip, at in laid[number]:
                strip.paint(pen, TOP + at)
            foot = down - 0.55 * FOOT
            pen.line(foot - 4.0, LEFT, LEFT + WIDTH, HAIR, FAINT)
            pen.text(LEFT, foot, name, SMALL, QUIET)
            pen.text(LEFT + WIDTH, foot, f"{number + 1} / {len(laid)}", SMALL, QUIET, align=1.0)

        return paint

    return vector_pdf(document.title, "Report", across, down, *(page(number) for number in range(len(laid))))


# -- the report to hand on as a file of either ending ----------------------------------------------------

GoOn = Callable[[int], bool]
"""Takes the number of pictures that are drawn; whether to go on."""


@frozen(eq=False)
class PictureKind:
    """A row: the scale that its pictures are drawn for, and what writes it with them."""

    scale: float
    write: Callable[[Document, Mapping[ReportPicture, Vector]], bytes]


def with_pictures(document: Document, drawn: Mapping[ReportPicture, Vector]) -> bytes:
    """As HTML."""
    return html(document, {picture: svg(each, picture.caption) for picture, each in drawn.items()}).encode()


KINDS: Mapping[str, PictureKind] = MappingProxyType(
    {".html": PictureKind(1.0, with_pictures), ".pdf": PictureKind(SCALE, pdf)}
)
assert tuple(KINDS) == ENDINGS


def report_file(document: Document, ending: str, go_on: GoOn = lambda done: True) -> bytes | None:
    """The file of a row of ``KINDS``; None where it was not to go on. Raises NoSolution where a picture has none."""
    ensure_app(offscreen=True)
    kind, drawn = KINDS[ending], {}
    for done, picture in enumerate(document.pictures):
        if not go_on(done):
            return None
        drawn[picture] = vector(picture, kind.scale)
    return kind.write(document, drawn) if go_on(len(drawn)) else None
