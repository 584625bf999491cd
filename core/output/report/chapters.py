"""The order of a report, and what each of its chapters holds: one list of rows of the report to hand on, one of the plain text. The same
walk makes of them the report of a design of one drive, of all drives of a shaft, and of each of these."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from core.frozen import frozen
from core.output.channels import channels
from core.output.export import SHAFT_QUANTITIES
from core.output.lines import printable
from core.output.report import sections as of_camshaft
from core.output.report import sections as of_sources
from core.output.report import sections as of_stability
from core.output.report import sections as of_study
from core.output.report.equations import equations_of
from core.output.report.parts import (
    Block,
    Number,
    ReportEquations,
    ReportPicture,
    ReportTable,
    Section,
    Sentences,
    section,
    table,
)
from core.output.report.sections import of_papers
from core.output.summary import extremes, flywheel, torque
from core.study import Quantity, Study, names_of
from core.study.camshaft import is_complete

ALONE, SHAFT, DRIVE = "alone", "shaft", "drive"
WHOLE, ONE, EVERY = (ALONE, SHAFT), (ALONE, DRIVE), (ALONE, SHAFT, DRIVE)
_BALANCE_CAM = ("follower", "cam", "loads", "limits")  # tables that nobody typed of it

MAIN: tuple[str, ...] = (
    "displacement", "velocity", "acceleration", "jerk", "pressure_angle", "contact_force", "contact_pressure", "drive_torque",
    "motor_torque", "driver_torque", "driver_force",
)  # fmt: skip
"""Quantities of the main figures, those that a design has."""


FIRST: tuple[str, ...] = (
    "pressure_angle", "contact_force", "contact_pressure", "drive_torque", "driver_torque", "driver_force", "acceleration", "displacement",
)  # fmt: skip
"""Quantities of the first page, the first of them that a design has."""
FIGURES, STEP, GLANCE = 5, 5.0, "glance"
"""How many figures the first page has; degrees between the rows of a profile's table; name of the picture of the first page."""
OUTLINE = ("profile_x", "profile_y", "radius", "polar_angle", "outer_x", "outer_y", "second_x", "second_y")


@frozen(eq=False)
class Subject:
    """What a report, or the part of one, is of.

    of       a design of one drive (ALONE), all drives of a shaft (SHAFT), or one of these by its own angle (DRIVE)
    tables   of the file whose values are its inputs, besides motion and links
    parts    of what may be left out, what is wanted
    without  quantities that stand with the whole
    """

    study: Study
    of: str
    tables: tuple[str, ...]
    parts: frozenset[str] = frozenset()
    without: frozenset[str] = frozenset()

    def drives(self, without: frozenset[str] = SHAFT_QUANTITIES) -> Iterator[Subject]:
        """Each drive of a shaft that has an answer."""
        if self.of == SHAFT:
            yield from (self.drive(each, (), without) for each in self.study.solved_drives.values())

    def drive(self, study: Study, less: Sequence[str], without: frozenset[str] = SHAFT_QUANTITIES) -> Subject:
        """One drive of the shaft; less: tables that are left out besides the shaft's."""
        apart = (*of_study.APART, "shaft", *less)
        return Subject(study, DRIVE, _but(study.design.tables, apart), self.parts, without)

    def pictures(self, captions: Mapping[str, str]) -> tuple[ReportPicture, ...]:
        """Pictures by name with their captions, where they are wanted."""
        wanted = captions if "pictures" in self.parts else {}
        return tuple(ReportPicture(name, self.study, caption) for name, caption in wanted.items())

    def channels(self) -> Iterable[Quantity]:
        """The quantities whose extremes stand in it."""
        return (row for row in channels(self.study.design) if row.name not in self.without)


def subject_of(study: Study, parts: Iterable[str] = ()) -> Subject:
    """Of what the report of a design is."""
    tables = study.design.tables
    if study.design.listed:
        return Subject(study, SHAFT, tuple(name for name in ("shaft", "balancer") if name in tables), frozenset(parts))
    return Subject(study, ALONE, _but(tables, of_study.APART), frozenset(parts))


def _but(tables: Iterable[str], apart: Sequence[str]) -> tuple[str, ...]:
    return tuple(name for name in tables if name not in apart)


class Chapter(NamedTuple):
    """title   its heading; empty where its sections have their own
    of      in the reports of which subjects it stands
    made    its sections; no chapter where there are none
    part    what a reader who does not want it leaves out; empty: it always stands
    within  heading in the chapter of a drive of what has none, where that is not the title
    """

    title: str
    of: Sequence[str]
    made: Callable[[Subject], Iterable[Section]]
    part: str = ""
    within: str | None = None


