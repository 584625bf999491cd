"""Every modal question of the window, in one module, so that tests can answer for the user."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QFileDialog, QInputDialog, QMessageBox, QPushButton, QWidget

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
"""Properties of widgets: their page of ``resources/help``, and the path of the value typed in them."""
MOST_LINES = 12  # lines of faults above Details
UNSAVED = "has unsaved changes"
SEGMENT_FROM = (
    "Scaled to the segment's span and rise, from rest to rest",
    "Scaled, with velocity and acceleration of its neighbours at its ends",
    "With the table's span and rise, from rest to rest",
    "With the table's span and rise, and velocity and acceleration of its neighbours",
)

# -- answers ---------------------------------------------------------------------------------------------


class SaveAnswer(Enum):
    """Answer to whether changes are saved."""

    SAVE = "save"
    DISCARD = "discard"
    CANCEL = "cancel"


class OnConflict(Enum):
    """Answer to what to do where another program has changed the file to save to."""

    RELOAD = "reload"
    SAVE_AS = "save as"
    OVERWRITE = "overwrite"
    CANCEL = "cancel"


class IncompleteChoice(Enum):
    """Answer to what to save where the values do not fit together."""

    CLOSE = "close"
    AS_TYPED = "as typed"
    LAST_VALID = "last valid"
    CANCEL = "cancel"


class OnShaft(Enum):
    """Answer to which shaft of several drives a design is added."""

    NEW = "a new shaft"
    FILE = "the shaft of a file"
    CANCEL = "cancel"


# -- help and buttons of dialogs -------------------------------------------------------------------------


def help_on(widget: QWidget) -> tuple[str, str]:
    """Return the page of help on a widget, and the words to search for; for a field the page of fields and its path."""
    current: QWidget | None = widget
    while current is not None:
        if path := current.property(FIELD):
            return "fields", str(path)
        if target := current.property(HELP):
            page, _, words = str(target).partition("#")
            return page, words
        current = None if current.isWindow() else current.parentWidget()
    return "tour", ""


def give_help(dialog: QWidget, page: str) -> None:
    """Let F1 in a dialog or window open its page of help over it, at the words after #.

    The help window is a child of the dialog, which blocks all other windows.
    """

    def open() -> None:
        from kindyna_gui.help import HelpWindow

        help_window = dialog.findChild(HelpWindow) or HelpWindow(dialog)
        help_window.open(*help_on(dialog.focusWidget() or dialog))

    dialog.setProperty(HELP, page)
    QShortcut(QKeySequence(QKeySequence.StandardKey.HelpContents), dialog).activated.connect(open)


def accept_buttons(dialog: QDialog, text: str) -> tuple[QDialogButtonBox, QPushButton]:
    """Return the buttons that accept and cancel a dialog, and the accepting one, with its text."""
    buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
    buttons.accepted.connect(dialog.accept)
    buttons.rejected.connect(dialog.reject)
    accept = buttons.button(QDialogButtonBox.StandardButton.Ok)
    accept.setText(text)
    return buttons, accept


# -- files to save ---------------------------------------------------------------------------------------


def file_to_save(parent: QWidget, suggestion: Path, title: str, kinds: Mapping[str, str]) -> Path | None:
    """Ask for the file to save to; ``kinds`` maps endings to the names of such files. None where the user cancels."""
    filters = ";;".join(f"{name} (*{ending})" for ending, name in kinds.items())
    name, chosen = QFileDialog.getSaveFileName(parent, title, str(suggestion), filters)
    ending = next((ending for ending in kinds if f"(*{ending})" in chosen), next(iter(kinds)))
    return with_suffix(parent, name, ending, tuple(kinds))


Save = Callable[[QWidget, Path], Path | None]
"""Asks for a file to save to, with the parent window and a suggested file; None where the user cancels."""


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
lift_table_to_save = _save("Export lift table", TABLES)
drawing_to_save = _save("Export drawing", {**PDF, **SVG})
timing_to_save = _save("Export timing chart", {**PDF, **SVG, ".png": "PNG picture", ".csv": "Table of events"})


def links_to_save(parent: QWidget, suggestion: Path, table: bool = False) -> Path | None:
    """Ask for the file of a pose, or of curves of points; ``table``: CSV too."""
    kinds = {".csv": "Table"} if table else {}
    return file_to_save(parent, suggestion, "Export links", {**kinds, ".dxf": "DXF drawing", ".svg": "SVG drawing"})


def profile_to_save(parent: QWidget, suggestion: Path) -> Path | None:
    """Ask for the file of a profile, with the ending of the suggestion."""
    return file_to_save(parent, suggestion, "Export profile", {suggestion.suffix: "Profile"})


def surfaces_to_save(parent: QWidget, suggestion: Path) -> Path | None:
    """Ask for the file of surfaces, with the ending of the suggestion."""
    return file_to_save(parent, suggestion, "Export surfaces", {suggestion.suffix: "Surfaces"})


def controller_table_to_save(parent: QWidget, suggestion: Path) -> Path | None:
    """Ask for the file of a controller's table, with the ending of the suggestion."""
    return file_to_save(parent, suggestion, "Export controller table", {suggestion.suffix: "Table"})


