"""Every question that stops the window, in one place, so that tests can answer in the user's stead."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import QDialogButtonBox, QFileDialog, QInputDialog, QMessageBox, QPushButton, QWidget

from core.bounds import BYTES
from core.errors import KindynaError
from core.project.files import read_bytes
from core.project.recovery import Recoverable
from kindyna_gui.settings import Settings

A = TypeVar("A")

if TYPE_CHECKING:
    from kindyna_gui.documents.texts import OnRecovery

DESIGNS = {".toml": "Designs"}
PICTURES = {".png": "PNG picture", ".svg": "SVG drawing"}
TABLES = {".csv": "Table"}
PDF = {".pdf": "PDF"}
SVG = {".svg": "SVG drawing"}
REPORTS = {".txt": "Text", ".pdf": "PDF", ".html": "HTML"}
GRAPH_FILES = "Tables and designs (*.csv *.txt *.dat *.tsv *.toml)"
MOTION_FILES = "Tables and designs (*.csv *.txt *.dat *.tsv *.xlsx *.ods *.toml)"
GRAPHS = "Graph (*.graph.json)"
HELP, FIELD = "help page", "field path"
"""Properties of widgets: the page of ``resources/help`` on them, and the path of the value that is typed there."""
MOST_LINES = 12  # of faults before the rest goes under Details


class SaveAnswer(Enum):
    """To the question whether changes shall be saved."""

    SAVE = "save"
    DISCARD = "discard"
    CANCEL = "cancel"


class OnConflict(Enum):
    """What to do where another program has changed the file that is to be saved to."""

    RELOAD = "reload"
    SAVE_AS = "save as"
    OVERWRITE = "overwrite"
    CANCEL = "cancel"


class Unfinished(Enum):
    """What to save where the values do not fit together."""

    CLOSE = "close"
    AS_TYPED = "as typed"
    LAST_FITTING = "last that fits"
    CANCEL = "cancel"


class OnShaft(Enum):
    """On which shaft of several drives a design shall be put."""

    NEW = "a new one"
    FILE = "that of a file"
    CANCEL = "cancel"


def help_on(widget: QWidget) -> tuple[str, str]:
    """The page of the help on a widget, and the words to look for there: of a field the page of all fields, at its path."""
    at: QWidget | None = widget
    while at is not None:
        if path := at.property(FIELD):
            return "fields", str(path)
        if found := at.property(HELP):
            page, _, words = str(found).partition("#")
            return page, words
        at = None if at.isWindow() else at.parentWidget()
    return "tour", ""


def give_help(dialog: QWidget, page: str) -> None:
    """Let F1 in a dialog, or another window, open its page of the help, at the words behind #, over it: a dialog keeps all other windows
    from the user."""

    def open() -> None:
        from kindyna_gui.help import HelpWindow

        found = dialog.findChild(HelpWindow) or HelpWindow(dialog)
        found.open(*help_on(dialog.focusWidget() or dialog))

    dialog.setProperty(HELP, page)
    QShortcut(QKeySequence(QKeySequence.StandardKey.HelpContents), dialog).activated.connect(open)


def file_to_save(parent: QWidget, suggestion: Path, title: str, kinds: Mapping[str, str]) -> Path | None:
    """The file to save to, None where the user cancels; kinds: its endings, each with what files of it are called."""
    filters = ";;".join(f"{what} (*{ending})" for ending, what in kinds.items())
    name, chosen = QFileDialog.getSaveFileName(parent, title, str(suggestion), filters)
    ending = next((ending for ending in kinds if f"(*{ending})" in chosen), next(iter(kinds)))
    return with_suffix(parent, name, ending, tuple(kinds))


Save = Callable[[QWidget, Path], Path | None]
"""Asks for a file to save to, of the window in front and the file suggested; None where the user cancels."""


def _save(title: str, kinds: Mapping[str, str]) -> Save:
    return lambda parent, suggestion: file_to_save(parent, suggestion, title, kinds)


design_to_save = _save("Save design as", DESIGNS)
picture_to_save = _save("Export picture", PICTURES)
figure_to_save = _save("Save figure", {**PICTURES, **TABLES})
graph_picture_to_save = _save("Export picture", {**PICTURES, **PDF})
table_to_save = _save("Export numbers", TABLES)
page_to_save = _save("Export web page", {".html": "Web page"})
handover_to_save = _save("Hand-over", {".zip": "Archive of all files"})
comparison_to_save = _save("Save comparison", {".html": "Web page", **TABLES})
inspection_to_save = _save("Export inspection table", TABLES)
drawing_to_save = _save("Export drawing", {**PDF, **SVG})
timing_to_save = _save("Export timing chart", {**PDF, **SVG, ".png": "PNG picture", ".csv": "Table of events"})


def links_to_save(parent: QWidget, suggestion: Path, table: bool = False) -> Path | None:
    """The file to save a pose, or the curves of points, to; table: as CSV, too."""
    kinds = {".csv": "Table"} if table else {}
    return file_to_save(parent, suggestion, "Export links", {**kinds, ".dxf": "DXF drawing", ".svg": "SVG drawing"})


def profile_to_save(parent: QWidget, suggestion: Path) -> Path | None:
    """The file to save a profile to, with the ending of the suggestion."""
    return file_to_save(parent, suggestion, "Export profile", {suggestion.suffix: "Profile"})


def controller_table_to_save(parent: QWidget, suggestion: Path) -> Path | None:
    """The file to save a controller's table to, with the ending of the suggestion."""
    return file_to_save(parent, suggestion, "Export controller table", {suggestion.suffix: "Table"})