def sections_of(rows: Sequence[Chapter], subject: Subject) -> list[Section]:
    """The sections of the rows that stand in the report of a subject."""
    found: list[Section] = []
    for row in rows:
        if subject.of in row.of and (not row.part or row.part in subject.parts):
            found += (_inside if subject.of == DRIVE else _chapter)(row, list(row.made(subject)))
    return found


def _chapter(row: Chapter, sections: Sequence[Section]) -> Sequence[Section]:
    """The sections below a heading of their own. One without a title joins the heading."""
    if not sections or not row.title:
        return sections
    first, *rest = sections
    if first.title:
        return [Section(row.title, (), 1), first, *rest]
    return [replace(first, title=row.title, level=1), *rest]


def _inside(row: Chapter, sections: Sequence[Section]) -> Sequence[Section]:
    """In the chapter of a drive: named is what had no title because its chapter had, and what would repeat."""
    title = row.title if row.within is None else row.within
    return [replace(each, title=title) if each.title in ("", "Segments") else each for each in sections]


# -- chapters of the report to hand on ----------------------------------------------------------------------


def _with(sections: list[Section], blocks: tuple[Block, ...]) -> list[Section]:
    """Blocks ahead of the sections."""
    return [Section("", blocks), *sections] if blocks else sections


def _untitled(sections: Iterable[Section]) -> list[Section]:
    return [replace(each, title="") for each in sections]


def _glance(subject: Subject) -> list[Section]:
    """The machine, the figures that a reader asks for first, and what is wrong with it: the first page."""
    study = subject.study
    drawn = is_complete(study.camshaft) if subject.of == SHAFT else "linkage" in study.stages
    pictures = subject.pictures({GLANCE: "The machine, to scale."}) if drawn else ()
    rows = [
        (label, value, unit, Number(angle) if angle is not None else "") for label, value, unit, angle in _five(subject)
    ]
    found = of_study.findings(study)
    return [*section("", *pictures, table(("", "", "", "at °"), rows, left=1, slug="glance") if rows else None), *found]


def _five(subject: Subject) -> list[tuple[str, Number, str, float | None]]:
    """Five figures at most: of a shaft those of all drives together, else the largest of the first quantities that there are."""
    study = subject.study
    wheel = [
        ("Flywheel needed", Number(value), "kg·m²", None)
        for value in (flywheel(study).get("needed_inertia_kg_m2"),)
        if value is not None
    ]
    if subject.of == SHAFT:
        if not is_complete(study.camshaft):
            return []
        found = torque(study.camshaft)
        return [
            ("Largest torque of the shaft", Number(found["peak_nm"]), "N·m", found["peak_angle_deg"]),
            ("Root mean square", Number(found["rms_nm"]), "N·m", None),
            ("Peak power", Number(found["peak_power_w"]), "W", None),
            *wheel,
        ]
    values, order = extremes(study, study.stages), {name: i for i, name in enumerate(FIRST)}
    rows = sorted(
        (row for row in subject.channels() if row.name in order and row.slug in values), key=lambda row: order[row.name]
    )
    ends = [(row, max(values[row.slug].values(), key=lambda end: abs(end["value"]))) for row in rows]
    figures = [
        (row.label, Number(end["value"]), row.unit.symbol, end["cam_angle_deg"]) for row, end in ends if end["value"]
    ]
    return [*figures[: FIGURES - len(wheel)], *wheel]


def _profile(subject: Subject) -> list[Section]:
    """Points of every profile in steps of ``STEP``, by cam angle."""
    if "cam" not in subject.study.stages:
        return []
    study = subject.study.at_theta(np.deg2rad(np.arange(0.0, 360.0, STEP)))
    rows = [row for row in subject.channels() if row.name in OUTLINE and row.name in names_of(study.design)]
    columns = [np.rad2deg(study.theta), *(row.values(study) for row in rows)]
    cells = [(f"{angle:g}", *(f"{value:.4f}" for value in values)) for angle, *values in zip(*columns, strict=True)]
    head = ("cam angle °", *(f"{row.label.lower()} {row.unit.symbol}" for row in rows))
    note = Sentences(
        (
            f"Every {STEP:g}° of the cam, in the cam's own frame; the file of the profile has it to its stated deviation.",
        )
    )
    return section("", note, table(head, cells, left=0, slug="profile"))


def _drives(subject: Subject) -> list[Section]:
    return _untitled(of_camshaft.drives(subject.study.camshaft))