def report_to_save(parent: QWidget, suggestion: Path) -> Path | None:
    """Ask for the file of a report, with the ending of the suggestion, else .txt."""
    ending = suggestion.suffix if suggestion.suffix in REPORTS else ".txt"
    return file_to_save(parent, suggestion, "Report", {ending: REPORTS[ending]})


def study_to_save(parent: QWidget, suggestion: Path) -> Path | None:
    """Ask for the file of a study."""
    return file_to_save(parent, suggestion, "Save the study", {".toml": "Study"})


def graph_to_save(parent: QWidget, suggestion: Path) -> Path | None:
    """Ask for the file of a graph's curves and axes, which ends in .json."""
    name, _ = QFileDialog.getSaveFileName(parent, "Save graph", str(suggestion), GRAPHS)
    return with_suffix(parent, name, ".graph.json", (".json",))


CommandText = Callable[[A], str]
"""Returns the command that does the same as a question, from its answer."""

# -- questions with one answer ---------------------------------------------------------------------------


def _ask(
    box: QInputDialog, title: str, page: str, answer: Callable[[], A], command: CommandText[A] | None = None
) -> A | None:
    """Ask a question with its page of help and its command; None where the user cancels."""
    box.setWindowTitle(title)
    give_help(box, page)
    box.sizeHint()  # creates the buttons
    buttons = box.findChild(QDialogButtonBox)
    if command is not None and isinstance(buttons, QDialogButtonBox):
        from kindyna_gui.documents.texts import add_copy_of_line

        add_copy_of_line(buttons, lambda: command(answer()))
    value = answer() if box.exec() else None
    box.deleteLater()
    return value


def _choice(parent: QWidget, text: str, rows: Sequence[str]) -> QInputDialog:
    """Return a question for one of several rows."""
    box = QInputDialog(parent)
    box.setComboBoxItems(list(rows))
    box.setLabelText(text)
    return box


def ask_shift(parent: QWidget, command: CommandText[float]) -> float | None:
    """Ask by how much a motion is shifted [deg]; None where the user cancels."""
    box = QInputDialog(parent)
    box.setInputMode(QInputDialog.InputMode.DoubleInput)
    box.setLabelText("Shift in degrees of cam angle (positive: later, negative: earlier):")
    box.setDoubleDecimals(6)
    box.setDoubleRange(-360.0, 360.0)
    box.setDoubleValue(10.0)
    return _ask(box, "Shift the motion", "making#Shift the motion by", box.doubleValue, command)


def ask_segment(parent: QWidget, command: CommandText[tuple[bool, bool]] | None) -> tuple[bool, bool] | None:
    """Ask how a table becomes a segment: with its own size, joined to its neighbours; None where the user cancels."""
    box = _choice(parent, "Insert the table:", SEGMENT_FROM)

    def answer() -> tuple[bool, bool]:
        number = SEGMENT_FROM.index(box.textValue())
        return number >= 2, number % 2 == 1

    return _ask(box, "Segment from table", "making#Segment from table", answer, command)


