"""The drawing of a cam as the core lays it out: what it states, against closed forms and the tables; and that nothing overlaps."""

from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from mechanisms import PUSHER, levels, with_cam, with_drive, with_shaft
from PIL import Image
from sampled import spread

from core.design import Design
from core.errors import KindynaError, NoCam
from core.output.files.cam_drawing import drawing
from core.output.files.sheet import PAPERS, DrawingRequest, DrawingSheet, SheetCircle, SheetLine, SheetLogo, SheetText
from core.project import load, load_one
from core.study import Study, extremes_of

EXAMPLES = Path(__file__).parents[3] / "resources/examples"
STANDARD = {f"{n}:1" for n in (1, 2, 5, 10, 20, 50)} | {
    f"1:{n}" for n in (2, 5, 10, 20, 50, 100, 200, 500, 1000)
}  # ISO 5455

# a rise so steep that the cam is hollow there
HOLLOW = with_cam(with_drive(PUSHER, motion=levels(0.0, (40.0, 0.0, "dwell"), (80.0, 40.0, "cycloidal"), (130.0, 40.0, "dwell"),
                                                   (110.0, 0.0, "3-4-5"))), base_radius_mm=30.0)  # fmt: skip
KEYED = with_cam(
    HOLLOW,
    bore_mm=20.0,
    hub_mm=34.0,
    keyway_width_mm=6.0,
    keyway_depth_mm=2.8,
    keyway_angle_deg=90.0,
    thickness_mm=12.0,
)


def texts(sheet: DrawingSheet) -> list[SheetText]:
    return [item for item in sheet.items if isinstance(item, SheetText)]


def beside(sheet: DrawingSheet, name: str) -> list[str]:
    """What stands in the row of a table that begins with a name."""
    first = next(text for text in texts(sheet) if text.text == name)
    row = [
        t
        for t in texts(sheet)
        if abs(t.at.imag - first.at.imag) < 1e-9 and t.at.real > first.at.real and t.height == first.height
    ]
    return [text.text for text in sorted(row, key=lambda t: t.at.real)]


def field(sheet: DrawingSheet, name: str) -> str:
    """What stands below the name of a field of the title block."""
    label = min((text for text in texts(sheet) if text.text == name), key=lambda t: t.height)
    below = [
        t for t in texts(sheet) if t.at.real == label.at.real and 0.0 < label.at.imag - t.at.imag < 5.0 * label.height
    ]
    return below[0].text if below else ""


def points(sheet: DrawingSheet) -> np.ndarray:
    """The table of points: cam angle, radius, polar angle, as printed, by cam angle."""
    rows = [[angle, *beside(sheet, str(angle))] for angle in range(0, 180, 10)]
    numbers = [float(value) for row in rows for value in row]
    return np.array(numbers).reshape(-1, 2, 3).transpose(1, 0, 2).reshape(-1, 3)


# -- what it states ---------------------------------------------------------------------------------------


def test_an_eccentric_disk_is_stated_in_closed_form(tmp_path: Path) -> None:
    rises = "".join(
        f'[[motion.segments]]\nlaw = "simple-harmonic"\nspan_deg = 180.0\nrise_mm = {rise}\n' for rise in (20.0, -20.0)
    )
    (tmp_path / "disk.toml").write_text(
        f'format = 1\nname = "Disk"\n[motion]\nstart_mm = 0.0\n{rises}[follower]\nkind = "translating"\nface = "flat"\n'
        '[cam]\nbase_radius_mm = 40.0\n[shaft]\nrotation = "cw"\nspeed_rpm = 60.0\n[loads]\n',
        "utf-8",
    )
    sheet = drawing(Study(load(tmp_path / "disk.toml")))
    assert beside(sheet, "Smallest radius") == ["40", "0"]
    assert beside(sheet, "Largest radius") == ["60", "180"]
    assert beside(sheet, "Least convex radius of curvature")[0] == "50"
    assert beside(sheet, "Least concave radius of curvature") == ["none"]
    assert field(sheet, "Sense of rotation") == "clockwise"
    assert field(sheet, "Face") == "Flat face"
    # r² - 20 r cos(polar - top) = 40² - 10²·…: the disk's centre is 10 mm from the cam's, towards the largest radius
    table = points(sheet)
    top = table[18, 2]
    along = np.radians(table[:, 2] - top)
    assert table[:, 1] == pytest.approx(10.0 * np.cos(along) + np.sqrt(2500.0 - (10.0 * np.sin(along)) ** 2), abs=6e-4)


