"""Colours, pens, sizes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache, partial, wraps
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QBrush, QColor, QFont, QIcon, QPen

from core.dynamics import Forces
from core.frozen import frozen
from core.study import Quantity, Study
from kindyna_gui.settings import sized

# -- sizes -----------------------------------------------------------------------------------------------

# In a dwell the contact normal passes through the cam's centre, so that the torque is the difference of two equal
# products; drawn to its own scale it would be a storm of noise.

ROUNDING = 256.0 * np.finfo(float).eps  # of the natural size: what rounding leaves of a zero
_ORDERS: Mapping[str, int] = MappingProxyType({"/s": 1, "/s²": 2, "/s³": 3})


def _reach(study: Study) -> float:
    """A length characteristic of the mechanism's size [m]."""
    return study.driver_ranges.plan.size if study.mechanism.ranged else study.reach


def _motion(study: Study) -> float:
    return float(np.abs(study.motion.displacement[0]).max())


def _one(study: Study) -> float:
    return 1.0


def _force(study: Study) -> float:
    return force_size(study.dynamics)


_SIZES: Mapping[str, Callable[[Study], float]] = MappingProxyType(
    {
        "mm": _reach,
        "1/mm": lambda study: 1.0 / _reach(study),
        "N": _force,
        "N·m": lambda study: torque_size(study),
    }
)
"""Unit of a channel, without what makes it a rate -> the natural size of what it counts [SI]; angles and ratios: 1."""


@lru_cache(maxsize=4)
def force_size(forces: Forces) -> float:
    """The largest finite force on any pair [N]."""
    sizes = np.abs(np.array(list(forces.pairs.values())))
    return float(sizes.max(where=np.isfinite(sizes), initial=0.0))


def torque_size(study: Study) -> float:
    """What the largest force would give at the arm of the follower's reference point [N m]."""
    return _force(study) * _reach(study)


def floor_of(study: Study, row: Quantity) -> float:
    """Size below which values of a channel are zero, in its own unit. Raises NoSolution where its stage has none."""
    symbol, slash, rate = row.unit.symbol.partition("/s")
    order = _ORDERS.get(slash + rate, 0)
    natural = _motion if row.stage == "motion" else _SIZES.get(symbol, _one)
    return ROUNDING * natural(study) * abs(study.omega) ** order / row.unit.factor


def without_noise(values: np.ndarray, floor: float) -> np.ndarray:
    """The values (n,); all zero where none stands above the floor."""
    return values if bool((np.abs(values) > floor).any()) else np.where(np.isnan(values), values, 0.0)


# -- the look of every drawing: colours by quantity, papers, pens, fonts ---------------------------------

# A drawing office: the mechanism and the curves carry the colour, everything else is quiet. The colours of the
# quantities are those of Okabe and Ito, which colour-blind readers keep apart; each family of ``core.output.channels`` has one,
# the same in every picture.

BLACK, ORANGE, SKY, GREEN, YELLOW = "#000000", "#E69F00", "#56B4E9", "#009E73", "#F0E442"
BLUE, VERMILION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"
WHITE = "#FFFFFF"

FAMILIES: Mapping[str, str] = MappingProxyType(
    {
        "displacement": BLUE,
        "velocity": GREEN,
        "speed": "#00694D",
        "acceleration": VERMILION,
        "jerk": PURPLE,
        "pressure-angle": ORANGE,
        "force": BLACK,
        "torque": SKY,
        "stress": "#9E2A63",
        "curvature": "#8C6D1F",
        "length": "#5A6B7B",
        "angle": "#6A51A3",
        "energy": "#A6761D",
        "power": "#B0305C",
        "ratio": "#7A7A7A",
    }
)
"""Family of a channel -> colour. Black turns white on dark paper."""


DRIVES = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK)
"""Colours of the drives on one shaft, in the order of their list."""
BALANCE = "#5A6B7B"
"""That of the balance cam."""

READABLE = 4.5  # least contrast of a colour with dark paper: that of texts, by WCAG 2
THIN, OUTLINE = 1.0, 1.5  # widths in pixels at every zoom


