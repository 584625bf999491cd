"""What the mouse drags in a timing chart: a drive, a join of its motion, the centre of a valve, or an edge of its lobe."""

from __future__ import annotations

from dataclasses import replace
from math import inf

from core.design import (
    AngleRoom,
    Design,
    events_at,
    faults,
    get,
    join_room,
    path_in,
    phase_path,
    phase_room,
    put,
    turn_drive,
    turn_join,
    with_phase_value,
)
from core.design.engine import CRANK_PER_CAM
from core.frozen import frozen
from core.valves import LobeEdge
from kindyna_gui.pictures.paper.crank_chart import CrankChart
from kindyna_gui.pictures.paper.timing_chart import TimingChart, event_text
from kindyna_gui.pictures.units import brief, short

ANYWHERE = AngleRoom(-3600.0, 3600.0)
REFUSED = "not possible: see the findings and the status line"


@frozen
class DraggedDrive:
    """A drive, or a join of its motion, while the mouse drags it.

    Attributes
    ----------
    drive : number of the drive
    join : number of the join, None for the drive
    design : the design before the drag
    at : machine angle at the start of the drag [deg]
    room : range of the angle by which it may be turned
    """

    drive: int
    join: int | None
    design: Design
    at: float
    room: AngleRoom

    @property
    def path(self) -> str:
        """Path of the field that the drag changes."""
        if self.join is None:
            return phase_path(self.design, self.drive)
        return f"drives[{self.drive}].motion.joins[{self.join}]"

    def turned(self, by: float) -> Design:
        """Return the design with the drive or join turned by an angle [deg]."""
        if self.join is None:
            return turn_drive(self.design, self.drive, self.at + by)
        return turn_join(self.design, self.drive, self.join, by)


@frozen
class DraggedBand(DraggedDrive):
    """A drive or a join in a chart, with its texts in the unit of the axis; ``chart`` is the chart before the drag."""

    chart: TimingChart

    def step(self, by: float) -> str:
        """Name of the undo step: ``Turn Feed to 330°``, ``Move Feed rise 1 end to 33.5°``."""
        at = f"{short((self.at + by) % 360.0)}°"
        return f"Turn {self._drive_name} to {at}" if self.join is None else f"Move {self._name} to {at}"

    def text(self, by: float) -> str:
        """Value during the drag."""
        name = f"{self._drive_name} phase" if self.join is None else self._name
        return f"{name}  {self.chart.degrees_and_ms(round(self.at + by, 9) % 360.0)}"

    @property
    def typed_name(self) -> str:
        """Name of the value that can be typed."""
        return "Phase" if self.join is None else "Machine angle"

    @property
    def value(self) -> float:
        """Value that can be typed, in the unit of the axis."""
        return self.chart.value(self.at % 360.0)

    def typed(self, value: float) -> tuple[float, AngleRoom]:
        """Angle by which a typed value turns, and its range, between the neighbours of a join without sequence conditions."""
        angle = value / self.chart.value(360.0) * 360.0
        if self.join is None:
            return round(angle - self.at, 9), ANYWHERE
        room = join_room(replace(self.design, timing=()), self.drive, self.join)
        return round((angle - self.at + 180.0) % 360.0 - 180.0, 9), room

    def refusal(self, by: float) -> str:
        """Why the design turned by an angle is refused."""
        return REFUSED

    @property
    def _drive_name(self) -> str:
        return self.chart.bands[self.drive].name

    @property
    def _name(self) -> str:
        assert self.join is not None
        events = events_at(self.design, self.drive, self.join)
        return event_text(events[0]) if events else f"join {self.join + 1} of {self._drive_name}"


