"""The command ``explain``: where a number comes from."""

from __future__ import annotations

from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import as_json, design_file, drive_name, one_studied, studied
from core.frozen import frozen
from core.output.explain import as_row, as_text, explained
from core.output.summary import to_json
from core.project import load
from core.requests import typed


@frozen(kw_only=True)
class Arguments:
    """Which number of which design, and at which angle."""

    design: Path = design_file()
    quantity: str = typed(
        "column of a table, or a figure of the flywheel: drive_torque_nm, needed_inertia_kg_m2", "QUANTITY"
    )
    at: float | None = typed(
        "angle of cam, crank or machine; else where it is largest", default=None, type=float, metavar="DEG"
    )
    drive: str = drive_name()
    json: bool = as_json()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """Equation, letters and proof, on the terminal."""
    study = one_studied(arguments.design, arguments.drive) if arguments.drive else studied(load(arguments.design))
    made = explained(study, arguments.quantity, arguments.at)
    print(to_json(as_row(made)) if arguments.json else as_text(made), end="")
    return DONE