@frozen
class Theme:
    """One paper and what is quiet on it.

    ink    outlines of the mechanism, texts; quiet: axes, hatching, construction lines; faint: grid; band: every other
           segment of the motion; limit: lines that must not be crossed
    cam, second, roller, slider, shaft, links   fills of the mechanism, links in turn; second: of a conjugate pair
    desk   what is around the papers; line: frames; chosen: what is; chosen_row: its row in a table; assumed: values; good: what
           is right; title, button, row, tip: of docks, of buttons, of every other row of tables, of tips; greyed: what is disabled;
           dwell: beside the player; hair: the finer grid of a drawing
    light ... shadow, idle   edges of Qt's style, and what is chosen in a window that has not the keys
    ratio  dots per pixel of the device: Qt counts the width of cosmetic pens in dots
    """

    paper: str
    ink: str
    quiet: str
    faint: str
    band: str
    limit: str
    cam: str
    cam_line: str
    second: str
    second_line: str
    roller: str
    slider: str
    shaft: str
    links: tuple[str, ...]
    desk: str
    line: str
    chosen: str
    chosen_row: str
    assumed: str
    good: str
    title: str
    button: str
    row: str
    tip: str
    greyed: str
    dwell: str
    hair: str
    light: str
    midlight: str
    mid: str
    dark: str
    shadow: str
    idle: str
    ratio: float = 1.0

    def pen(self, colour: str, width: float = THIN, dash: tuple[float, ...] = ()) -> QPen:
        """A pen of so many pixels at every zoom; dashes in pixels."""
        return QPen(_pen(colour, width, dash, self.ratio))

    def letters(self, colour: str) -> str:
        """A colour for texts: the same hue, dark enough to be read on light paper."""
        base = QColor(self.seen(colour))
        light = 0.2126 * base.redF() + 0.7152 * base.greenF() + 0.0722 * base.blueF()
        pale = QColor(self.paper).lightnessF() > 0.5 and light > 0.5
        return base.darker(140).name() if pale else base.name()

    def family(self, name: str) -> str:
        """The colour of a quantity on this paper."""
        colour = FAMILIES.get(name, self.quiet)
        return self.ink if colour == BLACK else self.seen(colour)

    def drive(self, number: int) -> str:
        """The colour of the drive of this number, from 0, on this paper; those beyond the colours that can be told apart are shades."""
        turn, place = divmod(number, len(DRIVES))
        return self.seen(shade(DRIVES[place], turn))

    def seen(self, colour: str) -> str:
        """A colour of the same hue that stands out from dark paper; on light paper, for which all are chosen, the colour itself."""
        if not self.is_dark:
            return colour
        return self.ink if colour == BLACK else _lightened(colour, self.paper)

    @property
    def is_dark(self) -> bool:
        """Whether the paper is."""
        return QColor(self.paper).lightnessF() < 0.5


LIGHT = Theme(
    paper=WHITE,
    ink="#1C2126",
    quiet="#6E7780",
    faint="#E3E6E9",
    band="#F4F5F6",
    limit="#C62828",
    cam="#F7EFD9",
    cam_line="#6B5416",
    second="#E1E8EE",
    second_line="#4A6072",
    roller="#FFFFFF",
    slider="#DCE8DF",
    shaft="#D5D8DB",
    links=("#D6E3EE", "#E9DDEA", "#F3E0D2", "#DDE7D3"),
    desk="#F1F1EF",
    line="#C9CBCC",
    chosen="#2F6690",
    chosen_row="#E4ECF2",
    assumed="#A05A00",
    good="#2E7D32",
    title="#E6E7E6",
    button="#F4F4F2",
    row="#F7F7F5",
    tip="#FFFDF2",
    greyed="#9A9EA2",
    dwell="#DFE2E4",
    hair="#ECEEEF",
    light="#FFFFFF",
    midlight="#E8E8E5",
    mid="#B9BBBB",
    dark="#9A9C9D",
    shadow="#6E7072",
    idle="#B8CAD8",
)
DARK = Theme(
    paper="#1B1F23",
    ink="#F2F4F5",
    quiet="#9AA4AD",
    faint="#30363C",
    band="#22272C",
    limit="#FF6B6B",
    cam="#3A3524",
    cam_line="#D9C68A",
    second="#2B3640",
    second_line="#8FA9BF",
    roller="#262B30",
    slider="#2C3A31",
    shaft="#454C53",
    links=("#2B3A47", "#3B2F3D", "#43352A", "#323B29"),
    desk="#2A2F35",
    line="#4A525A",
    chosen="#6DB3E0",
    chosen_row="#2C4356",
    assumed="#E5A550",
    good="#6FCF75",
    title="#343A41",
    button="#363C43",
    row="#20252A",
    tip="#3A3A2E",
    greyed="#6C757D",
    dwell="#3A4148",
    hair="#262B31",
    light="#4A525A",
    midlight="#3E454C",
    mid="#2A3036",
    dark="#1C2024",
    shadow="#101214",
    idle="#3B5163",
)


SCREEN = replace(LIGHT)
"""The theme of everything that is drawn in the window. It alone changes, by ``draw_in``; files and reports are ``LIGHT``."""


Made = TypeVar("Made")
_OF_THEME: list[Callable[[], None]] = []
_MADE: dict[int, Callable[[], Any]] = {}


