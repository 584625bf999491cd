"""The command ``contact``: whether the follower stays on its cam, its flights where it does not, and the map over angle and speed."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.commands import DONE, Painter
from core.commands.common import design_file, drive_name, one_studied, require_cam, samples_per_turn
from core.design.fields import flag, number, whole
from core.frozen import frozen
from core.motion import degrees
from core.output.contact_files import SPEEDS, flight_lines, lift_off_lines, map_csv, map_of
from core.project.files import write_all
from core.requests import asked, typed


@frozen(kw_only=True)
class Arguments:
    """Whose contact, whether its flights are followed, and how finely the map is."""

    design: Path = design_file()
    drive: str = drive_name()
    flights: bool = flag("Flights", help="follow the follower after it has left the cam")
    turns: float = asked(number("Turns", 0.0, 200.0, open_low=True, default=3.0, help="through so many"), metavar="N")
    out: Path | None = typed("the contact force over cam angle and speed", default=None, type=Path, metavar="FILE.csv")
    samples: int = samples_per_turn(help="cam angles of the table", default=360)
    speeds: int = whole("Speeds of the map", 1, 2000, default=SPEEDS, help="speeds of the table")
    rpm: float | None = asked(
        number("Speed", 0.0, 1e5, open_low=True, default=None, help="highest speed of the table"),
        usual="above the design's and that of lift-off",
        metavar="RPM",
    )


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The speed of lift-off on the terminal, with the flights where they are asked for; the map as a file."""
    study = one_studied(arguments.design, arguments.drive)
    require_cam(study, "contact")
    study.contact_force  # noqa: B018 - raises, and says why, where no contact can be lost
    lines = lift_off_lines(study)
    if arguments.flights:
        lines += ["", *flight_lines(study, study.flights(arguments.turns))]
    if arguments.out is not None:
        theta = np.deg2rad(degrees(arguments.samples))
        found = map_of(study, theta, arguments.rpm, arguments.speeds)
        write_all(arguments.out.parent, {arguments.out.name: map_csv(found)})
    print("\n".join(lines))
    return DONE
