"""Design files: TOML into a design, with all faults of the file reported at once, and back as typed."""

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
from core.project.differences import ValueDifference, differences
from core.project.files import AnyPath, read_text, write
from core.project.reading import design_from_tables
from core.project.reading_faults import require_few_marks

if TYPE_CHECKING:
    from core.project.writing import dumps, dumps_table, to_table
else:
    __getattr__ = lazy_attributes(__name__, "writing")

__all__ = [
    "ValueDifference", "differences", "dumps", "dumps_table", "from_table", "load", "load_drawing", "load_linked", "load_one", "loads",
    "loads_drawing", "number_of", "one_of", "parsed", "save", "to_table",
]  # fmt: skip


def load(path: AnyPath) -> Design:
    """The design in a file. Raises FileError where it cannot be read, DesignError with all its faults."""
    return loads(read_text(path), source=str(path))


def load_one(path: AnyPath, drive: str = "") -> Design:
    """The design of one drive in a file, as it stands on its shaft: of several the one of this name, called by it and the machine.
    Raises FileError, DesignError, and KindynaError where it is not clear which one."""
    return one_of(load(path), drive)


def one_of(design: Design, drive: str = "") -> Design:
    """The same of a design; the drive need not be named where there is but one. Raises KindynaError."""
    return in_machine(design, only(design, number_of(design, drive)))


def number_of(design: Design, drive: str = "") -> int:
    """The number of that drive in the list."""
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
    """The design in a text; ``source`` names it where it is no TOML; unfinished: its values need not fit together; chain: the files
    being read, each linked from the one before. Raises DesignError with all faults."""
    chain = (*chain, os.path.abspath(source))
    return design_from_tables(parsed(text, source), load_linked, chain=chain, unfinished=unfinished)


def load_linked(path: str, chain: Sequence[str]) -> Design:
    """The design of the one drive in a file from which a motion follows; chain: the files being read. Raises as ``load_one``."""
    return one_of(loads(read_text(path), path, chain=chain))


def from_table(table: Mapping[str, Any]) -> Design:
    """The design in the tables of a file. Raises DesignError with all faults; with one alone where there is too much of something."""
    return design_from_tables(table, load_linked)


def loads_drawing(text: str, source: str = "design") -> Design:
    """The design in a text; a linkage that is drawn need be no mechanism yet. Raises DesignError with all other faults."""
    try:
        return loads(text, source)
    except DesignError as error:
        drawn = loads(text, source, unfinished=True)
        if drawn.listed or not drawn.drive.links or not only_incomplete(drawn.drive, error.faults):
            raise
        return drawn


def load_drawing(path: AnyPath) -> Design:
    """The same of a file. Raises FileError where it cannot be read."""
    return loads_drawing(read_text(path), str(path))


def save(design: Design, path: AnyPath, *, in_place: bool = False) -> str:
    """Write a design, whole or not at all; the text that the file holds now. in_place: as ``files.write`` has it.

    Raises FileError where it cannot be written, DesignError where ``loads_drawing`` would refuse it.
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
    """The tables of a TOML text; ``source`` names it where it is none. Raises DesignError."""
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
    if len(line) > 200:  # it quotes a key; where it stands comes last
        line = f"{line[:140]}...{line[-50:]}"
    return DesignError([Fault(_named(source), MISSING, f"not TOML: {line}")])


def _named(source: str) -> str:
    return source if source.isprintable() else repr(source)
