"""A graph: curves of any columns of tables and designs on axes by unit, their differences, and what is read off them."""

from core.output.graph.curves import AxisOf, Plotted, Series, difference, plotted, series_of
from core.output.graph.model import (
    ALL,
    ANGLES,
    AUTO,
    DASHES,
    LEAST_WIDTH,
    LEFT,
    MARKS,
    MOST_WIDTH,
    RIGHT,
    SIDES,
    WHOLE,
    Graph,
    GraphAxis,
    GraphCurve,
    add_curve,
    copy_curve,
    from_data,
    is_colour,
    move_curve,
    remove_curve,
    to_data,
    with_curve,
)
from core.output.graph.numbers import (
    GraphPoint,
    PointDistance,
    angle_at,
    angle_marks,
    columns_of,
    gap,
    numbers_csv,
    point_at,
)
from core.output.graph.ready import PointValue, ReadyGraph, on_path, ready
from core.output.graph.sources import (
    MACHINE,
    TIME,
    ColumnHeading,
    DesignSource,
    Source,
    TableSource,
    read_source,
    words_of,
)
from core.output.graph.table import NumberTable, Progress, read_numbers, read_table_file
from core.output.graph.units import unit_of_column
from core.units import kind_of, units_like

__all__ = [
    "ALL", "ANGLES", "AUTO", "DASHES", "LEAST_WIDTH", "LEFT", "MACHINE", "MARKS", "MOST_WIDTH", "RIGHT", "SIDES",
    "TIME", "WHOLE", "AxisOf", "ColumnHeading", "DesignSource", "Graph", "GraphAxis", "GraphCurve", "GraphPoint",
    "NumberTable", "Plotted", "PointDistance", "PointValue", "Progress", "ReadyGraph", "Series", "Source",
    "TableSource", "add_curve", "angle_at", "angle_marks", "columns_of", "copy_curve", "difference", "from_data", "gap",
    "is_colour", "kind_of", "move_curve", "numbers_csv", "on_path", "plotted", "point_at", "read_numbers",
    "read_source", "read_table_file", "ready", "remove_curve", "series_of", "to_data", "unit_of_column", "units_like",
    "with_curve", "words_of",
]  # fmt: skip
