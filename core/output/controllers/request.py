"""What a table for a controller shall hold."""

from __future__ import annotations

import math

from core.design.fields import choice, flag, number, whole
from core.errors import KindynaError
from core.frozen import frozen
from core.output.controllers.row import INTERPOLATIONS, MOST_ROWS
from core.output.controllers.slave import MOTION, TURN
from core.requests import asked, typed

PLACED, EQUAL = "placed", "equal"
PER_TURN = {"deg": TURN, "rad": 2.0 * math.pi, "counts": None, "mm": None}
"""Unit of the master -> how many of them make a turn; None: that must be given."""
USUAL_ERROR = 1e-3


@frozen
class Request:
    """Of one table; which controller it is for is asked for beside it."""

    interpolation: str | None = asked(
        choice(
            "Between the rows", INTERPOLATIONS, default=None, help="what the controller is set to run between two rows"
        ),
        usual="what it usually runs",
        metavar="NAME",
    )
    placing: str | None = asked(
        choice("Rows stand", (PLACED, EQUAL), default=None, help="where the rows stand"),
        "--as",
        usual="placed, where the controller takes that",
        words={PLACED: "Placed for the least error", EQUAL: "At equal steps"},
    )
    error: float | None = asked(
        number("Largest error", 0.0, open_low=True, default=None, help="of the position, in the motion's unit"),
        usual="0.001",
        metavar="MM",
        one_of=("Number of rows", "The fewest that keep an error"),
    )
    points: int | None = asked(
        whole("Rows", 2, MOST_ROWS, default=None, help="as many rows, with the least error"),
        one_of=("Number of rows", "As many as given"),
    )
    velocity_error: float | None = asked(
        number("Velocity error", 0.0, open_low=True, default=None, help="largest error of the velocity, per degree of the master"),
        usual="any", metavar="X",
    )  # fmt: skip
    acceleration_error: float | None = asked(
        number("Acceleration error", 0.0, open_low=True, default=None, help="largest error of the acceleration, per degree²"),
        usual="any", metavar="X",
    )  # fmt: skip
    master: str = choice("Master counts in", tuple(PER_TURN), default="deg", help="unit of the master")
    master_per_turn: float | None = asked(
        number("Master, per turn", 0.0, open_low=True, default=None, help="units of the master that make a turn"),
        usual="360 deg, 2π rad", metavar="X",
    )  # fmt: skip
    slave_scale: float = asked(
        number("Slave's scale", default=1.0, help="the file holds scale times the position, plus the offset"),
        metavar="A",
    )
    slave_offset: float = asked(number("Slave's offset", default=0.0, help="in the file's unit"), metavar="B")
    reverse: bool = flag("Run backwards", help="the motion at minus the master's angle")
    shift_deg: float = asked(
        number("Shift", -3600.0, 3600.0, default=0.0, help="the motion begins so many degrees later"),
        "--shift",
        metavar="DEG",
    )
    segment: int | None = asked(
        whole("Segment", 1, 10**6, default=None, help="this segment alone, counted from 1, where a file is one segment"),
        usual="the whole turn", metavar="N",
    )  # fmt: skip
    of: str = typed(
        "what the slave does: motion, or the column of a position, such as link4_deg", default=MOTION, metavar="CHANNEL"
    )
    cycle_ms: float | None = asked(
        number("Cycle", 0.0, 1e4, open_low=True, default=None, help="of the controller, at the design's speed: what the drive is given"),
        "--cycle", usual="not looked at", metavar="MS",
    )  # fmt: skip

    @property
    def per_turn(self) -> float:
        """Units of the master in a turn. Raises KindynaError where nobody says."""
        found = self.master_per_turn or PER_TURN[self.master]
        if found is None:
            raise KindynaError(f"--master {self.master}: needs --master-per-turn, the {self.master} that make a turn")
        return found

    @property
    def limits(self) -> tuple[float, float, float]:
        """Of the errors of position, velocity and acceleration; inf where there is none. Raises KindynaError."""
        given = self.error, self.velocity_error, self.acceleration_error
        if self.points is not None and any(each is not None for each in given):
            raise KindynaError("--points: so many rows have the error that they have; allowed: --points, or errors")
        if all(each is None for each in given) and self.points is None:
            given = USUAL_ERROR, None, None
        return tuple(math.inf if each is None else each for each in given)  # type: ignore[return-value]

    def require(self) -> None:
        """Raises KindynaError for a scale of zero."""
        if self.slave_scale == 0.0:
            raise KindynaError("--slave-scale 0: all rows would be alike; allowed: any other number")


__all__ = ["EQUAL", "PLACED", "Request"]