def report_to_save(parent: QWidget, suggestion: Path) -> Path | None:
    """The file to save a report to, with the ending of the suggestion, .txt where it has none."""
    ending = suggestion.suffix if suggestion.suffix in REPORTS else ".txt"
    return file_to_save(parent, suggestion, "Report", {ending: REPORTS[ending]})


def study_to_save(parent: QWidget, suggestion: Path) -> Path | None:
    """Ask for the file of a study."""
    return file_to_save(parent, suggestion, "Save the study", {".toml": "Study"})


def graph_to_save(parent: QWidget, suggestion: Path) -> Path | None:
    """The file to save a graph's curves and axes to, any that ends in .json."""
    name, _ = QFileDialog.getSaveFileName(parent, "Save graph", str(suggestion), GRAPHS)
    return with_suffix(parent, name, ".graph.json", (".json",))


Spell = Callable[[A], str]
"""The command that does the same with what stands in a question."""


def _asked(box: QInputDialog, title: str, page: str, given: Callable[[], A], spell: Spell[A] | None = None) -> A | None:
    """What is given in a question, with its page of the help and its command; None where the user cancels."""
    box.setWindowTitle(title)
    give_help(box, page)
    box.sizeHint()  # now it has its buttons
    buttons = box.findChild(QDialogButtonBox)
    if spell is not None and isinstance(buttons, QDialogButtonBox):
        from kindyna_gui.documents.texts import add_copy_of_line

        add_copy_of_line(buttons, lambda: spell(given()))
    value = given() if box.exec() else None
    box.deleteLater()
    return value


def _choice(parent: QWidget, text: str, rows: Sequence[str]) -> QInputDialog:
    """A question for one of some rows."""
    box = QInputDialog(parent)
    box.setComboBoxItems(list(rows))
    box.setLabelText(text)
    return box


def shift_wanted(parent: QWidget, spell: Spell[float]) -> float | None:
    """By how much a motion is shifted [deg], None where the user cancels."""
    box = QInputDialog(parent)
    box.setInputMode(QInputDialog.InputMode.DoubleInput)
    box.setLabelText("The same later by so many degrees of the cam, earlier where negative:")
    box.setDoubleDecimals(6)
    box.setDoubleRange(-360.0, 360.0)
    box.setDoubleValue(10.0)
    return _asked(box, "Shift the motion", "making#Shift the motion by", box.doubleValue, spell)


