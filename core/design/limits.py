"""The user's own limits of a drive, one row each: a field that says of which quantities it is a limit. Finding, margin, line in plots
and report, and what Find may hold follow; usual values and figures of other sorts stand in ``core.study.limits``. And how far the
numbers of a machine may be off as made: tolerances, and the waviness of the profile."""

from __future__ import annotations

from typing import Any

from core.design.fields import LONGEST_MM, Bounds, FileLayout, choice, leading, number, placed, whole
from core.frozen import frozen


def _angle(label: str, stretch: str) -> Any:
    made = number(
        label,
        0.0,
        90.0,
        open_low=True,
        default=None,
        step=1.0,
        help=f"greatest {stretch}; empty = the usual one",
        bounds=Bounds(("pressure_angle",), line=f"limit of the {label.rpartition(' ')[2]} {{}}"),
    )
    return leading(made)


# Which quantities a limit holds for is in its ``Bounds``, by their names in ``core.study.quantities``. With a ``remedy`` there the whole
# check follows; without, the limit has a check of its own (``core.study.cam_checks``, ``contact_stress``), and a new row would be silent.
# A lower limit says ``most=False``.


def _least(label: str, help: str, usual: str = "none") -> Any:
    return leading(number(label, 0.0, LONGEST_MM, open_low=True, default=None, help=f"{help}; empty = {usual}"))


def _most(label: str, help: str, bounds: Bounds) -> Any:
    return leading(number(label, 0.0, open_low=True, default=None, help=f"{help}; empty = none", bounds=bounds))


@frozen(kw_only=True)
class Limits:
    """What the user does not want to exceed, as far as stated; radii are those of the profile."""

    pressure_angle_rise_deg: float | None = _angle("Pressure angle, rise", "while the motion rises")
    pressure_angle_return_deg: float | None = _angle("Pressure angle, return", "while it returns")
    convex_radius_mm: float | None = _least(
        "Convex radius",
        "least radius of curvature where the profile bulges",
        "half the roller's radius, 3 mm under what slides",
    )
    concave_radius_mm: float | None = _least("Concave radius", "least radius of curvature where the profile is hollow")
    polar_radius_mm: float | None = _least(
        "Polar radius",
        "least distance of the profile from the cam centre",
        "metal around hub and bore, else room for the shaft's hub",
    )
    contact_force_n: float | None = _most(
        "Contact force",
        "greatest between follower and cam",
        Bounds(
            ("contact_force", "second_contact_force", "elastic_contact_force"),
            "lower the speed, the masses or the closing force",
        ),
    )
    contact_pressure_mpa: float | None = _most(
        "Contact pressure",
        "greatest between follower and cam",
        Bounds(("contact_pressure", "second_contact_pressure")),
    )


NO_LIMITS = Limits()


# -- as made -------------------------------------------------------------------------------------------------

NORMAL, UNIFORM, WORST = "normal", "uniform", "worst"
SIGMAS = 3.0
"""Of a normal distribution, half the width of the tolerance where its file does not state sigma."""


@frozen
class Tolerance:
    """A number of the machine lies between its own less ``minus`` and that plus ``plus``, in the unit of its field.

    distribution  normal about the middle, half the width being three sigma where ``sigma`` is not stated; uniform; worst: at either end
    cost          of halving the tolerance, in any currency; None: the same for all
    """

    field: str = placed(FileLayout(missing="the path of a number, as cam.base_radius_mm"))
    plus: float = number("Upper deviation", 0.0)
    minus: float | None = number("Lower deviation", 0.0, default=None, help="downwards; empty = as upwards")
    distribution: str = choice("Distribution", (NORMAL, UNIFORM, WORST), default=NORMAL)
    sigma: float | None = number(
        "Standard deviation", 0.0, open_low=True, default=None, help="empty = a sixth of the width"
    )
    cost: float | None = number("Cost", 0.0, default=None, help="of halving the tolerance")

    @property
    def down(self) -> float:
        """How far the number may lie below its own."""
        return self.plus if self.minus is None else self.minus

    @property
    def middle(self) -> float:
        """Of the tolerance, from the number itself."""
        return 0.5 * (self.plus - self.down)

    @property
    def half(self) -> float:
        """Half the width of the tolerance."""
        return 0.5 * (self.plus + self.down)

    @property
    def deviation(self) -> float:
        """Standard deviation of its distribution."""
        by_word = {NORMAL: self.half / SIGMAS, UNIFORM: self.half / 3.0**0.5, WORST: self.half}
        return self.sigma if self.sigma is not None and self.distribution == NORMAL else by_word[self.distribution]


@frozen
class Waviness:
    """Waves of the profile along its normal, a whole number of lobes around the cam, of any phase: how high each, and how many lobes."""

    amplitude_mm: float = number("Amplitude", 0.0, 1e3)
    lobes_from: int = whole("Lobes from", 1, 10_000, pair="lobes")
    lobes_to: int = whole("Lobes to", 1, 10_000, pair="lobes")
