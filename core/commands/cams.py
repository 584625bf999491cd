"""Commands about cams: contact, inspection, profile and vibration."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from core.commands import DONE, DONE_WITH_ERRORS, Painter
from core.commands.common import (
    DriveArguments,
    as_json,
    design_file,
    drive_name,
    one_studied,
    require_cam,
    samples_per_turn,
    verdict,
)
from core.design.fields import flag, number, whole
from core.findings import ERROR
from core.frozen import frozen
from core.motion import degrees
from core.number_text import result_text, rounded_up, signed_text
from core.output.files.files import FORMATS, facts_text, profile_job, write_profile
from core.output.files.inspection import (
    Inspection,
    ProfileComparison,
    compare,
    facts,
    inspection,
    read_lift,
    require_name,
    write_inspection,
)
from core.output.files.probe import InspectionRequest
from core.output.files.profile_request import ProfileRequest
from core.output.lines import finding_line, printable
from core.output.subject_files import (
    CONTACT_SPEEDS,
    SPECTRUM_SPEEDS,
    contact_force_map,
    contact_map_csv,
    elastic_figures,
    elastic_lines,
    flight_lines,
    lift_off_lines,
    spectrum_csv,
    spectrum_speeds,
    spectrum_table,
)
from core.output.summary import to_json
from core.project import load, load_one
from core.project.files import read_bytes, write_all
from core.requests import option, text_option
from core.study import Study

# -- the command ``contact`` ------------------------------------------------------------------------------------


@frozen(kw_only=True)
class ContactArguments(DriveArguments):
    """Arguments of ``contact``: a design, whether flights are computed, and the samples of the map."""

    flights: bool = flag("Flights", help="compute the motion of the follower after it has left the cam")
    turns: float = option(
        number("Turns", 0.0, 200.0, open_low=True, default=3.0, help="number of turns to compute"), metavar="N"
    )
    out: Path | None = text_option(
        "the contact force over cam angle and speed", default=None, type=Path, metavar="FILE.csv"
    )
    samples: int = samples_per_turn(help="cam angles of the table", default=360)
    speeds: int = whole("Speeds of the map", 1, 2000, default=CONTACT_SPEEDS, help="speeds of the table")
    rpm: float | None = option(
        number("Speed", 0.0, 1e5, open_low=True, default=None, help="highest speed of the table"),
        default_text="above the design's speed and that of lift-off",
        metavar="RPM",
    )


def run_contact(arguments: ContactArguments, painter: Painter | None) -> int:
    """Print the speed of lift-off, with flights where requested; write the map to a file."""
    study = one_studied(load(arguments.design), arguments.drive)
    require_cam(study, "contact")
    study.contact_force  # noqa: B018 - raises, and says why, where no contact can be lost
    lines = lift_off_lines(study)
    if arguments.flights:
        lines += ["", *flight_lines(study, study.flights(arguments.turns))]
    if arguments.out is not None:
        theta = np.deg2rad(degrees(arguments.samples))
        force_map = contact_force_map(study, theta, arguments.rpm, arguments.speeds)
        write_all(arguments.out.parent, {arguments.out.name: contact_map_csv(force_map)})
    print("\n".join(lines))
    return DONE


# -- the command ``inspection`` ---------------------------------------------------------------------------------


@frozen(kw_only=True)
class InspectionArguments(DriveArguments):
    """Arguments of ``inspection``: a cam, its inspection, and a measured table to compare with."""

    out: Path = text_option("table to write (.csv), with summary.json in the same folder", type=Path, metavar="FILE")
    request: InspectionRequest = InspectionRequest()
    measured: Path | None = text_option(
        "measured table: cam angle and lift in each row", default=None, type=Path, metavar="TABLE"
    )
    fit: bool = flag("Fit", help="fit the zero marks of its angles and of its lift by least squares")
    json: bool = as_json()


def run_inspection(arguments: InspectionArguments, painter: Painter | None) -> int:
    """Write the files, and print the verdict."""
    require_name(arguments.out)
    result, comparison = inspection(Study(load_one(arguments.design, arguments.drive)), arguments.request), None
    if arguments.measured is not None:
        comparison = compare(
            result.setup, read_lift(read_bytes(arguments.measured), arguments.measured.name), arguments.fit
        )
    elif arguments.fit:
        print("--fit is ignored: there is no measured table", file=sys.stderr)
    paths = write_inspection(result, arguments.out, comparison)
    if arguments.json:
        print(to_json(facts(result, comparison)), end="")
    else:
        print("\n".join([*map(str, paths), *_lines(result, comparison)]))
    findings = result.setup.findings if comparison is None else comparison.findings
    for finding in findings:
        print(finding_line(finding), file=sys.stderr)
    return DONE_WITH_ERRORS if any(finding.severity == ERROR for finding in findings) else DONE


def _lines(result: Inspection, comparison: ProfileComparison | None) -> list[str]:
    """Summary of the files in lines."""
    setup = result.setup
    size = f", radius {result_text(setup.radius, 6)} mm" if setup.kind.radius else ""
    lines = [
        f"{setup.kind.label}{size}; lift 0 at {result_text(setup.base, 6)} mm from the cam centre, largest "
        f"{result_text(result.table.lift.max(), 6)} mm",
    ]
    if comparison is None:
        return lines
    row = comparison.worst_row
    if comparison.is_fitted:
        lines.append(
            f"fitted: cam angle = angle {signed_text(comparison.angle_offset)} deg, lift = measured "
            f"{signed_text(-comparison.lift_offset)} mm"
        )
    band = setup.request.tolerance_mm
    lines += [
        *(printable(note) for note in comparison.notes),
        f"{comparison.lines.size} rows; largest deviation {signed_text(comparison.normal_deviation[row])} mm normal to the profile "
        f"({signed_text(comparison.deviation[row])} mm of lift) at {result_text(comparison.table.degrees[row])} "
        f"deg, line {comparison.lines[row]}",
        f"in tolerance, ± {band:g} mm"
        if comparison.is_in_tolerance
        else f"OUT OF TOLERANCE, ± {band:g} mm, in {comparison.is_outside.sum()} rows",
    ]
    return lines


# -- the command ``profile`` ------------------------------------------------------------------------------------


@frozen(kw_only=True)
class ProfileArguments:
    """Arguments of ``profile``: a cam and the content of the file."""

    design: Path = design_file()
    out: Path = text_option(
        f"file to write, with one of the endings {'|'.join(FORMATS)}; FILE.json has the facts, as --json prints them",
        type=Path,
        metavar="FILE",
    )
    drive: str = drive_name()
    request: ProfileRequest = ProfileRequest()
    json: bool = as_json()


def run_profile(arguments: ProfileArguments, painter: Painter | None) -> int:
    """Write the file, and print its deviation."""
    study = one_studied(load(arguments.design), arguments.drive)
    job = profile_job(study, arguments.out, arguments.request)
    paths, main = write_profile(job, arguments.out), job.main
    if arguments.json:
        print(facts_text(job, arguments.out), end="")
    else:
        for path in paths:
            print(path)
        print(
            f"{main.count} points on {result_text(main.curve.length, 6)} mm, at most "
            f"{rounded_up(main.deviation, 4):g} mm from the exact curve"
        )
    return verdict(study, ("cam",))


# -- the command ``vibration`` ----------------------------------------------------------------------------------


FASTEST = 1e5


def _speeds(text: str) -> tuple[float, float]:
    low, colon, high = text.partition(":")
    try:
        ends = float(low), float(high)
    except ValueError:
        ends = (0.0, 0.0)
    if not (colon and 0.0 < ends[0] < ends[1] <= FASTEST):
        raise argparse.ArgumentTypeError(f"{text!r}: range of speeds; allowed: A:B in rpm, 0 < A < B <= {FASTEST:g}")
    return ends


@frozen(kw_only=True)
class VibrationArguments(DriveArguments):
    """Arguments of ``vibration``: a design and the speeds of the spectrum."""

    speeds: tuple[float, float] | None = text_option(
        "range of speeds of the spectrum, in rpm",
        default=None,
        default_text="up to twice the design's speed",
        type=_speeds,
        metavar="A:B",
    )
    count: int = whole("Speeds of the spectrum", 2, 5000, default=SPECTRUM_SPEEDS, help="speeds of the spectrum")
    out: Path | None = text_option("the spectrum as a table", default=None, type=Path, metavar="FILE.csv")
    json: bool = as_json("figures and spectrum as JSON")


def run_vibration(arguments: VibrationArguments, painter: Painter | None) -> int:
    """Print the residual vibration in every dwell of an elastic follower; write the spectrum to a file."""
    study = Study(load_one(arguments.design, arguments.drive))
    require_cam(study, "vibration")
    study.elasticity  # noqa: B018 - raises, and says why, where nothing vibrates
    low, high = arguments.speeds or (None, None)
    spectrum = None
    if arguments.out is not None or arguments.json:
        spectrum = study.vibration(spectrum_speeds(study, low, high, arguments.count))
    if arguments.out is not None and spectrum is not None:
        write_all(arguments.out.parent, {arguments.out.name: spectrum_csv(study, spectrum)})
    if arguments.json and spectrum is not None:
        table = {name: column.tolist() for name, column in spectrum_table(study, spectrum).items()}
        print(to_json({**elastic_figures(study), "spectrum": table}), end="")
    else:
        print("\n".join(elastic_lines(study)))
    return DONE
