"""Design files: a design from TOML, with all faults of the file reported at once, and TOML from a design."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from core.bounds import DIGITS
from core.design import BALANCER, Design, drive_names, in_machine, numbered, only, part_faults
from core.design.linkage_rules import only_incomplete
from core.errors import MISSING, DesignError, Fault, KindynaError
from core.process import lazy_attributes
from core.project.files import AnyPath, read_text, write
from core.project.reading import design_from_tables
from core.project.reading_faults import require_few_marks

if TYPE_CHECKING:
    from core.project.writing import dumps, dumps_table, to_table
else:
    __getattr__ = lazy_attributes(__name__, "writing")

__all__ = [
    "dumps", "dumps_table", "from_table", "load", "load_drawing", "load_linked", "load_one", "loads",
    "loads_drawing", "number_of", "one_of", "parsed", "save", "to_table",
]  # fmt: skip


def load(path: AnyPath) -> Design:
    """Design in a file. Raises FileError where it cannot be read, DesignError with all its faults."""
    return loads(read_text(path), source=str(path))


def load_one(path: AnyPath, drive: str = "") -> Design:
    """Design of one drive in a file, on the shaft of its machine; the name is needed where there are several drives.

    Raises FileError, DesignError, and KindynaError where the name is missing or unknown.
    """
    return one_of(load(path), drive)


def one_of(design: Design, drive: str = "") -> Design:
    """Design of one drive of a design; the name is needed where there are several. Raises KindynaError."""
    return in_machine(design, only(design, number_of(design, drive)))


def number_of(design: Design, drive: str = "") -> int:
    """Index of a drive by its name. Raises KindynaError."""
    if not design.listed and drive:
        raise KindynaError(f"drive {drive!r}: this design has one drive, without a name; leave --drive out")
    if drive == BALANCER and design.balancer is not None:
        raise KindynaError(
            f"drive {drive!r}: the balance cam follows from the torque of the others; allowed here: {' | '.join(drive_names(design))} "
            "(find balancer sizes its spring; profile and contact take it too)"
        )
    if drive:
        return numbered(design, drive)
    if len(design.drives) > 1:
        raise KindynaError(
            f"drives: there are {len(design.drives)}; choose one with --drive: {' | '.join(drive_names(design))}"
        )
    return 0


def loads(text: str, source: str = "design", *, unfinished: bool = False, chain: Sequence[str] = ()) -> Design:
    """Design in a text.

    Parameters
    ----------
    text : str
    source : str
        Name of the text in faults, and its path for linked files.
    unfinished : bool
        Accept values that contradict each other.
    chain : sequence of str
        Files being read, each linked from the one before.

    Returns
    -------
    Design

    Raises
    ------
    DesignError
        With all faults.
    """
    chain = (*chain, os.path.abspath(source))
    return design_from_tables(parsed(text, source), load_linked, chain=chain, unfinished=unfinished)


def load_linked(path: str, chain: Sequence[str]) -> Design:
    """Design of the one drive in a file to which a motion is linked; chain: files being read. Raises as `load_one`."""
    return one_of(loads(read_text(path), path, chain=chain))


def from_table(table: Mapping[str, Any]) -> Design:
    """Design in the tables of a file. Raises DesignError with all faults, or with the first count that is too large."""
    return design_from_tables(table, load_linked)


def loads_drawing(text: str, source: str = "design") -> Design:
    """Design in a text, in which a drawn linkage may be incomplete. Raises DesignError with all other faults."""
    try:
        return loads(text, source)
    except DesignError as error:
        drawn = loads(text, source, unfinished=True)
        if drawn.listed or not drawn.drive.links or not only_incomplete(drawn.drive, error.faults):
            raise
        return drawn


def load_drawing(path: AnyPath) -> Design:
    """Design in a file, in which a drawn linkage may be incomplete. Raises FileError and DesignError."""
    return loads_drawing(read_text(path), str(path))


def save(design: Design, path: AnyPath, *, in_place: bool = False) -> str:
    """Write a design atomically and return the text of the file; in_place: as in `files.write`.

    Raises
    ------
    FileError
        The file cannot be written.
    DesignError
        `loads_drawing` would refuse the design.
    """
    from core.project.writing import dumps

    if changed := [
        drive.motion for drive in design.drives if drive.motion is not None and not drive.motion.is_as_linked
    ]:
        raise DesignError(part_faults(changed[0], "motion"))
    text = dumps(design, os.path.dirname(os.path.abspath(path)))
    loads_drawing(text, os.fspath(path))
    write(path, text, in_place=in_place)
    return text


def parsed(text: str, source: str) -> dict[str, Any]:
    """Tables of a TOML text; `source` is its name in faults. Raises DesignError."""
    require_few_marks(text, _named(source))
    try:
        return tomllib.loads(text, parse_float=_bounded_float)
    except RecursionError:
        raise _not_toml(source, "nested too deeply") from None
    except tomllib.TOMLDecodeError as error:
        end = f"at line {text.count(chr(10)) + 1}, column {len(text) - text.rfind(chr(10))}, the end"
        raise _not_toml(source, str(error).replace("at end of document", end)) from error
    except ValueError as error:
        raise _not_toml(source, "a number of too many digits") from error


def _bounded_float(text: str) -> float:
    if len(text) > DIGITS:
        raise ValueError(text)
    return float(text)


def _not_toml(source: str, reason: str) -> DesignError:
    line = " ".join(reason.split())
    if len(line) > 200:  # a quoted key; its position is at the end
        line = f"{line[:140]}...{line[-50:]}"
    return DesignError([Fault(_named(source), MISSING, f"not TOML: {line}")])


def _named(source: str) -> str:
    return source if source.isprintable() else repr(source)
