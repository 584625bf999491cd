"""Graph."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

from PySide6.QtCore import QEvent, QObject, QSize, Qt, QTimer
from PySide6.QtGui import QAction, QKeyEvent, QPainter, QPaintEvent, QPalette, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QButtonGroup, QGridLayout, QHBoxLayout, QScrollArea, QSplitter, QToolButton, QWidget

from core.errors import KindynaError
from core.frozen import frozen
from core.motion.extremes import Extremes
from core.output.channels import channels
from core.study import Quantity, Study
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.graph_choice import USUAL_WIDTH, ChannelTree, Choice
from kindyna_gui.graph.live_plot import LivePlot, LivePolar
from kindyna_gui.graph.marked_view import MarkedView
from kindyna_gui.look import icon, text_button
from kindyna_gui.pictures.painter import curves_file
from kindyna_gui.pictures.paper.sheets import columns_for, polar_file
from kindyna_gui.pictures.plots.quantities import first_graph, stages_of, why_missing
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player, obey
from kindyna_gui.rebuilt import ContentArea
from kindyna_gui.saving import save_numbers, save_picture

# -- the plots of a graph: their two forms, and the panel that holds one ---------------------------------

LEAST_STRAIGHT, LEAST_POLAR = 118, 280  # height of a plot before the column scrolls, pixels
Plot = LivePlot | LivePolar


@frozen
class PanelForm:
    """Straight or polar: name, tip, a plot of the form, and the file of a picture."""

    label: str
    tip: str
    make: Callable[[int, int], Plot]
    file: Callable[..., bytes]
    least: int
    columns: Callable[[int, float, float], int]


FORMS: Mapping[str, PanelForm] = MappingProxyType(
    {
        "straight": PanelForm(
            "Straight", "The cam angle along, the value upwards",
            lambda i, n: LivePlot(names=i == 0, angles=i == n - 1), curves_file, LEAST_STRAIGHT, lambda *_: 1,
        ),
        "polar": PanelForm(
            "Polar", "The cam angle round about, the value outwards",
            lambda i, n: LivePolar(), polar_file, LEAST_POLAR, columns_for,
        ),
    }
)  # fmt: skip


class Panel(QWidget):
    """One plot with a button that takes it away; a bar on its left where it takes what is ticked next."""

    BAR = 3

    def __init__(self, plot: Plot, take_away: Callable[[], None]) -> None:
        super().__init__()
        self.plot, self.active = plot, False
        row = QHBoxLayout(self)
        row.setContentsMargins(self.BAR + 1, 0, 0, 0)
        row.addWidget(plot)
        self.close_button = QToolButton(self, autoRaise=True)
        self.close_button.setIcon(icon("close"))
        self.close_button.setIconSize(QSize(12, 12))
        self.close_button.setToolTip("Take this plot away")
        self.close_button.setAccessibleName("Take this plot away")
        self.close_button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.close_button.clicked.connect(take_away)

    def offer_close(self, on: bool) -> None:
        """Whether the button is there; the names of the curves stay clear of it."""
        self.close_button.setVisible(on)
        if isinstance(self.plot, LivePlot):  # a polar one always does
            self.plot.reserve_corner(float(self.close_button.sizeHint().width()) if on else 0.0)

    def name_angle(self, study: Study) -> None:
        """Cam angle or driver angle, also where no curve is drawn."""
        if isinstance(self.plot, LivePlot):
            self.plot.name_angle(study)

    @property
    def lacks_extremes(self) -> bool:
        """Whether other curves are drawn than those whose extremes were shown last."""
        return self.plot.lacks_extremes

    def show_extremes(self, found: Mapping[str, Extremes] | None) -> None:
        """Mark them."""
        self.plot.show_extremes(found)

    def set_active(self, on: bool) -> None:
        self.active = on
        self.update()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        size = self.close_button.sizeHint()
        self.close_button.setGeometry(self.width() - size.width(), 0, size.width(), size.height())
        self.close_button.raise_()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().base())
        if self.active:
            painter.fillRect(0, 2, self.BAR, self.height() - 4, SCREEN.chosen)
        painter.end()


# -- graph view ------------------------------------------------------------------------------------------

EMPTY = "Tick channels in the tree on the left to draw them here"
TREE_SHARE = 0.4  # of the width, at most


class GraphView(MarkedView):
    """The page of the graph."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.choice, self.form = Choice(), "straight"
        self.tree = ChannelTree()
        self.panels: list[Panel] = []
        self._rows: dict[str, Quantity] = {}
        self._reasons: dict[str, str] = {}
        self._built: tuple[object, ...] = ()
        self._shared = False
        self._paper = ContentArea(session, player)
        self._paper.setBackgroundRole(QPalette.ColorRole.Base)
        self._paper.setAutoFillBackground(True)
        self.area = QScrollArea(widgetResizable=True)
        self.area.setFrameShape(QScrollArea.Shape.NoFrame)
        self.area.setWidget(self._paper)
        self.area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.area.viewport().installEventFilter(self)
        self._parted = parted = QSplitter(Qt.Orientation.Horizontal, childrenCollapsible=True)
        parted.addWidget(self.tree)
        parted.addWidget(self.area)
        parted.setStretchFactor(1, 1)
        self.set_column(self._tools(), parted, grows=parted)
        self._in_sight = QTimer(self, singleShot=True, interval=0)
        self._in_sight.timeout.connect(self._show_active)
        self.tree.ticked.connect(self._ticked)

    def _tools(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setContentsMargins(6, 3, 6, 3)
        row.setSpacing(3)
        self.add_button = self._button("Add plot", "An empty plot that takes what is ticked next", "add")
        self.add_button.clicked.connect(self.add_plot)
        row.addWidget(self.add_button)
        row.addSpacing(8)
        self.form_buttons: dict[str, QToolButton] = {}
        group = QButtonGroup(self)
        for name, form in FORMS.items():
            button = self._button(form.label, form.tip, "graph" if name == "straight" else name)
            button.setCheckable(True)
            button.setChecked(name == self.form)
            button.clicked.connect(partial(self.set_form, name))
            group.addButton(button)
            row.addWidget(button)
            self.form_buttons[name] = button
        row.addStretch(1)
        for text, tip, slot in (
            ("Picture...", "Write the plots as PNG or SVG", self.export_picture),
            ("Numbers...", "Write the channels shown as a CSV table", self.export_numbers),
        ):
            button = self._button(text, tip, "export")
            button.clicked.connect(slot)
            row.addWidget(button)
        return row

    def _button(self, text: str, tip: str, picture: str) -> QToolButton:
        button = text_button(text, flat=True)
        button.setIcon(icon(picture))
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        button.setToolTip(tip)
        button.setStatusTip(tip)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Those that the channels shown need, and no others."""
        return stages_of(self.choice.chosen)

    # -- what is shown ------------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        rows = channels(study.design)
        self._rows = {row.name: row for row in rows}
        self.choice.keep(self._rows)
        if study.by_crank and not self.choice.chosen:
            self.choice = Choice(first_graph(study))
        if not self.choice.plots:  # a graph without a plot would not say how to fill it
            self.choice.add()
        self._reasons = {}
        for name in self.choice.chosen:
            try:
                self._rows[name].values(study)
            except KindynaError:
                self._reasons[name] = why_missing(study, self._rows[name])
        self.tree.show_rows(rows, self._reasons)
        self._rebuild()
        for panel, names in zip(self.panels, self.choice.plots, strict=True):
            drawable = [self._rows[name] for name in names if name not in self._reasons]
            panel.name_angle(study)
            if drawable:
                panel.plot.set_curves(study, drawable, bands=self.bands.read(drawable))
            else:
                panel.plot.show_message("\n".join(self._reasons[name] for name in names) or EMPTY)
        self.look_for_extremes(study)

    def lacking(self, study: Study) -> list[Quantity]:
        return self.drawn if any(panel.lacks_extremes for panel in self.panels) else []

    def show_extremes(self, found: Mapping[str, Extremes] | None) -> None:
        for panel in self.panels:
            panel.show_extremes(found)

    def follow(self, theta: float) -> None:
        self.extremes.resume()
        if self.drawn:
            at_angle = self.session.at(theta)
            for panel in self.panels:
                panel.plot.set_angle(theta, at_angle)

    @property
    def drawn(self) -> list[Quantity]:
        """The channels that are drawn, in the order of the plots."""
        return [self._rows[name] for name in self.choice.chosen if name in self._rows and name not in self._reasons]

    def _rebuild(self) -> None:
        """Make the plots anew where their number or form has changed; mark the active one, tick the tree."""
        count = len(self.choice.plots)
        wanted = (self.form, count)
        if wanted != self._built:
            paper = QWidget()
            self._grid = QGridLayout(paper)
            self._grid.setContentsMargins(0, 4, 4, 4)
            self._grid.setSpacing(2)
            self.panels = [self._panel(i, count) for i in range(count)]
            self._built = wanted
            self._lay()
            self._paper.replace(paper)
        for index, panel in enumerate(self.panels):
            panel.set_active(count > 1 and index == self.choice.active)
        self.tree.show_ticks(self.choice.chosen)

    def _panel(self, index: int, count: int) -> Panel:
        plot = FORMS[self.form].make(index, count)
        panel = Panel(plot, partial(self.remove_plot, index))
        panel.offer_close(count > 1)
        plot.angle_moved.connect(self._turn)
        plot.installEventFilter(self)
        (plot.viewport() if isinstance(plot, LivePlot) else plot).installEventFilter(self)
        plot.setMinimumHeight(FORMS[self.form].least)
        self.offer_deeds(plot, partial(self._rows_of, index))
        for text, slot in (("Export picture...", self.export_picture), ("Export numbers...", self.export_numbers)):
            action = QAction(text, plot)
            action.triggered.connect(slot)
            plot.addAction(action)
        plot.addAction(self.marks)
        if isinstance(plot, LivePlot):
            plot.addAction(plot.whole_action)
        return panel

    def _rows_of(self, index: int) -> list[Quantity]:
        """What a plot shows."""
        names = self.choice.plots[index] if index < len(self.choice.plots) else ()
        return [self._rows[name] for name in names if name in self._rows and name not in self._reasons]

    def _lay(self) -> None:
        """Put the plots into a column, or polar ones into a grid in which they are as large as can be."""
        if not self.panels:
            return
        room = self.area.viewport().size()
        form, count = FORMS[self.form], len(self.panels)
        most = max(1, room.width() // form.least)
        columns = min(form.columns(count, room.width(), room.height()), most)
        grid = self._grid
        for row in range(grid.rowCount()):
            grid.setRowStretch(row, 0)
        for index, panel in enumerate(self.panels):
            grid.addWidget(panel, index // columns, index % columns)
            grid.setRowStretch(index // columns, 1)

    def _changed(self) -> None:
        """The choice has changed: read the channels from the session."""
        self._stale = True
        self.pull()
        self._in_sight.start()

    def _show_active(self) -> None:
        """Scroll to the plot that has just got something, once it has its place."""
        if self.choice.active < len(self.panels):
            self.area.ensureWidgetVisible(self.panels[self.choice.active], 0, 0)

    # -- what the user does -------------------------------------------------------------------------------

    def _ticked(self, name: str, on: bool) -> None:
        if on:
            self.choice.tick(name, {q: row.unit.symbol for q, row in self._rows.items()})
        else:
            self.choice.untick(name)
        self._changed()

    def add_plot(self) -> None:
        """An empty plot."""
        self.choice.add()
        self._changed()

    def remove_plot(self, index: int) -> None:
        """Take a plot away."""
        self.choice.remove(index)
        self._changed()

    def set_form(self, name: str) -> None:
        """``straight`` or ``polar``."""
        self.form = name
        self.form_buttons[name].setChecked(True)
        self._changed()

    def _turn(self, theta: float) -> None:
        self.player.play(False)
        self.player.set_theta(theta)

    def _choose_plot(self, index: int) -> None:
        if index != self.choice.active:
            self.choice.active = index
            self._rebuild()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """A click into a plot makes it the active one; another room, another grid."""
        if event.type() == QEvent.Type.MouseButtonPress:
            for index, panel in enumerate(self.panels):
                if isinstance(watched, QWidget) and (panel.plot is watched or panel.plot.isAncestorOf(watched)):
                    self._choose_plot(index)
        elif event.type() == QEvent.Type.Resize and watched is self.area.viewport():
            self._lay()
        return super().eventFilter(watched, event)

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if not self._shared:  # the width is known only now
            self._shared = True
            tree = min(USUAL_WIDTH, round(TREE_SHARE * self.width()))
            self._parted.setSizes([tree, self.width() - tree])

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not obey(self.player, event):
            super().keyPressEvent(event)

    # -- as files -----------------------------------------------------------------------------------------

    def picture(self, ending: str) -> bytes:
        """The plots on paper, without cursor; the page as it is where nothing is drawn."""
        self.pull()
        rows = [self._rows_of(index) for index in range(len(self.choice.plots))]
        shown = [row for row in rows if row]
        if not shown:
            return super().picture(ending)
        bands = self.bands.read([each for row in shown for each in row])
        return FORMS[self.form].file(self.session.study, shown, ending, self.marks.isChecked(), bands)

    def export_picture(self) -> None:
        """Ask for a file, and write the graph into it as a picture."""
        save_picture(self, "graph")

    def export_numbers(self) -> None:
        """Ask for a file, and write the curves into it as a table."""
        if self.drawn:
            save_numbers(self, self.drawn, "graph")
