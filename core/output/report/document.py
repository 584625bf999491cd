"""The report to hand on: a title block and chapters, some of which may be left out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType

from core import __version__
from core.findings import ERROR, NOTE, WARNING
from core.frozen import frozen
from core.output.channels import channels
from core.output.drawing.tables import mechanism_text
from core.output.export import OF_SHAFT
from core.output.lines import printable
from core.output.report import of_camshaft, of_stability, of_study
from core.output.report.equations import Equation, answering, equations_of
from core.output.report.of_papers import of_papers
from core.output.report.parts import (
    Block,
    ReportEquations,
    ReportPicture,
    ReportTable,
    Section,
    Sentences,
    section,
    table,
)
from core.output.summary import answers, extremes, flywheel
from core.study import Study, certificate_of, findings_of
from core.study.cam_checks import limit_rows

SENSES: Mapping[str, str] = MappingProxyType({"ccw": "counter-clockwise", "cw": "clockwise"})

PARTS: Mapping[str, str] = MappingProxyType(
    {
        "inputs": "Inputs, and what is assumed",
        "pictures": "Drawings and curves",
        "extremes": "Extremes of all quantities",
        "certificate": "Certificate with bounds",
        "equations": "Equations used, with their source",
        "papers": "What a paper says, of a paper's example",
        "conventions": "Conventions and sources",
    }
)
"""What may be left out of a report; the main figures, limits and findings always stand in it."""


@frozen(eq=False)
class Document:
    """title: the design's name; rows: of the title block, name and text; chapters: sections, those of level 1 begin one."""

    title: str
    rows: tuple[tuple[str, str], ...]
    sections: tuple[Section, ...]

    @property
    def pictures(self) -> tuple[ReportPicture, ...]:
        """Every picture of the document, in order."""
        return tuple(block for each in self.sections for block in each.blocks if isinstance(block, ReportPicture))


@frozen(eq=False)
class Printed:
    """A document that is to be a file of this ending."""

    document: Document
    ending: str


ENDINGS = (".html", ".pdf")


def document(study: Study, parts: Collection[str] = tuple(PARTS)) -> Document:
    """The report of a design or of a shaft with several drives. Raises NoAnswer where it has none."""
    wanted = frozenset(parts)
    chapters = list(_of_camshaft(study, wanted) if study.design.listed else _of_study(study, wanted))
    used = equations_of(study)
    if "equations" in wanted:
        chapters += _chapter("Equations used", [Section("", (ReportEquations(used),))])
    if "papers" in wanted:
        chapters += _chapter("Held against the paper", of_papers(study.design))
    if "conventions" in wanted:
        chapters += _chapter("Conventions and sources", _conventions(study, used, chapters))
    return Document(printable(study.design.name), _title_rows(study), tuple(chapters))


def _chapter(title: str, sections: Iterable[Section]) -> list[Section]:
    """The sections below a heading of their own; none where there is none. One without a title joins the heading."""
    there = list(sections)
    if not there:
        return []
    first = [replace(there[0], title=title, level=1)] if not there[0].title else [Section(title, (), 1), there[0]]
    return [*first, *there[1:]]


# -- title block --------------------------------------------------------------------------------------------


def _title_rows(study: Study) -> tuple[tuple[str, str], ...]:
    design = study.design
    findings, proof = findings_of(study, ()), certificate_of(study, ())
    counts = Counter(each.severity for each in findings)
    found = ", ".join(f"{counts[s]} {s}{'s' if counts[s] > 1 else ''}" for s in (ERROR, WARNING, NOTE) if counts[s])
    kept = sum(each.kept for each in proof.values())
    rows = [("Mechanism", _mechanism(study)), ("Speed", f"{design.speed_rpm:.10g} rpm{_sense(study)}")]
    assumed = len(design.assumed)
    rows += [("Assumed", f"{assumed} of the inputs, marked {of_study.ASSUMED}" if assumed else "none of the inputs")]
    rows += [("Findings", found or "none"), ("Certificate", f"{kept} of {len(proof)} residuals within their bounds")]
    return (*rows, ("Computed with", f"KINDYNA {__version__}"))


def _sense(study: Study) -> str:
    """The sense of the shaft, of a design that has one."""
    return "" if study.design.shaft is None else f", {SENSES[study.design.shaft.rotation]}"


def _mechanism(study: Study) -> str:
    if study.design.listed:
        balanced = " and a balance cam" if study.design.balancer is not None else ""
        return f"{len(study.drives)} drives on one shaft{balanced}"
    drive = study.design.drive
    return mechanism_text(study) + ("" if drive.cam is None else f", {drive.face.noun}, {drive.cam.form.form} cam")


# -- one design ---------------------------------------------------------------------------------------------

MAIN: tuple[str, ...] = (
    "displacement", "velocity", "acceleration", "jerk", "pressure_angle", "contact_force", "contact_pressure", "drive_torque",
    "motor_torque", "driver_torque", "driver_force",
)  # fmt: skip
"""Quantities of the main figures, those that a design has."""
OTHERS = "Extremes over one turn of all other quantities"


