"""pyqtgraph, imported without the parts that no plot uses.

On import pyqtgraph loads all of its items and widgets, and copies every class of Qt, which Qt for Python then has to
create. Both take longer than everything else that a plot needs.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from types import ModuleType
from typing import Any

from PySide6 import QtCore, QtGui, QtWidgets

_UNUSED = (
    "imageview",
    *(
        f"graphicsItems.{name}"
        for name in (
            "ArrowItem", "BarGraphItem", "BoxplotItem", "ColorBarItem", "CurvePoint", "DateAxisItem", "ErrorBarItem",
            "FillBetweenItem", "GradientEditorItem", "GradientLegend", "GraphItem", "HistogramLUTItem", "IsocurveItem",
            "PColorMeshItem", "ROI", "ScaleBar", "TargetItem", "VTickGroup",
        )
    ),
    *(
        f"widgets.{name}"
        for name in (
            "BusyCursor", "CheckTable", "ColorButton", "ColorMapMenu", "ColorMapWidget", "ComboBox", "DataFilterWidget",
            "DataTreeWidget", "DiffTreeWidget", "FeedbackButton", "GradientWidget", "GraphicsLayoutWidget", "GroupBox",
            "HistogramLUTWidget", "JoystickButton", "LayoutWidget", "PathButton", "ProgressDialog", "RawImageWidget",
            "RemoteGraphicsView", "ScatterPlotWidget", "SpinBox", "TableWidget", "TreeWidget", "ValueLabel", "VerticalLabel",
        )
    ),
)  # fmt: skip
"""Modules of pyqtgraph that are skipped; a later import of one of them by its own name still works."""


@contextmanager
def _without_unused_parts() -> Iterator[None]:
    """Put empty modules in place of the unused ones, and let copies of Qt's modules look up each class when it is used."""
    for part in _UNUSED:
        name = f"pyqtgraph.{part}"
        sys.modules[name] = empty = ModuleType(name)
        setattr(empty, name.rpartition(".")[2], None)
    modules: tuple[Any, ...] = QtCore, QtGui, QtWidgets
    for module in modules:
        name = f"pyqtgraph.Qt.{module.__name__.rpartition('.')[2]}"
        sys.modules[name] = mirror = ModuleType(name)
        vars(mirror)["__getattr__"] = partial(getattr, module)
        module.__dir__ = list  # no class is copied
    try:
        yield
    finally:
        for part in _UNUSED:
            del sys.modules[f"pyqtgraph.{part}"]
        for module in modules:
            del module.__dir__


if "pyqtgraph" in sys.modules:
    import pyqtgraph as pg
else:
    with _without_unused_parts():
        import pyqtgraph as pg

__all__ = ["pg"]
