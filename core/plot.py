"""Plots as plain data: all that a painter needs."""

from __future__ import annotations

import numpy as np

from core.frozen import frozen


@frozen(eq=False)
class PlotCurve:
    """One curve of a plot.

    Attributes
    ----------
    x, y : (n,) in the units of the plot's axes, NaN where the curve has a gap
    label : text in the legend
    row : curves of equal row have one colour, and one label in the legend
    dashed : whether the line is dashed
    family : quantity whose colour the curve has in every plot
    """

    x: np.ndarray
    y: np.ndarray
    label: str = ""
    row: int = 0
    dashed: bool = False
    family: str = ""


@frozen
class Span:
    """A named part of the x axis, such as a segment of the motion: start, end, name, and short name."""

    start: float
    end: float
    name: str
    short: str = ""


@frozen
class PlotDot:
    """A marked point of a curve with its text; ``row`` is that of the curve."""

    x: float
    y: float
    text: str
    row: int = 0


@frozen(eq=False)
class Plot:
    """Curves over common axes.

    Attributes
    ----------
    across, upwards : titles of the x and the y axis, with their units
    curves : the curves
    marks : (x, text) of vertical marks
    note : further text in the legend
    alike : whether both axes have the same scale
    fit : whether the y axis may begin at another value than zero
    quiet : whether the marks are plain positions, not warnings
    dots : marked points of the curves
    spans : parts of the x axis; every second one is shaded
    ends : ends of the y axis; None where they follow from the curves
    """

    across: str
    upwards: str
    curves: tuple[PlotCurve, ...]
    marks: tuple[tuple[float, str], ...] = ()
    note: str = ""
    alike: bool = False
    fit: bool = False
    quiet: bool = False
    dots: tuple[PlotDot, ...] = ()
    spans: tuple[Span, ...] = ()
    ends: tuple[float, float] | None = None


@frozen(eq=False)
class Figure:
    """Plots one below the other, with the name of the figure's files and the title above it."""

    name: str
    title: str
    plots: tuple[Plot, ...]