def of_theme(make: Callable[..., Made]) -> Callable[..., Made]:
    """A function whose answers, such as icons, are kept as long as the theme stays."""

    @lru_cache(maxsize=256)
    def kept(*asked: Any) -> Made:
        made: Any = make(*asked)
        if isinstance(made, QIcon):
            _MADE[made.cacheKey()] = partial(kept, *asked)
        return made

    _OF_THEME.append(kept.cache_clear)
    return wraps(make)(kept)


def made_for(key: int) -> Callable[[], Any] | None:
    """What makes the icon of this key for the theme at hand; None where it was not made for a theme."""
    return _MADE.get(key)


def draw_in(theme: Theme) -> None:
    """Let the window be drawn in the colours of this theme from now on."""
    vars(SCREEN).clear()
    vars(SCREEN).update(vars(theme))
    for forget in _OF_THEME:
        forget()


# dashes and gaps, pixels
DASHED = (7.0, 4.0)  # the reference design
CHAIN = (10.0, 3.0, 1.5, 3.0)  # pitch curve, centre lines
DOTTED = (1.5, 3.0)  # base circle
SPARSE = (2.0, 4.0)  # construction lines

TEXT, SMALL = 12, 11  # heights of letters, pixels
SERIF = (
    "DejaVu Serif",
    "Noto Serif",
    "Liberation Serif",
    "Cambria",
    "Times New Roman",
)  # of equations: others lose the dots of derivatives
FONTS = ("DejaVu Sans", "Noto Sans", "Liberation Sans", "Segoe UI", "Helvetica Neue", "Arial", "NanumGothic")


# Every edit needs the same few dozens of these again; a copy costs next to nothing.


@lru_cache(maxsize=256)
def _pen(colour: str, width: float, dash: tuple[float, ...], ratio: float) -> QPen:
    made = QPen(QColor(colour), width * ratio)
    made.setCosmetic(True)
    made.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    made.setCapStyle(Qt.PenCapStyle.FlatCap if dash else Qt.PenCapStyle.RoundCap)
    if dash:
        made.setDashPattern([part / width for part in dash])
    return made


def contrast(colour: str, paper: str) -> float:
    """How much brighter one of two colours is than the other, 1 ... 21 (WCAG 2, relative luminance)."""
    ends = sorted(0.05 + _luminance(QColor(each)) for each in (colour, paper))
    return ends[1] / ends[0]


def _luminance(colour: QColor) -> float:
    rgb = (colour.redF(), colour.greenF(), colour.blueF())
    parts = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in rgb]
    return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]


@lru_cache(maxsize=256)
def _lightened(colour: str, paper: str) -> str:
    """The colour, as much lighter as it takes to be read."""
    made = QColor(colour)
    hue, depth, light = made.hslHueF(), made.hslSaturationF(), made.lightnessF()
    while contrast(made.name(), paper) < READABLE and light < 1.0:
        light = min(light + 0.02, 1.0)
        made = QColor.fromHslF(max(hue, 0.0), depth, light)
    return made.name() if made != QColor(colour) else colour


def no_pen() -> QPen:
    return QPen(Qt.PenStyle.NoPen)


def rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue, 0 ... 255."""
    made = QColor(colour)
    return made.red(), made.green(), made.blue()


def brush(colour: str, opacity: float = 1.0) -> QBrush:
    return QBrush(_brush(colour, opacity))


@lru_cache(maxsize=256)
def _brush(colour: str, opacity: float) -> QBrush:
    made = QColor(colour)
    made.setAlphaF(opacity)
    return QBrush(made)


def font(pixels: int = TEXT, bold: bool = False) -> QFont:
    """The font of all drawings, in pixels at the usual size of letters; the first of ``FONTS`` that the machine has."""
    return QFont(_font(round(sized(pixels)), bold))


@lru_cache(maxsize=16)
def _font(pixels: int, bold: bool) -> QFont:
    made = QFont()
    made.setFamilies(list(FONTS))
    made.setPixelSize(pixels)
    made.setBold(bold)
    return made


@lru_cache(maxsize=64)
def shade(colour: str, number: int) -> str:
    """The colour of the curve of this number (0, 1, ...) among curves of one family in one plot: darker and
    lighter in turn, lighter only where dark already."""
    base = QColor(colour)
    if number == 0:
        return base.name()
    steps = (200, 62, 330)  # below 100 it becomes lighter
    step = steps[(number - 1) % len(steps)]
    dark = base.lightnessF() < 0.2
    if dark:
        return QColor.fromHsvF(0.0, 0.0, min(0.75, 0.3 + 0.15 * number)).name()
    return base.darker(step).name()