@frozen
class DraggedValve:
    """The centre of a valve, or an edge of its lobe, while the mouse drags it.

    Attributes
    ----------
    chart : the chart before the drag
    design : the design before the drag
    drive : number of the drive
    join : number of the edge from 1, None for the centre
    edge : the edge, None for the centre
    room : range of the angle by which it may be turned
    crank : crank degrees per degree of the chart: 1 over the crank, 2 over the machine angle
    """

    chart: TimingChart
    design: Design
    drive: int
    join: int | None
    edge: LobeEdge | None
    room: AngleRoom
    crank: float = 1.0

    @property
    def path(self) -> str:
        """Path of the field that the drag changes."""
        return path_in(self.design, self.drive, "valve.centre_deg" if self.edge is None else self.edge.path)

    @property
    def value(self) -> float:
        """Value of the field: the centre, or the angle of the row [crank deg]."""
        return float(get(self.design, self.path))

    @property
    def at(self) -> float:
        """Angle of the chart that is rounded to the step of the drag: the centre, or that of the edge from the nose [deg]."""
        return self.value / self._factor

    @property
    def _factor(self) -> float:
        """Change of the field per change of the angle of the chart."""
        return self.crank * (1.0 if self.edge is None else self.edge.factor)

    def _moved(self, by: float) -> float:
        return round(self.value + by * self._factor, 9)

    def turned(self, by: float) -> Design:
        """Return the design with the centre or edge turned by an angle of the chart [deg]."""
        if self.edge is None:
            return with_phase_value(self.design, self.drive, self._moved(by))
        return put(self.design, self.path, self._moved(by))

    def step(self, by: float) -> str:
        """Name of the undo step, such as ``Change Inlet centre to 110°``."""
        return f"Change {self._name} to {short(self._moved(by))}°"

    def text(self, by: float) -> str:
        """Value during the drag."""
        return f"{self._name}  {short(self._moved(by))}°"

    @property
    def typed_name(self) -> str:
        """Name of the value that can be typed."""
        return self._name

    def typed(self, value: float) -> tuple[float, AngleRoom]:
        """Angle by which a typed value turns, and its range."""
        return (value - self.value) / self._factor, ANYWHERE

    def refusal(self, by: float) -> str:
        """Why the design turned by an angle is refused."""
        return "; ".join(map(str, faults(self.turned(by))[:1])) or REFUSED

    @property
    def _name(self) -> str:
        name = self.chart.bands[self.drive].name
        if self.edge is None:
            return f"{name} centre"
        at = brief(self.edge.at_mm, "mm")
        return f"{name} duration at {at}" if self.edge.is_duration else f"{name} from {at} to the nose"


def dragged(chart: TimingChart, design: Design, drive: int, join: int | None) -> DraggedBand | DraggedValve:
    """Return what the mouse drags at a join of a drive in the chart of a design, None for the drive itself."""
    if isinstance(chart, CrankChart):
        if join:
            on_crank = chart.curves[drive].edges[join - 1][0]
            return DraggedValve(chart, design, drive, join, on_crank, AngleRoom(-inf, inf))
        return DraggedValve(chart, design, drive, None, None, _on_crank(phase_room(design, drive)))
    if join is not None and (edge := _lobe_edge(chart, design, drive, join)) is not None:
        return DraggedValve(chart, design, drive, join, edge, AngleRoom(-inf, inf), CRANK_PER_CAM)
    if join is None or chart.edges.get(drive):  # the nose moves with its drive
        return DraggedBand(drive, None, design, design.drives[drive].phase, phase_room(design, drive), chart)
    return DraggedBand(drive, join, design, chart.bands[drive].joins[join], join_room(design, drive, join), chart)


def _lobe_edge(chart: TimingChart, design: Design, drive: int, join: int) -> LobeEdge | None:
    """Edge of a lobe at a point of a chart over the machine angle; a side's start or end moves its lowest edge."""
    if (edge := chart.edge(drive, join)) is not None:
        return edge[0]
    motion, edges = design.drives[drive].motion, [edge for edge, _ in chart.edges.get(drive, ())]
    if motion is None or not edges:
        return None
    before, after = motion.segments[join - 1].rise, motion.segments[join].rise
    if before and after:
        return None
    side = [edge for edge in edges if (edge.factor < 0.0) == (after > 0.0)]
    return min(side, key=lambda edge: edge.at_mm, default=None)


def _on_crank(room: AngleRoom) -> AngleRoom:
    return replace(room, low=CRANK_PER_CAM * room.low, high=CRANK_PER_CAM * room.high)