SEGMENT_FROM = (
    "Stretched to the segment's span and rise, from rest to rest",
    "Stretched, with velocity and acceleration of its neighbours at its ends",
    "With the table's own span and rise, from rest to rest",
    "With its own span and rise, and velocity and acceleration of its neighbours",
)


def segment_wanted(parent: QWidget, spell: Spell[tuple[bool, bool]] | None) -> tuple[bool, bool] | None:
    """How a table becomes a segment: as it is, joined; None where the user cancels."""
    box = _choice(parent, "The table is taken:", SEGMENT_FROM)

    def given() -> tuple[bool, bool]:
        number = SEGMENT_FROM.index(box.textValue())
        return number >= 2, number % 2 == 1

    return _asked(box, "Segment from table", "making#Segment from table", given, spell)


def layout_name_wanted(parent: QWidget, names: Sequence[str]) -> str:
    """The name to keep a layout under, a new one or one of these; empty where the user cancels."""
    box = _choice(parent, "Under the name:", names)
    box.setComboBoxEditable(True)
    box.setTextValue("")
    return (_asked(box, "Save this layout", "tour#Named layouts", box.textValue) or "").strip()


def drive_wanted(parent: QWidget, names: Sequence[str], spell: Spell[str]) -> int | None:
    """Number of the drive whose motion is taken, None where the user cancels."""
    box = _choice(parent, "Of the drive:", names)
    name = _asked(box, "Motion from a design", "making#Motion from a design or file", box.textValue, spell)
    return None if name is None else list(names).index(name)


def design_to_open(parent: QWidget, folder: Path) -> Path | None:
    """The design file to open, None where the user cancels."""
    return file_to_open(parent, "Open design", "Designs (*.toml)", folder)


def motion_files_to_open(parent: QWidget, folder: Path) -> list[Path]:
    """A table, or designs, from which a motion follows; none where the user cancels."""
    names, _ = QFileDialog.getOpenFileNames(
        parent, "Files that the motion follows from", str(folder), f"{MOTION_FILES};;All files (*)"
    )
    return [Path(name) for name in names]


def output_wanted(parent: QWidget, outputs: Mapping[str, str]) -> str | None:
    """The link of a linkage that is to do what the motion says, empty where its own motion is taken; None where the user cancels."""
    rows = {"": "its own motion"} | {
        n: f"its driver's, so that link {n} does this motion ({unit})" for n, unit in outputs.items()
    }
    box = _choice(parent, "Take:", list(rows.values()))

    def given() -> str:
        return next(n for n, row in rows.items() if row == box.textValue())

    return _asked(box, "Motion that follows from a linkage", "making#Motion that follows from files", given)


def graph_to_open(parent: QWidget, folder: Path) -> Path | None:
    """A graph that was saved."""
    return file_to_open(parent, "Open graph", GRAPHS, folder)


def graph_files_to_open(parent: QWidget, folder: Path) -> list[Path]:
    """Tables and designs to be drawn; none where the user cancels."""
    names, _ = QFileDialog.getOpenFileNames(parent, "Files to be drawn", str(folder), f"{GRAPH_FILES};;All files (*)")
    return [Path(name) for name in names]


def with_suffix(parent: QWidget, name: str, suffix: str, allowed: Sequence[str] = ()) -> Path | None:
    """The file's path with an ending, where it has none that is allowed. The dialog has asked about the name as it was typed
    only: a file that has it with the ending is asked about here; None where it shall stay."""
    if not name:
        return None
    path = Path(name)
    if path.suffix.lower() in (allowed or (suffix,)):
        return path
    path = path.with_name(path.name + suffix)
    return path if not path.exists() or ask_to_replace(parent, path.name) else None


