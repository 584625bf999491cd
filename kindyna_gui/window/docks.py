"""The views of the window, and the docks that show them.

``VIEWS`` has one row for each view: title, constructor, side of the window, menu entry, tip, keys, page of the help.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QEvent, QSize, Qt, Signal
from PySide6.QtGui import QPaintEvent
from PySide6.QtWidgets import (
    QDockWidget,
    QMainWindow,
    QStyle,
    QStyleOptionDockWidget,
    QStyleOptionFrame,
    QStylePainter,
    QWidget,
)

from core.frozen import frozen
from kindyna_gui.documents.session import Session
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import is_in_sight, single_shot
from kindyna_gui.view import View

ACROSS, UPWARDS = Qt.Orientation.Horizontal, Qt.Orientation.Vertical
Area = Qt.DockWidgetArea
LEFT, RIGHT, TOP, BOTTOM = (
    Area.LeftDockWidgetArea,
    Area.RightDockWidgetArea,
    Area.TopDockWidgetArea,
    Area.BottomDockWidgetArea,
)
COLUMNS, ROWS = (LEFT, RIGHT), (TOP, BOTTOM)
CENTRE = Area.NoDockWidgetArea  # no dock: a page in the middle of the window
TAB = 26  # width of a tab beyond its text [pixels]
ANY_HEIGHT = (1 << 24) - 1  # Qt's QWIDGETSIZE_MAX

# -- rows of the views -----------------------------------------------------------------------------------


@frozen
class Need:
    """Size at which a view can be read, in pixels, without the title of its dock.

    Attributes
    ----------
    width, height : int
        Least size.
    row_height : int
        Least height in a row above or below the middle, where its sentences have fewer lines; 0: the same.
    most : int
        Height above which it shows nothing more.
    tab : int
        Width of its tab.
    """

    width: int
    height: int
    most: int = ANY_HEIGHT
    tab: int = 0
    row_height: int = 0

    def height_at(self, area: Area) -> int:
        """Least height at a side of the window."""
        return self.row_height or self.height if area in ROWS else self.height


PLOT = (250, 152)
"""Least size of a plot with its axes and two lines of names: 160 by 80 pixels inside."""

Make = Callable[[Session, Player], View]


def lazily(module: str, name: str, **more: Any) -> Make:
    """Return a function that makes a view; its module is imported at the first call."""

    def make(session: Session, player: Player) -> View:
        view: View = getattr(import_module(f"kindyna_gui.{module}"), name)(session, player, **more)
        return view

    return make


@frozen
class ViewRow:
    """One view.

    Attributes
    ----------
    title : str
        Title of its dock or page.
    area : Area
        Default side of the window, or the middle; ``tasks.TASKS`` has its position in each task.
    menu, tip, keys, icon : str
        Its entry in a menu, where ``menus.MENUS`` lists it.
    least : tuple of int
        Width and height at which it can be read [pixels].
    picture : bool
        Whether it can be exported as a picture.
    quantities : tuple of str
        Quantities of a plot.
    of_cam : bool
        Whether it is empty without a cam.
    help : str
        Page of the help and, after #, the text to search there.
    short : str
        Title where its tab has no room for the full one; empty: no shorter one.
    task : str
        Task that is shown when it is opened, for a view that needs the drawing large; empty: the current one.
    """

    title: str
    make: Make
    area: Area
    menu: str = ""
    tip: str = ""
    least: tuple[int, int] = PLOT
    keys: str | None = None
    icon: str = ""
    picture: bool = False
    quantities: tuple[str, ...] = ()
    of_cam: bool = False
    help: str = "tour"
    short: str = ""
    task: str = ""

    @property
    def short_title(self) -> str:
        """Title where there is little room."""
        return self.short or self.title


def _plot(
    title: str,
    quantities: tuple[str, ...],
    menu: str,
    tip: str,
    of_cam: bool = False,
    help: str = "tour#Plots, in the tasks",
    short: str = "",
) -> ViewRow:
    make = lazily("graph.plots_view", "PlotView", quantities=quantities)
    return ViewRow(
        title, make, RIGHT, menu, tip, picture=True, quantities=quantities, of_cam=of_cam, help=help, short=short
    )


VIEWS: Mapping[str, ViewRow] = MappingProxyType(
    {
        "mechanism": ViewRow("Mechanism", lazily("linkage.mechanism_view", "MechanismView"), CENTRE,
            "&Mechanism", "Show the mechanism, drawn to scale", least=(240, 212), picture=True, help="tour#See it move"),
        "graph": ViewRow("Graph", lazily("graph.graph_view", "GraphView"), CENTRE,
            "New &graph...", "Plot any channels over the cam angle, in straight or polar axes",
            least=(560, 320), keys="Ctrl+G", icon="graph", picture=True,
            help="graphs#draws channels of the design in plots"),
        "curves": ViewRow("Curves", lazily("graph.curves_view", "CurvesView"), CENTRE,
            "&Curves", "Plot channels, tables and other designs on one graph, with differences and values", least=(652, 360),
            icon="graph", picture=True, help="graphs#Curves on one graph"),
        "space": ViewRow("Path in space", lazily("space_view", "SpaceView"), CENTRE,
            "Path in &space", "Show the path of the part that all drives move, in three dimensions", least=(240, 212), picture=True,
            help="camshaft#Path in space", short="Space"),
        "surface": ViewRow("Cam in space", lazily("spatial.view", "SpatialView"), CENTRE,
            "Cam in sp&ace", "Show a barrel or globoidal cam shaded, and its unrolled flanks", least=(420, 300),
            picture=True, help="spatial#What is computed", short="Cam"),
        "laws": ViewRow("Laws", lazily("motion.laws_view", "LawsView"), CENTRE,
            "&Law table", "Compare the motion laws: curves and peak values",
            least=(500, 440), keys="Ctrl+L", picture=True, help="laws#Motion laws"),
        "stability": ViewRow("Stability", lazily("stability_view", "StabilityView"), CENTRE,
            "&Chart", "Show the stability chart of the flexible camshaft: tongues of instability and wind-up",
            least=(860, 340), keys="Ctrl+T", picture=True,
            help="stability#What you see"),
        "log": ViewRow("Log", lazily("window.log_view", "LogView"), CENTRE, "Lo&g", "Show the error log", least=(400, 120),
            help="tour#If something fails"),
        "parameters": ViewRow("Parameters", lazily("motion.inspector", "inspector"), RIGHT, least=(388, 185), help="tour#Change it",
            short="Param."),
        "motion": ViewRow("Motion", lazily("motion.segments_view", "SegmentsView"), LEFT,
            "&Motion table", "Edit the segments of the motion: law, span, rise", least=(384, 480), keys="Ctrl+M", help="making#By mouse"),
        "drives": ViewRow("Drives", lazily("drives_view", "DrivesView"), LEFT,
            "D&rives", "Add, duplicate, remove and rename the drives on the shaft, and set their phases; peak torques", least=(280, 200),
            help="camshaft#In the window"),
        "find": ViewRow("Find", lazily("find", "FindView"), LEFT,
            "Fi&nd", "Calculate the smallest base radius, roller, offset, pivot or span within your limits, and plot what it costs",
            least=(384, 560),
            keys="Ctrl+F", help="finding#Finding dimensions"),
        "find_linkage": ViewRow("Find a linkage", lazily("synthesis.find_linkage_view", "FindLinkageView"), RIGHT,
            "Find a linka&ge", "Propose four-bars and slider-cranks through poses of a body, along a path, for pairs of angles or a swing",
            least=(388, 340), help="linkages#Finding a linkage", short="Find link.", task="compo"),
        "study": ViewRow("Study", lazily("studies.study_view", "StudyView"), LEFT,
            "St&udy", "Vary values of the design: curves over one, a map over two, parallel coordinates over more; compare designs",
            picture=True, least=(600, 300), help="studies#In the window"),
        "centres": ViewRow("Centres", lazily("linkage.centres_view", "CentresView"), LEFT,
            "&Instant centres", "List instant centres, angular velocities and points at the current angle", least=(330, 180),
            help="linkages#Instant centres and velocities", short="Centres"),
        "circle": ViewRow("Circle diagram", lazily("linkage.centres_view", "CircleView"), LEFT,
            "Circle &diagram", "Construct the instant centres step by step, as in the lecture",
            least=(310, 180), help="linkages#Circle diagram", short="Circle"),
        "polygon": ViewRow("Polygons", lazily("linkage.centres_view", "PolygonView"), LEFT, least=(240, 200), picture=True,
            help="linkages#draws all velocities from one pole"),
        "stack": ViewRow("Motion and pressure angle", lazily("graph.plots_view", "StackView"), LEFT,
            "Motion and pressure an&gle", "Plot displacement, velocity, acceleration, jerk and pressure angle over one cam angle axis",
            picture=True, least=(250, 540), help="tour#Plots, in the tasks", short="Motion"),
        "displacement": _plot("Displacement", ("displacement", "elastic_displacement"),
            "&Displacement", "Plot the displacement over the cam angle", short="Displ."),
        "velocity": _plot("Velocity", ("velocity",), "&Velocity", "Plot the velocity over the cam angle", short="Vel."),
        "acceleration": _plot("Acceleration", ("acceleration", "elastic_acceleration"),
            "&Acceleration", "Plot the acceleration over the cam angle", short="Accel."),
        "jerk": _plot("Jerk", ("jerk",), "&Jerk", "Plot the jerk over the cam angle"),
        "pressure_angle": _plot("Pressure angle", ("pressure_angle", "second_pressure_angle"),
            "&Pressure angle", "Plot the pressure angle over the cam angle", help="followers#Limits and checks", short="Pr. angle"),
        "curvature": _plot("Curvature", ("pitch_curvature", "profile_curvature", "outer_curvature", "second_profile_curvature"),
            "&Curvature", "Plot the curvature of pitch curve and profile", of_cam=True, help="followers#Limits and checks"),
        "torque": _plot("Torque", ("drive_torque", "motor_torque", "linear_motor_torque"),
            "&Torque", "Plot the torque at the camshaft, with and without flywheel", help="tour#Plots, in the tasks"),
        "camshaft_speed": _plot("Camshaft speed", ("camshaft_speed",),
            "Camshaft &speed", "Plot the camshaft speed over the cam angle, smoothed by the flywheel", help="tour#Camshaft speed",
            short="Speed"),
        "contact_force": _plot("Contact force", ("contact_force", "second_contact_force", "elastic_contact_force"),
            "&Contact force", "Plot the force between follower and cam", help="tour#Plots, in the tasks", short="Force"),
        "contact_pressure": _plot("Contact pressure", ("contact_pressure", "second_contact_pressure"),
            "Contact &pressure", "Plot the Hertz pressure between follower and cam, and the allowable pressure", of_cam=True,
            help="followers#Contact pressure and rolling life", short="Pressure"),
        "shaft_torque": ViewRow("Shaft torque", lazily("shaft", "ShaftTorqueView"), RIGHT,
            "Shaft tor&que", "Plot the total torque of all drives, with flywheel and balance cam", least=(250, 250), picture=True,
            help="camshaft#Shaft torque", short="Sh. torque"),
        "shaft_figures": ViewRow("Shaft figures", lazily("shaft", "ShaftFiguresView"), RIGHT,
            "Shaft fig&ures", "Show the true speed of the shaft, and mean, RMS and peak torque and power of all drives",
            least=(380, 142), picture=True,
            help="camshaft#Shaft figures", short="Figures"),
        "against_speed": ViewRow("Torque against speed", lazily("shaft", "AgainstSpeedView"), RIGHT,
            "Torque agai&nst speed", "Plot torque and speed fluctuation of the shaft against the machine's speed",
            least=(250, 310), picture=True,
            help="camshaft#Torque against speed", short="Over speed"),
        "servo": ViewRow("Cam or servo", lazily("shaft", "ServoView"), CENTRE,
            "Ca&m or servo", "Compare a cam with flywheel and a servo: torque, operating points of the motor, energy",
            least=(480, 260), picture=True,
            help="controllers#The motor", short="Servo"),
        "findings": ViewRow("Findings", lazily("findings", "FindingsView"), BOTTOM, least=(300, 110), help="tour#also behind their number"),
        "certificate": ViewRow("Certificate", lazily("findings", "CertificateView"), BOTTOM, least=(300, 110),
            help="tour#the residuals that prove the results", short="Certif."),
        "timing": ViewRow("Timing", lazily("timing_view", "TimingView"), BOTTOM,
            "T&iming chart", "Show the motions of all drives over the machine angle, with sequence conditions",
            least=(690, 200), picture=True,
            help="timing#By mouse"),
        "clearance": ViewRow("Clearances", lazily("linkage.clearance_view", "ClearanceView"), BOTTOM,
            "Clearances of bodi&es", "Give bodies their outlines, and list the least clearances of all pairs over the turn",
            least=(620, 200), help="clearance#Outlines", short="Clear."),
        "contact": ViewRow("Keeping contact", lazily("graph.flywheel_view", "ContactView"), RIGHT,
            "&Keeping contact", "Map the contact force over angle and speed, and plot the lift-off of the follower",
            least=(250, 262), of_cam=True,
            help="finding#Keeping contact", short="Contact"),
        "vibration": ViewRow("Response spectrum", lazily("graph.flywheel_view", "VibrationView"), RIGHT,
            "Resp&onse spectrum", "Plot the vibration of an elastic follower in its dwells, at the design speed and against speed",
            picture=True, least=(250, 262), of_cam=True, help="followers#Elastic follower", short="Spectrum"),
        "valve_figures": ViewRow("Valve figures", lazily("valves.figures", "ValveFiguresView"), RIGHT,
            "&Valve figures", "List durations, overlap, velocities, springs, float speed and piston clearance of both valves",
            picture=True, least=(360, 200), help="valves#From the card to both valves", short="Valves"),
        "valve_springs": ViewRow("Valve springs", lazily("valves.spring_view", "SpringView"), RIGHT,
            "Valve sprin&gs", "Plot the force of the valve springs with surge, and the engine speeds at which they resonate",
            picture=True, least=(250, 262), help="valves#Valve springs in Dyna", short="Springs"),
        "compare": ViewRow("What changed", lazily("compare", "CompareView"), BOTTOM,
            "&What changed", "Compare inputs and results with the pinned variant, largest change first",
            least=(480, 200), help="tour#What changed", short="Changed"),
        "explain": ViewRow("Explain", lazily("compare", "ExplainView"), RIGHT,
            "&Explain a number", "Show the equation of the selected value, and each symbol with its value and origin", least=(480, 330),
            help="tour#Explain a number"),
        "flywheel": ViewRow("Flywheel", lazily("graph.flywheel_view", "FlywheelView"), BOTTOM,
            "Fly&wheel", "Calculate the flywheel that limits the speed fluctuation", least=(280, 200), help="tour#how large it must be"),
    }
)  # fmt: skip
"""Every view by the name that menus and ``show_view`` use."""

PLAYER_BAR = lazily("window.player_bar", "PlayerBar")


def least_size(row: tuple[int, int], view: View | None) -> tuple[int, int]:
    """Return the least size of a view [pixels]: that of its row of ``VIEWS``, or more where its content needs it."""
    hint = QSize() if view is None or view.arranges_itself else view.minimumSizeHint()
    return max(row[0], hint.width()), max(row[1], hint.height())


# -- docks -----------------------------------------------------------------------------------------------


class Dock(QDockWidget):
    """A dock whose view is created when it is first visible.

    Signals
    - seen: the view has become visible, or hidden
    - need_changed: its content needs another height
    """

    seen = Signal()
    need_changed = Signal()

    def __init__(self, name: str, row: ViewRow, make: Callable[[], View], window: QMainWindow) -> None:
        super().__init__(row.title, window)  # without a parent it would float until it is laid out
        self.setObjectName(name)
        self._row, self._make = row, make
        self.title = row.title
        """Full title; the window title, which its tab shows, may be shorter."""
        self.view: View | None = None  # None while it has not been created
        self._paused = False
        self._least = row.least
        self._heights = {
            True: (0, False),
            False: (0, False),
        }  # of the content in a row, and in a column, once laid out there
        self._missed: Need | None = None  # what there was no room for, when the content last changed
        self._soon = single_shot(self, self.wake)
        self.visibilityChanged.connect(self._visibility_changed)

    def build(self) -> View:
        """Return the view, created at the first call."""
        if self.view is None:
            self.view = self._make()
            if hasattr(self.view, "height_requested"):
                self.view.height_requested.connect(self._note_height)
            self.setWidget(self.view)
        return self.view

    def _note_height(self, least: int, is_all: bool) -> None:
        """Note the height that the content needs, and that it needs no more where this shows all of it."""
        if (least, is_all) != self._heights[self._is_in_row]:
            self._heights[self._is_in_row] = least, is_all
            self.need_changed.emit()

    @property
    def _is_in_row(self) -> bool:
        window = self.parent()
        return isinstance(window, QMainWindow) and window.dockWidgetArea(self) in ROWS

    def need(self) -> Need:
        """Return the size that the view needs."""
        in_row, in_column = (self._heights[place] for place in (True, False))
        width, height = least_size((self._least[0], in_column[0] or in_row[0] or self._least[1]), self.view)
        row_height = least_size((0, in_row[0] or in_column[0] or self._least[1]), self.view)[1]
        most = ANY_HEIGHT
        if self._heights[self._is_in_row][1]:
            most = row_height if self._is_in_row else height
        return Need(width, height, most, self._tab_width(), row_height)

    def event(self, event: QEvent) -> bool:
        if event.type() == QEvent.Type.LayoutRequest and self.view is not None and is_in_sight(self):
            need = self.need()
            height = need.row_height if self._is_in_row else need.height
            is_small = need.width > self.view.width() or height > self.view.height()
            if is_small and need != self._missed:
                self._missed = need  # once: there may be no room for it
                self.need_changed.emit()
        return super().event(event)

    @property
    def short_title(self) -> str:
        """Title where its tab has little room; one that the design gives has no shorter one."""
        return self._row.short_title if self.title == self._row.title else self.title

    def _tab_width(self) -> int:
        return self.fontMetrics().horizontalAdvance(self.short_title) + TAB

    def wake(self) -> None:
        """Make or update the view if any part of the dock is visible."""
        if is_in_sight(self) and not self._paused:
            self.build().wake()
        self.seen.emit()

    def pause(self, on: bool) -> None:
        """Make no view until called with False: the drawing is shown first."""
        self._paused = on
        if not on:
            self._soon.start()

    def _visibility_changed(self, visible: bool) -> None:
        # whether it is in front is known once the tabs are laid out
        self._soon.start()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the title in the current font; Qt would keep the font from when the dock was created."""
        painter = QStylePainter(self)
        if self.isFloating():
            frame = QStyleOptionFrame()
            frame.initFrom(self)
            painter.drawPrimitive(QStyle.PrimitiveElement.PE_FrameDockWidget, frame)
        if self.titleBarWidget() is None:
            title = QStyleOptionDockWidget()
            self.initStyleOption(title)
            painter.setFont(self.font())
            painter.drawControl(QStyle.ControlElement.CE_DockWidgetTitle, title)
        painter.end()

    def show_title(self, on: bool) -> None:
        """Show or hide the title; a tab with the same text makes it unnecessary."""
        blank: Any = self.titleBarWidget()  # an empty widget in place of the title, or None
        if on and blank is not None:
            self.setTitleBarWidget(None)  # type: ignore[arg-type]
            blank.deleteLater()
        elif not on and blank is None:
            self.setTitleBarWidget(QWidget())
