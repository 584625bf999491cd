"""Curves with axes as plain data, which a painter needs nothing beside."""

from __future__ import annotations

import numpy as np

from core.frozen import frozen


@frozen(eq=False)
class PlotCurve:
    """y over x (n,), nan where there is nothing; curves of one ``row`` have one colour and one ``label`` in the legend;
    family: the quantity whose colour a curve has wherever it is shown."""

    x: np.ndarray
    y: np.ndarray
    label: str = ""
    row: int = 0
    dashed: bool = False
    family: str = ""


@frozen(eq=False)
class Plot:
    """Curves with axes of their own; marks: places on the x axis with a text; note: what the legend adds; alike: one unit is
    as long on both axes; fit: the y axis need not begin at zero; quiet: the marks are places, not warnings."""

    across: str
    upwards: str
    curves: tuple[PlotCurve, ...]
    marks: tuple[tuple[float, str], ...] = ()
    note: str = ""
    alike: bool = False
    fit: bool = False
    quiet: bool = False


@frozen(eq=False)
class Figure:
    """Plots one below the other; ``name`` of its files, ``title`` above it."""

    name: str
    title: str
    plots: tuple[Plot, ...]