def _main(subject: Subject) -> list[Section]:
    """Lowest and highest of what a reader asks for first, and what is judged."""
    study = subject.study
    rows = sorted((row for row in subject.channels() if row.name in MAIN), key=lambda row: MAIN.index(row.name))
    sections = section("", of_study.extreme_rows(study, rows, study.stages, "main"))
    sections += of_study.limits(study, study.stages)
    return sections


def _inputs(subject: Subject) -> list[Section]:
    """Ahead of the inputs what their mark means, and the reasons that stand beside none of them."""
    sections = of_study.table_sections(subject.study.design, subject.tables, why=True)
    keys = {key for each in sections for b in each.blocks if isinstance(b, ReportTable) for key in b.keys}
    sections = [*of_study.linkage_inputs(subject.study), *sections] if subject.of != SHAFT else sections
    note = of_study.assumed_note(
        subject.study, lambda path: path.startswith("drives[") or not keys.isdisjoint(of_study.rows_of(path))
    )
    noted = _with(sections, (note,)) if note is not None and sections else sections
    if subject.of != DRIVE:
        return noted
    return [replace(each, title=f"Inputs: {each.title.lower()}") if each.title else each for each in noted]


def _timing(subject: Subject) -> list[Section]:
    caption = "Motions of all drives over the machine angle; lines from event to event are what must come after what."
    return _with(of_camshaft.timing(subject.study.design), subject.pictures({"timing": caption}))


def _motion(subject: Subject) -> list[Section]:
    if "motion" not in subject.study.stages:
        return []
    of = " of the follower over one turn of the cam" if "cam" in subject.study.stages else " over one turn"
    caption = f"Displacement, velocity, acceleration and jerk{of}, with their extremes."
    typed = [replace(each, title="Segments") for each in of_study.motion(subject.study)]
    return [*typed, *of_study.cycle(subject.study), *section("Curves", *subject.pictures({"motion": caption}))]


def _cam(subject: Subject) -> list[Section]:
    if "cam" not in subject.study.stages:
        return []
    curves = {"cam": "Pressure angle, curvature and radius of the cam over one turn."}
    return _mechanism(subject, "Curves of the cam", curves, " where the pressure angle is greatest")


def _links(subject: Subject) -> list[Section]:
    if "cam" in subject.study.stages or "linkage" not in subject.study.stages:
        return []
    curves = {"links": "Motion and transmission angles of the links over one turn."}
    return _mechanism(subject, "Curves of the links", curves, "")


def _mechanism(subject: Subject, title: str, curves: Mapping[str, str], where: str) -> list[Section]:
    drawn = subject.pictures({"mechanism": f"The mechanism to scale{where}."})
    return _with([*section(title, *subject.pictures(curves)), *of_study.base(subject.study)], drawn)


def _forces(subject: Subject) -> list[Section]:
    study = subject.study
    wheel = _flywheel(subject) if subject.of == ALONE else []
    there = extremes(study, ("dynamics",)) if "dynamics" in study.stages else {}
    if not any(
        end["value"] for row in there.values() for end in row.values()
    ):  # a guide jams, or nothing has a mass or a load
        return wheel
    caption = "Forces and torque over one turn at the design's speed."
    own = [*of_study.contact(study), *of_study.vibration(study), *of_study.life(study)]
    return [*_with(own, subject.pictures({"forces": caption})), *wheel]


def _torque(subject: Subject) -> list[Section]:
    if not is_complete(subject.study.camshaft):
        return []
    caption = "Torque of each drive and of all together over the machine angle, and the speed of the shaft."
    torque = of_camshaft.torque(subject.study.camshaft)
    return [*_with(torque, subject.pictures({"torque": caption})), *_flywheel(subject)]


def _flywheel(subject: Subject) -> list[Section]:
    """On a shaft the mean torque stands with that of all drives."""
    return of_study.flywheel(subject.study, flywheel(subject.study), with_mean=subject.of == ALONE)


def _stability(subject: Subject) -> list[Section]:
    sections = of_stability.shaft_stability(subject.study)
    if not sections:
        return []
    caption = "Forbidden bands by frequency ratio and inertia ratio, with the machine's place."
    return [replace(sections[0], title=""), *section("Chart", *subject.pictures({"stability": caption}))]


def _each_drive(subject: Subject) -> list[Section]:
    """A chapter of each drive by its own angle, then of the balance cam; what belongs to the shaft is left out."""
    camshaft = subject.study.camshaft
    there = [(f"Drive {printable(each.study.design.name)}", each) for each in subject.drives()]
    if subject.study.design.balancer is not None and is_complete(camshaft) and camshaft.balancer is not None:
        there.append(("Balance cam", subject.drive(camshaft.balancer, _BALANCE_CAM)))
    return [
        part
        for title, each in there
        for part in _chapter(Chapter(title, SHAFT, _each_drive), sections_of(CHAPTERS, each))
    ]