def _of_study(study: Study, wanted: Collection[str]) -> list[Section]:
    """The chapters of one design."""
    stages, wheel = study.stages, flywheel(study)
    judged = [*of_study.limits(study, stages), *of_study.findings(study)]
    sections = _chapter("Main figures", [*_main(study), *judged])
    if "inputs" in wanted:
        sections += _chapter("Inputs", _inputs(study, ("motion", "linkage")))
    sections += _chapter("Motion", _motion(study, wanted))
    sections += _chapter("Mechanism and cam" if "cam" in stages else "Mechanism", _cam(study, wanted))
    sections += _chapter("Forces and torque", [*_forces(study, wanted), *of_study.flywheel(study, wheel)])
    sections += _chapter("Flexible shaft", _stability(study, wanted))
    if "extremes" in wanted:
        sections += _chapter(OTHERS, _extremes(study))
    if "certificate" in wanted:
        sections += _chapter("Certificate", _certificate(study))
    return sections


def _main(study: Study, without: frozenset[str] = frozenset()) -> list[Section]:
    """Lowest and highest of what a reader asks for first."""
    rows = (row for row in channels(study.design) if row.name in MAIN and row.name not in without)
    return section(
        "", of_study.extreme_rows(study, sorted(rows, key=lambda row: MAIN.index(row.name)), study.stages, "main")
    )


def _inputs(study: Study, without: tuple[str, ...]) -> list[Section]:
    sections = of_study.inputs(study, without, why=True)
    keys = _keys(sections)
    return _noted(
        study, [*of_study.linkage_inputs(study), *sections], lambda path: not keys.isdisjoint(of_study.rows_of(path))
    )


def _keys(sections: Iterable[Section]) -> frozenset[str]:
    """Paths of the values that stand in tables."""
    return frozenset(
        key for each in sections for block in each.blocks if isinstance(block, ReportTable) for key in block.keys
    )


def _noted(study: Study, sections: list[Section], elsewhere: Callable[[str], bool]) -> list[Section]:
    """Ahead of the inputs what their mark means, and the reasons that stand beside none of them."""
    note = of_study.assumed_note(study, elsewhere)
    return [Section("", (note,)), *sections] if note is not None and sections else sections


def _pictures(study: Study, wanted: Collection[str], captions: Mapping[str, str]) -> tuple[ReportPicture, ...]:
    return (
        tuple(ReportPicture(name, study, caption) for name, caption in captions.items()) if "pictures" in wanted else ()
    )


def _with(sections: list[Section], blocks: tuple[Block, ...]) -> list[Section]:
    """Blocks ahead of the sections."""
    return [Section("", blocks), *sections] if blocks else sections


def _motion(study: Study, wanted: Collection[str]) -> list[Section]:
    if "motion" not in study.stages:
        return []
    caption = (
        "Displacement, velocity, acceleration and jerk of the follower over one turn of the cam, with their extremes."
    )
    typed = [replace(each, title="Segments") for each in of_study.motion(study)]
    return [*typed, *section("Curves", *_pictures(study, wanted, {"motion": caption}))]


def _cam(study: Study, wanted: Collection[str]) -> list[Section]:
    has_cam = "cam" in study.stages
    where = " where the pressure angle is greatest" if has_cam else ""
    name, title, caption = (
        "cam",
        "Curves of the cam",
        "Pressure angle, curvature and radius of the cam over one turn.",
    )
    if not has_cam:
        name, title, caption = (
            "links",
            "Curves of the links",
            "Motion and transmission angles of the links over one turn.",
        )
    curves = section(title, *_pictures(study, wanted, {name: caption}))
    return _with(
        [*curves, *of_study.base(study)], _pictures(study, wanted, {"mechanism": f"The mechanism to scale{where}."})
    )


def _forces(study: Study, wanted: Collection[str]) -> list[Section]:
    there = extremes(study, ("dynamics",)) if "dynamics" in study.stages else {}
    if not any(
        end["value"] for row in there.values() for end in row.values()
    ):  # a guide jams, or nothing has a mass or a load
        return []
    caption = "Forces and torque over one turn at the design's speed."
    own = [*of_study.contact(study), *of_study.vibration(study), *of_study.life(study)]
    return _with(own, _pictures(study, wanted, {"forces": caption}))


def _stability(study: Study, wanted: Collection[str]) -> list[Section]:
    sections = of_stability.shaft_stability(study)
    if not sections:
        return []
    caption = {"stability": "Forbidden bands by frequency ratio and inertia ratio, with the machine's place."}
    return [replace(sections[0], title=""), *section("Chart", *_pictures(study, wanted, caption))]


def _extremes(study: Study, without: frozenset[str] = frozenset()) -> list[Section]:
    rows = (row for row in channels(study.design) if row.name not in without and row.name not in MAIN)
    return [replace(each, title="") for each in of_study.extreme_values(study, rows, study.stages)]


