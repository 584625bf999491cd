"""The conventions of a report, and the sources of what stands in it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from core.output.report.equations import equations_of
from core.output.report.parts import Section, Sentences, section, table
from core.study import Study
from core.study.cam_checks import limit_rows

CONVENTIONS: Mapping[str, bool] = MappingProxyType(
    {
        "Global frame: origin at the centre of the cam or at the frame of the linkage, x to the right, y upwards, angles "
        "counter-clockwise.": True,
        "The cam angle θ grows with time, whichever way the shaft turns; angle 0 is the start of the first segment.": False,
        "Vectors of the plane are written as complex numbers; · and × are their scalar and vector product, a bar the conjugate of a "
        "vector, or the mean of a scalar.": True,
        "A curvature is positive where the cam is convex. The contact force is positive where it presses the follower on the cam. "
        "A drive torque is positive where it drives.": True,
        "Extremes are refined to the true extreme of the continuous curve, not read from a table; where a quantity jumps, both sides "
        "count.": False,
        "Numbers are rounded for reading; summary.json of the same design holds all their digits.": False,
    }
)
"""Convention -> whether it is of a mechanism; the others hold of a motion alone too."""

SOURCES: Mapping[str, str] = MappingProxyType(
    {
        "Shin1995": "J.-H. Shin, J.-S. Kim, K.-H. Ha: A Study on the Kinetodynamic Analysis for General Disk Cam Driving Slider "
        "Mechanisms. 1995.",
        "Kim1990": "H.-B. Kim, H.-S. Jeon, C.-W. Lee, Y.-S. Park: Dynamic Stability Analysis of a Single Cam Drive Mechanism. 1990.",
        "Yang": "M.-Y. Yang, T.-Y. Shon: Study on Blended Cam Design.",
        "Velocity": "Velocity Analysis, chapter 6 of a lecture on the kinematics of machines.",
        "Norton": "R. L. Norton: Cam Design and Manufacturing Handbook.",
        "Neklutin": "C. N. Neklutin: Mechanisms and Cams for Automatic Machines. 1969.",
        "Freudenstein": "F. Freudenstein: On the Dynamics of High-Speed Cam Profiles. 1960.",
        "Gutman": "A. S. Gutman: To Avoid Vibration, Try This New Cam Profile. 1961.",
        "VDI 2142": "VDI 2142: Design of plane cam mechanisms.",
        "ISO 281": "ISO 281: Rolling bearings, dynamic load ratings and rating life.",
    }
)
"""How a source is called in tables -> what it is."""


def conventions(study: Study) -> list[Section]:
    """What holds of every number, and the sources that equations and limits of this design name."""
    rows_of_all = (row for each in study.answering.values() for row in limit_rows(each, each.stages))
    named = " ".join([*(row.source for row in equations_of(study)), *(row.source for row in rows_of_all)])
    rows = [(name, text) for name, text in SOURCES.items() if name in named]
    corrected = (
        "corrected: the printed equation is wrong there, and the one given here is computed."
        if "corrected" in named
        else ""
    )
    remark = Sentences((corrected,), mark=True) if corrected else None
    moves = any("linkage" in each.stages for each in study.answering.values())
    texts = tuple(text for text, of_mechanism in CONVENTIONS.items() if moves or not of_mechanism)
    return [Section("", (Sentences(texts),)), *section("Sources", table((), rows, left=2), remark)]