def _others(subject: Subject) -> list[Section]:
    rows = (row for row in subject.channels() if row.name not in MAIN)
    return _untitled(of_study.extreme_values(subject.study, rows, subject.study.stages))


def _certificate(subject: Subject) -> list[Section]:
    text = "Each residual is computed anew for this very design; it is kept where it is not above its bound, which follows from rounding."
    return [Section("", (Sentences((text,)), *each.blocks)) for each in of_study.certificate(subject.study)]


def _equations(subject: Subject) -> list[Section]:
    return [Section("", (ReportEquations(equations_of(subject.study)),))]


CHAPTERS: tuple[Chapter, ...] = (
    Chapter("At a glance", WHOLE, _glance),
    Chapter("Drives", (SHAFT,), _drives),
    Chapter("Main figures", ONE, _main, within=""),
    Chapter("Inputs", ONE, _inputs, "inputs"),
    Chapter("Inputs of the shaft", (SHAFT,), _inputs, "inputs"),
    Chapter("Timing", (SHAFT,), _timing),
    Chapter("Motion", ONE, _motion),
    Chapter("Mechanism and cam", ONE, _cam, within="Mechanism"),
    Chapter("Mechanism", ONE, _links),
    Chapter("Forces and torque", ONE, _forces),
    Chapter("Torque of the shaft", (SHAFT,), _torque),
    Chapter("Flexible shaft", WHOLE, _stability),
    Chapter("", (SHAFT,), _each_drive),
    Chapter("Profile", ONE, _profile, "profile"),
    Chapter("Extremes over one turn of all other quantities", ONE, _others, "extremes"),
    Chapter("Certificate", WHOLE, _certificate, "certificate"),
    Chapter("Equations used", WHOLE, _equations, "equations"),
    Chapter("Held against the paper", WHOLE, lambda subject: of_papers(subject.study.design), "papers"),
    Chapter("Conventions and sources", WHOLE, lambda subject: of_sources.conventions(subject.study), "conventions"),
)  # fmt: skip
"""The chapters of the report to hand on, in their order."""


# -- sections of the plain text -----------------------------------------------------------------------------


def _marked_inputs(subject: Subject) -> list[Section]:
    """The mark of what is assumed is explained below the last table."""
    sections = of_study.table_sections(subject.study.design, subject.tables)
    note = of_study.assumed_note(subject.study, lambda path: path.startswith("drives["))
    if note is None or not sections:
        return sections
    return [*sections[:-1], replace(sections[-1], blocks=(*sections[-1].blocks, note))]


TEXT: tuple[Chapter, ...] = (
    Chapter("", (SHAFT,), lambda subject: of_camshaft.drives(subject.study.camshaft)),
    Chapter("", ONE, lambda subject: of_study.linkage_inputs(subject.study)),
    Chapter("", EVERY, _marked_inputs),
    Chapter("", (SHAFT,), lambda subject: of_camshaft.timing(subject.study.design)),
    Chapter("", (SHAFT,), lambda subject: of_camshaft.torque(subject.study.camshaft)),
    Chapter("", ONE, lambda subject: of_study.motion(subject.study)),
    Chapter("", ONE, lambda subject: of_study.cycle(subject.study)),
    Chapter("", ONE, lambda subject: of_study.base(subject.study)),
    Chapter("", ONE, lambda subject: of_study.extreme_values(subject.study, subject.channels(), subject.study.stages)),
    Chapter("", ONE, lambda subject: of_study.limits(subject.study, subject.study.stages)),
    Chapter("", ONE, lambda subject: of_study.contact(subject.study)),
    Chapter("", ONE, lambda subject: of_study.vibration(subject.study)),
    Chapter("", ONE, lambda subject: of_study.life(subject.study)),
    Chapter("", WHOLE, _flywheel),
    Chapter("", WHOLE, lambda subject: of_stability.shaft_stability(subject.study)),
    Chapter("", WHOLE, lambda subject: of_study.findings(subject.study)),
    Chapter("", WHOLE, lambda subject: of_study.certificate(subject.study)),
)  # fmt: skip
"""The sections of the plain text, in their order; they have titles of their own."""


__all__ = ["ALONE", "CHAPTERS", "DRIVE", "SHAFT", "TEXT", "Chapter", "Subject", "sections_of", "subject_of"]
