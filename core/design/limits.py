"""Limits that the user sets on a drive, tolerances, and the waviness of the profile.

Each limit is a field with the quantities that it limits; finding, margin, plot line, report and Find follow from it. Typical
values and limits of other kinds are in ``core.study.limits``.
"""

from __future__ import annotations

from typing import Any

from core.design.fields import LONGEST_MM, Bounds, FileLayout, choice, leading, number, placed, whole
from core.frozen import frozen


def _angle(label: str, section: str) -> Any:
    field = number(
        label,
        0.0,
        90.0,
        open_low=True,
        default=None,
        step=1.0,
        help=f"greatest {section}; empty = the typical limit",
        bounds=Bounds(("pressure_angle",), line=f"limit of the {label.rpartition(' ')[2]} {{}}"),
    )
    return leading(field)


# ``Bounds`` lists the quantities of a limit, by their names in ``core.study.quantities``. With a ``remedy`` the check follows from the
# row; without, the limit needs a separate check, as in ``core.study.cam_checks``. A lower limit has ``most=False``.


def _least(label: str, help: str, default: str = "none") -> Any:
    return leading(number(label, 0.0, LONGEST_MM, open_low=True, default=None, help=f"{help}; empty = {default}"))


def _most(label: str, help: str, bounds: Bounds) -> Any:
    return leading(number(label, 0.0, open_low=True, default=None, help=f"{help}; empty = none", bounds=bounds))


@frozen(kw_only=True)
class Limits:
    """Limits that the user sets; the radii are those of the profile."""

    pressure_angle_rise_deg: float | None = _angle("Pressure angle, rise", "while the motion rises")
    pressure_angle_return_deg: float | None = _angle("Pressure angle, return", "while the motion returns")
    convex_radius_mm: float | None = _least(
        "Convex radius",
        "least radius of curvature where the profile is convex",
        "half the roller's radius, 3 mm under a sliding face",
    )
    concave_radius_mm: float | None = _least("Concave radius", "least radius of curvature where the profile is concave")
    polar_radius_mm: float | None = _least(
        "Polar radius",
        "least distance of the profile from the cam centre",
        "from hub, bore and keyway, or from the hub of the estimated shaft",
    )
    contact_force_n: float | None = _most(
        "Contact force",
        "greatest allowed between follower and cam",
        Bounds(
            ("contact_force", "second_contact_force", "elastic_contact_force"),
            "lower the speed, the masses or the closing force",
        ),
    )
    contact_pressure_mpa: float | None = _most(
        "Contact pressure",
        "greatest allowed between follower and cam",
        Bounds(("contact_pressure", "second_contact_pressure")),
    )
    piston_clearance_mm: float | None = leading(
        number(
            "Piston clearance",
            0.0,
            LONGEST_MM,
            open_low=True,
            default=None,
            help="least between valve and piston; empty = none",
            bounds=Bounds(
                ("piston_clearance",), "enlarge valve.clearance_mm, or reduce lift, duration or overlap", most=False
            ),
        )
    )
    spring_stress_mpa: float | None = _most(
        "Spring stress",
        "greatest corrected shear stress of the valve springs",
        Bounds(("valve_spring_stress",), "enlarge the wire, or reduce the lift or the force"),
    )


NO_LIMITS = Limits()


# -- tolerances -----------------------------------------------------------------------------------------------

NORMAL, UNIFORM, WORST = "normal", "uniform", "worst"
SIGMAS = 3.0
"""Half the width of the tolerance in standard deviations, for a normal distribution without a stated sigma."""


@frozen
class Tolerance:
    """Tolerance of a number of the machine, from nominal - minus to nominal + plus, in the unit of its field.

    Attributes
    ----------
    field : path of the number
    plus, minus : upper and lower deviation
    distribution : normal about the middle, with half the width equal to three sigma where ``sigma`` is not given; uniform;
        worst: at either end
    sigma : standard deviation of the normal distribution
    cost : of halving the tolerance, in any currency; None: the same for all
    """

    field: str = placed(FileLayout(missing="the path of a number, as cam.base_radius_mm"))
    plus: float = number("Upper deviation", 0.0)
    minus: float | None = number(
        "Lower deviation", 0.0, default=None, help="below the nominal value; empty = the upper deviation"
    )
    distribution: str = choice("Distribution", (NORMAL, UNIFORM, WORST), default=NORMAL)
    sigma: float | None = number(
        "Standard deviation", 0.0, open_low=True, default=None, help="empty = a sixth of the width"
    )
    cost: float | None = number("Cost", 0.0, default=None, help="of halving the tolerance")

    @property
    def down(self) -> float:
        """Lower deviation."""
        return self.plus if self.minus is None else self.minus

    @property
    def middle(self) -> float:
        """Middle of the tolerance, from the nominal value."""
        return 0.5 * (self.plus - self.down)

    @property
    def half(self) -> float:
        """Half the width of the tolerance."""
        return 0.5 * (self.plus + self.down)

    @property
    def deviation(self) -> float:
        """Standard deviation of the distribution."""
        by_word = {NORMAL: self.half / SIGMAS, UNIFORM: self.half / 3.0**0.5, WORST: self.half}
        return self.sigma if self.sigma is not None and self.distribution == NORMAL else by_word[self.distribution]


@frozen
class Waviness:
    """Waves of the profile along its normal, of any phase: their amplitude, and the numbers of lobes around the cam."""

    amplitude_mm: float = number("Amplitude", 0.0, 1e3)
    lobes_from: int = whole("Lobes from", 1, 10_000, pair="lobes")
    lobes_to: int = whole("Lobes to", 1, 10_000, pair="lobes")
