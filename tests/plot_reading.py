"""What plots and drawings show, as items of their scenes: texts, limits, values beside the cursor, curves. For tests."""

from PySide6.QtCore import QRectF
from PySide6.QtWidgets import QGraphicsSimpleTextItem

from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.items import Tag
from kindyna_gui.pictures.plots.curves import CurvePlot
from kindyna_gui.pictures.plots.lines import Cursor, CurveLine
from kindyna_gui.pictures.plots.marks import MarkText
from kindyna_gui.pictures.style import LIGHT


def tags(plot: CurvePlot) -> list[Tag]:
    """The texts within the axes that are to be read."""
    return [item for item in plot.items() if isinstance(item, Tag) and item.text and item.isVisible()]


def box_in_mm(tag: Tag, scale: float) -> QRectF:
    """The box of a text in its scene, at so many pixels a millimetre [mm]."""
    box, at = tag.pixel_box(), tag.scenePos()
    return QRectF(at.x() + box.left() / scale, at.y() - box.bottom() / scale, box.width() / scale, box.height() / scale)


def is_limit(tag: Tag) -> bool:
    """Written in the colour of limits."""
    letters = (child for child in tag.childItems() if isinstance(child, QGraphicsSimpleTextItem))
    return any(child.brush().color().name() == LIGHT.limit.lower() for child in letters)


def limits(plot: CurvePlot) -> list[Tag]:
    """The texts of the limits, each at its value."""
    return [tag for tag in tags(plot) if is_limit(tag)]


def readouts(plot: CurvePlot) -> list[Tag]:
    """The values beside the cursor."""
    return [tag for tag in tags(plot) if not is_limit(tag) and not isinstance(tag, MarkText)]


def marks(plot: CurvePlot) -> list[MarkText]:
    """The texts of the extremes."""
    return [tag for tag in tags(plot) if isinstance(tag, MarkText)]


def message(plot: CurvePlot) -> str:
    """What stands in a plot without curves, in one line."""
    assert curves(plot) == []
    return " ".join(tag.text for tag in tags(plot)).replace("\n", " ")


def box_of(tag: Tag) -> QRectF:
    """Where a text stands in the scene [pixels]."""
    return tag.pixel_box().translated(tag.scenePos())


def cursor(plot: CurvePlot) -> Cursor:
    (found,) = (item for item in plot.items() if isinstance(item, Cursor))
    return found


def curves(plot: CurvePlot) -> list[CurveLine]:
    """The curves, a reference before those it is compared with."""
    found = (item for item in plot.items() if isinstance(item, CurveLine))
    return sorted(found, key=lambda item: (item.zValue(), id(item)))


def labels(scene: MechanismScene) -> dict[tuple[str, int], float]:
    """Where each text of the drawing stands beside its part, across and downwards [pixels]."""
    tags = {key: part.item for key, part in scene.parts.items() if isinstance(part.item, Tag)}
    return {(key, i): at for key, tag in tags.items() for i, at in enumerate(tag.pixel_box().center().toTuple())}
