"""The chapters of a report in their order: one list for the HTML and PDF report, one for the plain text.

The same rows give the report of a design with one drive, of the shaft of several drives, and of every drive.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from core.design.design import SHARED
from core.design.fields import in_sentence
from core.frozen import frozen
from core.number_text import MOST_DIGITS, result_text
from core.output.channels import channels
from core.output.export import SHAFT_QUANTITIES
from core.output.lines import printable
from core.output.report import sections as content
from core.output.report.equations import equations_of
from core.output.report.parts import (
    Block,
    Cell,
    Number,
    ReportEquations,
    ReportPicture,
    ReportTable,
    Section,
    Sentences,
    section,
    table,
)
from core.output.summary import extremes, flywheel, torque
from core.study import Quantity, Study, names_of
from core.study.camshaft import is_complete

ALONE, SHAFT, DRIVE = "alone", "shaft", "drive"
DESIGN, SINGLE, EVERY = (ALONE, SHAFT), (ALONE, DRIVE), (ALONE, SHAFT, DRIVE)
_BALANCE_CAM = ("follower", "cam", "loads", "limits")  # its tables, which no file holds

MAIN: tuple[str, ...] = (
    "displacement", "velocity", "acceleration", "jerk", "pressure_angle", "contact_force", "contact_pressure", "drive_torque",
    "motor_torque", "driver_torque", "driver_force",
)  # fmt: skip
"""Quantities of the main figures, where a design has them."""


FIRST: tuple[str, ...] = (
    "pressure_angle", "contact_force", "contact_pressure", "drive_torque", "driver_torque", "driver_force", "acceleration", "displacement",
)  # fmt: skip
"""Quantities of the first page; the first ones that a design has are shown."""
FIGURES, STEP, GLANCE = 5, 5.0, "glance"
"""Number of figures on the first page; step of a profile's table [deg]; name of the picture on the first page."""
OUTLINE = ("profile_x", "profile_y", "radius", "polar_angle", "outer_x", "outer_y", "second_x", "second_y")


@frozen(eq=False)
class Subject:
    """The subject of a report, or of a part of it.

    Attributes
    ----------
    study : Study
    scope : a design with one drive (ALONE), the shaft of several drives (SHAFT), or a drive of a shaft by its cam angle (DRIVE)
    tables : tables of the file whose values are listed as inputs, besides motion and links
    parts : optional parts that the report contains
    without : quantities that the shaft's part lists
    """

    study: Study
    scope: str
    tables: tuple[str, ...]
    parts: frozenset[str] = frozenset()
    without: frozenset[str] = frozenset()

    def drives(self, without: frozenset[str] = SHAFT_QUANTITIES) -> Iterator[Subject]:
        """Drives of a shaft that have a solution."""
        if self.scope == SHAFT:
            yield from (self.drive(drive, (), without) for drive in self.study.solved_drives.values())

    def drive(self, study: Study, less: Sequence[str], without: frozenset[str] = SHAFT_QUANTITIES) -> Subject:
        """A drive of the shaft; less: tables that are left out besides the shared ones."""
        left_out = (*content.SEPARATE_TABLES, *SHARED, *less)
        return Subject(study, DRIVE, _but(study.design.tables, left_out), self.parts, without)

    def pictures(self, captions: Mapping[str, str]) -> tuple[ReportPicture, ...]:
        """Pictures by name with their captions, where the report contains pictures."""
        shown = captions if "pictures" in self.parts else {}
        return tuple(ReportPicture(name, self.study, caption) for name, caption in shown.items())

    def channels(self) -> Iterable[Quantity]:
        """Quantities whose extremes are listed."""
        return (row for row in channels(self.study.design) if row.name not in self.without)


def subject_of(study: Study, parts: Iterable[str] = ()) -> Subject:
    """Subject of the report of a design."""
    tables = study.design.tables
    if study.design.listed:
        return Subject(study, SHAFT, tuple(name for name in (*SHARED, "balancer") if name in tables), frozenset(parts))
    return Subject(study, ALONE, _but(tables, content.SEPARATE_TABLES), frozenset(parts))


def _but(tables: Iterable[str], left_out: Sequence[str]) -> tuple[str, ...]:
    return tuple(name for name in tables if name not in left_out)


class Chapter(NamedTuple):
    """A chapter of a report.

    Attributes
    ----------
    title : heading; empty where its sections have headings
    scopes : scopes of the subjects whose reports contain it
    sections : its sections, of a subject; without any there is no chapter
    part : optional part that it belongs to; empty where every report contains it
    within : heading in the chapter of a drive, where that is not the title
    """

    title: str
    scopes: Sequence[str]
    sections: Callable[[Subject], Iterable[Section]]
    part: str = ""
    within: str | None = None


