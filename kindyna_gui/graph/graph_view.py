"""Page Graph: selected channels in plots of their own, straight or polar."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import MappingProxyType

from PySide6.QtCore import QEvent, QObject, QSize, Qt, QTimer
from PySide6.QtGui import QPainter, QPaintEvent, QPalette, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QButtonGroup, QGridLayout, QHBoxLayout, QScrollArea, QSplitter, QToolButton, QWidget

from core.errors import KindynaError
from core.frozen import frozen
from core.motion.extremes import Extremes
from core.output.channels import channels
from core.study import Quantity, Study
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.graph_choice import DEFAULT_WIDTH, ChannelTree, PlotSelection
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.graph.live_polar import LivePolar
from kindyna_gui.graph.marked_view import PlotsView
from kindyna_gui.look import icon, text_button
from kindyna_gui.pictures.painter import curves_file
from kindyna_gui.pictures.paper.sheets import columns_for, polar_file
from kindyna_gui.pictures.plots.curves import TurnCurves
from kindyna_gui.pictures.plots.quantities import first_graph, needs_flywheel, stages_of, why_missing
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import ContentArea
from kindyna_gui.saving import save_numbers, save_picture

LEAST_STRAIGHT, LEAST_POLAR = 144, 280  # height of a plot before the column scrolls, pixels
EMPTY = "Tick channels in the tree on the left to draw them here"
TREE_SHARE = 0.45  # of the width, at most
Plot = LivePlot | LivePolar

# -- straight and polar plots ----------------------------------------------------------------------------


@frozen
class PanelForm:
    """Form of the plots: how to construct one, how to write them to a file, and their arrangement."""

    label: str
    tip: str
    make: Callable[[int, int], Plot]
    file: Callable[..., bytes]
    least: int
    columns: Callable[[int, float, float], int]


FORMS: Mapping[str, PanelForm] = MappingProxyType(
    {
        "straight": PanelForm(
            "Straight", "Values over the cam angle",
            lambda i, n: LivePlot(names=i == 0, angles=i == n - 1), curves_file, LEAST_STRAIGHT, lambda *_: 1,
        ),
        "polar": PanelForm(
            "Polar", "Values as distances from the centre, the cam angle as direction",
            lambda i, n: LivePolar(), polar_file, LEAST_POLAR, columns_for,
        ),
    }
)  # fmt: skip


class Panel(QWidget):
    """A plot with a button that removes it; a bar on the left marks the active plot."""

    BAR = 3

    def __init__(self, plot: Plot, remove: Callable[[], None]) -> None:
        super().__init__()
        self.plot, self.active = plot, False
        row = QHBoxLayout(self)
        row.setContentsMargins(self.BAR + 1, 0, 0, 0)
        row.addWidget(plot)
        self.close_button = QToolButton(self, autoRaise=True)
        self.close_button.setIcon(icon("close"))
        self.close_button.setIconSize(QSize(12, 12))
        self.close_button.setToolTip("Remove this plot")
        self.close_button.setAccessibleName("Remove this plot")
        self.close_button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.close_button.clicked.connect(remove)

    def offer_close(self, on: bool) -> None:
        """Show or hide the button; the names of the curves do not overlap it."""
        self.close_button.setVisible(on)
        if isinstance(self.plot, LivePlot):  # in a polar plot they never overlap
            self.plot.reserve_corner(float(self.close_button.sizeHint().width()) if on else 0.0)

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


# -- page ------------------------------------------------------------------------------------------------


class GraphView(PlotsView):
    """The page Graph: the tree of channels, and the plots."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.selection, self.form = PlotSelection(), "straight"
        self.tree = ChannelTree()
        self.panels: list[Panel] = []
        self._rows: dict[str, Quantity] = {}
        self._reasons: dict[str, str] = {}
        self._built: tuple[object, ...] = ()  # form and number of the plots
        self._has_sizes = False
        self._is_by_hand = False  # whether the user has set the width of the tree
        self._paper = ContentArea(session, player)
        self._paper.setBackgroundRole(QPalette.ColorRole.Base)
        self._paper.setAutoFillBackground(True)
        self.area = QScrollArea(widgetResizable=True)
        self.area.setFrameShape(QScrollArea.Shape.NoFrame)
        self.area.setWidget(self._paper)
        self.area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.area.viewport().installEventFilter(self)
        self._splitter = QSplitter(Qt.Orientation.Horizontal, childrenCollapsible=True)
        self._splitter.addWidget(self.tree)
        self._splitter.addWidget(self.area)
        self._splitter.setStretchFactor(1, 1)
        self._splitter.splitterMoved.connect(self._note_by_hand)
        self.set_column(self._tools(), self._splitter, grows=self._splitter)
        self._scroll_timer = QTimer(self, singleShot=True, interval=0)
        self._scroll_timer.timeout.connect(self._show_active)
        self.tree.ticked.connect(self._ticked)

    def _tools(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setContentsMargins(6, 3, 6, 3)
        row.setSpacing(3)
        self.add_button = self._button("Add plot", "Add an empty plot for the next channel that you tick", "add")
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
            ("Picture...", "Write the plots as an image, PNG or SVG", self.export_picture),
            ("Numbers...", "Write the channels on display as a CSV table", self.export_numbers),
        ):
            button = self._button(text, tip, "export")
            button.clicked.connect(slot)
            row.addWidget(button)
        return row

    def _button(self, text: str, tip: str, icon_name: str) -> QToolButton:
        button = text_button(text, flat=True)
        button.setIcon(icon(icon_name))
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        button.setToolTip(tip)
        button.setStatusTip(tip)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Stages that the channels on display need."""
        return stages_of(self.selection.quantities)

    @property
    def is_slow(self) -> bool:
        return needs_flywheel(self.session.study, self.selection.quantities)

    def turn_plots(self) -> Sequence[TurnCurves]:
        return [panel.plot for panel in self.panels]

    # -- display ------------------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        rows = channels(study.design)
        self._rows = {row.name: row for row in rows}
        self.selection.restrict_to(self._rows)
        if study.by_crank and not self.selection.quantities:
            self.selection = PlotSelection(first_graph(study))
        if not self.selection.plots:  # an empty plot says how to fill it
            self.selection.add()
        self._reasons = {}
        for name in self.selection.quantities:
            try:
                self._rows[name].values(study)
            except KindynaError:
                self._reasons[name] = why_missing(study, self._rows[name])
        if self.tree.show_rows(rows, self._reasons) and not self._is_by_hand:
            self._share_width()
        self._rebuild()
        for panel, names in zip(self.panels, self.selection.plots, strict=True):
            drawable = self._drawable(names)
            if isinstance(panel.plot, LivePlot):  # also where no curve is drawn
                panel.plot.name_angle(study)
            if drawable:
                panel.plot.set_curves(study, drawable, **self.companions(drawable))
            else:
                panel.plot.show_message("\n".join(self._reasons[name] for name in names) or EMPTY)
        self.request_extremes(study)

    def lacking(self, study: Study) -> list[Quantity]:
        return self.drawn if any(panel.plot.lacks_extremes for panel in self.panels) else []

    def show_extremes(self, extremes: Mapping[str, Extremes] | None) -> None:
        for panel in self.panels:
            panel.plot.show_extremes(extremes)

    def follow(self, theta: float) -> None:
        self.extremes.resume()
        if self.drawn:
            at_angle = self.session.at(theta)
            for panel in self.panels:
                panel.plot.set_angle(theta, at_angle)

    @property
    def drawn(self) -> list[Quantity]:
        """Channels that are drawn, in the order of the plots."""
        return self._drawable(self.selection.quantities)

    def _drawable(self, names: Sequence[str]) -> list[Quantity]:
        return [self._rows[name] for name in names if name in self._rows and name not in self._reasons]

    def _rebuild(self) -> None:
        """Create the plots if their number or form has changed; mark the active one, tick the tree."""
        count = len(self.selection.plots)
        if (self.form, count) != self._built:
            paper = QWidget()
            self._grid = QGridLayout(paper)
            self._grid.setContentsMargins(0, 4, 4, 4)
            self._grid.setSpacing(2)
            self.panels = [self._panel(i, count) for i in range(count)]
            self._built = self.form, count
            self._arrange()
            self._paper.replace(paper)
        for index, panel in enumerate(self.panels):
            panel.active = count > 1 and index == self.selection.active
            panel.update()
        self.tree.show_ticks(self.selection.quantities)

    def _panel(self, index: int, count: int) -> Panel:
        plot = FORMS[self.form].make(index, count)
        panel = Panel(plot, partial(self.remove_plot, index))
        panel.offer_close(count > 1)
        plot.installEventFilter(self)
        (plot.viewport() if isinstance(plot, LivePlot) else plot).installEventFilter(self)
        plot.setMinimumHeight(FORMS[self.form].least)
        exports = ("Export picture...", self.export_picture), ("Export numbers...", self.export_numbers)
        self.offer_actions(plot, partial(self._rows_of, index), exports)
        return panel

    def _rows_of(self, index: int) -> list[Quantity]:
        """Channels drawn in a plot."""
        return self._drawable(self.selection.plots[index] if index < len(self.selection.plots) else ())

    def _arrange(self) -> None:
        """Arrange the plots in a column, polar ones in the grid in which they are largest."""
        if not self.panels:
            return
        size = self.area.viewport().size()
        form, count = FORMS[self.form], len(self.panels)
        most = max(1, size.width() // form.least)
        columns = min(form.columns(count, size.width(), size.height()), most)
        grid = self._grid
        for row in range(grid.rowCount()):
            grid.setRowStretch(row, 0)
        for index, panel in enumerate(self.panels):
            grid.addWidget(panel, index // columns, index % columns)
            grid.setRowStretch(index // columns, 1)

    def _changed(self) -> None:
        """Refresh after a change of the selection, and scroll to the active plot."""
        self._stale = True
        self.pull()
        self._scroll_timer.start()

    def _show_active(self) -> None:
        """Scroll to the active plot, once the plots are arranged."""
        if self.selection.active < len(self.panels):
            self.area.ensureWidgetVisible(self.panels[self.selection.active], 0, 0)

    # -- input --------------------------------------------------------------------------------------------

    def _ticked(self, name: str, on: bool) -> None:
        if on:
            self.selection.tick(name, {key: row.unit.symbol for key, row in self._rows.items()})
        else:
            self.selection.untick(name)
        self._changed()

    def add_plot(self) -> None:
        """Add an empty plot."""
        self.selection.add()
        self._changed()

    def remove_plot(self, index: int) -> None:
        """Remove a plot."""
        self.selection.remove(index)
        self._changed()

    def set_form(self, name: str) -> None:
        """Set the form of the plots, ``straight`` or ``polar``."""
        self.form = name
        self.form_buttons[name].setChecked(True)
        self._changed()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Activate the plot that is clicked; arrange the plots after a change of size."""
        if event.type() == QEvent.Type.MouseButtonPress:
            for index, panel in enumerate(self.panels):
                is_clicked = isinstance(watched, QWidget) and (
                    panel.plot is watched or panel.plot.isAncestorOf(watched)
                )
                if is_clicked and index != self.selection.active:
                    self.selection.active = index
                    self._rebuild()
        elif event.type() == QEvent.Type.Resize and watched is self.area.viewport():
            self._arrange()
        return super().eventFilter(watched, event)

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if not self._has_sizes:  # the width is not known before
            self._has_sizes = True
            self._share_width()

    def _note_by_hand(self, *_: int) -> None:
        self._is_by_hand = True

    def _share_width(self) -> None:
        """Give the tree the width of its names, or its share."""
        tree_width = min(max(DEFAULT_WIDTH, self.tree.full_width), round(TREE_SHARE * self.width()))
        self._splitter.setSizes([tree_width, self.width() - tree_width])

    # -- export -------------------------------------------------------------------------------------------

    def picture(self, ending: str) -> bytes:
        """Return the plots without the cursor, or the page if nothing is drawn, as the content of a file."""
        self.pull()
        rows = [self._rows_of(index) for index in range(len(self.selection.plots))]
        shown = [row for row in rows if row]
        if not shown:
            return super().picture(ending)
        return FORMS[self.form].file(self.session.study, shown, ending, self.marks.isChecked(), self.companions)

    def export_picture(self) -> None:
        """Ask for a file, and write the plots to it as an image."""
        save_picture(self, "graph")

    def export_numbers(self) -> None:
        """Ask for a file, and write the curves to it as a table."""
        if self.drawn:
            save_numbers(self, self.drawn, "graph")