def ask_layout_name(parent: QWidget, names: Sequence[str]) -> str:
    """Ask for the name of a layout, a new name or one of these; empty where the user cancels."""
    box = _choice(parent, "Name of the layout:", names)
    box.setComboBoxEditable(True)
    box.setTextValue("")
    return (_ask(box, "Save this layout", "tour#Named layouts", box.textValue) or "").strip()


def ask_drive(parent: QWidget, names: Sequence[str], command: CommandText[str]) -> int | None:
    """Ask for the drive whose motion is used, and return its number; None where the user cancels."""
    box = _choice(parent, "Motion of the drive:", names)
    name = _ask(box, "Motion from a design", "making#Motion from a design or file", box.textValue, command)
    return None if name is None else list(names).index(name)


def design_to_open(parent: QWidget, folder: Path) -> Path | None:
    """Ask for a design file to open; None where the user cancels."""
    return file_to_open(parent, "Open design", "Designs (*.toml)", folder)


def motion_files_to_open(parent: QWidget, folder: Path) -> list[Path]:
    """Ask for the table or designs from which a motion follows; empty where the user cancels."""
    names, _ = QFileDialog.getOpenFileNames(
        parent, "Files that the motion follows from", str(folder), f"{MOTION_FILES};;All files (*)"
    )
    return [Path(name) for name in names]


def ask_output(parent: QWidget, outputs: Mapping[str, str]) -> str | None:
    """Ask which motion of a linkage is used: its own (empty), or the driver's for a link; None where the user cancels."""
    rows = {"": "its own motion"} | {
        n: f"the driver's motion that moves link {n} by this motion ({unit})" for n, unit in outputs.items()
    }
    box = _choice(parent, "Use:", list(rows.values()))

    def answer() -> str:
        return next(n for n, row in rows.items() if row == box.textValue())

    return _ask(box, "Motion that follows from a linkage", "making#Motion that follows from files", answer)


def graph_to_open(parent: QWidget, folder: Path) -> Path | None:
    """Ask for a saved graph."""
    return file_to_open(parent, "Open graph", GRAPHS, folder)


def graph_files_to_open(parent: QWidget, folder: Path) -> list[Path]:
    """Ask for tables and designs to plot; empty where the user cancels."""
    names, _ = QFileDialog.getOpenFileNames(parent, "Files to plot", str(folder), f"{GRAPH_FILES};;All files (*)")
    return [Path(name) for name in names]


def with_suffix(parent: QWidget, name: str, suffix: str, allowed: Sequence[str] = ()) -> Path | None:
    """Return the path with an ending, where it has none that is allowed; None where an existing file is not replaced.

    The file dialog asks only about the typed name, so this asks about the file with the ending.
    """
    if not name:
        return None
    path = Path(name)
    if path.suffix.lower() in (allowed or (suffix,)):
        return path
    path = path.with_name(path.name + suffix)
    return path if not path.exists() or ask_to_replace(parent, path.name) else None


def ask_to_replace(parent: QWidget, name: str) -> bool:
    """Ask whether an existing file is replaced."""
    text, answers = f"{name} already exists.\nDo you want to replace it?", QMessageBox.StandardButton
    return QMessageBox.warning(parent, "KINDYNA", text, answers.Yes | answers.No, answers.No) == answers.Yes


# -- messages --------------------------------------------------------------------------------------------


def _box(parent: QWidget, icon: QMessageBox.Icon, text: str, page: str) -> QMessageBox:
    box = QMessageBox(icon, "KINDYNA", text, parent=parent)
    give_help(box, page)
    return box