@pytest.mark.parametrize(("design", "flank"), [(HOLLOW, "inner"), (with_shaft(HOLLOW, rotation="cw"), "inner")])
def test_radii_and_points_are_those_of_the_cam(design: Design, flank: str) -> None:
    sheet, study = drawing(Study(design), DrawingRequest(flank=flank)), Study(design, 36)
    there = study.cam.only(flank).flank
    table = points(sheet)
    assert table[:, 0] == pytest.approx(np.arange(0.0, 360.0, 10.0), abs=0.0)
    assert table[:, 1] == pytest.approx(1e3 * np.abs(there.profile), abs=5.1e-4)
    polar = np.degrees(np.angle(there.profile * np.exp(-1j * np.radians(table[:, 2]))))
    assert np.abs(polar).max() < 5.1e-4
    bend = extremes_of(study, "cam", ("profile_curvature",))["profile_curvature"]
    convex, concave = (beside(sheet, f"Least {name} radius of curvature") for name in ("convex", "concave"))
    assert [float(text) for text in convex] == pytest.approx(
        [1e3 / bend.high.value, np.degrees(bend.high.theta)], abs=6e-4
    )
    assert [float(text) for text in concave] == pytest.approx(
        [-1e3 / bend.low.value, np.degrees(bend.low.theta)], abs=6e-4
    )


def test_what_is_known_of_the_blank_is_drawn_and_stated() -> None:
    sheet = drawing(Study(KEYED), DrawingRequest(date="1 March"))
    given = {
        "Base radius": "30", "Bore ⌀": "20", "Hub ⌀": "34", "Keyway width": "6", "Keyway depth, from the bore": "2.8",
        "Keyway angle, °": "90", "Thickness": "12",
    }  # fmt: skip
    assert {name: beside(sheet, name)[0] for name in given} == given
    assert field(sheet, "Thickness") == "12 mm"
    assert field(sheet, "Date") == "1 March"
    paper, cam = (float(part) for part in field(sheet, "Scale").split(":"))
    circles = {round(item.radius * cam / paper, 9) for item in sheet.items if isinstance(item, SheetCircle)}
    assert {10.0, 17.0, 30.0} <= circles
    named = {text.text for text in texts(sheet)}
    assert {"⌀ 20", "⌀ 34", "keyway 6 × 2.8", "0°"} <= named
    plain = {text.text for text in texts(drawing(Study(HOLLOW)))}
    assert not {text for text in plain if "⌀" in text or "eyway" in text}
    anywhere = drawing(Study(with_cam(KEYED, keyway_angle_deg=None)))
    assert beside(anywhere, "Keyway angle, °")[0] == "not given"
    assert "keyway 6 × 2.8" not in {text.text for text in texts(anywhere)}


def test_the_drawing_of_one_drive_of_several_names_machine_and_drive() -> None:
    sheet = drawing(Study(load_one(EXAMPLES / "transfer_unit.toml", "lift")))
    assert sheet.title == field(sheet, "Title") == "Transfer unit, drive Lift"


@pytest.mark.stress
def test_the_other_flanks_have_drawings() -> None:
    groove, pair = (Study(load(EXAMPLES / f"{name}.toml")) for name in ("groove", "conjugate"))
    assert field(drawing(groove, DrawingRequest(flank="outer")), "Face") == "Roller, radius 16 mm", (
        "the play is none of the roller"
    )
    assert beside(drawing(pair, DrawingRequest(flank="second")), "Smallest radius") != beside(
        drawing(pair), "Smallest radius"
    )


# -- the page ---------------------------------------------------------------------------------------------

Box = tuple[float, float, float, float]


def room(text: SheetText) -> Box:
    """The room of a text, its capitals' height high."""
    left = text.at.real - text.align * text.room
    return left, text.at.imag, left + text.room, text.at.imag + text.height


def overlap(one: Box, other: Box) -> bool:
    """Whether two boxes do, also where one is but a line."""
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def runs_through(line: SheetLine, box: Box) -> bool:
    """Whether a line runs through the room of a text."""
    for a, b in pairwise(line.points):
        around = min(a.real, b.real), min(a.imag, b.imag), max(a.real, b.real), max(a.imag, b.imag)
        if not overlap(around, box):
            continue
        z = a + (b - a) * np.linspace(0.0, 1.0, 200)
        if ((z.real > box[0]) & (z.real < box[2]) & (z.imag > box[1]) & (z.imag < box[3])).any():
            return True
    return False