def sections_of(rows: Sequence[Chapter], subject: Subject) -> list[Section]:
    """Sections of the chapters in the report of a subject."""
    sections: list[Section] = []
    for row in rows:
        if subject.scope in row.scopes and (not row.part or row.part in subject.parts):
            sections += (_inside if subject.scope == DRIVE else _chapter)(row, list(row.sections(subject)))
    return sections


def _chapter(row: Chapter, sections: Sequence[Section]) -> Sequence[Section]:
    """Sections below the heading of their chapter; a first one without a title joins the heading."""
    if not sections or not row.title:
        return sections
    first, *rest = sections
    if first.title:
        return [Section(row.title, (), 1), first, *rest]
    return [replace(first, title=row.title, level=1), *rest]


def _inside(row: Chapter, sections: Sequence[Section]) -> Sequence[Section]:
    """Sections in the chapter of a drive, where a section without a title gets that of its chapter."""
    title = row.title if row.within is None else row.within
    return [replace(part, title=title) if part.title in ("", "Segments") else part for part in sections]


# -- chapters of the HTML and PDF report --------------------------------------------------------------------


def _with(sections: list[Section], blocks: tuple[Block, ...]) -> list[Section]:
    """Sections with blocks before them."""
    return [Section("", blocks), *sections] if blocks else sections


def _untitled(sections: Iterable[Section]) -> list[Section]:
    return [replace(part, title="") for part in sections]


def _glance(subject: Subject) -> list[Section]:
    """The first page: the machine, the main figures and the findings."""
    study = subject.study
    drawn = is_complete(study.camshaft) if subject.scope == SHAFT else "linkage" in study.stages or study.has_surface
    pictures = subject.pictures({GLANCE: "The machine, to scale."}) if drawn else ()
    rows = [
        (label, value, unit, Number(angle) if angle is not None else "")
        for label, value, unit, angle in _first_figures(subject)
    ]
    figures = table(("", "", "", "at °"), rows, left=1, slug="glance") if rows else None
    return [*section("", *pictures, figures), *content.findings(study)]


def _first_figures(subject: Subject) -> list[tuple[str, Number, str, float | None]]:
    """At most ``FIGURES`` figures: of a shaft its torque and power, else the greatest values of the first quantities."""
    study = subject.study
    wheel = [
        ("Flywheel needed", Number(value), "kg·m²", None)
        for value in (flywheel(study).get("needed_inertia_kg_m2"),)
        if value is not None
    ]
    if subject.scope == SHAFT:
        if not is_complete(study.camshaft):
            return []
        figures = torque(study.camshaft)
        return [
            ("Largest torque of the shaft", Number(figures["peak_nm"]), "N·m", figures["peak_angle_deg"]),
            ("Root mean square", Number(figures["rms_nm"]), "N·m", None),
            ("Peak power", Number(figures["peak_power_w"]), "W", None),
            *wheel,
        ]
    values, order = extremes(study, study.stages), {name: i for i, name in enumerate(FIRST)}
    rows = sorted(
        (row for row in subject.channels() if row.name in order and row.slug in values), key=lambda row: order[row.name]
    )
    greatest = [(row, max(values[row.slug].values(), key=lambda end: abs(end["value"]))) for row in rows]
    extremes_shown = [
        (row.label, Number(end["value"]), row.unit.symbol, end["cam_angle_deg"])
        for row, end in greatest
        if end["value"]
    ]
    return [*extremes_shown[: FIGURES - len(wheel)], *wheel]


def _profile(subject: Subject) -> list[Section]:
    """Points of every profile in steps of ``STEP``, by cam angle."""
    if not subject.study.has_disk:
        return []
    study = subject.study.at_theta(np.deg2rad(np.arange(0.0, 360.0, STEP)))
    rows = [row for row in subject.channels() if row.name in OUTLINE and row.name in names_of(study.design)]
    columns = [np.rad2deg(study.theta), *(row.values(study) for row in rows)]
    cells: list[tuple[Cell, ...]] = [
        (result_text(angle), *(Number(value, MOST_DIGITS) for value in values))
        for angle, *values in zip(*columns, strict=True)
    ]
    header = ("cam angle °", *(f"{in_sentence(row.label)} {row.unit.symbol}" for row in rows))
    note = Sentences(
        (f"In steps of {STEP:g}°, in the frame of the cam; the profile file has the profile to its stated deviation.",)
    )
    return section("", note, table(header, cells, left=0, slug="profile"))


def _main(subject: Subject) -> list[Section]:
    """Lowest and highest values of the main quantities, and the limits."""
    study = subject.study
    rows = sorted((row for row in subject.channels() if row.name in MAIN), key=lambda row: MAIN.index(row.name))
    sections = section("", content.extreme_rows(study, rows, study.stages, "main"))
    sections += content.limits(study, study.stages)
    return sections