def _certificate(study: Study) -> list[Section]:
    text = "Each residual is computed anew for this very design; it is kept where it is not above its bound, which follows from rounding."
    return [Section("", (Sentences((text,)), *each.blocks)) for each in of_study.certificate(study)]


# -- several drives -----------------------------------------------------------------------------------------


def _of_camshaft(study: Study, wanted: Collection[str]) -> list[Section]:
    """The whole, then each of its drives, then the balance cam."""
    camshaft = study.camshaft
    first = [replace(each, title="") for each in of_camshaft.drives(camshaft)]
    sections = _chapter("Drives", [*first, *of_study.findings(study)])
    if "inputs" in wanted:
        sections += _chapter("Inputs of the shaft", _shaft_inputs(study))
    chart_of_all = {
        "timing": "Motions of all drives over the machine angle; lines from event to event are what must come after what."
    }
    sections += _chapter("Timing", _with(of_camshaft.timing(study.design), _pictures(study, wanted, chart_of_all)))
    if answers(camshaft):
        caption = {
            "torque": "Torque of each drive and of all together over the machine angle, and the speed of the shaft."
        }
        torque = _with(of_camshaft.torque(camshaft), _pictures(study, wanted, caption))
        sections += _chapter("Torque of the shaft", [*torque, *of_study.flywheel(study, flywheel(study))])
        sections += _chapter("Flexible shaft", _stability(study, wanted))
    for name, each in study.drives.items():
        if name not in camshaft.failures:
            sections += _drive(f"Drive {printable(name)}", each, wanted)
    if study.design.balancer is not None and answers(camshaft) and camshaft.balancer is not None:
        sections += _drive("Balance cam", camshaft.balancer, wanted, ("follower", "cam", "loads", "limits"))
    if "certificate" in wanted:
        sections += _chapter("Certificate", _certificate(study))
    return sections


def _shaft_inputs(study: Study) -> list[Section]:
    names = [name for name in ("shaft", "balancer") if name in study.design.tables]
    sections = of_study.table_sections(study.design, names, why=True)
    own = _keys(sections)
    return _noted(study, sections, lambda path: path in own or path.startswith("drives["))


def _drive(title: str, study: Study, wanted: Collection[str], without: tuple[str, ...] = ()) -> list[Section]:
    """The chapter of one drive, by its own angle; what belongs to the shaft is left out."""
    sections = [*_main(study, OF_SHAFT), *of_study.limits(study, study.stages)]
    if "inputs" in wanted:
        inputs = _inputs(study, ("motion", "linkage", "shaft", *without))
        sections += [
            replace(each, title=f"Inputs: {each.title.lower()}" if each.title else "Inputs") for each in inputs
        ]
    sections += [_named(each, "Motion") for each in _motion(study, wanted)]
    sections += [_named(each, "Mechanism") for each in _cam(study, wanted)]
    sections += [_named(each, "Forces and torque") for each in _forces(study, wanted)]
    if "extremes" in wanted:
        sections += [_named(each, OTHERS) for each in _extremes(study, OF_SHAFT)]
    return _chapter(title, sections)


def _named(each: Section, title: str) -> Section:
    """What had no title because its chapter had, and what would repeat."""
    return replace(each, title=title if each.title in ("", "Segments") else each.title)


# -- conventions and sources --------------------------------------------------------------------------------

CONVENTIONS: tuple[str, ...] = (
    "Global frame: origin at the centre of the cam or at the frame of the linkage, x to the right, y upwards, angles counter-clockwise.",
    "The cam angle θ grows with time, whichever way the shaft turns; angle 0 is the start of the first segment.",
    "Vectors of the plane are written as complex numbers; · and × are their scalar and vector product, a bar the conjugate of a "
    "vector, or the mean of a scalar.",
    "A curvature is positive where the cam is convex. The contact force is positive where it presses the follower on the cam. "
    "A drive torque is positive where it drives.",
    "Extremes are refined to the true extreme of the continuous curve, not read from a table; where a quantity jumps, both sides count.",
    "Numbers are rounded for reading; summary.json of the same design holds all their digits.",
)

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


def _conventions(study: Study, used: Iterable[Equation], chapters: Iterable[Section]) -> list[Section]:
    rows_of_all = (row for each in answering(study) for row in limit_rows(each, each.stages))
    named = " ".join([*(row.source for row in used), *(row.source for row in rows_of_all)])
    rows = [(name, text) for name, text in SOURCES.items() if name in named]
    corrected = (
        "corrected: the printed equation is wrong there, and the one given here is computed."
        if "corrected" in named
        else ""
    )
    remark = Sentences((corrected,), mark=True) if corrected else None
    return [Section("", (Sentences(CONVENTIONS),)), *section("Sources", table((), rows, left=2), remark)]


__all__ = ["ENDINGS", "PARTS", "Document", "Printed", "document"]
