"""What a design reaches of a limit, and how far that is from it."""

from __future__ import annotations

import math

from core.findings import apart
from core.frozen import frozen
from core.study.limits import CONVEX, LIMITS
from core.units import split_unit


@frozen
class LimitReading:
    """A limit and what is reached: value in the unit of the limit, infinite where there is no such figure; margin as a part of the
    limit; cam angle [rad]; reason: of the limit, empty where it was stated; whose: of which flank."""

    key: str
    limit: float
    reached: float
    margin: float
    theta: float
    reason: str = ""
    whose: str = ""

    @property
    def kept(self) -> bool:
        """A limit of 0 must not be reached itself."""
        return self.margin >= 0.0 if self.limit else self.margin > 0.0

    @property
    def text(self) -> str:
        """The reading in a line: value, cam angle, limit and why it holds."""
        unit = LIMITS[self.key].unit if self.key in LIMITS else "N"
        name = split_unit(self.key.rpartition(".")[2])[0].replace("_", " ")
        if not self.limit and self.key == CONVEX:
            return f"undercut at {math.degrees(self.theta):.5g} deg"
        reached, limit = apart([self.reached, self.limit], 6)
        why = f" ({self.reason})" if self.reason else ""
        return f"{name}{self.whose} {reached} {unit} at {math.degrees(self.theta):.5g} deg, limit {limit} {unit}{why}"