def _inputs(subject: Subject) -> list[Section]:
    """Inputs after the meaning of their mark and the reasons that no table lists."""
    sections = content.table_sections(subject.study.design, subject.tables, why=True)
    keys = {key for part in sections for block in part.blocks if isinstance(block, ReportTable) for key in block.keys}
    sections = [*content.linkage_inputs(subject.study), *sections] if subject.scope != SHAFT else sections
    note = content.assumed_note(
        subject.study, lambda path: path.startswith("drives[") or not keys.isdisjoint(content.rows_of(path))
    )
    noted = _with(sections, (note,)) if note is not None and sections else sections
    if subject.scope != DRIVE:
        return noted
    return [replace(part, title=f"Inputs: {part.title.lower()}") if part.title else part for part in noted]


def _timing(subject: Subject) -> list[Section]:
    caption = "Motions of all drives over the machine angle; a line between two events is a condition on their order."
    return _with(content.timing(subject.study.design), subject.pictures({"timing": caption}))


def _valve_train(subject: Subject) -> list[Section]:
    if not subject.study.design.has_valves:
        return []
    from core.output.report.valve_train import valve_train  # only reports of valve trains need it

    caption = "Lifts of the valves over the crank from TDC of overlap; points are the typed rows of the lobes."
    return _with(valve_train(subject.study.design), subject.pictures({"valves": caption}))


def _motion(subject: Subject) -> list[Section]:
    if "motion" not in subject.study.stages:
        return []
    of = " of the follower over one turn of the cam" if subject.study.has_disk else " over one turn"
    caption = f"Displacement, velocity, acceleration and jerk{of}, with their extremes."
    segments = [replace(part, title="Segments") for part in content.motion(subject.study)]
    return [*segments, *content.cycle(subject.study), *section("Curves", *subject.pictures({"motion": caption}))]


def _cam(subject: Subject) -> list[Section]:
    if subject.study.has_surface:
        in_space = {"cam": "Pressure angle, curvature and sliding over one turn, each the worst along the roller."}
        views = "The cam with its rollers and the output, to scale, in side view and end view, where the pressure angle is greatest."
        return _with(section("Curves of the cam", *subject.pictures(in_space)), subject.pictures({"mechanism": views}))
    if not subject.study.has_disk:
        return []
    curves = {"cam": "Pressure angle, curvature and radius of the cam over one turn."}
    return _mechanism(subject, "Curves of the cam", curves, " where the pressure angle is greatest")


def _links(subject: Subject) -> list[Section]:
    if subject.study.has_disk or "linkage" not in subject.study.stages:
        return []
    curves = {"links": "Motion and transmission angles of the links over one turn."}
    return _mechanism(subject, "Curves of the links", curves, "")


def _mechanism(subject: Subject, title: str, curves: Mapping[str, str], where: str) -> list[Section]:
    drawn = subject.pictures({"mechanism": f"The mechanism to scale{where}."})
    return _with([*section(title, *subject.pictures(curves)), *content.base(subject.study)], drawn)


def _forces(subject: Subject) -> list[Section]:
    study = subject.study
    wheel = _flywheel(subject) if subject.scope == ALONE else []
    values = extremes(study, ("dynamics",)) if "dynamics" in study.stages else {}
    if not any(
        end["value"] for row in values.values() for end in row.values()
    ):  # a guide jams, or nothing has a mass or a load
        return wheel
    caption = "Forces and torque over one turn at the design's speed."
    parts = [*content.contact(study), *content.vibration(study), *content.life(study)]
    return [*_with(parts, subject.pictures({"forces": caption})), *wheel]


def _torque(subject: Subject) -> list[Section]:
    if not is_complete(subject.study.camshaft):
        return []
    caption = "Torque of every drive and of all drives over the machine angle, and the speed of the shaft."
    torque = content.torque(subject.study.camshaft)
    return [*_with(torque, subject.pictures({"torque": caption})), *_flywheel(subject)]


def _flywheel(subject: Subject) -> list[Section]:
    """The flywheel; the mean torque of a shaft is listed with the torque of all drives."""
    return content.flywheel(subject.study, flywheel(subject.study), with_mean=subject.scope == ALONE)


def _stability(subject: Subject) -> list[Section]:
    sections = content.shaft_stability(subject.study)
    if not sections:
        return []
    caption = "Forbidden bands by frequency ratio and inertia ratio, with the machine's point."
    return [replace(sections[0], title=""), *section("Chart", *subject.pictures({"stability": caption}))]