def ask_to_replace(parent: QWidget, name: str) -> bool:
    """Whether a file that is there already may be replaced."""
    text, answers = f"{name} already exists.\nDo you want to replace it?", QMessageBox.StandardButton
    return QMessageBox.warning(parent, "KINDYNA", text, answers.Yes | answers.No, answers.No) == answers.Yes


def _box(parent: QWidget, icon: QMessageBox.Icon, text: str, page: str) -> QMessageBox:
    box = QMessageBox(icon, "KINDYNA", text, parent=parent)
    give_help(box, page)
    return box


UNSAVED = "has unsaved changes"


def ask_to_save(parent: QWidget, name: str, state: str = UNSAVED) -> SaveAnswer:
    """Whether a design shall be saved before it is left; ``state`` says what its file lacks."""
    box = _box(parent, QMessageBox.Icon.Question, f"{name} {state}.", "tour#Unsaved work is kept")
    box.setInformativeText("Save them?" if state == UNSAVED else "Save it?")
    buttons = {
        QMessageBox.StandardButton.Save: SaveAnswer.SAVE,
        QMessageBox.StandardButton.Discard: SaveAnswer.DISCARD,
        QMessageBox.StandardButton.Cancel: SaveAnswer.CANCEL,
    }
    for button in buttons:
        box.addButton(button)
    box.setDefaultButton(QMessageBox.StandardButton.Save)
    box.setEscapeButton(QMessageBox.StandardButton.Cancel)
    answer = buttons.get(QMessageBox.StandardButton(box.exec()), SaveAnswer.CANCEL)
    box.deleteLater()
    return answer


def ask_on_conflict(parent: QWidget, name: str, lines: Sequence[str], gone: bool = False) -> OnConflict:
    """What to do with a file that another program has changed, or taken away; lines: what differs between it and the design."""
    text = f"{name} has been {'moved or deleted' if gone else 'changed'} by another program since it was read."
    box = _box(parent, QMessageBox.Icon.Warning, text, "tour#Where another program has changed that file")
    _list(box, lines)
    role = QMessageBox.ButtonRole
    buttons = {
        **({} if gone else {box.addButton("Reload the file", role.DestructiveRole): OnConflict.RELOAD}),
        box.addButton("Save as...", role.AcceptRole): OnConflict.SAVE_AS,
        box.addButton("Write it again" if gone else "Overwrite", role.DestructiveRole): OnConflict.OVERWRITE,
        box.addButton(QMessageBox.StandardButton.Cancel): OnConflict.CANCEL,
    }
    box.setDefaultButton(next(button for button, answer in buttons.items() if answer is OnConflict.SAVE_AS))
    box.setEscapeButton(QMessageBox.StandardButton.Cancel)
    box.exec()
    return _answer(box, buttons, OnConflict.CANCEL)


def _answer(box: QMessageBox, buttons: Mapping[QPushButton, A], cancelled: A) -> A:
    """What was clicked."""
    clicked = box.clickedButton()
    box.deleteLater()
    return next((answer for button, answer in buttons.items() if button is clicked), cancelled)


def ask_on_shaft(parent: QWidget, name: str) -> OnShaft:
    """On which shaft a design of one drive shall be put."""
    text = f"Put {name} on a shaft that turns several drives."
    box = _box(parent, QMessageBox.Icon.Question, text, "camshaft#Add this design to a shaft")
    role = QMessageBox.ButtonRole
    buttons = {
        box.addButton("New shaft", role.AcceptRole): OnShaft.NEW,
        box.addButton("Shaft of a file...", role.AcceptRole): OnShaft.FILE,
        box.addButton(QMessageBox.StandardButton.Cancel): OnShaft.CANCEL,
    }
    box.setEscapeButton(QMessageBox.StandardButton.Cancel)
    box.exec()
    return _answer(box, buttons, OnShaft.CANCEL)