def ask_to_save(parent: QWidget, name: str, state: str = UNSAVED) -> SaveAnswer:
    """Ask whether a design is saved before another is opened; ``state`` says how it differs from its file."""
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
    """Ask what to do with a file that another program has changed or removed; ``lines`` are the differences."""
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
    """Return the answer of the clicked button."""
    clicked = box.clickedButton()
    box.deleteLater()
    return next((answer for button, answer in buttons.items() if button is clicked), cancelled)


def ask_on_shaft(parent: QWidget, name: str) -> OnShaft:
    """Ask to which shaft a design of one drive is added."""
    text = f"Add {name} to a shaft with several drives."
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


def ask_incomplete(parent: QWidget, lines: Sequence[str], closing: str, as_typed: bool) -> IncompleteChoice:
    """Ask what to save where the values do not fit together.

    ``lines`` are the reasons; ``closing`` is what would close the motion, or ''; ``as_typed`` whether a file can have the
    typed values.
    """
    text = "The typed values do not fit together yet."
    box = _box(parent, QMessageBox.Icon.Question, text, "tour#asks whether to write what is typed")
    close = [f"Close the motion: {closing}."] if closing else []
    typed = ["Save unfinished: you can open the file and go on; it has no drawing or cam until the values fit."]
    last = "Save the last valid version: what you typed since then is not saved, but remains in this window."
    box.setInformativeText("\n".join((*lines, "", *close, *(typed if as_typed else []), last)))
    role = QMessageBox.ButtonRole
    buttons = {box.addButton("Close the motion and save", role.AcceptRole): IncompleteChoice.CLOSE} if closing else {}
    buttons |= {box.addButton("Save unfinished", role.AcceptRole): IncompleteChoice.AS_TYPED} if as_typed else {}
    buttons |= {
        box.addButton("Save the last valid version", role.AcceptRole): IncompleteChoice.LAST_VALID,
        box.addButton(QMessageBox.StandardButton.Cancel): IncompleteChoice.CANCEL,
    }
    box.setDefaultButton(next(iter(buttons)))
    box.setEscapeButton(QMessageBox.StandardButton.Cancel)
    box.exec()
    return _answer(box, buttons, IncompleteChoice.CANCEL)


def ask_to_recover(parent: QWidget, entries: Sequence[Recoverable]) -> tuple[OnRecovery, Recoverable]:
    """Ask what to do with unsaved work, and with which."""
    from kindyna_gui.documents.texts import RecoveryDialog

    dialog = RecoveryDialog(parent, entries)
    give_help(dialog, "tour#Unsaved work is kept")
    dialog.exec()
    answer = dialog.choice, dialog.chosen
    dialog.deleteLater()
    return answer


def _list(box: QMessageBox, lines: Sequence[str]) -> None:
    """Show the first lines below the text of a box, and where there are many all of them under Details."""
    shown = list(lines[:MOST_LINES])
    if len(lines) > MOST_LINES:
        shown.append(f"... and {len(lines) - MOST_LINES} more")
        box.setDetailedText("\n".join(lines))
    box.setInformativeText("\n".join(shown))
    box.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)


def show_faults(parent: QWidget, message: str, lines: Sequence[str]) -> None:
    """Show what went wrong, a line for each fault; all of them can be selected and copied."""
    box = _box(parent, QMessageBox.Icon.Warning, message, "tour")
    _list(box, lines)
    box.exec()
    box.deleteLater()


# -- files to open ---------------------------------------------------------------------------------------


def file_to_open(parent: QWidget, title: str, kinds: str, folder: Path | None = None) -> Path | None:
    """Ask for a file to read, in a folder, else in that of the last file; None where the user cancels."""
    start = str(Settings().folder if folder is None else folder)
    name, _ = QFileDialog.getOpenFileName(parent, title, start, f"{kinds};;All files (*)")
    return Path(name) if name else None


def opened_file(parent: QWidget, title: str, kinds: str, most_bytes: int = BYTES) -> tuple[Path, bytes] | None:
    """Ask for a file and read it; None where the user cancels, or where it cannot be read, after showing why."""
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
    """Show the name and version of the program."""
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
        "<p>Based on the program of Shin (1995), with the same menus.</p>",
    )