def check_page(sheet: DrawingSheet, paper: str) -> None:
    assert (sheet.width, sheet.height) == PAPERS[paper]
    assert field(sheet, "Scale") in STANDARD
    frame = (20.0, 10.0, sheet.width - 10.0, sheet.height - 10.0)
    boxes = {text: room(text) for text in texts(sheet)}
    lines = [item for item in sheet.items if isinstance(item, SheetLine)]
    for text, box in boxes.items():
        assert frame[0] < box[0] < box[2] < frame[2], text
        assert frame[1] < box[1] < box[3] < frame[3], text
        through = [line for line in lines if runs_through(line, box)]
        assert not through, (text, through)
    for one, other in combinations(boxes, 2):
        assert not overlap(boxes[one], boxes[other]), (one, other)
    for line in lines:
        for z in line.points:
            assert frame[0] <= z.real <= frame[2] + 1e-9
            assert frame[1] - 1e-9 <= z.imag <= frame[3] + 1e-9


DRAWN = ("transfer_lift", "tappet_flat", "groove", "conjugate", "rocker_shoe", "four_bar_coupler_cam")


@pytest.mark.parametrize(("name", "paper"), spread([(name, paper) for name in DRAWN for paper in PAPERS], 2))
def test_nothing_lies_over_anything(name: str, paper: str) -> None:
    check_page(drawing(Study(load(EXAMPLES / f"{name}.toml")), DrawingRequest(paper=paper)), paper)


@pytest.mark.stress
def test_a_full_page_has_room_for_all(tmp_path: Path) -> None:
    check_page(drawing(Study(KEYED)), "A4")
    Image.new("RGB", (300, 80), "navy").save(tmp_path / "logo.png")
    sheet = drawing(
        Study(KEYED),
        DrawingRequest(author="J. Kim", company="Cams & Sons Ltd., Busan", logo=str(tmp_path / "logo.png")),
    )
    check_page(sheet, "A4")
    assert (field(sheet, "Drawn"), field(sheet, "Company")) == ("J. Kim", "Cams & Sons Ltd., Busan")
    (logo,) = [item for item in sheet.items if isinstance(item, SheetLogo)]
    corners = logo.low.real, logo.low.imag, logo.high.real, logo.high.imag
    assert not any(overlap(room(text), corners) for text in texts(sheet))
    assert sheet.missing == ""


def test_a_logo_that_is_no_picture_is_left_out_and_said(tmp_path: Path) -> None:
    (tmp_path / "logo.png").write_bytes(b"\x89PNG\r\n\x1a\n broken")
    for name, why in (("logo.png", "cannot be read as an image"), ("none.png", "no such file")):
        sheet = drawing(Study(HOLLOW), DrawingRequest(logo=str(tmp_path / name)))
        assert why in sheet.missing
        assert not any(isinstance(item, SheetLogo) for item in sheet.items)


def test_the_scale_fits_the_paper() -> None:
    """Four times the cam on the same paper, and larger paper, change the scale as they should."""
    scales = {
        (size, paper): field(
            drawing(Study(with_cam(HOLLOW, base_radius_mm=size)), DrawingRequest(paper=paper)), "Scale"
        )
        for size, paper in ((30.0, "A4"), (30.0, "A3"), (300.0, "A4"), (300.0, "A3"))
    }
    factor = {key: float(text.split(":")[0]) / float(text.split(":")[1]) for key, text in scales.items()}
    assert factor[30.0, "A4"] > factor[300.0, "A4"]
    assert factor[30.0, "A3"] >= factor[30.0, "A4"]
    assert factor[300.0, "A3"] >= factor[300.0, "A4"]


# -- refusals ---------------------------------------------------------------------------------------------


def test_what_cannot_be_drawn_is_refused_as_its_profile_is() -> None:
    cusp = with_drive(
        PUSHER, motion=levels(0.0, (25.0, 20.0, "cycloidal"), (25.0, 0.0, "cycloidal"), (310.0, 0.0, "dwell"))
    )
    with pytest.raises(NoCam, match="the profile is undercut"):
        drawing(Study(cusp))
    with pytest.raises(KindynaError, match="this kind of design has none of that name"):
        drawing(Study(load(EXAMPLES / "four_bar.toml")))
    with pytest.raises(KindynaError, match="flank 'outer': this cam has none of that name; allowed: inner"):
        drawing(Study(HOLLOW), DrawingRequest(flank="outer"))
    with pytest.raises(KindynaError, match="paper 'A5': unknown; allowed: A4, A3"):
        drawing(Study(HOLLOW), DrawingRequest(paper="A5"))