def ask_unfinished(parent: QWidget, lines: Sequence[str], closing: str, as_typed: bool) -> Unfinished:
    """What to save where the values do not fit together; lines: what is amiss; closing: what would close the motion, '' where
    nothing simple does, or it is whole; as_typed: a file can hold what is typed."""
    text = "What is typed does not fit together yet."
    box = _box(parent, QMessageBox.Icon.Question, text, "tour#asks whether to write what is typed")
    close = [f"Close the motion: {closing}."] if closing else []
    typed = [
        "Save as typed: the file can be opened and gone on with, but there is no drawing and no cam until the values fit."
    ]
    last = "Save the last that fits: what was typed since stays in this window, and is not in the file."
    box.setInformativeText("\n".join((*lines, "", *close, *(typed if as_typed else []), last)))
    role = QMessageBox.ButtonRole
    buttons = {box.addButton("Close it and save", role.AcceptRole): Unfinished.CLOSE} if closing else {}
    buttons |= {box.addButton("Save as typed", role.AcceptRole): Unfinished.AS_TYPED} if as_typed else {}
    buttons |= {
        box.addButton("Save the last that fits", role.AcceptRole): Unfinished.LAST_FITTING,
        box.addButton(QMessageBox.StandardButton.Cancel): Unfinished.CANCEL,
    }
    box.setDefaultButton(next(iter(buttons)))
    box.setEscapeButton(QMessageBox.StandardButton.Cancel)
    box.exec()
    return _answer(box, buttons, Unfinished.CANCEL)


def ask_to_recover(parent: QWidget, entries: Sequence[Recoverable]) -> tuple[OnRecovery, Recoverable]:
    """What to do with unsaved work, and with which."""
    from kindyna_gui.documents.texts import RecoveryDialog

    dialog = RecoveryDialog(parent, entries)
    give_help(dialog, "tour#Unsaved work is kept")
    dialog.exec()
    answer = dialog.choice, dialog.chosen
    dialog.deleteLater()
    return answer


def _list(box: QMessageBox, lines: Sequence[str]) -> None:
    """The first lines below the text of a box, where there are many all of them under Details."""
    shown = list(lines[:MOST_LINES])
    if len(lines) > MOST_LINES:
        shown.append(f"... and {len(lines) - MOST_LINES} more")
        box.setDetailedText("\n".join(lines))
    box.setInformativeText("\n".join(shown))
    box.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)


def show_faults(parent: QWidget, what: str, lines: Sequence[str]) -> None:
    """What went wrong, every fault on a line of its own; all of them can be selected and copied."""
    box = _box(parent, QMessageBox.Icon.Warning, what, "tour")
    _list(box, lines)
    box.exec()
    box.deleteLater()


def file_to_open(parent: QWidget, title: str, kinds: str, folder: Path | None = None) -> Path | None:
    """The file to read, asked for in a folder, else in that of the last one; None where the user cancels."""
    where = str(Settings().folder if folder is None else folder)
    name, _ = QFileDialog.getOpenFileName(parent, title, where, f"{kinds};;All files (*)")
    return Path(name) if name else None


def opened_file(parent: QWidget, title: str, kinds: str, most_bytes: int = BYTES) -> tuple[Path, bytes] | None:
    """A file that the user chose, and its bytes; None where there is none, or it cannot be read and the user has been told why."""
    path = file_to_open(parent, title, kinds)
    if path is None:
        return None
    try:
        data = read_bytes(path, most_bytes)
    except KindynaError as error:
        show_faults(parent, f"{path.name} cannot be read.", str(error).splitlines())
        return None
    Settings().folder = path.parent
    return path, data


def about(parent: QWidget) -> None:
    """What this program is."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        number = version("kindyna")
    except PackageNotFoundError:
        number = "from the checkout"
    QMessageBox.about(
        parent,
        "About KINDYNA",
        f"<h3>KINDYNA {number}</h3>"
        "<p>Design of cams, camshafts and the linkages they drive: motion, profile, forces, torque.</p>"
        "<p>After the program of Shin (1995), whose menus it keeps.</p>",
    )