def _each_drive(subject: Subject) -> list[Section]:
    """A chapter of every drive by its cam angle, then of the balance cam, without the quantities of the shaft."""
    camshaft = subject.study.camshaft
    drives = [(f"Drive {printable(drive.study.design.name)}", drive) for drive in subject.drives()]
    if subject.study.design.balancer is not None and is_complete(camshaft) and camshaft.balancer is not None:
        drives.append(("Balance cam", subject.drive(camshaft.balancer, _BALANCE_CAM)))
    return [
        part
        for title, drive in drives
        for part in _chapter(Chapter(title, SHAFT, _each_drive), sections_of(CHAPTERS, drive))
    ]


def _others(subject: Subject) -> list[Section]:
    rows = (row for row in subject.channels() if row.name not in MAIN)
    return _untitled(content.extreme_values(subject.study, rows, subject.study.stages))


def _certificate(subject: Subject) -> list[Section]:
    text = "Every residual is computed for this design; it must not exceed its bound, which follows from rounding."
    return [Section("", (Sentences((text,)), *part.blocks)) for part in content.certificate(subject.study)]


CHAPTERS: tuple[Chapter, ...] = (
    Chapter("At a glance", DESIGN, _glance),
    Chapter("Drives", (SHAFT,), lambda subject: _untitled(content.drives(subject.study.camshaft))),
    Chapter("Main figures", SINGLE, _main, within=""),
    Chapter("Inputs", SINGLE, _inputs, "inputs"),
    Chapter("Inputs of the shaft", (SHAFT,), _inputs, "inputs"),
    Chapter("Timing", (SHAFT,), _timing),
    Chapter("Valve train", DESIGN, _valve_train),
    Chapter("Motion", SINGLE, _motion),
    Chapter("Mechanism and cam", SINGLE, _cam, within="Mechanism"),
    Chapter("Mechanism", SINGLE, _links),
    Chapter("Forces and torque", SINGLE, _forces),
    Chapter("Torque of the shaft", (SHAFT,), _torque),
    Chapter("Flexible shaft", DESIGN, _stability),
    Chapter("", (SHAFT,), _each_drive),
    Chapter("Profile", SINGLE, _profile, "profile"),
    Chapter("Extremes over one turn of all other quantities", SINGLE, _others, "extremes"),
    Chapter("Certificate", DESIGN, _certificate, "certificate"),
    Chapter("Equations used", DESIGN,
            lambda subject: [Section("", (ReportEquations(equations_of(subject.study)),))], "equations"),
    Chapter("Comparison with the paper", DESIGN, lambda subject: content.paper_claims(subject.study.design), "papers"),
    Chapter("Conventions and sources", DESIGN, lambda subject: content.conventions(subject.study), "conventions"),
)  # fmt: skip
"""Chapters of the HTML and PDF report, in their order."""


# -- sections of the plain text -----------------------------------------------------------------------------


def _marked_inputs(subject: Subject) -> list[Section]:
    """Inputs, with the meaning of the mark of assumed values below the last table."""
    sections = content.table_sections(subject.study.design, subject.tables)
    note = content.assumed_note(subject.study, lambda path: path.startswith("drives["))
    if note is None or not sections:
        return sections
    return [*sections[:-1], replace(sections[-1], blocks=(*sections[-1].blocks, note))]


TEXT: tuple[Chapter, ...] = (
    Chapter("", (SHAFT,), lambda subject: content.drives(subject.study.camshaft)),
    Chapter("", SINGLE, lambda subject: content.linkage_inputs(subject.study)),
    Chapter("", EVERY, _marked_inputs),
    Chapter("", (SHAFT,), lambda subject: content.timing(subject.study.design)),
    Chapter("", DESIGN, lambda subject: [replace(part, title=part.title or "Valve train") for part in _valve_train(subject)]),
    Chapter("", (SHAFT,), lambda subject: content.torque(subject.study.camshaft)),
    Chapter("", SINGLE, lambda subject: content.motion(subject.study)),
    Chapter("", SINGLE, lambda subject: content.cycle(subject.study)),
    Chapter("", SINGLE, lambda subject: content.base(subject.study)),
    Chapter("", SINGLE, lambda subject: content.extreme_values(subject.study, subject.channels(), subject.study.stages)),
    Chapter("", SINGLE, lambda subject: content.limits(subject.study, subject.study.stages)),
    Chapter("", SINGLE, lambda subject: content.contact(subject.study)),
    Chapter("", SINGLE, lambda subject: content.vibration(subject.study)),
    Chapter("", SINGLE, lambda subject: content.life(subject.study)),
    Chapter("", DESIGN, _flywheel),
    Chapter("", DESIGN, lambda subject: content.shaft_stability(subject.study)),
    Chapter("", DESIGN, lambda subject: content.findings(subject.study)),
    Chapter("", DESIGN, lambda subject: content.certificate(subject.study)),
)  # fmt: skip
"""Chapters of the plain text, in their order; their sections have titles."""
